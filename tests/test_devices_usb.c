// A wired Xbox 360 pad that is not there, from its bytes through the real libusb to events, and back to its motors.
#define _GNU_SOURCE // RUSAGE_THREAD
#include "tests/device_fixture.h"

#include "input/devices/devices_usb.h"
#include "input/devices/xbox_report.h"
#include "tests/heard.h"

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static int set_up(void **state) {
    DeviceFixture *fixture = device_fixture_create();
    *state = fixture;
    fake_stick_plug(fixture->bed, &FAKE_MOUSE, 20); // so that there is a bus, and nothing to read on it
    return devices_create(NULL, &fixture->devices) == RESULT_OK ? 0 : -1;
}

static FakePad *plug(DeviceFixture *fixture, int address, DeviceEvent *event) {
    FakePad *pad = fake_pad_plug(fixture->bed, address, FAKE_FREE);
    assert_true(fake_wait(fixture->devices, DEVICE_ARRIVED, event));
    return pad;
}

static void send(FakePad *pad, FakePadHands hands) {
    uint8_t report[FAKE_PAD_BYTES];
    fake_pad_report(&hands, report);
    fake_pad_send(pad, report, sizeof report);
}

static void test_a_pad_arrives_with_its_name_and_parts(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    plug(fixture, 3, &event);
    const PadInfo *info = &event.info;
    print_message("slot %d: %s %04x:%04x %s, %d axes, %d buttons, %d hats\n", event.slot, info->name, info->vendor,
                  info->product, info->path, info->axis_count, info->button_count, info->hat_count);
    assert_string_equal(info->name, "Nobody Pretended Pad");
    assert_string_equal(info->path, "/dev/bus/usb/001/003");
    assert_true(info->bus == PAD_BUS_USB && info->vendor == 0x045e && info->product == 0x028e);
    assert_true(info->axis_count == 6 && info->button_count == 11 && info->hat_count == 1);
}

static void test_its_sticks_triggers_cross_and_buttons_are_told(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    FakePad *pad = plug(fixture, 3, &event);
    send(pad, (FakePadHands){-0.5, 1.0, 0.25, -1.0, 0.0, 1.0, 0x1001});
    assert_true(fake_wait(fixture->devices, DEVICE_REPORT, &event));
    const double *axes = event.state.axes;
    print_message("%g %g %g %g %g %g, hat %d, buttons %llx\n", axes[0], axes[1], axes[2], axes[3], axes[4], axes[5],
                  event.state.hats[0], (unsigned long long)event.state.buttons[0]);
    static const double expected[6] = {-0.5, -1.0, 0.25, 1.0, -1.0, 1.0};
    for (int i = 0; i < 6; i++)
        assert_true(fabs(axes[i] - expected[i]) < 1e-4);
    assert_true(event.state.hats[0] == 0 && event.state.buttons[0] == 1u << XBOX_A);
}

static void test_other_messages_are_passed_over_and_damaged_ones_said_once(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    Heard others, heard;
    FakePad *pad = plug(fixture, 3, &event);
    heard_begin(&others);
    fake_pad_send(pad, (const uint8_t[]){1, 3, 6}, 3);
    fake_pad_send(pad, (const uint8_t[]){8, 3, 0}, 3);
    device_fixture_sleep_ms(50);
    heard_end();
    heard_begin(&heard);
    fake_pad_send(pad, (const uint8_t[20]){0, 20, 0xff, 0xff}, 19);
    fake_pad_send(pad, (const uint8_t[32]){0, 20, 0xff, 0xff}, 32);
    fake_pad_send(pad, (const uint8_t[1]){0}, 0);
    device_fixture_sleep_ms(50);
    int events = devices_poll(fixture->devices, &event, 1);
    send(pad, (FakePadHands){.left_x = 0.5});
    bool arrived = fake_wait(fixture->devices, DEVICE_REPORT, &event);
    heard_end();
    print_message("%d events of 5 such messages; x %g of a whole report, expected 0.5; said: %s", events,
                  event.state.axes[0], heard.text);
    assert_true(events == 0 && arrived && fabs(event.state.axes[0] - 0.5) < 1e-4);
    assert_true(others.warnings == 0 && heard.warnings == 1);
}

static void test_it_leaves_and_comes_back(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    for (int round = 0; round < 3; round++) {
        FakePad *pad = plug(fixture, 3 + round, &event);
        assert_int_equal(event.slot, 0);
        send(pad, (FakePadHands){.left_x = 0.1 * round});
        assert_true(fake_wait(fixture->devices, DEVICE_REPORT, &event));
        assert_true(fabs(event.state.axes[0] - 0.1 * round) < 1e-4);
        int64_t begin_ns = clock_now_ns();
        fake_pad_unplug(pad);
        assert_true(fake_wait(fixture->devices, DEVICE_LEFT, &event));
        print_message("left %.1f ms after it was pulled\n", (double)(clock_now_ns() - begin_ns) * 1e-6);
        assert_int_equal(event.slot, 0);
    }
}

