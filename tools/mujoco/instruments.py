"""What the robot's sensors say of a world: range, steps, noise and offsets of the robot file, and a delay that it does
not have."""
import math
from collections import deque

import numpy as np


def sensed(value, noise, step, full_scale, random):
    if noise > 0:
        value += noise * random.standard_normal()
    if full_scale > 0:
        value = min(max(value, -full_scale), full_scale)
    return step * math.floor(value / step + 0.5) if step > 0 else value


def converted(value, low, high, bits):
    if bits == 0:
        return value
    codes = 1 << bits
    step = (high - low) / codes
    return low + step * min(max(math.floor((value - low) / step + 0.5), 0), codes - 1)


def duty(raw, bits):
    """Of a PWM timer with so many bits."""
    return round(raw * (1 << bits)) / (1 << bits) if bits else raw


class Instruments:
    """`delay`: inertial sensors tell of so many ticks ago, as a low-pass filter in them does."""

    def __init__(self, robot, seed, delay):
        self._random = np.random.default_rng(seed)
        self._late = deque(maxlen=delay + 1)
        given, number = robot.given, robot.number
        self._counts = int(number("encoder.counts_per_turn"))
        self._gyro = [given(f"gyro.{key}", 0.0) for key in ("noise_rms_dps", "step_dps", "full_scale_dps")]
        self._gyro_bias, self._gyro_scale = number("gyro.bias_dps"), 1 + given("gyro.scale_error", 0.0)
        self._accelerometer = [given(f"accelerometer.{key}", 0.0) for key in ("noise_rms_g", "step_g", "full_scale_g")]
        self._accelerometer_bias = given("accelerometer.bias_g", 0.0)
        self._accelerometer_scale = 1 + given("accelerometer.scale_error", 0.0)
        self._current = [number(f"current_sense.{key}") for key in ("full_scale_a", "bits", "noise_rms_a")]
        self._voltage = [robot.number("bus_sense.full_scale_v"), int(robot.number("bus_sense.bits"))]

    def read(self, angles, inertial, currents, bus_voltage):
        """The signals of a sample by name. Angles of the motors at the wheel in rad; pitch rate, yaw rate in rad/s and
        specific forces ahead and up in m/s²; A; V."""
        self._late.append(inertial)
        pitch_rate, yaw_rate, ahead, up = self._late[0]
        left, right = (math.floor(angle / math.tau * self._counts) for angle in angles)
        return {"EncoderLeft": left, "EncoderRight": right, "BusVoltage": self._bus(bus_voltage),
                "PitchRate": self._turns(pitch_rate), "YawRate": self._turns(yaw_rate),
                "AccelX": self._force(ahead), "AccelZ": self._force(up),
                "CurrentLeft": self._ampere(currents[0]), "CurrentRight": self._ampere(currents[1])}

    def _turns(self, rate):
        dps = math.degrees(rate) * self._gyro_scale + self._gyro_bias
        return sensed(dps, *self._gyro, self._random) / 360

    def _force(self, acceleration):
        g = acceleration / 9.81 * self._accelerometer_scale + self._accelerometer_bias
        return sensed(g, *self._accelerometer, self._random)

    def _ampere(self, current):
        full_scale, bits, noise = self._current
        return converted(sensed(current, noise, 0.0, 0.0, self._random), -full_scale, full_scale, int(bits))

    def _bus(self, voltage):
        full_scale, bits = self._voltage
        return converted(voltage, 0.0, full_scale, bits)
