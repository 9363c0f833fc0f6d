#!/usr/bin/env python3
"""Bounds of the instructions of a tick on a Cortex-M4: the longest way through the control flow of its image.

Argument: the folder of a variant, build/cortex-m4, with the images of the benches that measure the same. What no
disassembly tells stands in tests/target/instruction_bounds.json, each with its reason: how often a loop turns at most, and
which calls exclude each other. Prints each bound beside what was measured (tests/bench/figures.json) and writes
build/numbers/instruction_bounds.json. Exit status 1: a bound is below what was measured, so that one of both is wrong, or
above BAR times it; 2: bad input, or a loop without a bound.

Every instruction of a block counts, in an IT block those too whose condition fails, as the emulator counts. A turn of a loop
counts as the longest.
"""
import json
import re
import subprocess
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from tools.common import EXIT_MISSED, ROOT, ArgumentParser, ToolError, print_aligned, run, write_whole
from tools.measure import control_flow, core_numbers

FACTS = ROOT / "tests/target/instruction_bounds.json"
FIGURES = ROOT / "tests/bench/figures.json"
BAR = 1.5
# What the compiler adds to the name of a copy.
COPY = re.compile(r"(\.(isra|part|constprop|cold)(\.\d+)?)+$")


@dataclass
class Bound:
    name: str
    figure: str
    bound: int
    measured: int

    def ratio(self):
        return self.bound / self.measured


def disassemble(path):
    if not path.is_file():
        raise ToolError(f"{path}: no such image; `make cycles` builds it")
    return subprocess.run(["arm-none-eabi-objdump", "-d", path], capture_output=True, text=True, check=True).stdout


def plain(name):
    return COPY.sub("", name)


class Image:
    """Bounds of the functions of an image."""

    def __init__(self, path, facts):
        self._names, self._functions = control_flow.read_functions(disassemble(path))
        self._facts = facts
        self._worst = {}
        self._path = []
        self.used = set()

    def bound(self, name):
        places = [address for address, found in self._names.items() if plain(found) == name]
        if len(places) != 1:
            raise ToolError(f"{name}: {len(places)} functions of that name")
        return self._bound(places[0], None)

    def _bound(self, address, size):
        """`size`: bytes that a function of the C library sets or copies, None if it is none."""
        if (address, size) not in self._worst:
            if address in self._path:
                raise ToolError(f"recursion: {self._names[address]}")
            self._path.append(address)
            self._worst[address, size] = self._longest(address, size)
            self._path.pop()
        return self._worst[address, size]

    def _longest(self, address, size):
        graph = control_flow.Graph(self._names[address], self._functions[address], self._names)
        if None in graph.calls():
            raise ToolError(f"{graph.name}: calls by a pointer")
        bounds = self._loop_bounds(graph, size)
        alternatives = self._alternatives(graph)
        worst = max(graph.worst(self._cost, bounds, frozenset().union(*without)) for without in product(*alternatives))
        if worst == 0:
            raise ToolError(f"{graph.name}: no way leads out of it")
        return worst

    def _cost(self, block):
        return block.weight + sum(self._bound(called, self._size(called, block)) for called in block.calls)

    def _size(self, called, block):
        """Of a function that takes one: the constant that the block passes."""
        name = plain(self._names[called])
        if name not in self._facts["sized"]:
            return None
        if block.size is None:
            return self._facts["sized"][name]["most"]
        return block.size

    def _loop_bounds(self, graph, size):
        name, headers = plain(graph.name), graph.loops()
        if not headers:
            return {}
        fact = self._facts["sized"].get(name) or self._facts["loops"].get(name)
        if fact is None or len(fact["turns"]) != len(headers):
            places = ", ".join(f"{header:x}" for header in headers)
            raise ToolError(f"{name}: loops at {places}: list their turns in {FACTS.name}")
        self.used.add(name)
        return {header: turns(fact["turns"][i], size) for i, header in enumerate(headers)}

    def _alternatives(self, graph):
        """For each exclusion, sets of calls of which a way lacks at least one. Functions of several robots share a name:
        it is about the one with these calls."""
        called = {address: plain(self._names[address]) for address in graph.calls()}
        for number, exclusion in enumerate(self._facts["exclusions"]):
            sides = [{address for address, name in called.items() if name in exclusion[side]}
                     for side in ("if", "never")]
            if exclusion["function"] == plain(graph.name) and all(sides):
                self.used.add(number)
                yield sides


def turns(value, size):
    """A number, or how many bytes a turn takes."""
    return value if isinstance(value, int) else size // int(value.removeprefix("size/"))


def read_figures(path):
    benches = core_numbers.read_json(path)["benches"]
    return {figure["name"]: figure["value"] for bench in benches.values() for figure in bench}


def measure(folder, facts, figures):
    images = {}
    for entry in facts["entries"]:
        if entry["figure"] not in figures:
            raise ToolError(f"{FACTS.name}: {entry['figure']}: no such figure was measured")
        image = images.setdefault(entry["image"], Image(folder / entry["image"], facts))
        yield Bound(" + ".join(entry["functions"]), entry["figure"], sum(map(image.bound, entry["functions"])),
                    int(figures[entry["figure"]]))
    used = set().union(*(image.used for image in images.values()))
    for name in facts["loops"]:
        if name not in used:
            raise ToolError(f"{FACTS.name}: {name}: no image needs its loops' turns any more")
    for number, exclusion in enumerate(facts["exclusions"]):
        if number not in used:
            raise ToolError(f"{FACTS.name}: {exclusion['function']}: calls nothing of {', '.join(exclusion['if'])}")


def wrong(bounds):
    for bound in bounds:
        if bound.bound < bound.measured:
            yield f"{bound.figure}: bound {bound.bound} is below the measured {bound.measured}"
        elif bound.ratio() > BAR:
            yield (f"{bound.figure}: bound {bound.bound} is {bound.ratio():.2f} times the measured {bound.measured}, "
                   f"bar {BAR}")


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folder", metavar="FOLDER", type=Path)
    parser.add_argument("--facts", metavar="FILE", type=Path, default=FACTS,
                        help="what no disassembly tells (default: tests/target/instruction_bounds.json)")
    parser.add_argument("--figures", metavar="FILE", type=Path, default=FIGURES,
                        help="what was measured (default: tests/bench/figures.json)")
    options = parser.parse_args()
    bounds = list(measure(options.folder, core_numbers.read_json(options.facts), read_figures(options.figures)))
    print_aligned([("what runs", "bound", "measured", "ratio", "measured as"),
                   *((b.name, str(b.bound), str(b.measured), f"{b.ratio():.2f}", b.figure) for b in bounds)])
    rows = [vars(bound) | {"ratio": round(bound.ratio(), 3)} for bound in bounds]
    write_whole(core_numbers.measured_path("instruction_bounds"), json.dumps(rows, indent=1) + "\n")
    misses = list(wrong(bounds))
    for line in misses:
        print(line)
    return EXIT_MISSED if misses else 0


if __name__ == "__main__":
    run(main)
