"""Measure the Python package: what its README's first commands take in a fresh environment, and planning beside jp-plan.

Writes figures for tools/measure/figures.py. What a machine that has other work takes is in the time by the clock; the
processors' time is that of the commands alone. Both are measured: the bar is on the clock.

Planning is timed from a map that is loaded to a route that is read: with the planner's block, set-up, search and route,
in both. Both have chosen the task on that map before, so that neither pays for what loading the map has left; both plan
for the first time since. It is the thread's time on a processor, the least of some rounds that take turns.
"""
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, read_text, run, shown_path, write_whole
from tools.design.robot_json import build_directory

README = ROOT / "tools/python/README.md"
COMMAND = "make bench-python"
ROUNDS = 5
# The maps that come with the project, and hills with walls: of so many cells a side, by a seed.
MAPS = ("office", "yard")
HILLS = {"hills, 100 cells": (100, 1), "hills, 150 cells": (150, 2), "hills, 200 cells": (200, 3)}
ROBOTS = ("zhang2018", "burger")
MEMORY_KIB = 65536
RATIO_BAR, LINES_BAR, INSTALL_BAR_S = 1.1, 5, 180


def first_commands():
    """The lines of the first block of the package's README."""
    block = re.search(r"^```sh\n(.*?)^```$", read_text(README), re.M | re.S)
    if block is None:
        raise ToolError(f"{shown_path(README)}: has no commands")
    return [line for line in block[1].splitlines() if line]


def children_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def timed(command, **options):
    """Seconds by the clock and of the processors; ToolError: it failed."""
    clock, processors = time.perf_counter(), children_seconds()
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        reason = (done.stderr.strip() or "no reason given").splitlines()[-1]
        raise ToolError(f"{command}: exit status {done.returncode}: {reason}")
    return time.perf_counter() - clock, children_seconds() - processors


def copy_sources(folder):
    """The project as it stands, without anything that was built."""
    for name in subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, text=True,
                               check=True, capture_output=True).stdout.split("\0"):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)


