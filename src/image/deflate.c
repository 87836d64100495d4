#include "image/deflate.h"

#include <zlib.h>

/* Measured on full sets of maps (tests/bench/bench_paint.c --compression): higher levels take longer for files that are hardly smaller. */
enum { LEVEL = 1, WINDOW_BITS = 15, MEMORY = 8 };

struct Deflate {
    z_stream stream;
    gboolean last;
};

static voidpf get_memory(voidpf user, uInt n, uInt size) { return g_malloc0_n(n, size); }

static void free_memory(voidpf user, voidpf memory) { g_free(memory); }

Deflate *deflate_new(DeflateMatch match)
{
    Deflate *d = g_new0(Deflate, 1);
    d->stream.zalloc = get_memory; /* runs out of memory as all else does */
    d->stream.zfree = free_memory;
    if (deflateInit2(&d->stream, LEVEL, Z_DEFLATED, WINDOW_BITS, MEMORY, match == DEFLATE_RUNS ? Z_RLE : Z_DEFAULT_STRATEGY) != Z_OK)
        g_error("zlib refuses to compress at level %d", LEVEL); /* it fails on wrong settings alone */
    return d;
}

void deflate_free(Deflate *d)
{
    if (!d)
        return;
    deflateEnd(&d->stream);
    g_free(d);
}

gsize deflate_whole(Deflate *d, const uint8_t *in, uint32_t n, uint8_t *out, uint32_t room)
{
    deflate_begin(d);
    deflate_give(d, in, n, TRUE);
    d->stream.next_out = out;
    d->stream.avail_out = room;
    return deflate(&d->stream, Z_FINISH) == Z_STREAM_END ? d->stream.total_out : 0;
}

void deflate_begin(Deflate *d)
{
    deflateReset(&d->stream);
}

void deflate_give(Deflate *d, const uint8_t *in, uint32_t n, gboolean last)
{
    d->stream.next_in = (Bytef *)(gintptr)in; /* not written to */
    d->stream.avail_in = n;
    d->last = last;
}

gsize deflate_take(Deflate *d, uint8_t *out, uint32_t room)
{
    d->stream.next_out = out;
    d->stream.avail_out = room;
    deflate(&d->stream, d->last ? Z_FINISH : Z_NO_FLUSH); /* no room, or nothing to do, is no error here */
    return room - d->stream.avail_out;
}
