"""Robots from their files, and the lattices of motions that they plan on."""

from pathlib import Path

from ._call import Error, check, encoded, text
from ._native import ffi, lib

_FOLDER = Path(__file__).parent / "sim" / "robots"


def robots():
    """The names of the robots that come with the package."""
    return sorted(path.stem for path in _FOLDER.glob("*.cfg"))


def robot_path(robot):
    """The file of a robot: of the name of one that comes with the package, or a path itself."""
    path = Path(robot)
    return _FOLDER / f"{robot}.cfg" if path.parent == Path() and path.suffix == "" else path


class Robot:
    """A balancer, or a robot that its sides steer: what a planner must know of it."""

    def __init__(self, robot):
        """By the name of one that comes with the package (robots()), or the path of a robot's file."""
        self.path = robot_path(robot)
        self._robot = ffi.new("struct lattice_robot *")
        check(lib.lattice_robot_load(encoded(self.path), self._robot))

    @property
    def name(self):
        return text(self._robot.name)

    @property
    def length_m(self):
        return self._robot.length_m

    @property
    def width_m(self):
        return self._robot.width_m

    @property
    def cell_m(self):
        """Side of a cell of its maps, m."""
        return self._robot.cell_m

    @property
    def speed_max(self):
        """m/s"""
        return self._robot.speed_max

    @property
    def turn_rate_max(self):
        """rad/s"""
        return self._robot.turn_rate_max

    @property
    def grade_max(self):
        """Steepest ground that it drives on, rise over run."""
        return self._robot.grade_max

    @property
    def electronics_w(self):
        return self._robot.electronics_power

    def motion_joules(self, speed, turn_rate, duration, rise=0.0):
        """J of a motion at constant speed, m/s, and turn rate, rad/s, that ends `rise` m higher."""
        return lib.lattice_robot_energy(self._robot, ffi.new("struct lattice_motion *", {
            "speed": speed, "turn_rate": turn_rate, "rise": rise, "duration": duration}))

    def cheapest_speed(self, curvature=0.0):
        """m/s at which a curve, rad/m, takes the least energy a metre."""
        return lib.lattice_robot_speed(self._robot, curvature)


class Lattice:
    """The motions of a robot that a planner joins to a route."""

    def __init__(self, robot):
        """As built in for a robot."""
        self._lattice = lib.plan_lattice_find(encoded(robot.name))
        if self._lattice == ffi.NULL:
            raise Error(f"{robot.name}: no lattice is built in for this robot; make one with tools.design.lattice --json "
                        "and give Lattice.load()")
        self.robot_name = robot.name

    @classmethod
    def for_navigation(cls, robot):
        """The one that a robot finds its own way by."""
        lattice = cls.__new__(cls)
        lattice._lattice = lib.plan_lattice_for_navigation(encoded(robot.name))
        if lattice._lattice == ffi.NULL or robot._robot.turning_radius_m == 0:
            raise Error(f"{robot.name}: no lattice for finding its way is built in; give a robot that has a section navigation")
        lattice.robot_name = robot.name
        return lattice

    @classmethod
    def load(cls, path):
        """Of a JSON file, as tools/design/lattice.py writes it."""
        lattice = cls.__new__(cls)
        file = ffi.new("struct lattice_file *")
        check(lib.lattice_file_load(encoded(path), file))
        lattice._file = ffi.gc(file, lib.lattice_file_free)
        lattice._lattice = ffi.addressof(lattice._file, "lattice")
        lattice.robot_name = text(file.name)
        return lattice

    @property
    def cell_m(self):
        """Side of the cells of its maps, m."""
        return self._lattice.resolution / lib.JP_Q16_ONE
