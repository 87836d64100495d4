/* What a variant depends on, as one short text; the version of its row, too, so that none is of an older kind. */
#include "batch/private.h"

struct Keys {
    const BatchDef *def;
    GMutex lock;
    GHashTable *file; /* path → checksum of what is in it */
};

Keys *keys_new(const BatchDef *def)
{
    Keys *k = g_new0(Keys, 1);
    k->def = def;
    g_mutex_init(&k->lock);
    k->file = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
    return k;
}

void keys_free(Keys *k)
{
    if (!k)
        return;
    g_hash_table_destroy(k->file);
    g_mutex_clear(&k->lock);
    g_free(k);
}

static char *checksum_of(const char *path)
{
    GMappedFile *file = g_mapped_file_new(path, FALSE, NULL);
    if (!file)
        return g_strdup("missing");
    GBytes *bytes = g_mapped_file_get_bytes(file);
    char *sum = g_compute_checksum_for_bytes(G_CHECKSUM_SHA256, bytes);
    g_bytes_unref(bytes);
    g_mapped_file_unref(file);
    return sum;
}

/* A sweep's variants name few files, most of them over and over: each is read once. */
static void add_file(Keys *k, const char *path, GChecksum *sum)
{
    g_mutex_lock(&k->lock);
    const char *known = g_hash_table_lookup(k->file, path);
    if (!known) {
        char *found = checksum_of(path);
        g_hash_table_insert(k->file, g_strdup(path), found);
        known = found;
    }
    g_checksum_update(sum, (const guchar *)known, -1);
    g_mutex_unlock(&k->lock);
}

char *keys_of(Keys *k, const Params *p, uint64_t seed)
{
    const BatchDef *d = k->def;
    GChecksum *sum = g_checksum_new(G_CHECKSUM_SHA256);
    char *text = params_to_file(p), *rest = g_strdup_printf("%s rows 3 %" G_GUINT64_FORMAT " %d %d %u %d", ven_version(), seed, d->models != 0, d->labels != 0,
                                                            d->picture, d->picture && d->specimen);
    g_checksum_update(sum, (const guchar *)rest, -1);
    g_checksum_update(sum, (const guchar *)text, -1);
    for (int i = 0; i < PARAM_COUNT; i++)
        if (param_info((ParamId)i)->type == TYPE_FILE && *params_text(p, (ParamId)i))
            add_file(k, params_text(p, (ParamId)i), sum);
    char *key = g_strndup(g_checksum_get_string(sum), 32);
    g_checksum_free(sum);
    g_free(text);
    g_free(rest);
    return key;
}

Params *batch_params(const BatchDef *def, const SweepVariant *v, GError **error)
{
    Params *p = params_copy(def->params);
    if (sweep_apply(def->sweep, v, p, error))
        return p;
    params_free(p);
    return NULL;
}
