#include "shape/bend.h"

#include <string.h>

#include "geom/dtrig.h"

static const double ripple_waves = 1.25; /* along a vein */
static const double rooted = 0.3;        /* the sheet has its height from this part of the midrib on; before it rises from the roots */
static const double steepest = 1.4;      /* radians; of the sheet */

static double sequence_length(const Skeleton *s, const Sequence *q)
{
    double length = 0.0;
    for (uint32_t k = 1; k < q->n; k++)
        length += vec_dist(s->rest[s->at[q->first + k - 1]], s->rest[s->at[q->first + k]]);
    return length;
}

static Vec2 first_place(const Skeleton *s, const Sequence *q) { return s->rest[s->at[q->first]]; }
static Vec2 last_place(const Skeleton *s, const Sequence *q) { return s->rest[s->at[q->first + q->n - 1]]; }

static Vec2 unit(Vec2 a)
{
    double n = sqrt(vec_norm2(a));
    return n > 0.0 ? vec_scale(a, 1.0 / n) : vec2(0.0, 0.0);
}

/* The one that is called so, else the longest primary. */
static uint32_t find_midrib(const Skeleton *s, const double *length)
{
    uint32_t best = 0;
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        if (strcmp(s->sequence[q].name, "midrib") == 0)
            return q;
        if (s->sequence[q].parent == NO_PARENT && length[q] > length[best])
            best = q;
    }
    return best;
}

/* Between the two edges of the sequence that meet at its node k. */
static Vec2 direction_at(const Skeleton *s, const Sequence *q, uint32_t k)
{
    const uint32_t *node = s->at + q->first;
    Vec2 before = k > 0 ? unit(vec_sub(s->rest[node[k]], s->rest[node[k - 1]])) : vec2(0.0, 0.0);
    Vec2 after = k + 1 < q->n ? unit(vec_sub(s->rest[node[k + 1]], s->rest[node[k]])) : vec2(0.0, 0.0);
    return unit(vec_add(before, after));
}

static double part_of_parent(const Skeleton *s, const Sequence *q, const double *length)
{
    const Sequence *parent = &s->sequence[q->parent];
    double along = 0.0;
    for (uint32_t k = 1; k <= q->start; k++)
        along += vec_dist(s->rest[s->at[parent->first + k - 1]], s->rest[s->at[parent->first + k]]);
    return length[q->parent] > 0.0 ? along / length[q->parent] : 0.0;
}

static int8_t sign(double k) { return (int8_t)((k > 0.0) - (k < 0.0)); }

static void lay_sequence(Layout *l, const Skeleton *s, uint32_t q)
{
    const Sequence *seq = &s->sequence[q];
    Vec2 chord = vec_sub(last_place(s, seq), first_place(s, seq));
    if (seq->parent != NO_PARENT) {
        l->at[q] = part_of_parent(s, seq, l->length);
        l->axis[q] = direction_at(s, &s->sequence[seq->parent], seq->start);
    } else if (q != l->midrib) {
        l->axis[q] = l->along;
    }
    l->fold_side[q] = sign(vec_cross(l->axis[q], chord));
    if (q == l->midrib)
        return;
    if (seq->parent == l->midrib)
        l->side[q] = l->fold_side[q];
    else if (seq->parent != NO_PARENT)
        l->side[q] = l->side[seq->parent];
    else
        l->side[q] = sign(vec_cross(l->along, vec_sub(vec_lerp(first_place(s, seq), last_place(s, seq), 0.5), l->base)));
}

static void measure(Layout *l, const Skeleton *s)
{
    Box2 box = box_empty();
    for (uint32_t i = 0; i < s->n_nodes; i++) {
        box = box_add(box, s->rest[i]);
        double away = fabs(vec_cross(l->along, vec_sub(s->rest[i], l->base)));
        l->half_width = away > l->half_width ? away : l->half_width;
    }
    if (s->outline)
        box = s->outline->box;
    l->leaf_length = s->length > 0.0 ? s->length : box_is_empty(box) ? 0.0 : box.y1 - box.y0;
}

Layout *layout_new(const Skeleton *s)
{
    Layout *l = g_new0(Layout, 1);
    uint32_t n = s->n_sequences;
    l->length = g_new0(double, n);
    l->at = g_new0(double, n);
    l->axis = g_new0(Vec2, n);
    l->fold_side = g_new0(int8_t, n);
    l->side = g_new0(int8_t, n);
    if (n == 0)
        return l;
    for (uint32_t q = 0; q < n; q++)
        l->length[q] = sequence_length(s, &s->sequence[q]);
    l->midrib = find_midrib(s, l->length);
    l->base = first_place(s, &s->sequence[l->midrib]);
    Vec2 chord = vec_sub(last_place(s, &s->sequence[l->midrib]), l->base);
    l->along = unit(chord);
    l->chord = sqrt(vec_norm2(chord));
    for (uint32_t q = 0; q < n; q++)
        lay_sequence(l, s, q);
    measure(l, s);
    return l;
}

void layout_free(Layout *l)
{
    if (!l)
        return;
    g_free(l->length);
    g_free(l->at);
    g_free(l->axis);
    g_free(l->fold_side);
    g_free(l->side);
    g_free(l);
}

/* Angles at a place on a vein; what is different between two places is the bend between them. */
typedef struct {
    double lift, turn; /* about the vein's own direction across, about the blade's normal */
    double course;     /* as lift, but of a vein on the sheet across the midrib */
} Sum;

static double course_at(const Bend *b, double t)
{
    double sum = 0.0;
    for (int k = (int)G_N_ELEMENTS(b->course) - 1; k >= 0; k--)
        sum = (sum + b->course[k]) * t;
    if (b->curl != 0.0 && t > b->curl_from) {
        double u = (t - b->curl_from) / (1.0 - b->curl_from);
        sum += b->curl * u * u;
    }
    return sum;
}

