#define _DEFAULT_SOURCE // strsep
#include "app/recording/recording_header.h"

#include "app/recording/recording_bytes.h"
#include "base/log.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// As PNG's: what mangles line ends or the eighth bit is found out.
static const uint8_t MAGIC[RECORDING_MAGIC_BYTES] = {0x89, 'O', 'F', 'R', '\r', '\n', 0x1A, '\n'};
#define VERSION_AT 8
#define LENGTH_AT 12
#define TEXT_AT 16
#define CRC_BYTES 4

static const char *const KEYS[RECORDING_KEY_COUNT] = {
#define KEY_NAME(id, key, what) key,
    RECORDING_KEY_TABLE(KEY_NAME)
#undef KEY_NAME
};

#define TEXT_OF(value) #value
#define WIDE_TEXT(field, name, least, greatest, per_unit) name " i16 1/" TEXT_OF(per_unit),
#define NARROW_TEXT(field, name, least, greatest, per_unit) name " u8 1/" TEXT_OF(per_unit),
static const char *const COLUMNS[] = {RECORDING_WIDE_TABLE(WIDE_TEXT)
                                          RECORDING_NARROW_TABLE(NARROW_TEXT) "bits u8 gear_up"};

static const char *const EVENTS[] = {
#define EVENT_TEXT(id, code, name) TEXT_OF(code) " " name,
    RECORDING_EVENT_TABLE(EVENT_TEXT)
#undef EVENT_TEXT
};

const char *recording_key_name(RecordingKey key) {
    return KEYS[key];
}

RecordingHeader recording_header_create(uint32_t state_bytes, uint64_t state_layout) {
    return (RecordingHeader){.steps_per_s = RECORDING_STEPS_PER_S,
                             .chunk_steps = RECORDING_CHUNK_STEPS,
                             .state_bytes = state_bytes,
                             .state_layout = state_layout};
}

void recording_header_set(RecordingHeader *header, RecordingKey key, const char *format, ...) {
    char *value = header->environment[key];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(value, RECORDING_VALUE_BYTES, format, arguments);
    va_end(arguments);
    for (char *at = value; *at; at++)
        if (iscntrl((unsigned char)*at))
            *at = ' ';
    if (length >= RECORDING_VALUE_BYTES)
        memcpy(value + RECORDING_VALUE_BYTES - 4, "...", 4);
}

RecordingKey recording_header_difference(const RecordingHeader *a, const RecordingHeader *b, RecordingKey from) {
    while (from < RECORDING_KEY_COUNT && strcmp(a->environment[from], b->environment[from]) == 0)
        from++;
    return from;
}

// ---- writing ----

static size_t add(char *text, size_t used, const char *format, ...) PRINTF_LIKE(3, 4);
static size_t add(char *text, size_t used, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text + used, RECORDING_TEXT_BYTES_MAX - used, format, arguments);
    va_end(arguments);
    return used + (size_t)length; // all keys with the longest values fit
}

static size_t write_text(const RecordingHeader *header, char text[RECORDING_TEXT_BYTES_MAX]) {
    size_t used = add(text, 0, "format=overfly recording\nsteps_per_s=%d\nchunk_steps=%d\nstate_bytes=%" PRIu32 "\n",
                      header->steps_per_s, header->chunk_steps, header->state_bytes);
    used = add(text, used, "state_layout=%" PRIu64 "\n", header->state_layout);
    for (size_t i = 0; i < COUNT_OF(COLUMNS); i++)
        used = add(text, used, "column=%s\n", COLUMNS[i]);
    for (size_t i = 0; i < COUNT_OF(EVENTS); i++)
        used = add(text, used, "event=%s\n", EVENTS[i]);
    for (int key = 0; key < RECORDING_KEY_COUNT; key++)
        used = add(text, used, "%s=%s\n", KEYS[key], header->environment[key]);
    return used;
}
_Static_assert(RECORDING_KEY_COUNT *(RECORDING_VALUE_BYTES + 32) + 2048 < RECORDING_TEXT_BYTES_MAX, "the text fits");

size_t recording_header_encode(const RecordingHeader *header, uint8_t out[RECORDING_HEADER_BYTES_MAX], uint32_t *crc) {
    size_t text_bytes = write_text(header, (char *)out + TEXT_AT);
    memcpy(out, MAGIC, sizeof MAGIC);
    recording_put32(out + VERSION_AT, RECORDING_VERSION);
    recording_put32(out + LENGTH_AT, (uint32_t)text_bytes);
    *crc = recording_crc32(0, out, TEXT_AT + text_bytes);
    recording_put32(out + TEXT_AT + text_bytes, *crc);
    return TEXT_AT + text_bytes + CRC_BYTES;
}

// ---- reading ----

typedef struct Parse {
    const char *file;
    RecordingHeader *header;
    uint64_t numbers[4];
    size_t columns;
    int line;
} Parse;

static const struct {
    const char *key;
    uint64_t least, greatest;
} NUMBERS[] = {{"steps_per_s", 1, 1000},
               {"chunk_steps", 1, RECORDING_CHUNK_STEPS_MAX},
               {"state_bytes", 1, RECORDING_STATE_BYTES_MAX},
               {"state_layout", 0, UINT64_MAX}};
_Static_assert(COUNT_OF(NUMBERS) == COUNT_OF(((Parse *)0)->numbers), "a number a key");
#define NOT_SAID UINT64_MAX

static bool check_column(Parse *parse, const char *value) {
    size_t i = parse->columns++;
    const char *expected = i < COUNT_OF(COLUMNS) ? COLUMNS[i] : "none";
    if (strcmp(value, expected) == 0)
        return true;
    log_error("%s: header line %d: column %zu is '%s', expected '%s'; a newer overfly may read it", parse->file,
              parse->line, i + 1, value, expected);
    return false;
}

