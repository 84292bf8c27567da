#!/usr/bin/env python3
"""`overfly bench` from outside, at tiny sizes: its report in a browser, its figures in CSV and JSON, how it repeats and
how it refuses. Usage: test_bench.py OVERFLY [NAME]..."""
import contextlib
import csv
import json
import math
import os
import re
import shlex
import shutil
import sys

from cli_support import DEM, Cli, Fault, Skip, expect, expect_true, run_cases

TINY = ["--quick", "--methods", "hybrid,geomipmap,geomipmap-ye", "--tau", "2,4", "--errors", "midpoint,total:8",
        "--track", "ridge,turn", "--frames", "6", "--rounds", "5", "--size", "96x64", "--threads", "2"]
SMALL = ["--quick", "--tau", "2,4", "--errors", "total", "--track", "turn", "--frames", "6", "--rounds", "1", "--size",
         "96x64", "--threads", "2"]
FILES = ["frames.csv", "summary.csv", "summary.json", "report.html", "worst-frame-error.png", "worst-frame.png",
         "plots.gp", "preprocessing.svg", "workers.svg", "flight-jacksboro_fault-ridge.csv",
         "flight-jacksboro_fault-turn.csv"]
PLOTS = ["pareto", "refine", "claimed", "triangles", "bound", "track", "times", "equal"]
TIMES = [f"{stage}_ms{end}" for end in ("", "_min", "_max") for stage in ("select", "refine", "upload", "draw", "frame")]
TIMES += ["memory_bytes"]


class BenchCli(Cli):
    """Two runs of the tiny benchmark, each once, are kept: by two threads, and by one."""

    def __init__(self, program, folder):
        super().__init__(program, folder)
        self.reports = {}

    def report(self, name):
        """(folder, JSON) of a run of the tiny benchmark."""
        if name not in self.reports:
            folder = os.path.join(self.folder, "made", name)  # folders that are not there are made
            threads = "1" if name == "second" else "2"
            code, out, err = self.run("bench", *TINY, "--threads", threads, "-o", folder, "--json")
            expect(f"exit status, having said {err!r}", code, 0)
            self.reports[name] = (folder, json.loads(out))
        return self.reports[name]


