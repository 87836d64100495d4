/* What the leaf looks like: colours of both sides, roughness, translucency. Light is mixed linearly. */
#include <glib.h>
#include <string.h>

#include "image/painter.h"

typedef struct {
    Painter *p;
    MapId id;
    Plane *plane;
    Box2 box; /* of the blade */
    bool abaxial;
    const float *lamina, *vein; /* colours of the side */
    double least;               /* strength of the finest veins' colour, see vein_strength */
    const Photo *photo;         /* the side's colours, or NULL */
} Look;

/* What there is at one pixel. */
typedef struct {
    double up;       /* segments */
    double cover;    /* part of the blade here that veins cover */
    double share;    /* width of the vein here as part of the stout ones */
    double across;   /* 0 on its axis, 1 at its edge */
    double middle;   /* 0 at a vein, 1 in the middle of a mesh */
    double bulge;    /* segments */
    double nearness; /* of larger veins */
    double inset;    /* pixels */
    double noise[N_NOISE];
} Spot;

static const double usual_middle = 0.4; /* mean of Spot.middle in a net */

static double smoothstep(double t)
{
    t = CLAMP(t, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

static double mix(double a, double b, double t)
{
    return a + (b - a) * t;
}

static void spot_vein(const Painter *p, Spot *s, uint32_t owner, uint32_t x, uint32_t y)
{
    if (owner == OWNER_NONE || !(s->cover > 0.0))
        return;
    const Stroke *k = &p->strokes->v[owner & ~OWNER_BESIDE];
    Vec2 at = vec2(x + 0.5, y + 0.5);
    double t;
    capsule_distance(&k->shape, at, &t);
    double radius = capsule_radius(&k->shape, t), aside = fabs(vec_cross(k->shape.d, vec_sub(at, k->shape.a)));
    s->share = MIN(2.0 * radius / p->frame.scale / p->stout, 1.0);
    /* Veins of a few pixels have no room for shading across. An end is shaded as what it ends is, for another vein may go on there. */
    s->across = radius > 1.0 ? mix(0.5, MIN(aside / radius, 1.0), MIN(radius - 1.0, 1.0)) : 0.5;
}

/* A pixel of the blade. */
static Spot spot_at(const Look *l, uint32_t x, uint32_t y)
{
    const Painter *p = l->p;
    Spot s = {.up = p->frame.corner.y - (y + 0.5) / p->frame.scale};
    s.cover = MIN((double)field_row(p, &p->cover, y)[x] / (double)field_row(p, &p->blade, y)[x], 1.0);
    s.middle = smoothstep((double)field_row(p, &p->away, y)[x] / (0.5 * p->spacing * p->frame.scale));
    s.bulge = (double)field_row(p, &p->bulge, y)[x];
    s.nearness = (double)field_row(p, &p->nearness, y)[x];
    s.inset = (double)field_row(p, &p->inset, y)[x];
    for (int i = 0; i < N_NOISE; i++)
        s.noise[i] = (double)field_row(p, &p->grain[i], y)[x];
    spot_vein(p, &s, label_row(p, &p->owner, y)[x], x, y);
    return s;
}

/* The blade at a place, image coordinates, of the margin, as if there were no veins. */
static Spot spot_beyond(const Look *l, Vec2 at)
{
    const Painter *p = l->p;
    Vec2 pos = vec2(p->frame.corner.x + at.x / p->frame.scale, p->frame.corner.y - at.y / p->frame.scale);
    Spot s = {.up = pos.y, .middle = usual_middle};
    for (int i = 0; i < N_NOISE; i++)
        s.noise[i] = noise_at(&p->noise[i], pos);
    return s;
}

/* How far a vein's colour stands out from the blade's: fully in stout ones, hardly in veinlets, and as smoothly in between as
 * veins taper. The root lifts the middle orders, whose widths go down by a factor of about five from each to the next. */
static double vein_strength(const Look *l, const Spot *s)
{
    return mix(l->least, 1.0, sqrt(s->share));
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
    double along = CLAMP((s->up - l->box.y0) / height, 0.0, 1.0);
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
    double halo = (l->abaxial ? 0.07 : 0.12) * s->nearness;
    double fill = (l->abaxial ? 0.03 : 0.07) * (s->middle - usual_middle);
    double uneven[3], near = halo - fill;
    unevenness(l, s, uneven);
    /* a narrow band along the margin, of uneven width */
    double limit = l->p->rim * (0.75 + 0.4 * s->noise[PATCH]);
    double edge = l->p->net->margin != NULL ? 1.0 - smoothstep(s->inset / limit) : 0.0;
    for (int i = 0; i < 3; i++) {
        double base = (double)l->lamina[i], margin = (double)l->p->style.margin[i];
        double own = CLAMP(base + near * ((double)l->vein[i] - base), 0.6 * base, 1.0);
        double band = l->abaxial ? 0.5 * (margin + base) : margin;
        out[i] = tint(own, uneven[i]);
        if (edge > 0.0)
            out[i] = mix(out[i], tint(band, uneven[i]), (l->abaxial ? 0.5 : 0.7) * edge);
    }
}

static void look_colour(const Look *l, const Spot *s, float *out)
{
    double lamina[3];
    lamina_colour(l, s, lamina);
    if (!(s->cover > 0.0)) {
        for (int i = 0; i < 3; i++)
            out[i] = (float)CLAMP(lamina[i], 0.0, 1.0);
        return;
    }
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
    double lamina = MAX(l->p->style.thickness, 1e-3), bulge = s->bulge / lamina;
    double uneven = 1.0 + 0.25 * l->p->style.variation * (s->noise[PATCH] + s->noise[MOTTLE] + 0.5 * s->noise[GRAIN]);
    double edge = 1.0 - smoothstep(s->inset / l->p->rim);
    return CLAMP((0.72 + 0.05 * edge) * uneven / (1.0 + 0.9 * bulge), 0.0, 1.0);
}

static void look_at(const Look *l, const Spot *s, float *out)
{
    if (l->id == MAP_ROUGHNESS)
        *out = (float)look_roughness(l, s);
    else if (l->id == MAP_TRANSLUCENCY)
        *out = (float)look_translucency(l, s);
    else
        look_colour(l, s, out);
}

/* ---- the colours of a scan ---- */

/* The scan shows nothing but leaf, beyond its margin too (scan/fill.h). */
static void photo_at(const Look *l, uint32_t x, uint32_t y, float *out)
{
    const Painter *p = l->p;
    Vec2 beyond;
    if (!(field_row(p, &p->blade, y)[x] > 0.0f) && !painter_padded(p, x, y, &beyond))
        return;
    Vec2 place = vec2(p->frame.corner.x + (x + 0.5) / p->frame.scale, p->frame.corner.y - (y + 0.5) / p->frame.scale);
    photo_colour(l->photo, place, 1.0 / p->frame.scale, out);
}

static void photo_row(uint32_t y, void *user)
{
    const Look *l = user;
    float *out = plane_row(l->p, l->plane, y);
    for (uint32_t x = 0; x < l->p->width; x++)
        photo_at(l, x, y, out + (gsize)x * l->plane->channels);
}

static Plane *paint_photo(Look *l)
{
    Painter *p = l->p;
    painter_blade(p);
    painter_inset(p);
    painter_rows(p, p->y0, p->y1, photo_row, l);
    return l->plane;
}

static void look_row(uint32_t y, void *user)
{
    const Look *l = user;
    const Painter *p = l->p;
    const float *blade = field_row(p, &p->blade, y);
    float *out = plane_row(p, l->plane, y);
    Vec2 at;
    for (uint32_t x = 0; x < p->width; x++, out += l->plane->channels) {
        if (blade[x] > 0.0f) {
            Spot s = spot_at(l, x, y);
            look_at(l, &s, out);
        } else if (painter_padded(p, x, y, &at)) {
            Spot s = spot_beyond(l, at);
            look_at(l, &s, out);
        }
    }
}

/* ---- noise ---- */

/* Of the blade, or of the image when there is none. */
static Box2 blade_box(const Painter *p)
{
    Vec2 far = vec2(p->frame.corner.x + p->width / p->frame.scale, p->frame.corner.y - p->rows / p->frame.scale);
    return p->net->margin != NULL ? p->net->margin->box : (Box2){p->frame.corner.x, far.y, far.x, p->frame.corner.y};
}

/* From a third of the leaf down to a part of a mesh. */
static void choose_noise(Painter *p)
{
    Box2 box = blade_box(p);
    double length = MAX(MAX(box.x1 - box.x0, box.y1 - box.y0), 1e-6);
    double wave[N_NOISE] = {0.33 * length, 0.10 * length, MAX(0.022 * length, 2.0 * p->spacing), 0.45 * p->spacing,
                            0.26 * length};
    for (uint32_t i = 0; i < N_NOISE; i++)
        noise_init(&p->noise[i], p->style.seed, i, wave[i], box, p->frame.scale);
    p->has_noise = true;
}

static void noise_of_row(uint32_t y, void *user)
{
    const Painter *p = user;
    const float *blade = field_row(p, &p->blade, y);
    uint32_t first = 0, last = p->width;
    while (first < last && !(blade[first] > 0.0f))
        first++;
    while (last > first && !(blade[last - 1] > 0.0f))
        last--;
    Vec2 start = vec2(p->frame.corner.x + 0.5 / p->frame.scale, p->frame.corner.y - (y + 0.5) / p->frame.scale);
    for (int i = 0; i < N_NOISE; i++)
        noise_row(&p->noise[i], start, 1.0 / p->frame.scale, first, last, field_row(p, &p->grain[i], y));
}

void painter_noise(Painter *p)
{
    if (!p->has_noise)
        choose_noise(p);
    painter_blade(p);
    uint32_t from = p->bottom;
    for (int i = 0; i < N_NOISE; i++)
        from = field_begin(p, &p->grain[i]);
    painter_rows(p, from, p->bottom, noise_of_row, p);
}

Plane *paint_look(Painter *p, MapId id)
{
    Look l = {.p = p, .id = id, .plane = painter_plane(p, id), .box = blade_box(p), .abaxial = id == MAP_ABAXIAL_BASE_COLOR};
    l.lamina = l.abaxial ? p->style.abaxial_lamina : p->style.lamina;
    l.vein = l.abaxial ? p->style.abaxial_vein : p->style.vein;
    l.least = least_strength(&l);
    l.photo = id == MAP_BASE_COLOR || id == MAP_ABAXIAL_BASE_COLOR ? p->style.photo[l.abaxial] : NULL;
    if (l.photo)
        return paint_photo(&l);
    painter_cover(p);
    painter_owner(p);
    painter_away(p);
    painter_inset(p);
    painter_relief(p);
    painter_noise(p);
    painter_rows(p, p->y0, p->y1, look_row, &l);
    return l.plane;
}
