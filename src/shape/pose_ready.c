/* The ready-made poses. Angles were chosen by eye from leaves and from Hong 2005, figs. 7.4, 7.5, 8.5 and 8.9; they are bends of a vein as
 * long as the longest of its kind. */
#include "geom/dtrig.h"
#include "geom/random.h"
#include "shape/bend.h"

#define DEG DTRIG_DEGREE

/* What a vein does for the blade. */
typedef enum {
    ROLE_MIDRIB,
    ROLE_RADIAL, /* another primary of a palmate leaf */
    ROLE_SIDE,   /* leaves a primary */
    ROLE_TWIG,   /* finer */
    ROLE_SHEET   /* any but the midrib of a leaf whose primaries run side by side (grasses, many monocotyledons) */
} Role;

/* Which of a vein's random numbers. */
enum { UNEVEN_ANGLE, UNEVEN_LIFT, UNEVEN_TURN, UNEVEN_PHASE };

typedef struct {
    const Skeleton *s;
    const Layout *l;
    const PoseDef *def;
    double variation, age; /* held within 0 … 1 */
    bool parallel;      /* primaries run side by side */
    double longest;     /* ROLE_SIDE vein, segments */
    double spread;      /* mean distance of ROLE_SIDE veins on one side of a primary, part of its length */
} Maker;

static const double side_by_side = 0.87; /* cosine of the angle between primaries, about 30° */

static bool is_primary(const Sequence *q) { return q->order <= 1 || q->parent == NO_PARENT; }

static Role role_of(const Maker *m, uint32_t q)
{
    const Sequence *seq = &m->s->sequence[q];
    if (q == m->l->midrib)
        return ROLE_MIDRIB;
    if (m->parallel)
        return ROLE_SHEET;
    if (is_primary(seq))
        return ROLE_RADIAL;
    return is_primary(&m->s->sequence[seq->parent]) ? ROLE_SIDE : ROLE_TWIG;
}

/* More than one primary, and all along the midrib. */
static bool runs_parallel(const Skeleton *s, const Layout *l)
{
    uint32_t others = 0;
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        const Sequence *seq = &s->sequence[q];
        if (q == l->midrib || !is_primary(seq))
            continue;
        Vec2 chord = vec_sub(s->rest[s->at[seq->first + seq->n - 1]], s->rest[s->at[seq->first]]);
        if (vec_dot(chord, l->along) < side_by_side * sqrt(vec_norm2(chord)))
            return false;
        others++;
    }
    return others > 0;
}

static Maker maker(const Skeleton *s, const Layout *l, const PoseDef *def)
{
    Maker m = {s, l, def, CLAMP(def->variation, 0.0, 1.0), CLAMP(def->age, 0.0, 1.0), runs_parallel(s, l), 0.0, 0.0};
    uint32_t sides = 0, primaries = 0;
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        Role role = role_of(&m, q);
        primaries += role == ROLE_MIDRIB || role == ROLE_RADIAL;
        if (role != ROLE_SIDE)
            continue;
        sides++;
        m.longest = l->length[q] > m.longest ? l->length[q] : m.longest;
    }
    m.spread = sides > 0 ? 2.0 * (double)primaries / (double)sides : 1.0;
    return m;
}

/* FNV-1a; the number of a vein without a name. */
static uint64_t vein_key(const Skeleton *s, uint32_t q)
{
    const char *name = s->sequence[q].name;
    if (!*name)
        return q;
    uint64_t h = 0xcbf29ce484222325u;
    for (; *name; name++)
        h = (h ^ (unsigned char)*name) * 0x100000001b3u;
    return h;
}

static double random_signed(const Maker *m, uint64_t key, uint32_t which)
{
    double u[2];
    random_pair(m->def->seed, RANDOM_POSE, which, key, u);
    return 2.0 * u[0] - 1.0;
}

