#!/usr/bin/env python3
"""Make a page and a picture from the results of jp-navigate.

Reads DIR/summary.json, the log that it names, and the map that the robot had; writes DIR/report.html, one file that
needs nothing else, and DIR/navigate.png. Exit status 2: bad input; nothing was written.
"""
from pathlib import Path

import numpy as np
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from tools.common import ArgumentParser, ToolError, run, shown_path, write_whole
from tools.report import plots
from tools.report.ground import (FREE, OUTLINE, WIDTH, draw_ground, draw_places, finish_map, legend_entries, map_height,
                                 read_map)
from tools.report.results import (format_number, need, need_list, need_numbers, need_points, need_texts, need_vector,
                                  read_columns, read_json, render_page)

SUMMARY_KEYS = ("robot", "map", "steepest", "steep_cells", "start", "goal", "view_m", "hidden_boxes", "memory_bytes",
                "seed", "result", "courses", "seen", "log")
RESULT_TEXTS = ("state", "reason")
RESULT_NUMBERS = ("replans", "cells_seen", "clearance_m", "goal_error_m", "deviation_m", "length_m", "time_s", "energy_j",
                  "planned_j", "forecast_j", "forecast_deviation_j")
LOG_COLUMNS = ("t_s", "x_m", "y_m", "energy_j", "left_m")

ENDS = ("arrived", "unreachable", "failed")
NO_REASON = "-"
# States of the log by what is seen of them: label, states, colour.
PHASES = (("stands and plans", ("planning", "proving", "joining"), "#DCCFE6"),
          ("turns on the spot", ("turning",), "#CDE3F1"),
          ("drives", ("driving",), "#F1F6EC"),
          ("brakes", ("braking",), "#F8C4B8"))
STATES = {"idle", *ENDS}.union(*(states for _, states, _ in PHASES))
# Only in them the robot has a course, and a length that is left of it.
ON_COURSE = ("turning", "driving", "arrived")

DRIVEN, SEEN, BLOCKED = plots.BLUE, "#E8331C", "#B3122A"
STEEP = "#A08A78"
FIRST = {"color": "#E58A00", "linewidth": 1.9, "linestyle": (0, (4, 1.8))}
FIRST_TEXT = "#8A5200"  # its colour, dark enough to read
LATER = {"color": plots.PURPLE, "linewidth": 1.1, "linestyle": (0, (3, 2)), "alpha": 0.6}
ANEW = {"color": "white", "markeredgecolor": plots.PURPLE, "markeredgewidth": 1.4, "markersize": 11}
STOPPED = {"marker": "8", "color": BLOCKED, "markeredgecolor": "white", "markersize": 19, "linestyle": "none"}

# Standard deviations to either side that hold 95 % of a normal distribution.
SPREAD = 1.96
# jp-navigate tells clearances up to it, m.
CLEARANCE_MAX = 0.25
PANEL_HEIGHT = 2.3  # inches
PANELS = 2


# ---- input ---------------------------------------------------------------------------------------------------------

def read_summary(path):
    summary = read_json(path)
    need(path, "summary", summary, SUMMARY_KEYS)
    need_texts(path, "summary", summary, ("robot", "log"))
    need_texts(path, "map", summary["map"], ("file", "name"))
    need_texts(path, "map", summary["map"], ("note",), least=0)
    need_numbers(path, "summary", summary, ("steepest", "steep_cells", "view_m", "hidden_boxes", "memory_bytes", "seed"))
    need_vector(path, "start", summary["start"], 3)
    need_vector(path, "goal", summary["goal"], 3)
    check_result(path, summary["result"])
    check_courses(path, summary["courses"])
    return summary


def check_result(path, result):
    need_texts(path, "result", result, RESULT_TEXTS)
    need_numbers(path, "result", result, RESULT_NUMBERS)
    need(path, "result", result, ("touched",))
    if not isinstance(result["touched"], bool):
        raise ToolError(f"{path}: result: touched must be true or false")
    if result["state"] not in STATES:
        raise ToolError(f"{path}: result: state {result['state']!r} is not known")


def check_courses(path, courses):
    if not isinstance(courses, list):
        raise ToolError(f"{path}: courses: must be a list")
    for i, course in enumerate(courses):
        place = f"courses[{i}]"
        need_texts(path, place, course, ("reason",))
        need_numbers(path, place, course, ("time_s",))
        need(path, place, course, ("points_m",))
        need_list(path, f"{place}.points_m", course["points_m"])
        need_points(path, f"{place}.points_m", course["points_m"])


