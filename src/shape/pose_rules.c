/* Rule text: reading it whole, then posing by it. */
#include <string.h>

#include "geom/dtrig.h"
#include "shape/bend.h"

static const double most_degrees = 3600.0, most_lengths = 1000.0;

typedef enum { VEINS_ALL, VEINS_ORDER, VEINS_SIDE, VEINS_FICTITIOUS, VEINS_NAME } VeinsKind;
typedef enum { ACTION_LIFT, ACTION_TURN, ACTION_FOLD, ACTION_ROTATE, ACTION_SPLINE } ActionKind;

typedef struct {
    VeinsKind veins;
    int number;          /* the order; 1 left, -1 right */
    const char *name;    /* of `word` */
    ActionKind action;
    double angle;        /* radians */
    Vec3 axis;
    double part;         /* where to rotate */
    GArray *at, *target; /* of a spline: double, Vec3 in leaf lengths; NULL for other actions */
    char **word;         /* owned */
    uint32_t index;      /* 1, 2, … for messages */
    const char *text;
} Rule;

static void rule_clear(gpointer data)
{
    Rule *r = data;
    g_strfreev(r->word);
    if (r->at)
        g_array_unref(r->at);
    if (r->target)
        g_array_unref(r->target);
}

G_GNUC_PRINTF(4, 5)
static gboolean fail(const Rule *r, PoseError code, GError **error, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *what = g_strdup_vprintf(format, args);
    va_end(args);
    g_set_error(error, POSE_ERROR, (int)code, "pose rule %u, '%s': %s", r->index, r->text, what);
    g_free(what);
    return FALSE;
}

/* Words between blanks; free with g_strfreev. */
static char **split_words(const char *text)
{
    GPtrArray *words = g_ptr_array_new();
    char **all = g_strsplit_set(text, " \t\r\n\f\v", -1);
    for (char **w = all; *w; w++) {
        if (**w)
            g_ptr_array_add(words, *w);
        else
            g_free(*w);
    }
    g_free(all);
    g_ptr_array_add(words, NULL);
    return (char **)g_ptr_array_free(words, FALSE);
}

/* Digits, signs, point and exponent only: strtod would take inf, nan and hexadecimals too. */
static bool read_number(const char *text, double low, double high, double *out)
{
    if (!text || !*text || text[strspn(text, "0123456789+-.eE")])
        return false;
    char *end;
    double value = g_ascii_strtod(text, &end);
    if (*end || !(value >= low && value <= high))
        return false;
    *out = value + 0.0; /* -0 becomes 0 */
    return true;
}

/* "1,2,3" for n = 3. */
static bool read_numbers(const char *text, uint32_t n, double low, double high, double *out)
{
    char **part = g_strsplit(text ? text : "", ",", (int)n + 1);
    bool good = g_strv_length(part) == n;
    for (uint32_t i = 0; i < n && good; i++)
        good = read_number(part[i], low, high, &out[i]);
    g_strfreev(part);
    return good;
}

static const char *shown(const char *word) { return word ? word : "nothing"; }

/* Reads the VEINS part; returns the words it took, 0 on an error. */
static guint read_veins(Rule *r, GError **error)
{
    const char *first = r->word[0], *second = r->word[1];
    if (strcmp(first, "all") == 0 || strcmp(first, "fictitious") == 0) {
        r->veins = *first == 'a' ? VEINS_ALL : VEINS_FICTITIOUS;
        return 1;
    }
    if (strcmp(first, "order") == 0) {
        double order;
        r->veins = VEINS_ORDER;
        if (!read_number(second, 1, 255, &order) || order != floor(order)) {
            fail(r, POSE_ERROR_SYNTAX, error, "found '%s' after 'order'; a whole number 1 … 255 is allowed", shown(second));
            return 0;
        }
        r->number = (int)order;
        return 2;
    }
    if (strcmp(first, "side") == 0) {
        bool left = second && strcmp(second, "left") == 0;
        r->veins = VEINS_SIDE;
        if (!left && !(second && strcmp(second, "right") == 0)) {
            fail(r, POSE_ERROR_SYNTAX, error, "found '%s' after 'side'; left or right is allowed", shown(second));
            return 0;
        }
        r->number = left ? 1 : -1;
        return 2;
    }
    const char *star = strchr(first, '*');
    if (star && star[1]) {
        fail(r, POSE_ERROR_SYNTAX, error, "found '%s'; '*' is allowed at the end of a name only", first);
        return 0;
    }
    r->veins = VEINS_NAME;
    r->name = first;
    return 1;
}

static gboolean read_degrees(Rule *r, const char *word, GError **error)
{
    double degrees;
    if (!read_number(word, -most_degrees, most_degrees, &degrees))
        return fail(r, POSE_ERROR_SYNTAX, error, "found '%s' for the angle; degrees, -3600 … 3600, are allowed", shown(word));
    r->angle = degrees * DTRIG_DEGREE;
    return TRUE;
}

static gboolean read_end(Rule *r, const char *word, GError **error)
{
    return word ? fail(r, POSE_ERROR_SYNTAX, error, "found '%s' where the rule should end or a ';' stand", word) : TRUE;
}

