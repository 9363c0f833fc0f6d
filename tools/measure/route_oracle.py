"""The joint optimum of a route's segments (joulepath/route.h) in double precision, from many starts.

A route is rows of (γ, 1/T), one for each leg. Energies are those of joulepath/energy.h and, with transients, of
joulepath/horizon.h, where what the last segment's step costs is counted until it is settled.
"""
import math
import warnings
from dataclasses import dataclass

import numpy as np
from scipy import optimize

ARC_MAX = 0.9 * math.tau  # JP_ARC_ANGLE_MAX

# What a start is scaled by: speeds of about this, m/s.
TYPICAL_SPEED = 0.4

# Of the constraints, which are shares of the limits.
VIOLATION_MAX = 1e-6

PRECISION = 1e-9  # of the energy
ITERATIONS = 150

RANDOM_ARC = 1.5  # rad

V, W, SIGMA, V_BEFORE, W_BEFORE = range(5)


@dataclass(frozen=True)
class Limits:
    speed: float      # m/s
    turn_rate: float  # rad/s
    turn: float       # rad
    shortest: float   # s
    longest: float    # s


@dataclass(frozen=True)
class Transients:
    """The modes of both axes, a pair as one complex mode; functionals take the real part of conj(f)·mode."""
    rate: np.ndarray  # 1/s, complex
    step: np.ndarray  # rows for Δv, Δw and σ: V a unit step
    cost: np.ndarray  # likewise: J/V a unit step, what a step meets


def transients_of(travel, yaw):
    """From two tables of tools/design/horizon.py."""
    def paired(table):
        first, k = [], 0
        while k < len(table.decay):
            first.append(k)
            k += 2 if table.frequency[k] else 1
        return first

    def complex_of(table, values):
        return np.array([values[k] + (1j * values[k + 1] if table.frequency[k] else 0) for k in paired(table)])

    rates, steps, costs = [], [], []
    for table, rows in ((travel, (0, None)), (yaw, (1, 2))):
        first = paired(table)
        rates.append(-table.decay[first] + 1j * table.frequency[first])
        step, cost = np.zeros((3, len(first)), complex), np.zeros((3, len(first)), complex)
        step[rows[0]] = complex_of(table, table.step[0])
        cost[rows[0]] = complex_of(table, table.cross[0] + table.steady)
        if rows[1] is not None:
            step[rows[1]] = complex_of(table, table.step[1])
            cost[rows[1]] = complex_of(table, table.cross[1])
        steps.append(step)
        costs.append(cost)
    return Transients(np.concatenate(rates), np.hstack(steps), np.hstack(costs))


class Model:
    """The settled energy as a quadratic form of (v, w, σ, v before, w before), friction and electronics."""

    def __init__(self, parameters):
        a, (self.b1, self.b2) = parameters["a"], parameters["b"]
        self.power, self.settling = parameters["electronics_power"], parameters["settling_time"]
        cv, cw = parameters["voltage_per_speed"], parameters["voltage_per_turn_rate"]
        step = np.array([[1, 0, 0, -1, 0], [0, 1, 0, 0, -1], [0, 0, 1, 0, 0.0]])
        quadratic = np.array([[a[0], a[3] / 2, a[4] / 2], [a[3] / 2, a[1], a[5] / 2], [a[4] / 2, a[5] / 2, a[2]]])
        left, right = np.array([0, 0, 0, cv, -cw]), np.array([0, 0, 0, cv, cw])
        voltage = np.outer(left, a[6:9] @ step) + np.outer(right, a[9:12] @ step)
        before = a[12] / parameters["motor_resistance"] * (np.outer(left, left) + np.outer(right, right))
        form = step.T @ quadratic @ step + (voltage + voltage.T) / 2 + before
        form[V, V] -= self.b1 * self.settling
        form[W, W] -= self.b2 * self.settling
        self.hessian = 2 * form


