/* What separability and frame can't tell (threshold.h): a sheet of paper that lies on another ground, and a leaf that fills the image. Private to threshold*.c. */
#ifndef SCAN_THRESHOLD_SHEET_H
#define SCAN_THRESHOLD_SHEET_H

#include "scan/threshold.h"

/* By the pixels on a sheet alone, in its shape the frame; of the whole image when it has no corners. */
void threshold_find_on(const Scan *s, const ThresholdDef *def, const Paper *sheet, Threshold *out);

/* Otsu's two classes are sheet and table where the sheet is large: if *t, of the whole image, has such a sheet for a leaf or for what lies behind one, and there is
 * a leaf on it, *t becomes what finds that, and true is returned. */
bool threshold_look_for_sheet(const Scan *s, const ThresholdDef *def, Threshold *t);

/* Where the frame shows both classes it can't tell leaf from paper, but their colours do. Sets t->turned and t->pale. */
void threshold_look_at_sides(const Scan *s, Threshold *t);

#endif