static gboolean read_rotate(Rule *r, char **word, GError **error)
{
    double axis[3] = {0.0, 0.0, 0.0};
    bool named = word[0] && strlen(word[0]) == 1 && strchr("xyz", *word[0]);
    if (named)
        axis[*word[0] - 'x'] = 1.0;
    r->axis = vec3(axis[0], axis[1], axis[2]);
    if (!named && read_numbers(word[0], 3, -1e6, 1e6, axis))
        r->axis = vec3_unit(vec3(axis[0], axis[1], axis[2]), r->axis);
    if (vec3_dot(r->axis, r->axis) == 0.0)
        return fail(r, POSE_ERROR_SYNTAX, error, "found '%s' for the axis; x, y, z or three numbers X,Y,Z, -1e6 … 1e6 and not all 0, are allowed",
                    shown(word[0]));
    if (!read_degrees(r, word[1], error))
        return FALSE;
    if (!word[2])
        return TRUE;
    if (strcmp(word[2], "at") != 0)
        return fail(r, POSE_ERROR_SYNTAX, error, "found '%s' after the angle; 'at T' or the end is allowed", word[2]);
    if (!read_number(word[3], 0.0, 1.0, &r->part))
        return fail(r, POSE_ERROR_SYNTAX, error, "found '%s' after 'at'; a part of the vein, 0 … 1, is allowed", shown(word[3]));
    return read_end(r, word[4], error);
}

static gboolean read_spline(Rule *r, char **word, GError **error)
{
    double last = 0.0;
    r->at = g_array_new(FALSE, FALSE, sizeof(double));
    r->target = g_array_new(FALSE, FALSE, sizeof(Vec3));
    for (; *word; word++) {
        double v[4];
        if (!read_numbers(*word, 4, -most_lengths, most_lengths, v))
            return fail(r, POSE_ERROR_SYNTAX, error, "found '%s'; points T,X,Y,Z of four numbers, -1000 … 1000, are allowed", *word);
        if (r->at->len == 0 && v[0] > 0.0) { /* the base, which stays where it is */
            double zero = 0.0;
            Vec3 none = {0};
            g_array_append_val(r->at, zero);
            g_array_append_val(r->target, none);
        }
        if (!(v[0] >= 0.0 && v[0] <= 1.0) || (r->at->len > 0 && !(v[0] > last)))
            return fail(r, POSE_ERROR_SYNTAX, error, "found '%s'; its T must be greater than the one before and 0 … 1", *word);
        Vec3 target = vec3(v[1], v[2], v[3]);
        last = v[0];
        g_array_append_val(r->at, last);
        g_array_append_val(r->target, target);
    }
    if (last != 1.0)
        return fail(r, POSE_ERROR_SYNTAX, error, "found %s; the last point must have T = 1, the tip",
                    r->at->len ? "no point at the tip" : "no points");
    return TRUE;
}

static gboolean read_action(Rule *r, char **word, GError **error)
{
    static const char *const names[] = {"lift", "turn", "fold", "rotate", "spline"};
    guint k = 0;
    while (k < G_N_ELEMENTS(names) && (!word[0] || strcmp(word[0], names[k]) != 0))
        k++;
    if (k == G_N_ELEMENTS(names))
        return fail(r, POSE_ERROR_SYNTAX, error, "found '%s' for what to do; lift, turn, fold, rotate and spline are allowed", shown(word[0]));
    r->action = (ActionKind)k;
    if (r->action == ACTION_ROTATE)
        return read_rotate(r, word + 1, error);
    if (r->action == ACTION_SPLINE)
        return read_spline(r, word + 1, error);
    return read_degrees(r, word[1], error) && read_end(r, word[2], error);
}

static bool matches(const Rule *r, const Skeleton *s, const Layout *l, uint32_t q)
{
    const Sequence *seq = &s->sequence[q];
    switch (r->veins) {
    case VEINS_ALL:
        return true;
    case VEINS_ORDER:
        return seq->order == r->number;
    case VEINS_SIDE:
        return l->side[q] == r->number;
    case VEINS_FICTITIOUS:
        return seq->fictitious;
    case VEINS_NAME:
        break;
    }
    gsize n = strlen(r->name);
    if (n > 0 && r->name[n - 1] == '*')
        return strncmp(seq->name, r->name, n - 1) == 0;
    return strcmp(seq->name, r->name) == 0;
}

