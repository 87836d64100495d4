#include "geom/hilbert.h"
#include "geom/mesh.h"
#include "geom/segment.h"

#include <math.h>

G_DEFINE_QUARK(mesh-error-quark, mesh_error)

enum { LEAF = 4, NONE = UINT32_MAX };

/* Coordinates beyond this overflow in the products that exact predicates take; extents below its inverse vanish in them. */
static const double largest = 1e50;

Pslg *pslg_new(uint32_t n_points, uint32_t n_outline, uint32_t n_segments)
{
    Pslg *g = g_new0(Pslg, 1);
    g->n_points = n_points;
    g->n_outline = n_outline;
    g->n_segments = n_segments;
    g->point = g_new0(Vec2, n_points);
    g->segment = g_malloc0_n(n_segments, sizeof *g->segment);
    return g;
}

void pslg_free(Pslg *g)
{
    if (!g)
        return;
    g_free(g->point);
    g_free(g->segment);
    g_free(g);
}

static gboolean refuse(GError **error, const char *format, ...) G_GNUC_PRINTF(2, 3);

static gboolean refuse(GError **error, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    GError *e = g_error_new_valist(MESH_ERROR, MESH_ERROR_INPUT, format, args);
    va_end(args);
    g_propagate_error(error, e);
    return FALSE;
}

/* --- words for messages --- */

/* A name is good until `names` is freed. */
static const char *point_name(GStringChunk *names, const Pslg *g, uint32_t i)
{
    char x[G_ASCII_DTOSTR_BUF_SIZE], y[G_ASCII_DTOSTR_BUF_SIZE];
    g_ascii_formatd(x, sizeof x, "%.9g", g->point[i].x);
    g_ascii_formatd(y, sizeof y, "%.9g", g->point[i].y);
    char *name = g_strdup_printf("%s point %u (%s, %s)", i < g->n_outline ? "outline" : "vein", i, x, y);
    const char *kept = g_string_chunk_insert(names, name);
    g_free(name);
    return kept;
}

static const char *length_name(GStringChunk *names, double length)
{
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    return g_string_chunk_insert(names, g_ascii_formatd(text, sizeof text, "%.4g", length));
}

/* --- parts: the segments, and points that are on none --- */

typedef struct {
    uint32_t a, b; /* the same for a lone point */
    Box2 box;
} Part;

/* The parts along Hilbert's curve, with a tree of boxes over them: node k has the children 2k and 2k + 1, the last n_leaves nodes hold LEAF
 * parts each. */
typedef struct {
    const Pslg *g;
    uint32_t n, n_leaves;
    Part *part;
    uint32_t *order; /* parts by place on the curve */
    Box2 *node;      /* [2 n_leaves], from 1 */
} Parts;

static const char *part_name(GStringChunk *names, const Pslg *g, Part p)
{
    const char *from = point_name(names, g, p.a), *to = point_name(names, g, p.b);
    gboolean margin = p.a < g->n_outline && p.b == (p.a + 1 < g->n_outline ? p.a + 1 : 0);
    char *name = g_strdup_printf("the %s segment from %s to %s", margin ? "outline" : "vein", from, to);
    const char *kept = g_string_chunk_insert(names, name);
    g_free(name);
    return kept;
}

static void collect(Parts *t, const Pslg *g)
{
    uint8_t *used = g_malloc0(g->n_points);
    t->part = g_new(Part, (gsize)g->n_points + g->n_segments);
    for (uint32_t i = 0; i < g->n_outline; i++)
        t->part[t->n++] = (Part){.a = i, .b = i + 1 < g->n_outline ? i + 1 : 0};
    for (uint32_t i = 0; i < g->n_segments; i++) {
        t->part[t->n++] = (Part){.a = g->segment[i][0], .b = g->segment[i][1]};
        used[g->segment[i][0]] = used[g->segment[i][1]] = 1;
    }
    for (uint32_t i = g->n_outline; i < g->n_points; i++)
        if (!used[i])
            t->part[t->n++] = (Part){.a = i, .b = i};
    for (uint32_t i = 0; i < t->n; i++)
        t->part[i].box = box_add(box_add(box_empty(), g->point[t->part[i].a]), g->point[t->part[i].b]);
    g_free(used);
}

