/* What a sweep grows: its file, and what the options set over it. */
#include <string.h>

#include "batch/dataset.h"
#include "cli/sweep_private.h"

/* An option that the sweep would override says nothing. */
static gboolean check_free(const Sweeping *w, int id, const char *option, GError **error)
{
    for (uint32_t k = 0; k < sweep_keys(w->sweep); k++)
        if (sweep_key(w->sweep, k).id == id) {
            g_set_error(error, PARAM_ERROR, PARAM_ERROR_VALUE, "%s: %s gives %s its values", option, sweep_path(w->sweep), sweep_key(w->sweep, k).key);
            return FALSE;
        }
    return TRUE;
}

/* Size may vary from leaf to leaf of a data set; what is written may not. */
static gboolean put_dataset(Sweeping *w, GError **error)
{
    static const ParamId fixed[] = {PARAM_TEXTURE_MAPS, PARAM_TEXTURE_EXR, PARAM_TEXTURE_DEPTH, PARAM_EXPORT_SPECIMEN, PARAM_EXPORT_VEINS_IMAGE, PARAM_EXPORT_SVG,
                                    PARAM_EXPORT_NETWORK};
    for (gsize i = 0; i < G_N_ELEMENTS(fixed); i++)
        if (!check_free(w, fixed[i], "--dataset", error))
            return FALSE;
    return dataset_params(w->params, "--dataset", error) && dataset_check_place(w->dir, error);
}

static gboolean put(Sweeping *w, const char *option, const char *key, const char *value, GError **error)
{
    return check_free(w, param_find(key), option, error) && params_set(w->params, (ParamId)param_find(key), value, option, error);
}

/* --write: what is not in the list is off. */
static gboolean choose_writing(Sweeping *w, GError **error)
{
    static const char *const kind[] = {"maps", "svg", "network", "mesh", "none"};
    gboolean wanted[G_N_ELEMENTS(kind)] = {FALSE};
    char **word = g_strsplit_set(w->args->write, ", ", -1);
    const char *wrong = NULL;
    for (char **at = word; *at && !wrong; at++) {
        gsize k = 0;
        while (k < G_N_ELEMENTS(kind) && strcmp(kind[k], *at) != 0)
            k++;
        if (k < G_N_ELEMENTS(kind))
            wanted[k] = TRUE;
        else if (**at)
            wrong = *at;
    }
    gboolean ok = !wrong;
    if (wrong)
        g_set_error(error, PARAM_ERROR, PARAM_ERROR_VALUE, "--write %s: must be none, or names out of maps svg network mesh", wrong);
    g_strfreev(word);
    w->def.models = wanted[3];
    return ok && (wanted[0] || (put(w, "--write", "texture.maps", "none", error) && put(w, "--write", "export.veins_image", "no", error))) &&
           put(w, "--write", "export.svg", wanted[1] ? "yes" : "no", error) && put(w, "--write", "export.network", wanted[2] ? "yes" : "no", error);
}

/* What a sweep varies can't be one value for all. */
static gboolean check_set(const Sweeping *w, const char *assignment, GError **error)
{
    for (uint32_t k = 0; k < sweep_keys(w->sweep); k++) {
        SweepKey key = sweep_key(w->sweep, k);
        gsize n = strlen(key.key);
        const char *from = assignment + strspn(assignment, " \t");
        if (strncmp(from, key.key, n) == 0 && from[n + strspn(from + n, " \t")] == '=') {
            g_set_error(error, PARAM_ERROR, PARAM_ERROR_VALUE, "--set %s: %s gives %s its values", assignment, sweep_path(w->sweep), key.key);
            return FALSE;
        }
    }
    return TRUE;
}

gboolean sweeping_read(Sweeping *w, GError **error)
{
    const SweepArgs *a = w->args;
    w->sweep = sweep_load(a->common.operands[0], error);
    if (!w->sweep)
        return FALSE;
    w->params = params_copy(sweep_params(w->sweep));
    for (char **s = a->set; s && *s; s++)
        if (!check_set(w, *s, error) || !params_override(w->params, *s, error))
            return FALSE;
    if ((a->maps && !put(w, "--maps", "texture.maps", a->maps, error)) || (a->size && !put(w, "--size", "texture.size", a->size, error)) ||
        (a->write && !choose_writing(w, error)) || (a->dataset && !put_dataset(w, error)))
        return FALSE;
    w->def.labels = a->dataset;
    w->def.sweep = w->sweep;
    w->def.params = w->params;
    w->def.out = w->dir;
    w->def.threads = (unsigned)w->threads;
    w->def.shard = (uint32_t)(w->shard - 1);
    w->def.shards = (uint32_t)w->shards;
    w->def.picture = (uint32_t)w->cell;
    w->def.specimen = a->picture ? strcmp(a->picture, "specimen") == 0 : a->dataset;
    return TRUE;
}
