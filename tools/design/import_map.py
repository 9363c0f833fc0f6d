#!/usr/bin/env python3
"""Import a map of the ground into the JSON file that the planner's programs read.

The kind of map follows from the source's name:
  .yaml, .yml  ROS map_server, mode trinary, with its PGM or PNG image beside it
  .asc         ESRI ASCII grid of elevations, m; NODATA (-9999 if it names none) is unknown ground
  .npz         elevations, m, with dx, dy, ymin, ymax in degrees as in matplotlib's jacksboro_fault_dem.npz
  .map         MovingAI grid: . G S are free, @ O T W are occupied; S is ground of class 1, G of class 2
  .cfg         SBPL environment, nav2D or (x, y, theta): cells from obsthresh on are occupied, the costs of others are
               kept; its first row is y = 0, the southern one; its start and end are printed as options of jp-plan
  jacksboro    the elevation model that matplotlib carries

Ground steeper than 15 degrees, or than --steep says, is occupied. Elevations are relative to the middle of their range, which must fit 64 m.
Where the land is larger than a robot's map, --scale makes a model of it: lengths and heights shrink alike, so that the
slopes stay those of the land.

The file: {"format": "joulepath-map-1", "name", "width", "height" (cells), "resolution_m", "origin_m": [x, y, yaw] of
the south-west corner, "note", "rows": one text a row of cells, the northern row first (. free, # occupied, ?
unknown), "elevation_m": likewise, absent where the ground is level, "cost": likewise, 0…255, absent without costs,
"cost_shift": with costs, 0…8: driving over a cell costs 1 + cost/2^cost_shift times as much, "class": likewise a text of
digits 0…3, absent where all ground is of class 0, "grounds": of each class, from 0 on, what it is like in the simulator,
absent where all are alike: {"name", "rolling", "friction": times as much as the robot file says}}.
Exit status 2: bad input; nothing was written.
"""
import argparse
import contextlib
import json
import math
import re
import warnings
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
import yaml
from PIL import Image
from scipy import ndimage

from tools.common import (ArgumentParser, ToolError, print_aligned, read_text, real_number, run, shown_path,
                          whole_number, write_whole)

FORMAT = "joulepath-map-1"

# What the library's map holds: include/joulepath/terrain.h.
SIDE_MAX = 4096
ELEVATION_MAX_M = 31.99
RESOLUTION_RANGE_M = 0.001, 1000.0

# Of the source, before it is resampled.
SOURCE_SIDE_MAX = 8192

FREE, UNKNOWN, OCCUPIED = 0, 1, 2
CHARACTERS = np.array([".", "?", "#"])

LATTICE_CELL_M = 0.2
MODEL_SIDE = 300
STEEP_DEG = 15
# Unit steps of the lattice to one side, in columns and rows.
STEPS = ((1, 0), (2, 1), (1, 1), (1, 2), (0, 1), (-1, 2), (-1, 1), (-2, 1))

# Nothing on Earth is farther from sea level.
LAND_MAX_M = 12000.0
METRES_PER_DEGREE = 111200.0

JACKSBORO = "jacksboro"
# Left, top, columns and rows of its less rugged east.
JACKSBORO_WINDOW = 283, 40, 120, 96


@dataclass
class Grid:
    """A map, the northern row first."""
    cells: np.ndarray  # FREE, UNKNOWN, OCCUPIED
    resolution: float  # m
    note: str
    origin: tuple = (0.0, 0.0, 0.0)  # of the south-west corner: m, m, rad
    elevation: np.ndarray | None = None  # m
    cost: np.ndarray | None = None  # whole numbers; driving over a cell costs 1 + cost times as much
    classes: np.ndarray | None = None  # of the ground
    task: str = ""  # options of jp-plan


@dataclass
class Land:
    """Measured elevations, the northern row first."""
    elevation: np.ndarray  # m; NaN: unknown
    cell: tuple  # width and height, m
    note: str
    origin: tuple = (0.0, 0.0)  # m


