#define _POSIX_C_SOURCE 200809L
#include "app/accuracy/accuracy_html.h"

#include "app/accuracy/accuracy_hitches.h"
#include "app/accuracy/accuracy_plots.h"
#include "app/accuracy/html.h"
#include "app/bench/bench.h"
#include "app/version.h"
#include "base/paths.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct Page {
    const Accuracy *accuracy;
    const char *folder;
    FILE *to;
} Page;

// ---- pictures and parts from files ----

static Result put_asset(const char *name, const char *before, const char *after, FILE *to) {
    char path[PATHS_BYTES_MAX], *bytes;
    size_t count;
    Result result = paths_find_data(name, path);
    if (result == RESULT_OK)
        result = accuracy_read_file(path, &bytes, &count);
    if (result != RESULT_OK)
        return result;
    fprintf(to, "<%s>\n", before);
    fwrite(bytes, 1, count, to);
    fprintf(to, "</%s>\n", after);
    free(bytes);
    return RESULT_OK;
}

static Result put_picture(const Page *page, const char *file, const char *alt, const char *css_class,
                          const char *caption) {
    char path[PATHS_BYTES_MAX], *bytes;
    size_t count, length = strlen(file);
    snprintf(path, sizeof path, "%s/%s", page->folder, file);
    Result result = accuracy_read_file(path, &bytes, &count);
    if (result != RESULT_OK)
        return result;
    const HtmlPicture picture = {
        .type = length > 4 && strcmp(file + length - 4, ".svg") == 0 ? "image/svg+xml" : "image/png",
        .name = alt,
        .css_class = css_class,
        .caption = caption,
        .bytes = (const unsigned char *)bytes,
        .count = count,
    };
    html_picture(&picture, page->to);
    free(bytes);
    return RESULT_OK;
}

// ---- the head ----

// Which frame it was, and how to see it again.
static void put_worst_frame(const Page *page) {
    const Accuracy *accuracy = page->accuracy;
    const AccuracyWorst *worst = &accuracy->worst;
    if (worst->run < 0)
        return;
    const AccuracyRun *run = &accuracy->runs[worst->run];
    const AccuracyDem *dem = &accuracy->dems[run->dem];
    const AccuracyPose *pose = &dem->poses[worst->frame];
    const AccuracyFrame *frame = &run->frames[worst->frame];
    bool promised = run->summary.promised;
    fputs("<p>", page->to);
    html_format(page->to,
                "The worst frame%s: %s at tau %g px over %s, frame %d of the flight \"%s\": %.4f px "
                "measured where %.4g px are %s, at column %d, row %d; %s. To see it again:",
                promised ? ", of those that promise" : "", accuracy->plan.variants[run->variant].name, run->tau_px,
                dem->name, pose->number, dem->tracks[pose->flight].name, frame->measure.max_px, frame->reached_px,
                promised ? "promised" : "asked for", frame->measure.worst_col, frame->measure.worst_row,
                worst->repeated ? "a refinement from scratch gave the same error"
                                : "a refinement from scratch gave another error");
    char *command = accuracy_command(accuracy, run, worst->frame);
    fputs("</p><pre><code id=\"again\">", page->to);
    html_text(command ? command : "(no memory)", page->to);
    free(command);
    fputs("</code></pre>\n", page->to);
}

static void put_verdict(const Page *page) {
    char text[ACCURACY_TEXT_BYTES];
    const Accuracy *accuracy = page->accuracy;
    bool holds = accuracy_holds(accuracy);
    accuracy_verdict(accuracy, text);
    const char *rest = strchr(text, ':'); // what stands before it is the heading
    int head = rest ? (int)(rest + 1 - text) : 0;
    fprintf(page->to, "<div class=\"verdict%s\" id=\"verdict\"><p><strong>", holds ? "" : " broken");
    html_format(page->to, "%.*s", head, text);
    fputs("</strong>", page->to);
    html_text(text + head, page->to);
    fputs("</p>\n", page->to);
    for (int i = 0; i < accuracy->run_count; i++) {
        accuracy_fault(accuracy, &accuracy->runs[i], text);
        if (*text)
            html_element("p", text, page->to);
    }
    put_worst_frame(page);
    fputs("</div>\n", page->to);
    if (accuracy->software)
        fputs(
            "<p class=\"notice\">Drawn by a software renderer: the times of drawing, and of whole frames, compare the "
            "methods on this machine, and say little about a GPU. Those of refinement are of the processor "
            "anyway.</p>\n",
            page->to);
}

