#define _XOPEN_SOURCE 700 // realpath
#include "config/scene.h"

#include "base/log.h"
#include "config/files.h"
#include "config/ini_read.h"
#include "config/options_internal.h"
#include "config/suggest.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A key is checked as the option that means the same.
typedef enum Key {
    KEY_DEM,
    KEY_DATUM,
    KEY_VOIDS,
    KEY_IMAGE,
    KEY_IMAGE_BOUNDS,
    KEY_POSITION,
    KEY_LOOK,
    KEY_SPEED,
    KEY_SUN,
    KEY_DEMO,
    KEY_COUNT
} Key;

static const struct {
    const char *section, *name;
    OptionId checked_as;
} keys[KEY_COUNT] = {
    [KEY_DEM] = {"terrain", "dem", OPTION_IMAGE},
    [KEY_DATUM] = {"terrain", "datum", OPTION_DATUM},
    [KEY_VOIDS] = {"terrain", "voids", OPTION_VOIDS},
    [KEY_IMAGE] = {"terrain", "image", OPTION_IMAGE},
    [KEY_IMAGE_BOUNDS] = {"terrain", "image-bounds", OPTION_IMAGE_BOUNDS},
    [KEY_POSITION] = {"start", "position", OPTION_EYE},
    [KEY_LOOK] = {"start", "look", OPTION_LOOK},
    [KEY_SPEED] = {"start", "speed", OPTION_SPEED},
    [KEY_SUN] = {"light", "sun", OPTION_SUN},
    [KEY_DEMO] = {"demo", "file", OPTION_IMAGE},
};

static int find_key(const IniEntry *entry) {
    for (int i = 0; i < KEY_COUNT; i++)
        if (strcmp(keys[i].section, entry->section) == 0 && strcmp(keys[i].name, entry->name) == 0)
            return i;
    return -1;
}

static void report_unknown(const IniEntry *entry) {
    const char *names[KEY_COUNT];
    for (int i = 0; i < KEY_COUNT; i++)
        names[i] = keys[i].name;
    const char *nearest = suggest_nearest(entry->name, names, KEY_COUNT);
    for (int i = 0; i < KEY_COUNT && nearest; i++) {
        if (strcmp(keys[i].name, nearest) == 0) {
            log_error("%s:%d: a scene has no '%s' in [%s]; did you mean '%s' in [%s]?", entry->file, entry->line,
                      entry->name, entry->section, nearest, keys[i].section);
            return;
        }
    }
    log_error("%s:%d: a scene has no '%s' in [%s]; expected dem, datum, voids, image, image-bounds in [terrain], "
              "position, look, speed in [start], sun in [light], file in [demo]",
              entry->file, entry->line, entry->name, entry->section);
}

// As people would write it: without "..", where the file exists. A plain name beside a scene named relatively stays so.
static char *copy_beside(const char *file, const char *name) {
    char path[PATHS_BYTES_MAX];
    if (files_beside(file, name, path) != RESULT_OK)
        return NULL;
    char *resolved = strstr(path, "../") ? realpath(path, NULL) : NULL;
    return resolved ? resolved : strdup(path);
}

static bool replace_text(char **slot, char *text) {
    free(*slot);
    *slot = text;
    return text != NULL;
}

static bool add_dem(Scene *scene, const IniEntry *entry) {
    if (scene->dem_count == SCENE_DEM_MAX) {
        log_error("%s:%d: more than %d DEM files; put them into one folder and name that", entry->file, entry->line,
                  SCENE_DEM_MAX);
        return false;
    }
    scene->dem[scene->dem_count] = copy_beside(entry->file, entry->value);
    return scene->dem[scene->dem_count] && ++scene->dem_count;
}

static bool keep_numbers(double *slot, int count, bool *has, const double *numbers) {
    memcpy(slot, numbers, sizeof *slot * (size_t)count);
    *has = true;
    return true;
}