@contextlib.contextmanager
def foreign(path, what):
    """Reading by a library: for a broken file it raises, or warns of, whatever its parts do."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            yield
    except ToolError:
        raise
    except OSError as error:
        raise ToolError(f"{path}: {error.strerror or f'not {what}: {_first_line(error)}'}") from None
    except Exception as error:  # noqa: BLE001
        raise ToolError(f"{path}: not {what}: {_first_line(error)}") from None


def _first_line(error):
    return next((printable(line) for line in str(error).splitlines() if line.strip()), type(error).__name__)


def printable(text, limit=80):
    """Text of a file as it may stand in a line of ours."""
    text = "".join(c if c.isprintable() else "?" for c in str(text))
    return text if len(text) <= limit else text[:limit] + "…"


def number(path, key, value, low=-math.inf, high=math.inf):
    """A finite number of a file, from its text or as its library gave it."""
    try:
        if isinstance(value, bool):
            raise TypeError
        result = float(value)
    except (TypeError, ValueError, OverflowError):
        raise ToolError(f"{path}: {key}: {printable(value)!r} is not a number") from None
    if not math.isfinite(result) or not low <= result <= high:
        raise ToolError(f"{path}: {key}: {result:g} is not in {low:g}…{high:g}")
    return result


def whole(path, key, value, high):
    result = number(path, key, value, 1, high)
    if result != int(result):
        raise ToolError(f"{path}: {key}: {result:g} is not a whole number")
    return int(result)


def check_not_output(path, options):
    """A source would be lost."""
    if options.output.exists() and options.output.samefile(path):
        raise ToolError(f"{options.output}: is read for this map; name another file for the result")


# ---- ROS map_server ----

IMAGE_FORMATS = {".pgm": "PPM", ".png": "PNG"}
# Full scale of the modes that Pillow reads grey images into; the others are turned into RGB.
GREY_MODES = {"1": 1, "L": 255, "I;16": 65535, "I;16B": 65535, "I": 65535}


def read_image(path):
    """Brightness, the average of the colours, and its full scale."""
    kind = IMAGE_FORMATS.get(path.suffix.lower())
    if kind is None:
        raise ToolError(f"{path}: give a PGM or PNG image")
    with foreign(path, f"a whole {path.suffix[1:].upper()} image"), Image.open(path, formats=[kind]) as image:
        if max(image.size) > SOURCE_SIDE_MAX:
            raise ToolError(f"{path}: {image.width} × {image.height} pixels; at most {SOURCE_SIDE_MAX} a side")
        if "A" in image.getbands() or "transparency" in image.info:
            raise ToolError(f"{path}: has transparent pixels, whose meaning differs between programs; flatten it")
        if image.mode in GREY_MODES:
            return np.asarray(image, dtype=float), GREY_MODES[image.mode]
        return np.asarray(image.convert("RGB"), dtype=float).mean(axis=2), 255


def read_ros(path, options):
    text = read_text(path)
    with foreign(path, "a YAML file"):
        about = yaml.safe_load(text)
    if not isinstance(about, dict):
        raise ToolError(f"{path}: holds no keys; a map_server file names image, resolution, origin, …")
    for key in ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"):
        if key not in about:
            raise ToolError(f"{path}: the key {key} is missing")
    if about.get("mode", "trinary") != "trinary":
        raise ToolError(f"{path}: mode: {printable(about['mode'])!r} is not supported; only trinary is")
    if not isinstance(about["image"], str) or not about["image"].isprintable() or not about["image"]:
        raise ToolError(f"{path}: image: {printable(about['image'])!r} is not a file name")
    if not isinstance(about["origin"], list) or len(about["origin"]) != 3:
        raise ToolError(f"{path}: origin: {printable(about['origin'])!r} is not [x, y, yaw]")
    origin = tuple(number(path, "origin", value) for value in about["origin"])
    resolution = number(path, "resolution", about["resolution"], *RESOLUTION_RANGE_M)
    occupied = number(path, "occupied_thresh", about["occupied_thresh"], 0, 1)
    free = number(path, "free_thresh", about["free_thresh"], 0, occupied)
    negate = about["negate"] if isinstance(about["negate"], bool) else number(path, "negate", about["negate"])
    if negate not in (0, 1):
        raise ToolError(f"{path}: negate: {negate:g} is not 0 or 1")

    image = path.parent / about["image"]
    brightness, full = read_image(image)
    check_not_output(image, options)
    darkness = (brightness if negate else full - brightness) / full
    cells = np.where(darkness > occupied, OCCUPIED, np.where(darkness < free, FREE, UNKNOWN))
    return Grid(cells, resolution, f"ROS map {path.name}", origin)


# ---- MovingAI ----

MOVING_AI = {**dict.fromkeys(".GS", FREE), **dict.fromkeys("@OTW", OCCUPIED)}
MOVING_AI_CLASSES = {"S": 1, "G": 2}


def read_moving_ai(path, options):
    lines = read_text(path).splitlines()
    header = {}
    for index, line in enumerate(lines):
        words = line.split()
        if words == ["map"]:
            break
        if len(words) != 2 or words[0] not in ("type", "height", "width"):
            raise ToolError(f"{path}: line {index + 1}: {printable(line)!r} is not part of a MovingAI header")
        header[words[0]] = words[1]
    else:
        raise ToolError(f"{path}: no line 'map': not a MovingAI map")
    for key in ("height", "width"):
        if key not in header:
            raise ToolError(f"{path}: the header lacks {key}")
    height = whole(path, "height", header["height"], SOURCE_SIDE_MAX)
    width = whole(path, "width", header["width"], SOURCE_SIDE_MAX)
    rows = lines[index + 1:]
    while len(rows) > height and not rows[-1].strip():
        rows.pop()
    if len(rows) != height:
        raise ToolError(f"{path}: {len(rows)} rows, but height is {height}")
    cells = np.empty((height, width), dtype=int)
    classes = np.zeros((height, width), dtype=int)
    for y, row in enumerate(rows):
        if len(row) != width:
            raise ToolError(f"{path}: line {index + 2 + y}: {len(row)} cells, but width is {width}")
        if not set(row) <= MOVING_AI.keys():
            wrong = sorted(set(row) - MOVING_AI.keys())[0]
            raise ToolError(f"{path}: line {index + 2 + y}: {printable(wrong)!r} is no MovingAI cell")
        cells[y] = [MOVING_AI[c] for c in row]
        classes[y] = [MOVING_AI_CLASSES.get(c, 0) for c in row]
    return Grid(cells, options.cell_size, f"MovingAI map {path.name}, {options.cell_size:g} m a cell",
                classes=classes if classes.any() else None)


# ---- SBPL ----

# Keys of an environment, and how many numbers follow each.
SBPL_KEYS = {"discretization(cells)": 2, "NumThetaDirs": 1, "obsthresh": 1, "cost_inscribed_thresh": 1,
             "cost_possibly_circumscribed_thresh": 1, "cellsize(meters)": 1, "nominalvel(mpersecs)": 1,
             "timetoturn45degsinplace(secs)": 1, "start(cells)": 2, "end(cells)": 2, "start(meters,rads)": 3,
             "end(meters,rads)": 3}
SBPL_COST_MAX = 255


def read_sbpl_header(path, words):
    """The numbers of each key, and how many words they take."""
    header, place = {}, 0
    while place < len(words) and words[place] != "environment:":
        key = words[place][:-1]
        if not words[place].endswith(":") or key not in SBPL_KEYS:
            raise ToolError(f"{path}: {printable(words[place])!r} is not a key of an SBPL environment")
        count = SBPL_KEYS[key]
        values = words[place + 1:place + 1 + count]
        if key in header or len(values) < count:
            raise ToolError(f"{path}: {key}: needs {'one number' if count == 1 else f'{count} numbers'}, once")
        header[key] = [number(path, key, value) for value in values]
        place += 1 + count
    for key in ("discretization(cells)", "obsthresh"):
        if key not in header:
            raise ToolError(f"{path}: the key {key} is missing: not an SBPL environment")
    if place == len(words):
        raise ToolError(f"{path}: the key environment is missing: not an SBPL environment")
    return header, place + 1


def sbpl_place(path, header, end, size, cell):
    """X,Y or X,Y,DEGREES of the start or the end, m; nothing when the file has none."""
    if f"{end}(meters,rads)" in header:
        x, y, angle = header[f"{end}(meters,rads)"]
        heading = [math.degrees(angle)]
    elif f"{end}(cells)" in header:
        x, y = ((value + 0.5) * cell for value in header[f"{end}(cells)"])
        heading = [0] if end == "start" else []
    else:
        return ""
    if not (0 <= x < size[0] * cell and 0 <= y < size[1] * cell):
        raise ToolError(f"{path}: {end}: {x:g}, {y:g} m is outside the map of {size[0]} × {size[1]} cells of "
                        f"{cell:g} m")
    return ",".join(f"{value:.6g}" for value in (x, y, *heading))


def read_sbpl_cells(path, words, width, height):
    """Costs, the southern row first."""
    if len(words) != width * height:
        raise ToolError(f"{path}: environment: {len(words)} cells, but discretization says {width} × {height}")
    costs = [number(path, f"environment: row {i // width + 1}, cell {i % width + 1}", word, 0, SBPL_COST_MAX)
             for i, word in enumerate(words)]
    fraction = next((i for i, cost in enumerate(costs) if cost != int(cost)), None)
    if fraction is not None:
        raise ToolError(f"{path}: environment: row {fraction // width + 1}, cell {fraction % width + 1}: "
                        f"{costs[fraction]:g} is not a whole number")
    return np.array(costs).reshape(height, width)


def read_sbpl(path, options):
    words = read_text(path).split()
    header, place = read_sbpl_header(path, words)
    width, height = (whole(path, "discretization(cells)", value, SOURCE_SIDE_MAX)
                     for value in header["discretization(cells)"])
    threshold = number(path, "obsthresh", header["obsthresh"][0], 1, SBPL_COST_MAX)
    cell = number(path, "cellsize(meters)", header.get("cellsize(meters)", [options.cell_size])[0], *RESOLUTION_RANGE_M)
    costs = read_sbpl_cells(path, words[place:], width, height)
    grey = costs[(costs > 0) & (costs < threshold)]
    note = f"SBPL environment {path.name}"
    if grey.size:
        note += f"; {grey.size} cells cost {1 + grey.min():g} to {1 + grey.max():g} times as much"
    start = sbpl_place(path, header, "start", (width, height), cell)
    goal = sbpl_place(path, header, "end", (width, height), cell)
    task = f"--start={start} --goal={goal}" if start and goal else ""
    cost = np.where(costs >= threshold, 0, costs)[::-1].astype(int) if grey.size else None
    return Grid(np.where(costs >= threshold, OCCUPIED, FREE)[::-1], cell, note, cost=cost, task=task)


# ---- Elevations ----

# Of a grid whose header names none.
NODATA_DEFAULT = -9999
ASC_KEYS = ("ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize", "nodata_value")


def read_asc_header(path, lines):
    """Keys with their values, and how many lines they take."""
    header = {}
    for index, line in enumerate(lines):
        words = line.split()
        if not words or not words[0][0].isalpha() or words[0].lower() in ("nan", "inf", "infinity"):
            break
        key = words[0].lower()
        if key not in ASC_KEYS or len(words) != 2:
            raise ToolError(f"{path}: line {index + 1}: {printable(line)!r} is not part of an ESRI ASCII header")
        header[key] = number(path, key, words[1])
    for key in ("ncols", "nrows", "cellsize"):
        if key not in header:
            raise ToolError(f"{path}: the header lacks {key}: not an ESRI ASCII grid")
    return header, len(header)


def asc_corner(path, header, axis, cell):
    if f"{axis}llcorner" in header:
        return header[f"{axis}llcorner"]
    if f"{axis}llcenter" in header:
        return header[f"{axis}llcenter"] - cell / 2
    raise ToolError(f"{path}: the header lacks {axis}llcorner")


def read_asc(path, options):
    lines = read_text(path).splitlines()
    header, start = read_asc_header(path, lines)
    width = whole(path, "ncols", header["ncols"], SOURCE_SIDE_MAX)
    height = whole(path, "nrows", header["nrows"], SOURCE_SIDE_MAX)
    cell = number(path, "cellsize", header["cellsize"], RESOLUTION_RANGE_M[0], 1e6)
    origin = asc_corner(path, header, "x", cell), asc_corner(path, header, "y", cell)
    rows = lines[start:]
    while len(rows) > height and not rows[-1].strip():
        rows.pop()
    if len(rows) != height:
        raise ToolError(f"{path}: {len(rows)} rows, but nrows is {height}")
    elevation = np.empty((height, width))
    for y, row in enumerate(rows):
        words = row.split()
        if len(words) != width:
            raise ToolError(f"{path}: line {start + 1 + y}: {len(words)} values, but ncols is {width}")
        for x, word in enumerate(words):
            elevation[y, x] = number(path, f"line {start + 1 + y}", word)
    elevation[elevation == header.get("nodata_value", NODATA_DEFAULT)] = np.nan
    return Land(elevation, (cell, cell), f"ESRI ASCII grid {path.name}", origin)


def read_npz(path, options):
    with foreign(path, "a NumPy archive with elevation, dx, dy, ymin and ymax"), np.load(path) as archive:
        values = {key: archive[key] for key in ("elevation", "dx", "dy", "ymin", "ymax")}
        elevation = values["elevation"].astype(float)
        latitude, dx, dy = (float(x) for x in ((values["ymin"] + values["ymax"]) / 2, values["dx"], values["dy"]))
    if elevation.ndim != 2 or not 1 <= min(elevation.shape) <= max(elevation.shape) <= SOURCE_SIDE_MAX:
        raise ToolError(f"{path}: elevation: {printable(elevation.shape)} is no grid of 1…{SOURCE_SIDE_MAX} a side")
    number(path, "latitude", latitude, -85, 85)
    for key, value in (("dx", dx), ("dy", dy)):
        number(path, key, value, 1e-6, 1)
    if not np.isfinite(elevation).all():
        raise ToolError(f"{path}: elevation: holds values that are not finite")
    cell = METRES_PER_DEGREE * dx * math.cos(math.radians(latitude)), METRES_PER_DEGREE * dy
    return Land(elevation, cell, f"elevation model {path.name}")


def check_land(path, elevation):
    known = elevation[~np.isnan(elevation)]
    if known.size == 0:
        raise ToolError(f"{path}: every elevation is missing")
    worst = known[np.argmax(np.abs(known))]
    if abs(worst) > LAND_MAX_M:
        raise ToolError(f"{path}: an elevation of {worst:g} m is not of this Earth; is NODATA_value missing or wrong?")


def resampled_land(path, land, resolution, scale):
    """Elevations (NaN: unknown) on square cells of the model, by linear interpolation between the cells' centres."""
    rows, columns = land.elevation.shape
    step = resolution * scale  # m of the land
    height, width = (max(1, int(n * c / step + 1e-6)) for n, c in ((rows, land.cell[1]), (columns, land.cell[0])))
    check_side(path, width, height)
    # Whole cells, from the south-west corner.
    y = rows - 0.5 - (height - 0.5 - np.arange(height)) * step / land.cell[1]
    x = (np.arange(width) + 0.5) * step / land.cell[0] - 0.5
    places = np.meshgrid(y, x, indexing="ij")
    unknown = np.isnan(land.elevation)
    nearest = ndimage.distance_transform_edt(unknown, return_distances=False, return_indices=True)
    filled = land.elevation[tuple(nearest)] if unknown.any() else land.elevation
    elevation = ndimage.map_coordinates(filled, places, order=1, mode="nearest")
    elevation[ndimage.map_coordinates(unknown.astype(float), places, order=1, mode="nearest") > 1e-9] = np.nan
    return elevation


