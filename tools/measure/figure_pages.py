"""Pages made of the figures: tests/bench/FIGURES.md, and the marks in the README of each room.

  <!-- figure: NAME -->measured<!-- /figure -->     <!-- bar: NAME -->its bar<!-- /bar -->
  <!-- block: NAME -->
  a table of figures.json, or size, stack or cycles of tests/target/numbers.json
  <!-- /block -->
"""
import os
import re
from dataclasses import dataclass
from pathlib import Path

from tools.common import ROOT, ArgumentParser, ToolError, markdown_table, read_text, run, shown_path, write_whole
from tools.measure import core_numbers
from tools.measure.figure_store import STORE, by_name, is_met, read_json, read_store

PAGE = "tests/bench/FIGURES.md"
SIGNS = {"<=": "≤", ">=": "≥", "==": "="}
THIN_SPACE = "\u202f"  # between thousands; does not break
HEADINGS = ("what", "measured", "bar", "met?", "command")
VALUE_MARK = re.compile(r"<!-- (figure|bar): (.+?) -->([^<]*)<!-- /\1 -->")
BLOCK_MARK = re.compile(r"<!-- block: (\w+) -->\n(.*?)<!-- /block -->", re.S)

INTRODUCTION = """# Figures

Made by `make figures`, which runs the benches; nobody types a figure. Instructions are exact counts in QEMU
(`-icount`), not times. A bar is what a figure must reach; figures without one are only shown. Energies and drives are of simulated
robots, times of the machine that ran the benches."""


@dataclass(frozen=True)
class Section:
    """A part of the page: benches by patterns of their names, and blocks."""
    title: str
    text: str = ""
    benches: str = ""
    blocks: tuple = ()


