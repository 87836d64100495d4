/* What the leaf looks like: colours of both sides, roughness, translucency. Light is mixed linearly. */
#include <glib.h>
#include <string.h>

#include "image/noise.h"
#include "image/painter.h"

enum { BLOTCH, PATCH, MOTTLE, GRAIN, TINT, N_NOISE };

typedef struct {
    Painter *p;
    MapId id;
    Plane *plane;
    Noise noise[N_NOISE];
    Box2 box; /* of the blade */
    bool abaxial;
    const float *lamina, *vein; /* colours of the side */
    double least;               /* strength of the finest veins' colour, see vein_strength */
} Look;

/* What there is at one pixel. */
typedef struct {
    gsize at;
    Vec2 pos;      /* segments */
    double cover;  /* part of the blade here that veins cover */
    double share;  /* width of the vein here as part of the stout ones */
    double across; /* 0 on its axis, 1 at its edge */
    double order;
    double middle; /* 0 at a vein, 1 in the middle of a mesh */
    double noise[N_NOISE];
} Spot;

static double smoothstep(double t)
{
    t = CLAMP(t, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

static double mix(double a, double b, double t)
{
    return a + (b - a) * t;
}

static void spot_vein(const Painter *p, Spot *s, uint32_t x, uint32_t y)
{
    uint32_t owner = p->owner[s->at];
    if (owner == OWNER_NONE || !(s->cover > 0.0))
        return;
    const Stroke *k = &p->strokes->v[owner & ~OWNER_BESIDE];
    double t, distance = capsule_distance(&k->shape, vec2(x + 0.5, y + 0.5), &t), radius = capsule_radius(&k->shape, t);
    s->share = MIN(2.0 * radius / p->frame.scale / p->stout, 1.0);
    s->order = k->order;
    /* veins of a few pixels have no room for shading across */
    s->across = radius > 1.0 ? mix(0.5, CLAMP((distance + radius) / radius, 0.0, 1.0), MIN(radius - 1.0, 1.0)) : 0.5;
}

static Spot spot_at(const Look *l, uint32_t x, uint32_t y)
{
    const Painter *p = l->p;
    Spot s = {.at = (gsize)y * p->width + x};
    s.pos = vec2(p->frame.corner.x + (x + 0.5) / p->frame.scale, p->frame.corner.y - (y + 0.5) / p->frame.scale);
    s.cover = MIN((double)p->cover[s.at] / (double)p->blade[s.at], 1.0);
    s.middle = smoothstep((double)p->away[s.at] / (0.5 * p->spacing * p->frame.scale));
    for (int i = 0; i < N_NOISE; i++)
        s.noise[i] = noise_at(&l->noise[i], s.pos);
    spot_vein(p, &s, x, y);
    return s;
}

/* How far a vein's colour stands out from the blade's: fully in stout ones, hardly in veinlets. */
static double vein_strength(const Look *l, const Spot *s)
{
    double base = l->least, by_width = base + (1.0 - base) * sqrt(sqrt(s->share) * s->share);
    double by_order = s->order <= 1.0 ? 1.0 : s->order <= 2.0 ? 0.5 : s->order <= 3.0 ? 0.32 : 0.0;
    return MAX(by_width, by_order * (l->abaxial ? 0.9 : 1.0));
}

/* Where the colours are close, as in petals, even veinlets differ from the blade by more of the little there is; the
 * square root stands in for the eye's response. */
static double least_strength(const Look *l)
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        double d = sqrt((double)l->vein[i]) - sqrt((double)l->lamina[i]);
        sum += d * d;
    }
    double contrast = sqrt(sum / 3.0);
    return CLAMP(0.075 / MAX(contrast, 1e-6), 0.2, 0.45);
}

/* Makes a colour `by` times as bright where it is dark; the nearer it is to white the less it can change either way, for
 * what varies is the pigment. Never leaves 0 … 1. */
static double tint(double c, double by)
{
    return c * by / (1.0 + c * (by - 1.0));
}

/* Unevenness of the blade: brightness and, along with it, a drift between yellow and blue green. */
static void unevenness(const Look *l, const Spot *s, double out[3])
{
    double strength = l->p->style.variation * (l->abaxial ? 0.6 : 1.0), height = MAX(l->box.y1 - l->box.y0, 1e-9);
    double along = CLAMP((s->pos.y - l->box.y0) / height, 0.0, 1.0);
    double bright = 0.50 * s->noise[BLOTCH] + 0.40 * s->noise[PATCH] + 0.32 * s->noise[MOTTLE] + 0.22 * s->noise[GRAIN];
    double yellow = 0.8 * s->noise[TINT] + 0.3 * s->noise[PATCH] + 0.5 * (0.5 - along);
    bright = MAX(1.0 + strength * (bright + 0.12 * (0.5 - along)), 0.2);
    yellow *= 0.55 * strength;
    out[0] = bright * MAX(1.0 + 0.8 * yellow, 0.2);
    out[1] = bright * MAX(1.0 + 0.15 * yellow, 0.2);
    out[2] = bright * MAX(1.0 - 0.6 * yellow, 0.2);
}

/* The blade takes on something of the veins' colour along large ones, and is most itself in the middle of a mesh, where
 * the mesophyll is thickest. Both are parts of the way from one colour to the other: where there is no contrast there is
 * neither. */
