/* Export of networks: same bytes, exact read-back, well-formed XML, failures that leave nothing. */
#include <errno.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <locale.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "export/export.h"
#include "export/sink.h"
#include "geom/random.h"

static char *folder;

static char *in_folder(const char *name)
{
    return g_build_filename(folder, name, NULL);
}

G_GNUC_NO_INLINE static char *slurp(const char *path, gsize *length)
{
    char *text = NULL;
    GError *error = NULL;
    g_file_get_contents(path, &text, length, &error);
    g_assert_no_error(error);
    return text;
}

static guint files_in(const char *dir)
{
    guint n = 0;
    GDir *d = g_dir_open(dir, 0, NULL);
    while (g_dir_read_name(d) != NULL)
        n++;
    g_dir_close(d);
    return n;
}

static void put_edge(Network *n, uint32_t e, uint32_t tail, uint32_t head, uint8_t order, uint32_t vein, double width)
{
    n->tail[e] = tail;
    n->head[e] = head;
    n->order[e] = order;
    n->rank[e] = (uint8_t)(order + 1);
    n->vein[e] = vein;
    n->width[e] = width;
    n->flow[e] = width * width / 0.25;
    n->birth[e] = head;
}

/* A midvein 0…n along y with a side vein of two edges at each of its nodes, and one edge that closes a loop. */
static Network *small_leaf(uint32_t n)
{
    Network *net = network_new(3 * n + 1, 3 * n + 1);
    net->n_steps = n;
    net->n_veins = n + 2;
    for (uint32_t i = 0; i <= n; i++) {
        net->node[i] = vec2(0.1 * i * i / n, i);
        net->node_birth[i] = i;
    }
    for (uint32_t i = 0; i < 2 * n; i++) {
        net->node[n + 1 + i] = vec2(1.0 / 3.0 + i % 2, 1.25 + i / 2 + 0.1 * (i % 2));
        net->node_birth[n + 1 + i] = i;
    }
    uint32_t e = 0;
    for (uint32_t i = 0; i < n; i++)
        put_edge(net, e++, i, i + 1, 1, 0, 0.5 + 0.1 * (n - i));
    for (uint32_t i = 0; i < n; i++) {
        put_edge(net, e++, i + 1, n + 1 + 2 * i, 2, i + 1, 0.5);
        put_edge(net, e++, n + 1 + 2 * i, n + 2 + 2 * i, 2, i + 1, 0.5);
    }
    put_edge(net, e, n + 2, n + 4, 3, n + 1, 0.3);
    net->kind[e] = EDGE_ANASTOMOSIS;
    Vec2 margin[] = {{0, 0}, {n / 2.0, n / 3.0}, {0.4, n + 1.0}, {-(n / 2.0), n / 3.0}};
    net->margin = polygon_new(margin, 4);
    return net;
}

static Frame frame_of(double size)
{
    return (Frame){.width = 400, .height = 500, .scale = 400 / size, .corner = {-size / 2, size * 1.2}};
}

static PaintStyle green(void)
{
    return (PaintStyle){.lamina = {0.0f, 0.2f, 1.0f}, .vein = {1.0f, 0.214041140f, 0.0f}};
}

/* Runs a command and returns its output; NULL when the program is not there, so that the test skips; it fails where VENATION_REQUIRE is all. */
static char *output_of(const char *const *argv)
{
    char *out = NULL, *err = NULL, *program = g_find_program_in_path(argv[0]);
    gboolean required = g_strcmp0(g_getenv("VENATION_REQUIRE"), "all") == 0;
    if (program == NULL && required)
        g_error("%s is not installed", argv[0]);
    if (program == NULL)
        return NULL;
    g_free(program);
    int status = 0;
    GError *error = NULL;
    g_spawn_sync(NULL, (char **)argv, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL, &out, &err, &status, &error);
    g_assert_no_error(error);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 77 && !required) {
        g_clear_pointer(&out, g_free);
    } else if (status != 0) {
        g_test_message("%s: %s%s", argv[0], out, err);
        g_assert_cmpint(status, ==, 0);
    }
    g_free(err);
    return out;
}

