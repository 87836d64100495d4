/* What a running simulation holds; private to src/sim. */
#ifndef SIM_STATE_H
#define SIM_STATE_H

#include "geom/neighbours.h"
#include "geom/parallel.h"
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

/* What slot k of the sources is besides its place. */
enum {
    MARK_IDLE = 1,    /* pulls nothing: removed, or (open) its node can't get nearer */
    MARK_WITHIN = 2,  /* a node may lie within the kill distance */
    MARK_REACHED = 4, /* closed: a vein came within the kill distance; from then on only tagged veins count */
    MARK_ZONED = 8,   /* closed: the index holds the zone; as long as it does not, the source looks at every step's nodes */
    MARK_GROWN = 16,  /* its zone has grown beyond the boxes above it */
};

/* A source of a closed pattern: 64 bytes, which looks wait for. Bit i of a mask speaks of member i of the hood. */
typedef struct {
    Hood hood;        /* nodes that it pulls */
    uint8_t tagged;   /* mask: this member belongs to a tagged vein */
    uint8_t spent;    /* mask: this member can't get nearer */
    uint32_t arrived; /* first of its arrivals, NO_POINT for none */
} Source;

/* A tagged vein's node that came within the kill distance of a reached source. */
typedef struct {
    uint32_t node, next; /* next: of the same source, or of the unused ones; NO_POINT at the end */
} Arrival;

/* One pull of a source at a vein node, as the threads find it. */
typedef struct {
    Vec2 towards; /* of length 1 */
    uint32_t node, source;
    uint8_t member;
} Draught;

enum { SHARE = 256, SHARES = 16 };
typedef struct {
    uint32_t n, live; /* pulls; sources that pull */
    Draught pull[SHARE * HOOD_MAX];
} Share;

/* The same in the list of its node. */
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
    bool barred; /* no child is born where the sum points to */
} Pulled;

/* Squares of the frame that veins pass through: most darts that come down too near to a vein come down in one. */
typedef struct {
    Vec2 corner;
    double scale; /* squares a length */
    uint32_t nx;
    uint8_t *bits; /* NULL: not kept */
    uint32_t n;    /* nodes entered */
} Paths;

/* The veins of SimulationDef.given. */
typedef struct {
    uint32_t n, next;  /* nodes; how many are there yet */
    Vec2 *place;       /* [n] marginal growth: in the frame; else material */
    uint32_t *step;    /* [n] at which it appears */
    uint32_t *turn;    /* [n] the order in which they do */
    uint32_t *node;    /* [n] its number among the veins */
    uint32_t *parent;  /* [n] among the given ones */
    Quadtree pending;  /* places of those that will come */
} Given;

struct Simulation {
    SimulationDef def;
    Blade *blade;
    Reach *reach; /* NULL: no sinus can come between a source and a vein */
    Veins veins;
    Given given;
    Pool *pool;
    /* Sources, sorted by place from time to time so that neighbours in the blade are neighbours in memory. One that was removed keeps
     * its slot, idle and nowhere (NaN), until the next sorting. Bytes a source, the index of zones included: 53 in an open pattern, 105
     * in a closed one, and about 250 for an Urquhart cell. */
    Vec2 *place;      /* [n_sources] */
    uint32_t *birth;  /* [n_sources] step */
    uint8_t *mark;    /* [n_sources] MARK_… */
    Vec2 *material;   /* [n_sources] moving frames only */
    uint32_t *near;   /* [n_sources] open: nearest node */
    double *near2;    /* [n_sources] open: its squared distance; -1 for a removed source */
    Source *source;   /* [n_sources] closed */
    Cell *cell;       /* [n_sources] closed, Urquhart neighbourhoods */
    Arrival *arrival;
    uint32_t n_arrivals, cap_arrivals, unused_arrival;
    uint32_t n_sources, cap_sources, n_removed, n_unsorted;
    Zones zones;      /* of the sources; item = slot */
    gint grown;       /* there is a MARK_GROWN; atomic */
    Paths paths;
    double dart_carry;
    uint32_t misses; /* darts in a row that found no room */
    /* sources that wait to appear (margin, list), in the order in which they may */
    ListedSource *waiting;
    uint32_t n_waiting, next_waiting;
    /* work space of one step */
    Share *share; /* [SHARES] */
    Pull *pull;
    Pulled *pulled;
    uint32_t n_pull, cap_pull, n_pulled, cap_pulled;
    uint32_t *fresh; /* nodes born in this step */
    uint32_t n_fresh, cap_fresh;
    Quadtree young;  /* the same, while they are being born */
    Boxtree fresh_tree;
    uint32_t *touched, n_touched; /* squares of cells with sources that the fresh nodes may concern */
    gint seen; /* sources that looked at this step's nodes; atomic */
    SimulationCounts counts;
};

/* veins.c */
void veins_init(Veins *v, Box2 field);
void veins_clear(Veins *v);
uint32_t veins_add(Veins *v, Vec2 pos, uint32_t parent, uint32_t step);
bool veins_join(Veins *v, uint32_t a, uint32_t b, uint32_t step); /* FALSE: they are joined already */

/* given.c */
void given_prepare(Simulation *s);
void given_clear(Given *g);
bool given_claims(const Simulation *s, Vec2 p); /* a drawn vein will pass here, so no other grows in its place */
void given_appear(Simulation *s, void (*fresh)(Simulation *s, uint32_t node)); /* those whose step has come; tells each, unless NULL */

/* sources.c */
gboolean sources_prepare(Simulation *s, GError **error);
void sources_place(Simulation *s);          /* the step's new sources */
bool sources_waiting(const Simulation *s);
bool sources_expected(const Simulation *s); /* darts may still find room */

/* slots.c */
void source_add(Simulation *s, Vec2 p);       /* its neighbourhood is not known yet */
void source_look(Simulation *s, uint32_t k);  /* finds the neighbourhood of slot k from scratch */
void source_weigh(Simulation *s, uint32_t k); /* MARK_WITHIN, from the neighbours */
void source_remove(Simulation *s, uint32_t k);
void sources_sort(Simulation *s);             /* drops removed slots, sorts by place, rebuilds s->zones */
bool source_sees(const Simulation *s, uint32_t k, uint32_t node); /* no sinus is between them; needs s->reach */
Box2 field_box(const Simulation *s);          /* holds all nodes that may ever come */
Box2 source_zone(const Simulation *s, uint32_t k); /* outside it no new node can concern slot k */

/* look.c */
void sources_update(Simulation *s); /* shows this step's nodes to the sources that they may concern */

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

static inline uint32_t source_member(const Simulation *s, uint32_t k, uint32_t i)
{
    return s->def.pattern == PATTERN_OPEN ? s->near[k] : s->source[k].hood.m[i];
}

/* The points as the source in slot k sees them. */
typedef struct {
    const Simulation *sim;
    uint32_t slot;
} Eye;
Field source_field(const Simulation *s, uint32_t k, Eye *eye);

/* Squares of lengths in the frame. A node nearer than `past` to a source can't get nearer by a step of D = 1, only past it: the source lets
 * go of it. */
static inline double kill2(const Simulation *s)
{
    double kill = s->def.kill_distance * s->blade->unit;
    return kill * kill;
}
static inline double past2(const Simulation *s) { return 0.25 * s->blade->unit * s->blade->unit; }

#endif
