"""The trajectory of cruise and transients that takes the least energy through waypoints, in double precision.

Of each leg the middle is a straight line at constant speed. Round a waypoint heading and speed are blended: the heading
by a cubic, the flat output of wheels and body by a quintic, so that with it the pitch that a speed needs is planned, too.
Whatever the start differs from the first leg's cruise decays as under the regulator of least energy, whose modes are the
robot's own. Heading, turn rate and speed at each waypoint, heading and speed of each middle and the legs' times are
free; a leg must end in its waypoint. All linear models are the plant's derivatives about standing upright.
"""
import math
from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy import linalg

from tools.measure.energy_limit import PITCH, PITCH_RATE, SPEED, STATES, X, Y, YAW, YAW_RATE

BLEND = 1.3            # s, each side of a waypoint
BLEND_SHARE = 1 / 2.1  # of a leg at most
TURN_PACE = 1.0        # 1/s: turn rate at a waypoint by the turn, where the search starts
NODES = 8              # Gauss-Legendre, of a blend or a middle
ITERATIONS = 300
STEP = 1e-3            # s

TRAVEL = [SPEED, PITCH, PITCH_RATE]


class Linear:
    """The plant about standing upright, as two axes."""

    def __init__(self, plant):
        state, volts = ca.SX.sym("state", STATES), ca.SX.sym("volts", 2)
        rate, power = plant.step(state, volts)[:2]
        everything = ca.vertcat(state, volts)
        at = ca.Function("at", [everything], [ca.jacobian(rate, everything), ca.hessian(power, everything)[0]])
        slopes, curvature = (np.array(part) for part in at(np.zeros(STATES + 2)))
        travel, mean = slopes[np.ix_(TRAVEL, TRAVEL)], slopes[TRAVEL, STATES]
        self._flatten(travel, mean)
        self.yaw = np.array([-slopes[YAW_RATE, YAW_RATE], 1]) / slopes[YAW_RATE, STATES + 1]  # difference of φ̇ and φ̈
        self.curvature, self.electronics = curvature, plant.electronics
        self._regulate(travel, mean)

    def _flatten(self, travel, mean):
        """States and mean voltage as sums of the flat output and its derivatives: ν, which is v in steady motion."""
        rows = [np.linalg.inv(np.column_stack([mean, travel @ mean, travel @ travel @ mean]))[-1]]
        for _ in range(3):
            rows.append(rows[-1] @ travel)
        self.states = np.linalg.inv(np.array(rows[:3]))
        scale = self.states[0, 0]
        self.states /= scale
        self.volts = np.append(-rows[3] @ self.states * scale, 1) / scale / (rows[2] @ mean)

    def _regulate(self, travel, mean):
        places = [*TRAVEL, STATES]
        cost = self.curvature[np.ix_(places, places)]
        push = mean[:, None]
        price = linalg.solve_continuous_are(travel, push, cost[:3, :3], cost[3:, 3:], s=cost[:3, 3:])
        self.gain = ((push.T @ price + cost[3:, :3]) / cost[3, 3]).ravel()
        self.rates, vectors = np.linalg.eig(travel - push @ self.gain[None, :])
        self._modes = [np.outer(vectors[:, k], np.linalg.inv(vectors)[k]) for k in range(3)]

    def decayed(self, start, time):
        """The difference of travel that was `start` at time 0."""
        shares = [(rate, (product(mode.real, start), product(mode.imag, start))) for rate, mode in zip(self.rates, self._modes)]
        return sum(ca.exp(rate.real * time) * (ca.cos(rate.imag * time) * real - ca.sin(rate.imag * time) * imaginary)
                   for rate, (real, imaginary) in shares)

    def power(self, state, volts):
        both = ca.vertcat(state, volts)
        return self.electronics + ca.dot(both, product(self.curvature, both)) / 2


def product(matrix, vector):
    """Of numbers and symbols; a single row gives a number."""
    return ca.mtimes(ca.DM(np.atleast_2d(matrix)), vector)


