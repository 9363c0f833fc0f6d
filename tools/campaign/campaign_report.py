"""The report of a campaign: how missions ended, how far the predicted energies can be trusted, and what learning gains.

Energies are judged on the missions that are done; answers about the reserve on all that asked.
"""
from dataclasses import dataclass

import numpy as np
from matplotlib.ticker import PercentFormatter
from scipy import stats

from tools.campaign.campaign_task import OUTCOMES
from tools.report import plots
from tools.report.results import format_number

CONFIDENCE = 0.95
COVERAGE_OFF_MAX = 2.0  # percentage points
NONE = "none"

OUTCOME_HEADINGS = ("", "missions", *(f"{outcome}, %" for outcome in OUTCOMES), "asked about the reserve", "right, %",
                    "optimistic, %", "pessimistic, %")
ENERGY_HEADINGS = ("", "missions done", "in the 95 % interval, %", "from", "to", "error, mean, %", "95th, %",
                   "not learned: mean, %", "95th, %")

Z_MAX = 5.0  # standard deviations shown


# ---- figures -------------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Energies:
    """Of missions that are done, J."""
    measured: np.ndarray
    predicted: np.ndarray
    std: np.ndarray
    prior: np.ndarray
    inside: np.ndarray

    @property
    def error(self):
        """Relative to what was measured."""
        return np.abs(self.predicted - self.measured) / self.measured

    @property
    def prior_error(self):
        return np.abs(self.prior - self.measured) / self.measured

    @property
    def z(self):
        return (self.measured - self.predicted) / self.std


def energies(missions):
    done = [mission for mission in missions if mission["outcome"] == "done"]
    columns = (np.array([mission[key] for mission in done]) for key in
               ("measured_j", "predicted_j", "std_j", "prior_predicted_j", "inside"))
    return Energies(*columns)


def percent(count, total):
    return 100 * count / total if total else None


def error_figures(errors):
    if errors.size == 0:
        return {"mean_percent": None, "percentile_95_percent": None}
    return {"mean_percent": 100 * float(errors.mean()), "percentile_95_percent": 100 * float(np.percentile(errors, 95))}


def coverage_figures(inside):
    """With the interval in which the true share is (Clopper and Pearson's)."""
    if inside.size == 0:
        return {"percent": None, "from_percent": None, "to_percent": None}
    covered = int(inside.sum())
    interval = stats.binomtest(covered, inside.size).proportion_ci(CONFIDENCE)
    return {"percent": percent(covered, inside.size), "from_percent": 100 * float(interval.low),
            "to_percent": 100 * float(interval.high)}


def reserve_figures(missions):
    asked = [mission["reserve"] for mission in missions if mission["reserve"]["asked"]]
    answers = {"right": lambda reserve: reserve["answer"] == reserve["true"],
               "optimistic": lambda reserve: reserve["answer"] and not reserve["true"],
               "pessimistic": lambda reserve: not reserve["answer"] and reserve["true"]}
    return {"asked": len(asked)} | {f"{name}_percent": percent(sum(map(is_so, asked)), len(asked))
                                    for name, is_so in answers.items()}


def figures_of(missions):
    outcomes = [mission["outcome"] for mission in missions]
    done = energies(missions)
    return {"missions": len(missions), "done": outcomes.count("done"),
            "outcome_percent": {outcome: percent(outcomes.count(outcome), len(missions)) for outcome in OUTCOMES},
            "coverage": coverage_figures(done.inside), "error": error_figures(done.error),
            "unlearned_error": error_figures(done.prior_error), "reserve": reserve_figures(missions)}


def groups(missions):
    """Missions by what happened to them, as (kind, name, missions): all, those by fault, those by change."""
    yield "all", "all", missions
    for kind in ("fault", "change"):
        names = {mission[kind] for mission in missions}
        for name in sorted(names, key=lambda name: name or "") if names != {None} else ():
            yield kind, name or NONE, [mission for mission in missions if mission[kind] == name]


def report(settings, missions):
    """What campaign.json holds. It depends on the missions alone, not on how they were run."""
    return {"settings": settings, "missions": len(missions),
            "groups": [{"kind": kind, "name": name, **figures_of(group)} for kind, name, group in groups(missions)]}


# ---- tables --------------------------------------------------------------------------------------------------------

