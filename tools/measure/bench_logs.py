#!/usr/bin/env python3
"""Robots whose file is wrong by 20 % in every constant: what do logs of a drive tell of them, and how surely?

The file of a robot is made wrong, each constant up or down by chance; its controller is designed from that, and the
robot as it is drives the routes of tools.operate.excite with it. From the logs, the wrong file, its weight and a
measured distance the constants are identified. Then tables are made once more, of the corrected file, and what they
forecast of random routes is compared with what the robot takes. A robot that falls leaves no log: another one is drawn.
Prints tables, writes figures and tables for figures.py. Exit status 2: a program failed; nothing was written.
"""
import json
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tools.common import (ROOT, ArgumentParser, ToolError, print_aligned, read_text, run, shown_path, whole_number,
                          write_whole)
from tools.design import robot_json, robot_trials
from tools.identify import log_can, log_identify, robot_fit, robot_text
from tools.measure.figure_store import write_tables
from tools.operate import excite
from tools.operate.can_messages import GROUPS, database

COMMAND = "make bench-logs"
ROBOTS = ("courier24", "gao2018", "nxtway", "hoverbot")
SEED = 1001  # of the first; development used those below
DRAWS = 2          # of each robot
ATTEMPTS_MAX = 20  # for them
WRONG = 0.2
SPACE = excite.Space(2.0, 1.5)  # 4 x 3 m
ROUTES = 3         # to forecast
SURE = 1.96        # deviations, of 95 %

SAMPLES, TELEMETRY = "samples", "telemetry"
HEADINGS = ("robot", "log", "constant", "error", "its deviation", "")

CONSTANT_BAR = 3.0   # %, mean of what samples tell
SURE_BAR = 90.0      # %, of the constants inside their 95 %
FORECAST_BAR = 1.0   # %, mean


@dataclass(frozen=True)
class Found:
    """A constant that the log told."""
    robot: str
    kind: str
    key: str
    error: float      # %, of the true one
    deviation: float  # %

    @property
    def is_inside(self):
        return abs(self.error) <= SURE * self.deviation


@dataclass(frozen=True)
class Result:
    robot: str
    seed: int
    found: list
    before: list  # %, forecasts of the wrong file's tables against what was driven
    after: list


# ---- a robot and its wrong file ------------------------------------------------------------------------------------

def wrong_values(true, seed):
    """Every constant that is above 0. A battery whose voltage the controller would refuse is off to the other side."""
    generator = np.random.default_rng(seed)
    values = {key: true.number(key) * (1 + WRONG * generator.choice([-1, 1]))
              for key in robot_fit.UNITS if true.number(key) > 0}
    voltage = true.number("supply.voltage_v")
    if not true.number("control.voltage_min_v") < values["supply.voltage_v"] < true.number("control.voltage_max_v"):
        values["supply.voltage_v"] = 2 * voltage - values["supply.voltage_v"]
    return values


def write_robot(path, source, values):
    write_whole(path, robot_text.rewritten(source, read_text(source), values))
    return path


def make_tables(folder, robot_file):
    (folder / "tables").mkdir(parents=True, exist_ok=True)
    robot_trials.tool("gain_design", robot_file, "--tables", folder / "tables", "--initial-energy")


def record(program, routes, true_file, folder, seed):
    """A log of each route, and of a straight way with its length."""
    pose, logs = excite.Pose(0.0, 0.0, 0.0), []
    for index, waypoints in enumerate([*(route.waypoints for route in routes), None]):
        points = [(2.0, 0.0)] if waypoints is None else [pose.to_local(point) for point in waypoints]
        output = folder / f"route{index}"
        output.mkdir(parents=True)
        (_, x, y, heading), *_ = excite.simulate(program, true_file, points, output, 100 * seed + index, ("--frames",))
        logs.append(output / "frames.log")
        pose = excite.Pose(*pose.to_world(x[-1], y[-1]), pose.heading + heading[-1])
    return logs[:-1], (str(logs[-1]), str(float(np.hypot(x[-1], y[-1]))))


def without_samples(path):
    """The log of a robot whose sensors and bridges are on its board."""
    names = (*GROUPS["CurrentSensors"], "CurrentSensors", "MotorCommand")
    identifiers = "|".join(f"{database().get_message_by_name(name).frame_id:03X}" for name in names)
    pattern = re.compile(rf"^\S+ \S+ (?:{identifiers})#.*\n", re.M)
    output = path.with_name("telemetry.log")
    write_whole(output, pattern.sub("", read_text(path)))
    return output


# ---- identification ------------------------------------------------------------------------------------------------

def identified(wrong, logs, mass, distance):
    """RobotFit of these logs."""
    references = robot_fit.References(mass, log_identify.radius_by(*distance, wrong))
    return log_identify.identify(wrong, [log_can.read(path, wrong) for path in logs], references)[0]


def compared(true, found, kind):
    return [Found(true.name, kind, one.key, 100 * (one.value / true.number(one.key) - 1),
                  100 * one.deviation / one.value) for one in found.constants if one.is_told]


def forecasts(folder, true_file, seed):
    """% by which the forecasts of these tables miss the energy that the robot itself takes."""
    program, = robot_trials.build(folder, "jp-mission")
    errors = []
    for index in range(ROUTES):
        drive = robot_trials.drive(program, true_file, folder, 1000 * seed + index)
        total = json.loads(read_text(folder / "route" / "summary.json"))["strategies"][0]["total"]
        errors.append(100 * (drive.forecast / total["plant_energy_j"] - 1))
    return errors


