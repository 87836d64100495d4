/* The public interface, used as a program outside would: nothing but venation.h. */
#include <gio/gio.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "venation.h"

static void set(VenParams *p, const char *key, const char *value)
{
    GError *error = NULL;
    g_assert_true(ven_params_set(p, key, value, &error));
    g_assert_no_error(error);
}

/* A leaf that grows in a moment. */
static VenParams *small(void)
{
    VenParams *p = ven_params_new();
    set(p, "growth.kind", "isogonic");
    set(p, "growth.initial_length", "15");
    set(p, "growth.final_length", "60");
    set(p, "growth.step", "1.5");
    set(p, "sources.density", "0.01");
    set(p, "sources.birth_distance_sources", "3");
    set(p, "sources.birth_distance_veins", "3");
    set(p, "texture.size", "48");
    return p;
}

static VenLeaf *grow(const VenParams *p, uint64_t seed, unsigned threads)
{
    GError *error = NULL;
    VenOptions options = {.threads = threads};
    VenLeaf *leaf = ven_grow(p, seed, &options, &error);
    g_assert_no_error(error);
    g_assert_nonnull(leaf);
    return leaf;
}

static void test_version(void)
{
    g_assert_nonnull(ven_version());
    g_assert_cmpuint(strlen(ven_version()), >=, 5);
}

/* ---- parameters ---- */

static void test_params(void)
{
    VenParams *p = ven_params_new();
    char *value = ven_params_get(p, "veins.pattern");
    g_assert_cmpstr(value, ==, "closed");
    g_free(value);
    set(p, "veins.pattern", "open");
    value = ven_params_get(p, "veins.pattern");
    g_assert_cmpstr(value, ==, "open");
    g_free(value);
    g_assert_null(ven_params_get(p, "veins.no_such_key"));
    GError *error = NULL;
    g_assert_false(ven_params_set(p, "veins.patern", "open", &error));
    g_assert_nonnull(error);
    g_assert_nonnull(strstr(error->message, "pattern")); /* the nearest name */
    g_clear_error(&error);
    g_assert_false(ven_params_set(p, "veins.kill_distance", "-1", &error));
    g_assert_nonnull(strstr(error->message, "-1"));
    g_clear_error(&error);
    g_assert_false(ven_params_set(p, "veins.kill_distance", "much", NULL));
    ven_params_free(p);
    ven_params_free(NULL);
    ven_leaf_free(NULL);
}

/* The text of a set reads back as the same set. */
static void test_params_file(void)
{
    VenParams *p = small();
    char *text = ven_params_text(p), *dir = g_dir_make_tmp("venation-XXXXXX", NULL),
         *path = g_build_filename(dir, "leaf.ini", NULL);
    g_assert_true(g_file_set_contents(path, text, -1, NULL));
    GError *error = NULL;
    VenParams *q = ven_params_load(path, &error);
    g_assert_no_error(error);
    char *again = ven_params_text(q);
    g_assert_cmpstr(again, ==, text);
    g_assert_true(g_file_set_contents(path, "[veins]\nkill_distance = far\n", -1, NULL));
    g_assert_null(ven_params_load(path, &error));
    g_assert_nonnull(strstr(error->message, "kill_distance"));
    g_assert_nonnull(strstr(error->message, "far"));
    g_clear_error(&error);
    g_remove(path);
    g_assert_null(ven_params_load(path, &error));
    g_assert_nonnull(error);
    g_clear_error(&error);
    g_rmdir(dir);
    g_free(again);
    g_free(text);
    g_free(path);
    g_free(dir);
    ven_params_free(p);
    ven_params_free(q);
}

/* ---- growing ---- */

static void test_network(void)
{
    VenParams *p = small();
    VenLeaf *leaf = grow(p, 1, 1);
    uint32_t nodes = ven_leaf_nodes(leaf), edges = ven_leaf_edges(leaf), joins = 0;
    g_assert_cmpuint(nodes, >, 100);
    for (uint32_t v = 0; v < nodes; v++) {
        double x, y;
        uint32_t birth;
        ven_leaf_node(leaf, v, &x, &y, &birth);
        ven_leaf_node(leaf, v, NULL, NULL, NULL);
        g_assert_cmpfloat(fabs(x), <, 31);
        g_assert_cmpfloat(y, >, -2);
        g_assert_cmpfloat(y, <, 62);
        g_assert_cmpint(birth == 0, ==, v == 0);
    }
    for (uint32_t e = 0; e < edges; e++) {
        VenEdge edge;
        ven_leaf_edge(leaf, e, &edge);
        g_assert_cmpuint(edge.tail, <, edge.head);
        g_assert_cmpuint(edge.head, <, nodes);
        g_assert_cmpuint(edge.order, >=, 1);
        g_assert_cmpuint(edge.rank, >=, 1);
        g_assert_cmpfloat(edge.width, >, 0);
        joins += edge.anastomosis ? 1 : 0;
    }
    g_assert_cmpuint(joins, >, 0);
    g_assert_cmpuint(edges, ==, nodes - 1 + joins);
    ven_leaf_free(leaf);
    ven_params_free(p);
}

