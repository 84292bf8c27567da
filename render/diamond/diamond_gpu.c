// Yalcin, Weiss, De Floriani 2011, sections 4 to 8: all buffers stay on the GPU, the CPU only starts the phases. Ours:
// twelve arrays a super-square instead of a raster, so that neighbouring invocations read neighbouring words; closure
// without atomics; compacted indices and an indirect draw.
#include "render/diamond/diamond_gpu.h"

#include "base/log.h"
#include "render/diamond/diamond_program.h"
#include "render/diamond/diamond_upload.h"
#include "render/gl.h"
#include "render/shader.h"
#include "render/timing.h"

#include <stdlib.h>
#include <string.h>

// As shaders/diamond*.glsl and diamond*.comp have them.
enum { BLOCK_MODEL = 6, BLOCK_VIEW = 7 };
enum { BITS, DATUM, ERRORS, X, Y, Z, SQUARES, DEGREES, BINDINGS };
enum { HEIGHTS = 3, TERMS = 4 };   // generation
enum { INDICES = 6, COMMAND = 7 }; // indices
enum { UNIFORM_PLANE = 0, UNIFORM_FIRST_SLOT = 1, UNIFORM_SLOTS = 2, UNIFORM_BANDS = 3 };
enum { BAND_ROWS = 32 };
// From this step on a group of invocations shares a band of a diamond; a software renderer's invocations are few.
enum { GROUP_STEP_HARDWARE = 8, GROUP_STEP_SOFTWARE = 32 };

#define READBACKS 3

// std140, shaders/diamond.glsl.
typedef struct DiamondBlock {
    int32_t size[4];
    int32_t planes[16][4];
} DiamondBlock;
_Static_assert(DIAMOND_LEVEL_MAX <= 16, "as shaders/diamond.glsl has it");

// std140, shaders/diamond_view.glsl.
typedef struct DiamondViewBlock {
    float eye[4], lens[4];
    float planes[DIAMOND_PLANES][4];
    float constants[DIAMOND_CONSTANTS_MAX];
} DiamondViewBlock;

// As glDrawElementsIndirect reads it, and what shaders/diamond_indices.comp counts.
typedef struct DiamondCommand {
    uint32_t index_count, instance_count, first_index;
    int32_t base_vertex;
    uint32_t base_instance, triangles, triangles_max;
} DiamondCommand;

// A count on its way to the CPU.
typedef struct Readback {
    GLuint buffer;
    const uint32_t *mapped;
    GLsync fence;
    uint64_t generation;
} Readback;

struct DiamondGpu {
    DiamondLayout layout;
    unsigned fields; // of the model
    Storage storages[BINDINGS], heights, terms, indices, command, model_block, view_block;
    Storage vertices[3];
    GLuint vertex_array;
    GLuint errors_program, errors_group_program, close_edges, close_centres, indices_program;
    DiamondPrograms programs;
    Timing timings[DIAMOND_PHASE_COUNT];
    double ms[DIAMOND_PHASE_COUNT];
    Readback readbacks[READBACKS];
    uint64_t generation, ready_generation; // of indices
    int64_t ready;                         // count of the latter
    int64_t triangles_max;
    int group_step;
    bool wait, has_errors;
};

// ---- programs ----

static Result create_program(const char *file, const char *defines, GLuint *out) {
    const ShaderSpec spec = {.stages = {file}, .defines = defines};
    return shader_create_program(&spec, out);
}

static Result create_programs(DiamondGpu *gpu) {
    Result result = create_program("diamond_errors.comp", NULL, &gpu->errors_program);
    if (result == RESULT_OK)
        result = create_program("diamond_errors.comp", "BY_GROUP", &gpu->errors_group_program);
    if (result == RESULT_OK)
        result = create_program("diamond_close.comp", "EDGES_OF_PLANE", &gpu->close_edges);
    if (result == RESULT_OK)
        result = create_program("diamond_close.comp", "CENTRES_OF_ALL", &gpu->close_centres);
    if (result == RESULT_OK)
        result = create_program("diamond_indices.comp", NULL, &gpu->indices_program);
    return result;
}

// ---- buffers ----

static DiamondBlock block_of(const DiamondLayout *layout) {
    DiamondBlock block = {.size = {layout->width, layout->height, layout->level_count, (int32_t)layout->word_count}};
    for (int k = 0; k < layout->level_count; k++) {
        block.planes[k][0] = (int32_t)layout->offset[k];
        block.planes[k][1] = (int32_t)layout->across[k];
        block.planes[k][2] = (int32_t)layout->down[k];
        block.planes[k][3] = (int32_t)layout->row_offset[k];
    }
    return block;
}

