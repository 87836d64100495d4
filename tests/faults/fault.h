/* When a call fails: what the two shims share. They are loaded into a program with LD_PRELOAD and steered by the environment:
 *
 *     FAULT_AT      the call that fails, counted from 1 once main has begun; 0: none
 *     FAULT_MODE    "once", or "on": all from that call on fail
 *     FAULT_COUNT   a file of eight bytes, into which the number of calls goes as they are made (the program may end without a chance to tell)
 */
#ifndef FAULT_H
#define FAULT_H

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static struct {
    _Atomic(uint64_t) own, *count;
    uint64_t at;
    bool on, begun;
} fault = {.count = &fault.own};

/* TRUE when this call is to fail. */
static inline bool fault_here(void)
{
    if (!fault.begun)
        return false;
    uint64_t n = atomic_fetch_add(fault.count, 1) + 1;
    return fault.at && (fault.on ? n >= fault.at : n == fault.at);
}

static void fault_begin(void)
{
    const char *at = getenv("FAULT_AT"), *mode = getenv("FAULT_MODE"), *file = getenv("FAULT_COUNT");
    fault.at = at ? strtoull(at, NULL, 10) : 0;
    fault.on = mode && strcmp(mode, "on") == 0;
    int fd = file ? open(file, O_RDWR) : -1;
    void *map = fd < 0 ? MAP_FAILED : mmap(NULL, sizeof *fault.count, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (map != MAP_FAILED)
        fault.count = map;
    if (fd >= 0)
        close(fd);
    fault.begun = true;
}

/* ---- from main on: what goes before is the loader's and the libraries' own beginning, about which a program can do nothing ---- */

typedef int (*Main)(int argc, char **argv, char **env);
typedef int (*Start)(Main main, int argc, char **argv, void (*init)(void), void (*fini)(void), void (*rtld_fini)(void), void *stack);

static Main real_main;

static int fault_main(int argc, char **argv, char **env)
{
    fault_begin();
    return real_main(argc, argv, env);
}

int __libc_start_main(Main main, int argc, char **argv, void (*init)(void), void (*fini)(void), void (*rtld_fini)(void), void *stack);

int __libc_start_main(Main main, int argc, char **argv, void (*init)(void), void (*fini)(void), void (*rtld_fini)(void), void *stack)
{
    void *found = dlsym(RTLD_NEXT, "__libc_start_main");
    Start start;
    memcpy(&start, &found, sizeof start);
    real_main = main;
    return start(fault_main, argc, argv, init, fini, rtld_fini, stack);
}

#endif
