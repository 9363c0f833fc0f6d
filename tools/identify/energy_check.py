"""What the battery gave for each segment, and what the constants of a file say of the same motion."""
from dataclasses import dataclass

import numpy as np

from tools.identify import robot_fit
from tools.identify.motion_fit import MECHANICAL, mechanical_rows

COVERED_MIN = 0.9  # of a segment's time, by the motion that can be used
MARGIN = 1.5       # deviations of the filter between two points that follow each other


@dataclass(frozen=True)
class SegmentEnergy:
    """J that left the battery, electronics included."""
    begin: float
    seconds: float
    planned: float | None  # by the robot: of what its motors and electronics spend
    spent: float | None    # the same by its meter
    logged: float
    by_file: float
    by_fit: float


def motor_power(motion, robot):
    """W of both motors, which the constants need for this motion."""
    numbers = {key: robot.number(key) for key in robot_fit.MOTION_KEYS}
    gear = robot.positive("motor.gear_ratio")
    found = robot_fit.coefficients(numbers, gear, True)
    matrices, _ = mechanical_rows(motion, numbers["body.width_m"] / (2 * numbers["wheel.radius_m"]),
                                  motion.torque_currents)
    first, third = matrices[0] @ found[:len(MECHANICAL)], matrices[2] @ found[:len(MECHANICAL)]
    power = np.zeros(len(motion.times))
    for sign in (-1, 1):
        current = (first + sign * third) / 2
        rate = motion.motor_rate + sign * motion.difference_rate
        power += current * (numbers["motor.resistance_ohm"] * current
                            + gear * numbers["motor.back_emf_v_s_per_rad"] * rate)
    return power


def integral(times, values, begin, end, width):
    """Over the segment, and the share of it that the points cover."""
    inside = (times >= begin) & (times <= end)
    steps = np.diff(times[inside])
    joined = steps < MARGIN * width
    if not joined.any():
        return 0.0, 0.0
    means = (values[inside][1:] + values[inside][:-1]) / 2
    covered = float(steps[joined].sum())
    return float((means * steps)[joined].sum()) * (end - begin) / covered, covered / (end - begin)


def drawn_by_motors(log, segment, electronics):
    """J: by the samples, else by the robot's meter, which counts its file's electronics; None: neither was logged."""
    if log.has("current_left", "current_right") and (log.counts_wheels or segment.drawn is None):
        times = log["voltage_left"].times
        inside = (times >= segment.begin) & (times <= segment.end)
        power = sum(log[f"voltage_{side}"].values_at(times) * log[f"current_{side}"].values_at(times)
                    for side in ("left", "right"))
        return float(np.trapz(power[inside], times[inside]))
    return None if segment.drawn is None else segment.drawn - electronics * (segment.end - segment.begin)


def compare(log, motion, file, fit):
    """SegmentEnergy of each segment that the motion covers."""
    powers = {name: motor_power(motion, robot) for name, robot in (("file", file), ("fit", fit))}
    watts = {name: robot.positive("electronics.power_w") for name, robot in (("file", file), ("fit", fit))}
    found = []
    for segment in log.segments:
        seconds = segment.end - segment.begin
        motors = drawn_by_motors(log, segment, watts["file"])
        energies = {}
        for name, power in powers.items():
            joules, covered = integral(motion.times, power, segment.begin, segment.end, motion.width)
            energies[name] = joules + watts[name] * seconds
        if motors is not None and covered >= COVERED_MIN:
            found.append(SegmentEnergy(segment.begin, seconds, segment.planned, segment.spent,
                                       motors + watts["fit"] * seconds, energies["file"], energies["fit"]))
    return found


def errors(segments):
    """% of the sum, by file and by fit; and the mean of the segments' own."""
    logged = np.array([segment.logged for segment in segments])
    found = {}
    for name in ("by_file", "by_fit"):
        told = np.array([getattr(segment, name) for segment in segments])
        found[name] = {"total_percent": float(100 * (told.sum() / logged.sum() - 1)),
                       "mean_percent": float(100 * np.mean(np.abs(told - logged)) / logged.mean())}
    return found
