#include "scan/fang_rough.h"

/* Radius of the disc that threads have no room for, pixels. What is nearer than STUB such radii to what is wider stays: tips of teeth. */
#define THREAD 2.5
#define STUB 2.0

/* Of the pixels in a window, keeps those with all bits of `which` as MASK_LEAF; returns how many. */
static uint64_t keep(const Mask *w, uint8_t which)
{
    uint64_t n = 0;
    for (uint32_t y = 0; y < w->height; y++)
        for (uint32_t x = 0; x < w->width; x++) {
            uint8_t *px = mask_at(w, x, y);
            *px = (*px & which) == which ? MASK_LEAF : 0;
            n += *px != 0;
        }
    return n;
}

/* A leaf that is all thread stays as it is. What a thread joined to the leaf goes with it. */
static void take_off_threads(const Mask *w)
{
    mask_erode(w, MASK_LEAF, MASK_CORE, THREAD);
    mask_dilate(w, MASK_CORE, MASK_CORE, (1.0 + STUB) * THREAD);
    bool any = false;
    for (uint32_t y = 0; y < w->height && !any; y++)
        for (uint32_t x = 0; x < w->width && !any; x++)
            any = (*mask_at(w, x, y) & MASK_CORE) != 0;
    keep(w, any ? MASK_LEAF | MASK_CORE : MASK_LEAF);
}

/* One of the parts that are marked, with what it encloses, and nothing else. */
static void keep_part(const Mask *m, const Component *part)
{
    mask_take(m, part);
    keep(m, MASK_THIS);
}

/* The part with most pixels in a window; mask_components would pass over one along its edge, as the lid of a scanner. */
static Component largest_part(const Mask *w)
{
    static const Flood part = {MASK_LEAF | MASK_SEEN, MASK_LEAF, MASK_SEEN, true};
    Component best = {0};
    for (uint32_t y = 0; y < w->height; y++)
        for (uint32_t x = 0; x < w->width; x++) {
            Component c = {0, x, y, {0}};
            if ((*mask_at(w, x, y) & part.test) != part.want)
                continue;
            c.area = mask_flood(w, &part, x, y, &c.box);
            best = c.area > best.area ? c : best;
        }
    return best;
}

static bool no_leaf(const Threshold *t, guint n, uint32_t leaf, GError **error)
{
    if (n == 0)
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_NO_LEAF, "no leaf: nothing is %s than %g in the %s channel but the edge of the image",
                    t->dark ? "darker" : "lighter", t->level, channel_name(t->channel));
    else
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE, "scan.leaf is %u, but there %s %u in the image", leaf, n == 1 ? "is" : "are", n);
    return false;
}

static bool check(const FangDef *d, GError **error)
{
    const struct {
        const char *name;
        double value, least, most;
    } range[] = {{"closing radius", d->close, 0.0, 65535.0}, {"opening radius", d->open, 0.0, 65535.0}, {"least area", d->least_area, 0.0, 1.0},
                 {"number of the leaf", d->leaf, 1.0, (double)G_MAXUINT32}};
    for (guint k = 0; k < G_N_ELEMENTS(range); k++)
        if (!(range[k].value >= range[k].least && range[k].value <= range[k].most)) {
            g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE, "%s %g: allowed are %g … %g", range[k].name, range[k].value, range[k].least,
                        range[k].most);
            return false;
        }
    return true;
}

bool fang_rough(const Scan *s, const Threshold *t, const FangDef *def, const Mask *m, MaskBox *box, GError **error)
{
    if (!check(def, error))
        return false;
    threshold_apply(s, t, m->px);
    if (def->close > 0.0) {
        mask_dilate(m, MASK_LEAF, MASK_LEAF, def->close);
        mask_erode(m, MASK_LEAF, MASK_LEAF, def->close);
    }
    if (def->open > 0.0) {
        mask_erode(m, MASK_LEAF, MASK_LEAF, def->open);
        mask_dilate(m, MASK_LEAF, MASK_LEAF, def->open);
    }
    GArray *parts = mask_components(m, def->least_area);
    bool ok = def->leaf <= parts->len || no_leaf(t, parts->len, def->leaf, error);
    if (ok) {
        const Component *leaf = &g_array_index(parts, Component, def->leaf - 1);
        keep_part(m, leaf);
        *box = leaf->box;
        Mask w = mask_window(m, *box);
        take_off_threads(&w);
        Component whole = largest_part(&w);
        keep_part(&w, &whole);
    }
    g_array_free(parts, TRUE);
    return ok;
}
