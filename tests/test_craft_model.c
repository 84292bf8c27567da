// Aircraft as triangles: solids without a hole, normals outwards, the size that the sources tell, the same on both
// sides; controls that move the right way; and places that are exact wherever on the Earth.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "render/craft/craft_model.h"
#include "terrain/geodesy.h"

#define TRIANGLES_MOST 20000
#define DEG GEODESY_RAD_PER_DEG

static const Quatd NO_TURN = {1.0, 0.0, 0.0, 0.0};

static CraftModel model_of(int kind) {
    CraftModel model;
    assert_int_equal(craft_model_create(craft_shape((CraftKind)kind), &model), RESULT_OK);
    return model;
}

static Vec3d position_of(const CraftMesh *mesh, uint32_t vertex) {
    const float *at = mesh->vertices[vertex].position;
    return vec3d(at[0], at[1], at[2]);
}

static Vec3d normal_of(const CraftMesh *mesh, uint32_t vertex) {
    const int16_t *normal = mesh->vertices[vertex].normal;
    return vec3d_scale(vec3d(normal[0], normal[1], normal[2]), 1.0 / 32767.0);
}

// --- solids

typedef struct Edge {
    float low[3], high[3];
    int direction; // 1 from low to high
} Edge;

static int compare_edges(const void *left, const void *right) {
    const Edge *a = left, *b = right;
    int order = memcmp(a->low, b->low, sizeof a->low);
    return order ? order : memcmp(a->high, b->high, sizeof a->high);
}

static Edge edge_between(const CraftMesh *mesh, uint32_t from, uint32_t to) {
    const float *a = mesh->vertices[from].position, *b = mesh->vertices[to].position;
    bool forward = memcmp(a, b, 3 * sizeof *a) < 0;
    Edge edge = {.direction = forward ? 1 : -1};
    memcpy(edge.low, forward ? a : b, sizeof edge.low);
    memcpy(edge.high, forward ? b : a, sizeof edge.high);
    return edge;
}

// Edges that are not run through as often one way as the other.
static int count_open_edges(const CraftMesh *mesh, const CraftPiece *piece) {
    Edge *edges = malloc((size_t)piece->index_count * sizeof *edges);
    assert_non_null(edges);
    for (int i = 0; i < piece->index_count; i++) {
        const uint32_t *triangle = mesh->indices + piece->first_index + i / 3 * 3;
        edges[i] = edge_between(mesh, triangle[i % 3], triangle[(i + 1) % 3]);
    }
    qsort(edges, (size_t)piece->index_count, sizeof *edges, compare_edges);
    int open = 0;
    for (int begin = 0, end; begin < piece->index_count; begin = end) {
        int balance = 0;
        for (end = begin; end < piece->index_count && compare_edges(&edges[begin], &edges[end]) == 0; end++)
            balance += edges[end].direction;
        open += balance != 0;
    }
    free(edges);
    return open;
}

static double volume_of(const CraftMesh *mesh, const CraftPiece *piece) {
    double volume = 0.0;
    for (int i = piece->first_index; i < piece->first_index + piece->index_count; i += 3)
        volume += vec3d_dot(position_of(mesh, mesh->indices[i]), vec3d_cross(position_of(mesh, mesh->indices[i + 1]),
                                                                             position_of(mesh, mesh->indices[i + 2])));
    return volume / 6.0;
}

static void solids_have_no_hole_and_face_outwards(void **state) {
    (void)state;
    for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) {
        CraftModel model = model_of(kind);
        int open = 0, inside_out = 0, sheets = 0;
        for (int i = 0; i < model.mesh.piece_count; i++) {
            const CraftPiece *piece = &model.mesh.pieces[i];
            sheets += !piece->closed;
            open += piece->closed ? count_open_edges(&model.mesh, piece) : 0;
            inside_out += piece->closed && volume_of(&model.mesh, piece) <= 0.0;
        }
        print_message("%s: %d pieces, %d of them sheets, %d triangles; %d open edges, %d inside out\n",
                      craft_shape((CraftKind)kind)->name, model.mesh.piece_count, sheets, model.mesh.index_count / 3,
                      open, inside_out);
        assert_int_equal(open, 0);
        assert_int_equal(inside_out, 0);
        assert_int_equal(sheets, craft_shape((CraftKind)kind)->propeller.diameter_m > 0.0); // its disc
        assert_in_range(model.mesh.index_count / 3, 1000, TRIANGLES_MOST - 1);
        craft_model_free(&model);
    }
}

