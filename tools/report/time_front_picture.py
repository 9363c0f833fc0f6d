"""Draw the front of a route: its energy over its time, as foretold, as driven, and the least that exists.

Reads DIR/front.json, the results of jp-front, and DIR/limits.json, those of tools/measure/time_front.py; writes
DIR/front.png. Exit status 2: bad input; nothing was written.
"""
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import interpolate

from tools.common import ArgumentParser, ToolError, run, shown_path, write_whole
from tools.report import plots
from tools.report.results import format_number, need, need_list, need_numbers, need_point, read_json

KEYS = ("robot", "scenario", "energy", "seed", "waypoints_m", "forecasts", "drives")
FORECAST_KEYS = ("cruise_m_s", "duration_s", "energy_j")
DRIVE_KEYS = ("limit", "duration_s", "plant_energy_j", "end_speed_m_s", "passed_m")
POINT_KEYS = ("duration_s", "energy_j")

LEAST, SHARE, IN_TIME, IN_ENERGY = "least_energy", "share", "within_seconds", "within_joules"
MARKS = {LEAST: ("*", 15, plots.GREEN), SHARE: ("o", 6, plots.ORANGE), IN_TIME: ("s", 8, plots.PURPLE),
         IN_ENERGY: ("D", 8, plots.RED)}

SIZE = 9.2, 6.8  # inches
MARGIN = 0.06    # of the times that are shown


@dataclass(frozen=True)
class Point:
    seconds: float
    joules: float


@dataclass(frozen=True)
class Drive:
    request: str
    budget: float  # s or J
    forecast: Point
    driven: Point
    limit: Point
    miss: float  # m, how far from the worst waypoint it passed

    @property
    def above(self):
        """%, of the drive above the limit."""
        return 100 * (self.driven.joules / self.limit.joules - 1)

    @property
    def foretold(self):
        """%, of the forecast above the limit."""
        return 100 * (self.forecast.joules / self.limit.joules - 1)


# ---- Results -------------------------------------------------------------------------------------------------------

def read_front(path):
    """The results of jp-front, checked."""
    front = read_json(path)
    need(path, "front", front, KEYS)
    for name in ("waypoints_m", "forecasts", "drives"):
        need_list(path, name, front[name])
    for i, point in enumerate(front["waypoints_m"]):
        need_point(path, f"waypoints_m[{i}]", point)
    for i, forecast in enumerate(front["forecasts"]):
        need_numbers(path, f"forecasts[{i}]", forecast, FORECAST_KEYS)
    for i, drive in enumerate(front["drives"]):
        need(path, f"drives[{i}]", drive, ("request", "forecast"))
        need_numbers(path, f"drives[{i}]", drive, DRIVE_KEYS)
        need_numbers(path, f"drives[{i}].forecast", drive["forecast"], FORECAST_KEYS)
        if drive["request"] not in MARKS:
            raise ToolError(f"{path}: drives[{i}]: request is {drive['request']!r}, not one of {', '.join(MARKS)}")
    return front


def read_limits(path, front):
    """Those of the drives, and slower ones."""
    limits = read_json(path)
    need(path, "limits", limits, ("scenario", "drives", "slower"))
    for name in ("drives", "slower"):
        need_list(path, name, limits[name])
        for i, point in enumerate(limits[name]):
            need_numbers(path, f"{name}[{i}]", point, POINT_KEYS)
    if limits["scenario"] != front["scenario"] or len(limits["drives"]) != len(front["drives"]):
        raise ToolError(f"{path}: is of another front than front.json beside it")
    return limits


def point_of(data, energy="energy_j"):
    return Point(data["duration_s"], data[energy])


def drives_of(front, limits):
    return [Drive(drive["request"], drive["limit"], point_of(drive["forecast"]), point_of(drive, "plant_energy_j"),
                  point_of(limit), drive["passed_m"]) for drive, limit in zip(front["drives"], limits["drives"])]


# ---- Picture -------------------------------------------------------------------------------------------------------

def curve(points):
    """Their times and energies, from the fastest to the slowest; one of those that take the same time."""
    ordered = sorted(points, key=lambda point: point.seconds)
    return np.array(list({point.seconds: (point.seconds, point.joules) for point in ordered}.values())).T


