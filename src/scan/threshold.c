#include "scan/threshold_sheet.h"

#include <string.h>

#define GREEN_NEAR 0.9  /* of the best separability */
#define GREEN_OTHER 1.2 /* times as much leaf */
#define LEAST_CONTRAST 0.02
#define SATURATION_HANDICAP 0.01 /* in separability: its outlines lie off by some of a pixel where leaf and paper share one */

const char *channel_name(Channel channel)
{
    static const char *const name[CHANNEL_COUNT] = {"best", "red", "green", "blue", "grey", "saturation", "greenness", "alpha"};
    return name[channel];
}

/* Pixels of one row as R, G, B (alpha taken off) and alpha, whatever the scan holds. */
typedef struct {
    uint32_t width, most;
    uint16_t *rgb, *alpha, *value;
} Row;

static void row_init(Row *r, const Scan *s)
{
    r->width = s->width;
    r->most = s->depth == 8 ? 255 : 65535;
    r->rgb = g_new(uint16_t, 3 * (gsize)s->width);
    r->alpha = g_new(uint16_t, s->width);
    r->value = g_new(uint16_t, s->width);
}

static void row_clear(Row *r)
{
    g_free(r->rgb);
    g_free(r->alpha);
    g_free(r->value);
}

/* `a` of a colour over white. */
static inline uint32_t over_white(uint32_t colour, uint32_t a, uint32_t most)
{
    return (uint32_t)(((uint64_t)colour * a + (uint64_t)most * (most - a) + most / 2) / most);
}

static inline void pixel_rgba(const Scan *s, uint32_t most, uint32_t x, uint32_t y, uint32_t rgba[4])
{
    uint32_t n = s->channels, colours = n < 3 ? 1 : 3;
    rgba[3] = n == colours ? most : scan_sample(s, x, y, n - 1);
    for (uint32_t c = 0; c < 3; c++) {
        uint32_t v = scan_sample(s, x, y, colours == 1 ? 0 : c);
        rgba[c] = rgba[3] == most ? v : over_white(v, rgba[3], most);
    }
}

static void row_load(Row *r, const Scan *s, uint32_t y)
{
    uint32_t n = s->channels, w = s->width;
    gsize at = (gsize)y * w * n;
    if (n == 3 && s->depth == 8) {
        const uint8_t *in = (const uint8_t *)s->px + at;
        for (gsize i = 0; i < 3 * (gsize)w; i++)
            r->rgb[i] = in[i];
        return;
    }
    if (n == 3) {
        memcpy(r->rgb, (const uint16_t *)s->px + at, 6 * (gsize)w);
        return;
    }
    if (n == 1) {
        for (uint32_t x = 0; x < w; x++)
            for (int c = 0; c < 3; c++)
                r->rgb[3 * (gsize)x + c] = s->depth == 8 ? ((const uint8_t *)s->px)[at + x] : ((const uint16_t *)s->px)[at + x];
        return;
    }
    for (uint32_t x = 0; x < w; x++) {
        uint32_t rgba[4];
        pixel_rgba(s, r->most, x, y, rgba);
        for (int c = 0; c < 3; c++)
            r->rgb[3 * (gsize)x + c] = (uint16_t)rgba[c];
        r->alpha[x] = (uint16_t)rgba[3];
    }
}

/* Each channel rounded to a whole number of 0 … most. */
static inline uint16_t channel_of(Channel channel, uint32_t r, uint32_t g, uint32_t b, uint32_t alpha, uint32_t most)
{
    uint32_t high = MAX(MAX(r, g), b), low = MIN(MIN(r, g), b);
    switch (channel) {
    case CHANNEL_RED: return (uint16_t)r;
    case CHANNEL_GREEN: return (uint16_t)g;
    case CHANNEL_BLUE: return (uint16_t)b;
    case CHANNEL_GREY: return (uint16_t)((299 * r + 587 * g + 114 * b + 500) / 1000);
    case CHANNEL_SATURATION: return (uint16_t)((float)(high - low) / (float)(high ? high : 1) * (float)most + 0.5f);
    case CHANNEL_GREENNESS: return (uint16_t)((2 * g + 2 * most - r - b) / 4);
    default: return (uint16_t)alpha;
    }
}

