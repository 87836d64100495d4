/* Shaping a grown leaf, stage by stage: skeleton, mesh and factor once, then a pose over and over, vein solids and normals with it. The second and third size
 * are about 6000 and 20 000 vertices. Processor time.
 * usage: bench_shape PARAMS [--quick]
 *
 * What bounds it: the two triangular solves of the membrane, x, y and z at once, read the factor, a few MB, from memory for each pose, and are as fast as that; they
 * take half of a pose of 20 000 vertices and more of larger ones. Below, it is the angles of bends, an arc tangent and a sine for each node. */
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "lib/leaf.h"
#include "lib/settings.h"
#include "lib/shape.h"
#include "venation.h"

/* Seconds of all threads. */
static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static void one(const VenLeaf *leaf, const VenParams *params, double area)
{
    GError *error = NULL;
    char *setting = g_strdup_printf("mesh.max_area=%g", area);
    if (!params_override(leaf->params, setting, &error))
        g_error("%s", error->message);
    g_free(setting);
    double t0 = now();
    SkeletonDef def = settings_skeleton(leaf->params, leaf->length, 0);
    Skeleton *sk = skeleton_new(leaf->net, &def, &error);
    if (!sk)
        g_error("%s", error->message);
    double t1 = now();
    skeleton_free(sk);
    VenShape *s = ven_shape(leaf, &error);
    if (!s)
        g_error("%s", error->message);
    double t2 = now();
    uint32_t poses = 0;
    while (now() - t2 < 1.0 || poses < 3) {
        if (!ven_shape_pose(s, params, poses++, &error))
            g_error("%s", error->message);
    }
    double t3 = now();
    Vec3 *posed = g_new(Vec3, s->n_fixed), *place = g_new(Vec3, s->mesh->n_vertices);
    Mat3 *turn = g_new(Mat3, s->n_fixed);
    for (uint32_t i = 0; i < s->n_fixed; i++) {
        posed[i] = s->bent.pose->place[s->fixed_node[i]];
        turn[i] = s->bent.pose->turn[s->fixed_node[i]];
    }
    uint32_t solves = 0;
    while (now() - t3 < 1.0 || solves < 3) {
        membrane_interpolate_turned(s->membrane, posed, turn, place);
        solves++;
    }
    double t4 = now();
    printf("%8u %9u %7u %12.1f %23.1f %14.1f %18.1f\n", s->mesh->n_triangles, s->mesh->n_vertices, s->skeleton->n_nodes, (t1 - t0) * 1e3,
           (t2 - t1) * 1e3, poses / (t3 - t2), solves / (t4 - t3));
    g_free(posed);
    g_free(place);
    g_free(turn);
    ven_shape_free(s);
}

int main(int argc, char **argv)
{
    GError *error = NULL;
    gboolean quick = argc > 2 && strcmp(argv[2], "--quick") == 0;
    if (argc < 2) {
        fputs("usage: bench_shape PARAMS [--quick]\n", stderr);
        return 2;
    }
    VenParams *params = ven_params_load(argv[1], &error);
    if (params && quick)
        ven_params_set(params, "growth.final_length", "900", &error);
    VenLeaf *leaf = params ? ven_grow(params, 1, NULL, &error) : NULL;
    if (!leaf)
        g_error("%s", error->message);
    printf("%u vein nodes\ntriangles  vertices   nodes  skeleton, ms  skeleton to first pose  poses a second  membranes a second\n", ven_leaf_nodes(leaf));
    const double area[] = {2.5e-4, 6.4e-5, 1.9e-5, 4e-6, 6e-7};
    for (int i = 0; i < (quick ? 3 : 5); i++)
        one(leaf, params, area[i]);
    ven_leaf_free(leaf);
    ven_params_free(params);
    return 0;
}
