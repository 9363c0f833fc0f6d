"""A skid-steered or differential-drive robot from its file: its controller, its path and its lattices are designed, its energy
and what it can learn are identified, and it drives routes that nothing was fitted to."""
import json

import numpy as np

from tools.common import read_text
from tools.design import robot_json, robot_trials
from tools.design.robot_findings import Made, Steps, at_least, at_most, information

ROUTES = 20
ROUTE_SEED = 2001   # of the first; no development used it
TRIPS = 40
TRIP_SEED = 7001

# What a robot must do.
FORECAST_MEAN, FORECAST_WORST = 1.5, 5.0  # %, before it has learned, on the ground of its file
LEARNED_MEAN = 1.5                        # %, on grounds that it had to learn
MISS_PERCENT = 1.0                        # of its way, by wheels and gyro
# Of 40 trips, where 38 are expected inside their 95 % interval: fewer happen by chance once in a thousand.
INSIDE_PERCENT = 80.0


def design_controller(making):
    """Loops of the sides, odometry, monitors and limits; limits and steering of a path; motions of the planners."""
    robot_trials.clear_tables(making.tables)
    for tool in ("skid_robot", "path_table", "lattice"):
        robot_trials.tool(tool, making.robot_file, "--tables", making.tables)


def identify(making):
    """The energy model, and what the robot can learn of it."""
    robot_trials.called([robot_json.build_directory() / "bin" / "jp-skid-identify", making.robot_file, "--output",
                         making.experiments], "jp-skid-identify")
    robot_trials.tool("skid_identify", making.robot_file, "--experiments", making.experiments, "--tables", making.tables)
    return json.loads(read_text(making.experiments / "identification.json"))


def drive_routes(making):
    program, = robot_trials.build(making.folder, "jp-mission")
    return [robot_trials.drive(program, making.robot_file, making.folder, ROUTE_SEED + k, "battery") for k in range(ROUTES)]


def findings_of(identified, drives, trips):
    errors = 100 * np.abs([drive.error for drive in drives])
    misses = [100 * drive.end_miss / drive.length for drive in drives]
    done = [trip for trip in trips if trip["outcome"] == "done"]
    learned = [100 * abs(trip["predicted_j"] / trip["measured_j"] - 1) for trip in done]
    return [
        information("energy model, mean error on random motions", identified["random_percent"]["mean"], "%"),
        at_most(f"forecast against {len(drives)} routes, mean", np.mean(errors), "%", FORECAST_MEAN,
                "finer encoders, or more motor.current_limit_a"),
        at_most("the same, worst", np.max(errors), "%", FORECAST_WORST, "lower limits.speed_m_s, or stronger motors"),
        at_most("ends its routes off their end, of the way, mean", np.mean(misses), "%", MISS_PERCENT,
                "a gyro with less noise and a truer scale"),
        at_least("trips of robots that differ, driven", 100 * len(done) / len(trips), "%", 100,
                 "lower limits.slope_deg or limits.speed_m_s, or stronger motors"),
        at_most("forecast of these that have learned, mean", np.mean(learned) if done else np.inf, "%", LEARNED_MEAN,
                "nothing in the robot file: it differs in more than it learns"),
        at_least("of these inside their 95 % interval", 100 * sum(trip["inside"] for trip in done) / max(len(done), 1),
                 "%", INSIDE_PERCENT, "nothing in the robot file: forecasts of this robot are less sure than they say"),
    ]


def make(making):
    """Every step."""
    steps = Steps(5)
    robot = steps.do("robot file", lambda: robot_json.load_skid_steer(making.robot_file))
    steps.do("controller, path and lattices", lambda: design_controller(making))
    identified = steps.do("energy, and what it can learn, identified in drives", lambda: identify(making))
    drives = steps.do(f"{ROUTES} routes driven", lambda: drive_routes(making))
    trips = steps.do(f"{TRIPS} robots that differ, learning",
                     lambda: robot_trials.drive_trips(making.folder, making.robot_file, TRIPS, TRIP_SEED))
    return Made(robot, findings_of(identified, drives, trips), robot_trials.ROUTES_DRIVEN, drives, trips)