static void lamina_colour(const Look *l, const Spot *s, double out[3])
{
    double halo = (l->abaxial ? 0.07 : 0.12) * (double)l->p->halo[s->at];
    double fill = (l->abaxial ? 0.03 : 0.07) * (s->middle - 0.4);
    double uneven[3], near = halo - fill;
    unevenness(l, s, uneven);
    /* a narrow band along the margin, of uneven width */
    double limit = l->p->band * (0.75 + 0.4 * s->noise[PATCH]);
    double edge = l->p->net->margin != NULL ? 1.0 - smoothstep((double)l->p->inset[s->at] / limit) : 0.0;
    for (int i = 0; i < 3; i++) {
        double base = (double)l->lamina[i], margin = (double)l->p->style.margin[i];
        double own = CLAMP(base + near * ((double)l->vein[i] - base), 0.6 * base, 1.0);
        double band = l->abaxial ? 0.5 * (margin + base) : margin;
        out[i] = mix(tint(own, uneven[i]), tint(band, uneven[i]), (l->abaxial ? 0.5 : 0.7) * edge);
    }
}

static void look_colour(const Look *l, const Spot *s, float *out)
{
    double lamina[3];
    lamina_colour(l, s, lamina);
    double strength = vein_strength(l, s);
    /* rounded: lighter along the axis, deeper at the edges, which melt into the blade */
    double shade =
        (l->abaxial ? 1.05 : 1.03) - 0.16 * s->across * s->across + 0.10 * l->p->style.variation * s->noise[MOTTLE];
    double melt = s->cover * (1.0 - 0.35 * smoothstep(2.0 * s->across - 1.0));
    for (int i = 0; i < 3; i++) {
        double v = mix(lamina[i], tint((double)l->vein[i], shade), strength);
        out[i] = (float)CLAMP(mix(lamina[i], v, melt), 0.0, 1.0);
    }
}

static double look_roughness(const Look *l, const Spot *s)
{
    double gloss = l->p->style.gloss, vein = s->cover * (0.4 + 0.6 * vein_strength(l, s));
    double rough = 0.82 - 0.5 * gloss + 0.16 * vein * gloss + 0.03 * s->middle;
    return CLAMP(rough + 0.10 * l->p->style.variation * (s->noise[MOTTLE] + 0.6 * s->noise[GRAIN]), 0.02, 1.0);
}

/* Light is weakened by each thickness alike: 1 / (1 + x) stands in for the exponential. */
static double look_translucency(const Look *l, const Spot *s)
{
    double lamina = MAX(l->p->style.thickness, 1e-3), bulge = (double)l->p->vein_height[s->at] / lamina;
    double uneven = 1.0 + 0.25 * l->p->style.variation * (s->noise[PATCH] + s->noise[MOTTLE] + 0.5 * s->noise[GRAIN]);
    double edge = 1.0 - smoothstep((double)l->p->inset[s->at] / l->p->band);
    return CLAMP((0.72 + 0.05 * edge) * uneven / (1.0 + 0.9 * bulge), 0.0, 1.0);
}

static void look_row(uint32_t y, void *user)
{
    const Look *l = user;
    for (uint32_t x = 0; x < l->p->width; x++) {
        if (!(l->p->blade[(gsize)y * l->p->width + x] > 0.0f))
            continue;
        Spot s = spot_at(l, x, y);
        float *out = l->plane->px + s.at * l->plane->channels;
        if (l->id == MAP_ROUGHNESS)
            *out = (float)look_roughness(l, &s);
        else if (l->id == MAP_TRANSLUCENCY)
            *out = (float)look_translucency(l, &s);
        else
            look_colour(l, &s, out);
    }
}

/* From a third of the leaf down to a part of a mesh. */
static void look_noise(Look *l)
{
    const Painter *p = l->p;
    double length = MAX(MAX(l->box.x1 - l->box.x0, l->box.y1 - l->box.y0), 1e-6);
    double wave[N_NOISE] = {0.33 * length, 0.10 * length, MAX(0.022 * length, 2.0 * p->spacing), 0.45 * p->spacing,
                            0.26 * length};
    for (uint32_t i = 0; i < N_NOISE; i++)
        noise_init(&l->noise[i], p->style.seed, i, wave[i], l->box, p->frame.scale);
}

Plane *paint_look(Painter *p, MapId id)
{
    Look l = {.p = p, .id = id, .plane = painter_plane(p, id), .abaxial = id == MAP_ABAXIAL_BASE_COLOR};
    Vec2 far = vec2(p->frame.corner.x + p->width / p->frame.scale, p->frame.corner.y - p->rows / p->frame.scale);
    l.box = p->net->margin != NULL ? p->net->margin->box : (Box2){p->frame.corner.x, far.y, far.x, p->frame.corner.y};
    l.lamina = l.abaxial ? p->style.abaxial_lamina : p->style.lamina;
    l.vein = l.abaxial ? p->style.abaxial_vein : p->style.vein;
    l.least = least_strength(&l);
    painter_cover(p);
    painter_owner(p);
    painter_away(p);
    painter_inset(p);
    painter_halo(p);
    look_noise(&l);
    painter_rows(p, look_row, &l);
    for (int i = 0; i < N_NOISE; i++)
        noise_clear(&l.noise[i]);
    painter_pad(p, l.plane);
    return l.plane;
}
