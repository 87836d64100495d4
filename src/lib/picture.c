#include "lib/picture.h"

#include "image/specimen.h"
#include "lib/settings.h"
#include "lib/writer.h"

static Plane *paint_specimen(Painter *painter, const VenLeaf *leaf)
{
    SpecimenDef def = settings_specimen(leaf->params, leaf->seed);
    Specimen *specimen = specimen_new(painter, &def);
    Plane *plane = specimen_paint(specimen);
    specimen_free(specimen);
    return plane;
}

gboolean leaf_picture(const VenLeaf *leaf, const char *path, uint32_t pixels, gboolean specimen, GError **error)
{
    static const double border = 0.02;
    Writer w;
    writer_init(&w, leaf, ".", "");
    Frame frame = frame_fit(leaf->net->margin->box, pixels, false, border);
    Painter *painter = writer_painter(&w, &frame);
    Plane *plane = specimen ? paint_specimen(painter, leaf) : painter_veins(painter);
    gboolean ok = image_write_png(plane, path, 8, NULL, error);
    plane_free(plane);
    painter_free(painter);
    writer_clear(&w);
    return ok;
}
