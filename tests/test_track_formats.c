// Flights in files of others: values, datums, gaps, and what is wrong with a file.
#define _POSIX_C_SOURCE 200809L
#include "app/track/track_build.h"
#include "app/track/track_time.h"
#include "heard.h"
#include "track_support.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#define NEAR(value, expected, within)                                                                                  \
    do {                                                                                                               \
        double found_ = (value), wanted_ = (expected);                                                                 \
        if (!(fabs(found_ - wanted_) <= (within)))                                                                     \
            fail_msg("%s: %.12g, expected %.12g within %g", #value, found_, wanted_, (double)(within));                \
    } while (0)

typedef struct Read {
    Result result;
    Track track;
    Heard heard;
} Read;

static Read read_as(const char *text, const char *ending, TrackReading how) {
    Read read = {0};
    heard_begin(&read.heard);
    read.result = track_of_text(text, strlen(text), ending, &how, &read.track);
    heard_end();
    return read;
}

static Track good(const char *text, const char *ending, TrackReading how) {
    Read read = read_as(text, ending, how);
    if (read.result != RESULT_OK)
        fail_msg("%s: %s", result_name(read.result), read.heard.text);
    return read.track;
}

// ---- IGC ----

#define IGC_HEAD "AXXX001\r\nHFDTE010624\r\n"
#define IGC_FIXES "B1200004630000N00800000EA0140001500\r\nB1200014630010N00800010EA0140101501\r\n"

static void test_igc_altitudes_are_of_the_datum_the_file_or_the_user_says(void **state) {
    static const struct {
        const char *headers;
        TrackIgcAlt asked;
        double alt_m;
        bool above_ellipsoid;
        TrackHeights heights;
        int warnings;
    } CASES[] = {
        {"", TRACK_IGC_UNTOLD, 1500, true, TRACK_HEIGHTS_ELLIPSOID_ASSUMED, 0},
        {"", TRACK_IGC_ELLIPSOID, 1500, true, TRACK_HEIGHTS_ELLIPSOID_ASKED, 0},
        {"", TRACK_IGC_GEOID, 1500, false, TRACK_HEIGHTS_GEOID_ASKED, 0},
        {"", TRACK_IGC_PRESSURE, 1400, false, TRACK_HEIGHTS_PRESSURE, 0},
        {"HFALG:GEO\r\n", TRACK_IGC_UNTOLD, 1500, false, TRACK_HEIGHTS_GEOID, 0},
        {"HFALGALTGPS:GEO\r\n", TRACK_IGC_UNTOLD, 1500, false, TRACK_HEIGHTS_GEOID, 0},
        {"HFALGALTGPS: ELL\r\n", TRACK_IGC_UNTOLD, 1500, true, TRACK_HEIGHTS_ELLIPSOID, 0},
        {"HFALGALTGPS:ELL\r\n", TRACK_IGC_GEOID, 1500, true, TRACK_HEIGHTS_ELLIPSOID, 1},
        {"HFALGALTGPS:GEO\r\n", TRACK_IGC_ELLIPSOID, 1500, false, TRACK_HEIGHTS_GEOID, 1},
        {"HFALGALTGPS:NKN\r\n", TRACK_IGC_GEOID, 1500, false, TRACK_HEIGHTS_GEOID_ASKED, 0},
        {"HFALGALTGPS:NIL\r\n", TRACK_IGC_UNTOLD, 1400, false, TRACK_HEIGHTS_PRESSURE, 1},
        {"HFALGALTGPS:GEO\r\n", TRACK_IGC_PRESSURE, 1400, false, TRACK_HEIGHTS_PRESSURE, 0},
    };
    Geoid *geoid = *state;
    double undulation_m = geoid_undulation_m(geoid, 46.5, 8.0);
    NEAR(undulation_m, 50.68, 1.0);
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        char text[512];
        snprintf(text, sizeof text, IGC_HEAD "%s" IGC_FIXES, CASES[i].headers);
        Read read = read_as(text, ".igc", (TrackReading){.igc_alt = CASES[i].asked, .geoid = geoid});
        assert_int_equal(read.result, RESULT_OK);
        NEAR(read.track.points[0].at.alt_m, CASES[i].alt_m - (CASES[i].above_ellipsoid ? undulation_m : 0.0), 1e-6);
        assert_int_equal(read.track.heights, CASES[i].heights);
        assert_int_equal(read.heard.warnings, CASES[i].warnings);
        track_clear(&read.track);
    }
}

static void test_igc_above_the_ellipsoid_needs_a_geoid(void **state) {
    (void)state;
    Read read = read_as(IGC_HEAD IGC_FIXES, ".igc", track_reading_default());
    assert_int_equal(read.result, RESULT_UNSUPPORTED);
    assert_non_null(strstr(read.heard.text, "no geoid"));
}

// As a glider's recorder, a paraglider's instrument and a phone begin their files.
static void test_igc_headers_of_real_recorders_are_understood(void **state) {
    static const struct {
        const char *text;
        double start_unix_s, lat_deg, lon_deg;
        int count;
        TrackHeights heights;
    } CASES[] = {
        {"ALXV6MSFLIGHT:1\r\nHFDTE160701\r\nHFFXA035\r\nHFDTM100GPSDATUM:WGS-1984\r\nI033638FXA3940SIU4143ENL\r\n"
         "F1602401916\r\nC150701213841160701000102500K\r\n"
         "B1602405407121N00249342WA002800042120509950\r\nE160245PEV\r\n"
         "B1602455107126S00149300WA002880042919509020\r\nLXXXRURITANIAN STANDARD NATIONALS DAY 1\r\nGREJNGJERJKNJKRE31",
         995299360.0, 54.0 + 7.121 / 60.0, -(2.0 + 49.342 / 60.0), 2, TRACK_HEIGHTS_ELLIPSOID_ASSUMED},
        {"AXSDUBP\nHFDTEDATE:291123,01\nHFALGALTGPS:GEO\nHFALPALTPRESSURE:ISA\nLMMMGPSPERIOD1000MSEC\n"
         "I023638FXA3940SIU\nB0900004552000N00625000EA012340129900514\nB0900014552001N00625001EA012340129900514\n",
         1701248400.0, 45.0 + 52.0 / 60.0, 6.0 + 25.0 / 60.0, 2, TRACK_HEIGHTS_GEOID},
        {"\xEF\xBB\xBF"
         "AXCS000 phone\nHOPLTPILOT:x\nHFDTEDATE: 010120\nHFALG: GEO\n"
         "B0000003352000S15112000EV0000000000\nB0000013352000S15112000EA0000000100\n",
         1577836801.0, -(33.0 + 52.0 / 60.0), 151.2, 1, TRACK_HEIGHTS_GEOID},
    };
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        Track track = good(CASES[i].text, ".igc", (TrackReading){.igc_alt = TRACK_IGC_UNTOLD, .geoid = *state});
        NEAR(track.start_unix_s, CASES[i].start_unix_s, 0.0);
        NEAR(track.points[0].at.lat_deg, CASES[i].lat_deg, 1e-9);
        NEAR(track.points[0].at.lon_deg, CASES[i].lon_deg, 1e-9);
        assert_int_equal(track.count, CASES[i].count);
        assert_int_equal(track.heights, CASES[i].heights);
        assert_true(track_is_derived(&track));
        track_clear(&track);
    }
}