static void parts_init(Parts *t, const Pslg *g)
{
    *t = (Parts){.g = g, .n_leaves = 1};
    collect(t, g);
    Box2 all = box_empty();
    for (uint32_t i = 0; i < t->n; i++)
        all = box_union(all, t->part[i].box);
    Hilbert curve = hilbert_over(all);
    uint64_t *place = g_new(uint64_t, t->n);
    for (uint32_t i = 0; i < t->n; i++)
        place[i] = hilbert_place(curve, vec_lerp(g->point[t->part[i].a], g->point[t->part[i].b], 0.5), i);
    g_qsort_with_data(place, (gint)t->n, sizeof *place, hilbert_compare, NULL);

    while (t->n_leaves * LEAF < t->n)
        t->n_leaves *= 2;
    t->order = g_new(uint32_t, t->n);
    t->node = g_new(Box2, 2 * (gsize)t->n_leaves);
    for (uint32_t k = 1; k < 2 * t->n_leaves; k++)
        t->node[k] = box_empty();
    for (uint32_t i = 0; i < t->n; i++) {
        t->order[i] = (uint32_t)place[i];
        Box2 *leaf = &t->node[t->n_leaves + i / LEAF];
        *leaf = box_union(*leaf, t->part[t->order[i]].box);
    }
    for (uint32_t k = t->n_leaves; k-- > 1;)
        t->node[k] = box_union(t->node[2 * k], t->node[2 * k + 1]);
    g_free(place);
}

static void parts_clear(Parts *t)
{
    g_free(t->part);
    g_free(t->order);
    g_free(t->node);
}

/* --- what two parts may not do --- */

static int side(Vec2 a, Vec2 b, Vec2 c)
{
    double k = vec_cross(vec_sub(b, a), vec_sub(c, a));
    return (k > 0.0) - (k < 0.0);
}

static bool boxes_meet(Box2 a, Box2 b) { return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1; }

/* Whether they cross like an X. Ends on or near the other one are too_near's business, so plain signs do. */
static bool cross(const Parts *t, Part p, Part q)
{
    const Vec2 *v = t->g->point;
    return p.a != q.a && p.a != q.b && p.b != q.a && p.b != q.b && boxes_meet(p.box, q.box) &&
           side(v[p.a], v[p.b], v[q.a]) * side(v[p.a], v[p.b], v[q.b]) < 0 &&
           side(v[q.a], v[q.b], v[p.a]) * side(v[q.a], v[q.b], v[p.b]) < 0;
}

/* An end of q that is nearer to p than it may be; NONE if there is none. */
static uint32_t too_near(const Parts *t, Part p, Part q, double least2)
{
    const Vec2 *v = t->g->point;
    const uint32_t end[2] = {q.a, q.b};
    for (int k = 0; k < 2; k++) {
        if (end[k] == p.a || end[k] == p.b)
            continue;
        double d2 = segment_dist2(v[p.a], v[p.b], v[end[k]]);
        if (d2 < least2 || d2 == 0.0)
            return end[k];
    }
    return NONE;
}

static gboolean refuse_near(const Parts *t, Part p, uint32_t i, double least, GError **error)
{
    const Vec2 *v = t->g->point;
    GStringChunk *names = g_string_chunk_new(256);
    const char *point = point_name(names, t->g, i), *need = length_name(names, least);
    double at = segment_nearest(v[p.a], v[p.b], v[i]);
    if (at == 0.0 || at == 1.0) {
        uint32_t j = at == 0.0 ? p.a : p.b;
        refuse(error, "%s and %s are %s apart; points must be at least %s apart", point, point_name(names, t->g, j),
               length_name(names, vec_dist(v[i], v[j])), need);
    } else {
        refuse(error, "%s is %s away from %s; a point must be an end of a segment or at least %s away from it", point,
               length_name(names, sqrt(segment_dist2(v[p.a], v[p.b], v[i]))), part_name(names, t->g, p), need);
    }
    g_string_chunk_free(names);
    return FALSE;
}

static gboolean check_pair(const Parts *t, Part p, Part q, double least, GError **error)
{
    bool twice = (p.a == q.a && p.b == q.b) || (p.a == q.b && p.b == q.a);
    if (twice || cross(t, p, q)) {
        GStringChunk *names = g_string_chunk_new(256);
        if (twice)
            refuse(error, "%s is there twice", part_name(names, t->g, p));
        else
            refuse(error, "%s crosses %s; segments may meet at common points only", part_name(names, t->g, p),
                   part_name(names, t->g, q));
        g_string_chunk_free(names);
        return FALSE;
    }
    uint32_t near = too_near(t, p, q, least * least);
    if (near != NONE)
        return refuse_near(t, p, near, least, error);
    near = too_near(t, q, p, least * least);
    return near == NONE || refuse_near(t, q, near, least, error);
}