def measure(name, seed, folder):
    """ToolError: this robot does not drive with the controller of its wrong file."""
    true_file = ROOT / f"sim/robots/{name}.cfg"
    true = robot_json.load(true_file)
    values = wrong_values(true, seed)
    wrong_file = write_robot(folder / "wrong" / f"{name}.cfg", true_file, values)
    # A robot measures its supply: its controller knows the voltage.
    values = {key: value for key, value in values.items() if key != "supply.voltage_v"}
    make_tables(folder, write_robot(folder / f"{name}.cfg", true_file, values))
    program, = robot_trials.build(folder, "jp-plant")
    routes = excite.plan(program, folder / f"{name}.cfg", SPACE)
    logs, distance = record(program, routes, true_file, folder / "logs", seed)
    wrong = robot_json.load(wrong_file)
    mass = true.number("body.mass_kg") + 2 * true.number("wheel.mass_kg")
    fits = {kind: identified(wrong, of_kind, mass, distance)
            for kind, of_kind in ((SAMPLES, logs), (TELEMETRY, [without_samples(path) for path in logs]))}
    before = forecasts(folder, true_file, seed)
    corrected = folder / "corrected"
    write_whole(corrected / f"{name}.cfg", log_identify.corrected_text(wrong_file, fits[SAMPLES]))
    make_tables(corrected, corrected / f"{name}.cfg")
    return Result(name, seed, [one for kind, fit in fits.items() for one in compared(true, fit, kind)], before,
                  forecasts(corrected, true_file, seed))


def measure_robot(name, first, draws):
    """So many that drive. ToolError: too few of them do."""
    results = []
    build = robot_json.build_directory().resolve() / "logs"
    build.mkdir(parents=True, exist_ok=True)
    for seed in range(first, first + ATTEMPTS_MAX):
        with tempfile.TemporaryDirectory(dir=build) as folder:
            try:
                results.append(measure(name, seed, Path(folder)))
                before, after = (np.mean(np.abs(errors)) for errors in (results[-1].before, results[-1].after))
                said = f"forecast off by {after:.2f} % after {before:.1f} %"
            except ToolError as error:
                said = str(error).replace(f"{folder}/", "")
        print(f"{name}, seed {seed}: {said}", flush=True)
        if len(results) == draws:
            return results
    raise ToolError(f"{name}: of {ATTEMPTS_MAX} with a wrong file only {len(results)} drive")


# ---- tables and figures --------------------------------------------------------------------------------------------

def table_of(results):
    rows = []
    for name in dict.fromkeys(result.robot for result in results):
        for kind in (SAMPLES, TELEMETRY):
            found = [one for result in results for one in result.found if (one.robot, one.kind) == (name, kind)]
            for key in dict.fromkeys(one.key for one in found):
                own = [one for one in found if one.key == key]
                rows.append((name, kind, key, f"{np.mean([abs(one.error) for one in own]):.2f}",
                             f"{np.mean([one.deviation for one in own]):.2f}", "%"))
    return rows


def figures_of(results):
    def figure(name, value, op=None, bar=None):
        return {"name": f"robots wrong by 20 %, identified from logs: {name}", "value": float(value), "unit": "%",
                "bound": {"op": op, "value": bar} if op else None, "command": COMMAND}

    found = {kind: [one for result in results for one in result.found if one.kind == kind]
             for kind in (SAMPLES, TELEMETRY)}
    inside = {kind: 100 * np.mean([one.is_inside for one in ones]) for kind, ones in found.items()}
    before, after = ([abs(error) for result in results for error in getattr(result, name)]
                     for name in ("before", "after"))
    return [figure("constants that samples tell, mean error", np.mean([abs(one.error) for one in found[SAMPLES]]), "<=",
                   CONSTANT_BAR),
            figure("the same, inside their 95 %", inside[SAMPLES], ">=", SURE_BAR),
            figure("constants that telemetry tells, mean error", np.mean([abs(one.error) for one in found[TELEMETRY]])),
            figure("the same by telemetry, inside their 95 %", inside[TELEMETRY], ">=", SURE_BAR),
            figure("forecast of the wrong file, mean error", np.mean(before)),
            figure("forecast of the corrected file, mean error", np.mean(after), "<=", FORECAST_BAR),
            figure("the same, worst", np.max(after))]


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--robots", metavar="NAME", nargs="+", choices=ROBOTS, default=ROBOTS,
                        help=f"which (default: {' '.join(ROBOTS)})")
    parser.add_argument("--draws", metavar="N", type=whole_number(1, 1000), default=DRAWS,
                        help=f"wrong files of each robot (default: {DRAWS})")
    parser.add_argument("--seed", metavar="S", type=whole_number(0, 2**31), default=SEED,
                        help=f"of the first; the others follow (default: {SEED})")
    parser.add_argument("--bench", metavar="FILE", type=Path,
                        help="where the figures go, and beside them the tables (default: build/bench/logs.json)")
    return parser.parse_args()


def main():
    options = arguments()
    results = [result for name in options.robots for result in measure_robot(name, options.seed, options.draws)]
    table, figures = table_of(results), figures_of(results)
    path = options.bench or robot_json.build_directory() / "bench/logs.json"
    write_whole(path, json.dumps(figures, indent=2, ensure_ascii=False) + "\n")
    write_tables(path.with_suffix(".tables.json"), {"logs": (HEADINGS, table)})
    print()
    print_aligned([HEADINGS, *table])
    print()
    print_aligned([("", "measured", ""), *((one["name"], f"{one['value']:.3g}", one["unit"]) for one in figures)])
    print(f"\nwrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
