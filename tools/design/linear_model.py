"""The balancing robot linearised at upright: plant, LQR gains, energy of its step responses.

State [θ ψ φ θ̇ ψ̇ φ̇ ∫θ ∫φ] in rad and s, inputs [ul ur] in V. The robot is symmetric: θ and ψ answer to the common
voltage (ul = ur), φ to the difference (ur = +d, ul = −d).
"""
import math
from dataclasses import dataclass

import numpy as np
from scipy import linalg

GRAVITY = 9.81  # m/s², as in sim/balancer/plant.h

STATES = ("θ", "ψ", "φ", "θ̇", "ψ̇", "φ̇", "∫θ", "∫φ")
TRAVEL = (0, 1, 3, 4, 6)  # θ ψ θ̇ ψ̇ ∫θ
YAW = (2, 5, 7)           # φ φ̇ ∫φ

# The Riccati solver is good to about 1e-10 and its last digits differ between libraries.
GAIN_DIGITS = 7

# Voltage within which a transition counts as settled, as in the paper.
SETTLED_VOLTS = 0.01
SEGMENT_SECONDS = 10.0


@dataclass(frozen=True)
class Plant:
    """dx/dt = a x + b u, and the steady voltages per speed and turn rate."""
    a: np.ndarray
    b: np.ndarray
    volts_per_speed: float      # cv, V·s/m
    volts_per_turn_rate: float  # cw, V·s/rad


@dataclass(frozen=True)
class Gains:
    """Rows of the gain; V per rad, V·s per rad and V per rad·s on reference − measured."""
    wheel: float
    pitch: float
    wheel_rate: float
    pitch_rate: float
    wheel_integral: float
    yaw: float
    yaw_rate: float
    yaw_integral: float

    @property
    def common(self):
        return np.array([self.wheel, self.pitch, self.wheel_rate, self.pitch_rate, self.wheel_integral])

    @property
    def difference(self):
        return np.array([self.yaw, self.yaw_rate, self.yaw_integral])


@dataclass(frozen=True)
class Design:
    plant: Plant
    gains: Gains
    poles: np.ndarray


@dataclass(frozen=True)
class EnergyModel:
    """Parameters of include/joulepath/energy.h in SI units."""
    a: tuple
    b: tuple
    electronics_power: float
    settling_time: float
    voltage_per_speed: float
    voltage_per_turn_rate: float
    motor_resistance: float


def steady_voltages(robot):
    """cv and cw of the energy model: volts per m/s and per rad/s of steady motion."""
    gear = robot.positive("motor.gear_ratio")
    resistance = robot.positive("motor.resistance_ohm")
    alpha = gear * robot.positive("motor.torque_constant_nm_per_a") / resistance
    beta = alpha * gear * robot.positive("motor.back_emf_v_s_per_rad") + robot.number("motor.friction_nm_s_per_rad")
    drag = (beta + robot.number("ground.friction_nm_s_per_rad")) / alpha
    per_speed = drag / robot.positive("wheel.radius_m")
    return per_speed, per_speed * robot.positive("body.width_m") / 2


def linear_plant(robot):
    body, wheel = robot.positive("body.mass_kg"), robot.positive("wheel.mass_kg")
    height, width = robot.positive("body.centre_height_m"), robot.positive("body.width_m")
    depth, radius = robot.positive("body.depth_m"), robot.positive("wheel.radius_m")
    gear, resistance = robot.positive("motor.gear_ratio"), robot.positive("motor.resistance_ohm")

    # Torque and back-EMF both carry the gear.
    alpha = gear * robot.positive("motor.torque_constant_nm_per_a") / resistance
    beta = alpha * gear * robot.positive("motor.back_emf_v_s_per_rad") + robot.number("motor.friction_nm_s_per_rad")
    ground = robot.number("ground.friction_nm_s_per_rad")

    wheel_own = wheel * radius**2 / 2
    rotor = gear**2 * robot.number("motor.rotor_inertia_kg_m2")
    coupling = body * height * radius - 2 * rotor
    mass = np.array([[(2 * wheel + body) * radius**2 + 2 * wheel_own + 2 * rotor, coupling],
                     [coupling, 4 / 3 * body * height**2 + 2 * rotor]])
    if np.linalg.det(mass) <= 1e-9 * mass[0, 0] * mass[1, 1]:
        raise robot.error("wheel, body", "the mass matrix is singular: wheels and body move as one")
    yaw_inertia = (wheel * width**2 / 2 + body * (width**2 + depth**2) / 12
                   + width**2 / (2 * radius**2) * (wheel_own + rotor))

    # Columns: ψ, θ̇, ψ̇ and the sum of the voltages.
    forces = np.array([[0, -2 * (beta + ground), 2 * beta, alpha],
                       [body * GRAVITY * height, 2 * beta, -2 * beta, -alpha]])
    travel = np.linalg.solve(mass, forces)
    half_track = width / (2 * radius)

    a = np.zeros((8, 8))
    b = np.zeros((8, 2))
    a[0:3, 3:6] = np.eye(3)
    a[3:5, [1, 3, 4]] = travel[:, 0:3]
    a[5, 5] = -2 * half_track**2 * (beta + ground) / yaw_inertia
    a[6, 0] = a[7, 2] = 1
    b[3:5, :] = travel[:, 3:4]
    b[5, :] = half_track * alpha / yaw_inertia * np.array([-1, 1])
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        raise robot.error("body, wheel, motor", "the linear plant is not finite")
    return Plant(a, b, *steady_voltages(robot))


