/* Fuzzes the parameter file reader: whatever the bytes, it returns parameters that write and read back alike, or an
 * error with a message that is valid UTF-8.
 *
 *     clang -fsanitize=fuzzer,address,undefined -DFUZZ …    libFuzzer
 *     fuzz_params [-n MUTATIONS] FILE …                     each as it is, then that many mutations of it */
#include <glib.h>
#include <stdlib.h>
#include <string.h>

#include "param/params.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    GError *error = NULL;
    Params *p = params_parse((const char *)data, size, "params/fuzz.ini", &error);
    if ((p == NULL) != (error != NULL))
        abort();
    if (error) {
        if (error->domain != PARAM_ERROR || !g_utf8_validate(error->message, -1, NULL))
            abort();
        g_error_free(error);
        return 0;
    }
    char *text = params_to_file(p);
    Params *q = params_parse(text, strlen(text), "params/fuzz.ini", NULL);
    if (!q && strlen(text) <= 1 << 20)
        abort();
    if (q && params_hash(q) != params_hash(p))
        abort();
    params_free(q);
    params_free(p);
    g_free(text);
    return 0;
}

#ifndef FUZZ

#include <stdio.h>

#include "geom/random.h"

/* Overwrites, deletes, doubles or inserts something at a random place, up to eight times. */
static void mutate(GByteArray *bytes, uint64_t index)
{
    static const char *const pieces[] = {"\n",  "=",        "[",   "]",    ";",    ",",    "#",
                                         "nan", "1e999",    "-",   "\xff", "\xC3", "\x01", "[veins]",
                                         "\n[", "pattern=", "0x1", "..",   " ",    "\r\n"};
    uint32_t times = 1 + random_block(1, 0, 0, index).w[0] % 8;
    for (uint32_t i = 1; i <= times; i++) {
        RandomBlock r = random_block(1, 0, i, index);
        guint at = bytes->len ? r.w[0] % bytes->len : 0, rest = bytes->len - at,
              run = rest ? 1 + r.w[1] % MIN(rest, 40) : 0;
        if (r.w[2] % 4 == 0 && rest) {
            bytes->data[at] = (guint8)r.w[3];
        } else if (r.w[2] % 4 == 1 && run) {
            g_byte_array_remove_range(bytes, at, run);
        } else if (r.w[2] % 4 == 2 && run) {
            guint8 copy[40];
            memcpy(copy, bytes->data + at, run);
            g_byte_array_append(bytes, copy, run);
        } else {
            const char *piece = pieces[r.w[3] % G_N_ELEMENTS(pieces)];
            guint length = (guint)strlen(piece);
            g_byte_array_set_size(bytes, bytes->len + length);
            memmove(bytes->data + at + length, bytes->data + at, rest);
            memcpy(bytes->data + at, piece, length);
        }
    }
}

static void feed(const char *data, gsize size, uint64_t mutations)
{
    LLVMFuzzerTestOneInput((const uint8_t *)data, size);
    for (uint64_t i = 0; i < mutations; i++) {
        GByteArray *bytes = g_byte_array_new();
        g_byte_array_append(bytes, (const guint8 *)data, (guint)size);
        mutate(bytes, i);
        LLVMFuzzerTestOneInput(bytes->data ? bytes->data : (const uint8_t *)"", bytes->len);
        g_byte_array_unref(bytes);
    }
}

int main(int argc, char **argv)
{
    uint64_t mutations = 2000;
    int first = 1;
    if (argc > 2 && strcmp(argv[1], "-n") == 0) {
        mutations = g_ascii_strtoull(argv[2], NULL, 10);
        first = 3;
    }
    Params *p = params_new();
    char *defaults = params_to_file(p);
    feed(defaults, strlen(defaults), mutations);
    feed("", 0, 10);
    for (int i = first; i < argc; i++) {
        char *data;
        gsize size;
        GError *error = NULL;
        if (!g_file_get_contents(argv[i], &data, &size, &error)) {
            fprintf(stderr, "%s\n", error->message);
            return 1;
        }
        feed(data, size, mutations);
        g_free(data);
    }
    g_free(defaults);
    params_free(p);
    return 0;
}

#endif