static void put_unequal_cuts(const Page *page) {
    int unequal = 0;
    for (int i = 0; i < page->accuracy->run_count; i++)
        unequal += !page->accuracy->runs[i].summary.same_cuts;
    if (unequal)
        html_format(page->to,
                    "Runs that were timed over other cuts than were measured, so that their times are not those of the "
                    "errors beside them: %d. ",
                    unequal);
}

static Result put_worst(const Page *page) {
    if (page->accuracy->worst.run < 0)
        return RESULT_OK;
    fputs("<h2 id=\"worst\">The worst frame</h2>\n<div class=\"pair\">\n", page->to);
    Result result = put_picture(page, "worst-frame-error.png", "the error of each sample, on the map", "map",
                                "The error of every sample, on the map: the brighter, the more of the bound is used up "
                                "(below: none to all); magenta: more than that; black: no triangle. White ring: the "
                                "eye; red ring: the worst sample.");
    if (result == RESULT_OK && page->accuracy->worst.picture.rgb)
        result = put_picture(page, "worst-frame.png", "the worst frame as it is drawn", "map", "The frame itself.");
    fputs("</div><div class=\"ramp\" role=\"img\" aria-label=\"none to all of the bound\"></div>\n", page->to);
    return result;
}

// ---- tables ----

static void put_promise(const AccuracyRun *run, FILE *to) {
    const char *word = !accuracy_run_holds(run) ? "broken" : run->summary.promised ? "held" : "none";
    html_cell_text(word, run->summary.promised || !accuracy_run_holds(run) ? word : "", to);
}

// Nothing found says as much as there was to find it in.
static void put_popping(const AccuracySummary *s, FILE *to) {
    char none[48];
    snprintf(none, sizeof none, "none in %d pairs", s->popping_pairs);
    if (s->popping_px > 0.0)
        html_cell_number(s->popping_px, 2, to);
    else
        html_cell_text(none, "", to);
    html_cell_number(s->popping_pairs, 0, to);
}

static void put_run_row(const Page *page, const AccuracyRun *run) {
    const AccuracySummary *s = &run->summary;
    FILE *to = page->to;
    html_begin_row(to);
    html_cell_text(page->accuracy->plan.variants[run->variant].name, "", to);
    html_cell_number(run->tau_px, 2, to);
    put_promise(run, to);
    html_cell_number(s->promised ? s->reached_px : NAN, 2, to);
    html_cell_number(s->max_px, 3, to);
    html_cell_number(s->p999_px, 3, to);
    html_cell_number(s->p99_px, 3, to);
    html_cell_number(s->rms_px, 3, to);
    html_cell_number(100.0 * s->above_tau_share, 3, to);
    put_popping(s, to);
    html_cell_number((double)(s->t_junctions + s->holes + s->overlaps), 0, to);
    html_cell_number(s->triangles_mean, 0, to);
    html_cell_number(100.0 * s->rebuilt_share, 1, to);
    html_cell_number(s->mean.select_ms, 2, to);
    html_cell_number(s->mean.refine_ms, 2, to);
    html_cell_number(s->mean.upload_ms, 2, to);
    html_cell_number(s->mean.draw_ms, 2, to);
    html_cell_number(s->update_ms.p50, 3, to);
    html_cell_number(s->update_p50.least, 3, to);
    html_cell_number(s->update_p50.most, 3, to);
    html_cell_number(s->frame_ms.p50, 2, to);
    html_cell_number(s->frame_p50.least, 2, to);
    html_cell_number(s->frame_p50.most, 2, to);
    html_cell_number(s->frame_ms.p95, 2, to);
    html_cell_number(s->frame_ms.p99, 2, to);
    html_cell_number(s->frame_ms.max, 2, to);
    html_cell_number(s->upload_bytes_mean / 1e3, 1, to);
    html_cell_number((double)s->vram_bytes / 1e6, 1, to);
    html_cell_number((double)s->memory_bytes / 1e6, 1, to);
    html_end_row(to);
}