static double ripple_at(const Bend *b, int which, double t)
{
    if (b->ripple[which] == 0.0)
        return 0.0;
    return b->ripple[which] * dtrig_sin(2.0 * DTRIG_PI * ripple_waves * t + b->phase[which]);
}

static Sum sum_at(const Layout *l, const Bend *b, double t, Vec2 rest)
{
    double u = t;
    if (b->on_sheet) {
        u = l->chord > 0.0 ? vec_dot(vec_sub(rest, l->base), l->along) / l->chord : 0.0;
        u = u < 0.0 ? 0.0 : u > 1.0 ? 1.0 : u;
    }
    return (Sum){b->lift * t, b->turn * t + b->sway * u + ripple_at(b, 1, u), course_at(b, u) + ripple_at(b, 0, u)};
}

/* The axis that lifts direction d out of the flat blade. */
static Vec3 across(Vec2 d) { return vec3(d.y, -d.x, 0.0); }

static Mat3 carry(Mat3 frame, const Layout *l, const Bend *b, Vec2 d, Sum from, Sum to, double part)
{
    double lift = to.lift - from.lift, course = to.course - from.course, turn = to.turn - from.turn;
    if (!b->on_sheet)
        lift += course;
    if (lift == 0.0 && turn == 0.0 && course == 0.0)
        return frame;
    Vec3 v = vec3_add(vec3_scale(across(d), lift), vec3(0.0, 0.0, turn));
    if (b->on_sheet)
        v = vec3_add(v, vec3_scale(across(l->along), course));
    return rotation_compose(frame, rotation_by(vec3_scale(v, part)));
}

static double slope(double angle)
{
    angle = angle > steepest ? steepest : angle < -steepest ? -steepest : angle;
    return dtrig_sin(angle);
}

static double sheet_height(const Layout *l, const Sheet *sheet, double part, Vec2 rest)
{
    if (!(l->half_width > 0.0 && l->chord > 0.0))
        return 0.0;
    Vec2 r = vec_sub(rest, l->base);
    double v = vec_dot(r, l->along) / l->chord, x = vec_cross(l->along, r), w = fabs(x) / l->half_width;
    double rise = v <= 0.0 ? 0.0 : v >= rooted ? 1.0 : v / rooted;
    rise = rise * rise * (3.0 - 2.0 * rise);
    double h = l->half_width * (slope(part * sheet->fold) * w + 0.5 * slope(part * sheet->cup[x < 0.0]) * w * w);
    if (sheet->wave != 0.0 && sheet->waves > 0.0) {
        double turn = 2.0 * DTRIG_PI * sheet->waves;
        h += slope(part * sheet->wave) * l->chord / turn * w * w * dtrig_sin(turn * v + sheet->phase);
    }
    return rise * h;
}

/* Of the sheet along the edge; a slope, not a bend: it doesn't add up along the vein. */
static Mat3 with_slope(Mat3 frame, Vec2 d, double rise, double length)
{
    double run2 = length * length - rise * rise;
    if (rise == 0.0)
        return frame;
    double angle = dtrig_atan2(rise, run2 > 0.0 ? sqrt(run2) : 0.0);
    return rotation_compose(frame, rotation_by(vec3_scale(across(d), angle)));
}

/* frame[node] receives how the vein is turned at its nodes, where its children take over. An edge has the turn of its middle, so that the bent
 * vein is nearly the same however finely it is cut. */
static void bend_sequence(Pose *p, const Layout *l, uint32_t q, const Bend *b, const Sheet *sheet, double part, Mat3 *frame)
{
    const Skeleton *s = p->skeleton;
    const uint32_t *node = s->at + s->sequence[q].first;
    Mat3 f = frame[node[0]];
    if (b->fold != 0.0)
        f = rotation_compose(f, rotation_by(vec3_scale(vec3_flat(l->axis[q]), part * b->fold * l->fold_side[q])));
    Sum before = sum_at(l, b, 0.0, s->rest[node[0]]);
    double along = 0.0, height = b->on_sheet ? sheet_height(l, sheet, part, s->rest[node[0]]) : 0.0;
    for (uint32_t k = 1; k < s->sequence[q].n; k++) {
        Vec2 from = s->rest[node[k - 1]], to = s->rest[node[k]], d = unit(vec_sub(to, from));
        double length = vec_dist(from, to), whole = l->length[q] > 0.0 ? l->length[q] : 1.0;
        Sum middle = sum_at(l, b, (along + 0.5 * length) / whole, vec_lerp(from, to, 0.5)), after = sum_at(l, b, (along + length) / whole, to);
        f = carry(f, l, b, d, before, middle, part);
        p->turn[node[k]] = f;
        if (b->on_sheet) {
            double next = sheet_height(l, sheet, part, to);
            p->turn[node[k]] = with_slope(f, d, next - height, length);
            height = next;
        }
        pose_place(p, node[k]);
        f = carry(f, l, b, d, middle, after, part);
        frame[node[k]] = f;
        along += length;
        before = after;
    }
}

void bend_apply(Pose *p, const Layout *l, const Bend *bend, const Sheet *sheet, double part)
{
    const Skeleton *s = p->skeleton;
    Mat3 *frame = g_new(Mat3, s->n_nodes);
    for (uint32_t i = 0; i < s->n_nodes; i++) {
        p->place[i] = vec3_flat(s->rest[i]);
        p->turn[i] = frame[i] = mat3_identity();
    }
    for (uint32_t q = 0; q < s->n_sequences; q++)
        bend_sequence(p, l, q, &bend[q], sheet, part, frame);
    g_free(frame);
}
