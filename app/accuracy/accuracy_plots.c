// Plots by gnuplot: the data of a report as blocks, then the script of assets/data/report, run in the report's folder.
#define _GNU_SOURCE // posix_spawn_file_actions_addchdir_np
#include "app/accuracy/accuracy_plots.h"
#include "base/log.h"
#include "base/paths.h"
#include "terrain/mesh/mesh_file.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define SCRIPT "plots.gp"
#define SAID "plots.log"
#define TARGETS_MAX 3
#define BLOCK_END "\n\n" // between the parts of a block

extern char **environ;

typedef struct Plot {
    const char *name, *what;
} Plot;
static const Plot OF_DEM[] = {{"pareto", "measured error against frame time"},
                              {"refine", "measured error against the time of refinement"},
                              {"claimed", "claimed error against measured error"},
                              {"triangles", "triangles against the tolerance"},
                              {"bound", "measured error against triangles, by kind of vertex errors"},
                              {"track", "error and frame time along the flights"},
                              {"times", "distribution of frame times"},
                              {"equal", "frame time at equal measured error"}};
static const Plot OF_ALL[] = {{"preprocessing", "time of building the errors against the size"},
                              {"workers", "gain by workers"}};

// A style sheet gives the two colours of the script what the reader's theme asks for.
static const char STYLE[] = "<style>"
                            "[stroke='rgb( 18,  52,  86)']{stroke:#3b444c}[fill='rgb(18,52,86)']{fill:#20272d}"
                            "[stroke='rgb(101,  67,  33)']{stroke:#dfe3e6}"
                            "@media(prefers-color-scheme:dark){"
                            "[stroke='rgb( 18,  52,  86)']{stroke:#aab4bc}[fill='rgb(18,52,86)']{fill:#dde3e8}"
                            "[stroke='rgb(101,  67,  33)']{stroke:#343c43}}"
                            "</style>";

static void plain_stem(const Accuracy *accuracy, int dem, char out[64]) {
    const char *name = accuracy->dems[dem].name, *dot = strrchr(name, '.');
    size_t length = dot && dot > name ? (size_t)(dot - name) : strlen(name), used = 0;
    for (size_t i = 0; i < length && used < 56; i++)
        out[used++] = isalnum((unsigned char)name[i]) || name[i] == '-' ? name[i] : '_';
    out[used] = '\0';
}

void accuracy_stem(const Accuracy *accuracy, int dem, char out[64]) {
    plain_stem(accuracy, dem, out);
    for (int i = 0; i < accuracy->plan.dem_count; i++) {
        char other[64];
        plain_stem(accuracy, i, other);
        if (i == dem || strcmp(other, out) != 0)
            continue;
        size_t used = strlen(out);
        snprintf(out + used, 64 - used, "_%c", (char)('1' + dem)); // a '_' before a digit: no other DEM's own
        return;
    }
}

int accuracy_tau_shown(const Accuracy *accuracy) {
    int best = 0;
    for (int i = 1; i < accuracy->plan.tau_count; i++)
        if (fabs(log(accuracy->plan.tau_px[i])) < fabs(log(accuracy->plan.tau_px[best])))
            best = i;
    return best;
}

// ---- data ----

// For gnuplot: nothing in it is a command.
static void put_string(const char *text, FILE *to) {
    fputc('\'', to);
    for (; *text; text++)
        fprintf(to, *text == '\'' ? "\'\'" : "%c", iscntrl((unsigned char)*text) ? '?' : *text);
    fputc('\'', to);
}

static void put_entry(const char *array, int index, const char *text, FILE *to) {
    fprintf(to, "%s[%d] = ", array, index);
    put_string(text, to);
    fputc('\n', to);
}

