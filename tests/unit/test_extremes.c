/* Random points of the whole parameter table: each leaf is grown, shaped and written, or refused with a reason, in bounded time and memory, and no number
 * that comes out, to its last file, is infinite or none. Three points of four are small leaves, whose runs must end by themselves; the others may be of any
 * size, and must be ready to stop.
 *
 *     test_extremes                   some hundred points
 *     test_extremes -n 5000 -f 1000   so many, from that one on, with more time for each; of a single one all settings are told
 *     test_extremes -n 5000 -t 60     all of them may grow for so many seconds, before they are told to stop
 *
 * A point that fails is told by the few settings that it takes. */
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "../fuzz/sound.h"
#include "finite.h"
#include "geom/random.h"
#include "lib/settings.h"
#include "lib/shape.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define __SANITIZE_ADDRESS__ 1
#endif
#endif
#ifdef __SANITIZE_ADDRESS__
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

/* What became of a point: exit statuses of its child. */
enum { DONE = 0, REFUSED = 10, STOPPED = 11, BROKEN = 12, ENDLESS = 13 }; /* statuses 2 … 9 are sanitizers' */

/* ---- points ---- */

typedef struct {
    uint64_t index;
    uint32_t n; /* random numbers drawn */
} Dice;

static double throw(Dice *d)
{
    double u[2];
    random_pair(2005, 7, d->n++, d->index, u);
    return u[0];
}

static uint32_t throw_below(Dice *d, uint32_t n) { return MIN((uint32_t)(throw(d) * n), n - 1); }

static double power_of_ten(double x)
{
    char text[32];
    g_snprintf(text, sizeof text, "1e%d", (int)floor(x));
    return g_ascii_strtod(text, NULL) * (1.0 + 9.0 * (x - floor(x)));
}

/* A number of a range: its ends, nothing, something tiny or huge, any order of magnitude, anything. */
static double number_between(Dice *d, double low, double high)
{
    double tiny = low > 0.0 ? log10(low) : -12.0, huge = high > 0.0 ? log10(high) : 0.0, v;
    switch (throw_below(d, 8)) {
    case 0:
        return low;
    case 1:
        return high;
    case 2:
        v = 0.0;
        break;
    case 3:
        v = 1.0;
        break;
    case 4:
        v = low + (high - low) * throw(d);
        break;
    case 5:
        v = low < 0.0 ? -power_of_ten(tiny + throw(d) * (log10(-low) - tiny)) : power_of_ten(tiny + throw(d));
        break;
    default:
        v = power_of_ten(tiny + throw(d) * (huge - tiny));
    }
    return CLAMP(v, low, high);
}

/* Where small leaves keep to, so that they are small. */
typedef struct {
    ParamId id;
    double low, high;
    bool always; /* the default is too large */
} Tame;
static const Tame tame[] = {
    {PARAM_GROWTH_INITIAL_LENGTH, 1, 30, true}, {PARAM_GROWTH_FINAL_LENGTH, 30, 45, true}, {PARAM_GROWTH_STEP, 0.5, 1e6, true},
    {PARAM_GROWTH_STEPS, 0, 30, true},          {PARAM_TEXTURE_SIZE, 16, 80, true},        {PARAM_SOURCES_DENSITY, 0, 1, false},
    {PARAM_MESH_MAX_AREA, 0.001, 1, true},      {PARAM_MESH_TOLERANCE, 1e-3, 0.1, false},  {PARAM_MESH_SPACING, 0.01, 1, false},
    {PARAM_MESH_CLEARANCE, 2e-3, 0.1, false},   {PARAM_VEINS_SEED_ROW, 0, 40, false},      {PARAM_OUTLINE_FLATNESS, 1e-3, 0.1, true},
    {PARAM_OUTLINE_TEETH_COUNT, 0, 40, false},  {PARAM_EXPORT_RIG_JOINTS, 0, 9, false},    {PARAM_MESH_LEVELS, 1, 4, false},
    {PARAM_TEXTURE_PADDING, 0, 100, false},
};

static const Tame *tame_find(ParamId id)
{
    for (guint i = 0; i < G_N_ELEMENTS(tame); i++)
        if (tame[i].id == id)
            return &tame[i];
    return NULL;
}

