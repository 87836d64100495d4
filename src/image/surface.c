/* The shape of the blade: height, normals, ambient occlusion, thickness. */
#include <glib.h>

#include "image/blur.h"
#include "image/painter.h"
#include "geom/wide.h"

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
    uint32_t from; /* row that both begin with */
    int32_t *arch, *blade;
} Arch;

/* Steep beside the veins, level in the middle of a mesh. */
WIDE static void arch_stretch(const float *restrict away, const float *restrict blade, uint32_t n, double gain, int32_t *restrict arch, int32_t *restrict in)
{
    for (uint32_t i = 0; i < n; i++) {
        double rest = 1.0 - clamped((double)away[i] * gain, 0.0, 1.0);
        int32_t a = (int32_t)(ARCH_ONE * (1.0 - rest * rest));
        arch[i] = blade[i] > 0.0f ? a : 0;
        in[i] = blade[i] > 0.0f ? ARCH_ONE : 0;
    }
}

static void arch_row(uint32_t y, void *user)
{
    const Arch *a = user;
    const Painter *p = a->p;
    gsize row = (gsize)(y - a->from) * p->width;
    double gain = 1.0 / (0.5 * p->spacing * p->frame.scale);
    arch_stretch(field_row(p, &p->away, y), field_row(p, &p->blade, y), p->width, gain, a->arch + row, a->blade + row);
}

WIDE static void settle_stretch(const int32_t *restrict arch, const int32_t *restrict blade, uint32_t n, float *restrict out)
{
    for (uint32_t i = 0; i < n; i++) {
        float part = (float)((double)arch[i] / (double)(blade[i] > 0 ? blade[i] : 1));
        out[i] = blade[i] > 0 ? part : 0.0f;
    }
}

static void settle_row(uint32_t y, void *user)
{
    const Arch *a = user;
    gsize row = (gsize)(y - a->from) * a->p->width;
    settle_stretch(a->arch + row, a->blade + row, a->p->width, field_row(a->p, &a->p->arch, y));
}

/* Of the painted rows, the ones that normals look at around them, and what specimens need. */
const float *painter_arch(Painter *p)
{
    painter_away(p);
    uint32_t around = 1 + p->surround, reach = around + arch_reach(p);
    if (field_begin(p, &p->arch) == p->bottom)
        return p->arch.px;
    uint32_t y0 = p->y0 > p->top + around ? p->y0 - around : p->top, y1 = MIN(p->y1 + around, p->bottom);
    uint32_t from = p->y0 > p->top + reach ? p->y0 - reach : p->top, rows = MIN(p->y1 + reach, p->bottom) - from;
    gsize n = (gsize)p->width * rows;
    if (2 * n > p->n_blurred) {
        g_free(p->blurred);
        p->blurred = g_new(int32_t, 2 * n);
        p->n_blurred = 2 * n;
    }
    Arch a = {p, from, p->blurred, p->blurred + n};
    painter_rows(p, from, from + rows, arch_row, &a);
    image_blur(p->pool, a.arch, p->width, rows, arch_blur(p));
    image_blur(p->pool, a.blade, p->width, rows, arch_blur(p));
    painter_rows(p, y0, y1, settle_row, &a);
    return p->arch.px;
}

/* ---- maps ---- */

typedef struct {
    Painter *p;
    Plane *plane;
    double arch, bulge, groove; /* what the parts of a side's surface count, segments */
} Surface;

/* Pixels of a row are worked on in stretches, in loops that vector instructions take in. */
enum { STRETCH = 64 };

/* Height of pixels x … x + n - 1 of row y, segments; 0 where there is no blade. */
static inline void heights(const Surface *s, uint32_t x, uint32_t y, uint32_t n, double *out)
{
    const Painter *p = s->p;
    const float *blade = field_row(p, &p->blade, y) + x, *bulge = field_row(p, &p->bulge, y) + x;
    const float *arch = field_row(p, &p->arch, y) + x, *nearness = field_row(p, &p->nearness, y) + x;
    double by_bulge = s->bulge, by_arch = s->arch, by_groove = s->groove;
    for (uint32_t i = 0; i < n; i++) {
        double near = (double)nearness[i];
        double h = by_bulge * (double)bulge[i] + by_arch * (double)arch[i] - by_groove * near * (0.5 + 0.5 * near);
        out[i] = blade[i] > 0.0f ? h : 0.0;
    }
}

/* Is there blade at a pixel? */
static bool has_blade(const float *blade, uint32_t n)
{
    uint32_t any = 0;
    for (uint32_t i = 0; i < n; i++)
        any |= (uint32_t)(blade[i] > 0.0f);
    return any != 0;
}

