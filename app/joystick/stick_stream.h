// app/joystick/stick_stream.h: the reports of a stick as they once came, from a file: a flight by somebody's hands.
// Seconds from the first step; the bytes are those of a HID device.
// A StickStream owns its reports; one thread.
#pragma once
#include "base/base.h"
#include "input/controls.h"

#define STICK_STREAM_REPORTS_MAX 1000000

// A text file of lines
//   device VENDOR:PRODUCT NAME     hexadecimal, as 046d:c215
//   descriptor BYTES               of the device's reports, hexadecimal with blanks; may come again, and goes on then
//   SECONDS BYTES                  a report and when it came; times do not go back
// and comments after '#'.
typedef struct StickStream StickStream;

// The device's profile is found as that of one that is plugged in; its calibration is not looked for. NOT_FOUND, IO,
// MEMORY; FORMAT names file and line; logged.
MUST_USE Result stick_stream_read(const char *path, StickStream **out);
void stick_stream_destroy(StickStream **stream);

// To the begin, with these controls; nothing has moved yet.
void stick_stream_begin(StickStream *stream, const Controls *controls);
// The controls for the next `dt_s`: what has come before acts.
Controls stick_stream_sample(StickStream *stream, double dt_s);
bool stick_stream_is_over(const StickStream *stream);
double stick_stream_duration_s(const StickStream *stream);
