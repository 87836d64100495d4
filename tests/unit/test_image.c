/* Image files: what is written reads back, metadata and all; failures leave nothing. */
#include <glib/gstdio.h>
#include <math.h>
#include <openexr.h>
#include <png.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <zlib.h>

#include "geom/dmath.h"
#include "geom/parallel.h"
#include "geom/random.h"
#include "image/blur.h"
#include "image/deflate.h"
#include "image/encode.h"
#include "image/file.h"

static char *dir;

static char *file(const char *name)
{
    return g_build_filename(dir, name, NULL);
}

static guint files_in_dir(void)
{
    guint n = 0;
    GDir *d = g_dir_open(dir, 0, NULL);
    while (g_dir_read_name(d) != NULL)
        n++;
    g_dir_close(d);
    return n;
}

static Plane *noise_plane(uint32_t w, uint32_t h, uint32_t c, PlaneKind kind)
{
    Plane *p = plane_new(w, h, c, kind);
    for (gsize i = 0; i < (gsize)w * h * c; i++) {
        double v[2];
        random_pair(7, 0, 0, i, v);
        p->px[i] = (float)(kind == PLANE_LABEL ? floor(v[0] * 200.0) : v[0]);
    }
    return p;
}

typedef struct {
    uint32_t width, height, channels;
    int depth;
    uint16_t *level; /* [height][width][channels] */
    gboolean srgb;
    GHashTable *text;
} Picture;

static Picture read_png(const char *path)
{
    Picture r = {0};
    FILE *f = fopen(path, "rb");
    g_assert_nonnull(f);
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    if (setjmp(png_jmpbuf(png)))
        g_error("libpng can't read %s", path);
    png_init_io(png, f);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, NULL);
    r.width = png_get_image_width(png, info);
    r.height = png_get_image_height(png, info);
    r.channels = png_get_channels(png, info);
    r.depth = png_get_bit_depth(png, info);
    r.srgb = png_get_valid(png, info, PNG_INFO_sRGB) != 0;
    gsize row = (gsize)r.width * r.channels;
    r.level = g_new(uint16_t, row * r.height);
    png_bytepp rows = png_get_rows(png, info);
    for (uint32_t y = 0; y < r.height; y++)
        for (gsize i = 0; i < row; i++)
            r.level[y * row + i] = r.depth == 16 ? (uint16_t)(rows[y][2 * i] << 8 | rows[y][2 * i + 1]) : rows[y][i];
    r.text = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
    png_textp text;
    int n = png_get_text(png, info, &text, NULL);
    for (int i = 0; i < n; i++)
        g_hash_table_insert(r.text, g_strdup(text[i].key), g_strdup(text[i].text));
    png_destroy_read_struct(&png, &info, NULL);
    fclose(f);
    return r;
}

static void picture_clear(Picture *p)
{
    g_free(p->level);
    g_hash_table_unref(p->text);
}

static void test_png_data(void)
{
    for (int depth = 8; depth <= 16; depth += 8)
        for (uint32_t c = 1; c <= 4; c++) {
            Plane *p = noise_plane(37, 23, c, PLANE_DATA);
            p->low = -0.25;
            p->high = 0.75;
            char *path = file("data.png");
            GError *error = NULL;
            g_assert_true(image_write_png(p, path, depth, NULL, &error));
            g_assert_no_error(error);
            Picture r = read_png(path);
            g_assert_cmpuint(r.width, ==, 37);
            g_assert_cmpuint(r.height, ==, 23);
            g_assert_cmpuint(r.channels, ==, c);
            g_assert_cmpint(r.depth, ==, depth);
            g_assert_false(r.srgb);
            double top = depth == 16 ? 65535.0 : 255.0;
            for (gsize i = 0; i < (gsize)37 * 23 * c; i++) {
                double want = fmin(1.0, (double)p->px[i] + 0.25);
                g_assert_cmpfloat(fabs(r.level[i] / top - want), <=, 0.5001 / top);
            }
            g_assert_cmpstr(g_hash_table_lookup(r.text, "low"), ==, "-0.25");
            g_assert_cmpstr(g_hash_table_lookup(r.text, "high"), ==, "0.75");
            picture_clear(&r);
            g_remove(path);
            g_free(path);
            plane_free(p);
        }
}

