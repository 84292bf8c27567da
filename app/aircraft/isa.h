// app/aircraft/isa.h: the standard atmosphere.
// SI units: metres above the sea (taken as the ellipsoid), kelvin, pascal, kg/m^3, metres a second.
// Pure functions; any thread; deterministic.
#pragma once
#include "base/base.h"

#define ISA_DENSITY_0 1.225 // kg/m^3 at sea level
#define ISA_SOUND_0 340.294 // m/s at sea level

typedef struct Isa {
    double temperature_k, pressure_pa, density, sound_m_s; // all > 0
} Isa;

// At a geometric height: U.S. Standard Atmosphere 1976 (NOAA-S/T 76-1562), part 1, equations 18, 19, 23, 33a, 33b and
// table 4, to 86 km; within 0.1 % of its tables. The lowest layer goes on down to -5 km. Beyond, temperature
// stays and pressure falls off exponentially; heights outside -5 km .. 1000 km count as these.
Isa isa_at(double h_m);
// The height at which the tables have the pressure of a geometric height: in geopotential metres, equation 18.
double isa_pressure_altitude(double h_m);
