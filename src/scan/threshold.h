/* Which pixels are leaf (Hong 2005, § 5.2.1): a channel of the image, a threshold on it, and the side of it that is leaf. */
#ifndef SCAN_THRESHOLD_H
#define SCAN_THRESHOLD_H

#include "scan/paper.h"
#include "scan/scan.h"

/* Where a pixel is partly transparent, colours are taken as seen on white. */
typedef enum {
    /* The one with the greatest separability, of equals the first; saturation only where it is better by 0.01; greenness where it parts nearly as well, what
     * is greener is leaf, and there is clearly more of it: then the other has but part of a green leaf, as on wood. */
    CHANNEL_BEST,
    CHANNEL_RED,
    CHANNEL_GREEN,
    CHANNEL_BLUE,
    CHANNEL_GREY,       /* (299 R + 587 G + 114 B) / 1000 */
    CHANNEL_SATURATION, /* (greatest - least) / greatest: shadows on white have little, leaves much; not in proportion to a pixel's share of leaf */
    CHANNEL_GREENNESS,  /* (2 G - R - B) / 4, from the middle of the scale: misses what is brown or red of a leaf */
    CHANNEL_ALPHA,
    CHANNEL_COUNT
} Channel;

typedef enum {
    LEAF_BY_FRAME, /* the leaf is on the side that fewer pixels along the image's frame are on, of equals the darker; but what is paper by its colours isn't leaf (turned) */
    LEAF_DARK,     /* below the threshold */
    LEAF_LIGHT,    /* not below it */
} LeafSide;

typedef struct {
    Channel channel;
    LeafSide side;
    double level; /* 0 … 255 whatever the depth; below 0: Otsu's, which parts the pixels into two classes of least variance */
} ThresholdDef;

typedef struct {
    Channel channel;
    bool dark;           /* the leaf is below the level */
    double level;        /* in values of the channel: 0 … 255, or 0 … 65535 of a 16-bit scan */
    double separability; /* variance between the two classes / total variance (Otsu 1979, η): 0 … 1 */
    double contrast;     /* between the classes' means, share of the whole scale */
    double frame;        /* share of the frame's pixels that are background */
    double leaf;         /* share of all pixels that are leaf; of those on the sheet if there is one */
    double green;        /* the same by greenness where that parts nearly as well as the best channel and says otherwise (paper on a dark ground); else 0 */
    Paper sheet;         /* that the leaf lies on and the frame is of, on another ground; beyond it nothing is leaf. Only where all is left to be found */
    bool turned;         /* the frame shows more leaf than paper, as a leaf that fills the image has it, and the sides were changed */
    bool pale;           /* what is leaf is pale and grey, what is not green: a white leaf, or holes and gaps in a leaf that fills the image */
} Threshold;

/* False with SCAN_ERROR_NO_LEAF when the image is all of one shade (contrast below 2 %), with SCAN_ERROR_VALUE for a channel that the image
 * lacks or a level beyond 255. */
bool threshold_find(const Scan *s, const ThresholdDef *def, Threshold *out, GError **error);

/* Sets mask[height][width] to 1 for leaf on the sheet, if there is one, and 0 for all else. */
void threshold_apply(const Scan *s, const Threshold *t, uint8_t *mask);

/* A pixel's value in a channel other than CHANNEL_BEST. */
uint32_t channel_value(const Scan *s, Channel channel, uint32_t x, uint32_t y);

/* "best", "red", … */
const char *channel_name(Channel channel);

#endif
