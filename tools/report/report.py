#!/usr/bin/env python3
"""Make a page from the results of a mission.

Reads DIR/summary.json and the logs that it names, writes DIR/report.html, one file that needs nothing else, and
DIR/path.png, its first picture. Exit status 2: bad input; nothing was written.
"""
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tools.common import ArgumentParser, ToolError, run, shown_path, write_whole
from tools.report import plots
from tools.report.results import (format_number, is_number, need, need_list, need_point, read_columns, read_json,
                                  render_page)

LOG_COLUMNS = ("t_s", "x_m", "y_m", "ref_x_m", "ref_y_m", "heading_rad", "speed_m_s", "turn_rate_rad_s",
               "ref_speed_m_s", "ref_turn_rate_rad_s", "pitch_deg", "u_left_v", "u_right_v", "i_left_a", "i_right_a",
               "power_w", "energy_j", "segment")
SUMMARY_KEYS = ("robot", "scenario", "energy_model", "energy", "seed", "waypoints_m", "strategies", "simulation")
WORLD_KEYS = ("name", "conditions", "ledger_j", "film", "film_is")
STRATEGY_KEYS = ("name", "title", "log")
DRIVEN_KEYS = ("forecast", "segments", "total")  # of a strategy that can drive the route
FORECAST_KEYS = ("energy_j", "deviation_j")
SEGMENT_KEYS = ("index", "target_m", "planned_energy_j", "measured_energy_j", "plant_energy_j", "battery_energy_j",
                "duration_s", "speed_m_s", "turn_rate_rad_s", "turn_deg", "arc_rad", "end_m", "end_error_m",
                "error_percent")
TOTAL_KEYS = ("planned_energy_j", "measured_energy_j", "plant_energy_j", "battery_energy_j", "duration_s",
              "relative_percent")
NULLABLE = ("planned_energy_j", "error_percent", "relative_percent", "speed_m_s", "turn_rate_rad_s", "turn_deg",
            "arc_rad", "plant_energy_j", "battery_energy_j", "end_error_m")

# By kinds of robots, which share colours. What drives a balancer's route as a whole has the style of its counterpart, driven segment by segment.
COLOURS = {"optimal": plots.BLUE, "straight": plots.ORANGE, "bezier": plots.GREEN, "cruise": plots.RED,
           "straight_cruise": plots.AMBER, "bezier_route": plots.PURPLE, "optimised_cruise": plots.INK,
           "rounded": plots.BLUE, "turn_and_go": plots.ORANGE, "rounded_again": plots.GREEN}
STYLES = {"optimal": "-", "straight": "--", "bezier": "-.", "cruise": "-", "straight_cruise": "--", "bezier_route": "-.",
          "optimised_cruise": "--", "rounded": "-", "turn_and_go": "--", "rounded_again": ":"}

WIDE = (9.2, 3.4)

# Peak over median beyond which power is drawn on a logarithmic axis.
LOG_SCALE_FROM = 20


@dataclass(frozen=True)
class Strategy:
    """One way to drive the route: its part of the summary and its log by columns."""
    about: dict
    log: dict

    @property
    def name(self):
        return self.about["name"]

    @property
    def title(self):
        return self.about["title"]

    @property
    def colour(self):
        return COLOURS.get(self.name, plots.GREY)

    @property
    def style(self):
        return STYLES.get(self.name, ":")


def _need_numbers(path, place, data, keys):
    need(path, place, data, keys)
    for key in keys:
        value = data[key]
        if key.endswith("_m") and isinstance(value, list):
            need_point(path, f"{place}.{key}", value)
        elif not is_number(value) and not (value is None and key in NULLABLE):
            raise ToolError(f"{path}: {place}: {key} is {value!r}, not a number")


def _need_texts(path, place, data, keys):
    need(path, place, data, keys)
    for key in keys:
        if not isinstance(data[key], str) or not data[key]:
            raise ToolError(f"{path}: {place}: {key} must be a text")


def check_strategy(path, place, strategy):
    _need_texts(path, place, strategy, STRATEGY_KEYS)
    if "impossible" in strategy:
        _need_texts(path, place, strategy, ("impossible",))
        return
    need(path, place, strategy, DRIVEN_KEYS)
    need_list(path, f"{place}.segments", strategy["segments"])
    for j, segment in enumerate(strategy["segments"]):
        _need_numbers(path, f"{place}.segments[{j}]", segment, SEGMENT_KEYS)
    _need_numbers(path, f"{place}.total", strategy["total"], TOTAL_KEYS)
    if strategy["forecast"] is not None:
        _need_numbers(path, f"{place}.forecast", strategy["forecast"], FORECAST_KEYS)


