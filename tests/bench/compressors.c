#include "compressors.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <zlib.h>

#include "image/encode.h"
#include "image/paint.h"
#include "lib/settings.h"

enum { CHUNK = 16 }; /* rows of a ZIP chunk */
enum { NONE, SUB, UP, AVERAGE, PAETH };

struct Plain {
    PlainKind kind;
    int depth, filter;
    Encoder encoder;
    uint32_t width, step;        /* step: bytes of a pixel in the file */
    uint8_t *row[2];             /* unfiltered, the last one first */
    GByteArray *bytes, *packed;  /* of the band */
    gsize piece;                 /* bytes compressed on their own; 0: all of them go on with one stream */
    z_stream zlib;
};

Plain *plain_new(PlainKind kind, const Plane *like, int depth)
{
    Plain *f = g_new0(Plain, 1);
    gboolean half = like->kind != PLANE_LABEL;
    f->kind = kind;
    f->width = like->width;
    encoder_init(&f->encoder, like, depth);
    f->step = kind == PLAIN_PNG ? f->encoder.channels * (uint32_t)f->encoder.depth / 8 : like->channels * (half ? 2 : 4);
    f->filter = PAETH;
    f->piece = kind == PLAIN_EXR ? (gsize)f->width * f->step * CHUNK : 0;
    f->row[0] = g_malloc0((gsize)f->width * f->step);
    f->row[1] = g_malloc0((gsize)f->width * f->step);
    f->bytes = g_byte_array_new();
    f->packed = g_byte_array_new();
    gboolean strings = kind == PLAIN_EXR && !half && like->high > 255.0;
    if (deflateInit2(&f->zlib, 1, Z_DEFLATED, 15, 8, strings ? Z_DEFAULT_STRATEGY : Z_RLE) != Z_OK)
        g_error("zlib failed");
    return f;
}

void plain_free(Plain *f)
{
    deflateEnd(&f->zlib);
    encoder_clear(&f->encoder);
    g_free(f->row[0]);
    g_free(f->row[1]);
    g_byte_array_free(f->bytes, TRUE);
    g_byte_array_free(f->packed, TRUE);
    g_free(f);
}