static void test_igc_goes_on_after_midnight_and_leaves_out_fixes_that_are_none(void **state) {
    Read read = read_as(IGC_HEAD "HFALG:GEO\n"
                                 "B2359584630000N00800000EA0140001500\n"
                                 "B2359594630000N00800010EV0140001500\n" // no position
                                 "B0000004630000N00800020EA0140001500\n"
                                 "B0000014630000N008\n" // damaged
                                 "B0000024630000N00800040EA-012301500\n"
                                 "B0000024630000N00800040EA0140001500\n" // twice
                                 "B0000036160000N00800040EA0140001500\n" // 60 minutes of arc
                                 "B0000054630000N00800070EA01400015",    // cut off
                        ".igc", (TrackReading){.geoid = *state});
    assert_int_equal(read.result, RESULT_OK);
    assert_int_equal(read.track.count, 3);
    NEAR(read.track.points[1].t_s, 2.0, 0.0);
    NEAR(read.track.points[2].t_s, 4.0, 0.0);
    NEAR(read.track.points[2].at.alt_m, -123.0, 0.0);
    assert_int_equal(read.track.skipped[TRACK_SKIP_INVALID], 1);
    assert_int_equal(read.track.skipped[TRACK_SKIP_MALFORMED], 3);
    assert_int_equal(read.track.skipped[TRACK_SKIP_DUPLICATE], 1);
    assert_int_equal(read.heard.warnings, 1);
    assert_non_null(strstr(read.heard.text, ".igc:7: a point damaged, the first of 3"));
    track_clear(&read.track);
}

static void test_igc_extensions_add_digits(void **state) {
    Track track = good(IGC_HEAD "HFALG:GEO\nI033637LAD3839LOD4042TDS\n"
                                "B1200004630000N00800000EA01400015002550250\n"
                                "B1200004630000S00800000WA01400015002550750\n",
                       ".igc", (TrackReading){.igc_alt = TRACK_IGC_UNTOLD, .geoid = *state});
    assert_int_equal(track.count, 2);
    NEAR(track.points[0].at.lat_deg, 46.5 + 0.25e-3 / 60.0, 1e-12);
    NEAR(track.points[1].at.lon_deg, -(8.0 + 0.50e-3 / 60.0), 1e-12);
    NEAR(track.points[1].t_s, 0.5, 1e-6);
    track_clear(&track);
}

// ---- GPX ----

#define GPX(body)                                                                                                      \
    "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n" body "</gpx>"
#define PT(lat, lon, inside) "<trkpt lat=\"" lat "\" lon=\"" lon "\">" inside "</trkpt>\n"
#define AT(second, ele) "<ele>" ele "</ele><time>2024-06-01T12:00:" second "Z</time>"

static void test_gpx_segments_are_gaps_and_other_tracks_are_left_out(void **state) {
    (void)state;
    static const char text[] =
        GPX("<wpt lat=\"1\" lon=\"2\"><ele>5</ele></wpt>\n<trk><name>a &amp; b</name><trkseg>\n" PT("46.5", "8",
                                                                                                    AT("00", "1500"))
                PT("46.5001", "8.0001", AT("01.250", "1501.5") "<extensions><x><ele>9</ele></x></extensions>")
                    PT("46.5002", "8.0002", AT("03", "1503")) "</trkseg><trkseg>\n" PT(
                        "46.5003", "8.0003", AT("05", "1505")) PT("46.5003", "8.0003", "<ele>3</ele>")
                        PT("46.5003", "8.0003",
                           "<time>2024-06-01T12:00:06Z</time>") "</trkseg></trk>\n<trk><name>c</"
                                                                "name><trkseg>" PT("47", "9",
                                                                                   AT("00", "2000")) "</trkseg></trk>");
    Read first = read_as(text, ".gpx", track_reading_default());
    assert_int_equal(first.result, RESULT_OK);
    Track *track = &first.track;
    assert_int_equal(track->count, 4);
    NEAR(track->start_unix_s, 1717243200.0, 0.0);
    NEAR(track->points[1].t_s, 1.25, 1e-6);
    NEAR(track->points[1].at.alt_m, 1501.5, 0.0);
    assert_int_equal(track->points[2].flags & TRACK_GAP, 0);
    assert_int_equal(track->points[3].flags & TRACK_GAP, TRACK_GAP);
    assert_int_equal(track->skipped[TRACK_SKIP_OTHER], 1);
    assert_int_equal(track->skipped[TRACK_SKIP_UNTIMED], 1);
    assert_int_equal(track->skipped[TRACK_SKIP_NO_HEIGHT], 1);
    assert_int_equal(track->heights, TRACK_HEIGHTS_GEOID_ASSUMED);
    assert_int_equal(first.heard.warnings, 2);
    Track named = good(text, ".gpx", (TrackReading){.object = "c"}),
          second = good(text, ".gpx", (TrackReading){.object = "2"});
    NEAR(named.points[0].at.lat_deg, 47.0, 0.0);
    NEAR(second.points[0].at.lat_deg, 47.0, 0.0);
    track_clear(track);
    track_clear(&named);
    track_clear(&second);
}

static void test_gpx_geoidheight_carries_heights_over_to_our_geoid(void **state) {
    Geoid *geoid = *state;
    Track track = good(GPX("<trk><trkseg>" PT("46.5", "8", AT("00", "1500") "<geoidheight>0</geoidheight>") PT(
                           "46.5", "8.001", AT("01", "1500") "<geoidheight>48.5</geoidheight>") "</trkseg></trk>"),
                       ".gpx", (TrackReading){.geoid = geoid});
    NEAR(track.points[0].at.alt_m, 1500.0 - geoid_undulation_m(geoid, 46.5, 8.0), 1e-6);
    NEAR(track.points[1].at.alt_m, 1548.5 - geoid_undulation_m(geoid, 46.5, 8.001), 1e-6);
    assert_int_equal(track.heights, TRACK_HEIGHTS_GEOID_HEIGHT);
    track_clear(&track);
}

// ---- KML ----

#define KML(body)                                                                                                      \
    "<kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\"><Document>" body     \
    "</Document></kml>"
#define WHEN(second) "<when>2024-06-01T12:00:" second "Z</when>"

