// A joystick that is not there, from its bytes through the real hidapi to events: coming, saying, going, coming again.
#define _GNU_SOURCE // setresuid, RUSAGE_THREAD
#include "tests/device_fixture.h"
#include "tests/heard.h"

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define NOBODY 65534

static int set_up(void **state) {
    DeviceFixture *fixture = device_fixture_create();
    *state = fixture;
    return devices_create(NULL, &fixture->devices) == RESULT_OK && devices_wait(fixture->devices, 20.0) ? 0 : -1;
}

static FakeStick *plug(DeviceFixture *fixture, int number, DeviceEvent *event) {
    FakeStick *stick = fake_stick_plug(fixture->bed, &FAKE_JOYSTICK, number);
    assert_true(fake_wait(fixture->devices, DEVICE_ARRIVED, event));
    return stick;
}

static void send(FakeStick *stick, double x, double y, int hat, uint8_t buttons) {
    uint8_t report[FAKE_STICK_BYTES];
    fake_joystick_report(x, y, 0.0, -1.0, hat, buttons, report);
    fake_stick_send(stick, report, sizeof report);
}

static void test_a_stick_arrives_with_its_name_and_parts(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    plug(fixture, 0, &event);
    const PadInfo *info = &event.info;
    print_message("slot %d: %s %04x:%04x %s, %d axes, %d buttons, %d hats\n", event.slot, info->name, info->vendor,
                  info->product, info->path, info->axis_count, info->button_count, info->hat_count);
    assert_string_equal(info->name, "Nobody Pretended Stick");
    assert_string_equal(info->path, "/dev/hidraw0");
    assert_true(info->bus == PAD_BUS_HID && info->vendor == 0x044f && info->product == 0xb10a && event.slot == 0);
    assert_true(info->axis_count == 4 && info->button_count == 8 && info->hat_count == 1);
    assert_true(info->axes[0] == PAD_AXIS_X && info->axes[1] == PAD_AXIS_Y && info->axes[2] == PAD_AXIS_RZ &&
                info->axes[3] == PAD_AXIS_SLIDER);
}

static void test_its_axes_hat_and_buttons_are_told(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    FakeStick *stick = plug(fixture, 0, &event);
    send(stick, -1.0, 0.5, 3, 0x85);
    assert_true(fake_wait(fixture->devices, DEVICE_REPORT, &event));
    print_message("x %g, y %g, rz %g, slider %g, hat %d, buttons %llx\n", event.state.axes[0], event.state.axes[1],
                  event.state.axes[2], event.state.axes[3], event.state.hats[0],
                  (unsigned long long)event.state.buttons[0]);
    assert_true(event.state.axes[0] == -1.0 && fabs(event.state.axes[1] - 0.5) < 2e-5);
    assert_true(event.state.axes[3] == -1.0 && event.state.hats[0] == 3 && event.state.buttons[0] == 0x85);
    assert_int_equal(event.state.axes_unknown & 15, 0);
    send(stick, 1.0, -1.0, -1, 0);
    assert_true(fake_wait(fixture->devices, DEVICE_REPORT, &event));
    assert_true(event.state.axes[0] == 1.0 && event.state.axes[1] == -1.0);
    assert_true(event.state.hats[0] == PAD_HAT_CENTRED && event.state.buttons[0] == 0);
}

static void test_a_report_of_another_length_is_passed_over_and_said_once(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    Heard heard;
    FakeStick *stick = plug(fixture, 0, &event);
    heard_begin(&heard);
    for (int count = 1; count < FAKE_STICK_BYTES; count += 3) {
        fake_stick_send(stick, (const uint8_t[FAKE_STICK_BYTES]){0xff, 0xff, 0xff, 0xff, 0xff}, (size_t)count);
        device_fixture_sleep_ms(30);
    }
    int events = devices_poll(fixture->devices, &event, 1);
    send(stick, 0.25, 0.0, 0, 1);
    bool arrived = fake_wait(fixture->devices, DEVICE_REPORT, &event);
    heard_end();
    print_message("%d events of 3 short reports; x %g of a whole one, expected 0.25; said: %s", events,
                  event.state.axes[0], heard.text);
    assert_int_equal(events, 0);
    assert_true(arrived && fabs(event.state.axes[0] - 0.25) < 2e-5);
    assert_int_equal(heard.warnings, 1);
}

static void test_it_leaves_and_comes_back(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    for (int round = 0; round < 3; round++) {
        FakeStick *stick = plug(fixture, round, &event);
        assert_int_equal(event.slot, 0);
        send(stick, 0.1 * round, 0.0, 0, 0);
        assert_true(fake_wait(fixture->devices, DEVICE_REPORT, &event));
        assert_true(fabs(event.state.axes[0] - 0.1 * round) < 2e-5);
        int64_t begin_ns = clock_now_ns();
        fake_stick_unplug(stick);
        assert_true(fake_wait(fixture->devices, DEVICE_LEFT, &event));
        print_message("left %.1f ms after it was pulled\n", (double)(clock_now_ns() - begin_ns) * 1e-6);
        assert_int_equal(event.slot, 0);
    }
}

