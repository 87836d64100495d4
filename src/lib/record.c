/* The run record: all that a run depends on and what came of it, and no time or place, so that equal runs give equal bytes. */
#include "export/export.h"
#include "geom/ring.h"
#include "lib/leaf.h"
#include "lib/shape.h"

static uint64_t fnv(uint64_t h, const void *data, gsize n)
{
    const uint8_t *b = data;
    for (gsize i = 0; i < n; i++)
        h = (h ^ b[i]) * 0x100000001B3u;
    return h;
}

uint64_t leaf_hash(const Network *net)
{
    uint64_t h = 0xCBF29CE484222325u;
    h = fnv(h, &net->n_nodes, sizeof net->n_nodes);
    h = fnv(h, &net->n_edges, sizeof net->n_edges);
    h = fnv(h, net->node, sizeof *net->node * net->n_nodes);
    h = fnv(h, net->node_birth, sizeof *net->node_birth * net->n_nodes);
    h = fnv(h, net->tail, sizeof *net->tail * net->n_edges);
    h = fnv(h, net->head, sizeof *net->head * net->n_edges);
    h = fnv(h, net->birth, sizeof *net->birth * net->n_edges);
    h = fnv(h, net->kind, sizeof *net->kind * net->n_edges);
    h = fnv(h, net->width, sizeof *net->width * net->n_edges);
    h = fnv(h, net->order, sizeof *net->order * net->n_edges);
    h = fnv(h, net->rank, sizeof *net->rank * net->n_edges);
    h = fnv(h, net->vein, sizeof *net->vein * net->n_edges);
    if (net->holes) {
        h = fnv(h, net->holes->start, sizeof *net->holes->start * ((gsize)net->holes->n + 1));
        h = fnv(h, net->holes->p, sizeof *net->holes->p * net->holes->start[net->holes->n]);
    }
    return fnv(h, net->margin->v, sizeof *net->margin->v * net->margin->n);
}

static void key(GString *s, const char *indent, const char *name)
{
    g_string_append(s, indent);
    export_json_string(s, name);
    g_string_append(s, ": ");
}

static void number(GString *s, const char *name, double v, const char *end)
{
    key(s, "    ", name);
    export_number(s, v);
    g_string_append(s, end);
}

static void list(GString *s, const double *v, uint32_t n, gboolean points)
{
    g_string_append_c(s, '[');
    for (uint32_t i = 0; i < n; i++) {
        g_string_append(s, i ? ", " : "");
        if (points)
            g_string_append_c(s, '[');
        export_number(s, v[points ? 2 * i : i]);
        if (points) {
            g_string_append(s, ", ");
            export_number(s, v[2 * i + 1]);
            g_string_append_c(s, ']');
        }
    }
    g_string_append_c(s, ']');
}

static void value(GString *s, const Params *p, ParamId id)
{
    uint32_t n;
    const double *v;
    char *text;
    switch (param_info(id)->type) {
    case TYPE_NUMBER:
        export_number(s, params_number(p, id));
        break;
    case TYPE_INTEGER:
        g_string_append_printf(s, "%" G_GINT64_FORMAT, (gint64)params_integer(p, id));
        break;
    case TYPE_SWITCH:
        g_string_append(s, params_switch(p, id) ? "true" : "false");
        break;
    case TYPE_NUMBERS:
    case TYPE_POINTS:
        v = params_list(p, id, &n);
        list(s, v, n, param_info(id)->type == TYPE_POINTS);
        break;
    default:
        text = params_format(p, id);
        export_json_string(s, text);
        g_free(text);
    }
}

static void parameters(GString *s, const Params *p)
{
    const char *section = NULL;
    g_string_append(s, "  \"parameters\": {");
    for (int i = 0; i < PARAM_COUNT; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        gboolean first = !section || !g_str_equal(section, info->section);
        if (first) {
            g_string_append(s, section ? "\n    },\n" : "\n");
            key(s, "    ", info->section);
            g_string_append_c(s, '{');
            section = info->section;
        }
        g_string_append(s, first ? "\n" : ",\n");
        key(s, "      ", info->key);
        value(s, p, (ParamId)i);
    }
    g_string_append(s, "\n    }\n  },\n");
}

/* The blade in pixels and, where the scan says their size, in millimetres. Its outline is what was traced, before it was simplified, if that is known. */
static void scan_sizes(GString *s, const Ground *g)
{
    double length = vec_dist(affine_apply(&g->to_scan, vec2(0.0, 0.0)), affine_apply(&g->to_scan, vec2(0.0, 1.0))), mm = g->scan->mm_per_pixel;
    double around = g->profile ? g->profile->perimeter : length * ring_length(g->outline), width = length * (g->outline->box.x1 - g->outline->box.x0);
    double area = g->profile ? g->profile->area : g->fang ? g->fang->contour->area : length * length * g->outline->area;
    double holes = g->holes ? length * length * g->holes->area : 0.0;
    number(s, "length", length, ",\n");
    number(s, "width_across", width, ",\n");
    number(s, "perimeter", around, ",\n");
    number(s, "area", area, ",\n");
    g_string_append_printf(s, "    \"holes\": %u,\n", g->holes ? g->holes->n : 0);
    number(s, "holes_area", holes, ",\n");
    if (!(mm > 0.0))
        return;
    number(s, "length_mm", mm * length, ",\n");
    number(s, "width_mm", mm * width, ",\n");
    number(s, "perimeter_mm", mm * around, ",\n");
    number(s, "area_mm2", mm * mm * (area - holes), ",\n");
}