// The tolerances; and the lines of the first method with each kind of errors.
static void put_taus(const AccuracyPlan *plan, FILE *to) {
    fprintf(to, "TAUS = %d\narray TAU[%d]\n", plan->tau_count, plan->tau_count);
    for (int i = 0; i < plan->tau_count; i++)
        fprintf(to, "TAU[%d] = %g\n", i + 1, plan->tau_px[i]);
    int bounds = accuracy_variant_of_kind(plan, 0) < 0 ? 0 : plan->kind_count;
    fprintf(to, "BOUNDS = %d\narray BOUND[%d]\n", bounds, bounds + 1);
    for (int kind = 0; kind < bounds; kind++)
        fprintf(to, "BOUND[%d] = %d\n", kind + 1, accuracy_variant_of_kind(plan, kind) + 1);
}

static void put_names(const Accuracy *accuracy, FILE *to) {
    const AccuracyPlan *plan = &accuracy->plan;
    fprintf(to, "DEMS = %d\nVARIANTS = %d\nSOFTWARE = %d\nTAU_SHOWN = %g\nFLIGHTS = %d\nFRAMES = %d\n", plan->dem_count,
            plan->variant_count, accuracy->software, plan->tau_px[accuracy_tau_shown(accuracy)], plan->flight_count,
            plan->frames);
    fprintf(to, "array NAME[%d]\narray KIND[%d]\narray DEM[%d]\narray STEM[%d]\narray FLIGHT[%d]\n",
            plan->variant_count, plan->variant_count, plan->dem_count, plan->dem_count, plan->flight_count);
    for (int i = 0; i < plan->flight_count; i++)
        put_entry("FLIGHT", i + 1, accuracy->dems[0].tracks[i].name, to);
    for (int i = 0; i < plan->variant_count; i++) {
        put_entry("NAME", i + 1, plan->variants[i].name, to);
        fprintf(to, "KIND[%d] = %d\n", i + 1, plan->variants[i].kind);
    }
    for (int i = 0; i < plan->dem_count; i++) {
        char stem[64];
        accuracy_stem(accuracy, i, stem);
        put_entry("DEM", i + 1, stem, to);
        put_entry("STEM", i + 1, stem, to);
    }
    put_taus(plan, to);
}

static void put_number(double value, FILE *to) {
    if (isfinite(value))
        fprintf(to, " %.9g", value);
    else
        fputs(" NaN", to);
}

static void put_runs(const Accuracy *accuracy, FILE *to) {
    const AccuracyPlan *plan = &accuracy->plan;
    fputs("$runs << EOD\n", to);
    for (int i = 0; i < accuracy->run_count; i++) {
        const AccuracyRun *run = &accuracy->runs[i];
        const AccuracySummary *s = &run->summary;
        const double numbers[] = {run->tau_px,         s->reached_px,     s->max_px,         s->frame_ms.p50,
                                  s->frame_p50.least,  s->frame_p50.most, s->triangles_mean, s->update_ms.p50,
                                  s->update_p50.least, s->update_p50.most};
        for (size_t k = 0; k < COUNT_OF(numbers); k++)
            put_number(numbers[k], to);
        fputs((i + 1) % plan->tau_count == 0 ? "\n" BLOCK_END : "\n", to);
    }
    fputs("EOD\n", to);
}

// Whether nothing is both as accurate and as fast, and better in one of them.
static bool is_on_front(const Accuracy *accuracy, const AccuracyRun *run) {
    const AccuracySummary *s = &run->summary;
    for (int i = 0; i < accuracy->run_count; i++) {
        const AccuracySummary *o = &accuracy->runs[i].summary;
        bool as_good = o->max_px <= s->max_px && o->frame_ms.p50 <= s->frame_ms.p50;
        bool better = o->max_px < s->max_px || o->frame_ms.p50 < s->frame_ms.p50;
        if (accuracy->runs[i].dem == run->dem && as_good && better)
            return false;
    }
    return true;
}

static int by_error(const void *a, const void *b) {
    double x = (*(const AccuracyRun *const *)a)->summary.max_px, y = (*(const AccuracyRun *const *)b)->summary.max_px;
    return (x > y) - (x < y);
}

