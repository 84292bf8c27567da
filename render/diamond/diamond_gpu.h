// render/diamond/diamond_gpu.h: a diamond model resident on the GPU, and the phases of terrain/diamond/diamond.h as
// compute shaders: generation, evaluation, closure, indices. The same bits as there. Needs a context, no Renderer.
// Metres; milliseconds by timer queries on hardware, by glFinish and the clock on a software renderer.
// A DiamondGpu owns its buffers and programs and copies what it needs of the model; thread of the context.
//
// Source: Yalcin, Weiss, De Floriani 2011, sections 4 to 8.
#pragma once
#include "base/base.h"
#include "terrain/diamond/diamond.h"

typedef enum DiamondPhase {
    DIAMOND_PHASE_GENERATE,
    DIAMOND_PHASE_EVALUATE,
    DIAMOND_PHASE_CLOSE,
    DIAMOND_PHASE_INDICES,
    DIAMOND_PHASE_COUNT
} DiamondPhase;

typedef struct DiamondGpu DiamondGpu;

// Whether this context has room for a terrain, and its positions fit into 32 bits. UNSUPPORTED, with `why`, static
// text.
MUST_USE Result diamond_gpu_check(const Terrain *terrain, const char **why);

// Uploads the model; errors too, if it has them. `triangles_max`: room for indices, less where the driver allows less.
// `wait`: each phase is finished and timed before its function returns; else times are those of frames before. DEVICE,
// MEMORY, NOT_FOUND, with a message.
MUST_USE Result diamond_gpu_create(const DiamondModel *model, int64_t triangles_max, bool software, bool wait,
                                   DiamondGpu **out);
void diamond_gpu_destroy(DiamondGpu **gpu);
int64_t diamond_gpu_triangles_max(const DiamondGpu *gpu);
size_t diamond_gpu_bytes(const DiamondGpu *gpu); // of all buffers
bool diamond_gpu_has_errors(const DiamondGpu *gpu);

// All depths. `depth_ms`: [2 * level_count], as diamond_level numbers them, each finished before the next; or NULL.
void diamond_gpu_generate_errors(DiamondGpu *gpu, double *depth_ms);
// DEVICE, MEMORY, NOT_FOUND: the predicate does not compile; UNSUPPORTED: the model has no field that it reads.
MUST_USE Result diamond_gpu_evaluate(DiamondGpu *gpu, const DiamondProgram *program, const DiamondView *view);
void diamond_gpu_fill(DiamondGpu *gpu, const uint32_t *bits); // [word_count], instead of an evaluation
void diamond_gpu_close(DiamondGpu *gpu);
// Of closed bits; not more triangles than there is room for.
void diamond_gpu_generate_indices(DiamondGpu *gpu);

// The triangles wanted by the last generation of indices, whether or not there was room; waits for it.
int64_t diamond_gpu_count_now(const DiamondGpu *gpu);
// The same of the newest generation that has left the GPU, without waiting; -1: none has yet. `generation`: which one,
// from 1.
int64_t diamond_gpu_count_ready(DiamondGpu *gpu, uint64_t *generation);
uint64_t diamond_gpu_generation(const DiamondGpu *gpu); // of indices, the last that was started; 0: none
double diamond_gpu_ms(const DiamondGpu *gpu, DiamondPhase phase);

// Binds positions and indices and draws the triangles of the last generation with the program that is bound: attributes
// 0, 1, 2 are x, y, z, lattice units from the model's origin; gl_VertexID is row * width + column.
void diamond_gpu_draw(const DiamondGpu *gpu);

// For tests: wait, and copy.
void diamond_gpu_read_bits(const DiamondGpu *gpu, uint32_t *bits);   // [word_count]
void diamond_gpu_read_errors(const DiamondGpu *gpu, float *error_m); // [DIAMOND_SLOTS * word_count]
void diamond_gpu_read_indices(const DiamondGpu *gpu, uint32_t *indices, int64_t triangles); // 3 each
