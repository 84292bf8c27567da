#include "render/craft/craft_parts.h"

#include <string.h>

#define PI 3.14159265358979323846

enum {
    FRONT_STEPS = 12, // along the chord, nose to lip
    REAR_STEPS = 5,   // lip or hinge to trailing edge
    ARC_POINTS = 7,   // of a control's nose, or the cove around it
    TIP_RINGS = 6,
    FULL_SIZE = 2 * (FRONT_STEPS + REAR_STEPS),
    FRONT_SIZE = 2 * FRONT_STEPS + 1 + ARC_POINTS,
    REAR_SIZE = 2 * REAR_STEPS + 1 + ARC_POINTS,
    RINGS_MAX = CRAFT_STATIONS_MAX + TIP_RINGS + 2,
    SIZE_MAX_RING = FULL_SIZE > FRONT_SIZE ? FULL_SIZE : FRONT_SIZE,
};
#define WHOLE_SPLIT 0.7 // where no control asks for another

// Shares of the chord: x backwards from the leading edge, z up.
typedef struct Point {
    double x, z;
} Point;

typedef enum Profile {
    PROFILE_WHOLE,
    PROFILE_FRONT, // up to a control, hollow behind
    PROFILE_REAR,  // the control
} Profile;

typedef struct Half {
    const CraftWing *wing;
    CraftSurface surface;
    bool mirror, upright; // upright: a fin
} Half;

// Half the thickness of NACA's four-digit sections, with a closed trailing edge (Abbott and von Doenhoff, Theory of
// Wing Sections, section 6.4; the last coefficient is -0.1036 instead of -0.1015).
static double half_thickness(double x, double thickness) {
    return 5.0 * thickness * (0.2969 * sqrt(x) + x * (-0.1260 + x * (-0.3516 + x * (0.2843 - x * 0.1036))));
}

static double mean_line(const CraftWing *wing, double x) {
    double m = wing->camber, p = wing->camber_at;
    if (m == 0.0)
        return 0.0;
    return x < p ? m / (p * p) * (2.0 * p * x - x * x)
                 : m / ((1.0 - p) * (1.0 - p)) * (1.0 - 2.0 * p + 2.0 * p * x - x * x);
}

static Point skin(const CraftWing *wing, double thickness, double x, double side) {
    double half = x < 1.0 ? half_thickness(x, thickness) : 0.0;
    return (Point){x, mean_line(wing, x) + side * half};
}

static double lip_of(const CraftWing *wing) {
    return wing->hinge > 0.0 ? wing->hinge : WHOLE_SPLIT;
}

// Dense at the nose, where the section is most curved.
static double front_x(const CraftWing *wing, int step) {
    return lip_of(wing) * (1.0 - cos(0.5 * PI * step / FRONT_STEPS));
}

static double whole_x(const CraftWing *wing, int step) {
    double lip = lip_of(wing);
    return step <= FRONT_STEPS ? front_x(wing, step) : lip + (1.0 - lip) * (step - FRONT_STEPS) / REAR_STEPS;
}

static void fill_whole(const CraftWing *wing, double thickness, Point *out) {
    const int steps = FRONT_STEPS + REAR_STEPS;
    for (int i = 0; i < steps; i++) {
        out[i] = skin(wing, thickness, whole_x(wing, steps - i), 1.0);
        out[steps + i] = skin(wing, thickness, whole_x(wing, i), -1.0);
    }
}

// From one angle to another about the hinge, without the ends; the radius goes from that of `from` to that of `to`.
static void fill_arc(Point centre, Point from, Point to, Point *out) {
    double begin = atan2(from.z - centre.z, from.x - centre.x), end = atan2(to.z - centre.z, to.x - centre.x);
    begin = begin < 0.0 ? begin + 2.0 * PI : begin; // through the front, at pi
    end = end < 0.0 ? end + 2.0 * PI : end;
    double radius = hypot(from.x - centre.x, from.z - centre.z);
    double change = hypot(to.x - centre.x, to.z - centre.z) - radius;
    for (int i = 0; i < ARC_POINTS; i++) {
        double along = (i + 1.0) / (ARC_POINTS + 1.0), angle = begin + (end - begin) * along;
        double at = radius + change * along;
        out[i] = (Point){centre.x + at * cos(angle), centre.z + at * sin(angle)};
    }
}

