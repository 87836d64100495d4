#include "export/model_file.h"

#include <errno.h>
#include <glib/gstdio.h>

void model_put_line(GString *s, const char *text)
{
    for (const char *c = text; *c != '\0'; c++)
        g_string_append_c(s, (unsigned char)*c < 0x20 || *c == 0x7f ? ' ' : *c);
}

char *model_word(const Model *m)
{
    char *word = g_strdup(m->name != NULL && m->name[0] != '\0' ? m->name : "leaf");
    return g_strcanon(word, G_CSET_a_2_z G_CSET_A_2_Z G_CSET_DIGITS "-_.", '_');
}

void model_abandon(Sink *s)
{
    if (s->error == 0)
        s->error = ECANCELED; /* a sink with an error is removed */
    sink_close(s, NULL);
}

gboolean model_close_pair(Sink *first, Sink *second, GError **error)
{
    char *path = g_strdup(first->target);
    gboolean ok = sink_close(first, error);
    if (!ok) {
        model_abandon(second);
    } else if (!sink_close(second, error)) {
        g_unlink(path);
        ok = FALSE;
    }
    g_free(path);
    return ok;
}
