/* Export of bent leaves as OBJ, PLY and POV-Ray: what is written is read back and compared with the model (glTF: test_glb.c); other people's
 * programs read all formats too, where they are installed. */
#include <errno.h>
#include <locale.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "bent_leaf.h"

static guint files_in(const char *dir)
{
    guint n = 0;
    GDir *d = g_dir_open(dir, 0, NULL);
    while (g_dir_read_name(d) != NULL)
        n++;
    g_dir_close(d);
    return n;
}

/* ---- OBJ ---- */

static void test_obj(void)
{
    Leaf l;
    leaf_init(&l, 12, 15, 1.0);
    l.blade.place[3] = vec3(1e-4, 4e-8, 123456.789);
    char *path = in_folder("oak.obj"), *mtl_path = in_folder("oak.mtl");
    GError *error = NULL;
    g_assert_true(export_obj(&l.m, path, &error));
    char *text = contents(path, NULL), *mtl = contents(mtl_path, NULL), **line = g_strsplit(text, "\n", -1);
    uint32_t n[3] = {0}, faces = 0, blade = l.blade.n_vertices, all = blade + l.veins.n_vertices;
    const char *group = NULL;
    for (guint i = 0; line[i] != NULL; i++) {
        char **word = g_strsplit(line[i], " ", -1);
        const Surface *f = n[0] <= blade && (n[2] < blade || faces < l.blade.n_triangles) ? &l.blade : &l.veins;
        uint32_t base = f == &l.blade ? 0 : blade;
        int kind = line[i][0] == '\0' ? -1 : 3;
        for (int k = 0; k < 3 && kind == 3; k++)
            kind = strcmp(word[0], k == 0 ? "v" : k == 1 ? "vt" : "vn") == 0 ? k : 3;
        double v[3] = {0};
        for (guint k = 0; kind >= 0 && kind < 3 && k < (kind == 1 ? 2 : 3); k++) {
            g_assert_null(strstr(word[1 + k], "-0.0000000"));
            v[k] = g_ascii_strtod(word[1 + k], NULL);
        }
        if (kind == 0)
            assert_near(v, lying(&l, f->place[n[0]++ - base]), 0.51e-9);
        if (kind == 1) {
            Vec2 uv = f->uv[n[1]++ - base];
            assert_near(v, vec3(uv.x, uv.y, 0), 0.51e-6);
        }
        if (kind == 2) {
            Vec3 m = f->normal[n[2]++ - base];
            assert_near(v, vec3(m.x, m.z, -m.y), 0.51e-6);
        }
        if (kind == 3 && strcmp(word[0], "g") == 0)
            group = word[1][0] == 'b' ? "blade" : "veins";
        if (kind == 3 && strcmp(word[0], "usemtl") == 0) {
            g_assert_cmpstr(word[1], ==, group);
            char *want = g_strconcat("newmtl ", word[1], "\n", NULL);
            g_assert_nonnull(strstr(mtl, want));
            g_free(want);
        }
        if (kind == 3 && strcmp(word[0], "f") == 0) {
            for (guint k = 0; k < 3; k++) {
                guint a, b, c, corner = f->triangle[faces - (base ? l.blade.n_triangles : 0)][k] + base + 1;
                g_assert_cmpint(sscanf(word[1 + k], "%u/%u/%u", &a, &b, &c), ==, 3);
                g_assert_cmpuint(a, ==, corner);
                g_assert_cmpuint(b, ==, corner);
                g_assert_cmpuint(c, ==, corner);
                g_assert_cmpuint(a, <=, n[0]);
            }
            faces++;
        }
        g_strfreev(word);
    }
    for (int k = 0; k < 3; k++)
        g_assert_cmpuint(n[k], ==, all);
    g_assert_cmpuint(faces, ==, l.blade.n_triangles + l.veins.n_triangles);
    g_assert_nonnull(strstr(text, "\nmtllib oak.mtl\n"));
    g_assert_nonnull(strstr(text, " 0.0000005 617.283945 0\n")); /* to a nanometre, no -0 */
    const char *const map[] = {"map_Kd oak_base_color.png", "map_d oak_opacity.png", "norm oak_normal.png", "map_Bump -bm 1 oak_normal.png",
                               "map_Pr oak_roughness.png", "map_Kd oak_abaxial_base_color.png"};
    for (guint k = 0; k < G_N_ELEMENTS(map); k++)
        g_assert_nonnull(strstr(mtl, map[k]));
    g_strfreev(line);
    g_free(text);
    g_free(mtl);
    g_unlink(path);
    g_unlink(mtl_path);
    g_free(path);
    g_free(mtl_path);
    leaf_clear(&l);
}