def steep_cells(elevation, resolution, degrees=STEEP_DEG):
    """True where any unit step from or to a cell is steeper; unknown neighbours do not count."""
    height, width = elevation.shape
    steep = np.zeros(elevation.shape, dtype=bool)
    for dx, dy in STEPS:
        if abs(dx) >= width or dy >= height:
            continue
        here = np.s_[:height - dy, max(0, -dx):width - max(0, dx)]
        there = np.s_[dy:, max(0, dx):width + min(0, dx)]
        rise = np.abs(elevation[there] - elevation[here])
        over = rise > math.tan(math.radians(degrees)) * resolution * math.hypot(dx, dy)  # false for NaN
        steep[here] |= over
        steep[there] |= over
    return steep


def grid_from_land(path, land, options):
    check_land(path, land.elevation)
    scale = options.scale
    rows, columns = land.elevation.shape
    extent = max(rows * land.cell[1], columns * land.cell[0])
    if path.suffix.lower() == ".npz":
        resolution = options.resolution or LATTICE_CELL_M
        scale = scale or extent / (MODEL_SIDE * resolution)
    else:
        scale = scale or 1.0
        resolution = options.resolution or land.cell[0] / scale
    if not RESOLUTION_RANGE_M[0] <= resolution <= RESOLUTION_RANGE_M[1]:
        raise ToolError(f"{path}: cells of {resolution:g} m; give --resolution")

    elevation = resampled_land(path, land, resolution, scale)
    known = ~np.isnan(elevation)
    if not known.any():
        raise ToolError(f"{path}: nothing is known of any cell of {resolution:g} m")
    low, high = elevation[known].min(), elevation[known].max()
    if (high - low) / scale > 2 * ELEVATION_MAX_M:
        least = math.ceil((high - low) / (2 * ELEVATION_MAX_M))
        raise ToolError(f"{path}: elevations from {low:g} to {high:g} m do not fit ±32 m; --scale {least} would")
    elevation = np.round((elevation - (low + high) / 2) / scale, 3)
    cells = np.where(known, np.where(steep_cells(elevation, resolution, options.steep), OCCUPIED, FREE), UNKNOWN)
    note = f"{land.note}; heights above {(low + high) / 2:g} m; ground steeper than {options.steep:g}° is occupied"
    if scale != 1:
        note += f"; a model 1:{scale:.4g}, lengths and heights alike, so that slopes stay those of the land"
    origin = (land.origin[0] / scale, land.origin[1] / scale, 0.0)
    return Grid(cells, resolution, note, origin, np.where(known, elevation, 0.0))


