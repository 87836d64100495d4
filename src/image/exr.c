#include <errno.h>
#include <math.h>
#include <openexr.h>
#include <string.h>
#include <unistd.h>

#include "geom/wide.h"
#include "image/deflate.h"
#include "image/encode.h"
#include "image/file.h"
#include "image/staged.h"

enum { CHUNK_ROWS = IMAGE_BAND, BATCH = 64 }; /* rows of a ZIP chunk; chunks compressed at a time */
enum { GRAIN = 4 };                           /* chunks that a thread compresses in a row */

#define HALF_MOST 65504.0 /* the largest number of a half */

/* A chunk on its way into the file. */
typedef struct {
    uint16_t *raw;   /* its pixels in file precision: row by row, and a row channel by channel */
    uint8_t *packed; /* the same, compressed */
    gsize n_raw, n_packed; /* bytes; n_packed is 0 when compression gains nothing */
} Chunk;

typedef struct {
    ImageFile base;
    Plane like; /* the image: size, kind, range */
    Pool *pool;
    const Plane *band; /* being written, which begins at row `row` */
    uint32_t row;
    exr_context_t exr;
    int part;
    gboolean half;
    Staged file;
    int code; /* errno of a failed write */
    /* the batch being compressed */
    uint32_t first; /* chunk of the band */
    Chunk chunk[BATCH];
} Writer;

/* Says nothing: the result code tells the caller. The library may hold its lock here, so nothing of it can be asked. */
static void on_error(exr_const_context_t exr, exr_result_t code, const char *message)
{
    (void)exr;
    (void)code;
    (void)message;
}

static int64_t on_write(exr_const_context_t exr, void *user, const void *buffer, uint64_t size, uint64_t offset,
                        exr_stream_error_func_ptr_t fail)
{
    Writer *w = user;
    (void)exr;
    (void)fail; /* would take the lock that the library holds while it writes */
    const char *at = buffer;
    uint64_t left = size;
    while (left > 0) {
        ssize_t n = pwrite(fileno(w->file.file), at, left, (off_t)(offset + size - left));
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0) {
            w->code = n < 0 ? errno : ENOSPC;
            return -1;
        }
        at += n;
        left -= (uint64_t)n;
    }
    return (int64_t)size;
}

/* Attribute names keep letters, digits, '_', '.' and '-'; the names OpenEXR gives a meaning of its own get a '_'
 * behind. */
static char *attribute_name(const char *key)
{
    static const char *const taken[] = {"channels",
                                        "compression",
                                        "dataWindow",
                                        "displayWindow",
                                        "lineOrder",
                                        "pixelAspectRatio",
                                        "screenWindowCenter",
                                        "screenWindowWidth",
                                        "name",
                                        "type",
                                        "version",
                                        "chunkCount",
                                        "tiles",
                                        "view",
                                        "preview",
                                        "envmap",
                                        "timeCode",
                                        "keyCode",
                                        "chromaticities",
                                        "whiteLuminance",
                                        "adoptedNeutral",
                                        "xDensity",
                                        "longitude",
                                        "latitude",
                                        "altitude",
                                        "utcOffset",
                                        "focus",
                                        "expTime",
                                        "aperture",
                                        "isoSpeed",
                                        "framesPerSecond",
                                        "multiView",
                                        "worldToCamera",
                                        "worldToNDC",
                                        "deepImageState",
                                        "originalDataWindow",
                                        "dwaCompressionLevel",
                                        "maxSamplesPerPixel"};
    GString *s = g_string_new(NULL);
    for (const char *c = key; *c != '\0' && s->len < 250; c++)
        g_string_append_c(s, g_ascii_isalnum(*c) || strchr("_.-", *c) != NULL ? *c : '_');
    gboolean reserved = s->len == 0;
    for (gsize i = 0; i < G_N_ELEMENTS(taken); i++)
        reserved = reserved || strcmp(taken[i], s->str) == 0;
    if (reserved)
        g_string_append_c(s, '_');
    return g_string_free(s, FALSE);
}

/* Names above 31 bytes need a flag that some readers refuse. */
static int has_long_keys(const Metadata *meta)
{
    for (uint32_t i = 0; meta != NULL && i < meta->n; i++)
        if (strlen(meta->key[i]) >= 31)
            return 1;
    return 0;
}

static exr_result_t put_text(Writer *w, const char *key, const char *value)
{
    char *name = attribute_name(key), *text = g_utf8_make_valid(value, -1);
    exr_result_t r = exr_attr_set_string(w->exr, w->part, name, text);
    g_free(name);
    g_free(text);
    return r;
}

static exr_result_t put_number(Writer *w, const char *key, double value)
{
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    return put_text(w, key, g_ascii_formatd(text, sizeof text, "%.15g", value));
}