def check_seen(path, seen, ground):
    """Cells must be on the map, where they are drawn."""
    if not isinstance(seen, list):
        raise ToolError(f"{path}: seen: must be a list")
    rows, columns = ground.cells.shape
    for i, cell in enumerate(seen):
        need_vector(path, f"seen[{i}]", cell, 3)
        x, y = cell[:2]
        if not (x in range(columns) and y in range(rows)):
            raise ToolError(f"{path}: seen[{i}]: [{x}, {y}] is no cell of the map, {columns} × {rows} cells")


def read_log(path):
    log = read_columns(path, LOG_COLUMNS, rows_min=1, texts=("state", "reason"))
    for i, state in enumerate(log["state"]):
        if state not in STATES:
            raise ToolError(f"{path}: line {i + 2}: state {str(state)!r} is not known")
    return log


# ---- the map -------------------------------------------------------------------------------------------------------

def draw_seen(axes, ground, seen):
    """The cells that the robot saw and the map does not show, as cells of the map."""
    image = np.zeros((*ground.cells.shape, 4))
    for x, y, _ in seen:
        image[int(y), int(x)] = to_rgba(SEEN)
    width, height = ground.size
    drawn = axes.imshow(image, origin="lower", extent=(0, width, 0, height), interpolation="nearest", zorder=2)
    drawn.set_transform(ground.frame() + axes.transData)


def steep_cells(ground, steepest):
    """True where free ground rises by more, rise over run, in any direction: between the neighbours of a cell."""
    if ground.elevation is None or min(ground.cells.shape) < 2:
        return np.zeros(ground.cells.shape, dtype=bool)
    return (np.hypot(*np.gradient(ground.elevation, ground.resolution)) > steepest) & (ground.cells == FREE)


def draw_steep(axes, ground, steepest):
    """Ground on which the robot may not be."""
    image = np.zeros((*ground.cells.shape, 4))
    image[steep_cells(ground, steepest)] = to_rgba(STEEP)
    width, height = ground.size
    drawn = axes.imshow(image, origin="lower", extent=(0, width, 0, height), interpolation="nearest", zorder=0.5)
    drawn.set_transform(ground.frame() + axes.transData)


def draw_courses(axes, courses):
    """The first course over the later ones, and a numbered mark where each later one begins."""
    for i, course in enumerate(courses):
        axes.plot(*np.array(course["points_m"]).T, zorder=5 if i == 0 else 4.5, **(LATER if i else FIRST))
    for i, course in enumerate(courses[1:], start=1):
        point = course["points_m"][0]
        axes.plot(*point, "o", zorder=6, **ANEW)
        axes.annotate(str(i), point, fontsize=7.5, ha="center", va="center_baseline", color=plots.PURPLE,
                      fontweight="bold", zorder=6)


def phase_spans(log, states):
    """(from, until) in s of the times in any of the states; each lasts until the next line of the log."""
    return plots.spans_of(log["t_s"], np.isin(log["state"], states))


def stops(log):
    """x, y where it came to a stand because the way ahead was blocked."""
    braking = (log["state"] == "braking") & (log["reason"] == "blocked ahead")
    last = np.flatnonzero(braking & ~np.append(braking[1:], False))
    return np.column_stack([log["x_m"], log["y_m"]])[last]


def legend_of(summary, ground, log):
    result, courses = summary["result"], summary["courses"]
    driven = f"driven: {format_number(result['length_m'], 1, 'm')}, {format_number(result['energy_j'], 0, 'J')}"
    entries = [(Line2D([], [], color=DRIVEN, linewidth=3), driven)]
    if courses:
        planned = f", planned {format_number(result['planned_j'], 0, 'J')}" if result["planned_j"] else ""
        first = f"first course: {format_number(course_length(courses[0]), 1, 'm')}{planned}, {forecast_text(result)} forecast"
        entries.append((Line2D([], [], **FIRST), first))
    if courses[1:]:
        line = Line2D([], [], marker="o", markerfacecolor="white", **{**ANEW, **LATER, "markersize": 7, "alpha": 1})
        entries.append((line, "planned anew, from where its number stands"))
    if stops(log).size:
        entries.append((Line2D([], [], **{**STOPPED, "markersize": 12}), "braked to a stand: blocked ahead"))
    entries += legend_entries(ground)
    if summary["steep_cells"]:
        steepest = format_number(np.degrees(np.arctan(summary["steepest"])), 0)
        entries.append((Patch(facecolor=STEEP), f"too steep for the robot: above {steepest}°"))
    if summary["seen"]:
        entries.append((Patch(facecolor=SEEN), f"seen on the way, not on the map: {len(summary['seen'])} cells"))
    return entries


