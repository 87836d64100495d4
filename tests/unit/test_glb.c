/* glTF of bent leaves: read back with a plain reader and compared with the model. test_model.c hands it to other people's programs. */
#include "bent_leaf.h"
#include "plain_json.h"

typedef struct {
    Json *json;
    char *file;
    const char *bin;
    gsize size, bin_size;
} Glb;

static void check_chunks(Glb *g)
{
    g_assert_cmpuint(g->size, >=, 28);
    g_assert_cmpint(memcmp(g->file, "glTF\2\0\0\0", 8), ==, 0);
    g_assert_cmpuint(u32(g->file + 8), ==, g->size);
    uint32_t n = u32(g->file + 12);
    g_assert_cmpuint(n % 4, ==, 0);
    g_assert_cmpint(memcmp(g->file + 16, "JSON", 4), ==, 0);
    g_assert_cmpuint(28 + (gsize)n, <=, g->size);
    const char *head = g->file + 20 + n;
    g->bin_size = u32(head);
    g->bin = head + 8;
    g_assert_cmpint(memcmp(head + 4, "BIN\0", 4), ==, 0);
    g_assert_cmpuint(g->bin_size % 4, ==, 0);
    g_assert_cmpuint(28 + n + g->bin_size, ==, g->size);
    char *text = g_strndup(g->file + 20, n);
    const char *s = text;
    g->json = json_read(&s);
    skip(&s);
    g_assert_cmpint(*s, ==, '\0');
    g_free(text);
}

static const char *view_bytes(const Glb *g, guint view, gsize *n)
{
    const Json *v = at(get(g->json, "bufferViews"), view);
    guint start = whole(get(v, "byteOffset"));
    *n = whole(get(v, "byteLength"));
    g_assert_cmpuint(whole(get(v, "buffer")), ==, 0);
    g_assert_cmpuint(start % 4, ==, 0);
    g_assert_cmpuint(start + *n, <=, g->bin_size);
    return g->bin + start;
}

