#!/usr/bin/env python3
"""Make a robot's state lattice with jp-lattice: the tables src/tables/lattice_<robot>.c, or a file for jp-plan.

Of a robot that finds its way it also makes src/tables/navigation_<robot>.c: the disc in which it turns. Where the
lattice sweeps its rectangle it makes one that sweeps the disc, too: lattice_<robot>_navigation.c.

With --import, the primitives come from an SBPL .mprim file or a Nav2 lattice .json file; jp-lattice sweeps and prices
them for the robot. With --json, jp-plan --lattice plans on the result, without a compiler.

That file: {"format": "joulepath-lattice-1", "robot", and the members of struct jp_lattice (joulepath/lattice.h) in
their units: "resolution", "heading", "primitives", "moves", "spans", "footprint", "reach", "core", "move_costs"}, each
a list of rows: members of members in their order there, move_costs a row each kind of cost and of move.
Exit status 2: bad input; nothing was written.
"""
import json
import math
import re
import tempfile
from pathlib import Path

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, read_text, run, shown_path, write_whole
from tools.design import c_tables, lattice_import, robot_json

FORMAT = "joulepath-lattice-1"  # of the file for jp-plan

HEADINGS = 16
KINDS = ("physical", "paper", "distance")
MOVES = ("axis", "knight", "diagonal")

ROM_MAX = 32 * 1024
# Bytes on a 32-bit core: struct jp_primitive, an index, a span, struct jp_lattice.
PRIMITIVE_SIZE, INDEX_SIZE, SPAN_SIZE, LATTICE_SIZE = 20, 2, 3, 632

UNITS_PER_JOULE = 16  # JP_COST_PER_JOULE
STEP_UNITS_MIN = 5  # of a step, below which it is said that rounding shows
BRANCHES_MAX = 255  # JP_PRIMITIVES_PER_HEADING_MAX

# What the members of struct jp_primitive hold: name, unit, per unit, most.
BASES = [("its energy on top of that of its steps", " J", UNITS_PER_JOULE, 65535),
         ("its energy by the paper on top of that of its steps", " J", UNITS_PER_JOULE, 65535),
         ("its price by distance on top of that of its steps", " m", 1000, 65535)]
LENGTH = ("its length", " m", 1000, 65535)
DURATION = ("its duration", " s", 1000, 65535)
FIRST_MOVE = ("the place of its moves", "", 1, 65535)
FIRST_SPAN = ("the place of its spans", "", 1, 65535)
SPAN_COUNT = ("the number of its spans", "", 1, 255)

LINE_WIDTH = 120


class Pool:
    """One table that holds many lists; equal runs are stored once."""

    def __init__(self):
        self.items = []
        self._known = {}
        self._places = {}  # of each item

    def place(self, items):
        """Index of the first of `items`, which stand in a row."""
        key = tuple(items)
        if key not in self._known:
            self._known[key] = self._find(key)
        return self._known[key]

    def _find(self, key):
        for first in self._places.get(key[0], ()) if key else (0,):
            if tuple(self.items[first:first + len(key)]) == key:
                return first
        first = len(self.items)
        for place, item in enumerate(key, first):
            self._places.setdefault(item, []).append(place)
        self.items.extend(key)
        return first