static void test_kml_tracks_are_placed_and_turned(void **state) {
    (void)state;
    Track track =
        good(KML("<Placemark><gx:MultiTrack><gx:Track><altitudeMode>absolute</altitudeMode>" WHEN("00")
                     WHEN("02") "<gx:coord>8 46.5 1500</gx:coord><gx:coord>\n 8.001 46.501 1510.5 </gx:coord>"
                                "<gx:angles>350 -10 -30</gx:angles><gx:angles>10 350 45</gx:angles></gx:Track>"
                                "<gx:Track>" WHEN("04") "<gx:coord>8.002 46.502 1500</gx:coord></gx:Track>"
                                                        "</gx:MultiTrack></Placemark>"
                                                        "<Placemark><gx:Track>" WHEN(
                                                            "00") "<gx:coord>9 47 1</gx:coord></gx:Track></Placemark>"),
             ".kml", track_reading_default());
    assert_int_equal(track.count, 3);
    NEAR(track.points[1].at.lat_deg, 46.501, 0.0);
    NEAR(track.points[1].at.alt_m, 1510.5, 0.0);
    NEAR(track.points[0].at.pitch_deg, 10.0, 1e-9); // tilt is positive nose down
    NEAR(track.points[0].bank_deg, 30.0, 1e-9);     // roll is positive left wing down
    NEAR(track.points[1].at.pitch_deg, 10.0, 1e-9);
    NEAR(track.points[1].bank_deg, -45.0, 1e-9);
    assert_int_equal(track.points[0].flags, 0);
    assert_int_equal(track.points[2].flags, TRACK_GAP | TRACK_DERIVED);
    assert_int_equal(track.skipped[TRACK_SKIP_OTHER], 1);
    track_clear(&track);
}

// ---- ACMI ----

#define ACMI                                                                                                           \
    "\xEF\xBB\xBF"                                                                                                     \
    "FileType=text/acmi/tacview\nFileVersion=2.2\n0,ReferenceTime=2024-06-01T12:00:00Z\n"

static void test_acmi_leaves_unchanged_what_is_empty(void **state) {
    (void)state;
    Track track = good(ACMI "0,ReferenceLongitude=8,ReferenceLatitude=46\n0,Comments=one\\,two\\\n"
                            "102,T=9|9|9 of a text\n#0.5\n"
                            "102,Name=F\\,16,T=0.5|0.25|1500|30|10|350,Type=Air+FixedWing\n"
                            "#1.5\n102,T=|0.26||||\n// a remark\n#2.5\n102,AOA=3\n#3.5\n102,T=0.51|||-30\n"
                            "#4.5\n102,T=0.52|||-30||5\n-102\n#5.5\n102,T=0.53|0.26|1510|0|0|0\n",
                       ".acmi", track_reading_default());
    assert_int_equal(track.count, 5);
    NEAR(track.start_unix_s, 1717243200.5, 1e-6);
    NEAR(track.points[0].at.lon_deg, 8.5, 1e-12);
    NEAR(track.points[1].at.lat_deg, 46.26, 1e-12);
    NEAR(track.points[1].at.lon_deg, 8.5, 1e-12);
    NEAR(track.points[1].at.heading_deg, 350.0, 0.0);
    NEAR(track.points[1].bank_deg, 30.0, 0.0);
    NEAR(track.points[3].bank_deg, -30.0, 0.0);
    NEAR(track.points[3].at.heading_deg, 5.0, 0.0);
    NEAR(track.points[3].at.pitch_deg, 10.0, 0.0);
    assert_int_equal(track.points[4].flags, TRACK_GAP); // it had left
    track_clear(&track);
}

static void test_acmi_takes_the_first_aircraft_or_the_one_asked_for(void **state) {
    (void)state;
    static const char text[] = ACMI "#0\n1,T=1|1|1,Type=Navaid+Static\n2,T=2|2|2|0|0|0,Type=Air+FixedWing,Pilot=Ann\n"
                                    "3,T=3|3|3|0|0|0,Type=Air+Rotorcraft,Pilot=Bob\n#1\n2,T=2.001||\n3,T=3.001||\n";
    static const struct {
        const char *object;
        double lat_deg;
        int others;
    } CASES[] = {{NULL, 2, 3}, {"1", 1, 4}, {"3", 3, 3}, {"Bob", 3, 3}, {"Ann", 2, 3}};
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        Track track = good(text, ".acmi", (TrackReading){.object = CASES[i].object});
        NEAR(track.points[0].at.lat_deg, CASES[i].lat_deg, 0.0);
        assert_int_equal(track.skipped[TRACK_SKIP_OTHER], CASES[i].others);
        track_clear(&track);
    }
}

static void test_who_asks_for_a_flight_that_is_not_there_is_told_which_are(void **state) {
    (void)state;
    static const struct {
        const char *ending, *text, *said;
    } CASES[] = {
        {".gpx",
         GPX("<trk><name>Ann</name><trkseg>" PT("46", "8", AT("00", "1")) "</trkseg></trk><trk><trkseg>" PT(
             "46", "8", AT("00", "1")) "</trkseg></trk>"),
         ".gpx: no flight of 'x'; there are: 1 'Ann', 2; name one of them with --object"},
        {".kml",
         KML("<Placemark><name>Bob</name><Track>" WHEN("00") "<coord>8 46 1</coord></Track><Track>" WHEN(
             "01") "<coord>8 46 1</coord></Track></Placemark><Placemark><Track>" WHEN("00") "<coord>8 46 1</coord>"
                                                                                            "</Track></Placemark>"),
         ".kml: no flight of 'x'; there are: 1 'Bob', 2; name"},
        {".acmi", ACMI "#0\n2a,T=2|2|2\n3,T=3|3|3,Pilot=Bob\n#1\n2a,T=2.1||,Name=F-16\n",
         ".acmi: no flight of 'x'; there are: 2a 'F-16', 3 'Bob'; name"},
        {".acmi",
         ACMI "#0\n1,T=1|1|1\n2,T=1|1|1\n3,T=1|1|1\n4,T=1|1|1\n5,T=1|1|1\n6,T=1|1|1\n7,T=1|1|1\n8,T=1|1|1\n"
              "9,T=1|1|1\n",
         "there are: 1, 2, 3, 4, 5, 6, 7, 8, and more; name"},
    };
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        Read read = read_as(CASES[i].text, CASES[i].ending, (TrackReading){.object = "x"});
        if (read.result != RESULT_FORMAT || !strstr(read.heard.text, CASES[i].said) || read.heard.errors != 1)
            fail_msg("%zu: %s, said '%s', expected '%s'", i, result_name(read.result), read.heard.text, CASES[i].said);
    }
}

// ---- what is wrong with a file ----

