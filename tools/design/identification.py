"""What the identifications of energy models share (skid_identify.py, four_wheel_identify.py): their input, the fit of a
model's parameters, and the tables of what is learned."""
import csv
import io
import json
import math
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import optimize

from tools.common import ROOT, ArgumentParser, ToolError, Verdict, print_aligned, read_text, shown_path, write_whole
from tools.design import c_tables, robot_json

PHASES_MAX = 1000

LEAST_SCALE = 1e-3  # of the most that a parameter may be: what one that starts at 0 is counted in

# Errors of what takes less than this share of the mean count by that: downhill all may come back.
SMALL_SHARE = 0.1

ERROR_MAX = 0.1

MEMORY = 64  # legs after which a measurement counts 1/e

# Single legs are as far from the model as a normal distribution whose share SURE is within that of theirs: the slides of a
# steep slope must not pass for another ground.
SURE, SURE_DEVIATIONS = 0.99, 2.575829

FORMAT_MAX = 32768
HOUR = 3600


@dataclass(frozen=True)
class Numbers:
    """experiments.json"""
    robot: str
    values: dict

    def __getitem__(self, name):
        return self.values[name]


@dataclass(frozen=True)
class Result:
    """An energy model."""
    model: object
    fit: np.ndarray    # relative errors
    check: np.ndarray


# ---- Input -----------------------------------------------------------------------------------------------------------

def read_numbers(path, robot, keys):
    try:
        data = json.loads(read_text(path))
        numbers = Numbers(data["robot"], {key: float(data[key]) for key in keys})
    except KeyError as error:
        raise ToolError(f"{path}: key {error.args[0]} is missing") from None
    except (ValueError, TypeError) as error:
        raise ToolError(f"{path}: garbled: {error}") from None
    if numbers.robot != robot:
        raise ToolError(f"{path}: robot: is {numbers.robot!r}, expected {robot!r}")
    return numbers


def read_columns(path, names, program):
    """Arrays, in the order of their names."""
    reader = csv.reader(io.StringIO(read_text(path)))
    if tuple(next(reader, ())) != names:
        raise ToolError(f"{path}: line 1: not the columns {', '.join(names)}; run {program} again")
    rows = []
    for row in reader:
        try:
            rows.append([float(cell) for cell in row])
        except ValueError:
            raise ToolError(f"{path}: line {reader.line_num}: not a number") from None
        if len(row) != len(names) or not all(map(math.isfinite, rows[-1])):
            raise ToolError(f"{path}: line {reader.line_num}: not {len(names)} finite numbers")
    if not rows:
        raise ToolError(f"{path}: no drives")
    columns = np.array(rows).T
    shortest = columns[names.index("seconds")].min()
    if shortest <= 0:
        raise ToolError(f"{path}: seconds: is {shortest:g}, must be above 0")
    return columns


def groups_of(run, phase):
    return np.unique(run * PHASES_MAX + phase, return_inverse=True)[1]


# ---- The model -------------------------------------------------------------------------------------------------------

def relative(predicted, measured):
    return (predicted - measured) / np.maximum(measured, SMALL_SHARE * measured.mean())


def relative_errors(energies, model, pieces):
    return relative(pieces.by_group(energies(model, pieces)), pieces.by_group(pieces.energy))


class Unknowns:
    """The parameters `names` of a model, each between `least`, or 0, and `most`; as numbers about 1."""

    def __init__(self, start, names, least, most):
        self._start, self._names = start, names
        low, high = np.array([least.get(name, 0) for name in names], float), np.array([most[name] for name in names], float)
        first = np.clip([getattr(start, name) for name in names], low + 1e-9, high - 1e-9)
        self._scale = np.maximum(first, LEAST_SCALE * high)
        self.first, self.low, self.high = first / self._scale, low / self._scale, high / self._scale

    def model(self, unknown):
        return self._start.with_values(self._names, unknown[:len(self._names)] * self._scale)


def least_squares(errors, unknowns, jacobian="2-point", free=0):
    """Those and so many free ones that are 0 at first."""
    edge = np.full(free, np.inf)
    bounds = np.concatenate([unknowns.low, -edge]), np.concatenate([unknowns.high, edge])
    return optimize.least_squares(errors, np.concatenate([unknowns.first, np.zeros(free)]), jacobian, bounds, xtol=1e-12,
                                  ftol=1e-12, gtol=1e-12, max_nfev=2000).x


