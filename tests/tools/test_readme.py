"""README.md: its examples are firmware that compiles and links, and its table of figures was made by a command."""
import re
import subprocess

import pytest
from conftest import ROOT

WARNINGS = ["-std=c11", "-fno-math-errno", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror", "-I", str(ROOT / "include"), "-I",
            str(ROOT)]

BALANCER_BOARD = """
#include "hal/hal.h"
enum jp_status board_read(void *context, struct jp_sensors *sensors);
enum jp_status board_write(void *context, const struct jp_actuation *actuation);
uint32_t board_time_us(void *context);
enum jp_status board_read(void *context, struct jp_sensors *sensors)
{
    (void)context;
    (void)sensors;
    return JP_OK;
}
enum jp_status board_write(void *context, const struct jp_actuation *actuation)
{
    (void)context;
    (void)actuation;
    return JP_OK;
}
uint32_t board_time_us(void *context)
{
    (void)context;
    return 0;
}
"""

PLANNER_BOARD = """
#include <joulepath/planner.h>
bool sensed_cell(int32_t *x, int32_t *y, enum jp_cell *cell);
void drive(const struct jp_primitive *primitive);
bool sensed_cell(int32_t *x, int32_t *y, enum jp_cell *cell)
{
    (void)x;
    (void)y;
    (void)cell;
    return false;
}
void drive(const struct jp_primitive *primitive)
{
    (void)primitive;
}
"""

PILOT_BOARD = """
#include <joulepath/pilot.h>
jp_q16 joules_left(void);
extern struct jp_robot robot;
struct jp_robot robot;
jp_q16 joules_left(void)
{
    return JP_Q16(1000);
}
"""

BOARDS = [PILOT_BOARD, PLANNER_BOARD, BALANCER_BOARD]


def readme():
    return (ROOT / "README.md").read_text(encoding="utf-8")


def examples():
    found = re.findall(r"^```c\n(.*?)^```", readme(), re.S | re.M)
    assert len(found) == len(BOARDS), "README.md has lost or gained a C example"
    return found


@pytest.fixture(params=range(3), ids=["pilot", "planner", "balancer"])
def sources(request, tmp_path):
    (tmp_path / "main.c").write_text(examples()[request.param], encoding="utf-8")
    (tmp_path / "board.c").write_text(BOARDS[request.param], encoding="utf-8")
    core = [*ROOT.glob("src/*.c"), *ROOT.glob("src/tables/*.c"), ROOT / "hal" / "hal.c"]
    if "pilot.h" in examples()[request.param]:
        core += ROOT.glob("src/float/*.c")
    return [tmp_path / "main.c", tmp_path / "board.c", *core], tmp_path


def build(command):
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


def test_example_builds_on_the_host(sources):
    files, directory = sources
    build(["gcc", *WARNINGS, *files, "-o", directory / "example"])


def test_example_builds_for_a_microcontroller(sources):
    files, directory = sources
    build(["arm-none-eabi-gcc", "-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard", "-Os", "--specs=nosys.specs", *WARNINGS, *files, "-o",
           directory / "example.elf"])


@pytest.mark.parametrize("mark, command", [("figures", "make figures"), ("plan", "make bench-plan")])
def test_figures_are_in_the_readme(mark, command):
    table = re.search(rf"<!-- {mark} -->\n(.*?)<!-- /{mark} -->", readme(), re.S)
    assert table, f"README.md has lost the marks of its table {mark}"
    rows = [line for line in table.group(1).splitlines() if line.startswith("|")]
    assert len(rows) > 2, f"the table is empty: run {command}"


def test_commands_are_targets():
    targets = set(re.findall(r"^([a-z-]+):.*##", (ROOT / "Makefile").read_text(encoding="utf-8"), re.M))
    named = set(re.findall(r"make ([a-z-]+)", readme()))
    assert named <= targets, f"README.md names {sorted(named - targets)}, which the Makefile has not"
