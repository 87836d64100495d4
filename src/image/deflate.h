/* Compressing with zlib (RFC 1950, 1951). ISA-L takes a fifth of its time for files of about the same size, but one file in some thousands comes out in
 * other bytes from run to run; libdeflate can't stream. */
#ifndef IMAGE_DEFLATE_H
#define IMAGE_DEFLATE_H

#include <glib.h>
#include <stdint.h>

typedef struct Deflate Deflate;

/* What is looked for: runs of a byte, which is quick and finds what there is where numbers change little from pixel to pixel, once neighbours are taken
 * away from them; or any string seen before, as numbers of veins, which take several bytes, come back row after row. */
typedef enum { DEFLATE_RUNS, DEFLATE_STRINGS } DeflateMatch;

Deflate *deflate_new(DeflateMatch match);
void deflate_free(Deflate *d);

/* n bytes as one stream; its length, or 0 when it is longer than `room`. */
gsize deflate_whole(Deflate *d, const uint8_t *in, uint32_t n, uint8_t *out, uint32_t room);

/* One stream piece by piece: begin; give a piece, which must stay until all of it is taken: take, until less than `room` bytes come. The
 * last piece may be empty. */
void deflate_begin(Deflate *d);
void deflate_give(Deflate *d, const uint8_t *in, uint32_t n, gboolean last);
gsize deflate_take(Deflate *d, uint8_t *out, uint32_t room);

#endif