static bool keep(Scene *scene, Key key, const IniEntry *entry, const double *numbers) {
    switch (key) {
    case KEY_DEM:
        return add_dem(scene, entry);
    case KEY_DATUM:
        scene->datum = (int)numbers[0];
        return true;
    case KEY_VOIDS:
        scene->voids = (int)numbers[0];
        return true;
    case KEY_IMAGE:
        return replace_text(&scene->image, copy_beside(entry->file, entry->value));
    case KEY_DEMO:
        return replace_text(&scene->demo, copy_beside(entry->file, entry->value));
    case KEY_IMAGE_BOUNDS:
        return keep_numbers(scene->image_bounds, 4, &scene->has_image_bounds, numbers);
    case KEY_POSITION:
        return keep_numbers(scene->position, 3, &scene->has_position, numbers);
    case KEY_LOOK:
        return keep_numbers(scene->look, 2, &scene->has_look, numbers);
    case KEY_SPEED:
        return keep_numbers(&scene->speed_m_s, 1, &scene->has_speed, numbers);
    case KEY_SUN:
        return keep_numbers(scene->sun, 2, &scene->has_sun, numbers);
    case KEY_COUNT:
        break;
    }
    return false;
}

static bool visit_entry(void *user, const IniEntry *entry) {
    int key = find_key(entry);
    if (key < 0) {
        report_unknown(entry);
        return false;
    }
    char where[512];
    snprintf(where, sizeof where, "%s:%d: %s", entry->file, entry->line, entry->name);
    double numbers[4] = {0};
    return option_check(keys[key].checked_as, entry->value, where, numbers) == RESULT_OK &&
           keep(user, (Key)key, entry, numbers);
}

static char *stem_of(const char *path) {
    const char *slash = strrchr(path, '/');
    const char *begin = slash ? slash + 1 : path;
    const char *dot = strrchr(begin, '.');
    return strndup(begin, dot && dot > begin ? (size_t)(dot - begin) : strlen(begin));
}

static Result check_whole(const char *path, const Scene *scene) {
    if (!scene->name)
        return RESULT_MEMORY;
    if (scene->dem_count > 0)
        return RESULT_OK;
    log_error("%s: the scene names no terrain; expected 'dem = FILE' under [terrain]", path);
    return RESULT_FORMAT;
}

static Scene empty_scene(void) {
    return (Scene){.datum = -1, .voids = -1};
}

Result scene_read(const char *path, Scene *out) {
    Scene scene = empty_scene();
    Result result = ini_read(path, visit_entry, &scene);
    if (result == RESULT_NOT_FOUND || result == RESULT_IO)
        log_error("%s: the scene file %s", path, result == RESULT_IO ? "cannot be read" : "does not exist");
    if (result == RESULT_OK) {
        scene.name = stem_of(path);
        result = check_whole(path, &scene);
    }
    if (result == RESULT_OK)
        *out = scene;
    else
        scene_clear(&scene);
    return result;
}

Result scene_of_dems(const char *const *paths, int count, Scene *out) {
    if (count > SCENE_DEM_MAX) {
        log_error("%d DEM files; at most %d can be named one by one: put them into one folder and name that", count,
                  SCENE_DEM_MAX);
        return RESULT_RANGE;
    }
    Scene scene = empty_scene();
    scene.name = strdup("");
    for (int i = 0; i < count; i++) {
        scene.dem[i] = strdup(paths[i]);
        if (!scene.dem[i])
            goto fail;
        scene.dem_count++;
    }
    if (!scene.name)
        goto fail;
    *out = scene;
    return RESULT_OK;
fail:
    scene_clear(&scene);
    return RESULT_MEMORY;
}

void scene_clear(Scene *scene) {
    for (int i = 0; i < scene->dem_count; i++)
        free(scene->dem[i]);
    free(scene->name);
    free(scene->image);
    free(scene->demo);
    *scene = empty_scene();
}
