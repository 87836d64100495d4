#include "geom/simplify.h"

/* Whether every point strictly between i and j lies nearer than the tolerance to the line through p[i] and p[j]. */
static bool chord_holds(const Vec2 *p, uint32_t i, uint32_t j, double tolerance)
{
    Vec2 d = vec_sub(p[j], p[i]);
    double length2 = vec_norm2(d), limit2 = tolerance * tolerance;
    bool point = length2 == 0.0;
    for (uint32_t k = j - 1; k > i; k--) { /* backwards: the latest are the likeliest to stray */
        Vec2 q = vec_sub(p[k], p[i]);
        double c = vec_cross(d, q);
        if (point ? !(vec_norm2(q) < limit2) : !(c * c < limit2 * length2))
            return false;
    }
    return true;
}

/* Directions in which a ray passes all points so far by less than the tolerance: counter-clockwise from `right` to `left`, or any. Spares the
 * look at every point where the answer is plain, which makes smooth lines linear. */
typedef struct {
    bool any, none;
    Vec2 right, left;
} Wedge;

static bool wedge_has(const Wedge *w, Vec2 d)
{
    return (w->any && vec_norm2(d) > 0.0) || (!w->any && !w->none && vec_cross(w->right, d) > 0.0 && vec_cross(d, w->left) > 0.0);
}

/* Narrows the wedge to the tangents to the circle of that radius around q. None is wider than a half plane, so what two share is a wedge. */
static void wedge_narrow(Wedge *w, Vec2 q, double radius)
{
    double s2 = vec_norm2(q) - radius * radius;
    if (s2 < 0.0)
        return; /* the origin itself is within */
    double s = sqrt(s2);
    Wedge tangent = {false, false, vec2(q.x * s + q.y * radius, q.y * s - q.x * radius), vec2(q.x * s - q.y * radius, q.y * s + q.x * radius)};
    if (w->any) {
        *w = tangent;
        return;
    }
    bool right_in = wedge_has(w, tangent.right), left_in = wedge_has(w, tangent.left);
    if (!right_in && !left_in && !(wedge_has(&tangent, w->right) && wedge_has(&tangent, w->left)))
        w->none = true;
    w->right = right_in ? tangent.right : w->right;
    w->left = left_in ? tangent.left : w->left;
}

uint32_t simplify_polyline(const Vec2 *p, uint32_t n, double tolerance, const bool *must, uint32_t *keep)
{
    if (n == 0)
        return 0;
    uint32_t kept = 0, i = 0;
    keep[kept++] = 0;
    while (i + 1 < n) {
        uint32_t j = i + 1; /* the end of the longest chord so far; between neighbours there is nothing to stray */
        Wedge w = {.any = true};
        for (; j + 1 < n && !(must && must[j]); j++) {
            wedge_narrow(&w, vec_sub(p[j], p[i]), tolerance * (1.0 - 1e-9)); /* a hair for the rounding: what it passes holds */
            if (!wedge_has(&w, vec_sub(p[j + 1], p[i])) && !chord_holds(p, i, j + 1, tolerance))
                break;
        }
        keep[kept++] = i = j;
    }
    return kept;
}
