"""What the equations of motion of sim/balancer/plant.c say about a log.

The motors: u = Rm i + n Kb ω, with an offset of each current sensor. The travel, twice, with what the current i of both
motors makes; the yaw; all divided by the torque of an ampere n Kt, as motion alone does not tell how heavy a robot is:

  i = 2 (fm ω + fw θ̇) + A θ̈ + C (ψ̈ cosψ − ψ̇² sinψ)
  i = 2 fm ω + G (sinψ + φ̇² L/g sinψ cosψ) − C θ̈ cosψ − B ψ̈
  ir − il = 2 (fm + fw) δ + (Y + M L² sin²ψ (2R/W)²) δ̇ + …

ω is the wheels' mean speed against the body and θ̇ that in the world, δ half of right less left; A, B, C and Y are
inertias, G the weight's moment. The pitch has an offset that changes slowly. Where no current was logged i is u/Rm, and
fm holds the motors' back-EMF too.
"""
from dataclasses import dataclass

import numpy as np

from tools.identify import regression, signals

KNOTS = 20.0  # s between them; the offset of the pitch is linear from one to the next
MECHANICAL = ("fm", "fw", "A", "C", "B", "G", "Y")
SMOOTH_SHARE = 0.02  # of the currents, below which their jumps do not count
ROUNDS = 3   # of weighting the equations by their residuals
# Points in which both wheels and body are at rest tell nothing but offsets.
STAND_RATE = 0.02  # rad/s of the wheels, by the largest


@dataclass(frozen=True)
class MotionFit:
    """Coefficients of the equations with their covariance; None: not told by the log."""
    motors: regression.Estimate | None      # resistance, back-EMF, offsets of both voltages
    mechanics: regression.Estimate          # MECHANICAL, per n Kt or, without currents, per n Kt/Rm
    half_track: regression.Estimate | None  # W/2R, offset of the gyro
    tilt_offset: tuple | None               # rad, by which the robot's pitch is off, and its deviation
    wheel_rate: float                       # rad/s, that the log has, root of the mean square
    residual_share: float                   # of the current that the equations leave


def fit_motors(source, motion):
    """u = Rm i + n Kb ω for both sides."""
    rates = (motion.motor_rate - motion.difference_rate, motion.motor_rate + motion.difference_rate)
    ones, none = np.ones(len(motion.times)), np.zeros(len(motion.times))
    offsets = ((ones, none), (none, ones))
    matrix = np.vstack([np.column_stack([motion.currents[side], rates[side], *offsets[side]]) for side in (0, 1)])
    blocks = np.tile(regression.blocks_of(motion.times, motion.width), 2)
    # Currents of messages lag behind their voltages by a tick, with which references do not help.
    is_sampled = motion.half_tick > 0
    explaining = 2 * [with_constant(motion.references)] if is_sampled and motion.references is not None else None
    names = ("resistance", "back-EMF", "offset of the left current", "offset of the right current")
    return regression.fit(source, matrix, motion.voltages.ravel(), blocks, names, explaining)


def with_constant(references):
    return np.vstack([np.ones(references.shape[1]), references]).T


def knots(times):
    """Hat functions, a column each, apart for what is driven without a pause."""
    columns = []
    for run in signals.runs(times, KNOTS):
        count = max(2, round(np.ptp(times[run]) / KNOTS) + 1)
        places = np.linspace(times[run][0], times[run][-1], count)
        hats = np.zeros((len(times), count))
        hats[run] = np.column_stack([np.interp(times[run], places, row) for row in np.eye(count)])
        columns.append(hats)
    return np.hstack(columns)


def mean_currents(motion, motors):
    """Of the ticks: the back-EMF changes from the middle of a tick to its end, where the current is sampled."""
    if motors is None:
        return motion.torque_currents
    accelerations = (motion.wheel_acceleration - motion.pitch_acceleration
                     + np.array([[-1], [1]]) * motion.difference_acceleration)
    return motion.torque_currents + motors.values[1] / motors.values[0] * motion.half_tick * accelerations