static Point hinge_point(const CraftWing *wing) {
    return (Point){wing->hinge, mean_line(wing, wing->hinge)};
}

static void fill_front(const CraftWing *wing, double thickness, Point *out) {
    for (int i = 0; i <= FRONT_STEPS; i++) {
        out[i] = skin(wing, thickness, front_x(wing, FRONT_STEPS - i), 1.0);
        out[FRONT_STEPS + i] = skin(wing, thickness, front_x(wing, i), -1.0);
    }
    fill_arc(hinge_point(wing), out[2 * FRONT_STEPS], out[0], out + 2 * FRONT_STEPS + 1);
}

static void fill_rear(const CraftWing *wing, double thickness, Point *out) {
    double hinge = wing->hinge;
    Point *lower = out + REAR_STEPS + 1 + ARC_POINTS;
    for (int i = 0; i <= REAR_STEPS; i++)
        out[i] = skin(wing, thickness, 1.0 - (1.0 - hinge) * i / REAR_STEPS, 1.0);
    for (int i = 0; i < REAR_STEPS; i++)
        lower[i] = skin(wing, thickness, hinge + (1.0 - hinge) * i / REAR_STEPS, -1.0);
    fill_arc(hinge_point(wing), out[REAR_STEPS], lower[0], out + REAR_STEPS + 1);
}

static int fill_profile(const CraftWing *wing, Profile profile, double thickness, Point *out) {
    if (profile == PROFILE_WHOLE)
        fill_whole(wing, thickness, out);
    else if (profile == PROFILE_FRONT)
        fill_front(wing, thickness, out);
    else
        fill_rear(wing, thickness, out);
    return profile == PROFILE_WHOLE ? FULL_SIZE : profile == PROFILE_FRONT ? FRONT_SIZE : REAR_SIZE;
}

static double mix(double a, double b, double along) {
    return a + (b - a) * along;
}

static CraftStation station_between(const CraftStation *a, const CraftStation *b, double along) {
    return (CraftStation){mix(a->across_m, b->across_m, along),
                          mix(a->x_m, b->x_m, along),
                          mix(a->z_m, b->z_m, along),
                          mix(a->chord_m, b->chord_m, along),
                          mix(a->thickness, b->thickness, along),
                          mix(a->twist_rad, b->twist_rad, along)};
}

static CraftStation station_at(const CraftWing *wing, double across_m) {
    int i = 0;
    while (i + 2 < wing->station_count && wing->stations[i + 1].across_m < across_m)
        i++;
    const CraftStation *a = &wing->stations[i], *b = &wing->stations[i + 1];
    double along = (across_m - a->across_m) / (b->across_m - a->across_m);
    return along == 1.0 ? *b : station_between(a, b, along);
}

static Vec3d place(const Half *half, const CraftStation *station, Point point) {
    double ahead = 0.25 - point.x, c = cos(station->twist_rad), s = sin(station->twist_rad);
    double x = station->x_m - 0.25 * station->chord_m + station->chord_m * (ahead * c - point.z * s);
    double rise = station->chord_m * (ahead * s + point.z * c);
    return half->upright ? vec3d(x, rise, -station->across_m) : vec3d(x, station->across_m, station->z_m - rise);
}

static int place_ring(const Half *half, const CraftStation *station, Profile profile, Vec3d *ring) {
    Point points[SIZE_MAX_RING];
    int size = fill_profile(half->wing, profile, station->thickness, points);
    for (int i = 0; i < size; i++)
        ring[i] = place(half, station, points[i]);
    return size;
}

static CraftPieceSpec spec_of(const Half *half, CraftJoint joint) {
    return (CraftPieceSpec){.joint = joint, .surface = half->surface, .mirror = half->mirror};
}