static void text(GString *s, const char *name, const char *v)
{
    key(s, "    ", name);
    export_json_string(s, v);
    g_string_append(s, ",\n");
}

/* Where outline and veins come from, and by what a drawing of them came to lie on the scan. */
static void scan_origins(GString *s, const Ground *g)
{
    text(s, "outline_from", g->profile ? "threshold" : g->fang ? "edges" : g->outline_lies ? "drawing" : "path");
    if (g->outline_lies)
        text(s, "outline_laid_by", g->outline_lies);
    text(s, "veins_from", !g->drawing ? "none" : g->found ? "scan" : "drawing");
    if (g->drawing_lies)
        text(s, "veins_laid_by", g->drawing_lies);
}

/* What a scan gave, in pixels of it. */
static void scan_facts(GString *s, const Ground *g)
{
    static const char *const base[] = {"given", "petiole", "symmetry"};
    Vec2 from = affine_apply(&g->to_scan, vec2(0.0, 0.0)), to = affine_apply(&g->to_scan, vec2(0.0, 1.0));
    g_string_append_printf(s, "  \"scan\": {\n    \"width\": %u,\n    \"height\": %u,\n", g->scan->width, g->scan->height);
    number(s, "mm_per_pixel", g->scan->mm_per_pixel, ",\n");
    if (g->scan->aspect > 0.0)
        number(s, "pixel_aspect", g->scan->aspect, ",\n");
    number(s, "cut_off", g->cut_off, ",\n");
    if (g->back)
        number(s, "back_off", g->back_off, ",\n");
    if (g->has_threshold) { /* as scan.channel, scan.threshold and scan.side take it */
        key(s, "    ", "channel");
        export_json_string(s, channel_name(g->threshold.channel));
        g_string_append(s, ",\n");
        number(s, "threshold", g->scan->depth == 8 ? g->threshold.level : g->threshold.level / 257.0, ",\n");
        key(s, "    ", "side");
        g_string_append(s, g->threshold.dark ? "\"dark\",\n" : "\"light\",\n");
        number(s, "separability", g->threshold.separability, ",\n");
    }
    scan_sizes(s, g);
    if (g->profile) {
        number(s, "beyond_threshold", g->profile->beyond, ",\n");
        number(s, "symmetry", g->profile->symmetry, ",\n");
        g_string_append_printf(s, "    \"nodes_traced\": %u,\n    \"base_from\": \"%s\",\n", g->profile->nodes, base[g->profile->base_from]);
    }
    if (g->fang) {
        g_string_append_printf(s, "    \"characteristic_points\": %u,\n    \"curves\": %u,\n    \"nodes_traced\": %u,\n",
                               g->fang->corners->len, g->fang->fit->n, g->fang->contour->n);
        number(s, "area_off_level", g->fang->region.area / g->fang->region.rough - 1.0, ",\n");
        number(s, "edge_continuity", g->fang->region.continuity, ",\n");
        number(s, "edge_gap", g->fang->region.gap, ",\n");
        number(s, "edge_sigma", g->fang->used.sigma, ",\n");
        number(s, "edge_high", g->fang->used.high, ",\n");
        number(s, "edge_low", g->fang->used.low, ",\n");
        number(s, "deviation_largest", g->fang->fit->largest, ",\n");
        number(s, "deviation_mean", g->fang->fit->mean, ",\n");
    }
    g_string_append_printf(s, "    \"nodes\": %u,\n    \"veins\": %u,\n", g->outline->n, g->drawing ? g->drawing->n : 0);
    scan_origins(s, g);
    key(s, "    ", "base");
    list(s, &from.x, 2, FALSE);
    g_string_append(s, ",\n");
    key(s, "    ", "tip");
    list(s, &to.x, 2, FALSE);
    g_string_append(s, "\n  },\n");
}

