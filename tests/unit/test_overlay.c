/* What lies between a scan and the person who draws over it: how drawings lie on scans, and the files a capture leaves behind. */
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>
#include <tiffio.h>

#include "geom/random.h"
#include "geom/svgplace.h"
#include "image/scan_file.h"
#include "import/drawing_file.h"
#include "lib/leaf.h"

static char *folder;

static char *in_folder(const char *name) { return g_build_filename(folder, name, NULL); }

static char *write_text(const char *name, const char *text)
{
    char *path = in_folder(name);
    g_assert_true(g_file_set_contents(path, text, -1, NULL));
    return path;
}

static void empty_folder(void)
{
    GDir *dir = g_dir_open(folder, 0, NULL);
    for (const char *name; (name = g_dir_read_name(dir));) {
        char *path = in_folder(name);
        g_unlink(path);
        g_free(path);
    }
    g_dir_close(dir);
}

static char *grape(void) { return g_test_build_filename(G_TEST_DIST, "..", "..", "params", "scans", "grape.jpg", NULL); }

static void set(VenParams *p, const char *key, const char *value)
{
    GError *error = NULL;
    ven_params_set(p, key, value, &error);
    g_assert_no_error(error);
}

static VenParams *scan_params(const char *image)
{
    GError *error = NULL;
    VenParams *p = ven_params_new();
    ven_params_use_scan(p, image, &error);
    g_assert_no_error(error);
    set(p, "veins.origin", "drawn");
    set(p, "texture.maps", "none");
    return p;
}

/* ---- how a drawing lies ---- */

static const SvgUnder under = {"/a/b c/leaf.jpg", 400, 300};

static double uniform(uint32_t i, uint32_t k, double low, double high) { return low + (high - low) * random_block(7, i, 0, k).w[0] * 0x1p-32; }

static void check_place(const char *text, Vec2 drawn, double column, double row, const char *how)
{
    char *path = write_text("place.svg", text);
    SvgPlace place;
    GError *error = NULL;
    svgplace_find(path, &under, &place, &error);
    g_assert_no_error(error);
    Vec2 p = affine_apply(&place.map, vec2(drawn.x, -drawn.y)), back = affine_apply(&place.inverse, p);
    if (!(fabs(p.x - column) < 1e-6 && fabs(p.y + row) < 1e-6))
        g_error("%s\nlies at %g, %g, not at %g, %g: %s", text, p.x, -p.y, column, row, place.how);
    g_assert_cmpfloat(vec_dist(back, vec2(drawn.x, -drawn.y)), <, 1e-6);
    if (!strstr(place.how, how))
        g_error("'%s' does not say '%s'", place.how, how);
    svgplace_clear(&place);
    g_unlink(path);
    g_free(path);
}

#define PAGE "<svg xmlns:xlink='l' width='210mm' height='297mm' viewBox='0 0 210 297'>"