static char *record(const VenParams *p, uint64_t seed, unsigned threads)
{
    VenLeaf *leaf = grow(p, seed, threads);
    char *text = ven_leaf_record(leaf);
    ven_leaf_free(leaf);
    return text;
}

static void test_threads(void)
{
    VenParams *p = small();
    char *one = record(p, 7, 1), *other = record(p, 8, 1);
    g_assert_cmpstr(one, !=, other);
    g_assert_nonnull(strstr(one, "\"hash\": \""));
    const unsigned threads[] = {2, 7, 0};
    for (int i = 0; i < 3; i++) {
        char *text = record(p, 7, threads[i]);
        g_assert_cmpstr(text, ==, one);
        g_free(text);
    }
    GError *error = NULL;
    VenLeaf *plain = ven_grow(p, 7, NULL, &error); /* no options */
    char *text = ven_leaf_record(plain);
    g_assert_cmpstr(text, ==, one);
    g_free(text);
    ven_leaf_free(plain);
    g_free(one);
    g_free(other);
    ven_params_free(p);
}

static void refused(const char *key, const char *value, const char *word)
{
    VenParams *p = small();
    set(p, key, value);
    GError *error = NULL;
    g_assert_null(ven_grow(p, 1, NULL, &error));
    g_assert_nonnull(error);
    if (!strstr(error->message, word))
        g_error("'%s' does not name %s", error->message, word);
    g_clear_error(&error);
    g_assert_null(ven_grow(p, 1, NULL, NULL));
    ven_params_free(p);
}

static void test_errors(void)
{
    refused("growth.final_length", "5", "final_length");
    refused("outline.path", "M 0 0 L 1", "path");
    refused("outline.file", "no-such-file.svg", "no-such-file.svg");
    refused("veins.seeds", "3,3", "seeds");
    refused("veins.seeds", "", "seeds");
    refused("texture.maps", "base_color colour", "colour");
    refused("sources.placement", "list", "file");
    refused("sources.placement", "margin", "margin");
    refused("outline.teeth_count", "4", "teeth");
}

/* ---- progress ---- */

typedef struct {
    uint32_t calls, last_step, stop_at, snapshots, every, rehearsed;
    double done;
    char *final; /* record of the last snapshot */
} Watch;

static gboolean watch(const VenProgress *p, gpointer user)
{
    Watch *w = user;
    if (p->rehearsal) { /* the first of two growings has no snapshots */
        g_assert_cmpuint(w->calls, ==, 0);
        g_assert_null(p->leaf);
        g_assert_cmpfloat(p->done, >=, w->done);
        w->done = p->done;
        w->rehearsed++;
        return TRUE;
    }
    g_assert_cmpuint(p->step, ==, w->calls ? w->last_step + 1 : w->every ? 0 : 1); /* snapshots begin with the first nodes */
    w->calls++;
    g_assert_cmpfloat(p->done, >=, w->done);
    g_assert_cmpfloat(p->done, <=, 1.0);
    g_assert_cmpfloat(p->length, <=, 60);
    w->last_step = p->step;
    w->done = p->done;
    if (w->every && p->step % w->every == 0)
        g_assert_nonnull(p->leaf);
    if (!w->every)
        g_assert_null(p->leaf);
    if (p->leaf) {
        w->snapshots++;
        g_assert_cmpuint(ven_leaf_nodes(p->leaf), ==, p->nodes);
        g_free(w->final);
        w->final = ven_leaf_record(p->leaf);
    }
    return !w->stop_at || p->step != w->stop_at;
}

