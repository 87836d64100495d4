#include "export/glb_buffer.h"

#include <string.h>

#include "export/export.h"

enum { USHORT = 5123, UINT = 5125, FLOAT = 5126 };

void glb_buffer_init(GlbBuffer *b)
{
    *b = (GlbBuffer){.bytes = g_byte_array_new(), .views = g_string_new(NULL), .accessors = g_string_new(NULL)};
}

void glb_buffer_clear(GlbBuffer *b)
{
    g_byte_array_free(b->bytes, TRUE);
    g_string_free(b->views, TRUE);
    g_string_free(b->accessors, TRUE);
}

static void pad(GByteArray *a)
{
    static const uint8_t zero[4] = {0};
    g_byte_array_append(a, zero, -a->len % 4);
}

/* Describes what was appended from `start` on. */
static uint32_t end_view(GlbBuffer *b, guint start, GlbTarget target)
{
    g_string_append_printf(b->views, "%s{\"buffer\":0,\"byteOffset\":%u,\"byteLength\":%u", b->n_views > 0 ? "," : "", start,
                           b->bytes->len - start);
    if (target != GLB_NO_TARGET)
        g_string_append_printf(b->views, ",\"target\":%d", (int)target);
    g_string_append_c(b->views, '}');
    pad(b->bytes);
    return b->n_views++;
}

uint32_t glb_add_bytes(GlbBuffer *b, const void *bytes, gsize n, GlbTarget target)
{
    guint start = b->bytes->len;
    g_byte_array_append(b->bytes, bytes, (guint)n);
    return end_view(b, start, target);
}

static void put_u32(GByteArray *a, uint32_t v)
{
    v = GUINT32_TO_LE(v);
    g_byte_array_append(a, (const uint8_t *)&v, sizeof v);
}

static void put_u16(GByteArray *a, uint16_t v)
{
    v = GUINT16_TO_LE(v);
    g_byte_array_append(a, (const uint8_t *)&v, sizeof v);
}

static void put_float(GByteArray *a, float v)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    put_u32(a, bits);
}

static const char *type_name(uint32_t parts)
{
    return parts == 1 ? "SCALAR" : parts == 2 ? "VEC2" : parts == 3 ? "VEC3" : parts == 4 ? "VEC4" : "MAT4";
}

/* Begins the accessor's object. */
static void put_accessor(GlbBuffer *b, uint32_t view, uint32_t count, int component, const char *type)
{
    g_string_append_printf(b->accessors, "%s{\"bufferView\":%u,\"componentType\":%d,\"count\":%u,\"type\":\"%s\"",
                           b->n_accessors > 0 ? "," : "", view, component, count, type);
}

static void put_bound(GString *s, const char *name, const float *bound, uint32_t parts)
{
    g_string_append_printf(s, ",\"%s\":[", name);
    for (uint32_t k = 0; k < parts; k++) {
        g_string_append(s, k > 0 ? "," : "");
        export_number(s, (double)bound[k]);
    }
    g_string_append_c(s, ']');
}

uint32_t glb_add_floats(GlbBuffer *b, const float *value, uint32_t count, uint32_t parts, gboolean bounds, GlbTarget target)
{
    float low[16] = {0}, high[16] = {0};
    guint start = b->bytes->len;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < parts; k++) {
            float v = value[(gsize)i * parts + k];
            low[k] = i == 0 || v < low[k] ? v : low[k];
            high[k] = i == 0 || v > high[k] ? v : high[k];
            put_float(b->bytes, v);
        }
    put_accessor(b, end_view(b, start, target), count, FLOAT, type_name(parts));
    if (bounds) {
        put_bound(b->accessors, "min", low, parts);
        put_bound(b->accessors, "max", high, parts);
    }
    g_string_append_c(b->accessors, '}');
    return b->n_accessors++;
}

uint32_t glb_add_vec3(GlbBuffer *b, const Vec3 *value, uint32_t count, gboolean bounds, GlbTarget target)
{
    float *f = g_new(float, (gsize)count * 3 + 1);
    for (uint32_t i = 0; i < count; i++) {
        f[(gsize)i * 3] = (float)value[i].x;
        f[(gsize)i * 3 + 1] = (float)value[i].y;
        f[(gsize)i * 3 + 2] = (float)value[i].z;
    }
    uint32_t accessor = glb_add_floats(b, f, count, 3, bounds, target);
    g_free(f);
    return accessor;
}

uint32_t glb_add_joints(GlbBuffer *b, const uint16_t *value, uint32_t count)
{
    guint start = b->bytes->len;
    for (gsize i = 0; i < (gsize)count * 4; i++)
        put_u16(b->bytes, value[i]);
    put_accessor(b, end_view(b, start, GLB_VERTICES), count, USHORT, "VEC4");
    g_string_append_c(b->accessors, '}');
    return b->n_accessors++;
}

uint32_t glb_add_triangles(GlbBuffer *b, const uint32_t (*triangle)[3], uint32_t n_triangles, uint32_t n_vertices)
{
    gboolean small = n_vertices <= UINT16_MAX; /* 65535 itself is not an index but a restart */
    guint start = b->bytes->len;
    for (uint32_t t = 0; t < n_triangles; t++)
        for (int k = 0; k < 3; k++) {
            if (small)
                put_u16(b->bytes, (uint16_t)triangle[t][k]);
            else
                put_u32(b->bytes, triangle[t][k]);
        }
    put_accessor(b, end_view(b, start, GLB_INDICES), n_triangles * 3, small ? USHORT : UINT, "SCALAR");
    g_string_append_c(b->accessors, '}');
    return b->n_accessors++;
}
