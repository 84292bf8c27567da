#include "render/diamond/diamond_pass.h"

#include "base/clock.h"
#include "base/log.h"
#include "render/gl.h"
#include "render/shader.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define DRAW_BLOCK_BINDING 7
// As terrain/lod/budget.c: above the budget the tolerance grows by this; it shrinks again when there is room.
#define RAISE 1.25
#define RAISE_FAST 4.0
#define FAR_ABOVE 8
#define LOWER 1.1
#define LOWER_BELOW 0.7
#define COARSEST_PX 1e12
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
    int64_t budget, room; // triangles: what is aimed at, and what can be drawn
    bool wet;
    GLuint land_program, level_program, wire_program; // 0 until they are called for
    GLuint draw_block;
    double raised_px;              // the tolerance that the budget forced; 0: none
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
    glDeleteProgram(self->land_program);
    glDeleteProgram(self->level_program);
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
    pass->raised_px = 0.0;
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
    pass->budget = order->max_triangles < pass->room ? order->max_triangles : pass->room;
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

static double raised(const DiamondPass *pass, double tau_px, int64_t triangles) {
    return tau_px * (triangles > FAR_ABOVE * pass->budget ? RAISE_FAST : RAISE);
}

// What a frame's count means for the tolerance of the next one.
static double next_raised(const DiamondPass *pass, double asked_px, double tau_px, int64_t triangles) {
    if (triangles > pass->budget)
        return tau_px <= COARSEST_PX ? raised(pass, tau_px, triangles) : tau_px;
    if (tau_px <= asked_px)
        return 0.0;
    return (double)triangles < LOWER_BELOW * (double)pass->budget ? tau_px / LOWER : tau_px;
}

static void warn_over_room(DiamondPass *pass) {
    if (!pass->over_room)
        log_warn("%lld triangles of diamonds are wanted, there is room for %lld, and no more are drawn; raise the "
                 "tolerance, or --max-triangles",
                 (long long)pass->triangles, (long long)pass->room);
    pass->over_room = true;
}

// Raises the tolerance until the triangles fit.
static Result refine_now(DiamondPass *pass, const LodCut *cut, double tau_px) {
    Result result = refine_at(pass, cut, tau_px);
    pass->triangles = result == RESULT_OK ? diamond_gpu_count_now(pass->gpu) : 0;
    while (cut->resident->may_raise && pass->triangles > pass->budget && tau_px <= COARSEST_PX) {
        tau_px = raised(pass, tau_px, pass->triangles);
        if ((result = refine_at(pass, cut, tau_px)) != RESULT_OK)
            return result;
        pass->triangles = diamond_gpu_count_now(pass->gpu);
    }
    pass->tau_px = tau_px;
    return result;
}

// The count comes some frames later.
static Result refine_ahead(DiamondPass *pass, const LodCut *cut, double tau_px) {
    Result result = refine_at(pass, cut, tau_px);
    uint64_t generation = 0;
    int64_t triangles = diamond_gpu_count_ready(pass->gpu, &generation);
    if (result == RESULT_OK && triangles >= 0) {
        pass->triangles = triangles;
        pass->tau_px = pass->tolerances[generation % TOLERANCES];
    }
    return result;
}

static Result refine(DiamondPass *pass, const LodCut *cut) {
    bool may_raise = cut->resident->may_raise;
    double asked = cut->view.tau_px, tau = may_raise ? fmax(asked, pass->raised_px) : asked;
    pass->tau_px = tau; // until more is known
    Result result = pass->options.wait ? refine_now(pass, cut, tau) : refine_ahead(pass, cut, tau);
    if (result != RESULT_OK)
        return result;
    if (pass->triangles > pass->room)
        warn_over_room(pass);
    pass->raised_px = may_raise ? next_raised(pass, asked, pass->tau_px, pass->triangles) : 0.0;
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

static GLuint land_program(DiamondPass *pass) {
    char defines[96];
    snprintf(defines, sizeof defines, "%s%s", pass->options.defines, pass->wet ? " WATER" : "");
    const ShaderSpec spec = {.stages = {"diamond_terrain.vert", "terrain.frag"}, .defines = defines};
    return have_program(&spec, &pass->land_program);
}

static GLuint level_program(DiamondPass *pass) {
    const ShaderSpec spec = {.stages = {"diamond_terrain.vert", "diamond_level.geom", "terrain.frag"},
                             .defines = pass->options.defines};
    return have_program(&spec, &pass->level_program);
}

static void draw_with(const DiamondPass *pass, GLuint program) {
    if (!program)
        return;
    glUseProgram(program);
    glBindBufferBase(GL_UNIFORM_BUFFER, DRAW_BLOCK_BINDING, pass->draw_block);
    diamond_gpu_draw(pass->gpu);
}

void diamond_pass_draw(DiamondPass *pass, RenderColouring colouring) {
    if (pass->gpu)
        draw_with(pass, colouring == RENDER_COLOUR_LEVEL ? level_program(pass) : land_program(pass));
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