static void test_images(void)
{
    const char *mm = "'leaf.jpg', 100 × 75 units with a corner at 20,30";
    check_place(PAGE "<image x='20' y='30' width='100' height='75' href='leaf.jpg'/></svg>", vec2(20, 30), 0, 0, mm);
    check_place(PAGE "<image x='20' y='30' width='100' height='75' href='leaf.jpg'/></svg>", vec2(120, 105), 400, 300, mm);
    check_place(PAGE "<image x='20' y='30' width='100' height='75' xlink:href='../b%20c/leaf.jpg'/></svg>", vec2(45, 55), 100, 100, "leaf.jpg");
    check_place(PAGE "<image x='20' y='30' width='100' height='75' xlink:href='C:\\b c\\LEAF.JPG'/></svg>", vec2(45, 55), 100, 100, "its image 'LEAF.JPG',");
    check_place(PAGE "<image x='20' y='30' width='100' height='75' href='data:image/png;base64,AAAA'/></svg>", vec2(45, 55), 100, 100, "embedded image");
    check_place(PAGE "<image x='20' y='30' width='100' height='75' href='copy.png'/></svg>", vec2(45, 55), 100, 100, "not the scan's");
    /* preserveAspectRatio: fitting a port of another shape, at its middle, first or last edge */
    check_place(PAGE "<image width='200' height='75'/></svg>", vec2(50, 0), 0, 0, "");
    check_place(PAGE "<image width='200' height='75' preserveAspectRatio='xMinYMid meet'/></svg>", vec2(0, 75), 0, 300, "");
    check_place(PAGE "<image width='200' height='75' preserveAspectRatio='xMaxYMid'/></svg>", vec2(200, 75), 400, 300, "");
    check_place(PAGE "<image width='100' height='175' preserveAspectRatio='xMaxYMin'/></svg>", vec2(100, 75), 400, 300, "");
    check_place(PAGE "<image width='100' height='175' preserveAspectRatio='xMaxYMax'/></svg>", vec2(100, 175), 400, 300, "");
    check_place(PAGE "<image width='200' height='75' preserveAspectRatio='xMidYMid slice'/></svg>", vec2(0, 0), 0, 75, "");
    check_place(PAGE "<image width='200' height='75' preserveAspectRatio='none'/></svg>", vec2(200, 75), 400, 300, "");
    /* lengths: units, parts of the page, left out */
    check_place(PAGE "<image x='1in' width='4in' height='3in'/></svg>", vec2(96 + 384, 288), 400, 300, "");
    check_place(PAGE "<image x='10%' y='10%' width='50%' height='300'/></svg>", vec2(21, 29.7 + 150 - 0.5 * 78.75), 0, 0, "");
    check_place(PAGE "<image x='1' width='100'/></svg>", vec2(101, 75), 400, 300, "");
    check_place(PAGE "<image y='1' height='75'/></svg>", vec2(100, 76), 400, 300, "");
    check_place(PAGE "<image/></svg>", vec2(400, 300), 400, 300, "");
    /* which of several: by its name, else the largest; not one that is only defined, nor one without size */
    check_place(PAGE "<image width='4' height='3' href='leaf.jpg'/><image width='40' height='30' href='logo.jpg'/></svg>", vec2(4, 3), 400, 300, "'leaf.jpg'");
    check_place(PAGE "<image width='40' height='30' href='logo.jpg'/><image width='4' height='3' href='leaf.jpg'/></svg>", vec2(4, 3), 400, 300, "'leaf.jpg'");
    check_place(PAGE "<image width='4' height='3'/><image width='40' height='30'/><image width='8' height='6'/></svg>", vec2(40, 30), 400, 300, "");
    check_place(PAGE "<image width='4' height='3'/><g transform='scale(20)'><image width='4' height='3'/></g></svg>", vec2(80, 60), 400, 300, "");
    check_place(PAGE "<defs><image width='40' height='30' href='leaf.jpg'/></defs><image width='4' height='3'/></svg>", vec2(4, 3), 400, 300, "");
    check_place(PAGE "<image width='4' height='3' transform='scale(0,1)'/><image width='4' height='3' style='display:none'/></svg>", vec2(4, 3), 400, 300, "");
    check_place(PAGE "<image width='4' height='3' transform='scale(1e-40)'/><image width='4' height='3' transform='scale(1e40)'/></svg>", vec2(5, 6), 5, 6,
                "units for pixels");
}

static void test_pages(void)
{
    check_place("<svg viewBox='10 20 200 150'/>", vec2(10, 20), 0, 0, "page of 200 × 150 units, as it has no image");
    check_place("<svg viewBox='10 20 200 150' width='1mm' height='9mm'/>", vec2(210, 170), 400, 300, "page of 200 × 150");
    check_place("<svg width='200' height='150'/>", vec2(200, 150), 400, 300, "page of 200 × 150");
    check_place("<svg width='40mm' height='30mm'/>", vec2(40 * 96 / 25.4, 30 * 96 / 25.4), 400, 300, "page of 151.181 × 113.386");
    check_place("<svg viewBox='0 0 201 150'/>", vec2(201, 150), 400, 300, "page"); /* rounded */
    check_place("<svg viewBox='0 0 210 150'/>", vec2(201, 150), 201, 150, "its page of 210 × 150 units is not of the shape of the scan");
    check_place("<svg/>", vec2(201, 150), 201, 150, "neither an image nor a size");
    check_place("<svg viewBox='0 0 0 150'/>", vec2(201, 150), 201, 150, "neither");
}

