/* PNG files: libpng writes the chunks; what goes into the IDAT ones is filtered here, by loops that vector instructions take in, and
 * compressed in steps of a band. */
#include <errno.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

#include "geom/wide.h"
#include "image/deflate.h"
#include "image/encode.h"
#include "image/file.h"
#include "image/staged.h"

enum { LONG_TEXT = 1024 };      /* bytes from which a text is compressed */
enum { IDAT_BYTES = 1 << 16 };  /* of an IDAT chunk */
enum { PAETH = 4 };             /* the filter of all rows (PNG specification, section 9) */
enum { MOST_STEP = 8 };         /* bytes of a pixel */

/* Everything libpng's error jump must leave behind whole. */
typedef struct {
    ImageFile base;
    png_structp png;
    png_infop info;
    Staged file;
    GByteArray *memory; /* written to instead of the file, when not NULL */
    Encoder encoder;
    GPtrArray *strings; /* keys and values of the text chunks */
    GArray *texts;      /* png_text */
    uint32_t row_bytes, step; /* bytes of a row and of a pixel */
    uint8_t *row, *above; /* without filter; MOST_STEP zeros lie before them */
    uint8_t *filtered;    /* IMAGE_BAND rows, each behind its filter's number */
    Deflate *deflate;
    uint8_t *idat; /* a chunk that is being filled */
    uint32_t n_idat;
    int code;      /* errno of a failed write or allocation */
    char *message; /* libpng's, of any other failure */
} Writer;

