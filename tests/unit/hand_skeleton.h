/* Skeletons made by hand, for tests of posing: a pinnate, a palmate and a parallel-veined leaf about 100 segments long, symmetric about
 * x = 0, every edge cut into `cut` equal pieces. */
#ifndef HAND_SKELETON_H
#define HAND_SKELETON_H

#include <glib.h>
#include <string.h>

#include "geom/dtrig.h"
#include "geom/vec3.h"
#include "shape/skeleton.h"

typedef struct {
    GArray *rest, *hinge, *radius, *at, *sequence;
    uint32_t cut;
} Hand;

static inline Hand hand_start(uint32_t cut)
{
    return (Hand){g_array_new(FALSE, FALSE, sizeof(Vec2)), g_array_new(FALSE, FALSE, sizeof(uint32_t)),
                  g_array_new(FALSE, FALSE, sizeof(double)), g_array_new(FALSE, FALSE, sizeof(uint32_t)),
                  g_array_new(FALSE, FALSE, sizeof(Sequence)), cut};
}

static inline uint32_t hand_node(Hand *h, Vec2 p, uint32_t hinge, double radius)
{
    g_array_append_val(h->rest, p);
    g_array_append_val(h->hinge, hinge);
    g_array_append_val(h->radius, radius);
    return h->rest->len - 1;
}

/* A vein along the uncut polyline p[n], from uncut node `start` of the parent; with `root` != NO_PARENT from that node. Returns its number. */
static inline uint32_t hand_vein(Hand *h, uint32_t parent, uint32_t start, uint32_t root, uint8_t order, const char *name, const Vec2 *p,
                                 uint32_t n, double base_radius, double tip_radius)
{
    Sequence s = {.parent = parent, .start = start * h->cut, .first = h->at->len, .n = (n - 1) * h->cut + 1, .order = order,
                  .vein = h->sequence->len, .base_radius = base_radius, .tip_radius = tip_radius};
    g_strlcpy(s.name, name, sizeof s.name);
    uint32_t last = root;
    if (parent != NO_PARENT)
        last = g_array_index(h->at, uint32_t, g_array_index(h->sequence, Sequence, parent).first + s.start);
    else if (root == NO_PARENT)
        last = hand_node(h, p[0], NO_PARENT, base_radius);
    g_array_append_val(h->at, last);
    for (uint32_t k = 1; k < s.n; k++) {
        uint32_t i = (k - 1) / h->cut, j = k - i * h->cut;
        double t = (double)k / (s.n - 1);
        last = hand_node(h, j == h->cut ? p[i + 1] : vec_lerp(p[i], p[i + 1], (double)j / h->cut), last,
                         base_radius + (tip_radius - base_radius) * t);
        g_array_append_val(h->at, last);
    }
    for (uint32_t i = 0; i + 1 < n; i++)
        s.length += vec_dist(p[i], p[i + 1]);
    g_array_append_val(h->sequence, s);
    return h->sequence->len - 1;
}

static inline Skeleton *hand_finish(Hand *h, const Vec2 *outline, uint32_t n)
{
    Skeleton *s = g_new0(Skeleton, 1);
    s->n_nodes = h->rest->len;
    s->n_at = h->at->len;
    s->n_sequences = h->sequence->len;
    s->rest = (Vec2 *)(void *)g_array_free(h->rest, FALSE);
    s->hinge = (uint32_t *)(void *)g_array_free(h->hinge, FALSE);
    s->radius = (double *)(void *)g_array_free(h->radius, FALSE);
    s->at = (uint32_t *)(void *)g_array_free(h->at, FALSE);
    s->sequence = (Sequence *)(void *)g_array_free(h->sequence, FALSE);
    s->vertex = g_new(uint32_t, s->n_nodes);
    for (uint32_t i = 0; i < s->n_nodes; i++)
        s->vertex[i] = NO_PARENT;
    s->outline = n ? polygon_new(outline, n) : NULL;
    return s;
}

static inline void hand_free(Skeleton *s)
{
    if (!s)
        return;
    g_free(s->rest);
    g_free(s->hinge);
    g_free(s->radius);
    g_free(s->vertex);
    g_free(s->at);
    g_free(s->sequence);
    polygon_free(s->outline);
    g_free(s);
}

