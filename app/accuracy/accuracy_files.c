#include "app/accuracy/accuracy_html.h"
#include "app/accuracy/accuracy_plots.h"
#include "app/outputs.h"
#include "app/text_file.h"
#include "assets/image.h"
#include "config/files.h"

#include <stdio.h>

Result accuracy_check_report(const Options *options, const char *folder) {
    static const char *const begins[] = {"frames.", "summary.", "flight-", "worst-frame", NULL};
    Result result = accuracy_check_plots();
    if (result == RESULT_OK)
        result = files_make_folder(folder);
    if (result == RESULT_OK)
        result = files_check_folder(folder);
    return result == RESULT_OK ? outputs_check_folder(options, "--output", folder, begins) : result;
}

// ---- files that appear whole or not at all ----

typedef Result Printer(const Accuracy *accuracy, const char *folder, FILE *to);

static Result print_frames(const Accuracy *accuracy, const char *folder, FILE *to) {
    (void)folder;
    accuracy_write_frames(accuracy, to);
    return RESULT_OK;
}

static Result print_summary(const Accuracy *accuracy, const char *folder, FILE *to) {
    (void)folder;
    accuracy_write_summary(accuracy, to);
    return RESULT_OK;
}

static Result print_json(const Accuracy *accuracy, const char *folder, FILE *to) {
    (void)folder;
    Json *json = accuracy_make_json(accuracy);
    Result result = json_write(json, to);
    json_destroy(&json);
    return result;
}

static Result write_file(const Accuracy *accuracy, const char *folder, const char *name, Printer *print) {
    char path[PATHS_BYTES_MAX];
    TextFile file;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    Result result = text_file_begin(path, &file);
    return result == RESULT_OK ? text_file_end(&file, print(accuracy, folder, file.to)) : result;
}

static Result write_flight(const AccuracyDem *dem, const char *stem, int flight, const char *folder) {
    char path[PATHS_BYTES_MAX];
    TextFile file;
    snprintf(path, sizeof path, "%s/flight-%s-%s.csv", folder, stem, dem->tracks[flight].name);
    Result result = text_file_begin(path, &file);
    if (result != RESULT_OK)
        return result;
    (void)track_write(&dem->tracks[flight], file.to); // what the stream does not take, text_file_end tells
    return text_file_end(&file, RESULT_OK);
}

static Result write_flights(const Accuracy *accuracy, const char *folder) {
    Result result = RESULT_OK;
    for (int dem = 0; dem < accuracy->plan.dem_count; dem++) {
        char stem[64];
        accuracy_stem(accuracy, dem, stem);
        for (int i = 0; i < accuracy->plan.flight_count && result == RESULT_OK; i++)
            result = write_flight(&accuracy->dems[dem], stem, i, folder);
    }
    return result;
}

static Result write_picture(const AccuracyHeat *picture, const char *folder, const char *name) {
    char path[PATHS_BYTES_MAX];
    if (!picture->rgb)
        return RESULT_OK;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return image_write_png(path, picture->width, picture->height, 3, picture->rgb);
}

Result accuracy_write_report(const Accuracy *accuracy, const char *folder) {
    Result result = write_file(accuracy, folder, "frames.csv", print_frames);
    if (result == RESULT_OK)
        result = write_file(accuracy, folder, "summary.csv", print_summary);
    if (result == RESULT_OK)
        result = write_file(accuracy, folder, "summary.json", print_json);
    if (result == RESULT_OK)
        result = write_flights(accuracy, folder);
    if (result == RESULT_OK)
        result = write_picture(&accuracy->worst.heat, folder, "worst-frame-error.png");
    if (result == RESULT_OK)
        result = write_picture(&accuracy->worst.picture, folder, "worst-frame.png");
    if (result == RESULT_OK)
        result = accuracy_write_plots(accuracy, folder);
    return result == RESULT_OK ? write_file(accuracy, folder, "report.html", accuracy_write_html) : result;
}