/* Any transforms at all: pixels taken to the page by other means than the product, and drawn there, come back. */
static void test_transforms(void)
{
    for (uint32_t i = 0; i < 200; i++) {
        double a = uniform(i, 0, -3, 3), b = uniform(i, 1, -3, 3), c = uniform(i, 2, -3, 3), d = uniform(i, 3, -3, 3), tx = uniform(i, 4, -99, 99);
        double ty = uniform(i, 5, -99, 99), x = uniform(i, 6, -50, 50), y = uniform(i, 7, -50, 50), w = uniform(i, 8, 1, 500), h = uniform(i, 9, 1, 500);
        double col = uniform(i, 10, 0, 400), row = uniform(i, 11, 0, 300);
        if (fabs(a * d - b * c) < 0.1)
            continue;
        Vec2 in_image = vec2(x + w * col / 400, y + h * row / 300), in_group = vec2(2 * in_image.x + 5, 3 * in_image.y - 7);
        Vec2 on_page = vec2(a * in_group.x + c * in_group.y + tx, b * in_group.x + d * in_group.y + ty);
        char *text = g_strdup_printf("<svg viewBox='3 4 5 6'><g transform='matrix(%.17g %.17g %.17g %.17g %.17g %.17g)'><image preserveAspectRatio='none' "
                                     "transform='translate(5,-7) scale(2,3)' x='%.17g' y='%.17g' width='%.17g' height='%.17g'/></g></svg>",
                                     a, b, c, d, tx, ty, x, y, w, h);
        check_place(text, on_page, col, row, "image");
        g_free(text);
    }
}

/* ---- drawings over the scan in the repository ---- */

#define INK "<svg width='157.48mm' height='187.96mm' viewBox='0 0 157.48 187.96' xmlns:xlink='l'>" \
    "<image width='157.48' height='187.96' preserveAspectRatio='none' xlink:href='grape.jpg'/>"
#define VEINS "<g inkscape:label='veins' style='fill:none;stroke:#f00'><path style='stroke-width:1.5' d='M 78.7,69 86,172'/>" \
    "<path style='stroke-width:0.7' d='M 80,90 C 95,95 100,110 115,120'/></g>"

/* A page in millimetres, the same drawing in pixels, and the same without the image: one leaf. */
static void test_ink(void)
{
    char *image = grape(), *mm = write_text("mm.svg", INK VEINS "</svg>"), *bare = write_text("bare.svg", "<svg viewBox='0 0 157.48 187.96'>" VEINS "</svg>");
    char *pixels = write_text("px.svg", "<svg><g id='veins'><g transform='scale(5.905512 5.905512)'>" VEINS "</g></g></svg>");
    const char *file[] = {mm, bare, pixels};
    Ground *g[3];
    for (int k = 0; k < 3; k++) {
        GError *error = NULL;
        VenParams *p = scan_params(image);
        set(p, "veins.drawing", file[k]);
        g[k] = ground_new(p->values, true, &error);
        g_assert_no_error(error);
        VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
        g_assert_no_error(error);
        ven_leaf_free(leaf);
        ven_params_free(p);
    }
    for (int k = 1; k < 3; k++)
        for (uint32_t v = 0; v < 2; v++) {
            const DrawnVein *one = &g[0]->drawing->vein[v], *other = &g[k]->drawing->vein[v];
            g_assert_cmpfloat(vec_dist(one->point[0], other->point[0]), <, 1e-4);
            g_assert_cmpfloat(vec_dist(one->point[one->n - 1], other->point[other->n - 1]), <, 1e-4);
            g_assert_cmpfloat(fabs(one->width[0] / other->width[0] - 1.0), <, 1e-3);
        }
    Vec2 start = affine_apply(&g[0]->to_scan, g[0]->drawing->vein[0].point[0]); /* 5.9055 pixels a millimetre */
    g_assert_cmpfloat(vec_dist(start, vec2(78.7 * 930 / 157.48, 69 * 1110 / 187.96)), <, 1e-6);
    for (int k = 0; k < 3; k++) {
        ground_unref(g[k]);
        g_unlink(file[k]);
    }
    g_free(image);
    g_free(mm);
    g_free(bare);
    g_free(pixels);
}

