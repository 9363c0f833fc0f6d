"""hal/README.md, the porting guide: what it names is there, and its figures hold. tests/tools/test_readme.py tests its
links and commands as those of all pages."""
import re

import pytest
from conftest import PROGRAMS, ROOT, command

GUIDE = (ROOT / "hal" / "README.md").read_text("utf-8")
SOURCES = [*ROOT.glob("include/joulepath/*.h"), *ROOT.glob("hal/**/*.[ch]"), *ROOT.glob("tests/target/*.h")]


def named(pattern):
    found = sorted(set(re.findall(pattern, GUIDE)))
    assert found, pattern
    return found


def text_of(*patterns):
    return "\n".join(path.read_text("utf-8") for pattern in patterns for path in ROOT.glob(pattern))


def test_files_it_names_exist():
    for name in named(r"`((?:tests|hal|sim|tools)/[\w./]+)`"):
        assert (ROOT / name).exists() or name.endswith("/mine.cfg"), name
    for name in named(r"`((?:app|can|storage|skeleton|cortex_m|firmware|mps2|stm32f4)/[\w./]*|\w+\.[ch])`"):
        places = [ROOT / "hal" / name, ROOT / "hal" / "skeleton" / name]
        assert any(path.exists() for path in places), name


def test_functions_it_names_are_declared():
    code = "\n".join(path.read_text("utf-8") for path in SOURCES)
    for name in named(r"`((?:jp|board|target|control)_\w+)\(\)`"):
        assert re.search(rf"\b{name}\(", code), name


def test_tests_it_names_exist():
    tests = text_of("tests/**/*.c", "tests/**/*.py")
    for name in named(r"`(test_\w+)`"):
        assert f"{name}(" in tests, name
    rows = text_of("tests/fault/fault_sensors.c")
    for row in named(r'(?:the same|fault_sensors\.c`): "([^"]+)"'):
        assert f'"{row}"' in rows, row


def test_keys_it_names_are_those_of_a_robot_file():
    keys = text_of("sim/balancer/robot_file.c")
    for key in named(r"`(?:\w+\.)?(\w+_(?:kg|m|ohm|v|dps|hz|s|deg|a|rad_s|per_rad|per_a|per_turn))`"):
        assert f'.{key}"' in keys, key


def test_faults_and_states_it_names_are_the_library_s():
    code = text_of("include/joulepath/*.h", "hal/**/*.h")
    for name in named(r"`(JP_[A-Z_0-9]+)`"):
        assert name in code, name


@pytest.mark.parametrize("name, kibibytes", [
    ("jp_robot", 1), ("jp_pilot", 2), ("jp_ecu", 2), ("jp_ecu_balancer", 3), ("jp_ecu_skid", 8), ("jp_retained", 0.5)])
def test_structs_are_as_small_as_it_says(name, kibibytes):
    assert f"`struct {name}` | under {f'{kibibytes} KiB' if kibibytes >= 1 else '512 B'}" in GUIDE
    program = f'#include "hal/app/ecu.h"\n#include "hal/app/ecu_balancer.h"\n#include "hal/app/ecu_skid.h"\n_Static_assert(sizeof(struct {name}) < {int(kibibytes * 1024)}, "size");\n'
    for core in (["arm-none-eabi-gcc", "-mthumb", "-mcpu=cortex-m0"],
                 ["riscv64-unknown-elf-gcc", "-march=rv32imac", "-mabi=ilp32", "--specs=picolibc.specs"]):
        command(*core, "-fsyntax-only", "-I", ROOT / "include", "-I", ROOT, "-x", "c", "-", input=program)


def test_limits_of_time_are_those_of_the_test():
    test = (ROOT / "tests" / "fault" / "fault_timing.c").read_text("utf-8")
    limits = dict(re.findall(r"^#define (AGE|JITTER|LEFT_OUT) +([\d.]+)", test, re.M))
    assert limits == {"AGE": "10", "JITTER": "2", "LEFT_OUT": "0.1"}
    assert "samples 10 ms old, ages that\njump by 2 ms and every tenth tick left out" in GUIDE


def test_each_function_of_the_board_is_in_the_skeleton():
    skeleton = (PROGRAMS.parents[1] / "hal" / "skeleton" / "board.h").read_text("utf-8")
    for name in named(r"`(board_\w+)\(\)`"):
        assert f"{name}(" in skeleton, name