/* Texts that keys may have; "" ends a list. Files lie in the folder of the tests. */
typedef struct {
    ParamId id;
    const char *text[9];
} Texts;
static const Texts texts[] = {
    {PARAM_LEAF_TITLE, {"a <b> & \"c\" 'd' ]]> é \\", "0"}},
    {PARAM_OUTLINE_PATH,
     {"M0 0C.3 .1 .3 .6 0 1 -.3 .6 -.3 .1 0 0Z", "M0 0L1 0 1 1 0 1Z", "M0 0L.02 .5 0 1 -.02 .5Z", "M0 0L.1 .1.5-.1.4.3.9.6.3.5.2.9.1.6 0 1-.1.6-.2.9-.3.5-.9.6-.4.3-.5-.1-.1 .1Z",
      "M0 0L1e-9 5e8 1 1e9 2e8 5e8Z", "M0 0L1 1 0 1 1 0Z", "M0 0C.4 .2.4.8 0 1", "M-1 0A1 1 0 0 1 1 0 1 1 0 0 1-1 0Z"}},
    {PARAM_OUTLINE_FILE, {"../../params/outlines/ginkgo.svg", "../fuzz/corpus/outline/shapes.svg", "../../params/outlines/trillium.svg", "nowhere.svg"}},
    {PARAM_SCAN_FILE, {"../fuzz/corpus/image/leaf.png", "../fuzz/corpus/image/leaf.png", "../fuzz/corpus/image/rgb.jpg"}},
    {PARAM_SCAN_BACK, {"../fuzz/corpus/image/leaf.png"}},
    {PARAM_SOURCES_FILE, {"../fuzz/corpus/sources/listed.csv"}},
    {PARAM_VEINS_DRAWING, {"../fuzz/corpus/drawing/layers.svg", "../fuzz/corpus/drawing/lines.txt"}},
    {PARAM_LSYSTEM_AXIOM, {"F", "[+L][-R]V", "FffF|F", "+", "F[!F[!F]]@@@@F"}},
    {PARAM_LSYSTEM_PRODUCTIONS, {"F=FF", "F=F[+F]F[-F]F", "V=F[+L][-R]V; L=FL; R:0.5=R;R:2=FR", "F=", "F=F+F-"}},
    {PARAM_LSYSTEM_DRAWS, {"VLR", "+"}},
    {PARAM_TEXTURE_MAPS, {"all", "none", "base_color", "height normal_gl ao", "vein_id age distance", "bark"}},
    {PARAM_MESH_FICTITIOUS, {"0,0.35 0.1,0.42", "0,0 0,0", "0,0.5 1e30,0.5; 0,0.1 0.01,0.1"}},
    {PARAM_POSE_RULES, {"midrib lift -40", "all turn 3600; all lift -3600", "order 2 fold 90; L1 rotate 0,0,0 4", "midrib spline 0.5,1e9,0,1e-9 1,0,0,0", "L* lift"}},
    {PARAM_POSE_KEYFRAMES, {"0 blend=0; 2 blend=1", "0 preset=flat; 1e-9 preset=withered age=1; 1e9 strength=-10", "0"}},
    {PARAM_EXPORT_MODELS, {"all", "none", "glb ply", "obj,pov", "stl"}},
};

static char *text_of(Dice *d, const ParamInfo *info, ParamId id)
{
    for (guint i = 0; i < G_N_ELEMENTS(texts); i++) {
        uint32_t n = 0;
        if (texts[i].id != id)
            continue;
        while (n < G_N_ELEMENTS(texts[i].text) && texts[i].text[n])
            n++;
        const char *text = texts[i].text[throw_below(d, n)];
        return info->type == TYPE_FILE ? g_test_build_filename(G_TEST_DIST, text, NULL) : g_strdup(text);
    }
    return g_strdup("");
}

static void append_number(GString *s, double v)
{
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    g_string_append(s, g_ascii_formatd(text, sizeof text, "%.12g", v));
}