/* The outline drawn over it, with base and tip; points given by hand are in the drawing's units, and so are complaints. */
static void test_outline(void)
{
    char *image = grape(), *file = write_text("outline.svg", INK "<path id='outline' d='M 78,69 C 150,60 150,150 86,174 C 20,150 20,60 78,69 Z'/>" VEINS
                                                                 "<circle id='base' cx='78' cy='69' r='1'/><circle id='tip' cx='86' cy='174' r='1'/></svg>");
    GError *error = NULL;
    VenParams *p = scan_params(image);
    set(p, "outline.file", file);
    set(p, "veins.drawing", file);
    Ground *g = ground_new(p->values, true, &error);
    g_assert_no_error(error);
    double mm = 930 / 157.48, down = 1110 / 187.96;
    g_assert_cmpfloat(vec_dist(affine_apply(&g->to_scan, vec2(0, 0)), vec2(78 * mm, 69 * down)), <, 1e-6);
    g_assert_cmpfloat(vec_dist(affine_apply(&g->to_scan, vec2(0, 1)), vec2(86 * mm, 174 * down)), <, 1e-6);
    ground_unref(g);
    set(p, "outline.base", "79,72");
    g = ground_new(p->values, true, &error);
    g_assert_no_error(error);
    g_assert_cmpfloat(vec_dist(affine_apply(&g->to_scan, vec2(0, 0)), vec2(79 * mm, 72 * down)), <, 1e-6);
    ground_unref(g);
    set(p, "outline.base", "10,20");
    g_assert_null(ground_new(p->values, true, &error));
    g_assert_nonnull(strstr(error->message, "the base 10,20 lies outside the blade"));
    g_clear_error(&error);
    ven_params_free(p);
    g_unlink(file);
    g_free(file);
    g_free(image);
}

/* What lies beside the leaf says how the drawing was laid. */
static void test_outside(void)
{
    char *image = grape(), *file = write_text("off.svg", "<svg viewBox='0 0 100 100'>" VEINS "</svg>");
    GError *error = NULL;
    VenParams *p = scan_params(image);
    set(p, "veins.drawing", file);
    g_assert_null(ven_grow(p, 1, NULL, &error));
    g_assert_nonnull(strstr(error->message, "lies outside the blade"));
    g_assert_nonnull(strstr(error->message, "the drawing was laid on the scan by taking its units for pixels, as it has no image"));
    g_clear_error(&error);
    ven_params_free(p);
    g_unlink(file);
    g_free(file);
    g_free(image);
}

/* ---- scans as they are kept ---- */

static Scan *noise(uint32_t channels, uint32_t depth)
{
    Scan *s = scan_new(37, 23, channels, depth);
    gsize n = (gsize)s->width * s->height * channels * depth / 8;
    for (gsize i = 0; i < n; i++)
        ((uint8_t *)s->px)[i] = (uint8_t)random_block(5, (uint32_t)i, channels, depth).w[0];
    s->mm_per_pixel = 25.4 / 300;
    return s;
}

static void check_same(const Scan *a, const Scan *b)
{
    g_assert_cmpuint(a->width, ==, b->width);
    g_assert_cmpuint(a->height, ==, b->height);
    g_assert_cmpuint(a->depth, ==, b->depth);
    g_assert_cmpuint(a->channels, ==, b->channels);
    g_assert_cmpfloat(fabs(a->mm_per_pixel - b->mm_per_pixel), <=, 1e-4 * a->mm_per_pixel);
    g_assert_cmpint(memcmp(a->px, b->px, (gsize)a->width * a->height * a->channels * a->depth / 8), ==, 0);
}

