// Joystick profiles and calibrations: what files give, how broken ones are refused, and which file a pad gets.
#define _GNU_SOURCE
#include "app/joystick/joystick_files.h"
#include "tests/heard.h"

#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "config/joystick_calibration.h"
#include "tests/hid_support.h"

#define MUTATIONS 20000

typedef struct Home {
    char folder[64]; // XDG_CONFIG_HOME and XDG_STATE_HOME
} Home;

static void write_file(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static size_t read_whole(const char *path, char *bytes, size_t room) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t count = fread(bytes, 1, room, file);
    fclose(file);
    return count;
}

static int make_home(void **state) {
    static Home home;
    char path[128];
    strcpy(home.folder, "/tmp/overfly-XXXXXX");
    assert_non_null(mkdtemp(home.folder));
    setenv("XDG_CONFIG_HOME", home.folder, 1);
    setenv("XDG_STATE_HOME", home.folder, 1);
    snprintf(path, sizeof path, "%s/overfly", home.folder);
    assert_int_equal(mkdir(path, 0700), 0);
    snprintf(path, sizeof path, "%s/overfly/joysticks", home.folder);
    assert_int_equal(mkdir(path, 0700), 0);
    *state = &home;
    return 0;
}

static int remove_home(void **state) {
    char command[128];
    snprintf(command, sizeof command, "rm -r '%s'", ((Home *)*state)->folder);
    return system(command) == 0 ? 0 : -1;
}

static void write_profile(void **state, const char *name, const char *text, char path[128]) {
    snprintf(path, 128, "%s/overfly/joysticks/%s", ((Home *)*state)->folder, name);
    write_file(path, text);
}

static PadInfo pad_of(uint16_t vendor, uint16_t product, const char *name) {
    PadInfo info = {.vendor = vendor,
                    .product = product,
                    .axis_count = 5,
                    .axes = {PAD_AXIS_X, PAD_AXIS_Y, PAD_AXIS_RZ, PAD_AXIS_SLIDER, PAD_AXIS_SLIDER}};
    snprintf(info.name, sizeof info.name, "%s", name);
    return info;
}

static void a_whole_profile_is_read(void **state) {
    char path[128];
    write_profile(state, "mine.joystick",
                  "# A stick\n[device]\nid = 1234:abCD\nname = My *\n"
                  "[axis x]\ncontrol = aileron\ndead-band = 0.1\npower = 2\ninvert = yes\n"
                  "[axis slider 2]\nfactor = -0.5\noffset = -1\ncontrol = throttle\n"
                  "[button 1]\naction = view-next\n[button 128]\ncontrol = flaps\nstep = -0.25\n"
                  "[hat 1 left]\ncontrol = brakes\nhold = 0.5\n",
                  path);
    PadProfile profile;
    assert_int_equal(joystick_read_profile(path, &profile), RESULT_OK);
    assert_string_equal(profile.name, "mine");
    assert_int_equal(profile.axis_count, 2);
    const AxisMapping *x = &profile.axes[0], *slider = &profile.axes[1];
    assert_true(x->axis == PAD_AXIS_X && x->ordinal == 1 && x->control == PAD_CONTROL_AILERON && x->invert);
    assert_true(x->dead_band == 0.1 && x->power == 2.0 && x->offset == 0.0 && x->factor == 1.0);
    assert_true(slider->axis == PAD_AXIS_SLIDER && slider->ordinal == 2 && slider->control == PAD_CONTROL_THROTTLE);
    assert_true(slider->offset == -1.0 && slider->factor == -0.5 && slider->power == 1.0 && !slider->invert);
    assert_int_equal(profile.button_count, 3);
    const ButtonMapping *first = &profile.buttons[0], *second = &profile.buttons[1], *hat = &profile.buttons[2];
    assert_true(!first->is_hat && first->number == 1 && first->does == BUTTON_ACTION);
    assert_int_equal(first->action, ACTION_VIEW_NEXT);
    assert_true(second->number == 128 && second->does == BUTTON_STEP && second->control == PAD_CONTROL_FLAPS);
    assert_true(second->amount == -0.25);
    assert_true(hat->is_hat && hat->number == 1 && hat->direction == 6 && hat->does == BUTTON_HOLD);
    assert_true(hat->control == PAD_CONTROL_BRAKES && hat->amount == 0.5);
}

