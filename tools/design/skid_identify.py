#!/usr/bin/env python3
"""Identify the energy model of a skid-steered or differential-drive robot from the drives of jp-skid-identify.

The parameters of include/joulepath/skid_energy.h are fitted to the energies of designed motions, and of legs of robots on
other grounds together with the factors by which these differ, by least squares of the relative errors, none below 0;
weight, friction and inertia are those of the robot file. Random motions on slopes that were not fitted tell how good the
model is.

Further robots learn their factors as tools/design/skid_learning.py says; what their forecasts miss is the noise that they
learn with.

Writes src/tables/skid_energy_<robot>.c and skid_learning_<robot>.c. Exit status 1: the model misses random motions by more
than 10 % on average; 2: bad input. Then nothing was written.
"""
import csv
import dataclasses
import io
import json
import math
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import optimize

from tools.common import ROOT, ArgumentParser, ToolError, Verdict, print_aligned, read_text, run, shown_path, write_whole
from tools.design import c_tables, robot_json, skid_learning, skid_model

COLUMNS = ("run", "phase", "v0_m_s", "w0_rad_s", "v1_m_s", "w1_rad_s", "grade", "bank", "seconds", "energy_j")
NUMBERS = ("width_m", "half_track_m", "weight_n", "friction", "felt_mass_kg", "felt_inertia_kg_m2", "electronics_w",
           "efficiency", "ohm_per_newton_squared", "seed", "design", "check", "robots")
HOLD, CHECK = 1, 3  # phases in jp-skid-identify: steady motion, random motions
PHASES_MAX = 1000

FITTED = ("half_track", "rolling", "turning", "yielding", "scrub", "easing", "bank_easing", "tilting", "driving", "braking", "copper_driving",
          "copper_braking", "electronics_power")
LEAST = {"half_track": 0.01, "driving": 1}
MOST = {"half_track": 4, "rolling": 0.5, "turning": 4, "yielding": 16, "scrub": 4, "easing": 4, "bank_easing": 4, "tilting": 4, "driving": 10, "braking": 1,
        "copper_driving": 16384, "copper_braking": 16384, "electronics_power": 1024}

# Errors of what takes less than this share of the mean count by that: downhill all may come back.
SMALL_SHARE = 0.1

ERROR_MAX = 0.1

FITTED_ROBOTS = 20
USUAL_ERROR = 0.02  # of what a leg takes, for how unlikely the factors of a robot may be
STEP = 1e-6         # of derivatives

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
    model: skid_model.Model
    fit: np.ndarray    # relative errors
    check: np.ndarray


def read_numbers(path, name):
    try:
        data = json.loads(read_text(path))
        numbers = Numbers(data["robot"], {key: float(data[key]) for key in NUMBERS})
    except KeyError as error:
        raise ToolError(f"{path}: key {error.args[0]} is missing") from None
    except (ValueError, TypeError) as error:
        raise ToolError(f"{path}: garbled: {error}") from None
    if numbers.robot != name:
        raise ToolError(f"{path}: robot: is {numbers.robot!r}, expected {name!r}")
    return numbers


def read_table(path):
    """(run, phase, pieces whose groups are the phases of the runs)"""
    reader = csv.reader(io.StringIO(read_text(path)))
    if tuple(next(reader, ())) != COLUMNS:
        raise ToolError(f"{path}: line 1: not the columns {', '.join(COLUMNS)}; run jp-skid-identify again")
    rows = []
    for row in reader:
        try:
            rows.append([float(cell) for cell in row])
        except ValueError:
            raise ToolError(f"{path}: line {reader.line_num}: not a number") from None
        if len(row) != len(COLUMNS) or not all(map(math.isfinite, rows[-1])):
            raise ToolError(f"{path}: line {reader.line_num}: not {len(COLUMNS)} finite numbers")
    if not rows:
        raise ToolError(f"{path}: no drives")
    run_, phase, v0, w0, v1, w1, grade, bank, seconds, energy = np.array(rows).T
    if seconds.min() <= 0:
        raise ToolError(f"{path}: seconds: is {seconds.min():g}, must be above 0")
    group = np.unique(run_ * PHASES_MAX + phase, return_inverse=True)[1]
    return run_, phase, skid_model.Pieces(np.array([v0, v1]), np.array([w0, w1]), grade, bank, seconds, energy, group)


