/* Where the middle of a petiole meets the blade, when the mask has only one side of it. */
#include <math.h>

#include "scan/stalk.h"

static const double near = 2.0;   /* widths from the base: pixels that tell how it sets out */
static const double from = 0.6, to = 3.0; /* widths from the base: sections, where it has left the blade */
static const double most = 4.0;   /* widths, to one side: of a pale one the mask has a thin shadow */
static const double wider = 1.25; /* times the mask's width: what is seen of a petiole of which that has but one side */
static const double slit = 0.25;  /* of a width: less of no plant is no border */
enum { SECTIONS = 9 };

/* Middle of the petiole's pixels around its base. */
static bool setting_out(const Mask *w, const Stalk *s, Vec2 *out)
{
    double r = near * s->width, n = 0.0;
    Vec2 sum = vec2(0.0, 0.0);
    for (double y = MAX(0.0, floor(s->base.y - r)); y <= MIN(w->height - 1.0, s->base.y + r); y += 1.0)
        for (double x = MAX(0.0, floor(s->base.x - r)); x <= MIN(w->width - 1.0, s->base.x + r); x += 1.0)
            if ((*mask_at(w, (uint32_t)x, (uint32_t)y) & MASK_STALK) && vec_dist(vec2(x, y), s->base) <= r) {
                sum = vec_add(sum, vec2(x, y));
                n += 1.0;
            }
    *out = vec_sub(vec_scale(sum, n > 0.0 ? 1.0 / n : 0.0), s->base);
    double length = sqrt(vec_norm2(*out));
    if (n == 0.0 || !(length > 0.0))
        return false;
    *out = vec_scale(*out, 1.0 / length);
    return true;
}

/* How far it reaches to a side, from a point on it; negative when it doesn't end. */
static double reach(const Mask *w, Vec2 q, Vec2 side, double width, bool (*plant)(const void *, uint32_t, uint32_t), const void *user)
{
    double last = 0.0;
    for (double t = 0.0; t <= most * width; t += 0.5) {
        Vec2 p = vec_add(q, vec_scale(side, t));
        bool in = p.x > -0.5 && p.y > -0.5 && p.x < w->width - 0.5 && p.y < w->height - 0.5;
        if (in && plant(user, (uint32_t)(p.x + 0.5), (uint32_t)(p.y + 0.5)))
            last = t;
        else if (t - last > slit * width)
            return last;
    }
    return -1.0;
}

static gint by_value(gconstpointer a, gconstpointer b, gpointer user)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

Vec2 stalk_middle(const Mask *w, const Stalk *s, bool (*plant)(const void *user, uint32_t x, uint32_t y), const void *user)
{
    Vec2 out;
    double off[SECTIONS];
    uint32_t n = 0;
    if (!setting_out(w, s, &out))
        return s->base;
    Vec2 side = vec2(-out.y, out.x);
    for (uint32_t k = 0; k < SECTIONS; k++) {
        Vec2 q = vec_add(s->base, vec_scale(out, s->width * (from + (to - from) * k / (SECTIONS - 1))));
        double a = reach(w, q, side, s->width, plant, user), b = reach(w, q, vec_scale(side, -1.0), s->width, plant, user);
        if (a >= 0.0 && b >= 0.0 && a + b > wider * s->width)
            off[n++] = 0.5 * (a - b);
    }
    if (2 * n <= SECTIONS)
        return s->base;
    g_qsort_with_data(off, (gint)n, sizeof *off, by_value, NULL);
    return vec_add(s->base, vec_scale(side, off[n / 2]));
}
