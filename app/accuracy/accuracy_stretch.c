// Popping in one long stretch of a flight: successive cuts, compared where they differ.
#include "app/accuracy/accuracy_internal.h"

#include <math.h>

static Result fly_stretch(Accuracy *accuracy, AccuracyPass *pass, int flight, int frames, MeasureStretch *stretch,
                          AccuracyRun *run) {
    const AccuracyPlan *plan = pass->plan;
    const Track *track = &pass->dem->tracks[flight];
    double begin_s = fmax((track_duration_s(track) - (frames - 1) / ACCURACY_FRAME_HZ) / 2.0, 0.0);
    Result result = RESULT_OK;
    for (int i = 0; i < frames && result == RESULT_OK && accuracy_goes_on(accuracy); i++) {
        Viewpoint at = track_at(track, begin_s + i / ACCURACY_FRAME_HZ);
        MeasurePopping popping = {0};
        result = accuracy_pass_refine_at(pass, &at);
        LodCut cut = pass->cut;
        if (result == RESULT_OK && plan->tamper)
            plan->tamper(plan->tamper_user, pass->world->terrain, &cut);
        if (result == RESULT_OK)
            result = measure_stretch_add(stretch, &cut, pass->world->jobs, &popping);
        run->stretch_px = fmax(run->stretch_px, popping.max_px);
        run->stretch_pairs += i > 0;
    }
    return result;
}

Result accuracy_stretch(Accuracy *accuracy, AccuracyPass *pass, int flight, int frames, AccuracyRun *run) {
    MeasureStretch *stretch = NULL;
    Result result = measure_stretch_create(pass->world->terrain, &stretch);
    if (result == RESULT_OK)
        result = fly_stretch(accuracy, pass, flight, frames, stretch, run);
    measure_stretch_destroy(&stretch);
    return result;
}
