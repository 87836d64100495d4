/* venation capture: outline and veins of a real leaf from its scan. */
#include <stdio.h>
#include <string.h>

#include "cli/run.h"

typedef struct {
    RunArgs run;
    gboolean each, table;
    char *params, *back, *drawing, *method, *maps;
} CaptureArgs;

#define FIELD(name) (gpointer) offsetof(CaptureArgs, name)
static const GOptionEntry options[] = {
    RUN_OPTIONS,
    {"params", 0, 0, G_OPTION_ARG_FILENAME, FIELD(params), "Parameter file to begin from (default: the defaults for a scan)", "PARAMS"},
    {"method", 0, 0, G_OPTION_ARG_FILENAME, FIELD(method),
     "How the outline is found, as --set scan.method: by threshold, or by edges, corners and curves", "contour|fang"},
    {"back", 0, 0, G_OPTION_ARG_FILENAME, FIELD(back), "Scan of the shadow side, as --set scan.back", "IMAGE"},
    {"drawing", 0, 0, G_OPTION_ARG_FILENAME, FIELD(drawing), "Drawn veins instead of those found in the scan, as --set veins.drawing",
     "DRAWING"},
    {"maps", 0, 0, G_OPTION_ARG_FILENAME, FIELD(maps), "Maps to paint: all, none, or names parted by commas, as --set texture.maps", "LIST"},
    {"each", 0, 0, G_OPTION_ARG_NONE, FIELD(each), "Capture every leaf of the image, as NAME_1, NAME_2 … from the largest on", NULL},
    {"table", 0, 0, G_OPTION_ARG_NONE, FIELD(table),
     "Only print how many nodes the outline has for squares of 1 to 16 pixels and tolerances of 0 to 16; with method fang, what each edge "
     "operator finds and how well, and how far the curves are off", NULL},
    {0},
};

typedef struct {
    Run run;
    const CaptureArgs *args;
    VenScan *sheet; /* with --each, else NULL */
    guint32 leaves;  /* of the image; 1 without --each */
} Capture;

static gboolean set_option(Run *run, const char *option, const char *key, const char *value, GError **error)
{
    return !value || cli_set(run->params, option, key, value, error);
}

static gboolean by_lsystem(const Run *run)
{
    char *origin = ven_params_get(run->params, "veins.origin");
    gboolean lsystem = g_strcmp0(origin, "lsystem") == 0;
    g_free(origin);
    return lsystem;
}

/* Nothing grows, unless an L-system was asked for, which draws at once. */
static gboolean choose_origin(Run *run, GError **error)
{
    return by_lsystem(run) || run_set(run, "veins.origin", "drawn", error);
}

static gboolean read_params(Capture *c, GError **error)
{
    Run *run = &c->run;
    const CaptureArgs *a = c->args;
    return run_read_params(run, a->params, error) && ven_params_use_scan(run->params, run->path, error) &&
           choose_origin(run, error) && set_option(run, "--method", "scan.method", a->method, error) &&
           set_option(run, "--back", "scan.back", a->back, error) && set_option(run, "--drawing", "veins.drawing", a->drawing, error) &&
           set_option(run, "--maps", "texture.maps", a->maps, error);
}

/* ---- nodes of the outline (Hong 2005, tables 5.1 and 5.2), or operators compared (Fang and Shen 2013, figure 3) ---- */

static int print_table(Capture *c)
{
    GError *error = NULL;
    char *text = ven_scan_table(c->run.params, &error);
    if (!text)
        return run_report(error, TRUE);
    int status = cli_print(text);
    g_free(text);
    return status;
}

/* ---- leaves ---- */

static char *leaf_name(const Capture *c, guint32 leaf)
{
    return c->args->each ? g_strdup_printf("%s_%u", c->run.name, leaf) : g_strdup(c->run.name);
}

static gboolean capture_leaf(Capture *c, guint32 leaf, GError **error)
{
    Run *run = &c->run;
    VenOptions how = {.threads = (unsigned)run->threads};
    char *number = g_strdup_printf("%u", leaf);
    gboolean ok = !c->args->each || run_set(run, "scan.leaf", number, error);
    ven_leaf_free(run->leaf);
    run->leaf = ok ? ven_scan_grow(c->sheet, run->params, run->seed, &how, error) : NULL;
    g_free(number);
    return run->leaf != NULL;
}

/* Writes the first leaf, which is there, and captures and writes the others; the last one stays for the summary and the record. */
static gboolean write_leaves(Run *run, const char *dir, gpointer user, GError **error)
{
    Capture *c = user;
    gboolean ok = TRUE;
    for (guint32 i = 1; ok && i <= c->leaves; i++) {
        char *name = leaf_name(c, i);
        ok = (i == 1 || capture_leaf(c, i, error)) && ven_write(run->leaf, dir, name, error) &&
             ven_write_capture_of(run->leaf, dir, name, run->name, error);
        g_free(name);
    }
    return ok;
}

