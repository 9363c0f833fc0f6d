#!/usr/bin/env python3
"""Make a page and a picture from the results of jp-patrol, of drives or of a round.

Reads DIR/summary.json and the logs that it names; writes DIR/report.html, one file that needs nothing else, and
DIR/patrol.png. Exit status 2: bad input; nothing was written.
"""
from dataclasses import dataclass
from pathlib import Path

import matplotlib.patheffects
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Polygon

from tools.common import ArgumentParser, ToolError, run, shown_path, write_whole
from tools.report import plots, round_report
from tools.report.ground_cells import (FILLS, HIDDEN, SOLID, check_map, draw_ground, draw_robot, map_window, placed,
                                       rectangle)
from tools.report.plots import spans_of
from tools.report.results import (format_number, need, need_list, need_numbers, need_points, need_texts, need_vector,
                                  read_columns, read_json, render_page)

SUMMARY_KEYS = ("robot", "scene", "robot_size_m", "seed", "map", "start", "goal", "limit_s", "faults", "states",
                "reasons", "methods")
METHOD_TEXTS = ("name", "title", "log", "outcome", "reason")
METHOD_NUMBERS = ("time_s", "length_m", "energy_j", "reversed_m", "direction_changes", "clearance_min_m",
                  "position_error_m", "heading_error_deg", "odometry_error_m")
PLANNER_KEYS = ("turning_points", "expansions", "edge_nodes", "bytes", "path_length_m")
COUNT_KEYS = ("cycles", "turns", "waits", "infeasible_bands", "laser_missing", "laser_rejected", "scans_missing",
              "shapes_dropped", "replans")
OBSTACLE_KEYS = ("x_m", "y_m", "heading_deg", "radius_m", "length_m", "width_m")
LOG_COLUMNS = ("t_s", "x_m", "y_m", "heading_deg", "speed_m_s", "turn_rate_rad_s", "clearance_m", "state")
TURNING = 1  # number of the state of turning in place

MOVER = plots.PURPLE
WAY = plots.GREEN
COLLISION = "#C2185B"
OUTLINE = [matplotlib.patheffects.withStroke(linewidth=3, foreground="white")]

LOOKS = {"improved": {"color": plots.BLUE, "linewidth": 2.4, "zorder": 5},
         "plain": {"color": plots.ORANGE, "linewidth": 1.7, "zorder": 4},
         "pursuit": {"color": plots.GREY, "linewidth": 1.5, "linestyle": (0, (4, 1.6)), "zorder": 3}}

WIDTH = 11.0             # inches
MAP_HEIGHT = 3.0, 9.0    # when the panels are below
PANEL_HEIGHT = 1.7
TALL = 1.05              # a map so much higher than wide has the panels beside it
OUTLINES_MAX = 30        # of the robot along a track
OUTLINE_STEP = 0.2       # m, least from one to the next
PERIODS = 1, 2, 5, 10, 20, 60  # s, from one to the next


@dataclass(frozen=True)
class Drive:
    """A method's part of the summary and its log by columns."""
    about: dict
    log: dict

    @property
    def look(self):
        return LOOKS.get(self.about["name"], {"color": plots.PURPLE, "linewidth": 1.5, "zorder": 3})

    @property
    def arrived(self):
        return self.about["outcome"] == "arrived"

    @property
    def stands(self):
        """Whether it drove, but not to the goal."""
        return not self.arrived and self.log["t_s"].size > 0

    @property
    def outcome(self):
        reason = self.about["reason"]
        return f"{self.about['outcome']}: {reason}" if reason else self.about["outcome"]

    @property
    def label(self):
        return f"{self.about['title']}: {self.outcome}, {format_number(self.about['time_s'], 1, 's')}"


# ---- input ---------------------------------------------------------------------------------------------------------

def check_summary(path, summary):
    need(path, "summary", summary, SUMMARY_KEYS)
    need_texts(path, "summary", summary, ("robot", "scene"))
    need_vector(path, "robot_size_m", summary["robot_size_m"], 2)
    need_vector(path, "start", summary["start"], 3)
    need_vector(path, "goal", summary["goal"], 3)
    check_map(path, summary["map"])
    need(path, "faults", summary["faults"], ("beam_dropout", "scan_dropout_s", "jump_s_m", "slip"))
    need_list(path, "methods", summary["methods"])
    for i, method in enumerate(summary["methods"]):
        check_method(path, f"methods[{i}]", method)


