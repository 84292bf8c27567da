// config/named_files.h: files of one kind in a folder, known by their names: aircraft, demos, joystick profiles.
// No units.
// Values; nothing is owned. Any thread.
#pragma once
#include "base/base.h"
#include "base/paths.h"

#define NAMED_FILES_MAX 256   // in a folder
#define NAMED_FILES_BYTES 256 // of a name and its end

typedef struct NamedFileKind {
    const char *folder; // of those that came with the program, below its data: "aircraft"
    const char *ending; // ".aircraft"
    const char *what;   // in messages: "an aircraft"
} NamedFileKind;

typedef struct NamedFiles {
    char names[NAMED_FILES_MAX][NAMED_FILES_BYTES]; // without folder and ending, in the order of the alphabet
    int count;
} NamedFiles;

// Those in `folder`; hidden ones are left out, and so, with a warning, is what is above NAMED_FILES_MAX. IO, logged.
MUST_USE Result named_files_list(const NamedFileKind *kind, const char *folder, NamedFiles *out);
// Those that came with the program. NOT_FOUND, IO; logged.
MUST_USE Result named_files_of_program(const NamedFileKind *kind, NamedFiles *out);
// The file that `name` is, or that came with the program under this name. NOT_FOUND lists the names there are, with the
// nearest; `where` is the place that messages begin with ("--aircraft", "round.demo:3: aircraft"). IO, RANGE; logged.
MUST_USE Result named_files_find(const NamedFileKind *kind, const char *where, const char *name,
                                 char path[PATHS_BYTES_MAX]);
