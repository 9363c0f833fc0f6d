#!/usr/bin/env python3
"""Measure how far above the least energy that exists a robot drives: scenarios and random routes, by each strategy.

jp-mission drives every route in closed loop. The limit is that of energy_limit.py through the same waypoints, in settled
motion at the speed with which the strategy ended. It is integrated, so that its voltages are known to be possible.
Beside them stands what cruise and transients reach (trajectory_oracle.py): planned in double precision, and followed by
the same plant under a feedback of its exact state. A drive that ends hardly faster or slower than another has the other's
limit, and the momentum between them: all limits are kept, and found anew only where the route, the robot or the program
that finds them are others.
Prints tables and writes figures and tables for figures.py. Exit status 2: a program failed or no limit was found;
nothing was written.
"""
import hashlib
import itertools
import json
import math
import os
import subprocess
import tempfile
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, read_text, run, shown_path, whole_number, write_whole
from tools.design import robot_json, robot_trials
from tools.measure import energy_limit, progress, trajectory_oracle
from tools.measure.figure_store import write_tables

COMMAND = "make bench-limit"
SCENARIOS = ("gao2018_mission", "gao2018_short", "courier24_mission", "courier24_short")

# Random routes, as robot_trials.py draws them: chosen before anything was measured on them. The first of them are driven by
# every strategy.
ROBOTS = ("gao2018", "courier24")
SEED = 1
# And routes by the rule, and optimised, alone, of seeds that nothing was developed with.
UNSEEN_SEED = 1001

# %, of the strategies that are to be within them; which of the scenarios are short.
RULE = "cruise and transients, by rule"
OPTIMISED = "cruise and transients, optimised"
BARS = {RULE: {"mission": 0.25, "short": 0.5, "mean": 0.6, "worst": 0.8},
        OPTIMISED: {"mission": 0.25, "short": 0.5, "mean": 0.3, "worst": 0.8}}
BESIDE_OTHERS_BAR = 0.0                      # %, above any other strategy, with the same end
SAVED_BAR = 0.0                              # %, of the rule's energy in the mean
MISS_BAR = 1.0                               # cm
FORECAST_BARS = {"mean": 0.3, "worst": 1.0}  # %

ORACLE = "cruise and transients, double precision"

NEAR_MAX = 0.01  # m/s, between the ends of two drives of which one has the other's limit

STARTS = 4
INTEGRATED_MAX = 1e-4  # of the limit: beyond it the mesh is too coarse
TIMEOUT = 600          # s, of jp-mission

SCENARIO_HEADINGS = ("scenario", "strategy", "driven, J", "limit, J", "above, %", "time, s", "limit, s", "end, m/s",
                     "worst miss, cm")
ROUTE_HEADINGS = ("robot", "strategy", "routes", "above, mean %", "above, worst %", "worst miss, cm")


@dataclass(frozen=True)
class Route:
    name: str
    scenario: str  # text of its file
    seed: int
    by_rule_alone: bool = False


@dataclass(frozen=True)
class Drive:
    """Of a route by a strategy."""
    strategy: str
    energy: float     # J
    seconds: float
    end_speed: float  # m/s
    miss: float       # m, how far from the worst waypoint it passed
    forecast: float   # J, before the start; nan: it tells none
    limit: float      # J
    limit_seconds: float

    @property
    def above(self):
        """%."""
        return 100 * (self.energy / self.limit - 1)

    @property
    def forecast_error(self):
        """%."""
        return 100 * abs(self.forecast / self.energy - 1)


@dataclass(frozen=True)
class Limit:
    """The least energy of a route for one speed at its end."""
    end_speed: float  # m/s
    energy: float     # J
    seconds: float


# ---- Routes --------------------------------------------------------------------------------------------------------

def scenario_route(name):
    """Its robot's file named by its whole path: the scenario is driven from elsewhere."""
    text = read_text(ROOT / f"sim/scenarios/{name}.cfg")
    return Route(name, text.replace("../robots", str(ROOT / "sim/robots")), SEED)


def random_route(robot, seed, by_rule_alone=False):
    points = ", ".join(f"[{x:.3f}, {y:.3f}]" for x, y in robot_trials.draw_points(np.random.default_rng(seed)))
    return Route(f"{robot}_{seed}", f'name = "{robot}_{seed}";\nrobot = "{ROOT}/sim/robots/{robot}.cfg";\n'
                 f'energy_model = "identified";\nseed = {seed};\nwaypoints = ( {points} );\n', seed, by_rule_alone)


