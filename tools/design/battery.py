#!/usr/bin/env python3
"""The battery of a robot for the core's filter, from the files of its pack, of the cell and of the robot.

Writes src/tables/battery_<robot>.c and pack_<robot>.c. Exit status 2: bad input; nothing was written.
"""
import math
import re
import zlib
from pathlib import Path

from tools.common import ROOT, ArgumentParser, ToolError, read_text, run, shown_path, write_whole
from tools.design import c_tables

POINTS = 21

# The current sensor's zero wanders by a tenth of its spread in an hour, the counted charge by what rounding and the
# voltage between two readings leave.
OFFSET_WALK_SHARE = 0.1
CHARGE_WALK = 1e-4

# Updates a second; what the robot shall not use of its charge; how far the charge is off that it is told, or finds by
# the voltage at rest.
UPDATE_RATE = 10
RESERVE = 0.1
CHARGE_DEVIATION = 0.05

SETTING = re.compile(r'(\w+)\s*=\s*(\[[^\]]*\]|"[^"]*"|[^;{}]+);|(\w+)\s*:\s*\{|(\})')


class Settings:
    """Values by "group.key" of a configuration file; complaints name file and key."""

    def __init__(self, path):
        self.source = shown_path(path)
        self._values = {}
        group = ""
        for key, value, opened, closed in SETTING.findall(re.sub(r"#.*", "", read_text(path))):
            if opened or closed:
                group = f"{opened}." if opened else ""
            else:
                self._values[group + key] = value.strip()

    def text(self, key):
        value = self._values.get(key, "")
        if not re.fullmatch(r'"[a-z][a-z0-9_]*"', value):
            raise self.error(key, "must be a name of small letters, digits and _")
        return value[1:-1]

    def number(self, key):
        return self._number(key, self._values.get(key, ""))

    def count(self, key):
        value = self.number(key)
        if value < 1 or value != int(value):
            raise self.error(key, f"is {value:g}, must be a whole number above 0")
        return value

    def numbers(self, key):
        value = self._values.get(key, "")
        if not value.startswith("["):
            raise self.error(key, "must be an array of numbers")
        return [self._number(key, item) for item in value[1:-1].split(",")]

    def error(self, key, reason):
        return ToolError(f"{self.source}: {key}: {reason}")

    def first(self, *keys):
        """Of these keys, which mean the same in files of different kinds of robots, that which is there."""
        return next((key for key in keys if key in self._values), keys[0])

    def _number(self, key, text):
        try:
            value = float(text)
        except ValueError:
            raise self.error(key, "must be a number") from None
        if not math.isfinite(value):
            raise self.error(key, "is not finite")
        return value


def interpolate(places, values, place):
    """Linear between the points."""
    for left, right, low, high in zip(places, places[1:], values, values[1:]):
        if place <= right:
            return low + (high - low) * (place - left) / (right - left)
    return values[-1]


def pack_path(robot):
    """The file of the pack of a robot given by path or by name."""
    path = Path(robot)
    return path if path.suffix == ".cfg" else ROOT / "sim" / "robots" / "packs" / f"{robot}.cfg"


def curve(to, name, values, unit, low, high):
    members = [to.q24(f"{name}[{i}]", value, unit, low, high) for i, value in enumerate(values)]
    return c_tables.Array(name, [member.value for member in members], [member.comment for member in members])


def members_of(pack, cell, name):
    """Members of struct jp_battery_cells but for the identity."""
    to = c_tables.Converter(f"battery of {name}")
    series, parallel = pack.count("series"), pack.count("parallel")
    charges = cell.numbers("cell.charge")
    if len(charges) != POINTS:
        raise cell.error("cell.charge", f"must be {POINTS} numbers")
    places, ohmic = cell.numbers("resistance.charge"), cell.numbers("resistance.ohmic_ohm")
    wiring = pack.number("wiring_ohm") / series
    capacity = cell.number("cell.capacity_ah") * parallel
    offset = pack.number("offset_a") / capacity
    return [
        to.whole("series", series, "cells", 1, 200),
        curve(to, "charge", charges, "", 0, 1),
        curve(to, "open_voltage", cell.numbers("cell.open_circuit_v"), "V", 0.5, 10),
        curve(to, "resistance", [interpolate(places, ohmic, z) / parallel + wiring for z in charges], "Ω", 2**-24, 1),
        to.q24("polarisation", cell.number("resistance.polarisation_ohm") / parallel, "Ω", 0, 1),
        to.q31("polarisation_keep", math.exp(-1 / cell.number("resistance.polarisation_s")), "", 0, 1),
        to.q24("resistance_deviation", cell.number("spread.resistance"), "", 0.001, 1),
        to.q24("slowness_deviation", cell.number("spread.polarisation"), "", 0.001, 1),
        to.q24("curve_deviation", cell.number("spread.curve_v"), "V", 0, 0.5),
        to.q24("curve_length", cell.number("spread.curve_length"), "", 0.001, 1),
        to.q24("capacity_deviation", cell.number("spread.capacity"), "", 0.001, 0.5),
        to.q24("offset_deviation", offset, "1/h", 0, 1),
        to.q24("charge_walk", CHARGE_WALK, "", 0, 1),
        to.q24("resistance_walk", cell.number("spread.resistance_per_root_h"), "", 0, 1),
        to.q24("slowness_walk", cell.number("spread.polarisation_per_root_h"), "", 0, 1),
        to.q24("capacity_walk", cell.number("spread.capacity_per_root_h"), "", 0, 1),
        to.q24("offset_walk", OFFSET_WALK_SHARE * offset, "1/h", 0, 1),
        to.q24("voltage_noise", cell.number("spread.voltage_v"), "V", 0.005, 1),
        to.q24("load_noise", cell.number("spread.load_share"), "", 0, 1),
    ]


