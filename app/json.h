// app/json.h: build one JSON document and print it on stdout.
// No units.
// The root owns everything below it. A failed allocation makes the document NULL or incomplete, and json_print says so.
#pragma once
#include "base/base.h"

#include <stdio.h>

typedef struct Json Json;

Json *json_create(void); // an object
void json_destroy(Json **json);

// Below: `parent` is an object; `name` is copied. A NULL parent is ignored, and NULL comes back.
Json *json_add_object(Json *parent, const char *name);
Json *json_add_array(Json *parent, const char *name);
void json_add_number(Json *parent, const char *name, double value); // null when not finite
void json_add_integer(Json *parent, const char *name, int64_t value);
void json_add_bool(Json *parent, const char *name, bool value);
void json_add_text(Json *parent, const char *name, const char *value); // null when NULL
void json_add_numbers(Json *parent, const char *name, const double *values, int count);

// Below: `array` is an array.
Json *json_append_object(Json *array);
void json_append_number(Json *array, double value);
void json_append_text(Json *array, const char *value);

// Prints the document and a newline on stdout. MEMORY, IO.
MUST_USE Result json_print(const Json *json);
// The same on `to`, which stays open.
MUST_USE Result json_write(const Json *json, FILE *to);