/* ---- PLY ---- */

static void test_ply(void)
{
    Leaf l;
    leaf_init(&l, 12, 15, 1.0);
    char *path = in_folder("oak.ply");
    GError *error = NULL;
    g_assert_true(export_ply(&l.m, path, &error));
    gsize size;
    char *file = contents(path, &size), *body = strstr(file, "end_header\n");
    g_assert_nonnull(body);
    body += strlen("end_header\n");
    g_assert_true(g_str_has_prefix(file, "ply\nformat binary_little_endian 1.0\n"));
    char *header = g_strndup(file, (gsize)(body - file)), *at_vertex = strstr(header, "element vertex "), *at_face = strstr(header, "element face ");
    uint32_t n = (uint32_t)g_ascii_strtoull(at_vertex + 15, NULL, 10), faces = (uint32_t)g_ascii_strtoull(at_face + 13, NULL, 10), row = 0;
    g_assert_cmpuint(n, ==, l.blade.n_vertices + l.veins.n_vertices);
    g_assert_cmpuint(faces, ==, l.blade.n_triangles + l.veins.n_triangles);
    g_assert_nonnull(strstr(header, "property list uchar int vertex_indices\n"));
    GString *names = g_string_new(NULL);
    for (char *p = strstr(at_vertex, "property "); p != NULL && p < at_face; p = strstr(p + 1, "property ")) {
        char type[8], name[12];
        g_assert_cmpint(sscanf(p, "property %7s %11s", type, name), ==, 2);
        row += strcmp(type, "uchar") == 0 ? 1 : 4;
        g_string_append_printf(names, "%s ", name);
    }
    g_assert_cmpstr(names->str, ==, "x y z nx ny nz s t order radius sequence margin ");
    g_assert_cmpuint((gsize)(body - file) + (gsize)n * row + (gsize)faces * 13, ==, size);
    for (uint32_t i = 0; i < n; i++) {
        const char *p = body + (gsize)i * row;
        gboolean blade = i < l.blade.n_vertices;
        const Surface *f = blade ? &l.blade : &l.veins;
        uint32_t k = i - (blade ? 0 : l.blade.n_vertices), q = k / (BALLS * SIDES), ball = k / SIDES % BALLS;
        Vec3 place = lying(&l, f->place[k]), m = f->normal[k];
        const double want[8] = {place.x, place.y, place.z, m.x, m.z, -m.y, f->uv[k].x, f->uv[k].y};
        for (int c = 0; c < 8; c++)
            g_assert_cmpfloat(fabs((double)f32(p + 4 * c) - want[c]), <, 1e-7);
        double radius = l.m.unit * (blade ? l.m.vein_radius[k] : l.tube[q].radius[ball]);
        g_assert_cmpuint((uint8_t)p[32], ==, blade ? l.m.vein_order[k] : 1);
        g_assert_cmpfloat(fabs((double)f32(p + 33) - radius), <, 1e-9);
        g_assert_cmpuint(u32(p + 37), ==, blade ? l.m.vein_id[k] : q); /* the petiole is no sequence, the midrib the first */
        g_assert_cmpuint((uint8_t)p[41], ==, blade ? l.m.on_margin[k] : 0);
    }
    for (uint32_t t = 0; t < faces; t++) {
        const char *p = body + (gsize)n * row + (gsize)t * 13;
        gboolean blade = t < l.blade.n_triangles;
        g_assert_cmpint(*p, ==, 3);
        for (int c = 0; c < 3; c++)
            g_assert_cmpuint(u32(p + 1 + 4 * c), ==,
                             blade ? l.blade.triangle[t][c] : l.blade.n_vertices + l.veins.triangle[t - l.blade.n_triangles][c]);
    }
    g_string_free(names, TRUE);
    g_free(header);
    g_free(file);
    g_unlink(path);
    g_free(path);
    leaf_clear(&l);
}

/* ---- POV-Ray ---- */

/* The numbers in braces after `name`, up to the closing brace. */
static double *numbers(const char *text, const char *name, uint32_t *n)
{
    const char *s = strstr(text, name);
    g_assert_nonnull(s);
    GArray *v = g_array_new(FALSE, FALSE, sizeof(double));
    for (s = strchr(s, '{'); *s != '}';) {
        char *end;
        double x = g_ascii_strtod(s, &end);
        if (end == s || g_ascii_isalpha(*s)) {
            s++;
            continue;
        }
        g_array_append_val(v, x);
        s = end;
    }
    *n = v->len;
    return (double *)(void *)g_array_free(v, FALSE);
}

