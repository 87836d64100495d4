#include "scan/stalk.h"

#include <string.h>

#define THIN 0.17        /* disc that parts thin from broad, share of the greatest half width */
#define LOOSE 1.3        /* disc that shows where the stalk ends, share of its half width */
#define LEAST_LENGTH 1.0 /* stalk widths */
#define LEAST_WIDTH 0.1  /* share of the radius of the disc that parts thin from broad; thinner ones are hairs and slits */
#define LEAST_TAPER 0.67 /* width near its end, share of that near the blade; of a straight tip it is 0.3, of a parabolic one 0.55 */
#define MOST_AREA 0.25   /* share of the whole */

typedef struct {
    uint32_t x, y;
} Pixel;

static inline bool has(const Mask *m, int64_t x, int64_t y, uint8_t bit)
{
    return x >= 0 && y >= 0 && x < m->width && y < m->height && (*mask_at(m, (uint32_t)x, (uint32_t)y) & bit);
}

static const int8_t AROUND[8][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};

/* MASK_CORE becomes the largest part of what an opening leaves. */
static void set_core(const Mask *m, double r)
{
    static const Flood seek = {MASK_CORE | MASK_WORK, MASK_CORE, MASK_WORK, true};
    mask_erode(m, MASK_THIS, MASK_CORE, r);
    mask_dilate(m, MASK_CORE, MASK_CORE, r);
    uint64_t most = 0;
    Pixel best = {0, 0};
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            if ((*mask_at(m, x, y) & seek.test) != seek.want)
                continue;
            uint64_t n = mask_flood(m, &seek, x, y, NULL);
            if (n > most) {
                most = n;
                best = (Pixel){x, y};
            }
        }
    mask_clear(m, MASK_WORK);
    if (most > 0)
        mask_flood(m, &seek, best.x, best.y, NULL);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            uint8_t *px = mask_at(m, x, y);
            *px = (uint8_t)((*px & ~(MASK_CORE | MASK_WORK)) | (*px & MASK_WORK ? MASK_CORE : 0));
        }
}

/* Pixels of the part around `first` that is not core; they get MASK_WORK. */
static void gather(const Mask *m, Pixel first, GArray *part)
{
    g_array_set_size(part, 0);
    g_array_append_val(part, first);
    *mask_at(m, first.x, first.y) |= MASK_WORK;
    for (guint i = 0; i < part->len; i++) {
        Pixel p = g_array_index(part, Pixel, i);
        for (int k = 0; k < 8; k++) {
            int64_t x = (int64_t)p.x + AROUND[k][0], y = (int64_t)p.y + AROUND[k][1];
            if (!has(m, x, y, MASK_THIS) || has(m, x, y, MASK_CORE | MASK_WORK))
                continue;
            Pixel next = {(uint32_t)x, (uint32_t)y};
            *mask_at(m, next.x, next.y) |= MASK_WORK;
            g_array_append_val(part, next);
        }
    }
}

static bool touches_core(const Mask *m, Pixel p)
{
    for (int k = 0; k < 8; k++)
        if (has(m, (int64_t)p.x + AROUND[k][0], (int64_t)p.y + AROUND[k][1], MASK_CORE))
            return true;
    return false;
}

/* A part seen from where it meets the core: how many pixels are how many steps away. Steps go over edges and over edges and corners by turns, so
 * that about as much is reached in every direction. */
typedef struct {
    GArray *part, *front, *next, *count; /* Pixel, Pixel, Pixel, uint32_t */
    Vec2 base;
    Pixel end;
    bool one_side; /* it meets the core in one place */
} Probe;

static Vec2 middle(const GArray *pixels)
{
    Vec2 sum = vec2(0.0, 0.0);
    for (guint i = 0; i < pixels->len; i++) {
        Pixel p = g_array_index(pixels, Pixel, i);
        sum = vec_add(sum, vec2(p.x, p.y));
    }
    return vec_scale(sum, 1.0 / pixels->len);
}

