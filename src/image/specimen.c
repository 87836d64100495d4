#include "image/specimen.h"

#include <glib.h>

#include "geom/dtrig.h"
#include "image/camera.h"
#include "image/painter.h"
#include "image/shadow.h"

/* Noise of the paper, at several sizes, and of the blade, which is never quite flat; parts of the image's longer side. Numbers of
 * fields go on after the painter's. */
enum { FIBRE, CLOUD, STAIN, TINGE, WAVE, RIPPLE, N_FIELDS, FIRST_FIELD = 16 };
static const double wavelength[N_FIELDS] = {1.0 / 500.0, 1.0 / 160.0, 1.0 / 11.0, 1.0 / 5.0, 1.0 / 6.0, 1.0 / 16.0};

struct Specimen {
    Painter *p;
    SpecimenDef def;
    Camera camera;
    double longer; /* side of the image, pixels */
    Vec2 from;     /* unit vector to where the light comes from, y up */
    Noise noise[N_FIELDS];
    Shadow *broad, *close; /* NULL: no shadow */
};

/* Maps of the rows at hand, and the scene that is made of them. */
typedef struct {
    const Specimen *s;
    Plane *base, *normal, *ao, *translucency, *scene; /* NULL: not needed */
    Plane *out;
    const float *blade;
} Scene;

SpecimenDef specimen_def_default(void)
{
    SpecimenDef d = {.grain = 0.3, .light = 0.6, .light_angle = 120.0, .sheen = 0.25, .falloff = 0.05, .vignette = 0.05, .shadow = 0.7,
                     .shadow_size = 0.014, .blur = 0.6, .contrast = 0.1, .noise = 0.006, .chroma_noise = 0.003};
    paint_colour(0xf3f1ec, d.background);
    return d;
}

Specimen *specimen_new(Painter *p, const SpecimenDef *def)
{
    Specimen *s = g_new0(Specimen, 1);
    Box2 image = {0.0, 0.0, p->width, p->rows};
    s->p = p;
    s->def = *def;
    s->longer = MAX(p->width, p->rows);
    dtrig_sin_cos(def->light_angle * DTRIG_DEGREE, &s->from.y, &s->from.x);
    camera_init(&s->camera, def);
    for (uint32_t i = 0; i < N_FIELDS; i++)
        if ((i < WAVE ? def->grain : def->light) > 0.0)
            noise_init(&s->noise[i], def->seed, FIRST_FIELD + i, wavelength[i] * s->longer, image, 1.0);
    if (def->shadow > 0.0 && def->backlight < 1.0) {
        s->broad = shadow_new(p, 0.5 * def->shadow_size * s->longer);
        s->close = shadow_new(p, 0.125 * def->shadow_size * s->longer);
    }
    p->surround = s->camera.reach;
    painter_band(p, p->y0, p->y1);
    return s;
}

void specimen_free(Specimen *s)
{
    if (s == NULL)
        return;
    for (int i = 0; i < N_FIELDS; i++)
        noise_clear(&s->noise[i]);
    shadow_free(s->broad);
    shadow_free(s->close);
    camera_clear(&s->camera);
    g_free(s);
}

/* ---- paper ---- */

/* The light that the leaf keeps from the paper at a place, 0 … 1: it lies on it, so most of it near by and some farther away, on the side away
 * from the light. */
static double shaded(const Specimen *s, double x, double y)
{
    static const double shift = 0.5; /* of the soft edge's width */
    double by = shift * s->def.shadow_size * s->longer * s->def.light;
    Vec2 toward = vec2(s->from.x * by, -s->from.y * by);
    double broad = shadow_at(s->broad, vec2(x + toward.x, y + toward.y)), close = shadow_at(s->close, vec2(x + 0.25 * toward.x, y + 0.25 * toward.y));
    return s->def.shadow * (1.0 - s->def.backlight) * (0.5 * broad + 0.5 * close);
}

static void paper_at(const Specimen *s, float *const noise[N_FIELDS], uint32_t x, uint32_t y, double out[3])
{
    double grain = s->def.grain, bright = 1.0, tinge = 0.0;
    if (grain > 0.0) {
        bright += grain * (0.11 * (double)noise[FIBRE][x] + 0.06 * (double)noise[CLOUD][x] + 0.06 * (double)noise[STAIN][x]);
        tinge = 0.035 * grain * (double)noise[TINGE][x];
    }
    if (s->broad != NULL)
        bright *= 1.0 - shaded(s, x + 0.5, y + 0.5);
    for (int k = 0; k < 3; k++)
        out[k] = (double)s->def.background[k] * bright * (1.0 + tinge * (1 - k));
}

/* ---- leaf ---- */

/* Light from one side at 45° and from all around, as much as a level blade has: 1 is that. */
static double lit(const Scene *c, const float *n, float *const noise[N_FIELDS], uint32_t x)
{
    const Specimen *s = c->s;
    double nx = 2.0 * (double)n[0] - 1.0, ny = 2.0 * (double)n[1] - 1.0, nz = 2.0 * (double)n[2] - 1.0;
    double side = nz + nx * s->from.x + ny * s->from.y - 1.0, uneven = 0.09 * (double)noise[WAVE][x] + 0.07 * (double)noise[RIPPLE][x];
    return MAX(1.0 + s->def.light * (side + uneven), 0.0);
}

