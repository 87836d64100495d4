#include "batch/dataset.h"

#include <gio/gio.h>
#include <glib/gstdio.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "batch/labels.h"
#include "batch/private.h"
#include "export/export.h"
#include "export/sink.h"
#include "geom/random.h"

enum { SPLIT_STREAM = RANDOM_SWEEP + 2, SPLITS = 2 };
#define CARD_BEGINS "Leaves grown by Venation "
static const char *const split_name[SPLITS] = {"train", "val"};

/* Folders of the data set, and the files of a leaf that go there. */
static const struct {
    const char *folder, *suffix;
} part[] = {{"images", "specimen"}, {"lamina", "opacity"}, {"vein", "vein_mask"}, {"order", "vein_order"}, {"areole", "areole"}};

typedef struct {
    const BatchDef *def;
    double validation;
    bool by_seed;
    char *root;            /* the new data set while it is made */
    uint64_t n[SPLITS];
    uint64_t annotations;  /* numbers given so far */
    int rounds;            /* over all leaves, so far */
} Dataset;

gboolean dataset_params(Params *p, const char *origin, GError **error)
{
    static const struct {
        ParamId id;
        const char *value;
    } set[] = {{PARAM_TEXTURE_MAPS, "opacity vein_mask vein_order areole"}, {PARAM_TEXTURE_EXR, "none"}, {PARAM_TEXTURE_DEPTH, "8"},
               {PARAM_EXPORT_SPECIMEN, "yes"}, {PARAM_EXPORT_VEINS_IMAGE, "no"}, {PARAM_EXPORT_SVG, "no"}, {PARAM_EXPORT_NETWORK, "no"}};
    for (gsize i = 0; i < G_N_ELEMENTS(set); i++)
        if (!params_set(p, set[i].id, set[i].value, origin, error))
            return FALSE;
    return TRUE;
}

gboolean dataset_check_place(const char *out, GError **error)
{
    char *folder = g_build_filename(out, "dataset", NULL), *card = g_build_filename(folder, "README.txt", NULL), *text = NULL;
    gboolean ours = !g_file_test(folder, G_FILE_TEST_EXISTS) || (g_file_get_contents(card, &text, NULL, NULL) && g_str_has_prefix(text, CARD_BEGINS));
    if (!ours)
        g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_EXIST, "%s: is there and no data set of a sweep; it would be replaced: move it away, or choose another --output", folder);
    g_free(text);
    g_free(card);
    g_free(folder);
    return ours;
}

static int split_of(const Dataset *d, const SweepVariant *v)
{
    double u[2];
    random_pair(d->by_seed ? v->seed : v->index, SPLIT_STREAM, 0, 0, u);
    return u[0] < d->validation;
}

/* ---- files ---- */

static gboolean copy(const char *from, const char *to, GError **error)
{
    GFile *source = g_file_new_for_path(from), *target = g_file_new_for_path(to);
    gboolean ok = g_file_copy(source, target, G_FILE_COPY_OVERWRITE, NULL, NULL, NULL, error);
    g_object_unref(source);
    g_object_unref(target);
    return ok;
}

static gboolean lay_files(const Dataset *d, const Row *row, GError **error)
{
    gboolean ok = TRUE;
    for (gsize i = 0; i < G_N_ELEMENTS(part) && ok; i++) {
        char *from = g_strdup_printf("%s/%s/%s_%s.png", d->def->out, row->folder, row->variant.name, part[i].suffix);
        char *to = g_strdup_printf("%s/%s/%s/%s.png", d->root, part[i].folder, split_name[split_of(d, &row->variant)], row->variant.name);
        ok = link(from, to) == 0 || copy(from, to, error);
        g_free(from);
        g_free(to);
    }
    return ok;
}

static gboolean make_folders(const Dataset *d, GError **error)
{
    gboolean ok = TRUE;
    for (gsize i = 0; i < G_N_ELEMENTS(part) * SPLITS && ok; i++) {
        char *path = g_strdup_printf("%s/%s/%s", d->root, part[i / SPLITS].folder, split_name[i % SPLITS]);
        ok = batch_make_folder(path, error);
        g_free(path);
    }
    char *path = g_build_filename(d->root, "annotations", NULL);
    ok = ok && batch_make_folder(path, error);
    g_free(path);
    return ok;
}