static int64_t room_for(const DiamondLayout *layout, int64_t triangles_max) {
    int64_t all = 2 * (int64_t)(layout->width - 1) * (layout->height - 1);
    int64_t allowed = (int64_t)(storage_bytes_max() / (3 * sizeof(uint32_t)));
    int64_t room = triangles_max < all ? triangles_max : all;
    return room < allowed ? room : allowed;
}

static Result create_work_buffers(DiamondGpu *gpu) {
    const DiamondLayout *layout = &gpu->layout;
    const DiamondBlock block = block_of(layout);
    size_t words = layout->word_count, entries = DIAMOND_SLOTS * words;
    Result result = storage_create("diamonds: layout", &block, sizeof block, &gpu->model_block);
    if (result == RESULT_OK)
        result = storage_create("diamonds: view", NULL, sizeof(DiamondViewBlock), &gpu->view_block);
    if (result == RESULT_OK)
        result = storage_create("diamonds: split bits", NULL, words * sizeof(uint32_t), &gpu->storages[BITS]);
    if (result == RESULT_OK)
        result = storage_create("diamonds: errors", NULL, entries * sizeof(float), &gpu->storages[ERRORS]);
    if (result == RESULT_OK)
        result =
            storage_create("diamonds: indices", NULL, (size_t)gpu->triangles_max * 3 * sizeof(uint32_t), &gpu->indices);
    if (result == RESULT_OK)
        result = storage_create("diamonds: draw command", NULL, sizeof(DiamondCommand), &gpu->command);
    return result;
}

static Result upload_model(DiamondGpu *gpu, const DiamondModel *model) {
    Storage *s = gpu->storages;
    size_t entries = DIAMOND_SLOTS * (size_t)model->layout.word_count * sizeof(float);
    size_t samples = (size_t)model->layout.width * (size_t)model->layout.height;
    Result result = storage_create("diamonds: x", model->x, entries, &s[X]);
    if (result == RESULT_OK)
        result = storage_create("diamonds: y", model->y, entries, &s[Y]);
    if (result == RESULT_OK)
        result = storage_create("diamonds: z", model->z, entries, &s[Z]);
    if (result == RESULT_OK)
        result = storage_create("diamonds: heights", model->height_m, samples * sizeof(float), &gpu->heights);
    if (result == RESULT_OK)
        result =
            storage_create("diamonds: rows", model->terms, model->layout.row_count * sizeof(DiamondTerms), &gpu->terms);
    if (result == RESULT_OK && model->datum_m)
        result = storage_create("diamonds: datum", model->datum_m, entries, &s[DATUM]);
    if (result == RESULT_OK)
        result = diamond_upload_squares(model, &s[SQUARES]);
    if (result == RESULT_OK && model->east_deg)
        result = diamond_upload_degrees(model, &s[DEGREES]);
    return result == RESULT_OK ? diamond_upload_vertices(model, gpu->vertices) : result;
}

static void upload_errors(DiamondGpu *gpu, const DiamondModel *model) {
    gpu->fields = (model->datum_m ? DIAMOND_FIELD_DATUM : 0) | (model->east_deg ? DIAMOND_FIELD_DEGREES : 0);
    gpu->has_errors = model->error_m != NULL;
    const Storage *errors = &gpu->storages[ERRORS];
    if (gpu->has_errors)
        glNamedBufferSubData(errors->buffer, 0, (GLsizeiptr)errors->bytes, model->error_m);
}

static void create_vertex_array(DiamondGpu *gpu) {
    glCreateVertexArrays(1, &gpu->vertex_array);
    for (GLuint i = 0; i < COUNT_OF(gpu->vertices); i++) {
        glVertexArrayAttribIFormat(gpu->vertex_array, i, 1, GL_INT, 0);
        glEnableVertexArrayAttrib(gpu->vertex_array, i);
        glVertexArrayAttribBinding(gpu->vertex_array, i, i);
        glVertexArrayVertexBuffer(gpu->vertex_array, i, gpu->vertices[i].buffer, 0, sizeof(int32_t));
    }
    glVertexArrayElementBuffer(gpu->vertex_array, gpu->indices.buffer);
}

