#define _FILE_OFFSET_BITS 64
#include "terrain/dem/byte_stream.h"

#include "base/log.h"
#include "terrain/dem/dem_source.h"

#include <errno.h>
#include <limits.h>
#include <minizip/unzip.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define NAME_MAX_BYTES 256

// gzread also passes plain files through.
struct ByteStream {
    gzFile gzip;
    unzFile zip;
    bool member_open;
    int64_t size, position;
    char name[NAME_MAX_BYTES];
    char path[];
};

static const char *base_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static Result refuse_damaged(const ByteStream *stream, const char *what) {
    log_error("%s: %s after %lld of %lld bytes; fetch it again", stream->path, what, (long long)stream->position,
              (long long)stream->size);
    return RESULT_FORMAT;
}

// ---- Plain and .gz ----------------------------------------------------------------------------------------------

// What the file promises: its length, or what gzip wrote at its end (RFC 1952, ISIZE).
static Result promised_size(const char *path, bool *gzip, bool *zip, int64_t *size) {
    uint8_t head[4] = {0}, tail[4] = {0};
    FILE *file = fopen(path, "rb");
    if (!file) {
        int cause = errno;
        log_error("%s: %s; check the path", path, strerror(cause));
        return cause == ENOENT ? RESULT_NOT_FOUND : RESULT_IO;
    }
    size_t read = fread(head, 1, sizeof head, file);
    *gzip = read >= 2 && head[0] == 0x1f && head[1] == 0x8b;
    *zip = read >= 4 && memcmp(head, "PK\3\4", 4) == 0;
    bool sized = fseek(file, 0, SEEK_END) == 0;
    *size = sized ? (int64_t)ftell(file) : -1;
    if (*gzip && *size >= 18 && fseek(file, -4, SEEK_END) == 0 && fread(tail, 1, 4, file) == 4)
        *size = (int64_t)tail[0] | (int64_t)tail[1] << 8 | (int64_t)tail[2] << 16 | (int64_t)tail[3] << 24;
    fclose(file);
    if (*size >= 0)
        return RESULT_OK;
    log_error("%s: its size cannot be found out; give an ordinary file", path);
    return RESULT_IO;
}

static Result open_gzip(ByteStream *stream) {
    snprintf(stream->name, sizeof stream->name, "%s", base_name(stream->path));
    if (dem_name_ends(stream->name, ".gz"))
        stream->name[strlen(stream->name) - 3] = '\0';
    stream->gzip = gzopen(stream->path, "rb");
    if (stream->gzip)
        return RESULT_OK;
    log_error("%s: %s", stream->path, strerror(errno));
    return RESULT_IO;
}

// ---- .zip -------------------------------------------------------------------------------------------------------

// Leaves the archive at the member whose name ends so; how many there are.
static int find_members(ByteStream *stream, const char *ending) {
    unz_file_pos place = {0};
    int found = 0;
    for (int status = unzGoToFirstFile(stream->zip); status == UNZ_OK; status = unzGoToNextFile(stream->zip)) {
        char name[NAME_MAX_BYTES] = "";
        unz_file_info64 info;
        if (unzGetCurrentFileInfo64(stream->zip, &info, name, sizeof name - 1, NULL, 0, NULL, 0) != UNZ_OK)
            break;
        // Folders of resource forks repeat the name.
        if (!dem_name_ends(name, ending) || base_name(name)[0] == '.')
            continue;
        found++;
        stream->size = info.uncompressed_size < INT64_MAX ? (int64_t)info.uncompressed_size : INT64_MAX;
        snprintf(stream->name, sizeof stream->name, "%s", base_name(name));
        unzGetFilePos(stream->zip, &place);
    }
    if (found > 0 && unzGoToFilePos(stream->zip, &place) != UNZ_OK)
        return 0;
    return found;
}

static Result open_zip(ByteStream *stream, const char *ending) {
    stream->zip = unzOpen64(stream->path);
    if (!stream->zip) {
        log_error("%s: a damaged or truncated .zip archive; fetch it again", stream->path);
        return RESULT_FORMAT;
    }
    int members = find_members(stream, ending);
    if (members != 1) {
        log_error("%s: %d files ending in %s in the archive; expected one; unpack it and give the folder", stream->path,
                  members, ending);
        return RESULT_UNSUPPORTED;
    }
    stream->member_open = unzOpenCurrentFile(stream->zip) == UNZ_OK;
    return stream->member_open ? RESULT_OK : refuse_damaged(stream, "the .zip archive is damaged");
}

// ---- Both -------------------------------------------------------------------------------------------------------

Result byte_stream_open(const char *path, const char *ending, ByteStream **out) {
    bool gzip, zip;
    int64_t size = 0;
    Result result = promised_size(path, &gzip, &zip, &size);
    if (result != RESULT_OK)
        return result;
    ByteStream *stream = calloc(1, sizeof *stream + strlen(path) + 1);
    if (!stream) {
        log_error("%s: out of memory", path);
        return RESULT_MEMORY;
    }
    strcpy(stream->path, path);
    stream->size = size;
    result = zip ? open_zip(stream, ending) : open_gzip(stream);
    if (result != RESULT_OK)
        byte_stream_close(&stream);
    else
        *out = stream;
    return result;
}

void byte_stream_close(ByteStream **stream) {
    if (!*stream)
        return;
    if ((*stream)->member_open)
        unzCloseCurrentFile((*stream)->zip);
    if ((*stream)->zip)
        unzClose((*stream)->zip);
    if ((*stream)->gzip)
        gzclose((*stream)->gzip);
    free(*stream);
    *stream = NULL;
}

const char *byte_stream_name(const ByteStream *stream) {
    return stream->name;
}

int64_t byte_stream_size(const ByteStream *stream) {
    return stream->size;
}

static int read_some(ByteStream *stream, void *out, size_t bytes) {
    unsigned most = bytes < INT_MAX ? (unsigned)bytes : INT_MAX;
    return stream->zip ? unzReadCurrentFile(stream->zip, out, most) : gzread(stream->gzip, out, most);
}

Result byte_stream_read(ByteStream *stream, void *out, size_t bytes) {
    for (size_t done = 0; done < bytes;) {
        int read = read_some(stream, (char *)out + done, bytes - done);
        if (read <= 0)
            return refuse_damaged(stream, read == 0 ? "the file ends" : "the file is damaged");
        done += (size_t)read;
        stream->position += read;
    }
    return RESULT_OK;
}

Result byte_stream_finish(ByteStream *stream) {
    char more;
    int read = read_some(stream, &more, 1);
    if (read > 0)
        return refuse_damaged(stream, "there is more than promised");
    if (stream->zip) {
        stream->member_open = false;
        read = unzCloseCurrentFile(stream->zip) == UNZ_OK ? read : -1;
    }
    return read == 0 ? RESULT_OK : refuse_damaged(stream, "the checksum is wrong");
}
