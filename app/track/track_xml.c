#define _POSIX_C_SOURCE 200809L
#include "app/track/track_xml.h"

#include "base/log.h"

#include <errno.h>
#include <expat.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define BLOCK_BYTES (1 << 16)
#define TOKEN_BYTES_MAX (1 << 20) // the parser keeps a tag until it is whole

typedef struct Reader {
    const char *path;
    XML_Parser parser;
    const TrackXmlHandler *handler;
    void *user;
    int depth;
    char names[TRACK_XML_DEPTH_MAX + 1][TRACK_XML_NAME_BYTES]; // of the elements open; [0] is ""
    char text[TRACK_XML_TEXT_BYTES];
    size_t text_length;
    int64_t fed, heard; // bytes: given to the parser, and when it last told something
    int64_t file_bytes;
    Progress progress;
    Result result;
} Reader;

static int64_t line_of(const Reader *r) {
    return (int64_t)XML_GetCurrentLineNumber(r->parser);
}

static void stop(Reader *r, Result result) {
    r->result = result;
    XML_StopParser(r->parser, XML_FALSE);
}

static void refuse(Reader *r, const char *why) {
    log_error("%s:%lld: %s", r->path, (long long)line_of(r), why);
    stop(r, RESULT_FORMAT);
}

static const char *local_name(const char *name) {
    const char *colon = strrchr(name, ':');
    return colon ? colon + 1 : name;
}

static TrackXmlPlace place_of(const Reader *r) {
    return (TrackXmlPlace){line_of(r), r->depth, r->names[r->depth - 1]};
}

static void XMLCALL on_begin(void *user, const XML_Char *name, const XML_Char **attributes) {
    Reader *r = user;
    r->heard = r->fed;
    if (r->result != RESULT_OK)
        return;
    if (r->depth == TRACK_XML_DEPTH_MAX) {
        refuse(r, "elements nested more than 64 deep; no track is");
        return;
    }
    r->depth++;
    r->text_length = 0;
    snprintf(r->names[r->depth], TRACK_XML_NAME_BYTES, "%s", local_name(name));
    TrackXmlPlace place = place_of(r);
    Result result = r->handler->begin(r->user, &place, r->names[r->depth], (const char *const *)attributes);
    if (result != RESULT_OK)
        stop(r, result);
}

static const char *trimmed(Reader *r) {
    while (r->text_length > 0 && strchr(" \t\r\n", r->text[r->text_length - 1]))
        r->text_length--;
    r->text[r->text_length] = '\0';
    return r->text + strspn(r->text, " \t\r\n");
}

static void XMLCALL on_end(void *user, const XML_Char *name) {
    Reader *r = user;
    (void)name;
    r->heard = r->fed;
    if (r->result != RESULT_OK)
        return;
    TrackXmlPlace place = place_of(r);
    Result result = r->handler->end(r->user, &place, r->names[r->depth], trimmed(r));
    r->text_length = 0;
    r->depth--;
    if (result != RESULT_OK)
        stop(r, result);
}

static void XMLCALL on_text(void *user, const XML_Char *text, int length) {
    Reader *r = user;
    size_t room = TRACK_XML_TEXT_BYTES - 1 - r->text_length, count = (size_t)length < room ? (size_t)length : room;
    r->heard = r->fed;
    memcpy(r->text + r->text_length, text, count);
    r->text_length += count;
}

static void XMLCALL on_other(void *user, const XML_Char *text, int length) {
    Reader *r = user;
    (void)text, (void)length;
    r->heard = r->fed;
}

static void XMLCALL on_doctype(void *user, const XML_Char *name, const XML_Char *system, const XML_Char *public,
                               int internal) {
    (void)name, (void)system, (void)public;
    if (internal)
        refuse(user, "a document type with declarations of its own, as entities are; no track needs them");
}

// ---- files that break off ----

static bool is_end(enum XML_Error error) {
    return error == XML_ERROR_NO_ELEMENTS || error == XML_ERROR_UNCLOSED_TOKEN || error == XML_ERROR_PARTIAL_CHAR ||
           error == XML_ERROR_UNCLOSED_CDATA_SECTION;
}

// What chance makes of a file; the parser's other errors are of files made to be wrong, or of another kind.
static bool is_damage(enum XML_Error error) {
    static const enum XML_Error damages[] = {XML_ERROR_INVALID_TOKEN,          XML_ERROR_TAG_MISMATCH,
                                             XML_ERROR_DUPLICATE_ATTRIBUTE,    XML_ERROR_BAD_CHAR_REF,
                                             XML_ERROR_JUNK_AFTER_DOC_ELEMENT, XML_ERROR_MISPLACED_XML_PI,
                                             XML_ERROR_UNDEFINED_ENTITY};
    for (size_t i = 0; i < COUNT_OF(damages); i++)
        if (error == damages[i])
            return true;
    return is_end(error);
}

