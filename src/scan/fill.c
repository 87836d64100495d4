#include "scan/fill.h"

#include <string.h>

#include "scan/mask.h"

/* Way to the nearest kept pixel, found by sweeps that hand it on from neighbour to neighbour (Danielsson 1980): now and then a pixel off the nearest,
 * which no eye sees. */
typedef struct {
    int16_t x, y;
} Way;

enum { FAR = INT16_MAX };

typedef struct {
    Scan *scan;
    MaskBox box;
    uint32_t width, height;
    Way *way; /* [height][width] */
} Fill;

static int64_t length2(Way w) { return w.x == FAR ? INT64_MAX : (int64_t)w.x * w.x + (int64_t)w.y * w.y; }

/* Takes the way of the neighbour at dx, dy, when it is shorter. */
static void ask(const Fill *f, uint32_t x, uint32_t y, int dx, int dy)
{
    int64_t i = (int64_t)x + dx, j = (int64_t)y + dy;
    if (i < 0 || j < 0 || i >= f->width || j >= f->height)
        return;
    Way *own = &f->way[(gsize)y * f->width + x], other = f->way[(gsize)j * f->width + (gsize)i];
    if (other.x == FAR || ABS(other.x) + 1 >= FAR || ABS(other.y) + 1 >= FAR)
        return;
    other.x = (int16_t)(other.x + dx);
    other.y = (int16_t)(other.y + dy);
    if (length2(other) < length2(*own))
        *own = other;
}

static void sweep_row(const Fill *f, uint32_t y, int from)
{
    for (uint32_t x = 0; x < f->width; x++) {
        ask(f, x, y, 0, from);
        ask(f, x, y, -1, from);
        ask(f, x, y, 1, from);
        ask(f, x, y, -1, 0);
    }
    for (uint32_t x = f->width; x-- > 0;)
        ask(f, x, y, 1, 0);
}

static void copy_pixels(const Fill *f)
{
    gsize size = (gsize)f->scan->channels * f->scan->depth / 8, stride = size * f->scan->width;
    uint8_t *px = f->scan->px;
    for (uint32_t y = 0; y < f->height; y++)
        for (uint32_t x = 0; x < f->width; x++) {
            Way w = f->way[(gsize)y * f->width + x];
            uint8_t *to = px + (f->box.y0 + y) * stride + (f->box.x0 + x) * size;
            if (w.x != FAR && (w.x || w.y))
                memcpy(to, to + w.y * (gssize)stride + w.x * (gssize)size, size);
        }
}

/* Sets MASK_LEAF on pixels whose centres lie in the outline and which the threshold takes for leaf. */
static void mark_leaf(const Scan *s, const Polygon *outline, const Threshold *t, const Mask *m, MaskBox box)
{
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            uint32_t i = box.x0 + x, j = box.y0 + y;
            bool in = polygon_contains(outline, vec2(i + 0.5, s->height - (j + 0.5)));
            if (in && t)
                in = ((double)channel_value(s, t->channel, i, j) < t->level) == t->dark;
            *mask_at(m, x, y) = in ? MASK_LEAF : 0;
        }
}

void scan_fill(Scan *s, const Polygon *outline, const Threshold *t, double inset, uint32_t around)
{
    double x0 = outline->box.x0 - around, x1 = outline->box.x1 + around, y0 = s->height - outline->box.y1 - around, y1 = s->height - outline->box.y0 + around;
    if (x1 <= 0.0 || y1 <= 0.0 || x0 >= s->width || y0 >= s->height)
        return;
    Fill f = {.scan = s, .box = {(uint32_t)MAX(x0, 0.0), (uint32_t)MAX(y0, 0.0), (uint32_t)MIN(x1, s->width - 1.0), (uint32_t)MIN(y1, s->height - 1.0)}};
    f.width = f.box.x1 - f.box.x0 + 1;
    f.height = f.box.y1 - f.box.y0 + 1;
    uint8_t *px = g_malloc((gsize)f.width * f.height);
    Mask m = {f.width, f.height, f.width, px};
    mark_leaf(s, outline, t, &m, f.box);
    mask_erode(&m, MASK_LEAF, MASK_CORE, inset);
    f.way = g_new(Way, (gsize)f.width * f.height);
    for (gsize i = 0; i < (gsize)f.width * f.height; i++)
        f.way[i] = px[i] & MASK_CORE ? (Way){0, 0} : (Way){FAR, 0};
    g_free(px);
    for (uint32_t y = 0; y < f.height; y++)
        sweep_row(&f, y, -1);
    for (uint32_t y = f.height; y-- > 0;)
        sweep_row(&f, y, 1);
    copy_pixels(&f);
    g_free(f.way);
}
