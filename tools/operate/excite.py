#!/usr/bin/env python3
"""Drive a robot so that a log of it tells its constants: straight on, slow and fast, turns both ways, stands.

The robot stands in the middle of a free space and looks along its length. The routes are made for that space, tried out
on the simulated robot, drawn in where that leaves it, and written with how long they take; with --bus they are driven,
too. Record meanwhile, as with candump -l, and hand the log to tools.identify.log_identify. Exit status 1: the robot did
not do it, and one line says why; 2: bad input; nothing was written.
"""
import argparse
import csv
import io
import json
import math
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console

from tools.common import (ArgumentParser, ToolError, build_directory, print_aligned, read_text, run, shown_path,
                          write_whole)
from tools.design import robot_json
from tools.operate import drive
from tools.operate.can_client import Operator, RobotError, open_bus

# Waypoints by the halves of length and width, and the greatest of these, m: short steps are slow ones.
PATTERNS = {
    "there and back": (2.0, ((1, 0), (-1, 0), (1, 0), (-1, 0), (0, 0))),
    "steps": (0.8, ((0.2, 0), (0.4, 0), (0.6, 0), (0.8, 0), (1, 0), (0.7, 0), (0.4, 0), (0.1, 0), (-0.3, 0), (0, 0))),
    "loops": (2.0, ((1, -1), (1, 1), (-1, 1), (-1, -1), (1, -1), (-1, -1), (-1, 1), (1, 1), (1, -1), (0, 0))),
    "short steps": (0.4, ((-0.3, 0), (-0.6, 0), (-0.8, 0), (-1, 0), (-0.7, 0), (-0.4, 0), (-0.1, 0), (0.3, 0), (0, 0))),
    "zigzag": (2.0, ((-1, -0.4), (-0.6, 0.4), (-0.2, -0.4), (0.2, 0.4), (0.6, -0.4), (1, 0.4), (0.5, -0.4), (0, 0.4),
                     (-0.5, -0.4), (0, 0))),
    "half way and back": (1.0, ((1, 0), (0, 0), (-1, 0), (0, 0))),
}
STAND = 4.0          # s between two routes
SETTLE = 7.0         # s that a robot takes at most to come back to a stand
HALF_MIN = 0.2       # m
DRAWN_IN = 0.9       # where the robot left the space
ATTEMPTS = 12
LENGTHS = (0.1, 1000.0)  # m, of a space
ROLL = 0.3           # m beyond the last waypoint, where the simulated robot never stands quite still
SCENARIO = ('name = "excite";\nrobot = "{robot}";\nenergy_model = "identified";\nseed = {seed};\n'
            'waypoints = ( [0.0, 0.0], {points} );\n')
TO_STAND = 'end = "stand";\n'


@dataclass(frozen=True)
class Route:
    name: str
    waypoints: list        # m, in the frame of the start
    seconds: float
    reach: tuple           # m from the start: forward and back, to the sides
    speeds: tuple          # m/s, least and greatest of its legs


# ---- the space -----------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Space:
    """Half of its length and width, m; round has both as its radius."""
    length: float
    width: float
    is_round: bool = False

    def holds(self, x, y, margin=0.0):
        """Whether all these places are inside, and so far from the edge."""
        if self.is_round:
            return bool((np.hypot(x, y) <= self.length - margin).all())
        return bool((np.abs(x) <= self.length - margin).all() and (np.abs(y) <= self.width - margin).all())

    def halves(self, margin, most):
        """Of the waypoints, m: of a circle the square in it."""
        share = math.sqrt(0.5) if self.is_round else 1.0
        return tuple(min(most, share * half - margin) for half in (self.length, self.width))


def parse_length(text):
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not LENGTHS[0] <= value <= LENGTHS[1]:
        raise argparse.ArgumentTypeError(f"{text!r}: must be {LENGTHS[0]:g} to {LENGTHS[1]:g} m")
    return value


