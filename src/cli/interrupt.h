/* Ctrl-C and its kin (SIGINT, SIGTERM, SIGHUP) without signal handlers: a thread waits for them. */
#ifndef CLI_INTERRUPT_H
#define CLI_INTERRUPT_H

#include <glib.h>

typedef struct Interrupt Interrupt;

/* Runs on the waiting thread just before the process ends, when all other threads stand still, wherever they are: it must neither allocate nor
 * take a lock, nor print by stdio. */
typedef void (*InterruptCleanup)(gpointer user);

/* Blocks the signals in this thread and those it starts from now on. Signals that were ignored (nohup) stay ignored.
 * The first one is only noted, for interrupt_signal; a second, or any once interrupt_urgent was called, runs `cleanup`
 * and ends the process. */
Interrupt *interrupt_new(InterruptCleanup cleanup, gpointer user);
void interrupt_free(Interrupt *in);

/* The signal that came, or 0. Any thread. */
int interrupt_signal(Interrupt *in);

/* From now on a signal ends the process at once; so does one that came already. */
void interrupt_urgent(Interrupt *in);

/* From now on a second signal ends the process, as at the start. */
void interrupt_polite(Interrupt *in);

/* Makes all other threads stand still for good, so that none makes anew what is being removed. For the thread that ends the process; one that
 * calls it later stands still too. Neither allocates nor locks. */
void interrupt_freeze(void);

/* From now on signals are only noted. Does not return while the clean-up runs. */
void interrupt_hold(Interrupt *in);

#endif
