// app/track/track_attitude.h: how an aircraft was turned, worked out from its path.
// Degrees, metres, seconds.
// Fills a Track its owner has not shared yet. Deterministic.
#pragma once
#include "app/track/track.h"

#define TRACK_WINDOW_S 2.0 // to each side: what is measured over at each point; at least to the neighbours
#define TRACK_SLOW_M_S 2.0 // below it the path says nothing: the heading is held, level and without bank
#define TRACK_GRAVITY_M_S2 9.80665

// For the points marked TRACK_DERIVED: heading of the path over ground; pitch its climb angle, as if there were no
// angle of attack; bank that of a coordinated turn, tan(bank) = V omega / g, with speed over ground, as if there were
// no wind. Windows never reach across a gap. MEMORY.
MUST_USE Result track_derive_attitude(Track *track);
