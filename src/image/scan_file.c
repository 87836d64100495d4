#include "image/scan_file.h"

#include <errno.h>
#include <png.h>
#include <tiffio.h>

#include "image/staged.h"

/* Everything libpng's error jump must leave behind whole. */
typedef struct {
    png_structp png;
    png_infop info;
    Staged file;
    int code;      /* errno of a failed write */
    char *message; /* libpng's, of any other failure */
} Writer;

static void on_error(png_structp png, png_const_charp message)
{
    Writer *w = png_get_error_ptr(png);
    if (!w->message)
        w->message = g_strdup(message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message) {}

static void on_write(png_structp png, png_bytep data, png_size_t n)
{
    Writer *w = png_get_io_ptr(png);
    if (fwrite(data, 1, n, w->file.file) == n)
        return;
    w->code = errno ? errno : EIO;
    png_error(png, "write failed");
}

static void on_flush(png_structp png) {}

static void emit_head(const Writer *w, const Scan *s)
{
    static const int type[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
    png_set_IHDR(w->png, w->info, s->width, s->height, (int)s->depth, type[s->channels - 1], PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    if (s->mm_per_pixel > 0.0) {
        png_uint_32 metre = (png_uint_32)(1000.0 / s->mm_per_pixel + 0.5);
        png_set_pHYs(w->png, w->info, metre, metre, PNG_RESOLUTION_METER);
    }
    png_set_compression_level(w->png, 3); /* scans are noise: level 6 with all filters makes 4 megapixels of 16 bits 22.5 MB instead of 22.9 */
    png_set_filter(w->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_PAETH);
    png_write_info(w->png, w->info);
    if (s->depth == 16 && G_BYTE_ORDER == G_LITTLE_ENDIAN)
        png_set_swap(w->png);
}

static bool emit(Writer *w, const Scan *s)
{
    w->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, w, on_error, on_warning);
    w->info = w->png ? png_create_info_struct(w->png) : NULL;
    if (!w->info || setjmp(png_jmpbuf(w->png)))
        return false;
    png_set_write_fn(w->png, w, on_write, on_flush);
    png_set_user_limits(w->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    emit_head(w, s);
    gsize row = (gsize)s->width * s->channels * s->depth / 8;
    for (uint32_t y = 0; y < s->height; y++)
        png_write_row(w->png, (png_const_bytep)s->px + y * row);
    png_write_end(w->png, NULL);
    return true;
}

gboolean image_write_scan(const Scan *s, const char *path, GError **error)
{
    Writer w = {0};
    if (!staged_open(&w.file, path, error))
        return FALSE;
    gboolean ok = emit(&w, s);
    png_destroy_write_struct(&w.png, &w.info);
    if (ok)
        ok = staged_commit(&w.file, error);
    else {
        if (w.code)
            staged_error(path, w.code, error);
        else
            g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_FAILED, "can't write %s: %s", path, w.message ? w.message : "libpng failed");
        staged_abort(&w.file);
    }
    g_free(w.message);
    return ok;
}

/* ---- pages ---- */

static int say_nothing(TIFF *tif, void *user, const char *module, const char *format, va_list args) { return 1; }

uint32_t image_pages(const char *path)
{
    enum { MOST = 1000 };
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    if (!options)
        return 1;
    TIFFOpenOptionsSetErrorHandlerExtR(options, say_nothing, NULL);
    TIFFOpenOptionsSetWarningHandlerExtR(options, say_nothing, NULL);
    TIFF *tif = TIFFOpenExt(path, "rm", options);
    uint32_t n = 0;
    for (int more = tif != NULL, i = 0; more && i < MOST; more = TIFFReadDirectory(tif), i++) {
        uint32_t kind = 0;
        TIFFGetField(tif, TIFFTAG_SUBFILETYPE, &kind);
        n += !(kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK));
    }
    if (tif)
        TIFFClose(tif);
    TIFFOpenOptionsFree(options);
    return n > 0 ? n : 1;
}