static void broken_profiles_are_refused_with_file_and_line(void **state) {
    static const struct {
        const char *text, *said;
    } broken[] = {
        {"[device]\nid = 1:2\n", ":2: id: expected VENDOR:PRODUCT"},
        {"[device]\nid = 046d:c21g\n", ":2: id: expected VENDOR:PRODUCT"},
        {"[device]\nnames = x\n", ":2: there is no key 'names'; did you mean 'name'?"},
        {"[axis x]\ncontrol = aileron\n", "the profile is for no device"},
        {"[device]\nname = a\n[axis x]\ncontrol = ailron\n",
         ":4: there is no control 'ailron'; did you mean 'aileron'?"},
        {"[device]\nname = a\n[axis x]\ndeadband = 0.1\n", ":4: there is no key 'deadband'; did you mean 'dead-band'?"},
        {"[device]\nname = a\n[axis x]\ndead-band = 1\n", ":4: dead-band: expected a number from 0 to 0.9, found '1'"},
        {"[device]\nname = a\n[axis x]\npower = nan\n", ":4: power: expected a number from 0.2 to 5, found 'nan'"},
        {"[device]\nname = a\n[axis x]\nfactor = 0\n", ":4: factor: 0 does nothing"},
        {"[device]\nname = a\n[axis x]\nfactor = 1e999\n", ":4: factor: expected a number"},
        {"[device]\nname = a\n[axis x]\ninvert = true\n", ":4: there is no invert 'true'; expected one of no, yes"},
        {"[device]\nname = a\n[axis x]\npower = 1\n", ":4: the axis moves nothing"},
        {"[device]\nname = a\n[axis slidr]\ncontrol = flaps\n", ":4: there is no axis 'slidr'; did you mean 'slider'?"},
        {"[device]\nname = a\n[axis x 33]\ncontrol = flaps\n", ":4: there is no axis 'x 33'"},
        {"[device]\nname = a\n[button 0]\naction = pause\n", ":4: expected [button 1] to [button 128]"},
        {"[device]\nname = a\n[button 129]\naction = pause\n", ":4: expected [button 1] to [button 128]"},
        {"[device]\nname = a\n[button]\naction = pause\n", ":4: expected [button 1] to [button 128]"},
        {"[device]\nname = a\n[hat 1]\naction = pause\n", ":4: expected [hat 1 up] to [hat 4 left]"},
        {"[device]\nname = a\n[hat 5 up]\naction = pause\n", ":4: expected [hat 1 up] to [hat 4 left]"},
        {"[device]\nname = a\n[button 1]\naction = puase\n", ":4: there is no action 'puase'; did you mean 'pause'?"},
        {"[device]\nname = a\n[button 1]\ncontrol = trim\n",
         ":4: a button has either 'action', or 'control' and one of"},
        {"[device]\nname = a\n[button 1]\naction = pause\nstep = 1\n", ":4: a button has either 'action', or"},
        {"[device]\nname = a\n[buton 1]\naction = pause\n", ":4: there is no section 'buton'; did you mean 'button'?"},
        {"[device]\nname a\n", ":2: expected"},
    };
    for (size_t i = 0; i < COUNT_OF(broken); i++) {
        char path[128];
        PadProfile profile;
        Heard heard;
        write_profile(state, "broken.txt", broken[i].text, path);
        heard_begin(&heard);
        Result result = joystick_read_profile(path, &profile);
        heard_end();
        if (result != RESULT_FORMAT || heard.errors != 1 || !strstr(heard.text, broken[i].said) ||
            !strstr(heard.text, path))
            fail_msg("%s: %s, %d messages: %s; expected one with \"%s\"", broken[i].text, result_name(result),
                     heard.errors, heard.text, broken[i].said);
    }
}

static void a_missing_profile_is_named(void **state) {
    (void)state;
    PadProfile profile;
    Heard heard;
    heard_begin(&heard);
    assert_int_equal(joystick_read_profile("/nowhere/x.joystick", &profile), RESULT_NOT_FOUND);
    heard_end();
    assert_int_equal(heard.errors, 1);
    assert_non_null(strstr(heard.text, "/nowhere/x.joystick"));
}

static void expect_profile(uint16_t vendor, uint16_t product, const char *name, const char *expected) {
    PadInfo info = pad_of(vendor, product, name);
    PadProfile profile = {.name = ""};
    char path[PATHS_BYTES_MAX];
    Result result = joystick_find_profile(&info, &profile, path);
    if (result != (*expected ? RESULT_OK : RESULT_NOT_FOUND) || strcmp(profile.name, expected) != 0)
        fail_msg("%04x:%04x %s: %s, profile '%s'; expected '%s'", vendor, product, name, result_name(result),
                 profile.name, expected);
}

