/* Exact coverage of pixels by the veins and by the blade. */
#include <glib.h>
#include <string.h>

#include "image/painter.h"
#include "image/pixels.h"

/* ---- veins ---- */

enum { NONE = 0xFFFFFFFFu };

typedef struct {
    uint32_t next, stroke;
} Link;

/* Scratch for one tile: the strokes that cut each pixel, as chains. */
typedef struct {
    const Painter *p;
    Union area;
    bool full[TILE * TILE];
    uint32_t head[TILE * TILE];
    Link *link;
    uint32_t n_links, cap_links;
    Rings blade, spare; /* the margin within the tile, pixels */
    bool has_blade;
} Tile;

static void tile_link(Tile *t, uint32_t pixel, uint32_t stroke)
{
    if (t->n_links == t->cap_links) {
        t->cap_links = t->cap_links > 0 ? t->cap_links * 2 : 4096;
        t->link = g_renew(Link, t->link, t->cap_links);
    }
    t->link[t->n_links] = (Link){t->head[pixel], stroke};
    t->head[pixel] = t->n_links++;
}

static void tile_enter(Tile *t, TileBox box, uint32_t stroke)
{
    const Capsule *k = &t->p->strokes->v[stroke].shape;
    uint32_t y0, y1;
    pixel_rows(k, box.y0, box.y1, &y0, &y1);
    Span top = y0 < y1 ? capsule_chord(k, y0) : (Span){0.0, 0.0};
    for (uint32_t y = y0; y < y1; y++) {
        Span bottom = capsule_chord(k, y + 1.0), reach = capsule_reach(k, y, y + 1.0, top, bottom);
        Span inside = {MAX(top.lo, bottom.lo), MIN(top.hi, bottom.hi)};
        uint32_t x0, x1, in0, in1, row = (y - box.y0) * TILE - box.x0;
        pixels_touched(reach, box.x0, box.x1, &x0, &x1);
        pixels_inside(inside, box.x0, box.x1, &in0, &in1);
        for (uint32_t x = x0; x < x1; x++) {
            if (x >= in0 && x < in1)
                t->full[row + x] = true;
            else if (!t->full[row + x])
                tile_link(t, row + x, stroke);
        }
        top = bottom;
    }
}

/* ---- joints ---- */

/* How stroke s and the one before it, which are cut at their joint, part what is there. */
typedef struct {
    bool bent;  /* there is a wedge between them, on the outer side */
    bool apart; /* nothing belongs to both */
    bool sharp; /* the wedge is so slim that both may as well go on to where they meet */
    Vec2 side;  /* the half-plane that is the first one's, through the joint; (0, 0): it makes no difference */
} Joint;

/* Both sides of the inner side touch the disc at the joint, so that they meet in the middle between their normals. What the first has beyond the line there
 * from the joint the second has, too, as long as that ends no earlier. */
static Joint joint_of(const Stroke *s)
{
    const Capsule *a = &s[-1].shape, *b = &s->shape;
    double turn = vec_cross(a->d, b->d), ahead = vec_dot(a->d, b->d), sign = turn > 0.0 ? 1.0 : -1.0, r2 = b->ra * b->ra;
    Joint j = {.bent = 0.5 * r2 * fabs(turn) > 1e-6 || ahead < 0.0};
    j.apart = !j.bent;
    if (!j.bent || ahead < 0.0 || b->ra * fabs(turn) > MIN(a->length, b->length))
        return j;
    Vec2 middle = vec_add(capsule_normal(a, sign), capsule_normal(b, sign));
    j.apart = vec_dot(middle, a->d) <= 0.0 && vec_dot(middle, b->d) >= 0.0;
    if (!j.apart)
        return j;
    double half = fabs(turn) / (1.0 + ahead); /* tangent of half the angle; a corner has about its third power by r² / 3 more than the disc */
    j.sharp = r2 * half * half * half < 6e-5;
    j.side = vec2(sign * middle.y, -sign * middle.x);
    return j;
}

/* May the disc reach the pixel? */
static bool is_near(Vec2 centre, double radius, Vec2 corner)
{
    double reach = radius + 0.7072;
    return vec_dist2(centre, vec2(corner.x + 0.5, corner.y + 0.5)) < reach * reach;
}

/* Is an end disc of another stroke within this one, so that the other one may be cut there? Of two that hold each other's ends one must stay whole: the `earlier`
 * one, or one whose ends are not in question. */
