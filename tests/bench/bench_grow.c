/* How growing scales, beside plain twins and on the static workload.
 *
 *     bench_grow [--quick] [PARAMS.ini]…
 *     bench_grow --sources FILE.csv
 *
 * Prints tables. First the static workload from 10³ sources on: times, what a source update, a new node and a dart cost, and how many times
 * as long the twin without an index takes (cached.h), whose time says how fast the machine is; on one thread, and what two make of it. Then
 * a closed and an open model (Runions 2005, fig. 9e) beside the twin that keeps nothing (plain.h), with nodes, source updates, time for each
 * of them and peak memory. Then the models given: poplar's and the life-size leaf's, at full size.
 * --sources grows the static workload from points of your own, x,y in segments from the base, open and closed, on one thread: for comparing
 * with other implementations on the same points.
 * What bounds it now. Of the static workload: every source turns to a new nearest node in every step, which makes 1.3e8 turns of 10⁵ sources
 * and 4e9 of 10⁶. An open turn takes 7 to 8 ns. More than half of the sources are in crowds that all pull one node and are moved on together (lone.c);
 * of them nothing is left but the square root and the division of each pull, 14 cycles for four of them. (Products alone, from a guessed root on, are
 * no faster in runs of 16 to 64.) The others are compared with the few nodes that their crowd looks at, a fifth of the time; which these are
 * takes a quarter (points.c), births a tenth. A closed turn takes 21 ns. A fifth of that is for the sources with several neighbours, which look for
 * themselves (hood_update), about 0.6 us each, most of it waiting on two trees; a quarter for the crowds near veins, where some of the nodes behind
 * the nearest one matter (block_rivals, all_excluded); a sixth to find which nodes a crowd looks at. Two threads have a part of the blade each and
 * meet twice a turn (turn.c), 0.1 to 0.4 us for each line of memory that one has written and the other reads, as far from each other as their caches
 * are; births, joining the sums and sorting are one thread's. Of a growing leaf: the first neighbourhoods of new sources
 * (hood_find), and room for darts and nodes (quadtree_any_within).
 * Ends with 1 when the plain twin grows another network, when threads do, or when a model takes more than 200 bytes a vein node. Times are of
 * the growth loop alone. --quick, of less than 20 seconds without a model, keeps to small cases and leaves Urquhart's neighbourhoods out. */
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cached.h"
#include "curve.h"
#include "geom/outline.h"
#include "lib/leaf.h"
#include "lib/settings.h"
#include "plain.h"
#include "sim/width.h"
#include "workload.h"

enum { MOST_BYTES = 200 }; /* a vein node of the model */

typedef struct {
    double seconds;
    SimulationCounts counts;
    uint64_t graph; /* hash of the network, free of the order of birth within a step */
    long peak;      /* growth of the process's peak memory, bytes */
    Costs costs;
} Result;

static long peak_memory(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss * 1024L;
}

/* ---- the same graph? ---- */

static uint64_t mix(uint64_t h)
{
    h = (h ^ (h >> 33)) * 0xFF51AFD7ED558CCDu;
    h = (h ^ (h >> 33)) * 0xC4CEB9FE1A85EC53u;
    return h ^ (h >> 33);
}

/* A node's place to a hundred-thousandth of a segment: sums of pulls may be rounded in another order. */
static uint64_t place_hash(const Network *net, uint32_t v)
{
    return mix((uint64_t)llrint(net->node[v].x * 1e5) +
               mix((uint64_t)llrint(net->node[v].y * 1e5) + mix(net->node_birth[v])));
}

/* Sums over nodes and edges, so that their order is of no concern. */
static uint64_t graph_hash(const Network *net)
{
    uint64_t h = net->n_nodes, *place = g_new(uint64_t, net->n_nodes);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        h += place[v] = place_hash(net, v);
    for (uint32_t e = 0; e < net->n_edges; e++)
        h += mix(mix(place[net->tail[e]]) * mix(place[net->head[e]]) + net->birth[e] + 31u * net->kind[e]);
    g_free(place);
    return h;
}

