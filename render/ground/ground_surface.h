// render/ground/ground_surface.h: what every cell of the ground looks like: slope, open sky, water, height. No GL.
// Cells of a GroundSource; bytes as shaders/ground.glsl decodes them.
// A GroundSurface owns its arrays.
#pragma once
#include "render/ground/ground_source.h"
#include "terrain/jobs.h"

typedef struct GroundSurface {
    int width, height;
    uint8_t *cells;       // [height][width][4]: normal east, normal north (128: 0, 255: 1), open sky, water (0 or 255)
    uint16_t *heights;    // [height][width]: 0 at source->min_m, 65535 at source->max_m
    uint32_t *wet_blocks; // [height / GROUND_BLOCK + 2][width / GROUND_BLOCK + 2]: blocks with water above and left of
                          // each block's corner, so that a rectangle is four look-ups
    int wet_width;        // entries a row of wet_blocks
    float border_m;       // mean height of the outermost cells, above the geoid
    float border_water;   // share of them that is water
} GroundSurface;

// The same bytes for any number of workers.
MUST_USE Result ground_surface_create(const GroundSource *source, Jobs *jobs, GroundSurface *out);
void ground_surface_destroy(GroundSurface *surface);

// The part of ground_surface_create that finds water, in render/ground/ground_water.c: regions of cells whose third
// channel of flatness, cells[3], is 1 (level with all eight neighbours) and that are large, or lie at sea level; those
// and their rims become 255, all others 0.
MUST_USE Result ground_water_find(const GroundSource *source, GroundSurface *surface);
// Fills wet_blocks from cells[3]. MEMORY.
MUST_USE Result ground_water_count(GroundSurface *surface);
