#include "shape/membrane.h"

#include "shape/cholesky.h"
#include "shape/voronoi.h"

G_DEFINE_QUARK(membrane-error-quark, membrane_error)

enum { FREE = UINT32_MAX };

/* With L the finite-volume operator, (Lf)_i = Σ_j w_ij (f_j - f_i), the equations at the free vertices are K f = 0, where K = -L for
 * MEMBRANE_LAPLACE and K = L D L for MEMBRANE_BILAPLACE, D = 1 / area, or 0 at fixed vertices of the margin. Split by free and fixed
 * columns: K_free f = -K_fixed posed. Free vertices, ascending, are the unknowns 0 … n_free - 1. (Numbered along a Hilbert curve, the order
 * of elimination is found a third sooner and the system put together as much later.) */
struct Membrane {
    MembraneKind kind;
    Voronoi *cells;
    double *degree;    /* [n_vertices] Σ_j w_ij */
    uint32_t n_fixed, n_free, n_rim;
    uint32_t *fixed;   /* [n_fixed] vertices */
    uint32_t *slot;    /* [n_vertices] index in `fixed`, or FREE */
    uint32_t *vertex;  /* [n_free] of the unknown */
    uint32_t *unknown; /* [n_vertices], FREE at a fixed one */
    SparseRows cross;  /* -K_fixed: rows are unknowns, columns are indices in `fixed` */
    Cholesky *factor;
    uint32_t *rim;     /* [n_rim] free vertices of the margin */
    Vec2 *pull;        /* [n_rim] L of the flat blade: what its margin lacks to a closed cell; 0 at inner vertices */
    Vec3 *push;        /* [n_rim] working space: the pull, turned */
    Vec3 *x;           /* [n_free] working space of the solver, in the order of elimination */
};

/* ---- the parts of the mesh ---- */

/* Marks all that hangs together with `from`; returns how many were new. */
static uint32_t flood(const Voronoi *v, uint32_t from, bool *wet, uint32_t *queue)
{
    if (wet[from])
        return 0;
    uint32_t n = 0;
    queue[n++] = from;
    wet[from] = true;
    for (uint32_t q = 0; q < n; q++)
        for (uint32_t p = v->start[queue[q]]; p < v->start[queue[q] + 1]; p++)
            if (!wet[v->neighbour[p]]) {
                wet[v->neighbour[p]] = true;
                queue[n++] = v->neighbour[p];
            }
    return n;
}

static gboolean check_parts(const Voronoi *v, const Mesh *mesh, const uint32_t *fixed, uint32_t n_fixed, GError **error)
{
    bool *wet = g_new0(bool, v->n);
    uint32_t *queue = g_new(uint32_t, v->n), reached = 0;
    for (uint32_t f = 0; f < n_fixed; f++)
        reached += flood(v, fixed[f], wet, queue);
    if (reached < v->n) {
        uint32_t dry = 0;
        while (wet[dry])
            dry++;
        uint32_t size = flood(v, dry, wet, queue);
        g_set_error(error, MEMBRANE_ERROR, MEMBRANE_ERROR_BARE,
                    "no vein holds the part of the blade at (%g, %g): of its %u vertices (%u is one) at least one must be fixed, and "
                    "none of the %u fixed ones is there",
                    mesh->vertex[dry].x, mesh->vertex[dry].y, size, dry, n_fixed);
    }
    g_free(queue);
    g_free(wet);
    return reached == v->n;
}

/* ---- the system ---- */

/* A row of K while it is put together, by vertex. */
typedef struct {
    uint32_t n, *column; /* [n_vertices] */
    double *value;       /* [n_vertices] by column */
    bool *seen;          /* [n_vertices] */
} Row;

static void row_add(Row *r, uint32_t column, double value)
{
    if (!r->seen[column]) {
        r->seen[column] = true;
        r->value[column] = 0.0;
        r->column[r->n++] = column;
    }
    r->value[column] += value;
}

/* scale · (row i of L) */
static void row_add_operator(const Membrane *m, Row *r, uint32_t i, double scale)
{
    row_add(r, i, -scale * m->degree[i]);
    for (uint32_t p = m->cells->start[i]; p < m->cells->start[i + 1]; p++)
        row_add(r, m->cells->neighbour[p], scale * m->cells->weight[p]);
}

