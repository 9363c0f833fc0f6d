"""The motion of a log, smoothed alike in all its channels, with its derivatives.

The equations of motion are linear in what is sought, so that a linear filter over all their terms leaves them true:
a Gaussian, whose derivatives differentiate. What noise and steps of the sensors leave is far below the motion.
"""
from dataclasses import dataclass

import numpy as np
from scipy import signal

from tools.common import ToolError
from tools.design import linear_model, specification
from tools.identify.samples import Series

WIDTH_SHARE = 0.3        # of the filter's deviation, in falling times 1/p
QUICK_SHARE = WIDTH_SHARE / 4  # where energy is summed: it goes with the square of what a filter takes off
REACH = 4.0              # deviations that the filter looks at
TELEMETRY_PERIOD = 0.005  # s, of the grid where messages come by the 20 ms
LAGS = 25                # of what the controller follows, whose effect lasts for LAG_WIDTHS deviations each
LAG_WIDTHS = 2
GAP_PERIODS = 5.5        # without samples: what is near is left out
POINTS_MIN = 100


SCALARS = ("half_tick", "width")  # of Motion


@dataclass(frozen=True)
class Motion:
    """At times that are one deviation of the filter apart. Rates in rad/s; wheels against the body: mean of both, and
    half of right less left. None: not logged."""
    times: np.ndarray
    wheel_rate: np.ndarray           # of the wheels in the world
    wheel_acceleration: np.ndarray
    motor_rate: np.ndarray           # of the wheels against the body
    difference_rate: np.ndarray
    difference_acceleration: np.ndarray
    pitch: np.ndarray                # but for an offset that changes slowly
    pitch_rate: np.ndarray
    pitch_acceleration: np.ndarray
    logged_pitch: np.ndarray | None
    yaw_rate: np.ndarray | None      # of the gyro
    voltages: np.ndarray             # left and right, V, at the times of the currents
    currents: np.ndarray | None      # A
    torque_currents: np.ndarray      # A at the times of the motion; where there are none, voltages
    roughness: np.ndarray            # A: how far sum and difference of them stray from straight lines between samples
    references: np.ndarray | None    # what the controller followed, at each of the lags: speeds, then turn rates
    half_tick: float                 # s from the middle of what a current is of to its sample; 0: not known
    width: float                     # s, deviation of the filter

    @property
    def has_currents(self):
        return self.currents is not None

    def chosen(self, which):
        return Motion(**{name: value if value is None or name in SCALARS else value[..., which]
                         for name, value in vars(self).items()})


class Filter:
    """Channels on a grid, then smoothed at every stride-th of its points."""

    def __init__(self, begin, end, period, width):
        self.period, self.width = period, width
        self.grid = np.arange(begin, end, period)
        self.stride = max(1, round(width / period))
        reach = int(np.ceil(REACH * width / period))
        offset = np.arange(-reach, reach + 1) * period
        bell = np.exp(-0.5 * (offset / width)**2)
        self._kernel = bell / bell.sum()
        slope = -offset * bell
        self._slope = slope / -(slope @ offset)  # of a ramp it makes 1
        self.times = self.grid[reach:-reach:self.stride]
        self._reach = reach

    def on_grid(self, series, shift=0.0):
        """shift: s by which the channel is late."""
        return np.interp(self.grid, series.times - shift, series.values)

    def _convolved(self, values, kernel):
        return signal.fftconvolve(values, kernel, mode="valid")[::self.stride]

    def value(self, values):
        return self._convolved(values, self._kernel)

    def rate(self, values):
        return self._convolved(values, self._slope)


def filter_width(robot, share):
    """s: narrow against the time in which the robot falls, by its file."""
    return share / specification.falling_rate(linear_model.linear_plant(robot))


def estimator_delay(robot):
    """s by which the robot's tracking loop tells the speed of its wheels late."""
    bandwidth = robot.number("control.encoder_bandwidth_rad_s")
    return 2 / bandwidth if bandwidth > 0 else 0.0


def are_sound(log, times, reach):
    """At which times the motors were on and every needed channel was logged, all around."""
    sound = np.zeros(len(times), bool)
    for begin, end in log.active or [log.span]:
        sound |= (times - reach > begin) & (times + reach < end)
    for name in log.needed:
        series = log[name]
        gaps = np.flatnonzero(np.diff(series.times) > GAP_PERIODS * series.period)
        for begin, end in zip(series.times[gaps], series.times[gaps + 1]):
            sound &= (times + reach < begin) | (times - reach > end)
    return sound


def wheel_rates(log, smoothed, robot):
    """Values on the grid, and how to make rates of them: mean and half difference of the wheels against the body."""
    if log.counts_wheels:
        left, right = (smoothed.on_grid(log[f"wheel_{side}"]) for side in ("left", "right"))
        mean, difference = (left + right) / 2, (right - left) / 2
        acceleration = [np.gradient(values, smoothed.period) for values in (mean, difference)]
        return [(smoothed.rate(values), smoothed.rate(rate)) for values, rate in zip((mean, difference), acceleration)]
    radius, width = robot.positive("wheel.radius_m"), robot.positive("body.width_m")
    delay = estimator_delay(robot)
    speed, turn = log["speed"], log["turn_rate"]
    against_body = speed.values / radius - np.interp(speed.times, log["pitch_rate"].times, log["pitch_rate"].values)
    rates = (Series(speed.times, against_body), Series(turn.times, turn.values * width / (2 * radius)))
    on_grid = [smoothed.on_grid(series, delay) for series in rates]
    return [(smoothed.value(values), smoothed.rate(values)) for values in on_grid]


