"""The Arduino library: its description, and its example sketch, on a board of this machine and compiled for others.

Arduino's tool chains come from a registry that a test must not need. What stands for them: its rules of where sources and
headers are, Debian's compilers for the cores of the RP2040 and the ESP32-C3, and the functions that the sketch calls.
"""
import re
import zipfile

import pytest
from conftest import PROGRAMS, command

LOOK = ["-I", PROGRAMS / "arduino_stand_ins"]
# As Arduino compiles: the library's folder src is the only one with headers, and every source below it belongs to it.
FLAGS = ["-Os", "-ffunction-sections", "-fdata-sections", "-Wall", "-Werror"]
CORES = {"rp2040": ["arm-none-eabi-", "-mcpu=cortex-m0plus", "-mthumb"],
         "esp32c3": ["riscv64-unknown-elf-", "-march=rv32imc", "-mabi=ilp32", "--specs=picolibc.specs"]}


@pytest.fixture(scope="module")
def library(build, version, tmp_path_factory):
    folder = tmp_path_factory.mktemp("arduino")
    with zipfile.ZipFile(build / f"package/joulepath-arduino-{version}.zip") as archive:
        archive.extractall(folder)
    return folder / "Joulepath"


def sketch(library, folder):
    """As C++, which Arduino makes of it."""
    path = folder / "Balancer.cpp"
    path.write_text((library / "examples/Balancer/Balancer.ino").read_text("utf-8"), "utf-8")
    return path


def test_its_description_is_complete(library, version):
    properties = dict(line.split("=", 1) for line in (library / "library.properties").read_text().splitlines())
    assert set(properties) >= {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url",
                               "architectures"}
    assert properties["version"] == version and properties["architectures"] == "*"
    assert (library / "src" / properties["includes"]).is_file()
    assert {path.name for path in library.iterdir()} == {"LICENSE", "library.properties", "src", "examples"}


def test_each_source_finds_its_headers_below_src(library):
    for path in [*library.rglob("*.[ch]")]:
        for name in re.findall(r'#include ["<]((?:joulepath|hal|src)/[^">]+)[">]', path.read_text("utf-8")):
            assert (library / "src" / name).is_file(), f"{path}: {name}"


def test_the_sketch_drives_a_robot_and_stops_it(library, installed, tmp_path):
    command("gcc", "-c", "-O1", "-I", library / "src", library / "src/hal/hal.c", cwd=tmp_path)
    command("g++", "-std=gnu++17", "-O1", "-Wall", "-Wextra", "-Wno-missing-field-initializers", "-Werror", *LOOK, "-I",
            library / "src", sketch(library, tmp_path), PROGRAMS / "arduino_board.cpp", tmp_path / "hal.o",
            installed / "lib/libjoulepath.a", "-lm", "-o", tmp_path / "board")
    command(tmp_path / "board")


@pytest.mark.parametrize("core", CORES)
def test_sketch_and_library_compile_for(library, tmp_path, core):
    prefix, *options = CORES[core]
    used = ["src/balancer/robot.c", "src/trajectory/trajectory_rule.c", "src/navigate/pilot.c", "hal/hal.c"]
    command(f"{prefix}gcc", "-std=gnu11", *options, *FLAGS, "-I", library / "src", "-c",
            *(library / "src" / (f"src/{name[4:]}" if name.startswith("src/") else name) for name in used), cwd=tmp_path)
    command(f"{prefix}g++", "-std=gnu++17", *options, *FLAGS, *LOOK, "-I", library / "src", "-c",
            sketch(library, tmp_path), cwd=tmp_path)
