"""No room reads what another room keeps to itself: prints one result a file in the format of Unity.

What is private stands in members called `internal`, of types that a header of the room declares. Clang's syntax tree
says whose member an expression names.
"""
import itertools
import os
import re
import shlex
import sys
from pathlib import Path

import yaml
from clang import cindex

sys.path.insert(0, str(Path(__file__).parent))
import includes  # pylint: disable=wrong-import-position

ROOT = includes.ROOT
MEMBER = "internal"
ACCESS = re.compile(r"(->|\.)internal\b")


def members_read(unit, path):
    """(line, header that declares the member) of each private member that a file names."""
    own = [top for top in unit.cursor.get_children() if top.location.file and top.location.file.name == unit.spelling]
    for cursor in itertools.chain.from_iterable(top.walk_preorder() for top in own):
        if cursor.kind == cindex.CursorKind.MEMBER_REF_EXPR and cursor.spelling == MEMBER and cursor.referenced:
            yield cursor.location.line, Path(cursor.referenced.location.file.name).resolve()


def parse(path, flags, text=None):
    """The syntax tree of a file, or of another text in its place."""
    unit = cindex.Index.create().parse(str(path), args=flags, unsaved_files=[(str(path), text)] if text else None)
    errors = [str(problem) for problem in unit.diagnostics if problem.severity >= cindex.Diagnostic.Error]
    if errors:
        raise SystemExit(f"{path}: {errors[0]}")
    return unit


def problems_of(unit, path, homes):
    """(line, reason) of each private member of another room."""
    room = includes.room_of(path.relative_to(ROOT).as_posix(), homes)
    for line, header in members_read(unit, path):
        owner = includes.room_of(header.relative_to(ROOT).as_posix(), homes)
        if owner != room:
            yield line, f"{room} reads a private member of {owner}"


def main():
    settings = yaml.safe_load((Path(__file__).parent / "layers.yaml").read_text(encoding="utf-8"))
    sources = sorted(path for top in ("src", "hal", "sim") for path in (ROOT / top).rglob("*.c"))
    homes = {**includes.homes_of([path.relative_to(ROOT).as_posix() for path in sources]), **settings["public_headers"]}
    flags = [*shlex.split(os.environ["GATE_CFLAGS"]), "-w", "-isystem", os.environ["COMPILER_HEADERS"]]
    passed = failed = 0
    for path in sources:
        name = path.relative_to(ROOT).as_posix()
        if not ACCESS.search(path.read_text(encoding="utf-8")):
            continue
        problems = list(problems_of(parse(path, flags), path, homes))
        for line, reason in problems:
            print(f"{name}:{line}:private:FAIL: {reason}")
        if not problems:
            print(f"{name}:1:private:PASS")
        passed, failed = passed + (not problems), failed + len(problems)
    print(f"\n-----------------------\n{passed + failed} Tests {failed} Failures 0 Ignored \n{'FAIL' if failed else 'OK'}")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
