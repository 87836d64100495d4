#include "shape/rig.h"

#include <string.h>

G_DEFINE_QUARK(venation-rig-error-quark, rig_error)

#define LEAST_WEIGHT 1e-6 /* smaller weights move nothing that can be seen: 1 µm for a joint a metre away */

/* The joints that hold a node of the skeleton, with their weights; where one is enough both are the same and the second weighs 0. */
typedef struct {
    uint32_t joint[2];
    double weight[2];
} Hat;

typedef struct {
    const Skeleton *s;
    uint32_t per_sequence;
    uint32_t *owner;   /* [n_nodes] the first sequence that has the node */
    uint32_t *joint;   /* [n_nodes] the joint that the node's owner has there, or NO_PARENT */
    uint8_t *forks;    /* [n_nodes] another sequence than the owner begins there */
    Hat *hat;          /* [n_nodes] */
    double spacing;    /* of joints along sequences of median length */
    double *arc;       /* [longest sequence] arc length from the sequence's first node */
    bool *chosen;      /* [longest sequence] has a joint */
    GArray *joints;
} Builder;

static int by_length(const void *a, const void *b, void *user)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double median_length(const Skeleton *s)
{
    double *length = g_new(double, (gsize)s->n_sequences + 1);
    for (uint32_t q = 0; q < s->n_sequences; q++)
        length[q] = s->sequence[q].length;
    g_qsort_with_data(length, (int)s->n_sequences, sizeof *length, by_length, NULL);
    double median = length[s->n_sequences / 2];
    g_free(length);
    return median;
}

static void find_owners(Builder *b)
{
    const Skeleton *s = b->s;
    for (uint32_t i = 0; i < s->n_nodes; i++)
        b->owner[i] = b->joint[i] = NO_PARENT;
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        const uint32_t *at = s->at + s->sequence[q].first;
        for (uint32_t i = 0; i < s->sequence[q].n; i++)
            if (b->owner[at[i]] == NO_PARENT)
                b->owner[at[i]] = q;
            else
                b->forks[at[i]] = 1;
    }
}

/* Joints between nodes `from` and `to` of a sequence, which have joints: as many as keep to the spacing, each at the node nearest to its
 * even share of the way. */
static void choose_between(Builder *b, uint32_t from, uint32_t to, double spacing)
{
    double way = b->arc[to] - b->arc[from];
    uint32_t parts = to - from;
    if (spacing > 0.0 && way / spacing < parts)
        parts = (uint32_t)ceil(way / spacing - 1e-9);
    uint32_t at = from;
    for (uint32_t k = 1; k < parts; k++) {
        double mark = b->arc[from] + way * k / parts;
        uint32_t last = to - (parts - k); /* leaves a node for each that follows */
        at++;
        while (at < last && fabs(b->arc[at + 1] - mark) < fabs(b->arc[at] - mark))
            at++;
        b->chosen[at] = true;
    }
}

/* The ends have joints, so has every node where another sequence leaves, else its veins would come apart when this one bends; and between
 * those as many as keep the joints of a sequence at most 1 / (per_sequence + 1) of its length, or of the median length, apart. */
static void choose(Builder *b, uint32_t q)
{
    const Sequence *v = &b->s->sequence[q];
    const uint32_t *at = b->s->at + v->first;
    b->arc[0] = 0.0;
    for (uint32_t i = 0; i < v->n; i++) {
        if (i > 0)
            b->arc[i] = b->arc[i - 1] + vec_dist(b->s->rest[at[i]], b->s->rest[at[i - 1]]);
        b->chosen[i] = i == 0 || i == v->n - 1 || (b->forks[at[i]] && b->owner[at[i]] == q);
    }
    double length = b->arc[v->n - 1], spacing = (length < b->spacing ? length : b->spacing) / (b->per_sequence + 1);
    for (uint32_t from = 0, i = 1; i < v->n; i++)
        if (b->chosen[i]) {
            if (b->per_sequence > 0)
                choose_between(b, from, i, spacing);
            from = i;
        }
}

