/* Parameter files: sections in brackets, key = value, comments on lines of their own after # or ;. A reader of our own
 * rather than GKeyFile, which knows no line numbers and lets the last of two equal keys win in silence. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "param/private.h"
#include "param/suggest.h"

enum { LARGEST_FILE = 1 << 20 };

typedef struct {
    Params *params;
    Place place;
    const char *section;        /* of the table; NULL before the first */
    unsigned seen[PARAM_COUNT]; /* line each was given in, 0 not yet */
} Reader;

static G_GNUC_PRINTF(4, 5) gboolean
    fail(const Place *place, ParamErrorCode code, GError **error, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *what = g_strdup_vprintf(format, args);
    va_end(args);
    char *origin = g_filename_display_name(place->origin);
    if (place->line)
        g_set_error(error, PARAM_ERROR, code, "%s:%u: %s", origin, place->line, what);
    else
        g_set_error(error, PARAM_ERROR, code, "%s: %s", origin, what);
    g_free(origin);
    g_free(what);
    return FALSE;
}

static gboolean read_section(Reader *r, char *line, GError **error)
{
    gsize length = strlen(line);
    char *quoted = param_quote(line);
    gboolean good = FALSE;
    if (line[length - 1] != ']') {
        fail(&r->place, PARAM_ERROR_FILE, error, "%s: a section's name stands in brackets, as [veins]", quoted);
    } else {
        line[length - 1] = '\0';
        char *name = g_strstrip(line + 1);
        for (int i = 0; i < PARAM_COUNT && !good; i++) {
            r->section = param_info((ParamId)i)->section;
            good = strcmp(r->section, name) == 0;
        }
        if (!good) {
            char *hint = suggest_section(name);
            fail(&r->place, PARAM_ERROR_UNKNOWN, error, "%s: no such section; %s", quoted, hint);
            g_free(hint);
        }
    }
    g_free(quoted);
    return good;
}

static int find_key(const char *section, const char *key)
{
    for (int i = 0; i < PARAM_COUNT; i++)
        if (strcmp(param_info((ParamId)i)->section, section) == 0 && strcmp(param_info((ParamId)i)->key, key) == 0)
            return i;
    return -1;
}

static gboolean read_value(Reader *r, const char *key, const char *value, GError **error)
{
    char *quoted = param_quote(key);
    int id = r->section ? find_key(r->section, key) : -1;
    gboolean good = FALSE;
    if (!r->section) {
        fail(&r->place, PARAM_ERROR_FILE, error, "%s: a [section] must come before the first key", quoted);
    } else if (id < 0) {
        char *hint = suggest_key(r->section, key);
        fail(&r->place, PARAM_ERROR_UNKNOWN, error, "[%s] %s: no such key; %s", r->section, quoted, hint);
        g_free(hint);
    } else if (r->seen[id]) {
        fail(&r->place, PARAM_ERROR_FILE, error, "[%s] %s: already given in line %u", r->section, quoted, r->seen[id]);
    } else {
        r->seen[id] = r->place.line;
        good = params_assign(r->params, (ParamId)id, value, &r->place, error);
    }
    g_free(quoted);
    return good;
}

static gboolean read_line(Reader *r, char *line, GError **error)
{
    g_strstrip(line);
    if (!*line || *line == '#' || *line == ';')
        return TRUE;
    if (*line == '[')
        return read_section(r, line, error);
    char *equals = strchr(line, '=');
    if (!equals || equals == line) {
        char *quoted = param_quote(line);
        fail(&r->place, PARAM_ERROR_FILE, error, "'%s': must be key = value, [section], or a comment after # or ;",
             quoted);
        g_free(quoted);
        return FALSE;
    }
    *equals = '\0';
    return read_value(r, g_strchomp(line), g_strchug(equals + 1), error);
}

static gboolean is_text(const char *text, gsize length, Place place, GError **error)
{
    const char *bad;
    if (length > LARGEST_FILE)
        return fail(&place, PARAM_ERROR_FILE, error, "larger than 1 MiB, which no parameter file is");
    if (memchr(text, 0, length))
        return fail(&place, PARAM_ERROR_FILE, error, "not a text file");
    if (g_utf8_validate(text, (gssize)length, &bad))
        return TRUE;
    place.line = 1;
    for (const char *c = text; c < bad; c++)
        place.line += *c == '\n';
    return fail(&place, PARAM_ERROR_FILE, error, "not UTF-8 text");
}

Params *params_parse(const char *text, gsize length, const char *path, GError **error)
{
    char *folder = g_path_get_dirname(path);
    Reader r = {.place = {path, 0, folder}};
    gboolean good = is_text(text, length, r.place, error);
    if (good) {
        r.params = params_new();
        gboolean marked = length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0; /* byte order mark */
        char *body = g_strndup(text + (marked ? 3 : 0), length - (marked ? 3 : 0));
        for (char *line = body; line && good;) {
            char *end = strchr(line, '\n');
            if (end)
                *end++ = '\0';
            r.place.line++;
            good = read_line(&r, line, error);
            line = end;
        }
        g_free(body);
    }
    g_free(folder);
    if (good)
        return r.params;
    params_free(r.params);
    return NULL;
}

/* A file that can't be read: the machine's fault if it lacks memory or file handles, else that of who named it. */
static void refuse_file(const Place *place, int code, GError **error)
{
    if (code == ENOMEM || code == EMFILE || code == ENFILE || code == EIO)
        g_set_error(error, G_FILE_ERROR, (gint)g_file_error_from_errno(code), "%s: %s", place->origin, g_strerror(code));
    else
        fail(place, PARAM_ERROR_FILE, error, "%s", g_strerror(code));
}

Params *params_load(const char *path, GError **error)
{
    Place place = {path, 0, NULL};
    FILE *file = fopen(path, "rbe");
    if (!file) {
        refuse_file(&place, errno, error);
        return NULL;
    }
    char *text = g_malloc(LARGEST_FILE + 1);
    errno = 0;
    gsize length = fread(text, 1, LARGEST_FILE + 1, file);
    int problem = ferror(file) ? errno : 0;
    fclose(file);
    Params *p = NULL;
    if (problem)
        refuse_file(&place, problem, error);
    else
        p = params_parse(text, length, path, error);
    g_free(text);
    return p;
}

char *params_to_file(const Params *p)
{
    GString *s = g_string_new(NULL);
    const char *section = "";
    for (int i = 0; i < PARAM_COUNT; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        if (strcmp(section, info->section) != 0) {
            g_string_append_printf(s, "%s[%s]\n", *section ? "\n" : "", info->section);
            section = info->section;
        }
        char *value = params_format(p, (ParamId)i);
        g_string_append_printf(s, "%s =%s%s\n", info->key, *value ? " " : "", value);
        g_free(value);
    }
    return g_string_free(s, FALSE);
}

uint64_t params_hash(const Params *p)
{
    char *text = params_to_file(p);
    uint64_t hash = 0xcbf29ce484222325u; /* FNV-1a */
    for (const char *c = text; *c; c++)
        hash = (hash ^ (unsigned char)*c) * 0x100000001b3u;
    g_free(text);
    return hash;
}
