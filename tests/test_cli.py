#!/usr/bin/env python3
"""The program from outside, as a person or a script uses it, mistakes included. Usage: test_cli.py OVERFLY [NAME|-NAME]...
with names these cases alone, with -NAME all but these."""
import csv
import hashlib
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

from cli_support import DEM, Cli, Fault, Skip, expect, expect_in, expect_true, passes

SMALL = ["--size", "320x200"]
SUBCOMMANDS = ["fly", "demo", "replay", "snapshot", "mesh", "bench", "reproduce", "info", "convert", "devices",
               "aircraft", "config"]


class FlightCli(Cli):
    def write(self, name, text):
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(name)

    def write_picture(self, name, pixel=b"\xff\0\0", side=2):
        """A PNG of red or other pixels."""
        def chunk(kind, data):
            body = kind + data
            return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

        with open(self.path(name), "wb") as file:
            file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)) +
                       chunk(b"IDAT", zlib.compress(side * (b"\0" + side * pixel))) + chunk(b"IEND", b""))

    def write_tile(self, name, side):
        """A flat .hgt, whose name says where it lies."""
        with open(self.path(name), "wb") as file:
            file.write(b"\0\x64" * (side * side))

    def warned(self, said, *arguments):
        """The program does what it is asked to and gives one warning, which says `said`."""
        run = self.run(*arguments)
        what = " ".join(arguments)
        expect(f"{what}: exit status, having said {run.err!r}", run.code, 0)
        expect(f"{what}: warnings in {run.err!r}", run.err.count("warning: "), 1)
        expect_in(what, said, run.err)

    def json(self, *arguments, **environment):
        run = self.run(*arguments, "--json", **environment)
        expect(f"{' '.join(arguments)}: exit status, having said {run.err!r}", run.code, 0)
        return json.loads(run.out)

    def digest(self, name):
        with open(self.path(name), "rb") as file:
            data = file.read()
        expect(f"{name}: begins as", data[:8], b"\x89PNG\r\n\x1a\n")
        return hashlib.sha256(data).hexdigest()


def help_is_instant_and_complete(cli):
    run = cli.run("--help")
    expect("exit status", run.code, 0)
    for name in SUBCOMMANDS:
        expect_in("--help", f"\n  {name} ", run.out)
        page = cli.run(name, "--help")
        expect(f"{name} --help: exit status", page.code, 0)
        expect_in(f"{name} --help", f"usage: overfly {name}", page.out)
        expect_in(f"{name} --help", "--help", page.out)
    rows = run.out[run.out.index("subcommands") :].split("\n\n")[0].splitlines()[1:]
    for row, below in zip(rows, rows[1:] + [""]):
        expect_true(f"--help: where the summary begins: {row!r}",
                    re.match(r".{33}  \S", row) or below.startswith(" " * 35) and below[35:36].strip())
    expect("--version", cli.run("--version").out.split()[0], "overfly")


def help_comes_even_with_a_damaged_file(cli):
    cli.write("config/overfly/overfly.conf", "[[[\n")
    expect("exit status", cli.run("fly", "--help").code, 0)


def wrong_usage_is_exit_2(cli):
    cli.refused(2, "did you mean '--tau'", "--tua", "2")
    cli.refused(2, "did you mean '--method'", "snapshot", "--metod", "brute")
    cli.refused(2, "did you mean 'hybrid'", "snapshot", "-o", "x.png", "--method", "hybird")
    cli.refused(2, "did you mean 'overfly snapshot'", "snapshoot")
    cli.refused(2, "unexpected argument", "config", "fly", "again")
    cli.refused(2, "-o FILE.png", "snapshot")
    cli.refused(2, "ends in .png", "snapshot", "-o", "x.jpg")
    cli.refused(2, "ends in .png", "fly", "--no-window", "--frames", "1", "--screenshot", "picture")
    cli.refused(2, "a value is missing", "fly", "--tau")
    cli.refused(2, "not to this subcommand; it is one of mesh", "fly", "--cull")
    cli.refused(2, "option '--no-assist' is known, but not to this subcommand; it is one of fly, demo", "mesh", "--no-assist")
    cli.refused(2, "--idle: expected a number of seconds, from 1 to 86400; found '1m'", "demo", "list", "--idle", "1m")
    cli.refused(2, "to fly it again: overfly replay day.igc", "fly", "day.igc")
    cli.refused(2, "--verify draws nothing: expected no --video", "replay", "none.ofr", "--verify", "--video", "x.mp4")
    cli.refused(2, "OVERFLY_FOV", "fly", "--no-window", "--frames", "1", OVERFLY_FOV="wide")


def a_wrong_kind_of_errors_is_told_the_right_ones(cli):
    """Where only the number is wrong, its range is all there is to say."""
    said = "error: --error: expected one of midpoint, total, total:N with N a power of two from 1 to 1024; found "
    alone = ("total:0", "total:3", "total:2048", "total:", "total:x", "total:N", "nonsense")
    meant = {"totl": "total", "totl:8": "total:N", "midpiont": "midpoint"}
    for kind in (*alone, *meant):
        run = cli.run("mesh", DEM, "--error", kind)
        expect(f"{kind}: exit status", run.code, 2)
        expect(f"{kind}: stdout", run.out, "")
        hint = f"; did you mean '{meant[kind]}'?" if kind in meant else ""
        expect(f"{kind}: stderr", run.err, f"{said}'{kind}'{hint}\n")


def options_may_come_before_the_subcommand(cli):
    """Values of options are no subcommands; what follows the subcommand is read as ever."""
    for leading in (["-q"], ["-q", "--json"], ["--tau", "2", "-qv"], ["--tau=2"], ["-t2"], ["--no-quiet"]):
        run = cli.run(*leading, "config", "snapshot")
        expect(f"exit status of {leading}", run.code, 0)
        expect_in(f"config after {leading}", "wireframe", run.out)
    cli.refused(2, "-o FILE.png", "-q", "snapshot")
    cli.refused(2, "unexpected argument", "-q", "config", "fly", "again")
    cli.refused(2, "not to this subcommand; it is one of mesh", "--cull", "snapshot", "-o", "x.png")
    cli.refused(2, "neither a file nor a subcommand", "--no-window", "--frames", "1", "--", "mesh")
    cli.refused(2, "ends in .png", "--output", "mesh", "snapshot")


def a_file_of_settings_has_a_section_for_each_subcommand(cli):
    cli.write("config/overfly/overfly.conf", "".join(f"[{name}]\nquiet = yes\n" for name in SUBCOMMANDS))
    run = cli.run("config", "devices")
    expect(f"exit status, having said {run.err!r}", run.code, 0)
    expect_in("quiet of devices", f"overfly.conf:{2 * SUBCOMMANDS.index('devices') + 2}", run.out)


def a_damaged_file_is_named_with_its_line(cli):
    path = cli.write("config/overfly/overfly.conf", "# mine\ntau = 2\nfov = wide\n")
    cli.refused(2, f"{path}:3: fov: expected an angle", "snapshot", "-o", "x.png")


def sources_win_in_order(cli):
    cli.write("config/overfly/overfly.conf", "tau = 3\nfov = 50\nsize = 640x480\n")
    rows = cli.json("config", "--tau", "5", OVERFLY_TAU="4", OVERFLY_FOV="40")["options"]
    options = {row["name"]: row for row in rows}
    expect("tau", (options["tau"]["value"], options["tau"]["source"]), ("5", "command line"))
    expect("fov", (options["fov"]["value"], options["fov"]["source"]), ("40", "environment"))
    expect("size", (options["size"]["value"], options["size"]["source"]), ("640x480", "file"))
    expect_in("size", "overfly.conf:3", options["size"]["where"])
    expect("method", (options["method"]["value"], options["method"]["source"]), ("hybrid", "default"))


