/* Scans: every kind of file reads back what was written, upright; bad files are refused; thresholds against brute force. */
#include <glib/gstdio.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <string.h>
#include <tiffio.h>

#include <jpeglib.h>

#include "geom/random.h"
#include "scan/scan.h"
#include "scan/scan_file.h"
#include "scan/threshold.h"

enum { W = 23, H = 17 };

static char *dir, *path;

static uint32_t noise(uint32_t stream, uint64_t index, uint32_t below)
{
    double u[2];
    random_pair(3, stream, 0, index, u);
    return (uint32_t)(u[0] * below);
}

static Scan *read_ok(void)
{
    GError *error = NULL;
    Scan *s = scan_read(path, 0, &error);
    g_assert_no_error(error);
    g_assert_nonnull(s);
    return s;
}

static void read_fails(const char *at, uint64_t max_pixels, GQuark domain, int code, const char *says)
{
    GError *error = NULL;
    Scan *s = scan_read(at, max_pixels, &error);
    g_assert_null(s);
    if (code < 0)
        g_assert_nonnull(error);
    else
        g_assert_error(error, domain, code);
    if (!strstr(error->message, says))
        g_error("'%s' is not in '%s'", says, error->message);
    g_assert_nonnull(strstr(error->message, at));
    g_error_free(error);
}

static void assert_pixels(const Scan *s, uint32_t channels, uint32_t depth, const uint32_t *want)
{
    g_assert_cmpuint(s->width, ==, W);
    g_assert_cmpuint(s->height, ==, H);
    g_assert_cmpuint(s->channels, ==, channels);
    g_assert_cmpuint(s->depth, ==, depth);
    for (uint32_t i = 0; i < W * H * channels; i++)
        g_assert_cmpuint(scan_sample(s, i / channels % W, i / channels / W, i % channels), ==, want[i]);
}

/* PNG */

typedef struct {
    int colour, bits, interlace;
    bool trns;
    uint32_t phys; /* height of a pixel, widths; 0: no resolution is said */
    unsigned orientation;
} PngKind;

static const uint8_t PALETTE[4][3] = {{10, 20, 30}, {200, 100, 0}, {255, 255, 255}, {1, 2, 3}};

