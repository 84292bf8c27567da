#include "render/craft/craft_cast.h"

#include "render/craft/craft_shadow.h"
#include "terrain/geodesy.h"

#include <math.h>

#define MU_LEAST (-0.03)     // cosine of the sun's zenith angle: below, the land is lit by the sky alone
#define BETWEEN_SPHERES 1.15 // spheres a radius apart hold the tube that they are in
#define DESCENT_MOST 2.0     // of a ray towards a slope of 60 degrees, a metre
#define CLEAR_RADII 3.0      // so high above the ground in its middle, a sphere is clear of such a slope
#define EDGE_PX 2.0
#define AROUND 4
#define CORNERS 8

// Where along the ray from the sun the ground is within reach, and how high it is there.
typedef struct Stretch {
    bool found, on_globe;
    double from_m, to_m, low_m, high_m;
} Stretch;

typedef struct Caster {
    const CraftLand *land;
    Vec3d position, sun, right, top; // the map's axes
    Mat3d enu;
    double reach_m, eye_m, globe_m; // how far away the eye is; height of the globe above the ellipsoid
} Caster;

static double ground_m(const Caster *caster, Geodetic place, bool *on_globe) {
    double h_m;
    if (terrain_ground_m(caster->land->terrain, place.lat_rad / GEODESY_RAD_PER_DEG,
                         place.lon_rad / GEODESY_RAD_PER_DEG, &h_m) &&
        isfinite(h_m))
        return h_m;
    *on_globe = true;
    return caster->globe_m;
}

// Of the ground under a sphere.
static Stretch look_under(const Caster *caster, Vec3d at, double radius_m, double ground_here_m) {
    static const double ASIDE[AROUND][2] = {{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}};
    Stretch under = {.low_m = ground_here_m, .high_m = ground_here_m};
    for (int i = 0; i < AROUND; i++) {
        Vec3d aside = mat3d_mul_vec_transposed(&caster->enu, vec3d(ASIDE[i][0], ASIDE[i][1], 0.0));
        double h_m = ground_m(caster, geodesy_from_ecef(vec3d_mad(at, aside, radius_m)), &under.on_globe);
        under.low_m = fmin(under.low_m, h_m);
        under.high_m = fmax(under.high_m, h_m);
    }
    return under;
}

static void extend(Stretch *stretch, const Stretch *under, double along_m) {
    if (!stretch->found)
        *stretch = (Stretch){true, false, along_m, along_m, under->low_m, under->high_m};
    stretch->to_m = along_m;
    stretch->low_m = fmin(stretch->low_m, under->low_m);
    stretch->high_m = fmax(stretch->high_m, under->high_m);
    stretch->on_globe = stretch->on_globe || under->on_globe;
}

static double penumbra_m(double along_m) {
    return fmax(along_m, 0.0) * CRAFT_SUN_TANGENT;
}

// The ground that is drawn may be off by so much.
static double slack_m(const Caster *caster, double along_m) {
    return caster->land->coarse_rad * (caster->eye_m + along_m);
}

// From sphere to sphere down the ray, until all of one is underground: what is farther lies in the land's own shadow.
static Stretch find_stretch(const Caster *caster) {
    Stretch stretch = {0};
    double along_m = 0.0, last_m = caster->reach_m / CRAFT_SUN_TANGENT;
    while (along_m <= last_m) {
        Vec3d at = vec3d_mad(caster->position, caster->sun, -along_m);
        double radius_m = BETWEEN_SPHERES * (caster->reach_m + penumbra_m(along_m)) + slack_m(caster, along_m);
        Geodetic place = geodesy_from_ecef(at);
        bool on_globe = false;
        double here_m = ground_m(caster, place, &on_globe), clear_m = place.h_m - here_m - CLEAR_RADII * radius_m;
        if (clear_m < 0.0) {
            Stretch under = look_under(caster, at, radius_m, here_m);
            under.on_globe = under.on_globe || on_globe;
            if (place.h_m + radius_m < under.low_m)
                break;
            if (place.h_m - radius_m < under.high_m)
                extend(&stretch, &under, along_m);
        }
        along_m += fmax(clear_m / DESCENT_MOST, caster->reach_m);
    }
    return stretch;
}

// The ends of the map's corner rays, between the lowest and the highest ground.
static void find_corners(const Caster *caster, const Stretch *stretch, Vec3d corners[CORNERS]) {
    Vec3d up = mat3d_mul_vec_transposed(&caster->enu, vec3d(0.0, 0.0, 1.0));
    double mu = vec3d_dot(up, caster->sun), h_m = geodesy_from_ecef(caster->position).h_m;
    double slack = slack_m(caster, stretch->to_m), most_m = stretch->to_m + 2.0 * caster->reach_m + slack;
    double reach_m = caster->reach_m + penumbra_m(most_m), least_m = stretch->from_m - 2.0 * caster->reach_m - slack;
    for (int i = 0; i < CORNERS / 2; i++) {
        Vec3d corner = vec3d_mad(caster->position, caster->right, i & 1 ? reach_m : -reach_m);
        corner = vec3d_mad(corner, caster->top, i & 2 ? reach_m : -reach_m);
        double corner_m = h_m + vec3d_dot(up, vec3d_sub(corner, caster->position));
        double from_m = least_m, to_m = most_m;
        if (mu > 1e-3) {
            from_m = (corner_m - stretch->high_m - slack) / mu;
            to_m = (corner_m - stretch->low_m + slack) / mu;
        }
        corners[2 * i] = vec3d_mad(corner, caster->sun, -fmin(fmax(from_m, least_m), most_m));
        corners[2 * i + 1] = vec3d_mad(corner, caster->sun, -fmin(fmax(to_m, least_m), most_m));
    }
}

