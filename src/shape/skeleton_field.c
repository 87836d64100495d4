#include "shape/skeleton_field.h"

enum { CELLS = 128, NO_ENTRY = UINT32_MAX }; /* cells along the longer side */

typedef struct {
    uint32_t edge, next, cell;
} Entry;

void field_init(Field *f, Box2 box)
{
    double w = box.x1 - box.x0, h = box.y1 - box.y0, size = MAX(w, h);
    f->scale = size > 0.0 ? CELLS / size : 1.0;
    f->corner = vec2(box.x0, box.y0);
    f->nx = (uint32_t)MIN(w * f->scale, CELLS - 1) + 1;
    f->ny = (uint32_t)MIN(h * f->scale, CELLS - 1) + 1;
    f->head = g_new(uint32_t, f->nx * f->ny);
    for (uint32_t i = 0; i < f->nx * f->ny; i++)
        f->head[i] = NO_ENTRY;
    f->node = g_array_new(FALSE, FALSE, sizeof(FieldNode));
    f->edge = g_array_new(FALSE, FALSE, sizeof(FieldEdge));
    f->entry = g_array_new(FALSE, FALSE, sizeof(Entry));
    f->seen = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    f->found = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    f->query = 0;
}

void field_clear(Field *f)
{
    g_free(f->head);
    g_array_free(f->node, TRUE);
    g_array_free(f->edge, TRUE);
    g_array_free(f->entry, TRUE);
    g_array_free(f->seen, TRUE);
    g_array_free(f->found, TRUE);
}

static uint32_t cell_of(double t, uint32_t n) { return !(t > 0.0) ? 0 : t >= (double)n ? n - 1 : (uint32_t)t; }

/* The cells of row j that the segment uv, `reach` wide to each side, may touch: from *i0 to *i1. */
static void row_span(const Field *f, Vec2 u, Vec2 v, double reach, uint32_t j, uint32_t *i0, uint32_t *i1)
{
    double y0 = f->corner.y + (double)j / f->scale - reach, y1 = f->corner.y + (double)(j + 1) / f->scale + reach;
    double dy = v.y - u.y, s = 0.0, t = 1.0;
    if (dy != 0.0) { /* the part of uv between y0 and y1; the border rows reach to infinity */
        double p = (y0 - u.y) / dy, q = (y1 - u.y) / dy;
        if (j > 0 && j + 1 < f->ny) {
            s = CLAMP(MIN(p, q), 0.0, 1.0);
            t = CLAMP(MAX(p, q), 0.0, 1.0);
        }
    }
    double xs = u.x + (v.x - u.x) * s, xt = u.x + (v.x - u.x) * t;
    *i0 = cell_of((MIN(xs, xt) - reach - f->corner.x) * f->scale, f->nx);
    *i1 = cell_of((MAX(xs, xt) + reach - f->corner.x) * f->scale, f->nx);
}

static void rows(const Field *f, Vec2 u, Vec2 v, double reach, uint32_t *j0, uint32_t *j1)
{
    *j0 = cell_of((MIN(u.y, v.y) - reach - f->corner.y) * f->scale, f->ny);
    *j1 = cell_of((MAX(u.y, v.y) + reach - f->corner.y) * f->scale, f->ny);
}

uint32_t field_add_node(Field *f, Vec2 p, bool margin)
{
    FieldNode node = {p, margin};
    g_array_append_val(f->node, node);
    return f->node->len - 1;
}

uint32_t field_add_edge(Field *f, uint32_t a, uint32_t b, uint32_t owner)
{
    FieldEdge e = {a, b, owner};
    uint32_t index = f->edge->len, j0, j1, i0, i1;
    Vec2 u = field_at(f, a), v = field_at(f, b);
    double hair = 1e-6 / f->scale; /* far above the rounding of the spans */
    g_array_append_val(f->edge, e);
    g_array_append_val(f->seen, f->query);
    rows(f, u, v, hair, &j0, &j1);
    for (uint32_t j = j0; j <= j1; j++) {
        row_span(f, u, v, hair, j, &i0, &i1);
        for (uint32_t i = i0; i <= i1; i++) {
            Entry entry = {index, f->head[j * f->nx + i], j * f->nx + i};
            f->head[entry.cell] = f->entry->len;
            g_array_append_val(f->entry, entry);
        }
    }
    return index;
}

uint32_t field_split(Field *f, uint32_t edge, uint32_t node)
{
    FieldEdge *e = &g_array_index(f->edge, FieldEdge, edge);
    uint32_t b = e->b, owner = e->owner;
    e->b = node; /* it stays listed in all its cells, which is more than is needed */
    return field_add_edge(f, node, b, owner);
}

void field_undo(Field *f, uint32_t n_nodes, uint32_t n_edges)
{
    while (f->entry->len > 0) {
        Entry *last = &g_array_index(f->entry, Entry, f->entry->len - 1);
        if (last->edge < n_edges)
            break;
        f->head[last->cell] = last->next;
        g_array_set_size(f->entry, f->entry->len - 1);
    }
    g_array_set_size(f->edge, n_edges);
    g_array_set_size(f->seen, n_edges);
    g_array_set_size(f->node, n_nodes);
}

const uint32_t *field_near(Field *f, Vec2 u, Vec2 v, double reach, uint32_t *n)
{
    uint32_t j0, j1, i0, i1;
    double wide = reach + 1e-6 / f->scale;
    f->query++;
    g_array_set_size(f->found, 0);
    rows(f, u, v, wide, &j0, &j1);
    for (uint32_t j = j0; j <= j1; j++) {
        row_span(f, u, v, wide, j, &i0, &i1);
        for (uint32_t i = i0; i <= i1; i++)
            for (uint32_t k = f->head[j * f->nx + i]; k != NO_ENTRY; k = g_array_index(f->entry, Entry, k).next) {
                uint32_t edge = g_array_index(f->entry, Entry, k).edge, *seen = &g_array_index(f->seen, uint32_t, edge);
                if (*seen != f->query)
                    g_array_append_val(f->found, edge);
                *seen = f->query;
            }
    }
    *n = f->found->len;
    return (const uint32_t *)(void *)f->found->data;
}

static int side(Vec2 a, Vec2 b, Vec2 c)
{
    double k = vec_cross(vec_sub(b, a), vec_sub(c, a));
    return (k > 0.0) - (k < 0.0);
}

bool field_cross(Vec2 a, Vec2 b, Vec2 c, Vec2 d)
{
    /* Of segments apart on one line the signs would be chance. */
    if (MAX(a.x, b.x) < MIN(c.x, d.x) || MAX(c.x, d.x) < MIN(a.x, b.x) || MAX(a.y, b.y) < MIN(c.y, d.y) || MAX(c.y, d.y) < MIN(a.y, b.y))
        return false;
    return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}
