#include "render/craft/craft_model.h"

#include "base/log.h"

#include <string.h>

static bool folds(const CraftLeg *leg) {
    return vec3d_length(leg->fold_axis) > 0.0;
}

static CraftJoint leg_joint(const CraftLeg *leg, bool mirror) {
    if (!folds(leg))
        return CRAFT_FIXED;
    return !leg->mirrored ? CRAFT_NOSE_LEG : mirror ? CRAFT_LEFT_LEG : CRAFT_RIGHT_LEG;
}

static void add_wings(CraftBuilder *builder, const CraftShape *shape, CraftHinge *hinges) {
    for (int mirror = 0; mirror < 2; mirror++) {
        if (shape->wing.station_count)
            craft_add_wing(builder, &shape->wing, CRAFT_ON_WING, mirror, hinges);
        if (shape->tail.station_count)
            craft_add_wing(builder, &shape->tail, CRAFT_ON_TAIL, mirror, hinges);
    }
    if (shape->fin.station_count)
        craft_add_fin(builder, &shape->fin, hinges);
}

static void add_bodies(CraftBuilder *builder, const CraftShape *shape, bool turning) {
    for (int i = 0; i < shape->body_count; i++)
        for (int mirror = 0; mirror <= shape->bodies[i].mirrored; mirror++)
            if (shape->bodies[i].turns == turning)
                craft_add_body(builder, &shape->bodies[i], mirror);
}

static void add_struts(CraftBuilder *builder, const CraftShape *shape) {
    for (int i = 0; i < shape->strut_count; i++)
        for (int mirror = 0; mirror <= shape->struts[i].mirrored; mirror++)
            craft_add_strut(builder, &shape->struts[i], mirror);
}

// Seen in a mirror, turns go the other way round.
static CraftHinge fold_hinge(const CraftLeg *leg, bool mirror) {
    Vec3d at = leg->pivot, axis = leg->fold_axis;
    if (mirror)
        return (CraftHinge){vec3d(at.x, -at.y, at.z), vec3d(-axis.x, axis.y, -axis.z)};
    return (CraftHinge){at, axis};
}

static void add_legs(CraftBuilder *builder, const CraftShape *shape, bool folding, CraftModel *model) {
    for (int i = 0; i < shape->leg_count; i++) {
        const CraftLeg *leg = &shape->legs[i];
        for (int mirror = 0; mirror <= leg->mirrored && folds(leg) == folding; mirror++) {
            CraftJoint joint = leg_joint(leg, mirror);
            craft_add_leg(builder, leg, joint, mirror);
            model->hinges[joint] = fold_hinge(leg, mirror);
            model->fold_rad[joint] = folding ? leg->fold_rad : 0.0;
        }
    }
}

static void add_range(CraftBuilder *builder, const CraftShape *shape, CraftRange range, CraftModel *model) {
    switch (range) {
    case CRAFT_RANGE_AIRFRAME:
        add_bodies(builder, shape, false);
        add_wings(builder, shape, model->hinges);
        add_struts(builder, shape);
        add_legs(builder, shape, false, model);
        add_bodies(builder, shape, true);
        break;
    case CRAFT_RANGE_GEAR:
        add_legs(builder, shape, true, model);
        break;
    case CRAFT_RANGE_BLADES:
        craft_add_blades(builder, &shape->propeller);
        break;
    case CRAFT_RANGE_DISC:
        if (shape->propeller.diameter_m > 0.0)
            craft_add_disc(builder, &shape->propeller);
        break;
    case CRAFT_RANGE_COUNT:
        break;
    }
}

static double radius_of(const CraftMesh *mesh) {
    double radius = 0.0;
    for (int i = 0; i < mesh->vertex_count; i++) {
        const float *at = mesh->vertices[i].position;
        radius = fmax(radius, vec3d_length(vec3d(at[0], at[1], at[2])));
    }
    return radius;
}

static void find_box(CraftModel *model) {
    Vec3d *low = &model->low, *high = &model->high;
    for (int i = 0; i < model->mesh.vertex_count; i++) {
        const float *at = model->mesh.vertices[i].position;
        *low = vec3d(fmin(low->x, (double)at[0]), fmin(low->y, (double)at[1]), fmin(low->z, (double)at[2]));
        *high = vec3d(fmax(high->x, (double)at[0]), fmax(high->y, (double)at[1]), fmax(high->z, (double)at[2]));
    }
}

