/* venation grow: one leaf from one parameter file. */
#include <stdio.h>
#include <string.h>

#include "cli/run.h"

typedef struct {
    RunArgs run;
    char *back, *drawing, *every, *frames, *maps;
} GrowArgs;

#define FIELD(name) (gpointer) offsetof(GrowArgs, name)
static const GOptionEntry options[] = {
    RUN_OPTIONS,
    {"back", 0, 0, G_OPTION_ARG_FILENAME, FIELD(back), "Scan of the shadow side, as --set scan.back", "IMAGE"},
    {"drawing", 0, 0, G_OPTION_ARG_FILENAME, FIELD(drawing), "Drawn veins instead of those found in the scan, as --set veins.drawing", "DRAWING"},
    {"maps", 0, 0, G_OPTION_ARG_FILENAME, FIELD(maps),
     "Maps to paint: all, none, or names with commas or spaces between them, as --set texture.maps", "LIST"},
    {"every", 0, 0, G_OPTION_ARG_FILENAME, FIELD(every), "Write a frame of every K-th step into the folder frames", "K"},
    {"frames", 0, 0, G_OPTION_ARG_FILENAME, FIELD(frames), "What the frames are: svg, drawings (the default), or maps, those that --maps names", "svg|maps"},
    {0},
};

typedef struct {
    Run run;
    const GrowArgs *args;
    guint64 every;
    gboolean frame_maps;
    GError *frame_error;
} Grow;

static gboolean read_args(Grow *g, const Verb *verb, const GrowArgs *a)
{
    *g = (Grow){.args = a};
    if (!run_read_args(&g->run, verb, &a->run) ||
        (a->every && !cli_count_from(verb, "--every", a->every, 1, G_MAXUINT32, &g->every)))
        return FALSE;
    g->frame_maps = a->frames && strcmp(a->frames, "maps") == 0;
    if (a->frames && !g->frame_maps && strcmp(a->frames, "svg") != 0) {
        cli_usage(verb, "--frames %s: must be svg or maps", a->frames);
        return FALSE;
    }
    if (a->frames && !g->every) {
        cli_usage(verb, "--frames needs --every");
        return FALSE;
    }
    return TRUE;
}

static gboolean read_params(Grow *g, GError **error)
{
    const GrowArgs *a = g->args;
    if (!run_read_params(&g->run, g->run.path, error) || (a->back && !cli_set(g->run.params, "--back", "scan.back", a->back, error)) ||
        (a->drawing && !cli_set(g->run.params, "--drawing", "veins.drawing", a->drawing, error)))
        return FALSE;
    if (!g->args->maps)
        return TRUE;
    char *maps = g_strdelimit(g_strdup(g->args->maps), ",", ' ');
    gboolean good = cli_set(g->run.params, "--maps", "texture.maps", maps, error);
    g_free(maps);
    return good;
}

/* Frames of maps when no map is wanted would be an empty folder. */
static gboolean frames_are_empty(const Grow *g)
{
    char *maps = ven_params_get(g->run.params, "texture.maps");
    g_strstrip(maps);
    gboolean none = !*maps || g_str_equal(maps, "none");
    g_free(maps);
    return g->frame_maps && none;
}

static gboolean write_frame(const VenProgress *now, gpointer user)
{
    Grow *g = user;
    return !g->every || !now->leaf ||
           ven_write_frame(now->leaf, output_staging(g->run.output), g->run.name, g->frame_maps, &g->frame_error);
}

static gboolean write_leaf(Run *run, const char *dir, gpointer user, GError **error)
{
    return ven_write(run->leaf, dir, run->name, error);
}

static int carry_out(Grow *g)
{
    Run *run = &g->run;
    GError *error = NULL;
    if (!read_params(g, &error))
        return run_report(error, TRUE);
    if (frames_are_empty(g))
        return cli_usage(run->verb, "--frames maps needs a map: --maps is none");
    int status = run_begin(run);
    if (status == 0)
        status = run_grow_leaf(run, (uint32_t)g->every, write_frame, g, &g->frame_error);
    if (status == 0)
        status = run_write(run, write_leaf, NULL);
    if (status != 0)
        return status;
    uint32_t nodes = ven_leaf_nodes(run->leaf), edges = ven_leaf_edges(run->leaf);
    char *what = g_strdup_printf("%u node%s and %u edge%s in %u step%s, seed %" G_GUINT64_FORMAT, nodes, cli_s(nodes), edges, cli_s(edges),
                                 run->steps, cli_s(run->steps), run->seed);
    run_summarise(run, what);
    g_free(what);
    uint64_t given_up;
    const char *end = ven_leaf_end(run->leaf, &given_up);
    if (!run->args->quiet && edges == 0)
        fprintf(stderr, "no vein grew: %s\n", end);
    else if (!run->args->quiet && given_up)
        fprintf(stderr, "%" G_GUINT64_FORMAT " source%s given up: %s\n", (guint64)given_up, given_up == 1 ? " was" : "s were", end);
    return run->args->json ? run_print_record(ven_leaf_record(run->leaf)) : 0;
}

static int run_grow(const Verb *verb, int argc, char **argv)
{
    GrowArgs args = {0};
    int status;
    if (cli_parse(verb, &args, argc, argv, &status)) {
        Grow g;
        status = read_args(&g, verb, &args) ? carry_out(&g) : EXIT_USAGE;
        run_clear(&g.run);
        g_clear_error(&g.frame_error);
    }
    cli_clear(verb, &args);
    return status;
}

const Verb grow_verb = {
    "grow",
    "PARAMS|IMAGE",
    "Grow a leaf and write its maps, drawing, network and record",
    "Grows the leaf that the parameter file PARAMS describes and writes it into a folder: texture maps, a drawing, the "
    "network, "
    "and the run record. Equal parameters and seed give equal files, whatever the number of threads. IMAGE is the scan of a real "
    "leaf instead: its outline, colours and larger veins are taken, and the finer veins grow between them.\n\n"
    "The files appear when all is done: a run that fails or is interrupted leaves nothing behind.",
    options,
    run_grow,
};
