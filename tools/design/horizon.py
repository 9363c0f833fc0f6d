#!/usr/bin/env python3
"""Make the tables of a robot's transients (struct jp_horizon), for both definitions of energy.

The closed loop of each axis as modes, each measured by what it adds to the motor voltage: src/tables/horizon_<robot>.c
and horizon_<robot>_battery.c. Where a number does not fit its format, the mode is measured in another unit, a power of two
of a volt. Checks the rounded tables against the whole linear loop on random chains of segments, and draws that check:
build/horizon/horizon_<robot>.png. Exit status 1: the tables miss the loop by more than they may; 2: bad input. Then no table was
written.
"""
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import linalg

from tools.common import ROOT, ArgumentParser, Verdict, print_aligned, run, shown_path, write_whole
from tools.design import c_tables, closed_loop, energy_unit, linear_model, reversal, robot_json
from tools.report import plots

DURATION_MIN = 0.5  # s; the shortest segment
MODES_MAX = 9       # JP_AXIS_MODES

# A mode is left out of which the shortest segment leaves less than this share; or which adds less than this share of the
# voltage of a step, and of its energy less than half of what is allowed: a slow one of little voltage has time to take it.
GONE = 1e-4

# Real modes whose decays are within this factor have amplitudes that nearly cancel: where they fit no format they are kept as
# sums. Beyond the other bound nothing tells modes apart.
ALIKE = 1.5
CONDITION_MAX = 1e5

# Of the energy that a segment turns over, electronics included: rounded tables against the whole linear loop, mean, of 99 % of
# the segments and largest. Not of what is left of it: a heavy robot may give back as much as it takes.
MEAN_ERROR_MAX, USUAL_ERROR_MAX, ERROR_MAX = 2e-4, 2e-3, 2e-2
USUAL_PERCENTILE = 99
CHECK_SEGMENTS = 2000
CHECK_SEED = 1
PICTURE_MIN = 1e-5  # %
LONGEST = 10.0  # s

# The formats of include/joulepath/horizon.h.
STEP_MAX, STORAGE_MAX, SHARE_MAX, TRANSIENT_MAX, PASSED_MAX = 512, 8, 4096, 4096, 4096
STEP_BITS, STORAGE_BITS, SHARE_BITS = 16, 28, 16

# Of a mode's storage, with itself and with others, which is doubled in the table.
OWN_STORAGE_MAX = STORAGE_MAX / 2

SUFFIXES = {closed_loop.MOTOR: "", closed_loop.BATTERY: "_battery"}
WORDING = {closed_loop.MOTOR: "(ul² + ur²)/Rm", closed_loop.BATTERY: "ul il + ur ir"}


@dataclass(frozen=True)
class Modes:
    """Those that last longer than the shortest segment, by components."""
    decay: np.ndarray       # 1/s
    frequency: np.ndarray   # rad/s
    from_state: np.ndarray  # m = from_state e
    to_state: np.ndarray    # what m is of e
    passed: np.ndarray      # 1: the next holds its own amplitude and what is in this one; 0: it does not


@dataclass(frozen=True)
class Table:
    """One axis of struct jp_horizon in SI units; steps and cross: rows for v or w, and for σ."""
    decay: np.ndarray
    frequency: np.ndarray
    passed: np.ndarray
    step: np.ndarray
    storage: np.ndarray  # symmetric
    cross: np.ndarray
    steady: np.ndarray


@dataclass(frozen=True)
class Units:
    """What the numbers of an axis are counted in: energies in 2^energy J, each mode in 2^-mode V."""
    energy: int
    mode: np.ndarray

    @property
    def passed(self):
        """What one of a mode is of its successor's."""
        return 2.0**np.append(np.diff(self.mode), 0)

    @property
    def step_bits(self):
        """Fraction bits of SI numbers in the formats; a column for each mode."""
        return STEP_BITS + self.mode

    @property
    def storage_bits(self):
        return STORAGE_BITS - self.energy - np.add.outer(self.mode, self.mode)

    @property
    def share_bits(self):
        return SHARE_BITS - self.energy - self.mode