def install():
    """(command, seconds by the clock, of the processors) of each first command, in a fresh environment, from a fresh copy
    of the project."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "joulepath"
        copy_sources(copy)
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith(("MAKE", "MFLAGS", "PYTHON", "VIRTUAL_ENV", "SKBUILD"))}
        for command in first_commands():
            yield command, *timed(command, shell=True, cwd=copy, env=environment)


# ---- Planning --------------------------------------------------------------------------------------------------------

def write_hills(path, side, seed, cell):
    """Walls with gaps over hills up to 1.5 m."""
    import numpy
    random = numpy.random.default_rng(seed)
    y, x = numpy.mgrid[0:side, 0:side]
    cells = numpy.zeros((side, side), bool)
    for wall in range(20, side, 20):
        cells[:, wall] = True
        gap = random.integers(0, side - 12)
        cells[gap:gap + 12, wall] = False
    elevation = sum(random.uniform(0.1, 0.5) * numpy.sin(2 * numpy.pi * (x * random.normal() + y * random.normal()) / 60)
                    for _ in range(3))
    path.write_text(json.dumps({
        "format": "joulepath-map-1", "name": path.stem, "width": side, "height": side, "resolution_m": cell,
        "origin_m": [0, 0, 0], "rows": ["".join(".#"[int(cell)] for cell in row) for row in cells[::-1]],
        "elevation_m": numpy.round(elevation, 3)[::-1].tolist()}))


def write_maps(folder, cell):
    for name in MAPS:
        timed([sys.executable, "-m", "tools.design.import_map", ROOT / f"sim/scenarios/{name}.map", folder / f"{name}.json",
               "--cell-size", str(cell)], cwd=ROOT)
        yield name, folder / f"{name}.json"
    for name, (side, seed) in HILLS.items():
        path = folder / f"{name.replace(' ', '_')}.json"
        write_hills(path, side, seed, cell)
        yield name, path


def program_plans(path, robot, folder):
    """The summary of jp-plan, and in it the route of least energy."""
    command = [build_directory() / "bin/jp-plan", path, "--robot", robot, "--memory", str(MEMORY_KIB), "--output", folder]
    subprocess.run(command, check=False, capture_output=True)
    summary = json.loads(read_text(folder / "summary.json"))
    return summary, next(route for route in summary["routes"] if route["name"] == "energy")


def python_plans(joulepath, terrain, robot, start, goal):
    joulepath.Planner(terrain, robot, memory=MEMORY_KIB << 10).choose_task()
    begin = time.thread_time()
    planner = joulepath.Planner(terrain, robot, memory=MEMORY_KIB << 10)
    planner.set_task(start, goal)
    found = planner.work()
    return time.thread_time() - begin, found


def compare(joulepath, name, path, robot, folder):
    """(map and robot, s in C, s in Python): of the processor, the least of some rounds, one after the other."""
    in_c, in_python = [], []
    known = joulepath.Robot(robot)
    for _ in range(ROUNDS):
        summary, route = program_plans(path, robot, folder)
        in_c.append(route["whole_s"])
        seconds, found = python_plans(joulepath, joulepath.Terrain.load(path), known, summary["start"],
                                      summary["goal_m"])
        in_python.append(seconds)
        if found.joules != route["energy_j"]:
            raise ToolError(f"{name}, {robot}: {found.joules} J in Python, {route['energy_j']} J of jp-plan")
    return f"{name}, {robot}", min(in_c), min(in_python)


def comparisons():
    sys.path.insert(0, str(build_directory() / "python/site"))
    import joulepath
    for robot in ROBOTS:
        with tempfile.TemporaryDirectory() as folder:
            for name, path in write_maps(Path(folder), joulepath.Robot(robot).cell_m):
                yield compare(joulepath, name, path, robot, Path(folder) / "plan")


def figure(name, value, unit, bound=None):
    return {"name": f"Python package: {name}", "value": value, "unit": unit,
            "bound": bound and {"op": "<=", "value": bound}, "command": COMMAND}


def measure_install():
    steps = list(install())
    print_aligned([("command", "by the clock, s", "of processors, s"),
                   *((command, f"{clock:.1f}", f"{processors:.1f}") for command, clock, processors in steps)])
    yield figure("lines from a checkout to the first joules", len(steps), "", LINES_BAR)
    yield figure("from a checkout to the first joules, fresh environment", sum(step[1] for step in steps), "s", INSTALL_BAR_S)
    yield figure("the same, time of processors", sum(step[2] for step in steps), "s")


def measure_planning():
    rows = list(comparisons())
    print_aligned([("\nplan", "jp-plan, ms", "Python, ms", "ratio"),
                   *((name, f"{1e3 * c:.2f}", f"{1e3 * python:.2f}", f"{python / c:.3f}") for name, c, python in rows)])
    yield figure(f"planning, time over that of jp-plan, {len(rows)} plans: all together",
                 sum(python for _, _, python in rows) / sum(c for _, c, _ in rows), "", RATIO_BAR)
    yield figure(f"planning, time over that of jp-plan, {len(rows)} plans: mean",
                 sum(python / c for _, c, python in rows) / len(rows), "", RATIO_BAR)
    yield figure(f"planning, time over that of jp-plan, {len(rows)} plans: worst",
                 max(python / c for _, c, python in rows), "", RATIO_BAR)


PARTS = {"install": measure_install, "planning": measure_planning}


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("parts", metavar="PART", nargs="+", choices=PARTS, help="install, planning")
    for part in parser.parse_args().parts:
        output = build_directory() / f"bench/python_{part}.json"
        write_whole(output, json.dumps(list(PARTS[part]()), indent=1) + "\n")
        print(f"wrote {shown_path(output)}")
    return 0


if __name__ == "__main__":
    run(main)
