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
    s->mark[k] &= (uint8_t)~(MARK_ZONED | MARK_APART);
    if (s->source)
        s->mark[k] |= MARK_APART;
    source_weigh(s, k);
}

void source_set_apart(Simulation *s, uint32_t k)
{
    if (s->mark[k] & MARK_APART)
        return;
    s->source[k].hood.n = 1;
    s->source[k].hood.m[0] = s->near[k];
    s->near[k] = NEAR_APART;
    s->near2[k] = -1.0;
    s->mark[k] |= MARK_APART;
}

/* Can a source that is apart go with the crowd? */
static bool is_plain(const Simulation *s, uint32_t k)
{
    const Source *src = &s->source[k];
    return s->def.neighbourhood == NEIGHBOURHOOD_RELATIVE && src->hood.n == 1 && !(src->tagged | src->spent) &&
           !(s->mark[k] & (MARK_WITHIN | MARK_REACHED | MARK_ZONED));
}

/* The kill distance only shrinks (in the frame), so what is not within it stays so until the neighbours change. */
void source_weigh(Simulation *s, uint32_t k)
{
    double least2 = HUGE_VAL;
    for (uint32_t i = 0; i < source_members(s, k); i++)
        least2 = MIN(least2, vec_dist2(s->place[k], s->veins.pos[source_member(s, k, i)]));
    s->mark[k] = (uint8_t)(least2 < MAX(kill2(s), past2(s)) ? s->mark[k] | MARK_WITHIN : s->mark[k] & ~MARK_WITHIN);
    if (s->def.pattern == PATTERN_OPEN) {
        s->mark[k] = (uint8_t)(s->near[k] == NO_POINT ? s->mark[k] | MARK_APART : s->mark[k] & ~MARK_APART);
    } else if (is_plain(s, k)) {
        s->near[k] = s->source[k].hood.m[0];
        s->near2[k] = least2;
        s->mark[k] &= (uint8_t)~MARK_APART;
    } else {
        s->near[k] = NEAR_APART;
        s->near2[k] = -1.0;
        s->mark[k] |= MARK_APART;
    }
}

/* ---- slots ---- */

/* The arrays that this simulation needs. */
#define COLUMNS(DO)                                                                \
    DO(place, true)                                                                \
    DO(birth, true)                                                                \
    DO(mark, true)                                                                 \
    DO(material, s->blade->moving)                                                 \
    DO(near, true)                                                                 \
    DO(near2, true)                                                                \
    DO(zone, s->def.pattern == PATTERN_CLOSED)                                     \
    DO(source, s->def.pattern == PATTERN_CLOSED)                                   \
    DO(cell, s->def.pattern == PATTERN_CLOSED && s->def.neighbourhood == NEIGHBOURHOOD_URQUHART)

static void reserve(Simulation *s)
{
    if (s->n_sources + SLOTS_ASIDE < s->cap_sources)
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
    if (sources_need_room(s))
        grid_add(&s->grid, p);
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
    s->near[k] = NO_POINT;
    s->near2[k] = -1.0;
    s->place[k] = vec2((double)NAN, (double)NAN);
    s->mark[k] = MARK_IDLE;
    s->n_removed++;
}

/* ---- order ---- */

/* New order of the slots: living ones by cell, in a cell as they were. start[i] becomes where those of cell i begin, and after the last cell
 * how many there are. */
static uint32_t *sorted_slots(const Simulation *s, uint32_t *start)
{
    uint32_t cells = grid_cells(&s->grid), alive = MAX(sources_alive(s), 1), *slot = g_new(uint32_t, alive), *cell = g_new(uint32_t, alive), n_cell = 0;
    memset(start, 0, sizeof *start * (cells + 1));
    for (uint32_t k = 0; k < s->n_sources; k++)
        if (source_is_alive(s, k))
            start[cell[n_cell++] = grid_cell(&s->grid, s->place[k])]++;
    for (uint32_t c = 0, sum = 0; c <= cells; c++) {
        uint32_t n = start[c];
        start[c] = sum;
        sum += n;
    }
    n_cell = 0;
    for (uint32_t k = 0; k < s->n_sources; k++)
        if (source_is_alive(s, k))
            slot[start[cell[n_cell++]]++] = k;
    g_free(cell);
    memmove(start + 1, start, sizeof *start * cells);
    start[0] = 0;
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
    crowds_wake(s, NO_POINT);
    uint32_t n = sources_alive(s), *start = g_new(uint32_t, grid_cells(&s->grid) + 1), *slot = sorted_slots(s, start);
#define PERMUTE(array, wanted) \
    if (wanted)                \
        s->array = permuted(s->array, sizeof *s->array, s->cap_sources, slot, n);
    COLUMNS(PERMUTE)
#undef PERMUTE
    g_free(slot);
    s->n_sources = n;
    s->n_removed = s->n_unsorted = 0;
    s->drawn = false; /* pulled[] speaks of the old slots */
    if (sources_need_room(s)) {
        grid_reset(&s->grid);
        for (uint32_t k = 0; k < n; k++)
            grid_add(&s->grid, s->place[k]);
    }
    crowds_build(s, start);
    g_free(start);
}
