/* The steps on the way to what a leaf starts from (ground.h), one file each. Private to src/lib/ground*.c. */
#ifndef LIB_GROUND_PRIVATE_H
#define LIB_GROUND_PRIVATE_H

#include "geom/svgplace.h"
#include "lib/ground.h"
#include "lib/settings.h"

struct GroundScan {
    Scan *scan, *back;        /* back: NULL when none is given */
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

/* ---- ground_scan.c ---- */

/* The scan and its back, read anew or as the sheet has them; *back_profiles receives the leaves on the back, NULL without one. */
gboolean ground_read_scans(Ground *g, const Params *p, const GroundScan *sheet, GPtrArray **back_profiles, GError **error);

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

/* Makes the scans textures: they are looked at no more. */
void ground_make_textures(Ground *g, const Params *p);

#endif