static Result create_readbacks(DiamondGpu *gpu) {
    const GLbitfield flags = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    for (int i = 0; i < READBACKS; i++) {
        Readback *readback = &gpu->readbacks[i];
        glCreateBuffers(1, &readback->buffer);
        glNamedBufferStorage(readback->buffer, sizeof(uint32_t), NULL, flags);
        readback->mapped = glMapNamedBufferRange(readback->buffer, 0, sizeof(uint32_t), flags);
        if (!readback->mapped) {
            log_error("diamonds: the driver maps no buffer for their count; fly with --compute cpu");
            return RESULT_DEVICE;
        }
    }
    return RESULT_OK;
}

Result diamond_gpu_create(const DiamondModel *model, int64_t triangles_max, bool software, bool wait,
                          DiamondGpu **out) {
    DiamondGpu *gpu = calloc(1, sizeof *gpu);
    if (!gpu) {
        log_error("out of memory for the diamonds of the GPU");
        return RESULT_MEMORY;
    }
    gpu->layout = model->layout;
    gpu->wait = wait;
    gpu->group_step = software ? GROUP_STEP_SOFTWARE : GROUP_STEP_HARDWARE;
    gpu->ready = -1;
    gpu->triangles_max = room_for(&model->layout, triangles_max);
    for (int i = 0; i < DIAMOND_PHASE_COUNT; i++)
        gpu->timings[i] = timing_create(software);
    Result result = create_programs(gpu);
    if (result == RESULT_OK)
        result = create_work_buffers(gpu);
    if (result == RESULT_OK)
        result = upload_model(gpu, model);
    if (result == RESULT_OK)
        result = create_readbacks(gpu);
    if (result != RESULT_OK) {
        diamond_gpu_destroy(&gpu);
        return result;
    }
    upload_errors(gpu, model);
    create_vertex_array(gpu);
    *out = gpu;
    return RESULT_OK;
}

static void destroy_readbacks(DiamondGpu *gpu) {
    for (int i = 0; i < READBACKS; i++) {
        if (gpu->readbacks[i].mapped)
            glUnmapNamedBuffer(gpu->readbacks[i].buffer);
        glDeleteSync(gpu->readbacks[i].fence);
        glDeleteBuffers(1, &gpu->readbacks[i].buffer);
    }
}

static Storage *every_storage(DiamondGpu *gpu, size_t i) {
    Storage *others[] = {&gpu->heights,    &gpu->terms,       &gpu->indices,     &gpu->command,    &gpu->model_block,
                         &gpu->view_block, &gpu->vertices[0], &gpu->vertices[1], &gpu->vertices[2]};
    if (i < BINDINGS)
        return &gpu->storages[i];
    return i - BINDINGS < COUNT_OF(others) ? others[i - BINDINGS] : NULL;
}

void diamond_gpu_destroy(DiamondGpu **gpu) {
    DiamondGpu *self = *gpu;
    if (!self)
        return;
    Storage *storage;
    for (size_t i = 0; (storage = every_storage(self, i)) != NULL; i++)
        storage_destroy(storage);
    glDeleteVertexArrays(1, &self->vertex_array);
    const GLuint programs[] = {self->errors_program, self->errors_group_program, self->close_edges, self->close_centres,
                               self->indices_program};
    for (size_t i = 0; i < COUNT_OF(programs); i++)
        glDeleteProgram(programs[i]);
    diamond_programs_destroy(&self->programs);
    destroy_readbacks(self);
    for (int i = 0; i < DIAMOND_PHASE_COUNT; i++)
        timing_destroy(&self->timings[i]);
    free(self);
    *gpu = NULL;
}

int64_t diamond_gpu_triangles_max(const DiamondGpu *gpu) {
    return gpu->triangles_max;
}

size_t diamond_gpu_bytes(const DiamondGpu *gpu) {
    size_t bytes = 0;
    const Storage *storage;
    for (size_t i = 0; (storage = every_storage((DiamondGpu *)(uintptr_t)gpu, i)) != NULL; i++)
        bytes += storage->bytes;
    return bytes;
}

bool diamond_gpu_has_errors(const DiamondGpu *gpu) {
    return gpu->has_errors;
}

// ---- the phases ----

static void begin_phase(DiamondGpu *gpu, DiamondPhase phase) {
    timing_begin(&gpu->timings[phase]);
    glBindBufferBase(GL_UNIFORM_BUFFER, BLOCK_MODEL, gpu->model_block.buffer);
    storage_bind(&gpu->storages[BITS], BITS);
}

