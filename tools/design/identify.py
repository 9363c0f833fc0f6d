#!/usr/bin/env python3
"""Identify the energy model of a robot from the experiments of jp-identify.

Least squares for a1…a13 and b1, b2 (paper eq. 12–19) on 70 % of the experiments, validation on the rest.

The paper fits b on the energy after the settling time and a on the energy before it. What is left of the transient then
goes into b, and the split matters. Here b is the power of the last second, with terms beside v², w² that take up what is
left of the transient, and a fits the whole segment's energy less b (T − Ts): Ts only names where the line starts.

Noise of the sensors shakes the motors, with a power that v² and w² do not tell: a constant, which comes to that of the
electronics.

The energy is that of the motors as the paper defines it, (ul² + ur²)/Rm, or what the battery gives them, ul il + ur ir.
The model takes the power before the segment as P₋ = (ul₋² + ur₋²)/Rm, which is not what the battery sees. Its model has
*effective* voltages instead, whose squares are the steady power: 2 cv²/Rm = b1 and 2 cw²/Rm = b2, so that a13 = Ts as in
the paper's.

Writes src/tables/energy_<robot>.c or energy_<robot>_battery.c, and identification.json and identification.png beside
the experiments, of the battery with _battery in their names. Exit status 1: the model misses the validation by more than
3 % on average; 2: bad input. Then nothing was written but the picture of a model that misses.
"""
import csv
import io
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import linalg, optimize

from tools.common import ROOT, ArgumentParser, ToolError, Verdict, print_aligned, read_text, run, shown_path, write_whole
from tools.design import c_tables, energy_unit, linear_model, robot_json
from tools.report import plots

COLUMNS = ("v1_m_s", "w1_rad_s", "turn1_rad", "v2_m_s", "w2_rad_s", "turn2_rad", "u_left_before_v",
           "u_right_before_v", "settling_s")
# Errors of experiments that take less than this share of the mean count by that.
SMALL_SHARE = 0.01

ENERGIES = ("state_j", "steady_j", "last_j", "total_j")  # of motor and of battery

TERMS = ("Δv²", "Δw²", "σ²", "ΔvΔw", "Δvσ", "Δwσ", "ul₋Δv", "ul₋Δw", "ul₋σ", "ur₋Δv", "ur₋Δw", "ur₋σ", "P₋")
STEADY_TERMS = ("v²", "w²")
RESIDUAL_TERMS = ("vΔv", "wΔw", "wσ")
NOISE_TERMS = ("a constant",)

# The paper's Table 2 and its validation.
PUBLISHED_A = (172.2, 7.57, 13.2, -0.66, -0.94, 1.37, 16.26, -4.39, -1.11, 15.97, 4.27, 1.09, 5.82)
PUBLISHED_B = (20.83, 0.93)
PUBLISHED_MEAN_RELATIVE_ERROR = 0.63  # %
PUBLISHED_MAX_ABSOLUTE_ERROR = 1.0    # J

MEAN_RELATIVE_ERROR_BAR = 0.15  # %
# Ten times what the worst robot of the project reaches (0.30 %), five times the paper's. A robot beyond it does not obey
# the model: its motors saturate, or its controller is of another robot.
MEAN_RELATIVE_ERROR_LIMIT = 3.0  # %

MOTOR, BATTERY = "motor", "battery"

FIT_SHARE = 0.7
EXPERIMENTS_MIN = 40

# Standard deviations below 0 at which a power is not chance.
SURELY = 4.0

# A column that adds less than this to the others is not independent of them.
RANK_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Wording:
    """How an energy is called."""
    suffix: str  # of the table and of the reports
    figure: str  # in the name of a figure
    title: str
    errors: str  # what they are errors of


WORDINGS = {
    MOTOR: Wording("", "energy model", "energy of the motors", "the motors' energy"),
    BATTERY: Wording("_battery", "battery energy model", "energy of the battery",
                     "the energy that the battery gives the motors"),
}
EFFECTIVE_VOLTAGES = ("The voltages are effective ones, whose squares over Rm are the power that the battery sees: "
                      "2 cv²/Rm = b1,\n * 2 cw²/Rm = b2.")


@dataclass(frozen=True)
class Experiments:
    source: str
    columns: dict  # name: array
    settling_time: float
    segment: float
    last: float
    seed: int
    energy: str = MOTOR

    @property
    def count(self):
        return len(self.columns["settling_s"])

    def joules(self, name):
        """One of ENERGIES."""
        return self.columns[f"{self.energy}_{name}"]


