// app/flight/runway.h: where near a place an aircraft can take off: the flattest stretch of ground, with room to climb.
// Radians, metres; slopes as metres a metre.
// Values; nothing is owned. The same ground gives the same stretch.
#pragma once
#include "app/dynamics/flight_model.h"

#define RUNWAY_SEARCH_M 8000.0 // from the place to the north, east, south and west, at most
#define RUNWAY_SLOPE 0.04      // steeper is not flat

typedef struct RunwayWish {
    double lat_rad, lon_rad; // near here
    double heading_rad;      // looked along first; with heading_given the only one
    bool heading_given;
    double length_m; // of the take-off run
} RunwayWish;

typedef struct Runway {
    double lat_rad, lon_rad, heading_rad; // where the run begins
    double slope;                         // of its steepest part, along or across
    double climb;                         // that the ground behind it asks for; 0: none
    bool level;                           // everywhere, as water is
    bool leaves;                          // the land ends behind it
} Runway;

// The run to lift off, and as much again for who pulls late; of gliders, which have no engine, a short one.
double runway_length_m(const Aircraft *aircraft, double h_m);
// The stretch with the least slope and climb behind it that a search finds, nearer ones before farther ones, land
// before water. RANGE: there is no ground so long; MEMORY. Says nothing. Asks for some 15,000 heights.
MUST_USE Result runway_find(const FlightGround *ground, const RunwayWish *wish, Runway *out);
