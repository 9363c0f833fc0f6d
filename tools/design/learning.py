#!/usr/bin/env python3
"""Make the tables of what a robot can learn about its energy (struct jp_learning), for both definitions of energy.

Robots of a kind are drawn with other ground friction, payload, motor resistance and motor friction. Each drives the same
chains of segments under the controller of the robot file. How far the energies then move the 15 parameters of the energy
model spans few directions; what is left is noise. Legs of trajectories have transients and noise of their own, which
jp-trip drives in the simulator. Writes src/tables/learning_<robot>.c and learning_<robot>_battery.c, and draws what is left
when all is learned: build/learning/learning_<robot>.png. Exit status 1: too much is left; 2: bad input. Then no table was written.
"""
import math
import re
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import optimize

from tools.common import ROOT, ArgumentParser, ToolError, Verdict, print_aligned, read_text, run, shown_path, write_whole
from tools.design import c_tables, closed_loop, horizon, learning_legs, linear_model, robot_json
from tools.report import plots

DIRECTIONS = 4   # JP_LEARNING_DIRECTIONS
PARAMETERS = 15  # JP_ENERGY_PARAMETERS
NAMES = (*(f"a{i}" for i in range(1, 14)), "b1", "b2")

# The population: factors of the robot file's numbers. Its payload is the robot file's.
GROUND_FACTOR = (0.6, 1.6)
RESISTANCE_FACTOR = (0.92, 1.12)
MOTOR_FRICTION_FACTOR = (0.8, 1.25)
POPULATION = 150
SEED = 1

# What is driven: chains from standing.
CHAINS = 50
CHAIN_SEGMENTS = 20
SHORT_SHARE = 0.75
SHORT_SECONDS = (horizon.DURATION_MIN, 10)
LONG_SECONDS = (10, 60)
STRAIGHT_SHARE = 0.25  # of segments without a turn rate, and of those without a turn

# Segments after which a measurement counts 1/e.
MEMORY = 64

# Of the identified model against the simulated robot, as `make identify` tells.
MODEL_ERROR = 0.003

# Segments that take less than this share of the mean count by that.
SMALL_SHARE = 0.01

# Of whole chains when all is learned; robots of the project leave 0.2 to 0.4 %.
CHAIN_ERROR_MAX = 0.03
SURPRISE_MAX = 4.0  # standard deviations in the picture

# Directions that matter less to the energy are rounding.
SMALLEST_SHARE = 1e-7

FORMAT_MAX = 4096
LEG_MAX = 256
LEG_WORDING = ["of what speeding up takes by the steady voltage", "of what changes of the speed take",
               "of what turning faster takes by the steady voltage"]


@dataclass(frozen=True)
class Member:
    """A robot of the population."""
    robot: robot_json.Robot
    ground: float   # relative change of the ground's friction
    payload: float  # kg


@dataclass(frozen=True)
class Segments:
    """Of several chains, one after the other; `first` marks those that begin at rest."""
    speed: np.ndarray
    turn_rate: np.ndarray
    turn: np.ndarray
    seconds: np.ndarray
    first: np.ndarray

    def __len__(self):
        return len(self.seconds)

    def before(self, values):
        """Of the segment before; 0 at rest."""
        return np.where(self.first, 0, np.roll(values, 1))

    def side_by_side(self):
        """The first ones of all chains, then the second ones, and so on."""
        numbers = np.arange(len(self))
        places = numbers - np.maximum.accumulate(np.where(self.first, numbers, 0))
        return (np.flatnonzero(places == place) for place in range(places.max() + 1))


@dataclass(frozen=True)
class Reference:
    """The robot of the file on the segments: energies, and what multiplies the parameters of its model."""
    energies: np.ndarray    # J of the motors
    totals: np.ndarray      # J, electronics included
    transients: np.ndarray  # J that earlier steps add
    regressors: np.ndarray  # segments × PARAMETERS