static void on_error(png_structp png, png_const_charp message)
{
    Writer *w = png_get_error_ptr(png);
    if (w->message == NULL)
        w->message = g_strdup(message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void *on_malloc(png_structp png, png_alloc_size_t n)
{
    Writer *w = png_get_mem_ptr(png);
    void *block = w->memory ? g_malloc(n) : g_try_malloc(n);
    if (block == NULL)
        w->code = ENOMEM;
    return block;
}

static void on_free(png_structp png, void *block)
{
    (void)png;
    g_free(block);
}

static void on_write(png_structp png, png_bytep data, png_size_t n)
{
    Writer *w = png_get_io_ptr(png);
    if (w->memory)
        g_byte_array_append(w->memory, data, (guint)n);
    else if (fwrite(data, 1, n, w->file.file) != n) {
        w->code = errno != 0 ? errno : EIO;
        png_error(png, "write failed");
    }
}

static void on_flush(png_structp png)
{
    (void)png;
}

/* A keyword is 1 … 79 printable Latin-1 characters without outer or double spaces; ours are plain ASCII. */
static char *keyword(const char *key)
{
    GString *s = g_string_new(NULL);
    for (const char *c = key; *c != '\0' && s->len < 79; c++) {
        char k = g_ascii_isgraph(*c) ? *c : ' ';
        if (k != ' ' || (s->len > 0 && s->str[s->len - 1] != ' '))
            g_string_append_c(s, k);
    }
    while (s->len > 0 && s->str[s->len - 1] == ' ')
        g_string_truncate(s, s->len - 1);
    if (s->len == 0)
        g_string_append_c(s, '_');
    return g_string_free(s, FALSE);
}

/* tEXt for short plain texts, zTXt for long ones, iTXt for texts beyond ASCII. */
static void add_text(Writer *w, const char *key, const char *value)
{
    char *k = keyword(key), *v = g_utf8_make_valid(value, -1);
    gboolean large = strlen(v) >= LONG_TEXT;
    png_text t = {0};
    t.key = k;
    t.text = v;
    if (g_str_is_ascii(v)) {
        t.compression = large ? PNG_TEXT_COMPRESSION_zTXt : PNG_TEXT_COMPRESSION_NONE;
        t.text_length = strlen(v);
    } else {
        t.compression = large ? PNG_ITXT_COMPRESSION_zTXt : PNG_ITXT_COMPRESSION_NONE;
        t.itxt_length = strlen(v);
    }
    g_ptr_array_add(w->strings, k);
    g_ptr_array_add(w->strings, v);
    g_array_append_val(w->texts, t);
}

static void add_number(Writer *w, const char *key, double value)
{
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    add_text(w, key, g_ascii_formatd(text, sizeof text, "%.15g", value));
}

static void collect_texts(Writer *w, const Plane *p, const Metadata *meta)
{
    if (p->kind == PLANE_DATA) {
        add_number(w, "low", p->low);
        add_number(w, "high", p->high);
        add_text(w, "unit", p->unit != NULL ? p->unit : "");
    }
    if (w->encoder.packed)
        add_text(w, "label_encoding", "R*65536+G*256+B");
    for (uint32_t i = 0; meta != NULL && i < meta->n; i++)
        add_text(w, meta->key[i], meta->value[i]);
}

static int colour_type(uint32_t channels)
{
    static const int type[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                               PNG_COLOR_TYPE_RGB_ALPHA};
    return type[channels - 1];
}

static gboolean emit_head(Writer *w, const Plane *p, uint32_t height)
{
    if (setjmp(png_jmpbuf(w->png)))
        return FALSE;
    png_set_write_fn(w->png, w, on_write, on_flush);
    png_set_user_limits(w->png, 0x7FFFFFFF, 0x7FFFFFFF);
    png_set_IHDR(w->png, w->info, p->width, height, w->encoder.depth, colour_type(w->encoder.channels), PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (p->kind == PLANE_COLOUR)
        png_set_sRGB_gAMA_and_cHRM(w->png, w->info, PNG_sRGB_INTENT_PERCEPTUAL);
    if (w->texts->len > 0)
        png_set_text(w->png, w->info, (png_textp)(void *)w->texts->data, (int)w->texts->len);
    png_write_info(w->png, w->info);
    return TRUE;
}

static void put_idat(Writer *w)
{
    png_write_chunk(w->png, (png_const_bytep)"IDAT", w->idat, w->n_idat);
    w->n_idat = 0;
}

/* Compresses n bytes; chunks are written as they fill up. */
static void put_bytes(Writer *w, const uint8_t *bytes, uint32_t n, gboolean last)
{
    deflate_give(w->deflate, bytes, n, last);
    for (;;) {
        w->n_idat += (uint32_t)deflate_take(w->deflate, w->idat + w->n_idat, IDAT_BYTES - w->n_idat);
        if (w->n_idat < IDAT_BYTES)
            return;
        put_idat(w);
    }
}

/* Takes from each byte that of the pixel on the left, above, or above on the left that is nearest to left + above - corner. Of all filters this one leaves
 * most to runs, also of labels (tests/bench/bench_paint.c, --compression). */
WIDE static void filter_paeth(const uint8_t *row, const uint8_t *above, uint32_t n, uint32_t step, uint8_t *restrict out)
{
    const uint8_t *left = row - step, *corner = above - step;
    for (uint32_t i = 0; i < n; i++) {
        int16_t a = left[i], b = above[i], c = corner[i], da = (int16_t)(b - c), db = (int16_t)(a - c), dc = (int16_t)(da + db);
        da = (int16_t)(da < 0 ? -da : da);
        db = (int16_t)(db < 0 ? -db : db);
        dc = (int16_t)(dc < 0 ? -dc : dc);
        int16_t other = db <= dc ? b : c, least = db <= dc ? db : dc;
        out[i] = (uint8_t)(row[i] - (da <= least ? a : other));
    }
}

static void filter_row(Writer *w, uint8_t *out)
{
    uint8_t *row = w->row, *above = w->above;
    *out++ = PAETH;
    filter_paeth(row, above, w->row_bytes, w->step, out);
    w->row = above;
    w->above = row;
}

static gboolean emit_rows(Writer *w, const Plane *p)
{
    if (setjmp(png_jmpbuf(w->png)))
        return FALSE;
    for (uint32_t y = 0; y < p->height; y += IMAGE_BAND) { /* by the same rows whatever the band, so that bytes are the same */
        uint32_t n = MIN(p->height - y, (uint32_t)IMAGE_BAND), bytes = w->row_bytes + 1;
        for (uint32_t i = 0; i < n; i++) {
            encoder_row(&w->encoder, p, y + i, w->row);
            filter_row(w, w->filtered + (gsize)i * bytes);
        }
        put_bytes(w, w->filtered, n * bytes, FALSE);
    }
    return TRUE;
}

static gboolean emit_end(Writer *w)
{
    if (setjmp(png_jmpbuf(w->png)))
        return FALSE;
    put_bytes(w, w->filtered, 0, TRUE);
    if (w->n_idat > 0)
        put_idat(w);
    png_write_chunk(w->png, (png_const_bytep)"IEND", NULL, 0); /* png_write_end misses IDAT chunks of its own */
    return TRUE;
}

static gboolean failed(const Writer *w, GError **error)
{
    if (w->code != 0)
        staged_error(w->file.path, w->code, error);
    else
        g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_FAILED, "can't write %s: %s", w->file.path,
                    w->message != NULL ? w->message : "libpng failed");
    return FALSE;
}

/* To the writer's file or memory, whichever is open. */
static gboolean begin(Writer *w, const Plane *like, uint32_t height, int depth, const Metadata *meta)
{
    encoder_init(&w->encoder, like, depth);
    w->strings = g_ptr_array_new_with_free_func(g_free);
    w->texts = g_array_new(FALSE, TRUE, sizeof(png_text));
    collect_texts(w, like, meta);
    w->step = w->encoder.channels * (uint32_t)(w->encoder.depth / 8);
    w->row_bytes = like->width * w->step;
    w->row = (uint8_t *)g_malloc0(MOST_STEP + (gsize)w->row_bytes) + MOST_STEP;
    w->above = (uint8_t *)g_malloc0(MOST_STEP + (gsize)w->row_bytes) + MOST_STEP;
    w->filtered = g_malloc(IMAGE_BAND * ((gsize)w->row_bytes + 1));
    w->idat = g_malloc(IDAT_BYTES);
    w->deflate = deflate_new(DEFLATE_RUNS);
    deflate_begin(w->deflate);
    w->png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, w, on_error, on_warning, w, on_malloc, on_free);
    if (w->png != NULL)
        w->info = png_create_info_struct(w->png);
    return w->info != NULL && emit_head(w, like, height);
}

static void writer_free(Writer *w)
{
    png_destroy_write_struct(&w->png, &w->info);
    encoder_clear(&w->encoder);
    g_array_free(w->texts, TRUE);
    g_ptr_array_free(w->strings, TRUE);
    g_free(w->row - MOST_STEP);
    g_free(w->above - MOST_STEP);
    g_free(w->filtered);
    g_free(w->idat);
    deflate_free(w->deflate);
    g_free(w->message);
    g_free(w);
}

static gboolean png_rows(ImageFile *file, const Plane *band, GError **error)
{
    Writer *w = (Writer *)file;
    return emit_rows(w, band) || failed(w, error);
}

static void png_abort(ImageFile *file)
{
    Writer *w = (Writer *)file;
    staged_abort(&w->file);
    writer_free(w);
}

static gboolean png_end(ImageFile *file, GError **error)
{
    Writer *w = (Writer *)file;
    gboolean ok = emit_end(w);
    if (!ok) {
        failed(w, error);
        png_abort(file);
        return FALSE;
    }
    ok = staged_commit(&w->file, error);
    writer_free(w);
    return ok;
}

ImageFile *image_png_begin(const char *path, const Plane *like, uint32_t height, int depth, const Metadata *meta, GError **error)
{
    Writer *w = g_new0(Writer, 1);
    w->base = (ImageFile){png_rows, png_end, png_abort};
    if (!staged_open(&w->file, path, error)) {
        g_free(w);
        return NULL;
    }
    if (begin(w, like, height, depth, meta))
        return &w->base;
    failed(w, error);
    png_abort(&w->base);
    return NULL;
}

GBytes *image_png_bytes(const Plane *p, int depth, const Metadata *meta)
{
    Writer *w = g_new0(Writer, 1);
    w->memory = g_byte_array_new();
    GByteArray *bytes = w->memory;
    if (!begin(w, p, p->height, depth, meta) || !emit_rows(w, p) || !emit_end(w))
        g_error("libpng refused an image: %s", w->message ? w->message : "no reason given"); /* there is no file that could fail */
    writer_free(w);
    return g_byte_array_free_to_bytes(bytes);
}
