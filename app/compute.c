#include "app/compute.h"

#include "base/log.h"
#include "render/diamond/diamond_gpu.h"

typedef enum ComputeChoice { COMPUTE_AUTO, COMPUTE_GPU, COMPUTE_CPU } ComputeChoice; // as --compute lists them

Result compute_choose(const Options *options, Context *context, const Terrain *terrain, bool *resident) {
    ComputeChoice choice = (ComputeChoice)options_choice(options, OPTION_COMPUTE);
    const char *why = NULL;
    *resident = false;
    if (choice == COMPUTE_CPU || (choice == COMPUTE_AUTO && context_is_software(context)))
        return RESULT_OK;
    Result result = context_make_current(context);
    if (result != RESULT_OK)
        return result;
    *resident = diamond_gpu_check(terrain, &why) == RESULT_OK;
    context_release_current(context);
    if (!*resident && choice == COMPUTE_GPU)
        log_warn("--compute gpu: %s; diamonds are computed on the processor instead", why);
    else if (!*resident)
        log_debug("diamonds are computed on the processor: %s", why);
    return RESULT_OK;
}

void compute_add_json(Json *json, const RenderResident *resident) {
    if (!resident->made)
        return;
    Json *compute = json_add_object(json, "compute");
    json_add_text(compute, "where", "gpu");
    json_add_number(compute, "evaluation_ms", resident->evaluate_ms);
    json_add_number(compute, "closure_ms", resident->close_ms);
    json_add_number(compute, "indices_ms", resident->indices_ms);
}
