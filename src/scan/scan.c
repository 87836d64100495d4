#include "scan/scan.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

#include <glib/gstdio.h>

#include "scan/scan_file.h"

G_DEFINE_QUARK(scan-error-quark, scan_error)

Scan *scan_new(uint32_t width, uint32_t height, uint32_t channels, uint32_t depth)
{
    gsize pixel = (gsize)channels * depth / 8, bytes;
    if (!g_size_checked_mul(&bytes, width, height) || !g_size_checked_mul(&bytes, bytes, pixel))
        return NULL;
    void *px = g_try_malloc0(bytes ? bytes : 1);
    if (!px)
        return NULL;
    Scan *s = g_new0(Scan, 1);
    *s = (Scan){.width = width, .height = height, .channels = channels, .depth = depth, .px = px};
    return s;
}

Scan *scan_copy(const Scan *s) { return scan_copy_part(s, 0, 0, s->width, s->height); }

Scan *scan_copy_part(const Scan *s, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1)
{
    Scan *copy = scan_new(s->width, s->height, s->channels, s->depth);
    if (!copy)
        return NULL;
    gsize pixel = (gsize)s->channels * s->depth / 8, row = pixel * s->width;
    char *px = copy->px;
    for (gsize y = y0; y < MIN(y1, s->height) && x0 < MIN(x1, s->width); y++)
        memcpy(px + y * row + x0 * pixel, (const char *)s->px + y * row + x0 * pixel, (MIN(x1, s->width) - x0) * pixel);
    *copy = *s;
    copy->px = px;
    return copy;
}

void scan_free(Scan *s)
{
    if (!s)
        return;
    g_free(s->px);
    g_free(s);
}

Scan *scan_file_error(const ScanFile *f, ScanError code, GError **error, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *text = g_strdup_vprintf(format, args);
    va_end(args);
    g_set_error(error, SCAN_ERROR, code, "%s: %s", f->path, text);
    g_free(text);
    return NULL;
}

Scan *scan_file_no_memory(const ScanFile *f, GError **error)
{
    g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_NOMEM, "can't read %s: %s", f->path, g_strerror(ENOMEM));
    return NULL;
}

Scan *scan_file_new(const ScanFile *f, uint64_t width, uint64_t height, uint32_t channels, uint32_t depth, GError **error)
{
    if (width == 0 || height == 0 || width > INT32_MAX || height > INT32_MAX)
        return scan_file_error(f, SCAN_ERROR_DAMAGED, error, "says it is %" G_GUINT64_FORMAT " × %" G_GUINT64_FORMAT " pixels", width, height);
    if (width * height > f->max_pixels)
        return scan_file_error(f, SCAN_ERROR_SIZE, error,
                               "is %" G_GUINT64_FORMAT " × %" G_GUINT64_FORMAT " pixels; at most %" G_GUINT64_FORMAT " in all are allowed",
                               width, height, f->max_pixels);
    Scan *s = scan_new((uint32_t)width, (uint32_t)height, channels, depth);
    return s ? s : scan_file_no_memory(f, error);
}

/* The size of pixels, if some device has such: 1 … 50 000 dots an inch, up to eight times as many one way as the other. */
static void set_scale(Scan *s, const ScanFile *f)
{
    double x = f->across_mm, y = f->down_mm, least = 1.0 / 25.4, most = 50000.0 / 25.4;
    if (!(x >= least && x <= most && y >= least && y <= most && x <= 8.0 * y && y <= 8.0 * x))
        return;
    bool square = fabs(x - y) <= 0.01 * x, on_side = f->orientation >= 5 && f->orientation <= 8;
    s->mm_per_pixel = square ? 2.0 / (x + y) : 1.0 / sqrt(x * y);
    s->aspect = square ? 1.0 : on_side ? x / y : y / x;
}

typedef Scan *(*ReadFormat)(ScanFile *f, GError **error);

static ReadFormat format_of(const uint8_t *head, size_t n)
{
    static const struct {
        const char *magic;
        size_t n;
        ReadFormat read;
    } known[] = {
        {"\x89PNG\r\n\x1a\n", 8, scan_read_png}, {"\xff\xd8\xff", 3, scan_read_jpeg}, {"II*\0", 4, scan_read_tiff},
        {"MM\0*", 4, scan_read_tiff},           {"II+\0", 4, scan_read_tiff},        {"MM\0+", 4, scan_read_tiff},
    };
    for (size_t i = 0; i < G_N_ELEMENTS(known); i++)
        if (n >= known[i].n && !memcmp(head, known[i].magic, known[i].n))
            return known[i].read;
    return NULL;
}

static Scan *read_open(ScanFile *f, GError **error)
{
    uint8_t head[8];
    size_t n = fread(head, 1, sizeof head, f->file);
    if (ferror(f->file)) {
        g_set_error(error, G_FILE_ERROR, (gint)g_file_error_from_errno(errno), "can't read %s: %s", f->path, g_strerror(errno));
        return NULL;
    }
    if (n == 0)
        return scan_file_error(f, SCAN_ERROR_FORMAT, error, "is empty");
    ReadFormat read = format_of(head, n);
    if (!read)
        return scan_file_error(f, SCAN_ERROR_FORMAT, error, "is not a PNG, JPEG or TIFF image");
    rewind(f->file);
    Scan *s = read(f, error);
    if (s && !scan_orient(s, f->orientation)) {
        scan_free(s);
        return scan_file_no_memory(f, error);
    }
    if (s) {
        set_scale(s, f);
        s->as_stored = read != scan_read_tiff && (f->orientation < 2 || f->orientation > 8);
    }
    return s;
}

Scan *scan_read(const char *path, uint64_t max_pixels, GError **error)
{
    ScanFile f = {.path = path, .max_pixels = max_pixels ? max_pixels : SCAN_MAX_PIXELS};
    GStatBuf about;
    f.file = g_fopen(path, "rb");
    int code = f.file ? 0 : errno;
    if (f.file && fstat(fileno(f.file), &about) == 0 && S_ISDIR(about.st_mode))
        code = EISDIR;
    if (code) {
        g_set_error(error, G_FILE_ERROR, (gint)g_file_error_from_errno(code), "can't read %s: %s", path, g_strerror(code));
        if (f.file)
            fclose(f.file);
        return NULL;
    }
    Scan *s = read_open(&f, error);
    fclose(f.file);
    return s;
}
