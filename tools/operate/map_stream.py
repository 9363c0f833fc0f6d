"""A map as the stream of bytes that MapData carries: hal/can/joulepath.dbc says how.

Cells are rows of 0 free, 1 occupied, 2 unknown, the southern row first.
"""
import math
import struct
from dataclasses import dataclass

import numpy as np

from tools.common import ToolError
from tools.report.ground import read_map

HEAD = struct.Struct("<HHiiiIB")
ROW_OF_CELLS, ROW_OF_RUNS = 128, 129
RUN_MAX, ROWS_MAX = 64, 128
FREE, OCCUPIED, UNKNOWN = range(3)
LETTERS = {".": FREE, "#": OCCUPIED, "?": UNKNOWN}
STREAM_MAX = 65535
Q16 = 65536
TURN = 1 << 32


@dataclass(frozen=True)
class Place:
    """x and y in m, heading in degrees."""
    x: float
    y: float
    heading: float = 0.0


@dataclass(frozen=True)
class CellMap:
    """A map that a robot can be given; `frame` is where its south-west corner is in the map's own frame."""
    cells: np.ndarray
    resolution: float
    frame: Place

    def from_corner(self, place):
        """A place of the map's frame, from its south-west corner."""
        angle = math.radians(self.frame.heading)
        dx, dy = place.x - self.frame.x, place.y - self.frame.y
        return Place(dx * math.cos(angle) + dy * math.sin(angle), dy * math.cos(angle) - dx * math.sin(angle),
                     place.heading - self.frame.heading)

    def cell(self, name, place):
        """(x, y) of the cell of a place of the map's frame; ToolError: it is outside the map."""
        corner = self.from_corner(place)
        x, y = (math.floor(value / self.resolution) for value in (corner.x, corner.y))
        height, width = self.cells.shape
        if not (0 <= x < width and 0 <= y < height):
            raise ToolError(f"{name} {place.x:g},{place.y:g}: is outside the map")
        return x, y


def read_cells(path):
    """A map of tools.design.import_map."""
    ground = read_map(path)
    cells = np.full(ground.cells.shape, UNKNOWN)
    for letter, state in LETTERS.items():
        cells[ground.cells == letter] = state
    x, y, yaw = ground.origin
    return CellMap(cells, ground.resolution, Place(x, y, math.degrees(yaw)))


def run_bytes(row):
    """Runs of equal cells, at most RUN_MAX long."""
    ends = [*np.flatnonzero(np.diff(row)) + 1, len(row)]
    out, begin = [], 0
    for end in ends:
        while begin < end:
            length = min(RUN_MAX, end - begin)
            out.append(int(row[begin]) * RUN_MAX + length - 1)
            begin += length
    return bytes([ROW_OF_RUNS, *out])


def cell_bytes(row):
    padded = np.concatenate([row, np.zeros(-len(row) % 4, dtype=int)]).reshape(-1, 4)
    return bytes([ROW_OF_CELLS, *(int(four @ (1, 4, 16, 64)) for four in padded)])


def encode(cell_map, origin):
    """The stream; `origin` is where the robot was switched on, from the map's south-west corner."""
    height, width = cell_map.cells.shape
    out = bytearray(HEAD.pack(width, height, round(cell_map.resolution * Q16), round(origin.x * Q16),
                              round(origin.y * Q16), round(origin.heading / 360 * TURN) % TURN, 0))
    before, repeated = np.full(width, UNKNOWN), 0
    for row in cell_map.cells:
        if (row == before).all() and repeated < ROWS_MAX:
            repeated += 1
        else:
            out += bytes([repeated - 1]) if repeated else b""
            repeated = int((row == before).all())
            out += b"" if repeated else min(run_bytes(row), cell_bytes(row), key=len)
        before = row
    out += bytes([repeated - 1]) if repeated else b""
    if len(out) > STREAM_MAX:
        raise ToolError(f"the map takes {len(out)} bytes, at most {STREAM_MAX} go over the bus; import a smaller window")
    return bytes(out)


def decode(stream):
    """(CellMap, origin) of a whole stream; None: it is none."""
    try:
        width, height, resolution, x, y, heading, _ = HEAD.unpack_from(stream)
        cells = _rows(stream[HEAD.size:], width, height)
    except (struct.error, IndexError, ValueError):
        return None
    return (CellMap(cells, resolution / Q16, Place(0, 0)), Place(x / Q16, y / Q16, heading / TURN * 360))


def _rows(stream, width, height):
    cells, y, place = np.full((height, width), UNKNOWN), 0, 0
    while y < height:
        kind, place = stream[place], place + 1
        if kind < ROW_OF_CELLS:
            if y + kind + 1 > height:
                raise ValueError("more rows than the map has")
            cells[y:y + kind + 1] = cells[y - 1] if y else UNKNOWN
            y += kind + 1
            continue
        row, place = (_cells if kind == ROW_OF_CELLS else _runs)(stream, place, width)
        cells[y] = row
        y += 1
    if place != len(stream):
        raise ValueError("more than the map")
    return cells


def _cells(stream, place, width):
    end = place + -(-width // 4)
    row = [stream[place + i // 4] >> 2 * (i % 4) & 3 for i in range(width)]
    return row, end


def _runs(stream, place, width):
    row = []
    while len(row) < width:
        row += [stream[place] // RUN_MAX] * (stream[place] % RUN_MAX + 1)
        place += 1
    return row, place