/* D of the comment at struct Membrane. A fixed vertex of the margin would ask for no slope there, where nothing but the veins should. */
static double share(const Membrane *m, uint32_t i)
{
    return m->slot[i] != FREE && m->cells->margin[i] ? 0.0 : 1.0 / m->cells->area[i];
}

static void row_of_system(const Membrane *m, Row *r, uint32_t i)
{
    if (m->kind == MEMBRANE_LAPLACE) {
        row_add_operator(m, r, i, -1.0);
        return;
    }
    row_add_operator(m, r, i, -m->degree[i] * share(m, i));
    for (uint32_t p = m->cells->start[i]; p < m->cells->start[i + 1]; p++) {
        uint32_t j = m->cells->neighbour[p];
        double scale = m->cells->weight[p] * share(m, j);
        if (scale != 0.0)
            row_add_operator(m, r, j, scale);
    }
}

/* Rows that grow at their end. */
typedef struct {
    GArray *column, *value;
    uint32_t *start;
} Builder;

static Builder builder_new(uint32_t n)
{
    return (Builder){g_array_new(FALSE, FALSE, sizeof(uint32_t)), g_array_new(FALSE, FALSE, sizeof(double)),
                     g_new0(uint32_t, (gsize)n + 1)};
}

static void builder_add(Builder *b, uint32_t column, double value)
{
    g_array_append_val(b->column, column);
    g_array_append_val(b->value, value);
}

static SparseRows builder_end(Builder *b, uint32_t n)
{
    return (SparseRows){n, b->start, (uint32_t *)(void *)g_array_free(b->column, FALSE), (double *)(void *)g_array_free(b->value, FALSE)};
}

static void rows_clear(SparseRows *a)
{
    g_free(a->start);
    g_free(a->column);
    g_free(a->value);
}

/* Fills m->cross and returns K_free. */
static SparseRows build_system(Membrane *m)
{
    uint32_t n = m->cells->n;
    Row r = {0, g_new(uint32_t, n), g_new(double, n), g_new0(bool, n)};
    Builder inner = builder_new(m->n_free), cross = builder_new(m->n_free);
    for (uint32_t u = 0; u < m->n_free; u++) {
        r.n = 0;
        row_of_system(m, &r, m->vertex[u]);
        for (uint32_t k = 0; k < r.n; k++) {
            uint32_t j = r.column[k];
            r.seen[j] = false;
            if (m->slot[j] == FREE)
                builder_add(&inner, m->unknown[j], r.value[j]);
            else
                builder_add(&cross, m->slot[j], -r.value[j]);
        }
        inner.start[u + 1] = inner.column->len;
        cross.start[u + 1] = cross.column->len;
    }
    g_free(r.column);
    g_free(r.value);
    g_free(r.seen);
    m->cross = builder_end(&cross, m->n_free);
    return builder_end(&inner, m->n_free);
}

static gboolean factorise(Membrane *m, GError **error)
{
    SparseRows a = build_system(m);
    m->factor = cholesky_new(&a);
    rows_clear(&a);
    if (!m->factor)
        g_set_error(error, MEMBRANE_ERROR, MEMBRANE_ERROR_FACTOR,
                    "the blade's %u free vertices can't be solved for: some triangles are too thin, or there are too many (a factor "
                    "may have 2^31 entries)",
                    m->n_free);
    return m->factor != NULL;
}

/* The flat blade's own (Lf)_i at free vertices of the margin. Inside it is 0, the equations being exact for linear functions. */
static void find_rim(Membrane *m, const Mesh *mesh)
{
    const Voronoi *v = m->cells;
    for (uint32_t i = 0; i < v->n; i++)
        m->n_rim += m->slot[i] == FREE && v->margin[i];
    m->rim = g_new(uint32_t, m->n_rim);
    m->pull = g_new(Vec2, m->n_rim);
    m->push = g_new(Vec3, m->n_rim);
    for (uint32_t i = 0, k = 0; i < v->n; i++) {
        if (m->slot[i] != FREE || !v->margin[i])
            continue;
        Vec2 sum = vec2(0.0, 0.0);
        for (uint32_t p = v->start[i]; p < v->start[i + 1]; p++)
            sum = vec_add(sum, vec_scale(vec_sub(mesh->vertex[v->neighbour[p]], mesh->vertex[i]), v->weight[p]));
        m->rim[k] = i;
        m->pull[k++] = sum;
    }
}

