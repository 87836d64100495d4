/* Best paths over the ridges: Dijkstra's over places and directions, so that a path that bends pays for it and one that hasn't the direction of a ridge
 * gains nothing by crossing it. Places are cells of 2 × 2 working pixels. When a vein is added, only what depended on its place is found anew. */
#include <math.h>
#include <string.h>

#include "scan/found_parts.h"
#include "scan/found_queue.h"

enum { WAYS = 16, SCALE = 8, FAR = UINT32_MAX, CELL = 2, UNSEEN = 32 };
enum { TURNED_LEFT = 3, TURNED_RIGHT = 4, SOURCE = 5 };
static const double floor_strength = 0.06; /* what even no ridge counts as */
static const double longest_gap = 0.03;    /* of the leaf's length: a vein may be unseen for so long */
static const double base_radius = 0.025;   /* of the leaf's length */
static const double turn_cost = 0.02;      /* of the length, of the clearest ridge, for each turn by 22.5 degrees; two are free to wiggle in */
static const double turn_loss = 0.007;     /* of evidence */
static const double poorest = -0.03;       /* of the length: paths with so little evidence are given up */
static const double leaving = 0.35;        /* least strength in the band of the vein that a path leaves */
static const double over_hole = 0.5, over_bite = 0.4; /* strength where nothing can be seen: paths go straight over holes rather than round them */
static const double over_loss = 0.25;      /* of evidence */
static const double blind_share = 0.15;    /* of their length there counts as unseen */
static const double beside = 0.15;         /* strength in another vein's band */

/* Steps at 0, 26.6, 45, 63.4 … degrees, y down: the first 8 are FoundRidges.along, the others go back. */
static const int8_t step_x[WAYS] = {1, 2, 1, 1, 0, -1, -1, -2, -1, -2, -1, -1, 0, 1, 1, 2};
static const int8_t step_y[WAYS] = {0, -1, -1, -2, -1, -2, -1, -1, 0, 1, 1, 2, 1, 2, 1, 1};
static const float step_length[3] = {1.0f, 1.41421356f, 2.23606798f};

/* How a state is reached; together, as they are looked at together. */
typedef struct {
    uint32_t distance; /* FAR: not at all */
    float gain;        /* evidence so far */
    uint16_t owner;    /* the vein it started from */
    uint16_t unseen;   /* length of the gap it is in, 1/32 cells */
    uint8_t from;      /* 0, 1, 2: stepped with way - 1, way, way + 1; TURNED_LEFT …; SOURCE */
} State;

/* A state is cell · 16 + way: a path that is at the cell and heads in the way, along which it may step, or along the ways next to it. */
struct FoundPaths {
    uint32_t width, height; /* cells */
    uint32_t x0, y0;        /* the first cell's pixel */
    uint32_t leaf_width;    /* of the working image */
    double length;          /* of the leaf, cells */
    float threshold, turn_loss, poorest;
    uint32_t gap;           /* 1/32 cells */
    bool anywhere;          /* paths are followed whatever their evidence */
    uint32_t turn_cost;
    uint8_t *ground;    /* [cells] BLADE … */
    uint8_t *along;     /* [cells][8] strength, 0 … 255 */
    uint16_t *band;     /* [cells] 1 + the vein that it is near, 0 none; EVERYBODY around the base */
    uint16_t *wall;     /* [cells] 1 + the vein whose line runs there; 0 none */
    State *state;       /* [states] */
    uint32_t cost[256][3];
    FoundQueue queue;
};
enum { EVERYBODY = UINT16_MAX };
enum { NOWHERE, OUTSIDE, HOLE, RIM, BLADE }; /* OUTSIDE: beyond the outline, where only paths may lead that are followed anywhere; RIM: too near to it for ridges */
static const float hopeless = -1e9f; /* gain of paths that are given up: these only replace others that were longer */

static inline uint32_t kind(uint32_t way) { return way % 2 ? 2 : way % 4 ? 1 : 0; }