static const struct {
    const char *ending, *text;
    Result result;
    const char *said;
} WRONG[] = {
    {".txt", "hello\n", RESULT_FORMAT, ".txt:1: of no known format"},
    {".kmz", "PK\3\4xx", RESULT_FORMAT, "unpack it first"},
    {".igc", "", RESULT_FORMAT, ".igc: the file is empty; expected a flight as .ofr, .igc, .gpx, .kml, .acmi, .csv"},
    {".txt", "", RESULT_FORMAT, ".txt: the file is empty"},
    {".igc", "nonsense\n\1\2\3\n", RESULT_FORMAT, "no points of a flight"},
    {".igc", IGC_HEAD "B1200004630000N00800000EV0140001500\n", RESULT_FORMAT, ".igc:3: a point without a valid"},
    {".igc", IGC_HEAD "B1200004630000X00800000EA0140001500\n", RESULT_FORMAT, ".igc:3: a point damaged"},
    {".igc",
     IGC_HEAD "B1200034630000N00800000EA0140001500\nB1200024630000N00800000EA0140001500\n"
              "B1200014630000N00800000EA0140001500\n",
     RESULT_FORMAT, ".igc:4: a point going back in time, the first of 2; 1 are left: sort the file by time"},
    {".gpx", "<gpx><trk><trkseg>\n<trkpt lat=\"1\" lon=\"2\">\n<ele>1</e", RESULT_FORMAT, ".gpx:3: "},
    {".gpx", "<gpx></gpx>", RESULT_FORMAT, "no points of a flight"},
    {".gpx", "<html><gpx/></html>", RESULT_FORMAT, ".gpx:1: found <html>, expected <gpx>"},
    {".gpx", GPX("<rte><rtept lat=\"1\" lon=\"2\"/></rte>"), RESULT_FORMAT, "a route, which has no times"},
    {".gpx", GPX("<trk><trkseg>\n" PT("1", "2", "<ele>3</ele>") "</trkseg></trk>"), RESULT_FORMAT,
     ".gpx:4: a point without a time"},
    {".gpx", GPX("<trk><trkseg>\n" PT("91", "2", AT("00", "1")) "</trkseg></trk>"), RESULT_FORMAT,
     ".gpx:4: a point damaged"},
    {".gpx", "<!DOCTYPE gpx [<!ENTITY a \"b\">]>\n<gpx/>", RESULT_FORMAT, ".gpx:1: a document type"},
    {".kml", KML("<Placemark><LineString><coordinates>1,2,3</coordinates></LineString></Placemark>"), RESULT_FORMAT,
     "a LineString, which has no times"},
    {".kml", KML("<Placemark>\n<Track>" WHEN("00") WHEN("01") "<coord>1 2 3</coord></Track></Placemark>"),
     RESULT_FORMAT, ".kml:2: a track of 2 when, 1 coord and 0 angles"},
    {".kml", KML("<Track><altitudeMode>relativeToGround</altitudeMode></Track>"), RESULT_FORMAT,
     "relative to the ground"},
    {".kml", KML("<Track>\n" WHEN("99") "\n<coord>1 2 3</coord></Track>"), RESULT_FORMAT,
     ".kml:3: a point without a time"},
    {".acmi", "FileType=text/acmi/tacview\nFileVersion=1.7\n", RESULT_FORMAT, ".acmi:2: found 'FileVersion=1.7'"},
    {".acmi", "hello\n", RESULT_FORMAT, ".acmi:1: found 'hello'"},
    {".acmi", ACMI "#1\n2,T=1|2\n", RESULT_FORMAT, ".acmi:5: a point damaged"},
    {".acmi", ACMI "#1\n2,T=1|2|300|0|0|0", RESULT_FORMAT, ".acmi:5: a point damaged"}, // cut off within a number
    {".acmi", ACMI "#5\n2,T=1|2|3\n#4\n2,T=1|2|4\n#3\n2,T=1|2|5\n", RESULT_FORMAT, ".acmi:7: a point going back"},
    {".csv", "t_s,lat_deg,lon_deg,alt_m\n0,46,8,1\n0,46,8,1\n", RESULT_FORMAT, ".csv:3: t_s: found 0 after 0"},
};

static void test_what_is_wrong_is_told_with_file_and_line(void **state) {
    for (size_t i = 0; i < COUNT_OF(WRONG); i++) {
        Read read = read_as(WRONG[i].text, WRONG[i].ending, (TrackReading){.geoid = *state});
        if (read.result != WRONG[i].result || !strstr(read.heard.text, WRONG[i].said) || read.heard.errors != 1)
            fail_msg("%zu: %s, said '%s', expected '%s'", i, result_name(read.result), read.heard.text, WRONG[i].said);
    }
}

// ---- files that break off ----

#define FIX(n) PT("46.5", "8", AT(n, "1"))
#define COORD "<coord>8 46.5 1</coord>\n"
#define DEEP "<a><a><a><a><a><a><a><a><a><a><a><a><a><a><a><a>"
#define CUT(line) ":" line ": the file is cut off here; points before it, which are kept: 2"

// Each is read up to where it breaks off, or is damaged; `broken` takes the place of the end.
static const struct {
    const char *ending, *text, *broken, *said;
    size_t zeros; // behind it
} BROKEN[] = {
    {".gpx", "<gpx><trk><trkseg>\n" FIX("00") FIX("01"), "", CUT("4"), 0},
    {".gpx", "<gpx><trk><trkseg>\n" FIX("00") FIX("01"), "<trkpt lat=\"46.5\" l", CUT("4"), 0},
    {".gpx", "<gpx><trk><trkseg>\n" FIX("00") FIX("01"), "<trkpt lat=\"46.5\" lon=\"8\"><ele>1", CUT("4"), 0},
    {".gpx", "<gpx><trk><trkseg>\n" FIX("00") FIX("01"), "<trkpt", CUT("4"), 5000},
    {".gpx", "<gpx><trk><trkseg>\n" FIX("00") FIX("01"), "</trkseg></trk></gpx><gpx>",
     ":4: junk after document element: nothing behind it can be read; points before it, which are kept: 2", 0},
    {".gpx", "<gpx><trk><trkseg>\n" FIX("00") FIX("01"), "</trk></gpx>\n",
     ":4: mismatched tag: nothing behind it can be read; points before it, which are kept: 2", 0},
    {".kml", "<kml><Placemark><Track>\n" WHEN("00") WHEN("01") WHEN("02") COORD COORD, "<coord>8 4", CUT("4"), 0},
    {".kml", "<kml><Placemark><Track>\n" WHEN("00") COORD WHEN("01") COORD, "<when>", CUT("4"), 0},
    {".kml", "<kml><Placemark><Track>\n" WHEN("00") COORD "</Track><Track>" WHEN("01") COORD, "", CUT("4"), 0},
    {".csv", "t_s,lat_deg,lon_deg,alt_m\n0,46.5,8,1\n1,46.5,8,1\n", "2,46.5,", CUT("4"), 0},
    {".csv", "t_s,lat_deg,lon_deg,alt_m\n0,46.5,8,1\n1,46.5,8,1\n", "2", CUT("4"), 5000},
    {".igc", IGC_HEAD IGC_FIXES, "B12000246300", ".igc:5: a point damaged, which is left out", 0},
    {".acmi", ACMI "#0\n2,T=8|46.5|1\n#1\n2,T=8|46.5|1\n", "#2\n2,T=8|4", ".acmi:9: a point damaged, which is left out",
     0},
};

