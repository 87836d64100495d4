/* Names of vein sequences, for poses and rigs: midrib, P2; L1, R2 by side and number from the base; R2.L1; F1 fictitious. */
#include <stdio.h>

#include "shape/skeleton_private.h"

static Vec2 node_of(const Skeleton *s, const Sequence *q, uint32_t i) { return s->rest[s->at[q->first + i]]; }

/* Whether a sequence leaves its parent to the left, seen from the base to the tip. */
static bool leaves_left(const Skeleton *s, const Sequence *q)
{
    const Sequence *p = &s->sequence[q->parent];
    uint32_t from = q->start > 0 ? q->start - 1 : 0, to = MIN(q->start + 1, p->n - 1);
    Vec2 along = vec_sub(node_of(s, p, to), node_of(s, p, from)), away = vec_sub(node_of(s, q, 1), node_of(s, q, 0));
    return vec_cross(along, away) > 0.0;
}

typedef struct {
    uint32_t parent, start, sequence;
} Branch;

static gint by_start(gconstpointer a, gconstpointer b, gpointer user)
{
    const Branch *p = a, *q = b;
    if (p->parent != q->parent)
        return p->parent < q->parent ? -1 : 1;
    if (p->start != q->start)
        return p->start < q->start ? -1 : 1;
    return (p->sequence > q->sequence) - (p->sequence < q->sequence);
}

static bool is_primary(const Sequence *q) { return !q->fictitious && (q->parent == NO_PARENT || q->order == 1); }

/* A name that would not fit gives way to the sequence's number. */
static void set_name(Skeleton *s, uint32_t i, const char *prefix, char kind, uint32_t number)
{
    Sequence *q = &s->sequence[i];
    int n = snprintf(q->name, sizeof q->name, "%s%s%c%u", prefix, prefix[0] ? "." : "", kind, number);
    if (n >= (int)sizeof q->name)
        snprintf(q->name, sizeof q->name, "V%u", i);
}

void skeleton_name(Skeleton *s)
{
    uint32_t primaries = 0, fictitious = 0, n = 0;
    g_strlcpy(s->sequence[0].name, "midrib", sizeof s->sequence[0].name);
    for (uint32_t i = 0; i < s->n_sequences; i++) {
        if (s->sequence[i].fictitious)
            set_name(s, i, "", 'F', ++fictitious);
        else if (is_primary(&s->sequence[i]) && ++primaries > 1)
            set_name(s, i, "", 'P', primaries);
    }
    Branch *branch = g_new(Branch, s->n_sequences);
    for (uint32_t i = 0; i < s->n_sequences; i++)
        if (!s->sequence[i].fictitious && !is_primary(&s->sequence[i]))
            branch[n++] = (Branch){s->sequence[i].parent, s->sequence[i].start, i};
    g_qsort_with_data(branch, (gint)n, sizeof *branch, by_start, NULL);
    uint32_t count[2] = {0, 0};
    for (uint32_t k = 0; k < n; k++) { /* parents come before their children, so they have their names */
        const char *prefix = s->sequence[branch[k].parent].name;
        if (k == 0 || branch[k].parent != branch[k - 1].parent)
            count[0] = count[1] = 0;
        bool left = leaves_left(s, &s->sequence[branch[k].sequence]);
        set_name(s, branch[k].sequence, branch[k].parent == 0 ? "" : prefix, left ? 'L' : 'R', ++count[left]);
    }
    g_free(branch);
}
