"""What the tests of the packages share: an installed tree, a source package, programs that use them."""
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from once import once  # noqa: E402

PROGRAMS = Path(__file__).parent
# What `make install` need not compile anew.
BUILT = " ".join(sorted(map(str, (Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve() / "bin").glob("jp-*"))))
WARNINGS = ["-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror"]

# What a user of a package has: neither the paths of this build nor its make.
CLEAN = {name: value for name, value in os.environ.items()
         if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "CFLAGS", "CXXFLAGS", "LDFLAGS", "PKG_CONFIG_PATH")}


def core_sources(robot):
    """What every core compiles: no floating point, the tables of one robot."""
    single = {path for line in (ROOT / "src/single_precision.txt").read_text("utf-8").split() for path in ROOT.glob(line)}
    return [path for path in ROOT.glob("src/*/*.c")
            if path not in single and (path.parent.name != "tables" or path.stem.endswith(f"_{robot}"))]


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


def cmake_project(directory, body, languages="C"):
    """A project of a user, whose CMakeLists.txt says this after its head. For each language CMake tries a compiler."""
    directory.mkdir(parents=True, exist_ok=True)
    (directory / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.16)\nproject(user LANGUAGES {languages})\n{body}", encoding="utf-8")
    return directory


@pytest.fixture(scope="session")
def version():
    """As the header says: the only place where it stands."""
    program = "#include <joulepath/version.h>\nJP_VERSION_MAJOR.JP_VERSION_MINOR.JP_VERSION_PATCH\n"
    text = command("gcc", "-E", "-P", "-I", ROOT / "include", "-", input=program)
    return text.strip().replace(" ", "")


def make_packages(folder):
    """`make install` compiles the library in a build directory of its own; the programs are there."""
    make(f"BUILD={folder}/build", "package")
    make(f"BUILD={folder}/build", f"PREFIX={folder}/usr", f"PROGRAMS={BUILT}", "install")


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    return once(tmp_path_factory, "packages", make_packages)


@pytest.fixture(scope="session")
def build(made):
    return made / "build"


@pytest.fixture(scope="session")
def package(build, version):
    return build / "package" / f"joulepath-{version}"


@pytest.fixture(scope="session")
def installed(made):
    """The prefix of an installation."""
    return made / "usr"
