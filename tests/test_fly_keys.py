#!/usr/bin/env python3
"""Takes off, climbs, turns and lands in a window, by keys alone.

The script is the pilot: it reads the telemetry, and presses and lets go keys of the window, as a person does who looks
at the instruments. Without a virtual display, xdotool or GDAL the test is skipped.
    test_fly_keys.py OVERFLY
"""
import csv
import math
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time

LIMIT_S = 300.0
SKIPPED = 77
KEYS = {"throttle up": "Prior", "throttle down": "Next", "nose up": "Down", "nose down": "Up", "left": "Left",
        "right": "Right", "brakes": "b", "flaps": "bracketright"}


class Fault(Exception):
    pass


class Flight:
    """The program in its window, and the newest line of its telemetry."""

    def __init__(self, overfly, dem, environment):
        self.environment = environment
        self.lines, self.held, self.newest = [], set(), None
        self.program = subprocess.Popen(
            [overfly, "fly", dem, "--aircraft", "c172", "--on-ground", "--eye", "47.1,10.05,300", "--look", "90,0",
             "--size", "320x200", "--tau", "8", "--fps", "20", "--no-joystick", "--no-hud", "--telemetry", "-"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment, text=True)
        self.errors = []
        threading.Thread(target=self.listen, daemon=True).start()
        threading.Thread(target=lambda: self.errors.extend(self.program.stderr), daemon=True).start()
        self.end_s = time.monotonic() + LIMIT_S
        self.window = self.find_window()

    def listen(self):
        for row in csv.DictReader(self.program.stdout):
            self.newest = {name: value if name == "contact" else float(value or "nan") for name, value in row.items()}
            self.lines.append(self.newest)

    def run(self, *words):
        return subprocess.run(["xdotool", *words], env=self.environment, capture_output=True, text=True, timeout=20)

    def find_window(self):
        while time.monotonic() < self.end_s and self.program.poll() is None:
            found = self.run("search", "--name", "Overfly").stdout.split()
            if found and self.newest:
                time.sleep(1.0)
                self.run("windowfocus", found[0])
                return found[0]
            time.sleep(0.2)
        raise Fault(f"no window: {''.join(self.errors)}")

    def hold(self, *names):
        """Exactly these keys are down from here on."""
        wanted = {KEYS[name] for name in names}
        for key in self.held - wanted:
            self.run("keyup", key)
        for key in wanted - self.held:
            self.run("keydown", key)
        self.held = wanted

    def tap(self, name):
        self.run("key", KEYS[name])

    def pulse(self, names, seconds):
        """A short push, and a look at what came of it: the path stays where it is left."""
        self.hold(*names)
        time.sleep(seconds)
        self.hold()
        time.sleep(0.3)

    def until(self, what, condition, keys=lambda now: ()):
        """Flies on with the keys that the instruments call for, until it is so."""
        print(f"{what} ...", flush=True)
        while time.monotonic() < self.end_s:
            if self.program.poll() is not None:
                raise Fault(f"{what}: the program has ended: {''.join(self.errors)}")
            now = self.newest
            if now["contact"] == "crashed":
                raise Fault(f"{what}: crashed: {self.lines[-8:]}")
            if condition(now):
                print(f"   {now['t_s']:.1f} s, {now['above_ground_m']:.1f} m, {now['airspeed_m_s']:.1f} m/s, heading "
                      f"{now['heading_deg']:.0f}, {now['contact']}", flush=True)
                return now
            names = keys(now)
            if names and isinstance(names[-1], float):
                self.pulse(names[:-1], names[-1])
            else:
                self.hold(*names)
                time.sleep(0.05)
        raise Fault(f"{what}: not within {LIMIT_S:.0f} s: {now}")

    def leave(self):
        self.hold()
        self.run("key", "Escape")
        code = self.program.wait(timeout=30)
        if code != 0:
            raise Fault(f"expected exit status 0, found {code}: {''.join(self.errors)}")


def pitch_for(now, climb_m_s, others=()):
    """A push that is as long as the path is off, and others with it."""
    off_deg = math.degrees((climb_m_s - now["vertical_speed_m_s"]) / max(now["airspeed_m_s"], 20.0))
    if abs(off_deg) < 0.4:
        return others
    return (*others, "nose up" if off_deg > 0.0 else "nose down", min(0.05 + 0.04 * abs(off_deg), 0.3))


def level_wings(now):
    return ("right",) if now["bank_deg"] < -3.0 else ("left",) if now["bank_deg"] > 3.0 else ()


def speed_for(now, speed_m_s):
    off = now["airspeed_m_s"] - speed_m_s
    return ("throttle down",) if off > 1.5 else ("throttle up",) if off < -1.5 else ()


def turned(now, before):
    return (now["heading_deg"] - before + 540.0) % 360.0 - 180.0


def fly(flight):
    flight.until("full throttle", lambda now: now["throttle"] > 0.98, lambda now: ("throttle up",))
    flight.until("rolls", lambda now: now["airspeed_m_s"] > 29.0)
    lifted = flight.until("lifts off", lambda now: now["contact"] == "airborne" and now["above_ground_m"] > 4.0,
                          lambda now: ("nose up",) if now["pitch_deg"] < 8.0 else ())
    flight.until("climbs", lambda now: now["above_ground_m"] > 45.0, lambda now: pitch_for(now, 3.0, level_wings(now)))
    flight.until("levels off", lambda now: abs(now["vertical_speed_m_s"]) < 0.5,
                 lambda now: pitch_for(now, 0.0, level_wings(now)))
    flight.until("banks", lambda now: now["bank_deg"] > 18.0, lambda now: ("right",))
    flight.until("turns right", lambda now: turned(now, lifted["heading_deg"]) > 60.0, lambda now: pitch_for(now, 0.0))
    flight.until("rolls out", lambda now: abs(now["bank_deg"]) < 4.0, level_wings)
    flight.until("comes down", lambda now: now["above_ground_m"] < 9.0,
                 lambda now: pitch_for(now, -2.2, level_wings(now) + speed_for(now, 34.0)))
    flight.until("flares", lambda now: now["contact"] == "rolling",
                 lambda now: pitch_for(now, -0.7, level_wings(now) + ("throttle down",)))
    flight.until("stands", lambda now: now["airspeed_m_s"] < 2.0 and now["contact"] == "rolling",
                 lambda now: ("throttle down", "brakes"))


def with_display(arguments):
    """Runs this script again under a display of its own."""
    if not all(map(shutil.which, ("xvfb-run", "xdotool", "gdal_create"))):
        print("skipped: needs xvfb-run, xdotool and gdal_create")
        return SKIPPED
    return subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 640x400x24", sys.executable, *arguments, "--in-display"],
                          timeout=LIMIT_S + 60.0).returncode


def make_plain(folder):
    path = os.path.join(folder, "plain.tif")
    subprocess.run(["gdal_create", "-q", "-of", "GTiff", "-ot", "Int16", "-outsize", "121", "121", "-burn", "300",
                    "-a_srs", "EPSG:4326", "-a_ullr", "10.0", "47.2", "10.2", "47.0", path], check=True)
    return path


def main():
    if "--in-display" not in sys.argv:
        return with_display(sys.argv)
    with tempfile.TemporaryDirectory() as folder:
        environment = dict(os.environ, XDG_CONFIG_HOME=folder, XDG_STATE_HOME=folder, HOME=folder)
        flight = Flight(sys.argv[1], make_plain(folder), environment)
        try:
            fly(flight)
            flight.leave()
        except Fault as fault:
            print(f"FAILED: {fault}")
            return 1
        finally:
            if flight.program.poll() is None:
                flight.program.kill()
    print("took off, climbed, turned, landed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
