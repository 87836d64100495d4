#include "scan/fang_outline.h"

#include <math.h>

#include "geom/bezier.h"

#define FLATNESS 0.1

/* A fit as a closed chain of chords; edge i of it, from vertex i on, belongs to piece owner[i]. */
typedef struct {
    GArray *v;     /* Vec2 */
    GArray *owner; /* uint32_t */
} Chain;

static uint32_t edges_of(const Polygon *contour, const BezierPiece *c)
{
    return c->to > c->from ? c->to - c->from : c->to + contour->n - c->from;
}

/* Adds a chord from p on; one of no length is left out. */
static void add_chord(Chain *c, Vec2 p, Vec2 to, uint32_t owner)
{
    if (!(vec_dist2(p, to) > 0.0))
        return;
    g_array_append_val(c->v, p);
    g_array_append_val(c->owner, owner);
}

static void add_piece(Chain *c, const BezierPiece *piece, uint32_t owner, GArray *way)
{
    Curve curve = {{piece->p[0], piece->p[1], piece->p[2], piece->p[3]}, false};
    Vec2 p = piece->p[0];
    g_array_set_size(way, 0);
    curve_flatten(&curve, FLATNESS, way);
    for (guint k = 0; k < way->len; k++) {
        Vec2 to = g_array_index(way, Vec2, k);
        add_chord(c, p, to, owner);
        p = to;
    }
}

static void add_contour(Chain *c, const Polygon *contour, const BezierPiece *piece, uint32_t owner)
{
    uint32_t n = contour->n, last = edges_of(contour, piece);
    for (uint32_t k = 0; k < last; k++)
        add_chord(c, contour->v[(piece->from + k) % n], contour->v[(piece->from + k + 1) % n], owner);
}

/* The fit, with the contour itself in place of the pieces that are marked. */
static void draw(Chain *c, const Polygon *contour, const BezierFit *fit, const bool *marked)
{
    g_array_set_size(c->v, 0);
    g_array_set_size(c->owner, 0);
    GArray *way = g_array_new(FALSE, FALSE, sizeof(Vec2));
    for (uint32_t k = 0; k < fit->n; k++)
        if (marked[k])
            add_contour(c, contour, &fit->piece[k], k);
        else
            add_piece(c, &fit->piece[k], k, way);
    g_array_unref(way);
}

static double signed_area(const GArray *points)
{
    const Vec2 *v = (const Vec2 *)(const void *)points->data;
    double twice = 0.0;
    for (guint i = 1; i + 1 < points->len; i++)
        twice += vec_cross(vec_sub(v[i], v[0]), vec_sub(v[i + 1], v[0]));
    return 0.5 * twice;
}

/* A chain as a polygon when it is simple and counter-clockwise. Else NULL, and the pieces that clash are marked: those that own the two
 * edges, or all. */
static Polygon *polygon_or_mark(const Chain *c, const BezierFit *fit, bool *marked)
{
    uint32_t i, j;
    if (c->v->len >= 3 && signed_area(c->v) > 0.0) {
        Polygon *p = polygon_new((const Vec2 *)(const void *)c->v->data, c->v->len);
        if (!polygon_crossing(p, &i, &j))
            return p;
        polygon_free(p);
        uint32_t a = g_array_index(c->owner, uint32_t, i), b = g_array_index(c->owner, uint32_t, j);
        g_assert(!marked[a] || !marked[b]); /* the contour is simple */
        marked[a] = marked[b] = true;
    } else {
        for (uint32_t k = 0; k < fit->n; k++)
            marked[k] = true;
    }
    return NULL;
}

/* Makes pieces along single edges straight. */
static void straighten(const Polygon *contour, BezierFit *fit)
{
    double whole = 0.0, sum = 0.0;
    fit->largest = 0.0;
    for (uint32_t k = 0; k < fit->n; k++) {
        BezierPiece *c = &fit->piece[k];
        uint32_t n = edges_of(contour, c);
        if (n == 1) {
            c->p[1] = vec_lerp(c->p[0], c->p[3], 1.0 / 3.0);
            c->p[2] = vec_lerp(c->p[0], c->p[3], 2.0 / 3.0);
            c->largest = c->mean = 0.0;
        }
        double length = 0.0;
        for (uint32_t i = 0; i < n; i++)
            length += vec_dist(contour->v[(c->from + i) % contour->n], contour->v[(c->from + i + 1) % contour->n]);
        whole += length;
        sum += length * c->mean;
        fit->largest = fmax(fit->largest, c->largest);
    }
    fit->mean = sum / whole;
}

/* Where a piece is parted: at its farthest vertex when that is in its middle half, else in the middle. */
static uint32_t parting(const Polygon *contour, const BezierPiece *c)
{
    uint32_t n = edges_of(contour, c), far = (c->farthest + contour->n - c->from) % contour->n;
    return (c->from + (far >= n - n * 3 / 4 && far <= n * 3 / 4 && far > 0 && far < n ? far : n / 2)) % contour->n;
}

/* The fit's joints, and one more in every marked piece that can be parted. */
static void take_joints(const Polygon *contour, const BezierFit *fit, const bool *marked, GArray *at)
{
    g_array_set_size(at, 0);
    for (uint32_t k = 0; k < fit->n; k++) {
        const BezierPiece *c = &fit->piece[k];
        g_array_append_val(at, c->from);
        if (!marked[k] || edges_of(contour, c) < 2)
            continue;
        uint32_t i = parting(contour, c);
        g_array_append_val(at, i);
    }
}

BezierFit *fang_fit(const Polygon *contour, const GArray *points, uint32_t base, uint32_t tip, const BezierFitDef *def, Polygon **outline,
                    GError **error)
{
    GArray *at = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    g_array_append_vals(at, points->data, points->len);
    Chain chain = {g_array_new(FALSE, FALSE, sizeof(Vec2)), g_array_new(FALSE, FALSE, sizeof(uint32_t))};
    BezierFit *fit = NULL;
    Polygon *p = NULL;
    while (!p) {
        bezierfit_free(fit);
        fit = bezierfit_new(contour->v, contour->n, (const uint32_t *)(const void *)at->data, at->len, base, tip, def, error);
        if (!fit)
            break;
        straighten(contour, fit);
        bool *marked = g_new0(bool, fit->n), clash = false;
        do {
            draw(&chain, contour, fit, marked);
            p = polygon_or_mark(&chain, fit, marked);
            clash = clash || !p;
        } while (!p);
        if (clash) { /* that was the outline with pieces of the contour in it */
            polygon_free(p);
            p = NULL;
            take_joints(contour, fit, marked, at);
        }
        g_free(marked);
    }
    g_array_unref(chain.v);
    g_array_unref(chain.owner);
    g_array_unref(at);
    *outline = p;
    return fit;
}
