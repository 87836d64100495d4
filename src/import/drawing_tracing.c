/* Tracings of veins as text: lines, or the outline of a whole vein system, which is filled and thinned. */
#include <string.h>

#include "geom/textfile.h"
#include "geom/tracing.h"
#include "import/drawing_file.h"
#include "import/names.h"
#include "scan/centre.h"

enum {
    LARGEST_FILE = 16 << 20, /* bytes: some million points */
    RASTER = 8000000,        /* pixels that an outline is filled in, or some more */
    MARGIN = 2,              /* of them, around it */
};

#define MEETS 3.0    /* pixels between the ends of what is closed */

/* How an outline of veins differs from a vein: its ends are no farther apart than some of its mean width, and it is slender; from a
 * blade: nowhere as wide as this share of its longer side. */
#define END_WIDTHS 6.0
#define ROUNDEST 0.3 /* 4 π area / perimeter² */
#define WIDEST 0.25

/* A polyline of the file. */
typedef struct {
    guint first, n, line; /* points; where it begins */
    char *name;
} Stroke;

typedef struct {
    const char *path;
    GArray *point, *stroke; /* Vec2, y down; Stroke */
    char *heading;          /* letters before the next stroke, or NULL */
    bool open;              /* the last stroke goes on */
    GError **error;
} Reading;

static bool bad_line(const Reading *r, guint line, const char *text, const char *what)
{
    char *valid = g_utf8_make_valid(text, -1), *quoted = names_quote(valid);
    g_set_error(r->error, IMPORT_ERROR, IMPORT_ERROR_SYNTAX, "%s:%u: %s %s", r->path, line, quoted, what);
    g_free(quoted);
    g_free(valid);
    return false;
}

static void end_stroke(Reading *r) { r->open = false; }

static void add_point(Reading *r, Vec2 p, guint line)
{
    if (!r->open) {
        Stroke s = {.first = r->point->len, .line = line, .name = r->heading};
        r->heading = NULL;
        r->open = true;
        g_array_append_val(r->stroke, s);
    }
    Stroke *s = &g_array_index(r->stroke, Stroke, r->stroke->len - 1);
    const Vec2 *last = s->n > 0 ? &g_array_index(r->point, Vec2, r->point->len - 1) : NULL;
    if (last && last->x == p.x && last->y == p.y)
        return; /* a double click */
    g_array_append_val(r->point, p);
    s->n++;
}

/* The words of a line that has no end: how many are numbers, how many are not; the first three numbers to v. */
static void count_words(const char *s, double v[3], guint *numbers, guint *others)
{
    *numbers = *others = 0;
    while (tracing_is_gap(*s))
        s++;
    while (*s != '\0') {
        char *end;
        double value = g_ascii_strtod(s, &end);
        if (end != s && (*end == '\0' || tracing_is_gap(*end))) {
            if (*numbers < 3)
                v[*numbers] = value;
            ++*numbers;
        } else {
            ++*others;
        }
        while (*s != '\0' && !tracing_is_gap(*s))
            s++;
        while (tracing_is_gap(*s))
            s++;
    }
}

static bool read_line(Reading *r, char *text, guint line)
{
    static const char *allowed = "is no point: a line is x y (pixels of the image, y down), a blank line or one of letters parts veins";
    double v[3];
    guint numbers, others;
    count_words(text, v, &numbers, &others);
    if (numbers == 0) {
        end_stroke(r);
        if (others > 0) {
            g_free(r->heading);
            r->heading = g_utf8_make_valid(g_strstrip(text), -1);
        }
        return true;
    }
    if (numbers != 2 || others > 0)
        return bad_line(r, line, g_strstrip(text), allowed);
    if (!(fabs(v[0]) <= TRACING_FARTHEST && fabs(v[1]) <= TRACING_FARTHEST))
        return bad_line(r, line, g_strstrip(text), "is no point of an image: x and y are -1000000 to 1000000");
    add_point(r, vec2(v[0], v[1]), line);
    return true;
}

