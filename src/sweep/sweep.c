/* Variants, each from its index alone. */
#include "sweep/sweep.h"

#include "param/private.h"
#include "sweep/private.h"

static const SweepAxis *axis_at(const Sweep *s, guint i)
{
    return &g_array_index(s->axis, SweepAxis, i);
}

void sweep_free(Sweep *s)
{
    if (!s)
        return;
    for (guint i = 0; i < s->axis->len; i++)
        sweep_axis_clear(&g_array_index(s->axis, SweepAxis, i));
    g_array_free(s->axis, TRUE);
    params_free(s->params);
    g_free(s->params_path);
    g_free(s->folder);
    g_free(s->path);
    g_free(s);
}

SweepMode sweep_mode(const Sweep *s) { return s->mode; }

const char *sweep_path(const Sweep *s) { return s->path; }

const char *sweep_params_path(const Sweep *s) { return s->params_path; }

const Params *sweep_params(const Sweep *s) { return s->params; }

uint64_t sweep_count(const Sweep *s) { return s->count; }

char *sweep_checksum(const Sweep *s)
{
    GString *text = g_string_new(NULL);
    g_string_append_printf(text, "%d %" G_GUINT64_FORMAT " %" G_GUINT64_FORMAT " %d\n", s->mode, s->count, s->sample_seed, s->halton);
    for (guint i = 0; i < s->axis->len; i++) {
        const SweepAxis *a = axis_at(s, i);
        const double number[] = {a->low, a->high, a->step};
        g_string_append_printf(text, "%d %" G_GUINT64_FORMAT " %d %d", a->kind, a->levels, a->drawn, a->digits);
        for (gsize k = 0; k < G_N_ELEMENTS(number); k++) {
            char buffer[G_ASCII_DTOSTR_BUF_SIZE];
            g_string_append_printf(text, " %s", g_ascii_dtostr(buffer, sizeof buffer, number[k]));
        }
        for (uint32_t f = 0; f < a->fields; f++)
            g_string_append_printf(text, "\n%s", a->field[f].key);
        for (uint64_t c = 0; a->cell && c < a->levels * a->fields; c++)
            g_string_append_printf(text, "\n%s", a->cell[c] ? a->cell[c] : "\t");
        g_string_append_c(text, '\n');
    }
    char *sum = g_compute_checksum_for_string(G_CHECKSUM_SHA256, text->str, (gssize)text->len);
    g_string_free(text, TRUE);
    return sum;
}

uint32_t sweep_keys(const Sweep *s)
{
    uint32_t n = 0;
    for (guint i = 0; i < s->axis->len; i++)
        for (uint32_t f = 0; f < axis_at(s, i)->fields; f++)
            n += axis_at(s, i)->field[f].id != FIELD_NAME;
    return n;
}

/* The axis and field of a key. */
static const SweepAxis *find_key(const Sweep *s, uint32_t key, guint *axis, uint32_t *field)
{
    for (*axis = 0; *axis < s->axis->len; ++*axis)
        for (*field = 0; *field < axis_at(s, *axis)->fields; ++*field)
            if (axis_at(s, *axis)->field[*field].id != FIELD_NAME && key-- == 0)
                return axis_at(s, *axis);
    g_assert_not_reached();
}

SweepKey sweep_key(const Sweep *s, uint32_t key)
{
    guint at;
    uint32_t field;
    const SweepAxis *axis = find_key(s, key, &at, &field);
    const SweepField *f = &axis->field[field];
    bool drawn = sweep_axis_varies(axis) && axis->kind != AXIS_EACH && (axis->drawn || s->mode == SWEEP_SAMPLE);
    return (SweepKey){f->key, f->id, f->varies, drawn, at, axis->levels};
}

char *sweep_level(const Sweep *s, uint32_t key, uint64_t level)
{
    guint at;
    uint32_t field;
    const SweepAxis *axis = find_key(s, key, &at, &field);
    g_assert(level < axis->levels);
    return axis->kind == AXIS_LIST ? g_strdup(axis->cell[level * axis->fields + field]) : sweep_axis_level_text(axis, level);
}

static uint64_t choose_level(const Sweep *s, const SweepAxis *axis, uint64_t index)
{
    if (axis->levels == 1)
        return 0;
    if (axis->drawn || s->mode == SWEEP_SAMPLE) {
        double level = sweep_chance(s, axis, index) * (double)axis->levels;
        return MIN((uint64_t)level, axis->levels - 1);
    }
    return s->mode == SWEEP_GRID ? index / axis->stride % axis->levels : index;
}

static char *choose_text(const Sweep *s, const SweepAxis *axis, uint32_t field, uint64_t level, uint64_t index)
{
    if (axis->kind == AXIS_EACH)
        return g_strdup_printf("%" G_GUINT64_FORMAT, s->sample_seed + index);
    if (axis->kind == AXIS_LIST)
        return g_strdup(axis->cell[level * axis->fields + field]);
    return axis->levels ? sweep_axis_level_text(axis, level) : sweep_axis_draw_text(axis, sweep_chance(s, axis, index));
}

void sweep_variant(const Sweep *s, uint64_t index, SweepVariant *out)
{
    g_assert(index < s->count);
    *out = (SweepVariant){.index = index, .seed = 1, .n = sweep_keys(s)};
    out->value = g_new0(char *, out->n + 1);
    out->level = g_new0(uint64_t, out->n + 1);
    uint32_t key = 0;
    for (guint i = 0; i < s->axis->len; i++) {
        const SweepAxis *axis = axis_at(s, i);
        uint64_t level = axis->levels ? choose_level(s, axis, index) : 0;
        for (uint32_t f = 0; f < axis->fields; f++) {
            if (axis->field[f].id == FIELD_NAME)
                continue;
            out->level[key] = level;
            out->value[key] = choose_text(s, axis, f, level, index);
            if (axis->field[f].id == FIELD_SEED && out->value[key])
                out->seed = g_ascii_strtoull(out->value[key], NULL, 10);
            key++;
        }
    }
    out->name = sweep_name(s, out);
}

void sweep_variant_clear(SweepVariant *v)
{
    for (uint32_t i = 0; i < v->n; i++)
        g_free(v->value[i]);
    g_free(v->value);
    g_free(v->level);
    g_free(v->name);
    *v = (SweepVariant){0};
}

gboolean sweep_apply(const Sweep *s, const SweepVariant *v, Params *p, GError **error)
{
    Place place = {s->path, 0, s->folder};
    uint32_t key = 0;
    for (guint i = 0; i < s->axis->len; i++) {
        const SweepAxis *axis = axis_at(s, i);
        for (uint32_t f = 0; f < axis->fields; f++) {
            if (axis->field[f].id == FIELD_NAME)
                continue;
            const char *value = v->value[key++];
            if (axis->field[f].id >= 0 && value && !params_assign(p, (ParamId)axis->field[f].id, value, &place, error))
                return FALSE;
        }
    }
    return TRUE;
}
