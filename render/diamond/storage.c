#include "render/diamond/storage.h"

#include "base/log.h"
#include "render/gl.h"

#define GROUPS_ACROSS 32768 // the standard allows 65535 at least

Result storage_create(const char *what, const void *data, size_t bytes, Storage *out) {
    gl_take_error();
    glCreateBuffers(1, &out->buffer);
    glNamedBufferStorage(out->buffer, (GLsizeiptr)bytes, data, GL_DYNAMIC_STORAGE_BIT);
    if (gl_take_error() != GL_NO_ERROR) {
        log_error("%s: the driver refuses a buffer of %zu MiB; fly with --compute cpu", what, (bytes >> 20) + 1);
        storage_destroy(out);
        return RESULT_DEVICE;
    }
    out->bytes = bytes;
    if (!data)
        storage_clear(out);
    return RESULT_OK;
}

void storage_destroy(Storage *storage) {
    glDeleteBuffers(1, &storage->buffer);
    *storage = (Storage){0};
}

void storage_clear(const Storage *storage) {
    glClearNamedBufferData(storage->buffer, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
}

void storage_bind(const Storage *storage, unsigned binding) {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, storage->buffer);
}

void storage_read(const Storage *storage, void *out, size_t bytes) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(storage->buffer, 0, (GLsizeiptr)bytes, out);
}

size_t storage_bytes_max(void) {
    GLint64 bytes = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
    return (size_t)bytes;
}

void storage_dispatch(int64_t invocations) {
    int64_t groups = (invocations + STORAGE_GROUP - 1) / STORAGE_GROUP;
    int64_t across = groups < GROUPS_ACROSS ? groups : GROUPS_ACROSS;
    glDispatchCompute((GLuint)across, (GLuint)((groups + across - 1) / across), 1);
}

void storage_barrier(void) {
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}