@dataclass(frozen=True)
class Errors:
    """Prediction of the energy without the electronics against the measured one."""
    measured: np.ndarray  # J
    absolute: np.ndarray  # J, predicted − measured
    relative: np.ndarray  # %

    def summary(self):
        return {
            "experiments": len(self.absolute),
            "mean_relative_error_percent": float(np.abs(self.relative).mean()),
            "max_relative_error_percent": float(np.abs(self.relative).max()),
            "mean_absolute_error_j": float(np.abs(self.absolute).mean()),
            "max_absolute_error_j": float(np.abs(self.absolute).max()),
        }


def columns_of(energy):
    """Columns of the CSV file that an identification reads."""
    return (*COLUMNS, *(f"{energy}_{name}" for name in ENERGIES))


def read_rows(path, columns):
    """Those columns of the CSV file as arrays; complaints name the line."""
    reader = csv.reader(io.StringIO(read_text(path)))
    header = tuple(next(reader, ()))
    missing = [name for name in columns if name not in header]
    if missing:
        raise ToolError(f"{path}: line 1: column {missing[0]} is missing; run jp-identify again")
    rows = []
    for row in reader:
        if len(row) != len(header):
            raise ToolError(f"{path}: line {reader.line_num}: {len(row)} values, expected {len(header)}")
        try:
            rows.append([float(cell) for cell in row])
        except ValueError:
            raise ToolError(f"{path}: line {reader.line_num}: not a number") from None
        if not all(map(math.isfinite, rows[-1])):
            raise ToolError(f"{path}: line {reader.line_num}: a value is not finite")
    if len(rows) < EXPERIMENTS_MIN:
        raise ToolError(f"{path}: {len(rows)} experiments; at least {EXPERIMENTS_MIN} are needed")
    return {name: values for name, values in zip(header, np.array(rows).T) if name in columns}


def read_experiments(directory, robot_name, energy=MOTOR):
    path = directory / "experiments.json"
    try:
        about = json.loads(read_text(path))
        settling, segment = float(about["settling_time_s"]), float(about["segment_s"])
        last = float(about["last_s"])
        seed, name = int(about["seed"]), about["robot"]
    except (ValueError, TypeError) as error:
        raise ToolError(f"{path}: garbled: {error}") from None
    except KeyError as error:
        raise ToolError(f"{path}: key {error.args[0]} is missing") from None
    if name != robot_name:
        raise ToolError(f"{path}: robot: is {name!r}, expected {robot_name!r}")
    if not 0 < settling < segment:
        raise ToolError(f"{path}: settling_time_s: is {settling:g} s, must be above 0 and below segment_s {segment:g} s")
    if not 0 < last < segment:
        raise ToolError(f"{path}: last_s: is {last:g} s, must be above 0 and below segment_s {segment:g} s")
    source = str(directory / "experiments.csv")
    return Experiments(source, read_rows(source, columns_of(energy)), settling, segment, last, seed, energy)


def voltages_before(columns, per_speed, per_turn_rate):
    """Steady voltages before the second segment, as the library predicts them."""
    travel, turn = per_speed * columns["v1_m_s"], per_turn_rate * columns["w1_rad_s"]
    return travel - turn, travel + turn


def predicted_voltages(robot, columns):
    return voltages_before(columns, *linear_model.steady_voltages(robot))


def effective_voltages(b, resistance):
    """cv and cw with which (ul² + ur²)/Rm is the steady power b1 v² + b2 w²."""
    return tuple(np.sqrt(b * resistance / 2).tolist())


def state_regressors(columns, left, right, resistance):
    dv = columns["v2_m_s"] - columns["v1_m_s"]
    dw = columns["w2_rad_s"] - columns["w1_rad_s"]
    sigma = columns["turn2_rad"]
    before = (left**2 + right**2) / resistance
    return np.column_stack([dv**2, dw**2, sigma**2, dv * dw, dv * sigma, dw * sigma, left * dv, left * dw,
                            left * sigma, right * dv, right * dw, right * sigma, before])


def steady_regressors(columns, seconds):
    return np.column_stack([columns["v2_m_s"]**2, columns["w2_rad_s"]**2]) * seconds


