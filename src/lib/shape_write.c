/* Writing a shaped leaf: models for other programs and the maps they refer to. */
#include <math.h>
#include <string.h>

#include "export/export.h"
#include "export/model.h"
#include "geom/dtrig.h"
#include "lib/settings.h"
#include "lib/shape.h"
#include "lib/writer.h"

/* The maps a model is dressed in. */
static const MapId dress[] = {MAP_BASE_COLOR, MAP_ABAXIAL_BASE_COLOR, MAP_OPACITY, MAP_NORMAL_GL, MAP_ADAXIAL_NORMAL_GL,
                              MAP_ROUGHNESS, MAP_AO, MAP_TRANSLUCENCY, MAP_HEIGHT};

typedef struct {
    const VenShape *shape;
    Writer writer;
    gboolean wanted[MODEL_COUNT];
    Plane *plane[MAP_COUNT]; /* those of dress */
    char *file[MAP_COUNT];   /* their names; NULL: not written */
    Model model;
    uint8_t *vein_order, *on_margin;
    double *vein_radius;
    uint32_t *vein_id;
    char *record;
} ModelWriter;

/* ---- maps ---- */

static gboolean paint(ModelWriter *m, GError **error)
{
    /* what OBJ and POV-Ray refer to lies beside them; what glTF holds needs no file */
    gboolean files = m->wanted[MODEL_OBJ] || m->wanted[MODEL_POV], ok = TRUE;
    if (!files && !m->wanted[MODEL_GLB])
        return TRUE;
    Painter *painter = writer_painter(&m->writer, &m->shape->frame);
    for (gsize i = 0; ok && i < G_N_ELEMENTS(dress); i++) {
        MapId id = dress[i];
        const char *name = paint_map_info(id)->name;
        m->plane[id] = painter_paint(painter, id);
        if (!files)
            continue;
        m->file[id] = g_strdup_printf("%s_%s.png", m->writer.name, name);
        char *path = g_build_filename(m->writer.dir, m->file[id], NULL);
        ok = image_write_png(m->plane[id], path, id == MAP_HEIGHT ? 16 : m->writer.depth, &m->writer.meta, error);
        g_free(path);
    }
    painter_free(painter);
    return ok;
}

static GBytes *with_alpha(const Plane *colour, const Plane *alpha)
{
    Plane *p = plane_new(colour->width, colour->height, 4, PLANE_COLOUR);
    for (gsize i = 0; i < (gsize)p->width * p->height; i++) {
        memcpy(p->px + 4 * i, colour->px + 3 * i, 3 * sizeof(float));
        p->px[4 * i + 3] = alpha->px[i];
    }
    GBytes *bytes = image_png_bytes(p, 8, NULL);
    plane_free(p);
    return bytes;
}

/* glTF's packing of what has no colour. */
static GBytes *packed_surface(const Plane *ao, const Plane *roughness)
{
    Plane *p = plane_new(ao->width, ao->height, 3, PLANE_DATA);
    p->high = 1.0;
    for (gsize i = 0; i < (gsize)p->width * p->height; i++) {
        p->px[3 * i] = ao->px[i];
        p->px[3 * i + 1] = roughness->px[i];
    }
    GBytes *bytes = image_png_bytes(p, 8, NULL);
    plane_free(p);
    return bytes;
}

static void embed(ModelWriter *m)
{
    Plane **p = m->plane;
    m->model.images = (ModelImages){.base_color = with_alpha(p[MAP_BASE_COLOR], p[MAP_OPACITY]),
                                    .abaxial_base_color = with_alpha(p[MAP_ABAXIAL_BASE_COLOR], p[MAP_OPACITY]),
                                    .normal = image_png_bytes(p[MAP_ADAXIAL_NORMAL_GL], 8, NULL),
                                    .abaxial_normal = image_png_bytes(p[MAP_NORMAL_GL], 8, NULL),
                                    .surface = packed_surface(p[MAP_AO], p[MAP_ROUGHNESS]),
                                    .transmission = with_alpha(p[MAP_BASE_COLOR], p[MAP_TRANSLUCENCY])};
}

/* ---- the model ---- */

static void describe_vertices(ModelWriter *m)
{
    const VenShape *s = m->shape;
    const Skeleton *sk = s->skeleton;
    uint32_t n = s->mesh->n_vertices;
    m->vein_order = g_new0(uint8_t, n);
    m->on_margin = g_new0(uint8_t, n);
    m->vein_radius = g_new0(double, n);
    m->vein_id = g_new0(uint32_t, n);
    for (uint32_t q = sk->n_sequences; q-- > 0;) /* parents last: they own the nodes their children start at */
        for (uint32_t i = 0; i < sk->sequence[q].n; i++) {
            uint32_t node = sk->at[sk->sequence[q].first + i], v = sk->vertex[node];
            if (sk->sequence[q].fictitious)
                continue;
            m->vein_order[v] = sk->sequence[q].order;
            m->vein_radius[v] = sk->radius[node];
            m->vein_id[v] = q + 1;
        }
    for (uint32_t i = 0; i < s->mesh->n_boundary; i++)
        m->on_margin[s->mesh->boundary[i][0]] = 1;
}

