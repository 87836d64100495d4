/* What a running simulation holds; private to src/sim. */
#ifndef SIM_STATE_H
#define SIM_STATE_H

#include "geom/neighbours.h"
#include "geom/quadtree.h"
#include "geom/reach.h"
#include "geom/zones.h"
#include "sim/simulation.h"

/* The veins so far. Node arrays are [cap]: 28 bytes a node, plus about 40 in the tree. */
typedef struct {
    uint32_t n, cap;
    Vec2 *pos;         /* in the frame (growth.h) */
    Vec2 *material;    /* moving frames only */
    uint32_t *parent;  /* NO_POINT for a seed */
    uint32_t *birth;   /* step */
    uint32_t *pull;    /* index of the node's entry in Simulation.pulled during a step; stale otherwise */
    Quadtree tree;
    uint32_t *join_tail, *join_head, *join_birth; /* anastomoses */
    uint32_t n_joins, cap_joins;
    GHashTable *joined; /* their pairs of nodes: two sources may be reached by the same two veins */
} Veins;

/* An auxin source. Bit i of a mask speaks of member i of the hood. */
typedef struct {
    uint32_t birth;    /* step */
    bool reached;      /* closed: a vein came within the kill distance; from then on only tagged veins count */
    uint8_t tagged;    /* mask: this member belongs to a tagged vein */
    uint8_t spent;     /* mask: this member can't get nearer */
    uint8_t n_arrived;
    Hood hood;         /* nodes that it pulls; hood.s is its place */
    uint32_t arrived[HOOD_MAX]; /* tagged veins' nodes that came within the kill distance */
    Vec2 material;     /* moving frames only */
    Cell cell;         /* Urquhart neighbourhoods only */
} Source;

/* One pull of a source at a vein node. */
typedef struct {
    uint32_t source;
    uint8_t member;
    uint32_t next; /* of the same node, NO_POINT at the end */
} Pull;

/* A vein node that is pulled in this step: S(v) and the sum of eq. 1. */
typedef struct {
    uint32_t node;
    uint32_t first, last; /* its pulls */
    uint32_t count;
    Vec2 sum;
} Pulled;

struct Simulation {
    SimulationDef def;
    Blade *blade;
    Reach *reach; /* NULL: no sinus can come between a source and a vein */
    Veins veins;
    /* Sources, sorted by place from time to time so that neighbours in the blade are neighbours in memory. One that was removed keeps
     * its slot, idle and nowhere (NaN), until the next sorting. */
    Source *source;   /* [n_sources] */
    Vec2 *place;      /* [n_sources] */
    uint8_t *idle;    /* [n_sources] pulls nothing: removed, or (open) its node can't get nearer */
    uint32_t *near;   /* [n_sources] open: nearest node, instead of a hood */
    double *near2;    /* [n_sources] open: its squared distance; -1 for a removed source */
    uint32_t n_sources, cap_sources, n_removed, n_unsorted;
    Zones zones;      /* of the sources; item = slot */
    double dart_carry;
    uint32_t misses; /* darts in a row that found no room */
    /* sources that wait to appear (margin, list), in the order in which they may */
    ListedSource *waiting;
    uint32_t n_waiting, next_waiting;
    /* work space of one step */
    Pull *pull;
    Pulled *pulled;
    uint32_t n_pull, cap_pull, n_pulled, cap_pulled;
    uint32_t *fresh; /* nodes born in this step */
    uint32_t n_fresh, cap_fresh;
    Boxtree fresh_tree;
    uint32_t *touched, n_touched; /* slots (open: cells) that the fresh nodes may concern */
    uint32_t cap_touched;
    gint seen; /* sources that looked at this step's nodes; atomic */
    SimulationCounts counts;
};

/* veins.c */
void veins_init(Veins *v, Box2 field);
void veins_clear(Veins *v);
uint32_t veins_add(Veins *v, Vec2 pos, uint32_t parent, uint32_t step);
bool veins_join(Veins *v, uint32_t a, uint32_t b, uint32_t step); /* FALSE: they are joined already */

/* sources.c */
gboolean sources_prepare(Simulation *s, GError **error);
void sources_place(Simulation *s);           /* the step's new sources */
void source_look(Simulation *s, uint32_t k); /* finds the neighbourhood of slot k from scratch */
void source_remove(Simulation *s, uint32_t k);
void sources_sort(Simulation *s);            /* drops removed slots, sorts by place, rebuilds s->zones */
bool sources_waiting(const Simulation *s);
bool sources_expected(const Simulation *s); /* darts may still find room */

/* develop.c */
uint32_t veins_develop(Simulation *s); /* grows the pulled nodes; returns how many live sources there are */
void sources_remove(Simulation *s);    /* tags, arrivals, anastomoses, removal */

static inline bool source_is_alive(const Simulation *s, uint32_t k) { return s->place[k].x == s->place[k].x; }
static inline uint32_t sources_alive(const Simulation *s) { return s->n_sources - s->n_removed; }

/* Box of the disc around p with squared radius r2. */
static inline Box2 disc_box(Vec2 p, double r2)
{
    return box_grow((Box2){p.x, p.y, p.x, p.y}, sqrt(r2) * (1.0 + 1e-12));
}

/* Number of nodes that slot k pulls or might pull, and node i of them. */
static inline uint32_t source_members(const Simulation *s, uint32_t k)
{
    return s->def.pattern == PATTERN_OPEN ? s->near[k] != NO_POINT : s->source[k].hood.n;
}

static inline Neighbour source_member(const Simulation *s, uint32_t k, uint32_t i)
{
    if (s->def.pattern == PATTERN_OPEN)
        return (Neighbour){s->veins.pos[s->near[k]], s->near2[k], s->near[k]};
    return s->source[k].hood.m[i];
}

/* The points as source `src` sees them. */
typedef struct {
    const Simulation *sim;
    const Source *src;
} Eye;
Field source_field(const Simulation *s, const Source *src, Eye *eye);

#endif
