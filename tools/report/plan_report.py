#!/usr/bin/env python3
"""Make a page and a picture from the results of jp-plan.

Reads DIR/summary.json, the routes and the log that it names, and the map that was planned on; writes DIR/report.html,
one file that needs nothing else, and DIR/plan.png. Exit status 2: bad input; nothing was written.
"""
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.transforms import Affine2D

from tools.common import ArgumentParser, run, shown_path, write_whole
from tools.report import plots
from tools.report.ground import (OUTLINE, WIDTH, draw_ground, draw_places, finish_map, legend_entries, map_height,
                                 read_map)
from tools.report.results import (format_number, need, need_list, need_numbers, need_texts, need_vector, read_columns,
                                  read_json, render_page)

SUMMARY_KEYS = ("robot", "map", "parameters", "memory", "task_chosen", "start", "goal_m", "routes", "comparison",
                "drive")
ROUTE_KEYS = ("name", "title", "file", "cost", "answer", "length_m", "energy_j", "time_s", "climb_m",
              "turning_energy_j", "bound", "distance_left_m", "expansions", "states", "planning_s")
ROUTE_TEXTS = ("name", "title", "file", "cost", "answer")
ROUTE_COLUMNS = ("x_m", "y_m", "z_m", "heading_deg", "length_m", "energy_j", "time_s")
DRIVE_KEYS = ("log", "waypoints_m", "margin_m", "clear", "end_error_m", "level_ground_assumed", "planned",
              "predicted", "driven")
LOG_COLUMNS = ("x_m", "y_m", "energy_j")
MEMORY_KEYS = ("block_bytes", "guide_bytes", "field_bytes", "search_bytes", "states_max", "map_bytes")

COLOURS = {"energy": plots.BLUE, "distance": plots.ORANGE}
STYLES = {"energy": "-", "distance": (0, (4, 1.6))}

LINES = 3.0, 1.7  # widths of the first route and of the others
PROFILE_HEIGHT = 2.3


@dataclass(frozen=True)
class Route:
    """One plan: its part of the summary and its steps by columns."""
    about: dict
    steps: dict

    @property
    def arrives(self):
        return self.about["answer"] in ("optimal", "within bound")

    @property
    def label(self):
        lengths = f"{format_number(self.about['length_m'], 1, 'm')}, {format_number(self.about['energy_j'], 0, 'J')}"
        return f"{self.about['title']}: {lengths if self.arrives else self.about['answer']}"

    @property
    def look(self):
        name = self.about["name"]
        return {"color": COLOURS.get(name, plots.PURPLE), "linestyle": STYLES.get(name, ":")}


# ---- input ---------------------------------------------------------------------------------------------------------

def read_summary(path):
    summary = read_json(path)
    need(path, "summary", summary, SUMMARY_KEYS)
    need(path, "map", summary["map"], ("file", "name", "note"))
    need(path, "parameters", summary["parameters"], ("version", "file"))
    need_numbers(path, "parameters", summary["parameters"], ("version",))
    need_numbers(path, "memory", summary["memory"], MEMORY_KEYS)
    need_vector(path, "start", summary["start"], 3)
    need_vector(path, "goal_m", summary["goal_m"], 2)
    need_list(path, "routes", summary["routes"])
    for i, route in enumerate(summary["routes"]):
        check_route(path, f"routes[{i}]", route)
    if summary["comparison"] is not None:
        need(path, "comparison", summary["comparison"], ("energy_percent", "length_percent", "time_percent"))
    if summary["drive"] is not None:
        check_drive(path, summary["drive"])
    return summary


def check_route(path, place, route):
    need(path, place, route, ROUTE_KEYS)
    need_texts(path, place, route, ROUTE_TEXTS)
    need_numbers(path, place, route, [key for key in ROUTE_KEYS if key not in ROUTE_TEXTS and key != "bound"])


def check_drive(path, drive):
    need(path, "drive", drive, DRIVE_KEYS)
    need_list(path, "drive.waypoints_m", drive["waypoints_m"])
    for i, point in enumerate(drive["waypoints_m"]):
        need_vector(path, f"drive.waypoints_m[{i}]", point, 2)
    for key in ("planned", "predicted", "driven"):
        need_numbers(path, f"drive.{key}", drive[key], ("length_m", "energy_j", "time_s"))
    need_numbers(path, "drive", drive, ("margin_m", "end_error_m"))


def driven_path(log, start):
    """x, y in the map's frame of a log, which is in that of odometry: from the start, x ahead."""
    x, y, heading = start
    path = np.column_stack([log["x_m"], log["y_m"]])
    return Affine2D().rotate(math.radians(heading)).translate(x, y).transform(path)


# ---- the map -------------------------------------------------------------------------------------------------------

def draw_routes(axes, routes, driven, waypoints):
    for i, route in enumerate(routes):
        # Dashes over the solid line: where both lead the same way, both are seen.
        axes.plot(route.steps["x_m"], route.steps["y_m"], linewidth=LINES[i > 0], zorder=4,
                  path_effects=OUTLINE if i == 0 else None, **route.look)
    if driven is not None:
        axes.plot(*driven.T, color=plots.GREEN, linewidth=1.6, zorder=5)
        axes.plot(*waypoints.T, "o", color="white", markeredgecolor=plots.GREEN, markersize=5, zorder=5)


