"""From what the equations say of a log to the constants of the robot's file.

The coefficients of the equations are ratios of products of constants; motion alone does not tell all of them. So the
file counts too, as a measurement of each constant that is good to PRIOR, and what comes out are the constants that
agree best with both. A constant that the log leaves as uncertain as the file had it is not identifiable.
"""
from dataclasses import dataclass

import numpy as np
from scipy import optimize

from tools.design.linear_model import GRAVITY
from tools.identify.motion_fit import MECHANICAL

PRIOR = 0.25  # of a constant's logarithm: what a data sheet and an estimate are good for
TOLD = 0.4    # a constant whose deviation is below this share of PRIOR was told by the log
# Shares: what filter, samples and model themselves are off by. Messages that come with every 20th tick see voltages
# that change with every tick in one phase, and the currents of the tick before.
MODEL_ERROR = {"motors": 0.0005, "mechanics": 0.003, "half_track": 0.0005}
TELEMETRY_ERROR = {"motors": 0.08, "mechanics": 0.04}
REFERENCE_ERROR = 0.002  # of a scale and of a tape
LEAN_ERROR = 0.0005  # rad: how far the robot leans at speed tells friction of the ground from that of the motors

UNITS = {
    "body.mass_kg": "kg", "wheel.mass_kg": "kg", "body.centre_height_m": "m", "body.width_m": "m", "body.depth_m": "m",
    "wheel.radius_m": "m", "motor.resistance_ohm": "ohm", "motor.torque_constant_nm_per_a": "N m/A",
    "motor.back_emf_v_s_per_rad": "V s/rad", "motor.rotor_inertia_kg_m2": "kg m2",
    "motor.friction_nm_s_per_rad": "N m s/rad",
    "ground.friction_nm_s_per_rad": "N m s/rad", "electronics.power_w": "W", "supply.voltage_v": "V",
    "supply.resistance_ohm": "ohm", "supply.capacity_wh": "Wh"}
MOTION_KEYS = tuple(UNITS)[:12]
SUPPLY_KEYS = {"electronics.power_w": "electronics", "supply.voltage_v": "voltage",
               "supply.resistance_ohm": "resistance"}


@dataclass(frozen=True)
class Constant:
    key: str
    file: float
    value: float
    deviation: float   # of the value, in its unit
    is_told: bool      # by the log

    @property
    def unit(self):
        return UNITS[self.key]

    @property
    def change(self):
        """%."""
        return 100 * (self.value / self.file - 1) if self.file else 0.0


@dataclass(frozen=True)
class References:
    """What was measured beside the log; None: it was not."""
    mass: float | None = None    # kg, with wheels
    radius: float | None = None  # m, of the wheels, by a distance


@dataclass(frozen=True)
class Observation:
    """Numbers that are functions of the constants, with their covariance."""
    values: np.ndarray
    covariance: np.ndarray
    model: object  # of a dictionary of constants


def coefficients(constants, gear, has_currents):
    """MECHANICAL of motion_fit."""
    c = {key.split(".")[1] if key.count("mass") == 0 and key.count("friction") == 0 else key: value
         for key, value in constants.items()}
    body, wheel = c["body.mass_kg"], c["wheel.mass_kg"]
    height, radius, width = c["centre_height_m"], c["radius_m"], c["width_m"]
    rotor = gear**2 * c["rotor_inertia_kg_m2"]
    half_track = width / (2 * radius)
    yaw = (wheel * width**2 / 2 + body * (width**2 + c["depth_m"]**2) / 12
           + 2 * half_track**2 * (wheel * radius**2 / 2 + rotor))
    friction = np.array([c["motor.friction_nm_s_per_rad"], c["ground.friction_nm_s_per_rad"]])
    inertias = np.array([(3 * wheel + body) * radius**2 + 2 * rotor, body * height * radius - 2 * rotor,
                         4 / 3 * body * height**2 + 2 * rotor, body * GRAVITY * height, yaw / half_track**2])
    torque = gear * c["torque_constant_nm_per_a"]
    if has_currents:
        return np.concatenate([friction, inertias]) / torque
    found = np.concatenate([friction, inertias]) * c["resistance_ohm"] / torque
    found[0] += gear * c["back_emf_v_s_per_rad"]
    return found


def with_model_error(covariance, values, share):
    return covariance + np.diag((share * values)**2)


def of_mechanics(motion_fit, gear, shares):
    count = len(MECHANICAL)
    values, has_currents = motion_fit.mechanics.values[:count], motion_fit.motors is not None
    covariance = with_model_error(motion_fit.mechanics.covariance[:count, :count], values, shares["mechanics"])
    leaning = LEAN_ERROR * values[MECHANICAL.index("G")] / (2 * motion_fit.wheel_rate)
    covariance[:2, :2] += leaning**2 * np.array([[1, -1], [-1, 1]])
    return Observation(values, covariance, lambda c: coefficients(c, gear, has_currents))


