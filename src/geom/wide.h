/* Loops that vector instructions take in. */
#ifndef GEOM_WIDE_H
#define GEOM_WIDE_H

#include <stdint.h> /* says which C library it is */

/* Before a function's definition: it is compiled twice, for any processor of its kind and for those with AVX2, and the program takes the one that fits. Both
 * give the same results, bit by bit, as long as there is nothing but + - * / and square roots in them (with -ffp-contract=off). */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__) && !defined(__AVX2__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define WIDE __attribute__((target_clones("avx2", "default")))
#else
#define WIDE
#endif

#endif