static bool read_text(Reading *r, char *text, gsize length)
{
    if (memchr(text, '\0', length)) {
        g_set_error(r->error, IMPORT_ERROR, IMPORT_ERROR_SYNTAX, "%s: is no text: a tracing is a line x y for each point", r->path);
        return false;
    }
    guint line = 1;
    char *s = text;
    if (length >= 3 && memcmp(s, "\xEF\xBB\xBF", 3) == 0)
        s += 3;
    for (char *next; s; s = next, line++) {
        next = strchr(s, '\n');
        if (next)
            *next++ = '\0';
        if (!read_line(r, s, line))
            return false;
    }
    for (guint i = 0; i < r->stroke->len; i++) {
        const Stroke *k = &g_array_index(r->stroke, Stroke, i);
        if (k->n < 2) {
            g_set_error(r->error, IMPORT_ERROR, IMPORT_ERROR_GRAPH, "%s:%u: is a vein of one point; it must have two at least", r->path, k->line);
            return false;
        }
    }
    if (r->stroke->len == 0)
        g_set_error(r->error, IMPORT_ERROR, IMPORT_ERROR_GRAPH, "%s: holds no vein: a tracing is a line x y for each point", r->path);
    return r->stroke->len > 0;
}

/* ---- outlines ---- */

static bool is_outline(const Vec2 *p, guint n)
{
    double area = 0.0, length = 0.0, gap = vec_dist(p[0], p[n - 1]);
    for (guint i = 0; i < n; i++) {
        Vec2 q = p[i + 1 < n ? i + 1 : 0];
        area += 0.5 * vec_cross(vec_sub(p[i], p[0]), vec_sub(q, p[0]));
        length += vec_dist(p[i], q);
    }
    area = fabs(area);
    if (n < 3 || !(area > 0.0))
        return false;
    if (gap <= MEETS && gap < 0.1 * length)
        return true;
    double width = 2.0 * area / length;
    return gap <= END_WIDTHS * width && 12.566370614359172 * area <= ROUNDEST * length * length;
}

/* Pixels of the raster in units of the tracing: x = corner.x + column / scale, y (down) alike. */
typedef struct {
    Mask m;
    Vec2 corner;
    double scale;
} Raster;

static Raster raster_new(const Vec2 *p, guint n)
{
    Box2 b = box_empty();
    for (guint i = 0; i < n; i++)
        b = box_add(b, p[i]);
    double w = b.x1 - b.x0, h = b.y1 - b.y0, scale = sqrt(RASTER / (w * h));
    scale = fmin(scale, RASTER / 64.0 / fmax(w, h)); /* what is long and thin gets no finer than its length allows */
    Raster r = {.scale = scale};
    r.m.width = (uint32_t)ceil(w * scale) + 2 * MARGIN;
    r.m.height = (uint32_t)ceil(h * scale) + 2 * MARGIN;
    r.m.stride = r.m.width;
    r.corner = vec2(b.x0 - MARGIN / scale, b.y0 - MARGIN / scale);
    r.m.px = g_new0(uint8_t, (gsize)r.m.width * r.m.height);
    return r;
}

static Vec2 to_raster(const Raster *r, Vec2 p) { return vec_scale(vec_sub(p, r->corner), r->scale); }

/* The pixels whose centres an edge passes nearest, so that what is narrower than a pixel doesn't break. */
static void draw_edge(const Raster *r, Vec2 a, Vec2 b)
{
    double dx = fabs(b.x - a.x), dy = fabs(b.y - a.y);
    uint32_t steps = (uint32_t)ceil(fmax(dx, dy));
    for (uint32_t k = 0; k <= steps; k++) {
        Vec2 q = vec_lerp(a, b, steps ? (double)k / steps : 0.0);
        *mask_at(&r->m, (uint32_t)q.x, (uint32_t)q.y) |= MASK_LEAF;
    }
}

/* Notes in each row of pixel centres that an edge crosses, from which pixel on there is one more turn around it or one less. */
static void note_turns(const Raster *r, Vec2 a, Vec2 b, int32_t *turns)
{
    Vec2 top = a.y <= b.y ? a : b, low = a.y <= b.y ? b : a;
    for (double row = ceil(top.y - 0.5); row + 0.5 < low.y; row += 1.0) {
        double x = top.x + (low.x - top.x) * ((row + 0.5 - top.y) / (low.y - top.y));
        turns[(gsize)row * r->m.width + (gsize)ceil(x - 0.5)] += a.y <= b.y ? 1 : -1;
    }
}

