#include "render/diamond/diamond_pass.h"

#include "base/clock.h"
#include "base/log.h"
#include "render/gl.h"
#include "render/shader.h"
#include "terrain/lod/budget.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define DRAW_BLOCK_BINDING 7
// Room for indices beyond the budget, so that frames that are over it before that is known are whole.
#define ROOM_BEYOND 4 // a share of it
#define ROOM_LEAST 65536
#define TOLERANCES 8 // remembered, more than there are frames in flight

// std140, shaders/diamond_draw.glsl.
typedef struct DiamondDrawBlock {
    int32_t origin_lo[4], origin_hi[4], levels[4];
} DiamondDrawBlock;

struct DiamondPass {
    DiamondPassOptions options;
    DiamondGpu *gpu;     // NULL: no resident cut came yet, or lately
    uint64_t model_id;   // of what it holds
    uint64_t refused_id; // of a model that could not be had; 0: none
    bool refused;        // in this frame
    double create_ms;    // of the model
    GridPoint origin;
    int32_t width, level_count;
    int64_t room; // triangles that can be drawn
    bool wet;
    GLuint land_programs[2], level_programs[2], wire_program; // without and with a shadow; 0 until they are called for
    GLuint draw_block;
    Budget budget;
    uint64_t settled;              // the first generation of the view as it is
    double tolerances[TOLERANCES]; // by generation of indices
    int64_t triangles;             // wanted in the newest frame known
    double tau_px;                 // its tolerance
    bool over_room;                // and it has been said
};

Result diamond_pass_create(const DiamondPassOptions *options, DiamondPass **out) {
    DiamondPass *pass = calloc(1, sizeof *pass);
    if (!pass) {
        log_error("out of memory for the pass that draws diamonds");
        return RESULT_MEMORY;
    }
    pass->options = *options;
    glCreateBuffers(1, &pass->draw_block);
    glNamedBufferStorage(pass->draw_block, sizeof(DiamondDrawBlock), NULL, GL_DYNAMIC_STORAGE_BIT);
    *out = pass;
    return RESULT_OK;
}

void diamond_pass_destroy(DiamondPass **pass) {
    DiamondPass *self = *pass;
    if (!self)
        return;
    diamond_gpu_destroy(&self->gpu);
    for (int shaded = 0; shaded < 2; shaded++) {
        glDeleteProgram(self->land_programs[shaded]);
        glDeleteProgram(self->level_programs[shaded]);
    }
    glDeleteProgram(self->wire_program);
    glDeleteBuffers(1, &self->draw_block);
    free(self);
    *pass = NULL;
}

// ---- the model ----

static GridPoint lattice_point(Vec3d metres) {
    return (GridPoint){(int64_t)metres.x * GRID_LATTICE_PER_M, (int64_t)metres.y * GRID_LATTICE_PER_M,
                       (int64_t)metres.z * GRID_LATTICE_PER_M};
}

static void forget_model(DiamondPass *pass) {
    diamond_gpu_destroy(&pass->gpu);
    pass->budget = (Budget){0};
    pass->triangles = 0;
    pass->over_room = false;
}

static Result take_model(DiamondPass *pass, const DiamondOrder *order, const Ground *ground) {
    const DiamondModel *model = order->model;
    if (pass->gpu && pass->model_id == model->id)
        return RESULT_OK;
    forget_model(pass);
    int64_t begin_ns = clock_now_ns();
    int64_t room = order->max_triangles + order->max_triangles / ROOM_BEYOND + ROOM_LEAST;
    Result result = diamond_gpu_create(model, room, pass->options.software, pass->options.wait, &pass->gpu);
    if (result != RESULT_OK)
        return result;
    if (!diamond_gpu_has_errors(pass->gpu))
        diamond_gpu_generate_errors(pass->gpu, NULL);
    glFinish(); // the first frame would wait for it anyway, and none other does
    pass->create_ms = (double)(clock_now_ns() - begin_ns) * 1e-6;
    pass->model_id = model->id;
    pass->origin = lattice_point(model->origin_ecef);
    pass->width = model->layout.width;
    pass->level_count = model->layout.level_count;
    pass->wet = ground_is_wet(ground, 0, 0, model->layout.width, model->layout.height);
    pass->room = diamond_gpu_triangles_max(pass->gpu);
    pass->budget.max_triangles = order->max_triangles < pass->room ? order->max_triangles : pass->room;
    return RESULT_OK;
}

