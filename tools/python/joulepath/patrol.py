"""Drives of the patrol robot through scenes, among what its map does not show."""

from __future__ import annotations

from os import PathLike
from typing import Any

import numpy
from numpy.typing import NDArray

from ._call import array_over, check, encoded, record, text
from ._native import ffi, lib
from .robot import robot_path

SCENES: tuple[str, ...] = tuple(text(lib.patrol_scene_names[i]) for i in range(lib.PATROL_SCENES))
METHODS: tuple[str, ...] = tuple(text(lib.patrol_method_names[i]) for i in range(lib.PATROL_METHODS))

_ROW = record("struct patrol_row", {
    "t_s": ("time",), "x_m": ("x",), "y_m": ("y",), "heading_rad": ("heading",), "believed_x_m": ("believed_x",),
    "believed_y_m": ("believed_y",), "believed_heading_rad": ("believed_heading",), "speed_m_s": ("speed",),
    "turn_rate_rad_s": ("turn_rate",), "clearance_m": ("clearance",), "energy_j": ("energy",), "state": ("state",)})


class Patrol:
    """What came of a drive: outcome, seconds, metres, joules, clearance_m at least, how far from the goal; rows, one a
    cycle of 0.1 s."""

    rows: NDArray[numpy.void]
    outcome: str
    seconds: float
    metres: float
    joules: float
    reversed_m: float
    clearance_m: float
    position_error_m: float
    heading_error_rad: float

    def __init__(self, result: Any, rows: Any) -> None:
        """Of patrol()."""
        self.rows = array_over(ffi.cast("struct patrol_row *", rows.first), rows.count, _ROW, rows)
        self.outcome = text(lib.patrol_outcome_names[result.outcome])
        self.seconds = result.time
        self.metres = result.length
        self.joules = result.energy_j
        self.reversed_m = result.reversed
        self.clearance_m = result.clearance_min
        self.position_error_m = result.position_error
        self.heading_error_rad = result.heading_error

    def __repr__(self) -> str:
        return f"<Patrol {self.outcome}: {self.joules:.1f} J, {self.seconds:.1f} s, {self.metres:.2f} m>"


def patrol(scene: str, seed: int = 0, method: str = METHODS[0], robot: str | PathLike[str] = "patrol") -> Patrol:
    """Drives through one of SCENES by one of METHODS; a seed gives the same scene and noise every time."""
    for what, value, values in (("scene", scene, SCENES), ("method", method, METHODS)):
        if value not in values:
            raise ValueError(f"{what}: {value!r} is none of {', '.join(values)}")
    file = ffi.new("struct four_wheel_file *")
    check(lib.four_wheel_file_load(encoded(robot_path(robot)), file))
    rows = ffi.gc(ffi.new("struct rows *"), lib.rows_free)
    result = ffi.new("struct patrol_result *")
    check(lib.drive_patrol(rows, result, file, SCENES.index(scene), METHODS.index(method), seed))
    return Patrol(result, rows)