def last_regressors(columns, seconds):
    """Steady power, the steady voltages times the small voltages that remain of the transient, and noise."""
    v, w = columns["v2_m_s"], columns["w2_rad_s"]
    residual = np.column_stack([v * (v - columns["v1_m_s"]), w * (w - columns["w1_rad_s"]), w * columns["turn2_rad"]])
    noise = np.ones((len(v), 1))
    return np.hstack([steady_regressors(columns, seconds), residual * seconds, noise * seconds])


def fit(source, matrix, energies, terms):
    """Least squares; complains about regressors that the experiments do not tell apart."""
    scale = np.linalg.norm(matrix, axis=0)
    empty = [term for term, size in zip(terms, scale) if size == 0]
    if empty:
        raise ToolError(f"{source}: {empty[0]} is 0 in every experiment; vary speeds, turn rates and turns")
    _, r, order = linalg.qr(matrix / scale, mode="economic", pivoting=True)
    independent = np.abs(np.diag(r))
    rank = int(np.sum(independent > RANK_TOLERANCE * independent[0]))
    if rank < len(terms):
        raise ToolError(f"{source}: rank {rank} of {len(terms)}: the experiments do not tell {terms[order[rank]]} from "
                        "the other terms; vary speeds, turn rates and turns independently")
    return np.linalg.lstsq(matrix / scale, energies, rcond=None)[0] / scale


def steady_powers(source, last, energies):
    """b, and the power of noise: none below 0, if the experiments tell no better."""
    powers = fit(source, last, energies, STEADY_TERMS + RESIDUAL_TERMS + NOISE_TERMS)
    scatter = np.sum((energies - last @ powers)**2) / (len(energies) - len(powers))
    uncertainty = np.sqrt(scatter * np.diag(np.linalg.inv(last.T @ last)))
    b, surely = powers[:len(STEADY_TERMS)], -SURELY * uncertainty[:len(STEADY_TERMS)]
    if np.any(b < surely):
        worst = (b - surely).argmin()
        raise ToolError(f"{source}: last_j: b{worst + 1} is {b[worst]:g}, steady motion cannot gain energy; check the robot "
                        "file")
    scale = np.linalg.norm(last, axis=0)
    low = np.full(len(powers), -np.inf)
    low[[*range(len(STEADY_TERMS)), -1]] = 0
    powers = optimize.lsq_linear(last / scale, energies, (low, np.inf), method="bvls").x / scale
    return powers[:len(STEADY_TERMS)], powers[-1]


def errors_of(source, measured, predicted):
    if measured.mean() <= 0:
        raise ToolError(f"{source}: total_j: experiments of {measured.mean():g} J on average; driving takes more than 0")
    absolute = predicted - measured
    # What braking gives back may be all that an experiment takes.
    return Errors(measured, absolute, 100 * absolute / np.maximum(measured, SMALL_SHARE * measured.mean()))


@dataclass(frozen=True)
class Identification:
    model: linear_model.EnergyModel
    fit: Errors
    validation: Errors
    split: Errors  # validation of the paper's own procedure: a before Ts, b after it
    voltage_difference: float  # V, largest |predicted − measured| steady voltage


def fit_paper(experiments, state, steady, fitted):
    """Energies predicted by the paper's procedure."""
    columns = experiments.columns
    a = fit(experiments.source, state[fitted], experiments.joules("state_j")[fitted], TERMS)
    b = fit(experiments.source, steady[fitted], experiments.joules("steady_j")[fitted], STEADY_TERMS)
    return state @ a + steady @ b


def identify(robot, experiments):
    source, columns = experiments.source, experiments.columns
    resistance = robot.positive("motor.resistance_ohm")
    steady = steady_regressors(columns, experiments.segment - experiments.settling_time)
    measured = experiments.joules("total_j")

    order = np.random.default_rng(experiments.seed).permutation(experiments.count)
    fitted, held_out = np.split(order, [round(FIT_SHARE * experiments.count)])
    last = last_regressors(columns, experiments.last)
    b, noise = steady_powers(source, last[fitted], experiments.joules("last_j")[fitted])
    per_speed, per_turn_rate = (effective_voltages(b, resistance) if experiments.energy == BATTERY
                                else linear_model.steady_voltages(robot))
    state = state_regressors(columns, *voltages_before(columns, per_speed, per_turn_rate), resistance)
    settled = steady @ b + noise * experiments.segment
    a = fit(source, state[fitted], (measured - settled)[fitted], TERMS)

    def errors(predicted, chosen):
        return errors_of(source, measured[chosen], predicted[chosen])

    predicted = state @ a + settled
    model = linear_model.EnergyModel(tuple(a.tolist()), tuple(b.tolist()), robot.positive("electronics.power_w") + noise,
                                     experiments.settling_time, per_speed, per_turn_rate, resistance)
    left, right = predicted_voltages(robot, columns)
    difference = max(np.abs(left - columns["u_left_before_v"]).max(), np.abs(right - columns["u_right_before_v"]).max())
    return Identification(model, errors(predicted, fitted), errors(predicted, held_out),
                          errors(fit_paper(experiments, state, steady, fitted), held_out), float(difference))


