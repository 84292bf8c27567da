// render/diamond/diamond_upload.h: what the GPU needs of a model in another form than the CPU has it, and what it can
// hold. Lattice units; metres; degrees.
// The caller owns the storages; thread of the context.
#pragma once
#include "render/diamond/storage.h"
#include "terrain/diamond/diamond.h"

// Of each super-square: reach of its centres, of its edge midpoints, always-split bits; three arrays in one.
MUST_USE Result diamond_upload_squares(const DiamondModel *model, Storage *out);
// East and north of each entry, side by side.
MUST_USE Result diamond_upload_degrees(const DiamondModel *model, Storage *out);
// The positions that are drawn, from the model's origin: x, y, z, in the samples' order.
MUST_USE Result diamond_upload_vertices(const DiamondModel *model, Storage out[3]);