@dataclass(frozen=True)
class Piece:
    """Flat output and heading as polynomials in a share of its duration, lowest power first; their values may be
    CasADi's."""
    flat: list
    heading: list
    seconds: object


def derivatives(coefficients, share, seconds, count):
    """In time."""
    found = []
    for order in range(count):
        found.append(sum((c * share**i for i, c in enumerate(coefficients)), 0.0) / seconds**order)
        coefficients = [i * c for i, c in enumerate(coefficients)][1:]
    return found


def hermite(start, end, seconds):
    """Polynomial with these derivatives in time at its ends."""
    half = len(start)
    rows = [[math.perm(j, order) * (at if j > order else 1) if j >= order else 0 for j in range(2 * half)]
            for at in (0, 1) for order in range(half)]
    values = [value * seconds**order for end_values in (start, end) for order, value in enumerate(end_values)]
    inverse = np.linalg.inv(np.array(rows, float))
    return [sum(inverse[i, j] * values[j] for j in range(2 * half) if abs(inverse[i, j]) > 1e-12)
            for i in range(2 * half)]


@dataclass(frozen=True)
class Waypoint:
    heading: object
    turn_rate: object
    speed: object


class Unknowns:
    def __init__(self):
        self.symbols, self.first, self.low, self.high = [], [], [], []

    def new(self, first, low=-math.inf, high=math.inf):
        symbol = ca.SX.sym(f"x{len(self.symbols)}")
        for held, value in ((self.symbols, symbol), (self.first, first), (self.low, low), (self.high, high)):
            held.append(value)
        return symbol


