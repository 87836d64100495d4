/* The shape of the blade: height, normals, ambient occlusion, thickness. */
#include <glib.h>
#include <string.h>

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

typedef struct {
    Painter *p;
    Plane *plane;
    float *z;                /* the surface in question, segments */
    float *sum, *weight;     /* blurred surface and blade */
    double radius, strength; /* of occlusion: width of the blur, segments */
} Surface;

static void mask_row(uint32_t y, void *user)
{
    const Surface *s = user;
    for (uint32_t x = 0; x < s->p->width; x++) {
        gsize at = (gsize)y * s->p->width + x;
        s->weight[at] = s->p->blade[at] > 0.0f ? 1.0f : 0.0f;
    }
}

/* Blurs z, which is 0 beyond the blade, into sum and the blade into weight. */
static void blur_surface(const Surface *s, double radius)
{
    Painter *p = s->p;
    memcpy(s->sum, s->z, (gsize)p->width * p->rows * sizeof(float));
    painter_rows(p, mask_row, (void *)s);
    image_blur(s->sum, p->width, p->rows, radius, p->style.threads);
    image_blur(s->weight, p->width, p->rows, radius, p->style.threads);
}

/* Steep beside the veins, level in the middle of a mesh. */
static void arch_row(uint32_t y, void *user)
{
    const Surface *s = user;
    const Painter *p = s->p;
    for (uint32_t x = 0; x < p->width; x++) {
        gsize at = (gsize)y * p->width + x;
        double rest = 1.0 - CLAMP((double)p->away[at] / (0.5 * p->spacing * p->frame.scale), 0.0, 1.0);
        if (p->blade[at] > 0.0f)
            p->arch[at] = (float)(1.0 - rest * rest);
    }
}

static void smooth_row(uint32_t y, void *user)
{
    const Surface *s = user;
    for (uint32_t x = 0; x < s->p->width; x++) {
        gsize at = (gsize)y * s->p->width + x;
        if (s->weight[at] > 0.0f && s->p->blade[at] > 0.0f)
            s->p->arch[at] = s->sum[at] / s->weight[at];
    }
}

/* Blurred a little, as the distance to a vein has creases in the middle of a mesh. */
const float *painter_arch(Painter *p)
{
    if (p->arch != NULL)
        return p->arch;
    gsize n = (gsize)p->width * p->rows;
    painter_away(p);
    p->arch = g_new0(float, n);
    Surface s = {.p = p, .z = p->arch, .sum = g_new(float, n), .weight = g_new(float, n)};
    painter_rows(p, arch_row, &s);
    blur_surface(&s, 0.16 * p->spacing * p->frame.scale);
    painter_rows(p, smooth_row, &s);
    g_free(s.sum);
    g_free(s.weight);
    return p->arch;
}

static void height_row(uint32_t y, void *user)
{
    const Surface *s = user;
    for (uint32_t x = 0; x < s->p->width; x++) {
        gsize at = (gsize)y * s->p->width + x;
        if (s->p->blade[at] > 0.0f)
            s->z[at] = (float)((double)s->p->vein_height[at] - arch_depth(s->p) * (double)s->p->arch[at]);
    }
}

const float *painter_height(Painter *p)
{
    if (p->height == NULL) {
        painter_vein_height(p);
        painter_arch(p);
        p->height = g_new0(float, (gsize)p->width * p->rows);
        Surface s = {.p = p, .z = p->height};
        painter_rows(p, height_row, &s);
    }
    return p->height;
}

/* The sunny side: arched between the veins, which sink in the more the larger they are. */
static void adaxial_row(uint32_t y, void *user)
{
    const Surface *s = user;
    double scale = 0.125 * s->p->style.relief * s->p->stout;
    for (uint32_t x = 0; x < s->p->width; x++) {
        gsize at = (gsize)y * s->p->width + x;
        double v = (double)s->p->vein_height[at], sunk = v > 0.0 ? 0.35 * v * v / (v + scale) : 0.0;
        if (s->p->blade[at] > 0.0f)
            s->z[at] = (float)(arch_depth(s->p) * (double)s->p->arch[at] - sunk);
    }
}

/* Slope between pixels a and b on either side of `at`, each left out where it is not of the blade; segments per pixel.
 */
static double slope(const Surface *s, gsize a, gsize at, gsize b)
{
    bool has_a = s->p->blade[a] > 0.0f, has_b = s->p->blade[b] > 0.0f;
    gsize lo = has_a ? a : at, hi = has_b ? b : at;
    if (lo == hi)
        return 0.0;
    double rise = (double)s->z[hi] - (double)s->z[lo];
    return lo != at && hi != at ? 0.5 * rise : rise;
}