static void read_ridges(FoundPaths *p, const FoundLeaf *l, const FoundRidges *r, Vec2 base)
{
    for (uint32_t y = 0; y < p->height; y++)
        for (uint32_t x = 0; x < p->width; x++) {
            gsize c = (gsize)y * p->width + x;
            uint8_t ground = x < 2 || y < 2 || x + 2 >= p->width || y + 2 >= p->height ? NOWHERE : OUTSIDE;
            for (uint32_t k = 0; k < CELL * CELL; k++) {
                gsize i = (gsize)(p->y0 + y * CELL + k / CELL) * l->width + p->x0 + x * CELL + k % CELL;
                uint8_t here = l->hole[i] ? HOLE : l->deep[i] ? BLADE : l->inside[i] ? RIM : NOWHERE;
                ground = MAX(ground, here);
                for (uint32_t m = 0; m < FOUND_MOVES; m++)
                    p->along[c * FOUND_MOVES + m] = MAX(p->along[c * FOUND_MOVES + m], (uint8_t)(255.0f * r->along[m]->px[i] + 0.5f));
            }
            p->ground[c] = ground;
            double dx = p->x0 + (x + 0.5) * CELL - base.x, dy = p->y0 + (y + 0.5) * CELL - base.y;
            p->band[c] = dx * dx + dy * dy < base_radius * l->length * base_radius * l->length ? EVERYBODY : 0;
        }
}

/* No state is reached. */
static void forget(FoundPaths *p)
{
    for (gsize i = 0; i < (gsize)p->width * p->height * WAYS; i++)
        p->state[i].distance = FAR;
}

FoundPaths *found_paths_new(const FoundLeaf *l, const FoundRidges *r, double threshold, Vec2 base)
{
    FoundPaths *p = g_new0(FoundPaths, 1);
    p->x0 = p->y0 = l->pad - 3 * CELL;
    p->leaf_width = l->width;
    p->width = (l->width - 2 * p->x0) / CELL;
    p->height = (l->height - 2 * p->y0) / CELL;
    p->length = l->length / CELL;
    p->threshold = (float)threshold;
    p->turn_loss = (float)(turn_loss * p->length);
    p->turn_cost = (uint32_t)(turn_cost * p->length * SCALE + 0.5);
    p->gap = (uint32_t)(longest_gap * p->length * UNSEEN);
    p->poorest = (float)(poorest * p->length);
    gsize cells = (gsize)p->width * p->height, states = cells * WAYS;
    p->ground = g_new0(uint8_t, cells);
    p->along = g_new0(uint8_t, cells * FOUND_MOVES);
    p->band = g_new0(uint16_t, cells);
    p->wall = g_new0(uint16_t, cells);
    p->state = g_new0(State, states);
    found_queue_init(&p->queue);
    forget(p);
    read_ridges(p, l, r, base);
    for (uint32_t s = 0; s < 256; s++)
        for (uint32_t k = 0; k < 3; k++) {
            double c = 1.0 / (floor_strength + s / 255.0);
            p->cost[s][k] = (uint32_t)(SCALE * (double)step_length[k] * c * c + 0.5);
        }
    return p;
}

void found_paths_free(FoundPaths *p)
{
    if (!p)
        return;
    g_free(p->ground);
    g_free(p->along);
    g_free(p->band);
    g_free(p->wall);
    g_free(p->state);
    found_queue_clear(&p->queue);
    g_free(p);
}

/* --- steps --- */

/* Where a path may lead, but straight ahead only, and sees nothing. */
static inline bool is_blind(const FoundPaths *p, uint32_t cell)
{
    return p->ground[cell] == HOLE || (p->anywhere && (p->ground[cell] == OUTSIDE || p->ground[cell] == RIM));
}

/* The cell a step leads to; false off the blade, or across another vein, or back into the own one. */
static inline bool step_to(const FoundPaths *p, uint32_t cell, uint32_t way, uint32_t owner, uint32_t *to)
{
    *to = cell + (uint32_t)(step_y[way] * (int32_t)p->width + step_x[way]); /* two cells along the grid's sides are never inside */
    return (p->ground[*to] >= RIM || is_blind(p, *to)) && (p->wall[*to] == 0 || (p->wall[*to] == owner + 1 && p->wall[cell] == owner + 1));
}

static inline bool is_free(const FoundPaths *p, uint32_t cell, uint32_t owner) { return p->band[cell] == EVERYBODY || p->band[cell] == owner + 1; }

