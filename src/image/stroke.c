#include "image/stroke.h"

#include <glib.h>
#include <stdlib.h>
#include <string.h>

/* A point of a vein's centre line: pixels. `birth` is that of the edge that leaves it. */
typedef struct {
    Vec2 p;
    double r, birth;
} Knot;

typedef struct {
    GArray *knot; /* nodes of one run */
    GArray *apart;  /* from each of them to the next one, pixels */
    GArray *number; /* scratch */
    GArray *line; /* the smooth curve through them, as a polyline */
    GArray *kept; /* indices into line */
    GArray *stack;
    StrokeTolerance tol;
    Strokes *out;
} Builder;

enum { MAX_CUTS = 16 }; /* pieces of the curve between two nodes */

/* Turning shortens a chord; a vein may lose this part of its length, hence of its area, by simplification. */
static const double length_loss = 0.0005;

static Knot *knots(GArray *a)
{
    return (Knot *)(void *)a->data;
}

static double *numbers(GArray *a)
{
    return (double *)(void *)a->data;
}

/* Edges by vein, and along each vein from its origin on: tails grow along a vein. */
static uint32_t *edges_by_vein(const Network *net)
{
    uint32_t n = net->n_edges, *by_tail = g_new(uint32_t, n + 1), *by_vein = g_new(uint32_t, n + 1);
    uint32_t *count = g_new0(uint32_t, MAX(net->n_nodes, net->n_veins) + 2);
    for (uint32_t e = 0; e < n; e++)
        count[net->tail[e] + 1]++;
    for (uint32_t i = 0; i < net->n_nodes; i++)
        count[i + 1] += count[i];
    for (uint32_t e = 0; e < n; e++)
        by_tail[count[net->tail[e]]++] = e;
    memset(count, 0, (net->n_veins + 2) * sizeof *count);
    for (uint32_t e = 0; e < n; e++)
        count[net->vein[e] + 1]++;
    for (uint32_t i = 0; i < net->n_veins; i++)
        count[i + 1] += count[i];
    for (uint32_t i = 0; i < n; i++)
        by_vein[count[net->vein[by_tail[i]]]++] = by_tail[i];
    g_free(by_tail);
    g_free(count);
    return by_vein;
}

static Vec2 to_image(const Frame *f, Vec2 p)
{
    return vec2((p.x - f->corner.x) * f->scale, (f->corner.y - p.y) * f->scale);
}

/* Nodes of the run edge[0 … n-1]. Widths at inner nodes are the mean of the edges', so that veins taper without steps.
 */
static void collect_knots(Builder *b, const Network *net, const Frame *frame, const uint32_t *edge, uint32_t n)
{
    g_array_set_size(b->knot, n + 1);
    g_array_set_size(b->apart, n + 1);
    Knot *k = knots(b->knot);
    for (uint32_t i = 0; i <= n; i++) {
        uint32_t in = edge[i > 0 ? i - 1 : 0], out = edge[i < n ? i : n - 1];
        uint32_t node = i < n ? net->tail[out] : net->head[in];
        k[i] = (Knot){to_image(frame, net->node[node]), 0.25 * frame->scale * (net->width[in] + net->width[out]), net->birth[out]};
        if (i > 0)
            numbers(b->apart)[i - 1] = vec_dist(k[i - 1].p, k[i].p);
    }
}

/* Murray's law makes a vein narrower at once where a branch leaves; in a leaf it takes about a vein's width. So radii
 * are averaged along the vein over `blend` radii to either side, less near its tip, and at its origin over what lies ahead:
 * there several veins may leave at once, and what stands for all of them would be a bulb. sum[i] is the integral of the
 * radius up to knot i, at[i] the arc length. */
static double integral(const double *at, const double *sum, const Knot *k, uint32_t lo, double s)
{
    double d = s - at[lo], step = at[lo + 1] - at[lo], slope = step > 0.0 ? (k[lo + 1].r - k[lo].r) / step : 0.0;
    return sum[lo] + d * (k[lo].r + 0.5 * d * slope);
}

