#include "app/picture_options.h"

ContextOptions picture_context_options(const Options *options) {
    const double *size = options_numbers(options, OPTION_SIZE);
    return (ContextOptions){.width = (int)size[0],
                            .height = (int)size[1],
                            .title = "Overfly",
                            .debug = options_flag(options, OPTION_DEBUG_GL)};
}

static void set_image_bounds(RenderOptions *render, const double bounds[4]) {
    render->image_bounds_given = true;
    render->image_west_deg = bounds[0];
    render->image_south_deg = bounds[1];
    render->image_east_deg = bounds[2];
    render->image_north_deg = bounds[3];
}

RenderOptions picture_render_options(const Options *options, const World *world) {
    RenderOptions render = render_default_options();
    const double *size = options_numbers(options, OPTION_SIZE);
    bool image_given = options_is_set(options, OPTION_IMAGE);
    render.width = (int)size[0];
    render.height = (int)size[1];
    render.samples = (int)options_integer(options, OPTION_SAMPLES);
    render.vram_bytes_max = (size_t)options_integer(options, OPTION_VRAM);
    render.image_path = image_given ? options_text(options, OPTION_IMAGE) : world->scene.image;
    if (options_is_set(options, OPTION_IMAGE_BOUNDS))
        set_image_bounds(&render, options_numbers(options, OPTION_IMAGE_BOUNDS));
    else if (!image_given && world->scene.has_image_bounds)
        set_image_bounds(&render, world->scene.image_bounds);
    return render;
}
