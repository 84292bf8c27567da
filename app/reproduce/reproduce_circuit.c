#include "app/reproduce/reproduce_circuit.h"

#include "terrain/geodesy.h"

#include <math.h>

#define REACH 0.3         // half-axes, of the sides
#define WINDOW 8          // stations to each side whose ground is kept clear of, and over which heights are smoothed
#define TANGENT 1e-5      // of the circuit
#define LOOK_DOWN_DEG 8.0 // the picture's middle is ground, not sky

static void place(const Terrain *terrain, double part, double *lat_deg, double *lon_deg) {
    const Dem *dem = terrain_dem(terrain);
    double angle = 2.0 * GEODESY_PI * part;
    double col = (dem->width - 1) * (0.5 + REACH * cos(angle)), row = (dem->height - 1) * (0.5 - REACH * sin(angle));
    grid_geodetic(terrain_grid(terrain), col, row, lat_deg, lon_deg);
}

static double ground_at(const Terrain *terrain, int station) {
    double lat, lon, ground = 0.0;
    place(terrain, (double)station / CIRCUIT_STATIONS, &lat, &lon);
    return terrain_ground_m(terrain, lat, lon, &ground) ? ground : 0.0;
}

static int wrap(int station) {
    return (station + CIRCUIT_STATIONS) % CIRCUIT_STATIONS;
}

// The mean over a window of the greatest over a window: never below what is in the middle.
static void smooth(const double *ground_m, double height_m, double *altitude_m) {
    double greatest[CIRCUIT_STATIONS];
    for (int i = 0; i < CIRCUIT_STATIONS; i++) {
        greatest[i] = ground_m[i];
        for (int k = -WINDOW; k <= WINDOW; k++)
            greatest[i] = fmax(greatest[i], ground_m[wrap(i + k)]);
    }
    for (int i = 0; i < CIRCUIT_STATIONS; i++) {
        double sum = 0.0;
        for (int k = -WINDOW; k <= WINDOW; k++)
            sum += greatest[wrap(i + k)];
        altitude_m[i] = sum / (2 * WINDOW + 1) + height_m;
    }
}

static Vec3d point_at(const Circuit *circuit, double part) {
    double lat, lon;
    place(circuit->terrain, part, &lat, &lon);
    return geodesy_to_ecef((Geodetic){lat * GEODESY_RAD_PER_DEG, lon * GEODESY_RAD_PER_DEG, 0.0});
}

void circuit_plan(const Terrain *terrain, double height_m, Circuit *out) {
    double ground_m[CIRCUIT_STATIONS];
    *out = (Circuit){.terrain = terrain};
    for (int i = 0; i < CIRCUIT_STATIONS; i++) {
        ground_m[i] = ground_at(terrain, i);
        out->length_m += vec3d_distance(point_at(out, (double)i / CIRCUIT_STATIONS),
                                        point_at(out, (double)(i + 1) / CIRCUIT_STATIONS));
    }
    smooth(ground_m, height_m, out->altitude_m);
}

static double altitude_at(const Circuit *circuit, double part) {
    double at = (part - floor(part)) * CIRCUIT_STATIONS;
    int station = (int)at;
    double share = at - station;
    return circuit->altitude_m[wrap(station)] * (1.0 - share) + circuit->altitude_m[wrap(station + 1)] * share;
}

Viewpoint circuit_at(const Circuit *circuit, double part) {
    Viewpoint at = {.pitch_deg = -LOOK_DOWN_DEG};
    place(circuit->terrain, part, &at.lat_deg, &at.lon_deg);
    Vec3d along = vec3d_sub(point_at(circuit, part + TANGENT), point_at(circuit, part));
    Mat3d enu = geodesy_enu_from_ecef(at.lat_deg * GEODESY_RAD_PER_DEG, at.lon_deg * GEODESY_RAD_PER_DEG);
    Vec3d local = mat3d_mul_vec(&enu, along);
    at.heading_deg = atan2(local.x, local.y) / GEODESY_RAD_PER_DEG;
    at.alt_m = altitude_at(circuit, part);
    return at;
}

LodView circuit_view(const Viewpoint *at, double px_per_rad, double tau_px) {
    Geodetic eye = {at->lat_deg * GEODESY_RAD_PER_DEG, at->lon_deg * GEODESY_RAD_PER_DEG, at->alt_m};
    return (LodView){.eye_ecef = geodesy_to_ecef(eye),
                     .forward_ecef = viewpoint_forward(at),
                     .px_per_rad = px_per_rad,
                     .tau_px = tau_px};
}