static void set_fixed(Membrane *m, const uint32_t *fixed, uint32_t n_fixed)
{
    m->n_fixed = n_fixed;
    m->n_free = m->cells->n - n_fixed;
    m->fixed = g_memdup2(fixed, n_fixed * sizeof *fixed);
    for (uint32_t i = 0; i < m->cells->n; i++) {
        m->slot[i] = FREE;
        m->degree[i] = 0.0;
        for (uint32_t p = m->cells->start[i]; p < m->cells->start[i + 1]; p++)
            m->degree[i] += m->cells->weight[p];
    }
    for (uint32_t f = 0; f < n_fixed; f++) {
        g_assert(fixed[f] < m->cells->n && m->slot[fixed[f]] == FREE);
        m->slot[fixed[f]] = f;
    }
}

Membrane *membrane_new(const Mesh *mesh, const uint32_t *fixed, uint32_t n_fixed, MembraneKind kind, GError **error)
{
    g_assert(n_fixed <= mesh->n_vertices && mesh->n_vertices < G_MAXINT);
    Voronoi *cells = voronoi_new(mesh);
    if (!check_parts(cells, mesh, fixed, n_fixed, error)) {
        voronoi_free(cells);
        return NULL;
    }
    Membrane *m = g_new0(Membrane, 1);
    m->kind = kind;
    m->cells = cells;
    m->degree = g_new(double, cells->n);
    m->slot = g_new(uint32_t, cells->n);
    m->unknown = g_new(uint32_t, cells->n);
    set_fixed(m, fixed, n_fixed);
    m->vertex = g_new(uint32_t, m->n_free);
    m->x = g_new(Vec3, m->n_free);
    for (uint32_t i = 0, u = 0; i < cells->n; i++) {
        m->unknown[i] = m->slot[i] == FREE ? u : FREE;
        if (m->slot[i] == FREE)
            m->vertex[u++] = i;
    }
    find_rim(m, mesh);
    if (factorise(m, error))
        return m;
    membrane_free(m);
    return NULL;
}

void membrane_free(Membrane *m)
{
    if (!m)
        return;
    voronoi_free(m->cells);
    cholesky_free(m->factor);
    rows_clear(&m->cross);
    g_free(m->degree);
    g_free(m->fixed);
    g_free(m->slot);
    g_free(m->vertex);
    g_free(m->unknown);
    g_free(m->rim);
    g_free(m->pull);
    g_free(m->push);
    g_free(m->x);
    g_free(m);
}

/* ---- solving ---- */

/* Right-hand sides from the fixed vertices; fixed one f has its value at at_fixed[f · stride]. */
static void load(Membrane *m, const Vec3 *at_fixed, uint32_t stride)
{
    for (uint32_t u = 0; u < m->n_free; u++) {
        Vec3 sum = vec3(0.0, 0.0, 0.0);
        for (uint32_t p = m->cross.start[u]; p < m->cross.start[u + 1]; p++)
            sum = vec3_add(sum, vec3_scale(at_fixed[m->cross.column[p] * (gsize)stride], m->cross.value[p]));
        m->x[m->factor->position[u]] = sum;
    }
}

static void unload(const Membrane *m, const Vec3 *posed, Vec3 *place)
{
    for (uint32_t u = 0; u < m->n_free; u++)
        place[m->vertex[u]] = m->x[m->factor->position[u]];
    for (uint32_t f = 0; f < m->n_fixed; f++)
        place[m->fixed[f]] = posed[f];
}

void membrane_interpolate(Membrane *m, const Vec3 *posed, Vec3 *place)
{
    load(m, posed, 1);
    cholesky_solve3(m->factor, m->x);
    unload(m, posed, place);
}

static void add_to_unknown(Membrane *m, uint32_t vertex, Vec3 value)
{
    if (m->slot[vertex] != FREE)
        return;
    Vec3 *x = &m->x[m->factor->position[m->unknown[vertex]]];
    *x = vec3_add(*x, value);
}

/* The equations become L f = push for L f = 0: K f = -push for Laplace, K f = L D push for Bilaplace. */
static void load_push(Membrane *m)
{
    const Voronoi *v = m->cells;
    for (uint32_t k = 0; k < m->n_rim; k++) {
        uint32_t i = m->rim[k];
        if (m->kind == MEMBRANE_LAPLACE) {
            add_to_unknown(m, i, vec3_scale(m->push[k], -1.0));
            continue;
        }
        Vec3 part = vec3_scale(m->push[k], share(m, i));
        add_to_unknown(m, i, vec3_scale(part, -m->degree[i]));
        for (uint32_t p = v->start[i]; p < v->start[i + 1]; p++)
            add_to_unknown(m, v->neighbour[p], vec3_scale(part, v->weight[p]));
    }
}

