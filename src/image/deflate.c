#include "image/deflate.h"

#include <isa-l/igzip_lib.h>

/* Measured on full sets of maps of 2048 pixels (tests/bench/bench_paint.c): level 2 takes as long, level 3 twice as long, and neither gives smaller files. */
enum { LEVEL = 1, MEMORY = ISAL_DEF_LVL1_DEFAULT };

struct Deflate {
    struct isal_zstream stream;
    _Alignas(16) uint8_t memory[MEMORY];
};

Deflate *deflate_new(void)
{
    return g_new(Deflate, 1);
}

void deflate_free(Deflate *d)
{
    g_free(d);
}

static void settle(Deflate *d)
{
    d->stream.level = LEVEL;
    d->stream.level_buf = d->memory;
    d->stream.level_buf_size = MEMORY;
    d->stream.gzip_flag = IGZIP_ZLIB;
    d->stream.flush = NO_FLUSH;
}

static void give(Deflate *d, const uint8_t *in, uint32_t n, gboolean last)
{
    d->stream.next_in = (uint8_t *)(gintptr)in; /* not written to */
    d->stream.avail_in = n;
    d->stream.end_of_stream = last ? 1 : 0;
}

gsize deflate_whole(Deflate *d, const uint8_t *in, uint32_t n, uint8_t *out, uint32_t room)
{
    isal_deflate_stateless_init(&d->stream);
    settle(d);
    give(d, in, n, TRUE);
    d->stream.next_out = out;
    d->stream.avail_out = room;
    return isal_deflate_stateless(&d->stream) == COMP_OK && d->stream.avail_in == 0 ? d->stream.total_out : 0;
}

void deflate_begin(Deflate *d)
{
    isal_deflate_init(&d->stream);
    settle(d);
}

void deflate_give(Deflate *d, const uint8_t *in, uint32_t n, gboolean last)
{
    give(d, in, n, last);
}

gsize deflate_take(Deflate *d, uint8_t *out, uint32_t room)
{
    d->stream.next_out = out;
    d->stream.avail_out = room;
    if (isal_deflate(&d->stream) != COMP_OK)
        g_error("ISA-L refuses to compress at level %d", LEVEL); /* it fails on wrong settings alone */
    return room - d->stream.avail_out;
}
