#include "image/paint.h"

static uint32_t pixels(double length)
{
    double n = ceil(length - 1e-6);
    return n < 1.0 ? 1 : n > 65535.0 ? 65535 : (uint32_t)n;
}

Frame frame_fit(Box2 box, uint32_t size, bool square, double border)
{
    if (box_is_empty(box))
        box = (Box2){0.0, 0.0, 0.0, 0.0};
    double w = box.x1 - box.x0, h = box.y1 - box.y0, longer = w > h ? w : h;
    if (size < 1)
        size = 1;
    if (!(longer > 0.0))
        longer = 1.0;
    double edge = border * size;
    Frame f = {size, size, (size - 2.0 * edge) / longer, {0.0, 0.0}};
    if (!square) {
        f.width = w >= h ? size : pixels(w * f.scale + 2.0 * edge);
        f.height = h >= w ? size : pixels(h * f.scale + 2.0 * edge);
        if (f.width > size)
            f.width = size;
        if (f.height > size)
            f.height = size;
    }
    f.corner =
        vec2(0.5 * (box.x0 + box.x1) - 0.5 * f.width / f.scale, 0.5 * (box.y0 + box.y1) + 0.5 * f.height / f.scale);
    return f;
}
