#include "sim/faces.h"

#include <glib.h>
#include <string.h>

#include "geom/turn.h"

/* The walk with the face to the left goes on from the head of a half-edge with the next one clockwise from the way back. */
typedef struct {
    const EdgeOrder *o;
    uint32_t n_half;
    uint32_t *first;  /* [nodes + 1] into around */
    uint32_t *around; /* half-edges that leave a node, counter-clockwise */
    uint32_t *next;   /* [half-edges] */
    uint32_t *mark;   /* [half-edges] */
} Tracer;

static inline uint32_t tail_of(const EdgeOrder *o, uint32_t h) { return o->edge[h / 2][h % 2]; }
static inline uint32_t head_of(const EdgeOrder *o, uint32_t h) { return o->edge[h / 2][1 - h % 2]; }

/* ---- what follows what ---- */

static void list_around(Tracer *t)
{
    uint32_t *first = t->first = g_new0(uint32_t, (gsize)t->o->n_nodes + 2);
    t->around = g_new(uint32_t, (gsize)t->n_half + 1);
    first++; /* moves on while nodes fill, and then is what it should be */
    for (uint32_t h = 0; h < t->n_half; h++)
        first[tail_of(t->o, h) + 1]++;
    for (uint32_t v = 0; v < t->o->n_nodes; v++)
        first[v + 1] += first[v];
    for (uint32_t h = 0; h < t->n_half; h++)
        t->around[first[tail_of(t->o, h)]++] = h;
}

static int by_angle(gconstpointer x, gconstpointer y, gpointer user)
{
    const EdgeOrder *o = user;
    uint32_t h = *(const uint32_t *)x, k = *(const uint32_t *)y;
    Vec2 q = o->node[tail_of(o, h)], a = o->node[head_of(o, h)], b = o->node[head_of(o, k)];
    return turn_before(q, a, b) ? -1 : turn_before(q, b, a) ? 1 : (h > k) - (h < k);
}

/* Nearly all nodes have two or three edges; around two, either order is the same. */
static void sort_around(const Tracer *t, uint32_t *h, uint32_t n)
{
    enum { FEW = 8 };
    gpointer order = (gpointer)(gintptr)t->o;
    if (n > FEW)
        g_qsort_with_data(h, (gint)n, sizeof *h, by_angle, order);
    else if (n > 2)
        for (uint32_t i = 1; i < n; i++)
            for (uint32_t j = i; j > 0 && by_angle(&h[j - 1], &h[j], order) > 0; j--) {
                uint32_t swap = h[j];
                h[j] = h[j - 1];
                h[j - 1] = swap;
            }
}

/* Links what leaves a node, but for bridges, to what arrives there. */
static void link_node(Tracer *t, uint32_t v)
{
    uint32_t last = FACE_NONE, from = t->first[v], to = t->first[v + 1];
    for (uint32_t i = to; i-- > from && last == FACE_NONE;)
        if (t->mark[t->around[i]] != FACE_BRIDGE)
            last = t->around[i];
    for (uint32_t i = from; i < to; i++) {
        uint32_t h = t->around[i];
        if (t->mark[h] == FACE_BRIDGE)
            continue;
        t->next[h ^ 1u] = last;
        last = h;
    }
}

/* ---- walks ---- */

/* Marks each half-edge with the walk it is of. */
static void mark_walks(Tracer *t)
{
    uint32_t n = 0;
    for (uint32_t from = 0; from < t->n_half; from++) {
        if (t->mark[from] != FACE_NONE)
            continue;
        uint32_t h = from;
        do {
            t->mark[h] = n;
            h = t->next[h];
        } while (h != from);
        n++;
    }
}

/* Takes away the edges that have one face on both sides. */
static void drop_bridges(Tracer *t)
{
    for (uint32_t h = 0; h < t->n_half; h += 2)
        t->mark[h] = t->mark[h + 1] = t->mark[h] == t->mark[h + 1] ? FACE_BRIDGE : FACE_NONE;
}

/* The area by the way's turns about its first node. */
static double area_of(const Faces *f, const Walk *w)
{
    const Vec2 *node = f->order->node, o = node[face_node(f, w, 0)];
    Vec2 from = vec_sub(o, o);
    double sum = 0.0;
    for (uint32_t i = 1; i <= w->n; i++) {
        Vec2 to = vec_sub(node[face_node(f, w, i < w->n ? i : 0)], o);
        sum += vec_cross(from, to);
        from = to;
    }
    return 0.5 * sum;
}

/* The walk on which half-edge `from` lies, whose nodes are put behind those of the ones before. */
static Walk trace(const Tracer *t, Faces *f, uint32_t from, uint32_t number, uint32_t first)
{
    const uint32_t *was = t->o->was;
    Walk w = {.first = first, .number = number, .rank = G_MAXUINT64};
    uint32_t h = from, tail = tail_of(t->o, from), old = was[tail];
    do {
        uint32_t head = head_of(t->o, h), ahead = was[head];
        uint64_t rank = (uint64_t)old << 32 | ahead;
        t->mark[h] = number;
        f->tail[first + w.n] = tail;
        if (rank < w.rank) {
            w.rank = rank;
            w.start = w.n;
        }
        w.n++;
        tail = head;
        old = ahead;
        h = t->next[h];
    } while (h != from);
    w.area = area_of(f, &w);
    return w;
}

static int by_rank(gconstpointer x, gconstpointer y, gpointer user)
{
    const Walk *a = x, *b = y;
    return (a->rank > b->rank) - (a->rank < b->rank);
}

/* Walks are traced in the order that edges have here, and come in that of the planar graph. */
static void trace_all(const Tracer *t, Faces *f)
{
    GArray *all = g_array_new(FALSE, FALSE, sizeof(Walk));
    uint32_t first = 0;
    for (uint32_t h = 0; h < t->n_half; h++) {
        if (t->mark[h] != FACE_NONE)
            continue;
        Walk w = trace(t, f, h, all->len, first);
        g_array_append_val(all, w);
        first += w.n;
    }
    if (all->len > 0)
        g_qsort_with_data(all->data, (gint)all->len, sizeof(Walk), by_rank, NULL);
    f->n_walks = all->len;
    f->walk = (Walk *)(void *)g_array_free(all, FALSE);
    f->rank = g_new(uint32_t, (gsize)f->n_walks + 1);
    for (uint32_t k = 0; k < f->n_walks; k++)
        f->rank[f->walk[k].number] = k;
}

void faces_init(Faces *f, const EdgeOrder *order)
{
    Tracer t = {.o = order, .n_half = 2 * order->n_edges};
    *f = (Faces){.order = order, .tail = g_new(uint32_t, (gsize)t.n_half + 1), .mark = g_new(uint32_t, (gsize)t.n_half + 1)};
    t.mark = f->mark;
    t.next = g_new(uint32_t, (gsize)t.n_half + 1);
    memset(t.mark, 0xFF, (gsize)t.n_half * sizeof *t.mark);
    list_around(&t);
    for (uint32_t v = 0; v < order->n_nodes; v++) {
        sort_around(&t, t.around + t.first[v], t.first[v + 1] - t.first[v]);
        link_node(&t, v);
    }
    mark_walks(&t);
    drop_bridges(&t);
    for (uint32_t v = 0; v < order->n_nodes; v++)
        link_node(&t, v);
    g_free(t.first);
    g_free(t.around);
    trace_all(&t, f);
    g_free(t.next);
}

void faces_clear(Faces *f)
{
    g_free(f->tail);
    g_free(f->mark);
    g_free(f->walk);
    g_free(f->rank);
}