static void pads_get_the_profiles_that_came_along(void **state) {
    (void)state;
    expect_profile(0x046d, 0xc215, "Logitech Logitech Extreme 3D", "logitech-extreme-3d-pro");
    expect_profile(0x044f, 0xb10a, "Thrustmaster T.16000M", "thrustmaster-t16000m");
    expect_profile(0x06a3, 0x075c, "Logitech X52 H.O.T.A.S.", "saitek-x52");
    expect_profile(0x044f, 0xb679, "T-Rudder", "rudder-pedals-thrustmaster");
    expect_profile(0x045e, 0x028e, "Controller", "xbox-360-pad");
    expect_profile(0x1bad, 0xf016, "Mad Catz xbox 360 Controller", "xbox-360-pad");
    expect_profile(0x1234, 0x5678, "Unheard Of", "");
}

static void users_profiles_come_first_and_ids_before_names(void **state) {
    char path[128];
    const char *name_only = "[device]\nname = *extreme 3d*\n[axis x]\ncontrol = rudder\n";
    write_profile(state, "a.joystick", "[device]\nname = nothing\n[axis x\n", path); // broken: passed over
    write_profile(state, "b.joystick", name_only, path);
    write_profile(state, "c.joystick", "[device]\nid = 046D:C215\n[axis x]\ncontrol = trim\n", path);
    write_profile(state, "d.txt", "[device]\nid = 046d:c215\n[axis x]\ncontrol = trim\n", path);
    Heard heard;
    heard_begin(&heard);
    expect_profile(0x046d, 0xc215, "Logitech Extreme 3D", "c");
    heard_end();
    assert_int_equal(heard.errors, 1);
    assert_non_null(strstr(heard.text, "a.joystick:3"));
    heard_begin(&heard);
    expect_profile(0x046d, 0x0001, "Logitech Extreme 3D", "b");
    expect_profile(0x044f, 0xb10a, "Thrustmaster T.16000M", "thrustmaster-t16000m");
    heard_end();
}

static void patterns_stand_for_any_letters(void **state) {
    (void)state;
    static const struct {
        const char *pattern, *name;
        bool fits;
    } cases[] = {
        {"*", "", true},
        {"*", "x", true},
        {"a*c", "AbbbC", true},
        {"a?c", "abc", true},
        {"a?c", "ac", false},
        {"abc", "abcd", false},
        {"*bc", "abcbc", true},
        {"*b*d*", "abcde", true},
        {"*b*d", "abcde", false},
        {"", "x", false},
        {"**a**", "bab", true},
        {"x*", "ax", false},
        {"a*b*c", "a_b_b_c", true},
        {"?", "", false},
        {"abc*", "abc", true},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        JoystickProfile profile = {.name_count = 1};
        snprintf(profile.names[0], sizeof profile.names[0], "%s", cases[i].pattern);
        bool fits = joystick_profile_fit(&profile, 1, 2, cases[i].name) == JOYSTICK_FITS_NAME;
        if (fits != cases[i].fits)
            fail_msg("%s and %s: %d, expected %d", cases[i].pattern, cases[i].name, fits, cases[i].fits);
    }
}

static void the_example_of_the_manual_is_sound(void **state) {
    static char page[32768];
    page[read_whole(SOURCE_DIR "/docs/joystick.md", page, sizeof page - 1)] = '\0';
    char path[128], *begin = strstr(page, "```ini\n"), *end = begin ? strstr(begin + 7, "```") : NULL;
    assert_non_null(end);
    *end = '\0';
    write_profile(state, "example.joystick", begin + 7, path);
    PadProfile profile;
    assert_int_equal(joystick_read_profile(path, &profile), RESULT_OK);
    assert_int_equal(profile.axis_count, 3);
    assert_int_equal(profile.button_count, 4);
}

static void every_profile_that_came_along_is_sound(void **state) {
    (void)state;
    DIR *folder = opendir(SOURCE_DIR "/assets/data/joysticks");
    assert_non_null(folder);
    int count = 0;
    for (struct dirent *entry = readdir(folder); entry; entry = readdir(folder)) {
        char path[512];
        PadProfile profile;
        if (entry->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, SOURCE_DIR "/assets/data/joysticks/%s", entry->d_name);
        assert_int_equal(joystick_read_profile(path, &profile), RESULT_OK);
        assert_true(profile.axis_count > 0);
        count++;
    }
    closedir(folder);
    assert_true(count >= 6);
}

