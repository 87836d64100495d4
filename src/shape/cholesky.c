#include "shape/cholesky.h"

#include <float.h>
#include <glib.h>
#define NCOMPLEX
#include <suitesparse/cs.h>

enum { NONE = UINT32_MAX };

/* Order, elimination tree and column sizes; NULL when the factor would be too large. */
static cs_dis *analyse(const SparseRows *a)
{
    G_STATIC_ASSERT(sizeof(int) == sizeof(uint32_t));
    if (a->n > G_MAXINT / 2 || a->start[a->n] > G_MAXINT / 2)
        return NULL;
    cs_di pattern = {.nzmax = (int)a->start[a->n],
                     .m = (int)a->n,
                     .n = (int)a->n,
                     .p = (int *)a->start,
                     .i = (int *)a->column,
                     .nz = -1};
    cs_dis *s = cs_di_schol(1, &pattern);
    if (s && !(s->lnz < (double)G_MAXINT)) {
        cs_di_sfree(s);
        return NULL;
    }
    return s;
}

/* Working space of the factorisation. */
typedef struct {
    const int *parent; /* elimination tree, -1 at a root */
    uint32_t *end;     /* [n] where the next entry of each column of L goes */
    uint32_t *mark;    /* [n] last row whose pattern a column was found in */
    uint32_t *path, *stack;
    double *y;         /* [n] the row of A, then of L, being worked on; 0 between rows */
} Work;

/* Spreads row v of A, which is row k of P A Pᵀ, into y and its diagonal into *diagonal. The columns where row k of L is not zero
 * are those of A's entries and their ancestors below k; stack[returned … n - 1] lists them, descendants first. */
static uint32_t row_pattern(const Cholesky *c, const SparseRows *a, Work *w, uint32_t v, uint32_t k, double *diagonal)
{
    uint32_t top = c->n;
    *diagonal = 0.0;
    w->mark[k] = k;
    for (uint32_t p = a->start[v]; p < a->start[v + 1]; p++) {
        uint32_t j = c->position[a->column[p]], length = 0;
        if (j == k)
            *diagonal = a->value[p];
        if (j >= k)
            continue;
        w->y[j] = a->value[p];
        for (; w->mark[j] != k; j = (uint32_t)w->parent[j]) {
            w->path[length++] = j;
            w->mark[j] = k;
        }
        while (length > 0)
            w->stack[--top] = w->path[--length];
    }
    return top;
}

/* Row by row (up-looking): row k of L solves a triangular system with the rows above. */
static bool eliminate(Cholesky *c, const SparseRows *a, const uint32_t *order, Work *w)
{
    for (uint32_t k = 0; k < c->n; k++) {
        double diagonal, pivot;
        uint32_t top = row_pattern(c, a, w, order[k], k, &diagonal);
        pivot = diagonal;
        for (; top < c->n; top++) {
            uint32_t j = w->stack[top];
            double entry = w->y[j] * c->inverse[j];
            w->y[j] = 0.0;
            for (uint32_t p = c->start[j]; p < w->end[j]; p++)
                w->y[c->row[p]] -= c->value[p] * entry;
            pivot -= entry * entry;
            c->row[w->end[j]] = k;
            c->value[w->end[j]++] = entry;
        }
        if (!(pivot > DBL_EPSILON * diagonal)) /* no digit of it is left */
            return false;
        c->inverse[k] = 1.0 / sqrt(pivot);
    }
    return true;
}

static bool factorise(Cholesky *c, const SparseRows *a, const cs_dis *s)
{
    uint32_t n = c->n, *order = g_new(uint32_t, n);
    Work w = {.parent = s->parent,
              .end = g_new(uint32_t, n),
              .mark = g_new(uint32_t, n),
              .path = g_new(uint32_t, n),
              .stack = g_new(uint32_t, n),
              .y = g_new0(double, n)};
    for (uint32_t i = 0; i < n; i++) {
        c->position[i] = (uint32_t)s->pinv[i];
        order[c->position[i]] = i;
        w.mark[i] = NONE;
        c->start[i] = w.end[i] = (uint32_t)s->cp[i] - i; /* cp counts the diagonal */
    }
    c->start[n] = (uint32_t)s->cp[n] - n;
    c->row = g_new(uint32_t, c->start[n]);
    c->value = g_new(double, c->start[n]);
    bool done = eliminate(c, a, order, &w);
    g_free(order);
    g_free(w.end);
    g_free(w.mark);
    g_free(w.path);
    g_free(w.stack);
    g_free(w.y);
    return done;
}

Cholesky *cholesky_new(const SparseRows *a)
{
    Cholesky *c = g_new0(Cholesky, 1);
    c->n = a->n;
    c->position = g_new(uint32_t, a->n);
    c->start = g_new0(uint32_t, (gsize)a->n + 1);
    c->inverse = g_new(double, a->n);
    if (a->n == 0)
        return c;
    cs_dis *s = analyse(a);
    bool done = s && factorise(c, a, s);
    cs_di_sfree(s);
    if (done)
        return c;
    cholesky_free(c);
    return NULL;
}

void cholesky_free(Cholesky *c)
{
    if (!c)
        return;
    g_free(c->position);
    g_free(c->start);
    g_free(c->row);
    g_free(c->value);
    g_free(c->inverse);
    g_free(c);
}

void cholesky_solve(const Cholesky *c, double *x)
{
    for (uint32_t j = 0; j < c->n; j++) {
        double t = x[j] *= c->inverse[j];
        for (uint32_t p = c->start[j]; p < c->start[j + 1]; p++)
            x[c->row[p]] -= c->value[p] * t;
    }
    for (uint32_t j = c->n; j-- > 0;) {
        double t = x[j];
        for (uint32_t p = c->start[j]; p < c->start[j + 1]; p++)
            t -= c->value[p] * x[c->row[p]];
        x[j] = t * c->inverse[j];
    }
}

void cholesky_solve3(const Cholesky *c, Vec3 *x)
{
    for (uint32_t j = 0; j < c->n; j++) {
        Vec3 t = x[j] = vec3_scale(x[j], c->inverse[j]);
        for (uint32_t p = c->start[j]; p < c->start[j + 1]; p++) {
            Vec3 *to = &x[c->row[p]];
            *to = vec3_sub(*to, vec3_scale(t, c->value[p]));
        }
    }
    for (uint32_t j = c->n; j-- > 0;) {
        Vec3 t = x[j];
        for (uint32_t p = c->start[j]; p < c->start[j + 1]; p++)
            t = vec3_sub(t, vec3_scale(x[c->row[p]], c->value[p]));
        x[j] = vec3_scale(t, c->inverse[j]);
    }
}