/* -1 … 1. Neighbours on one side of a parent do much the same: most of it is a smooth course along the parent, the rest the vein's own. */
static double uneven(const Maker *m, uint32_t q, uint32_t which)
{
    enum { KNOTS = 4 };
    const Sequence *seq = &m->s->sequence[q];
    double own = random_signed(m, vein_key(m->s, q), which);
    if (seq->parent == NO_PARENT)
        return own;
    double x = m->l->at[q] * KNOTS, i = floor(x), f = x - i, common[2];
    for (uint32_t k = 0; k < 2; k++) {
        uint32_t knot = 16 + 4 * (2 * ((uint32_t)i + k) + (m->l->fold_side[q] < 0)) + which;
        common[k] = random_signed(m, vein_key(m->s, seq->parent), knot);
    }
    f = f * f * (3.0 - 2.0 * f);
    return 0.65 * (common[0] + (common[1] - common[0]) * f) + 0.35 * own;
}

/* Smooth unevenness along the vein: up to `lift` and `turn` degrees. */
static void add_ripple(const Maker *m, Bend *b, uint32_t q, double lift, double turn)
{
    double random[2];
    random_pair(m->def->seed, RANDOM_POSE, UNEVEN_PHASE, vein_key(m->s, q), random);
    b->ripple[0] = m->variation * lift * DEG;
    b->ripple[1] = m->variation * turn * DEG;
    for (int k = 0; k < 2; k++)
        b->phase[k] = 2.0 * DTRIG_PI * random[k];
}

/* The longest side veins bend most: equal curvature. */
static double reach(const Maker *m, uint32_t q) { return m->longest > 0.0 ? m->l->length[q] / m->longest : 1.0; }

static double weaker_on_radials(const Maker *m, uint32_t q, double k) { return m->s->sequence[q].parent == m->l->midrib ? 1.0 : k; }

/* Adds k · (1 − (1 − t)⁴): most of k in the first part of the vein. */
static void add_rise(Bend *b, double k)
{
    static const double term[4] = {4.0, -6.0, 4.0, -1.0};
    for (int i = 0; i < 4; i++)
        b->course[i] += k * term[i];
}

/* The blade's edges rise. */
static void make_cupped(const Maker *m, Role role, uint32_t q, Bend *b)
{
    switch (role) {
    case ROLE_MIDRIB:
        b->lift = 18 * DEG;
        break;
    case ROLE_RADIAL:
        b->fold = 8 * DEG;
        b->lift = 42 * DEG;
        break;
    case ROLE_SIDE:
        b->fold = 8 * DEG * weaker_on_radials(m, q, 0.5);
        b->lift = 62 * DEG * reach(m, q) * weaker_on_radials(m, q, 0.6);
        break;
    case ROLE_TWIG:
        b->lift = 8 * DEG;
        break;
    case ROLE_SHEET:
        break; /* as the midrib */
    }
}

/* A V along the midrib, weaker ones along other primaries. */
static void make_folded(const Maker *m, Role role, uint32_t q, Bend *b)
{
    if (role == ROLE_SIDE)
        b->fold = 38 * DEG * weaker_on_radials(m, q, 0.4);
    else if (role == ROLE_RADIAL)
        b->fold = 38 * DEG;
}

/* The base rises, then the weight of the blade bends the midrib down, the more the farther out. */
static void make_drooping(const Maker *m, Role role, uint32_t q, Bend *b)
{
    if (role == ROLE_MIDRIB || role == ROLE_RADIAL) {
        add_rise(b, 26 * DEG);
        b->course[0] -= 30 * DEG;
        b->course[1] -= 85 * DEG;
    } else if (role == ROLE_SIDE) {
        b->fold = -4 * DEG;
        b->course[0] = -12 * DEG * reach(m, q);
        b->course[1] = -22 * DEG * reach(m, q);
    }
}

