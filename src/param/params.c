#include "param/params.h"

#include <string.h>

#include "param/private.h"
#include "param/suggest.h"
#include "param/value.h"

typedef struct {
    Value value;
    char *path;   /* FILE, openable */
    char *origin; /* NULL: default */
    bool over;    /* given by an override, not by a file */
} Entry;

struct Params {
    Entry entry[PARAM_COUNT];
};

enum { PLACED_BY_LIST = 2 }; /* among the choices of sources.placement */

G_DEFINE_QUARK(param-error-quark, param_error)

#define P(id, section, key, type, unit, initial, low, high, choices, doc)                                              \
    {section, key, TYPE_##type, unit, initial, low, high, choices, doc},
static const ParamInfo table[PARAM_COUNT] = {
#include "param/table.def"
};
#undef P

const ParamInfo *param_info(ParamId id)
{
    return &table[id];
}

int param_find(const char *dotted)
{
    const char *dot = strchr(dotted, '.');
    if (!dot)
        return -1;
    gsize length = (gsize)(dot - dotted);
    for (int i = 0; i < PARAM_COUNT; i++)
        if (strlen(table[i].section) == length && strncmp(table[i].section, dotted, length) == 0 &&
            strcmp(table[i].key, dot + 1) == 0)
            return i;
    return -1;
}

Params *params_new(void)
{
    Params *p = g_new0(Params, 1);
    for (int i = 0; i < PARAM_COUNT; i++) {
        bool good = value_parse(&table[i], table[i].initial, &p->entry[i].value);
        g_assert(good); /* the table's own defaults */
        p->entry[i].path = g_strdup(p->entry[i].value.text);
    }
    return p;
}

Params *params_copy(const Params *p)
{
    Params *copy = g_new0(Params, 1);
    for (int i = 0; i < PARAM_COUNT; i++) {
        copy->entry[i].value = value_copy(&table[i], &p->entry[i].value);
        copy->entry[i].path = g_strdup(p->entry[i].path);
        copy->entry[i].origin = g_strdup(p->entry[i].origin);
        copy->entry[i].over = p->entry[i].over;
    }
    return copy;
}

void params_free(Params *p)
{
    if (!p)
        return;
    for (int i = 0; i < PARAM_COUNT; i++) {
        value_clear(&p->entry[i].value);
        g_free(p->entry[i].path);
        g_free(p->entry[i].origin);
    }
    g_free(p);
}

char *param_quote(const char *text)
{
    enum { LONGEST = 60 };
    char *valid = g_utf8_make_valid(text, (gssize)strnlen(text, 8 * LONGEST));
    GString *s = g_string_new(NULL);
    glong n = 0;
    for (const char *c = valid; *c && n < LONGEST; c = g_utf8_next_char(c), n++) {
        gunichar u = g_utf8_get_char(c);
        g_string_append_unichar(s, g_unichar_iscntrl(u) ? 0xFFFD : u);
    }
    if (n == LONGEST)
        g_string_append(s, "…");
    g_free(valid);
    return g_string_free(s, FALSE);
}

/* Whether an origin is an option that stands for one parameter, as --size does. */
static bool is_option(const char *origin) { return origin && g_str_has_prefix(origin, "--") && strcmp(origin, "--set") != 0; }

static void refuse(ParamId id, const char *value, const Place *place, GError **error)
{
    const ParamInfo *info = &table[id];
    char *found = param_quote(value), *allowed = param_allowed(id), *hint = value_hint(info, value);
    char *origin = place->origin ? g_filename_display_name(place->origin) : NULL;
    GString *s = g_string_new(NULL);
    if (place->line)
        g_string_append_printf(s, "%s:%u: [%s] %s = %s", origin, place->line, info->section, info->key, found);
    else if (is_option(origin))
        g_string_append_printf(s, "%s %s", origin, found);
    else
        g_string_append_printf(s, "%s%s%s.%s=%s", origin ? origin : "", origin ? " " : "", info->section, info->key,
                               found);
    g_string_append_printf(s, ": must be %s%s%s", allowed, hint ? "; " : "", hint ? hint : "");
    g_set_error_literal(error, PARAM_ERROR, PARAM_ERROR_VALUE, s->str);
    g_string_free(s, TRUE);
    g_free(origin);
    g_free(hint);
    g_free(allowed);
    g_free(found);
}

/* How much a value has been asked for: by nobody, by a file, by an override. */
static int strength(const Entry *e) { return !e->origin ? 0 : e->over ? 2 : 1; }

/* Gives way: parameter `id` takes another value when `to` has been asked for more strongly. */
static void yield(Params *p, ParamId id, ParamId to, const char *value)
{
    Entry *e = &p->entry[id];
    if (strength(e) >= strength(&p->entry[to]))
        return;
    value_clear(&e->value);
    bool good = value_parse(&table[id], value, &e->value);
    g_assert(good);
    g_free(e->path);
    e->path = g_strdup(e->value.text);
}

/* Parameters that exclude each other: of a file's and an override the override wins, and a list of sources that is given
 * is used. Where both are asked for equally they stay, to be refused where they are read. */
static void settle(Params *p, ParamId given)
{
    const Value *v = &p->entry[given].value;
    if (given == PARAM_OUTLINE_PATH && *v->text)
        yield(p, PARAM_OUTLINE_FILE, given, "");
    else if (given == PARAM_OUTLINE_FILE && *v->text)
        yield(p, PARAM_OUTLINE_PATH, given, "");
    else if (given == PARAM_SOURCES_FILE && *v->text)
        yield(p, PARAM_SOURCES_PLACEMENT, given, "list");
    else if (given == PARAM_SOURCES_PLACEMENT && v->integer != PLACED_BY_LIST)
        yield(p, PARAM_SOURCES_FILE, given, "");
}

gboolean params_assign(Params *p, ParamId id, const char *value, const Place *place, GError **error)
{
    Value parsed;
    if (!value_parse(&table[id], value, &parsed)) {
        refuse(id, value, place, error);
        return FALSE;
    }
    Entry *e = &p->entry[id];
    value_clear(&e->value);
    g_free(e->path);
    g_free(e->origin);
    e->value = parsed;
    e->origin = g_strdup(place->origin ? place->origin : "");
    e->over = place->line == 0;
    e->path = g_strdup(parsed.text);
    if (table[id].type == TYPE_FILE && place->folder && strcmp(place->folder, ".") != 0 && *parsed.text &&
        !g_path_is_absolute(parsed.text)) {
        g_free(e->path);
        e->path = g_build_filename(place->folder, parsed.text, NULL);
    }
    settle(p, id);
    return TRUE;
}

gboolean params_set(Params *p, ParamId id, const char *value, const char *origin, GError **error)
{
    return params_assign(p, id, value, &(Place){origin, 0, NULL}, error);
}

static gboolean refuse_override(const char *assignment, const char *dotted, GError **error)
{
    char *found = param_quote(assignment);
    if (!dotted) {
        g_set_error(error, PARAM_ERROR, PARAM_ERROR_VALUE, "--set %s: must be section.key=value", found);
    } else {
        char *hint = suggest_dotted(dotted);
        g_set_error(error, PARAM_ERROR, PARAM_ERROR_UNKNOWN, "--set %s: no such parameter; %s", found, hint);
        g_free(hint);
    }
    g_free(found);
    return FALSE;
}

gboolean params_override(Params *p, const char *assignment, GError **error)
{
    const char *equals = strchr(assignment, '=');
    if (!equals)
        return refuse_override(assignment, NULL, error);
    char *dotted = g_strstrip(g_strndup(assignment, (gsize)(equals - assignment)));
    int id = param_find(dotted);
    gboolean good =
        id >= 0 ? params_set(p, (ParamId)id, equals + 1, "--set", error) : refuse_override(assignment, dotted, error);
    g_free(dotted);
    return good;
}

static const Value *value(const Params *p, ParamId id, ParamType type)
{
    g_assert(table[id].type == type);
    return &p->entry[id].value;
}

double params_number(const Params *p, ParamId id)
{
    return value(p, id, TYPE_NUMBER)->number;
}

int64_t params_integer(const Params *p, ParamId id)
{
    return value(p, id, TYPE_INTEGER)->integer;
}

bool params_switch(const Params *p, ParamId id)
{
    return value(p, id, TYPE_SWITCH)->integer != 0;
}

int params_choice(const Params *p, ParamId id)
{
    return (int)value(p, id, TYPE_CHOICE)->integer;
}

uint32_t params_colour(const Params *p, ParamId id)
{
    return (uint32_t)value(p, id, TYPE_COLOUR)->integer;
}

const char *params_text(const Params *p, ParamId id)
{
    g_assert(table[id].type == TYPE_TEXT || table[id].type == TYPE_FILE);
    return p->entry[id].path;
}

const double *params_list(const Params *p, ParamId id, uint32_t *n)
{
    g_assert(table[id].type == TYPE_NUMBERS || table[id].type == TYPE_POINTS);
    *n = p->entry[id].value.n;
    return p->entry[id].value.list;
}

bool params_is_given(const Params *p, ParamId id)
{
    return p->entry[id].origin != NULL;
}

const char *params_origin(const Params *p, ParamId id)
{
    return p->entry[id].origin ? p->entry[id].origin : "default";
}

char *params_place(const Params *p, ParamId id)
{
    const char *origin = params_origin(p, id);
    if (is_option(origin))
        return g_strdup(origin);
    char *name = g_filename_display_name(origin);
    char *place = strcmp(origin, "--set") == 0 ? g_strdup_printf("--set %s.%s", table[id].section, table[id].key)
                                               : g_strdup_printf("%s: [%s] %s", name, table[id].section, table[id].key);
    g_free(name);
    return place;
}

char *params_format(const Params *p, ParamId id)
{
    return value_format(&table[id], &p->entry[id].value);
}
