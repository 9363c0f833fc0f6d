#!/usr/bin/env python3
"""Measure the navigator of the firmware's image.

Drives courier24 over random maps among boxes that they do not show: large ones with the application in process, small
ones over the bus both in process and with the image in QEMU as the controller, and compares these byte by byte; reads
what the navigator takes of the image's memory. Prints a table, writes figures for figures.py and leaves the drives in
build/image. Exit status 2: a program failed; nothing was written.
"""
import csv
import json
import os
import random
import re
import shutil
import statistics
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, run, shown_path, write_whole
from tools.design import robot_json

ROBOT = "courier24"
CELL = 0.1  # m
COMMAND = "make bench-image"

LARGE, SMALL = 192, 40    # cells a side
DRIVES, PIL_DRIVES = 100, 20
FIRST_SEED = 910001
SHARE = 0.06              # of the cells that boxes cover
KEPT_FREE = 7             # cells round start and goal
PIL_SECONDS = 3600

WAITS = ("planning", "proving", "joining")  # states in which it stands and works out its way
REPLAN_BAR = 500          # ms
RAM_BAR = 112 * 1024
MEMORY = ("navigation", "planner_block", "ground")  # of hal/stm32f4/main.c


def random_map(side, seed):
    """Rows, the northern one first; start and goal are in opposite corners."""
    draw = random.Random(seed)
    occupied = {(x, y) for x in range(side) for y in range(side) if x in (0, side - 1) or y in (0, side - 1)}
    covered = 0
    while covered < SHARE * side * side:
        width, height = draw.choice([(1, draw.randint(4, 20)), (draw.randint(4, 20), 1),
                                     (draw.randint(1, 6), draw.randint(1, 6))])
        x, y = draw.randrange(side), draw.randrange(side)
        occupied |= {(u, v) for u in range(x, min(x + width, side)) for v in range(y, min(y + height, side))}
        covered += width * height
    free = {(corner + x, corner + y) for corner in (2, side - 2 - KEPT_FREE) for x in range(KEPT_FREE)
            for y in range(KEPT_FREE)}
    return ["".join("#" if (x, y) in occupied - free else "." for x in range(side)) for y in reversed(range(side))]


def write_map(path, side, seed):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"format": "joulepath-map-1", "name": path.stem, "width": side, "height": side,
                                "resolution_m": CELL, "origin_m": [0, 0, 0], "rows": random_map(side, seed)}))
    return path


def command(build, map_path, side, seed, bus, output):
    near, far = ((corner + KEPT_FREE / 2) * CELL for corner in (2, side - 2 - KEPT_FREE))
    return [build / "bin/jp-navigate", map_path, "--robot", ROOT / f"sim/robots/{ROBOT}.cfg",
            f"--start={near},{near},45", f"--goal={far},{far}", f"--hidden={side // 16}", "--view=1.5",
            f"--seed={seed}", "--bus", bus, "--frames", "--patience", "600", "--output", output]


def drive(arguments, seconds=1800):
    """The summary of a drive."""
    result = subprocess.run([str(part) for part in arguments], capture_output=True, text=True, check=False,
                            timeout=seconds, cwd=ROOT)
    if result.returncode > 1:
        raise ToolError(f"jp-navigate: {(result.stderr.strip() or 'no reason given').splitlines()[-1]}")
    return json.loads((arguments[-1] / "summary.json").read_text())