static void write_png(const PngKind *k, const uint16_t *value, uint32_t samples)
{
    FILE *f = fopen(path, "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, f);
    png_set_IHDR(png, info, W, H, k->bits, k->colour, k->interlace, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_color palette[4];
    for (int i = 0; i < 4; i++)
        palette[i] = (png_color){PALETTE[i][0], PALETTE[i][1], PALETTE[i][2]};
    if (k->colour == PNG_COLOR_TYPE_PALETTE)
        png_set_PLTE(png, info, palette, 4);
    png_color_16 clear = {.gray = 1, .red = 1, .green = 1, .blue = 1};
    png_byte alpha[2] = {255, 77};
    if (k->trns)
        png_set_tRNS(png, info, alpha, 2, &clear);
    if (k->phys)
        png_set_pHYs(png, info, 11811, 11811 / k->phys, PNG_RESOLUTION_METER);
    png_byte exif[26] = {'M', 'M', 0, 42, 0, 0, 0, 8, 0, 1, 1, 0x12, 0, 3, 0, 0, 0, 1, 0, (png_byte)k->orientation};
    if (k->orientation)
        png_set_eXIf_1(png, info, sizeof exif, exif);
    png_write_info(png, info);
    int passes = k->interlace ? png_set_interlace_handling(png) : 1;
    if (k->bits < 8)
        png_set_packing(png);
    for (int pass = 0; pass < passes; pass++)
        for (uint32_t y = 0; y < H; y++) {
            uint8_t row[W * 8];
            for (uint32_t i = 0; i < W * samples; i++) {
                uint16_t v = value[y * W * samples + i];
                if (k->bits == 16) {
                    row[2 * i] = (uint8_t)(v >> 8);
                    row[2 * i + 1] = (uint8_t)v;
                } else {
                    row[i] = (uint8_t)v;
                }
            }
            png_write_row(png, row);
        }
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
    fclose(f);
}

/* What the file's samples stand for, by the PNG specification. */
static uint32_t expect_png(const PngKind *k, const uint16_t *value, uint32_t samples, uint32_t *want)
{
    bool palette = k->colour == PNG_COLOR_TYPE_PALETTE;
    uint32_t channels = (palette ? 3 : samples) + k->trns, most = (1u << k->bits) - 1, scale = k->bits < 8 ? 255 / most : 1, n = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        bool clear = true;
        for (uint32_t c = 0; c < channels - k->trns; c++) {
            uint32_t v = value[i * samples + (palette ? 0 : c)];
            want[n++] = palette ? PALETTE[v][c] : v * scale;
            clear &= v == 1;
        }
        if (k->trns)
            want[n++] = palette ? (clear ? 77 : 255) : clear ? 0 : MAX(most, 255);
    }
    return channels;
}

static void test_png(void)
{
    static const struct {
        int colour;
        uint32_t samples;
        int bits[6];
    } kinds[] = {{PNG_COLOR_TYPE_GRAY, 1, {1, 2, 4, 8, 16}},
                 {PNG_COLOR_TYPE_PALETTE, 1, {2, 4, 8}},
                 {PNG_COLOR_TYPE_RGB, 3, {8, 16}},
                 {PNG_COLOR_TYPE_GRAY_ALPHA, 2, {8, 16}},
                 {PNG_COLOR_TYPE_RGB_ALPHA, 4, {8, 16}}};
    uint16_t value[W * H * 4];
    uint32_t want[W * H * 4];
    for (uint32_t i = 0; i < G_N_ELEMENTS(kinds); i++)
        for (int b = 0; kinds[i].bits[b]; b++)
            for (int variant = 0; variant < 4; variant++) {
                PngKind k = {kinds[i].colour, kinds[i].bits[b], variant & 1 ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, false, variant == 2, 0};
                k.trns = variant & 2 && kinds[i].samples % 2 == 1;
                uint32_t most = k.colour == PNG_COLOR_TYPE_PALETTE ? 4 : variant & 2 ? 3 : 1u << k.bits;
                for (uint32_t j = 0; j < W * H * kinds[i].samples; j++)
                    value[j] = (uint16_t)noise(i, j, MIN(most, 1u << k.bits));
                write_png(&k, value, kinds[i].samples);
                Scan *s = read_ok();
                assert_pixels(s, expect_png(&k, value, kinds[i].samples, want), k.bits == 16 ? 16 : 8, want);
                g_assert_cmpfloat(fabs(s->mm_per_pixel - (k.phys ? 25.4 / 300.0 : 0.0)), <=, 1e-5);
                scan_free(s);
            }
}

/* Pixels that are not square: areas are right, and which way they are long is known however the image lies. */
static void test_png_aspect(void)
{
    uint16_t value[W * H * 3] = {0};
    for (uint32_t tall = 1; tall <= 10; tall += 3)
        for (unsigned o = 0; o <= 8; o += 2) {
            PngKind k = {.colour = PNG_COLOR_TYPE_RGB, .bits = 8, .interlace = PNG_INTERLACE_NONE, .phys = tall, .orientation = o};
            write_png(&k, value, 3);
            Scan *s = read_ok();
            double mm = tall > 8 ? 0.0 : 25.4 / 300.0 * sqrt(tall), aspect = tall > 8 ? 0.0 : o > 4 ? tall : 1.0 / tall;
            g_assert_cmpfloat(fabs(s->mm_per_pixel - mm), <=, 1e-4);
            g_assert_cmpfloat(fabs(s->aspect - aspect), <=, 1e-3 * aspect);
            scan_free(s);
        }
}

/* JPEG */

/* `exif` as it is in an APP1 marker, or NULL. */
static void write_jpeg(J_COLOR_SPACE in, J_COLOR_SPACE stored, uint32_t samples, const uint8_t *value, bool progressive, int dpi, GByteArray *exif)
{
    FILE *f = fopen(path, "wb");
    struct jpeg_compress_struct j = {0};
    struct jpeg_error_mgr manager;
    j.err = jpeg_std_error(&manager);
    jpeg_create_compress(&j);
    jpeg_stdio_dest(&j, f);
    j.image_width = W;
    j.image_height = H;
    j.input_components = (int)samples;
    j.in_color_space = in;
    jpeg_set_defaults(&j);
    jpeg_set_colorspace(&j, stored);
    jpeg_set_quality(&j, 100, TRUE);
    for (int c = 0; c < j.num_components; c++)
        j.comp_info[c].h_samp_factor = j.comp_info[c].v_samp_factor = 1;
    if (progressive)
        jpeg_simple_progression(&j);
    if (dpi) {
        j.density_unit = 1;
        j.X_density = j.Y_density = (UINT16)dpi;
    }
    jpeg_start_compress(&j, TRUE);
    if (exif)
        jpeg_write_marker(&j, JPEG_APP0 + 1, exif->data, exif->len);
    for (uint32_t y = 0; y < H; y++) {
        JSAMPROW row = (JSAMPROW)value + y * W * samples;
        jpeg_write_scanlines(&j, &row, 1);
    }
    jpeg_finish_compress(&j);
    jpeg_destroy_compress(&j);
    fclose(f);
}

/* A smooth picture, which JPEG keeps to some levels. */
static void ramp(uint8_t *value, uint32_t samples)
{
    for (uint32_t i = 0; i < W * H; i++)
        for (uint32_t c = 0; c < samples; c++)
            value[i * samples + c] = (uint8_t)(c % 3 == 0 ? 5 * (i % W) + 60 : c % 3 == 1 ? 6 * (i / W) + 90 : 150 - 3 * (i % W) + 4 * (i / W));
}

static void assert_near(const Scan *s, uint32_t x, uint32_t y, uint32_t c, double want)
{
    if (fabs(scan_sample(s, x, y, c) - want) > 6.0)
        g_error("at %u, %u channel %u: %u, wanted %g", x, y, c, scan_sample(s, x, y, c), want);
}

static void test_jpeg(void)
{
    uint8_t value[W * H * 4];
    static const struct {
        J_COLOR_SPACE in, stored;
        uint32_t samples;
    } kinds[] = {{JCS_GRAYSCALE, JCS_GRAYSCALE, 1}, {JCS_RGB, JCS_YCbCr, 3}, {JCS_RGB, JCS_RGB, 3}, {JCS_CMYK, JCS_CMYK, 4}, {JCS_CMYK, JCS_YCCK, 4}};
    for (uint32_t i = 0; i < G_N_ELEMENTS(kinds); i++)
        for (int progressive = 0; progressive < 2; progressive++) {
            ramp(value, kinds[i].samples);
            write_jpeg(kinds[i].in, kinds[i].stored, kinds[i].samples, value, progressive, progressive ? 600 : 0, NULL);
            Scan *s = read_ok();
            g_assert_cmpuint(s->channels, ==, kinds[i].samples == 1 ? 1 : 3);
            g_assert_cmpuint(s->depth, ==, 8);
            bool jfif = kinds[i].stored == JCS_GRAYSCALE || kinds[i].stored == JCS_YCbCr; /* libjpeg writes that marker for these only */
            g_assert_cmpfloat(fabs(s->mm_per_pixel - (progressive && jfif ? 25.4 / 600.0 : 0.0)), <=, 1e-9);
            for (uint32_t k = 0; k < W * H; k++)
                for (uint32_t c = 0; c < s->channels; c++) {
                    const uint8_t *v = value + k * kinds[i].samples;
                    /* libjpeg writes Adobe's marker with CMYK, whose values are complements: v[c] is how much of red there is before black. */
                    assert_near(s, k % W, k / W, c, kinds[i].samples == 4 ? v[c] * v[3] / 255.0 : v[c]);
                }
            scan_free(s);
        }
}

static void put(GByteArray *b, bool little, uint32_t v, int bytes)
{
    for (int i = 0; i < bytes; i++) {
        uint8_t byte = (uint8_t)(v >> 8 * (little ? i : bytes - 1 - i));
        g_byte_array_append(b, &byte, 1);
    }
}

static GByteArray *exif_block(bool little, uint32_t orientation, uint32_t dots, uint32_t unit)
{
    GByteArray *b = g_byte_array_new();
    g_byte_array_append(b, (const guint8 *)"Exif\0\0", 6);
    g_byte_array_append(b, (const guint8 *)(little ? "II*\0" : "MM\0*"), 4);
    put(b, little, 8, 4);
    put(b, little, 4, 2);
    const uint32_t entry[4][4] = {{0x0112, 3, 1, orientation}, {0x011A, 5, 1, 62}, {0x011B, 5, 1, 62}, {0x0128, 3, 1, unit}};
    for (int i = 0; i < 4; i++) {
        put(b, little, entry[i][0], 2);
        put(b, little, entry[i][1], 2);
        put(b, little, entry[i][2], 4);
        put(b, little, entry[i][3], entry[i][1] == 3 ? 2 : 4);
        if (entry[i][1] == 3)
            put(b, little, 0, 2);
    }
    put(b, little, 0, 4);
    put(b, little, dots, 4);
    put(b, little, 1, 4);
    return b;
}

/* Where the stored pixel (x, y) is seen, from the table of the Exif standard: which side row 0 and column 0 are. */
static void seen_at(unsigned orientation, uint32_t x, uint32_t y, uint32_t *u, uint32_t *v)
{
    switch (orientation) {
    case 2: *u = W - 1 - x, *v = y; break;         /* top, right */
    case 3: *u = W - 1 - x, *v = H - 1 - y; break; /* bottom, right */
    case 4: *u = x, *v = H - 1 - y; break;         /* bottom, left */
    case 5: *u = y, *v = x; break;                 /* left, top */
    case 6: *u = H - 1 - y, *v = x; break;         /* right, top */
    case 7: *u = H - 1 - y, *v = W - 1 - x; break; /* right, bottom */
    case 8: *u = y, *v = W - 1 - x; break;         /* left, bottom */
    default: *u = x, *v = y;
    }
}

static void test_jpeg_exif(void)
{
    uint8_t value[W * H * 3];
    ramp(value, 3);
    for (unsigned o = 0; o <= 9; o++) {
        GByteArray *exif = exif_block(o % 2, o, 300, 2 + o % 2);
        write_jpeg(JCS_RGB, JCS_YCbCr, 3, value, false, 0, exif);
        Scan *s = read_ok();
        g_assert_cmpuint(s->width, ==, o >= 5 && o <= 8 ? H : W);
        g_assert_cmpfloat(fabs(s->mm_per_pixel - (o % 2 ? 10.0 / 300.0 : 25.4 / 300.0)), <=, 1e-9);
        for (uint32_t k = 0; k < W * H; k++) {
            uint32_t u, v;
            seen_at(o, k % W, k / W, &u, &v);
            for (uint32_t c = 0; c < 3; c++)
                assert_near(s, u, v, c, value[3 * k + c]);
        }
        scan_free(s);
        g_byte_array_unref(exif);
    }
}

static void test_png_exif(void)
{
    uint16_t value[W * H];
    for (uint32_t i = 0; i < W * H; i++)
        value[i] = (uint16_t)noise(9, i, 65536);
    for (unsigned o = 1; o <= 8; o++) {
        PngKind k = {PNG_COLOR_TYPE_GRAY, 16, PNG_INTERLACE_NONE, false, true, o};
        write_png(&k, value, 1);
        Scan *s = read_ok();
        for (uint32_t i = 0; i < W * H; i++) {
            uint32_t u, v;
            seen_at(o, i % W, i / W, &u, &v);
            g_assert_cmpuint(scan_sample(s, u, v, 0), ==, value[i]);
        }
        g_assert_cmpfloat(s->mm_per_pixel, >, 0.08);
        scan_free(s);
    }
}

/* Exif blocks with any bytes changed: nothing is read that isn't there. */
static void test_exif_noise(void)
{
    for (uint32_t k = 0; k < 20000; k++) {
        GByteArray *exif = exif_block(k % 2, 6, 300, 2);
        uint8_t *copy = g_memdup2(exif->data + 6, exif->len - 6);
        size_t n = noise(40, 3 * k, exif->len - 5);
        for (uint32_t i = 0; i < 1 + k % 4 && n > 0; i++)
            copy[noise(41, 4 * k + i, (uint32_t)n)] = (uint8_t)noise(42, 4 * k + i, 256);
        uint8_t *exact = g_memdup2(copy, n ? n : 1);
        ScanFile f = {0};
        scan_file_exif(&f, exact, n);
        g_assert_true(n >= 18 || f.orientation == 0);
        g_free(exact);
        g_free(copy);
        g_byte_array_unref(exif);
    }
}

/* TIFF */

typedef struct {
    uint16_t photometric, samples, bits, planar, compression, extra; /* extra: 0 none, else 1 + its kind */
    bool tiled, sixteenths; /* sixteenths: resolution in centimetres */
    uint16_t orientation;
} TiffKind;

/* Samples as bytes or native words, pixel by pixel. */
static void write_tiff(const TiffKind *k, const uint16_t *value)
{
    TIFF *t = TIFFOpen(path, "w");
    TIFFSetField(t, TIFFTAG_IMAGEWIDTH, W);
    TIFFSetField(t, TIFFTAG_IMAGELENGTH, H);
    TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, k->bits);
    TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, k->samples);
    TIFFSetField(t, TIFFTAG_PHOTOMETRIC, k->photometric);
    TIFFSetField(t, TIFFTAG_PLANARCONFIG, k->planar);
    TIFFSetField(t, TIFFTAG_COMPRESSION, k->compression);
    if (k->orientation)
        TIFFSetField(t, TIFFTAG_ORIENTATION, k->orientation);
    uint16_t kind = (uint16_t)(k->extra - 1);
    if (k->extra)
        TIFFSetField(t, TIFFTAG_EXTRASAMPLES, 1, &kind);
    TIFFSetField(t, TIFFTAG_RESOLUTIONUNIT, k->sixteenths ? RESUNIT_CENTIMETER : RESUNIT_INCH);
    TIFFSetField(t, TIFFTAG_XRESOLUTION, k->sixteenths ? 160.0 : 300.0);
    TIFFSetField(t, TIFFTAG_YRESOLUTION, k->sixteenths ? 160.0 : 300.0);
    uint16_t map[3][256] = {{0}};
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++)
            map[c][i] = (uint16_t)(PALETTE[i][c] * 257);
    if (k->photometric == PHOTOMETRIC_PALETTE)
        TIFFSetField(t, TIFFTAG_COLORMAP, map[0], map[1], map[2]);
    if (k->tiled) {
        TIFFSetField(t, TIFFTAG_TILEWIDTH, 16);
        TIFFSetField(t, TIFFTAG_TILELENGTH, 16);
    } else {
        TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, 5);
    }
    bool apart = k->planar == PLANARCONFIG_SEPARATE;
    uint32_t planes = apart ? k->samples : 1, each = apart ? 1 : k->samples, across = k->tiled ? 16 : W, down = k->tiled ? 16 : 1;
    for (uint32_t p = 0; p < planes; p++)
        for (uint32_t y0 = 0; y0 < H; y0 += down)
            for (uint32_t x0 = 0; x0 < W; x0 += across) {
                uint16_t words[16 * 32 * 4] = {0};
                uint8_t *bytes = (uint8_t *)words;
                for (uint32_t y = 0; y < down && y0 + y < H; y++)
                    for (uint32_t x = 0; x < across && x0 + x < W; x++)
                        for (uint32_t c = 0; c < each; c++) {
                            uint16_t v = value[((y0 + y) * W + x0 + x) * k->samples + (apart ? p : c)];
                            if (k->bits == 16)
                                words[(y * across + x) * each + c] = v;
                            else if (k->bits == 8)
                                bytes[(y * across + x) * each + c] = (uint8_t)v;
                            else if (v)
                                bytes[x / 8] |= (uint8_t)(128u >> x % 8);
                        }
                if (k->tiled)
                    TIFFWriteTile(t, words, x0, y0, 0, (uint16_t)p);
                else
                    TIFFWriteScanline(t, words, y0, (uint16_t)p);
            }
    TIFFClose(t);
}

