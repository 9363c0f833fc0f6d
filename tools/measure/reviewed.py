"""Lists of what people have looked at and found right, each entry with its reason; one that nothing needs is an error."""
from dataclasses import dataclass

import yaml

from tools.common import ToolError, read_text


@dataclass
class Entry:
    """What it names, by the keys of its list."""

    place: str
    name: tuple
    reason: str
    found: int = 0


class Reviewed:
    """Of a YAML file: entries with these keys and a reason."""

    def __init__(self, path, keys):
        text = read_text(path)
        lines = [number for number, line in enumerate(text.splitlines(), 1) if line.startswith("- ")]
        self.entries = {}
        for content, line in zip(yaml.safe_load(text) or [], lines):
            entry = _entry(content, keys, f"{path}:{line}")
            if entry.name in self.entries:
                raise ToolError(f"{entry.place}: is listed already")
            self.entries[entry.name] = entry

    def explains(self, *name):
        """Whether an entry names it; the entry is needed then."""
        entry = self.entries.get(name)
        if entry:
            entry.found += 1
        return entry is not None

    def unneeded(self, files):
        """Problems: entries of these files that explained nothing."""
        return [f"{entry.place}: error: nothing needs this entry any more: remove it"
                for entry in self.entries.values() if entry.name[0] in files and not entry.found]


def _entry(content, keys, place):
    if not isinstance(content, dict) or set(content) != {*keys, "reason"}:
        raise ToolError(f"{place}: must have {', '.join(keys)} and reason")
    return Entry(place, tuple(str(content[key]) for key in keys), " ".join(str(content["reason"]).split()))
