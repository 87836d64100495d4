/* A text file that appears whole or not at all: written beside its target, renamed when complete. */
#ifndef EXPORT_SINK_H
#define EXPORT_SINK_H

#include <glib.h>
#include <stdint.h>

typedef struct {
    GString *text; /* what is not yet in the file; writers append here and call sink_drain now and then */
    char *target, *part;
    int fd;
    int error; /* errno of the first failed write, 0: none */
} Sink;

/* Makes the file beside `target`. NULL with an error in G_FILE_ERROR. */
Sink *sink_open(const char *target, GError **error);

/* Moves the text to the file once there is enough of it, so that a large network needs little memory. */
void sink_drain(Sink *s);

/* Completes, renames and frees. On failure nothing is left of it, and a former target is as it was. */
gboolean sink_close(Sink *s, GError **error);

/* Whole numbers, and numbers rounded to hundredths without needless zeros ("-0.5", "12"): fast, and alike in every
 * locale. */
void sink_uint(GString *s, uint64_t value);
void sink_hundredths(GString *s, int64_t hundredths);
int64_t sink_round_hundredths(double value);

/* A number rounded to millionths, half to even and exactly, without needless zeros ("-0.25", "3.000001", "0" for what
 * rounds to it); beyond 1e12 and for NaN and infinity as export_number. */
void sink_millionths(GString *s, double value);

/* The same for sizes that may be tiny: below 0.01 as many digits as read back exactly. */
void sink_size(GString *s, double value);

#endif
