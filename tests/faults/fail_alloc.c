/* A shim under which the n-th allocation fails (fault.h). For glibc, whose own allocator it hands on to. */
#include "fault.h"

extern void *__libc_malloc(size_t size), *__libc_calloc(size_t n, size_t size), *__libc_realloc(void *block, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);

void *malloc(size_t size)
{
    if (!fault_here())
        return __libc_malloc(size);
    errno = ENOMEM;
    return NULL;
}

void *calloc(size_t n, size_t size)
{
    if (!fault_here())
        return __libc_calloc(n, size);
    errno = ENOMEM;
    return NULL;
}

void *realloc(void *block, size_t size)
{
    if (!fault_here())
        return __libc_realloc(block, size);
    errno = ENOMEM;
    return NULL;
}

void *memalign(size_t alignment, size_t size);

void *memalign(size_t alignment, size_t size)
{
    if (!fault_here())
        return __libc_memalign(alignment, size);
    errno = ENOMEM;
    return NULL;
}

void *aligned_alloc(size_t alignment, size_t size) { return memalign(alignment, size); }

/* Tells by its result, not by errno. */
int posix_memalign(void **block, size_t alignment, size_t size)
{
    void *got = fault_here() ? NULL : __libc_memalign(alignment, size);
    if (!got)
        return ENOMEM;
    *block = got;
    return 0;
}
