// The triangle budget of a made-up method, whose triangles follow a known law of the tolerance.
#include "terrain/lod/budget.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

typedef struct Method {
    Budget budget;
    double scale, power; // triangles at 1 px; they grow with tau^-power
    int64_t least;       // that no tolerance takes away
    int64_t give_up;     // above it a refinement is given up, where it may; 0: never
    int refined;         // times, in the last frame
    LodCut cut;
} Method;

static Result refine_at(void *user, double tau_px, LodStats *stats) {
    Method *m = user;
    m->refined++;
    stats->triangles = m->least + (int64_t)fmin(m->scale * pow(tau_px, -m->power), 1e15);
    bool give_up = m->give_up && stats->triangles > m->give_up && budget_may_give_up(&m->budget, tau_px);
    return give_up ? RESULT_BUDGET : RESULT_OK;
}

static Result show(Method *m, double tau_px, double eye) {
    m->refined = 0;
    m->cut = (LodCut){.view = {.eye_ecef = vec3d(7e6, eye, 0.0), .px_per_rad = 1000.0, .tau_px = tau_px}};
    return budget_refine(&m->budget, refine_at, m, &m->cut);
}

static void test_within_the_budget_a_frame_is_refined_once_as_asked_for(void **state) {
    (void)state;
    Method m = {.budget = {.max_triangles = 1000}, .scale = 1000.0, .power = 1.0};
    for (int frame = 0; frame < 5; frame++) {
        assert_int_equal(show(&m, 1.0, frame), RESULT_OK);
        assert_int_equal(m.refined, 1);
        assert_true(m.cut.reached_px == 1.0);
    }
}

// Whatever the law: a still view settles, well used, and then costs one refinement a frame.
static void test_a_still_view_above_the_budget_settles_where_it_is_well_used(void **state) {
    (void)state;
    for (double power = 0.5; power <= 3.0; power += 0.5) {
        Method m = {.budget = {.max_triangles = 1000}, .scale = 1e5, .power = power, .give_up = 4000};
        double tau = 0.0;
        for (int frame = 0; frame < 60; frame++) {
            assert_int_equal(show(&m, 1.0, 0.0), RESULT_BUDGET);
            assert_true(m.cut.stats.triangles <= 1000);
            if (frame >= 40 && (m.refined != 1 || m.cut.reached_px != tau))
                fail_msg("power %.1f, frame %d: %d times, %.4f px after %.4f", power, frame, m.refined,
                         m.cut.reached_px, tau);
            tau = m.cut.reached_px;
        }
        double fits = pow(100.0, 1.0 / power); // the smallest tolerance that keeps the budget
        if (tau > fits * 1.15)
            fail_msg("power %.1f: %.4f px, %.4f px fit", power, tau, fits);
    }
}

static void test_a_still_view_that_fits_comes_back_from_afar(void **state) {
    (void)state;
    Method m = {.budget = {.max_triangles = 1000}, .scale = 1e7, .power = 1.0};
    for (int frame = 0; frame < 50; frame++)
        assert_int_equal(show(&m, 1.0, frame), RESULT_BUDGET);
    double before = m.cut.reached_px;
    m.scale = 990.0; // at 1 px nearly all of the budget
    int frames = 1;
    while (frames < 60 && show(&m, 1.0, 0.0) == RESULT_BUDGET)
        frames++;
    if (m.cut.reached_px != 1.0 || frames > 30)
        fail_msg("from %.0f to %.3f px in %d frames", before, m.cut.reached_px, frames);
}

static void test_a_moving_view_is_seldom_refined_more_than_once(void **state) {
    (void)state;
    Method m = {.budget = {.max_triangles = 1000}, .scale = 1e5, .power = 1.2, .give_up = 4000};
    int refined = 0, changes = 0;
    double tau = 0.0;
    for (int frame = 0; frame < 400; frame++) {
        assert_int_equal(show(&m, 1.0, frame), RESULT_BUDGET);
        assert_true(m.cut.stats.triangles <= 1000);
        refined += frame < 100 ? 0 : m.refined;
        changes += frame >= 100 && m.cut.reached_px != tau;
        tau = m.cut.reached_px;
    }
    if (refined > 330 || changes > 30)
        fail_msg("%d refinements and %d changes of tolerance in 300 frames", refined, changes);
}

// The tolerance is one beyond which little is saved: a sixteenth.
static void test_a_budget_that_can_not_be_kept_is_not_chased(void **state) {
    (void)state;
    for (int64_t give_up = 0; give_up <= 1500; give_up += 1500) {
        Method m = {.budget = {.max_triangles = 1000}, .scale = 1e5, .power = 1.0, .least = 2000, .give_up = give_up};
        for (int frame = 0; frame < 10; frame++) {
            assert_int_equal(show(&m, 1.0, 0.0), RESULT_BUDGET);
            if (m.cut.stats.triangles > 2125 || m.cut.reached_px > 5000.0 || m.refined > (frame ? 1 : 40))
                fail_msg("frame %d: %" PRId64 " triangles at %g px, refined %d times", frame, m.cut.stats.triangles,
                         m.cut.reached_px, m.refined);
        }
        m.least = 0; // elsewhere it can
        m.scale = 900.0;
        Result result = RESULT_BUDGET;
        for (int frame = 0; frame < 60 && result == RESULT_BUDGET; frame++)
            result = show(&m, 1.0, 5.0);
        assert_int_equal(result, RESULT_OK);
    }
}

// Counts of the three frames in flight come late: one overflow raises the tolerance once.
static void test_late_counts_of_one_tolerance_are_learned_from_once(void **state) {
    (void)state;
    Budget budget = {.max_triangles = 1000};
    LodView view = {.eye_ecef = {7e6, 0.0, 0.0}, .px_per_rad = 1000.0, .tau_px = 1.0};
    assert_true(budget_begin(&budget, &view) == 1.0);
    double raised = budget_learn(&budget, 1.0, 1.0, 1200);
    assert_true(raised > 1.0);
    assert_true(budget_learn(&budget, 1.0, 1.0, 1200) == raised);
    assert_true(budget_begin(&budget, &view) == raised);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_within_the_budget_a_frame_is_refined_once_as_asked_for),
        cmocka_unit_test(test_a_still_view_above_the_budget_settles_where_it_is_well_used),
        cmocka_unit_test(test_a_still_view_that_fits_comes_back_from_afar),
        cmocka_unit_test(test_a_moving_view_is_seldom_refined_more_than_once),
        cmocka_unit_test(test_a_budget_that_can_not_be_kept_is_not_chased),
        cmocka_unit_test(test_late_counts_of_one_tolerance_are_learned_from_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
