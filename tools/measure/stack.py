#!/usr/bin/env python3
"""Worst-case stack of each entry point on each core, from the call graph.

Arguments: folders of variants, such as build/cortex-m4 or build/firmware, each with its image `whole`; of several
variants of a core the worst counts. Frames of the library are gcc's (-fcallgraph-info=su), those of the compiler's
helpers are counted in the image's disassembly. Errors: recursion, a frame whose size varies, an indirect call whose
targets tests/target/indirect_calls.json does not list. Prints a table, writes build/numbers/stack.json and figures for
tools/measure/figures.py. Exit status 2: an error or bad input, nothing was written.

A tail call counts as a call, which is at most too much. What the core pushes for an exception is not counted.
"""
import subprocess
from pathlib import Path

from elftools.common.exceptions import ELFError
from elftools.elf.elffile import ELFFile

from tools.common import ROOT, ArgumentParser, ToolError, run
from tools.measure import call_graph, core_numbers

ENTRIES = ("jp_robot_tick", "jp_hal_tick", "jp_ecu_tick", "jp_ecu_accept", "jp_ecu_work",
           "jp_energy_forecast", "jp_energy_regressors", "jp_learner_update", "jp_forecast_add",
           "jp_segment_optimise", "jp_planner_work",
           "jp_tariff_by_models", "jp_four_wheel_tick", "jp_pure_pursuit_tick", "jp_grid_planner_work",
           "jp_path_spline", "jp_battery_update", "jp_current_check_update", "jp_pilot_work")
FIRMWARE_ENTRIES = ("jp_hal_tick", "jp_ecu_tick", "jp_ecu_accept", "jp_ecu_work", "DMA2_Stream0_IRQHandler",
                    "CAN1_RX0_IRQHandler", "main")
FLOAT_ENTRIES = ("jp_obstacles_add_scan", "jp_teb_plan", "jp_patrol_cycle", "jp_trajectory_optimiser_work")
BAR_ENTRY, BAR = "jp_hal_tick", 256  # B
BAR_CORES = ("Cortex-M4", core_numbers.BOARD_NAME)
LISTED = ROOT / "tests/target/indirect_calls.json"
FLOAT_FOLDER = "src/local"  # of a variant that has the float library
BOARD = "board"  # a listed target that is not the library's: it counts nothing

THUMB = 1  # bit of a function's address
MACHINES = {"EM_ARM": ("arm", "arm-none-eabi-objdump"), "EM_RISCV": ("riscv", "riscv64-unknown-elf-objdump")}


class Graph:
    """Functions by name, and the worst stack from each of them."""

    def __init__(self, functions, aliases, listed):
        self._functions = functions
        self._aliases = aliases
        self._listed = listed
        self._worst = {}
        self._path = []

    def worst(self, name):
        """(bytes, names from the entry down) of the deepest path from a function."""
        if name == BOARD:
            return 0, []
        name = name if name in self._functions else self._aliases.get(name, name)
        if name in self._path:
            cycle = [*self._path[self._path.index(name):], name]
            raise ToolError(f"recursion: {' -> '.join(cycle)}")
        if name not in self._worst:
            self._worst[name] = self._descend(name)
        return self._worst[name]

    def _descend(self, name):
        function = self._functions.get(name)
        if function is None:
            raise ToolError(f"{self._route(name)}: the call graph does not know it")
        if function.frame is None:
            raise ToolError(f"{self._route(name)}: its frame has no bound")
        self._path.append(name)
        below = [self.worst(called) for called in sorted(function.calls | self._indirect(function))]
        self._path.pop()
        depth, path = max(below, default=(0, []), key=lambda worst: worst[0])
        return function.frame + depth, [name, *path]

    def _indirect(self, function):
        targets = set()
        for place in function.indirect:
            expression = call_graph.called_expression(place)
            listed = call_graph.targets_of(expression, self._listed)
            if listed is None:
                raise ToolError(f"{place}: indirect call of {expression}: list its targets in {LISTED.name}")
            known = {target for target in listed if target == BOARD or target in self._functions}
            if not known:
                raise ToolError(f"{place}: indirect call of {expression}: none of its targets in {LISTED.name} exists")
            targets |= known
        return targets

    def _route(self, name):
        return " -> ".join([*self._path, name])


