/* A picture of the leaf as a scanner or a camera sees it: on paper, lit, blurred and noisy. Pixels lie where those of the other maps of
 * the frame lie. */
#ifndef IMAGE_SPECIMEN_H
#define IMAGE_SPECIMEN_H

#include "image/paint.h"

/* Everything but the colour of the background is 0 for the plain picture: the base colour over the background by opacity, in linear light. */
typedef struct {
    bool abaxial;        /* the shadow side */
    float background[3]; /* linear light */
    double grain;        /* unevenness of the paper, 0 … 1 */
    double light;        /* how much the light comes from one side, 0 … 2: 1 shades as light at 45° does */
    double light_angle;  /* where from, degrees counter-clockwise from the right */
    double backlight;    /* part of the light that comes through the leaf, 0 … 1 */
    double sheen;        /* light that the surface throws back before it meets any pigment, 0 … 1 */
    double falloff;      /* part of the light that is lost on the way across the image, away from where it comes from */
    double vignette;     /* the same towards the corners */
    double shadow;       /* of the leaf on the background, 0 none … 1 black where it is deepest */
    double shadow_size;  /* width of its soft edge, parts of the image's longer side */
    double blur;         /* standard deviation, pixels */
    double exposure;     /* stops */
    double contrast;     /* -1 … 1 */
    double warmth;       /* white balance, -1 blue … 1 yellow */
    double noise;        /* standard deviation at white, parts of it; in the dark about the same to the eye, as photons come one by one */
    double chroma_noise; /* the same of red against blue, and of both against green */
    uint64_t seed;       /* of paper and noise */
} SpecimenDef;

SpecimenDef specimen_def_default(void);

typedef struct Specimen Specimen;

/* Makes a painter ready for specimens; it must outlive what is returned. */
Specimen *specimen_new(Painter *p, const SpecimenDef *def);
void specimen_free(Specimen *s);

/* The painted rows: three channels of linear light. Depends on the painter's network, frame and style and on the definition alone. */
Plane *specimen_paint(Specimen *s);

#endif