def missing_files_are_named(cli):
    cli.refused(1, "nowhere.tif", "snapshot", "nowhere.tif", "-o", "x.png")
    cli.refused(1, "nowhere.scene", "snapshot", "nowhere.scene", "-o", "x.png")
    cli.refused(1, "nowhere.pgm", "snapshot", "--geoid", "nowhere.pgm", "-o", "x.png")
    scene = cli.write("lost.scene", "[terrain]\ndem = gone.tif\n")
    cli.refused(1, "gone.tif", "snapshot", scene, "-o", "x.png")
    scene = cli.write("odd.scene", "[terrain]\nden = gone.tif\n")
    cli.refused(1, f"{scene}:2:", "snapshot", scene, "-o", "x.png")


def folders_for_pictures_are_looked_at_before_the_work(cli):
    """No word of an elevation model that is not there either: it would have been opened next."""
    cli.write("plain", "")
    lost = ["nowhere.tif", "--no-window", "--frames", "1"]
    cli.refused(1, "mkdir -p 'nowhere'", "snapshot", "nowhere.tif", "-o", "nowhere/x.png")
    cli.refused(1, "plain: is a file, not a folder", "snapshot", "nowhere.tif", "-o", "plain/x.png")
    cli.refused(1, "mkdir -p 'nowhere'", "fly", *lost, "--screenshot", "nowhere/x.png")
    cli.refused(1, "plain: is a file, not a folder", "fly", *lost, "--pictures", "plain")
    cli.refused(1, "no file can be made in it", "fly", *lost, "--pictures", "/proc")
    cli.refused(1, "nowhere.tif", "fly", *lost, "--screenshot", "x.png", "--pictures", "made")
    cli.refused(1, "mkdir -p 'nowhere'", "replay", "lost.igc", *lost, "--video", "nowhere/x.mp4")
    cli.refused(1, "mkdir -p 'nowhere'", "fly", *lost, "--record", "nowhere/x.ofr")
    cli.refused(1, "mkdir -p 'nowhere'", "fly", *lost, "--telemetry", "nowhere/x.csv")


def files_of_other_kinds_are_not_written_over(cli):
    fly = ["fly", "nowhere.tif", "--no-window", "--frames", "1"]
    notes = cli.write("notes.csv", "t_s,what\n0,words\n")
    plain = cli.write("plain.ofr", "no recording")
    cli.refused(2, "ends in .ofr; found 'notes.csv'", *fly, "--record", "notes.csv")
    cli.refused(2, "no recording of this program", *fly, "--record", "plain.ofr")
    cli.refused(2, "no telemetry of this program", *fly, "--telemetry", "notes.csv")
    cli.refused(2, ".ofr are of recordings", *fly, "--record", "new.ofr", "--telemetry", "./new.ofr")
    cli.refused(2, "./notes.csv is a file that is read", "replay", "notes.csv", "--telemetry", "./notes.csv")
    cli.refused(2, "--record: a value is missing", *fly, "--record", "--no-window")
    for path, text in ((notes, "t_s,what\n0,words\n"), (plain, "no recording")):
        with open(path, encoding="utf-8") as file:
            expect(f"{path} as it was", file.read(), text)
    run = ["fly", *SMALL, "--no-window", "--demo", "--frames", "2", "--telemetry"]
    for _ in range(2):
        cli.json(*run, "own.csv")


def nothing_is_written_over_what_is_read(cli):
    """By whatever name: of a link, in a scene, in a folder of pictures or of a report."""
    window = ["--no-window", "--frames", "1"]
    cli.write_picture("red.png")
    os.link(cli.path("red.png"), cli.path("same.png"))
    os.mkdir(cli.path("out"))
    os.link(cli.path("red.png"), cli.path("out/overfly-001.png"))
    flight = cli.write("out/flight-a.csv", "t_s,lat_deg,lon_deg,alt_m\n0,36.58,-84.24,1500\n1,36.581,-84.24,1500\n")
    os.link(flight, cli.path("flight.mp4"))
    os.symlink(DEM, cli.path("mesh.obj"))
    os.symlink(DEM, cli.path("out/ye.tif"))
    scene = cli.write("own.scene", f"[terrain]\ndem = {DEM}\nimage = red.png\n[demo]\nfile = own.demo\n")
    demo = cli.write("own.demo", "to 36.58,-84.24,1500m 100m/s\n")
    before = {name: os.stat(cli.path(name)).st_mtime_ns for name in ("red.png", "own.demo", "own.scene", "out/flight-a.csv")}
    for said, command in ((("--output", "red.png"), ["snapshot", "-o", "same.png", "--image", "red.png"]),
                          (("--output", "red.png"), ["snapshot", "-o", "same.png", scene]),
                          (("--screenshot", "same.png"), ["fly", *window, "--image", "same.png", "--screenshot", "./red.png"]),
                          (("--screenshot", "red.png"), ["demo", demo, scene, *window, "--screenshot", "same.png"]),
                          (("--pictures", "out/overfly-001.png"),
                           ["fly", *window, "--image", "out/overfly-001.png", "--pictures", "out"]),
                          (("--telemetry", "own.demo"), ["demo", "own.demo", *window, "--telemetry", demo]),
                          (("--telemetry", "own.demo"), ["fly", scene, *window, "--telemetry", "own.demo"]),
                          (("--telemetry", "own.scene"), ["fly", scene, *window, "--telemetry", "own.scene"]),
                          (("--video", "flight-a.csv"), ["replay", flight, "--video", "flight.mp4"]),
                          (("--output", DEM), ["mesh", DEM, "-o", "mesh.obj"]),
                          (("--output", flight), ["bench", "--track", f"valley,{flight}", "-o", "out"]),
                          (("--output", "out/ye.tif"), ["reproduce", "ye", "out/ye.tif", "-o", "out"])):
        cli.refused(2, [*said, "read", "name another"], *command)
    for name, time in before.items():
        expect(f"{name} as it was", os.stat(cli.path(name)).st_mtime_ns, time)
    cli.refused(1, "nowhere.tif", "fly", "nowhere.tif", *window, "--image", "out/ye.tif", "--pictures", "out")


def options_that_change_nothing_are_told(cli):
    demo = ["demo", "round", *SMALL, "--no-window", "--frames", "1", "--tau", "8"]
    cli.warned("--idle changes nothing without --kiosk", *demo, "--idle", "9")
    cli.write("short.csv", "t_s,lat_deg,lon_deg,alt_m\n0,36.58,-84.24,1500\n1,36.581,-84.24,1500\n")
    cli.warned("--every changes nothing without --pictures", "replay", "short.csv", *SMALL, "--no-window", "--frames", "1", "--every",
               "2")
    cli.refused(2, "demo list: expected nothing more; found 'extra'", "demo", "list", "extra")


def a_track_of_another_land_is_told_and_tells_no_more_than_a_path(cli):
    cli.write("far.csv", "t_s,lat_deg,lon_deg,alt_m\n0,46.5,8.1,1500\n1,46.501,8.1,1500\n")
    cli.warned("far.csv: the flight is nowhere over this land, it begins at 46.5000, 8.1000", "replay", "far.csv", *SMALL,
               "--no-window", "--frames", "1", "--tau", "8", "--telemetry", "out.csv")
    with open(cli.path("out.csv"), encoding="utf-8") as file:
        line = list(csv.DictReader(file))[0]
    told = [name for name, value in line.items() if value]
    expect("what is told", told, ["t_s", "lat_deg", "lon_deg", "alt_m", "heading_deg", "pitch_deg", "bank_deg",
                                  "vertical_speed_m_s"])


