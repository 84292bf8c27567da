// app/recording/recording_player.h: any moment of a recorded flight, forwards and backwards.
// Steps count from the flight's begin; the position p is the moment before step p, after all earlier ones.
// A RecordingPlayer owns its cache and borrows reader and simulation, which must outlive it. One thread.
#pragma once
#include "app/recording/recording_replay.h"

typedef struct RecordingPlayer RecordingPlayer;

// At the flight's begin. UNSUPPORTED, FORMAT, IO, MEMORY as recording_verify.
MUST_USE Result recording_player_create(RecordingReader *reader, const RecordingSim *sim, RecordingPlayer **out);
void recording_player_destroy(RecordingPlayer **player);

// The simulation then holds the state at `step`, which is moved into the flight: from the nearest keyframe at or before
// it, at most 10 s re-simulated. The state of a position does not depend on the way there, and positions of the segment
// that were passed before, or of the one before that, come from memory. In a gap it is the last state known before.
// IO, FORMAT, MEMORY: logged; the position is as before, the simulation's state undefined until the next success.
MUST_USE Result recording_player_seek(RecordingPlayer *player, int64_t step);
uint32_t recording_player_position(const RecordingPlayer *player);
bool recording_player_is_in_gap(const RecordingPlayer *player); // show it: what is seen is older
// The smallest step among those simulated so far whose hash differed from the recorded one; -1: none.
int64_t recording_player_first_difference(const RecordingPlayer *player);
