/* Where the primaries of a palmate leaf meet. Right at the base they are too close to be told apart, and paths leave the midvein with a bend; so
 * each one's beginning is drawn anew, from the point that all of them head for. */
#include <math.h>

#include "scan/found_parts.h"

static const double near_end = 0.05, far_end = 0.11; /* of the length: the run of a primary, by distance from the base, that tells where it heads */
static const double most_shift = 0.045;              /* of the length: farther from the base is no place where a petiole meets the blade */
static const double most_miss = 0.035;               /* of the length: a primary that misses the node by more begins elsewhere */
static const double base_weight = 1.5;                 /* of the base, in lines: they meet in a short bar rather than in a point */
static const double drawn_anew = 0.045;              /* of the length: around the node */
static const double slack = 0.008;                   /* of the length: less than what drawn veins may stick out (sim/drawing.h) */
static const double spacing = 3.0;                   /* of points, working pixels */

typedef struct {
    Vec2 at, along; /* unit */
} Line;

static bool is_primary(const FoundVein *v) { return !v->ghost && v->order == 1; }

static uint32_t first_beyond(const FoundVein *v, Vec2 from, double distance)
{
    uint32_t i = 0;
    while (i < v->n && vec_dist(v->p[i], from) < distance)
        i++;
    return i;
}

/* False for veins that end before. */
static bool heading(const FoundVein *v, Vec2 base, double length, Line *line)
{
    uint32_t a = first_beyond(v, base, near_end * length), b = first_beyond(v, base, far_end * length);
    if (b >= v->n || !(vec_dist2(v->p[a], v->p[b]) > 0.0))
        return false;
    Vec2 d = vec_sub(v->p[b], v->p[a]);
    *line = (Line){v->p[a], vec_scale(d, 1.0 / sqrt(vec_norm2(d)))};
    return true;
}

static double miss(const Line *line, Vec2 q) { return fabs(vec_cross(line->along, vec_sub(q, line->at))); }

/* The point with the least sum of squared distances from the lines and, weighted, from the base. */
static Vec2 meeting(const Line *line, uint32_t n, Vec2 base)
{
    double xx = base_weight, xy = 0.0, yy = base_weight, x = 0.0, y = 0.0;
    for (uint32_t k = 0; k < n; k++) {
        Vec2 normal = vec2(-line[k].along.y, line[k].along.x);
        double off = vec_dot(normal, vec_sub(line[k].at, base));
        xx += normal.x * normal.x;
        xy += normal.x * normal.y;
        yy += normal.y * normal.y;
        x += normal.x * off;
        y += normal.y * off;
    }
    double det = xx * yy - xy * xy; /* positive: at least base_weight squared */
    return vec_add(base, vec2((yy * x - xy * y) / det, (xx * y - xy * x) / det));
}

/* In the blade, or so near to it that it is: the pale pad in which veins meet is often bitten into by the outline. */
static bool on_blade(const FoundLeaf *l, Vec2 q)
{
    int64_t r = (int64_t)floor(slack * l->length), x = (int64_t)floor(q.x), y = (int64_t)floor(q.y), w = l->width, h = l->height;
    for (int64_t j = MAX(0, y - r); j <= MIN(h - 1, y + r); j++)
        for (int64_t i = MAX(0, x - r); i <= MIN(w - 1, x + r); i++)
            if ((i - x) * (i - x) + (j - y) * (j - y) <= r * r && l->inside[j * w + i])
                return true;
    return false;
}

static bool run_on_blade(const FoundLeaf *l, Vec2 a, Vec2 b)
{
    uint32_t n = (uint32_t)ceil(2.0 * vec_dist(a, b)) + 1;
    for (uint32_t k = 0; k <= n; k++)
        if (!on_blade(l, vec_lerp(a, b, (double)k / n)))
            return false;
    return true;
}

/* How the vein heads at a point of it, as long as `length`. */
static Vec2 slope(const FoundVein *v, uint32_t at, double length)
{
    Vec2 d = vec_sub(v->p[MIN(at + 6, v->n - 1)], v->p[at]);
    double n = sqrt(vec_norm2(d));
    return n > 0.0 ? vec_scale(d, length / n) : d;
}

/* On the way from a to b, which begins straight and ends along `end` (a cubic in Hermite's form). */
static Vec2 bent(Vec2 a, Vec2 b, Vec2 end, double t)
{
    Vec2 straight = vec_sub(b, a);
    return vec_add(vec_lerp(a, b, t), vec_scale(vec_sub(end, straight), t * t * (t - 1.0)));
}

/* The vein from its point `keep` on, with a run from the node to it, and before that a straight one from `start`, if given. */
static void redraw(FoundVein *v, uint32_t keep, Vec2 node, const Vec2 *start)
{
    double run = vec_dist(node, v->p[keep]), stub = start ? vec_dist(*start, node) : 0.0;
    uint32_t n_run = MAX(1, (uint32_t)(run / spacing + 0.5)), n_stub = stub > 0.0 ? MAX(1, (uint32_t)(stub / spacing + 0.5)) : 0;
    Vec2 *lead = g_new(Vec2, n_stub + n_run), end = slope(v, keep, run);
    for (uint32_t k = 0; k < n_stub; k++)
        lead[k] = vec_lerp(*start, node, (double)k / n_stub);
    for (uint32_t k = 0; k < n_run; k++)
        lead[n_stub + k] = bent(node, v->p[keep], end, (double)k / n_run);
    found_lead(v, keep, lead, n_stub + n_run);
    g_free(lead);
}

void found_hub(const FoundLeaf *l, FoundVein *vein, uint32_t n, Vec2 base)
{
    Line *line = g_new(Line, n + 1);
    uint32_t *which = g_new(uint32_t, n + 1), m = 0;
    for (uint32_t k = 0; k < n; k++)
        if (is_primary(&vein[k]) && heading(&vein[k], base, l->length, &line[m]))
            which[m++] = k;
    if (m >= 3 && which[0] == 0) {
        Vec2 between = meeting(line, m, base);
        Vec2 node = vec_add(line[0].at, vec_scale(line[0].along, vec_dot(line[0].along, vec_sub(between, line[0].at)))); /* on the midvein */
        for (uint32_t i = 0; i < vein[0].n && !on_blade(l, node); i++)
            node = vein[0].p[i];
        uint32_t keep = first_beyond(&vein[0], node, drawn_anew * l->length);
        while (keep < vein[0].n && vec_dist(vein[0].p[keep], base) < drawn_anew * l->length)
            keep++;
        bool good = vec_dist(node, base) <= most_shift * l->length && keep < vein[0].n &&
                    vec_dist(node, between) < most_miss * l->length && run_on_blade(l, node, vein[0].p[keep]);
        if (good)
            redraw(&vein[0], keep, node, &base);
        for (uint32_t k = 1; good && k < m; k++) {
            FoundVein *v = &vein[which[k]];
            keep = first_beyond(v, node, drawn_anew * l->length);
            if (keep < v->n && miss(&line[k], node) < most_miss * l->length && run_on_blade(l, node, v->p[keep]))
                redraw(v, keep, node, NULL);
        }
    }
    g_free(line);
    g_free(which);
}
