/* The veins that carry the blade. */
#include "lib/shape.h"

/* When no vein is left at all, it is tried again with half the clearance and tolerance, at most so often. */
enum { NARROWER = 6 };

Skeleton *shape_skeleton_by(const VenShape *s, SkeletonDef def, GError **error)
{
    const Network *net = s->carries ? s->carries : s->leaf->net;
    GError *first = NULL;
    Skeleton *sk = skeleton_new(net, &def, &first);
    for (int i = 0; i < NARROWER && !sk && g_error_matches(first, SKELETON_ERROR, SKELETON_ERROR_EMPTY); i++) {
        def.clearance *= 0.5;
        def.tolerance *= 0.5;
        sk = skeleton_new(net, &def, NULL);
    }
    if (sk)
        g_clear_error(&first);
    else
        g_propagate_error(error, first);
    return sk;
}

Skeleton *shape_skeleton(const VenShape *s, GError **error)
{
    const VenLeaf *leaf = s->leaf;
    Vec2 *point = NULL;
    uint32_t *count = NULL, n;
    Skeleton *sk = shape_skeleton_by(s, settings_skeleton(leaf->params, leaf->length, 1.0), error);
    if (sk && !settings_fictitious(leaf->params, leaf->length, &point, &count, &n, error)) {
        skeleton_free(sk);
        sk = NULL;
    }
    if (sk && n) {
        Skeleton *with = skeleton_add_fictitious(sk, point, count, n, leaf->length, error);
        if (!with)
            settings_prefix(leaf->params, PARAM_MESH_FICTITIOUS, error);
        skeleton_free(sk);
        sk = with;
    }
    g_free(point);
    g_free(count);
    return sk;
}