static void leaf_at(const Scene *c, float *const noise[N_FIELDS], uint32_t x, gsize i, double out[3])
{
    const Specimen *s = c->s;
    double light = 1.0, through = s->def.backlight;
    if (s->def.light > 0.0)
        light = lit(c, c->normal->px + 3 * i, noise, x);
    if (c->ao != NULL)
        light *= 1.0 - MIN(s->def.light, 1.0) * (1.0 - (double)c->ao->px[i]);
    /* a wax sheds light from fewer directions, so that it shows slopes the more */
    double sheen = 0.13 * s->def.sheen * light * light * light * (1.0 - through);
    for (int k = 0; k < 3; k++) {
        double base = (double)c->base->px[3 * i + k];
        out[k] = base * light + sheen;
        if (through > 0.0) /* what comes through has met more pigment than what is thrown back */
            out[k] += through * (3.2 * (double)c->translucency->px[i] * base * sqrt(base) - out[k]);
    }
}

/* ---- scene ---- */

/* Part of the light that reaches a place of the image. */
static double level(const Specimen *s, double x, double y)
{
    const Painter *p = s->p;
    double u = (2.0 * x - p->width) / s->longer, v = (2.0 * y - p->rows) / s->longer;
    double corner = 1.0 + 0.5 * s->def.vignette * (u * u + v * v), along = CLAMP(0.5 - 0.5 * (u * s->from.x - v * s->from.y), 0.0, 1.0);
    return (1.0 - s->def.falloff * along) / (corner * corner);
}

static void scene_row(uint32_t y, void *user)
{
    const Scene *c = user;
    const Specimen *s = c->s;
    const Painter *p = s->p;
    gsize row = (gsize)(y - p->y0) * p->width;
    float *out = c->scene->px + 3 * row, *store = g_new0(float, (gsize)p->width * N_FIELDS), *noise[N_FIELDS];
    for (int i = 0; i < N_FIELDS; i++) {
        noise[i] = store + (gsize)i * p->width;
        if (s->noise[i].gradient != NULL)
            noise_row(&s->noise[i], vec2(0.5, y + 0.5), 1.0, 0, p->width, noise[i]);
    }
    for (uint32_t x = 0; x < p->width; x++) {
        double alpha = (double)c->blade[row + x], paper[3], leaf[3] = {0.0}, light = level(s, x + 0.5, y + 0.5);
        paper_at(s, noise, x, y, paper);
        if (alpha > 0.0)
            leaf_at(c, noise, x, row + x, leaf);
        for (int k = 0; k < 3; k++)
            out[3 * (gsize)x + k] = (float)((leaf[k] * alpha + paper[k] * (1.0 - alpha)) * light);
    }
    g_free(store);
}

static void picture_row(uint32_t y, void *user)
{
    const Scene *c = user;
    const Painter *p = c->s->p;
    uint32_t reach = c->s->camera.reach, top = p->y0 > reach ? p->y0 - reach : 0;
    float *scratch = g_new(float, 3 * (gsize)p->width);
    camera_row(&c->s->camera, c->scene, top, y, scratch, plane_row(p, c->out, y));
    g_free(scratch);
}

/* Paints what the scene is made of, in the rows that the picture's depend on. */
static void paint_scene(Scene *c)
{
    const Specimen *s = c->s;
    Painter *p = s->p;
    const SpecimenDef *d = &s->def;
    uint32_t y0 = p->y0, y1 = p->y1;
    p->y0 = y0 > s->camera.reach ? y0 - s->camera.reach : 0;
    p->y1 = MIN(y1 + s->camera.reach, p->rows);
    c->base = painter_paint(p, d->abaxial ? MAP_ABAXIAL_BASE_COLOR : MAP_BASE_COLOR);
    c->normal = d->light > 0.0 ? painter_paint(p, d->abaxial ? MAP_NORMAL_GL : MAP_ADAXIAL_NORMAL_GL) : NULL;
    c->ao = d->light > 0.0 && d->abaxial ? painter_paint(p, MAP_AO) : NULL;
    c->translucency = d->backlight > 0.0 ? painter_paint(p, MAP_TRANSLUCENCY) : NULL;
    painter_blade(p);
    c->blade = field_row(p, &p->blade, p->y0);
    c->scene = painter_sheet(p, 3, PLANE_COLOUR);
    painter_rows(p, p->y0, p->y1, scene_row, c);
    p->y0 = y0;
    p->y1 = y1;
}

Plane *specimen_paint(Specimen *s)
{
    Painter *p = s->p;
    Scene c = {.s = s};
    paint_scene(&c);
    c.out = painter_sheet(p, 3, PLANE_COLOUR);
    painter_rows(p, p->y0, p->y1, picture_row, &c);
    painter_give_back(p, c.base);
    painter_give_back(p, c.normal);
    painter_give_back(p, c.ao);
    painter_give_back(p, c.translucency);
    painter_give_back(p, c.scene);
    return c.out;
}
