"""What a skid-steered or differential-drive robot can learn of its energy, and how sure that makes its forecasts.

The learner of include/joulepath/skid_learner.h in floating point, of many robots at once. Its noise is what its own
forecasts miss of robots that it learns from in the same way.
"""
import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import optimize

from tools.design import identification, skid_model
from tools.design.identification import MEMORY, SURE, SURE_DEVIATIONS

# Of the factors about 1, root mean square over what jp-skid-identify draws: rolling 0.7 to 1.5, friction 0.6 to 1.2,
# weight 0.9 to 1.3, electronics 0.8 to 1.2.
RANGES = ((0.7, 1.5), (0.6, 1.2), (0.9, 1.3), (0.8, 1.2))
FACTOR_MIN, FACTOR_MAX = 0.25, 4
STEP = 1e-5  # of derivatives by x

OUTLIER_DEVIATIONS = 4
SCALE_MEMORY, SCALE_MIN, SCALE_MAX = 128, 0.25, 8

PHASES_OF_ROUTE = 100  # in jp-skid-identify
NOISE_START = (1, 0.01, 0.01)
ROUNDS = 3
LEAST_PART = 1e-6  # of the noise, J and shares
INSIDE, INSIDE_DEVIATIONS = 0.95, 1.959964


def deviations():
    return identification.deviations(RANGES)


@dataclass(frozen=True)
class Learning:
    """struct jp_skid_learning in SI units."""
    deviation: np.ndarray
    noise: float           # J
    noise_relative: float
    noise_slopes: float
    spread: float
    untaught: np.ndarray  # relative errors of plans, before and after learning
    taught: np.ndarray
    inside: float         # share of plans inside their intervals


def factors(x):
    return np.clip(1 + deviations() * x, FACTOR_MIN, FACTOR_MAX)


# ---- Legs ------------------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Legs:
    """Legs of many robots: tables with a row a robot and a column a leg; those of robots with fewer end in zeros."""
    pieces: skid_model.Pieces
    robot: np.ndarray  # of each piece
    leg: np.ndarray
    route: np.ndarray
    shape: tuple

    def table(self, values):
        return np.bincount(self.robot * self.shape[1] + self.leg, values, self.shape[0] * self.shape[1]).reshape(self.shape)

    def column(self, leg):
        which = self.leg == leg
        return Legs(self.pieces.chosen(which), self.robot[which], self.leg[which] - leg, self.route[which], (self.shape[0], 1))

    @cached_property
    def measured(self):
        return self.table(self.pieces.energy)

    def on_route(self, route):
        """Whether a leg is: a table."""
        return self.table(self.route == route) > 0

    def energies(self, model, of_robots):
        """of_robots: factors, a row a robot."""
        return self.table(skid_model.energies(model.scaled(of_robots[self.robot].T), self.pieces))

    def slope_works(self, model):
        return self.table(skid_model.slope_works(model, self.pieces))