def deviations(ranges):
    """Root mean square of factors about 1, drawn evenly from their ranges."""
    return np.array([math.sqrt(((high - 1)**3 - (low - 1)**3) / (3 * (high - low))) for low, high in ranges])


# ---- Tables ----------------------------------------------------------------------------------------------------------

def unit_exponent(model):
    """An hour at twice the power of driving as fast as a second's metre on level ground is about the most that fits."""
    power = model.electronics_power + model.driving * model.weight * model.rolling
    return round(math.log2(2 * power * HOUR / FORMAT_MAX))


def percent(errors):
    return f"{100 * np.abs(errors).mean():.2g}"


def worst_percent(errors):
    return f"{100 * np.abs(errors).max():.3g}"


def factor_members(to, names, learning, exponent):
    """Members of struct jp_factor_learning but for the identity; `learning`: deviation, noise, noise_relative, spread."""
    values = [to.q16(name, value, "", 2**-16, 1) for name, value in zip(names, learning.deviation)]
    return [
        c_tables.Array("deviation", [value.value for value in values], [f"{value.comment} of the {value.name}" for value in values]),
        to.q16("noise_relative", learning.noise_relative, "of the energy", 0, 1),
        to.energy("noise", max(learning.noise, 2.0**(exponent - 16)), "J", 2**-16, 1024, exponent),
        to.q16("spread", learning.spread, "of single legs beyond their noise", 1, 16),
        to.whole("memory", MEMORY, "legs", 8, 1024),
    ]


def identity_of(members):
    """A state that was learned with other numbers means nothing with these."""
    numbers = [value for member in members
               for value in (member.values if isinstance(member, c_tables.Array) else [member.value])]
    return c_tables.Member("identity", f"{zlib.crc32(','.join(numbers).encode()) or 1}U", "of the numbers above")


def energy_exponent(exponent):
    return c_tables.Member("unit_exponent", str(exponent), f"energies are in units of {2.0**exponent:g} J")


def show(result, learning, names):
    print_aligned([("parameter", "value"), *((name, f"{getattr(result.model, name):.6g}") for name in names)])
    print()
    rows = (("designed drives", result.fit), ("random ones", result.check), ("plans of other robots, untaught", learning.untaught),
            ("the same, taught", learning.taught))
    print_aligned([("errors, %", "mean", "worst"), *((name, percent(errors), worst_percent(errors)) for name, errors in rows)])


def write_errors(directory, result, learning):
    """What show() prints of errors, as identification.json."""
    rows = {"designed_percent": result.fit, "random_percent": result.check, "untaught_percent": learning.untaught,
            "taught_percent": learning.taught}
    errors = {name: {"mean": 100 * float(np.abs(row).mean()), "worst": 100 * float(np.abs(row).max())}
              for name, row in rows.items()}
    write_whole(directory / "identification.json", json.dumps(errors, indent=2) + "\n")


# ---- The program -----------------------------------------------------------------------------------------------------

def arguments(description, program):
    parser = ArgumentParser(description=description.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots")
    parser.add_argument("--experiments", metavar="DIR", type=Path, help=f"output of {program} (default: build/identify/<robot>)")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C files go (default: src/tables)")
    return parser.parse_args()


def input_of(options):
    """The robot's name, and where its drives are."""
    name = robot_json.robot_path(options.robot).stem
    return name, options.experiments or robot_json.build_directory() / "identify" / name


def refuse_what_misses(result, directory, advice):
    if not np.abs(result.check).mean() <= ERROR_MAX:
        raise Verdict(f"{directory}: the model misses random motions by {percent(result.check)} % on average, at most "
                      f"{100 * ERROR_MAX:g} % is accepted; {advice}")


def write_tables(directory, tables):
    """tables: of a file's name each."""
    for name, table in tables.items():
        path = directory / f"{name}.c"
        write_whole(path, c_tables.render(table))
        print(f"wrote {shown_path(path)}")
