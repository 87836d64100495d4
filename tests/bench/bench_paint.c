/* Painting and writing the maps of a leaf: what maps share, each map apart, beside the plain floor, which is no more than zlib's compression of what the
 * files hold, as the library has it; whole sets on one thread and two; leaves a minute. Times are processor time unless they are called wall time.
 * usage: bench_paint PARAMS [--quick | --large] [--compression]
 *
 * What bounds it: compression takes most of the writing, and of a leaf of few veins most of all: 4.8 of 7.9 s of processor time of a set at 4096
 * (kill-distance.ini), painting 1.9. Of a leaf of many veins (poplar.ini, 10^6 edges) painting takes more than half at 4096, 6.3 s. A quarter of that is the exact
 * union of strokes in each pixel, 1.5 s: 2.5 million pixels, of which three quarters
 * show one vein. There neighbours are cut where they meet, so that areas add up: 0.1 µs where there is one stroke, 0.5 µs where there are more. The others, where
 * veins meet, take 1.4 µs each, 0.9 s together: seven strokes in eight end within another one there and need no round end, and of two that overlap what they share is
 * taken away. Entering strokes into tiles takes 0.25 s. The rest: areoles 0.6 s, the nearest vein and bulges 0.9 each, strokes 0.7, which is waiting for the network's
 * arrays, colours 0.6, which pixel is whose 0.4; all other maps are 0.5 together. Areoles are made by one thread while another one makes strokes and noise: 2.0 s
 * beside 1.8 of a life-size leaf, of 19 s of painting at 8192, where coverage takes 4.7.
 *
 * Compression (kill-distance.ini, 2048 pixels, 17 maps, zlib 1.2.13, s of processor time and MB; --compression prints it map by map). PNG, the rows behind one
 * filter for all: with runs `distance` alone grows, by an eighth, and vein_id by a tenth.
 *     level 1, runs, Paeth 0.56   20.3        level 1, strings, Up   0.70   22.5
 *     level 1, runs, Up    0.57   21.3        level 1, strings, Paeth, labels plain  0.72   22.8
 *     level 1, runs, plain 0.64   36.7        level 4, the same      1.19   20.9
 * EXR, the chunks alone, and OpenEXR 3.1 writing the same pixels its own way, with all that goes with it:
 *     level 1, runs        0.91   44.7        level 1, runs, but strings for areole and vein_id   0.88   40.9
 *     level 1, strings     1.12   43.3        level 4, strings       1.76   40.1
 *     OpenEXR ZIP          2.32   40.1        OpenEXR PIZ            1.66   42.8
 *     OpenEXR ZIPS         2.86   45.3        OpenEXR RLE            0.80   64.7
 *     OpenEXR PXR24        4.12   40.5 */
#include <glib/gstdio.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "compressors.h"
#include "image/file.h"
#include "image/paint.h"
#include "image/painter.h"
#include "lib/leaf.h"
#include "lib/settings.h"
#include "venation.h"

static double wall(void) { return (double)g_get_monotonic_time() * 1e-6; }