static void fill_model(ModelWriter *m)
{
    const VenShape *s = m->shape;
    describe_vertices(m);
    m->record = ven_shape_record(s);
    Model *o = &m->model;
    o->name = m->writer.name;
    o->title = params_text(s->leaf->params, PARAM_LEAF_TITLE);
    o->generator = "Venation " VENATION_VERSION;
    o->extras = m->record;
    o->unit = s->unit;
    o->blade = s->bent.blade;
    o->veins = s->bent.veins;
    o->tubes = s->bent.tubes;
    o->n_tubes = s->bent.n_tubes;
    o->skeleton = s->skeleton;
    o->vein_order = m->vein_order;
    o->vein_radius = m->vein_radius;
    o->vein_id = m->vein_id;
    o->on_margin = m->on_margin;
    o->base_color_file = m->file[MAP_BASE_COLOR];
    o->abaxial_base_color_file = m->file[MAP_ABAXIAL_BASE_COLOR];
    o->opacity_file = m->file[MAP_OPACITY];
    o->holes = s->leaf->net->holes != NULL;
    o->normal_file = m->file[MAP_ADAXIAL_NORMAL_GL];
    o->roughness_file = m->file[MAP_ROUGHNESS];
    o->height_file = m->file[MAP_HEIGHT];
    o->translucency_file = m->file[MAP_TRANSLUCENCY];
}

static gboolean write_formats(const ModelWriter *m, const Model *model, const char *suffix, GError **error)
{
    static const char *const end[MODEL_COUNT] = {".glb", ".obj", ".ply", ".pov"};
    gboolean ok = TRUE;
    for (int f = 0; ok && f < MODEL_COUNT; f++) {
        if (!m->wanted[f])
            continue;
        char *last = g_strconcat(suffix, end[f], NULL), *path = writer_path(&m->writer, last);
        char *include = g_strconcat(suffix, ".inc", NULL), *inc = writer_path(&m->writer, include);
        ok = f == MODEL_GLB   ? export_glb(model, path, error)
             : f == MODEL_OBJ ? export_obj(model, path, error)
             : f == MODEL_PLY ? export_ply(model, path, error)
                              : export_pov(model, inc, path, error);
        g_free(last);
        g_free(path);
        g_free(include);
        g_free(inc);
    }
    return ok;
}

/* ---- coarser levels ---- */

static gboolean write_level(const ModelWriter *m, uint32_t level, GError **error)
{
    const VenShape *s = m->shape;
    Model model = m->model;
    Bent bent = shape_level_bend(s, level, &s->bent);
    model.blade = bent.blade;
    model.veins = bent.veins;
    model.tubes = bent.tubes;
    model.n_tubes = bent.n_tubes;
    model.skeleton = s->level[level - 1].skeleton;
    model.vein_order = model.on_margin = NULL;
    model.vein_radius = NULL;
    model.vein_id = NULL;
    model.morph = NULL;
    model.n_morphs = 0;
    char *suffix = g_strdup_printf("_lod%u", level);
    gboolean ok = write_formats(m, &model, suffix, error);
    g_free(suffix);
    bent_clear(&bent);
    return ok;
}

/* ---- rig ---- */

static gboolean write_rigged(const ModelWriter *m, GError **error)
{
    Model model = m->model;
    model.rig = m->shape->rig;
    model.morph = NULL;
    model.n_morphs = 0;
    char *path = writer_path(&m->writer, "_rigged.glb");
    gboolean ok = export_glb(&model, path, error);
    g_free(path);
    return ok;
}

/* ---- keyframes ---- */

/* Morph targets move vertices along straight lines, so between far poses the blade would shrink: poses are put between, STEP degrees of the
 * largest turn apart, at most MOST_BETWEEN in a row. */
enum { STEP_DEGREES = 15, MOST_BETWEEN = 23 };

typedef struct {
    PoseDef def;
    Pose *pose; /* owned */
    double time;
} Moment;

static void moment_clear(gpointer data) { pose_free(((Moment *)data)->pose); }

static gboolean pose_moment(const VenShape *s, const PoseDef *def, Moment *m, GError **error)
{
    m->def = *def;
    m->pose = pose_new(s->skeleton);
    return pose_apply(m->pose, def, error);
}

/* Poses between the last moment and the next one. */
static gboolean add_between(const VenShape *s, GArray *moments, const Moment *last, const Moment *next, GError **error)
{
    double apart = pose_apart(last->pose, next->pose) / DTRIG_DEGREE;
    uint32_t n = (uint32_t)CLAMP(ceil(apart / STEP_DEGREES - 1e-6) - 1.0, 0.0, MOST_BETWEEN);
    for (uint32_t i = 1; i <= n; i++) {
        double part = (double)i / (n + 1);
        Moment m = {.time = last->time + part * (next->time - last->time)};
        PoseDef def;
        gboolean ok = TRUE;
        if (pose_def_between(&last->def, &next->def, part, &def))
            ok = pose_moment(s, &def, &m, error);
        else
            m.pose = pose_between(last->pose, next->pose, part);
        g_array_append_val(moments, m);
        if (!ok)
            return FALSE;
    }
    return TRUE;
}