def legs_of(run, phase, pieces):
    """A leg ends where the robot drives on: one that turns on the spot on a slope slides down it, and is led back by what
    it drives next."""
    robot = np.unique(run, return_inverse=True)[1]
    is_last = np.append(np.diff(run) != 0, True)
    ends = is_last | np.append(np.diff(phase) != 0, True) & (pieces.speed[1] != 0)
    leg = np.cumsum(ends) - ends
    leg -= leg[np.searchsorted(robot, robot)]
    return Legs(pieces, robot, leg, phase // PHASES_OF_ROUTE, (robot[-1] + 1, int(leg.max()) + 1))


# ---- The learner -----------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Noise:
    """Standard deviation of a leg: J, share of its energy, and share of the work of its slopes."""
    parts: np.ndarray
    spread: float = 1.0  # of single legs beyond it

    def variance(self, energy, slopes):
        constant, by_energy, by_slopes = self.parts**2
        return constant + by_energy * energy**2 + by_slopes * slopes**2


class Learner:
    """As jp_skid_learner, of many robots; changes of robot or ground are not looked for."""

    def __init__(self, model, noise, count):
        self.model, self.noise = model, noise
        self.x = np.zeros((count, skid_model.FACTORS))
        self.root = np.tile(np.eye(skid_model.FACTORS), (count, 1, 1))
        self.scale = np.ones(count)

    def expect(self, legs):
        """Energies of legs, their derivatives by x, and the variances of their noise: tables."""
        def energies(x):
            return legs.energies(self.model, factors(x))

        energy = energies(self.x)
        gradient = [(energies(self.x + step) - energy) / STEP for step in STEP * np.eye(skid_model.FACTORS)]
        return energy, np.stack(gradient, axis=-1), self.noise.variance(energy, legs.slope_works(self.model)) * self.scale[:, None]**2

    def update(self, legs, which):
        """From one column of legs, of those robots which learn."""
        energy, gradient, variance = (values[:, 0] for values in self.expect(legs))
        sigma = np.sqrt(variance)
        root = self.root + self.root @ (np.eye(skid_model.FACTORS) - self.root.transpose(0, 2, 1) @ self.root) / (2 * MEMORY)
        v = np.einsum("rij,ri->rj", root, gradient / sigma[:, None])
        d = np.sqrt(1 + np.sum(v**2, axis=1))
        gate = OUTLIER_DEVIATIONS * self.noise.spread
        innovation = np.clip((legs.measured[:, 0] - energy) / (sigma * d), -gate, gate)
        surprise = ((innovation / self.noise.spread)**2 - 1) / d**2
        unit = v / d[:, None]
        gain = np.einsum("rij,rj->ri", root, unit)
        self.x = np.where(which[:, None], self.x + gain * innovation[:, None], self.x)
        self.root = np.where(which[:, None, None], root - np.einsum("ri,rj->rij", gain, unit * (d / (d + 1))[:, None]), self.root)
        self.scale = np.where(which, np.clip(self.scale * (1 + surprise / SCALE_MEMORY), SCALE_MIN, SCALE_MAX), self.scale)


# ---- What is left ----------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Plans:
    """What robots drive that have learned from their other legs: tables of all legs, of which some are in the plan."""
    planned: np.ndarray
    measured: np.ndarray
    energy: np.ndarray
    gradient: np.ndarray
    slopes: np.ndarray
    root: np.ndarray
    scale: np.ndarray

    def missed(self):
        return np.where(self.planned, self.energy - self.measured, 0)

    def errors(self):
        return self.missed().sum(axis=1) / np.where(self.planned, self.measured, 0).sum(axis=1)

    def variances(self, noise):
        """Of each leg and of the plans, by the noise and by what is not known of the robot."""
        single = noise.variance(self.energy, self.slopes) * self.scale[:, None]**2
        gradient = np.where(self.planned[..., None], self.gradient, 0)
        of_legs = np.sum(np.einsum("rli,rij->rlj", gradient, self.root)**2, axis=-1)
        of_plans = np.sum(np.einsum("ri,rij->rj", gradient.sum(axis=1), self.root)**2, axis=-1)
        return single + of_legs, np.where(self.planned, single, 0).sum(axis=1) + of_plans


def plan(model, noise, legs, route):
    """Each robot drives one route after it learned from the others."""
    planned = legs.on_route(route)
    lessons = (legs.measured != 0) & ~planned
    learner = Learner(model, noise, legs.shape[0])
    for leg in range(legs.shape[1]):
        which = lessons[:, leg]
        if which.any():
            learner.update(legs.column(leg), which)
    energy, gradient, _ = learner.expect(legs)
    return Plans(planned, legs.measured, energy, gradient, legs.slope_works(model), learner.root, learner.scale)


def likeliest(plans, noise):
    """The parts of the noise by which what single legs miss is likeliest."""
    missed, energy, slopes = (np.concatenate([values(made)[made.planned] for made in plans])
                              for values in (Plans.missed, lambda made: made.energy, lambda made: made.slopes))

    def cost(logarithms):
        variances = Noise(np.exp(logarithms)).variance(energy, slopes)
        return np.mean(np.log(variances) + missed**2 / variances)

    start = np.log(np.maximum(noise.parts, LEAST_PART))
    found = optimize.minimize(cost, start, method="L-BFGS-B", bounds=[(math.log(LEAST_PART), None)] * len(start))
    return np.exp(found.x)


def surprises(plans, noise):
    """Errors of plans and of single legs over their standard deviations."""
    of_plans = np.concatenate([made.missed().sum(axis=1) / np.sqrt(made.variances(noise)[1]) for made in plans])
    of_legs = np.concatenate([(made.missed() / np.sqrt(made.variances(noise)[0]))[made.planned] for made in plans])
    return of_plans, of_legs


def learn(model, legs):
    """Robots learn, and what their forecasts then miss is the noise that they learn with."""
    def plans_with(noise):
        return [plan(model, noise, legs, route) for route in np.unique(legs.route)]

    noise = Noise(np.array(NOISE_START, float))
    for _ in range(ROUNDS):
        plans = plans_with(noise)
        noise = replace(noise, parts=likeliest(plans, noise))
    for _ in range(ROUNDS):
        plans = plans_with(noise)
        of_plans, of_legs = surprises(plans, noise)
        scale = float(np.quantile(np.abs(of_plans), INSIDE)) / INSIDE_DEVIATIONS
        spread = float(np.quantile(np.abs(of_legs), SURE)) / SURE_DEVIATIONS
        noise = Noise(scale * noise.parts, max(spread / scale, 1.0))
    plans = plans_with(noise)
    before = legs.energies(model, np.ones((legs.shape[0], skid_model.FACTORS))).sum(axis=1) / legs.measured.sum(axis=1) - 1
    return Learning(deviations(), *map(float, noise.parts), noise.spread, before, np.concatenate([made.errors() for made in plans]),
                    float(np.mean(np.abs(surprises(plans, noise)[0]) <= INSIDE_DEVIATIONS)))
