#!/usr/bin/env python3
"""Drive the robots in MuJoCo: reference missions, slopes, steps, slippery ground, poor gears and sensors, pushes, and what
the forecast of energy is worth before and after it has learned.

Cases follow from the robots' files by the rules here, and random routes from seeds 1, 2, … Prints tables, writes figures for figures.py
and all rows to build/bench-mujoco. Exit status 2: a program failed; nothing was written.
"""
import json
import math
import os
import random
import statistics
from concurrent.futures import ProcessPoolExecutor

import libconf
import numpy as np

from tools.common import ROOT, ArgumentParser, print_aligned, run, shown_path, whole_number, write_whole
from tools.design import robot_json
from tools.mujoco.drive import Drive, load_robot
from tools.mujoco.ground import Ground, Patch, Step
from tools.mujoco.world import Conditions, World
from tools.operate import map_stream
from tools.operate.can_client import RobotError

COMMAND = "make bench-mujoco"

ROBOTS = ("courier24", "gao2018", "burger", "zhang2018")  # those that jp-ecu drives
NAVIGATORS = ("courier24", "burger")                      # and those to a goal on a map
PATROL, PATROL_SLOPE = "patrol", 3.0  # which needs walls to see; °, a ramp for wheelchairs

SLOPE = 10.0        # ° of a balancer's; other robots' files say what they drive
STEP = 0.005        # m
HARD = 0.001        # of the radius by which a hard tyre sinks in
SLIPPERY = 0.2      # friction
BACKLASH = 1.0      # °
DELAY = 0.004       # s
PAYLOAD = 0.2       # of the body
PUSH_SECONDS = 0.05

SEGMENTS, LEARNED = 26, 20  # of a route that learns, and those before it has learned
WORLDS = 4                  # with such routes, of each robot
SEGMENT_SECONDS = (4.0, 6.0)
TURN = 80.0                 # ° from a segment to the next at most, and limits.turn_deg

# As many after it has learned as it takes to tell 93 % from 97 %.
COURSES, LEARNED_COURSES = 46, 6  # over a map, and those before it has learned
PATROL_COURSES = 60               # of the patrol robot in a hall, which has learned after LEARNED
COURSE_SECONDS = 10.0             # from the middle of the map to its edge
HALL, HALL_CELL, HALL_BOXES, HALL_BOX = (16.0, 12.0), 0.05, 8, (0.3, 1.0)  # m; of the patrol robot
PUSHES = (0.25, 0.5, 0.75)        # of what the robot takes in our world

# Share of what left the cells that the ledger may miss.
LEDGER = 0.5


# ---- cases ---------------------------------------------------------------------------------------------------------

def cruise_speed(robot):
    """What the robot's own missions are driven at, m/s."""
    return robot.number("limits.speed_m_s") / 2 if robot.type == robot_json.BALANCER else robot.number("lattice.speed_m_s")


def radius(robot):
    return robot.number("wheel.radius_m")


def is_geared(robot):
    return robot.number("motor.gear_ratio") > 1


def poor_parts(robot):
    return {"backlash": math.radians(BACKLASH) if is_geared(robot) else 0.0,
            "delay": math.ceil(DELAY * robot.number("control.rate_hz"))}


def conditions(robot):
    """By name. Obstacles lie across the first leg of the route."""
    balances = robot.type == robot_json.BALANCER
    slope = math.radians(SLOPE if balances else robot.number("limits.slope_deg"))
    ahead = 3 * cruise_speed(robot)
    # A step is of 5 mm for a balancer, and for a smaller wheel as much of its radius as that is of 0.09 m.
    step = (Step(ahead, STEP if balances else min(STEP, radius(robot) * STEP / 0.09)),)
    hard = HARD * radius(robot)
    patch = (Patch(ahead, 0.0, 2 * radius(robot) + robot.number("body.width_m"), SLIPPERY),)
    poor = poor_parts(robot)
    # On a step a robot stands steeper than the ground, and its file forbids more than its slope.
    half = slope if balances else slope / 2
    payload = PAYLOAD * robot.number("body.mass_kg")
    return {"level": Conditions(), "uphill": Conditions(Ground(slope)), "downhill": Conditions(Ground(-slope)),
            "across": Conditions(Ground(across=slope)), "step": Conditions(Ground(steps=step)),
            "step, hard tyres": Conditions(Ground(steps=step), sinking=hard),
            "slippery": Conditions(Ground(patches=patch)), "poor parts": Conditions(**poor),
            "payload": Conditions(payload=payload),
            "uphill, step, poor parts": Conditions(Ground(half, steps=step), **poor)}