def title(settings):
    return f"{settings['robot']}{', with faults' if settings['faults'] else ''}"


def cell(value, digits=1):
    return "-" if value is None else f"{value:.{digits}f}"


def group_label(group):
    return group["name"] if group["kind"] == "all" else f"{group['kind']}: {group['name']}"


def outcome_rows(groups):
    for group in groups:
        reserve = group["reserve"]
        yield (group_label(group), str(group["missions"]),
               *(cell(group["outcome_percent"][outcome]) for outcome in OUTCOMES), str(reserve["asked"]),
               *(cell(reserve[f"{name}_percent"]) for name in ("right", "optimistic", "pessimistic")))


def energy_rows(groups):
    for group in groups:
        coverage = group["coverage"]
        yield (group_label(group), str(group["done"]),
               *(cell(coverage[key]) for key in ("percent", "from_percent", "to_percent")),
               *(cell(group[error][key], 2) for error in ("error", "unlearned_error")
                 for key in ("mean_percent", "percentile_95_percent")))


def tables(groups):
    """Each as headings and rows."""
    return [OUTCOME_HEADINGS, *outcome_rows(groups)], [ENERGY_HEADINGS, *energy_rows(groups)]


# ---- figures of make figures ----------------------------------------------------------------------------------------

def bench(data, command):
    """For tools/measure/figures.py. None: no mission is done."""
    everything = data["groups"][0]
    if everything["done"] == 0:
        return None
    label = f"campaign of {data['missions']} unseen missions, {title(data['settings'])}"
    coverage, reserve = everything["coverage"]["percent"], everything["reserve"]["right_percent"]

    def figure(name, value, unit="%", bound=None):
        return {"name": f"{label}: {name}", "value": value, "unit": unit, "bound": bound, "command": command}

    return [figure("share in the 95 % interval is off 95 % by", abs(coverage - 100 * CONFIDENCE), "points",
                   {"op": "<=", "value": COVERAGE_OFF_MAX}),
            figure("share in the 95 % interval", coverage),
            figure("error of the predicted energy, mean", everything["error"]["mean_percent"]),
            figure("error of the predicted energy without learning, mean",
                   everything["unlearned_error"]["mean_percent"]),
            *([figure("right answers about the reserve", reserve)] if reserve is not None else [])]


# ---- picture -------------------------------------------------------------------------------------------------------

def draw_predictions(axes, done):
    axes.scatter(done.measured, done.prior, s=7, color=plots.ORANGE, linewidths=0, alpha=0.5, label="not learned")
    axes.scatter(done.measured, done.predicted, s=7, color=plots.BLUE, linewidths=0, alpha=0.7, label="learned")
    ends = [0, 1.05 * max(done.measured.max(), done.predicted.max(), done.prior.max())]
    axes.plot(ends, ends, color=plots.INK, linewidth=0.9, zorder=2)
    axes.set(title="Energy of a mission", xlabel="measured, J", ylabel="predicted, J", xlim=ends, ylim=ends)
    axes.legend(loc="upper left", markerscale=2)


def draw_intervals(axes, done):
    """Missions by the width of their interval: a fan that all but one in 20 should be in."""
    order = np.argsort(done.std / done.predicted)
    off = 100 * (done.measured / done.predicted - 1)[order]
    half = 100 * stats.norm.ppf((1 + CONFIDENCE) / 2) * (done.std / done.predicted)[order]
    inside = done.inside[order]
    places = np.arange(off.size)
    axes.fill_between(places, -half, half, color=plots.BLUE, alpha=0.15, linewidth=0)
    for chosen, color, label in ((inside, plots.BLUE, "inside"), (~inside, plots.ORANGE, "outside")):
        axes.scatter(places[chosen], off[chosen], s=7, color=color, linewidths=0, label=f"{label}: {chosen.sum()}")
    axes.axhline(0, color=plots.INK, linewidth=0.9)
    axes.set(title="Measured in its 95 % interval", xlabel="missions, by the width of their interval",
             ylabel="measured − predicted, % of predicted", xlim=(0, off.size))
    axes.set_ylim(top=1.35 * axes.get_ylim()[1])
    axes.legend(loc="upper left", markerscale=2)


