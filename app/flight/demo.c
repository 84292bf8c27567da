#define _POSIX_C_SOURCE 200809L
#include "app/flight/demo.h"

#include "base/log.h"
#include "config/quantity.h"
#include "terrain/geodesy.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define LINE_BYTES 512
#define CLEARANCE_M 120.0
#define ROUND_POINTS 8
#define ROUND_SPEED 110.0

static bool parse_place(const char *text, const Geoid *geoid, Waypoint *out) {
    static const QuantityKind kinds[3] = {QUANTITY_ANGLE, QUANTITY_ANGLE, QUANTITY_LENGTH};
    double place[3];
    if (quantity_parse_list(kinds, 3, text, place) != RESULT_OK || place[0] < -90 || place[0] > 90 || place[1] < -540 ||
        place[1] > 540 || place[2] < -20000 || place[2] > 1e6)
        return false;
    out->lat_rad = place[0] * GEODESY_RAD_PER_DEG;
    out->lon_rad = place[1] * GEODESY_RAD_PER_DEG;
    out->h_m = place[2] + geoid_undulation_m(geoid, place[0], place[1]);
    return true;
}

static bool parse_to(const char *place, const char *speed, const Geoid *geoid, Demo *demo) {
    Waypoint waypoint;
    if (!place || !speed || !parse_place(place, geoid, &waypoint) ||
        quantity_parse(QUANTITY_SPEED, speed, &waypoint.speed_m_s) != RESULT_OK || waypoint.speed_m_s < 15.0 ||
        waypoint.speed_m_s > 1000.0 || demo->count == DEMO_WAYPOINTS_MAX)
        return false;
    demo->waypoints[demo->count++] = waypoint;
    return true;
}

static bool parse_clearance(const char *text, Demo *demo) {
    return text && quantity_parse(QUANTITY_LENGTH, text, &demo->clearance_m) == RESULT_OK &&
           demo->clearance_m >= 10.0 && demo->clearance_m <= 10000.0;
}

static bool parse_line(char *line, const Geoid *geoid, Demo *demo) {
    static const char blanks[] = " \t\r\n";
    char *rest = NULL;
    line[strcspn(line, "#")] = '\0';
    const char *word = strtok_r(line, blanks, &rest);
    if (!word)
        return true;
    const char *first = strtok_r(NULL, blanks, &rest), *second = strtok_r(NULL, blanks, &rest);
    if (strtok_r(NULL, blanks, &rest))
        return false;
    if (strcmp(word, "to") == 0)
        return parse_to(first, second, geoid, demo);
    return strcmp(word, "clearance") == 0 && !second && parse_clearance(first, demo);
}

static Result read_lines(FILE *stream, const char *path, const Geoid *geoid, Demo *demo) {
    char line[LINE_BYTES];
    for (int number = 1; fgets(line, sizeof line, stream); number++) {
        bool whole = strchr(line, '\n') || feof(stream);
        if (whole && parse_line(line, geoid, demo))
            continue;
        log_error(
            "%s:%d: expected 'to LAT,LON,ALT SPEED' (at most %d times; 15 to 1000 m/s), 'clearance LENGTH' (10 to "
            "10000 m), or a comment after '#'",
            path, number, DEMO_WAYPOINTS_MAX);
        return RESULT_FORMAT;
    }
    return ferror(stream) ? RESULT_IO : RESULT_OK;
}

Result demo_read(const char *path, const Geoid *geoid, Demo *out) {
    FILE *stream = fopen(path, "r");
    if (!stream) {
        log_error("%s: the demo flight cannot be opened: %s", path, strerror(errno));
        return RESULT_NOT_FOUND;
    }
    *out = (Demo){.clearance_m = CLEARANCE_M};
    Result result = read_lines(stream, path, geoid, out);
    fclose(stream);
    if (result == RESULT_IO)
        log_error("%s: the demo flight cannot be read", path);
    if (result == RESULT_OK && out->count == 0) {
        log_error("%s: the demo flight goes nowhere; expected lines 'to LAT,LON,ALT SPEED'", path);
        result = RESULT_FORMAT;
    }
    return result;
}

void demo_make_round(const Viewpoint *view, const Geoid *geoid, double distance_m, Demo *out) {
    *out = (Demo){.clearance_m = 2.0 * CLEARANCE_M, .count = ROUND_POINTS};
    double lat = view->lat_deg * GEODESY_RAD_PER_DEG, lon = view->lon_deg * GEODESY_RAD_PER_DEG;
    double heading = view->heading_deg * GEODESY_RAD_PER_DEG;
    double centre_lat = lat + distance_m * cos(heading) / GEODESY_A_M;
    double centre_lon = lon + distance_m * sin(heading) / (GEODESY_A_M * fmax(cos(lat), 0.05));
    double h_m = view->alt_m + geoid_undulation_m(geoid, view->lat_deg, view->lon_deg);
    for (int i = 0; i < ROUND_POINTS; i++) {
        double angle = heading + GEODESY_PI - 2.0 * GEODESY_PI * (i + 1) / ROUND_POINTS;
        double radius_m = 0.6 * distance_m;
        out->waypoints[i] =
            (Waypoint){centre_lat + radius_m * cos(angle) / GEODESY_A_M,
                       centre_lon + radius_m * sin(angle) / (GEODESY_A_M * fmax(cos(lat), 0.05)), h_m, ROUND_SPEED};
    }
}

Controls demo_fly(Demo *demo, const Flight *flight, double dt_s) {
    if (!demo_is_over(demo) && autopilot_has_reached(flight, &demo->waypoints[demo->next]))
        demo->next++;
    int next = demo->next < demo->count ? demo->next : demo->count - 1;
    return autopilot_fly(&demo->autopilot, flight, &demo->waypoints[next], demo->clearance_m, dt_s);
}

bool demo_is_over(const Demo *demo) {
    return demo->next >= demo->count;
}

double demo_duration_s(const Demo *demo, double lat_rad, double lon_rad) {
    double sum_s = 0.0, distance_m, bearing_rad;
    for (int i = 0; i < demo->count; i++) {
        const Waypoint *to = &demo->waypoints[i];
        autopilot_course(lat_rad, lon_rad, to, &distance_m, &bearing_rad);
        sum_s += distance_m / to->speed_m_s;
        lat_rad = to->lat_rad;
        lon_rad = to->lon_rad;
    }
    return sum_s;
}
