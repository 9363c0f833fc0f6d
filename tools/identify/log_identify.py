#!/usr/bin/env python3
"""Identify a balancer's constants from logs of a drive: of the real robot, or of a simulated one.

Takes logs of the CAN bus (candump -l, -ta, .asc, .blf), of lcm-logger, or CSV; several are fitted together. Compares
what they say with the robot's file, constant by constant, and the energy of each segment as it was foretold, as it was
counted, and as file and fit have it. Writes DIR/identification.json and identification.png; --write the corrected robot
file. Exit status 2: bad input; nothing was written.
"""
import json
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np

from tools.common import (ArgumentParser, ToolError, build_directory, print_aligned, read_text, real_number, run,
                          shown_path, write_whole)
from tools.design import linear_model, robot_json
from tools.identify import (energy_check, log_can, log_csv, log_report, motion_fit, robot_fit, robot_text, signals,
                            supply_fit)

DISTANCE_MIN = 0.5  # m
STRAIGHT = 0.1      # rad, by which the robot may turn on a measured distance


# ---- logs ----------------------------------------------------------------------------------------------------------

def read_log(path, robot):
    """By what it begins with."""
    try:
        with path.open("rb") as file:
            begin = file.read(4096)
    except OSError as error:
        raise ToolError(f"{path}: {error.strerror}") from None
    if not begin:
        raise ToolError(f"{path}: is empty")
    if begin.startswith(bytes.fromhex("eda1da01")):
        from tools.identify import log_lcm  # not everybody has LCM
        return log_lcm.read(path, robot)
    if path.suffix == ".csv" or begin.lstrip(b"\xef\xbb\xbf").split(b"\n")[0].count(b",") > 1:
        return log_csv.read(path, robot)
    return log_can.read(path, robot)


def rolled(log, robot):
    """rad that the wheels turned forward, on the mean, and rad that the robot turned."""
    ratio = robot.positive("body.width_m") / (2 * robot.positive("wheel.radius_m"))
    if log.counts_wheels:
        left, right = (float(log[f"wheel_{side}"].values[-1] - log[f"wheel_{side}"].values[0])
                       for side in ("left", "right"))
        return (left + right) / 2, (right - left) / 2 / ratio
    speed, turn = log["speed"], log["turn_rate"]
    return (float(np.trapz(speed.values, speed.times)) / robot.positive("wheel.radius_m"),
            float(np.trapz(turn.values, turn.times)))


def radius_by(path, text, robot):
    """m, of the wheels, by a log of a straight way that was measured."""
    try:
        distance = float(text)
    except ValueError:
        distance = 0.0
    if not distance >= DISTANCE_MIN:
        raise ToolError(f"--distance {text}: must be a number of m, {DISTANCE_MIN:g} or more")
    log = read_log(Path(path), robot)
    log.check()
    angle, turned = rolled(log, robot)
    if abs(turned) > STRAIGHT:
        raise ToolError(f"{path}: the robot turned by {np.degrees(turned):.0f}°; drive it straight on to measure a "
                        "distance")
    if angle <= 0:
        raise ToolError(f"{path}: the wheels did not turn forward; drive it straight on to measure a distance")
    return distance / angle


# ---- results -------------------------------------------------------------------------------------------------------

def energy_parameters(robot, found):
    """(name, unit, by file, by fit, deviation) of the steady part of the energy model, tools/design/identify.py."""
    def parameter(index):
        def of(one):
            resistance = one.positive("motor.resistance_ohm")
            return 2 * linear_model.steady_voltages(one)[index]**2 / resistance
        return of
    rows = []
    for index, (name, unit) in enumerate((("b1", "J s/m2"), ("b2", "J s/rad2"))):
        of = parameter(index)
        rows.append((name, unit, of(robot), of(found.robot), robot_fit.deviation_of(found, of)))
    return rows


def significant(value, deviation):
    """With one digit more than it is certain."""
    if deviation <= 0 or value == 0:
        return f"{value:.5g}"
    digits = int(np.clip(np.ceil(np.log10(abs(value) / deviation)) + 1, 2, 6))
    return f"{value:.{digits}g}"


def constant_rows(constants):
    rows = [("constant", "unit", "file", "fitted", "deviation", "change", "")]
    for one in constants:
        if one.is_told:
            rows.append((one.key, one.unit, f"{one.file:.5g}", significant(one.value, one.deviation),
                         f"{one.deviation:.2g}", f"{one.change:+.2f}", "%"))
        else:
            rows.append((one.key, one.unit, f"{one.file:.5g}", "-", "-", "-", "not identifiable from these logs"))
    return rows


def energy_rows(segments):
    def shown(value):
        return "-" if value is None else f"{value:.2f}"
    rows = [("segment", "time", "", "planned", "spent", "drawn", "by file", "by fit", "", "file off", "fit off", "")]
    for index, one in enumerate(segments, start=1):
        rows.append((str(index), f"{one.seconds:.2f}", "s", shown(one.planned), shown(one.spent), shown(one.logged),
                     shown(one.by_file), shown(one.by_fit), "J", f"{100 * (one.by_file / one.logged - 1):+.2f}",
                     f"{100 * (one.by_fit / one.logged - 1):+.2f}", "%"))
    return rows


