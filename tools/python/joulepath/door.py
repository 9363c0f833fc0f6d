"""The command joulepath: one door to the programs and to the tools of the project."""

from __future__ import annotations

import os
import runpy
import subprocess
import sys
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent
_PROGRAMS = _PACKAGE / "build" / "bin"

# What the tools are called here, and which they are.
TOOLS = {
    "can-map": "operate.can_map", "can-report": "operate.can_report", "drive": "operate.drive",
    "energy-model": "design.identify", "excite": "operate.excite", "foxglove": "report.foxglove_log",
    "gains": "design.gain_design", "identify-log": "identify.log_identify", "import-map": "design.import_map",
    "lattice-tables": "design.lattice", "navigate-report": "report.navigate_report",
    "patrol-report": "report.patrol_report", "plan-report": "report.plan_report", "report": "report.report",
    "show-frames": "operate.show_frames", "skid-gains": "design.skid_robot"}

# Programs whose results a tool makes a page of: at once.
RECIPES = {"sil": ("mission", "report"), "planned": ("plan", "plan-report"), "navigated": ("navigate", "navigate-report"),
           "patrolled": ("patrol", "patrol-report")}

USAGE = """usage: joulepath NAME [ARGUMENTS]; joulepath NAME --help says which
programs: {}
tools: {}
program and its report, with --output DIR: {}"""


def programs() -> list[str]:
    """Their names, without jp-."""
    return sorted(path.name.removeprefix("jp-") for path in _PROGRAMS.glob("jp-*"))


def usage() -> str:
    """What is said when it is asked for help."""
    recipes = (f"{name} ({program}, {tool})" for name, (program, tool) in RECIPES.items())
    return USAGE.format(*map(", ".join, (programs(), sorted(TOOLS), recipes)))


def program(name: str, arguments: list[str]) -> list[str]:
    """The command that runs jp-NAME."""
    return [str(_PROGRAMS / f"jp-{name}"), *arguments]


def run_tool(name: str, arguments: list[str]) -> int:
    """In this process; what it needs and is not there is said in a line."""
    sys.argv = [f"joulepath {name}", *arguments]
    try:
        runpy.run_module(f"joulepath.tools.{TOOLS[name]}", run_name="__main__", alter_sys=False)
    except ModuleNotFoundError as error:
        print(f"joulepath {name}: needs the Python package of {error.name}; pip install 'joulepath[tools]' has all",
              file=sys.stderr)
        return 2
    return 0


def run_recipe(name: str, arguments: list[str]) -> int:
    """A program, and the report of what it wrote. The exit status of what failed, or 0."""
    if "--output" not in arguments[:-1]:
        print(f"joulepath {name}: --output DIR is needed, for the results and their report", file=sys.stderr)
        return 2
    first, tool = RECIPES[name]
    status = subprocess.run(program(first, arguments), check=False).returncode
    if status > 1:  # 1: done, but not as it should be
        return status
    return run_tool(tool, [arguments[arguments.index("--output") + 1]]) or status


def main() -> int:
    """Of sys.argv; the exit status."""
    name, arguments = (sys.argv[1] if len(sys.argv) > 1 else "--help"), sys.argv[2:]
    os.environ.setdefault("JOULEPATH_ROBOTS", str(_PACKAGE / "sim" / "robots"))
    if name in ("-h", "--help"):
        print(usage())
        return 0
    if name in programs():
        command = program(name, arguments)
        os.execv(command[0], command)
    if name in TOOLS:
        return run_tool(name, arguments)
    if name in RECIPES:
        return run_recipe(name, arguments)
    print(f"joulepath: {name}: no such program or tool; joulepath --help names them", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.path[0] = str(_PACKAGE.parent)
    sys.exit(main())
