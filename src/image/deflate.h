/* Compressing as zlib does (RFC 1950, 1951), with Intel's ISA-L: on maps it takes a fifth of zlib's time at its lowest level for files of about
 * the same size. Bytes depend on the version of the library and on the instructions that the processor has, as those of zlib depend on its version;
 * what they stand for doesn't. */
#ifndef IMAGE_DEFLATE_H
#define IMAGE_DEFLATE_H

#include <glib.h>
#include <stdint.h>

typedef struct Deflate Deflate;

Deflate *deflate_new(void);
void deflate_free(Deflate *d);

/* n bytes as one stream; its length, or 0 when it is longer than `room`. */
gsize deflate_whole(Deflate *d, const uint8_t *in, uint32_t n, uint8_t *out, uint32_t room);

/* One stream piece by piece: begin; give a piece, which must stay until all of it is taken: take, until less than `room` bytes come. The
 * last piece may be empty. */
void deflate_begin(Deflate *d);
void deflate_give(Deflate *d, const uint8_t *in, uint32_t n, gboolean last);
gsize deflate_take(Deflate *d, uint8_t *out, uint32_t room);

#endif
