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
import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from tools.common import ToolError, run
from tools.design import c_tables, identification, skid_learning, skid_model
from tools.design.identification import percent, relative

PROGRAM = "jp-skid-identify"
COLUMNS = ("run", "phase", "v0_m_s", "w0_rad_s", "v1_m_s", "w1_rad_s", "grade", "bank", "seconds", "energy_j")
NUMBERS = ("width_m", "half_track_m", "weight_n", "friction", "felt_mass_kg", "felt_inertia_kg_m2", "electronics_w",
           "efficiency", "ohm_per_newton_squared", "seed", "design", "check", "robots")
HOLD, CHECK = 1, 3  # phases in jp-skid-identify: steady motion, random motions
FITTED = ("half_track", "rolling", "turning", "yielding", "scrub", "easing", "bank_easing", "tilting", "driving", "braking", "copper_driving",
          "copper_braking", "electronics_power")
LEAST = {"half_track": 0.01, "driving": 1}
MOST = {"half_track": 4, "rolling": 0.5, "turning": 4, "yielding": 16, "scrub": 4, "easing": 4, "bank_easing": 4, "tilting": 4, "driving": 10, "braking": 1,
        "copper_driving": 16384, "copper_braking": 16384, "electronics_power": 1024}

FITTED_ROBOTS = 20
USUAL_ERROR = 0.02  # of what a leg takes, for how unlikely the factors of a robot may be
STEP = 1e-6         # of derivatives, of what an unknown is, or of 1


def read_table(path):
    """(run, phase, pieces whose groups are the phases of the runs)"""
    run_, phase, v0, w0, v1, w1, grade, bank, seconds, energy = identification.read_columns(path, COLUMNS, PROGRAM)
    group = identification.groups_of(run_, phase)
    return run_, phase, skid_model.Pieces(seconds, energy, group, np.array([v0, v1]), np.array([w0, w1]), grade, bank)


# ---- The model -------------------------------------------------------------------------------------------------------

def relative_errors(model, pieces):
    return identification.relative_errors(skid_model.energies, model, pieces)


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


def derivative(function, unknown, which):
    """By one unknown, or by several that move together: central, since one side's rounding would end the fit anywhere."""
    step = np.zeros(unknown.size)
    step[which] = STEP * max(1, np.abs(unknown[which]).max())
    return (function(unknown + step) - function(unknown - step)) / (2 * step.max())


@dataclass(frozen=True)
class Fit:
    """Unknown are the parameters of FITTED, and of each robot the coordinates x of skid_learning.py."""
    parameters: identification.Unknowns
    fitted: tuple  # pieces in groups, each of whose energies counts
    robots: skid_learning.Legs

    def model(self, unknown):
        return self.parameters.model(unknown)

    def of_robots(self, unknown):
        x = unknown[len(FITTED):].reshape(-1, skid_model.FACTORS)
        return relative(self.robots.energies(self.model(unknown), skid_learning.factors(x)), self.robots.measured)

    def errors(self, unknown):
        model = self.model(unknown)
        return np.concatenate([*(relative_errors(model, pieces) for pieces in self.fitted), self.of_robots(unknown).ravel(),
                               USUAL_ERROR * unknown[len(FITTED):]])

    def jacobian(self, unknown):
        """Robots do not depend on each other: one step moves a factor of all of them."""
        columns = np.zeros((self.errors(unknown).size, unknown.size))
        for i in range(len(FITTED)):
            columns[:, i] = derivative(self.errors, unknown, i)
        count, legs = self.robots.shape
        first = len(columns) - self.robots.measured.size - count * skid_model.FACTORS
        for factor in range(skid_model.FACTORS):
            change = derivative(self.of_robots, unknown, slice(len(FITTED) + factor, None, skid_model.FACTORS))
            for robot in range(count):
                column = len(FITTED) + robot * skid_model.FACTORS + factor
                columns[first + robot * legs:first + (robot + 1) * legs, column] = change[robot]
                columns[column - unknown.size, column] = USUAL_ERROR
        return columns