def read_summary(path):
    summary = read_json(path)
    need(path, "summary", summary, SUMMARY_KEYS)
    need_list(path, "waypoints_m", summary["waypoints_m"])
    for i, point in enumerate(summary["waypoints_m"]):
        need_point(path, f"waypoints_m[{i}]", point)
    need_list(path, "strategies", summary["strategies"])
    for i, strategy in enumerate(summary["strategies"]):
        check_strategy(path, f"strategies[{i}]", strategy)
    if "impossible" in summary["strategies"][0]:
        raise ToolError(f"{path}: strategies[0]: the others are compared with it, so it cannot be impossible")
    if summary["simulation"] is not None:
        _need_numbers(path, "simulation", summary["simulation"], ("ticks", "wall_s", "real_time_factor"))
    return summary


# ---- figures -------------------------------------------------------------------------------------------------------

def _corner(waypoints):
    """The inner waypoint with the sharpest turn, or None."""
    sharpest, corner = 0.0, None
    for a, b, c in zip(waypoints, waypoints[1:], waypoints[2:]):
        turn = abs(math.remainder(math.atan2(*(c - b)[::-1]) - math.atan2(*(b - a)[::-1]), math.tau))
        if turn > sharpest:
            sharpest, corner = turn, b
    return corner


def _plot_paths(axes, strategies, waypoints):
    for s in strategies:
        axes.plot(s.log["x_m"], s.log["y_m"], s.style, color=s.colour, label=s.title)
    axes.plot(*waypoints.T, "o", color=plots.INK, markersize=5, label="waypoints", zorder=3)


def _emptiest_quadrant(strategies, bounds):
    """Lower-left corner, in shares of the axes, of the quadrant with the fewest samples."""
    (x0, x1), (y0, y1) = bounds
    x = np.concatenate([s.log["x_m"] for s in strategies])
    y = np.concatenate([s.log["y_m"] for s in strategies])
    right, upper = x > (x0 + x1) / 2, y > (y0 + y1) / 2
    quadrants = {(0.57, 0.06): right & ~upper, (0.06, 0.57): ~right & upper, (0.06, 0.06): ~right & ~upper,
                 (0.57, 0.57): right & upper}
    return min(quadrants, key=lambda corner: int(quadrants[corner].sum()))


def draw_path(strategies, waypoints):
    figure, axes = plots.new_figure(9.2, 7.2)
    _plot_paths(axes, strategies, waypoints)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    for i, point in enumerate(waypoints):
        axes.annotate("start" if i == 0 else str(i), point, xytext=(7, -12), textcoords="offset points", fontsize=9)
    corner = _corner(waypoints)
    if corner is not None:
        figure.canvas.draw()
        place = _emptiest_quadrant(strategies, (axes.get_xlim(), axes.get_ylim()))
        inset = axes.inset_axes([*place, 0.37, 0.37])
        _plot_paths(inset, strategies, waypoints)
        reach = 0.06 * max(np.ptp(waypoints, axis=0).max(), 1.0)
        inset.set_xlim(corner[0] - reach, corner[0] + reach)
        inset.set_ylim(corner[1] - reach, corner[1] + reach)
        inset.set_aspect("equal")
        inset.tick_params(labelsize=8)
        inset.set_title("corner, enlarged", fontsize=9, fontweight="normal")
        axes.indicate_inset_zoom(inset, edgecolor=plots.GREY)
        figure.legend(*axes.get_legend_handles_labels(), loc="outside upper left", ncols=3)
    else:
        axes.legend()
    return figure


def _mark_segments(axes, log):
    for t in log["t_s"][1:][np.diff(log["segment"]) != 0]:
        axes.axvline(t, color=plots.GREY, linewidth=0.8, linestyle=":", zorder=0)


def _legend_above(axes):
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=4, borderaxespad=0.2)


def _over_time(log, panels):
    """One panel for each (title, unit, [(column, label, style, colour)])."""
    width, height = WIDE
    figure, axes = plots.new_figure(width, height * len(panels), len(panels), sharex=True, squeeze=False)
    for axis, (title, unit, curves) in zip(axes[:, 0], panels):
        _mark_segments(axis, log)
        for column, label, style, colour in curves:
            axis.plot(log["t_s"], log[column], style, color=colour, label=label, linewidth=1.3)
        if len(panels) > 1:
            axis.set_title(title)
        axis.set_ylabel(unit)
        if len(curves) > 1:
            _legend_above(axis)
    axes[-1, 0].set_xlabel("time, s")
    return figure


def draw_motion(log):
    measured, reference = ("-", plots.BLUE), ("--", plots.ORANGE)
    return _over_time(log, [
        ("Speed", "v, m/s", [("speed_m_s", "robot", *measured), ("ref_speed_m_s", "reference", *reference)]),
        ("Turn rate", "w, rad/s", [("turn_rate_rad_s", "robot", *measured),
                                   ("ref_turn_rate_rad_s", "reference", *reference)])])


