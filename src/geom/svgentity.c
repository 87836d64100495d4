#include "geom/svgentity.h"

#include <stdbool.h>
#include <string.h>

enum { LONGEST = 1000 };

static const char *skip_space(const char *at, const char *end)
{
    while (at < end && g_ascii_isspace(*at))
        at++;
    return at;
}

/* A declaration that begins here: its name, and its text without line ends. Both are the caller's. */
static bool read_entity(const char *at, const char *end, char **name, char **value)
{
    const char *first = skip_space(at + strlen("<!ENTITY"), end), *last = first;
    while (last < end && (g_ascii_isalnum(*last) || strchr("_-.:", *last)))
        last++;
    const char *open = skip_space(last, end), *close = open < end && (*open == '"' || *open == '\'') ? memchr(open + 1, *open, (gsize)(end - open - 1)) : NULL;
    if (last == first || !close || close - open > LONGEST || memchr(open, '&', (gsize)(close - open)) || memchr(open, '<', (gsize)(close - open)))
        return false;
    *name = g_strndup(first, (gsize)(last - first));
    *value = g_strdelimit(g_strndup(open + 1, (gsize)(close - open - 1)), "\r\n", ' ');
    return true;
}

/* The declarations between the brackets of <!DOCTYPE svg … [ … ]>; *body receives where the drawing begins. */
static GHashTable *read_entities(const char *text, gsize length, const char **body)
{
    const char *end = text + length, *head = g_strstr_len(text, (gssize)length, "<!DOCTYPE");
    const char *open = head ? memchr(head, '[', (gsize)(end - head)) : NULL, *tag = head ? memchr(head, '>', (gsize)(end - head)) : NULL;
    const char *close = open && tag && open < tag ? g_strstr_len(open, end - open, "]>") : NULL;
    if (!close)
        return NULL;
    GHashTable *all = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
    for (const char *at = open; (at = g_strstr_len(at, close - at, "<!ENTITY")); at++) {
        char *name, *value;
        if (!read_entity(at, close, &name, &value))
            continue;
        if (g_hash_table_contains(all, name)) { /* the first one counts (XML 1.0, 4.2) */
            g_free(name);
            g_free(value);
        } else {
            g_hash_table_insert(all, name, value);
        }
    }
    *body = close;
    return all;
}

char *svgentity_expand(const char *text, gsize *length, gsize largest)
{
    const char *at = NULL, *end = text + *length;
    GHashTable *all = read_entities(text, *length, &at);
    if (!all || g_hash_table_size(all) == 0) {
        g_clear_pointer(&all, g_hash_table_unref);
        return NULL;
    }
    GString *s = g_string_new_len(text, at - text);
    for (const char *mark; s->len <= largest && (mark = memchr(at, '&', (gsize)(end - at)));) {
        const char *stop = memchr(mark, ';', (gsize)MIN(end - mark, LONGEST)), *value = NULL;
        if (stop) {
            char *name = g_strndup(mark + 1, (gsize)(stop - mark - 1));
            value = g_hash_table_lookup(all, name);
            g_free(name);
        }
        g_string_append_len(s, at, mark - at);
        g_string_append(s, value ? value : "&");
        at = value ? stop + 1 : mark + 1;
    }
    g_string_append_len(s, at, end - at);
    g_hash_table_unref(all);
    *length = s->len;
    return g_string_free(s, s->len > largest);
}
