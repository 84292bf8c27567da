#include "render/craft/craft_cast.h"

#include "terrain/geodesy.h"

#include <math.h>
#include <stdlib.h>

#define MU_LEAST (-0.03)     // cosine of the sun's zenith angle: below, the land is lit by the sky alone
#define BETWEEN_SPHERES 1.15 // spheres a radius apart hold the tube that they are in
#define DESCENT_MOST 2.0     // of a ray towards a slope of 60 degrees, a metre
#define CLEAR_RADII 3.0      // so high above the ground in its middle, a sphere is clear of such a slope
#define EDGE_PX 2.0
#define SPREADS 2.0    // radii of the sun's disc: the mipmaps' texels are wide
#define STEPS_MOST 8.0 // of a part's spheres along what the aircraft's met
#define AROUND 4
#define CORNERS 8
#define POINTS (2 * CORNERS)
#define UNEVEN 0.1    // of the reach: the ground between the places that are looked at
#define FLATTEST 0.02 // cosine of the sun's angle off the ground's normal: below, all that is in reach is taken

// Where along the ray from the sun the ground is within reach, and a slab that it lies in there.
typedef struct Stretch {
    bool found, on_globe;
    double from_m, to_m;
    double nearest_m;     // of the sphere's middle to the ground that is nearest to one
    Vec3d normal;         // of the ground there, unit
    double low_m, high_m; // along it, from the aircraft
} Stretch;

// The ground around a place under a sphere: in the middle, to the east, north, west, south.
typedef struct Under {
    Vec3d at[AROUND + 1];
    double low_m, high_m; // above the ellipsoid
    bool on_globe;
} Under;

typedef struct Caster {
    const CraftLand *land;
    Vec3d position, sun;
    Mat3d enu;
    double reach_m, gone_m, eye_m, globe_m; // how far away the eye is; height of the globe above the ellipsoid
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

static Under look_under(const Caster *caster, Vec3d at, double radius_m) {
    static const double ASIDE[AROUND + 1][2] = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}};
    Under under = {.low_m = INFINITY, .high_m = -INFINITY};
    Vec3d up = mat3d_mul_vec_transposed(&caster->enu, vec3d(0.0, 0.0, 1.0));
    for (int i = 0; i <= AROUND; i++) {
        Vec3d aside = mat3d_mul_vec_transposed(&caster->enu, vec3d(ASIDE[i][0], ASIDE[i][1], 0.0));
        Vec3d over = vec3d_mad(at, aside, radius_m);
        Geodetic place = geodesy_from_ecef(over);
        double h_m = ground_m(caster, place, &under.on_globe);
        under.low_m = fmin(under.low_m, h_m);
        under.high_m = fmax(under.high_m, h_m);
        under.at[i] = vec3d_sub(vec3d_mad(over, up, h_m - place.h_m), caster->position);
    }
    return under;
}

static void extend(Stretch *stretch, const Under *under, double along_m, double away_m) {
    if (!stretch->found)
        *stretch = (Stretch){.found = true, .from_m = along_m, .nearest_m = INFINITY};
    stretch->to_m = along_m;
    stretch->on_globe = stretch->on_globe || under->on_globe;
    if (away_m >= stretch->nearest_m)
        return;
    stretch->nearest_m = away_m;
    stretch->normal =
        vec3d_normalize(vec3d_cross(vec3d_sub(under->at[1], under->at[3]), vec3d_sub(under->at[2], under->at[4])));
}

static double penumbra_m(double along_m) {
    return fmax(along_m, 0.0) * CRAFT_SUN_TANGENT;
}

// The ground that is drawn may be off by so much.
static double slack_m(const Caster *caster, double along_m) {
    return caster->land->coarse_m + caster->land->coarse_rad * (caster->eye_m + along_m);
}

static double radius_m(const Caster *caster, double along_m) {
    return BETWEEN_SPHERES * (caster->reach_m + penumbra_m(along_m)) + slack_m(caster, along_m);
}

static Vec3d along_ray(const Caster *caster, double along_m) {
    return vec3d_mad(caster->position, caster->sun, -along_m);
}

// From sphere to sphere down the ray, until all of one is underground: what is farther lies in the land's own shadow.
static Stretch find_stretch(const Caster *caster) {
    Stretch stretch = {0};
    double along_m = 0.0;
    while (along_m <= caster->gone_m) {
        Vec3d at = along_ray(caster, along_m);
        double sphere_m = radius_m(caster, along_m);
        Geodetic place = geodesy_from_ecef(at);
        bool on_globe = false;
        double above_m = place.h_m - ground_m(caster, place, &on_globe), clear_m = above_m - CLEAR_RADII * sphere_m;
        if (clear_m < 0.0) {
            Under under = look_under(caster, at, sphere_m);
            if (place.h_m + sphere_m < under.low_m)
                break;
            if (place.h_m - sphere_m < under.high_m)
                extend(&stretch, &under, along_m, fabs(above_m));
        }
        along_m += fmax(clear_m / DESCENT_MOST, caster->reach_m);
    }
    return stretch;
}

