/* The painter's inside: parts that several maps share, each made when first asked for. */
#ifndef IMAGE_PAINTER_H
#define IMAGE_PAINTER_H

#include "image/bins.h"
#include "image/convex.h"
#include "image/paint.h"
#include "image/stroke.h"

enum { LINE_REACH = 16 }; /* pixels within which the margin may be drawn as a line */

/* A pixel's vein: which stroke, and whether the pixel belongs to it or lies beside it. */
enum { OWNER_NONE = 0xFFFFFFFFu, OWNER_BESIDE = 0x80000000u };

struct Painter {
    const Network *net;
    Frame frame;
    PaintStyle style;
    uint32_t width, rows; /* of the image, pixels */
    double widest;        /* largest vein width, segments */
    uint32_t steps;       /* of the run */
    double stout;         /* what the widest veins are for a stretch, not just where all of them come together, segments */
    double spacing;       /* blade area over vein length, segments: distance of neighbouring veins in a net */
    double band;          /* width of the band along the margin, pixels */
    Circle *circle;

    Strokes *strokes; /* as exact as the image can show */
    Bins bins;
    float *cover;       /* part of the pixel covered by veins within the blade */
    float *blade;       /* part of the pixel covered by the blade */
    uint32_t *owner;    /* stroke at the pixel, see above */
    float *away;        /* distance from the pixel's centre to the nearest vein, pixels; negative inside a vein */
    float *inset;       /* distance to the margin, pixels, exact up to `band` and LINE_REACH */
    float *vein_height; /* relief of the veins alone, segments */
    float *halo;        /* nearness of large veins, 0 … 1 */
    float *arch;        /* arch of the blade between veins, 0 at a vein, 1 in the middle of a mesh */
    float *height;      /* abaxial surface, segments; carried beyond the margin */
    uint32_t *source;   /* pixel whose colour a pixel takes: itself in the blade, OWNER_NONE beyond the padding */
};

/* Each makes what its name says and keeps it in the painter. */
const Strokes *painter_strokes(Painter *p);
const float *painter_cover(Painter *p);
const float *painter_blade(Painter *p);
const uint32_t *painter_owner(Painter *p);
const float *painter_away(Painter *p);
const float *painter_inset(Painter *p);
const float *painter_vein_height(Painter *p);
const float *painter_halo(Painter *p);
const float *painter_arch(Painter *p);
const float *painter_height(Painter *p);
const uint32_t *painter_source(Painter *p);

double painter_round_up(double value); /* to two significant digits */

/* Distance of each pixel's centre to the nearest of n strokes, exact up to `limit`, beyond which it is `limit`; 0 where
 * `where` is 0 (strokes may then be farther or nearer). Signed: negative inside a stroke. */
float *distance_field(const Painter *p, const Capsule *(*shape)(uint32_t i, const void *user), const void *user,
                      uint32_t n, const float *where, double limit);

/* Maps of data and labels (attribute.c), of the surface (surface.c) and of what it looks like (shade.c). */
Plane *paint_attribute(Painter *p, MapId id);
Plane *paint_surface(Painter *p, MapId id);
Plane *paint_look(Painter *p, MapId id);

/* A plane for a map, with its kind, unit and range. */
Plane *painter_plane(const Painter *p, MapId id);

/* Copies each pixel beyond the margin from its source. */
void painter_pad(Painter *p, Plane *plane);

/* A row loop: fn(y, user) for every row of the image, in parallel. */
void painter_rows(const Painter *p, void (*fn)(uint32_t y, void *user), void *user);

#endif