// ---- the budget ----

static Result refine_at(DiamondPass *pass, const LodCut *cut, double tau_px) {
    const DiamondOrder *order = cut->resident;
    DiamondView view = order->view;
    if (tau_px > cut->view.tau_px) {
        DiamondView raised = diamond_view(order->model, &cut->view, tau_px, NULL);
        view.nu = raised.nu;
        view.tau_px = raised.tau_px;
    }
    Result result = diamond_gpu_evaluate(pass->gpu, order->program, &view);
    if (result != RESULT_OK)
        return result;
    diamond_gpu_close(pass->gpu);
    diamond_gpu_generate_indices(pass->gpu);
    pass->tolerances[diamond_gpu_generation(pass->gpu) % TOLERANCES] = tau_px;
    return RESULT_OK;
}

static void warn_over_room(DiamondPass *pass) {
    if (!pass->over_room)
        log_warn("%lld triangles of diamonds are wanted, there is room for %lld, and no more are drawn; raise the "
                 "tolerance, or --max-triangles",
                 (long long)pass->triangles, (long long)pass->room);
    pass->over_room = true;
}

typedef struct Counting {
    DiamondPass *pass;
    const LodCut *cut;
} Counting;

static Result count_at(void *user, double tau_px, LodStats *stats) {
    const Counting *counting = user;
    Result result = refine_at(counting->pass, counting->cut, tau_px);
    if (result == RESULT_OK)
        stats->triangles = diamond_gpu_count_now(counting->pass->gpu);
    return result;
}

static Result refine_now(DiamondPass *pass, const LodCut *cut) {
    Counting counting = {pass, cut};
    LodCut counted = {.view = cut->view, .reached_px = cut->view.tau_px};
    Result result = cut->resident->may_raise ? budget_refine(&pass->budget, count_at, &counting, &counted)
                                             : count_at(&counting, cut->view.tau_px, &counted.stats);
    pass->triangles = counted.stats.triangles;
    pass->tau_px = counted.reached_px;
    return result == RESULT_BUDGET ? RESULT_OK : result;
}

// What a generation's count says of the frames to come. One of another view says nothing of what fits this one.
static void learn(DiamondPass *pass, const LodCut *cut, uint64_t generation, int64_t triangles) {
    pass->triangles = triangles;
    pass->tau_px = pass->tolerances[generation % TOLERANCES];
    if (!cut->resident->may_raise)
        return;
    (void)budget_learn(&pass->budget, cut->view.tau_px, pass->tau_px, triangles);
    if (generation < pass->settled)
        pass->budget.overflow_px = 0.0;
}

// The count comes some frames later.
static Result refine_ahead(DiamondPass *pass, const LodCut *cut) {
    pass->tau_px = cut->resident->may_raise ? budget_begin(&pass->budget, &cut->view) : cut->view.tau_px;
    Result result = refine_at(pass, cut, pass->tau_px);
    if (result != RESULT_OK)
        return result;
    if (!pass->budget.still)
        pass->settled = diamond_gpu_generation(pass->gpu);
    uint64_t generation = 0;
    int64_t triangles = diamond_gpu_count_ready(pass->gpu, &generation);
    if (triangles >= 0)
        learn(pass, cut, generation, triangles);
    return RESULT_OK;
}

static Result refine(DiamondPass *pass, const LodCut *cut) {
    Result result = pass->options.wait ? refine_now(pass, cut) : refine_ahead(pass, cut);
    if (result != RESULT_OK)
        return result;
    if (pass->triangles > pass->room)
        warn_over_room(pass);
    return RESULT_OK;
}