// Between which planes across the normal the ground lies.
static void measure_slab(const Caster *caster, Stretch *stretch) {
    stretch->low_m = INFINITY;
    stretch->high_m = -INFINITY;
    for (double along_m = stretch->from_m; along_m <= stretch->to_m; along_m += caster->reach_m) {
        Under under = look_under(caster, along_ray(caster, along_m), radius_m(caster, along_m));
        for (int i = 0; i <= AROUND; i++) {
            double h_m = vec3d_dot(under.at[i], stretch->normal);
            stretch->low_m = fmin(stretch->low_m, h_m);
            stretch->high_m = fmax(stretch->high_m, h_m);
        }
    }
    double more_m = slack_m(caster, stretch->to_m) + UNEVEN * caster->reach_m;
    stretch->low_m -= more_m;
    stretch->high_m += more_m;
}

// The corners of the box, wider by the penumbra, thrown along the sun's rays to both sides of the slab.
static void find_points(const Caster *caster, const Stretch *stretch, const CraftBox *box, Vec3d points[POINTS]) {
    double more_m = 2.0 * caster->reach_m + slack_m(caster, stretch->to_m);
    double least_m = stretch->from_m - more_m, most_m = stretch->to_m + more_m, wider_m = SPREADS * penumbra_m(most_m);
    double facing = vec3d_dot(stretch->normal, caster->sun);
    for (int i = 0; i < CORNERS; i++) {
        Vec3d corner = {i & 1 ? box->high.x + wider_m : box->low.x - wider_m,
                        i & 2 ? box->high.y + wider_m : box->low.y - wider_m,
                        i & 4 ? box->high.z + wider_m : box->low.z - wider_m};
        corner = quatd_rotate(box->ecef_from_body, corner);
        double from_m = least_m, to_m = most_m, h_m = vec3d_dot(corner, stretch->normal);
        if (facing > FLATTEST) {
            from_m = fmin(fmax((h_m - stretch->high_m) / facing, least_m), most_m);
            to_m = fmin(fmax((h_m - stretch->low_m) / facing, least_m), most_m);
        }
        corner = vec3d_add(caster->position, corner);
        points[2 * i] = vec3d_mad(corner, caster->sun, -from_m);
        points[2 * i + 1] = vec3d_mad(corner, caster->sun, -to_m);
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

// Of the solid between the points, ahead of the near plane: where the line between any two crosses it is a point too.
static CraftBounds bounds_of(const Frame *frame, const Vec3d points[POINTS]) {
    CraftBounds bounds = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    Clip clips[POINTS];
    for (int i = 0; i < POINTS; i++) {
        clips[i] = clip_of(frame, points[i]);
        if (clips[i].w >= FRAME_NEAR_M)
            include(&bounds, clips[i]);
    }
    for (int i = 0; i < POINTS; i++)
        for (int j = 0; j < POINTS; j++) {
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

static void find_sphere(const Frame *frame, const Vec3d points[POINTS], CraftCast *cast) {
    Vec3d sum = vec3d(0.0, 0.0, 0.0);
    for (int i = 0; i < POINTS; i++)
        sum = vec3d_add(sum, points[i]);
    cast->centre_ecef = vec3d_scale(sum, 1.0 / POINTS);
    for (int i = 0; i < POINTS; i++)
        cast->radius_m = fmax(cast->radius_m, vec3d_distance(points[i], cast->centre_ecef));
    cast->eye_m = fmax(vec3d_distance(cast->centre_ecef, frame->eye_ecef) - cast->radius_m, FRAME_NEAR_M);
}

static Caster caster_of(const CraftLand *land, const Frame *frame, const CraftBox *box, double reach_m) {
    Geodetic place = geodesy_from_ecef(box->position_ecef);
    Vec3d up = geodesy_up(place.lat_rad, place.lon_rad);
    return (Caster){.land = land,
                    .position = box->position_ecef,
                    .sun = {(double)frame->block.sun[0], (double)frame->block.sun[1], (double)frame->block.sun[2]},
                    .enu = geodesy_enu_from_ecef(place.lat_rad, place.lon_rad),
                    .reach_m = reach_m,
                    .gone_m = box->gone_m,
                    .eye_m = vec3d_distance(box->position_ecef, frame->eye_ecef),
                    // A metre up is somewhat more in round space.
                    .globe_m = frame->globe_m / vec3d_length(frame_round(up))};
}

// False: no ground is met.
static bool throw_box(const Caster *caster, const CraftBox *box, Stretch *stretch, Vec3d points[POINTS]) {
    *stretch = find_stretch(caster);
    if (!stretch->found)
        return false;
    measure_slab(caster, stretch);
    find_points(caster, stretch, box, points);
    return true;
}

static bool find_pixels(const CraftLand *land, const CraftBounds *clip, CraftPixels *pixels) {
    return pixels_of(clip->left, clip->right, land->view_width, &pixels->x, &pixels->width) &&
           pixels_of(clip->bottom, clip->top, land->view_height, &pixels->y, &pixels->height);
}

CraftCast craft_cast_find(const CraftLand *land, const Frame *frame, const CraftBox *box, double reach_m) {
    CraftCast cast = {0};
    const Caster caster = caster_of(land, frame, box, reach_m);
    Vec3d up = mat3d_mul_vec_transposed(&caster.enu, vec3d(0.0, 0.0, 1.0)), points[POINTS];
    Stretch stretch;
    if (vec3d_dot(up, caster.sun) < MU_LEAST || !throw_box(&caster, box, &stretch, points))
        return cast;
    cast.clip = bounds_of(frame, points);
    cast.falls = find_pixels(land, &cast.clip, &cast.pixels);
    cast.on_globe = stretch.on_globe;
    cast.nearest_m = fmax(stretch.from_m - reach_m, 0.0);
    cast.long_m = stretch.to_m - stretch.from_m;
    find_sphere(frame, points, &cast);
    return cast;
}

// ---- part by part ----

static int order(const void *a, const void *b) {
    return *(const int *)a - *(const int *)b;
}

static bool is_covered(const CraftPixels *parts, int count, int x, int y) {
    for (int i = 0; i < count; i++)
        if (x >= parts[i].x && x < parts[i].x + parts[i].width && y >= parts[i].y && y < parts[i].y + parts[i].height)
            return true;
    return false;
}

// On top of one as wide, it makes that higher.
static void add_beside(CraftCast *cast, CraftPixels run) {
    for (int i = 0; i < cast->beside_count; i++) {
        CraftPixels *below = &cast->beside[i];
        if (below->x == run.x && below->width == run.width && below->y + below->height == run.y) {
            below->height += run.height;
            return;
        }
    }
    cast->beside[cast->beside_count++] = run;
}

// Of a band from edge to edge.
static void add_band(const CraftPixels *parts, int count, const int *xs, CraftPixels band, CraftCast *cast) {
    int begin = xs[0], last = 2 * count - 1;
    for (int i = 0; i < last; i++) {
        if (xs[i] == xs[i + 1] || !is_covered(parts, count, xs[i], band.y))
            continue;
        if (begin < xs[i])
            add_beside(cast, (CraftPixels){begin, band.y, xs[i] - begin, band.height});
        begin = xs[i + 1];
    }
    if (begin < xs[last])
        add_beside(cast, (CraftPixels){begin, band.y, xs[last] - begin, band.height});
}

static void find_beside(const CraftPixels *parts, int count, CraftCast *cast) {
    int xs[2 * CRAFT_CAST_PARTS], ys[2 * CRAFT_CAST_PARTS], last = 2 * count - 1;
    for (int i = 0; i < count; i++) {
        xs[2 * i] = parts[i].x;
        xs[2 * i + 1] = parts[i].x + parts[i].width;
        ys[2 * i] = parts[i].y;
        ys[2 * i + 1] = parts[i].y + parts[i].height;
    }
    qsort(xs, 2 * (size_t)count, sizeof xs[0], order);
    qsort(ys, 2 * (size_t)count, sizeof ys[0], order);
    cast->pixels = (CraftPixels){xs[0], ys[0], xs[last] - xs[0], ys[last] - ys[0]};
    for (int i = 0; i < last; i++) {
        const CraftPixels band = {xs[0], ys[i], cast->pixels.width, ys[i + 1] - ys[i]};
        if (band.height > 0)
            add_band(parts, count, xs, band, cast);
    }
}

void craft_cast_narrow(const CraftLand *land, const Frame *frame, const CraftBox *boxes, int count, CraftCast *cast) {
    CraftPixels parts[CRAFT_CAST_PARTS];
    int found = 0;
    for (int i = 0; i < count; i++) {
        double reach_m = 0.5 * vec3d_distance(boxes[i].low, boxes[i].high);
        const Caster caster = caster_of(land, frame, &boxes[i], fmax(reach_m, cast->long_m / STEPS_MOST));
        Vec3d points[POINTS];
        Stretch stretch;
        if (!throw_box(&caster, &boxes[i], &stretch, points))
            continue;
        CraftBounds clip = bounds_of(frame, points);
        found += find_pixels(land, &clip, &parts[found]);
    }
    cast->falls = found > 0;
    if (cast->falls)
        find_beside(parts, found, cast);
}
