#!/usr/bin/env python3
"""Measure the navigator on the maps of others.

Drives courier24 in closed loop between places that jp-navigate chooses, among boxes that the maps do not show, with
seeds 1, 2, … on each map. Prints a table, writes figures for figures.py. Exit status 2: a program failed; nothing was
written.
"""
import json
import os
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, run, shown_path, write_whole
from tools.design import robot_json

COMMAND = "make bench-navigate"
ROBOT = "courier24"
DRIVES = 5         # a map
HIDDEN = 8         # boxes
MEMORY = 16 * 1024  # KiB


def drive(build, map_path, seed, output):
    """The result of a drive; None: no two places of the map are connected for the robot."""
    result = subprocess.run([build / "bin/jp-navigate", map_path, "--robot", ROOT / f"sim/robots/{ROBOT}.cfg",
                             f"--hidden={HIDDEN}", f"--memory={MEMORY}", f"--seed={seed}", "--output", output],
                            capture_output=True, text=True, check=False, cwd=ROOT)
    if result.returncode > 1:
        raise ToolError(f"jp-navigate: {shown_path(map_path)}, seed {seed}: "
                        f"{(result.stderr.strip() or 'no reason given').splitlines()[-1]}")
    summary = json.loads((output / "summary.json").read_text())["result"]
    shutil.rmtree(output)
    return summary


def figure(name, value, unit, bound):
    return {"name": f"navigator on the maps of others, {name}", "value": value, "unit": unit, "bound": bound,
            "command": COMMAND}


def figures_of(results):
    states = [result["state"] for result in results]
    none = {"op": "==", "value": 0}
    return [figure("drives", len(results), "", None),
            figure("drives that touched something", sum(result["touched"] for result in results), "", none),
            figure("neither arrived nor proved that there is no way", sum(state not in ("arrived", "unreachable")
                                                                          for state in states), "", none),
            figure("arrived", states.count("arrived"), "", None),
            figure("planned anew, all drives", sum(result["replans"] for result in results), "", None)]


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("maps", metavar="MAP", type=Path, nargs="+", help="map of tools.design.import_map")
    options = parser.parse_args()
    build = Path(os.path.abspath(robot_json.build_directory()))
    tasks = [(map_path, seed) for map_path in options.maps for seed in range(1, DRIVES + 1)]
    folder = build / "bench-navigate"
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda task: drive(build, *task, folder / f"{task[0].stem}-{task[1]}"), tasks))
    print_aligned([(task[0].stem, str(task[1]), result["state"], "touched" if result["touched"] else "",
                    f"{result['length_m']:.1f} m", f"{result['replans']} replans")
                   for task, result in zip(tasks, results)])
    path = build / "bench/navigate_maps.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, json.dumps(figures_of(results), indent=1) + "\n")
    print(f"wrote {shown_path(path)}")


if __name__ == "__main__":
    run(main)
