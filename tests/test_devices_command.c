// overfly devices, as a person and a script run it, with a stick and a pad that are not there.
#define _GNU_SOURCE // setresuid
#include "tests/device_support.h"

#include "base/clock.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#define NOBODY 65534

static int set_up(void **state) {
    *state = fake_bed_create();
    return setenv("XDG_CONFIG_HOME", "/nowhere", 1) || setenv("XDG_STATE_HOME", "/nowhere", 1);
}

static int tear_down(void **state) {
    FakeBed *bed = *state;
    fake_bed_destroy(&bed);
    return 0;
}

static FILE *start(const char *arguments) {
    char command[512];
    fflush(stdout);
    snprintf(command, sizeof command, "%s devices %s", OVERFLY_PROGRAM, arguments);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    return pipe;
}

// What it prints until it ends, which must be well.
static void finish(FILE *pipe, char out[8192]) {
    size_t count = fread(out, 1, 8191, pipe);
    int status = pclose(pipe);
    out[count] = '\0';
    print_message("%s", out);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

static void expect(const char *text, const char *part) {
    if (!strstr(text, part))
        fail_msg("expected '%s' in the above", part);
}

static void test_nothing_is_found_and_it_is_said_what_was_looked_for(void **state) {
    FakeBed *bed = *state;
    char text[8192];
    fake_stick_plug(bed, &FAKE_MOUSE, 0);
    finish(start(""), text);
    expect(text, "No joystick or gamepad was found");
    expect(text, "/dev/hidraw*");
    expect(text, "/dev/bus/usb");
    finish(start("--json"), text);
    expect(text, "\"devices\":\t[]");
}

static void test_sticks_and_pads_are_listed_with_their_profile(void **state) {
    FakeBed *bed = *state;
    char text[8192];
    fake_stick_plug(bed, &FAKE_JOYSTICK, 0);
    FakePad *pad = fake_pad_plug(bed, 3, FAKE_FREE);
    uint8_t report[FAKE_PAD_BYTES];
    fake_pad_report(&(FakePadHands){.left_x = 1.0, .left_trigger = 1.0, .buttons = 0x1008}, report);
    fake_pad_send(pad, report, sizeof report);
    finish(start(""), text);
    expect(text, "Nobody Pretended Stick (044f:b10a)\n  node        /dev/hidraw0, HID\n");
    expect(text, "may be read and written");
    expect(text, "thrustmaster-t16000m.joystick");
    expect(text, "Nobody Pretended Pad (045e:028e)\n  node        /dev/bus/usb/001/003, USB\n");
    expect(text, "  x           32767 of -32768..32767    +1.000   aileron      +1.000\n");
    expect(text, "  x           ?                              ?   aileron           ?\n");
    expect(text, "  brake       255 of 0..255             +1.000   brakes       +1.000\n");
    expect(text, "  hat 1       right   look-x +1.00\n");
    expect(text, "  11 buttons  1 (next view)\n");
}

static void test_json_tells_the_same(void **state) {
    FakeBed *bed = *state;
    char text[8192];
    fake_pad_plug(bed, 3, FAKE_FREE);
    finish(start("--json"), text);
    expect(text, "\"name\":\t\"Nobody Pretended Pad\"");
    expect(text, "\"vendor\":\t\"045e\"");
    expect(text, "\"readable\":\ttrue");
    expect(text, "\"udev_rule\":\t\"SUBSYSTEM==\\\"usb\\\"");
    expect(text, "\"raw\":\tnull");
    expect(text, "\"raw_value\":\tnull,\n\t\t\t\t\t\"raw_min\":\t-32768,\n\t\t\t\t\t\"raw_max\":\t32767");
}

static void test_a_node_that_may_not_be_read_is_told_with_its_remedy(void **state) {
    FakeBed *bed = *state;
    char text[8192];
    if (getuid() != 0) {
        print_message("only root can leave off its rights for a while\n");
        skip();
    }
    fake_bed_open_to_all(bed);
    fake_stick_plug(bed, &FAKE_JOYSTICK, 0);
    assert_int_equal(setresuid(NOBODY, NOBODY, 0), 0);
    FILE *pipe = start("");
    finish(pipe, text);
    assert_int_equal(setresuid(0, 0, 0), 0);
    expect(text, "Permission denied (mode ");
    expect(text, "    KERNEL==\"hidraw*\", KERNELS==\"*:044F:B10A.*\", TAG+=\"uaccess\"\n");
    expect(text, "sudo udevadm control --reload-rules && sudo udevadm trigger");
    expect(text, "70-overfly.rules /etc/udev/rules.d/");
}

static void sleep_ms(int ms) {
    clock_sleep_until_ns(clock_now_ns() + (int64_t)ms * 1000000);
}

static void test_watching_prints_a_line_for_what_changes(void **state) {
    FakeBed *bed = *state;
    char text[8192], line[512];
    uint8_t report[FAKE_STICK_BYTES];
    FakeStick *stick = fake_stick_plug(bed, &FAKE_JOYSTICK, 0);
    FILE *pipe = start("--watch --seconds 2");
    assert_non_null(fgets(line, sizeof line, pipe));
    assert_string_equal(line, "/dev/hidraw0: Nobody Pretended Stick arrived\n");
    fake_joystick_report(0.5, -1.0, 0.0, 1.0, 2, 0x81, report);
    fake_stick_send(stick, report, sizeof report);
    sleep_ms(300);
    fake_stick_unplug(stick);
    finish(pipe, text);
    expect(text, "/dev/hidraw0: x 49151 of 0..65535: +0.500 (aileron ");
    expect(text, " y 0 of 0..65535: -1.000 (elevator -1.000)");
    expect(text, " hat 2 button 1 button 8\n");
    expect(text, "/dev/hidraw0: Nobody Pretended Stick left\n");
}

// ---- Calibrating ----

typedef struct Person {
    char folder[64], fifo[80];
    FILE *sees, *types;
} Person;

// With a state folder of its own.
static void sit_down(Person *person, const char *arguments) {
    char command[256];
    strcpy(person->folder, "/tmp/overfly-calibrate-XXXXXX");
    assert_non_null(mkdtemp(person->folder));
    snprintf(person->fifo, sizeof person->fifo, "%s/keys", person->folder);
    assert_int_equal(mkfifo(person->fifo, 0600), 0);
    setenv("XDG_STATE_HOME", person->folder, 1);
    snprintf(command, sizeof command, "--calibrate %s 2>&1 < %s", arguments, person->fifo);
    person->sees = start(command);
    person->types = fopen(person->fifo, "w");
    assert_non_null(person->types);
}

static void press_enter(Person *person) {
    fputc('\n', person->types);
    fflush(person->types);
}

static void wait_for(Person *person, const char *part) {
    char line[512];
    while (fgets(line, sizeof line, person->sees)) {
        print_message("%s", line);
        if (strstr(line, part))
            return;
    }
    fail_msg("expected '%s'", part);
}

// The exit status.
static int stand_up(Person *person, char text[8192]) {
    text[fread(text, 1, 8191, person->sees)] = '\0';
    int status = pclose(person->sees);
    fclose(person->types);
    unlink(person->fifo);
    print_message("%s", text);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void read_kept(Person *person, char text[8192]) {
    char path[256];
    snprintf(path, sizeof path, "%s/overfly/calibration.conf", person->folder);
    FILE *file = fopen(path, "r");
    text[file ? fread(text, 1, 8191, file) : 0] = '\0';
    if (file)
        fclose(file);
    unlink(path);
    snprintf(path, sizeof path, "%s/overfly", person->folder);
    rmdir(path);
    rmdir(person->folder);
    print_message("%s", text);
}

static void move_stick(FakeStick *stick, double x, double y, double slider) {
    uint8_t report[FAKE_STICK_BYTES];
    fake_joystick_report(x, y, 0.1, slider, -1, 0, report);
    fake_stick_send(stick, report, sizeof report);
    sleep_ms(30);
}

static void test_calibrating_learns_shows_and_keeps(void **state) {
    FakeBed *bed = *state;
    Person person;
    char text[8192], kept[8192];
    FakeStick *stick = fake_stick_plug(bed, &FAKE_JOYSTICK, 0);
    sit_down(&person, "--seconds 20");
    wait_for(&person, "(Enter: they rest.");
    press_enter(&person); // it has said nothing yet, as most sticks that rest
    wait_for(&person, "Now move");
    move_stick(stick, 0.04, -0.02, 0.0);
    move_stick(stick, -0.8, -0.02, 0.0);
    move_stick(stick, 0.9, 0.02, -0.96);
    move_stick(stick, 0.05, -0.02, 0.98);
    press_enter(&person);
    assert_int_equal(stand_up(&person, text), 0);
    expect(text, "  x            -0.800   +0.040   +0.900\n");
    expect(text, "  y            not moved\n");
    expect(text, "2 of 4 axes are kept, for all devices 044f:b10a\n");
    FILE *pipe = start("--watch --seconds 1");
    sleep_ms(500);
    move_stick(stick, 0.9, 0.0, 0.98);
    finish(pipe, text);
    read_kept(&person, kept);
    expect(kept, "[044f:b10a]\nx = ");
    expect(kept, "slider = ");
    expect(text, "x 62258 of 0..65535: +0.900 (aileron +1.000)");
}

static void test_an_axis_that_was_held_has_no_centre_and_is_not_kept(void **state) {
    FakeBed *bed = *state;
    Person person;
    char text[8192];
    FakeStick *stick = fake_stick_plug(bed, &FAKE_JOYSTICK, 0);
    sit_down(&person, "--seconds 20");
    press_enter(&person);
    wait_for(&person, "Now move");
    move_stick(stick, -0.9, 0.0, -1.0); // held to the left, the lever at its end
    move_stick(stick, 0.9, 1.0, 1.0);
    move_stick(stick, 0.0, -1.0, 0.0);
    press_enter(&person);
    assert_int_equal(stand_up(&person, text), 0);
    expect(text, "x seemed to rest at -0.900, near its end, and is not kept");
    expect(text, "2 of 4 axes are kept");
    read_kept(&person, text);
    expect(text, "y = ");
    expect(text, "slider = ");
    assert_null(strstr(text, "\nx = "));
}

static void test_a_calibration_that_is_left_or_never_rests_keeps_nothing(void **state) {
    FakeBed *bed = *state;
    Person person;
    char text[8192];
    sit_down(&person, "--seconds 5");
    int nothing = stand_up(&person, text);
    expect(text, "nothing to calibrate");
    read_kept(&person, text);
    assert_string_equal(text, "");
    fake_stick_plug(bed, &FAKE_JOYSTICK, 0);
    sit_down(&person, "--seconds 0.3");
    int short_of_rest = stand_up(&person, text);
    expect(text, "never left alone");
    read_kept(&person, text);
    assert_string_equal(text, "");
    sit_down(&person, "--json");
    int usage = stand_up(&person, text);
    expect(text, "neither --watch nor --json");
    read_kept(&person, text);
    print_message("exit status %d, %d, %d\n", nothing, short_of_rest, usage);
    assert_true(nothing != 0 && short_of_rest != 0 && usage == 2);
}

#define DEVICE_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void) {
    const struct CMUnitTest tests[] = {
        DEVICE_TEST(test_nothing_is_found_and_it_is_said_what_was_looked_for),
        DEVICE_TEST(test_sticks_and_pads_are_listed_with_their_profile),
        DEVICE_TEST(test_json_tells_the_same),
        DEVICE_TEST(test_a_node_that_may_not_be_read_is_told_with_its_remedy),
        DEVICE_TEST(test_watching_prints_a_line_for_what_changes),
        DEVICE_TEST(test_calibrating_learns_shows_and_keeps),
        DEVICE_TEST(test_an_axis_that_was_held_has_no_centre_and_is_not_kept),
        DEVICE_TEST(test_a_calibration_that_is_left_or_never_rests_keeps_nothing),
    };
    if (!fake_bed_works())
        return 77;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
