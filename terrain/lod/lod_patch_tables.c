// The tables of a PatchSeam. Spheres of patches: as in Loeffler, Schwanke, Schumann 2010, section 4.1, but a patch
// whose page holds all forced vertices need not split, which the hybrid method's patches do.
#include "terrain/lod/lod_patch_tables.h"

#include "base/log.h"
#include "terrain/terrain_parts.h"

#include <math.h>
#include <stdlib.h>

// Tiles narrower than so many pages are remainder: as strips of static patches, which can not be coarser than their
// tile, they would be most of what is drawn.
#define STATIC_PAGES 4

bool seam_list_add(SeamList *list, int32_t sample) {
    if (list->count == list->capacity) {
        int32_t larger = list->capacity ? list->capacity * 2 : 256;
        int32_t *grown = realloc(list->samples, sizeof *grown * (size_t)larger);
        if (!grown)
            return false;
        list->samples = grown;
        list->capacity = larger;
    }
    list->samples[list->count++] = sample;
    return true;
}

size_t seam_plane_entry(const PatchSeam *seam, int plane, int32_t col, int32_t row) {
    const PatchPlane *p = &seam->terrain->patches.planes[plane];
    int k = __builtin_ctz((unsigned)p->step);
    return (size_t)(row >> k) * (size_t)p->width + (size_t)(col >> k);
}

// Tiles around a sample -----------------------------------------------------------------------------------------

static int32_t side_at(const PatchSeam *seam, int32_t col, int32_t row) {
    int32_t square = square_grid_at(&seam->squares, col, row);
    return square < 0 ? 0 : seam->tile_sides[square];
}

// The largest tile around a sample, and whether one of them is remainder.
typedef struct Around {
    int32_t side;
    bool remainder;
} Around;

static Around around(const PatchSeam *seam, int32_t col, int32_t row) {
    Around found = {0, false};
    for (int c = 0; c < 4; c++) {
        int32_t side = side_at(seam, col - (c & 1), row - (c >> 1));
        found.side = side > found.side ? side : found.side;
        found.remainder = found.remainder || (side > 0 && side < seam->static_side);
    }
    return found;
}

// Spheres ------------------------------------------------------------------------------------------------------

typedef struct Spheres { // of one plane
    const PatchSeam *seam;
    int plane;
    double reach_m; // no sample within a patch of this plane lies farther from its middle
} Spheres;

static double widest_cell_m(const Terrain *terrain) {
    GridBounds bounds = grid_bounds(terrain->grid, 0, terrain->dem->height - 1, 0.0);
    return fmax(bounds.across_m, bounds.down_m);
}

static double range_m(const Terrain *terrain) {
    const float *h = terrain->dem->height_m;
    float low = h[0], high = h[0];
    for (size_t i = 1; i < (size_t)terrain->dem->width * (size_t)terrain->dem->height; i++) {
        low = h[i] < low ? h[i] : low;
        high = h[i] > high ? h[i] : high;
    }
    return (double)high - (double)low;
}

static void include(const Spheres *s, const PatchVertex *own, SeamSphere *sphere, int plane, int i, int j) {
    const PatchPlane *p = &s->seam->terrain->patches.planes[plane];
    if (i < 0 || j < 0 || i >= p->width || j >= p->height)
        return;
    int32_t side = around(s->seam, i * p->step, j * p->step).side;
    if (side < s->seam->static_side || side <= p->step) // no static patch splits there
        return;
    size_t at = (size_t)j * (size_t)p->width + (size_t)i;
    SeamSphere child = s->seam->spheres[plane][at];
    float reach = nextafterf((float)vec3d_distance(own->position, p->vertices[at].position) + child.radius, INFINITY);
    sphere->delta = fmaxf(sphere->delta, child.delta);
    sphere->radius = fmaxf(sphere->radius, reach * 1.000001f);
}

