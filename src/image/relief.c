/* The bulge of each vein on the abaxial side, and how it makes itself felt beside it. */
#include <glib.h>
#include <string.h>

#include "image/painter.h"
#include "image/pixels.h"
#include "geom/wide.h"

/* The profile over u, distance from the axis in radii: an arch over the vein and a fillet that runs out to the blade
 * FILLET radii beyond its edge, joined smoothly at a height of `foot`. */
static const double fillet = 0.6, foot = 0.375; /* foot = fillet / (1 + fillet) makes the slopes agree */
static const double crease_full = 1.2, crease_reach = 3.4; /* radii from the axis */
static const double least_radius = 0.8; /* pixels; thinner veins are drawn this thick and as much lower */
static const double least_near = 1.2;   /* the same for nearness */

/* Veins narrower than this part of the stout ones have neither crease nor nearness; from the other on they have all of it. */
static const double share_from = 0.002, share_full = 0.016;

static double larger(const Painter *p, double radius)
{
    double t = CLAMP((2.0 * radius / (p->stout * p->frame.scale) - share_from) / (share_full - share_from), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/* How far from its axis a vein is felt: small veins farther for their width than large ones, as the blade that bends down to
 * them is as thick as elsewhere. Pixels. */
static double near_reach(const Painter *p, double radius)
{
    return 1.3 * sqrt(radius * 0.5 * p->stout * p->frame.scale) + 0.7 * radius;
}

/* A piece of a vein: what it raises, at its ends a and b; in between straight lines. */
typedef struct {
    Capsule shape;
    uint32_t vein;
    bool large;
    double gain[2];          /* 1 / radius as drawn, 1 / pixels */
    double height[2];        /* of its top, segments; equal volume: height times width is that of the vein itself */
    double crease[2];        /* the same, fading out for small veins */
    double near_gain[2];     /* 1 / how far it is felt, 1 / pixels */
    double nearness[2];      /* on its axis */
    double reach[2];         /* of all of these, pixels */
} Ridge;

static Ridge ridge_of(const Painter *p, const Stroke *s)
{
    const double unit = p->frame.scale, radius[2] = {s->shape.ra, s->shape.rb};
    Ridge r = {.shape = s->shape, .vein = s->vein, .large = larger(p, MAX(radius[0], radius[1])) > 0.0};
    for (int e = 0; e < 2; e++) {
        double drawn = MAX(radius[e], least_radius), large = larger(p, radius[e]);
        r.gain[e] = 1.0 / drawn;
        r.height[e] = p->style.relief * radius[e] / unit * (radius[e] / drawn);
        r.reach[e] = drawn * (1.0 + fillet);
        if (!r.large)
            continue;
        double true_reach = near_reach(p, radius[e]), reach = MAX(true_reach, least_near);
        r.crease[e] = large * r.height[e];
        r.near_gain[e] = 1.0 / reach;
        r.nearness[e] = large * (true_reach / reach) * sqrt(MIN(2.0 * radius[e] / (p->stout * unit), 1.0));
        r.reach[e] = MAX(drawn * crease_reach, reach);
    }
    return r;
}

static Capsule ridge_area(const Ridge *r)
{
    return capsule_new(r->shape.a, r->reach[0], r->shape.b, r->reach[1]);
}

static Capsule ridge_shape(uint32_t i, const void *user)
{
    const Painter *p = user;
    Ridge r = ridge_of(p, &p->ridges->v[i]);
    return ridge_area(&r);
}

/* ---- pixel by pixel ---- */

/* Pixels of a row are worked on together, in loops that vector instructions take in: a multiple of LANES of them, with room for those beyond a tile. */
enum { LANES = 8, ROW = TILE + LANES };

/* The bulges at the pixels of a tile: of the highest vein, and of the highest other one. */
typedef struct {
    uint32_t vein[TILE * ROW];
    float first[TILE * ROW], second[TILE * ROW]; /* segments */
    float crease[TILE * ROW], nearness[TILE * ROW];
} Bulges;

/* Veins that meet merge in a fillet, not in a crease: a maximum that is rounded where the two are about equal. */
static inline float bulge_height(float highest, float other)
{
    double first = (double)highest, second = (double)other, gap = first - second, round = 0.6 * second;
    return (float)(0.5 * (first + second + sqrt(gap * gap + round * round)));
}

static inline double between(const double end[2], double t)
{
    return end[0] + (end[1] - end[0]) * t;
}

static inline double profile(double u)
{
    double rest = (1.0 + fillet - u) / fillet, arch = 1.0 - (1.0 - foot) * u * u, flank = rest > 0.0 ? foot * rest * rest : 0.0;
    return u <= 1.0 ? arch : flank;
}

/* How much of a vein a place beside it sees; the fourth power looks smooth under a root (surface.c). */
static inline double crease(double u)
{
    double fall = (crease_reach - u) / (crease_reach - crease_full);
    fall = fall < 1.0 ? fall * fall : 1.0;
    return fall * fall;
}

/* Of n pixels in a row, the first one's centre at `at`: where along the axis the nearest cross-section lies, 0 … 1, and how far from the axis the
 * pixel is; what capsule_distance has, without branches. */
static inline void measure(const Capsule *k, Vec2 at, uint32_t n, double *restrict t, double *restrict from_axis)
{
    double qy = at.y - k->a.y, by = at.y - k->b.y, side = k->length * k->c, whole = side > 0.0 ? side : 1.0;
    for (uint32_t i = 0; i < n; i++) {
        double px = at.x + i, qx = px - k->a.x, x = qx * k->d.x + qy * k->d.y, y = k->d.x * qy - k->d.y * qx;
        y = y < 0.0 ? -y : y;
        double along = x * k->c - y * k->s;
        bool beyond_a = !(along > 0.0), beyond_b = along >= side;
        double ex = beyond_a ? qx : px - k->b.x, ey = beyond_a ? qy : by, end = sqrt(ex * ex + ey * ey) - (beyond_a ? k->ra : k->rb);
        double beside = x * k->s + y * k->c - k->ra, place = beyond_b ? 1.0 : along / whole, distance = beyond_b ? end : beside;
        place = beyond_a ? 0.0 : place;
        distance = beyond_a ? end : distance;
        t[i] = place;
        from_axis[i] = distance + (k->ra + (k->rb - k->ra) * place);
    }
}

/* Of the n pixels from number `at` on, those from number `count` on are none. */
static inline void lift(const Ridge *r, const double *t, const double *from_axis, uint32_t n, uint32_t count, Bulges *b, uint32_t at)
{
    float height[ROW];
    uint32_t *restrict vein = b->vein + at;
    float *restrict first = b->first + at, *restrict second = b->second + at;
    for (uint32_t i = 0; i < n; i++) {
        float h = (float)(between(r->height, t[i]) * profile(from_axis[i] * between(r->gain, t[i])));
        height[i] = i < count && h > 0.0f ? h : 0.0f;
    }
    for (uint32_t i = 0; i < n; i++) {
        float h = height[i], one = first[i], two = second[i], least = h < one ? h : one;
        second[i] = vein[i] == r->vein || two > least ? two : least;
        vein[i] = h > one ? r->vein : vein[i];
        first[i] = h > one ? h : one;
    }
}

/* What a larger vein does beside it. */
static inline void surround(const Ridge *r, const double *t, const double *from_axis, uint32_t n, uint32_t count, Bulges *b, uint32_t at)
{
    float *restrict shade = b->crease + at, *restrict nearness = b->nearness + at;
    for (uint32_t i = 0; i < n; i++) {
        double u = from_axis[i] * between(r->gain, t[i]), deep = between(r->crease, t[i]) * crease(u);
        float seen = i < count && u < crease_reach ? (float)deep : 0.0f;
        shade[i] = shade[i] > seen ? shade[i] : seen;
    }
    for (uint32_t i = 0; i < n; i++) {
        double v = from_axis[i] * between(r->near_gain, t[i]), rest = 1.0 - v * v, near = between(r->nearness, t[i]) * rest * rest;
        float felt = i < count && v < 1.0 ? (float)near : 0.0f;
        nearness[i] = nearness[i] > felt ? nearness[i] : felt;
    }
}

WIDE static void raise_ridge(const Ridge *r, TileBox box, Bulges *b)
{
    Capsule area = ridge_area(r);
    uint32_t y0, y1, x0, x1;
    pixel_rows(&area, box.y0, box.y1, &y0, &y1);
    for (uint32_t y = y0; y < y1; y++) {
        pixels_centred(capsule_chord(&area, y + 0.5), box.x0, box.x1, &x0, &x1);
        if (x0 == x1)
            continue;
        double t[ROW], from_axis[ROW];
        uint32_t at = (y - box.y0) * ROW + x0 - box.x0, count = x1 - x0, n = (count + LANES - 1) / LANES * LANES;
        measure(&r->shape, vec2(x0 + 0.5, y + 0.5), n, t, from_axis);
        lift(r, t, from_axis, n, count, b, at);
        if (r->large)
            surround(r, t, from_axis, n, count, b, at);
    }
}

WIDE static void settle_tile(const Painter *p, TileBox box, const Bulges *b)
{
    for (uint32_t y = box.y0; y < box.y1; y++) {
        float *restrict height = field_row(p, &p->bulge, y) + box.x0;
        uint32_t at = (y - box.y0) * ROW, n = box.x1 - box.x0;
        for (uint32_t i = 0; i < n; i++)
            height[i] = bulge_height(b->first[at + i], b->second[at + i]);
        memcpy(field_row(p, &p->crease, y) + box.x0, b->crease + at, n * sizeof(float));
        memcpy(field_row(p, &p->nearness, y) + box.x0, b->nearness + at, n * sizeof(float));
    }
}

static void raise_tile(const Painter *p, uint32_t tile, Bulges *b)
{
    TileBox box = bins_tile(&p->ridge_bins, tile);
    uint32_t from = p->ridge_bins.start[tile], to = p->ridge_bins.start[tile + 1];
    if (from == to) {
        field_clear_tile(p, &p->bulge, box);
        field_clear_tile(p, &p->crease, box);
        field_clear_tile(p, &p->nearness, box);
        return;
    }
    memset(b, 0, sizeof *b);
    for (uint32_t i = from; i < to; i++) {
        bins_ahead(&p->ridge_bins, i, to, p->ridges->v, sizeof *p->ridges->v);
        Ridge r = ridge_of(p, &p->ridges->v[p->ridge_bins.item[i]]);
        raise_ridge(&r, box, b);
    }
    settle_tile(p, box, b);
}

static void raise_tiles(uint32_t first, uint32_t last, void *user)
{
    Bulges *b = g_new(Bulges, 1);
    for (uint32_t tile = first; tile < last; tile++)
        raise_tile(user, tile, b);
    g_free(b);
}

void painter_ridges_ready(Painter *p)
{
    painter_ridges(p);
    if (p->ridge_bins.start == NULL)
        bins_init(&p->ridge_bins, p->width, p->rows, p->ridges->n, ridge_shape, p);
}

void painter_relief(Painter *p)
{
    painter_ridges_ready(p);
    uint32_t from = field_begin(p, &p->bulge);
    field_begin(p, &p->crease);
    field_begin(p, &p->nearness);
    painter_tiles(p, &p->ridge_bins, from, raise_tiles, p);
}