static void fill_noise(uint16_t *value, uint32_t n, uint32_t stream, uint32_t below)
{
    for (uint32_t i = 0; i < n; i++)
        value[i] = (uint16_t)noise(stream, i, below);
}

static void test_tiff_plain(void)
{
    static const struct {
        uint16_t photometric, samples, extra, channels;
    } kinds[] = {{PHOTOMETRIC_MINISBLACK, 1, 0, 1},
                 {PHOTOMETRIC_MINISWHITE, 1, 0, 1},
                 {PHOTOMETRIC_RGB, 3, 0, 3},
                 {PHOTOMETRIC_RGB, 4, 1 + EXTRASAMPLE_UNASSALPHA, 4},
                 {PHOTOMETRIC_RGB, 4, 1 + EXTRASAMPLE_UNSPECIFIED, 3},
                 {PHOTOMETRIC_MINISBLACK, 2, 1 + EXTRASAMPLE_UNASSALPHA, 2}};
    static const uint16_t compressions[] = {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS};
    uint16_t value[W * H * 4];
    uint32_t want[W * H * 4];
    for (uint32_t i = 0; i < G_N_ELEMENTS(kinds); i++)
        for (uint32_t variant = 0; variant < 16; variant++) {
            TiffKind k = {kinds[i].photometric, kinds[i].samples, variant & 1 ? 16 : 8, variant & 2 ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG,
                          compressions[(variant / 4 + i) % 4], kinds[i].extra, variant & 4, variant & 8, 0};
            uint32_t most = k.bits == 16 ? 65535 : 255, n = 0;
            fill_noise(value, W * H * k.samples, i, most + 1);
            write_tiff(&k, value);
            for (uint32_t p = 0; p < W * H; p++)
                for (uint32_t c = 0; c < kinds[i].channels; c++) {
                    uint32_t v = value[p * k.samples + c];
                    want[n++] = k.photometric == PHOTOMETRIC_MINISWHITE ? most - v : v;
                }
            Scan *s = read_ok();
            assert_pixels(s, kinds[i].channels, k.bits, want);
            g_assert_cmpfloat(fabs(s->mm_per_pixel - (k.sixteenths ? 1.0 / 16.0 : 25.4 / 300.0)), <=, 1e-6);
            scan_free(s);
        }
}

