// config/option_table.h: every option of every subcommand, one row each. Nothing else knows names, defaults or ranges.
// Units: see OptionType in config/options.h; ranges hold in the type's own unit.
// Included by config/options.h and config/options.c only.
#pragma once

#define COMMANDS_FLOWN (COMMAND_FLY | COMMAND_DEMO)
#define COMMANDS_FLIGHT (COMMANDS_FLOWN | COMMAND_REPLAY)
#define COMMANDS_SCENE (COMMANDS_FLIGHT | COMMAND_SNAPSHOT | COMMAND_MESH | COMMAND_BENCH)
#define COMMANDS_VIEW (COMMANDS_FLIGHT | COMMAND_SNAPSHOT | COMMAND_MESH)
#define COMMANDS_WORK (COMMANDS_SCENE | COMMAND_REPRODUCE)
#define COMMANDS_LAND (COMMANDS_WORK | COMMAND_INFO | COMMAND_CONVERT)
#define COMMANDS_PICTURE (COMMANDS_FLIGHT | COMMAND_SNAPSHOT)

#define CHOICES_DATUM "file|egm96|ellipsoid"
#define CHOICES_VOIDS "fill|hole|error"
#define CHOICES_ERROR "midpoint|total|total:N"
#define CHOICES_PATCH_SIDE "3|5|9|17|33|65|129"
#define CHOICES_METHOD "hybrid|patch|roam|roam-parallel|geomipmap|geomipmap-ye|diamond|brute"
#define CHOICES_BOUND "published|centre|corner"
#define CHOICES_TILE_SIDE "3|5|9|17|33|65|129"
#define CHOICES_COMPUTE "auto|gpu|cpu"
#define CHOICES_TIME_RATE "1/4|1/2|1|2|4|8|16"
#define CHOICES_REPLAY_RATE "1/8|1/4|1/2|1|2|4|8|16|32|64"
#define CHOICES_VIEW "cockpit|chase|fly-by|map|free|right|back|left|down"
#define CHOICES_IGC_ALT "pressure|ellipsoid|geoid"
#define CHOICES_COLOUR "land|level|cache|partition"