/* Coordinates: mostly of a leaf, now and then of none. Rates of growth ascend, mostly. */
static void append_points(GString *s, Dice *d, ParamId id)
{
    bool rates = id == PARAM_GROWTH_RATE_X || id == PARAM_GROWTH_RATE_Y;
    uint32_t n = rates ? 1 + throw_below(d, 3) : id == PARAM_VEINS_SEEDS || !throw_below(d, 8) ? throw_below(d, 4) : 1;
    double wild = throw_below(d, 5) ? 1.0 : number_between(d, 0.0, 1e12);
    for (uint32_t i = 0; i < n; i++) {
        g_string_append(s, i ? "; " : "");
        append_number(s, rates ? i * 0.4 : wild * (throw(d) - 0.5));
        g_string_append_c(s, ',');
        append_number(s, rates ? (throw(d) - 0.3) * (throw_below(d, 4) ? 0.05 : 2.0) : wild * throw(d));
    }
}

static char *value_of(Dice *d, ParamId id, bool small)
{
    const ParamInfo *info = param_info(id);
    const Tame *t = small ? tame_find(id) : NULL;
    double low = t ? t->low : info->low, high = t ? t->high : info->high;
    GString *s = g_string_new(NULL);
    char **words, *text;
    switch (info->type) {
    case TYPE_NUMBER:
        append_number(s, number_between(d, low, high));
        break;
    case TYPE_INTEGER:
        append_number(s, floor(number_between(d, low, high)));
        break;
    case TYPE_SWITCH:
        g_string_append(s, throw_below(d, 2) ? "yes" : "no");
        break;
    case TYPE_CHOICE:
        words = g_strsplit(info->choices, "|", -1);
        g_string_append(s, words[throw_below(d, g_strv_length(words))]);
        g_strfreev(words);
        break;
    case TYPE_TEXT:
    case TYPE_FILE:
        text = text_of(d, info, id);
        g_string_append(s, text);
        g_free(text);
        break;
    case TYPE_COLOUR:
        g_string_append_printf(s, "#%06x", throw_below(d, 1 << 24));
        break;
    case TYPE_NUMBERS:
        for (uint32_t i = throw_below(d, 12) ? 1 : 0; i < 3; i++) { /* mostly two: lists must be as long as each other */
            append_number(s, number_between(d, low, high));
            g_string_append(s, i < 2 ? "; " : "");
        }
        break;
    case TYPE_POINTS:
        append_points(s, d, id);
        break;
    }
    return g_string_free(s, FALSE);
}

static void set(GPtrArray *point, ParamId id, const char *value)
{
    g_ptr_array_add(point, g_strdup_printf("%s.%s=%s", param_info(id)->section, param_info(id)->key, value));
}

static bool is_set(const GPtrArray *point, ParamId id)
{
    char *key = g_strdup_printf("%s.%s=", param_info(id)->section, param_info(id)->key);
    bool found = false;
    for (guint i = 0; i < point->len; i++)
        found |= g_str_has_prefix(point->pdata[i], key);
    g_free(key);
    return found;
}

static bool is_small(uint64_t index) { return index % 4 != 1; }

/* Settings "section.key=value". Few keys or many; files and texts more rarely, as they shut out so much else. */
static GPtrArray *point_new(uint64_t index)
{
    Dice d = {index, 0};
    bool small = is_small(index), large = index % 16 == 1 && index > 1000;
    GPtrArray *point = g_ptr_array_new_with_free_func(g_free);
    double often = 0.02 + 0.5 * throw(&d) * throw(&d);
    for (int id = 0; id < PARAM_COUNT; id++) {
        const ParamInfo *info = param_info((ParamId)id);
        bool rare = info->type == TYPE_FILE || info->type == TYPE_TEXT || info->type == TYPE_POINTS || id == PARAM_SCAN_LEAF ||
                    id == PARAM_SOURCES_PLACEMENT || id == PARAM_VEINS_SEED_ROW;
        const Tame *t = tame_find((ParamId)id);
        bool teeth = id == PARAM_OUTLINE_TEETH_COUNT && is_set(point, PARAM_OUTLINE_TEETH_AMPLITUDE);
        if (id == PARAM_OUTLINE_TEETH_COUNT && !teeth && throw_below(&d, 20))
            continue;
        bool always = (small && t && t->always) || id == PARAM_TEXTURE_SIZE || teeth;
        if (large && (id == PARAM_TEXTURE_MAPS || id == PARAM_TEXTURE_EXR)) { /* one map tells enough of the size */
            set(point, (ParamId)id, id == PARAM_TEXTURE_MAPS ? "opacity" : "none");
            continue;
        }
        if (!always && throw(&d) >= (rare ? 0.3 * often : often))
            continue;
        char *value = value_of(&d, (ParamId)id, small || (id == PARAM_TEXTURE_SIZE && !large));
        set(point, (ParamId)id, value);
        g_free(value);
    }
    return point;
}

