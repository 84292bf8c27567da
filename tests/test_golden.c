// Pictures of the default scene, without a window, beside stored ones. Usage:
//   test_golden OVERFLY             compares with tests/golden/NAME.png; on failure leaves NAME.actual.png and
//                                   NAME.difference.png (four times the difference) in the working folder
//   test_golden OVERFLY --update    writes the stored pictures anew: look at them before you commit them
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#define STBI_ONLY_PNG
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

#include "render/context/context.h"

#define SKIP_STATUS 77
#define ARGUMENTS_MAX 28
#define GOLDEN_FOLDER SOURCE_DIR "/tests/golden"

// The mean difference over all channels, of 255, and the share of pixels in which a channel differs by more than FAR.
// One Mesa version gives the same bytes each time; others round differently, and an edge may move to the next pixel.
// The stored pictures are a software renderer's. Hardware draws several samples a pixel: there, both pictures are
// compared as means of BLOCK x BLOCK pixels, in which smooth and jagged edges are alike.
#define MEAN_MOST 1.5
#define FAR 32
#define FAR_SHARE_MOST 0.01
#define BLOCK 4

typedef struct View {
    const char *name;
    const char *arguments[16];
} View;

#define METHOD_EYE "--eye", "36.47,-84.40,1800m", "--look", "48,-18"

static const View VIEWS[] = {
    {"start", {NULL}},
    {"ridge", {"--eye", "36.530,-84.300,640m", "--look", "60,-3"}},
    {"whole", {"--eye", "36.40,-84.46,7000m", "--look", "48,-24"}},
    {"down", {"--eye", "36.59,-84.25,5000m", "--look", "0,-90", "--fov", "90"}},
    {"low-sun", {"--eye", "36.60,-84.38,1300m", "--look", "95,-8", "--sun", "250,6"}},
    {"levels", {"--colour", "level", "--tau", "4"}},
    {"wireframe", {"--wireframe", "--tau", "6"}},
    {"compare", {"--compare", "brute", "--colour", "level", "--wireframe", "--tau", "6"}},
    {"compare-names", {"--compare", "roam", "--tau", "8", "--wireframe", "--size", "640x400"}},
    {"brute", {"--method", "brute", "--eye", "36.40,-84.46,7000m", "--look", "48,-24"}},
    {"method-hybrid", {"--method", "hybrid", "--colour", "level", "--wireframe", "--tau", "4", METHOD_EYE}},
    {"method-patch",
     {"--method", "patch", "--patch-side", "17", "--colour", "level", "--wireframe", "--tau", "4", METHOD_EYE}},
    {"method-roam", {"--method", "roam", "--colour", "level", "--wireframe", "--tau", "4", METHOD_EYE}},
    {"method-roam-parallel",
     {"--method", "roam-parallel", "--colour", "partition", "--wireframe", "--tau", "4", METHOD_EYE, "--partitions",
      "4"}},
    {"method-geomipmap", {"--method", "geomipmap", "--colour", "level", "--wireframe", "--tau", "4", METHOD_EYE}},
    {"method-geomipmap-ye", {"--method", "geomipmap-ye", "--colour", "level", "--wireframe", "--tau", "4", METHOD_EYE}},
    {"method-diamond", {"--method", "diamond", "--colour", "level", "--wireframe", "--tau", "4", METHOD_EYE}},
    {"method-diamond-gpu", {"--method", "diamond", "--compute", "gpu", "--colour", "level", "--tau", "4", METHOD_EYE}},
};

typedef struct Picture {
    int width, height;
    uint8_t *rgb;
} Picture;

static const char *overfly; // from the command line
static bool update;
static bool software; // the renderer is