def integral(rate, period):
    return np.concatenate([[0], np.cumsum((rate[1:] + rate[:-1]) / 2)]) * period


def gyro_rate(log, smoothed, robot):
    """On the grid. A robot that tells what it estimates has taken off the gyro's bias as it knew it, and each change of
    the speed, which its accelerometer takes for a tilt, changes that."""
    rate = smoothed.on_grid(log["pitch_rate"])
    learns = robot.number("control.tilt_time_constant_s") > 0 and robot.number("control.bias_time_constant_s") > 0
    if not (log.is_estimated and learns and log.has("pitch")):
        return rate
    corrected = smoothed.on_grid(log["pitch"]) - integral(rate, smoothed.period)
    return rate - (corrected - corrected[0]) / robot.number("control.bias_time_constant_s")


def pitch_of(log, smoothed, rate):
    """By its rate, level on the whole, and as the robot estimated it."""
    pitch = integral(rate, smoothed.period)
    logged = smoothed.on_grid(log["pitch"]) if log.has("pitch") else np.zeros_like(pitch)
    pitch = pitch - np.polyval(np.polyfit(smoothed.grid, pitch - logged, 1), smoothed.grid)
    return pitch, logged if log.has("pitch") else None


def roughness(log, smoothed, name):
    """What lies between messages is the less known, the more these jump; the samples themselves leave nothing out."""
    if log.counts_wheels:
        return np.zeros((2, len(smoothed.times)))
    left, right = log[f"{name}_left"], log[f"{name}_right"]
    sides = left.values, np.interp(left.times, right.times, right.values)
    bends = [np.diff(values, 2)**2 for values in (sides[0] + sides[1], sides[1] - sides[0])]
    return np.array([np.sqrt(np.maximum(smoothed.value(np.interp(smoothed.grid, left.times[1:-1], bend)), 0))
                     for bend in bends])


def references(log, smoothed, share):
    if share != WIDTH_SHARE or not log.has("reference_speed", "reference_turn_rate"):
        return None
    lags = -LAG_WIDTHS * smoothed.width * np.arange(LAGS)
    return np.array([smoothed.value(smoothed.on_grid(log[name], lag))
                     for name in ("reference_speed", "reference_turn_rate") for lag in lags])


def motion(log, robot, share=WIDTH_SHARE):
    """ToolError: too little of it."""
    period = min(log[name].period for name in log.needed) if log.counts_wheels else TELEMETRY_PERIOD
    smoothed = Filter(*log.span, period, filter_width(robot, share))
    if not len(smoothed.times):
        raise ToolError(f"{log.source}: {len(smoothed.grid) * period:.1f} s of motion; drive for longer")
    (motor_rate, motor_acceleration), (difference_rate, difference_acceleration) = wheel_rates(log, smoothed, robot)
    pitch_rate = gyro_rate(log, smoothed, robot)
    pitch, logged_pitch = pitch_of(log, smoothed, pitch_rate)
    pitch_acceleration = smoothed.rate(pitch_rate)

    def both(name, shift=0.0):
        return np.array([smoothed.value(smoothed.on_grid(log[f"{name}_{side}"], shift)) for side in ("left", "right")])

    has_currents = log.has("current_left", "current_right")
    # A sample's current is that of the tick before it, on the mean half a period older.
    half = 0.5 / robot.positive("control.rate_hz") if log.counts_wheels else 0.0
    found = Motion(
        times=smoothed.times, wheel_rate=motor_rate + smoothed.value(pitch_rate),
        wheel_acceleration=motor_acceleration + pitch_acceleration, motor_rate=motor_rate,
        difference_rate=difference_rate, difference_acceleration=difference_acceleration,
        pitch=smoothed.value(pitch), pitch_rate=smoothed.value(pitch_rate), pitch_acceleration=pitch_acceleration,
        logged_pitch=None if logged_pitch is None else smoothed.value(logged_pitch),
        yaw_rate=smoothed.value(smoothed.on_grid(log["yaw_rate"])) if log.has("yaw_rate") else None,
        voltages=both("voltage"), currents=both("current") if has_currents else None,
        torque_currents=both("current" if has_currents else "voltage", half),
        roughness=roughness(log, smoothed, "current" if has_currents else "voltage"),
        references=references(log, smoothed, share), half_tick=half, width=smoothed.width)
    found = found.chosen(are_sound(log, smoothed.times, REACH * smoothed.width))
    if len(found.times) < POINTS_MIN:
        raise ToolError(f"{log.source}: {len(found.times) * smoothed.width:.1f} s with the motors on and all channels "
                        f"there; {POINTS_MIN * smoothed.width:.1f} s or more are needed")
    return found


PAUSE = 1000.0  # s put between two logs


def joined(motions):
    """Of several logs, one after the other; what not all of them have is left out."""
    parts, begin = [], 0.0
    for one in motions:
        parts.append(vars(one) | {"times": one.times - one.times[0] + begin})
        begin = parts[-1]["times"][-1] + PAUSE

    def whole(name):
        values = [part[name] for part in parts]
        return None if any(value is None for value in values) else np.concatenate(values, axis=-1)
    return Motion(**{name: getattr(motions[0], name) if name in SCALARS else whole(name) for name in vars(motions[0])})


def runs(times, pause):
    """Slices of times without a pause."""
    edges = [0, *(np.flatnonzero(np.diff(times) > pause) + 1), len(times)]
    return [slice(begin, end) for begin, end in zip(edges, edges[1:])]
