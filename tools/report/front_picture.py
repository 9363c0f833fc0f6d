"""Make the picture of the front page: two routes over the same ground, and the figures that matter as bars.

Reads DIR, the results of jp-plan, for the routes, and tests/bench/figures.json and tests/target/numbers.json for the
bars. Exit status 2: bad input; nothing was written.
"""
from pathlib import Path

from tools.common import ROOT, ArgumentParser, ToolError, run, shown_path, write_whole
from tools.measure import core_numbers
from tools.measure.figure_store import STORE, by_name, read_store
from tools.report import plan_report, plots

SAVED = "energy-optimal against distance-optimal routes, 20 scenes: energy saved, mean"
BEFORE = "campaign of 1000 unseen missions, courier24: error of the predicted energy without learning, mean"
AFTER = "campaign of 1000 unseen missions, courier24: error of the predicted energy, mean"
CORE = "Cortex-M4"
MODULES = {"balancer, energy, segments": "flash: balancer + energy + optimiser", "planner": "flash: planner",
           "learner": "flash: learner"}
SIZE = 12.0, 5.2  # inches
KIBIBYTE = 1024


def value_of(figures, name):
    if name not in figures:
        raise ToolError(f"{STORE}: has no figure {name!r}")
    return figures[name]["value"]


def size_of(numbers, row):
    if CORE not in numbers["size"].get(row, {}):
        raise ToolError(f"{core_numbers.ACCEPTED.name}: size: has no {row!r} of {CORE}")
    return numbers["size"][row][CORE]


def fill_bars(axes, title, bars, form):
    """Bars of {label: value}, each with its value behind it."""
    labels, values = list(bars), list(bars.values())
    colours = [plots.BLUE] if len(bars) != 2 else [plots.ORANGE, plots.BLUE]
    drawn = axes.barh(labels, values, color=colours, height=0.62)
    axes.bar_label(drawn, [form.format(value) for value in values], padding=4, fontsize=10, fontweight="bold")
    axes.invert_yaxis()
    axes.set_title(title)
    axes.set_xlim(0, 1.22 * max(values))
    axes.set_xticks([])
    axes.grid(False)
    axes.spines["bottom"].set_visible(False)
    axes.tick_params(axis="y", length=0)


def fill_routes(axes, summary, ground, routes):
    plan_report.draw_ground(axes, ground)
    plan_report.draw_routes(axes, routes, None, None)
    plan_report.draw_places(axes, summary["start"], summary["goal_m"])
    handles, labels = zip(*plan_report.legend_of(summary, ground, routes))
    axes.legend(handles, labels, loc="lower left", bbox_to_anchor=(0, 1.01), ncols=2, borderaxespad=0, handlelength=2.6)
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_xticks([])
    axes.set_yticks([])


def draw(results, figures, numbers):
    figure, axes = plots.plt.subplot_mosaic([["map", "saved"], ["map", "error"], ["map", "flash"]], figsize=SIZE,
                                            width_ratios=(1.15, 1), height_ratios=(2, 2, 3))
    fill_routes(axes["map"], *results)
    saved = value_of(figures, SAVED)
    fill_bars(axes["saved"], "Energy over rough ground",
              {"shortest route": 100, "route of least energy": 100 - saved}, "{:.0f} %")
    fill_bars(axes["error"], "Error of a mission's predicted energy",
              {"as the robot's file says": value_of(figures, BEFORE), "after learning": value_of(figures, AFTER)},
              "{:.2f} %")
    robot = size_of(numbers, "RAM: struct jp_robot")
    fill_bars(axes["flash"], f"Flash, {CORE} (RAM of a robot: {robot} bytes)",
              {label: size_of(numbers, row) / KIBIBYTE for label, row in MODULES.items()}, "{:.1f} KiB")
    return figure


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("directory", metavar="DIR", type=Path, help="what jp-plan wrote")
    parser.add_argument("output", metavar="PNG", type=Path)
    return parser.parse_args()


def main():
    options = arguments()
    summary, ground, routes, _ = plan_report.load(options.directory)
    store = read_store(ROOT / STORE)
    numbers = core_numbers.check_accepted(core_numbers.ACCEPTED, core_numbers.read_json(core_numbers.ACCEPTED))
    figure = draw((summary, ground, routes), by_name(STORE, store), numbers)
    write_whole(options.output, plots.png_bytes(figure, dpi=110))
    print(f"wrote {shown_path(options.output)}")
    return 0


if __name__ == "__main__":
    run(main)
