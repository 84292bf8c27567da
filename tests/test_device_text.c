// What people are told about devices, whatever bytes these are named with; and waiting for nodes.
#define _POSIX_C_SOURCE 200809L
#include "base/clock.h"
#include "input/devices/device_text.h"
#include "input/devices/node_watch.h"

#include <errno.h>
#include <fnmatch.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static void expect_name(const wchar_t *maker, const wchar_t *product, const char *expected) {
    PadInfo info = {.vendor = 0x44f, .product = 0xb10a};
    device_text_name(maker, product, &info);
    print_message("'%s', expected '%s'\n", info.name, expected);
    assert_string_equal(info.name, expected);
}

static void test_names_are_put_together_and_made_harmless(void **state) {
    (void)state;
    expect_name(L"Thrustmaster", L"T.16000M", "Thrustmaster T.16000M");
    expect_name(L"Logitech", L"Logitech Extreme 3D", "Logitech Extreme 3D");
    expect_name(L"", L"Stick", "Stick");
    expect_name(L"Maker", NULL, "Maker");
    expect_name(NULL, NULL, "044f:b10a");
    expect_name(L"  ", L" Wide   ", "Wide");
    expect_name(L"M\u00fcller", L"\u2708", "M\u00fcller \u2708");
    expect_name(NULL, L"\x1b[31mred\x9b", "\ufffd[31mred\ufffd");
    wchar_t endless[400];
    for (size_t i = 0; i < COUNT_OF(endless); i++)
        endless[i] = L'\u2708';
    endless[COUNT_OF(endless) - 1] = L'\0';
    PadInfo info = {0};
    device_text_name(endless, L"Stick", &info);
    size_t length = strlen(info.name);
    print_message("%zu bytes of %d\n", length, PAD_NAME_BYTES);
    assert_true(length > 60 && (length - strlen(" Stick")) % 3 == 0); // whole letters, of three bytes each
    device_text_name_bytes("Maker\x80", "P\tad", &info);
    assert_string_equal(info.name, "Maker\ufffd P\ufffdad");
}

static void test_a_rule_names_the_device_on_any_bus(void **state) {
    (void)state;
    char text[DEVICE_TEXT_BYTES];
    PadInfo info = {.bus = PAD_BUS_HID, .vendor = 0x44f, .product = 0xb10a, .axis_count = 1, .button_count = 12};
    device_text_rule(&info, text);
    assert_string_equal(text, "KERNEL==\"hidraw*\", KERNELS==\"*:044F:B10A.*\", TAG+=\"uaccess\"");
    info.bus = PAD_BUS_USB;
    device_text_rule(&info, text);
    assert_string_equal(text,
                        "SUBSYSTEM==\"usb\", ATTR{idVendor}==\"044f\", ATTR{idProduct}==\"b10a\", TAG+=\"uaccess\"");
    strcpy(info.name, "Stick");
    strcpy(info.path, "/dev/hidraw7");
    device_text_summary(&info, text);
    assert_string_equal(text, "Stick (044f:b10a) at /dev/hidraw7: 1 axis, 12 buttons, 0 hats");
}

static void test_the_remedy_is_that_of_the_cause(void **state) {
    (void)state;
    char denied[DEVICE_TEXT_BYTES], busy[DEVICE_TEXT_BYTES];
    PadInfo info = {.name = "Stick", .path = "/dev/hidraw7"};
    device_text_denied(&info, EACCES, denied);
    device_text_denied(&info, EBUSY, busy);
    print_message("%s\n%s\n", denied, busy);
    assert_true(strstr(denied, "udev rule") && strstr(denied, "Permission denied") && strstr(denied, "/dev/hidraw7"));
    assert_true(strstr(busy, "another program") && !strstr(busy, "udev"));
}

// "e\"\x05*\"": what udev makes of it.
static void unescape(const char *from, char *to) {
    while (*from && *from != '"') {
        unsigned code;
        if (sscanf(from, "\\x%2x", &code) == 1) {
            *to++ = (char)code;
            from += 4;
        } else {
            *to++ = *from++;
        }
    }
    *to = '\0';
}