static void put_runs(const Page *page, int dem) {
    static const char *const titles[] = {"<method",    "tau px",       "<promise",    "holds px",      "max px",
                                         "p99.9 px",   "p99 px",       "RMS px",      "% above tau",   "popping px",
                                         "pairs",      "cracks",       "triangles",   "% new",         "select ms",
                                         "refine ms",  "upload ms",    "draw ms",     "update p50 ms", "least round",
                                         "most round", "frame p50 ms", "least round", "most round",    "p95 ms",
                                         "p99 ms",     "max ms",       "upload kB",   "VRAM MB",       "memory MB"};
    int of_dem = page->accuracy->plan.variant_count * page->accuracy->plan.tau_count;
    html_begin_table(titles, COUNT_OF(titles), page->to);
    for (int i = dem * of_dem; i < (dem + 1) * of_dem; i++)
        put_run_row(page, &page->accuracy->runs[i]);
    html_end_table(page->to);
}

// At the tolerances but the largest, which lines of methods that keep their bound do not reach.
static void put_equal(const Page *page, int dem) {
    static const char *const titles[] = {"<method",    "measured px", "frame ms",  "least round",
                                         "most round", "update ms",   "triangles", "build ms"};
    const AccuracyPlan *plan = &page->accuracy->plan;
    int taus = plan->tau_count > 1 ? plan->tau_count - 1 : 1;
    html_begin_table(titles, COUNT_OF(titles), page->to);
    for (int tau = 0; tau < taus; tau++)
        for (int variant = 0; variant < plan->variant_count; variant++) {
            AccuracyCost cost = accuracy_cost_at(page->accuracy, dem, variant, plan->tau_px[tau]);
            html_begin_row(page->to);
            html_cell_text(plan->variants[variant].name, "", page->to);
            html_cell_number(plan->tau_px[tau], 2, page->to);
            html_cell_number(cost.frame_ms, 2, page->to);
            html_cell_number(cost.frame_least_ms, 2, page->to);
            html_cell_number(cost.frame_most_ms, 2, page->to);
            html_cell_number(cost.update_ms, 3, page->to);
            html_cell_number(cost.triangles, 0, page->to);
            html_cell_number(page->accuracy->dems[dem].begin_ms[variant], 1, page->to);
            html_end_row(page->to);
        }
    html_end_table(page->to);
}

// Of one kind of errors at one tolerance: the first method's run.
static void put_kind_row(const Page *page, int dem, int kind, int tau) {
    const AccuracyPlan *plan = &page->accuracy->plan;
    const AccuracyRun *run = accuracy_run_at(page->accuracy, dem, accuracy_variant_of_kind(plan, kind), tau);
    const double *build = page->accuracy->dems[dem].build_ms[kind];
    html_begin_row(page->to);
    html_cell_text(plan->kinds[kind].name, "", page->to);
    html_cell_number(plan->tau_px[tau], 2, page->to);
    html_cell_number(build[0], 1, page->to);
    html_cell_number(build[1], 1, page->to);
    html_cell_number(build[2], 1, page->to);
    html_cell_number(run->summary.triangles_mean, 0, page->to);
    html_cell_number(run->summary.frame_ms.p50, 2, page->to);
    html_cell_number(run->summary.max_px, 3, page->to);
    html_cell_number(run->summary.max_px / plan->tau_px[tau], 3, page->to);
    put_promise(run, page->to);
    html_end_row(page->to);
}

static void put_kinds(const Page *page, int dem) {
    static const char *const titles[] = {"<--error",  "tau px",       "build ms", "least",     "most",
                                         "triangles", "frame p50 ms", "max px",   "max / tau", "<promise"};
    if (accuracy_variant_of_kind(&page->accuracy->plan, 0) < 0) {
        html_element("p", "No method with nested errors was run; the others have errors of their own.", page->to);
        return;
    }
    html_begin_table(titles, COUNT_OF(titles), page->to);
    for (int kind = 0; kind < page->accuracy->plan.kind_count; kind++)
        for (int tau = 0; tau < page->accuracy->plan.tau_count; tau++)
            put_kind_row(page, dem, kind, tau);
    html_end_table(page->to);
}