static void check_vectors(const char *text, const char *name, const Vec3 *want, uint32_t n)
{
    uint32_t count;
    double *v = numbers(text, name, &count);
    g_assert_cmpuint(count, ==, 1 + 3 * n);
    g_assert_cmpfloat(v[0], ==, n);
    for (gsize i = 0; i < n; i++)
        assert_near(v + 1 + 3 * i, vec3(want[i].x, want[i].y, -want[i].z), 0.51e-6);
    g_free(v);
}

static void check_include(const Leaf *l, const char *text)
{
    check_vectors(text, "vertex_vectors", l->blade.place, l->blade.n_vertices);
    check_vectors(text, "normal_vectors", l->blade.normal, l->blade.n_vertices);
    uint32_t count;
    double *v = numbers(text, "face_indices", &count);
    g_assert_cmpuint(count, ==, 1 + 3 * l->blade.n_triangles);
    for (gsize i = 0; i < 3 * (gsize)l->blade.n_triangles; i++)
        g_assert_cmpfloat(v[1 + i], ==, l->blade.triangle[i / 3][i % 3]);
    g_free(v);
    v = numbers(text, "uv_vectors", &count);
    g_assert_cmpuint(count, ==, 1 + 2 * l->blade.n_vertices);
    g_free(v);
    for (uint32_t q = 0; q < TUBES; q++) {
        char *name = g_strdup_printf("#declare vein%u = sphere_sweep", q);
        v = numbers(text, name, &count);
        g_assert_cmpuint(count, ==, 1 + 4 * BALLS);
        g_assert_cmpfloat(v[0], ==, BALLS);
        for (gsize i = 0; i < BALLS; i++) {
            Vec3 c = l->tube[q].centre[i];
            assert_near(v + 1 + 4 * i, vec3(c.x, c.y, -c.z), 0.51e-6);
            g_assert_cmpfloat(fabs(v[4 + 4 * i] - l->tube[q].radius[i]), <, 0.51e-6);
        }
        g_free(v);
        g_free(name);
    }
}

/* Three numbers between < and > after `name`. */
static Vec3 vector_after(const char *text, const char *name)
{
    Vec3 v;
    const char *s = strstr(text, name);
    g_assert_nonnull(s);
    g_assert_cmpint(sscanf(strchr(s, '<'), "<%lf, %lf, %lf>", &v.x, &v.y, &v.z), ==, 3);
    return v;
}

static double value_after(const char *text, const char *name)
{
    const char *s = strstr(text, name);
    g_assert_nonnull(s);
    return g_ascii_strtod(s + strlen(name), NULL);
}

/* Where a ball lies in the picture at distance 1: its box, added to `box`. */
static void see(const char *scene, Vec3 p, double radius, double box[4])
{
    Vec3 d = vec3_sub(vec3(p.x, p.z, p.y), vector_after(scene, "location"));
    double depth = vec3_dot(d, vector_after(scene, "direction"));
    const Vec3 axis[2] = {vector_after(scene, "right 2"), vector_after(scene, "up 2")};
    for (int k = 0; k < 2; k++) {
        box[2 * k] = MIN(box[2 * k], (vec3_dot(d, axis[k]) - radius) / depth);
        box[2 * k + 1] = MAX(box[2 * k + 1], (vec3_dot(d, axis[k]) + radius) / depth);
    }
}

/* The camera's axes are square to each other, POV-Ray's left hand; the leaf is in the middle of the picture and fills it. */
static void check_camera(const Leaf *l, const char *scene)
{
    Vec3 ahead = vector_after(scene, "direction"), up = vector_after(scene, "up 2"), right = vector_after(scene, "right 2");
    g_assert_cmpfloat(fabs(vec3_dot(ahead, up)) + fabs(vec3_dot(ahead, right)) + fabs(vec3_dot(up, right)), <, 1e-12);
    g_assert_cmpfloat(vec3_dist(vec3_cross(right, up), ahead), <, 1e-12);
    double box[4] = {HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL}, half[2] = {value_after(scene, "Half_width = "), value_after(scene, "Half_height = ")};
    for (uint32_t i = 0; i < l->blade.n_vertices; i++)
        see(scene, l->blade.place[i], 0.0, box);
    for (uint32_t q = 0; q < TUBES; q++)
        for (uint32_t i = 0; i < BALLS; i++)
            see(scene, l->tube[q].centre[i], l->tube[q].radius[i], box);
    for (int k = 0; k < 2; k++) {
        g_assert_cmpfloat(fabs(box[2 * k] / half[k] + 1.0), <, 0.001);
        g_assert_cmpfloat(fabs(box[2 * k + 1] / half[k] - 1.0), <, 0.001);
    }
}