static void normals_are_units_on_the_side_of_their_triangles(void **state) {
    (void)state;
    for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) {
        CraftModel model = model_of(kind);
        double shortest = 2.0, longest = 0.0, least = 1.0;
        for (int i = 0; i < model.mesh.index_count; i++) {
            const uint32_t *triangle = model.mesh.indices + i / 3 * 3;
            Vec3d a = position_of(&model.mesh, triangle[0]), normal = normal_of(&model.mesh, triangle[i % 3]);
            Vec3d face = vec3d_cross(vec3d_sub(position_of(&model.mesh, triangle[1]), a),
                                     vec3d_sub(position_of(&model.mesh, triangle[2]), a));
            shortest = fmin(shortest, vec3d_length(normal));
            longest = fmax(longest, vec3d_length(normal));
            if (vec3d_length(face) > 1e-8) // square metres: slivers have no side
                least = fmin(least, vec3d_dot(vec3d_normalize(face), normal));
        }
        print_message("%s: lengths %.5f to %.5f, cosine to the face at least %.3f\n",
                      craft_shape((CraftKind)kind)->name, shortest, longest, least);
        assert_true(shortest > 0.9999 && longest < 1.0001);
        assert_true(least > 0.6);
        craft_model_free(&model);
    }
}

// --- size

static void sizes_are_those_of_the_sources(void **state) {
    (void)state;
    for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) {
        const CraftShape *shape = craft_shape((CraftKind)kind);
        CraftModel model = model_of(kind);
        Vec3d low = {1e9, 1e9, 1e9}, high = {-1e9, -1e9, -1e9};
        for (int i = 0; i < model.mesh.index_count; i++) {
            const CraftVertex *vertex = &model.mesh.vertices[model.mesh.indices[i]];
            if (vertex->finish == CRAFT_BLADE || vertex->finish == CRAFT_DISC)
                continue;
            low = vec3d(fmin(low.x, vertex->position[0]), fmin(low.y, vertex->position[1]), 0.0);
            high = vec3d(fmax(high.x, vertex->position[0]), fmax(high.y, vertex->position[1]), 0.0);
        }
        print_message("%s: span %.3f of %.3f m, length %.3f of %.3f m\n", shape->name, high.y - low.y, shape->span_m,
                      high.x - low.x, shape->length_m);
        assert_true(fabs(high.y - low.y - shape->span_m) < 0.03);
        assert_true(fabs(high.x - low.x - shape->length_m) < 0.06);
        assert_true(model.radius_m > 0.5 * shape->span_m && model.radius_m < shape->span_m + shape->length_m);
        craft_model_free(&model);
    }
}

// The other half's joint.
static uint8_t mirrored_joint(uint8_t joint) {
    static const uint8_t others[CRAFT_JOINT_COUNT] = {CRAFT_FIXED,         CRAFT_AILERON_RIGHT, CRAFT_AILERON_LEFT,
                                                      CRAFT_FLAP_RIGHT,    CRAFT_FLAP_LEFT,     CRAFT_ELEVATOR_RIGHT,
                                                      CRAFT_ELEVATOR_LEFT, CRAFT_RUDDER_JOINT,  CRAFT_NOSE_LEG,
                                                      CRAFT_RIGHT_LEG,     CRAFT_LEFT_LEG,      CRAFT_PROPELLER_JOINT};
    return others[joint];
}

static int compare_places(const void *left, const void *right) {
    const CraftVertex *a = left, *b = right;
    for (int i = 0; i < 3; i++)
        if (a->position[i] != b->position[i])
            return a->position[i] < b->position[i] ? -1 : 1;
    return 0;
}

