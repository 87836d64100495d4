/* GraphML read as a stream, and what it says handed to a draft. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "import/draft.h"

G_DEFINE_QUARK(venation-import-error-quark, import_error)

/* Where the reader is. */
typedef enum { AT_START, IN_GRAPHML, IN_KEY, IN_GRAPH, IN_NODE, IN_EDGE, IN_DATA, IN_DEFAULT } Place;

/* A <key>: the field that its data are of nodes, edges or graphs; FIELD_COUNT: none of ours. */
typedef struct {
    char *id;
    FieldId field[DOMAIN_COUNT];
} Key;

typedef struct {
    Draft draft;
    GMarkupParseContext *markup;
    char *file;
    char *prefix;      /* of the file's elements, as "g:"; mostly "" */
    Place place, outer; /* outer: what a <data> belongs to */
    guint passed_over; /* open elements from one on that does not concern us */
    GArray *keys;
    guint next_key;    /* keys mostly come in turn */
    unsigned declared; /* FIELD_BIT of the fields that have keys */
    char *standard[FIELD_COUNT]; /* defaults; NULL: none */
    bool has_graph, directed; /* edges are unless they say otherwise */
    FieldId field;     /* of the open <data> */
    uint32_t line;     /* where it, or a <key>, begins */
    GString *text;     /* of it */
    Item item;         /* the open node or edge */
    unsigned graph_given;
} Reader;

static uint32_t line_of(const Reader *r)
{
    int line = 0;
    g_markup_parse_context_get_position(r->markup, &line, NULL);
    return (uint32_t)line;
}

static const char *attribute(const char **names, const char **values, const char *name)
{
    for (; *names != NULL; names++, values++)
        if (strcmp(*names, name) == 0)
            return *values;
    return NULL;
}

#define FAIL(r, code, error, ...) draft_fail(&(r)->draft, line_of(r), code, error, __VA_ARGS__)

/* ---- values ---- */

/* "node 'a'", "edge 'a' – 'b'", "the graph". Free it. */
static char *owner_text(const Reader *r)
{
    const Names *names = &r->draft.names;
    if (r->outer == IN_GRAPH)
        return g_strdup("the graph");
    char *a = names_quoted(names, r->outer == IN_NODE ? r->item.name : r->item.source);
    char *b = r->outer == IN_NODE ? NULL : names_quoted(names, r->item.target);
    char *text = b != NULL ? g_strdup_printf("edge %s – %s", a, b) : g_strdup_printf("node %s", a);
    g_free(a);
    g_free(b);
    return text;
}

/* Puts the owner and the place before what is wrong with it. */
static gboolean place_error(const Reader *r, uint32_t line, GError *cause, GError **error)
{
    char *owner = owner_text(r);
    draft_fail(&r->draft, line, (ImportErrorCode)cause->code, error, "%s: %s", owner, cause->message);
    g_free(owner);
    g_error_free(cause);
    return FALSE;
}

static gboolean take_graph_value(Reader *r, FieldId field, const char *text, gsize length, GError **error)
{
    double steps = 0.0;
    r->draft.given[field] = 1;
    if (field == FIELD_MARGIN)
        return (r->draft.net->margin = field_margin(text, length, error)) != NULL;
    if (field == FIELD_HOLES)
        return (r->draft.net->holes = field_holes(text, length, error)) != NULL;
    if (field == FIELD_BASE || field == FIELD_TIP)
        return field_point(field, text, length, field == FIELD_BASE ? &r->draft.base : &r->draft.tip, error);
    if (!field_value(field, text, length, &steps, error))
        return FALSE;
    r->draft.net->n_steps = (uint32_t)steps;
    return TRUE;
}