def draw_z(axes, done):
    edges = np.linspace(-Z_MAX, Z_MAX, 41)
    axes.hist(np.clip(done.z, -Z_MAX, Z_MAX), edges, density=True, color=plots.BLUE, alpha=0.5,
              label=f"mean {format_number(done.z.mean())}, standard deviation {format_number(done.z.std())}")
    z = np.linspace(-Z_MAX, Z_MAX, 201)
    axes.plot(z, stats.norm.pdf(z), color=plots.INK, label="normal curve")
    axes.set(title="Normalised error", xlabel=f"(measured − predicted) / standard deviation, up to ±{Z_MAX:g}",
             ylabel="density", xlim=(-Z_MAX, Z_MAX))
    axes.set_ylim(top=1.3 * axes.get_ylim()[1])
    axes.legend(loc="upper left")


def draw_coverage(axes, groups):
    groups = [group for group in groups if group["done"]]
    places = range(len(groups))
    shares = np.array([[group["coverage"][key] for key in ("percent", "from_percent", "to_percent")]
                       for group in groups])
    axes.axvspan(100 * CONFIDENCE - COVERAGE_OFF_MAX, 100 * CONFIDENCE + COVERAGE_OFF_MAX, color=plots.GREEN,
                 alpha=0.15, linewidth=0)
    axes.axvline(100 * CONFIDENCE, color=plots.GREEN, linewidth=1)
    axes.errorbar(shares[:, 0], places, xerr=np.abs(shares[:, 1:] - shares[:, :1]).T, fmt="o", color=plots.BLUE,
                  markersize=5, elinewidth=1.4, capsize=3)
    axes.set_yticks(places, [f"{group_label(group)} ({group['done']})" for group in groups])
    axes.set(title="Share inside the 95 % interval", xlabel="%, with its own 95 % interval", xlim=(None, 100.5),
             ylim=(len(groups) - 0.5, -0.5))
    axes.grid(axis="y", visible=False)


def draw_errors(axes, done):
    for errors, color, label in ((done.error, plots.BLUE, "learned"), (done.prior_error, plots.ORANGE, "not learned")):
        figures = error_figures(errors)
        axes.ecdf(100 * errors, color=color, label=f"{label}: mean {figures['mean_percent']:.2f} %,\n95th percentile "
                  f"{figures['percentile_95_percent']:.2f} %")
    axes.axhline(0.95, color=plots.GREY, linewidth=0.9, linestyle=(0, (4, 2)))
    axes.set(title="Error of the predicted energy", xlabel="|predicted − measured| / measured, %",
             ylabel="share of missions", ylim=(0, 1.02), xlim=(0, None))
    axes.yaxis.set_major_formatter(PercentFormatter(1))
    axes.legend(loc="lower right")


def draw_reserve(axes, groups):
    groups = [group for group in groups if group["reserve"]["asked"]]
    left = np.zeros(len(groups))
    for name, color in (("right", plots.BLUE), ("pessimistic", plots.GREY), ("optimistic", plots.ORANGE)):
        shares = np.array([group["reserve"][f"{name}_percent"] for group in groups])
        axes.barh(range(len(groups)), shares, left=left, height=0.6, color=color, label=name)
        left += shares
    axes.set_yticks(range(len(groups)), [f"{group_label(group)} ({group['reserve']['asked']})" for group in groups])
    axes.set(title="Answers about the reserve", xlabel="% of those that asked", xlim=(0, 100),
             ylim=(len(groups) - 0.5, -1.2))
    axes.grid(axis="y", visible=False)
    axes.legend(loc="upper left", ncols=3)


def picture(missions, data):
    """PNG; None: no mission is done."""
    done = energies(missions)
    if done.measured.size == 0:
        return None
    groups = data["groups"]
    figure, axes = plots.new_figure(16.5, max(8.6, 4.6 + 0.3 * len(groups)), 2, 3)
    draw_predictions(axes[0, 0], done)
    draw_intervals(axes[0, 1], done)
    draw_z(axes[0, 2], done)
    draw_errors(axes[1, 0], done)
    draw_coverage(axes[1, 1], groups)
    draw_reserve(axes[1, 2], groups)
    first, last = missions[0]["seed"], missions[-1]["seed"]
    figure.suptitle(f"{title(data['settings'])}: {done.measured.size} of {len(missions)} missions done, seeds "
                    f"{first}…{last}", fontsize=13, fontweight="bold")
    return plots.png_bytes(figure)
