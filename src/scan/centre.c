/* From the graph of thinned pixels to veins: their lines put in the middle, smoothed, lengthened and simplified. */
#include "scan/centre.h"

#include "geom/simplify.h"
#include "scan/centre_private.h"

CentreDef centre_def_default(void) { return (CentreDef){.hole = 12.0, .spur = 1.0, .tolerance = 0.75, .least = 8.0}; }

/* ---- one vein ---- */

typedef struct {
    Vec2 p;
    double r;
    uint32_t node; /* a junction; CENTRE_NONE else */
} Station;

typedef struct {
    const Thinned *t;
    const CentreGraph *g;
    const CentreDef *def;
    uint32_t *partner;
    bool *used;     /* [edges] */
    GArray *line;   /* Station: of all veins, one after the other */
    GArray *start;  /* uint32_t: where each begins, and where the last ends */
    GArray *scratch; /* CentrePoint */
    Vec2 *place;    /* [nodes] sum of where lines pass through a junction, then where it is */
    uint32_t *passes;
} Veins;

static Station *station(const Veins *v, uint32_t i) { return &g_array_index(v->line, Station, i); }

static void add_station(Veins *v, Vec2 p, double r, uint32_t node)
{
    Station s = {p, r, node};
    g_array_append_val(v->line, s);
}

static void add_node(Veins *v, uint32_t i)
{
    const CentreNode *node = centre_node(v->g, i);
    add_station(v, node->p, node->r, node->degree > 2 ? i : CENTRE_NONE);
}

/* All edges from a half on, as far as they are joined. */
static void gather(Veins *v, uint32_t half)
{
    g_array_append_val(v->start, v->line->len);
    add_node(v, centre_half_node(v->g, half));
    do {
        for (uint32_t k = 0; k < centre_edge(v->g, half / 2)->n; k++)
            add_station(v, centre_half_point(v->g, half, k)->p, centre_half_point(v->g, half, k)->r, CENTRE_NONE);
        add_node(v, centre_half_node(v->g, half ^ 1));
        v->used[half / 2] = true;
        half = v->partner[half ^ 1];
    } while (half != CENTRE_NONE && !v->used[half / 2]);
}

/* How far the region reaches from p along the unit vector u, at least `from`, at most `to`, in quarters of a pixel. */
static double reach(const Thinned *t, Vec2 p, Vec2 u, double from, double to)
{
    double d = fmax(from, 0.0);
    while (d < to && thinned_has(t, vec_add(p, vec_scale(u, d + 0.25))))
        d += 0.25;
    return fmin(d, to);
}

/* Thinned pixels lie up to half a pixel beside the middle, and their distance to the nearer side is less than half the width: measures to both
 * sides, across the line as it runs over some pixels. Neither side is more than about a pixel farther than the nearest. */
static void centre_stations(Veins *v, uint32_t first, uint32_t end)
{
    GArray *moved = v->scratch;
    g_array_set_size(moved, 0);
    for (uint32_t i = first; i < end; i++) {
        const Station *s = station(v, i);
        CentrePoint c = {s->p, s->r};
        uint32_t k = 2 + (uint32_t)(0.5 * s->r), a = i - first > k ? i - k : first, b = end - 1 - i > k ? i + k : end - 1;
        Vec2 d = vec_sub(station(v, b)->p, station(v, a)->p);
        double length = sqrt(vec_norm2(d));
        if (s->node == CENTRE_NONE && length > 0.0) {
            Vec2 across = vec2(-d.y / length, d.x / length);
            double from = s->r - 1.125, to = s->r + 1.5, left = reach(v->t, s->p, across, from, to);
            double right = reach(v->t, s->p, vec_scale(across, -1.0), from, to);
            c.p = vec_add(s->p, vec_scale(across, 0.5 * (left - right)));
            c.r = 0.5 * (left + right) + 0.125; /* half a step */
        }
        g_array_append_val(moved, c);
    }
    for (uint32_t i = first; i < end; i++) {
        station(v, i)->p = g_array_index(moved, CentrePoint, i - first).p;
        station(v, i)->r = g_array_index(moved, CentrePoint, i - first).r;
    }
}

