"""`make package`: the same bytes every time, and firmware that CMake builds from it for a host and for cores."""
import re
import subprocess
import tarfile
from pathlib import Path

import pytest
from conftest import CLEAN, PROGRAMS, ROOT, WARNINGS, cmake_project, command, configure, make

# Compiler, flags of the core, flags of its C library.
CORES = {
    "cortex-m0": ("arm-none-eabi-", "-mthumb -mcpu=cortex-m0", "--specs=nosys.specs"),
    "rv32imac": ("riscv64-unknown-elf-", "-march=rv32imac -mabi=ilp32", "--specs=picolibc.specs"),
}

def add(package):
    return f"add_subdirectory({package} joulepath)\n"


def user_of(target, program, name="user"):
    return (f"add_executable({name} {program})\ntarget_link_libraries({name} PRIVATE joulepath::{target})\n"
            f"target_compile_options({name} PRIVATE {' '.join(WARNINGS)})\n")


def build_project(directory, body, *definitions, languages="C"):
    configure(cmake_project(directory, body, languages), directory / "build", *definitions)
    command("cmake", "--build", directory / "build", "--parallel", "2")


def sources_of(package, place, robots, library="joulepath"):
    """The names of what a library is made of, as CMake says."""
    ask = f'get_target_property(found {library} SOURCES)\nmessage(STATUS "sources: ${{found}}")\n'
    answer = configure(cmake_project(place, add(package) + ask), place / "build", f"-DJOULEPATH_ROBOTS={robots}")
    return {Path(name).stem for name in re.search(r"sources: (.*)", answer)[1].split(";")}


def test_it_holds_what_firmware_needs_and_no_more(package):
    assert sorted(path.name for path in package.iterdir()) == [
        "CMakeLists.txt", "LICENSE", "README.md", "examples", "hal", "idf_component.yml", "include", "library.json",
        "src", "zephyr"]
    folders = {str(path.relative_to(package)) for path in (package / "hal").iterdir() if path.is_dir()}
    assert folders == {"hal/app", "hal/can", "hal/skeleton", "hal/storage"}
    for folder in ("include/joulepath", "src", "hal/app", "hal/can", "hal/storage"):
        here = {path.relative_to(ROOT) for path in (ROOT / folder).rglob("*.[ch]")}
        assert {path.relative_to(package) for path in (package / folder).rglob("*.[ch]")} == here


def test_its_links_lead_somewhere(package):
    for name in ("hal/README.md", "hal/skeleton/board.c", "hal/skeleton/main.c"):
        assert (package / name).is_file()
    assert "](hal/README.md)" in (package / "README.md").read_text("utf-8")


def test_it_is_the_same_every_time(package, build, version, tmp_path):
    archive = package.parent / f"{package.name}.tar.gz"
    make(f"BUILD={tmp_path}", "package", TZ="Asia/Tokyo", LC_ALL="C")
    assert (tmp_path / "package" / archive.name).read_bytes() == archive.read_bytes()


def test_the_archive_holds_the_directory_and_nothing_of_this_machine(package, tmp_path):
    with tarfile.open(f"{package}.tar.gz") as archive:
        members = archive.getmembers()
        archive.extractall(tmp_path, filter="data")
    assert {(member.uid, member.gid, member.uname, member.gname) for member in members} == {(0, 0, "", "")}
    assert len({member.mtime for member in members}) == 1
    command("diff", "-r", package, tmp_path / package.name)
    for path in package.rglob("*"):
        assert path.is_dir() or str(ROOT).encode() not in path.read_bytes(), path


def test_a_usage_error_is_one_line():
    result = subprocess.run([ROOT / "tools" / "packaging" / "package.sh"], capture_output=True, text=True, check=False)
    assert (result.returncode, len(result.stderr.splitlines())) == (2, 1)


def test_programs_in_c_and_cpp_add_it_as_a_subdirectory(package, tmp_path):
    in_cpp = tmp_path / "firmware.cpp"
    in_cpp.write_bytes((PROGRAMS / "firmware.c").read_bytes())
    users = {"consumer": ("joulepath", PROGRAMS / "consumer.c"), "firmware": ("hal", PROGRAMS / "firmware.c"),
             "in_cpp": ("hal", in_cpp), "float_consumer": ("float", PROGRAMS / "float_consumer.c")}
    build_project(tmp_path, add(package) + "".join(user_of(*user, name) for name, user in users.items()),
                  languages="C CXX")
    for name in users:
        command(tmp_path / "build" / name)