/* A joint at node i of sequence q. A sequence's first joint hangs on the joint of the vein it leaves. */
static void add_joint(Builder *b, uint32_t q, uint32_t i, uint32_t number)
{
    const Sequence *v = &b->s->sequence[q];
    uint32_t node = b->s->at[v->first + i], index = b->joints->len;
    bool own = b->owner[node] == q;
    Joint j = {.node = node, .parent = number > 0 ? index - 1 : own ? NO_PARENT : b->joint[node], .place = vec3_flat(b->s->rest[node])};
    g_snprintf(j.name, sizeof j.name, "%s_%u", v->name, number);
    if (own)
        b->joint[node] = index;
    g_array_append_val(b->joints, j);
}

/* Hats along a sequence: a node's weights are shared by the two joints between which it lies. A node that another sequence owns is left to
 * the joint there, of which this sequence's first joint is a child in the same place. */
static void add_sequence(Builder *b, uint32_t q)
{
    const Sequence *v = &b->s->sequence[q];
    const uint32_t *at = b->s->at + v->first;
    choose(b, q);
    for (uint32_t from = 0, to, number = 0; from < v->n; from = to) {
        add_joint(b, q, from, number++);
        uint32_t index = b->joints->len - 1;
        for (to = from + 1; to < v->n && !b->chosen[to];)
            to++;
        double way = to < v->n ? b->arc[to] - b->arc[from] : 0.0;
        for (uint32_t i = from; i < to; i++) {
            double t = way > 0.0 ? (b->arc[i] - b->arc[from]) / way : 0.0;
            if (b->owner[at[i]] == q)
                b->hat[at[i]] = t > 0.0 ? (Hat){{index, index + 1}, {1.0 - t, t}} : (Hat){{index, index}, {1.0, 0.0}};
        }
    }
}

static void builder_init(Builder *b, const Skeleton *s, uint32_t per_sequence)
{
    uint32_t longest = 1;
    for (uint32_t q = 0; q < s->n_sequences; q++)
        longest = MAX(longest, s->sequence[q].n);
    *b = (Builder){.s = s, .per_sequence = per_sequence, .owner = g_new(uint32_t, (gsize)s->n_nodes + 1),
                   .joint = g_new(uint32_t, (gsize)s->n_nodes + 1), .forks = g_new0(uint8_t, (gsize)s->n_nodes + 1),
                   .hat = g_new0(Hat, (gsize)s->n_nodes + 1), .spacing = median_length(s), .arc = g_new(double, longest),
                   .chosen = g_new(bool, longest), .joints = g_array_new(FALSE, TRUE, sizeof(Joint))};
    find_owners(b);
    for (uint32_t q = 0; q < s->n_sequences; q++)
        add_sequence(b, q);
}

static void builder_clear(Builder *b)
{
    g_free(b->owner);
    g_free(b->joint);
    g_free(b->forks);
    g_free(b->hat);
    g_free(b->arc);
    g_free(b->chosen);
    g_array_free(b->joints, TRUE);
}

/* The largest weights of each vertex so far, descending, and the sum of the sizes of all. */
typedef struct {
    uint32_t per_vertex;
    uint16_t *joint;
    double *weight; /* [n · per_vertex] */
    double *total;  /* [n] */
} Best;

/* Equal weights: the joint that came first stays before. */
static void best_add(Best *b, uint32_t vertex, uint32_t joint, double weight)
{
    double *w = b->weight + (gsize)vertex * b->per_vertex;
    uint16_t *j = b->joint + (gsize)vertex * b->per_vertex;
    b->total[vertex] += fabs(weight);
    if (!(weight > w[b->per_vertex - 1]) || weight < LEAST_WEIGHT)
        return;
    uint32_t k = b->per_vertex - 1;
    for (; k > 0 && weight > w[k - 1]; k--) {
        w[k] = w[k - 1];
        j[k] = j[k - 1];
    }
    w[k] = weight;
    j[k] = (uint16_t)joint;
}

/* Weights that sum to 1 in float too: what rounding leaves goes to the largest. Returns the part that did not fit. */
static double normalise(const double *weight, double total, uint32_t n, float *out)
{
    double kept = 0.0, sum = 0.0;
    for (uint32_t k = 0; k < n; k++)
        kept += weight[k];
    for (uint32_t k = 0; k < n; k++) {
        out[k] = kept > 0.0 ? (float)(weight[k] / kept) : k == 0 ? 1.0f : 0.0f;
        sum += k > 0 ? (double)out[k] : 0.0;
    }
    if (sum > 0.0 && 1.0 - sum >= (double)out[1])
        out[0] = (float)(1.0 - sum);
    return total > kept ? total - kept : 0.0;
}