def _check_controllable(robot, plant):
    for pole in np.linalg.eigvals(plant.a):
        # A gap far below the scale of the plant: no voltage moves that mode.
        pencil = np.hstack([plant.a - pole * np.eye(8), plant.b])
        singular = np.linalg.svd(pencil, compute_uv=False)
        if pole.real > -1e-6 and singular[-1] < 1e-9 * singular[0]:
            raise robot.error("motor, wheel, body", f"the motors cannot control the mode at {pole:.3g} 1/s")


def _rounded(value):
    return float(f"{value:.{GAIN_DIGITS - 1}e}")


def _rows(robot, gain):
    """Common and difference row of the 2 x 8 gain, after a check of its symmetry."""
    left, right = gain
    common, difference = (left + right) / 2, (right - left) / 2
    tolerance = 1e-6 * np.abs(gain).max()
    if np.abs(common[list(YAW)]).max() > tolerance or np.abs(difference[list(TRAVEL)]).max() > tolerance:
        raise robot.error("control.weights", "the optimal gain is not symmetric between left and right")
    return common, difference


def _check_signs(robot, gains):
    for name, value, sign in (("pitch", gains.pitch, -1), ("pitch rate", gains.pitch_rate, -1),
                              ("yaw", gains.yaw, 1), ("yaw rate", gains.yaw_rate, 1)):
        if value * sign <= 0:
            raise robot.error("control.weights", f"the {name} gain is {value:.4g} V/rad: its sign is wrong")


def regulator(robot, plant, weights, r):
    """Gain of the least ∫ xᵀ Q x + uᵀ R u dt, with the weights on the diagonal of Q."""
    try:
        cost = linalg.solve_continuous_are(plant.a, plant.b, np.diag(weights), r)
        gain = np.linalg.solve(r, plant.b.T @ cost)
    except (np.linalg.LinAlgError, ValueError) as error:
        raise robot.error("control.weights", f"the Riccati equation has no solution: {error}") from None
    if not np.isfinite(gain).all():
        raise robot.error("control.weights", "the gain is not finite")
    return gain


def design(robot):
    """LQR of the robot file's weights."""
    plant = linear_plant(robot)
    _check_controllable(robot, plant)
    weights = robot.numbers("control.weights", 8)
    if min(weights) < 0:
        raise robot.error("control.weights", "weights must not be negative")
    for index in (6, 7):
        if weights[index] == 0:
            raise robot.error(f"control.weights[{index}]", f"{STATES[index]} needs a weight above 0")
    gain = regulator(robot, plant, weights, robot.positive("control.input_weight") * np.eye(2))
    common, difference = _rows(robot, gain)
    gains = Gains(*(_rounded(common[i]) for i in TRAVEL), *(_rounded(difference[i]) for i in YAW))
    poles = np.linalg.eigvals(plant.a - plant.b @ gain)
    if poles.real.max() > -1e-4:
        raise robot.error("control.weights", f"the closed loop does not settle (pole at {poles.real.max():.3g} 1/s)")
    _check_signs(robot, gains)
    _check_sampled(robot, plant, gains)
    return Design(plant, gains, poles[np.argsort(poles.real)])


def sampled_plant(plant, rate):
    """Discrete plant for voltages that are held for a tick: x+ = f x + g u."""
    block = np.zeros((10, 10))
    block[:8, :8], block[:8, 8:] = plant.a, plant.b
    discrete = linalg.expm(block / rate)
    return discrete[:8, :8], discrete[:8, 8:]


def _check_sampled(robot, plant, gains):
    rate = robot.positive("control.rate_hz")
    f, g = sampled_plant(plant, rate)
    gain = np.zeros((2, 8))
    gain[:, list(TRAVEL)] = gains.common
    gain[:, list(YAW)] = np.array([[-1], [1]]) * gains.difference
    radius = np.abs(np.linalg.eigvals(f - g @ gain)).max()
    if radius >= 1:
        raise robot.error("control.rate_hz", f"at {rate:g} Hz the sampled loop is unstable (radius {radius:.4f})")


class _ShapedAxis:
    """src/balancer/reference.c in real numbers, one column for each step that is tried at once."""

    def __init__(self, rate_hz, shaping_s, target, target_rate):
        self._rate_hz = rate_hz
        self._bandwidth = 1 / shaping_s if shaping_s > 0 else 0
        self._target, self._target_rate = target.copy(), target_rate
        self.angle, self.rate = np.zeros_like(target), np.zeros_like(target)

    def advance(self):
        self._target += self._target_rate / self._rate_hz
        if self._bandwidth == 0:
            self.angle, self.rate = self._target.copy(), self._target_rate
            return
        pull = self._bandwidth * (self._target - self.angle) + 2 * (self._target_rate - self.rate)
        self.rate = self.rate + pull * self._bandwidth / self._rate_hz
        self.angle = self.angle + self.rate / self._rate_hz


