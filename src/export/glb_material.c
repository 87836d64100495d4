#include "export/glb_material.h"

#include "export/export.h"

#define NONE UINT32_MAX

/* Indices of textures. */
typedef struct {
    uint32_t colour, abaxial_colour, normal, abaxial_normal, surface, transmission;
} Textures;

static uint32_t add_texture(GlbMaterials *g, GlbBuffer *b, GBytes *png, const char *name)
{
    if (png == NULL)
        return NONE;
    gsize n;
    const void *bytes = g_bytes_get_data(png, &n);
    const char *comma = g->n_textures > 0 ? "," : "";
    g_string_append_printf(g->images, "%s{\"name\":\"%s\",\"mimeType\":\"image/png\",\"bufferView\":%u}", comma, name,
                           glb_add_bytes(b, bytes, n, GLB_NO_TARGET));
    g_string_append_printf(g->textures, "%s{\"sampler\":0,\"source\":%u}", comma, g->n_textures);
    return g->n_textures++;
}

static void put_texture(GString *s, const char *key, uint32_t texture)
{
    if (texture != NONE)
        g_string_append_printf(s, ",\"%s\":{\"index\":%u}", key, texture);
}

/* Metal 0 and roughness; without a map a leaf's usual gloss. */
static void put_pbr(GString *s, uint32_t colour, uint32_t surface, const char *plain)
{
    g_string_append_printf(s, "\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":%s", surface != NONE ? "1" : "0.55");
    if (colour == NONE)
        g_string_append_printf(s, ",\"baseColorFactor\":[%s,1]", plain);
    put_texture(s, "baseColorTexture", colour);
    put_texture(s, "metallicRoughnessTexture", surface);
    g_string_append_c(s, '}');
}

static uint32_t begin_material(GlbMaterials *g, const char *name)
{
    g_string_append_printf(g->materials, "%s{\"name\":\"%s\",", g->n_materials > 0 ? "," : "", name);
    return g->n_materials++;
}

static uint32_t add_blade(GlbMaterials *g, const char *name, uint32_t colour, uint32_t normal, const Textures *t)
{
    uint32_t index = begin_material(g, name);
    GString *s = g->materials;
    put_pbr(s, colour, t->surface, "0.08,0.19,0.03");
    put_texture(s, "normalTexture", normal);
    put_texture(s, "occlusionTexture", t->surface);
    g_string_append(s, ",\"doubleSided\":true");
    if (colour != NONE) /* else there is no alpha */
        g_string_append(s, ",\"alphaMode\":\"MASK\",\"alphaCutoff\":0.5");
    if (t->transmission != NONE) {
        g_string_append(s, ",\"extensions\":{\"KHR_materials_diffuse_transmission\":{\"diffuseTransmissionFactor\":1");
        put_texture(s, "diffuseTransmissionTexture", t->transmission);
        put_texture(s, "diffuseTransmissionColorTexture", t->transmission);
        g_string_append(s, "}}");
        g->transmits = TRUE;
    }
    g_string_append_c(s, '}');
    g->bumpy = g->bumpy || normal != NONE;
    return index;
}

void glb_materials_init(GlbMaterials *g, const Model *m, GlbBuffer *b)
{
    const ModelImages *i = &m->images;
    *g = (GlbMaterials){.images = g_string_new(NULL), .textures = g_string_new(NULL), .materials = g_string_new(NULL),
                        .shadow_side = NONE, .veins = NONE};
    Textures t = {
        .colour = add_texture(g, b, i->base_color, "base_color"),
        .abaxial_colour = add_texture(g, b, i->abaxial_base_color, "abaxial_base_color"),
        .normal = add_texture(g, b, i->normal, "normal"),
        .abaxial_normal = add_texture(g, b, i->abaxial_base_color != NULL ? i->abaxial_normal : NULL, "abaxial_normal"),
        .surface = add_texture(g, b, i->surface, "surface"),
        .transmission = add_texture(g, b, i->transmission, "transmission"),
    };
    g->blade = add_blade(g, "blade", t.colour, t.normal, &t);
    if (t.abaxial_colour != NONE)
        g->shadow_side = add_blade(g, "blade, shadow side", t.abaxial_colour, t.abaxial_normal, &t);
    if (m->veins != NULL) {
        g->veins = begin_material(g, "veins");
        put_pbr(g->materials, t.abaxial_colour != NONE ? t.abaxial_colour : t.colour, t.surface, "0.55,0.62,0.24");
        g_string_append_c(g->materials, '}');
    }
}

void glb_materials_clear(GlbMaterials *g)
{
    g_string_free(g->images, TRUE);
    g_string_free(g->textures, TRUE);
    g_string_free(g->materials, TRUE);
}
