"""What the tests of the program from outside share: running it, expecting, and telling what came of it."""
import collections
import os
import subprocess
import sys
import tempfile
import time

DEM = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "assets/data/dem/jacksboro_fault.tif")

Run = collections.namedtuple("Run", "code out err")


class Fault(Exception):
    pass


class Skip(Exception):
    pass


def expect(what, found, wanted):
    if found != wanted:
        raise Fault(f"{what}: expected {wanted!r}, found {found!r}")


def expect_true(what, holds):
    if not holds:
        raise Fault(what)


def expect_in(what, part, text):
    expect_true(f"{what}: expected {part!r} in: {text!r}", part in text)


class Cli:
    """The program, run in a folder of its own: without the options, the home and the display of who runs the test."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.environment = {k: v for k, v in os.environ.items() if not k.startswith("OVERFLY_")}
        self.environment.update(HOME=folder, XDG_CONFIG_HOME=os.path.join(folder, "config"))
        self.environment.pop("DISPLAY", None)
        self.environment.pop("XDG_PICTURES_DIR", None)

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, *arguments, **environment):
        return subprocess.Popen([self.program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                cwd=self.folder, env={**self.environment, **environment})

    def run(self, *arguments, **environment):
        with self.start(*arguments, **environment) as process:
            try:
                out, err = process.communicate(timeout=400)
            except BaseException:
                process.kill()
                raise
        return Run(process.returncode, out, err)

    def refused(self, code, said, *arguments, **environment):
        """The program leaves with `code`, nothing on stdout and exactly one error, which says all of `said`."""
        run = self.run(*arguments, **environment)
        what = " ".join(arguments)
        expect(f"{what}: exit status, having said {run.err!r}", run.code, code)
        expect(f"{what}: stdout", run.out, "")
        expect(f"{what}: errors in {run.err!r}", run.err.count("error: "), 1)
        for part in [said] if isinstance(said, str) else said:
            expect_in(what, part, run.err)


def passes(case, cli):
    """Runs a case and prints what came of it, as tools/test_summary reads it; a skip is no fault."""
    begin_s = time.monotonic()
    try:
        case(cli)
    except Skip as skip:
        print(f"{skip}\n[  SKIPPED ] {case.__name__}", flush=True)
    except (Fault, subprocess.TimeoutExpired, ValueError, KeyError, TypeError, OSError) as fault:
        print(f"{type(fault).__name__}: {fault}\n[  FAILED  ] {case.__name__}", flush=True)
        return False
    else:
        print(f"{time.monotonic() - begin_s:.1f} s\n[       OK ] {case.__name__}", flush=True)
    return True


def run_cases(cases, begin):
    """Those that the command line names, or all, of one `begin(program, folder)`; the exit status."""
    names = sys.argv[2:]
    with tempfile.TemporaryDirectory() as folder:
        cli = begin(os.path.abspath(sys.argv[1]), folder)
        outcomes = [passes(case, cli) for case in cases if not names or case.__name__ in names]
    return 0 if all(outcomes) else 1
