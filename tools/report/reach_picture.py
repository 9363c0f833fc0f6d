#!/usr/bin/env python3
"""Draw from where a robot comes home on what is in its battery, and what it drove.

Reads DIR/summary.json, the results of jp-navigate with --battery, the log that it names, and the map; writes
DIR/reach.png. Exit status 2: bad input; nothing was written.
"""
from pathlib import Path

import numpy as np
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from tools.common import ArgumentParser, ToolError, run, shown_path, write_whole
from tools.report import plots
from tools.report.ground import OUTLINE, WIDTH, draw_ground, draw_places, finish_map, map_height, read_map
from tools.report.results import format_number, need, need_numbers, need_texts, need_vector, read_columns, read_json

HOME_NUMBERS = ("battery_j", "confidence", "given_j", "least_probability", "trip_j", "trip_deviation_j")
HOME_FLAGS = ("turned_back", "stranded")
# Of cells, by the least probability of coming home from there, %.
LEVELS = ((95, "#9CCB86", "there and home with 95 % and more"), (50, "#F3DD8B", "50 to 95 %"),
          (0, "#EDB49A", "less than 50 %"))
DRIVEN = plots.BLUE


def read_summary(path):
    summary = read_json(path)
    need(path, "summary", summary, ("robot", "map", "start", "goal", "log", "home"))
    need_texts(path, "summary", summary, ("robot", "log"))
    need_texts(path, "map", summary["map"], ("file",))
    need_vector(path, "start", summary["start"], 3)
    need_vector(path, "goal", summary["goal"], 3)
    home = summary["home"]
    need_texts(path, "home", home, ("state",))
    need_numbers(path, "home", home, HOME_NUMBERS)
    need(path, "home", home, (*HOME_FLAGS, "reach_percent"))
    return summary


def read_reach(path, summary, ground):
    """% of each cell, row by row from the south; −1: no way leads there."""
    try:
        reach = np.array(summary["home"]["reach_percent"], dtype=float)
    except (TypeError, ValueError):
        reach = np.empty(0)
    if reach.shape != ground.cells.shape or not ((reach >= -1) & (reach <= 100)).all():
        rows, columns = ground.cells.shape
        raise ToolError(f"{path}: home.reach_percent: is no grid of {columns} × {rows} numbers −1…100")
    return reach


def draw_reach(axes, ground, reach):
    image = np.zeros((*reach.shape, 4))
    for level, colour, _ in reversed(LEVELS):
        image[reach >= level] = to_rgba(colour)
    width, height = ground.size
    drawn = axes.imshow(image, origin="lower", extent=(0, width, 0, height), interpolation="nearest", zorder=0.6)
    drawn.set_transform(ground.frame() + axes.transData)


def legend_of(home, reach):
    ends = {"home": "turned back and came home" if home["turned_back"] else "to the goal and home"}
    end = "ran empty on its way" if home["stranded"] else ends.get(home["state"], home["state"])
    took, holds = format_number(home["given_j"], 0, "J"), format_number(home["battery_j"], 0, "J")
    entries = [(Line2D([], [], color=DRIVEN, linewidth=3), f"driven, {end}: {took} of {holds}")]
    bounds = (101, *(level for level, _, _ in LEVELS))
    entries += [(Patch(facecolor=colour), label) for upper, (level, colour, label) in zip(bounds, LEVELS)
                if ((reach >= level) & (reach < upper)).any()]
    return entries


def draw(summary, ground, reach, log):
    figure, axes = plots.new_figure(WIDTH, map_height(ground) + 0.8)
    draw_ground(axes, ground)
    draw_reach(axes, ground, reach)
    axes.plot(log["x_m"], log["y_m"], color=DRIVEN, linewidth=3, solid_capstyle="round", zorder=4, path_effects=OUTLINE)
    draw_places(axes, summary["start"], summary["goal"][:2])
    finish_map(figure, axes, ground, legend_of(summary["home"], reach))
    return figure


def main():
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("directory", metavar="DIR", type=Path, help="results of jp-navigate --battery")
    folder = parser.parse_args().directory
    path = folder / "summary.json"
    summary = read_summary(path)
    ground = read_map(Path(summary["map"]["file"]))
    reach = read_reach(path, summary, ground)
    log = read_columns(folder / summary["log"], ("x_m", "y_m"), rows_min=1, texts=("state", "reason"))
    write_whole(folder / "reach.png", plots.png_bytes(draw(summary, ground, reach, log)))
    print(f"wrote {shown_path(folder / 'reach.png')}")
    return 0


if __name__ == "__main__":
    run(main)
