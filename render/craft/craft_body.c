#include "render/craft/craft_parts.h"

#define PI 3.14159265358979323846

enum {
    RING_SIZE = 40,
    STEPS = 4, // between sections
    RINGS_MAX = (CRAFT_SECTIONS_MAX - 1) * STEPS + 1,
    VALUES = 5,
};
#define RIM 0.92    // of an opening, against its outside
#define TUNNEL 0.86 // its inner end

// What is interpolated of a section. Squares of the radii, so that a body may begin round.
typedef struct Values {
    double of[VALUES]; // middle's z, exponent, squares of half width, up, down
} Values;

static Values values_of(const CraftSection *section) {
    return (Values){{section->z_m, section->square, section->half_width_m * section->half_width_m,
                     section->up_m * section->up_m, section->down_m * section->down_m}};
}

static double slope_between(const CraftBody *body, int i, int value) {
    const CraftSection *a = &body->sections[i], *b = a + 1;
    return (values_of(b).of[value] - values_of(a).of[value]) / (b->x_m - a->x_m);
}

// F. N. Fritsch and J. Butland, "A method for constructing local monotone piecewise cubic interpolants", 1984: the
// harmonic mean of the slopes on both sides, none at an extremum.
static double slope_at(const CraftBody *body, int i, int value) {
    if (i == 0 || i == body->section_count - 1)
        return slope_between(body, i == 0 ? 0 : i - 1, value);
    double before = slope_between(body, i - 1, value), after = slope_between(body, i, value);
    if (before * after <= 0.0)
        return 0.0;
    double wide = body->sections[i].x_m - body->sections[i - 1].x_m;
    double next = body->sections[i + 1].x_m - body->sections[i].x_m;
    double share = (wide + 2.0 * next) / (3.0 * (wide + next));
    return before * after / (share * after + (1.0 - share) * before);
}

static double interpolate(const CraftBody *body, int i, int value, double t) {
    double width = body->sections[i + 1].x_m - body->sections[i].x_m;
    double a = values_of(&body->sections[i]).of[value], b = values_of(&body->sections[i + 1]).of[value];
    double t2 = t * t, t3 = t2 * t;
    return a * (2.0 * t3 - 3.0 * t2 + 1.0) + b * (3.0 * t2 - 2.0 * t3) +
           width * (slope_at(body, i, value) * (t3 - 2.0 * t2 + t) + slope_at(body, i + 1, value) * (t3 - t2));
}

static CraftSection section_between(const CraftBody *body, int i, double t) {
    double x = body->sections[i].x_m + (body->sections[i + 1].x_m - body->sections[i].x_m) * t;
    double values[VALUES];
    for (int value = 0; value < VALUES; value++)
        values[value] = interpolate(body, i, value, t);
    return (CraftSection){
        x, values[0], sqrt(fmax(values[2], 0.0)), sqrt(fmax(values[3], 0.0)), sqrt(fmax(values[4], 0.0)), values[1]};
}

// Dense where the body begins or ends round.
static double spread(const CraftBody *body, int i, double t) {
    if (i == 0 && body->sections[0].half_width_m == 0.0)
        return t * t;
    if (i == body->section_count - 2 && body->sections[i + 1].half_width_m == 0.0)
        return 1.0 - (1.0 - t) * (1.0 - t);
    return t;
}

static double power_of(double value, double square) {
    return value > 0.0 ? pow(value, 2.0 / square) : 0.0;
}

// From the top to the right; the left is the right's mirror image, bit for bit about the body's own middle.
static void place_ring(const CraftSection *section, double y_m, double scale, Vec3d ring[RING_SIZE]) {
    for (int i = 0; i <= RING_SIZE / 2; i++) {
        double angle = 2.0 * PI * i / RING_SIZE, side = i % (RING_SIZE / 2) == 0 ? 0.0 : sin(angle), up = cos(angle);
        double y = section->half_width_m * power_of(side, section->square) * scale;
        double height = up >= 0.0 ? section->up_m : section->down_m;
        double z = height * power_of(fabs(up), section->square) * scale;
        z = section->z_m + (up >= 0.0 ? -z : z);
        ring[i] = vec3d(section->x_m, y_m + y, z);
        ring[(RING_SIZE - i) % RING_SIZE] = vec3d(section->x_m, y_m - y, z);
    }
}

static int place_rings(const CraftBody *body, Vec3d *rings) {
    int count = 0;
    for (int i = 0; i + 1 < body->section_count; i++) {
        for (int step = 0; step < STEPS; step++) {
            CraftSection section = section_between(body, i, spread(body, i, (double)step / STEPS));
            place_ring(&section, body->y_m, 1.0, rings + RING_SIZE * count++);
        }
    }
    place_ring(&body->sections[body->section_count - 1], body->y_m, 1.0, rings + RING_SIZE * count++);
    return count;
}

// An end that is not round: flat, or an opening with a dark inside, `depth_m` deep.
static void close_end(CraftBuilder *builder, const CraftBody *body, bool last, double depth_m) {
    CraftSection section = body->sections[last ? body->section_count - 1 : 0], inner = section;
    Vec3d rings[3 * RING_SIZE];
    if (section.half_width_m == 0.0)
        return;
    place_ring(&section, body->y_m, 1.0, rings);
    if (depth_m == 0.0) {
        craft_builder_add_cap(builder, rings, RING_SIZE, last);
        return;
    }
    inner.x_m += last ? depth_m : -depth_m;
    place_ring(&section, body->y_m, RIM, rings + RING_SIZE);
    place_ring(&inner, body->y_m, TUNNEL, rings + 2 * RING_SIZE);
    Vec3d turned[3 * RING_SIZE]; // from the inside out
    for (int i = 0; i < 3 * RING_SIZE; i++)
        turned[i] = rings[last ? i : (2 - i / RING_SIZE) * RING_SIZE + i % RING_SIZE];
    int rim = last ? 0 : RING_SIZE, inside = last ? RING_SIZE : 0;
    craft_builder_add_loft(builder, turned + rim, 2, RING_SIZE);
    craft_builder_set_finish(builder, CRAFT_DARK);
    craft_builder_add_loft(builder, turned + inside, 2, RING_SIZE);
    craft_builder_add_cap(builder, rings + 2 * RING_SIZE, RING_SIZE, last);
    craft_builder_set_finish(builder, body->finish);
}

void craft_add_body(CraftBuilder *builder, const CraftBody *body, bool mirror) {
    Vec3d rings[RINGS_MAX * RING_SIZE];
    int count = place_rings(body, rings);
    const CraftPieceSpec spec = {body->turns ? CRAFT_PROPELLER_JOINT : CRAFT_FIXED, body->surface, mirror, false};
    craft_builder_begin_piece(builder, &spec);
    craft_builder_set_finish(builder, body->finish);
    craft_builder_add_loft(builder, rings, count, RING_SIZE);
    close_end(builder, body, false, body->front_tunnel_m);
    close_end(builder, body, true, body->rear_tunnel_m);
    craft_builder_end_piece(builder);
}
