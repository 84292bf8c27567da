// render/atmosphere.h: tables of light in the air, drawn by the GPU: some once, the sky around the eye when it moved.
// Metres above the ellipsoid; radiance relative to the sun's irradiance outside the air.
// An Atmosphere owns its textures and programs; thread of the context.
#pragma once
#include "base/base.h"
#include "base/vec.h"

typedef struct Atmosphere Atmosphere;

// Draws the tables that depend on nothing.
MUST_USE Result atmosphere_create(Atmosphere **out);
void atmosphere_destroy(Atmosphere **atmosphere);

// Draws the sky around an eye, unless the one at hand is of the same eye: heights in steps of 2 %, the sun's zenith
// angle in steps of 1/1024 of its cosine, so that the picture depends on the view and not on the views before.
// Changes framebuffer, viewport, program, vertex array and textures 0 and 1.
void atmosphere_update(Atmosphere *atmosphere, double eye_h_m, double mu_sun);

unsigned atmosphere_radiance(const Atmosphere *atmosphere); // textures of shaders/sky_view.frag
unsigned atmosphere_source(const Atmosphere *atmosphere);

// Tables of shaders/atmosphere_ground.frag: what atmosphere_light tells, for shaders.
unsigned atmosphere_light_sun(const Atmosphere *atmosphere);
unsigned atmosphere_light_sky(const Atmosphere *atmosphere);

// Light on the ground: irradiance of the sun across its rays, and of the sky on level ground.
typedef struct AtmosphereLight {
    Vec3f sun, sky;
} AtmosphereLight;
AtmosphereLight atmosphere_light(const Atmosphere *atmosphere, double h_m, double mu_sun);