def a_wrong_image_is_refused_in_one_message(cli):
    snapshot = ["snapshot", *SMALL, "-o", "x.png", "--image"]
    text = cli.write("notes/words.txt", "these are words\n" * 20)
    cli.write_picture("red.png")
    cli.refused(1, "nofile.png: No such file or directory; check the path", *snapshot, "nofile.png")
    cli.refused(1, f"{text}: cannot be opened as an image", *snapshot, text)
    cli.refused(1, "red.png: a picture without a georeference of its own", *snapshot, "red.png")
    half = cli.write("half.tif", "II*")
    cli.refused(1, f"{half}: cannot be opened as an image", *snapshot, half)
    cli.refused(2, "WEST,SOUTH,EAST,NORTH", *snapshot, "red.png", "--image-bounds=3,0,3,0")
    expect("a picture all the same", os.path.exists(cli.path("x.png")), False)


def image_bounds_without_an_image_are_wrong_usage(cli):
    bounds = "--image-bounds=-85,36,-84,37"
    cli.refused(2, "--image FILE", "snapshot", *SMALL, "-o", "x.png", bounds)
    cli.refused(2, "--image FILE", "fly", "--no-window", "--frames", "1", bounds)


def an_image_beside_the_terrain_is_warned_of(cli):
    cli.write_picture("red.png")
    snapshot = ["snapshot", *SMALL, "-o", "x.png", "--image", "red.png"]
    cli.warned("red.png: the picture lies beside the terrain", *snapshot, "--image-bounds=10,45,11,46")
    run = cli.run(*snapshot, "--image-bounds=-84.21,36.51,-84.209,36.511")
    expect("exit status of a small picture on the terrain", run.code, 0)
    expect("what it says", "beside" in run.err, False)


def an_eye_under_the_ground_is_warned_of(cli):
    for command in (["snapshot", *SMALL, "-o", "x.png"], ["mesh"]):
        cli.warned("m under the ground", *command, "--eye", "36.58,-84.24,100", "--look", "60,-5")
        run = cli.run(*command, "--eye", "36.58,-84.24,1500", "--look", "60,-5")
        expect(f"warned of above the ground: {run.err!r}", "under the ground" in run.err, False)


def a_start_that_cannot_be_is_told(cli):
    fly = ["fly", *SMALL, "--no-window", "--frames", "1"]
    cli.refused(2, ["--speed: an aircraft that starts standing", "(--on-ground)"], *fly, "--on-ground", "--speed", "90kt")
    cli.refused(2, "OVERFLY_SPEED: an aircraft that starts standing", *fly, "--on-ground", OVERFLY_SPEED="90kt")
    cli.refused(2, "--no-trim: an aircraft that starts standing", *fly, "--on-ground", "--no-trim")
    cli.write_picture("meadow.png", b"\x80\x64\0", 9)  # 100 m high
    run = cli.run("fly", "meadow.png", "--bounds=10,47,10.01,47.006", *SMALL, "--no-window", "--frames", "1", "--on-ground")
    expect_in("on a meadow", "the land near the start is too small for the 1187 m", run.err)
    cli.warned("--eye: 100 m is 618 m under the ground there: the flight starts 60 m above it, at 778 m", *fly, "--eye",
               "36.58,-84.24,100")


def missing_files_are_named_before_a_window_is_wanted(cli):
    cli.refused(1, "wrong.tif: No such file or directory", "fly", "wrong.tif")
    cli.refused(1, "wrong.png: No such file or directory", "fly", "--image", "wrong.png")
    scene = cli.write("lost.scene", "[terrain]\ndem = gone.tif\n")
    cli.refused(1, "gone.tif", "fly", scene)


def info_names_every_file(cli):
    for name in ("N10E020.hgt", "N10E021.hgt"):
        cli.write_tile(name, 1201)
    report = cli.json("info", "N10E020.hgt", "N10E021.hgt")
    expect("file", report["file"], "N10E020.hgt")
    expect("files", report["files"], ["N10E020.hgt", "N10E021.hgt"])
    expect("files of a folder", cli.json("info", ".")["files"], ["./N10E020.hgt", "./N10E021.hgt"])
    run = cli.run("info", "N10E020.hgt", "N10E021.hgt")
    expect("what is said of neighbours", run.err.count("warning"), 0)


def overlapping_files_are_warned_of(cli):
    cli.write_tile("N10E020.hgt", 1201)
    cli.warned("N10E020.hgt: given more than once", "info", "N10E020.hgt", "N10E020.hgt")
    cli.warned("N10E020.hgt and ./N10E020.hgt overlap", "info", "N10E020.hgt", "./N10E020.hgt")


def paths_of_a_scene_are_written_plainly(cli):
    path = cli.json("mesh", "--tau", "100")["dem"]
    expect("..  in " + path, ".." in path, False)
    expect("exists", os.path.exists(path), True)
    cli.write("scenes/here.scene", f"[terrain]\ndem = ../{os.path.relpath(DEM, cli.path(''))}\n")
    expect("from a scene elsewhere", cli.json("mesh", "scenes/here.scene", "--tau", "100")["dem"],
           os.path.realpath(DEM))


def a_budget_below_the_smallest_mesh_says_so(cli):
    run = cli.run("mesh", DEM, "--tau", "0.01", "--max-triangles", "1000", "--method", "hybrid", "--json")
    expect(f"exit status, having said {run.err!r}", run.code, 0)
    triangles = json.loads(run.out)["triangles"]
    if triangles <= 1000:
        expect_in("a budget that holds", "px hold instead", run.err)
    else:
        expect_in("a budget that cannot hold", f"smallest mesh of this terrain, {triangles} triangles", run.err)
    text = cli.run("mesh", DEM, "--tau", "0.01", "--max-triangles", "1000", "--method", "hybrid")
    expect(f"an error of 1e12 px in {text.err!r} and {text.out!r}", "e+12" in text.err + text.out, False)


def brute_keeps_the_budget_in_flight_only(cli):
    options = DEM, "--method", "brute", "--max-triangles", "1000"
    triangles = cli.json("mesh", *options)["triangles"]
    expect("a mesh of every sample", triangles > 1000, True)
    run = cli.run("fly", *options, "--no-window", "--frames", "1")
    expect(f"exit status of the flight, having said {run.err!r}", run.code, 1)
    expect_in("the flight's message", f"{triangles} triangles, more than --max-triangles 1000", run.err)


def partitions_draw_the_serial_triangles(cli):
    report = cli.json("bench", "partitions", DEM, "--vertices", "5000", "--frames", "4", "--threads", "2")
    expect("surplus", report["surplus_share"], 0)
    expect("partitions", report["partitions"], 4)
    vertices = report["roam"]["vertices_mean"]
    expect(f"about 5000 vertices, found {vertices}", 4000 < vertices < 6000, True)
    given = cli.json("bench", "partitions", DEM, "--tau", "30", "--frames", "2")
    expect("the tolerance that was given", given["tau_px"], 30)


def a_snapshot_is_the_same_each_time(cli):
    for name in ("a.png", "b.png"):
        report = cli.json("snapshot", *SMALL, "-o", name)
        expect_in("log", f"{name}: hybrid, ", cli.run("snapshot", *SMALL, "-o", name).err)
        expect("eye", len(report["eye"]), 3)
        if report["triangles"] < 100:
            raise Fault(f"only {report['triangles']} triangles")
    expect("picture", cli.digest("b.png"), cli.digest("a.png"))


