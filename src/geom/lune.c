/* Is a lune empty? What excludes a node x from the neighbourhood of s lies in the lune of the two. */
#include "geom/nearby.h"

/* Box of the lune of s and x, a little more. */
static Box2 lune_box(Vec2 s, const Neighbour *x)
{
    double d = sqrt(x->d2) * (1.0 + 1e-9);
    return (Box2){MAX(s.x, x->p.x) - d, MAX(s.y, x->p.y) - d, MIN(s.x, x->p.x) + d, MIN(s.y, x->p.y) + d};
}

/* Which quadrants of a square may hold a node that excludes x, and are not wholly in the disc that is clear? */
static inline __attribute__((always_inline)) void quadrants_open(QuadSquare q, Vec2 s, const Neighbour *x, const Neighbour *clear,
                                                                 FourMask *out)
{
    FourSquares c = {0};
    four_quadrants(q, &c);
    Four cx = c.x, cy = c.y, reach = c.reach, d2 = FOUR(x->d2);
    Four ax = FOUR_GAP(cx - FOUR(x->p.x), reach), ay = FOUR_GAP(cy - FOUR(x->p.y), reach);
    Four bx = FOUR_GAP(cx - FOUR(s.x), reach), by = FOUR_GAP(cy - FOUR(s.y), reach);
    FourMask open = (ax * ax + ay * ay <= d2) & (bx * bx + by * by <= d2);
    if (clear) {
        Four fx = FOUR_ABS(cx - FOUR(clear->p.x)) + reach, fy = FOUR_ABS(cy - FOUR(clear->p.y)) + reach;
        open &= ~(fx * fx + fy * fy < FOUR(clear->d2 * (1.0 - 1e-9)));
    }
    *out = open;
}

/* Might one of a bucket's nodes exclude x? */
static inline __attribute__((always_inline)) bool bucket_open(const QuadBucket *k, Vec2 s, const Neighbour *x)
{
    FourMask any = FOUR_MASK(0);
    for (uint32_t j = 0; j < QUAD_BUCKET; j += 4) {
        Four low, high, d2 = FOUR(x->d2);
        memcpy(&low, k->p + j, sizeof low);
        memcpy(&high, k->p + j + 2, sizeof high);
        Four px = __builtin_shufflevector(low, high, 0, 2, 4, 6), py = __builtin_shufflevector(low, high, 1, 3, 5, 7);
        Four ax = px - FOUR(x->p.x), ay = py - FOUR(x->p.y), bx = px - FOUR(s.x), by = py - FOUR(s.y);
        FourMask there = (FourMask){j, j + 1, j + 2, j + 3} < FOUR_MASK(k->count);
        any |= (ax * ax + ay * ay <= d2) & (bx * bx + by * by <= d2) & there;
    }
    return FOUR_ANY(any);
}

WIDE bool lune_search(const Field *f, Vec2 s, const Neighbour *x, const Neighbour *clear, Neighbour *found)
{
    QuadSquare stack[QUAD_STACK];
    unsigned depth = 0;
    stack[depth++] = quadtree_around(f->tree, lune_box(s, x));
    while (depth) {
        QuadSquare q = stack[--depth];
        const QuadNode *n = &f->tree->node[q.node];
        if (n->child) {
            FourMask open;
            quadrants_open(q, s, x, clear, &open);
            for (unsigned k = 0; k < 4; k++)
                if (open[k])
                    stack[depth++] = quadtree_quadrant(f->tree, q, k);
            continue;
        }
        for (uint32_t b = n->bucket; b != NO_POINT; b = f->tree->bucket[b].next) {
            const QuadBucket *k = &f->tree->bucket[b];
            if (!bucket_open(k, s, x))
                continue;
            for (uint32_t j = 0; j < k->count; j++) {
                *found = (Neighbour){k->p[j], vec_dist2(s, k->p[j]), k->i[j]};
                if (found->v != x->v && excludes(found, x) && (!f->sees || f->sees(f->user, found->v)))
                    return true;
            }
        }
    }
    return false;
}

/* Must all that excludes x, at places relative to s, lie in the lune of s and its old neighbour m, which is farther off? The discs around x
 * and m through s both leave out less than the disc around any point c beyond x on the line from m through x: q² <= 2 q·x and q² > 2 q·m
 * give q·(x - m) > 0 and so q² <= 2 q·c. With c at the foot of the perpendicular from s, |q| is at most twice its length h; and there is
 * nothing nearer than near2. The second term covers what rounding does to the premises. Mostly x is the child of m, growing towards s. */
bool lune_inherited(Vec2 s, const Neighbour *x, const Neighbour *m, double near2)
{
    Vec2 w = vec_sub(x->p, m->p), a = vec_sub(s, m->p);
    double along = vec_dot(a, w), w2 = vec_norm2(w), cross = vec_cross(a, w);
    return along >= w2 && 4.04 * cross * cross + 1e-11 * along * m->d2 < near2 * w2;
}