static void test_kept(void)
{
    char *path = in_folder("kept.png");
    for (uint32_t channels = 1; channels <= 4; channels++)
        for (uint32_t depth = 8; depth <= 16; depth += 8) {
            GError *error = NULL;
            Scan *s = noise(channels, depth), *twin = scan_copy(s);
            check_same(s, twin);
            image_write_scan(s, path, &error);
            g_assert_no_error(error);
            Scan *back = scan_read(path, 0, &error);
            g_assert_no_error(error);
            check_same(s, back);
            g_assert_true(back->as_stored);
            scan_free(s);
            scan_free(twin);
            scan_free(back);
        }
    GError *error = NULL;
    Scan *s = noise(1, 8);
    g_assert_false(image_write_scan(s, "/no/such/folder/kept.png", &error));
    g_assert_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
    g_clear_error(&error);
    scan_free(s);
    g_unlink(path);
    g_free(path);
}

/* The scan in the repository with another orientation in its Exif tag; its bytes stay as they are. */
static char *turned(unsigned orientation)
{
    static const guchar tag[] = {0x01, 0x12, 0x00, 0x03, 0x00, 0x00, 0x00, 0x01, 0x00};
    char *image = grape(), *bytes, *path = in_folder("turned.jpg");
    gsize n, at = 0;
    g_assert_true(g_file_get_contents(image, &bytes, &n, NULL));
    while (at + sizeof tag < n && memcmp(bytes + at, tag, sizeof tag))
        at++;
    g_assert_cmpuint(at + sizeof tag, <, n);
    bytes[at + sizeof tag] = (char)orientation;
    g_assert_true(g_file_set_contents(path, bytes, (gssize)n, NULL));
    g_free(bytes);
    g_free(image);
    return path;
}

static bool holds(const char *name, const char *text)
{
    char *path = in_folder(name), *all = NULL;
    bool yes = g_file_get_contents(path, &all, NULL, NULL) && (!text || strstr(all, text));
    g_free(all);
    g_free(path);
    return yes;
}

/* Captures, writes what one goes on with, and reads that again: the outline lies where it lay. */
static void check_kept(const char *image, const char *scan, bool as_is)
{
    GError *error = NULL;
    VenParams *p = scan_params(image);
    set(p, "scan.veins", "none");
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    g_assert_true(ven_write_capture(leaf, folder, "x", &error));
    char *kept = in_folder(scan), *ini = in_folder("x.ini"), *href = g_strdup_printf("xlink:href=\"%s\"", scan);
    g_assert_true(holds("x_drawing.svg", href));
    Scan *before = scan_read(image, 0, &error), *after = scan_read(kept, 0, &error);
    g_assert_no_error(error);
    check_same(before, after);
    g_assert_cmpint(before->as_stored, ==, as_is);
    g_assert_true(after->as_stored);
    VenParams *q = ven_params_load(ini, &error);
    g_assert_no_error(error);
    Ground *g = ground_new(q->values, true, &error);
    g_assert_no_error(error);
    g_assert_nonnull(g->drawing);
    g_assert_cmpuint(g->drawing->n, ==, 0); /* holes are no veins */
    uint32_t holes = leaf->ground->holes ? leaf->ground->holes->n : 0;
    g_assert_cmpuint(g->holes ? g->holes->n : 0, ==, holes);
    g_assert_cmpuint(holes, ==, strcmp(scan, "x_scan.jpg") == 0 ? 2 : holes); /* grape.jpg as it is */
    g_assert_true(holds("x_drawing.svg", "id=\"hole-2\"") == (holes >= 2) && !holds("x_drawing.svg", "id=\"hole-3\""));
    for (int k = 0; k < 2; k++)
        g_assert_cmpfloat(vec_dist(affine_apply(&g->to_scan, vec2(0, k)), affine_apply(&leaf->ground->to_scan, vec2(0, k))), <, 0.01);
    ground_unref(g);
    scan_free(before);
    scan_free(after);
    ven_params_free(q);
    ven_params_free(p);
    ven_leaf_free(leaf);
    g_free(kept);
    g_free(ini);
    g_free(href);
    empty_folder();
}