def check_disassembly(image, functions, disassembled):
    """It must count at least what gcc says, or the helpers' frames are no upper bounds either."""
    for name, function in functions.items():
        shown = disassembled.get(name)
        if shown and shown.frame is not None and shown.frame < function.frame:
            raise ToolError(f"{image}: {name}: {shown.frame} bytes by its disassembly, {function.frame} by gcc; "
                            "build again")


def check_pointers(functions, listed):
    """A static function that none calls by its name is called by a pointer, and so must be listed."""
    called = {name for function in functions.values() for name in function.calls}
    targets = {target for targets in listed.values() for target in targets}
    for name in sorted(functions):
        if ":" in name and name not in called | targets:
            raise ToolError(f"{name}: only a pointer to it is used: list it in {LISTED.name} as a target of that call")


def read_listed(path):
    listed = core_numbers.read_json(path)
    if not isinstance(listed, dict) or not all(
            isinstance(targets, list) and targets and all(isinstance(target, str) for target in targets)
            for targets in listed.values()):
        raise ToolError(f"{path}: must give a list of functions for each call")
    return listed


def read_image(path):
    """Functions by disassembly, and {alias: name} of those that have several."""
    try:
        with open(path, "rb") as file:
            elf = ELFFile(file)
            machine, objdump = MACHINES[elf["e_machine"]]
            symbols = {symbol.name: symbol["st_value"] & ~THUMB if machine == "arm" else symbol["st_value"]
                       for symbol in elf.get_section_by_name(".symtab").iter_symbols()
                       if symbol["st_info"]["type"] == "STT_FUNC"}
    except OSError as error:
        raise ToolError(f"{path}: {error.strerror}") from None
    except (ELFError, KeyError) as error:
        raise ToolError(f"{path}: no image of a core: {error}") from None
    starts = {address: name for name, address in symbols.items()}
    text = subprocess.run([objdump, "-d", path], capture_output=True, text=True, check=True).stdout
    return (call_graph.read_disassembly(text, machine, starts),
            {name: starts[address] for name, address in symbols.items()})


def call_graphs(folder):
    """Those of the libraries and of the CAN application; of a board also its own."""
    places = ("src/*", "hal", "hal/storage", "hal/can", "hal/app",
              *(("hal/stm32f4", "hal/cortex_m", ".") if folder.name == core_numbers.FIRMWARE else ()))
    return sorted(path for place in places for path in folder.glob(f"{place}/*.ci"))


def graph_of(folder, image, listed):
    paths = call_graphs(folder)
    if not paths:
        raise ToolError(f"{folder}: no call graphs; `make stack` builds them")
    functions = call_graph.read_gcc(paths)
    check_pointers(functions, listed)
    disassembled, aliases = read_image(image)
    check_disassembly(image, functions, disassembled)
    return Graph({**disassembled, **functions}, aliases, listed)


def entries_of(folder):
    if folder.name == core_numbers.FIRMWARE:
        return FIRMWARE_ENTRIES
    return ENTRIES + FLOAT_ENTRIES if (folder / FLOAT_FOLDER).is_dir() else ENTRIES


def measure(folders, listed, show_paths=False):
    table = {entry: {} for entry in ENTRIES}
    for folder in folders:
        graph, core = graph_of(folder, folder / "whole", listed), core_numbers.core_of(folder.name)
        for entry in entries_of(folder):
            depth, path = graph.worst(entry)
            values = table.setdefault(entry, {})
            values[core] = max(depth, values.get(core, 0))
            if show_paths:
                print(f"{folder.name}: {entry}: {depth} B: {' -> '.join(path)}")
    return table


def figures(table):
    for core in BAR_CORES:
        if core in table[BAR_ENTRY]:
            yield core_numbers.figure(f"{core}: worst-case stack of {BAR_ENTRY}()", table[BAR_ENTRY][core], "B", BAR,
                                      "make stack")


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folders", metavar="FOLDER", type=Path, nargs="+")
    parser.add_argument("--indirect", metavar="FILE", type=Path, default=LISTED,
                        help="targets of the indirect calls (default: tests/target/indirect_calls.json)")
    parser.add_argument("--paths", action="store_true", help="also print the deepest path of each entry point")
    core_numbers.add_arguments(parser)
    options = parser.parse_args()
    table = measure(options.folders, read_listed(options.indirect), options.paths)
    core_numbers.show("stack", table, options.diff)
    core_numbers.write_figures("stack", list(figures(table)))
    return 0


if __name__ == "__main__":
    run(main)
