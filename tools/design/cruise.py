"""How wheels and body of a balancer move together, linear about standing upright: for trajectories of cruise and
transients (include/joulepath/trajectory.h).

The plant has a flat output ν, which is the speed v in steady motion:

  v = ν − lag ν̈    ψ = lean₀ ν + lean₁ ν̇    mean voltage = Σ voltsᵢ ν⁽ⁱ⁾

A difference of (v, ψ, ψ̇) from that motion is to vanish for the least ∫ u² dt: the regulator of that price mirrors the
plant's poles, and each of its three modes decays alone.
"""
import math
from dataclasses import dataclass

import numpy as np
from scipy import linalg, optimize

# Modes whose decays differ by less are hard to tell from each other; those nearer to 1/√lag, from no speed at all.
MODES_APART = 1.3
STILL_APART = 1.05

TRAVEL = (3, 1, 4)  # θ̇ ψ ψ̇ of linear_model.STATES
YAW = 5             # φ̇


@dataclass(frozen=True)
class Flat:
    lag: float         # s²
    lean: np.ndarray   # rad·s/m, rad·s²/m
    volts: np.ndarray  # V·s/m … V·s⁴/m
    turning: np.ndarray  # half the difference of the voltages by φ̇ and φ̈: V·s/rad, V·s²/rad


@dataclass(frozen=True)
class Mode:
    decay: float       # 1/s
    share: np.ndarray  # of v, ψ, ψ̇ in it: m/s per m/s, rad, rad/s
    lean: float        # what it adds to ψ, rad per m/s
    lean_rate: float   # to ψ̇, rad/s per m/s
    volts: float       # to the mean voltage, V per m/s


def travel_plant(plant, radius):
    """d/dt (v, ψ, ψ̇) by itself and by the mean voltage, in m."""
    scale = np.array([radius, 1, 1])
    states = plant.a[np.ix_(TRAVEL, TRAVEL)] * scale[:, None] / scale
    return states, plant.b[list(TRAVEL)].sum(axis=1) * scale


def flat(plant, radius):
    states, volts = travel_plant(plant, radius)
    reach = np.column_stack([volts, states @ volts, states @ states @ volts])
    rows = [np.linalg.inv(reach)[-1]]
    for _ in range(3):
        rows.append(rows[-1] @ states)
    motion = np.linalg.inv(np.array(rows[:3]))
    scale = motion[0, 0]
    motion = motion / scale
    voltages = np.append(-rows[3] @ motion * scale, 1) / scale / (rows[2] @ volts)
    damping, push = plant.a[YAW, YAW], (plant.b[YAW, 1] - plant.b[YAW, 0])
    return Flat(-motion[0, 2], motion[1, :2], voltages, np.array([-damping, 1]) / push)


def ascending(values):
    """The nearest numbers that do not fall, by least squares: what falls is pooled to its mean."""
    pools = []  # [mean, count]
    for value in values:
        pools.append([value, 1])
        while len(pools) > 1 and pools[-2][0] > pools[-1][0]:
            (first, many), (second, more) = pools[-2:]
            pools[-2:] = [[(first * many + second * more) / (many + more), many + more]]
    return np.concatenate([np.full(count, mean) for mean, count in pools]) if pools else np.array([])


def spread(logarithms, low=-np.inf, high=np.inf):
    """The nearest logarithms that are apart, and within low and high."""
    steps = np.arange(len(logarithms)) * math.log(MODES_APART)
    return np.clip(ascending(logarithms - steps), low, high - steps[-1:].sum()) + steps


def told_apart(decays, lag):
    """The nearest decays that are so far from each other that their modes are not alike, and so far from 1/√lag, where a
    mode leaves the speed as it is."""
    logarithms = np.log(np.sort(decays))
    if lag <= 0:
        return np.exp(spread(logarithms))
    still, gap = -math.log(lag) / 2, math.log(STILL_APART)
    slower, faster = logarithms[logarithms < still], logarithms[logarithms >= still]
    return np.exp(np.concatenate([spread(slower, high=still - gap), spread(faster, low=still + gap)]))