def _pole(rate):
    return f"{rate.real:.4g} ± {abs(rate.imag):.4g}i 1/s" if rate.imag else f"{rate.real:.4g} 1/s"


def _components(axis, value, right, left):
    """(from_state, to_state) of a mode whose first component is what it adds to the voltage: one, or two of a pair. Of one
    that adds next to nothing it is some multiple of it."""
    amplitude = axis.voltage @ right
    amplitude = amplitude if abs(amplitude) > 1 / CONDITION_MAX else 1 / CONDITION_MAX
    covector, vector = left.conj() * amplitude / (left.conj() @ right), right / amplitude
    if value.imag == 0:
        return [(covector.real, vector.real)]
    return [(2 * covector.real, vector.real), (2 * covector.imag, -vector.imag)]


def _steps(axis):
    return np.array([axis.jump(1, 0), axis.jump(0, 1)])


def _noticed(axis, energies):
    """Whether a mode (from_state, to_state) adds enough to be kept: voltage, or energy by any definition."""
    steps, linear = _steps(axis), np.column_stack([energy.linear for energy in energies])
    volts, joules = GONE * np.abs(steps @ axis.voltage), USUAL_ERROR_MAX / 2 * np.abs(steps @ linear)

    def noticed(from_state, to_state):
        amplitudes = np.abs(steps @ from_state)
        return np.any(amplitudes > volts) or np.any(np.outer(amplitudes, np.abs(to_state @ linear)) > joules)
    return noticed


def modes_of(robot, axis, energy_exponent):
    resistance = robot.positive("motor.resistance_ohm")
    energies = [closed_loop.energy(axis, definition, resistance) for definition in SUFFIXES]
    values, left, right = linalg.eig(axis.matrix, left=True)
    lasting = np.abs(values) > GONE**(1 / (DURATION_MIN * axis.rate_hz))
    rates = np.log(values[lasting].astype(complex)) * axis.rate_hz
    components = []  # (decay, frequency, from_state, to_state)
    noticed = _noticed(axis, energies)
    for k in sorted(range(len(rates)), key=lambda k: -rates[k].real):
        vector, covector = right[:, lasting][:, k], left[:, lasting][:, k]
        if not abs(covector.conj() @ vector) > 1 / CONDITION_MAX:
            raise robot.error("control", f"{axis.name}: the mode at {_pole(rates[k])} cannot be told from others; change the "
                                         "shaping or the weights")
        mode = [(-rates[k].real, rates[k].imag, *rows)
                for rows in _components(axis, values[lasting][k], vector, covector)]
        if rates[k].imag >= 0 and any(noticed(*rows[2:]) for rows in mode):
            components += mode
    if len(components) > MODES_MAX:
        raise robot.error("control", f"{axis.name}: {len(components)} modes last longer than {DURATION_MIN:g} s, the "
                                     f"tables hold {MODES_MAX}")
    modes = Modes(*(np.array(column) for column in zip(*components)), np.zeros(len(components)))
    return _summed(modes, _cancelling(axis, modes, energies, 2.0**energy_exponent))


def _cancelling(axis, modes, energies, unit):
    """Real ones whose amplitude and storage, J of this unit, fit together in no unit of theirs, but for a factor of 2."""
    amplitudes = np.abs(modes.from_state @ _steps(axis).T).max(axis=1)
    storage = np.max([np.abs(modes.to_state @ energy.form @ modes.to_state.T).max(axis=1) for energy in energies], axis=0)
    return (amplitudes * np.sqrt(storage / unit) > STEP_MAX * math.sqrt(OWN_STORAGE_MAX) / 2) & (modes.frequency == 0)


def _summed(modes, cancelling):
    """The same with sums of neighbours that are alike and cancel."""
    passed, sums = np.zeros(len(modes.decay)), np.eye(len(modes.decay))
    for k in range(len(passed) - 1):
        if cancelling[k] and cancelling[k + 1] and modes.decay[k + 1] < ALIKE * modes.decay[k]:
            passed[k] = 1
            sums[k + 1] += sums[k]
    return Modes(modes.decay, modes.frequency, sums @ modes.from_state, np.linalg.solve(sums.T, modes.to_state), passed)


