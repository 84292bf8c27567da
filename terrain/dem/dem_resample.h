// terrain/dem/dem_resample.h: the same ground with other samples, for experiments at several sizes.
// Samples; metres above the Dem's datum.
// The result is a Dem of its own, which the caller owns.
#pragma once
#include "terrain/dem/dem.h"

// `width` x `height` samples between the same outermost sample centres: areas and distances on the ground stay true.
// Between samples by Catmull-Rom's cubic, which keeps the heights of samples that coincide and may overshoot others by
// an eighth of a step. Where the new grid is coarser the kernel is widened by the ratio, so that what the grid cannot
// hold is averaged. Finer samples add no detail. Beyond the rim its heights go on. Voids count as filled, and none is
// marked. RANGE: not 2 .. DEM_SIDE_MAX samples a side; MEMORY.
MUST_USE Result dem_resample(const Dem *dem, int width, int height, Dem **out);