static void test_progress(void)
{
    VenParams *p = small();
    Watch w = {0}, often = {.every = 10};
    VenOptions options = {.threads = 1, .progress = watch, .user = &w};
    VenLeaf *leaf = ven_grow(p, 3, &options, NULL);
    g_assert_nonnull(leaf);
    g_assert_cmpuint(w.calls, >, 20);
    g_assert_cmpfloat(w.done, ==, 1.0);
    g_assert_cmpuint(w.snapshots, ==, 0);
    options.snapshot_every = 10;
    options.user = &often;
    VenLeaf *same = ven_grow(p, 3, &options, NULL);
    g_assert_cmpuint(often.calls, ==, w.calls + 1);
    g_assert_cmpuint(w.rehearsed, ==, 0);
    g_assert_cmpuint(often.rehearsed, ==, w.calls);
    g_assert_cmpuint(often.snapshots, ==, 1 + w.calls / 10 + (w.calls % 10 != 0));
    char *a = ven_leaf_record(leaf), *b = ven_leaf_record(same);
    g_assert_cmpstr(a, ==, b);
    g_assert_cmpstr(often.final, ==, b); /* the last snapshot is the leaf */
    g_free(a);
    g_free(b);
    g_free(often.final);
    ven_leaf_free(leaf);
    ven_leaf_free(same);
    ven_params_free(p);
}

static void test_cancel(void)
{
    VenParams *p = small();
    Watch w = {.stop_at = 5};
    VenOptions options = {.threads = 1, .progress = watch, .user = &w};
    GError *error = NULL;
    g_assert_null(ven_grow(p, 3, &options, &error));
    g_assert_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED);
    g_assert_cmpuint(w.calls, ==, 5);
    g_clear_error(&error);
    ven_params_free(p);
}

/* ---- files ---- */

/* Folder, file names and all, emptied of what a run wrote. */
static uint32_t remove_all(const char *dir)
{
    uint32_t n = 0;
    const char *name;
    GDir *d = g_dir_open(dir, 0, NULL);
    while (d && (name = g_dir_read_name(d))) {
        char *path = g_build_filename(dir, name, NULL);
        if (g_file_test(path, G_FILE_TEST_IS_DIR))
            n += remove_all(path);
        else
            n++;
        g_remove(path);
        g_free(path);
    }
    if (d)
        g_dir_close(d);
    g_rmdir(dir);
    return n;
}

static void has(const char *dir, const char *name)
{
    char *path = g_build_filename(dir, name, NULL);
    GStatBuf st;
    if (g_stat(path, &st) != 0 || st.st_size == 0)
        g_error("%s is missing or empty", name);
    g_free(path);
}

static void test_write(void)
{
    VenParams *p = small();
    VenLeaf *leaf = grow(p, 2, 2);
    char *tmp = g_dir_make_tmp("venation-XXXXXX", NULL), *dir = g_build_filename(tmp, "deep", "er", NULL);
    GError *error = NULL;
    g_assert_true(ven_write(leaf, dir, "small", &error)); /* makes the folders */
    g_assert_no_error(error);
    static const char *const file[] = {"small_base_color.png", "small_base_color.exr",
                                       "small_height.png",     "small_vein_mask.png",
                                       "small_veins.png",      "small.svg",
                                       "small.graphml",        "small_nodes.csv",
                                       "small_edges.csv",      "small.json"};
    for (gsize i = 0; i < G_N_ELEMENTS(file); i++)
        has(dir, file[i]);
    char *path = g_build_filename(dir, "small.json", NULL), *text, *want = ven_leaf_record(leaf);
    g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
    g_assert_cmpstr(text, ==, want);
    g_free(text);
    g_free(want);
    g_free(path);
    g_assert_true(ven_write_frame(leaf, dir, "small", FALSE, &error));
    g_assert_true(ven_write_frame(leaf, dir, "small", TRUE, &error));
    /* a folder that can't be: a file is in the way */
    char *blocked = g_build_filename(dir, "small.json", "sub", NULL);
    g_assert_false(ven_write(leaf, blocked, "small", &error));
    g_assert_nonnull(error);
    g_clear_error(&error);
    g_free(blocked);
    g_assert_cmpuint(remove_all(tmp), >, G_N_ELEMENTS(file));
    /* only what is asked for */
    set(p, "texture.maps", "opacity");
    set(p, "texture.exr", "none");
    set(p, "export.svg", "no");
    set(p, "export.network", "no");
    set(p, "export.veins_image", "no");
    VenLeaf *bare = grow(p, 2, 1);
    g_assert_true(ven_write(bare, dir, "bare", &error));
    has(dir, "bare_opacity.png");
    has(dir, "bare.json");
    g_assert_cmpuint(remove_all(tmp), ==, 2);
    g_free(tmp);
    g_free(dir);
    ven_leaf_free(leaf);
    ven_leaf_free(bare);
    ven_params_free(p);
}