static bool holds(const Stroke *s, Vec2 centre, double radius, bool earlier)
{
    const Capsule *k = &s->shape;
    double t, along = vec_dot(vec_sub(centre, k->a), k->d);
    bool within = k->length > 0.0 && ((s->cut & CUT_A) != 0 || along >= radius) && ((s->cut & CUT_B) != 0 || along <= k->length - radius);
    return (earlier || within) && capsule_distance(k, centre, &t) + radius <= 1e-9;
}

/* Ends of a stroke that needn't be round: those at joints, and those that another stroke hides, as veins begin in veins. */
static unsigned plain_ends(const Tile *t, uint32_t pixel, uint32_t stroke, Vec2 corner)
{
    const Stroke *all = t->p->strokes->v, *s = &all[stroke];
    unsigned cut = s->cut;
    for (int end = 0; end < 2 && s->shape.length > 0.0; end++) {
        Vec2 c = end == 0 ? s->shape.a : s->shape.b;
        double r = end == 0 ? s->shape.ra : s->shape.rb;
        unsigned bit = end == 0 ? CUT_A : CUT_B;
        if ((cut & bit) != 0 || !is_near(c, r, corner))
            continue;
        for (uint32_t l = t->head[pixel]; l != NONE && (cut & bit) == 0; l = t->link[l].next)
            if (t->link[l].stroke != stroke && holds(&all[t->link[l].stroke], c, r, t->link[l].stroke < stroke))
                cut |= bit;
    }
    return cut;
}

static void tile_blade(Tile *t, TileBox box)
{
    ring_within(t->p->margin, t->p->n_margin, (Box2){box.x0, box.y0, box.x1, box.y1}, &t->blade, &t->spare);
    t->has_blade = true;
}

/* Strokes come last one first. */
static void add_strokes(Tile *t, uint32_t pixel, Vec2 corner)
{
    uint32_t place = 0;
    Joint after = {0}; /* with the one that comes next along the vein */
    union_reset(&t->area);
    for (uint32_t l = t->head[pixel]; l != NONE; l = t->link[l].next) {
        uint32_t stroke = t->link[l].stroke, next = t->link[l].next;
        const Stroke *s = &t->p->strokes->v[stroke];
        StrokeEnds ends = {plain_ends(t, pixel, stroke, corner), after.sharp ? CUT_B : CUT_NONE, {{0.0, 0.0}, after.side}};
        bool has_joint = (s->cut & CUT_A) != 0, has_next = has_joint && next != NONE && t->link[next].stroke + 1 == stroke;
        bool near = has_joint && is_near(s->shape.a, s->shape.ra, corner);
        Joint joint = near || has_next ? joint_of(s) : (Joint){0};
        after = has_next ? joint : (Joint){0};
        ends.mitre |= after.sharp ? CUT_A : CUT_NONE;
        ends.side[0] = vec2(-after.side.x, -after.side.y);
        union_add(&t->area, &s->shape, &ends, corner, place);
        if (near && joint.bent && !after.sharp)
            union_add_wedge(&t->area, s->shape.a, s->shape.ra, s[-1].shape.d, s->shape.d, corner, place + 1);
        place += after.apart ? 2 : 4;
    }
}

/* Veins end at the margin: what a first node on it or a wide vein in a narrow base has beyond is of the petiole. */
static float pixel_cover(Tile *t, TileBox box, uint32_t pixel, Vec2 corner, float blade)
{
    if (blade == 0.0f || t->full[pixel])
        return blade;
    if (t->head[pixel] == NONE)
        return 0.0f;
    add_strokes(t, pixel, corner);
    if (blade == 1.0f) {
        double area = union_area(&t->area);
        return (float)MIN(area, 1.0);
    }
    if (!t->has_blade)
        tile_blade(t, box);
    double area = union_area_within(&t->area, t->blade.v, t->blade.n_v, corner);
    return (float)MIN(area, (double)blade);
}

static void cover_tiles(uint32_t first, uint32_t last, void *user)
{
    const Painter *p = user;
    Tile *t = g_new0(Tile, 1);
    t->p = p;
    union_init(&t->area, p->circle);
    for (uint32_t tile = first; tile < last; tile++) {
        uint32_t from = p->bins.start[tile], to = p->bins.start[tile + 1];
        TileBox box = bins_tile(&p->bins, tile);
        if (from == to) {
            field_clear_tile(p, &p->cover, box);
            continue;
        }
        memset(t->full, 0, sizeof t->full);
        memset(t->head, 0xFF, sizeof t->head);
        t->n_links = 0;
        t->has_blade = false;
        for (uint32_t i = from; i < to; i++) {
            bins_ahead(&p->bins, i, to, p->strokes->v, sizeof *p->strokes->v);
            tile_enter(t, box, p->bins.item[i]);
        }
        for (uint32_t y = box.y0; y < box.y1; y++) {
            const float *blade = p->net->margin != NULL ? field_row(p, &p->blade, y) : NULL;
            float *out = field_row(p, &p->cover, y);
            for (uint32_t x = box.x0; x < box.x1; x++)
                out[x] = pixel_cover(t, box, (y - box.y0) * TILE + x - box.x0, vec2(x, y), blade != NULL ? blade[x] : 1.0f);
        }
    }
    union_clear(&t->area);
    rings_clear(&t->blade);
    rings_clear(&t->spare);
    g_free(t->link);
    g_free(t);
}

