/* Places on lines, and which of them are near. */
#include "sim/drawing_private.h"
#include "geom/segment.h"

Spot line_spot(const Sketch *s, const Line *line, double along)
{
    for (int end = 0; end < 2; end++) {
        double beyond = end ? along - line->end[1] : line->end[0] - along;
        if (line->extra[end] > 0.0 && beyond > 0.0) {
            Spot last = line_spot(s, line, line->end[end]);
            last.p = vec_lerp(last.p, line->to[end], MIN(beyond / line->extra[end], 1.0));
            return last;
        }
    }
    uint32_t lo = line->first, hi = line->last;
    while (hi - lo > 1) {
        uint32_t mid = lo + (hi - lo) / 2;
        *(s->spot[mid].along <= along ? &lo : &hi) = mid;
    }
    const Spot *a = &s->spot[lo], *b = a + 1;
    double t = CLAMP((along - a->along) / (b->along - a->along), 0.0, 1.0);
    return (Spot){vec_lerp(a->p, b->p, t), a->width + (b->width - a->width) * t, along};
}

void pieces_init(PieceIndex *x, const Sketch *s)
{
    *x = (PieceIndex){.middle = g_new(Vec2, s->n_spots)};
    uint32_t *item = g_new(uint32_t, s->n_spots), n = 0;
    for (uint32_t i = 0; i < s->n_spots; i++)
        if (s->line_of[i] != NONE) {
            x->middle[i] = vec_lerp(s->spot[i].p, s->spot[i + 1].p, 0.5);
            item[n++] = i;
        }
    boxtree_build(&x->tree, x->middle, item, n);
    g_free(item);
}

void pieces_clear(PieceIndex *x)
{
    boxtree_clear(&x->tree);
    g_free(x->middle);
}

void pieces_visit(const PieceIndex *x, Box2 box, double r, PieceSeen see, void *user)
{
    const Boxtree *t = &x->tree;
    uint32_t stack[BOXTREE_DEPTH], depth = 0;
    box = box_grow(box, r + 0.500001); /* half a piece */
    if (t->n_nodes)
        stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &t->node[k];
        if (!box_meets(n->box, box))
            continue;
        if (n->right) {
            stack[depth++] = n->right;
            stack[depth++] = k + 1;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++)
            if (box_has(box, x->middle[t->item[i]]))
                see(user, t->item[i]);
    }
}

typedef struct {
    const Sketch *s;
    Vec2 p;
    double most2;
    uint32_t below, except, piece;
    Hit *hit;
} Search;

static void see(void *user, uint32_t i)
{
    Search *q = user;
    uint32_t k = q->s->line_of[i];
    if (k == NONE || k >= q->below || k == q->except)
        return;
    const Line *line = LINE(q->s, k);
    const Spot *a = &q->s->spot[i], *b = a + 1;
    if (b->along < line->end[0] || a->along > line->end[1])
        return;
    double along = a->along + segment_nearest(a->p, b->p, q->p) * (b->along - a->along);
    along = CLAMP(along, line->end[0], line->end[1]);
    Vec2 p = vec_lerp(a->p, b->p, (along - a->along) / (b->along - a->along));
    double d2 = vec_dist2(p, q->p);
    if (d2 > q->most2 || (q->piece != NONE && (d2 > q->hit->dist2 || (d2 == q->hit->dist2 && i > q->piece))))
        return;
    q->piece = i;
    *q->hit = (Hit){k, along, p, d2};
}

bool pieces_nearest(const PieceIndex *x, const Sketch *s, Vec2 p, double r, uint32_t below, uint32_t except, Hit *hit)
{
    Search q = {s, p, r * r, below, except, NONE, hit};
    pieces_visit(x, (Box2){p.x, p.y, p.x, p.y}, r, see, &q);
    return q.piece != NONE;
}