/* Handles are independent: leaves grow side by side. */
static gpointer in_thread(gpointer data)
{
    return record(data, 11, 1);
}

static void test_side_by_side(void)
{
    VenParams *p[4];
    GThread *thread[4];
    for (int i = 0; i < 4; i++) {
        p[i] = small();
        set(p[i], "veins.pattern", i % 2 ? "open" : "closed");
        thread[i] = g_thread_new("leaf", in_thread, p[i]);
    }
    for (int i = 0; i < 4; i++) {
        char *text = g_thread_join(thread[i]), *alone = record(p[i], 11, 1);
        g_assert_cmpstr(text, ==, alone);
        g_free(text);
        g_free(alone);
        ven_params_free(p[i]);
    }
}

/* ---- shaping ---- */

/* Of the triangles; signed, seen from above, when `flat`. */
static double shape_area(const VenShape *s, gboolean flat)
{
    double sum = 0.0;
    for (uint32_t t = 0; t < ven_shape_triangles(s); t++) {
        uint32_t v[3];
        double p[3][3], a[3], b[3];
        ven_shape_triangle(s, t, v);
        for (int k = 0; k < 3; k++)
            ven_shape_vertex(s, v[k], p[k], NULL);
        for (int k = 0; k < 3; k++) {
            a[k] = p[1][k] - p[0][k];
            b[k] = p[2][k] - p[0][k];
        }
        double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
        sum += 0.5 * (flat ? z : sqrt(x * x + y * y + z * z));
    }
    return sum;
}

/* A flat blade of a known outline, then bent: each triangle faces the sunny side, together they are the lamina. */
static void test_shape(void)
{
    GError *error = NULL;
    VenParams *p = small();
    set(p, "outline.path", "M0,0 L3,5 0,10 -3,5 Z");
    set(p, "pose.preset", "flat");
    set(p, "export.leaf_length", "0.2");
    VenLeaf *leaf = grow(p, 1, 1);
    VenShape *s = ven_shape(leaf, &error);
    g_assert_no_error(error);
    double metres = 0.2 / 10.0, area = 30.0 * metres * metres;
    g_assert_cmpfloat(fabs(shape_area(s, TRUE) - area), <, 1e-6 * area);
    g_assert_cmpuint(ven_shape_levels(s), ==, 1);
    g_assert_false(ven_shape_rig(s, NULL, NULL, NULL));
    double normal[3], place[3], top = 0.0;
    for (uint32_t i = 0; i < ven_shape_vertices(s); i++) {
        ven_shape_vertex(s, i, place, normal);
        g_assert_cmpfloat(fabs(normal[2] - 1.0), <, 1e-9);
        g_assert_cmpfloat(fabs(place[2]), <, 1e-9);
        top = MAX(top, place[1]);
    }
    g_assert_cmpfloat(fabs(top - 0.2), <, 1e-9);

    set(p, "pose.preset", "folded");
    g_assert_true(ven_shape_pose(s, p, 1, &error));
    g_assert_no_error(error);
    double bent = shape_area(s, FALSE), seen = shape_area(s, TRUE);
    g_assert_cmpfloat(fabs(bent - area), <, 0.1 * area); /* a blade bends far more easily than it stretches */
    g_assert_cmpfloat(seen, <, 0.9 * area);

    set(p, "pose.rules", "no_such_vein lift 10");
    g_assert_false(ven_shape_pose(s, p, 1, &error));
    g_assert_nonnull(strstr(error->message, "no_such_vein"));
    g_clear_error(&error);
    g_assert_cmpfloat(shape_area(s, TRUE), ==, seen);
    ven_shape_free(s);
    ven_leaf_free(leaf);
    ven_params_free(p);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/api/version", test_version);
    g_test_add_func("/api/params", test_params);
    g_test_add_func("/api/params/file", test_params_file);
    g_test_add_func("/api/network", test_network);
    g_test_add_func("/api/threads", test_threads);
    g_test_add_func("/api/errors", test_errors);
    g_test_add_func("/api/progress", test_progress);
    g_test_add_func("/api/cancel", test_cancel);
    g_test_add_func("/api/write", test_write);
    g_test_add_func("/api/side-by-side", test_side_by_side);
    g_test_add_func("/api/shape", test_shape);
    return g_test_run();
}
