/* Drawn veins, an SVG file or the text lines of a tracing: whatever the bytes, there are lines of finite points, which make a sound network in a blade,
 * or an error. */
#include "fuzz.h"
#include "geom/outline.h"
#include "import/drawing_file.h"
#include "scan/scan.h"
#include "sound.h"

static void check(const Drawing *d)
{
    for (uint32_t k = 0; k < d->n; k++) {
        require(d->vein[k].n >= 2);
        for (uint32_t i = 0; i < d->vein[k].n; i++)
            require(isfinite(d->vein[k].point[i].x) && isfinite(d->vein[k].point[i].y) && d->vein[k].width[i] >= 0.0 && isfinite(d->vein[k].width[i]));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bool svg = memchr(data, '<', size) != NULL;
    GError *error = NULL;
    const char *path = fuzz_file(svg ? "veins.svg" : "veins.txt", data, size);
    Drawing *d = svg ? drawing_read_svg(path, 0.1, NULL, &error) : drawing_read_tracing(path, 200.0, &error);
    fuzz_check_error(d != NULL, &error, IMPORT_ERROR, OUTLINE_ERROR, SCAN_ERROR, 0);
    if (!d)
        return 0;
    check(d);
    /* a blade around what lies between 0,0 and 200,200 with y down, standing on its edge */
    const Vec2 corner[] = {{-0.6, 0}, {0.6, 0}, {0.6, 1.1}, {-0.6, 1.1}};
    Polygon *leaf = polygon_new(corner, 4);
    drawing_to_leaf(d, svg ? vec2(100, -200) : vec2(100, 0), svg ? vec2(100, 0) : vec2(100, 200));
    DrawingDef def = drawing_def_default();
    Network *net = drawing_network(d, leaf, &def, &error);
    fuzz_check_error(net != NULL, &error, DRAWING_ERROR, 0);
    if (net)
        sound_network(net);
    network_free(net);
    polygon_free(leaf);
    drawing_free(d);
    return 0;
}