// ---- in the picture ----

typedef struct Clip {
    double x, y, w; // w: metres ahead
} Clip;

static Clip clip_of(const Frame *frame, Vec3d ecef) {
    const float(*m)[4] = frame->block.clip_from_eye; // columns
    Vec3d p = vec3d_sub(ecef, frame->eye_ecef);
    double out[4];
    for (int i = 0; i < 4; i++)
        out[i] = (double)m[0][i] * p.x + (double)m[1][i] * p.y + (double)m[2][i] * p.z;
    return (Clip){out[0], out[1], out[3]};
}

static void include(CraftBounds *bounds, Clip at) {
    bounds->left = fmin(bounds->left, at.x / at.w);
    bounds->right = fmax(bounds->right, at.x / at.w);
    bounds->bottom = fmin(bounds->bottom, at.y / at.w);
    bounds->top = fmax(bounds->top, at.y / at.w);
}

// Of the solid between the corners, ahead of the near plane: where the line between any two crosses it is a corner too.
static CraftBounds bounds_of(const Frame *frame, const Vec3d corners[CORNERS]) {
    CraftBounds bounds = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    Clip clips[CORNERS];
    for (int i = 0; i < CORNERS; i++) {
        clips[i] = clip_of(frame, corners[i]);
        if (clips[i].w >= FRAME_NEAR_M)
            include(&bounds, clips[i]);
    }
    for (int i = 0; i < CORNERS; i++)
        for (int j = 0; j < CORNERS; j++) {
            const Clip a = clips[i], b = clips[j];
            if (a.w >= FRAME_NEAR_M || b.w < FRAME_NEAR_M)
                continue;
            double share = (FRAME_NEAR_M - a.w) / (b.w - a.w);
            include(&bounds, (Clip){a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), FRAME_NEAR_M});
        }
    return bounds;
}

// Pixels from `low` to `high`, of `count`; false: none.
static bool pixels_of(double low, double high, int count, int *first, int *width) {
    double from = floor((0.5 + 0.5 * low) * count - EDGE_PX), to = ceil((0.5 + 0.5 * high) * count + EDGE_PX);
    if (!(from < count && to > 0.0 && from < to))
        return false;
    *first = (int)fmax(from, 0.0);
    *width = (int)fmin(to, count) - *first;
    return true;
}

static void find_sphere(const Frame *frame, const Vec3d corners[CORNERS], CraftCast *cast) {
    Vec3d sum = vec3d(0.0, 0.0, 0.0);
    for (int i = 0; i < CORNERS; i++)
        sum = vec3d_add(sum, corners[i]);
    cast->centre_ecef = vec3d_scale(sum, 1.0 / CORNERS);
    for (int i = 0; i < CORNERS; i++)
        cast->radius_m = fmax(cast->radius_m, vec3d_distance(corners[i], cast->centre_ecef));
    cast->eye_m = fmax(vec3d_distance(cast->centre_ecef, frame->eye_ecef) - cast->radius_m, FRAME_NEAR_M);
}

CraftCast craft_cast_find(const CraftLand *land, const Frame *frame, Vec3d position_ecef, double reach_m) {
    CraftCast cast = {0};
    Geodetic place = geodesy_from_ecef(position_ecef);
    Vec3d sun = {(double)frame->block.sun[0], (double)frame->block.sun[1], (double)frame->block.sun[2]};
    Caster caster = {.land = land, .position = position_ecef, .sun = sun, .reach_m = reach_m};
    caster.eye_m = vec3d_distance(position_ecef, frame->eye_ecef);
    // A metre up is somewhat more in round space.
    Vec3d up = geodesy_up(place.lat_rad, place.lon_rad);
    caster.globe_m = frame->globe_m / vec3d_length(frame_round(up));
    caster.enu = geodesy_enu_from_ecef(place.lat_rad, place.lon_rad);
    if (vec3d_dot(up, sun) < MU_LEAST)
        return cast;
    craft_shadow_axes(sun, &caster.right, &caster.top);
    Stretch stretch = find_stretch(&caster);
    if (!stretch.found)
        return cast;
    Vec3d corners[CORNERS];
    find_corners(&caster, &stretch, corners);
    cast.clip = bounds_of(frame, corners);
    cast.falls = pixels_of(cast.clip.left, cast.clip.right, land->view_width, &cast.x, &cast.width) &&
                 pixels_of(cast.clip.bottom, cast.clip.top, land->view_height, &cast.y, &cast.height);
    cast.on_globe = stretch.on_globe;
    cast.nearest_m = fmax(stretch.from_m - reach_m, 0.0);
    find_sphere(frame, corners, &cast);
    return cast;
}
