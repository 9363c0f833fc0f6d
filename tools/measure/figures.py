"""Collect what the benches measured: into tests/bench/figures.json, and into the pages made of it.

Without FILES everything in build/bench takes the place of what the store holds; with them, what they hold does. A file
NAME.json holds the figures of bench NAME, a file NAME.tables.json holds tables. Prints the figures. Exit status 1: a
bar is newly missed, or a known miss changed, and a line says which; 2: bad input, nothing was written.
"""
from pathlib import Path

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, run, shown_path
from tools.design import robot_json
from tools.measure import core_numbers
from tools.measure.figure_pages import HEADINGS, bar, format_value, measured, row, write_pages
from tools.measure.figure_store import (STORE, TABLES, by_name, check_tables, is_met, read_figures, read_json, read_store,
                                        write_store)


def collect(paths):
    """Figures by their bench, and tables by their names."""
    benches, tables = {}, {}
    for path in paths:
        if path.name.endswith(TABLES):
            content = read_json(path)
            check_tables(path, content)
            tables.update(content)
        else:
            benches[path.stem] = [{key: figure[key] for key in ("name", "value", "unit", "bound", "command")}
                                  for figure in read_figures(path)]
    return benches, tables


def surprises(store):
    """A line for each bar that is newly missed and each known miss that changed."""
    figures = by_name("figures", store)
    known = {miss["name"]: miss["value"] for miss in store["known_misses"]}
    for name, figure in figures.items():
        if not is_met(figure) and name not in known:
            yield f"{name}: {measured(figure)} misses its bar of {bar(figure)}"
    for name, value in known.items():
        if name not in figures:
            yield f"{name}: a known miss, but measured no more"
        elif is_met(figures[name]):
            yield f"{name}: {measured(figures[name])} meets its bar: it is no known miss any more"
        elif format_value(figures[name]["value"]) != format_value(value):
            yield f"{name}: a known miss with {format_value(value)}, but now {measured(figures[name])}"


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("files", metavar="FILE", type=Path, nargs="*",
                        help="NAME.json or NAME.tables.json (default: all in build/bench)")
    return parser.parse_args()


def main():
    options = arguments()
    folder = robot_json.build_directory() / "bench"
    paths = options.files or sorted(folder.glob("*.json"))
    if not paths:
        raise ToolError(f"{folder}: no *.json; run the benches first")
    numbers = core_numbers.check_accepted(core_numbers.ACCEPTED, read_json(core_numbers.ACCEPTED))
    store = read_store(ROOT / STORE)
    benches, tables = collect(paths)
    store["benches"] = {**store["benches"], **benches} if options.files else benches
    store["tables"] = {**store["tables"], **tables} if options.files else tables
    figures = by_name("figures", store)
    pages = write_pages(ROOT, store, numbers)
    write_store(ROOT / STORE, store)

    print_aligned([HEADINGS, *(row(figure) for shown in benches.values() for figure in shown)])
    print(f"\nwrote {', '.join(shown_path(path) for path in [ROOT / STORE, *pages])}: {len(figures)} figures")
    changed = list(surprises(store))
    for line in changed:
        print(line)
    return 1 if changed else 0


if __name__ == "__main__":
    run(main)
