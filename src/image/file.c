#include "image/file.h"

gboolean image_file_rows(ImageFile *file, const Plane *band, GError **error)
{
    return file->rows(file, band, error);
}

gboolean image_file_end(ImageFile *file, GError **error)
{
    return file->end(file, error);
}

void image_file_abort(ImageFile *file)
{
    if (file != NULL)
        file->abort(file);
}

static gboolean write_whole(ImageFile *file, const Plane *p, GError **error)
{
    if (file == NULL)
        return FALSE;
    if (image_file_rows(file, p, error))
        return image_file_end(file, error);
    image_file_abort(file);
    return FALSE;
}

gboolean image_write_png(const Plane *p, const char *path, int depth, const Metadata *meta, GError **error)
{
    return write_whole(image_png_begin(path, p, p->height, depth, meta, error), p, error);
}

gboolean image_write_exr(const Plane *p, const char *path, gboolean half, const Metadata *meta, GError **error)
{
    Pool *pool = pool_new(0);
    gboolean ok = write_whole(image_exr_begin(path, p, p->height, half, meta, pool, error), p, error);
    pool_free(pool);
    return ok;
}
