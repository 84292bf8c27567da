#include "app/live/curve.h"

#include <math.h>
#include <stdlib.h>

#define BINS_AN_OCTAVE 3.0
#define BIN_LEAST_PX 0.01
#define WEIGHT_MOST 60.0 // frames that a bin remembers
#define WEIGHT_LEAST 4.0 // frames before it is shown
#define OUTLIER 3.0      // times the mean: a pause of the machine, not of the frame
#define CORRELATION 4.0  // neighbouring frames resemble each other: so many tell as much as one
#define TWO_SIGMA 2.0
#define APART 1.3        // times the triangles: a slope can be told from frames so far apart
#define KNOWN_WITHIN 0.5 // of what it may be at most: the width of what it may be, to be known

double curve_sample_tau(int index) {
    return CURVE_LEAST_PX * exp2(0.5 * index);
}

static int bin_of(double tau_px) {
    double place = floor(BINS_AN_OCTAVE * log2(tau_px / BIN_LEAST_PX) + 0.5);
    return (int)fmin(fmax(place, 0.0), CURVE_BINS - 1.0);
}

static double refine_ms_of(const PipelineFrame *frame) {
    return (double)frame->select_ms + (double)frame->refine_ms;
}

static double draw_ms_of(const PipelineFrame *frame) {
    return (double)frame->upload_ms + (double)frame->draw_ms;
}

static void blend(double *mean, double value, double share) {
    *mean += (value - *mean) * share;
}

static void add_to_bin(CurveBin *bin, const PipelineFrame *frame) {
    double triangles = (double)frame->triangles_drawn, draw_ms = draw_ms_of(frame);
    if (bin->weight >= WEIGHT_LEAST)
        draw_ms = fmin(draw_ms, OUTLIER * bin->draw_ms);
    bin->weight = fmin(bin->weight + 1.0, WEIGHT_MOST);
    double share = 1.0 / bin->weight;
    blend(&bin->log_tau, log(frame->tau_px), share);
    blend(&bin->refine_ms, refine_ms_of(frame), share);
    blend(&bin->triangles, triangles, share);
    blend(&bin->triangles2, triangles * triangles, share);
    blend(&bin->draw_ms, draw_ms, share);
    blend(&bin->draw2, draw_ms * draw_ms, share);
    blend(&bin->both, triangles * draw_ms, share);
    bin->seen_ns = frame->end_ns;
}

void curve_add_frame(Curve *curve, const PipelineFrame *frame) {
    if (frame->another || frame->px_per_rad != curve->last.px_per_rad)
        *curve = (Curve){0};
    curve->last = *frame;
    if (frame->disturbed) // something was made or written meanwhile: its times are not the tolerance's
        return;
    // A bin that was left long ago begins anew: the view has changed.
    CurveBin *bin = &curve->bins[bin_of(frame->tau_px)];
    if (frame->end_ns - bin->seen_ns > (int64_t)(CURVE_FRESH_S * 1e9))
        *bin = (CurveBin){0};
    add_to_bin(bin, frame);
}

static double freshness_of(int64_t then_ns, int64_t now_ns) {
    double age_s = (double)(now_ns - then_ns) * 1e-9;
    return fmin(fmax((CURVE_FORGOTTEN_S - age_s) / (CURVE_FORGOTTEN_S - CURVE_FRESH_S), 0.0), 1.0);
}

static bool is_shown(const CurveBin *bin, int64_t now_ns) {
    return bin->weight >= WEIGHT_LEAST && freshness_of(bin->seen_ns, now_ns) > 0.0;
}

// ---- what a triangle costs ----

typedef struct Moments {
    double weight, x, y, xx, yy, xy;
} Moments;

static Moments moments_of(const Curve *curve, int64_t now_ns) {
    Moments sum = {0};
    for (int i = 0; i < CURVE_BINS; i++) {
        const CurveBin *bin = &curve->bins[i];
        if (!is_shown(bin, now_ns))
            continue;
        double weight = bin->weight * freshness_of(bin->seen_ns, now_ns);
        sum.weight += weight;
        sum.x += weight * bin->triangles;
        sum.y += weight * bin->draw_ms;
        sum.xx += weight * bin->triangles2;
        sum.yy += weight * bin->draw2;
        sum.xy += weight * bin->both;
    }
    return sum;
}

// The line through all frames, with what nobody can doubt as the prior: a slope that is anywhere between nothing and
// proportion. Where the flight has seen one tolerance only, little more than that comes out.
static CurveSlope slope_of(const Moments *m, double most_ms) {
    double x = m->x / m->weight, y = m->y / m->weight;
    double sxx = m->xx - m->weight * x * x, sxy = m->xy - m->weight * x * y, syy = m->yy - m->weight * y * y;
    double prior = 0.5 * most_ms, prior_weight = 12.0 / (most_ms * most_ms); // of an even spread
    double slope = 0.0, weight = 0.0;
    if (sxx > 1e-9 * m->xx) {
        slope = sxy / sxx;
        double left = fmax(syy - slope * sxy, 1e-6 * m->yy);
        weight = m->weight * sxx / (CORRELATION * left);
    }
    double sigma = sqrt(1.0 / (prior_weight + weight));
    double best = (prior * prior_weight + slope * weight) / (prior_weight + weight);
    best = fmin(fmax(best, 0.0), most_ms);
    CurveSlope found = {best, fmax(best - TWO_SIGMA * sigma, 0.0), fmin(best + TWO_SIGMA * sigma, most_ms), false};
    found.known = found.most_ms - found.least_ms <= KNOWN_WITHIN * most_ms;
    return found;
}