def a_target_and_lockstep_exclude_one_another(cli):
    cli.refused(2, "--target-ms and --lockstep", "fly", "--no-window", "--frames", "2", "--lockstep", "--target-ms", "20")
    for value in ("0", "0.5", "1001", "-16", "fast", "nan"):
        cli.refused(2, "--target-ms", "fly", "--no-window", "--frames", "2", f"--target-ms={value}")


def a_governed_flight_tells_its_target(cli):
    plain = cli.json("fly", *SMALL, "--no-window", "--frames", "5", "--tau", "2")
    expect("fields without a target", [name for name in ("target_ms", "governed") if name in plain], [])
    report = cli.json("fly", *SMALL, "--no-window", "--frames", "40", "--tau", "2", "--target-ms", "25")
    expect("target", report["target_ms"], 25)
    if not 0.1 <= report["tau_px"] <= 64:
        raise Fault(f"tau {report['tau_px']}")
    expect("fields", sorted(report["governed"]), ["changes", "changes_settled", "reach", "reachable", "settled"])
    if not report["software"]:
        return
    run = cli.run("fly", "--size", "640x400", "--no-window", "--frames", "200", "--tau", "32", "--target-ms", "1", "--json")
    slow = json.loads(run.out)
    expect("1 ms a frame", (slow["governed"]["reach"], slow["tau_px"]), ("too slow", 64))
    if slow["frames"] * slow["frame_ms"]["mean"] > 3000:  # for so long that it is worth a word
        expect(f"warnings in {run.err!r}", run.err.count("warning: --target-ms 1: even the coarsest tolerance"), 1)


def the_governor_is_measured(cli):
    report = cli.json("bench", "governor", *SMALL, "--frames", "60", "--target-ms", "15", "--max-triangles", "20000")
    expect("target", (report["target_ms"], report["target_picked"]), (15, False))
    for part in ("ridge", "fixed"):
        for name in ("frame_ms", "p95_over_target", "within_15_percent", "reachable", "reach", "tau_px", "reversals"):
            if name not in report[part]:
                raise Fault(f"{part}: no {name}")
        over = report[part]["p95_over_target"]
        if report[part]["reachable"] and not over <= 1.15:
            raise Fault(f"{part}: called reachable with {over} of the target")
    expect("changes of a view that stands", report["fixed"]["changes_settled"], 0)


def two_methods_are_reported_side_by_side(cli):
    view = ["--size", "640x360", "--eye", "36.50,-84.20,1200m", "--look", "60,0"]
    picture = ["snapshot", *view, "--compare", "brute", "-o", cli.path("two.png")]
    report = json.loads(cli.run(*picture, "--json").out)
    expect("left", report["method"], "hybrid")
    expect("right", report["right"]["method"], "brute")
    if not report["triangles"] < report["right"]["triangles"]:
        raise Fault(f"expected fewer triangles than brute's, found {report}")
    said = cli.run(*picture).err
    expect_in("what was written", "two.png: two methods side by side", said)
    expect_in("log", "left: hybrid, ", said)
    expect_in("log", "right: brute, ", said)
    flight = ["fly", "--no-window", "--frames", "2", *view, "--method", "brute", "--compare", "hybrid", "--json"]
    for more in ([], ["--lockstep"]):
        report = json.loads(cli.run(*flight, *more).out)
        expect("methods", (report["method"], report["right"]["method"]), ("brute", "hybrid"))
        expect("frames with both", report["frames_compared"], report["frames"])
        expect("frames by method", report["frames_by_method"], {"brute": report["frames"], "hybrid": report["frames"]})


def the_panel_of_accuracy_tells_what_it_measured(cli):
    for more in (["--lockstep"], ["--compare", "geomipmap"]):
        for frames in ("120", "800"):  # a busy machine has little time for what runs at the lowest priority
            report = cli.json("fly", "--size", "640x400", "--no-window", "--demo", "--accuracy", "--frames", frames, *more)
            panel = report["accuracy"]
            measured = panel["measured"]
            if measured["state"] != "not yet":
                break
        expect("state", measured["state"], "measured")
        if not 0.0 < measured["p999_px"] <= measured["max_px"] <= measured["promised_px"] == 1.0:
            raise Fault(f"{more}: expected errors up to the promised 1 px, found {measured}")
        expect("cracks and samples above", (measured["cracks"], measured["above_tau_share"]), (0, 0))
        flown = [point for point in panel["curve"] if point["flown"]]
        expect("flown", [round(point["tau_px"], 6) for point in flown], [1.0])
        if not all(point["least_ms"] <= point["most_ms"] for point in panel["curve"] if not point["flown"]):
            raise Fault(f"{more}: bounds out of order in {panel['curve']}")
        if not 0 < panel["p50"] <= panel["p99"] or not panel["stack"]["draw_ms"] > 0:
            raise Fault(f"{more}: expected times, found {panel}")
    report = cli.json("fly", *SMALL, "--no-window", "--demo", "--frames", "3")
    expect("without the panel", ("accuracy" in report, report["accuracy_panel"]), (False, False))


def the_cost_of_the_panel_is_measured(cli):
    report = cli.json("bench", "panel", *SMALL, "--frames", "4", "--rounds", "5")
    expect("rounds and frames", (report["rounds"], report["frames"], report["limit_share"]), (5, 4, 0.03))
    for name in ("cost_share", "processor_share"):
        share = report[name]
        low, high = share["median_95"]
        if not share["min"] <= low <= share["median"] <= high <= share["max"]:
            raise Fault(f"expected a spread, found {share}")
    low, high = report["cost_share"]["median_95"]
    expect("the limit", report["limit"], "met" if high <= 0.03 else "missed" if low > 0.03 else "undecided")
    # Four times a second and in every twelfth frame at most; of 40 here.
    if not 0 <= report["painted_share"] <= 0.25:
        raise Fault(f"painted in {report['painted_share']} of the frames")
    if not report["frame_ms_without"]["p50"] > 0 or not report["frame_ms_with"]["p50"] > 0:
        raise Fault(f"expected times, found {report}")


def the_corner_bound_holds_in_flight_too(cli):
    """As many triangles as the picture of the same view, whose refinement the mesh's tests measure; halves too."""
    view = ["--size", "640x360", "--eye", "36.50,-84.20,1200m", "--look", "60,0", "--tau", "2", "--json"]
    found = {}
    for bound in ("centre", "corner"):
        for more in ([], ["--compare", "brute"]):
            snapshot = json.loads(cli.run("snapshot", *view, "--bound", bound, *more, "-o", cli.path("x.png")).out)
            flight = json.loads(cli.run("fly", "--no-window", "--lockstep", "--frames", "1", *view, "--bound", bound,
                                        *more).out)
            if abs(flight["triangles"] / snapshot["triangles"] - 1.0) > 0.01:
                raise Fault(f"{bound} {more}: {flight['triangles']} in flight, {snapshot['triangles']} in a picture")
        found[bound] = flight["triangles"]
    if not found["corner"] > 1.2 * found["centre"]:
        raise Fault(f"expected more triangles for the corners, found {found}")


def a_flight_repeats_in_lockstep(cli):
    def fly(name, *options):
        report = cli.json("fly", *SMALL, "--no-window", "--lockstep", "--demo", "--no-hud", "--frames", "30", "--screenshot",
                          name, *options)
        expect("frames", report["frames"], 30)
        return cli.digest(name), report["lat_deg"], report["lon_deg"], report["alt_m"], report["heading_deg"]

    first = fly("a.png")
    expect("the same flight again", fly("b.png"), first)
    expect("with one worker", fly("c.png", "--threads", "1"), first)
    expect("with three workers and five partitions", fly("d.png", "--threads", "3", "--partitions", "5"), first)