def check_method(path, place, method):
    need(path, place, method, (*METHOD_TEXTS, *METHOD_NUMBERS, "planner", "counts", "plans", "snapshots"))
    need_texts(path, place, method, METHOD_TEXTS, least=0)
    need_numbers(path, place, method, METHOD_NUMBERS)
    need_numbers(path, f"{place}.planner", method["planner"], PLANNER_KEYS)
    need_numbers(path, f"{place}.counts", method["counts"], COUNT_KEYS)
    for key, check in (("plans", check_plan), ("snapshots", check_snapshot)):
        if not isinstance(method[key], list):
            raise ToolError(f"{path}: {place}.{key}: must be a list")
        for i, item in enumerate(method[key]):
            check(path, f"{place}.{key}[{i}]", item)


def check_plan(path, place, plan):
    need(path, place, plan, ("time_s", "way_m", "path_m"))
    for key in ("way_m", "path_m"):
        need_points(path, f"{place}.{key}", plan[key])


def check_snapshot(path, place, snapshot):
    need(path, place, snapshot, ("time_s", "band_m", "obstacles"))
    need_points(path, f"{place}.band_m", snapshot["band_m"])
    for i, obstacle in enumerate(snapshot["obstacles"]):
        need_numbers(path, f"{place}.obstacles[{i}]", obstacle, OBSTACLE_KEYS)


def read_log(path):
    """Without a path to follow a log has no lines."""
    return read_columns(path, LOG_COLUMNS, 0) or {name: np.empty(0) for name in LOG_COLUMNS}


def load(directory):
    summary = read_json(directory / "summary.json")
    check_summary(directory / "summary.json", summary)
    return summary, [Drive(about, read_log(directory / about["log"])) for about in summary["methods"]]


# ---- the map -------------------------------------------------------------------------------------------------------

def map_extent(summary, drives):
    """West, east, south and north of what is shown: where the drives are, and some of the map around."""
    points = [summary["start"][:2], summary["goal"][:2]]
    for drive in drives:
        points += list(zip(drive.log["x_m"], drive.log["y_m"]))
        points += [point for plan in drive.about["plans"] for point in plan["path_m"]]
    return map_window(summary["map"], points)


def outline_period(seconds):
    return next((period for period in PERIODS if seconds / period <= OUTLINES_MAX), PERIODS[-1])


def draw_outlines(axes, drive, size, period):
    """Where the robot got on since the last outline: turns in place would cover it."""
    log = drive.log
    drawn = np.array([np.inf, np.inf])
    for i in np.searchsorted(log["t_s"], np.arange(0, drive.about["time_s"], period)):
        if i < log["t_s"].size and not np.hypot(*(drawn - (log["x_m"][i], log["y_m"][i]))) < OUTLINE_STEP:
            drawn = np.array([log["x_m"][i], log["y_m"][i]])
            draw_robot(axes, size, (*drawn, log["heading_deg"][i]), facecolor="none", edgecolor=drive.look["color"],
                       linewidth=0.8, alpha=0.6, zorder=2.5)


def draw_plans(axes, plans):
    """The first way and path, and thinner those that were planned anew."""
    for i, plan in enumerate(plans):
        strength = 1 if i == 0 else 0.6
        if plan["way_m"]:
            axes.plot(*np.array(plan["way_m"]).T, "o--", color=WAY, linewidth=1.1 * strength, markersize=5 * strength,
                      markerfacecolor="white", zorder=3.5)
        if plan["path_m"]:
            axes.plot(*np.array(plan["path_m"]).T, color=WAY, linewidth=1.3 * strength, alpha=0.7, zorder=3.4)


def draw_bands(axes, drive):
    for snapshot in drive.about["snapshots"]:
        if len(snapshot["band_m"]) > 1:
            axes.plot(*np.array(snapshot["band_m"]).T, color=drive.look["color"], linewidth=0.7, alpha=0.35, zorder=4)


def shape_patch(obstacle, **look):
    if obstacle["radius_m"] > 0:
        return Circle((obstacle["x_m"], obstacle["y_m"]), obstacle["radius_m"], **look)
    outline = rectangle(obstacle["length_m"], obstacle["width_m"])
    return Polygon(placed(outline, obstacle["x_m"], obstacle["y_m"], obstacle["heading_deg"]), closed=True, **look)


