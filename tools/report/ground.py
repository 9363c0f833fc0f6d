"""Ground on a picture: reads a map as tools.design.import_map writes it and draws it, with start and goal on it."""
from dataclasses import dataclass

import matplotlib.patheffects
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LightSource, LinearSegmentedColormap, to_rgb
from matplotlib.patches import Patch
from matplotlib.path import Path as MarkerPath
from matplotlib.transforms import Affine2D

from tools.common import ToolError
from tools.report import plots
from tools.report.results import need, need_numbers, need_vector, read_json

MAP_KEYS = ("format", "name", "width", "height", "resolution_m", "origin_m", "rows")
MAP_FORMAT = "joulepath-map-1"

FREE, OCCUPIED, UNKNOWN = ".", "#", "?"

# Low ground to high ground, light enough for the lines on it.
GROUND = LinearSegmentedColormap.from_list("ground", ["#9DBF9E", "#D9E2B4", "#F0E2BC", "#DDBE9A", "#C9A58A"])
LEVEL, OBSTACLE, UNKNOWN_FILL, UNKNOWN_HATCH = "#FBFCFD", "#6B7580", "#E6EAEE", "#A5AFB9"
OUTLINE = [matplotlib.patheffects.withStroke(linewidth=5, foreground="white")]

# Points along x.
DART = MarkerPath([(1, 0), (-0.9, 0.75), (-0.45, 0), (-0.9, -0.75), (1, 0)], closed=True)

CONTOURS = 9
# Hills look flat in true proportion.
RELIEF = 3

WIDTH = 10.0  # inches
MAP_HEIGHT = 3.2, 9.5


@dataclass(frozen=True)
class Map:
    """Cells and elevations with the southern row first."""
    cells: np.ndarray
    elevation: np.ndarray | None  # m
    resolution: float  # m
    origin: tuple  # of the south-west corner: m, m, rad

    @property
    def size(self):
        """m from west to east and from south to north."""
        return self.cells.shape[1] * self.resolution, self.cells.shape[0] * self.resolution

    def frame(self):
        """From m of the grid to m of the map's frame."""
        return Affine2D().rotate(self.origin[2]).translate(*self.origin[:2])


# ---- input ---------------------------------------------------------------------------------------------------------

def read_map(path):
    data = read_json(path)
    need(path, "map", data, MAP_KEYS)
    if data["format"] != MAP_FORMAT:
        raise ToolError(f"{path}: format: not {MAP_FORMAT}; import the map again with "
                        "python -m tools.design.import_map")
    need_numbers(path, "map", data, ("width", "height", "resolution_m"))
    need_vector(path, "origin_m", data["origin_m"], 3)
    shape = data["height"], data["width"]
    rows = data["rows"] if isinstance(data["rows"], list) else []
    cells = grid(path, "rows", [list(str(row)) for row in rows], shape, str)
    elevation = data.get("elevation_m")
    if elevation is not None:
        elevation = grid(path, "elevation_m", elevation, shape, float)
    return Map(cells, elevation, data["resolution_m"], tuple(data["origin_m"]))


def grid(path, key, rows, shape, kind):
    """Rows of a map, the southern one first."""
    try:
        values = np.array(rows, dtype=kind)
    except (TypeError, ValueError):
        values = np.empty(0)
    if values.shape != shape or (kind is float and not np.isfinite(values).all()):
        raise ToolError(f"{path}: {key}: is no grid of {shape[0]} rows of {shape[1]} cells")
    return values[::-1]


# ---- drawing -------------------------------------------------------------------------------------------------------

def ground_image(ground):
    """Colours of the cells."""
    if ground.elevation is None or min(ground.cells.shape) < 2:
        image = np.ones((*ground.cells.shape, 3)) * to_rgb(LEVEL)
    else:
        low, high = elevation_range(ground)
        shade = LightSource(azdeg=315, altdeg=50)
        image = shade.shade(np.clip(ground.elevation, low, high), GROUND, vert_exag=RELIEF, dx=ground.resolution,
                            dy=-ground.resolution, vmin=low, vmax=high, blend_mode="soft")[..., :3]
    image[ground.cells == UNKNOWN] = to_rgb(UNKNOWN_FILL)
    image[ground.cells == OCCUPIED] = to_rgb(OBSTACLE)
    return image