def check_validation(robot, experiments, result):
    taken = result.validation.measured.mean() + robot.positive("electronics.power_w") * experiments.segment
    mean = 100 * np.abs(result.validation.absolute).mean() / taken
    if not mean <= MEAN_RELATIVE_ERROR_LIMIT:
        raise Verdict(f"{experiments.source}: the model misses the energies that were not fitted by {mean:.2g} % of "
                      f"what such a drive takes on average, at most {MEAN_RELATIVE_ERROR_LIMIT:g} % is accepted; lower "
                      f"the limits of the robot file, or correct control.weights and run make gains ROBOT={robot.name}")


def parameter_rows(model, energy):
    """(name, term, value, published value or None, unit) of each parameter."""
    published_a, published_b = (PUBLISHED_A, PUBLISHED_B) if energy == MOTOR else ([None] * 13, [None] * 2)
    a = zip([f"a{i}" for i in range(1, 14)], TERMS, model.a, published_a, c_tables.STATE_UNITS)
    b = zip(["b1", "b2"], STEADY_TERMS, model.b, published_b, c_tables.STEADY_UNITS)
    return [*a, *b]


def result_json(robot, experiments, result):
    return {
        "robot": robot.name,
        "energy": experiments.energy,
        "settling_time_s": experiments.settling_time,
        "segment_s": experiments.segment,
        "seed": experiments.seed,
        "parameters": [{"name": name, "term": term, "value": value, "published": published, "unit": unit}
                       for name, term, value, published, unit in parameter_rows(result.model, experiments.energy)],
        "fit": result.fit.summary(),
        "validation": result.validation.summary(),
        "validation_of_the_papers_procedure": result.split.summary(),
        "published_mean_relative_error_percent": PUBLISHED_MEAN_RELATIVE_ERROR,
        "published_max_absolute_error_j": PUBLISHED_MAX_ABSOLUTE_ERROR,
        "max_steady_voltage_difference_v": result.voltage_difference,
    }


def bench_json(robot, energy, result):
    """The headline numbers for tools/measure/figures.py."""
    summary = result.validation.summary()
    command = f"make identify ROBOT={robot.name}"
    name = f"{WORDINGS[energy].figure} of {robot.name}"
    return [
        {"name": f"{name}, mean error", "value": summary["mean_relative_error_percent"],
         "unit": "%", "bound": {"op": "<=", "value": MEAN_RELATIVE_ERROR_BAR}, "command": command},
        {"name": f"{name}, largest error", "value": summary["max_absolute_error_j"],
         "unit": "J", "bound": {"op": "<=", "value": PUBLISHED_MAX_ABSOLUTE_ERROR}, "command": command},
    ]


def _error_axes(axes, values, unit, label, mean):
    trace, histogram = axes
    trace.axhline(0, color=plots.GREY, linewidth=0.8)
    trace.plot(np.arange(1, len(values) + 1), values, ".", color=plots.BLUE, markersize=4)
    trace.set_xlabel("validation experiment")
    trace.set_ylabel(f"{label}, {unit}")
    trace.set_title(f"{label.capitalize()} (predicted − measured)")
    histogram.hist(values, bins=30, orientation="horizontal", color=plots.BLUE, alpha=0.8)
    histogram.set_xlabel("experiments")
    histogram.set_ylim(trace.get_ylim())
    histogram.tick_params(labelleft=False)
    histogram.set_title(f"mean |error| {mean:.3g} {unit}", fontweight="normal")