def drive_in_qemu(build, arguments):
    """As drive(), with the image as the controller; the bus is the last but --output's."""
    image = build / f"firmware/{ROBOT}/emulated.elf"
    with subprocess.Popen(["qemu-system-arm", "-M", "netduinoplus2", "-nographic", "-monitor", "none", "-serial", "pty",
                           "-kernel", image], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as qemu:
        try:
            line = re.search(r"redirected to (\S+)", qemu.stdout.readline())
            if line is None:
                raise ToolError(f"qemu-system-arm: gave no serial line for {shown_path(image)}")
            time.sleep(0.2)
            return drive([part if part != "in-process" else f"slcan:{line[1]}" for part in arguments], PIL_SECONDS)
        finally:
            qemu.kill()


def waits(folder):
    """ms of each time that it stood, worked out its way and found one, the first left out."""
    with (folder / "drive.csv").open() as file:
        rows = list(csv.DictReader(file))
    begin, found = None, []
    for row in rows:
        if row["state"] in WAITS:
            begin = float(row["t_s"]) if begin is None else begin
        elif begin is not None:
            found += [1000 * (float(row["t_s"]) - begin)] if row["state"] == "turning" else []
            begin = None
    return found[1:]


def frames(folder):
    """Without those of lockstep, which are sent again when the computer is slow, and those of the way home, for which
    the image has no memory."""
    return [line for line in (folder / "frames.log").read_text().splitlines()
            if not re.search(" (7F[01]|19[CD])#", line)]


def told(folder):
    """The summary of a drive, and the state of its home apart."""
    summary = json.loads((folder / "summary.json").read_text())
    return summary, summary["bus"].pop("home")["state"]


def are_equal(one, other):
    return ((one / "drive.csv").read_bytes() == (other / "drive.csv").read_bytes() and
            told(one)[0] == told(other)[0] and frames(one) == frames(other))


def figure(name, value, unit, bound):
    return {"name": name, "value": value, "unit": unit, "bound": bound, "command": COMMAND}


def equal_to(value):
    return {"op": "==", "value": value}


def at_most(value):
    return {"op": "<=", "value": value}


def large_drives(build, folder):
    results, replans = [], []
    for seed in range(FIRST_SEED, FIRST_SEED + DRIVES):
        output = folder / f"large-{seed}"
        summary = drive(command(build, write_map(folder / f"large-{seed}.json", LARGE, seed), LARGE, seed,
                                "in-process", output))
        results.append(summary["result"])
        replans += waits(output)
        shutil.rmtree(output)
    what = f"navigator of the application, {len(results)} maps of {LARGE} × {LARGE} cells"
    ends = [(result["state"], result["reason"]) for result in results]
    yield figure(f"{what}: drives that touched something", sum(result["touched"] for result in results), "", equal_to(0))
    yield figure(f"{what}: arrived", sum(state == "arrived" for state, _ in ends), "", None)
    yield figure(f"{what}: proved unreachable", sum(state == "unreachable" for state, _ in ends), "", None)
    yield figure(f"{what}: ended for want of memory", sum(reason == "no memory" for _, reason in ends), "", None)
    yield figure(f"{what}: planned anew while driving", len(replans), "", None)
    yield figure(f"{what}: from the stand to a new way, a slice a tick, median", statistics.median(replans), "ms", None)
    yield figure(f"{what}: from the stand to a new way, a slice a tick, worst", max(replans), "ms", at_most(REPLAN_BAR))


def small_drives(build, folder):
    """The first drives in process whose goals can be reached: their arguments and folders."""
    found, seed = [], FIRST_SEED
    while len(found) < PIL_DRIVES:
        map_path = write_map(folder / f"small-{seed}.json", SMALL, seed)
        alone = folder / f"small-{seed}-in-process"
        arguments = command(build, map_path, SMALL, seed, "in-process", alone)
        if drive(arguments)["result"]["state"] == "unreachable":
            shutil.rmtree(alone)
        else:
            found.append((arguments, alone, folder / f"small-{seed}-image"))
        seed += 1
    return found


def repeat_with_image(build, small_drive):
    """Whether the image arrived and touched nothing, and whether it did what was done in process."""
    arguments, alone, image = small_drive
    result = drive_in_qemu(build, [*arguments[:-1], image])["result"]
    is_right = result["state"] == "arrived" and not result["touched"]
    is_equal = are_equal(alone, image)
    print(f"{image.name}: {'arrived' if is_right else result['state']}, {'equal' if is_equal else 'not equal'}", flush=True)
    return is_right, is_equal


def pil_drives(build, folder):
    drives = small_drives(build, folder)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda small_drive: repeat_with_image(build, small_drive), drives))
    yield figure(f"navigator of the image in QEMU, {PIL_DRIVES} drives: arrived, and touched nothing",
                 sum(is_right for is_right, _ in results), "", equal_to(PIL_DRIVES))
    yield figure(f"navigator of the image in QEMU, {PIL_DRIVES} drives: same frames, trajectory and energies as in "
                 "process", sum(is_equal for _, is_equal in results), "", equal_to(PIL_DRIVES))


def memory(build):
    names = subprocess.run(["arm-none-eabi-nm", "-S", build / f"firmware/{ROBOT}/joulepath.elf"], capture_output=True,
                           text=True, check=True).stdout
    sizes = {name: int(size, 16) for size, name in re.findall(r"^\w+ (\w+) [bB] (\w+)$", names, re.MULTILINE)}
    if not set(MEMORY) <= set(sizes):
        raise ToolError(f"{ROBOT}: the image has no navigator; run make firmware ROBOT={ROBOT}")
    yield figure(f"RAM of the navigator, map of {LARGE} × {LARGE} cells, all of it", sum(sizes[name] for name in MEMORY),
                 "B", at_most(RAM_BAR))
    yield figure("RAM of the navigator: the planner's block", sizes["planner_block"], "B", None)


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--bench", metavar="FILE", type=Path,
                        help="where the figures go (default: build/bench/image.json)")
    options = parser.parse_args()
    build = Path(os.path.abspath(robot_json.build_directory()))
    path = options.bench or build / "bench/image.json"
    folder = build / "image"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    figures = [*memory(build), *large_drives(build, folder), *pil_drives(build, folder)]
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, json.dumps(figures, indent=1, ensure_ascii=False) + "\n")
    print_aligned([(each["name"], f"{each['value']:g} {each['unit']}".rstrip()) for each in figures])
    print(f"wrote {shown_path(path)}")


if __name__ == "__main__":
    run(main)
