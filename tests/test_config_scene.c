// Scene files: what they give, and how broken ones are refused.
#define _DEFAULT_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

#include "config/scene.h"
#include "tests/heard.h"

static void write_scene(char path[], const char *text) {
    int file = mkstemps(path, 6);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), strlen(text));
    close(file);
}

static void a_whole_scene_is_read(void **state) {
    (void)state;
    char path[] = "/tmp/overfly-XXXXXX.scene";
    write_scene(path, "[terrain]\ndem = a/b.tif\ndem = /abs/c.tif\ndatum = ellipsoid\nvoids = hole\nimage = i.jpg\n"
                      "image-bounds = -1,2,3,4\n[start]\nposition = 36.5,-84.2,3000ft\nlook = 270,-5\nspeed = 100kt\n"
                      "[light]\nsun = 120,40\n[demo]\nfile = tour.demo\n");
    Scene scene;
    assert_int_equal(scene_read(path, &scene), RESULT_OK);
    assert_int_equal(scene.dem_count, 2);
    assert_string_equal(scene.dem[0], "/tmp/a/b.tif");
    assert_string_equal(scene.dem[1], "/abs/c.tif");
    assert_int_equal(scene.datum, 2);
    assert_int_equal(scene.voids, 1);
    assert_string_equal(scene.image, "/tmp/i.jpg");
    assert_string_equal(scene.demo, "/tmp/tour.demo");
    assert_true(scene.has_position && scene.has_look && scene.has_speed && scene.has_sun && scene.has_image_bounds);
    assert_true(scene.position[0] == 36.5 && scene.position[2] > 914.39 && scene.position[2] < 914.41);
    assert_true(scene.speed_m_s > 51.44 && scene.speed_m_s < 51.45);
    assert_true(scene.image_bounds[3] == 4.0 && scene.sun[1] == 40.0 && scene.look[0] == 270.0);
    assert_memory_equal(scene.name, "overfly-", 8);
    scene_clear(&scene);
    unlink(path);
}

static void paths_upwards_are_resolved_where_the_file_exists(void **state) {
    (void)state;
    char path[] = "/tmp/overfly-XXXXXX.scene", text[256];
    write_scene(path, ""); // mkstemps chooses the name, which the text then holds
    snprintf(text, sizeof text, "[terrain]\ndem = ../tmp/%s\ndem = ../no/such.tif\n", path + 5);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    Scene scene;
    assert_int_equal(scene_read(path, &scene), RESULT_OK);
    assert_string_equal(scene.dem[0], path);
    assert_string_equal(scene.dem[1], "/tmp/../no/such.tif");
    scene_clear(&scene);
    unlink(path);
}

static void broken_scenes_are_refused_with_file_and_line(void **state) {
    (void)state;
    static const struct {
        const char *text, *said;
    } broken[] = {
        {"[terrain]\ndme = a.tif\n", ":2: a scene has no 'dme' in [terrain]; did you mean 'dem'"},
        {"dem = a.tif\n", ":1: a scene has no 'dem' in []; did you mean 'dem' in [terrain]"},
        {"[terrain]\ndem = a.tif\n[start]\nposition = here\n", ":4: position: expected LATITUDE"},
        {"[light]\nsun = 1,2\n", "names no terrain"},
        {"[terrain]\ndem a.tif\n", ":2: expected"},
        {"[terrain]\ndatum = egm2008\ndem = a.tif\n", ":2: datum: expected one of file, egm96, ellipsoid"},
    };
    for (size_t i = 0; i < COUNT_OF(broken); i++) {
        char path[] = "/tmp/overfly-XXXXXX.scene";
        write_scene(path, broken[i].text);
        Scene scene;
        Heard heard;
        heard_begin(&heard);
        Result result = scene_read(path, &scene);
        heard_end();
        if (result != RESULT_FORMAT || heard.errors != 1 || !strstr(heard.text, broken[i].said))
            fail_msg("%s: %s, %d messages: %s; expected one with \"%s\"", broken[i].text, result_name(result),
                     heard.errors, heard.text, broken[i].said);
        unlink(path);
    }
}

static void a_missing_scene_is_named(void **state) {
    (void)state;
    Scene scene;
    Heard heard;
    heard_begin(&heard);
    assert_int_equal(scene_read("/nowhere/x.scene", &scene), RESULT_NOT_FOUND);
    heard_end();
    assert_int_equal(heard.errors, 1);
    assert_non_null(strstr(heard.text, "/nowhere/x.scene"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_whole_scene_is_read),
        cmocka_unit_test(paths_upwards_are_resolved_where_the_file_exists),
        cmocka_unit_test(broken_scenes_are_refused_with_file_and_line),
        cmocka_unit_test(a_missing_scene_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