static void end_phase(DiamondGpu *gpu, DiamondPhase phase) {
    storage_barrier();
    gpu->ms[phase] = timing_end(&gpu->timings[phase], gpu->wait);
}

static int64_t plane_words(const DiamondLayout *layout, int plane) {
    return (int64_t)layout->across[plane] * layout->down[plane];
}

// The centres or the edge midpoints of a plane.
static void generate_depth(const DiamondGpu *gpu, int plane, bool centres) {
    int step = 1 << plane, slots = centres ? DIAMOND_CENTRE_SLOTS : DIAMOND_SLOTS - DIAMOND_CENTRE_SLOTS;
    bool by_group = step >= gpu->group_step;
    int bands = by_group ? (2 * step + BAND_ROWS) / BAND_ROWS : 1;
    glUseProgram(by_group ? gpu->errors_group_program : gpu->errors_program);
    glUniform1i(UNIFORM_PLANE, plane);
    glUniform1i(UNIFORM_FIRST_SLOT, centres ? 0 : DIAMOND_CENTRE_SLOTS);
    glUniform1i(UNIFORM_SLOTS, slots);
    glUniform1i(UNIFORM_BANDS, bands);
    storage_dispatch(plane_words(&gpu->layout, plane) * slots * bands * (by_group ? STORAGE_GROUP : 1));
}

void diamond_gpu_generate_errors(DiamondGpu *gpu, double *depth_ms) {
    double total_ms = 0.0;
    Timing *timing = &gpu->timings[DIAMOND_PHASE_GENERATE];
    storage_clear(&gpu->storages[ERRORS]); // maxima begin at 0
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    glBindBufferBase(GL_UNIFORM_BUFFER, BLOCK_MODEL, gpu->model_block.buffer);
    storage_bind(&gpu->storages[BITS], BITS);
    storage_bind(&gpu->storages[ERRORS], ERRORS);
    storage_bind(&gpu->storages[SQUARES], SQUARES);
    storage_bind(&gpu->heights, HEIGHTS);
    storage_bind(&gpu->terms, TERMS);
    for (int depth = 0; depth < 2 * gpu->layout.level_count; depth++) {
        timing_begin(timing);
        generate_depth(gpu, gpu->layout.level_count - 1 - depth / 2, depth % 2 == 0);
        storage_barrier();
        double ms = timing_end(timing, gpu->wait || depth_ms);
        total_ms += ms;
        if (depth_ms)
            depth_ms[depth] = ms;
    }
    gpu->ms[DIAMOND_PHASE_GENERATE] = total_ms;
    gpu->has_errors = true;
}

static void upload_view(const DiamondGpu *gpu, const DiamondProgram *program, const DiamondView *view) {
    DiamondViewBlock block = {.eye = {view->eye[0], view->eye[1], view->eye[2], view->nu},
                              .lens = {view->slack_m, view->px_per_rad, view->tau_px}};
    for (int i = 0; i < DIAMOND_PLANES; i++)
        memcpy(block.planes[i], view->plane[i], sizeof view->plane[i]);
    memcpy(block.constants, program->constants, sizeof(float) * (size_t)program->constant_count);
    glNamedBufferSubData(gpu->view_block.buffer, 0, sizeof block, &block);
    glBindBufferBase(GL_UNIFORM_BUFFER, BLOCK_VIEW, gpu->view_block.buffer);
}

Result diamond_gpu_evaluate(DiamondGpu *gpu, const DiamondProgram *program, const DiamondView *view) {
    if (diamond_program_fields(program) & ~gpu->fields) {
        log_error("diamonds: the predicate reads heights or degrees that this model was made without");
        return RESULT_UNSUPPORTED;
    }
    GLuint compiled = 0;
    Result result = diamond_programs_find(&gpu->programs, program, &compiled);
    if (result != RESULT_OK)
        return result;
    begin_phase(gpu, DIAMOND_PHASE_EVALUATE);
    upload_view(gpu, program, view);
    for (unsigned i = 0; i < BINDINGS; i++)
        storage_bind(&gpu->storages[i], i);
    glUseProgram(compiled);
    storage_dispatch(gpu->layout.word_count);
    end_phase(gpu, DIAMOND_PHASE_EVALUATE);
    return RESULT_OK;
}