static void make_curled(Role role, Bend *b)
{
    if (role == ROLE_SIDE || role == ROLE_TWIG)
        return;
    b->curl = (role == ROLE_RADIAL ? -150 : -210) * DEG;
    b->curl_from = 0.7;
}

/* Between the midrib and another primary, in the blade. */
static double angle_to_midrib(const Maker *m, uint32_t q)
{
    const Sequence *seq = &m->s->sequence[q];
    Vec2 chord = vec_sub(m->s->rest[m->s->at[seq->first + seq->n - 1]], m->s->rest[m->s->at[seq->first]]);
    return dtrig_atan2(fabs(vec_cross(m->l->along, chord)), vec_dot(m->l->along, chord));
}

/* About four side veins a wave; the phase is that of the place where the vein leaves its primary. Primaries go up and down in turn. */
static void make_wavy(const Maker *m, Role role, uint32_t q, Bend *b)
{
    double waves = 1.0 / (4.0 * m->spread), phase = 0.0;
    waves = waves < 1.5 ? 1.5 : waves > 6.0 ? 6.0 : waves;
    if (role == ROLE_SIDE) {
        phase = 2.0 * DTRIG_PI * waves * m->l->at[q] + m->variation * uneven(m, q, UNEVEN_PHASE);
        b->curl = 70 * DEG * (0.45 + 0.55 * reach(m, q)) * dtrig_sin(phase);
        b->curl_from = 0.35;
    } else if (role == ROLE_RADIAL) {
        b->curl = 50 * DEG * dtrig_sin(5.0 * angle_to_midrib(m, q));
        b->curl_from = 0.4;
    }
}

/* Drying up (figs. 8.5, 8.9): thin veins give way first and roll in, the thick midrib last. */
static void make_withered(const Maker *m, Role role, uint32_t q, Bend *b)
{
    double age = m->age, roll = age * (0.3 + 0.7 * age * age), late = age * age;
    switch (role) {
    case ROLE_MIDRIB:
        b->course[0] = 10 * DEG * age;
        b->course[1] = 80 * DEG * late;
        add_ripple(m, b, q, 22 * late, 14 * late);
        b->sway = 30 * DEG * late * m->variation * uneven(m, q, UNEVEN_TURN);
        break;
    case ROLE_RADIAL:
        b->fold = 30 * DEG * age;
        b->course[0] = 40 * DEG * roll;
        b->course[1] = 150 * DEG * roll;
        add_ripple(m, b, q, 28 * age, 16 * late);
        b->sway = 25 * DEG * late * m->variation * uneven(m, q, UNEVEN_TURN);
        break;
    case ROLE_SIDE: {
        double angle = roll * DEG * (0.55 + 0.45 * reach(m, q)) * weaker_on_radials(m, q, 0.7);
        b->fold = 18 * DEG * age;
        b->course[0] = 60 * angle;
        b->course[1] = 130 * angle;
        b->course[2] = 130 * angle;
        add_ripple(m, b, q, 26 * age, 14 * age);
        b->sway = 22 * DEG * age * m->variation * uneven(m, q, UNEVEN_TURN);
        break;
    }
    case ROLE_TWIG:
        b->lift = 40 * DEG * roll;
        add_ripple(m, b, q, 18 * age, 10 * age);
        break;
    case ROLE_SHEET:
        break; /* as the midrib */
    }
}

/* No two veins of a leaf are bent alike. */
static void make_uneven(const Maker *m, Role role, uint32_t q, Bend *b)
{
    double amount = m->def->kind == POSE_WITHERED ? m->age : 1.0;
    double factor = 1.0 + m->variation * (role == ROLE_SIDE ? 0.5 : 0.2) * uneven(m, q, UNEVEN_ANGLE);
    if (m->variation == 0.0)
        return;
    b->fold *= factor;
    b->lift *= factor;
    b->curl *= factor;
    for (guint k = 0; k < G_N_ELEMENTS(b->course); k++)
        b->course[k] *= factor;
    b->lift += (role == ROLE_SIDE ? 9 : 5) * DEG * amount * m->variation * uneven(m, q, UNEVEN_LIFT);
    b->sway += 6 * DEG * amount * m->variation * uneven(m, q, UNEVEN_TURN);
    if (m->def->kind != POSE_WITHERED)
        add_ripple(m, b, q, 4, 2);
}

