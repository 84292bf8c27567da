// base/vec.h: double vectors, matrices and quaternions for the world, float ones for what is near.
// No units of their own. Matrices are row-major: m[row][column], and act on column vectors.
// Values; nothing owned.
#pragma once
#include <math.h>

typedef struct Vec3d {
    double x, y, z;
} Vec3d;

typedef struct Vec3f {
    float x, y, z;
} Vec3f;

typedef struct Mat3d {
    double m[3][3];
} Mat3d;

// Unit quaternion w + xi + yj + zk; rotates vectors as q v q*.
typedef struct Quatd {
    double w, x, y, z;
} Quatd;

static inline Vec3d vec3d(double x, double y, double z) {
    return (Vec3d){x, y, z};
}
static inline Vec3d vec3d_add(Vec3d a, Vec3d b) {
    return (Vec3d){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline Vec3d vec3d_sub(Vec3d a, Vec3d b) {
    return (Vec3d){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline Vec3d vec3d_scale(Vec3d a, double s) {
    return (Vec3d){a.x * s, a.y * s, a.z * s};
}
static inline Vec3d vec3d_mad(Vec3d a, Vec3d b, double s) { // a + b s
    return (Vec3d){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}
static inline double vec3d_dot(Vec3d a, Vec3d b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline Vec3d vec3d_cross(Vec3d a, Vec3d b) {
    return (Vec3d){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline double vec3d_length(Vec3d a) {
    return sqrt(vec3d_dot(a, a));
}
static inline double vec3d_distance(Vec3d a, Vec3d b) {
    return vec3d_length(vec3d_sub(a, b));
}
static inline Vec3d vec3d_normalize(Vec3d a) { // a zero vector stays zero
    double length = vec3d_length(a);
    return length > 0.0 ? vec3d_scale(a, 1.0 / length) : a;
}
static inline Vec3d mat3d_mul_vec(const Mat3d *m, Vec3d v) {
    return (Vec3d){m->m[0][0] * v.x + m->m[0][1] * v.y + m->m[0][2] * v.z,
                   m->m[1][0] * v.x + m->m[1][1] * v.y + m->m[1][2] * v.z,
                   m->m[2][0] * v.x + m->m[2][1] * v.y + m->m[2][2] * v.z};
}
static inline Vec3d mat3d_mul_vec_transposed(const Mat3d *m, Vec3d v) {
    return (Vec3d){m->m[0][0] * v.x + m->m[1][0] * v.y + m->m[2][0] * v.z,
                   m->m[0][1] * v.x + m->m[1][1] * v.y + m->m[2][1] * v.z,
                   m->m[0][2] * v.x + m->m[1][2] * v.y + m->m[2][2] * v.z};
}
static inline Mat3d mat3d_mul(const Mat3d *a, const Mat3d *b) {
    Mat3d out;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] + a->m[i][2] * b->m[2][j];
    return out;
}
static inline Quatd quatd_mul(Quatd a, Quatd b) {
    return (Quatd){a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                   a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
static inline Quatd quatd_normalize(Quatd q) {
    double scale = 1.0 / sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return (Quatd){q.w * scale, q.x * scale, q.y * scale, q.z * scale};
}
static inline Quatd quatd_conjugate(Quatd q) {
    return (Quatd){q.w, -q.x, -q.y, -q.z};
}
static inline Quatd quatd_from_axis_angle(Vec3d unit_axis, double angle_rad) {
    double s = sin(angle_rad * 0.5);
    return (Quatd){cos(angle_rad * 0.5), unit_axis.x * s, unit_axis.y * s, unit_axis.z * s};
}
static inline Vec3d quatd_rotate(Quatd q, Vec3d v) {
    Vec3d u = {q.x, q.y, q.z};
    Vec3d t = vec3d_scale(vec3d_cross(u, v), 2.0);
    return vec3d_add(vec3d_add(v, vec3d_scale(t, q.w)), vec3d_cross(u, t));
}
