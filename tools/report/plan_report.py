#!/usr/bin/env python3
"""Make a page and a picture from the results of jp-plan.

Reads DIR/summary.json, the routes and the log that it names, and the map that was planned on; writes DIR/report.html,
one file that needs nothing else, and DIR/plan.png. Exit status 2: bad input; nothing was written.
"""
import math
from dataclasses import dataclass
from pathlib import Path

import matplotlib.patheffects
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LightSource, LinearSegmentedColormap, to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.path import Path as MarkerPath
from matplotlib.transforms import Affine2D

from tools.common import ArgumentParser, ToolError, run, shown_path, write_whole
from tools.report import plots
from tools.report.results import (format_number, need, need_list, need_numbers, need_vector, read_columns, read_json,
                                  render_page)

SUMMARY_KEYS = ("robot", "map", "parameters", "memory", "task_chosen", "start", "goal_m", "routes", "comparison", "drive")
ROUTE_KEYS = ("name", "title", "file", "cost", "answer", "length_m", "energy_j", "time_s", "climb_m",
              "turning_energy_j", "bound", "distance_left_m", "expansions", "states", "planning_s")
ROUTE_TEXTS = ("name", "title", "file", "cost", "answer")
ROUTE_COLUMNS = ("x_m", "y_m", "z_m", "heading_deg", "length_m", "energy_j", "time_s")
DRIVE_KEYS = ("log", "waypoints_m", "margin_m", "clear", "end_error_m", "level_ground_assumed", "planned",
              "predicted", "driven")
LOG_COLUMNS = ("x_m", "y_m", "energy_j")
MEMORY_KEYS = ("block_bytes", "guide_bytes", "field_bytes", "search_bytes", "states_max", "map_bytes")
MAP_KEYS = ("format", "name", "width", "height", "resolution_m", "origin_m", "rows")
MAP_FORMAT = "joulepath-map-1"

FREE, OCCUPIED, UNKNOWN = ".", "#", "?"

COLOURS = {"energy": plots.BLUE, "distance": plots.ORANGE}
STYLES = {"energy": "-", "distance": (0, (4, 1.6))}

# Low ground to high ground, light enough for the lines on it.
GROUND = LinearSegmentedColormap.from_list("ground", ["#9DBF9E", "#D9E2B4", "#F0E2BC", "#DDBE9A", "#C9A58A"])
LEVEL, OBSTACLE, UNKNOWN_FILL, UNKNOWN_HATCH = "#FBFCFD", "#6B7580", "#E6EAEE", "#A5AFB9"
OUTLINE = [matplotlib.patheffects.withStroke(linewidth=5, foreground="white")]
LINES = 3.0, 1.7  # widths of the first route and of the others

# Points along x.
DART = MarkerPath([(1, 0), (-0.9, 0.75), (-0.45, 0), (-0.9, -0.75), (1, 0)], closed=True)

CONTOURS = 9
# Hills look flat in true proportion.
RELIEF = 3

WIDTH = 10.0  # inches
MAP_HEIGHT = 3.2, 9.5
PROFILE_HEIGHT = 2.3


@dataclass(frozen=True)
class Map:
    """Cells and elevations with the southern row first."""
    cells: np.ndarray
    elevation: np.ndarray | None  # m
    resolution: float  # m
    origin: tuple  # of the south-west corner: m, m, rad

    @property
    def size(self):
        """m from west to east and from south to north."""
        return self.cells.shape[1] * self.resolution, self.cells.shape[0] * self.resolution

    def frame(self):
        """From m of the grid to m of the map's frame."""
        return Affine2D().rotate(self.origin[2]).translate(*self.origin[:2])


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
    for key in ROUTE_TEXTS:
        if not isinstance(route[key], str) or not route[key]:
            raise ToolError(f"{path}: {place}: {key} must be a text")
    need_numbers(path, place, route, [key for key in ROUTE_KEYS if key not in ROUTE_TEXTS and key != "bound"])


def check_drive(path, drive):
    need(path, "drive", drive, DRIVE_KEYS)
    need_list(path, "drive.waypoints_m", drive["waypoints_m"])
    for i, point in enumerate(drive["waypoints_m"]):
        need_vector(path, f"drive.waypoints_m[{i}]", point, 2)
    for key in ("planned", "predicted", "driven"):
        need_numbers(path, f"drive.{key}", drive[key], ("length_m", "energy_j", "time_s"))
    need_numbers(path, "drive", drive, ("margin_m", "end_error_m"))


def read_map(path):
    data = read_json(path)
    need(path, "map", data, MAP_KEYS)
    if data["format"] != MAP_FORMAT:
        raise ToolError(f"{path}: format: not {MAP_FORMAT}; import the map again with python -m tools.design.import_map")
    need_numbers(path, "map", data, ("width", "height", "resolution_m"))
    need_vector(path, "origin_m", data["origin_m"], 3)
    shape = data["height"], data["width"]
    rows = data["rows"] if isinstance(data["rows"], list) else []
    cells = grid(path, "rows", [list(str(row)) for row in rows], shape, str)
    elevation = data.get("elevation_m")
    if elevation is not None:
        elevation = grid(path, "elevation_m", elevation, shape, float)
    return Map(cells, elevation, data["resolution_m"], tuple(data["origin_m"]))


def grid(path, key, rows, shape, kind):
    """Rows of a map, the southern one first."""
    try:
        values = np.array(rows, dtype=kind)
    except (TypeError, ValueError):
        values = np.empty(0)
    if values.shape != shape or (kind is float and not np.isfinite(values).all()):
        raise ToolError(f"{path}: {key}: is no grid of {shape[0]} rows of {shape[1]} cells")
    return values[::-1]


