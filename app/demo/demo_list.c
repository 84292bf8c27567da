#include "app/demo/demo_list.h"

#include <stdio.h>

static const NamedFileKind KIND = {"demos", DEMO_ENDING, "a demo"};

static void add(const char *folder, const char *name, DemoList *out) {
    char path[PATHS_BYTES_MAX];
    DemoEntry *entry = &out->entries[out->count];
    snprintf(entry->name, sizeof entry->name, "%s", name);
    if (snprintf(path, sizeof path, "%s/%s%s", folder, name, KIND.ending) < (int)sizeof path &&
        demo_read_title(path, entry->title) == RESULT_OK)
        out->count++;
}

Result demo_list(DemoList *out) {
    NamedFiles files;
    char folder[PATHS_BYTES_MAX];
    out->count = 0;
    Result result = paths_find_data(KIND.folder, folder);
    if (result == RESULT_OK)
        result = named_files_list(&KIND, folder, &files);
    for (int i = 0; result == RESULT_OK && i < files.count; i++)
        add(folder, files.names[i], out);
    return result;
}

Result demo_find(const char *name, char path[PATHS_BYTES_MAX]) {
    return named_files_find(&KIND, "demo", name, path);
}