static bool has_twin(const CraftMesh *sorted, const CraftVertex *vertex) {
    CraftVertex mirrored = *vertex;
    mirrored.position[1] = -vertex->position[1] + 0.0f;
    const CraftVertex *found =
        bsearch(&mirrored, sorted->vertices, (size_t)sorted->vertex_count, sizeof *found, compare_places);
    if (!found)
        return false;
    while (found > sorted->vertices && compare_places(found - 1, &mirrored) == 0)
        found--;
    for (; found < sorted->vertices + sorted->vertex_count && compare_places(found, &mirrored) == 0; found++)
        if (found->finish == vertex->finish && found->joint == mirrored_joint(vertex->joint) &&
            abs(found->normal[0] - vertex->normal[0]) < 400 && abs(found->normal[1] + vertex->normal[1]) < 400 &&
            abs(found->normal[2] - vertex->normal[2]) < 400)
            return true;
    return false;
}

static void the_left_is_the_right_in_a_mirror(void **state) {
    (void)state;
    for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) {
        CraftModel model = model_of(kind), sorted = model_of(kind);
        qsort(sorted.mesh.vertices, (size_t)sorted.mesh.vertex_count, sizeof *sorted.mesh.vertices, compare_places);
        int alone = 0, checked = 0;
        for (int i = 0; i < model.mesh.vertex_count; i++) {
            const CraftVertex *vertex = &model.mesh.vertices[i];
            if (vertex->joint == CRAFT_PROPELLER_JOINT || vertex->surface == CRAFT_ON_REST)
                continue; // blades are twisted, and wheels on the middle are not symmetric bit for bit
            checked++;
            alone += !has_twin(&sorted.mesh, vertex);
        }
        print_message("%s: %d of %d vertices without a twin\n", craft_shape((CraftKind)kind)->name, alone, checked);
        assert_true(checked > 1000);
        assert_int_equal(alone, 0);
        craft_model_free(&model);
        craft_model_free(&sorted);
    }
}

static void one_shape_gives_the_same_bytes(void **state) {
    (void)state;
    for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) {
        CraftModel a = model_of(kind), b = model_of(kind);
        assert_int_equal(a.mesh.vertex_count, b.mesh.vertex_count);
        assert_int_equal(a.mesh.index_count, b.mesh.index_count);
        assert_memory_equal(a.mesh.vertices, b.mesh.vertices, (size_t)a.mesh.vertex_count * sizeof *a.mesh.vertices);
        assert_memory_equal(a.mesh.indices, b.mesh.indices, (size_t)a.mesh.index_count * sizeof *a.mesh.indices);
        craft_model_free(&a);
        craft_model_free(&b);
    }
}

// --- what moves

static Vec3d placed(const CraftPlacement *placement, Vec3d at) {
    double out[3];
    for (int row = 0; row < 3; row++)
        out[row] = (double)placement->rows[row][0] * at.x + (double)placement->rows[row][1] * at.y +
                   (double)placement->rows[row][2] * at.z + (double)placement->rows[row][3];
    return vec3d(out[0], out[1], out[2]);
}

// The rearmost vertex of a joint: on its trailing edge.
static Vec3d rearmost(const CraftModel *model, CraftJoint joint) {
    Vec3d rear = {1e9, 0.0, 0.0};
    for (int i = 0; i < model->mesh.vertex_count; i++)
        if (model->mesh.vertices[i].joint == joint && (double)model->mesh.vertices[i].position[0] < rear.x)
            rear = position_of(&model->mesh, (uint32_t)i);
    assert_true(rear.x < 1e8);
    return rear;
}

// How a joint's trailing edge moves, body axes.
static Vec3d motion(const CraftModel *model, CraftJoint joint, const CraftPose *pose) {
    Vec3d rear = rearmost(model, joint);
    CraftPlacement placement = craft_place_joint(model, joint, pose, NO_TURN, vec3d(0.0, 0.0, 0.0));
    return vec3d_sub(placed(&placement, rear), rear);
}

