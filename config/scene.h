// config/scene.h: scene files: which terrain, where a flight starts, what hangs over it.
// Degrees; metres above the geoid; metres a second.
// A Scene owns its texts.
#pragma once
#include "base/base.h"

#define SCENE_DEM_MAX 64

// INI. All keys may be missing but `dem`:
//   [terrain] dem (again for each further tile), datum, voids, image, image-bounds
//   [start]   position = LAT,LON,ALT   look = HEADING,PITCH   speed
//   [light]   sun = AZIMUTH,HEIGHT
//   [demo]    file
// Files are named relative to the scene's folder.
typedef struct Scene {
    char *name; // of the file, without folder and ending; "" without a file
    char *dem[SCENE_DEM_MAX];
    int dem_count;
    char *image, *demo; // NULL: none
    int datum, voids;   // the choice's index in the option of that name; -1: not said
    bool has_position, has_look, has_speed, has_sun, has_image_bounds;
    double position[3]; // latitude, longitude, altitude
    double look[2];     // heading, pitch
    double speed_m_s;
    double sun[2];          // azimuth, height
    double image_bounds[4]; // west, south, east, north
} Scene;

// NOT_FOUND, FORMAT (file, line, what was expected), MEMORY; logged.
MUST_USE Result scene_read(const char *path, Scene *out);
// A scene without a file, of these DEM paths.
MUST_USE Result scene_of_dems(const char *const *paths, int count, Scene *out);
void scene_clear(Scene *scene);