static void test_pov(void)
{
    Leaf l;
    leaf_init(&l, 12, 15, 1.0);
    char *inc = in_folder("oak.inc"), *pov = in_folder("oak.pov");
    GError *error = NULL;
    g_assert_true(export_pov(&l.m, inc, pov, &error));
    char *text = contents(inc, NULL), *scene = contents(pov, NULL);
    check_include(&l, text);
    g_assert_nonnull(strstr(text, "object { vein0 }"));
    g_assert_nonnull(strstr(text, "object { vein1 }"));
    g_assert_null(strstr(text, "vein2"));
    g_assert_cmpfloat(value_after(text, "leaf_metres = "), ==, 0.005);
    const char *const file[] = {"\"oak_base_color.png\"", "\"oak_abaxial_base_color.png\"", "\"oak_height.png\"", "\"oak_translucency.png\""};
    for (guint k = 0; k < G_N_ELEMENTS(file); k++)
        g_assert_nonnull(strstr(text, file[k]));
    g_assert_nonnull(strstr(scene, "#include \"oak.inc\""));
    g_assert_null(strstr(scene, folder));
    check_camera(&l, scene);
    g_assert_null(strstr(text, "oak_opacity.png"));
    g_free(text);
    g_free(scene);
    l.m.holes = TRUE; /* both sides are clear where the opacity map is */
    g_assert_true(export_pov(&l.m, inc, pov, &error));
    text = contents(inc, NULL);
    const char *first = strstr(text, "oak_opacity.png"), *second = first ? strstr(first + 1, "oak_opacity.png") : NULL;
    g_assert_nonnull(second);
    g_assert_null(strstr(second + 1, "oak_opacity.png"));
    g_assert_nonnull(strstr(second, "rgbt 1"));
    check_include(&l, text);
    g_free(text);
    l.m.holes = FALSE;
    for (int k = 1; k < 4; k++) { /* a union of nothing would be an error */
        l.m.n_tubes = k & 1 ? 0 : TUBES;
        l.m.veins = k & 2 ? NULL : &l.veins;
        g_assert_true(export_pov(&l.m, inc, pov, &error));
        text = contents(inc, NULL);
        g_assert_cmpint(strstr(text, "sphere_sweep") != NULL, ==, !(k & 1));
        g_assert_cmpint(strstr(text, "object { vein0") != NULL, ==, !(k & 1));
        g_assert_cmpint(strstr(text, "object { vein texture") != NULL, ==, !(k & 1));
        g_assert_cmpint(strstr(text, "object { vein_mesh texture") != NULL, ==, !(k & 2));
        g_assert_cmpint(strstr(text, "round_veins)") != NULL, ==, FALSE);
        g_free(text);
    }
    g_unlink(inc);
    g_unlink(pov);
    g_free(inc);
    g_free(pov);
    leaf_clear(&l);
}

/* ---- all of them ---- */

enum { FORMATS = 4 };

static gboolean write_as(const Model *m, int format, const char *stem, GError **error)
{
    static const char *const end[] = {".obj", ".ply", ".inc", ".glb"};
    char *path = g_strconcat(stem, end[format], NULL), *scene = g_strconcat(stem, ".pov", NULL);
    gboolean ok = format == 0   ? export_obj(m, path, error)
                  : format == 1 ? export_ply(m, path, error)
                  : format == 2 ? export_pov(m, path, scene, error)
                                : export_glb(m, path, error);
    g_free(path);
    g_free(scene);
    return ok;
}

static void assert_same(const char *a, const char *b)
{
    gsize n, m;
    char *x = contents(a, &n), *y = contents(b, &m);
    g_assert_cmpuint(n, >, 100);
    g_assert_cmpuint(n, ==, m);
    g_assert_cmpint(memcmp(x, y, n), ==, 0);
    g_free(x);
    g_free(y);
}

