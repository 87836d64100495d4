/* The turtle of sim/lsystem.h. */
#include <string.h>

#include "geom/bezier.h"
#include "sim/lturtle.h"

/* --- drawing --- */

static uint32_t add_node(Drawing *d, Vec2 at, uint32_t birth)
{
    g_array_append_val(d->node, at);
    g_array_append_val(d->birth, birth);
    return d->node->len - 1;
}

/* The node where the turtle is. */
static uint32_t here(Drawing *d, Turtle *t, uint32_t birth)
{
    if (t->node != NONE)
        return t->node;
    Spot *spot = &g_array_index(d->spot, Spot, t->spot);
    if (spot->node == NONE)
        spot->node = add_node(d, spot->at, birth);
    return t->node = spot->node;
}

void lturtle_draw(Drawing *d, Turtle *t, Vec2 to, uint16_t born, uint32_t depth)
{
    if ((to.x == t->at.x && to.y == t->at.y) || (d->overflow |= d->piece->len >= d->def->max_symbols))
        return;
    uint32_t tail = here(d, t, born), birth = MAX(born, g_array_index(d->birth, uint32_t, tail));
    if (t->vein == NONE)
        t->vein = d->n_veins++;
    Piece piece = {.tail = tail,
                   .head = add_node(d, to, birth),
                   .vein = t->vein,
                   .born = (uint16_t)birth,
                   .order = (uint8_t)MIN(depth - t->first + 1, MAX_ORDER),
                   .width = d->width[born] * t->width};
    g_array_append_val(d->piece, piece);
    t->node = piece.head;
    t->at = to;
}

void lturtle_go(Drawing *d, Turtle *t, double length, uint32_t n, uint16_t born, uint32_t depth, bool draws)
{
    double sine, cosine;
    for (uint32_t k = 0; k < n && !t->stopped && !d->overflow; k++) {
        if (d->def->bend != 0.0) {
            degrees_sincos(t->heading - t->tilt, &sine, &cosine);
            t->heading += d->def->bend * cosine * length / (n * d->unit * t->scale);
        }
        double heading = t->wary != 0.0 || t->swerve != 0.0 ? t->heading + lturtle_swerve(d, t, length / n) : t->heading;
        Vec2 to = vec_add(t->at, vec_scale(lturtle_direction(d, t, heading, length / n), length / n));
        if (!lturtle_in_field(d, t, to)) {
            t->stopped = true;
            return;
        }
        if (!lturtle_clip(d, t, &to))
            break;
        if (draws)
            lturtle_draw(d, t, to, born, depth);
        else
            t->at = to;
    }
    if (draws)
        d->n_margin += t->stopped && t->vein != NONE;
}

static void step(Drawing *d, Turtle *t, uint16_t born, uint32_t depth, bool draws)
{
    double length = d->length[born] * t->length * t->scale;
    lturtle_go(d, t, length, lturtle_pieces(length), born, depth, draws);
    if (!draws && !t->stopped) {
        Spot spot = {t->at, NONE};
        g_array_append_val(d->spot, spot);
        t->node = t->vein = NONE;
        t->spot = d->spot->len - 1;
    }
}

static bool draws(const LSystemDef *def, char c) { return c == 'F' || (def->draws && c != '\0' && strchr(def->draws, c) != NULL); }

static void obey(Drawing *d, Turtle *t, char symbol, uint16_t born, uint32_t depth)
{
    if (draws(d->def, symbol) || symbol == 'f') {
        if (!t->stopped)
            step(d, t, born, depth, draws(d->def, symbol));
        return;
    }
    if (symbol != '\0' && strchr("^<>~$", symbol)) {
        if (d->margin && !t->stopped)
            lturtle_obey_blade(d, t, symbol, born, depth);
        return;
    }
    switch (symbol) {
    case '+':
        t->heading += d->def->angle;
        break;
    case '-':
        t->heading -= d->def->angle;
        break;
    case '|':
        t->heading += 180.0;
        break;
    case '!':
        t->width *= d->def->width_scale;
        break;
    case '@':
        t->length *= d->def->length_scale;
        break;
    default:
        break;
    }
}

static void draw(Drawing *d, const LString *s)
{
    GArray *stack = g_array_new(FALSE, FALSE, sizeof(Turtle));
    Turtle t = {.heading = 90.0, .length = 1.0, .width = 1.0, .scale = 1.0, .node = NONE, .vein = NONE};
    const Spot base = {{0.0, 0.0}, NONE};
    g_array_append_val(d->spot, base);
    for (uint32_t i = 0; i < s->n; i++) {
        if (s->symbol[i] == '[') {
            g_array_append_val(stack, t);
            t.vein = NONE;
            t.stopped |= t.swerve != 0.0; /* there's no room for branches either */
            t.wary = 0.0;
        } else if (s->symbol[i] == ']') {
            t = g_array_index(stack, Turtle, stack->len - 1);
            g_array_set_size(stack, stack->len - 1);
        } else {
            obey(d, &t, s->symbol[i], s->born[i], stack->len);
        }
    }
    g_array_unref(stack);
}

/* --- limits --- */

