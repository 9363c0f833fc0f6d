"""Writes the C of the module joulepath._native: interface.py INTERFACE.cdef OUTPUT.c"""

import sys
from pathlib import Path

from cffi import FFI

HEADERS = ("joulepath/planner.h", "joulepath/status.h", "sim/files/lattice_file.h", "sim/lattice/lattice_robot.h",
           "sim/missions/mission_report.h",
           "sim/balancer/rig.h", "joulepath/learner.h", "sim/missions/plan_lattice.h", "sim/missions/plan_route.h", "tools/python/native/errors.h",
           "tools/python/native/drives.h", "tools/python/native/map_arrays.h", "tools/python/native/planning.h")


def main():
    interface, output = map(Path, sys.argv[1:])
    ffi = FFI()
    ffi.cdef(interface.read_text())
    includes = "\n".join(f"#include \"{header}\"" for header in HEADERS)
    ffi.set_source("joulepath._native", includes)
    ffi.emit_c_code(str(output))


if __name__ == "__main__":
    main()