// The Pareto front of each DEM.
static Result put_front(const Accuracy *accuracy, FILE *to) {
    const AccuracyRun **front = malloc(sizeof(const AccuracyRun *) * (size_t)accuracy->run_count);
    if (!front)
        return RESULT_MEMORY;
    fputs("$front << EOD\n", to);
    for (int dem = 0; dem < accuracy->plan.dem_count; dem++) {
        int count = 0;
        for (int i = 0; i < accuracy->run_count; i++)
            if (accuracy->runs[i].dem == dem && is_on_front(accuracy, &accuracy->runs[i]))
                front[count++] = &accuracy->runs[i];
        qsort(front, (size_t)count, sizeof *front, by_error);
        for (int i = 0; i < count; i++)
            fprintf(to, "%.9g %.9g\n", front[i]->summary.max_px, front[i]->summary.frame_ms.p50);
        fputs(BLOCK_END, to);
    }
    fputs("EOD\n", to);
    free(front);
    return RESULT_OK;
}

static void put_track(const Accuracy *accuracy, FILE *to) {
    int tau = accuracy_tau_shown(accuracy);
    fputs("$track << EOD\n", to);
    for (int dem = 0; dem < accuracy->plan.dem_count; dem++)
        for (int variant = 0; variant < accuracy->plan.variant_count; variant++) {
            const AccuracyRun *run = accuracy_run_at(accuracy, dem, variant, tau);
            for (int pose = 0; pose < accuracy->dems[dem].pose_count; pose++) {
                const AccuracyPose *p = &accuracy->dems[dem].poses[pose];
                if (p->number == 0 && pose > 0)
                    fputc('\n', to); // another flight: the line is broken
                fprintf(to, "%d", pose);
                put_number(run->frames[pose].measure.max_px, to);
                put_number(p->jump ? NAN : run->frames[pose].median.frame_ms, to);
                fputc('\n', to);
            }
            fputs(BLOCK_END, to);
        }
    fputs("EOD\n", to);
}

// Steps from 0 to 1 over the frames of all rounds, so that a slow frame of any round shows.
static void put_times_of(const AccuracyRun *run, FILE *to) {
    for (int i = 0; i < run->frame_ms_count; i++) {
        if (i == 0)
            fprintf(to, "%.9g 0\n", run->frame_ms[i]);
        fprintf(to, "%.9g %.6g\n", run->frame_ms[i], (i + 1.0) / run->frame_ms_count);
    }
    fputs(BLOCK_END, to);
}

static void put_times(const Accuracy *accuracy, FILE *to) {
    fputs("$times << EOD\n", to);
    for (int dem = 0; dem < accuracy->plan.dem_count; dem++)
        for (int variant = 0; variant < accuracy->plan.variant_count; variant++)
            put_times_of(accuracy_run_at(accuracy, dem, variant, accuracy_tau_shown(accuracy)), to);
    fputs("EOD\n", to);
}

// The largest tolerances but one, which lines of methods that keep their bound do not reach.
static void put_equal(const Accuracy *accuracy, FILE *to) {
    const AccuracyPlan *plan = &accuracy->plan;
    int reached = plan->tau_count > 1 ? plan->tau_count - 1 : 1;
    int count = reached > TARGETS_MAX ? TARGETS_MAX : reached, first = reached - count;
    fprintf(to, "TARGETS = %d\narray TARGET[%d]\n", count, count);
    for (int t = 0; t < count; t++)
        fprintf(to, "TARGET[%d] = %g\n", t + 1, plan->tau_px[first + t]);
    fputs("$equal << EOD\n", to);
    for (int dem = 0; dem < plan->dem_count; dem++)
        for (int t = 0; t < count; t++) {
            for (int variant = 0; variant < plan->variant_count; variant++) {
                fprintf(to, "%d", variant + 1);
                AccuracyCost cost = accuracy_cost_at(accuracy, dem, variant, plan->tau_px[first + t]);
                put_number(cost.frame_ms, to);
                put_number(cost.frame_least_ms, to);
                put_number(cost.frame_most_ms, to);
                fputc('\n', to);
            }
            fputs(BLOCK_END, to);
        }
    fputs("EOD\n", to);
}

