#!/usr/bin/env python3
"""Robots that nobody has seen, from their data sheets alone: which can balance, do they drive, and as was foretold?

Each is drawn by random_robots.py, designed without a setting of its own, leant and pushed; its energy is identified, tables of
its transients are made, and it drives a random route before it has learned anything. A robot that is refused must be refused by its physics. Prints a table and writes
figures and tables for figures.py. Exit status 2: a program failed; nothing was written.
"""
import json
import os
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from tools.common import ArgumentParser, ToolError, print_aligned, run, shown_path, whole_number, write_whole
from tools.design import closed_loop, robot_json, robot_trials
from tools.measure import progress, random_robots
from tools.measure.figure_store import write_tables

COMMAND = "make bench-robots"
ROBOTS = 200
SEED = 1001  # of the first; development used those below
EXPERIMENTS = 200, 60  # of each, as robot_trials.experiment() takes them

# What the design says of motors that are too weak, or of speeds that they do not reach.
PHYSICS = ("the motors at full voltage just lift the body", "are left beside the reserve for balance",
           "and so takes more than", "no voltage lets the wheels settle")

MEAN_BAR, WORST_BAR = 0.5, 2.0  # % of forecast against driven
HEADINGS = ("", "robots", "least", "median", "most", "")


@dataclass(frozen=True)
class Result:
    """Of a robot: refused, with the reason; or how it balances and drives."""
    seed: int
    reason: str     # empty: it was designed
    is_driven: bool
    lean: float     # °
    push: float     # m/s of its mass
    error: float    # %, of the forecast
    miss: float     # cm

    @property
    def is_weak(self):
        return any(text in self.reason for text in PHYSICS)


def mass_of(data):
    return data["body"]["mass_kg"] + 2 * data["wheel"]["mass_kg"]


def tried(folder, robot_file, data, seed):
    robot_trials.tool("gain_design", robot_file, "--tables", folder / "tables", "--initial-energy")
    balance, identify = robot_trials.build(folder, "jp-balance", "jp-identify")
    found = robot_trials.balance(balance, robot_file)
    robot_trials.experiment(identify, robot_file, robot_json.load(robot_file), found["standing_voltage_rms_v"],
                            folder / "identify", *EXPERIMENTS)
    robot_trials.identify(robot_file, closed_loop.MOTOR, folder / "identify", folder / "tables")
    robot_trials.tool("horizon", robot_file, "--tables", folder / "tables", "--pictures", folder)
    mission, = robot_trials.build(folder, "jp-mission")
    drive = robot_trials.drive(mission, robot_file, folder, seed)
    return Result(seed, "", True, found["lean_deg"], found["push_n_s"] / mass_of(data), 100 * abs(drive.error),
                  100 * drive.miss)


def measure(seed, build):
    """From its file to its drive. What fails is told with its reason."""
    data = random_robots.draw(seed)
    with tempfile.TemporaryDirectory(dir=build) as name:
        folder = Path(name)
        robot_file = folder / f"{data['name']}.cfg"
        (folder / "tables").mkdir()
        write_whole(robot_file, random_robots.robot_file(data))
        try:
            return tried(folder, robot_file, data, seed)
        except ToolError as error:
            return Result(seed, str(error).replace(f"{folder}/", ""), False, *4 * (float("nan"),))


def measure_all(seeds, workers):
    """In parallel, with a bar."""
    build = robot_json.build_directory().resolve() / "robots"
    build.mkdir(parents=True, exist_ok=True)
    with progress.workers(workers) as track:
        return list(track(partial(measure, build=build), seeds, "robots"))


def row(name, values, unit):
    return name, str(len(values)), *(f"{value:.3g}" for value in (min(values), np.median(values), max(values))), unit


def table_of(results):
    driven = [result for result in results if result.is_driven]
    return [("too weak or too slow, by their physics", str(sum(result.is_weak for result in results)), "", "", "", ""),
            ("refused or fallen otherwise", str(sum(not (result.is_driven or result.is_weak) for result in results)), "", "",
             "", ""),
            row("come back from a lean of", [result.lean for result in driven], "°"),
            row("take a push that gives them", [result.push for result in driven], "m/s"),
            row("pass their waypoints within", [result.miss for result in driven], "cm"),
            row("forecast against driven", [result.error for result in driven], "%")]


def figures_of(results):
    driven = [result for result in results if result.is_driven]
    able = sum(not result.is_weak for result in results)
    errors = [result.error for result in driven]

    def figure(name, value, unit, op, bar):
        return {"name": f"{len(results)} random robots from their data sheets: {name}", "value": value, "unit": unit,
                "bound": {"op": op, "value": bar}, "command": COMMAND}

    return [figure("of those that can, drive their route", 100 * len(driven) / able, "%", ">=", 100),
            figure("forecast against driven, mean", float(np.mean(errors)), "%", "<=", MEAN_BAR),
            figure("forecast against driven, worst", float(np.max(errors)), "%", "<=", WORST_BAR)]


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--robots", metavar="N", type=whole_number(1, 1_000_000), default=ROBOTS,
                        help=f"how many (default: {ROBOTS})")
    parser.add_argument("--seed", metavar="S", type=whole_number(0, 2**31), default=SEED,
                        help=f"of the first; the others follow (default: {SEED})")
    parser.add_argument("--workers", metavar="N", type=whole_number(1, 4096), default=os.cpu_count(),
                        help="default: one for each core")
    parser.add_argument("--bench", metavar="FILE", type=Path,
                        help="where the figures go, and beside them the tables (default: build/bench/robots.json)")
    return parser.parse_args()


def main():
    options = arguments()
    results = measure_all(range(options.seed, options.seed + options.robots), options.workers)
    for result in results:
        if not result.is_driven:
            print(f"{result.seed}: {result.reason}")
    if not any(result.is_driven for result in results):
        raise ToolError("no robot drove")
    table = table_of(results)
    path = options.bench or robot_json.build_directory() / "bench/robots.json"
    write_whole(path, json.dumps(figures_of(results), indent=2, ensure_ascii=False) + "\n")
    write_tables(path.with_suffix(".tables.json"), {"random_robots": (HEADINGS, table)})
    print()
    print_aligned([HEADINGS, *table])
    print(f"\nwrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