static void put_hitch_row(const Page *page, const AccuracyHitch *hitch) {
    const AccuracyDem *dem = &page->accuracy->dems[hitch->run->dem];
    const AccuracyPose *pose = &dem->poses[hitch->pose];
    html_begin_row(page->to);
    html_cell_text(page->accuracy->plan.variants[hitch->run->variant].name, "", page->to);
    html_cell_number(hitch->run->tau_px, 2, page->to);
    html_cell_text(dem->tracks[pose->flight].name, "", page->to);
    html_cell_number(pose->number, 0, page->to);
    html_cell_number(hitch->ms, 2, page->to);
    html_cell_number(hitch->times, 2, page->to);
    html_cell_text(hitch->cause, "", page->to);
    html_end_row(page->to);
}

static void put_hitches(const Page *page, int dem) {
    static const char *const titles[] = {"<method", "tau px", "<flight", "frame", "ms", "times", "<cause"};
    AccuracyHitch hitches[ACCURACY_HITCHES_MAX];
    int found, count = accuracy_hitches(page->accuracy, dem, hitches, &found);
    fputs("<h3>Hitches</h3>\n<p class=\"dim\">", page->to);
    html_format(page->to,
                "Frames that took more than %g times what they take in other rounds, or what others of their run and "
                "flight take: %d; the worst:",
                ACCURACY_HITCH_TIMES, found);
    fputs("</p>\n", page->to);
    if (count == 0)
        return;
    html_begin_table(titles, COUNT_OF(titles), page->to);
    for (int i = 0; i < count; i++)
        put_hitch_row(page, &hitches[i]);
    html_end_table(page->to);
}

// ---- the DEMs ----

// What methods cost at the measured error that is shown.
typedef struct Costs {
    AccuracyCost of[ACCURACY_VARIANTS_MAX];
    bool promised[ACCURACY_VARIANTS_MAX];
    bool cheap[ACCURACY_VARIANTS_MAX]; // their rounds overlap with the cheapest one's: no difference beyond the spread
} Costs;

static void find_costs(const Page *page, int dem, Costs *out) {
    int tau = accuracy_tau_shown(page->accuracy);
    for (int i = 0; i < page->accuracy->plan.variant_count; i++) {
        out->of[i] = accuracy_cost_at(page->accuracy, dem, i, page->accuracy->plan.tau_px[tau]);
        out->promised[i] = accuracy_run_at(page->accuracy, dem, i, tau)->summary.promised;
    }
}

static bool is_compared(const Page *page, const Costs *costs, int variant) {
    return page->accuracy->plan.variants[variant].kind == 0 && isfinite(costs->of[variant].frame_ms);
}

// Of all, or of those that promise; how many there are.
static int find_cheap(const Page *page, Costs *costs, bool promised) {
    int count = 0, best = -1;
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < page->accuracy->plan.variant_count; i++) {
            const AccuracyCost *cost = &costs->of[i];
            bool counts = is_compared(page, costs, i) && (!promised || costs->promised[i]);
            if (pass == 0 && counts && (best < 0 || cost->frame_ms < costs->of[best].frame_ms))
                best = i;
            costs->cheap[i] = pass > 0 && counts && cost->frame_least_ms <= costs->of[best].frame_most_ms;
            count += costs->cheap[i];
        }
    return count;
}

static void put_cheap(const Page *page, const Costs *costs, const char *before) {
    const char *between = before;
    for (int i = 0; i < page->accuracy->plan.variant_count; i++)
        if (costs->cheap[i]) {
            html_format(page->to, "%s%s (%.1f to %.1f ms)", between, page->accuracy->plan.variants[i].name,
                        costs->of[i].frame_least_ms, costs->of[i].frame_most_ms);
            between = ", ";
        }
}

// Those whose line does not reach the error.
static void put_uncompared(const Page *page, const Costs *costs) {
    const char *between = "Not compared, as their measured errors do not reach from below it to above it: ";
    bool any = false;
    for (int i = 0; i < page->accuracy->plan.variant_count; i++)
        if (page->accuracy->plan.variants[i].kind == 0 && !is_compared(page, costs, i)) {
            html_format(page->to, "%s%s", between, page->accuracy->plan.variants[i].name);
            between = ", ";
            any = true;
        }
    fputs(any ? ". " : "", page->to);
}