static void row_channel(Row *r, Channel channel)
{
    const uint16_t *p = r->rgb;
#define EACH(c)                                                                                                                      \
    case c:                                                                                                                          \
        for (uint32_t x = 0; x < r->width; x++)                                                                                      \
            r->value[x] = channel_of(c, p[3 * (gsize)x], p[3 * (gsize)x + 1], p[3 * (gsize)x + 2], 0, r->most);                      \
        break
    switch (channel) {
        EACH(CHANNEL_RED);
        EACH(CHANNEL_GREEN);
        EACH(CHANNEL_BLUE);
        EACH(CHANNEL_GREY);
        EACH(CHANNEL_SATURATION);
        EACH(CHANNEL_GREENNESS);
    default:
        memcpy(r->value, r->alpha, sizeof *r->value * r->width);
    }
#undef EACH
}

uint32_t channel_value(const Scan *s, Channel channel, uint32_t x, uint32_t y)
{
    uint32_t rgba[4], most = s->depth == 8 ? 255 : 65535;
    pixel_rgba(s, most, x, y, rgba);
    return channel_of(channel, rgba[0], rgba[1], rgba[2], rgba[3], most);
}

/* Whether the image has it. */
static bool has_channel(const Scan *s, Channel channel)
{
    if (channel == CHANNEL_ALPHA)
        return s->channels == 2 || s->channels == 4;
    return channel == CHANNEL_GREY || (channel != CHANNEL_BEST && s->channels >= 3);
}

/* Counts of the values, over the whole image and over its frame. Even and odd columns are counted apart at first, since equal neighbours would
 * wait for each other. */
typedef struct {
    uint32_t bins;
    uint32_t *count[CHANNEL_COUNT], *odd[CHANNEL_COUNT], *frame[CHANNEL_COUNT]; /* NULL: not wanted */
} Histograms;

/* Columns from … to - 1 of a row; those up to left - 1 and from right on are of the frame. */
typedef struct {
    uint32_t from, to, left, right;
} Span;

static void count_row(Histograms *h, Channel c, const Row *row, const Span *span)
{
    uint32_t *count = h->count[c], *odd = h->odd[c], *frame = h->frame[c], x = span->from;
    for (; x + 1 < span->to; x += 2) {
        count[row->value[x]]++;
        odd[row->value[x + 1]]++;
    }
    if (x < span->to)
        count[row->value[x]]++;
    for (x = span->from; x < span->left; x++)
        frame[row->value[x]]++;
    for (x = span->right; x < span->to; x++)
        frame[row->value[x]]++;
}

/* Of the sheet, or of all of the image; false where it has nothing of a row. The frame is what has a neighbour beyond. */
static bool span_of(const Scan *s, const Paper *sheet, uint32_t y, Span *out)
{
    *out = (Span){0, s->width, 0, 0};
    if (sheet->n > 0 && !paper_span(sheet, s->width, y, &out->from, &out->to))
        return false;
    uint32_t most = out->from + 1, least = out->to - 1;
    for (uint32_t k = 0; k < 2; k++) {
        uint32_t from = out->from, to = out->to;
        if ((k ? y + 1 == s->height : y == 0) || (sheet->n > 0 && !paper_span(sheet, s->width, k ? y + 1 : y - 1, &from, &to)))
            from = to = out->to;
        most = MAX(most, MIN(from, out->to));
        least = MIN(least, MAX(to, out->from));
    }
    out->left = most;
    out->right = MAX(least, most);
    return true;
}