def identity(members):
    """CRC-32 of the numbers, not 0."""
    values = []
    for member in members:
        values += member.values if isinstance(member, c_tables.Array) else [member.value]
    return zlib.crc32(" ".join(values).encode()) or 1


def settings_of(pack, cell, robot, name):
    """Members of struct jp_battery_config. The bus is believed between half of the empty cells' voltage, at which they
    give most power, and what the full ones have and that half."""
    to = c_tables.Converter(f"battery of {name}")
    series, parallel = pack.count("series"), pack.count("parallel")
    charges, voltages = cell.numbers("cell.charge"), cell.numbers("cell.open_circuit_v")
    steps = zip(charges, charges[1:], voltages, voltages[1:])
    mean = sum((right - left) * (low + high) / 2 for left, right, low, high in steps)
    empty, full = series * voltages[0], series * voltages[-1]
    return [
        to.whole("capacity", 3600 * cell.number("cell.capacity_ah") * parallel, "A·s", 60, 262144),
        to.q16("voltage_empty", empty, "V", 1, 1000),
        to.q16("voltage_nominal", series * mean, "V", 1, 1000),
        to.q16("voltage_full", full, "V", 1, 1000),
        to.q16("voltage_min", empty / 2, "V", 1, 1000),
        to.q16("voltage_max", full + empty / 2, "V", 1, 1000),
        to.q16("voltage_jump", empty / 2, "V", 2**-16, 1000),
        to.q16("charge_efficiency", 1, "", 0.5, 1),
        to.q31("reserve", RESERVE, "", 0, 0.5),
        to.q31("charge_deviation", CHARGE_DEVIATION, "", 0, 0.5),
        c_tables.Member("load", "0", "A: who forecasts knows it"),
        to.q16("voltage_designed", robot.number(robot.first("supply.voltage_v", "electronics.voltage_v")), "V", 1, 1000),
        to.whole("update_rate", UPDATE_RATE, "1/s", 1, 1000),
        c_tables.Member("cells", f"&jp_battery_cells_{name}", "that it is made of"),
        c_tables.Member("unit_exponent", "0", "as the robot's energy model"),
    ]


def tables(path):
    """The C tables of the pack in a file, by the name of their file: its cells, and how they are used."""
    pack = Settings(path)
    name = path.stem
    cell_path = ROOT / "sim" / "robots" / "cells" / f"{pack.text('cell')}.cfg"
    cell, robot = Settings(cell_path), Settings(path.resolve().parents[1] / path.name)
    members = members_of(pack, cell, name)
    members.append(c_tables.Member("identity", f"0x{identity(members):08X}U"))
    kinds = (("battery", "jp_battery_cells", members, ()),
             ("pack", "jp_battery_config", settings_of(pack, cell, robot, name), ("joulepath/tables.h",)))
    return {f"{stem}_{name}.c": c_tables.Table(f"make battery ROBOT={name}", shown_path(path),
                                               f"Its cell: {shown_path(cell_path)}.", "joulepath/battery.h", kind,
                                               f"{kind}_{name}", values, others)
            for stem, kind, values, others in kinds}


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="file of a pack, or the name of a robot that has one in sim/robots/packs")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C file goes (default: src/tables)")
    options = parser.parse_args()
    path = pack_path(options.robot)
    for file, made in tables(path).items():
        output = options.tables / file
        write_whole(output, c_tables.render(made))
        print(f"wrote {shown_path(output)}")
    return 0


if __name__ == "__main__":
    run(main)