/* One value of the open node, edge or graph. */
static gboolean take_value(Reader *r, FieldId field, const char *text, gsize length, uint32_t line, GError **error)
{
    GError *cause = NULL;
    unsigned *given = r->outer == IN_GRAPH ? &r->graph_given : &r->item.given;
    if (*given & FIELD_BIT(field))
        cause = g_error_new(IMPORT_ERROR, IMPORT_ERROR_SYNTAX, "%s is given a second time", field_name(field));
    else if (r->outer == IN_GRAPH)
        take_graph_value(r, field, text, length, &cause);
    else
        field_value(field, text, length, &r->item.value[field], &cause);
    *given |= FIELD_BIT(field);
    return cause == NULL || place_error(r, line, cause, error);
}

/* The defaults of what the open node, edge or graph does not say. */
static gboolean take_standards(Reader *r, Domain domain, GError **error)
{
    gboolean good = TRUE;
    unsigned given = domain == DOMAIN_GRAPH ? r->graph_given : r->item.given;
    for (guint f = 0; f < FIELD_COUNT && good; f++)
        if (r->standard[f] != NULL && field_domain((FieldId)f) == domain && !(given & FIELD_BIT(f)))
            good = take_value(r, (FieldId)f, r->standard[f], strlen(r->standard[f]), r->item.line, error);
    return good;
}

/* ---- keys ---- */

static Key *find_key(Reader *r, const char *id)
{
    for (guint i = 0; i < r->keys->len; i++) {
        guint k = r->next_key + i < r->keys->len ? r->next_key + i : r->next_key + i - r->keys->len;
        Key *key = &g_array_index(r->keys, Key, k);
        if (strcmp(key->id, id) == 0) {
            r->next_key = k + 1 < r->keys->len ? k + 1 : 0;
            return key;
        }
    }
    return NULL;
}

static gboolean open_key(Reader *r, const char **names, const char **values, GError **error)
{
    static const char *const domains[DOMAIN_COUNT] = {"node", "edge", "graph"};
    const char *id = attribute(names, values, "id"), *of = attribute(names, values, "for"), *name = attribute(names, values, "attr.name");
    if (id == NULL)
        return FAIL(r, IMPORT_ERROR_SYNTAX, error, "a <key> without id");
    if (find_key(r, id) != NULL) {
        char *text = names_quote(id);
        FAIL(r, IMPORT_ERROR_SYNTAX, error, "a second <key> with the id %s", text);
        g_free(text);
        return FALSE;
    }
    Key key = {.id = g_strdup(id)};
    for (int i = 0; i < DOMAIN_COUNT; i++) {
        bool meant = of == NULL || strcmp(of, "all") == 0 || strcmp(of, domains[i]) == 0;
        key.field[i] = meant && name != NULL ? field_find((Domain)i, name) : FIELD_COUNT;
        if (key.field[i] != FIELD_COUNT)
            r->declared |= FIELD_BIT(key.field[i]);
    }
    g_array_append_val(r->keys, key);
    r->place = IN_KEY;
    return TRUE;
}

/* The default of the last <key>. */
static void take_default(Reader *r)
{
    const Key *key = &g_array_index(r->keys, Key, r->keys->len - 1);
    for (int i = 0; i < DOMAIN_COUNT; i++)
        if (key->field[i] != FIELD_COUNT && r->standard[key->field[i]] == NULL)
            r->standard[key->field[i]] = g_strdup(r->text->str);
}

/* ---- elements ---- */

static gboolean open_root(Reader *r, const char *element, GError **error)
{
    const char *colon = strchr(element, ':'), *name = colon != NULL ? colon + 1 : element;
    if (strcmp(name, "graphml") != 0) {
        char *text = names_quote(element);
        FAIL(r, IMPORT_ERROR_SYNTAX, error, "not GraphML: it begins with the element %s, not 'graphml'", text);
        g_free(text);
        return FALSE;
    }
    r->prefix = g_strndup(element, (gsize)(name - element));
    r->place = IN_GRAPHML;
    return TRUE;
}

static gboolean open_graph(Reader *r, const char **names, const char **values, GError **error)
{
    if (r->has_graph)
        return FAIL(r, IMPORT_ERROR_SYNTAX, error, "a second <graph>; a venation is a single one");
    const char *direction = attribute(names, values, "edgedefault");
    r->has_graph = true;
    r->directed = direction != NULL && strcmp(direction, "directed") == 0;
    r->place = IN_GRAPH;
    return TRUE;
}