static inline uint32_t strength(const FoundPaths *p, uint32_t from, uint32_t to, uint32_t way, uint32_t owner)
{
    uint32_t m = way % FOUND_MOVES;
    uint32_t s = ((uint32_t)p->along[(gsize)from * FOUND_MOVES + m] + p->along[(gsize)to * FOUND_MOVES + m]) / 2;
    if (is_blind(p, to))
        return (uint32_t)(255 * (p->ground[to] == HOLE ? over_hole : over_bite));
    if (is_free(p, to, owner))
        return MAX(s, (uint32_t)(255 * leaving));
    return p->band[to] ? MIN(s, (uint32_t)(255 * beside)) : s;
}

static inline float evidence(const FoundPaths *p, uint32_t to, uint32_t way, uint32_t s, uint32_t owner)
{
    if (is_blind(p, to))
        return -(float)over_loss * step_length[kind(way)];
    return is_free(p, to, owner) ? 0.0f : step_length[kind(way)] * ((float)s / 255.0f - p->threshold);
}

static inline void reach(FoundPaths *p, uint32_t from, uint32_t to, uint32_t distance, uint8_t how, float gain, uint32_t unseen)
{
    p->state[to].distance = distance;
    p->state[to].from = how;
    p->state[to].owner = p->state[from].owner;
    p->state[to].unseen = (uint16_t)MIN(unseen, UINT16_MAX);
    p->state[to].gain = gain;
    found_queue_put(&p->queue, distance, to);
}

static void walk(FoundPaths *p, uint32_t state, uint32_t distance)
{
    uint32_t cell = state / WAYS, way = state % WAYS, owner = p->state[state].owner, to;
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t step = (way + k + WAYS - 1) % WAYS;
        if (!step_to(p, cell, step, owner, &to))
            continue;
        uint32_t s = strength(p, cell, to, step, owner), d = distance + p->cost[s][kind(step)], next = to * WAYS + way;
        if (d >= p->state[next].distance)
            continue;
        float e = evidence(p, to, step, s, owner), gain = p->state[state].gain + e;
        float length = UNSEEN * step_length[kind(step)] * (is_blind(p, to) ? (float)blind_share : 1.0f);
        uint32_t unseen = is_free(p, to, owner) || e > 0.0f ? 0 : p->state[state].unseen + (uint32_t)(length + 0.5f);
        bool given_up = !p->anywhere && !(unseen <= p->gap && gain >= p->poorest);
        if (!given_up || p->state[next].distance != FAR)
            reach(p, state, next, d, (uint8_t)k, given_up ? hopeless : gain, unseen);
    }
    for (uint32_t k = 0; k < 2 && !is_blind(p, cell); k++) {
        uint32_t next = cell * WAYS + (way + (k ? WAYS - 1 : 1)) % WAYS, d = distance + p->turn_cost;
        float gain = p->state[state].gain - p->turn_loss;
        bool given_up = !p->anywhere && !(gain >= p->poorest);
        if (d < p->state[next].distance && (!given_up || p->state[next].distance != FAR))
            reach(p, state, next, d, k ? TURNED_RIGHT : TURNED_LEFT, given_up ? hopeless : gain, p->state[state].unseen);
    }
}

/* To the end, or until `goal` is reached: its state, FAR when it isn't. */
static uint32_t run(FoundPaths *p, uint32_t goal)
{
    FoundEntry e;
    uint32_t reached = FAR;
    while (reached == FAR && found_queue_take(&p->queue, &e)) {
        if (p->state[e.value].distance != e.key)
            continue;
        if (e.value / WAYS == goal)
            reached = e.value;
        else
            walk(p, e.value, e.key);
    }
    found_queue_restart(&p->queue);
    return reached;
}

/* The state that a way back leads to: `how` as in FoundPaths.from. Cells off the grid can't be asked for. */
static inline uint32_t came_from(const FoundPaths *p, uint32_t state, uint8_t how)
{
    uint32_t cell = state / WAYS, way = state % WAYS;
    if (how == TURNED_LEFT || how == TURNED_RIGHT)
        return cell * WAYS + (way + (how == TURNED_LEFT ? WAYS - 1 : 1)) % WAYS;
    uint32_t step = (way + how + WAYS - 1) % WAYS;
    return (uint32_t)((int64_t)cell - step_x[step] - (int64_t)step_y[step] * p->width) * WAYS + way;
}

/* --- changes --- */

static inline void lose(FoundPaths *p, GArray *lost, uint32_t state)
{
    p->state[state].distance = FAR;
    g_array_append_val(lost, state);
}