static void histograms_init(Histograms *h, const Scan *s, Channel wanted, const Paper *sheet)
{
    *h = (Histograms){.bins = s->depth == 8 ? 256 : 65536};
    Row row;
    row_init(&row, s);
    for (Channel c = CHANNEL_RED; c < CHANNEL_COUNT; c++) {
        if (!has_channel(s, c) || (wanted != CHANNEL_BEST && wanted != c))
            continue;
        h->count[c] = g_new0(uint32_t, h->bins);
        h->odd[c] = g_new0(uint32_t, h->bins);
        h->frame[c] = g_new0(uint32_t, h->bins);
    }
    for (uint32_t y = 0; y < s->height; y++) {
        Span span;
        if (!span_of(s, sheet, y, &span))
            continue;
        row_load(&row, s, y);
        for (Channel c = CHANNEL_RED; c < CHANNEL_COUNT; c++) {
            if (!h->count[c])
                continue;
            row_channel(&row, c);
            count_row(h, c, &row, &span);
        }
    }
    for (Channel c = CHANNEL_RED; c < CHANNEL_COUNT; c++)
        for (uint32_t i = 0; h->count[c] && i < h->bins; i++)
            h->count[c][i] += h->odd[c][i];
    row_clear(&row);
}

static void histograms_clear(Histograms *h)
{
    for (Channel c = 0; c < CHANNEL_COUNT; c++) {
        g_free(h->count[c]);
        g_free(h->odd[c]);
        g_free(h->frame[c]);
    }
}

/* Numbers and sums of a histogram's values below a bin and in all. */
typedef struct {
    double n, sum, n0, sum0, total; /* total: sum of squared distances from the mean */
} Moments;

static Moments moments(const uint32_t *count, uint32_t bins)
{
    Moments m = {0};
    for (uint32_t i = 0; i < bins; i++) {
        m.n += count[i];
        m.sum += (double)i * count[i];
    }
    double mean = m.sum / m.n;
    for (uint32_t i = 0; i < bins; i++)
        m.total += count[i] * (i - mean) * (i - mean);
    return m;
}

/* Variance between the classes (times n), and the distance of their means. */
static double between(const Moments *m, double *distance)
{
    double n1 = m->n - m->n0;
    *distance = m->n0 > 0.0 && n1 > 0.0 ? (m->sum - m->sum0) / n1 - m->sum0 / m->n0 : 0.0;
    return m->n0 * n1 / m->n * *distance * *distance;
}

/* How well a level parts the values. */
static void judge(const uint32_t *count, uint32_t bins, Threshold *t)
{
    Moments m = moments(count, bins);
    for (uint32_t i = 0; i < bins && i < t->level; i++) {
        m.n0 += count[i];
        m.sum0 += (double)i * count[i];
    }
    double distance, variance = between(&m, &distance);
    t->separability = m.total > 0.0 ? variance / m.total : 0.0;
    t->contrast = distance / (bins - 1);
}

/* Otsu's level: between the two values where the variance between the classes is greatest. */
static double otsu(const uint32_t *count, uint32_t bins)
{
    Moments m = moments(count, bins);
    double most = -1.0, level = 0.0, distance;
    for (uint32_t i = 0; i < bins; i++) {
        if (!count[i])
            continue;
        m.n0 += count[i];
        m.sum0 += (double)i * count[i];
        double variance = between(&m, &distance);
        if (!(variance > most))
            continue;
        most = variance;
        uint32_t next = i + 1;
        while (next < bins && !count[next])
            next++;
        level = 0.5 * ((double)i + (double)MIN(next, bins));
    }
    return level;
}

static Threshold threshold_of(const Histograms *h, Channel c, double level)
{
    Threshold t = {.channel = c, .level = level < 0.0 ? otsu(h->count[c], h->bins) : h->bins == 256 ? level : level * 257.0};
    judge(h->count[c], h->bins, &t);
    return t;
}

static void set_side(const Histograms *h, LeafSide side, Threshold *t)
{
    double below = 0.0, all = 0.0;
    for (uint32_t i = 0; i < h->bins; i++) {
        below += i < t->level ? h->frame[t->channel][i] : 0;
        all += h->frame[t->channel][i];
    }
    t->dark = side == LEAF_DARK || (side == LEAF_BY_FRAME && below <= 0.5 * all);
    t->frame = (t->dark ? all - below : below) / all;
    below = all = 0.0;
    for (uint32_t i = 0; i < h->bins; i++) {
        below += i < t->level ? h->count[t->channel][i] : 0;
        all += h->count[t->channel][i];
    }
    t->leaf = (t->dark ? below : all - below) / all;
}