# ---- Resampling and cutting ----

def covered(count, ratio):
    """For each coarse cell, the range of fine cells that it overlaps; `ratio` fine cells make one coarse cell."""
    coarse = max(1, math.ceil(count / ratio - 1e-6))
    return [(int(i * ratio + 1e-6), math.ceil((i + 1) * ratio - 1e-6)) for i in range(coarse)]


def resampled_cells(path, cells, ratio, beyond):
    """Each coarse cell is the worst of the fine cells in it and, at the edges, of what lies beyond the map. From the
    south-west corner."""
    rows = covered(cells.shape[0], ratio)
    columns = covered(cells.shape[1], ratio)
    check_side(path, len(columns), len(rows))
    from_south = cells[::-1]
    padded = np.pad(from_south, ((0, rows[-1][1] - cells.shape[0]), (0, columns[-1][1] - cells.shape[1])),
                    constant_values=beyond)
    by_row = np.stack([padded[low:high].max(axis=0) for low, high in rows])
    return np.stack([by_row[:, low:high].max(axis=1) for low, high in columns], axis=1)[::-1]


def check_side(path, width, height):
    if max(width, height) > SIDE_MAX:
        raise ToolError(f"{path}: {width} × {height} cells; at most {SIDE_MAX} a side: give a --window, a coarser "
                        "--resolution or, for elevations, a larger --scale")


