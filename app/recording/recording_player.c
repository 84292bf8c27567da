#include "app/recording/recording_player.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

#define SLOTS 2               // to and fro over a border takes two
#define SLOT_BYTES (16 << 20) // of states; where a segment has more, not every step's is kept

// The states of a segment that were met so far: of steps first, first + stride, ...
typedef struct Slot {
    int segment; // -1: none
    uint32_t stride, count, room;
    uint8_t *states;
    uint64_t *hashes; // running
    int64_t used;
} Slot;

struct RecordingPlayer {
    RecordingReader *reader;
    RecordingSim sim;
    RecordingRun run;
    Slot slots[SLOTS];
    int64_t clock;
    uint32_t position;
    int at_segment;   // what the simulation holds: -1 nothing
    uint32_t at_step; // of it
};

static const RecordingSegment *segment_of(const RecordingPlayer *player, int index) {
    return recording_reader_segment(player->reader, index);
}

// ---- states kept ----

static uint32_t kept_step(const RecordingPlayer *player, const Slot *slot, uint32_t i) {
    return segment_of(player, slot->segment)->first + i * slot->stride;
}

static void keep_state(RecordingPlayer *player, Slot *slot) {
    if (slot->count == slot->room || player->at_step != kept_step(player, slot, slot->count))
        return;
    player->sim.save(player->sim.user, slot->states + (size_t)slot->count * player->sim.state_bytes);
    slot->hashes[slot->count++] = player->run.hash;
}

static Result load_kept(RecordingPlayer *player, const Slot *slot, uint32_t i) {
    if (!player->sim.load(player->sim.user, slot->states + (size_t)i * player->sim.state_bytes)) {
        log_error("%s: the simulation refuses a state that it had itself; is it complete?",
                  recording_reader_path(player->reader));
        return RESULT_FORMAT;
    }
    player->run.hash = slot->hashes[i];
    player->at_segment = slot->segment;
    player->at_step = kept_step(player, slot, i);
    return RESULT_OK;
}

static Result make_room(Slot *slot, uint32_t room, uint32_t state_bytes) {
    if (room > slot->room) {
        uint8_t *states = realloc(slot->states, (size_t)room * state_bytes);
        slot->states = states ? states : slot->states;
        uint64_t *hashes = realloc(slot->hashes, room * sizeof *hashes);
        slot->hashes = hashes ? hashes : slot->hashes;
        if (!states || !hashes) {
            log_error("no memory for %u states of the replay", room);
            return RESULT_MEMORY;
        }
        slot->room = room;
    }
    return RESULT_OK;
}

// Begins with the segment's keyframe.
static Result fill_slot(RecordingPlayer *player, Slot *slot, int index) {
    const RecordingSegment *segment = segment_of(player, index);
    const RecordingChunk *chunk;
    uint64_t positions = (uint64_t)(segment->known_end - segment->first) + 1;
    uint64_t kept = SLOT_BYTES / player->sim.state_bytes; // >= 256
    slot->segment = -1;
    slot->count = 0;
    slot->stride = (uint32_t)((positions + kept - 1) / kept);
    Result result = make_room(slot, (uint32_t)((positions + slot->stride - 1) / slot->stride), player->sim.state_bytes);
    if (result == RESULT_OK)
        result = recording_reader_chunk(player->reader, segment->chunk, &chunk);
    if (result == RESULT_OK)
        result = recording_run_begin(&player->run, player->reader, chunk);
    if (result != RESULT_OK)
        return result;
    slot->segment = player->at_segment = index;
    player->at_step = segment->first;
    keep_state(player, slot);
    return RESULT_OK;
}

static Result find_slot(RecordingPlayer *player, int segment, Slot **out) {
    Slot *oldest = &player->slots[0];
    for (int i = 0; i < SLOTS; i++) {
        Slot *slot = &player->slots[i];
        if (slot->used < oldest->used)
            oldest = slot;
        if (slot->segment != segment)
            continue;
        *out = slot;
        slot->used = ++player->clock;
        return RESULT_OK;
    }
    *out = oldest;
    oldest->used = ++player->clock;
    player->at_segment = -1;
    return fill_slot(player, oldest, segment);
}

