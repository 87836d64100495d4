/* Parameter files: whatever the bytes, there are parameters that write and read back alike, or an error. */
#include "fuzz.h"
#include "param/params.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    GError *error = NULL;
    Params *p = params_parse((const char *)data, size, "params/fuzz.ini", &error);
    fuzz_check_error(p != NULL, &error, PARAM_ERROR, 0);
    if (!p)
        return 0;
    char *text = params_to_file(p);
    Params *q = params_parse(text, strlen(text), "params/fuzz.ini", NULL);
    require(q || strlen(text) > 1 << 20);
    require(!q || params_hash(q) == params_hash(p));
    params_free(q);
    params_free(p);
    g_free(text);
    return 0;
}
