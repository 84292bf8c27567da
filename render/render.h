// render/render.h: draw frame packets of one terrain. Everything of GL is behind this header.
// ECEF metres in double; the camera frame is x right, y up, z backwards; pixels.
// A Renderer belongs to the thread that has the context current; it borrows the Terrain.
#pragma once
#include "base/base.h"
#include "base/vec.h"
#include "render/accuracy.h"
#include "render/craft/craft_model.h"
#include "terrain/lod/lod.h"
#include "terrain/terrain.h"

typedef enum RenderColouring {
    RENDER_COLOUR_LAND,  // height, slope, water, or the draped image
    RENDER_COLOUR_LEVEL, // by patch level
    RENDER_COLOUR_CACHE, // by cache state: reused, retriangulated, uploaded in this frame
    RENDER_COLOUR_PARTITION,
    RENDER_COLOURING_COUNT
} RenderColouring;

typedef struct RenderCamera {
    Vec3d eye_ecef;
    Mat3d camera_from_ecef; // rows: right, up, back
    double fov_y_rad;       // 1 .. 179 degrees
} RenderCamera;

// One row of the page of keys.
typedef struct RenderHelpRow {
    const char *keys, *meaning; // "PgUp", "more throttle"
} RenderHelpRow;

// What the HUD and the panel say. Text is UTF-8.
// Where a recorded flight is.
typedef struct RenderReplay {
    bool show;
    double t_s, duration_s;
    double rate; // below 0: backwards
    bool paused;
    bool in_gap;  // nothing is recorded of this time
    bool derived; // the attitude was worked out from the path
} RenderReplay;

#define RENDER_TRAIL_PLACES 602

// Of a way over the ground.
typedef struct RenderMapPlace {
    Vec3d ecef;
    bool apart; // no line leads here from the place before
    bool stop;  // to be marked
} RenderMapPlace;

// What is drawn over a view straight down.
typedef struct RenderMap {
    bool show;
    double ground_m;             // from the eye down to the ground, > 0: what the scale holds for
    const RenderMapPlace *route; // that is to be flown, or was recorded; constant, and lives as long as the renderer
    int route_count;
    int next; // of the route: the stop that is flown to; -1: none
    int trail_count;
    RenderMapPlace trail[RENDER_TRAIL_PLACES]; // flown, oldest first
} RenderMap;

typedef struct RenderHud {
    bool show_flight, show_numbers, show_help;
    double heading_rad, pitch_rad, bank_rad;
    double speed_m_s, altitude_m, above_ground_m, vertical_speed_m_s, throttle; // throttle 0..1
    Vec3d velocity_ecef;                                                        // m/s, for the flight path marker
    bool over_terrain;                                                          // above_ground_m is valid
    bool crashed, paused;
    double alpha_rad;   // angle of attack; NaN: not told
    bool stalls;        // or is about to
    bool no_engine;     // `throttle` is not told
    double flaps;       // 0 up .. 1 full
    bool gear_retracts; // `gear` is told
    double gear;        // 0 up .. 1 down and locked
    bool brakes, autopilot;
    double trim, rudder; // that the pilot holds, shares of full: + nose up, + nose right; 0: neutral, or not told
    const char *warning; // static, or NULL: none
    bool outside; // the camera is not on board: instead of the attitude the aircraft is marked where it is small, at
    Vec3d aircraft_ecef, nose_ecef, wing_ecef; // metres; unit, ahead; unit, to the right
    RenderMap map;
    bool show_names;               // where the picture is split and show_numbers is not set: the methods and their cuts
    const char *datum;             // of altitude_m: "EGM96"; static
    const char *method;            // lod_method_name of what made the cut; static, or NULL
    const char *right_method;      // of what made `right`, where the picture is split
    double frame_ms, frame_p99_ms; // of the last seconds, whole frames
    double target_ms;              // that the tolerance is moved to hold a frame to; 0: it is not
    bool target_out_of_reach;      // with no tolerance
    bool target_missed;            // with the one that was settled on
    const RenderHelpRow *help;     // the page of keys, help_count rows; static
    int help_count;
    const char *message; // one line for a few seconds, or NULL; lives as long as the packet
    RenderReplay replay;
    RenderAccuracy accuracy;
} RenderHud;

// An aircraft to be seen from outside, or by its shadow alone. Without either the rest is not looked at, and nothing is
// made for it.
typedef struct RenderCraft {
    bool show;
    bool casts; // its shadow lies on the ground, where that is near enough along the sun's rays
    CraftKind kind;
    Vec3d position_ecef;  // of the shape's origin, see render/craft/craft_shape.h
    Quatd ecef_from_body; // unit; body axes: x ahead, y right, z down
    CraftPose pose;
} RenderCraft;

