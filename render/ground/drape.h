// render/ground/drape.h: an image laid on the land, and on the globe around it.
// Degrees of the image's outer edges; texture coordinates 0 .. 1, v down.
// A Drape owns its textures; thread of the context.
#pragma once
#include "base/base.h"
#include "render/render.h"
#include "terrain/terrain.h"

#define DRAPE_BLOCK_BINDING 2
enum { DRAPE_UNIT_IMAGE = 10, DRAPE_UNIT_MAP = 11 }; // as shaders/drape.glsl has them

// std140; the twin of shaders/drape.glsl.
typedef struct DrapeBlock {
    float globe[4]; // image coordinates = (longitude, latitude in radians - xy) * zw; zw 0: not on the globe
    float map[4];   // coordinates in the map = DEM sample * xy + zw
    float image[4]; // x: 1 where it goes around the globe; unused
} DrapeBlock;
_Static_assert(sizeof(DrapeBlock) == 3 * 16, "as shaders/drape.glsl has it");

typedef struct Drape Drape;

// Reads options->image_path. RANGE: bounds that are none; UNSUPPORTED: the image has no georeference of its own that is
// understood (WGS84 degrees or UTM) and no bounds were given; else what assets/image.h reports.
MUST_USE Result drape_create(const RenderOptions *options, const Terrain *terrain, bool software, Drape **out);
void drape_destroy(Drape **drape);
void drape_bind(const Drape *drape);