def placed(states, push, decays):
    """Gain that gives these real poles (Ackermann)."""
    powers = [push, states @ push, states @ states @ push]
    polynomial = np.eye(3)
    for decay in decays:
        polynomial = polynomial @ (states + decay * np.eye(3))
    return np.linalg.solve(np.column_stack(powers).T, np.array([0, 0, 1.0])) @ polynomial


def modes(plant, radius):
    """Of the regulator of least ∫ u² dt, by the speed that they are. Where its poles are alike they are moved apart, which
    takes 2 % more of that integral at most."""
    states, push = travel_plant(plant, radius)
    gain = push @ linalg.solve_continuous_are(states, push[:, None], np.zeros((3, 3)), np.eye(1))
    decays = np.sort(np.abs(np.linalg.eigvals(states - np.outer(push, gain))))
    apart = told_apart(decays, flat(plant, radius).lag)
    if not np.allclose(apart, decays, rtol=1e-9):
        gain = placed(states, push, apart)
    rates, vectors = np.linalg.eig(states - np.outer(push, gain))
    vectors = (vectors / vectors[0]).real
    return [Mode(-rate, share, vector[1], vector[2], -gain @ vector)
            for rate, share, vector in sorted(zip(rates.real, np.linalg.inv(vectors), vectors.T), key=lambda mode: mode[0])]


@dataclass(frozen=True)
class Turn:
    """How a waypoint is rounded at cruising speed."""
    blend: float  # s, before and after it
    pace: float   # 1/s, turn rate in it by the turn


@dataclass(frozen=True)
class WayBack:
    """To the path, when the robot is beside it: critically damped at the speed of least energy."""
    steering: float  # 1/s, of the heading towards its aim
    aim: float       # turns of heading by wheel turns beside the path


def way_back(robot, flat_motion, turn_at_waypoint):
    """As slow as a waypoint's turn, which is the quickest that pays."""
    voltage = math.sqrt(robot.positive("electronics.power_w") * robot.positive("motor.resistance_ohm") / 2)
    wheel_rate = voltage / flat_motion.volts[0] / robot.positive("wheel.radius_m")  # rad/s
    return WayBack(2 / turn_at_waypoint.blend, 1 / (2 * wheel_rate * turn_at_waypoint.blend))


TURN = np.pi / 3  # the shape hardly depends on it
SHARES, WEIGHTS = (np.array(part) for part in np.polynomial.legendre.leggauss(16))


def turn_cost(robot, flat_motion, blend, pace):
    """J of half a turn: the voltages' difference, and the way that is longer than the two lines. What φ̇ φ̈ costs before
    the waypoint comes back after it."""
    resistance, electronics = robot.positive("motor.resistance_ohm"), robot.positive("electronics.power_w")
    share, weight = (SHARES + 1) / 2, WEIGHTS / 2 * blend
    half, rate = TURN / 2, pace * TURN
    bend = 6 * half / blend - 3 * rate
    heading = half * share**2 * (3 - 2 * share) + blend * rate * share * (1 - share)**2
    turn_rate = rate * (1 - share) + bend * share * (1 - share)
    acceleration = (bend * (1 - 2 * share) - rate) / blend
    squares = flat_motion.turning**2 @ [turn_rate**2, acceleration**2]
    return weight @ (2 * squares / resistance + 2 * electronics * (1 - np.cos(half - heading)))


def turn(robot, flat_motion):
    """The one of least cost."""
    def cost(numbers):
        return turn_cost(robot, flat_motion, *np.exp(numbers))

    found = optimize.minimize(cost, np.zeros(2), method="Nelder-Mead", options={"xatol": 1e-6, "fatol": 1e-12})
    return Turn(*np.exp(found.x))
