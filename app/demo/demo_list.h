// app/demo/demo_list.h: the demonstration flights that came with the program.
// No units.
// Values; nothing is owned. Any thread.
#pragma once
#include "app/demo/demo.h"
#include "config/named_files.h"

typedef struct DemoEntry {
    char name[NAMED_FILES_BYTES]; // of the file, without folder and ending
    char title[DEMO_TEXT_BYTES];
} DemoEntry;

typedef struct DemoList {
    DemoEntry entries[NAMED_FILES_MAX]; // in the order of the alphabet
    int count;
} DemoList;

// NOT_FOUND, IO; logged, as is what is wrong with a demo, which is then left out.
MUST_USE Result demo_list(DemoList *out);
// A file, or the name of one that came with the program. NOT_FOUND names what is near, or all there are; logged.
MUST_USE Result demo_find(const char *name, char path[PATHS_BYTES_MAX]);
