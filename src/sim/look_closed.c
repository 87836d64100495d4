/* A crowd of a closed pattern looks at the few fresh nodes that may concern it: those of its sources that pull one node each. */
#include "sim/block.h"

/* Is a node at x excluded from the neighbourhood of k by the one at u, which is another? */
static bool excludes_node(const Simulation *s, uint32_t k, uint32_t node, Vec2 u, Vec2 x, double d2)
{
    return vec_dist2(s->place[k], u) < d2 && vec_dist2(u, x) <= d2 && (!s->reach || source_sees(s, k, node));
}

/* The same by one of the few, or by a witness. */
static bool excluded(const Simulation *s, uint32_t k, Vec2 x, const Few *few)
{
    const Hood *h = &s->source[k].hood;
    double d2 = vec_dist2(s->place[k], x);
    for (uint32_t j = 0; j < few->n; j++)
        if (excludes_node(s, k, few->v[j], vec2(few->x[j], few->y[j]), x, d2))
            return true;
    for (uint32_t j = 0; j < h->n_witnesses; j++)
        if (excludes_node(s, k, h->w[j], s->veins.pos[h->w[j]], x, d2))
            return true;
    return false;
}

/* Rivals that concern a source: bit j for the j-th, the last bit for all from LISTED on. */
enum { LISTED = 63 };

static bool rival_excluded(const Simulation *s, uint32_t k, Vec2 nearest, const Sight *sight, uint32_t j)
{
    Vec2 x = vec2(sight->rival.x[j], sight->rival.y[j]);
    return vec_dist2(nearest, x) <= vec_dist2(s->place[k], x) || excluded(s, k, x, &sight->nearest);
}

/* Node v, which is nearer to k than any other, does not exclude some rivals. Do others? */
static bool all_excluded(const Simulation *s, uint32_t k, uint32_t v, const Sight *sight, uint64_t more)
{
    Vec2 u = s->veins.pos[v];
    for (uint64_t rest = more & ~((uint64_t)1 << LISTED); rest; rest &= rest - 1)
        if (!rival_excluded(s, k, u, sight, (uint32_t)__builtin_ctzll(rest)))
            return false;
    for (uint32_t j = LISTED; more >> LISTED && j < sight->rival.n; j++)
        if (!rival_excluded(s, k, u, sight, j))
            return false;
    return true;
}

/* Moves one source to its new nearest node, which excludes the old one. FALSE when it must look for itself: when it can't see the node, or
 * when that may not be all its neighbourhood by now. */
static bool show_closed(Simulation *s, uint32_t k, uint32_t v, double d2, uint64_t more, const Sight *sight)
{
    if (!all_excluded(s, k, v, sight, more) || (s->reach && !source_sees(s, k, v)))
        return false;
    s->near[k] = v;
    s->near2[k] = d2;
    if (d2 < MAX(kill2(s), past2(s))) {
        source_set_apart(s, k);
        s->mark[k] |= MARK_WITHIN;
    }
    return true;
}

/* Which rivals does neither the new nearest node of each nor another of the first few exclude? */
BLOCK_INLINE void block_rivals(const Simulation *s, const Block *b, const Sight *sight, const FourMask *plain, FourMask *more)
{
    const Few *few = &sight->nearest, *rival = &sight->rival;
    uint32_t n = s->reach ? 0 : MIN(few->n, SIGHT_GUARDS);
    Four vx, vy, e2[SIGHT_GUARDS];
    for (uint32_t l = 0; l < 4; l++) {
        Vec2 v = b->kin[l] < 0 ? vec2(0.0, 0.0) : s->veins.pos[(uint32_t)b->kin[l]];
        vx[l] = v.x;
        vy[l] = v.y;
    }
    for (uint32_t i = 0; i < n; i++) {
        Four dx = FOUR(few->x[i]) - b->x, dy = FOUR(few->y[i]) - b->y;
        e2[i] = dx * dx + dy * dy;
    }
    for (uint32_t j = 0; j < rival->n; j++) {
        Four rx = FOUR(rival->x[j]), ry = FOUR(rival->y[j]), d2 = (rx - b->x) * (rx - b->x) + (ry - b->y) * (ry - b->y);
        FourMask open = ((rx - vx) * (rx - vx) + (ry - vy) * (ry - vy) > d2) & *plain;
        if (!FOUR_ANY(open))
            continue;
        const double *apart2 = sight->apart2[j];
        for (uint32_t i = 0; i < n; i++)
            open &= ~((e2[i] < d2) & (FOUR(apart2[i]) <= d2));
        *more |= open & FOUR_MASK((int64_t)((uint64_t)1 << MIN(j, LISTED)));
    }
}