// Building errors of a kind over the largest ground, as many times as fast as one thread builds them.
static void put_building(const PreprocessBench *bench, const PreprocessRun *single, FILE *to) {
    for (int i = 0; i < bench->run_count; i++) {
        const PreprocessRun *run = &bench->runs[i];
        if (run->kind == single->kind && run->stride == single->stride && run->scheme == ERROR_SCHEME_PARALLEL &&
            run->side == single->side)
            fprintf(to, "%d %.6g %.6g %.6g\n", run->threads,
                    preprocess_median(bench, single) / preprocess_median(bench, run),
                    preprocess_median(bench, single) / run->ns_per_vertex[bench->rounds - 1],
                    preprocess_median(bench, single) / run->ns_per_vertex[0]);
    }
    fputs(BLOCK_END, to);
}

static bool is_single(const PreprocessBench *bench, const PreprocessRun *run) {
    return run->threads == 1 && run->scheme == ERROR_SCHEME_PARALLEL &&
           run->side == bench->sides[bench->side_count - 1];
}

// Gains by workers: refinement by method, then building by kind.
static void put_workers(const AccuracyScaling *scaling, FILE *to) {
    const PreprocessBench *bench = &scaling->preprocess;
    int lines = 0;
    fprintf(to, "array METHOD[%d]\n", scaling->speed_count + bench->run_count + 1);
    for (int i = 0; i < scaling->speed_count; i++)
        if (scaling->speeds[i].threads == 1)
            put_entry("METHOD", ++lines, lod_method_name(scaling->speeds[i].method), to);
    for (int i = 0; i < bench->run_count; i++)
        if (is_single(bench, &bench->runs[i])) {
            char kind[PREPROCESS_NAME_BYTES];
            preprocess_kind_name(&bench->runs[i], kind);
            fprintf(to, "METHOD[%d] = 'building %s'\n", ++lines, kind);
        }
    fprintf(to, "METHODS = %d\n$workers << EOD\n", lines);
    for (int i = 0; i < scaling->speed_count; i++) {
        if (i > 0 && scaling->speeds[i].threads == 1)
            fputs(BLOCK_END, to);
        const AccuracySpeed *speed = &scaling->speeds[i];
        fprintf(to, "%d %.6g %.6g %.6g\n", speed->threads, speed->speedup, speed->least_speedup, speed->most_speedup);
    }
    fputs(BLOCK_END, to);
    for (int i = 0; i < bench->run_count; i++)
        if (is_single(bench, &bench->runs[i]))
            put_building(bench, &bench->runs[i], to);
    fputs("EOD\n", to);
}

static bool same_line(const PreprocessRun *a, const PreprocessRun *b) {
    return a->kind == b->kind && a->stride == b->stride && a->scheme == b->scheme && a->threads == b->threads;
}

// Whether the run is the first one of its kind, scheme and number of threads.
static bool begins_line(const PreprocessBench *bench, int run) {
    for (int i = 0; i < run; i++)
        if (same_line(&bench->runs[i], &bench->runs[run]))
            return false;
    return true;
}

static void put_line(const PreprocessBench *bench, const PreprocessRun *first, FILE *to) {
    for (int i = 0; i < bench->run_count; i++) {
        const PreprocessRun *run = &bench->runs[i];
        double scale = (double)run->side * run->side * 1e-6;
        if (same_line(run, first))
            fprintf(to, "%d %.9g %.9g %.9g\n", run->side, scale * preprocess_median(bench, run),
                    scale * run->ns_per_vertex[0], scale * run->ns_per_vertex[bench->rounds - 1]);
    }
    fputs(BLOCK_END, to);
}