// Bytes from `at` on, counted until they are more than `most`. Zeros are none: a recorder that lost its power leaves
// them behind what it wrote.
static int64_t count_behind(FILE *file, int64_t at, int64_t most) {
    char block[4096];
    int64_t count = 0;
    if (fseeko(file, (off_t)at, SEEK_SET) != 0)
        return most + 1;
    for (size_t got; count <= most && (got = fread(block, 1, sizeof block, file)) > 0;)
        for (size_t i = 0; i < got; i++)
            count += block[i] != '\0';
    return count;
}

static Result refuse_broken(const Reader *r, enum XML_Error error, bool at_end, const char *why) {
    log_error("%s:%lld: %s: %s%s", r->path, (long long)line_of(r), XML_ErrorString(error),
              at_end ? "the file is empty or cut off" : "expected well-formed XML", why);
    return RESULT_FORMAT;
}

// As of the other formats, where more must be whole than damaged: what stands before the place is kept if it is the
// greater part of the file. The parser cannot go on behind it.
static Result keep_before(Reader *r, FILE *file, enum XML_Error error) {
    int64_t before = XML_GetCurrentByteIndex(r->parser), behind = count_behind(file, before, before);
    bool at_end = is_end(error) || behind == 0;
    int points = 0;
    Result result = r->handler->cut(r->user, &points);
    if (result != RESULT_OK)
        return result;
    if (points == 0)
        return refuse_broken(r, error, at_end, at_end ? " before its first point" : "; no point stands before it");
    if (behind > before)
        return refuse_broken(r, error, false, "; more of the file stands behind it than before: mend that line");
    if (at_end)
        log_warn("%s:%lld: the file is cut off here; points before it, which are kept: %d", r->path,
                 (long long)line_of(r), points);
    else
        log_warn("%s:%lld: %s: nothing behind it can be read; points before it, which are kept: %d", r->path,
                 (long long)line_of(r), XML_ErrorString(error), points);
    return RESULT_OK;
}

// What the parser found wrong; nothing when a handler has said it.
static Result parser_failed(Reader *r, FILE *file) {
    enum XML_Error error = XML_GetErrorCode(r->parser);
    if (r->result != RESULT_OK)
        return r->result;
    if (is_damage(error))
        return keep_before(r, file, error);
    (void)refuse_broken(r, error, false, "");
    return error == XML_ERROR_NO_MEMORY ? RESULT_MEMORY : RESULT_FORMAT;
}

// ---- reading ----

static Result feed(Reader *r, FILE *file) {
    for (bool last = false; !last;) {
        void *block = XML_GetBuffer(r->parser, BLOCK_BYTES);
        if (!block) {
            log_error("%s: no memory to read it", r->path);
            return RESULT_MEMORY;
        }
        size_t count = fread(block, 1, BLOCK_BYTES, file);
        last = count < BLOCK_BYTES;
        r->fed += (int64_t)count;
        if (r->file_bytes > 0)
            progress_update(&r->progress, fmin((double)r->fed / (double)r->file_bytes, 1.0));
        if (ferror(file)) {
            log_error("%s: reading failed: %s", r->path, strerror(errno));
            return RESULT_IO;
        }
        if (XML_ParseBuffer(r->parser, (int)count, last) != XML_STATUS_OK)
            return parser_failed(r, file);
        if (r->fed - r->heard > TOKEN_BYTES_MAX) {
            refuse(r, "a tag of more than a megabyte; no track has one");
            return RESULT_FORMAT;
        }
    }
    return RESULT_OK;
}

static Result parse(Reader *r, FILE *file) {
    XML_SetUserData(r->parser, r);
    XML_SetElementHandler(r->parser, on_begin, on_end);
    XML_SetCharacterDataHandler(r->parser, on_text);
    XML_SetDefaultHandlerExpand(r->parser, on_other);
    XML_SetStartDoctypeDeclHandler(r->parser, on_doctype);
    struct stat about;
    r->file_bytes = fstat(fileno(file), &about) == 0 ? about.st_size : 0;
    r->progress = progress_begin("read the flight");
    Result result = feed(r, file);
    progress_end(&r->progress);
    return result;
}

Result track_xml_read(const char *path, const TrackXmlHandler *handler, void *user) {
    Reader reader = {.path = path, .handler = handler, .user = user, .parser = XML_ParserCreate(NULL)};
    FILE *file = fopen(path, "rb");
    Result result = RESULT_OK;
    if (!file) {
        log_error("%s: the flight cannot be opened: %s", path, strerror(errno));
        result = errno == ENOENT ? RESULT_NOT_FOUND : RESULT_IO;
    } else if (!reader.parser) {
        log_error("%s: no memory to read it", path);
        result = RESULT_MEMORY;
    } else {
        result = parse(&reader, file);
    }
    if (reader.parser)
        XML_ParserFree(reader.parser);
    if (file)
        fclose(file);
    return result;
}