def table_of(axis, modes, energy):
    steps = _steps(axis)
    return Table(modes.decay, modes.frequency, modes.passed, steps @ modes.from_state.T,
                 modes.to_state @ energy.form @ modes.to_state.T, 2 * steps @ energy.form @ modes.to_state.T,
                 modes.to_state @ energy.linear)


def _largest_transients(robot, axis, table):
    """V, of each mode whatever the robot drives. Speeds are bounded, so that steps of them take each other back: a mode
    reaches the greatest speed times its first value and the whole way that it then goes. Turns of every segment may add up."""
    travel = axis.name == "travel"
    speed = robot.positive("limits.speed_m_s" if travel else "limits.turn_rate_rad_s")
    turn = 0 if travel else math.radians(robot.number("limits.turn_deg"))
    amplitudes = np.array([np.hypot.reduce(table.step[:, pair], axis=1) for pair in _pairs(table.frequency)
                           for _ in range(pair.start, pair.stop)]).T
    there_and_back = 1 + np.hypot(1, table.frequency / table.decay)
    return speed * amplitudes[0] * there_and_back + turn * amplitudes[1] / -np.expm1(-table.decay * DURATION_MIN)


def _pairs(frequency):
    """First and last mode of each: of a pair, or of one that is alone."""
    pairs, k = [], 0
    while k < len(frequency):
        size = 1 if frequency[k] == 0 else 2
        pairs.append(slice(k, k + size))
        k += size
    return pairs


def units_of(robot, axis, table, energy):
    """Modes are counted in volts where that fits, else in the unit nearest to it in which everything fits. Both of a pair
    have the same, because they turn into each other."""
    unit, mode = 2.0**energy, np.zeros(len(table.decay), int)
    transients = _largest_transients(robot, axis, table)
    for pair in _pairs(table.frequency):
        own = np.abs(table.storage[pair]).max() / unit
        shares = max(np.abs(table.cross[:, pair]).max(), np.abs(table.steady[pair]).max()) / unit
        least = max(math.log2(max(own / OWN_STORAGE_MAX, 1)) / 2, math.log2(max(shares / SHARE_MAX, 1)))
        steps = max(np.abs(table.step[:, pair]).max() / STEP_MAX, transients[pair].max() / TRANSIENT_MAX)
        mode[pair] = math.ceil(least) or -math.ceil(math.log2(max(steps, 1)))
    return Units(energy, mode)


class Chain:
    """Energy of chained segments, J and without electronics, by the whole linear loop: (of the transients, of steady
    motion)."""

    def __init__(self, axis, energy):
        self._axis, self._energy = axis, energy
        self._state, self._speed = np.zeros(axis.size), 0.0

    def drive(self, speed, turn, seconds):
        energy, start = self._energy, self._state + self._axis.jump(speed - self._speed, turn)
        ticks = round(seconds * self._axis.rate_hz)
        self._state = np.linalg.matrix_power(self._axis.matrix, ticks) @ start
        self._speed = speed
        return (energy.stored(start, speed) - energy.stored(self._state, speed),
                energy.power * speed**2 * ticks / self._axis.rate_hz)


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
    shares = np.exp(-table.decay * seconds)
    left, pushed = modes * shares, 0.0
    for k in range(len(left) - 1):
        pushed = table.passed[k] * (pushed + (shares[k] - shares[k + 1]) * modes[k])
        left[k + 1] += pushed
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
    """Share of what each segment turns over by which tables miss the whole linear loop."""
    segments = random_segments(robot, CHECK_SEGMENTS, CHECK_SEED)
    turnover, missed = segments[:, 3] * robot.positive("electronics.power_w"), np.zeros(len(segments))
    for axis, energy, table, level in zip(axes, energies, tables, (0, 1)):
        whole, short = Chain(axis, energy), TableChain(axis, energy, table)
        for k, segment in enumerate(segments):
            step = segment[level], segment[2] * level, segment[3]
            transient, steady = whole.drive(*step)
            turnover[k] += abs(transient) + steady
            missed[k] += short.drive(*step) - (transient + steady)
    return np.abs(missed / turnover)


