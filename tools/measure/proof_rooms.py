"""What is measured room by room: the rooms of tests/proof/rooms.yaml, which can hurt someone, and any folder of sources."""
import re

import yaml

from tools.common import ROOT, ToolError, read_text

ROOMS = ROOT / "tests/proof/rooms.yaml"
SOURCES = (".c", ".h")


def sources_of(patterns, root=ROOT):
    """Files, relative to the root, in order."""
    return sorted({path.relative_to(root).as_posix() for pattern in patterns for path in root.glob(pattern)
                   if path.suffix in SOURCES})


def critical_rooms(path=ROOMS):
    """Name: files."""
    rooms = {name: sources_of(patterns) for name, patterns in yaml.safe_load(read_text(path)).items()}
    for name, files in rooms.items():
        if not files:
            raise ToolError(f"{path}: room {name} has no sources")
    return rooms


def chosen_rooms(names):
    """Of each name its files: a critical room, a folder of sources, or a source."""
    critical = critical_rooms()
    rooms = {}
    for name in names or critical:
        files = critical.get(name) or sources_of([f"{name}/*" if (ROOT / name).is_dir() else name])
        if not files:
            raise ToolError(f"{name}: no room; must be one of {', '.join(critical)}, a folder of sources, or a source")
        rooms[name] = files
    return rooms


def one_line(code):
    """A piece of C as one line, so that it is found again when lines move."""
    return re.sub(r"\s+", " ", re.sub(r"/\*.*?\*/", " ", code, flags=re.S)).strip()
