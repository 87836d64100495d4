/* Names for texts that an SVG file declares at its head, as Illustrator does for namespaces: <!ENTITY ns_svg "http://www.w3.org/2000/svg">. */
#ifndef GEOM_SVGENTITY_H
#define GEOM_SVGENTITY_H

#include <glib.h>

/* The text with references (&ns_svg;) replaced by what they stand for, lines kept, and its length; NULL when it declares none that could be used, or so
 * much that it would grow beyond `largest` bytes. Texts of more than 1000 bytes and those with references of their own are left out. */
char *svgentity_expand(const char *text, gsize *length, gsize largest);

#endif