// Immutable once handed over. Cuts and what they point to live until lod_release of their frames. Cuts in one renderer
// are of Lods with different LodOptions.serial.
typedef struct RenderPacket {
    LodCut cut;
    bool split; // `cut` on the left half of the picture, `right` on the right one, each as the camera sees it through a
                // viewport of half the width: the same vertical field of view, and the same scale
    LodCut right;
    RenderCamera camera;
    Vec3d sun_ecef; // unit vector towards the sun
    RenderColouring colouring;
    RenderCraft craft;
    bool wireframe;
    bool magenta_background; // for the pinhole test: the sky is one flat (255, 0, 255), one sample a pixel, and level,
                             // cache and partition colours are without light and air
    RenderHud hud;
} RenderPacket;

// Of a cut that the renderer made itself (LodCut.resident). Known at once on a software renderer and with
// RenderOptions.lockstep; else of the newest frame that has left the GPU.
typedef struct RenderResident {
    bool made;        // false: the cut was not resident
    bool refused;     // it could not be made, for want of memory on the GPU say; nothing is drawn, the log says why
    double create_ms; // what bringing its model to the GPU took, once
    int64_t triangles;
    double reached_px;                        // as LodCut has it; INFINITY: triangles are left out for lack of room
    double evaluate_ms, close_ms, indices_ms; // the phases of terrain/diamond
} RenderResident;
// The cut with what only the renderer knows: the numbers where it made it; that nothing is promised where it was not
// drawn whole.
void render_tell_cut(const RenderResident *resident, bool partial, LodCut *cut);

// Of one cut.
typedef struct RenderCutStats {
    int64_t draws, triangles_drawn, patches_drawn; // after view culling
    int64_t upload_bytes, evictions;
    double upload_ms, draw_ms; // draw_ms by glFinish and the clock on a software renderer, else timer queries
    bool partial; // it did not fit into the patch cache: its nearest patches were drawn, or an earlier cut's
    RenderResident resident;
} RenderCutStats;

typedef struct RenderStats {
    int64_t draws, triangles_drawn,
        patches_drawn; // after view culling; of a split picture the left half's, as all below
    int64_t upload_bytes, evictions;
    int64_t vram_bytes;        // in use in the patch cache, and by resident cuts
    double upload_ms, draw_ms; // draw_ms by glFinish and the clock on a software renderer, else timer queries. Of a
                               // whole picture with the head-up display, of half a picture without
    bool software, partial;
    RenderResident resident;
    RenderCutStats right; // zeros where the picture is not split
} RenderStats;

typedef struct RenderOptions {
    int width, height;       // pixels
    size_t vram_bytes_max;   // of the patch cache
    const char *image_path;  // draped image, or NULL
    bool image_bounds_given; // else the image's own georeference
    double image_west_deg, image_south_deg, image_east_deg, image_north_deg;
    bool measure_times; // true: finish each frame to time it
    bool lockstep;      // resident cuts keep the budget in each frame, not only in those that follow
    int samples;        // a pixel, 1 .. 16, against jagged edges; 0: 4 on hardware, 1 on a software renderer
} RenderOptions;
RenderOptions render_default_options(void);

typedef struct Renderer Renderer;
// With the context current. Takes about a second for 20 million samples. DEVICE: no framebuffer, no patch cache, or the
// shaders do not compile; NOT_FOUND: the shaders; MEMORY; for the draped image what render/ground/drape.h says.
MUST_USE Result render_create(const RenderOptions *options, const Terrain *terrain, Renderer **out);
void render_destroy(Renderer **renderer);
void render_resize(Renderer *renderer, int width, int height);

// Uploads what changed and draws to the current framebuffer of the context (window or offscreen). When the cut does not
// fit into vram_bytes_max, only what is in view is kept there, or else the last cut that fitted is drawn, with a
// warning. DEVICE: no framebuffer of the new size; MEMORY: the terrain is not drawn.
MUST_USE Result render_frame(Renderer *renderer, const RenderPacket *packet, RenderStats *stats);

// Drops what the patch cache holds, as if nothing had been drawn yet.
void render_forget_patches(Renderer *renderer);

// The columns of the left half of a split picture.
static inline int render_left_width(int width) {
    return width / 2;
}

// The finished picture, top row first, RGB, width * height * 3 bytes.
MUST_USE Result render_read_pixels(Renderer *renderer, uint8_t *rgb);
