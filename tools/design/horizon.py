#!/usr/bin/env python3
"""Make the tables of a robot's transients (struct jp_horizon), for both definitions of energy.

The closed loop of each axis as modes, each measured by what it adds to the motor voltage: src/tables/horizon_<robot>.c
and horizon_<robot>_battery.c. Checks the rounded tables against the whole linear loop on random chains of segments. Exit
status 2: bad input; nothing was written.
"""
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import linalg

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, run, shown_path, write_whole
from tools.design import c_tables, closed_loop, robot_json

DURATION_MIN = 0.5  # s; the shortest segment
MODES_MAX = 8       # JP_AXIS_MODES

# A mode is left out of which the shortest segment leaves less than this share, or which adds less than this share of the
# voltage of a step.
GONE = 1e-4

# Beyond it modes are so alike that their amplitudes cancel.
CONDITION_MAX = 1e5

# Of a segment's energy, electronics included: rounded tables against the whole linear loop, mean and largest.
MEAN_ERROR_MAX, ERROR_MAX = 2e-4, 2e-3
CHECK_SEGMENTS = 2000
CHECK_SEED = 1
LONGEST = 10.0  # s

# The formats of include/joulepath/horizon.h.
STEP_MAX, SHARE_MAX = 512, 4096

SUFFIXES = {closed_loop.MOTOR: "", closed_loop.BATTERY: "_battery"}
WORDING = {closed_loop.MOTOR: "(ul² + ur²)/Rm", closed_loop.BATTERY: "ul il + ur ir"}


@dataclass(frozen=True)
class Modes:
    """Those that last longer than the shortest segment, by components."""
    decay: np.ndarray       # 1/s
    frequency: np.ndarray   # rad/s
    from_state: np.ndarray  # m = from_state e
    to_state: np.ndarray    # what m is of e


@dataclass(frozen=True)
class Table:
    """One axis of struct jp_horizon in SI units; steps and cross: rows for v or w, and for σ."""
    decay: np.ndarray
    frequency: np.ndarray
    step: np.ndarray
    storage: np.ndarray  # symmetric
    cross: np.ndarray
    steady: np.ndarray


def _pole(rate):
    return f"{rate.real:.4g} ± {abs(rate.imag):.4g}i 1/s" if rate.imag else f"{rate.real:.4g} 1/s"


def _components(axis, value, right, left):
    """(from_state, to_state) of a mode whose first component is what it adds to the voltage: one, or two of a pair."""
    amplitude = axis.voltage @ right
    covector, vector = left.conj() * amplitude / (left.conj() @ right), right / amplitude
    if value.imag == 0:
        return [(covector.real, vector.real)]
    return [(2 * covector.real, vector.real), (2 * covector.imag, -vector.imag)]


def modes_of(robot, axis):
    values, left, right = linalg.eig(axis.matrix, left=True)
    lasting = np.abs(values) > GONE**(1 / (DURATION_MIN * axis.rate_hz))
    rates = np.log(values[lasting].astype(complex)) * axis.rate_hz
    components = []  # (decay, frequency, from_state, to_state)
    steps = np.array([axis.jump(1, 0), axis.jump(0, 1)])
    least = GONE * np.abs(steps @ axis.voltage)
    for k in sorted(range(len(rates)), key=lambda k: -rates[k].real):
        vector, covector = right[:, lasting][:, k], left[:, lasting][:, k]
        if not abs(covector.conj() @ vector) > 1 / CONDITION_MAX or abs(axis.voltage @ vector) < 1 / CONDITION_MAX:
            raise robot.error("control", f"{axis.name}: the mode at {_pole(rates[k])} cannot be told from others or from "
                                         "the voltage; change the shaping or the weights")
        mode = [(-rates[k].real, rates[k].imag, *rows)
                for rows in _components(axis, values[lasting][k], vector, covector)]
        if rates[k].imag >= 0 and np.any(np.abs([steps @ rows[2] for rows in mode]) > least):
            components += mode
    if len(components) > MODES_MAX:
        raise robot.error("control", f"{axis.name}: {len(components)} modes last longer than {DURATION_MIN:g} s, the "
                                     f"tables hold {MODES_MAX}")
    return Modes(*(np.array(column) for column in zip(*components)))


def table_of(axis, modes, energy):
    steps = np.array([axis.jump(1, 0), axis.jump(0, 1)])
    return Table(modes.decay, modes.frequency, steps @ modes.from_state.T,
                 modes.to_state @ energy.form @ modes.to_state.T, 2 * steps @ energy.form @ modes.to_state.T,
                 modes.to_state @ energy.linear)