Result craft_model_create(const CraftShape *shape, CraftModel *model) {
    *model = (CraftModel){0};
    CraftBuilder *builder = craft_builder_create();
    if (!builder) {
        log_error("out of memory for the aircraft");
        return RESULT_MEMORY;
    }
    for (int range = 0; range < CRAFT_RANGE_COUNT; range++) {
        model->first[range] = craft_builder_triangles(builder) * 3;
        add_range(builder, shape, (CraftRange)range, model);
        model->count[range] = craft_builder_triangles(builder) * 3 - model->first[range];
    }
    model->hinges[CRAFT_PROPELLER_JOINT] = (CraftHinge){shape->propeller.hub, vec3d(1.0, 0.0, 0.0)};
    Result result = craft_builder_finish(builder, &model->mesh);
    craft_builder_destroy(&builder);
    model->radius_m = radius_of(&model->mesh);
    find_box(model);
    return result;
}

void craft_model_free(CraftModel *model) {
    craft_mesh_free(&model->mesh);
    *model = (CraftModel){0};
}

int craft_list_marks(const CraftShape *shape, CraftMark marks[CRAFT_MARKS_MAX]) {
    int count = shape->mark_count;
    memcpy(marks, shape->marks, (size_t)count * sizeof marks[0]);
    count += craft_mark_seams(&shape->wing, CRAFT_ON_WING, CRAFT_MARKS_MAX - count, marks + count);
    count += craft_mark_seams(&shape->tail, CRAFT_ON_TAIL, CRAFT_MARKS_MAX - count, marks + count);
    return count + craft_mark_seams(&shape->fin, CRAFT_ON_FIN, CRAFT_MARKS_MAX - count, marks + count);
}

double craft_joint_angle_rad(const CraftModel *model, CraftJoint joint, const CraftPose *pose) {
    switch (joint) {
    case CRAFT_AILERON_LEFT:
        return pose->aileron_rad;
    case CRAFT_AILERON_RIGHT:
        return -pose->aileron_rad;
    case CRAFT_FLAP_LEFT:
    case CRAFT_FLAP_RIGHT:
        return pose->flaps_rad;
    case CRAFT_ELEVATOR_LEFT:
    case CRAFT_ELEVATOR_RIGHT:
        return -pose->elevator_rad;
    case CRAFT_RUDDER_JOINT:
        return pose->rudder_rad;
    case CRAFT_NOSE_LEG:
    case CRAFT_LEFT_LEG:
    case CRAFT_RIGHT_LEG:
        return model->fold_rad[joint] * (1.0 - fmin(fmax(pose->gear, 0.0), 1.0));
    case CRAFT_PROPELLER_JOINT:
        return pose->propeller_rad;
    case CRAFT_FIXED:
    case CRAFT_JOINT_COUNT:
        break;
    }
    return 0.0;
}

// Pictures come 60 times a second: two blades at 600 turns a minute move by 60 degrees between them.
#define BLUR_BEGINS_RPM 150.0
#define BLUR_ENDS_RPM 450.0

double craft_disc_share(const CraftPose *pose) {
    double share = (fabs(pose->rpm) - BLUR_BEGINS_RPM) / (BLUR_ENDS_RPM - BLUR_BEGINS_RPM);
    return fmin(fmax(share, 0.0), 1.0);
}

bool craft_shows_range(const CraftModel *model, CraftRange range, const CraftPose *pose) {
    if (model->count[range] == 0)
        return false;
    if (range == CRAFT_RANGE_GEAR)
        return pose->gear > 0.0;
    if (range == CRAFT_RANGE_BLADES)
        return craft_disc_share(pose) < 1.0;
    return range != CRAFT_RANGE_DISC || craft_disc_share(pose) > 0.0;
}

static void put_row(CraftPlacement *placement, int column, Vec3d v) {
    placement->rows[0][column] = (float)v.x;
    placement->rows[1][column] = (float)v.y;
    placement->rows[2][column] = (float)v.z;
}

CraftPlacement craft_place_joint(const CraftModel *model, CraftJoint joint, const CraftPose *pose, Quatd ecef_from_body,
                                 Vec3d craft_from_eye_m) {
    double angle = craft_joint_angle_rad(model, joint, pose);
    const CraftHinge *hinge = &model->hinges[joint];
    Quatd turn = angle != 0.0 ? quatd_from_axis_angle(hinge->axis, angle) : (Quatd){1.0, 0.0, 0.0, 0.0};
    Vec3d shift = vec3d_sub(hinge->at, quatd_rotate(turn, hinge->at));
    Quatd whole = quatd_mul(ecef_from_body, turn);
    CraftPlacement placement;
    put_row(&placement, 0, quatd_rotate(whole, vec3d(1.0, 0.0, 0.0)));
    put_row(&placement, 1, quatd_rotate(whole, vec3d(0.0, 1.0, 0.0)));
    put_row(&placement, 2, quatd_rotate(whole, vec3d(0.0, 0.0, 1.0)));
    put_row(&placement, 3, vec3d_add(craft_from_eye_m, quatd_rotate(ecef_from_body, shift)));
    return placement;
}