class Tables:
    """A lattice of jp-lattice, laid out for struct jp_lattice."""

    def __init__(self, name, data, label=None):
        self.name = name
        self.label = label or name  # in errors
        self.data = data
        self.primitives = sorted(data["primitives"], key=lambda primitive: primitive["start"])
        self.by_end = sorted(range(len(self.primitives)), key=lambda i: self.primitives[i]["end"])
        self.first_from = self._offsets("start")
        self.first_to = self._offsets("end")
        self.moves, self.spans = Pool(), Pool()
        self.rows = [self._row(i, primitive) for i, primitive in enumerate(self.primitives)]
        self.footprint = [self._cells(cells) for cells in data["footprint"]]
        self.reach = [self._cells(cells) for cells in data["reach"]]
        self.core = self._cells(data["core"])
        self._check_limits()

    def check_rom(self):
        if self.rom_size > ROM_MAX:
            raise ToolError(f"{self.label}: {self.rom_size} bytes of tables, at most {ROM_MAX} are allowed; "
                            "import fewer primitives, or larger cells, or make a file with --json")

    def _check_limits(self):
        branches = max(last - first for first, last in zip(self.first_from, self.first_from[1:]))
        if branches > BRANCHES_MAX:
            raise ToolError(f"{self.label}: {branches} primitives start at one heading, at most {BRANCHES_MAX} are "
                            "allowed; import fewer")

    @property
    def rom_size(self):
        return (PRIMITIVE_SIZE * len(self.rows) + INDEX_SIZE * len(self.by_end) + len(self.moves.items)
                + SPAN_SIZE * len(self.spans.items) + LATTICE_SIZE)

    def _offsets(self, key):
        return [sum(primitive[key] < heading for primitive in self.primitives) for heading in range(HEADINGS + 1)]

    def _checked(self, index, quantity, value):
        """A value that its member holds."""
        what, unit, per_unit, high = quantity
        primitive = self.primitives[index]
        if value > high:
            moves = primitive["dx"] or primitive["dy"]
            advice = (f"cells of at most {0.99 * self.data['resolution_m'] * high / value:.2g} m, or shorter primitives"
                      if moves else "smaller turns")
            raise ToolError(f"{self.label}: primitive {index} (heading {primitive['start']}, to cell "
                            f"{primitive['dx']}, {primitive['dy']}): {what} is {value / per_unit:g}{unit}, the tables "
                            f"hold at most {high / per_unit:g}{unit}; import {advice}")
        return value

    def _cells(self, rows):
        rows = [tuple(row) for row in rows]
        return self.spans.place(rows), len(rows)

    def _row(self, index, primitive):
        first_span, span_count = self._cells(primitive["swept"])
        base = tuple(self._checked(index, quantity, cost) for quantity, cost in zip(BASES, primitive["base"]))
        length = self._checked(index, LENGTH, round(1000 * primitive["length_m"]))
        duration = self._checked(index, DURATION, round(1000 * primitive["duration_s"]))
        first_move = self.moves.place(primitive["moves"])
        self._checked(index, FIRST_MOVE, first_move)
        self._checked(index, FIRST_SPAN, first_span)
        self._checked(index, SPAN_COUNT, span_count)
        states = tuple(primitive[key] for key in ("dx", "dy", "start", "end"))
        return states, base, (length, duration, first_move, first_span, len(primitive["moves"]), span_count)


def row_text(row):
    states, base, rest = (", ".join(map(str, part)) for part in row)
    return f"{{{states}, {{{base}}}, {rest}}}"


def filled(items):
    """Items in lines of the width of the code."""
    lines, line = [], "   "
    for item in items:
        if len(line) + len(item) + 2 > LINE_WIDTH:
            lines.append(line)
            line = "   "
        line += f" {item},"
    return "\n".join([*lines, line])


def cells_text(cells):
    return f"{{{cells[0]}, {cells[1]}}}"


def move_cost_text(cost):
    climb, descend = (", ".join(map(str, cost[side])) for side in ("climb", "descend"))
    return f"{{{{{climb}}}, {{{descend}}}, {cost['bend']}, {cost['rise_max']}, {cost['floor']}}}"


def move_costs_text(costs):
    blocks = []
    for kind, cost in zip(KINDS, costs):
        rows = "\n".join(f"            {move_cost_text(move)}, /* {name} */"
                         for name, move in zip(MOVES, cost["moves"]))
        blocks.append(f"        {{\n            /* {kind} */\n{rows}\n        }},")
    return "\n".join(blocks)


def angle(radians):
    """A wrapping binary angle."""
    return round(radians / (2 * math.pi) * 2**32) % 2**32


def resolution(data):
    return round(data["resolution_m"] * 65536)


def arrays_text(tables):
    spans = filled("{%d, %d, %d}" % span for span in tables.spans.items)
    return f"""static const struct jp_primitive primitives[] = {{
    /* dx, dy, start, end, {{base}}, length, duration, first_move, first_span, move_count, span_count */
{chr(10).join(f"    {row_text(row)}," for row in tables.rows)}
}};

static const uint16_t by_end[] = {{
{filled(map(str, tables.by_end))}
}};

static const uint8_t moves[] = {{
{filled(map(str, tables.moves.items))}
}};

static const struct jp_span spans[] = {{
{spans}
}};"""


def lattice_text(tables):
    data = tables.data
    return f"""const struct jp_lattice jp_lattice_{tables.name} = {{
    .name = "{tables.name}",
    .resolution = {resolution(data)}, /* {data["resolution_m"]:g} m */
    .heading = {{
{filled(f"{angle(heading)}U" for heading in data["headings_rad"])}
    }},
    .primitives = primitives,
    .by_end = by_end,
    .moves = moves,
    .spans = spans,
    .first_from = {{
{filled(map(str, tables.first_from))}
    }},
    .first_to = {{
{filled(map(str, tables.first_to))}
    }},
    .footprint = {{
{filled(map(cells_text, tables.footprint))}
    }},
    .reach = {{
{filled(map(cells_text, tables.reach))}
    }},
    .core = {cells_text(tables.core)},
    .move_costs = {{
{move_costs_text(data["costs"])}
    }},
}};"""


