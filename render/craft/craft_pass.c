#include "render/craft/craft_pass.h"

#include "base/log.h"
#include "render/craft/craft_model.h"
#include "render/craft/craft_shade.h"
#include "render/craft/craft_shadow.h"
#include "render/craft/craft_split.h"
#include "render/gl.h"
#include "render/shader.h"
#include "terrain/geodesy.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define CRAFT_BLOCK_BINDING 3 // shaders/craft.glsl

// std140; the twin of shaders/craft.glsl.
typedef struct CraftBlock {
    float rows[CRAFT_JOINT_COUNT][3][4]; // CraftPlacement
    float finishes[CRAFT_FINISH_COUNT][4];
    float sides[CRAFT_MARKS_MAX][3][4];
    float figures[CRAFT_MARKS_MAX][4];      // radius of the corners, width of the line, strength
    int32_t kinds[CRAFT_MARKS_MAX][4];      // from above, finish
    int32_t ranges[CRAFT_SURFACE_COUNT][4]; // first mark, behind the last
    float place[4];                         // xyz: the origin from the eye, metres; w: its height, km
    float disc[4];                          // radius, how opaque, the first blade's angle, blades
    float hub[4];
    float map_rows[3][4];
    int32_t shadow[4]; // 1 where the map of shadows holds this aircraft
} CraftBlock;
_Static_assert(sizeof(CraftBlock) ==
                   (3 * CRAFT_JOINT_COUNT + CRAFT_FINISH_COUNT + 5 * CRAFT_MARKS_MAX + CRAFT_SURFACE_COUNT + 7) * 16,
               "as shaders/craft.glsl has it");

typedef struct DrawnModel {
    CraftModel model;
    CraftSplit split;
    GLuint vertex_array, vertices, indices;
    bool made;
} DrawnModel;

struct CraftPass {
    GLuint program, block_buffer; // program: 0 until an aircraft is shown
    CraftShadow *shadow;          // as that
    CraftShade *shade;            // NULL until a shadow falls on the land
    DrawnModel models[CRAFT_KIND_COUNT];
    bool seen; // what was prepared is in the picture
    CraftBlock block;
};

Result craft_pass_create(CraftPass **out) {
    CraftPass *pass = calloc(1, sizeof *pass);
    if (!pass) {
        log_error("out of memory for the aircraft");
        return RESULT_MEMORY;
    }
    glCreateBuffers(1, &pass->block_buffer);
    glNamedBufferStorage(pass->block_buffer, sizeof pass->block, NULL, GL_DYNAMIC_STORAGE_BIT);
    *out = pass;
    return RESULT_OK;
}

static void destroy_model(DrawnModel *drawn) {
    glDeleteVertexArrays(1, &drawn->vertex_array);
    glDeleteBuffers(1, &drawn->vertices);
    glDeleteBuffers(1, &drawn->indices);
    craft_model_free(&drawn->model);
    *drawn = (DrawnModel){0};
}

void craft_pass_destroy(CraftPass **pass) {
    CraftPass *self = *pass;
    if (!self)
        return;
    for (int kind = 0; kind < CRAFT_KIND_COUNT; kind++)
        destroy_model(&self->models[kind]);
    craft_shadow_destroy(&self->shadow);
    craft_shade_destroy(&self->shade);
    glDeleteProgram(self->program);
    glDeleteBuffers(1, &self->block_buffer);
    free(self);
    *pass = NULL;
}

static void describe_vertices(GLuint array) {
    for (GLuint i = 0; i < 3; i++) {
        glEnableVertexArrayAttrib(array, i);
        glVertexArrayAttribBinding(array, i, 0);
    }
    glVertexArrayAttribFormat(array, 0, 3, GL_FLOAT, GL_FALSE, offsetof(CraftVertex, position));
    glVertexArrayAttribFormat(array, 1, 3, GL_SHORT, GL_TRUE, offsetof(CraftVertex, normal));
    glVertexArrayAttribIFormat(array, 2, 3, GL_UNSIGNED_BYTE, offsetof(CraftVertex, finish));
}