/* The curve against the standard's formula, at every 8 bit level and all over 16 bits. */
static void test_png_colour(void)
{
    for (int depth = 8; depth <= 16; depth += 8) {
        Plane *p = noise_plane(256, 64, 3, PLANE_COLOUR);
        for (int i = 0; i < 256; i++) {
            double s = i / 255.0;
            p->px[3 * i] = (float)(s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4));
        }
        p->px[3] = -1.0f;
        p->px[4] = 7.0f;
        p->px[5] = NAN;
        char *path = file("colour.png");
        g_assert_true(image_write_png(p, path, depth, NULL, NULL));
        Picture r = read_png(path);
        g_assert_true(r.srgb);
        double top = depth == 16 ? 65535.0 : 255.0;
        for (int i = 2; i < 256; i++)
            g_assert_cmpint(r.level[3 * i], ==, i * (depth == 16 ? 257 : 1));
        for (gsize i = 6; i < (gsize)256 * 64 * 3; i++) {
            double x = (double)p->px[i], s = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
            g_assert_cmpfloat(fabs(r.level[i] - s * top), <=, 0.64);
        }
        g_assert_cmpint(r.level[3], ==, 0);
        g_assert_cmpint(r.level[4], ==, (int)top);
        g_assert_cmpint(r.level[5], ==, 0);
        picture_clear(&r);
        g_remove(path);
        g_free(path);
        plane_free(p);
    }
}

/* Levels of 8 bits, which come from a table where they can, are those of 16 bits, rounded anew where these leave no doubt. */
static void test_colour_levels(void)
{
    enum { N = 1 << 18, EXTRA = 6 };
    static const float extra[EXTRA] = {-0.5f, 1.0f, 1.5f, 1e-30f, 0.99999994f, NAN};
    Plane *p = plane_new(N + EXTRA, 1, 1, PLANE_COLOUR);
    for (uint32_t i = 0; i < N; i++)
        p->px[i] = (float)i / N;
    memcpy(p->px + N, extra, sizeof extra);
    uint8_t *few = g_malloc(N + EXTRA), *many = g_malloc(2 * (N + EXTRA));
    Encoder e;
    encoder_init(&e, p, 8);
    g_assert_nonnull(e.quick);
    encoder_row(&e, p, 0, few);
    encoder_clear(&e);
    encoder_init(&e, p, 16);
    encoder_row(&e, p, 0, many);
    encoder_clear(&e);
    for (uint32_t i = 0; i < N + EXTRA; i++)
        g_assert_cmpfloat(fabs(few[i] * 257.0 - (many[2 * i] << 8 | many[2 * i + 1])), <=, 129.0);
    g_free(few);
    g_free(many);
    plane_free(p);
}

static void test_png_labels(void)
{
    static const float top[] = {255.0f, 256.0f, 65535.0f, 65536.0f, 1234567.0f};
    static const int depth[] = {8, 16, 16, 8, 8};
    for (int k = 0; k < 5; k++) {
        Plane *p = noise_plane(16, 16, 1, PLANE_LABEL);
        p->px[17] = top[k];
        p->high = (double)top[k];
        char *path = file("label.png");
        g_assert_true(image_write_png(p, path, 8, NULL, NULL));
        Picture r = read_png(path);
        g_assert_cmpint(r.depth, ==, depth[k]);
        for (int i = 0; i < 256; i++) {
            const uint16_t *l = r.level + i * (int)r.channels;
            unsigned v = r.channels == 3 ? l[0] * 65536u + l[1] * 256u + l[2] : l[0];
            g_assert_cmpuint(v, ==, (unsigned)p->px[i]);
        }
        g_assert_cmpint(r.channels, ==, k < 3 ? 1 : 3);
        g_assert_cmpint(g_hash_table_contains(r.text, "label_encoding"), ==, k >= 3);
        picture_clear(&r);
        g_remove(path);
        g_free(path);
        plane_free(p);
    }
}