/* ---- one run, in a process of its own so that its peak memory is its own ---- */

typedef enum { WITH_INDEX, PLAIN, CACHED, BY_PART } How; /* src/sim, or a twin; src/sim with a clock in it */

static Result measure(const SimulationDef *def, How how)
{
    Result r = {0};
    long before = peak_memory();
    gint64 start = g_get_monotonic_time();
    Network *net;
    if (how == BY_PART) {
        r.costs = curve_costs(def);
        return r;
    }
    if (how == CACHED) {
        cached_grow(def, &r.counts);
        r.seconds = (double)(g_get_monotonic_time() - start) * 1e-6;
        return r;
    }
    if (how == PLAIN) {
        net = plain_grow(def, &r.counts);
    } else {
        GError *error = NULL;
        Simulation *s = simulation_new(def, &error);
        if (!s) {
            fprintf(stderr, "%s\n", error->message);
            _exit(1);
        }
        while (simulation_step(s))
            ;
        r.counts = simulation_counts(s);
        r.seconds = (double)(g_get_monotonic_time() - start) * 1e-6;
        r.peak = peak_memory() - before;
        net = simulation_network(s);
        simulation_free(s);
    }
    if (how == PLAIN) {
        r.seconds = (double)(g_get_monotonic_time() - start) * 1e-6;
        r.peak = peak_memory() - before;
    }
    r.graph = graph_hash(net);
    network_free(net);
    return r;
}

static Result run(const SimulationDef *def, How how)
{
    Result r;
    int channel[2];
    fflush(stdout);
    if (pipe(channel) != 0)
        g_error("no pipe");
    pid_t child = fork();
    if (child == 0) {
        r = measure(def, how);
        gssize n = write(channel[1], &r, sizeof r);
        _exit(n == (gssize)sizeof r ? 0 : 1);
    }
    close(channel[1]);
    gssize n = read(channel[0], &r, sizeof r);
    close(channel[0]);
    waitpid(child, NULL, 0);
    if (n != (gssize)sizeof r)
        g_error("a run failed");
    return r;
}

/* ---- tables ---- */

static void heading(const char *title)
{
    printf("\n%s\n\n| %-26s | %8s | %6s | %8s | %8s | %9s | %8s | %9s | %8s | %8s |\n", title, "case", "seconds", "steps",
           "nodes", "left", "updates", "us/node", "ns/update", "peak MB", "bytes/n");
    printf("| -------------------------- | -------: | -----: | -------: | -------: | --------: | -------: | --------: "
           "| -------: | -------: |\n");
}

static void row(const char *name, const Result *r)
{
    const SimulationCounts *c = &r->counts;
    double us = r->seconds * 1e6;
    printf("| %-26s | %8.3f | %6u | %8u | %8u | %9.2e | %8.2f | %9.1f | %8.1f | %8.0f |\n", name, r->seconds, c->step, c->nodes,
           c->sources, (double)c->updates, us / c->nodes, c->updates ? 1e3 * us / (double)c->updates : 0.0, (double)r->peak * 1e-6,
           (double)r->peak / c->nodes);
    fflush(stdout);
}

/* Both ways; FALSE when they differ. */
static gboolean beside_plain(const char *name, SimulationDef def)
{
    def.threads = 1;
    Result fast = run(&def, WITH_INDEX), plain = run(&def, PLAIN);
    char *label = g_strdup_printf("%s, plain twin", name);
    row(name, &fast);
    row(label, &plain);
    g_free(label);
    gboolean same =
        fast.graph == plain.graph && fast.counts.nodes == plain.counts.nodes && fast.counts.joins == plain.counts.joins;
    printf("%s: %.0f times as fast, %s\n", name, plain.seconds / fast.seconds,
           same ? "the same network" : "ANOTHER NETWORK");
    return same;
}

static Polygon *ovate(void)
{
    OutlineDef def = outline_def_default();
    return outline_new(&def, NULL);
}