static int paeth(int a, int b, int c)
{
    int p = a + b - c, pa = abs(p - a), pb = abs(p - b), pc = abs(p - c);
    return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

static void fill_png(Plain *f, const Plane *band)
{
    gsize n = (gsize)f->width * f->step;
    g_byte_array_set_size(f->bytes, (guint)(band->height * (n + 1)));
    uint8_t *out = f->bytes->data;
    for (uint32_t y = 0; y < band->height; y++) {
        uint8_t *up = f->row[0], *now = f->row[1];
        encoder_row(&f->encoder, band, y, now);
        *out++ = (uint8_t)f->filter;
        for (gsize i = 0; i < n; i++) {
            int a = i < f->step ? 0 : now[i - f->step], b = up[i], c = i < f->step ? 0 : up[i - f->step];
            int guess = f->filter == SUB ? a : f->filter == UP ? b : f->filter == AVERAGE ? (a + b) / 2 : f->filter == PAETH ? paeth(a, b, c) : 0;
            *out++ = (uint8_t)(now[i] - guess);
        }
        f->row[0] = now;
        f->row[1] = up;
    }
}

/* The chunk's even bytes before its odd ones, each less the one before. */
static void predict(const uint8_t *in, gsize n, uint8_t *out)
{
    for (gsize i = 0; i < n; i++)
        out[(i & 1) * (n / 2) + i / 2] = in[i];
    for (gsize i = n - 1; i > 0; i--)
        out[i] = (uint8_t)(out[i] - out[i - 1] + 128);
}

static void fill_exr(Plain *f, const Plane *band)
{
    uint32_t nc = band->channels, size = f->step / nc;
    gsize n = (gsize)f->width * f->step * band->height, at = 0;
    uint8_t *raw = g_malloc(n);
    for (uint32_t y = 0; y < band->height; y++)
        for (uint32_t c = nc; c-- > 0;)
            for (uint32_t x = 0; x < f->width; x++, at += size) {
                float v = band->px[((gsize)y * f->width + x) * nc + c];
                uint16_t h = encode_half(v);
                memcpy(raw + at, size == 2 ? (const void *)&h : &v, size);
            }
    g_byte_array_set_size(f->bytes, (guint)n);
    for (at = 0; at < n; at += f->piece)
        predict(raw + at, MIN(n - at, f->piece), f->bytes->data + at);
    g_free(raw);
}

void plain_fill(Plain *f, const Plane *band)
{
    if (f->kind == PLAIN_PNG)
        fill_png(f, band);
    else
        fill_exr(f, band);
    g_byte_array_set_size(f->packed, f->bytes->len + f->bytes->len / 8 + 65536);
}

gsize plain_compress(Plain *f)
{
    gsize n = f->bytes->len, sum = 0, piece = f->piece > 0 ? f->piece : n;
    for (gsize at = 0; at < n; at += piece) {
        if (f->piece > 0)
            deflateReset(&f->zlib);
        f->zlib.next_in = f->bytes->data + at;
        f->zlib.avail_in = (uInt)MIN(n - at, piece);
        f->zlib.next_out = f->packed->data;
        f->zlib.avail_out = f->packed->len;
        deflate(&f->zlib, f->piece > 0 ? Z_FINISH : Z_NO_FLUSH);
        sum += f->packed->len - f->zlib.avail_out;
    }
    return sum;
}

/* ---- other compressors ---- */

static double thread_time(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/* Settings of zlib and the filter of PNG rows. */
typedef struct {
    const char *name;
    int level, strategy, filter;
    double seconds[2];
    gsize bytes[2];
} Trial;

static gsize try_band(const Plain *f, z_stream *z)
{
    gsize n = f->bytes->len, sum = 0, piece = f->piece > 0 ? f->piece : n;
    for (gsize at = 0; at < n; at += piece) {
        if (f->piece > 0)
            deflateReset(z);
        z->next_in = f->bytes->data + at;
        z->avail_in = (uInt)MIN(n - at, piece);
        z->next_out = f->packed->data;
        z->avail_out = f->packed->len;
        deflate(z, f->piece > 0 ? Z_FINISH : Z_NO_FLUSH);
        gsize got = f->packed->len - z->avail_out;
        sum += f->piece > 0 ? MIN(got, MIN(n - at, piece)) : got;
    }
    return sum;
}

static void try_map(const Plane *plane, gboolean wide, gboolean exr, Trial *t)
{
    Plain *f = plain_new(exr ? PLAIN_EXR : PLAIN_PNG, plane, wide ? 16 : 8);
    z_stream z = {0};
    f->filter = t->filter;
    deflateInit2(&z, t->level, Z_DEFLATED, 15, 8, t->strategy);
    double seconds = 0.0;
    gsize bytes = 0;
    for (uint32_t y = 0; y < plane->height; y += 128) {
        Plane band = *plane;
        band.height = MIN(128u, plane->height - y);
        band.px = plane->px + (gsize)y * plane->width * plane->channels;
        plain_fill(f, &band);
        double begin = thread_time();
        bytes += try_band(f, &z);
        seconds += thread_time() - begin;
    }
    deflateEnd(&z);
    plain_free(f);
    printf(" %8.0f %6.2f", seconds * 1e3, (double)bytes * 1e-6);
    t->seconds[exr] += seconds;
    t->bytes[exr] += bytes;
}

void compare_compressors(const VenLeaf *leaf, uint32_t size)
{
    Trial trial[] = {{"runs", 1, Z_RLE, PAETH, {0}, {0}},          {"strings", 1, Z_DEFAULT_STRATEGY, PAETH, {0}, {0}},
                     {"level 4", 4, Z_DEFAULT_STRATEGY, PAETH, {0}, {0}}, {"runs, plain", 1, Z_RLE, NONE, {0}, {0}},
                     {"runs, Sub", 1, Z_RLE, SUB, {0}, {0}},       {"runs, Up", 1, Z_RLE, UP, {0}, {0}},
                     {"strings, plain", 1, Z_DEFAULT_STRATEGY, NONE, {0}, {0}}, {"strings, Up", 1, Z_DEFAULT_STRATEGY, UP, {0}, {0}}};
    Frame frame = frame_fit(leaf->net->margin->box, size, TRUE, 0.02);
    PaintStyle style = settings_style(leaf->params, leaf->seed, 1);
    Painter *painter = painter_new(leaf->net, &frame, &style);
    gboolean all[MAP_COUNT];
    for (int id = 0; id < MAP_COUNT; id++)
        all[id] = TRUE;
    painter_expect(painter, all);
    printf("\ncompressing maps of %u pixels, ms of processor time and MB\n%-22s", size, "");
    for (gsize i = 0; i < G_N_ELEMENTS(trial); i++)
        printf(" %15s", trial[i].name);
    puts("");
    for (int id = 0; id < MAP_COUNT; id++) {
        Plane *plane = painter_paint(painter, (MapId)id);
        gboolean wide = id == MAP_HEIGHT || id == MAP_THICKNESS || id == MAP_VEIN_WIDTH || id == MAP_DISTANCE || id == MAP_AGE || id == MAP_AREOLE;
        for (int exr = 0; exr < 2; exr++) {
            printf("%-18s %s", paint_map_info((MapId)id)->name, exr ? "exr" : "png");
            for (gsize i = 0; i < G_N_ELEMENTS(trial); i++)
                if (!exr || trial[i].filter == PAETH)
                    try_map(plane, wide, exr, &trial[i]);
            puts("");
        }
        plane_free(plane);
    }
    for (int exr = 0; exr < 2; exr++) {
        printf("%-18s %s", "together", exr ? "exr" : "png");
        for (gsize i = 0; i < G_N_ELEMENTS(trial); i++)
            if (!exr || trial[i].filter == PAETH)
                printf(" %8.0f %6.2f", trial[i].seconds[exr] * 1e3, (double)trial[i].bytes[exr] * 1e-6);
        puts("");
    }
    painter_free(painter);
}