static guint parts(const Json *accessor)
{
    static const char *const name[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT4"};
    static const guint n[] = {1, 2, 3, 4, 16};
    for (guint i = 0; i < 5; i++)
        if (strcmp(get(accessor, "type")->text, name[i]) == 0)
            return n[i];
    g_error("type of accessor");
}

static guint component_size(const Json *accessor) { return whole(get(accessor, "componentType")) == 5123 ? 2 : 4; }

/* Values of an accessor as doubles; checks its range against its view. */
static double *values(const Glb *g, guint accessor, guint count, guint n_parts)
{
    const Json *a = at(get(g->json, "accessors"), accessor);
    gsize n;
    const char *bytes = view_bytes(g, whole(get(a, "bufferView")), &n);
    guint size = component_size(a), type = whole(get(a, "componentType"));
    g_assert_cmpuint(whole(get(a, "count")), ==, count);
    g_assert_cmpuint(parts(a), ==, n_parts);
    g_assert_cmpuint((gsize)count * n_parts * size, ==, n);
    double *v = g_new(double, (gsize)count * n_parts + 1);
    for (gsize i = 0; i < (gsize)count * n_parts; i++, bytes += size)
        v[i] = type == 5126 ? (double)f32(bytes) : size == 2 ? (double)((uint8_t)bytes[0] | (uint8_t)bytes[1] << 8) : (double)u32(bytes);
    return v;
}

/* Bounds, where there are some, are those of the values, exactly. */
static void check_bounds(const Glb *g, guint accessor)
{
    const Json *a = at(get(g->json, "accessors"), accessor);
    guint n = whole(get(a, "count")), k = parts(a);
    double *v = values(g, accessor, n, k);
    if (get(a, "min") != NULL)
        for (guint c = 0; c < k; c++) {
            double low = HUGE_VAL, high = -HUGE_VAL;
            for (gsize i = 0; i < n; i++) {
                low = MIN(low, v[i * k + c]);
                high = MAX(high, v[i * k + c]);
            }
            g_assert_cmpfloat(at(get(a, "min"), c)->number, ==, low);
            g_assert_cmpfloat(at(get(a, "max"), c)->number, ==, high);
        }
    g_free(v);
}

static void glb_open(Glb *g, const Model *m)
{
    char *path = in_folder("leaf.glb");
    GError *error = NULL;
    export_glb(m, path, &error);
    g_assert_no_error(error);
    *g = (Glb){0};
    g->file = contents(path, &g->size);
    check_chunks(g);
    g_assert_cmpuint(whole(get(at(get(g->json, "buffers"), 0), "byteLength")), ==, g->bin_size);
    gsize n;
    for (guint i = 0; i < length(get(g->json, "bufferViews")); i++)
        view_bytes(g, i, &n);
    for (guint i = 0; i < length(get(g->json, "accessors")); i++)
        check_bounds(g, i);
    g_unlink(path);
    g_free(path);
}

static void glb_close(Glb *g)
{
    json_free(g->json);
    g_free(g->file);
}

static const Json *primitive(const Glb *g, guint mesh) { return at(get(at(get(g->json, "meshes"), mesh), "primitives"), 0); }

static double *attribute(const Glb *g, guint mesh, const char *name, guint count, guint n_parts)
{
    return values(g, whole(get(get(primitive(g, mesh), "attributes"), name)), count, n_parts);
}

static void check_surface(const Glb *g, const Leaf *l, guint mesh, const Surface *f)
{
    uint32_t n = f->n_vertices;
    double *place = attribute(g, mesh, "POSITION", n, 3), *normal = attribute(g, mesh, "NORMAL", n, 3), *uv = attribute(g, mesh, "TEXCOORD_0", n, 2);
    for (gsize i = 0; i < n; i++) {
        assert_near(place + 3 * i, lying(l, f->place[i]), 1e-8);
        assert_near(normal + 3 * i, vec3(f->normal[i].x, f->normal[i].z, -f->normal[i].y), 1e-6);
        g_assert_cmpfloat(fabs(uv[2 * i] - f->uv[i].x), <, 1e-6);
        g_assert_cmpfloat(fabs(uv[2 * i + 1] - (1.0 - f->uv[i].y)), <, 1e-6);
    }
    guint indices = whole(get(primitive(g, mesh), "indices"));
    double *corner = values(g, indices, 3 * f->n_triangles, 1);
    for (gsize i = 0; i < 3 * (gsize)f->n_triangles; i++)
        g_assert_cmpfloat(corner[i], ==, f->triangle[i / 3][i % 3]);
    g_assert_cmpuint(whole(get(at(get(g->json, "accessors"), indices), "componentType")), ==, n > 65535 ? 5125 : 5123);
    g_free(place);
    g_free(normal);
    g_free(uv);
    g_free(corner);
}

static void test_glb_plain(void)
{
    Leaf l;
    Glb g;
    leaf_init(&l, 12, 15, 1.0);
    glb_open(&g, &l.m);
    const Json *asset = get(g.json, "asset");
    assert_text(get(asset, "version"), "2.0");
    assert_text(get(asset, "generator"), "Venation 0");
    assert_text(get(get(asset, "extras"), "title"), "Quercus, a leaf");
    g_assert_cmpuint(whole(get(get(get(asset, "extras"), "record"), "seed")), ==, 7);
    check_surface(&g, &l, 0, &l.blade);
    check_surface(&g, &l, 1, &l.veins);
    g_assert_null(get(g.json, "images"));
    g_assert_null(get(g.json, "skins"));
    g_assert_null(get(g.json, "animations"));
    g_assert_null(get(g.json, "extensionsUsed"));
    const Json *nodes = get(g.json, "nodes"), *scene = at(get(g.json, "scenes"), whole(get(g.json, "scene")));
    g_assert_cmpuint(length(nodes), ==, 3);
    assert_text(get(at(nodes, 0), "name"), "oak_blade");
    assert_text(get(at(nodes, 1), "name"), "oak_veins");
    assert_text(get(at(nodes, 2), "name"), "oak");
    g_assert_cmpuint(length(get(scene, "nodes")), ==, 1);
    g_assert_cmpuint(whole(at(get(scene, "nodes"), 0)), ==, 2);
    g_assert_cmpuint(length(get(at(nodes, 2), "children")), ==, 2);
    glb_close(&g);
    l.m.veins = NULL;
    glb_open(&g, &l.m);
    g_assert_cmpuint(length(get(g.json, "meshes")), ==, 1);
    g_assert_cmpuint(length(get(g.json, "materials")), ==, 1);
    g_assert_cmpuint(length(get(g.json, "nodes")), ==, 2);
    glb_close(&g);
    leaf_clear(&l);
}

static void assert_texture(const Glb *g, const Json *slot, GBytes *image)
{
    g_assert_nonnull(slot);
    const Json *texture = at(get(g->json, "textures"), whole(get(slot, "index"))), *i = at(get(g->json, "images"), whole(get(texture, "source")));
    assert_text(get(i, "mimeType"), "image/png");
    gsize n, m;
    const char *bytes = view_bytes(g, whole(get(i, "bufferView")), &n), *want = g_bytes_get_data(image, &m);
    g_assert_cmpuint(n, ==, m);
    g_assert_cmpint(memcmp(bytes, want, n), ==, 0);
}

/* Tangents point along growing u (the leaf's right), are square to the normals, and with them make the direction of growing v up. */
static void check_tangents(const Glb *g, const Leaf *l)
{
    uint32_t n = l->blade.n_vertices;
    double *tangent = attribute(g, 0, "TANGENT", n, 4), *normal = attribute(g, 0, "NORMAL", n, 3);
    for (gsize i = 0; i < n; i++) {
        const double *t = tangent + 4 * i, *m = normal + 3 * i;
        Vec3 a = vec3(t[0], t[1], t[2]), b = vec3(m[0], m[1], m[2]), up = vec3_scale(vec3_cross(b, a), t[3]);
        g_assert_cmpfloat(fabs(vec3_norm(a) - 1.0), <, 1e-6);
        g_assert_cmpfloat(fabs(vec3_dot(a, b)), <, 1e-6);
        g_assert_true(t[3] == 1.0 || t[3] == -1.0);
        g_assert_cmpfloat(a.x, >, 0.9);
        g_assert_cmpfloat(up.z, <, -0.9);
    }
    g_free(tangent);
    g_free(normal);
}

static void test_glb_maps(void)
{
    Leaf l;
    Glb g;
    leaf_init(&l, 12, 15, 1.0);
    add_pictures(&l, FALSE);
    const ModelImages *i = &l.m.images;
    glb_open(&g, &l.m);
    const Json *materials = get(g.json, "materials"), *blade = at(materials, whole(get(primitive(&g, 0), "material"))),
               *veins = at(materials, whole(get(primitive(&g, 1), "material"))), *pbr = get(blade, "pbrMetallicRoughness");
    assert_texture(&g, get(pbr, "baseColorTexture"), i->base_color);
    assert_texture(&g, get(pbr, "metallicRoughnessTexture"), i->surface);
    g_assert_cmpfloat(get(pbr, "metallicFactor")->number, ==, 0.0);
    g_assert_cmpfloat(get(pbr, "roughnessFactor")->number, ==, 1.0);
    assert_texture(&g, get(blade, "normalTexture"), i->normal);
    assert_texture(&g, get(blade, "occlusionTexture"), i->surface);
    assert_text(get(blade, "alphaMode"), "MASK");
    g_assert_cmpint(get(blade, "doubleSided")->kind, ==, 't');
    const Json *passes = get(get(blade, "extensions"), "KHR_materials_diffuse_transmission");
    assert_texture(&g, get(passes, "diffuseTransmissionTexture"), i->transmission);
    assert_texture(&g, get(get(veins, "pbrMetallicRoughness"), "baseColorTexture"), i->abaxial_base_color);
    g_assert_cmpuint(length(get(g.json, "extensionsUsed")), ==, 2);
    g_assert_null(get(g.json, "extensionsRequired"));
    const Json *mapping = get(get(get(primitive(&g, 0), "extensions"), "KHR_materials_variants"), "mappings");
    g_assert_true(at(materials, whole(get(at(mapping, 0), "material"))) == blade);
    const Json *shadow = at(materials, whole(get(at(mapping, 1), "material")));
    assert_texture(&g, get(get(shadow, "pbrMetallicRoughness"), "baseColorTexture"), i->abaxial_base_color);
    assert_texture(&g, get(shadow, "normalTexture"), i->abaxial_normal);
    check_surface(&g, &l, 0, &l.blade);
    check_tangents(&g, &l);
    glb_close(&g);
    leaf_clear(&l);
}

/* A name with quotes and a line end, no texts, normals of length 0. */
static void test_glb_odd(void)
{
    Leaf l;
    Glb g;
    leaf_init(&l, 12, 15, 1.0);
    l.m.name = "a \"leaf\"\nof \\ mine";
    l.m.title = l.m.generator = l.m.extras = NULL;
    l.blade.normal[0] = l.blade.normal[5] = vec3(0, 0, 0);
    glb_open(&g, &l.m);
    assert_text(get(at(get(g.json, "nodes"), 2), "name"), "a \"leaf\"\nof \\ mine");
    double *normal = attribute(&g, 0, "NORMAL", l.blade.n_vertices, 3);
    assert_near(normal, vec3(0, 1, 0), 0.0);
    g_free(normal);
    glb_close(&g);
    leaf_clear(&l);
}

/* The last count whose indices fit into 16 bits, and the next one. */
static void test_glb_index_size(void)
{
    const uint32_t columns[] = {255, 256}, rows[] = {257, 256};
    for (int k = 0; k < 2; k++) {
        Leaf l;
        Glb g;
        leaf_init(&l, columns[k], rows[k], 1.0);
        g_assert_cmpuint(l.blade.n_vertices, ==, 65535u + (unsigned)k);
        glb_open(&g, &l.m);
        check_surface(&g, &l, 0, &l.blade);
        glb_close(&g);
        leaf_clear(&l);
    }
}

/* Where each joint's node is at rest, by the tree of nodes alone; each is hung up once. */
static Vec3 *joint_places(const Glb *g, const Json *joints)
{
    const Json *nodes = get(g->json, "nodes");
    guint n = length(nodes), *parent = g_new(guint, n);
    Vec3 *place = g_new0(Vec3, length(joints));
    for (guint i = 0; i < n; i++)
        parent[i] = n;
    for (guint i = 0; i < n; i++)
        for (guint c = 0; c < length(get(at(nodes, i), "children")); c++) {
            guint child = whole(at(get(at(nodes, i), "children"), c));
            g_assert_cmpuint(parent[child], ==, n);
            parent[child] = i;
        }
    for (guint j = 0; j < length(joints); j++)
        for (guint i = whole(at(joints, j)), deep = 0; i < n; i = parent[i]) {
            const Json *t = get(at(nodes, i), "translation");
            if (t != NULL)
                place[j] = vec3_add(place[j], vec3(at(t, 0)->number, at(t, 1)->number, at(t, 2)->number));
            g_assert_cmpuint(deep++, <, n);
        }
    g_free(parent);
    return place;
}

/* Linear blend skinning in the pose of the nodes gives back the rest places. */
static void check_skin(const Glb *g, const Leaf *l, guint mesh, const Surface *f, const uint16_t *joint, const float *weight)
{
    const Json *skin = at(get(g->json, "skins"), 0), *joints = get(skin, "joints");
    uint32_t n = f->n_vertices, per = l->rig.per_vertex, n_joints = length(joints);
    g_assert_cmpuint(n_joints, ==, l->rig.n_joints);
    double *inverse = values(g, whole(get(skin, "inverseBindMatrices")), n_joints, 16), *place = attribute(g, mesh, "POSITION", n, 3);
    double *j[2] = {NULL, NULL}, *w[2] = {NULL, NULL};
    for (guint set = 0; set < per / 4; set++) {
        char *a = g_strdup_printf("JOINTS_%u", set), *b = g_strdup_printf("WEIGHTS_%u", set);
        j[set] = attribute(g, mesh, a, n, 4);
        w[set] = attribute(g, mesh, b, n, 4);
        g_free(a);
        g_free(b);
    }
    Vec3 *at_rest = joint_places(g, joints);
    for (uint32_t k = 0; k < n_joints; k++) {
        Vec3 want = lying(l, l->rig.joint[k].place);
        assert_near((double[]){at_rest[k].x, at_rest[k].y, at_rest[k].z}, want, 1e-8);
        assert_text(get(at(get(g->json, "nodes"), whole(at(joints, k))), "name"), l->rig.joint[k].name);
    }
    for (gsize i = 0; i < n; i++) {
        double sum = 0.0;
        Vec3 p = vec3(place[3 * i], place[3 * i + 1], place[3 * i + 2]), q = vec3(0, 0, 0);
        for (gsize c = 0; c < per; c++) {
            double part = w[c / 4][4 * i + c % 4];
            guint k = (guint)j[c / 4][4 * i + c % 4];
            const double *m = inverse + 16 * k;
            Vec3 moved = vec3(m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12], m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
                              m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]);
            q = vec3_add(q, vec3_scale(vec3_add(moved, at_rest[k]), part));
            sum += part;
            g_assert_cmpfloat(part, ==, (double)weight[i * per + c]);
            g_assert_cmpuint(k, ==, part > 0.0 ? joint[i * per + c] : 0);
        }
        g_assert_cmpfloat(fabs(sum - 1.0), <, 2e-7);
        g_assert_cmpfloat(vec3_dist(p, q), <, 1e-7);
    }
    for (guint set = 0; set < 2; set++) {
        g_free(j[set]);
        g_free(w[set]);
    }
    g_free(inverse);
    g_free(place);
    g_free(at_rest);
}

