#include "sim/lsystem.h"

#include <string.h>

#include "geom/random.h"

G_DEFINE_QUARK(venation-lsystem-error-quark, lsystem_error)

enum { MAX_ITERATIONS = 1000, MAX_SYMBOLS = 1 << 28 };

static const char turtle_symbols[] = "+-[]|!@^<>~$";

/* --- leaves --- */

enum { MAX_TURNS = 4, N_PRODUCTIONS = 8 };

/* `l` and `r` turn left and right by as many angles of the system as a lateral leaves the midvein at. A lateral's steps are a third of an
 * internode (THIRD: 0.9^11). From each a vein of the third order, twice the lateral's angle off, crosses half of the space to the next
 * lateral and bears a veinlet; the lowest pair (M, N) has on its outer side veins that run to the margin, as where bases are broad or lobed. What
 * is left to the margin when the last iteration is done has no branches. */
#define THIRD "@@@@@@@@@@@"
#define LATERALS(l, r, start, left_outer, right_outer, left, right)                                                                       \
    "[" l start THIRD "FF[" r r "T]" left_outer "F[" r r "T]" left "$][" r start THIRD "FF[" l l "U]" right_outer "F[" l l "U]" right "$]"
#define SIDE(turns, t) "F[" turns t "]F[" turns t "]F[" turns t "]F[" turns t "]"
#define BRANCHED(turns, t, vein) "F[" turns t "]F[" turns t "]F[" turns t "][" vein "]F[" turns t "]"
#define PRODUCTIONS(l, r)                                                                                                                 \
    {                                                                                                                                     \
        "V=F" LATERALS(l, r, "", "", "", "L", "R") "V", "L=" SIDE(r r, "T") "L", "R=" SIDE(l l, "U") "R",                                 \
            "M=" BRANCHED(r r, "T", l "FFL$") "M", "N=" BRANCHED(l l, "U", r "FFR$") "N",                                                     \
            "T=F[" l "@@@@@@F]@@@@@@@F", "U=F[" r "@@@@@@F]@@@@@@@F", "W=F" LOWEST(l, r) "V"                                              \
    }
#define LOWEST(l, r) LATERALS(l, r, "~", "[" l "FFL$]", "[" r "FFR$]", "M", "N")
#define PINNATE(l, r) LOWEST(l, r) "V"
static const char *const production[MAX_TURNS][N_PRODUCTIONS] = {PRODUCTIONS("+", "-"), PRODUCTIONS("++", "--"),
                                                                 PRODUCTIONS("+++", "---"), PRODUCTIONS("++++", "----")};
static const char *const pinnate[MAX_TURNS] = {PINNATE("+", "-"), PINNATE("++", "--"), PINNATE("+++", "---"), PINNATE("++++", "----")};
/* A midvein in each lobe, beginning where they part; as many branches as there may be lobes. */
#define PALMATE(l, r) "^[<W][<<W][<<<W][<<<<W][>W][>>W][>>>W][>>>>W]" PINNATE(l, r)
static const char *const palmate[MAX_TURNS] = {PALMATE("+", "-"), PALMATE("++", "--"), PALMATE("+++", "---"), PALMATE("++++", "----")};

static LSystemDef def_of(bool lobes, uint32_t margin_veins)
{
    uint32_t n = (CLAMP(margin_veins, 8, 34) - 2) / 2;
    uint32_t turns = CLAMP((uint32_t)(50.0 * n / 180.0 + 0.5), 1, MAX_TURNS);
    LSystemDef def = {.axiom = (lobes ? palmate : pinnate)[turns - 1],
                      .production = production[turns - 1],
                      .n_productions = N_PRODUCTIONS,
                      .iterations = n,
                      .max_symbols = 1000000,
                      .draws = "VLRMN",
                      .angle = 180.0 / n,
                      .length_scale = 0.9,
                      .bend = 50.0,
                      .murray = true,
                      .widths = width_def_default(),
                      .width = 4.0,
                      .width_scale = 0.8};
    double whole = 0.0, last = 1.0; /* the midvein: a step of each iteration, and the bud at its end */
    for (uint32_t k = 1; k <= n; k++)
        whole += last *= def.length_scale;
    def.step = 0.97 / (whole + last);
    return def;
}

LSystemDef lsystem_def_pinnate(uint32_t margin_veins) { return def_of(false, margin_veins); }

LSystemDef lsystem_def_palmate(uint32_t margin_veins) { return def_of(true, margin_veins); }

LSystemDef lsystem_def_default(void) { return lsystem_def_pinnate(16); }

/* --- checks --- */