static void test_a_file_that_breaks_off_is_read_up_to_there(void **state) {
    for (size_t i = 0; i < COUNT_OF(BROKEN); i++) {
        char text[8192] = "";
        size_t bytes = (size_t)snprintf(text, sizeof text, "%s%s", BROKEN[i].text, BROKEN[i].broken);
        Read read = {0};
        heard_begin(&read.heard);
        read.result = track_of_text(text, bytes + BROKEN[i].zeros, BROKEN[i].ending,
                                    &(TrackReading){.igc_alt = TRACK_IGC_UNTOLD, .geoid = *state}, &read.track);
        heard_end();
        if (read.result != RESULT_OK || !strstr(read.heard.text, BROKEN[i].said) || read.heard.warnings != 1)
            fail_msg("%zu: %s, said '%s', expected '%s'", i, result_name(read.result), read.heard.text, BROKEN[i].said);
        assert_int_equal(read.track.count, 2);
        track_clear(&read.track);
    }
}

// Where less of a file is whole than damaged, as of the other formats; and what is made to be wrong.
static void test_what_breaks_off_early_or_is_hostile_is_refused(void **state) {
    static const struct {
        const char *ending, *text, *said;
    } CASES[] = {
        {".gpx", "<gpx><trk><trkseg>\n" FIX("00") "</trk>\n" FIX("01") FIX("02") "</trkseg></trk></gpx>",
         ".gpx:3: mismatched tag: expected well-formed XML; more of the file stands behind it than before"},
        {".kml", "<kml><Placemark><Track>\n" WHEN("00") WHEN("01"),
         ".kml:2: no element found: the file is empty or cut off"},
        {".gpx", "<gpx><name>a & b</name>",
         ".gpx:1: not well-formed (invalid token): expected well-formed XML; no point"},
        {".gpx", "<!DOCTYPE gpx [<!ENTITY a SYSTEM \"file:///etc/passwd\">]>\n<gpx><trk><trkseg>" FIX("00") "&a;",
         ".gpx:1: a document type"},
        {".gpx", "<gpx><trk><trkseg>" FIX("00") DEEP DEEP DEEP DEEP, ".gpx:2: elements nested more than 64 deep"},
    };
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        Read read = read_as(CASES[i].text, CASES[i].ending, (TrackReading){.geoid = *state});
        if (read.result != RESULT_FORMAT || !strstr(read.heard.text, CASES[i].said) || read.heard.errors != 1)
            fail_msg("%zu: %s, said '%s', expected '%s'", i, result_name(read.result), read.heard.text, CASES[i].said);
    }
}

static void test_one_point_back_in_time_is_left_out_with_a_warning(void **state) {
    (void)state;
    Read read = read_as(GPX("<trk><trkseg>\n" PT("46.5", "8", AT("00", "1")) PT("46.5", "8", AT("02", "1"))
                                PT("46.5", "8", AT("01", "1")) PT("46.5", "8", AT("03", "1")) "</trkseg></trk>"),
                        ".gpx", track_reading_default());
    assert_int_equal(read.result, RESULT_OK);
    assert_int_equal(read.track.count, 3);
    assert_int_equal(read.track.skipped[TRACK_SKIP_BACKWARD], 1);
    assert_non_null(strstr(read.heard.text, ".gpx:6: a point going back in time, which is left out"));
    track_clear(&read.track);
}

static void test_a_file_is_what_it_holds_whatever_its_name(void **state) {
    Read read = read_as(IGC_HEAD IGC_FIXES, ".gpx", (TrackReading){.geoid = *state});
    assert_int_equal(read.result, RESULT_OK);
    assert_string_equal(read.track.format, "igc");
    assert_int_equal(read.heard.warnings, 1);
    track_clear(&read.track);
}

// ---- hostile sizes ----

static Read read_bytes(char *text, size_t bytes, const char *ending) {
    Read read = {0};
    heard_begin(&read.heard);
    read.result = track_of_text(text, bytes, ending, &(TrackReading){0}, &read.track);
    heard_end();
    free(text);
    return read;
}

// `head`, then `count` times `middle`.
static char *repeated(const char *head, const char *middle, size_t count, size_t *bytes) {
    size_t length = strlen(middle), at = strlen(head);
    *bytes = at + length * count;
    char *text = malloc(*bytes + 1);
    assert_non_null(text);
    memcpy(text, head, at);
    for (size_t i = 0; i < count; i++, at += length)
        memcpy(text + at, middle, length);
    return text;
}

static void test_hostile_sizes_are_refused_in_bounded_memory(void **state) {
    (void)state;
    static const struct {
        const char *ending, *head, *middle;
        size_t count;
        const char *said;
    } CASES[] = {
        {".gpx", "<gpx>", "<a>", 100000, "nested more than 64 deep"},
        {".gpx", "<gpx><trk name=\"", "xxxxxxxxxxxxxxxx", 1 << 18, "a tag of more than a megabyte"},
        {".gpx", "<gpx><!--", "xxxxxxxxxxxxxxxx", 1 << 18, "a tag of more than a megabyte"},
        {".gpx", "<gpx><trk><name>", "xxxxxxxxxxxxxxxx", 1 << 18, "the file is empty or cut off"},
        {".igc", "", "B1200004630000N008", 1 << 18, ".igc:1: a point damaged"},
        {".acmi", "FileType=text/acmi/tacview\nFileVersion=2.2\n2,T=", "1|2|", 1 << 20, ".acmi:3: a point damaged"},
        {".csv", "t_s,lat_deg,lon_deg,alt_m\n", "1,", 1 << 20, ".csv:2: a line of more than 4095 bytes"},
    };
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        size_t bytes;
        char *text = repeated(CASES[i].head, CASES[i].middle, CASES[i].count, &bytes);
        Read read = read_bytes(text, bytes, CASES[i].ending);
        if (read.result != RESULT_FORMAT || !strstr(read.heard.text, CASES[i].said))
            fail_msg("%zu: %s, said '%s', expected '%s'", i, result_name(read.result), read.heard.text, CASES[i].said);
    }
}

