// render/ground/drape_place.h: where on Earth an image lies. No GL.
// The image's outer edges in degrees, or in metres of a UTM zone.
// Values; any thread.
#pragma once
#include "base/base.h"
#include "render/render.h"

typedef struct DrapePlace {
    bool utm;
    int zone; // 1 .. 60
    bool zone_north;
    double west, north;  // outer edges
    double across, down; // extent, > 0
} DrapePlace;

// From options->image_bounds or the image's own tags; see drape_create.
MUST_USE Result drape_place_find(const RenderOptions *options, DrapePlace *out);

// Image coordinates of a point, 0 .. 1 inside, v down. Longitudes are taken within 180 degrees of `near_lon_deg`, so
// that neighbours stay neighbours. False outside the projection's domain.
bool drape_place_locate(const DrapePlace *place, double lat_deg, double lon_deg, double near_lon_deg, double *u,
                        double *v);
