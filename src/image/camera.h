/* What a camera or scanner makes of the light that reaches it: blurs it, sets its level, adds noise. */
#ifndef IMAGE_CAMERA_H
#define IMAGE_CAMERA_H

#include "image/plane.h"
#include "image/specimen.h"

typedef struct {
    double *weight;  /* [2 reach + 1] of the blur; NULL: none */
    uint32_t reach;  /* pixels */
    double gain[3];  /* of the channels */
    double contrast, noise, chroma_noise;
    uint64_t seed;
} Camera;

void camera_init(Camera *c, const SpecimenDef *def);
void camera_clear(Camera *c);

/* Row y of the image from a scene of three channels of linear light whose first row is row `top`; it has the rows that lie within reach, and beyond the
 * image its edge goes on. Uses `scratch`, as long as a row of the scene. */
void camera_row(const Camera *c, const Plane *scene, uint32_t top, uint32_t y, float *scratch, float *out);

#endif
