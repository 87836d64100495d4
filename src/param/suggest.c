#include "param/suggest.h"

#include <string.h>

#include "param/params.h"

enum { LONGEST = 64 }; /* no name is nearly as long; bounds the work on hostile input */

static unsigned char plain(char c)
{
    return c == '-' ? '_' : (unsigned char)g_ascii_tolower(c);
}

/* Edit distance with swaps of neighbours (optimal string alignment), three rows of the usual table. */
static unsigned edit_distance(const char *a, const char *b)
{
    unsigned rows[3][LONGEST + 1];
    gsize n = strlen(a), m = strlen(b);
    for (gsize j = 0; j <= m; j++)
        rows[0][j] = (unsigned)j;
    for (gsize i = 1; i <= n; i++) {
        unsigned *row = rows[i % 3], *above = rows[(i + 2) % 3], *second = rows[(i + 1) % 3];
        row[0] = (unsigned)i;
        for (gsize j = 1; j <= m; j++) {
            unsigned char x = plain(a[i - 1]), y = plain(b[j - 1]);
            unsigned best = above[j - 1] + (x != y);
            best = MIN(best, MIN(above[j], row[j - 1]) + 1);
            if (i > 1 && j > 1 && x == plain(b[j - 2]) && plain(a[i - 2]) == y)
                best = MIN(best, second[j - 2] + 1);
            row[j] = best;
        }
    }
    return rows[n % 3][m];
}

static const char *only_with_prefix(const char *word, const char *const *known, gsize n)
{
    const char *found = NULL;
    for (gsize i = 0; i < n; i++) {
        if (g_ascii_strncasecmp(known[i], word, strlen(word)) != 0)
            continue;
        if (found)
            return NULL;
        found = known[i];
    }
    return found;
}

const char *suggest_nearest(const char *word, const char *const *known, gsize n)
{
    gsize length = strlen(word);
    if (length == 0 || length > LONGEST)
        return NULL;
    const char *best = NULL;
    unsigned least = G_MAXUINT;
    for (gsize i = 0; i < n; i++) {
        gsize other = strlen(known[i]);
        if (other > LONGEST)
            continue;
        unsigned distance = edit_distance(word, known[i]);
        if (distance < least && distance <= MAX(1, MAX(length, other) / 3) && distance < MIN(length, other)) {
            least = distance;
            best = known[i];
        }
    }
    return best || length < 2 ? best : only_with_prefix(word, known, n);
}

static gsize sections(const char **out)
{
    gsize n = 0;
    for (int i = 0; i < PARAM_COUNT; i++) {
        const char *section = param_info((ParamId)i)->section;
        if (n == 0 || strcmp(out[n - 1], section) != 0)
            out[n++] = section;
    }
    return n;
}

/* Keys of a section, or of all when `section` is NULL. */
static gsize keys(const char *section, const char **out)
{
    gsize n = 0;
    for (int i = 0; i < PARAM_COUNT; i++)
        if (!section || strcmp(param_info((ParamId)i)->section, section) == 0)
            out[n++] = param_info((ParamId)i)->key;
    return n;
}

static const ParamInfo *with_key(const char *key)
{
    for (int i = 0; i < PARAM_COUNT; i++)
        if (strcmp(param_info((ParamId)i)->key, key) == 0)
            return param_info((ParamId)i);
    return NULL;
}

static char *list(const char *intro, const char *const *words, gsize n)
{
    GString *s = g_string_new(intro);
    for (gsize i = 0; i < n; i++)
        g_string_append_printf(s, "%s%s", i ? ", " : " ", words[i]);
    return g_string_free(s, FALSE);
}

char *suggest_key(const char *section, const char *key)
{
    const ParamInfo *elsewhere = with_key(key);
    if (elsewhere)
        return g_strdup_printf("it is in [%s]", elsewhere->section);
    const char *names[PARAM_COUNT];
    gsize n = keys(section, names);
    const char *near = suggest_nearest(key, names, n);
    if (near)
        return g_strdup_printf("did you mean '%s'?", near);
    n = keys(NULL, names);
    near = suggest_nearest(key, names, n);
    if (near)
        return g_strdup_printf("did you mean '%s', which is in [%s]?", near, with_key(near)->section);
    n = keys(section, names);
    return list("its keys are", names, n);
}

char *suggest_section(const char *section)
{
    const char *names[PARAM_COUNT];
    gsize n = sections(names);
    const char *near = suggest_nearest(section, names, n);
    return near ? g_strdup_printf("did you mean [%s]?", near) : list("sections are", names, n);
}

/* The known "section.key" that `dotted` may stand for: as it is, or by its key alone. */
static char *nearest_dotted(const char *dotted)
{
    const char *dot = strchr(dotted, '.');
    const ParamInfo *same = with_key(dot ? dot + 1 : dotted);
    if (same)
        return g_strdup_printf("%s.%s", same->section, same->key);
    char *names[PARAM_COUNT];
    for (int i = 0; i < PARAM_COUNT; i++)
        names[i] = g_strdup_printf("%s.%s", param_info((ParamId)i)->section, param_info((ParamId)i)->key);
    char *near = g_strdup(suggest_nearest(dotted, (const char *const *)names, PARAM_COUNT));
    for (int i = 0; i < PARAM_COUNT; i++)
        g_free(names[i]);
    if (near)
        return near;
    const char *bare[PARAM_COUNT];
    const char *key = suggest_nearest(dot ? dot + 1 : dotted, bare, keys(NULL, bare));
    return key ? g_strdup_printf("%s.%s", with_key(key)->section, key) : NULL;
}

char *suggest_dotted(const char *dotted)
{
    char *near = nearest_dotted(dotted);
    if (near) {
        char *hint = g_strdup_printf("did you mean '%s'?", near);
        g_free(near);
        return hint;
    }
    const char *names[PARAM_COUNT];
    gsize n = sections(names);
    const char *dot = strchr(dotted, '.');
    char *section = dot ? g_strndup(dotted, (gsize)(dot - dotted)) : g_strdup("");
    for (gsize i = 0; i < n && dot; i++) {
        if (strcmp(names[i], section) != 0)
            continue;
        char *intro = g_strdup_printf("keys of [%s] are", section);
        n = keys(section, names);
        char *hint = list(intro, names, n);
        g_free(intro);
        g_free(section);
        return hint;
    }
    g_free(section);
    return list("sections are", names, n);
}
