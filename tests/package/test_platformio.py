"""library.json: PlatformIO takes the package and builds programs from it.

PlatformIO's platforms and its copy of SCons come from its registry, which a test must not need. So the platform here is
one of a few lines, for the compiler of this machine, and SCons is that of PyPI.
"""
import json
import sys
import tarfile
from pathlib import Path
from unittest import mock

import pytest
from conftest import CLEAN, PROGRAMS, command
from platformio.dependencies import get_core_dependencies
from platformio.package.manifest.schema import ManifestSchema
from platformio.package.pack import PackagePacker

PLATFORM = {
    "platform.json": json.dumps({"name": "thismachine", "title": "This machine", "description": "Its own compiler",
                                 "version": "1.0.0", "packages": {}}),
    "platform.py": "from platformio.public import PlatformBase\n\n\nclass ThismachinePlatform(PlatformBase):\n"
                   "    pass\n",
    "builder/main.py": 'from SCons.Script import Default, DefaultEnvironment\n\nenv = DefaultEnvironment()\n'
                       'env.Replace(AR="ar", CC="gcc", CXX="g++", RANLIB="ranlib", PROGSUFFIX="")\n'
                       'Default(env.BuildProgram())\n',
}


def write_tree(directory, files):
    for name, text in files.items():
        path = directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return directory


@pytest.fixture
def pio(tmp_path):
    """Runs PlatformIO with a home of its own, in which SCons is already there."""
    scons = get_core_dependencies()["tool-scons"].lstrip("~")
    write_tree(tmp_path / "home" / "packages" / "tool-scons", {
        "package.json": json.dumps({"name": "tool-scons", "version": scons, "system": "*"}),
        ".piopm": json.dumps({"type": "tool", "name": "tool-scons", "version": scons,
                              "spec": {"owner": "platformio", "id": 1, "name": "tool-scons"}}),
        "scons.py": "import SCons.Script\nSCons.Script.main()\n",
    })
    environment = {**CLEAN, "PLATFORMIO_CORE_DIR": str(tmp_path / "home"), "PLATFORMIO_SETTING_ENABLE_TELEMETRY": "no",
                   "PLATFORMIO_SETTING_CHECK_PLATFORMIO_INTERVAL": "9999"}
    program = Path(sys.executable).parent / "pio"
    return lambda *arguments: command(program, *arguments, env=environment, cwd=tmp_path)


def project(directory, package, source, extra=""):
    platform = write_tree(directory / "platform", PLATFORM)
    return write_tree(directory / "project", {
        "platformio.ini": f"[env:test]\nplatform = symlink://{platform}\n{extra}",
        f"src/{source}": (PROGRAMS / source).read_text("utf-8"),
    }), directory / "project" / ".pio" / "build" / "test" / "program"


def test_it_is_a_valid_package(package, version, tmp_path):
    """As `pio pkg pack`, but with a list of licences that is here: PlatformIO fetches it anew each time."""
    licences = {"licenses": [{"licenseId": "MIT"}]}
    with mock.patch.object(ManifestSchema, "load_spdx_licenses", staticmethod(lambda: licences)):
        packed = PackagePacker(str(package)).pack(str(tmp_path / "packed.tar.gz"))
    with tarfile.open(packed) as archive:
        manifest = json.load(archive.extractfile("library.json"))
        names = set(archive.getnames())
    assert (manifest["name"], manifest["version"]) == ("joulepath", version)
    assert {"include/joulepath/robot.h", "src/balancer/robot.c", "hal/hal.h", "LICENSE"} <= names
    for header in manifest["headers"]:
        assert header in names or f"include/{header}" in names


def test_a_project_builds_with_the_archive(pio, package, tmp_path):
    directory, program = project(tmp_path, package, "float_consumer.c", f"lib_deps = file://{package}.tar.gz\n")
    pio("run", "-d", directory)
    command(program)


def test_a_project_builds_with_the_directory_in_lib(pio, package, tmp_path):
    directory, program = project(tmp_path, package, "firmware.c")
    (directory / "lib").mkdir()
    (directory / "lib" / "joulepath").symlink_to(package)
    pio("run", "-d", directory)
    command(program)
