"""What the tests of the packages share: an installed tree, a source package, programs that use them."""
import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = Path(__file__).parent
WARNINGS = ["-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror"]

# What a user of a package has: neither the paths of this build nor its make.
CLEAN = {name: value for name, value in os.environ.items()
         if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "CFLAGS", "CXXFLAGS", "LDFLAGS", "PKG_CONFIG_PATH")}


def command(*words, **options):
    """Run a program that must succeed and return what it printed."""
    options.setdefault("env", CLEAN)
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **options)
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


def make(*arguments, **environment):
    return command("make", "-C", ROOT, *arguments, env={**CLEAN, "JP_SETUP": "skip", **environment})


def configure(source, build, *definitions):
    return command("cmake", "-S", source, "-B", build, "-G", "Unix Makefiles", *definitions)


def cmake_project(directory, body):
    """A project of a user, whose CMakeLists.txt says this after its head."""
    directory.mkdir(parents=True, exist_ok=True)
    (directory / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.16)\nproject(user LANGUAGES C CXX)\n{body}", encoding="utf-8")
    return directory


@pytest.fixture(scope="session")
def version():
    """As the header says: the only place where it stands."""
    program = "#include <joulepath/version.h>\nJP_VERSION_MAJOR.JP_VERSION_MINOR.JP_VERSION_PATCH\n"
    text = command("gcc", "-E", "-P", "-I", ROOT / "include", "-", input=program)
    return text.strip().replace(" ", "")


@pytest.fixture(scope="session")
def build(tmp_path_factory):
    """A build directory of its own: `make install` compiles there."""
    return tmp_path_factory.mktemp("build")


@pytest.fixture(scope="session")
def package(build, version):
    make(f"BUILD={build}", "package")
    return build / "package" / f"joulepath-{version}"


@pytest.fixture(scope="session")
def installed(build, tmp_path_factory):
    """The prefix of an installation."""
    prefix = tmp_path_factory.mktemp("installed") / "usr"
    make(f"BUILD={build}", f"PREFIX={prefix}", "install")
    return prefix
