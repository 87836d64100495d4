/* The plain floor of writing maps: the compressor alone, given bytes that are ready for it; and other settings of it beside. */
#ifndef BENCH_COMPRESSORS_H
#define BENCH_COMPRESSORS_H

#include "image/plane.h"
#include "lib/leaf.h"

typedef enum { PLAIN_PNG, PLAIN_EXR } PlainKind;

typedef struct Plain Plain;

Plain *plain_new(PlainKind kind, const Plane *like, int depth);
void plain_free(Plain *f);

/* Readies a band's bytes: rows of a PNG file behind their filter, ZIP chunks of an EXR file as ZIP has them. */
void plain_fill(Plain *f, const Plane *band);

/* Compresses them, and gives the result up; bytes. */
gsize plain_compress(Plain *f);

/* Prints times and sizes of each map with other filters, levels and strategies. */
void compare_compressors(const VenLeaf *leaf, uint32_t size);

#endif
