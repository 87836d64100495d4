/* The slots that auxin sources are held in: what each sees, how they come, go and are sorted. */
#include <string.h>

#include "sim/state.h"

/* ---- what a source sees ---- */

/* Decided when the younger of the two is born. */
bool source_sees(const Simulation *s, uint32_t k, uint32_t node)
{
    if (s->blade->moving) {
        double scale = 1.0 / s->def.growth.initial_length;
        return reach_sees(s->reach, vec_scale(s->material[k], scale), vec_scale(s->veins.material[node], scale));
    }
    double scale = 1.0 / blade_scale_at(s->blade, MAX(s->birth[k], s->veins.birth[node]));
    return reach_sees(s->reach, vec_scale(s->place[k], scale), vec_scale(s->veins.pos[node], scale));
}

static bool sees(const void *user, uint32_t node)
{
    const Eye *eye = user;
    return source_sees(eye->sim, eye->slot, node);
}

Box2 field_box(const Simulation *s)
{
    Vec2 c = s->veins.tree.centre;
    double h = s->veins.tree.half;
    return (Box2){c.x - h, c.y - h, c.x + h, c.y + h};
}

Field source_field(const Simulation *s, uint32_t k, Eye *eye)
{
    *eye = (Eye){s, k};
    return (Field){s->veins.pos, &s->veins.tree, field_box(s), s->reach ? sees : NULL, eye};
}

void source_look(Simulation *s, uint32_t k)
{
    Eye eye;
    Field f = source_field(s, k, &eye);
    if (s->def.pattern == PATTERN_OPEN) {
        s->near2[k] = HUGE_VAL;
        s->near[k] = quadtree_nearest(f.tree, s->place[k], HUGE_VAL, f.sees, f.user, &s->near2[k]);
    } else if (s->def.neighbourhood == NEIGHBOURHOOD_RELATIVE) {
        hood_find(&s->source[k].hood, &f, s->place[k]);
    } else {
        urquhart_find(&s->source[k].hood, &s->cell[k], &f, s->place[k]);
    }
    s->mark[k] &= (uint8_t)~MARK_ZONED;
    source_weigh(s, k);
}

/* The kill distance only shrinks (in the frame), so what is not within it stays so until the neighbours change. */
void source_weigh(Simulation *s, uint32_t k)
{
    double least2 = HUGE_VAL;
    for (uint32_t i = 0; i < source_members(s, k); i++)
        least2 = MIN(least2, vec_dist2(s->place[k], s->veins.pos[source_member(s, k, i)]));
    s->mark[k] = (uint8_t)(least2 < kill2(s) ? s->mark[k] | MARK_WITHIN : s->mark[k] & ~MARK_WITHIN);
}

Box2 source_zone(const Simulation *s, uint32_t k)
{
    Eye eye;
    Field f = source_field(s, k, &eye);
    if (s->def.pattern == PATTERN_CLOSED)
        return s->def.neighbourhood == NEIGHBOURHOOD_RELATIVE ? hood_zone(&s->source[k].hood, &f, s->place[k])
                                                              : urquhart_zone(&s->cell[k], &f, s->place[k]);
    return s->near[k] == NO_POINT ? f.field : disc_box(s->place[k], s->near2[k]);
}

/* ---- slots ---- */

/* The arrays that this simulation needs. */
#define COLUMNS(DO)                                                                \
    DO(place, true)                                                                \
    DO(birth, true)                                                                \
    DO(mark, true)                                                                 \
    DO(material, s->blade->moving)                                                 \
    DO(near, s->def.pattern == PATTERN_OPEN)                                       \
    DO(near2, s->def.pattern == PATTERN_OPEN)                                      \
    DO(source, s->def.pattern == PATTERN_CLOSED)                                   \
    DO(cell, s->def.pattern == PATTERN_CLOSED && s->def.neighbourhood == NEIGHBOURHOOD_URQUHART)

static void reserve(Simulation *s)
{
    if (s->n_sources < s->cap_sources)
        return;
    s->cap_sources = MAX(s->cap_sources * 2, 256);
#define RENEW(array, wanted) \
    if (wanted)              \
        s->array = g_realloc_n(s->array, s->cap_sources, sizeof *s->array);
    COLUMNS(RENEW)
#undef RENEW
}

void source_add(Simulation *s, Vec2 p)
{
    reserve(s);
    uint32_t k = s->n_sources++;
    s->place[k] = p;
    s->birth[k] = s->blade->step;
    s->mark[k] = 0;
    if (s->material)
        s->material[k] = blade_material(s->blade, p);
    if (s->source)
        s->source[k] = (Source){.arrived = NO_POINT};
    if (s->cell)
        s->cell[k] = (Cell){0};
    zones_add(&s->zones, p, field_box(s));
    s->n_unsorted++;
    s->counts.placed++;
}

static void forget_arrivals(Simulation *s, uint32_t k)
{
    uint32_t *end = &s->source[k].arrived;
    while (*end != NO_POINT)
        end = &s->arrival[*end].next;
    *end = s->unused_arrival;
    s->unused_arrival = s->source[k].arrived;
}

void source_remove(Simulation *s, uint32_t k)
{
    if (s->cell)
        cell_clear(&s->cell[k]);
    if (s->source)
        forget_arrivals(s, k);
    if (s->near2)
        s->near2[k] = -1.0;
    s->place[k] = vec2((double)NAN, (double)NAN);
    s->mark[k] = MARK_IDLE;
    zones_set(&s->zones, k, box_empty());
    s->n_removed++;
}

/* ---- order ---- */

/* New order of the slots: living ones by cell, in a cell as they were. Returns how many there are. */
static uint32_t *sorted_slots(const Simulation *s, uint32_t n)
{
    uint32_t cells = zones_cells(&s->zones);
    uint32_t *start = g_new0(uint32_t, cells + 1), *slot = g_new(uint32_t, MAX(n, 1));
    for (uint32_t k = 0; k < s->n_sources; k++)
        if (source_is_alive(s, k))
            start[zones_cell(&s->zones, s->place[k]) + 1]++;
    for (uint32_t c = 0; c < cells; c++)
        start[c + 1] += start[c];
    for (uint32_t k = 0; k < s->n_sources; k++)
        if (source_is_alive(s, k))
            slot[start[zones_cell(&s->zones, s->place[k])]++] = k;
    g_free(start);
    return slot;
}

static void *permuted(void *array, gsize size, gsize cap, const uint32_t *slot, uint32_t n)
{
    char *from = array, *to = g_malloc_n(cap, size);
    for (uint32_t k = 0; k < n; k++)
        memcpy(to + size * k, from + size * slot[k], size);
    g_free(array);
    return to;
}

void sources_sort(Simulation *s)
{
    uint32_t n = sources_alive(s), *slot = sorted_slots(s, n);
#define PERMUTE(array, wanted) \
    if (wanted)                \
        s->array = permuted(s->array, sizeof *s->array, s->cap_sources, slot, n);
    COLUMNS(PERMUTE)
#undef PERMUTE
    g_free(slot);
    s->n_sources = n;
    s->n_removed = s->n_unsorted = 0;
    zones_reset(&s->zones);
    bool open = s->def.pattern == PATTERN_OPEN;
    for (uint32_t k = 0; k < n; k++)
        zones_add(&s->zones, s->place[k], open || (s->mark[k] & MARK_ZONED) ? source_zone(s, k) : field_box(s));
}
