/* Values of levels, and draws: of sweep, key and variant alone. */
#include <math.h>

#include "geom/dmath.h"
#include "geom/random.h"
#include "sweep/private.h"

enum { STREAM_SWEEP = RANDOM_SWEEP, STREAM_SWEEP_DIGITS = RANDOM_SWEEP + 1 };

static const double ln2 = 0.693147180559945309417;

/* Halton's sequence (1960) in a prime base, the digits of each place sent through a random permutation of their own (Owen 2017): the points
 * fill the interval as evenly, but the sequences of two bases are not alike any more, and the seed matters. Places beyond the last digit of
 * the index are permuted too. */
void sweep_seat_digits(const Sweep *s, SweepAxis *axis)
{
    double unit = 1.0;
    for (axis->places = 0; unit > 0x1p-55; axis->places++)
        unit /= (double)axis->base;
    axis->digit = g_new(uint16_t, (gsize)axis->places * axis->base);
    for (uint32_t k = 0; k < axis->places; k++) {
        uint16_t *digit = axis->digit + (gsize)k * axis->base;
        for (uint32_t i = 0; i < axis->base; i++) { /* Durstenfeld 1964, from the front */
            RandomBlock r = random_block(s->sample_seed, STREAM_SWEEP_DIGITS, axis->base, (uint64_t)k << 32 | i);
            uint32_t j = r.w[0] % (i + 1);
            digit[i] = digit[j];
            digit[j] = (uint16_t)i;
        }
    }
}

static double halton(const SweepAxis *axis, uint64_t index)
{
    double x = 0.0, unit = 1.0 / (double)axis->base;
    for (uint32_t k = 0; k < axis->places; k++, unit /= (double)axis->base, index /= axis->base)
        x += unit * (double)axis->digit[k * axis->base + index % axis->base];
    return MIN(x, 1.0 - 0x1p-53);
}

double sweep_chance(const Sweep *s, const SweepAxis *axis, uint64_t index)
{
    if (s->halton)
        return halton(axis, index);
    double u[2];
    random_pair(s->sample_seed, STREAM_SWEEP, axis->key, index, u);
    return u[0];
}

static double ratio(const double up[8], const double down[8], double x)
{
    double p = 0.0, q = 0.0;
    for (int i = 7; i >= 0; i--) {
        p = p * x + up[i];
        q = q * x + down[i];
    }
    return p / q;
}

/* Wichura 1988, algorithm AS 241 (PPND16): rational approximations, relative error about 1e-16. */
double sweep_normal(double u)
{
    static const double a[8] = {3.3871328727963666080,  133.14166789178437745, 1971.5909503065514427, 13731.693765509461125,
                                45921.953931549871457,  67265.770927008700853, 33430.575583588128105, 2509.0809287301226727};
    static const double b[8] = {1.0, 42.313330701600911252, 687.18700749205790830, 5394.1960214247511077, 21213.794301586595867,
                                39307.895800092710610, 28729.085735721942674, 5226.4952788528545610};
    static const double c[8] = {1.42343711074968357734, 4.63033784615654529590, 5.76949722146069140550, 3.64784832476320460504,
                                1.27045825245236838258, 0.241780725177450611770, 0.0227238449892691845833, 7.74545014278341407640e-4};
    static const double d[8] = {1.0, 2.05319162663775882187, 1.67638483018380384940, 0.689767334985100004550, 0.148103976427480074590,
                                0.0151986665636164571966, 5.47593808499534494600e-4, 1.05075007164441684324e-9};
    static const double e[8] = {6.65790464350110377720, 5.46378491116411436990, 1.78482653991729133580, 0.296560571828504891230,
                                0.0265321895265761230930, 0.00124266094738807843860, 2.71155556874348757815e-5, 2.01033439929228813265e-7};
    static const double f[8] = {1.0, 0.599832206555887937690, 0.136929880922735805310, 0.0148753612908506148525, 7.86869131145613259100e-4,
                                1.84631831751005468180e-5, 1.42151175831644588870e-7, 2.04426310338993978564e-15};
    u = MAX(u, 0x1p-54);
    double q = u - 0.5;
    if (fabs(q) <= 0.425)
        return q * ratio(a, b, 0.180625 - q * q);
    double r = sqrt(-ln2 * dmath_log2(MIN(u, 1.0 - u)));
    double x = r <= 5.0 ? ratio(c, d, r - 1.6) : ratio(e, f, r - 5.0);
    return q < 0.0 ? -x : x;
}

char *sweep_axis_level_text(const SweepAxis *axis, uint64_t level)
{
    bool last = level + 1 == axis->levels;
    double part = axis->levels > 1 ? (double)level / (double)(axis->levels - 1) : 0.0, value = axis->low;
    switch (axis->kind) {
    case AXIS_LIST:
        return g_strdup(axis->cell[level * axis->fields]);
    case AXIS_STEPS:
        value = axis->low + (double)level * axis->step;
        last = last && fabs(value - axis->high) <= 1e-8 * fabs(axis->step);
        break;
    case AXIS_EVEN:
        value = axis->low + (axis->high - axis->low) * part;
        break;
    case AXIS_LOG:
        value = axis->low * dmath_exp2(dmath_log2(axis->high / axis->low) * part);
        break;
    case AXIS_UNIFORM:
    case AXIS_LOG_UNIFORM:
    case AXIS_NORMAL:
    case AXIS_EACH:
        g_assert_not_reached();
    }
    if (level == 0 || last) /* the ends as they were given */
        return sweep_number_text(level == 0 ? axis->low : axis->high, 17, axis->whole);
    return sweep_number_text(value, axis->digits, axis->whole);
}

char *sweep_axis_draw_text(const SweepAxis *axis, double u)
{
    const ParamInfo *info = axis->field->info;
    double low = axis->low, high = axis->high, value = low;
    if (axis->kind == AXIS_UNIFORM) {
        value = low + (high - low) * u;
    } else if (axis->kind == AXIS_LOG_UNIFORM) {
        value = low * dmath_exp2(dmath_log2(high / low) * u);
    } else {
        g_assert(axis->kind == AXIS_NORMAL);
        value = low + high * sweep_normal(u);
        bool bounded = info->low < info->high;
        low = bounded ? info->low : -1e300;
        high = bounded ? info->high : 1e300;
    }
    value = CLAMP(value, low, high);
    char *text = sweep_number_text(value, axis->digits, axis->whole);
    double rounded = g_ascii_strtod(text, NULL);
    if (rounded >= low && rounded <= high)
        return text;
    g_free(text);
    return sweep_number_text(CLAMP(rounded, low, high), 17, axis->whole);
}
