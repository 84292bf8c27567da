#include <stdlib.h>
// The governor over made-up plants, whose frames cost a + b * tau^-power with noise, and come three frames late, as
// those of the pipeline do. No clock: time is what the frames take.
#include "app/flight/governor.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define DELAY 3 // frames on their way when a tolerance is asked for
#define SEEDS 100

typedef struct Plant {
    Governor governor;
    double fixed_ms, scale_ms, power; // a frame costs fixed_ms + scale_ms * tau^-power
    double noise;                     // standard deviation, logarithmic
    double spikes;                    // share of frames that take 8 times as long
    double asked_px[DELAY];
    double time_s, excess_s;
    uint64_t random;
} Plant;

static double uniform(uint64_t *random) {
    *random = *random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return ((double)(*random >> 33) + 0.5) / 2147483648.0;
}

static double normal(uint64_t *random) {
    return sqrt(-2.0 * log(uniform(random))) * cos(6.283185307179586 * uniform(random));
}

// The cost of `tau_px` at the target when `share` of it is fixed.
static Plant plant_of(double target_ms, double tau_px, double share, double power, int seed) {
    Plant p = {.governor = governor_create(target_ms, 1.0),
               .fixed_ms = share * target_ms,
               .scale_ms = (1.0 - share) * target_ms * pow(tau_px, power),
               .power = power,
               .random = (uint64_t)seed * 7919 + 1};
    for (int i = 0; i < DELAY; i++)
        p.asked_px[i] = p.governor.tau_px;
    for (int i = 0; i < 8; i++)
        (void)uniform(&p.random);
    return p;
}

static double plain_cost(const Plant *p, double tau_px) {
    return p->fixed_ms + p->scale_ms * pow(tau_px, -p->power);
}

// Draws a frame; its cost in milliseconds.
static double draw(Plant *p, bool moved, bool first) {
    double tau = p->asked_px[0], before = p->governor.tau_px;
    double cost = plain_cost(p, tau) * exp(p->noise * normal(&p->random));
    if (uniform(&p->random) < p->spikes || first)
        cost *= 8.0;
    p->excess_s += first || cost > 4.0 * plain_cost(p, tau) ? cost * 1e-3 : 0.0;
    GovernorFrame frame = {.cost_ms = cost,
                           .passed_s = cost * 1e-3,
                           .tau_px = tau,
                           .reached_px = tau,
                           .moved = moved || first,
                           .disturbed = first};
    memmove(p->asked_px, p->asked_px + 1, sizeof *p->asked_px * (DELAY - 1));
    p->asked_px[DELAY - 1] = governor_hear(&p->governor, &frame);
    p->time_s += frame.passed_s;
    double after = p->governor.tau_px, rate = log(GOVERNOR_RATE_FINDING) * fmin(frame.passed_s, 1.0) + 1e-9;
    if (!isfinite(after) || after < GOVERNOR_TAU_MIN_PX || after > GOVERNOR_TAU_MAX_PX)
        fail_msg("tau %g px", after);
    if (fabs(log(after / before)) > rate && !p->governor.settled)
        fail_msg("from %g to %g px in %g s", before, after, frame.passed_s);
    return cost;
}

// Until it settles: how long that takes.
static double let_settle(Plant *p, double limit_s) {
    draw(p, true, true);
    p->excess_s = 0.0;
    double begin_s = p->time_s;
    for (int i = 0; !p->governor.settled && (p->time_s - begin_s < limit_s || i < 400); i++)
        draw(p, false, false);
    return p->time_s - begin_s - p->excess_s;
}

static void check_stays(Plant *p, double seconds, const char *what) {
    double tau = p->governor.tau_px;
    for (double until = p->time_s + seconds; p->time_s < until;)
        draw(p, false, false);
    if (p->governor.tau_px != tau || p->governor.changes_settled != 0 || !p->governor.settled)
        fail_msg("%s: %g px became %g", what, tau, p->governor.tau_px);
}

static const double TARGETS[] = {1000.0 / 60.0, 1000.0 / 30.0, 1000.0 / 15.0};
static const double POWERS[] = {0.5, 1.0, 1.5, 2.0};
static const double TAUS[] = {0.3, 0.8, 1.0, 2.5, 6.0};

