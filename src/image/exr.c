#include <errno.h>
#include <openexr.h>
#include <string.h>
#include <unistd.h>

#include "geom/parallel.h"
#include "image/encode.h"
#include "image/file.h"
#include "image/staged.h"

enum { CHUNK_ROWS = 16, BATCH = 64 }; /* rows of a ZIP chunk; chunks compressed at a time */
enum { ZIP_LEVEL = 4 };               /* within some percent of the library's choice at a fraction of the time */

typedef struct {
    const Plane *plane;
    exr_context_t exr;
    int part;
    gboolean half;
    Staged file;
    int code; /* errno of a failed write */
    /* the batch being compressed */
    uint32_t first; /* chunk */
    exr_encode_pipeline_t pipe[BATCH];
    uint8_t *pixels[BATCH];
    exr_result_t result[BATCH];
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
    if (w->plane->kind == PLANE_DATA) {
        r = put_number(w, "low", w->plane->low);
        if (r == EXR_ERR_SUCCESS)
            r = put_number(w, "high", w->plane->high);
        if (r == EXR_ERR_SUCCESS)
            r = put_text(w, "unit", w->plane->unit != NULL ? w->plane->unit : "");
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
    const Plane *p = w->plane;
    exr_result_t r = exr_set_longname_support(w->exr, has_long_keys(meta));
    if (r == EXR_ERR_SUCCESS)
        r = exr_add_part(w->exr, NULL, EXR_STORAGE_SCANLINE, &w->part);
    if (r == EXR_ERR_SUCCESS)
        r = exr_initialize_required_attr_simple(w->exr, w->part, (int32_t)p->width, (int32_t)p->height,
                                                EXR_COMPRESSION_ZIP);
    if (r == EXR_ERR_SUCCESS)
        r = exr_set_zip_compression_level(w->exr, w->part, ZIP_LEVEL);
    for (uint32_t c = 0; r == EXR_ERR_SUCCESS && c < p->channels; c++)
        r = exr_add_channel(w->exr, w->part, channel_name(p->channels, c), type, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    if (r == EXR_ERR_SUCCESS)
        r = put_metadata(w, meta);
    return r == EXR_ERR_SUCCESS ? exr_write_header(w->exr) : r;
}

/* The rows of a chunk in file precision, interleaved in file order (which is that of the plane reversed). */
static void fill_pixels(const Writer *w, uint32_t y0, uint32_t rows, uint8_t *out)
{
    const Plane *p = w->plane;
    uint32_t nc = p->channels, size = w->half ? 2 : 4;
    const float *in = p->px + (gsize)y0 * p->width * nc;
    for (gsize i = 0; i < (gsize)rows * p->width; i++, in += nc)
        for (uint32_t c = 0; c < nc; c++, out += size) {
            float v = in[nc - 1 - c];
            if (w->half) {
                uint16_t h = encode_half(v);
                memcpy(out, &h, 2);
            } else {
                memcpy(out, &v, 4);
            }
        }
}

static exr_result_t keep_chunk(exr_encode_pipeline_t *pipe)
{
    (void)pipe;
    return EXR_ERR_SUCCESS;
}

/* Packs and compresses one chunk; it stays in its pipeline until the batch is written in order. */
static exr_result_t compress_chunk(Writer *w, uint32_t slot)
{
    const Plane *p = w->plane;
    uint32_t y0 = (w->first + slot) * CHUNK_ROWS, size = w->half ? 2 : 4;
    uint32_t rows = MIN((uint32_t)CHUNK_ROWS, p->height - y0);
    exr_encode_pipeline_t *pipe = &w->pipe[slot];
    fill_pixels(w, y0, rows, w->pixels[slot]);
    for (int c = 0; c < pipe->channel_count; c++) {
        exr_coding_channel_info_t *ch = &pipe->channels[c];
        ch->encode_from_ptr = w->pixels[slot] + (uint32_t)c * size;
        ch->user_pixel_stride = (int32_t)(p->channels * size);
        ch->user_line_stride = (int32_t)(p->width * p->channels * size);
        ch->user_bytes_per_element = (int16_t)size;
        ch->user_data_type = w->half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
    }
    exr_result_t r = exr_encoding_choose_default_routines(w->exr, w->part, pipe);
    pipe->yield_until_ready_fn = keep_chunk;
    pipe->write_fn = keep_chunk;
    return r == EXR_ERR_SUCCESS ? exr_encoding_run(w->exr, w->part, pipe) : r;
}

static void compress_range(uint32_t first, uint32_t last, void *user)
{
    Writer *w = user;
    for (uint32_t i = first; i < last; i++)
        w->result[i] = compress_chunk(w, i);
}

static exr_result_t put_batch(Writer *w, uint32_t n)
{
    exr_result_t r = EXR_ERR_SUCCESS;
    for (uint32_t i = 0; i < n; i++) {
        exr_chunk_info_t info;
        if (r == EXR_ERR_SUCCESS)
            r = exr_write_scanline_chunk_info(w->exr, w->part, (int)((w->first + i) * CHUNK_ROWS), &info);
        w->pipe[i] = (exr_encode_pipeline_t)EXR_ENCODE_PIPELINE_INITIALIZER;
        if (r == EXR_ERR_SUCCESS)
            r = exr_encoding_initialize(w->exr, w->part, &info, &w->pipe[i]);
    }
    if (r == EXR_ERR_SUCCESS)
        parallel_for(0, n, 1, compress_range, w);
    for (uint32_t i = 0; i < n; i++) {
        if (r == EXR_ERR_SUCCESS)
            r = w->result[i];
        if (r == EXR_ERR_SUCCESS)
            r = exr_write_scanline_chunk(w->exr, w->part, (int)((w->first + i) * CHUNK_ROWS),
                                         w->pipe[i].compressed_buffer, w->pipe[i].compressed_bytes);
        exr_encoding_destroy(w->exr, &w->pipe[i]);
    }
    return r;
}

static exr_result_t put_pixels(Writer *w)
{
    const Plane *p = w->plane;
    uint32_t chunks = (p->height + CHUNK_ROWS - 1) / CHUNK_ROWS;
    exr_result_t r = EXR_ERR_SUCCESS;
    for (uint32_t i = 0; i < MIN(chunks, (uint32_t)BATCH); i++)
        w->pixels[i] = g_malloc((gsize)p->width * p->channels * CHUNK_ROWS * (w->half ? 2 : 4));
    for (w->first = 0; r == EXR_ERR_SUCCESS && w->first < chunks; w->first += BATCH)
        r = put_batch(w, MIN(chunks - w->first, (uint32_t)BATCH));
    for (uint32_t i = 0; i < BATCH; i++)
        g_free(w->pixels[i]);
    return r;
}

gboolean image_write_exr(const Plane *p, const char *path, gboolean half, const Metadata *meta, GError **error)
{
    Writer *w = g_new0(Writer, 1);
    w->plane = p;
    /* half holds whole numbers up to 2048 only */
    w->half = half && p->kind != PLANE_LABEL;
    if (!staged_open(&w->file, path, error)) {
        g_free(w);
        return FALSE;
    }
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = on_error;
    init.user_data = w;
    init.write_fn = on_write;
    exr_result_t r = exr_start_write(&w->exr, path, EXR_WRITE_FILE_DIRECTLY, &init);
    if (r == EXR_ERR_SUCCESS)
        r = put_header(w, meta);
    if (r == EXR_ERR_SUCCESS)
        r = put_pixels(w);
    if (w->exr != NULL) {
        exr_result_t closed = exr_finish(&w->exr);
        r = r == EXR_ERR_SUCCESS ? closed : r;
    }
    gboolean ok = r == EXR_ERR_SUCCESS && w->code == 0;
    if (ok) {
        ok = staged_commit(&w->file, error);
    } else {
        if (w->code != 0)
            staged_error(path, w->code, error);
        else
            g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_FAILED, "can't write %s: %s", path,
                        exr_get_error_code_as_string(r));
        staged_abort(&w->file);
    }
    g_free(w);
    return ok;
}
