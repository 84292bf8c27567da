// render/diamond/storage.h: buffers for compute shaders, what the driver allows of them, and dispatches over many
// invocations.
// Bytes; invocations.
// A Storage is one GL buffer, deleted by storage_destroy; thread of the context.
#pragma once
#include "base/base.h"

#define STORAGE_GROUP 64 // invocations of a work group, as the shaders of diamonds have it

typedef struct Storage {
    unsigned buffer; // GL name; 0: none
    size_t bytes;
} Storage;

// `data` may be NULL: zeros. DEVICE, with a message that names `what`: the driver has no room for it.
MUST_USE Result storage_create(const char *what, const void *data, size_t bytes, Storage *out);
void storage_destroy(Storage *storage);
void storage_clear(const Storage *storage); // to zeros
void storage_bind(const Storage *storage, unsigned binding);
// Copies the first bytes to memory, after all that was dispatched.
void storage_read(const Storage *storage, void *out, size_t bytes);

// The largest buffer that a shader can reach all of.
size_t storage_bytes_max(void);

// Runs the bound compute program over at least `invocations` >= 1, in groups of STORAGE_GROUP.
void storage_dispatch(int64_t invocations);
// What was written is seen by the dispatches that follow.
void storage_barrier(void);