// Lines over the sizes.
static void put_sizes(const PreprocessBench *bench, FILE *to) {
    int lines = 0;
    fprintf(to, "array SIZE[%d]\n", bench->run_count + 1);
    for (int i = 0; i < bench->run_count; i++)
        if (begins_line(bench, i)) {
            char kind[PREPROCESS_NAME_BYTES];
            preprocess_kind_name(&bench->runs[i], kind);
            fprintf(to, "SIZE[%d] = '%s, %s, %d'\n", ++lines, kind, preprocess_scheme_name(&bench->runs[i]),
                    bench->runs[i].threads);
        }
    fprintf(to, "SIZES = %d\n$sizes << EOD\n", lines);
    for (int i = 0; i < bench->run_count; i++)
        if (begins_line(bench, i))
            put_line(bench, &bench->runs[i], to);
    fputs("EOD\n", to);
}

// ---- the script ----

static Result copy_script(FILE *to) {
    char path[PATHS_BYTES_MAX], block[4096];
    Result result = paths_find_data("report/" SCRIPT, path);
    if (result != RESULT_OK)
        return result;
    FILE *from = fopen(path, "r");
    if (!from) {
        log_error("%s: cannot be read: %s", path, strerror(errno));
        return RESULT_IO;
    }
    for (size_t got; (got = fread(block, 1, sizeof block, from)) > 0;)
        fwrite(block, 1, got, to);
    fclose(from);
    return RESULT_OK;
}

static Result write_script(const Accuracy *accuracy, const char *folder) {
    char path[PATHS_BYTES_MAX];
    snprintf(path, sizeof path, "%s/" SCRIPT, folder);
    FILE *to = fopen(path, "w");
    if (!to) {
        log_error("%s: cannot be written: %s", path, strerror(errno));
        return RESULT_IO;
    }
    put_names(accuracy, to);
    put_runs(accuracy, to);
    put_track(accuracy, to);
    put_times(accuracy, to);
    Result result = put_front(accuracy, to);
    put_equal(accuracy, to);
    put_workers(&accuracy->scaling, to);
    put_sizes(&accuracy->scaling.preprocess, to);
    if (result == RESULT_OK)
        result = copy_script(to);
    bool written = !ferror(to);
    if (fclose(to) == 0 && written)
        return result;
    log_error("%s: writing failed: %s", path, strerror(errno));
    return RESULT_IO;
}

static bool is_program(const char *name) {
    const char *path = getenv("PATH");
    char copy[4096], file[4400], *rest = copy;
    snprintf(copy, sizeof copy, "%s", path ? path : "");
    for (char *folder; (folder = strsep(&rest, ":")) != NULL;) {
        snprintf(file, sizeof file, "%s/%s", folder, name);
        if (*folder && access(file, X_OK) == 0)
            return true;
    }
    return false;
}

Result accuracy_check_plots(void) {
    if (is_program("gnuplot"))
        return RESULT_OK;
    log_error(
        "gnuplot is not there, and it draws the report's plots: install it (sudo apt-get install gnuplot-nox), or "
        "leave -o away for a table");
    return RESULT_NOT_FOUND;
}

