#!/usr/bin/env python3
"""Flights converted by overfly against gpsbabel's reading of the same files, both ways, for what both know: IGC, GPX and
KML. Usage: test_track_gpsbabel.py OVERFLY; exits 77 where gpsbabel is missing."""
import calendar
import csv
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time

POINTS = 300
START = 1703980680  # 2023-12-30T23:58:00Z: midnight is passed
# What gpsbabel keeps. It reads IGC's 1/1000 minutes without the further digits, and writes whole metres; geoidheight of
# GPX to 0.1 m, which our reading of altitudes follows; places in KML to 1e-6 degrees.
PLACE_DEG = {"igc": 1.01e-3 / 60, "gpx": 2e-9, "kml": 5.1e-7}
ALTITUDE_M = {"igc": 0.51, "gpx": 0.051, "kml": 0.0051}


class Fault(Exception):
    pass


def flight():
    """(seconds since 1970, latitude, longitude, metres above the geoid): circles that climb, in all four quadrants' signs."""
    for i in range(POINTS):
        turn = 2 * math.pi * i / 25
        yield START + i, -33.5 + 0.002 * math.sin(turn) + 1e-5 * i, -70.25 + 0.002 * math.cos(turn), 1500.0 + 2 * i


def write_csv(path):
    with open(path, "w", encoding="utf-8") as file:
        file.write("t_s,lat_deg,lon_deg,alt_m,unix_s\n")
        for utc, lat, lon, alt in flight():
            file.write(f"{utc - START},{lat:.9f},{lon:.9f},{alt:.3f},{utc}\n")


def read_csv(path):
    """As flight()."""
    with open(path, newline="", encoding="utf-8") as file:
        return [(float(r["unix_s"]), float(r["lat_deg"]), float(r["lon_deg"]), float(r["alt_m"]))
                for r in csv.DictReader(file)]


def read_unicsv(path):
    """As flight(), of gpsbabel's own columns; altitudes in metres as the file it read had them."""
    rows = []
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            moment = row["Date"] + " " + row["Time"].split(".")[0]
            utc = calendar.timegm(time.strptime(moment, "%Y/%m/%d %H:%M:%S"))
            altitude = float(row["Altitude"]) if row.get("Altitude") else math.nan
            rows.append((utc, float(row["Latitude"]), float(row["Longitude"]), altitude))
    return rows


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60, env={**os.environ, "TZ": "UTC"})
    if done.returncode != 0:
        raise Fault(f"{' '.join(command)}: {done.stderr}")
    return done.stdout


def compare(what, found, expected, place_deg, altitude_m):
    if len(found) != len(expected):
        raise Fault(f"{what}: {len(found)} points, expected {len(expected)}")
    worst = [0.0, 0.0]
    for a, b in zip(found, expected):
        place = max(abs(a[1] - b[1]), abs(math.remainder(a[2] - b[2], 360)))
        if abs(a[0] - b[0]) > 1e-6 or place > place_deg or not abs(a[3] - b[3]) <= altitude_m:
            raise Fault(f"{what}: found {a}, expected {b}, within {place_deg} degrees and {altitude_m} m")
        worst = [max(worst[0], place), max(worst[1], abs(a[3] - b[3]))]
    print(f"{what}: at most {worst[0]:.2e} degrees, {worst[1]:.3f} m apart")


def above_ellipsoid(rows, undulations):
    return [(*row[:3], row[3] + n) for row, n in zip(rows, undulations)]


def undulations_of(overfly, folder):
    """Of the flight's points: what an IGC file's altitudes above the ellipsoid are taken down by."""
    path = os.path.join(folder, "level.igc")
    with open(path, "w", encoding="utf-8") as file:
        file.write("AXXX001\nHFDTE301223\nHFALG:ELL\n")
        for utc, lat, lon, _ in flight():
            clock = time.strftime("%H%M%S", time.gmtime(utc))
            south, west = round(-lat * 60000), round(-lon * 60000)
            file.write(f"B{clock}{south // 60000:02}{south % 60000:05}S{west // 60000:03}{west % 60000:05}WA0000005000\n")
    run(overfly, "convert", path, path + ".csv")
    return [5000 - row[3] for row in read_csv(path + ".csv")]


def overfly_writes_gpsbabel_reads(overfly, folder, name, undulations):
    written, told = os.path.join(folder, f"ours.{name}"), os.path.join(folder, f"ours-{name}.csv")
    run(overfly, "convert", os.path.join(folder, "flight.csv"), written)
    tracks = ["-x", "track,merge"] if name == "kml" else []
    run("gpsbabel", "-t", "-i", name, "-f", written, *tracks, "-o", "unicsv,prec=9,utc=0", "-F", told)
    expected = list(flight())
    if name == "igc":
        expected = above_ellipsoid(expected, undulations)
    # It tells altitudes to 0.1 m.
    compare(f"{name}: overfly to gpsbabel", read_unicsv(told), expected, PLACE_DEG[name], max(ALTITUDE_M[name], 0.051))


def gpsbabel_writes_overfly_reads(overfly, folder, name, _undulations):
    source, written = os.path.join(folder, "ours.gpx"), os.path.join(folder, f"theirs.{name}")
    told = os.path.join(folder, f"theirs-{name}.csv")
    kind = "kml,track=1,points=0,lines=0" if name == "kml" else name
    run("gpsbabel", "-t", "-i", "gpx", "-f", source, "-o", kind, "-F", written)
    # It writes the altitudes above the geoid into the column for those above the ellipsoid, without HFALG.
    asked = ["--igc-alt", "geoid"] if name == "igc" else []
    report = json.loads(run(overfly, "convert", written, told, "--json", *asked))
    if report["gaps"] != 0 or report["attitude"] != "derived":
        raise Fault(f"{name}: {report}")
    compare(f"{name}: gpsbabel to overfly", read_csv(told), list(flight()), PLACE_DEG[name], ALTITUDE_M[name])


def main():
    overfly = os.path.abspath(sys.argv[1])
    if not shutil.which("gpsbabel"):
        print("[  SKIPPED ] flights_agree_with_gpsbabel: no gpsbabel")
        return 77
    faults = 0
    with tempfile.TemporaryDirectory() as folder:
        write_csv(os.path.join(folder, "flight.csv"))
        undulations = undulations_of(overfly, folder)
        for case in (overfly_writes_gpsbabel_reads, gpsbabel_writes_overfly_reads):
            for name in ("gpx", "igc", "kml"):
                try:
                    case(overfly, folder, name, undulations)
                except (Fault, OSError, KeyError, ValueError, subprocess.TimeoutExpired) as fault:
                    faults += 1
                    print(f"FAILED  {case.__name__}: {fault}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
