/* The shape of the blade: height, normals, ambient occlusion, thickness. */
#include <glib.h>

#include "image/blur.h"
#include "image/painter.h"

static double smoothstep(double t)
{
    t = CLAMP(t, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/* Depth of the blade between veins below its veins, segments: it arches towards the sunny side. */
static double arch_depth(const Painter *p)
{
    return 0.1 * p->style.relief * p->spacing;
}

/* Depth of the stoutest veins below the blade on the sunny side, segments. */
static double groove_depth(const Painter *p)
{
    return 0.18 * p->style.relief * p->stout;
}

/* ---- the arch between veins ---- */

/* Blurred a little, as the distance to a vein has creases in the middle of a mesh. */
static uint32_t arch_blur(const Painter *p)
{
    return (uint32_t)CLAMP(0.08 * p->spacing * p->frame.scale + 0.5, 0.0, 4096.0);
}

uint32_t arch_reach(const Painter *p)
{
    return 2 * arch_blur(p);
}

enum { ARCH_ONE = 1 << 24 }; /* stands for 1 in whole numbers */

typedef struct {
    Painter *p;
    int32_t *arch, *blade;
} Arch;

/* Steep beside the veins, level in the middle of a mesh. */
static void arch_row(uint32_t y, void *user)
{
    const Arch *a = user;
    const Painter *p = a->p;
    const float *away = field_row(p, &p->away, y), *blade = field_row(p, &p->blade, y);
    gsize row = (gsize)(y - p->top) * p->width;
    double gain = 1.0 / (0.5 * p->spacing * p->frame.scale);
    for (uint32_t x = 0; x < p->width; x++) {
        double rest = 1.0 - CLAMP((double)away[x] * gain, 0.0, 1.0);
        bool in = blade[x] > 0.0f;
        a->blade[row + x] = in ? ARCH_ONE : 0;
        a->arch[row + x] = in ? (int32_t)(ARCH_ONE * (1.0 - rest * rest)) : 0;
    }
}

static void settle_row(uint32_t y, void *user)
{
    const Arch *a = user;
    const Painter *p = a->p;
    float *out = field_row(p, &p->arch, y);
    gsize row = (gsize)(y - p->top) * p->width;
    for (uint32_t x = 0; x < p->width; x++)
        if (a->blade[row + x] > 0)
            out[x] = (float)((double)a->arch[row + x] / (double)a->blade[row + x]);
}

const float *painter_arch(Painter *p)
{
    painter_away(p);
    uint32_t from = field_begin(p, &p->arch);
    if (from == p->bottom)
        return p->arch.px;
    gsize n = (gsize)p->width * (p->bottom - p->top);
    Arch a = {p, g_new(int32_t, n), g_new(int32_t, n)};
    painter_rows(p, p->top, p->bottom, arch_row, &a);
    image_blur(p->pool, a.arch, p->width, p->bottom - p->top, arch_blur(p));
    image_blur(p->pool, a.blade, p->width, p->bottom - p->top, arch_blur(p));
    painter_rows(p, p->top, p->bottom, settle_row, &a);
    g_free(a.arch);
    g_free(a.blade);
    return p->arch.px;
}

/* ---- maps ---- */

typedef struct {
    Painter *p;
    Plane *plane;
    double arch, bulge, groove; /* what the parts of a side's surface count, segments */
} Surface;

/* Parts of a row. */
typedef struct {
    const float *blade, *bulge, *arch, *nearness;
} Row;

static Row row_at(const Painter *p, uint32_t y)
{
    return (Row){field_row(p, &p->blade, y), field_row(p, &p->bulge, y), field_row(p, &p->arch, y), field_row(p, &p->nearness, y)};
}

static double height_at(const Surface *s, const Row *r, uint32_t x)
{
    double n = (double)r->nearness[x];
    return s->bulge * (double)r->bulge[x] + s->arch * (double)r->arch[x] - s->groove * n * (0.5 + 0.5 * n);
}

static void height_row(uint32_t y, void *user)
{
    const Surface *s = user;
    Row r = row_at(s->p, y);
    float *out = plane_row(s->p, s->plane, y);
    Vec2 at;
    for (uint32_t x = 0; x < s->p->width; x++) {
        if (r.blade[x] > 0.0f)
            out[x] = (float)height_at(s, &r, x);
        else if (painter_padded(s->p, x, y, &at))
            out[x] = (float)s->arch;
    }
}

/* Slope from pixel a over `at` to b, each left out where it is not of the blade; segments per pixel. */
static double slope(const Surface *s, const Row *ra, uint32_t xa, const Row *rb, uint32_t xb, double here)
{
    bool has_a = ra->blade[xa] > 0.0f, has_b = rb->blade[xb] > 0.0f;
    double a = has_a ? height_at(s, ra, xa) : here, b = has_b ? height_at(s, rb, xb) : here;
    return has_a && has_b ? 0.5 * (b - a) : b - a;
}

static void normal_row(uint32_t y, void *user)
{
    const Surface *s = user;
    const Painter *p = s->p;
    uint32_t w = p->width;
    Row up = row_at(p, y > 0 ? y - 1 : y), mid = row_at(p, y), down = row_at(p, y + 1 < p->rows ? y + 1 : y);
    float *n = plane_row(p, s->plane, y);
    for (uint32_t x = 0; x < w; x++, n += 3) {
        n[0] = n[1] = 0.5f;
        n[2] = 1.0f;
        if (!(mid.blade[x] > 0.0f))
            continue;
        double here = height_at(s, &mid, x);
        double dx = slope(s, &mid, x > 0 ? x - 1 : x, &mid, x + 1 < w ? x + 1 : x, here) * p->frame.scale;
        double dy = slope(s, &down, x, &up, x, here) * p->frame.scale;
        double k = 0.5 / sqrt(1.0 + dx * dx + dy * dy);
        n[0] = (float)(0.5 - dx * k);
        n[1] = (float)(0.5 - dy * k);
        n[2] = (float)(0.5 + k);
    }
}

/* Veins that stand beside a place keep light from it, small ones more than their height would say: what counts is how they look,
 * and that is lost when they are as faint as they are low. On top of them there is light. */
static void occlusion_row(uint32_t y, void *user)
{
    static const double open = 0.75; /* height from which on the flank of a vein is not dark, of its top's */
    const Surface *s = user;
    const Painter *p = s->p;
    const float *blade = field_row(p, &p->blade, y), *bulge = field_row(p, &p->bulge, y), *crease = field_row(p, &p->crease, y);
    float *out = plane_row(p, s->plane, y);
    double strength = 0.9 * MIN(p->style.relief, 1.2), top = MAX(0.5 * p->style.relief * p->stout, 1e-9);
    for (uint32_t x = 0; x < p->width; x++) {
        double seen = (double)crease[x], deep = seen > 0.0 ? smoothstep(1.0 - (double)bulge[x] / (open * seen)) : 0.0;
        out[x] = blade[x] > 0.0f && deep > 0.0 ? (float)(1.0 / (1.0 + strength * deep * sqrt(seen / top))) : 1.0f;
    }
}

static void thickness_row(uint32_t y, void *user)
{
    static const double thinnest = 0.45; /* at the margin, of the blade's */
    const Surface *s = user;
    const Painter *p = s->p;
    const float *blade = field_row(p, &p->blade, y), *bulge = field_row(p, &p->bulge, y), *inset = field_row(p, &p->inset, y);
    float *out = plane_row(p, s->plane, y);
    Vec2 at;
    for (uint32_t x = 0; x < p->width; x++) {
        double thin = thinnest + (1.0 - thinnest) * smoothstep((double)inset[x] / p->rim);
        if (blade[x] > 0.0f)
            out[x] = (float)(p->style.thickness * thin + (double)bulge[x]);
        else if (painter_padded(p, x, y, &at))
            out[x] = (float)(p->style.thickness * thinnest);
    }
}

double painter_round_up(double value)
{
    if (!(value > 0.0))
        return 0.0;
    double unit = 1e-9;
    while (unit * 100.0 <= value && unit < 1e300)
        unit *= 10.0;
    double n = ceil(value / unit);
    return unit < 1.0 ? n / floor(1.0 / unit + 0.5) : n * unit;
}

Plane *paint_surface(Painter *p, MapId id)
{
    Plane *plane = painter_plane(p, id);
    /* where veins merge they stand higher than either */
    double tallest = 0.65 * p->style.relief * MIN(p->widest, 2.0 * p->stout);
    Surface s = {.p = p, .plane = plane, .arch = -arch_depth(p), .bulge = 1.0};
    painter_relief(p);
    painter_inset(p);
    if (id == MAP_AO) {
        painter_rows(p, p->y0, p->y1, occlusion_row, &s);
    } else if (id == MAP_THICKNESS) {
        painter_rows(p, p->y0, p->y1, thickness_row, &s);
        plane->high = MAX(painter_round_up(p->style.thickness + tallest), 1e-9);
    } else if (id == MAP_HEIGHT) {
        painter_arch(p);
        painter_rows(p, p->y0, p->y1, height_row, &s);
        plane->low = -painter_round_up(arch_depth(p));
        plane->high = painter_round_up(tallest);
        if (plane->high <= plane->low)
            plane->high = 1.0;
    } else {
        painter_arch(p);
        if (id == MAP_ADAXIAL_NORMAL_GL) /* arched between the veins, which sink in the more the larger they are */
            s = (Surface){.p = p, .plane = plane, .arch = arch_depth(p), .groove = groove_depth(p)};
        painter_rows(p, p->y0, p->y1, normal_row, &s);
    }
    return plane;
}