static gboolean fail_no_vein(const Rule *r, const Skeleton *s, GError **error)
{
    enum { SHOWN = 12 };
    if (r->veins == VEINS_FICTITIOUS)
        return fail(r, POSE_ERROR_VEIN, error, "the leaf has no fictitious vein");
    if (r->veins == VEINS_SIDE)
        return fail(r, POSE_ERROR_VEIN, error, "the leaf has no vein on its %s side", r->number > 0 ? "left" : "right");
    GString *allowed = g_string_new(NULL);
    if (r->veins == VEINS_ORDER) {
        bool has[256] = {false};
        for (uint32_t q = 0; q < s->n_sequences; q++)
            has[s->sequence[q].order] = true;
        for (int k = 0; k < 256; k++)
            if (has[k])
                g_string_append_printf(allowed, "%s%d", allowed->len ? ", " : "", k);
        fail(r, POSE_ERROR_VEIN, error, "the leaf has no vein of order %d; its orders are %s", r->number, allowed->len ? allowed->str : "none");
    } else {
        for (uint32_t q = 0; q < s->n_sequences && q < SHOWN; q++)
            g_string_append_printf(allowed, "%s%s", q ? ", " : "", s->sequence[q].name);
        fail(r, POSE_ERROR_VEIN, error, "the leaf has no vein '%s'; all, order N, side left, side right, fictitious and its veins %s%s are allowed",
             r->name, allowed->str, s->n_sequences > SHOWN ? ", …" : "");
    }
    g_string_free(allowed, TRUE);
    return FALSE;
}

static gboolean check_veins(const Rule *r, const Skeleton *s, const Layout *l, GError **error)
{
    uint32_t found = 0, foldable = 0;
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        if (!matches(r, s, l, q))
            continue;
        found++;
        foldable += l->fold_side[q] != 0;
    }
    if (found == 0)
        return fail_no_vein(r, s, error);
    if (r->action == ACTION_FOLD && foldable == 0)
        return fail(r, POSE_ERROR_VEIN, error, "nothing to fold: a vein that leaves another to its left or right is allowed");
    return TRUE;
}

/* Rules of def, all read and all naming veins; NULL with an error. */
static GArray *read_rules(const char *text, const Skeleton *s, const Layout *l, char **parts, GError **error)
{
    GArray *rules = g_array_new(FALSE, TRUE, sizeof(Rule));
    g_array_set_clear_func(rules, rule_clear);
    uint32_t index = 0;
    for (; text && *parts; parts++) {
        index++;
        Rule r = {.index = index, .text = g_strstrip(*parts), .word = split_words(*parts)};
        if (!r.word[0]) {
            rule_clear(&r);
            continue;
        }
        guint taken = read_veins(&r, error);
        bool good = taken > 0 && read_action(&r, r.word + taken, error) && check_veins(&r, s, l, error);
        g_array_append_val(rules, r);
        if (!good) {
            g_array_unref(rules);
            return NULL;
        }
    }
    return rules;
}

static void add_bends(const Rule *r, const Skeleton *s, const Layout *l, Bend *bend)
{
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        if (!matches(r, s, l, q))
            continue;
        if (r->action == ACTION_LIFT)
            bend[q].lift += r->angle;
        else if (r->action == ACTION_TURN)
            bend[q].turn += r->angle;
        else if (r->action == ACTION_FOLD)
            bend[q].fold += r->angle;
    }
}

/* The node beyond the hinge nearest to part t of the sequence. */
static uint32_t target_at(const Skeleton *s, const Layout *l, uint32_t q, double t)
{
    const uint32_t *node = s->at + s->sequence[q].first;
    uint32_t best = 0;
    double along = 0.0, least = HUGE_VAL;
    for (uint32_t k = 0; k + 1 < s->sequence[q].n; k++) {
        double away = fabs(along - t * l->length[q]);
        if (away < least) {
            least = away;
            best = k;
        }
        along += vec_dist(s->rest[node[k]], s->rest[node[k + 1]]);
    }
    return node[best + 1];
}

static void follow_rule(Pose *p, const Layout *l, const Rule *r, double part)
{
    const Skeleton *s = p->skeleton;
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        if (r->action < ACTION_ROTATE || !matches(r, s, l, q))
            continue;
        if (r->action == ACTION_ROTATE) {
            pose_rotate(p, target_at(s, l, q, r->part), r->axis, r->angle * part);
            continue;
        }
        double *at = g_new(double, r->at->len);
        Vec3 *target = g_new(Vec3, r->at->len);
        for (guint k = 0; k < r->at->len; k++) {
            at[k] = g_array_index(r->at, double, k) * l->length[q];
            target[k] = vec3_scale(g_array_index(r->target, Vec3, k), l->leaf_length);
        }
        pose_spline_at(p, q, at, target, r->at->len, part);
        g_free(target);
        g_free(at);
    }
}

gboolean pose_apply(Pose *p, const PoseDef *def, GError **error)
{
    const Skeleton *s = p->skeleton;
    Layout *l = layout_new(s);
    char **parts = g_strsplit(def->rules ? def->rules : "", ";", -1);
    GArray *rules = read_rules(def->rules, s, l, parts, error);
    if (rules) {
        Bend *bend = g_new0(Bend, s->n_sequences);
        Sheet sheet;
        bend_ready(s, l, def, bend, &sheet);
        for (guint k = 0; k < rules->len; k++)
            add_bends(&g_array_index(rules, Rule, k), s, l, bend);
        bend_apply(p, l, bend, &sheet, def->blend);
        for (guint k = 0; k < rules->len; k++)
            follow_rule(p, l, &g_array_index(rules, Rule, k), def->blend);
        g_free(bend);
        g_array_unref(rules);
    }
    g_strfreev(parts);
    layout_free(l);
    return rules != NULL;
}
