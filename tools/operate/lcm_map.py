#!/usr/bin/env python3
"""Make a picture of a drive on a map from a log of lcm-logger.

The log was begun before the map was sent. Writes DIR/map.png and DIR/map.json, as tools.operate.can_map does of a log of
the bus, of the last map: JP_MAP, what JP_CELLS told of it, the goals of JP_MAP_GOAL, and what the robot did. Time is that
of jp-lcm. Exit status 2: bad input; nothing was written.
"""
import math
import struct
import sys
from pathlib import Path

import numpy as np

from tools.common import ArgumentParser, ToolError, run
from tools.operate import can_map, map_stream
from tools.operate.can_messages import database
from tools.operate.lcm_report import US_PER_S, load_types, replay

MAP_ID_MAX, SIDE_MAX = 15, 4096


def choice(signal, value):
    """What a number of jp_navigation_t means, by the DBC."""
    choices = database().get_message_by_name("NavigationStatus").get_signal_by_name(signal).choices
    return str(choices.get(value, value))


def is_sound_map(message):
    """It is one that jp-lcm takes."""
    return (1 <= message.map_id <= MAP_ID_MAX and 1 <= message.width <= SIDE_MAX and 1 <= message.height <= SIDE_MAX and
            all(len(row) == message.width and max(row) <= map_stream.UNKNOWN for row in message.cells) and
            math.isfinite(message.resolution) and message.resolution > 0 and
            all(map(math.isfinite, (message.origin.x, message.origin.y, message.origin_heading))))


class Listener:
    """Takes what teams send and what jp-lcm tells, in the order in which they come."""

    def __init__(self):
        types = load_types()
        self.bad = 0  # messages that are not of their type, or not of the map
        self.found, self.drive = None, can_map.Drive()  # (CellMap, origin)
        self._map_id, self._content, self._t = 0, None, 0.0
        self._handlers = {"JP_MAP": (types.map_t, self._map), "JP_CELLS": (types.cells_t, self._cells),
                          "JP_MAP_GOAL": (types.map_goal_t, self._goal), "JP_STATE": (types.state_t, self._state),
                          "JP_ENERGY": (types.energy_t, self._energy),
                          "JP_NAVIGATION": (types.navigation_t, self._navigation)}

    def take(self, channel, data):
        if channel not in self._handlers:
            return
        message_type, handle = self._handlers[channel]
        try:
            message = message_type.decode(data)
        except (ValueError, struct.error, IndexError):
            self.bad += 1
            return
        handle(message)

    def _map(self, message):
        if not is_sound_map(message):
            self.bad += 1
            return
        message.utime = 0
        content = message.encode()
        if content == self._content:
            return
        cells = np.array([list(row) for row in message.cells])
        origin = map_stream.Place(message.origin.x, message.origin.y, math.degrees(message.origin_heading))
        self.found = map_stream.CellMap(cells, message.resolution, map_stream.Place(0, 0)), origin
        self._map_id, self._content, self.drive = message.map_id, content, can_map.Drive()

    def _is_of_the_map(self, message):
        if self.found is not None and message.map_id == self._map_id:
            return True
        self.bad += 1
        return False

    def _cells(self, message):
        if self._is_of_the_map(message):
            self.drive.changes += [(self._t, cell.x, cell.y, cell.cell) for cell in message.cells]

    def _goal(self, message):
        if self._is_of_the_map(message):
            heading = math.degrees(message.heading) if message.has_heading else None
            self.drive.goals.append((self._t, message.point.x, message.point.y, heading))

    def _state(self, state):
        self._t = state.utime / US_PER_S
        if self.found is not None:
            self.drive.way.append((self._t, *can_map.on_map(self.found[1], state.x, state.y)))

    def _energy(self, energy):
        self.drive.energy.append((energy.utime / US_PER_S, energy.spent))

    def _navigation(self, told):
        t = told.utime / US_PER_S
        state = choice("State", told.state), choice("Reason", told.reason)
        if not self.drive.states or self.drive.states[-1][1:] != state:
            self.drive.states.append((t, *state))
        self.drive.left.append((t, told.distance, told.duration, told.energy, told.deviation))
        if told.home_probability > 0:
            self.drive.home.append((t, told.home_probability, told.home_energy, told.home_deviation))
        for after, leg in enumerate(reversed(told.legs)):
            self.drive.courses.setdefault(told.course, {}).setdefault(after, (leg.x, leg.y))


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("log", metavar="LOG", type=Path, help="of lcm-logger")
    parser.add_argument("directory", metavar="DIR", type=Path, help="where the results go")
    options = parser.parse_args()
    listener = Listener()
    replay(listener.take, options.log)
    if listener.found is None:
        raise ToolError(f"{options.log}: no JP_MAP in it; begin the log before the map is sent")
    if listener.bad:
        print(f"{listener.bad} messages were not of their type or not of the map and are left out", file=sys.stderr)
    can_map.write(options.directory, *listener.found, listener.drive)
    return 0


if __name__ == "__main__":
    run(main)