SECTIONS = (
    Section("Planner", "Rough scenes of 60 × 60 m, 300 × 300 cells × 16 headings. \"Optimum\" is the optimum of the "
            "lattice, proved and compared with a plain Dijkstra. The plain A* is led by what the moves from each cell cost at "
            "least. OMPL's robot turns on the spot at no cost and drives straight in any direction, ours at 16 headings.",
            r"bench_plan|planner(_memory)?"),
    Section("Planner on maps and lattices from elsewhere", "Twelve maps and eleven lattices: SBPL's primitives, priced for "
            "gao2018, and its environments; ROS maps; the Moving AI collection; an elevation model. Three tasks a map, each "
            "with the next lattice, by energy and by length in turn; those without a route after ten tries are left out.",
            r"bench_maps"),
    Section("Plans by the size of the block", blocks=("plan",)),
    Section("Energy against length", "Each metre has a price besides its energy.", blocks=("prices",)),
    Section("Python package", "From a checkout to the first joules by the commands of its README, in a fresh environment, downloads "
            "among them. Planning: office, yard and three maps of hills and walls, for zhang2018 and burger; the planner's "
            "set-up, the search and the route, of the processor.", r"python_\w+"),
    Section("Tutorial", "Each step of [TUTORIAL.md](../../tools/TUTORIAL.md) in a fresh copy with a `.venv` of its own.", r"tutorial"),
    Section("Navigator", "courier24 in closed loop on random maps of 8 to 19 m a side, 8 to 20 % of it blocked, where 3 to 10 "
            "boxes stand that the map does not show; it sees 2.5 m far, where nothing is in between. Touched: its body's "
            "true place; reachable: by a planner that knows the world. On the maps of others, cells of 0.1 m, those of Moving "
            "AI 0.8 m wide: five drives each among eight such boxes.", r"bench_navigate|navigate_maps"),
    Section("Home on what is in the battery", "Robots drawn as in the other benches drive on dense maps with boxes that they do "
            "not show to a goal and home, four times each, and keep what they learn; before a trip a quarter of them become "
            "others, on another ground, and in a third of the trips of wheeled robots the ground changes on the way. At the "
            "border: the battery holds what there and home take with 95 % by the return map, and nobody turns back. In use: "
            "it holds 0.5 to 1.5 times what they are expected to take; the robot turns back at 99.9 %, or does not leave.",
            r"bench_home"),
    Section("In another physics engine", "The robots rebuilt in MuJoCo from their files (`make sil WORLD=mujoco`), driven by the same "
            "controllers over the same bus: reference missions, slopes of 10° for balancers and of the file for others, steps of "
            "5 mm or as much of a smaller wheel, with the tyres of the file and hard ones, friction of 0.2, gears with 1° of play "
            "and sensors 4 ms late, 20 % more payload, pushes; random routes and courses on which the forecast learns.",
            r"mujoco"),
    Section("Navigator of the firmware's image", "courier24 over the bus, which brings it map, goal and what its sensor sees, "
            "on random maps of 192 × 192 and 40 × 40 cells with boxes that they do not show, in process and with the image "
            "in QEMU; the application alone on the core, whose way is blocked again and again, an instruction taking 8 ns; "
            "its planner on the scenes cut to its map.", r"image|image_ticks|bench_cuts"),
    Section("The page in the browser", "In Chromium without a window; drives to their ends, beside the same C compiled for this "
            "machine.", r"page"),
    Section("Grid planner", "Paths over occupancy grids, shortest or of least joules.", r"bench_grid|grid_planner|grid_prices"),
    Section("Segments of any length", "Predicted against driven energy.", r"bench_horizon|horizon"),
    Section("Learner", "Error of the predicted energy after so many segments.", r"bench_learner"),
    Section("Campaign", "Robots that differ from their file, each on a mission of its own.", r"campaign"),
    Section("Missions", "The reference mission in closed loop, and random missions.", r"bench_mission"),
    Section("Routes of short segments", "Energies relative to those of cruise and transients.", r"bench_short"),
    Section("Energy limit", "Driven energy above the least that exists: direct collocation of the non-linear plant through "
            "the same waypoints, with the same speed at the end.", r"limit"),
    Section("Energy limit: scenarios", blocks=("limit_scenarios",)),
    Section("Energy limit: random routes", "Legs of 1 to 15 m, turns to ±120°.", blocks=("limit_routes",)),
    Section("Robots from their data sheets", "Random balancers of 0.3 to 100 kg, designed without a setting of their own; "
            "each drives a random route before it has learned anything.", r"robots", ("random_robots",)),
    Section("Intervals", "Robots that differ from their file learn on a way and are forecast on the next: how many take an "
            "energy inside the 95 % interval that was stated before.", r"intervals", ("intervals",)),
    Section("Robots from their logs", "Robot files that are wrong by 20 % in every constant; tables are made of them, the "
            "robot drives with these, and its constants are identified from the log, its weight and a measured distance.",
            r"logs", ("logs",)),
    Section("Segment optimiser", "Plans against brute force and the paper's Table 3.", r"segment"),
    Section("Energy models", "", r"identify(_battery)?"),
    Section("Battery", "Batteries of a cell's data sheet, drawn by the rule in tests/bench/bench_battery.c: the filter knows "
            "the data sheet alone.", r"bench_battery|battery(_filter)?|cells"),
    Section("Controller", "", r"bench_controller"),
    Section("The patrol robot", "", r"bench_(patrol|patrol_plans|patrol_round|joules|goals)|patrol_energy"),
    Section("The patrol robot by scene", "Improved band / plain band / pure pursuit. Pursuit has arrived at the goal "
            "whatever its heading. Times and energies are the means of those that arrived.", blocks=("patrol",)),
    Section("Skid steer, driven", "Plans on the 20 scenes, driven in closed loop over their hills; energies by the plant's "
            "ledger.", r"bench_skid_drive"),
    Section("Skid steer by itself", "Robots and grounds that differ from their file: what odometry and control are told "
            "of them.", r"skid_(energy|odometry|plant|robot)"),
    Section("Skid steer, forecast", "Plans of ten legs over hills, foretold before and after 20 legs of learning; energies by "
            "the plant's ledger.", r"skid_(changes|plans)"),
    Section("Pure pursuit", "", r"bench_pursuit|pure_pursuit"),
    Section("Pure pursuit by speed", "Largest distance from the path (and root mean square), cm; speeds are those of "
            "straight parts. The tightest bends of the scenes' paths are tighter than the robot can drive; from 1.25 "
            "m/s on it leaves them.", blocks=("pursuit",)),
    Section("Elastic band", "", r"teb"),
    Section("Four wheels", "", r"four_wheel(_plant)?"),
    Section("Laser odometry", "", r"scan_match"),
    Section("Localisation", "On maps of others, against the true pose: wheels that err by up to 3 %, on slippery ground "
            "10 %, of the way; four who walk along with the robot and a box every 2 m that the map does not show; 30 % of "
            "the beams and a second of each half minute without scans.", r"bench_localise"),
    Section("Faulty bus", "Missions on a bus on which frames are lost, late, repeated and corrupt.", r"bench_(skid_)?bus"),
    Section("Bus", "", r"bus|bench_flips|bench_restart|decoders"),
    Section("Parameter store", "", r"store"),
    Section("Fixed point", "Every input, or random ones where there are too many.", r"fixed"),
    Section("Equal bits", "", r"bits"),
    Section("Tests", "", r"coverage|targets"),
    Section("Size", "Bytes. Flash is code and constants of gcc `-Os`, without the compiler's helpers for 64-bit "
            "arithmetic; the planner's block is yours to size.", r"size", ("size",)),
    Section("Stack", "Bytes: the deepest path in the call graph, the worst of `-Os` and `-O2`. Not counted: what the "
            "core pushes for an interrupt, and the functions of your board; those of the STM32F405 are in its column.",
            r"stack", ("stack",)),
    Section("Instructions", "gcc `-O2`, the worst over random inputs.", r"target_.*", ("cycles",)),
)


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


def _with_unit(text, figure):
    return f"{text} {figure['unit']}".strip()