def table_text(tables, command, source):
    return f"""/* Generated by `{command}` from {source}; do not edit.
 * {len(tables.rows)} primitives on cells of {tables.data["resolution_m"]:g} m, {tables.rom_size} bytes.
 */
#include <joulepath/lattice.h>

/* clang-format off */
{arrays_text(tables)}

{lattice_text(tables)}

_Static_assert(
    sizeof primitives + sizeof by_end + sizeof moves + sizeof spans + sizeof jp_lattice_{tables.name} <= {ROM_MAX}U,
    "the tables of one lattice take at most {ROM_MAX} bytes");
/* clang-format on */
"""


def members(tables):
    """The members of struct jp_lattice, as lists of rows."""
    data = tables.data
    moves = (move for costs in data["costs"] for move in costs["moves"])
    return {
        "resolution": [resolution(data)],
        "heading": [angle(heading) for heading in data["headings_rad"]],
        "primitives": [states + base + rest for states, base, rest in tables.rows],
        "moves": tables.moves.items,
        "spans": tables.spans.items,
        "footprint": tables.footprint,
        "reach": tables.reach,
        "core": [tables.core],
        "move_costs": [[*move["climb"], *move["descend"], move["bend"], move["rise_max"], move["floor"]]
                       for move in moves],
    }


def file_text(tables):
    """The lattice for jp-plan, a line a member."""
    content = {"format": FORMAT, "robot": tables.data["robot"], **members(tables)}
    return "{\n" + ",\n".join(f'"{key}": {json.dumps(value)}' for key, value in content.items()) + "\n}\n"


def skid_steer_table(name, data, command, source):
    """The C table of a skid-steered robot's constants; ranges as in joulepath/skid_steer.h."""
    to = c_tables.Converter(f"skid-steer constants of {name}")
    members = [
        to.q24("wheel_radius", data["wheel_radius_m"], "m", 0.01, 1),
        to.q24("width", data["width_m"], "m", 0.05, 4),
        to.q24("wheelbase", data["wheelbase_m"], "m", 0, 4),
        to.q16("weight", data["weight_n"], "N", 1, 16384),
        to.q24("rolling", data["rolling"], "", 0, 0.5),
        to.q24("friction", data["friction"], "", 0, 2),
        to.q16("torque_per_ampere", data["torque_per_ampere"], "N·m/A", 0.01, 16384),
        to.q24("resistance", data["resistance_ohm"], "Ω", 0, 100),
        to.q24("efficiency", data["efficiency"], "", 0.1, 1),
        to.q24("recuperation", data["recuperation"], "", 0, 1),
        to.q16("electronics_power", data["electronics_power_w"], "W", 0, 1024),
        to.q16("distance_energy", data["distance_j_per_m"], "J/m", 0, 1024),
    ]
    return c_tables.Table(command, source, "", "joulepath/skid_steer.h", "jp_skid_steer_config",
                          f"jp_skid_steer_{name}", members)


def navigation_table(name, data, command, source):
    """The C table jp_navigation_<name> of the disc in which a robot turns that finds its way."""
    to = c_tables.Converter(f"navigation of {name}")
    members = [to.q16("radius", data["radius_m"], "m", 0.01, 16), to.q16("margin", data["margin_m"], "m", 0.0001, 16)]
    return c_tables.Table(command, source, "", "joulepath/navigator_body.h", "jp_navigator_body", f"jp_navigation_{name}",
                          members)


def run_jp_lattice(robot_path, options):
    """What jp-lattice makes for a robot."""
    program = robot_json.build_directory() / "bin" / "jp-lattice"
    with tempfile.TemporaryDirectory() as directory:
        robot_json.printed_by(program, robot_path, "--output", directory, *options)
        return json.loads(read_text(Path(directory) / "lattice.json"))


def run_on_primitives(robot_path, path, primitives):
    """What jp-lattice makes of primitives read from a file, which its complaints then name."""
    with tempfile.TemporaryDirectory() as directory:
        intermediate = Path(directory) / "primitives.json"
        write_whole(intermediate, json.dumps(primitives))
        try:
            return run_jp_lattice(robot_path, ["--primitives", intermediate])
        except ToolError as error:
            raise ToolError(str(error).replace(str(intermediate), str(path))) from None


