#include <errno.h>
#include <string.h>
#include <tiffio.h>

#include "scan/scan_file.h"

/* What a TIFF file says about its pixels. */
typedef struct {
    ScanFile *f;
    TIFF *tif;
    char *message;  /* libtiff's first complaint */
    bool no_memory; /* it came when memory was lacking */
    uint32_t width, height;
    uint16_t bits, samples, format, photometric, planar, compression;
    uint32_t colours;      /* samples that are colour, 0: only libtiff knows how */
    bool alpha, multiplied; /* the sample after them is alpha, and they are multiplied by it */
} Reader;

static int on_error(TIFF *tif, void *user, const char *module, const char *format, va_list args)
{
    Reader *r = user;
    r->no_memory |= errno == ENOMEM;
    if (!r->message)
        r->message = g_strdup_vprintf(format, args);
    return 1;
}

static int on_warning(TIFF *tif, void *user, const char *module, const char *format, va_list args) { return 1; }

/* Some complaints begin with the file's name, which the error has already. */
static const char *complaint(const Reader *r)
{
    gsize n = strlen(r->f->path);
    bool named = r->message && !strncmp(r->message, r->f->path, n) && g_str_has_prefix(r->message + n, ": ");
    return named ? r->message + n + 2 : r->message;
}

static Scan *damaged(Reader *r, GError **error)
{
    if (r->no_memory)
        return scan_file_no_memory(r->f, error);
    return scan_file_error(r->f, SCAN_ERROR_DAMAGED, error, "damaged TIFF image: %s", r->message ? complaint(r) : "libtiff failed");
}

/* More than an image within the limit takes in one piece. */
static uint64_t most_bytes(const ScanFile *f) { return MIN(f->max_pixels, (uint64_t)G_MAXINT64 / 16) * 8 + (1 << 26); }

/* A tile or row buffer; libtiff's sizes come from the file, so they are not to be trusted. */
static uint8_t *buffer_new(Reader *r, tmsize_t bytes, GError **error)
{
    uint8_t *b = bytes > 0 ? g_try_malloc0((gsize)bytes) : NULL;
    if (!b && bytes > 0 && (uint64_t)bytes <= most_bytes(r->f))
        scan_file_no_memory(r->f, error);
    else if (!b)
        scan_file_error(r->f, SCAN_ERROR_SIZE, error, "no memory for a part of %" G_GINT64_FORMAT " bytes", (gint64)bytes);
    return b;
}

/* Copies n pixels of `in_step` samples each to row y from column x on: `count` samples a pixel, to channel `to` and on. */
static void store(Scan *s, uint32_t x, uint32_t y, uint32_t n, const void *in, uint32_t in_step, uint32_t to, uint32_t count, bool invert)
{
    gsize at = ((gsize)y * s->width + x) * s->channels;
    if (s->depth == 8) {
        const uint8_t *from = in;
        uint8_t *out = (uint8_t *)s->px + at + to;
        for (uint32_t i = 0; i < n; i++, from += in_step, out += s->channels)
            for (uint32_t c = 0; c < count; c++)
                out[c] = invert && to + c == 0 ? (uint8_t)(255 - from[c]) : from[c];
    } else {
        const uint16_t *from = in;
        uint16_t *out = (uint16_t *)s->px + at + to;
        for (uint32_t i = 0; i < n; i++, from += in_step, out += s->channels)
            for (uint32_t c = 0; c < count; c++)
                out[c] = invert && to + c == 0 ? (uint16_t)(65535 - from[c]) : from[c];
    }
}

static bool read_rows(Reader *r, Scan *s, GError **error)
{
    bool apart = r->planar == PLANARCONFIG_SEPARATE, invert = r->photometric == PHOTOMETRIC_MINISWHITE;
    gsize needed = (gsize)r->width * (apart ? 1 : r->samples) * r->bits / 8;
    if ((gsize)TIFFScanlineSize64(r->tif) != needed)
        return damaged(r, error);
    uint8_t *row = buffer_new(r, (tmsize_t)needed, error);
    bool ok = row != NULL;
    for (uint32_t k = 0; ok && k < (apart ? s->channels : 1); k++)
        for (uint32_t y = 0; ok && y < s->height; y++) {
            ok = TIFFReadScanline(r->tif, row, y, (uint16_t)k) == 1;
            if (ok)
                store(s, 0, y, s->width, row, apart ? 1 : r->samples, apart ? k : 0, apart ? 1 : s->channels, invert);
            else
                damaged(r, error);
        }
    g_free(row);
    return ok;
}

static bool read_tile(Reader *r, Scan *s, uint8_t *tile, uint32_t x, uint32_t y, uint32_t sample)
{
    bool apart = r->planar == PLANARCONFIG_SEPARATE, invert = r->photometric == PHOTOMETRIC_MINISWHITE;
    uint32_t across = 0, down = 0, step = apart ? 1 : r->samples;
    TIFFGetField(r->tif, TIFFTAG_TILEWIDTH, &across);
    TIFFGetField(r->tif, TIFFTAG_TILELENGTH, &down);
    if (TIFFReadTile(r->tif, tile, x, y, 0, (uint16_t)sample) < 0)
        return false;
    for (uint32_t i = 0; i < MIN(down, s->height - y); i++)
        store(s, x, y + i, MIN(across, s->width - x), tile + (gsize)i * across * step * r->bits / 8, step, apart ? sample : 0,
              apart ? 1 : s->channels, invert);
    return true;
}

