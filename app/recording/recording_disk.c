#define _POSIX_C_SOURCE 200809L
#include "app/recording/recording_disk.h"

#include "base/log.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

Result recording_disk_open(RecordingDisk *disk, const char *path) {
    *disk = (RecordingDisk){.path = strdup(path), .file = -1};
    if (!disk->path)
        return RESULT_MEMORY;
    disk->file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (disk->file >= 0)
        return RESULT_OK;
    int error = errno;
    log_error("%s: cannot be created: %s; name a file in a folder that exists and may be written to", path,
              strerror(error));
    free(disk->path);
    disk->path = NULL;
    return error == ENOENT || error == ENOTDIR ? RESULT_NOT_FOUND : RESULT_IO;
}

static bool write_all(int file, const uint8_t *bytes, size_t count) {
    while (count > 0) {
        ssize_t written = write(file, bytes, count);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return false;
        bytes += written;
        count -= (size_t)written;
    }
    return true;
}

bool recording_disk_append(RecordingDisk *disk, const void *bytes, size_t count) {
    if (write_all(disk->file, bytes, count)) {
        disk->bytes += count;
        return true;
    }
    int error = errno;
    if (ftruncate(disk->file, (off_t)disk->bytes) == 0)
        lseek(disk->file, (off_t)disk->bytes, SEEK_SET);
    errno = error;
    return false;
}

bool recording_disk_sync(const RecordingDisk *disk) {
    return fdatasync(disk->file) == 0 || errno == EINVAL || errno == EROFS;
}

bool recording_disk_close(RecordingDisk *disk) {
    bool closed = disk->file < 0 || close(disk->file) == 0;
    free(disk->path);
    *disk = (RecordingDisk){.file = -1};
    return closed;
}

Result recording_disk_write_whole(const char *path, const void *bytes, size_t count) {
    size_t name_bytes = strlen(path) + sizeof ".part";
    char *part = malloc(name_bytes);
    RecordingDisk disk;
    if (!part)
        return RESULT_MEMORY;
    snprintf(part, name_bytes, "%s.part", path);
    Result result = recording_disk_open(&disk, part);
    if (result != RESULT_OK)
        goto done;
    bool written = recording_disk_append(&disk, bytes, count) && recording_disk_sync(&disk);
    int error = written ? 0 : errno;
    written = recording_disk_close(&disk) && written;
    if (!written || rename(part, path) != 0) {
        error = error ? error : errno;
        log_error("%s: cannot be written: %s; %zu bytes are needed", path, strerror(error), count);
        unlink(part);
        result = RESULT_IO;
    }
done:
    free(part);
    return result;
}
