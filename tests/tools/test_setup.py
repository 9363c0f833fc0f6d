"""setup.sh and the lists of Python packages: what each scope installs, what is missing without, nothing needless."""
import ast
import os
import re
import shutil
import subprocess
import sys

import pytest
from conftest import ROOT, assert_one_line_error

LISTS = ("sil", "design", "operate", "campaign", "python", "mujoco", "test")
LINE = re.compile(r"([a-z0-9-]+)==([0-9.]+)(?:  # (?:(program) )?([\w-]+))?")

# What the targets of each list's scope run, and the lists that they have.
PROGRAMS = {
    "sil": (["report.report", "report.patrol_report", "measure.figure_pages"], ["sil"]),
    "design": (["design.gain_design", "design.horizon", "design.identify", "design.import_map", "design.lattice",
                "design.learning", "design.patrol_table", "design.tables_header", "report.navigate_report",
                "report.plan_report"],
               ["sil", "design"]),
    "operate": (["design.can_codec", "operate.can_report", "operate.drive", "operate.lcm_map",
                 "operate.lcm_navigate", "operate.lcm_report",
                 "operate.show_frames", "report.foxglove_log"], ["sil", "operate"]),
    "campaign": (["campaign.campaign"], ["sil", "campaign"]),
    "mujoco": (["mujoco.mission", "mujoco.film"], ["sil", "design", "operate", "mujoco"]),
}
# Needed by what is imported.
INDIRECT = {"serial": "can.interfaces.slcan"}


def packages(name):
    """{package: (version, module, or None of a program)} of a list."""
    lines = [line for line in (ROOT / f"tools/requirements-{name}.txt").read_text().splitlines() if line[:1] != "#"]
    found = [LINE.fullmatch(line) for line in lines]
    assert all(found), lines
    return {match[1]: (match[2], None if match[3] else match[4] or match[1]) for match in found}


def imports(module, seen):
    """Modules of others that a module of tools and all that it imports of tools import."""
    path = ROOT / f"{module.replace('.', '/')}.py"
    if module in seen or not path.exists():
        return set()
    seen.add(module)
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
    ours = {name for name in found if name.startswith("tools")}
    return (found - ours).union(*(imports(name, seen) for name in ours))


@pytest.mark.parametrize("scope", PROGRAMS)
def test_a_scope_has_what_its_programs_import_and_nothing_else(scope):
    programs, lists = PROGRAMS[scope]
    seen = set()
    names = set().union(*(imports(f"tools.{program}", seen) for program in programs))
    # lcm-gen makes jp, the types of LCM messages.
    used = {name.split(".")[0] for name in names} - set(sys.stdlib_module_names) - {"jp"}
    used |= {module for module, user in INDIRECT.items() if user in names}
    listed = {module for name in lists for _, module in packages(name).values()}
    assert used - listed == set()
    assert {module for _, module in packages(scope).values()} - used == set()


def test_a_package_has_one_version():
    versions = {}
    for name in LISTS:
        for package, (version, _) in packages(name).items():
            assert versions.setdefault(package, version) == version


