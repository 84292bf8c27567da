#include "app/track/track_options.h"

#include "base/log.h"

TrackReading track_reading_of(const Options *options, const Geoid *geoid) {
    TrackReading how = track_reading_default();
    how.geoid = geoid;
    how.object = options_text(options, OPTION_OBJECT);
    if (options_is_set(options, OPTION_IGC_ALT))
        how.igc_alt = (TrackIgcAlt)options_choice(options, OPTION_IGC_ALT);
    return how;
}

static bool is_typed(const Options *options, OptionId id) {
    return options_source(options, id) == SOURCE_COMMAND_LINE;
}

void track_warn_of_unused(const Options *options, const char *path, const TrackFormat *format) {
    const char *what = format ? format->what : "recording";
    if (is_typed(options, OPTION_IGC_ALT) && !(format && format->has_pressure))
        log_warn("--igc-alt changes nothing: %s is %s, whose altitudes are of one kind", path, what);
    if (is_typed(options, OPTION_OBJECT) && !(format && format->has_objects))
        log_warn("--object changes nothing: %s is %s, which holds one flight", path, what);
}