// ---- moving ----

static Result simulate_until(RecordingPlayer *player, Slot *slot, uint32_t step) {
    while (player->at_step < step) {
        const RecordingChunk *chunk;
        int index = recording_reader_chunk_at(player->reader, player->at_step);
        Result result = recording_reader_chunk(player->reader, index, &chunk);
        if (result != RESULT_OK)
            return result;
        uint32_t end = chunk->first + (uint32_t)chunk->count;
        for (uint32_t until = step < end ? step : end; player->at_step < until;) {
            recording_run_step(&player->run, chunk, (int)(player->at_step - chunk->first));
            player->at_step++;
            keep_state(player, slot);
        }
    }
    return RESULT_OK;
}

// The steps that forward play leaves out when it takes the next segment's keyframe would not be compared.
static Result finish_segment(RecordingPlayer *player, int next) {
    if (player->at_segment < 0 || player->at_segment != next - 1 || !segment_of(player, next)->follows)
        return RESULT_OK;
    uint32_t end = segment_of(player, player->at_segment)->known_end;
    Slot *slot;
    if (end - player->at_step > RECORDING_STEPS_PER_S)
        return RESULT_OK;
    Result result = find_slot(player, player->at_segment, &slot);
    return result == RESULT_OK ? simulate_until(player, slot, end) : result;
}

// `step` is within the known steps of the segment.
static Result go(RecordingPlayer *player, int index, uint32_t step) {
    Slot *slot;
    Result result = finish_segment(player, index);
    if (result == RESULT_OK)
        result = find_slot(player, index, &slot);
    if (result != RESULT_OK)
        return result;
    uint32_t nearest = (step - segment_of(player, index)->first) / slot->stride;
    nearest = nearest < slot->count ? nearest : slot->count - 1;
    bool on_the_way =
        player->at_segment == index && player->at_step <= step && player->at_step >= kept_step(player, slot, nearest);
    if (!on_the_way)
        result = load_kept(player, slot, nearest);
    return result == RESULT_OK ? simulate_until(player, slot, step) : result;
}

Result recording_player_seek(RecordingPlayer *player, int64_t step) {
    uint32_t first = recording_reader_first(player->reader), end = recording_reader_end(player->reader);
    uint32_t wanted = step < first ? first : step > end ? end : (uint32_t)step;
    int index = recording_reader_segment_at(player->reader, wanted);
    uint32_t known_end = segment_of(player, index)->known_end;
    Result result = go(player, index, wanted < known_end ? wanted : known_end);
    if (result == RESULT_OK)
        player->position = wanted;
    else
        player->at_segment = -1;
    return result;
}

uint32_t recording_player_position(const RecordingPlayer *player) {
    return player->position;
}

bool recording_player_is_in_gap(const RecordingPlayer *player) {
    return player->position >
           segment_of(player, recording_reader_segment_at(player->reader, player->position))->known_end;
}

int64_t recording_player_first_difference(const RecordingPlayer *player) {
    return player->run.first_difference;
}

Result recording_player_create(RecordingReader *reader, const RecordingSim *sim, RecordingPlayer **out) {
    Result result = recording_sim_check(reader, sim);
    if (result != RESULT_OK)
        return result;
    RecordingPlayer *player = calloc(1, sizeof *player);
    if (!player)
        return RESULT_MEMORY;
    player->reader = reader;
    player->sim = *sim;
    player->run = (RecordingRun){.sim = &player->sim, .first_difference = -1};
    player->at_segment = -1;
    for (int i = 0; i < SLOTS; i++)
        player->slots[i].segment = -1;
    result = recording_player_seek(player, recording_reader_first(reader));
    if (result == RESULT_OK)
        *out = player;
    else
        recording_player_destroy(&player);
    return result;
}

void recording_player_destroy(RecordingPlayer **player) {
    if (!*player)
        return;
    for (int i = 0; i < SLOTS; i++) {
        free((*player)->slots[i].states);
        free((*player)->slots[i].hashes);
    }
    free(*player);
    *player = NULL;
}