/* Drops stations inside a junction's disc, where the middle of the region isn't the middle of the vein. Returns the new end. A line all in such
 * discs keeps its narrowest radius at its nodes. */
static uint32_t clear_junctions(Veins *v, uint32_t first, uint32_t end)
{
    bool *drop = g_new0(bool, end - first + 1);
    for (uint32_t i = first; i < end; i++) {
        const Station *s = station(v, i);
        if (s->node == CENTRE_NONE)
            continue;
        const CentreNode *node = centre_node(v->g, s->node);
        for (uint32_t k = i + 1; k < end && station(v, k)->node == CENTRE_NONE && vec_dist(station(v, k)->p, node->p) <= node->r; k++)
            drop[k - first] = true;
        for (uint32_t k = i; k-- > first && station(v, k)->node == CENTRE_NONE && vec_dist(station(v, k)->p, node->p) <= node->r;)
            drop[k - first] = true;
    }
    drop[0] = drop[end - 1 - first] = false; /* ends close to a junction */
    double least = HUGE_VAL;
    uint32_t n = first;
    bool only = true;
    for (uint32_t i = first; i < end; i++) {
        least = fmin(least, station(v, i)->r);
        if (drop[i - first])
            continue;
        only &= station(v, i)->node != CENTRE_NONE;
        *station(v, n++) = *station(v, i);
    }
    for (uint32_t i = first; only && i < n; i++)
        station(v, i)->r = least;
    g_free(drop);
    return n;
}

/* Means over windows about as long as the line is wide, narrower towards the ends a … b - 1, which stay. */
static void smooth_run(Veins *v, uint32_t a, uint32_t b)
{
    g_array_set_size(v->scratch, 0);
    CentrePoint sum = {{0.0, 0.0}, 0.0};
    g_array_append_val(v->scratch, sum); /* of all before */
    for (uint32_t i = a; i < b; i++) {
        sum = (CentrePoint){vec_add(sum.p, station(v, i)->p), sum.r + station(v, i)->r};
        g_array_append_val(v->scratch, sum);
    }
    for (uint32_t i = a; i < b; i++) {
        uint32_t most = 3 + (uint32_t)fmin(station(v, i)->r, 20.0), k = MIN(most, MIN(i - a, b - 1 - i));
        CentrePoint low = g_array_index(v->scratch, CentrePoint, i - k - a), high = g_array_index(v->scratch, CentrePoint, i + k + 1 - a);
        double share = 1.0 / (2.0 * k + 1.0);
        station(v, i)->p = vec_scale(vec_sub(high.p, low.p), share);
        station(v, i)->r = (high.r - low.r) * share;
    }
}

/* Smooths between junctions. There the first and last stations, which have little to be smoothed by, go. Returns the new end. */
static uint32_t smooth(Veins *v, uint32_t first, uint32_t end)
{
    enum { ROUGH = 3 };
    uint32_t n = first;
    for (uint32_t i = first; i < end;) {
        uint32_t a = i;
        while (i < end && station(v, i)->node == CENTRE_NONE)
            i++;
        if (i == a) {
            *station(v, n++) = *station(v, i++);
            continue;
        }
        smooth_run(v, a, i);
        uint32_t skip = MIN(ROUGH, (i - a) / 4);
        for (uint32_t k = a + skip; k < i - skip; k++)
            *station(v, n++) = *station(v, k);
    }
    return n;
}

/* How many stations at a free end are of a bend into a corner of it, or anyway no longer than a spur would be. */
static uint32_t loose(const Veins *v, uint32_t end, int inward, uint32_t n)
{
    double length = station(v, end)->r;
    uint32_t i = end;
    for (uint32_t k = 1; k + 1 < n; k++) {
        uint32_t next = (uint32_t)((int64_t)end + inward * (int64_t)k);
        length += vec_dist(station(v, i)->p, station(v, next)->p);
        if (station(v, next)->node != CENTRE_NONE || !(length < v->def->spur * 2.0 * station(v, next)->r))
            return k - 1;
        i = next;
    }
    return 0; /* all of it: too short to tell */
}