static void test_png_texts(void)
{
    char *large = g_strnfill(5000, 'x'), *large8 = g_strdup_printf("%sé", large);
    const char *key[] = {"seed", "leaf.title", "long", "long8", " a  b\n"};
    const char *value[] = {"42", "Tilia × europaea, limettier ‘Käfer’", large, large8, ""};
    Metadata meta = {5, key, value};
    Plane *p = noise_plane(8, 8, 1, PLANE_DATA);
    p->unit = "segments";
    char *path = file("text.png");
    g_assert_true(image_write_png(p, path, 8, &meta, NULL));
    Picture r = read_png(path);
    for (int i = 0; i < 4; i++)
        g_assert_cmpstr(g_hash_table_lookup(r.text, key[i]), ==, value[i]);
    g_assert_true(g_hash_table_contains(r.text, "a b"));
    g_assert_cmpstr(g_hash_table_lookup(r.text, "unit"), ==, "segments");
    picture_clear(&r);
    GStatBuf st;
    g_assert_cmpint(g_stat(path, &st), ==, 0);
    g_assert_cmpint(st.st_size, <, 3000); /* the long ones are compressed */
    g_remove(path);
    g_free(path);
    g_free(large);
    g_free(large8);
    plane_free(p);
}

/* Half to float by the definition of binary16. */
static double half_value(uint16_t h)
{
    int e = h >> 10 & 31, m = h & 1023;
    double v = e == 31 ? (m != 0 ? (double)NAN : HUGE_VAL) : e == 0 ? ldexp(m, -24) : ldexp(1024 + m, e - 25);
    return h & 0x8000 ? -v : v;
}

static void test_half(void)
{
    for (int h = 0; h < 65536; h++) { /* every half is itself */
        double v = half_value((uint16_t)h);
        if (v == v)
            g_assert_cmpint(encode_half((float)v), ==, h);
    }
    for (int h = 0; h < 0x7BFF; h++) { /* between neighbours: the nearer, halfway the even one */
        double a = half_value((uint16_t)h), b = half_value((uint16_t)(h + 1)), mid = 0.5 * (a + b);
        g_assert_cmpint(encode_half((float)mid), ==, h & 1 ? h + 1 : h);
        g_assert_cmpint(encode_half(nextafterf((float)mid, 0.0f)), ==, h);
        g_assert_cmpint(encode_half(-nextafterf((float)mid, 1e9f)), ==, (h + 1) | 0x8000);
    }
    g_assert_cmpint(encode_half(65519.0f), ==, 0x7BFF);
    g_assert_cmpint(encode_half(65520.0f), ==, 0x7C00);
    g_assert_cmpint(encode_half(NAN) & 0x7C00, ==, 0x7C00);
    g_assert_cmpint(encode_half(NAN) & 0x3FF, !=, 0);
    float in[1000];
    uint16_t out[1001];
    for (uint32_t n = 0; n < 1000; n += n < 20 ? 1 : 97) { /* rows of them, with stretches of one value */
        for (uint32_t i = 0; i < n; i++) {
            double v[2];
            random_pair(5, 0, n, i, v);
            in[i] = i / 200 % 2 ? -0.3f : (float)ldexp(v[0] - 0.5, (int)(v[1] * 60.0) - 30);
        }
        out[n] = 4711;
        encode_halves(in, n, out);
        for (uint32_t i = 0; i < n; i++)
            g_assert_cmpint(out[i], ==, encode_half(in[i]));
        g_assert_cmpint(out[n], ==, 4711);
    }
}