// The cheapest of all; those of a promise by themselves only where they are others.
static void put_costs(const Page *page, int dem) {
    Costs all = {.cheap = {false}}, bound;
    find_costs(page, dem, &all);
    bound = all;
    int count = find_cheap(page, &all, false), bounds = find_cheap(page, &bound, true);
    bool same = count == bounds && memcmp(all.cheap, bound.cheap, sizeof all.cheap) == 0;
    if (count) {
        put_cheap(page, &all, "the cheapest frames, as far as the rounds tell, are those of ");
        fputs(same ? ", of which each promises its bound. " : ". ", page->to);
    } else {
        fputs("there is nothing to compare. ", page->to);
    }
    if (bounds && !same) {
        put_cheap(page, &bound, "Of those that promise their bound: ");
        fputs(". ", page->to);
    }
    put_uncompared(page, &all);
}

static void put_conclusion(const Page *page, int dem) {
    const AccuracyDem *d = &page->accuracy->dems[dem];
    double tau = page->accuracy->plan.tau_px[accuracy_tau_shown(page->accuracy)];
    fputs("<p>", page->to);
    html_format(page->to, "At a measured error of %g px ", tau);
    put_costs(page, dem);
    if (d->off_count || d->under_count)
        html_format(page->to, "%d of the %d eyes are not over the model, and %d are under its ground. ", d->off_count,
                    d->pose_count, d->under_count);
    fputs("</p>\n", page->to);
}

static Result put_plots(const Page *page, int first, int count) {
    Result result = RESULT_OK;
    for (int i = first; i < first + count && result == RESULT_OK; i++) {
        char name[ACCURACY_PLOT_BYTES];
        accuracy_plot_name(page->accuracy, i, name);
        result = put_picture(page, name, accuracy_plot_what(page->accuracy, i), "plot", NULL);
    }
    return result;
}

static Result put_dem(const Page *page, int dem) {
    const AccuracyDem *d = &page->accuracy->dems[dem];
    FILE *to = page->to;
    fprintf(to, "<h2 id=\"dem%d\">", dem + 1);
    html_format(to, "%s, %d x %d samples", d->name, d->width, d->height);
    fputs("</h2>\n", to);
    put_conclusion(page, dem);
    Result result = put_plots(page, dem * accuracy_plots_of_dem(), accuracy_plots_of_dem());
    fputs(
        "<h3>All runs</h3>\n<p class=\"dim\">Errors are of every sample in every frame. Times are of all frames in all "
        "rounds but the first of each burst, those of single stages the means of the rounds' medians; \"least\" and "
        "\"most round\" are the p50 of single rounds. The table scrolls sideways.</p>\n",
        to);
    put_runs(page, dem);
    fputs(
        "<h3>At equal measured error</h3>\n<p class=\"dim\">Between the two tolerances around it, on straight lines of "
        "logarithms; a dash where a method's line does not reach so far. \"Build\" is all that a method has ready "
        "before its first frame: the nested errors if it takes them, and what it makes by itself.</p>\n",
        to);
    put_equal(page, dem);
    fputs("<h3>The price of a true bound</h3>\n<p class=\"dim\">The first method with each kind of vertex errors: what "
          "building them takes, and what they give. \"total:N\" is exact up to a stride of N samples and bounded above "
          "it.</p>\n",
          to);
    put_kinds(page, dem);
    put_hitches(page, dem);
    return result;
}

// ---- the machine ----