# ---- The model -------------------------------------------------------------------------------------------------------

def relative(predicted, measured):
    return (predicted - measured) / np.maximum(measured, SMALL_SHARE * measured.mean())  # of no leg, 0


def relative_errors(model, pieces):
    return relative(pieces.by_group(skid_model.energies(model, pieces)), pieces.by_group(pieces.energy))


def start_of(numbers):
    """What the robot file says, of wheels that slide by Coulomb's friction as they turn, on tyres that yield little."""
    weight, efficiency = numbers["weight_n"], numbers["efficiency"]
    copper = numbers["ohm_per_newton_squared"] * weight**2
    widening = 2 * numbers["half_track_m"] / numbers["width_m"]  # 1 + (wheelbase/width)²
    across = math.sqrt(widening - 1)
    return skid_model.Model(
        half_track=numbers["half_track_m"], weight=weight, rolling=0.03, friction=numbers["friction"],
        turning=across / (2 * math.sqrt(widening)), yielding=0.2,
        scrub=numbers["width_m"] * across * math.sqrt(widening) / 2, easing=0.5, bank_easing=0.5, tilting=0.3,
        inertia=numbers["felt_mass_kg"] / weight,
        turn_inertia=numbers["felt_inertia_kg_m2"] / (weight * numbers["width_m"]), driving=1 / efficiency,
        braking=efficiency / 2, copper_driving=copper, copper_braking=copper * efficiency**4,
        electronics_power=numbers["electronics_w"])


@dataclass(frozen=True)
class Fit:
    """Unknown are the parameters of FITTED, over `scale`, and of each robot the coordinates x of skid_learning.py."""
    start: skid_model.Model
    scale: np.ndarray
    fitted: tuple  # pieces in groups, each of whose energies counts
    robots: skid_learning.Legs

    def model(self, unknown):
        return self.start.with_values(FITTED, unknown[:len(FITTED)] * self.scale)

    def of_robots(self, unknown):
        x = unknown[len(FITTED):].reshape(-1, skid_model.FACTORS)
        return relative(self.robots.energies(self.model(unknown), skid_learning.factors(x)), self.robots.measured)

    def errors(self, unknown):
        model = self.model(unknown)
        return np.concatenate([*(relative_errors(model, pieces) for pieces in self.fitted), self.of_robots(unknown).ravel(),
                               USUAL_ERROR * unknown[len(FITTED):]])

    def jacobian(self, unknown):
        """Robots do not depend on each other: one step moves a factor of all of them."""
        here = self.errors(unknown)
        columns = np.zeros((here.size, unknown.size))
        for i in range(len(FITTED)):
            columns[:, i] = (self.errors(unknown + STEP * np.eye(unknown.size)[i]) - here) / STEP
        count, legs = self.robots.shape
        first = here.size - self.robots.measured.size - count * skid_model.FACTORS
        for factor in range(skid_model.FACTORS):
            moved = unknown.copy()
            moved[len(FITTED) + factor::skid_model.FACTORS] += STEP
            change = (self.of_robots(moved) - self.of_robots(unknown)) / STEP
            for robot in range(count):
                column = len(FITTED) + robot * skid_model.FACTORS + factor
                columns[first + robot * legs:first + (robot + 1) * legs, column] = change[robot]
                columns[column - unknown.size, column] = USUAL_ERROR
        return columns