// Sections at both ends and at the stations between.
static int list_sections(const CraftWing *wing, double from_m, double to_m, CraftStation *sections) {
    int count = 0;
    sections[count++] = station_at(wing, from_m);
    for (int i = 0; i < wing->station_count; i++)
        if (wing->stations[i].across_m > from_m && wing->stations[i].across_m < to_m)
            sections[count++] = wing->stations[i];
    sections[count++] = station_at(wing, to_m);
    return count;
}

// The last section swung round to an edge: an ellipse seen from ahead and, at its corners, from above.
static int list_tip(const CraftWing *wing, CraftStation *sections) {
    const CraftStation *last = &wing->stations[wing->station_count - 1], *before = last - 1;
    double width = last->across_m - before->across_m;
    double x_slope = (last->x_m - before->x_m) / width, z_slope = (last->z_m - before->z_m) / width;
    for (int i = 0; i < TIP_RINGS; i++) {
        double angle = 0.5 * PI * (i + 1) / TIP_RINGS, out_m = wing->tip_m * sin(angle);
        double shrink = fmin(0.9 * wing->tip_m, 0.35 * last->chord_m) * (1.0 - cos(angle));
        sections[i] = *last;
        sections[i].across_m += out_m;
        sections[i].x_m += x_slope * out_m - shrink;
        sections[i].z_m += z_slope * out_m;
        sections[i].chord_m -= 1.5 * shrink;
        sections[i].thickness *= i + 1 < TIP_RINGS ? cos(angle) * last->chord_m / sections[i].chord_m : 0.0;
    }
    return TIP_RINGS;
}

// What is seen of a control's nose and of the cove around it is dark: it is a gap, which no sun reaches.
static void add_skin(CraftBuilder *builder, Profile profile, const Vec3d *rings, int count, int size) {
    int arc = profile == PROFILE_WHOLE ? size : profile == PROFILE_FRONT ? 2 * FRONT_STEPS : REAR_STEPS;
    int end = profile == PROFILE_WHOLE ? size : arc + ARC_POINTS + 1;
    craft_builder_add_strip(builder, rings, count, size, 0, arc);
    craft_builder_set_finish(builder, CRAFT_LINE);
    craft_builder_add_strip(builder, rings, count, size, arc, end);
    craft_builder_set_finish(builder, CRAFT_PAINT);
    craft_builder_add_strip(builder, rings, count, size, end, size);
}

static void add_piece(CraftBuilder *builder, const Half *half, CraftJoint joint, Profile profile,
                      const CraftStation *sections, int count, bool tip) {
    Vec3d rings[RINGS_MAX * SIZE_MAX_RING];
    int size = 0;
    for (int i = 0; i < count; i++)
        size = place_ring(half, &sections[i], profile, rings + i * size);
    const CraftPieceSpec spec = spec_of(half, joint);
    craft_builder_begin_piece(builder, &spec);
    add_skin(builder, profile, rings, count, size);
    craft_builder_add_cap(builder, rings, size, false);
    if (!tip)
        craft_builder_add_cap(builder, rings + (count - 1) * size, size, true);
    craft_builder_end_piece(builder);
}

static void add_panel(CraftBuilder *builder, const Half *half, Profile profile, double from_m, double to_m) {
    const CraftWing *wing = half->wing;
    CraftStation sections[RINGS_MAX];
    if (to_m - from_m < 1e-9)
        return;
    int count = list_sections(wing, from_m, to_m, sections);
    add_piece(builder, half, CRAFT_FIXED, profile, sections, count, false);
}

// From the last control, if it ends before, to the end.
static void add_tip(CraftBuilder *builder, const Half *half, double from_m) {
    const CraftWing *wing = half->wing;
    double to_m = wing->stations[wing->station_count - 1].across_m;
    CraftStation sections[RINGS_MAX];
    int count = to_m - from_m > 1e-9 ? list_sections(wing, from_m, to_m, sections) : 1;
    if (count == 1)
        sections[0] = wing->stations[wing->station_count - 1];
    count += list_tip(wing, sections + count);
    add_piece(builder, half, CRAFT_FIXED, PROFILE_WHOLE, sections, count, true);
}