def test_a_program_fetches_the_archive(package, tmp_path):
    """The part in floating point, which it does not use, is not built."""
    fetch = (f"include(FetchContent)\nFetchContent_Declare(joulepath URL {package}.tar.gz)\n"
             "FetchContent_MakeAvailable(joulepath)\n")
    build_project(tmp_path, fetch + user_of("joulepath", PROGRAMS / "consumer.c"))
    command(tmp_path / "build" / "user")
    libraries = {path.name for path in (tmp_path / "build").rglob("*.a")}
    assert "libjoulepath.a" in libraries and "libjoulepath_float.a" not in libraries


def test_only_the_tables_of_the_named_robots_are_built_in(package, tmp_path):
    sources = sources_of(package, tmp_path, "courier24")
    assert {"robot_courier24", "energy_courier24", "energy_courier24_battery", "robot"} <= sources
    assert not any("gao2018" in name or "zhang2018" in name for name in sources)


def test_a_robot_s_tables_in_floating_point_are_built_in_with_it(package, tmp_path):
    for robots, tables in (("", {"patrol_patrol"}), ("patrol", {"patrol_patrol"}), ("courier24", set())):
        sources = sources_of(package, tmp_path / f"robots_{robots}", robots, library="joulepath_float")
        assert {name for name in sources if name.startswith("patrol_patrol")} == tables
        assert "teb" in sources


def test_a_robot_without_tables_is_an_error(package, tmp_path):
    project = cmake_project(tmp_path, add(package))
    result = subprocess.run(["cmake", "-S", project, "-B", tmp_path / "build", "-DJOULEPATH_ROBOTS=courier24;rover"],
                            capture_output=True, text=True, check=False, env=CLEAN)
    assert result.returncode != 0
    assert "JOULEPATH_ROBOTS: no table src/tables/*_rover.c" in result.stderr.replace("\n  ", " ")


def test_the_version_of_the_cmake_project_is_the_header_s(package, version, tmp_path):
    ask = (f"get_directory_property(found DIRECTORY {package} DEFINITION PROJECT_VERSION)\n"
           'message(STATUS "version: ${found}")\n')
    assert f"version: {version}\n" in configure(cmake_project(tmp_path, add(package) + ask), tmp_path / "build")


@pytest.mark.parametrize("core", CORES)
def test_the_skeleton_is_built_for_a_core_with_a_toolchain_file(package, tmp_path, core):
    prefix, flags, library = CORES[core]
    (tmp_path / "toolchain.cmake").write_text(
        "set(CMAKE_SYSTEM_NAME Generic)\n"
        "set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)\n"
        f"set(CMAKE_C_COMPILER {prefix}gcc)\n"
        f'set(CMAKE_C_FLAGS_INIT "{flags} {library} -Os")\n'
        # What the timer's interrupt of a port refers to.
        'set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,--gc-sections -Wl,--undefined=control_tick")\n', encoding="utf-8")
    skeleton = f"{package}/hal/skeleton/main.c {package}/hal/skeleton/board.c"
    build_project(tmp_path, add(package) + user_of("hal", skeleton),
                  f"-DCMAKE_TOOLCHAIN_FILE={tmp_path / 'toolchain.cmake'}")
    symbols = command(f"{prefix}nm", tmp_path / "build" / "user").split()
    assert {"control_tick", "board_write", "jp_robot_control", "jp_robot_courier24"} <= set(symbols)
    assert "jp_robot_gao2018" not in symbols, "a table that nobody uses takes flash"


@pytest.mark.parametrize("compiler", [["gcc", "-std=c11", "-x", "c"], ["g++", "-std=c++17", "-x", "c++"]],
                         ids=["c", "c++"])
def test_each_header_of_the_hal_compiles_alone(package, compiler):
    headers = [path for path in package.glob("hal/**/*.h")]
    assert len(headers) > 10
    for header in headers:
        command(*compiler, *WARNINGS, "-fsyntax-only", "-I", package / "include", "-I", package, "-",
                input=f'#include "{header.relative_to(package)}"\n')


def test_every_public_function_has_the_linkage_of_c_in_cpp(package):
    """`clang++` lists each function of all headers with the name that the linker will see: of static ones it begins with
    _ZL, of what C++ adds to a structure with _ZN."""
    headers = [*package.glob("include/joulepath/*.h"), *package.glob("hal/**/*.h")]
    listing = command("clang++", "-std=c++17", "-fsyntax-only", "-Xclang", "-ast-dump=json", "-Xclang",
                      "-ast-dump-filter=jp_", "-I", package / "include", "-I", package, "-x", "c++", "-",
                      input="".join(f'#include "{header}"\n' for header in headers))
    names = set(re.findall(r'"mangledName": "(\w*jp_\w*)"', listing))
    assert {"jp_robot_init", "jp_obstacles_add", "jp_hal_tick", "jp_ecu_tick"} <= names
    assert not {name for name in names if re.match("_Z(?![LN])", name)}, "not extern C"
