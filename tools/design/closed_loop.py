"""The sampled closed loop of each axis of a balancing robot, and the energy of its transients.

With gains that are fixed the axes are linear and apart: travel (common voltage; steps of v) and yaw (difference; steps of
w and of the heading σ). The state e is the difference from steady motion, tick by tick e+ = M e. It holds what
src/balancer/reference.c, src/balancer/lqr.c and src/balancer/estimator.c remember and the plant, seen from the target.
"""
import math
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from tools.design import estimator_gains, linear_model

MOTOR = "motor"      # (ul² + ur²)/Rm, as in the paper
BATTERY = "battery"  # ul il + ur ir

MARGIN_FREQUENCIES, MARGIN_DELAYS = 2000, 9


@dataclass(frozen=True)
class Axis:
    """voltage and current are rows on e, of one motor; `steady` is the state of unit speed less that of standing, so a
    step of the speed by Δ adds −steady Δ, and one of the heading by σ adds turn σ, which is 0 for travel. A volt more at
    the motors for a tick adds push."""
    name: str
    matrix: np.ndarray
    voltage: np.ndarray
    current: np.ndarray
    steady: np.ndarray
    turn: np.ndarray
    push: np.ndarray
    volts_per_unit: float
    amperes_per_unit: float
    rate_hz: float

    @property
    def size(self):
        return len(self.matrix)

    def jump(self, speed, turn):
        """What a step of the speed and of the heading adds to e."""
        return self.turn * turn - self.steady * speed


class _Loop:
    """One tick of the firmware and of the plant in real numbers, for several states at once. State: angle and rate of the
    shaped reference, the plant, angle and rate of the tracked encoder, the error's integral."""

    PLANT = 2  # first of the plant's states: angles, then as many rates

    def __init__(self, robot, states, inputs, gain, shaping):
        rate = robot.positive("control.rate_hz")
        f, g = linear_model.sampled_plant(linear_model.linear_plant(robot), rate)
        self._f, self._g, self._gain, self._rate_hz = f[np.ix_(states, states)], g[states] @ inputs, gain, rate
        self._bandwidth = estimator_gains.reciprocal(robot.number(shaping))
        self._tracking = estimator_gains.tracking_gains(robot.number("control.encoder_bandwidth_rad_s"), rate)
        self._angles = len(states) // 2
        self._tracked = self.PLANT + len(states)
        self._integral = self._tracked + 2
        self.size = self._integral + 1
        self.seen_from_target = [0, self.PLANT, self._tracked]

    def tick(self, state, speed, push=0.0):
        """The next states and the voltages that the controller asks for, to which `push` comes; a column for each speed."""
        state = state.copy()
        state[self.seen_from_target] -= speed / self._rate_hz
        state[0], state[1] = self._shape(state, speed)
        angle_error, others = self._errors(state)
        voltage = self._gain @ np.vstack([angle_error, *others, state[self._integral]])
        state[self._integral] += angle_error / self._rate_hz
        plant = slice(self.PLANT, self._tracked)
        state[plant] = self._f @ state[plant] + np.outer(self._g, voltage + push)
        self._estimate(state, voltage + push)
        return state, voltage

    def _shape(self, state, speed):
        """Angle and rate of the reference."""
        if self._bandwidth == 0:
            return np.zeros_like(speed), speed
        angle, rate = state[0], state[1]
        pull = 2 * (speed - rate) - self._bandwidth * angle
        rate = rate + pull * self._bandwidth / self._rate_hz
        return angle + rate / self._rate_hz, rate

    def _track(self, state, measured):
        """The alpha-beta filter of an encoder."""
        angle_gain, rate_gain = self._tracking
        predicted = state[self._tracked] + state[self._tracked + 1] / self._rate_hz
        error = measured - predicted
        state[self._tracked] = predicted + angle_gain * error
        state[self._tracked + 1] += rate_gain * error


class _Yaw(_Loop):
    """Plant φ, φ̇."""

    def __init__(self, robot, gains):
        super().__init__(robot, [2, 5], [-1, 1], gains.difference, "control.yaw_shaping_s")
        self.turned = self.seen_from_target
        self.motor_rate = np.zeros(self.size)
        self.motor_rate[self.PLANT + 1] = robot.positive("body.width_m") / 2 / robot.positive("wheel.radius_m")

    def _errors(self, state):
        return state[0] - state[self._tracked], [state[1] - state[self._tracked + 1]]

    def _estimate(self, state, _):
        self._track(state, state[self.PLANT])


class _Travel(_Loop):
    """Plant θ, ψ, θ̇, ψ̇; the encoders see θ − ψ. Two more states: pitch and bias of the gyro as estimated."""

    def __init__(self, robot, gains):
        super().__init__(robot, [0, 1, 3, 4], [1, 1], gains.common, "control.travel_shaping_s")
        plant = linear_model.linear_plant(robot)
        self._accelerations = plant.a[3:5][:, [0, 1, 3, 4]], plant.b[3:5].sum(axis=1)
        # What the accelerometer feels of them, in g.
        self._felt = np.array([robot.positive("wheel.radius_m"),
                               robot.number("accelerometer.height_m")]) / linear_model.GRAVITY
        self._tilt_gain, self._bias_gain = estimator_gains.levelling_gains(robot)
        self._pitch = self.size
        self.size += 2
        self.encoder_rate, self.body_pitch = self._tracked + 1, self.PLANT + 1
        self.turned = []
        self.motor_rate = np.zeros(self.size)
        self.motor_rate[[self.PLANT + 2, self.PLANT + 3]] = 1, -1

    def _errors(self, state):
        pitch, bias = state[self._pitch:]
        pitch_rate = state[self.PLANT + 3] - bias
        wheel_rate = state[self._tracked + 1] + pitch_rate
        return state[0] - (state[self._tracked] + pitch), [-pitch, state[1] - wheel_rate, -pitch_rate]

    def _estimate(self, state, voltage):
        plant = state[self.PLANT:self._tracked]
        self._track(state, plant[0] - plant[1])
        if self._tilt_gain == 0:
            state[self._pitch:] = plant[1], np.zeros_like(voltage)
            return
        from_state, from_voltage = self._accelerations
        felt = self._felt @ (from_state @ plant + np.outer(from_voltage, voltage))
        pitch, bias = state[self._pitch:]
        pitch = pitch + (plant[3] - bias) / self._rate_hz
        tilt_error = plant[1] - felt - pitch
        # Without learning the bias stays what it is: 0.
        state[self._pitch:] = pitch + self._tilt_gain * tilt_error, (bias - self._bias_gain * tilt_error
                                                                      if self._bias_gain else np.zeros_like(voltage))


