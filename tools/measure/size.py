#!/usr/bin/env python3
"""Flash and RAM of each module on each core, and RAM of its objects.

Arguments: folders of the variants built for size, such as build/cortex-m4-os, each with its image `whole`. Flash is
code and constants of a module's objects, without the compiler's helpers; RAM is its own variables, of which the library
has none. What a robot needs is the size of its struct. Prints a table, writes build/numbers/size.json and figures for
figures.py. Exit status 2: bad input, nothing was written.
"""
import re
from pathlib import Path

from elftools.common.exceptions import ELFError
from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile

from tools.common import ArgumentParser, ToolError, run
from tools.measure import core_numbers

# Of hal/, what is not a port.
HAL_ROOMS = ("storage", "can", "app")

# By the path of the object; the first that matches holds it.
MODULES = {
    "balancer": r"src/(balancer/(robot|robot_read|estimator|lqr|odometry|path_error|reference)|energy/meter|base/(fixed|config_check|monitor))",
    "energy": r"src/energy/energy",
    "skid steer: energy": r"src/(energy/skid_energy|skid_steer/skid_(tariff|path_energy))",
    "skid steer: learner": r"src/learn/(skid_learner|skid_grounds|ground_learner)",
    "energy of short segments": r"src/energy/horizon",
    "battery": r"src/energy/battery(_\w+)?",
    "evidence": r"src/balancer/(current_check|evidence)",
    "optimiser": r"src/trajectory/segment(_\w+)?",
    "planner": r"src/(search/planner(_\w+)?|map/(lattice|terrain|open_plane|guide_field|energy_field|turn_field|wavefront))",
    "learner": r"src/learn/(learner(_\w+)?|learned_state|forecast(_sum)?|normal_quantile)",
    "tariff": r"src/map/tariff",
    "skid steer": r"src/skid_steer/skid_steer",
    "skid steer: control, robot": r"src/(skid_steer/skid_(robot|robot_read|snapshot|control|monitor|follow)|energy/meter_battery)",
    "skid steer: odometry": r"src/(skid_steer/skid_(odometry|gyro|tilt|slip|past|estimate|arithmetic)|base/reciprocal)",
    "grid planner": r"src/search/grid_\w+",
    "path spline": r"src/trajectory/path_spline",
    "path of a lattice plan": r"src/trajectory/(clothoid|lattice_path|line_path|path_(corner|drive|speed))",
    "four wheels: energy, learner": r"src/(energy/(four_wheel_energy|bus_meter)|learn/(four_wheel_learner|factor_learning)|four_wheel/four_wheel_trip)",
    "four wheels": r"src/four_wheel/four_wheel",
    "four-wheeled robot": r"src/(four_wheel/four_wheel_robot(_\w+)?|navigate/patrol_(pilot|ledger|round))",
    "pure pursuit": r"src/four_wheel/pure_pursuit",
    "plane": r"src/base/plane",
    "obstacles": r"src/local/(obstacle\w*|scan_(runs|shapes))",
    "movers": r"src/local/movers(_\w+)?",
    "timed elastic band": r"src/(local/teb(_\w+)?|base/config_float_check)",
    "patrol mission": r"src/local/patrol_(approach|marks|mission)",
    "patrol": r"src/local/patrol(_\w+)?",
    "scan matching": r"src/local/(scan_match(_\w+)?|eigen)",
    "localiser": r"src/local/(localiser(_\w+)?|wall_field)",
    "trajectory within a budget": r"src/trajectory/trajectory_budget",
    "headings and speeds of a route": r"src/trajectory/trajectory_(optimiser|cost)",
    "trajectory by rule": r"src/(trajectory/trajectory(_\w+)?|base/power_of_half)",
    "pilot": r"src/navigate/pilot",
    "pilot of skid steer": r"src/navigate/skid_(pilot|run)",
    "navigator": r"src/(navigate/(navigator(_\w+)?|course|balancer_vehicle)|map/(capsule|line_cost|lattice_way|unit_step|reach))",
    "home": r"src/(navigate/home\w*|map/(pose_\w+|barred_steps|return_map))",
    "navigator's skid steer": r"src/navigate/skid_vehicle",
    "end-to-end protection": r"src/base/e2e",
    "waypoints of a route": r"src/(navigate/waypoint\w*|map/clearance)",
    "operator": r"hal/app/operator",
    "CAN application": r"hal/((can|app)/\w+|hal)",
    "parameters in flash": r"hal/storage/(parameters|store|crc32)",
    "battery in flash": r"hal/storage/battery_store",
    "post-mortem": r"hal/storage/(post_mortem|memory_check)",
    "tables of a robot": r"src/tables/(robot|energy)_courier24",
    "table of a skid-steered robot": r"src/tables/skid_robot_zhang2018",
    "table of short segments": r"src/tables/horizon_courier24",
    "table of a battery": r"src/tables/battery_courier24",
    "lattice of a robot": r"src/tables/lattice_courier24",
    "tables of a patrol robot": r"src/tables/\w+_patrol",
    None: r"src/tables/\w+",  # other robots
}
SMALL_ROBOT = ("balancer", "energy", "optimiser")
SMALL_ROBOT_BAR = 15 * 1024  # B
SKID_STEER = ("skid steer: control, robot", "skid steer: odometry", "skid steer: energy", "skid steer: learner")
SKID_STEER_BAR = 12 * 1024  # B

