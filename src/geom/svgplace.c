#include "geom/svgplace.h"

#include <string.h>

#include "geom/svgwalk.h"

static const double same_shape = 0.01; /* of a page and a scan: how far their ratios of width to height may differ */

typedef struct {
    const SvgUnder *under;
    double page[4];          /* viewBox, or width and height at 0,0, in user units; 0: not known */
    bool any, named;         /* an image was found; its address ends in the file's name */
    double area;             /* of it, user units² */
    Affine image;            /* from columns and negative rows to the drawing's units, y up */
    char *what;
} Reader;

/* From the scan to the drawing and back; false where one of them has no size, or numbers get out of hand. */
static bool invert(const Affine *m, Affine *out)
{
    const double largest = 1e30;
    double det = m->a * m->d - m->b * m->c;
    bool good = true;
    if (!(fabs(det) > 0.0))
        return false;
    *out = (Affine){.a = m->d / det, .b = -m->b / det, .c = -m->c / det, .d = m->a / det};
    out->e = -(out->a * m->e + out->c * m->f);
    out->f = -(out->b * m->e + out->d * m->f);
    const double all[] = {m->a, m->b, m->c, m->d, m->e, m->f, out->a, out->b, out->c, out->d, out->e, out->f};
    for (gsize k = 0; k < G_N_ELEMENTS(all); k++)
        good &= fabs(all[k]) <= largest;
    return good;
}

/* ---- images ---- */

static const char *last_part(const char *path)
{
    for (const char *at; (at = strpbrk(path, "/\\"));)
        path = at + 1;
    return path;
}

/* The file's name in an address, which may be escaped as URIs are; NULL for an embedded image. */
static char *address_name(const SvgElement *e)
{
    const char *href = svgelement_attribute(e, "href");
    href = href ? href : svgelement_attribute(e, "xlink:href");
    if (!href || g_str_has_prefix(href, "data:"))
        return NULL;
    char *plain = g_uri_unescape_string(href, NULL), *name = g_strdup(last_part(plain ? plain : href));
    g_free(plain);
    return name;
}

static double length_of(const SvgElement *e, const char *name, double whole)
{
    double value = 0.0;
    return svgwalk_length(svgelement_attribute(e, name), whole, &value) ? value : 0.0;
}

/* x, y, width and height in its user units; a missing side follows from the other one, both from the pixels (SVG 2, 12.3). */
static void image_port(const Reader *r, const SvgElement *e, double port[4])
{
    double w = r->under->width, h = r->under->height;
    port[0] = length_of(e, "x", r->page[2]);
    port[1] = length_of(e, "y", r->page[3]);
    port[2] = length_of(e, "width", r->page[2]);
    port[3] = length_of(e, "height", r->page[3]);
    bool wide = port[2] > 0.0, high = port[3] > 0.0;
    if (!wide)
        port[2] = high ? port[3] * w / h : w;
    if (!high)
        port[3] = wide ? port[2] * h / w : h;
}

static void see_image(Reader *r, const SvgElement *e)
{
    const double pixels[4] = {0.0, 0.0, r->under->width, r->under->height};
    double port[4];
    image_port(r, e, port);
    Affine own = svgwalk_viewport(port, pixels, svgelement_attribute(e, "preserveAspectRatio")), down = {1.0, 0.0, 0.0, -1.0, 0.0, 0.0};
    Affine map = affine_multiply(&e->map, &own);
    double area = fabs(map.a * map.d - map.b * map.c) * pixels[2] * pixels[3];
    Affine back;
    map = affine_multiply(&map, &down);
    char *name = address_name(e);
    bool named = name && !g_ascii_strcasecmp(name, last_part(r->under->file));
    if (invert(&map, &back) && (!r->any || named > r->named || (named == r->named && area > r->area))) {
        g_free(r->what);
        r->what = g_strdup_printf("its %s%s%s%s, %.6g × %.6g units with a corner at %.6g,%.6g", name ? "image '" : "embedded image", name ? name : "",
                                  name ? "'" : "", named || !name ? "" : " (whose name is not the scan's)",
                                  sqrt(map.a * map.a + map.b * map.b) * pixels[2], sqrt(map.c * map.c + map.d * map.d) * pixels[3], map.e + 0.0, 0.0 - map.f);
        r->image = map;
        r->any = true;
        r->named = named;
        r->area = area;
    }
    g_free(name);
}

static bool see_element(const SvgElement *e, void *user, GError **error)
{
    Reader *r = user;
    if (!e->above && !svgwalk_box(svgelement_attribute(e, "viewBox"), r->page)) {
        r->page[0] = r->page[1] = 0.0;
        r->page[2] = length_of(e, "width", 0.0);
        r->page[3] = length_of(e, "height", 0.0);
    }
    if (!strcmp(e->name, "image") && !e->defined)
        see_image(r, e);
    return true;
}

/* ---- the place ---- */

/* From columns and negative rows to the page that the scan covers, or whose units are its pixels. */
static Affine by_page(const Reader *r, char **how)
{
    double w = r->under->width, h = r->under->height, pw = r->page[2], ph = r->page[3];
    bool page = pw > 0.0 && ph > 0.0;
    char *size = page ? g_strdup_printf("%.6g × %.6g units", pw, ph) : NULL;
    if (page && fabs(pw * h - ph * w) <= same_shape * ph * w) {
        *how = g_strdup_printf("its page of %s, as it has no image", size);
        g_free(size);
        return (Affine){.a = pw / w, .d = ph / h, .e = r->page[0], .f = -r->page[1]};
    }
    *how = page ? g_strdup_printf("taking its units for pixels, as it has no image, and its page of %s is not of the shape of the scan", size)
                : g_strdup("taking its units for pixels, as it has neither an image nor a size");
    g_free(size);
    return (Affine){.a = 1.0, .d = 1.0};
}

bool svgplace_find(const char *drawing, const SvgUnder *under, SvgPlace *out, GError **error)
{
    Reader r = {.under = under};
    bool good = svgwalk_file(drawing, see_element, &r, error);
    if (good) {
        out->how = r.any ? g_steal_pointer(&r.what) : NULL;
        out->inverse = r.any ? r.image : by_page(&r, &out->how);
        if (!invert(&out->inverse, &out->map)) /* a page of no size to speak of */
            out->map = out->inverse = (Affine){.a = 1.0, .d = 1.0};
    }
    g_free(r.what);
    return good;
}

void svgplace_clear(SvgPlace *place)
{
    g_free(place->how);
    *place = (SvgPlace){0};
}