def generated(robot_path):
    """A lattice that jp-lattice chooses, and what made it."""
    data = run_jp_lattice(robot_path, [])
    return Tables(robot_path.stem, data), f"make lattice ROBOT={robot_path.stem}", f"sim/robots/{robot_path.name}"


def imported(robot_path, path):
    """A lattice whose primitives another planner made, and what made it."""
    found = lattice_import.read_primitives(path)
    for note in found.notes:
        print(f"{shown_path(path)}: {note}")
    name = re.sub(r"[^a-z0-9]+", "_", f"{robot_path.stem}_{path.stem}".lower())
    data = run_on_primitives(robot_path, path, found.input)
    command = f"python -m tools.design.lattice {robot_path.stem} --import {path.name}"
    return Tables(name, data, shown_path(path)), command, path.name


def navigation_tables(robot_path):
    """The lattice of the disc in which a robot turns."""
    return Tables(f"{robot_path.stem}_navigation", run_jp_lattice(robot_path, ["--navigation"]))


def lattice_file(directory, tables, command, source):
    tables.check_rom()
    return {directory / f"lattice_{tables.name}.c": table_text(tables, command, source)}


def c_files(directory, robot_path, tables, command, source):
    files = lattice_file(directory, tables, command, source)
    if "skid_steer" in tables.data and tables.name == robot_path.stem:
        table = skid_steer_table(tables.name, tables.data["skid_steer"], command, source)
        files[directory / f"skid_steer_{tables.name}.c"] = c_tables.render(table)
    if "navigation" in tables.data and tables.name == robot_path.stem:
        table = navigation_table(tables.name, tables.data["navigation"], command, source)
        files[directory / f"navigation_{tables.name}.c"] = c_tables.render(table)
        if not tables.data["navigation"]["is_swept"]:
            files |= lattice_file(directory, navigation_tables(robot_path), command, source)
    return files


def rounding_note(data):
    """On cells so small that the rounding of energies to whole units shows."""
    units = data["costs"][0]["moves"][0]["climb"][0] / 65536  # of a level step along an axis
    if units >= STEP_UNITS_MIN:
        return ""
    what = ("less than one: plans by energy count steps, trust those by distance" if units < 1
            else "and each primitive is rounded to whole ones")
    return (f"a step of {data['resolution_m']:g} m takes {units / UNITS_PER_JOULE:.2g} J, {units:.2g} of the units in "
            f"which energies are counted, {what}; larger cells are counted better")


def print_lattice(data):
    """The primitives of the first quarter's headings; energies on level ground."""
    rows = [("heading", "to cell", "to heading", "length", "duration", "turning", "turning, paper")]
    for primitive in data["primitives"]:
        if primitive["start"] <= 2:
            physical, paper, _ = primitive["base"]
            rows.append((str(primitive["start"]), f"{primitive['dx']}, {primitive['dy']}", str(primitive["end"]),
                         f"{primitive['length_m']:.3f} m", f"{primitive['duration_s']:.2f} s",
                         f"{physical / UNITS_PER_JOULE:.1f} J", f"{paper / UNITS_PER_JOULE:.1f} J"))
    print_aligned(rows)


def arguments():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("robot", help="robot file, or the name of one in sim/robots")
    parser.add_argument("--import", dest="source", metavar="FILE", type=Path,
                        help="primitives of an SBPL .mprim or a Nav2 lattice .json file; the table is then "
                             "lattice_<robot>_<file>.c")
    parser.add_argument("--tables", metavar="DIR", type=Path, default=ROOT / "src" / "tables",
                        help="where the C files go (default: src/tables)")
    parser.add_argument("--json", metavar="FILE", type=Path,
                        help="in place of the C files, a file for jp-plan --lattice")
    return parser.parse_args()


def main():
    options = arguments()
    robot_path = robot_json.robot_path(options.robot)
    made = imported(robot_path, options.source) if options.source else generated(robot_path)
    tables = made[0]
    if options.json:
        if options.source and options.json.exists() and options.json.samefile(options.source):
            raise ToolError(f"{options.json}: is read for this lattice; name another file for the result")
        files = {options.json: file_text(tables)}
    else:
        robot_json.check_name(robot_path, tables.data["robot"])
        files = c_files(options.tables, robot_path, *made)
    print_lattice(tables.data)
    if rounding_note(tables.data):
        print(f"{tables.label}: {rounding_note(tables.data)}")
    for path, content in files.items():
        write_whole(path, content)
        print(f"wrote {shown_path(path)}")
    return 0


if __name__ == "__main__":
    run(main)
