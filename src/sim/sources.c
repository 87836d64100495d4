/* Auxin source placement (Runions 2005, section 3.3). */
#include <string.h>

#include "geom/random.h"
#include "sim/state.h"

/* No source is placed nearer to a vein than b_v, nor within the kill distance: it would be removed in the same step without ever having
 * been out of reach, but pull a stub of vein out of its neighbour before. */
static double vein_clearance(const Simulation *s)
{
    return MAX(s->def.birth_distance_veins, s->def.kill_distance) * s->blade->unit;
}

/* A source sees a node unless the blade's margin comes between them, decided when the younger of the two is born. */
static bool sees(const void *user, uint32_t node)
{
    const Eye *eye = user;
    const Simulation *s = eye->sim;
    Vec2 a = eye->src->hood.s, b = s->veins.pos[node];
    if (s->blade->moving) {
        a = vec_scale(eye->src->material, 1.0 / s->def.growth.initial_length);
        b = vec_scale(s->veins.material[node], 1.0 / s->def.growth.initial_length);
        return reach_sees(s->reach, a, b);
    }
    double scale = 1.0 / blade_scale_at(s->blade, MAX(eye->src->birth, s->veins.birth[node]));
    return reach_sees(s->reach, vec_scale(a, scale), vec_scale(b, scale));
}

Field source_field(const Simulation *s, const Source *src, Eye *eye)
{
    *eye = (Eye){s, src};
    Vec2 c = s->veins.tree.centre;
    double h = s->veins.tree.half;
    return (Field){s->veins.pos, &s->veins.tree, {c.x - h, c.y - h, c.x + h, c.y + h}, s->reach ? sees : NULL, eye};
}

void source_look(Simulation *s, uint32_t k)
{
    Source *src = &s->source[k];
    Eye eye;
    Field f = source_field(s, src, &eye);
    if (s->def.pattern == PATTERN_OPEN) {
        s->near2[k] = HUGE_VAL;
        s->near[k] = quadtree_nearest(f.tree, src->hood.s, HUGE_VAL, f.sees, f.user, &s->near2[k]);
    } else if (s->def.neighbourhood == NEIGHBOURHOOD_RELATIVE) {
        hood_find(&src->hood, &f, src->hood.s);
    } else {
        urquhart_find(&src->hood, &src->cell, &f, src->hood.s);
    }
    s->counts.updates++;
}

/* Outside this box no new node can concern slot k. */
static Box2 zone_of(const Simulation *s, uint32_t k)
{
    if (s->def.pattern == PATTERN_CLOSED)
        return s->source[k].hood.zone;
    Vec2 p = s->place[k], c = s->veins.tree.centre;
    double h = s->veins.tree.half;
    if (s->near[k] == NO_POINT)
        return (Box2){c.x - h, c.y - h, c.x + h, c.y + h};
    return disc_box(p, s->near2[k]);
}

static void reserve(Simulation *s)
{
    if (s->n_sources < s->cap_sources)
        return;
    s->cap_sources = MAX(s->cap_sources * 2, 256);
    s->source = g_renew(Source, s->source, s->cap_sources);
    s->place = g_renew(Vec2, s->place, s->cap_sources);
    s->idle = g_renew(uint8_t, s->idle, s->cap_sources);
    s->near = g_renew(uint32_t, s->near, s->cap_sources);
    s->near2 = g_renew(double, s->near2, s->cap_sources);
}

static void source_add(Simulation *s, Vec2 p)
{
    reserve(s);
    uint32_t k = s->n_sources++;
    s->source[k] = (Source){.birth = s->blade->step};
    s->source[k].hood.s = p;
    s->source[k].material = s->blade->moving ? blade_material(s->blade, p) : p;
    s->place[k] = p;
    s->idle[k] = 0;
    source_look(s, k);
    zones_add(&s->zones, p, zone_of(s, k));
    s->n_unsorted++;
    s->counts.placed++;
}

void source_remove(Simulation *s, uint32_t k)
{
    cell_clear(&s->source[k].cell);
    s->place[k] = vec2((double)NAN, (double)NAN);
    s->idle[k] = 1;
    s->near2[k] = -1.0;
    zones_set(&s->zones, k, box_empty());
    s->n_removed++;
}

