"""The folder of a campaign: its settings, and what is kept of its missions."""
import json
import re
from pathlib import Path

from tools.campaign.campaign_task import parse_missions
from tools.common import ToolError, read_text, shown_path, write_whole
from tools.report.results import read_json

SETTINGS = "settings.json"
BATCHES = "batches"
REPORTS = ("campaign.json", "campaign.png")
BATCH_NAME = re.compile(r"(\d+)-(\d+)\.jsonl")


def span(first, count):
    """Seeds as people write them."""
    return str(first) if count == 1 else f"{first}…{first + count - 1}"


def runs(seeds, length_max):
    """Sorted seeds as (first, count) of those in a row, of at most length_max."""
    found = []
    for seed in seeds:
        if found and seed == found[-1][0] + found[-1][1] and found[-1][1] < length_max:
            found[-1][1] += 1
        else:
            found.append([seed, 1])
    return [tuple(run) for run in found]


class Store:
    """Each file in it is whole or absent; a batch's is what the program printed."""

    def __init__(self, folder):
        self.folder = folder
        self._batches = folder / BATCHES

    def forget(self):
        """Removes what a campaign keeps and nothing else."""
        kept = [path for path, _, _ in self._files()]
        for path in [*kept, *(self.folder / name for name in (SETTINGS, *REPORTS))]:
            path.unlink(missing_ok=True)

    def open(self, settings):
        """Begins a campaign, or goes on with one of the same settings."""
        path = self.folder / SETTINGS
        if not path.exists():
            if self._files():
                raise ToolError(f"{shown_path(self.folder)}: holds batches but no {SETTINGS}; --fresh forgets them")
            write_whole(path, json.dumps(settings, indent=1) + "\n")
            return
        begun = read_json(path)
        if not isinstance(begun, dict):
            raise ToolError(f"{shown_path(path)}: not the settings of a campaign; --fresh forgets it")
        differing = [key for key in settings if begun.get(key) != settings[key]]
        if differing:
            what = ", ".join(f"{key} (was {begun.get(key)!s:.16}, is {settings[key]!s:.16})" for key in differing)
            raise ToolError(f"{shown_path(self.folder)}: holds a campaign of other settings: {what}; --fresh forgets "
                            "it, --output DIR keeps both")

    def keep(self, first, count, text):
        write_whole(self._batches / f"{first:07d}-{first + count - 1:07d}.jsonl", text)

    def seeds(self):
        """Of the missions that are kept."""
        return {seed for _, first, count in self._files() for seed in range(first, first + count)}

    def missions(self):
        """All that are kept, by their seeds."""
        missions = {}
        for path, first, count in self._files():
            try:
                missions.update((mission["seed"], mission) for mission in parse_missions(read_text(path), first, count))
            except RuntimeError as error:
                raise ToolError(f"{shown_path(path)}: {error}; remove it, and its missions are run again") from None
        return missions

    def _files(self):
        """Path, first seed and count of each batch."""
        found = []
        for path in sorted(self._batches.glob("*.jsonl")):
            match = BATCH_NAME.fullmatch(path.name)
            if match:
                first, last = map(int, match.groups())
                found.append((path, first, last - first + 1))
        return found


def default_folder(build, robot_path):
    return Path(build) / "campaign" / robot_path.stem