static void test_what_is_there_at_the_start_is_found(void **state) {
    DeviceFixture *fixture = *state;
    Devices *devices;
    DeviceEvent event, first;
    devices_destroy(&fixture->devices);
    fake_pad_plug(fixture->bed, 3, FAKE_FREE);
    assert_int_equal(devices_create(NULL, &devices), RESULT_OK);
    assert_true(devices_wait(devices, 20.0));
    int count = devices_poll(devices, &first, 1), more = devices_poll(devices, &event, 1);
    devices_destroy(&devices);
    print_message("%d and %d events, kind %d\n", count, more, first.kind);
    assert_true(count == 1 && more == 0 && first.kind == DEVICE_ARRIVED && first.info.bus == PAD_BUS_USB);
}

static void print_rumbles(const uint8_t rumbles[][8], int count) {
    for (int i = 0; i < count; i++)
        print_message("%02x %02x %02x %02x %02x %02x %02x %02x\n", rumbles[i][0], rumbles[i][1], rumbles[i][2],
                      rumbles[i][3], rumbles[i][4], rumbles[i][5], rumbles[i][6], rumbles[i][7]);
}

static void test_motors_start_change_and_stop_by_themselves(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    uint8_t rumbles[FAKE_RUMBLES_MAX][8];
    FakePad *pad = plug(fixture, 3, &event);
    devices_rumble(fixture->devices, 7, 1.0, 1.0, 1.0); // a slot that is empty
    devices_rumble(fixture->devices, -1, 1.0, 1.0, 1.0);
    devices_rumble(fixture->devices, 0, 1.0, 1.0, (double)NAN);
    devices_rumble(fixture->devices, event.slot, 1.0, 0.2, 5.0);
    device_fixture_sleep_ms(50);
    devices_rumble(fixture->devices, event.slot, 1.0, 0.2, 5.0); // the same again is no message
    device_fixture_sleep_ms(50);
    devices_rumble(fixture->devices, event.slot, 0.0, 0.5, 0.1);
    device_fixture_sleep_ms(50);
    int early = fake_pad_rumbles(pad, rumbles);
    device_fixture_sleep_ms(200);
    int count = fake_pad_rumbles(pad, rumbles);
    print_rumbles(rumbles, count);
    assert_int_equal(early, 2);
    assert_int_equal(count, 3);
    assert_memory_equal(rumbles[0], ((const uint8_t[8]){0, 8, 0, 255, 51, 0, 0, 0}), 8);
    assert_memory_equal(rumbles[1], ((const uint8_t[8]){0, 8, 0, 0, 128, 0, 0, 0}), 8);
    assert_memory_equal(rumbles[2], ((const uint8_t[8]){0, 8, 0, 0, 0, 0, 0, 0}), 8);
}

static void test_motors_stop_when_the_program_ends(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    uint8_t rumbles[FAKE_RUMBLES_MAX][8];
    FakePad *pad = plug(fixture, 3, &event);
    devices_rumble(fixture->devices, event.slot, 0.6, 0.6, 10.0);
    device_fixture_sleep_ms(50);
    int64_t begin_ns = clock_now_ns();
    devices_destroy(&fixture->devices);
    double ms = (double)(clock_now_ns() - begin_ns) * 1e-6;
    int count = fake_pad_rumbles(pad, rumbles);
    print_rumbles(rumbles, count);
    print_message("ended within %.1f ms\n", ms);
    assert_int_equal(count, 2);
    assert_true(rumbles[1][3] == 0 && rumbles[1][4] == 0 && ms < 1000.0);
}

static void test_the_kernel_lends_a_pad_and_gets_it_back(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    FakePad *pad = fake_pad_plug(fixture->bed, 3, FAKE_KERNEL);
    assert_true(fake_wait(fixture->devices, DEVICE_ARRIVED, &event));
    send(pad, (FakePadHands){.left_x = 0.5});
    assert_true(fake_wait(fixture->devices, DEVICE_REPORT, &event));
    assert_false(fake_pad_is_with_kernel(pad));
    devices_destroy(&fixture->devices);
    assert_true(fake_pad_is_with_kernel(pad));
}

static void test_a_pad_that_another_program_holds_is_said_once_and_read_when_it_lets_go(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event, more;
    Heard heard;
    heard_begin(&heard);
    FakePad *pad = fake_pad_plug(fixture->bed, 3, FAKE_HELD);
    bool denied = fake_wait(fixture->devices, DEVICE_DENIED, &event);
    device_fixture_sleep_ms(1200);
    int count = devices_poll(fixture->devices, &more, 1);
    fake_pad_let_go(pad);
    bool arrived = fake_wait(fixture->devices, DEVICE_ARRIVED, &more);
    heard_end();
    print_message("denied: %d, error %d, expected %d; %d more events; said: %s", denied, event.error, EBUSY, count,
                  heard.text);
    assert_true(denied && event.error == EBUSY && count == 0 && heard.warnings == 1);
    assert_true(arrived && more.slot == event.slot);
}

