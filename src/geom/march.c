#include "geom/march.h"

#include <glib.h>

enum { LEFT = 1, TOP = 2, BOTTOM = 3, RIGHT = 4 }; /* edges, in the thesis' numbers */

/* Where the curve that enters a square by an edge leaves it, leaf on its left; 0: no curve enters there. This is the thesis' lineTable
 * with a direction. */
static const uint8_t EXIT[16][5] = {
    [1] = {[LEFT] = TOP},
    [2] = {[BOTTOM] = LEFT},
    [3] = {[BOTTOM] = TOP},
    [4] = {[TOP] = RIGHT},
    [5] = {[LEFT] = RIGHT},
    [6] = {[TOP] = LEFT, [BOTTOM] = RIGHT},
    [7] = {[BOTTOM] = RIGHT},
    [8] = {[RIGHT] = BOTTOM},
    [9] = {[LEFT] = BOTTOM, [RIGHT] = TOP},
    [10] = {[RIGHT] = LEFT},
    [11] = {[RIGHT] = TOP},
    [12] = {[TOP] = BOTTOM},
    [13] = {[LEFT] = BOTTOM},
    [14] = {[TOP] = LEFT},
};

/* Crossings nearer to a corner than this share of a pixel are moved away from it, so that curves stay apart. */
#define LEAST_STEP (1.0 / 1024)

/* Corner (i, j) is the pixel in column i * square and row j * square. Cell (i, j) has it as its top left corner. */
typedef struct {
    const MarchField *f;
    int64_t square, i0, j0, i1, j1; /* corners, last ones included, with a border of background around the leaf */
    uint8_t *visited;               /* a bit for each crossing between a corner and the one below it */
    GArray *points, *starts, *areas;
} Walk;

static inline bool is_leaf(const MarchField *f, int64_t x, int64_t y)
{
    return x >= 0 && y >= 0 && x < f->width && y < f->height && (f->px[(size_t)y * f->width + (size_t)x] & f->test) == f->want;
}

static inline bool corner(const Walk *w, int64_t i, int64_t j) { return is_leaf(w->f, i * w->square, j * w->square); }

static inline uint32_t square_index(const Walk *w, int64_t i, int64_t j)
{
    return (uint32_t)corner(w, i, j) + 2u * corner(w, i, j + 1) + 4u * corner(w, i + 1, j) + 8u * corner(w, i + 1, j + 1);
}

/* Level of a pixel, or NaN beyond the image. */
static double level_at(const MarchField *f, int64_t x, int64_t y)
{
    return x >= 0 && y >= 0 && x < f->width && y < f->height ? f->level(f->user, (uint32_t)x, (uint32_t)y) : (double)NAN;
}

/* How far from the leaf pixel (x, y), whose neighbour (x + dx, y + dy) is not leaf, the boundary lies. Halfway where the levels don't part the two:
 * at the image's border, and where the mask was not made by the threshold alone. */
static double step_to_threshold(const MarchField *f, int64_t x, int64_t y, int64_t dx, int64_t dy)
{
    double in = level_at(f, x, y) - f->threshold, out = level_at(f, x + dx, y + dy) - f->threshold;
    double t = in * out <= 0.0 && in != out ? in / (in - out) : 0.5;
    return t < LEAST_STEP ? LEAST_STEP : t > 1.0 - LEAST_STEP ? 1.0 - LEAST_STEP : t;
}

/* The crossing between two neighbouring corners as a distance in pixels from the leaf one, pixel (x, y), in direction (dx, dy). */
static double crossing(const Walk *w, int64_t x, int64_t y, int64_t dx, int64_t dy)
{
    const MarchField *f = w->f;
    if (f->level) {
        int64_t k = 0;
        while (k + 1 < w->square && is_leaf(f, x + (k + 1) * dx, y + (k + 1) * dy))
            k++;
        return (double)k + step_to_threshold(f, x + k * dx, y + k * dy, dx, dy);
    }
    int64_t room = dx > 0 ? f->width - 1 - x : dx < 0 ? x : dy > 0 ? f->height - 1 - y : y;
    double half = 0.5 * (double)w->square, border = (double)room + 0.5;
    return half < border ? half : border;
}

