#!/usr/bin/env python3
"""Send a robot a map and a goal on it over LCM, and follow it there.

jp-lcm is on the robot's bus and on the same LCM. What its sensors see on the way is sent by whoever has them, on
JP_CELLS, with the map_id that is printed. Ctrl-C ends the view; the robot drives on until jp-lcm is stopped. Exit status
1: the robot did not arrive, and one line says why; 2: bad input.
"""
import contextlib
import math
import struct
import time
import zlib
from pathlib import Path

from tools.common import ArgumentParser, ToolError, Verdict, run
from tools.operate import map_stream
from tools.operate.drive import parse_goal, parse_start
from tools.operate.lcm_map import MAP_ID_MAX, SIDE_MAX, choice
from tools.operate.lcm_report import QUIET_MAX, load_types, open_lcm

DEFAULT_URL = "udpm://239.255.76.67:7667?ttl=0"


# ---- messages ------------------------------------------------------------------------------------------------------

def map_message(types, cell_map, start):
    """With an id that depends on what the map is, so that another one gets another one, mostly."""
    if max(cell_map.cells.shape) > SIDE_MAX:
        raise ToolError(f"the map has more than {SIDE_MAX} cells a side; import a smaller window")
    origin = cell_map.from_corner(start)
    stream = map_stream.encode(cell_map, origin)
    message = types.map_t()
    message.utime, message.map_id = now(), zlib.crc32(stream) % MAP_ID_MAX + 1
    message.height, message.width = cell_map.cells.shape
    message.resolution = cell_map.resolution
    message.origin.x, message.origin.y, message.origin_heading = origin.x, origin.y, math.radians(origin.heading)
    message.cells = [bytes(row.astype("uint8")) for row in cell_map.cells]
    return message


def goal_message(types, map_id, cell_map, goal):
    place = map_stream.Place(*goal)
    cell_map.cell("--goal", place)
    corner = cell_map.from_corner(place)
    message = types.map_goal_t()
    message.utime, message.map_id = now(), map_id
    message.point.x, message.point.y = corner.x, corner.y
    message.has_heading, message.heading = len(goal) == 3, math.radians(corner.heading)
    return message


def now():
    return int(time.time() * 1e6)


# ---- the drive -----------------------------------------------------------------------------------------------------

class View:
    """What jp-lcm tells of the task; a line for each change."""

    def __init__(self, types):
        self._types, self._shown = types, None
        self.state, self.heard_at = None, time.monotonic()
        self._takers = {"JP_STATE": (types.state_t, self._state), "JP_NAVIGATION": (types.navigation_t, self._navigation)}

    def take(self, channel, data):
        if channel in self._takers:
            message_type, taker = self._takers[channel]
            with contextlib.suppress(ValueError, struct.error, IndexError):  # somebody else's
                taker(message_type.decode(data))

    def _state(self, state):
        self.state, self.heard_at = state, time.monotonic()

    def _navigation(self, told):
        state, reason = choice("State", told.state), choice("Reason", told.reason)
        if (state, reason, told.course) != self._shown:
            self._shown = state, reason, told.course
            left = f"; {told.distance:.1f} m, {told.energy:.0f} ± {told.deviation:.0f} J left" if told.leg_count else ""
            print(f"navigator: {state}" + (f" ({reason})" if reason != "None" else "") + left, flush=True)

    def is_busy(self):
        types = self._types.state_t
        return self.state is not None and self.state.task in (types.TASK_STANDING_UP, types.TASK_UPLOADING,
                                                              types.TASK_DRIVING)


def wait(link, url, condition, limit, missing):
    end = time.monotonic() + limit
    while not condition():
        link.handle_timeout(50)
        if time.monotonic() > end:
            raise ToolError(f"--lcm {url}: {missing}")


def follow(link, view, url, types):
    while view.is_busy():
        link.handle_timeout(100)
        if time.monotonic() - view.heard_at > QUIET_MAX:
            raise ToolError(f"--lcm {url}: no JP_STATE for {QUIET_MAX} s; is jp-lcm still there, and the robot?")
    if view.state.task != types.state_t.TASK_DONE:
        raise Verdict(f"not arrived: {view.state.task_reason or 'another task has replaced this one'}")
    print(f"arrived at {view.state.x:.2f}, {view.state.y:.2f} m, heading {math.degrees(view.state.heading):.0f}°, "
          "by odometry")


def drive(url, types, the_map, goal):
    view = View(types)
    link = open_lcm(url, view.take, "--lcm")
    wait(link, url, lambda: view.state is not None, QUIET_MAX,
         f"no JP_STATE for {QUIET_MAX} s; is jp-lcm on the robot's bus and this URL?")
    link.publish("JP_MAP", the_map.encode())
    link.publish("JP_MAP_GOAL", goal.encode())
    print(f"sent map {the_map.map_id}, {the_map.width} x {the_map.height} cells", flush=True)
    before = view.state
    wait(link, url, lambda: view.state is not before and view.is_busy(), QUIET_MAX,
         "jp-lcm has not taken the goal; what it says on stderr tells why")
    follow(link, view, url, types)


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--lcm", metavar="URL", default=DEFAULT_URL, help="where jp-lcm is (%(default)s)")
    parser.add_argument("--map", metavar="FILE", type=Path, required=True, help="of tools.design.import_map")
    parser.add_argument("--start", metavar="X,Y,DEG", type=parse_start, required=True,
                        help="where on the map the robot was switched on")
    parser.add_argument("--goal", metavar="X,Y[,DEG]", type=parse_goal, required=True, help="on the map")
    options = parser.parse_args()
    start = options.start
    for name, place in (("--start", (start.x, start.y, start.heading)), ("--goal", options.goal)):
        if not all(map(math.isfinite, place)):
            parser.error(f"argument {name}: {','.join(map(str, place))}: must be finite")
    types = load_types()
    cell_map = map_stream.read_cells(options.map)
    the_map = map_message(types, cell_map, start)
    goal = goal_message(types, the_map.map_id, cell_map, options.goal)
    with contextlib.suppress(KeyboardInterrupt):
        drive(options.lcm, types, the_map, goal)
    return 0


if __name__ == "__main__":
    run(main)