class Plan:
    """From rest in the first point, looking along x, to settled motion at a speed in the last."""

    def __init__(self, task, end_speed):
        self.task, self.linear = task, Linear(task.plant)
        self._end_speed, self._unknowns = end_speed, Unknowns()
        self._energy, self._constraints = 0, []
        self._solve(self._pieces())

    def _waypoints(self, directions, cruise):
        new = self._unknowns.new
        turns = np.diff(directions)
        yield Waypoint(0.0, 0.0, None)
        for direction, turn in zip(directions, turns):
            yield Waypoint(new(direction + turn / 2), new(TURN_PACE * turn), new(cruise, 0, self.task.plant.speed_max))
        yield None

    def _pieces(self):
        legs, cruise, new = np.diff(self.task.points, axis=0), self.task.plant.cruise(), self._unknowns.new
        directions = np.unwrap(np.append(0.0, np.arctan2(legs[:, 1], legs[:, 0])))[1:]
        waypoints = list(self._waypoints(directions, cruise))
        pieces, begun = [], 0.0
        for k, (leg, before, after) in enumerate(zip(legs, waypoints, waypoints[1:])):
            seconds = np.hypot(*leg) / cruise + (0.5 if k == 0 else 0)
            blend = min(BLEND, BLEND_SHARE * seconds)
            heading, speed = new(directions[k]), new(cruise, 0, self.task.plant.speed_max)
            if k == 0:
                self._difference = -ca.DM(self.linear.states[:, 0]) * speed
            middle = new(seconds - 2 * blend, 0)
            made = list(self._leg(before, after, heading, speed, blend, middle))
            self._count(made, begun, leg)
            pieces += made
            begun += 2 * blend + middle
        return pieces

    def _leg(self, before, after, heading, speed, blend, middle):
        flat = [speed] if before.speed is None else hermite([before.speed, 0, 0], [speed, 0, 0], blend)
        yield Piece(flat, hermite([before.heading, before.turn_rate], [heading, 0], blend), blend)
        yield Piece([speed], [heading], middle)
        if after is None:
            yield Piece(hermite([speed, 0, 0], [self._end_speed, 0, 0], blend), [heading], blend)
        else:
            yield Piece(hermite([speed, 0, 0], [after.speed, 0, 0], blend),
                        hermite([heading, 0], [after.heading, after.turn_rate], blend), blend)

    def motion(self, piece, share, time, difference):
        """State, its place left out, and voltages."""
        flat = ca.vertcat(*derivatives(piece.flat, share, piece.seconds, 4))
        heading, turn_rate, bend = derivatives(piece.heading, share, piece.seconds, 3)
        left = self.linear.decayed(difference, time)
        speed, pitch, pitch_rate = ca.vertsplit(product(self.linear.states, flat[:3]) + left)
        return (ca.vertcat(0, 0, heading, speed, pitch, pitch_rate, turn_rate),
                ca.vertcat(product(self.linear.volts, flat) - product(self.linear.gain, left),
                           self.linear.yaw[0] * turn_rate + self.linear.yaw[1] * bend))

    def _count(self, pieces, begun, leg):
        """Energy and way of a leg."""
        way = ca.DM.zeros(2)
        for piece in pieces:
            for share, weight in zip(*np.polynomial.legendre.leggauss(NODES)):
                share, weight = (share + 1) / 2, weight / 2 * piece.seconds
                state, volts = self.motion(piece, share, begun + share * piece.seconds, self._difference)
                away = ca.vertcat(0, 0, 0, state[SPEED:])  # no place and no heading has a price
                self._energy += weight * self.linear.power(away, volts)
                way = way + weight * state[SPEED] * ca.vertcat(ca.cos(state[YAW]), ca.sin(state[YAW]))
            begun = begun + piece.seconds
        self._constraints.append(way - ca.DM(leg))

    def _solve(self, pieces):
        unknowns = ca.vertcat(*self._unknowns.symbols)
        solver = ca.nlpsol("trajectory", "ipopt", {"x": unknowns, "f": self._energy, "g": ca.vertcat(*self._constraints)},
                           {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.max_iter": ITERATIONS})
        found = solver(x0=self._unknowns.first, lbx=self._unknowns.low, ubx=self._unknowns.high, lbg=0, ubg=0)
        self.is_found, self.energy = solver.stats()["success"], float(found["f"])
        numbers = [(piece.flat, piece.heading, [piece.seconds]) for piece in pieces]
        flat = [ca.SX(value) for piece in numbers for part in piece for value in part]
        values = iter(np.array(ca.Function("values", [unknowns], [ca.vertcat(*flat)])(found["x"])).ravel())
        self.pieces = [Piece(*([next(values) for _ in part] for part in piece[:2]), next(values)) for piece in numbers]
        self.difference = np.array(ca.Function("start", [unknowns], [self._difference])(found["x"])).ravel()
        self.seconds = sum(piece.seconds for piece in self.pieces)

    def sampled(self):
        """For energy_limit.follow(): steps, states and voltages in their middles, and the steps that end legs."""
        time, share, seconds, flat, heading = (ca.SX.sym(name, *size) for name, size in (
            ("time", (1,)), ("share", (1,)), ("seconds", (1,)), ("flat", (6,)), ("heading", (4,))))
        piece = Piece(ca.vertsplit(flat), ca.vertsplit(heading), seconds)
        motion = ca.Function("motion", [flat, heading, seconds, share, time],
                             list(self.motion(piece, share, time, self.difference)))
        steps, states, volts, ends, begun = [], [], [], [], 0.0
        for number, piece in enumerate(self.pieces):
            count = max(1, math.ceil(piece.seconds / STEP))
            shares = (np.arange(count) + 0.5) / count
            padded = [np.tile(np.pad(part, (0, size - len(part)))[:, None], count)
                      for part, size in ((piece.flat, 6), (piece.heading, 4))]
            state, volt = motion.map(count)(*padded, np.full(count, max(piece.seconds, 1e-9)), shares,
                                            begun + shares * piece.seconds)
            steps.append(np.full(count, piece.seconds / count))
            states.append(np.array(state))
            volts.append(np.array(volt))
            begun += piece.seconds
            if number % 3 == 2:
                ends.append(sum(map(len, steps)))
        steps, states, volts = np.concatenate(steps), np.hstack(states), np.hstack(volts)
        moves = steps * states[SPEED] * np.array([np.cos(states[YAW]), np.sin(states[YAW])])
        states[[X, Y]] = self.task.points[:1].T + np.cumsum(moves, axis=1) - moves / 2
        return steps, states, volts, ends
