/* What a running simulation holds; private to src/sim. */
#ifndef SIM_STATE_H
#define SIM_STATE_H

#include "geom/neighbours.h"
#include "geom/parallel.h"
#include "geom/quadtree.h"
#include "geom/reach.h"
#include "geom/grid.h"
#include "geom/vectors.h"
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

/* What slot k of the sources is besides its place. 0: it pulls one node, near[k], and that is all there is to it. Most sources are like
 * that: all of an open pattern, and those of a closed one that are ahead of the veins, as nearly all are where many are placed at once. */
enum {
    MARK_IDLE = 1,    /* pulls nothing: removed, or (open) its node can't get nearer */
    MARK_WITHIN = 2,  /* a node may lie within the kill distance */
    MARK_REACHED = 4, /* closed: a vein came within the kill distance; from then on only tagged veins count */
    MARK_ZONED = 8,   /* closed: zone[k] is known; as long as it is not, the source looks at every step's nodes */
    MARK_APART = 16,  /* open: it sees no node yet; closed: source[k] says what it pulls, near[k] nothing */
};

/* A source of a closed pattern: 64 bytes, which looks wait for. Bit i of a mask speaks of member i of the hood. */
typedef struct {
    Hood hood;        /* nodes that it pulls; out of date without MARK_APART */
    uint8_t tagged;   /* mask: this member belongs to a tagged vein */
    uint8_t spent;    /* mask: this member can't get nearer */
    uint32_t arrived; /* first of its arrivals, NO_POINT for none */
} Source;

/* A tagged vein's node that came within the kill distance of a reached source. */
typedef struct {
    uint32_t node, next; /* next: of the same source, or of the unused ones; NO_POINT at the end */
} Arrival;

/* A vein node that is pulled in this step: S(v) and the sum of eq. 1. */
typedef struct {
    uint32_t node;
    uint32_t first, last; /* slots of the sources that pull it lie between; last not included */
    uint32_t count;       /* of the pulls */
    Vec2 sum;
    bool barred; /* no child is born where the sum points to */
} Pulled;

/* Sources beside each other in the blade: those of a cell, or of 4 x 4 smaller ones, so of some runs of slots. Which of a step's nodes can
 * concern them at all is found for all of them together. */
enum { CROWD_SIDE = 4 };
typedef struct {
    uint32_t first[CROWD_SIDE], last[CROWD_SIDE]; /* runs of slots, the last one not included */
    Box2 place;                                   /* holds all of them */
    uint32_t plain;                               /* how many are not apart, or were when it was last measured */
    double most2;                                 /* not less than any near2 */
    ZoneBox zone;                                 /* holds their zones */
    bool restless;                                /* one that is apart has no zone */
    uint32_t lone; /* unless NO_POINT: the one node that all of them pull, unmarked; near[] and near2[] don't say so */
} Crowd;

/* Crowds beside each other, 4 x 4 at most: what a thread takes up at a time. Newcomers are in no square. */
typedef struct {
    uint32_t first_crowd, last_crowd;
    bool square;
} Unit;

/* Room for points (geom/points.h). */
typedef struct {
    uint32_t v[POINTS_MOST + 4];
    double x[POINTS_MOST + 4], y[POINTS_MOST + 4];
} PointsRoom;

/* The fresh nodes that may concern one of a unit's crowds. */
typedef struct {
    uint32_t n_nearest, n_rivals; /* above the limit: they did not fit, or it was not worth while */
    PointsRoom nearest, rival;
} Square;

/* The sources in crowds, as of the last sorting and with what has come since. */
typedef struct {
    uint32_t n_crowds, cap_crowds, n_units, cap_units, n_slots;
    Crowd *crowd;
    Unit *unit;
    uint32_t longest; /* sources of a crowd */
} Crowds;

/* Whether turns are faster by all threads or by one: found out again and again (turn.c). */
typedef enum { PACE_SHARED, PACE_TRIAL, PACE_ALONE } PaceKind; /* by all; by one to compare, or because that was faster */
typedef struct {
    PaceKind kind;
    uint32_t turns, shared, alone; /* of this kind, so far; how many of the other two there will be */
    double time, sources;          /* microseconds in all, sources in all */
    double cost;                   /* when shared, a source */
} Pace;

