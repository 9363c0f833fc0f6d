"""What a robot's log says, whatever its format: channels of numbers over time, and the segments that were driven.

A channel has its own times, as messages come at their own rates. Units are those of UNITS; angles and turn rates are
positive to the left, pitch forward, voltages and currents as they drive forward.
"""
from dataclasses import dataclass, field

import numpy as np

from tools.common import ToolError

UNITS = {
    "wheel_left": "rad",       # of the wheel against the body, as its encoder counts
    "wheel_right": "rad",
    "speed": "m/s",            # by the robot's odometry, with the radius of its file
    "turn_rate": "rad/s",      # by its odometry, with radius and width of its file
    "pitch": "rad",            # as the robot estimates it
    "pitch_rate": "rad/s",
    "yaw_rate": "rad/s",       # of a gyro
    "voltage_left": "V",       # of the motor
    "voltage_right": "V",
    "current_left": "A",
    "current_right": "A",
    "bus_voltage": "V",
    "motors_current": "A",     # that both bridges take of the bus
    "battery_voltage": "V",
    "battery_current": "A",    # that leaves the battery, electronics included
    "reference_speed": "m/s",  # that the controller follows
    "reference_turn_rate": "rad/s",
    "spent": "J",              # counters of the robot's meters, with the electronics' power of its file
    "drawn": "J",
}

SECONDS_MIN = 5.0  # of a log


@dataclass(frozen=True)
class Series:
    times: np.ndarray   # s, ascending
    values: np.ndarray

    @property
    def period(self):
        return float(np.median(np.diff(self.times)))

    def values_at(self, times):
        return np.interp(times, self.times, self.values)


@dataclass(frozen=True)
class Segment:
    """J; None was not logged."""
    begin: float  # s
    end: float
    planned: float | None
    spent: float | None
    drawn: float | None


@dataclass
class Log:
    source: str
    channels: dict = field(default_factory=dict)  # Series by name of UNITS
    segments: list = field(default_factory=list)
    active: list = field(default_factory=list)    # (begin, end) s in which the motors were on; none: all of it
    is_estimated: bool = False                    # pitch and rates are those of the robot's estimator
    left_out: int = 0                             # frames or messages that were damaged

    def add(self, name, times, values):
        """A channel whose times ascend; of two samples at one time the first counts."""
        times, values = np.asarray(times, float), np.asarray(values, float)
        good = np.isfinite(times) & np.isfinite(values)
        times, values = times[good], values[good]
        later = np.concatenate([[True], np.diff(np.maximum.accumulate(times)) > 0]) if len(times) else []
        if len(times) >= 2 and np.count_nonzero(later) >= 2:
            self.channels[name] = Series(times[later], values[later])

    def has(self, *names):
        return all(name in self.channels for name in names)

    def __getitem__(self, name):
        return self.channels[name]

    @property
    def counts_wheels(self):
        """The encoders themselves are logged, not only what the robot makes of them."""
        return self.has("wheel_left", "wheel_right")

    def check(self):
        """ToolError: what is missing for any fit."""
        if not self.counts_wheels and not self.has("speed", "turn_rate"):
            raise ToolError(f"{self.source}: neither wheel angles nor speed and turn rate; log one of them")
        for name in ("pitch_rate", "voltage_left", "voltage_right"):
            if not self.has(name):
                raise ToolError(f"{self.source}: {name} is missing; without it no equation of motion can be fitted")
        begin, end = self.span
        if end - begin < SECONDS_MIN:
            raise ToolError(f"{self.source}: {max(end - begin, 0):.1f} s of motion; {SECONDS_MIN:g} s or more are "
                            "needed")

    @property
    def needed(self):
        wheels = ("wheel_left", "wheel_right") if self.counts_wheels else ("speed", "turn_rate")
        return (*wheels, "pitch_rate", "voltage_left", "voltage_right")

    @property
    def span(self):
        """s, in which all that is needed was logged."""
        series = [self[name] for name in self.needed]
        return max(one.times[0] for one in series), min(one.times[-1] for one in series)


def spans_where(times, is_on):
    """(begin, end) of each run of samples that are on."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(is_on, int), [0]])))
    return [(float(times[begin]), float(times[end - 1])) for begin, end in edges.reshape(-1, 2)]