# ---- Drives --------------------------------------------------------------------------------------------------------

def driven(route, *arguments):
    """What jp-mission says of it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "route.cfg"
        write_whole(path, route.scenario)
        command = [robot_json.build_directory() / "bin/jp-mission", path, *arguments, "--output", folder]
        try:
            result = subprocess.run(command, capture_output=True, text=True, check=False, timeout=TIMEOUT)
        except OSError as error:
            raise ToolError(f"{command[0]}: {error.strerror}; build it with `make`") from None
        if result.returncode != 0:
            raise ToolError(f"{route.name}: jp-mission: {result.stderr.strip() or 'no reason given'}")
        return json.loads(read_text(Path(folder) / "summary.json"))


def oracle_drive(route, task):
    """Its end, time, energy and the worst miss."""
    speed = task.plant.cruise()
    plan = trajectory_oracle.Plan(task, speed)
    if not plan.is_found:
        raise ToolError(f"{route.name}: no trajectory of cruise and transients found")
    check = energy_limit.follow(task.plant, task.points, *plan.sampled())
    return ORACLE, check.energy, plan.seconds, speed, max(check.misses), math.nan


def plant_of(summary):
    return energy_limit.Plant(robot_json.load(robot_json.robot_path(summary["robot"])), summary["energy"])


def drives_of(rows):
    """Of the strategies that can drive the route: what a Drive begins with."""
    return [(row["title"], row["total"]["plant_energy_j"], row["total"]["duration_s"], row["total"]["end_speed_m_s"],
             max(leg["passed_m"] for leg in row["segments"]), (row["forecast"] or {"energy_j": math.nan})["energy_j"])
            for row in rows if "total" in row]


# ---- Limits --------------------------------------------------------------------------------------------------------

def check_limit(name, solution, speed):
    """There is one, and integrated it is the same."""
    if solution is None:
        raise ToolError(f"{name}: no limit found that ends at {speed:.3f} m/s")
    apart = energy_limit.integrate(solution).energy / solution.energy - 1
    if abs(apart) > INTEGRATED_MAX:
        raise ToolError(f"{name}: the limit integrated is {100 * apart:.3f} % away: its mesh is too coarse")


def limits_found(route, task, speeds):
    """For each speed at the end, integrated."""
    found = energy_limit.least(task, speeds, STARTS, route.seed)
    for speed, solution in zip(speeds, found):
        check_limit(route.name, solution, speed)
    return [Limit(speed, solution.energy, solution.durations.sum()) for speed, solution in zip(speeds, found)]


def nearest(limits, speed):
    """None: none is near."""
    near = [limit for limit in limits if abs(limit.end_speed - speed) <= NEAR_MAX]
    return min(near, key=lambda limit: abs(limit.end_speed - speed), default=None)


def moved(plant, limit, speed):
    """A limit's energy at another speed at the end, near the cruise: what the voltages' squares gain with the momentum."""
    linear = trajectory_oracle.Linear(plant)
    return limit.energy + (linear.curvature[-2, -2] * linear.volts[0] * linear.volts[1]
                           * (speed**2 - limit.end_speed**2) / 2)


def kept_in(store, route, summary):
    """The file of the route's limits, by all that they follow from."""
    told = (route.scenario, route.seed, STARTS, summary["energy"],
            robot_json.printed_by(robot_json.default_jp_robot(), robot_json.robot_path(summary["robot"]), "--json=-"),
            *(read_text(module.__file__) for module in (energy_limit, trajectory_oracle)))
    return store / f"{route.name}_{hashlib.sha256(json.dumps(told).encode()).hexdigest()[:16]}.json"


def limits_of(route, task, speeds, path):
    """The nearest for each speed: those kept at the path, and where none is near, one that is found and kept there."""
    kept = [Limit(**limit) for limit in json.loads(read_text(path))] if path.exists() else []
    missing = [speed for speed in speeds if nearest(kept, speed) is None]
    if missing:
        kept += limits_found(route, task, missing)
        write_whole(path, json.dumps([asdict(limit) for limit in kept]))
    return [nearest(kept, speed) for speed in speeds]