/* The sums of eq. 1 that one thread makes: entries of nodes, some of them perhaps twice. */
enum { TALLY_WAYS = 1024 };
typedef struct {
    Pulled *pulled;
    uint32_t n, cap;
    uint32_t way[TALLY_WAYS]; /* to the entry of the last node that has this remainder, if it is one of the n */
} Tally;

/* The sums of four nodes under way, a lane each: sources beside each other mostly pull the same few. */
typedef struct {
    Four x, y;
    EightNodes node, count; /* in two halves of a lane of x each; node NO_POINT: none */
    FourNodes line[4];      /* node i, to compare four slots with */
    FourNodes first, last;  /* as in Pulled */
    uint32_t run_first, run_last; /* slots at work */
    uint32_t next;          /* to go */
    uint32_t live;          /* sources that pull */
    Tally *tally;
} Sums;

typedef struct Lane Lane; /* turn.c: what a thread has to itself */

/* Squares of the frame that veins pass through. */
enum { PATHS_WIDEST = 12 };
typedef struct {
    Vec2 corner;
    double scale; /* squares a length */
    uint32_t nx, ny;
    uint8_t *bits; /* NULL: not kept */
    uint32_t n;    /* nodes entered */
    double radius; /* the clearance of darts by now, in squares */
    int rows, reach[PATHS_WIDEST]; /* squares wholly nearer than that: in rows 0 to rows - 1 away, up to reach away in the row */
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

/* What is kept at most: about 1 GB of sources, 20 GB of nodes. */
enum { MOST_SOURCES = 10000000, MOST_NODES = 1 << 28 };

struct Simulation {
    SimulationDef def;
    Blade *blade;
    Reach *reach; /* NULL: no sinus can come between a source and a vein */
    Veins veins;
    Given given;
    Pool *pool;
    /* Sources, sorted by place from time to time so that neighbours in the blade are neighbours in memory. One that was removed keeps
     * its slot, idle and nowhere (NaN), until the next sorting. Bytes a source, the grid included: 37 in an open pattern, 117 in a closed
     * one, and about 250 for an Urquhart cell. */
    Vec2 *place;      /* [n_sources] */
    uint32_t *birth;  /* [n_sources] step */
    uint8_t *mark;    /* [n_sources] MARK_… */
    Vec2 *material;   /* [n_sources] moving frames only */
    uint32_t *near;   /* [n_sources] the nearest node, NO_POINT for none; NEAR_APART: see source[k] */
    double *near2;    /* [n_sources] its squared distance; -1 for a source that is removed or (closed) apart */
    Source *source;   /* [n_sources] closed */
    ZoneBox *zone;    /* [n_sources] closed: no node outside can concern the source */
    Cell *cell;       /* [n_sources] closed, Urquhart neighbourhoods */
    uint32_t n_sources, cap_sources, n_unsorted;
    Grid grid;        /* of the sources' places; they are its items, item = slot, if sources_need_room */
    Crowds crowds;
    Paths paths;
    double dart_carry;
    uint32_t misses; /* darts in a row that found no room */
    uint32_t last_use; /* step in which the blade or a vein grew last; how many darts there were then */
    uint64_t last_darts;
    /* sources that wait to appear (margin, list), in the order in which they may */
    ListedSource *waiting;
    uint32_t n_waiting, next_waiting;
    /* work space of one step */
    Lane **lane; /* [n_lanes] */
    uint32_t n_lanes;
    Pace pace;
    bool drawn;      /* pulled[] speaks of the coming step already */
    uint32_t *fresh; /* nodes born in this step */
    uint32_t n_fresh, cap_fresh;
    Quadtree young;  /* the same, while they are being born: only if `looked` */
    bool looked;     /* where children have room was looked at before any was born */
    Boxtree fresh_tree;
    Points fresh_points; /* the same, unless there are many */
    Pulled *pulled; /* by number of the node */
    uint32_t n_pulled, cap_pulled;
    GArray *nodes; /* uint32_t: that are pulled */
    uint32_t n_live; /* sources that pull */
    uint32_t n_removed;
    Arrival *arrival;
    uint32_t n_arrivals, cap_arrivals, unused_arrival;
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
static inline bool sources_need_room(const Simulation *s) { return s->def.placement == PLACEMENT_DARTS; } /* those that come look how near others are */
bool sources_expected(const Simulation *s); /* darts may still find room */
bool sources_are_many(double darts);        /* so many a step are worth waiting for when the blade does not grow */

/* slots.c */
void source_add(Simulation *s, Vec2 p);       /* its neighbourhood is not known yet */
void source_look(Simulation *s, uint32_t k);  /* finds the neighbourhood of slot k from scratch */
void source_set_apart(Simulation *s, uint32_t k); /* closed: from now on source[k] tells what it pulls */
void source_weigh(Simulation *s, uint32_t k); /* sorts it out after its hood, or its one node, has changed: apart? MARK_WITHIN? */
void source_remove(Simulation *s, uint32_t k);
void sources_sort(Simulation *s);             /* drops removed slots, sorts by place, rebuilds the grid and the crowds */
bool source_sees(const Simulation *s, uint32_t k, uint32_t node); /* no sinus is between them; needs s->reach */
Box2 field_box(const Simulation *s);          /* holds all nodes that may ever come */

/* crowd.c */
void crowds_clear(Crowds *c);
void crowds_build(Simulation *s, const uint32_t *start); /* of sorted slots; those of cell i begin at start[i] */
void crowds_add(Simulation *s);                          /* takes in newcomers, whose neighbourhoods are known */
void crowd_part(Simulation *s, uint32_t k);              /* closed: slot k leaves the others and looks for itself from now on */
void crowd_measure(const Simulation *s, Crowd *c);       /* renews what depends on its sources' neighbourhoods */

/* Nodes beside each other in memory; a pair of places out of sight follows. */
enum { FEW = 1024, SIGHT_GUARDS = 8 };
typedef struct {
    uint32_t n;
    uint32_t v[FEW + 4];
    double x[FEW + 4], y[FEW + 4];
} Few;

/* sight.c */
void fresh_prepare(Simulation *s);                         /* lists them; a tree of them, if one is needed */
void fresh_nearest(const Simulation *s, const Field *f, Vec2 p, uint32_t *near, double *near2); /* as boxtree_nearest */
void square_prepare(const Simulation *s, const Unit *u, Square *q);

/* The fresh nodes that a crowd looks at. */
typedef struct {
    Few nearest; /* those that may be nearest to a source, ascending */
    int64_t kin[POINTS_MOST];    /* the nearest once more; in a closed pattern their parents, too, as the upper half */
    double stride2[POINTS_MOST]; /* closed: the squared distances from the nearest to their parents */
    Few rival;   /* closed: those that the nearest one need not exclude */
    double apart2[FEW][SIGHT_GUARDS]; /* squared distances of rivals from the first of the nearest */
} Sight;
uint32_t crowd_sole(const Simulation *s, const Crowd *c, Square *q); /* the one that is nearest to all of them; NO_POINT: perhaps there are several */
bool crowd_has_rivals(const Simulation *s, const Crowd *c, Square *q, uint32_t node, Sight *room); /* closed: of the one that is nearest to all of them */
bool crowd_sight(const Simulation *s, const Crowd *c, Square *q, Sight *sight); /* FALSE when there are too many, and each source must look for itself */

/* Where the pulls of a run of slots go: that of slot k to x[k - first], y[k - first]. NULL: nobody asks for them. */
typedef struct {
    double *x, *y;
    uint32_t first;
} Draw;

/* lone.c */
void crowd_rest(Simulation *s, Crowd *c, uint32_t node); /* they all pull one node */
void crowd_wake(Simulation *s, Crowd *c);                /* brings near[] and near2[] up to date */
void crowds_wake(Simulation *s, uint32_t node);          /* those that pull the node; NO_POINT: all */
bool crowd_turns(const Simulation *s, const Crowd *c, uint32_t node); /* all of a lone one turn to the node, and keep together, unless rivals part them */

/* look.c; what the sources of a crowd pull after it is drawn, too */
/* Shows the fresh nodes to a crowd; returns how many sources they may concern. q: NULL for newcomers; draw: of each run. */
uint32_t crowd_look(Simulation *s, Crowd *c, Square *q, Sight *room, const Draw *draw);
void source_look_open(Simulation *s, uint32_t k);   /* the same of one source */
void source_look_closed(Simulation *s, uint32_t k);

/* look_open.c, look_closed.c; slots first … last-1 of a crowd look at the few that there are. Return the largest near2.
 * `together` becomes FALSE unless all turn to one of them, and no more is to be said of any. */
double look_open_run(Simulation *s, uint32_t first, uint32_t last, const Sight *sight, const Draw *draw, bool *together);
double look_closed_run(Simulation *s, uint32_t first, uint32_t last, const Sight *sight, const Draw *draw, bool *together, bool *parted);

/* pull.c */
void sums_init(Sums *sums, Tally *tally);
void sums_end(const Sums *sums); /* enters what is under way */
void pulls_draw(const Simulation *s, uint32_t first, uint32_t last, const Draw *draw); /* slots first … last-1, at near[] */
/* Adds what a crowd's sources pull, which are drawn already unless it is lone. With `late`, slots where something happens first (develop.c)
 * are left out and go there. */
void crowd_pull(Simulation *s, Crowd *c, Sums *sums, const Draw *draw, GArray *late);
void source_pull(Simulation *s, uint32_t k, Sums *sums); /* that of slot k, whatever it is */
double lone_sum(const Vec2 *place, uint32_t n, Vec2 p, Vec2 *sum); /* adds the pulls of n sources on a node at p; returns the largest squared distance */

/* tally.c */
Pulled *tally_entry(Tally *t, uint32_t node);
void tallies_join(Simulation *s, const Tally *const *tally, uint32_t n); /* fills pulled[] */

/* turn.c */
void sources_turn(Simulation *s, bool look, bool remove, bool pull); /* all sources look at the new nodes, go when reached, pull */

void lanes_free(Simulation *s);

/* A pull at a node, found again: the next one at p->node from slot `from` on that has not been let go of since. FALSE when there is none. */
typedef struct {
    uint32_t slot;
    uint8_t member;
} Pull;
bool pulls_next(const Simulation *s, const Pulled *p, uint32_t from, Pull *pull);

/* develop.c */
uint32_t veins_develop(Simulation *s); /* grows the pulled nodes; returns how many live sources there were */
bool source_is_late(const Simulation *s, uint32_t k);  /* it may be removed, or a vein arrive at it */
bool source_remove_reached(Simulation *s, uint32_t k); /* returns whether it was */
void sources_remove(Simulation *s);    /* shows the new nodes to the sources; tags, arrivals, anastomoses, removal */

static inline bool source_is_alive(const Simulation *s, uint32_t k) { return s->place[k].x == s->place[k].x; }
static inline uint32_t sources_alive(const Simulation *s) { return s->n_sources - s->n_removed; }

/* Box of the disc around p with squared radius r2. */
static inline Box2 disc_box(Vec2 p, double r2)
{
    return box_grow((Box2){p.x, p.y, p.x, p.y}, sqrt(r2) * (1.0 + 1e-12));
}

enum { NEAR_APART = UINT32_MAX - 1 };

/* Slots behind the last one that there is memory for, as some loops take four at a time. */
enum { SLOTS_ASIDE = 3 };

static inline bool source_is_apart(const Simulation *s, uint32_t k) { return s->source && (s->mark[k] & MARK_APART); }

/* Number of nodes that slot k pulls or might pull, and node i of them. */
static inline uint32_t source_members(const Simulation *s, uint32_t k)
{
    return source_is_apart(s, k) ? s->source[k].hood.n : s->near[k] != NO_POINT;
}

static inline uint32_t source_member(const Simulation *s, uint32_t k, uint32_t i)
{
    return source_is_apart(s, k) ? s->source[k].hood.m[i] : s->near[k];
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
