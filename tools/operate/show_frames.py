#!/usr/bin/env python3
"""Show some frames of a log as candump prints them, and decoded as joulepath.dbc says.

Takes a tick in the middle of the drive and one frame of each other message around it. With --tables they are written for
tools/measure/figures.py too. Exit status 2: bad input; nothing was written.
"""
import json
import subprocess
import sys
from pathlib import Path

from tools.common import ArgumentParser, ToolError, read_text, run, write_whole
from tools.operate.can_messages import DBC, database

# What a reader wants to see, in the order of a tick.
SHOWN = ("WheelSensors", "BalanceSensors", "CurrentSensors", "MotorCommand", "OperatorCommand", "Pose", "EnergySpent",
         "SegmentForecast", "BatteryStatus")


def pick(lines, ids):
    """One line of each id, the first one after the middle of the log."""
    middle = len(lines) // 2
    found = {}
    for line in lines[middle:] + lines[:middle]:
        identifier = int(line.split(" ")[2].split("#")[0], 16)
        if identifier in ids and identifier not in found:
            found[identifier] = line
            if len(found) == len(ids):
                break
    if not found:
        raise ToolError("the log holds no frame of joulepath.dbc; record one with make sil BUS=vcan")
    return [found[identifier] for identifier in ids if identifier in found]


def as_candump(line):
    """A line of candump -L as candump prints it on a terminal."""
    _, interface, frame = line.split(" ")
    identifier, data = frame.split("#")
    octets = " ".join(data[i:i + 2] for i in range(0, len(data), 2))
    return f"  {interface}  {identifier}   [{len(data) // 2}]  {octets}"


def decoded(lines):
    """The lines as cantools decodes them."""
    command = [sys.executable, "-m", "cantools", "decode", "--single-line", str(DBC)]
    result = subprocess.run(command, input="\n".join(lines) + "\n", capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise ToolError(f"cantools cannot decode: {(result.stderr.strip() or 'no reason given').splitlines()[-1]}")
    return [line.split(" :: ", 1)[1] for line in result.stdout.splitlines() if " :: " in line]


def shown_ids():
    return [database().get_message_by_name(name).frame_id for name in SHOWN]


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("log", type=Path, help="as candump -L writes it")
    parser.add_argument("--tables", metavar="FILE", type=Path, help="write the lines there as a table")
    options = parser.parse_args()
    raw = pick(read_text(options.log).splitlines(), shown_ids())
    shown = [as_candump(line) for line in raw]
    lines = ["$ candump can0", *shown, "", "$ candump can0 | python -m cantools decode --single-line "
             "hal/can/joulepath.dbc", *decoded(shown)]
    print("\n".join(lines))
    if options.tables:
        write_whole(options.tables, json.dumps({"frames": {"lines": lines}}, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    run(main)
