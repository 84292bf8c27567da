// Recorded reports of a stick to controls: as if it were plugged in; and files that are none.
#include "app/joystick/stick_stream.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

#define STEP_S (1.0 / 120.0)
#define DEVICE "device 046d:c215 Logitech Extreme 3D\n"
// Written for this test: X and Y of eight bits, -127..127.
#define DESCRIPTOR                                                                                                     \
    "descriptor 05 01 09 04 a1 01 15 81 25 7f 75 08\n"                                                                 \
    "descriptor 95 02 09 30 09 31 81 02 c0\n"

static const char PATH[] = "stick_stream_test.reports";

static Result read_text(const char *text, StickStream **out) {
    FILE *file = fopen(PATH, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    Result result = stick_stream_read(PATH, out);
    unlink(PATH);
    return result;
}

static void test_reports_move_the_controls_when_they_came(void **state) {
    (void)state;
    StickStream *stream = NULL;
    const Controls begin = {.throttle = 0.6, .flaps = 0.5};
    // At rest, full right at half a second, then right and back.
    assert_int_equal(read_text("# a stick\n" DEVICE DESCRIPTOR "0 00 00\n0.5 7f 00\n1.0 7f 7f # back\n", &stream),
                     RESULT_OK);
    assert_true(stick_stream_duration_s(stream) == 2.0);
    for (int run = 0; run < 2; run++) {
        stick_stream_begin(stream, &begin);
        for (int i = 0; i < 240; i++) {
            assert_false(stick_stream_is_over(stream));
            Controls controls = stick_stream_sample(stream, STEP_S);
            double aileron = i >= 60 ? 1.0 : 0.0, elevator = i >= 120 ? 1.0 : 0.0;
            if (fabs(controls.aileron - aileron) > 1e-6 || fabs(controls.elevator - elevator) > 1e-6)
                fail_msg("step %d: aileron %g, elevator %g", i, controls.aileron, controls.elevator);
            assert_true(controls.throttle == 0.6 && controls.flaps == 0.5);
        }
        assert_true(stick_stream_is_over(stream));
    }
    stick_stream_destroy(&stream);
    assert_null(stream);
}

static void test_files_that_are_none_are_refused(void **state) {
    (void)state;
    static const char *const BAD[] = {"",
                                      DEVICE,
                                      DEVICE DESCRIPTOR,
                                      DESCRIPTOR "0 00 00\n",
                                      DEVICE "0 00 00\n",
                                      "device 46d\n",
                                      "device\n",
                                      DEVICE "descriptor 05 0\n",
                                      DEVICE "descriptor 05 xx\n",
                                      DEVICE DESCRIPTOR "1 00 00\n0.5 00 00\n",
                                      DEVICE DESCRIPTOR "nan 00 00\n",
                                      DEVICE DESCRIPTOR "-1 00 00\n",
                                      DEVICE DESCRIPTOR "0\n",
                                      DEVICE DESCRIPTOR "0 0\n",
                                      DEVICE DESCRIPTOR "zero 00\n",
                                      DEVICE "descriptor 05 01 09 06 a1 01 c0\n0 00\n" /* a keyboard */};
    for (size_t i = 0; i < COUNT_OF(BAD); i++) {
        StickStream *stream = NULL;
        Result result = read_text(BAD[i], &stream);
        if (result != RESULT_FORMAT || stream)
            fail_msg("'%s': %s", BAD[i], result_text(result));
    }
    StickStream *stream = NULL;
    assert_int_equal(stick_stream_read("no such file", &stream), RESULT_NOT_FOUND);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reports_move_the_controls_when_they_came),
        cmocka_unit_test(test_files_that_are_none_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
