#!/usr/bin/env python3
"""Draw what a robot learned of grounds, and what it saved.

Reads DIR/summary.json, the results of jp-grounds, and the map that it names; writes DIR/grounds.png. Exit status 2: bad
input; nothing was written.
"""
from pathlib import Path

import numpy as np
from matplotlib.colors import to_rgba
from matplotlib.patches import Patch

from tools.common import ArgumentParser, ToolError, run, shown_path, write_whole
from tools.report import plots
from tools.report.ground import draw_ground, grid, read_map
from tools.report.results import need, need_list, need_numbers, need_points, need_texts, read_json

KEYS = ("robot", "map", "grounds", "kept", "not_kept")
GROUND_KEYS = ("rolling", "friction", "straight_j_per_m", "turning_j_per_rad")
TRIP_KEYS = ("energy_j", "forecast_j", "length_m")

KEPT, NOT_KEPT, FIRST = plots.BLUE, plots.ORANGE, plots.GREY
# Of classes 1, 2, 3; 0 is as the map.
CLASSES = (None, "#B79268", "#B5CF8F", "#C9B6DA")
SIZE = 10.0, 9.0  # inches


def read_summary(path):
    summary = read_json(path)
    need(path, "summary", summary, KEYS)
    need_texts(path, "summary", summary, ("robot", "map"))
    for name in ("grounds", "kept", "not_kept"):
        need_list(path, name, summary[name])
    for i, ground in enumerate(summary["grounds"]):
        need_texts(path, f"grounds[{i}]", ground, ("name",), least=0)
        need_numbers(path, f"grounds[{i}]", ground, GROUND_KEYS)
    for name in ("kept", "not_kept"):
        for i, trip in enumerate(summary[name]):
            check_trip(path, f"{name}[{i}]", trip, len(summary["grounds"]))
    if len(summary["grounds"]) > len(CLASSES):
        raise ToolError(f"{path}: grounds: at most {len(CLASSES)} are drawn")
    return summary


def check_trip(path, place, trip, classes):
    need_numbers(path, place, trip, TRIP_KEYS)
    need(path, place, trip, ("metres_on", "known", "track_m"))
    need_list(path, f"{place}.track_m", trip["track_m"])
    need_points(path, f"{place}.track_m", trip["track_m"])
    for key in ("metres_on", "known"):
        if not isinstance(trip[key], list) or len(trip[key]) != classes:
            raise ToolError(f"{path}: {place}.{key}: is no list of {classes} classes")
    for known in trip["known"]:
        need_numbers(path, f"{place}.known", known, ("straight_j_per_m", "legs"))


def draw_classes(axes, ground, classes):
    image = np.zeros((*classes.shape, 4))
    for k, colour in enumerate(CLASSES):
        if colour is not None:
            image[(classes == str(k)) & (ground.cells == ".")] = to_rgba(colour)
    width, height = ground.size
    drawn = axes.imshow(image, origin="lower", extent=(0, width, 0, height), interpolation="nearest", zorder=0.5)
    drawn.set_transform(ground.frame() + axes.transData)


def draw_map(axes, summary):
    path = Path(summary["map"])
    ground = read_map(path)
    draw_ground(axes, ground)
    rows = read_json(path).get("class")
    if rows is None:
        raise ToolError(f"{path}: class: the map tells no grounds apart")
    draw_classes(axes, ground, grid(path, "class", [list(str(row)) for row in rows], ground.cells.shape, str))
    for trip, style in ((summary["not_kept"][-1], {"color": NOT_KEPT, "linestyle": (0, (5, 2))}),
                        (summary["kept"][0], {"color": FIRST}), (summary["kept"][-1], {"color": KEPT})):
        axes.plot(*np.array(trip["track_m"]).T, linewidth=2, **style)
    axes.set_xlim(0, ground.size[0])
    axes.set_ylim(0, ground.size[1])
    axes.set_aspect("equal")
    axes.set(xlabel="x, m", ylabel="y, m", title=f"{summary['robot']}: first trip grey, last trip blue; dashed: the last "
             "trip of one that keeps nothing of the grounds")
    names = [(CLASSES[k], ground["name"]) for k, ground in enumerate(summary["grounds"]) if CLASSES[k] and ground["name"]]
    axes.legend(handles=[Patch(facecolor=colour, label=name) for colour, name in names], loc="lower left", fontsize=9)


def draw_energy(axes, summary):
    for name, colour, label in (("not_kept", NOT_KEPT, "keeps what it learns of itself"),
                                ("kept", KEPT, "keeps what it learns of the grounds, too")):
        trips = np.arange(1, len(summary[name]) + 1)
        axes.plot(trips, [trip["energy_j"] for trip in summary[name]], "o-", color=colour, label=label)
        axes.plot(trips, [trip["forecast_j"] for trip in summary[name]], "x", color=colour)
    axes.plot([], [], "x", color=plots.INK, label="forecast before the trip")
    axes.set_ylim(bottom=0)
    axes.set(xlabel="trip", ylabel="energy, J")
    axes.legend(fontsize=9)


def draw_learned(axes, summary):
    """J/m of each class that was driven on, against what it takes truly."""
    trips = np.arange(1, len(summary["kept"]) + 1)
    for k, ground in enumerate(summary["grounds"]):
        if not any(trip["metres_on"][k] > 0 for trip in summary["kept"]):
            continue
        colour = CLASSES[k] or plots.INK
        axes.axhline(ground["straight_j_per_m"], color=colour, linewidth=1, linestyle=":")
        axes.plot(trips, [trip["known"][k]["straight_j_per_m"] for trip in summary["kept"]], "o-", color=colour,
                  label=ground["name"] or f"class {k}")
    axes.set_ylim(bottom=0)
    axes.set(xlabel="trip", ylabel="straight on level ground, J/m", title="learned; dotted: by the plant")
    axes.legend(fontsize=9)


def picture(summary):
    figure, axes = plots.new_figure(*SIZE, 2, 2, gridspec_kw={"height_ratios": (1.25, 1)})
    for axis in axes[0]:
        axis.remove()
    draw_map(figure.add_subplot(axes[0, 0].get_gridspec()[0, :]), summary)
    draw_energy(axes[1, 0], summary)
    draw_learned(axes[1, 1], summary)
    return plots.png_bytes(figure)


def main():
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("directory", metavar="DIR", type=Path, help="what jp-grounds wrote")
    directory = parser.parse_args().directory
    summary = read_summary(directory / "summary.json")
    write_whole(directory / "grounds.png", picture(summary))
    print(f"wrote {shown_path(directory / 'grounds.png')}")
    return 0


if __name__ == "__main__":
    run(main)