/* The same bytes again, from other memory, into another folder, where decimals have a comma. */
static void test_same_bytes(void)
{
    char *dir[2] = {in_folder("one"), in_folder("two")};
    for (int k = 0; k < 2; k++) {
        Leaf l;
        leaf_init(&l, 12, 15, 1.0);
        add_pictures(&l, FALSE);
        add_rig(&l, 4);
        add_morphs(&l);
        g_assert_cmpint(g_mkdir(dir[k], 0700), ==, 0);
        char *stem = g_build_filename(dir[k], "oak", NULL);
        if (k == 1 && setlocale(LC_ALL, "de_DE.UTF-8") == NULL)
            g_test_message("no German locale here");
        for (int f = 0; f < FORMATS; f++)
            g_assert_true(write_as(&l.m, f, stem, NULL));
        setlocale(LC_ALL, "C");
        g_free(stem);
        leaf_clear(&l);
    }
    const char *const name[] = {"oak.obj", "oak.mtl", "oak.ply", "oak.inc", "oak.pov", "oak.glb"};
    for (guint i = 0; i < G_N_ELEMENTS(name); i++) {
        char *a = g_build_filename(dir[0], name[i], NULL), *b = g_build_filename(dir[1], name[i], NULL);
        assert_same(a, b);
        g_unlink(a);
        g_unlink(b);
        g_free(a);
        g_free(b);
    }
    for (int k = 0; k < 2; k++) {
        g_assert_cmpuint(files_in(dir[k]), ==, 0);
        g_rmdir(dir[k]);
        g_free(dir[k]);
    }
}

static void expect_failure(const Model *m, int format, const char *stem, int code)
{
    guint before = files_in(folder);
    GError *error = NULL;
    g_assert_false(write_as(m, format, stem, &error));
    g_assert_error(error, G_FILE_ERROR, code);
    g_assert_nonnull(strstr(error->message, stem));
    g_error_free(error);
    g_assert_cmpuint(files_in(folder), ==, before);
}

static void test_failures(void)
{
    static const char *const second[] = {"x.mtl", "x.ply", "x.pov", "x.glb"};
    Leaf l;
    leaf_init(&l, 12, 15, 1.0);
    char *missing = in_folder("no/x"), *stem = in_folder("x");
    for (int f = 0; f < FORMATS; f++) {
        expect_failure(&l.m, f, missing, G_FILE_ERROR_NOENT);
        char *taken = in_folder(second[f]); /* of a pair the one that is renamed last */
        g_assert_cmpint(g_mkdir(taken, 0700), ==, 0);
        expect_failure(&l.m, f, stem, G_FILE_ERROR_ISDIR);
        g_rmdir(taken);
        g_free(taken);
    }
    g_free(missing);
    g_free(stem);
    leaf_clear(&l);
}

/* A file size limit stands in for a full disk; what was there before stays. */
static void test_full_disk(void)
{
    static const char *const first[] = {"x.obj", "x.ply", "x.inc", "x.glb"};
    Leaf l;
    leaf_init(&l, 220, 220, 1.0);
    char *stem = in_folder("x");
    struct rlimit old, low;
    getrlimit(RLIMIT_FSIZE, &old);
    low = old;
    low.rlim_cur = 1500000;
    for (int f = 0; f < FORMATS; f++) {
        char *path = in_folder(first[f]), *left;
        g_assert_true(g_file_set_contents(path, "before", 6, NULL));
        void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
        setrlimit(RLIMIT_FSIZE, &low);
        expect_failure(&l.m, f, stem, (int)g_file_error_from_errno(EFBIG));
        setrlimit(RLIMIT_FSIZE, &old);
        signal(SIGXFSZ, handler);
        left = contents(path, NULL);
        g_assert_cmpstr(left, ==, "before");
        g_free(left);
        g_unlink(path);
        g_free(path);
    }
    g_free(stem);
    leaf_clear(&l);
}