/* Forgets the states of cells marked in `changed`, and what was reached through them, and finds them anew. */
static void renew(FoundPaths *p, const uint8_t *changed)
{
    GArray *lost = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    for (uint32_t c = 0; c < p->width * p->height; c++)
        for (uint32_t k = 0; changed[c] && k < WAYS; k++)
            if (p->state[c * WAYS + k].distance != FAR)
                lose(p, lost, c * WAYS + k);
    for (guint i = 0; i < lost->len; i++) {
        uint32_t state = g_array_index(lost, uint32_t, i), cell = state / WAYS, way = state % WAYS;
        for (uint8_t how = 0; how < SOURCE; how++) {
            uint32_t next;
            if (how >= TURNED_LEFT)
                next = cell * WAYS + (way + (how == TURNED_LEFT ? 1 : WAYS - 1)) % WAYS;
            else {
                uint32_t step = (way + how + WAYS - 1) % WAYS;
                int64_t x = (int64_t)(cell % p->width) + step_x[step], y = (int64_t)(cell / p->width) + step_y[step];
                if (x < 0 || y < 0 || x >= p->width || y >= p->height)
                    continue;
                next = (uint32_t)(y * p->width + x) * WAYS + way;
            }
            if (p->state[next].distance != FAR && p->state[next].from == how)
                lose(p, lost, next);
        }
    }
    for (guint i = 0; i < lost->len; i++) {
        uint32_t state = g_array_index(lost, uint32_t, i), cell = state / WAYS, way = state % WAYS, before;
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t back = (way + k + WAYS / 2 + WAYS - 1) % WAYS;
            int64_t x = (int64_t)(cell % p->width) + step_x[back], y = (int64_t)(cell / p->width) + step_y[back];
            if (x < 0 || y < 0 || x >= p->width || y >= p->height)
                continue;
            before = (uint32_t)(y * p->width + x) * WAYS + way;
            if (p->state[before].distance != FAR)
                found_queue_put(&p->queue, p->state[before].distance, before);
        }
        for (uint32_t k = 0; k < 2; k++) {
            before = cell * WAYS + (way + (k ? WAYS - 1 : 1)) % WAYS;
            if (p->state[before].distance != FAR)
                found_queue_put(&p->queue, p->state[before].distance, before);
        }
    }
    g_array_free(lost, TRUE);
}

static void set_source(FoundPaths *p, uint32_t state, uint32_t id)
{
    p->state[state].distance = 0;
    p->state[state].from = SOURCE;
    p->state[state].owner = (uint16_t)id;
    p->state[state].unseen = 0;
    p->state[state].gain = 0.0f;
    found_queue_put(&p->queue, 0, state);
}

/* Whether a branch may set out in a way from a vein that heads in another: not back along it, and not all but along it. */
static bool may_leave(Vec2 heading, uint32_t way)
{
    Vec2 w = vec2(step_x[way], step_y[way]);
    double n = sqrt(vec_norm2(heading) * vec_norm2(w)), along = vec_dot(heading, w);
    return !(n > 0.0) || (along < 0.97 * n && along > 0.0);
}

static void mark_disc(const FoundPaths *p, uint32_t cell, double r, uint16_t value, uint16_t *in, uint8_t *changed)
{
    int32_t x = (int32_t)(cell % p->width), y = (int32_t)(cell / p->width), n = (int32_t)ceil(r);
    for (int32_t j = MAX(0, y - n); j <= MIN((int32_t)p->height - 1, y + n); j++)
        for (int32_t i = MAX(0, x - n); i <= MIN((int32_t)p->width - 1, x + n); i++) {
            gsize c = (gsize)j * p->width + (gsize)i;
            if ((i - x) * (i - x) + (j - y) * (j - y) <= r * r && in[c] == 0) {
                in[c] = value;
                changed[c] = 1;
            }
        }
}

static uint32_t cell_of(const FoundPaths *p, uint32_t pixel)
{
    return (pixel / p->leaf_width - p->y0) / CELL * p->width + (pixel % p->leaf_width - p->x0) / CELL;
}

