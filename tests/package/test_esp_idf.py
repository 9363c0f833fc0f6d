"""The component for ESP-IDF: its manifest, its build and its example.

ESP-IDF cannot be installed here. What stands for it: its two CMake calls, its early reading of a component as a script,
esp_timer, and Debian's compiler for the ESP32-C3's core.
"""
import re

import pytest
import yaml
from conftest import PROGRAMS, command, configure

COMPONENT = "${CMAKE_CURRENT_LIST_DIR}/component"
# As tools/cmake/component.cmake documents it.
IDF = """
set(ESP_PLATFORM 1)
macro(idf_component_register)
  cmake_parse_arguments(_ "" "" "SRCS;INCLUDE_DIRS;REQUIRES" ${ARGN})
  if(CMAKE_SCRIPT_MODE_FILE)
    return()
  endif()
  set(COMPONENT_LIB joulepath)
  add_library(joulepath STATIC ${__SRCS})
  target_include_directories(joulepath PUBLIC ${__INCLUDE_DIRS})
endmacro()
"""
TIMER = "#include <esp_timer.h>\nint64_t esp_timer_get_time(void) { static int64_t now; return now += 1000; }\n" \
        "void app_main(void);\nint main(void) { app_main(); return 0; }\n"


@pytest.fixture
def project(package, tmp_path):
    (tmp_path / "component").symlink_to(package)
    (tmp_path / "idf.cmake").write_text(IDF)
    (tmp_path / "board.c").write_text(TIMER)
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\nproject(plan LANGUAGES C)\ninclude(idf.cmake)\n"
        f"add_subdirectory({COMPONENT} component)\n"
        f"add_executable(plan {COMPONENT}/examples/plan/main/main.c board.c)\n"
        f"target_include_directories(plan PRIVATE {PROGRAMS}/esp_idf_stand_ins)\n"
        "target_compile_options(plan PRIVATE -Wall -Wextra -Werror)\ntarget_link_libraries(plan PRIVATE joulepath m)\n")
    return tmp_path


def test_the_manifest_says_what_it_is(package, version):
    manifest = yaml.safe_load((package / "idf_component.yml").read_text())
    assert manifest["version"] == version and manifest["license"] == "MIT" and manifest["dependencies"]["idf"] == ">=5.0"
    assert all((package / each["path"]).is_dir() for each in manifest["examples"])
    example = yaml.safe_load((package / "examples/plan/main/idf_component.yml").read_text())
    override = example["dependencies"]["joulepath"]["override_path"]
    assert (package / "examples/plan/main" / override).resolve() == package.resolve()


def test_it_can_be_read_as_a_script(project):
    (project / "early.cmake").write_text("include(${CMAKE_CURRENT_LIST_DIR}/idf.cmake)\n"
                                         "include(${CMAKE_CURRENT_LIST_DIR}/component/CMakeLists.txt)\n")
    command("cmake", "-P", project / "early.cmake")


def test_the_example_plans(project):
    configure(project, project / "build", "-DCMAKE_BUILD_TYPE=Release")
    command("cmake", "--build", project / "build", "--parallel", "2")
    said = command(project / "build/plan")
    assert re.fullmatch(r"\d+ steps, \d+\.\d J, proved within \d+/256 of the optimum, after 1000 us\n", said)


def test_the_example_compiles_for_the_esp32c3(package, tmp_path):
    command("riscv64-unknown-elf-gcc", "-march=rv32imc", "-mabi=ilp32", "--specs=picolibc.specs", "-std=gnu11", "-Os",
            "-Wall", "-Wextra", "-Werror", "-I", package / "include", "-I", PROGRAMS / "esp_idf_stand_ins", "-c",
            package / "examples/plan/main/main.c", "-o", tmp_path / "main.o")