static bool has_axis(const PadInfo *info, const AxisMapping *mapping) {
    int ordinal = 0;
    for (int i = 0; i < info->axis_count; i++)
        ordinal += info->axes[i] == mapping->axis;
    return mapping->ordinal <= ordinal;
}

// What a profile moves, the device's own descriptor has.
static void profiles_that_came_along_fit_the_published_descriptors(void **state) {
    (void)state;
    static const struct {
        const char *file;
        const HidSample *sample;
    } pairs[] = {{"logitech-extreme-3d-pro", &hid_extreme3d},
                 {"thrustmaster-t16000m", &hid_t16000m},
                 {"thrustmaster-t16000m", &hid_t16000m_short},
                 {"thrustmaster-twcs", &hid_twcs},
                 {"saitek-x52", &hid_x52},
                 {"rudder-pedals-thrustmaster", &hid_t_rudder}};
    for (size_t i = 0; i < COUNT_OF(pairs); i++) {
        char path[512];
        PadProfile profile;
        HidDescriptor descriptor;
        PadInfo info = {.bus = PAD_BUS_HID};
        snprintf(path, sizeof path, SOURCE_DIR "/assets/data/joysticks/%s.joystick", pairs[i].file);
        assert_int_equal(joystick_read_profile(path, &profile), RESULT_OK);
        assert_int_equal(hid_descriptor_parse(pairs[i].sample->bytes, pairs[i].sample->count, &descriptor), RESULT_OK);
        hid_describe(&descriptor, &info);
        for (int k = 0; k < profile.axis_count; k++)
            if (!has_axis(&info, &profile.axes[k]))
                fail_msg("%s: %s lacks axis %s %d", pairs[i].file, pairs[i].sample->name,
                         pad_axis_name(profile.axes[k].axis), profile.axes[k].ordinal);
        for (int k = 0; k < profile.button_count; k++)
            if (profile.buttons[k].number > (profile.buttons[k].is_hat ? info.hat_count : info.button_count))
                fail_msg("%s: %s lacks button or hat %d", pairs[i].file, pairs[i].sample->name,
                         profile.buttons[k].number);
    }
}

// ---- Calibration ----

static void a_calibration_is_kept_for_its_pad(void **state) {
    (void)state;
    PadInfo first = pad_of(0x1111, 0x2222, "one"), second = pad_of(0x3333, 0x4444, "two");
    PadCalibration calibration = {.axes = {[0] = {true, 0.01, -0.9, 0.95}, [4] = {true, -0.25, -0.5, 0.75}}}, found;
    assert_int_equal(joystick_load_calibration(&first, &found), RESULT_NOT_FOUND);
    assert_int_equal(joystick_save_calibration(&first, &calibration), RESULT_OK);
    calibration.axes[0].centre = 0.5;
    assert_int_equal(joystick_save_calibration(&second, &calibration), RESULT_OK);
    calibration.axes[0].centre = 0.0625;
    assert_int_equal(joystick_save_calibration(&first, &calibration), RESULT_OK);
    assert_int_equal(joystick_load_calibration(&first, &found), RESULT_OK);
    for (int i = 0; i < PAD_AXES_MAX; i++) {
        const AxisCalibration *a = &calibration.axes[i], *b = &found.axes[i];
        if (a->known != b->known || a->centre != b->centre || a->min != b->min || a->max != b->max)
            fail_msg("axis %d: %d %g %g %g, expected %d %g %g %g", i, b->known, b->centre, b->min, b->max, a->known,
                     a->centre, a->min, a->max);
    }
    assert_int_equal(joystick_load_calibration(&second, &found), RESULT_OK);
    assert_true(found.axes[0].centre == 0.5);
    PadInfo third = pad_of(0x1111, 0x2223, "three");
    assert_int_equal(joystick_load_calibration(&third, &found), RESULT_NOT_FOUND);
}