void membrane_interpolate_turned(Membrane *m, const Vec3 *posed, const Mat3 *turn, Vec3 *place)
{
    for (uint32_t k = 0; k < m->n_rim; k++)
        m->push[k] = vec3(0.0, 0.0, 0.0);
    for (int axis = 0; axis < 2; axis++) { /* the flat blade has no z */
        load(m, axis == 0 ? &turn->x : &turn->y, sizeof(Mat3) / sizeof(Vec3));
        cholesky_solve3(m->factor, m->x);
        for (uint32_t k = 0; k < m->n_rim; k++) {
            Vec3 column = m->x[m->factor->position[m->unknown[m->rim[k]]]];
            m->push[k] = vec3_add(m->push[k], vec3_scale(column, axis == 0 ? m->pull[k].x : m->pull[k].y));
        }
    }
    load(m, posed, 1);
    load_push(m);
    cholesky_solve3(m->factor, m->x);
    unload(m, posed, place);
}

void membrane_harmonic(Membrane *m, const double *at_fixed, double *value)
{
    double *x = &m->x->x;
    for (uint32_t u = 0; u < m->n_free; u++) {
        double sum = 0.0;
        for (uint32_t p = m->cross.start[u]; p < m->cross.start[u + 1]; p++)
            sum += at_fixed[m->cross.column[p]] * m->cross.value[p];
        x[m->factor->position[u]] = sum;
    }
    cholesky_solve(m->factor, x);
    for (uint32_t u = 0; u < m->n_free; u++)
        value[m->vertex[u]] = x[m->factor->position[u]];
    for (uint32_t f = 0; f < m->n_fixed; f++)
        value[m->fixed[f]] = at_fixed[f];
}

/* ---- for tests ---- */

/* (L f)_i of `of`, and in size[i] the sum of its terms' sizes. */
static void apply(const Membrane *m, const Vec3 *of, const double *of_size, Vec3 *out, double *size)
{
    const Voronoi *v = m->cells;
    for (uint32_t i = 0; i < v->n; i++) {
        out[i] = vec3(0.0, 0.0, 0.0);
        size[i] = 0.0;
        for (uint32_t p = v->start[i]; p < v->start[i + 1]; p++) {
            uint32_t j = v->neighbour[p];
            out[i] = vec3_add(out[i], vec3_scale(vec3_sub(of[j], of[i]), v->weight[p]));
            size[i] += fabs(v->weight[p]) * (of_size[j] + of_size[i]);
        }
    }
}

double membrane_residual(const Membrane *m, const Vec3 *place)
{
    uint32_t n = m->cells->n;
    Vec3 *once = g_new(Vec3, n), *twice = g_new(Vec3, n);
    double *length = g_new(double, n), *once_size = g_new(double, n), *twice_size = g_new(double, n), worst = 0.0;
    for (uint32_t i = 0; i < n; i++)
        length[i] = vec3_norm(place[i]);
    apply(m, place, length, once, once_size);
    if (m->kind == MEMBRANE_BILAPLACE) {
        for (uint32_t i = 0; i < n; i++) {
            double scale = m->degree[i] != 0.0 ? share(m, i) : 0.0;
            once[i] = vec3_scale(once[i], scale);
            once_size[i] *= scale;
        }
        apply(m, once, once_size, twice, twice_size);
    }
    for (uint32_t i = 0; i < n; i++) {
        double r = vec3_norm(m->kind == MEMBRANE_LAPLACE ? once[i] : twice[i]);
        double size = m->kind == MEMBRANE_LAPLACE ? once_size[i] : twice_size[i];
        if (m->slot[i] == FREE && r > 0.0)
            worst = MAX(worst, r / size);
    }
    g_free(once);
    g_free(twice);
    g_free(length);
    g_free(once_size);
    g_free(twice_size);
    return worst;
}

double membrane_weight(const Membrane *m, uint32_t i, uint32_t j)
{
    for (uint32_t p = m->cells->start[i]; p < m->cells->start[i + 1]; p++)
        if (m->cells->neighbour[p] == j)
            return m->cells->weight[p];
    return 0.0;
}