class Machine:
    """A copy of the script where every apt package is there, and Pythons that only note what they are told."""

    def __init__(self, folder):
        self.folder, self.log, self.commands = folder, folder / "log", folder / "commands"
        self.commands.mkdir()
        (folder / "tools/operate/vcan").mkdir(parents=True)
        for name in ("setup.sh", "operate/vcan/common.sh", "operate/vcan/init.sh"):
            shutil.copy(ROOT / "tools" / name, folder / "tools" / name)
        for name in LISTS:
            shutil.copy(ROOT / f"tools/requirements-{name}.txt", folder / "tools")
        self.command("dpkg-query", "printf installed")
        self.command("unshare", "exit 0")
        self.command("clang", f"echo {folder}/clang")
        for library in ("any/libclang_rt.asan.a", "wasi/libclang_rt.builtins-wasm32.a"):
            (folder / "clang/lib" / library).parent.mkdir(parents=True)
            (folder / "clang/lib" / library).touch()
        self.command("chromium", "exit 0")
        self.command("python3", f'echo "$@" >>{self.log}; [ "$2" != venv ] || {{ mkdir -p .venv/bin; '
                                f'cp {self.commands}/pip .venv/bin/python; }}')
        self.command("pip", f'echo "${{@: -1}}" >>{self.log}')

    def command(self, name, text):
        path = self.commands / name
        path.write_text(f"#!/bin/bash\n{text}\n")
        path.chmod(0o755)
        return path

    def setup(self, *scopes, **environment):
        self.log.write_text("")
        environment = {**os.environ, "PATH": f"{self.commands}:{os.environ['PATH']}", "JP_SETUP": "yes", **environment}
        return subprocess.run([self.folder / "tools/setup.sh", *scopes], env=environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, check=False, timeout=60)

    def installed(self, *scopes):
        result = self.setup(*scopes)
        assert (result.returncode, result.stderr) == (0, "")
        return self.log.read_text().splitlines()


VENV = "-m venv --clear .venv"


@pytest.fixture
def machine(tmp_path):
    return Machine(tmp_path)


def list_path(name):
    return f"tools/requirements-{name}.txt"


@pytest.mark.parametrize("scopes, lists", [
    (["sil"], ["sil"]), (["firmware"], ["sil"]), (["design"], ["sil", "design"]), (["vcan"], ["sil", "operate"]),
    (["sil", "operate", "firmware"], ["sil", "operate"]), (["campaign"], ["sil", "campaign"]),
    (["python"], ["sil", "python"]), (["page"], ["sil"]),
    (["mujoco"], ["sil", "design", "operate", "mujoco"]), (["test"], LISTS),
    ([], LISTS)])
def test_a_scope_installs_its_lists(machine, scopes, lists):
    assert machine.installed(*scopes) == [VENV, *map(list_path, lists)]


def test_a_larger_scope_adds_to_what_is_there(machine):
    assert machine.installed("sil") == [VENV, list_path("sil")]
    (machine.folder / ".venv/by-hand").touch()
    assert machine.installed("design") == [list_path("design")]
    assert machine.installed("sil", "design") == []
    assert machine.installed("test") == [list_path(name) for name in ("operate", "campaign", "python", "mujoco", "test")]
    assert (machine.folder / ".venv/by-hand").exists()


def test_a_list_that_changed_is_installed_again(machine):
    machine.installed("design")
    with (machine.folder / list_path("design")).open("a") as file:
        file.write("new==1.0\n")
    assert machine.installed("design") == [list_path("design")]


def test_an_environment_without_python_is_made_again(machine):
    machine.installed("sil")
    (machine.folder / ".venv/bin/python").unlink()
    assert machine.installed("sil") == [VENV, list_path("sil")]


def test_a_wrong_scope_is_refused(machine):
    assert_one_line_error(machine.setup("everything"), "usage: tools/setup.sh", "campaign")


def missing(machine, python, scope="sil"):
    result = machine.setup(scope, JP_SETUP="skip", PYTHON=str(python))
    return set(re.findall(r"python module (\w+)", result.stderr))


def test_without_setup_the_python_that_is_named_is_asked(machine):
    everything, nothing = machine.command("everything", "exit 0"), machine.command("nothing", "exit 1")
    machine.installed("sil")
    assert missing(machine, everything) == set()
    assert missing(machine, nothing) == {"jinja2", "matplotlib", "numpy"}
    assert missing(machine, nothing, "campaign") == {"distributed", "jinja2", "matplotlib", "numpy", "psutil", "rich",
                                                     "scipy"}


def test_without_setup_a_python_that_is_not_there_is_named(machine):
    assert_one_line_error(machine.setup("sil", JP_SETUP="skip", PYTHON="/no/python"), "missing: ", "/no/python")
