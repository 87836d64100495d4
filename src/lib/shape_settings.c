/* From [mesh], [pose] and [export] to the definitions that src/shape works from. */
#include <math.h>
#include <string.h>

#include "lib/settings.h"
#include "lib/shape.h"
#include "param/suggest.h"

gboolean settings_prefix(const Params *p, ParamId id, GError **error)
{
    char *place = params_place(p, id);
    g_prefix_error(error, "%s: ", place);
    g_free(place);
    return FALSE;
}

/* Sets an error that begins with the place where a parameter was given; always FALSE. */
static G_GNUC_PRINTF(4, 5) gboolean conflict(const Params *p, ParamId id, GError **error, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *what = g_strdup_vprintf(format, args);
    va_end(args);
    g_set_error_literal(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT, what);
    g_free(what);
    return settings_prefix(p, id, error);
}

/* What a coarse leaf must not lose: its outline by and large, and room for veins. */
static const double most_tolerance = 0.03, most_clearance = 0.05;

SkeletonDef settings_skeleton(const Params *p, double length, double coarser)
{
    double tolerance = params_number(p, PARAM_MESH_TOLERANCE), clearance = params_number(p, PARAM_MESH_CLEARANCE);
    SkeletonDef d = skeleton_def_default(length);
    d.max_order = (uint32_t)params_integer(p, PARAM_MESH_MAX_ORDER);
    d.tolerance = MAX(tolerance, MIN(tolerance * coarser, most_tolerance)) * length;
    d.spacing = coarser > 1.0 ? 0.0 : params_number(p, PARAM_MESH_SPACING) * length;
    d.clearance = MAX(clearance, MIN(clearance * coarser, most_clearance)) * length;
    d.min_length = params_number(p, PARAM_MESH_MIN_LENGTH) * length * coarser;
    return d;
}

MeshDef settings_mesh(const Params *p, double length, double coarser)
{
    double area = params_number(p, PARAM_MESH_MAX_AREA) * length * length * coarser * coarser;
    return (MeshDef){.min_angle = params_number(p, PARAM_MESH_MIN_ANGLE), .max_area = area, .max_triangles = 20000000};
}

PoseDef settings_pose(const Params *p, uint64_t seed)
{
    PoseDef d = pose_def_default();
    int64_t own = params_integer(p, PARAM_POSE_SEED);
    d.kind = (PoseKind)params_choice(p, PARAM_POSE_PRESET);
    d.strength = params_number(p, PARAM_POSE_STRENGTH);
    d.age = params_number(p, PARAM_POSE_AGE);
    d.variation = params_number(p, PARAM_POSE_VARIATION);
    d.seed = own ? (uint64_t)own : seed;
    d.blend = params_number(p, PARAM_POSE_BLEND);
    d.rules = params_text(p, PARAM_POSE_RULES);
    return d;
}

SolidDef settings_solids(const Params *p, double length, double coarser)
{
    SolidDef d = solid_def_default(length);
    d.scale = params_number(p, PARAM_MESH_VEIN_SCALE);
    d.offset = params_number(p, PARAM_MESH_VEIN_OFFSET);
    d.petiole_length = params_number(p, PARAM_MESH_PETIOLE_LENGTH) * length;
    d.petiole_radius = 0.5 * params_number(p, PARAM_MESH_PETIOLE_WIDTH) * length;
    d.petiole_bend = params_number(p, PARAM_MESH_PETIOLE_BEND);
    d.sides = MAX(3, (uint32_t)((double)params_integer(p, PARAM_MESH_VEIN_SIDES) / sqrt(coarser)));
    d.spacing = 1.2 * params_number(p, PARAM_MESH_SPACING) * length * coarser; /* nodes a little nearer than a full edge may go */
    return d;
}