// Runs the program and waits; true when it ended with status 0.
static bool run(char *const *arguments) {
    pid_t child = fork();
    if (child == 0) {
        execv(arguments[0], arguments);
        fprintf(stderr, "%s: %s\n", arguments[0], strerror(errno));
        _exit(127);
    }
    int status = -1;
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static bool take_picture(const View *view, const char *threads, const char *path) {
    const char *arguments[ARGUMENTS_MAX] = {overfly, "snapshot", "-q", "--size", "256x160", "-j", threads, "-o", path};
    int count = 9;
    for (size_t i = 0; i < sizeof view->arguments / sizeof view->arguments[0] && view->arguments[i]; i++)
        arguments[count++] = view->arguments[i];
    return run((char *const *)arguments);
}

static Picture read_picture(const char *path) {
    Picture picture = {0};
    int channels;
    picture.rgb = stbi_load(path, &picture.width, &picture.height, &channels, 3);
    if (!picture.rgb)
        print_error("%s: %s\n", path, stbi_failure_reason());
    return picture;
}

// Each pixel becomes the mean of its block.
static void average_blocks(Picture *picture) {
    size_t row_bytes = (size_t)picture->width * 3;
    for (size_t y = 0; y + BLOCK <= (size_t)picture->height; y += BLOCK)
        for (size_t x = 0; x + BLOCK <= (size_t)picture->width; x += BLOCK)
            for (size_t channel = 0; channel < 3; channel++) {
                uint8_t *corner = picture->rgb + y * row_bytes + x * 3 + channel;
                int sum = 0;
                for (size_t i = 0; i < BLOCK * BLOCK; i++)
                    sum += corner[i / BLOCK * row_bytes + i % BLOCK * 3];
                for (size_t i = 0; i < BLOCK * BLOCK; i++)
                    corner[i / BLOCK * row_bytes + i % BLOCK * 3] = (uint8_t)(sum / (BLOCK * BLOCK));
            }
}

static void write_difference(const char *name, const Picture *a, const Picture *b) {
    char path[256];
    size_t bytes = (size_t)a->width * (size_t)a->height * 3;
    uint8_t *rgb = malloc(bytes);
    if (!rgb)
        return;
    for (size_t i = 0; i < bytes; i++) {
        int difference = abs(a->rgb[i] - b->rgb[i]) * 4;
        rgb[i] = (uint8_t)(difference > 255 ? 255 : difference);
    }
    snprintf(path, sizeof path, "%s.difference.png", name);
    stbi_write_png(path, a->width, a->height, 3, rgb, a->width * 3);
    free(rgb);
}

static bool is_alike(const char *name, const Picture *golden, const Picture *actual) {
    size_t pixels = (size_t)golden->width * (size_t)golden->height, far = 0;
    double sum = 0.0;
    for (size_t i = 0; i < pixels; i++) {
        int worst = 0;
        for (size_t channel = 0; channel < 3; channel++) {
            int difference = abs(golden->rgb[i * 3 + channel] - actual->rgb[i * 3 + channel]);
            sum += difference;
            worst = difference > worst ? difference : worst;
        }
        far += worst > FAR;
    }
    double mean = sum / (double)(pixels * 3), far_share = (double)far / (double)pixels;
    print_message(
        "%-10s mean difference %.4f (at most %.1f), %.4f %% of pixels differ by more than %d (at most %.1f %%)\n", name,
        mean, MEAN_MOST, far_share * 100.0, FAR, FAR_SHARE_MOST * 100.0);
    return mean <= MEAN_MOST && far_share <= FAR_SHARE_MOST;
}

// The actual picture stays behind where it is not as stored.
static bool compare(const char *name, const char *golden_path, const char *actual_path) {
    Picture golden = read_picture(golden_path), actual = read_picture(actual_path);
    bool readable = golden.rgb && actual.rgb;
    bool same_size = readable && golden.width == actual.width && golden.height == actual.height;
    if (readable && !same_size)
        print_error("%s: expected %d x %d pixels, found %d x %d\n", name, golden.width, golden.height, actual.width,
                    actual.height);
    if (same_size && !software) {
        average_blocks(&golden);
        average_blocks(&actual);
    }
    bool alike = same_size && is_alike(name, &golden, &actual);
    if (same_size && !alike)
        write_difference(name, &golden, &actual);
    stbi_image_free(golden.rgb);
    stbi_image_free(actual.rgb);
    return alike;
}

static bool check_view(const View *view) {
    char golden[512], actual[256];
    snprintf(golden, sizeof golden, "%s/%s.png", GOLDEN_FOLDER, view->name);
    snprintf(actual, sizeof actual, "%s.actual.png", view->name);
    if (!take_picture(view, "2", update ? golden : actual)) {
        print_error("%s: the program wrote no picture\n", view->name);
        return false;
    }
    bool alike = update || compare(view->name, golden, actual);
    if (alike && !update)
        remove(actual);
    return alike;
}

static void pictures_are_as_stored(void **state) {
    (void)state;
    int faults = 0;
    for (size_t i = 0; i < sizeof VIEWS / sizeof VIEWS[0]; i++)
        faults += !check_view(&VIEWS[i]);
    assert_int_equal(faults, 0);
}

static bool same_bytes(const Picture *a, const Picture *b) {
    return a->rgb && b->rgb && a->width == b->width && a->height == b->height &&
           memcmp(a->rgb, b->rgb, (size_t)a->width * (size_t)a->height * 3) == 0;
}

static void threads_change_no_pixel(void **state) {
    (void)state;
    assert_true(take_picture(&VIEWS[0], "1", "threads-1.actual.png"));
    assert_true(take_picture(&VIEWS[0], "5", "threads-5.actual.png"));
    Picture one = read_picture("threads-1.actual.png"), five = read_picture("threads-5.actual.png");
    bool same = same_bytes(&one, &five);
    stbi_image_free(one.rgb);
    stbi_image_free(five.rgb);
    assert_true(same);
    remove("threads-1.actual.png");
    remove("threads-5.actual.png");
}

static int has_gl(void) {
    Context *context = NULL;
    ContextOptions options = {.width = 16, .height = 16, .title = "test"};
    if (context_create_offscreen(&options, &context) != RESULT_OK)
        return 0;
    software = context_is_software(context);
    context_destroy(&context);
    return 1;
}

// A person's own settings are not to be in the picture.
static void forget_settings(void) {
    static const char *const SETTINGS[] = {"OVERFLY_SUN", "OVERFLY_TAU",    "OVERFLY_FOV",       "OVERFLY_COLOUR",
                                           "OVERFLY_EYE", "OVERFLY_METHOD", "OVERFLY_WIREFRAME", "OVERFLY_IMAGE"};
    for (size_t i = 0; i < sizeof SETTINGS / sizeof SETTINGS[0]; i++)
        unsetenv(SETTINGS[i]);
    setenv("XDG_CONFIG_HOME", "/nonexistent", 1);
}

int main(int argc, char **argv) {
    if (argc < 2) {
        fprintf(stderr, "usage: test_golden OVERFLY [--update]\n");
        return 2;
    }
    if (!has_gl()) {
        printf("skipped: no OpenGL 4.5 without a window\n");
        return SKIP_STATUS;
    }
    forget_settings();
    overfly = argv[1];
    update = argc > 2 && strcmp(argv[2], "--update") == 0;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_as_stored),
        cmocka_unit_test(threads_change_no_pixel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