static void blade_weights(Rig *r, const Builder *b, Membrane *membrane, const uint32_t *fixed_node, uint32_t n_fixed)
{
    gsize n = r->n_blade, cells = n * r->per_vertex;
    Best best = {r->per_vertex, r->blade_joint, g_new0(double, cells + 1), g_new0(double, n + 1)};
    double *at_fixed = g_new0(double, (gsize)n_fixed + 1), *value = g_new(double, n + 1);
    for (uint32_t j = 0; j < r->n_joints; j++) {
        bool any = false;
        for (uint32_t i = 0; i < n_fixed; i++) {
            const Hat *h = &b->hat[fixed_node[i]];
            at_fixed[i] = h->joint[0] == j ? h->weight[0] : h->joint[1] == j ? h->weight[1] : 0.0;
            any = any || at_fixed[i] > 0.0;
        }
        if (!any)
            continue;
        membrane_harmonic(membrane, at_fixed, value);
        for (uint32_t v = 0; v < n; v++)
            if (value[v] != 0.0)
                best_add(&best, v, j, value[v]);
    }
    for (gsize v = 0; v < n; v++) {
        double loss = normalise(best.weight + v * r->per_vertex, best.total[v], r->per_vertex, r->blade_weight + v * r->per_vertex);
        r->worst_loss = MAX(r->worst_loss, loss);
        r->mean_loss += loss / (double)n;
    }
    g_free(best.weight);
    g_free(best.total);
    g_free(at_fixed);
    g_free(value);
}

/* A vertex of the vein solids goes with its node; one without a node (of the petiole) with the first joint. */
static void vein_weights(Rig *r, const Builder *b, const uint32_t *node)
{
    for (gsize v = 0; v < r->n_veins; v++) {
        Hat h = node[v] != NO_PARENT ? b->hat[node[v]] : (Hat){.weight = {1.0, 0.0}};
        uint32_t first = h.weight[1] > h.weight[0] ? 1 : 0;
        double weight[8] = {h.weight[first], h.weight[1 - first]};
        r->vein_joint[v * r->per_vertex] = (uint16_t)h.joint[first];
        r->vein_joint[v * r->per_vertex + 1] = weight[1] > 0.0 ? (uint16_t)h.joint[1 - first] : 0;
        normalise(weight, 1.0, r->per_vertex, r->vein_weight + v * r->per_vertex);
    }
}

Rig *rig_new(const Skeleton *s, const Mesh *mesh, Membrane *membrane, const uint32_t *fixed_node, uint32_t n_fixed,
             const uint32_t *vein_vertex_node, uint32_t n_vein_vertices, uint32_t per_sequence, uint32_t per_vertex, GError **error)
{
    g_assert(per_vertex == 4 || per_vertex == 8);
    g_assert(s->n_sequences > 0);
    Builder b;
    builder_init(&b, s, per_sequence);
    Rig *r = NULL;
    if (b.joints->len > RIG_MAX_JOINTS) {
        g_set_error(error, RIG_ERROR, RIG_ERROR_JOINTS, "the rig would have %u joints, at most %d are allowed: ask for fewer joints a vein or "
                    "fewer orders of veins", b.joints->len, RIG_MAX_JOINTS);
    } else {
        gsize blade = (gsize)mesh->n_vertices * per_vertex, veins = (gsize)n_vein_vertices * per_vertex;
        r = g_new0(Rig, 1);
        *r = (Rig){.n_joints = b.joints->len, .per_vertex = per_vertex, .joint = g_memdup2(b.joints->data, b.joints->len * sizeof(Joint)),
                   .n_blade = mesh->n_vertices, .n_veins = n_vein_vertices,
                   .blade_joint = g_new0(uint16_t, blade + 1), .vein_joint = g_new0(uint16_t, veins + 1),
                   .blade_weight = g_new0(float, blade + 1), .vein_weight = g_new0(float, veins + 1)};
        blade_weights(r, &b, membrane, fixed_node, n_fixed);
        vein_weights(r, &b, vein_vertex_node);
    }
    builder_clear(&b);
    return r;
}

void rig_free(Rig *r)
{
    if (r == NULL)
        return;
    g_free(r->joint);
    g_free(r->blade_joint);
    g_free(r->vein_joint);
    g_free(r->blade_weight);
    g_free(r->vein_weight);
    g_free(r);
}