/* n points of a parabola from a to c that starts towards b. */
static inline void hand_arc(Vec2 a, Vec2 b, Vec2 c, Vec2 *p, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        double t = (double)i / (n - 1);
        p[i] = vec_lerp(vec_lerp(a, b, t), vec_lerp(b, c, t), t);
    }
}

static inline double hand_half_width(double y) { return 34.0 * sqrt(y / 100.0) * (1.0 - (y / 100.0) * (y / 100.0)) / 0.55; }

/* Midrib, `pairs` (up to 16) of secondaries that end within the margin, and two tertiaries on each of the lowest two pairs. */
static inline Skeleton *hand_pinnate(uint32_t pairs, uint32_t cut)
{
    enum { ARC = 7, MIDRIB = 36 };
    Hand h = hand_start(cut);
    Vec2 p[MIDRIB + 1], outline[64];
    uint32_t n = 2 * pairs + 4, edge = 0;
    for (uint32_t i = 0; i <= n; i++)
        p[i] = vec2(0.0, 100.0 * i / n);
    uint32_t midrib = hand_vein(&h, NO_PARENT, 0, NO_PARENT, 1, "midrib", p, n + 1, 0.9, 0.15);
    for (uint32_t k = 0; k < pairs; k++) {
        for (int side = -1; side <= 1; side += 2) {
            double y0 = 100.0 * (2 * k + 1) / n, y1 = y0 + 0.75 * (100.0 - y0) * 0.45 + 4.0, w = 0.93 * hand_half_width(y1);
            char name[16], twig[24];
            g_snprintf(name, sizeof name, "%c%u", side < 0 ? 'L' : 'R', k + 1);
            hand_arc(vec2(0, y0), vec2(0.6 * side * w, y0 + 0.25 * (y1 - y0)), vec2(side * w, y1), p, ARC);
            uint32_t q = hand_vein(&h, midrib, 2 * k + 1, NO_PARENT, 2, name, p, ARC, 0.45 - 0.015 * k, 0.1);
            for (uint32_t j = 0; j < 2 && k < 2; j++) {
                Vec2 a = p[2 + 2 * j], b = vec2(a.x + side * 5.0, a.y - 1.0), c = vec2(a.x + side * 6.0, a.y - 2.5);
                g_snprintf(twig, sizeof twig, "%s.%c%u", name, side < 0 ? 'L' : 'R', j + 1);
                Vec2 arc[4];
                hand_arc(a, b, c, arc, 4);
                hand_vein(&h, q, 2 + 2 * j, NO_PARENT, 3, twig, arc, 4, 0.2, 0.08);
            }
        }
    }
    for (uint32_t i = 1; i < 32; i++)
        outline[edge++] = vec2(hand_half_width(100.0 * i / 32), 100.0 * i / 32);
    outline[edge++] = vec2(0, 100);
    for (uint32_t i = 31; i >= 1; i--)
        outline[edge++] = vec2(-hand_half_width(100.0 * i / 32), 100.0 * i / 32);
    outline[edge++] = vec2(0, 0);
    return hand_finish(&h, outline, edge);
}

