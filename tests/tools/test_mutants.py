"""tools/measure/mutants.py on a small library of its own: what is killed, what survives, and what stays known."""
import json
import subprocess

import pytest
from conftest import ROOT, assert_one_line_error, run_tool

from tools.measure import mutants, proof_rooms

SOURCE = """#include "src/room/a.h"

#define STEP 2

static const int shares[2] = {3, 4};

int a_sum(int a, int b)
{
    if (a > 100) {
        a = 50;
    }
    return a + b * STEP;
}

int a_share(unsigned i)
{
    return shares[i & 1U];
}

int a_size(int a)
{
    return a < 0 ? -a : a;
}
"""
HEADER = """int a_sum(int a, int b);
int a_share(unsigned i);
int a_size(int a);
static inline int a_twice(int a)
{
    return a + a;
}
"""
USER = '#include "src/room/a.h"\nint user(int a);\nint user(int a)\n{\n    return a_twice(a);\n}\n'
TESTS = {
    "test_sum": "int a_sum(int, int);\nint main(void)\n{\n    return a_sum(1, 2) != 5 || a_sum(101, 1) != 52;\n}\n",
    "test_rest": '#include "src/room/a.h"\nint user(int a);\nint main(void)\n{\n'
                 "    return a_share(0) != 3 || a_share(1) != 4 || a_size(-2) != 2 || a_size(2) != 2 || user(3) != 6;\n}\n"}
FLAGS = "-std=c11 -I."
# Nobody tries 100 itself.
LIMIT = {"a [> => >=] 100", "a > [100 => 99]"}


def build(root, tests):
    """The same as tools/make/mutants.mk."""
    def gcc(*arguments):
        subprocess.run(["gcc", "-std=c11", "-I.", "-MMD", *arguments], cwd=root, check=True)
    for variant, flags in (("mutants", ["-fPIC"]), ("counting", ["--coverage"])):
        folder = root / "build" / variant
        objects = []
        for name in ("src/room/a", "src/room/user"):
            target = folder / f"{name}.o"
            target.parent.mkdir(parents=True, exist_ok=True)
            gcc("-O0", *flags, "-c", f"{name}.c", "-o", target)
            objects.append(target)
        for name, text in tests.items():
            runner = root / "build/runners/tests" / f"{name}.c"
            runner.parent.mkdir(parents=True, exist_ok=True)
            runner.write_text(text, encoding="utf-8")
            target = folder / "tests" / f"{name}.o"
            target.parent.mkdir(exist_ok=True)
            gcc("-O0", *flags, "-c", runner, "-o", target)
            if variant == "counting":
                gcc(*flags, target, *objects, "-o", folder / name)
        if variant == "mutants":
            gcc("-shared", *objects, "-o", folder / "libcore.so")
            subprocess.run(["ar", "qc", folder / "libdrivers.a"], check=True)
            for name in tests:
                gcc(folder / "tests" / f"{name}.o", folder / "libcore.so", f"-Wl,-rpath,{folder}", "-o", folder / name)


@pytest.fixture(name="project")
def fixture_project(tmp_path, monkeypatch):
    (tmp_path / "src/room").mkdir(parents=True)
    for name, text in (("a.c", SOURCE), ("a.h", HEADER), ("user.c", USER)):
        (tmp_path / "src/room" / name).write_text(text, encoding="utf-8")
    (tmp_path / "rooms.yaml").write_text("room: [src/room/a.*]\n", encoding="utf-8")
    (tmp_path / "reviewed.yaml").write_text("[]\n", encoding="utf-8")
    for module in (mutants, proof_rooms):
        monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setattr(proof_rooms, "ROOMS", tmp_path / "rooms.yaml")
    monkeypatch.setattr(proof_rooms.chosen_rooms, "__defaults__", None)
    monkeypatch.setattr(proof_rooms.critical_rooms, "__defaults__", (tmp_path / "rooms.yaml",))
    monkeypatch.setattr(proof_rooms.sources_of, "__defaults__", (tmp_path,))
    monkeypatch.chdir(tmp_path)
    build(tmp_path, TESTS)
    return tmp_path


def run_mutants(project, *arguments, names=("test_sum", "test_rest")):
    headers = subprocess.run(["gcc", "-print-file-name=include"], capture_output=True, text=True, check=True).stdout.strip()
    return run_tool("measure.mutants", "--build", project / "build/mutants", "--counting", project / "build/counting",
                    "--folder", project / "known", f"--flags={FLAGS}", "--headers", headers, "--reviewed",
                    project / "reviewed.yaml", "--json", project / "mutants.json", *arguments, *names)


def survivors(result):
    return [line.split(": error: ")[1] for line in result.stderr.splitlines() if "noticed by none" in line]


