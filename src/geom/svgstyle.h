/* Style sheets of SVG files (<style>), as drawing programs write them: rules of single elements, by name, class and id. */
#ifndef GEOM_SVGSTYLE_H
#define GEOM_SVGSTYLE_H

#include <glib.h>
#include <stdbool.h>

typedef struct SvgStyle SvgStyle;
SvgStyle *svgstyle_new(void);
void svgstyle_free(SvgStyle *s);

/* Reads rules "path.st0, #midrib { stroke-width: 2px; }". At-rules (@media …) are passed over, and so are selectors that are more than an
 * element's name or *, classes and ids: combinators, attributes, pseudo-classes. Like a browser it takes what it can of any text. */
void svgstyle_add(SvgStyle *s, const char *text);

/* What decides a property of an element (CSS 2.1, 6.4): the style sheet's rule for it that weighs most, before the element's attribute of that
 * name, and its style attribute before both, but for !important. The strings may be NULL. Free it; NULL: not set. */
char *svgstyle_property(const SvgStyle *s, const char *element, const char *id, const char *classes, const char *style, const char *plain,
                        const char *property);

#endif
