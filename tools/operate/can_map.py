#!/usr/bin/env python3
"""Make a picture of a drive on a map from a log of the CAN bus.

LOG is one of candump (-l, -L), .asc or .blf, begun before the map was sent. Writes DIR/map.png: the map as it was sent,
the cells that changed, the courses, the way by odometry, and over time the energy and what was left of the way; and
DIR/map.json, the same in numbers, m from the map's south-west corner. Where the log was taken in lockstep, time is that
of the simulation. Exit status 2: bad input; nothing was written.
"""
import json
import math
import zlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from matplotlib.colors import to_rgba
from matplotlib.patches import Patch

from tools.common import ArgumentParser, ToolError, run, shown_path, write_whole
from tools.operate import map_stream
from tools.operate.can_messages import Codec, SimClock, message_of
from tools.operate.can_report import read_frames
from tools.report import ground, plots

PICTURE_NAME, NUMBERS_NAME = "map.png", "map.json"
MAP_DATA, INDEX_MASK = 5, 0xFFF
CHANGES, UNCHANGED = 12, 3
LETTERS = np.array([ground.FREE, ground.OCCUPIED, ground.UNKNOWN])

WAY = {"color": plots.BLUE, "linewidth": 2.6, "zorder": 4, "path_effects": ground.OUTLINE}
COURSE = {"color": plots.PURPLE, "linewidth": 1.2, "linestyle": (0, (3, 2)), "zorder": 5}
CHANGED = "#E8331C"
GOAL = {"color": plots.PURPLE, "marker": "*", "markersize": 11, "linestyle": "none", "zorder": 6,
        "path_effects": ground.OUTLINE}


