/* What the turtle of sim/lsystem.h asks the blade for: where it ends, room, lobes. */
#include "geom/bezier.h"
#include "geom/dtrig.h"
#include "geom/segment.h"
#include "sim/lturtle.h"

/* Of ~, in ways from where the lobe's vein begins to its tip: how much blade a vein wants to see ahead, and for how long it minds; how fast
 * it comes back to its own direction, degrees a way; how finely directions are tried. */
static const double room = 0.06, beginning = 0.1, recovery = 1000.0;
enum { SWERVES = 40 };
/* Veins of neighbouring lobes end so far from the line between them, leaf lengths. */
static const double field_gap = 0.006;

/* --- margin --- */

/* How much of the way from a to b, 0 … 1, lies before the margin first crosses it; crossings at a itself, where a vein starts on the
 * margin, don't count. */
static double way_to_margin(const Polygon *p, Vec2 a, Vec2 b)
{
    Vec2 d = vec_sub(b, a);
    double first = 1.0;
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 c = p->v[i], e = vec_sub(p->v[i + 1 < p->n ? i + 1 : 0], c);
        double across = vec_cross(d, e);
        if (across == 0.0)
            continue;
        double t = vec_cross(vec_sub(c, a), e) / across, u = vec_cross(vec_sub(c, a), d) / across;
        if (u >= 0.0 && u <= 1.0 && t > 1e-9 && t < first)
            first = t;
    }
    return first;
}

/* --- which way is up --- */

/* Its own direction; other lobes' primaries are straight. */
static bool is_turned(const Drawing *d, const Turtle *t) { return d->axis.curved && t->lobe == 0; }

static double axis_at(const Drawing *d, double y) { return d->unit * laxis_x(&d->axis, y / d->unit); }

/* In the frame that has `up` as its y axis. */
static Vec2 turned(Vec2 direction, Vec2 up)
{
    return vec2(direction.x * up.y + direction.y * up.x, direction.y * up.y - direction.x * up.x);
}

Vec2 lturtle_direction(const Drawing *d, const Turtle *t, double degrees, double ahead)
{
    double sine, cosine;
    degrees_sincos(degrees, &sine, &cosine);
    Vec2 way = vec2(cosine, sine);
    if (!is_turned(d, t))
        return way;
    Vec2 first = turned(way, laxis_way(&d->axis, t->at.y / d->unit));
    return turned(way, laxis_way(&d->axis, (t->at.y + 0.5 * ahead * first.y) / d->unit));
}

/* --- fields --- */

bool lturtle_in_field(const Drawing *d, const Turtle *t, Vec2 at)
{
    if (t->side && is_turned(d, t)) {
        if (t->side * (axis_at(d, at.y) - at.x) <= 0.0)
            return false;
    } else if (t->side) {
        double sine, cosine;
        degrees_sincos(90.0 + t->tilt, &sine, &cosine);
        Vec2 hub = d->looked ? vec_scale(d->lobes.hub, d->unit) : vec2(0.0, 0.0);
        if (t->side * vec_cross(vec2(cosine, sine), vec_sub(at, hub)) <= 0.0)
            return false;
    }
    if (!d->looked)
        return true;
    const Lobe *lobe = &d->lobes.lobe[(int)d->lobes.middle + t->lobe];
    Vec2 way = vec_sub(vec_scale(at, 1.0 / d->unit), d->lobes.hub);
    double gap = MIN(field_gap, 0.05 * sqrt(vec_norm2(way)));
    return (lobe->open_left || vec_dot(lobe->left, way) <= 0.0 || vec_cross(way, lobe->left) >= gap) &&
           (lobe->open_right || vec_dot(lobe->right, way) <= 0.0 || vec_cross(lobe->right, way) >= gap);
}

bool lturtle_clip(const Drawing *d, Turtle *t, Vec2 *to)
{
    if (!d->margin || vec_dist(*to, t->centre) < t->radius)
        return true;
    t->centre = t->at;
    t->radius = polygon_depth(d->margin, t->at);
    if (vec_dist(*to, t->at) < t->radius)
        return true;
    double way = way_to_margin(d->margin, t->at, *to);
    if (!polygon_contains(d->margin, vec_lerp(t->at, *to, 0.5 * way))) {
        t->stopped = true;
        return false;
    }
    if (way == 1.0 && polygon_contains(d->margin, *to))
        return true;
    t->stopped = true;
    for (double back = 0x1p-30; back < 1.0; back *= 2.0) { /* as near to the margin as rounding lets it be inside */
        Vec2 end = vec_lerp(t->at, *to, way * (1.0 - back));
        if (polygon_contains(d->margin, end)) {
            *to = end;
            return true;
        }
    }
    return false;
}