def rounded(table, units):
    """The table as its formats hold it."""
    def to(values, bits):
        return np.floor(values * 2.0**bits + 0.5) / 2.0**bits

    storage = np.where(np.eye(len(table.decay)), 1, 2) * table.storage
    storage = to(storage, units.storage_bits) / np.where(np.eye(len(table.decay)), 1, 2)
    return Table(to(table.decay / math.log(2), 24) * math.log(2), to(table.frequency / math.tau, 24) * math.tau,
                 table.passed, to(table.step, units.step_bits), storage, to(table.cross, units.share_bits),
                 to(table.steady, units.share_bits))


def _axis_group(to, axis, table, units):
    count = len(table.decay)

    def number(name, value, bits, unit, limit, bits_of_volts):
        scale = 2.0**(bits_of_volts - bits)
        return to.number(f"{axis.name}.{name}", value, int(bits), unit, -limit * scale, limit * scale)

    def row(name, values, bits, unit, limit, bits_of_volts):
        return [number(name, value, own, unit, limit, bits_of_volts) for value, own in zip(values, bits)]

    def rows(name, values, bits, of_rows, limit, bits_of_volts):
        members = [row(name, of_row, bits, unit, limit, bits_of_volts) for of_row, unit in zip(values, of_rows)]
        return c_tables.Array(name, [f"{{{', '.join(m.value for m in of_row)}}}" for of_row in members], list(of_rows))

    def column(name, members):
        return c_tables.Array(name, [m.value for m in members], [m.comment for m in members])

    passed = [to.q16(f"{axis.name}.passed[{k}]", value, "", 0, PASSED_MAX)
              for k, value in enumerate(table.passed * units.passed)]
    modes, storage = [], []
    for k, (decay, frequency) in enumerate(zip(table.decay, table.frequency)):
        halvings = to.q24(f"{axis.name}.mode[{k}].decay", decay / math.log(2), "halvings/s", 2**-24, 127)
        turns = to.q24(f"{axis.name}.mode[{k}].frequency", frequency / math.tau, "turn/s", 0, 64)
        modes.append((f"{{{halvings.value}, {turns.value}}}",
                      f"-{decay:.4f}{f' ± {frequency:.4f}i' if frequency else ''} 1/s"))
        storage += row("storage", table.storage[k, k:] * np.where(np.arange(k, count) == k, 1, 2),
                       units.storage_bits[k, k:], "J/V²", STORAGE_MAX, STORAGE_BITS)
    steps, crosses = ((["V·s/m"], ["J·s/(V·m)"]) if axis.name == "travel"
                      else (["V·s/rad", "V/rad"], ["J·s/(V·rad)", "J/(V·rad)"]))
    return c_tables.Group(axis.name, [
        to.whole("count", count, "", 0, MODES_MAX),
        c_tables.Array("mode", *map(list, zip(*modes))),
        *([column("passed", passed)] if table.passed.any() else []),
        rows("step", table.step, units.step_bits, steps, STEP_MAX, STEP_BITS),
        column("storage", storage),
        rows("cross", table.cross, units.share_bits, crosses, SHARE_MAX, SHARE_BITS),
        column("steady", row("steady", table.steady, units.share_bits, crosses[0], SHARE_MAX, SHARE_BITS)),
    ])


def _percent(errors):
    return f"{100 * errors.mean():.1g} %, at most {100 * errors.max():.1g} %"


def c_table(robot, definition, axes, tables, units, errors):
    to = c_tables.Converter(robot.source)
    turning = reversal.design(robot, linear_model.design(robot).gains)
    rest = turning.rest_ticks(robot) / robot.positive("control.rate_hz")
    members = [to.q16("duration_min", DURATION_MIN, "s", 2**-16, 60),
               to.q16("reversal_rest", rest, "s", 0, 1000),
               *(_axis_group(to, *of_axis) for of_axis in zip(axes, tables, units))]
    return c_tables.Table(f"make horizon ROBOT={robot.name}", f"sim/robots/{robot.name}.cfg",
                          f"Energy {WORDING[definition]}; mean error against the whole linear loop {_percent(errors)}.",
                          "joulepath/horizon.h", "jp_horizon", f"jp_horizon_{robot.name}{SUFFIXES[definition]}", members)