static void make_sheet(const Maker *m, Sheet *sheet)
{
    double both = 0.0, wild = 0.0, age = m->age;
    switch (m->def->kind) {
    case POSE_CUPPED:
        both = 52;
        break;
    case POSE_FOLDED:
        sheet->fold = 38 * DEG;
        break;
    case POSE_DROOPING:
        both = -18;
        break;
    case POSE_WAVY:
        sheet->wave = 38 * DEG;
        sheet->waves = 4.0;
        break;
    case POSE_WITHERED:
        both = 78 * (1.0 - (1.0 - age) * (1.0 - age));
        wild = 30 * age;
        break;
    case POSE_FLAT:
    case POSE_CURLED_TIP:
        break;
    }
    for (uint32_t k = 0; k < 2; k++)
        sheet->cup[k] = both * DEG * (1.0 + 0.25 * m->variation * random_signed(m, k, UNEVEN_ANGLE));
    if (m->variation > 0.0 && sheet->waves == 0.0) {
        sheet->wave = (4.0 + wild) * DEG * m->variation;
        sheet->waves = 2.5;
    }
    sheet->phase = 2.0 * DTRIG_PI * m->variation * random_signed(m, 2, UNEVEN_PHASE);
}

static void scale_bend(Bend *b, double k)
{
    b->fold *= k;
    b->lift *= k;
    b->sway *= k;
    b->curl *= k;
    b->ripple[0] *= k;
    b->ripple[1] *= k;
    for (guint i = 0; i < G_N_ELEMENTS(b->course); i++)
        b->course[i] *= k;
}

static Bend ready_bend(const Maker *m, Role role, uint32_t q)
{
    Bend b = {0};
    switch (m->def->kind) {
    case POSE_FLAT:
        return b;
    case POSE_CUPPED:
        make_cupped(m, role, q, &b);
        break;
    case POSE_FOLDED:
        make_folded(m, role, q, &b);
        break;
    case POSE_DROOPING:
        make_drooping(m, role, q, &b);
        break;
    case POSE_CURLED_TIP:
        make_curled(role, &b);
        break;
    case POSE_WAVY:
        make_wavy(m, role, q, &b);
        break;
    case POSE_WITHERED:
        make_withered(m, role, q, &b);
    }
    make_uneven(m, role, q, &b);
    scale_bend(&b, m->def->strength);
    return b;
}

void bend_ready(const Skeleton *s, const Layout *l, const PoseDef *def, Bend *bend, Sheet *sheet)
{
    *sheet = (Sheet){0};
    if (def->kind == POSE_FLAT || (def->kind == POSE_WITHERED && !(def->age > 0.0)))
        return;
    Maker m = maker(s, l, def);
    Bend lengthwise = ready_bend(&m, ROLE_MIDRIB, l->midrib); /* of a sheet: what the midrib does, by the part of its chord */
    lengthwise.course[0] += lengthwise.lift;
    lengthwise.lift = 0.0;
    lengthwise.on_sheet = true;
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        Role role = role_of(&m, q);
        bend[q] = role == ROLE_SHEET ? lengthwise : ready_bend(&m, role, q);
    }
    make_sheet(&m, sheet);
    sheet->fold *= def->strength;
    sheet->wave *= def->strength;
    sheet->cup[0] *= def->strength;
    sheet->cup[1] *= def->strength;
}

PoseDef pose_def_default(void)
{
    return (PoseDef){.kind = POSE_FLAT, .strength = 1.0, .age = 0.6, .variation = 0.4, .seed = 1, .blend = 1.0, .rules = NULL};
}
