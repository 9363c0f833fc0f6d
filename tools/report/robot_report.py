"""The page about a robot: what it must do and does, its forecasts, its identification."""
import base64

import numpy as np

from tools.report import plots
from tools.report.results import format_number, render_page

Z_MAX = 4.0  # standard deviations shown


def draw_forecasts(drives):
    """Forecast before the start against what was driven."""
    figure, (energies, errors) = plots.new_figure(9, 3.6, columns=2)
    driven = np.array([drive.driven for drive in drives])
    percent = 100 * np.array([drive.error for drive in drives])
    most = 1.08 * driven.max()
    energies.plot([0, most], [0, most], color=plots.GREY, linewidth=1, label="equal")
    energies.plot(driven, [drive.forecast for drive in drives], "o", color=plots.BLUE, markersize=4, label="a route")
    energies.set(xlim=(0, most), ylim=(0, most), xlabel="driven, J", ylabel="forecast before the start, J")
    energies.legend()
    errors.axhline(0, color=plots.GREY, linewidth=1)
    errors.plot([drive.seconds for drive in drives], percent, "o", color=plots.ORANGE, markersize=4)
    errors.set(xlabel="duration of the route, s", ylabel="forecast beyond the drive, %", xlim=(0, None))
    return plots.inline_png(figure)


def draw_intervals(trips):
    """How far trips end from their forecast, in standard deviations of it."""
    figure, axes = plots.new_figure(9, 3.2)
    z = np.clip([(trip["measured_j"] - trip["predicted_j"]) / trip["std_j"] for trip in trips
                 if trip["outcome"] == "done"], -Z_MAX, Z_MAX)
    edges = np.linspace(-Z_MAX, Z_MAX, 33)
    axes.hist(z, bins=edges, color=plots.BLUE, label="trips")
    middle = (edges[1:] + edges[:-1]) / 2
    normal = np.exp(-middle**2 / 2) / np.sqrt(2 * np.pi) * len(z) * (edges[1] - edges[0])
    axes.plot(middle, normal, color=plots.ORANGE, label="as many if the forecasts say the truth")
    axes.axvspan(-1.96, 1.96, color=plots.GREEN, alpha=0.1, label="95 % interval")
    axes.set(xlabel="driven energy beyond the forecast, standard deviations", ylabel="trips", xlim=(-Z_MAX, Z_MAX))
    axes.legend(loc="upper left")
    return plots.inline_png(figure)


def embedded(path):
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode("ascii")


def headlines(findings):
    """Those that have a bar."""
    return [(f"{finding.value:.3g} {finding.unit}", finding.name) for finding in findings if finding.bar]


def render(made):
    """The page about a robot_findings.Made as text."""
    figures = [("Forecasts", made.driven, draw_forecasts(made.drives))]
    if made.trips:
        figures.append(("Intervals", "Robots that differ from the file in ground, payload and motors drive, learn, and forecast "
                                     "the rest of their way.", draw_intervals(made.trips)))
    figures += [(name, shown, embedded(path)) for name, shown, path in made.pictures]
    return render_page("robot.html.j2", summary={"robot": made.robot.name}, headlines=headlines(made.findings),
                       findings=made.findings, figures=figures, is_good=all(finding.is_met for finding in made.findings),
                       format_number=format_number)
