/* Outlines: an SVG file, or path data, its half mirrored and toothed; whatever the bytes, there is a simple polygon with its base at 0,0, or
 * an error. */
#include "fuzz.h"
#include "geom/outline.h"
#include "sound.h"

static void draw(const OutlineDef *def)
{
    GError *error = NULL;
    Vec2 base, tip;
    Polygon *p = outline_new_from(def, &base, &tip, &error);
    fuzz_check_error(p != NULL, &error, OUTLINE_ERROR, 0);
    if (!p)
        return;
    sound_polygon(p);
    require(isfinite(base.x) && isfinite(base.y) && isfinite(tip.x) && isfinite(tip.y));
    require(polygon_depth(p, vec2(0, 0)) > -1e-5); /* the tip may be anywhere, between two lobes say */
    polygon_free(p);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const OutlineWave teeth[] = {{0.01, 12}, {0.003, 40}};
    OutlineDef def = outline_def_default();
    char *text = size ? g_strndup((const char *)data, size) : g_strdup("");
    def.where = "fuzz";
    def.flatness = 0.002;
    if (memchr(data, '<', size)) {
        def.file = fuzz_file("outline.svg", data, size);
        def.path = NULL;
        draw(&def);
    } else {
        def.path = text;
        draw(&def);
        def.mirror = true;
        def.waves = teeth;
        def.n_waves = G_N_ELEMENTS(teeth);
        draw(&def);
    }
    g_free(text);
    return 0;
}