// Runs gnuplot in the folder, where what it says is kept if it fails.
static bool run_gnuplot(const char *folder) {
    char *const arguments[] = {"gnuplot", SCRIPT, NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status = -1;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return false;
    int failed = posix_spawn_file_actions_addchdir_np(&actions, folder);
    if (!failed)
        failed = posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, SAID, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (!failed)
        failed = posix_spawnp(&child, arguments[0], &actions, NULL, arguments, environ);
    while (!failed && waitpid(child, &status, 0) < 0 && errno == EINTR)
        ;
    posix_spawn_file_actions_destroy(&actions);
    return !failed && status == 0;
}

static Result draw_plots(const char *folder) {
    char said[PATHS_BYTES_MAX];
    snprintf(said, sizeof said, "%s/" SAID, folder);
    if (!run_gnuplot(folder)) {
        log_error("%s: gnuplot could not draw the plots of " SCRIPT "; what it said is in %s", folder, said);
        return RESULT_IO;
    }
    unlink(said);
    return RESULT_OK;
}

// ---- the pictures ----

Result accuracy_read_file(const char *path, char **bytes, size_t *count) {
    FILE *file = fopen(path, "rb");
    char block[65536];
    *bytes = NULL;
    *count = 0;
    if (!file) {
        log_error("%s: cannot be read: %s", path, strerror(errno));
        return RESULT_NOT_FOUND;
    }
    FILE *memory = open_memstream(bytes, count);
    for (size_t got; memory && (got = fread(block, 1, sizeof block, file)) > 0;)
        fwrite(block, 1, got, memory);
    bool read = !ferror(file);
    fclose(file);
    if (memory && fclose(memory) == 0 && read)
        return RESULT_OK;
    log_error("%s: reading failed", path);
    free(*bytes);
    *bytes = NULL;
    return RESULT_IO;
}

static Result style_picture(const char *path) {
    char *bytes;
    size_t count;
    MeshFile *file;
    Result result = accuracy_read_file(path, &bytes, &count);
    if (result != RESULT_OK)
        return result;
    const char *svg = strstr(bytes, "<svg"), *end = svg ? strchr(svg, '>') : NULL;
    size_t head = end ? (size_t)(end + 1 - bytes) : count;
    result = mesh_file_create(path, &file);
    if (result == RESULT_OK) {
        mesh_file_bytes(file, bytes, head);
        mesh_file_text(file, "%s", end ? STYLE : "");
        mesh_file_bytes(file, bytes + head, count - head);
        result = mesh_file_commit(&file);
    }
    free(bytes);
    return result;
}

int accuracy_plots_of_dem(void) {
    return (int)COUNT_OF(OF_DEM);
}

int accuracy_plot_count(const Accuracy *accuracy) {
    return (int)COUNT_OF(OF_DEM) * accuracy->plan.dem_count + (int)COUNT_OF(OF_ALL);
}

void accuracy_plot_name(const Accuracy *accuracy, int plot, char out[ACCURACY_PLOT_BYTES]) {
    int of_dems = (int)COUNT_OF(OF_DEM) * accuracy->plan.dem_count;
    char stem[64];
    if (plot >= of_dems) {
        snprintf(out, ACCURACY_PLOT_BYTES, "%s.svg", OF_ALL[plot - of_dems].name);
        return;
    }
    accuracy_stem(accuracy, plot / (int)COUNT_OF(OF_DEM), stem);
    snprintf(out, ACCURACY_PLOT_BYTES, "%s-%s.svg", OF_DEM[plot % (int)COUNT_OF(OF_DEM)].name, stem);
}

const char *accuracy_plot_what(const Accuracy *accuracy, int plot) {
    int of_dems = (int)COUNT_OF(OF_DEM) * accuracy->plan.dem_count;
    return plot >= of_dems ? OF_ALL[plot - of_dems].what : OF_DEM[plot % (int)COUNT_OF(OF_DEM)].what;
}

Result accuracy_write_plots(const Accuracy *accuracy, const char *folder) {
    Result result = write_script(accuracy, folder);
    if (result == RESULT_OK)
        result = draw_plots(folder);
    for (int plot = 0; plot < accuracy_plot_count(accuracy) && result == RESULT_OK; plot++) {
        char name[ACCURACY_PLOT_BYTES], path[PATHS_BYTES_MAX];
        accuracy_plot_name(accuracy, plot, name);
        snprintf(path, sizeof path, "%s/%s", folder, name);
        result = style_picture(path);
    }
    return result;
}