def mechanical_rows(motion, half_track, currents):
    """Matrices of the three equations, columns as MECHANICAL, and what stands left of the equals sign."""
    m, none = motion, np.zeros(len(motion.times))
    sine, cosine = np.sin(m.pitch), np.cos(m.pitch)
    yaw_rate = m.difference_rate / half_track
    first = [2 * m.motor_rate, 2 * m.wheel_rate, m.wheel_acceleration,
             m.pitch_acceleration * cosine - m.pitch_rate**2 * sine, none, none, none]
    # M L² is three quarters of B, nearly: its share of these equations is small.
    second = [2 * m.motor_rate, none, none, -m.wheel_acceleration * cosine,
              -m.pitch_acceleration + 0.75 * yaw_rate**2 * sine * cosine, sine, none]
    leaning = 0.75 / half_track**2 * sine * (sine * m.difference_acceleration
                                             + 2 * cosine * m.pitch_rate * m.difference_rate)
    third = [2 * m.difference_rate, 2 * m.difference_rate, none, none, leaning, none, m.difference_acceleration]
    left, right = currents
    return [np.column_stack(rows) for rows in (first, second, third)], [left + right, left + right, right - left]


def instruments(motion, hats, trust):
    """Of each equation: motion follows what the controller does, with which no noise of the sensors goes. None: not
    logged."""
    if motion.references is None:
        return None
    followed = with_constant(motion.references)
    return [np.hstack(parts) * row[:, None] for parts, row in
            zip(([followed], [followed, hats], [followed]), trust)]


def fit_mechanics(source, motion, half_track, currents):
    """The coefficients, what the second equation says of the pitch's offset, and the share that is left."""
    matrices, targets = mechanical_rows(motion, half_track, currents)
    trust = [1 / np.hypot(SMOOTH_SHARE * np.std(target), motion.roughness[kind])
             for kind, target in zip((0, 0, 1), targets)]
    constant = np.ones((len(motion.times), 1))
    hats = knots(motion.times) * np.cos(motion.pitch)[:, None]
    extra = [constant, hats, constant]
    wide = []
    for i, matrix in enumerate(matrices):
        parts = [extra[i] if i == j else np.zeros_like(extra[j]) for j in range(3)]
        wide.append(np.hstack([matrix, *parts]) * trust[i][:, None])
    blocks = np.tile(regression.blocks_of(motion.times, motion.width), 3)
    names = [*MECHANICAL, "offset", *(f"tilt {i}" for i in range(hats.shape[1])), "offset of the difference"]
    targets = [row * target for row, target in zip(trust, targets)]
    explaining = instruments(motion, hats, trust)
    weights = np.ones(3)
    for _ in range(ROUNDS):
        matrix = np.vstack([weight * part for weight, part in zip(weights, wide)])
        target = np.concatenate([weight * part for weight, part in zip(weights, targets)])
        found = regression.fit(source, matrix, target, blocks, names, explaining)
        left = [float(np.sqrt(np.mean(part**2))) / weight
                for part, weight in zip(np.split(found.residuals, 3), weights)]
        weights = 1 / np.maximum(left, 1e-12)
    share = float(np.mean([size / np.std(part) for size, part in zip(left, targets)]))
    return found, knots(motion.times) @ found.values[8:8 + hats.shape[1]] / found.values[5], share


def fit_half_track(source, motion):
    """δ = W/2R φ̇ of the gyro; it turns with the body."""
    matrix = np.column_stack([motion.yaw_rate / np.cos(motion.pitch), np.ones(len(motion.times))])
    blocks = regression.blocks_of(motion.times, motion.width)
    return regression.fit(source, matrix, motion.difference_rate, blocks, ("turns", "offset of the gyro"))


def tilt_offset(motion, offset):
    """The robot's pitch less that by the equations, while it stands; the deviation is by blocks."""
    rates = np.abs(motion.motor_rate) + np.abs(motion.difference_rate)
    stands = rates < STAND_RATE * rates.max()
    if motion.logged_pitch is None or np.count_nonzero(stands) < 2:
        return None
    differences = (motion.logged_pitch - motion.pitch - offset)[stands]
    blocks = regression.blocks_of(motion.times[stands], motion.width)
    means = [differences[blocks == block].mean() for block in np.unique(blocks)]
    deviation = np.std(means, ddof=1) / np.sqrt(len(means)) if len(means) > 1 else np.std(differences)
    return float(np.mean(differences)), float(deviation)


def fit(source, motion, robot):
    half_track = robot.positive("body.width_m") / (2 * robot.positive("wheel.radius_m"))
    by_gyro = fit_half_track(source, motion) if motion.yaw_rate is not None else None
    motors = fit_motors(source, motion) if motion.has_currents else None
    mechanics, offset, share = fit_mechanics(source, motion, by_gyro.values[0] if by_gyro else half_track,
                                             mean_currents(motion, motors))
    return MotionFit(motors, mechanics, by_gyro, tilt_offset(motion, offset),
                     float(np.sqrt(np.mean(motion.wheel_rate**2))), share)