def cut(path, values, window):
    """The window (left, top, columns, rows) of an array."""
    left, top, columns, rows = window
    if min(left, top) < 0 or min(columns, rows) < 1 or left + columns > values.shape[1] or top + rows > values.shape[0]:
        raise ToolError(f"{path}: the window {left} {top} {columns} {rows} is not inside its {values.shape[1]} columns "
                        f"and {values.shape[0]} rows")
    return values[top:top + rows, left:left + columns]


def moved(origin, shape, cell, window):
    """South-west corner of the window."""
    left, top, _, rows = window
    return (origin[0] + left * cell[0], origin[1] + (shape[0] - top - rows) * cell[1], *origin[2:])


# ---- The program ----

READERS = {".yaml": read_ros, ".yml": read_ros, ".asc": read_asc, ".npz": read_npz, ".map": read_moving_ai,
           ".cfg": read_sbpl}


def read_grid(path, window, options):
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise ToolError(f"{path}: a map is a .yaml, .asc, .npz, .map or .cfg file, or {JACKSBORO}")
    if not path.is_file():
        raise ToolError(f"{path}: {'is a directory' if path.is_dir() else 'no such file'}")
    if path.stat().st_size == 0:
        raise ToolError(f"{path}: the file is empty")
    check_not_output(path, options)
    source = reader(path, options)
    if isinstance(source, Land):
        if window:
            source.origin = moved(source.origin, source.elevation.shape, source.cell, window)
            source.elevation = cut(path, source.elevation, window)
            source.note += f", window {' '.join(map(str, window))}"
        return grid_from_land(path, source, options)
    if options.scale:
        raise ToolError(f"{path}: --scale is for elevations")
    if window:
        source.origin = moved(source.origin, source.cells.shape, (source.resolution,) * 2, window)
        source.cells = cut(path, source.cells, window)
        source.cost = None if source.cost is None else cut(path, source.cost, window)
        source.classes = None if source.classes is None else cut(path, source.classes, window)
        source.note += f", window {' '.join(map(str, window))}"
    if options.resolution:
        ratio = options.resolution / source.resolution
        source.cells = resampled_cells(path, source.cells, ratio, UNKNOWN)
        source.cost = None if source.cost is None else resampled_cells(path, source.cost, ratio, 0)
        source.classes = None if source.classes is None else resampled_cells(path, source.classes, ratio, 0)
        source.resolution = options.resolution
    check_side(path, source.cells.shape[1], source.cells.shape[0])
    return source