/* Reads one channel of an EXR file as floats. */
static float *read_exr(const char *path, const char *channel, uint32_t w, uint32_t h, const char *key, char **value)
{
    exr_context_t c;
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    g_assert_cmpint(exr_start_read(&c, path, &init), ==, EXR_ERR_SUCCESS);
    exr_attr_box2i_t window;
    g_assert_cmpint(exr_get_data_window(c, 0, &window), ==, EXR_ERR_SUCCESS);
    g_assert_cmpint(window.max.x - window.min.x + 1, ==, (int)w);
    g_assert_cmpint(window.max.y - window.min.y + 1, ==, (int)h);
    if (key != NULL) {
        const char *text = NULL;
        int32_t length = 0;
        g_assert_cmpint(exr_attr_get_string(c, 0, key, &length, &text), ==, EXR_ERR_SUCCESS);
        *value = g_strndup(text, (gsize)length);
    }
    int32_t lines;
    exr_get_scanlines_per_chunk(c, 0, &lines);
    float *out = g_new(float, (gsize)w *h), *other = g_new(float, (gsize)w *(gsize)lines);
    for (int32_t y = 0; y < (int32_t)h; y += lines) {
        exr_chunk_info_t info;
        exr_decode_pipeline_t pipe = EXR_DECODE_PIPELINE_INITIALIZER;
        g_assert_cmpint(exr_read_scanline_chunk_info(c, 0, y, &info), ==, EXR_ERR_SUCCESS);
        g_assert_cmpint(exr_decoding_initialize(c, 0, &info, &pipe), ==, EXR_ERR_SUCCESS);
        for (int i = 0; i < pipe.channel_count; i++) {
            exr_coding_channel_info_t *ch = &pipe.channels[i];
            gboolean wanted = strcmp(ch->channel_name, channel) == 0;
            ch->decode_to_ptr = (uint8_t *)(wanted ? out + (gsize)y * w : other);
            ch->user_bytes_per_element = 4;
            ch->user_data_type = EXR_PIXEL_FLOAT;
            ch->user_pixel_stride = 4;
            ch->user_line_stride = (int32_t)(4 * w);
        }
        g_assert_cmpint(exr_decoding_choose_default_routines(c, 0, &pipe), ==, EXR_ERR_SUCCESS);
        g_assert_cmpint(exr_decoding_run(c, 0, &pipe), ==, EXR_ERR_SUCCESS);
        exr_decoding_destroy(c, &pipe);
    }
    exr_finish(&c);
    g_free(other);
    return out;
}