@dataclass(frozen=True)
class Learning:
    """struct jp_learning in SI units."""
    direction: np.ndarray  # PARAMETERS × DIRECTIONS
    ground: np.ndarray
    payload: np.ndarray
    ground_deviation: float
    payload_deviation: float
    noise_relative: float
    noise_transient: float
    noise: float
    leg: np.ndarray        # learning_legs.TRANSIENTS × DIRECTIONS
    leg_noise_relative: float
    leg_noise_transient: float
    leg_noise: float
    leg_spread: float      # of single legs beyond it


@dataclass(frozen=True)
class Quality:
    """Over the population, shares of the energy."""
    untaught: np.ndarray   # mean errors of the robot file's model by segment, of each robot
    segment: np.ndarray    # with x known
    chain: np.ndarray      # the same, of whole chains
    shares: np.ndarray     # that each direction moves, root mean square
    surprises: np.ndarray  # of routes of robots that learned, by what their forecasts say; standard deviations


def draw_segments(robot, generator):
    count = CHAINS * CHAIN_SEGMENTS
    turn_rate = robot.positive("limits.turn_rate_rad_s")
    turn = math.radians(robot.number("limits.turn_deg"))

    def straight(values):
        return np.where(generator.uniform(size=count) < STRAIGHT_SHARE, 0, values)

    seconds = np.where(generator.uniform(size=count) < SHORT_SHARE, generator.uniform(*SHORT_SECONDS, count),
                       generator.uniform(*LONG_SECONDS, count))
    return Segments(generator.uniform(0, robot.positive("limits.speed_m_s"), count),
                    straight(generator.uniform(-turn_rate, turn_rate, count)),
                    straight(generator.uniform(-turn, turn, count)), np.round(seconds, 3),
                    np.arange(count) % CHAIN_SEGMENTS == 0)


def draw_member(robot, generator):
    ground, resistance, friction = (generator.uniform(*factor) for factor in (
        GROUND_FACTOR, RESISTANCE_FACTOR, MOTOR_FRICTION_FACTOR))
    return member_of(robot, ground, generator.uniform(*robot.numbers("limits.payload_kg", 2)), resistance, friction)


def member_of(robot, ground, payload, resistance, friction):
    return Member(robot.varied({
        "ground.friction_nm_s_per_rad": ground * robot.number("ground.friction_nm_s_per_rad"),
        "body.mass_kg": robot.positive("body.mass_kg") + payload,
        "motor.resistance_ohm": resistance * robot.positive("motor.resistance_ohm"),
        "motor.friction_nm_s_per_rad": friction * robot.number("motor.friction_nm_s_per_rad"),
    }), ground - 1, payload)


class _Drive:
    """The states of an axis over the segments: those that the one before left, and those at either end."""

    def __init__(self, axis, segments):
        values, vectors = np.linalg.eig(axis.matrix)
        speed, turn = ((segments.speed, np.zeros(len(segments))) if axis.name == "travel"
                       else (segments.turn_rate, segments.turn))
        self.speed = speed
        self.jump = np.outer(turn, axis.turn) - np.outer(speed - segments.before(speed), axis.steady)
        covectors = np.linalg.inv(vectors)
        jumps = self.jump @ covectors.T
        decay = values.astype(complex)**np.round(segments.seconds * axis.rate_hz)[:, None]
        left, before = np.zeros_like(decay), np.zeros_like(decay)
        for own in segments.side_by_side():
            before[own] = np.where(segments.first[own, None], 0, left[own - 1])
            left[own] = decay[own] * (before[own] + jumps[own])
        self.before = (before @ vectors.T).real
        self.end = ((decay * (before + jumps)) @ vectors.T).real

    def stored(self, energy, states):
        return np.einsum("ki,ij,kj->k", states, energy.form, states) + self.speed * (states @ energy.linear)


def drive(axes, segments, definition, resistance):
    """Energies of the motors, J, and what of them the transients of earlier steps are."""
    energies, transients = np.zeros(len(segments)), np.zeros(len(segments))
    for axis in axes:
        energy, driven = closed_loop.energy(axis, definition, resistance), _Drive(axis, segments)
        left = driven.stored(energy, driven.end)
        spent = driven.stored(energy, driven.before + driven.jump) - left
        energies += spent + energy.power * driven.speed**2 * segments.seconds
        transients += spent - driven.stored(energy, driven.jump)
    return energies, transients