def overlapped_stages_draw_what_lockstep_draws(cli):
    def fly(name, *options):
        cli.json("fly", *SMALL, "--no-window", "--demo", "--no-hud", "--frames", "30", "--screenshot", name, *options)
        return cli.digest(name)

    expect("picture", fly("a.png"), fly("b.png", "--lockstep"))


def pictures_are_spread_over_the_flight(cli):
    report = cli.json("fly", *SMALL, "--no-window", "--demo", "--frames", "20", "--pictures", "new/folder",
                      "--picture-count", "4")
    expect("frames", report["frames"], 20)
    expect("pictures", sorted(os.listdir(cli.path("new/folder"))), [f"overfly-00{i}.png" for i in range(1, 5)])
    cli.json("fly", *SMALL, "--no-window", "--lockstep", "--frames", "3", "--pictures", "few")
    expect("pictures of fewer frames", sorted(os.listdir(cli.path("few"))), [f"overfly-00{i}.png" for i in range(1, 4)])


def without_a_display_it_says_how_to_get_a_window(cli):
    run = cli.run("fly")
    expect(f"exit status, having said {run.err!r}", run.code, 1)
    expect_in("message", "xvfb-run", run.err)
    expect_in("message", "--no-window", run.err)
    run = cli.run("fly", *SMALL, "--frames", "3", "--json")
    expect(f"exit status with --frames, having said {run.err!r}", run.code, 0)
    expect("window", json.loads(run.out)["window"], False)
    expect_in("message with --frames", "flying on without a window", run.err)
    expect_in("message with --frames", "warning: no display to open a window on", run.err)
    expect(f"errors of a flight that goes on: {run.err!r}", run.err.count("error: "), 0)
    expect("what to do for a window, where it isn't missed", run.err.count("xvfb-run"), 0)


def an_old_opengl_is_named_beside_what_is_needed(cli):
    run = cli.run("snapshot", *SMALL, "-o", "old.png", MESA_GL_VERSION_OVERRIDE="3.3")
    if run.code == 0:
        return  # not Mesa: the variable does nothing
    expect(f"exit status, having said {run.err!r}", run.code, 1)
    expect_in("what was found", "3.3", run.err)
    expect_in("what is needed", "4.5", run.err)
    expect("a picture all the same", os.path.exists(cli.path("old.png")), False)


def signals_end_a_flight_cleanly(cli):
    for name in ("SIGINT", "SIGTERM"):
        process = cli.start("fly", *SMALL, "--no-window", "--json", "--pictures", "begun", "--picture-count", "1")
        begin = time.time()
        while not os.path.exists(cli.path("begun/overfly-001.png")) and time.time() - begin < 60:
            time.sleep(0.05)
        process.send_signal(getattr(signal, name))
        out, err = process.communicate(timeout=60)
        expect(f"exit status after {name}, having said {err!r}", process.returncode, 0)
        if json.loads(out)["frames"] < 1:
            raise Fault(f"no frame before {name}")
        os.remove(cli.path("begun/overfly-001.png"))


def a_flight_starts_in_the_air_wherever_it_is_asked_to(cli):
    report = cli.json("fly", *SMALL, "--no-window", "--lockstep", "--frames", "5", "--eye", "36.6,-84.2,-3000", "--look",
                      "90,0", "--speed", "160kt")
    if report["above_ground_m"] < 30:
        raise Fault(f"{report['above_ground_m']} m above the ground")
    if abs(report["speed_m_s"] - 82.3) > 1 or abs(report["heading_deg"] - 90) > 1:
        raise Fault(f"{report['speed_m_s']} m/s towards {report['heading_deg']}")
    report = cli.json("fly", *SMALL, "--no-window", "--lockstep", "--frames", "60", "--speed", "10000", "--eye",
                      "36.6,-84.2,9000")
    expect("crashes", report["crashes"], 0)
    for name in ("lat_deg", "lon_deg", "alt_m", "speed_m_s"):
        if not isinstance(report[name], float):
            raise Fault(f"{name} is {report[name]!r} after a second at 10 km/s")


def a_flight_may_start_on_the_ground(cli):
    for name in ("c172", "t37", "ask21"):
        report = cli.json("fly", *SMALL, "--no-window", "--lockstep", "--frames", "30", "--on-ground", "--aircraft", name)
        expect(f"contact of {name}", report["contact"], "rolling")
        expect(f"aircraft of {name}", report["aircraft"], name)
        if not report["above_ground_m"] < 2.0 or not report["speed_m_s"] < 3.0 or not report["throttle"] < 0.01:
            raise Fault(f"{name}: {report['above_ground_m']} m above the ground, {report['speed_m_s']} m/s, throttle "
                        f"{report['throttle']}")



def an_aircraft_is_chosen_by_name_or_file(cli):
    nowhere = ["nowhere.tif", "--no-window", "--frames", "1"]  # which would be told next
    cli.refused(1, "--aircraft: expected the file of an aircraft (.aircraft), or one of ask21, c172, t37; found 'c127'; did "
                "you mean 'c172'?", "fly", *nowhere, "--aircraft", "c127")
    cli.refused(1, "found 'rond'; did you mean 'round'?", "demo", "rond", *nowhere)
    own = cli.write("own.aircraft", "[mass]\nmas = 3\n")
    cli.refused(1, "own.aircraft:2: an aircraft has no 'mas' in [mass]; did you mean 'mass'?", "fly", "--no-window",
                "--frames", "1", "--aircraft", own)
    cli.refused(1, "own.aircraft:2", "aircraft", own)
    names = [aircraft["name"] for aircraft in cli.json("aircraft")["aircraft"]]
    expect("aircraft", names, ["ask21", "c172", "t37"])
    steady = cli.json("fly", *SMALL, "--no-window", "--lockstep", "--frames", "120", "--aircraft", "c172")
    loose = cli.json("fly", *SMALL, "--no-window", "--lockstep", "--frames", "120", "--aircraft", "c172", "--no-trim",
                     "--no-assist")
    if not abs(steady["vertical_speed_m_s"]) < 0.05 < abs(loose["vertical_speed_m_s"]):
        raise Fault(f"{steady['vertical_speed_m_s']} m/s up in trim, {loose['vertical_speed_m_s']} without")


def the_table_of_aircraft_is_the_documented_one(cli):
    def figure(value):
        return "" if value is None else f"{value:.4f}" if abs(value) < 1 else f"{value:.2f}"

    with open(os.path.join(os.path.dirname(__file__), "..", "docs", "aircraft.md"), encoding="utf-8") as page:
        text = page.read()
    for aircraft in cli.json("aircraft", "t37", "c172", "ask21")["aircraft"]:
        for row in aircraft["rows"]:
            unit = f", {row['unit']}" if row["unit"] else ""
            figures = " | ".join(figure(row[name]) for name in ("theory", "simulation", "published"))
            expect_in("docs/aircraft.md", f"| {aircraft['name']}: {row['name'].strip()}{unit} | {figures} |", text)


FLIGHT = ("AXXX001\r\nHFDTE010624\r\nHFALG:GEO\r\n" +
          "".join(f"B12{i // 60:02}{i % 60:02}46{30000 + 15 * i:05}N00800000EA00000{1500 + i:05}\r\n" for i in range(90) if i != 30))


