"""Numbers of the library on its five cores: how they are kept, shown and compared.

A kind of numbers (size, stack, cycles) is a table: rows by name, and in a row a value for each core.
"""
import json
import subprocess

from tools.common import ROOT, ToolError, build_directory, print_aligned, read_text, write_whole

# Names of the cores by that of their variants in the Makefile, in the order of the columns.
CORES = {"cortex-m0": "Cortex-M0", "cortex-m3": "Cortex-M3", "cortex-m4": "Cortex-M4", "cortex-m7": "Cortex-M7",
         "rv32": "RV32"}

# The image of a board, measured beside the cores.
FIRMWARE, BOARD_NAME = "firmware", "STM32F405"

UNITS = {"size": "B", "stack": "B", "cycles": "instructions"}
ACCEPTED = ROOT / "tests/target/numbers.json"


def core_of(variant):
    """The name of the core that a variant is built for."""
    for prefix, name in {**CORES, FIRMWARE: BOARD_NAME}.items():
        if variant == prefix or variant.startswith(prefix + "-"):
            return name
    raise ToolError(f"{variant}: no variant of a core; must begin with one of {', '.join(CORES)}")


def measured_path(kind):
    return build_directory() / "numbers" / f"{kind}.json"


def write_measured(kind, table):
    write_whole(measured_path(kind), json.dumps(table, indent=2) + "\n")


def read_json(path):
    try:
        return json.loads(read_text(path))
    except ValueError as error:
        raise ToolError(f"{path}: no JSON: {error}") from None


def check_table(source, kind, table):
    if not isinstance(table, dict):
        raise ToolError(f"{source}: {kind}: must be rows of numbers")
    for row, values in table.items():
        if not isinstance(values, dict) or not all(type(value) is int and value >= 0 for value in values.values()):
            raise ToolError(f"{source}: {kind}: {row}: must give a whole number for each core")


def read_measured(kind):
    path = measured_path(kind)
    table = read_json(path)
    check_table(path, kind, table)
    if not table:
        raise ToolError(f"{path}: {kind}: holds no number")
    return table


def check_accepted(source, accepted):
    if not isinstance(accepted, dict):
        raise ToolError(f"{source}: must be an object")
    for kind in UNITS:
        check_table(source, kind, accepted.get(kind))
    return accepted


def last_commit(kind):
    """The accepted numbers of the last commit; none before the first."""
    name = ACCEPTED.relative_to(ROOT).as_posix()
    result = subprocess.run(["git", "show", f"HEAD:{name}"], cwd=ROOT, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise ToolError(f"{name}: not in the last commit, nothing to compare with: {result.stderr.strip()}")
    return check_accepted(f"HEAD:{name}", json.loads(result.stdout))[kind]


def columns(table):
    """Cores that the table has numbers of, in their order, then what else it has."""
    present = {column for values in table.values() for column in values}
    known = [name for name in CORES.values() if name in present]
    return known + sorted(present - set(known))


def cell(values, column):
    return str(values[column]) if column in values else "-"


def print_table(kind, table):
    names = columns(table)
    print_aligned([(f"{kind}, {UNITS[kind]}", *names),
                   *((row, *(cell(values, name) for name in names)) for row, values in table.items())])


def print_difference(kind, old, new):
    """Rows that changed: old, new, change in %."""
    rows = [(f"{kind}, {UNITS[kind]}", "core", "old", "new", "change, %")]
    for row in {**old, **new}:
        for name in columns({**old, **new}):
            before, after = old.get(row, {}).get(name), new.get(row, {}).get(name)
            if before != after:
                change = f"{100 * (after - before) / before:+.1f}" if before and after is not None else "-"
                rows.append((row, name, str(before if before is not None else "-"),
                             str(after if after is not None else "-"), change))
    if len(rows) == 1:
        print(f"{kind}: nothing changed since the last commit")
    else:
        print_aligned(rows)


def markdown(table):
    names = columns(table)
    lines = ["| | " + " | ".join(names) + " |", "|---|" + "--:|" * len(names)]
    lines += [f"| {row} | " + " | ".join(cell(values, name).replace("-", "–") for name in names) + " |"
              for row, values in table.items()]
    return "\n".join(lines)


def add_arguments(parser):
    parser.add_argument("--diff", action="store_true", help="compare with the last commit's numbers")


def show(kind, table, diff):
    """Keep what was measured and print it, or how it differs from the last commit."""
    write_measured(kind, table)
    if diff:
        print_difference(kind, last_commit(kind), table)
    else:
        print_table(kind, table)


def write_figures(kind, figures):
    write_whole(build_directory() / "bench" / f"{kind}.json", json.dumps(figures, indent=2) + "\n")


def figure(name, value, unit, bar, command):
    """`bar`: None where there is none."""
    bound = None if bar is None else {"op": "<=", "value": bar}
    return {"name": name, "value": value, "unit": unit, "bound": bound, "command": command}
