"""What the reports share: reading the results of the host programs, and the page."""
import csv
import io
import json
import math
from pathlib import Path

import jinja2
import numpy as np

from tools.common import ToolError, read_text

ROWS_MAX = 2_000_000


# ---- results -------------------------------------------------------------------------------------------------------

def read_json(path):
    try:
        return json.loads(read_text(path))
    except ValueError as error:
        raise ToolError(f"{path}: no JSON: {error}") from None


def need(path, place, data, keys):
    if not isinstance(data, dict):
        raise ToolError(f"{path}: {place}: must be an object")
    for key in keys:
        if key not in data:
            raise ToolError(f"{path}: {place}: key {key} is missing")


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def need_numbers(path, place, data, keys):
    need(path, place, data, keys)
    for key in keys:
        if not is_number(data[key]):
            raise ToolError(f"{path}: {place}: {key} is {data[key]!r}, not a number")


def need_texts(path, place, data, keys, least=1):
    """Texts of at least so many characters."""
    need(path, place, data, keys)
    for key in keys:
        if not isinstance(data[key], str) or len(data[key]) < least:
            raise ToolError(f"{path}: {place}: {key} must be a text")


def need_vector(path, place, value, length):
    if not (isinstance(value, list) and len(value) == length and all(map(is_number, value))):
        raise ToolError(f"{path}: {place}: must be {length} numbers")


def need_point(path, place, value):
    if not (isinstance(value, list) and len(value) == 2 and all(map(is_number, value))):
        raise ToolError(f"{path}: {place}: must be [x, y]")


def need_points(path, place, points):
    if not isinstance(points, list):
        raise ToolError(f"{path}: {place}: must be a list")
    for i, point in enumerate(points):
        need_point(path, f"{place}[{i}]", point)


def need_list(path, place, value):
    if not isinstance(value, list) or not value:
        raise ToolError(f"{path}: {place}: must be a list that is not empty")


def read_columns(path, names, rows_min=2, texts=()):
    """The columns of a CSV file, by name: all of numbers but those named in texts."""
    reader = csv.reader(io.StringIO(read_text(path)))
    header = next(reader, [])
    missing = [name for name in (*names, *texts) if name not in header]
    if missing:
        raise ToolError(f"{path}: line 1: column {missing[0]} is missing")
    kinds = [str if name in texts else float for name in header]
    rows = []
    for row in reader:
        try:
            rows.append([kind(cell) for kind, cell in zip(kinds, row)])
        except ValueError:
            raise ToolError(f"{path}: line {reader.line_num}: not a number") from None
        if len(row) != len(header) or not all(math.isfinite(value) for value in rows[-1] if isinstance(value, float)):
            raise ToolError(f"{path}: line {reader.line_num}: {len(header)} finite values expected")
        if len(rows) > ROWS_MAX:
            raise ToolError(f"{path}: more than {ROWS_MAX} lines")
    if len(rows) < rows_min:
        raise ToolError(f"{path}: fewer samples than {rows_min}")
    return {name: np.array(column) for name, column in zip(header, zip(*rows))}


# ---- page ----------------------------------------------------------------------------------------------------------

def format_number(value, digits=2, unit=""):
    """A number with a narrow no-break space between thousands, a true minus and its unit; – for none."""
    if value is None:
        return "–"
    text = f"{value:,.{digits}f}".replace(",", "\u202f").replace("-", "−")
    return f"{text}\u202f{unit}" if unit else text


def render_page(template, **data):
    """A page of tools/report/<template>, which extends page.html.j2."""
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(Path(__file__).parent), autoescape=True,
                                     undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["number"] = format_number
    return environment.get_template(template).render(**data)
