"""What the legs of trajectories teach: how a robot's transients change along the directions of learning.py, and the noise
that is left. Robots of the population drive routes in the simulator: jp-trip --legs.

What b1 and b2 leave of a robot's legs is not independent: all that begin or end at rest err alike. So what the transients
take changes with x, too. What is left when x is as good as the legs tell it is noise.
"""
import csv
import io
import math
import subprocess
from dataclasses import dataclass

import numpy as np

from tools.common import ToolError

ROBOTS = 40
TRANSIENTS = 3  # JP_LEG_TRANSIENTS
ROUNDS = 4      # of the noise, which weighs the legs that it is found from

# Of src/learn/learned_state.c and learner_filter.h.
SENSITIVITY_MAX = 1000
OUTLIER_DEVIATIONS = 4
SPREAD_MAX = 16
NOISE_MEMORY = 128

CAUSES = ("ground_friction", "payload_kg", "motor_resistance", "motor_friction")
STEADY = ("travel", "turning")
CHANGING = ("speeding_j", "pushing_j", "bending_j")


@dataclass(frozen=True)
class Legs:
    """Of several robots, one after the other."""
    robot: np.ndarray       # its number, from 0
    causes: list            # of each robot: CAUSES
    is_forecast: np.ndarray  # of the second route of a robot, which is forecast from what it learned on the first
    steady: np.ndarray      # legs × 2, what multiplies b1 and b2
    transients: np.ndarray  # legs × TRANSIENTS, J
    expected: np.ndarray    # J of the robot of the file
    measured: np.ndarray


@dataclass(frozen=True)
class Lesson:
    """What legs teach."""
    rows: np.ndarray       # TRANSIENTS × directions: relative change of what the transients take
    noise: np.ndarray      # standard deviations: J, share of the energy, share of what its transients take
    spread: float          # by how much single legs exceed it
    taught: np.ndarray     # the likeliest x of each robot
    surprises: np.ndarray  # of each robot's forecast, in standard deviations


def drive(program, path, definition):
    """Each at the speed that spends the least of the energy of this definition."""
    command = [str(program), "--legs", f"--count={ROBOTS}", f"--energy={definition}", str(path)]
    try:
        result = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise ToolError(f"{program}: {error.strerror}; run make") from error
    if result.returncode != 0:
        raise ToolError(result.stderr.strip() or f"{program}: exit status {result.returncode}")
    return read(result.stdout, program)


def read(text, source):
    rows = list(csv.DictReader(io.StringIO(text)))
    if not rows:
        raise ToolError(f"{source}: holds no legs")
    try:
        columns = {name: np.array([float(row[name]) for row in rows]) for name in (
            "seed", "route", *CAUSES, *STEADY, *CHANGING, "expected_j", "measured_j")}
    except (KeyError, TypeError, ValueError) as error:
        raise ToolError(f"{source}: not the legs of jp-trip --legs: {error}") from error
    _, first, robot = np.unique(columns["seed"], return_index=True, return_inverse=True)
    causes = [[columns[name][k] for name in CAUSES] for k in first]
    return Legs(robot, causes, columns["route"] == 1, np.column_stack([columns[name] for name in STEADY]),
                np.column_stack([columns[name] for name in CHANGING]), columns["expected_j"], columns["measured_j"])


def coefficients(legs, changes):
    """What each robot's legs say by themselves: changes of b1 and b2, and of what the transients take, a row a robot."""
    basis = np.hstack([legs.steady, legs.transients]) / legs.expected[:, None]
    return np.array([np.linalg.lstsq(basis[own], (changes / legs.expected)[own], rcond=None)[0]
                     for own in (legs.robot == number for number in range(len(legs.causes)))])


def find_rows(legs, changes, steady, x):
    """TRANSIENTS × DIRECTIONS: relative change of what the transients take, whose changes of each robot are given.

    Where x changes b1 and b2, legs tell it. The transients take the directions that are left, turned so that they mean what
    segments mean by them."""
    free = np.linalg.svd(steady)[2][len(steady):].T
    size, robots, count = np.sqrt(np.mean(legs.transients**2, axis=0)), len(changes), free.shape[1]
    along, moved, ways = np.linalg.svd(changes * size / math.sqrt(robots), full_matrices=False)
    left, _, right = np.linalg.svd((x @ free).T @ along[:, :count])
    return (ways[:count] * moved[:count, None] / size).T @ (free @ left @ right).T