def map_name(path):
    return re.sub(r"[^A-Za-z0-9._-]+", "-", path.stem)[:63]


def map_json(name, grid, grounds=None):
    """The file's text, with one row of the map a line."""
    height, width = grid.cells.shape
    head = {"format": FORMAT, "name": name, "width": width, "height": height, "resolution_m": grid.resolution,
            "origin_m": list(grid.origin), "note": grid.note}
    lists = {"rows": ["".join(row) for row in CHARACTERS[grid.cells]]}
    if grid.elevation is not None:
        lists["elevation_m"] = grid.elevation.tolist()
    if grid.cost is not None:
        head["cost_shift"] = 0
        lists["cost"] = grid.cost.tolist()
    if grid.classes is not None:
        lists["class"] = ["".join(map(str, row)) for row in grid.classes.tolist()]
        if grounds:
            head["grounds"] = grounds
    parts = [f"{json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}" for key, value in head.items()]
    parts += [f"{json.dumps(key)}: [\n" + ",\n".join(map(json.dumps, rows)) + "\n]" for key, rows in lists.items()]
    return "{" + ",\n".join(parts) + "}\n"


def print_result(name, grid):
    shares = [f"{100 * np.mean(grid.cells == kind):.1f}" for kind in (FREE, OCCUPIED, UNKNOWN)]
    height, width = grid.cells.shape
    relief = "0" if grid.elevation is None else f"{np.ptp(grid.elevation[grid.cells != UNKNOWN]):.2f}"
    print_aligned([("map", "columns", "rows", "cell, m", "free, %", "occupied, %", "unknown, %", "relief, m"),
                   (name, str(width), str(height), f"{grid.resolution:g}", *shares, relief)])
    print(grid.note)
    if grid.task:
        print(f"its task for jp-plan: {grid.task}")