void found_paths_add(FoundPaths *p, uint32_t id, const uint32_t *pixel, uint32_t n, double band, uint32_t open_n, uint32_t free_n)
{
    uint8_t *changed = g_new0(uint8_t, (gsize)p->width * p->height);
    for (uint32_t k = 0; k < n; k++) {
        mark_disc(p, cell_of(p, pixel[k]), 1.0, (uint16_t)(id + 1), p->wall, changed);
        mark_disc(p, cell_of(p, pixel[k]), band / CELL, (uint16_t)(id + 1), p->band, changed);
    }
    renew(p, changed);
    for (uint32_t k = 0; k < open_n; k++) {
        uint32_t cell = cell_of(p, pixel[k]), a = cell_of(p, pixel[k >= 4 ? k - 4 : 0]), b = cell_of(p, pixel[MIN(n - 1, k + 4)]);
        Vec2 heading = vec2((double)(b % p->width) - (double)(a % p->width), (double)(b / p->width) - (double)(a / p->width));
        for (uint32_t way = 0; way < WAYS && p->wall[cell] == id + 1 && p->ground[cell] >= RIM; way++)
            if (k < free_n || may_leave(heading, way))
                set_source(p, cell * WAYS + way, id);
    }
    run(p, FAR);
    g_free(changed);
}

/* --- paths --- */

/* Middles of the cells that lead to a state as pixels, its source first. */
static uint32_t *path_to(const FoundPaths *p, uint32_t state, uint32_t *n)
{
    GArray *a = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    uint32_t last = FAR;
    for (;; state = came_from(p, state, p->state[state].from)) {
        uint32_t cell = state / WAYS, pixel = (p->y0 + cell / p->width * CELL + CELL / 2) * p->leaf_width + p->x0 + cell % p->width * CELL + CELL / 2;
        if (cell != last)
            g_array_append_val(a, pixel);
        last = cell;
        if (p->state[state].from == SOURCE)
            break;
    }
    for (guint i = 0, j = a->len - 1; i < j; i++, j--) {
        uint32_t t = g_array_index(a, uint32_t, i);
        g_array_index(a, uint32_t, i) = g_array_index(a, uint32_t, j);
        g_array_index(a, uint32_t, j) = t;
    }
    *n = a->len;
    return (uint32_t *)g_array_free(a, FALSE);
}

static uint32_t nearest_cell(const FoundPaths *p, Vec2 q)
{
    uint32_t best = FAR;
    double least = HUGE_VAL;
    for (uint32_t c = 0; c < p->width * p->height; c++) {
        double d = vec_dist2(q, vec2(p->x0 + (c % p->width + 0.5) * CELL, p->y0 + (c / p->width + 0.5) * CELL));
        if (p->ground[c] >= RIM && d < least) {
            least = d;
            best = c;
        }
    }
    return best;
}

uint32_t *found_paths_between(FoundPaths *p, Vec2 from, Vec2 to, uint32_t *n, double *gain)
{
    uint32_t a = nearest_cell(p, from), b = nearest_cell(p, to), *path = NULL;
    if (a == FAR)
        return NULL;
    for (uint32_t way = 0; way < WAYS; way++)
        set_source(p, a * WAYS + way, 0);
    p->anywhere = true;
    uint32_t end = run(p, b);
    p->anywhere = false;
    *gain = 0.0;
    if (end != FAR) {
        uint32_t best = end;
        float most = -1e9f, so_far;
        for (uint32_t s = end; p->state[s].from != SOURCE; s = came_from(p, s, p->state[s].from)) {
            so_far = p->state[s].gain;
            if (so_far > most) {
                most = so_far;
                best = s;
            }
        }
        *gain = (double)most * CELL;
        path = path_to(p, best, n);
    }
    forget(p);
    return path;
}

uint32_t *found_paths_best(FoundPaths *p, double least, uint32_t *n, uint32_t *id, double *gain)
{
    gsize best = 0;
    float most = (float)(least / CELL);
    bool any = false;
    for (gsize c = 0; c < (gsize)p->width * p->height; c++)
        for (gsize i = c * WAYS; p->ground[c] >= RIM && i < (c + 1) * WAYS; i++)
            if (p->state[i].gain > most && p->state[i].distance != FAR) {
                most = p->state[i].gain;
                best = i;
                any = true;
            }
    if (!any)
        return NULL;
    *gain = (double)most * CELL;
    *id = p->state[best].owner;
    return path_to(p, (uint32_t)best, n);
}