/* Kinds that libtiff converts; and alpha that colours were multiplied by. */
static void test_tiff_converted(void)
{
    uint16_t value[W * H * 4];
    uint32_t want[W * H * 4];
    TiffKind palette = {PHOTOMETRIC_PALETTE, 1, 8, PLANARCONFIG_CONTIG, COMPRESSION_LZW, 0, false, false, 0};
    for (int tiled = 0; tiled < 2; tiled++) {
        palette.tiled = tiled;
        fill_noise(value, W * H, 50, 4);
        for (uint32_t i = 0; i < W * H * 3; i++)
            want[i] = PALETTE[value[i / 3]][i % 3];
        write_tiff(&palette, value);
        Scan *s = read_ok();
        assert_pixels(s, 3, 8, want);
        scan_free(s);
    }
    TiffKind bits = {PHOTOMETRIC_MINISWHITE, 1, 1, PLANARCONFIG_CONTIG, COMPRESSION_CCITTFAX4, 0, false, false, 0};
    fill_noise(value, W * H, 51, 2);
    for (uint32_t i = 0; i < W * H; i++)
        want[i] = value[i] ? 0 : 255;
    write_tiff(&bits, value);
    Scan *s = read_ok();
    assert_pixels(s, 1, 8, want);
    scan_free(s);
    TiffKind cmyk = {PHOTOMETRIC_SEPARATED, 4, 8, PLANARCONFIG_CONTIG, COMPRESSION_NONE, 0, false, false, 0};
    fill_noise(value, W * H * 4, 52, 256);
    write_tiff(&cmyk, value);
    s = read_ok();
    g_assert_cmpuint(s->channels, ==, 3);
    for (uint32_t i = 0; i < W * H * 3; i++) {
        const uint16_t *v = value + i / 3 * 4;
        assert_near(s, i / 3 % W, i / 3 / W, i % 3, (255 - v[i % 3]) * (255 - v[3]) / 255.0);
    }
    scan_free(s);
    TiffKind multiplied = {PHOTOMETRIC_RGB, 4, 16, PLANARCONFIG_CONTIG, COMPRESSION_NONE, 1 + EXTRASAMPLE_ASSOCALPHA, false, false, 0};
    for (uint32_t i = 0; i < W * H * 4; i++) {
        uint32_t a = i / 4 % 5 * 16383, v = noise(53, i, 65536);
        want[i] = i % 4 == 3 ? a : a ? v : 0;
        value[i] = (uint16_t)(i % 4 == 3 ? a : (want[i] * (uint64_t)a + 32767) / 65535);
    }
    write_tiff(&multiplied, value);
    s = read_ok();
    for (uint32_t i = 0; i < W * H * 4; i++)
        g_assert_cmpint(abs((int)scan_sample(s, i / 4 % W, i / 4 / W, i % 4) - (int)want[i]), <=, 3);
    scan_free(s);
}