/* From the pose that is written, at 0 s, through the keyframes. */
static GArray *make_moments(const VenShape *s, const Keyframe *frame, uint32_t n, GError **error)
{
    GArray *moments = g_array_new(FALSE, TRUE, sizeof(Moment));
    g_array_set_clear_func(moments, moment_clear);
    Moment last = {.def = s->bent_as, .pose = s->bent.pose};
    for (uint32_t i = 0; i < n; i++) {
        Moment next = {.time = frame[i].time};
        PoseDef def = settings_pose(frame[i].params, s->leaf->seed);
        gboolean ok = pose_moment(s, &def, &next, error);
        if (!ok)
            settings_prefix(s->leaf->params, PARAM_POSE_KEYFRAMES, error);
        if (!ok || (next.time > last.time && !add_between(s, moments, &last, &next, error))) {
            pose_free(next.pose);
            g_array_unref(moments);
            return NULL;
        }
        g_array_append_val(moments, next);
        last = next;
    }
    return moments;
}

/* "1.25 s" */
static char *name_of_time(double seconds)
{
    GString *s = g_string_new(NULL);
    export_number(s, floor(seconds * 1e4 + 0.5) / 1e4);
    g_string_append(s, " s");
    return g_string_free(s, FALSE);
}

static gboolean write_moments(const ModelWriter *m, GArray *moments, GError **error)
{
    Bent *bent = g_new0(Bent, moments->len);
    ModelMorph *morph = g_new0(ModelMorph, moments->len);
    char **name = g_new0(char *, (gsize)moments->len + 1);
    for (uint32_t i = 0; i < moments->len; i++) {
        Moment *at = &g_array_index(moments, Moment, i);
        bent[i] = shape_bend(m->shape, at->pose);
        at->pose = NULL; /* taken over */
        name[i] = name_of_time(at->time);
        morph[i] = (ModelMorph){name[i], bent[i].blade->place, bent[i].blade->normal, bent[i].veins ? bent[i].veins->place : NULL,
                                bent[i].veins ? bent[i].veins->normal : NULL, at->time};
    }
    Model model = m->model;
    char *path = writer_path(&m->writer, "_animated.glb");
    model.morph = morph;
    model.n_morphs = moments->len;
    gboolean ok = export_glb(&model, path, error);
    g_free(path);
    for (uint32_t i = 0; i < moments->len; i++)
        bent_clear(&bent[i]);
    g_strfreev(name);
    g_free(bent);
    g_free(morph);
    return ok;
}

static gboolean write_animated(const ModelWriter *m, GError **error)
{
    Keyframe *frame;
    uint32_t n;
    if (!settings_keyframes(m->shape->leaf->params, &frame, &n, error))
        return FALSE;
    GArray *moments = make_moments(m->shape, frame, n, error);
    gboolean ok = moments != NULL && (moments->len == 0 || write_moments(m, moments, error));
    if (moments)
        g_array_unref(moments);
    keyframes_free(frame, n);
    return ok;
}

/* ---- all of it ---- */

static gboolean write_record(const ModelWriter *m, GError **error)
{
    char *path = writer_path(&m->writer, ".json");
    gboolean ok = export_text(m->record, strlen(m->record), path, error);
    g_free(path);
    return ok;
}

static gboolean write_all(ModelWriter *m, GError **error)
{
    const VenShape *s = m->shape;
    if (!writer_make_dir(&m->writer, error) || !paint(m, error))
        return FALSE;
    if (m->wanted[MODEL_GLB])
        embed(m);
    fill_model(m);
    gboolean ok = write_formats(m, &m->model, "", error);
    for (uint32_t i = 1; ok && i <= s->n_levels; i++)
        ok = write_level(m, i, error);
    if (ok && m->wanted[MODEL_GLB])
        ok = write_animated(m, error) && (!s->rig || write_rigged(m, error));
    return ok && write_record(m, error);
}

static void clear(ModelWriter *m)
{
    GBytes *image[] = {m->model.images.base_color,     m->model.images.abaxial_base_color, m->model.images.normal,
                       m->model.images.abaxial_normal, m->model.images.surface,            m->model.images.transmission};
    for (gsize i = 0; i < G_N_ELEMENTS(image); i++)
        if (image[i])
            g_bytes_unref(image[i]);
    for (int i = 0; i < MAP_COUNT; i++) {
        plane_free(m->plane[i]);
        g_free(m->file[i]);
    }
    g_free(m->vein_order);
    g_free(m->on_margin);
    g_free(m->vein_radius);
    g_free(m->vein_id);
    g_free(m->record);
    writer_clear(&m->writer);
}

gboolean ven_shape_write(const VenShape *shape, const char *dir, const char *name, GError **error)
{
    ModelWriter m = {.shape = shape};
    if (!settings_models(shape->leaf->params, m.wanted, error))
        return FALSE;
    writer_init(&m.writer, shape->leaf, dir, name);
    gboolean ok = write_all(&m, error);
    clear(&m);
    return ok;
}