def label_of(drive, miss):
    if drive.request == SHARE:
        return f"driven in closed loop, waypoints passed within {format_number(100 * miss, 1, 'cm')}"
    told = {LEAST: "least energy", IN_TIME: f"asked: least energy within {format_number(drive.budget, 2, 's')}",
            IN_ENERGY: f"asked: fastest within {format_number(drive.budget, 1, 'J')}"}[drive.request]
    return f"{told}: {format_number(drive.driven.seconds, 2, 's')}, {format_number(drive.driven.joules, 1, 'J')}"


def mark_drives(axes, drives, height, labelled):
    """Each kind of request has its mark; what was asked for lies above the others."""
    seen, miss = set(), max(drive.miss for drive in drives)
    for drive in sorted(drives, key=lambda drive: list(MARKS).index(drive.request) if drive.request != SHARE else -1):
        marker, size, colour = MARKS[drive.request]
        label = label_of(drive, miss) if labelled and drive.request not in seen else None
        axes.plot(drive.driven.seconds, height(drive), marker, markersize=size, color=colour, markeredgecolor="white",
                  markeredgewidth=0.8, linestyle="none", label=label, zorder=3)
        seen.add(drive.request)


def name_budget(axes, text, place, transform, style):
    """Where its line meets an axis."""
    axes.annotate(text, place, xycoords=transform, xytext=(4, 4), textcoords="offset points", fontsize=9,
                  color=style["color"])


def smooth(points):
    """The curve through points that were computed."""
    seconds = np.linspace(points[0, 0], points[0, -1], 200)
    return seconds, interpolate.PchipInterpolator(*points)(seconds)


def draw_budgets(axes, drives):
    for drive in drives:
        style = {"color": MARKS[drive.request][2], "linewidth": 1, "linestyle": ":"}
        if drive.request == IN_TIME:
            axes.axvline(drive.budget, **style)
            name_budget(axes, format_number(drive.budget, 2, "s"), (drive.budget, 0), axes.get_xaxis_transform(), style)
        if drive.request == IN_ENERGY:
            axes.axhline(drive.budget, **style)
            name_budget(axes, format_number(drive.budget, 1, "J"), (0, drive.budget), axes.get_yaxis_transform(), style)


def draw_front(axes, kind, forecasts, drives, limits):
    slowest = limits[0, -1]
    shown = forecasts[:, forecasts[0] <= slowest * (1 + MARGIN / 2)]
    axes.plot(*smooth(limits), "--", color=plots.INK, linewidth=1.3, label="least that exists in that time: plant, no controller")
    axes.plot(*shown, color=plots.BLUE, label="forecast of the library, over the cruise")
    draw_budgets(axes, drives)
    mark_drives(axes, drives, lambda drive: drive.driven.joules, labelled=True)
    axes.set_ylabel(f"energy ({kind}), J")
    axes.legend(loc="upper right")


def draw_above(axes, drives):
    ordered = sorted(drives, key=lambda drive: drive.driven.seconds)
    axes.plot([drive.driven.seconds for drive in ordered], [drive.foretold for drive in ordered], color=plots.BLUE)
    mark_drives(axes, drives, lambda drive: drive.above, labelled=False)
    axes.axhline(0, color=plots.INK, linewidth=1.3, linestyle="--")
    axes.set_ylabel("above the least, %")
    axes.set_xlabel("time of the whole route, s")


def draw(front, limits):
    drives = drives_of(front, limits)
    least = curve([*(drive.limit for drive in drives), *map(point_of, limits["slower"])])
    figure, axes = plots.new_figure(*SIZE, 2, sharex=True, height_ratios=(3, 1.2))
    draw_front(axes[0], front["energy"], curve(map(point_of, front["forecasts"])), drives, least)
    draw_above(axes[1], drives)
    axes[0].set_title(f"{front['scenario']}: energy over time, robot {front['robot']}")
    return figure


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("directory", metavar="DIR", type=Path, help="holds front.json and limits.json")
    directory = parser.parse_args().directory
    front = read_front(directory / "front.json")
    figure = draw(front, read_limits(directory / "limits.json", front))
    path = directory / "front.png"
    write_whole(path, plots.png_bytes(figure, dpi=110))
    print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
