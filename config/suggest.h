// config/suggest.h: which known name did the person mean?
// No units.
// Pure functions; any thread.
#pragma once
#include "base/base.h"

// Edits (insert, delete, replace, swap of neighbours) from a to b, upper and lower case alike.
int suggest_distance(const char *a, const char *b);
// Whether `distance` is near enough for a name of this length to be what was meant.
bool suggest_is_near(const char *typed, int distance);
// The nearest of `names`, or NULL when none is near.
const char *suggest_nearest(const char *typed, const char *const *names, int count);

#define SUGGEST_BYTES 320
// The end of a message, in `out`: "; did you mean 'NEAREST'?", or "" when none is near.
const char *suggest_question(const char *typed, const char *const *names, int count, char out[SUGGEST_BYTES]);
