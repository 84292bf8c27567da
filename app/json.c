#include "app/json.h"

#include "base/log.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>

// A Json is a cJSON node under another name.
static cJSON *node_of(Json *json) {
    return (cJSON *)json;
}

Json *json_create(void) {
    return (Json *)cJSON_CreateObject();
}

void json_destroy(Json **json) {
    cJSON_Delete(node_of(*json));
    *json = NULL;
}

Json *json_add_object(Json *parent, const char *name) {
    return parent ? (Json *)cJSON_AddObjectToObject(node_of(parent), name) : NULL;
}

Json *json_add_array(Json *parent, const char *name) {
    return parent ? (Json *)cJSON_AddArrayToObject(node_of(parent), name) : NULL;
}

void json_add_number(Json *parent, const char *name, double value) {
    if (parent && isfinite(value))
        cJSON_AddNumberToObject(node_of(parent), name, value);
    else if (parent)
        cJSON_AddNullToObject(node_of(parent), name);
}

// cJSON holds numbers as doubles, which round above 2^53: integers go in as their digits.
void json_add_integer(Json *parent, const char *name, int64_t value) {
    char digits[32];
    snprintf(digits, sizeof digits, "%lld", (long long)value);
    if (parent)
        cJSON_AddRawToObject(node_of(parent), name, digits);
}

void json_add_bool(Json *parent, const char *name, bool value) {
    if (parent)
        cJSON_AddBoolToObject(node_of(parent), name, value);
}

void json_add_text(Json *parent, const char *name, const char *value) {
    if (parent && value)
        cJSON_AddStringToObject(node_of(parent), name, value);
    else if (parent)
        cJSON_AddNullToObject(node_of(parent), name);
}

void json_add_numbers(Json *parent, const char *name, const double *values, int count) {
    Json *array = json_add_array(parent, name);
    for (int i = 0; i < count; i++)
        json_append_number(array, values[i]);
}

static Json *append(Json *array, cJSON *item) {
    if (!item)
        return NULL;
    if (array && cJSON_AddItemToArray(node_of(array), item))
        return (Json *)item;
    cJSON_Delete(item);
    return NULL;
}

Json *json_append_object(Json *array) {
    return append(array, cJSON_CreateObject());
}

void json_append_number(Json *array, double value) {
    append(array, isfinite(value) ? cJSON_CreateNumber(value) : cJSON_CreateNull());
}

void json_append_text(Json *array, const char *value) {
    append(array, cJSON_CreateString(value));
}

Result json_write(const Json *json, FILE *to) {
    char *text = json ? cJSON_Print((const cJSON *)json) : NULL;
    if (!text) {
        log_error("no memory for the JSON document");
        return RESULT_MEMORY;
    }
    bool written = fputs(text, to) >= 0 && fputc('\n', to) >= 0 && fflush(to) == 0;
    cJSON_free(text);
    if (written)
        return RESULT_OK;
    log_error("%s: writing the JSON document failed", to == stdout ? "stdout" : "file");
    return RESULT_IO;
}

Result json_print(const Json *json) {
    return json_write(json, stdout);
}
