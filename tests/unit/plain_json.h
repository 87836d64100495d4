/* JSON read the plain way, for tests of what is written: any fault in it ends the test. */
#ifndef PLAIN_JSON_H
#define PLAIN_JSON_H

#include <glib.h>
#include <string.h>

typedef struct Json Json;
struct Json {
    char kind; /* { [ " 0 t f n */
    char *text;
    double number;
    GPtrArray *key, *item;
};

static void json_free(gpointer data)
{
    Json *j = data;
    g_free(j->text);
    if (j->key != NULL)
        g_ptr_array_unref(j->key);
    if (j->item != NULL)
        g_ptr_array_unref(j->item);
    g_free(j);
}

static void skip(const char **s) { *s += strspn(*s, " \n\t\r"); }

static void expect(const char **s, char c)
{
    skip(s);
    if (**s != c)
        g_error("JSON: '%c' expected before %.40s", c, *s);
    (*s)++;
}

static char *json_string(const char **s)
{
    GString *text = g_string_new(NULL);
    for (expect(s, '"'); **s != '"'; (*s)++) {
        g_assert_true((unsigned char)**s >= 0x20);
        if (**s == '\\') {
            (*s)++;
            g_assert_nonnull(strchr("\"\\/bfnrtu", **s));
            g_string_append_c(text, **s == 'n' ? '\n' : **s);
        } else {
            g_string_append_c(text, **s);
        }
    }
    (*s)++;
    return g_string_free(text, FALSE);
}

static Json *json_read(const char **s)
{
    Json *j = g_new0(Json, 1);
    skip(s);
    j->kind = **s;
    if (**s == '{' || **s == '[') {
        char end = **s == '{' ? '}' : ']';
        j->item = g_ptr_array_new_with_free_func(json_free);
        j->key = g_ptr_array_new_with_free_func(g_free);
        (*s)++;
        skip(s);
        while (**s != end) {
            if (j->item->len > 0)
                expect(s, ',');
            if (end == '}') {
                g_ptr_array_add(j->key, json_string(s));
                expect(s, ':');
            }
            g_ptr_array_add(j->item, json_read(s));
            skip(s);
        }
        (*s)++;
    } else if (**s == '"') {
        j->text = json_string(s);
    } else if (strchr("tfn", **s) != NULL) {
        *s += **s == 'f' ? 5 : 4;
    } else {
        char *end;
        j->kind = '0';
        j->number = g_ascii_strtod(*s, &end);
        g_assert_true(end > *s);
        *s = end;
    }
    return j;
}

static const Json *get(const Json *j, const char *key)
{
    for (guint i = 0; j != NULL && j->key != NULL && i < j->key->len; i++)
        if (strcmp(j->key->pdata[i], key) == 0)
            return j->item->pdata[i];
    return NULL;
}

static const Json *at(const Json *j, guint i)
{
    g_assert_nonnull(j);
    g_assert_cmpint(j->kind, ==, '[');
    g_assert_cmpuint(i, <, j->item->len);
    return j->item->pdata[i];
}

static guint length(const Json *j) { return j != NULL ? j->item->len : 0; }

static guint whole(const Json *j)
{
    g_assert_nonnull(j);
    g_assert_cmpint(j->kind, ==, '0');
    return (guint)j->number;
}

static void assert_text(const Json *j, const char *text)
{
    g_assert_nonnull(j);
    g_assert_cmpstr(j->text, ==, text);
}

#endif