class Chain:
    """Energy of chained segments, J and without electronics, by the whole linear loop."""

    def __init__(self, axis, energy):
        self._axis, self._energy = axis, energy
        self._state, self._speed = np.zeros(axis.size), 0.0

    def drive(self, speed, turn, seconds):
        energy, start = self._energy, self._state + self._axis.jump(speed - self._speed, turn)
        ticks = round(seconds * self._axis.rate_hz)
        self._state = np.linalg.matrix_power(self._axis.matrix, ticks) @ start
        self._speed = speed
        return (energy.stored(start, speed) - energy.stored(self._state, speed)
                + energy.power * speed**2 * ticks / self._axis.rate_hz)


class TableChain:
    """The same by a table, with the settled energy of the whole linear loop."""

    def __init__(self, axis, energy, table):
        self._axis, self._energy, self._table = axis, energy, table
        self._modes, self._speed = np.zeros(len(table.decay)), 0.0

    def _stored(self, modes, speed):
        return modes @ self._table.storage @ modes + speed * (self._table.steady @ modes)

    def drive(self, speed, turn, seconds):
        step = np.array([speed - self._speed, turn])
        jump, table = self._axis.jump(*step), self._table
        energy = (self._energy.stored(jump, speed) + self._energy.power * speed**2 * seconds
                  + self._stored(self._modes, speed) + step @ table.cross @ self._modes)
        self._modes, self._speed = moved(table, self._modes + step @ table.step, seconds), speed
        return energy - self._stored(self._modes, speed)


def moved(table, modes, seconds):
    """The modes after that time."""
    left = modes * np.exp(-table.decay * seconds)
    turned, k = left.copy(), 0
    while k < len(left):
        if table.frequency[k] == 0:
            k += 1
            continue
        c, s = math.cos(table.frequency[k] * seconds), math.sin(table.frequency[k] * seconds)
        turned[k], turned[k + 1] = c * left[k] - s * left[k + 1], s * left[k] + c * left[k + 1]
        k += 2
    return turned


def random_segments(robot, count, seed):
    """(v, w, σ, T) within the robot's limits, T in whole ticks."""
    rate = robot.positive("control.rate_hz")
    generator = np.random.default_rng(seed)
    turn = math.radians(robot.number("limits.turn_deg"))
    turn_rate = robot.positive("limits.turn_rate_rad_s")
    return np.column_stack([generator.uniform(0, robot.positive("limits.speed_m_s"), count),
                            generator.uniform(-turn_rate, turn_rate, count), generator.uniform(-turn, turn, count),
                            np.round(generator.uniform(DURATION_MIN, LONGEST, count) * rate) / rate])


def errors_of(robot, axes, energies, tables):
    """Share of each segment's energy by which tables miss the whole linear loop."""
    segments = random_segments(robot, CHECK_SEGMENTS, CHECK_SEED)
    exact, rounded = segments[:, 3] * robot.positive("electronics.power_w"), np.zeros(len(segments))
    for axis, energy, table, level in zip(axes, energies, tables, (0, 1)):
        whole, short = Chain(axis, energy), TableChain(axis, energy, table)
        for k, segment in enumerate(segments):
            step = segment[level], segment[2] * level, segment[3]
            energy_of_segment = whole.drive(*step)
            exact[k] += energy_of_segment
            rounded[k] += short.drive(*step) - energy_of_segment
    return np.abs(rounded / exact)


def rounded(table):
    """The table as its formats hold it."""
    def to(values, bits):
        return np.floor(values * 2.0**bits + 0.5) / 2.0**bits

    storage = np.where(np.eye(len(table.decay)), 1, 2) * table.storage
    storage = to(storage, 28) / np.where(np.eye(len(table.decay)), 1, 2)
    return Table(to(table.decay / math.log(2), 24) * math.log(2), to(table.frequency / math.tau, 24) * math.tau,
                 to(table.step, 16), storage, to(table.cross, 16), to(table.steady, 16))


