#!/usr/bin/env python3
"""Limits and steering of a path of a robot that its sides steer, from its file.

Writes src/tables/path_limits_<robot>.c and path_drive_<robot>.c. Exit status 2: bad input; nothing was written.
"""
from pathlib import Path

from tools.common import ROOT, ArgumentParser, ToolError, run, shown_path, write_whole
from tools.design import c_tables, robot_json, skid_loads

# The robot returns to its path over what it drives in this time, and within it along the path, s.
RETURN_TIME = 0.7
PACE_TIME = 0.4

# Corrections of the speed, of the greatest; of the turn rate all of it.
SPEED_CORRECTION = 0.25


def limits(robot):
    """Members of struct jp_path_limits."""
    to = c_tables.Converter(f"path limits of {robot.name}")
    acceleration = skid_loads.acceleration_limit(robot, skid_loads.loads(robot, skid_loads.steering_ratio(robot)))
    width = robot.number("body.width_m")
    return [
        to.q24("speed", robot.number("lattice.speed_m_s"), "m/s", 0.01, 8),
        to.q24("turn_rate", robot.number("lattice.turn_rate_rad_s"), "rad/s", 0.01, 8),
        to.q24("side_speed", robot.number("limits.speed_m_s"), "m/s", 0.01, 16),
        to.q24("width", width, "m", 0.05, 4),
        to.q24("acceleration", acceleration, "m/s²", 0.01, 16),
        to.q24("turn_acceleration", skid_loads.turn_acceleration_limit(robot, acceleration), "rad/s²", 0.01, 64),
    ]


def drive(robot):
    """Members of struct jp_path_drive_config."""
    to = c_tables.Converter(f"path drive of {robot.name}")
    speed = robot.number("lattice.speed_m_s")
    return [
        to.whole("tick_rate", robot.number("control.rate_hz"), "1/s", 100, 10000),
        to.q24("way", RETURN_TIME * speed, "m", 0.01, 8),
        to.q24("pace", 1 / PACE_TIME, "1/s", 0, 64),
        to.q24("speed_correction", SPEED_CORRECTION * speed, "m/s", 0, 8),
        to.q24("turn_correction", robot.number("lattice.turn_rate_rad_s"), "rad/s", 0, 8),
    ]


def tables(robot, folder):
    """{path: text}"""
    if robot.type not in (robot_json.SKID_STEER, robot_json.DIFFERENTIAL_DRIVE):
        raise ToolError(f"{robot.source}: type: {robot.type} robot; its sides do not steer it; give the file of a "
                        f"{robot_json.SKID_STEER} or {robot_json.DIFFERENTIAL_DRIVE} robot")

    def text(part, header, kind, members):
        return c_tables.render(c_tables.Table(f"make path ROBOT={robot.name}", f"sim/robots/{robot.name}.cfg", "",
                                              f"joulepath/{header}.h", kind, f"jp_{part}_{robot.name}", members))

    return {folder / f"path_limits_{robot.name}.c": text("path_limits", "path_speed", "jp_path_limits", limits(robot)),
            folder / f"path_drive_{robot.name}.c": text("path_drive", "path_drive", "jp_path_drive_config",
                                                        drive(robot))}


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C files go (default: src/tables)")
    options = parser.parse_args()
    for path, content in tables(robot_json.load_any(robot_json.robot_path(options.robot)), options.tables).items():
        write_whole(path, content)
        print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
