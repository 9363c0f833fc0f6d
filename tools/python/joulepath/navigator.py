"""Robots that find their way by themselves among what their map does not show: navigator.h."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy
from numpy.typing import NDArray

from ._call import Error, array_over, check, encoded, record, text
from ._native import ffi, lib
from .planner import _place
from .robot import Lattice, Robot
from .terrain import Terrain

STATES: tuple[str, ...] = tuple(text(lib.navigation_state_name(state)) for state in range(10))

_ROW = record("struct navigator_row", {
    "t_s": ("time",), "x_m": ("x",), "y_m": ("y",), "heading_rad": ("heading",), "energy_j": ("energy",),
    "left_m": ("left",), "state": ("state",), "replans": ("replans",)})


class Navigation:
    """What came of a drive: outcome ("arrived", "unreachable", …) and reason, joules, seconds, metres, how near it came to
    what is blocked; planned_joules of the first route, forecast_joules of the first course with forecast_deviation; rows, 20
    a second, in m from the map's south-west corner: t_s, x_m, y_m, heading_rad, energy_j, left_m, state, replans."""

    rows: NDArray[numpy.void]
    outcome: str
    reason: str
    joules: float
    seconds: float
    metres: float
    planned_joules: float
    forecast_joules: float
    forecast_deviation: float
    replans: int
    cells_seen: int
    touched: bool
    clearance_m: float
    goal_error_m: float

    def __init__(self, result: Any, rows: Any) -> None:
        """Of navigate()."""
        self.rows = array_over(ffi.cast("struct navigator_row *", rows.first), rows.count, _ROW, rows)
        self.outcome = text(lib.navigation_state_name(result.state))
        self.reason = text(lib.navigation_reason_name(result.reason))
        self.joules, self.seconds, self.metres = result.joules, result.seconds, result.length_m
        self.planned_joules = result.planned_joules
        self.forecast_joules, self.forecast_deviation = result.forecast_joules, result.deviation_joules
        self.replans, self.cells_seen = result.replans, result.seen
        self.touched, self.clearance_m = result.is_touched, result.clearance_m
        self.goal_error_m = result.goal_error_m

    def __repr__(self) -> str:
        return f"<Navigation {self.outcome}: {self.joules:.1f} J, {self.seconds:.1f} s, {self.metres:.2f} m>"


def navigate(terrain: Terrain, robot: Robot, start: Sequence[float] | None = None, goal: Sequence[float] | None = None,
             hidden: int = 6, view_m: float = 2.5, memory: int = 1 << 20, seed: int = 1) -> Navigation:
    """Lets a robot drive to a goal over a map, in the simulator, among `hidden` boxes that the map does not show.

    start: x, y in m of the map's frame and a heading in degrees; goal: the same, or without a heading; without both, two
    places far apart. view_m: how far it sees; memory: of its planner, bytes. The terrain is then what the robot knows.
    """
    lattice = Lattice.for_navigation(robot)
    check(lib.plan_lattice_fits(encoded(terrain.name or "map"), terrain._map, lattice._lattice))
    drive = ffi.new("struct navigator_drive *", {
        "map": terrain._map, "robot": robot._robot, "lattice": lattice._lattice, "hidden": hidden, "view_m": view_m,
        "memory": memory, "seed": seed})
    if (start is None) != (goal is None):
        raise Error("start, goal: give both or neither")
    places = ffi.addressof(drive, "places")
    if start is None or goal is None:
        check(lib.plan_task_choose(terrain._map, lattice._lattice, places))
    else:
        check(lib.plan_task_set(terrain._map, lattice._lattice, _place("start", start, (3,)),
                                _place("goal", goal, (2, 3)), places))
    rows, result = ffi.gc(ffi.new("struct rows *"), lib.rows_free), ffi.new("struct navigation_result *")
    check(lib.drive_navigator(rows, result, drive))
    return Navigation(result, rows)