// clang-format off
// X(identifier, name, short name or 0, type, argument, default or NULL, least, greatest, choices, subcommands, help)
// Least and greatest of several numbers hold for each of them; both 0: the type's own range.
#define OPTION_TABLE(X)                                                                                                \
    X(HELP, "help", 'h', FLAG, NULL, "false", 0, 0, NULL, COMMANDS_ALL, "print this help and leave")                   \
    X(VERSION, "version", 'V', FLAG, NULL, "false", 0, 0, NULL, COMMANDS_ALL, "print the version and leave")           \
    X(QUIET, "quiet", 'q', FLAG, NULL, "false", 0, 0, NULL, COMMANDS_ALL, "errors only")                               \
    X(VERBOSE, "verbose", 'v', FLAG, NULL, "false", 0, 0, NULL, COMMANDS_ALL, "messages for developers too")           \
    X(JSON, "json", 0, FLAG, NULL, "false", 0, 0, NULL, COMMANDS_ALL, "one JSON document on stdout")                   \
    X(THREADS, "threads", 'j', INTEGER, "N", "0", 0, 64, NULL, COMMANDS_WORK, "worker threads; 0: one per processor")  \
                                                                                                                       \
    X(DATUM, "datum", 0, CHOICE, NULL, "file", 0, 0, CHOICES_DATUM, COMMANDS_LAND, "what heights are measured from")   \
    X(VOIDS, "voids", 0, CHOICE, NULL, "fill", 0, 0, CHOICES_VOIDS, COMMANDS_LAND, "what samples without data become") \
    X(SPACING, "spacing", 0, LENGTH, "LENGTH", NULL, 1e-3, 1e6, NULL, COMMANDS_LAND,                                   \
      "between samples, for images without georeference")                                                              \
    X(BOUNDS, "bounds", 0, BOUNDS, "W,S,E,N", NULL, 0, 0, NULL, COMMANDS_LAND,                                         \
      "degrees, for images without georeference")                                                                      \
    X(GEOID, "geoid", 0, PATH, "FILE", NULL, 0, 0, NULL, COMMANDS_WORK | COMMAND_CONVERT,                              \
      "EGM96 grid (.pgm) instead of the own one")                                                                      \
    X(ERROR, "error", 0, CHOICE, NULL, "total", 1, 1024, CHOICES_ERROR, COMMANDS_SCENE,                                \
      "how vertex errors are defined; only total bounds the error at every sample; total:N looks at the samples of "   \
      "diamonds up to a step of N, and bounds larger ones")                                                            \
    X(PATCH_SIDE, "patch-side", 0, CHOICE, NULL, "65", 0, 0, CHOICES_PATCH_SIDE, COMMANDS_SCENE, "samples a page side")\
                                                                                                                       \
    X(METHOD, "method", 'm', CHOICE, NULL, "hybrid", 0, 0, CHOICES_METHOD, COMMANDS_SCENE, "level-of-detail method")   \
    X(TAU, "tau", 't', NUMBER, "PX", "1", 0.01, 1000, NULL, COMMANDS_VIEW, "tolerated error at the image centre")      \
    X(BENCH_TAU, "tau", 't', TEXT, "LIST", NULL, 0, 0, NULL, COMMAND_BENCH,                                            \
      "tolerated errors at the image centre, pixels: 0.5,1,2,4 if not given; 1 for one benchmark")                     \
    X(PARTITIONS, "partitions", 0, INTEGER, "N", "0", 0, 64, NULL, COMMANDS_SCENE,                                     \
      "hybrid, roam-parallel: sectors along the observer line; 0: 1 for one worker, else 2 a worker")                  \
    X(BOUND, "bound", 0, CHOICE, NULL, "published", 0, 0, CHOICES_BOUND, COMMANDS_SCENE,                               \
      "which error is kept: the method's own, or tau at every sample at the image's centre, or its corners")           \
    X(TILE_SIDE, "tile-side", 0, CHOICE, NULL, "33", 0, 0, CHOICES_TILE_SIDE, COMMANDS_SCENE,                          \
      "samples a tile side of geomipmap and geomipmap-ye")                                                             \
    X(UNIT, "unit", 0, LENGTH, "LENGTH", "1", 1e-6, 1e6, NULL, COMMANDS_SCENE,                                         \
      "geomipmap-ye: the unit of length whose square its level rule takes")                                            \
    X(COMPUTE, "compute", 0, CHOICE, NULL, "auto", 0, 0, CHOICES_COMPUTE, COMMANDS_PICTURE,                            \
      "where diamond works; auto: on the GPU, but not with a software renderer")                                       \
    X(COMPARE, "compare", 0, CHOICE, NULL, NULL, 0, 0, CHOICES_METHOD, COMMANDS_PICTURE,                               \
      "a second method, on the right half of the picture")                                                             \
    X(SELECT, "select", 0, TEXT, "EXPRESSION", NULL, 0, 0, NULL, COMMAND_MESH,                                         \
      "diamond: what to refine, as 'error > 5 || within(36.6, -84.2, 2000)'")                                          \
    X(MAX_TRIANGLES, "max-triangles", 0, INTEGER, "N", "16000000", 1000, 2000000000, NULL, COMMANDS_SCENE,             \
      "above it the tolerance is raised; a flight refuses brute")                                                      \
    X(REUSE, "reuse", 0, FLAG, NULL, "true", 0, 0, NULL, COMMANDS_SCENE, "keep triangulations from frame to frame")    \
                                                                                                                       \
    X(SIZE, "size", 's', SIZE, "WxH", "1280x800", 16, 16384, NULL, COMMANDS_SCENE, "picture or window, pixels")        \
    X(FOV, "fov", 0, ANGLE, "ANGLE", "60", 1, 179, NULL, COMMANDS_SCENE, "vertical field of view")                     \
    X(EYE, "eye", 0, POSITION, "LAT,LON,ALT", NULL, 0, 0, NULL, COMMANDS_SCENE,                                        \
      "degrees, and metres above the geoid (500m, 5000ft)")                                                            \
    X(LOOK, "look", 0, DIRECTION, "HEADING,PITCH", NULL, 0, 0, NULL, COMMANDS_SCENE, "degrees; north is 0, up is +")   \
    X(OUTPUT, "output", 'o', PATH, "FILE", NULL, 0, 0, NULL, COMMAND_SNAPSHOT | COMMAND_MESH, "where to write")        \
                                                                                                                       \
    X(VIEW, "view", 0, CHOICE, NULL, "cockpit", 0, 0, CHOICES_VIEW, COMMANDS_FLIGHT, "where the flight is seen from")  \
    X(COLOUR, "colour", 'c', CHOICE, NULL, "land", 0, 0, CHOICES_COLOUR, COMMANDS_PICTURE, "what colours mean")        \
    X(WIREFRAME, "wireframe", 'w', FLAG, NULL, "false", 0, 0, NULL, COMMANDS_PICTURE, "draw the triangles' edges")     \
    X(MAGENTA, "magenta", 0, FLAG, NULL, "false", 0, 0, NULL, COMMANDS_PICTURE, "a magenta sky, to count pinholes")    \
    X(SUN, "sun", 0, DIRECTION, "AZIMUTH,HEIGHT", "300,35", 0, 0, NULL, COMMANDS_PICTURE, "where the sun is, degrees") \
    X(IMAGE, "image", 0, PATH, "FILE", NULL, 0, 0, NULL, COMMANDS_PICTURE, "picture draped over the terrain")          \
    X(IMAGE_BOUNDS, "image-bounds", 0, BOUNDS, "W,S,E,N", NULL, 0, 0, NULL, COMMANDS_PICTURE,                          \
      "degrees, for pictures without georeference")                                                                    \
    X(SAMPLES, "samples", 0, INTEGER, "N", "0", 0, 16, NULL, COMMANDS_PICTURE,                                         \
      "a pixel, against jagged edges; 0: 4, but 1 flying with a software renderer")                                    \
    X(VRAM, "vram", 0, BYTES, "BYTES", "256M", 1048576, 1e12, NULL, COMMANDS_PICTURE, "limit of the patch cache")      \
    X(HUD, "hud", 0, FLAG, NULL, "true", 0, 0, NULL, COMMANDS_FLIGHT, "draw the flight instruments and numbers")       \
    X(ACCURACY, "accuracy", 0, FLAG, NULL, "false", 0, 0, NULL, COMMANDS_FLIGHT,                                       \
      "begin with the panel of frame time against accuracy (F2)")                                                      \
    X(DEBUG_GL, "debug-gl", 0, FLAG, NULL, "false", 0, 0, NULL, COMMANDS_PICTURE, "log what the GL driver reports")    \
                                                                                                                       \
    X(WINDOW, "window", 0, FLAG, NULL, "true", 0, 0, NULL, COMMANDS_FLIGHT, "fly in a window; without: by EGL")        \
    X(FULLSCREEN, "fullscreen", 'f', FLAG, NULL, "false", 0, 0, NULL, COMMANDS_FLIGHT, "the whole screen")             \
    X(FPS, "fps", 0, NUMBER, "HZ", "60", 1, 1000, NULL, COMMANDS_FLIGHT, "frames a second at most")                    \
    X(TARGET_MS, "target-ms", 0, NUMBER, "MS", NULL, 1, 1000, NULL, COMMANDS_FLIGHT | COMMAND_BENCH,                   \
      "move the tolerated error, from --tau, so that 95 of 100 frames take at most so long")                           \
    X(FRAMES, "frames", 'n', INTEGER, "N", "0", 0, 1000000000, NULL, COMMANDS_FLIGHT | COMMAND_BENCH,                  \
      "leave after N frames, or measure so many; 0: when told to, or a measurement's own number")                      \
    X(LOCKSTEP, "lockstep", 0, FLAG, NULL, "false", 0, 0, NULL, COMMANDS_FLIGHT,                                       \
      "stages one after another, 1/60 s a frame: the same pictures each time")                                         \
    X(TELEMETRY, "telemetry", 0, PATH, "FILE", NULL, 0, 0, NULL, COMMANDS_FLIGHT,                                      \
      "a line of CSV ten times a second of flight, for scripts; -: on stdout")                                         \
    X(RECORD, "record", 0, PATH, "FILE", NULL, 0, 0, NULL, COMMANDS_FLIGHT,                                            \
      "record the flight as it goes (.ofr); without: the last ten minutes are kept, and F5 saves them")                \
    X(JOYSTICK, "joystick", 0, FLAG, NULL, "true", 0, 0, NULL, COMMANDS_FLIGHT, "look for sticks and gamepads")        \
    X(DEMO, "demo", 0, FLAG, NULL, "false", 0, 0, NULL, COMMAND_FLY, "fly the scene's demonstration")                  \
    X(KIOSK, "kiosk", 0, FLAG, NULL, "false", 0, 0, NULL, COMMAND_DEMO,                                                \
      "for a stand: the demo begins again at its end, on Esc, and when nobody steers for --idle")                      \
    X(IDLE, "idle", 0, NUMBER, "S", "45", 1, 86400, NULL, COMMAND_DEMO,                                                \
      "with --kiosk: seconds until the demo begins again")                                                             \
    X(AIRCRAFT, "aircraft", 0, TEXT, "NAME|FILE", "t37", 0, 0, NULL, COMMANDS_FLIGHT | COMMAND_CONVERT,                \
      "what is flown: one that 'overfly aircraft' lists, or an aircraft file; replaying: instead of what was recorded")\
    X(TRIM, "trim", 0, FLAG, NULL, "true", 0, 0, NULL, COMMANDS_FLOWN, "start in steady flight")                       \
    X(ON_GROUND, "on-ground", 0, FLAG, NULL, "false", 0, 0, NULL, COMMANDS_FLOWN,                                      \
      "start standing on flat ground near the start, or where --eye says")                                             \
    X(ASSIST, "assist", 0, FLAG, NULL, "true", 0, 0, NULL, COMMANDS_FLOWN,                                             \
      "keys ask for rates of pitch and roll, and the path stays when let go; without: they move the surfaces")         \
    X(TIME_RATE, "time-rate", 0, CHOICE, NULL, "1", 0, 0, CHOICES_TIME_RATE, COMMANDS_FLOWN,                           \
      "how fast time runs at the start")                                                                               \
    X(SPEED, "speed", 0, SPEED, "SPEED", NULL, 0, 20000, NULL, COMMANDS_FLOWN | COMMAND_BENCH,                         \
      "at the start (80m/s, 120kt); measuring: 100m/s if not given")                                                   \
    X(HEIGHT, "height", 0, LENGTH, "LENGTH", "500", 1, 1e7, NULL, COMMAND_BENCH, "of the flight above the ground")     \
    X(SIDES, "sides", 0, TEXT, "LIST", "1025,2049,4097", 0, 0, NULL, COMMAND_BENCH, "samples a side to preprocess")    \
    X(VERTICES, "vertices", 0, INTEGER, "N", "100000", 10, 100000000, NULL, COMMAND_BENCH,                             \
      "partitions: refine for so many, unless --tau is given")                                                         \
    X(ROUNDS, "rounds", 0, INTEGER, "N", "5", 1, 1000, NULL, COMMAND_BENCH,                                            \
      "of each measurement, interleaved; panel: 240 if not given, 5 at least")                                         \
    X(METHODS, "methods", 0, TEXT, "LIST", NULL, 0, 0, NULL, COMMAND_BENCH,                                            \
      "to set against each other, separated by commas; NAME:centre keeps tau at every sample")                         \
    X(ERRORS, "errors", 0, TEXT, "LIST", NULL, 0, 0, NULL, COMMAND_BENCH,                                              \
      "kinds of --error that the first method is run with as well: midpoint,total:8,total if not given")               \
    X(TRACK, "track", 0, TEXT, "LIST", NULL, 0, 0, NULL, COMMAND_BENCH,                                                \
      "flights: valley,ridge,pass,dive,turn, or files of them, as 'overfly convert' reads")                            \
    X(BENCH_QUICK, "quick", 0, FLAG, NULL, "false", 0, 0, NULL, COMMAND_BENCH,                                         \
      "a minute or so: fewer methods, tolerances and frames, a smaller picture")                                       \
    X(SCREENSHOT, "screenshot", 0, PATH, "FILE", NULL, 0, 0, NULL, COMMANDS_FLIGHT, "write the last frame as PNG")     \
    X(PICTURES, "pictures", 0, PATH, "DIR", NULL, 0, 0, NULL, COMMANDS_FLIGHT, "write pictures of the flight as PNG")  \
    X(PICTURE_COUNT, "picture-count", 0, INTEGER, "N", "6", 1, 100000, NULL, COMMANDS_FLIGHT,                          \
      "how many, spread over the flight")                                                                              \
    X(EVERY, "every", 0, INTEGER, "N", NULL, 1, 1000000000, NULL, COMMAND_REPLAY,                                      \
      "with --pictures: every Nth frame of the replay, instead of --picture-count")                                    \
    X(VIDEO, "video", 0, PATH, "FILE", NULL, 0, 0, NULL, COMMAND_REPLAY,                                               \
      "a film of the replay, by ffmpeg: frame i at i / --fps seconds; .mp4, .mkv, .webm or .mov")                      \
    X(VERIFY, "verify", 0, FLAG, NULL, "false", 0, 0, NULL, COMMAND_REPLAY,                                            \
      "fly a recording again without drawing, and tell whether it is the same flight, step by step")                   \
    X(AT, "at", 0, TEXT, "TIME", NULL, 0, 0, NULL, COMMAND_REPLAY, "where to begin: seconds, M:SS or H:MM:SS")         \
    X(REPLAY_RATE, "time-rate", 0, CHOICE, NULL, "1", 0, 0, CHOICES_REPLAY_RATE, COMMAND_REPLAY,                       \
      "how fast time runs at the start")                                                                               \
    X(BACKWARDS, "backwards", 0, FLAG, NULL, "false", 0, 0, NULL, COMMAND_REPLAY,                                      \
      "begin at the end, or at --at, and go backwards")                                                                \
                                                                                                                       \
    X(QUICK, "quick", 0, FLAG, NULL, "false", 0, 0, NULL, COMMAND_REPRODUCE,                                           \
      "a minute at most: fewer sizes, frames and rounds, nothing drawn")                                               \
    X(OUTPUT_FOLDER, "output", 'o', PATH, "DIR", NULL, 0, 0, NULL, COMMAND_REPRODUCE,                                  \
      "a folder for the tables as Markdown, JSON and CSV, instead of stdout")                                          \
    X(REPORT_FOLDER, "output", 'o', PATH, "DIR", NULL, 0, 0, NULL, COMMAND_BENCH,                                      \
      "a folder for the report: report.html, CSV and JSON files, plots")                                               \
    X(REPRODUCE_SIDES, "sides", 0, TEXT, "LIST", NULL, 0, 0, NULL, COMMAND_REPRODUCE,                                  \
      "samples a side (2^n + 1, separated by commas) instead of the paper's")                                          \
    X(SECONDS, "seconds", 0, NUMBER, "S", NULL, 0.1, 3600, NULL, COMMAND_REPRODUCE,                                    \
      "length of the flights instead of the experiment's own")                                                         \
                                                                                                                       \
    X(IGC_ALT, "igc-alt", 0, CHOICE, NULL, NULL, 0, 0, CHOICES_IGC_ALT, COMMAND_CONVERT | COMMAND_REPLAY,              \
      "altitudes of an IGC file: its pressure column as it is, or its GNSS column above the ellipsoid (if not given) " \
      "or the geoid where HFALG does not say")                                                                         \
    X(OBJECT, "object", 0, TEXT, "NAME", NULL, 0, 0, NULL, COMMAND_CONVERT | COMMAND_REPLAY,                           \
      "which track of several: its name, or its number; of ACMI its id")                                               \
    X(INTERVAL, "interval", 0, NUMBER, "S", NULL, 0.01, 3600, NULL, COMMAND_CONVERT,                                   \
      "between the points that are written; if not given, those of the file, and of a recording (.ofr) 0.5, for IGC 1")\
    X(START, "start", 0, TEXT, "TIME", NULL, 0, 0, NULL, COMMAND_CONVERT,                                              \
      "when the flight began, as 2024-06-01T12:00:00Z, instead of what the file says")                                 \
                                                                                                                       \
    X(WATCH, "watch", 'w', FLAG, NULL, "false", 0, 0, NULL, COMMAND_DEVICES, "show live values until Ctrl-C")          \
    X(CALIBRATE, "calibrate", 0, FLAG, NULL, "false", 0, 0, NULL, COMMAND_DEVICES,                                     \
      "learn where sticks and levers rest and end, and keep it")                                                       \
    X(WATCH_SECONDS, "seconds", 0, NUMBER, "S", NULL, 0.1, 86400, NULL, COMMAND_DEVICES,                               \
      "watch for so long; calibrate for so long at most (default 60)")                                                 \
                                                                                                                       \
    X(CULL, "cull", 0, FLAG, NULL, "false", 0, 0, NULL, COMMAND_MESH, "only what the view frustum holds")
// clang-format on
