/* Painting a venation network as texture maps, with exact coverage. */
#ifndef IMAGE_PAINT_H
#define IMAGE_PAINT_H

#include "geom/vec.h"
#include "image/photo.h"
#include "image/plane.h"
#include "sim/network.h"

/* The maps, in the order they are written. Name, kind and meaning: paint_map_info. */
typedef enum {
    MAP_BASE_COLOR,         /* sunny side */
    MAP_ABAXIAL_BASE_COLOR, /* shadow side */
    MAP_OPACITY,            /* exact coverage by the blade */
    MAP_HEIGHT,             /* veins raised on the abaxial side, segments */
    MAP_NORMAL_GL,          /* from height, seen from the abaxial side; tangent space, y up */
    MAP_ADAXIAL_NORMAL_GL,  /* the sunny side, where the larger veins are slightly sunk */
    MAP_ROUGHNESS,
    MAP_AO,
    MAP_TRANSLUCENCY,
    MAP_THICKNESS,          /* blade plus vein, segments */
    MAP_VEIN_MASK,          /* exact coverage by the veins */
    MAP_VEIN_ORDER,         /* label: order of the vein at the pixel, 0 none */
    MAP_VEIN_ID,            /* label: 1 + vein of the network, 0 none */
    MAP_VEIN_WIDTH,         /* width of the vein at the pixel, segments, 0 none */
    MAP_DISTANCE,           /* distance to the nearest vein's surface inside the blade, segments, 0 in veins */
    MAP_AGE,                /* step of birth of the vein at the pixel; low/high = 0 … steps */
    MAP_AREOLE,             /* label: 1 + areole at the pixel's centre, 0 in veins and where there is none */
    MAP_COUNT
} MapId;

typedef struct {
    const char *name; /* file suffix, e.g. "base_color" */
    PlaneKind kind;
    uint32_t channels;
    const char *unit, *doc;
} MapInfo;

const MapInfo *paint_map_info(MapId id);
int paint_map_find(const char *name); /* -1: none */

/* Which part of the plane an image shows. Image y runs down, leaf y up. */
typedef struct {
    uint32_t width, height; /* pixels */
    double scale;           /* pixels per segment */
    Vec2 corner;            /* leaf coordinates of the top left corner of the image */
} Frame;

/* A frame whose longer side has `size` pixels and which holds `box` with an empty border of `border` (part of the longer side). */
Frame frame_fit(Box2 box, uint32_t size, bool square, double border);

/* Colours are linear light. */
typedef struct {
    float lamina[3], vein[3], abaxial_lamina[3], abaxial_vein[3], margin[3];
    double variation, relief, gloss, thickness;
    uint32_t padding; /* pixels in maps of 2048; larger maps have more */
    uint64_t seed;    /* of the colour variation */
    unsigned threads; /* 0: all processors */
    const Network *reference; /* network whose widths, density and steps set the scale of values and colours, so that frames of
                               * one run compare; NULL: the painted one's own. Outlives the painter. */
    const Photo *photo[2];    /* colours of the sunny and the shadow side instead of painted ones; NULL: painted. Outlive the painter. */
} PaintStyle;

PaintStyle paint_style_default(void);

/* sRGB 0xRRGGBB to linear light. */
void paint_colour(uint32_t srgb, float out[3]);

typedef struct Painter Painter;

/* Prepares a network for painting in a frame; both must outlive the painter. The result depends on network, frame and style alone, not on threads. */
Painter *painter_new(const Network *net, const Frame *frame, const PaintStyle *style);
void painter_free(Painter *p);

/* Says which rows of the image, y0 … y1-1, the next planes show; at first they are all. Pixels are the same in any bands. Going down
 * the image band by band computes everything once and needs memory for the rows of a band and a few around it. */
void painter_band(Painter *p, uint32_t y0, uint32_t y1);

/* Says which maps, MAP_COUNT of them, will be painted of each band, so that those that depend on the same are painted together; what is not
 * asked for after all costs time alone. */
void painter_expect(Painter *p, const gboolean *wanted);

/* Paints one map; the shared parts (coverage, nearest vein, distance) are computed once and kept in the painter. */
Plane *painter_paint(Painter *p, MapId id);

/* Takes back a plane, which the painter made or NULL, instead of plane_free: the next ones need no memory from the system then. */
void painter_give_back(Painter *p, Plane *plane);

/* Black veins on white, the paper's own look, and a thin grey line along the margin. One channel, values 0 … 1. */
Plane *painter_veins(Painter *p);

#endif