static void controls_move_the_way_the_aircraft_is_to_go(void **state) {
    (void)state;
    const CraftPose pose = {.aileron_rad = 0.2, .elevator_rad = 0.2, .rudder_rad = 0.2, .flaps_rad = 0.2};
    for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) {
        CraftModel model = model_of(kind);
        Vec3d left = motion(&model, CRAFT_AILERON_LEFT, &pose), right = motion(&model, CRAFT_AILERON_RIGHT, &pose);
        Vec3d left_elevator = motion(&model, CRAFT_ELEVATOR_LEFT, &pose);
        Vec3d right_elevator = motion(&model, CRAFT_ELEVATOR_RIGHT, &pose);
        Vec3d rudder = motion(&model, CRAFT_RUDDER_JOINT, &pose);
        print_message("%s, down: ailerons %.3f and %.3f, elevators %.3f and %.3f m; right: rudder %.3f m\n",
                      craft_shape((CraftKind)kind)->name, left.z, right.z, left_elevator.z, right_elevator.z, rudder.y);
        assert_true(left.z > 0.01 && fabs(left.z + right.z) < 0.3 * left.z); // z is down
        assert_true(left_elevator.z < -0.01 && fabs(left_elevator.z - right_elevator.z) < 1e-5);
        assert_true(rudder.y > 0.01);
        if (craft_shape((CraftKind)kind)->wing.controls[0].kind == CRAFT_FLAP) {
            Vec3d flap = motion(&model, CRAFT_FLAP_RIGHT, &pose), other = motion(&model, CRAFT_FLAP_LEFT, &pose);
            assert_true(flap.z > 0.01 && fabs(flap.z - other.z) < 0.05 * flap.z);
        }
        assert_true(vec3d_length(motion(&model, CRAFT_FIXED, &pose)) == 0.0);
        craft_model_free(&model);
    }
}

// The lowest point of the wheels.
static double lowest_wheel(const CraftModel *model, const CraftPose *pose) {
    double lowest = -1e9;
    for (int i = 0; i < model->mesh.vertex_count; i++) {
        const CraftVertex *vertex = &model->mesh.vertices[i];
        if (vertex->finish != CRAFT_RUBBER)
            continue;
        CraftPlacement placement =
            craft_place_joint(model, (CraftJoint)vertex->joint, pose, NO_TURN, vec3d(0.0, 0.0, 0.0));
        lowest = fmax(lowest, placed(&placement, position_of(&model->mesh, (uint32_t)i)).z);
    }
    return lowest;
}

static void gear_folds_and_is_not_seen_when_it_is_up(void **state) {
    (void)state;
    for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) {
        CraftModel model = model_of(kind);
        const CraftPose down = {.gear = 1.0}, half = {.gear = 0.5}, up = {.gear = 0.0};
        double down_m = lowest_wheel(&model, &down), half_m = lowest_wheel(&model, &half);
        bool folds = model.count[CRAFT_RANGE_GEAR] > 0;
        print_message("%s: wheels %.2f m below the origin, half way %.2f m\n", craft_shape((CraftKind)kind)->name,
                      down_m, half_m);
        assert_true(folds == (kind != CRAFT_C172));
        assert_true(folds ? half_m < down_m - 0.02 : half_m == down_m);
        assert_true(craft_shows_range(&model, CRAFT_RANGE_GEAR, &down) == folds);
        assert_false(craft_shows_range(&model, CRAFT_RANGE_GEAR, &up));
        assert_true(craft_shows_range(&model, CRAFT_RANGE_AIRFRAME, &up));
        craft_model_free(&model);
    }
}

static void blades_blur_into_a_disc(void **state) {
    (void)state;
    CraftModel single = model_of(CRAFT_C172), glider = model_of(CRAFT_GLIDER);
    const CraftPose still = {.rpm = 0.0}, starting = {.rpm = 300.0}, fast = {.rpm = 2400.0};
    assert_true(craft_shows_range(&single, CRAFT_RANGE_BLADES, &still));
    assert_false(craft_shows_range(&single, CRAFT_RANGE_DISC, &still));
    assert_true(craft_shows_range(&single, CRAFT_RANGE_BLADES, &starting));
    assert_true(craft_shows_range(&single, CRAFT_RANGE_DISC, &starting));
    assert_false(craft_shows_range(&single, CRAFT_RANGE_BLADES, &fast));
    assert_true(craft_shows_range(&single, CRAFT_RANGE_DISC, &fast));
    assert_false(craft_shows_range(&glider, CRAFT_RANGE_DISC, &fast));
    // A quarter of a turn, clockwise seen from behind: what was up is right.
    const CraftPose quarter = {.propeller_rad = 0.5 * GEODESY_PI};
    CraftPlacement placement =
        craft_place_joint(&single, CRAFT_PROPELLER_JOINT, &quarter, NO_TURN, vec3d(0.0, 0.0, 0.0));
    Vec3d hub = craft_shape(CRAFT_C172)->propeller.hub;
    Vec3d turned = vec3d_sub(placed(&placement, vec3d_add(hub, vec3d(0.0, 0.0, -1.0))), hub);
    print_message("up goes to %.3f %.3f %.3f\n", turned.x, turned.y, turned.z);
    assert_true(fabs(turned.y - 1.0) < 1e-5 && fabs(turned.z) < 1e-5);
    craft_model_free(&single);
    craft_model_free(&glider);
}