static void test_orientation(void)
{
    static const unsigned orientation[] = {1, 3, 6};
    for (gsize k = 0; k < G_N_ELEMENTS(orientation); k++) {
        char *path = turned(orientation[k]);
        check_kept(path, orientation[k] == 1 ? "x_scan.jpg" : "x_scan.png", orientation[k] == 1);
        g_free(path);
    }
}

static void write_tiff(const Scan *s, const char *path)
{
    TIFF *t = TIFFOpen(path, "w");
    TIFFSetField(t, TIFFTAG_IMAGEWIDTH, s->width);
    TIFFSetField(t, TIFFTAG_IMAGELENGTH, s->height);
    TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, s->depth);
    TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, s->channels);
    TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
    TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, s->height);
    TIFFSetField(t, TIFFTAG_RESOLUTIONUNIT, RESUNIT_INCH);
    TIFFSetField(t, TIFFTAG_XRESOLUTION, 300.0);
    TIFFSetField(t, TIFFTAG_YRESOLUTION, 300.0);
    for (uint32_t y = 0; y < s->height; y++)
        TIFFWriteScanline(t, (uint8_t *)s->px + (gsize)y * s->width * s->channels * s->depth / 8, y, 0);
    TIFFClose(t);
}

/* White paper with elliptic leaves. */
static Scan *paper(uint32_t width, uint32_t height, uint32_t n, const Vec2 *middle, const Vec2 *half)
{
    Scan *s = scan_new(width, height, 3, 16);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            for (uint32_t c = 0; c < 3; c++) {
                bool leaf = false;
                for (uint32_t k = 0; k < n; k++) {
                    double u = (x + 0.5 - middle[k].x) / half[k].x, v = (y + 0.5 - middle[k].y) / half[k].y;
                    leaf |= u * u + v * v <= 1.0;
                }
                ((uint16_t *)s->px)[3 * ((gsize)y * width + x) + c] = leaf ? (uint16_t)(c == 1 ? 30000 : 12000) : 64000;
            }
    s->mm_per_pixel = 25.4 / 300;
    return s;
}

static void test_tiff(void)
{
    Scan *s = paper(120, 200, 1, &(Vec2){60, 100}, &(Vec2){30, 80});
    char *path = in_folder("leaf.tif");
    write_tiff(s, path);
    check_kept(path, "x_scan.png", false);
    scan_free(s);
    g_free(path);
}

/* ---- leaves without veins ---- */

static void test_no_veins(void)
{
    GError *error = NULL;
    Scan *s = paper(300, 400, 1, &(Vec2){150, 200}, &(Vec2){90, 180});
    char *image = in_folder("bare.png"), *ini = in_folder("y.ini"), *graph = in_folder("y.graphml");
    image_write_scan(s, image, &error);
    VenParams *p = scan_params(image);
    set(p, "growth.initial_length", "20");
    set(p, "growth.final_length", "60");
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    g_assert_cmpuint(ven_leaf_edges(leaf), ==, 0);
    g_assert_true(ven_write(leaf, folder, "y", &error) && ven_write_capture(leaf, folder, "y", &error));

    VenParams *q = ven_params_load(ini, &error); /* none are drawn, so all grow */
    VenLeaf *grown = ven_grow(q, 1, NULL, &error);
    g_assert_no_error(error);
    g_assert_cmpuint(ven_leaf_edges(grown), >, 100);

    VenLeaf *read = ven_leaf_load(p, graph, 1, &error); /* the network reads back, and a midrib carries the leaf */
    g_assert_no_error(error);
    g_assert_cmpuint(ven_leaf_nodes(read), ==, 1);
    g_assert_cmpuint(ven_leaf_edges(read), ==, 0);
    g_assert_cmpfloat(fabs(read->net->margin->area / leaf->net->margin->area - 1.0), <, 1e-5);
    VenLeaf *both[] = {leaf, read};
    for (int k = 0; k < 2; k++) {
        VenShape *shape = ven_shape(both[k], &error);
        g_assert_no_error(error);
        g_assert_cmpuint(ven_shape_veins(shape), ==, 1);
        char *record = ven_shape_record(shape);
        g_assert_nonnull(strstr(record, "\"name\": \"midrib\""));
        g_free(record);
        ven_shape_free(shape);
    }
    ven_leaf_free(leaf);
    ven_leaf_free(grown);
    ven_leaf_free(read);
    ven_params_free(p);
    ven_params_free(q);
    scan_free(s);
    g_free(image);
    g_free(ini);
    g_free(graph);
    empty_folder();
}