static Result make_model(CraftKind kind, DrawnModel *drawn) {
    Result result = craft_model_create(craft_shape(kind), &drawn->model);
    if (result == RESULT_OK && (result = craft_split_find(&drawn->model, &drawn->split)) != RESULT_OK)
        craft_model_free(&drawn->model);
    if (result != RESULT_OK)
        return result;
    const CraftMesh *mesh = &drawn->model.mesh;
    glCreateBuffers(1, &drawn->vertices);
    glCreateBuffers(1, &drawn->indices);
    glNamedBufferStorage(drawn->vertices, (GLsizeiptr)mesh->vertex_count * (GLsizeiptr)sizeof *mesh->vertices,
                         mesh->vertices, 0);
    glNamedBufferStorage(drawn->indices, (GLsizeiptr)mesh->index_count * (GLsizeiptr)sizeof *mesh->indices,
                         mesh->indices, 0);
    glCreateVertexArrays(1, &drawn->vertex_array);
    describe_vertices(drawn->vertex_array);
    glVertexArrayVertexBuffer(drawn->vertex_array, 0, drawn->vertices, 0, sizeof(CraftVertex));
    glVertexArrayElementBuffer(drawn->vertex_array, drawn->indices);
    drawn->made = true;
    return RESULT_OK;
}

// The outward distance from one side of the quadrilateral, grown by the mark's rounding.
static void put_side(float sides[3][4], int side, const CraftMark *mark) {
    const float *a = mark->corners[side], *b = mark->corners[(side + 1) % 4], *c = mark->corners[(side + 2) % 4];
    double along_x = (double)b[0] - (double)a[0], along_y = (double)b[1] - (double)a[1];
    double turn = along_x * ((double)c[1] - (double)b[1]) - along_y * ((double)c[0] - (double)b[0]);
    double scale = (turn < 0.0 ? -1.0 : 1.0) / hypot(along_x, along_y);
    sides[0][side] = (float)(along_y * scale);
    sides[1][side] = (float)(-along_x * scale);
    sides[2][side] = (float)((along_x * (double)a[1] - along_y * (double)a[0]) * scale - (double)mark->round_m);
}

static void put_mark(CraftBlock *block, int i, const CraftMark *mark) {
    for (int side = 0; side < 4; side++)
        put_side(block->sides[i], side, mark);
    block->figures[i][0] = mark->round_m;
    block->figures[i][1] = mark->line_m;
    block->figures[i][2] = mark->strength;
    block->kinds[i][0] = mark->from_above;
    block->kinds[i][1] = (int32_t)mark->finish;
}

// Marks of one surface stand together: a pixel looks at those alone.
static void put_marks(CraftBlock *block, const CraftShape *shape) {
    CraftMark marks[CRAFT_MARKS_MAX];
    int count = craft_list_marks(shape, marks), put = 0;
    for (int surface = 0; surface < CRAFT_SURFACE_COUNT; surface++) {
        block->ranges[surface][0] = put;
        for (int i = 0; i < count; i++)
            if (marks[i].surface == (CraftSurface)surface)
                put_mark(block, put++, &marks[i]);
        block->ranges[surface][1] = put;
    }
}

static void put_paint(CraftBlock *block, const CraftShape *shape) {
    for (int i = 0; i < CRAFT_FINISH_COUNT; i++) {
        const CraftColour *colour = &shape->finishes[i];
        const float values[4] = {colour->red, colour->green, colour->blue, colour->gloss};
        memcpy(block->finishes[i], values, sizeof values);
    }
    put_marks(block, shape);
}

static void put_vector(float out[4], Vec3d v, double w) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
    out[3] = (float)w;
}

static void put_places(CraftBlock *block, const CraftModel *model, const RenderCraft *craft, Vec3d from_eye) {
    for (int joint = 0; joint < CRAFT_JOINT_COUNT; joint++) {
        CraftPlacement placement =
            craft_place_joint(model, (CraftJoint)joint, &craft->pose, craft->ecef_from_body, from_eye);
        for (int row = 0; row < 3; row++)
            for (int column = 0; column < 4; column++)
                block->rows[joint][row][column] = placement.rows[row][column];
    }
    double height_m = vec3d_length(frame_round(craft->position_ecef)) - GEODESY_A_M;
    put_vector(block->place, from_eye, height_m * 1e-3);
}

static void put_propeller(CraftBlock *block, const CraftPropeller *propeller, const CraftPose *pose) {
    block->disc[0] = (float)(0.5 * propeller->diameter_m);
    block->disc[1] = (float)craft_disc_share(pose);
    block->disc[2] = 0.0f;
    block->disc[3] = (float)propeller->blades;
    put_vector(block->hub, propeller->hub, 0.0);
}

