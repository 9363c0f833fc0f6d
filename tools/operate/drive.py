#!/usr/bin/env python3
"""Send a robot a route, a goal, or a map and a goal on it over CAN and follow it there.

Ctrl-C brakes the robot to a stand. Exit status 1: the robot did not arrive, and one line says why; 2: bad input.
"""
import argparse
import json
import sys
import time
from pathlib import Path

import libconf
from rich.console import Console, Group
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table

from tools.common import ArgumentParser, ToolError, read_text, run, shown_path, write_whole
from tools.operate import map_stream
from tools.operate.can_client import Listener, Operator, RobotError, add_bus_argument, check_waypoints, open_bus

EXIT_NOT_ARRIVED = 1
VIEW_PERIOD = 0.2  # s
BAR_WIDTH = 24

COUNTERS = {"EcuErrors": ("CrcErrors", "SequenceErrors", "OperatorTimeouts", "BusOffs", "Conflicts", "Malformed"),
            "EcuLosses": ("LostSamples", "UnknownFrames", "Rejected", "SendErrors"),
            "EcuStatus": ("Resets",)}


# ---- what there is to tell -----------------------------------------------------------------------------------------

def number(value, digits, unit=""):
    return "–" if value is None else f"{value:.{digits}f} {unit}".rstrip()


def percent_more(spent, predicted):
    return None if not predicted or spent is None else 100 * (spent / predicted - 1)


class Progress:
    """The energy that the segment now driven has used so far, and the share of it that is driven."""

    def __init__(self):
        self._segment = self._energy_before = None

    def follow(self, state):
        segment = state.get("RouteStatus", "Segment")
        if segment != self._segment:
            self._segment, self._energy_before = segment, state.get("EnergySpent", "Energy")

    def used(self, state):
        energy = state.get("EnergySpent", "Energy")
        return None if energy is None or self._energy_before is None else energy - self._energy_before

    @staticmethod
    def share(state, index):
        segment, ended = state.get("RouteStatus", "Segment") or 0, state.get("RouteStatus", "SegmentsEnded") or 0
        left = state.get("Reference", "SegmentTimeLeft")
        duration = state.get("SegmentShape", "Duration")
        if index <= ended:
            return 1.0
        if index != segment or left is None or not duration or state.get("SegmentShape", "Segment") != index:
            return 0.0
        return min(max(1 - left / duration, 0.0), 1.0)


def status_line(state):
    version = ".".join(str(state.get("EcuStatus", f"Version{part}")) for part in ("Major", "Minor", "Patch"))
    parts = [f"{state.state or 'no EcuStatus yet'}",
             f"route {state.get('RouteStatus', 'State')}, {state.get('RouteStatus', 'SegmentsEnded') or 0} of "
             f"{state.get('RouteStatus', 'Length') or 0} waypoints",
             f"operator {state.get('EcuStatus', 'OperatorState')}", f"v{version}"]
    return " · ".join(parts)


def motion_line(state):
    return (f"x {number(state.get('Pose', 'X'), 2)}, y {number(state.get('Pose', 'Y'), 2, 'm')} · "
            f"{number(state.get('Motion', 'Speed'), 2, 'm/s')}")


def navigator_line(state):
    """What the navigator does; None where there is none."""
    if "NavigationStatus" not in state.latest:
        return None
    doing, reason = (state.get("NavigationStatus", signal) for signal in ("State", "Reason"))
    text = f"map {state.get('MapStatus', 'State')} · {doing}" + (f" ({reason})" if reason != "None" else "")
    if state.get("NavigationStatus", "HasCourse"):
        left = [state.get("NavigationProgress", signal) for signal in ("Distance", "Duration", "Energy", "Deviation")]
        text += (f" · {number(left[0], 1, 'm')}, {number(left[1], 0, 's')}, {number(left[2], 0)} ± "
                 f"{number(left[3], 0, 'J')} left")
    return f"{text} · planned anew {state.get('NavigationStatus', 'Replans')} times"


def home_line(state):
    """Whether what is left brings the robot home; None where nothing is told."""
    if "HomeStatus" not in state.latest:
        return None
    text = state.get("HomeStatus", "HomeState")
    probability, way, give = (state.get("HomeStatus", signal) for signal in ("Probability", "Way", "WayDeviation"))
    if not probability:
        return text
    left, deviation = (state.get("HomeBattery", signal) for signal in ("Left", "LeftDeviation"))
    return (f"{text}, {number(100 * probability, 2, '%')} · {number(way, 0)} ± {number(give, 0, 'J')} of "
            f"{number(left, 0)} ± {number(deviation, 0, 'J')}")


def energy_line(state):
    charge = state.get("BatteryStatus", "StateOfCharge")
    return (f"spent {number(state.get('EnergySpent', 'Energy'), 1, 'J')}, "
            f"drawn {number(state.get('EnergyDrawn', 'Energy'), 1, 'J')} · battery "
            f"{number(None if charge is None else 100 * charge, 1, '%')}, "
            f"{number(state.get('BatteryStatus', 'EnergyLeft'), 2, 'Wh')}, "
            f"{number(state.get('BatteryStatus', 'Voltage'), 1, 'V')}")