def legend_of(summary, ground, routes):
    entries = [(Line2D([], [], linewidth=LINES[i > 0], **route.look), route.label) for i, route in enumerate(routes)]
    if summary["drive"] is not None:
        driven = summary["drive"]["driven"]
        line = Line2D([], [], color=plots.GREEN, marker="o", markerfacecolor="white", linewidth=1.6, markersize=5)
        entries.append((line, f"driven, with waypoints: {format_number(driven['length_m'], 1, 'm')}, "
                              f"{format_number(driven['energy_j'], 0, 'J')}"))
    return entries + legend_entries(ground)


def fill_map(figure, axes, summary, ground, routes, driven):
    draw_ground(axes, ground)
    drive = summary["drive"]
    draw_routes(axes, routes, driven, None if drive is None else np.array(drive["waypoints_m"], dtype=float))
    draw_places(axes, summary["start"], summary["goal_m"])
    finish_map(figure, axes, ground, legend_of(summary, ground, routes))


def draw_map(summary, ground, routes, driven):
    figure, axes = plots.new_figure(WIDTH, map_height(ground) + 0.8)
    fill_map(figure, axes, summary, ground, routes, driven)
    return figure


# ---- profiles ------------------------------------------------------------------------------------------------------

def fill_profiles(axes, ground, routes):
    """Elevation, where the map has any, and energy against the way driven."""
    panels = [("energy_j", "energy so far, J")]
    if ground.elevation is not None:
        panels.insert(0, ("z_m", "elevation, m"))
    for axis, (column, label) in zip(axes, panels):
        for route in routes:
            axis.plot(route.steps["length_m"], route.steps[column], label=route.label, **route.look)
        axis.set_ylabel(label)
        axis.set_xlim(left=0)
    axes[-1].set_ylim(bottom=0)
    axes[-1].set_xlabel("length driven, m")


def profile_count(ground):
    return 1 if ground.elevation is None else 2


def draw_profiles(ground, routes):
    count = profile_count(ground)
    figure, axes = plots.new_figure(WIDTH, 0.5 + PROFILE_HEIGHT * count, count, squeeze=False, sharex=True)
    fill_profiles(axes[:, 0], ground, routes)
    axes[0, 0].legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2)
    return figure


def draw_plan(summary, ground, routes, driven):
    """Map and profiles in one picture."""
    count = profile_count(ground)
    heights = [map_height(ground) + 0.8] + [PROFILE_HEIGHT] * count
    figure, axes = plots.new_figure(WIDTH, sum(heights), 1 + count, height_ratios=heights)
    fill_map(figure, axes[0], summary, ground, routes, driven)
    fill_profiles(axes[1:], ground, routes)
    return figure


# ---- page ----------------------------------------------------------------------------------------------------------

def signed(value, digits=2, unit="%"):
    text = format_number(value, digits, unit)
    return f"+{text}" if value is not None and value > 0 else text


def headlines(summary):
    """(value, label) of the numbers at the top."""
    energy = summary["routes"][0]
    cards = [(format_number(energy["energy_j"], 0, "J"), f"{energy['title']} route, over {energy['length_m']:.1f} m")]
    if summary["comparison"] is not None:
        cards += [(signed(summary["comparison"]["energy_percent"]), "energy against the distance-optimal route"),
                  (signed(summary["comparison"]["length_percent"]), "length against the distance-optimal route")]
    cards.append((energy["answer"], f"answer, after {format_number(1000 * energy['planning_s'], 0, 'ms')}"))
    if summary["drive"] is not None:
        driven = summary["drive"]["driven"]["energy_j"]
        cards.append((format_number(driven, 0, "J"), "driven in closed loop"))
        error = 100 * (summary["drive"]["predicted"]["energy_j"] / driven - 1) if driven else None
        cards.append((signed(error), "prediction against driven energy"))
    cards.append((format_number(summary["memory"]["block_bytes"] / 1024, 0, "KiB"), "memory of the planner"))
    return cards


def figures(summary, ground, routes, driven):
    drawn = [("Routes over the map", summary["map"]["note"], draw_map(summary, ground, routes, driven)),
             ("Along the routes", "What the lattice plans, against the length driven.", draw_profiles(ground, routes))]
    return [(name, caption, plots.inline_png(figure, dpi=130)) for name, caption, figure in drawn]


def render(summary, ground, routes, driven):
    return render_page("plan.html.j2", summary=summary, headlines=headlines(summary), signed=signed,
                       colours=COLOURS, driven_colour=plots.GREEN, figures=figures(summary, ground, routes, driven))


def load(directory):
    summary = read_summary(directory / "summary.json")
    ground = read_map(Path(summary["map"]["file"]))
    routes = [Route(about, read_columns(directory / about["file"], ROUTE_COLUMNS, 1)) for about in summary["routes"]]
    drive = summary["drive"]
    if drive is None:
        return summary, ground, routes, None
    log = read_columns(directory / drive["log"], LOG_COLUMNS)
    return summary, ground, routes, driven_path(log, summary["start"])


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("directory", metavar="DIR", type=Path, help="holds summary.json and the routes")
    directory = parser.parse_args().directory
    results = load(directory)
    picture = plots.png_bytes(draw_plan(*results), dpi=120)
    for name, content in (("report.html", render(*results)), ("plan.png", picture)):
        write_whole(directory / name, content)
        print(f"wrote {shown_path(directory / name)}")
    return 0


if __name__ == "__main__":
    run(main)
