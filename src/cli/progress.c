#include "cli/progress.h"

#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "cli/cli.h"

struct Progress {
    char *label;
    gint64 begun, drawn; /* monotonic time, µs */
    int length;          /* columns the line takes now */
    gboolean colour, utf8;
};

Progress *progress_new(const char *label)
{
    if (!isatty(STDERR_FILENO))
        return NULL;
    const char *no_color = g_getenv("NO_COLOR"), *term = g_getenv("TERM");
    Progress *p = g_new0(Progress, 1);
    p->label = g_strdup(label);
    p->begun = g_get_monotonic_time();
    p->colour = !(no_color && *no_color) && term && *term && strcmp(term, "dumb") != 0;
    p->utf8 = g_get_charset(NULL);
    return p;
}

void progress_free(Progress *p)
{
    if (!p)
        return;
    progress_clear(p);
    g_free(p->label);
    g_free(p);
}

static int columns(void)
{
    struct winsize size;
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

static void append_bar(GString *s, const Progress *p, int width, double done)
{
    static const char *const eighths[] = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
    int parts = p->utf8 ? 8 : 1, full = (int)(done * width * parts);
    g_string_append(s, p->colour ? "\033[32m" : "");
    for (int i = 0; i < full / parts; i++)
        g_string_append(s, p->utf8 ? "█" : "#");
    int filled = full / parts;
    if (full % parts) {
        g_string_append(s, eighths[full % parts]);
        filled++;
    }
    g_string_append(s, p->colour ? "\033[0;2m" : "");
    for (; filled < width; filled++)
        g_string_append(s, p->utf8 ? "░" : ".");
    g_string_append(s, p->colour ? "\033[0m" : "");
}

/* Puts the line in place of the last one, over which it writes blanks: every terminal can do that. `length` in columns.
 */
static void draw(Progress *p, const char *line, int length)
{
    fprintf(stderr, "\r%s%*s", line, MAX(p->length - length, 0), "");
    fflush(stderr);
    p->length = length;
}

/* The label, as much of it as fits. */
static char *fitting(const Progress *p, const char *text, int room)
{
    char *whole = g_strconcat(p->label, text, NULL);
    char *part = g_utf8_substring(whole, 0, MIN(g_utf8_strlen(whole, -1), MAX(room, 0)));
    g_free(whole);
    return part;
}

/* A bar of the part that is done, and facts after it; redrawn at most ten times a second. */
static void draw_bar(Progress *p, double done, const char *facts)
{
    int room = columns() - 1, label = (int)g_utf8_strlen(p->label, -1), bar = MIN(30, room - label - 1 - (int)g_utf8_strlen(facts, -1));
    if (bar < 5) {
        char *line = fitting(p, facts, room);
        draw(p, line, (int)g_utf8_strlen(line, -1));
        g_free(line);
    } else {
        GString *s = g_string_new(p->label);
        g_string_append_c(s, ' ');
        append_bar(s, p, bar, CLAMP(done, 0, 1));
        g_string_append(s, facts);
        draw(p, s->str, label + 1 + bar + (int)g_utf8_strlen(facts, -1));
        g_string_free(s, TRUE);
    }
}

static gboolean is_time(Progress *p)
{
    gint64 time = g_get_monotonic_time();
    if (!p || (p->drawn && time - p->drawn < G_USEC_PER_SEC / 10))
        return FALSE;
    p->drawn = time;
    return TRUE;
}

void progress_update(Progress *p, const VenProgress *now)
{
    if (!is_time(p))
        return;
    int seconds = (int)((p->drawn - p->begun) / G_USEC_PER_SEC);
    char *facts = g_strdup_printf(" %3d%%  step %u  %u node%s  %u source%s  %d:%02d", (int)(CLAMP(now->done, 0, 1) * 100), now->step, now->nodes,
                                  cli_s(now->nodes), now->sources, cli_s(now->sources), seconds / 60, seconds % 60);
    draw_bar(p, now->done, facts);
    g_free(facts);
}

void progress_part(Progress *p, double done, const char *facts)
{
    if (is_time(p))
        draw_bar(p, done, facts);
}

void progress_say(Progress *p, const char *what)
{
    if (!p)
        return;
    char *line = fitting(p, what, columns() - 1);
    draw(p, line, (int)g_utf8_strlen(line, -1));
    g_free(line);
}

void progress_clear(Progress *p)
{
    if (!p || p->length == 0)
        return;
    draw(p, "", 0);
    fputc('\r', stderr);
    fflush(stderr);
}
