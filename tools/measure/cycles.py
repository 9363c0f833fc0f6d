#!/usr/bin/env python3
"""Worst-case instructions on each core, from the benches that ran there.

Arguments: their figures, build/bench/target_NAME-VARIANT.json. Of several figures of a row the greatest counts. Prints a
table and writes build/numbers/cycles.json. Exit status 2: bad input, nothing was written.
"""
import re
from pathlib import Path

from tools.common import ArgumentParser, ToolError, run
from tools.measure import core_numbers
from tools.measure.figure_store import read_figures

# What a figure of a bench counts for.
ROWS = {
    "sensor decode to PWM": r"sensor decode to PWM",
    "whole tick": r"whole tick",
    "jp_energy_forecast": r"energy forecast",
    "jp_energy_regressors": r"energy regressors",
    "jp_learner_update": r"learner: update",
    "jp_forecast_add": r"learner: forecast",
    "jp_current_check_update": r"current check: update",
    "jp_segment_optimise": r"segment optimiser",
    "jp_planner_work, 32 expansions": r"slice of 32 expansions of the planner",
    "jp_grid_planner_work, 32 expansions": r"slice of 32 expansions of the grid planner",
    "jp_four_wheel_tick": r"four wheels: tick",
    "jp_pure_pursuit_tick": r"pure pursuit: tick",
    "jp_teb_plan, 50 poses, 20 obstacles": r"TEB cycle",
    "jp_localiser_update, 360 beams": r"localiser, scan",
}


def tabulate(paths):
    table = {row: {} for row in ROWS}
    for path in paths:
        core = core_numbers.core_of(path.stem.partition("-")[2])
        for figure in read_figures(path):
            for row, pattern in ROWS.items():
                if re.search(pattern, figure["name"]):
                    table[row][core] = max(int(figure["value"]), table[row].get(core, 0))
    for row, values in table.items():
        if not values:
            raise ToolError(f"{row}: no bench counted it")
    return table


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("benches", metavar="FILE", type=Path, nargs="+")
    core_numbers.add_arguments(parser)
    options = parser.parse_args()
    core_numbers.show("cycles", tabulate(options.benches), options.diff)
    return 0


if __name__ == "__main__":
    run(main)