/* --- making room --- */

double lturtle_swerve(const Drawing *d, Turtle *t, double length)
{
    double reach = t->scale * d->unit, aside = 90.0 + t->tilt - t->heading, need = 0.0;
    for (int k = 0; t->wary > 0.0 && k <= SWERVES; k++) {
        Vec2 way = lturtle_direction(d, t, t->heading + aside * k / SWERVES, 0.0);
        if (k < SWERVES && lobes_way(d->margin, t->at, way, room * reach) < room * reach)
            continue;
        need = k == 0 ? 0.0 : aside * (0.5 + 0.5 * k / SWERVES);
        break;
    }
    double back = MAX(fabs(t->swerve) - recovery * length / reach, 0.0);
    t->swerve = fabs(need) > back ? need : t->swerve > 0.0 ? back : -back;
    t->wary = t->swerve != 0.0 ? t->wary - length : 0.0;
    return t->swerve;
}

/* --- in the blade --- */

static void look_for_lobes(Drawing *d)
{
    if (d->looked)
        return;
    Polygon *leaf = polygon_scaled(d->margin, 1.0 / d->unit);
    lobes_find(leaf, &d->lobes);
    polygon_free(leaf);
    if (d->axis.curved)
        d->lobes.hub.x = laxis_x(&d->axis, d->lobes.hub.y);
    d->looked = true;
}

/* Straight on, or as the midvein bends, to where primaries part. */
static void to_hub(Drawing *d, Turtle *t, uint16_t born, uint32_t depth)
{
    look_for_lobes(d);
    Vec2 hub = vec_scale(d->lobes.hub, d->unit), from = t->at;
    uint32_t n = vec_dist(hub, from) > 0.0 ? lturtle_pieces(vec_dist(hub, from)) : 0; /* it may be there: at the base */
    for (uint32_t k = 1; k <= n && !t->stopped; k++) {
        Vec2 to = k == n ? hub : vec_lerp(from, hub, (double)k / n);
        if (d->axis.curved)
            to.x += axis_at(d, to.y) - (axis_at(d, from.y) + (axis_at(d, hub.y) - axis_at(d, from.y)) * k / n);
        if (lturtle_clip(d, t, &to))
            lturtle_draw(d, t, to, born, depth);
    }
    if (t->lobe == 0)
        t->scale = 1.0 - d->lobes.hub.y;
}

/* To the next lobe on the left (-1) or right; where there is none the branch is not drawn. */
static void to_lobe(Drawing *d, Turtle *t, int side, uint32_t depth)
{
    look_for_lobes(d);
    int lobe = t->lobe + side, at = (int)d->lobes.middle + lobe;
    Vec2 way = at < 0 || at >= (int)d->lobes.n ? vec2(0.0, 0.0) : vec_sub(d->lobes.lobe[at].tip, vec_scale(t->at, 1.0 / d->unit));
    if (vec_norm2(way) < 1e-12) {
        t->stopped = true;
        return;
    }
    t->lobe = lobe;
    t->scale = sqrt(vec_norm2(way));
    if (is_turned(d, t))
        way.x = laxis_x(&d->axis, t->at.y / d->unit) - t->at.x / d->unit;
    t->heading = dtrig_atan2(way.y, way.x) / DTRIG_DEGREE;
    t->tilt = t->heading - 90.0;
    t->first = depth;
}

/* On to the margin or the end of the field, however far that is; a vein that turns round and round ends after once round the blade. */
static void to_margin(Drawing *d, Turtle *t, uint16_t born, uint32_t depth)
{
    const Box2 *b = &d->margin->box;
    uint32_t most = lturtle_pieces(2.0 * (b->x1 - b->x0 + b->y1 - b->y0));
    double length = MIN(1.0, 0.01 * d->unit);
    for (uint32_t k = 0; k < most && !t->stopped && !d->overflow; k++)
        lturtle_go(d, t, length, 1, born, depth, true);
}

void lturtle_obey_blade(Drawing *d, Turtle *t, char symbol, uint16_t born, uint32_t depth)
{
    switch (symbol) {
    case '^':
        to_hub(d, t, born, depth);
        break;
    case '<':
    case '>':
        to_lobe(d, t, symbol == '<' ? -1 : 1, depth);
        break;
    case '~':
        t->wary = beginning * t->scale * d->unit;
        t->side = t->heading >= 90.0 + t->tilt ? 1 : -1;
        break;
    default:
        to_margin(d, t, born, depth);
        break;
    }
}