/* What there is to do in the drawing: an L-system's veins are not in it. */
static const char *task(const Capture *c)
{
    return by_lsystem(&c->run)                ? "correct the outline"
           : ven_leaf_edges(c->run.leaf) == 0 ? "correct the outline and draw veins"
                                              : "correct outline and veins";
}

/* Of all the files written, those that are meant for people. */
static void say_how_to_go_on(const Capture *c)
{
    char *dir = g_filename_display_name(c->run.dir), *first = leaf_name(c, 1), *last = leaf_name(c, c->leaves);
    gboolean several = c->leaves > 1;
    fprintf(stderr, "%s/%s_drawing.svg%s%s%s: %s with Inkscape, in the layers over the scan\n", dir, first, several ? " … " : "",
            several ? last : "", several ? "_drawing.svg" : "", task(c));
    fprintf(stderr, "%s/%s.ini%s%s%s: then venation grow, or shape, th%s file%s; both need %s_scan.* beside them, the rest is maps, network and record\n", dir,
            first, several ? " … " : "", several ? last : "", several ? ".ini" : "", several ? "ese" : "is", several ? "s" : "", c->run.name);
    g_free(first);
    g_free(last);
    g_free(dir);
}

/* "veins found: 5 primary, 18 secondary" */
static char *count_veins(const Run *run)
{
    char *drawing = ven_params_get(run->params, "veins.drawing");
    uint32_t primary = ven_leaf_veins(run->leaf, 1), secondary = ven_leaf_veins(run->leaf, 2), finer = ven_leaf_veins(run->leaf, 0) - primary - secondary;
    GString *s = g_string_new(by_lsystem(run) ? "veins by the L-system: " : drawing && *drawing ? "veins drawn: " : "veins found: ");
    g_string_append_printf(s, "%u primary, %u secondary", primary, secondary);
    if (finer)
        g_string_append_printf(s, ", %u finer", finer);
    g_free(drawing);
    return g_string_free(s, FALSE);
}

static void summarise(const Capture *c)
{
    char *veins = count_veins(&c->run), *what;
    if (c->leaves > 1)
        what = g_strdup_printf("%u leaves captured", c->leaves);
    else
        what = g_strdup_printf("outline captured, %s", ven_leaf_edges(c->run.leaf) ? veins : "without veins");
    run_summarise(&c->run, what);
    g_free(what);
    g_free(veins);
    if (!c->run.args->quiet)
        say_how_to_go_on(c);
}

static int carry_out(Capture *c)
{
    Run *run = &c->run;
    GError *error = NULL;
    if (!read_params(c, &error))
        return run_report(error, TRUE);
    if (c->args->table)
        return print_table(c);
    if (c->args->each && !(c->sheet = ven_scan_open(run->params, &error)))
        return run_report(error, TRUE);
    c->leaves = c->sheet ? ven_scan_count(c->sheet) : 1;
    if (!capture_leaf(c, 1, &error))
        return run_report(error, TRUE);
    int status = run_begin(run);
    if (status == 0)
        status = run_write(run, write_leaves, c);
    if (status != 0)
        return status;
    summarise(c);
    return run->args->json ? run_print_record(ven_leaf_record(run->leaf)) : 0;
}

static int run_capture(const Verb *verb, int argc, char **argv)
{
    CaptureArgs args = {0};
    int status;
    if (cli_parse(verb, &args, argc, argv, &status)) {
        Capture c = {.args = &args};
        status = run_read_args(&c.run, verb, &args.run) ? carry_out(&c) : EXIT_USAGE;
        ven_scan_close(c.sheet);
        run_clear(&c.run);
    }
    cli_clear(verb, &args);
    return status;
}

const Verb capture_verb = {
    "capture",
    "IMAGE",
    "Take outline and veins of a real leaf from a scan",
    "Finds the leaf in a scan (PNG, JPEG or TIFF), traces its outline, cuts off the petiole, and looks for primary and secondary veins; or takes "
    "veins that were drawn. Written are the maps, with the scan's colours, the network, the record, and three files to go on with: NAME_drawing.svg, "
    "the scan with outline and veins as layers, to be corrected in Inkscape; NAME.ini, a parameter file from which grow fills in the finer "
    "veins and shape makes a bent leaf; and NAME_scan, the copy of the scan to which both refer.\n\n"
    "A drawing of your own (--drawing, or outline.file) is an SVG file with the scan as its image, wherever that lies on the page and in whatever units, and the "
    "veins as open paths in a layer or group called veins, the outline as a path called outline. Without an image its page, if it has the shape of the "
    "scan, is the scan; else its units are pixels.\n\n"
    "grow and shape take an image, too: they do all at once.",
    options,
    run_capture,
};