static void test_numbers(void)
{
    static const struct {
        double value;
        const char *text;
    } cases[] = {
        {0, "0"},
        {-0.0, "-0"},
        {1, "1"},
        {-17, "-17"},
        {0.1, "0.1"},
        {0.5, "0.5"},
        {1.0 / 3, "0.3333333333333333"},
        {0.1 + 0.2, "0.30000000000000004"},
        {1e15, "1e+15"},
        {123456789012345, "123456789012345"},
        {1e300, "1e+300"},
        {5e-324, "4.94065645841247e-324"},
        {-2.5e-7, "-2.5e-07"},
        {4294967295.0, "4294967295"},
        {G_MAXDOUBLE, "1.7976931348623157e+308"},
    };
    GString *s = g_string_new(NULL);
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        g_string_truncate(s, 0);
        export_number(s, cases[i].value);
        g_assert_cmpstr(s->str, ==, cases[i].text);
    }
    for (uint32_t i = 0; i < 100000; i++) { /* any bits at all read back */
        RandomBlock b = random_block(7, 1, 0, i);
        uint64_t bits = (uint64_t)b.w[0] << 32 | b.w[1];
        double value, back;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value))
            continue;
        g_string_truncate(s, 0);
        export_number(s, value);
        back = g_ascii_strtod(s->str, NULL);
        g_assert_cmpmem(&value, sizeof value, &back, sizeof back);
        g_assert_cmpuint(s->len, <=, 24);
    }
    g_string_free(s, TRUE);
}

/* Against printf, which rounds exactly and half to even; and numbers that lie just beside a half. */
static void test_millionths(void)
{
    GString *s = g_string_new(NULL);
    static const struct {
        double value;
        const char *text;
    } cases[] = {{0, "0"}, {-0.0, "0"}, {-1e-9, "0"}, {0.25, "0.25"}, {-3.0000004, "-3"}, {0.99999949, "0.999999"},
                 {0.99999951, "1"}, {-1234.5, "-1234.5"}, {999999999999.5, "999999999999.5"}, {1e12, "1000000000000"},
                 {5e-7, "0"}, {5.0000001e-7, "0.000001"}, {1e300, "1e+300"}, {0.0078125, "0.007812"}, {0.0234375, "0.023438"}};
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        g_string_truncate(s, 0);
        sink_millionths(s, cases[i].value);
        g_assert_cmpstr(s->str, ==, cases[i].text);
    }
    for (uint32_t i = 0; i < 200000; i++) {
        RandomBlock b = random_block(11, 1, 0, i);
        double value = (double)(int32_t)b.w[0] * (1.0 + b.w[1] * 0x1p-32) / (double)(UINT64_C(1) << b.w[2] % 50);
        if (b.w[2] >> 31) /* halves of a millionth and their neighbours */
            value = nextafter((b.w[0] % 10000000 + 0.5) * 1e-6, b.w[3] % 3 == 0 ? 0.0 : b.w[3] % 3 == 1 ? 100.0 : 50.0);
        char want[64];
        snprintf(want, sizeof want, "%.6f", value);
        char *end = want + strlen(want);
        while (end[-1] == '0')
            *--end = '\0';
        if (end[-1] == '.')
            *--end = '\0';
        g_string_truncate(s, 0);
        sink_millionths(s, value);
        g_assert_cmpstr(s->str, ==, strcmp(want, "-0") == 0 ? "0" : want);
    }
    g_string_truncate(s, 0);
    sink_size(s, 1.0 / 300);
    g_assert_cmpfloat(g_ascii_strtod(s->str, NULL), ==, 1.0 / 300); /* small sizes lose nothing */
    g_string_free(s, TRUE);
}

