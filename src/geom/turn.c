#include "geom/turn.h"

/* A number as a sum of doubles that share no bits, smallest first (Shewchuk 1997). */
typedef struct {
    double part[16];
    int n;
} Expansion;

static void add(Expansion *e, double x)
{
    for (int i = 0; i < e->n; i++) { /* what rounding leaves of each sum stays, the sum goes on */
        double sum = x + e->part[i], of_part = sum - x, of_x = sum - of_part;
        e->part[i] = (x - of_x) + (e->part[i] - of_part);
        x = sum;
    }
    e->part[e->n++] = x;
}

static double high_half(double x)
{
    double c = 134217729.0 * x; /* 2^27 + 1 (Dekker 1971) */
    return c - (c - x);
}

static void add_product(Expansion *e, double x, double y)
{
    double product = x * y, xh = high_half(x), xl = x - xh, yh = high_half(y), yl = y - yh;
    add(e, xl * yl - (((product - xh * yh) - xl * yh) - xh * yl));
    add(e, product);
}

static int sign_of(double x)
{
    return (x > 0.0) - (x < 0.0);
}

int turn_sign(Vec2 a, Vec2 b, Vec2 c)
{
    static const double bound = 4.0 * 0x1p-52; /* more than rounding can be off by, of the sum below */
    double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x), det = left - right;
    if (fabs(det) > bound * (fabs(left) + fabs(right)))
        return sign_of(det);
    Expansion e = {.n = 0};
    add_product(&e, a.x, b.y);
    add_product(&e, -a.y, b.x);
    add_product(&e, b.x, c.y);
    add_product(&e, -b.y, c.x);
    add_product(&e, c.x, a.y);
    add_product(&e, -c.y, a.x);
    for (int i = e.n; i-- > 0;)
        if (e.part[i] != 0.0)
            return sign_of(e.part[i]);
    return 0;
}

bool turn_before(Vec2 q, Vec2 a, Vec2 b)
{
    bool low_a = a.y < q.y || (a.y == q.y && a.x < q.x), low_b = b.y < q.y || (b.y == q.y && b.x < q.x);
    return low_a != low_b ? low_b : turn_sign(q, a, b) > 0;
}