static void test_glb_rig(void)
{
    for (uint32_t per = 4; per <= 8; per += 4) {
        Leaf l;
        Glb g;
        leaf_init(&l, 12, 15, 1.0);
        add_rig(&l, per);
        glb_open(&g, &l.m);
        check_skin(&g, &l, 0, &l.blade, l.rig.blade_joint, l.rig.blade_weight);
        check_skin(&g, &l, 1, &l.veins, l.rig.vein_joint, l.rig.vein_weight);
        const Json *scene = at(get(g.json, "scenes"), 0), *nodes = get(g.json, "nodes");
        g_assert_cmpuint(length(get(scene, "nodes")), ==, 3); /* skinned meshes hang on nothing */
        g_assert_cmpuint(whole(get(at(nodes, 0), "skin")), ==, 0);
        g_assert_cmpuint(whole(get(at(nodes, 1), "skin")), ==, 0);
        g_assert_cmpuint(whole(get(at(get(g.json, "skins"), 0), "skeleton")), ==, 2);
        glb_close(&g);
        l.m.veins = NULL;
        glb_open(&g, &l.m);
        check_skin(&g, &l, 0, &l.blade, l.rig.blade_joint, l.rig.blade_weight);
        glb_close(&g);
        leaf_clear(&l);
    }
}