static void test_json(void)
{
    static const struct {
        const char *text, *json;
    } cases[] = {
        {"", "\"\""},
        {"Ginkgo", "\"Ginkgo\""},
        {"a\"b\\c/", "\"a\\\"b\\\\c/\""},
        {"\n\t\x01\x1f\r\b\f", "\"\\n\\t\\u0001\\u001f\\r\\b\\f\""},
        {"Alchémille \xe2\x88\x9e", "\"Alchémille \xe2\x88\x9e\""},
        {"\xff", "\"\xef\xbf\xbd\""},
        {NULL, "null"},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        GString *s = g_string_new(NULL);
        export_json_string(s, cases[i].text);
        g_assert_cmpstr(s->str, ==, cases[i].json);
        g_string_free(s, TRUE);
    }
}

static void test_text(void)
{
    GError *error = NULL;
    char *path = in_folder("text.txt");
    guint before = files_in(folder);
    const char bytes[] = "a\0b"; /* zero bytes too */
    g_assert_true(export_text(bytes, 3, path, &error));
    g_assert_true(export_text("second", 6, path, &error));
    gsize n;
    char *text = slurp(path, &n);
    g_assert_cmpmem(text, (int)n, "second", 6);
    g_assert_true(export_text(bytes, 3, path, NULL));
    g_free(text);
    text = slurp(path, &n);
    g_assert_cmpmem(text, (int)n, bytes, 3);
    g_assert_cmpuint(files_in(folder), ==, before + 1);
    GStatBuf st;
    g_assert_cmpint(g_stat(path, &st), ==, 0);
    mode_t mask = umask(0);
    umask(mask);
    g_assert_cmpuint(st.st_mode & 0777, ==, 0666 & ~mask); /* as any other file, not the 0600 of mkstemp */
    g_unlink(path);
    g_free(text);
    g_free(path);
}

static void expect_failure(const char *path, int code)
{
    Network *net = small_leaf(3);
    Frame frame = frame_of(8);
    PaintStyle style = green();
    guint before = files_in(folder);
    for (int i = 0; i < 5; i++) {
        GError *error = NULL;
        gboolean ok = i == 0   ? export_text("x", 1, path, &error)
                      : i == 1 ? export_svg(net, &frame, &style, "t", path, &error)
                      : i == 2 ? export_graphml(net, path, &error)
                      : i == 3 ? export_nodes_csv(net, path, &error)
                               : export_edges_csv(net, path, &error);
        g_assert_false(ok);
        g_assert_error(error, G_FILE_ERROR, code);
        g_assert_nonnull(strstr(error->message, path));
        g_error_free(error);
    }
    g_assert_cmpuint(files_in(folder), ==, before);
    network_free(net);
}

static void test_failures(void)
{
    char *file = in_folder("file"), *below = in_folder("file/x.svg"), *missing = in_folder("no/x.svg"),
         *dir = in_folder("dir");
    g_assert_true(export_text("x", 1, file, NULL));
    g_assert_cmpint(g_mkdir(dir, 0700), ==, 0);
    expect_failure(below, G_FILE_ERROR_NOTDIR);
    expect_failure(missing, G_FILE_ERROR_NOENT);
    expect_failure(dir, G_FILE_ERROR_ISDIR); /* fails at the rename */
    if (geteuid() != 0) {
        char *locked = in_folder("dir/x.svg");
        g_chmod(dir, 0500);
        expect_failure(locked, G_FILE_ERROR_ACCES);
        g_chmod(dir, 0700);
        g_assert_cmpuint(files_in(dir), ==, 0);
        g_free(locked);
    }
    g_rmdir(dir);
    g_unlink(file);
    g_free(file);
    g_free(below);
    g_free(missing);
    g_free(dir);
}

