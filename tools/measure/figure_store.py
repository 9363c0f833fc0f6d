"""The committed figures: tests/bench/figures.json.

  known_misses  written by people: figures that miss their bar, with the value that they then have and the reason
  benches       figures by the name of the bench that measured them: name, value, unit, bound, command
  tables        tables of the benches, and frames of a drive

`bound` is the figure's bar, or null. Only the bench that measures a figure knows its bar.
"""
import json
import math
import operator
from pathlib import Path

from tools.common import ToolError, read_text, write_whole

STORE = "tests/bench/figures.json"
KEYS = {"name": str, "value": (int, float), "unit": str, "bound": (dict, type(None)), "command": str}
COMPARE = {"<=": operator.le, ">=": operator.ge, "==": operator.eq}
TABLES = ".tables.json"  # ends the name of a file of tables


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def read_json(path):
    try:
        return json.loads(read_text(path))
    except ValueError as error:
        raise ToolError(f"{path}: no JSON: {error}") from None


def check_figure(place, figure):
    if not isinstance(figure, dict):
        raise ToolError(f"{place}: must be an object")
    for key, kind in KEYS.items():
        if key not in figure or not isinstance(figure[key], kind):
            raise ToolError(f"{place}: {key} is missing or of the wrong type")
    if not is_number(figure["value"]):
        raise ToolError(f"{place}: value is not a finite number")
    bound = figure["bound"]
    if bound is not None and (bound.get("op") not in COMPARE or not is_number(bound.get("value"))):
        raise ToolError(f'{place}: bound must be null or {{"op": "<=", ">=" or "==", "value": number}}')


def check_figures(place, figures):
    if not isinstance(figures, list):
        raise ToolError(f"{place}: must be a list of figures")
    for index, figure in enumerate(figures):
        check_figure(f"{place}: figure {index}", figure)


def read_figures(path):
    """Those of one bench."""
    figures = read_json(path)
    check_figures(path, figures)
    return figures


def _is_list(value, kind):
    return isinstance(value, list) and all(isinstance(item, kind) for item in value)


def check_tables(place, tables):
    """Each is {"headings", "rows"}, or {"lines"} of a text."""
    if not isinstance(tables, dict):
        raise ToolError(f"{place}: must be tables by name")
    for name, table in tables.items():
        members = table if isinstance(table, dict) else {}
        is_table = _is_list(members.get("headings"), str) and _is_list(members.get("rows"), list)
        if not is_table and not _is_list(members.get("lines"), str):
            raise ToolError(f"{place}: {name}: must hold headings and rows, or lines")


def check_misses(place, misses):
    if not isinstance(misses, list):
        raise ToolError(f"{place}: known_misses: must be a list")
    for index, miss in enumerate(misses):
        if not isinstance(miss, dict) or not isinstance(miss.get("name"), str) or not is_number(miss.get("value")):
            raise ToolError(f"{place}: known miss {index}: must have name and value")
        if not isinstance(miss.get("reason"), str) or not miss["reason"].strip():
            raise ToolError(f"{place}: known miss {index}: {miss['name']}: the reason is missing")


def by_name(place, store):
    """{name: figure} of all benches; a name stands once."""
    found, benches = {}, {}
    for bench, figures in store["benches"].items():
        for figure in figures:
            name = figure["name"]
            if name in found:
                raise ToolError(f"{place}: {bench}: {name!r} stands in {benches[name]} too")
            found[name], benches[name] = figure, bench
    return found


def read_store(path):
    store = read_json(path)
    if not isinstance(store, dict) or not isinstance(store.get("benches"), dict):
        raise ToolError(f"{path}: must hold known_misses, benches and tables")
    check_misses(path, store.get("known_misses"))
    for bench, figures in store["benches"].items():
        check_figures(f"{path}: {bench}", figures)
    check_tables(path, store.get("tables"))
    by_name(path, store)
    return store


def _json(value, depth, indent=""):
    """JSON in which the containers of the first `depth` levels have a line for each member."""
    if depth == 0 or not isinstance(value, (dict, list)) or not value:
        return json.dumps(value, ensure_ascii=False)
    inner = indent + " "
    if isinstance(value, dict):
        members = [f"{json.dumps(key, ensure_ascii=False)}: {_json(member, depth - 1, inner)}"
                   for key, member in value.items()]
        opening, closing = "{", "}"
    else:
        members = [_json(member, depth - 1, inner) for member in value]
        opening, closing = "[", "]"
    lines = ",\n".join(inner + member for member in members)
    return f"{opening}\n{lines}\n{indent}{closing}"


def write_store(path, store):
    """A line for each miss, figure and row, so that a diff shows what changed."""
    parts = {"known_misses": _json(store["known_misses"], 1, " "),
             "benches": _json(dict(sorted(store["benches"].items())), 2, " "),
             "tables": _json(dict(sorted(store["tables"].items())), 3, " ")}
    write_whole(path, "{\n" + ",\n".join(f' "{key}": {text}' for key, text in parts.items()) + "\n}\n")


def write_tables(path, tables):
    """{name: (headings, rows)}, for tools/measure/figures.py."""
    content = {name: {"headings": list(headings), "rows": [list(row) for row in rows]}
               for name, (headings, rows) in tables.items()}
    write_whole(path, json.dumps(content, indent=1, ensure_ascii=False) + "\n")


def is_met(figure):
    bound = figure["bound"]
    return bound is None or COMPARE[bound["op"]](figure["value"], bound["value"])
