#include "export/sink.h"

#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <math.h>
#include <stdbool.h>
#include <unistd.h>

#include "export/export.h"

#define DRAIN_AT (1u << 20) /* bytes */

static void fail(GError **error, const char *target, int code)
{
    char *name = g_filename_display_name(target);
    g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(code), "%s: cannot be written: %s", name,
                g_strerror(code));
    g_free(name);
}

static void sink_free(Sink *s)
{
    g_string_free(s->text, TRUE);
    g_free(s->target);
    g_free(s->part);
    g_free(s);
}

Sink *sink_open(const char *target, GError **error)
{
    char *part = g_strconcat(target, ".XXXXXX", NULL);
    int fd = g_mkstemp_full(part, O_WRONLY | O_CLOEXEC, 0666); /* less the umask, as any other file */
    if (fd < 0) {
        fail(error, target, errno);
        g_free(part);
        return NULL;
    }
    Sink *s = g_new0(Sink, 1);
    s->text = g_string_sized_new(DRAIN_AT + DRAIN_AT / 4);
    s->target = g_strdup(target);
    s->part = part;
    s->fd = fd;
    return s;
}

static void write_out(Sink *s)
{
    const char *at = s->text->str;
    gsize left = s->text->len;
    while (left > 0 && s->error == 0) {
        ssize_t n = write(s->fd, at, left);
        if (n > 0) {
            at += n;
            left -= (gsize)n;
        } else if (n == 0) {
            s->error = ENOSPC;
        } else if (errno != EINTR) {
            s->error = errno;
        }
    }
    g_string_truncate(s->text, 0);
}

void sink_drain(Sink *s)
{
    if (s->text->len >= DRAIN_AT)
        write_out(s);
}

gboolean sink_close(Sink *s, GError **error)
{
    write_out(s);
    if (close(s->fd) != 0 && s->error == 0) /* network file systems report a full disk only here */
        s->error = errno;
    if (s->error == 0 && g_rename(s->part, s->target) != 0)
        s->error = errno;
    int code = s->error;
    if (code != 0) {
        g_unlink(s->part);
        fail(error, s->target, code);
    }
    sink_free(s);
    return code == 0;
}

/* Writes the digits before `end`; returns where they begin. */
static char *digits(char *end, uint64_t value)
{
    do {
        *--end = (char)('0' + value % 10);
        value /= 10;
    } while (value > 0);
    return end;
}

void sink_uint(GString *s, uint64_t value)
{
    char text[20], *end = text + sizeof text, *at = digits(end, value);
    g_string_append_len(s, at, end - at);
}

/* f * 1e6 for 0 <= f < 1, rounded half to even. f = (whole + rest) / 2^53; the product is whole * 1e6, 73 bits in two
 * parts, and rest * 1e6, which is exact as rest is 0 or, since f is not below 2^-22, has 22 bits. */
static uint64_t millionths(double f)
{
    if (f < 0x1p-22)
        return 0; /* and so below half a millionth */
    double scaled = f * 0x1p53, below = floor(scaled), rest = (scaled - below) * 1e6;
    uint64_t whole = (uint64_t)below, extra = (uint64_t)rest;
    uint64_t low = (whole & 0xFFFFFFFFu) * 1000000u + extra, high = (whole >> 32) * 1000000u + (low >> 32);
    uint64_t n = high >> 21, left = (high & 0x1FFFFFu) << 32 | (low & 0xFFFFFFFFu), half = UINT64_C(1) << 52;
    bool odd = n % 2 != 0, more = rest > (double)extra;
    return left > half || (left == half && (odd || more)) ? n + 1 : n;
}

void sink_millionths(GString *s, double value)
{
    double size = fabs(value);
    if (!(size < 1e12)) {
        export_number(s, value);
        return;
    }
    uint64_t whole = (uint64_t)size, part = millionths(size - (double)whole);
    if (part == 1000000) {
        whole++;
        part = 0;
    }
    char text[24], *end = text + sizeof text, *at = end;
    if (part > 0) {
        int places = 6;
        for (; part % 10 == 0; part /= 10)
            places--;
        for (; places > 0; places--, part /= 10)
            *--at = (char)('0' + part % 10);
        *--at = '.';
    }
    bool negative = value < 0.0 && (whole > 0 || at < end);
    at = digits(at, whole);
    if (negative)
        *--at = '-';
    g_string_append_len(s, at, end - at);
}

void sink_size(GString *s, double value)
{
    if (fabs(value) < 0.01 && value != 0.0)
        export_number(s, value);
    else
        sink_millionths(s, value);
}

int64_t sink_round_hundredths(double value)
{
    const double limit = 9e15; /* whole doubles below this are exact, and fit */
    double h = floor(value * 100.0 + 0.5);
    return !(h > -limit) ? (int64_t)-limit : h > limit ? (int64_t)limit : (int64_t)h;
}

void sink_hundredths(GString *s, int64_t hundredths)
{
    uint64_t h = hundredths < 0 ? 0u - (uint64_t)hundredths : (uint64_t)hundredths;
    uint64_t part = h % 100;
    if (hundredths < 0)
        g_string_append_c(s, '-');
    sink_uint(s, h / 100);
    if (part == 0)
        return;
    g_string_append_c(s, '.');
    g_string_append_c(s, (char)('0' + part / 10));
    if (part % 10 != 0)
        g_string_append_c(s, (char)('0' + part % 10));
}
