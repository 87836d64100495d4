#include "cli/interrupt.h"

#include <dirent.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "cli/cli.h"

typedef enum { POLITE, URGENT, HELD } Mood;

struct Interrupt {
    pthread_t thread;
    pthread_mutex_t lock; /* not GMutex, which the thread sanitizer does not see */
    Mood mood;
    int came;
    gboolean quit;
    sigset_t signals;
    InterruptCleanup cleanup;
    gpointer user;
};

static atomic_uint still; /* threads that stand still */

static void stand_still(int number)
{
    atomic_fetch_add(&still, 1);
    for (;;)
        pause();
}

/* Tells every other thread to stand still; returns how many there are. Those that do already have the signal blocked. */
static unsigned tell_others(int number)
{
    _Alignas(struct dirent64) char entries[2048];
    int folder = open("/proc/self/task", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    unsigned others = 0;
    for (ssize_t n; folder >= 0 && (n = getdents64(folder, entries, sizeof entries)) > 0;)
        for (ssize_t i = 0; i < n;) {
            const struct dirent64 *entry = (const struct dirent64 *)(const void *)(entries + i);
            pid_t thread = (pid_t)strtol(entry->d_name, NULL, 10);
            i += entry->d_reclen;
            if (thread > 0 && thread != gettid() && tgkill(getpid(), thread, number) == 0)
                others++;
        }
    if (folder >= 0)
        close(folder);
    return others;
}

void interrupt_freeze(void)
{
    static atomic_flag frozen = ATOMIC_FLAG_INIT;
    enum { TRIES = 20000 }; /* two seconds, after which a thread hangs in the kernel and makes nothing */
    if (atomic_flag_test_and_set(&frozen))
        for (;;)
            pause();
    struct sigaction action = {.sa_handler = stand_still};
    sigaction(SIGRTMAX, &action, NULL);
    for (int i = 0; i < TRIES && atomic_load(&still) < tell_others(SIGRTMAX); i++)
        nanosleep(&(struct timespec){.tv_nsec = 100000}, NULL);
}

/* Holding the lock, which is never given back: nobody else goes on. */
static G_GNUC_NORETURN void end(Interrupt *in)
{
    interrupt_freeze();
    in->cleanup(in->user);
    _exit(EXIT_SIGNAL + in->came);
}

static void *wait_for_signals(void *user)
{
    Interrupt *in = user;
    for (;;) {
        int signal_number;
        if (sigwait(&in->signals, &signal_number) != 0)
            continue;
        pthread_mutex_lock(&in->lock);
        gboolean quit = in->quit, first = !in->came;
        if (signal_number != SIGURG && first)
            in->came = signal_number;
        if (signal_number != SIGURG && (in->mood == URGENT || (in->mood == POLITE && !first)))
            end(in);
        pthread_mutex_unlock(&in->lock);
        if (quit)
            return NULL;
    }
}

Interrupt *interrupt_new(InterruptCleanup cleanup, gpointer user)
{
    static const int wanted[] = {SIGINT, SIGTERM, SIGHUP};
    Interrupt *in = g_new0(Interrupt, 1);
    pthread_mutex_init(&in->lock, NULL);
    in->cleanup = cleanup;
    in->user = user;
    sigemptyset(&in->signals);
    sigaddset(&in->signals, SIGURG); /* does nothing by default: wakes the thread for interrupt_free */
    for (gsize i = 0; i < G_N_ELEMENTS(wanted); i++) {
        struct sigaction old;
        if (sigaction(wanted[i], NULL, &old) == 0 && old.sa_handler != SIG_IGN)
            sigaddset(&in->signals, wanted[i]);
    }
    pthread_sigmask(SIG_BLOCK, &in->signals, NULL);
    if (pthread_create(&in->thread, NULL, wait_for_signals, in) != 0)
        g_error("can't start a thread"); /* as g_thread_new does */
    return in;
}

void interrupt_free(Interrupt *in)
{
    if (!in)
        return;
    pthread_mutex_lock(&in->lock);
    in->quit = TRUE;
    pthread_mutex_unlock(&in->lock);
    pthread_kill(in->thread, SIGURG);
    pthread_join(in->thread, NULL);
    pthread_sigmask(SIG_UNBLOCK, &in->signals, NULL);
    pthread_mutex_destroy(&in->lock);
    g_free(in);
}

int interrupt_signal(Interrupt *in)
{
    pthread_mutex_lock(&in->lock);
    int came = in->came;
    pthread_mutex_unlock(&in->lock);
    return came;
}

void interrupt_urgent(Interrupt *in)
{
    pthread_mutex_lock(&in->lock);
    in->mood = URGENT;
    if (in->came)
        end(in);
    pthread_mutex_unlock(&in->lock);
}

void interrupt_hold(Interrupt *in)
{
    pthread_mutex_lock(&in->lock);
    in->mood = HELD;
    pthread_mutex_unlock(&in->lock);
}

void interrupt_polite(Interrupt *in)
{
    pthread_mutex_lock(&in->lock);
    in->mood = POLITE;
    pthread_mutex_unlock(&in->lock);
}
