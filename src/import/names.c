#include "import/names.h"

#include <string.h>

void names_init(Names *names)
{
    *names = (Names){.numbers = g_hash_table_new(g_str_hash, g_str_equal), .store = g_string_chunk_new(1 << 16)};
}

void names_clear(Names *names)
{
    g_free(names->node);
    g_free(names->text);
    g_hash_table_unref(names->numbers);
    g_string_chunk_free(names->store);
}

/* The number that a text is in plain decimal, without needless zeros; NONE for any other text. */
static uint32_t plain_number(const char *text)
{
    uint64_t value = 0;
    guint n = 0;
    for (; g_ascii_isdigit(text[n]) && n < 10; n++)
        value = value * 10 + (uint64_t)(text[n] - '0');
    return n == 0 || text[n] != '\0' || (text[0] == '0' && n > 1) || value >= NONE ? NONE : (uint32_t)value;
}

static uint32_t add(Names *names, const char *text, bool plain)
{
    if (names->n == names->room) {
        names->room = MAX(names->room + names->room / 2, 1024);
        names->node = g_renew(uint32_t, names->node, names->room);
        names->text = g_renew(const char *, names->text, names->room);
    }
    uint32_t number = names->n++;
    names->node[number] = NONE;
    names->text[number] = plain ? NULL : g_string_chunk_insert(names->store, text);
    if (!plain)
        g_hash_table_insert(names->numbers, (gpointer)names->text[number], GUINT_TO_POINTER(number + 1));
    return number;
}

uint32_t names_number(Names *names, const char *text)
{
    uint32_t number = plain_number(text);
    if (number < names->n && names->text[number] == NULL)
        return number;
    guint known = GPOINTER_TO_UINT(g_hash_table_lookup(names->numbers, text));
    return known > 0 ? known - 1 : add(names, text, number == names->n);
}

char *names_quote(const char *text)
{
    enum { LONGEST = 60 };
    GString *s = g_string_new("'");
    glong n = 0;
    for (const char *c = text; *c != '\0' && n < LONGEST; c = g_utf8_next_char(c), n++) {
        gunichar u = g_utf8_get_char(c);
        g_string_append_unichar(s, g_unichar_iscntrl(u) ? 0xFFFD : u);
    }
    g_string_append(s, n == LONGEST ? "…'" : "'");
    return g_string_free(s, FALSE);
}

char *names_quoted(const Names *names, uint32_t number)
{
    return names->text[number] != NULL ? names_quote(names->text[number]) : g_strdup_printf("'%u'", number);
}