/* A file size limit stands in for a full disk: the write stops part of the way. */
static void test_full_disk(void)
{
    char *path = in_folder("big.graphml");
    g_assert_true(export_text("before", 6, path, NULL));
    Network *net = small_leaf(20000);
    guint before = files_in(folder);
    struct rlimit old, low;
    getrlimit(RLIMIT_FSIZE, &old);
    low = old;
    low.rlim_cur = 1500000;
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &low);
    GError *error = NULL;
    gboolean ok = export_graphml(net, path, &error);
    setrlimit(RLIMIT_FSIZE, &old);
    signal(SIGXFSZ, handler);
    g_assert_false(ok);
    g_assert_error(error, G_FILE_ERROR, (int)g_file_error_from_errno(EFBIG));
    g_error_free(error);
    g_assert_cmpuint(files_in(folder), ==, before);
    gsize n;
    char *text = slurp(path, &n);
    g_assert_cmpstr(text, ==, "before"); /* the former file is untouched */
    g_free(text);
    g_unlink(path);
    g_free(path);
    network_free(net);
}

static gboolean write_format(const Network *net, int format, const char *path)
{
    Frame frame = frame_of(8);
    PaintStyle style = green();
    switch (format) {
    case 0:
        return export_svg(net, &frame, &style, "Poplar", path, NULL);
    case 1:
        return export_graphml(net, path, NULL);
    case 2:
        return export_nodes_csv(net, path, NULL);
    default:
        return export_edges_csv(net, path, NULL);
    }
}

static void test_same_bytes(void)
{
    Network *net = small_leaf(50);
    char *a = in_folder("a"), *b = in_folder("elsewhere");
    for (int format = 0; format < 4; format++) {
        g_assert_true(write_format(net, format, a));
        if (setlocale(LC_ALL, "de_DE.UTF-8") == NULL)
            setlocale(LC_ALL, "");
        g_assert_true(write_format(net, format, b));
        setlocale(LC_ALL, "C");
        gsize na, nb;
        char *ta = slurp(a, &na), *tb = slurp(b, &nb);
        g_assert_cmpuint(na, ==, nb);
        g_assert_true(memcmp(ta, tb, na) == 0);
        g_free(ta);
        g_free(tb);
    }
    g_unlink(a);
    g_unlink(b);
    g_free(a);
    g_free(b);
    network_free(net);
}

static void test_tables(void)
{
    Network *net = small_leaf(40);
    char *path = in_folder("t.csv");
    g_assert_true(export_nodes_csv(net, path, NULL));
    gsize n;
    char *text = slurp(path, &n), **lines = g_strsplit(text, "\n", -1);
    g_assert_cmpuint(g_strv_length(lines), ==, net->n_nodes + 2); /* header, and nothing after the last newline */
    g_assert_cmpstr(lines[0], ==, "node,x,y,birth");
    for (uint32_t i = 0; i < net->n_nodes; i++) {
        char **f = g_strsplit(lines[i + 1], ",", -1);
        g_assert_cmpuint(g_strv_length(f), ==, 4);
        g_assert_cmpuint(g_ascii_strtoull(f[0], NULL, 10), ==, i);
        g_assert_cmpfloat(fabs(g_ascii_strtod(f[1], NULL) - net->node[i].x), <=, 0.5001e-6);
        g_assert_cmpfloat(fabs(g_ascii_strtod(f[2], NULL) - net->node[i].y), <=, 0.5001e-6);
        g_assert_cmpuint(g_ascii_strtoull(f[3], NULL, 10), ==, net->node_birth[i]);
        g_strfreev(f);
    }
    g_strfreev(lines);
    g_free(text);
    g_assert_true(export_edges_csv(net, path, NULL));
    text = slurp(path, &n);
    lines = g_strsplit(text, "\n", -1);
    g_assert_cmpuint(g_strv_length(lines), ==, net->n_edges + 2);
    g_assert_cmpstr(lines[0], ==, "tail,head,kind,order,rank,vein,width,flow,birth,length");
    for (uint32_t e = 0; e < net->n_edges; e++) {
        char **f = g_strsplit(lines[e + 1], ",", -1);
        g_assert_cmpuint(g_strv_length(f), ==, 10);
        const uint32_t whole[] = {net->tail[e], net->head[e], 0, net->order[e], net->rank[e], net->vein[e], 0, 0,
                                  net->birth[e]};
        for (int k = 0; k < 9; k++)
            if (k != 2 && k != 6 && k != 7)
                g_assert_cmpuint(g_ascii_strtoull(f[k], NULL, 10), ==, whole[k]);
        g_assert_cmpstr(f[2], ==, e + 1 == net->n_edges ? "anastomosis" : "vein");
        g_assert_cmpfloat(fabs(g_ascii_strtod(f[6], NULL) - net->width[e]), <=, 0.5001e-6);
        g_assert_cmpfloat(fabs(g_ascii_strtod(f[7], NULL) - net->flow[e]), <=, 0.5001e-6);
        double length = vec_dist(net->node[net->tail[e]], net->node[net->head[e]]);
        g_assert_cmpfloat(fabs(g_ascii_strtod(f[9], NULL) - length), <=, 0.5001e-6);
        g_strfreev(f);
    }
    g_strfreev(lines);
    g_free(text);
    g_unlink(path);
    g_free(path);
    network_free(net);
}