@dataclass(frozen=True)
class BuiltIn:
    """What the regressors and the tables take from the identified model."""
    settling_time: float
    voltage_per_speed: float
    voltage_per_turn_rate: float
    motor_resistance: float
    unit_exponent: int  # of the energies in the table


def read_built_in(path):
    text = read_text(path)

    def number(name):
        found = re.search(rf"\.{name} = (-?\d+),", text)
        if not found:
            raise ToolError(f"{path}: {name} is missing; run make identify")
        return int(found[1])

    settling, per_speed, per_turn_rate, resistance, exponent = map(number, BuiltIn.__dataclass_fields__)
    return BuiltIn(settling / 2**16, per_speed / 2**16, per_turn_rate / 2**16, resistance / 2**(16 + exponent), exponent)


def regressors(segments, model):
    """What multiplies a1…a13 and b1, b2."""
    v, w, sigma = segments.speed, segments.turn_rate, segments.turn
    v0, w0 = segments.before(v), segments.before(w)
    dv, dw = v - v0, w - w0
    left = model.voltage_per_speed * v0 - model.voltage_per_turn_rate * w0
    right = model.voltage_per_speed * v0 + model.voltage_per_turn_rate * w0
    rest = segments.seconds - model.settling_time
    return np.column_stack([dv**2, dw**2, sigma**2, dv * dw, dv * sigma, dw * sigma, left * dv, left * dw, left * sigma,
                            right * dv, right * dw, right * sigma, (left**2 + right**2) / model.motor_resistance,
                            v**2 * rest,
                            w**2 * rest])


# The robot is symmetric: a4 = a5 = 0, a10 = a7, a11 = −a8, a12 = −a9; a column for each number that is free.
SYMMETRY = np.zeros((PARAMETERS, 10))
for _column, _signs in enumerate(({1: 1}, {2: 1}, {3: 1}, {6: 1}, {7: 1, 10: 1}, {8: -1, 11: 1}, {9: -1, 12: 1}, {13: 1},
                                  {14: 1}, {15: 1})):
    for _parameter, _sign in _signs.items():
        SYMMETRY[_parameter - 1, _column] = _sign


def reference_of(robot, axes, segments, definition, model):
    energies, transients = drive(axes, segments, definition, robot.positive("motor.resistance_ohm"))
    totals = energies + segments.seconds * robot.positive("electronics.power_w")
    # What braking gives back may be all that a segment takes.
    totals = np.maximum(totals, SMALL_SHARE * totals.mean())
    return Reference(energies, totals, transients, regressors(segments, model))


def signed(vectors):
    """Columns whose largest element is positive: the sign of a direction is free."""
    largest = np.abs(vectors).argmax(axis=0)
    return np.sign(vectors[largest, np.arange(vectors.shape[1])])


def find_directions(robot, reference, changes):
    """Directions of the parameters, how far each member is along them, and the share of the energy that each moves.

    changes: members × segments, J. The segments count relative to their energy."""
    weights = 1 / reference.totals
    basis = (reference.regressors @ SYMMETRY) * weights[:, None]
    fitted = basis @ np.linalg.lstsq(basis, changes.T * weights[:, None], rcond=None)[0]
    count, members = fitted.shape
    left, singular, right = np.linalg.svd(fitted / math.sqrt(count * members), full_matrices=False)
    if not singular[DIRECTIONS - 1] > SMALLEST_SHARE:
        raise robot.error("ground, motor", f"the population spans fewer than {DIRECTIONS} directions of the parameters")
    moved = math.sqrt(count) * left[:, :DIRECTIONS] * singular[:DIRECTIONS]
    directions = np.linalg.lstsq(basis, moved, rcond=None)[0]
    signs = signed(moved)
    return (SYMMETRY @ directions) * signs, math.sqrt(members) * right[:DIRECTIONS].T * signs, singular[:DIRECTIONS]


