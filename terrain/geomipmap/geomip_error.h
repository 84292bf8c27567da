// terrain/geomipmap/geomip_error.h: the errors of the levels of one tile.
// As terrain/geomipmap/geomip_tiles.h.
// Writes into the tables of a GeomipTiles under construction.
#pragma once
#include "terrain/geomipmap/geomip_tiles.h"

// The largest |height|.
float geomip_error_highest(const float *height_m, size_t count);
// Fills the tile's errors. `highest_m`: geomip_error_highest of the DEM. Tiles are independent: any thread.
void geomip_error_fill(GeomipTiles *tiles, const GeomipInput *input, float highest_m, int32_t tile);
