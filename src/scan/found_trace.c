/* From chains of pixels to smooth lines along the middle of the ridge, with widths. */
#include <math.h>
#include <string.h>

#include "scan/convolve.h"
#include "scan/found_parts.h"

static const double spacing = 3.0;        /* of points, working pixels */
static const double chain_smoothing = 2.5; /* sigma, points: of what the steps of the pixels leave */
static const double shift_smoothing = 1.5; /* sigma, points: of what is added to follow the ridge */
enum { PROFILE = 24 };                    /* samples to each side */
static const double profile_step = 0.5;   /* working pixels */

static double sample(const GreyImage *g, Vec2 q)
{
    double x = q.x - 0.5, y = q.y - 0.5;
    int64_t i = (int64_t)floor(x), j = (int64_t)floor(y);
    double fx = x - (double)i, fy = y - (double)j;
    double a = (double)g->px[grey_index(g, i, j)], b = (double)g->px[grey_index(g, i + 1, j)];
    double c = (double)g->px[grey_index(g, i, j + 1)], d = (double)g->px[grey_index(g, i + 1, j + 1)];
    return (a + (b - a) * fx) * (1.0 - fy) + (c + (d - c) * fx) * fy;
}

/* Smooths along an open line; the ends are mirrored in themselves, so that they stay. */
static void smooth_points(Vec2 *p, uint32_t n, double sigma)
{
    Kernel k = kernel_gaussian(sigma, 3.0);
    Vec2 *q = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t r = MIN(k.r, MIN(i, n - 1 - i));
        double total = k.w[0];
        q[i] = vec_scale(p[i], k.w[0]);
        for (uint32_t j = 1; j <= r; j++) {
            q[i] = vec_add(q[i], vec_scale(vec_add(p[i - j], p[i + j]), k.w[j]));
            total += 2.0 * k.w[j];
        }
        q[i] = vec_scale(q[i], 1.0 / total);
    }
    memcpy(p, q, n * sizeof *p);
    g_free(q);
    kernel_clear(&k);
}

static Vec2 *resample(const Vec2 *p, uint32_t n, double step, uint32_t *m)
{
    double length = 0.0, at = 0.0;
    for (uint32_t i = 1; i < n; i++)
        length += vec_dist(p[i - 1], p[i]);
    *m = MAX(2, (uint32_t)(length / step + 0.5) + 1);
    Vec2 *q = g_new(Vec2, *m);
    q[0] = p[0];
    uint32_t i = 1;
    for (uint32_t k = 1; k + 1 < *m; k++) {
        double want = length * k / (*m - 1);
        while (i + 1 < n && at + vec_dist(p[i - 1], p[i]) < want) {
            at += vec_dist(p[i - 1], p[i]);
            i++;
        }
        double d = vec_dist(p[i - 1], p[i]);
        q[k] = vec_lerp(p[i - 1], p[i], d > 0.0 ? MIN(1.0, (want - at) / d) : 0.0);
    }
    q[*m - 1] = p[n - 1];
    return q;
}

static Vec2 normal_at(const Vec2 *p, uint32_t n, uint32_t i)
{
    uint32_t a = i >= 2 ? i - 2 : 0, b = MIN(n - 1, i + 2);
    Vec2 t = vec_sub(p[b], p[a]);
    double length = sqrt(vec_norm2(t));
    return length > 0.0 ? vec2(-t.y / length, t.x / length) : vec2(0, 0);
}

typedef struct {
    double v[2 * PROFILE + 1];
} Across;

/* Light across the line at each point, averaged with that at some points before and after it. */
static Across *profiles(const GreyImage *light, const Vec2 *p, uint32_t n)
{
    Across *raw = g_new(Across, n), *mean = g_new(Across, n);
    for (uint32_t i = 0; i < n; i++) {
        Vec2 normal = normal_at(p, n, i);
        for (int32_t k = -PROFILE; k <= PROFILE; k++)
            raw[i].v[k + PROFILE] = sample(light, vec_add(p[i], vec_scale(normal, k * profile_step)));
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t a = i >= 3 ? i - 3 : 0, b = MIN(n - 1, i + 3);
        for (uint32_t k = 0; k <= 2 * PROFILE; k++) {
            double sum = 0.0;
            for (uint32_t j = a; j <= b; j++)
                sum += raw[j].v[k];
            mean[i].v[k] = sum / (b - a + 1);
        }
    }
    g_free(raw);
    return mean;
}

/* Where a flank falls to `level`, from the peak outward, in samples from the middle; the end when it doesn't within `most`. */
static double flank(const Across *a, int32_t peak, int32_t way, int32_t most, double level)
{
    for (int32_t k = peak + way; way * (k - peak) <= most && k >= 0 && k <= 2 * PROFILE; k += way)
        if (a->v[k] < level) {
            double inner = a->v[k - way], t = inner > a->v[k] ? (inner - level) / (inner - a->v[k]) : 0.0;
            return k - way + way * t - PROFILE;
        }
    return peak + way * most - PROFILE;
}

