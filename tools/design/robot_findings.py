"""What the designs of all kinds of robots share: where a robot is made, the steps, and what was found."""
import time
from dataclasses import dataclass, field
from pathlib import Path

from tools.common import ToolError


@dataclass(frozen=True)
class Finding:
    """What was measured, and what it must be."""
    name: str
    value: float
    unit: str
    bar: str       # as people read it; empty: for information
    is_met: bool
    remedy: str


def at_least(name, value, unit, low, remedy):
    return Finding(name, value, unit, f"≥ {low:.3g}", value >= low, remedy)


def at_most(name, value, unit, high, remedy):
    return Finding(name, value, unit, f"≤ {high:.3g}", value <= high, remedy)


def information(name, value, unit):
    return Finding(name, value, unit, "", True, "")


@dataclass(frozen=True)
class Made:
    """A robot, and how good it is."""
    robot: object
    findings: list
    driven: str                                 # what the drives are
    drives: list                                # robot_trials.Drive
    trips: list = field(default_factory=list)   # what jp-trip says of each, of robots that learn
    pictures: list = field(default_factory=list)  # for the report: name, what is shown, and path


@dataclass(frozen=True)
class Making:
    """Paths of a robot in the making."""
    robot_file: Path
    folder: Path

    @property
    def tables(self):
        return self.folder / "tables"

    @property
    def experiments(self):
        return self.folder / "identify"


class Steps:
    """Says what is being done, and how long it took."""

    def __init__(self, count):
        self._count, self._number = count, 0

    def do(self, title, work):
        self._number += 1
        print(f"{self._number}/{self._count}  {title:<58}", end="", flush=True)
        begun = time.monotonic()
        try:
            result = work()
        except ToolError:
            print("  failed", flush=True)
            raise
        print(f"{time.monotonic() - begun:7.1f} s", flush=True)
        return result