/* The last knot but the very last one that lies no farther than s, near knot `from`. */
static uint32_t knot_before(const double *at, uint32_t n, uint32_t from, double s)
{
    enum { STEPS = 16 };
    uint32_t lo = MIN(from, n - 2), hi, steps = 0;
    while (lo > 0 && at[lo] > s && steps++ < STEPS)
        lo--;
    while (lo + 2 < n && at[lo + 1] <= s && steps++ < STEPS)
        lo++;
    if (steps < STEPS)
        return lo;
    for (lo = 0, hi = n - 1; hi - lo > 1;) {
        uint32_t mid = lo + (hi - lo) / 2;
        if (at[mid] <= s)
            lo = mid;
        else
            hi = mid;
    }
    return lo;
}

static void blend_radii(Builder *b)
{
    static const double blend = 2.5;
    uint32_t n = b->knot->len;
    Knot *k = knots(b->knot);
    const double *apart = numbers(b->apart);
    g_array_set_size(b->number, 3 * n);
    double *at = numbers(b->number), *sum = at + n, *mean = sum + n;
    at[0] = sum[0] = 0.0;
    for (uint32_t i = 1; i < n; i++) {
        at[i] = at[i - 1] + apart[i - 1];
        sum[i] = sum[i - 1] + 0.5 * (at[i] - at[i - 1]) * (k[i - 1].r + k[i].r);
    }
    for (uint32_t i = 0; i < n; i++) {
        double ahead = MIN(blend * k[i].r, at[n - 1] - at[i]), back = MIN(ahead, at[i]), span = ahead + back;
        mean[i] = k[i].r;
        if (span > 0.0) {
            double to = at[i] + ahead, from = at[i] - back;
            mean[i] = (integral(at, sum, k, knot_before(at, n, i, to), to) - integral(at, sum, k, knot_before(at, n, i, from), from)) / span;
        }
    }
    for (uint32_t i = 0; i < n; i++)
        k[i].r = mean[i];
}

/* Slope of the curve at knot i against arc length along the chords; nodes may be unevenly spaced. */
static Vec2 tangent(const Knot *k, const double *apart, uint32_t i, uint32_t last)
{
    uint32_t lo = i > 0 ? i - 1 : 0, hi = i < last ? i + 1 : last;
    double d0 = i > 0 ? apart[lo] : 0.0, d1 = i < last ? apart[i] : 0.0;
    Vec2 v0 = d0 > 0.0 ? vec_scale(vec_sub(k[i].p, k[lo].p), 1.0 / d0) : vec2(0.0, 0.0);
    Vec2 v1 = d1 > 0.0 ? vec_scale(vec_sub(k[hi].p, k[i].p), 1.0 / d1) : vec2(0.0, 0.0);
    if (d0 == 0.0)
        return v1;
    if (d1 == 0.0)
        return v0;
    return vec_scale(vec_add(vec_scale(v0, d1), vec_scale(v1, d0)), 1.0 / (d0 + d1));
}

static Vec2 hermite(Vec2 p, Vec2 m, Vec2 q, Vec2 n, double t)
{
    double u = 1.0 - t, h0 = u * u * (1.0 + 2.0 * t), h1 = t * t * (3.0 - 2.0 * t);
    double g0 = u * u * t, g1 = -t * t * u;
    return vec2(h0 * p.x + g0 * m.x + h1 * q.x + g1 * n.x, h0 * p.y + g0 * m.y + h1 * q.y + g1 * n.y);
}

/* Pieces that keep the polyline within half the tolerance of the curve: its deviation is about |tangent - chord| / 4n².
 */
static uint32_t cuts(const Builder *b, Vec2 chord, Vec2 m0, Vec2 m1)
{
    double bend = MAX(vec_dist(m0, chord), vec_dist(m1, chord)), allowed = 2.0 * b->tol.position;
    uint32_t n = 1;
    while (n < MAX_CUTS && bend > allowed * n * n)
        n++;
    return n;
}

