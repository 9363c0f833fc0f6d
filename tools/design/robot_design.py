#!/usr/bin/env python3
"""From a robot file, of any kind, to all of its tables, tried out on the way: is this robot good, and how good?

What is made and tried of each kind: balancer_design.py, skid_design.py, four_wheel_design.py. Everything is made in a folder;
the tables go to src/tables/ when the robot does what it must. Exit status 1: it does not, and why; 2: bad input. Then
src/tables/ is as it was. The report is written either way.
"""
import json
from dataclasses import asdict
from pathlib import Path

from tools.common import ROOT, ArgumentParser, print_aligned, run, shown_path, write_whole
from tools.design import balancer_design, four_wheel_design, robot_json, robot_trials, skid_design, tables_header
from tools.design.robot_findings import Making
from tools.report import robot_report

KINDS = {robot_json.BALANCER: balancer_design, robot_json.SKID_STEER: skid_design,
         robot_json.DIFFERENTIAL_DRIVE: skid_design, robot_json.FOUR_WHEEL: four_wheel_design}
PACKS = ROOT / "sim" / "robots" / "packs"


def print_findings(findings):
    print()
    print_aligned([("", "measured", "", "must be", ""),
                   *((f.name, f"{f.value:.3g}", f.unit, f.bar, "" if f.is_met else "MISSED") for f in findings)])
    print()


def make_battery(making):
    """Of the cells that it has, if a file says so."""
    if (PACKS / making.robot_file.name).exists():
        robot_trials.tool("battery", making.robot_file.stem, "--tables", making.tables)


def install(making, tables):
    """All at once: the robot is whole, or as it was."""
    for path in sorted(making.tables.glob("*.c")):
        write_whole(tables / path.name, path.read_bytes())
    if tables == ROOT / "src" / "tables":
        tables_header.declare()


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C files go (default: src/tables)")
    return parser.parse_args()


def make(making):
    made = KINDS[robot_json.load_any(making.robot_file).type].make(making)
    make_battery(making)
    return made


def main():
    options = arguments()
    robot_file = robot_json.robot_path(options.robot).resolve()
    making = Making(robot_file, robot_json.build_directory().resolve() / "robot" / robot_file.stem)
    making.tables.mkdir(parents=True, exist_ok=True)
    made = make(making)
    print_findings(made.findings)
    write_whole(making.folder / "robot.json", json.dumps([asdict(finding) for finding in made.findings], indent=2,
                                                         ensure_ascii=False, default=bool) + "\n")
    write_whole(making.folder / "report.html", robot_report.render(made))
    print(f"wrote {shown_path(making.folder / 'report.html')}")
    missed = [finding for finding in made.findings if not finding.is_met]
    if missed:
        first = missed[0]
        print(f"{made.robot.name}: {first.name} {first.value:.3g} {first.unit}, must be {first.bar}: {first.remedy}")
        return 1
    install(making, options.tables)
    print(f"{made.robot.name}: good; its tables are in {shown_path(options.tables)}")
    return 0


if __name__ == "__main__":
    run(main)
