#!/usr/bin/env python3
"""Make the C tables of a patrol robot's controller from its file, with jp-patrol-config.

Writes src/tables/<part>_<robot>.c for each of its parts: the numbers with which the simulator drives, bit by bit.
Exit status 2: bad input; nothing was written.
"""
import itertools
import json
from pathlib import Path

import numpy as np

from tools.common import ROOT, ArgumentParser, run, shown_path, write_whole
from tools.design import c_tables, robot_json

# The header of a table, its struct, and its name but for the robot's.
PARTS = {
    "patrol": ("patrol", "jp_patrol_config", "jp_patrol_config"),
    "pure_pursuit": ("pure_pursuit", "jp_pure_pursuit_config", "jp_pure_pursuit_config"),
    "patrol_localiser": ("localiser", "jp_localiser_config", "jp_localiser_config"),
    "patrol_scanner": ("patrol_scanner", "jp_patrol_scanner", "jp_patrol_scanner"),
    "four_wheel_robot": ("four_wheel_robot", "jp_four_wheel_robot_config", "jp_four_wheel_robot"),
}

# How a stored value is written, and what it means in its unit.
FORMATS = {
    "float": (lambda value: float_text(value), None),
    "q16": (str, 2**-16),
    "q24": (str, 2**-24),
    "q32": (str, 2**-32),
    "angle": (str, 2**-32),
    "whole": (lambda value: f"{value}U", None),
    "flag": (lambda value: str(value).lower(), None),
}
PURE_NUMBER = "1"  # as a unit


def float_text(value):
    """The shortest constant that a compiler reads back to the same single-precision number."""
    return np.format_float_positional(np.float32(value), unique=True, trim="0") + "f"


def member_of(name, data):
    text, step = FORMATS[data["format"]]
    quantity = f"{data['value'] * step:.6g}" if step else ""
    unit = "" if data["unit"] == PURE_NUMBER else data["unit"]
    return c_tables.Member(name, text(data["value"]), f"{quantity} {unit}".strip())


def members_of(data, depth=0):
    """Members and groups of them, from the dots in their keys."""
    members = []
    for name, group in itertools.groupby(data, lambda member: member["key"].split(".")[depth]):
        group = list(group)
        if group[0]["key"].count(".") == depth:
            members.append(member_of(name, group[0]))
        else:
            members.append(c_tables.Group(name, members_of(group, depth + 1)))
    return members


def table_text(data, part):
    name = data["name"]
    header, struct, table = PARTS[part]
    return c_tables.render(c_tables.Table(
        f"make patrol-config ROBOT={name}", f"sim/robots/{name}.cfg", "", f"joulepath/{header}.h", struct, f"{table}_{name}",
        members_of(data[part])))


def tables(data, folder):
    """{path: text}"""
    return {folder / f"{part}_{data['name']}.c": table_text(data, part) for part in PARTS}


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C files go (default: src/tables)")
    return parser.parse_args()


def main():
    options = arguments()
    program = robot_json.build_directory() / "bin" / "jp-patrol-config"
    path = robot_json.robot_path(options.robot)
    data = json.loads(robot_json.printed_by(program, path, "--json=-"))
    robot_json.check_name(path, data["name"])
    for path, text in tables(data, options.tables).items():
        write_whole(path, text)
        print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
