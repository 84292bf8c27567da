#include "render/craft/craft_parts.h"

#define PI 3.14159265358979323846

enum { STRUT_SIZE = 16, WHEEL_SIZE = 30, BLADE_SIZE = 16, BLADE_RINGS = 9, DISC_SIZE = 64 };

// A streamlined bar.
static void add_bar(CraftBuilder *builder, Vec3d from, Vec3d to, double chord_m, double thickness_m) {
    Vec3d along = vec3d_normalize(vec3d_sub(to, from));
    Vec3d aside = vec3d_normalize(vec3d_cross(along, vec3d(1.0, 0.0, 0.0)));
    Vec3d ahead = vec3d_cross(aside, along), rings[2 * STRUT_SIZE];
    for (int i = 0; i < STRUT_SIZE; i++) {
        double angle = 2.0 * PI * i / STRUT_SIZE;
        Vec3d out = vec3d_add(vec3d_scale(ahead, 0.5 * chord_m * cos(angle)),
                              vec3d_scale(aside, 0.5 * thickness_m * sin(angle)));
        rings[i] = vec3d_add(from, out);
        rings[STRUT_SIZE + i] = vec3d_add(to, out);
    }
    craft_builder_add_loft(builder, rings, 2, STRUT_SIZE);
    craft_builder_add_cap(builder, rings, STRUT_SIZE, false);
    craft_builder_add_cap(builder, rings + STRUT_SIZE, STRUT_SIZE, true);
}

void craft_add_strut(CraftBuilder *builder, const CraftStrut *strut, bool mirror) {
    const CraftPieceSpec spec = {CRAFT_FIXED, CRAFT_ON_REST, mirror, false};
    craft_builder_begin_piece(builder, &spec);
    craft_builder_set_finish(builder, strut->finish);
    add_bar(builder, strut->from, strut->to, strut->chord_m, strut->thickness_m);
    craft_builder_end_piece(builder);
}

static void place_circle(Vec3d axle, double y_m, double radius_m, Vec3d ring[WHEEL_SIZE]) {
    for (int i = 0; i < WHEEL_SIZE; i++) {
        double angle = 2.0 * PI * i / WHEEL_SIZE;
        ring[i] = vec3d(axle.x + radius_m * cos(angle), axle.y + y_m, axle.z + radius_m * sin(angle));
    }
}

// A disc of metal in a tyre, turned about the axle. Shares of half the width and of the radius.
static void add_wheel(CraftBuilder *builder, Vec3d axle, double radius_m, double width_m) {
    static const double tyre[][2] = {{-0.70, 0.50}, {-0.72, 0.56}, {-0.98, 0.70}, {-0.98, 0.82}, {-0.80, 0.93},
                                     {-0.45, 0.99}, {0.00, 1.00},  {0.45, 0.99},  {0.80, 0.93},  {0.98, 0.82},
                                     {0.98, 0.70},  {0.72, 0.56},  {0.70, 0.50}};
    enum { RINGS = COUNT_OF(tyre) };
    Vec3d rings[RINGS * WHEEL_SIZE];
    for (int i = 0; i < RINGS; i++)
        place_circle(axle, 0.5 * width_m * tyre[i][0], radius_m * tyre[i][1], rings + i * WHEEL_SIZE);
    craft_builder_set_finish(builder, CRAFT_RUBBER);
    craft_builder_add_loft(builder, rings, RINGS, WHEEL_SIZE);
    craft_builder_set_finish(builder, CRAFT_METAL);
    craft_builder_add_cap(builder, rings, WHEEL_SIZE, false);
    craft_builder_add_cap(builder, rings + (RINGS - 1) * WHEEL_SIZE, WHEEL_SIZE, true);
}

