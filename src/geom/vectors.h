/* Four numbers at a time. The compiler makes of it what the machine has; as it is + - * / √ and comparisons, lane by lane, the bits are
 * those of one number after the other. */
#ifndef GEOM_VECTORS_H
#define GEOM_VECTORS_H

#include <math.h>
#include <stdint.h>

#include "geom/wide.h"

typedef double Four __attribute__((vector_size(32)));
typedef int64_t FourMask __attribute__((vector_size(32))); /* of a comparison: all ones or 0 */
typedef uint32_t FourNodes __attribute__((vector_size(16)));
typedef uint32_t EightNodes __attribute__((vector_size(32)));
typedef double Two __attribute__((vector_size(16)));
typedef int64_t TwoMask __attribute__((vector_size(16)));

#define FOUR(v) ((Four){(v), (v), (v), (v)})
#define FOUR_PICK(mask, a, b) ((Four)(((FourMask)(a) & (mask)) | ((FourMask)(b) & ~(mask))))
#define FOUR_ABS(a) ((Four)((FourMask)(a) & FOUR_MASK(INT64_MAX)))
#define FOUR_MASK(v) ((FourMask){(v), (v), (v), (v)})
#define FOUR_NODES(v) ((FourNodes){(v), (v), (v), (v)})
#define EIGHT_NODES(v) ((EightNodes){(v), (v), (v), (v), (v), (v), (v), (v)})

static inline __attribute__((always_inline)) int two_any(TwoMask m)
{
#ifdef __SSE2__
    return __builtin_ia32_movmskpd((Two)m) != 0;
#else
    return (m[0] | m[1]) != 0;
#endif
}

static inline __attribute__((always_inline)) int four_any(const FourMask *m)
{
    TwoMask two = __builtin_shufflevector(*m, *m, 0, 1) | __builtin_shufflevector(*m, *m, 2, 3);
    return two_any(two);
}

/* 1 / √ of each. */
static inline __attribute__((always_inline)) void four_inverse_root(const Four *a, Four *out)
{
    Four root;
#ifdef __SSE2__
    Two low = __builtin_ia32_sqrtpd(__builtin_shufflevector(*a, *a, 0, 1)), high = __builtin_ia32_sqrtpd(__builtin_shufflevector(*a, *a, 2, 3));
    root = __builtin_shufflevector(low, high, 0, 1, 2, 3);
#else
    for (int l = 0; l < 4; l++)
        root[l] = sqrt((*a)[l]);
#endif
    *out = FOUR(1.0) / root;
}

#define FOUR_ANY(mask)          \
    ({                          \
        FourMask any_ = (mask); \
        four_any(&any_);        \
    })

#endif
