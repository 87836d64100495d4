/* The steps on the way to what a leaf starts from (ground.h), one file each. Private to src/lib/ground*.c. */
#ifndef LIB_GROUND_PRIVATE_H
#define LIB_GROUND_PRIVATE_H

#include "geom/svgplace.h"
#include "lib/ground.h"
#include "lib/settings.h"

typedef struct {
    uint32_t width, height; /* pixels; 0: there is none */
} ScanSize;

struct GroundScan {
    Scan *scan, *back;        /* NULL: lent to a leaf or kept by one, or no back is given */
    ScanSize size, back_size;
    GPtrArray *profile;       /* Profile; NULL for those that were given away */
    GPtrArray *back_profile;  /* of the leaves on the back; NULL when none is given */
    Threshold threshold;
};

/* ---- ground.c ---- */

/* Leaf coordinates to columns and rows of an image of that height whose y-up pixels the ends are in. */
Affine ground_to_pixels(Vec2 base, Vec2 tip, uint32_t height);

/* Source units, y up, to leaf coordinates: base to 0,0, tip to 0,1. */
Vec2 ground_to_leaf(const Ground *g, Vec2 p);

/* The outline as it lies in a scan, y-up pixels. */
Polygon *ground_outline_in(const Ground *g, const Scan *scan, const Affine *to_scan);

/* Names the image in what went wrong with it; always FALSE. */
gboolean ground_blame(const Params *p, ParamId id, GError **error);

/* Where a drawing lies on the scan; false where that can't be told: what is wrong with the file its reader will say. */
bool ground_place(const Ground *g, const Params *p, const char *file, SvgPlace *place);

/* How a drawing lies on the scan, in words: as `place` has it, which gives its words away, or NULL by its numbers. NULL without a scan. */
char *ground_lies(const Ground *g, SvgPlace *place);

/* ---- ground_scan.c ---- */

/* The scan and its back, read anew or lent by the sheet; *back_profiles receives the leaves on the back, NULL without one. */
gboolean ground_read_scans(Ground *g, const Params *p, GroundScan *sheet, GPtrArray **back_profiles, GError **error);

/* Once nothing else is to be found in them, lent scans go back to the sheet, and the leaf has a copy of what lies around it; but one that takes up most of a
 * scan keeps it, as two of it might be too many for the memory. */
gboolean ground_part_scans(Ground *g, const Params *p, GroundScan *sheet, GError **error);

/* Gives lent scans back as they are, when there will be no leaf. */
void ground_return_scans(Ground *g, GroundScan *sheet);

/* ---- ground_outline.c ---- */

gboolean ground_find_outline(Ground *g, const Params *p, GroundScan *sheet, GError **error);

/* ---- ground_back.c ---- */

/* Lays the back onto the outline. */
gboolean ground_find_back(Ground *g, const Params *p, const GPtrArray *all, GError **error);

/* ---- ground_veins.c ---- */

gboolean ground_find_veins(Ground *g, const Params *p, GError **error);

/* ---- ground_colour.c ---- */

/* Openings in the blade, whatever its outline comes from. */
void ground_find_holes(Ground *g, const Params *p);

/* Parts the scans from the sheet, if there is one, and makes them textures: they are looked at no more. */
gboolean ground_make_textures(Ground *g, const Params *p, GroundScan *sheet, GError **error);

#endif
