/* Where lines meet: they cross, or an end reaches another line. */
#include "sim/drawing_private.h"

/* ---- crossings ---- */

typedef struct {
    uint32_t line[2];
    double along[2];
    Vec2 p;
} Crossing;

typedef struct {
    const Sketch *s;
    uint32_t piece;
    GArray *found; /* Crossing */
} CrossingSearch;

/* The place, if any, where piece i meets a later piece; ends count. Parallel pieces do not meet: their lines meet elsewhere, or are one. */
static void see_piece(void *user, uint32_t j)
{
    CrossingSearch *q = user;
    const Sketch *s = q->s;
    uint32_t i = q->piece;
    bool neighbours = s->line_of[i] == s->line_of[j] && j == i + 1;
    if (j <= i || neighbours)
        return;
    const Spot *a = &s->spot[i], *c = &s->spot[j];
    Vec2 u = vec_sub(a[1].p, a->p), v = vec_sub(c[1].p, c->p), w = vec_sub(c->p, a->p);
    double area = vec_cross(u, v);
    if (!(area * area > 1e-16 * vec_norm2(u) * vec_norm2(v)))
        return;
    double t = vec_cross(w, v) / area, r = vec_cross(w, u) / area;
    const double slack = 1e-9;
    if (t < -slack || t > 1.0 + slack || r < -slack || r > 1.0 + slack)
        return;
    t = CLAMP(t, 0.0, 1.0);
    r = CLAMP(r, 0.0, 1.0);
    Crossing x = {{s->line_of[i], s->line_of[j]},
                  {a->along + t * (a[1].along - a->along), c->along + r * (c[1].along - c->along)},
                  vec_lerp(a->p, a[1].p, t)};
    g_array_append_val(q->found, x);
}

static GArray *find_crossings(const Sketch *s, const PieceIndex *x)
{
    CrossingSearch q = {s, 0, g_array_new(FALSE, FALSE, sizeof(Crossing))};
    for (uint32_t i = 0; i < s->n_spots; i++)
        if (s->line_of[i] != NONE) {
            q.piece = i;
            Vec2 p = s->spot[i].p, r = s->spot[i + 1].p;
            pieces_visit(x, box_add((Box2){p.x, p.y, p.x, p.y}, r), 0.0, see_piece, &q);
        }
    return q.found;
}

/* What a line sticks out beyond a crossing, and at which end. */
static double stub(const Line *line, double along, int *end)
{
    double before = along - line->end[0], after = line->end[1] - along;
    *end = after < before;
    return MIN(before, after);
}

/* An end that goes past another line by no more than `snap` was meant to end there; of two such the finer line's. */
static void trim_stubs(Sketch *s, const GArray *crossings)
{
    double *to = g_new(double, 2 * (gsize)s->line->len);
    for (uint32_t k = 0; k < s->line->len; k++)
        for (int end = 0; end < 2; end++)
            to[2 * k + end] = LINE(s, k)->end[end];
    for (guint i = 0; i < crossings->len; i++) {
        const Crossing *x = &g_array_index(crossings, Crossing, i);
        int end[2];
        double length[2];
        for (int k = 0; k < 2; k++)
            length[k] = stub(LINE(s, x->line[k]), x->along[k], &end[k]);
        int fine = x->line[0] == x->line[1] ? length[1] < length[0] : x->line[1] > x->line[0];
        int side = length[fine] <= s->snap ? fine : !fine;
        if (length[side] > s->snap)
            continue;
        double *end_at = &to[2 * x->line[side] + end[side]];
        *end_at = end[side] ? MIN(*end_at, x->along[side]) : MAX(*end_at, x->along[side]);
    }
    for (uint32_t k = 0; k < s->line->len; k++)
        for (int end = 0; end < 2; end++)
            LINE(s, k)->end[end] = to[2 * k + end];
    g_free(to);
}

static void add_cut(Sketch *s, uint32_t line, double along, uint32_t node, uint32_t other)
{
    Cut cut = {line, node, other, along};
    g_array_append_val(s->cut, cut);
}

static void keep_crossings(Sketch *s, const GArray *crossings)
{
    const double slack = 1e-9;
    for (guint i = 0; i < crossings->len; i++) {
        const Crossing *x = &g_array_index(crossings, Crossing, i);
        bool left = true;
        for (int k = 0; k < 2; k++) {
            const Line *line = LINE(s, x->line[k]);
            left = left && x->along[k] >= line->end[0] - slack && x->along[k] <= line->end[1] + slack;
        }
        if (!left)
            continue;
        for (int k = 0; k < 2; k++) {
            Line *line = LINE(s, x->line[k]);
            add_cut(s, x->line[k], x->along[k], s->node->len, x->line[!k]);
            for (int end = 0; end < 2; end++)
                line->joined[end] |= fabs(x->along[k] - line->end[end]) < drawing_least;
        }
        g_array_append_val(s->node, x->p);
    }
}