static void broken_calibrations_are_refused_with_file_and_line(void **state) {
    static const struct {
        const char *text, *said;
    } broken[] = {
        {"x = 0, -1, 1\n", ":1: expected a section such as [046d:c215]"},
        {"[046d:c215]\nq = 0, -1, 1\n", ":2: expected an axis"},
        {"[046d:c215]\nx = 0, -1\n", ":2: expected CENTRE, MIN, MAX"},
        {"[046d:c215]\nx = 0, 1, -1\n", ":2: expected -1 <= MIN"},
        {"[046d:c215]\nx = 0, -1, 1.5\n", ":2: expected -1 <= MIN"},
        {"[046d:c215]\nx = 0.5, 0.5, 0.5\n", ":2: expected -1 <= MIN"},
    };
    for (size_t i = 0; i < COUNT_OF(broken); i++) {
        char path[128];
        PadInfo info = pad_of(0x046d, 0xc215, "one");
        PadCalibration calibration = {.axes = {{.known = false}}};
        Heard heard;
        snprintf(path, sizeof path, "%s/overfly/calibration.conf", ((Home *)*state)->folder);
        write_file(path, broken[i].text);
        heard_begin(&heard);
        Result result = joystick_load_calibration(&info, &calibration);
        Result saved = joystick_save_calibration(&info, &calibration); // and does not destroy it
        heard_end();
        if (result != RESULT_FORMAT || saved != RESULT_FORMAT || heard.errors != 2 ||
            !strstr(heard.text, broken[i].said))
            fail_msg("%s: %s, %s, %d messages: %s; expected \"%s\"", broken[i].text, result_name(result),
                     result_name(saved), heard.errors, heard.text, broken[i].said);
    }
}

// ---- Hostile bytes ----

static void drop_message(void *user, LogLevel level, const char *message) {
    (void)user, (void)level, (void)message;
}

static void put_bytes(int file, const char *bytes, size_t count) {
    assert_int_equal(ftruncate(file, 0), 0);
    assert_int_equal(pwrite(file, bytes, count, 0), count);
}

static void expect_finite(const PadProfile *profile) {
    for (int i = 0; i < profile->axis_count; i++) {
        double value = profile_axis_value(&profile->axes[i], -0.37);
        if (!(isfinite(value) && fabs(value) <= 1.0))
            fail_msg("axis %d is at %g", i, value);
    }
}

static void hostile_profiles_are_read_or_refused(void **state) {
    (void)state;
    char bytes[4096], changed[4096], path[128];
    size_t count =
        read_whole(SOURCE_DIR "/assets/data/joysticks/logitech-extreme-3d-pro.joystick", bytes, sizeof bytes);
    uint64_t random = 20260102;
    int read = 0, memory = memfd_create("profile", 0);
    snprintf(path, sizeof path, "/proc/self/fd/%d", memory);
    log_set_sink(drop_message, NULL);
    for (int i = 0; i < MUTATIONS; i++) {
        PadProfile profile;
        memcpy(changed, bytes, count);
        for (int k = 0; k < 1 + i % 4; k++) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            changed[(random >> 33) % count] = (char)(random >> 24);
        }
        put_bytes(memory, changed, i % 5 == 0 ? (random >> 40) % count : count);
        if (joystick_read_profile(path, &profile) != RESULT_OK)
            continue;
        read++;
        expect_finite(&profile);
    }
    log_set_sink(NULL, NULL);
    close(memory);
    assert_in_range(read, MUTATIONS / 100, MUTATIONS - MUTATIONS / 100); // it reads some, and refuses some
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_whole_profile_is_read, make_home, remove_home),
        cmocka_unit_test_setup_teardown(broken_profiles_are_refused_with_file_and_line, make_home, remove_home),
        cmocka_unit_test(a_missing_profile_is_named),
        cmocka_unit_test_setup_teardown(pads_get_the_profiles_that_came_along, make_home, remove_home),
        cmocka_unit_test_setup_teardown(users_profiles_come_first_and_ids_before_names, make_home, remove_home),
        cmocka_unit_test(patterns_stand_for_any_letters),
        cmocka_unit_test_setup_teardown(the_example_of_the_manual_is_sound, make_home, remove_home),
        cmocka_unit_test(every_profile_that_came_along_is_sound),
        cmocka_unit_test(profiles_that_came_along_fit_the_published_descriptors),
        cmocka_unit_test_setup_teardown(a_calibration_is_kept_for_its_pad, make_home, remove_home),
        cmocka_unit_test_setup_teardown(broken_calibrations_are_refused_with_file_and_line, make_home, remove_home),
        cmocka_unit_test(hostile_profiles_are_read_or_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