static void test_tiff_orientation(void)
{
    uint16_t value[W * H * 3];
    fill_noise(value, W * H * 3, 54, 256);
    for (int converted = 0; converted < 2; converted++)
        for (uint16_t o = 1; o <= 8; o++) {
            TiffKind k = {PHOTOMETRIC_RGB, 3, 8, PLANARCONFIG_CONTIG, COMPRESSION_LZW, 0, false, false, o};
            if (converted) {
                k.photometric = PHOTOMETRIC_PALETTE;
                k.samples = 1;
                for (uint32_t i = 0; i < W * H; i++)
                    value[i] &= 3;
            }
            write_tiff(&k, value);
            Scan *s = read_ok();
            for (uint32_t i = 0; i < W * H * 3; i++) {
                uint32_t u, v;
                seen_at(o, i / 3 % W, i / 3 / W, &u, &v);
                g_assert_cmpuint(scan_sample(s, u, v, i % 3), ==, converted ? PALETTE[value[i / 3]][i % 3] : value[i]);
            }
            scan_free(s);
            if (converted)
                continue;
            fill_noise(value, W * H * 3, 54 + o, 256);
        }
}

static void test_tiff_jpeg(void)
{
    uint8_t value[W * H * 3];
    ramp(value, 3);
    TIFF *t = TIFFOpen(path, "w");
    TIFFSetField(t, TIFFTAG_IMAGEWIDTH, W);
    TIFFSetField(t, TIFFTAG_IMAGELENGTH, H);
    TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, 8);
    TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 3);
    TIFFSetField(t, TIFFTAG_COMPRESSION, COMPRESSION_JPEG);
    TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_YCBCR);
    TIFFSetField(t, TIFFTAG_YCBCRSUBSAMPLING, 1, 1);
    TIFFSetField(t, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
    TIFFSetField(t, TIFFTAG_JPEGQUALITY, 100);
    TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, 8);
    for (uint32_t y = 0; y < H; y++)
        TIFFWriteScanline(t, value + y * W * 3, y, 0);
    TIFFClose(t);
    Scan *s = read_ok();
    g_assert_cmpuint(s->channels, ==, 3);
    for (uint32_t i = 0; i < W * H * 3; i++)
        assert_near(s, i / 3 % W, i / 3 / W, i % 3, value[i]);
    scan_free(s);
}

static void test_tiff_refused(void)
{
    static const uint16_t bad[][2] = {{32, SAMPLEFORMAT_IEEEFP}, {16, SAMPLEFORMAT_INT}, {32, SAMPLEFORMAT_UINT}};
    float row[W] = {0.5f};
    for (uint32_t i = 0; i < G_N_ELEMENTS(bad); i++) {
        TIFF *t = TIFFOpen(path, "w");
        TIFFSetField(t, TIFFTAG_IMAGEWIDTH, W);
        TIFFSetField(t, TIFFTAG_IMAGELENGTH, 1);
        TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, bad[i][0]);
        TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, bad[i][1]);
        TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFWriteScanline(t, row, 0, 0);
        TIFFClose(t);
        read_fails(path, 0, SCAN_ERROR, SCAN_ERROR_KIND, "can't read this TIFF image");
    }
}

/* Bad files */

static void spit(const void *data, gsize n)
{
    FILE *f = fopen(path, "wb");
    g_assert_cmpuint(fwrite(data, 1, n, f), ==, n);
    fclose(f);
}

/* Writes small pictures of all sorts, one at a time. False when there are no more. */
static bool write_sample(uint32_t which)
{
    uint16_t value[W * H * 4];
    uint8_t bytes[W * H * 3];
    fill_noise(value, W * H * 4, 60, 256);
    ramp(bytes, 3);
    PngKind png[] = {{PNG_COLOR_TYPE_RGB, 8, PNG_INTERLACE_NONE, false, true, 6}, {PNG_COLOR_TYPE_GRAY, 16, PNG_INTERLACE_ADAM7, false, false, 0}};
    TiffKind tiff[] = {{PHOTOMETRIC_RGB, 3, 8, PLANARCONFIG_CONTIG, COMPRESSION_LZW, 0, false, false, 3},
                       {PHOTOMETRIC_RGB, 4, 16, PLANARCONFIG_SEPARATE, COMPRESSION_ADOBE_DEFLATE, 1 + EXTRASAMPLE_ASSOCALPHA, true, false, 0},
                       {PHOTOMETRIC_SEPARATED, 4, 8, PLANARCONFIG_CONTIG, COMPRESSION_NONE, 0, false, false, 0},
                       {PHOTOMETRIC_MINISBLACK, 1, 8, PLANARCONFIG_CONTIG, COMPRESSION_NONE, 0, false, false, 0}};
    GByteArray *exif = exif_block(false, 8, 300, 2);
    if (which < 2)
        write_png(&png[which], value, which == 0 ? 3 : 1);
    else if (which < 4)
        write_jpeg(JCS_RGB, JCS_YCbCr, 3, bytes, which == 3, 300, exif);
    else if (which < 8)
        write_tiff(&tiff[which - 4], value);
    g_byte_array_unref(exif);
    return which < 8;
}