def counters(state):
    """Every counter of the ECU, None before it was told."""
    return {name: state.get(message, name) for message, names in COUNTERS.items() for name in names}


def counter_line(state):
    counted = [f"{name} {value}" for name, value in counters(state).items() if value]
    return ", ".join(counted) or "none"


# ---- views ---------------------------------------------------------------------------------------------------------

class LiveView:
    """A picture on a terminal."""

    def __init__(self, console):
        self._live = Live(console=console, auto_refresh=False)
        self._progress = Progress()
        self._next = 0.0

    def __enter__(self):
        self._live.start()
        return self

    def __exit__(self, *_):
        self._live.stop()

    def __call__(self, state):
        self._progress.follow(state)
        if time.monotonic() >= self._next:
            self._next = time.monotonic() + VIEW_PERIOD
            self._live.update(self._picture(state), refresh=True)

    def _picture(self, state):
        about = Table.grid(padding=(0, 2))
        about.add_row("robot", status_line(state))
        about.add_row("motion", motion_line(state))
        about.add_row("energy", energy_line(state))
        if navigator_line(state) is not None:
            about.add_row("navigator", navigator_line(state))
        if home_line(state) is not None:
            about.add_row("home", home_line(state))
        about.add_row("faults", ", ".join(state.faults) or "none", style="bold red" if state.faults else "")
        about.add_row("counters", counter_line(state))
        return Group(about, self._segments(state))

    def _segments(self, state):
        table = Table(box=None)
        for title in ("segment", "driven", "predicted J", "used J", "more %"):
            table.add_column(title, justify="left" if title == "driven" else "right")
        for index, segment in sorted(state.segments.items()):
            share = Progress.share(state, index)
            driven_now = segment.spent is None and index == state.get("RouteStatus", "Segment")
            used = self._progress.used(state) if driven_now else segment.spent
            table.add_row(str(index), ProgressBar(total=1.0, completed=share, width=BAR_WIDTH),
                          number(segment.predicted, 2), number(used, 2),
                          number(percent_more(segment.spent, segment.predicted), 2))
        return table