/* ---- leaves ---- */

/* Calls `each` for every leaf that is there, in order. */
static gboolean each_leaf(Dataset *d, int split, gboolean (*each)(Dataset *d, const Row *row, gpointer user, GError **error), gpointer user, GError **error)
{
    enum { ROUNDS = 1 + 2 * SPLITS };
    uint64_t count = sweep_count(d->def->sweep);
    gboolean ok = TRUE;
    for (uint64_t i = 0; i < count && ok; i++) {
        Row row;
        row_read(d->def->sweep, d->def->out, i, &row);
        if (row.outcome == ROW_GROWN && (split < 0 || split_of(d, &row.variant) == split))
            ok = each(d, &row, user, error);
        row_clear(&row);
        ok = ok && watch_tick(&d->def->watch, (d->rounds + (double)(i + 1) / (double)count) / ROUNDS, error);
    }
    d->rounds++;
    return ok;
}

static gboolean place(Dataset *d, const Row *row, gpointer user, GError **error)
{
    d->n[split_of(d, &row->variant)]++;
    return lay_files(d, row, error);
}

/* ---- COCO ---- */

typedef struct {
    Sink *out;
    uint64_t n;
} Listing;

/* Width and height of a PNG, from its header. */
static gboolean image_size(const char *path, uint32_t size[2], GError **error)
{
    uint8_t head[24] = {0};
    FILE *file = fopen(path, "rb");
    gboolean ok = file && fread(head, 1, sizeof head, file) == sizeof head;
    if (file)
        fclose(file);
    if (!ok)
        g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_FAILED, "%s: can't be read", path);
    for (int i = 0; i < 2; i++)
        size[i] = (uint32_t)head[16 + 4 * i] << 24 | (uint32_t)head[17 + 4 * i] << 16 | (uint32_t)head[18 + 4 * i] << 8 | head[19 + 4 * i];
    return ok;
}

static gboolean list_image(Dataset *d, const Row *row, gpointer user, GError **error)
{
    Listing *l = user;
    char *path = g_strdup_printf("%s/%s/%s_specimen.png", d->def->out, row->folder, row->variant.name);
    uint32_t size[2];
    gboolean ok = image_size(path, size, error);
    g_string_append_printf(l->out->text, "%s\n{\"id\": %" G_GUINT64_FORMAT ", \"file_name\": \"%s.png\", \"width\": %u, \"height\": %u}", l->n++ ? "," : "",
                           row->index + 1, row->variant.name, size[0], size[1]);
    sink_drain(l->out);
    g_free(path);
    return ok;
}

static gboolean list_annotations(Dataset *d, const Row *row, gpointer user, GError **error)
{
    Listing *l = user;
    char *path = g_strdup_printf("%s/%s/%s_labels.jsonl", d->def->out, row->folder, row->variant.name), *text;
    gboolean ok = g_file_get_contents(path, &text, NULL, error);
    char **line = ok ? g_strsplit(text, "\n", -1) : NULL;
    for (char **at = line; ok && *at; at++) {
        if (**at != '{')
            continue;
        g_string_append_printf(l->out->text, "%s\n{\"id\": %" G_GUINT64_FORMAT ", \"image_id\": %" G_GUINT64_FORMAT ", %s", l->n++ ? "," : "", ++d->annotations,
                               row->index + 1, *at + 1);
        sink_drain(l->out);
    }
    g_strfreev(line);
    if (ok)
        g_free(text);
    g_free(path);
    return ok;
}

static void list_categories(GString *s)
{
    g_string_append(s, "{\"info\": {\"description\": \"Leaves grown by Venation ");
    g_string_append_printf(s, "%s\", \"version\": \"1.0\"},\n\"licenses\": [],\n\"categories\": [", ven_version());
    for (int id = 1; id <= LABEL_LAST; id++)
        g_string_append_printf(s, "%s\n{\"id\": %d, \"name\": \"%s\", \"supercategory\": \"leaf\"}", id > 1 ? "," : "", id, label_category(id));
    g_string_append(s, "\n],\n\"images\": [");
}

