#include "image/paint.h"

#include <glib.h>
#include <string.h>

#include "geom/dmath.h"
#include "image/painter.h"

static const MapInfo infos[MAP_COUNT] = {
    [MAP_BASE_COLOR] = {"base_color", PLANE_COLOUR, 3, "", "Colour of the sunny (adaxial) side"},
    [MAP_ABAXIAL_BASE_COLOR] = {"abaxial_base_color", PLANE_COLOUR, 3, "", "Colour of the shadow (abaxial) side"},
    [MAP_OPACITY] = {"opacity", PLANE_DATA, 1, "", "Exact part of the pixel that the blade covers"},
    [MAP_HEIGHT] = {"height", PLANE_DATA, 1, "segments",
                    "Surface of the abaxial side: veins raised, blade sunk between them"},
    [MAP_NORMAL_GL] = {"normal_gl", PLANE_DATA, 3, "",
                       "Normals of the abaxial side from the height map, x right, y up, z to the viewer"},
    [MAP_ADAXIAL_NORMAL_GL] = {"adaxial_normal_gl", PLANE_DATA, 3, "",
                               "Normals of the adaxial side: larger veins slightly sunk, blade arched between them"},
    [MAP_ROUGHNESS] = {"roughness", PLANE_DATA, 1, "", "Roughness of the surface, 0 mirror to 1 dull"},
    [MAP_AO] = {"ao", PLANE_DATA, 1, "", "Ambient occlusion of the abaxial side: dark in the creases beside veins"},
    [MAP_TRANSLUCENCY] = {"translucency", PLANE_DATA, 1, "",
                          "Part of the light that passes through: much in the blade, little in thick veins"},
    [MAP_THICKNESS] = {"thickness", PLANE_DATA, 1, "segments",
                       "Thickness of blade and vein, thinning out at the margin"},
    [MAP_VEIN_MASK] = {"vein_mask", PLANE_DATA, 1, "", "Exact part of the pixel that veins cover"},
    [MAP_VEIN_ORDER] = {"vein_order", PLANE_LABEL, 1, "", "Order of the vein at the pixel, 1 primary; 0 none"},
    [MAP_VEIN_ID] = {"vein_id", PLANE_LABEL, 1, "", "Number of the vein at the pixel, from 1; 0 none"},
    [MAP_VEIN_WIDTH] = {"vein_width", PLANE_DATA, 1, "segments", "Width of the vein at the pixel; 0 none"},
    [MAP_DISTANCE] = {"distance", PLANE_DATA, 1, "segments",
                      "Distance to the nearest vein inside the blade; 0 in veins"},
    [MAP_AGE] = {"age", PLANE_DATA, 1, "steps", "Step at which the vein at the pixel was born; 0 none"},
    [MAP_AREOLE] = {"areole", PLANE_LABEL, 1, "",
                    "Number of the areole, a mesh of the net, at the pixel, from 1; 0 where veins cover half of it or more, and where veins don't enclose it"},
};

const MapInfo *paint_map_info(MapId id)
{
    return &infos[id];
}

int paint_map_find(const char *name)
{
    for (int i = 0; i < MAP_COUNT; i++)
        if (strcmp(infos[i].name, name) == 0)
            return i;
    return -1;
}

void paint_colour(uint32_t srgb, float out[3])
{
    for (int i = 0; i < 3; i++) {
        double s = (srgb >> (16 - 8 * i) & 255u) / 255.0;
        out[i] = (float)(s <= 0.04045 ? s / 12.92 : dmath_pow((s + 0.055) / 1.055, 2.4));
    }
}

PaintStyle paint_style_default(void)
{
    PaintStyle s = {.variation = 0.35, .relief = 0.6, .gloss = 0.5, .thickness = 1.5, .padding = 16};
    paint_colour(0x4f7a2c, s.lamina);
    paint_colour(0xc3cf86, s.vein);
    paint_colour(0x86a06b, s.abaxial_lamina);
    paint_colour(0xc9cfa0, s.abaxial_vein);
    paint_colour(0x5f7f33, s.margin);
    return s;
}