/* "name …" line of the script's report. */
static char *reported(char **lines, const char *name)
{
    gsize n = strlen(name);
    for (; *lines != NULL; lines++)
        if (strncmp(*lines, name, n) == 0 && (*lines)[n] == ' ')
            return *lines + n + 1;
    g_test_message("the report has no %s", name);
    g_assert_not_reached();
}

static void test_graphml(void)
{
    Network *net = small_leaf(40);
    char *path = in_folder("n.graphml"), *script = g_test_build_filename(G_TEST_DIST, "check_graphml.py", NULL);
    g_assert_true(export_graphml(net, path, NULL));
    const char *argv[] = {"/usr/bin/python3", script, path, NULL};
    char *out = output_of(argv);
    if (out != NULL) {
        char **l = g_strsplit(out, "\n", -1), *expected = g_strdup_printf("%u", net->n_nodes);
        g_assert_cmpstr(reported(l, "class"), ==, "DiGraph");
        g_assert_cmpstr(reported(l, "acyclic"), ==, "True"); /* base to extremities */
        g_assert_cmpstr(reported(l, "nodes"), ==, expected);
        g_free(expected);
        expected = g_strdup_printf("%u", net->n_edges);
        g_assert_cmpstr(reported(l, "edges"), ==, expected);
        g_free(expected);
        g_assert_cmpfloat(g_ascii_strtod(reported(l, "meshedness"), NULL), ==,
                          1.0 / (2.0 * net->n_nodes - 5.0)); /* one loop */
        static const char *const ints[] = {"node.birth", "edge.order", "edge.rank", "edge.vein", "edge.birth"};
        static const char *const floats[] = {"node.x", "node.y", "edge.width", "edge.flow", "edge.length"};
        for (int i = 0; i < 5; i++) {
            g_assert_true(g_str_has_prefix(reported(l, ints[i]), "int "));
            g_assert_true(g_str_has_prefix(reported(l, floats[i]), "float "));
        }
        g_assert_true(g_str_has_prefix(reported(l, "edge.kind"), "str "));
        g_assert_cmpstr(reported(l, "graph.steps"), ==, "int 40");
        g_assert_cmpstr(reported(l, "graph.margin"), ==, "str 0,0 20,13.333333 0.4,41 -20,13.333333");
        double y = 0, births = 0;
        for (uint32_t i = 0; i < net->n_nodes; i++) {
            y += net->node[i].y;
            births += net->node_birth[i];
        }
        g_assert_cmpfloat(fabs(g_ascii_strtod(reported(l, "node.y") + 6, NULL) - y), <, 1e-6 * net->n_nodes);
        g_assert_cmpfloat(g_ascii_strtod(reported(l, "node.birth") + 4, NULL), ==, births);
        g_strfreev(l);
        g_free(out);
    } else {
        g_test_message("no NetworkX: the file was not read back");
    }
    g_unlink(path);
    g_free(path);
    g_free(script);
    network_free(net);
}

