"""Primitives of other planners: SBPL's .mprim and Nav2's lattice .json, as input of jp-lattice.

Both give poses in metres along each primitive. SBPL's end headings are rounded to the nearest of its angles, so a path
may miss its end state a little; the miss is spread along the path, which then ends exactly there.

An .mprim's additionalactioncostmult multiplies what the primitive costs. Primitives that drive across their heading are
left out, as no robot here can: those whose way is on average farther from the heading than half the widest gap between
headings, so that a heading beside would have described it better.
"""
import json
import math

from tools.common import ToolError, read_text

HEADINGS = 16

RESOLUTION_MIN, RESOLUTION_MAX = 0.01, 10.0  # m
PRIMITIVES_MAX = 1024
POSES_MAX = 1000
CELLS_MAX = 127

# A path may miss its end state by this much, cells and rad.
MISS_MAX = 0.6
MISS_HEADING_MAX = 0.3

# Files carry four decimals; a heading this close to a round one is meant to be it, rad.
HEADING_ROUNDING = 1e-3

# Of additionalactioncostmult; SBPL's are whole numbers.
FACTOR_MAX = 65535

# Ways are looked at in pieces this long, cells: decimals of poses close together say nothing of a direction.
STRIDE = 0.25

STRAIGHT = [(1, 0), (2, 1), (1, 1), (1, 2), (0, 1), (-1, 2), (-1, 1), (-2, 1), (-1, 0), (-2, -1), (-1, -1), (-1, -2),
            (0, -1), (1, -2), (1, -1), (2, -1)]


class Primitive:
    """One primitive of a file: headings by index, its end cell, its poses in metres, the factor of its cost."""

    def __init__(self, where, start, end, cell, poses, factor=1):
        self.where = where
        self.start, self.end = start, end
        self.dx, self.dy = cell
        self.poses = poses
        self.factor = factor

    def error(self, reason):
        return ToolError(f"{self.where}: {reason}")


def wrapped(angle):
    """To (−π, π]."""
    return math.remainder(angle, 2 * math.pi)


def number(where, text, low, high, whole=False):
    try:
        value = int(text) if whole else float(text)
    except (ValueError, TypeError, OverflowError):
        kind = "a whole number" if whole else "a number"
        raise ToolError(f"{where}: {str(text)[:40]!r} is not {kind}") from None
    if not low <= value <= high:
        raise ToolError(f"{where}: {value:g} is out of range, must be {low:g} to {high:g}")
    return value


class Lines:
    """The lines of an .mprim file, one `key: value` or one row of numbers after the other."""

    def __init__(self, path):
        self.path = path
        self._lines = [line.strip() for line in read_text(path).splitlines()]
        self._next = 0

    @property
    def where(self):
        return f"{self.path}: line {self._next}"

    def _take(self, what):
        while self._next < len(self._lines) and not self._lines[self._next]:
            self._next += 1
        if self._next == len(self._lines):
            raise ToolError(f"{self.path}: ends early, {what} is missing")
        self._next += 1
        return self._lines[self._next - 1]

    def value(self, key):
        line = self._take(key)
        name, _, text = line.partition(":")
        if name.strip() != key:
            raise ToolError(f"{self.where}: expected {key}:, found {line[:40]!r}")
        return text.strip()

    def skip(self, key):
        """Passes over a line that only some files have."""
        line = self._lines[self._next] if self._next < len(self._lines) else ""
        self._next += line.startswith(f"{key}:")

    def number(self, key, low, high, whole=False):
        return number(f"{self.path}: {key}", self.value(key), low, high, whole)

    def pose(self):
        cells = self._take("a pose").split()
        if len(cells) != 3:
            raise ToolError(f"{self.where}: a pose is three numbers")
        return [number(self.where, cell, -1e4, 1e4) for cell in cells]


def read_mprim_primitive(lines):
    lines.value("primID")
    where = lines.where
    start = lines.number("startangle_c", 0, HEADINGS - 1, whole=True)
    cells = lines.value("endpose_c").split()
    if len(cells) != 3:
        raise ToolError(f"{lines.where}: endpose_c is three whole numbers")
    dx, dy = (number(lines.where, cell, -CELLS_MAX, CELLS_MAX, whole=True) for cell in cells[:2])
    end = number(lines.where, cells[2], -HEADINGS, 2 * HEADINGS, whole=True) % HEADINGS
    factor = lines.number("additionalactioncostmult", 1, FACTOR_MAX)
    lines.skip("turning_radius")
    poses = [lines.pose() for _ in range(lines.number("intermediateposes", 2, POSES_MAX, whole=True))]
    return Primitive(where, start, end, (dx, dy), poses, factor)