def draw_pitch(log):
    return _over_time(log, [("Pitch", "ψ, °", [("pitch_deg", "pitch", "-", plots.BLUE)])])


def draw_motors(log):
    return _over_time(log, [
        ("Motor voltages", "u, V", [("u_left_v", "left", "-", plots.BLUE), ("u_right_v", "right", "-", plots.ORANGE)]),
        ("Motor currents", "i, A", [("i_left_a", "left", "-", plots.BLUE), ("i_right_a", "right", "-", plots.ORANGE)])])


def draw_power(log):
    figure = _over_time(log, [("Power", "P, W", [("power_w", "power", "-", plots.BLUE)])])
    # A step of the reference costs hundreds of watts for milliseconds; the steady power must stay legible beside it.
    if log["power_w"].min() > 0 and log["power_w"].max() > LOG_SCALE_FROM * np.median(log["power_w"]):
        figure.axes[0].set_yscale("log")
    return figure


def _progress(strategy):
    """Segments driven so far; inside a segment by its share of time."""
    log = strategy.log
    # The last sample may lie beyond the last segment, where the robot already brakes.
    segment = np.minimum(log["segment"], len(strategy.about["segments"]))
    starts = np.flatnonzero(np.diff(segment, prepend=np.nan) != 0)
    ends = np.append(starts[1:], len(log["t_s"]) - 1)
    return np.interp(log["t_s"], np.append(log["t_s"][starts], log["t_s"][-1]), np.arange(len(ends) + 1))


def draw_energy(strategies):
    """Energy over time, and what the other strategies spend more than the first at equal progress."""
    first, others = strategies[0], strategies[1:]
    width, height = WIDE
    figure, axes = plots.new_figure(width, height * (2 if others else 1), 2 if others else 1, squeeze=False)
    total = axes[0, 0]
    for s in strategies:
        label = f"{s.title}, {s.log['energy_j'][-1]:.0f} J"
        total.plot(s.log["t_s"], s.log["energy_j"], s.style, color=s.colour, label=label)
    total.set_xlabel("time, s")
    total.set_ylabel("E, J")
    figure.legend(*total.get_legend_handles_labels(), loc="outside upper left", ncols=2)
    if others:
        extra = axes[1, 0]
        extra.axhline(0, color=first.colour)
        for s in others:
            progress = _progress(s)
            base = np.interp(progress, _progress(first), first.log["energy_j"])
            extra.plot(progress, s.log["energy_j"] - base, s.style, color=s.colour, label=s.title)
        extra.xaxis.get_major_locator().set_params(integer=True)
        extra.set_title(f"Energy above: {first.title}")
        extra.set_xlabel("segments driven")
        extra.set_ylabel("ΔE, J")
    return figure


def draw_coordinate_error(log):
    width, height = WIDE
    figure, axes = plots.new_figure(width, height)
    _mark_segments(axes, log)
    for axis, colour, style in (("x", plots.BLUE, "-"), ("y", plots.ORANGE, "-")):
        axes.plot(log["t_s"], log[f"{axis}_m"] - log[f"ref_{axis}_m"], style, color=colour, label=axis, linewidth=1.3)
    axes.set_xlabel("time, s")
    axes.set_ylabel("robot − reference, m")
    _legend_above(axes)
    return figure


def figures(strategies, waypoints):
    """(title, caption, data URI) of each figure; single-strategy figures show the first one."""
    first = strategies[0]
    log, title = first.log, first.title
    drawn = [
        ("Path", "Driven paths and waypoints; inset: the sharpest corner.", draw_path(strategies, waypoints)),
        ("Energy", "Cumulated energy of each strategy, electronics included.", draw_energy(strategies)),
        ("Speed and turn rate", f"{title}. Dotted lines: a new segment.", draw_motion(log)),
        ("Motors", f"{title}.", draw_motors(log)),
        ("Power", f"{title}, electronics included.", draw_power(log)),
        ("Coordinate error", f"{title}. Where the robot is, less where the reference is.",
         draw_coordinate_error(log)),
    ]
    if log["pitch_deg"].any():  # else its robot does not balance
        drawn.insert(3, ("Pitch", f"{title}. Forward is positive.", draw_pitch(log)))
    return [(name, caption, plots.inline_png(figure, dpi=130)) for name, caption, figure in drawn]


# ---- page ----------------------------------------------------------------------------------------------------------

def origin(summary):
    """Who drove and how, as far as it is known."""
    named = (("Robot", "robot"), ("energy model", "energy_model"), ("energy of the", "energy"),
             ("seed", "seed"))
    return " · ".join(f"{label} {summary[key]}" for label, key in named if summary[key] is not None)