/* The head of the file, with a margin and without, with a length and without. */
static void test_graphml_graph(void)
{
    Network *net = small_leaf(2);
    char *path = in_folder("g.graphml"), *text;
    for (int i = 0; i < 3; i++) {
        net->length = i == 0 ? 3.0000004 : 0.0;
        g_assert_true(export_graphml(net, path, NULL));
        text = slurp(path, NULL);
        const char *graph = strstr(text, "<graph ");
#define HEAD "<graph id=\"venation\" edgedefault=\"directed\">\n"
#define MARGIN "<data key=\"m\">0,0 1,0.666667 0.4,3 -1,0.666667</data>\n"
#define REST "<data key=\"s\">2</data>\n<node id=\"0\">"
        static const char *const head[] = {HEAD MARGIN "<data key=\"base\">0,0</data>\n<data key=\"tip\">0,3</data>\n" REST,
                                           HEAD MARGIN REST, HEAD REST};
        g_assert_true(g_str_has_prefix(graph, head[i]));
        g_assert_nonnull(strstr(text, "<key id=\"m\" for=\"graph\" attr.name=\"margin\" attr.type=\"string\"/>\n"
                                      "<key id=\"base\" for=\"graph\" attr.name=\"base\" attr.type=\"string\"/>\n"
                                      "<key id=\"tip\" for=\"graph\" attr.name=\"tip\" attr.type=\"string\"/>\n"
                                      "<key id=\"s\" for=\"graph\" attr.name=\"steps\" attr.type=\"int\"/>\n"));
        g_free(text);
        if (i == 1)
            g_clear_pointer(&net->margin, polygon_free);
    }
    g_unlink(path);
    g_free(path);
    network_free(net);
}

/* A length is that between its nodes as the file has them. */
static void test_graphml_lengths(void)
{
    enum { N = 2000 };
    Network *net = network_new(N, N - 1);
    for (uint32_t v = 0; v < N; v++) {
        double u[2];
        random_pair(3, 1, 0, v, u);
        net->node[v] = vec2(4000 * u[0], 4000 * u[1]);
        if (v % 2) /* just beside halves of a millionth */
            net->node[v].x = nextafter(floor(net->node[v].x * 1e6) * 1e-6 + 0.5e-6, v % 4 == 1 ? 0.0 : 1e9);
        if (v > 0) {
            net->tail[v - 1] = v - 1;
            net->head[v - 1] = v;
        }
    }
    char *path = in_folder("l.graphml"), *text, **x, **y, **length;
    g_assert_true(export_graphml(net, path, NULL));
    text = slurp(path, NULL);
    x = g_strsplit(text, "<data key=\"x\">", -1);
    y = g_strsplit(text, "<data key=\"y\">", -1);
    length = g_strsplit(text, "<data key=\"l\">", -1);
    GString *s = g_string_new(NULL);
    for (uint32_t e = 0; e + 1 < N; e++) {
        Vec2 a = vec2(g_ascii_strtod(x[e + 1], NULL), g_ascii_strtod(y[e + 1], NULL));
        Vec2 b = vec2(g_ascii_strtod(x[e + 2], NULL), g_ascii_strtod(y[e + 2], NULL));
        g_string_truncate(s, 0);
        sink_size(s, vec_dist(a, b));
        g_string_append(s, "</data></edge>");
        g_assert_true(g_str_has_prefix(length[e + 1], s->str));
    }
    g_string_free(s, TRUE);
    g_strfreev(x);
    g_strfreev(y);
    g_strfreev(length);
    g_free(text);
    g_unlink(path);
    g_free(path);
    network_free(net);
}