def elevation_range(ground):
    known = ground.elevation[ground.cells != UNKNOWN]
    if known.size == 0 or np.ptp(known) == 0:
        return 0.0, 1.0
    return known.min(), known.max()


def cell_centres(ground):
    """x and y in the map's frame of every cell."""
    rows, columns = ground.cells.shape
    x, y = np.meshgrid((np.arange(columns) + 0.5) * ground.resolution, (np.arange(rows) + 0.5) * ground.resolution)
    points = ground.frame().transform(np.column_stack([x.ravel(), y.ravel()]))
    return points[:, 0].reshape(x.shape), points[:, 1].reshape(y.shape)


def draw_ground(axes, ground):
    width, height = ground.size
    image = axes.imshow(ground_image(ground), origin="lower", extent=(0, width, 0, height), interpolation="nearest",
                        zorder=0)
    image.set_transform(ground.frame() + axes.transData)
    corners = ground.frame().transform([(0, 0), (width, 0), (0, height), (width, height)])
    axes.set_xlim(corners[:, 0].min(), corners[:, 0].max())
    axes.set_ylim(corners[:, 1].min(), corners[:, 1].max())
    if min(ground.cells.shape) >= 2:
        draw_contours(axes, ground)


def draw_contours(axes, ground):
    x, y = cell_centres(ground)
    unknown = ground.cells == UNKNOWN
    if unknown.any() and not unknown.all():
        with plt.rc_context({"hatch.color": UNKNOWN_HATCH, "hatch.linewidth": 0.6}):
            axes.contourf(x, y, unknown.astype(float), levels=[0.5, 1.5], colors="none", hatches=["////"], zorder=1)
    if ground.elevation is not None and np.ptp(ground.elevation) > 0:
        heights = np.ma.masked_where(ground.cells != FREE, ground.elevation)
        if heights.count() > 0 and np.ptp(heights.compressed()) > 0:
            axes.contour(x, y, heights, levels=CONTOURS, colors="#5B4A3A", linewidths=0.5, linestyles="solid",
                         alpha=0.45, zorder=1)


def draw_places(axes, start, goal):
    """Start, x, y and degrees, as a dart that points ahead, and goal, x and y, as a star."""
    x, y, heading = start
    marks = {"markersize": 16, "markeredgecolor": "white", "markeredgewidth": 1.3, "zorder": 6, "clip_on": False}
    axes.plot(x, y, marker=DART.transformed(Affine2D().rotate_deg(heading)), color=plots.INK, **marks)
    axes.plot(*goal, marker="*", color="#C2185B", **{**marks, "markersize": 18})
    for text, point in (("start", (x, y)), ("goal", goal)):
        axes.annotate(text, point, xytext=place_of_label(axes, point), textcoords="offset points", fontsize=10,
                      ha="center", fontweight="bold", zorder=7, path_effects=OUTLINE)


def place_of_label(axes, point):
    """Above a mark, or below where there is no room above."""
    low, high = axes.get_ylim()
    return (0, 12) if point[1] < low + 0.9 * (high - low) else (0, -21)


def legend_entries(ground):
    """(handle, label) of the cells that are not free."""
    entries = [(Patch(facecolor=OBSTACLE), "obstacle")] if (ground.cells == OCCUPIED).any() else []
    if (ground.cells == UNKNOWN).any():
        entries.append((Patch(facecolor=UNKNOWN_FILL, edgecolor=UNKNOWN_HATCH, hatch="////", linewidth=0), "unknown"))
    return entries


def finish_map(figure, axes, ground, entries):
    """Axes in true proportion, and the legend of (handle, label) above them; beside them the scale of elevations."""
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    axes.legend(*zip(*entries), loc="lower left", bbox_to_anchor=(0, 1.01), ncols=2, borderaxespad=0,
                columnspacing=1.6, handlelength=2.6)
    if ground.elevation is not None:
        low, high = elevation_range(ground)
        scale = plt.cm.ScalarMappable(plt.Normalize(low, high), GROUND)
        figure.colorbar(scale, ax=axes, label="elevation, m", shrink=0.8, pad=0.015, aspect=32)


def map_height(ground):
    """Inches that the map takes at full width."""
    corners = ground.frame().transform([(0, 0), (ground.size[0], 0), (0, ground.size[1]), ground.size])
    width, height = np.ptp(corners, axis=0)
    return float(np.clip(WIDTH * height / width, *MAP_HEIGHT))