/* ---- ends ---- */

typedef struct {
    uint32_t line;
    int end;
    double dist2;
} End;

static int by_distance(gconstpointer x, gconstpointer y, gpointer user)
{
    const End *a = x, *b = y;
    if (a->dist2 != b->dist2)
        return a->dist2 < b->dist2 ? -1 : 1;
    if (a->line != b->line)
        return a->line < b->line ? -1 : 1;
    return a->end - b->end;
}

/* The cuts of each line, as chains; they grow while ends are joined. */
typedef struct {
    Sketch *s;
    const PieceIndex *x;
    GArray *next;    /* uint32_t, by cut */
    uint32_t *first; /* by line */
} Joining;

static void chain_cuts(Joining *j)
{
    for (uint32_t c = j->next->len; c < j->s->cut->len; c++) {
        uint32_t line = g_array_index(j->s->cut, Cut, c).line;
        g_array_append_val(j->next, j->first[line]);
        j->first[line] = c;
    }
}

/* Does `line` meet `other` (NONE: any) from `lo` to `hi`? */
static bool meets(const Joining *j, uint32_t line, uint32_t other, double lo, double hi)
{
    for (uint32_t c = j->first[line]; c != NONE; c = g_array_index(j->next, uint32_t, c)) {
        const Cut *cut = &g_array_index(j->s->cut, Cut, c);
        if (cut->along >= lo && cut->along <= hi && (other == NONE || cut->other == other))
            return true;
    }
    return false;
}

/* Where it is met near its own end, and nothing is there yet, a line ends: two parts of one vein are joined end to end, though they
 * overlap a little. */
static double end_nearby(const Joining *j, uint32_t k, double along)
{
    Line *line = LINE(j->s, k);
    int end;
    double length = stub(line, along, &end), rest = line->end[1] - line->end[0];
    if (length > 0.5 * j->s->snap || rest < 2.0 * j->s->snap || line->joined[end])
        return along;
    if (meets(j, k, NONE, MIN(along, line->end[end]), MAX(along, line->end[end])))
        return along;
    line->end[end] = along;
    line->joined[end] = true;
    return along;
}

static void join_end(Joining *j, const End *e)
{
    Sketch *s = j->s;
    Line *line = LINE(s, e->line);
    Hit hit;
    if (line->joined[e->end])
        return;
    double from = line->end[e->end], near = 2.0 * s->snap;
    Vec2 p = line_spot(s, line, from).p;
    if (!pieces_nearest(j->x, s, p, s->snap, NONE, e->line, &hit) || meets(j, e->line, hit.line, from - near, from + near))
        return;
    double along = end_nearby(j, hit.line, hit.along);
    line->joined[e->end] = true;
    line->to[e->end] = hit.p;
    line->extra[e->end] = sqrt(hit.dist2);
    add_cut(s, e->line, from + (e->end ? line->extra[1] : -line->extra[0]), s->node->len, hit.line);
    add_cut(s, hit.line, along, s->node->len, e->line);
    g_array_append_val(s->node, hit.p);
    chain_cuts(j);
}

static void join_ends(Sketch *s, const PieceIndex *x)
{
    Joining j = {s, x, g_array_new(FALSE, FALSE, sizeof(uint32_t)), g_new(uint32_t, s->line->len)};
    GArray *ends = g_array_new(FALSE, FALSE, sizeof(End));
    Hit hit;
    for (uint32_t k = 0; k < s->line->len; k++) {
        const Line *line = LINE(s, k);
        j.first[k] = NONE;
        for (int end = 0; end < 2; end++)
            if (!line->joined[end] && pieces_nearest(x, s, line_spot(s, line, line->end[end]).p, s->snap, NONE, k, &hit)) {
                End e = {k, end, hit.dist2};
                g_array_append_val(ends, e);
            }
    }
    chain_cuts(&j);
    if (ends->len > 1)
        g_qsort_with_data(ends->data, (gint)ends->len, sizeof(End), by_distance, NULL);
    for (guint k = 0; k < ends->len; k++)
        join_end(&j, &g_array_index(ends, End, k));
    g_array_unref(ends);
    g_array_unref(j.next);
    g_free(j.first);
}

void sketch_join(Sketch *s)
{
    PieceIndex x;
    pieces_init(&x, s);
    GArray *crossings = find_crossings(s, &x);
    trim_stubs(s, crossings);
    keep_crossings(s, crossings);
    join_ends(s, &x);
    g_array_unref(crossings);
    pieces_clear(&x);
}
