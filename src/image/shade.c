/* What the leaf looks like: colours of both sides, roughness, translucency. Light is mixed linearly. */
#include <glib.h>
#include <string.h>

#include "geom/wide.h"
#include "image/painter.h"

/* Pixels are worked on in short stretches of a row, quantity by quantity, in loops that vector instructions take in. */
enum { STRETCH = 64 };

/* Numbers that belong to the pixels of a stretch. */
typedef double Lane[STRETCH];

typedef struct {
    Painter *p;
    MapId id;
    Plane *plane;
    bool abaxial;
    const float *lamina, *vein; /* colours of the side */
    double least;               /* strength of the finest veins' colour, see least_strength */
    const Photo *photo;         /* the side's colours, or NULL */
} Look;

enum { N_LOOKS = 4 };

/* Maps that are painted together, as they depend on the same. */
typedef struct {
    Painter *p;
    Box2 box; /* of the blade */
    Look look[N_LOOKS];
    uint32_t n;
} View;

/* What there is at the pixels of a stretch. */
typedef struct {
    uint32_t n;
    bool shown[STRETCH]; /* is the pixel of the blade, or of the padding? */
    Lane along;          /* 0 at the base of the blade, 1 at its tip */
    Lane cover;          /* part of the blade here that veins cover */
    Lane share;          /* width of the vein here as part of the stout ones */
    Lane across;         /* 0 on its axis, 1 at its edge */
    Lane middle;         /* 0 at a vein, 1 in the middle of a mesh */
    Lane bulge;          /* segments */
    Lane nearness;       /* of larger veins */
    Lane inset;          /* pixels */
    Lane noise[N_NOISE];
} Spots;

static const double usual_middle = 0.4; /* mean of Spots.middle in a net */

static inline double mix(double a, double b, double t)
{
    return a + (b - a) * t;
}

/* ---- what there is ---- */

static void spot_vein(const Painter *p, Spots *s, uint32_t i, uint32_t owner, uint32_t x, uint32_t y)
{
    if (owner == OWNER_NONE || !(s->cover[i] > 0.0))
        return;
    const Stroke *k = &p->strokes->v[owner & ~OWNER_BESIDE];
    Vec2 at = vec2(x + 0.5, y + 0.5);
    double t;
    capsule_distance(&k->shape, at, &t);
    double radius = capsule_radius(&k->shape, t), aside = fabs(vec_cross(k->shape.d, vec_sub(at, k->shape.a)));
    s->share[i] = MIN(2.0 * radius / p->frame.scale / p->stout, 1.0);
    /* Veins of a few pixels have no room for shading across. An end is shaded as what it ends is, for another vein may go on there. */
    s->across[i] = radius > 1.0 ? mix(0.5, MIN(aside / radius, 1.0), MIN(radius - 1.0, 1.0)) : 0.5;
}

static double along(const View *v, double up)
{
    return CLAMP((up - v->box.y0) / MAX(v->box.y1 - v->box.y0, 1e-9), 0.0, 1.0);
}

/* The blade at a place, image coordinates, of the margin, as if there were no veins. */
static void spot_beyond(const View *v, Spots *s, uint32_t i, Vec2 at)
{
    const Painter *p = v->p;
    Vec2 pos = vec2(p->frame.corner.x + at.x / p->frame.scale, p->frame.corner.y - at.y / p->frame.scale);
    s->along[i] = along(v, pos.y);
    s->cover[i] = s->bulge[i] = s->nearness[i] = s->inset[i] = 0.0;
    s->middle[i] = usual_middle;
    for (int k = 0; k < N_NOISE; k++)
        s->noise[k][i] = noise_at(&p->noise[k], pos);
}

static inline void widen(const Painter *p, const Field *f, uint32_t x, uint32_t y, uint32_t n, double *out)
{
    const float *in = field_row(p, f, y) + x;
    for (uint32_t i = 0; i < n; i++)
        out[i] = (double)in[i];
}