/* One source that does not simply turn to its new nearest node. `more`: rivals that may matter to it. */
static void show_one(Simulation *s, uint32_t k, int64_t kin, double d2, bool child, uint64_t more, const Sight *sight)
{
    uint32_t v = (uint32_t)kin;
    bool stays = kin >= 0 && !child && vec_dist2(s->veins.pos[v], s->veins.pos[s->near[k]]) > s->near2[k];
    if (kin < 0 || stays || !show_closed(s, k, v, d2, more, sight))
        source_look_closed(s, k);
}

typedef struct {
    const Sight *sight;
    double within2;
    const Draw *draw;
    bool *together, *parted;
} Show;

/* What is to be found out of a block. */
typedef struct {
    FourMask plain, child, more, trouble; /* more: rivals that may matter; trouble: it can't be moved on as it is */
} Plight;

static __attribute__((noinline)) void show_each(Simulation *s, uint32_t k, uint32_t n, const Show *show, const Plight *p, Block *b)
{
    for (uint32_t l = 0; l < n; l++) {
        if (!p->plain[l])
            continue;
        if (p->trouble[l]) {
            show_one(s, k + l, b->kin[l], b->d2[l], p->child[l], (uint64_t)p->more[l], show->sight);
            *show->parted |= (s->mark[k + l] & MARK_APART) != 0;
            b->d2[l] = s->near2[k + l];
        } else {
            s->near[k + l] = (uint32_t)b->kin[l];
            s->near2[k + l] = b->d2[l];
        }
    }
    pulls_draw(s, k, k + n, show->draw);
}

/* Most often all that are plain turn to new nodes and stay plain: the new node is a child of the old one and near by, and so excludes it. */
BLOCK_INLINE void show_block(Simulation *s, const Columns *c, uint32_t k, uint32_t n, const Show *show, uint32_t few, Four *most2)
{
    Block b;
    Plight p;
    p.more = FOUR_MASK(0);
    block_look(c, k, n, show->sight, few, false, &b);
    FourMask old = __builtin_convertvector(block_old(c, k, n), FourMask);
    p.plain = b.near2 >= FOUR(0.0);
    p.child = ((b.kin >> 32) == old) & (b.stride2 <= b.near2);
    if (show->sight->rival.n)
        block_rivals(s, &b, show->sight, &p.plain, &p.more);
    p.trouble = (~p.child | (b.d2 < FOUR(show->within2)) | (p.more != FOUR_MASK(0))) & p.plain;
    if (s->reach)
        p.trouble = p.plain;
    if (FOUR_ANY(p.trouble)) {
        Block each = b; /* a block that nobody asks for by its address stays in registers */
        Plight of_each = p;
        show_each(s, k, n, show, &of_each, &each);
        b.d2 = each.d2;
        *show->together = false;
    } else {
        if (FOUR_ANY(~p.plain)) {
            block_keep(c, k, n, s->veins.pos, &p.plain, &b);
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

WIDE double look_closed_run(Simulation *s, uint32_t first, uint32_t last, const Sight *sight, const Draw *draw, bool *together,
                                 bool *parted)
{
    const Show show = {sight, MAX(kill2(s), past2(s)), draw, together, parted};
    uint32_t few = sight->nearest.n;
    return few == 1 ? show_run(s, first, last, &show, 1) : few == 2 ? show_run(s, first, last, &show, 2) : show_run(s, first, last, &show, few);
}
