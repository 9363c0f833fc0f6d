#!/usr/bin/env python3
"""Drive the patrol robot over a map in MuJoCo: the controller's program on the bus as in `make patrol BUS=`, another physics
as the world, and a laser scanner that sees its walls.

MAP is one of tools.design.import_map. Writes the frames (frames.log), what was so (world.csv), result.json, a picture of the
map and a film of the drive. Exit status 1: the robot did not arrive, and one line says why; 2: bad input.
"""
import json
import math
import sys
from pathlib import Path

import mujoco

from tools.common import ArgumentParser, ToolError, print_aligned, run, shown_path, whole_number, write_whole
from tools.design import robot_json
from tools.mujoco import film
from tools.mujoco.drive import Drive, load_robot
from tools.mujoco.mission import (EXIT_NOT_ARRIVED, FRAMES_NAME, FrameLog, add_condition_arguments, conditions_of,
                                  conditions_text, drawn_film, ledger_rows, track_csv)
from tools.operate import can_map, map_stream
from tools.operate.can_client import RobotError
from tools.operate.drive import map_task, parse_goal, parse_start

RESULT_NAME, TRACK_NAME = "result.json", "world.csv"
REST = 2.0  # s in which it says what the leg took


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("map", metavar="MAP.json", type=Path)
    parser.add_argument("--start", metavar="X,Y,DEG", type=parse_start, required=True, help="in the map's frame")
    parser.add_argument("--goal", metavar="X,Y[,DEG]", type=parse_goal, required=True)
    parser.add_argument("--robot", metavar="NAME", default="patrol", help="patrol")
    parser.add_argument("--seed", metavar="N", type=whole_number(0, 2**32 - 1), default=1, help="of the noise; 1")
    parser.add_argument("--output", metavar="DIR", type=Path, default=Path("build/patrol"), help="build/patrol")
    add_condition_arguments(parser)
    return parser.parse_args()


def checked_robot(name):
    robot = load_robot(name)
    if robot.type != robot_json.FOUR_WHEEL:
        raise ToolError(f"--robot {name}: has no four steered wheels; drive it by tools.mujoco.mission")
    return robot


def goal_errors(pose, cell_map, goal):
    """m, and degrees where the goal has a heading."""
    there = cell_map.from_corner(map_stream.Place(*goal))
    turn = math.degrees(math.remainder(pose[2] - math.radians(there.heading), math.tau))
    return math.hypot(pose[0] - there.x, pose[1] - there.y), abs(turn) if len(goal) == 3 else None


def result_of(drive, options, cell_map, failure):
    distance, turn = goal_errors(drive.world.pose(), cell_map, options.goal)
    leg = drive.operator.state.segments.get(1)
    return {"robot": options.robot, "world": f"MuJoCo {mujoco.__version__}", "conditions": conditions_text(options),
            "seed": options.seed, "arrived": failure is None, "failure": failure, "seconds": drive.bus.seconds,
            "goal_error_m": distance, "goal_error_deg": turn, "forecast_j": leg and leg.predicted,
            "metered_j": leg and leg.drawn, "ledger_j": drive.world.ledger()}


def drive_map(options):
    """(drive, result)."""
    robot, cell_map = checked_robot(options.robot), map_stream.read_cells(options.map)
    cell_map.cell("--start", options.start)
    stream, goal = map_task(options)
    options.output.mkdir(parents=True, exist_ok=True)
    failure = None
    with open(options.output / FRAMES_NAME, "w", encoding="ascii") as frames:
        with Drive(robot, conditions_of(options, options.seed), log=FrameLog(frames), ecu_log=options.output / "ecu.log",
                   place=(cell_map, cell_map.from_corner(options.start))) as drive:
            try:
                drive.stand()
                drive.operator.navigate(stream, goal)
                drive.operator.hold(REST)
            except RobotError as error:
                failure = str(error)
    return robot, drive, result_of(drive, options, cell_map, failure)


def write_results(options, robot, drive, result):
    write_whole(options.output / TRACK_NAME, track_csv(drive.track))
    film.save(options.output, drive.world.xml, drive.track)
    film.make(options.output, lambda: drawn_film(robot, drive.track))
    write_whole(options.output / RESULT_NAME, json.dumps(result, indent=1) + "\n")
    can_map.write(options.output, *can_map.convert(options.output / FRAMES_NAME))


def print_result(result):
    rows = [["of the way", "", ""], ["time", f"{result['seconds']:.1f}", "s"],
            ["from the goal", f"{100 * result['goal_error_m']:.1f}", "cm"]]
    if result["goal_error_deg"] is not None:
        rows.append(["from its heading", f"{result['goal_error_deg']:.1f}", "°"])
    rows += [[name, "-" if result[key] is None else f"{result[key]:.1f}", "J"]
             for name, key in (("foretold", "forecast_j"), ("by its meter", "metered_j"))]
    print_aligned(rows)
    print("\nout of the cells, and where it went, J:")
    print_aligned(ledger_rows(result["ledger_j"]))


def main():
    options = arguments()
    robot, drive, result = drive_map(options)
    write_results(options, robot, drive, result)
    print_result(result)
    for name in (RESULT_NAME, TRACK_NAME, film.FILM_NAME):
        print(f"wrote {shown_path(options.output / name)}")
    if result["failure"] is not None:
        print(result["failure"], file=sys.stderr)
        return EXIT_NOT_ARRIVED
    return 0


if __name__ == "__main__":
    run(main)
