// A wired Xbox 360 pad that is not there, from its bytes through the real libusb to events, and back to its motors.
#include "tests/device_support.h"

#include "base/clock.h"
#include "base/statistics.h"
#include "input/devices/xbox_report.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct Fixture {
    FakeBed *bed;
    Devices *devices;
} Fixture;

static int set_up(void **state) {
    Fixture *fixture = calloc(1, sizeof *fixture);
    *state = fixture;
    fixture->bed = fake_bed_create();
    fake_stick_plug(fixture->bed, &FAKE_MOUSE, 20); // so that there is a bus, and nothing to read on it
    return devices_create(&fixture->devices) == RESULT_OK ? 0 : -1;
}

static int tear_down(void **state) {
    Fixture *fixture = *state;
    devices_destroy(&fixture->devices);
    fake_bed_destroy(&fixture->bed);
    free(fixture);
    return 0;
}

static void test_a_pad_arrives_with_its_name_and_parts(void **state) {
    Fixture *fixture = *state;
    DeviceEvent event;
    fake_pad_plug(fixture->bed, 3, false);
    assert_true(fake_wait(fixture->devices, DEVICE_ARRIVED, &event));
    print_message("%s %04x:%04x %s: %d axes, %d buttons, %d hats\n", event.info.name, event.info.vendor,
                  event.info.product, event.info.path, event.info.axis_count, event.info.button_count,
                  event.info.hat_count);
    assert_string_equal(event.info.name, "Nobody Pretended Pad");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_a_pad_arrives_with_its_name_and_parts, set_up, tear_down),
    };
    if (!fake_bed_works()) {
        print_message("skipped: umockdev's preload library is not there\n");
        return 77;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