/* The point on an edge between corners (i, j) and (i + 1, j) or (i, j + 1). */
static Vec2 edge_point(const Walk *w, int64_t i, int64_t j, bool down)
{
    int64_t x = i * w->square, y = j * w->square, dx = !down, dy = down;
    double at = 0.0;
    if (corner(w, i, j))
        at = crossing(w, x, y, dx, dy);
    else
        at = (double)w->square - crossing(w, x + dx * w->square, y + dy * w->square, -dx, -dy);
    return vec2((double)x + 0.5 + (double)dx * at, (double)w->f->height - ((double)y + 0.5 + (double)dy * at));
}

static size_t crossing_bit(const Walk *w, int64_t i, int64_t j) { return (size_t)((j - w->j0) * (w->i1 - w->i0 + 1) + (i - w->i0)); }

static bool visit(Walk *w, int64_t i, int64_t j)
{
    size_t bit = crossing_bit(w, i, j);
    uint8_t mask = (uint8_t)(1u << (bit & 7));
    bool was = w->visited[bit >> 3] & mask;
    w->visited[bit >> 3] |= mask;
    return was;
}

/* Follows the curve that crosses the edge between corner (i, j) and the one below it, until it is back there. */
static void follow(Walk *w, int64_t i, int64_t j)
{
    guint start = w->points->len;
    uint32_t side = LEFT;     /* by which the cell is entered */
    if (!corner(w, i, j)) { /* leaf below: with leaf on the left the curve runs to the left */
        i--;
        side = RIGHT;
    }
    for (;;) {
        if ((side == LEFT || side == RIGHT) && visit(w, side == LEFT ? i : i + 1, j))
            break;
        Vec2 p = edge_point(w, side == RIGHT ? i + 1 : i, side == BOTTOM ? j + 1 : j, side == LEFT || side == RIGHT);
        g_array_append_val(w->points, p);
        uint32_t out = EXIT[square_index(w, i, j)][side];
        g_assert(out != 0);
        i += out == LEFT ? -1 : out == RIGHT;
        j += out == TOP ? -1 : out == BOTTOM;
        side = 5 - out; /* the same edge seen from the next cell */
    }
    const Vec2 *p = &g_array_index(w->points, Vec2, start);
    double twice = 0.0;
    for (guint k = 1; k + 1 < w->points->len - start; k++)
        twice += vec_cross(vec_sub(p[k], p[0]), vec_sub(p[k + 1], p[0]));
    double area = 0.5 * twice;
    g_array_append_val(w->areas, area);
    uint32_t end = w->points->len;
    g_array_append_val(w->starts, end);
}

/* The square runs over the leaf's box line by line, as in fig. 5.5, and walks off along each curve it meets for the first time. */
static void scan_lines(Walk *w)
{
    for (int64_t j = w->j0; j < w->j1; j++)
        for (int64_t i = w->i0; i <= w->i1; i++) {
            size_t bit = crossing_bit(w, i, j);
            if (corner(w, i, j) != corner(w, i, j + 1) && !(w->visited[bit >> 3] & 1u << (bit & 7)))
                follow(w, i, j);
        }
}

MarchLoops *march_loops(const MarchField *f, uint32_t square)
{
    g_assert(square >= 1);
    int64_t s = square;
    Walk w = {.f = f, .square = s, .i0 = f->x0 / s - 1, .j0 = f->y0 / s - 1, .i1 = f->x1 / s + 1, .j1 = f->y1 / s + 1};
    uint32_t zero = 0;
    w.visited = g_malloc0((size_t)((w.i1 - w.i0 + 1) * (w.j1 - w.j0 + 1)) / 8 + 1);
    w.points = g_array_new(FALSE, FALSE, sizeof(Vec2));
    w.starts = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    w.areas = g_array_new(FALSE, FALSE, sizeof(double));
    g_array_append_val(w.starts, zero);
    scan_lines(&w);
    g_free(w.visited);
    MarchLoops *l = g_new0(MarchLoops, 1);
    l->n = w.areas->len;
    l->start = (uint32_t *)(void *)g_array_free(w.starts, FALSE);
    l->area = (double *)(void *)g_array_free(w.areas, FALSE);
    l->p = (Vec2 *)(void *)g_array_free(w.points, FALSE);
    return l;
}

void march_loops_free(MarchLoops *l)
{
    if (!l)
        return;
    g_free(l->start);
    g_free(l->area);
    g_free(l->p);
    g_free(l);
}

uint32_t march_largest(const MarchLoops *l)
{
    uint32_t best = l->n;
    for (uint32_t k = 0; k < l->n; k++)
        if (l->area[k] > 0.0 && (best == l->n || l->area[k] > l->area[best]))
            best = k;
    return best;
}
