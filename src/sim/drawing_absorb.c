/* What is drawn twice is taken once. */
#include "sim/drawing_private.h"

/* What runs along a coarser line, nearer than this part of `snap` and for longer than `snap`, is that line drawn again. */
static const double same = 0.25;

/* Pieces of a line that follow one another and are gone, or not. */
typedef struct {
    uint32_t first, last; /* spots */
    bool gone;
} Run;

static void append_run(GArray *runs, uint32_t piece, bool gone)
{
    Run *r = runs->len ? &g_array_index(runs, Run, runs->len - 1) : NULL;
    if (r && r->gone == gone) {
        r->last = piece + 1;
        return;
    }
    Run fresh = {piece, piece + 1, gone};
    g_array_append_val(runs, fresh);
}

static bool run_is_long(const Sketch *s, const Run *r, double least) { return s->spot[r->last].along - s->spot[r->first].along > least; }

/* Runs of a line beside coarser lines, and others. */
static void find_runs(const Sketch *s, const PieceIndex *x, uint32_t k, double reach, GArray *runs)
{
    const Line *line = LINE(s, k);
    Hit hit;
    bool here = pieces_nearest(x, s, s->spot[line->first].p, reach, k, NONE, &hit);
    g_array_set_size(runs, 0);
    for (uint32_t i = line->first; i < line->last; i++) {
        bool next = pieces_nearest(x, s, s->spot[i + 1].p, reach, k, NONE, &hit);
        append_run(runs, i, here && next && pieces_nearest(x, s, x->middle[i], reach, k, NONE, &hit));
        here = next;
    }
}

/* A run beside another line counts when it is long; what is left between such runs, or at their ends, when it is. */
static void settle_runs(const Sketch *s, double least, GArray *runs)
{
    Run *r = &g_array_index(runs, Run, 0);
    guint n = runs->len;
    bool *firm = g_new(bool, n); /* gone for sure */
    for (guint k = 0; k < n; k++)
        firm[k] = r[k].gone && (n == 1 || run_is_long(s, &r[k], least));
    for (guint k = 0; k < n; k++) {
        bool beside = (k > 0 && firm[k - 1]) || (k + 1 < n && firm[k + 1]);
        r[k].gone = firm[k] || (beside && !run_is_long(s, &r[k], least));
    }
    g_free(firm);
}

/* Takes its gone pieces from a line; what is left becomes lines of their own. */
static void split_line(Sketch *s, uint32_t k, const GArray *runs, GArray *lines)
{
    for (guint j = 0; j < runs->len;) {
        const Run *first = &g_array_index(runs, Run, j);
        uint32_t last = first->last;
        for (j++; j < runs->len && g_array_index(runs, Run, j).gone == first->gone; j++)
            last = g_array_index(runs, Run, j).last;
        for (uint32_t i = first->first; first->gone && i < last; i++)
            s->line_of[i] = NONE;
        Line part = *LINE(s, k);
        part.first = first->first;
        part.last = last;
        part.end[0] = s->spot[part.first].along;
        part.end[1] = s->spot[part.last].along;
        if (!first->gone)
            g_array_append_val(lines, part);
    }
}

void sketch_absorb(Sketch *s)
{
    PieceIndex x;
    pieces_init(&x, s);
    GArray *runs = g_array_new(FALSE, FALSE, sizeof(Run)), *lines = g_array_new(FALSE, FALSE, sizeof(Line));
    double least = MAX(s->snap, 0.01 * drawing_least);
    for (uint32_t k = 0; k < s->line->len; k++) {
        find_runs(s, &x, k, same * least, runs);
        settle_runs(s, least, runs);
        split_line(s, k, runs, lines);
    }
    g_array_unref(runs);
    pieces_clear(&x);
    g_array_unref(s->line);
    s->line = lines;
    for (uint32_t k = 0; k < lines->len; k++)
        for (uint32_t i = LINE(s, k)->first; i < LINE(s, k)->last; i++)
            s->line_of[i] = k;
}