static void expect_one_event(DeviceQueue *queue, DeviceEventKind kind, int slot) {
    DeviceEvent event = {.slot = -1};
    int count = 0;
    int64_t until_ns = clock_now_ns() + 20 * INT64_C(1000000000);
    while ((count = device_queue_take(queue, &event, 1)) == 0 && clock_now_ns() < until_ns)
        device_fixture_sleep_ms(5);
    assert_int_equal(count, 1);
    assert_true(event.kind == kind && event.slot == slot);
}

static void test_a_pad_too_many_arrives_when_another_leaves(void **state) {
    DeviceFixture *fixture = *state;
    DeviceQueue *queue;
    UsbSource *source;
    PadInfo other = {.bus = PAD_BUS_HID};
    Heard heard;
    devices_destroy(&fixture->devices);
    assert_int_equal(device_queue_create(NULL, &queue), RESULT_OK);
    for (int slot = 0; slot < DEVICES_MAX; slot++) {
        assert_int_equal(device_queue_join(queue, &other, 0), slot);
        expect_one_event(queue, DEVICE_ARRIVED, slot);
    }
    FakePad *pad = fake_pad_plug(fixture->bed, 3, FAKE_KERNEL);
    heard_begin(&heard);
    assert_int_equal(usb_source_create(queue, &source), RESULT_OK);
    while (!usb_source_looked(source))
        device_fixture_sleep_ms(5);
    heard_end();
    print_message("said: %s", heard.text);
    assert_true(heard.warnings == 1 && strstr(heard.text, "16 devices are there already"));
    assert_true(fake_pad_is_with_kernel(pad));
    device_queue_leave(queue, 3);
    expect_one_event(queue, DEVICE_LEFT, 3);
    expect_one_event(queue, DEVICE_ARRIVED, 3);
    assert_false(fake_pad_is_with_kernel(pad));
    usb_source_destroy(&source);
    device_queue_destroy(&queue);
}

static void send_x(void *pad, double x) {
    send(pad, (FakePadHands){.left_x = x});
}

static void test_a_report_is_an_event_within_a_step(void **state) {
    DeviceEvent event;
    FakePad *pad = plug(*state, 3, &event);
    device_fixture_time_reports(*state, send_x, pad, 1e-4, "from the report's send to its event");
}

static void *plug_one(DeviceFixture *fixture, int round) {
    return fake_pad_plug(fixture->bed, 3 + round, FAKE_FREE);
}

static void pull_one(DeviceFixture *fixture, void *pad) {
    devices_rumble(fixture->devices, 0, 1.0, 1.0, 5.0);
    send(pad, (FakePadHands){.left_x = 0.5});
    fake_pad_unplug(pad);
}

static void test_a_poll_does_not_wait_while_devices_come_and_go(void **state) {
    device_fixture_time_changes(*state, plug_one, pull_one, 6, "a poll while pads come and go");
}

static void test_nobody_polls_and_the_newest_reports_are_kept(void **state) {
    DeviceFixture *fixture = *state;
    DeviceEvent event;
    static DeviceEvent events[300];
    FakePad *pad = plug(fixture, 3, &event);
    for (int i = 0; i < 300; i++) {
        send(pad, (FakePadHands){.left_x = i / 300.0});
        if (i % 100 == 99)
            device_fixture_sleep_ms(20);
    }
    int64_t until_ns = clock_now_ns() + 20 * INT64_C(1000000000);
    while (devices_lost(fixture->devices) < 300 - 256 && clock_now_ns() < until_ns)
        device_fixture_sleep_ms(5);
    int count = devices_poll(fixture->devices, events, 300);
    print_message("%d events of 300 reports, %lld lost, last x %g\n", count, (long long)devices_lost(fixture->devices),
                  events[count - 1].state.axes[0]);
    assert_int_equal(count, 256);
    assert_int_equal(devices_lost(fixture->devices), 44);
    assert_true(fabs(events[255].state.axes[0] - 299 / 300.0) < 1e-4);
}

#define DEVICE_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, device_fixture_tear_down)

int main(void) {
    const struct CMUnitTest tests[] = {
        DEVICE_TEST(test_a_pad_arrives_with_its_name_and_parts),
        DEVICE_TEST(test_its_sticks_triggers_cross_and_buttons_are_told),
        DEVICE_TEST(test_other_messages_are_passed_over_and_damaged_ones_said_once),
        DEVICE_TEST(test_it_leaves_and_comes_back),
        DEVICE_TEST(test_what_is_there_at_the_start_is_found),
        DEVICE_TEST(test_motors_start_change_and_stop_by_themselves),
        DEVICE_TEST(test_motors_stop_when_the_program_ends),
        DEVICE_TEST(test_the_kernel_lends_a_pad_and_gets_it_back),
        DEVICE_TEST(test_a_pad_that_another_program_holds_is_said_once_and_read_when_it_lets_go),
        DEVICE_TEST(test_a_pad_too_many_arrives_when_another_leaves),
        DEVICE_TEST(test_a_report_is_an_event_within_a_step),
        DEVICE_TEST(test_a_poll_does_not_wait_while_devices_come_and_go),
        DEVICE_TEST(test_nobody_polls_and_the_newest_reports_are_kept),
    };
    return fake_bed_works() ? cmocka_run_group_tests(tests, NULL, NULL) : 77;
}
