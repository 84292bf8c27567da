// terrain/lod/lod_patch_tables.h: what the files of a PatchSeam share: its tables, made once.
// As terrain/lod/lod_patch_seam.h.
// As terrain/lod/lod_patch_seam.h.
#pragma once
#include "terrain/lod/lod_patch_seam.h"

#define SEAM_BORDER 8 // a mark that stays: a static patch on one side, the remainder on the other

// False when memory is out.
MUST_USE bool seam_list_add(SeamList *list, int32_t sample);
// Where a plane of the patch forest holds the vertex.
size_t seam_plane_entry(const PatchSeam *seam, int plane, int32_t col, int32_t row);