static CraftJoint joint_of(CraftControlKind kind, bool mirror) {
    switch (kind) {
    case CRAFT_AILERON:
        return mirror ? CRAFT_AILERON_LEFT : CRAFT_AILERON_RIGHT;
    case CRAFT_FLAP:
        return mirror ? CRAFT_FLAP_LEFT : CRAFT_FLAP_RIGHT;
    case CRAFT_ELEVATOR:
        return mirror ? CRAFT_ELEVATOR_LEFT : CRAFT_ELEVATOR_RIGHT;
    case CRAFT_RUDDER:
        break;
    }
    return CRAFT_RUDDER_JOINT;
}

// Mirrored, the axis is turned round: positive turns are the same on both sides.
static CraftHinge hinge_of(const Half *half, const CraftControl *control) {
    CraftStation from = station_at(half->wing, control->from_m), to = station_at(half->wing, control->to_m);
    Vec3d at = place(half, &from, hinge_point(half->wing)), end = place(half, &to, hinge_point(half->wing));
    Vec3d axis = vec3d_normalize(vec3d_sub(end, at));
    if (half->mirror)
        return (CraftHinge){vec3d(at.x, -at.y, at.z), vec3d(-axis.x, axis.y, -axis.z)};
    return (CraftHinge){at, axis};
}

static void add_control(CraftBuilder *builder, const Half *half, const CraftControl *control, CraftHinge *hinges) {
    CraftJoint joint = joint_of(control->kind, half->mirror);
    CraftStation sections[RINGS_MAX];
    int count = list_sections(half->wing, control->from_m, control->to_m, sections);
    add_piece(builder, half, joint, PROFILE_REAR, sections, count, false);
    hinges[joint] = hinge_of(half, control);
}

static void add_half(CraftBuilder *builder, const Half *half, CraftHinge *hinges) {
    const CraftWing *wing = half->wing;
    double done_m = wing->stations[0].across_m;
    craft_builder_set_finish(builder, CRAFT_PAINT);
    for (int i = 0; i < wing->control_count; i++) {
        const CraftControl *control = &wing->controls[i];
        add_panel(builder, half, PROFILE_WHOLE, done_m, control->from_m);
        add_panel(builder, half, PROFILE_FRONT, control->from_m, control->to_m);
        add_control(builder, half, control, hinges);
        done_m = control->to_m;
    }
    add_tip(builder, half, done_m);
}

// The side of a control's outline that lies behind the trailing edge is not seen.
#define BEHIND 0.3 // of the chord
#define SEAM_M 0.011f

static void put_corner(const Half *half, double across_m, double share, float corner[2]) {
    const CraftStation station = station_at(half->wing, across_m);
    corner[0] = (float)(station.x_m - share * station.chord_m);
    corner[1] = (float)(half->upright ? -across_m : across_m);
}

int craft_mark_seams(const CraftWing *wing, CraftSurface surface, int room, CraftMark *marks) {
    const Half half = {.wing = wing, .upright = surface == CRAFT_ON_FIN};
    int count = wing->control_count < room ? wing->control_count : room;
    for (int i = 0; i < count; i++) {
        const CraftControl *control = &wing->controls[i];
        marks[i] = (CraftMark){
            .surface = surface, .from_above = !half.upright, .finish = CRAFT_LINE, .line_m = SEAM_M, .strength = 0.7f};
        put_corner(&half, control->from_m, wing->hinge, marks[i].corners[0]);
        put_corner(&half, control->to_m, wing->hinge, marks[i].corners[1]);
        put_corner(&half, control->to_m, 1.0 + BEHIND, marks[i].corners[2]);
        put_corner(&half, control->from_m, 1.0 + BEHIND, marks[i].corners[3]);
    }
    return count;
}

void craft_add_wing(CraftBuilder *builder, const CraftWing *wing, CraftSurface surface, bool mirror,
                    CraftHinge *hinges) {
    const Half half = {.wing = wing, .surface = surface, .mirror = mirror};
    add_half(builder, &half, hinges);
}

void craft_add_fin(CraftBuilder *builder, const CraftWing *fin, CraftHinge *hinges) {
    const Half half = {.wing = fin, .surface = CRAFT_ON_FIN, .upright = true};
    add_half(builder, &half, hinges);
}