static void test_a_still_view_settles_within_two_seconds_and_stays(void **state) {
    (void)state;
    double worst = 0.0, off_sum = 0.0;
    int off = 0, runs = 0;
    for (int seed = 0; seed < SEEDS; seed++) {
        for (size_t t = 0; t < COUNT_OF(TARGETS); t++) {
            double power = POWERS[seed % 4], tau = TAUS[seed / 4 % 5], share = 0.2 * (seed / 20 % 4);
            Plant p = plant_of(TARGETS[t], tau, share, power, seed);
            p.noise = seed % 3 * 0.05;
            p.spikes = seed % 2 * 0.01;
            double start = plain_cost(&p, 1.0) / TARGETS[t];
            double settled_s = let_settle(&p, 4.0), cost = plain_cost(&p, p.governor.tau_px) / TARGETS[t];
            if (start < 2 && settled_s > 2.0)
                print_message("seed %d, target %.1f ms, from %.2f: settled after %.2f s\n", seed, TARGETS[t], start, settled_s);
            worst = fmax(worst, settled_s);
            off += cost * exp(1.645 * p.noise) < 0.85 || cost * exp(1.645 * p.noise) > 1.15;
            if (cost * exp(1.645 * p.noise) < 0.85 || cost * exp(1.645 * p.noise) > 1.15)
                print_message("seed %d target %.1f p %.1f tau %.1f share %.1f noise %.2f start %.2f: p95 %.2f after %.2fs tau %.3f spread %.3f\n", seed, TARGETS[t], power, tau, share, p.noise, start, cost*exp(1.645*p.noise), settled_s, p.governor.tau_px, p.governor.spread);
            off_sum += log(cost * exp(1.645 * p.noise));
            runs++;
            check_stays(&p, 600.0 / (seed < 10 ? 1 : 20), "still");
        }
    }
    print_message("%d runs, worst %.2f s, %d off, mean %.3f\n", runs, worst, off, off_sum / runs);
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void test_a_moving_view_keeps_the_95th_percentile(void **state) {
    (void)state;
    static double costs[20000];
    int off = 0, runs = 0; double rate=0;
    for (int seed = 0; seed < SEEDS; seed++) {
        for (size_t t = 0; t < COUNT_OF(TARGETS); t++) {
            Plant p = plant_of(TARGETS[t], TAUS[seed / 4 % 5], 0.2 * (seed / 20 % 4), POWERS[seed % 4], seed);
            p.noise = seed % 4 * 0.05;
            double scale = p.scale_ms, phase = 6.28 * uniform(&p.random);
            int count = 0;
            double before_tau = p.governor.tau_px; double before_s=0;
            for (draw(&p, true, true); p.time_s < 60.0;) {
                p.scale_ms = scale * exp(0.4 * sin(phase + p.time_s * 6.28 / 20.0) - 0.4*sin(phase)); // a scene that changes slowly
                double cost = draw(&p, true, false);
                if (p.time_s > 4.0) { costs[count++] = cost; rate = fmax(rate, fabs(log(p.governor.tau_px/before_tau))/(p.time_s-before_s));}
                before_tau = p.governor.tau_px; before_s=p.time_s;
            }
            qsort(costs, (size_t)count, sizeof *costs, by_size);
            double p95 = costs[(int)(0.95 * count)] / TARGETS[t];
            off += p95 < 0.85 || p95 > 1.15;
            if (p95 < 0.85 || p95 > 1.15) print_message("seed %d target %.1f power %.1f tau %.1f share %.1f noise %.2f: p95 %.3f spread %.3f tau %.3f\n", seed, TARGETS[t], p.power, TAUS[seed/4%5], .2*(seed/20%4), p.noise, p95, p.governor.spread, p.governor.tau_px);
            runs++;
        }
    }
    print_message("moving: %d runs, %d off rate %.3f\n", runs, off,rate);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_still_view_settles_within_two_seconds_and_stays),
        cmocka_unit_test(test_a_moving_view_keeps_the_95th_percentile),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
