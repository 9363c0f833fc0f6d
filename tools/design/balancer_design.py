"""A balancer from its file: its controller is designed and leant, pushed and left standing on the non-linear plant; its energy
is identified, what it can learn is made, and it drives routes that nothing was fitted to."""
import json
import math

import numpy as np

from tools.common import read_text
from tools.design import closed_loop, linear_model, robot_json, robot_trials, specification
from tools.design.robot_findings import Made, Steps, at_least, at_most, information

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


def design_controller(making):
    """Gains, and a model of the energy to begin with."""
    robot_trials.clear_tables(making.tables)
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


def pictures_of(making, robot):
    return [*(("Energy model", "Validation on experiments that were not fitted.",
               making.experiments / f"identification{suffix}.png") for suffix in ("", "_battery")),
            ("Transients", "What rounding to the tables' formats costs.", making.folder / f"horizon_{robot.name}.png"),
            ("Learning", "Robots of other ground, payload and motors: what is left when all is learned, and how true their "
                         "forecasts are.", making.folder / f"learning_{robot.name}.png")]


def make(making):
    """Every step."""
    steps = Steps(8)
    robot = steps.do("robot file, and the settings that it leaves out", lambda: robot_json.load(making.robot_file))
    steps.do("controller, designed and checked", lambda: design_controller(making))
    balance = steps.do("leant, pushed and left standing", lambda: try_balance(making))
    validations = steps.do("energy, identified in experiments",
                           lambda: identify(making, robot, balance["standing_voltage_rms_v"]))
    steps.do("transients of segments", lambda: make_horizon(making))
    steps.do("what it can learn", lambda: make_learning(making))
    drives = steps.do(f"{ROUTES} routes driven", lambda: drive_routes(making))
    trips = steps.do(f"{TRIPS} robots that differ, learning",
                     lambda: robot_trials.drive_trips(making.folder, making.robot_file, TRIPS, TRIP_SEED))
    return Made(robot, findings_of(robot, balance, validations, drives, trips), robot_trials.ROUTES_DRIVEN, drives, trips,
                pictures_of(making, robot))
