#!/usr/bin/env python3
"""From a robot file to all of its tables, tried out on the way: is this robot good, and how good?

The controller is designed and leant, pushed and left standing on the non-linear plant; its energy is identified, what it
can learn is made, and it drives routes that nothing was fitted to. Everything is made in a folder; the tables go to
src/tables/ when the robot does what it must. Exit status 1: it does not, and why; 2: bad input. Then src/tables/ is as it
was. The report is written either way.
"""
import json
import math
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, read_text, run, shown_path, write_whole
from tools.design import closed_loop, linear_model, robot_json, robot_trials, specification, tables_header
from tools.report import robot_report

ROUTES = 20
ROUTE_SEED = 2001   # of the first; no development used it
TRIPS = 60
TRIP_SEED = 7001

# As in the paper; or fewer, of a robot that takes long to settle.
EXPERIMENTS, EXPERIMENTS_MIN = 1000, 300

# What a robot must do.
LEAN_DEG, LEAN_SHARE = 10.0, 0.5  # comes back from the first, or from this share of what its motors allow
FORECAST_MEAN, FORECAST_WORST = 0.5, 2.0  # %, before it has learned
MISS_CM = 2.0
# Of 60 trips, where 57 are expected inside their 95 % interval: fewer happen by chance once in a thousand.
INSIDE_PERCENT = 85.0


@dataclass(frozen=True)
class Finding:
    """What was measured, and what it must be."""
    name: str
    value: float
    unit: str
    bar: str       # as people read it; empty: for information
    is_met: bool
    remedy: str


def at_least(name, value, unit, low, remedy):
    return Finding(name, value, unit, f"≥ {low:.3g}", value >= low, remedy)


def at_most(name, value, unit, high, remedy):
    return Finding(name, value, unit, f"≤ {high:.3g}", value <= high, remedy)


def information(name, value, unit):
    return Finding(name, value, unit, "", True, "")


class Steps:
    """Says what is being done, and how long it took."""

    def __init__(self, count):
        self._count, self._number = count, 0

    def do(self, title, work):
        self._number += 1
        print(f"{self._number}/{self._count}  {title:<58}", end="", flush=True)
        begun = time.monotonic()
        try:
            result = work()
        except ToolError:
            print("  failed", flush=True)
            raise
        print(f"{time.monotonic() - begun:7.1f} s", flush=True)
        return result


@dataclass(frozen=True)
class Making:
    """Paths of a robot in the making."""
    robot_file: Path
    folder: Path

    @property
    def tables(self):
        return self.folder / "tables"

    @property
    def experiments(self):
        return self.folder / "identify"


def design_controller(making):
    """Gains, and a model of the energy to begin with."""
    for path in making.tables.glob("*.c"):
        path.unlink()
    return robot_trials.tool("gain_design", making.robot_file, "--tables", making.tables, "--initial-energy")


def try_balance(making):
    program, = robot_trials.build(making.folder, "jp-balance")
    return robot_trials.balance(program, making.robot_file)


def identify(making, robot, shaking):
    """shaking: V of noise at the motors."""
    program, = robot_trials.build(making.folder, "jp-identify")
    robot_trials.experiment(program, making.robot_file, robot, shaking, making.experiments, EXPERIMENTS, EXPERIMENTS_MIN)
    for energy in (closed_loop.MOTOR, closed_loop.BATTERY):
        robot_trials.identify(making.robot_file, energy, making.experiments, making.tables)
    return {energy: json.loads(read_text(making.experiments / f"identification{suffix}.json"))["validation"]
            for energy, suffix in ((closed_loop.MOTOR, ""), (closed_loop.BATTERY, "_battery"))}


def make_horizon(making):
    robot_trials.tool("horizon", making.robot_file, "--tables", making.tables, "--pictures", making.folder)


def make_learning(making):
    program, = robot_trials.build(making.folder, "jp-trip")
    robot_trials.tool("learning", making.robot_file, "--jp-trip", program, "--tables", making.tables, "--models",
                      making.tables, "--pictures", making.folder)


def drive_routes(making):
    program, = robot_trials.build(making.folder, "jp-mission")
    return [robot_trials.drive(program, making.robot_file, making.folder, ROUTE_SEED + k) for k in range(ROUTES)]


def drive_trips(making):
    """Of robots that differ from their file, and have learned a little."""
    program, = robot_trials.build(making.folder, "jp-trip")
    lines = robot_trials.called([program, making.robot_file, f"--count={TRIPS}", f"--seed={TRIP_SEED}"], "jp-trip")
    return [json.loads(line) for line in lines.splitlines()]


