/* A sheet's PNG, drawn by librsvg a few rows and one leaf at a time, so that memory doesn't go with its size. */
#include <errno.h>
#include <librsvg/rsvg.h>
#include <png.h>

#include "batch/sheet_private.h"
#include "image/staged.h"

enum { STRIPE = 4 << 20, MOST_STRIPES = 4 }; /* bytes; of a band, as a leaf is read once for each */

struct SheetPng {
    png_structp png;
    png_infop info;
    Staged file;
    int width;
    uint8_t *row;
    cairo_surface_t *stripe; /* NULL between stripes */
    int code;      /* errno of a failed write */
    char *message; /* libpng's, of any other failure */
};

static void on_error(png_structp png, png_const_charp message)
{
    SheetPng *p = png_get_error_ptr(png);
    if (!p->message)
        p->message = g_strdup(message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message) {}

static void on_write(png_structp png, png_bytep data, png_size_t n)
{
    SheetPng *p = png_get_io_ptr(png);
    if (fwrite(data, 1, n, p->file.file) != n) {
        p->code = errno ? errno : EIO;
        png_error(png, "write failed");
    }
}

static void on_flush(png_structp png) {}

static gboolean fail(SheetPng *p, GError **error)
{
    if (p->code)
        staged_error(p->file.path, p->code, error);
    else
        g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_FAILED, "can't write %s: %s", p->file.path, p->message ? p->message : "out of memory");
    return FALSE;
}

SheetPng *sheet_png_begin(const char *path, int width, int height, GError **error)
{
    SheetPng *p = g_new0(SheetPng, 1);
    p->width = width;
    if (!staged_open(&p->file, path, error)) {
        g_free(p);
        return NULL;
    }
    p->row = g_malloc(3 * (gsize)width);
    p->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, p, on_error, on_warning);
    p->info = p->png ? png_create_info_struct(p->png) : NULL;
    if (!p->info || setjmp(png_jmpbuf(p->png))) {
        fail(p, error);
        sheet_png_abort(p);
        return NULL;
    }
    png_set_write_fn(p->png, p, on_write, on_flush);
    png_set_IHDR(p->png, p->info, (png_uint_32)width, (png_uint_32)height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(p->png, p->info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_filter(p->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP); /* mostly white paper: a tenth larger than the best of all filters, in half the time */
    png_set_compression_level(p->png, 4);
    png_write_info(p->png, p->info);
    return p;
}

/* The part as a drawing of its own. */
static RsvgHandle *load(int width, int height, const char *style, const GString *svg, GError **error)
{
    char *head = g_strdup_printf("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\">\n", width, height);
    GInputStream *in = g_memory_input_stream_new_from_data(head, -1, NULL);
    GMemoryInputStream *m = G_MEMORY_INPUT_STREAM(in);
    g_memory_input_stream_add_data(m, style, -1, NULL);
    g_memory_input_stream_add_data(m, svg->str, (gssize)svg->len, NULL);
    g_memory_input_stream_add_data(m, "</svg>", -1, NULL);
    RsvgHandle *handle = rsvg_handle_new_from_stream_sync(in, NULL, RSVG_HANDLE_FLAG_UNLIMITED, NULL, error);
    g_object_unref(in);
    g_free(head);
    return handle;
}

static gboolean draw(RsvgHandle *handle, cairo_surface_t *surface, int height, int top, GError **error)
{
    cairo_t *cr = cairo_create(surface);
    RsvgRectangle all = {0.0, -top, cairo_image_surface_get_width(surface), height};
    gboolean ok = rsvg_handle_render_document(handle, cr, &all, error);
    cairo_status_t status = cairo_status(cr);
    if (ok && status != CAIRO_STATUS_SUCCESS) {
        g_set_error_literal(error, G_FILE_ERROR, G_FILE_ERROR_FAILED, cairo_status_to_string(status));
        ok = FALSE;
    }
    cairo_destroy(cr);
    return ok;
}

static gboolean put_rows(SheetPng *p, cairo_surface_t *surface, GError **error)
{
    int height = cairo_image_surface_get_height(surface);
    cairo_surface_flush(surface);
    const uint8_t *data = cairo_image_surface_get_data(surface);
    gsize stride = (gsize)cairo_image_surface_get_stride(surface);
    if (setjmp(png_jmpbuf(p->png)))
        return fail(p, error);
    for (int y = 0; y < height; y++) {
        const uint32_t *pixel = (const uint32_t *)(const void *)(data + (gsize)y * stride);
        for (int x = 0; x < p->width; x++) {
            p->row[3 * x] = (uint8_t)(pixel[x] >> 16);
            p->row[3 * x + 1] = (uint8_t)(pixel[x] >> 8);
            p->row[3 * x + 2] = (uint8_t)pixel[x];
        }
        png_write_row(p->png, p->row);
    }
    return TRUE;
}

int sheet_png_stripe(const SheetPng *p, int height) { return MAX(STRIPE / (4 * p->width), (height + MOST_STRIPES - 1) / MOST_STRIPES); }

gboolean sheet_png_begin_stripe(SheetPng *p, int rows, GError **error)
{
    p->stripe = cairo_image_surface_create(CAIRO_FORMAT_RGB24, p->width, rows);
    if (cairo_surface_status(p->stripe) != CAIRO_STATUS_SUCCESS) {
        g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_FAILED, "can't draw %s: %s", p->file.path, cairo_status_to_string(cairo_surface_status(p->stripe)));
        return FALSE;
    }
    cairo_t *cr = cairo_create(p->stripe);
    cairo_set_source_rgb(cr, 1.0, 1.0, 1.0);
    cairo_paint(cr);
    cairo_destroy(cr);
    return TRUE;
}

gboolean sheet_png_draw(SheetPng *p, const char *style, const GString *svg, int height, int top, GError **error)
{
    RsvgHandle *handle = load(p->width, height, style, svg, error);
    gboolean ok = handle && draw(handle, p->stripe, height, top, error);
    if (!ok)
        g_prefix_error(error, "can't draw %s: ", p->file.path);
    g_clear_object(&handle);
    return ok;
}

gboolean sheet_png_end_stripe(SheetPng *p, GError **error)
{
    gboolean ok = put_rows(p, p->stripe, error);
    g_clear_pointer(&p->stripe, cairo_surface_destroy);
    return ok;
}

gboolean sheet_png_end(SheetPng *p, GError **error)
{
    if (setjmp(png_jmpbuf(p->png))) {
        fail(p, error);
        sheet_png_abort(p);
        return FALSE;
    }
    png_write_end(p->png, p->info);
    gboolean ok = staged_commit(&p->file, error);
    sheet_png_abort(p);
    return ok;
}

void sheet_png_abort(SheetPng *p)
{
    if (!p)
        return;
    png_destroy_write_struct(&p->png, &p->info);
    staged_abort(&p->file);
    g_clear_pointer(&p->stripe, cairo_surface_destroy);
    g_free(p->row);
    g_free(p->message);
    g_free(p);
}