static bool check_range(const char *name, double value, double least, double most, GError **error)
{
    if (value >= least && value <= most)
        return true;
    g_set_error(error, LSYSTEM_ERROR, LSYSTEM_ERROR_SETTINGS, "the L-system's %s is %g; it must lie between %g and %g", name, value, least,
                most);
    return false;
}

bool lsystem_check(const LSystemDef *def, GError **error)
{
    return check_range("number of iterations", def->iterations, 0.0, MAX_ITERATIONS, error) &&
           check_range("limit of symbols", def->max_symbols, 1.0, MAX_SYMBOLS, error) &&
           check_range("angle", def->angle, -360.0, 360.0, error) && check_range("step", def->step, 1e-9, 1000.0, error) &&
           check_range("length scale", def->length_scale, 1e-3, 10.0, error) && check_range("bend", def->bend, -3600.0, 3600.0, error) &&
           check_range("width", def->width, 1e-9, 1e6, error) && check_range("width scale", def->width_scale, 1e-3, 10.0, error);
}

/* --- reading --- */

/* A production, or the axiom: text without blanks. */
typedef struct {
    char from;
    double weight;
    char *to;
    uint32_t length;
} Rule;

typedef struct {
    Rule *rule; /* [n] those of one symbol side by side, in the order given */
    uint32_t n;
    uint32_t first[129]; /* by symbol */
} Rules;

static bool is_symbol(char c) { return g_ascii_isalnum(c) || (c != '\0' && strchr(turtle_symbols, c) != NULL); }

static bool fail_syntax(const char *text, const char *where, GError **error, const char *format, ...) G_GNUC_PRINTF(4, 5);

/* "'F=F[' at character 4: …" */
static bool fail_syntax(const char *text, const char *where, GError **error, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *what = g_strdup_vprintf(format, args), *shown = g_strndup(text, 60);
    va_end(args);
    g_set_error(error, LSYSTEM_ERROR, LSYSTEM_ERROR_SYNTAX, "L-system '%s%s' at character %u: %s", shown, strlen(text) > 60 ? "…" : "",
                (guint)(where - text) + 1, what);
    g_free(what);
    g_free(shown);
    return false;
}

static const char *skip_blanks(const char *at)
{
    while (*at == ' ' || *at == '\t')
        at++;
    return at;
}

/* Symbols from `at` to the end of the text, brackets in pairs, without the blanks. */
static bool read_symbols(const char *text, const char *at, Rule *rule, GError **error)
{
    GString *to = g_string_new(NULL);
    GArray *open = g_array_new(FALSE, FALSE, sizeof(const char *));
    bool good = true;
    for (at = skip_blanks(at); *at && good; at = skip_blanks(at + 1)) {
        if (!is_symbol(*at))
            good = fail_syntax(text, at, error, "symbols are letters, digits and %s", turtle_symbols);
        else if (*at == ']' && open->len == 0)
            good = fail_syntax(text, at, error, "no [ belongs to this ]");
        else if (*at == ']')
            g_array_set_size(open, open->len - 1);
        else if (*at == '[')
            g_array_append_val(open, at);
        g_string_append_c(to, *at);
    }
    if (good && open->len > 0)
        good = fail_syntax(text, g_array_index(open, const char *, open->len - 1), error, "no ] belongs to this [");
    g_array_unref(open);
    rule->length = (uint32_t)to->len;
    rule->to = g_string_free(to, FALSE);
    return good;
}

static bool read_rule(const char *text, Rule *rule, GError **error)
{
    const char *at = skip_blanks(text);
    if (!is_symbol(*at) || *at == '[' || *at == ']')
        return fail_syntax(text, at, error, "a production starts with the symbol that it replaces, which is no bracket");
    rule->from = *at;
    rule->weight = 1.0;
    at = skip_blanks(at + 1);
    if (*at == ':') {
        const char *number = at + 1;
        char *end;
        rule->weight = g_ascii_strtod(number, &end);
        if (end == number || !(rule->weight > 0.0 && rule->weight <= 1e9))
            return fail_syntax(text, number, error, "a weight is a number above 0 and no more than 1e9");
        at = skip_blanks(end);
    }
    if (*at != '=')
        return fail_syntax(text, at, error, "= must follow the symbol that a production replaces");
    return read_symbols(text, at + 1, rule, error);
}

static int by_symbol(gconstpointer a, gconstpointer b, gpointer user)
{
    const Rule *const *p = a, *const *q = b;
    return (*p)->from != (*q)->from ? (*p)->from - (*q)->from : (*p > *q) - (*p < *q);
}

