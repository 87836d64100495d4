/* What captions tell where more varies than they have room for: the keys whose values differ most from leaf to leaf. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "batch/sheet_label.h"
#include "batch/sheet_private.h"
#include "sweep/private.h"

enum { MOST_ASKED = 120, RANKS = 4 }; /* variants that are compared, each with each; below: rank */

/* One value of a key: a number, a colour, or a word that is another or not. */
typedef struct {
    bool number;
    double value;
    int colour; /* 0xRRGGBB, -1: none */
    char *text;
} Value;

typedef struct {
    guint at;     /* among the items, in the file's order */
    int rank;     /* lower first, whatever the difference */
    double apart; /* mean difference of two leaves, 0 … 2 */
    Value *value; /* by leaf */
} Candidate;

static Value value_of(const SheetPlan *p, const SheetItem *item, const SweepVariant *v)
{
    SweepKey key = sweep_key(p->s, item->key);
    Value out = {.colour = -1};
    out.text = v->value[item->key] ? g_strdup(v->value[item->key]) : key.id >= 0 ? params_format(sweep_params(p->s), (ParamId)key.id) : g_strdup("");
    out.number = key.id >= 0 && param_info((ParamId)key.id)->type != TYPE_TEXT && sweep_number(out.text, &out.value); /* of seeds each is just another */
    out.colour = label_colour(&key, out.text);
    return out;
}

/* Colours as their channels are apart, parts of white; words 1 or 0. */
static double difference(const Value *a, const Value *b)
{
    if (a->number && b->number)
        return fabs(a->value - b->value);
    if (a->colour < 0 || b->colour < 0)
        return strcmp(a->text, b->text) != 0;
    int sum = 0;
    for (int shift = 0; shift < 24; shift += 8)
        sum += abs((a->colour >> shift & 255) - (b->colour >> shift & 255));
    return sum / 765.0;
}

/* Mean over all pairs; of numbers as part of the largest, or of what they span where some are below 0: 2 and 4 are as far apart as 200 and 400. */
static double mean_difference(const Value *value, guint n)
{
    double sum = 0.0, least = 0.0, most = 0.0; /* with 0 */
    bool numbers = true;
    for (guint i = 0; i < n; i++) {
        numbers &= value[i].number;
        least = MIN(least, value[i].value);
        most = MAX(most, value[i].value);
        for (guint j = 0; j < i; j++)
            sum += difference(&value[i], &value[j]);
    }
    double pairs = 0.5 * n * (n - 1.0);
    return sum <= 0.0 ? 0.0 : numbers ? sum / (most - least) / pairs : sum / pairs;
}

static bool is_coloured(const ParamInfo *info) { return strcmp(info->section, "specimen") == 0 || strcmp(info->section, "texture") == 0; }

/* Names that the user gave come first; lists of points say little; of colours and light the picture of the veins alone shows nothing. */
static int rank(const SheetPlan *p, const SheetItem *item)
{
    static const char *const unseen[] = {"leaf", "specimen", "texture", "mesh", "pose", "export", NULL};
    SweepKey key = sweep_key(p->s, item->key);
    if (key.id < 0)
        return 1;
    const ParamInfo *info = param_info((ParamId)key.id);
    bool seen = (p->specimen && is_coloured(info)) || !g_strv_contains(unseen, info->section);
    return info->type == TYPE_POINTS ? 3 : seen ? 1 : 2;
}

/* Whether leaves that are alike in the one are alike in the other, as columns of a table may be; said of leaves enough to know. */
static bool follows(const Candidate *c, const Candidate *from, guint n)
{
    guint pairs = 0;
    for (guint i = 0; from->value && c->value && i < n; i++)
        for (guint j = 0; j < i; j++)
            if (strcmp(from->value[i].text, from->value[j].text) == 0) {
                pairs++;
                if (strcmp(c->value[i].text, c->value[j].text) != 0)
                    return false;
            }
    return 2 * pairs >= n;
}

static gint by_difference(gconstpointer a, gconstpointer b, gpointer user)
{
    const Candidate *x = a, *y = b;
    int less = x->rank != y->rank ? x->rank - y->rank : (x->apart < y->apart) - (x->apart > y->apart);
    return less ? less : x->at < y->at ? -1 : 1;
}

static gint by_place(gconstpointer a, gconstpointer b, gpointer user)
{
    const Candidate *x = a, *y = b;
    return (x->at > y->at) - (x->at < y->at);
}

/* Brings the ones to tell to the front: one by one, and what follows from one of them goes behind all others. */
static void sort(Candidate *c, guint items, guint n)
{
    for (guint i = 0; i < SHEET_MOST_TOLD; i++) {
        for (guint k = i; k < items && i > 0; k++)
            c[k].rank += follows(&c[k], &c[i - 1], n) ? RANKS : 0;
        g_qsort_with_data(c + i, (gint)(items - i), sizeof *c, by_difference, NULL);
    }
    g_qsort_with_data(c, SHEET_MOST_TOLD, sizeof *c, by_place, NULL);
}

/* Variants from all over the sweep, as those of a grid change slowly. */
static SweepVariant *ask(const Sweep *s, guint *n)
{
    uint64_t count = sweep_count(s);
    *n = (guint)MIN(count, MOST_ASKED);
    SweepVariant *v = g_new0(SweepVariant, *n);
    for (guint i = 0; i < *n; i++)
        sweep_variant(s, i * (count / *n), &v[i]);
    return v;
}

static Candidate judge(const SheetPlan *p, const SheetItem *item, guint at, const SweepVariant *v, guint n)
{
    Candidate c = {.at = at};
    if (item->key == NAME_ITEM)
        return c;
    c.value = g_new(Value, n);
    for (guint i = 0; i < n; i++)
        c.value[i] = value_of(p, item, &v[i]);
    c.rank = rank(p, item);
    c.apart = mean_difference(c.value, n);
    int id = sweep_key(p->s, item->key).id;
    if (id >= 0 && is_coloured(param_info((ParamId)id))) /* plain to see; how the leaf grew wants telling */
        c.apart *= 0.5;
    return c;
}

void sheet_choose(const SheetPlan *p, GArray *items)
{
    if (items->len <= SHEET_MOST_TOLD)
        return;
    guint n;
    SweepVariant *v = ask(p->s, &n);
    Candidate *c = g_new(Candidate, items->len);
    for (guint i = 0; i < items->len; i++)
        c[i] = judge(p, &g_array_index(items, SheetItem, i), i, v, n);
    sort(c, items->len, n);
    for (guint i = 0; i < SHEET_MOST_TOLD; i++) /* c[i].at >= i */
        g_array_index(items, SheetItem, i) = g_array_index(items, SheetItem, c[i].at);
    for (guint i = 0; i < items->len; i++) {
        for (guint k = 0; c[i].value && k < n; k++)
            g_free(c[i].value[k].text);
        g_free(c[i].value);
    }
    g_array_set_size(items, SHEET_MOST_TOLD);
    for (guint i = 0; i < n; i++)
        sweep_variant_clear(&v[i]);
    g_free(v);
    g_free(c);
}