/* The one of the pixels that is nearest to their middle. */
static Pixel middle_one(const GArray *pixels)
{
    Vec2 m = middle(pixels);
    Pixel best = g_array_index(pixels, Pixel, 0);
    for (guint i = 1; i < pixels->len; i++) {
        Pixel p = g_array_index(pixels, Pixel, i);
        if (vec_dist2(vec2(p.x, p.y), m) < vec_dist2(vec2(best.x, best.y), m))
            best = p;
    }
    return best;
}

/* One step from the front into pixels with MASK_WORK, which they lose. */
static void advance(const Mask *m, Probe *p, bool corners)
{
    g_array_set_size(p->next, 0);
    for (guint i = 0; i < p->front->len; i++) {
        Pixel at = g_array_index(p->front, Pixel, i);
        for (int k = 0; k < (corners ? 8 : 4); k++) {
            int64_t x = (int64_t)at.x + AROUND[k][0], y = (int64_t)at.y + AROUND[k][1];
            if (!has(m, x, y, MASK_WORK))
                continue;
            Pixel next = {(uint32_t)x, (uint32_t)y};
            *mask_at(m, next.x, next.y) &= (uint8_t)~MASK_WORK;
            g_array_append_val(p->next, next);
        }
    }
    GArray *was = p->front;
    p->front = p->next;
    p->next = was;
}

/* The pixels of the part that touch the core become the front, and whether they hang together. */
static void start(const Mask *m, Probe *p)
{
    g_array_set_size(p->front, 0);
    for (guint i = 0; i < p->part->len; i++) {
        Pixel at = g_array_index(p->part, Pixel, i);
        if (touches_core(m, at))
            g_array_append_val(p->front, at);
        else
            *mask_at(m, at.x, at.y) &= (uint8_t)~MASK_WORK;
    }
    p->base = middle(p->front);
    GArray *contact = p->front;
    guint n = contact->len, longest = 0;
    p->front = g_array_new(FALSE, FALSE, sizeof(Pixel));
    for (guint i = 0; i < n; i++) { /* only they have MASK_WORK now */
        Pixel at = g_array_index(contact, Pixel, i);
        if (!has(m, at.x, at.y, MASK_WORK))
            continue;
        *mask_at(m, at.x, at.y) &= (uint8_t)~MASK_WORK;
        g_array_set_size(p->front, 0);
        g_array_append_val(p->front, at);
        guint reached = 0;
        for (; p->front->len > 0; advance(m, p, true))
            reached += p->front->len;
        longest = MAX(longest, reached);
    }
    p->one_side = longest > n - n / 8 - 1;
    g_array_free(p->front, TRUE);
    p->front = contact;
}

static void probe(const Mask *m, Probe *p)
{
    start(m, p);
    for (guint i = 0; i < p->part->len; i++) {
        Pixel at = g_array_index(p->part, Pixel, i);
        *mask_at(m, at.x, at.y) |= MASK_WORK;
    }
    for (guint i = 0; i < p->front->len; i++) {
        Pixel at = g_array_index(p->front, Pixel, i);
        *mask_at(m, at.x, at.y) &= (uint8_t)~MASK_WORK;
    }
    g_array_set_size(p->count, 0);
    for (bool corners = false; p->front->len > 0; corners = !corners) {
        uint32_t n = p->front->len;
        p->end = middle_one(p->front);
        g_array_append_val(p->count, n);
        advance(m, p, corners);
    }
}

static double mean_count(const Probe *p, double from, double to)
{
    guint a = (guint)(from * p->count->len), b = MAX((guint)(to * p->count->len), a + 1);
    double sum = 0.0;
    for (guint i = a; i < b; i++)
        sum += g_array_index(p->count, uint32_t, i);
    return sum / (b - a);
}

static gint smaller_first(gconstpointer a, gconstpointer b, gpointer user)
{
    return (*(const uint32_t *)a > *(const uint32_t *)b) - (*(const uint32_t *)a < *(const uint32_t *)b);
}