def ground(text):
    """One of --grounds."""
    match = re.fullmatch(r"([^=]+)=([0-9.]+),([0-9.]+)", text)
    if match is None:
        raise argparse.ArgumentTypeError(f"{text!r} is not NAME=ROLLING,FRICTION")
    return {"name": match[1], "rolling": real_number(0.0625, 16)(match[2]), "friction": real_number(0.0625, 1)(match[3])}


def arguments():
    parser = ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", help=f"a .yaml, .asc, .npz, .map or .cfg file, or {JACKSBORO}")
    parser.add_argument("output", type=Path, help="the JSON file")
    parser.add_argument("--window", type=whole_number(0, SOURCE_SIDE_MAX), nargs=4,
                        metavar=("LEFT", "TOP", "COLUMNS", "ROWS"),
                        help="the part of the source to take, in its cells from the north-west corner (default: all; "
                        f"for {JACKSBORO} {' '.join(map(str, JACKSBORO_WINDOW))})")
    parser.add_argument("--resolution", type=real_number(RESOLUTION_RANGE_M[0], 1e6), metavar="M",
                        help="side of a cell of the result; the lattices have 0.2 m. Occupancy: a cell is occupied if "
                        "any part of it is, or else unknown if any part is. (default: as the source; 0.2 for .npz)")
    parser.add_argument("--cell-size", type=real_number(RESOLUTION_RANGE_M[0], 1e6), metavar="M", default=LATTICE_CELL_M,
                        help="side of a cell of MovingAI, or of SBPL's nav2D (default: %(default)s)")
    parser.add_argument("--steep", type=real_number(0.1, 89), metavar="DEGREES", default=STEEP_DEG,
                        help="steeper ground is occupied (default: %(default)s; a robot that finds its way refuses what is "
                        "too steep for it by itself)")
    parser.add_argument("--scale", type=real_number(RESOLUTION_RANGE_M[0], 1e6), metavar="N",
                        help="elevations become a model 1:N, lengths and heights alike, so that slopes stay (default: "
                        f"1; for .npz what fits {MODEL_SIDE} cells)")
    parser.add_argument("--grounds", type=ground, nargs="+", metavar="NAME=ROLLING,FRICTION",
                        help="what classes 0, 1, … are like in the simulator, times as much as the robot file says, as "
                        "mud=3,0.7")
    return parser.parse_args()


def main():
    options = arguments()
    window = options.window
    path = Path(options.source)
    if options.source == JACKSBORO:
        path = Path(matplotlib.get_data_path()) / "sample_data" / "jacksboro_fault_dem.npz"
        window = window or JACKSBORO_WINDOW
    grid = read_grid(path, window, options)
    name = map_name(path)
    if options.grounds and grid.classes is None:
        raise ToolError(f"{path}: --grounds: the map tells no grounds apart")
    write_whole(options.output, map_json(name, grid, options.grounds))
    print_result(name, grid)
    print(f"wrote {shown_path(options.output)}")
    return 0


if __name__ == "__main__":
    run(main)