/* As if all pixels were of the blade. */
WIDE static void spots_within(const View *v, uint32_t x, uint32_t y, Spots *s)
{
    const Painter *p = v->p;
    const float *cover = field_row(p, &p->cover, y) + x, *blade = field_row(p, &p->blade, y) + x, *away = field_row(p, &p->away, y) + x;
    double place = along(v, p->frame.corner.y - (y + 0.5) / p->frame.scale), half_mesh = 0.5 * p->spacing * p->frame.scale;
    uint32_t n = s->n;
    for (uint32_t i = 0; i < n; i++) {
        s->along[i] = place;
        s->share[i] = s->across[i] = 0.0;
    }
    for (uint32_t i = 0; i < n; i++) {
        double part = (double)cover[i] / MAX((double)blade[i], 1e-30);
        s->cover[i] = MIN(part, 1.0);
    }
    for (uint32_t i = 0; i < n; i++)
        s->middle[i] = smoothstep((double)away[i] / half_mesh);
    widen(p, &p->bulge, x, y, n, s->bulge);
    widen(p, &p->nearness, x, y, n, s->nearness);
    widen(p, &p->inset, x, y, n, s->inset);
    for (int k = 0; k < N_NOISE; k++)
        widen(p, &p->grain[k], x, y, n, s->noise[k]);
}

static bool any_near(const Painter *p, uint32_t x, uint32_t y, uint32_t n)
{
    const float *blade = field_row(p, &p->blade, y) + x;
    const uint32_t *side = label_row(p, &p->side, y) + x;
    uint32_t near = 0;
    for (uint32_t i = 0; i < n; i++)
        near |= (uint32_t)(blade[i] > 0.0f) | (uint32_t)(side[i] != OWNER_NONE);
    return near != 0;
}

/* Pixels x … x + s->n - 1 of row y; FALSE when none is shown. */
static bool spots_fill(const View *v, uint32_t x, uint32_t y, Spots *s)
{
    const Painter *p = v->p;
    if (!any_near(p, x, y, s->n))
        return false;
    const float *blade = field_row(p, &p->blade, y) + x;
    const uint32_t *owner = label_row(p, &p->owner, y) + x;
    bool any = false;
    Vec2 at;
    spots_within(v, x, y, s);
    for (uint32_t i = 0; i < s->n; i++) {
        s->shown[i] = true;
        if (blade[i] > 0.0f)
            spot_vein(p, s, i, owner[i], x + i, y);
        else if (painter_padded(p, x + i, y, &at))
            spot_beyond(v, s, i, at);
        else
            s->shown[i] = false;
        any = any || s->shown[i];
    }
    return any;
}

/* ---- colours ---- */

/* How far a vein's colour stands out from the blade's: fully in stout ones, hardly in veinlets, and as smoothly in between as
 * veins taper. The root lifts the middle orders, whose widths go down by a factor of about five from each to the next. */