def short_route(robot):
    """Straight on for 6 s, then to the left for 4 s."""
    way = cruise_speed(robot)
    return [(6 * way, 0.0), (8 * way, 2 * math.sqrt(3) * way)]


def reference_route(name):
    scenario = libconf.loads((ROOT / f"sim/scenarios/{name}_mission.cfg").read_text())
    return [tuple(point) for point in scenario["waypoints"][1:]]


def random_route(robot, seed):
    """Segments of random lengths and turns."""
    draw = random.Random(seed)
    turn = math.radians(min(TURN, robot.given("limits.turn_deg", TURN)))
    x = y = heading = 0.0
    points = []
    for _ in range(SEGMENTS):
        heading += draw.uniform(-turn, turn) if points else draw.uniform(-turn, turn) / 2
        way = cruise_speed(robot) * draw.uniform(*SEGMENT_SECONDS)
        x, y = x + way * math.cos(heading), y + way * math.sin(heading)
        points.append((x, y))
    return points


def random_conditions(robot, seed):
    """Level, with another payload, gears, sensors and tyres."""
    draw = random.Random(1000 + seed)
    poor = poor_parts(robot)
    return Conditions(backlash=draw.uniform(0, 1) * poor["backlash"], delay=draw.randint(0, poor["delay"]),
                      payload=draw.uniform(0, PAYLOAD) * robot.number("body.mass_kg"),
                      sinking=radius(robot) * 10 ** draw.uniform(-3, -1.7), seed=seed)


# ---- drives --------------------------------------------------------------------------------------------------------

def result_of(drive, failure):
    world = drive.world
    segments = [(segment.predicted, segment.spent) for _, segment in sorted(drive.operator.state.segments.items())]
    ledger = world.ledger()
    return {"failure": failure, "segments": segments, "ledger": ledger, "seconds": drive.bus.seconds,
            "pitch_deg": math.degrees(max((abs(sample[4]) for sample in drive.track), default=0.0)),
            "pose": world.pose(), "fell": failure is not None and "fell" in failure or world.fallen}


def drive_route(task):
    """The result of a drive, a dict for JSON."""
    kind, name, case, conditions_now, route, options = task
    with Drive(load_robot(name), conditions_now, options) as drive:
        failure = None
        try:
            drive.stand()
            for part in range(0, len(route), 30):
                drive.route(route[part:part + 30])
            drive.operator.hold(1.0)
        except RobotError as error:
            failure = str(error)
        result = result_of(drive, failure)
        if failure is None:
            x, y, _ = drive.world.pose()
            result["miss_m"] = math.hypot(x - route[-1][0], y - route[-1][1])
    return {"kind": kind, "robot": name, "case": case, **result}


class Forecasts:
    """What the navigator foretold of each course, J with its deviation, beside what the ECU's meter counted."""

    def __init__(self, meter):
        self.courses, self._meter, self._now = [], meter, None

    def __call__(self, state):
        if self._now is None and state.get("NavigationProgress", "Energy"):  # 0 before there is a course
            self._now = (state.get("NavigationProgress", "Energy"), state.get("NavigationProgress", "Deviation"),
                         state.get(self._meter, "Energy"))

    def begin(self, state):
        state.latest.pop("NavigationProgress", None)
        self._now = None

    def end(self, state):
        """Of a course; a goal where the robot was has none."""
        if self._now is None:
            return
        energy, deviation, before = self._now
        self.courses.append((energy, deviation, state.get(self._meter, "Energy") - before))