static guint count(const char *text, const char *what)
{
    guint n = 0;
    for (const char *at = text; (at = strstr(at, what)) != NULL; at += strlen(what))
        n++;
    return n;
}

static void assert_has(const char *text, const char *what)
{
    if (strstr(text, what) == NULL)
        g_error("not found: %s\nin:\n%s", what, text);
}

static void test_svg(void)
{
    Network *net = small_leaf(3);
    Frame frame = frame_of(8);
    PaintStyle style = green();
    char *path = in_folder("s.svg");
    g_assert_true(export_svg(net, &frame, &style, "A <leaf> & \"more\"\x01", path, NULL));
    gsize n;
    char *text = slurp(path, &n);
    assert_has(text, "width=\"400\" height=\"500\" viewBox=\"-4 -9.6 8 10\"");
    assert_has(text, "<title>A &lt;leaf&gt; &amp; &quot;more&quot; </title>");
    assert_has(text,
               "<path id=\"blade\" fill=\"#007cff\" d=\"M0,0 1.5,-1 0.4,-4 -1.5,-1Z\"/>"); /* linear 0.2 is sRGB 0x7c */
    assert_has(text,
               "<g id=\"order-1\" data-order=\"1\" inkscape:groupmode=\"layer\" inkscape:label=\"Order 1, primary\"");
    assert_has(
        text,
        "stroke-linecap=\"round\" stroke-linejoin=\"round\" stroke=\"#ff8000\" stroke-width=\"0.6\">"); /* 0.214 is 0x80
                                                                                                         */
    /* The midvein tapers by more than 3 % an edge: three pieces; the side veins are one piece each at the group's
     * width. */
    assert_has(text,
               "<path stroke-width=\"0.8\" d=\"M0,0 0.03,-1\"/>\n<path stroke-width=\"0.7\" d=\"M0.03,-1 0.13,-2\"/>\n"
               "<path d=\"M0.13,-2 0.3,-3\"/>\n</g>");
    assert_has(text, "<path d=\"M0.03,-1 0.33,-1.25 1.33,-1.35\"/>");
    g_assert_cmpuint(count(text, "<path"), ==, 1 + 3 + 3 + 1);
    g_assert_true(strstr(text, "order-3") < strstr(text, "order-2") &&
                  strstr(text, "order-2") < strstr(text, "order-1"));
    char *png = in_folder("s.png");
    const char *lint[] = {"xmllint", "--noout", path, NULL}, *render[] = {"rsvg-convert", "-o", png, path, NULL};
    g_free(output_of(lint));
    g_free(output_of(render));
    g_unlink(path);
    g_unlink(png);
    g_free(png);
    g_free(text);
    g_free(path);
    network_free(net);
}

/* Within 3 % a vein stays one path, beyond that it is cut; edges come in any order. */
static void test_svg_runs(void)
{
    Network *net = network_new(6, 5);
    net->n_veins = 1;
    static const double width[] = {1.0, 0.99, 0.975, 0.9, 0.89};
    for (uint32_t i = 0; i < 6; i++)
        net->node[i] = vec2(i, -0.004 * i);
    for (uint32_t i = 0; i < 5; i++)
        put_edge(net, 4 - i, i, i + 1, 1, 0, width[i]);
    Frame frame = frame_of(8);
    PaintStyle style = green();
    char *path = in_folder("r.svg");
    g_assert_true(export_svg(net, &frame, &style, NULL, path, NULL));
    gsize n;
    char *text = slurp(path, &n);
    assert_has(text, "<path stroke-width=\"0.988\" d=\"M0,0 1,0 2,0.01 3,0.01\"/>\n<path "
                     "d=\"M3,0.01 4,0.02 5,0.02\"/>\n");
    g_free(text);
    net->n_edges = 0; /* nothing grown yet */
    g_assert_true(export_svg(net, &frame, &style, NULL, path, NULL));
    text = slurp(path, &n);
    g_assert_null(strstr(text, "order-"));
    g_free(text);
    g_unlink(path);
    g_free(path);
    network_free(net);
}