def advice(constants, references):
    """What else would tell more."""
    told = {one.key: one.is_told for one in constants}
    lines = []
    if references.mass is None:
        lines.append("masses, torque and friction are known by their ratios alone: weigh the robot, --mass KG")
    if references.radius is None:
        lines.append("the wheels' radius follows from gravity: surer by --distance LOG M, a straight way that was "
                     "measured")
    if not told["motor.resistance_ohm"]:
        lines.append("no currents in the log: the motors' resistance and friction stay those of the file")
    if not told["body.width_m"]:
        lines.append("no gyro of yaw in the log: the width between the wheels stays that of the file")
    if not told["electronics.power_w"]:
        lines.append("no voltage and current of the battery in the log: the electronics' power stays that of the file")
    return lines


def print_results(constants, parameters, segments, tilt, references):
    print_aligned(constant_rows(constants))
    print()
    print_aligned([("energy model", "unit", "file", "fitted", "deviation"),
                   *((name, unit, f"{file:.5g}", significant(value, deviation), f"{deviation:.2g}")
                     for name, unit, file, value, deviation in parameters)])
    if tilt is not None:
        print(f"\npitch where the robot is in balance {np.degrees(tilt[0]):+.2f} ± {np.degrees(tilt[1]):.2f} °")
    if segments:
        print()
        print_aligned(energy_rows(segments))
        error = energy_check.errors(segments)
        print(f"energy of {len(segments)} segments, by their motion: file {error['by_file']['total_percent']:+.2f} %, "
              f"fit {error['by_fit']['total_percent']:+.2f} % of what was drawn")
    for line in advice(constants, references):
        print(f"note: {line}")


def as_json(robot, logs, found, parameters, segments, fitted, references):
    return {
        "robot": robot.name, "logs": [log.source for log in logs], "damaged_frames": sum(log.left_out for log in logs),
        "mass_kg": references.mass, "wheel_radius_by_distance_m": references.radius,
        "constants": [{"key": one.key, "unit": one.unit, "file": one.file, "fitted": one.value if one.is_told else None,
                       "deviation": one.deviation if one.is_told else None, "identifiable": one.is_told}
                      for one in found.constants],
        "energy_model": [{"name": name, "unit": unit, "file": file, "fitted": value, "deviation": deviation}
                         for name, unit, file, value, deviation in parameters],
        "pitch_in_balance_rad": fitted.tilt_offset,
        "current_left_over": fitted.residual_share,
        "segments": [asdict(segment) for segment in segments],
        "energy_errors": energy_check.errors(segments) if segments else None,
    }


def corrected_text(robot_file, found):
    """The robot file with each constant that changed. What the logs do not tell goes along with what they do."""
    values = {one.key: one.value for one in found.constants if one.value != one.file}
    return robot_text.rewritten(robot_file, read_text(robot_file), values)


# ---- the whole -----------------------------------------------------------------------------------------------------

def identify(robot, logs, references):
    """RobotFit, MotionFit and the segments' energies."""
    for log in logs:
        log.check()
    if len({(log.counts_wheels, log.has("current_left", "current_right")) for log in logs}) > 1:
        raise ToolError(f"{logs[0].source} and others: logs of different channels cannot be fitted together; hand over "
                        "those of one kind at a time")
    motions = [signals.motion(log, robot) for log in logs]
    fitted = motion_fit.fit(", ".join(log.source for log in logs), signals.joined(motions), robot)
    supply = supply_fit.joined([supply_fit.fit(log, robot) for log in logs])
    found = robot_fit.fit(robot, fitted, supply, references, logs[0].counts_wheels)
    segments = [segment for log, motion in zip(logs, motions)
                for segment in energy_check.compare(log, signals.motion(log, robot, signals.QUICK_SHARE)
                                                    if log.counts_wheels else motion, robot, found.robot)]
    return found, fitted, segments


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots: that of the robot's tables")
    parser.add_argument("logs", metavar="LOG", type=Path, nargs="+", help="of candump or lcm-logger, or CSV")
    parser.add_argument("--mass", metavar="KG", type=real_number(0.01, 1000), help="of the whole robot, weighed")
    parser.add_argument("--distance", metavar=("LOG", "M"), nargs=2,
                        help="a log of a straight way, and how long it was by a tape")
    parser.add_argument("--output", metavar="DIR", type=Path,
                        help="where the report goes (default: build/identify-log/ROBOT)")
    parser.add_argument("--write", metavar="FILE", type=Path, help="write the corrected robot file there")
    return parser.parse_args()


def main():
    options = arguments()
    robot_file = robot_json.robot_path(options.robot)
    robot = robot_json.load(robot_file)
    references = robot_fit.References(options.mass, radius_by(*options.distance, robot) if options.distance else None)
    logs = [read_log(path, robot) for path in options.logs]
    for log in logs:
        if log.left_out:
            print(f"{log.source}: {log.left_out} damaged frames or messages are left out", file=sys.stderr)
    found, fitted, segments = identify(robot, logs, references)
    parameters = energy_parameters(robot, found)
    corrected = corrected_text(robot_file, found) if options.write else None
    print_results(found.constants, parameters, segments, fitted.tilt_offset, references)
    output = options.output or build_directory() / "identify-log" / robot.name
    written = {output / "identification.json": json.dumps(as_json(robot, logs, found, parameters, segments, fitted,
                                                                  references), indent=2, ensure_ascii=False) + "\n",
               output / "identification.png": log_report.picture(robot.name, found.constants, segments)}
    if corrected is not None:
        written[options.write] = corrected
    for path, content in written.items():
        write_whole(path, content)
        print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