static bool read_tiles(Reader *r, Scan *s, GError **error)
{
    bool apart = r->planar == PLANARCONFIG_SEPARATE;
    uint32_t across = 0, down = 0;
    TIFFGetField(r->tif, TIFFTAG_TILEWIDTH, &across);
    TIFFGetField(r->tif, TIFFTAG_TILELENGTH, &down);
    uint64_t needed = (uint64_t)across * down * (apart ? 1 : r->samples) * r->bits / 8;
    if (across == 0 || down == 0 || TIFFTileSize64(r->tif) != needed)
        return damaged(r, error);
    uint8_t *tile = buffer_new(r, TIFFTileSize(r->tif), error);
    bool ok = tile != NULL;
    for (uint32_t k = 0; ok && k < (apart ? s->channels : 1); k++)
        for (uint32_t y = 0; ok && y < s->height; y += MIN(down, s->height - y))
            for (uint32_t x = 0; ok && x < s->width; x += MIN(across, s->width - x)) {
                ok = read_tile(r, s, tile, x, y, k);
                if (!ok)
                    damaged(r, error);
            }
    g_free(tile);
    return ok;
}

static void divide_by_alpha(Scan *s)
{
    uint32_t most = s->depth == 8 ? 255 : 65535, n = s->channels;
    gsize samples = (gsize)s->width * s->height * n;
    for (gsize i = 0; i < samples; i += n) {
        uint32_t a = s->depth == 8 ? ((uint8_t *)s->px)[i + n - 1] : ((uint16_t *)s->px)[i + n - 1];
        for (uint32_t c = 0; a && c < n - 1; c++) {
            if (s->depth == 8)
                ((uint8_t *)s->px)[i + c] = (uint8_t)MIN(most, (((uint8_t *)s->px)[i + c] * most + a / 2) / a);
            else
                ((uint16_t *)s->px)[i + c] = (uint16_t)MIN(most, (((uint16_t *)s->px)[i + c] * most + a / 2) / a);
        }
    }
}

/* Samples as they are. */
static Scan *read_plain(Reader *r, GError **error)
{
    Scan *s = scan_file_new(r->f, r->width, r->height, r->colours + r->alpha, r->bits, error);
    if (!s)
        return NULL;
    if (!(TIFFIsTiled(r->tif) ? read_tiles(r, s, error) : read_rows(r, s, error))) {
        scan_free(s);
        return NULL;
    }
    if (r->alpha && r->multiplied)
        divide_by_alpha(s);
    return s;
}

/* The rest by way of libtiff's own conversion to 8-bit RGBA, a strip or row of tiles at a time. What is transparent there gets white behind. */
static bool read_converted_rows(Reader *r, TIFFRGBAImage *image, Scan *s, uint32_t *raster, uint32_t rows, GError **error)
{
    for (uint32_t y0 = 0; y0 < s->height; y0 += rows) {
        uint32_t n = MIN(rows, s->height - y0);
        image->row_offset = (int)y0;
        if (!TIFFRGBAImageGet(image, raster, s->width, n))
            return damaged(r, error);
        for (gsize i = 0; i < (gsize)n * s->width; i++) {
            uint8_t *out = (uint8_t *)s->px + ((gsize)y0 * s->width + i) * s->channels;
            uint32_t behind = image->alpha ? 255 - TIFFGetA(raster[i]) : 0;
            out[0] = (uint8_t)MIN(255, TIFFGetR(raster[i]) + behind);
            if (s->channels < 3)
                continue;
            out[1] = (uint8_t)MIN(255, TIFFGetG(raster[i]) + behind);
            out[2] = (uint8_t)MIN(255, TIFFGetB(raster[i]) + behind);
        }
    }
    return true;
}

static Scan *read_converted(Reader *r, GError **error)
{
    char why[1024] = "";
    TIFFRGBAImage image;
    if (!TIFFRGBAImageOK(r->tif, why) || !TIFFRGBAImageBegin(&image, r->tif, 1, why))
        return r->no_memory ? damaged(r, error) : scan_file_error(r->f, SCAN_ERROR_KIND, error, "can't read this TIFF image: %s",
                               why[0] ? why : r->message ? r->message : "unknown kind");
    image.req_orientation = image.orientation; /* rows as they are stored */
    bool grey = r->photometric == PHOTOMETRIC_MINISBLACK || r->photometric == PHOTOMETRIC_MINISWHITE;
    uint32_t rows = 0;
    TIFFGetField(r->tif, TIFFIsTiled(r->tif) ? TIFFTAG_TILELENGTH : TIFFTAG_ROWSPERSTRIP, &rows);
    rows = rows == 0 || rows > r->height ? r->height : rows;
    Scan *s = scan_file_new(r->f, r->width, r->height, grey ? 1 : 3, 8, error);
    uint32_t *raster = s ? (uint32_t *)(void *)buffer_new(r, (tmsize_t)rows * r->width * 4, error) : NULL;
    bool ok = raster && read_converted_rows(r, &image, s, raster, rows, error);
    TIFFRGBAImageEnd(&image);
    g_free(raster);
    if (!ok) {
        scan_free(s);
        return NULL;
    }
    return s;
}

