#!/usr/bin/env python3
"""Measure how far above the least energy for its time each point of a route's front is driven.

Reads DIR/front.json, the results of jp-front. The limit is that of energy_limit.py with the time of the drive and the
speed at its end. Prints a table and writes DIR/limits.json, of which tools/report/time_front_picture.py draws.
Exit status 2: bad input, or no limit was found; nothing was written.
"""
import json
from pathlib import Path

import numpy as np

from tools.common import ArgumentParser, print_aligned, run, shown_path, write_whole
from tools.design import robot_json
from tools.measure import bench_limit, energy_limit
from tools.report.time_front_picture import read_front

REQUESTS = {"least_energy": "least energy", "share": "least energy within s", "within_seconds": "asked: within s",
            "within_joules": "asked: within J"}

SLOWER = (1.3, 1.2, 1.1)  # of the time of least energy: there the limit is found, too, and nothing is driven

HEADINGS = ("request", "budget", "cruise, m/s", "forecast, s", "forecast, J", "driven, s", "driven, J", "limit, J",
            "above, %", "off forecast, %", "worst miss, cm")


def ends_of(drives):
    """(speed at the end, time in all): of each drive, then of what is slower."""
    first = drives[0]
    return [*((drive["end_speed_m_s"], drive["duration_s"]) for drive in drives),
            *((first["end_speed_m_s"] / share, first["duration_s"] * share) for share in SLOWER)]


def limits_of(front):
    """[(time, energy)] for those ends; found from the slowest to the fastest, each beside the one before it."""
    plant = energy_limit.Plant(robot_json.load(robot_json.robot_path(front["robot"])), front["energy"])
    task = energy_limit.Task(plant, np.array(front["waypoints_m"]))
    ends = ends_of(front["drives"])
    order = sorted(range(len(ends)), key=lambda i: -ends[i][1])
    found = energy_limit.least_in(task, [ends[i] for i in order], bench_limit.STARTS, bench_limit.SEED)
    limits = {}
    for i, solution in zip(order, found):
        bench_limit.check_limit(f"{front['scenario']} in {ends[i][1]:.2f} s", solution, ends[i][0])
        limits[i] = (ends[i][1], solution.energy)
    return [limits[i] for i in range(len(ends))]


def row(drive, limit):
    forecast, driven = drive["forecast"], drive["plant_energy_j"]
    return (REQUESTS[drive["request"]], f"{drive['limit']:.2f}" if drive["limit"] else "–",
            f"{forecast['cruise_m_s']:.4f}", f"{forecast['duration_s']:.2f}", f"{forecast['energy_j']:.2f}",
            f"{drive['duration_s']:.2f}", f"{driven:.2f}", f"{limit:.2f}", f"{100 * (driven / limit - 1):.3f}",
            f"{100 * (driven / forecast['energy_j'] - 1):.3f}", f"{100 * drive['passed_m']:.1f}")


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("directory", metavar="DIR", type=Path, help="what jp-front wrote")
    return parser.parse_args()


def main():
    directory = arguments().directory
    front = read_front(directory / "front.json")
    limits = limits_of(front)
    drives = front["drives"]
    points = [{"duration_s": float(seconds), "energy_j": float(energy)} for seconds, energy in limits]
    path = directory / "limits.json"
    write_whole(path, json.dumps({"scenario": front["scenario"], "drives": points[:len(drives)],
                                  "slower": points[len(drives):]}, indent=2) + "\n")
    print(f"{front['scenario']}: robot {front['robot']}, energy of the {front['energy']}")
    print_aligned([HEADINGS, *(row(drive, energy) for drive, (_, energy) in zip(drives, limits))])
    print(f"\nwrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
