/* A shim under which the n-th call that writes fails (fault.h): opening for writing, making folders, writing, renaming, closing what was written.
 * Besides
 *
 *     FAULT_KIND   calls counted: letters out of o (open, mkdir), w (write), r (rename), c (close, flush); default: all
 *     FAULT_ERRNO  how they fail, a number; default ENOSPC. 0: writing is short, half of what was asked for, and nothing else fails
 *
 * Standard error is left alone. */
#undef _FILE_OFFSET_BITS /* calls have two names, of which it would make one */

#include <stdarg.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/uio.h>

#include "fault.h"

/* The function that a call would reach without the shim. */
#define REAL(name)                                    \
    static __typeof__(&name) real;                    \
    if (!real) {                                      \
        void *found = dlsym(RTLD_NEXT, #name);        \
        memcpy(&real, &found, sizeof real);           \
    }

static int code(void)
{
    const char *text = getenv("FAULT_ERRNO");
    return text ? atoi(text) : ENOSPC;
}

static bool fails(char kind)
{
    const char *kinds = getenv("FAULT_KIND");
    if (kinds && !strchr(kinds, kind))
        return false;
    if (!fault_here() || (kind != 'w' && code() == 0))
        return false;
    errno = code();
    return true;
}

static bool writes(int flags) { return (flags & O_ACCMODE) != O_RDONLY; }

/* ---- open, mkdir ---- */

#define OPEN(name)                                                  \
    int name(const char *path, int flags, ...)                      \
    {                                                               \
        REAL(name)                                                  \
        va_list args;                                               \
        va_start(args, flags);                                      \
        mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(args, mode_t) : 0; \
        va_end(args);                                               \
        return writes(flags) && fails('o') ? -1 : real(path, flags, mode); \
    }
OPEN(open)
OPEN(open64)

#define FOPEN(name)                                                 \
    FILE *name(const char *path, const char *mode)                  \
    {                                                               \
        REAL(name)                                                  \
        return *mode != 'r' && fails('o') ? NULL : real(path, mode); \
    }
FOPEN(fopen)
FOPEN(fopen64)

FILE *fdopen(int fd, const char *mode)
{
    REAL(fdopen)
    return *mode != 'r' && fails('o') ? NULL : real(fd, mode);
}

int mkdir(const char *path, mode_t mode)
{
    REAL(mkdir)
    return fails('o') ? -1 : real(path, mode);
}

/* ---- write ---- */

/* What is really written when a call fails: nothing, or half. */
static size_t part(size_t n) { return code() == 0 ? (n + 1) / 2 : 0; }

ssize_t write(int fd, const void *data, size_t n)
{
    REAL(write)
    if (fd == STDERR_FILENO || !fails('w'))
        return real(fd, data, n);
    return part(n) ? real(fd, data, part(n)) : -1;
}

#define PWRITE(name, Offset)                                              \
    ssize_t name(int fd, const void *data, size_t n, Offset at)           \
    {                                                                     \
        REAL(name)                                                        \
        if (!fails('w'))                                                  \
            return real(fd, data, n, at);                                 \
        return part(n) ? real(fd, data, part(n), at) : -1;                \
    }
PWRITE(pwrite, off_t)
PWRITE(pwrite64, off64_t)

ssize_t writev(int fd, const struct iovec *part_of, int n)
{
    REAL(writev)
    if (fd == STDERR_FILENO || !fails('w'))
        return real(fd, part_of, n);
    return part(2) ? real(fd, part_of, 1) : -1;
}

/* The standard library's own writing can't be reached from here: its entries fail instead. A short write is no failure to it, for it goes on. */
size_t fwrite(const void *data, size_t size, size_t n, FILE *file)
{
    REAL(fwrite)
    return file == stderr || code() == 0 || !fails('w') ? real(data, size, n, file) : 0;
}

int fputs(const char *text, FILE *file)
{
    REAL(fputs)
    return file == stderr || code() == 0 || !fails('w') ? real(text, file) : EOF;
}

/* ---- flush, close, rename ---- */

int fflush(FILE *file)
{
    REAL(fflush)
    return file == stderr || !file || !fails('c') ? real(file) : EOF;
}

int fclose(FILE *file)
{
    REAL(fclose)
    bool counts = (fcntl(fileno(file), F_GETFL) & O_ACCMODE) != O_RDONLY && fails('c');
    int reason = errno, result = real(file);
    if (!counts)
        return result;
    errno = reason;
    return EOF;
}

int close(int fd)
{
    REAL(close)
    int flags = fcntl(fd, F_GETFL);
    bool counts = flags >= 0 && (flags & O_ACCMODE) != O_RDONLY && fails('c');
    int reason = errno, result = real(fd);
    if (!counts)
        return result;
    errno = reason;
    return -1;
}

int fsync(int fd)
{
    REAL(fsync)
    return fails('c') ? -1 : real(fd);
}

int rename(const char *from, const char *to)
{
    REAL(rename)
    return fails('r') ? -1 : real(from, to);
}
