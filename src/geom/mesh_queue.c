#include "geom/mesh_gts.h"

/* Buckets are stacks: refining on where it has just been is kind to caches (a quarter of the time) and gives as few triangles as taking
 * turns. A face knows its place there, in GtsObject's spare field, and its bucket, in spare bits of the flags: most faces never want to be
 * refined, and bytes in each would be the larger part of the queue. Places of faces that are gone hold NULL. */
enum { BUCKET_MASK = 255 };

static uint32_t bucket_of(const GtsTriangle *f) { return (f->object.flags >> MESH_BUCKET_SHIFT) & BUCKET_MASK; }

static void put(MeshBucket *b, uint32_t at, GtsTriangle *f)
{
    b->face[at] = f;
    f->object.reserved = GUINT_TO_POINTER(at);
}

/* Makes room at the end, by closing up the gaps if they are half of it. */
static void make_room(MeshBucket *b)
{
    if (b->live >= b->cap / 2) {
        b->cap = b->cap ? 2 * b->cap : 64;
        b->face = g_renew(GtsTriangle *, b->face, b->cap);
        return;
    }
    uint32_t n = 0;
    for (uint32_t i = 0; i < b->end; i++)
        if (b->face[i])
            put(b, n++, b->face[i]);
    b->end = n;
}

void mesh_queue_add(Mesher *m, GtsTriangle *f)
{
    uint32_t urgency = mesh_urgency(m, f);
    if (!urgency)
        return;
    MeshBucket *b = &m->bucket[urgency];
    if (b->end == b->cap)
        make_room(b);
    put(b, b->end++, f);
    b->live++;
    f->object.flags |= urgency << MESH_BUCKET_SHIFT;
    m->top = urgency > m->top ? urgency : m->top;
}

void mesh_queue_remove(Mesher *m, GtsTriangle *f)
{
    uint32_t urgency = bucket_of(f);
    if (!urgency)
        return;
    MeshBucket *b = &m->bucket[urgency];
    b->face[GPOINTER_TO_UINT(f->object.reserved)] = NULL;
    b->live--;
    while (b->end && !b->face[b->end - 1])
        b->end--;
    f->object.reserved = NULL;
    f->object.flags &= ~((guint32)BUCKET_MASK << MESH_BUCKET_SHIFT);
}

GtsTriangle *mesh_queue_take(Mesher *m)
{
    while (m->top && !m->bucket[m->top].live)
        m->top--;
    if (!m->top)
        return NULL;
    const MeshBucket *b = &m->bucket[m->top];
    GtsTriangle *f = b->face[b->end - 1];
    mesh_queue_remove(m, f);
    return f;
}

void mesh_queue_clear(Mesher *m)
{
    for (uint32_t k = 0; k < MESH_BUCKETS; k++)
        g_free(m->bucket[k].face);
}