void diamond_gpu_fill(DiamondGpu *gpu, const uint32_t *bits) {
    glNamedBufferSubData(gpu->storages[BITS].buffer, 0, (GLsizeiptr)gpu->storages[BITS].bytes, bits);
}

// Edge midpoints plane after plane; a barrier between, because each reads what the one before wrote. The centres of
// all planes in the end, at once: nobody reads them.
void diamond_gpu_close(DiamondGpu *gpu) {
    begin_phase(gpu, DIAMOND_PHASE_CLOSE);
    glUseProgram(gpu->close_edges);
    for (int plane = 1; plane < gpu->layout.level_count; plane++) {
        glUniform1i(UNIFORM_PLANE, plane);
        storage_dispatch(plane_words(&gpu->layout, plane));
        storage_barrier();
    }
    glUseProgram(gpu->close_centres);
    storage_dispatch(gpu->layout.word_count);
    end_phase(gpu, DIAMOND_PHASE_CLOSE);
}

static void reset_command(const DiamondGpu *gpu) {
    const DiamondCommand command = {.instance_count = 1, .triangles_max = (uint32_t)gpu->triangles_max};
    glNamedBufferSubData(gpu->command.buffer, 0, sizeof command, &command);
}

// Takes the count of a generation whose slot is free to be read.
static void take_ready(DiamondGpu *gpu, Readback *readback) {
    gpu->ready = *readback->mapped;
    gpu->ready_generation = readback->generation;
    glDeleteSync(readback->fence);
    readback->fence = NULL;
}

static void start_readback(DiamondGpu *gpu) {
    Readback *readback = &gpu->readbacks[++gpu->generation % READBACKS];
    if (readback->fence) { // three generations ago: it is as good as done
        glClientWaitSync(readback->fence, GL_SYNC_FLUSH_COMMANDS_BIT, GL_TIMEOUT_IGNORED);
        take_ready(gpu, readback);
    }
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
    glCopyNamedBufferSubData(gpu->command.buffer, readback->buffer, offsetof(DiamondCommand, triangles), 0,
                             sizeof(uint32_t));
    readback->generation = gpu->generation;
    readback->fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}

void diamond_gpu_generate_indices(DiamondGpu *gpu) {
    begin_phase(gpu, DIAMOND_PHASE_INDICES);
    reset_command(gpu);
    storage_bind(&gpu->indices, INDICES);
    storage_bind(&gpu->command, COMMAND);
    glUseProgram(gpu->indices_program);
    storage_dispatch(gpu->layout.word_count);
    glMemoryBarrier(GL_ELEMENT_ARRAY_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    end_phase(gpu, DIAMOND_PHASE_INDICES);
    start_readback(gpu);
}

// ---- results ----

int64_t diamond_gpu_count_now(const DiamondGpu *gpu) {
    DiamondCommand command;
    storage_read(&gpu->command, &command, sizeof command);
    return command.triangles;
}

int64_t diamond_gpu_count_ready(DiamondGpu *gpu, uint64_t *generation) {
    for (uint64_t g = gpu->ready_generation + 1; g <= gpu->generation; g++) {
        Readback *readback = &gpu->readbacks[g % READBACKS];
        if (glClientWaitSync(readback->fence, GL_SYNC_FLUSH_COMMANDS_BIT, 0) == GL_TIMEOUT_EXPIRED)
            break;
        take_ready(gpu, readback);
    }
    *generation = gpu->ready_generation;
    return gpu->ready;
}

uint64_t diamond_gpu_generation(const DiamondGpu *gpu) {
    return gpu->generation;
}

double diamond_gpu_ms(const DiamondGpu *gpu, DiamondPhase phase) {
    return gpu->ms[phase];
}

void diamond_gpu_draw(const DiamondGpu *gpu) {
    glBindVertexArray(gpu->vertex_array);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, gpu->command.buffer);
    glDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, NULL);
    glBindVertexArray(0);
}

void diamond_gpu_read_bits(const DiamondGpu *gpu, uint32_t *bits) {
    storage_read(&gpu->storages[BITS], bits, gpu->storages[BITS].bytes);
}

void diamond_gpu_read_errors(const DiamondGpu *gpu, float *error_m) {
    storage_read(&gpu->storages[ERRORS], error_m, gpu->storages[ERRORS].bytes);
}

void diamond_gpu_read_indices(const DiamondGpu *gpu, uint32_t *indices, int64_t triangles) {
    storage_read(&gpu->indices, indices, (size_t)triangles * 3 * sizeof(uint32_t));
}