/* As wide as a part of the blade is narrow (area over perimeter is half the width of a strip), on broad blades of the
 * leaf's length. */
static double rim_width(const Painter *p)
{
    const Polygon *m = p->net->margin;
    double around = 0.0;
    if (m == NULL)
        return 1.0;
    for (uint32_t i = 0; i < m->n; i++)
        around += vec_dist(m->v[i], m->v[i + 1 < m->n ? i + 1 : 0]);
    double length = MAX(m->box.x1 - m->box.x0, m->box.y1 - m->box.y0), half = around > 0.0 ? m->area / around : 0.0;
    return MAX(MIN(0.05 * half, 0.006 * length) * p->frame.scale, 1.0);
}

/* The width that veins as long as a part of the leaf together reach. At a base where many veins leave one node a single
 * segment may bear the flow of all, which tells nothing about the leaf. */
static double stout_width(const Network *net, double widest)
{
    enum { CLASSES = 256 };
    static const double part = 0.03;
    double length[CLASSES] = {0.0}, leaf = 0.0, sum = 0.0;
    if (net->margin == NULL || !(widest > 0.0))
        return widest;
    leaf = MAX(net->margin->box.x1 - net->margin->box.x0, net->margin->box.y1 - net->margin->box.y0);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint32_t c = (uint32_t)(net->width[e] / widest * (CLASSES - 1));
        length[MIN(c, CLASSES - 1)] += vec_dist(net->node[net->tail[e]], net->node[net->head[e]]);
    }
    for (int c = CLASSES - 1; c > 0; c--) {
        sum += length[c];
        if (sum >= part * leaf)
            return MIN(widest, widest * (c + 1) / (CLASSES - 1));
    }
    return widest;
}

/* What the leaf is like as a whole. */
static void survey(Painter *p)
{
    const Network *net = p->style.reference != NULL ? p->style.reference : p->net;
    double length = 0.0;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        p->widest = MAX(p->widest, net->width[e]);
        length += vec_dist(net->node[net->tail[e]], net->node[net->head[e]]);
    }
    double area = net->margin != NULL ? net->margin->area : 0.0;
    p->stout = stout_width(net, p->widest);
    p->rim = rim_width(p);
    p->spacing = length > 0.0 && area > 0.0 ? area / length : 1.0;
    p->steps = net->n_steps;
}

/* Sides of holes come after those of the margin. */
static void take_holes(Painter *p)
{
    const Holes *h = p->net->holes;
    for (uint32_t k = 0; h != NULL && k < h->n; k++)
        for (uint32_t i = h->start[k]; i < h->start[k + 1]; i++) {
            uint32_t next = i + 1 < h->start[k + 1] ? i + 1 : h->start[k];
            p->edge[p->n_edges++] = capsule_new(painter_to_image(p, h->p[i]), 0.0, painter_to_image(p, h->p[next]), 0.0);
        }
}

static void take_margin(Painter *p)
{
    const Polygon *m = p->net->margin;
    const Holes *h = m != NULL ? p->net->holes : NULL;
    p->n_margin = p->n_edges = m != NULL ? m->n : 0;
    p->margin = g_new(Vec2, p->n_margin + 1);
    p->edge = g_new(Capsule, p->n_margin + (h != NULL ? h->start[h->n] : 0) + 1);
    for (uint32_t i = 0; i < p->n_margin; i++)
        p->margin[i] = painter_to_image(p, m->v[i]);
    for (uint32_t i = 0; i < p->n_margin; i++)
        p->edge[i] = capsule_new(p->margin[i], 0.0, p->margin[i + 1 < p->n_margin ? i + 1 : 0], 0.0);
    if (m != NULL)
        take_holes(p);
}