WIDE static void height_row(uint32_t y, void *user)
{
    const Surface *s = user;
    const Painter *p = s->p;
    double h[STRETCH];
    Vec2 at;
    for (uint32_t first = 0; first < p->width; first += STRETCH) {
        uint32_t n = MIN(p->width - first, (uint32_t)STRETCH);
        const float *blade = field_row(p, &p->blade, y) + first;
        float *out = plane_row(p, s->plane, y) + first;
        heights(s, first, y, n, h);
        for (uint32_t i = 0; i < n; i++)
            out[i] = (float)h[i];
        for (uint32_t i = 0; i < n; i++)
            if (!(blade[i] > 0.0f) && painter_padded(p, first + i, y, &at))
                out[i] = (float)s->arch;
    }
}

/* Slope from a over `here` to b, each left out where it is not of the blade; segments per pixel. */
static inline double slope(double a, double blade_a, double b, double blade_b, double here)
{
    double to_a = blade_a > 0.0 ? a : here, to_b = blade_b > 0.0 ? b : here, all = MIN(blade_a, blade_b);
    return (all > 0.0 ? 0.5 : 1.0) * (to_b - to_a);
}

/* Heights and parts of blade of pixels of a row, widened for the loops. */
typedef struct {
    double height[STRETCH + 2], blade[STRETCH + 2];
} Line;

static inline void take_line(const Surface *s, uint32_t x, uint32_t y, uint32_t n, double *height, double *blade)
{
    const float *in = field_row(s->p, &s->p->blade, y) + x;
    heights(s, x, y, n, height);
    for (uint32_t i = 0; i < n; i++)
        blade[i] = (double)in[i];
}

/* Of the row itself, with the pixels beside the stretch at 0 and n + 1; the image's last pixel is its own neighbour. */
static inline void take_middle(const Surface *s, uint32_t x, uint32_t y, uint32_t n, Line *l)
{
    uint32_t x1 = MIN(x + n + 1, s->p->width), from = x > 0 ? 0 : 1;
    take_line(s, x + from - 1, y, x1 - (x + from - 1), l->height + from, l->blade + from);
    if (x == 0) {
        l->height[0] = l->height[1];
        l->blade[0] = l->blade[1];
    }
    if (x + n == s->p->width) {
        l->height[n + 1] = l->height[n];
        l->blade[n + 1] = l->blade[n];
    }
}

WIDE static void normal_stretch(const Surface *s, uint32_t x, uint32_t y, uint32_t n, float *out)
{
    const Painter *p = s->p;
    Line up, mid, down;
    double nx[STRETCH], ny[STRETCH], nz[STRETCH], scale = p->frame.scale;
    take_line(s, x, y > 0 ? y - 1 : y, n, up.height, up.blade);
    take_middle(s, x, y, n, &mid);
    take_line(s, x, y + 1 < p->rows ? y + 1 : y, n, down.height, down.blade);
    for (uint32_t i = 0; i < n; i++) {
        double here = mid.height[i + 1];
        double dx = slope(mid.height[i], mid.blade[i], mid.height[i + 2], mid.blade[i + 2], here) * scale;
        double dy = slope(down.height[i], down.blade[i], up.height[i], up.blade[i], here) * scale;
        double k = 0.5 / sqrt(1.0 + dx * dx + dy * dy);
        nx[i] = 0.5 - dx * k;
        ny[i] = 0.5 - dy * k;
        nz[i] = 0.5 + k;
    }
    for (uint32_t i = 0; i < n; i++)
        if (mid.blade[i + 1] > 0.0) {
            out[3 * i] = (float)nx[i];
            out[3 * i + 1] = (float)ny[i];
            out[3 * i + 2] = (float)nz[i];
        }
}

static void normal_row(uint32_t y, void *user)
{
    const Surface *s = user;
    const Painter *p = s->p;
    float *out = plane_row(p, s->plane, y);
    for (uint32_t x = 0; x < p->width; x++) {
        out[3 * x] = out[3 * x + 1] = 0.5f;
        out[3 * x + 2] = 1.0f;
    }
    for (uint32_t first = 0; first < p->width; first += STRETCH) {
        uint32_t n = MIN(p->width - first, (uint32_t)STRETCH);
        if (has_blade(field_row(p, &p->blade, y) + first, n))
            normal_stretch(s, first, y, n, out + 3 * (gsize)first);
    }
}

/* Veins that stand beside a place keep light from it, small ones more than their height would say: what counts is how they look,
 * and that is lost when they are as faint as they are low. On top of them there is light. */
WIDE static void occlusion_row(uint32_t y, void *user)
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

WIDE static void thickness_row(uint32_t y, void *user)
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
        else
            out[x] = painter_padded(p, x, y, &at) ? (float)(p->style.thickness * thinnest) : 0.0f;
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
