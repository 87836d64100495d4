#include <string.h>

#include "geom/textfile.h"
#include "lib/settings.h"

static gboolean bad(GError **error, const char *path, unsigned line, const char *text)
{
    char *valid = g_utf8_make_valid(text, -1);
    glong length = g_utf8_strlen(valid, -1);
    char *shown = g_utf8_substring(valid, 0, MIN(length, 60));
    g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_SOURCES,
                "%s:%u: '%s%s' is no source: a line is x,y or x,y,step (segments from the base, tip along +y)", path, line, shown,
                length > 60 ? "…" : "");
    g_free(shown);
    g_free(valid);
    return FALSE;
}

static bool number(const char *s, double *v)
{
    char *end;
    *v = g_ascii_strtod(s, &end);
    return end != s && *end == '\0' && *v > -1e9 && *v < 1e9;
}

/* The parts of a line that are not empty; returns how many, at most 4. */
static uint32_t split(char *line, char *part[4])
{
    uint32_t n = 0;
    line[strcspn(line, "#")] = '\0';
    for (char *s = line + strspn(line, ",; \t\r"); *s && n < 4; s += strspn(s, ",; \t\r")) {
        part[n++] = s;
        s += strcspn(s, ",; \t\r");
        if (*s)
            *s++ = '\0';
    }
    return n;
}

enum { LARGEST_LIST = 256 << 20 }; /* bytes: ten million sources */

gboolean source_list_read(const char *path, ListedSource **list, uint32_t *n, GError **error)
{
    char *text;
    gsize length;
    if (!textfile_read(path, LARGEST_LIST, &text, &length, error)) {
        if (error && g_error_matches(*error, G_FILE_ERROR, G_FILE_ERROR_FAILED)) { /* too large: no failure of the system */
            (*error)->domain = SETTINGS_ERROR;
            (*error)->code = SETTINGS_ERROR_SOURCES;
        }
        g_prefix_error(error, "sources.file: ");
        return FALSE;
    }
    GArray *out = g_array_new(FALSE, FALSE, sizeof(ListedSource));
    char **line = g_strsplit(text, "\n", -1);
    gboolean ok = TRUE;
    for (unsigned i = 0; ok && line[i]; i++) {
        char *copy = g_strstrip(g_strdup(line[i])), *part[4] = {NULL};
        uint32_t parts = split(line[i], part);
        double x, y, step = 0.0;
        bool heading = i == 0 && parts >= 2 && g_ascii_strcasecmp(part[0], "x") == 0 && g_ascii_strcasecmp(part[1], "y") == 0;
        if (parts && !heading) {
            ok = parts >= 2 && parts <= 3 && number(part[0], &x) && number(part[1], &y) &&
                 (parts == 2 || (number(part[2], &step) && step >= 0.0 && step == floor(step)));
            if (ok) {
                ListedSource s = {{x, y}, (uint32_t)step};
                g_array_append_val(out, s);
            } else {
                bad(error, path, i + 1, copy);
            }
        }
        g_free(copy);
    }
    if (ok && out->len == 0) {
        g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_SOURCES, "%s: holds no source: a line is x,y or x,y,step (segments from the base, tip along +y)", path);
        ok = FALSE;
    }
    g_strfreev(line);
    g_free(text);
    *n = out->len;
    *list = (ListedSource *)g_array_free(out, !ok);
    return ok;
}