// --- exactness

// An eye that moves by a millimetre moves each vertex by a millimetre the other way, to a hundredth of it.
static void nothing_trembles_anywhere_on_the_earth(void **state) {
    (void)state;
    static const double places_deg[][2] = {{0.0, 0.0},    {0.0, 180.0},    {0.0, -179.999999},
                                           {89.99, 12.0}, {-89.99, 180.0}, {36.5, -84.3}};
    enum { STEPS = 200 };
    CraftModel model = model_of(CRAFT_C172);
    const CraftPose pose = {.elevator_rad = 0.1};
    double worst_m = 0.0;
    int backwards = 0;
    for (size_t p = 0; p < COUNT_OF(places_deg); p++) {
        Vec3d craft = geodesy_to_ecef((Geodetic){places_deg[p][0] * DEG, places_deg[p][1] * DEG, 1500.0});
        Quatd turn = quatd_from_axis_angle(vec3d_normalize(vec3d(1.0, 2.0, 3.0)), 0.7 + (double)p);
        for (int axis = 0; axis < 3; axis++) {
            double last = 1e9;
            for (int step = 0; step < STEPS; step++) {
                double eye[3] = {craft.x - 9.0, craft.y + 7.0, craft.z - 8.0};
                eye[axis] += 0.001 * step;
                Vec3d from_eye = vec3d_sub(craft, vec3d(eye[0], eye[1], eye[2]));
                CraftPlacement placement = craft_place_joint(&model, CRAFT_ELEVATOR_LEFT, &pose, turn, from_eye);
                double now = (double)placement.rows[axis][3];
                backwards += now >= last;
                if (step > 0)
                    worst_m = fmax(worst_m, fabs(last - now - 0.001));
                last = now;
            }
        }
    }
    print_message("%d steps the wrong way; a step of 1 mm is off by %.2e m at most\n", backwards, worst_m);
    assert_int_equal(backwards, 0);
    assert_true(worst_m < 1e-5);
    craft_model_free(&model);
}

// The last mark of each shape must not be cut off by the room for them.
static void every_seam_has_room(void **state) {
    (void)state;
    for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++) {
        const CraftShape *shape = craft_shape((CraftKind)kind);
        CraftMark marks[CRAFT_MARKS_MAX];
        int expected =
            shape->mark_count + shape->wing.control_count + shape->tail.control_count + shape->fin.control_count;
        print_message("%s: %d marks\n", shape->name, expected);
        assert_int_equal(craft_list_marks(shape, marks), expected);
        for (int i = 0; i < expected; i++)
            assert_true(marks[i].surface < CRAFT_SURFACE_COUNT && marks[i].strength > 0.0f);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solids_have_no_hole_and_face_outwards),
        cmocka_unit_test(normals_are_units_on_the_side_of_their_triangles),
        cmocka_unit_test(sizes_are_those_of_the_sources),
        cmocka_unit_test(the_left_is_the_right_in_a_mirror),
        cmocka_unit_test(one_shape_gives_the_same_bytes),
        cmocka_unit_test(controls_move_the_way_the_aircraft_is_to_go),
        cmocka_unit_test(gear_folds_and_is_not_seen_when_it_is_up),
        cmocka_unit_test(blades_blur_into_a_disc),
        cmocka_unit_test(nothing_trembles_anywhere_on_the_earth),
        cmocka_unit_test(every_seam_has_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