static void test_more_points_than_there_may_be_are_refused(void **state) {
    (void)state;
    Track track;
    TrackBuild build = track_build_begin("long.igc", &track);
    Heard heard;
    TrackPoint point = {.at = {46, 8, 1000, 0, 0}};
    for (int i = 0; i < TRACK_POINTS_MAX; i++) {
        point.t_s = i;
        assert_int_equal(track_build_add(&build, i + 1, &point), RESULT_OK);
    }
    heard_begin(&heard);
    point.t_s = TRACK_POINTS_MAX;
    assert_int_equal(track_build_add(&build, 4000001, &point), RESULT_FORMAT);
    heard_end();
    assert_non_null(strstr(heard.text, "long.igc:4000001: more than 4000000 points"));
    track_clear(&track);
}

// ---- times ----

static void test_times_agree_with_the_c_library(void **state) {
    (void)state;
    for (int64_t day = -719000; day < 2932000; day += 97) {
        double unix_s = (double)(day * 86400 + day * 7919 % 86400 + (day * 7919 % 86400 < 0 ? 86400 : 0)), back;
        time_t seconds = (time_t)unix_s;
        struct tm parts;
        char text[TRACK_TIME_BYTES], expected[80];
        assert_non_null(gmtime_r(&seconds, &parts));
        snprintf(expected, sizeof expected, "%04d-%02d-%02dT%02d:%02d:%02dZ", parts.tm_year + 1900, parts.tm_mon + 1,
                 parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec);
        track_time_write(unix_s, text);
        assert_string_equal(text, expected);
        assert_true(track_time_read(text, &back));
        NEAR(back, unix_s, 0.0);
    }
}

static void test_times_are_read_as_xml_has_them(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double unix_s; // NaN: none
    } CASES[] = {{"2024-06-01T12:00:00Z", 1717243200.0},
                 {"2024-06-01T12:00:00", 1717243200.0},
                 {"2024-06-01T14:00:00+02:00", 1717243200.0},
                 {"2024-06-01T07:30:00.5-0430", 1717243200.5},
                 {"2024-02-29T00:00:00Z", 1709164800.0},
                 {"2023-02-29T00:00:00Z", NAN},
                 {"2024-13-01T00:00:00Z", NAN},
                 {"2024-06-01", NAN},
                 {"2024-06-01T25:00:00Z", NAN},
                 {"2024-06-01T12:00:00Zx", NAN},
                 {"", NAN},
                 {"2024-06-01T12:00", NAN}};
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        double unix_s;
        bool is_time = track_time_read(CASES[i].text, &unix_s);
        if (is_time == (isnan(CASES[i].unix_s) != 0))
            fail_msg("'%s' is %s time", CASES[i].text, is_time ? "a" : "no");
        if (is_time)
            NEAR(unix_s, CASES[i].unix_s, 1e-6);
    }
}

// ---- from one to another ----

// What a format keeps: degrees, metres, degrees of attitude (negative: none), seconds.
typedef struct Keeps {
    const char *ending;
    double place_deg, alt_m, attitude_deg, time_s;
} Keeps;
static const Keeps KEEPS[] = {{".igc", 1e-5 / 60.0, 0.51, -1.0, 1e-6},
                              {".gpx", 1e-9, 2e-3, -1.0, 1e-6},
                              {".kml", 1e-9, 6e-4, 1e-6, 1e-6},
                              {".acmi", 1e-9, 6e-4, 1e-6, 1e-6},
                              {".csv", 1e-12, 1e-9, 1e-9, 1e-6}};

static void compare(const Track *a, const Track *b, const Keeps *keeps, const char *way) {
    if (a->count != b->count || fabs(a->start_unix_s - b->start_unix_s) > keeps->time_s)
        fail_msg("%s: %d points from %.3f, expected %d from %.3f", way, b->count, b->start_unix_s, a->count,
                 a->start_unix_s);
    for (int i = 0; i < a->count; i++) {
        const TrackPoint *p = &a->points[i], *q = &b->points[i];
        double lon = remainder(p->at.lon_deg - q->at.lon_deg, 360.0), lat = p->at.lat_deg - q->at.lat_deg;
        double place = fmax(fabs(lon), fabs(lat)), alt = fabs(p->at.alt_m - q->at.alt_m);
        double turn =
            fmax(fabs(remainder(p->at.heading_deg - q->at.heading_deg, 360.0)),
                 fmax(fabs(p->at.pitch_deg - q->at.pitch_deg), fabs(remainder(p->bank_deg - q->bank_deg, 360.0))));
        bool turned = keeps->attitude_deg >= 0.0, derived = (q->flags & TRACK_DERIVED) != 0;
        if (place > keeps->place_deg || alt > keeps->alt_m || fabs(p->t_s - q->t_s) > keeps->time_s ||
            (turned && turn > keeps->attitude_deg) || derived == turned ||
            ((p->flags ^ q->flags) & TRACK_GAP && turned))
            fail_msg("%s, point %d: differs by %g degrees, %g m, %g s, attitude %g degrees; flags %x, %x", way, i,
                     place, alt, p->t_s - q->t_s, turn, p->flags, q->flags);
    }
}

static void test_every_format_gives_back_what_every_other_wrote(void **state) {
    Track track = track_aerobatic(90);
    TrackReading how = {.igc_alt = TRACK_IGC_UNTOLD, .geoid = *state};
    track.points[40].flags = TRACK_GAP;
    for (size_t i = 0; i < COUNT_OF(KEEPS); i++)
        for (size_t k = 0; k < COUNT_OF(KEEPS); k++) {
            size_t bytes;
            char way[64];
            Track first, second;
            snprintf(way, sizeof way, "%s to %s", KEEPS[i].ending, KEEPS[k].ending);
            char *text = text_of_track(&track, KEEPS[i].ending, *state, &bytes);
            assert_int_equal(track_of_text(text, bytes, KEEPS[i].ending, &how, &first), RESULT_OK);
            free(text);
            compare(&track, &first, &KEEPS[i], KEEPS[i].ending);
            text = text_of_track(&first, KEEPS[k].ending, *state, &bytes);
            assert_int_equal(track_of_text(text, bytes, KEEPS[k].ending, &how, &second), RESULT_OK);
            free(text);
            Keeps both = KEEPS[k];
            both.attitude_deg = -1.0; // what was derived is derived again, or marked
            if (KEEPS[i].attitude_deg < 0.0 || KEEPS[k].attitude_deg < 0.0)
                compare(&first, &second, &both, way);
            else
                compare(&first, &second, &KEEPS[k], way);
            track_clear(&first);
            track_clear(&second);
        }
    track_clear(&track);
}

