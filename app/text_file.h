// app/text_file.h: a file that is printed to a stream and appears whole or not at all.
// No units.
// A TextFile owns its stream and its bytes, and ends with text_file_end; the path is borrowed. One thread.
#pragma once
#include "base/base.h"

#include <stdio.h>

typedef struct TextFile {
    FILE *to; // print here
    const char *path;
    char *bytes;
    size_t count;
} TextFile;

// MEMORY; logged. Nothing is written before the end.
MUST_USE Result text_file_begin(const char *path, TextFile *out);
// `printed`: what came of printing. If that is not OK, it is given back and no file is written. IO, MEMORY; logged.
MUST_USE Result text_file_end(TextFile *file, Result printed);