def parse_space(text):
    sides = text.lower().split("x")
    if len(sides) != 2:
        raise argparse.ArgumentTypeError(f"{text!r}: must be LENGTHxWIDTH in m, such as 4x3")
    return Space(*(parse_length(side) / 2 for side in sides))


def parse_radius(text):
    return Space(*2 * (parse_length(text),), is_round=True)


# ---- trying out ----------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Pose:
    x: float
    y: float
    heading: float

    def to_local(self, point):
        dx, dy = point[0] - self.x, point[1] - self.y
        cosine, sine = math.cos(self.heading), math.sin(self.heading)
        return cosine * dx + sine * dy, cosine * dy - sine * dx

    def to_world(self, x, y):
        cosine, sine = math.cos(self.heading), math.sin(self.heading)
        return self.x + cosine * x - sine * y, self.y + sine * x + cosine * y


def simulate(program, robot_file, waypoints, folder, seed=1, options=()):
    """What jp-plant makes of a route from the origin: the columns of its log, its summary, and whether the robot came
    to a stand: one with coarse sensors never rests, and its log ends at the last waypoint."""
    points = ", ".join(f"[{x:.6f}, {y:.6f}]" for x, y in waypoints)
    scenario = Path(folder) / "route.cfg"
    for end in (TO_STAND, ""):
        write_whole(scenario, SCENARIO.format(robot=robot_file.resolve(), seed=seed, points=points) + end)
        try:
            result = subprocess.run([program, scenario, "--bus", "in-process", "--output", folder, *options],
                                    capture_output=True, text=True, check=False)
        except OSError as error:
            raise ToolError(f"{program}: {error.strerror}; build it with `make`") from None
        if result.returncode == 0:
            break
    if result.returncode != 0:
        reason = (result.stderr.strip().splitlines() or ["no reason given"])[-1]
        raise ToolError(f"the simulated robot does not drive the route: {reason}")
    rows = csv.DictReader(io.StringIO(read_text(Path(folder) / "log_cruise.csv")))
    columns = np.array([[float(row[name]) for name in ("t_s", "x_m", "y_m", "heading_rad")] for row in rows]).T
    return columns, json.loads(read_text(Path(folder) / "summary.json"))["strategies"][0], end == TO_STAND


def try_route(program, robot_file, name, waypoints, pose):
    """The route, where the robot was on it, where it ends, and how far it may still roll from there."""
    local = [pose.to_local(point) for point in waypoints]
    with tempfile.TemporaryDirectory() as folder:
        (times, x, y, heading), summary, stands = simulate(program, robot_file, local, folder)
    x, y = pose.to_world(x, y)
    speeds = [segment["speed_m_s"] for segment in summary["segments"]]
    reach = float(np.abs(x).max()), float(np.abs(y).max())
    end = Pose(float(x[-1]), float(y[-1]), pose.heading + float(heading[-1]))
    seconds = float(times[-1]) + (0 if stands else SETTLE)
    return Route(name, waypoints, seconds, reach, (min(speeds), max(speeds))), (x, y), end, 0 if stands else ROLL


def fitted(program, robot_file, space, name, pose):
    """The pattern as large as the robot stays in the space with it, and where it ends."""
    most, pattern = PATTERNS[name]
    margin = 0.0
    for _ in range(ATTEMPTS):
        halves = space.halves(margin, most)
        if min(halves) < HALF_MIN:
            break
        waypoints = [(round(u * halves[0], 3), round(v * halves[1], 3)) for u, v in pattern]
        route, places, end, roll = try_route(program, robot_file, name, waypoints, pose)
        if space.holds(*places, roll):
            return route, end
        margin += (1 - DRAWN_IN) * min(space.length, space.width)
    raise ToolError(f"a space of {2 * space.length:g} x {2 * space.width:g} m: the robot, which rolls on beyond its "
                    f"last waypoint, does not stay inside on the route {name!r}; give more room")


