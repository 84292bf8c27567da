#define _POSIX_C_SOURCE 200809L
#include "app/demo/demo_list.h"

#include "base/log.h"
#include "config/files.h"
#include "config/suggest.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FOLDER "demos"

static int by_name(const void *a, const void *b) {
    return strcmp(((const DemoEntry *)a)->name, ((const DemoEntry *)b)->name);
}

static void add(const char *folder, const char *file, DemoList *out) {
    char path[PATHS_BYTES_MAX];
    size_t length = strlen(file), ending = strlen(DEMO_ENDING);
    DemoEntry *entry = &out->entries[out->count];
    if (out->count == DEMO_LIST_MAX || length <= ending || length - ending >= sizeof entry->name ||
        strcmp(file + length - ending, DEMO_ENDING) != 0 ||
        snprintf(path, sizeof path, "%s/%s", folder, file) >= (int)sizeof path)
        return;
    snprintf(entry->name, sizeof entry->name, "%.*s", (int)(length - ending), file);
    if (demo_read_title(path, entry->title) == RESULT_OK)
        out->count++;
}

Result demo_list(DemoList *out) {
    char path[PATHS_BYTES_MAX];
    out->count = 0;
    Result result = paths_find_data(FOLDER, path);
    if (result != RESULT_OK)
        return result;
    DIR *folder = opendir(path);
    if (!folder) {
        log_error("%s: the folder of demos cannot be read: %s", path, strerror(errno));
        return RESULT_IO;
    }
    for (const struct dirent *entry; (entry = readdir(folder));)
        add(path, entry->d_name, out);
    closedir(folder);
    qsort(out->entries, (size_t)out->count, sizeof *out->entries, by_name);
    return RESULT_OK;
}

static Result refuse_name(const char *name, const DemoList *list) {
    const char *names[DEMO_LIST_MAX];
    char all[DEMO_LIST_MAX * 66] = "";
    for (int i = 0; i < list->count; i++) {
        size_t used = strlen(all);
        names[i] = list->entries[i].name;
        snprintf(all + used, sizeof all - used, "%s%s", i ? ", " : "", names[i]);
    }
    const char *nearest = suggest_nearest(name, names, list->count);
    log_error("demo: expected a demo file (.demo) or one of %s; found '%s'%s%s%s", all, name,
              nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
    return RESULT_NOT_FOUND;
}

Result demo_find(const char *name, char path[PATHS_BYTES_MAX]) {
    DemoList list;
    if (files_exists(name) || strchr(name, '/') || strstr(name, DEMO_ENDING))
        return snprintf(path, PATHS_BYTES_MAX, "%s", name) < PATHS_BYTES_MAX ? RESULT_OK : RESULT_RANGE;
    Result result = demo_list(&list);
    for (int i = 0; i < list.count && result == RESULT_OK; i++) {
        char relative[128];
        if (strcmp(list.entries[i].name, name) != 0)
            continue;
        snprintf(relative, sizeof relative, FOLDER "/%s" DEMO_ENDING, name);
        return paths_find_data(relative, path);
    }
    return result == RESULT_OK ? refuse_name(name, &list) : result;
}