// As udev compares: up to the first byte that is 0.
static bool rules_open(const char *descriptor) {
    static const char key[] = "ATTRS{report_descriptor}==e\"";
    char line[512], pattern[512];
    bool opened = false;
    FILE *rules = fopen(SOURCE_DIR "/assets/data/udev/70-overfly.rules", "r");
    assert_non_null(rules);
    while (fgets(line, sizeof line, rules)) {
        const char *at = strstr(line, key);
        if (!at)
            continue;
        assert_non_null(strstr(line, "TAG+=\"uaccess\""));
        unescape(at + strlen(key), pattern);
        opened |= fnmatch(pattern, descriptor, 0) == 0;
    }
    fclose(rules);
    return opened;
}

static void test_the_installed_rules_open_sticks_and_nothing_else(void **state) {
    (void)state;
    static const struct {
        const char *descriptor;
        bool opened;
    } CASES[] = {{"\x05\x01\x09\x04\xa1\x01", true},       // joystick
                 {"\x05\x01\x09\x05\xa1\x01\x85", true},   // gamepad
                 {"\x05\x01\x09\x08\xa1\x01", true},       // multi-axis controller
                 {"\x05\x02\x09\x01\xa1\x01", true},       // flight simulation device
                 {"\x05\x01\x09\x06\xa1\x01", false},      // keyboard
                 {"\x05\x01\x09\x02\xa1\x01", false},      // mouse
                 {"\x05\x01\x09\x07\xa1\x01", false},      // keypad
                 {"\x05\x0c\x09\x01\xa1\x01", false},      // volume keys
                 {"\x06\xd0\xf1\x09\x01\xa1\x01", false}}; // a key for passwords
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        bool opened = rules_open(CASES[i].descriptor);
        print_message("descriptor %zu: %s, expected %s\n", i, opened ? "opened" : "closed",
                      CASES[i].opened ? "opened" : "closed");
        assert_true(opened == CASES[i].opened);
    }
}

static void make_file(const char *folder, const char *name) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fclose(file);
}

static void remove_file(const char *folder, const char *name) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(unlink(path), 0);
}

static void *wake(void *argument) {
    clock_sleep_until_ns(clock_now_ns() + 20000000);
    node_watch_wake(argument);
    return NULL;
}

static void test_a_wait_ends_when_a_node_of_that_name_changes(void **state) {
    (void)state;
    char folder[] = "/tmp/overfly-nodes-XXXXXX";
    NodeWatch watch;
    pthread_t waker;
    assert_non_null(mkdtemp(folder));
    assert_int_equal(node_watch_open(folder, "hidraw", &watch), RESULT_OK);
    assert_true(node_watch_sees(&watch));
    make_file(folder, "tty0");
    assert_false(node_watch_wait(&watch, 50));
    make_file(folder, "hidraw3");
    assert_true(node_watch_wait(&watch, 3000));
    assert_false(node_watch_wait(&watch, 0));
    assert_int_equal(pthread_create(&waker, NULL, wake, &watch), 0);
    assert_true(node_watch_wait(&watch, 3000));
    pthread_join(waker, NULL);
    remove_file(folder, "hidraw3");
    assert_true(node_watch_wait(&watch, 3000));
    node_watch_close(&watch);
    remove_file(folder, "tty0");
    assert_int_equal(rmdir(folder), 0);
}

static void test_a_folder_that_cannot_be_watched_is_said(void **state) {
    (void)state;
    NodeWatch watch;
    assert_int_equal(node_watch_open("/nowhere/at/all", "hidraw", &watch), RESULT_OK);
    assert_false(node_watch_sees(&watch));
    assert_false(node_watch_wait(&watch, 1));
    node_watch_wake(&watch);
    assert_true(node_watch_wait(&watch, 3000));
    node_watch_close(&watch);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names_are_put_together_and_made_harmless),
        cmocka_unit_test(test_a_rule_names_the_device_on_any_bus),
        cmocka_unit_test(test_the_remedy_is_that_of_the_cause),
        cmocka_unit_test(test_the_installed_rules_open_sticks_and_nothing_else),
        cmocka_unit_test(test_a_wait_ends_when_a_node_of_that_name_changes),
        cmocka_unit_test(test_a_folder_that_cannot_be_watched_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