/* Five primaries out of one root, three pairs of secondaries on each. */
static inline Skeleton *hand_palmate(uint32_t cut)
{
    static const double degrees[5] = {0, 42, -42, 84, -84}, length[5] = {100, 86, 86, 56, 56};
    static const char *const names[5] = {"midrib", "P2", "P3", "P4", "P5"};
    enum { N = 8, ARC = 5 };
    Hand h = hand_start(cut);
    Vec2 p[N + 1], outline[5 * 7 + 1];
    uint32_t primary[5], edge = 0;
    for (uint32_t k = 0; k < 5; k++) {
        double s = dtrig_sin(degrees[k] * DTRIG_DEGREE), c = dtrig_cos(degrees[k] * DTRIG_DEGREE);
        for (uint32_t i = 0; i <= N; i++) /* left is positive */
            p[i] = vec2(-s * length[k] * i / N, c * length[k] * i / N);
        primary[k] = hand_vein(&h, NO_PARENT, 0, k ? 0 : NO_PARENT, 1, names[k], p, N + 1, 0.8, 0.15);
    }
    static const uint32_t around[5] = {4, 2, 0, 1, 3};
    for (uint32_t a = 0; a < 5; a++) {
        uint32_t k = around[a];
        double s = dtrig_sin(degrees[k] * DTRIG_DEGREE), c = dtrig_cos(degrees[k] * DTRIG_DEGREE), l = length[k];
        Vec2 f = vec2(-s, c), r = vec2(c, s); /* along the primary, to its right */
        static const double at[6] = {0.32, 0.6, 0.85, 0.85, 0.6, 0.32}, wide[6] = {0.12, 0.24, 0.12, -0.12, -0.24, -0.12};
        for (uint32_t i = 0; i < 7; i++) {
            double up = i == 3 ? 1.02 : i < 3 ? at[i] : at[i - 1], out = i == 3 ? 0.0 : i < 3 ? wide[i] : wide[i - 1];
            outline[edge++] = vec_add(vec_scale(f, up * l), vec_scale(r, out * l));
        }
        for (uint32_t i = 0; i < 3; i++) {
            for (int side = -1; side <= 1; side += 2) {
                double from = (double)(2 * i + 2) / N, up = at[i] + 0.12 * (1 - at[i]), out = 0.88 * wide[i] * side;
                char name[16];
                if (k)
                    g_snprintf(name, sizeof name, "%s.%c%u", names[k], side < 0 ? 'L' : 'R', i + 1);
                else
                    g_snprintf(name, sizeof name, "%c%u", side < 0 ? 'L' : 'R', i + 1);
                Vec2 arc[ARC];
                up = up > from + 0.08 ? up : from + 0.08;
                hand_arc(vec_scale(f, from * l), vec_add(vec_scale(f, (0.6 * from + 0.4 * up) * l), vec_scale(r, 0.6 * out * l)),
                         vec_add(vec_scale(f, up * l), vec_scale(r, out * l)), arc, ARC);
                hand_vein(&h, primary[k], 2 * i + 2, NO_PARENT, 2, name, arc, ARC, 0.35, 0.1);
            }
        }
    }
    outline[edge++] = vec2(0, -4);
    return hand_finish(&h, outline, edge);
}

/* A midrib and three primaries on each side along it, each with a root of its own. */
static inline Skeleton *hand_parallel(uint32_t cut)
{
    enum { N = 12 };
    Hand h = hand_start(cut);
    Vec2 p[N + 1], outline[2 * N + 1];
    uint32_t edge = 0;
    for (int k = 0; k < 7; k++) {
        int rank = (k + 1) / 2, side = k % 2 ? 1 : -1;
        double top = 100.0 - 5.0 * rank;
        char name[16];
        for (uint32_t i = 0; i <= N; i++) {
            double t = (double)i / N;
            p[i] = vec2(side * rank * (1.2 + 12.0 * t * (1.0 - t)), top * t);
        }
        g_snprintf(name, sizeof name, k ? "P%d" : "midrib", k + 1);
        hand_vein(&h, NO_PARENT, 0, NO_PARENT, 1, name, p, N + 1, k ? 0.4 : 0.6, 0.1);
    }
    for (int i = 0; i < N; i++)
        outline[edge++] = vec2(4.6 + 46.0 * i / N * (1.0 - (double)i / N) * 0.9 - 4.6 * i / N, 101.0 * i / N);
    outline[edge++] = vec2(0, 101);
    for (int i = N - 1; i >= 0; i--)
        outline[edge++] = vec2(-(4.6 + 46.0 * i / N * (1.0 - (double)i / N) * 0.9 - 4.6 * i / N), 101.0 * i / N);
    return hand_finish(&h, outline, edge);
}

/* The largest distance between the nodes of two poses of one skeleton, one cut `by` times finer than the other. */
static inline double hand_difference(const Skeleton *coarse, const Vec3 *a, const Skeleton *fine, const Vec3 *b, uint32_t by)
{
    double worst = 0.0;
    for (uint32_t q = 0; q < coarse->n_sequences; q++)
        for (uint32_t k = 0; k < coarse->sequence[q].n; k++) {
            uint32_t i = coarse->at[coarse->sequence[q].first + k], j = fine->at[fine->sequence[q].first + k * by];
            double d = vec3_dist(a[i], b[j]);
            worst = d > worst ? d : worst;
        }
    return worst;
}

#endif