def fill_map(figure, axes, summary, ground, log):
    draw_ground(axes, ground)
    draw_steep(axes, ground, summary["steepest"])
    draw_seen(axes, ground, summary["seen"])
    axes.plot(log["x_m"], log["y_m"], color=DRIVEN, linewidth=3, solid_capstyle="round", zorder=4,
              path_effects=OUTLINE)
    draw_courses(axes, summary["courses"])
    axes.plot(*stops(log).T, zorder=5.5, **STOPPED)
    draw_places(axes, summary["start"], summary["goal"][:2])
    finish_map(figure, axes, ground, legend_of(summary, ground, log))


def draw_map(summary, ground, log):
    figure, axes = plots.new_figure(WIDTH, map_height(ground) + 0.8)
    fill_map(figure, axes, summary, ground, log)
    return figure


# ---- over time -----------------------------------------------------------------------------------------------------

def shade_phases(axis, log):
    for _, states, colour in PHASES:
        for first, end in phase_spans(log, states):
            axis.axvspan(first, end, color=colour, linewidth=0, zorder=0)


def fill_energy(axis, summary, log):
    """Energy so far, over what was forecast before anything of the world was seen."""
    result = summary["result"]
    if summary["courses"]:
        low, high = (result["forecast_j"] + sign * SPREAD * result["forecast_deviation_j"] for sign in (-1, 1))
        axis.axhspan(low, high, color=FIRST["color"], alpha=0.3, linewidth=0, zorder=1.5)
        axis.axhline(result["forecast_j"], zorder=1.6, **{**FIRST, "linewidth": 1.3})
        axis.annotate(f"forecast {forecast_text(result)}", (0, high), xytext=(6, 3), textcoords="offset points",
                      fontsize=9, color=FIRST_TEXT, fontweight="bold", zorder=4)
    axis.plot(log["t_s"], log["energy_j"], color=DRIVEN, linewidth=2.2, zorder=3)
    axis.annotate(format_number(log["energy_j"][-1], 0, "J"), (log["t_s"][-1], log["energy_j"][-1]), xytext=(0, 6),
                  textcoords="offset points", fontsize=9, ha="right", color=DRIVEN, fontweight="bold", zorder=4)
    axis.set_ylabel("energy so far, J")
    axis.margins(y=0.15)
    axis.set_ylim(bottom=0)


def fill_left(axis, log):
    """Length that is left of the course; none while there is no course."""
    left = np.where(np.isin(log["state"], ON_COURSE), log["left_m"], np.nan)
    axis.plot(log["t_s"], left, color=DRIVEN, linewidth=2.2, zorder=3)
    if np.isnan(left).all():
        axis.set_yticks([])
        axis.annotate("no course", (0.5, 0.5), xycoords="axes fraction", ha="center", va="center")
    axis.set_ylabel("left of the course, m")
    axis.set_xlabel("time, s")
    axis.set_ylim(bottom=0)


def number_courses(axes, courses):
    """Lines where a course was planned anew, with the numbers of the map."""
    for i, course in enumerate(courses[1:], start=1):
        for axis in axes:
            axis.axvline(course["time_s"], color=plots.PURPLE, linewidth=0.9, linestyle=(0, (3, 2)), zorder=2)
        axes[0].annotate(str(i), (course["time_s"], 1), xycoords=("data", "axes fraction"), xytext=(0, 2),
                         textcoords="offset points", fontsize=9, ha="center", color=plots.PURPLE, fontweight="bold")


def panels_legend(summary, log):
    entries = [(Line2D([], [], color=DRIVEN, linewidth=2.2), "this drive")]
    if summary["courses"]:
        band = Patch(facecolor=to_rgba(FIRST["color"], 0.3), edgecolor=FIRST["color"], linestyle="--")
        entries.append((band, "forecast of the first course, 95 %"))
    if summary["courses"][1:]:
        entries.append((Line2D([], [], color=plots.PURPLE, linewidth=0.9, linestyle=(0, (3, 2))), "planned anew"))
    entries += [(Patch(facecolor=colour, edgecolor="#C4CCD4", linewidth=0.6), label)
                for label, states, colour in PHASES if np.isin(log["state"], states).any()]
    return zip(*entries)