static bool vacant(const Simulation *s, Vec2 p)
{
    return !zones_any_within(&s->zones, s->place, p, s->def.birth_distance_sources * s->blade->unit) &&
           !quadtree_any_within(&s->veins.tree, p, vein_clearance(s));
}

/* A point uniform in the blade, by rejection from its box; FALSE in the (practically impossible) case of a long run of misses. */
static bool dart(const Simulation *s, uint64_t index, Vec2 *p)
{
    enum { TRIES = 256 };
    Box2 b = s->blade->box;
    for (uint64_t k = 0; k < TRIES; k++) {
        double u[2];
        random_pair(s->def.seed, RANDOM_DART, s->blade->step, index * TRIES + k, u);
        *p = vec2(b.x0 + u[0] * (b.x1 - b.x0), b.y0 + u[1] * (b.y1 - b.y0));
        if (blade_contains(s->blade, *p))
            return true;
    }
    return false;
}

static void throw_darts(Simulation *s)
{
    if (s->def.only_while_growing && s->blade->step > MAX(s->blade->last_step, 1))
        return;
    s->dart_carry += s->def.density * s->blade->area;
    uint64_t n = (uint64_t)s->dart_carry; /* the fraction is carried over, so that the mean is rho exactly */
    s->dart_carry -= (double)n;
    s->counts.darts += n;
    for (uint64_t i = 0; i < n; i++) {
        Vec2 p;
        s->misses++;
        if (dart(s, i, &p) && vacant(s, p)) {
            source_add(s, p);
            s->misses = 0;
        }
    }
}

/* Where few darts are thrown a step, a blade without a source need not be full: only when some darts in a row have found no room. */
bool sources_expected(const Simulation *s)
{
    enum { ENOUGH = 20, PATIENCE = 10000 };
    double darts = s->def.density * s->blade->area;
    return s->def.placement == PLACEMENT_DARTS && !s->def.only_while_growing && s->misses < ENOUGH && darts * PATIENCE > ENOUGH;
}

/* Waiting sources whose time has come. The precomputed set keeps b_s already; a listed source is placed as the user wants it. */
static void place_waiting(Simulation *s)
{
    bool listed = s->def.placement == PLACEMENT_LIST;
    uint32_t keep = s->next_waiting, i = keep;
    for (; i < s->n_waiting && s->waiting[i].step <= s->blade->step; i++) {
        Vec2 p = listed && !s->blade->moving ? vec_scale(s->waiting[i].pos, s->blade->unit) : s->waiting[i].pos;
        if (!blade_contains(s->blade, p) && s->blade->step < s->blade->last_step) {
            s->waiting[keep++] = s->waiting[i]; /* the margin has not passed it yet */
            continue;
        }
        if (listed || !quadtree_any_within(&s->veins.tree, p, vein_clearance(s)))
            source_add(s, p);
    }
    /* those that still wait move up to the end of the part just read */
    uint32_t kept = keep - s->next_waiting;
    memmove(s->waiting + i - kept, s->waiting + s->next_waiting, sizeof *s->waiting * kept);
    s->next_waiting = i - kept;
}

bool sources_waiting(const Simulation *s) { return s->next_waiting < s->n_waiting; }

void sources_place(Simulation *s)
{
    if (s->def.placement == PLACEMENT_DARTS)
        throw_darts(s);
    else
        place_waiting(s);
}

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

#define PERMUTE(array, slot, n)                                            \
    do {                                                                   \
        gpointer copy = g_memdup2(array, sizeof *(array) * s->n_sources);  \
        for (uint32_t k_ = 0; k_ < (n); k_++)                              \
            memcpy(&(array)[k_], (char *)copy + sizeof *(array) * (slot)[k_], sizeof *(array)); \
        g_free(copy);                                                      \
    } while (0)

void sources_sort(Simulation *s)
{
    uint32_t n = sources_alive(s), *slot = sorted_slots(s, n);
    PERMUTE(s->source, slot, n);
    PERMUTE(s->place, slot, n);
    PERMUTE(s->idle, slot, n);
    PERMUTE(s->near, slot, n);
    PERMUTE(s->near2, slot, n);
    g_free(slot);
    s->n_sources = n;
    s->n_removed = s->n_unsorted = 0;
    zones_reset(&s->zones);
    for (uint32_t k = 0; k < n; k++)
        zones_add(&s->zones, s->place[k], zone_of(s, k));
}

