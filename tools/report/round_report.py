"""Page and picture of hours of patrol (jp-patrol --round): the map with stops, charger and ways, what the battery held,
and the journeys. Part of tools.report.patrol_report."""
from dataclasses import dataclass

import matplotlib.patheffects
import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from tools.common import ToolError
from tools.report import plots
from tools.report.ground_cells import FILLS, HIDDEN, SOLID, check_map, draw_ground, draw_robot, map_window
from tools.report.plots import spans_of
from tools.report.results import (format_number, need, need_list, need_numbers, need_texts, need_vector, read_columns,
                                  render_page)

KEYS = ("robot", "scene", "robot_size_m", "seed", "hours", "outcome", "reason", "visits", "charges", "skipped",
        "time_s", "length_m", "energy_j", "map", "charger", "stops", "battery", "journeys", "log")
NUMBERS = ("seed", "hours", "visits", "charges", "skipped", "time_s", "length_m", "energy_j")
BATTERY_NUMBERS = ("full_j", "reserve_j", "charger_w", "deviations", "below_reserve", "account_error_j")
JOURNEY_NUMBERS = ("from", "to", "start_s", "time_s", "length_m", "foretold_j", "deviation_j", "taken_j", "left_j")
LOG_COLUMNS = ("t_s", "x_m", "y_m", "heading_deg", "held_j", "told_j", "state", "stop")

CHARGING = 4, 5   # numbers of states at the charger
DWELLING = 7
HOMING = 8

OUTWARD = plots.BLUE
HOMEWARD = plots.ORANGE
STOP = plots.INK
CHARGER = plots.GREEN
RESERVE = "#C2185B"
OUTLINE = [matplotlib.patheffects.withStroke(linewidth=3, foreground="white")]

WIDTH = 11.0             # inches
MAP_HEIGHT = 3.0, 8.0
BATTERY_HEIGHT = 2.6
MINUTES = 600            # s, from which on time is told in minutes


@dataclass(frozen=True)
class Round:
    about: dict
    log: dict

    @property
    def outcome(self):
        reason = self.about["reason"]
        return f"{self.about['outcome']}: {reason}" if reason else self.about["outcome"]

    def place(self, number):
        """Stops are numbered from 1 for people."""
        return f"stop {number + 1}" if number < len(self.about["stops"]) else "charger"


# ---- input ---------------------------------------------------------------------------------------------------------

def read_round(path, summary):
    need(path, "summary", summary, KEYS)
    need_texts(path, "summary", summary, ("robot", "scene", "outcome", "log"))
    need_texts(path, "summary", summary, ("reason",), least=0)
    need_numbers(path, "summary", summary, NUMBERS)
    need_vector(path, "robot_size_m", summary["robot_size_m"], 2)
    need_vector(path, "charger", summary["charger"], 3)
    check_map(path, summary["map"])
    need_numbers(path, "battery", summary["battery"], BATTERY_NUMBERS)
    need_list(path, "stops", summary["stops"])
    for i, stop in enumerate(summary["stops"]):
        need_numbers(path, f"stops[{i}]", stop, ("dwell_s",))
        need(path, f"stops[{i}]", stop, ("pose",))
        need_vector(path, f"stops[{i}].pose", stop["pose"], 3)
    check_journeys(path, summary)
    return Round(summary, read_columns(path.parent / summary["log"], LOG_COLUMNS))


def check_journeys(path, summary):
    if not isinstance(summary["journeys"], list):
        raise ToolError(f"{path}: journeys: must be a list")
    for i, journey in enumerate(summary["journeys"]):
        need_numbers(path, f"journeys[{i}]", journey, JOURNEY_NUMBERS)
        need_texts(path, f"journeys[{i}]", journey, ("outcome",))
        for key in ("from", "to"):
            if not 0 <= journey[key] <= len(summary["stops"]):
                raise ToolError(f"{path}: journeys[{i}]: {key} is {journey[key]}, no place of the round")


# ---- the map -------------------------------------------------------------------------------------------------------

def window_of(rounds):
    places = [rounds.about["charger"][:2], *(stop["pose"][:2] for stop in rounds.about["stops"])]
    return map_window(rounds.about["map"], [*places, *zip(rounds.log["x_m"], rounds.log["y_m"])])


def draw_ways(axes, log):
    """Where it drove outward, and home."""
    homing = log["state"] == HOMING
    for holds, colour, order in ((~homing, OUTWARD, 3), (homing, HOMEWARD, 4)):
        axes.plot(np.where(holds, log["x_m"], np.nan), np.where(holds, log["y_m"], np.nan), color=colour, linewidth=1.1,
                  alpha=0.75, zorder=order)


def below(pose, size):
    """However the robot is turned."""
    return pose[0], pose[1] - 0.6 * np.hypot(*size)