/* Mean of the middle half of the counts. */
static double usual_count(const Probe *p)
{
    guint n = p->count->len, from = n / 4, to = n - from;
    uint32_t *sorted = g_memdup2(p->count->data, n * sizeof(uint32_t));
    g_qsort_with_data(sorted, (gint)n, sizeof(uint32_t), smaller_first, NULL);
    double sum = 0.0;
    for (guint i = from; i < to; i++)
        sum += sorted[i];
    g_free(sorted);
    return sum / (to - from);
}

static void describe(const Probe *p, Stalk *s)
{
    *s = (Stalk){p->base, vec2(p->end.x, p->end.y), usual_count(p), p->count->len, p->part->len};
}

static bool is_stalk(const Probe *p, double r, uint64_t whole)
{
    Stalk s;
    describe(p, &s);
    return p->one_side && s.width >= LEAST_WIDTH * r && s.length >= LEAST_LENGTH * s.width && (double)s.area <= MOST_AREA * (double)whole &&
           mean_count(p, 0.7, 0.9) >= LEAST_TAPER * mean_count(p, 0.2, 0.5);
}

/* The largest stalk among the parts that are not core. */
static bool find_largest(const Mask *m, Probe *p, double r, uint64_t whole, Stalk *out)
{
    bool found = false;
    /* Parts that were looked at are told by MASK_STALK, for probing takes MASK_WORK off. */
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            if ((*mask_at(m, x, y) & (MASK_THIS | MASK_CORE | MASK_STALK)) != MASK_THIS)
                continue;
            gather(m, (Pixel){x, y}, p->part);
            for (guint i = 0; i < p->part->len; i++) {
                Pixel at = g_array_index(p->part, Pixel, i);
                *mask_at(m, at.x, at.y) |= MASK_STALK;
            }
            probe(m, p);
            if (!is_stalk(p, r, whole) || (found && p->part->len <= out->area))
                continue;
            describe(p, out);
            found = true;
        }
    mask_clear(m, MASK_STALK);
    return found;
}

/* The part that holds the stalk's end once more, with a core that reaches as far along the stalk as that is broader than the disc. */
static bool refine(const Mask *m, Probe *p, double r, Stalk *s)
{
    Pixel first = {(uint32_t)s->end.x, (uint32_t)s->end.y};
    set_core(m, r);
    if (has(m, first.x, first.y, MASK_CORE))
        return false;
    gather(m, first, p->part);
    probe(m, p);
    describe(p, s);
    return true;
}

static void mark(const Mask *m, const Probe *p)
{
    for (guint i = 0; i < p->part->len; i++) {
        Pixel at = g_array_index(p->part, Pixel, i);
        *mask_at(m, at.x, at.y) |= MASK_STALK;
    }
}

bool stalk_find(const Mask *w, Stalk *out)
{
    double r = THIN * mask_widest(w, MASK_THIS);
    if (r < 1.5)
        return false;
    Probe p = {.part = g_array_new(FALSE, FALSE, sizeof(Pixel)), .front = g_array_new(FALSE, FALSE, sizeof(Pixel)),
               .next = g_array_new(FALSE, FALSE, sizeof(Pixel)), .count = g_array_new(FALSE, FALSE, sizeof(uint32_t))};
    uint64_t whole = 0;
    for (uint32_t y = 0; y < w->height; y++)
        for (uint32_t x = 0; x < w->width; x++)
            whole += (*mask_at(w, x, y) & MASK_THIS) != 0;
    set_core(w, r);
    bool found = find_largest(w, &p, r, whole, out);
    if (found) {
        if (!refine(w, &p, MIN(r, LOOSE * 0.5 * out->width + 1.0), out))
            refine(w, &p, r, out);
        mark(w, &p);
    }
    mask_clear(w, MASK_CORE | MASK_WORK);
    g_array_free(p.part, TRUE);
    g_array_free(p.front, TRUE);
    g_array_free(p.next, TRUE);
    g_array_free(p.count, TRUE);
    return found;
}
