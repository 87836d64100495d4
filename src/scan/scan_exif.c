/* The few facts wanted from an Exif block (Exif 2.3, § 4.6): a TIFF header and its first directory. */
#include <string.h>

#include "scan/scan_file.h"

enum { TAG_ORIENTATION = 0x0112, TAG_X_RESOLUTION = 0x011A, TAG_Y_RESOLUTION = 0x011B, TAG_RESOLUTION_UNIT = 0x0128 };
enum { TYPE_SHORT = 3, TYPE_RATIONAL = 5 };

typedef struct {
    const uint8_t *data;
    size_t n;
    bool little; /* endian */
} Block;

/* The number of `size` bytes at `at`; 0 beyond the end. */
static uint32_t number(const Block *b, size_t at, size_t size)
{
    if (at > b->n || b->n - at < size)
        return 0;
    uint32_t v = 0;
    for (size_t i = 0; i < size; i++)
        v = v << 8 | b->data[at + (b->little ? size - 1 - i : i)];
    return v;
}

static double rational(const Block *b, size_t at)
{
    uint32_t over = number(b, at, 4), under = number(b, at + 4, 4);
    return under ? (double)over / (double)under : 0.0;
}

void scan_file_exif(ScanFile *f, const uint8_t *data, size_t n)
{
    Block b = {data, n, n >= 4 && !memcmp(data, "II*\0", 4)};
    if (!b.little && (n < 4 || memcmp(data, "MM\0*", 4) != 0))
        return;
    size_t at = number(&b, 4, 4);
    uint32_t entries = number(&b, at, 2), orientation = 0, unit = 2;
    double across = 0.0, down = 0.0;
    for (uint32_t i = 0; i < entries && at + 2 + 12 * (size_t)(i + 1) <= n; i++) {
        size_t e = at + 2 + 12 * (size_t)i;
        uint32_t tag = number(&b, e, 2), type = number(&b, e + 2, 2);
        if (tag == TAG_ORIENTATION && type == TYPE_SHORT)
            orientation = number(&b, e + 8, 2);
        else if (tag == TAG_RESOLUTION_UNIT && type == TYPE_SHORT)
            unit = number(&b, e + 8, 2);
        else if (tag == TAG_X_RESOLUTION && type == TYPE_RATIONAL)
            across = rational(&b, number(&b, e + 8, 4));
        else if (tag == TAG_Y_RESOLUTION && type == TYPE_RATIONAL)
            down = rational(&b, number(&b, e + 8, 4));
    }
    if (f->orientation == 0)
        f->orientation = orientation;
    double mm = unit == 2 ? 25.4 : unit == 3 ? 10.0 : 0.0;
    if (!(f->across_mm > 0.0) && mm > 0.0) {
        f->across_mm = across / mm;
        f->down_mm = down / mm;
    }
}