Painter *painter_new(const Network *net, const Frame *frame, const PaintStyle *style)
{
    static const double usual_size = 2048.0; /* of the maps that style.padding speaks of, pixels */
    Painter *p = g_new0(Painter, 1);
    p->net = net;
    p->frame = *frame;
    p->style = *style;
    p->pool = pool_new(style->threads);
    p->width = frame->width;
    p->rows = frame->height;
    p->padding = style->padding * MAX(p->width, p->rows) / usual_size;
    p->circle = circle_new();
    p->spare = g_ptr_array_new_with_free_func((GDestroyNotify)plane_free);
    take_margin(p);
    survey(p);
    painter_band(p, 0, p->rows);
    return p;
}

void painter_expect(Painter *p, const gboolean *wanted)
{
    for (int i = 0; i < MAP_COUNT; i++)
        p->expected[i] = wanted[i] != FALSE;
}

void painter_free(Painter *p)
{
    if (p == NULL)
        return;
    painter_drop(p);
    g_free(p->blurred);
    for (int i = 0; i < N_NOISE && p->has_noise; i++)
        noise_clear(&p->noise[i]);
    strokes_free(p->strokes);
    strokes_free(p->ridges);
    bins_clear(&p->bins);
    bins_clear(&p->ridge_bins);
    bins_clear(&p->edge_bins);
    areole_map_free(p->areoles);
    nearest_free(p->to_vein);
    nearest_free(p->to_edge);
    pool_free(p->pool);
    g_free(p->circle);
    g_free(p->margin);
    g_free(p->edge);
    g_free(p);
}

/* ---- strokes ---- */

/* A stroke with room for the pixels beside it. */
static Capsule stroke_area(uint32_t i, const void *user)
{
    const Capsule *k = &((const Strokes *)user)->v[i].shape;
    return capsule_new(k->a, k->ra + 0.75, k->b, k->rb + 0.75);
}

/* For what is seen of veins, and for relief: the bulge is smooth, so that strokes may be coarser, which matters for wide veins of short segments. */
static const StrokeTolerance tolerance[2] = {{0.04, 0.0}, {0.1, 0.03}};

const Strokes *painter_strokes(Painter *p)
{
    if (p->strokes == NULL)
        p->strokes = strokes_new(p->net, &p->frame, tolerance[0]);
    if (p->bins.start == NULL)
        bins_init(&p->bins, p->width, p->rows, p->strokes->n, stroke_area, p->strokes);
    return p->strokes;
}

const Strokes *painter_ridges(Painter *p)
{
    if (p->ridges == NULL)
        p->ridges = strokes_new(p->net, &p->frame, tolerance[1]);
    return p->ridges;
}

/* Strokes and ridges. */
static void make_strokes(Painter *p)
{
    Strokes *both[2];
    if (p->strokes != NULL || p->ridges != NULL)
        return;
    strokes_make(p->net, &p->frame, 2, tolerance, both);
    p->strokes = both[0];
    p->ridges = both[1];
}

/* ---- loops ---- */

typedef struct {
    void (*row)(uint32_t y, void *user);
    LoopFn range;
    void *user;
    uint32_t from; /* row, or tile */
} Loop;

static void run_rows(uint32_t first, uint32_t last, void *user)
{
    const Loop *loop = user;
    for (uint32_t y = first; y < last; y++)
        loop->row(loop->from + y, loop->user);
}

void painter_rows(const Painter *p, uint32_t y0, uint32_t y1, void (*fn)(uint32_t y, void *user), void *user)
{
    Loop loop = {.row = fn, .user = user, .from = y0};
    pool_for(p->pool, y1 - y0, 4, run_rows, &loop);
}

static void run_tiles(uint32_t first, uint32_t last, void *user)
{
    const Loop *loop = user;
    loop->range(loop->from + first, loop->from + last, loop->user);
}