static void check_target(const Glb *g, const Leaf *l, guint mesh, guint target, const Vec3 *place, const Vec3 *normal, uint32_t n)
{
    const Json *t = at(get(primitive(g, mesh), "targets"), target);
    guint position = whole(get(t, "POSITION"));
    double *base = attribute(g, mesh, "POSITION", n, 3), *by = values(g, position, n, 3);
    double *base_normal = attribute(g, mesh, "NORMAL", n, 3), *turn = values(g, whole(get(t, "NORMAL")), n, 3);
    g_assert_nonnull(get(at(get(g->json, "accessors"), position), "min"));
    for (gsize i = 0; i < 3 * (gsize)n; i++) {
        base[i] += by[i];
        base_normal[i] += turn[i];
    }
    for (gsize i = 0; i < n; i++) {
        assert_near(base + 3 * i, lying(l, place[i]), 1e-8);
        assert_near(base_normal + 3 * i, vec3(normal[i].x, normal[i].z, -normal[i].y), 1e-6);
    }
    g_free(base);
    g_free(by);
    g_free(base_normal);
    g_free(turn);
}

static void test_glb_morphs(void)
{
    Leaf l;
    Glb g;
    leaf_init(&l, 12, 15, 1.0);
    add_morphs(&l);
    glb_open(&g, &l.m);
    for (guint k = 0; k < 2; k++) {
        check_target(&g, &l, 0, k, l.morph[k].blade, l.morph[k].blade_normal, l.blade.n_vertices);
        check_target(&g, &l, 1, k, l.morph[k].veins, l.morph[k].vein_normal, l.veins.n_vertices);
        assert_text(at(get(get(at(get(g.json, "meshes"), 0), "extras"), "targetNames"), k), l.morph[k].name);
        g_assert_cmpfloat(at(get(at(get(g.json, "meshes"), 0), "weights"), k)->number, ==, 0.0);
    }
    const Json *animation = at(get(g.json, "animations"), 0), *sampler = at(get(animation, "samplers"), 0);
    double *time = values(&g, whole(get(sampler, "input")), 3, 1), *weight = values(&g, whole(get(sampler, "output")), 6, 1);
    const double want_time[] = {0, 0.5, 1.5}, want_weight[] = {0, 0, 1, 0, 0, 1};
    g_assert_cmpint(memcmp(time, want_time, sizeof want_time), ==, 0);
    g_assert_cmpint(memcmp(weight, want_weight, sizeof want_weight), ==, 0);
    g_assert_cmpuint(length(get(animation, "channels")), ==, 2);
    g_free(time);
    g_free(weight);
    glb_close(&g);
    l.morph[0].time = l.morph[1].time = 0.0; /* the first target is what the animation begins with */
    add_pictures(&l, FALSE);
    add_rig(&l, 8);
    glb_open(&g, &l.m);
    sampler = at(get(at(get(g.json, "animations"), 0), "samplers"), 0);
    weight = values(&g, whole(get(sampler, "output")), 4, 1);
    g_assert_cmpfloat(weight[0], ==, 1.0);
    g_assert_cmpfloat(weight[3], ==, 1.0);
    g_free(weight);
    time = values(&g, whole(get(sampler, "input")), 2, 1);
    g_assert_cmpfloat(time[0], ==, 0.0);
    g_assert_cmpfloat(time[1], >, 0.0); /* though given as 0 too */
    g_assert_cmpfloat(time[1], <, 1e-6);
    g_free(time);
    const Json *t = at(get(primitive(&g, 0), "targets"), 0);
    double *tangent = attribute(&g, 0, "TANGENT", l.blade.n_vertices, 4), *turn = values(&g, whole(get(t, "TANGENT")), l.blade.n_vertices, 3);
    for (gsize i = 0; i < l.blade.n_vertices; i++) { /* the flat leaf's */
        const double *from = tangent + 4 * i, *by = turn + 3 * i;
        assert_near((double[]){from[0] + by[0], from[1] + by[1], from[2] + by[2]}, vec3(1, 0, 0), 1e-5);
    }
    g_free(tangent);
    g_free(turn);
    glb_close(&g);
    leaf_clear(&l);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    folder = g_dir_make_tmp("test_glb_XXXXXX", NULL);
    g_test_add_func("/glb/plain", test_glb_plain);
    g_test_add_func("/glb/maps", test_glb_maps);
    g_test_add_func("/glb/odd-names", test_glb_odd);
    g_test_add_func("/glb/index-size", test_glb_index_size);
    g_test_add_func("/glb/rig", test_glb_rig);
    g_test_add_func("/glb/morphs", test_glb_morphs);
    int status = g_test_run();
    g_rmdir(folder);
    g_free(folder);
    return status;
}