/* Row 9e of the paper's table 1 (kill distance 1), or the same open, at a final length. */
static SimulationDef row_9e(const Polygon *leaf, Pattern pattern, double final_length)
{
    SimulationDef d = simulation_def_default();
    d.leaf = leaf;
    d.growth.kind = GROWTH_MARGINAL;
    d.growth.initial_length = 270;
    d.growth.final_length = final_length;
    d.growth.step = 8;
    d.pattern = pattern;
    d.threads = 1;
    return d;
}

/* The last size is beyond the twin, whose time grows as the fifth power of the length. */
static gboolean bench_sizes(gboolean quick)
{
    static const double all[] = {300, 450, 600, 1600}, some[] = {300, 600, 1200};
    const double *length = quick ? some : all;
    uint32_t n = quick ? 3 : 4, n_beside = quick ? 1 : 3;
    gboolean same = TRUE;
    Polygon *leaf = ovate();
    for (int p = 0; p < 2; p++) {
        heading(p ? "Closed, marginal growth (9e) to some lengths" : "Open, the same leaves");
        for (uint32_t i = 0; i < n; i++) {
            SimulationDef d = row_9e(leaf, p ? PATTERN_CLOSED : PATTERN_OPEN, length[i]);
            char *name = g_strdup_printf("%s %g", p ? "closed" : "open", length[i]);
            if (i < n_beside) {
                same &= beside_plain(name, d);
            } else {
                Result r = run(&d, WITH_INDEX);
                row(name, &r);
            }
            g_free(name);
        }
    }
    polygon_free(leaf);
    return same;
}

/* One case of the static workload; `twin` seconds of the twin for so many sources, 0 when it was not asked. */
static gboolean static_case(const Workload *w, const char *name, double twin)
{
    SimulationDef d = w->def;
    d.threads = 1;
    Result one = run(&d, WITH_INDEX), part = run(&d, BY_PART);
    d.threads = 2;
    Result two = run(&d, WITH_INDEX);
    const SimulationCounts *c = &one.counts;
    char *times = twin > 0.0 ? g_strdup_printf("%.1f", twin / one.seconds) : g_strdup("");
    printf("| %-14s | %8.3f | %5u | %8u | %5u | %9.2e | %9.1f | %7.2f | %7.2f | %7.1f | %8s | %7.2f |\n", name, one.seconds, c->step, c->nodes,
           c->sources, (double)c->updates, part.costs.update * 1e9, part.costs.node * 1e6, part.costs.dart * 1e6, (double)one.peak * 1e-6, times,
           one.seconds / two.seconds);
    fflush(stdout);
    g_free(times);
    return one.graph == two.graph;
}

static void static_heading(const char *title)
{
    printf("\n%s\n\n| %-14s | %8s | %5s | %8s | %5s | %9s | %9s | %7s | %7s | %7s | %8s | %7s |\n", title, "case", "seconds", "steps", "nodes",
           "left", "updates", "ns/update", "us/node", "us/dart", "peak MB", "twin / s", "1 / 2 t");
    printf("| -------------- | -------: | ----: | -------: | ----: | --------: | --------: | ------: | ------: | ------: | -------: | "
           "------: |\n");
}

/* The twin needs a minute for 10⁵ sources. */
static double twin_case(const Workload *w, const char *name)
{
    Result r = run(&w->def, CACHED);
    printf("| %-14s | %8.3f | %5u | %8u | %5u | %9s | %9s | %7s | %7s | %7s | %8s | %7s |\n", name, r.seconds, r.counts.step, r.counts.nodes,
           r.counts.sources, "", "", "", "", "", "1", "");
    fflush(stdout);
    return r.seconds;
}