static exr_result_t put_metadata(Writer *w, const Metadata *meta)
{
    exr_result_t r = EXR_ERR_SUCCESS;
    if (w->like.kind == PLANE_DATA) {
        r = put_number(w, "low", w->like.low);
        if (r == EXR_ERR_SUCCESS)
            r = put_number(w, "high", w->like.high);
        if (r == EXR_ERR_SUCCESS)
            r = put_text(w, "unit", w->like.unit != NULL ? w->like.unit : "");
    }
    for (uint32_t i = 0; r == EXR_ERR_SUCCESS && meta != NULL && i < meta->n; i++)
        r = put_text(w, meta->key[i], meta->value[i]);
    return r;
}

/* Channels stand in a file in the order of their names: A B G R, A Y. */
static const char *channel_name(uint32_t channels, uint32_t i)
{
    static const char *const names[4][4] = {{"Y"}, {"A", "Y"}, {"B", "G", "R"}, {"A", "B", "G", "R"}};
    return names[channels - 1][i];
}

static exr_result_t put_header(Writer *w, const Metadata *meta)
{
    exr_pixel_type_t type = w->half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
    const Plane *p = &w->like;
    exr_result_t r = exr_set_longname_support(w->exr, has_long_keys(meta));
    if (r == EXR_ERR_SUCCESS)
        r = exr_add_part(w->exr, NULL, EXR_STORAGE_SCANLINE, &w->part);
    if (r == EXR_ERR_SUCCESS)
        r = exr_initialize_required_attr_simple(w->exr, w->part, (int32_t)p->width, (int32_t)p->height,
                                                EXR_COMPRESSION_ZIP);
    for (uint32_t c = 0; r == EXR_ERR_SUCCESS && c < p->channels; c++)
        r = exr_add_channel(w->exr, w->part, channel_name(p->channels, c), type, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    if (r == EXR_ERR_SUCCESS)
        r = put_metadata(w, meta);
    return r == EXR_ERR_SUCCESS ? exr_write_header(w->exr) : r;
}

/* Channels stand in the file in the reverse of the plane's order, each channel of a row on its own. `row` has room for a row. */
static void fill_raw(const Writer *w, uint32_t y0, uint32_t rows, uint16_t *out, uint16_t *row)
{
    const Plane *p = w->band;
    uint32_t n = p->width * p->channels, nc = p->channels;
    for (uint32_t y = y0; y < y0 + rows; y++) {
        const float *in = p->px + (gsize)y * n;
        if (!w->half) {
            for (uint32_t c = nc; c-- > 0;)
                for (uint32_t x = 0; x < p->width; x++, out += 2)
                    memcpy(out, in + (gsize)x * nc + c, sizeof(float));
            continue;
        }
        encode_halves(in, n, nc > 1 ? row : out);
        for (uint32_t c = nc; nc > 1 && c-- > 0;)
            for (uint32_t x = 0; x < p->width; x++)
                out[(nc - 1 - c) * p->width + x] = row[x * nc + c];
        out += n;
    }
}

/* As OpenEXR's ZIP has it: first all bytes of even places, then those of odd ones, each less the one before it. */
WIDE static void predict(const uint16_t *restrict in, gsize n, uint8_t *restrict out)
{
    uint8_t *restrict high = out + n;
    out[0] = (uint8_t)in[0];
    high[0] = (uint8_t)((in[0] >> 8) - in[n - 1] + 128);
    for (gsize i = 1; i < n; i++)
        out[i] = (uint8_t)(in[i] - in[i - 1] + 128);
    for (gsize i = 1; i < n; i++)
        high[i] = (uint8_t)((in[i] >> 8) - (in[i - 1] >> 8) + 128);
}

/* Numbers of veins, or of areoles, come back row after row. Measured on full sets of maps (tests/bench/bench_paint.c). */
static DeflateMatch choose_match(const Plane *p)
{
    return p->kind == PLANE_LABEL && p->high > 255.0 ? DEFLATE_STRINGS : DEFLATE_RUNS;
}

/* Compresses the chunks first … last-1 of the batch; they stay there until they are written in order. */
static void compress_range(uint32_t first, uint32_t last, void *user)
{
    Writer *w = user;
    const Plane *p = w->band;
    Deflate *d = deflate_new(choose_match(&w->like));
    uint8_t *predicted = g_malloc((gsize)p->width * p->channels * CHUNK_ROWS * (w->half ? 2 : 4));
    uint16_t *row = g_new(uint16_t, (gsize)p->width * p->channels);
    for (uint32_t i = first; i < last; i++) {
        Chunk *k = &w->chunk[i];
        uint32_t y0 = (w->first + i) * CHUNK_ROWS, rows = MIN((uint32_t)CHUNK_ROWS, p->height - y0);
        k->n_raw = (gsize)rows * p->width * p->channels * (w->half ? 2 : 4);
        fill_raw(w, y0, rows, k->raw, row);
        predict(k->raw, k->n_raw / 2, predicted);
        k->n_packed = deflate_whole(d, predicted, (uint32_t)k->n_raw, k->packed, (uint32_t)k->n_raw - 1);
    }
    g_free(predicted);
    g_free(row);
    deflate_free(d);
}

/* Row of the image that chunk i of the batch begins at. */
static int chunk_row(const Writer *w, uint32_t i)
{
    return (int)(w->row + (w->first + i) * CHUNK_ROWS);
}

static exr_result_t put_batch(Writer *w, uint32_t n)
{
    if (w->pool != NULL)
        pool_for(w->pool, n, GRAIN, compress_range, w);
    else
        compress_range(0, n, w);
    exr_result_t r = EXR_ERR_SUCCESS;
    for (uint32_t i = 0; i < n && r == EXR_ERR_SUCCESS; i++) {
        const Chunk *k = &w->chunk[i];
        r = exr_write_scanline_chunk(w->exr, w->part, chunk_row(w, i), k->n_packed > 0 ? k->packed : (const void *)k->raw,
                                     k->n_packed > 0 ? k->n_packed : k->n_raw);
    }
    return r;
}

static exr_result_t put_band(Writer *w)
{
    uint32_t chunks = (w->band->height + CHUNK_ROWS - 1) / CHUNK_ROWS, batch = MIN(chunks, (uint32_t)BATCH);
    gsize most = (gsize)w->band->width * w->band->channels * CHUNK_ROWS * (w->half ? 2 : 4);
    exr_result_t r = EXR_ERR_SUCCESS;
    for (uint32_t i = 0; i < batch; i++)
        w->chunk[i] = (Chunk){.raw = g_malloc(most), .packed = g_malloc(most)};
    for (w->first = 0; r == EXR_ERR_SUCCESS && w->first < chunks; w->first += BATCH)
        r = put_batch(w, MIN(chunks - w->first, (uint32_t)BATCH));
    for (uint32_t i = 0; i < batch; i++) {
        g_free(w->chunk[i].raw);
        g_free(w->chunk[i].packed);
    }
    w->row += w->band->height;
    return r;
}

static gboolean succeeded(const Writer *w, exr_result_t r, GError **error)
{
    if (w->code != 0 || r == EXR_ERR_OUT_OF_MEMORY)
        staged_error(w->file.path, w->code != 0 ? w->code : ENOMEM, error);
    else if (r != EXR_ERR_SUCCESS)
        g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_FAILED, "can't write %s: %s", w->file.path, exr_get_error_code_as_string(r));
    return r == EXR_ERR_SUCCESS && w->code == 0;
}