static bool fail_pieces(double pieces, const LSystemDef *def, GError **error)
{
    g_set_error(
        error, LSYSTEM_ERROR, LSYSTEM_ERROR_LIMIT,
        "the L-system's veins would be drawn in %s%.0f pieces of a segment; the limit is %u. Fewer iterations or a smaller leaf have less",
        pieces > def->max_symbols ? "" : "more than ", pieces, def->max_symbols);
    return false;
}

/* Pieces in the whole drawing, were nothing cut off; the string's @ are followed as the turtle would. What depends on the blade is counted
 * as it is drawn. */
static bool check_pieces(const Drawing *d, const LString *s, GError **error)
{
    double pieces = 0.0, scale = 1.0;
    GArray *stack = g_array_new(FALSE, FALSE, sizeof(double));
    for (uint32_t i = 0; i < s->n; i++) {
        if (s->symbol[i] == '[') {
            g_array_append_val(stack, scale);
        } else if (s->symbol[i] == ']') {
            scale = g_array_index(stack, double, stack->len - 1);
            g_array_set_size(stack, stack->len - 1);
        } else if (s->symbol[i] == '@') {
            scale *= d->def->length_scale;
        } else if (s->symbol[i] == 'f' || draws(d->def, s->symbol[i])) {
            pieces += MAX(ceil(d->length[s->born[i]] * scale), 1.0);
        }
    }
    g_array_unref(stack);
    if (pieces <= d->def->max_symbols)
        return true;
    return fail_pieces(pieces, d->def, error);
}

/* --- the network --- */

static Network *take_network(Drawing *d)
{
    Network *net = network_new(d->node->len, d->piece->len);
    net->n_steps = d->def->iterations;
    memcpy(net->node, d->node->data, d->node->len * sizeof(Vec2));
    memcpy(net->node_birth, d->birth->data, d->birth->len * sizeof(uint32_t));
    for (uint32_t e = 0; e < net->n_edges; e++) {
        const Piece *piece = &g_array_index(d->piece, Piece, e);
        net->tail[e] = piece->tail;
        net->head[e] = piece->head;
        net->birth[e] = piece->born;
        net->kind[e] = EDGE_VEIN;
    }
    net->margin = d->margin;
    d->margin = NULL;
    network_assign_widths(net, &d->def->widths);
    net->n_veins = d->n_veins;
    for (uint32_t e = 0; e < net->n_edges; e++) { /* the brackets' hierarchy in place of that by flow */
        const Piece *piece = &g_array_index(d->piece, Piece, e);
        net->order[e] = piece->order;
        net->vein[e] = piece->vein;
        if (!d->def->murray)
            net->width[e] = piece->width;
    }
    return net;
}

static void drawing_init(Drawing *d, const LSystemDef *def, const Polygon *leaf, double length)
{
    *d = (Drawing){.def = def, .unit = length};
    if (leaf) {
        Vec2 *v = g_new(Vec2, leaf->n);
        for (uint32_t i = 0; i < leaf->n; i++)
            v[i] = vec_scale(leaf->v[i], length);
        d->margin = polygon_new(v, leaf->n);
        g_free(v);
        if (def->axis)
            d->axis = *def->axis;
        else
            laxis_of_blade(leaf, &d->axis);
    }
    double step = d->axis.curved ? def->step * length * d->axis.length : def->step * length;
    d->length = g_new(double, (gsize)def->iterations + 1);
    d->width = g_new(double, (gsize)def->iterations + 1);
    for (uint32_t k = 0; k <= def->iterations; k++) {
        d->length[k] = k ? d->length[k - 1] * def->length_scale : step;
        d->width[k] = k ? d->width[k - 1] * def->width_scale : def->width;
    }
    d->node = g_array_new(FALSE, FALSE, sizeof(Vec2));
    d->birth = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    d->piece = g_array_new(FALSE, FALSE, sizeof(Piece));
    d->spot = g_array_new(FALSE, FALSE, sizeof(Spot));
}

static void drawing_clear(Drawing *d)
{
    polygon_free(d->margin);
    g_free(d->length);
    g_free(d->width);
    g_array_unref(d->node);
    g_array_unref(d->birth);
    g_array_unref(d->piece);
    g_array_unref(d->spot);
}

Network *lsystem_network(const LSystemDef *def, const Polygon *leaf, double length, uint32_t *margin_veins, GError **error)
{
    if (!(length > 0.0 && length <= 1e6)) {
        g_set_error(error, LSYSTEM_ERROR, LSYSTEM_ERROR_SETTINGS,
                    "the leaf's length is %g; it must be above 0 and no more than 1e6 segments", length);
        return NULL;
    }
    LString *s = lsystem_expand(def, error);
    if (!s)
        return NULL;
    Drawing d;
    Network *net = NULL;
    drawing_init(&d, def, leaf, length);
    if (check_pieces(&d, s, error)) {
        draw(&d, s);
        if (d.overflow)
            fail_pieces(def->max_symbols, def, error);
        else if (d.piece->len > 0)
            net = take_network(&d);
        else
            g_set_error(error, LSYSTEM_ERROR, LSYSTEM_ERROR_EMPTY, "the L-system draws nothing in the leaf");
    }
    if (net && margin_veins)
        *margin_veins = d.n_margin;
    drawing_clear(&d);
    lstring_free(s);
    return net;
}