/* ---- sources known beforehand ---- */

static gint by_step(gconstpointer a, gconstpointer b, gpointer unused)
{
    const ListedSource *p = a, *q = b;
    return p->step < q->step ? -1 : p->step > q->step;
}

static gboolean prepare_margin(Simulation *s, GError **error)
{
    Box2 box = s->blade->widest;
    double scale = 1.0 / s->blade->last_length;
    double count = s->def.density * (box.x1 - box.x0) * (box.y1 - box.y0);
    if (s->def.growth.kind != GROWTH_MARGINAL && s->def.growth.kind != GROWTH_NONE) {
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SOURCES,
                    "sources.placement = margin needs growth.kind = marginal or none: in diffuse growth sources appear all over the blade");
        return FALSE;
    }
    if (count > 1e8) {
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SIZE,
                    "sources.density = %g asks for %.3g darts at once; at most 1e8 are possible", s->def.density, count);
        return FALSE;
    }
    Zones grid;
    zones_init(&grid, box, MAX(s->def.birth_distance_sources, sqrt(1.0 / MAX(s->def.density, 1e-12))));
    GArray *set = g_array_new(FALSE, FALSE, sizeof(ListedSource));
    GArray *place = g_array_new(FALSE, FALSE, sizeof(Vec2));
    s->counts.darts = (uint64_t)count;
    for (uint64_t i = 0; i < s->counts.darts; i++) {
        double u[2];
        random_pair(s->def.seed, RANDOM_MARGIN, 0, i, u);
        Vec2 p = vec2(box.x0 + u[0] * (box.x1 - box.x0), box.y0 + u[1] * (box.y1 - box.y0));
        if (!polygon_contains(s->def.leaf, vec_scale(p, scale)) ||
            zones_any_within(&grid, (Vec2 *)place->data, p, s->def.birth_distance_sources))
            continue;
        ListedSource it = {p, blade_step_passed(s->blade, p)};
        zones_add(&grid, p, (Box2){p.x, p.y, p.x, p.y});
        g_array_append_val(place, p);
        g_array_append_val(set, it);
    }
    zones_clear(&grid);
    g_array_free(place, TRUE);
    s->n_waiting = set->len;
    s->waiting = (ListedSource *)g_array_free(set, FALSE);
    return TRUE;
}

/* Whether a listed source lies in the blade in the end; one right on the margin may be off it by rounding, or by the flatness of a curve,
 * and a vein may reach a segment beyond. */
static bool in_reach(const Simulation *s, Vec2 p)
{
    if (s->blade->moving)
        return polygon_contains(s->blade->last_shape, p) || polygon_depth(s->blade->last_shape, p) >= -1.0;
    double scale = s->blade->last_length;
    Vec2 leaf = vec_scale(p, 1.0 / scale);
    return polygon_contains(s->def.leaf, leaf) || polygon_depth(s->def.leaf, leaf) * scale >= -1.0;
}

static gboolean prepare_list(Simulation *s, GError **error)
{
    s->n_waiting = s->def.n_list;
    s->waiting = g_memdup2(s->def.list, sizeof(ListedSource) * s->def.n_list);
    for (uint32_t i = 0; i < s->n_waiting; i++) {
        if (in_reach(s, s->waiting[i].pos))
            continue;
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SOURCES,
                    "sources.file: source %u at %g,%g lies outside the blade, which is %g segments long in the end", i + 1,
                    s->waiting[i].pos.x, s->waiting[i].pos.y, s->blade->last_length);
        return FALSE;
    }
    return TRUE;
}

gboolean sources_prepare(Simulation *s, GError **error)
{
    gboolean ok = s->def.placement == PLACEMENT_MARGIN ? prepare_margin(s, error)
                  : s->def.placement == PLACEMENT_LIST ? prepare_list(s, error)
                                                       : TRUE;
    if (ok && s->n_waiting > 1) /* stable: glib's is a merge sort */
        g_qsort_with_data(s->waiting, (gint)s->n_waiting, sizeof *s->waiting, by_step, NULL);
    return ok;
}