/* A speck is an outline all the same, and says that it is one. */
static void test_speck(void)
{
    GError *error = NULL;
    Scan *s = paper(300, 400, 1, &(Vec2){150, 200}, &(Vec2){4, 6});
    char *image = in_folder("speck.png");
    image_write_scan(s, image, &error);
    VenParams *p = scan_params(image);
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    g_assert_cmpuint(ven_leaf_edges(leaf), ==, 0);
    const char *note = ven_leaf_note(leaf), *area = strstr(note, "measures ");
    g_assert_true(g_str_has_prefix(note, "the leaf is only "));
    g_assert_cmpfloat(fabs(g_ascii_strtod(note + strlen("the leaf is only "), NULL) - 8.0), <, 1.0);
    g_assert_nonnull(area);
    g_assert_cmpfloat(fabs(g_ascii_strtod(area + strlen("measures "), NULL) - G_PI * 24), <, 6.0);
    ven_leaf_free(leaf);
    set(p, "scan.base", "10,390");
    g_assert_null(ven_grow(p, 1, NULL, &error));
    g_assert_nonnull(strstr(error->message, "scan.base 10,390 lies "));
    g_assert_nonnull(strstr(error->message, "y 194 … 206 (pixels from the upper left corner)"));
    g_clear_error(&error);
    ven_params_free(p);
    scan_free(s);
    g_free(image);
    empty_folder();
}

/* ---- several leaves ---- */

static VenLeaf *one_leaf(VenParams *p, const char *which, VenScan *sheet)
{
    GError *error = NULL;
    set(p, "scan.leaf", which);
    VenLeaf *leaf = sheet ? ven_scan_grow(sheet, p, 1, NULL, &error) : ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    return leaf;
}

/* Leaves of a sheet are those that are captured one by one, down to the colours; they share one copy of the scan. */
/* A leaf of a sheet has the pixels that lie around it. */
static void check_around(const VenLeaf *of_sheet, const VenLeaf *alone)
{
    const Scan *a = of_sheet->ground->scan, *b = alone->ground->scan;
    Box2 box = of_sheet->ground->profile->outline->box;
    g_assert_cmpuint(a->width, ==, b->width);
    g_assert_cmpuint(a->height, ==, b->height);
    for (uint32_t y = (uint32_t)(a->height - box.y1) - 20; y < (uint32_t)(a->height - box.y0) + 20; y++)
        for (uint32_t x = (uint32_t)box.x0 - 20; x < (uint32_t)box.x1 + 20; x++)
            for (uint32_t c = 0; c < a->channels; c++)
                g_assert_cmpuint(scan_sample(a, x, y, c), ==, scan_sample(b, x, y, c));
}