static void smooth(Builder *b)
{
    const Knot *k = knots(b->knot);
    const double *apart = numbers(b->apart);
    uint32_t last = b->knot->len - 1, n_line = 0;
    g_array_set_size(b->line, last * MAX_CUTS + 1);
    Knot *line = knots(b->line);
    Vec2 here = tangent(k, apart, 0, last);
    for (uint32_t i = 0; i < last; i++) {
        double d = apart[i];
        Vec2 next = tangent(k, apart, i + 1, last), m0 = vec_scale(here, d), m1 = vec_scale(next, d);
        uint32_t n = cuts(b, vec_sub(k[i + 1].p, k[i].p), m0, m1);
        for (uint32_t j = 0; j < n; j++) {
            double t = (double)j / n;
            line[n_line++] = (Knot){hermite(k[i].p, m0, k[i + 1].p, m1, t), k[i].r + (k[i + 1].r - k[i].r) * t, k[i].birth};
        }
        here = next;
    }
    line[n_line++] = k[last];
    g_array_set_size(b->line, n_line);
}

/* The point between i and j that a straight piece would miss worst, when it misses one by more than the tolerance; else
 * i. */
static uint32_t worst(const Builder *b, uint32_t i, uint32_t j)
{
    const Knot *k = knots(b->line);
    Vec2 axis = vec_sub(k[j].p, k[i].p);
    double chord2 = vec_norm2(axis), chord = sqrt(chord2), length = 0.0, top = 0.0;
    uint32_t at = i;
    for (uint32_t m = i + 1; m < j; m++) {
        double t = chord2 > 0.0 ? CLAMP(vec_dot(vec_sub(k[m].p, k[i].p), axis) / chord2, 0.0, 1.0) : 0.0;
        double r = k[i].r + (k[j].r - k[i].r) * t, slack = MAX(b->tol.position, b->tol.radius * r);
        double off = vec_dist(k[m].p, vec_lerp(k[i].p, k[j].p, t)) / slack;
        double wide = fabs(k[m].r - r) / (MIN(slack, MAX(b->tol.radius, 0.02) * r) + 1e-9);
        double young = b->tol.radius > 0.0 ? 0.0 : fabs(k[m].birth - (k[i].birth + (k[j - 1].birth - k[i].birth) * t));
        double miss = MAX(MAX(off, wide), young);
        if (miss > top) {
            top = miss;
            at = m;
        }
        length += vec_dist(k[m - 1].p, k[m].p);
    }
    length += vec_dist(k[j - 1].p, k[j].p);
    /* Wider strokes overlap themselves at bends, so length matters less to their area. */
    gboolean shrinks = length - chord > length_loss * length && length - chord > 0.25 * b->tol.radius * k[i].r;
    return top > 1.0 || (shrinks && at != i) ? at : i;
}

