#!/usr/bin/env python3
"""Files of ten million lines through overfly convert in limited memory: refused where they are too many points, read
where most of them are none. Usage: test_track_long.py OVERFLY"""
import os
import resource
import subprocess
import sys
import tempfile

LINES = 10_000_000
POINTS_MAX = 4_000_000
DAY_LINES = 86_400
MEMORY_BYTES = 420 << 20  # of addresses: points take 244 MiB, all of it 320
HEAD = "AXXX001\nHFDTE010624\nHFALG:GEO\n"


class Fault(Exception):
    pass


def clock(second):
    return f"{second // 3600:02}{second // 60 % 60:02}{second % 60:02}"


def write_long(path, fixes_first, fixes_last):
    """HEAD, fixes a second apart, lines that are none up to LINES in all, and fixes again."""
    day = "".join(f"B{clock(i)}4630000N00800000EA0140001500\n" for i in range(DAY_LINES)).encode()
    size, others = len(day) // DAY_LINES, LINES - HEAD.count("\n") - fixes_first - fixes_last
    with open(path, "wb") as file:
        file.write(HEAD.encode())
        for first in range(0, fixes_first, DAY_LINES):
            file.write(day[:(fixes_first - first) * size])
        file.write(b"L\n" * others)
        file.write(day[:fixes_last * size])


def convert(overfly, source, target):
    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    return subprocess.run([overfly, "convert", source, target], capture_output=True, text=True, check=False,
                          timeout=120, preexec_fn=limit)


def too_many_points_are_refused(overfly, folder):
    source, target = os.path.join(folder, "long.igc"), os.path.join(folder, "out.igc")
    write_long(source, POINTS_MAX + 1, 0)
    done = convert(overfly, source, target)
    said = f"long.igc:{POINTS_MAX + 4}: more than {POINTS_MAX} points"
    if done.returncode != 1 or said not in done.stderr or os.path.exists(target):
        raise Fault(f"exit {done.returncode}, '{done.stderr}'; expected 1 and '{said}'")


def lines_that_are_no_points_are_passed_over(overfly, folder):
    source, target = os.path.join(folder, "long.igc"), os.path.join(folder, "out.igc")
    write_long(source, 0, 1000)
    done = convert(overfly, source, target)
    with open(target if done.returncode == 0 else os.devnull, encoding="utf-8") as file:
        fixes = sum(line.startswith("B") for line in file)
    if done.returncode != 0 or fixes != 1000:
        raise Fault(f"exit {done.returncode}, {fixes} fixes, '{done.stderr}'; expected 1000")


def main():
    with tempfile.TemporaryDirectory() as folder:
        for test in (too_many_points_are_refused, lines_that_are_no_points_are_passed_over):
            try:
                test(os.path.abspath(sys.argv[1]), folder)
            except Fault as fault:
                sys.exit(f"{test.__name__}: {fault}")
            print(test.__name__)


if __name__ == "__main__":
    main()