def draw_places(axes, about):
    size = about["robot_size_m"]
    draw_robot(axes, size, about["charger"], facecolor=(*to_rgb(CHARGER), 0.25), edgecolor=CHARGER, linewidth=2,
               zorder=6)
    axes.annotate("charger", below(about["charger"], size), fontsize=9, ha="center", va="top", color=CHARGER,
                  fontweight="bold", zorder=8, path_effects=OUTLINE)
    for i, stop in enumerate(about["stops"]):
        draw_robot(axes, size, stop["pose"], facecolor="white", edgecolor=STOP, linewidth=1.6, zorder=6)
        axes.annotate(str(i + 1), stop["pose"][:2], fontsize=9, ha="center", va="center", color=STOP, fontweight="bold",
                      zorder=8, path_effects=OUTLINE)
        axes.annotate(format_number(stop["dwell_s"], 0, "s"), below(stop["pose"], size), fontsize=8, ha="center",
                      va="top", color=STOP, zorder=8, path_effects=OUTLINE)


def map_legend(about):
    entries = [(Line2D([], [], color=OUTWARD), "to the stops, each with how long it stays"),
               (Line2D([], [], color=HOMEWARD), "home to the charger"), (Patch(facecolor=FILLS[SOLID]), "on the map")]
    if any(HIDDEN in row for row in about["map"]["rows"]):
        entries.append((Patch(facecolor=FILLS[HIDDEN]), "there, but not on the map"))
    return zip(*entries)


def fill_map(axes, rounds):
    draw_ground(axes, rounds.about["map"])
    draw_ways(axes, rounds.log)
    draw_places(axes, rounds.about)
    west, east, south, north = window_of(rounds)
    axes.set_xlim(west, east)
    axes.set_ylim(south, north)
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")


# ---- over time -----------------------------------------------------------------------------------------------------

def fill_battery(axes, rounds):
    battery, log = rounds.about["battery"], rounds.log
    is_long = log["t_s"][-1] >= MINUTES
    times = log["t_s"] / (60 if is_long else 1)
    for holds, colour, text in ((np.isin(log["state"], CHARGING), CHARGER, "at the charger"),
                                (log["state"] == DWELLING, plots.GREY, "at a stop"),
                                (log["state"] == HOMING, HOMEWARD, "on its way home")):
        for i, (first, end) in enumerate(spans_of(times, holds)):
            axes.axvspan(first, end, color=colour, alpha=0.14, linewidth=0, label=text if i == 0 else None)
    axes.plot(times, log["held_j"] / 1000, color=plots.INK, linewidth=1.6, label="in the battery", zorder=4)
    axes.plot(times, log["told_j"] / 1000, color=plots.PURPLE, linewidth=1, linestyle=(0, (4, 2)),
              label="as the robot counts", zorder=5)
    axes.axhline(battery["reserve_j"] / 1000, color=RESERVE, linewidth=1.4, label="reserve", zorder=3)
    axes.set_ylim(0, 1.05 * battery["full_j"] / 1000)
    axes.set_xlim(times[0], times[-1])
    axes.set_ylabel("energy, kJ")
    axes.set_xlabel("time, min" if is_long else "time, s")
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=6, fontsize=8)


# ---- both ----------------------------------------------------------------------------------------------------------

def map_height(rounds):
    west, east, south, north = window_of(rounds)
    return float(np.clip(WIDTH * (north - south) / (east - west), *MAP_HEIGHT))


def add_legend(figure, rounds):
    handles, labels = map_legend(rounds.about)
    figure.legend(handles, labels, loc="outside upper left", ncols=4, columnspacing=1.6)


def draw_round(rounds):
    """Map and battery below each other."""
    height = map_height(rounds)
    figure, axes = plots.new_figure(WIDTH, height + BATTERY_HEIGHT + 1.2, 2, height_ratios=[height, BATTERY_HEIGHT])
    fill_map(axes[0], rounds)
    fill_battery(axes[1], rounds)
    add_legend(figure, rounds)
    return figure


def draw_map(rounds):
    figure, axes = plots.new_figure(WIDTH, map_height(rounds) + 1)
    fill_map(axes, rounds)
    add_legend(figure, rounds)
    return figure


def draw_battery(rounds):
    figure, axes = plots.new_figure(WIDTH, BATTERY_HEIGHT + 0.8)
    fill_battery(axes, rounds)
    return figure


# ---- page ----------------------------------------------------------------------------------------------------------

def headlines(about):
    """(value, label) of the numbers at the top."""
    battery = about["battery"]
    return [(about["outcome"], about["reason"] or f"for {format_number(about['hours'], 2, 'h')}"),
            (format_number(about["visits"], 0), f"visits, {about['skipped']} stops left out"),
            (format_number(about["charges"], 0), "times home to the charger"),
            (format_number(battery.get("least_left_j"), 0, "J") if battery.get("least_left_j") is not None else "–",
             f"least energy at home, of {format_number(battery['reserve_j'], 0, 'J')} reserve"),
            (format_number(about["length_m"], 0, "m"), "driven"),
            (format_number(about["energy_j"] / 1000, 1, "kJ"), "out of the battery")]


def figures(rounds):
    drawn = [("The ways", "The true track; stops are numbered in the order of the round.", draw_map(rounds)),
             ("The battery", "What it held, and what the robot counted: its charger tells, and away from it its own "
              "meter.", draw_battery(rounds))]
    return [(name, caption, plots.inline_png(figure, dpi=130)) for name, caption, figure in drawn]


def render(rounds):
    return render_page("round.html.j2", summary=rounds.about, headlines=headlines(rounds.about), rounds=rounds,
                       figures=figures(rounds))


def picture(rounds):
    return plots.png_bytes(draw_round(rounds), dpi=120)