def moves(snapshots):
    """Whether anything is in different places."""
    return len({(o["x_m"], o["y_m"]) for s in snapshots for o in s["obstacles"]}) > len(
        snapshots[-1]["obstacles"]) if snapshots else False


def draw_obstacles(axes, drive, period):
    """What stands is there in full; what moves leaves a trail of rings, with the times."""
    snapshots = drive.about["snapshots"]
    if not moves(snapshots):
        for obstacle in snapshots[-1]["obstacles"] if snapshots else []:
            axes.add_patch(shape_patch(obstacle, facecolor=FILLS[HIDDEN], edgecolor="none", zorder=1))
        return
    for i, snapshot in enumerate(snapshots):
        last = i + 1 == len(snapshots)
        for obstacle in snapshot["obstacles"]:
            axes.add_patch(shape_patch(obstacle, facecolor=MOVER if last else "none", edgecolor=MOVER, linewidth=1,
                                       alpha=0.55, zorder=2))
            if round(snapshot["time_s"]) % (2 * period) == 0:
                axes.annotate(f"{snapshot['time_s']:.0f} s", (obstacle["x_m"], obstacle["y_m"]), fontsize=7,
                              color=MOVER, ha="center", va="center", zorder=6, path_effects=OUTLINE)


def draw_times(axes, summary, drive, period):
    """Dots along the track with their times, away from each other, start and goal."""
    log, size = drive.log, summary["robot_size_m"][0]
    taken = [summary["start"][:2], summary["goal"][:2]]
    for i in np.searchsorted(log["t_s"], np.arange(0, drive.about["time_s"], 2 * period)):
        if i == log["t_s"].size:
            break
        place = log["x_m"][i], log["y_m"][i]
        if min(np.hypot(*np.subtract(taken, place).T)) < size:
            continue
        taken.append(place)
        axes.plot(*place, "o", color=drive.look["color"], markersize=4, zorder=5.5)
        axes.annotate(f"{log['t_s'][i]:.0f} s", place, xytext=(5, 5), textcoords="offset points", fontsize=8,
                      color=drive.look["color"], fontweight="bold", zorder=7, path_effects=OUTLINE)


def draw_end(axes, drive, size, place):
    """A mark where a drive did not arrive, and the robot as it stands there."""
    colour = COLLISION if drive.about["outcome"] == "collided" else plots.INK
    x, y, heading = (drive.log[key][-1] for key in ("x_m", "y_m", "heading_deg"))
    draw_robot(axes, size, (x, y, heading), facecolor=(*to_rgb(drive.look["color"]), 0.25),
               edgecolor=drive.look["color"], zorder=3)
    axes.plot(x, y, "X", color=colour, markeredgecolor="white", markersize=11, zorder=8)
    axes.annotate(f"{drive.about['title']}: {drive.outcome}", (x, y), xytext=(8, -11 - 10 * place),
                  textcoords="offset points", fontsize=8, color=colour, fontweight="bold", zorder=8,
                  path_effects=OUTLINE)


def draw_places(axes, summary):
    """Start and goal; their names on the sides away from each other."""
    apart = np.subtract(summary["start"][:2], summary["goal"][:2])
    apart = apart / max(np.hypot(*apart), 1e-9) * 0.95 * summary["robot_size_m"][0]
    for name, colour, aside in (("start", plots.INK, apart), ("goal", COLLISION, -apart)):
        draw_robot(axes, summary["robot_size_m"], summary[name], facecolor="none", edgecolor=colour, linewidth=2,
                   zorder=6)
        axes.annotate(name, np.add(summary[name][:2], aside), fontsize=10, ha="center", va="center", color=colour,
                      fontweight="bold", zorder=9, path_effects=OUTLINE)