static int by_index(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

/* Douglas and Peucker (1973), over position, radius and age at once. */
static void simplify(Builder *b)
{
    uint32_t range[2] = {0, b->line->len - 1};
    g_array_set_size(b->kept, 0);
    g_array_set_size(b->stack, 0);
    g_array_append_vals(b->kept, range, 2);
    g_array_append_vals(b->stack, range, 2);
    while (b->stack->len > 0) {
        uint32_t *top = (uint32_t *)(void *)b->stack->data + b->stack->len - 2, i = top[0], j = top[1];
        g_array_set_size(b->stack, b->stack->len - 2);
        uint32_t m = worst(b, i, j);
        if (m == i)
            continue;
        uint32_t two[4] = {i, m, m, j};
        g_array_append_val(b->kept, m);
        g_array_append_vals(b->stack, two, 4);
    }
    qsort(b->kept->data, b->kept->len, sizeof(uint32_t), by_index);
}

/* Is the part of an end disc of radius r that lies beyond the piece's other end within the disc there? With x >=
 * length, (x - length)² + y² <= x² + y² - length². */
static bool swallows(const Capsule *k, double r, double other)
{
    return other * other >= r * r - k->length * k->length;
}

/* At the joint of two pieces neither need draw the whole disc. The half beyond the first piece lies beside the second's
 * axis, in the second, or beyond its end, in the disc there, for which the same holds; but for a wedge on the outer
 * side of the bend. */
static void join(Stroke *a, Stroke *b)
{
    double r = b->shape.ra;
    if (a->shape.length == 0.0 || b->shape.length == 0.0 || !swallows(&a->shape, r, a->shape.ra) ||
        !swallows(&b->shape, r, b->shape.rb))
        return;
    a->cut |= CUT_B;
    b->cut |= CUT_A;
}

static void emit(Builder *b, uint32_t vein, uint8_t order)
{
    const Knot *k = knots(b->line);
    const uint32_t *at = (const uint32_t *)(void *)b->kept->data;
    Strokes *s = b->out;
    for (uint32_t i = 0; i + 1 < b->kept->len; i++) {
        const Knot *p = &k[at[i]], *q = &k[at[i + 1]];
        if (s->n == s->cap) {
            s->cap = s->cap > 0 ? s->cap * 2 : 1024;
            s->v = g_renew(Stroke, s->v, s->cap);
        }
        s->v[s->n++] = (Stroke){capsule_new(p->p, p->r, q->p, q->r),
                                vein,
                                (float)p->birth,
                                (float)k[at[i + 1] - 1].birth,
                                order,
                                CUT_NONE};
        if (i > 0)
            join(&s->v[s->n - 2], &s->v[s->n - 1]);
    }
}

static void builder_init(Builder *b)
{
    b->knot = g_array_new(FALSE, FALSE, sizeof(Knot));
    b->apart = g_array_new(FALSE, FALSE, sizeof(double));
    b->number = g_array_new(FALSE, FALSE, sizeof(double));
    b->line = g_array_new(FALSE, FALSE, sizeof(Knot));
    b->kept = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    b->stack = g_array_new(FALSE, FALSE, sizeof(uint32_t));
}

static void builder_clear(Builder *b)
{
    g_array_free(b->knot, TRUE);
    g_array_free(b->apart, TRUE);
    g_array_free(b->number, TRUE);
    g_array_free(b->line, TRUE);
    g_array_free(b->kept, TRUE);
    g_array_free(b->stack, TRUE);
}

/* Edges of the run that edge[0] begins. Memory is asked for what comes next, as edges of a vein are born, and lie, far apart. */
static uint32_t run_length(const Network *net, const uint32_t *edge, uint32_t most)
{
    enum { AHEAD = 16 };
    uint32_t n = 0;
    do {
        if (most - n > 2 * AHEAD) {
            uint32_t far = edge[n + 2 * AHEAD], near = edge[n + AHEAD];
            __builtin_prefetch(&net->vein[far]);
            __builtin_prefetch(&net->tail[far]);
            __builtin_prefetch(&net->head[far]);
            __builtin_prefetch(&net->width[far]);
            __builtin_prefetch(&net->node[net->tail[near]]);
        }
        n++;
    } while (n < most && net->vein[edge[n]] == net->vein[edge[0]] && net->tail[edge[n]] == net->head[edge[n - 1]]);
    return n;
}

void strokes_make(const Network *net, const Frame *frame, uint32_t n, const StrokeTolerance *tol, Strokes **out)
{
    uint32_t *edge = edges_by_vein(net);
    Builder b;
    builder_init(&b);
    for (uint32_t k = 0; k < n; k++)
        out[k] = g_new0(Strokes, 1);
    for (uint32_t first = 0, next; first < net->n_edges; first = next) {
        const uint32_t *e = edge + first;
        next = first + run_length(net, e, net->n_edges - first);
        collect_knots(&b, net, frame, e, next - first);
        blend_radii(&b);
        blend_radii(&b);
        for (uint32_t k = 0; k < n; k++) {
            b.tol = tol[k];
            b.out = out[k];
            smooth(&b);
            simplify(&b);
            emit(&b, net->vein[e[0]], net->order[e[0]]);
        }
    }
    builder_clear(&b);
    g_free(edge);
}

Strokes *strokes_new(const Network *net, const Frame *frame, StrokeTolerance tol)
{
    Strokes *out;
    strokes_make(net, frame, 1, &tol, &out);
    return out;
}

void strokes_free(Strokes *s)
{
    if (s == NULL)
        return;
    g_free(s->v);
    g_free(s);
}