def left_over(legs, changes, sensitivity, deviations):
    """Squares of what the likeliest x of each robot leaves, as large as if x were known."""
    squares = np.empty(len(changes))
    for number in range(len(legs.causes)):
        own = legs.robot == number
        h, y = sensitivity[own] / deviations[own, None], changes[own] / deviations[own]
        gain = np.linalg.solve(h.T @ h + np.eye(h.shape[1]), h.T)
        leverage = np.einsum("ij,ji->i", h, gain)
        squares[own] = (y - h @ (gain @ y))**2 / (1 - leverage) * deviations[own]**2
    return squares


def surprise(sensitivity, changes, deviations, spread, is_forecast, memory):
    """What the second route of a robot takes beyond its forecast, in standard deviations of that: src/learn in real
    numbers."""
    size = sensitivity.shape[1]
    s, x, scale = np.eye(size), np.zeros(size), 1.0
    learnt = ~is_forecast
    for f, change, deviation in zip(sensitivity[learnt], changes[learnt], deviations[learnt]):
        s = s + s @ (np.eye(size) - s.T @ s) / (2 * memory)
        noise = max(scale * deviation, np.abs(f).max() / SENSITIVITY_MAX)
        v = s.T @ f / noise
        d = math.sqrt(1 + v @ v)
        gate = OUTLIER_DEVIATIONS * spread
        innovation = np.clip((change - f @ x) / noise / d, -gate, gate)
        scale += scale * ((innovation / spread)**2 - 1) / d**2 / NOISE_MEMORY
        x = x + s @ v / d * innovation
        s = s - np.outer(s @ v, v) / (d * (d + 1))
    whole = sensitivity[is_forecast].sum(axis=0)
    error = changes[is_forecast].sum() - whole @ x
    return error / math.sqrt((scale**2 * deviations[is_forecast]**2).sum() + (s.T @ whole) @ (s.T @ whole))


def spread_of(factor):
    """Of single legs beyond the noise that is so many times what they leave."""
    return min(max(1 / factor, 1.0), SPREAD_MAX)


def calibrated(legs, changes, sensitivity, deviations, memory):
    """By how much the noise is to be multiplied so that routes are as far from their forecasts as those say, and how far they
    then are, in standard deviations. Forgetting and formats add to the learner's own uncertainty, and what one leg takes
    too much the next may take too little."""
    def surprises(factor):
        return np.array([surprise(sensitivity[own], changes[own], factor * deviations[own], spread_of(factor),
                                  legs.is_forecast[own], memory)
                         for own in (legs.robot == number for number in range(len(legs.causes)))])

    factor = 1.0
    for _ in range(ROUNDS):
        factor *= math.sqrt(np.mean(surprises(factor)**2))
    return factor, surprises(factor)


def taught(legs, changes, sensitivity, deviations):
    """The likeliest x of each robot by its legs."""
    found = []
    for number in range(len(legs.causes)):
        own = legs.robot == number
        h, y = sensitivity[own] / deviations[own, None], changes[own] / deviations[own]
        found.append(np.linalg.solve(h.T @ h + np.eye(h.shape[1]), h.T @ y))
    return np.array(found)


def learn(legs, directions, x, memory, fit_noise):
    """x: of each robot, as segments tell it."""
    changes = legs.measured - legs.expected
    rows = find_rows(legs, coefficients(legs, changes)[:, len(STEADY):], directions[-len(STEADY):], x)
    sensitivity = legs.steady @ directions[-len(STEADY):] + legs.transients @ rows
    spent = np.abs(legs.transients).sum(axis=1)
    parts = np.column_stack([np.ones(len(changes)), legs.expected, spent])
    deviations = np.sqrt(parts[:, 1]**2 + spent**2) * np.mean(np.abs(changes)) / legs.expected.mean()
    for _ in range(ROUNDS):
        noise = fit_noise(*parts[:, 1:].T, left_over(legs, changes, sensitivity, deviations))
        deviations = np.sqrt(parts**2 @ np.square(noise))
    factor, surprises = calibrated(legs, changes, sensitivity, deviations, memory)
    noise = noise * factor
    return Lesson(rows, noise, spread_of(factor),
                  taught(legs, changes, sensitivity, np.sqrt(parts**2 @ np.square(noise))), surprises)
