// app/compute.h: whether a method that can work on the GPU does: --compute.
// No units.
// Nothing owned.
#pragma once
#include "app/json.h"
#include "config/options.h"
#include "render/context/context.h"
#include "render/render.h"
#include "terrain/terrain.h"

// `resident` for LodOptions: auto chooses the GPU where there is one. Where the driver's limits forbid it, a message
// says so and the processor does the work. The context is current nowhere before and after. DEVICE: it cannot be made
// current.
MUST_USE Result compute_choose(const Options *options, Context *context, const Terrain *terrain, bool *resident);

// "compute", of a cut that was made on the GPU: where, and the phases' times. Nothing for other cuts.
void compute_add_json(Json *json, const RenderResident *resident);