def fit_noise(totals, transients, squares):
    """Standard deviations: J, share of the energy, share of the transients; the likeliest of independent ones."""
    parts = np.column_stack([np.ones(len(squares)), totals**2, transients**2])
    start = np.log(squares.mean() / 3 / parts.mean(axis=0))

    def cost(logarithms):
        variances = parts @ np.exp(logarithms)
        return np.mean(np.log(variances) + squares / variances)

    found = optimize.minimize(cost, start, method="Nelder-Mead",
                              options={"maxiter": 4000, "maxfev": 4000, "xatol": 1e-6, "fatol": 1e-10})
    return np.exp(found.x / 2)


def coordinates(reference, directions, changes):
    """x of robots whose segments take so much more."""
    basis = reference.regressors @ directions / reference.totals[:, None]
    return np.linalg.lstsq(basis, (changes / reference.totals).T, rcond=None)[0].T


def learn(robot, segments, reference, energies, of_legs, causes_of_legs):
    """The table, and how good it is.

    of_legs: from directions to rows and noise of legs, and what they teach; causes_of_legs: of its robots."""
    changes = energies - reference.energies
    directions, x, shares = find_directions(robot, reference, changes)
    lesson = of_legs(directions)
    residuals = changes - x @ (reference.regressors @ directions).T
    noise, relative, transient = fit_noise(reference.totals, reference.transients, np.mean(residuals**2, axis=0))

    def cause(values):
        coefficients = np.linalg.lstsq(lesson.taught, values, rcond=None)[0]
        freedom = len(values) - lesson.taught.shape[1]
        return coefficients, float(np.sqrt(np.sum((values - lesson.taught @ coefficients)**2) / freedom))

    causes = np.array(causes_of_legs)
    ground, ground_deviation = cause(causes[:, 0] - 1)
    payload, payload_deviation = cause(causes[:, 1])
    chains = np.cumsum(segments.first) - 1

    def by_chain(values):
        return np.add.reduceat(values, np.flatnonzero(np.diff(chains, prepend=-1)), axis=-1)

    def mean(errors):
        return np.mean(np.abs(errors), axis=1)

    quality = Quality(mean(changes / reference.totals), mean(residuals / reference.totals),
                      mean(by_chain(residuals) / by_chain(reference.totals)), shares, lesson.surprises)
    return Learning(directions, ground, payload, ground_deviation, payload_deviation, math.hypot(relative, MODEL_ERROR),
                    float(transient), float(noise), lesson.rows, float(lesson.noise[1]), float(lesson.noise[2]),
                    float(lesson.noise[0]), lesson.spread), quality


def c_table(robot, definition, learning, quality, exponent):
    """In units of 2^exponent J, as the energy model is."""
    to = c_tables.Converter(robot.source)
    units = (*c_tables.STATE_UNITS, *c_tables.STEADY_UNITS)
    smallest = 2.0**(exponent - 16)  # J: a noise of 0 would be certain

    def row(name, values, unit, limit, of_row=0):
        members = [to.energy(name, value, unit, -limit, limit, of_row) for value in values]
        return "{" + ", ".join(member.value for member in members) + "}"

    def column(name, values, unit):
        members = [to.q16(name, value, unit, -FORMAT_MAX, FORMAT_MAX) for value in values]
        return c_tables.Array(name, [m.value for m in members], [m.comment for m in members])

    members = [
        c_tables.Array("direction", [row(f"direction {number}", values, units[number], FORMAT_MAX, of_row)
                                     for number, (values, of_row) in enumerate(zip(
                                         learning.direction, c_tables.parameter_exponents(exponent)))],
                       [f"{name}: {unit}" for name, unit in zip(NAMES, units)]),
        column("ground", learning.ground, "of the friction"),
        column("payload", learning.payload, "kg"),
        to.q16("ground_deviation", learning.ground_deviation, "of the friction", 2**-16, 1),
        to.q16("payload_deviation", learning.payload_deviation, "kg", 2**-16, 16),
        to.q16("noise_relative", learning.noise_relative, "of the energy", 0, 1),
        to.q16("noise_transient", learning.noise_transient, "of what earlier steps left", 0, 16),
        to.energy("noise", max(learning.noise, smallest), "J", 2**-16, 1024, exponent),
        c_tables.Array("leg", [row("leg", values, "of it", LEG_MAX) for values in learning.leg], LEG_WORDING),
        to.q16("leg_noise_relative", learning.leg_noise_relative, "of the energy", 0, 1),
        to.q16("leg_noise_transient", learning.leg_noise_transient, "of what its transients take", 0, 16),
        to.energy("leg_noise", max(learning.leg_noise, smallest), "J", 2**-16, 1024, exponent),
        to.q16("leg_spread", learning.leg_spread, "of single legs beyond their noise", 1, 16),
        to.whole("memory", MEMORY, "segments", 8, 1024),
    ]
    members.append(c_tables.Member("identity", f"{identity_of(members)}U", "of the numbers above"))
    suffix = horizon.SUFFIXES[definition]
    shares = ", ".join(f"{100 * share:.2g}" for share in quality.shares)
    note = (f"Energy {horizon.WORDING[definition]}. Over {POPULATION} robots the directions move it by {shares} %.\n"
            f" * Mean errors: {100 * quality.untaught.mean():.2g} % of a segment untaught; taught {100 * quality.segment.mean():.2g} %, "
            f"and {100 * quality.chain.mean():.2g} % of {CHAIN_SEGMENTS} segments.")
    return c_tables.Table(f"make learning ROBOT={robot.name}", f"sim/robots/{robot.name}.cfg", note, "joulepath/learner.h",
                          "jp_learning", f"jp_learning_{robot.name}{suffix}", members)


