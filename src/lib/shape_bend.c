/* A pose of the whole leaf: blade and vein solids. */
#include "lib/shape.h"

#include "lib/settings.h"
#include "shape/solid_cut.h"

Vec2 shape_uv(const VenShape *s, Vec2 rest)
{
    const Frame *f = &s->frame;
    return vec2((rest.x - f->corner.x) * f->scale / f->width, 1.0 - (f->corner.y - rest.y) * f->scale / f->height);
}

Surface *shape_flat_blade(const VenShape *s, const Mesh *mesh)
{
    Surface *blade = surface_new(mesh->n_vertices, mesh->n_triangles);
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        blade->uv[i] = shape_uv(s, mesh->vertex[i]);
    for (uint32_t t = 0; t < mesh->n_triangles; t++)
        for (int k = 0; k < 3; k++)
            blade->triangle[t][k] = mesh->triangle[t][k];
    return blade;
}

void shape_dress_veins(const VenShape *s, Bent *b, const SolidDef *def)
{
    if (b->n_tubes == 0)
        return;
    b->veins = solid_surface(b->tubes, b->n_tubes, def);
    for (uint32_t i = 0; i < b->veins->n_vertices; i++)
        b->veins->uv[i] = shape_uv(s, b->veins->uv[i]);
}

static void add_veins(const VenShape *s, Bent *b)
{
    Vec3 *normal = g_new(Vec3, s->skeleton->n_nodes);
    for (uint32_t i = 0; i < s->skeleton->n_nodes; i++)
        normal[i] = b->pose->turn[i].z; /* the vein's own, which no crumpled triangle at the margin can flip */
    b->tubes = solid_tubes(b->pose, normal, &s->solid, &b->n_tubes);
    b->tubes = solid_cut(b->tubes, &b->n_tubes, normal, s->leaf->net->holes);
    shape_dress_veins(s, b, &s->solid);
    g_free(normal);
}

Bent shape_bend(const VenShape *s, Pose *pose)
{
    Bent b = {.pose = pose, .blade = shape_flat_blade(s, s->mesh)};
    Vec3 *posed = g_new(Vec3, s->n_fixed);
    Mat3 *turn = g_new(Mat3, s->n_fixed);
    for (uint32_t i = 0; i < s->n_fixed; i++) {
        posed[i] = pose->place[s->fixed_node[i]];
        turn[i] = pose->turn[s->fixed_node[i]];
    }
    if (params_choice(s->leaf->params, PARAM_MESH_MEMBRANE) == MEMBRANE_CHOICE_NATURAL)
        membrane_interpolate(s->membrane, posed, b.blade->place);
    else
        membrane_interpolate_turned(s->membrane, posed, turn, b.blade->place);
    g_free(posed);
    g_free(turn);
    surface_normals(b.blade);
    if (params_switch(s->leaf->params, PARAM_MESH_VEINS))
        add_veins(s, &b);
    return b;
}

void bent_clear(Bent *b)
{
    pose_free(b->pose);
    surface_free(b->blade);
    surface_free(b->veins);
    solid_tubes_free(b->tubes, b->n_tubes);
    *b = (Bent){0};
}

/* The stub of one that was cut off tells neither length nor width: it gets enough length to look like a stalk, and the width that the veins ask for. */
bool shape_real_petiole(const VenLeaf *leaf, double *length, double *width)
{
    const double least = 6.0; /* widths */
    const Profile *f = leaf->ground ? leaf->ground->profile : NULL;
    if (!f || !f->has_stalk || params_is_given(leaf->params, PARAM_MESH_PETIOLE_LENGTH))
        return false;
    double pixel = 1.0 / vec_dist(leaf->ground->base, leaf->ground->tip); /* leaf lengths */
    bool stub = f->stalk_length < least * f->stalk_width;
    *length = MAX(f->stalk_length, least * f->stalk_width) * pixel;
    *width = stub ? 0.0 : f->stalk_width * pixel;
    return true;
}

SolidDef shape_solids(const VenLeaf *leaf, double coarser)
{
    SolidDef def = settings_solids(leaf->params, leaf->length, coarser);
    double length, width;
    if (shape_real_petiole(leaf, &length, &width)) {
        def.petiole_length = length * leaf->length;
        if (!params_is_given(leaf->params, PARAM_MESH_PETIOLE_WIDTH))
            def.petiole_radius = 0.5 * width * leaf->length;
    }
    return def;
}
