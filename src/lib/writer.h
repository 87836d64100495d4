/* What writes the files of one leaf: where to, under which name, with which metadata. */
#ifndef LIB_WRITER_H
#define LIB_WRITER_H

#include "image/file.h"
#include "image/paint.h"
#include "image/photo.h"
#include "lib/leaf.h"

enum { WRITER_META = 5 };

typedef struct {
    const VenLeaf *leaf;
    const char *dir, *name;
    char *value[WRITER_META];
    Metadata meta;
    int depth; /* bits a channel of PNG */
    int exr;   /* 0 none, 1 half, 2 float */
    Photo *photo[2]; /* the scan as colours of the sunny and the shadow side, or NULL */
} Writer;

void writer_init(Writer *w, const VenLeaf *leaf, const char *dir, const char *name);
void writer_clear(Writer *w);

/* <dir>/<name><suffix>; free it. */
char *writer_path(const Writer *w, const char *suffix);

/* Makes the folder and those above it where they are missing. */
gboolean writer_make_dir(const Writer *w, GError **error);

/* A painter of the leaf as its parameters ask; `frame` and the leaf outlive it. */
Painter *writer_painter(const Writer *w, const Frame *frame);

#endif