static void rules_clear(Rules *r)
{
    for (uint32_t i = 0; i < r->n; i++)
        g_free(r->rule[i].to);
    g_free(r->rule);
}

/* All productions; those of a symbol from first[symbol] to first[symbol + 1]. */
static bool read_rules(const LSystemDef *def, Rules *r, GError **error)
{
    Rule *read = g_new0(Rule, def->n_productions), **sorted = g_new(Rule *, def->n_productions);
    bool good = true;
    for (uint32_t i = 0; i < def->n_productions && good; i++)
        good = read_rule(def->production[i], &read[i], error);
    for (uint32_t i = 0; i < def->n_productions; i++)
        sorted[i] = &read[i];
    if (def->n_productions > 0)
        g_qsort_with_data(sorted, (gint)def->n_productions, sizeof *sorted, by_symbol, NULL);
    *r = (Rules){.rule = g_new(Rule, def->n_productions), .n = def->n_productions};
    for (uint32_t i = 0; i < r->n; i++) {
        r->rule[i] = *sorted[i];
        r->first[(guchar)r->rule[i].from + 1]++;
    }
    for (int c = 0; c < 128; c++)
        r->first[c + 1] += r->first[c];
    g_free(read);
    g_free(sorted);
    if (!good)
        rules_clear(r);
    return good;
}

/* --- rewriting --- */

static LString *lstring_new(uint32_t n)
{
    LString *s = g_new0(LString, 1);
    s->n = n;
    s->symbol = g_new0(char, (gsize)n + 1);
    s->born = g_new0(uint16_t, (gsize)n + 1);
    return s;
}

void lstring_free(LString *s)
{
    if (!s)
        return;
    g_free(s->symbol);
    g_free(s->born);
    g_free(s);
}

/* The production for symbol i of a string in an iteration, NULL if there is none. */
static const Rule *choose(const Rules *r, const LSystemDef *def, const LString *s, uint32_t i, uint32_t iteration)
{
    uint32_t first = r->first[(guchar)s->symbol[i]], last = r->first[(guchar)s->symbol[i] + 1];
    if (last - first < 2)
        return last > first ? &r->rule[first] : NULL;
    double total = 0.0, u[2];
    for (uint32_t k = first; k < last; k++)
        total += r->rule[k].weight;
    random_pair(def->seed, RANDOM_LSYSTEM, iteration, i, u);
    double left = u[0] * total;
    while (first + 1 < last && left >= r->rule[first].weight)
        left -= r->rule[first++].weight;
    return &r->rule[first];
}

static bool check_length(uint64_t n, uint32_t iteration, const LSystemDef *def, GError **error)
{
    if (n <= def->max_symbols)
        return true;
    g_set_error(error, LSYSTEM_ERROR, LSYSTEM_ERROR_LIMIT,
                "iteration %u of the L-system would make %" G_GUINT64_FORMAT " symbols; the limit is %u", iteration, n, def->max_symbols);
    return false;
}

/* The next string; choices are made twice, for the length and for the symbols, and come out the same. */
static LString *rewrite(const Rules *r, const LSystemDef *def, const LString *s, uint32_t iteration, GError **error)
{
    uint64_t n = 0;
    for (uint32_t i = 0; i < s->n; i++) {
        const Rule *rule = choose(r, def, s, i, iteration);
        n += rule ? rule->length : 1;
    }
    if (!check_length(n, iteration, def, error))
        return NULL;
    LString *next = lstring_new((uint32_t)n);
    uint32_t at = 0;
    for (uint32_t i = 0; i < s->n; i++) {
        const Rule *rule = choose(r, def, s, i, iteration);
        uint32_t length = rule ? rule->length : 1;
        memcpy(next->symbol + at, rule ? rule->to : s->symbol + i, length);
        for (uint32_t k = 0; k < length; k++)
            next->born[at + k] = rule ? (uint16_t)iteration : s->born[i];
        at += length;
    }
    return next;
}

LString *lsystem_expand(const LSystemDef *def, GError **error)
{
    Rules rules;
    Rule axiom = {0};
    LString *s = NULL;
    if (!lsystem_check(def, error) || !read_rules(def, &rules, error))
        return NULL;
    if (read_symbols(def->axiom, def->axiom, &axiom, error) && check_length(axiom.length, 0, def, error)) {
        s = lstring_new(axiom.length);
        memcpy(s->symbol, axiom.to, axiom.length);
        for (uint32_t k = 1; k <= def->iterations && s; k++) {
            LString *next = rewrite(&rules, def, s, k, error);
            lstring_free(s);
            s = next;
        }
    }
    g_free(axiom.to);
    rules_clear(&rules);
    return s;
}