# ---- A route -------------------------------------------------------------------------------------------------------

def measure(route, store):
    """A drive for each strategy that is asked for and can drive the route."""
    summary = driven(route)
    task = energy_limit.Task(plant_of(summary), np.array(summary["waypoints_m"]))
    drives = drives_of(row for row in summary["strategies"] if row["title"] == RULE or not route.by_rule_alone)
    if not route.by_rule_alone:
        drives.append(oracle_drive(route, task))
    drives += drives_of(driven(route, "--optimised")["strategies"])
    found = limits_of(route, task, [drive[3] for drive in drives], kept_in(store, route, summary))
    return [Drive(*drive, moved(task.plant, limit, drive[3]), limit.seconds) for drive, limit in zip(drives, found)]


def measure_all(routes, workers, store):
    """In parallel, with a bar."""
    with progress.workers(workers) as track:
        return list(track(partial(measure, store=store), routes, "routes"))


# ---- Figures -------------------------------------------------------------------------------------------------------

def of_strategy(strategy, drives):
    return [drive for drive in drives if drive.strategy == strategy]


def figure(name, value, strategy, bar):
    bound = {"op": "<=", "value": BARS[strategy][bar]} if strategy in BARS else None
    return {"name": f"energy limit: {name}", "value": float(value), "unit": "%", "bound": bound, "command": COMMAND}


def figure_of(strategy, name, value, unit, bar):
    bound = bar and {"op": "<=", "value": bar}
    return {"name": f"{strategy}: {name}", "value": float(value), "unit": unit, "bound": bound, "command": COMMAND}


def figures_beside(strategy, scenarios, routes):
    """How the strategy's trajectories were driven beside their energy."""
    for name, drives in scenarios.items():
        for drive in of_strategy(strategy, drives):
            yield figure_of(strategy, f"{name}, waypoints passed within", 100 * drive.miss, "cm", MISS_BAR)
            yield figure_of(strategy, f"{name}, forecast against driven", drive.forecast_error, "%", None)
    for those, robot, results in routes:
        driven_routes = of_strategy(strategy, itertools.chain(*results))
        errors = [drive.forecast_error for drive in driven_routes]
        name = f"{those} of {robot_trials.LEGS}, {robot}"
        miss = 100 * max(drive.miss for drive in driven_routes)
        yield figure_of(strategy, f"{name}, waypoints passed within", miss, "cm", MISS_BAR)
        yield figure_of(strategy, f"{name}, forecast against driven, mean", np.mean(errors), "%", FORECAST_BARS["mean"])
        yield figure_of(strategy, f"{name}, forecast against driven, worst", max(errors), "%", FORECAST_BARS["worst"])


def figure_beside_others(strategy, others, results):
    """Of the routes that others were asked to drive, too, each drive above the limit of its own end."""
    beyond = []
    for drives in results:
        own, = of_strategy(strategy, drives)
        beyond.append([own.above - other.above for other in drives if other.strategy in others])
    routes = sum(bool(those) for those in beyond)
    return {"name": f"{strategy}: {routes} scenarios and random routes, above what another strategy takes, worst",
            "value": max(itertools.chain(*beyond)), "unit": "%", "bound": {"op": "<=", "value": BESIDE_OTHERS_BAR},
            "command": COMMAND}


def figures_beside_others(results):
    """The rule beside what it replaces; the optimised routes beside the rule, too."""
    before = {drive.strategy for drive in itertools.chain(*results)} - {RULE, OPTIMISED, ORACLE}
    yield figure_beside_others(RULE, before, results)
    yield figure_beside_others(OPTIMISED, before | {RULE}, results)


def figures_of_saving(routes):
    """Of the optimised routes against the rule's, both above their limits."""
    for those, robot, results in routes:
        rule, found = (of_strategy(strategy, itertools.chain(*results)) for strategy in (RULE, OPTIMISED))
        saved = np.mean([before.above - after.above for before, after in zip(rule, found)])
        yield {"name": f"{OPTIMISED}: {those} of {robot_trials.LEGS}, {robot}, saved against the rule, mean",
               "value": float(saved), "unit": "%", "bound": {"op": ">=", "value": SAVED_BAR}, "command": COMMAND}