/* Names with quotes and line ends, no texts at all, normals of length 0: still files that can be read. */
static void test_odd(void)
{
    Leaf l;
    leaf_init(&l, 12, 15, 1.0);
    l.m.name = "a \"leaf\"\nof \\ mine";
    l.m.title = "two\nlines";
    l.m.generator = l.m.extras = NULL;
    l.m.base_color_file = "odd \"name\".png";
    g_free((void *)l.m.vein_order);
    l.m.vein_order = NULL;
    l.m.n_tubes = 1; /* as many tubes as there are not */
    l.blade.normal[0] = l.blade.normal[5] = vec3(0, 0, 0);
    char *stem = in_folder("odd"), *obj = in_folder("odd.obj"), *ply = in_folder("odd.ply"), *inc = in_folder("odd.inc"), *mtl = in_folder("odd.mtl"),
         *pov = in_folder("odd.pov");
    for (int f = 0; f < 3; f++)
        g_assert_true(write_as(&l.m, f, stem, NULL));
    char *text = contents(obj, NULL);
    g_assert_nonnull(strstr(text, "# two lines\n"));
    g_assert_nonnull(strstr(text, "\no a__leaf__of___mine\n"));
    g_free(text);
    text = contents(inc, NULL);
    g_assert_nonnull(strstr(text, "// two lines\n"));
    g_assert_nonnull(strstr(text, "\"odd \\\"name\\\".png\""));
    g_free(text);
    text = contents(ply, NULL);
    g_assert_nonnull(strstr(text, "\ncomment two lines\n"));
    g_free(text);
    const char *const path[] = {obj, ply, inc, mtl, pov};
    for (guint i = 0; i < G_N_ELEMENTS(path); i++)
        g_unlink(path[i]);
    g_free(stem);
    g_free(obj);
    g_free(ply);
    g_free(inc);
    g_free(mtl);
    g_free(pov);
    leaf_clear(&l);
}

/* Writes leaves that check_model.py hands to other people's programs. VENATION_KEEP_MODELS names a folder that shall keep them. */
static void test_other_programs(void)
{
    const char *python = g_getenv("PYTHON3"), *keep = g_getenv("VENATION_KEEP_MODELS");
    char *script = g_test_build_filename(G_TEST_DIST, "check_model.py", NULL), *dir = in_folder("models"), *usual = folder;
    folder = keep != NULL ? g_strdup(keep) : dir;
    g_mkdir_with_parents(folder, 0700);
    GString *files = g_string_new(NULL);
    for (int k = 0; k < 4; k++) {
        Leaf l;
        leaf_init(&l, 24, 30, k == 1 ? 0.0 : 1.0);
        if (k != 1)
            add_pictures(&l, TRUE);
        else
            l.m.base_color_file = l.m.abaxial_base_color_file = l.m.height_file = l.m.translucency_file = NULL;
        if (k == 2)
            add_rig(&l, 4);
        if (k == 3) {
            add_rig(&l, 8);
            add_morphs(&l);
        }
        char *name = g_strdup_printf("leaf%d", k), *stem = in_folder(name);
        for (int f = 0; f < FORMATS; f++)
            g_assert_true(write_as(&l.m, f, stem, NULL));
        g_string_append_printf(files, " %s:%u:%u", name, l.blade.n_vertices + l.veins.n_vertices, l.blade.n_triangles + l.veins.n_triangles);
        g_free(name);
        g_free(stem);
        leaf_clear(&l);
    }
    char *command = g_strdup_printf("%s '%s' '%s'%s", python != NULL ? python : "python3", script, folder, files->str), *out = NULL, *err = NULL;
    int status = 0;
    GError *error = NULL;
    g_spawn_command_line_sync(command, &out, &err, &status, &error);
    g_assert_no_error(error);
    char **line = g_strsplit(out, "\n", -1);
    for (guint i = 0; line[i] != NULL; i++)
        if (line[i][0] != '\0')
            g_test_message("%s", line[i]);
    g_strfreev(line);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 77)
        g_test_skip("none of the programs is installed");
    else if (status != 0)
        g_error("%s%s", out, err);
    if (keep == NULL) {
        GDir *d = g_dir_open(folder, 0, NULL);
        for (const char *name; (name = g_dir_read_name(d)) != NULL;) {
            char *path = in_folder(name);
            g_unlink(path);
            g_free(path);
        }
        g_dir_close(d);
        g_rmdir(folder);
    } else {
        g_free(folder);
    }
    folder = usual;
    g_free(dir);
    g_free(out);
    g_free(err);
    g_free(command);
    g_free(script);
    g_string_free(files, TRUE);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    folder = g_dir_make_tmp("test_model_XXXXXX", NULL);
    g_test_add_func("/model/obj", test_obj);
    g_test_add_func("/model/ply", test_ply);
    g_test_add_func("/model/pov", test_pov);
    g_test_add_func("/model/same-bytes", test_same_bytes);
    g_test_add_func("/model/failures", test_failures);
    g_test_add_func("/model/full-disk", test_full_disk);
    g_test_add_func("/model/odd", test_odd);
    g_test_add_func("/model/other-programs", test_other_programs);
    int status = g_test_run();
    g_rmdir(folder);
    g_free(folder);
    return status;
}