def fit_model(numbers, fitted, robots):
    start = start_of(numbers)
    low = np.array([LEAST.get(name, 0) for name in FITTED], float)
    high = np.array([MOST[name] for name in FITTED], float)
    first = np.clip([getattr(start, name) for name in FITTED], low + 1e-6, high - 1e-6)
    scale = np.maximum(first, 1e-3)
    fit = Fit(start, scale, fitted, robots)
    free = np.full(robots.shape[0] * skid_model.FACTORS, np.inf)
    bounds = (np.concatenate([low / scale, -free]), np.concatenate([high / scale, free]))
    found = optimize.least_squares(fit.errors, np.concatenate([first / scale, 0 / free]), fit.jacobian, bounds, xtol=1e-10,
                                   ftol=1e-10, gtol=1e-10, max_nfev=500)
    return fit.model(found.x)


def identify(numbers, path, robots):
    drive, phase, pieces = read_table(path)
    held, check = pieces.chosen(phase == HOLD), pieces.chosen(phase == CHECK)
    whole = dataclasses.replace(pieces, group=drive.astype(int)).chosen(phase != CHECK)
    model = fit_model(numbers, (held, whole), robots)
    return Result(model, relative_errors(model, whole), relative_errors(model, check))


def read_robots(path):
    """Legs of the robots that are fitted, and of the others."""
    run_, phase, pieces = read_table(path)

    def legs(which):
        if not which.any():
            raise ToolError(f"{path}: robots: there must be more than {FITTED_ROBOTS}")
        return skid_learning.legs_of(run_[which], phase[which], pieces.chosen(which))

    return legs(run_ < FITTED_ROBOTS), legs(run_ >= FITTED_ROBOTS)


# ---- Tables ----------------------------------------------------------------------------------------------------------

def unit_exponent(numbers, model):
    """An hour at twice the power of driving as fast as the route's legs on level ground is about the most that fits."""
    power = model.electronics_power + model.driving * model.weight * model.rolling
    return round(math.log2(2 * power * HOUR / FORMAT_MAX))


def percent(errors):
    return f"{100 * np.abs(errors).mean():.2g}"


def energy_table(name, result, exponent, numbers):
    to, model = c_tables.Converter(f"energy model of {name}"), result.model
    members = [
        to.q24("half_track", model.half_track, "m", 0.01, 4),
        to.q16("weight", model.weight, "N", 1, 16384),
        to.q24("rolling", model.rolling, "", 0, 0.5),
        to.q24("friction", model.friction, "", 0.02, 2),
        to.q24("turning", model.turning, "", 0, 4),
        to.q24("yielding", model.yielding, "1/m", 0, 16),
        to.q24("scrub", model.scrub, "m", 0, 4),
        to.q24("easing", model.easing, "", 0, 4),
        to.q24("bank_easing", model.bank_easing, "", 0, 4),
        to.q24("tilting", model.tilting, "", 0, 4),
        to.q24("inertia", model.inertia, "s²/m", 0, 8),
        to.q24("turn_inertia", model.turn_inertia, "s²", 0, 8),
        to.q24("driving", model.driving, "", 1, 10),
        to.q24("braking", model.braking, "", 0, 1),
        to.q16("copper_driving", model.copper_driving, "W", 0, 16384),
        to.q16("copper_braking", model.copper_braking, "W", 0, 16384),
        to.q16("electronics_power", model.electronics_power, "W", 0, 1024),
        c_tables.Member("unit_exponent", str(exponent), f"energies are in units of {2.0**exponent:g} J"),
    ]
    note = (f"Mean error {percent(result.fit)} % of what {int(numbers['design'])} designed drives take, "
            f"{percent(result.check)} % of {int(numbers['check'])} random motions.")
    return c_tables.Table(f"make identify ROBOT={name}", f"sim/robots/{name}.cfg", note, "joulepath/skid_energy.h",
                          "jp_skid_energy_model", f"jp_skid_energy_{name}", members)


