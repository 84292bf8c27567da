// terrain/geomipmap/geomip_tiles.c: de Boer 2000: the terrain in square tiles. Who touches whom, how coarse each may
// get beside smaller ones and around holes, and boxes around their samples.
#include "terrain/geomipmap/geomip_tiles.h"

#include "terrain/geodesy.h"
#include "terrain/geomipmap/geomip_error.h"
#include "terrain/terrain_parts.h"

#include <stdlib.h>

GeomipFrame geomip_frame(Vec3d p) {
    Vec3d up = vec3d_normalize(vec3d(p.x, p.y, p.z / (1.0 - GEODESY_E2)));
    Vec3d east = vec3d_normalize(vec3d(-p.y, p.x, 0.0));
    if (vec3d_length(east) == 0.0) // at a pole
        east = vec3d(0.0, 1.0, 0.0);
    Vec3d north = vec3d_normalize(vec3d_cross(up, east));
    return (GeomipFrame){{vec3d_cross(north, up), north, up}};
}

// ---- who touches whom ----

static int least(int a, int b) {
    return a < b ? a : b;
}

// The square beyond a place of a side.
static int32_t beyond(const SquareGrid *grid, const ForestTile *square, int side, int t) {
    bool flat = side == GEOMIP_NORTH || side == GEOMIP_SOUTH;
    int along = side == GEOMIP_NORTH || side == GEOMIP_EAST ? t : square->side - 1 - t; // turned cells are one off
    int across = side == GEOMIP_NORTH || side == GEOMIP_WEST ? -1 : square->side;
    return square_grid_at(grid, square->col + (flat ? along : across), square->row + (flat ? across : along));
}

// Calls for each piece of the tile's border; `links` NULL: counts only.
static int32_t visit_links(const SquareGrid *grid, int32_t tile, GeomipLink *links) {
    const ForestTile *square = &grid->squares[tile];
    int32_t count = 0;
    for (int side = 0; side < GEOMIP_SIDES; side++) {
        for (int t = 0; t < square->side; count++) {
            int32_t other = beyond(grid, square, side, t);
            int length = other < 0 ? square->side : least(square->side, grid->squares[other].side);
            if (links)
                links[count] = (GeomipLink){other, (int16_t)t, (int16_t)(t + length), (uint8_t)side};
            t += length;
        }
    }
    return count;
}

static Result create_links(GeomipTiles *out) {
    int32_t count = 0;
    for (int32_t i = 0; i < out->squares.count; i++) {
        out->tiles[i].first_link = count;
        count += visit_links(&out->squares, i, NULL);
    }
    out->tiles[out->squares.count].first_link = count;
    out->links = malloc(sizeof *out->links * (size_t)count);
    if (!out->links)
        return RESULT_MEMORY;
    for (int32_t i = 0; i < out->squares.count; i++)
        (void)visit_links(&out->squares, i, out->links + out->tiles[i].first_link);
    return RESULT_OK;
}

// ---- the coarsest level ----

// A hole is to show in the shape of its samples: the cells around it are drawn one by one, in every tile that has one.
static bool has_hole_near(const Dem *dem, const ForestTile *square) {
    if (!dem->void_bits)
        return false;
    for (int row = square->row - 1; row <= square->row + square->side + 1; row++)
        for (int col = square->col - 1; col <= square->col + square->side + 1; col++)
            if (col >= 0 && row >= 0 && col < dem->width && row < dem->height && dem_is_void(dem, col, row))
                return true;
    return false;
}

// The ends of every piece of border have to be vertices.
static int cap_of(const GeomipTiles *tiles, int32_t tile) {
    if (has_hole_near(terrain_dem(tiles->terrain), &tiles->squares.squares[tile]))
        return 0;
    int shortest = tiles->squares.squares[tile].side;
    for (int32_t k = tiles->tiles[tile].first_link; k < tiles->tiles[tile + 1].first_link; k++)
        shortest = least(shortest, tiles->links[k].end - tiles->links[k].begin);
    return __builtin_ctz((unsigned)shortest);
}

