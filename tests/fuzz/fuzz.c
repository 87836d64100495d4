#include "fuzz.h"

#include <fcntl.h>
#include <glib/gstdio.h>
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

#include "geom/random.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define __SANITIZE_ADDRESS__ 1
#endif
#endif

void fuzz_broken(const char *promise, const char *file, int line)
{
    fprintf(stderr, "%s:%d: broken: %s\n", file, line, promise);
    abort();
}

/* ---- files ---- */

static char *folder; /* the only global: libFuzzer calls without a handle */

static void remove_folder(void)
{
    GDir *dir = g_dir_open(folder, 0, NULL);
    const char *name;
    while (dir && (name = g_dir_read_name(dir))) {
        char *path = g_build_filename(folder, name, NULL);
        g_unlink(path);
        g_free(path);
    }
    if (dir)
        g_dir_close(dir);
    g_rmdir(folder);
    g_free(folder);
}

const char *fuzz_file(const char *name, const void *data, size_t size)
{
    static char path[512];
    if (!folder) {
        folder = g_dir_make_tmp("venation-fuzz-XXXXXX", NULL);
        require(folder != NULL);
        atexit(remove_folder);
    }
    g_snprintf(path, sizeof path, "%s/%s", folder, name);
    int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    require(fd >= 0 && (size == 0 || write(fd, data, size) == (ssize_t)size) && close(fd) == 0);
    return path;
}

/* ---- promises ---- */

void fuzz_check_error(bool result, GError **error, ...)
{
    require(result == (*error == NULL));
    if (!*error)
        return;
    va_list domains;
    bool known = false;
    va_start(domains, error);
    for (GQuark domain; !known && (domain = va_arg(domains, GQuark)) != 0;)
        known = (*error)->domain == domain;
    va_end(domains);
    if (!known)
        fprintf(stderr, "error of domain %s: %s\n", g_quark_to_string((*error)->domain), (*error)->message);
    require(known);
    require(*(*error)->message && g_utf8_validate((*error)->message, -1, NULL));
    g_clear_error(error);
}

char *fuzz_part(const uint8_t *data, size_t size, unsigned k)
{
    char *text = size ? g_strndup((const char *)data, size) : g_strdup(""), **part = g_strsplit(text, "\n%%\n", (gint)k + 2);
    char *out = g_strdup(g_strv_length(part) > k ? part[k] : "");
    g_strfreev(part);
    g_free(text);
    return out;
}

#ifndef FUZZ

/* Small inputs ask for little memory: more than this is none. But sanitizers reserve terabytes. */
static void limit_memory(void)
{
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    struct rlimit memory = {(rlim_t)1 << 30, (rlim_t)1 << 30};
    setrlimit(RLIMIT_AS, &memory);
#endif
}

/* ---- a dictionary, as libFuzzer has it: "bytes with \xNN" a line, perhaps after name= ---- */

static GPtrArray *read_dictionary(const char *path)
{
    GPtrArray *words = g_ptr_array_new_with_free_func((GDestroyNotify)g_bytes_unref);
    char *text, **line;
    require(g_file_get_contents(path, &text, NULL, NULL));
    line = g_strsplit(text, "\n", -1);
    for (char **l = line; *l; l++) {
        char *from = strchr(*l, '"'), *to = strrchr(*l, '"');
        if (**l == '#' || !from || from == to)
            continue;
        GByteArray *word = g_byte_array_new();
        for (char *c = from + 1; c < to; c++) {
            guint8 byte = (guint8)*c;
            if (*c == '\\' && c[1] == 'x') {
                byte = (guint8)(g_ascii_xdigit_value(c[2]) * 16 + g_ascii_xdigit_value(c[3]));
                c += 3;
            } else if (*c == '\\') {
                byte = (guint8)*++c;
            }
            g_byte_array_append(word, &byte, 1);
        }
        g_ptr_array_add(words, g_byte_array_free_to_bytes(word));
    }
    g_strfreev(line);
    g_free(text);
    return words;
}

/* ---- mutations; of input and index alone ---- */

static void insert(GByteArray *bytes, guint at, const void *data, guint length)
{
    guint rest = bytes->len - at;
    g_byte_array_set_size(bytes, bytes->len + length);
    memmove(bytes->data + at + length, bytes->data + at, rest);
    memcpy(bytes->data + at, data, length);
}

/* Overwrites, deletes, doubles or inserts something at a random place, up to eight times. */
static void mutate(GByteArray *bytes, const GPtrArray *words, uint64_t index)
{
    uint32_t times = 1 + random_block(1, 0, 0, index).w[0] % 8;
    for (uint32_t i = 1; i <= times; i++) {
        RandomBlock r = random_block(1, 0, i, index);
        guint at = bytes->len ? r.w[0] % bytes->len : 0, rest = bytes->len - at, run = rest ? 1 + r.w[1] % MIN(rest, 200) : 0;
        if (r.w[2] % 4 == 0 && rest) { /* mostly a digit for a digit, which leaves a text that can be read */
            bool digit = g_ascii_isdigit(bytes->data[at]);
            bytes->data[at] = digit ? (guint8)('0' + r.w[3] % 10) : (guint8)r.w[3];
        } else if (r.w[2] % 4 == 1 && run) {
            g_byte_array_remove_range(bytes, at, run);
        } else if (r.w[2] % 4 == 2 && run) {
            guint8 copy[200];
            memcpy(copy, bytes->data + at, run);
            insert(bytes, r.w[3] % bytes->len, copy, run);
        } else if (words->len) {
            gsize length;
            const void *word = g_bytes_get_data(words->pdata[r.w[3] % words->len], &length);
            insert(bytes, at, word, (guint)length);
        }
    }
}