#define SHADOW_LEAST_PX 60.0 // of the aircraft's radius: smaller, its own shadows are not seen

static bool shows_shadows(const Frame *frame, const CraftModel *model, Vec3d from_eye) {
    double px_per_rad = (double)frame->block.ray_right[3];
    return frame->mu_sun > -0.05 && model->radius_m * px_per_rad > SHADOW_LEAST_PX * vec3d_length(from_eye);
}

static void fill_block(CraftBlock *block, const CraftModel *model, const Frame *frame, const RenderCraft *craft) {
    const CraftShape *shape = craft_shape(craft->kind);
    Vec3d from_eye = vec3d_sub(craft->position_ecef, frame->eye_ecef);
    Vec3d sun = {(double)frame->block.sun[0], (double)frame->block.sun[1], (double)frame->block.sun[2]};
    put_paint(block, shape);
    put_places(block, model, craft, from_eye);
    put_propeller(block, &shape->propeller, &craft->pose);
    craft_shadow_project(sun, from_eye, model->radius_m, block->map_rows);
    block->shadow[0] = shows_shadows(frame, model, from_eye);
}

static void draw_range(const CraftModel *model, CraftRange range, const CraftPose *pose) {
    if (craft_shows_range(model, range, pose))
        glDrawElements(GL_TRIANGLES, model->count[range], GL_UNSIGNED_INT,
                       (const void *)(sizeof(uint32_t) * (size_t)model->first[range]));
}

// The disc is seen from both sides, and what is behind it shows through.
static void draw_disc(const CraftModel *model, const CraftPose *pose) {
    if (!craft_shows_range(model, CRAFT_RANGE_DISC, pose))
        return;
    glDisable(GL_CULL_FACE);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    draw_range(model, CRAFT_RANGE_DISC, pose);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    glEnable(GL_CULL_FACE);
}

static void draw_solids(const CraftModel *model, const CraftPose *pose) {
    draw_range(model, CRAFT_RANGE_AIRFRAME, pose);
    draw_range(model, CRAFT_RANGE_GEAR, pose);
    draw_range(model, CRAFT_RANGE_BLADES, pose);
}

// ---- what is made when it is first needed ----

static Result have_model(CraftPass *pass, CraftKind kind) {
    DrawnModel *drawn = &pass->models[kind];
    return drawn->made ? RESULT_OK : make_model(kind, drawn);
}

static Result have_program(CraftPass *pass) {
    const ShaderSpec spec = {.stages = {"craft.vert", "craft.frag"}};
    Result result = pass->program ? RESULT_OK : shader_create_program(&spec, &pass->program);
    if (result == RESULT_OK && !pass->shadow)
        result = craft_shadow_create(&pass->shadow);
    return result;
}

static Result have_parts(CraftPass *pass, CraftKind kind, bool seen, bool falls) {
    Result result = have_model(pass, kind);
    if (result == RESULT_OK && seen)
        result = have_program(pass);
    if (result == RESULT_OK && falls && !pass->shade)
        result = craft_shade_create(&pass->shade);
    return result;
}

// ---- drawing ----

static void bind(CraftPass *pass, CraftKind kind) {
    glBindBufferBase(GL_UNIFORM_BUFFER, CRAFT_BLOCK_BINDING, pass->block_buffer);
    glBindVertexArray(pass->models[kind].vertex_array);
    glDepthFunc(GL_GREATER);
}

#define TEXELS_A_PENUMBRA 3.0 // of its radius: finer ones are not seen
#define TEXELS_A_PIXEL 1.2

static void draw_shade(CraftPass *pass, const CraftModel *model, const Frame *frame, const RenderCraft *craft,
                       const CraftCast *cast) {
    double pixel_m = cast->eye_m / (double)frame->block.ray_right[3];
    double texel_m = fmax(cast->nearest_m * CRAFT_SUN_TANGENT / TEXELS_A_PENUMBRA, pixel_m / TEXELS_A_PIXEL);
    craft_shade_begin(pass->shade, 2.0 * model->radius_m, texel_m);
    draw_solids(model, &craft->pose);
    craft_shade_end(pass->shade, pass->block.map_rows);
}

