"""Do what tools/TUTORIAL.md says, step by step in a fresh copy of the project, and measure each step.

The files are those that stand there, the commands those that begin its sections; what fails ends it with exit status 2.
The first step installs what the first `make` would: packages that this machine lacks, and a .venv of the copy's own. With
JP_SETUP=skip it is left out, and the copy has the .venv of this one. Writes them to build/tutorial as a table and figures.
"""
import json
import os
import re
import tempfile
from pathlib import Path

from tools.common import ROOT, ArgumentParser, ToolError, print_aligned, read_text, run, shown_path, write_whole
from tools.design.robot_json import build_directory
from tools.measure.bench_python import copy_sources, timed
from tools.measure.figure_store import write_tables

TUTORIAL = ROOT / "tools/TUTORIAL.md"
COMMAND = "make tutorial"
HEADINGS = ("step", "command", "takes, s", "of processors, s")
SETUP = "what it needs", "tools/setup.sh --yes design firmware"
BAR_S = 600


def sections(text):
    """(title, text) of the numbered sections."""
    parts = re.split(r"^## \d+\. (.+)$", text, flags=re.M)[1:]
    return list(zip(parts[::2], parts[1::2]))


def files(text):
    """What is to be written where: a block follows the line that names its file."""
    named = re.findall(r"`(sim/(?:robots|scenarios)/mine\.cfg)`(?:(?!^```).)*?^```\n(.*?)^```$", text, re.M | re.S)
    if len(named) != 2:
        raise ToolError(f"{shown_path(TUTORIAL)}: names {len(named)} files with their text; robot and scenario are two")
    return dict(named)


def steps(text):
    """(title, command) of each section that has one."""
    for title, part in sections(text):
        command = re.search(r"`(make [^`]+)`", part)
        if command is not None:
            yield title, command[1]


def measure(text):
    """(title, command, seconds by the clock, of the processors) of each step."""
    environment = {name: value for name, value in os.environ.items()
                   if not name.startswith(("MAKE", "MFLAGS", "PYTHON", "VIRTUAL_ENV")) and name != "JP_BUILD"}
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "joulepath"
        copy_sources(copy)
        if environment.get("JP_SETUP") == "skip":
            (copy / ".venv").symlink_to((ROOT / ".venv").resolve())
        else:
            yield *SETUP, *timed(SETUP[1], shell=True, cwd=copy, env=environment)
        for name, content in files(text).items():
            (copy / name).write_text(content, encoding="utf-8")
        for title, command in steps(text):
            yield title, command, *timed(command, shell=True, cwd=copy, env=environment)


def main():
    ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0]).parse_args()
    rows = []
    for title, command, clock, processors in measure(read_text(TUTORIAL)):
        rows.append((title, f"`{command}`", f"{clock:.0f}", f"{processors:.0f}"))
        print(f"{title}: {clock:.0f} s", flush=True)
    print_aligned([HEADINGS, *rows])
    folder = build_directory() / "tutorial"
    write_tables(folder / "tutorial.tables.json", {"tutorial": (HEADINGS, rows)})
    total = [sum(float(row[column]) for row in rows) for column in (2, 3)]
    write_whole(folder / "tutorial.json", json.dumps([
        {"name": "tutorial, from a robot file to the firmware's drive", "value": total[0], "unit": "s",
         "bound": {"op": "<=", "value": BAR_S}, "command": COMMAND},
        {"name": "tutorial, from a robot file to the firmware's drive: time of processors", "value": total[1], "unit": "s",
         "bound": None, "command": COMMAND}], indent=1) + "\n")
    print(f"\nwrote {shown_path(folder / 'tutorial.json')}")
    return 0


if __name__ == "__main__":
    run(main)