static void test_exr(void)
{
    static const char *const names[4][4] = {{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
    const char *key[] = {"sources.birth_distance_of_all_the_sources", "name", "leaf title"};
    const char *value[] = {"2.5", "x", "Tilia × europaea"};
    Metadata meta = {3, key, value};
    for (int half = 0; half <= 1; half++)
        for (uint32_t c = 1; c <= 4; c++) {
            uint32_t w = 61, h = 1100; /* more than one batch of chunks, the last one short */
            Plane *p = noise_plane(w, h, c, c == 3 ? PLANE_COLOUR : PLANE_DATA);
            char *path = file("x.exr");
            GError *error = NULL;
            gboolean ok = image_write_exr(p, path, half, &meta, &error);
            g_assert_no_error(error);
            g_assert_true(ok);
            for (uint32_t i = 0; i < c; i++) {
                char *text = NULL;
                static const char *const attr[] = {"sources.birth_distance_of_all_the_sources", "name_", "leaf_title",
                                                   "name_"};
                float *px = read_exr(path, names[c - 1][i], w, h, attr[i], &text);
                g_assert_cmpstr(text, ==, value[i % 3 == 0 && i > 0 ? 1 : i]);
                for (gsize k = 0; k < (gsize)w * h; k++) {
                    float want = p->px[k * c + i];
                    g_assert_cmpfloat(px[k], ==, half ? (float)half_value(encode_half(want)) : want);
                }
                g_free(text);
                g_free(px);
            }
            g_remove(path);
            g_free(path);
            plane_free(p);
        }
}

/* Labels keep their values whatever precision is asked for. */
static void test_exr_labels(void)
{
    Plane *p = noise_plane(9, 9, 1, PLANE_LABEL);
    p->px[5] = 1234567.0f;
    char *path = file("label.exr");
    g_assert_true(image_write_exr(p, path, TRUE, NULL, NULL));
    float *px = read_exr(path, "Y", 9, 9, NULL, NULL);
    g_assert_cmpmem(px, 81 * sizeof(float), p->px, 81 * sizeof(float));
    g_free(px);
    g_remove(path);
    g_free(path);
    plane_free(p);
}

static void test_same_bytes(void)
{
    Plane *p = noise_plane(123, 77, 3, PLANE_COLOUR);
    for (int kind = 0; kind < 2; kind++) {
        char *data[2];
        gsize n[2];
        for (int i = 0; i < 2; i++) {
            char *path = file("same");
            g_assert_true(kind ? image_write_png(p, path, 16, NULL, NULL) : image_write_exr(p, path, TRUE, NULL, NULL));
            g_assert_true(g_file_get_contents(path, &data[i], &n[i], NULL));
            g_remove(path);
            g_free(path);
        }
        g_assert_cmpuint(n[0], ==, n[1]);
        g_assert_true(memcmp(data[0], data[1], n[0]) == 0);
        g_free(data[0]);
        g_free(data[1]);
    }
    plane_free(p);
}

/* Bytes of several kinds: noise, one value, runs, text that repeats from afar. */
static void fill_bytes(uint8_t *out, uint32_t n, int kind)
{
    for (uint32_t i = 0; i < n; i++) {
        double v[2];
        random_pair(3, 0, (uint32_t)kind, i, v);
        out[i] = kind == 0 ? (uint8_t)(v[0] * 256.0) : kind == 1 ? 77 : kind == 2 ? (v[0] < 0.05 || i == 0 ? (uint8_t)(v[1] * 9.0) : out[i - 1])
                 : i >= 30000 ? out[i - 30000] : (uint8_t)(v[0] * 30.0);
    }
}

static void assert_inflates(const uint8_t *packed, gsize n_packed, const uint8_t *want, uint32_t n)
{
    uint8_t *got = g_malloc(n + 1);
    uLongf length = n + 1;
    g_assert_cmpint(uncompress(got, &length, packed, n_packed), ==, Z_OK);
    g_assert_cmpuint(length, ==, n);
    g_assert_true(memcmp(got, want, n) == 0);
    g_free(got);
}

/* What zlib makes of compressed bytes is what they were; noise is said not to fit. */
static void test_deflate(gconstpointer match)
{
    static const uint32_t size[] = {1, 2, 3, 31, 257, 258, 259, 1000, 32767, 32768, 32769, 65535, 65536, 70001, 400000, 1500000};
    enum { MOST = 1500000 };
    uint8_t *in = g_malloc(MOST), *out = g_malloc(2 * MOST);
    Deflate *d = deflate_new(GPOINTER_TO_INT(match));
    for (int kind = 0; kind < 4; kind++) {
        fill_bytes(in, MOST, kind);
        for (gsize i = 0; i < G_N_ELEMENTS(size); i++) {
            uint32_t n = size[i];
            gsize packed = deflate_whole(d, in, n, out, n + n / 8 + 100);
            assert_inflates(out, packed, in, n);
            gsize less = deflate_whole(d, in, n, out, n - 1);
            if (kind == 0 || n < 4)
                g_assert_cmpuint(less, ==, 0);
            else if (less > 0)
                assert_inflates(out, less, in, n);
            g_assert_true(n < 1000 || kind == 0 || less > 0);
        }
    }
    deflate_free(d);
    g_free(in);
    g_free(out);
}

/* The same given in pieces and taken in pieces, of all sizes. */
static void test_deflate_pieces(gconstpointer match)
{
    static const uint32_t given[] = {1, 100, 4097, 65536, 300000}, taken[] = {1, 7, 1000, 65536};
    enum { MOST = 300000 };
    uint8_t *in = g_malloc(MOST), *out = g_malloc(2 * MOST);
    Deflate *d = deflate_new(GPOINTER_TO_INT(match));
    for (int kind = 0; kind < 4; kind++)
        for (int g = 0; g < 5; g++)
            for (int t = 0; t < 4; t++) {
                uint32_t n = MIN(MOST, 3000 * given[g]);
                gsize packed = 0, got;
                fill_bytes(in, n, kind);
                deflate_begin(d);
                for (uint32_t at = 0; at <= n; at += given[g]) { /* the last piece is empty when pieces fit in */
                    uint32_t piece = MIN(given[g], n - at);
                    deflate_give(d, in + at, piece, at + piece == n && piece < given[g]);
                    do {
                        got = deflate_take(d, out + packed, taken[t]);
                        packed += got;
                        g_assert_cmpuint(packed, <=, 2 * MOST - 65536);
                    } while (got == taken[t]);
                }
                assert_inflates(out, packed, in, n);
            }
    deflate_free(d);
    g_free(in);
    g_free(out);
}

/* Matches of every length up to where a second one is needed and a third, and every distance about where symbols and the window change. */
static void test_deflate_matches(gconstpointer match)
{
    enum { MOST = 200000 };
    uint8_t *in = g_malloc(MOST), *out = g_malloc(2 * MOST);
    Deflate *d = deflate_new(GPOINTER_TO_INT(match));
    for (uint32_t at = 0, i = 0; at < MOST; i++) { /* runs of one byte, of all lengths, between which there is no pattern */
        uint32_t run = MIN(i % 800, MOST - at);
        memset(in + at, (int)(i * 2654435761u >> 24), run);
        at += run;
    }
    gsize packed = deflate_whole(d, in, MOST, out, 2 * MOST);
    assert_inflates(out, packed, in, MOST);
    for (uint32_t far = 1; far < 40000; far = far * 5 / 4 + 1)
        for (int off = -1; off <= 1; off++) {
            uint32_t distance = (uint32_t)MAX((int)(far > 32000 && far < 33000 ? 32768 : 1u << (31 - __builtin_clz(far))) + off, 1);
            fill_bytes(in, 2 * distance + 500, 0);
            memcpy(in + distance + 100, in + 100, MIN(distance, 400u));
            packed = deflate_whole(d, in, 2 * distance + 500, out, 2 * MOST);
            assert_inflates(out, packed, in, 2 * distance + 500);
        }
    deflate_free(d);
    g_free(in);
    g_free(out);
}

/* Files with many IDAT chunks, of noise, of one value, and of one and then the other. */
static void test_large(void)
{
    for (int kind = 0; kind < 3; kind++) {
        Plane *p = noise_plane(700, 333, 1, PLANE_DATA);
        for (gsize i = 0; kind > 0 && i < 700 * 333; i++)
            if (kind == 1 || i % 1000 < 500)
                p->px[i] = 0.25f;
        char *path = file("large");
        g_assert_true(image_write_png(p, path, 16, NULL, NULL));
        Picture r = read_png(path);
        for (gsize i = 0; i < 700 * 333; i++)
            g_assert_cmpfloat(fabs(r.level[i] / 65535.0 - (double)p->px[i]), <=, 0.5001 / 65535.0);
        picture_clear(&r);
        for (int half = 0; half < 2; half++) { /* noise doesn't compress: chunks stay as they are */
            g_assert_true(image_write_exr(p, path, half, NULL, NULL));
            float *px = read_exr(path, "Y", 700, 333, NULL, NULL);
            for (gsize i = 0; i < 700 * 333; i++)
                g_assert_cmpfloat(px[i], ==, half ? (float)half_value(encode_half(p->px[i])) : p->px[i]);
            g_free(px);
        }
        g_remove(path);
        g_free(path);
        plane_free(p);
    }
}

/* Part of a plane's rows as a plane, whose pixels are borrowed. */
static Plane rows_of(const Plane *p, uint32_t y0, uint32_t n)
{
    Plane part = *p;
    part.px = p->px + (gsize)y0 * p->width * p->channels;
    part.height = n;
    return part;
}

/* Files that are written band by band have the bytes of those written whole. */
static void test_banded(void)
{
    Plane *p = noise_plane(90, 203, 3, PLANE_COLOUR);
    for (int kind = 0; kind < 2; kind++)
        for (uint32_t band = 16; band < 203; band += 48) {
            char *data[2], *whole = file("whole"), *banded = file("banded");
            gsize n[2];
            g_assert_true(kind ? image_write_png(p, whole, 8, NULL, NULL) : image_write_exr(p, whole, TRUE, NULL, NULL));
            ImageFile *f = kind ? image_png_begin(banded, p, 203, 8, NULL, NULL) : image_exr_begin(banded, p, 203, TRUE, NULL, NULL, NULL);
            for (uint32_t y = 0; y < 203; y += band) {
                Plane part = rows_of(p, y, MIN(band, 203 - y));
                g_assert_true(image_file_rows(f, &part, NULL));
            }
            g_assert_true(image_file_end(f, NULL));
            g_assert_true(g_file_get_contents(whole, &data[0], &n[0], NULL) && g_file_get_contents(banded, &data[1], &n[1], NULL));
            g_assert_true(n[0] == n[1] && memcmp(data[0], data[1], n[0]) == 0);
            /* given up halfway, a file is as if it had never been begun */
            f = kind ? image_png_begin(banded, p, 203, 8, NULL, NULL) : image_exr_begin(banded, p, 203, TRUE, NULL, NULL, NULL);
            Plane part = rows_of(p, 0, band);
            g_assert_true(image_file_rows(f, &part, NULL));
            image_file_abort(f);
            g_assert_cmpuint(files_in_dir(), ==, 2);
            g_remove(whole);
            g_remove(banded);
            g_free(whole);
            g_free(banded);
            g_free(data[0]);
            g_free(data[1]);
        }
    image_file_abort(NULL);
    plane_free(p);
}

/* A folder that isn't there, and a disk that is full (a limit on file size stands for it). */
static void test_failures(void)
{
    Plane *p = noise_plane(300, 300, 3, PLANE_DATA);
    char *nowhere = file("none/x"), *kept = file("kept");
    for (int kind = 0; kind < 2; kind++) {
        GError *error = NULL;
        g_assert_false(kind ? image_write_png(p, nowhere, 8, NULL, &error)
                            : image_write_exr(p, nowhere, FALSE, NULL, &error));
        g_assert_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
        g_assert_nonnull(strstr(error->message, nowhere));
        g_clear_error(&error);

        g_assert_true(g_file_set_contents(kept, "old", 3, NULL));
        struct rlimit old, tiny;
        g_assert_cmpint(getrlimit(RLIMIT_FSIZE, &old), ==, 0);
        void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
        tiny = old;
        tiny.rlim_cur = 20000;
        g_assert_cmpint(setrlimit(RLIMIT_FSIZE, &tiny), ==, 0);
        gboolean ok = kind ? image_write_png(p, kept, 8, NULL, &error) : image_write_exr(p, kept, FALSE, NULL, &error);
        setrlimit(RLIMIT_FSIZE, &old);
        signal(SIGXFSZ, handler);
        g_assert_false(ok);
        g_assert_nonnull(error);
        g_assert_true(error->domain == G_FILE_ERROR);
        g_assert_nonnull(strstr(error->message, kept));
        g_clear_error(&error);
        char *text = NULL;
        g_assert_true(g_file_get_contents(kept, &text, NULL, NULL));
        g_assert_cmpstr(text, ==, "old");
        g_free(text);
        g_assert_cmpuint(files_in_dir(), ==, 1);
        g_remove(kept);
    }
    g_free(nowhere);
    g_free(kept);
    plane_free(p);
}

static void count_range(uint32_t first, uint32_t last, void *user)
{
    gint *hits = user;
    g_assert_cmpuint(first, <, last);
    for (uint32_t i = first; i < last; i++)
        g_atomic_int_inc(&hits[i]);
}

static void test_parallel(void)
{
    static const uint32_t n[] = {0, 1, 2, 99, 100, 101, 5000};
    for (int i = 0; i < 7; i++)
        for (unsigned threads = 0; threads < 9; threads += 4)
            for (uint32_t grain = 0; grain < 200; grain += 50) {
                gint *hits = g_new0(gint, n[i] + 1);
                parallel_for(threads, n[i], grain, count_range, hits);
                for (uint32_t k = 0; k < n[i]; k++)
                    g_assert_cmpint(hits[k], ==, 1);
                g_free(hits);
            }
}

/* ---- blurring ---- */

/* One box filter over n values `step` apart, by its definition. */
static void plain_box(int32_t *px, uint32_t n, gsize step, int64_t half)
{
    int32_t *out = g_new(int32_t, n);
    for (int64_t i = 0; i < n; i++) {
        int64_t sum = 0;
        for (int64_t k = MAX(i - half, 0); k <= MIN(i + half, (int64_t)n - 1); k++)
            sum += px[(gsize)k * step];
        out[i] = (int32_t)((double)sum * (1.0 / (2.0 * (double)half + 1.0)) + 0.5);
    }
    for (uint32_t i = 0; i < n; i++)
        px[i * step] = out[i];
    g_free(out);
}

static void test_blur(void)
{
    static const uint32_t size[][2] = {{1, 1}, {3, 40}, {17, 2}, {600, 33}, {257, 20}};
    Pool *pool = pool_new(2);
    for (gsize s = 0; s < G_N_ELEMENTS(size); s++)
        for (uint32_t half = 0; half < 24; half = half < 7 ? half + 1 : half + 16) {
            uint32_t w = size[s][0], h = size[s][1];
            int32_t *px = g_new(int32_t, w * h), *twin = g_new(int32_t, w * h);
            for (uint32_t i = 0; i < w * h; i++) {
                uint32_t chance = random_block(5, RANDOM_TEXTURE, half, i).w[0];
                px[i] = twin[i] = chance % 3 == 0 ? 1 << 30 : (int32_t)(chance >> 2);
            }
            image_blur(pool, px, w, h, half);
            for (uint32_t y = 0; half > 0 && y < h; y++)
                for (int k = 0; k < 2; k++)
                    plain_box(twin + (gsize)y * w, w, 1, half);
            for (uint32_t x = 0; half > 0 && x < w; x++)
                for (int k = 0; k < 2; k++)
                    plain_box(twin + x, h, w, half);
            g_assert_true(memcmp(px, twin, w * h * sizeof *px) == 0);
            g_free(px);
            g_free(twin);
        }
    pool_free(pool);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    dir = g_dir_make_tmp("venation-image-XXXXXX", NULL);
    g_test_add_func("/image/png/data", test_png_data);
    g_test_add_func("/image/png/colour", test_png_colour);
    g_test_add_func("/image/png/colour/levels", test_colour_levels);
    g_test_add_func("/image/png/labels", test_png_labels);
    g_test_add_func("/image/png/texts", test_png_texts);
    g_test_add_func("/image/half", test_half);
    g_test_add_func("/image/exr/pixels", test_exr);
    g_test_add_func("/image/exr/labels", test_exr_labels);
    g_test_add_data_func("/image/deflate/whole", GINT_TO_POINTER(DEFLATE_STRINGS), test_deflate);
    g_test_add_data_func("/image/deflate/whole/runs", GINT_TO_POINTER(DEFLATE_RUNS), test_deflate);
    g_test_add_data_func("/image/deflate/pieces", GINT_TO_POINTER(DEFLATE_STRINGS), test_deflate_pieces);
    g_test_add_data_func("/image/deflate/pieces/runs", GINT_TO_POINTER(DEFLATE_RUNS), test_deflate_pieces);
    g_test_add_data_func("/image/deflate/matches", GINT_TO_POINTER(DEFLATE_STRINGS), test_deflate_matches);
    g_test_add_data_func("/image/deflate/matches/runs", GINT_TO_POINTER(DEFLATE_RUNS), test_deflate_matches);
    g_test_add_func("/image/large", test_large);
    g_test_add_func("/image/same-bytes", test_same_bytes);
    g_test_add_func("/image/banded", test_banded);
    g_test_add_func("/image/failures", test_failures);
    g_test_add_func("/image/parallel", test_parallel);
    g_test_add_func("/image/blur", test_blur);
    int rc = g_test_run();
    g_rmdir(dir);
    g_free(dir);
    return rc;
}