gboolean settings_models(const Params *p, gboolean wanted[MODEL_COUNT], GError **error)
{
    static const char *const name[] = {"glb", "obj", "ply", "pov", "all", "none"};
    char **word = g_strsplit_set(params_text(p, PARAM_EXPORT_MODELS), " ,;\t", -1);
    gboolean ok = TRUE;
    memset(wanted, 0, sizeof *wanted * MODEL_COUNT);
    for (char **w = word; ok && *w; w++) {
        gsize i = 0;
        while (i < G_N_ELEMENTS(name) && !g_str_equal(*w, name[i]))
            i++;
        for (gsize k = 0; k < MODEL_COUNT; k++)
            wanted[k] |= i == k || i == MODEL_COUNT;
        ok = !**w || i < G_N_ELEMENTS(name);
        if (!ok) {
            const char *near = suggest_nearest(*w, name, G_N_ELEMENTS(name));
            conflict(p, PARAM_EXPORT_MODELS, error, "no format is called '%s'%s%s%s; there are all, none, glb, obj, ply, pov", *w,
                     near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
        }
    }
    g_strfreev(word);
    return ok;
}

/* ---- lists in words ---- */

static gboolean number(const char *text, double *v)
{
    char *end;
    *v = g_ascii_strtod(text, &end);
    return end != text && !*end && *v == *v && *v - *v == 0.0;
}

static gboolean one_keyframe(const Params *p, char *text, GArray *frames, GError **error)
{
    char **word = g_strsplit_set(g_strstrip(text), " \t", -1);
    Keyframe k = {.params = params_copy(p)};
    double last = frames->len ? g_array_index(frames, Keyframe, frames->len - 1).time : -1.0;
    gboolean ok = number(word[0] ? word[0] : "", &k.time) && k.time > last;
    if (!ok)
        conflict(p, PARAM_POSE_KEYFRAMES, error, "'%s' must begin with seconds, 0 or more, later than the keyframe before it", text);
    for (char **w = word[0] ? word + 1 : word; ok && *w; w++) {
        if (!**w)
            continue;
        char *setting = g_strdup_printf("pose.%s", *w);
        ok = strchr(*w, '=') != NULL && !g_str_has_prefix(*w, "keyframes");
        if (!ok)
            conflict(p, PARAM_POSE_KEYFRAMES, error, "'%s' must be key=value, with a key of [pose]", *w);
        else
            ok = params_override(k.params, setting, error);
        g_free(setting);
    }
    g_strfreev(word);
    g_array_append_val(frames, k);
    return ok;
}

gboolean settings_keyframes(const Params *p, Keyframe **frame, uint32_t *n, GError **error)
{
    char **part = g_strsplit(params_text(p, PARAM_POSE_KEYFRAMES), ";", -1);
    GArray *frames = g_array_new(FALSE, FALSE, sizeof(Keyframe));
    gboolean ok = TRUE;
    for (char **s = part; ok && *s; s++)
        if (*g_strchug(*s))
            ok = one_keyframe(frames->len ? g_array_index(frames, Keyframe, frames->len - 1).params : p, *s, frames, error);
    g_strfreev(part);
    *n = frames->len;
    *frame = (Keyframe *)(void *)g_array_free(frames, FALSE);
    if (ok)
        return TRUE;
    keyframes_free(*frame, *n);
    *frame = NULL;
    *n = 0;
    return FALSE;
}

void keyframes_free(Keyframe *frame, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        params_free(frame[i].params);
    g_free(frame);
}

static gboolean point(const char *text, Vec2 *at)
{
    char **xy = g_strsplit(text, ",", -1);
    gboolean ok = g_strv_length(xy) == 2 && number(xy[0], &at->x) && number(xy[1], &at->y);
    g_strfreev(xy);
    return ok;
}

gboolean settings_fictitious(const Params *p, double length, Vec2 **points, uint32_t **count, uint32_t *n, GError **error)
{
    char **line = g_strsplit(params_text(p, PARAM_MESH_FICTITIOUS), ";", -1);
    GArray *at = g_array_new(FALSE, FALSE, sizeof(Vec2)), *counts = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    gboolean ok = TRUE;
    for (char **l = line; ok && *l; l++) {
        char **word = g_strsplit_set(*l, " \t", -1);
        uint32_t found = 0;
        for (char **w = word; ok && *w; w++) {
            Vec2 q;
            if (!**w)
                continue;
            ok = point(*w, &q);
            if (!ok)
                conflict(p, PARAM_MESH_FICTITIOUS, error, "'%s' must be x,y in leaf lengths", *w);
            q = vec_scale(q, length);
            g_array_append_val(at, q);
            found++;
        }
        if (ok && found == 1) {
            ok = conflict(p, PARAM_MESH_FICTITIOUS, error, "'%s' needs two points at least", *l);
        }
        if (found)
            g_array_append_val(counts, found);
        g_strfreev(word);
    }
    g_strfreev(line);
    *n = counts->len;
    *points = (Vec2 *)(void *)g_array_free(at, FALSE);
    *count = (uint32_t *)(void *)g_array_free(counts, FALSE);
    return ok;
}
