"""Missions of balancers and of robots that their sides steer, driven in the simulator."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import libconf
import numpy
from numpy.typing import NDArray

from ._call import array_over, check, encoded, record, text
from ._native import ffi, lib
from .robot import robot_path

_FOLDER = Path(__file__).parent / "sim" / "scenarios"

STRATEGIES: dict[str, int] = {"segments": lib.MISSION_OPTIMAL, "cruise": lib.MISSION_CRUISE,
              "optimised cruise": lib.MISSION_OPTIMISED_CRUISE, "bezier": lib.MISSION_BEZIER,
              "bezier route": lib.MISSION_BEZIER_ROUTE, "rounded": lib.MISSION_ROUNDED,
              "turn and go": lib.MISSION_TURN_AND_GO}

_ROW = record("struct mission_row", {
    "t_s": ("time",), "x_m": ("position", "x"), "y_m": ("position", "y"), "ref_x_m": ("reference", "x"),
    "ref_y_m": ("reference", "y"), "heading_rad": ("heading",), "speed_m_s": ("speed",),
    "turn_rate_rad_s": ("turn_rate",), "ref_speed_m_s": ("reference_speed",),
    "ref_turn_rate_rad_s": ("reference_turn_rate",), "pitch_deg": ("pitch_deg",), "u_left_v": ("voltage_left",),
    "u_right_v": ("voltage_right",), "i_left_a": ("current_left",), "i_right_a": ("current_right",),
    "energy_j": ("energy",), "leg": ("leg",)})

_LEG = record("struct mission_leg", {
    "x_m": ("target", "x"), "y_m": ("target", "y"), "seconds": ("duration",), "planned_joules": ("planned_energy",),
    "metered_joules": ("measured_energy",), "plant_joules": ("plant_energy",), "passed_m": ("passed",),
    "end_error_m": ("end_error",)})


class Scenario:
    """A robot and the waypoints that it drives through: a libconfig file, or made here."""

    def __init__(self, path: str | PathLike[str]) -> None:
        """By the path of a file, or the name of one that comes with the package."""
        path = Path(path)
        if path.parent == Path() and path.suffix == "":
            path = _FOLDER / f"{path}.cfg"
        self._scenario = ffi.new("struct scenario *")
        check(lib.scenario_load(encoded(path), self._scenario))

    @classmethod
    def of(cls, robot: str | PathLike[str], waypoints: Iterable[Iterable[float]], name: str = "mission",
           energy: Literal["motor", "battery"] | None = None, end: Literal["stand", "pass"] = "stand", seed: int = 0,
           **more: Any) -> Scenario:
        """A robot by name or path, and its waypoints: (x, y) in m, from (0, 0) on; more: keys of a scenario's file."""
        keys = {"name": name, "robot": str(Path(robot_path(robot)).resolve()), "energy_model": "identified",
                "end": end, "seed": seed, **({} if energy is None else {"energy": energy}), **more,
                "waypoints": tuple([float(value) for value in point] for point in waypoints)}
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"{name}.cfg"
            path.write_text(libconf.dumps(keys))
            return cls(path)

    @property
    def name(self) -> str:
        """Of the scenario."""
        return text(self._scenario.name)

    @property
    def robot_name(self) -> str:
        """Of the robot that drives it."""
        return text(lib.scenario_robot(self._scenario).name)

    @property
    def is_of_balancer(self) -> bool:
        """Whether that is a balancer; otherwise its sides steer it."""
        return bool(self._scenario.kind == lib.SCENARIO_BALANCER)


class Mission:
    """What a drive planned and spent.

    rows              50 a second: t_s, x_m, y_m, heading_rad, …, energy_j: each name ends with its unit
    legs              a row a leg: planned, metered by the robot and spent by the plant, J; how near it passed its target
    joules            of the plant's ledger, of the scenario's kind of energy
    metered_joules    the same by the robot's meter
    forecast_joules   what its pilot said beforehand, with forecast_deviation, J; None: no pilot drove
    seconds           from its start to its end
    passed_m          how near it passed its targets, at worst
    ticks             of the controller
    """

    rows: NDArray[numpy.void]
    legs: NDArray[numpy.void]
    joules: float
    metered_joules: float
    seconds: float
    forecast_joules: float | None
    forecast_deviation: float | None
    passed_m: float
    ticks: int

    def __init__(self, mission: Any, rows: Any) -> None:
        """Of drive()."""
        self.rows = array_over(ffi.cast("struct mission_row *", rows.first), rows.count, _ROW, rows)
        self.legs = array_over(ffi.addressof(mission.legs, 0), mission.leg_count, _LEG, mission)
        self.joules = mission.total.plant_energy
        self.metered_joules = mission.total.measured_energy
        self.seconds = mission.total.duration
        known = mission.forecast.known
        self.forecast_joules = mission.forecast.energy if known else None
        self.forecast_deviation = mission.forecast.deviation if known else None
        self.passed_m = mission.total.passed
        self.ticks = mission.ticks

    @property
    def xy_m(self) -> NDArray[numpy.float64]:
        """Where the robot was: a row of x and y, m, for each of rows."""
        return numpy.column_stack([self.rows["x_m"], self.rows["y_m"]])

    def __repr__(self) -> str:
        return f"<Mission: {self.joules:.2f} J, {self.seconds:.1f} s, {len(self.legs)} legs>"


def drive(scenario: Scenario, strategy: str | None = None) -> Mission:
    """Drives a scenario in closed loop, by one of STRATEGIES; without one, as the robot drives by itself."""
    if strategy is None:
        strategy = "cruise" if scenario.is_of_balancer else "rounded"
    if strategy not in STRATEGIES:
        raise ValueError(f"strategy: {strategy!r} is none of {', '.join(STRATEGIES)}")
    rows = ffi.gc(ffi.new("struct rows *"), lib.rows_free)
    mission = ffi.new("struct mission *")
    check(lib.drive_mission(rows, mission, STRATEGIES[strategy], scenario._scenario))
    return Mission(mission, rows)