@dataclass(frozen=True)
class StepResponses:
    """Motor voltage of each tick after a unit step."""
    speed: np.ndarray      # common, V per m/s
    turn_rate: np.ndarray  # difference, V per rad/s
    turn: np.ndarray       # difference, V per rad
    rate_hz: float


def step_responses(robot, loop, seconds):
    """Voltages of the sampled loop, with the reference's shaping, after steps of v, w and σ."""
    rate = robot.positive("control.rate_hz")
    radius = robot.positive("wheel.radius_m")
    f, g = sampled_plant(loop.plant, rate)
    zero = np.zeros(3)
    wheel = _ShapedAxis(rate, robot.number("control.travel_shaping_s"), zero, np.array([1 / radius, 0, 0]))
    yaw = _ShapedAxis(rate, robot.number("control.yaw_shaping_s"), np.array([0, 0, 1.0]), np.array([0, 1.0, 0]))
    state = np.zeros((8, 3))
    wheel_integral, yaw_integral = zero.copy(), zero.copy()
    voltages = np.empty((round(seconds * rate), 3))

    for tick in range(len(voltages)):
        wheel.advance()
        yaw.advance()
        wheel_error, yaw_error = wheel.angle - state[0], yaw.angle - state[2]
        wheel_integral += wheel_error / rate
        yaw_integral += yaw_error / rate
        common = loop.gains.common @ np.array([wheel_error, -state[1], wheel.rate - state[3], -state[4],
                                               wheel_integral])
        difference = loop.gains.difference @ np.array([yaw_error, yaw.rate - state[5], yaw_integral])
        voltages[tick] = common + difference
        state = f @ state + g @ np.array([common - difference, common + difference])
    return StepResponses(voltages[:, 0], voltages[:, 1], voltages[:, 2], rate)


def settling_time(robot, loop, responses, experiments=1000, seed=1, volts=SETTLED_VOLTS):
    """Mean time after which both voltages of a random transition stay within `volts` of their steady values."""
    generator = np.random.default_rng(seed)
    speed = robot.positive("limits.speed_m_s")
    turn_rate = robot.positive("limits.turn_rate_rad_s")
    turn = math.radians(robot.number("limits.turn_deg"))
    dv = generator.uniform(0, speed, (experiments, 2)) @ [-1, 1]
    dw = generator.uniform(-turn_rate, turn_rate, (experiments, 2)) @ [-1, 1]
    sigma = generator.uniform(-turn, turn, experiments)

    stride = max(1, round(responses.rate_hz / 100))
    common = np.outer(responses.speed[::stride] - loop.plant.volts_per_speed, dv)
    difference = (np.outer(responses.turn_rate[::stride] - loop.plant.volts_per_turn_rate, dw)
                  + np.outer(responses.turn[::stride], sigma))
    unsettled = np.abs(common) + np.abs(difference) > volts
    last = len(unsettled) - np.argmax(unsettled[::-1], axis=0)
    return float(np.mean(np.where(unsettled.any(axis=0), last, 0))) * stride / responses.rate_hz


def linear_energy_model(robot, loop=None, settling_seconds=None):
    """The energy model's parameters as the linear closed loop has them.

    With a settled start the voltages of a segment are ul = ul− + Δv gv − Δw gw − σ gσ, ur = ur− + Δv gv + Δw gw + σ gσ;
    the energy of [0, Ts] is the integral of their squares. Products of common and difference cancel: a4 = a5 = 0.
    """
    loop = loop or design(robot)
    responses = step_responses(robot, loop, SEGMENT_SECONDS)
    if settling_seconds is None:
        settling_seconds = settling_time(robot, loop, responses)
    ticks = round(settling_seconds * responses.rate_hz)
    resistance = robot.positive("motor.resistance_ohm")
    scale = 2 / resistance / responses.rate_hz
    gv, gw, gs = (g[:ticks] for g in (responses.speed, responses.turn_rate, responses.turn))

    per_speed, per_turn_rate = loop.plant.volts_per_speed, loop.plant.volts_per_turn_rate
    linear = [scale * float(np.sum(g)) for g in (gv, gw, gs)]
    a = (scale * float(gv @ gv), scale * float(gw @ gw), scale * float(gs @ gs), 0.0, 0.0, 2 * scale * float(gw @ gs),
         linear[0], -linear[1], -linear[2], linear[0], linear[1], linear[2], ticks / responses.rate_hz)
    b = (2 * per_speed**2 / resistance, 2 * per_turn_rate**2 / resistance)
    return EnergyModel(tuple(_rounded(x) for x in a), tuple(_rounded(x) for x in b),
                       robot.positive("electronics.power_w"), ticks / responses.rate_hz, per_speed, per_turn_rate,
                       resistance)
