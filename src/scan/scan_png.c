#include <errno.h>
#include <png.h>

#include "scan/scan_file.h"

/* Everything that libpng's error jump must leave behind whole. */
typedef struct {
    ScanFile *f;
    png_structp png;
    png_infop info;
    Scan *scan;
    int code;      /* errno of a failed read or allocation */
    char *message; /* libpng's, of any other failure */
    GError *error; /* of our own */
} Reader;

static void on_error(png_structp png, png_const_charp message)
{
    Reader *r = png_get_error_ptr(png);
    if (!r->message)
        r->message = g_strdup(message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

/* libpng takes memory for as much as a chunk says it has, before it reads it, and only warns of its own limit; without the memory it leaves the chunk
 * out. A row of an image within the limit gets what it needs. */
static void *on_malloc(png_structp png, png_alloc_size_t n)
{
    Reader *r = png_get_mem_ptr(png);
    if (n > MIN(r->f->max_pixels, (uint64_t)G_MAXINT64 / 16) * 8 + (1 << 26))
        return NULL;
    void *block = g_try_malloc(n);
    if (!block)
        r->code = ENOMEM;
    return block;
}

static void on_free(png_structp png, void *block)
{
    (void)png;
    g_free(block);
}

static void on_read(png_structp png, png_bytep data, png_size_t n)
{
    Reader *r = png_get_io_ptr(png);
    if (fread(data, 1, n, r->f->file) == n)
        return;
    if (ferror(r->f->file))
        r->code = errno ? errno : EIO;
    png_error(png, "the file ends too early");
}

/* All kinds of pixels become 8 or 16 bits of grey or RGB, with alpha where there is any. */
static void set_conversions(png_structp png, png_infop info)
{
    png_set_palette_to_rgb(png);
    png_set_expand_gray_1_2_4_to_8(png);
    if (png_get_valid(png, info, PNG_INFO_tRNS))
        png_set_tRNS_to_alpha(png);
    if (png_get_bit_depth(png, info) == 16 && G_BYTE_ORDER == G_LITTLE_ENDIAN)
        png_set_swap(png);
}

static void read_facts(Reader *r)
{
    png_uint_32 x = 0, y = 0, n = 0;
    png_bytep exif = NULL;
    int unit = 0;
    if (png_get_pHYs(r->png, r->info, &x, &y, &unit) && unit == PNG_RESOLUTION_METER) {
        r->f->across_mm = x / 1000.0;
        r->f->down_mm = y / 1000.0;
    }
    if (png_get_eXIf_1(r->png, r->info, &n, &exif))
        scan_file_exif(r->f, exif, n);
}

static gboolean decode(Reader *r)
{
    if (setjmp(png_jmpbuf(r->png)))
        return FALSE;
    png_set_read_fn(r->png, r, on_read);
    png_set_user_limits(r->png, 0x7FFFFFFF, 0x7FFFFFFF); /* scan_file_new has the limit */
    png_read_info(r->png, r->info);
    set_conversions(r->png, r->info);
    int passes = png_set_interlace_handling(r->png);
    uint32_t width = png_get_image_width(r->png, r->info), height = png_get_image_height(r->png, r->info);
    if ((uint64_t)width * height <= r->f->max_pixels) /* else libpng would allocate rows of that width */
        png_read_update_info(r->png, r->info);
    r->scan = scan_file_new(r->f, width, height, png_get_channels(r->png, r->info), png_get_bit_depth(r->png, r->info), &r->error);
    if (!r->scan)
        return FALSE;
    gsize row = png_get_rowbytes(r->png, r->info);
    g_assert(row == (gsize)width * r->scan->channels * r->scan->depth / 8);
    for (int pass = 0; pass < passes; pass++)
        for (uint32_t y = 0; y < height; y++)
            png_read_row(r->png, (png_bytep)r->scan->px + y * row, NULL);
    png_read_end(r->png, r->info);
    read_facts(r);
    return TRUE;
}

Scan *scan_read_png(ScanFile *f, GError **error)
{
    Reader r = {.f = f};
    r.png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &r, on_error, on_warning, &r, on_malloc, on_free);
    if (r.png)
        r.info = png_create_info_struct(r.png);
    gboolean ok = r.info && decode(&r);
    png_destroy_read_struct(&r.png, &r.info, NULL);
    if (!ok) {
        scan_free(r.scan);
        r.scan = NULL;
        if (r.error)
            g_propagate_error(error, r.error);
        else if (r.code)
            g_set_error(error, G_FILE_ERROR, (gint)g_file_error_from_errno(r.code), "can't read %s: %s", f->path, g_strerror(r.code));
        else
            scan_file_error(f, SCAN_ERROR_DAMAGED, error, "damaged PNG image: %s", r.message ? r.message : "libpng failed");
    }
    g_free(r.message);
    return r.scan;
}