def map_legend(summary, drives):
    entries = [(Line2D([], [], **{**drive.look, "zorder": 1}), drive.label) for drive in drives]
    entries.append((Line2D([], [], color=WAY, marker="o", markerfacecolor="white", linestyle="--", linewidth=1.1,
                           markersize=5), "any-angle A*: turning points, and smoothed path"))
    if len(drives[0].about["plans"]) > 1:
        entries[-1] = entries[-1][0], f"{entries[-1][1]}; planned {len(drives[0].about['plans'])} times"
    entries.append((Patch(facecolor=FILLS[SOLID]), "on the map"))
    snapshots = drives[0].about["snapshots"]
    if any(HIDDEN in row for row in summary["map"]["rows"]) or (
            not moves(snapshots) and snapshots and snapshots[-1]["obstacles"]):
        entries.append((Patch(facecolor=FILLS[HIDDEN]), "there, but not on the map"))
    if moves(snapshots):
        entries.append((Line2D([], [], color=MOVER, marker="o", markerfacecolor="none", linestyle="none"),
                        f"moving, every second while {drives[0].about['title']} drives"))
    return zip(*entries)


def fill_map(axes, summary, drives):
    draw_ground(axes, summary["map"])
    size = summary["robot_size_m"]
    period = outline_period(max(drive.about["time_s"] for drive in drives))
    draw_plans(axes, drives[0].about["plans"])
    draw_bands(axes, drives[0])
    draw_obstacles(axes, drives[0], period)
    for drive in drives:
        axes.plot(drive.log["x_m"], drive.log["y_m"], **drive.look)
    for place, drive in enumerate(drive for drive in drives if drive.stands):
        draw_end(axes, drive, size, place)
    draw_outlines(axes, drives[0], size, period)
    draw_times(axes, summary, drives[0], period)
    draw_places(axes, summary)
    west, east, south, north = map_extent(summary, drives)
    axes.set_xlim(west, east)
    axes.set_ylim(south, north)
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")


# ---- over time -----------------------------------------------------------------------------------------------------

PANELS = (("speed_m_s", "speed, m/s"), ("turn_rate_rad_s", "turn rate, rad/s"), ("clearance_m", "clearance, m, up to 1"))


def fill_panels(axes, drives):
    for axis, (column, label) in zip(axes, PANELS):
        for drive in drives:
            axis.plot(drive.log["t_s"], drive.log[column], label=drive.about["title"],
                      **{**drive.look, "linewidth": 0.7 * drive.look["linewidth"]})
            if drive.stands:
                axis.plot(drive.log["t_s"][-1], drive.log[column][-1], "X", color=drive.look["color"],
                          markeredgecolor="white", markersize=8, zorder=8)
        for i, (first, end) in enumerate(spans_of(drives[0].log["t_s"], drives[0].log["state"] == TURNING)):
            axis.axvspan(first, end, color=plots.BLUE, alpha=0.1, linewidth=0,
                         label=f"{drives[0].about['title']} turns in place" if i == 0 else None)
        axis.axhline(0, color="#B8C0C8", linewidth=0.8, zorder=1)
        axis.set_ylabel(label)
        axis.set_xlim(left=0)
    low, high = axes[0].get_ylim()
    if low < -0.05:
        axes[0].axhspan(low, 0, color=plots.ORANGE, alpha=0.07, linewidth=0)
        axes[0].annotate("backwards", (0.995, 0.06), xycoords="axes fraction", fontsize=8, ha="right",
                         color=plots.ORANGE)
        axes[0].set_ylim(low, high)
    axes[2].set_ylim(bottom=0)
    axes[2].set_xlabel("time, s")


def draw_panels(drives):
    figure, axes = plots.new_figure(WIDTH, 3 * PANEL_HEIGHT + 0.5, 3, sharex=True)
    fill_panels(axes, drives)
    handles, labels = axes[0].get_legend_handles_labels()
    axes[0].legend(handles, labels, loc="lower left", bbox_to_anchor=(0, 1), ncols=4)
    return figure


# ---- both ----------------------------------------------------------------------------------------------------------

def map_ratio(summary, drives):
    west, east, south, north = map_extent(summary, drives)
    return (north - south) / (east - west)


def add_legend(figure, summary, drives):
    handles, labels = map_legend(summary, drives)
    figure.legend(handles, labels, loc="outside upper left", ncols=2, columnspacing=1.6, handlelength=2.6)


def draw_map(summary, drives):
    ratio = map_ratio(summary, drives)
    height = float(np.clip(WIDTH * ratio, *MAP_HEIGHT))
    figure, axes = plots.new_figure(min(WIDTH, max(height / ratio + 1, 0.7 * WIDTH)), height + 1.1)
    fill_map(axes, summary, drives)
    add_legend(figure, summary, drives)
    return figure


