#include "render/diamond/diamond_upload.h"

#include "base/log.h"
#include "render/diamond/diamond_gpu.h"
#include "render/gl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define REACH_MAX_M 500e3 // 32 bits of lattice reach 524 km; the rest is for heights and the curve of the sides

static Result report_memory(void) {
    log_error("out of memory for the diamonds on their way to the GPU");
    return RESULT_MEMORY;
}

Result diamond_upload_squares(const DiamondModel *model, Storage *out) {
    size_t words = model->layout.word_count;
    uint32_t *squares = malloc(3 * words * sizeof *squares);
    if (!squares)
        return report_memory();
    memcpy(squares, model->reach_m, 2 * words * sizeof *squares);
    memcpy(squares + 2 * words, model->always, words * sizeof *squares);
    Result result = storage_create("diamonds: super-squares", squares, 3 * words * sizeof *squares, out);
    free(squares);
    return result;
}

Result diamond_upload_degrees(const DiamondModel *model, Storage *out) {
    size_t entries = DIAMOND_SLOTS * (size_t)model->layout.word_count;
    float *pairs = malloc(2 * entries * sizeof *pairs);
    if (!pairs)
        return report_memory();
    for (size_t i = 0; i < entries; i++) {
        pairs[2 * i] = model->east_deg[i];
        pairs[2 * i + 1] = model->north_deg[i];
    }
    Result result = storage_create("diamonds: degrees", pairs, 2 * entries * sizeof *pairs, out);
    free(pairs);
    return result;
}

static int64_t component(GridPoint p, int axis) {
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

static void fill_row(const DiamondModel *model, int32_t *const axes[3], int row) {
    const DiamondLayout *layout = &model->layout;
    const Grid *grid = terrain_grid(model->terrain);
    const double origin[3] = {model->origin_ecef.x, model->origin_ecef.y, model->origin_ecef.z};
    size_t at = (size_t)row * (size_t)layout->width;
    for (int col = 0; col < layout->width; col++, at++) {
        GridPoint p = grid_lattice(grid, col, row, (double)model->height_m[at]);
        for (int axis = 0; axis < 3; axis++)
            axes[axis][at] = (int32_t)(component(p, axis) - (int64_t)origin[axis] * GRID_LATTICE_PER_M);
    }
}

Result diamond_upload_vertices(const DiamondModel *model, Storage out[3]) {
    size_t samples = (size_t)model->layout.width * (size_t)model->layout.height;
    int32_t *memory = malloc(3 * samples * sizeof *memory);
    if (!memory)
        return report_memory();
    int32_t *const axes[3] = {memory, memory + samples, memory + 2 * samples};
    for (int row = 0; row < model->layout.height; row++)
        fill_row(model, axes, row);
    Result result = RESULT_OK;
    for (int axis = 0; axis < 3 && result == RESULT_OK; axis++)
        result = storage_create("diamonds: positions", axes[axis], samples * sizeof *memory, &out[axis]);
    free(memory);
    return result;
}

// ---- limits ----

static Vec3d sample_ecef(const Terrain *terrain, int col, int row) {
    const Dem *dem = terrain_dem(terrain);
    return grid_ecef(terrain_grid(terrain), col, row,
                     (double)dem->height_m[(size_t)row * (size_t)dem->width + (size_t)col]);
}

// The corners and the middles of the sides are the farthest from the middle.
static double reach_m(const Terrain *terrain) {
    const Dem *dem = terrain_dem(terrain);
    int half_width = dem->width / 2, half_height = dem->height / 2;
    Vec3d middle = sample_ecef(terrain, half_width, half_height);
    double most = 0.0;
    for (int i = 0; i < 9; i++) {
        int col = i % 3 * half_width, row = i / 3 * half_height;
        col = col < dem->width ? col : dem->width - 1;
        row = row < dem->height ? row : dem->height - 1;
        most = fmax(most, vec3d_distance(middle, sample_ecef(terrain, col, row)));
    }
    return most;
}

Result diamond_gpu_check(const Terrain *terrain, const char **why) {
    const Dem *dem = terrain_dem(terrain);
    GLint blocks = 0;
    glGetIntegerv(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, &blocks);
    DiamondLayout layout = diamond_layout(dem->width, dem->height, FOREST_LEVEL_MAX);
    size_t bytes = DIAMOND_SLOTS * sizeof(float) * (size_t)layout.word_count;
    *why = NULL;
    if (blocks < 8)
        *why = "the driver has fewer than 8 storage blocks for compute shaders";
    else if (bytes > storage_bytes_max())
        *why = "the driver's largest storage block cannot hold a number for each sample";
    else if (reach_m(terrain) > REACH_MAX_M)
        *why = "a sample is more than 500 km from the middle, too far for positions of 32 bits";
    return *why ? RESULT_UNSUPPORTED : RESULT_OK;
}
