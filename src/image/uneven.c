/* Unevenness of the blade. */
#include <string.h>

#include "image/painter.h"

/* Of the blade, or of the image when there is none. */
Box2 painter_blade_box(const Painter *p)
{
    Vec2 far = vec2(p->frame.corner.x + p->width / p->frame.scale, p->frame.corner.y - p->rows / p->frame.scale);
    return p->net->margin != NULL ? p->net->margin->box : (Box2){p->frame.corner.x, far.y, far.x, p->frame.corner.y};
}

/* From a third of the leaf down to a part of a mesh. */
void painter_noise_ready(Painter *p)
{
    if (p->has_noise)
        return;
    Box2 box = painter_blade_box(p);
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
    for (int i = 0; i < N_NOISE; i++) {
        float *out = field_row(p, &p->grain[i], y);
        uint32_t none = p->noise[i].weight > 0.0 ? first : p->width;
        memset(out, 0, none * sizeof *out);
        memset(out + MAX(none, last), 0, (p->width - MAX(none, last)) * sizeof *out);
        noise_row(&p->noise[i], start, 1.0 / p->frame.scale, first, last, out);
    }
}

void painter_noise(Painter *p)
{
    painter_noise_ready(p);
    painter_blade(p);
    uint32_t from = p->bottom;
    for (int i = 0; i < N_NOISE; i++)
        from = field_begin(p, &p->grain[i]);
    painter_rows(p, from, p->bottom, noise_of_row, p);
}
