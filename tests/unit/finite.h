/* Whether every number in a file that was written is one: OpenEXR, PLY and glTF as they lie on the disk. Broken promises are told by fuzz_broken. */
#ifndef TESTS_FINITE_H
#define TESTS_FINITE_H

#include <glib.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <openexr.h>
#include <string.h>

#include "../fuzz/fuzz.h"

static inline float finite_float(const uint8_t *at)
{
    uint32_t bits;
    float f;
    memcpy(&bits, at, sizeof bits);
    bits = GUINT32_FROM_LE(bits);
    memcpy(&f, &bits, sizeof f);
    return f;
}

/* Halves are widened by the library, which keeps infinite what was too large for a half. */
static inline void finite_exr(const char *path)
{
    exr_context_t c;
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_attr_box2i_t window;
    int32_t lines;
    require(exr_start_read(&c, path, &init) == EXR_ERR_SUCCESS && exr_get_data_window(c, 0, &window) == EXR_ERR_SUCCESS);
    require(exr_get_scanlines_per_chunk(c, 0, &lines) == EXR_ERR_SUCCESS);
    gsize width = (gsize)(window.max.x - window.min.x + 1);
    for (int32_t y = window.min.y; y <= window.max.y; y += lines) {
        exr_chunk_info_t info;
        exr_decode_pipeline_t pipe = EXR_DECODE_PIPELINE_INITIALIZER;
        require(exr_read_scanline_chunk_info(c, 0, y, &info) == EXR_ERR_SUCCESS);
        require(exr_decoding_initialize(c, 0, &info, &pipe) == EXR_ERR_SUCCESS);
        gsize n = width * (gsize)info.height, channels = (gsize)pipe.channel_count;
        float *px = g_new0(float, n * channels);
        for (gsize i = 0; i < channels; i++) {
            exr_coding_channel_info_t *ch = &pipe.channels[i];
            ch->decode_to_ptr = (uint8_t *)(px + i * n);
            ch->user_bytes_per_element = 4;
            ch->user_data_type = EXR_PIXEL_FLOAT;
            ch->user_pixel_stride = 4;
            ch->user_line_stride = (int32_t)(4 * width);
        }
        require(exr_decoding_choose_default_routines(c, 0, &pipe) == EXR_ERR_SUCCESS && exr_decoding_run(c, 0, &pipe) == EXR_ERR_SUCCESS);
        exr_decoding_destroy(c, &pipe);
        for (gsize i = 0; i < n * channels; i++)
            require(isfinite(px[i]));
        g_free(px);
    }
    exr_finish(&c);
}

/* Floats of the vertices, which come first; of other properties only the size. */
static inline void finite_ply(const char *bytes, gsize size)
{
    const char *end = strstr(bytes, "end_header\n");
    require(end != NULL);
    char *head = g_strndup(bytes, (gsize)(end - bytes)), **line = g_strsplit(head, "\n", -1);
    gsize n = 0, stride = 0, n_floats = 0, offset[32], at = (gsize)(end - bytes) + strlen("end_header\n");
    for (char **l = line; *l && !g_str_has_prefix(*l, "element face"); l++) {
        if (g_str_has_prefix(*l, "element vertex "))
            n = (gsize)g_ascii_strtoull(*l + strlen("element vertex "), NULL, 10);
        if (!g_str_has_prefix(*l, "property "))
            continue;
        bool is_float = g_str_has_prefix(*l, "property float ");
        require(n_floats < G_N_ELEMENTS(offset));
        if (is_float)
            offset[n_floats++] = stride;
        bool one = g_str_has_prefix(*l, "property uchar "), four = is_float || g_str_has_prefix(*l, "property uint ") || g_str_has_prefix(*l, "property int ");
        require(one || four);
        stride += one ? 1 : 4;
    }
    require(n > 0 && n_floats >= 3 && at + n * stride <= size);
    for (gsize i = 0; i < n; i++)
        for (gsize k = 0; k < n_floats; k++)
            require(isfinite(finite_float((const uint8_t *)bytes + at + i * stride + offset[k])));
    g_strfreev(line);
    g_free(head);
}

/* Floats of every accessor: places, normals, weights, matrices, morph targets. */
static inline void finite_glb(const char *bytes, gsize size)
{
    enum { FLOAT = 5126, HEAD = 12, CHUNK = 8 };
    uint32_t length;
    require(size > HEAD + CHUNK);
    memcpy(&length, bytes + HEAD, sizeof length);
    length = GUINT32_FROM_LE(length);
    require(HEAD + CHUNK + (gsize)length + CHUNK <= size);
    const uint8_t *data = (const uint8_t *)bytes + HEAD + CHUNK + length + CHUNK;
    gsize n_data = size - (gsize)(data - (const uint8_t *)bytes), seen = 0;
    JsonParser *parser = json_parser_new();
    require(json_parser_load_from_data(parser, bytes + HEAD + CHUNK, (gssize)length, NULL));
    JsonObject *root = json_node_get_object(json_parser_get_root(parser));
    JsonArray *accessors = json_object_get_array_member(root, "accessors"), *views = json_object_get_array_member(root, "bufferViews");
    for (guint i = 0; i < json_array_get_length(accessors); i++) {
        JsonObject *a = json_array_get_object_element(accessors, i);
        if (json_object_get_int_member(a, "componentType") != FLOAT || !json_object_has_member(a, "bufferView"))
            continue;
        JsonObject *view = json_array_get_object_element(views, (guint)json_object_get_int_member(a, "bufferView"));
        gsize from = (gsize)json_object_get_int_member(view, "byteOffset"), n = (gsize)json_object_get_int_member(view, "byteLength");
        require(from + n <= n_data);
        for (gsize k = 0; k + 4 <= n; k += 4, seen++)
            require(isfinite(finite_float(data + from + k)));
    }
    require(seen > 0);
    g_object_unref(parser);
}

#endif
