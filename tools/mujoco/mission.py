#!/usr/bin/env python3
"""Drive a scenario's route in MuJoCo: the controller's program on the bus as in `make sil`, another physics as the world.

Writes what tools.report.report makes a page of, the frames (frames.log), what was so (world.csv), and a film of the drive.
Exit status 1: the robot did not arrive, and one line says why; 2: bad input.
"""
import argparse
import csv
import io
import math
import sys
import time
from pathlib import Path

import libconf
import mujoco

from tools.common import (ArgumentParser, ToolError, print_aligned, read_text, real_number, run, shown_path,
                          whole_number, write_whole)
from tools.design import robot_json
from tools.mujoco import film
from tools.mujoco.drive import Drive, load_robot
from tools.mujoco.ground import Ground, Patch, Step
from tools.mujoco.world import Conditions
from tools.operate.can_client import RobotError
from tools.operate.can_report import Converter
from tools.report import plots
from tools.report.mission_record import LOG_NAME, SUMMARY_NAME

EXIT_NOT_ARRIVED = 1
FRAMES_NAME = "frames.log"
REST = 1.0  # s of standing after the drive

TRACK_COLUMNS = ("t_s", "x_m", "y_m", "heading_rad", "pitch_rad", "cells_j")


# ---- what is asked for ---------------------------------------------------------------------------------------------

def numbers(count, names):
    """An option of numbers that commas divide."""
    def parse(text):
        try:
            values = [float(part) for part in text.split(",")]
        except ValueError:
            values = []
        if len(values) != count or not all(map(math.isfinite, values)):
            raise argparse.ArgumentTypeError(f"{text}: must be {names}")
        return values
    return parse


def add_condition_arguments(parser):
    parser.add_argument("--slope", metavar="DEGREES", type=real_number(-30, 30), default=0.0,
                        help="of the ground, which rises along x")
    parser.add_argument("--across", metavar="DEGREES", type=real_number(-30, 30), default=0.0, help="and to the left of x")
    parser.add_argument("--step", metavar="X,MM", type=numbers(2, "x in m and a height in mm"), action="append", default=[],
                        help="a board across the way, again for more")
    parser.add_argument("--patch", metavar="X,Y,R,FRICTION", action="append", default=[],
                        type=numbers(4, "x, y and radius in m, and a friction"), help="a slippery disc, again for more")
    parser.add_argument("--backlash", metavar="DEGREES", type=real_number(0, 5), default=0.0,
                        help="of the gears at the wheel")
    parser.add_argument("--delay", metavar="TICKS", type=whole_number(0, 50), default=0, help="of the inertial sensors")
    parser.add_argument("--hard-tyres", metavar="MM", type=real_number(0.001, 50), default=None,
                        help="how far they sink in, instead of what the file's tyres do")
    parser.add_argument("--payload", metavar="KG", type=real_number(0, 1000), default=0.0, help="at the body's centre")


def conditions_of(options, seed):
    steps = tuple(Step(x, height / 1000) for x, height in options.step)
    patches = tuple(Patch(*patch) for patch in options.patch)
    return Conditions(Ground(math.radians(options.slope), math.radians(options.across), steps, patches),
                      math.radians(options.backlash), options.delay, options.payload,
                      None if options.hard_tyres is None else options.hard_tyres / 1000, seed)


def read_scenario(path):
    """Robot, waypoints after the start, energy model, energy, seed, name."""
    try:
        scenario = libconf.loads(read_text(path))
    except libconf.ConfigParseError as error:
        raise ToolError(f"{path}: {' '.join(str(error).split())}") from None
    for key in ("name", "robot", "waypoints"):
        if key not in scenario:
            raise ToolError(f"{path}: {key}: is missing")
    for key in ("within_seconds", "within_joules"):
        if key in scenario:
            raise ToolError(f"{path}: {key}: a budget is for jp-mission; leave it out")
    if any(len(point) != 2 for point in scenario["waypoints"]):
        raise ToolError(f"{path}: waypoints: the bus carries points alone; write [x, y]")
    return scenario


# ---- what comes of it ----------------------------------------------------------------------------------------------

class FrameLog:
    """As candump -L writes, in simulated time."""

    def __init__(self, stream):
        self._stream = stream

    def __call__(self, seconds, id, data):
        self._stream.write(f"({seconds:017.6f}) can0 {id:03X}#{data.hex().upper()}\n")


def ledger_rows(ledger):
    return [[name, f"{joules:.4f}"] for name, joules in ledger.items()]


def track_csv(track):
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(TRACK_COLUMNS)
    writer.writerows([f"{value:.6g}" for value in sample[:len(TRACK_COLUMNS)]] for sample in track)
    return buffer.getvalue()