/* Every pair of parts whose boxes come within `least` of each other, once. */
static gboolean check_pairs(const Parts *t, double least, GError **error)
{
    for (uint32_t i = 0; i < t->n; i++) {
        Box2 box = box_grow(t->part[i].box, least);
        uint32_t stack[64], depth = 0;
        stack[depth++] = 1;
        while (depth) {
            uint32_t k = stack[--depth];
            if (!boxes_meet(t->node[k], box))
                continue;
            if (k < t->n_leaves) {
                stack[depth++] = 2 * k + 1;
                stack[depth++] = 2 * k;
                continue;
            }
            uint32_t first = (k - t->n_leaves) * LEAF;
            for (uint32_t at = first; at < first + LEAF && at < t->n; at++) {
                uint32_t j = t->order[at];
                if (j > i && boxes_meet(t->part[j].box, box) && !check_pair(t, t->part[i], t->part[j], least, error))
                    return FALSE;
            }
        }
    }
    return TRUE;
}

/* --- the rest --- */

static gboolean check_points(const Pslg *g, GError **error)
{
    Box2 box = box_empty();
    for (uint32_t i = 0; i < g->n_points; i++) {
        if (!(fabs(g->point[i].x) <= largest && fabs(g->point[i].y) <= largest)) {
            GStringChunk *names = g_string_chunk_new(256);
            refuse(error, "%s must have finite coordinates, at most 1e50", point_name(names, g, i));
            g_string_chunk_free(names);
            return FALSE;
        }
        box = box_add(box, g->point[i]);
    }
    if (g->n_outline < 3 || g->n_outline > g->n_points)
        return refuse(error, "the outline has %u of the %u points; it must have 3 at least", g->n_outline, g->n_points);
    if (!(box.x1 - box.x0 >= 1.0 / largest && box.y1 - box.y0 >= 1.0 / largest))
        return refuse(error, "the points lie on one line, or nearer than 1e-50 to it; the outline must enclose an area");
    return TRUE;
}

static gboolean check_ends(const Pslg *g, double least, GError **error)
{
    for (uint32_t i = 0; i < g->n_segments; i++) {
        uint32_t a = g->segment[i][0], b = g->segment[i][1];
        if (a >= g->n_points || b >= g->n_points)
            return refuse(error, "vein segment %u goes from point %u to point %u; there are %u points", i, a, b,
                          g->n_points);
        if (a == b)
            return refuse(error, "vein segment %u goes from point %u to itself; its ends must differ", i, a);
    }
    for (uint32_t i = 0; i < g->n_outline + g->n_segments; i++) {
        uint32_t a = i < g->n_outline ? i : g->segment[i - g->n_outline][0];
        uint32_t b = i >= g->n_outline ? g->segment[i - g->n_outline][1] : i + 1 < g->n_outline ? i + 1 : 0;
        double d2 = vec_dist2(g->point[a], g->point[b]);
        if (d2 < least * least || d2 == 0.0) {
            Parts t = {.g = g};
            return refuse_near(&t, (Part){.a = a, .b = a}, b, least, error);
        }
    }
    return TRUE;
}

static double signed_area(const Vec2 *v, uint32_t n)
{
    double twice = 0.0;
    for (uint32_t i = 1; i + 1 < n; i++)
        twice += vec_cross(vec_sub(v[i], v[0]), vec_sub(v[i + 1], v[0]));
    return 0.5 * twice;
}

/* As nothing crosses, a segment is outside when an end is, or when it joins two outline points through the outside. */
static gboolean check_inside(const Pslg *g, GError **error)
{
    if (!(signed_area(g->point, g->n_outline) > 0.0))
        return refuse(error, "the outline runs clockwise; it must run counter-clockwise");
    Polygon *outline = polygon_new(g->point, g->n_outline);
    GStringChunk *names = g_string_chunk_new(256);
    gboolean good = TRUE;
    for (uint32_t i = g->n_outline; i < g->n_points && good; i++)
        if (!polygon_contains(outline, g->point[i]))
            good = refuse(error, "%s lies outside the outline", point_name(names, g, i));
    for (uint32_t i = 0; i < g->n_segments && good; i++) {
        Part p = {.a = g->segment[i][0], .b = g->segment[i][1]};
        if (p.a < g->n_outline && p.b < g->n_outline &&
            !polygon_contains(outline, vec_lerp(g->point[p.a], g->point[p.b], 0.5)))
            good = refuse(error, "%s runs outside the outline", part_name(names, g, p));
    }
    g_string_chunk_free(names);
    polygon_free(outline);
    return good;
}

gboolean pslg_check(const Pslg *g, double least, GError **error)
{
    if (!check_points(g, error) || !check_ends(g, least, error))
        return FALSE;
    Parts t;
    parts_init(&t, g);
    gboolean good = check_pairs(&t, least, error);
    parts_clear(&t);
    return good && check_inside(g, error);
}
