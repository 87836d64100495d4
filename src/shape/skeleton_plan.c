#include "shape/skeleton_plan.h"

/* ---- where primaries begin ---- */

/* Where the segment from outside to inside enters the polygon last. */
static Vec2 entry(const Polygon *p, Vec2 outside, Vec2 inside)
{
    double last = 0.0;
    Vec2 d = vec_sub(inside, outside);
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 a = p->v[i], e = vec_sub(p->v[i + 1 < p->n ? i + 1 : 0], a);
        double k = vec_cross(d, e);
        if (k == 0.0)
            continue;
        double t = vec_cross(vec_sub(a, outside), e) / k, s = vec_cross(vec_sub(a, outside), d) / k;
        if (s >= 0.0 && s <= 1.0 && t > last && t <= 1.0)
            last = t;
    }
    return vec_lerp(outside, inside, last);
}

/* A vein that begins near the margin begins on it; one that begins outside, where it comes in. */
static Root find_root(const Polygon *margin, const Vec2 *p, uint32_t n, double clear)
{
    uint32_t edge, from = 1;
    Vec2 near = outline_nearest(margin, p[0], &edge);
    double d = vec_dist(near, p[0]);
    if (d < clear)
        return (Root){.at = d < 1e-9 * clear ? p[0] : near, .from = 1, .on_margin = true}; /* on it but for rounding: as it is */
    if (polygon_contains(margin, p[0]))
        return (Root){.at = p[0], .from = 1};
    while (from < n && !polygon_contains(margin, p[from]))
        from++;
    if (from == n)
        return (Root){.outside = true};
    near = outline_nearest(margin, entry(margin, p[from - 1], p[from]), &edge);
    return (Root){.at = near, .from = from, .on_margin = true};
}

/* ---- importance ---- */

typedef struct {
    double length;
    uint32_t order, trail;
} Importance;

static gint by_importance(gconstpointer a, gconstpointer b, gpointer user)
{
    const Importance *s = a, *t = b;
    if (s->order != t->order)
        return s->order < t->order ? -1 : 1;
    if (s->length != t->length)
        return s->length > t->length ? -1 : 1;
    return (s->trail > t->trail) - (s->trail < t->trail);
}

/* Lower orders first, of one order the longer ones; but none is more important than its parent. */
static uint32_t *rank_trails(const Trails *trails)
{
    Importance *key = g_new(Importance, trails->n);
    for (uint32_t i = 0; i < trails->n; i++) {
        const Trail *t = &trails->trail[i];
        key[i] = (Importance){t->length, t->order, i};
        if (t->parent == NONE)
            continue;
        const Importance *parent = &key[t->parent];
        if (parent->order > t->order || (parent->order == t->order && parent->length < t->length)) {
            key[i].order = parent->order;
            key[i].length = MIN(t->length, parent->length);
        }
    }
    g_qsort_with_data(key, (gint)trails->n, sizeof *key, by_importance, NULL);
    uint32_t *rank = g_new(uint32_t, trails->n);
    for (uint32_t i = 0; i < trails->n; i++)
        rank[i] = key[i].trail;
    g_free(key);
    return rank;
}

/* ---- the plan ---- */

static uint32_t count_points(const Trails *t) { return t->n ? t->trail[t->n - 1].first + t->trail[t->n - 1].n : 0; }

void plan_init(Plan *p, const Trails *trails, const Polygon *margin, const Limits *limits)
{
    *p = (Plan){.trails = trails, .merge = limits->clear};
    p->rank = rank_trails(trails);
    p->root = g_new0(Root, trails->n);
    p->wanted = g_new(bool, trails->n);
    p->host = g_new(uint32_t, trails->n);
    p->leaf = g_new(uint32_t, trails->n);
    p->must = g_new0(bool, count_points(trails));
    for (uint32_t i = 0; i < trails->n; i++) {
        const Trail *t = &trails->trail[i];
        p->wanted[i] = true;
        p->host[i] = t->parent;
        p->leaf[i] = t->leaves;
        if (t->parent == NONE)
            p->root[i] = find_root(margin, trails->point + t->first, t->n, limits->clear);
    }
}

void plan_clear(Plan *p)
{
    g_free(p->rank);
    g_free(p->root);
    g_free(p->wanted);
    g_free(p->host);
    g_free(p->leaf);
    g_free(p->must);
}

/* Whether a branch node stands nearer than `merge` along the trail, its ends included. */
static bool crowded(const Plan *p, const Trail *t, uint32_t at)
{
    const double *along = p->trails->along + t->first;
    const bool *must = p->must + t->first;
    if (along[at] < p->merge || along[t->n - 1] - along[at] < p->merge)
        return true;
    for (uint32_t i = at; along[at] - along[i] < p->merge; i--)
        if (must[i])
            return true;
    for (uint32_t i = at; along[i] - along[at] < p->merge; i++)
        if (must[i])
            return true;
    return false;
}

void plan_branches(Plan *p)
{
    for (uint32_t i = 0; i < count_points(p->trails); i++)
        p->must[i] = false;
    for (uint32_t k = 0; k < p->trails->n; k++) {
        uint32_t i = p->rank[k];
        if (!p->wanted[i] || p->host[i] == NONE)
            continue;
        const Trail *host = &p->trails->trail[p->host[i]];
        const double *along = p->trails->along + host->first;
        if (!crowded(p, host, p->leaf[i]))
            p->must[host->first + p->leaf[i]] = true;
        else if (along[host->n - 1] - along[p->leaf[i]] < p->merge) /* it will leave from the tip */
            p->must[host->first + host->n - 1] = true;
    }
}

static bool stands_near(const GArray *at, Vec2 p, double reach)
{
    for (uint32_t i = 0; i < at->len; i++)
        if (vec_dist2(g_array_index(at, Vec2, i), p) < reach * reach)
            return true;
    return false;
}

GArray *plan_roots(const Plan *p, Vec2 *base)
{
    GArray *at = g_array_new(FALSE, FALSE, sizeof(Vec2));
    bool first = true;
    for (uint32_t k = 0; k < p->trails->n; k++) {
        const Root *r = &p->root[p->rank[k]];
        if (!p->wanted[p->rank[k]] || p->trails->trail[p->rank[k]].parent != NONE || r->outside)
            continue;
        if (first)
            *base = r->at;
        if (r->on_margin && !stands_near(at, r->at, p->merge))
            g_array_append_val(at, r->at);
        first = false;
    }
    return at;
}

void plan_learn(Plan *p, const GArray *cleared)
{
    for (uint32_t i = 0; i < p->trails->n; i++)
        p->wanted[i] = false;
    for (uint32_t k = 0; k < cleared->len; k++) {
        const Cleared *c = &g_array_index(cleared, Cleared, k);
        p->wanted[c->trail] = true;
        p->host[c->trail] = NONE;
        if (c->parent == NONE)
            continue;
        const Cleared *host = &g_array_index(cleared, Cleared, c->parent);
        const Trail *h = &p->trails->trail[host->trail];
        double along = 0.0;
        for (uint32_t i = 0; i < host->knot->len; i++)
            if (g_array_index(host->knot, Knot, i).node == g_array_index(c->knot, Knot, 0).node)
                along = g_array_index(host->knot, Knot, i).along;
        uint32_t leaf = 0;
        while (leaf + 1 < h->n && p->trails->along[h->first + leaf] < along)
            leaf++;
        p->host[c->trail] = host->trail;
        p->leaf[c->trail] = leaf;
    }
}