static void draw_maps(CraftPass *pass, const Frame *frame, const RenderCraft *craft, const CraftCast *cast) {
    const CraftModel *model = &pass->models[craft->kind].model;
    glNamedBufferSubData(pass->block_buffer, 0, sizeof pass->block, &pass->block);
    bind(pass, craft->kind);
    if (pass->seen && pass->block.shadow[0]) {
        craft_shadow_begin(pass->shadow);
        draw_solids(model, &craft->pose);
        craft_shadow_end(pass->shadow);
    }
    if (cast->falls)
        draw_shade(pass, model, frame, craft, cast);
    glBindVertexArray(0);
}

#define MOVES_M 0.3 // beyond the box of the model, controls and a propeller
#define PARTS_MOVE_M 0.05
_Static_assert(CRAFT_SPLIT_MAX == CRAFT_CAST_PARTS, "every part is cast");

static void narrow_cast(const DrawnModel *drawn, const Frame *frame, const CraftBox *box, const CraftLand *land,
                        CraftCast *cast) {
    const CraftSplit *split = &drawn->split;
    const Vec3d more = {PARTS_MOVE_M, PARTS_MOVE_M, PARTS_MOVE_M};
    CraftBox parts[CRAFT_CAST_PARTS];
    for (int i = 0; i < split->count; i++) {
        Vec3d middle = vec3d_scale(vec3d_add(split->low[i], split->high[i]), 0.5);
        Vec3d half = vec3d_add(vec3d_scale(vec3d_sub(split->high[i], split->low[i]), 0.5), more);
        parts[i] = *box;
        parts[i].position_ecef = vec3d_add(box->position_ecef, quatd_rotate(box->ecef_from_body, middle));
        parts[i].low = vec3d_scale(half, -1.0);
        parts[i].high = half;
    }
    craft_cast_narrow(land, frame, parts, split->count, cast);
}

// First roughly: the model is made only for a shadow that may be seen.
static Result find_cast(CraftPass *pass, const Frame *frame, const RenderCraft *craft, const CraftLand *land,
                        CraftCast *cast) {
    double reach_m = craft_shape_reach_m(craft_shape(craft->kind));
    CraftBox box = {craft->position_ecef, craft->ecef_from_body, vec3d(-reach_m, -reach_m, -reach_m),
                    vec3d(reach_m, reach_m, reach_m), reach_m / CRAFT_SUN_TANGENT};
    *cast = craft_cast_find(land, frame, &box, reach_m);
    Result result = cast->falls ? have_model(pass, craft->kind) : RESULT_OK;
    if (!cast->falls || result != RESULT_OK)
        return result;
    const CraftModel *model = &pass->models[craft->kind].model;
    const Vec3d moves = {MOVES_M, MOVES_M, MOVES_M};
    box.low = vec3d_sub(model->low, moves);
    box.high = vec3d_add(model->high, moves);
    *cast = craft_cast_find(land, frame, &box, reach_m);
    if (cast->falls)
        narrow_cast(&pass->models[craft->kind], frame, &box, land, cast);
    return RESULT_OK;
}

Result craft_pass_prepare(CraftPass *pass, const Frame *frame, const RenderCraft *craft, const CraftLand *land,
                          CraftCast *cast) {
    *cast = (CraftCast){0};
    Result result = craft->casts ? find_cast(pass, frame, craft, land, cast) : RESULT_OK;
    pass->seen =
        craft->show && frame_sees_sphere(frame, craft->position_ecef, craft_shape_reach_m(craft_shape(craft->kind)));
    if (result == RESULT_OK && !pass->seen && !cast->falls)
        return RESULT_OK;
    if (result == RESULT_OK)
        result = have_parts(pass, craft->kind, pass->seen, cast->falls);
    if (result != RESULT_OK) {
        pass->seen = cast->falls = false;
        return result;
    }
    fill_block(&pass->block, &pass->models[craft->kind].model, frame, craft);
    draw_maps(pass, frame, craft, cast);
    return RESULT_OK;
}

void craft_pass_draw(CraftPass *pass, const RenderCraft *craft) {
    if (!pass->seen)
        return;
    const CraftModel *model = &pass->models[craft->kind].model;
    bind(pass, craft->kind);
    glUseProgram(pass->program);
    draw_solids(model, &craft->pose);
    draw_disc(model, &craft->pose);
    glBindVertexArray(0);
}