def rows_of(folder, name):
    with open(os.path.join(folder, name), newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def all_files_are_there(cli):
    folder, _ = cli.report("first")
    expected = set(FILES + [f"{plot}-jacksboro_fault.svg" for plot in PLOTS])
    expect("files", set(os.listdir(folder)), expected)
    for name in expected:
        expect_true(f"{name} is empty", os.path.getsize(os.path.join(folder, name)) > 100)
    expect_true("report.html has 5 MB or more", os.path.getsize(os.path.join(folder, "report.html")) < 5e6)


def json_keeps_its_contract(cli):
    folder, report = cli.report("first")
    with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
        expect("summary.json against stdout", json.load(file), report)
    expect("machine", sorted(report["machine"])[:2], ["compiler", "optimized"])
    expect("runs", len(report["runs"]), 5 * 2)
    for run in report["runs"]:
        what = f"{run['variant']}, {run['tau_px']}"
        for name in ("max_px", "p999_px", "p99_px", "rms_px", "above_tau_share", "t_junctions", "holes"):
            expect_true(f"{what}: {name}", run["measured"][name] >= 0)
        m = run["measured"]
        expect_true(f"{what}: percentiles", m["rms_px"] <= m["p99_px"] <= m["p999_px"] <= m["max_px"])
        for name in ("frame_ms", "refine_ms"):
            p = run[name]
            expect_true(f"{what}: {name}", 0 < p["p50"] <= p["p95"] <= p["p99"] <= p["max"])
        least, most = run["frame_ms_p50_of_rounds"]
        expect_true(f"{what}: rounds", 0 < least <= most)
        expect(f"{what}: measured what was timed", run["measured_what_was_timed"], True)
    expect("verdict", report["verdict"].startswith("Every promise held: all 4 runs that promise"), True)


def promises_are_those_of_the_methods(cli):
    for run in cli.report("first")[1]["runs"]:
        promised = run["method"] == "hybrid" and run["error"] != "midpoint"
        expect(f"{run['variant']}: promised", run["promised"], promised)
        if promised:
            expect(f"{run['variant']}: held", run["promise_held"], True)
    ye = [run for run in cli.report("first")[1]["runs"] if run["method"] == "geomipmap-ye"]
    expect("a method above its tolerance is not called kept", any(run["promise_held"] for run in ye), False)


def errors_of_two_runs_are_the_same_bytes(cli):
    first, second = (rows_of(cli.report(name)[0], "frames.csv") for name in ("first", "second"))
    expect("rows", len(first), 5 * 2 * 2 * 6)
    for row in first + second:
        for name in TIMES:
            expect_true(f"{name} {row[name]!r}", float(row.pop(name)) >= 0 or name == "memory_bytes")
    expect("errors, poses and counts", first, second)
    summaries = []
    for name in ("first", "second"):
        rows = [list(row.items()) for row in rows_of(cli.report(name)[0], "summary.csv")]
        times = [key for key, _ in rows[0]].index("frame_ms_p50")
        summaries.append([row[:times] for row in rows])
    expect("summaries of two threads, and of one", *summaries)


def summaries_are_those_of_the_frames(cli):
    folder, report = cli.report("first")
    frames, summary = rows_of(folder, "frames.csv"), rows_of(folder, "summary.csv")
    expect("rows", len(summary), len(report["runs"]))
    for row, run in zip(summary, report["runs"]):
        own = [f for f in frames if (f["variant"], f["tau_px"]) == (row["variant"], row["tau_px"])]
        what = f"{row['variant']}, {row['tau_px']}"
        expect(f"{what}: max", float(row["max_px"]), max(float(f["max_px"]) for f in own))
        expect(f"{what}: JSON", run["measured"]["max_px"], float(row["max_px"]))
        rms = math.sqrt(sum(float(f["rms_px"]) ** 2 for f in own) / len(own))
        expect_true(f"{what}: RMS {row['rms_px']}", abs(float(row["rms_px"]) - rms) < 1e-9)
        timed = [f for f in own if f["jump"] == "0"]
        expect(f"{what}: longest", float(row["frame_ms_max"]), max(float(f["frame_ms_max"]) for f in timed))
        expect_true(f"{what}: p50", min(float(f["frame_ms_min"]) for f in timed) <= float(row["frame_ms_p50"])
                    <= max(float(f["frame_ms_max"]) for f in timed))
        stretches = len({f["flight"] for f in own}) * (report["frames_a_stretch"] - 1)
        pairs = sum(1 for f in own if f["popping_px"]) + stretches
        expect(f"{what}: pairs of frames", [row["popping_pairs"], run["measured"]["popping_pairs"]], [str(pairs), pairs])
        expect(f"{what}: popping is told but at jumps", {f["jump"] for f in own if f["popping_px"]}, {"0"})


def the_distribution_of_times_keeps_its_tail(cli):
    folder, report = cli.report("first")
    with open(os.path.join(folder, "plots.gp"), encoding="utf-8") as file:
        parts = file.read().split("$times << EOD\n")[1].split("EOD")[0].split("\n\n\n")
    shown = [run for run in report["runs"] if run["tau_px"] == 2]
    for run, part in zip(shown, parts, strict=False):
        points = [[float(number) for number in line.split()] for line in part.split("\n")]
        expect(f"{run['variant']}: a start, and five rounds of the frames that are timed", len(points), 1 + 5 * 2 * 4)
        expect(f"{run['variant']}: from 0 to 1", [points[0][1], points[-1][1]], [0, 1])
        longest = run["frame_ms"]["max"]
        expect_true(f"{run['variant']}: {points[-1][0]} is {longest}", abs(points[-1][0] / longest - 1) < 1e-6)


def the_command_of_the_worst_frame_measures_it_again(cli):
    for run in cli.report("first")[1]["runs"]:
        words = shlex.split(run["worst_frame"]["command"])
        expect("program, as it was called", words[0], cli.program)
        code, out, err = cli.run(*words[1:], "--json")
        expect(f"exit status, having said {err!r}", code, 0)
        expect(f"{run['variant']}: error", json.loads(out)["measured"]["max_px"], run["worst_frame"]["max_px"])


def the_command_tells_what_else_was_given(cli):
    """And all of a path that is longer than a buffer would be."""
    folder, place = (os.path.join(cli.folder, *names) for names in (["given"], [*3 * [130 * "d"], "it's deep.tif"]))
    os.makedirs(os.path.dirname(place))
    shutil.copy(DEM, place)
    code, out, err = cli.run("bench", place, *SMALL, "--methods", "geomipmap:centre,roam", "--tile-side", "9", "-o", folder,
                             "--json", OVERFLY_MAX_TRIANGLES="3000", OVERFLY_VOIDS="hole")
    expect(f"exit status, having said {err!r}", code, 0)
    for run in json.loads(out)["runs"]:
        words = shlex.split(run["worst_frame"]["command"])
        for part in ("--tile-side=9", "--max-triangles=3000", "--voids=hole"):
            expect_true(f"{part} in {words}", part in words)
        expect("place", words[2], place)
        again = json.loads(cli.run(*words[1:], "--json")[1])
        expect(f"{run['variant']}: error", again["measured"]["max_px"], run["worst_frame"]["max_px"])


def where_nothing_is_promised_nothing_is_said_to_hold(cli):
    code, out, err = cli.run("bench", *SMALL, "--methods", "geomipmap", "--json", "-o", "none")
    expect(f"exit status, having said {err!r}", code, 0)
    expect_true("verdict", json.loads(out)["verdict"].startswith("Nothing was promised: none of the 2 runs"))
    with open(os.path.join(cli.folder, "none", "report.html"), encoding="utf-8") as file:
        html = file.read()
    expect_true("no green promise", "promise held" not in html and "of those that promise" not in html)
    told = html.split("At a measured error of ")[1].split("</p>")[0]
    expect("what is said of costs", "their bound" in told, False)
    expect("methods without a line there are named", "Not compared" in told, "geomipmap (" not in told)


def names_that_are_alike_are_told_apart(cli):
    for name in ("same.tif", "same.tiff"):
        shutil.copy(DEM, os.path.join(cli.folder, name))
    flight = os.path.join(cli.report("first")[0], "flight-jacksboro_fault-turn.csv")
    for folder in ("a", "b"):
        os.makedirs(os.path.join(cli.folder, folder), exist_ok=True)
        shutil.copy(flight, os.path.join(cli.folder, folder, "turn.csv"))
    code, _, err = cli.run("bench", "same.tif", "same.tiff", *SMALL, "--track", "a/turn.csv,b/turn.csv,turn", "--methods",
                           "hybrid,hybrid", "--tau", "2,2", "-o", "alike")
    expect(f"exit status, having said {err!r}", code, 0)
    expect_true(f"no estimate in {err!r}", "a model of this size" in err and "for all 2; interrupted" in err)
    found = set(os.listdir(os.path.join(cli.folder, "alike")))
    for stem in ("same_1", "same_2"):
        expect_true(f"plots of {stem} in {found}", f"pareto-{stem}.svg" in found)
        for name in ("turn", "turn-2", "turn-3"):
            expect_true(f"{name} of {stem} in {found}", f"flight-{stem}-{name}.csv" in found)
    rows = rows_of(os.path.join(cli.folder, "alike"), "frames.csv")
    expect("rows: two DEMs, one method, one tolerance, three flights of six frames", len(rows), 2 * 3 * 6)


def names_are_no_commands(cli):
    flight = os.path.join(cli.report("first")[0], "flight-jacksboro_fault-turn.csv")
    name = "x`touch owned`'\".csv"
    shutil.copy(flight, os.path.join(cli.folder, name))
    code, out, err = cli.run("bench", *SMALL, "--methods", "hybrid", "--tau", "2", "--track", "./" + name, "-o", "names")
    expect(f"exit status, having said {err!r}", code, 0)
    expect_true(f"one is no plural: {out!r}", "6 frames of 1 flight, 1 round; " in out and
                "the one run that promises a bound kept it" in out)
    expect_true("a file name was run", not any("owned" in files for _, _, files in os.walk(cli.folder)))


def mistakes_are_found_before_the_work(cli):
    with open(os.path.join(cli.folder, "bad.csv"), "w", encoding="utf-8") as file:
        file.write("t_s,lat_deg,lon_deg,alt_m\n0,0,0,x\n")
    with open(os.path.join(cli.folder, "far.csv"), "w", encoding="utf-8") as file:
        file.write("t_s,lat_deg,lon_deg,alt_m\n0,0,0,100\n10,0,0.01,100\n")
    for arguments, said in ((["jacksboro", "no-such.tif"], "no-such.tif"), (["--track", "./bad.csv"], "bad.csv:2"),
                            (["--track", "./far.csv"], "no flight comes over"), (["--track", "./made"], "a folder")):
        os.makedirs(os.path.join(cli.folder, "made"), exist_ok=True)
        code, out, err = cli.run("bench", *SMALL, *arguments, "-o", "late")
        expect(f"{arguments}: exit status, having said {err!r}", code, 1)
        expect_true(f"{arguments}: {said!r} in {err!r}", said in err and "timing" not in err)
        expect(f"{arguments}: stdout", out, "")


def other_kinds_of_errors_cost_and_give_what_they_should(cli):
    report = cli.report("first")[1]
    expect("kinds", [k["error"] for k in report["dems"][0]["preprocessing"]], ["total", "midpoint", "total:8"])
    triangles = {r["error"]: r["triangles_mean"] for r in report["runs"] if r["method"] == "hybrid" and r["tau_px"] == 2}
    expect_true(f"bounds take more triangles: {triangles}",
                triangles["midpoint"] < triangles["total"] < triangles["total:8"])
    kinds = {row["kind"] for row in report["preprocessing"]}
    expect_true(f"kinds preprocessed: {kinds}", {"midpoint", "total"} <= kinds)


def flights_from_files_are_flown(cli):
    """Of every format that is read; one of a report is the same flight again."""
    folder, report = cli.report("first")
    flight = os.path.join(folder, "flight-jacksboro_fault-ridge.csv")
    names = [f"ridge.{ending}" for ending in ("igc", "gpx", "kml", "acmi", "csv")]
    for name in names:
        code, _, err = cli.run("convert", flight, name, "--start", "2024-06-01T12:00:00Z", "--interval", "20")
        expect(f"{name}: exit status, having said {err!r}", code, 0)
    code, _, err = cli.run("fly", DEM, "--no-window", "--demo", "--frames", "5", "--time-rate", "16", "--size", "64x48",
                           "--record", "flown.ofr")
    expect(f"recording: exit status, having said {err!r}", code, 0)
    code, out, err = cli.run("bench", *SMALL, "--track", ",".join([flight, *names, "flown.ofr"]), "--methods", "hybrid",
                             "--tau", "4", "--frames", "3", "--json")
    expect(f"exit status, having said {err!r}", code, 0)
    again = json.loads(out)["dems"][0]["flights"]
    expect("hash", again[0]["hash"], report["dems"][0]["flights"][0]["hash"])
    expect("names", [flight["name"] for flight in again],
           ["flight-jacksboro_fault-ridge", "ridge"] + [f"ridge-{number}" for number in range(3, 7)] + ["t37"])
    expect_true(f"nobody is beside the terrain: {err!r}", "eyes" not in err)


def several_dems_stand_side_by_side(cli):
    code, out, err = cli.run("bench", DEM, "jacksboro", *TINY, "--methods", "hybrid", "--errors", "total", "--track",
                             "turn", "--json", "-o", "two")
    expect(f"exit status, having said {err!r}", code, 0)
    expect("dems", [run["dem"] for run in json.loads(out)["runs"]],
           ["jacksboro_fault.tif"] * 2 + ["jacksboro"] * 2)
    plots = [name for name in os.listdir(os.path.join(cli.folder, "two")) if name.endswith(".svg")]
    expect_true("plots of both", {"pareto-jacksboro_fault.svg", "pareto-jacksboro.svg"} <= set(plots))
    for name in plots:
        with open(os.path.join(cli.folder, "two", name), encoding="utf-8") as file:
            beside = re.findall(r'text-anchor="start">\s*<text>([\d.]+)<', file.read())
        expect(f"{name}: numbers that stand beside their ticks", beside, [])


def mistakes_are_named(cli):
    quick = ["bench", *TINY]
    cli.refused(2, ["--methods: ", "found 'hybrd'; did you mean 'hybrid'"], *quick, "--methods", "hybrd")
    cli.refused(2, ["found 'geomipmap:center'; did you mean 'geomipmap:centre'"], *quick, "--methods", "geomipmap:center")
    cli.refused(2, ["found 'hybridhybridhybridhybri...'"], *quick, "--methods", 99 * "hybrid")
    for empty in (",hybrid", "hybrid,", "hybrid,,roam"):
        cli.refused(2, ["--methods: ", "found an empty entry\n"], *quick, "--methods", empty)
    cli.refused(2, ["--tau: ", "0.01 to 1000", "found 'x'"], *quick, "--tau", "1,x")
    cli.refused(2, ["--tau: ", "found '0'"], *quick, "--tau", "0")
    cli.refused(2, ["--tau: ", "found 'nan'"], *quick, "--tau", "nan")
    cli.refused(2, ["--tau: ", "found an empty entry"], *quick, "--tau", "1,")
    cli.refused(2, ["--tau: expected at most 12"], *quick, "--tau", "1,2,3,4,5,6,7,8,9,10,11,12,13")
    cli.refused(2, ["--errors: ", "found 'tottal'"], *quick, "--errors", "tottal")
    cli.refused(2, ["--track: ", "found 'rigde'; did you mean 'ridge'"], *quick, "--track", "rigde")
    cli.refused(1, ["no/flight.csv"], *quick, "--track", "no/flight.csv")
    cli.refused(1, ["no-such.tif"], "bench", "no-such.tif", *TINY)
    cli.refused(2, ["--tau: expected one number", "found '1,2'"], "bench", "refine", "--tau", "1,2")
    cli.refused(2, ["--sides: expected", "found '4'"], "bench", "preprocess", "--sides", "4")
    cli.refused(1, ["gnuplot", "apt-get install gnuplot-nox"], *quick, "-o", "report", PATH="/nowhere")
    with open(os.path.join(cli.folder, "file"), "w", encoding="utf-8"):
        pass
    cli.refused(1, ["file"], *quick, "-o", "file/report")


def what_is_not_heeded_is_told(cli):
    """All of it before the elevation model, which is not there."""
    run = cli.run("bench", "no-such.tif", *SMALL, "--methods", "roam,roam", "--tau", "2,2", "--target-ms", "16", "--sides",
                  "5", "--eye", "36,-84,1000")
    for said in ("--methods: 'roam' is there already", "--tau: 2 is there already",
                 "--target-ms: only of 'bench governor'; ignored here", "--sides: only of 'bench preprocess'; ignored here",
                 "--eye: only of 'bench refine', 'partitions', 'governor' and 'panel'; flights are chosen with --track here"):
        expect(f"{said!r} in {run.err!r}", run.err.count("warning: " + said), 1)


def nothing_is_left_behind_by_what_was_refused(cli):
    cli.refused(2, ["--tau"], "bench", *TINY, "--tau", "x", "-o", "never")
    expect("folder", os.path.exists(os.path.join(cli.folder, "never")), False)


@contextlib.contextmanager
def open_browser(folder):
    """A browser, and the driver between, which is ended whatever becomes of them."""
    try:
        from selenium import webdriver
        from selenium.common.exceptions import WebDriverException
        from selenium.webdriver.common import utils
    except ImportError as missing:
        raise Skip("python3-selenium is not there") from missing
    if not shutil.which("chromium") or not shutil.which("chromedriver"):
        raise Skip("chromium or its driver is not there")

    class Service(webdriver.chrome.service.Service):
        """Reached by its address, as its browser is by a pipe: a bare machine's `localhost` has no address."""
        service_url = property(lambda self: f"http://127.0.0.1:{self.port}")

        def is_connectable(self):
            return utils.is_connectable(self.port, "127.0.0.1")

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for argument in ("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
                     "--disable-component-update", "--disable-sync", "--remote-debugging-pipe",
                     f"--user-data-dir={folder}/browser"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    service = Service(shutil.which("chromedriver"))
    try:
        yield webdriver.Chrome(service=service, options=options)
    except WebDriverException as failed:
        raise Fault(f"the browser or its driver: {failed.msg}") from failed
    finally:
        if getattr(service, "process", None):
            service.stop()  # and with it its browsers


def column_of(browser, column):
    script = """const table = document.querySelector('table.sortable');
                return Array.from(table.tBodies[0].rows).map(row => row.cells[arguments[0]].textContent);"""
    return browser.execute_script(script, column)


def click_title(browser, column):
    script = "document.querySelector('table.sortable').tHead.rows[0].cells[arguments[0]].firstChild.click();"
    browser.execute_script(script, column)


def the_report_works_in_a_browser(cli):
    folder, report = cli.report("first")
    with open_browser(cli.folder) as browser:
        browser.get(f"file://{folder}/report.html")
        pictures = browser.execute_script(
            "return Array.from(document.images).map(i => [i.alt, i.complete && i.naturalWidth > 0])")
        expect("pictures", len(pictures), 2 + len(PLOTS) + 2)
        expect("pictures that do not load", [alt for alt, loaded in pictures if not loaded], [])
        expect("verdict", browser.execute_script("return document.querySelector('#verdict').textContent")
               .startswith("Every promise held"), True)
        outside = browser.execute_script("return performance.getEntriesByType('resource').map(r => r.name)"
                                         ".filter(name => !name.startsWith('data:'))")
        expect("what the page asks for", outside, [])
        check_wide_table(browser)
        check_sorting(browser, len(report["runs"]))
        expect("console", [entry for entry in browser.get_log("browser")], [])
        check_themes(browser)


def check_wide_table(browser):
    """It scrolls in a box of its own, beside the names of its rows; the page does not."""
    browser.set_window_size(1280, 900)
    page, box, left, name = browser.execute_script("""
        const box = document.querySelector('.scroll'), page = document.documentElement;
        box.scrollLeft = 500;
        const name = box.querySelector('tbody td').getBoundingClientRect();
        return [[page.scrollWidth, window.innerWidth], [box.scrollWidth, box.clientWidth], box.scrollLeft,
                [name.left, box.getBoundingClientRect().left]];""")
    expect_true(f"the page is as wide as the window: {page}", page[0] <= page[1])
    expect_true(f"the table is wider than its box, which scrolls: {box}, {left}", box[0] > box[1] and left > 100)
    expect("where the name is", name[0], name[1])


def check_sorting(browser, count):
    triangles = 12
    before = column_of(browser, triangles)
    expect("rows", len(before), count)
    click_title(browser, triangles)
    expect("ascending", column_of(browser, triangles), sorted(before, key=float))
    click_title(browser, triangles)
    expect("descending", column_of(browser, triangles), sorted(before, key=float, reverse=True))
    click_title(browser, 0)
    names = column_of(browser, 0)
    expect("by name", names, sorted(names))


def a_style_matches_what_gnuplot_writes(cli):
    folder, _ = cli.report("first")
    with open(os.path.join(folder, "pareto-jacksboro_fault.svg"), encoding="utf-8") as file:
        svg = file.read()
    for colour in ("rgb( 18,  52,  86)", "rgb(18,52,86)", "rgb(101,  67,  33)"):
        expect_true(f"{colour} is in the style sheet alone", svg.count(colour) > 2)


def check_themes(browser):
    inks, plots = [], []
    for theme in ("light", "dark"):
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                {"features": [{"name": "prefers-color-scheme", "value": theme}]})
        inks.append(browser.execute_script("const s = getComputedStyle(document.body); return [s.color, s.backgroundColor]"))
        plots.append(browser.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})["data"])
    expect_true("plots are the same in light and dark", plots[0] != plots[1])
    expect_true(f"light and dark differ: {inks}", inks[0][0] != inks[1][0] and inks[0][1] != inks[1][1])


CASES = [all_files_are_there, json_keeps_its_contract, promises_are_those_of_the_methods,
         errors_of_two_runs_are_the_same_bytes, summaries_are_those_of_the_frames,
         the_distribution_of_times_keeps_its_tail,
         the_command_of_the_worst_frame_measures_it_again, the_command_tells_what_else_was_given,
         where_nothing_is_promised_nothing_is_said_to_hold, names_that_are_alike_are_told_apart, names_are_no_commands,
         mistakes_are_found_before_the_work, other_kinds_of_errors_cost_and_give_what_they_should,
         flights_from_files_are_flown, several_dems_stand_side_by_side, mistakes_are_named,
         what_is_not_heeded_is_told, nothing_is_left_behind_by_what_was_refused, a_style_matches_what_gnuplot_writes,
         the_report_works_in_a_browser]


if __name__ == "__main__":
    sys.exit(run_cases(CASES, BenchCli))
