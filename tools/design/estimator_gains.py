"""Gains of src/balancer/estimator.c: of the encoders' tracker and of the tilt toward the accelerometer's vertical."""
import math


def tracking_gains(bandwidth, rate):
    """Angle and rate gain of the alpha-beta filter with both poles at exp(−bandwidth/rate); 0: plain difference."""
    if bandwidth == 0:
        return 1.0, rate
    pole = math.exp(-bandwidth / rate)
    return 1 - pole**2, (1 - pole)**2 * rate


def reciprocal(value):
    """1/value; 0, which means off, stays 0."""
    return 1 / value if value > 0 else 0.0


def levelling_gains(robot):
    """Of the tilt toward the accelerometer's vertical, and of the gyro's bias in rad/s from rad; 0: off."""
    tilt_gain = reciprocal(robot.number("control.tilt_time_constant_s")) / robot.positive("control.rate_hz")
    return tilt_gain, tilt_gain * reciprocal(robot.number("control.bias_time_constant_s"))