def learning_table(name, learning, exponent, numbers):
    to = c_tables.Converter(f"learning of {name}")
    factors = ("rolling", "friction", "weight", "electronics")
    noise, by_energy, by_slopes = learning.noise.parts
    values = [to.q16(factor, value, "", 2**-16, 1) for factor, value in zip(factors, learning.deviation)]
    members = [
        c_tables.Array("deviation", [value.value for value in values],
                       [f"{value.comment} of the {value.name}" for value in values]),
        to.energy("noise", max(noise, 2.0**(exponent - 16)), "J", 2**-16, 1024, exponent),
        to.q16("noise_relative", by_energy, "of the energy", 0, 1),
        to.q16("noise_slopes", by_slopes, "of the work of slopes", 0, 1),
        to.q16("spread", learning.noise.spread, "of single legs beyond their noise", 1, 16),
        to.whole("memory", skid_learning.MEMORY, "legs", 8, 1024),
    ]
    members.append(c_tables.Member("identity", f"{identity_of(members)}U", "of the numbers above"))
    note = (f"Of {int(numbers['robots']) - FITTED_ROBOTS} robots, plans of a third of 30 legs take "
            f"{percent(learning.untaught)} % more or less than the model says, {percent(learning.taught)} % after\n"
            f" * learning from the others.")
    return c_tables.Table(f"make identify ROBOT={name}", f"sim/robots/{name}.cfg", note, "joulepath/skid_learner.h",
                          "jp_skid_learning", f"jp_skid_learning_{name}", members)


def identity_of(members):
    """A state that was learned with other numbers means nothing with these."""
    numbers = [value for member in members
               for value in (member.values if isinstance(member, c_tables.Array) else [member.value])]
    return zlib.crc32(",".join(numbers).encode()) or 1


def show(result, learning):
    print_aligned([("parameter", "value"), *((name, f"{getattr(result.model, name):.6g}") for name in skid_model.NAMES)])
    print()
    print_aligned([("errors, %", "mean", "worst"),
                   ("designed drives", percent(result.fit), f"{100 * np.abs(result.fit).max():.3g}"),
                   ("random motions", percent(result.check), f"{100 * np.abs(result.check).max():.3g}"),
                   ("plans of other robots, untaught", percent(learning.untaught), f"{100 * np.abs(learning.untaught).max():.3g}"),
                   ("the same, taught", percent(learning.taught), f"{100 * np.abs(learning.taught).max():.3g}")])
    noise, by_energy, by_slopes = learning.noise.parts
    print(f"noise of a leg {noise:.3g} J, {100 * by_energy:.3g} % of its energy and {100 * by_slopes:.3g} % of the work of its "
          f"slopes, of single ones {learning.noise.spread:.3g} times that; {100 * learning.inside:.3g} % inside")


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots")
    parser.add_argument("--experiments", metavar="DIR", type=Path,
                        help="output of jp-skid-identify (default: build/identify/<robot>)")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C files go (default: src/tables)")
    return parser.parse_args()


def main():
    options = arguments()
    name = robot_json.robot_path(options.robot).stem
    directory = options.experiments or robot_json.build_directory() / "identify" / name
    numbers = read_numbers(directory / "experiments.json", name)
    fitted, others = read_robots(directory / "robots.csv")
    result = identify(numbers, directory / "experiments.csv", fitted)
    learning = skid_learning.learn(result.model, others)
    show(result, learning)
    if not np.abs(result.check).mean() <= ERROR_MAX:
        raise Verdict(f"{directory}: the model misses random motions by {percent(result.check)} % on average, at most "
                      f"{100 * ERROR_MAX:g} % is accepted; lower limits.speed_m_s or limits.slope_deg")
    exponent = unit_exponent(numbers, result.model)
    for kind, table in (("energy", energy_table(name, result, exponent, numbers)),
                        ("learning", learning_table(name, learning, exponent, numbers))):
        path = options.tables / f"skid_{kind}_{name}.c"
        write_whole(path, c_tables.render(table))
        print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
