#include "geom/svgstyle.h"

#include <string.h>

/* A declaration of a rule, for one of the rule's selectors. */
typedef struct {
    char *element, *id;     /* NULL: any */
    char **classes;         /* all of these */
    unsigned weight;        /* ids count most, then classes, then names (CSS 2.1, 6.4.3) */
    bool important;
    char *property, *value;
} Rule;

struct SvgStyle {
    GArray *rule; /* in order */
};

static void rule_clear(gpointer rule)
{
    Rule *r = rule;
    g_free(r->element);
    g_free(r->id);
    g_strfreev(r->classes);
    g_free(r->property);
    g_free(r->value);
}

SvgStyle *svgstyle_new(void)
{
    SvgStyle *s = g_new(SvgStyle, 1);
    s->rule = g_array_new(FALSE, FALSE, sizeof(Rule));
    g_array_set_clear_func(s->rule, rule_clear);
    return s;
}

void svgstyle_free(SvgStyle *s)
{
    if (!s)
        return;
    g_array_unref(s->rule);
    g_free(s);
}

/* ---- declarations ---- */

/* Splits "name: value !important"; false for anything else. Both strings are the caller's. */
static bool read_declaration(const char *text, char **name, char **value, bool *important)
{
    const char *colon = strchr(text, ':');
    if (!colon)
        return false;
    *name = g_strstrip(g_strndup(text, (gsize)(colon - text)));
    *value = g_strdup(colon + 1);
    char *mark = strchr(*value, '!');
    *important = mark && !g_ascii_strcasecmp(g_strstrip(mark + 1), "important");
    if (mark)
        *mark = '\0';
    g_strstrip(*value);
    return true;
}

/* The last declaration of a property counts, but an important one stays. */
static char *find_declaration(const char *style, const char *property, bool *important)
{
    char **part = g_strsplit(style ? style : "", ";", -1), *found = NULL;
    *important = false;
    for (guint k = 0; part[k]; k++) {
        char *name, *value;
        bool strong;
        if (!read_declaration(part[k], &name, &value, &strong))
            continue;
        if (!strcmp(name, property) && (strong || !*important)) {
            g_free(found);
            found = g_steal_pointer(&value);
            *important = strong;
        }
        g_free(name);
        g_free(value);
    }
    g_strfreev(part);
    return found;
}

/* ---- selectors ---- */

static gsize name_length(const char *s)
{
    gsize n = 0;
    while (g_ascii_isalnum(s[n]) || s[n] == '-' || s[n] == '_' || (guchar)s[n] >= 0x80)
        n++;
    return n;
}

/* "path.st0#a" to what it asks for; false for what isn't read. */
static bool read_selector(const char *text, Rule *r)
{
    GPtrArray *classes = g_ptr_array_new();
    char *trimmed = g_strstrip(g_strdup(text));
    const char *at = trimmed;
    gsize n = name_length(at);
    bool good = *at != '\0';
    *r = (Rule){.element = n ? g_strndup(at, n) : NULL, .weight = n ? 1 : 0};
    at += n ? n : *at == '*';
    for (; good && *at; at += n) {
        char kind = *at++;
        n = name_length(at);
        good = n > 0 && (kind == '.' || (kind == '#' && !r->id));
        if (good && kind == '.')
            g_ptr_array_add(classes, g_strndup(at, n));
        else if (good)
            r->id = g_strndup(at, n);
        r->weight += kind == '.' ? 1u << 10 : 1u << 20;
    }
    g_ptr_array_add(classes, NULL);
    r->classes = (char **)g_ptr_array_free(classes, FALSE);
    g_free(trimmed);
    if (!good)
        rule_clear(r);
    return good;
}

static void add_rule(SvgStyle *s, const char *selector, const char *body)
{
    char **part = g_strsplit(body, ";", -1);
    for (guint k = 0; part[k]; k++) {
        Rule r;
        char *name, *value;
        bool important;
        if (!read_declaration(part[k], &name, &value, &important))
            continue;
        if (read_selector(selector, &r)) {
            r.property = g_steal_pointer(&name);
            r.value = g_steal_pointer(&value);
            r.important = important;
            g_array_append_val(s->rule, r);
        }
        g_free(name);
        g_free(value);
    }
    g_strfreev(part);
}

/* ---- sheets ---- */

static char *without_comments(const char *text)
{
    GString *s = g_string_new(NULL);
    for (const char *open; (open = strstr(text, "/*"));) {
        const char *close = strstr(open + 2, "*/");
        g_string_append_len(s, text, open - text);
        g_string_append_c(s, ' ');
        text = close ? close + 2 : "";
    }
    g_string_append(s, text);
    return g_string_free(s, FALSE);
}

/* Behind a block that opens here, or the whole rest when it doesn't close. */
static const char *block_end(const char *open)
{
    int depth = 0;
    const char *at = open;
    do {
        depth += (*at == '{') - (*at == '}');
    } while (*at && *++at && depth > 0);
    return at;
}

void svgstyle_add(SvgStyle *s, const char *text)
{
    char *clean = without_comments(text);
    const char *at = clean;
    for (const char *open; (open = strpbrk(at, "{;"));) {
        const char *end = *open == '{' ? block_end(open) : open + 1;
        while (g_ascii_isspace(*at))
            at++;
        if (*open == '{' && *at != '@') {
            char *body = g_strndup(open + 1, (gsize)(end - open - 1)), *prelude = g_strndup(at, (gsize)(open - at));
            char **selector = g_strsplit(prelude, ",", -1), *close = strrchr(body, '}');
            if (close)
                *close = '\0';
            for (guint k = 0; selector[k]; k++)
                add_rule(s, selector[k], body);
            g_strfreev(selector);
            g_free(prelude);
            g_free(body);
        }
        at = end;
    }
    g_free(clean);
}

/* ---- the cascade ---- */

static bool has_class(const char *classes, const char *name)
{
    gsize n = strlen(name);
    for (const char *at = classes; at && *at;) {
        gsize skip = strspn(at, " \t\r\n"), length = strcspn(at + skip, " \t\r\n");
        if (length == n && !strncmp(at + skip, name, n))
            return true;
        at += skip + length;
    }
    return false;
}

static bool applies(const Rule *r, const char *element, const char *id, const char *classes)
{
    bool all = (!r->element || !g_strcmp0(r->element, element)) && (!r->id || !g_strcmp0(r->id, id));
    for (guint k = 0; all && r->classes[k]; k++)
        all = has_class(classes, r->classes[k]);
    return all;
}

char *svgstyle_property(const SvgStyle *s, const char *element, const char *id, const char *classes, const char *style, const char *plain,
                        const char *property)
{
    const Rule *best = NULL;
    for (guint k = 0; s && k < s->rule->len; k++) {
        const Rule *r = &g_array_index(s->rule, Rule, k);
        if (strcmp(r->property, property) || (best && (r->important == best->important ? r->weight < best->weight : best->important)) ||
            !applies(r, element, id, classes))
            continue;
        best = r;
    }
    bool important;
    char *own = find_declaration(style, property, &important);
    if (best && (!own || (best->important && !important))) {
        g_free(own);
        return g_strdup(best->value);
    }
    return own || !plain ? own : g_strstrip(g_strdup(plain));
}
