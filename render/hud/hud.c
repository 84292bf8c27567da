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

void hud_draw(Hud *hud, const RenderPacket *packet, const RenderStats *previous, int width, int height) {
    if (width < 1 || height < 1)
        return;
    hud_paint(hud->canvas, hud->text, packet, previous, width, height);
    canvas_gl_draw(hud->gl, hud->canvas, hud->text, width, height);
}