class MapReceiver:
    """The map as the ECU takes it: each MapData in its turn."""

    def __init__(self):
        self._offer, self._stream = None, b""
        self.found = None  # (CellMap, origin)

    def offer(self, signals):
        offer = {name: signals[name] for name in ("MapId", "Bytes", "MapCrc")}
        if offer != self._offer:
            self._offer, self._stream = offer, b""

    def data(self, signals):
        """True when the map has just become whole."""
        if (self._offer is None or len(self._stream) >= self._offer["Bytes"] or
                signals["Index"] != len(self._stream) // MAP_DATA & INDEX_MASK):
            return False
        self._stream = (self._stream + signals["Data"].to_bytes(MAP_DATA, "little"))[:self._offer["Bytes"]]
        if len(self._stream) < self._offer["Bytes"] or zlib.crc32(self._stream) != self._offer["MapCrc"]:
            return False
        self.found = map_stream.decode(self._stream)
        return self.found is not None


def on_map(origin, x, y):
    """A place of the odometry on the map."""
    angle = math.radians(origin.heading)
    return (origin.x + x * math.cos(angle) - y * math.sin(angle),
            origin.y + x * math.sin(angle) + y * math.cos(angle))


@dataclass
class Drive:
    """On the last map that became whole; times in s, lengths in m from its south-west corner."""
    way: list = field(default_factory=list)      # (t, x, y)
    energy: list = field(default_factory=list)   # (t, J)
    left: list = field(default_factory=list)     # (t, m, s, J, J)
    home: list = field(default_factory=list)     # (t, probability, J, J) of the way home, where it is known
    changes: list = field(default_factory=list)  # (t, x, y, state)
    states: list = field(default_factory=list)   # (t, state, reason)
    courses: dict = field(default_factory=dict)  # number: {legs after: (x, y)}
    goals: list = field(default_factory=list)    # (t, x, y, heading in degrees or None), as far as the log tells them


class Converter:
    """Frames to a map and what was driven on it."""

    def __init__(self):
        self.maps, self.drive = MapReceiver(), Drive()
        self._codec, self._clock = Codec(), SimClock()
        self._takers = {"SimTime": self._sim_time, "MapOffer": self._offer, "MapData": self._data,
                        "CellChanges": self._changes, "Pose": self._pose, "EnergySpent": self._energy,
                        "NavigationStatus": self._status, "NavigationProgress": self._progress,
                        "HomeStatus": self._home,
                        "CourseLeg": self._leg}

    def take(self, frame):
        message = message_of(frame)
        if message is None or message.name not in self._takers:
            return
        decoded = self._codec.decode(frame)
        if decoded is not None:
            seconds = frame.timestamp if self._clock.seconds is None else self._clock.seconds
            self._takers[message.name](seconds, decoded[1])

    def _sim_time(self, _, signals):
        self._clock.take(signals)

    def _offer(self, _, signals):
        self.maps.offer(signals)

    def _data(self, _, signals):
        if self.maps.data(signals):
            self.drive = Drive()

    def _changes(self, t, signals):
        for i in range(CHANGES):
            state = signals["Cells"] >> 2 * i & UNCHANGED
            if state != UNCHANGED:
                self.drive.changes.append((t, signals["Column"] + i, signals["Row"], state))

    def _pose(self, t, signals):
        if self.maps.found is not None:
            self.drive.way.append((t, *on_map(self.maps.found[1], signals["X"], signals["Y"])))

    def _energy(self, t, signals):
        self.drive.energy.append((t, signals["Energy"]))

    def _status(self, t, signals):
        told = (str(signals["State"]), str(signals["Reason"]))
        if not self.drive.states or self.drive.states[-1][1:] != told:
            self.drive.states.append((t, *told))

    def _home(self, t, signals):
        if signals["Probability"] > 0:
            self.drive.home.append((t, *(signals[name] for name in ("Probability", "Way", "WayDeviation"))))

    def _progress(self, t, signals):
        self.drive.left.append((t, *(signals[name] for name in ("Distance", "Duration", "Energy", "Deviation"))))

    def _leg(self, _, signals):
        course = self.drive.courses.setdefault(signals["Course"], {})
        course.setdefault(signals["After"], (signals["X"], signals["Y"]))


def convert(path):
    """(map, origin, drive) of the last map in the log."""
    converter = Converter()
    for frame in read_frames(path):
        converter.take(frame)
    if converter.maps.found is None:
        raise ToolError(f"{path}: no whole map in it; begin the log before the map is sent")
    return (*converter.maps.found, converter.drive)


def courses_of(drive):
    """Points of each course, from its first leg's end on."""
    return [[course[after] for after in sorted(course, reverse=True)] for _, course in sorted(drive.courses.items())]


def draw_changes(axes, shape, size, changes):
    image = np.zeros((*shape, 4))
    for _, x, y, state in changes:
        if 0 <= x < shape[1] and 0 <= y < shape[0]:
            image[y, x] = to_rgba(CHANGED) if state == map_stream.OCCUPIED else (1, 1, 1, 0.8)
    axes.imshow(image, origin="lower", extent=(0, size[0], 0, size[1]), interpolation="nearest", zorder=2)


def draw(cell_map, drive):
    shown = ground.Map(LETTERS[cell_map.cells], None, cell_map.resolution, (0.0, 0.0, 0.0))
    figure, (picture, over_time) = plots.new_figure(ground.WIDTH, ground.map_height(shown) + 3.0, rows=2,
                                                   height_ratios=[ground.map_height(shown), 2.4])
    ground.draw_ground(picture, shown)
    draw_changes(picture, shown.cells.shape, shown.size, drive.changes)
    way = np.array(drive.way).reshape(-1, 3)
    handles = [(picture.plot(way[:, 1], way[:, 2], **WAY)[0], "way, by odometry")]
    for points in courses_of(drive):
        line = picture.plot(*np.array(points).T, marker=".", **COURSE)[0]
    if drive.courses:
        handles.append((line, f"courses: {len(drive.courses)}"))
    if drive.goals:
        handles.append((picture.plot(*np.array([goal[1:3] for goal in drive.goals]).T, **GOAL)[0], "goals"))
    if drive.changes:
        handles.append((Patch(facecolor=CHANGED), "occupied since"))
    ground.finish_map(figure, picture, shown, handles + ground.legend_entries(shown))
    energy, left = np.array(drive.energy).reshape(-1, 2), np.array(drive.left).reshape(-1, 5)
    over_time.plot(energy[:, 0], energy[:, 1] - energy[:1, 1], color=plots.BLUE, label="energy, J")
    over_time.plot(left[:, 0], left[:, 3], color=plots.PURPLE, label="energy left on the course, J")
    over_time.set_xlabel("time, s")
    over_time.legend(loc="upper left", ncols=2)
    return figure


def numbers(cell_map, origin, drive):
    height, width = cell_map.cells.shape
    return {"width": width, "height": height, "resolution_m": cell_map.resolution,
            "origin": [origin.x, origin.y, origin.heading], "way": drive.way, "left": drive.left, "home": drive.home,
            "changes": drive.changes, "states": drive.states, "courses": courses_of(drive),
            "goals": drive.goals}


def write(directory, cell_map, origin, drive):
    write_whole(directory / PICTURE_NAME, plots.png_bytes(draw(cell_map, drive)))
    write_whole(directory / NUMBERS_NAME, json.dumps(numbers(cell_map, origin, drive)) + "\n")
    for name in (PICTURE_NAME, NUMBERS_NAME):
        print(f"wrote {shown_path(directory / name)}")


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("log", metavar="LOG", type=Path, help="of candump, or .asc or .blf")
    parser.add_argument("directory", metavar="DIR", type=Path, help="where the results go")
    options = parser.parse_args()
    write(options.directory, *convert(options.log))
    return 0


if __name__ == "__main__":
    run(main)