// Where patches split at a vertex: not towards smaller tiles.
static PatchReach reach_of(const PatchSeam *seam, int32_t col, int32_t row, int32_t step) {
    bool along_row = col / step & 1, along_col = row / step & 1;
    PatchReach within = PATCH_REACH_ALL;
    if (along_row && !along_col) {
        within.north = side_at(seam, col, row - 1) >= seam->static_side && side_at(seam, col, row - 1) > step;
        within.south = side_at(seam, col, row) >= seam->static_side && side_at(seam, col, row) > step;
    }
    if (along_col && !along_row) {
        within.west = side_at(seam, col - 1, row) >= seam->static_side && side_at(seam, col - 1, row) > step;
        within.east = side_at(seam, col, row) >= seam->static_side && side_at(seam, col, row) > step;
    }
    return within;
}

// Of a vertex that is forced to be active: what its patches lack, and what the patches below lack.
static SeamSphere sphere_of_forced(const Spheres *s, const PatchVertex *own, int i, int j) {
    const PatchSeam *seam = s->seam;
    int32_t step = seam->terrain->patches.planes[s->plane].step;
    PatchReach within = reach_of(seam, i * step, j * step, step);
    ErrorCodes missing = patch_forest_missing(&seam->terrain->errors, seam->side, s->plane, i, j, within);
    double radius = s->reach_m + (double)error_field_decode(missing.radius);
    SeamSphere sphere = {error_field_decode(missing.delta), nextafterf((float)radius, INFINITY)};
    for (int c = 0; c < 4; c++) {
        if (i & j & 1)
            include(s, own, &sphere, s->plane, i + (c == 0) - (c == 1), j + (c == 2) - (c == 3));
        else if (s->plane > 0)
            include(s, own, &sphere, s->plane - 1, 2 * i + (c & 1 ? 1 : -1), 2 * j + (c & 2 ? 1 : -1));
    }
    return sphere;
}

static void fill_row(const Spheres *s, int j, bool centres) {
    const PatchPlane *p = &s->seam->terrain->patches.planes[s->plane];
    for (int i = 0; i < p->width; i++) {
        if (!((i | j) & 1) || (i & j & 1) != centres)
            continue;
        size_t at = (size_t)j * (size_t)p->width + (size_t)i;
        const PatchVertex *own = &p->vertices[at];
        s->seam->spheres[s->plane][at] =
            isinf(own->delta) ? sphere_of_forced(s, own, i, j) : (SeamSphere){own->delta, own->radius};
    }
}

static void fill_spheres(const PatchSeam *seam) {
    const PatchForest *forest = &seam->terrain->patches;
    double cell = widest_cell_m(seam->terrain), range = range_m(seam->terrain);
    for (int plane = 0; plane < forest->plane_count; plane++) {
        Spheres s = {seam, plane, 2.0 * forest->planes[plane].step * cell + range};
        for (int centres = 0; centres < 2; centres++)
            for (int j = 0; j < forest->planes[plane].height; j++)
                fill_row(&s, j, centres);
    }
}

// Tiles and their borders --------------------------------------------------------------------------------------

static void note_tile(PatchSeam *seam, const ForestTile *tile) {
    int32_t part = tile->side < seam->squares.side_max ? tile->side : seam->squares.side_max;
    for (int32_t row = tile->row; row < tile->row + tile->side; row += part)
        for (int32_t col = tile->col; col < tile->col + tile->side; col += part)
            seam->tile_sides[square_grid_at(&seam->squares, col, row)] = tile->side;
}

static bool note_border(PatchSeam *seam, const ForestTile *tile, int32_t col, int32_t row) {
    if (!around(seam, col, row).remainder)
        return true;
    int32_t sample = row * seam->width + col, spacing = tile->side > seam->side ? tile->side / seam->side : 1;
    seam->marks[sample] |= SEAM_BORDER;
    return (col | row) % spacing || seam_list_add(&seam->shown, sample);
}

static bool note_corner(PatchSeam *seam, int32_t col, int32_t row) {
    int32_t step = (col | row) & -(col | row);
    bool within = step && step >= seam->side && step < around(seam, col, row).side;
    return !within || seam_list_add(&seam->corners, row * seam->width + col);
}