static Result put_preprocessing(const Page *page) {
    static const char *const titles[] = {"<--error", "<scheme", "side", "threads",
                                         "ms",       "least",   "most", "ns a vertex"};
    const PreprocessBench *bench = &page->accuracy->scaling.preprocess;
    fputs(
        "<h2 id=\"preprocessing\">Preprocessing and workers</h2>\n<p>Building the nested vertex errors over synthetic "
        "rough ground, and refining from scratch with more workers.</p>\n",
        page->to);
    Result result = put_plots(page, accuracy_plot_count(page->accuracy) - 2, 2);
    html_begin_table(titles, COUNT_OF(titles), page->to);
    for (int i = 0; i < bench->run_count; i++) {
        const PreprocessRun *run = &bench->runs[i];
        double scale = (double)run->side * run->side * 1e-6;
        char kind[PREPROCESS_NAME_BYTES];
        html_begin_row(page->to);
        preprocess_kind_name(run, kind);
        html_cell_text(kind, "", page->to);
        html_cell_text(preprocess_scheme_name(run), "", page->to);
        html_cell_number(run->side, 0, page->to);
        html_cell_number(run->threads, 0, page->to);
        html_cell_number(scale * preprocess_median(bench, run), 2, page->to);
        html_cell_number(scale * run->ns_per_vertex[0], 2, page->to);
        html_cell_number(scale * run->ns_per_vertex[bench->rounds - 1], 2, page->to);
        html_cell_number(preprocess_median(bench, run), 2, page->to);
        html_end_row(page->to);
    }
    html_end_table(page->to);
    return result;
}

static void put_workers(const Page *page) {
    static const char *const titles[] = {"<method", "workers",       "ms a view", "least",
                                         "most",    "times as fast", "least",     "most"};
    const AccuracyScaling *scaling = &page->accuracy->scaling;
    html_begin_table(titles, COUNT_OF(titles), page->to);
    for (int i = 0; i < scaling->speed_count; i++) {
        const AccuracySpeed *speed = &scaling->speeds[i];
        html_begin_row(page->to);
        html_cell_text(lod_method_name(speed->method), "", page->to);
        html_cell_number(speed->threads, 0, page->to);
        html_cell_number(speed->ms / scaling->views, 3, page->to);
        html_cell_number(speed->least_ms / scaling->views, 3, page->to);
        html_cell_number(speed->most_ms / scaling->views, 3, page->to);
        html_cell_number(speed->speedup, 2, page->to);
        html_cell_number(speed->least_speedup, 2, page->to);
        html_cell_number(speed->most_speedup, 2, page->to);
        html_end_row(page->to);
    }
    html_end_table(page->to);
}

static void put_fact_text(const Page *page, const char *name, const char *text) {
    fputs("<tr><th scope=\"row\" class=\"text\">", page->to);
    html_text(name, page->to);
    fputs("</th><td>", page->to);
    html_text(text, page->to);
    fputs("</td></tr>\n", page->to);
}

static void put_fact(const Page *page, const char *name, const char *format, ...) PRINTF_LIKE(3, 4);
static void put_fact(const Page *page, const char *name, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    put_fact_text(page, name, text);
}

static void put_sources(const Page *page) {
    const Accuracy *accuracy = page->accuracy;
    for (int i = 0; i < accuracy->plan.dem_count; i++) {
        const AccuracyDem *dem = &accuracy->dems[i];
        put_fact(page, "elevation model", "%s, %d x %d, %.4g x %.4g m, heights above %s, hash %016" PRIx64, dem->name,
                 dem->width, dem->height, dem->spacing_m[0], dem->spacing_m[1], dem->datum, dem->hash);
        for (int k = 0; k < accuracy->plan.flight_count; k++)
            put_fact(page, "flight", "%s over it, %.0f s, hash %016" PRIx64, dem->tracks[k].name,
                     track_duration_s(&dem->tracks[k]), track_hash(&dem->tracks[k]));
    }
}