/* Middle and full width at half height of the ridge nearest the line; width 0 when there is none. Reach: how far it may lie off. */
static void measure(const Across *a, double scale, double *middle, double *width, double *height)
{
    int32_t near = (int32_t)(MAX(0.6 * scale, 2.5) / profile_step), far = MIN(PROFILE, (int32_t)(1.5 * scale / profile_step) + 3), peak = PROFILE;
    for (int32_t k = PROFILE - near; k <= PROFILE + near; k++)
        if (a->v[k] > a->v[peak])
            peak = k;
    double left = a->v[peak], right = a->v[peak];
    for (int32_t k = peak; k >= MAX(0, peak - far); k--)
        left = MIN(left, a->v[k]);
    for (int32_t k = peak; k <= MIN(2 * PROFILE, peak + far); k++)
        right = MIN(right, a->v[k]);
    double ground = MAX(left, right), level = 0.5 * (a->v[peak] + ground);
    *middle = *width = *height = 0.0;
    if (!(a->v[peak] > ground))
        return;
    double from = flank(a, peak, -1, far, level), to = flank(a, peak, 1, far, level);
    *middle = 0.5 * (from + to) * profile_step;
    *width = (to - from) * profile_step;
    *height = a->v[peak] - ground;
}

static int by_value(const void *a, const void *b, void *user)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* The middle one of up to nine neighbours, so that where another vein leaves doesn't show. */
static void median_filter(double *w, uint32_t n)
{
    double *out = g_new(double, n), box[9];
    for (uint32_t i = 0; i < n; i++) {
        uint32_t r = MIN(4, MIN(i, n - 1 - i)), a = i - r, m = 2 * r + 1;
        memcpy(box, w + a, m * sizeof *box);
        g_qsort_with_data(box, (gint)m, sizeof *box, by_value, NULL);
        out[i] = box[m / 2];
    }
    memcpy(w, out, n * sizeof *w);
    g_free(out);
}

static bool unseen(const FoundLeaf *l, Vec2 q)
{
    if (!(q.x >= 0.0 && q.y >= 0.0 && q.x < l->width && q.y < l->height))
        return true;
    gsize i = (gsize)q.y * l->width + (gsize)q.x;
    return !l->inside[i] || l->hole[i];
}

/* Straight over holes, from where it is last seen to where it is seen again, and as wide as the ends are; where it isn't seen again it tapers to half. */
static void bridge(const FoundLeaf *l, FoundVein *v)
{
    for (uint32_t i = 1, end; i < v->n; i = end + 1) {
        for (end = i; end < v->n && unseen(l, v->p[end]); end++)
            ;
        for (uint32_t k = i; end < v->n && k < end; k++) {
            double t = (double)(k - i + 1) / (end - i + 1);
            v->p[k] = vec_lerp(v->p[i - 1], v->p[end], t);
            v->width[k] = v->width[i - 1] + (v->width[end] - v->width[i - 1]) * t;
        }
        for (uint32_t k = i; end == v->n && k < end; k++)
            v->width[k] = v->width[i - 1] * (1.0 - 0.5 * (k - i + 1) / (end - i));
    }
}

void found_trace(const FoundLeaf *l, const FoundRidges *r, FoundVein *v)
{
    Vec2 *chain = g_new(Vec2, v->n_pixels);
    for (uint32_t i = 0; i < v->n_pixels; i++)
        chain[i] = vec2(v->pixel[i] % l->width + 0.5, v->pixel[i] / l->width + 0.5);
    v->p = resample(chain, v->n_pixels, spacing, &v->n);
    smooth_points(v->p, v->n, chain_smoothing);
    v->width = g_new0(double, v->n);
    Vec2 *shift = g_new0(Vec2, v->n);
    double sum = 0.0, n_seen = 0.0;
    for (uint32_t pass = 0; pass < 2; pass++) {
        Across *a = profiles(r->light, v->p, v->n);
        for (uint32_t i = 0; i < v->n; i++) {
            double scale = sample(r->width, v->p[i]) / l->step, middle, height;
            scale = CLAMP(scale, 2.0, PROFILE * profile_step / 1.6);
            measure(&a[i], scale, &middle, &v->width[i], &height);
            bool counts = pass == 1 && !unseen(l, v->p[i]);
            sum += counts ? height : 0.0;
            n_seen += counts;
            if (v->width[i] == 0.0)
                v->width[i] = scale;
            shift[i] = vec_scale(normal_at(v->p, v->n, i), CLAMP(middle, -0.5 * scale - 1.0, 0.5 * scale + 1.0));
        }
        shift[0] = shift[v->n - 1] = vec2(0, 0);
        smooth_points(shift, v->n, shift_smoothing);
        for (uint32_t i = 0; i < v->n; i++)
            v->p[i] = vec_add(v->p[i], shift[i]);
        g_free(a);
    }
    v->contrast = sum / MAX(n_seen, 1.0) / r->noise;
    median_filter(v->width, v->n);
    bridge(l, v);
    g_free(shift);
    g_free(chain);
}

void found_lead(FoundVein *v, uint32_t keep, const Vec2 *lead, uint32_t n)
{
    uint32_t kept = v->n - keep;
    Vec2 *p = g_new(Vec2, n + kept);
    double *w = g_new(double, n + kept);
    for (uint32_t k = 0; k < n; k++) {
        p[k] = lead[k];
        w[k] = v->width[keep];
    }
    memcpy(p + n, v->p + keep, kept * sizeof *p);
    memcpy(w + n, v->width + keep, kept * sizeof *w);
    g_free(v->p);
    g_free(v->width);
    v->p = p;
    v->width = w;
    v->n = n + kept;
}