static void test_truncated(void)
{
    for (uint32_t which = 0; write_sample(which); which++) {
        char *data;
        gsize n;
        g_assert_true(g_file_get_contents(path, &data, &n, NULL));
        scan_free(read_ok());
        for (gsize cut = 0; cut < n; cut += cut < 64 || cut + 16 > n ? 1 : 13) {
            spit(data, cut);
            read_fails(path, 0, 0, -1, cut == 0 ? "is empty" : ": ");
        }
        g_free(data);
    }
}

/* Changed bytes may go unnoticed but must not crash, and never give more than was allowed. */
static void test_corrupted(void)
{
    for (uint32_t which = 0; write_sample(which); which++) {
        char *data;
        gsize n;
        g_assert_true(g_file_get_contents(path, &data, &n, NULL));
        for (uint32_t k = 0; k < 400; k++) {
            char *copy = g_memdup2(data, n);
            for (uint32_t i = 0; i <= k % 3; i++)
                copy[noise(61, 12 * k + i + 5000 * which, (uint32_t)n)] = (char)noise(62, 12 * k + i, 256);
            spit(copy, n);
            GError *error = NULL;
            Scan *s = scan_read(path, 100000, &error);
            g_assert_true((s == NULL) == (error != NULL));
            g_assert_true(!s || (uint64_t)s->width * s->height <= 100000);
            g_clear_error(&error);
            scan_free(s);
            g_free(copy);
        }
        g_free(data);
    }
}

static void test_not_images(void)
{
    char *missing = g_build_filename(dir, "missing.png", NULL);
    read_fails(missing, 0, G_FILE_ERROR, G_FILE_ERROR_NOENT, "can't read");
    read_fails(dir, 0, G_FILE_ERROR, G_FILE_ERROR_ISDIR, "can't read");
    g_free(missing);
    spit("", 0);
    read_fails(path, 0, SCAN_ERROR, SCAN_ERROR_FORMAT, "is empty");
    static const char *const texts[] = {"GIF89a......", "x", "<svg/>", "II", "\x89PNG\r\n", "leaf.png is a name"};
    for (uint32_t i = 0; i < G_N_ELEMENTS(texts); i++) {
        spit(texts[i], strlen(texts[i]));
        read_fails(path, 0, SCAN_ERROR, SCAN_ERROR_FORMAT, "is not a PNG, JPEG or TIFF image");
    }
}

static void test_size_limit(void)
{
    for (uint32_t which = 0; write_sample(which); which++) {
        read_fails(path, W * H - 1, SCAN_ERROR, SCAN_ERROR_SIZE, "at most 390 in all are allowed");
        Scan *s = scan_read(path, W * H, NULL);
        g_assert_nonnull(s);
        scan_free(s);
    }
    /* A PNG header that announces 2³⁰ × 2³⁰ pixels. */
    static const uint8_t bomb[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 0, 0, 0, 13, 'I', 'H', 'D', 'R', 0x40, 0, 0, 0, 0x40, 0, 0, 0, 8, 2, 0, 0, 0};
    GByteArray *b = g_byte_array_new();
    g_byte_array_append(b, bomb, sizeof bomb);
    uint32_t crc = 0xFFFFFFFFu;
    for (guint i = 12; i < b->len; i++) {
        crc ^= b->data[i];
        for (int k = 0; k < 8; k++)
            crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
    }
    put(b, false, ~crc, 4);
    g_byte_array_append(b, (const guint8 *)"\0\0\0\0IDAT\x35\xaf\x06\x1e", 12);
    spit(b->data, b->len);
    read_fails(path, 0, SCAN_ERROR, SCAN_ERROR_SIZE, "1073741824 × 1073741824");
    g_byte_array_unref(b);
}

/* Thresholds */

static Scan *grey(uint32_t w, uint32_t h, uint32_t depth)
{
    Scan *s = scan_new(w, h, 1, depth);
    g_assert_nonnull(s);
    return s;
}

/* Otsu by trying every level on the values themselves: the share of variance it explains. */
static double explained(const Scan *s, double level)
{
    double n[2] = {0}, sum[2] = {0}, squares = 0.0;
    uint32_t pixels = s->width * s->height;
    for (uint32_t i = 0; i < pixels; i++) {
        double v = scan_sample(s, i % s->width, i / s->width, 0);
        n[v >= level]++;
        sum[v >= level] += v;
        squares += v * v;
    }
    double mean = (sum[0] + sum[1]) / pixels, within = squares;
    for (int k = 0; k < 2; k++)
        within -= n[k] > 0.0 ? sum[k] * sum[k] / n[k] : 0.0;
    return 1.0 - within / (squares - pixels * mean * mean);
}

static void test_otsu(void)
{
    for (uint32_t k = 0; k < 40; k++) {
        uint32_t depth = k % 2 ? 16 : 8, most = depth == 8 ? 255 : 4000;
        Scan *s = grey(31, 29, depth);
        for (uint32_t i = 0; i < 31 * 29; i++) {
            uint32_t v = noise(70, 2000 * k + i, 10) < k / 5 ? noise(71, 2000 * k + i, most / 2) : most / 3 + noise(72, 2000 * k + i, most - most / 3);
            if (depth == 8)
                ((uint8_t *)s->px)[i] = (uint8_t)v;
            else
                ((uint16_t *)s->px)[i] = (uint16_t)v;
        }
        ThresholdDef def = {CHANNEL_GREY, LEAF_DARK, -1.0};
        Threshold t;
        g_assert_true(threshold_find(s, &def, &t, NULL)); /* 6 % of the scale are contrast enough */
        double best = 0.0;
        for (uint32_t level = 1; level <= most; level++)
            best = fmax(best, explained(s, level));
        g_assert_cmpfloat(fabs(t.separability - best), <=, 1e-9);
        g_assert_cmpfloat(fabs(explained(s, t.level) - best), <=, 1e-9);
        uint8_t mask[31 * 29];
        threshold_apply(s, &t, mask);
        for (uint32_t i = 0; i < 31 * 29; i++)
            g_assert_cmpuint(mask[i], ==, scan_sample(s, i % 31, i / 31, 0) < t.level);
        scan_free(s);
    }
}

