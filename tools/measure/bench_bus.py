#!/usr/bin/env python3
"""Measure controller and robot as two programs on a bus.

Drives a scenario in lockstep in one process, over SLCAN, over vcan and with the firmware's image in QEMU as the
controller, and compares them byte by byte; drives 50 missions of the faulty bus over vcan; drives a scenario in real
time over SLCAN and counts the deadlines that were missed. Prints a table, writes figures for figures.py and leaves the
missions in build/bus. Exit status 2: a program failed; nothing was written.
"""
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, run, shown_path, write_whole
from tools.design import robot_json

SCENARIO = ROOT / "sim/scenarios/gao2018_mission.cfg"
REAL_TIME_SCENARIO = ROOT / "sim/scenarios/courier24_mission.cfg"
REAL_TIME_SECONDS = 60  # the scenario takes longer
LATE_BAR = 0.1  # %
PIL_SECONDS = 3600  # a byte of the emulated serial line takes some 40 µs
COMMAND = "make figures"


def call(command, seconds=1800):
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False,
                            timeout=seconds, cwd=ROOT)
    if result.returncode != 0:
        reason = (result.stderr.strip() or result.stdout.strip() or "no reason given").splitlines()[-1]
        raise ToolError(f"{Path(command[0]).name}: exit status {result.returncode}: {reason}")
    return result


def read_summary(folder):
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def drive_everywhere(build, folder):
    """Folders of the same mission by transport."""
    folders = {name: folder / name for name in ("in process", "SLCAN", "vcan", "PIL")}
    call([build / "bin/jp-plant", SCENARIO, "--bus", "in-process", "--output", folders["in process"], "--frames"])
    call(["tools/operate/bus_mission.sh", "slcan", SCENARIO, folders["SLCAN"]])
    call(["tools/operate/with_vcan.sh", "--", "tools/operate/bus_mission.sh", "vcan", SCENARIO, folders["vcan"]])
    call(["tools/operate/bus_mission.sh", "pil", SCENARIO, folders["PIL"]], PIL_SECONDS)
    return folders


def are_equal(one, other):
    files = ("log_cruise.csv", "frames.log")
    return (read_summary(one)["bus"]["fingerprint"] == read_summary(other)["bus"]["fingerprint"] and
            read_summary(one)["strategies"] == read_summary(other)["strategies"] and
            all((one / name).read_bytes() == (other / name).read_bytes() for name in files))


def sample_on_vcan(build):
    """50 missions of the faulty bus against jp-ecu, in one boot."""
    script = (f"'{build}/bin/jp-ecu' --bus can:vcan0 --robot courier24 >/dev/null & ecu=$!; "
              f"'{build}/bench/bench_bus' --bus can:vcan0; status=$?; kill $ecu; exit $status")
    return json.loads(call(["tools/operate/with_vcan.sh", "--", "bash", "-c", script]).stdout)


def drive_in_real_time(build, folder):
    """The plant's counts of a drive by the clock."""
    line = folder / "line"
    with subprocess.Popen([build / "bin/jp-ecu", "--bus", f"pty:{line}", "--robot", "courier24", "--real-time"],
                          stdout=subprocess.DEVNULL) as ecu:
        try:
            while not line.exists() and ecu.poll() is None:
                time.sleep(0.05)
            call([build / "bin/jp-plant", REAL_TIME_SCENARIO, "--bus", f"slcan:{line}", "--pace", "real-time",
                  "--output", folder / "real time"])
        finally:
            ecu.terminate()
    return read_summary(folder / "real time")["bus"]


def figure(name, value, unit, bound):
    return {"name": name, "value": value, "unit": unit, "bound": bound, "command": COMMAND}


def measure(build, folder):
    folders = drive_everywhere(build, folder)
    reference = folders["in process"]
    equal = sum(are_equal(reference, other) for other in folders.values())
    yield figure("reference mission: same frames, trajectory and energies in process, over SLCAN, over vcan and by the "
                 "firmware in QEMU (PIL), of 4", equal, "", {"op": "==", "value": len(folders)})
    yield figure("reference mission over a bus: energy", read_summary(reference)["strategies"][0]["total"]
                 ["measured_energy_j"], "J", None)
    yield from sample_on_vcan(build)
    clock = drive_in_real_time(build, folder)
    if clock["ticks_driven"] < REAL_TIME_SECONDS * 1000:
        raise ToolError(f"{REAL_TIME_SCENARIO.name}: only {clock['ticks_driven']} ticks in real time")
    yield figure("real time, 1 kHz: ticks driven", clock["ticks_driven"], "", None)
    yield figure("real time, 1 kHz: commands that missed their deadline",
                 100 * clock["commands_late"] / clock["ticks_driven"], "%", {"op": "<=", "value": LATE_BAR})


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--bench", metavar="FILE", type=Path, help="where the figures go (default: build/bench/bus.json)")
    options = parser.parse_args()
    build = Path(os.path.abspath(robot_json.build_directory()))
    path = options.bench or build / "bench/bus.json"
    folder = build / "bus"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    figures = list(measure(build, folder))
    call([sys.executable, "-m", "tools.measure.bus_load", "--log", folder / "vcan/frames.log", "--bench",
          path.with_name("bus_load.json")])
    print_aligned([("what", "measured"), *((f["name"], f"{f['value']:.6g} {f['unit']}".strip()) for f in figures)])
    write_whole(path, json.dumps(figures, indent=2) + "\n")
    print(f"wrote {shown_path(path)}")


if __name__ == "__main__":
    run(main)
