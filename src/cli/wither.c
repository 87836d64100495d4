#include "cli/wither.h"

#include <string.h>

enum { STAGES = 6 };

/* At ages 0, 0.2 … 1, as the six stages of Hong 2005, figs. 8.5 and 8.9, are coloured in params/scenes/aging.pov: sRGB, mixed with as much of the leaf's own. */
static const struct {
    const char *key;
    uint32_t colour[STAGES];
} dried[] = {
    {"texture.lamina_colour", {0x5b7a2a, 0x667c2a, 0x8b862a, 0xac802b, 0x8a5724, 0x5c3a1c}},
    {"texture.vein_colour", {0xc9cc88, 0xcfcc88, 0xd6c98a, 0xcdb27a, 0xa98655, 0x86683f}},
    {"texture.abaxial_lamina_colour", {0x86a06e, 0x98a266, 0xaea064, 0xb79a63, 0xa98455, 0x8a6a45}},
    {"texture.abaxial_vein_colour", {0xc6cc88, 0xc9ca86, 0xd0c483, 0xc2a468, 0x9a7748, 0x765a36}},
    {"texture.margin_colour", {0x5f7f33, 0x76802e, 0x8a7a2a, 0x946428, 0x714520, 0x4a2d18}}, /* dries first */
};
static const double own_part[STAGES] = {1.0, 0.6, 0.3, 0.15, 0.1, 0.05};

static double between(const double *stage, double age)
{
    double at = CLAMP(age, 0.0, 1.0) * (STAGES - 1);
    int k = MIN((int)at, STAGES - 2);
    return stage[k] + (stage[k + 1] - stage[k]) * (at - k);
}

static double channel_of(uint32_t colour, int shift) { return colour >> shift & 255; }

static uint32_t aged(uint32_t own, const uint32_t stage[STAGES], double age)
{
    uint32_t colour = 0;
    for (int shift = 16; shift >= 0; shift -= 8) {
        double value[STAGES], part = between(own_part, age);
        for (int k = 0; k < STAGES; k++)
            value[k] = channel_of(stage[k], shift);
        double mixed = channel_of(own, shift) * part + between(value, age) * (1.0 - part);
        colour |= (uint32_t)(mixed + 0.5) << shift;
    }
    return colour;
}

static gboolean is_set(const Run *run, const char *key)
{
    gsize n = strlen(key);
    for (char **s = run->args->set; s && *s; s++)
        if (strncmp(*s, key, n) == 0 && (*s)[n] == '=')
            return TRUE;
    return FALSE;
}

static double get_number(const Run *run, const char *key)
{
    char *text = ven_params_get(run->params, key);
    double value = g_ascii_strtod(text, NULL);
    g_free(text);
    return value;
}

static gboolean set_colour(Run *run, const char *key, const uint32_t stage[STAGES], double age, GError **error)
{
    char *own = ven_params_get(run->params, key), *now = g_strdup_printf("#%06x", aged((uint32_t)g_ascii_strtoull(own + 1, NULL, 16), stage, age));
    gboolean good = is_set(run, key) || run_set(run, key, now, error);
    g_free(own);
    g_free(now);
    return good;
}

static gboolean set_number(Run *run, const char *key, double value, GError **error)
{
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    return is_set(run, key) || run_set(run, key, g_ascii_formatd(text, sizeof text, "%.4f", value), error);
}

gboolean wither_colours(Run *run, GError **error)
{
    double age = get_number(run, "pose.age"), gloss = get_number(run, "texture.gloss"), variation = get_number(run, "texture.variation");
    for (gsize i = 0; i < G_N_ELEMENTS(dried); i++)
        if (!set_colour(run, dried[i].key, dried[i].colour, age, error))
            return FALSE;
    return set_number(run, "texture.gloss", gloss * (1.0 - 0.8 * age), error) &&
           set_number(run, "texture.variation", variation + MAX(0.0, 0.8 - variation) * age, error);
}