def plan(program, robot_file, space):
    pose, routes = Pose(0.0, 0.0, 0.0), []
    for name in PATTERNS:
        route, pose = fitted(program, robot_file, space, name, pose)
        routes.append(route)
    return routes


def duration(routes):
    """s, with the stands."""
    return sum(route.seconds + STAND for route in routes)


# ---- driving -------------------------------------------------------------------------------------------------------

class Guard:
    """A view that ends the drive when the robot is not where it may be, by its odometry."""

    def __init__(self, view, space, name):
        self._view, self._space, self._name = view, space, name

    def __call__(self, state):
        self._view(state)
        x, y = state.get("Pose", "X"), state.get("Pose", "Y")
        if x is not None and y is not None and not self._space.holds(np.array([x]), np.array([y])):
            raise RobotError(f"{self._name}: the robot is at {x:.2f}, {y:.2f} m and so outside the space; set it into "
                             "the middle and switch it on there")


def command(operator, routes):
    """RobotError: the robot did not do it."""
    operator.stand()
    operator.hold(STAND)
    for route in routes:
        operator.drive_route(route.waypoints)
        operator.stand()
        operator.hold(SETTLE + STAND)


def drive_routes(name, routes, space):
    """Why the robot did not drive them, or None."""
    console = Console()
    with open_bus(name) as bus, (drive.LiveView if console.is_terminal else drive.PlainView)(console) as view:
        operator = Operator(bus, name, Guard(view, space, name))
        try:
            try:
                command(operator, routes)
            except KeyboardInterrupt:
                drive.stop(operator)
        except RobotError as error:
            return str(error)
    return None


def print_routes(routes):
    print_aligned([("route", "waypoints", "time", "", "speed", "", "reach", "", "", ""),
                   *((route.name, str(len(route.waypoints)), f"{route.seconds:.1f}", "s",
                      f"{route.speeds[0]:.2f}", f"to {route.speeds[1]:.2f} m/s", f"{route.reach[0]:.2f}", "x",
                      f"{route.reach[1]:.2f}", "m") for route in routes)])
    print(f"{duration(routes):.0f} s in all, with {STAND:g} s of standing after each")


def as_json(robot, space, routes):
    return {"robot": robot, "space_m": [2 * space.length, 2 * space.width], "round": space.is_round,
            "stand_s": STAND, "duration_s": duration(routes),
            "routes": [{"name": route.name, "waypoints_m": route.waypoints, "duration_s": route.seconds,
                        "reach_m": route.reach, "speed_m_s": route.speeds} for route in routes]}


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots, whose tables are built in")
    room = parser.add_mutually_exclusive_group(required=True)
    room.add_argument("--space", metavar="LENGTHxWIDTH", type=parse_space, help="free around the robot, m: such as 4x3")
    room.add_argument("--radius", metavar="R", type=parse_radius, dest="space", help="the same of a round space, m")
    parser.add_argument("--output", metavar="FILE", type=Path,
                        help="where the routes go (default: build/excite/ROBOT.json)")
    parser.add_argument("--bus", metavar="KIND:CHANNEL",
                        help="drive them there: can:can0, slcan:/dev/ttyACM0, or any interface of python-can")
    return parser.parse_args()


def main():
    options = arguments()
    robot_file = robot_json.robot_path(options.robot)
    robot = robot_json.load(robot_file)
    routes = plan(build_directory() / "bin" / "jp-plant", robot_file, options.space)
    print_routes(routes)
    output = options.output or build_directory() / "excite" / f"{robot.name}.json"
    write_whole(output, json.dumps(as_json(robot.name, options.space, routes), indent=1) + "\n")
    print(f"wrote {shown_path(output)}", flush=True)
    failure = None if options.bus is None else drive_routes(options.bus, routes, options.space)
    if failure is not None:
        print(f"{Path(sys.argv[0]).name}: {failure}", file=sys.stderr)
        return drive.EXIT_NOT_ARRIVED
    return 0


if __name__ == "__main__":
    run(main)