static gboolean write_annotations(Dataset *d, int split, GError **error)
{
    char *path = g_strdup_printf("%s/annotations/%s.json", d->root, split_name[split]);
    Listing l = {.out = sink_open(path, error)};
    g_free(path);
    if (!l.out)
        return FALSE;
    list_categories(l.out->text);
    gboolean ok = each_leaf(d, split, list_image, &l, error);
    g_string_append(l.out->text, "\n],\n\"annotations\": [");
    l.n = 0;
    ok = ok && each_leaf(d, split, list_annotations, &l, error);
    g_string_append(l.out->text, "\n]}\n");
    return sink_close(l.out, ok ? error : NULL) && ok;
}

static gboolean write_card(const Dataset *d, GError **error)
{
    char *path = g_build_filename(d->root, "README.txt", NULL), *name = g_path_get_basename(sweep_path(d->def->sweep));
    char *text = g_strdup_printf(
        CARD_BEGINS "%s from %s: %" G_GUINT64_FORMAT " to train with, %" G_GUINT64_FORMAT " to validate (val); parted by %s.\n\n"
        "images        the leaf as a scanner sees it\n"
        "lamina        part of the pixel that the blade covers, 0 to 255\n"
        "vein          part of the pixel that veins cover, 0 to 255\n"
        "order         order of the vein at the pixel, 1 primary; 0 none. A pixel is a vein's where its centre lies in the vein drawn at least a pixel\n"
        "              wide, so that thin veins are unbroken lines, and the blade covers half of it or more; of several veins the lowest order's\n"
        "areole        number of the areole around the pixel's centre, 16 bits; 0 none, where veins cover half of the pixel or more, and where the\n"
        "              blade covers less than half. Thin veins that cover less are drawn in order alone: such pixels have an order and an areole\n"
        "annotations   COCO, for the files in images, iscrowd 0:\n"
        "              lamina  a polygon, the outer margin within a quarter of a pixel; of a blade with holes run-length encoded: the pixels that are\n"
        "                      128 or more in lamina\n"
        "              areole  run-length encoded: the pixels that hold its number in areole, which \"label\" repeats; area and box are theirs. Areoles\n"
        "                      of fewer than %d pixels are left out here, not there\n"
        "              vein    run-length encoded, all veins of a leaf as one: the pixels whose order is not 0\n"
        "              Where there is no pixel there is no annotation. Some loaders take run lengths only if told to (detectron2: mask_format bitmask)\n\n"
        "Leaves are upright and centred: turning, scaling and shifting are left to the loader. Leaves of open venation (veins.pattern), and of closed\n"
        "venation with a large veins.kill_distance, have few areoles or none.\n\n"
        "What each leaf was grown from is in ../manifest.csv, by the name of its files.\n",
        ven_version(), name, d->n[0], d->n[1], d->by_seed ? "seed" : "variant", LABEL_LEAST_AREOLE);
    gboolean ok = export_text(text, strlen(text), path, error);
    g_free(text);
    g_free(name);
    g_free(path);
    return ok;
}

/* ---- all of it ---- */

static gboolean put_in_place(const Dataset *d, GError **error)
{
    char *target = g_build_filename(d->def->out, "dataset", NULL);
    gboolean ok = batch_move_folder(d->root, target, error);
    g_free(target);
    return ok;
}

gboolean dataset_write(const BatchDef *def, double validation, GError **error)
{
    Dataset d = {.def = def, .validation = validation, .root = g_build_filename(def->staging, "dataset", NULL)};
    for (uint32_t k = 0; k < sweep_keys(def->sweep); k++)
        d.by_seed |= sweep_key(def->sweep, k).id < 0 && sweep_key(def->sweep, k).varies;
    gboolean ok = make_folders(&d, error) && each_leaf(&d, -1, place, NULL, error);
    for (int split = 0; split < SPLITS && ok; split++)
        ok = write_annotations(&d, split, error);
    ok = ok && write_card(&d, error) && put_in_place(&d, error);
    g_free(d.root);
    return ok;
}
