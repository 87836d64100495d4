/* Veins of a leaf, one by one: the midvein, then what leaves veins already found. */
#include "scan/found.h"

#include <math.h>

#include "scan/found_parts.h"

static const double band_length = 0.008;     /* of the leaf's length, and … */
static const double band_widths = 0.75;      /* … of the vein's width: no other vein runs so near to one */
static const double primary_start = 0.08;    /* of the length: veins that leave a primary so near to the base, and … */
static const double primary_length = 0.22;   /* … are at least so long are primaries */
static const double primary_share = 0.4;     /* … with as much contrast times width, compared with the midvein, */
static const double least_contrast = 2.0, most_contrast = 8.0;  /* over noise, of what may be a vein: at sensitivities 1 and 0 */
static const double long_share = 0.5;        /* of that contrast is enough in veins that run side by side through most of the leaf */
static const double weed_share = 0.33;       /* of the upper quartile of contrast times width in its order: the least prominent vein */
static const double least_gain = 0.022;      /* evidence times length that makes a vein, of the leaf's length */
static const double clear_contrast = 8.0;     /* over noise, the median of secondaries that stand in combs: shorter ones are looked for, … */
static const double short_gain = 0.3;        /* … of so much of that evidence, … */
static const double kin_contrast = 0.6;      /* … and with so much of that contrast */
static const double widens = 1.6;            /* mean width farther on over that so far: no vein does that, … */
static const uint32_t cut_back = 4;          /* … and pixels of its way to that aren't its own … */
static const uint32_t least_run = 16;        /* … seen over so many points to both sides */
static const double least_bite = 0.02;       /* of the leaf's length: a vein that leaves the outline for more ends there and begins anew */
static const uint32_t least_kin = 40, most_dismissed = 60;
enum { MOST_VEINS = 4000 };                  /* with those dismissed; a palmate leaf of many secondaries has a thousand */

FoundDef found_def_default(void) { return (FoundDef){.orders = 2, .sensitivity = 0.5}; }

typedef struct {
    const FoundDef *def;
    uint32_t orders; /* looked for: at least 2, as secondaries must be known lest they pass for primaries */
    FoundLeaf leaf;
    FoundRidges *ridges;
    FoundPaths *paths;
    GArray *vein; /* FoundVein */
    Vec2 base, tip;
    double asked_contrast; /* over noise, of veins, whatever the sensitivity */
} Search;

static Vec2 pixel_at(const Search *s, uint32_t i) { return vec2(i % s->leaf.width + 0.5, i / s->leaf.width + 0.5); }
static FoundVein *vein_at(const Search *s, uint32_t id) { return &g_array_index(s->vein, FoundVein, id); }

static void vein_clear(void *data)
{
    FoundVein *v = data;
    g_free(v->p);
    g_free(v->width);
    g_free(v->pixel);
}

static Vec2 to_working(const Search *s, Vec2 q)
{
    return vec2((q.x - s->ridges->corner.x) / s->ridges->step, (s->ridges->corner.y - q.y) / s->ridges->step);
}

static Vec2 to_scan(const Search *s, Vec2 q)
{
    return vec2(s->ridges->corner.x + q.x * s->ridges->step, s->ridges->corner.y - q.y * s->ridges->step);
}

static double chain_length(const Search *s, const FoundVein *v)
{
    double sum = 0.0;
    for (uint32_t i = 1; i < v->n_pixels; i++)
        sum += vec_dist(pixel_at(s, v->pixel[i - 1]), pixel_at(s, v->pixel[i]));
    return sum;
}

static double mean_width(const FoundVein *v)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < v->n; i++)
        sum += v->width[i];
    return sum / v->n;
}

static double prominence(const FoundVein *v) { return v->contrast * mean_width(v); }

/* Order, and whether it is a vein at all, now that it is measured. The midvein comes first. */
static void settle(const Search *s, FoundVein *v)
{
    if (s->vein->len == 0)
        return;
    const FoundVein *mid = vein_at(s, 0), *parent = vein_at(s, v->parent);
    bool basal = parent->order == 1 && vec_dist(pixel_at(s, v->pixel[0]), s->base) < primary_start * s->leaf.length;
    bool long_enough = chain_length(s, v) > primary_length * s->leaf.length;
    v->order = basal && long_enough && prominence(v) > primary_share * prominence(mid) ? 1 : (uint8_t)(parent->order + 1);
    v->ghost = v->order > s->orders || v->contrast < s->asked_contrast || v->contrast < most_contrast - (most_contrast - least_contrast) * s->def->sensitivity;
}

