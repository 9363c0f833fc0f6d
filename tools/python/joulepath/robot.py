"""Robots from their files, and the lattices of motions that they plan on."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

from ._call import Error, check, encoded, text
from ._native import ffi, lib

_FOLDER = Path(__file__).parent / "sim" / "robots"


def robots() -> list[str]:
    """The names of the robots that come with the package."""
    return sorted(path.stem for path in _FOLDER.glob("*.cfg"))


def robot_path(robot: str | PathLike[str]) -> Path:
    """The file of a robot: of the name of one that comes with the package, or a path itself."""
    path = Path(robot)
    return _FOLDER / f"{robot}.cfg" if path.parent == Path() and path.suffix == "" else path


class Robot:
    """A balancer, or a robot that its sides steer: what a planner must know of it."""

    def __init__(self, robot: str | PathLike[str]) -> None:
        """By the name of one that comes with the package (robots()), or the path of a robot's file."""
        self.path = robot_path(robot)
        self._robot = ffi.new("struct lattice_robot *")
        check(lib.lattice_robot_load(encoded(self.path), self._robot))

    @property
    def name(self) -> str:
        """Of the robot, as in its file."""
        return text(self._robot.name)

    @property
    def length_m(self) -> float:
        """Of the robot's outline, m."""
        return float(self._robot.length_m)

    @property
    def width_m(self) -> float:
        """Of the robot's outline, m."""
        return float(self._robot.width_m)

    @property
    def cell_m(self) -> float:
        """Side of a cell of its maps, m."""
        return float(self._robot.cell_m)

    @property
    def speed_max(self) -> float:
        """The highest speed that it plans, m/s."""
        return float(self._robot.speed_max)

    @property
    def turn_rate_max(self) -> float:
        """The highest turn rate that it plans, rad/s."""
        return float(self._robot.turn_rate_max)

    @property
    def grade_max(self) -> float:
        """Steepest ground that it drives on, rise over run."""
        return float(self._robot.grade_max)

    @property
    def electronics_w(self) -> float:
        """What its electronics draw all the time, W."""
        return float(self._robot.electronics_power)

    def motion_joules(self, speed: float, turn_rate: float, duration: float, rise: float = 0.0) -> float:
        """J of a motion at constant speed, m/s, and turn rate, rad/s, for `duration` s, that ends `rise` m higher."""
        return float(lib.lattice_robot_energy(self._robot, ffi.new("struct lattice_motion *", {
            "speed": speed, "turn_rate": turn_rate, "rise": rise, "duration": duration})))

    def cheapest_speed(self, curvature: float = 0.0) -> float:
        """m/s at which a curve, rad/m, takes the least energy a metre."""
        return float(lib.lattice_robot_speed(self._robot, curvature))


class Lattice:
    """The motions of a robot that a planner joins to a route."""

    _lattice: Any
    _file: Any  # that it was loaded from
    robot_name: str  # whose motions they are

    def __init__(self, robot: Robot) -> None:
        """As built in for a robot."""
        self._lattice = lib.plan_lattice_find(encoded(robot.name))
        if self._lattice == ffi.NULL:
            raise Error(f"{robot.name}: no lattice is built in for this robot; make one with tools.design.lattice --json "
                        "and give Lattice.load()")
        self.robot_name = robot.name

    @classmethod
    def for_navigation(cls, robot: Robot) -> Lattice:
        """The one that a robot finds its own way by."""
        lattice = cls.__new__(cls)
        lattice._lattice = lib.plan_lattice_for_navigation(encoded(robot.name))
        if lattice._lattice == ffi.NULL or robot._robot.turning_radius_m == 0:
            raise Error(f"{robot.name}: no lattice for finding its way is built in; give a robot that has a section navigation")
        lattice.robot_name = robot.name
        return lattice

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Lattice:
        """Of a JSON file, as tools/design/lattice.py writes it."""
        lattice = cls.__new__(cls)
        file = ffi.new("struct lattice_file *")
        check(lib.lattice_file_load(encoded(path), file))
        lattice._file = ffi.gc(file, lib.lattice_file_free)
        lattice._lattice = ffi.addressof(lattice._file, "lattice")
        lattice.robot_name = text(file.name)
        return lattice

    @property
    def cell_m(self) -> float:
        """Side of the cells of its maps, m."""
        return float(self._lattice.resolution / lib.JP_Q16_ONE)