def fit_model(numbers, fitted, robots):
    fit = Fit(identification.Unknowns(start_of(numbers), FITTED, LEAST, MOST), fitted, robots)
    free = robots.shape[0] * skid_model.FACTORS
    return fit.model(identification.least_squares(fit.errors, fit.parameters, fit.jacobian, free))


def identify(numbers, path, robots):
    drive, phase, pieces = read_table(path)
    held, check = pieces.chosen(phase == HOLD), pieces.chosen(phase == CHECK)
    whole = dataclasses.replace(pieces, group=drive.astype(int)).chosen(phase != CHECK)
    model = fit_model(numbers, (held, whole), robots)
    return identification.Result(model, relative_errors(model, whole), relative_errors(model, check))


def read_robots(path):
    """Legs of the robots that are fitted, and of the others."""
    run_, phase, pieces = read_table(path)

    def legs(which):
        if not which.any():
            raise ToolError(f"{path}: robots: there must be more than {FITTED_ROBOTS}")
        return skid_learning.legs_of(run_[which], phase[which], pieces.chosen(which))

    return legs(run_ < FITTED_ROBOTS), legs(run_ >= FITTED_ROBOTS)


# ---- Tables ----------------------------------------------------------------------------------------------------------

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
        identification.energy_exponent(exponent),
    ]
    note = (f"Mean error {percent(result.fit)} % of what {int(numbers['design'])} designed drives take, "
            f"{percent(result.check)} % of {int(numbers['check'])} random motions.")
    return c_tables.Table(f"make identify ROBOT={name}", f"sim/robots/{name}.cfg", note, "joulepath/skid_energy.h",
                          "jp_skid_energy_model", f"jp_skid_energy_{name}", members)


def learning_table(name, learning, exponent, numbers):
    to = c_tables.Converter(f"learning of {name}")
    factors = identification.factor_members(to, ("rolling", "friction", "weight", "electronics"), learning, exponent)
    slopes = to.q16("noise_slopes", learning.noise_slopes, "of the work of slopes", 0, 1)
    members = [c_tables.Group("factors", [*factors, identification.identity_of([*factors, slopes])]), slopes]
    note = (f"Of {int(numbers['robots']) - FITTED_ROBOTS} robots, routes take {percent(learning.untaught)} % more or less "
            f"than the model says, {percent(learning.taught)} % after\n * learning from two others.")
    return c_tables.Table(f"make identify ROBOT={name}", f"sim/robots/{name}.cfg", note, "joulepath/skid_learner.h",
                          "jp_skid_learning", f"jp_skid_learning_{name}", members)


def main():
    options = identification.arguments(__doc__, PROGRAM)
    name, directory = identification.input_of(options)
    numbers = identification.read_numbers(directory / "experiments.json", name, NUMBERS)
    fitted, others = read_robots(directory / "robots.csv")
    result = identify(numbers, directory / "experiments.csv", fitted)
    learning = skid_learning.learn(result.model, others)
    identification.show(result, learning, skid_model.NAMES)
    print(f"noise of a leg {learning.noise:.3g} J, {100 * learning.noise_relative:.3g} % of its energy and "
          f"{100 * learning.noise_slopes:.3g} % of the work of its slopes, of single ones {learning.spread:.3g} times that; "
          f"{100 * learning.inside:.3g} % inside")
    identification.write_errors(directory, result, learning)
    identification.refuse_what_misses(result, directory, "lower limits.speed_m_s or limits.slope_deg")
    exponent = identification.unit_exponent(result.model)
    identification.write_tables(options.tables, {f"skid_energy_{name}": energy_table(name, result, exponent, numbers),
                                                 f"skid_learning_{name}": learning_table(name, learning, exponent, numbers)})
    return 0


if __name__ == "__main__":
    run(main)
