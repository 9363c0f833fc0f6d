"""README.md: its first example is firmware that compiles and links, and its table of figures was made by a command."""
import re
import subprocess

import pytest
from conftest import ROOT

WARNINGS = ["-std=c11", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror", "-I", str(ROOT / "include"), "-I",
            str(ROOT)]

BOARD = """
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


def readme():
    return (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.fixture
def sources(tmp_path):
    example = re.search(r"^```c\n(.*?)^```", readme(), re.S | re.M)
    assert example, "README.md has no C example"
    (tmp_path / "main.c").write_text(example.group(1), encoding="utf-8")
    (tmp_path / "board.c").write_text(BOARD, encoding="utf-8")
    core = [*ROOT.glob("src/*.c"), *ROOT.glob("src/tables/*.c"), ROOT / "hal" / "hal.c"]
    return [tmp_path / "main.c", tmp_path / "board.c", *core], tmp_path


def build(command):
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


def test_first_example_builds_on_the_host(sources):
    files, directory = sources
    build(["gcc", *WARNINGS, *files, "-o", directory / "example"])


def test_first_example_builds_for_a_microcontroller(sources):
    files, directory = sources
    build(["arm-none-eabi-gcc", "-mcpu=cortex-m4", "-mthumb", "-Os", "--specs=nosys.specs", *WARNINGS, *files, "-o",
           directory / "example.elf"])


def test_figures_are_in_the_readme():
    table = re.search(r"<!-- figures -->\n(.*?)<!-- /figures -->", readme(), re.S)
    assert table, "README.md has lost the marks of its table"
    rows = [line for line in table.group(1).splitlines() if line.startswith("|")]
    assert len(rows) > 2, "the table is empty: run make figures"


def test_commands_are_targets():
    targets = set(re.findall(r"^([a-z]+):.*##", (ROOT / "Makefile").read_text(encoding="utf-8"), re.M))
    named = set(re.findall(r"make ([a-z]+)", readme()))
    assert named <= targets, f"README.md names {sorted(named - targets)}, which the Makefile has not"