/* Drops, doubles and swaps whole lines, and changes digits: what comes out is mostly well-formed. */
static void mutate_lines(GByteArray *bytes, uint64_t index)
{
    char *text = bytes->len ? g_strndup((const char *)bytes->data, bytes->len) : g_strdup(""), **line = g_strsplit(text, "\n", -1);
    guint n = g_strv_length(line);
    uint32_t times = n ? random_block(2, 0, 0, index).w[0] % 4 : 0;
    for (uint32_t i = 1; i <= times; i++) {
        RandomBlock r = random_block(2, 0, i, index);
        guint a = r.w[0] % n, b = r.w[1] % n;
        if (r.w[2] % 3 == 2) {
            char *swap = line[a];
            line[a] = line[b];
            line[b] = swap;
        } else {
            char *other = g_strdup(r.w[2] % 3 == 0 ? "" : line[b]);
            g_free(line[a]);
            line[a] = other;
        }
    }
    g_free(text);
    text = g_strjoinv("\n", line);
    g_strfreev(line);
    for (uint32_t i = 0; i < random_block(2, 1, 0, index).w[0] % 6 && *text; i++) {
        RandomBlock r = random_block(2, 1, i, index);
        char *at = text + r.w[0] % strlen(text), *digit = strpbrk(at, "0123456789");
        if (digit)
            *digit = (char)('0' + r.w[1] % 10);
    }
    g_byte_array_set_size(bytes, 0);
    g_byte_array_append(bytes, (const guint8 *)text, (guint)strlen(text));
    g_free(text);
}

/* ---- the inputs ---- */

static void feed(const GByteArray *bytes)
{
    /* a block of its own size, so that a sanitizer sees what reads beyond it */
    guint8 *data = g_memdup2(bytes->data, bytes->len);
    LLVMFuzzerTestOneInput(data ? data : (const uint8_t *)"", bytes->len);
    g_free(data);
}

static gint by_name(gconstpointer a, gconstpointer b) { return strcmp(*(char *const *)a, *(char *const *)b); }

static void add_inputs(GPtrArray *inputs, const char *path)
{
    if (g_file_test(path, G_FILE_TEST_IS_DIR)) {
        GPtrArray *names = g_ptr_array_new_with_free_func(g_free);
        GDir *dir = g_dir_open(path, 0, NULL);
        require(dir != NULL);
        for (const char *name; (name = g_dir_read_name(dir)) != NULL;)
            g_ptr_array_add(names, g_build_filename(path, name, NULL));
        g_dir_close(dir);
        g_ptr_array_sort(names, by_name);
        for (guint i = 0; i < names->len; i++)
            add_inputs(inputs, names->pdata[i]);
        g_ptr_array_unref(names);
        return;
    }
    char *data;
    gsize size;
    GError *error = NULL;
    if (!g_file_get_contents(path, &data, &size, &error)) {
        fprintf(stderr, "%s\n", error->message);
        exit(1);
    }
    g_ptr_array_add(inputs, g_byte_array_new_take((guint8 *)data, size));
}

int main(int argc, char **argv)
{
    uint64_t mutations = 2000;
    limit_memory();
    GPtrArray *words = NULL, *inputs = g_ptr_array_new_with_free_func((GDestroyNotify)g_byte_array_unref);
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "-n") == 0 && i + 1 < argc)
            mutations = g_ascii_strtoull(argv[++i], NULL, 10);
        else if (strcmp(argv[i], "-d") == 0 && i + 1 < argc)
            words = read_dictionary(argv[++i]);
        else
            add_inputs(inputs, argv[i]);
    }
    if (!words)
        words = g_ptr_array_new();
    g_ptr_array_add(inputs, g_byte_array_new());
    for (guint i = 0; i < inputs->len; i++)
        feed(inputs->pdata[i]);
    for (uint64_t i = 0; i < mutations; i++) {
        const GByteArray *from = inputs->pdata[i % inputs->len];
        GByteArray *bytes = g_byte_array_new();
        g_byte_array_append(bytes, from->data, from->len);
        if (i / inputs->len % 2 && from->len && !memchr(from->data, 0, from->len))
            mutate_lines(bytes, i);
        else
            mutate(bytes, words, i);
        feed(bytes);
        g_byte_array_unref(bytes);
    }
    g_ptr_array_unref(words);
    g_ptr_array_unref(inputs);
    return 0;
}

#endif
