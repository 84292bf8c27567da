// config/ini_read.h: INI files, entry by entry, with line numbers.
// No units.
// Entries' texts live during the callback.
#pragma once
#include "base/base.h"

typedef struct IniEntry {
    const char *file;
    int line;            // from 1
    const char *section; // "" before the first
    const char *name, *value;
} IniEntry;

// Returns false after logging what is wrong with the entry; reading stops there.
typedef bool IniVisit(void *user, const IniEntry *entry);

// NOT_FOUND and IO: nothing is logged. FORMAT: a line is no INI, or `visit` refused; one message names file and line.
MUST_USE Result ini_read(const char *path, IniVisit *visit, void *user);