/* Seeds 1001, 1002, … for 10³, 10⁴, … sources. */
static gboolean bench_static(gboolean quick)
{
    enum { MOST = 4 };
    gboolean same = TRUE;
    double twin[MOST] = {0};
    static_heading("Static workload; twin / s: times as long as that the twin takes; 1 / 2 t: one thread to two");
    for (int p = 0; p < 2; p++)
        for (uint32_t i = 0, n = quick ? 250 : 1000; i < (quick ? 3u : MOST); i++, n *= 10) {
            Workload *w = workload_new(n, 1001 + i, p ? PATTERN_CLOSED : PATTERN_OPEN);
            char *name = g_strdup_printf("%s %u", p ? "closed" : "open", n);
            if (p == 0 && n <= 100000)
                twin[i] = twin_case(w, "twin");
            same &= static_case(w, name, twin[i]);
            g_free(name);
            workload_free(w);
        }
    return same;
}

static gboolean bench_sources(const char *path)
{
    GError *error = NULL;
    Workload *w = workload_read(path, &error);
    if (!w) {
        fprintf(stderr, "bench_grow: %s\n", error->message);
        g_error_free(error);
        return FALSE;
    }
    gboolean same = TRUE;
    static_heading(path);
    double twin = w->n <= 100000 ? twin_case(w, "twin, open") : 0.0;
    for (int p = 0; p < 2; p++) {
        w->def.pattern = p ? PATTERN_CLOSED : PATTERN_OPEN;
        same &= static_case(w, p ? "closed" : "open", twin);
    }
    workload_free(w);
    return same;
}

static gboolean small_enough(const Result *r)
{
    double bytes = (double)r->peak / r->counts.nodes;
    if (bytes <= MOST_BYTES)
        return TRUE;
    fprintf(stderr, "bench_grow: %.0f bytes a node, of %d at most\n", bytes, MOST_BYTES);
    return FALSE;
}

/* A model of params/ at its full size, with both neighbourhoods. */
static gboolean bench_model(const char *path, gboolean quick)
{
    gboolean ok = TRUE;
    GError *error = NULL;
    Params *p = params_load(path, &error);
    Vec2 base, tip;
    Polygon *leaf = p ? settings_outline(p, NULL, &base, &tip, &error) : NULL;
    if (!leaf) {
        fprintf(stderr, "%s\n", error->message);
        return FALSE;
    }
    heading(path);
    gboolean large = params_number(p, PARAM_GROWTH_FINAL_LENGTH) > 5000; /* Urquhart's neighbourhoods would take too long */
    for (int n = 0; n < (quick || large ? 1 : 2); n++)
        for (unsigned threads = 1; threads != 2; threads = threads ? 0 : 2) { /* one, then all (0) */
            SimulationDef d;
            if (!settings_simulation(p, leaf, 1, threads, &d, &error)) {
                fprintf(stderr, "%s\n", error->message);
                return FALSE;
            }
            d.pattern = PATTERN_CLOSED;
            d.neighbourhood = n ? NEIGHBOURHOOD_URQUHART : NEIGHBOURHOOD_RELATIVE;
            Result r = run(&d, WITH_INDEX);
            char *name = g_strdup_printf("%s%s", n ? "Urquhart" : "relative", threads ? "" : ", all threads");
            row(name, &r);
            ok &= small_enough(&r);
            g_free(name);
            settings_simulation_clear(&d);
        }
    polygon_free(leaf);
    params_free(p);
    return ok;
}

int main(int argc, char **argv)
{
    gboolean quick = FALSE, ok = TRUE;
    int model = 1;
    if (argc == 3 && strcmp(argv[1], "--sources") == 0)
        return bench_sources(argv[2]) ? 0 : 1;
    if (argc > 1 && strcmp(argv[1], "--quick") == 0)
        quick = TRUE, model++;
    if (argc > model && argv[model][0] == '-') {
        fprintf(stderr, "usage: bench_grow [--quick] [PARAMS.ini]... | --sources FILE.csv\n");
        return 2;
    }
    ok &= bench_static(quick);
    ok &= bench_sizes(quick);
    for (; model < argc; model++)
        ok &= bench_model(argv[model], quick);
    if (!ok)
        fprintf(stderr, "bench_grow: another network, too much memory, or a run failed\n");
    return ok ? 0 : 1;
}
