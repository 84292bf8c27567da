#include "render/hud/canvas.h"

#include "base/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHAPES_AT_FIRST 2048
#define HALO_GROW 0.9f     // units that the halo reaches beyond its shape before it fades
#define HALO_SOFT 2.2f     // units over which it fades
#define HALO_OPACITY 0.68f // of that of the shape

typedef struct ShapeList {
    CanvasShape *shapes;
    int count, capacity;
} ShapeList;

struct Canvas {
    ShapeList under, over;
    float unit_px;
    bool halos, lower;
};

static bool list_reserve(ShapeList *list, int count) {
    if (count <= list->capacity)
        return true;
    int capacity = list->capacity * 2 > count ? list->capacity * 2 : count;
    CanvasShape *shapes = realloc(list->shapes, (size_t)capacity * sizeof *shapes);
    if (!shapes)
        return false;
    list->shapes = shapes;
    list->capacity = capacity;
    return true;
}

static bool is_finite_shape(const CanvasShape *shape) {
    float sum = 0.0f;
    for (int i = 0; i < 4; i++)
        sum += fabsf(shape->a[i]) + fabsf(shape->b[i]);
    return isfinite(sum);
}

static void list_push(ShapeList *list, const CanvasShape *shape) {
    if (list_reserve(list, list->count + 1))
        list->shapes[list->count++] = *shape;
}

static uint8_t byte_of(float share) {
    return (uint8_t)(fminf(fmaxf(share, 0.0f), 1.0f) * 255.0f + 0.5f);
}

static void set_colour(CanvasShape *shape, CanvasColour colour) {
    shape->rgba[0] = byte_of(colour.r);
    shape->rgba[1] = byte_of(colour.g);
    shape->rgba[2] = byte_of(colour.b);
    shape->rgba[3] = byte_of(colour.a);
}

static CanvasShape shape_make(CanvasKind kind, CanvasColour colour) {
    CanvasShape shape = {.kind = (float)kind, .soft = 1.0f};
    set_colour(&shape, colour);
    return shape;
}

static CanvasShape halo_of(const CanvasShape *shape, float unit_px) {
    CanvasShape halo = *shape;
    float reach = (HALO_GROW + HALO_SOFT) * unit_px;
    // A glyph's field ends at its spread; a halo beyond it would be cut off.
    float scale = shape->kind == (float)CANVAS_GLYPH ? fminf(1.0f, 0.95f * shape->spread / reach) : 1.0f;
    halo.grow = (HALO_GROW + HALO_SOFT * 0.5f) * unit_px * scale;
    halo.soft = HALO_SOFT * unit_px * scale;
    set_colour(&halo, (CanvasColour){0.02f, 0.04f, 0.06f, (float)shape->rgba[3] / 255.0f * HALO_OPACITY});
    return halo;
}

static void push_with_halo(Canvas *canvas, const CanvasShape *shape) {
    if (shape->rgba[3] == 0 || !is_finite_shape(shape))
        return;
    if (canvas->lower) {
        list_push(&canvas->under, shape);
        return;
    }
    if (canvas->halos) {
        CanvasShape halo = halo_of(shape, canvas->unit_px);
        list_push(&canvas->under, &halo);
    }
    list_push(&canvas->over, shape);
}

Result canvas_create(Canvas **out) {
    Canvas *canvas = calloc(1, sizeof *canvas);
    if (!canvas || !list_reserve(&canvas->under, SHAPES_AT_FIRST) || !list_reserve(&canvas->over, SHAPES_AT_FIRST)) {
        log_error("no memory for %d shapes of a canvas", 2 * SHAPES_AT_FIRST);
        canvas_destroy(&canvas);
        return RESULT_MEMORY;
    }
    canvas->unit_px = 1.0f;
    *out = canvas;
    return RESULT_OK;
}

void canvas_destroy(Canvas **canvas) {
    if (!*canvas)
        return;
    free((*canvas)->under.shapes);
    free((*canvas)->over.shapes);
    free(*canvas);
    *canvas = NULL;
}

void canvas_begin(Canvas *canvas, float unit_px) {
    canvas->under.count = canvas->over.count = 0;
    canvas->unit_px = unit_px;
    canvas->halos = true;
    canvas->lower = false;
}

