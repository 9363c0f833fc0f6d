"""The command joulepath: one door to the programs that come with the package."""

import os
import sys
from pathlib import Path

_PACKAGE = Path(__file__).parent
_PROGRAMS = _PACKAGE / "programs"


def programs():
    """Their names, without jp-."""
    return sorted(path.name.removeprefix("jp-") for path in _PROGRAMS.glob("jp-*"))


def main():
    name = sys.argv[1] if len(sys.argv) > 1 else "--help"
    if name in ("-h", "--help"):
        print("usage: joulepath PROGRAM [ARGUMENTS]; joulepath PROGRAM --help says which\nprograms:",
              ", ".join(programs()))
        return 0
    if name not in programs():
        print(f"joulepath: {name}: no such program; give one of {', '.join(programs())}", file=sys.stderr)
        return 2
    os.environ.setdefault("JOULEPATH_ROBOTS", str(_PACKAGE / "robots"))
    program = _PROGRAMS / f"jp-{name}"
    os.execv(program, [str(program), *sys.argv[2:]])