def flights_are_converted(cli):
    cli.write("a.igc", FLIGHT)
    for ending in ("gpx", "kml", "acmi", "csv", "igc"):
        report = cli.json("convert", "a.igc", f"b.{ending}")
        for name, wanted in (("format", "igc"), ("points", 89), ("gaps", 0), ("duration_s", 89), ("heights", "geoid"),
                             ("attitude", "derived"), ("start_utc", "2024-06-01T12:00:00Z"), ("output_format", ending)):
            expect(f"{ending}: {name}", report[name], wanted)
        back = cli.json("convert", f"b.{ending}", f"c-{ending}.csv")
        for name in ("points", "gaps", "duration_s", "start_utc", "attitude"):
            expect(f"{ending}: {name} read again", back[name], report[name])
    for name, said in (("--aircraft", "--aircraft changes nothing: a.igc is IGC flight log; only a recording"),
                       ("--object", "--object changes nothing: a.igc is IGC flight log")):
        cli.warned(said, "convert", "a.igc", "b.gpx", name, "c172")
    cli.warned("--igc-alt changes nothing: b.gpx is GPX 1.1", "convert", "b.gpx", "c.kml", "--igc-alt", "geoid")
    cli.write("one.csv", "t_s,lat_deg,lon_deg,alt_m,unix_s\n0,46,8,1,1717243200\n1,46,8,x")
    said = cli.run("convert", "one.csv", "b.gpx").out
    expect_in("convert one.csv", "flight    1 point, ", said)
    expect_in("convert one.csv", "left out  1 point damaged", said)
    expect("pressure", cli.json("convert", "a.igc", "b.igc")["output_pressure"], False)
    expect_in("convert", "left out  pressure altitudes: none are known", cli.run("convert", "a.igc", "b.igc").out)
    text = cli.run("convert", "a.igc", "b.gpx").out
    for part in ("89 points, 89 s, from 2024-06-01T12:00:00Z", "above the geoid", "derived from the path", "has no attitude"):
        expect_in("convert", part, text)


def a_conversion_has_its_points_as_far_apart_as_asked(cli):
    cli.write("a.igc", FLIGHT)
    for interval, points in (("10", 10), ("0.5", 179), ("1000", 2)):
        report = cli.json("convert", "a.igc", "b.csv", "--interval", interval)
        expect(f"--interval {interval}", (report["points"], report["duration_s"]), (points, 89))
    cli.warned("--interval 0.5: an IGC file has whole seconds", "convert", "a.igc", "b.igc", "--interval", "0.5")


def conversions_that_cannot_be_are_refused(cli):
    cli.write("a.igc", FLIGHT)
    cli.write("still.csv", "t_s,lat_deg,lon_deg,alt_m\n0,46,8,1\n1,46,8,1\n")
    os.symlink("a.igc", cli.path("link.igc"))
    before = sorted(os.listdir(cli.folder))
    cli.refused(2, "expected two files", "convert", "a.igc")
    cli.refused(2, "expected a name that ends with one of .igc, .gpx, .kml, .acmi, .csv", "convert", "a.igc", "b.txt")
    cli.refused(2, "link.igc is a file that is read, a.igc", "convert", "a.igc", "link.igc")
    cli.refused(2, "give it one: --start", "convert", "still.csv", "b.gpx")
    cli.refused(2, "--start: found 'noon'", "convert", "still.csv", "b.gpx", "--start", "noon")
    cli.refused(2, "--igc-alt", "convert", "a.igc", "b.gpx", "--igc-alt", "msl")
    cli.refused(1, "missing.igc", "convert", "missing.igc", "b.gpx")
    cli.refused(1, "missing.igc", "convert", "missing.igc", "b.txt")  # what is read comes first
    cli.refused(1, "a folder", "convert", ".", "b.gpx")
    cli.refused(1, "cannot be written", "convert", "a.igc", os.path.join("nowhere", "b.gpx"))
    cli.refused(1, "no-geoid.pgm", "convert", "a.igc", "b.gpx", "--geoid", "no-geoid.pgm")
    expect("files", sorted(os.listdir(cli.folder)), before)
    if os.path.exists("/dev/full"):
        os.symlink("/dev/full", cli.path("full.gpx"))
        cli.refused(1, "No space left", "convert", "a.igc", "full.gpx")


def a_flight_without_a_date_is_given_one(cli):
    cli.write("still.csv", "t_s,lat_deg,lon_deg,alt_m\n0,46,8,1\n1,46,8,1\n")
    report = cli.json("convert", "still.csv", "b.kml", "--start", "2024-06-01T12:00:00Z")
    expect("start", report["start_utc"], "2024-06-01T12:00:00Z")
    expect("start in the file", cli.json("convert", "b.kml", "c.csv")["start_utc"], "2024-06-01T12:00:00Z")


def a_pipe_is_not_waited_for(cli):
    os.mkfifo(cli.path("pipe.igc"))
    cli.refused(1, "no regular file", "convert", "pipe.igc", "b.gpx")


def a_full_disk_is_an_error(cli):
    if not os.path.exists("/dev/full"):
        return
    with open("/dev/full", "w", encoding="utf-8") as full:
        process = subprocess.run([cli.program, "config", "--json"], stdout=full, stderr=subprocess.PIPE, text=True,
                                 env=cli.environment, check=False)
    expect("exit status", process.returncode, 1)
    expect_in("message", "stdout", process.stderr)


RECORDED = ["--size", "64x48", "--no-window", "--demo", "--frames", "30", "--time-rate", "16"]
RECORDED_STEPS = 30 * 32  # 8 s


def record(cli, name, *options):
    report = cli.json("fly", *RECORDED, "--record", name, *options)
    expect("frames", report["frames"], 30)
    return cli.path(name)


def change_bytes(path, offset, data):
    with open(path, "r+b") as file:
        file.seek(offset)
        file.write(data)


def a_recorded_flight_is_flown_again(cli):
    hashes = set()
    for name, recording, replaying in (("a.ofr", [], []), ("b.ofr", ["--threads", "1", "--method", "roam"], ["--threads", "8"]),
                                       ("c.ofr", ["--threads", "8", "--method", "geomipmap"], ["--threads", "1"])):
        record(cli, name, *recording)
        verdict = cli.json("replay", name, "--verify", *replaying)
        for field, wanted in (("steps", RECORDED_STEPS), ("steps_missing", 0), ("equal", True), ("first_difference_step", -1),
                              ("expected_hash", verdict["hash"])):
            expect(f"{name}: {field}", verdict[field], wanted)
        expect(f"{name}: events", verdict["events"], [{"step": 0, "t_s": 0, "event": "time-rate", "rate": 16},
                                                      {"step": 0, "t_s": 0, "event": "demo-on"}])
        if not verdict["realtime_factor"] > 1:
            raise Fault(f"{verdict['realtime_factor']} times as fast as time")
        hashes.add(verdict["hash"])
    expect(f"hashes, found {hashes}", len(hashes), 1)
    text = cli.run("replay", "a.ofr", "--verify").out
    for part in ("a.ofr: 960 steps flown again", "the same flight", hashes.pop(), "events: 0:00:00 time-rate 16 ×, 0:00:00 demo-on"):
        expect_in("verdict", part, text)


