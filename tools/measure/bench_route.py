#!/usr/bin/env python3
"""Measure the route optimiser against scipy's best of many starts: the paper's four segments and random routes.

jp-route plans; the same energies in double precision say how far each plan is from the least of SLSQP's results from the
greedy plan, from straight chords and from random starts. Prints a table and writes figures for figures.py. Exit
status 2: a program failed; nothing was written.
"""
import json
import math
import multiprocessing
import os
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, run, shown_path, whole_number, write_whole
from tools.design import closed_loop, horizon, robot_json
from tools.measure.route_oracle import Limits, Model, Route, transients_of

ROBOT = "gao2018"
COMMAND = "make figures"
SEED = 1

PAPER_POINTS = [(0, 0), (10, 10), (20, 15), (25, 25), (15, 30)]
PAPER_BAR = 1110.2  # J

LEGS = 8
TURN = math.radians(120)  # ±
LONG = (1, 15)            # m
SHORT = (0.7, 2.1)
SHORT_SHARE = 0.2  # of the routes

RANDOM_STARTS = 9
NEAR = 0.05     # %
NEAR_BAR = 99   # % of the routes

TIMEOUT = 600  # s, of jp-route


@dataclass(frozen=True)
class Kind:
    """Routes of one kind."""
    name: str
    lengths: tuple
    options: tuple  # of jp-route
    counts: bool    # among the routes that the bar is for


KINDS = (
    Kind("published model", LONG, ("--model", "published"), True),
    Kind("identified model", LONG, ("--settled",), True),
    Kind("short segments, with transients", SHORT, (), False),
)


@dataclass(frozen=True)
class Task:
    route: Route
    plan: dict  # of jp-route
    seed: int


@dataclass(frozen=True)
class Result:
    above: float  # % of the best
    gain: float   # % of the greedy plan


# ---- Plans ---------------------------------------------------------------------------------------------------------

