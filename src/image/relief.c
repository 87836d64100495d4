/* The bulge of each vein on the abaxial side, and the light band along large veins. */
#include <glib.h>
#include <string.h>

#include "geom/parallel.h"
#include "image/painter.h"

/* The profile over u, distance from the axis in radii: an arch over the vein and a fillet that runs out to the blade
 * FILLET radii beyond its edge, joined smoothly at a height of `foot`. */
static const double fillet = 0.6, foot = 0.375; /* foot = fillet / (1 + fillet) makes the slopes agree */
static const double halo_reach = 2.2;           /* radii from the axis */
static const double halo_from = 0.08;           /* of the stout veins: where a vein begins to have a halo */
static const double least_radius = 0.8;         /* pixels; thinner veins are drawn this thick and as much lower */

typedef struct {
    Painter *p;
    Strokes *strokes;
    Bins bins;
} Relief;

static Capsule relief_shape(uint32_t i, const void *user)
{
    const Relief *r = user;
    const Capsule *k = &r->strokes->v[i].shape;
    double wide = 0.5 * halo_from * r->p->stout * r->p->frame.scale;
    double reach = MAX(k->ra, k->rb) > wide ? halo_reach : 1.0 + fillet;
    return capsule_new(k->a, MAX(k->ra, least_radius) * reach, k->b, MAX(k->rb, least_radius) * reach);
}

static double profile(double u)
{
    if (u <= 1.0)
        return 1.0 - (1.0 - foot) * u * u;
    double rest = (1.0 + fillet - u) / fillet;
    return rest > 0.0 ? foot * rest * rest : 0.0;
}

/* The bulges at one pixel: of the highest vein, and of the highest other one. */
typedef struct {
    uint32_t vein;
    float first, second; /* segments */
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

static void lift(const Relief *r, const Stroke *s, uint32_t x, uint32_t y, Bulge *bulge)
{
    Painter *p = r->p;
    const Capsule *k = &s->shape;
    double t, distance = capsule_distance(k, vec2(x + 0.5, y + 0.5), &t), radius = capsule_radius(k, t);
    double drawn = MAX(radius, least_radius), u = (distance + radius) / drawn;
    /* equal volume: height times width is that of the vein itself */
    double height = p->style.relief * radius / p->frame.scale * (radius / drawn) * profile(u);
    bulge_add(bulge, s->vein, (float)height);
    double share = 2.0 * radius / p->frame.scale / p->stout;
    if (share > halo_from && u < halo_reach) {
        gsize at = (gsize)y * p->width + x;
        double fall = 1.0 - u / halo_reach,
               halo = sqrt((MIN(share, 1.0) - halo_from) / (1.0 - halo_from)) * fall * fall * (3.0 - 2.0 * fall);
        if (halo > (double)p->halo[at])
            p->halo[at] = (float)halo;
    }
}

static void raise_tile(const Relief *r, uint32_t tile, Bulge *bulge)
{
    TileBox box = bins_tile(&r->bins, tile);
    memset(bulge, 0, TILE * TILE * sizeof *bulge);
    for (uint32_t i = r->bins.start[tile]; i < r->bins.start[tile + 1]; i++) {
        uint32_t stroke = r->bins.item[i], y0, y1;
        Capsule area = relief_shape(stroke, r);
        pixel_rows(&area, box.y0, box.y1, &y0, &y1);
        for (uint32_t y = y0; y < y1; y++) {
            uint32_t x0, x1;
            pixels_centred(capsule_chord(&area, y + 0.5), box.x0, box.x1, &x0, &x1);
            for (uint32_t x = x0; x < x1; x++)
                lift(r, &r->strokes->v[stroke], x, y, &bulge[(y - box.y0) * TILE + x - box.x0]);
        }
    }
    for (uint32_t y = box.y0; y < box.y1; y++)
        for (uint32_t x = box.x0; x < box.x1; x++)
            r->p->vein_height[(gsize)y * r->p->width + x] = bulge_height(&bulge[(y - box.y0) * TILE + x - box.x0]);
}

static void raise_tiles(uint32_t first, uint32_t last, void *user)
{
    Bulge *bulge = g_new(Bulge, TILE * TILE);
    for (uint32_t tile = first; tile < last; tile++)
        raise_tile(user, tile, bulge);
    g_free(bulge);
}

const float *painter_vein_height(Painter *p)
{
    if (p->vein_height != NULL)
        return p->vein_height;
    gsize n = (gsize)p->width * p->rows;
    p->vein_height = g_new0(float, n);
    p->halo = g_new0(float, n);
    /* The bulge is smooth: strokes may be coarser than for coverage, which matters for wide veins of short segments. */
    Relief r = {.p = p, .strokes = strokes_new(p->net, &p->frame, (StrokeTolerance){0.1, 0.03})};
    bins_init(&r.bins, p->width, p->rows, r.strokes->n, relief_shape, &r);
    parallel_for(p->style.threads, r.bins.nx * r.bins.ny, 16, raise_tiles, &r);
    bins_clear(&r.bins);
    strokes_free(r.strokes);
    return p->vein_height;
}

const float *painter_halo(Painter *p)
{
    painter_vein_height(p);
    return p->halo;
}