def another_flight_is_told_from_its_step_on(cli):
    with open(os.path.join(os.path.dirname(DEM), "../aircraft/t37.aircraft"), encoding="utf-8") as file:
        figures = file.read()
    cli.write("mine.aircraft", figures)
    record(cli, "a.ofr", "--aircraft", "mine.aircraft")
    expect("as recorded", cli.json("replay", "a.ofr", "--verify")["equal"], True)
    heavier = re.sub(r"^mass = (\d+)lb", lambda found: f"mass = {int(found[1]) + 1}lb", figures, flags=re.M)
    expect("figures changed", heavier != figures, True)
    cli.write("mine.aircraft", heavier)
    run = cli.run("replay", "a.ofr", "--verify")
    expect(f"exit status, having said {run.err!r}", run.code, 1)
    expect_in("verdict", "another flight from step 0 on (0:00:00)", run.out)
    expect_in("warning", f"other figures of the aircraft '{os.path.realpath(cli.path('mine.aircraft'))}'", run.err)
    run = cli.run("replay", "a.ofr", "--verify", "--json")
    expect("exit status with --json", run.code, 1)
    for field, wanted in (("equal", False), ("first_difference_step", 0)):
        expect(field, json.loads(run.out)[field], wanted)
    run = cli.run("convert", "a.ofr", "a.csv", "--json")
    expect("conversion: exit status, step", (run.code, json.loads(run.out)["first_difference_step"]), (1, 0))
    expect_in("conversion", "a.csv: written, but from 0:00:00 on it is not the flight of a.ofr", run.err)
    os.remove(cli.path("mine.aircraft"))
    cli.write("moved/mine.aircraft", figures)
    cli.refused(1, ["mine.aircraft", "--aircraft NAME|FILE"], "replay", "a.ofr", "--verify")
    run = cli.run("replay", "a.ofr", "--verify", "--aircraft", "moved/mine.aircraft")
    expect("with the file named: exit status, warnings", (run.code, "warning: " in run.err), (0, False))
    cli.refused(1, ["a.ofr: there is no file", "--aircraft NAME|FILE"], "convert", "a.ofr", "a.csv")
    run = cli.run("convert", "a.ofr", "a.csv", "--aircraft", "moved/mine.aircraft")
    expect("converted with the file named: exit status, warnings", (run.code, "warning: " in run.err), (0, False))
    run = cli.run("replay", "a.ofr", "--verify", "--aircraft", "c172")
    expect("with another: exit status", run.code, 1)
    expect_in("warning", "the figures of 'c172' are others", run.err)