/* ---- what comes out ---- */

void fuzz_broken(const char *promise, const char *file, int line)
{
    fprintf(stderr, "%s:%d: broken: %s\n", file, line, promise);
    fflush(NULL);
    _exit(BROKEN);
}

/* "nan" or "inf" that is no part of a word. */
static void check_text(const char *path, const char *text)
{
    static const char *const bad[] = {"nan", "inf", "NaN", "Infinity"};
    for (guint i = 0; i < G_N_ELEMENTS(bad); i++)
        for (const char *at = strstr(text, bad[i]); at; at = strstr(at + 1, bad[i]))
            if ((at == text || !g_ascii_isalpha(at[-1])) && !g_ascii_isalpha(at[strlen(bad[i])])) {
                fprintf(stderr, "%s: …%.60s\n", path, MAX(text, at - 30));
                require(!"a number that is none");
            }
}

static bool is_text(const char *name)
{
    static const char *const suffix[] = {".svg", ".graphml", ".csv", ".json", ".obj", ".mtl", ".pov", ".inc", ".glb"};
    for (guint i = 0; i < G_N_ELEMENTS(suffix); i++)
        if (g_str_has_suffix(name, suffix[i]))
            return true;
    return false;
}

/* Of all files of a folder. */
static void check_files(const char *folder)
{
    GDir *dir = g_dir_open(folder, 0, NULL);
    for (const char *name; dir && (name = g_dir_read_name(dir)) != NULL;) {
        char *path = g_build_filename(folder, name, NULL), *text = NULL;
        bool glb = g_str_has_suffix(name, ".glb"), ply = g_str_has_suffix(name, ".ply");
        gsize size = 0;
        require(!strstr(name, ".tmp"));
        if (is_text(name) || ply)
            require(g_file_get_contents(path, &text, &size, NULL));
        if (is_text(name))
            check_text(path, glb ? text + 20 : text); /* of a glTF its JSON, which ends at the next chunk's zero bytes at the latest */
        if (glb)
            finite_glb(text, size);
        if (ply)
            finite_ply(text, size);
        if (g_str_has_suffix(name, ".exr"))
            finite_exr(path);
        g_free(text);
        g_free(path);
    }
    if (dir)
        g_dir_close(dir);
}

static void check_maps(const VenLeaf *leaf)
{
    Frame frame = frame_fit(leaf->net->margin->box, 48, true, 0.02);
    PaintStyle style = settings_style(leaf->params, leaf->seed, 1);
    Painter *painter = painter_new(leaf->net, &frame, &style);
    for (int id = 0; id < MAP_COUNT; id++) {
        Plane *plane = painter_paint(painter, (MapId)id);
        for (gsize i = 0; i < (gsize)plane->width * plane->height * plane->channels; i++)
            require(isfinite(plane->px[i]));
        require(isfinite(plane->low) && isfinite(plane->high));
        plane_free(plane);
    }
    painter_free(painter);
}

static void check_surface(const Surface *s)
{
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        Vec3 a = s->place[i], n = s->normal[i];
        require(isfinite(a.x) && isfinite(a.y) && isfinite(a.z) && isfinite(n.x) && isfinite(n.y) && isfinite(n.z));
        require(isfinite(s->uv[i].x) && isfinite(s->uv[i].y));
    }
}

/* An error must be one that people can act on. */
static int refused(GError *error)
{
    require(error != NULL && g_utf8_validate(error->message, -1, NULL) && strlen(error->message) > 10);
    fprintf(stderr, "refused: %s\n", error->message);
    check_text("message", error->message);
    int status = g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED) ? STOPPED : REFUSED;
    g_error_free(error);
    return status;
}

/* ---- one point, in a child ---- */

typedef struct {
    clock_t until;
    uint32_t steps;
} Patience;

static gboolean go_on(const VenProgress *progress, gpointer user)
{
    Patience *p = user;
    p->steps++;
    require(isfinite(progress->length) && progress->done >= 0.0 && progress->done <= 1.0);
    return clock() < p->until;
}

