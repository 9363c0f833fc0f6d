"""The Zephyr module: its description, its options and its build.

Zephyr itself is too large to be here. What stands for it: the keys that its module description may have, kconfiglib,
which is the Kconfig of its build, and its five CMake functions that the module calls.
"""
from pathlib import Path

import kconfiglib
import pytest
import yaml
from conftest import PROGRAMS, WARNINGS, cmake_project, command, configure

# Of scripts/zephyr_module.py, which refuses others: the keys of "build" that a library needs.
BUILD_KEYS = {"cmake", "kconfig"}

# As cmake/modules/extensions.cmake documents them.
ZEPHYR = """
add_library(zephyr_interface INTERFACE)

function(zephyr_include_directories)
  target_include_directories(zephyr_interface INTERFACE ${ARGV})
endfunction()

macro(zephyr_library_named name)
  set(ZEPHYR_CURRENT_LIBRARY ${name})
  add_library(${name} STATIC "")
  target_link_libraries(${name} PUBLIC zephyr_interface)
  set_property(GLOBAL APPEND PROPERTY ZEPHYR_LIBS ${name})
endmacro()

function(zephyr_library_sources)
  target_sources(${ZEPHYR_CURRENT_LIBRARY} PRIVATE ${ARGV})
endfunction()

function(zephyr_library_include_directories)
  target_include_directories(${ZEPHYR_CURRENT_LIBRARY} PRIVATE ${ARGV})
endfunction()

function(zephyr_library_compile_options)
  target_compile_options(${ZEPHYR_CURRENT_LIBRARY} PRIVATE ${ARGV})
endfunction()
"""

APPLICATION = """
add_executable({name} {program})
target_link_libraries({name} PRIVATE -Wl,--whole-archive ${{libraries}} -Wl,--no-whole-archive zephyr_interface)
target_compile_options({name} PRIVATE {warnings})
"""


def configuration(package, tmp_path, *lines):
    """The symbols that are on after Kconfig has read prj.conf."""
    top = tmp_path / "Kconfig"
    top.write_text(f'mainmenu "test"\nsource "{package / "zephyr" / "Kconfig"}"\n', encoding="utf-8")
    (tmp_path / "prj.conf").write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    kconfig = kconfiglib.Kconfig(str(top), suppress_traceback=True)
    kconfig.load_config(str(tmp_path / "prj.conf"))
    assert kconfig.warnings == []
    return {name: symbol.str_value for name, symbol in kconfig.syms.items() if name.startswith("JOULEPATH")}


def build(package, directory, options, *programs):
    """Applications that hold all of the module."""
    switches = "".join(f"set(CONFIG_{name} {value})\n" for name, value in options.items() if value == "y")
    module = yaml.safe_load((package / "zephyr" / "module.yml").read_text("utf-8"))["build"]["cmake"]
    applications = "".join(APPLICATION.format(name=Path(program).stem, program=PROGRAMS / program,
                                              warnings=" ".join(WARNINGS)) for program in programs)
    project = cmake_project(directory / "app", f"{ZEPHYR}{switches}add_subdirectory({package / module} module)\n"
                            f"get_property(libraries GLOBAL PROPERTY ZEPHYR_LIBS)\n{applications}")
    configure(project, directory / "build")
    command("cmake", "--build", directory / "build", "--parallel", "2")
    for program in programs:
        command(directory / "build" / Path(program).stem)


def test_the_description_names_files_that_are_there(package):
    module = yaml.safe_load((package / "zephyr" / "module.yml").read_text("utf-8"))
    assert set(module) == {"name", "build"}
    assert set(module["build"]) == BUILD_KEYS
    assert (package / module["build"]["cmake"] / "CMakeLists.txt").is_file()
    assert (package / module["build"]["kconfig"]).is_file()


@pytest.mark.parametrize("lines, expected", [
    ([], {"JOULEPATH": "n", "JOULEPATH_HAL": "n", "JOULEPATH_FLOAT": "n"}),
    (["CONFIG_JOULEPATH=y"], {"JOULEPATH": "y", "JOULEPATH_HAL": "y", "JOULEPATH_FLOAT": "n"}),
    (["CONFIG_JOULEPATH=y", "CONFIG_JOULEPATH_HAL=n"], {"JOULEPATH": "y", "JOULEPATH_HAL": "n", "JOULEPATH_FLOAT": "n"}),
    (["CONFIG_JOULEPATH=y", "CONFIG_JOULEPATH_FLOAT=y"], {"JOULEPATH": "y", "JOULEPATH_HAL": "y", "JOULEPATH_FLOAT": "y"}),
], ids=["off", "on", "without the HAL", "with floating point"])
def test_options_have_these_values(package, tmp_path, lines, expected):
    assert configuration(package, tmp_path, *lines) == expected


def test_an_application_is_built_with_the_hal(package, tmp_path):
    build(package, tmp_path, configuration(package, tmp_path, "CONFIG_JOULEPATH=y"), "firmware.c")


def test_applications_are_built_with_floating_point_and_without_the_hal(package, tmp_path):
    options = configuration(package, tmp_path, "CONFIG_JOULEPATH=y", "CONFIG_JOULEPATH_HAL=n",
                            "CONFIG_JOULEPATH_FLOAT=y")
    build(package, tmp_path, options, "consumer.c", "float_consumer.c")


def test_a_module_that_is_off_builds_nothing(package, tmp_path):
    project = cmake_project(tmp_path, f"{ZEPHYR}add_subdirectory({package}/zephyr module)\n"
                            "get_property(libraries GLOBAL PROPERTY ZEPHYR_LIBS)\n"
                            'message(STATUS "libraries: [${libraries}]")\n')
    assert "libraries: []" in configure(project, tmp_path / "build")
