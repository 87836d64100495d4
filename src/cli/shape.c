/* venation shape: a bent leaf from a parameter file or a network. */
#include <stdio.h>
#include <string.h>

#include "cli/run.h"
#include "cli/wither.h"

typedef struct {
    RunArgs run;
    char *params, *back, *drawing, *pose, *formats, *lod, *rig;
} ShapeArgs;

#define FIELD(name) (gpointer) offsetof(ShapeArgs, name)
static const GOptionEntry options[] = {
    RUN_OPTIONS,
    {"params", 0, 0, G_OPTION_ARG_FILENAME, FIELD(params), "Parameter file for a NETWORK or an IMAGE: colours, mesh, pose (default: the defaults)", "PARAMS"},
    {"back", 0, 0, G_OPTION_ARG_FILENAME, FIELD(back), "Scan of the shadow side, as --set scan.back", "IMAGE"},
    {"drawing", 0, 0, G_OPTION_ARG_FILENAME, FIELD(drawing), "Drawn veins instead of those found in the scan, as --set veins.drawing", "DRAWING"},
    {"pose", 0, 0, G_OPTION_ARG_FILENAME, FIELD(pose), "Ready-made pose, as --set pose.preset; withered colours the leaf by its age (pose.age), too, but for what --set gives or a scan shows",
     "flat|cupped|folded|drooping|curled_tip|wavy|withered"},
    {"formats", 0, 0, G_OPTION_ARG_FILENAME, FIELD(formats),
     "Models to write: all, none, or names parted by commas out of glb, obj, ply, pov, as --set export.models", "MODELS"},
    {"lod", 0, 0, G_OPTION_ARG_FILENAME, FIELD(lod), "Levels of detail, as --set mesh.levels", "N"},
    {"rig", 0, 0, G_OPTION_ARG_FILENAME, FIELD(rig), "Rigged glTF too, with 4 or 8 joints a vertex, as --set export.rig", "none|4|8"},
    {0},
};

static gboolean is_network(const char *path) { return g_str_has_suffix(path, ".graphml") || g_str_has_suffix(path, ".xml"); }

/* Not itself the parameter file. */
static gboolean takes_params(const char *path) { return is_network(path) || run_is_image(path); }

static gboolean read_params(Run *run, const ShapeArgs *a, GError **error)
{
    const struct {
        const char *option, *key, *value;
    } given[] = {{"--back", "scan.back", a->back}, {"--drawing", "veins.drawing", a->drawing}, {"--pose", "pose.preset", a->pose}, {"--lod", "mesh.levels", a->lod}, {"--rig", "export.rig", a->rig}};
    if (!run_read_params(run, takes_params(run->path) ? a->params : run->path, error))
        return FALSE;
    for (gsize i = 0; i < G_N_ELEMENTS(given); i++)
        if (given[i].value && !cli_set(run->params, given[i].option, given[i].key, given[i].value, error))
            return FALSE;
    if (g_strcmp0(a->pose, "withered") == 0 && !wither_colours(run, error))
        return FALSE;
    if (!a->formats)
        return TRUE;
    char *formats = g_strdelimit(g_strdup(a->formats), ",", ' ');
    gboolean good = cli_set(run->params, "--formats", "export.models", formats, error);
    g_free(formats);
    return good;
}

static int get_leaf(Run *run)
{
    if (!is_network(run->path))
        return run_grow_leaf(run, 0, NULL, NULL, NULL);
    GError *error = NULL;
    run->leaf = ven_leaf_load(run->params, run->path, run->seed, &error);
    return run->leaf ? 0 : run_report(error, TRUE);
}

static gboolean shape_and_write(Run *run, const char *dir, gpointer user, GError **error)
{
    VenShape **shape = user;
    *shape = ven_shape(run->leaf, error);
    return *shape && ven_shape_write(*shape, dir, run->name, error);
}

static void summarise(const Run *run, const VenShape *shape)
{
    char *wanted = ven_params_get(run->params, "mesh.levels"), *rig = ven_params_get(run->params, "export.rig");
    char *what = g_strdup_printf("%u veins carry %u vertices and %u triangles", ven_shape_veins(shape), ven_shape_vertices(shape),
                                 ven_shape_triangles(shape));
    uint32_t joints, levels = ven_shape_levels(shape);
    double worst, mean;
    run_summarise(run, what);
    if (!run->args->quiet && levels < g_ascii_strtoull(wanted, NULL, 10))
        fprintf(stderr, "%u of %s levels of detail: no coarser leaf is possible\n", levels, wanted);
    if (!run->args->quiet && ven_shape_rig(shape, &joints, &worst, &mean))
        fprintf(stderr, "rig: %u joint%s; %.1f %% of the weights left out, at worst %.0f %%%s\n", joints, cli_s(joints), 100.0 * mean, 100.0 * worst,
                g_str_equal(rig, "4") ? " (--rig 8 leaves out less)" : "");
    g_free(what);
    g_free(wanted);
    g_free(rig);
}

static int carry_out(Run *run, const ShapeArgs *a, VenShape **shape)
{
    GError *error = NULL;
    if (!read_params(run, a, &error))
        return run_report(error, TRUE);
    int status = run_begin(run);
    if (status == 0)
        status = get_leaf(run);
    if (status == 0)
        status = run_write(run, shape_and_write, shape);
    if (status != 0)
        return status;
    summarise(run, *shape);
    return run->args->json ? run_print_record(ven_shape_record(*shape)) : 0;
}

static int run_shape(const Verb *verb, int argc, char **argv)
{
    ShapeArgs args = {0};
    int status;
    if (cli_parse(verb, &args, argc, argv, &status)) {
        Run run;
        VenShape *shape = NULL;
        status = EXIT_USAGE;
        if (run_read_args(&run, verb, &args.run)) {
            if (args.params && !takes_params(run.path))
                cli_usage(verb, "--params goes with a network or an image; %s is the parameter file", run.path);
            else if ((args.back || args.drawing) && is_network(run.path))
                cli_usage(verb, "%s goes with a scan; %s is a network, which has its veins", args.back ? "--back" : "--drawing", run.path);
            else
                status = carry_out(&run, &args, &shape);
        }
        ven_shape_free(shape);
        run_clear(&run);
    }
    cli_clear(verb, &args);
    return status;
}

const Verb shape_verb = {
    "shape",
    "PARAMS|NETWORK|IMAGE",
    "Bend a leaf by its veins and write it as a model",
    "Makes a leaf blade for other programs: the larger veins of a venation are its skeleton, which is bent as [pose] asks; the blade "
    "between them is meshed and interpolated, veins and petiole become solids, and models are written for glTF, OBJ, PLY and POV-Ray, with "
    "the maps they are dressed in.\n\n"
    "PARAMS is a parameter file, and the leaf is grown first. NETWORK is a GraphML file that grow (or a person) wrote. IMAGE "
    "is the scan of a real leaf: its outline and colours are taken, its larger veins looked for, and finer ones grown between them.\n\n"
    "The files appear when all is done: a run that fails or is interrupted leaves nothing behind.",
    options,
    run_shape,
};