/* The level lies in the middle of the gap between the classes. */
static void test_otsu_gap(void)
{
    Scan *s = grey(10, 10, 8);
    for (int i = 0; i < 100; i++)
        ((uint8_t *)s->px)[i] = i < 30 ? 50 : 200;
    ThresholdDef def = {CHANNEL_BEST, LEAF_BY_FRAME, -1.0};
    Threshold t;
    g_assert_true(threshold_find(s, &def, &t, NULL));
    g_assert_cmpfloat(t.level, ==, 125.0);
    g_assert_cmpfloat(t.separability, ==, 1.0);
    g_assert_true(t.dark && t.channel == CHANNEL_GREY);
    def.level = 100.0;
    g_assert_true(threshold_find(s, &def, &t, NULL));
    g_assert_cmpfloat(t.level, ==, 100.0);
    scan_free(s);
}

typedef struct {
    uint8_t paper[4], leaf[4];
    uint32_t channels;
    Channel best;
    bool dark;
} ColourCase;

/* A square leaf in the middle; colours get some noise, so that channels differ in how well they part them. */
static void test_channels(void)
{
    static const ColourCase cases[] = {
        {{250, 120, 250, 255}, {40, 118, 248, 255}, 3, CHANNEL_RED, true},
        {{90, 30, 90, 255}, {92, 230, 88, 255}, 3, CHANNEL_GREEN, false},
        {{200, 200, 60, 255}, {202, 199, 220, 255}, 3, CHANNEL_BLUE, false},
        {{130, 128, 130, 255}, {132, 120, 70, 255}, 3, CHANNEL_BLUE, true},
        {{10, 20, 30, 0}, {12, 22, 28, 255}, 4, CHANNEL_ALPHA, false},
        {{0, 0, 0, 0}, {240, 240, 240, 255}, 4, CHANNEL_ALPHA, false},
    };
    for (uint32_t k = 0; k < G_N_ELEMENTS(cases); k++) {
        const ColourCase *c = &cases[k];
        Scan *s = scan_new(40, 40, c->channels, 8);
        for (uint32_t i = 0; i < 1600; i++) {
            bool leaf = i % 40 > 9 && i % 40 < 30 && i / 40 > 9 && i / 40 < 30;
            for (uint32_t n = 0; n < c->channels; n++)
                ((uint8_t *)s->px)[i * c->channels + n] =
                    (uint8_t)MIN(255, (leaf ? c->leaf[n] : c->paper[n]) + (n < 3 ? noise(80 + k, 4 * i + n, 6) : 0));
        }
        ThresholdDef def = {CHANNEL_BEST, LEAF_BY_FRAME, -1.0};
        Threshold t;
        g_assert_true(threshold_find(s, &def, &t, NULL));
        g_assert_cmpstr(channel_name(t.channel), ==, channel_name(c->best));
        g_assert_cmpint(t.dark, ==, c->dark);
        g_assert_cmpfloat(t.frame, ==, 1.0);
        uint8_t mask[1600];
        threshold_apply(s, &t, mask);
        uint32_t area = 0;
        for (uint32_t i = 0; i < 1600; i++) {
            area += mask[i];
            g_assert_cmpint(mask[i], ==, (channel_value(s, t.channel, i % 40, i / 40) < t.level) == t.dark);
        }
        g_assert_cmpuint(area, ==, 400);
        def.side = c->dark ? LEAF_LIGHT : LEAF_DARK;
        g_assert_true(threshold_find(s, &def, &t, NULL));
        g_assert_cmpint(t.dark, !=, c->dark);
        scan_free(s);
    }
}

/* The definitions, by hand. */
static void test_channel_values(void)
{
    Scan *s = scan_new(1, 1, 4, 8);
    uint8_t *px = s->px;
    px[0] = 200, px[1] = 100, px[2] = 50, px[3] = 255;
    g_assert_cmpuint(channel_value(s, CHANNEL_RED, 0, 0), ==, 200);
    g_assert_cmpuint(channel_value(s, CHANNEL_GREEN, 0, 0), ==, 100);
    g_assert_cmpuint(channel_value(s, CHANNEL_BLUE, 0, 0), ==, 50);
    g_assert_cmpuint(channel_value(s, CHANNEL_GREY, 0, 0), ==, 124); /* 124.2 */
    g_assert_cmpuint(channel_value(s, CHANNEL_SATURATION, 0, 0), ==, 191); /* 3/4 of 255 */
    g_assert_cmpuint(channel_value(s, CHANNEL_GREENNESS, 0, 0), ==, 115); /* (510 - 50) / 4 */
    px[3] = 51; /* a fifth of it on white */
    g_assert_cmpuint(channel_value(s, CHANNEL_RED, 0, 0), ==, 244);
    g_assert_cmpuint(channel_value(s, CHANNEL_BLUE, 0, 0), ==, 214);
    g_assert_cmpuint(channel_value(s, CHANNEL_ALPHA, 0, 0), ==, 51);
    px[0] = px[1] = px[2] = 0, px[3] = 255;
    g_assert_cmpuint(channel_value(s, CHANNEL_SATURATION, 0, 0), ==, 0);
    scan_free(s);
}

/* On paper half in shadow a leaf is told by its colour, not by its shade. */
static void test_saturation(void)
{
    Scan *s = scan_new(60, 60, 3, 8);
    for (uint32_t i = 0; i < 3600; i++) {
        bool leaf = i % 60 > 19 && i % 60 < 40 && i / 60 > 19 && i / 60 < 40, shadow = i % 60 < 30;
        for (uint32_t c = 0; c < 3; c++) {
            uint32_t colour = leaf ? (c == 1 ? 140 : 55) : 230;
            ((uint8_t *)s->px)[3 * i + c] = (uint8_t)((shadow ? colour * 2 / 5 : colour) + noise(89, 3 * i + c, 4));
        }
    }
    ThresholdDef def = {CHANNEL_BEST, LEAF_BY_FRAME, -1.0};
    Threshold t;
    g_assert_true(threshold_find(s, &def, &t, NULL));
    g_assert_cmpstr(channel_name(t.channel), ==, "saturation");
    g_assert_false(t.dark);
    scan_free(s);
}