def headlines(summary):
    """(value, label) of the numbers at the top."""
    first = summary["strategies"][0]
    total = first["total"]
    cards = [(format_number(total["measured_energy_j"], 1, "J"), f"{first['title']}: the whole route"),
             (format_number(total["duration_s"], 1, "s"), "driving time")]
    errors = [abs(s["error_percent"]) for s in first["segments"] if s["error_percent"] is not None]
    if errors:
        cards.append((format_number(sum(errors) / len(errors), 2, "%"), "mean error of a segment's predicted energy"))
    for other in driven(summary)[1:]:
        extra = 100 * (other["total"]["measured_energy_j"] / total["measured_energy_j"] - 1)
        sign = "+" if extra >= 0 else ""
        cards.append((sign + format_number(extra, 2, "%"), f"{other['title']}: energy in comparison"))
    if summary["simulation"] is not None:
        cards.append((format_number(summary["simulation"]["real_time_factor"], 0) + "×", "faster than real time"))
    return cards


def driven(summary):
    """The strategies that can drive the route."""
    return [strategy for strategy in summary["strategies"] if "impossible" not in strategy]


def impossible(summary):
    return [strategy for strategy in summary["strategies"] if "impossible" in strategy]


def planned_strategies(summary):
    """Those of which the page shows every segment: the first, and what was foretold before the start."""
    first, *others = driven(summary)
    return [first, *(other for other in others if other["forecast"] is not None)]


def _forecast_cell(forecast):
    if forecast is None:
        return "–"
    return f"{format_number(forecast['energy_j'])} ± {format_number(forecast['deviation_j'])}"


def table4(summary):
    """Energy of each segment by strategy; a row is (label, cells)."""
    strategies = driven(summary)
    count = max(len(s["segments"]) for s in strategies)
    rows = []
    for i in range(count):
        cells = [format_number(s["segments"][i]["measured_energy_j"]) if i < len(s["segments"]) else "–"
                 for s in strategies]
        rows.append((f"segment {strategies[0]['segments'][i]['index']}" if i < len(strategies[0]["segments"])
                     else f"segment {i + 1}", cells))
    totals = [s["total"] for s in strategies]
    rows.append(("total energy, J", [format_number(t["measured_energy_j"]) for t in totals]))
    rows.append(("planned energy, J", [format_number(t["planned_energy_j"]) for t in totals]))
    if any(s["forecast"] for s in strategies):
        rows.append(("forecast before the start, J", [_forecast_cell(s["forecast"]) for s in strategies]))
    if any(t["plant_energy_j"] is not None for t in totals):
        rows.append(("energy by the plant's ledger, J", [format_number(t["plant_energy_j"]) for t in totals]))
    rows.append(("battery energy, J", [format_number(t["battery_energy_j"]) for t in totals]))
    rows.append(("driving time, s", [format_number(t["duration_s"]) for t in totals]))
    rows.append(("relative energy, %", [format_number(t["relative_percent"]) for t in totals]))
    return rows


def ledger_rows(summary):
    """(name, J, share of what left the cells in %) of another world's ledger."""
    ledger = summary["world"]["ledger_j"]
    return [(name, format_number(joules, 3), format_number(100 * joules / ledger["cells"], 3))
            for name, joules in ledger.items()]


def render(summary, strategies, film=None):
    waypoints = np.array(summary["waypoints_m"], dtype=float)
    return render_page("report.html.j2", summary=summary, origin=origin(summary), headlines=headlines(summary),
                       planned=planned_strategies(summary), strategies=strategies, table4=table4(summary),
                       impossible=impossible(summary), figures=figures(strategies, waypoints),
                       film=film, ledger=ledger_rows(summary) if summary.get("world") else [])


def read_film(directory, summary):
    """As a data URI; None of a drive that has none."""
    world = summary.get("world")
    if world is None:
        return None
    need(directory / "summary.json", "world", world, WORLD_KEYS)
    try:
        return plots.data_uri((directory / world["film"]).read_bytes())
    except OSError as error:
        raise ToolError(f"{directory / world['film']}: {error.strerror}") from None


def load(directory):
    summary = read_summary(directory / "summary.json")
    for about in summary["strategies"]:
        about["title"] = about["title"][:1].upper() + about["title"][1:]
    strategies = [Strategy(about, read_columns(directory / about["log"], LOG_COLUMNS)) for about in driven(summary)]
    return summary, strategies


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("directory", metavar="DIR", type=Path, help="holds summary.json and the logs")
    directory = parser.parse_args().directory
    summary, strategies = load(directory)
    film = read_film(directory, summary)
    path_picture = plots.png_bytes(draw_path(strategies, np.array(summary["waypoints_m"], dtype=float)), dpi=100)
    for name, content in (("report.html", render(summary, strategies, film)), ("path.png", path_picture)):
        write_whole(directory / name, content)
        print(f"wrote {shown_path(directory / name)}")
    return 0


if __name__ == "__main__":
    run(main)