/* A free end goes on to the region's border: thinning stops about half a width before it, smoothing and loose ends some more. */
static Station lengthened(const Veins *v, uint32_t end, int inward, uint32_t n)
{
    const Station *s = station(v, end);
    double back = fmax(3.0 * s->r, 4.0);
    Vec2 from = s->p;
    for (uint32_t k = 1; k < n && vec_dist(from, s->p) < back; k++) {
        const Station *q = station(v, (uint32_t)((int64_t)end + inward * (int64_t)k));
        if (q->node == CENTRE_NONE || k + 1 == n)
            from = q->p; /* a junction's place isn't known yet */
    }
    Vec2 d = vec_sub(s->p, from);
    double length = sqrt(vec_norm2(d)), most = 3.0 * s->r + 5.0;
    if (!(length > 0.0))
        return *s;
    d = vec_scale(d, 1.0 / length);
    return (Station){vec_add(s->p, vec_scale(d, reach(v->t, s->p, d, 0.125, most))), s->r, CENTRE_NONE};
}

static bool is_free(const Veins *v, uint32_t half) { return centre_node(v->g, centre_half_node(v->g, half))->degree == 1; }

/* The nearest station before or after i that is no junction; NULL when there is none. */
static const Station *beside(const Veins *v, uint32_t i, int way, uint32_t first, uint32_t end)
{
    for (int64_t k = (int64_t)i + way; k >= first && k < end; k += way)
        if (station(v, (uint32_t)k)->node == CENTRE_NONE)
            return station(v, (uint32_t)k);
    return NULL;
}

/* Where lines pass straight through a junction, or several whose discs touch, it is on the chord over them; its radius there, and where a line
 * begins, is that of the line beside it. */
static void pass_junctions(Veins *v, uint32_t first, uint32_t end)
{
    for (uint32_t i = first; i < end; i++) {
        Station *s = station(v, i);
        if (s->node == CENTRE_NONE)
            continue;
        const Station *a = beside(v, i, -1, first, end), *b = beside(v, i, 1, first, end);
        if (a && b) {
            Vec2 d = vec_sub(b->p, a->p);
            double l2 = vec_norm2(d), t = l2 > 0.0 ? fmin(fmax(vec_dot(vec_sub(s->p, a->p), d) / l2, 0.0), 1.0) : 0.5;
            v->place[s->node] = vec_add(v->place[s->node], vec_lerp(a->p, b->p, t));
            v->passes[s->node]++;
            s->r = a->r + (b->r - a->r) * t;
        } else if (a || b) {
            s->r = a ? a->r : b->r;
        }
    }
}

/* Of the last line. */
static void free_ends(Veins *v, uint32_t first, bool at_start, bool at_end)
{
    uint32_t n = v->line->len - first, before = at_start ? loose(v, first, 1, n) : 0, after = at_end ? loose(v, first + n - 1, -1, n) : 0;
    if (before + after + 2 > n)
        before = after = 0;
    g_array_set_size(v->line, first + n - after);
    g_array_remove_range(v->line, first, before);
    n -= before + after;
    Station start = *station(v, first), stop = *station(v, first + n - 1);
    if (at_start)
        start = lengthened(v, first, 1, n);
    if (at_end)
        stop = lengthened(v, first + n - 1, -1, n);
    if (at_start)
        g_array_insert_val(v->line, first, start);
    if (at_end)
        g_array_append_val(v->line, stop);
}

/* One vein, from a half that nothing comes before, or that is part of a ring. */
static void trace(Veins *v, uint32_t half)
{
    uint32_t first = v->line->len;
    gather(v, half);
    uint32_t end = v->line->len;
    bool at_start = is_free(v, half), ring;
    uint32_t last = half;
    for (uint32_t next; (next = v->partner[last ^ 1]) != CENTRE_NONE && next != half;)
        last = next;
    ring = v->partner[last ^ 1] == half;
    bool at_end = !ring && is_free(v, last ^ 1);
    centre_stations(v, first, end);
    end = clear_junctions(v, first, end);
    end = smooth(v, first, end);
    g_array_set_size(v->line, end);
    if (ring && station(v, first)->node == CENTRE_NONE)
        *station(v, end - 1) = *station(v, first);
    pass_junctions(v, first, end);
    free_ends(v, first, at_start, at_end);
}

/* ---- the drawing ---- */