static bool take_number(Parse *parse, size_t i, const char *value) {
    char *end;
    unsigned long long number = strtoull(value, &end, 10);
    parse->numbers[i] = number;
    if (isdigit((unsigned char)value[0]) && !*end && number >= NUMBERS[i].least && number <= NUMBERS[i].greatest)
        return true;
    log_error("%s: header line %d: %s is '%s', expected %" PRIu64 " to %" PRIu64, parse->file, parse->line,
              NUMBERS[i].key, value, NUMBERS[i].least, NUMBERS[i].greatest);
    return false;
}

// Keys of newer programs are left alone.
static Result take_line(Parse *parse, const char *key, const char *value) {
    if (strcmp(key, "column") == 0)
        return check_column(parse, value) ? RESULT_OK : RESULT_UNSUPPORTED;
    for (size_t i = 0; i < COUNT_OF(NUMBERS); i++)
        if (strcmp(key, NUMBERS[i].key) == 0)
            return take_number(parse, i, value) ? RESULT_OK : RESULT_FORMAT;
    for (int i = 0; i < RECORDING_KEY_COUNT; i++)
        if (strcmp(key, KEYS[i]) == 0)
            recording_header_set(parse->header, (RecordingKey)i, "%s", value);
    return RESULT_OK;
}

static Result take_whole(Parse *parse) {
    for (size_t i = 0; i < COUNT_OF(NUMBERS) - 1; i++) { // a layout may be any number
        if (parse->numbers[i] != NOT_SAID)
            continue;
        log_error("%s: the header does not say '%s'; is it another program's?", parse->file, NUMBERS[i].key);
        return RESULT_FORMAT;
    }
    if (parse->columns < COUNT_OF(COLUMNS))
        return check_column(parse, "missing") ? RESULT_OK : RESULT_UNSUPPORTED;
    parse->header->steps_per_s = (int)parse->numbers[0];
    parse->header->chunk_steps = (int)parse->numbers[1];
    parse->header->state_bytes = (uint32_t)parse->numbers[2];
    parse->header->state_layout = parse->numbers[3];
    return RESULT_OK;
}

static Result read_text(const char *file, char *text, RecordingHeader *out) {
    *out = (RecordingHeader){0};
    Parse parse = {.file = file, .header = out, .numbers = {NOT_SAID, NOT_SAID, NOT_SAID, NOT_SAID}};
    Result result = RESULT_OK;
    char *rest = text;
    for (char *line; result == RESULT_OK && (line = strsep(&rest, "\n"));) {
        char *value = strchr(line, '=');
        parse.line++;
        if (!value)
            continue;
        *value = '\0';
        result = take_line(&parse, line, value + 1);
    }
    return result == RESULT_OK ? take_whole(&parse) : result;
}

static Result check_beginning(const char *file, const uint8_t *bytes, size_t count) {
    if (count < TEXT_AT || memcmp(bytes, MAGIC, sizeof MAGIC) != 0) {
        log_error("%s: byte 0: not a recording of overfly (.ofr); other tracks are IGC, GPX, KML, ACMI, by their names",
                  file);
        return RESULT_FORMAT;
    }
    uint32_t version = recording_get32(bytes + VERSION_AT);
    if (version == RECORDING_VERSION)
        return RESULT_OK;
    log_error("%s: byte %d: version %" PRIu32 " of the format, this program reads version %d; use the overfly that "
              "wrote it, or a newer one",
              file, VERSION_AT, version, RECORDING_VERSION);
    return RESULT_UNSUPPORTED;
}

static Result check_whole(const char *file, const uint8_t *bytes, size_t count, size_t text_bytes, uint32_t *crc) {
    if (text_bytes > RECORDING_TEXT_BYTES_MAX || TEXT_AT + text_bytes + CRC_BYTES > count) {
        log_error("%s: byte %d: a header of %zu bytes, but the file has %zu, and %d are the most; it is damaged or was "
                  "cut off before the flight began",
                  file, LENGTH_AT, text_bytes, count, RECORDING_TEXT_BYTES_MAX);
        return RESULT_FORMAT;
    }
    *crc = recording_crc32(0, bytes, TEXT_AT + text_bytes);
    uint32_t expected = recording_get32(bytes + TEXT_AT + text_bytes);
    if (*crc == expected)
        return RESULT_OK;
    log_error(
        "%s: byte %zu: the header's checksum is %08" PRIx32 ", expected %08" PRIx32
        "; the header is damaged, and nothing after it can be read: use another copy of the file, if there is one",
        file, TEXT_AT + text_bytes, *crc, expected);
    return RESULT_FORMAT;
}

Result recording_header_decode(const char *file, const uint8_t *bytes, size_t count, RecordingHeader *out,
                               size_t *header_bytes, uint32_t *crc) {
    Result result = check_beginning(file, bytes, count);
    if (result != RESULT_OK)
        return result;
    size_t text_bytes = recording_get32(bytes + LENGTH_AT);
    result = check_whole(file, bytes, count, text_bytes, crc);
    if (result != RESULT_OK)
        return result;
    char text[RECORDING_TEXT_BYTES_MAX + 1];
    memcpy(text, bytes + TEXT_AT, text_bytes);
    text[text_bytes] = '\0';
    *header_bytes = TEXT_AT + text_bytes + CRC_BYTES;
    return read_text(file, text, out);
}

bool recording_is_one(const uint8_t begin[RECORDING_MAGIC_BYTES]) {
    return memcmp(begin, MAGIC, sizeof MAGIC) == 0;
}
