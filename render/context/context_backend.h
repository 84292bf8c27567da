// render/context/context_backend.h: what a window system must do for a Context; one table per system.
// Pixels.
// A backend embeds Context as its first member and frees the whole in `destroy`.
#pragma once
#include "render/context/context.h"

typedef struct ContextBackend {
    void (*destroy)(Context *context); // takes a half-built one
    Result (*make_current)(Context *context);
    void (*release_current)(Context *context);
    void (*swap)(Context *context);
    // Windows only; NULL elsewhere.
    void (*poll_events)(Context *context);
    bool (*should_close)(const Context *context);
} ContextBackend;

struct Context {
    const ContextBackend *backend;
    unsigned framebuffer;
    bool software;
    char renderer_name[256];
    ContextKey *on_key;
    void *on_key_user;
    ContextPointer *on_pointer;
    void *on_pointer_user;
    ContextResize *on_resize;
    void *on_resize_user;
};

// Once the context is current: refuses what cannot draw this program's pictures, and notes the renderer.
// DEVICE: older than GL 4.5, or no clip control; logged with what was found.
MUST_USE Result context_inspect(Context *context, bool debug);