static void put_provenance(const Page *page) {
    const Accuracy *accuracy = page->accuracy;
    const AccuracyPlan *plan = &accuracy->plan;
    BenchMachine machine = bench_machine();
    char when[64] = "";
    time_t begin = (time_t)accuracy->unix_s;
    struct tm utc;
    if (gmtime_r(&begin, &utc))
        strftime(when, sizeof when, "%Y-%m-%d %H:%M:%S UTC", &utc);
    fputs("<h2 id=\"provenance\">Provenance</h2>\n<table class=\"facts\"><tbody>\n", page->to);
    put_fact(page, "program", "overfly %s, compiler %s%s", version_text(), machine.compiler,
             machine.optimized ? ", optimized" : ", NOT optimized");
    put_fact(page, "processor", "%s, %d processors, %d worker threads", machine.processor, machine.processors,
             accuracy->threads);
    put_fact(page, "GPU and driver", "%s%s", *accuracy->renderer ? accuracy->renderer : "nothing was drawn",
             accuracy->software ? " (a software renderer)" : "");
    put_fact(page, "system", "%s, %.1f GB of memory", accuracy->system, accuracy->memory_gb);
    put_fact_text(page, "options given", *accuracy->given ? accuracy->given : "none");
    put_fact(page, "begun", "%s, %.0f s long, load average before %.2f", when, accuracy->wall_s, accuracy->load);
    put_fact(page, "picture", "%d x %d pixels, %g degrees from bottom to top, %g pixels a radian %s", plan->width,
             plan->height, options_number(plan->options, OPTION_FOV), accuracy_px_per_rad(plan),
             scene_bound_corner(plan->options) ? "at its corners" : "at its centre");
    put_fact(page, "frames",
             "%d a flight, in bursts of %d at %g Hz; %d interleaved rounds; popping also in %d on end a flight%s",
             plan->frames, ACCURACY_BURST, ACCURACY_FRAME_HZ, plan->rounds, plan->stretch,
             plan->quick ? "; quick" : "");
    put_sources(page);
    fputs("</tbody></table>\n", page->to);
}

static void put_definitions(const Page *page) {
    fputs(
        "<h2 id=\"words\">What the columns mean</h2>\n"
        "<p>The error of a sample is lambda |P - Q| / |P - e|: P is the sample's exact place, Q the point of the drawn "
        "surface at the same column and row, e the eye, lambda the pixels a radian, as told above. It is taken "
        "at every sample of the elevation model, in view or not, by code that shares nothing with the refinement. "
        "A promise is broken when one sample of one frame is above what holds. Popping is the largest change of the "
        "surface, seen from the eye, from one frame to the next one, a sixtieth of a second later, in so many pairs of "
        "frames as are told beside it: of a longer flight it may be more. Cracks are "
        "T-junctions, holes and overlaps. Measuring runs in passes of its own over the same cuts, so that it does not "
        "disturb the times; an outline of each cut, the places, levels and numbers of triangles of its patches, tells "
        "whether they were the same. </p>\n<p>",
        page->to);
    put_unequal_cuts(page);
    fputs("Memory is what the process grew by while a run was refined and drawn, as the system tells. Negative results "
          "stay in.</p>\n",
          page->to);
}

static void put_contents(const Page *page) {
    fputs("<nav><a href=\"#worst\">The worst frame</a>", page->to);
    for (int i = 0; i < page->accuracy->plan.dem_count; i++) {
        fprintf(page->to, " \xC2\xB7 <a href=\"#dem%d\">", i + 1);
        html_text(page->accuracy->dems[i].name, page->to);
        fputs("</a>", page->to);
    }
    fputs(" \xC2\xB7 <a href=\"#preprocessing\">Preprocessing and workers</a> \xC2\xB7 <a "
          "href=\"#provenance\">Provenance</a>"
          " \xC2\xB7 <a href=\"#words\">What the columns mean</a></nav>\n",
          page->to);
}

Result accuracy_write_html(const Accuracy *accuracy, const char *folder, FILE *to) {
    const Page page = {accuracy, folder, to};
    fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
          "<link rel=\"icon\" href=\"data:,\">\n<title>Overfly: what accuracy costs in time</title>\n",
          to);
    Result result = put_asset("report/report.css", "style", "style", to);
    fputs("</head><body>\n<h1>What accuracy costs in time</h1>\n", to);
    put_contents(&page);
    put_verdict(&page);
    if (result == RESULT_OK)
        result = put_worst(&page);
    for (int dem = 0; dem < accuracy->plan.dem_count && result == RESULT_OK; dem++)
        result = put_dem(&page, dem);
    if (result == RESULT_OK)
        result = put_preprocessing(&page);
    put_workers(&page);
    put_provenance(&page);
    put_definitions(&page);
    if (result == RESULT_OK)
        result = put_asset("report/report.js", "script", "script", to);
    fputs("</body></html>\n", to);
    return result;
}