static inline double vein_strength(const Look *l, double share)
{
    return mix(l->least, 1.0, sqrt(share));
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
static inline double tint(double c, double by)
{
    return c * by / (1.0 + c * (by - 1.0));
}

/* Unevenness of the blade: brightness and, along with it, a drift between yellow and blue green. */
static inline void unevenness(const Look *l, const Spots *s, Lane out[3])
{
    double strength = l->p->style.variation * (l->abaxial ? 0.6 : 1.0);
    const double *blotch = s->noise[BLOTCH], *patch = s->noise[PATCH], *mottle = s->noise[MOTTLE], *grain = s->noise[GRAIN];
    for (uint32_t i = 0; i < s->n; i++) {
        double bright = 0.50 * blotch[i] + 0.40 * patch[i] + 0.32 * mottle[i] + 0.22 * grain[i];
        double yellow = 0.8 * s->noise[TINT][i] + 0.3 * patch[i] + 0.5 * (0.5 - s->along[i]);
        bright = 1.0 + strength * (bright + 0.12 * (0.5 - s->along[i]));
        bright = MAX(bright, 0.2);
        yellow *= 0.55 * strength;
        double red = 1.0 + 0.8 * yellow, green = 1.0 + 0.15 * yellow, blue = 1.0 - 0.6 * yellow;
        out[0][i] = bright * MAX(red, 0.2);
        out[1][i] = bright * MAX(green, 0.2);
        out[2][i] = bright * MAX(blue, 0.2);
    }
}

/* A narrow band along the margin, of uneven width: how far its colour goes. FALSE when there is none of it. */
static inline bool margin_band(const Look *l, const Spots *s, double *edge)
{
    uint32_t any = 0;
    if (l->p->net->margin == NULL)
        return false;
    for (uint32_t i = 0; i < s->n; i++) {
        double limit = l->p->rim * (0.75 + 0.4 * s->noise[PATCH][i]);
        edge[i] = 1.0 - smoothstep(s->inset[i] / limit);
        any |= (uint32_t)(edge[i] > 0.0);
    }
    return any != 0;
}

/* The blade takes on something of the veins' colour along large ones, and is most itself in the middle of a mesh, where
 * the mesophyll is thickest. Both are parts of the way from one colour to the other: where there is no contrast there is
 * neither. */
WIDE static void lamina_colour(const Look *l, const Spots *s, Lane out[3])
{
    Lane uneven[3], edge;
    double by_halo = l->abaxial ? 0.07 : 0.12, by_fill = l->abaxial ? 0.03 : 0.07, by_edge = l->abaxial ? 0.5 : 0.7;
    unevenness(l, s, uneven);
    bool has_edge = margin_band(l, s, edge);
    for (int c = 0; c < 3; c++) {
        double base = (double)l->lamina[c], margin = (double)l->p->style.margin[c], to_vein = (double)l->vein[c] - base;
        double band = l->abaxial ? 0.5 * (margin + base) : margin, least = 0.6 * base;
        for (uint32_t i = 0; i < s->n; i++) {
            double near = by_halo * s->nearness[i] - by_fill * (s->middle[i] - usual_middle), own = base + near * to_vein;
            out[c][i] = tint(clamped(own, least, 1.0), uneven[c][i]);
        }
        for (uint32_t i = 0; has_edge && i < s->n; i++)
            out[c][i] = mix(out[c][i], tint(band, uneven[c][i]), by_edge * edge[i]);
    }
}

static void vein_colour(const Look *l, const Spots *s, uint32_t i, Lane out[3])
{
    double strength = vein_strength(l, s->share[i]);
    /* rounded: lighter along the axis, deeper at the edges, which melt into the blade */
    double shade = (l->abaxial ? 1.05 : 1.03) - 0.16 * s->across[i] * s->across[i] + 0.10 * l->p->style.variation * s->noise[MOTTLE][i];
    double melt = s->cover[i] * (1.0 - 0.35 * smoothstep(2.0 * s->across[i] - 1.0));
    for (int c = 0; c < 3; c++) {
        double v = mix(out[c][i], tint((double)l->vein[c], shade), strength);
        out[c][i] = mix(out[c][i], v, melt);
    }
}

static void look_colour(const Look *l, const Spots *s, float *out)
{
    Lane colour[3];
    lamina_colour(l, s, colour);
    for (uint32_t i = 0; i < s->n; i++)
        if (s->cover[i] > 0.0)
            vein_colour(l, s, i, colour);
    for (uint32_t i = 0; i < s->n; i++)
        for (int c = 0; c < 3; c++)
            out[3 * i + (uint32_t)c] = s->shown[i] ? (float)clamped(colour[c][i], 0.0, 1.0) : 0.0f;
}

/* ---- other looks ---- */

WIDE static void look_roughness(const Look *l, const Spots *s, double *out)
{
    double gloss = l->p->style.gloss, variation = l->p->style.variation;
    for (uint32_t i = 0; i < s->n; i++) {
        double vein = s->cover[i] * (0.4 + 0.6 * vein_strength(l, s->share[i]));
        double rough = 0.82 - 0.5 * gloss + 0.16 * vein * gloss + 0.03 * s->middle[i];
        rough += 0.10 * variation * (s->noise[MOTTLE][i] + 0.6 * s->noise[GRAIN][i]);
        out[i] = clamped(rough, 0.02, 1.0);
    }
}

/* Light is weakened by each thickness alike: 1 / (1 + x) stands in for the exponential. */
WIDE static void look_translucency(const Look *l, const Spots *s, double *out)
{
    double lamina = MAX(l->p->style.thickness, 1e-3), variation = l->p->style.variation, rim = l->p->rim;
    for (uint32_t i = 0; i < s->n; i++) {
        double bulge = s->bulge[i] / lamina;
        double uneven = 1.0 + 0.25 * variation * (s->noise[PATCH][i] + s->noise[MOTTLE][i] + 0.5 * s->noise[GRAIN][i]);
        double edge = 1.0 - smoothstep(s->inset[i] / rim), light = (0.72 + 0.05 * edge) * uneven / (1.0 + 0.9 * bulge);
        out[i] = clamped(light, 0.0, 1.0);
    }
}

static void look_stretch(const Look *l, const Spots *s, float *out)
{
    Lane value;
    if (l->id == MAP_ROUGHNESS)
        look_roughness(l, s, value);
    else if (l->id == MAP_TRANSLUCENCY)
        look_translucency(l, s, value);
    else {
        look_colour(l, s, out);
        return;
    }
    for (uint32_t i = 0; i < s->n; i++)
        out[i] = s->shown[i] ? (float)value[i] : 0.0f;
}

static void look_row(uint32_t y, void *user)
{
    const View *v = user;
    uint32_t width = v->p->width;
    Spots s;
    for (uint32_t x = 0; x < width; x += STRETCH) {
        s.n = MIN(width - x, (uint32_t)STRETCH);
        bool any = spots_fill(v, x, y, &s);
        for (uint32_t i = 0; i < v->n; i++) {
            Plane *plane = v->look[i].plane;
            float *out = plane_row(v->p, plane, y) + (gsize)x * plane->channels;
            if (any)
                look_stretch(&v->look[i], &s, out);
            else
                memset(out, 0, s.n * plane->channels * sizeof *out);
        }
    }
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
    memset(out, 0, (gsize)l->p->width * l->plane->channels * sizeof *out);
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

/* ---- maps ---- */

static const MapId looks[N_LOOKS] = {MAP_BASE_COLOR, MAP_ABAXIAL_BASE_COLOR, MAP_ROUGHNESS, MAP_TRANSLUCENCY};

bool paint_is_look(MapId id)
{
    bool is = false;
    for (int i = 0; i < N_LOOKS; i++)
        is = is || looks[i] == id;
    return is;
}

static Look look_of(Painter *p, MapId id)
{
    Look l = {.p = p, .id = id, .plane = painter_plane(p, id), .abaxial = id == MAP_ABAXIAL_BASE_COLOR};
    l.lamina = l.abaxial ? p->style.abaxial_lamina : p->style.lamina;
    l.vein = l.abaxial ? p->style.abaxial_vein : p->style.vein;
    l.least = least_strength(&l);
    l.photo = id == MAP_BASE_COLOR || id == MAP_ABAXIAL_BASE_COLOR ? p->style.photo[l.abaxial] : NULL;
    return l;
}

/* Those of the maps that are wanted along with map `id`; they are kept until they are asked for. */
static void add_others(View *v, MapId id)
{
    for (int i = 0; i < N_LOOKS; i++) {
        Painter *p = v->p;
        bool photo = looks[i] <= MAP_ABAXIAL_BASE_COLOR && p->style.photo[looks[i]] != NULL;
        if (looks[i] == id || !p->expected[looks[i]] || p->kept[looks[i]] != NULL || photo)
            continue;
        v->look[v->n] = look_of(p, looks[i]);
        p->kept[looks[i]] = v->look[v->n++].plane;
    }
}

Plane *paint_look(Painter *p, MapId id)
{
    if (p->kept[id] != NULL)
        return g_steal_pointer(&p->kept[id]);
    View v = {.p = p, .box = painter_blade_box(p), .look = {look_of(p, id)}, .n = 1};
    if (v.look[0].photo)
        return paint_photo(&v.look[0]);
    add_others(&v, id);
    painter_cover(p);
    painter_owner(p);
    painter_away(p);
    painter_inset(p);
    painter_relief(p);
    painter_noise(p);
    painter_rows(p, p->y0, p->y1, look_row, &v);
    return v.look[0].plane;
}