def test_what_no_test_looks_at_survives(project):
    result = run_mutants(project)
    assert result.returncode == 1
    found = survivors(result)
    assert {line.split(": ", maxsplit=1)[1] for line in found} == LIMIT, found
    counts = json.loads((project / "mutants.json").read_text(encoding="utf-8"))["files"]
    assert counts["src/room/a.c"]["equivalent"] == 2, "the size of 0 is 0 either way: the same machine code"
    assert counts["src/room/a.h"] == {"mutants": 2, "killed": 2, "by_hash": 0, "equivalent": 0, "survived": 0, "percent": 100}
    assert counts["src/room/a.c"]["survived"] == len(found) and counts["src/room/a.c"]["killed"] > 20
    rows = [line.split() for line in result.stdout.splitlines()]
    assert rows[0] == ["file", "mutants", "killed", "by", "bits", "equivalent", "survived", "%"]
    assert [row[0] for row in rows[1:]] == ["src/room/a.c", "src/room/a.h", "room:", "all:"]


def test_a_header_of_constants_is_judged_by_those_that_execute_what_includes_it(project):
    (project / "src/room/limits.h").write_text("#define LIMIT 100\n", encoding="utf-8")
    source = '#include "src/room/limits.h"\n' + SOURCE.replace("> 100", "> LIMIT")
    (project / "src/room/a.c").write_text(source, encoding="utf-8")
    build(project, TESTS)
    result = run_mutants(project, "--room", "src/room/limits.h")
    assert survivors(result) == ["constant in LIMIT, noticed by none of 2 tests: [100 => 99]"]
    counts = json.loads((project / "mutants.json").read_text(encoding="utf-8"))["files"]
    assert counts["src/room/limits.h"]["killed"] == 2


def test_the_record_keeps_the_rows_of_other_rooms(project):
    page = project / "MUTANTS.md"
    run_mutants(project, "--record", page)
    assert "| `room` | all | all | " in page.read_text(encoding="utf-8")
    result = run_mutants(project, "--record", page, "--room", "src/room", "--sample", "3", "--judges", "sum")
    assert result.stdout.startswith("3 mutants of each room")
    rows = [line.strip("| ").split(" | ") for line in page.read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    assert [(row[0], row[1], row[2], row[-1]) for row in rows] == [
        ("`room`", "all", "all", "100"), ("`src/room`", "3, seed 1", "sum", "95")]


def test_what_is_listed_is_equivalent_and_what_is_not_needed_an_error(project):
    entry = "- file: src/room/a.c\n  function: a_sum\n  code: a > 100\n  becomes: {}\n  reason: nobody has 100\n"
    (project / "reviewed.yaml").write_text(entry.format("a >= 100") + entry.format("a > 7"), encoding="utf-8")
    result = run_mutants(project)
    assert len(survivors(result)) == 1
    assert "reviewed.yaml:6: error: nothing needs this entry any more" in result.stderr
    (project / "reviewed.yaml").write_text("- file: src/room/a.c\n  reason: none\n", encoding="utf-8")
    assert_one_line_error(run_mutants(project), "reviewed.yaml:1")


def test_what_is_known_is_not_judged_again_unless_its_judges_changed(project, monkeypatch):
    run_mutants(project)
    judged = []
    compiler = mutants.Judge.compiler
    monkeypatch.setattr(mutants.Judge, "compiler", lambda self, *arguments: judged.append(arguments) or
                        compiler(self, *arguments))
    assert len(survivors(run_mutants(project))) == 2 and not judged
    build(project, TESTS | {"test_sum": TESTS["test_sum"].replace("101, 1) != 52", "101, 1) != 52 || a_sum(100, 0) != 100")})
    assert survivors(run_mutants(project)) == []
    assert judged


def test_what_only_bits_notice_is_counted_apart(project):
    result = run_mutants(project, "--hash", "test_rest", names=["test_sum"])
    counts = json.loads((project / "mutants.json").read_text(encoding="utf-8"))["files"]["src/room/a.c"]
    assert 0 < counts["by_hash"] < counts["killed"] and len(survivors(result)) == 2


def test_a_sample_says_its_seed(project):
    result = run_mutants(project, "--sample", "5", "--seed", "7")
    assert result.stdout.splitlines()[0] == "5 mutants of each room, drawn with seed 7"
    assert result.stdout.splitlines()[-1].split()[1] == "5"
    assert run_mutants(project, "--sample", "5", "--seed", "7").stdout == result.stdout


def test_a_test_that_fails_anyhow_is_an_error(project):
    build(project, {"test_sum": TESTS["test_sum"].replace("!= 5", "!= 6")})
    assert_one_line_error(run_mutants(project, names=["test_sum"]), "fails without a mutant")


def test_a_file_that_fails_unchanged_when_it_is_loaded_is_an_error(project):
    path = project / "src/room/a.c"
    path.write_text(SOURCE.replace("STEP 2", "STEP 3"), encoding="utf-8")
    assert_one_line_error(run_mutants(project), "fails with src/room/a.c as it is loaded")


def test_a_room_that_is_none_is_an_error(project):
    assert_one_line_error(run_mutants(project, "--room", "attic"), "attic: no room")


def test_the_rooms_that_can_hurt_someone_have_sources():
    rooms = proof_rooms.critical_rooms(ROOT / "tests/proof/rooms.yaml")
    assert {"balancer", "skid_steer", "monitor", "e2e", "operator", "navigator"} == set(rooms)
