"""The programs as processes, for tests/sil, tests/vcan and tests/firmware: how they start and end, what they say, how a
failure must look."""
import contextlib
import json
import os
import signal
import subprocess
import time
from pathlib import Path
from types import SimpleNamespace

ROOT = Path(__file__).resolve().parents[1]
BUILD = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve()
BIN = BUILD / "bin"
VCAN_RESULTS = BUILD / "test/vcan"  # from inside with_vcan.sh to outside
CANDUMP = "candump.log"
LOG = "log_cruise.csv"

LIMIT = 600  # s, for what takes seconds on an idle machine: something hangs


def stay_on_one_cpu():
    """Of this worker of pytest and all that it starts: programs that answer each other byte by byte would mostly wait for
    the other's CPU to wake up."""
    cpus = sorted(os.sched_getaffinity(0))
    worker = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
    os.sched_setaffinity(0, {cpus[worker % len(cpus)]})


def write_scenario(path, *waypoints, robot="gao2018"):
    """A scenario that begins at the origin."""
    points = ", ".join(f"[{x}, {y}]" for x, y in [(0.0, 0.0), *waypoints])
    path.write_text(f'name = "short";\nrobot = "{ROOT}/sim/robots/{robot}.cfg";\nenergy_model = "identified";\n'
                    f"seed = 1;\nwaypoints = ( {points} );\n")
    return path


def with_battery_energy(path):
    path.write_text(path.read_text() + 'energy = "battery";\n')
    return path


def write_vcan_scenario(path):
    """Short even in an emulated kernel."""
    return write_scenario(path, (0.5, 0.2))


def wait_until(condition, what, limit=LIMIT):
    end = time.monotonic() + limit
    while not condition():
        assert time.monotonic() < end, f"{what}: not within {limit} s"
        time.sleep(0.005)


class Program:
    """A process whose output is in files, so that it can be read while it runs."""

    def __init__(self, folder, name, command, counts=None):
        self.out, self.err, self._counts = folder / f"{name}.out", folder / f"{name}.err", counts
        with self.out.open("w") as out, self.err.open("w") as err:
            self.process = subprocess.Popen([str(part) for part in command], cwd=ROOT, stdin=subprocess.DEVNULL,
                                            stdout=out, stderr=err, env=dict(os.environ, PYTHONUNBUFFERED="1"))

    @property
    def running(self):
        return self.process.poll() is None

    def opens(self, *lines):
        """Pseudo-terminals, which it offers when it has read its files."""
        wait_until(lambda: all(line.exists() for line in lines) or not self.running, f"{self.out.name}: {lines}")
        assert self.running, self.err.read_text()

    def says(self, text):
        """To whoever looks at its terminal."""
        wait_until(lambda: text in self.out.read_text() or not self.running, f"{self.out.name} says {text}")
        assert text in self.out.read_text(), self.err.read_text()

    def wait(self, limit=LIMIT):
        """The result as of subprocess.run(), and what it has counted, where it writes that and came to its end."""
        self.process.wait(limit)
        counts = json.loads(self._counts.read_text()) if self._counts and self._counts.exists() else None
        return SimpleNamespace(returncode=self.process.returncode, stdout=self.out.read_text(),
                               stderr=self.err.read_text(), counts=counts)

    def stop(self, with_signal=signal.SIGTERM):
        self.process.send_signal(with_signal)
        return self.wait()


class Programs:
    """Starts programs; ends what still runs at the end of a `with`."""

    def __init__(self, folder):
        self.folder = folder
        self._started = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for program in self._started:
            with contextlib.suppress(ProcessLookupError):
                program.process.kill()
            program.process.wait()

    def start(self, *command):
        return self._start(command, self._next_name(command))

    def ecu(self, bus, *options):
        return self._start_counting(BIN / "jp-ecu", "--bus", bus, *options)

    def plant(self, scenario, *options, patience=LIMIT):
        return self._start_counting(BIN / "jp-plant", scenario, f"--patience={patience}", *options)

    def _start_counting(self, *command):
        name = self._next_name(command)
        counts = self.folder / f"{name}.json"
        return self._start((*command, "--json", counts), name, counts)

    def _start(self, command, name, counts=None):
        program = Program(self.folder, name, command, counts)
        self._started.append(program)
        return program

    def _next_name(self, command):
        return f"{len(self._started)}-{Path(command[0]).name}"


def assert_verdict(result, *parts):
    """Exit status 1 and a single line on stderr that holds all parts: the input is right, what comes of it is not."""
    assert_one_line_error(result, *parts, status=1)


def assert_one_line_error(result, *parts, status=2):
    """This exit status and a single line on stderr that holds all parts."""
    assert result.returncode == status, result.stdout + result.stderr
    lines = result.stderr.splitlines()
    assert len(lines) == 1, result.stderr
    for part in parts:
        assert str(part) in lines[0], lines[0]


def assert_done(program, limit=LIMIT):
    result = program.wait(limit)
    assert (result.returncode, result.stderr) == (0, ""), result.stdout + result.stderr
    return result


def assert_stopped(ecu):
    """What it has counted."""
    result = ecu.stop()
    assert (result.returncode, result.stderr) == (0, "")
    return result.counts


def drive_in_process(scenario, output):
    """The drive that all others must equal."""
    subprocess.run([BIN / "jp-plant", scenario, "--bus", "in-process", "--output", output], check=True,
                   stdout=subprocess.DEVNULL, timeout=LIMIT)
    return output


def summary(folder):
    return json.loads((folder / "summary.json").read_text())


def assert_same_drive(folder, other):
    """Trajectory and energies of every tick, the log's bytes, and the summary but for clock and pace."""
    one, two = summary(folder), summary(other)
    assert one["bus"]["fingerprint"] == two["bus"]["fingerprint"]
    log = one["strategies"][0]["log"]
    assert (folder / log).read_bytes() == (other / log).read_bytes()
    for result in (one, two):
        del result["simulation"], result["bus"]
    assert one == two
