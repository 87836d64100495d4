/* Where about a leaf is, by its level: what the edges of its margin are looked for around. */
#ifndef SCAN_FANG_ROUGH_H
#define SCAN_FANG_ROUGH_H

#include "scan/fang.h"
#include "scan/mask.h"

/* Marks def->leaf by MASK_LEAF and no other bit in a mask of the scan's size, and gives its box: a part on the leaf's side of the threshold
 * after closing and opening, counted as profile_capture counts them, with its holes filled and without threads (a grid's lines, hairs;
 * up to 5 pixels wide). SCAN_ERROR_NO_LEAF when there is none, SCAN_ERROR_VALUE when there are fewer leaves. */
bool fang_rough(const Scan *s, const Threshold *t, const FangDef *def, const Mask *m, MaskBox *box, GError **error);

#endif