def _axis_group(to, axis, table):
    count = len(table.decay)

    def rows(name, values, units, limit):
        members = [[to.q16(f"{axis.name}.{name}", value, unit, -limit, limit) for value in row]
                   for row, unit in zip(values, units)]
        return c_tables.Array(name, [f"{{{', '.join(m.value for m in row)}}}" for row in members], list(units))

    def column(name, members):
        return c_tables.Array(name, [m.value for m in members], [m.comment for m in members])

    modes, storage = [], []
    for k, (decay, frequency) in enumerate(zip(table.decay, table.frequency)):
        halvings = to.q24(f"{axis.name}.mode[{k}].decay", decay / math.log(2), "halvings/s", 2**-24, 127)
        turns = to.q24(f"{axis.name}.mode[{k}].frequency", frequency / math.tau, "turn/s", 0, 64)
        modes.append((f"{{{halvings.value}, {turns.value}}}",
                      f"-{decay:.4f}{f' ± {frequency:.4f}i' if frequency else ''} 1/s"))
        storage += [to.number(f"{axis.name}.storage", table.storage[k, l] * (1 if k == l else 2), 28, "J/V²", -8, 8)
                    for l in range(k, count)]
    steps, crosses = ((["V·s/m"], ["J·s/(V·m)"]) if axis.name == "travel"
                      else (["V·s/rad", "V/rad"], ["J·s/(V·rad)", "J/(V·rad)"]))
    return c_tables.Group(axis.name, [
        to.whole("count", count, "", 0, MODES_MAX),
        c_tables.Array("mode", *map(list, zip(*modes))),
        rows("step", table.step, steps, STEP_MAX),
        column("storage", storage),
        rows("cross", table.cross, crosses, SHARE_MAX),
        column("steady", [to.q16(f"{axis.name}.steady", value, crosses[0], -SHARE_MAX, SHARE_MAX)
                          for value in table.steady]),
    ])


def _percent(errors):
    return f"{100 * errors.mean():.1g} %, at most {100 * errors.max():.1g} %"


def c_table(robot, definition, axes, tables, errors):
    to = c_tables.Converter(robot.source)
    members = [to.q16("duration_min", DURATION_MIN, "s", 2**-16, 60),
               *(_axis_group(to, axis, table) for axis, table in zip(axes, tables))]
    return c_tables.Table(f"make horizon ROBOT={robot.name}", f"sim/robots/{robot.name}.cfg",
                          f"Energy {WORDING[definition]}; mean error against the whole linear loop {_percent(errors)}.",
                          "joulepath/horizon.h", "jp_horizon", f"jp_horizon_{robot.name}{SUFFIXES[definition]}", members)


def checked_tables(robot, definition, axes, modes):
    """Tables of both axes, and their errors."""
    resistance = robot.positive("motor.resistance_ohm")
    energies = [closed_loop.energy(axis, definition, resistance) for axis in axes]
    tables = [table_of(axis, mode, energy) for axis, mode, energy in zip(axes, modes, energies)]
    errors = errors_of(robot, axes, energies, [rounded(table) for table in tables])
    if not (errors.mean() <= MEAN_ERROR_MAX and errors.max() <= ERROR_MAX):
        raise robot.error("control", f"the tables miss the linear loop's energy by {100 * errors.mean():.2g} %, at most "
                                     f"{100 * errors.max():.2g} %; bars {100 * MEAN_ERROR_MAX:g} % and "
                                     f"{100 * ERROR_MAX:g} %; change the shaping or the weights")
    return tables, errors


def print_modes(robot, axes, modes):
    print(f"{robot.name}: modes of the closed loop that last longer than {DURATION_MIN:g} s\n")
    rows = [("axis", "pole, 1/s", "", "V a unit step")]
    for axis, found in zip(axes, modes):
        steps = found.from_state @ axis.jump(1, 0)
        rows += [(axis.name, f"{-decay:.4f}", f"± {frequency:.4f}i" if frequency else "", f"{step:.4f}")
                 for decay, frequency, step in zip(found.decay, found.frequency, steps)]
    print_aligned(rows)
    print()


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots")
    parser.add_argument("--jp-robot", metavar="PATH", help="the program (default: build/bin/jp-robot)")
    parser.add_argument("--robot-json", metavar="FILE", help="output of jp-robot --json=-, instead of running it")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C files go (default: src/tables)")
    return parser.parse_args()


def main():
    options = arguments()
    robot = (robot_json.load_json(options.robot_json) if options.robot_json
             else robot_json.load(robot_json.robot_path(options.robot), options.jp_robot))
    axes = closed_loop.axes(robot)
    modes = [modes_of(robot, axis) for axis in axes]
    files = {}
    print_modes(robot, axes, modes)
    for definition, suffix in SUFFIXES.items():
        tables, errors = checked_tables(robot, definition, axes, modes)
        files[options.tables / f"horizon_{robot.name}{suffix}.c"] = c_tables.render(
            c_table(robot, definition, axes, tables, errors))
        print(f"{definition}: tables miss the whole linear loop by {_percent(errors)}")
    print()
    for path, text in files.items():
        write_whole(path, text)
        print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
