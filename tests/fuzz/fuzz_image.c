/* Images (PNG, JPEG, TIFF, with Exif or not): whatever the bytes, there is an image, or an error. */
#include <math.h>

#include "fuzz.h"
#include "scan/scan.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint64_t most = 1 << 18;
    GError *error = NULL;
    Scan *s = scan_read(fuzz_file("image", data, size), most, &error);
    fuzz_check_error(s != NULL, &error, SCAN_ERROR, 0);
    if (!s)
        return 0;
    require(s->width > 0 && s->height > 0 && (uint64_t)s->width * s->height <= most);
    require(s->channels >= 1 && s->channels <= 4 && (s->depth == 8 || s->depth == 16));
    require(isfinite(s->mm_per_pixel) && s->mm_per_pixel >= 0.0);
    uint32_t sum = 0; /* every sample is there and was written: a sanitizer sees */
    for (size_t i = 0; i < (size_t)s->width * s->height * s->channels; i++)
        sum += s->depth == 8 ? ((const uint8_t *)s->px)[i] : ((const uint16_t *)s->px)[i];
    require(sum == sum);
    scan_free(s);
    return 0;
}