def scenario_rows(name, drives):
    return [(name, drive.strategy, f"{drive.energy:.2f}", f"{drive.limit:.2f}", f"{drive.above:.2f}",
             f"{drive.seconds:.1f}", f"{drive.limit_seconds:.1f}", f"{drive.end_speed:.3f}", f"{100 * drive.miss:.1f}")
            for drive in drives]


def by_strategy(results):
    """{strategy: its drives}, in the order of the first route that knows it."""
    found = {}
    for drives in results:
        for drive in drives:
            found.setdefault(drive.strategy, []).append(drive)
    return found


def route_rows(those, robot, results):
    return [(robot, strategy, those, f"{np.mean([drive.above for drive in drives]):.2f}",
             f"{max(drive.above for drive in drives):.2f}", f"{100 * max(drive.miss for drive in drives):.1f}")
            for strategy, drives in by_strategy(results).items()]


def figures_of(scenarios, routes):
    for name, drives in scenarios.items():
        for drive in drives:
            yield figure(f"{name}, {drive.strategy}: above the limit", drive.above, drive.strategy, name.split("_")[1])
    for those, robot, results in routes:
        for strategy, drives in by_strategy(results).items():
            above = [drive.above for drive in drives]
            name = f"{those} of {robot_trials.LEGS}, {robot}, {strategy}: above the limit"
            yield figure(f"{name}, mean", np.mean(above), strategy, "mean")
            yield figure(f"{name}, worst", max(above), strategy, "worst")


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--routes", metavar="N", type=whole_number(1, 1_000_000), default=25,
                        help=f"random ones for each robot, of the seeds from {SEED} (default: 25)")
    parser.add_argument("--unseen", metavar="N", type=whole_number(1, 1_000_000), default=100,
                        help="random ones for each robot by the rule and optimised alone (default: 100)")
    parser.add_argument("--seed", metavar="S", type=whole_number(0, 2**31), default=UNSEEN_SEED,
                        help=f"of the first of these; the others follow (default: {UNSEEN_SEED})")
    parser.add_argument("--workers", metavar="N", type=whole_number(1, 4096), default=os.cpu_count(),
                        help="default: one for each core")
    parser.add_argument("--bench", metavar="FILE", type=Path,
                        help="where the figures go, and beside them the tables and what was found of each route "
                             "(default: build/bench/limit.json)")
    return parser.parse_args()


def main():
    options = arguments()
    routes = [scenario_route(name) for name in SCENARIOS]
    routes += [random_route(robot, SEED + i) for robot in ROBOTS for i in range(options.routes)]
    routes += [random_route(robot, options.seed + i, True) for robot in ROBOTS for i in range(options.unseen)]
    path = options.bench or robot_json.build_directory() / "bench/limit.json"
    results = iter(measure_all(routes, options.workers, path.with_suffix("")))

    scenarios = {name: next(results) for name in SCENARIOS}
    random = [(f"{count} {kind} routes", robot, list(itertools.islice(results, count)))
              for count, kind in ((options.routes, "random"), (options.unseen, "unseen random")) for robot in ROBOTS]
    scenario_table = [row for name, drives in scenarios.items() for row in scenario_rows(name, drives)]
    route_table = [row for routes, robot, drives in random for row in route_rows(routes, robot, drives)]
    driven_routes = [*scenarios.values(), *itertools.chain(*(drives for _, _, drives in random))]
    figures = [*figures_of(scenarios, random), *figures_beside_others(driven_routes),
               *figures_beside(RULE, scenarios, random), *figures_beside(OPTIMISED, scenarios, random),
               *figures_of_saving(random)]
    write_whole(path, json.dumps(figures, indent=2, ensure_ascii=False) + "\n")
    tables = path.with_suffix(".tables.json")
    write_tables(tables, {"limit_scenarios": (SCENARIO_HEADINGS, scenario_table),
                          "limit_routes": (ROUTE_HEADINGS, route_table)})

    print_aligned([SCENARIO_HEADINGS, *scenario_table])
    low, high = robot_trials.LENGTHS
    turn = math.degrees(robot_trials.TURN)
    print(f"\nrandom routes of {robot_trials.LEGS} legs of {low:g} to {high:g} m, turns to ±{turn:g}°")
    print_aligned([ROUTE_HEADINGS, *route_table])
    print(f"\nwrote {shown_path(path)} and {shown_path(tables)}")
    return 0


if __name__ == "__main__":
    run(main)
