"""`make install`: what it puts where, and that pkg-config and CMake find and use it."""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import BUILT, CLEAN, PROGRAMS, ROOT, WARNINGS, cmake_project, command, configure, make

FIND = "find_package(joulepath {} CONFIG REQUIRED)\n"
FLOAT_LINK = (f"add_executable(user {PROGRAMS}/float_consumer.c)\n"
              "target_link_libraries(user PRIVATE joulepath::float)\n")
LINK = f"add_executable(user {PROGRAMS}/consumer.c)\ntarget_link_libraries(user PRIVATE joulepath::joulepath)\n"


def files_of(directory):
    return sorted(str(path.relative_to(directory)) for path in directory.rglob("*") if path.is_file())


def contents_of(directory):
    return {name: (directory / name).read_bytes() for name in files_of(directory)}


def pkg_config(installed, *arguments, package="joulepath"):
    return command("pkg-config", *arguments, package,
                   env={**CLEAN, "PKG_CONFIG_PATH": str(installed / "lib" / "pkgconfig")}).split()


def test_files_are_where_people_expect_them(installed):
    headers = [f"include/joulepath/{path.name}" for path in (ROOT / "include" / "joulepath").glob("*.h")]
    assert [name for name in files_of(installed) if not name.startswith(("lib/joulepath/", "bin/"))] == sorted([
        *headers, "lib/libjoulepath.a", "lib/libjoulepath_float.a", "lib/pkgconfig/joulepath.pc",
        "lib/pkgconfig/joulepath-float.pc", "lib/cmake/joulepath/joulepathConfig.cmake", "lib/cmake/joulepath/joulepathConfigVersion.cmake", "share/doc/joulepath/LICENSE"])


def test_everybody_may_read_the_files(build, tmp_path):
    prefix = tmp_path / "usr"
    command("sh", "-c", 'umask 077; exec "$@"', "-", "make", "-C", ROOT, f"BUILD={build}", f"PREFIX={prefix}",
            f"PROGRAMS={BUILT}", "install", env={**CLEAN, "JP_SETUP": "skip"})
    for path in filter(Path.is_file, prefix.rglob("*")):
        is_program = path.parent.name == "bin"
        assert path.stat().st_mode & 0o777 == (0o755 if is_program else 0o644), path


def test_the_command_joulepath_runs_programs_and_tools(installed, tmp_path):
    door = installed / "bin/joulepath"
    assert '"burger"' in command(door, "robot", "burger", "--json=-", cwd=tmp_path)
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    said = command(door, "gains", "courier24", "--tables", tmp_path, cwd=tmp_path, env={**CLEAN, "PATH": path})
    assert "modulus margin" in said
    assert (tmp_path / "robot_courier24.c").read_text() == (ROOT / "src/tables/robot_courier24.c").read_text()


def test_a_program_uses_it_by_pkg_config(installed, version, tmp_path):
    assert pkg_config(installed, "--modversion") == [version]
    command("gcc", "-std=c11", *WARNINGS, *pkg_config(installed, "--cflags"), PROGRAMS / "consumer.c",
            *pkg_config(installed, "--libs"), "-o", tmp_path / "user")
    command(tmp_path / "user")


@pytest.mark.parametrize("compiler", [["gcc", "-std=c11"], ["g++", "-std=c++17", "-x", "c++"]], ids=["c", "c++"])
def test_a_program_uses_the_part_in_floating_point(installed, version, tmp_path, compiler):
    flags, libraries = (pkg_config(installed, kind, package="joulepath-float") for kind in ("--cflags", "--libs"))
    assert pkg_config(installed, "--modversion", package="joulepath-float") == [version]
    command(*compiler, *WARNINGS, *flags, PROGRAMS / "float_consumer.c", "-x", "none", *libraries, "-o",
            tmp_path / "user")
    command(tmp_path / "user")


def test_a_program_in_cpp_uses_it(installed, tmp_path):
    command("g++", "-std=c++17", *WARNINGS, *pkg_config(installed, "--cflags"), "-x", "c++", PROGRAMS / "consumer.c",
            "-x", "none", *pkg_config(installed, "--libs"), "-o", tmp_path / "user")
    command(tmp_path / "user")


@pytest.mark.parametrize("link", [LINK, FLOAT_LINK], ids=["joulepath", "float"])
def test_a_program_uses_it_by_find_package(installed, version, tmp_path, link):
    project = cmake_project(tmp_path / "project", FIND.format(version) + link)
    configure(project, tmp_path / "build", f"-DCMAKE_PREFIX_PATH={installed}")
    command("cmake", "--build", tmp_path / "build")
    command(tmp_path / "build" / "user")


