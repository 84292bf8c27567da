#include "app/reproduce/reproduce_search.h"

#include <math.h>

#define STEPS_MAX 10
#define CLOSE_ENOUGH 0.02
#define FIRST_TAU_PX 1.0
#define FIRST_POWER 1.2 // triangles fall about as tau^-1.2 on rough ground
#define LEAST_POWER 0.4 // keeps steps short where the curve is flat
#define GREATEST_POWER 4.0

Result search_begin(const Circuit *circuit, const LodOptions *method, Jobs *jobs, double px_per_rad, double span,
                    int probes, Search *out) {
    *out = (Search){.circuit = circuit,
                    .px_per_rad = px_per_rad,
                    .span = span,
                    .probes = probes,
                    .tau_px = FIRST_TAU_PX,
                    .power = FIRST_POWER};
    race_begin(circuit->terrain, 1, &out->race);
    return race_enter(&out->race, method, jobs);
}

void search_end(Search *search) {
    race_end(&search->race);
}

static Result probe(Search *search, double tau_px, double *triangles) {
    *triangles = 0.0;
    Result result = RESULT_OK;
    for (int i = 0; i < search->probes && result == RESULT_OK; i++) {
        Viewpoint at = circuit_at(search->circuit, search->span * (i + 0.5) / search->probes);
        LodView view = circuit_view(&at, search->px_per_rad, tau_px);
        double ms;
        result = racer_refine(&search->race.racers[0], &view, &ms);
        *triangles += (double)search->race.racers[0].cut.stats.triangles / search->probes;
    }
    return result;
}

// Takes the point in, and the slope from the one before to it.
static void learn(Search *search, double tau_px, double triangles) {
    if (search->triangles > 0.0 && triangles > 0.0 && search->tau_px != tau_px) {
        double power = -log(search->triangles / triangles) / log(search->tau_px / tau_px);
        search->power = fmin(fmax(power, LEAST_POWER), GREATEST_POWER);
    }
    search->tau_px = tau_px;
    search->triangles = triangles;
}

// Where the curve through the latest point has `triangles`; the latest point where none is known.
static double guess(const Search *search, double triangles) {
    if (search->triangles <= 0.0)
        return search->tau_px;
    double tau = search->tau_px * pow(search->triangles / triangles, 1.0 / search->power);
    return fmin(fmax(tau, SEARCH_TAU_LEAST_PX), SEARCH_TAU_GREATEST_PX);
}

Result search_tau(Search *search, double triangles, double *tau_px) {
    double nearest = INFINITY;
    *tau_px = search->tau_px;
    for (int step = 0; step < STEPS_MAX && nearest > CLOSE_ENOUGH; step++) {
        double tau = guess(search, triangles), found;
        if (step > 0 && tau == search->tau_px)
            break;
        Result result = probe(search, tau, &found);
        if (result != RESULT_OK)
            return result;
        learn(search, tau, found);
        if (fabs(found / triangles - 1.0) < nearest) {
            nearest = fabs(found / triangles - 1.0);
            *tau_px = tau;
        }
    }
    return RESULT_OK;
}
