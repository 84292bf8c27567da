#include "render/craft/craft_split.h"

#include "base/log.h"

#include <math.h>
#include <stdlib.h>

#define POSES 5 // from one end of every joint's way to the other
#define CONTROLS_RAD 0.5
#define FLAPS_RAD 0.8
#define SLICES 16
#define AXES 3

typedef struct Box {
    Vec3d low, high;
} Box;

static const Box NOTHING = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

// A cut across an axis; gain: square metres of surface.
typedef struct Cut {
    int axis;
    double at, gain;
} Cut;

typedef struct Splitter {
    Box *boxes; // of triangles
    uint8_t *parts;
    int triangles;
} Splitter;

static Box join(Box a, Box b) {
    return (Box){{fmin(a.low.x, b.low.x), fmin(a.low.y, b.low.y), fmin(a.low.z, b.low.z)},
                 {fmax(a.high.x, b.high.x), fmax(a.high.y, b.high.y), fmax(a.high.z, b.high.z)}};
}

static double surface(Box box) {
    Vec3d d = vec3d_sub(box.high, box.low);
    return d.x >= 0.0 ? d.x * d.y + d.y * d.z + d.z * d.x : 0.0;
}

static double along(Vec3d v, int axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static double middle(const Box *box, int axis) {
    return 0.5 * (along(box->low, axis) + along(box->high, axis));
}

// ---- the triangles, wherever they move ----

static Box sweep(const CraftModel *model, const double angles[POSES][CRAFT_JOINT_COUNT], const uint32_t corners[3]) {
    Box box = NOTHING;
    for (int i = 0; i < 3; i++) {
        const CraftVertex *vertex = &model->mesh.vertices[corners[i]];
        const CraftHinge *hinge = &model->hinges[vertex->joint];
        Vec3d at = {(double)vertex->position[0], (double)vertex->position[1], (double)vertex->position[2]};
        for (int pose = 0; pose < POSES; pose++) {
            double angle = angles[pose][vertex->joint];
            Vec3d to = at;
            if (angle != 0.0)
                to = vec3d_add(hinge->at,
                               quatd_rotate(quatd_from_axis_angle(hinge->axis, angle), vec3d_sub(at, hinge->at)));
            box = join(box, (Box){to, to});
        }
    }
    return box;
}

// The blades' way is the disc.
static void sweep_all(const CraftModel *model, Box *boxes, int triangles) {
    double angles[POSES][CRAFT_JOINT_COUNT];
    for (int i = 0; i < POSES; i++) {
        double share = (double)i / (POSES - 1), control_rad = CONTROLS_RAD * (2.0 * share - 1.0);
        const CraftPose pose = {.aileron_rad = control_rad,
                                .elevator_rad = control_rad,
                                .rudder_rad = control_rad,
                                .flaps_rad = FLAPS_RAD * share,
                                .gear = share};
        for (int joint = 0; joint < CRAFT_JOINT_COUNT; joint++)
            angles[i][joint] = craft_joint_angle_rad(model, (CraftJoint)joint, &pose);
    }
    for (int i = 0; i < triangles; i++)
        boxes[i] = sweep(model, angles, model->mesh.indices + 3 * (size_t)i);
}

// ---- cuts ----

static Cut cut_across(const Splitter *splitter, int part, const Box *whole, int axis) {
    Box slices[SLICES], after[SLICES + 1], before = NOTHING;
    double from = along(whole->low, axis), width = (along(whole->high, axis) - from) / SLICES;
    Cut best = {.axis = axis};
    for (int i = 0; i < SLICES; i++)
        slices[i] = NOTHING;
    for (int i = 0; i < splitter->triangles; i++) {
        if (splitter->parts[i] != part)
            continue;
        int slice = (int)fmin((middle(&splitter->boxes[i], axis) - from) / width, SLICES - 1);
        slices[slice] = join(slices[slice], splitter->boxes[i]);
    }
    after[SLICES] = NOTHING;
    for (int i = SLICES; i-- > 0;)
        after[i] = join(after[i + 1], slices[i]);
    for (int i = 1; i < SLICES; i++) {
        before = join(before, slices[i - 1]);
        double gain = surface(*whole) - surface(before) - surface(after[i]);
        if (gain > best.gain)
            best = (Cut){axis, from + width * i, gain};
    }
    return best;
}

static Box box_of(const Splitter *splitter, int part) {
    Box box = NOTHING;
    for (int i = 0; i < splitter->triangles; i++)
        if (splitter->parts[i] == part)
            box = join(box, splitter->boxes[i]);
    return box;
}

static Cut best_cut(const Splitter *splitter, int part) {
    Box whole = box_of(splitter, part);
    Cut best = {0};
    for (int axis = 0; axis < AXES; axis++) {
        Cut cut = cut_across(splitter, part, &whole, axis);
        if (cut.gain > best.gain)
            best = cut;
    }
    return best;
}

static void cut_part(Splitter *splitter, int part, const Cut *cut, int other) {
    for (int i = 0; i < splitter->triangles; i++)
        if (splitter->parts[i] == part && middle(&splitter->boxes[i], cut->axis) >= cut->at)
            splitter->parts[i] = (uint8_t)other;
}

// Always there where the most is gained.
static int cut_all(Splitter *splitter) {
    Cut cuts[CRAFT_SPLIT_MAX];
    int count = 1;
    cuts[0] = best_cut(splitter, 0);
    while (count < CRAFT_SPLIT_MAX) {
        int most = 0;
        for (int i = 1; i < count; i++)
            most = cuts[i].gain > cuts[most].gain ? i : most;
        if (cuts[most].gain <= 0.0)
            break;
        cut_part(splitter, most, &cuts[most], count);
        cuts[most] = best_cut(splitter, most);
        cuts[count] = best_cut(splitter, count);
        count++;
    }
    return count;
}

Result craft_split_find(const CraftModel *model, CraftSplit *split) {
    int triangles = model->mesh.index_count / 3;
    Splitter splitter = {malloc((size_t)triangles * sizeof(Box)), calloc((size_t)triangles, 1), triangles};
    Result result = splitter.boxes && splitter.parts ? RESULT_OK : RESULT_MEMORY;
    *split = (CraftSplit){0};
    if (result == RESULT_OK) {
        sweep_all(model, splitter.boxes, triangles);
        split->count = cut_all(&splitter);
    } else {
        log_error("out of memory for the aircraft's shadow on the ground");
    }
    for (int i = 0; i < split->count; i++) {
        Box box = box_of(&splitter, i);
        split->low[i] = box.low;
        split->high[i] = box.high;
    }
    free(splitter.boxes);
    free(splitter.parts);
    return result;
}