class PlainView:
    """A line for each change, for files and pipes."""

    def __init__(self, console):
        self._console = console
        self._shown = {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def __call__(self, state):
        if state.state is not None:
            self._show("state", f"{state.state}, operator {state.get('EcuStatus', 'OperatorState')}")
            self._show("faults", ", ".join(state.faults) or None)
        if "RouteStatus" in state.latest:
            self._show("route", f"{state.get('RouteStatus', 'RouteId')} {state.get('RouteStatus', 'State')}")
        if "NavigationStatus" in state.latest:
            self._show("navigator", navigator_line(state).split(" · ")[1])
        if "HomeStatus" in state.latest:
            self._show("home", state.get("HomeStatus", "HomeState"))
        for index, segment in state.segments.items():
            self._show(f"segment {index}", self._segment(segment) + (
                f"; {energy_line(state)}" if segment.spent is not None else ""))

    def _segment(self, segment):
        text = f"predicted {number(segment.predicted, 2, 'J')}"
        return text if segment.spent is None else f"{text}, used {number(segment.spent, 2, 'J')}"

    def _show(self, what, text):
        key = text.split(";")[0] if text else text
        if self._shown.get(what) != key:
            self._shown[what] = key
            if key is not None:
                self._console.print(f"{what}: {text}", highlight=False, soft_wrap=True)


# ---- waypoints -----------------------------------------------------------------------------------------------------

def parse_point(text):
    try:
        x, y = map(float, text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r}: must be X,Y in m") from None
    return x, y


def parse_goal(text):
    """A point or, on a map, a pose."""
    try:
        place = tuple(map(float, text.split(",")))
    except ValueError:
        place = ()
    if len(place) not in (2, 3):
        raise argparse.ArgumentTypeError(f"{text!r}: must be X,Y in m, or X,Y,DEG on a map")
    return place


def parse_start(text):
    place = parse_goal(text)
    if len(place) != 3:
        raise argparse.ArgumentTypeError(f"{text!r}: must be X,Y,DEG")
    return map_stream.Place(*place)


def parse_route(text):
    return [parse_point(point) for point in text.split()]


def scenario_waypoints(path):
    """Those of a scenario (sim/scenarios/*.cfg) but the first, which is where the robot stands."""
    try:
        waypoints = libconf.loads(read_text(path))["waypoints"]
        return [(float(x), float(y)) for x, y in waypoints][1:]
    except libconf.ConfigParseError as error:
        reason = str(error).replace(" in '<unknown>'", "")
        raise ToolError(f"{path}: {' '.join(reason.split())}") from None
    except KeyError:
        raise ToolError(f"{path}: waypoints: missing") from None
    except (TypeError, ValueError):
        raise ToolError(f"{path}: waypoints: must be a list of [x, y]") from None


def waypoints_of(options):
    """The route or goal; None on a map, with --watch and --off."""
    if options.map is not None:
        return None
    if options.goal is not None:
        check_waypoints("--goal", [options.goal])
        return [options.goal]
    if options.route is not None:
        check_waypoints("--route", options.route)
        return options.route
    if options.scenario is not None:
        waypoints = scenario_waypoints(options.scenario)
        check_waypoints(options.scenario, waypoints)
        return waypoints
    return None


# ---- on a map ------------------------------------------------------------------------------------------------------

def map_task(options):
    """(stream of the map, signals of the goal); None without a map."""
    if options.map is None:
        return None
    cell_map = map_stream.read_cells(options.map)
    cell_map.cell("--start", options.start)
    place = map_stream.Place(*options.goal)
    x, y = cell_map.cell("--goal", place)
    turn = (cell_map.from_corner(place).heading / 360 + 0.5) % 1 - 0.5 if len(options.goal) == 3 else 0.0
    step = 1 / 4096  # of the signal
    goal = {"Column": x, "Row": y, "HasHeading": int(len(options.goal) == 3), "Heading": min(round(turn / step), 2047) * step}
    return map_stream.encode(cell_map, cell_map.from_corner(options.start)), goal


def check(parser, options):
    if (options.map is None) != (options.start is None):
        parser.error("--map and --start go together")
    if options.map is not None and options.goal is None:
        parser.error("--map: also give --goal")
    if options.map is None and options.goal is not None and len(options.goal) == 3:
        parser.error("--goal: a heading is for a goal on a map; give --map")


# ---- drive ---------------------------------------------------------------------------------------------------------

def command(operator, options, waypoints, task):
    """RobotError: the robot did not do it."""
    if options.off:
        operator.off()
        return
    operator.stand()
    if task is not None:
        operator.navigate(*task)
    elif options.goal is not None:
        operator.drive_goal(options.goal)
    else:
        operator.drive_route(waypoints)
    operator.stand()


def stop(operator):
    operator.stand()
    raise operator.error("stopped by Ctrl-C; the robot stands")


def watch(listener):
    try:
        while True:
            listener.step()
            listener.check_heartbeat()
    except KeyboardInterrupt:
        pass


def result(state, waypoints, failure):
    segments = [{"index": index, "predicted_j": segment.predicted, "spent_j": segment.spent, "drawn_j": segment.drawn}
                for index, segment in sorted(state.segments.items())]
    return {"waypoints_m": waypoints, "arrived": failure is None, "failure": failure, "segments": segments,
            "energy_spent_j": state.get("EnergySpent", "Energy"), "energy_drawn_j": state.get("EnergyDrawn", "Energy"),
            "battery_left_wh": state.get("BatteryStatus", "EnergyLeft"), "state": state.state, "faults": state.faults,
            "position_m": [state.get("Pose", "X"), state.get("Pose", "Y")], "counters": counters(state)}


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    add_bus_argument(parser)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--route", metavar='"X,Y X,Y …"', type=parse_route, help="waypoints, m")
    what.add_argument("--scenario", metavar="FILE", type=Path, help="the waypoints of a scenario file")
    what.add_argument("--goal", metavar="X,Y[,DEG]", type=parse_goal,
                      help="a single point, m; --goal=-1,2 where X is negative; with --map in the map's frame")
    what.add_argument("--off", action="store_true", help="motors off; clears faults")
    what.add_argument("--watch", action="store_true", help="only watch, until Ctrl-C")
    parser.add_argument("--map", metavar="FILE", type=Path,
                        help="a map (tools.design.import_map) on which the robot finds its way to the goal")
    parser.add_argument("--start", metavar="X,Y,DEG", type=parse_start,
                        help="where on the map the robot was switched on")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write what happened at the end")
    options = parser.parse_args()
    check(parser, options)
    return options


def drive(bus, options, waypoints, task, view):
    """The last state of the robot, and why it did not arrive or None."""
    actor = (Listener if options.watch else Operator)(bus, options.bus, view)
    try:
        if options.watch:
            watch(actor)
            return actor.state, None
        try:
            command(actor, options, waypoints, task)
        except KeyboardInterrupt:
            stop(actor)
    except RobotError as error:
        return actor.state, str(error)
    return actor.state, None


def main():
    options = arguments()
    waypoints, task = waypoints_of(options), map_task(options)
    console = Console()
    with open_bus(options.bus) as bus, (LiveView if console.is_terminal else PlainView)(console) as view:
        state, failure = drive(bus, options, waypoints, task, view)
    if options.json is not None:
        write_whole(options.json, json.dumps(result(state, waypoints, failure), indent=1) + "\n")
        print(f"wrote {shown_path(options.json)}")
    if failure is not None:
        print(f"{Path(sys.argv[0]).name}: {failure}", file=sys.stderr)
        return EXIT_NOT_ARRIVED
    return 0


if __name__ == "__main__":
    run(main)