static void normal_row(uint32_t y, void *user)
{
    const Surface *s = user;
    uint32_t w = s->p->width;
    for (uint32_t x = 0; x < w; x++) {
        gsize at = (gsize)y * w + x;
        float *n = s->plane->px + at * 3;
        n[0] = n[1] = 0.5f;
        n[2] = 1.0f;
        if (!(s->p->blade[at] > 0.0f))
            continue;
        double dx = slope(s, x > 0 ? at - 1 : at, at, x + 1 < w ? at + 1 : at) * s->p->frame.scale;
        double dy = slope(s, y + 1 < s->p->rows ? at + w : at, at, y > 0 ? at - w : at) * s->p->frame.scale;
        double k = 0.5 / sqrt(1.0 + dx * dx + dy * dy);
        n[0] = (float)(0.5 - dx * k);
        n[1] = (float)(0.5 - dy * k);
        n[2] = (float)(0.5 + k);
    }
}

static void paint_normals(Painter *p, MapId id, Plane *plane)
{
    Surface s = {.p = p, .plane = plane, .z = (float *)painter_height(p)};
    if (id == MAP_ADAXIAL_NORMAL_GL) {
        s.z = g_new0(float, (gsize)p->width * p->rows);
        painter_rows(p, adaxial_row, &s);
    }
    painter_rows(p, normal_row, &s);
    if (id == MAP_ADAXIAL_NORMAL_GL)
        g_free(s.z);
}

/* Where the surroundings, averaged over some width, stand higher than the surface, little light comes in. */
static void occlude_row(uint32_t y, void *user)
{
    const Surface *s = user;
    for (uint32_t x = 0; x < s->p->width; x++) {
        gsize at = (gsize)y * s->p->width + x;
        float *out = s->plane->px + at;
        if (!(s->p->blade[at] > 0.0f))
            continue;
        double around = (double)s->sum[at] / MAX((double)s->weight[at], 1e-6),
               deep = (around - (double)s->z[at]) / s->radius;
        if (deep > 0.0)
            *out = (float)((double)*out / (1.0 + s->strength * deep));
    }
}

/* At two widths: that of the net's meshes and that of the stout veins. */
static void paint_occlusion(Painter *p, Plane *plane)
{
    gsize n = (gsize)p->width * p->rows;
    Surface s = {.p = p, .plane = plane, .z = (float *)painter_height(p)};
    for (gsize i = 0; i < n; i++)
        plane->px[i] = 1.0f;
    double radius[2] = {0.2 * p->spacing, 0.5 * p->stout};
    s.sum = g_new(float, n);
    s.weight = g_new(float, n);
    for (int i = 0; i < 2; i++) {
        s.radius = radius[i];
        s.strength = i == 0 ? 2.0 : 3.0;
        if (s.radius * p->frame.scale < 0.5)
            continue;
        blur_surface(&s, s.radius * p->frame.scale);
        painter_rows(p, occlude_row, &s);
    }
    g_free(s.sum);
    g_free(s.weight);
}

static void thickness_row(uint32_t y, void *user)
{
    const Surface *s = user;
    double limit = s->p->band;
    for (uint32_t x = 0; x < s->p->width; x++) {
        gsize at = (gsize)y * s->p->width + x;
        if (!(s->p->blade[at] > 0.0f))
            continue;
        double thin = 0.45 + 0.55 * smoothstep((double)s->p->inset[at] / limit);
        s->plane->px[at] = (float)(s->p->style.thickness * thin + (double)s->p->vein_height[at]);
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
    Surface s = {.p = p, .plane = plane};
    if (id == MAP_HEIGHT) {
        memcpy(plane->px, painter_height(p), (gsize)p->width * p->rows * sizeof(float));
        plane->low = -painter_round_up(arch_depth(p));
        plane->high = painter_round_up(tallest);
        if (plane->high <= plane->low)
            plane->high = 1.0;
    } else if (id == MAP_AO) {
        paint_occlusion(p, plane);
    } else if (id == MAP_THICKNESS) {
        painter_vein_height(p);
        painter_inset(p);
        painter_rows(p, thickness_row, &s);
        plane->high = MAX(painter_round_up(p->style.thickness + tallest), 1e-9);
    } else {
        paint_normals(p, id, plane);
    }
    painter_pad(p, plane);
    return plane;
}