# Their owner provides the memory; without the planner's block.
STRUCTS = ("jp_robot", "jp_ecu", "jp_planner")
ROBOT_BAR = 1024  # B
BAR_CORE = "Cortex-M4"

# The codec's functions with `double`, which no program calls: the linker drops them.
DROPPED = re.compile(r"\.text\.jp_can_\w+_(encode|decode|init)")


def module_of(path, modules):
    for module, pattern in modules.items():
        if re.fullmatch(pattern + r"\.o", path):
            return module
    raise ToolError(f"{path}: belongs to no module: add it to MODULES in tools/measure/size.py")


def open_elf(path, file):
    try:
        return ELFFile(file)
    except ELFError as error:
        raise ToolError(f"{path}: no object file: {error}") from None


def measure_object(path):
    """Bytes in flash and in RAM."""
    flash = ram = 0
    with open(path, "rb") as file:
        for section in open_elf(path, file).iter_sections():
            flags, size = section["sh_flags"], section["sh_size"]
            if not flags & SH_FLAGS.SHF_ALLOC or DROPPED.match(section.name):
                continue
            writable = flags & SH_FLAGS.SHF_WRITE and not section.name.startswith(".data.rel.ro")
            ram += size if writable else 0
            flash += size if section["sh_type"] != "SHT_NOBITS" else 0
    return flash, ram


def struct_sizes(path, names):
    """sizeof of each, from the debugger's information of an image."""
    sizes = {}
    with open(path, "rb") as file:
        elf = open_elf(path, file)
        if not elf.has_dwarf_info():
            raise ToolError(f"{path}: holds no debugging information: compile with -g")
        for unit in elf.get_dwarf_info().iter_CUs():
            for entry in unit.iter_DIEs():
                name, size = entry.attributes.get("DW_AT_name"), entry.attributes.get("DW_AT_byte_size")
                if entry.tag == "DW_TAG_structure_type" and name and size:
                    sizes[name.value.decode()] = size.value
    for name in names:
        if name not in sizes:
            raise ToolError(f"{path}: does not know struct {name}")
    return {name: sizes[name] for name in names}


def objects(folder):
    """Of the library and the CAN application, by their path in the source tree."""
    paths = [*folder.glob("src/**/*.o"), *folder.glob("hal/*.o"),
             *(path for room in HAL_ROOMS for path in folder.glob(f"hal/{room}/*.o"))]
    if not paths:
        raise ToolError(f"{folder}: no objects; `make size` builds them")
    return {path.relative_to(folder).as_posix(): path for path in sorted(paths)}


def measure(folder, modules):
    """{row: bytes} of one variant; without an FPU it has not all modules."""
    flash = {}
    ram = 0
    for name, path in objects(folder).items():
        module = module_of(name, modules)
        if module is not None:
            object_flash, object_ram = measure_object(path)
            flash[module] = flash.get(module, 0) + object_flash
            ram += object_ram
    rows = {f"flash: {module}": flash[module] for module in modules if module in flash}
    rows["flash: balancer + energy + optimiser"] = sum(flash.get(module, 0) for module in SMALL_ROBOT)
    rows["flash: skid steer, control and energy"] = sum(flash.get(module, 0) for module in SKID_STEER)
    rows["RAM: variables of all modules"] = ram
    for struct, size in struct_sizes(folder / "whole", STRUCTS).items():
        rows[f"RAM: struct {struct}"] = size
    return rows


def tabulate(folders, modules):
    table = {}
    for folder in folders:
        for row, value in measure(folder, modules).items():
            table.setdefault(row, {})[core_numbers.core_of(folder.name)] = value
    return table


def figures(table):
    rows = (("flash: balancer + energy + optimiser", SMALL_ROBOT_BAR),
            ("flash: skid steer, control and energy", SKID_STEER_BAR), *((f"flash: {module}", None) for module in SKID_STEER),
            ("RAM: struct jp_robot", ROBOT_BAR))
    for row, bar in rows:
        if BAR_CORE in table.get(row, {}):
            yield core_numbers.figure(f"{BAR_CORE}, -Os: {row}", table[row][BAR_CORE], "B", bar, "make size")


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folders", metavar="FOLDER", type=Path, nargs="+")
    core_numbers.add_arguments(parser)
    options = parser.parse_args()
    table = tabulate(options.folders, MODULES)
    core_numbers.show("size", table, options.diff)
    core_numbers.write_figures("size", list(figures(table)))
    return 0


if __name__ == "__main__":
    run(main)