/* The record without its last brace. */
static GString *begin_record(const VenLeaf *leaf)
{
    const SimulationCounts *c = &leaf->counts;
    const Network *net = leaf->net;
    GString *s = g_string_new("{\n  \"format\": \"venation-record-1\",\n  \"version\": \"" VENATION_VERSION "\",\n");
    key(s, "  ", "title");
    export_json_string(s, params_text(leaf->params, PARAM_LEAF_TITLE));
    g_string_append_printf(s, ",\n  \"seed\": %" G_GUINT64_FORMAT ",\n", (guint64)leaf->seed);
    parameters(s, leaf->params);
    if (leaf->ground && leaf->ground->scan)
        scan_facts(s, leaf->ground);
    if (leaf->ground && leaf->ground->lsystem) /* what lsystem.preset auto came to */
        g_string_append_printf(s, "  \"lsystem\": {\n    \"preset\": \"%s\"\n  },\n", leaf->ground->lsystem);
    g_string_append(s, "  \"leaf\": {\n");
    number(s, "length", leaf->length, ",\n");
    number(s, "width", net->margin->box.x1 - net->margin->box.x0, ",\n");
    if (net->holes)
        number(s, "holes_area", net->holes->area, ",\n");
    number(s, "area", net->margin->area, "\n  },\n");
    g_string_append_printf(s, "  \"network\": {\n    \"nodes\": %u,\n    \"edges\": %u,\n    \"veins\": %u,\n    \"anastomoses\": %u,\n",
                           net->n_nodes, net->n_edges, net->n_veins, c->joins);
    g_string_append_printf(s, "    \"hash\": \"%016" G_GINT64_MODIFIER "x\"\n  },\n", (guint64)leaf_hash(net));
    g_string_append_printf(s,
                           "  \"sources\": {\n    \"darts\": %" G_GUINT64_FORMAT ",\n    \"placed\": %" G_GUINT64_FORMAT
                           ",\n    \"reached\": %" G_GUINT64_FORMAT ",\n    \"given_up\": %" G_GUINT64_FORMAT
                           ",\n    \"left\": %u,\n    \"most_at_once\": %u\n  },\n",
                           (guint64)c->darts, (guint64)c->placed, (guint64)c->reached, (guint64)c->given_up, c->sources, c->most_sources);
    g_string_append_printf(s, "  \"run\": {\n    \"steps\": %u,\n    \"growth_steps\": %u,\n    \"source_updates\": %" G_GUINT64_FORMAT ",\n",
                           c->step, leaf->growth_steps, (guint64)c->updates);
    key(s, "    ", "end");
    export_json_string(s, end_reason_text(c->end));
    g_string_append(s, "\n  }");
    return s;
}

char *ven_leaf_record(const VenLeaf *leaf)
{
    GString *s = begin_record(leaf);
    g_string_append(s, "\n}\n");
    return g_string_free(s, FALSE);
}

/* The veins that carry the blade, by the names that rules of a pose call them; where each begins and how long it is in leaf lengths. */
static void skeleton_veins(GString *s, const Skeleton *sk, double length)
{
    g_string_append(s, "    \"skeleton\": [");
    for (uint32_t q = 0; q < sk->n_sequences; q++) {
        const Sequence *v = &sk->sequence[q];
        Vec2 at = sk->rest[sk->at[v->first]];
        const double start[2] = {at.x / length + 0.0, at.y / length + 0.0};
        g_string_append(s, q ? ",\n      {\"name\": " : "\n      {\"name\": ");
        export_json_string(s, v->name);
        g_string_append_printf(s, ", \"order\": %u, \"parent\": ", v->order);
        if (v->parent == NO_PARENT)
            g_string_append(s, "null");
        else
            export_json_string(s, sk->sequence[v->parent].name);
        g_string_append(s, ", \"length\": ");
        export_number(s, v->length / length);
        g_string_append(s, ", \"start\": ");
        list(s, start, 2, FALSE);
        g_string_append(s, v->fictitious ? ", \"fictitious\": true}" : "}");
    }
    g_string_append(s, "\n    ],\n");
}

/* Part of the blade's weights that did not fit into the joints a vertex may have. */
static void rig_facts(GString *s, const VenShape *shape)
{
    double worst, mean;
    uint32_t joints;
    if (!ven_shape_rig(shape, &joints, &worst, &mean))
        return;
    g_string_append_printf(s, "    \"rig\": {\n      \"joints\": %u,\n      \"worst_loss\": ", joints);
    export_number(s, worst);
    g_string_append(s, ",\n      \"mean_loss\": ");
    export_number(s, mean);
    g_string_append(s, "\n    },\n");
}

char *ven_shape_record(const VenShape *shape)
{
    const Surface *blade = shape->bent.blade, *veins = shape->bent.veins;
    GString *s = begin_record(shape->leaf);
    g_string_append_printf(s, ",\n  \"shape\": {\n    \"veins\": %u,\n    \"vein_nodes\": %u,\n    \"vertices\": %u,\n    \"triangles\": %u,\n",
                           shape->skeleton->n_sequences, shape->skeleton->n_nodes, blade->n_vertices, blade->n_triangles);
    g_string_append_printf(s, "    \"vein_triangles\": %u,\n", veins ? veins->n_triangles : 0);
    number(s, "unit", shape->unit, ",\n    \"levels\": [");
    for (uint32_t i = 0; i < shape->n_levels; i++)
        g_string_append_printf(s, "%s%u", i ? ", " : "", shape->level[i].mesh->n_triangles);
    g_string_append(s, "],\n");
    rig_facts(s, shape);
    skeleton_veins(s, shape->skeleton, shape->leaf->length);
    g_string_append_printf(s, "    \"hash\": \"%016" G_GINT64_MODIFIER "x\"\n  }\n}\n",
                           (guint64)fnv(0xCBF29CE484222325u, blade->place, sizeof *blade->place * blade->n_vertices));
    return g_string_free(s, FALSE);
}
