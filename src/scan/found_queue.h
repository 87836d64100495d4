/* A radix heap (Ahuja et al. 1990): numbers taken out never go down, those put in are never below the last taken out. Of equal ones the order is fixed
 * by the order of calls. */
#ifndef SCAN_FOUND_QUEUE_H
#define SCAN_FOUND_QUEUE_H

#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint32_t key, value;
} FoundEntry;

typedef struct {
    struct {
        FoundEntry *e;
        gsize n, room;
    } bucket[33]; /* bucket b: keys whose highest bit that differs from `last` is bit b - 1 */
    uint32_t last;
    gsize n;
} FoundQueue;

void found_queue_init(FoundQueue *q);
void found_queue_clear(FoundQueue *q);
void found_queue_restart(FoundQueue *q); /* emptied: any key may be put in again */
void found_queue_put(FoundQueue *q, uint32_t key, uint32_t value);
bool found_queue_take(FoundQueue *q, FoundEntry *out);

#endif