const float *painter_cover(Painter *p)
{
    painter_strokes(p);
    if (p->net->margin != NULL)
        painter_blade(p);
    painter_tiles(p, &p->bins, field_begin(p, &p->cover), cover_tiles, p);
    return p->cover.px;
}

/* ---- blade ---- */

/* Adds the signed area to the right of the part of a segment within row y (0 <= its y <= 1) to the sums of its pixels.
 * sum[x] gathers what pixel x gets beyond what all pixels right of an edge get, so that prefix sums give areas. */
static void add_segment(double *sum, uint32_t width, Vec2 a, Vec2 b)
{
    double dy = b.y - a.y;
    if (dy == 0.0)
        return;
    if (a.x > b.x) {
        Vec2 swap = a;
        a = b;
        b = swap;
    }
    double x = a.x, y = a.y;
    while (x < b.x || y != b.y) {
        double next = floor(x) + 1.0, part_y;
        if (next >= b.x) {
            next = b.x;
            part_y = b.y;
        } else {
            part_y = a.y + (b.y - a.y) * ((next - a.x) / (b.x - a.x));
        }
        double h = dy > 0.0 ? fabs(part_y - y) : -fabs(part_y - y);
        double cell = floor(x), mid = 0.5 * (x + next) - cell;
        if (cell < 0.0) {
            sum[0] += h;
        } else if (cell < width) {
            uint32_t i = (uint32_t)cell;
            sum[i] += h * (1.0 - mid);
            sum[i + 1] += h * mid;
        }
        x = next;
        y = part_y;
    }
}

/* One edge's share of row y. */
static void add_edge(double *sum, uint32_t width, uint32_t y, Vec2 a, Vec2 b)
{
    double low = MAX(MIN(a.y, b.y), (double)y), high = MIN(MAX(a.y, b.y), y + 1.0);
    if (!(high > low))
        return;
    double from = a.y < b.y ? low : high, to = a.y < b.y ? high : low, k = (b.x - a.x) / (b.y - a.y);
    Vec2 p = {from == a.y ? a.x : a.x + (from - a.y) * k, from}, q = {to == b.y ? b.x : a.x + (to - a.y) * k, to};
    /* parts left of the image count in full, parts right of it not at all */
    if (MAX(p.x, q.x) <= 0.0)
        sum[0] += to - from;
    else
        add_segment(sum, width, p, q);
}

/* Holes turn the other way round than the margin, so they take away what it gave. */
static void blade_row(uint32_t y, void *user)
{
    const Painter *p = user;
    double *sum = g_new0(double, (gsize)p->width + 2), area = 0.0;
    for (uint32_t i = 0; i < p->n_margin; i++)
        add_edge(sum, p->width, y, p->margin[i], p->margin[i + 1 < p->n_margin ? i + 1 : 0]);
    for (uint32_t i = p->n_margin; i < p->n_edges; i++)
        add_edge(sum, p->width, y, p->edge[i].a, p->edge[i].b);
    float *out = field_row(p, &p->blade, y);
    for (uint32_t x = 0; x < p->width; x++) {
        area += sum[x];
        double part = MAX(area, 0.0); /* a hole may lie across the margin */
        /* what rounding leaves of sums that cancel */
        out[x] = part < 1e-7 ? 0.0f : part > 1.0 - 1e-7 ? 1.0f : (float)part;
    }
    g_free(sum);
}

const float *painter_blade(Painter *p)
{
    uint32_t from = field_begin(p, &p->blade);
    if (from < p->bottom && p->net->margin != NULL) {
        painter_rows(p, from, p->bottom, blade_row, p);
    } else if (from < p->bottom) { /* veins without a blade */
        painter_cover(p);
        memcpy(field_row(p, &p->blade, from), field_row(p, &p->cover, from), (gsize)(p->bottom - from) * p->width * sizeof(float));
    }
    return p->blade.px;
}