/* Veins are cut off at the margin, and the veinlets of a crowded order share paths: none is lost, none is drawn twice. */
static void test_svg_crowd(void)
{
    Network *net = small_leaf(6000);
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->order[e] == 2)
            net->width[e] = 0.01 * (1 + net->vein[e] % 3);
    Frame frame = frame_of(8);
    PaintStyle style = green();
    char *path = in_folder("c.svg");
    g_assert_true(export_svg(net, &frame, &style, NULL, path, NULL));
    gsize n;
    char *text = slurp(path, &n), *order2 = strstr(text, "id=\"order-2\""), *order1 = strstr(text, "id=\"order-1\"");
    assert_has(text, "<clipPath id=\"inside\"><use href=\"#blade\"/></clipPath>\n<g id=\"veins\"");
    assert_has(text, "inkscape:label=\"Veins\" clip-path=\"url(#inside)\">");
    g_assert_true(order2 != NULL && order1 != NULL && order2 < order1);
    *order1 = '\0';
    g_assert_cmpuint(count(order2, "<path"), ==, 3 * 32); /* 2000 veins of each width, 64 a path */
    g_assert_cmpuint(count(order2, "M"), ==, 6000);
    g_assert_cmpuint(count(order2, " stroke-width=\"0.03\" d="), ==, 32);
    g_assert_cmpuint(count(order2, ","), ==, 1 + 3 * 6000); /* three points each, and one in the label */
    g_free(text);
    g_unlink(path);
    g_free(path);
    network_free(net);
}

/* A million edges: only with -m perf. */
static void test_speed(void)
{
    Network *net = small_leaf(333333);
    for (uint32_t i = 0; i < net->n_nodes; i++) {
        double r[2];
        random_pair(1, 1, 0, i, r);
        net->node[i] = vec2(3000 * (r[0] - 0.5), 3000 * r[1]);
    }
    static const char *const name[] = {"speed.svg", "speed.graphml", "speed_nodes.csv", "speed_edges.csv"};
    for (int format = 0; format < 4; format++) {
        char *path = in_folder(name[format]);
        g_test_timer_start();
        g_assert_true(write_format(net, format, path));
        double seconds = g_test_timer_elapsed();
        GStatBuf st;
        g_stat(path, &st);
        g_test_minimized_result(seconds, "%s: %.2f s, %.1f MB", name[format], seconds, (double)st.st_size / 1e6);
        g_test_message("%s: %.2f s, %.1f MB", name[format], seconds, (double)st.st_size / 1e6);
        g_unlink(path);
        g_free(path);
    }
    network_free(net);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    folder = g_dir_make_tmp("venation-export-XXXXXX", NULL);
    g_test_add_func("/export/numbers", test_numbers);
    g_test_add_func("/export/millionths", test_millionths);
    g_test_add_func("/export/json", test_json);
    g_test_add_func("/export/text", test_text);
    g_test_add_func("/export/failures", test_failures);
    g_test_add_func("/export/full-disk", test_full_disk);
    g_test_add_func("/export/same-bytes", test_same_bytes);
    g_test_add_func("/export/tables", test_tables);
    g_test_add_func("/export/graphml", test_graphml);
    g_test_add_func("/export/graphml-graph", test_graphml_graph);
    g_test_add_func("/export/graphml-lengths", test_graphml_lengths);
    g_test_add_func("/export/svg", test_svg);
    g_test_add_func("/export/svg-runs", test_svg_runs);
    g_test_add_func("/export/svg-crowd", test_svg_crowd);
    if (g_test_perf())
        g_test_add_func("/export/speed", test_speed);
    int result = g_test_run();
    g_assert_cmpuint(files_in(folder), ==, 0);
    g_rmdir(folder);
    g_free(folder);
    return result;
}
