#include "render/hud/hud.h"

#include "base/log.h"
#include "base/paths.h"
#include "render/hud/canvas_gl.h"
#include "render/hud/hud_paint.h"

#include <stdlib.h>

struct Hud {
    Text *text;
    Canvas *canvas;
    CanvasGl *gl;
    // What the panel of accuracy that is kept as a picture was painted from.
    uint64_t accuracy_revision;
    const char *accuracy_method;
    CanvasRect accuracy_place;
    int accuracy_height; // of the window
};

HudOptions hud_default_options(void) {
    return (HudOptions){.font_path = NULL};
}

static Result open_text(const char *font_path, Text **out) {
    char found[PATHS_BYTES_MAX];
    if (font_path)
        return text_create(font_path, out);
    Result result = paths_find_data("fonts/DejaVuSans.ttf", found);
    return result == RESULT_OK ? text_create(found, out) : result;
}

Result hud_create(const HudOptions *options, Hud **out) {
    Hud *hud = calloc(1, sizeof *hud);
    if (!hud) {
        log_error("no memory for the head-up display");
        return RESULT_MEMORY;
    }
    Result result = open_text(options->font_path, &hud->text);
    if (result != RESULT_OK)
        goto fail;
    result = canvas_create(&hud->canvas);
    if (result != RESULT_OK)
        goto fail;
    result = canvas_gl_create(&hud->gl);
    if (result != RESULT_OK)
        goto fail;
    *out = hud;
    return RESULT_OK;
fail:
    hud_destroy(&hud);
    return result;
}

void hud_destroy(Hud **hud) {
    if (!*hud)
        return;
    canvas_gl_destroy(&(*hud)->gl);
    canvas_destroy(&(*hud)->canvas);
    text_destroy(&(*hud)->text);
    free(*hud);
    *hud = NULL;
}

static bool same_place(CanvasRect a, CanvasRect b) {
    return a.x0 == b.x0 && a.y0 == b.y0 && a.x1 == b.x1 && a.y1 == b.y1;
}

// Painted when it tells something new, some times a second; drawn in every frame.
static void draw_accuracy(Hud *hud, const RenderPacket *packet, int width, int height) {
    const CanvasRect place = hud_accuracy_place(packet, width, height);
    uint64_t revision = packet->hud.accuracy.revision;
    if (place.x1 <= place.x0)
        return;
    bool kept = revision != 0 && revision == hud->accuracy_revision && same_place(place, hud->accuracy_place) &&
                height == hud->accuracy_height && packet->hud.method == hud->accuracy_method;
    if (!kept) {
        hud_paint_accuracy_alone(hud->canvas, hud->text, packet, width, height);
        const CanvasKept part = {place, hud_accuracy_edge_px(packet, width, height)};
        canvas_gl_keep(hud->gl, hud->canvas, hud->text, &part, width, height);
        hud->accuracy_revision = revision;
        hud->accuracy_place = place;
        hud->accuracy_height = height;
        hud->accuracy_method = packet->hud.method;
    }
    canvas_gl_draw_kept(hud->gl);
}

void hud_draw(Hud *hud, const RenderPacket *packet, const RenderStats *previous, int width, int height) {
    if (width < 1 || height < 1)
        return;
    hud_paint_most(hud->canvas, hud->text, packet, previous, width, height);
    canvas_gl_draw(hud->gl, hud->canvas, hud->text, width, height);
    draw_accuracy(hud, packet, width, height);
}
