#include "sim/state.h"

void veins_init(Veins *v, Box2 field)
{
    *v = (Veins){0};
    quadtree_init(&v->tree, field);
}

void veins_clear(Veins *v)
{
    g_free(v->pos);
    g_free(v->material);
    g_free(v->parent);
    g_free(v->birth);
    g_free(v->pull);
    g_free(v->join_tail);
    g_free(v->join_head);
    g_free(v->join_birth);
    if (v->joined)
        g_hash_table_destroy(v->joined);
    quadtree_clear(&v->tree);
}

uint32_t veins_add(Veins *v, Vec2 pos, uint32_t parent, uint32_t step)
{
    if (v->n == v->cap) {
        v->cap = MAX(v->cap + v->cap / 2, 1024);
        v->pos = g_renew(Vec2, v->pos, v->cap);
        v->parent = g_renew(uint32_t, v->parent, v->cap);
        v->birth = g_renew(uint32_t, v->birth, v->cap);
        v->pull = g_renew(uint32_t, v->pull, v->cap);
        if (v->material)
            v->material = g_renew(Vec2, v->material, v->cap);
    }
    uint32_t i = v->n++;
    v->pos[i] = pos;
    v->parent[i] = parent;
    v->birth[i] = step;
    v->pull[i] = NO_POINT;
    quadtree_add(&v->tree, v->pos[i], i);
    return i;
}

bool veins_join(Veins *v, uint32_t a, uint32_t b, uint32_t step)
{
    gint64 pair = (gint64)((uint64_t)MIN(a, b) << 32 | MAX(a, b));
    if (!v->joined)
        v->joined = g_hash_table_new_full(g_int64_hash, g_int64_equal, g_free, NULL);
    if (!g_hash_table_add(v->joined, g_memdup2(&pair, sizeof pair)))
        return false;
    if (v->n_joins == v->cap_joins) {
        v->cap_joins = MAX(v->cap_joins * 2, 256);
        v->join_tail = g_renew(uint32_t, v->join_tail, v->cap_joins);
        v->join_head = g_renew(uint32_t, v->join_head, v->cap_joins);
        v->join_birth = g_renew(uint32_t, v->join_birth, v->cap_joins);
    }
    v->join_tail[v->n_joins] = MIN(a, b);
    v->join_head[v->n_joins] = MAX(a, b);
    v->join_birth[v->n_joins++] = step;
    return true;
}