static bool note_borders(PatchSeam *seam, const ForestTile *tile) {
    bool kept = true;
    for (int32_t i = 0; i <= tile->side; i++) {
        kept = kept && note_border(seam, tile, tile->col + i, tile->row);
        kept = kept && note_border(seam, tile, tile->col + i, tile->row + tile->side);
        kept = kept && note_border(seam, tile, tile->col, tile->row + i);
        kept = kept && note_border(seam, tile, tile->col + tile->side, tile->row + i);
    }
    for (int c = 0; c < 4; c++)
        kept = kept && note_corner(seam, tile->col + (c & 1) * tile->side, tile->row + (c >> 1) * tile->side);
    return kept;
}

static bool allocate(PatchSeam *seam) {
    const PatchForest *forest = &seam->terrain->patches;
    seam->tile_sides = calloc((size_t)seam->squares.count, sizeof *seam->tile_sides);
    seam->marks = calloc((size_t)seam->width * (size_t)seam->height, 1);
    seam->touched = calloc((size_t)seam->squares.count, 1);
    bool all = seam->tile_sides && seam->marks && seam->touched;
    for (int plane = 0; plane < forest->plane_count; plane++) {
        size_t count = (size_t)forest->planes[plane].width * (size_t)forest->planes[plane].height;
        seam->split[plane] = calloc(count, 1);
        seam->spheres[plane] = calloc(count, sizeof *seam->spheres[plane]);
        all = all && seam->split[plane] && seam->spheres[plane];
    }
    return all;
}

static Result fill(PatchSeam *seam) {
    const Forest *forest = &seam->terrain->forest;
    Result result = square_grid_create(forest, 128, &seam->squares);
    if (result != RESULT_OK)
        return result;
    if (!allocate(seam))
        return RESULT_MEMORY;
    for (int32_t i = 0; i < forest->tile_count; i++)
        note_tile(seam, &forest->tiles[i]);
    for (int32_t i = 0; i < forest->tile_count; i++)
        if (seam_is_static(seam, &forest->tiles[i]) && !note_borders(seam, &forest->tiles[i]))
            return RESULT_MEMORY;
    fill_spheres(seam);
    return RESULT_OK;
}

Result seam_create(const Terrain *terrain, PatchSeam *out) {
    const Forest *forest = &terrain->forest;
    PatchSeam seam = {.terrain = terrain, .width = forest->width, .height = forest->height, .empty = true};
    seam.side = terrain->patches.side;
    seam.widest_step = (double)INT32_MAX / (3.0 * widest_cell_m(terrain) * GRID_LATTICE_PER_M);
    for (int32_t i = 0; i < forest->tile_count; i++)
        if (forest->tiles[i].side > seam.static_side)
            seam.static_side = forest->tiles[i].side;
    if (seam.static_side > STATIC_PAGES * seam.side)
        seam.static_side = STATIC_PAGES * seam.side;
    for (int32_t i = 0; i < forest->tile_count; i++)
        seam.empty = seam.empty && seam_is_static(&seam, &forest->tiles[i]);
    Result result = seam.empty ? RESULT_OK : fill(&seam);
    if (result != RESULT_OK) {
        seam_destroy(&seam);
        return result;
    }
    *out = seam;
    return RESULT_OK;
}

void seam_destroy(PatchSeam *seam) {
    square_grid_destroy(&seam->squares);
    free(seam->tile_sides);
    free(seam->marks);
    free(seam->touched);
    for (int plane = 0; plane < FOREST_LEVEL_MAX; plane++) {
        free(seam->split[plane]);
        free(seam->spheres[plane]);
    }
    for (int level = 0; level < SEAM_LEVELS; level++) {
        free(seam->vertices[level].samples);
        free(seam->patches[level].samples);
    }
    free(seam->shown.samples);
    free(seam->corners.samples);
    *seam = (PatchSeam){0};
}
