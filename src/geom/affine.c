#include "geom/affine.h"

#include "geom/bezier.h"
#include "geom/svgscan.h"

#include <string.h>

static const Affine identity = {1.0, 0.0, 0.0, 1.0, 0.0, 0.0};

Affine affine_multiply(const Affine *m, const Affine *n)
{
    return (Affine){m->a * n->a + m->c * n->b,        m->b * n->a + m->d * n->b,
                    m->a * n->c + m->c * n->d,        m->b * n->c + m->d * n->d,
                    m->a * n->e + m->c * n->f + m->e, m->b * n->e + m->d * n->f + m->f};
}

static Affine matrix(const double v[6], int n) { return (Affine){v[0], v[1], v[2], v[3], v[4], v[5]}; }
static Affine translate(const double v[6], int n) { return (Affine){1.0, 0.0, 0.0, 1.0, v[0], v[1]}; }
static Affine scale(const double v[6], int n) { return (Affine){v[0], 0.0, 0.0, n > 1 ? v[1] : v[0], 0.0, 0.0}; }

/* About the point (v[1], v[2]), which is the origin when not given. */
static Affine rotate(const double v[6], int n)
{
    double s, c;
    degrees_sincos(v[0], &s, &c);
    return (Affine){c, s, -s, c, v[1] - c * v[1] + s * v[2], v[2] - s * v[1] - c * v[2]};
}

static Affine skew_x(const double v[6], int n)
{
    double s, c;
    degrees_sincos(v[0], &s, &c);
    return (Affine){1.0, 0.0, s / c, 1.0, 0.0, 0.0};
}

static Affine skew_y(const double v[6], int n)
{
    double s, c;
    degrees_sincos(v[0], &s, &c);
    return (Affine){1.0, s / c, 0.0, 1.0, 0.0, 0.0};
}

typedef struct {
    const char *name;
    unsigned counts; /* bit n is set when n arguments are allowed */
    Affine (*make)(const double v[6], int n);
} Kind;

static const Kind kinds[] = {{"matrix", 1u << 6, matrix},          {"translate", 1u << 1 | 1u << 2, translate},
                             {"scale", 1u << 1 | 1u << 2, scale},  {"rotate", 1u << 1 | 1u << 3, rotate},
                             {"skewX", 1u << 1, skew_x},           {"skewY", 1u << 1, skew_y}};

static const Kind *read_kind(SvgScan *s)
{
    size_t length = 0;
    while (g_ascii_isalpha(s->at[length]))
        length++;
    for (size_t k = 0; k < G_N_ELEMENTS(kinds); k++) {
        if (strlen(kinds[k].name) == length && !strncmp(s->at, kinds[k].name, length)) {
            s->at += length;
            return &kinds[k];
        }
    }
    return NULL;
}

static bool read_one(SvgScan *s, Affine *out, GError **error)
{
    const Kind *kind = read_kind(s);
    if (!kind)
        return svgscan_fail(s, "matrix, translate, scale, rotate, skewX or skewY", error);
    svgscan_space(s);
    if (*s->at != '(')
        return svgscan_fail(s, "'('", error);
    s->at++;
    svgscan_space(s);
    double v[6] = {0.0};
    int n = 0;
    do {
        if (!svgscan_number(s, &v[n++], error))
            return false;
    } while ((svgscan_comma(s) || svgscan_at_number(s)) && n < 6);
    if (*s->at != ')' || !(kind->counts >> n & 1u))
        return svgscan_fail(s, *s->at == ')' ? "another number" : "')'", error);
    s->at++;
    *out = kind->make(v, n);
    return true;
}

bool affine_parse(const char *text, Affine *out, GError **error)
{
    SvgScan s = {text, text};
    *out = identity;
    for (svgscan_space(&s); *s.at; svgscan_comma(&s)) {
        Affine one;
        if (!read_one(&s, &one, error))
            return false;
        *out = affine_multiply(out, &one);
    }
    return true;
}
