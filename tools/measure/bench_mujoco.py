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
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import libconf

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, run, shown_path, whole_number, write_whole
from tools.design import robot_json
from tools.mujoco.drive import Drive, Fell, load_robot
from tools.mujoco.ground import Ground, Patch, Step
from tools.mujoco.world import Conditions
from tools.operate.can_client import RobotError

COMMAND = "make bench-mujoco"

ROBOTS = ("courier24", "gao2018", "burger", "zhang2018")  # those that jp-ecu drives

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

# Share of what left the cells that the ledger may miss.
LEDGER = 0.5


# ---- cases ---------------------------------------------------------------------------------------------------------

def cruise_speed(robot):
    """What the robot's own missions are driven at, m/s."""
    return robot.number("limits.speed_m_s") / 2 if robot.type == robot_json.BALANCER else number_of(robot, "lattice")


def number_of(robot, group):
    return float(robot._data[group]["speed_m_s"])


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
    payload = PAYLOAD * robot.number("body.mass_kg")
    return {"level": Conditions(), "uphill": Conditions(Ground(slope)), "downhill": Conditions(Ground(-slope)),
            "across": Conditions(Ground(across=slope)), "step": Conditions(Ground(steps=step)),
            "step, hard tyres": Conditions(Ground(steps=step), sinking=hard),
            "slippery": Conditions(Ground(patches=patch)), "poor parts": Conditions(**poor),
            "payload": Conditions(payload=payload),
            "uphill, step, poor parts": Conditions(Ground(slope, steps=step), **poor)}


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
    return {"kind": kind, "robot": name, "case": case, "impulse": impulse, "failure": failure,
            "fell": failure is not None}


def do(task):
    return push(task) if task[0] == "push" else drive_route(task)