def jp_route(arguments):
    """What it says of each route."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "plans.json"
        command = [robot_json.build_directory() / "bin/jp-route", "--robot", robot_json.robot_path(ROBOT), *arguments,
                   "--json", path]
        try:
            result = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False,
                                    timeout=TIMEOUT)
        except OSError as error:
            raise ToolError(f"{command[0]}: {error.strerror}; build it with `make`") from None
        if result.returncode != 0:
            raise ToolError(f"jp-route: {result.stderr.strip() or 'no reason given'}")
        return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def plan(points, options):
    """A plan for each row of points."""
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"{i}.json" for i in range(len(points))]
        for path, row in zip(paths, points):
            path.write_text(json.dumps({"points_m": [list(map(float, point)) for point in row]}), encoding="utf-8")
        return jp_route([*options, *paths])


def columns(segments):
    """γ, 1/T and σ."""
    return (np.array([segment[name] for segment in segments]) ** power
            for name, power in (("arc_rad", 1), ("duration_s", -1), ("turn_rad", 1)))


def energy_of(route, segments):
    """Of a plan as it is stored."""
    arc, pace, turn = columns(segments)
    return route.turned_as(arc, turn).energy(arc, pace)[0]


# ---- Routes --------------------------------------------------------------------------------------------------------

def limits_of(robot, shortest):
    return Limits(robot.positive("limits.speed_m_s"), robot.positive("limits.turn_rate_rad_s"),
                  math.radians(robot.number("limits.turn_deg")), shortest, robot.positive("limits.duration_s"))


def transients(robot):
    resistance = robot.positive("motor.resistance_ohm")
    return transients_of(*(
        horizon.rounded(horizon.table_of(axis, horizon.modes_of(robot, axis),
                                         closed_loop.energy(axis, closed_loop.MOTOR, resistance)))
        for axis in closed_loop.axes(robot)))


def route_along(points, robot, said, modes):
    chords = np.diff(np.asarray(points, float), axis=0)
    directions = np.arctan2(chords[:, 1], chords[:, 0])
    turns = (np.diff(directions, prepend=0) + math.pi) % math.tau - math.pi
    model = Model(said["parameters"])
    settled = said["settled"]
    limits = limits_of(robot, model.settling if settled else horizon.DURATION_MIN)
    return Route(model, limits, np.hypot(*chords.T), turns, None if settled else modes)


def draw_points(generator, lengths):
    """From the origin along x."""
    directions = np.cumsum(generator.uniform(-TURN, TURN, LEGS))
    chords = generator.uniform(*lengths, LEGS)[:, None] * np.column_stack([np.cos(directions), np.sin(directions)])
    return np.vstack([np.zeros(2), np.cumsum(chords, axis=0)])


def tasks_of(kind, robot, modes, seed, count):
    generator = np.random.default_rng(seed)
    points = [draw_points(generator, kind.lengths) for _ in range(count)]
    return [Task(route_along(row, robot, said, modes), said, seed + i)
            for i, (row, said) in enumerate(zip(points, plan(points, kind.options)))]


# ---- Against the oracle --------------------------------------------------------------------------------------------

def best_of_starts(task):
    """The least energy from all starts; the plan itself is none of them."""
    route, generator = task.route, np.random.default_rng(task.seed)
    arc, pace, turn = columns(task.plan["greedy"])
    found = [route.turned_as(arc, turn).optimum_from(arc, pace)[0],
             route.optimum_from(np.zeros(route.count), route.random_start(generator)[1])[0]]
    found += [route.optimum_from(*route.random_start(generator))[0] for _ in range(RANDOM_STARTS)]
    return min(found)


def compare(task):
    joint, greedy = (energy_of(task.route, task.plan[name]) for name in ("joint", "greedy"))
    best = min(best_of_starts(task), joint)
    return Result(100 * (joint / best - 1), 100 * (1 - joint / greedy))


def compare_all(name, tasks, workers):
    """In parallel, with a bar."""
    console = Console(stderr=True)
    bar = Progress(TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(),
                   console=console, disable=not console.is_terminal, transient=True)
    with multiprocessing.Pool(workers) as pool, bar:
        return list(bar.track(pool.imap(compare, tasks), len(tasks), description=name))


# ---- Figures -------------------------------------------------------------------------------------------------------

def figure(name, value, unit, bound=None):
    return {"name": f"route optimiser: {name}", "value": float(value), "unit": unit, "bound": bound,
            "command": COMMAND}


def effective_voltages(parameters):
    """With the steady voltages whose squares are b1 and b2: 2 cv²/Rm = b1, 2 cw²/Rm = b2."""
    cv, cw = (math.sqrt(b * parameters["motor_resistance"] / 2) for b in parameters["b"])
    return {**parameters, "voltage_per_speed": cv, "voltage_per_turn_rate": cw}


def paper_figures(name, robot, options):
    said = plan([PAPER_POINTS], options)[0]
    task = Task(route_along(PAPER_POINTS, robot, said, None), said, SEED)
    joint = energy_of(task.route, said["joint"])
    yield figure(f"the paper's four segments, {name}", joint, "J", {"op": "<=", "value": PAPER_BAR})
    yield figure(f"the paper's four segments, {name}: segment by segment", energy_of(task.route, said["greedy"]), "J")
    yield figure(f"the paper's four segments, {name}: above the best of scipy", joint - best_of_starts(task), "J")


def both_papers(robot):
    published = ("--model", "published")
    yield from paper_figures("steady voltages of its Table 1", robot, published)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.json"
        parameters = plan([PAPER_POINTS], published)[0]["parameters"]
        path.write_text(json.dumps(effective_voltages(parameters)), encoding="utf-8")
        yield from paper_figures("steady voltages that b of its Table 2 implies", robot, ("--model", path))


def near_figure(name, results, bound=None):
    near = np.mean([result.above <= NEAR for result in results])
    return figure(f"{name}: within {NEAR} % of the best of scipy", 100 * near, "%", bound)


def figures_of(kind, results):
    above, gain = (np.array([getattr(result, name) for result in results]) for name in ("above", "gain"))
    name = f"{len(results)} routes of {LEGS}, {kind.name}"
    yield near_figure(name, results)
    yield figure(f"{name}: above the best of scipy, worst", above.max(), "%")
    yield figure(f"{name}: saved of the greedy plan, median", np.median(gain), "%")
    yield figure(f"{name}: saved of the greedy plan, most", gain.max(), "%")


def measure(robot, options):
    """Half of the long routes with each model."""
    yield from both_papers(robot)
    counts = (options.routes // 2, options.routes - options.routes // 2, round(SHORT_SHARE * options.routes))
    modes = transients(robot)
    counted = []
    for number, (kind, count) in enumerate(zip(KINDS, counts)):
        seed = options.seed + number * options.routes
        print(f"{kind.name}: {count} routes, seed {seed}")
        results = compare_all(kind.name, tasks_of(kind, robot, modes, seed, count), options.workers)
        counted += results if kind.counts else []
        yield from figures_of(kind, results)
    yield near_figure(f"{len(counted)} routes of {LEGS}, both models", counted, {"op": ">=", "value": NEAR_BAR})


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--routes", metavar="N", type=whole_number(2, 1_000_000), default=1000,
                        help="long ones, half of them with each model; of short ones a fifth (default: 1000)")
    parser.add_argument("--seed", metavar="S", type=whole_number(0, 2**32 - 1), default=SEED, help=f"default: {SEED}")
    parser.add_argument("--workers", metavar="N", type=whole_number(1, 4096), default=os.cpu_count(),
                        help="default: one for each core")
    parser.add_argument("--bench", metavar="FILE", type=Path,
                        help="where the figures go (default: build/bench/route.json)")
    return parser.parse_args()


def main():
    options = arguments()
    robot = robot_json.load(robot_json.robot_path(ROBOT))
    figures = list(measure(robot, options))
    path = options.bench or robot_json.build_directory() / "bench/route.json"
    print_aligned([("what", "measured", "unit"), *((f["name"], f"{f['value']:.6g}", f["unit"]) for f in figures)])
    write_whole(path, json.dumps(figures, indent=2, ensure_ascii=False) + "\n")
    print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