def measured(figure):
    """With its unit; all digits where rounding would hide which of value and bar is the greater."""
    value, bound = figure["value"], figure["bound"]
    shown = format_value(value)
    if bound and value != bound["value"] and _as_number(shown) == _as_number(format_value(bound["value"])):
        shown = repr(value)
    return _with_unit(shown, figure)


def bar_value(figure):
    """With its unit."""
    return _with_unit(format_value(figure["bound"]["value"]), figure)


def bar(figure):
    bound = figure["bound"]
    return "–" if bound is None else f"{SIGNS[bound['op']]} {format_value(bound['value'])}"


def row(figure):
    met = "–" if figure["bound"] is None else "yes" if is_met(figure) else "**no**"
    return figure["name"], measured(figure), bar(figure), met, figure["command"]


def _cell(text):
    return text.replace("|", "\\|")


def table(figures):
    """Those with a bar come first."""
    lines = ["| " + " | ".join(HEADINGS) + " |", "|---|--:|--:|---|---|"]
    for figure in sorted(figures, key=lambda figure: figure["bound"] is None):
        *cells, command = row(figure)
        lines.append("| " + " | ".join([*(_cell(cell) for cell in cells), f"`{command}`"]) + " |")
    return "\n".join(lines)


def miss_table(store):
    figures = by_name("figures", store)
    lines = ["| what | measured | bar | reason |", "|---|--:|--:|---|"]
    for miss in store["known_misses"]:
        name = miss["name"]
        if name not in figures:
            raise ToolError(f"known miss {name!r}: there is no such figure")
        lines.append(f"| {_cell(name)} | {measured(figures[name])} | {bar(figures[name])} | {_cell(miss['reason'])} |")
    return "\n".join(lines)


def block(store, numbers, name):
    if name in core_numbers.UNITS:
        return core_numbers.markdown(numbers[name])
    if name not in store["tables"]:
        raise ToolError(f"block {name}: there is no such table")
    content = store["tables"][name]
    if "lines" in content:
        return "```\n" + "\n".join(content["lines"]) + "\n```"
    return markdown_table(content["headings"], content["rows"])


def section_of(bench):
    for section in SECTIONS:
        if re.fullmatch(section.benches, bench):
            return section
    raise ToolError(f"bench {bench}: belongs to no section: add it to SECTIONS in tools/measure/figure_pages.py")


def page(store, numbers):
    parts = [INTRODUCTION]
    if store["known_misses"]:
        parts.append("## Known misses\n\nBars that are missed, and why.\n\n" + miss_table(store))
    members = {section: [] for section in SECTIONS}
    for bench, figures in store["benches"].items():
        members[section_of(bench)] += figures
    for section in SECTIONS:
        content = [f"## {section.title}", section.text]
        content += [block(store, numbers, name) for name in section.blocks]
        content += [table(members[section])] if members[section] else []
        parts.append("\n\n".join(part for part in content if part))
    return "\n\n".join(parts) + "\n"


def filled(path, text, store, numbers):
    """The text of a Markdown file with what stands between its marks."""
    figures = by_name(path, store)

    def fill_value(match):
        kind, name, _ = match.groups()
        if name not in figures:
            raise ToolError(f"{path}: {kind} {name!r}: there is no such figure")
        figure = figures[name]
        if kind == "bar" and figure["bound"] is None:
            raise ToolError(f"{path}: bar {name!r}: the figure has none")
        shown = measured(figure) if kind == "figure" else bar_value(figure)
        return f"<!-- {kind}: {name} -->{shown}<!-- /{kind} -->"

    def fill_block(match):
        name = match.group(1)
        return f"<!-- block: {name} -->\n{block(store, numbers, name)}\n<!-- /block -->"

    return BLOCK_MARK.sub(fill_block, VALUE_MARK.sub(fill_value, text))


def documents(root):
    """The Markdown files of the repository but the page."""
    found = []
    for folder, folders, files in os.walk(root):
        folders[:] = [name for name in folders if not name.startswith(".") and name != "build"]
        found += [Path(folder) / name for name in files if name.endswith(".md")]
    return sorted(path for path in found if path != root / PAGE)


def write_pages(root, store, numbers):
    """Paths of the files that changed. Nothing is written unless all can be filled in."""
    texts = {root / PAGE: page(store, numbers)}
    texts.update((path, filled(shown_path(path), read_text(path), store, numbers)) for path in documents(root))
    changed = [path for path, text in texts.items() if not path.exists() or read_text(path) != text]
    for path in changed:
        write_whole(path, texts[path])
    return changed


def main():
    ArgumentParser(description="Make FIGURES.md and the figures in the READMEs of figures.json.").parse_args()
    numbers = core_numbers.check_accepted(core_numbers.ACCEPTED, read_json(core_numbers.ACCEPTED))
    changed = write_pages(ROOT, read_store(ROOT / STORE), numbers)
    print("wrote " + ", ".join(shown_path(path) for path in changed) if changed else "nothing changed")
    return 0


if __name__ == "__main__":
    run(main)
