#!/usr/bin/env python3
"""Identify the energy model of a skid-steered or differential-drive robot from the drives of jp-skid-identify.

The parameters of include/joulepath/skid_energy.h are fitted to the energies of designed motions by least squares of the
relative errors, none below 0; weight, friction and inertia are those of the robot file. Random motions on slopes that were
not fitted tell how good the model is.

What other grounds, payloads and electronics change are four factors of the model. How far robots with factors of their own
are still from it is the noise of what the robot learns from.

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
from tools.design import c_tables, robot_json, skid_model

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

# Of the factors about 1, root mean square over what jp-skid-identify draws: rolling 0.7 to 1.5, friction 0.6 to 1.2,
# weight 0.9 to 1.3, electronics 0.8 to 1.2.
RANGES = ((0.7, 1.5), (0.6, 1.2), (0.9, 1.3), (0.8, 1.2))

LESSONS = 20             # legs of a robot that it learns from
NOISE_START = (1, 0.01)  # J, and share of the energy, of a leg
# Single legs are as far from the model as a normal distribution whose share SURE is within that of theirs: the slides of a
# steep slope must not pass for another ground.
SURE, SURE_DEVIATIONS = 0.99, 2.576
ROUNDS = 3               # of the noise, which weighs the legs that it is found from

MEMORY = 64  # legs after which a measurement counts 1/e

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


@dataclass(frozen=True)
class Learning:
    """struct jp_skid_learning in SI units."""
    deviation: np.ndarray
    noise: float           # J
    noise_relative: float
    spread: float          # of single legs beyond it
    untaught: np.ndarray   # relative errors of each robot's legs, before and after its factors are known
    taught: np.ndarray


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

def weights_of(measured):
    return 1 / np.maximum(measured, SMALL_SHARE * measured.mean())


def relative_errors(model, pieces):
    measured = pieces.by_group(pieces.energy)
    return (pieces.by_group(skid_model.energies(model, pieces)) - measured) * weights_of(measured)


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


def fit_model(numbers, fitted):
    """fitted: pieces in groups; each group's energy counts."""
    start = start_of(numbers)
    low = np.array([LEAST.get(name, 0) for name in FITTED], float)
    high = np.array([MOST[name] for name in FITTED], float)
    first = np.clip([getattr(start, name) for name in FITTED], low + 1e-6, high - 1e-6)
    scale = np.maximum(first, 1e-3)

    def errors(values):
        model = start.with_values(FITTED, values * scale)
        return np.concatenate([relative_errors(model, pieces) for pieces in fitted])

    found = optimize.least_squares(errors, first / scale, bounds=(low / scale, high / scale), xtol=1e-12, ftol=1e-12,
                                   gtol=1e-12, max_nfev=2000)
    return start.with_values(FITTED, found.x * scale)


def identify(numbers, path):
    drive, phase, pieces = read_table(path)
    held, check = pieces.chosen(phase == HOLD), pieces.chosen(phase == CHECK)
    whole = dataclasses.replace(pieces, group=drive.astype(int)).chosen(phase != CHECK)
    model = fit_model(numbers, (held, whole))
    return Result(model, relative_errors(model, whole), relative_errors(model, check))


# ---- What can be learned ---------------------------------------------------------------------------------------------

def deviations():
    """Root mean square of the factors about 1."""
    return np.array([math.sqrt(((high - 1)**3 - (low - 1)**3) / (3 * (high - low))) for low, high in RANGES])


def deviation_of(noise, energies):
    """Of legs about the model, J; noise: J, and share of the energy."""
    return np.hypot(noise[0], noise[1] * energies)


def fit_factors(model, pieces, deviation, noise):
    """Coordinates x of a robot by its legs and by what is usual, and their covariance; factors are 1 + deviation x."""
    measured = pieces.by_group(pieces.energy)
    sigma = deviation_of(noise, measured)

    def errors(x):
        predicted = pieces.by_group(skid_model.energies(model.scaled(1 + deviation * x), pieces))
        return np.concatenate([(predicted - measured) / sigma, x])

    found = optimize.least_squares(errors, np.zeros(skid_model.FACTORS))
    return found.x, np.linalg.inv(found.jac.T @ found.jac)