void craft_add_leg(CraftBuilder *builder, const CraftLeg *leg, CraftJoint joint, bool mirror) {
    const CraftPieceSpec spec = {joint, CRAFT_ON_REST, mirror, false};
    craft_builder_begin_piece(builder, &spec);
    craft_builder_set_finish(builder, CRAFT_METAL);
    add_bar(builder, leg->pivot, leg->axle, leg->leg_m, leg->leg_m);
    craft_builder_end_piece(builder);
    craft_builder_begin_piece(builder, &spec);
    add_wheel(builder, leg->axle, leg->wheel_radius_m, leg->wheel_width_m);
    craft_builder_end_piece(builder);
}

// --- propeller

// Broad inside, round at the tip: shares of the greatest chord.
static double blade_chord(double along) {
    return (0.55 + 0.95 * along - 0.5 * along * along) * sqrt(fmax(1.0 - pow(along, 8.0), 0.0));
}

static void place_section(const CraftPropeller *propeller, double turn, double along, Vec3d ring[BLADE_SIZE]) {
    double radius = 0.5 * propeller->diameter_m, r = radius * (0.06 + 0.94 * along);
    double pitch = atan2(propeller->pitch_m, 2.0 * PI * r), chord = propeller->chord_m * blade_chord(along);
    double thick = chord * (0.30 - 0.21 * along);
    Vec3d out = {0.0, sin(turn), -cos(turn)}, round = {0.0, cos(turn), sin(turn)}; // turning right, seen from behind
    Vec3d ahead = {1.0, 0.0, 0.0};
    Vec3d chordwise = vec3d_add(vec3d_scale(round, cos(pitch)), vec3d_scale(ahead, sin(pitch)));
    Vec3d across = vec3d_sub(vec3d_scale(ahead, cos(pitch)), vec3d_scale(round, sin(pitch)));
    for (int i = 0; i < BLADE_SIZE; i++) {
        double angle = 2.0 * PI * i / BLADE_SIZE;
        Vec3d at = vec3d_mad(propeller->hub, out, r);
        at = vec3d_mad(at, chordwise, 0.5 * chord * cos(angle));
        ring[i] = vec3d_mad(at, across, 0.5 * thick * sin(angle));
    }
}

static void add_blade(CraftBuilder *builder, const CraftPropeller *propeller, double turn) {
    const CraftPieceSpec spec = {.joint = CRAFT_PROPELLER_JOINT, .surface = CRAFT_ON_REST};
    Vec3d rings[BLADE_RINGS * BLADE_SIZE];
    for (int i = 0; i < BLADE_RINGS; i++) {
        double t = (double)i / (BLADE_RINGS - 1);
        place_section(propeller, turn, 1.0 - (1.0 - t) * (1.0 - t), rings + i * BLADE_SIZE);
    }
    craft_builder_begin_piece(builder, &spec);
    craft_builder_set_finish(builder, CRAFT_BLADE);
    craft_builder_add_loft(builder, rings, BLADE_RINGS, BLADE_SIZE);
    craft_builder_add_cap(builder, rings, BLADE_SIZE, false);
    craft_builder_end_piece(builder);
}

void craft_add_blades(CraftBuilder *builder, const CraftPropeller *propeller) {
    for (int i = 0; i < propeller->blades; i++)
        add_blade(builder, propeller, 2.0 * PI * i / propeller->blades);
}

void craft_add_disc(CraftBuilder *builder, const CraftPropeller *propeller) {
    const CraftPieceSpec spec = {.joint = CRAFT_PROPELLER_JOINT, .surface = CRAFT_ON_REST, .open = true};
    Vec3d rings[2 * DISC_SIZE];
    for (int i = 0; i < 2 * DISC_SIZE; i++) {
        double angle = 2.0 * PI * (i % DISC_SIZE) / DISC_SIZE;
        double radius = 0.5 * propeller->diameter_m * (i < DISC_SIZE ? 0.1 : 1.0);
        rings[i] = vec3d_add(propeller->hub, vec3d(0.0, radius * sin(angle), -radius * cos(angle)));
    }
    craft_builder_begin_piece(builder, &spec);
    craft_builder_set_finish(builder, CRAFT_DISC);
    craft_builder_add_loft(builder, rings, 2, DISC_SIZE);
    craft_builder_end_piece(builder);
}
