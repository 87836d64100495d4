/* Which vein a pixel belongs to. */
#include <glib.h>

#include "image/painter.h"
#include "image/pixels.h"

/* A pixel belongs to a vein when its centre lies in the vein drawn at least one pixel wide: so a thin vein gives an
 * unbroken line of pixels, and a wide one no more than its own. Just outside it lies beside the vein; such pixels take
 * its colour in part. */
static const double least_radius = 0.5, beside = 0.75; /* pixels */

typedef struct {
    uint32_t stroke; /* OWNER_NONE: none */
    bool within;
    uint8_t order;
    uint32_t vein;
    double radius, distance; /* of the cross-section here; to the surface */
} Claim;

/* Within a vein beats beside one. Of several veins the lowest order wins, then the widest, then the lower number; of
 * the pieces of one vein the one whose axis is nearest for its radius. Beside veins the nearest wins. */
static bool stronger(const Claim *a, const Claim *b)
{
    if (b->stroke == OWNER_NONE || a->within != b->within)
        return b->stroke == OWNER_NONE || a->within;
    if (!a->within)
        return a->distance < b->distance;
    if (a->vein == b->vein)
        return a->distance * b->radius < b->distance * a->radius;
    if (a->order != b->order)
        return a->order < b->order;
    return a->radius != b->radius ? a->radius > b->radius : a->vein < b->vein;
}

static void claim_tile(const Painter *p, TileBox box, uint32_t stroke, Claim *best)
{
    const Stroke *s = &p->strokes->v[stroke];
    const Capsule *k = &s->shape;
    Capsule wide = capsule_new(k->a, k->ra + beside, k->b, k->rb + beside);
    uint32_t y0, y1;
    pixel_rows(&wide, box.y0, box.y1, &y0, &y1);
    for (uint32_t y = y0; y < y1; y++) {
        uint32_t x0, x1;
        pixels_centred(capsule_chord(&wide, y + 0.5), box.x0, box.x1, &x0, &x1);
        for (uint32_t x = x0; x < x1; x++) {
            double t, distance = capsule_distance(k, vec2(x + 0.5, y + 0.5), &t), radius = capsule_radius(k, t);
            bool within = distance <= MAX(least_radius - radius, 0.0);
            Claim c = {stroke, within, s->order, s->vein, radius, distance};
            Claim *old = &best[(y - box.y0) * TILE + x - box.x0];
            if (stronger(&c, old))
                *old = c;
        }
    }
}

static void claim_tiles(uint32_t first, uint32_t last, void *user)
{
    Painter *p = user;
    Claim *best = g_new(Claim, TILE * TILE);
    for (uint32_t tile = first; tile < last; tile++) {
        TileBox box = bins_tile(&p->bins, tile);
        for (int i = 0; i < TILE * TILE; i++)
            best[i].stroke = OWNER_NONE;
        uint32_t to = p->bins.start[tile + 1];
        for (uint32_t i = p->bins.start[tile]; i < to; i++) {
            bins_ahead(&p->bins, i, to, p->strokes->v, sizeof *p->strokes->v);
            claim_tile(p, box, p->bins.item[i], best);
        }
        for (uint32_t y = box.y0; y < box.y1; y++) {
            uint32_t *out = label_row(p, &p->owner, y);
            for (uint32_t x = box.x0; x < box.x1; x++) {
                const Claim *c = &best[(y - box.y0) * TILE + x - box.x0];
                out[x] = c->stroke != OWNER_NONE && !c->within ? c->stroke | OWNER_BESIDE : c->stroke;
            }
        }
    }
    g_free(best);
}

const uint32_t *painter_owner(Painter *p)
{
    painter_strokes(p);
    painter_tiles(p, &p->bins, field_begin(p, &p->owner), claim_tiles, p);
    return p->owner.px;
}