static void upload_draw_block(const DiamondPass *pass, const Frame *frame) {
    const int32_t rebuilt = LOD_ITEM_REBUILT << 8; // as shaders/tint.glsl has it
    FrameOffset offset = frame_offset(frame, pass->origin);
    const DiamondDrawBlock block = {.origin_lo = {offset.lo[0], offset.lo[1], offset.lo[2], pass->width},
                                    .origin_hi = {offset.hi[0], offset.hi[1], offset.hi[2], rebuilt},
                                    .levels = {2 * pass->level_count}};
    glNamedBufferSubData(pass->draw_block, 0, sizeof block, &block);
}

void diamond_pass_prepare(DiamondPass *pass, const Frame *frame, const Ground *ground, const LodCut *cut) {
    pass->refused = cut->resident && cut->resident->model->id == pass->refused_id;
    if (!cut->resident || pass->refused) {
        forget_model(pass);
        return;
    }
    Result result = take_model(pass, cut->resident, ground);
    if (result == RESULT_OK)
        result = refine(pass, cut);
    if (result == RESULT_OK) {
        upload_draw_block(pass, frame);
        return;
    }
    forget_model(pass);
    pass->refused_id = cut->resident->model->id;
    pass->refused = true;
}

// ---- drawing ----

// 0, and a message, where it cannot be made.
static GLuint have_program(const ShaderSpec *spec, GLuint *program) {
    if (!*program && shader_create_program(spec, program) != RESULT_OK)
        *program = 0;
    return *program;
}

static GLuint land_program(DiamondPass *pass, bool shaded) {
    char defines[96];
    snprintf(defines, sizeof defines, "%s%s%s", pass->options.defines, pass->wet ? " WATER" : "",
             shaded ? " SHADED" : "");
    const ShaderSpec spec = {.stages = {"diamond_terrain.vert", "terrain.frag"}, .defines = defines};
    return have_program(&spec, &pass->land_programs[shaded]);
}

static GLuint level_program(DiamondPass *pass, bool shaded) {
    char defines[96];
    snprintf(defines, sizeof defines, "%s%s", pass->options.defines, shaded ? " SHADED" : "");
    const ShaderSpec spec = {.stages = {"diamond_terrain.vert", "diamond_level.geom", "terrain.frag"},
                             .defines = defines};
    return have_program(&spec, &pass->level_programs[shaded]);
}

static void draw_with(const DiamondPass *pass, GLuint program) {
    if (!program)
        return;
    glUseProgram(program);
    glBindBufferBase(GL_UNIFORM_BUFFER, DRAW_BLOCK_BINDING, pass->draw_block);
    diamond_gpu_draw(pass->gpu);
}

void diamond_pass_draw(DiamondPass *pass, RenderColouring colouring, bool shaded) {
    if (pass->gpu)
        draw_with(pass, colouring == RENDER_COLOUR_LEVEL ? level_program(pass, shaded) : land_program(pass, shaded));
}

void diamond_pass_draw_wire(DiamondPass *pass) {
    const ShaderSpec spec = {.stages = {"diamond_terrain.vert", "wire.geom", "wire.frag"}};
    if (pass->gpu)
        draw_with(pass, have_program(&spec, &pass->wire_program));
}

void diamond_pass_count(const DiamondPass *pass, RenderCutStats *stats) {
    stats->resident.refused = pass->refused;
    if (!pass->gpu)
        return;
    stats->draws = 1;
    stats->patches_drawn = 1;
    bool whole = pass->triangles <= pass->room;
    stats->triangles_drawn = whole ? pass->triangles : pass->room;
    stats->resident = (RenderResident){.made = true,
                                       .create_ms = pass->create_ms,
                                       .triangles = stats->triangles_drawn,
                                       .reached_px = whole ? pass->tau_px : (double)INFINITY,
                                       .evaluate_ms = diamond_gpu_ms(pass->gpu, DIAMOND_PHASE_EVALUATE),
                                       .close_ms = diamond_gpu_ms(pass->gpu, DIAMOND_PHASE_CLOSE),
                                       .indices_ms = diamond_gpu_ms(pass->gpu, DIAMOND_PHASE_INDICES)};
}

size_t diamond_pass_bytes(const DiamondPass *pass) {
    return pass->gpu ? diamond_gpu_bytes(pass->gpu) : 0;
}