static gboolean open_node(Reader *r, const char **names, const char **values, GError **error)
{
    const char *id = attribute(names, values, "id");
    if (id == NULL)
        return FAIL(r, IMPORT_ERROR_SYNTAX, error, "a <node> without id");
    r->item.line = line_of(r);
    r->item.given = 0;
    r->item.name = names_number(&r->draft.names, id);
    r->place = IN_NODE;
    return TRUE;
}

static gboolean open_edge(Reader *r, const char **names, const char **values, GError **error)
{
    const char *source = attribute(names, values, "source"), *target = attribute(names, values, "target");
    const char *directed = attribute(names, values, "directed");
    if (source == NULL || target == NULL)
        return FAIL(r, IMPORT_ERROR_SYNTAX, error, "an <edge> without %s", source == NULL ? "source" : "target");
    r->item.line = line_of(r);
    r->item.given = 0;
    r->item.source = names_number(&r->draft.names, source);
    r->item.target = names_number(&r->draft.names, target);
    r->item.directed = directed != NULL ? strcmp(directed, "true") == 0 || strcmp(directed, "1") == 0 : r->directed;
    r->place = IN_EDGE;
    return TRUE;
}

static gboolean open_data(Reader *r, const char **names, const char **values, GError **error)
{
    const char *id = attribute(names, values, "key");
    const Key *key = id != NULL ? find_key(r, id) : NULL;
    if (key == NULL) {
        char *text = names_quote(id != NULL ? id : "");
        if (id == NULL)
            FAIL(r, IMPORT_ERROR_SYNTAX, error, "a <data> without key");
        else
            FAIL(r, IMPORT_ERROR_SYNTAX, error, "data of the key %s, but there is no <key> with that id before the <graph>", text);
        g_free(text);
        return FALSE;
    }
    Domain domain = r->place == IN_NODE ? DOMAIN_NODE : r->place == IN_EDGE ? DOMAIN_EDGE : DOMAIN_GRAPH;
    r->outer = r->place;
    r->place = IN_DATA;
    r->field = key->field[domain];
    r->line = line_of(r);
    g_string_truncate(r->text, 0);
    return TRUE;
}

/* An element inside another one that concerns us. Elements of other vocabularies, descriptions and ports are passed over. */
static gboolean open_inner(Reader *r, const char *name, const char **names, const char **values, GError **error)
{
    bool holder = r->place == IN_GRAPH || r->place == IN_NODE || r->place == IN_EDGE;
    if (holder && strcmp(name, "data") == 0)
        return open_data(r, names, values, error);
    if (r->place == IN_GRAPH && strcmp(name, "node") == 0)
        return open_node(r, names, values, error);
    if (r->place == IN_GRAPH && strcmp(name, "edge") == 0)
        return open_edge(r, names, values, error);
    if (holder && (strcmp(name, "graph") == 0 || strcmp(name, "hyperedge") == 0))
        return FAIL(r, IMPORT_ERROR_SYNTAX, error, "a <%s>; a venation is one graph of plain nodes and edges", name);
    if (r->place == IN_GRAPHML && strcmp(name, "key") == 0)
        return open_key(r, names, values, error);
    if (r->place == IN_GRAPHML && strcmp(name, "graph") == 0)
        return open_graph(r, names, values, error);
    if (r->place == IN_KEY && strcmp(name, "default") == 0) {
        r->place = IN_DEFAULT;
        g_string_truncate(r->text, 0);
        return TRUE;
    }
    r->passed_over = 1;
    return TRUE;
}

static void start_element(GMarkupParseContext *context, const char *element, const char **names, const char **values, gpointer user,
                          GError **error)
{
    Reader *r = user;
    if (r->passed_over > 0)
        r->passed_over++;
    else if (r->place == AT_START)
        open_root(r, element, error);
    else if (g_str_has_prefix(element, r->prefix))
        open_inner(r, element + strlen(r->prefix), names, values, error);
    else
        r->passed_over = 1;
}