/* Marks pixels whose centres the outline winds around, whichever way and however often, and those it passes. */
static void fill(const Raster *r, const Vec2 *p, guint n)
{
    int32_t *turns = g_new0(int32_t, (gsize)r->m.width * r->m.height);
    for (guint i = 0; i < n; i++) {
        Vec2 a = to_raster(r, p[i]), b = to_raster(r, p[i + 1 < n ? i + 1 : 0]);
        note_turns(r, a, b, turns);
        if (i + 1 < n)
            draw_edge(r, a, b); /* but the way from the last point to the first may be an end that is cut off */
    }
    int32_t sum = 0; /* nothing again at the end of each row */
    for (gsize i = 0; i < (gsize)r->m.width * r->m.height; i++) {
        sum += turns[i];
        r->m.px[i] |= sum != 0 ? MASK_LEAF : 0;
    }
    g_free(turns);
}

/* From the raster's pixels, y up, to those of the image. An outline's own pixels widen what is filled by half a pixel on either side, measured
 * along the nearer axis: 0.9 pixels in the mean over directions. */
static void from_raster(const Raster *r, Drawing *d, double height)
{
    for (uint32_t i = 0; i < d->n; i++)
        for (uint32_t k = 0; k < d->vein[i].n; k++) {
            Vec2 *p = &d->vein[i].point[k];
            *p = vec2(r->corner.x + p->x / r->scale, height - (r->corner.y + (r->m.height - p->y) / r->scale));
            d->vein[i].width[k] = fmax(d->vein[i].width[k] - 0.9, 0.5) / r->scale;
        }
}

static Drawing *read_outline(const char *path, const Vec2 *p, guint n, double height, GError **error)
{
    Raster r = raster_new(p, n);
    fill(&r, p, n);
    double wide = 2.0 * mask_widest(&r.m, MASK_LEAF), longer = MAX(r.m.width, r.m.height);
    Drawing *d = NULL;
    if (wide > WIDEST * longer) {
        g_set_error(error, IMPORT_ERROR, IMPORT_ERROR_GRAPH,
                    "%s: is one closed line around a shape %.0f pixels long and up to %.0f wide, like a blade; the outline of a vein system is nowhere wider "
                    "than a quarter of its length", path, longer / r.scale, wide / r.scale);
    } else {
        CentreDef def = centre_def_default();
        d = centre_lines(&r.m, MASK_LEAF, &def);
        from_raster(&r, d, height);
        if (d->n == 0) {
            drawing_free(d);
            d = NULL;
            g_set_error(error, IMPORT_ERROR, IMPORT_ERROR_GRAPH, "%s: the outline encloses no vein", path);
        }
    }
    g_free(r.m.px);
    return d;
}

static Drawing *strokes(const Reading *r, double height)
{
    Drawing *d = drawing_new();
    for (guint i = 0; i < r->stroke->len; i++) {
        const Stroke *s = &g_array_index(r->stroke, Stroke, i);
        Vec2 *p = &g_array_index(r->point, Vec2, s->first);
        for (guint k = 0; k < s->n; k++)
            p[k].y = height - p[k].y;
        char *quoted = s->name ? names_quote(s->name) : NULL;
        char *name = quoted ? g_strdup_printf("vein %s", quoted) : g_strdup_printf("the vein at line %u", s->line);
        drawing_add(d, p, NULL, s->n, 0, name);
        g_free(name);
        g_free(quoted);
    }
    return d;
}

static void clear_stroke(gpointer stroke) { g_free(((Stroke *)stroke)->name); }

Drawing *drawing_read_tracing(const char *path, double height, GError **error)
{
    char *text;
    gsize length;
    if (!textfile_read(path, LARGEST_FILE, &text, &length, error))
        return NULL;
    Reading r = {.path = path, .error = error};
    r.point = g_array_new(FALSE, FALSE, sizeof(Vec2));
    r.stroke = g_array_new(FALSE, FALSE, sizeof(Stroke));
    g_array_set_clear_func(r.stroke, clear_stroke);
    Drawing *d = NULL;
    if (read_text(&r, text, length)) {
        const Vec2 *p = &g_array_index(r.point, Vec2, 0);
        d = r.stroke->len == 1 && is_outline(p, r.point->len) ? read_outline(path, p, r.point->len, height, error) : strokes(&r, height);
    }
    g_array_free(r.point, TRUE);
    g_array_free(r.stroke, TRUE);
    g_free(r.heading);
    g_free(text);
    return d;
}
