/* The simulation of vein development (Runions 2005, sections 3 and 4). */
#ifndef SIM_SIMULATION_H
#define SIM_SIMULATION_H

#include <glib.h>

#include "geom/polygon.h"
#include "sim/growth.h"
#include "sim/network.h"

typedef enum { PATTERN_OPEN, PATTERN_CLOSED } Pattern;
typedef enum { NEIGHBOURHOOD_RELATIVE, NEIGHBOURHOOD_URQUHART } Neighbourhood;
typedef enum { PLACEMENT_DARTS, PLACEMENT_MARGIN, PLACEMENT_LIST } Placement;

/* A source of an explicit list: where it is, in segments, and the step from which on it may appear. */
typedef struct {
    Vec2 pos;
    uint32_t step;
} ListedSource;

typedef struct {
    const Polygon *leaf; /* outline in leaf coordinates; borrowed for the life of the simulation */
    GrowthDef growth;
    /* auxin sources; lengths in segments */
    Placement placement;
    double density;                        /* darts per segment² and step; margin: per segment², once */
    bool only_while_growing;               /* no darts once growth has ended */
    double birth_distance_sources, birth_distance_veins;
    const ListedSource *list;              /* PLACEMENT_LIST; borrowed */
    uint32_t n_list;
    /* veins */
    Pattern pattern;
    Neighbourhood neighbourhood;
    double kill_distance;
    const Vec2 *seeds; /* first nodes, in initial leaf lengths; borrowed during simulation_new */
    uint32_t n_seeds;
    const Network *given; /* veins that are there from the start, or as soon as the margin of marginal growth has passed them; NULL: none. Borrowed */
    double given_length;  /* leaf length in that network's segments, whose base is at 0,0 and tip at 0,length */
    double sinus_depth;   /* leaf lengths */
    double join_distance; /* segments */
    uint32_t max_steps;   /* 0: no limit */
    uint64_t seed;
    unsigned threads;
} SimulationDef;

SimulationDef simulation_def_default(void);

typedef enum {
    SIMULATION_ERROR_SEEDS,   /* a first vein node outside the blade, or none */
    SIMULATION_ERROR_SOURCES, /* a listed source outside the leaf, a placement that doesn't fit the growth */
    SIMULATION_ERROR_SIZE,    /* the leaf would be too large to grow */
} SimulationError;
#define SIMULATION_ERROR simulation_error_quark()
GQuark simulation_error_quark(void);

/* Why a run ended. */
typedef enum {
    END_RUNNING,
    END_NO_SOURCES, /* growth has ended and every source was reached */
    END_UNREACHED,  /* growth has ended and none of the sources left can be reached */
    END_MAX_STEPS,
    END_BARE,       /* growth has ended and no source ever found room */
    END_LOADED,     /* there was no run: the network was read from a file, */
    END_DRAWN,      /* drawn or found in a scan, */
    END_LSYSTEM,    /* or written by an L-system */
    END_CROWDED,    /* there are more sources or nodes than can be kept: a failure */
} EndReason;
const char *end_reason_text(EndReason r);

typedef struct {
    uint32_t step, nodes, joins; /* joins: anastomoses */
    uint32_t sources;            /* alive now */
    uint64_t darts, placed;      /* thrown, accepted */
    uint64_t reached;            /* sources that veins reached */
    uint64_t given_up;           /* sources left that no vein can reach */
    uint64_t updates;            /* source neighbourhood updates (work done) */
    uint32_t most_sources;       /* alive at one step */
    EndReason end;
} SimulationCounts;

typedef struct Simulation Simulation;

Simulation *simulation_new(const SimulationDef *def, GError **error);
void simulation_free(Simulation *s);

/* One turn of the loop of section 3.3: grow the blade, place the sources, develop the veins, remove the sources. Returns FALSE, with
 * counts.end set, when the run has ended. */
bool simulation_step(Simulation *s);

SimulationCounts simulation_counts(const Simulation *s);
const Blade *simulation_blade(const Simulation *s);

/* Rough part of the run that is done, 0 … 1, for progress bars. */
double simulation_done(const Simulation *s);

/* The veins as they are now, as a graph in segments: nodes and edges without widths and orders (network_assign_widths). */
Network *simulation_network(const Simulation *s);

/* The number of each node of def.given in it, UINT32_MAX for one that is not there yet; NULL without given veins. */
const uint32_t *simulation_given(const Simulation *s);

/* Leaf length at the end of growth, segments; 0 for growth that contradicts itself, with the error. */
double simulation_final_length(const SimulationDef *def, GError **error);

#endif