/* Otsu's measure tells how well two classes are parted, not which of them is a leaf; that leaves are green tells more where classes differ. */
static void ask_greenness(const Histograms *h, const ThresholdDef *def, Threshold *t)
{
    if (def->channel != CHANNEL_BEST || def->level >= 0.0 || !h->count[CHANNEL_GREENNESS])
        return;
    Threshold green = threshold_of(h, CHANNEL_GREENNESS, def->level);
    set_side(h, def->side, &green);
    if (green.dark || green.separability < GREEN_NEAR * t->separability || green.contrast < LEAST_CONTRAST)
        return;
    if (green.leaf > t->leaf * GREEN_OTHER)
        *t = green;
    else if (green.leaf * GREEN_OTHER < t->leaf)
        t->green = green.leaf;
}

static bool check(const Scan *s, const ThresholdDef *def, GError **error)
{
    if (def->channel != CHANNEL_BEST && !has_channel(s, def->channel)) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE, "channel '%s': the image has none; it is %s%s", channel_name(def->channel),
                    s->channels < 3 ? "grey" : "RGB", s->channels == 2 || s->channels == 4 ? " with alpha" : " without alpha");
        return false;
    }
    if (!(def->level <= 255.0)) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE, "threshold %g: allowed are 0 … 255, or less than 0 to find one", def->level);
        return false;
    }
    return true;
}

void threshold_find_on(const Scan *s, const ThresholdDef *def, const Paper *sheet, Threshold *out)
{
    Histograms h;
    histograms_init(&h, s, def->channel, sheet);
    double best = -1.0;
    for (Channel c = CHANNEL_RED; c < CHANNEL_COUNT; c++) {
        if (!h.count[c] || (c == CHANNEL_GREENNESS && def->channel == CHANNEL_BEST))
            continue;
        Threshold t = threshold_of(&h, c, def->level);
        double score = t.separability - (c == CHANNEL_SATURATION ? SATURATION_HANDICAP : 0.0);
        if (score > best) {
            best = score;
            *out = t;
        }
    }
    set_side(&h, def->side, out);
    ask_greenness(&h, def, out);
    out->sheet = *sheet;
    histograms_clear(&h);
}

bool threshold_find(const Scan *s, const ThresholdDef *def, Threshold *out, GError **error)
{
    static const Paper whole = {0};
    if (!check(s, def, error))
        return false;
    threshold_find_on(s, def, &whole, out);
    if (def->level < 0.0 && !(out->contrast >= LEAST_CONTRAST)) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_NO_LEAF,
                    "no leaf: the image is all of one shade (parted by %s as well as it goes, its darker and lighter pixels differ by %.2g %% of the scale; at least %g %% are needed)",
                    channel_name(out->channel), 100.0 * out->contrast, 100.0 * LEAST_CONTRAST);
        return false;
    }
    if (def->level < 0.0 && def->side == LEAF_BY_FRAME && !(def->channel == CHANNEL_BEST && threshold_look_for_sheet(s, def, out)))
        threshold_look_at_sides(s, out);
    return true;
}

void threshold_apply(const Scan *s, const Threshold *t, uint8_t *mask)
{
    Row row;
    row_init(&row, s);
    for (uint32_t y = 0; y < s->height; y++) {
        uint8_t *out = mask + (gsize)y * s->width;
        uint32_t from = 0, to = s->width;
        if (t->sheet.n > 0) {
            memset(out, 0, s->width);
            if (!paper_span(&t->sheet, s->width, y, &from, &to))
                continue;
        }
        row_load(&row, s, y);
        row_channel(&row, t->channel);
        for (uint32_t x = from; x < to; x++)
            out[x] = ((double)row.value[x] < t->level) == t->dark;
    }
    row_clear(&row);
}