static bool is_spread(const Curve *curve, int64_t now_ns) {
    double least = INFINITY, most = 0.0;
    for (int i = 0; i < CURVE_BINS; i++) {
        if (!is_shown(&curve->bins[i], now_ns))
            continue;
        least = fmin(least, curve->bins[i].triangles);
        most = fmax(most, curve->bins[i].triangles);
    }
    return most >= APART * least;
}

static const CurveBin *present_bin(const Curve *curve) {
    return curve->last.tau_px > 0.0 ? &curve->bins[bin_of(curve->last.tau_px)] : NULL;
}

CurveSlope curve_slope(const Curve *curve, int64_t now_ns) {
    const CurveBin *present = present_bin(curve);
    Moments moments = moments_of(curve, now_ns);
    if (!present || present->weight <= 0.0 || present->triangles <= 0.0 || present->draw_ms <= 0.0)
        return (CurveSlope){0};
    double most_ms = present->draw_ms / present->triangles;
    if (moments.weight <= 0.0)
        return (CurveSlope){0.5 * most_ms, 0.0, most_ms, false};
    CurveSlope slope = slope_of(&moments, most_ms);
    slope.known = slope.known && is_spread(curve, now_ns);
    return slope;
}

// ---- points ----

static RenderAccuracyPoint point_of_bin(const CurveBin *bin, int64_t now_ns) {
    float ms = (float)(bin->refine_ms + bin->draw_ms);
    return (RenderAccuracyPoint){(float)exp(bin->log_tau), ms, ms, ms, (float)freshness_of(bin->seen_ns, now_ns), true};
}

// What a sample would have been at the present tolerance, between those around it.
static double present_refine_ms(const Curve *curve, double tau_px) {
    const CurveSample *below = NULL, *above = NULL;
    for (int i = 0; i < CURVE_SAMPLES; i++) {
        const CurveSample *sample = &curve->samples[i];
        if (sample->tau_px > 0.0 && sample->tau_px <= tau_px)
            below = sample;
        if (sample->tau_px > tau_px && !above)
            above = sample;
    }
    if (!below || !above)
        return below ? below->refine_ms : above ? above->refine_ms : 0.0;
    double share = log(tau_px / below->tau_px) / log(above->tau_px / below->tau_px);
    return below->refine_ms + share * (above->refine_ms - below->refine_ms);
}

// From the present point on along the slope; the refinement of a frame that follows another one is in proportion to
// one from scratch.
static RenderAccuracyPoint point_of_sample(const Curve *curve, const CurveSample *sample, const CurveSlope *slope,
                                           int64_t now_ns) {
    const CurveBin *present = present_bin(curve);
    double scratch_ms = present_refine_ms(curve, curve->last.tau_px);
    double refine_ms = scratch_ms > 0.0 ? present->refine_ms * sample->refine_ms / scratch_ms : present->refine_ms;
    double more = sample->triangles - present->triangles, base_ms = refine_ms + present->draw_ms;
    double one_ms = base_ms + slope->least_ms * more, other_ms = base_ms + slope->most_ms * more;
    return (RenderAccuracyPoint){
        (float)sample->tau_px,         (float)(base_ms + slope->ms * more),          (float)fmin(one_ms, other_ms),
        (float)fmax(one_ms, other_ms), (float)freshness_of(sample->made_ns, now_ns), false};
}

static int compare_tau(const void *a, const void *b) {
    const RenderAccuracyPoint *p = a, *q = b;
    return (p->tau_px > q->tau_px) - (p->tau_px < q->tau_px);
}

int curve_points(const Curve *curve, int64_t now_ns, RenderAccuracyPoint out[RENDER_ACCURACY_POINTS]) {
    _Static_assert(CURVE_BINS + CURVE_SAMPLES <= RENDER_ACCURACY_POINTS, "all have room");
    const CurveBin *present = present_bin(curve);
    CurveSlope slope = curve_slope(curve, now_ns);
    int count = 0;
    for (int i = 0; i < CURVE_BINS; i++)
        if (is_shown(&curve->bins[i], now_ns))
            out[count++] = point_of_bin(&curve->bins[i], now_ns);
    for (int i = 0; present && present->weight > 0.0 && i < CURVE_SAMPLES; i++)
        if (curve->samples[i].tau_px > 0.0 && freshness_of(curve->samples[i].made_ns, now_ns) > 0.0)
            out[count++] = point_of_sample(curve, &curve->samples[i], &slope, now_ns);
    qsort(out, (size_t)count, sizeof *out, compare_tau);
    return count;
}
