/* Sparse Cholesky factor for many right-hand sides. CXSparse finds the order of elimination (approximate minimum degree), which is
 * whole-number work; the arithmetic is done here, so that its bits don't hang on how that library was compiled (fused multiply-add). */
#ifndef SHAPE_CHOLESKY_H
#define SHAPE_CHOLESKY_H

#include "geom/vec3.h"

/* A sparse matrix by rows: entries start[i] … start[i + 1] - 1 of column and value are row i's, in any order, no column twice. */
typedef struct {
    uint32_t n;
    uint32_t *start, *column;
    double *value;
} SparseRows;

/* P A Pᵀ = L Lᵀ, unknown i being number position[i] in the order of elimination. */
typedef struct {
    uint32_t n;
    uint32_t *position; /* [n] */
    uint32_t *start;    /* [n + 1] columns of L below the diagonal, rows ascending */
    uint32_t *row;
    double *value;
    double *inverse;    /* [n] 1 / diagonal of L */
} Cholesky;

/* Of a symmetric positive definite matrix, both halves given. NULL when a pivot is lost to rounding, or the factor would have 2^31
 * entries or more. */
Cholesky *cholesky_new(const SparseRows *a);
void cholesky_free(Cholesky *c);

/* Solve in place, in the order of elimination: x[position[i]] is unknown i. The second does three right-hand sides in one pass over L,
 * each with the same bits as the first. */
void cholesky_solve(const Cholesky *c, double *x);
void cholesky_solve3(const Cholesky *c, Vec3 *x);

#endif
