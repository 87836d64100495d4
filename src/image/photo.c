#include "image/photo.h"

#include "geom/dmath.h"

Photo *photo_new(const Scan *scan, const Affine *to_scan, const float tint[3])
{
    Photo *p = g_new0(Photo, 1);
    uint32_t levels = 1u << scan->depth;
    p->scan = scan;
    p->to_scan = *to_scan;
    p->linear = g_new(float, levels);
    for (int i = 0; i < 3; i++)
        p->tint[i] = tint[i];
    for (uint32_t i = 0; i < levels; i++) { /* sRGB, IEC 61966-2-1 */
        double c = (double)i / (levels - 1);
        p->linear[i] = (float)(c <= 0.04045 ? c / 12.92 : dmath_pow((c + 0.055) / 1.055, 2.4));
    }
    return p;
}

void photo_free(Photo *p)
{
    if (!p)
        return;
    g_free(p->linear);
    g_free(p);
}

double photo_scale(const Photo *p)
{
    const Affine *m = &p->to_scan;
    return sqrt(fabs(m->a * m->d - m->b * m->c));
}

/* Between the four pixels around, whose centres are at halves. */
static void add_bilinear(const Photo *p, Vec2 at, double weight, double sum[3])
{
    const Scan *s = p->scan;
    double x = CLAMP(at.x - 0.5, 0.0, s->width - 1.0), y = CLAMP(at.y - 0.5, 0.0, s->height - 1.0);
    uint32_t i = (uint32_t)x, j = (uint32_t)y, i1 = MIN(i + 1, s->width - 1), j1 = MIN(j + 1, s->height - 1);
    double fx = x - i, fy = y - j;
    for (uint32_t c = 0; c < 3; c++) {
        uint32_t k = s->channels >= 3 ? c : 0;
        double top = (double)p->linear[scan_sample(s, i, j, k)] * (1.0 - fx) + (double)p->linear[scan_sample(s, i1, j, k)] * fx;
        double low = (double)p->linear[scan_sample(s, i, j1, k)] * (1.0 - fx) + (double)p->linear[scan_sample(s, i1, j1, k)] * fx;
        sum[c] += weight * (top * (1.0 - fy) + low * fy);
    }
}

void photo_colour(const Photo *p, Vec2 at, double size, float out[3])
{
    enum { MOST = 32 };
    double sum[3] = {0.0, 0.0, 0.0};
    uint32_t n = (uint32_t)CLAMP(ceil(size * photo_scale(p)), 1.0, (double)MOST); /* samples a side: one a pixel */
    for (uint32_t j = 0; j < n; j++)
        for (uint32_t i = 0; i < n; i++) {
            Vec2 q = vec2(at.x + size * ((i + 0.5) / n - 0.5), at.y + size * ((j + 0.5) / n - 0.5));
            add_bilinear(p, affine_apply(&p->to_scan, q), 1.0 / ((double)n * n), sum);
        }
    for (int c = 0; c < 3; c++)
        out[c] = (float)MIN(sum[c] * (double)p->tint[c], 1.0);
}