static void test_two_sticks_have_slots_of_their_own(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    FakeStick *first = plug(fixture, 0, &event), *second = plug(fixture, 1, &event);
    assert_int_equal(event.slot, 1);
    fake_stick_unplug(first);
    assert_true(fake_wait(fixture->devices, DEVICE_LEFT, &event) && event.slot == 0);
    send(second, -0.5, 0.0, 0, 0);
    assert_true(fake_wait(fixture->devices, DEVICE_REPORT, &event));
    assert_true(event.slot == 1 && fabs(event.state.axes[0] + 0.5) < 2e-5);
}

static void test_what_is_there_at_the_start_is_found_and_a_mouse_is_left_alone(void **state) {
    DeviceFixture *fixture = *state;
    Devices *devices;
    DeviceEvent events[8];
    fake_stick_plug(fixture->bed, &FAKE_MOUSE, 0);
    fake_stick_plug(fixture->bed, &FAKE_JOYSTICK, 1);
    assert_int_equal(devices_create(NULL, &devices), RESULT_OK);
    assert_true(devices_wait(devices, 20.0));
    int count = devices_poll(devices, events, 8);
    print_message("%d events, expected that one stick arrived: %s\n", count, count > 0 ? events[0].info.path : "-");
    assert_true(count == 1 && events[0].kind == DEVICE_ARRIVED);
    assert_string_equal(events[0].info.path, "/dev/hidraw1");
    devices_destroy(&devices);
    assert_null(devices);
}

static void test_a_node_that_may_not_be_read_is_said_once_and_read_when_it_may(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    Heard heard;
    if (getuid() != 0) {
        print_message("only root can leave off its rights for a while\n");
        skip();
    }
    fake_bed_open_to_all(fixture->bed);
    heard_begin(&heard);
    fake_stick_plug(fixture->bed, &FAKE_JOYSTICK, 0);
    assert_int_equal(setresuid(NOBODY, NOBODY, 0), 0);
    bool denied = fake_wait(fixture->devices, DEVICE_DENIED, &event);
    device_fixture_sleep_ms(1200); // it is looked at again meanwhile, and says no more
    DeviceEvent more;
    int count = devices_poll(fixture->devices, &more, 1);
    assert_int_equal(setresuid(0, 0, 0), 0);
    bool arrived = fake_wait(fixture->devices, DEVICE_ARRIVED, &more);
    heard_end();
    print_message("denied: %d, error %d, expected %d; %d more events; said: %s", denied, event.error, EACCES, count,
                  heard.text);
    assert_true(denied && event.error == EACCES && count == 0 && heard.warnings == 1);
    assert_non_null(strstr(heard.text, "udev rule"));
    assert_true(arrived && more.slot == event.slot);
}

static void send_x(void *stick, double x) {
    send(stick, x, 0.0, 0, 0);
}

static void test_a_report_is_an_event_within_a_step(void **state) {
    DeviceEvent event;
    FakeStick *stick = plug(*state, 0, &event);
    device_fixture_time_reports(*state, send_x, stick, 2e-5, "from the report's write to its event");
}

static void *plug_one(DeviceFixture *fixture, int round) {
    return fake_stick_plug(fixture->bed, &FAKE_JOYSTICK, round);
}

static void pull_one(DeviceFixture *fixture, void *stick) {
    (void)fixture;
    send(stick, 0.0, 0.0, 0, 0);
    fake_stick_unplug(stick);
}

static void test_a_poll_does_not_wait_while_devices_come_and_go(void **state) {
    device_fixture_time_changes(*state, plug_one, pull_one, 5, "a poll while sticks come and go");
}

static void test_it_ends_quickly_with_a_stick_that_says_nothing(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    plug(fixture, 0, &event);
    int64_t begin_ns = clock_now_ns();
    devices_destroy(&fixture->devices);
    double ms = (double)(clock_now_ns() - begin_ns) * 1e-6;
    print_message("%.1f ms\n", ms);
    assert_true(ms < 1000.0);
}

#define DEVICE_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, device_fixture_tear_down)

int main(void) {
    const struct CMUnitTest tests[] = {
        DEVICE_TEST(test_a_stick_arrives_with_its_name_and_parts),
        DEVICE_TEST(test_its_axes_hat_and_buttons_are_told),
        DEVICE_TEST(test_a_report_of_another_length_is_passed_over_and_said_once),
        DEVICE_TEST(test_it_leaves_and_comes_back),
        DEVICE_TEST(test_two_sticks_have_slots_of_their_own),
        DEVICE_TEST(test_what_is_there_at_the_start_is_found_and_a_mouse_is_left_alone),
        DEVICE_TEST(test_a_node_that_may_not_be_read_is_said_once_and_read_when_it_may),
        DEVICE_TEST(test_a_report_is_an_event_within_a_step),
        DEVICE_TEST(test_a_poll_does_not_wait_while_devices_come_and_go),
        DEVICE_TEST(test_it_ends_quickly_with_a_stick_that_says_nothing),
    };
    return fake_bed_works() ? cmocka_run_group_tests(tests, NULL, NULL) : 77;
}
