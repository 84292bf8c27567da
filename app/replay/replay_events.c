#include "app/replay/replay_events.h"

#include "app/recording/recording_bytes.h"
#include "base/rate.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PRINTED_MOST 12

Result replay_events_read(Playback *playback, ReplayEvents *out) {
    const RecordingHeader *header = playback_header(playback);
    *out = (ReplayEvents){.first_step = playback_first_step(playback), .steps_per_s = header ? header->steps_per_s : 1};
    return header ? playback_events(playback, &out->events, &out->count) : RESULT_OK;
}

void replay_events_clear(ReplayEvents *events) {
    free(events->events);
    *events = (ReplayEvents){0};
}

// Steps from the begin; the first chunk may tell what was before it.
static uint32_t steps_until(const ReplayEvents *events, const RecordingEvent *event) {
    return event->step > events->first_step ? event->step - events->first_step : 0;
}

static bool read_rate(const RecordingEvent *event, double *rate) {
    if (event->kind != RECORDING_EVENT_TIME_RATE || event->bytes != sizeof *rate)
        return false;
    uint64_t bits = recording_get64(event->data);
    memcpy(rate, &bits, sizeof *rate);
    return true;
}

void replay_events_add(const ReplayEvents *events, Json *parent) {
    Json *array = json_add_array(parent, "events");
    double rate;
    for (int i = 0; i < events->count; i++) {
        const RecordingEvent *event = &events->events[i];
        Json *object = json_append_object(array);
        json_add_integer(object, "step", event->step);
        json_add_number(object, "t_s", (double)steps_until(events, event) / events->steps_per_s);
        json_add_text(object, "event", recording_event_name(event->kind));
        if (read_rate(event, &rate))
            json_add_number(object, "rate", rate);
    }
}

void replay_events_print(const ReplayEvents *events, const char *label) {
    char when[RECORDING_TIME_BYTES], text[RATE_BYTES];
    double rate;
    for (int i = 0; i < events->count && i < PRINTED_MOST; i++) {
        const RecordingEvent *event = &events->events[i];
        printf("%s%s %s", i == 0 ? label : ", ",
               recording_time_text(steps_until(events, event), events->steps_per_s, when),
               recording_event_name(event->kind));
        if (read_rate(event, &rate)) {
            rate_write(rate, text);
            printf(" %s", text);
        }
    }
    if (events->count > PRINTED_MOST)
        printf(", and %d more (--json has all)", events->count - PRINTED_MOST);
    if (events->count > 0)
        printf("\n");
}