/* Which stations say something: of the line, or of how its width changes along it. */
static void mark_kept(const Vec2 *p, const double *width, uint32_t n, double tolerance, bool *must)
{
    uint32_t *keep = g_new(uint32_t, n), kept = simplify_polyline(p, n, tolerance, must, keep);
    for (uint32_t k = 0; k < kept; k++)
        must[keep[k]] = true;
    Vec2 *profile = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++)
        profile[i] = vec2(i ? profile[i - 1].x + vec_dist(p[i], p[i - 1]) : 0.0, 0.5 * width[i]);
    kept = simplify_polyline(profile, n, tolerance, must, keep);
    for (uint32_t k = 0; k < kept; k++)
        must[keep[k]] = true;
    g_free(profile);
    g_free(keep);
}

static void draw(const Veins *v, uint32_t first, uint32_t end, double height, Drawing *out)
{
    uint32_t n = 0, kept = 0;
    Vec2 *p = g_new(Vec2, end - first);
    double *width = g_new(double, end - first);
    bool *must = g_new0(bool, end - first);
    for (uint32_t i = first; i < end; i++) {
        const Station *s = station(v, i);
        Vec2 at = s->node == CENTRE_NONE ? s->p : v->place[s->node];
        at = vec2(v->t->box.x0 + at.x + 0.5, height - (v->t->box.y0 + at.y + 0.5));
        if (n > 0 && at.x == p[n - 1].x && at.y == p[n - 1].y) {
            must[n - 1] |= s->node != CENTRE_NONE;
            continue;
        }
        p[n] = at;
        width[n] = fmax(2.0 * s->r, 0.25);
        must[n++] = s->node != CENTRE_NONE;
    }
    if (n > 1)
        mark_kept(p, width, n, v->def->tolerance, must);
    for (uint32_t i = 0; i < n; i++)
        if (must[i]) {
            p[kept] = p[i];
            width[kept++] = width[i];
        }
    if (kept > 1)
        drawing_add(out, p, width, kept, 0, NULL);
    g_free(p);
    g_free(width);
    g_free(must);
}

static void place_junctions(Veins *v)
{
    for (uint32_t i = 0; i < v->g->node->len; i++)
        v->place[i] = v->passes[i] ? vec_scale(v->place[i], 1.0 / v->passes[i]) : centre_node(v->g, i)->p;
}

static void draw_all(const Thinned *t, const CentreGraph *g, const CentreDef *def, double height, Drawing *out)
{
    Veins v = {.t = t, .g = g, .def = def, .partner = centre_join(g), .used = g_new0(bool, g->edge->len + 1)};
    v.line = g_array_new(FALSE, FALSE, sizeof(Station));
    v.start = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    v.scratch = g_array_new(FALSE, FALSE, sizeof(CentrePoint));
    v.place = g_new0(Vec2, g->node->len + 1);
    v.passes = g_new0(uint32_t, g->node->len + 1);
    for (uint32_t rings = 0; rings < 2; rings++)
        for (uint32_t h = 0; h < 2 * g->edge->len; h++)
            if (!centre_edge(g, h / 2)->gone && !v.used[h / 2] && (rings || v.partner[h] == CENTRE_NONE))
                trace(&v, h);
    g_array_append_val(v.start, v.line->len);
    place_junctions(&v);
    for (guint i = 0; i + 1 < v.start->len; i++)
        draw(&v, g_array_index(v.start, uint32_t, i), g_array_index(v.start, uint32_t, i + 1), height, out);
    g_array_free(v.line, TRUE);
    g_array_free(v.start, TRUE);
    g_array_free(v.scratch, TRUE);
    g_free(v.partner);
    g_free(v.used);
    g_free(v.place);
    g_free(v.passes);
}

Drawing *centre_lines(const Mask *m, uint8_t bit, const CentreDef *def)
{
    Drawing *out = drawing_new();
    Thinned t;
    if (thinned_init(&t, m, bit, def->hole)) {
        CentreGraph g;
        centre_graph_init(&g, &t);
        centre_graph_prune(&g, def);
        draw_all(&t, &g, def, m->height, out);
        centre_graph_clear(&g);
    }
    thinned_clear(&t);
    return out;
}