def a_damaged_recording_says_what_is_lost(cli):
    whole = record(cli, "a.ofr")
    with open(whole, "rb") as file:
        data = file.read()
    with open(cli.path("cut.ofr"), "wb") as file:
        file.write(data[:len(data) * 3 // 4])
    run = cli.run("replay", "cut.ofr", "--verify", "--json")
    expect(f"exit status, having said {run.err!r}", run.code, 0)
    verdict = json.loads(run.out)
    if not 0 < verdict["steps"] < RECORDED_STEPS or not verdict["equal"]:
        raise Fault(f"{verdict} of a recording that was cut off")
    expect(f"warnings in {run.err!r}", run.err.count("warning: "), 1)
    expect_in("what is lost", "not closed in good order", run.err)
    change_bytes(whole, len(data) // 2, b"\0\0\0\0")
    run = cli.run("replay", "a.ofr", "--verify")
    expect(f"exit status of a damaged one, having said {run.err!r}", run.code, 0)
    expect_in("what is lost", "the replay has a gap there", run.err)
    for part in ("what is left is the same flight", "steps are lost in the file"):
        expect_in("what is missing", part, run.out)


def replays_that_cannot_be_are_refused(cli):
    replay = ["replay", "--size", "64x48", "--no-window"]
    newer = record(cli, "newer.ofr")
    with open(newer, "rb") as file:
        earlier = file.read()
    record(cli, "newer.ofr")
    with open(cli.path("newer.ofr~"), "rb") as file:
        expect_true("what was there before is kept", file.read() == earlier)
    os.rename(cli.path("newer.ofr~"), cli.path("a.ofr"))
    change_bytes(newer, 8, b"\x63")
    os.mkfifo(cli.path("pipe.ofr"))
    cli.refused(2, "expected a recorded flight", "replay")
    cli.refused(1, "nowhere.ofr", *replay, "nowhere.ofr")
    cli.refused(1, "nowhere.ofr", *replay, "nowhere.ofr", "--verify")
    cli.refused(1, "a folder", *replay, ".")
    cli.refused(1, "no regular file", *replay, "pipe.ofr")
    for options in ([], ["--verify"]):
        cli.refused(1, ["version 99", "reads version 1"], *replay, "newer.ofr", *options)
    cli.refused(2, "is no recording", *replay, DEM, "--verify")
    cli.refused(2, ["--at", "up to 0:00:08.0; found '17'"], *replay, "a.ofr", "--at", "17")
    cli.refused(2, ["--at", "found 'noon'"], *replay, "a.ofr", "--at", "noon")
    cli.refused(2, "./a.ofr is a file that is read", *replay, "a.ofr", "--record", "./a.ofr")
    os.link(cli.path("a.ofr"), cli.path("newer.ofr~"))
    cli.refused(2, "newer.ofr~ is a file that is read, a.ofr", *replay, "a.ofr", "--record", "newer.ofr")
    os.remove(cli.path("newer.ofr~"))
    cli.write("newer.ofr~", "notes")
    cli.refused(2, "would be kept as newer.ofr~, which is no recording", "fly", *RECORDED, "--record", "newer.ofr")
    cli.refused(1, ["nowhere: not a folder", "mkdir -p"], "fly", *RECORDED, "--record", "nowhere/b.ofr")
    os.mkdir(cli.path("folder.ofr"))
    cli.refused(1, "a folder", "fly", *RECORDED, "--record", "folder.ofr")
    cli.write("junk.ofr", "junk")
    cli.refused(1, "expected a flight as .ofr, .igc", *replay, "junk.ofr")
    expect("the recording is as it was", cli.json("replay", "a.ofr", "--verify")["equal"], True)


def a_recording_tells_where_its_land_is_and_how_it_is_read(cli):
    os.mkdir(cli.path("there"))
    there = FlightCli(cli.program, cli.path("there"))
    there.write_picture("flat.png", b"\x81\x2c\0", 65)  # 300 m by the terrarium code
    there.json("fly", "flat.png", "--spacing", "30m", "--datum", "ellipsoid", "--size", "64x48", "--no-window", "--on-ground",
               "--frames", "3", "--record", "a.ofr")
    expect("from elsewhere", cli.json("replay", "there/a.ofr", "--verify")["equal"], True)
    run = cli.run("convert", "there/a.ofr", "a.csv")
    expect("converted: exit status, warnings", (run.code, "warning: " in run.err), (0, False))
    run = cli.run("replay", "there/a.ofr", "--verify", "--datum", "egm96")
    expect("read otherwise, as typed: exit status", run.code, 1)
    os.rename(cli.path("there"), cli.path("moved"))
    expect("beside it", cli.json("replay", "moved/a.ofr", "--verify")["equal"], True)
    os.rename(cli.path("moved/flat.png"), cli.path("flatter.png"))
    for arguments in (["replay", "moved/a.ofr", "--verify"], ["convert", "moved/a.ofr", "a.igc"]):
        cli.refused(1, ["flat.png", "was recorded over 'flat.png', named as it was there"], *arguments)
    expect("over the land named", cli.json("replay", "moved/a.ofr", "flatter.png", "--verify")["equal"], True)
    expect("the same converted", cli.json("convert", "moved/a.ofr", "a.igc", "flatter.png")["first_difference_step"], -1)
    cli.warned("--datum changes nothing: a.csv is CSV", "convert", "a.csv", "a.gpx", "--datum", "egm96")
    cli.refused(2, "found 'land.tif' after them, but a.csv is CSV", "convert", "a.csv", "a.gpx", "land.tif")


def films_have_their_frames_at_exact_times(cli):
    if shutil.which("ffmpeg") is None or shutil.which("ffprobe") is None:
        raise Skip("no ffmpeg")
    record(cli, "a.ofr")
    replay = ["replay", "a.ofr", "--size", "64x48", "--fps", "12", "--time-rate", "8"]  # 1 s: 12 frames
    report = cli.json(*replay, "--video", "a.mp4", "--pictures", "stills", "--every", "5")
    expect("frames", report["frames"], 12)
    times = subprocess.run(["ffprobe", "-v", "error", "-select_streams", "v", "-show_entries", "frame=pts_time", "-of",
                            "csv=p=0", cli.path("a.mp4")], stdout=subprocess.PIPE, text=True, check=True).stdout.split()
    expect("frames of the film", len(times), 12)
    for i, text in enumerate(times):
        if abs(float(text.rstrip(",")) - i / 12) > 1e-6:
            raise Fault(f"frame {i} at {text} s, expected {i / 12:.6f} s")
    expect("stills", sorted(os.listdir(cli.path("stills"))), [f"overfly-00{i}.png" for i in (1, 2, 3)])


def read_points(path):
    with open(path, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {float(row["t_s"]): [float(row[name]) for name in ("lat_deg", "lon_deg", "alt_m")] for row in rows}


def a_recording_is_converted(cli):
    record(cli, "a.ofr")
    for ending, interval, points in (("csv", [], 17), ("gpx", ["--interval", "0.25"], 33), ("kml", ["--interval", "4"], 3),
                                     ("acmi", [], 17), ("igc", [], 9)):
        report = cli.json("convert", "a.ofr", f"a.{ending}", *interval)
        for name, wanted in (("format", "ofr"), ("points", points), ("gaps", 0), ("duration_s", 8), ("attitude", "recorded"),
                             ("output_format", ending)):
            expect(f"{ending}: {name}", report[name], wanted)
        expect(f"{ending}: events", [event["event"] for event in report["events"]], ["time-rate", "demo-on"])
    with open(cli.path("a.igc"), encoding="utf-8") as file:
        text = file.read()
    expect_in("a.igc", "HFALGALTGPS:ELL\nHFALPALTPRESSURE:ISA\n", text)
    for fix in [line for line in text.splitlines() if line.startswith("B")]:
        pressure, ellipsoid = int(fix[25:30]), int(fix[30:35])
        if abs(6356766 * ellipsoid / (6356766 + ellipsoid) - pressure) > 1.001 or not pressure:  # both are rounded
            raise Fault(f"{fix}: no pressure altitude of the standard atmosphere")
    cli.json("convert", "a.igc", "back.csv")
    flown, back = read_points(cli.path("a.csv")), read_points(cli.path("back.csv"))
    expect("points read again", len(back), 9)
    for t_s, (lat_deg, lon_deg, alt_m) in back.items():
        there = flown[t_s]
        if abs(lat_deg - there[0]) > 2e-7 or abs(lon_deg - there[1]) > 2e-7 or abs(alt_m - there[2]) > 0.51:
            raise Fault(f"at {t_s} s: {lat_deg}, {lon_deg}, {alt_m} from IGC, flown {there}")
    cli.refused(2, ["recordings are made by flying", "overfly fly --record b.ofr"], "convert", "a.igc", "b.ofr")
    cli.refused(2, "--interval", "convert", "a.ofr", "b.igc", "--interval", "0")


def a_flight_goes_on_when_the_disk_is_full(cli):
    disk = cli.path("disk")
    os.mkdir(disk)
    if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", disk],
                                           stderr=subprocess.DEVNULL, check=False).returncode != 0:
        raise Skip("no small disk: only who administers the machine can make one")
    try:
        run = cli.run("fly", *RECORDED, "--frames", "400", "--record", "disk/a.ofr", "--json")
        expect(f"exit status, having said {run.err!r}", run.code, 1)
        expect("frames", json.loads(run.out)["frames"], 400)
        for part in ("No space left on device", "which goes on", "steps are missing in it"):
            expect_in("message", part, run.err)
        verdict = cli.json("replay", "disk/a.ofr", "--verify")
        if not 0 < verdict["steps"] < 400 * 32 or not verdict["equal"]:
            raise Fault(f"{verdict} of what is in the file")
    finally:
        subprocess.run(["umount", disk], check=True)


CASES = [help_is_instant_and_complete, help_comes_even_with_a_damaged_file, wrong_usage_is_exit_2,
         a_wrong_kind_of_errors_is_told_the_right_ones,
         options_may_come_before_the_subcommand, a_damaged_file_is_named_with_its_line, sources_win_in_order, missing_files_are_named,
         folders_for_pictures_are_looked_at_before_the_work, files_of_other_kinds_are_not_written_over,
         nothing_is_written_over_what_is_read, options_that_change_nothing_are_told,
         a_file_of_settings_has_a_section_for_each_subcommand,
         a_track_of_another_land_is_told_and_tells_no_more_than_a_path,
         a_wrong_image_is_refused_in_one_message, image_bounds_without_an_image_are_wrong_usage,
         an_image_beside_the_terrain_is_warned_of, an_eye_under_the_ground_is_warned_of,
         a_start_that_cannot_be_is_told,
         missing_files_are_named_before_a_window_is_wanted, info_names_every_file, overlapping_files_are_warned_of,
         paths_of_a_scene_are_written_plainly, a_budget_below_the_smallest_mesh_says_so,
         brute_keeps_the_budget_in_flight_only,
         partitions_draw_the_serial_triangles, a_snapshot_is_the_same_each_time,
         a_target_and_lockstep_exclude_one_another, a_governed_flight_tells_its_target, the_governor_is_measured,
         two_methods_are_reported_side_by_side, the_panel_of_accuracy_tells_what_it_measured,
         the_cost_of_the_panel_is_measured, the_corner_bound_holds_in_flight_too,
         a_flight_repeats_in_lockstep, overlapped_stages_draw_what_lockstep_draws,
         pictures_are_spread_over_the_flight, without_a_display_it_says_how_to_get_a_window,
         an_old_opengl_is_named_beside_what_is_needed, signals_end_a_flight_cleanly,
         a_flight_starts_in_the_air_wherever_it_is_asked_to, a_flight_may_start_on_the_ground,
         an_aircraft_is_chosen_by_name_or_file, the_table_of_aircraft_is_the_documented_one, flights_are_converted,
         a_conversion_has_its_points_as_far_apart_as_asked, conversions_that_cannot_be_are_refused, a_flight_without_a_date_is_given_one, a_pipe_is_not_waited_for,
         a_full_disk_is_an_error, a_recorded_flight_is_flown_again, another_flight_is_told_from_its_step_on,
         a_damaged_recording_says_what_is_lost, replays_that_cannot_be_are_refused,
         a_recording_tells_where_its_land_is_and_how_it_is_read,
         films_have_their_frames_at_exact_times, a_recording_is_converted, a_flight_goes_on_when_the_disk_is_full]


def main():
    program, wanted = os.path.abspath(sys.argv[1]), sys.argv[2:]
    faults = 0
    for case in CASES:
        if f"-{case.__name__}" in wanted or (any(w[0] != "-" for w in wanted) and case.__name__ not in wanted):
            continue
        with tempfile.TemporaryDirectory() as folder:
            faults += not passes(case, FlightCli(program, folder))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
