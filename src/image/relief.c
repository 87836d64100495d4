/* The bulge of each vein on the abaxial side, and how it makes itself felt beside it. */
#include <glib.h>
#include <string.h>

#include "image/painter.h"

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

static double profile(double u)
{
    if (u <= 1.0)
        return 1.0 - (1.0 - foot) * u * u;
    double rest = (1.0 + fillet - u) / fillet;
    return rest > 0.0 ? foot * rest * rest : 0.0;
}

/* How much of a vein a place beside it sees; the fourth power looks smooth under a root (surface.c). */
static double crease(double u)
{
    double fall = (crease_reach - u) / (crease_reach - crease_full);
    fall = fall < 1.0 ? fall * fall : 1.0;
    return fall * fall;
}

/* The bulges at one pixel: of the highest vein, and of the highest other one. */
typedef struct {
    uint32_t vein;
    float first, second;   /* segments */
    float crease, nearness;
} Bulge;

static void bulge_add(Bulge *b, uint32_t vein, float height)
{
    if (height <= 0.0f)
        return;
    if (vein == b->vein) {
        b->first = MAX(b->first, height);
    } else if (height > b->first) {
        b->second = b->first;
        b->first = height;
        b->vein = vein;
    } else {
        b->second = MAX(b->second, height);
    }
}

/* Veins that meet merge in a fillet, not in a crease: a maximum that is rounded where the two are about equal. */
static float bulge_height(const Bulge *b)
{
    double first = (double)b->first, second = (double)b->second, gap = first - second, round = 0.6 * second;
    return (float)(0.5 * (first + second + sqrt(gap * gap + round * round)));
}

static double between(const double end[2], double t)
{
    return end[0] + (end[1] - end[0]) * t;
}

static void lift(const Ridge *r, Vec2 at, Bulge *b)
{
    double t, distance = capsule_distance(&r->shape, at, &t), from_axis = distance + capsule_radius(&r->shape, t);
    double u = from_axis * between(r->gain, t);
    if (u < 1.0 + fillet)
        bulge_add(b, r->vein, (float)(between(r->height, t) * profile(u)));
    if (!r->large)
        return;
    if (u < crease_reach)
        b->crease = MAX(b->crease, (float)(between(r->crease, t) * crease(u)));
    double v = from_axis * between(r->near_gain, t), rest = 1.0 - v * v;
    if (v < 1.0)
        b->nearness = MAX(b->nearness, (float)(between(r->nearness, t) * rest * rest));
}

static void raise_tile(const Painter *p, uint32_t tile, Bulge *bulge)
{
    TileBox box = bins_tile(&p->ridge_bins, tile);
    memset(bulge, 0, TILE * TILE * sizeof *bulge);
    for (uint32_t i = p->ridge_bins.start[tile]; i < p->ridge_bins.start[tile + 1]; i++) {
        uint32_t y0, y1;
        Ridge r = ridge_of(p, &p->ridges->v[p->ridge_bins.item[i]]);
        Capsule area = ridge_area(&r);
        pixel_rows(&area, box.y0, box.y1, &y0, &y1);
        for (uint32_t y = y0; y < y1; y++) {
            uint32_t x0, x1;
            pixels_centred(capsule_chord(&area, y + 0.5), box.x0, box.x1, &x0, &x1);
            for (uint32_t x = x0; x < x1; x++)
                lift(&r, vec2(x + 0.5, y + 0.5), &bulge[(y - box.y0) * TILE + x - box.x0]);
        }
    }
    for (uint32_t y = box.y0; y < box.y1; y++) {
        float *height = field_row(p, &p->bulge, y), *crease = field_row(p, &p->crease, y), *nearness = field_row(p, &p->nearness, y);
        for (uint32_t x = box.x0; x < box.x1; x++) {
            const Bulge *b = &bulge[(y - box.y0) * TILE + x - box.x0];
            height[x] = bulge_height(b);
            crease[x] = b->crease;
            nearness[x] = b->nearness;
        }
    }
}

static void raise_tiles(uint32_t first, uint32_t last, void *user)
{
    Bulge *bulge = g_new(Bulge, TILE * TILE);
    for (uint32_t tile = first; tile < last; tile++)
        raise_tile(user, tile, bulge);
    g_free(bulge);
}

void painter_ridges_ready(Painter *p)
{
    if (p->ridges != NULL)
        return;
    /* The bulge is smooth: strokes may be coarser than for coverage, which matters for wide veins of short segments. */
    p->ridges = strokes_new(p->net, &p->frame, (StrokeTolerance){0.1, 0.03});
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