/* Veins taper. One that goes on far wider has come upon something else, a petiole that lies over the blade: the point where, n when there is none. */
static uint32_t widening(const FoundVein *v)
{
    double all = 0.0, before = 0.0, most = widens, ratio;
    uint32_t at = v->n;
    for (uint32_t i = 0; i < v->n; i++)
        all += v->width[i];
    for (uint32_t i = 0; i + least_run < v->n; i++) {
        if (i >= least_run && (ratio = (all - before) / (v->n - i) * i / before) > most) {
            most = ratio;
            at = i;
        }
        before += v->width[i];
    }
    return at;
}

/* Takes up a vein that was traced. */
static void take_up(Search *s, FoundVein v)
{
    uint32_t id = s->vein->len;
    g_array_append_val(s->vein, v);
    double band = band_length * s->leaf.length + band_widths * mean_width(&v);
    uint32_t near = 0; /* what leaves here may be a primary */
    while (!v.ghost && v.order == 1 && near < v.n_pixels && vec_dist(pixel_at(s, v.pixel[near]), s->base) < primary_start * s->leaf.length)
        near++;
    found_paths_add(s->paths, id, v.pixel, v.n_pixels, band, !v.ghost && v.order < s->orders ? v.n_pixels : near, near);
}

/* Cuts a primary where it widens; *rest is what it went on along. */
static bool cut_wide(const Search *s, FoundVein *v, FoundVein *rest)
{
    uint32_t at = v->ghost || v->order != 1 || s->vein->len == 0 ? v->n : widening(v);
    uint32_t keep = (uint32_t)((uint64_t)at * v->n_pixels / v->n), back = cut_back;
    keep -= MIN(keep, back);
    if (at == v->n || keep < 4 || v->n_pixels - keep < 4)
        return false;
    *rest = (FoundVein){.parent = s->vein->len, .order = (uint8_t)(s->orders + 1), .ghost = true, .n_pixels = v->n_pixels - keep};
    rest->pixel = g_memdup2(v->pixel + keep, rest->n_pixels * sizeof *rest->pixel);
    v->n_pixels = keep;
    g_free(v->p);
    g_free(v->width);
    found_trace(&s->leaf, s->ridges, v);
    found_trace(&s->leaf, s->ridges, rest);
    return true;
}

/* Whether it is a vein. What was cut off keeps others off its place. */
static bool add(Search *s, FoundVein v)
{
    FoundVein rest;
    found_trace(&s->leaf, s->ridges, &v);
    settle(s, &v);
    bool cut = cut_wide(s, &v, &rest);
    take_up(s, v);
    if (cut)
        take_up(s, rest);
    return !v.ghost;
}

/* From the base as far as there is evidence. */
static bool find_midvein(Search *s, double least)
{
    FoundVein v = {.order = 1};
    v.pixel = found_paths_between(s->paths, s->base, s->tip, &v.n_pixels, &v.gain);
    if (!v.pixel)
        return false;
    if (v.gain < least || v.n_pixels < 4) {
        g_free(v.pixel);
        return false;
    }
    add(s, v);
    return true;
}

static int by_value(const void *a, const void *b, void *user)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Until no path is left, or only such as are none, one after the other. */
static void find_others(Search *s, double least)
{
    uint32_t dismissed = 0;
    while (s->vein->len < MOST_VEINS && dismissed < most_dismissed) {
        FoundVein v = {0};
        v.pixel = found_paths_best(s->paths, least, &v.n_pixels, &v.parent, &v.gain);
        if (!v.pixel)
            return;
        dismissed = add(s, v) ? 0 : dismissed + 1;
    }
}

/* The median of the contrasts of secondaries; 0 when they are too few for a comb. */
static double usual_contrast(const Search *s)
{
    double *all = g_new(double, s->vein->len + 1), usual = 0.0;
    uint32_t n = 0;
    for (uint32_t k = 0; k < s->vein->len; k++)
        if (!vein_at(s, k)->ghost && vein_at(s, k)->order == 2)
            all[n++] = vein_at(s, k)->contrast;
    if (n >= least_kin) {
        g_qsort_with_data(all, (gint)n, sizeof *all, by_value, NULL);
        usual = all[n / 2];
    }
    g_free(all);
    return usual;
}

/* In combs of many secondaries, shorter ones as clear as those are veins too: combs taper towards tip and base of each lobe. */
static void find_short(Search *s, double least)
{
    double usual = usual_contrast(s);
    if (usual < clear_contrast)
        return;
    s->asked_contrast = kin_contrast * usual;
    find_others(s, short_gain * least);
}