static void test_igc_is_written_at_whole_seconds(void **state) {
    Track track = track_aerobatic(200);
    for (int i = 0; i < track.count; i++)
        track.points[i].t_s = 0.125 * i + 0.0625;
    size_t bytes;
    char *text = text_of_track(&track, ".igc", *state, &bytes);
    Track back;
    track.start_unix_s += 0.4;
    free(text);
    text = text_of_track(&track, ".igc", *state, &bytes);
    assert_int_equal(
        track_of_text(text, bytes, ".igc", &(TrackReading){.igc_alt = TRACK_IGC_UNTOLD, .geoid = *state}, &back),
        RESULT_OK);
    free(text);
    assert_int_equal(back.count, 25);
    for (int i = 0; i < back.count; i++) {
        Viewpoint at = track_at(&track, back.start_unix_s + back.points[i].t_s - track.start_unix_s);
        NEAR(back.points[i].at.lat_deg, at.lat_deg, 1e-5 / 60.0);
        NEAR(back.points[i].at.alt_m, at.alt_m, 0.51);
    }
    track_clear(&back);
    track_clear(&track);
}

static void test_pressure_altitudes_stay_in_their_column_or_are_warned_of(void **state) {
    Track track = track_aerobatic(5), back;
    TrackReading how = {.igc_alt = TRACK_IGC_UNTOLD, .geoid = *state};
    Heard heard;
    size_t bytes;
    track.heights = TRACK_HEIGHTS_PRESSURE;
    heard_begin(&heard);
    char *text = text_of_track(&track, ".igc", *state, &bytes);
    assert_int_equal(heard.warnings, 0);
    assert_int_equal(track_of_text(text, bytes, ".igc", &how, &back), RESULT_OK);
    free(text);
    assert_int_equal(back.heights, TRACK_HEIGHTS_PRESSURE);
    NEAR(back.points[1].at.alt_m, track.points[1].at.alt_m, 0.5);
    free(text_of_track(&track, ".gpx", *state, &bytes));
    heard_end();
    assert_non_null(strstr(heard.text, "pressure altitudes are written where GPX"));
    track_clear(&back);
    track_clear(&track);
}

static void test_a_flight_without_a_date_is_not_given_one(void **state) {
    (void)state;
    Track track = track_aerobatic(3);
    Heard heard;
    track.start_unix_s = NAN;
    for (const TrackFormat *f = track_formats; f->name; f++) {
        if (!f->wants_start)
            continue;
        heard_begin(&heard);
        assert_int_equal(track_save("never-written", f, &track, NULL), RESULT_USAGE);
        heard_end();
        assert_non_null(strstr(heard.text, "--start"));
    }
    track_clear(&track);
}

#define IGC_DIGITS "I023637LAD3839LOD\r\n"

// Both columns, and the rest of each fix, are bytes of the input, of whatever datum.
static void test_igc_to_igc_keeps_both_altitudes(void **state) {
    static const struct {
        const char *headers, *fixes, *kept;
        TrackIgcAlt asked;
    } CASES[] = {
        {"HFALG:GEO\r\n" IGC_DIGITS,
         "B1200004630000N00800000EA01400015000123\r\nB1200014630010S07000010WA-004201501"
         "9900\r\n",
         "HFALGALTGPS:GEO\r\nHFALPALTPRESSURE:ISA\r\n", TRACK_IGC_UNTOLD},
        {"HFALG:ELL\r\nHFALP:ISA\r\n" IGC_DIGITS,
         "B1200004630000N00800000EA01400015000123\r\nB1200024630011N00800010EA00000-00014567\r\n",
         "HFALGALTGPS:ELL\r\nHFALPALTPRESSURE:ISA\r\n", TRACK_IGC_UNTOLD},
        {IGC_DIGITS, "B1200004630000N00800000EA01400015000123\r\n", "HFALGALTGPS:GEO\r\nHFALPALTPRESSURE:ISA\r\n",
         TRACK_IGC_GEOID},
        {"HFALG:GEO\r\n" IGC_DIGITS, "B1200004630000N00800000EA00000015000123\r\n",
         "HFALGALTGPS:GEO\r\nHFALPALTPRESSURE:NIL\r\n", TRACK_IGC_UNTOLD},
        {IGC_DIGITS, "B1200004630000N00800000EA01400000000123\r\n", "HFALGALTGPS:NIL\r\nHFALPALTPRESSURE:ISA\r\n",
         TRACK_IGC_UNTOLD},
    };
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        char text[400];
        size_t bytes;
        snprintf(text, sizeof text, IGC_HEAD "%s%s", CASES[i].headers, CASES[i].fixes);
        Track track = good(text, ".igc", (TrackReading){.igc_alt = CASES[i].asked, .geoid = *state});
        char *written = text_of_track(&track, ".igc", *state, &bytes), *fixes = strstr(written, "\r\nB");
        assert_non_null(strstr(written, CASES[i].kept));
        assert_non_null(fixes);
        assert_memory_equal(fixes + 2, CASES[i].fixes, strlen(CASES[i].fixes));
        assert_ptr_equal(fixes + 2 + strlen(CASES[i].fixes), written + bytes);
        free(written);
        track_clear(&track);
    }
}

static void test_pressure_altitudes_are_interpolated_and_those_of_no_use_left_out(void **state) {
    TrackReading how = {.igc_alt = TRACK_IGC_UNTOLD, .geoid = *state};
    Track track = good(IGC_HEAD "HFALG:GEO\r\n"
                                "B1200004630000N00800000EA0140001500\r\nB1200044630010N00800010EA0141001501\r\n",
                       ".igc", how);
    assert_int_equal(track_resample(&track, 1.0), RESULT_OK);
    assert_true(track_has_pressure(&track));
    NEAR((double)track.points[3].pressure_m, 1407.5, 1e-3);
    track.points[2].flags &= ~(unsigned)TRACK_PRESSURE;
    assert_false(track_has_pressure(&track));
    track_clear(&track);
    Read read = read_as(IGC_HEAD "HFALG:GEO\r\nHFALPALTPRESSURE:MSL\r\n" IGC_FIXES, ".igc", how);
    assert_int_equal(read.result, RESULT_OK);
    assert_false(track_has_pressure(&read.track));
    assert_non_null(strstr(read.heard.text, ".igc:4: 'HFALPALTPRESSURE:MSL': pressure altitudes that are not of"));
    track_clear(&read.track);
}

