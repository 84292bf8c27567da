#include "app/aircraft/isa.h"

#include <math.h>

#define EARTH_RADIUS_M 6356766.0 // of geopotential height, equation 18
#define GRAVITY 9.80665
#define GAS 287.05287 // J/(kg K), of air: R* / M0
#define GAMMA 1.4
#define LOWEST_M (-5000.0)
#define HIGHEST_M 1e6

// Table 4, with the pressure at each base from equation 33.
static const struct {
    double base_m, lapse_k_m, temperature_k, pressure_pa; // geopotential height
} layers[] = {
    {0.0, -0.0065, 288.15, 101325.0},    {11000.0, 0.0, 216.65, 22632.06},   {20000.0, 0.001, 216.65, 5474.889},
    {32000.0, 0.0028, 228.65, 868.0187}, {47000.0, 0.0, 270.65, 110.9063},   {51000.0, -0.0028, 270.65, 66.93887},
    {71000.0, -0.002, 214.65, 3.956420}, {84852.0, 0.0, 186.946, 0.3733836},
};

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

double isa_pressure_altitude(double h_m) {
    double h = clamp(h_m, LOWEST_M, HIGHEST_M);
    return EARTH_RADIUS_M * h / (EARTH_RADIUS_M + h);
}

Isa isa_at(double h_m) {
    double geopotential = isa_pressure_altitude(h_m);
    size_t i = COUNT_OF(layers) - 1;
    while (i > 0 && geopotential < layers[i].base_m)
        i--;
    double above = geopotential - layers[i].base_m, lapse = layers[i].lapse_k_m, base_k = layers[i].temperature_k;
    Isa air = {.temperature_k = base_k + lapse * above};
    double ratio = lapse == 0.0 ? exp(-GRAVITY * above / (GAS * base_k))
                                : pow(base_k / air.temperature_k, GRAVITY / (GAS * lapse));
    air.pressure_pa = layers[i].pressure_pa * ratio;
    air.density = air.pressure_pa / (GAS * air.temperature_k);
    air.sound_m_s = sqrt(GAMMA * GAS * air.temperature_k);
    return air;
}