void painter_tiles(Painter *p, const Bins *bins, uint32_t from, LoopFn fn, void *user)
{
    uint32_t first = from / TILE * bins->nx, last = (p->bottom + TILE - 1) / TILE * bins->nx;
    Loop loop = {.range = fn, .user = user, .from = first};
    if (from < p->bottom)
        pool_for(p->pool, last - first, 8, run_tiles, &loop);
}

/* What the leaf as a whole gives to maps, longest to make first. */
enum { READY_AREOLES, READY_STROKES, READY_NOISE, N_READY };

void painter_strokes_ready(Painter *p, bool shaped)
{
    if (shaped)
        make_strokes(p);
    painter_strokes(p);
    if (shaped)
        painter_ridges_ready(p);
    if (shaped || p->expected[MAP_DISTANCE])
        painter_away_ready(p);
}

static void make_ready(uint32_t first, uint32_t last, void *user)
{
    Painter *p = user;
    bool shaped = false, looks = false, veins = p->expected[MAP_VEIN_MASK] || p->expected[MAP_VEIN_ORDER] || p->expected[MAP_DISTANCE];
    for (int i = MAP_BASE_COLOR; i <= MAP_THICKNESS; i++)
        shaped = shaped || (p->expected[i] && i != MAP_OPACITY);
    for (int i = 0; i < MAP_COUNT; i++)
        looks = looks || (p->expected[i] && paint_is_look((MapId)i));
    for (uint32_t i = first; i < last; i++)
        if (i == READY_AREOLES && p->expected[MAP_AREOLE])
            areole_map_ready(p);
        else if (i == READY_STROKES && (shaped || veins))
            painter_strokes_ready(p, shaped);
        else if (i == READY_NOISE && looks)
            painter_noise_ready(p);
}

/* Each of these is made by one thread; so they are made side by side, when it is known what will be needed. */
static void get_ready(Painter *p)
{
    if (p->ready)
        return;
    p->ready = true;
    pool_for(p->pool, N_READY, 1, make_ready, p);
}

Plane *painter_paint(Painter *p, MapId id)
{
    get_ready(p);
    switch (id) {
    case MAP_OPACITY:
    case MAP_VEIN_MASK:
    case MAP_VEIN_ORDER:
    case MAP_VEIN_ID:
    case MAP_VEIN_WIDTH:
    case MAP_DISTANCE:
    case MAP_AGE:
        return paint_attribute(p, id);
    case MAP_AREOLE:
        return paint_areole(p);
    case MAP_HEIGHT:
    case MAP_NORMAL_GL:
    case MAP_ADAXIAL_NORMAL_GL:
    case MAP_AO:
    case MAP_THICKNESS:
        return paint_surface(p, id);
    default:
        return paint_look(p, id);
    }
}

typedef struct {
    const Painter *p;
    Plane *plane;
    double line; /* width, pixels */
} Ink;

static void ink_row(uint32_t y, void *user)
{
    const Ink *k = user;
    const Painter *p = k->p;
    const float *cover = field_row(p, &p->cover, y), *blade = field_row(p, &p->blade, y), *inset = field_row(p, &p->inset, y);
    float *out = plane_row(p, k->plane, y);
    for (uint32_t x = 0; x < p->width; x++) {
        double paper = 1.0;
        if (p->net->margin != NULL) /* just inside the margin, so that the line ends where the blade does */
            paper -= 0.5 * (double)blade[x] * CLAMP(k->line + 0.5 - (double)inset[x], 0.0, 1.0);
        out[x] = (float)(paper * (1.0 - (double)cover[x]));
    }
}

Plane *painter_veins(Painter *p)
{
    double size = MAX(p->width, p->rows);
    Ink k = {p, painter_sheet(p, 1, PLANE_DATA), CLAMP(1.5 * size / 2048.0, 0.75, LINE_REACH - 1.0)};
    painter_cover(p);
    painter_inset(p);
    painter_rows(p, p->y0, p->y1, ink_row, &k);
    return k.plane;
}