def draw_patrol(summary, drives):
    """Map and panels in one picture: below each other, or beside when the map is high."""
    ratio = map_ratio(summary, drives)
    if ratio > TALL:
        height = float(np.clip(0.5 * WIDTH * ratio, *MAP_HEIGHT))
        figure = plt.figure(figsize=(WIDTH, height + 1.1))
        axes = figure.subplot_mosaic([["map", "0"], ["map", "1"], ["map", "2"]], width_ratios=[1.1, 1])
    else:
        height = float(np.clip(WIDTH * ratio, *MAP_HEIGHT))
        figure = plt.figure(figsize=(WIDTH, height + 1.1 + 3 * PANEL_HEIGHT))
        axes = figure.subplot_mosaic([["map"], ["0"], ["1"], ["2"]], height_ratios=[height] + 3 * [PANEL_HEIGHT])
    panels = [axes[str(i)] for i in range(3)]
    for axis in panels[:2]:
        axis.sharex(panels[2])
        axis.tick_params(labelbottom=False)
    fill_map(axes["map"], summary, drives)
    fill_panels(panels, drives)
    spans = [handle for handle in panels[0].get_legend_handles_labels()[1] if handle.endswith("in place")]
    if spans:
        panels[0].annotate("shaded: " + spans[0], (0.005, 1.02), xycoords="axes fraction", fontsize=8,
                           color=plots.BLUE)
    add_legend(figure, summary, drives)
    return figure


# ---- page ----------------------------------------------------------------------------------------------------------

def headlines(summary):
    """(value, label) of the numbers at the top."""
    first = summary["methods"][0]
    return [(first["outcome"], first["title"] + (f": {first['reason']}" if first["reason"] else "")),
            (format_number(first["time_s"], 1, "s"), f"on the way, of {summary['limit_s']:.0f}\u202fs"),
            (format_number(100 * first["clearance_min_m"], 1, "cm"), "least clearance of the true shapes"),
            (format_number(100 * first["position_error_m"], 1, "cm"),
             f"off the goal, and {format_number(first['heading_error_deg'], 1, '°')}"),
            (format_number(first["reversed_m"], 2, "m"), "driven backwards"),
            (format_number(first["planner"]["turning_points"], 0), "turning points of the way")]


def fault_lines(faults):
    lines = []
    if faults["beam_dropout"] > 0:
        lines.append(f"{format_number(100 * faults['beam_dropout'], 0, '%')} of the beams drop out")
    first, end = faults["scan_dropout_s"]
    if end > first:
        lines.append(f"no scans from {first:g} to {end:g}\u202fs")
    when, jump = faults["jump_s_m"]
    if when >= 0:
        lines.append(f"the laser's pose jumps by {format_number(jump, 2, 'm')} at {when:g}\u202fs")
    if faults["slip"]:
        lines.append("slippery ground")
    return lines


def figures(summary, drives):
    drawn = [("The drives", f"The true tracks; of the {drives[0].about['title']} also its outlines, its bands once a "
              "second and the times.", draw_map(summary, drives)),
             ("Over time", "As the simulator knows them; a cross ends a drive that did not arrive.",
              draw_panels(drives))]
    return [(name, caption, plots.inline_png(figure, dpi=130)) for name, caption, figure in drawn]


def render(summary, drives):
    return render_page("patrol.html.j2", summary=summary, headlines=headlines(summary), drives=drives,
                       faults=fault_lines(summary["faults"]), figures=figures(summary, drives))


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("directory", metavar="DIR", type=Path, help="holds summary.json and the logs")
    directory = parser.parse_args().directory
    summary = read_json(directory / "summary.json")
    if isinstance(summary, dict) and summary.get("kind") == "round":
        results = round_report.read_round(directory / "summary.json", summary)
        page, picture = round_report.render(results), round_report.picture(results)
    else:
        results = load(directory)
        page, picture = render(*results), plots.png_bytes(draw_patrol(*results), dpi=120)
    for name, content in (("report.html", page), ("patrol.png", picture)):
        write_whole(directory / name, content)
        print(f"wrote {shown_path(directory / name)}")
    return 0


if __name__ == "__main__":
    run(main)
