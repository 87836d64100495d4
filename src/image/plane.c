#include "image/plane.h"

Plane *plane_new(uint32_t width, uint32_t height, uint32_t channels, PlaneKind kind)
{
    Plane *p = g_new0(Plane, 1);
    p->width = width;
    p->height = height;
    p->channels = channels;
    p->kind = kind;
    p->high = 1.0;
    p->unit = "";
    p->px = g_new0(float, (gsize)width *height *channels);
    return p;
}

void plane_free(Plane *p)
{
    if (p == NULL)
        return;
    g_free(p->px);
    g_free(p);
}
