// render/craft/craft_shape.h: what an aircraft looks like, as numbers: sections, planforms, gear, paint.
// Body axes: x ahead, y right, z down; metres from the origin, which is about where the centre of gravity is.
// Constants; nothing owned. Parts whose `mirrored` is set are given for the right side and built on both.
#pragma once
#include "base/base.h"
#include "base/vec.h"

typedef enum CraftKind {
    CRAFT_C172,        // a light single with a high, strut-braced wing and fixed gear
    CRAFT_JET_TRAINER, // two seats behind each other, a low straight wing, tip tanks
    CRAFT_GLIDER,      // a long thin wing and a T-tail
    CRAFT_KIND_COUNT
} CraftKind;

// What a surface is made of: an index into CraftShape.finishes.
typedef enum CraftFinish {
    CRAFT_PAINT, // the aircraft's own colour
    CRAFT_TRIM,
    CRAFT_TRIM_2,
    CRAFT_GLASS,
    CRAFT_METAL,
    CRAFT_RUBBER,
    CRAFT_DARK, // inside of intakes and pipes
    CRAFT_LINE, // joints of panels
    CRAFT_BLADE,
    CRAFT_DISC, // a turning propeller, blurred: translucent
    CRAFT_FINISH_COUNT
} CraftFinish;

typedef struct CraftColour {
    float red, green, blue; // linear albedo
    float gloss;            // 0 dull .. 1 polished
} CraftColour;

// Where marks of paint go.
typedef enum CraftSurface {
    CRAFT_ON_BODY,
    CRAFT_ON_WING,
    CRAFT_ON_TAIL,
    CRAFT_ON_FIN,
    CRAFT_ON_PODS, // tanks, intakes, fairings
    CRAFT_ON_CANOPY,
    CRAFT_ON_REST,
    CRAFT_SURFACE_COUNT
} CraftSurface;

// A section of a wing, tail or fin.
typedef struct CraftStation {
    double across_m;  // from the plane of symmetry; of a fin: upwards from z = 0
    double x_m, z_m;  // leading edge; z_m is not used by a fin
    double chord_m;   // > 0
    double thickness; // share of the chord
    double twist_rad; // nose up, about the quarter chord
} CraftStation;

typedef enum CraftControlKind { CRAFT_AILERON, CRAFT_FLAP, CRAFT_ELEVATOR, CRAFT_RUDDER } CraftControlKind;

typedef struct CraftControl {
    CraftControlKind kind;
    double from_m, to_m; // along across_m, within the stations
} CraftControl;

enum { CRAFT_STATIONS_MAX = 6, CRAFT_CONTROLS_MAX = 2 };

// One half of a wing or tail, which is mirrored, or a fin. Sections are NACA's of four digits.
typedef struct CraftWing {
    int station_count;                         // 2 ..; 0: there is none
    CraftStation stations[CRAFT_STATIONS_MAX]; // from the root to the tip
    double camber, camber_at;                  // shares of the chord
    double hinge;                              // share of the chord
    double tip_m;                              // how far the rounding of the tip reaches beyond the last station
    int control_count;
    CraftControl controls[CRAFT_CONTROLS_MAX]; // from the root to the tip
} CraftWing;

// A section across a body: a superellipse above the middle and one below.
typedef struct CraftSection {
    double x_m, z_m;                   // middle
    double half_width_m, up_m, down_m; // all 0: a rounded end
    double square;                     // exponent: 2 an ellipse, more: fuller
} CraftSection;

enum { CRAFT_SECTIONS_MAX = 16 };

typedef struct CraftBody {
    int section_count;
    CraftSection sections[CRAFT_SECTIONS_MAX]; // from the front to the rear
    double y_m;                                // of the plane of symmetry
    bool mirrored;
    CraftFinish finish;
    CraftSurface surface;
    double front_tunnel_m, rear_tunnel_m; // depth of an opening; 0: closed
    bool turns;                           // with the propeller
} CraftBody;

typedef struct CraftStrut {
    Vec3d from, to;
    double chord_m, thickness_m; // along x and across
    bool mirrored;
    CraftFinish finish;
} CraftStrut;

// A leg with its wheel. Folding turns it about an axis through `pivot`.
typedef struct CraftLeg {
    Vec3d pivot, axle; // the leg goes from one to the other
    double leg_m;      // thickness
    double wheel_radius_m, wheel_width_m;
    bool mirrored;   // main wheels; else on the plane of symmetry
    Vec3d fold_axis; // unit; zero: fixed gear
    double fold_rad;
} CraftLeg;

typedef struct CraftPropeller {
    double diameter_m; // 0: none
    Vec3d hub;
    int blades;
    double chord_m, pitch_m; // at three quarters of the radius; advance per turn
} CraftPropeller;

// A painted figure: a quadrilateral in the side view (x, z) or the top view (x, |y|), rounded, filled or outlined.
typedef struct CraftMark {
    CraftSurface surface;
    bool from_above;
    CraftFinish finish;
    float corners[4][2]; // of a convex one, in either order; metres
    float round_m;       // grows the quadrilateral with rounded corners
    float line_m;        // 0: filled; else the outline's width
    float strength;      // 0 .. 1
} CraftMark;

enum { CRAFT_BODIES_MAX = 8, CRAFT_STRUTS_MAX = 4, CRAFT_LEGS_MAX = 3, CRAFT_MARKS_MAX = 32 };

typedef struct CraftShape {
    const char *name;
    double span_m, length_m; // of the whole aircraft, without propeller and probes
    CraftWing wing, tail, fin;
    int body_count;
    CraftBody bodies[CRAFT_BODIES_MAX]; // the first is the fuselage
    int strut_count;
    CraftStrut struts[CRAFT_STRUTS_MAX];
    int leg_count;
    CraftLeg legs[CRAFT_LEGS_MAX];
    CraftPropeller propeller;
    CraftColour finishes[CRAFT_FINISH_COUNT];
    int mark_count;
    CraftMark marks[CRAFT_MARKS_MAX]; // later ones over earlier ones
} CraftShape;

// Static. The dimensions' sources stand in craft_shape.c.
const CraftShape *craft_shape(CraftKind kind);

// No part is farther from the origin.
static inline double craft_shape_reach_m(const CraftShape *shape) {
    return 0.6 * (shape->span_m > shape->length_m ? shape->span_m : shape->length_m);
}