static void add_text(GMarkupParseContext *context, const char *piece, gsize length, gpointer user, GError **error)
{
    Reader *r = user;
    if (r->passed_over == 0 && ((r->place == IN_DATA && r->field != FIELD_COUNT) || r->place == IN_DEFAULT))
        g_string_append_len(r->text, piece, (gssize)length);
}

static gboolean close_node(Reader *r, GError **error)
{
    r->outer = IN_NODE;
    if (!take_standards(r, DOMAIN_NODE, error))
        return FALSE;
    for (FieldId f = FIELD_X; f <= FIELD_Y; f++) {
        if (r->item.given & FIELD_BIT(f))
            continue;
        char *owner = owner_text(r);
        draft_fail(&r->draft, r->item.line, IMPORT_ERROR_SYNTAX, error, "%s has no %s; every node needs x and y, in segments%s", owner,
                   field_name(f), r->declared & FIELD_BIT(f) ? "" : ", and there is no <key> for nodes with that attr.name");
        g_free(owner);
        return FALSE;
    }
    return draft_add_node(&r->draft, &r->item, error);
}

static gboolean close_edge(Reader *r, GError **error)
{
    r->outer = IN_EDGE;
    return take_standards(r, DOMAIN_EDGE, error) && draft_add_edge(&r->draft, &r->item, error);
}

static void end_element(GMarkupParseContext *context, const char *element, gpointer user, GError **error)
{
    Reader *r = user;
    if (r->passed_over > 0) {
        r->passed_over--;
        return;
    }
    switch (r->place) {
    case IN_DATA:
        r->place = r->outer;
        if (r->field != FIELD_COUNT)
            take_value(r, r->field, r->text->str, r->text->len, r->line, error);
        break;
    case IN_NODE:
        r->place = IN_GRAPH;
        close_node(r, error);
        break;
    case IN_EDGE:
        r->place = IN_GRAPH;
        close_edge(r, error);
        break;
    case IN_DEFAULT:
        r->place = IN_KEY;
        take_default(r);
        break;
    case IN_GRAPH:
        r->place = IN_GRAPHML;
        r->outer = IN_GRAPH;
        r->item.line = line_of(r);
        take_standards(r, DOMAIN_GRAPH, error);
        break;
    default:
        r->place = IN_GRAPHML;
    }
}

/* ---- the whole ---- */

static void reader_init(Reader *r, const char *path)
{
    static const GMarkupParser parser = {.start_element = start_element, .end_element = end_element, .text = add_text};
    *r = (Reader){.file = g_filename_display_name(path), .keys = g_array_new(FALSE, FALSE, sizeof(Key)), .text = g_string_new(NULL)};
    draft_init(&r->draft, r->file);
    r->markup = g_markup_parse_context_new(&parser, G_MARKUP_TREAT_CDATA_AS_TEXT, r, NULL);
}

static void reader_clear(Reader *r)
{
    g_markup_parse_context_free(r->markup);
    for (guint i = 0; i < r->keys->len; i++)
        g_free(g_array_index(r->keys, Key, i).id);
    for (int f = 0; f < FIELD_COUNT; f++)
        g_free(r->standard[f]);
    g_array_unref(r->keys);
    g_string_free(r->text, TRUE);
    g_free(r->prefix);
    draft_clear(&r->draft);
    g_free(r->file);
}

/* Passes our errors on, and makes GLib's ours. */
static gboolean end_parse(const Reader *r, GError *cause, GError **error)
{
    if (cause == NULL)
        return TRUE;
    if (cause->domain == IMPORT_ERROR) {
        g_propagate_error(error, cause);
        return FALSE;
    }
    const char *what = cause->message, *colon = strstr(what, ": ");
    if (g_str_has_prefix(what, "Error on line ") && colon != NULL)
        what = colon + 2;
    char *valid = g_utf8_make_valid(what, -1); /* it may quote bytes of the file */
    FAIL(r, IMPORT_ERROR_SYNTAX, error, "not well-formed XML: %s", valid);
    g_free(valid);
    g_error_free(cause);
    return FALSE;
}