def driven_path(log, start):
    """x, y in the map's frame of a log, which is in that of odometry: from the start, x ahead."""
    x, y, heading = start
    path = np.column_stack([log["x_m"], log["y_m"]])
    return Affine2D().rotate(math.radians(heading)).translate(x, y).transform(path)


# ---- the map -------------------------------------------------------------------------------------------------------

def ground_image(ground):
    """Colours of the cells."""
    if ground.elevation is None or min(ground.cells.shape) < 2:
        image = np.ones((*ground.cells.shape, 3)) * to_rgb(LEVEL)
    else:
        low, high = elevation_range(ground)
        shade = LightSource(azdeg=315, altdeg=50)
        image = shade.shade(np.clip(ground.elevation, low, high), GROUND, vert_exag=RELIEF, dx=ground.resolution,
                            dy=-ground.resolution, vmin=low, vmax=high, blend_mode="soft")[..., :3]
    image[ground.cells == UNKNOWN] = to_rgb(UNKNOWN_FILL)
    image[ground.cells == OCCUPIED] = to_rgb(OBSTACLE)
    return image


def elevation_range(ground):
    known = ground.elevation[ground.cells != UNKNOWN]
    if known.size == 0 or np.ptp(known) == 0:
        return 0.0, 1.0
    return known.min(), known.max()


def cell_centres(ground):
    """x and y in the map's frame of every cell."""
    rows, columns = ground.cells.shape
    x, y = np.meshgrid((np.arange(columns) + 0.5) * ground.resolution, (np.arange(rows) + 0.5) * ground.resolution)
    points = ground.frame().transform(np.column_stack([x.ravel(), y.ravel()]))
    return points[:, 0].reshape(x.shape), points[:, 1].reshape(y.shape)


def draw_ground(axes, ground):
    width, height = ground.size
    image = axes.imshow(ground_image(ground), origin="lower", extent=(0, width, 0, height), interpolation="nearest",
                        zorder=0)
    image.set_transform(ground.frame() + axes.transData)
    corners = ground.frame().transform([(0, 0), (width, 0), (0, height), (width, height)])
    axes.set_xlim(corners[:, 0].min(), corners[:, 0].max())
    axes.set_ylim(corners[:, 1].min(), corners[:, 1].max())
    if min(ground.cells.shape) >= 2:
        draw_contours(axes, ground)


def draw_contours(axes, ground):
    x, y = cell_centres(ground)
    unknown = ground.cells == UNKNOWN
    if unknown.any() and not unknown.all():
        with plt.rc_context({"hatch.color": UNKNOWN_HATCH, "hatch.linewidth": 0.6}):
            axes.contourf(x, y, unknown.astype(float), levels=[0.5, 1.5], colors="none", hatches=["////"], zorder=1)
    if ground.elevation is not None and np.ptp(ground.elevation) > 0:
        heights = np.ma.masked_where(ground.cells != FREE, ground.elevation)
        if heights.count() > 0 and np.ptp(heights.compressed()) > 0:
            axes.contour(x, y, heights, levels=CONTOURS, colors="#5B4A3A", linewidths=0.5, linestyles="solid",
                         alpha=0.45, zorder=1)


def draw_places(axes, summary):
    x, y, heading = summary["start"]
    marks = {"markersize": 16, "markeredgecolor": "white", "markeredgewidth": 1.3, "zorder": 6, "clip_on": False}
    axes.plot(x, y, marker=DART.transformed(Affine2D().rotate_deg(heading)), color=plots.INK, **marks)
    axes.plot(*summary["goal_m"], marker="*", color="#C2185B", **{**marks, "markersize": 18})
    for text, point in (("start", (x, y)), ("goal", summary["goal_m"])):
        axes.annotate(text, point, xytext=place_of_label(axes, point), textcoords="offset points", fontsize=10,
                      ha="center", fontweight="bold", zorder=7, path_effects=OUTLINE)


def place_of_label(axes, point):
    """Above a mark, or below where there is no room above."""
    low, high = axes.get_ylim()
    return (0, 12) if point[1] < low + 0.9 * (high - low) else (0, -21)


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
    entries.append((Patch(facecolor=OBSTACLE), "obstacle"))
    if (ground.cells == UNKNOWN).any():
        entries.append((Patch(facecolor=UNKNOWN_FILL, edgecolor=UNKNOWN_HATCH, hatch="////", linewidth=0), "unknown"))
    return zip(*entries)


def fill_map(figure, axes, summary, ground, routes, driven):
    draw_ground(axes, ground)
    drive = summary["drive"]
    draw_routes(axes, routes, driven, None if drive is None else np.array(drive["waypoints_m"], dtype=float))
    draw_places(axes, summary)
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    handles, labels = legend_of(summary, ground, routes)
    axes.legend(handles, labels, loc="lower left", bbox_to_anchor=(0, 1.01), ncols=2, borderaxespad=0,
                columnspacing=1.6, handlelength=2.6)
    if ground.elevation is not None:
        low, high = elevation_range(ground)
        scale = plt.cm.ScalarMappable(plt.Normalize(low, high), GROUND)
        figure.colorbar(scale, ax=axes, label="elevation, m", shrink=0.8, pad=0.015, aspect=32)


def map_height(ground):
    """Inches that the map takes at full width."""
    corners = ground.frame().transform([(0, 0), (ground.size[0], 0), (0, ground.size[1]), ground.size])
    width, height = np.ptp(corners, axis=0)
    return float(np.clip(WIDTH * height / width, *MAP_HEIGHT))


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