static void read_facts(Reader *r)
{
    uint16_t orientation = 0, unit = RESUNIT_INCH;
    float across = 0.0f, down = 0.0f;
    TIFFGetField(r->tif, TIFFTAG_ORIENTATION, &orientation);
    TIFFGetFieldDefaulted(r->tif, TIFFTAG_RESOLUTIONUNIT, &unit);
    r->f->orientation = orientation;
    double mm = unit == RESUNIT_INCH ? 25.4 : unit == RESUNIT_CENTIMETER ? 10.0 : 0.0;
    if (mm > 0.0 && TIFFGetField(r->tif, TIFFTAG_XRESOLUTION, &across) && TIFFGetField(r->tif, TIFFTAG_YRESOLUTION, &down)) {
        r->f->across_mm = (double)across / mm;
        r->f->down_mm = (double)down / mm;
    }
}

/* Which samples mean what; colours stays 0 where it takes libtiff to tell. */
static void read_layout(Reader *r)
{
    uint16_t n_extra = 0, *extra = NULL;
    TIFFGetField(r->tif, TIFFTAG_IMAGEWIDTH, &r->width);
    TIFFGetField(r->tif, TIFFTAG_IMAGELENGTH, &r->height);
    TIFFGetFieldDefaulted(r->tif, TIFFTAG_BITSPERSAMPLE, &r->bits);
    TIFFGetFieldDefaulted(r->tif, TIFFTAG_SAMPLESPERPIXEL, &r->samples);
    TIFFGetFieldDefaulted(r->tif, TIFFTAG_SAMPLEFORMAT, &r->format);
    TIFFGetFieldDefaulted(r->tif, TIFFTAG_PLANARCONFIG, &r->planar);
    TIFFGetFieldDefaulted(r->tif, TIFFTAG_COMPRESSION, &r->compression);
    TIFFGetFieldDefaulted(r->tif, TIFFTAG_EXTRASAMPLES, &n_extra, &extra);
    if (!TIFFGetField(r->tif, TIFFTAG_PHOTOMETRIC, &r->photometric))
        r->photometric = r->samples >= 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK;
    if (r->photometric == PHOTOMETRIC_YCBCR && r->compression == COMPRESSION_JPEG && r->planar == PLANARCONFIG_CONTIG) {
        TIFFSetField(r->tif, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
        r->photometric = PHOTOMETRIC_RGB;
    }
    bool grey = r->photometric == PHOTOMETRIC_MINISBLACK || r->photometric == PHOTOMETRIC_MINISWHITE;
    uint32_t colours = grey ? 1 : r->photometric == PHOTOMETRIC_RGB ? 3 : 0;
    if (colours && r->samples >= colours && (r->bits == 8 || r->bits == 16))
        r->colours = colours;
    if (r->colours && r->samples > colours && n_extra > 0 && (extra[0] == EXTRASAMPLE_ASSOCALPHA || extra[0] == EXTRASAMPLE_UNASSALPHA)) {
        r->alpha = true;
        r->multiplied = extra[0] == EXTRASAMPLE_ASSOCALPHA;
    }
}

static Scan *read_image(Reader *r, GError **error)
{
    read_layout(r);
    read_facts(r);
    if (r->format != SAMPLEFORMAT_UINT && r->format != SAMPLEFORMAT_VOID)
        return scan_file_error(r->f, SCAN_ERROR_KIND, error, "can't read this TIFF image: its samples are not whole numbers from 0 on");
    if (!TIFFIsCODECConfigured(r->compression))
        return scan_file_error(r->f, SCAN_ERROR_KIND, error, "can't read this TIFF image: compression %u is unknown", r->compression);
    if ((uint64_t)r->width * r->height > r->f->max_pixels)
        return scan_file_new(r->f, r->width, r->height, 1, 8, error);
    return r->colours ? read_plain(r, error) : read_converted(r, error);
}

Scan *scan_read_tiff(ScanFile *f, GError **error)
{
    Reader r = {.f = f};
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    if (!options)
        return scan_file_no_memory(f, error);
    TIFFOpenOptionsSetErrorHandlerExtR(options, on_error, &r);
    TIFFOpenOptionsSetWarningHandlerExtR(options, on_warning, &r);
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, (tmsize_t)most_bytes(f));
    errno = 0;
    r.tif = TIFFOpenExt(f->path, "rm", options); /* m: no memory map, which would fault if the file shrank */
    Scan *s = r.tif ? read_image(&r, error) : damaged(&r, error);
    if (r.tif)
        TIFFClose(r.tif);
    TIFFOpenOptionsFree(options);
    g_free(r.message);
    return s;
}
