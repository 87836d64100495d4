/* Points and boxes in the plane. Everything in Venation is measured in vein segments unless said
 * otherwise; x to the right, y from the leaf base to its tip. */
#ifndef GEOM_VEC_H
#define GEOM_VEC_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct {
    double x, y;
} Vec2;

typedef struct {
    double x0, y0, x1, y1;
} Box2;

static inline Vec2 vec2(double x, double y) { return (Vec2){x, y}; }
static inline Vec2 vec_add(Vec2 a, Vec2 b) { return vec2(a.x + b.x, a.y + b.y); }
static inline Vec2 vec_sub(Vec2 a, Vec2 b) { return vec2(a.x - b.x, a.y - b.y); }
static inline Vec2 vec_scale(Vec2 a, double k) { return vec2(a.x * k, a.y * k); }
static inline Vec2 vec_lerp(Vec2 a, Vec2 b, double t) { return vec2(a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t); }
static inline double vec_dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
static inline double vec_cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
static inline double vec_norm2(Vec2 a) { return a.x * a.x + a.y * a.y; }
static inline double vec_dist2(Vec2 a, Vec2 b) { return vec_norm2(vec_sub(a, b)); }
static inline double vec_dist(Vec2 a, Vec2 b) { return sqrt(vec_dist2(a, b)); }

static inline Box2 box_empty(void) { return (Box2){HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL}; }
static inline bool box_is_empty(Box2 b) { return !(b.x0 <= b.x1 && b.y0 <= b.y1); }

static inline Box2 box_add(Box2 b, Vec2 p)
{
    return (Box2){p.x < b.x0 ? p.x : b.x0, p.y < b.y0 ? p.y : b.y0, p.x > b.x1 ? p.x : b.x1, p.y > b.y1 ? p.y : b.y1};
}

static inline Box2 box_union(Box2 a, Box2 b)
{
    return (Box2){a.x0 < b.x0 ? a.x0 : b.x0, a.y0 < b.y0 ? a.y0 : b.y0, a.x1 > b.x1 ? a.x1 : b.x1, a.y1 > b.y1 ? a.y1 : b.y1};
}

static inline Box2 box_grow(Box2 b, double by) { return (Box2){b.x0 - by, b.y0 - by, b.x1 + by, b.y1 + by}; }
static inline bool box_has(Box2 b, Vec2 p) { return p.x >= b.x0 && p.x <= b.x1 && p.y >= b.y0 && p.y <= b.y1; }

/* Squared distance from p to the box; 0 inside. */
static inline double box_dist2(Box2 b, Vec2 p)
{
    double dx = p.x < b.x0 ? b.x0 - p.x : p.x > b.x1 ? p.x - b.x1 : 0.0;
    double dy = p.y < b.y0 ? b.y0 - p.y : p.y > b.y1 ? p.y - b.y1 : 0.0;
    return dx * dx + dy * dy;
}

#endif
