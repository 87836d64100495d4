#include "geom/mesh.h"

#include "geom/dtrig.h"
#include "geom/mesh_gts.h"

/* Points and segments nearer to each other than this part of the largest coordinate are refused: seven digits are left for what lies
 * between. */
static const double least_part = 1e-9;
/* Pieces shorter than this part are not split, for want of digits. */
static const double tiny_part = 1e-12;
static const double greatest_min_angle = 33.0; /* degrees; refinement does not end for some inputs from 34 on */
static const uint32_t most_triangles = 1u << 30; /* what counters and sorts can take */

static GtsObjectClass *derive(gpointer parent, const char *name, gsize object_size)
{
    const GtsObjectClass *p = parent;
    GtsObjectClassInfo info = {.object_size = (guint)object_size, .class_size = p->info.class_size};
    g_strlcpy(info.name, name, sizeof info.name);
    return gts_object_class_new(parent, &info);
}

typedef struct {
    GtsObjectClass *vertex, *piece;
} Classes;

static gpointer make_classes(gpointer unused)
{
    const GtsObjectClass *constraint = (gpointer)gts_constraint_class();
    g_assert(constraint->info.object_size <= offsetof(MeshPiece, input));
    gts_triangle_class();
    Classes *c = g_new(Classes, 1);
    c->vertex = derive(gts_vertex_class(), "VenationVertex", sizeof(MeshVertex));
    c->piece = derive(gts_constraint_class(), "VenationPiece", sizeof(MeshPiece));
    return c;
}

/* GTS keeps classes for good, by name, so they are made once in a process, with GTS's own that we use. */
static const Classes *get_classes(void)
{
    static GOnce once = G_ONCE_INIT;
    return g_once(&once, make_classes, NULL);
}

static double largest_coordinate(const Pslg *g)
{
    double largest = 0.0;
    for (uint32_t i = 0; i < g->n_points; i++)
        largest = fmax(largest, fmax(fabs(g->point[i].x), fabs(g->point[i].y)));
    return largest;
}

static gboolean is_allowed(const char *what, double value, double most, const char *allowed, GError **error)
{
    if (value >= 0.0 && value <= most)
        return TRUE;
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    g_set_error(error, MESH_ERROR, MESH_ERROR_INPUT, "%s is %s; it must be %s", what,
                g_ascii_formatd(text, sizeof text, "%.6g", value), allowed);
    return FALSE;
}

static gboolean check_def(const MeshDef *def, GError **error)
{
    return is_allowed("the least angle of triangles", def->min_angle, greatest_min_angle, "0 … 33 degrees", error) &&
           is_allowed("the greatest area of triangles", def->max_area, HUGE_VAL, "0 (no limit) or more", error) &&
           is_allowed("the floor of edge lengths", def->floor, HUGE_VAL, "0 (none) or more", error);
}

static uint32_t limit_of(const MeshDef *def) { return def->max_triangles ? def->max_triangles : most_triangles; }

/* Before any work: the area alone can tell. */
static gboolean check_area(const Pslg *g, const MeshDef *def, GError **error)
{
    Polygon *outline = polygon_new(g->point, g->n_outline);
    double needed = def->max_area > 0.0 ? outline->area / def->max_area : 0.0;
    polygon_free(outline);
    if (needed <= limit_of(def))
        return TRUE;
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    g_set_error(error, MESH_ERROR, MESH_ERROR_SIZE, "triangles of the greatest area allowed would be more than %s; %u are allowed",
                g_ascii_formatd(text, sizeof text, "%.3g", needed), limit_of(def));
    return FALSE;
}

static void mesher_init(Mesher *m, const Pslg *g, const MeshDef *def)
{
    *m = (Mesher){.graph = g, .def = def, .limit = limit_of(def), .n_pieces = g->n_outline + g->n_segments};
    m->vertex_class = get_classes()->vertex;
    m->piece_class = get_classes()->piece;
    m->vertex = g_ptr_array_new();
    m->encroached = g_ptr_array_new();
    m->cavity = g_ptr_array_new();
    m->dead = g_ptr_array_new();
    m->touched = g_ptr_array_new();
    m->piece = g_new(MeshPiece *, m->n_pieces);
    double sine = dtrig_sin(def->min_angle * DTRIG_DEGREE);
    double tiny = tiny_part * largest_coordinate(g);
    m->sine2 = sine * sine;
    m->side = def->max_area > 0.0 ? sqrt(def->max_area) : HUGE_VAL;
    m->tiny2 = tiny * tiny;
}

static void mesher_clear(Mesher *m)
{
    mesh_free_gts(m);
    mesh_queue_clear(m);
    g_ptr_array_free(m->vertex, TRUE);
    g_ptr_array_free(m->encroached, TRUE);
    g_ptr_array_free(m->cavity, TRUE);
    g_ptr_array_free(m->dead, TRUE);
    g_ptr_array_free(m->touched, TRUE);
    g_free(m->piece);
    g_free(m->acute);
}

static Mesh *make(Mesher *m, GArray *pieces, GError **error)
{
    if (!mesh_triangulate(m)) {
        g_set_error(error, MESH_ERROR, MESH_ERROR_INPUT,
                    "the segments of outline and veins are too near to each other to be triangulated");
        return NULL;
    }
    if (!mesh_conform(m) || !mesh_refine(m)) {
        g_set_error(error, MESH_ERROR, MESH_ERROR_SIZE,
                    "the mesh needs more than %u triangles; allow more or larger ones, or clear narrow places between veins and margin",
                    m->limit);
        return NULL;
    }
    return mesh_copy(m, pieces);
}

Mesh *mesh_new(const Pslg *g, const MeshDef *def, GError **error)
{
    if (!check_def(def, error) || !pslg_check(g, least_part * largest_coordinate(g), error) || !check_area(g, def, error))
        return NULL;
    static GMutex lock; /* GTS's predicates keep the arithmetic's control word in a global while they work */
    GArray *pieces = g_array_new(FALSE, FALSE, sizeof(MeshPart));
    Mesher m;
    g_mutex_lock(&lock);
    mesher_init(&m, g, def);
    Mesh *mesh = make(&m, pieces, error);
    mesher_clear(&m);
    g_mutex_unlock(&lock);
    if (mesh)
        mesh_arrange(mesh, g, pieces);
    g_array_free(pieces, TRUE);
    return mesh;
}

void mesh_free(Mesh *m)
{
    if (!m)
        return;
    g_free(m->vertex);
    g_free(m->triangle);
    g_free(m->boundary);
    g_free(m->boundary_input);
    g_free(m->vein);
    g_free(m->vein_input);
    g_free(m);
}