/* Drops what is far less prominent than most of its order, with what leaves it. */
static void weed(Search *s)
{
    double *all = g_new(double, s->vein->len);
    for (uint32_t order = 2; order <= s->orders; order++) {
        uint32_t n = 0;
        for (uint32_t k = 0; k < s->vein->len; k++)
            if (!vein_at(s, k)->ghost && vein_at(s, k)->order == order)
                all[n++] = prominence(vein_at(s, k));
        g_qsort_with_data(all, (gint)n, sizeof *all, by_value, NULL);
        for (uint32_t k = 1; k < s->vein->len; k++) {
            FoundVein *v = vein_at(s, k);
            v->ghost = v->ghost || vein_at(s, v->parent)->ghost || (v->order == order && prominence(v) < weed_share * all[3 * n / 4]);
        }
    }
    g_free(all);
}

static bool off_leaf(const FoundLeaf *l, Vec2 q)
{
    if (!(q.x >= 0.0 && q.y >= 0.0 && q.x < l->width && q.y < l->height))
        return true;
    gsize i = (gsize)q.y * l->width + (gsize)q.x;
    return !l->inside[i] && !l->hole[i];
}

/* Where a vein leaves the outline that it comes back to, from a point of it on; its last point when it doesn't. *next: from where it goes on. */
static uint32_t next_bite(const Search *s, const FoundVein *v, uint32_t from, uint32_t *next)
{
    *next = v->n;
    for (uint32_t i = from, end; i < v->n; i = end + 1) {
        for (end = i; end < v->n && off_leaf(&s->leaf, v->p[end]); end++)
            ;
        if (i > from && end < v->n && vec_dist(v->p[i - 1], v->p[end]) > least_bite * s->leaf.length) {
            *next = end;
            return i - 1;
        }
    }
    return v->n - 1;
}

/* A vein's points from one to another. */
static void draw_run(const Search *s, const FoundVein *v, uint32_t from, uint32_t to, Drawing *d)
{
    uint32_t n = to + 1 - from;
    Vec2 *p = g_new(Vec2, n);
    double *w = g_new(double, n);
    for (uint32_t i = 0; i < n; i++) {
        p[i] = to_scan(s, v->p[from + i]);
        w[i] = v->width[from + i] * s->ridges->step;
    }
    if (n >= 2)
        drawing_add(d, p, w, n, v->order, NULL);
    g_free(p);
    g_free(w);
}

static Drawing *draw(const Search *s)
{
    Drawing *d = drawing_new();
    for (uint32_t k = 0; k < s->vein->len; k++) {
        FoundVein *v = vein_at(s, k);
        if (v->ghost || v->order > s->def->orders)
            continue;
        for (uint32_t from = 0, to, next; from < v->n; from = next) {
            to = next_bite(s, v, from, &next);
            draw_run(s, v, from, to, d);
        }
    }
    return d;
}

/* Widths and contrasts of veins that are there at once; what isn't clear is none. */
static void measure_all(Search *s)
{
    for (uint32_t k = 0; k < s->vein->len; k++) {
        FoundVein *v = vein_at(s, k);
        found_trace(&s->leaf, s->ridges, v);
        v->ghost = v->contrast < long_share * (most_contrast - (most_contrast - least_contrast) * s->def->sensitivity);
    }
}

/* The midvein and what leaves it, and what leaves that. */
static void find_branching(Search *s, double threshold)
{
    double least = least_gain * s->leaf.length;
    s->paths = found_paths_new(&s->leaf, s->ridges, threshold, s->base);
    if (find_midvein(s, 3.0 * least)) {
        find_others(s, least);
        find_short(s, least);
        found_under(&s->leaf, s->ridges, s->vein);
    }
    weed(s);
    found_hub(&s->leaf, (FoundVein *)(void *)s->vein->data, s->vein->len, s->base);
    found_join((FoundVein *)(void *)s->vein->data, s->vein->len);
}

Drawing *found_veins(const Scan *scan, const Polygon *outline, Vec2 base, Vec2 tip, const FoundDef *def, GError **error)
{
    Search s = {.def = def, .orders = MAX(def->orders, 2)};
    if (!found_def_check(def, error) || !found_leaf_init(&s.leaf, scan, outline, &base, FOUND_SIDE, error))
        return NULL;
    s.ridges = found_ridges_of(&s.leaf, def);
    s.base = to_working(&s, base);
    s.tip = to_working(&s, tip);
    double threshold = 0.75 - 0.5 * def->sensitivity;
    s.vein = g_array_new(FALSE, FALSE, sizeof(FoundVein));
    g_array_set_clear_func(s.vein, vein_clear);
    if (found_parallel(&s.leaf, s.ridges, s.base, s.tip, threshold, s.vein))
        measure_all(&s);
    else
        find_branching(&s, threshold);
    Drawing *d = draw(&s);
    g_array_free(s.vein, TRUE);
    found_paths_free(s.paths);
    found_ridges_free(s.ridges);
    found_leaf_clear(&s.leaf);
    return d;
}