def findings_of(robot, balance, validations, drives, trips):
    plant = linear_model.linear_plant(robot)
    allowed = math.degrees(specification.recoverable_lean(robot, plant))
    mass = robot.positive("body.mass_kg") + 2 * robot.positive("wheel.mass_kg")
    errors = 100 * np.abs([drive.error for drive in drives])
    done = [trip for trip in trips if trip["outcome"] == "done"]
    return [
        at_least("comes back from a lean of", balance["lean_deg"], "°", min(LEAN_DEG, LEAN_SHARE * allowed),
                 "a longer specification.settling_s, finer encoders or a quieter gyro"),
        information("its motors allow, without noise", allowed, "°"),
        information("takes a push that gives it", balance["push_n_s"] / mass, "m/s"),
        information("lean while standing, rms", balance["standing_lean_rms_deg"], "°"),
        information("voltage while standing, rms", balance["standing_voltage_rms_v"], "V"),
        *(information(f"energy model of the {energy}, mean error", validation["mean_relative_error_percent"], "%")
          for energy, validation in validations.items()),
        at_most(f"forecast against {len(drives)} routes, mean", errors.mean(), "%", FORECAST_MEAN,
                "finer encoders or a quieter gyro: noise takes energy that no model knows"),
        at_most("the same, worst", errors.max(), "%", FORECAST_WORST, "lower limits.speed_m_s, or stronger motors"),
        at_most("passes its waypoints within", 100 * max(drive.miss for drive in drives), "cm", MISS_CM,
                "finer encoders, or a quieter gyro"),
        at_least("trips of robots that differ, driven", 100 * len(done) / len(trips), "%", 100,
                 "a smaller limits.payload_kg, lower limits.speed_m_s, or stronger motors"),
        at_least("of these inside their 95 % interval", 100 * sum(trip["inside"] for trip in done) / max(len(done), 1),
                 "%", INSIDE_PERCENT, "nothing in the robot file: forecasts of this robot are less sure than they say"),
    ]


def print_findings(findings):
    print()
    print_aligned([("", "measured", "", "must be", ""),
                   *((f.name, f"{f.value:.3g}", f.unit, f.bar, "" if f.is_met else "MISSED") for f in findings)])
    print()


def validations_of(making, robot):
    """For the report: name, what is shown, and picture."""
    return [*(("Energy model", "Validation on experiments that were not fitted.",
               making.experiments / f"identification{suffix}.png") for suffix in ("", "_battery")),
            ("Transients", "What rounding to the tables' formats costs.", making.folder / f"horizon_{robot.name}.png"),
            ("Learning", "Robots of other ground, payload and motors: what is left when all is learned, and how true their "
                         "forecasts are.", making.folder / f"learning_{robot.name}.png")]


def install(making, tables):
    """All at once: the robot is whole, or as it was."""
    for path in sorted(making.tables.glob("*.c")):
        write_whole(tables / path.name, path.read_bytes())
    if tables == ROOT / "src" / "tables":
        tables_header.declare()


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C files go (default: src/tables)")
    return parser.parse_args()


def work(making):
    """Every step; the robot, what was found, and what the report shows."""
    steps = Steps(8)
    robot = steps.do("robot file, and the settings that it leaves out", lambda: robot_json.load(making.robot_file))
    steps.do("controller, designed and checked", lambda: design_controller(making))
    balance = steps.do("leant, pushed and left standing", lambda: try_balance(making))
    validations = steps.do("energy, identified in experiments",
                           lambda: identify(making, robot, balance["standing_voltage_rms_v"]))
    steps.do("transients of segments", lambda: make_horizon(making))
    steps.do("what it can learn", lambda: make_learning(making))
    drives = steps.do(f"{ROUTES} routes driven", lambda: drive_routes(making))
    trips = steps.do(f"{TRIPS} robots that differ, learning", lambda: drive_trips(making))
    return robot, findings_of(robot, balance, validations, drives, trips), drives, trips


def main():
    options = arguments()
    robot_file = robot_json.robot_path(options.robot).resolve()
    making = Making(robot_file, robot_json.build_directory().resolve() / "robot" / robot_file.stem)
    making.tables.mkdir(parents=True, exist_ok=True)
    robot, findings, drives, trips = work(making)
    print_findings(findings)
    write_whole(making.folder / "robot.json", json.dumps([asdict(finding) for finding in findings], indent=2,
                                                         ensure_ascii=False, default=bool) + "\n")
    write_whole(making.folder / "report.html", robot_report.render(robot, findings, drives, trips,
                                                                   validations_of(making, robot)))
    print(f"wrote {shown_path(making.folder / 'report.html')}")
    missed = [finding for finding in findings if not finding.is_met]
    if missed:
        first = missed[0]
        print(f"{robot.name}: {first.name} {first.value:.3g} {first.unit}, must be {first.bar}: {first.remedy}")
        return 1
    install(making, options.tables)
    print(f"{robot.name}: good; its tables are in {shown_path(options.tables)}")
    return 0


if __name__ == "__main__":
    run(main)