def navigate(task):
    """Courses to random goals on an empty map."""
    kind, name, case, conditions_now, seed, _ = task
    robot = load_robot(name)
    cell, draw = robot.number("navigation.cell_m"), random.Random(2000 + seed)
    count = round(COURSE_SECONDS * cruise_speed(robot) / cell * 2)
    stream = map_stream.encode(map_stream.CellMap(np.zeros((count, count), dtype=int), cell, map_stream.Place(0, 0)),
                               map_stream.Place(count * cell / 2, count * cell / 2))
    forecasts = Forecasts("EnergySpent" if robot.type == robot_json.BALANCER else "EnergyDrawn")
    failure = None
    with Drive(robot, conditions_now, watch=forecasts) as drive:
        try:
            for _ in range(COURSES):
                drive.stand()
                drive.operator.hold(0.5)
                forecasts.begin(drive.operator.state)
                goal = {"Column": draw.randrange(count // 8, count - count // 8),
                        "Row": draw.randrange(count // 8, count - count // 8), "HasHeading": 0, "Heading": 0.0}
                drive.operator.navigate(stream, goal)
                forecasts.end(drive.operator.state)
        except RobotError as error:
            failure = str(error)
        result = result_of(drive, failure)
    return {"kind": kind, "robot": name, "case": case, "courses": forecasts.courses, **result}


def hall(draw):
    """Walls around boxes at random places, as cells."""
    columns, rows = (round(side / HALL_CELL) for side in HALL)
    cells = np.zeros((rows, columns), dtype=int)
    cells[[0, -1]] = cells[:, [0, -1]] = map_stream.OCCUPIED
    for _ in range(HALL_BOXES):
        wide, high = (round(draw.uniform(*HALL_BOX) / HALL_CELL) for _ in range(2))
        x, y = draw.randrange(columns - wide), draw.randrange(rows - high)
        cells[y:y + high, x:x + wide] = map_stream.OCCUPIED
    return map_stream.CellMap(cells, HALL_CELL, map_stream.Place(0, 0))


def free_cell(draw, cells, room):
    """(column, row) with so many free cells to every side."""
    while True:
        y, x = draw.randrange(room, cells.shape[0] - room), draw.randrange(room, cells.shape[1] - room)
        if not cells[y - room:y + room + 1, x - room:x + room + 1].any():
            return x, y


def patrol(task):
    """Courses to random goals in a hall with boxes."""
    kind, name, case, conditions_now, seed, _ = task
    robot, draw = load_robot(name), random.Random(3000 + seed)
    cell_map = hall(draw)
    # What the robot takes when it turns, and the clearance that it keeps.
    room = math.ceil((math.hypot(robot.number("body.length_m"), robot.number("body.width_m")) / 2 +
                      robot.number("band.clearance_m")) / HALL_CELL)
    x, y = free_cell(draw, cell_map.cells, room)
    start = map_stream.Place((x + 0.5) * HALL_CELL, (y + 0.5) * HALL_CELL)
    stream = map_stream.encode(cell_map, start)
    forecasts, failure = Forecasts("EnergyDrawn"), None
    with Drive(robot, conditions_now, watch=forecasts, place=(cell_map, start)) as drive:
        try:
            for _ in range(PATROL_COURSES):
                drive.stand()
                forecasts.begin(drive.operator.state)
                column, row = free_cell(draw, cell_map.cells, room)
                drive.operator.navigate(stream, {"Column": column, "Row": row, "HasHeading": 1,
                                                 "Heading": draw.randrange(-2048, 2048) / 4096})
                forecasts.end(drive.operator.state)  # of the way alone, not of the rest after it
                drive.operator.hold(1.0)
        except RobotError as error:
            failure = str(error)
        result = result_of(drive, failure)
    return {"kind": kind, "robot": name, "case": case, "courses": forecasts.courses, **result}


def push(task):
    """Whether the robot stands again after a push of so many newton seconds, both ways."""
    kind, name, case, conditions_now, impulse, options = task
    failure = None
    for sign in (1, -1):
        with Drive(load_robot(name), conditions_now, options) as drive:
            try:
                drive.stand()
                drive.operator.hold(1.0)
                drive.world.push(sign * impulse / PUSH_SECONDS, 0.0, round(PUSH_SECONDS * drive.world.rate))
                drive.operator.hold(5.0)
            except RobotError as error:
                failure = str(error)
    return {"kind": kind, "robot": name, "case": case, "impulse": impulse, "failure": failure, "fell": failure is not None}


def do(task):
    return {"push": push, "navigate": navigate, "patrol": patrol}.get(task[0], drive_route)(task)


def our_push(name):
    """The largest that the robot takes in our world, N·s."""
    return json.loads(robot_json.printed_by(robot_json.build_directory() / "bin/jp-balance", name, "--json=-"))["push_n_s"]


def tasks():
    for name in ROBOTS:
        robot = load_robot(name)
        yield "mission", name, "reference", Conditions(), reference_route(name), ()
        for case, conditions_now in conditions(robot).items():
            yield "case", name, case, conditions_now, short_route(robot), ()
        if robot.type == robot_json.BALANCER:
            for share in PUSHES:
                yield "push", name, f"{share:g} of our world's", Conditions(), share * our_push(name), ()
        for seed in range(1, WORLDS + 1):
            yield "learn", name, f"seed {seed}", random_conditions(robot, seed), random_route(robot, seed), ()
        if name in NAVIGATORS:
            yield "navigate", name, "seed 1", random_conditions(robot, 1), 1, ()
    weight = load_robot(PATROL).number("body.mass_kg")
    for seed, (case, conditions_now) in enumerate({"level": Conditions(), "payload": Conditions(payload=PAYLOAD * weight),
                                                   "slope": Conditions(Ground(math.radians(PATROL_SLOPE)))}.items(), start=1):
        yield "patrol", PATROL, case, conditions_now, seed, ()


# ---- figures -------------------------------------------------------------------------------------------------------

def errors(rows, part):
    """|forecast − spent| of the segments of routes that learn, %."""
    return [100 * abs(predicted / spent - 1) for row in rows for predicted, spent in row["segments"][part]
            if predicted is not None and spent]


def figure(name, value, unit="", bound=None):
    return {"name": f"in MuJoCo, {name}", "value": value, "unit": unit, "bound": bound, "command": COMMAND}


def at_most(value):
    return {"op": "<=", "value": value}


def none():
    return {"op": "==", "value": 0}


def drive_figures(rows):
    missions, cases = ([row for row in rows if row["kind"] == kind] for kind in ("mission", "case"))
    pushes = [row for row in rows if row["kind"] == "push"]
    ledgers = [100 * abs(row["ledger"]["open"]) / row["ledger"]["cells"] for row in rows if "ledger" in row]
    yield figure("reference missions of four robots: not driven", sum(row["failure"] is not None for row in missions), "",
                 none())
    yield figure("cases of slopes, steps, slippery ground, poor parts and payloads", len(cases))
    yield figure("of those, not driven", sum(row["failure"] is not None for row in cases), "", none())
    patrols = [row for row in rows if row["kind"] == "patrol"]
    yield figure("courses of the patrol robot in halls with boxes", PATROL_COURSES * len(patrols))
    yield figure("of those courses, not driven", sum(PATROL_COURSES - len(row["courses"]) for row in patrols), "", none())
    yield figure("falls in all drives", sum(row["fell"] for row in rows if row["kind"] != "push"), "", none())
    yield figure("pushes that our world's robots take, and these do not", sum(row["failure"] is not None for row in pushes),
                 "", none())
    yield figure("share of the cells' energy that a ledger misses, most", max(ledgers), "%", at_most(LEDGER))


def interval_figures(what, courses):
    """Of courses after learning."""
    if courses:
        inside = [abs(energy - spent) <= 1.96 * deviation for energy, deviation, spent in courses]
        yield figure(f"{what}, after learning", len(courses))
        yield figure(f"{what}: in the 95 % interval, off 95 % by", abs(100 * sum(inside) / len(inside) - 95), "points",
                     at_most(2))


def learning_figures(rows):
    for name in ROBOTS:
        own = [row for row in rows if row["robot"] == name and row["kind"] == "learn"]
        before, after = errors(own, slice(0, 1)), errors(own, slice(LEARNED, None))
        if before and after:
            yield figure(f"{name}: forecast of a first segment against spent, mean", statistics.mean(before), "%", at_most(5))
            yield figure(f"{name}: the same after {LEARNED} segments", statistics.mean(after), "%", at_most(1.5))
    patrols = [row for row in rows if row["kind"] == "patrol"]
    for case in patrols:
        missed = [100 * abs(energy / spent - 1) for energy, _, spent in case["courses"]]
        if missed[LEARNED:]:
            yield figure(f"patrol robot, {case['case']}: forecast of a first course against spent", missed[0], "%", at_most(5))
            yield figure(f"patrol robot, {case['case']}: forecast of a course after {LEARNED}, mean error",
                         statistics.mean(missed[LEARNED:]), "%", at_most(1.5))
    yield from interval_figures("patrol robot: courses", [course for row in patrols for course in row["courses"][LEARNED:]])
    yield from interval_figures("courses over a map", [course for row in rows if row["kind"] == "navigate"
                                                       for course in row["courses"][LEARNED_COURSES:]])


TERMS = ("electronics", "copper", "conversion", "gear", "gear dry", "rolling", "slip contact", "normal contact", "stops dry",
         "bridge", "supply", "mechanical")


# Terms of a ledger in our world (jp-skid) and in MuJoCo.
BOTH_WORLDS = (("cells", ("battery",), ("cells",)), ("supply and electronics", ("supply", "electronics"), ("supply", "electronics")),
               ("windings", ("copper",), ("copper",)), ("bridges", ("bridge",), ("bridge",)),
               ("gears and rolling", ("gear", "rolling"), ("gear dry",)),
               ("tyres and caster", ("slip_along", "slip_across", "caster"), ("slip contact", "normal contact")))
DUTIES = {"straight on": (0.3, 0.3), "bend": (0.3, 0.2), "on the spot": (0.3, -0.3)}
DUTY_SECONDS = 5


def our_ledger(name, left, right):
    return json.loads(robot_json.printed_by(robot_json.build_directory() / "bin/jp-skid", name, f"--left={left}",
                                            f"--right={right}", f"--seconds={DUTY_SECONDS}", "--json=-"))


def their_ledger(name, left, right):
    world = World(load_robot(name), Conditions())
    for _ in range(round(DUTY_SECONDS * world.rate)):
        world.command(True, left, right)
        world.step()
    return world.ledger()


def joules_of(ledger, terms):
    return sum(ledger.get(f"{term}_j", ledger.get(term, 0.0)) for term in terms)


def print_worlds():
    """Where the two worlds differ, term by term, at the same duties."""
    table = [["J", "duties", *(name for name, _, _ in BOTH_WORLDS)]]
    for name in ROBOTS:
        if load_robot(name).type == robot_json.BALANCER:
            continue
        for case, duties in DUTIES.items():
            for world, ledger, column in (("ours", our_ledger(name, *duties), 1), ("MuJoCo", their_ledger(name, *duties), 2)):
                table.append([f"{name}, {world}", case, *(f"{joules_of(ledger, terms[column]):.2f}" for terms in BOTH_WORLDS)])
    print_aligned(table)


def print_rows(rows):
    table = [["robot", "kind", "case", "s", "pitch °", "miss m", "worst error %", "open %", "failure"]]
    for row in rows:
        if "ledger" not in row:
            table.append([row["robot"], row["kind"], row["case"], "-", "-", "-", "-", "-", row["failure"] or ""])
            continue
        worst = max(errors([row], slice(None)), default=None)
        table.append([row["robot"], row["kind"], row["case"], f"{row['seconds']:.1f}", f"{row['pitch_deg']:.1f}",
                      f"{row.get('miss_m', math.nan):.3f}", "-" if worst is None else f"{worst:.2f}",
                      f"{100 * row['ledger']['open'] / row['ledger']['cells']:.4f}", row["failure"] or ""])
    print_aligned(table)
    print()
    table = [["share of the cells' energy, %", "case", *TERMS]]
    for row in rows:
        if row["kind"] in ("mission", "case"):
            table.append([row["robot"], row["case"], *(f"{100 * row['ledger'].get(term, 0) / row['ledger']['cells']:.2f}"
                                                       for term in TERMS)])
    print_aligned(table)


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--kind", choices=("mission", "case", "push", "learn", "navigate", "patrol"), action="append",
                        help="only these")
    parser.add_argument("--robot", choices=(*ROBOTS, PATROL), action="append", help="only these")
    parser.add_argument("--jobs", type=whole_number(1, 256), default=int(os.environ.get("JOBS", 1)))
    options = parser.parse_args()
    chosen = [task for task in tasks() if task[0] in (options.kind or task) and task[1] in (options.robot or task)]
    with ProcessPoolExecutor(options.jobs) as pool:
        rows = list(pool.map(do, chosen))
    print_rows(rows)
    print()
    print_worlds()
    build = robot_json.build_directory()
    (build / "bench-mujoco").mkdir(parents=True, exist_ok=True)
    write_whole(build / "bench-mujoco/rows.json", json.dumps(rows, indent=1) + "\n")
    figures = [*drive_figures(rows), *learning_figures(rows)] if not (options.kind or options.robot) else []
    if figures:
        write_whole(build / "bench/mujoco.json", json.dumps(figures, indent=1) + "\n")
        print(f"wrote {shown_path(build / 'bench/mujoco.json')}")
    return 0


if __name__ == "__main__":
    run(main)