def fit_noise(totals, squares):
    """Standard deviations: J, and share of the energy; the likeliest of independent ones."""
    parts = np.column_stack([np.ones(len(squares)), totals**2])
    start = np.log(squares.mean() / 2 / parts.mean(axis=0))

    def cost(logarithms):
        variances = parts @ np.exp(logarithms)
        return np.mean(np.log(variances) + squares / variances)

    found = optimize.minimize(cost, start, method="Nelder-Mead", options={"maxiter": 4000, "xatol": 1e-6, "fatol": 1e-10})
    return np.exp(found.x / 2)


@dataclass(frozen=True)
class Route:
    """What a robot that has learned drives, of its legs."""
    measured: np.ndarray
    missed: np.ndarray
    untaught: float   # what the built-in model misses of the whole
    gradient: np.ndarray  # of the whole, by x
    covariance: np.ndarray

    def variance(self, noise):
        """As it is forecast."""
        return np.sum(deviation_of(noise, self.measured)**2) + self.gradient @ self.covariance @ self.gradient


def drive_route(model, lesson, rest, deviation, noise):
    x, covariance = fit_factors(model, lesson, deviation, noise)

    def energies(coordinates):
        return rest.by_group(skid_model.energies(model.scaled(1 + deviation * coordinates), rest))

    measured, step = rest.by_group(rest.energy), 1e-3
    gradient = [(energies(x + step * unit).sum() - energies(x - step * unit).sum()) / (2 * step)
                for unit in np.eye(skid_model.FACTORS)]
    return Route(measured, energies(x) - measured, (energies(0 * x) - measured).sum(), np.array(gradient), covariance)


def learn(model, path):
    """Robots learn from their first legs; what is left on the others is noise."""
    run_, phase, pieces = read_table(path)
    deviation, noise = deviations(), NOISE_START
    robots = [(pieces.chosen((run_ == robot) & (phase < LESSONS)), pieces.chosen((run_ == robot) & (phase >= LESSONS)))
              for robot in np.unique(run_)]
    for _ in range(ROUNDS):
        routes = [drive_route(model, lesson, rest, deviation, noise) for lesson, rest in robots]
        noise = fit_noise(np.concatenate([route.measured for route in routes]),
                          np.concatenate([route.missed for route in routes])**2)
    def surprise(scale):
        """Of routes by what their forecasts say, root mean square, with so much of the noise."""
        scaled = tuple(scale * np.array(noise))
        made = [drive_route(model, lesson, rest, deviation, scaled) for lesson, rest in robots]
        return math.sqrt(np.mean([route.missed.sum()**2 / route.variance(scaled) for route in made]))

    scale = 1.0
    for _ in range(ROUNDS):
        scale *= surprise(scale)
    noise = tuple(scale * np.array(noise))
    alone = np.concatenate([np.abs(route.missed) / deviation_of(noise, route.measured) for route in routes])
    totals = np.array([route.measured.sum() for route in routes])
    return Learning(deviation, float(noise[0]), float(noise[1]), max(float(np.quantile(alone, SURE)) / SURE_DEVIATIONS, 1.0),
                    np.array([route.untaught for route in routes]) / totals,
                    np.array([route.missed.sum() for route in routes]) / totals)


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
    values = [to.q16(factor, value, "", 2**-16, 1) for factor, value in zip(factors, learning.deviation)]
    members = [
        c_tables.Array("deviation", [value.value for value in values],
                       [f"{value.comment} of the {value.name}" for value in values]),
        to.q16("noise_relative", learning.noise_relative, "of the energy", 0, 1),
        to.energy("noise", max(learning.noise, 2.0**(exponent - 16)), "J", 2**-16, 1024, exponent),
        to.q16("spread", learning.spread, "of single legs beyond their noise", 1, 16),
        to.whole("memory", MEMORY, "legs", 8, 1024),
    ]
    members.append(c_tables.Member("identity", f"{identity_of(members)}U", "of the numbers above"))
    note = (f"Over {int(numbers['robots'])} robots routes of 10 legs take {percent(learning.untaught)} % more or less than "
            f"the model says, {percent(learning.taught)} % after\n * {LESSONS} legs.")
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
                   ("routes of other robots, untaught", percent(learning.untaught), f"{100 * np.abs(learning.untaught).max():.3g}"),
                   ("the same, taught", percent(learning.taught), f"{100 * np.abs(learning.taught).max():.3g}")])
    print(f"noise of a leg {learning.noise:.3g} J and {100 * learning.noise_relative:.3g} %, of single ones "
          f"{learning.spread:.3g} times that")


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
    result = identify(numbers, directory / "experiments.csv")
    learning = learn(result.model, directory / "robots.csv")
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