/* Or not: not every leaf has veins that can carry it. */
static void shape_leaf(const VenLeaf *leaf, const char *folder)
{
    GError *error = NULL;
    VenShape *shape = ven_shape(leaf, &error);
    if (!shape) {
        refused(error);
        return;
    }
    check_surface(shape->bent.blade);
    if (shape->bent.veins)
        check_surface(shape->bent.veins);
    for (uint32_t i = 0; i < ven_shape_vertices(shape); i++) {
        double at[3], normal[3];
        ven_shape_vertex(shape, i, at, normal);
        require(isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2]));
        require(fabs(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2] - 1.0) < 1e-9);
    }
    for (uint32_t t = 0; t < ven_shape_triangles(shape); t++) {
        uint32_t v[3];
        ven_shape_triangle(shape, t, v);
        require(v[0] < ven_shape_vertices(shape) && v[1] < ven_shape_vertices(shape) && v[2] < ven_shape_vertices(shape) && v[0] != v[1] && v[1] != v[2]);
    }
    if (ven_shape_write(shape, folder, "shape", &error))
        check_files(folder);
    if (error)
        refused(error);
    ven_shape_free(shape);
}

static int try_leaf(const VenParams *params, const char *folder, bool small, double seconds)
{
    /* no leaf of 45 segments takes so many steps but by growth, or for darts that fall so seldom */
    const uint32_t most_steps = 100000;
    GError *error = NULL;
    clock_t start = clock();
    Patience patience = {start + (clock_t)(seconds * CLOCKS_PER_SEC), 0};
    VenOptions options = {.threads = 1, .progress = go_on, .user = &patience};
    VenLeaf *leaf = ven_grow(params, 1, &options, &error);
    fprintf(stderr, "%u steps in %.2f s\n", patience.steps, (double)(clock() - start) / CLOCKS_PER_SEC);
    require(!small || patience.steps < most_steps);
    if (!leaf) {
        int status = refused(error);
        return small && status == STOPPED ? ENDLESS : status;
    }
    sound_network(leaf->net);
    check_maps(leaf);
    int status = DONE;
    if (ven_write(leaf, folder, "leaf", &error)) {
        check_files(folder);
        double area = params_number(params->values, PARAM_MESH_MAX_AREA);
        bool wide = params_integer(params->values, PARAM_TEXTURE_SIZE) > 4000; /* models hold their maps in memory: 144 bytes a pixel */
        if ((area >= 1e-4 || area == 0.0) && !wide)
            shape_leaf(leaf, folder);
    } else {
        status = refused(error);
    }
    ven_leaf_free(leaf);
    return status;
}

static int try_settings(const GPtrArray *point, const char *folder, bool small, double seconds)
{
    VenParams *params = ven_params_new();
    GError *error = NULL;
    int status = DONE;
    for (guint i = 0; status == DONE && i < point->len; i++)
        if (!params_override(params->values, point->pdata[i], &error))
            status = refused(error);
    if (status == DONE)
        status = try_leaf(params, folder, small, seconds);
    ven_params_free(params);
    return status;
}

/* ---- many points ---- */

typedef struct {
    double small, large; /* seconds for which leaves may grow */
    rlim_t seconds;      /* of a child */
    char *folder;        /* that children write to */
} Trial;

static void empty_folder(const char *folder)
{
    GDir *dir = g_dir_open(folder, 0, NULL);
    for (const char *name; dir && (name = g_dir_read_name(dir)) != NULL;) {
        char *path = g_build_filename(folder, name, NULL);
        g_unlink(path);
        g_free(path);
    }
    if (dir)
        g_dir_close(dir);
}

