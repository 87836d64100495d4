/* The painter's inside: parts that several maps share, each made when first asked for. */
#ifndef IMAGE_PAINTER_H
#define IMAGE_PAINTER_H

#include "geom/parallel.h"
#include "image/bins.h"
#include "image/convex.h"
#include "image/nearest.h"
#include "image/noise.h"
#include "image/paint.h"
#include "image/stroke.h"

enum { LINE_REACH = 16 }; /* pixels within which the margin may be drawn as a line */

/* A pixel's vein: which stroke, and whether the pixel belongs to it or lies beside it. */
enum { OWNER_NONE = 0xFFFFFFFFu, OWNER_BESIDE = 0x80000000u };

/* Unevenness of the blade at several sizes. */
enum { BLOTCH, PATCH, MOTTLE, GRAIN, TINT, N_NOISE };

/* One number a pixel of the rows at hand, painter.top … bottom-1, of which those above `done` are filled. What a pixel holds
 * depends on its place alone, so rows that the next band needs too are kept. */
typedef struct {
    void *px; /* float or uint32_t */
    uint32_t done;
} Field;

typedef struct AreoleMap AreoleMap;

struct Painter {
    const Network *net;
    Frame frame;
    PaintStyle style;
    Pool *pool;
    uint32_t width, rows; /* of the image, pixels */
    double widest;        /* largest vein width, segments */
    uint32_t steps;       /* of the run */
    double stout;         /* what the widest veins are for a stretch, not just where all of them come together, segments */
    double spacing;       /* blade area over vein length, segments: distance of neighbouring veins in a net */
    double rim;           /* width of the band along the margin, pixels */
    double padding;       /* pixels */

    uint32_t surround;    /* rows that specimens need around the painted ones */
    uint32_t y0, y1;      /* rows that are painted */
    uint32_t top, bottom; /* rows at hand: those and what of their surroundings they depend on; whole rows of tiles */

    Circle *circle;
    uint32_t n_margin, n_edges;
    Vec2 *margin;     /* image coordinates */
    Capsule *edge;    /* [n_edges] its sides, then those of holes */
    Strokes *strokes; /* as exact as the image can show */
    Bins bins;
    Strokes *ridges; /* coarser, for relief */
    Bins ridge_bins;
    Bins edge_bins;
    Nearest *to_vein, *to_edge;
    AreoleMap *areoles;
    Noise noise[N_NOISE];
    bool has_noise;

    bool expected[MAP_COUNT]; /* maps that will be asked for, see painter_expect */
    bool ready;               /* what they need of the leaf as a whole is there */
    Plane *kept[MAP_COUNT];   /* painted along with others, not asked for yet */
    GPtrArray *spare;         /* planes that were given back */
    int32_t *blurred;         /* scratch for the arch, n_blurred of them */
    gsize n_blurred;

    Field cover;   /* part of the pixel covered by veins within the blade */
    Field blade;   /* part of the pixel covered by the blade */
    Field owner;   /* stroke at the pixel, see above */
    Field away;    /* distance from the pixel's centre to the nearest vein, pixels; negative inside a vein */
    Field inset;   /* distance to the margin, pixels, exact up to `rim`, LINE_REACH and `padding` */
    Field side;    /* the nearest side of the margin, OWNER_NONE when none is that near */
    Field bulge;   /* relief of the veins alone, segments */
    Field crease;  /* height of the veins that stand beside the pixel, segments */
    Field nearness; /* of larger veins, 0 … 1: the root of the width of the vein as part of the stout ones, fading out beside it */
    Field arch;    /* arch of the blade between veins, 0 at a vein, 1 in the middle of a mesh */
    Field grain[N_NOISE];
};

/* Each makes what its name says, in the rows at hand. */
const Strokes *painter_strokes(Painter *p);
const Strokes *painter_ridges(Painter *p);
const float *painter_cover(Painter *p);
const float *painter_blade(Painter *p);
const uint32_t *painter_owner(Painter *p);
const float *painter_away(Painter *p);
const float *painter_inset(Painter *p);
const float *painter_arch(Painter *p);
void painter_relief(Painter *p); /* bulge, crease and nearness */
void painter_noise(Painter *p);

/* What some of them need of the leaf as a whole, by one thread each. */
void painter_ridges_ready(Painter *p);
void painter_away_ready(Painter *p);
void painter_noise_ready(Painter *p);
void painter_strokes_ready(Painter *p, bool shaped); /* strokes for coverage and distances; ridges, too, when `shaped` */

/* Rows around the painted ones that the arch depends on, pixels. */
uint32_t arch_reach(const Painter *p);

/* Frees planes and fields (band.c). */
void painter_drop(Painter *p);

/* Makes room for the rows at hand; the first of those not filled yet, a multiple of TILE, or p->bottom. What these hold is left from other rows. */
uint32_t field_begin(const Painter *p, Field *f);

/* Zeroes a tile of a field. */
void field_clear_tile(const Painter *p, const Field *f, TileBox box);

/* Row y of a field. */
static inline float *field_row(const Painter *p, const Field *f, uint32_t y)
{
    return (float *)f->px + (gsize)(y - p->top) * p->width;
}

static inline uint32_t *label_row(const Painter *p, const Field *f, uint32_t y)
{
    return (uint32_t *)f->px + (gsize)(y - p->top) * p->width;
}

/* Runs fn(first, last, p) over the tiles of rows `from` to the end of those at hand; last is behind the last. */
void painter_tiles(Painter *p, const Bins *bins, uint32_t from, LoopFn fn, void *user);

/* fn(y, user) for every row y0 … y1-1. */
void painter_rows(const Painter *p, uint32_t y0, uint32_t y1, void (*fn)(uint32_t y, void *user), void *user);

/* v within low … high; low for what is no number. Unlike CLAMP it is two instructions, with no branch. */
static inline double clamped(double v, double low, double high)
{
    v = v > low ? v : low;
    return v < high ? v : high;
}

static inline double smoothstep(double t)
{
    t = clamped(t, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

double painter_round_up(double value); /* to two significant digits */

static inline Vec2 painter_to_image(const Painter *p, Vec2 v)
{
    return vec2((v.x - p->frame.corner.x) * p->frame.scale, (p->frame.corner.y - v.y) * p->frame.scale);
}

/* Padding: a pixel beyond the margin, but no farther than the padding reaches, takes what a blade without veins would have at the
 * nearest point of the margin. FALSE when the pixel is in the blade or farther; *at is that point, image coordinates. */
bool painter_padded(const Painter *p, uint32_t x, uint32_t y, Vec2 *at);

/* Maps of data and labels (attribute.c), of the surface (surface.c) and of what it looks like (shade.c). */
Plane *paint_attribute(Painter *p, MapId id);
Plane *paint_surface(Painter *p, MapId id);
Plane *paint_look(Painter *p, MapId id);
bool paint_is_look(MapId id);

/* Areoles (areole.c). */
Plane *paint_areole(Painter *p);
void areole_map_ready(Painter *p);
void areole_map_free(AreoleMap *m);

/* Of the blade, or of the image when there is none; segments. */
Box2 painter_blade_box(const Painter *p);

/* A plane for the painted rows of a map, with its kind, unit and range; and any other one. What their pixels hold is left from other planes. */
Plane *painter_plane(Painter *p, MapId id);
Plane *painter_sheet(Painter *p, uint32_t channels, PlaneKind kind);

/* Its row that shows row y of the image. */
static inline float *plane_row(const Painter *p, Plane *plane, uint32_t y)
{
    return plane->px + (gsize)(y - p->y0) * plane->width * plane->channels;
}

#endif
