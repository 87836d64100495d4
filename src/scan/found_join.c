/* Where a vein leaves another its pixels and widths are the other's: there it is drawn anew, straight on from where it is by itself back to the other's line. */
#include <math.h>

#include "scan/found_parts.h"

static const double beside = 1.5;      /* working pixels, and half of both widths: nearer to the other's line a vein is not by itself */
static const uint32_t heading_run = 5; /* points that tell where it heads */
static const double most_slant = 3.0;  /* times its distance: farther along its heading it meets the other's line elsewhere */
static const double most_share = 0.34; /* of its points that may be drawn anew */
static const double spacing = 3.0;     /* of points, working pixels */

static Vec2 nearest_on(const FoundVein *v, Vec2 q, double *distance, double *width)
{
    Vec2 best = v->p[0];
    *distance = HUGE_VAL;
    for (uint32_t i = 1; i < v->n; i++) {
        Vec2 d = vec_sub(v->p[i], v->p[i - 1]);
        double n = vec_norm2(d), t = n > 0.0 ? CLAMP(vec_dot(vec_sub(q, v->p[i - 1]), d) / n, 0.0, 1.0) : 0.0;
        Vec2 at = vec_lerp(v->p[i - 1], v->p[i], t);
        if (vec_dist(q, at) < *distance) {
            *distance = vec_dist(q, at);
            *width = v->width[i];
            best = at;
        }
    }
    return best;
}

/* Where the run from a to b first meets the line of a vein. */
static bool meets(const FoundVein *v, Vec2 a, Vec2 b, Vec2 *at)
{
    double first = 2.0;
    Vec2 ab = vec_sub(b, a);
    for (uint32_t i = 1; i < v->n; i++) {
        Vec2 d = vec_sub(v->p[i], v->p[i - 1]), off = vec_sub(v->p[i - 1], a);
        double det = vec_cross(ab, d), t = vec_cross(off, d), u = vec_cross(off, ab);
        if (!(fabs(det) > 0.0))
            continue;
        t /= det;
        u /= det;
        if (t >= 0.0 && t <= 1.0 && u >= 0.0 && u <= 1.0)
            first = MIN(first, t);
    }
    *at = vec_lerp(a, b, first);
    return first <= 1.0;
}

/* Its points from `keep` on, with a straight run from `start` to them. */
static void begin_at(FoundVein *v, Vec2 start, uint32_t keep)
{
    uint32_t run = MAX(1, (uint32_t)(vec_dist(start, v->p[keep]) / spacing + 0.5));
    Vec2 *lead = g_new(Vec2, run);
    for (uint32_t k = 0; k < run; k++)
        lead[k] = vec_lerp(start, v->p[keep], (double)k / run);
    found_lead(v, keep, lead, run);
    g_free(lead);
}

static void join(FoundVein *v, const FoundVein *parent)
{
    uint32_t keep = 0, most = (uint32_t)(most_share * v->n);
    double distance, width;
    Vec2 at = nearest_on(parent, v->p[0], &distance, &width), ahead;
    if (!(distance > 0.0) || v->n < 2 * heading_run)
        return;
    while (keep < most && (nearest_on(parent, v->p[keep], &distance, &width), distance < beside + 0.5 * (width + v->width[keep])))
        keep++;
    if (keep == most) {
        v->p[0] = at;
        return;
    }
    Vec2 foot = nearest_on(parent, v->p[keep], &distance, &width), back = vec_sub(v->p[keep], v->p[MIN(keep + heading_run, v->n - 1)]);
    double length = sqrt(vec_norm2(back));
    if (length > 0.0 && meets(parent, v->p[keep], vec_add(v->p[keep], vec_scale(back, most_slant * distance / length)), &ahead))
        foot = ahead;
    begin_at(v, foot, keep);
}

/* No vein is wider than the one it leaves is there: where two run side by side both may be measured as one. */
static void cap(FoundVein *v, const FoundVein *parent)
{
    double distance, most = HUGE_VAL;
    nearest_on(parent, v->p[0], &distance, &most);
    for (uint32_t i = 0; i < v->n; i++)
        v->width[i] = MIN(v->width[i], most);
}

static bool leaves_another(const FoundVein *vein, uint32_t k) { return !vein[k].ghost && vein[k].parent != k && !vein[vein[k].parent].ghost; }

void found_join(FoundVein *vein, uint32_t n)
{
    for (uint32_t k = 1; k < n; k++)
        if (leaves_another(vein, k))
            join(&vein[k], &vein[vein[k].parent]);
    for (uint32_t order = 2, more = 1; more; order++) { /* parents first */
        more = 0;
        for (uint32_t k = 1; k < n; k++) {
            more += vein[k].order > order;
            if (vein[k].order == order && leaves_another(vein, k))
                cap(&vein[k], &vein[vein[k].parent]);
        }
    }
}