def _axis(name, loop, robot, unit):
    """unit: rad per m or per rad."""
    n, resistance = loop.size, robot.positive("motor.resistance_ohm")
    back_emf = robot.positive("motor.gear_ratio") * robot.positive("motor.back_emf_v_s_per_rad")
    columns, voltages = loop.tick(np.hstack([np.eye(n), np.zeros((n, 1))]), np.append(np.zeros(n), 1))
    matrix, drive = columns[:, :n], columns[:, n]
    voltage, direct = voltages[:n], voltages[n]
    if np.abs(np.linalg.eigvals(matrix)).max() >= 1 - 1e-9:
        raise robot.error("control", f"{name}: the closed loop with the estimator does not settle")
    steady = np.linalg.solve(np.eye(n) - matrix, drive)
    push = loop.tick(np.zeros((n, 1)), np.zeros(1), 1.0)[0][:, 0]
    # The meter has the current at the end of the tick.
    current = (voltage - back_emf * loop.motor_rate @ matrix) / resistance
    volts = voltage @ steady + direct
    turn = np.zeros(n)
    turn[loop.turned] = -1
    return Axis(name, matrix, voltage, current, steady * unit, turn, push, volts * unit,
                (volts - back_emf * loop.motor_rate @ steady) / resistance * unit, robot.positive("control.rate_hz"))


def axes(robot, gains=None):
    """Travel and yaw of a robot under these gains, else its own."""
    gains = gains or linear_model.design(robot).gains
    return (_axis("travel", _Travel(robot, gains), robot, 1 / robot.positive("wheel.radius_m")),
            _axis("yaw", _Yaw(robot, gains), robot, 1))


def modulus_margin(axis, delay_s=0.0):
    """How near the loop comes to −1, cut at the motors, when every sensor is late by up to this delay: 1 is an ideal
    regulator, 0 swings for ever."""
    frequencies = np.geomspace(1e-2, math.pi * axis.rate_hz, MARGIN_FREQUENCIES)
    shift = np.exp(1j * frequencies / axis.rate_hz)
    values, vectors = np.linalg.eig(axis.matrix)
    weights = (axis.voltage @ vectors) * np.linalg.solve(vectors, axis.push.astype(complex))
    # The voltage with the push that caused it, by the push: 1/(1 + L).
    sensitivity = 1 + (weights / (shift[:, None] - values)).sum(axis=1)
    # A delay at which it swings shows before a longer one that may look better.
    return min(float(np.abs(1 + (1 / sensitivity - 1) * np.exp(-1j * frequencies * delay)).min())
               for delay in np.linspace(0, delay_s, MARGIN_DELAYS))


def travel_step(robot, gains, seconds, stride):
    """After a step of the speed to 1 m/s, every `stride` ticks: the wheel rate that the encoders show, as a share of that
    of 1 m/s, and the pitch in rad."""
    loop, radius = _Travel(robot, gains), robot.positive("wheel.radius_m")
    axis = _axis("travel", loop, robot, 1 / radius)
    state, ticks = -axis.steady, np.linalg.matrix_power(axis.matrix, stride)
    shown = []
    for _ in range(round(seconds * axis.rate_hz) // stride):
        state = ticks @ state
        shown.append([state[loop.encoder_rate], state[loop.body_pitch]])
    steady = axis.steady[[loop.encoder_rate, loop.body_pitch]]
    return ((np.array(shown) + steady) * [radius, 1]).T


@dataclass(frozen=True)
class Energy:
    """Of one axis, J of both motors: a transient e while the steady speed is v stores eᵀ form e + v linear·e, which it
    spends until it is gone; steady motion spends power v²."""
    form: np.ndarray
    linear: np.ndarray
    power: float  # W per unit of v²

    def stored(self, state, speed):
        return state @ self.form @ state + speed * (self.linear @ state)


def energy(axis, definition, resistance):
    """What transients of an axis cost, by either definition of energy."""
    current, amperes = ((axis.current, axis.amperes_per_unit) if definition == BATTERY
                        else (axis.voltage / resistance, axis.volts_per_unit / resistance))
    product = np.outer(axis.voltage, current)
    form = linalg.solve_discrete_lyapunov(axis.matrix.T, (product + product.T) / axis.rate_hz)
    cross = axis.voltage * amperes + current * axis.volts_per_unit
    linear = np.linalg.solve((np.eye(axis.size) - axis.matrix).T, cross) * 2 / axis.rate_hz
    return Energy(form, linear, 2 * axis.volts_per_unit * amperes)