static void test_each(void)
{
    static const char *const number[] = {"1", "2", "3", "2"};
    GError *error = NULL;
    Scan *s = paper(500, 300, 3, (const Vec2[]){{100, 150}, {250, 150}, {400, 150}}, (const Vec2[]){{50, 100}, {60, 120}, {40, 80}});
    char *image = in_folder("leaves.png");
    image_write_scan(s, image, &error);
    VenParams *p = scan_params(image);
    VenScan *sheet = ven_scan_open(p, &error);
    g_assert_no_error(error);
    g_assert_cmpuint(ven_scan_count(sheet), ==, 3);
    g_assert_cmpuint(ven_scan_leaves(p, &error), ==, 3);
    for (gsize k = 0; k < G_N_ELEMENTS(number); k++) { /* the last one for the second time */
        VenLeaf *of_sheet = one_leaf(p, number[k], sheet), *alone = one_leaf(p, number[k], NULL);
        g_assert_cmphex(leaf_hash(of_sheet->net), ==, leaf_hash(alone->net));
        check_around(of_sheet, alone);
        char *a = ven_leaf_record(of_sheet), *b = ven_leaf_record(alone), *name = g_strdup_printf("z_%zu", k + 1);
        g_assert_cmpstr(a, ==, b);
        g_assert_true(ven_write_capture_of(of_sheet, folder, name, "z", &error));
        char *file = g_strconcat(name, "_drawing.svg", NULL);
        g_assert_true(holds(file, "\"z_scan.png\""));
        g_free(file);
        g_free(a);
        g_free(b);
        g_free(name);
        ven_leaf_free(of_sheet);
        ven_leaf_free(alone);
    }
    g_assert_true(holds("z_scan.png", NULL) && !holds("z_1_scan.png", NULL) && !holds("z_2_scan.png", NULL));
    g_assert_true(holds("z_3.ini", "file = z_scan.png"));
    set(p, "scan.leaf", "4");
    g_assert_null(ven_scan_grow(sheet, p, 1, NULL, &error));
    g_assert_nonnull(strstr(error->message, "scan.leaf is 4, but there are 3 in the image"));
    g_clear_error(&error);
    ven_scan_close(sheet);
    ven_params_free(p);
    VenParams *none = ven_params_new();
    g_assert_null(ven_scan_open(none, &error));
    g_assert_nonnull(strstr(error->message, "scan.file is not given"));
    g_clear_error(&error);
    ven_params_free(none);
    scan_free(s);
    g_free(image);
    empty_folder();
}

/* ---- tracings ---- */

/* A tracing says no orders; its drawing has those of the network, by which colours tell veins apart. */
static void test_tracing(void)
{
    GError *error = NULL;
    Scan *s = paper(300, 400, 1, &(Vec2){150, 200}, &(Vec2){120, 190});
    char *image = in_folder("traced.png");
    char *tracing = write_text("traced.txt", "150 385\n150 200\n150 20\n\n150 200\n200 150\n\n150 250\n100 200\n\n175 175\n190 178\n205 185\n");
    image_write_scan(s, image, &error);
    VenParams *p = scan_params(image);
    set(p, "scan.base", "150,389");
    set(p, "veins.drawing", tracing);
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    g_assert_true(ven_write_capture(leaf, folder, "t", &error));
    char *file = in_folder("t_drawing.svg");
    Drawing *d = drawing_read_svg(file, 0.1, NULL, &error);
    g_assert_no_error(error);
    static const uint8_t order[] = {1, 2, 2, 3};
    g_assert_cmpuint(d->n, ==, 4);
    for (uint32_t k = 0; k < d->n; k++)
        g_assert_cmpuint(d->vein[k].order, ==, order[k]);
    g_assert_false(holds("t_drawing.svg", "id=\"unordered\""));
    drawing_free(d);
    ven_leaf_free(leaf);
    ven_params_free(p);
    scan_free(s);
    g_free(file);
    g_free(tracing);
    g_free(image);
    empty_folder();
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    folder = g_dir_make_tmp("venation-overlay-XXXXXX", NULL);
    g_test_add_func("/overlay/images", test_images);
    g_test_add_func("/overlay/pages", test_pages);
    g_test_add_func("/overlay/transforms", test_transforms);
    g_test_add_func("/overlay/ink", test_ink);
    g_test_add_func("/overlay/outline", test_outline);
    g_test_add_func("/overlay/outside", test_outside);
    g_test_add_func("/overlay/kept", test_kept);
    g_test_add_func("/overlay/orientation", test_orientation);
    g_test_add_func("/overlay/tiff", test_tiff);
    g_test_add_func("/overlay/no-veins", test_no_veins);
    g_test_add_func("/overlay/speck", test_speck);
    g_test_add_func("/overlay/each", test_each);
    g_test_add_func("/overlay/tracing", test_tracing);
    int status = g_test_run();
    g_rmdir(folder);
    g_free(folder);
    return status;
}