/* GLib looks for this too, but in CDATA goes on with half an error. */
static gboolean check_text(const Reader *r, const char *piece, gsize length, GError **error)
{
    unsigned char bits = 0;
    for (gsize i = 0; i < length; i++)
        bits |= (unsigned char)piece[i];
    const char *stop = memchr(piece, '\0', length);
    if (stop == NULL && (bits < 0x80 || g_utf8_validate(piece, (gssize)length, &stop)))
        return TRUE;
    uint32_t line = line_of(r);
    for (const char *c = piece; c < stop; c++)
        line += *c == '\n';
    return draft_fail(&r->draft, line, IMPORT_ERROR_SYNTAX, error, "not UTF-8 text, as GraphML must be");
}

/* A piece is whole characters, and but for the first one begins with no newline. */
static gboolean feed(Reader *r, const char *piece, gsize length, gboolean first, GError **error)
{
    GError *cause = NULL;
    gsize mark = first && length >= 3 && memcmp(piece, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0; /* byte order mark */
    if (!check_text(r, piece, length, error))
        return FALSE;
    g_markup_parse_context_parse(r->markup, piece + mark, (gssize)(length - mark), &cause);
    return end_parse(r, cause, error);
}

/* How much of a piece to read now: the next one must not begin within a character, nor with a newline, which GLib would not count. */
static gsize piece_end(const char *piece, gsize n)
{
    enum { MOST_KEPT = 1 << 10 };
    gsize end = n - 1;
    while (n - end < MOST_KEPT && (piece[end] == '\n' || ((unsigned char)piece[end] & 0xC0) == 0x80))
        end--;
    return end;
}

static Network *finish(Reader *r, const WidthDef *widths, GError **error)
{
    GError *cause = NULL;
    g_markup_parse_context_end_parse(r->markup, &cause);
    if (!end_parse(r, cause, error))
        return NULL;
    if (!r->has_graph) {
        FAIL(r, IMPORT_ERROR_GRAPH, error, "there is no <graph>");
        return NULL;
    }
    return draft_finish(&r->draft, widths, error);
}

static gboolean fail_read(const Reader *r, int code, GError **error)
{
    g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(code), "%s: cannot be read: %s", r->file, g_strerror(code));
    return FALSE;
}

static gboolean feed_file(Reader *r, const char *path, GError **error)
{
    enum { PIECE = 1 << 16 };
    FILE *file = fopen(path, "rbe");
    if (file == NULL)
        return fail_read(r, errno, error);
    char *piece = g_malloc(PIECE);
    gsize kept = 0;
    gboolean good = TRUE, first = TRUE, last = FALSE;
    while (good && !last) {
        errno = 0;
        gsize n = kept + fread(piece + kept, 1, PIECE - kept, file);
        last = n < PIECE;
        if (ferror(file)) {
            good = fail_read(r, errno, error);
            break;
        }
        gsize end = last ? n : piece_end(piece, n);
        good = feed(r, piece, end, first, error);
        first = FALSE;
        kept = n - end;
        memmove(piece, piece + end, kept);
    }
    g_free(piece);
    fclose(file);
    return good;
}

Network *import_graphml(const char *path, const WidthDef *widths, GError **error)
{
    Reader r;
    reader_init(&r, path);
    Network *net = feed_file(&r, path, error) ? finish(&r, widths, error) : NULL;
    reader_clear(&r);
    return net;
}

Network *import_graphml_text(const char *text, gsize length, const char *name, const WidthDef *widths, GError **error)
{
    Reader r;
    reader_init(&r, name);
    Network *net = length == 0 || feed(&r, text, length, TRUE, error) ? finish(&r, widths, error) : NULL;
    reader_clear(&r);
    return net;
}
