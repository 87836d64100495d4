/* A crowd of an open pattern looks at the few fresh nodes that may concern it. */
#include "sim/block.h"

/* When the source can't see the node it looks for itself. */
static void show_one(Simulation *s, uint32_t k, uint32_t v, double d2, double within2)
{
    if (s->reach && !source_sees(s, k, v)) {
        source_look_open(s, k);
        return;
    }
    s->near[k] = v;
    s->near2[k] = d2;
    s->mark[k] = d2 < within2 ? MARK_WITHIN : 0;
}

/* One of a block that did not move on as a whole. */
static __attribute__((noinline)) void show_each(Simulation *s, uint32_t k, uint32_t n, double within2, const Draw *draw, Block *b)
{
    for (uint32_t l = 0; l < n; l++) {
        if (b->kin[l] >= 0)
            show_one(s, k + l, (uint32_t)b->kin[l], b->d2[l], within2);
        b->d2[l] = s->near2[k + l]; /* that of a node it sees */
    }
    pulls_draw(s, k, k + n, draw);
}

typedef struct {
    const Sight *sight;
    double within2;
    const Draw *draw;
    bool *together;
} Show;

/* Mostly all of them turn to new nodes, or have those that they had. */
BLOCK_INLINE void show_block(Simulation *s, const Columns *c, uint32_t k, uint32_t n, const Show *show, uint32_t few, Four *most2)
{
    Block b;
    uint32_t marks = 0;
    block_look(c, k, n, show->sight, few, true, &b);
    memcpy(&marks, c->mark + k, n);
    FourMask moved = b.kin >= FOUR_MASK(0), within = b.d2 < FOUR(show->within2);
    if (marks || s->reach || FOUR_ANY(within)) {
        Block each = b; /* a block that nobody asks for by its address stays in registers */
        show_each(s, k, n, show->within2, show->draw, &each);
        b.d2 = each.d2;
        *show->together = false;
    } else {
        if (FOUR_ANY(~moved)) {
            block_keep(c, k, n, s->veins.pos, &moved, &b);
            *show->together = false;
        }
        block_store(c, k, n, &b);
    }
    for (uint32_t l = n; l < 4; l++)
        b.d2[l] = b.d2[0];
    *most2 = FOUR_PICK(b.d2 > *most2, b.d2, *most2);
}

BLOCK_INLINE double show_run(Simulation *s, uint32_t first, uint32_t last, const Show *show, uint32_t few)
{
    Columns c = columns(s, show->draw);
    Four most2 = FOUR(-1.0);
    uint32_t k = first;
    for (; k + 4 <= last; k += 4)
        show_block(s, &c, k, 4, show, few, &most2);
    if (k < last)
        show_block(s, &c, k, last - k, show, few, &most2);
    return four_most(&most2);
}

WIDE double look_open_run(Simulation *s, uint32_t first, uint32_t last, const Sight *sight, const Draw *draw, bool *together)
{
    const Show show = {sight, MAX(kill2(s), past2(s)), draw, together};
    uint32_t few = sight->nearest.n;
    return few == 1 ? show_run(s, first, last, &show, 1) : few == 2 ? show_run(s, first, last, &show, 2) : show_run(s, first, last, &show, few);
}
