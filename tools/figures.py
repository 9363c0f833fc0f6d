#!/usr/bin/env python3
"""Collect the benches' results and put them into the README.

Merges build/bench/*.json into build/figures.json, prints the table, and rewrites it in the README between
<!-- figures --> and <!-- /figures -->. Exit status 1: a figure misses its bar (the table says so); 2: bad input,
nothing was written.
"""
import argparse
import json
import math
import operator
from pathlib import Path

import robot_json
from common import ROOT, ToolError, print_aligned, read_text, run, shown_path, with_block, write_whole

KEYS = {"name": str, "value": (int, float), "unit": str, "bound": (dict, type(None)), "command": str}
COMPARE = {"<=": operator.le, ">=": operator.ge, "==": operator.eq}
SIGNS = {"<=": "≤", ">=": "≥", "==": "="}

THIN_SPACE = "\u202f"  # between thousands; does not break
HEADINGS = ("what", "measured", "bar", "met?", "command")


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def check(path, index, figure):
    place = f"{path}: figure {index}"
    if not isinstance(figure, dict):
        raise ToolError(f"{place}: must be an object")
    for key, kind in KEYS.items():
        if key not in figure or not isinstance(figure[key], kind):
            raise ToolError(f"{place}: {key} is missing or of the wrong type")
    if not _is_number(figure["value"]):
        raise ToolError(f"{place}: value is not a finite number")
    bound = figure["bound"]
    if bound is not None and (bound.get("op") not in COMPARE or not _is_number(bound.get("value"))):
        raise ToolError(f'{place}: bound must be null or {{"op": "<=", ">=" or "==", "value": number}}')


def read_bench(path):
    try:
        figures = json.loads(read_text(path))
    except ValueError as error:
        raise ToolError(f"{path}: no JSON: {error}") from None
    if not isinstance(figures, list):
        raise ToolError(f"{path}: must be a list of figures")
    for index, figure in enumerate(figures):
        check(path, index, figure)
    return figures


def collect(directory):
    """All figures, by file name and then in their own order."""
    paths = sorted(directory.glob("*.json"))
    if not paths:
        raise ToolError(f"{directory}: no *.json; run the benches first")
    figures, seen = [], {}
    for path in paths:
        for figure in read_bench(path):
            name = figure["name"]
            if name in seen:
                raise ToolError(f"{path}: {name!r} stands in {seen[name]} too")
            seen[name] = path
            figures.append({key: figure[key] for key in KEYS})
    return figures


def is_met(figure):
    bound = figure["bound"]
    return bound is None or COMPARE[bound["op"]](figure["value"], bound["value"])


def format_value(value):
    """Three digits or so for a person; whole numbers exactly."""
    if float(value).is_integer() and abs(value) < 1e15:
        return f"{int(value):,}".replace(",", THIN_SPACE)
    magnitude = abs(value)
    if magnitude >= 1000:
        return f"{value:,.1f}".replace(",", THIN_SPACE)
    if magnitude >= 1:
        return f"{value:.2f}"
    return f"{value:.3g}"


def _as_number(text):
    return float(text.replace(THIN_SPACE, ""))


def _distinct(figure):
    """Measured and bar as text; all digits where rounding would hide which is the greater."""
    value, bound = figure["value"], figure["bound"]
    if bound is None:
        return format_value(value), "–"
    shown, bar = format_value(value), format_value(bound["value"])
    if value != bound["value"] and _as_number(shown) == _as_number(bar):
        shown = repr(value)
    return shown, f"{SIGNS[bound['op']]} {bar}"


def rows(figures):
    for figure in figures:
        measured, bar = _distinct(figure)
        met = "–" if figure["bound"] is None else "yes" if is_met(figure) else "**no**"
        yield figure["name"], f"{measured} {figure['unit']}".strip(), bar, met, figure["command"]


def table(figures):
    lines = ["| " + " | ".join(HEADINGS) + " |", "|---|--:|--:|---|---|"]
    for name, measured, bar, met, command in rows(figures):
        cells = [cell.replace("|", "\\|") for cell in (name, measured, bar, met)]
        lines.append("| " + " | ".join([*cells, f"`{command}`"]) + " |")
    return "\n".join(lines)


def markdown(figures):
    """Those with a bar; the others can be unfolded."""
    rest = [figure for figure in figures if figure["bound"] is None]
    text = table([figure for figure in figures if figure["bound"] is not None])
    if rest:
        text += f"\n\n<details>\n<summary>{len(rest)} more, without a bar</summary>\n\n{table(rest)}\n\n</details>"
    return text


def arguments():
    build = robot_json.build_directory()
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--bench", metavar="DIR", type=Path, default=build / "bench", help="default: build/bench")
    parser.add_argument("--output", metavar="FILE", type=Path, default=build / "figures.json",
                        help="default: build/figures.json")
    parser.add_argument("--readme", metavar="FILE", type=Path, default=ROOT / "README.md", help="default: README.md")
    return parser.parse_args()


def main():
    options = arguments()
    figures = collect(options.bench)
    readme = with_block(options.readme, read_text(options.readme), "figures", markdown(figures))
    write_whole(options.output, json.dumps(figures, indent=2, ensure_ascii=False) + "\n")
    write_whole(options.readme, readme)

    print_aligned([HEADINGS, *rows(figures)])
    missed = [figure["name"] for figure in figures if not is_met(figure)]
    print(f"\nwrote {shown_path(options.output)} and {shown_path(options.readme)}: {len(figures)} figures, "
          f"{len(missed)} below the bar")
    return 1 if missed else 0


if __name__ == "__main__":
    run(main)
