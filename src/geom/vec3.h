/* Points, directions and rotations in space. Leaf space: the flat blade lies in z = 0 with the base at the origin, x to the right, y from
 * the base to the tip; +z is the adaxial (sunny) side. */
#ifndef GEOM_VEC3_H
#define GEOM_VEC3_H

#include "geom/vec.h"

typedef struct {
    double x, y, z;
} Vec3;

/* A rotation as a matrix: columns are the images of the axes. */
typedef struct {
    Vec3 x, y, z;
} Mat3;

static inline Vec3 vec3(double x, double y, double z) { return (Vec3){x, y, z}; }
static inline Vec3 vec3_flat(Vec2 p) { return vec3(p.x, p.y, 0.0); }
static inline Vec3 vec3_add(Vec3 a, Vec3 b) { return vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline Vec3 vec3_sub(Vec3 a, Vec3 b) { return vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline Vec3 vec3_scale(Vec3 a, double k) { return vec3(a.x * k, a.y * k, a.z * k); }
static inline Vec3 vec3_lerp(Vec3 a, Vec3 b, double t) { return vec3_add(a, vec3_scale(vec3_sub(b, a), t)); }
static inline double vec3_dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline Vec3 vec3_cross(Vec3 a, Vec3 b) { return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
static inline double vec3_norm(Vec3 a) { return sqrt(vec3_dot(a, a)); }
static inline double vec3_dist(Vec3 a, Vec3 b) { return vec3_norm(vec3_sub(a, b)); }

/* Unit vector along a; `otherwise` when a has no direction. */
static inline Vec3 vec3_unit(Vec3 a, Vec3 otherwise)
{
    double n = vec3_norm(a);
    return n > 0.0 ? vec3_scale(a, 1.0 / n) : otherwise;
}

static inline Mat3 mat3_identity(void) { return (Mat3){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; }

static inline Vec3 mat3_apply(Mat3 m, Vec3 a)
{
    return vec3(m.x.x * a.x + m.y.x * a.y + m.z.x * a.z, m.x.y * a.x + m.y.y * a.y + m.z.y * a.z,
                m.x.z * a.x + m.y.z * a.y + m.z.z * a.z);
}

static inline Mat3 mat3_mul(Mat3 a, Mat3 b) { return (Mat3){mat3_apply(a, b.x), mat3_apply(a, b.y), mat3_apply(a, b.z)}; }
static inline Mat3 mat3_transpose(Mat3 m)
{
    return (Mat3){{m.x.x, m.y.x, m.z.x}, {m.x.y, m.y.y, m.z.y}, {m.x.z, m.y.z, m.z.z}};
}

#endif
