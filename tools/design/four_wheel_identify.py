#!/usr/bin/env python3
"""Identify the energy model of a robot with four steered wheels from the drives of jp-four-wheel-identify.

The parameters of include/joulepath/four_wheel_energy.h are fitted to the energies of designed motions by least squares of
the relative errors, none below 0; geometry, weight and inertia are those of the robot file. Random motions on slopes that
were not fitted tell how good the model is.

What other grounds, payloads and electronics change are four factors of the model. How far robots with factors of their own
are still from it is the noise of what the robot learns from.

Writes src/tables/four_wheel_energy_<robot>.c and four_wheel_learning_<robot>.c. Exit status 1: the model misses random
motions by more than 10 % on average; 2: bad input. Then nothing was written.
"""
import dataclasses
from dataclasses import dataclass

import numpy as np
from scipy import optimize

from tools.common import run
from tools.design import c_tables, four_wheel_model, identification
from tools.design.identification import SURE, SURE_DEVIATIONS, percent

PROGRAM = "jp-four-wheel-identify"
COLUMNS = ("run", "phase", "x0_m_s", "y0_m_s", "w0_rad_s", "x1_m_s", "y1_m_s", "w1_rad_s", "grade", "bank", "travel_rad", "seconds",
           "energy_j")
NUMBERS = ("wheelbase_m", "track_m", "weight_n", "rolling", "drag_s_m", "felt_mass_kg", "felt_inertia_kg_m2", "efficiency", "copper_w",
           "stiffness_n_s_m", "steering_j_rad", "contact_m", "electronics_w", "seed", "design", "check", "robots")
DESIGN, CHECK = 0, 1  # phases in jp-four-wheel-identify
FITTED = ("rolling", "drag", "cornering", "driving", "braking", "copper_driving", "copper_braking", "steering", "contact",
          "electronics_power")
LEAST = {"driving": 1}
MOST = {"rolling": 0.5, "drag": 1, "cornering": 1, "driving": 10, "braking": 1, "copper_driving": 16384, "copper_braking": 16384,
        "steering": 1024, "contact": 0.5, "electronics_power": 1024}

FITTED_PIECES = 5  # whose energies are added up: what the servos store comes back in that time

# Of the factors about 1, what jp-four-wheel-identify draws: rolling, weight, steering, electronics.
RANGES = ((0.7, 1.5), (0.9, 1.3), (0.6, 1.4), (0.8, 1.2))

LESSONS = 20             # legs of a robot that it learns from
NOISE_START = (1, 0.01)  # J, and share of the energy, of a leg
ROUNDS = 3               # of the noise, which weighs the legs that it is found from


@dataclass(frozen=True)
class Learning:
    """struct jp_factor_learning in SI units."""
    deviation: np.ndarray
    noise: float           # J
    noise_relative: float
    spread: float          # of single legs beyond it
    untaught: np.ndarray   # relative errors of each robot's route, before and after its factors are known
    taught: np.ndarray


def read_table(path):
    """(run, phase, pieces whose groups are the phases of the runs)"""
    (run_, phase, x0, y0, w0, x1, y1, w1, grade, bank, travel, seconds,
     energy) = identification.read_columns(path, COLUMNS, PROGRAM)
    group = identification.groups_of(run_, phase)
    return run_, phase, four_wheel_model.Pieces(seconds, energy, group, np.array([x0, x1]), np.array([y0, y1]), np.array([w0, w1]),
                                                grade, bank, travel)


# ---- The model -------------------------------------------------------------------------------------------------------

def relative_errors(model, pieces):
    return identification.relative_errors(four_wheel_model.energies, model, pieces)


def start_of(numbers):
    """What the robot file says."""
    weight, efficiency = numbers["weight_n"], numbers["efficiency"]
    return four_wheel_model.Model(
        wheelbase=numbers["wheelbase_m"], track=numbers["track_m"], weight=weight, rolling=numbers["rolling"],
        drag=numbers["drag_s_m"], cornering=numbers["felt_mass_kg"]**2 / (4 * numbers["stiffness_n_s_m"] * weight),
        inertia=numbers["felt_mass_kg"] / weight, turn_inertia=numbers["felt_inertia_kg_m2"] / weight, driving=1 / efficiency,
        braking=efficiency, copper_driving=numbers["copper_w"], copper_braking=numbers["copper_w"] * efficiency**4,
        steering=numbers["steering_j_rad"], contact=numbers["contact_m"], electronics_power=numbers["electronics_w"])


def fit_model(numbers, fitted):
    """fitted: pieces in groups; each group's energy counts."""
    parameters = identification.Unknowns(start_of(numbers), FITTED, LEAST, MOST)

    def errors(unknown):
        return np.concatenate([relative_errors(parameters.model(unknown), pieces) for pieces in fitted])

    return parameters.model(identification.least_squares(errors, parameters))


def identify(numbers, path):
    drive, phase, pieces = read_table(path)
    design, check = pieces.chosen(phase == DESIGN), pieces.chosen(phase == CHECK)
    number = np.arange(len(design.group)) // FITTED_PIECES
    short = dataclasses.replace(design, group=np.unique(design.group * len(number) + number, return_inverse=True)[1])
    model = fit_model(numbers, (short, design))
    return identification.Result(model, relative_errors(model, design), relative_errors(model, check))


# ---- What can be learned ---------------------------------------------------------------------------------------------

def deviations():
    return identification.deviations(RANGES)


def deviation_of(noise, energies):
    """Of legs about the model, J; noise: J, and share of the energy."""
    return np.hypot(noise[0], noise[1] * energies)


