/* Sweep files, a line "%%", a table (table.csv): whatever the bytes, there are variants, each with values that can be set, a name fit for a file and unlike
 * its neighbour's, or an error. */
#include "fuzz.h"
#include "sweep/sweep.h"

static void check_name(const char *name)
{
    require(*name && strlen(name) < 200 && strcmp(name, ".") && strcmp(name, "..") && g_utf8_validate(name, -1, NULL));
    for (const char *c = name; *c; c++)
        require((guchar)*c > ' ' && *c != '/' && *c != '\\' && *c != ':' && *c != 127);
    static const char *const device[] = {"con", "prn", "aux", "nul", "com1", "lpt1"}; /* on Windows, whatever comes after a point */
    for (gsize i = 0; i < G_N_ELEMENTS(device); i++)
        require(g_ascii_strncasecmp(name, device[i], strlen(device[i])) != 0 || (name[strlen(device[i])] && name[strlen(device[i])] != '.'));
}

static char *check_variant(const Sweep *s, uint64_t index)
{
    GError *error = NULL;
    SweepVariant v;
    sweep_variant(s, index, &v);
    check_name(v.name);
    require(v.index == index && v.n == sweep_keys(s));
    for (uint32_t k = 0; k < v.n; k++) {
        SweepKey key = sweep_key(s, k);
        require(!v.value[k] || g_utf8_validate(v.value[k], -1, NULL));
        require(key.levels == 0 || v.level[k] < key.levels);
        if (key.levels)
            g_free(sweep_level(s, k, v.level[k]));
    }
    Params *p = params_copy(sweep_params(s));
    bool ok = sweep_apply(s, &v, p, &error);
    fuzz_check_error(ok, &error, PARAM_ERROR, 0);
    params_free(p);
    char *name = g_utf8_casefold(v.name, -1);
    sweep_variant_clear(&v);
    return name;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    GError *error = NULL;
    char *text = fuzz_part(data, size, 0), *table = fuzz_part(data, size, 1);
    fuzz_file("table.csv", table, strlen(table));
    fuzz_file("leaf.ini", "[veins]\nkill_distance=2\n", 24);
    const char *path = fuzz_file("fuzz.ini", text, strlen(text));
    Sweep *s = sweep_parse(text, strlen(text), path, &error);
    fuzz_check_error(s != NULL, &error, PARAM_ERROR, 0);
    if (s) {
        uint64_t n = sweep_count(s);
        require(n >= 1 && n <= SWEEP_MOST);
        char *first = check_variant(s, 0), *last = check_variant(s, n - 1), *again = check_variant(s, 0);
        require(strcmp(first, again) == 0 && (n == 1 || strcmp(first, last) != 0));
        g_free(first);
        g_free(last);
        g_free(again);
    }
    sweep_free(s);
    g_free(text);
    g_free(table);
    return 0;
}