def read_mprim(path):
    """Resolution, headings and primitives of an SBPL file."""
    lines = Lines(path)
    resolution = lines.number("resolution_m", RESOLUTION_MIN, RESOLUTION_MAX)
    lines.skip("min_turning_radius_m")
    if lines.number("numberofangles", 1, 1e6, whole=True) != HEADINGS:
        raise ToolError(f"{path}: numberofangles: must be {HEADINGS}")
    for _ in range(HEADINGS):
        lines.skip("angle")  # the first poses say them too
    count = lines.number("totalnumberofprimitives", 1, PRIMITIVES_MAX, whole=True)
    primitives = [read_mprim_primitive(lines) for _ in range(count)]
    return resolution, mprim_headings(path, primitives), primitives


def round_heading(angle, heading):
    """The exact value that four decimals stand for: a sixteenth of a turn or the direction of a unit step."""
    for exact in (2 * math.pi * heading / HEADINGS, math.atan2(STRAIGHT[heading][1], STRAIGHT[heading][0])):
        if abs(wrapped(angle - exact)) < HEADING_ROUNDING:
            return exact % (2 * math.pi)
    return angle % (2 * math.pi)


def mprim_headings(path, primitives):
    """Each heading is that of the first pose of the primitives that start there."""
    headings = [None] * HEADINGS
    for primitive in primitives:
        angle = primitive.poses[0][2]
        known = headings[primitive.start]
        if known is None:
            headings[primitive.start] = round_heading(angle, primitive.start)
        elif abs(wrapped(angle - known)) > 2 * HEADING_ROUNDING:
            raise primitive.error(f"starts at {angle:g} rad, others at heading {primitive.start} at {known:g} rad")
    if None in headings:
        raise ToolError(f"{path}: no primitive starts at heading {headings.index(None)}")
    return headings


def member(where, value, key, kind, name):
    found = value.get(key) if isinstance(value, dict) else None
    if not isinstance(found, kind) or isinstance(found, bool):
        raise ToolError(f"{where}: {key}: missing, or not {name}")
    return found


def read_nav2_poses(where, values):
    if not 1 <= len(values) <= POSES_MAX:
        raise ToolError(f"{where}: {len(values)} poses, must be 1 to {POSES_MAX}")
    poses = []
    for value in values:
        if not isinstance(value, list) or len(value) != 3 or any(isinstance(x, (bool, str)) for x in value):
            raise ToolError(f"{where}: a pose is three numbers")
        poses.append([number(where, x, -1e4, 1e4) for x in value])
    return poses


def read_nav2_primitive(path, index, value, resolution, headings):
    where = f"{path}: primitive {index}"
    start, end = (number(f"{where}: {key}", member(where, value, key, int, "a whole number"), 0, HEADINGS - 1,
                         whole=True) for key in ("start_angle_index", "end_angle_index"))
    poses = read_nav2_poses(where, member(where, value, "poses", list, "a list"))
    if math.hypot(*poses[0][:2]) > 0 or len(poses) == 1:
        poses.insert(0, [0.0, 0.0, headings[start]])
    dx, dy = (number(where, round(x / resolution), -CELLS_MAX, CELLS_MAX, whole=True) for x in poses[-1][:2])
    return Primitive(where, start, end, (dx, dy), poses)


def read_nav2(path):
    """Resolution, headings and primitives of a Nav2 file."""
    try:
        data = json.loads(read_text(path))
    except (ValueError, RecursionError) as error:
        raise ToolError(f"{path}: no JSON: {error}") from None
    about = member(path, data, "lattice_metadata", dict, "an object")
    resolution = number(f"{path}: grid_resolution", member(path, about, "grid_resolution", (int, float), "a number"),
                        RESOLUTION_MIN, RESOLUTION_MAX)
    angles = member(path, about, "heading_angles", list, "a list")
    if len(angles) != HEADINGS:
        raise ToolError(f"{path}: heading_angles: {len(angles)} headings, must be {HEADINGS}")
    headings = [number(f"{path}: heading_angles", angle, -10, 10) for angle in angles]
    values = member(path, data, "primitives", list, "a list")
    if not 1 <= len(values) <= PRIMITIVES_MAX:
        raise ToolError(f"{path}: {len(values)} primitives, must be 1 to {PRIMITIVES_MAX}")
    return resolution, headings, [read_nav2_primitive(path, i, value, resolution, headings)
                                  for i, value in enumerate(values)]