/* Of all threads. */
static double processor(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/* Most memory at a time since the last call, MiB; Linux. */
static double peak(void)
{
    char *status = NULL;
    double kib = 0.0;
    if (g_file_get_contents("/proc/self/status", &status, NULL, NULL)) {
        const char *at = strstr(status, "VmHWM:");
        kib = at ? g_ascii_strtod(at + 6, NULL) : 0.0;
    }
    g_free(status);
    FILE *f = fopen("/proc/self/clear_refs", "w");
    if (f) {
        fputs("5", f);
        fclose(f);
    }
    return kib / 1024.0;
}

static void set(VenLeaf *leaf, const char *setting)
{
    GError *error = NULL;
    if (!params_override(leaf->params, setting, &error))
        g_error("%s", error->message);
}

static void set_size(VenLeaf *leaf, uint32_t size)
{
    char *setting = g_strdup_printf("texture.size=%u", size);
    set(leaf, setting);
    g_free(setting);
}

static void empty_dir(const char *dir)
{
    GDir *d = g_dir_open(dir, 0, NULL);
    for (const char *name; d && (name = g_dir_read_name(d));) {
        char *path = g_build_filename(dir, name, NULL);
        g_unlink(path);
        g_free(path);
    }
    if (d)
        g_dir_close(d);
}

/* ---- maps apart ---- */

typedef struct {
    double paint, png, exr, plain_png, plain_exr; /* seconds */
    gsize png_bytes, exr_bytes;
} Cost;

static const char *map_name(int id) { return id < MAP_COUNT ? paint_map_info((MapId)id)->name : "veins"; }

static gboolean has_16_bits(int id)
{
    return id == MAP_HEIGHT || id == MAP_THICKNESS || id == MAP_VEIN_WIDTH || id == MAP_DISTANCE || id == MAP_AGE;
}

/* Files of one map, and the compressors of the plain floor. */
typedef struct {
    ImageFile *file[2];
    Plain *plain[2];
    char *path[2];
} Page;

static void open_page(Page *g, int id, const Plane *like, const Frame *frame, const char *dir)
{
    GError *error = NULL;
    for (int exr = 0; exr < (id < MAP_COUNT ? 2 : 1); exr++) {
        char *name = g_strdup_printf("apart_%s.%s", map_name(id), exr ? "exr" : "png");
        g->path[exr] = g_build_filename(dir, name, NULL);
        g->file[exr] = exr ? image_exr_begin(g->path[exr], like, frame->height, TRUE, NULL, NULL, &error)
                           : image_png_begin(g->path[exr], like, frame->height, has_16_bits(id) ? 16 : 8, NULL, &error);
        if (!g->file[exr])
            g_error("%s", error->message);
        g->plain[exr] = plain_new(exr ? PLAIN_EXR : PLAIN_PNG, like, has_16_bits(id) ? 16 : 8);
        g_free(name);
    }
}

static void write_page(Page *g, const Plane *plane, Cost *c)
{
    GError *error = NULL;
    for (int exr = 0; exr < 2 && g->file[exr]; exr++) {
        double t = processor();
        if (!image_file_rows(g->file[exr], plane, &error))
            g_error("%s", error->message);
        *(exr ? &c->exr : &c->png) += processor() - t;
        plain_fill(g->plain[exr], plane);
        t = processor();
        plain_compress(g->plain[exr]);
        *(exr ? &c->plain_exr : &c->plain_png) += processor() - t;
    }
}

static void close_page(Page *g, Cost *c)
{
    GError *error = NULL;
    for (int exr = 0; exr < 2 && g->file[exr]; exr++) {
        double t = processor();
        if (!image_file_end(g->file[exr], &error))
            g_error("%s", error->message);
        *(exr ? &c->exr : &c->png) += processor() - t;
        GStatBuf st;
        if (g_stat(g->path[exr], &st) == 0)
            *(exr ? &c->exr_bytes : &c->png_bytes) = (gsize)st.st_size;
        plain_free(g->plain[exr]);
        g_free(g->path[exr]);
    }
}

/* What maps share: first what is made once, then what is painted of each band. */
static const char *const shared_name[] = {"(areoles)", "(strokes)", "(noise)", "(blade)", "(coverage)", "(nearest vein)", "(owner)", "(margin)", "(bulges)", "(arch)"};
enum { N_SHARED = G_N_ELEMENTS(shared_name), N_ONCE = 3 };

static void paint_shared(Painter *p, int i)
{
    switch (i) {
    case 0: areole_map_ready(p); break;
    case 1: painter_strokes_ready(p, TRUE); break;
    case 2: painter_noise_ready(p); break;
    case 3: painter_blade(p); break;
    case 4: painter_cover(p); break;
    case 5: painter_away(p); break;
    case 6: painter_owner(p); break;
    case 7: painter_inset(p); break;
    case 8: painter_relief(p); break;
    default: painter_arch(p); break;
    }
}

static void print_cost(const char *name, const Cost *c)
{
    printf("%-20s %7.0f %7.0f %7.0f %7.0f %7.0f %8.2f %8.2f\n", name, c->paint * 1e3, c->png * 1e3, c->plain_png * 1e3, c->exr * 1e3,
           c->plain_exr * 1e3, (double)c->png_bytes * 1e-6, (double)c->exr_bytes * 1e-6);
}

static void time_shared(Painter *p, int first, int last, Cost *cost)
{
    for (int i = first; i < last; i++) {
        double t = processor();
        paint_shared(p, i);
        cost[i].paint += processor() - t;
    }
}

/* One thread, band by band as the library does it. Returns the floor, seconds. */
static double apart(VenLeaf *leaf, uint32_t size, const char *dir)
{
    set_size(leaf, size);
    Frame frame = leaf_frame(leaf, leaf->net->margin->box);
    PaintStyle style = settings_style(leaf->params, leaf->seed, 1);
    Painter *painter = painter_new(leaf->net, &frame, &style);
    Cost cost[MAP_COUNT + 1] = {{0}}, shared[N_SHARED] = {{0}}, sum = {0};
    Page *page = g_new0(Page, MAP_COUNT + 1);
    gboolean all[MAP_COUNT];
    for (int id = 0; id < MAP_COUNT; id++)
        all[id] = TRUE;
    painter_expect(painter, all);
    time_shared(painter, 0, N_ONCE, shared);
    uint32_t rows = MAX((1u << 19) / frame.width / 32 * 32, 32u);
    for (uint32_t y = 0; y < frame.height; y += rows) {
        painter_band(painter, y, MIN(y + rows, frame.height));
        time_shared(painter, N_ONCE, N_SHARED, shared);
        for (int id = 0; id <= MAP_COUNT; id++) {
            double t = processor();
            Plane *plane = id < MAP_COUNT ? painter_paint(painter, (MapId)id) : painter_veins(painter);
            cost[id].paint += processor() - t;
            if (y == 0)
                open_page(&page[id], id, plane, &frame, dir);
            write_page(&page[id], plane, &cost[id]);
            painter_give_back(painter, plane);
        }
    }
    painter_free(painter);
    printf("\n%u pixels, one thread, ms of processor time        MB\nmap                    paint     png   floor     exr   floor      png      exr\n", size);
    for (int i = 0; i < N_SHARED; i++) {
        printf("%-20s %7.0f\n", shared_name[i], shared[i].paint * 1e3);
        sum.paint += shared[i].paint;
    }
    for (int id = 0; id <= MAP_COUNT; id++) {
        const Cost *c = &cost[id];
        close_page(&page[id], &cost[id]);
        print_cost(map_name(id), c);
        sum = (Cost){sum.paint + c->paint, sum.png + c->png, sum.exr + c->exr, sum.plain_png + c->plain_png, sum.plain_exr + c->plain_exr,
                     sum.png_bytes + c->png_bytes, sum.exr_bytes + c->exr_bytes};
    }
    print_cost("together", &sum);
    g_free(page);
    empty_dir(dir);
    return sum.plain_png + sum.plain_exr;
}

/* ---- whole sets ---- */

typedef struct {
    double wall, processor;
} Seconds;

/* The least of `times` runs. */
static Seconds write_set(VenLeaf *leaf, unsigned threads, const char *dir, int times)
{
    GError *error = NULL;
    Seconds best = {1e9, 1e9};
    leaf->threads = threads;
    for (int i = 0; i < times; i++) {
        double w = wall(), p = processor();
        if (!ven_write(leaf, dir, "whole", &error))
            g_error("%s", error->message);
        best.wall = MIN(best.wall, wall() - w);
        best.processor = MIN(best.processor, processor() - p);
        empty_dir(dir);
    }
    return best;
}

static void whole(VenLeaf *leaf, uint32_t size, double floor, const char *dir)
{
    set_size(leaf, size);
    for (unsigned threads = 1; threads <= 2; threads++) {
        peak();
        Seconds s = write_set(leaf, threads, dir, size < 4096 ? 3 : 1);
        printf("full set, %5u pixels, %u thread%s %6.2f s wall, %6.2f s processor, %4.1f times the floor, %5.0f MiB at most\n", size, threads,
               threads > 1 ? "s:" : ": ", s.wall, s.processor, s.processor / floor, peak());
    }
}

static void a_minute(VenLeaf *leaf, const char *what, const char *maps, uint32_t size, const char *dir)
{
    char *setting = g_strdup_printf("texture.maps=%s", maps);
    set(leaf, setting);
    set_size(leaf, size);
    for (unsigned threads = 1; threads <= 2; threads++) {
        Seconds s = write_set(leaf, threads, dir, size < 1024 ? 20 : 3);
        printf("%s, %u pixels, %u thread%s %6.0f leaves a minute, %6.0f a minute of processor time\n", what, size, threads,
               threads > 1 ? "s:" : ": ", 60.0 / s.wall, 60.0 / s.processor);
    }
    g_free(setting);
}

int main(int argc, char **argv)
{
    GError *error = NULL;
    setvbuf(stdout, NULL, _IOLBF, 0);
    gboolean quick = FALSE, large = FALSE, compression = FALSE;
    for (int i = 2; i < argc; i++) {
        quick |= strcmp(argv[i], "--quick") == 0;
        large |= strcmp(argv[i], "--large") == 0;
        compression |= strcmp(argv[i], "--compression") == 0;
    }
    if (argc < 2) {
        fputs("usage: bench_paint PARAMS [--quick | --large] [--compression]\n", stderr);
        return 2;
    }
    VenParams *params = ven_params_load(argv[1], &error);
    VenLeaf *leaf = params ? ven_grow(params, 1, NULL, &error) : NULL;
    char *dir = g_dir_make_tmp("venation-paint-XXXXXX", &error);
    if (!leaf || !dir)
        g_error("%s", error->message);
    set(leaf, "export.svg=no");
    set(leaf, "export.network=no");
    printf("%u vein edges\n", ven_leaf_edges(leaf));
    if (compression)
        compare_compressors(leaf, quick ? 1024 : 2048);
    for (uint32_t size = quick ? 1024 : 2048; size <= (quick ? 1024u : large ? 8192u : 4096u); size *= 2)
        whole(leaf, size, apart(leaf, size, dir), dir);
    a_minute(leaf, "training leaf, 3 maps", "base_color vein_mask vein_order", 512, dir);
    a_minute(leaf, "full set", "all", quick ? 1024 : 2048, dir);
    g_rmdir(dir);
    g_free(dir);
    ven_leaf_free(leaf);
    ven_params_free(params);
    return 0;
}
