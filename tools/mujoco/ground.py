"""The ground of a MuJoCo world: a plane that slopes, with steps across it and patches that are slippery.

Coordinates are the plane's: x is where the robot looks at the start, y to its left, z off the plane.
"""
import math
from dataclasses import dataclass

GRAVITY = 9.81  # m/s², of the robots' equations

STEP_LENGTH = 0.3  # m along x
STEP_WIDTH = 8.0   # m across


@dataclass(frozen=True)
class Step:
    """A board that lies across the way."""
    x: float       # of its near edge, m
    height: float  # m


@dataclass(frozen=True)
class Patch:
    """A disc on which tyres grip less."""
    x: float
    y: float
    radius: float
    friction: float

    def covers(self, x, y):
        return math.hypot(x - self.x, y - self.y) <= self.radius


@dataclass(frozen=True)
class Ground:
    """`slope` in radians rises along x, `across` to the left."""
    slope: float = 0.0
    across: float = 0.0
    steps: tuple = ()
    patches: tuple = ()

    def up(self):
        """The vertical, a unit vector."""
        rise = (math.sin(self.slope), math.cos(self.slope) * math.sin(self.across))
        return (*rise, math.sqrt(1 - rise[0] ** 2 - rise[1] ** 2))

    def gravity(self):
        return tuple(-GRAVITY * component for component in self.up())

    def friction_at(self, x, y, otherwise):
        return min((patch.friction for patch in self.patches if patch.covers(x, y)), default=otherwise)

    def names(self):
        """Of its parts."""
        return ["ground", *(f"step{i}" for i in range(len(self.steps)))]

    def geoms(self):
        """As elements of the model."""
        yield ('<geom name="ground" type="plane" size="200 200 1" material="floor" contype="0" conaffinity="0"/>')
        for i, step in enumerate(self.steps):
            yield (f'<geom name="step{i}" type="box" size="{STEP_LENGTH / 2} {STEP_WIDTH / 2} {step.height / 2}" '
                   f'pos="{step.x + STEP_LENGTH / 2} 0 {step.height / 2}" contype="0" conaffinity="0" '
                   f'rgba=".55 .42 .3 1"/>')
