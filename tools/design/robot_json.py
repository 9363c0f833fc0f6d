"""A robot file (sim/robots/*.cfg), read through jp-robot, which checks it."""
import copy
import json
import math
import re
import subprocess
import sys
from pathlib import Path

from tools.common import ROOT, ToolError, build_directory, read_text
from tools.design import specification

# The keys that the tools use, of robots that have them; jp-robot knows all of them and their ranges.
GROUPS = ("body", "wheel", "motor", "ground", "electronics", "supply", "encoder", "gyro", "accelerometer",
          "current_sense", "control", "limits")


def default_jp_robot():
    return build_directory() / "bin" / "jp-robot"


def robot_path(robot):
    """The file of a robot given by path or by name."""
    path = Path(robot)
    return path if path.suffix == ".cfg" else ROOT / "sim" / "robots" / f"{robot}.cfg"


BALANCER, SKID_STEER, DIFFERENTIAL_DRIVE = TYPES = "balancer", "skid_steer", "differential_drive"
FOUR_WHEEL = "four_wheel"  # whose groups are others


class Robot:
    """Numbers by "group.key"; complaints name the file and the key."""

    def __init__(self, source, data):
        self.source = source
        self._data = data
        self.name = self._checked_name()
        self.type = data.get("type", BALANCER)
        for group in GROUPS if self.type in TYPES else ():
            if not isinstance(data.get(group), dict):
                raise self.error(group, "the group is missing")

    def _checked_name(self):
        name = self._data.get("name")
        if not isinstance(name, str) or not re.fullmatch(r"[a-z][a-z0-9_]{0,30}", name):
            raise self.error("name", "must be a C identifier of small letters, digits and _")
        return name

    def error(self, key, reason):
        return ToolError(f"{self.source}: {key}: {reason}")

    def number(self, key):
        group, name = key.split(".")
        return self._finite(key, self._data[group].get(name))

    def is_given(self, key):
        """Whether the file gives it; what it may leave out tools/design/specification.py finds."""
        group, name = key.split(".")
        return self._data.get(group, {}).get(name) is not None

    def given(self, key, otherwise):
        return self.number(key) if self.is_given(key) else otherwise

    def numbers(self, key, count):
        group, name = key.split(".")
        values = self._data[group].get(name)
        if not isinstance(values, list) or len(values) != count:
            raise self.error(key, f"must be a list of {count} numbers")
        return [self._finite(f"{key}[{i}]", value) for i, value in enumerate(values)]

    def positive(self, key):
        value = self.number(key)
        if value <= 0:
            raise self.error(key, f"is {value:g}, must be above 0")
        return value

    def varied(self, changes):
        """The same robot with other numbers by key."""
        data = copy.deepcopy(self._data)
        for key, value in changes.items():
            group, name = key.split(".")
            data[group][name] = value
        return Robot(self.source, data)

    def _finite(self, key, value):
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self.error(key, "missing, or not a number")
        if not math.isfinite(value):
            raise self.error(key, "not finite")
        return float(value)


def from_text(source, text):
    try:
        data = json.loads(text)
    except ValueError as error:
        raise ToolError(f"{source}: no JSON: {error}") from None
    if not isinstance(data, dict):
        raise ToolError(f"{source}: a robot is a JSON object")
    return Robot(source, data)


def balancer(robot):
    """With every setting of its controller; a robot of another type is refused."""
    if robot.type != BALANCER:
        raise ToolError(f"{robot.source}: type: {robot.type} robot; needs a {BALANCER}; give the file of one")
    return specification.completed(robot)


def skid_steer(robot):
    """A robot that its sides steer by their speeds; another one is refused."""
    if robot.type not in (SKID_STEER, DIFFERENTIAL_DRIVE):
        raise ToolError(f"{robot.source}: type: {robot.type} robot; needs a {SKID_STEER} or a {DIFFERENTIAL_DRIVE}; "
                        "give the file of one")
    return robot


def from_file(path):
    """A robot that jp-robot has printed; - is standard input."""
    return from_text("standard input", sys.stdin.read()) if path == "-" else from_text(path, read_text(path))


def load_json(path):
    """A balancer that jp-robot has printed; - is standard input."""
    return balancer(from_file(path))


def load_skid_steer_json(path):
    """The same of a robot that its sides steer by their speeds."""
    return skid_steer(from_file(path))


def printed_by(program, path, *options):
    """What a program prints about a robot file, which it checks."""
    try:
        result = subprocess.run([program, path, *options], capture_output=True, text=True, check=False)
    except OSError as error:
        raise ToolError(f"{program}: {error.strerror}; build it with `make`") from None
    if result.returncode != 0:
        lines = result.stderr.strip().splitlines() or [f"{program} failed on {path}"]
        raise ToolError(lines[-1])
    return result.stdout


def check_name(path, name):
    """The tables bear the robot's name: those of another robot must not be overwritten by a copy of its file."""
    if name != Path(path).stem:
        raise ToolError(f"{path}: name: is {name!r}, but the file is {Path(path).stem!r}; give both the same name")


def load_any(path, jp_robot=None):
    """The file of a robot of any type, checked by jp-robot."""
    robot = from_text(str(path), printed_by(jp_robot or default_jp_robot(), path, "--json=-"))
    check_name(path, robot.name)
    return robot


def load(path, jp_robot=None):
    """The file of a balancer, with every setting of its controller."""
    return balancer(load_any(path, jp_robot))


def load_skid_steer(path, jp_robot=None):
    """The file of a robot that its sides steer by their speeds."""
    return skid_steer(load_any(path, jp_robot))


def load_four_wheel(path, jp_robot=None):
    """The file of a robot with four steered wheels."""
    robot = load_any(path, jp_robot)
    if robot.type != FOUR_WHEEL:
        raise ToolError(f"{robot.source}: type: {robot.type} robot; needs a {FOUR_WHEEL}; give the file of one")
    return robot