/* A green disc, on a round plate where `plate`, on a ground of one more colour. */
static Scan *green_disc(bool plate, const uint8_t ground[3], uint32_t unrest)
{
    Scan *s = scan_new(120, 120, 3, 8);
    for (uint32_t i = 0; i < 120 * 120; i++) {
        double x = i % 120 - 59.5, y = i / 120 - 59.5;
        bool leaf = x * x + y * y < 30.0 * 30.0, sheet = plate && x * x + y * y < 56.0 * 56.0;
        const uint8_t green[2][3] = {{60, 95, 45}, {120, 150, 100}}, white[3] = {245, 245, 240};
        const uint8_t *colour = leaf ? green[x > 0.0] : sheet ? white : ground;
        double off = leaf || sheet ? 0.0 : noise(97, i, unrest);
        for (uint32_t c = 0; c < 3; c++)
            ((uint8_t *)s->px)[3 * i + c] = (uint8_t)CLAMP(colour[c] + off, 0.0, 255.0);
    }
    return s;
}

/* Otsu's separability alone takes what the leaf lies on for it on a dark ground, unless that is a sheet (test_threshold.c), and of a leaf on wood the darker half. */
static void test_greenness(void)
{
    const double disc = 30.0 * 30.0 * G_PI / (120.0 * 120.0);
    ThresholdDef def = {CHANNEL_BEST, LEAF_BY_FRAME, -1.0};
    Threshold t;
    Scan *wood = green_disc(false, (const uint8_t[]){150, 120, 90}, 12), *dark = green_disc(true, (const uint8_t[]){10, 10, 10}, 4);
    g_assert_true(threshold_find(wood, &def, &t, NULL));
    g_assert_cmpstr(channel_name(t.channel), ==, "greenness");
    g_assert_cmpfloat(fabs(t.leaf - disc), <, 0.02 * disc);
    g_assert_true(threshold_find(dark, &def, &t, NULL));
    g_test_message("%s: leaf %g, green %g of %g", channel_name(t.channel), t.leaf, t.green, disc);
    g_assert_cmpfloat(t.leaf, >, 1.5 * disc);
    g_assert_cmpfloat(fabs(t.green - disc), <, 0.02 * disc);
    def.channel = CHANNEL_BLUE; /* who asks for a channel gets it */
    g_assert_true(threshold_find(wood, &def, &t, NULL));
    g_assert_true(t.channel == CHANNEL_BLUE && t.green == 0.0);
    scan_free(wood);
    scan_free(dark);
}

static void threshold_fails(const Scan *s, ThresholdDef def, int code, const char *says)
{
    GError *error = NULL;
    Threshold t;
    g_assert_false(threshold_find(s, &def, &t, &error));
    g_assert_error(error, SCAN_ERROR, code);
    if (!strstr(error->message, says))
        g_error("'%s' is not in '%s'", says, error->message);
    g_error_free(error);
}

static void test_threshold_refused(void)
{
    Scan *s = grey(12, 9, 8);
    for (int value = 0; value <= 255; value += 255) {
        memset(s->px, value, 12 * 9);
        threshold_fails(s, (ThresholdDef){CHANNEL_BEST, LEAF_BY_FRAME, -1.0}, SCAN_ERROR_NO_LEAF, "all of one shade");
    }
    for (uint32_t i = 0; i < 12 * 9; i++)
        ((uint8_t *)s->px)[i] = (uint8_t)(240 + noise(90, i, 5));
    threshold_fails(s, (ThresholdDef){CHANNEL_BEST, LEAF_BY_FRAME, -1.0}, SCAN_ERROR_NO_LEAF, "all of one shade");
    threshold_fails(s, (ThresholdDef){CHANNEL_RED, LEAF_BY_FRAME, -1.0}, SCAN_ERROR_VALUE, "channel 'red': the image has none; it is grey");
    threshold_fails(s, (ThresholdDef){CHANNEL_ALPHA, LEAF_BY_FRAME, -1.0}, SCAN_ERROR_VALUE, "without alpha");
    threshold_fails(s, (ThresholdDef){CHANNEL_GREY, LEAF_BY_FRAME, 256.0}, SCAN_ERROR_VALUE, "threshold 256");
    threshold_fails(s, (ThresholdDef){CHANNEL_GREY, LEAF_BY_FRAME, (double)NAN}, SCAN_ERROR_VALUE, "threshold nan");
    scan_free(s);
    s = grey(1, 1, 16);
    threshold_fails(s, (ThresholdDef){CHANNEL_BEST, LEAF_BY_FRAME, -1.0}, SCAN_ERROR_NO_LEAF, "all of one shade");
    scan_free(s);
    scan_free(NULL);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    dir = g_dir_make_tmp("venation-scan-XXXXXX", NULL);
    g_assert_nonnull(dir);
    path = g_build_filename(dir, "scan", NULL);
    g_test_add_func("/scan/png", test_png);
    g_test_add_func("/scan/png-aspect", test_png_aspect);
    g_test_add_func("/scan/png_exif", test_png_exif);
    g_test_add_func("/scan/jpeg", test_jpeg);
    g_test_add_func("/scan/jpeg_exif", test_jpeg_exif);
    g_test_add_func("/scan/exif_noise", test_exif_noise);
    g_test_add_func("/scan/tiff_plain", test_tiff_plain);
    g_test_add_func("/scan/tiff_converted", test_tiff_converted);
    g_test_add_func("/scan/tiff_orientation", test_tiff_orientation);
    g_test_add_func("/scan/tiff_jpeg", test_tiff_jpeg);
    g_test_add_func("/scan/tiff_refused", test_tiff_refused);
    g_test_add_func("/scan/truncated", test_truncated);
    g_test_add_func("/scan/corrupted", test_corrupted);
    g_test_add_func("/scan/not_images", test_not_images);
    g_test_add_func("/scan/size_limit", test_size_limit);
    g_test_add_func("/threshold/otsu", test_otsu);
    g_test_add_func("/threshold/otsu_gap", test_otsu_gap);
    g_test_add_func("/threshold/channels", test_channels);
    g_test_add_func("/threshold/channel_values", test_channel_values);
    g_test_add_func("/threshold/saturation", test_saturation);
    g_test_add_func("/threshold/greenness", test_greenness);
    g_test_add_func("/threshold/refused", test_threshold_refused);
    int status = g_test_run();
    g_unlink(path);
    g_rmdir(dir);
    g_free(path);
    g_free(dir);
    return status;
}