class Route:
    """Legs with chords `length`, m, that turn by `turn`, rad, each; from rest."""

    def __init__(self, model, limits, length, turn, transients=None):
        self.model, self.limits, self.transients = model, limits, transients
        self.length, self.turn = np.asarray(length, float), np.asarray(turn, float)
        self.count = len(self.length)
        self._turns = -(np.eye(self.count) + np.eye(self.count, k=-1)) / 2  # dσ/dγ
        self._scale = np.concatenate([np.ones(self.count), TYPICAL_SPEED / self.length])

    # ---- motion ----

    def sigma(self, arc):
        return self.turn + self._turns @ arc

    def _stretch(self, arc):
        """L/d and its derivative by γ."""
        half = arc / 2
        small = np.abs(half) < 1e-4
        half = np.where(small, 1, half)
        sine = np.sin(half)
        return (np.where(small, 1, half / sine),
                np.where(small, arc / 12, (sine - half * np.cos(half)) / (2 * sine**2)))

    # ---- energy ----

    def energy(self, arc, pace):
        """J and its gradients by γ and 1/T."""
        model, f, bend = self.model, *self._stretch(arc)
        v, w, sigma = self.length * f * pace, arc * pace, self.sigma(arc)
        motion = np.column_stack([v, w, sigma, np.append(0, v[:-1]), np.append(0, w[:-1])])
        by = motion @ model.hessian
        friction = model.b1 * (self.length * f)**2 + model.b2 * arc**2
        energy = (motion * by).sum() / 2 + (friction * pace + model.power / pace).sum()
        by_v, by_w, by_sigma = by[:, V], by[:, W], by[:, SIGMA]
        by_v[:-1] += by[1:, V_BEFORE]
        by_w[:-1] += by[1:, W_BEFORE]
        by_pace = friction - model.power / pace**2
        if self.transients is not None:
            extra, steps, times = self._carried(motion, pace)
            energy += extra
            by_v += steps[0] - np.append(steps[0, 1:], 0)
            by_w += steps[1] - np.append(steps[1, 1:], 0)
            by_sigma = by_sigma + steps[2]
            by_pace -= times / pace**2
        by_pace += by_v * self.length * f + by_w * arc
        by_arc = (by_v * self.length * bend * pace + by_w * pace + self._turns.T @ by_sigma
                  + 2 * (model.b1 * self.length**2 * f * bend + model.b2 * arc) * pace)
        return energy, by_arc, by_pace

    def _carried(self, motion, pace):
        """What unsettled starts add, and its gradients by the steps and by T."""
        modes = self.transients
        steps = np.array([motion[:, V] - motion[:, V_BEFORE], motion[:, W] - motion[:, W_BEFORE], motion[:, SIGMA]])
        jumps, costs, decay = steps.T @ modes.step, steps.T @ modes.cost, np.exp(np.outer(1 / pace, modes.rate))
        before = np.zeros((self.count + 1, len(modes.rate)), complex)
        for k in range(self.count):
            before[k + 1] = decay[k] * (before[k] + jumps[k])
        energy = (costs.conj() * before[:-1]).sum().real
        adjoint, times = np.zeros(len(modes.rate), complex), np.zeros(self.count)
        by_steps = (modes.cost.conj() @ before[:-1].T).real
        for k in reversed(range(self.count)):
            times[k] = (adjoint.conj() * modes.rate * before[k + 1]).sum().real
            adjoint = decay[k].conj() * adjoint
            by_steps[:, k] += (modes.step @ adjoint.conj()).real
            adjoint = adjoint + costs[k]
        return energy, by_steps, times

    # ---- optimum ----

    def _unpack(self, unknowns):
        unknowns = unknowns * self._scale
        return unknowns[:self.count], unknowns[self.count:]

    def _slack(self, unknowns):
        """Distances of v, w and σ from their limits, as shares of them."""
        arc, pace = self._unpack(unknowns)
        f, _ = self._stretch(arc)
        v, w = self.length * f * pace / self.limits.speed, arc * pace / self.limits.turn_rate
        sigma = self.sigma(arc) / self.limits.turn
        return np.concatenate([1 - v, 1 - w, 1 + w, 1 - sigma, 1 + sigma])

    def _slack_jacobian(self, unknowns):
        arc, pace = self._unpack(unknowns)
        f, bend = self._stretch(arc)
        none = np.zeros((self.count, self.count))
        v = np.hstack([np.diag(self.length * bend * pace), np.diag(self.length * f)]) / self.limits.speed
        w = np.hstack([np.diag(pace), np.diag(arc)]) / self.limits.turn_rate
        sigma = np.hstack([self._turns, none]) / self.limits.turn
        return np.vstack([-v, -w, w, -sigma, sigma]) * self._scale

    def optimum_from(self, arc, pace):
        """(J, γ, 1/T) of the optimum that SLSQP finds from there; J is infinite where it finds none."""
        unit = self.energy(arc, pace)[0]

        def energy(unknowns):
            value, by_arc, by_pace = self.energy(*self._unpack(unknowns))
            return value / unit, np.concatenate([by_arc, by_pace]) * self._scale / unit

        bounds = np.concatenate([np.tile([-ARC_MAX, ARC_MAX], (self.count, 1)),
                                 np.tile([1 / self.limits.longest, 1 / self.limits.shortest], (self.count, 1))])
        start = np.clip(np.concatenate([arc, pace]), *bounds.T) / self._scale
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Values in x were outside bounds")  # SLSQP clips its own rounding
            found = optimize.minimize(energy, start, jac=True, method="SLSQP", bounds=bounds / self._scale[:, None],
                                      constraints={"type": "ineq", "fun": self._slack, "jac": self._slack_jacobian},
                                      options={"maxiter": ITERATIONS, "ftol": PRECISION})
        is_feasible = self._slack(found.x).min() > -VIOLATION_MAX
        return (found.fun * unit if is_feasible else math.inf, *self._unpack(found.x))

    def random_start(self, generator):
        arc = generator.uniform(-RANDOM_ARC, RANDOM_ARC, self.count)
        speed = generator.uniform(0.5, 1.5, self.count) * TYPICAL_SPEED
        return arc, np.minimum(speed / self.length, 1 / self.limits.shortest)

    def turned_as(self, arc, turn):
        """The same route with the ways round that a plan with these γ and σ takes."""
        ways = np.round((turn - self.sigma(arc)) / math.tau)
        return Route(self.model, self.limits, self.length, self.turn + math.tau * ways, self.transients)
