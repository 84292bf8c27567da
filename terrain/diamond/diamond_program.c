// Our own: a selection bound to one model, as Yalcin's evaluation (2011, section 6) runs it: places become positions
// relative to the model's origin, in float, rounded so that a diamond is rather in than out.
#include "terrain/diamond/diamond_select_parts.h"

#include "terrain/diamond/diamond.h"
#include "terrain/geodesy.h"
#include "terrain/grid.h"

#include <math.h>

// Roundings of a position and of a product with it, relative.
#define PLACE_ROUNDING 1e-6
#define METRES_PER_DEGREE_MIN 110000.0 // of latitude; of longitude, times the cosine
#define COSINE_MIN 1e-3                // nearer to a pole every diamond reaches into every box
#define DEGREES_ROUNDING 1e-6          // relative, of a float difference of degrees

int diamond_op_operands(DiamondOp op) {
    static const uint8_t operands[DIAMOND_OP_COUNT] = {
#define OPERANDS(id, operands, constants, meaning) operands,
        DIAMOND_OP_TABLE(OPERANDS)
#undef OPERANDS
    };
    return operands[op];
}

int diamond_op_constants(DiamondOp op) {
    static const uint8_t constants[DIAMOND_OP_COUNT] = {
#define CONSTANTS(id, operands, constants, meaning) constants,
        DIAMOND_OP_TABLE(CONSTANTS)
#undef CONSTANTS
    };
    return constants[op];
}

unsigned diamond_select_fields(const DiamondSelect *select) {
    unsigned fields = 0;
    for (int i = 0; i < select->step_count; i++) {
        fields |= select->steps[i].op == DIAMOND_OP_HEIGHT ? DIAMOND_FIELD_DATUM : 0u;
        fields |= select->steps[i].op == DIAMOND_OP_BOX ? DIAMOND_FIELD_DEGREES : 0u;
    }
    return fields;
}

static void put_vector(float *out, Vec3d v) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static void bind_within(const double *arguments, const DiamondModel *model, float *out) {
    double lat = arguments[0] * GEODESY_RAD_PER_DEG, lon = arguments[1] * GEODESY_RAD_PER_DEG;
    Vec3d place = vec3d_sub(geodesy_to_ecef((Geodetic){lat, lon, 0.0}), model->origin_ecef);
    Mat3d enu = geodesy_enu_from_ecef(lat, lon);
    put_vector(out, place);
    put_vector(out + 3, vec3d(enu.m[0][0], enu.m[0][1], enu.m[0][2]));
    put_vector(out + 6, vec3d(enu.m[1][0], enu.m[1][1], enu.m[1][2]));
    out[9] = (float)(arguments[2] + PLACE_ROUNDING * (vec3d_length(place) + (double)model->extent_m));
}

static double largest_latitude(const DiamondModel *model) {
    const DiamondLayout *layout = &model->layout;
    double most = 0.0;
    for (int i = 0; i < 6; i++) {
        double lat, lon, col = 0.5 * (i % 3) * (layout->width - 1), row = (i / 3) * (layout->height - 1);
        grid_geodetic(terrain_grid(model->terrain), col, row, &lat, &lon);
        most = fmax(most, fabs(lat));
    }
    return most;
}

static void bind_box(const double *arguments, const DiamondModel *model, float *out) {
    double width = arguments[2] - arguments[0];
    width = width < 0.0 ? width + 360.0 : width;
    double middle = remainder(arguments[0] + 0.5 * width - model->middle_lon_deg, 360.0);
    double half = width < 360.0 ? 0.5 * width : 360.0;
    double cosine = fmax(COSINE_MIN, cos(fmin(90.0, largest_latitude(model) + 0.1) * GEODESY_RAD_PER_DEG));
    double more = DEGREES_ROUNDING * (fabs(middle) + half);
    out[0] = (float)(middle - half - more);
    out[1] = (float)(arguments[1] - model->middle_lat_deg - DEGREES_ROUNDING);
    out[2] = (float)(middle + half + more);
    out[3] = (float)(arguments[3] - model->middle_lat_deg + DEGREES_ROUNDING);
    out[4] = (float)(1.0 / (METRES_PER_DEGREE_MIN * cosine));
    out[5] = (float)(1.0 / METRES_PER_DEGREE_MIN);
}

static float *put_step(DiamondOp op, DiamondProgram *out) {
    float *constants = out->constants + out->constant_count;
    out->steps[out->step_count++] = (DiamondStep){(uint8_t)op, (uint16_t)out->constant_count};
    out->constant_count += diamond_op_constants(op);
    return constants;
}

// A vertex's degrees from the middle are within half a turn; a box that reaches beyond is asked for from both sides.
static void bind_boxes(const double *arguments, const DiamondModel *model, DiamondProgram *out) {
    float *first = put_step(DIAMOND_OP_BOX, out);
    bind_box(arguments, model, first);
    float turn = first[2] > 180.0f ? -360.0f : first[0] < -180.0f ? 360.0f : 0.0f;
    if (turn == 0.0f)
        return;
    float *second = put_step(DIAMOND_OP_BOX, out);
    for (int i = 0; i < diamond_op_constants(DIAMOND_OP_BOX); i++)
        second[i] = first[i] + (i == 0 || i == 2 ? turn : 0.0f);
    put_step(DIAMOND_OP_OR, out);
}

static void bind_step(const DiamondSelectStep *step, const DiamondModel *model, DiamondProgram *out) {
    if (step->op == DIAMOND_OP_BOX) {
        bind_boxes(step->arguments, model, out);
        return;
    }
    float *constants = put_step(step->op, out);
    if (step->op == DIAMOND_OP_CONSTANT)
        constants[0] = (float)step->arguments[0];
    if (step->op == DIAMOND_OP_WITHIN)
        bind_within(step->arguments, model, constants);
}

void diamond_select_bind(const DiamondSelect *select, const DiamondModel *model, DiamondProgram *out) {
    static const DiamondSelectStep tolerance = {.op = DIAMOND_OP_TOLERANCE};
    *out = (DiamondProgram){0};
    if (!select)
        bind_step(&tolerance, model, out);
    for (int i = 0; select && i < select->step_count; i++)
        bind_step(&select->steps[i], model, out);
}