def close_path(primitive, resolution, headings):
    """Poses in cells from the start state to exactly the end state."""
    start, end = headings[primitive.start], headings[primitive.end]
    poses = [[x / resolution, y / resolution, heading] for x, y, heading in primitive.poses]
    first, last = poses[0], poses[-1]
    if math.hypot(*first[:2]) > MISS_MAX or abs(wrapped(first[2] - start)) > MISS_HEADING_MAX:
        raise primitive.error("its poses do not begin at its start")
    miss = [primitive.dx - last[0], primitive.dy - last[1], wrapped(end - last[2])]
    if math.hypot(*miss[:2]) > MISS_MAX or abs(miss[2]) > MISS_HEADING_MAX:
        raise primitive.error("its poses do not end at its end")
    steps = len(poses) - 1
    closed = [[value + error * i / steps for value, error in zip(pose, miss)] for i, pose in enumerate(poses)]
    closed[0] = [0.0, 0.0, start]
    return closed


def strides(poses):
    """Neighbouring poses at least a stride apart, to the last one."""
    last = poses[0]
    for pose in poses[1:]:
        if math.dist(pose[:2], last[:2]) >= STRIDE or pose is poses[-1]:
            yield last, pose
            last = pose


def skew(poses):
    """Average angle between the way, ahead or back, and the heading, rad."""
    along = across = 0.0
    for (x, y, heading), (next_x, next_y, next_heading) in strides(poses):
        dx, dy = next_x - x, next_y - y
        middle = heading + wrapped(next_heading - heading) / 2
        along += abs(dx * math.cos(middle) + dy * math.sin(middle))
        across += abs(dy * math.cos(middle) - dx * math.sin(middle))
    return math.atan2(across, along)


def skew_max(headings):
    """Half the widest gap between headings."""
    return max(wrapped(b - a) % (2 * math.pi) for a, b in zip(headings, [*headings[1:], headings[0]])) / 2


class Found:
    """What a file holds: the input of jp-lattice, and what its reader should know."""

    def __init__(self, resolution, headings, primitives):
        limit = skew_max(headings)
        closed = [(primitive, close_path(primitive, resolution, headings)) for primitive in primitives]
        skews = [skew(poses) for _, poses in closed]
        kept = [pair for pair, angle in zip(closed, skews) if angle <= limit]
        left_out = [angle for angle in skews if angle > limit]
        dearer = [primitive.factor for primitive, _ in kept if primitive.factor > 1]
        self.input = {"resolution_m": resolution, "headings_rad": headings, "primitives": [
            {"start": primitive.start, "end": primitive.end, "dx": primitive.dx, "dy": primitive.dy,
             "factor": primitive.factor, "poses": poses} for primitive, poses in kept]}
        self.notes = []
        if left_out:
            least, most = math.degrees(min(left_out)), math.degrees(max(left_out))
            self.notes.append(f"{len(left_out)} primitives drive across their heading, by {least:.1f} to {most:.1f} "
                              f"degrees, and were left out: its headings explain {math.degrees(limit):.1f}")
        if dearer:
            self.notes.append(f"{len(dearer)} primitives cost {min(dearer):g} to {max(dearer):g} times what they take: "
                              "additionalactioncostmult")


def read_primitives(path):
    readers = {".mprim": read_mprim, ".json": read_nav2}
    if path.suffix not in readers:
        raise ToolError(f"{path}: neither .mprim (SBPL) nor .json (Nav2)")
    resolution, headings, primitives = readers[path.suffix](path)
    if abs(wrapped(headings[0])) > HEADING_ROUNDING or any(a >= b for a, b in zip(headings, headings[1:])):
        raise ToolError(f"{path}: the headings must rise from 0 within one turn")
    headings[0] = 0.0
    found = Found(resolution, headings, primitives)
    if not found.input["primitives"]:
        raise ToolError(f"{path}: every primitive drives across its heading; the robot cannot")
    return found