def fill_panels(axes, summary, log):
    for axis in axes:
        shade_phases(axis, log)
        axis.grid(False)
        # A drive that is over at once has a width too.
        axis.set_xlim(0, max(log["t_s"][-1], 1))
    fill_energy(axes[0], summary, log)
    fill_left(axes[1], log)
    number_courses(axes, summary["courses"])
    axes[0].tick_params(labelbottom=False)
    axes[0].legend(*panels_legend(summary, log), loc="lower left", bbox_to_anchor=(0, 1.06), ncols=4,
                   borderaxespad=0, columnspacing=1.6)


def draw_panels(summary, log):
    figure, axes = plots.new_figure(WIDTH, 0.6 + PANEL_HEIGHT * PANELS, PANELS)
    fill_panels(axes, summary, log)
    return figure


def draw_drive(summary, ground, log):
    """Map and panels in one picture."""
    heights = [map_height(ground) + 0.8] + [PANEL_HEIGHT] * PANELS
    figure, axes = plots.new_figure(WIDTH, sum(heights) + 0.5, 1 + PANELS, height_ratios=heights)
    fill_map(figure, axes[0], summary, ground, log)
    fill_panels(axes[1:], summary, log)
    return figure


# ---- page ----------------------------------------------------------------------------------------------------------

def course_length(course):
    """m along the waypoints."""
    return float(np.hypot(*np.diff(np.array(course["points_m"], dtype=float), axis=0).T).sum())


def course_rows(courses):
    """What the table tells of each course; its first point is where the robot stood."""
    return [{"time_s": course["time_s"], "reason": course["reason"] if course["reason"] != NO_REASON else "–",
             "waypoints": len(course["points_m"]) - 1, "length_m": course_length(course),
             "colour": (LATER if i else FIRST)["color"]} for i, course in enumerate(courses)]


def forecast_text(result):
    spread = format_number(SPREAD * result["forecast_deviation_j"], 0, "J")
    return f"{format_number(result['forecast_j'], 0)} ± {spread}"


def outcome(result):
    """(value, label) of how it ended."""
    left = f"{format_number(result['goal_error_m'], 2, 'm')} from the goal"
    if result["deviation_m"]:
        left += f", known to {format_number(result['deviation_m'], 2, 'm')}"
    if result["state"] not in ENDS:
        return "given up", f"while {result['state']}, {left}"
    reason = "" if result["reason"] == NO_REASON else f"{result['reason']}, "
    return result["state"], reason + left


def clearance(result):
    if result["touched"]:
        return "touched", "something in the way"
    least = "≥ " if result["clearance_m"] >= CLEARANCE_MAX else ""
    return least + format_number(100 * result["clearance_m"], 1, "cm"), "least clearance"


def headlines(summary):
    """(value, label) of the numbers at the top."""
    result = summary["result"]
    forecast = forecast_text(result) if summary["courses"] else format_number(None)
    times = "once" if result["replans"] == 1 else f"{result['replans']} times"
    return [outcome(result),
            (format_number(result["energy_j"], 0, "J"), "energy driven"),
            (forecast, "forecast of the first course, 95\u202f%"),
            (format_number(result["length_m"], 1, "m"), f"driven in {format_number(result['time_s'], 1, 's')}"),
            clearance(result),
            (format_number(result["cells_seen"], 0), f"cells not on the map; planned anew {times}")]


def figures(summary, ground, log):
    drawn = [("The drive over the map", summary["map"]["note"], draw_map(summary, ground, log)),
             ("Over time", "Energy against the forecast that was made before the first metre, and what was left of the "
              "course.", draw_panels(summary, log))]
    return [(name, caption, plots.inline_png(figure, dpi=130)) for name, caption, figure in drawn]


def render(summary, ground, log):
    return render_page("navigate.html.j2", summary=summary, ground=ground, headlines=headlines(summary),
                       courses=course_rows(summary["courses"]), figures=figures(summary, ground, log))


def load(directory):
    path = directory / "summary.json"
    summary = read_summary(path)
    ground = read_map(Path(summary["map"]["file"]))
    check_seen(path, summary["seen"], ground)
    return summary, ground, read_log(directory / summary["log"])


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("directory", metavar="DIR", type=Path, help="holds summary.json and the log")
    directory = parser.parse_args().directory
    results = load(directory)
    picture = plots.png_bytes(draw_drive(*results), dpi=120)
    for name, content in (("report.html", render(*results)), ("navigate.png", picture)):
        write_whole(directory / name, content)
        print(f"wrote {shown_path(directory / name)}")
    return 0


if __name__ == "__main__":
    run(main)
