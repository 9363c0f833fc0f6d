"""A map by its cells, with what is there and not on it, and a robot on it, for the reports of patrols."""
import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.patches import Polygon
from matplotlib.transforms import Affine2D

from tools.common import ToolError
from tools.report.results import need, need_numbers

FREE, SOLID, UNKNOWN, HIDDEN = ".#?o"
FILLS = {FREE: "#FBFCFD", SOLID: "#6B7580", UNKNOWN: "#E6EAEE", HIDDEN: "#E2A93B"}

MARGIN = 2.5             # m, around the drives
SHAPE = 0.6              # least width over height of what is shown, and height over width


def check_map(path, ground):
    need(path, "map", ground, ("width", "height", "resolution_m", "rows"))
    need_numbers(path, "map", ground, ("width", "height", "resolution_m"))
    rows = ground["rows"]
    if not (isinstance(rows, list) and len(rows) == ground["height"] > 0
            and all(isinstance(row, str) and len(row) == ground["width"] and set(row) <= set(FILLS) for row in rows)):
        raise ToolError(f"{path}: map.rows: is no grid of {ground['height']} rows of {ground['width']} cells")


def map_window(ground, points):
    """West, east, south and north of what is shown: the points, and some of the map around."""
    low = np.min(points, axis=0) - MARGIN
    high = np.max(points, axis=0) + MARGIN
    size = np.array([ground["width"], ground["height"]]) * ground["resolution_m"]
    widen = np.maximum(SHAPE * (high - low)[::-1] - (high - low), 0) / 2
    low, high = low - widen, high + widen
    # What is only a little more is shown to its end.
    low = np.where(low < MARGIN, 0, low)
    high = np.where(high > size - MARGIN, size, high)
    return low[0], high[0], low[1], high[1]


def draw_ground(axes, ground):
    cells = np.array([list(row) for row in ground["rows"]][::-1])
    image = np.empty((*cells.shape, 3))
    for symbol, colour in FILLS.items():
        image[cells == symbol] = to_rgb(colour)
    resolution = ground["resolution_m"]
    axes.imshow(image, origin="lower", extent=(0, ground["width"] * resolution, 0, ground["height"] * resolution),
                interpolation="nearest", zorder=0)


def placed(points, x, y, heading):
    return Affine2D().rotate_deg(heading).translate(x, y).transform(points)


def rectangle(length, width):
    return np.array([(-length, -width), (length, -width), (length, width), (-length, width)]) / 2


def draw_robot(axes, size, pose, **look):
    """The robot's outline, with a dart that points ahead."""
    length, width = size
    dart = np.array([(0.5 * length, 0), (0.28 * length, 0.16 * width), (0.28 * length, -0.16 * width)])
    axes.add_patch(Polygon(placed(rectangle(length, width), *pose), closed=True, **look))
    axes.add_patch(Polygon(placed(dart, *pose), closed=True, **{**look, "facecolor": look["edgecolor"]}))