def requests(version):
    """Versions that somebody may ask for, and whether ours serves."""
    major, minor, patch = (int(part) for part in version.split("."))
    series = [f"{major}.{minor}"] if major == 0 else [f"{major}", f"{major}.{minor}"]
    older = f"0.{max(minor - 1, 0)}" if major == 0 else f"{major - 1}.0"
    newer = [f"{major}.{minor}.{patch + 1}", f"{major}.{minor + 1}", f"{major + 1}.0"]
    return {**dict.fromkeys([*newer, older, f"{newer[0]} EXACT"], False),
            **dict.fromkeys([*series, version, f"{version} EXACT"], True)}


def test_find_package_takes_compatible_versions_only(installed, version, tmp_path):
    wanted = requests(version)
    ask = "".join(f'find_package(joulepath {request} CONFIG)\nmessage(STATUS "{request}: ${{joulepath_FOUND}}")\n'
                  "unset(joulepath_DIR CACHE)\n" for request in wanted)
    answer = configure(cmake_project(tmp_path, ask), tmp_path / "build", f"-DCMAKE_PREFIX_PATH={installed}")
    found = dict(re.findall(r"^-- (.*): (\d)$", answer, re.M))
    assert found == {request: str(int(suits)) for request, suits in wanted.items()}


def test_the_cmake_package_may_be_moved_and_found_twice(installed, tmp_path):
    shutil.copytree(installed, tmp_path / "elsewhere")
    project = cmake_project(tmp_path / "project", FIND.format("") * 2 + LINK)
    configure(project, tmp_path / "build", f"-DCMAKE_PREFIX_PATH={tmp_path / 'elsewhere'}")
    command("cmake", "--build", tmp_path / "build")
    command(tmp_path / "build" / "user")


def test_destdir_stages_the_same_files_without_its_path(build, tmp_path):
    stage = tmp_path / "stage"
    make(f"BUILD={build}", f"DESTDIR={stage}", "PREFIX=/opt/joulepath", f"PROGRAMS={BUILT}", "install")
    assert [path.name for path in stage.iterdir()] == ["opt"]
    assert "prefix=/opt/joulepath\n" in (stage / "opt/joulepath/lib/pkgconfig/joulepath.pc").read_text("utf-8")
    for name, content in contents_of(stage).items():
        for path in (stage, build, ROOT):
            assert os.fsencode(path) not in content, f"{name} names {path}"


def test_installing_again_changes_nothing(build, tmp_path):
    make(f"BUILD={build}", f"PREFIX={tmp_path}", f"PROGRAMS={BUILT}", "install")
    first = contents_of(tmp_path)
    make(f"BUILD={build}", f"PREFIX={tmp_path}", f"PROGRAMS={BUILT}", "install")
    assert contents_of(tmp_path) == first


def test_uninstall_removes_all_of_it_and_nothing_else(build, tmp_path):
    foreign = tmp_path / "lib" / "pkgconfig" / "other.pc"
    make(f"BUILD={build}", f"PREFIX={tmp_path}", f"PROGRAMS={BUILT}", "install")
    foreign.write_text("Name: other\n", encoding="utf-8")
    make(f"BUILD={build}", f"PREFIX={tmp_path}", "uninstall")
    assert files_of(tmp_path) == ["lib/pkgconfig/other.pc"]
    assert not list(tmp_path.rglob("joulepath*"))
    make(f"BUILD={build}", f"PREFIX={tmp_path}", "uninstall")


@pytest.mark.parametrize("target", ["install", "uninstall"])
@pytest.mark.parametrize("prefix", ["", "here/usr"])
def test_a_prefix_must_be_absolute(build, target, prefix):
    result = subprocess.run(["make", "-C", ROOT, f"BUILD={build}", f"PREFIX={prefix}", f"PROGRAMS={BUILT}", target], capture_output=True,
                            text=True, check=False, env={**CLEAN, "JP_SETUP": "skip"})
    assert result.returncode == 2
    assert f"PREFIX={prefix}: must be an absolute path" in result.stderr
    assert not (ROOT / "here").exists()


@pytest.mark.parametrize("compiler", [["gcc", "-std=c11", "-x", "c"], ["clang", "-std=c11", "-x", "c"],
                                      ["g++", "-std=c++11", "-x", "c++"], ["clang++", "-std=c++17", "-x", "c++"]],
                         ids=["gcc", "clang", "g++", "clang++"])
def test_each_installed_header_compiles_alone(installed, compiler):
    for header in sorted((installed / "include" / "joulepath").glob("*.h")):
        command(*compiler, *WARNINGS, "-fsyntax-only", "-I", installed / "include", "-",
                input=f"#include <joulepath/{header.name}>\n")