// ---- places ----

static Vec3d centre_of(const Terrain *terrain, const ForestTile *square) {
    int half = square->side / 2;
    if (half)
        return terrain_ecef(terrain, square->col + half, square->row + half);
    return vec3d_scale(vec3d_add(terrain_ecef(terrain, square->col, square->row),
                                 terrain_ecef(terrain, square->col + 1, square->row + 1)),
                       0.5);
}

static void fill_box(const Terrain *terrain, const ForestTile *square, GeomipTile *tile) {
    GeomipFrame frame = geomip_frame(tile->centre_ecef);
    double low[3] = {0}, high[3] = {0};
    for (int row = square->row; row <= square->row + square->side; row++) {
        for (int col = square->col; col <= square->col + square->side; col++) {
            Vec3d p = vec3d_sub(terrain_ecef(terrain, col, row), tile->centre_ecef);
            for (int k = 0; k < 3; k++) {
                double x = vec3d_dot(p, frame.axis[k]);
                low[k] = x < low[k] ? x : low[k];
                high[k] = x > high[k] ? x : high[k];
            }
        }
    }
    for (int k = 0; k < 3; k++) { // outwards, by more than the rounding to float
        tile->low[k] = (float)(low[k] * (1.0 + 1e-6) - 1e-3);
        tile->high[k] = (float)(high[k] * (1.0 + 1e-6) + 1e-3);
    }
}

// ---- all tiles ----

typedef struct Filling {
    const GeomipInput *input;
    GeomipTiles *tiles;
    float h_max_m;
} Filling;

static void fill_tiles(void *user, int64_t begin, int64_t end, int worker) {
    const Filling *f = user;
    (void)worker;
    for (int64_t i = begin; i < end; i++) {
        const ForestTile *square = &f->tiles->squares.squares[i];
        GeomipTile *tile = &f->tiles->tiles[i];
        tile->log_side = (int8_t)__builtin_ctz((unsigned)square->side);
        tile->cap = (int8_t)cap_of(f->tiles, (int32_t)i);
        tile->centre_ecef = centre_of(f->input->terrain, square);
        if (f->input->bounds)
            fill_box(f->input->terrain, square, tile);
        geomip_error_fill(f->tiles, f->input, f->h_max_m, (int32_t)i);
    }
}

static Result allocate(const GeomipInput *input, GeomipTiles *out) {
    Result result = square_grid_create(&input->terrain->forest, input->side, &out->squares);
    if (result != RESULT_OK)
        return result;
    size_t count = (size_t)out->squares.count, levels = (size_t)out->levels;
    out->tiles = calloc(count + 1, sizeof *out->tiles);
    out->delta = calloc(count * levels, sizeof *out->delta);
    if (input->bounds)
        out->strip = calloc(count * GEOMIP_SIDES * levels * levels, sizeof *out->strip);
    if (!out->tiles || !out->delta || (input->bounds && !out->strip))
        return RESULT_MEMORY;
    return create_links(out);
}

Result geomip_tiles_create(const GeomipInput *input, Jobs *jobs, GeomipTiles *out) {
    GeomipTiles tiles = {.terrain = input->terrain, .levels = __builtin_ctz((unsigned)input->side) + 1};
    Result result = allocate(input, &tiles);
    if (result != RESULT_OK) {
        geomip_tiles_destroy(&tiles);
        return result;
    }
    const Dem *dem = input->terrain->dem;
    Filling filling = {input, &tiles, geomip_error_highest(dem->height_m, (size_t)dem->width * (size_t)dem->height)};
    jobs_run(jobs, tiles.squares.count, 8, fill_tiles, &filling);
    *out = tiles;
    return RESULT_OK;
}

void geomip_tiles_destroy(GeomipTiles *tiles) {
    square_grid_destroy(&tiles->squares);
    free(tiles->tiles);
    free(tiles->links);
    free(tiles->delta);
    free(tiles->strip);
    *tiles = (GeomipTiles){0};
}
