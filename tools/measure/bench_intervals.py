#!/usr/bin/env python3
"""How honest forecasts are: of 500 missions on each of six robots, how many take an energy inside the 95 % interval that was
stated before?

The two robots whose tables ship, the two others that ship as robot files, and the first two of random_robots.py from a
seed on that are strong enough. Of each the tables are made anew, as make robot does. Each mission has a robot of its own,
which differs from its file in ground, payload, motors and battery, learns on a way, and is forecast on the next. Prints a
table and writes figures and tables for figures.py. Exit status 2: a program failed; nothing was written.
"""
import hashlib
import json
import math
import os
from functools import partial
from pathlib import Path

import numpy as np

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, read_text, run, shown_path, whole_number, write_whole
from tools.design import balancer_design, robot_json, robot_trials
from tools.design.robot_findings import Making
from tools.measure import bench_robots, progress, random_robots
from tools.measure.figure_store import write_tables

SHIPPED = ("gao2018", "courier24", "nxtway", "hoverbot")
RANDOM, RANDOM_SEED = 2, 5001  # robots, and the seed of the first that is tried; no development used those from it on
MISSIONS, MISSION_SEED, AT_ONCE = 500, 30001, 25
CONFIDENCE, OFF = 95.0, 2.0    # %, and points that the share may be off
HEADINGS = ("", "missions", "inside 95 %, %", "forecast off, %", "deviation stated, %", "unlearned off, %")


def folder_of(build, name):
    folder = build / name
    (folder / "tables").mkdir(parents=True, exist_ok=True)
    return folder


def strong_robots(build):
    """Files of the first random robots that their physics let drive."""
    files, seed = [], RANDOM_SEED
    while len(files) < RANDOM:
        data = random_robots.draw(seed)
        folder = folder_of(build, data["name"])
        robot_file = folder / f"{data['name']}.cfg"
        write_whole(robot_file, random_robots.robot_file(data))
        try:
            robot_json.load(robot_file)
            robot_trials.tool("gain_design", robot_file, "--tables", folder / "tables", "--initial-energy")
            files.append(robot_file)
        except ToolError as error:
            if not any(text in str(error) for text in bench_robots.PHYSICS):
                raise
        seed += 1
    return files


def make_tables(making):
    """As make robot does; missions drive legs, which need no transients of segments."""
    robot = robot_json.load(making.robot_file)
    balancer_design.design_controller(making)
    balancer_design.identify(making, robot, balancer_design.try_balance(making)["standing_voltage_rms_v"])
    balancer_design.make_learning(making)


def prepare(robot_file, build):
    """The program that drives missions by tables that were made for it."""
    making = Making(robot_file, folder_of(build, robot_file.stem))
    make_tables(making)
    program, = robot_trials.build(making.folder, "jp-trip")
    return program, robot_file


def trips(task):
    """Some missions of a robot, one after the other, as jp-trip prints them. What the same program drove before is kept
    beside it, so that an interrupted bench goes on."""
    program, robot_file, first, count = task
    driven_by = hashlib.sha256(program.read_bytes() + robot_file.read_bytes()).hexdigest()[:16]
    path = program.parent / "missions" / f"{driven_by}_{first}_{count}.json"
    if not path.exists():
        write_whole(path, robot_trials.called([program, robot_file, f"--count={count}", f"--seed={MISSION_SEED + first}"],
                                              "jp-trip"))
    return robot_file.stem, [json.loads(line) for line in read_text(path).splitlines()]


def drive_all(files, build, missions, workers):
    """Missions of each robot, by its name; with a bar."""
    found = {path.stem: [] for path in files}
    with progress.workers(workers) as track:
        prepared = list(track(partial(prepare, build=build), files, "tables"))
        tasks = [(*of_robot, first, min(AT_ONCE, missions - first)) for of_robot in prepared
                 for first in range(0, missions, AT_ONCE)]
        for name, some in track(trips, tasks, "missions"):
            found[name] += some
    return found


def row(name, found):
    """A line of the table: a mission that does not end counts as outside."""
    done = [trip for trip in found if trip["outcome"] == "done"]
    if not done:
        raise ToolError(f"{name}: no mission came to its end")
    predicted, measured, deviation, unlearned = (np.array([trip[key] for trip in done]) for key in (
        "predicted_j", "measured_j", "std_j", "prior_predicted_j"))
    inside = 100 * sum(trip["inside"] for trip in done) / len(found)
    return (name, str(len(found)), f"{inside:.1f}", f"{100 * np.abs(predicted / measured - 1).mean():.3f}",
            f"{100 * (deviation / measured).mean():.3f}", f"{100 * np.abs(unlearned / measured - 1).mean():.3g}")


def command_of(missions):
    return "make bench-intervals" if missions == MISSIONS else f"python -m tools.measure.bench_intervals --missions {missions}"


def figures_of(table):
    return [{"name": f"{missions} missions of {name} that learned: share in the 95 % interval is off 95 % by",
             "value": math.fabs(float(inside) - CONFIDENCE), "unit": "points", "bound": {"op": "<=", "value": OFF},
             "command": command_of(int(missions))} for name, missions, inside, *_ in table]


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--missions", metavar="N", type=whole_number(1, 1_000_000), default=MISSIONS,
                        help=f"of each robot (default: {MISSIONS})")
    parser.add_argument("--workers", metavar="N", type=whole_number(1, 4096), default=os.cpu_count(),
                        help="default: one for each core")
    parser.add_argument("--bench", metavar="FILE", type=Path,
                        help="where the figures go, and beside them the tables (default: build/bench/intervals.json)")
    return parser.parse_args()


def main():
    options = arguments()
    build = robot_json.build_directory().resolve() / "intervals"
    files = [ROOT / "sim" / "robots" / f"{name}.cfg" for name in SHIPPED] + strong_robots(build)
    table = [row(*of_robot) for of_robot in drive_all(files, build, options.missions, options.workers).items()]
    path = options.bench or robot_json.build_directory() / "bench/intervals.json"
    write_whole(path, json.dumps(figures_of(table), indent=2, ensure_ascii=False) + "\n")
    write_tables(path.with_suffix(".tables.json"), {"intervals": (HEADINGS, table)})
    print()
    print_aligned([HEADINGS, *table])
    print(f"\nwrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
