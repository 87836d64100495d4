#include "geom/random.h"

static inline void philox_round(uint32_t c[4], const uint32_t k[2])
{
    uint64_t p0 = (uint64_t)0xD2511F53u * c[0];
    uint64_t p1 = (uint64_t)0xCD9E8D57u * c[2];
    uint32_t n0 = (uint32_t)(p1 >> 32) ^ c[1] ^ k[0];
    uint32_t n2 = (uint32_t)(p0 >> 32) ^ c[3] ^ k[1];
    c[1] = (uint32_t)p1;
    c[3] = (uint32_t)p0;
    c[0] = n0;
    c[2] = n2;
}

RandomBlock random_block(uint64_t seed, uint32_t stream, uint32_t step, uint64_t index)
{
    uint32_t k[2] = {(uint32_t)seed, (uint32_t)(seed >> 32)};
    RandomBlock b = {{(uint32_t)index, (uint32_t)(index >> 32), step, stream}};
    for (int i = 0; i < 10; i++) {
        philox_round(b.w, k);
        k[0] += 0x9E3779B9u;
        k[1] += 0xBB67AE85u;
    }
    return b;
}

void random_pair(uint64_t seed, uint32_t stream, uint32_t step, uint64_t index, double out[2])
{
    RandomBlock b = random_block(seed, stream, step, index);
    for (int i = 0; i < 2; i++) {
        uint64_t bits = ((uint64_t)b.w[2 * i] << 32 | b.w[2 * i + 1]) >> 11;
        out[i] = (double)bits * 0x1p-53;
    }
}