def tables_of(robot, definition, axes, modes, energy_exponent):
    """Tables and units of both axes, and the errors of the tables."""
    resistance = robot.positive("motor.resistance_ohm")
    energies = [closed_loop.energy(axis, definition, resistance) for axis in axes]
    tables = [table_of(axis, mode, energy) for axis, mode, energy in zip(axes, modes, energies)]
    units = [units_of(robot, axis, table, energy_exponent) for axis, table in zip(axes, tables)]
    return tables, units, errors_of(robot, axes, energies, [rounded(*of_axis) for of_axis in zip(tables, units)])


def check_errors(robot, errors):
    usual = np.percentile(errors, USUAL_PERCENTILE)
    if not (errors.mean() <= MEAN_ERROR_MAX and usual <= USUAL_ERROR_MAX and errors.max() <= ERROR_MAX):
        raise Verdict(f"{robot.source}: control: the tables miss the linear loop's energy by {100 * errors.mean():.2g} %, of "
                      f"{USUAL_PERCENTILE} % by {100 * usual:.2g} %, at most {100 * errors.max():.2g} %; bars "
                      f"{100 * MEAN_ERROR_MAX:g} %, {100 * USUAL_ERROR_MAX:g} % and {100 * ERROR_MAX:g} %; change the "
                      "shaping or the weights")


def draw(robot, errors):
    """What share of the segments is missed by no more than so much; errors: by definition."""
    figure, axes = plots.new_figure(9, 3.6)
    for (definition, values), colour in zip(errors.items(), (plots.BLUE, plots.ORANGE)):
        axes.plot(np.sort(100 * values), 100 * np.arange(1, len(values) + 1) / len(values), color=colour,
                  label=f"energy of the {definition}")
    for bar, share in ((USUAL_ERROR_MAX, USUAL_PERCENTILE), (ERROR_MAX, 100)):
        axes.plot(100 * bar, share, "v", color=plots.RED, clip_on=False, zorder=3,
                  label=f"bar: {share} % within {100 * bar:g} %")
    axes.set(xscale="log", xlim=(PICTURE_MIN, None), ylim=(0, 100), xlabel="error of what a segment turns over, %",
             ylabel="segments within it, %",
             title=f"Transients of {robot.name}: tables against the whole linear loop, {CHECK_SEGMENTS} segments")
    axes.legend(loc="upper left")
    return plots.png_bytes(figure)


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
    parser.add_argument("--pictures", metavar="DIR", type=Path, default=robot_json.build_directory() / "horizon",
                        help="where the picture goes (default: build/horizon)")
    return parser.parse_args()


def main():
    options = arguments()
    robot = (robot_json.load_json(options.robot_json) if options.robot_json
             else robot_json.load(robot_json.robot_path(options.robot), options.jp_robot))
    axes = closed_loop.axes(robot)
    unit = energy_unit.exponent(robot)
    modes = [modes_of(robot, axis, unit) for axis in axes]
    print_modes(robot, axes, modes)
    made = {definition: tables_of(robot, definition, axes, modes, unit) for definition in SUFFIXES}
    for definition, (_, _, errors) in made.items():
        print(f"{definition}: tables miss the whole linear loop by {_percent(errors)}; "
              f"{USUAL_PERCENTILE} % of the segments by less than {100 * np.percentile(errors, USUAL_PERCENTILE):.1g} %")
    print()
    picture = options.pictures / f"horizon_{robot.name}.png"
    write_whole(picture, draw(robot, {definition: errors for definition, (_, _, errors) in made.items()}))
    print(f"wrote {shown_path(picture)}")
    files = {}
    for definition, (tables, units, errors) in made.items():
        check_errors(robot, errors)
        files[options.tables / f"horizon_{robot.name}{SUFFIXES[definition]}.c"] = c_tables.render(
            c_table(robot, definition, axes, tables, units, errors))
    for path, content in files.items():
        write_whole(path, content)
        print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
