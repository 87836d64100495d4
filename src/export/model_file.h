/* What the writers of bent leaves share: axes, comments, names, pairs of files. */
#ifndef EXPORT_MODEL_FILE_H
#define EXPORT_MODEL_FILE_H

#include "export/model.h"
#include "export/sink.h"

/* Leaf space to the axes of glTF, OBJ and PLY, which are right-handed with y up: the leaf lies with its sunny side up (+y), its tip away
 * from the viewer (-z) and its right side to the right (+x). Programs with z up (Blender) turn that back into leaf space by themselves.
 * Adding 0 makes no number -0. */
static inline Vec3 model_axes(Vec3 p) { return vec3(p.x + 0.0, p.z + 0.0, 0.0 - p.y); }
static inline Vec3 model_metres(const Model *m, Vec3 p) { return model_axes(vec3_scale(p, m->unit)); }

/* A normal of unit length; up where there is none. */
static inline Vec3 model_normal(Vec3 n) { return model_axes(vec3_unit(n, vec3(0.0, 0.0, 1.0))); }

/* Text on one line, control characters as spaces. */
void model_put_line(GString *s, const char *text);

/* The model's name in ASCII letters, digits, '-', '_' and '.', so that every reader takes it for one word. */
char *model_word(const Model *m);

/* Removes what there is of a file that is not to be; its former contents stay. */
void model_abandon(Sink *s);

/* Closes two files that only make sense together: both appear, or neither. */
gboolean model_close_pair(Sink *first, Sink *second, GError **error);

#endif