def observations(motion_fit, gear, references, is_sampled):
    has_currents = motion_fit.motors is not None
    shares = MODEL_ERROR if is_sampled else MODEL_ERROR | TELEMETRY_ERROR
    found = [of_mechanics(motion_fit, gear, shares)]
    if has_currents:
        values = motion_fit.motors.values[:2]
        covariance = with_model_error(motion_fit.motors.covariance[:2, :2], values, shares["motors"])
        found.append(Observation(values, covariance, lambda c: np.array([c["motor.resistance_ohm"],
                                                                         gear * c["motor.back_emf_v_s_per_rad"]])))
    if motion_fit.half_track is not None:
        values = motion_fit.half_track.values[:1]
        found.append(Observation(values, with_model_error(motion_fit.half_track.covariance[:1, :1], values,
                                                          shares["half_track"]),
                                 lambda c: np.array([c["body.width_m"] / (2 * c["wheel.radius_m"])])))
    for value, model in ((references.mass, lambda c: c["body.mass_kg"] + 2 * c["wheel.mass_kg"]),
                         (references.radius, lambda c: c["wheel.radius_m"])):
        if value is not None:
            found.append(Observation(np.array([value]), np.array([[(REFERENCE_ERROR * value)**2]]),
                                     lambda c, model=model: np.array([model(c)])))
    return found


def fit_motion(robot, motion_fit, references, is_sampled):
    """Constant of each of MOTION_KEYS, and the covariance of their logarithms; one that the file has as 0 stays so."""
    file = {key: robot.number(key) for key in MOTION_KEYS}
    gear = robot.positive("motor.gear_ratio")
    sought = [key for key in MOTION_KEYS if file[key] > 0]
    start = np.log([file[key] for key in sought])
    seen = observations(motion_fit, gear, references, is_sampled)
    roots = [np.linalg.inv(np.linalg.cholesky(one.covariance)) for one in seen]

    def constants(logarithms):
        return file | dict(zip(sought, np.exp(logarithms)))

    def residuals(logarithms):
        guess = constants(logarithms)
        return np.concatenate([*(root @ (one.model(guess) - one.values) for root, one in zip(roots, seen)),
                               (logarithms - start) / PRIOR])

    found = optimize.least_squares(residuals, start, x_scale=PRIOR, xtol=1e-12, ftol=1e-12)
    covariance = np.zeros((len(MOTION_KEYS), len(MOTION_KEYS)))
    places = [MOTION_KEYS.index(key) for key in sought]
    covariance[np.ix_(places, places)] = np.linalg.inv(found.jac.T @ found.jac)
    fitted = constants(found.x)
    deviations = np.sqrt(np.diag(covariance))
    return [Constant(key, file[key], float(fitted[key]), float(fitted[key] * deviation),
                     bool(0 < deviation < TOLD * PRIOR))
            for key, deviation in zip(MOTION_KEYS, deviations)], covariance


def fit_supply(robot, found):
    """Constants of the supply; the log tells them by themselves or not at all."""
    constants = []
    for key in ("electronics.power_w", "supply.voltage_v", "supply.resistance_ohm", "supply.capacity_wh"):
        file = robot.number(key)
        told = getattr(found, SUPPLY_KEYS[key]) if key in SUPPLY_KEYS else None
        is_told = told is not None and told[0] >= 0 and told[1] < TOLD * PRIOR * max(told[0], 1e-9)
        value, deviation = told if is_told else (file, PRIOR * file)
        constants.append(Constant(key, file, value, deviation, is_told))
    return constants


@dataclass(frozen=True)
class RobotFit:
    constants: list         # Constant, by UNITS
    covariance: np.ndarray  # of the logarithms of MOTION_KEYS
    robot: object           # with the constants that agree best with logs and file


def fit(robot, motion_fit, supply, references, is_sampled):
    constants, covariance = fit_motion(robot, motion_fit, references, is_sampled)
    constants += fit_supply(robot, supply)
    return RobotFit(constants, covariance, robot.varied({constant.key: constant.value for constant in constants}))


def deviation_of(found, function):
    """Standard deviation of a function of the robot that only MOTION_KEYS enter, from the covariance."""
    middle, step = function(found.robot), 1e-4
    slopes = np.array([(function(found.robot.varied({key: found.robot.number(key) * (1 + step)})) - middle) / step
                       for key in MOTION_KEYS])
    return float(np.sqrt(slopes @ found.covariance @ slopes))