def identity_of(members):
    """A state that was learned with other numbers means nothing with these."""
    numbers = [value for member in members
               for value in (member.values if isinstance(member, c_tables.Array) else [member.value])]
    return zlib.crc32(",".join(numbers).encode()) or 1


def make_tables(robot, tables, drive_legs):
    """{definition: (Learning, Quality, exponent of the unit)}; `tables` holds the identified models.

    drive_legs(definition): gives learning_legs.Legs."""
    models = {definition: read_built_in(tables / f"energy_{robot.name}{suffix}.c")
              for definition, suffix in horizon.SUFFIXES.items()}
    generator = np.random.default_rng(SEED)
    gains = linear_model.design(robot).gains
    segments = draw_segments(robot, generator)
    members = [draw_member(robot, generator) for _ in range(POPULATION)]
    loops = [closed_loop.axes(member.robot, gains) for member in members]
    nominal, resistance = closed_loop.axes(robot, gains), robot.positive("motor.resistance_ohm")
    for member, axes in zip(members, loops):
        if max(np.abs(np.linalg.eigvals(axis.matrix)).max() for axis in axes) >= 1:
            raise robot.error("control.weights", f"the loop is unstable with {member.payload:.2g} kg of payload and "
                                                 f"{1 + member.ground:.2g} times the ground's friction")
    made = {}
    for definition, model in models.items():
        legs = drive_legs(definition)
        leg_loops = [closed_loop.axes(member_of(robot, *causes).robot, gains) for causes in legs.causes]
        reference = reference_of(robot, nominal, segments, definition, model)

        def energies_of(robots):
            return np.array([drive(axes, segments, definition, resistance)[0] for axes in robots])

        def of_legs(directions):
            x = coordinates(reference, directions, energies_of(leg_loops) - reference.energies)
            return learning_legs.learn(legs, directions, x, MEMORY, fit_noise)

        made[definition] = (*learn(robot, segments, reference, energies_of(loops), of_legs, legs.causes),
                            model.unit_exponent)
    return made


def print_tables(robot, tables):
    print(f"{robot.name}: {POPULATION} robots on {CHAINS} chains of {CHAIN_SEGMENTS} segments\n")
    rows = [("energy", "before, %", "segment, %", "chain, %", "noise, J", "of energy, %", "of transients", "ground ±",
             "payload ±, kg", "leg noise, J", "of energy, %", "of transients")]
    for definition, (learning, quality, _) in tables.items():
        rows.append((definition, *(f"{100 * share.mean():.3f}" for share in (quality.untaught, quality.segment, quality.chain)),
                     f"{learning.noise:.3f}", f"{100 * learning.noise_relative:.3f}", f"{learning.noise_transient:.3f}",
                     f"{learning.ground_deviation:.3f}", f"{learning.payload_deviation:.3f}", f"{learning.leg_noise:.3f}",
                     f"{100 * learning.leg_noise_relative:.3f}", f"{learning.leg_noise_transient:.3f}"))
    print_aligned(rows)
    print()