def draw(robot, energy, result):
    """The validation errors, as the paper's Fig. 5."""
    figure, axes = plots.new_figure(9, 6.2, 2, 2, gridspec_kw={"width_ratios": [3, 1]})
    errors, summary = result.validation, result.validation.summary()
    _error_axes(axes[0], errors.absolute, "J", "absolute error", summary["mean_absolute_error_j"])
    _error_axes(axes[1], errors.relative, "%", "relative error", summary["mean_relative_error_percent"])
    figure.suptitle(f"Energy model of {robot.name}: {summary['experiments']} validation experiments, "
                    f"{WORDINGS[energy].title}", x=0.01, ha="left", fontsize=12)
    return plots.png_bytes(figure)


def print_result(robot, experiments, result):
    print(f"{robot.name}: {experiments.count} experiments of {experiments.segment:g} s, "
          f"Ts = {experiments.settling_time:g} s, seed {experiments.seed}\n")
    print_aligned([("", "term", "identified", "paper", "unit"),
                   *((name, term, f"{value:.3f}", "–" if published is None else f"{published:.2f}", unit)
                     for name, term, value, published, unit in parameter_rows(result.model, experiments.energy))])
    print()
    rows = [(WORDINGS[experiments.energy].title, "experiments", "mean error", "largest", "mean error", "largest")]
    for label, errors in (("fit", result.fit), ("validation", result.validation),
                          ("the paper's procedure", result.split)):
        s = errors.summary()
        rows.append((label, str(s["experiments"]), f"{s['mean_relative_error_percent']:.3f} %",
                     f"{s['max_relative_error_percent']:.3f} %", f"{s['mean_absolute_error_j']:.4f} J",
                     f"{s['max_absolute_error_j']:.4f} J"))
    if experiments.energy == MOTOR:
        rows.append(("as published", "300", f"{PUBLISHED_MEAN_RELATIVE_ERROR} %", "", "",
                     f"{PUBLISHED_MAX_ABSOLUTE_ERROR:g} J"))
    print_aligned(rows)
    print(f"\nsteady voltages: predicted within {result.voltage_difference:.4f} V of the measured ones\n")


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots")
    parser.add_argument("--energy", choices=sorted(WORDINGS), default=MOTOR,
                        help="which energy the model predicts (default: motor, the paper's)")
    parser.add_argument("--jp-robot", metavar="PATH", help="the program (default: build/bin/jp-robot)")
    parser.add_argument("--robot-json", metavar="FILE", help="output of jp-robot --json=-, instead of running it")
    parser.add_argument("--experiments", metavar="DIR", type=Path,
                        help="holds experiments.csv and experiments.json (default: build/identify/<robot>)")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C file goes (default: src/tables)")
    parser.add_argument("--bench", metavar="FILE", type=Path, help="write the headline numbers for figures.py")
    return parser.parse_args()


def main():
    options = arguments()
    if options.robot_json:
        robot = robot_json.load_json(options.robot_json)
    else:
        robot = robot_json.load(robot_json.robot_path(options.robot), options.jp_robot)
    wording = WORDINGS[options.energy]
    name = robot.name + wording.suffix
    directory = options.experiments or robot_json.build_directory() / "identify" / robot.name
    experiments = read_experiments(directory, robot.name, options.energy)
    result = identify(robot, experiments)
    picture = directory / f"identification{wording.suffix}.png"
    write_whole(picture, draw(robot, options.energy, result))
    check_validation(robot, experiments, result)
    mean = result.validation.summary()["mean_relative_error_percent"]
    note = f"Mean relative error {mean:.2f} % of {wording.errors}, on experiments that were not fitted."
    if options.energy == BATTERY:
        note += f"\n * {EFFECTIVE_VOLTAGES}"
    table = c_tables.energy_table(name, result.model, energy_unit.exponent(robot), f"make identify ROBOT={robot.name}",
                                  f"{experiments.count} experiments of jp-identify, seed {experiments.seed}", note)
    files = {
        options.tables / f"energy_{name}.c": c_tables.render(table),
        directory / f"identification{wording.suffix}.json": json.dumps(result_json(robot, experiments, result), indent=2,
                                                      ensure_ascii=False) + "\n",
    }
    if options.bench:
        files[options.bench] = json.dumps(bench_json(robot, options.energy, result), indent=2, ensure_ascii=False) + "\n"

    print_result(robot, experiments, result)
    for path, content in files.items():
        write_whole(path, content)
        print(f"wrote {shown_path(path)}")
    print(f"wrote {shown_path(picture)}")
    return 0


if __name__ == "__main__":
    run(main)
