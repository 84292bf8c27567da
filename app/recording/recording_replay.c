#include "app/recording/recording_replay.h"

#include "base/clock.h"
#include "base/log.h"

#include <inttypes.h>

Result recording_sim_check(const RecordingReader *reader, const RecordingSim *sim) {
    const RecordingHeader *header = recording_reader_header(reader);
    if (header->state_bytes == sim->state_bytes && header->state_layout == sim->state_layout)
        return RESULT_OK;
    log_error("%s: states of %" PRIu32 " bytes, layout %" PRIu64 ", expected %" PRIu32 " bytes, layout %" PRIu64
              ": another flight model recorded it ('%s'); replay it with that program",
              recording_reader_path(reader), header->state_bytes, header->state_layout, sim->state_bytes,
              sim->state_layout, header->environment[RECORDING_PROGRAM]);
    return RESULT_UNSUPPORTED;
}

Result recording_run_begin(RecordingRun *run, const RecordingReader *reader, const RecordingChunk *chunk) {
    if (run->sim->load(run->sim->user, chunk->state)) {
        run->hash = chunk->hash_before;
        return RESULT_OK;
    }
    log_error("%s: the state before step %" PRIu32 " is none to fly on from; it was not recorded by this program",
              recording_reader_path(reader), chunk->first);
    return RESULT_FORMAT;
}

static void hand_events(const RecordingSim *sim, const RecordingChunk *chunk, uint32_t step) {
    for (int i = 0; sim->event && i < chunk->event_count; i++)
        if (chunk->events[i].step == step)
            sim->event(sim->user, &chunk->events[i]);
}

static void note_difference(RecordingRun *run, int64_t step) {
    if (run->first_difference < 0 || step < run->first_difference)
        run->first_difference = step;
}

void recording_run_step(RecordingRun *run, const RecordingChunk *chunk, int k) {
    const RecordingSim *sim = run->sim;
    uint32_t step = chunk->first + (uint32_t)k;
    Controls controls = recording_controls(chunk->codes[k]);
    hand_events(sim, chunk, step);
    sim->step(sim->user, &controls);
    run->hash = recording_hash_next(run->hash, sim->hash(sim->user));
    bool same = recording_hash_short(run->hash) == chunk->hashes[k];
    if (k == chunk->count - 1)
        same = same && run->hash == chunk->hash_after;
    if (!same)
        note_difference(run, step);
}

static Result verify_segment(RecordingReader *reader, const RecordingSegment *segment, RecordingRun *run,
                             RecordingVerdict *verdict) {
    for (int i = segment->chunk; i < segment->chunk_end; i++) {
        const RecordingChunk *chunk;
        Result result = recording_reader_chunk(reader, i, &chunk);
        if (result == RESULT_OK && i == segment->chunk && !segment->follows)
            result = recording_run_begin(run, reader, chunk);
        if (result != RESULT_OK)
            return result;
        for (int k = 0; k < chunk->count; k++)
            recording_run_step(run, chunk, k);
        verdict->steps += (uint32_t)chunk->count;
        verdict->expected_hash = chunk->hash_after;
    }
    return RESULT_OK;
}

Result recording_verify(RecordingReader *reader, const RecordingSim *sim, RecordingVerdict *out) {
    RecordingRun run = {.sim = sim, .first_difference = -1};
    RecordingVerdict verdict = {0};
    Result result = recording_sim_check(reader, sim);
    int count = recording_reader_segment_count(reader);
    Progress progress = progress_begin("replay");
    int64_t begin_ns = clock_now_ns();
    for (int i = 0; result == RESULT_OK && i < count; i++) {
        result = verify_segment(reader, recording_reader_segment(reader, i), &run, &verdict);
        progress_update(&progress, (double)(i + 1) / count);
    }
    progress_end(&progress);
    if (result != RESULT_OK)
        return result;
    double seconds = (double)(clock_now_ns() - begin_ns) * 1e-9;
    verdict.hash = run.hash;
    verdict.first_difference_step = run.first_difference;
    verdict.equal = run.first_difference < 0;
    verdict.steps_missing = recording_reader_end(reader) - recording_reader_first(reader) - verdict.steps;
    double flown_s = (double)verdict.steps / recording_reader_header(reader)->steps_per_s;
    verdict.realtime_factor = seconds > 0.0 ? flown_s / seconds : 0.0;
    *out = verdict;
    return RESULT_OK;
}