def drawn_film(robot, track):
    """The body from its side, at the moments of the film, where nothing can render."""
    height = 2 * robot.given("body.centre_height_m", 0.1)
    radius = robot.number("wheel.radius_m")
    figure, axes = plots.new_figure(9.2, 2.6)
    for i, sample in enumerate(film.chosen(track)):
        x, pitch = 3.5 * i * (height + radius), sample[4]
        axes.add_patch(plots.plt.Circle((x, radius), radius, color=plots.INK))
        axes.plot([x, x + height * math.sin(pitch)], [radius, radius + height * math.cos(pitch)], color=plots.BLUE,
                  linewidth=5)
        axes.text(x, -0.4 * radius, f"{sample[0]:.1f} s", ha="center", va="top")
    axes.axhline(0, color=plots.GREY)
    axes.set_aspect("equal")
    axes.set_axis_off()
    return plots.png_bytes(figure, dpi=100)


def conditions_text(options):
    parts = [f"slope {options.slope:g}°" if options.slope else "", f"across {options.across:g}°" if options.across else "",
             *(f"step of {height:g} mm at x = {x:g} m" for x, height in options.step),
             *(f"patch of friction {patch[3]:g}" for patch in options.patch),
             f"backlash {options.backlash:g}°" if options.backlash else "",
             f"inertial sensors {options.delay} ticks late" if options.delay else "",
             f"payload {options.payload:g} kg" if options.payload else "",
             "" if options.hard_tyres is None else f"tyres sink in by {options.hard_tyres:g} mm"]
    return ", ".join(part for part in parts if part) or "level ground"


def about_world(world, options, how):
    return {"name": f"MuJoCo {mujoco.__version__}", "conditions": conditions_text(options),
            "ledger_j": world.ledger(), "film": film.FILM_NAME, "film_is": how}


def write_results(directory, scenario, robot, converter, drive, options, wall):
    world, xml = drive.world, drive.world.xml
    write_whole(directory / "world.csv", track_csv(drive.track))
    film.save(directory, xml, drive.track)
    how = film.make(directory, lambda: drawn_film(robot, drive.track))
    converter.record.write(directory, {
        "robot": robot.name, "scenario": scenario["name"], "energy": scenario.get("energy", "motor"),
        "energy_model": scenario.get("energy_model", "identified"), "seed": int(scenario.get("seed", 1)),
        "simulation": {"ticks": world.tick, "wall_s": wall, "real_time_factor": world.tick / world.rate / wall},
        "world": about_world(world, options, how)})


# ---- the whole -----------------------------------------------------------------------------------------------------

def ecu_options(scenario, robot):
    if robot.type != robot_json.BALANCER:
        return []
    return ["--model", scenario.get("energy_model", "identified"), "--energy", scenario.get("energy", "motor")]


def drive_scenario(path, options):
    scenario = read_scenario(path)
    robot = load_robot((path.parent / scenario["robot"]).resolve())
    conditions = conditions_of(options, int(scenario.get("seed", 1)))
    options.output.mkdir(parents=True, exist_ok=True)
    converter = Converter(f"{scenario['name']} in MuJoCo")
    begin = time.monotonic()
    with open(options.output / FRAMES_NAME, "w", encoding="ascii") as frames:
        with Drive(robot, conditions, ecu_options(scenario, robot), FrameLog(frames), converter.take,
                   options.output / "ecu.log") as drive:
            drive.stand()
            drive.route([tuple(point) for point in scenario["waypoints"][1:]])
            drive.operator.hold(REST)
    write_results(options.output, scenario, robot, converter, drive, options, time.monotonic() - begin)
    return drive


def print_segments(drive):
    rows = [["segment", "planned J", "spent J", "drawn J"]]
    for index, segment in sorted(drive.operator.state.segments.items()):
        rows.append([str(index), *("-" if value is None else f"{value:.2f}"
                                   for value in (segment.predicted, segment.spent, segment.drawn))])
    print_aligned(rows)


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scenario", metavar="SCENARIO.cfg", type=Path)
    parser.add_argument("--output", metavar="DIR", type=Path, default=Path("build/mujoco"), help="build/mujoco")
    add_condition_arguments(parser)
    options = parser.parse_args()
    try:
        drive = drive_scenario(options.scenario, options)
    except RobotError as error:
        print(f"mission: {error}", file=sys.stderr)
        return EXIT_NOT_ARRIVED
    print_segments(drive)
    print("\nout of the cells, and where it went, J:")
    print_aligned(ledger_rows(drive.world.ledger()))
    for name in (LOG_NAME, SUMMARY_NAME, film.FILM_NAME):
        print(f"wrote {shown_path(options.output / name)}")
    return 0


if __name__ == "__main__":
    run(main)