/* The wait status of a child that tries the settings; what it says is in <folder>/said. */
static int try_apart(const Trial *t, const GPtrArray *point, bool small, rlim_t seconds)
{
    empty_folder(t->folder);
    char *said = g_build_filename(t->folder, "said", NULL);
    fflush(NULL);
    pid_t child = fork();
    g_assert_cmpint(child, >=, 0);
    if (child == 0) {
        struct rlimit cpu = {seconds, seconds + 1}, memory = {(rlim_t)3 << 30, (rlim_t)3 << 30}, core = {0, 0};
        setrlimit(RLIMIT_CPU, &cpu);
        setrlimit(RLIMIT_CORE, &core);
        if (!SANITIZED) /* sanitizers reserve terabytes */
            setrlimit(RLIMIT_AS, &memory);
        if (!freopen(said, "w", stderr) || dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
            _exit(BROKEN);
        signal(SIGTRAP, SIG_DFL);
        int status = try_settings(point, t->folder, small, small ? t->small : t->large);
        fflush(NULL);
        _exit(status);
    }
    int status;
    g_assert_cmpint(waitpid(child, &status, 0), ==, child);
    g_free(said);
    return status;
}

static bool is_fine(int status)
{
    return WIFEXITED(status) && (WEXITSTATUS(status) == DONE || WEXITSTATUS(status) == REFUSED || WEXITSTATUS(status) == STOPPED);
}

/* Leaves out settings, many and then few at a time, as long as it fails likewise; in a shorter time, else what hangs would take for ever. */
static void shrink(const Trial *t, GPtrArray *point, bool small, int status)
{
    const rlim_t seconds = SANITIZED ? 60 : 6;
    for (guint run = point->len; run > 0; run /= 2)
        for (guint at = 0; at < point->len;) {
            GPtrArray *rest = g_ptr_array_new();
            for (guint i = 0; i < point->len; i++)
                if (i < at || i >= at + run)
                    g_ptr_array_add(rest, point->pdata[i]);
            if (try_apart(t, rest, small, seconds) == status)
                g_ptr_array_remove_range(point, at, MIN(run, point->len - at));
            else
                at += run;
            g_ptr_array_unref(rest);
        }
    try_apart(t, point, small, seconds);
}

/* What the last child said. Free it. */
static char *last_words(const Trial *t)
{
    char *said = g_build_filename(t->folder, "said", NULL), *text = NULL;
    if (!g_file_get_contents(said, &text, NULL, NULL))
        text = g_strdup("");
    g_free(said);
    return text;
}

static void tell(const Trial *t, uint64_t index, const GPtrArray *point, int status)
{
    char *text = last_words(t);
    GString *s = g_string_new(NULL);
    g_string_append_printf(s, "point %" G_GUINT64_FORMAT " %s %d:", index, WIFSIGNALED(status) ? "ended by signal" : "ended with status",
                           WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
    for (guint i = 0; i < point->len; i++)
        g_string_append_printf(s, " --set '%s'", (char *)point->pdata[i]);
    g_string_append_printf(s, "\n%.600s", text);
    char **line = g_strsplit(s->str, "\n", -1);
    for (char **l = line; *l; l++)
        g_test_message("%s", *l);
    g_strfreev(line);
    g_free(text);
    g_string_free(s, TRUE);
}

static uint64_t from, count = 160;
static double patience;
static bool by_hand;

static Trial trial_begin(void)
{
    GError *error = NULL;
    double slow = SANITIZED ? 8.0 : 1.0;
    Trial t = {.small = (by_hand ? 20.0 : 10.0) * slow, .large = by_hand ? 1.0 : 0.1};
    if (patience > 0.0)
        t.small = t.large = patience;
    t.seconds = (rlim_t)((by_hand ? 40.0 : 20.0) * slow + patience);
    t.folder = g_dir_make_tmp("venation-extremes-XXXXXX", &error);
    g_assert_no_error(error);
    return t;
}

static void trial_end(Trial *t)
{
    empty_folder(t->folder);
    g_rmdir(t->folder);
    g_free(t->folder);
}

static void test_points(void)
{
    Trial t = trial_begin();
    uint32_t became[3] = {0}, failed = 0;
    for (uint64_t i = from; i < from + count; i++) {
        GPtrArray *point = point_new(i);
        gint64 start = g_get_monotonic_time();
        int status = try_apart(&t, point, is_small(i), t.seconds);
        double took = (double)(g_get_monotonic_time() - start) * 1e-6;
        if (!is_fine(status)) {
            failed++;
            if (by_hand)
                tell(&t, i, point, status);
            shrink(&t, point, is_small(i), status);
            tell(&t, i, point, status);
        } else {
            if (by_hand && count == 1)
                tell(&t, i, point, status);
            became[WEXITSTATUS(status) == DONE ? 0 : WEXITSTATUS(status) - REFUSED + 1]++;
        }
        if (by_hand) {
            char *said = last_words(&t);
            g_test_message("%" G_GUINT64_FORMAT ": %.1f s %s", i, took, g_strdelimit(g_strchomp(said), "\n", ' '));
            g_free(said);
        }
        g_ptr_array_unref(point);
    }
    g_test_message("%u leaves were made, %u refused, %u stopped, %u failed", became[0], became[1], became[2], failed);
    trial_end(&t);
    g_assert_cmpuint(failed, ==, 0);
    g_assert_true(became[0] > count / 10 || count < 100); /* else nothing much was tried */
}

/* Points that failed once, shrunk. */
static void test_found(void)
{
    static const char *const found[][5] = {
        {"growth.initial_length=30", "growth.final_length=30", "sources.birth_distance_sources=0", "veins.sinus_depth=0"}, /* never ended */
        {"growth.final_length=40", "growth.kind=nonuniform", "growth.rate_y=0,0.03; 0.4,-0.3"},    /* a blade that shrank to nothing */
        {"growth.initial_length=20", "growth.kind=nonuniform", "growth.steps=1000000", "growth.rate_x=0,9"}, /* and one beyond all bounds */
        {"growth.initial_length=20", "growth.kind=none", "texture.size=16384", "texture.maps=none", "export.veins_image=no"}, /* 36 GiB of maps */
        {"growth.initial_length=1000", "growth.final_length=1000", "sources.density=99", "sources.birth_distance_sources=0", "veins.pattern=open"}, /* memory */
        {"growth.initial_length=400", "growth.final_length=400", "sources.density=30", "sources.birth_distance_sources=0", "veins.pattern=open"}, /* likewise, at length */
        {"growth.initial_length=20", "growth.final_length=40", "width.minimum=1000000", "texture.size=16", "texture.exr=half"}, /* more than a half can hold */
    };
    Trial t = trial_begin();
    for (guint i = 0; i < G_N_ELEMENTS(found); i++) {
        GPtrArray *point = g_ptr_array_new();
        for (guint k = 0; k < G_N_ELEMENTS(found[i]) && found[i][k]; k++)
            g_ptr_array_add(point, (gpointer)found[i][k]);
        int status = try_apart(&t, point, true, t.seconds);
        if (!is_fine(status))
            tell(&t, i, point, status);
        g_assert_true(is_fine(status) && WEXITSTATUS(status) != STOPPED);
        g_ptr_array_unref(point);
    }
    trial_end(&t);
}

/* Runs that would last for days are refused, with the key that makes them. */
static void test_endless(void)
{
    static const char *const endless[][6] = {
        {"growth.initial_length=5", "growth.step=1e-3", "sources.density=99", "is refused: sources.density"},
        {"sources.density=1e-7", "sources.birth_distance_veins=0", "veins.kill_distance=1e-3", "is refused: sources.density"},
        {"growth.initial_length=1e5", "growth.final_length=1e5", "sources.density=1e-9", "is refused: sources.density"},
        {"growth.step=1e-6", "growth.final_length=5000", "is refused: growth.step"},
    };
    Trial t = trial_begin();
    for (guint i = 0; i < G_N_ELEMENTS(endless); i++) {
        GPtrArray *point = g_ptr_array_new();
        guint k = 0;
        for (; !g_str_has_prefix(endless[i][k], "is "); k++)
            g_ptr_array_add(point, (gpointer)endless[i][k]);
        int status = try_apart(&t, point, false, t.seconds);
        char *text = last_words(&t);
        g_test_message("%s", text);
        g_assert_true(WIFEXITED(status) && WEXITSTATUS(status) == REFUSED && strstr(text, endless[i][k] + strlen("is ")));
        g_free(text);
        g_ptr_array_unref(point);
    }
    trial_end(&t);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    for (int i = 1; i + 1 < argc; i += 2) {
        by_hand = true;
        if (strcmp(argv[i], "-n") == 0)
            count = g_ascii_strtoull(argv[i + 1], NULL, 10);
        else if (strcmp(argv[i], "-f") == 0)
            from = g_ascii_strtoull(argv[i + 1], NULL, 10);
        else if (strcmp(argv[i], "-t") == 0)
            patience = g_ascii_strtod(argv[i + 1], NULL);
    }
    if (!by_hand) {
        g_test_add_func("/extremes/found", test_found);
        g_test_add_func("/extremes/endless", test_endless);
    }
    g_test_add_func("/extremes/points", test_points);
    return g_test_run();
}
