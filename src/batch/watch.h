/* Who watches work that goes on for a while. */
#ifndef BATCH_WATCH_H
#define BATCH_WATCH_H

#include <gio/gio.h>

/* `tick` (may be NULL) is told how much is done, 0 … 1, on the thread that works; FALSE stops it. */
typedef struct {
    gboolean (*tick)(double part, gpointer user);
    gpointer user;
} Watch;

/* FALSE with G_IO_ERROR_CANCELLED if the work is to stop. */
static inline gboolean watch_tick(const Watch *w, double part, GError **error)
{
    if (!w->tick || w->tick(part, w->user))
        return TRUE;
    g_set_error_literal(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
    return FALSE;
}

#endif