void canvas_set_halos(Canvas *canvas, bool on) {
    canvas->halos = on;
}

void canvas_set_lower(Canvas *canvas, bool lower) {
    canvas->lower = lower;
}

void canvas_line(Canvas *canvas, CanvasPoint a, CanvasPoint b, float width_px, CanvasColour colour) {
    CanvasShape shape = shape_make(CANVAS_LINE, colour);
    memcpy(shape.a, (float[]){a.x, a.y, b.x, b.y}, sizeof shape.a);
    shape.b[0] = width_px * 0.5f;
    push_with_halo(canvas, &shape);
}

static CanvasShape box_make(CanvasRect box, float corner_px, float half_width_px, CanvasColour colour) {
    CanvasShape shape = shape_make(CANVAS_BOX, colour);
    memcpy(shape.a, (float[]){box.x0, box.y0, box.x1, box.y1}, sizeof shape.a);
    shape.b[0] = corner_px;
    shape.b[1] = half_width_px;
    return shape;
}

void canvas_box(Canvas *canvas, CanvasRect box, float corner_px, CanvasColour colour) {
    CanvasShape shape = box_make(box, corner_px, -1.0f, colour);
    if (shape.rgba[3] != 0 && is_finite_shape(&shape))
        list_push(&canvas->under, &shape);
}

void canvas_frame(Canvas *canvas, CanvasRect box, float corner_px, float width_px, CanvasColour colour) {
    CanvasShape shape = box_make(box, corner_px, width_px * 0.5f, colour);
    push_with_halo(canvas, &shape);
}

void canvas_triangle(Canvas *canvas, CanvasPoint a, CanvasPoint b, CanvasPoint c, CanvasColour colour) {
    CanvasShape shape = shape_make(CANVAS_TRIANGLE, colour);
    float turn = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (turn > 0.0f) { // clockwise, as y points downwards
        CanvasPoint swap = b;
        b = c;
        c = swap;
    }
    memcpy(shape.a, (float[]){a.x, a.y, b.x, b.y}, sizeof shape.a);
    shape.b[0] = c.x;
    shape.b[1] = c.y;
    push_with_halo(canvas, &shape);
}

void canvas_ring(Canvas *canvas, CanvasPoint centre, float radius_px, float width_px, CanvasColour colour) {
    CanvasRect box = {centre.x - radius_px, centre.y - radius_px, centre.x + radius_px, centre.y + radius_px};
    canvas_frame(canvas, box, radius_px, width_px, colour); // all corner
}

static void push_glyph(Canvas *canvas, const CanvasFont *font, CanvasPoint pen, const TextGlyph *glyph) {
    CanvasShape shape = shape_make(CANVAS_GLYPH, font->colour);
    float size = font->size_px;
    memcpy(shape.a,
           (float[]){pen.x + glyph->x0 * size, pen.y + glyph->y0 * size, pen.x + glyph->x1 * size,
                     pen.y + glyph->y1 * size},
           sizeof shape.a);
    memcpy(shape.b, (float[]){glyph->u0, glyph->v0, glyph->u1, glyph->v1}, sizeof shape.b);
    shape.spread = TEXT_SPREAD_EM * size;
    push_with_halo(canvas, &shape);
}

void canvas_text(Canvas *canvas, const CanvasFont *font, CanvasPoint at, const char *utf8) {
    CanvasPoint pen = at;
    if (font->align != CANVAS_LEFT) {
        float width = text_width_px(font->text, utf8, font->size_px);
        pen.x -= font->align == CANVAS_CENTRE ? width * 0.5f : width;
    }
    for (uint32_t character; (character = text_next_character(&utf8)) != 0;) {
        const TextGlyph *glyph = text_find_glyph(font->text, character);
        if (glyph->x1 > glyph->x0)
            push_glyph(canvas, font, pen, glyph);
        pen.x += glyph->advance * font->size_px;
    }
}

int canvas_under(const Canvas *canvas, const CanvasShape **shapes) {
    *shapes = canvas->under.shapes;
    return canvas->under.count;
}

int canvas_over(const Canvas *canvas, const CanvasShape **shapes) {
    *shapes = canvas->over.shapes;
    return canvas->over.count;
}