def fit_factors(model, pieces, deviation, noise):
    """Coordinates x of a robot by its legs and by what is usual; factors are 1 + deviation x."""
    measured = pieces.by_group(pieces.energy)
    sigma = deviation_of(noise, measured)

    def errors(x):
        predicted = pieces.by_group(four_wheel_model.energies(model.scaled(1 + deviation * x), pieces))
        return np.concatenate([(predicted - measured) / sigma, x])

    return optimize.least_squares(errors, np.zeros(four_wheel_model.FACTORS)).x


def fit_noise(totals, squares):
    """Standard deviations: J, and share of the energy; the likeliest of independent ones."""
    parts = np.column_stack([np.ones(len(squares)), totals**2])
    start = np.log(squares.mean() / 2 / parts.mean(axis=0))

    def cost(logarithms):
        variances = parts @ np.exp(logarithms)
        return np.mean(np.log(variances) + squares / variances)

    found = optimize.minimize(cost, start, method="Nelder-Mead", options={"maxiter": 4000, "xatol": 1e-6, "fatol": 1e-10})
    return np.exp(found.x / 2)


def missed_by(model, pieces):
    """Of each leg, J."""
    return pieces.by_group(four_wheel_model.energies(model, pieces) - pieces.energy)


def learn(model, path):
    """Robots learn from their first legs; what is left on the others is noise."""
    run_, phase, pieces = read_table(path)
    deviation, noise = deviations(), NOISE_START
    robots = [(pieces.chosen((run_ == robot) & (phase < LESSONS)), pieces.chosen((run_ == robot) & (phase >= LESSONS)))
              for robot in np.unique(run_)]
    measured = [rest.by_group(rest.energy) for _, rest in robots]
    for _ in range(ROUNDS):
        missed = [missed_by(model.scaled(1 + deviation * fit_factors(model, lesson, deviation, noise)), rest)
                  for lesson, rest in robots]
        noise = fit_noise(np.concatenate(measured), np.concatenate(missed)**2)
    alone = np.abs(np.concatenate(missed)) / deviation_of(noise, np.concatenate(measured))
    totals = np.array([legs.sum() for legs in measured])
    return Learning(deviation, float(noise[0]), float(noise[1]), max(float(np.quantile(alone, SURE)) / SURE_DEVIATIONS, 1.0),
                    np.array([missed_by(model, rest).sum() for _, rest in robots]) / totals,
                    np.array([legs.sum() for legs in missed]) / totals)


# ---- Tables ----------------------------------------------------------------------------------------------------------

def energy_table(name, result, exponent, numbers):
    to, model = c_tables.Converter(f"energy model of {name}"), result.model
    members = [
        to.q24("wheelbase", model.wheelbase, "m", 0.05, 4),
        to.q24("track", model.track, "m", 0.05, 4),
        to.q16("weight", model.weight, "N", 1, 16384),
        to.q24("rolling", model.rolling, "", 0, 0.5),
        to.q24("drag", model.drag, "s/m", 0, 1),
        to.q24("cornering", model.cornering, "s³/m²", 0, 1),
        to.q24("inertia", model.inertia, "s²/m", 0, 8),
        to.q24("turn_inertia", model.turn_inertia, "s²·m", 0, 8),
        to.q24("driving", model.driving, "", 1, 10),
        to.q24("braking", model.braking, "", 0, 1),
        to.q16("copper_driving", model.copper_driving, "W", 0, 16384),
        to.q16("copper_braking", model.copper_braking, "W", 0, 16384),
        to.q16("steering", model.steering, "J/rad", 0, 1024),
        to.q24("contact", model.contact, "m", 0, 0.5),
        to.q16("electronics_power", model.electronics_power, "W", 0, 1024),
        identification.energy_exponent(exponent),
    ]
    note = (f"Mean error {percent(result.fit)} % of what {int(numbers['design'])} designed drives take, "
            f"{percent(result.check)} % of {int(numbers['check'])} random ones.")
    return c_tables.Table(f"make identify ROBOT={name}", f"sim/robots/{name}.cfg", note, "joulepath/four_wheel_energy.h",
                          "jp_four_wheel_energy_model", f"jp_four_wheel_energy_{name}", members)


def learning_table(name, learning, exponent, numbers):
    to = c_tables.Converter(f"learning of {name}")
    members = identification.factor_members(to, ("rolling", "weight", "steering", "electronics"), learning, exponent)
    members.append(identification.identity_of(members))
    note = (f"Over {int(numbers['robots'])} robots routes of 10 legs take {percent(learning.untaught)} % more or less than "
            f"the model says, {percent(learning.taught)} % after\n * {LESSONS} legs.")
    return c_tables.Table(f"make identify ROBOT={name}", f"sim/robots/{name}.cfg", note, "joulepath/factor_learning.h",
                          "jp_factor_learning", f"jp_four_wheel_learning_{name}", members)


def main():
    options = identification.arguments(__doc__, PROGRAM)
    name, directory = identification.input_of(options)
    numbers = identification.read_numbers(directory / "experiments.json", name, NUMBERS)
    result = identify(numbers, directory / "experiments.csv")
    learning = learn(result.model, directory / "robots.csv")
    identification.show(result, learning, four_wheel_model.NAMES)
    print(f"noise of a leg {learning.noise:.3g} J and {100 * learning.noise_relative:.3g} %, of single ones "
          f"{learning.spread:.3g} times that")
    identification.write_errors(directory, result, learning)
    identification.refuse_what_misses(result, directory, "look at the robot file's drive and steering")
    exponent = identification.unit_exponent(result.model)
    identification.write_tables(options.tables, {f"four_wheel_energy_{name}": energy_table(name, result, exponent, numbers),
                                                 f"four_wheel_learning_{name}": learning_table(name, learning, exponent, numbers)})
    return 0


if __name__ == "__main__":
    run(main)