static void test_igc_extensions_that_make_no_sense_are_warned_of(void **state) {
    static const char *const LINES[] = {"I99XX", "I", "I0X", "I023637LAD", "I013736LAD", "I013436LAD", "I01363XLAD"};
    for (size_t i = 0; i < COUNT_OF(LINES); i++) {
        char text[400], said[64];
        snprintf(text, sizeof text, IGC_HEAD "%s\r\nB1200004630000N00800000EA0140000000999\r\n", LINES[i]);
        snprintf(said, sizeof said, ".igc:3: '%s': no list of extensions", LINES[i]);
        Read read = read_as(text, ".igc", (TrackReading){.igc_alt = TRACK_IGC_UNTOLD, .geoid = *state});
        assert_int_equal(read.result, RESULT_OK);
        assert_non_null(strstr(read.heard.text, said));
        assert_int_equal(read.heard.warnings, 2); // and once of the GNSS column, which has it read twice
        NEAR(read.track.points[0].at.lat_deg, 46.5, 1e-12);
        track_clear(&read.track);
    }
}

// ---- mutations ----

static uint64_t next_random(uint64_t *seed) {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return *seed;
}

// Changes, drops, doubles or cuts some bytes.
static size_t mutate(char *text, size_t bytes, size_t room, uint64_t *seed) {
    static const char spice[] = "\0\r\n,|#-.09eE<>&\"'=BHI\xff\x80";
    for (uint64_t k = next_random(seed) % 6; k > 0 && bytes > 8; k--) {
        size_t at = next_random(seed) % bytes, length = next_random(seed) % 40 % (bytes - at + 1);
        switch (next_random(seed) % 5) {
        case 0:
            text[at] = spice[next_random(seed) % (sizeof spice - 1)];
            break;
        case 1:
            text[at] = (char)next_random(seed);
            break;
        case 2:
            memmove(text + at, text + at + length, bytes - at - length), bytes -= length;
            break;
        case 3:
            if (bytes + length < room)
                memmove(text + at + length, text + at, bytes - at), bytes += length;
            break;
        default:
            bytes = next_random(seed) % 20 == 0 ? at : bytes;
            break;
        }
    }
    return bytes;
}

static void check_track(const Track *track, uint64_t seed) {
    for (int i = 0; i < track->count; i++) {
        const TrackPoint *p = &track->points[i];
        if ((i > 0 && !(p->t_s > p[-1].t_s)) || !(fabs(p->at.lat_deg) <= 90.0) || !(fabs(p->at.lon_deg) <= 540.0) ||
            !isfinite(p->at.alt_m) || !isfinite(p->at.heading_deg) || !isfinite(p->at.pitch_deg) ||
            !isfinite(p->bank_deg))
            fail_msg("seed %llu: point %d of %d", (unsigned long long)seed, i, track->count);
    }
    for (int i = 0; i <= 10; i++) {
        TrackState s = track_state_at(track, track_duration_s(track) * i / 10.0);
        if (!isfinite(s.at.lat_deg) || !isfinite(s.at.alt_m) || !isfinite(s.at.heading_deg) || !isfinite(s.bank_deg))
            fail_msg("seed %llu: state at %d tenths", (unsigned long long)seed, i);
    }
}

static void test_damaged_files_are_read_or_refused_with_a_message(void **state) {
    Track track = track_aerobatic(60);
    track.points[30].flags = TRACK_GAP;
    uint64_t seed = 20240601;
    for (size_t f = 0; f < COUNT_OF(KEEPS); f++) {
        size_t bytes, room = 1 << 16;
        char *whole = text_of_track(&track, KEEPS[f].ending, *state, &bytes), *text = malloc(room);
        assert_non_null(text);
        for (int run = 0; run < 400; run++) {
            uint64_t begun = seed;
            Heard heard;
            Track read;
            memcpy(text, whole, bytes);
            size_t left = mutate(text, bytes, room, &seed);
            heard_begin(&heard);
            Result result = track_of_text(text, left, KEEPS[f].ending, &(TrackReading){.geoid = *state}, &read);
            heard_end();
            if (result != RESULT_OK && heard.errors != 1)
                fail_msg("seed %llu of %s: %s, %d errors: '%s'", (unsigned long long)begun, KEEPS[f].ending,
                         result_name(result), heard.errors, heard.text);
            if (result == RESULT_OK) {
                check_track(&read, begun);
                track_clear(&read);
            }
        }
        free(text);
        free(whole);
    }
    track_clear(&track);
}

static int open_geoid(void **state) {
    *state = track_geoid();
    return 0;
}

static int close_geoid(void **state) {
    Geoid *geoid = *state;
    geoid_close(&geoid);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_igc_altitudes_are_of_the_datum_the_file_or_the_user_says),
        cmocka_unit_test(test_igc_above_the_ellipsoid_needs_a_geoid),
        cmocka_unit_test(test_igc_headers_of_real_recorders_are_understood),
        cmocka_unit_test(test_igc_goes_on_after_midnight_and_leaves_out_fixes_that_are_none),
        cmocka_unit_test(test_igc_extensions_add_digits),
        cmocka_unit_test(test_gpx_segments_are_gaps_and_other_tracks_are_left_out),
        cmocka_unit_test(test_gpx_geoidheight_carries_heights_over_to_our_geoid),
        cmocka_unit_test(test_kml_tracks_are_placed_and_turned),
        cmocka_unit_test(test_acmi_leaves_unchanged_what_is_empty),
        cmocka_unit_test(test_acmi_takes_the_first_aircraft_or_the_one_asked_for),
        cmocka_unit_test(test_who_asks_for_a_flight_that_is_not_there_is_told_which_are),
        cmocka_unit_test(test_what_is_wrong_is_told_with_file_and_line),
        cmocka_unit_test(test_a_file_that_breaks_off_is_read_up_to_there),
        cmocka_unit_test(test_what_breaks_off_early_or_is_hostile_is_refused),
        cmocka_unit_test(test_one_point_back_in_time_is_left_out_with_a_warning),
        cmocka_unit_test(test_a_file_is_what_it_holds_whatever_its_name),
        cmocka_unit_test(test_hostile_sizes_are_refused_in_bounded_memory),
        cmocka_unit_test(test_more_points_than_there_may_be_are_refused),
        cmocka_unit_test(test_times_agree_with_the_c_library),
        cmocka_unit_test(test_times_are_read_as_xml_has_them),
        cmocka_unit_test(test_every_format_gives_back_what_every_other_wrote),
        cmocka_unit_test(test_igc_is_written_at_whole_seconds),
        cmocka_unit_test(test_igc_to_igc_keeps_both_altitudes),
        cmocka_unit_test(test_pressure_altitudes_are_interpolated_and_those_of_no_use_left_out),
        cmocka_unit_test(test_igc_extensions_that_make_no_sense_are_warned_of),
        cmocka_unit_test(test_pressure_altitudes_stay_in_their_column_or_are_warned_of),
        cmocka_unit_test(test_a_flight_without_a_date_is_not_given_one),
        cmocka_unit_test(test_damaged_files_are_read_or_refused_with_a_message),
    };
    return cmocka_run_group_tests_name("test_track_formats", tests, open_geoid, close_geoid);
}