static gboolean write_rows(ImageFile *file, const Plane *band, GError **error)
{
    Writer *w = (Writer *)file;
    w->band = band;
    return succeeded(w, put_band(w), error);
}

static void write_abort(ImageFile *file)
{
    Writer *w = (Writer *)file;
    if (w->exr != NULL)
        exr_finish(&w->exr);
    staged_abort(&w->file);
    g_free(w);
}

static gboolean write_end(ImageFile *file, GError **error)
{
    Writer *w = (Writer *)file;
    if (!succeeded(w, exr_finish(&w->exr), error)) {
        w->exr = NULL;
        write_abort(file);
        return FALSE;
    }
    gboolean ok = staged_commit(&w->file, error);
    g_free(w);
    return ok;
}

ImageFile *image_exr_begin(const char *path, const Plane *like, uint32_t height, gboolean half, const Metadata *meta, Pool *pool,
                           GError **error)
{
    Writer *w = g_new0(Writer, 1);
    w->base = (ImageFile){write_rows, write_end, write_abort};
    w->like = *like;
    w->like.height = height;
    w->like.px = NULL;
    w->pool = pool;
    gboolean fits = fabs(like->low) <= HALF_MOST && fabs(like->high) <= HALF_MOST;
    w->half = half && fits && like->kind != PLANE_LABEL; /* half holds whole numbers up to 2048 only */
    if (!staged_open(&w->file, path, error)) {
        g_free(w);
        return NULL;
    }
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = on_error;
    init.user_data = w;
    init.write_fn = on_write;
    exr_result_t r = exr_start_write(&w->exr, path, EXR_WRITE_FILE_DIRECTLY, &init);
    if (r == EXR_ERR_SUCCESS)
        r = put_header(w, meta);
    if (succeeded(w, r, error))
        return &w->base;
    write_abort(&w->base);
    return NULL;
}