def check_quality(robot, definition, quality):
    chain = quality.chain.mean()
    if not chain <= CHAIN_ERROR_MAX:
        raise Verdict(f"{robot.source}: limits: robots with other ground, payload and motors miss the {definition}'s energy of "
                      f"whole drives by {100 * chain:.2g} % when all is learned, at most {100 * CHAIN_ERROR_MAX:g} % is "
                      "accepted; a smaller limits.payload_kg, or lower limits.speed_m_s")


def draw(robot, qualities):
    """How much is left when all is learned, and how true forecasts of routes are; qualities: by definition."""
    figure, (errors, routes) = plots.new_figure(9.5, 3.8, columns=2)
    edges, tallest = np.linspace(-SURPRISE_MAX, SURPRISE_MAX, 17), 0
    for (definition, quality), colour in zip(qualities.items(), (plots.BLUE, plots.ORANGE)):
        for values, style, name in ((quality.untaught, ":", "as of the file"), (quality.chain, "-", "all learned")):
            errors.plot(np.sort(100 * values), 100 * np.arange(1, len(values) + 1) / len(values), style, color=colour,
                        label=f"{definition}, {name}")
        counts, *_ = routes.hist(np.clip(quality.surprises, -SURPRISE_MAX, SURPRISE_MAX), bins=edges, color=colour,
                                 histtype="step", linewidth=1.6, label=f"energy of the {definition}")
        tallest = max(tallest, counts.max())
    errors.set(xscale="log", ylim=(0, 100), xlabel="mean error of the energy, %", ylabel="robots within it, %",
               title=f"{POPULATION} robots like {robot.name}")
    errors.legend(loc="upper left")
    middle = (edges[1:] + edges[:-1]) / 2
    normal = np.exp(-middle**2 / 2) / math.sqrt(math.tau) * learning_legs.ROBOTS * (edges[1] - edges[0])
    routes.plot(middle, normal, color=plots.GREY, label="as many if forecasts say the truth")
    routes.set(xlabel="driven beyond the forecast, standard deviations", ylabel="routes", ylim=(0, 1.5 * tallest),
               title=f"Routes of {learning_legs.ROBOTS} robots that learned")
    routes.legend(loc="upper left")
    return plots.png_bytes(figure)


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots")
    parser.add_argument("--jp-robot", metavar="PATH", help="the program (default: build/bin/jp-robot)")
    parser.add_argument("--robot-json", metavar="FILE", help="output of jp-robot --json=-, instead of running it")
    parser.add_argument("--jp-trip", metavar="PATH", type=Path, default=robot_json.build_directory() / "bin" / "jp-trip",
                        help="the program that drives legs (default: build/bin/jp-trip)")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C files go (default: src/tables)")
    parser.add_argument("--models", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the identified models energy_*.c are (default: src/tables)")
    parser.add_argument("--pictures", metavar="DIR", type=Path, default=robot_json.build_directory() / "learning",
                        help="where the picture goes (default: build/learning)")
    return parser.parse_args()


def main():
    options = arguments()
    robot = (robot_json.load_json(options.robot_json) if options.robot_json
             else robot_json.load(robot_json.robot_path(options.robot), options.jp_robot))
    tables = make_tables(robot, options.models,
                         lambda definition: learning_legs.drive(options.jp_trip, robot_json.robot_path(options.robot),
                                                                definition))
    print_tables(robot, tables)
    picture = options.pictures / f"learning_{robot.name}.png"
    write_whole(picture, draw(robot, {definition: quality for definition, (_, quality, _) in tables.items()}))
    print(f"wrote {shown_path(picture)}")
    for definition, (_, quality, _) in tables.items():
        check_quality(robot, definition, quality)
    for definition, (learning, quality, exponent) in tables.items():
        path = options.tables / f"learning_{robot.name}{horizon.SUFFIXES[definition]}.c"
        write_whole(path, c_tables.render(c_table(robot, definition, learning, quality, exponent)))
        print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
