"""tools/measure/mcdc.py: what it makes of clang's export, and that clang's own measurement of a small program is read."""
import json
import shutil
import subprocess

import pytest
from conftest import assert_one_line_error, run_tool

from tools.measure import mcdc, proof_rooms

SOURCE = """int f(int a, int b)
{
    if (a > 1 && b > 1) {
        return 1;
    }
    return a ? 2 : 3;
}
"""
DECISION, LEFT, RIGHT, QUESTION = [3, 9, 3, 23], [3, 9, 3, 14], [3, 18, 3, 23], [6, 12, 6, 13]


def export(root, shown, branches):
    return {"data": [{"files": [{
        "filename": str(root / "src/a.c"), "mcdc_records": [[*DECISION, 0, 5, shown]],
        "branches": [[*region, *counts, 0, 0, 6] for region, counts in zip((LEFT, RIGHT, QUESTION), branches)]}]}]}


@pytest.fixture(name="report")
def fixture_report(tmp_path, monkeypatch):
    (tmp_path / "src").mkdir()
    (tmp_path / "src/a.c").write_text(SOURCE, encoding="utf-8")
    for module in (mcdc, proof_rooms):
        monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setattr(proof_rooms.critical_rooms, "__defaults__", (tmp_path / "rooms.yaml",))
    monkeypatch.setattr(proof_rooms.sources_of, "__defaults__", (tmp_path,))
    (tmp_path / "rooms.yaml").write_text("room: [src/*]\n", encoding="utf-8")

    def report(measured, reviewed="[]\n"):
        monkeypatch.setattr(mcdc, "measure", lambda *arguments: measured)
        (tmp_path / "reviewed.yaml").write_text(reviewed, encoding="utf-8")
        return run_tool("measure.mcdc", "--objects", tmp_path, "--reviewed", tmp_path / "reviewed.yaml", "--json",
                        tmp_path / "mcdc.json", tmp_path / "test")
    report.root = tmp_path
    return report


def test_all_is_shown(report):
    result = report(export(report.root, [True, True], [(1, 1), (1, 1), (1, 1)]))
    assert result.returncode == 0 and result.stderr == ""
    assert [line.split() for line in result.stdout.splitlines()[1:]] == [
        [name, "1", "2", "2", "0", "100.00", "6", "100.00"] for name in ("src/a.c", "room:", "all:")]
    assert json.loads((report.root / "mcdc.json").read_text(encoding="utf-8")) == {"room": [
        {"file": "src/a.c", "decisions": 1, "conditions": 2, "shown": 2, "explained": 0, "outcomes": 6, "taken": 6}]}


def test_what_is_not_shown_is_named(report):
    result = report(export(report.root, [True, False], [(1, 1), (1, 1), (1, 0)]))
    assert result.returncode == 1
    assert result.stderr.splitlines() == [
        "src/a.c:3: error: not shown to matter alone: b > 1 in a > 1 && b > 1", "src/a.c:6: error: never false: a"]


def test_what_is_explained_is_counted(report):
    reviewed = ("- file: src/a.c\n  decision: a > 1 && b > 1\n  condition: b > 1\n  reason: b is a when a > 1\n"
                "- file: src/a.c\n  decision: a\n  condition: never false\n  reason: nobody asks\n")
    assert report(export(report.root, [True, False], [(1, 1), (1, 1), (1, 0)]), reviewed).returncode == 0
    result = report(export(report.root, [True, True], [(1, 1), (1, 1), (1, 0)]), reviewed)
    assert result.returncode == 1
    assert result.stderr.endswith("reviewed.yaml:1: error: nothing needs this entry any more: remove it\n")


def test_instances_of_a_function_count_together(report):
    measured = export(report.root, [True, False], [(1, 0), (1, 1), (1, 1)])
    measured["data"][0]["files"] += export(report.root, [False, True], [(0, 1), (1, 1), (1, 1)])["data"][0]["files"]
    assert report(measured).returncode == 0


def test_a_decision_that_clang_leaves_out_is_an_error(report):
    measured = export(report.root, [True, True], [(1, 1), (1, 1), (1, 1)])
    measured["data"][0]["files"][0]["mcdc_records"] = []
    result = report(measured)
    assert result.returncode == 1
    assert result.stderr == "src/a.c:3: error: clang 19 cannot measure this decision: write it as two, or as a function\n"


def test_a_test_that_fails_tells_nothing(tmp_path):
    test = tmp_path / "test_a"
    test.write_text("#!/bin/sh\nexit 1\n", encoding="utf-8")
    test.chmod(0o755)
    assert_one_line_error(run_tool("measure.mcdc", "--objects", tmp_path, test), "test_a: failed")


# That compiler comes with `make mcdc`, not with the set-up of the tests.
if shutil.which("clang-19"):
    @pytest.mark.parametrize("calls, missing", [
        ("f(2, 2); f(2, 1); f(1, 2); f(0, 0);", []),
        ("f(2, 2); f(2, 1);", ["a > 1"]),
        ("f(2, 2); f(1, 2); f(0, 0);", ["b > 1"])])
    def test_clang_measures_it(tmp_path, monkeypatch, calls, missing):
        (tmp_path / "a.c").write_text(SOURCE, encoding="utf-8")
        (tmp_path / "main.c").write_text(f"int f(int, int);\nint main(void)\n{{\n    {calls}\n    return 0;\n}}\n",
                                         encoding="utf-8")
        flags = ["-O0", "-fprofile-instr-generate", "-fcoverage-mapping", "-fcoverage-mcdc"]
        subprocess.run(["clang-19", *flags, "-c", "a.c"], cwd=tmp_path, check=True)
        subprocess.run(["clang-19", *flags, "main.c", "a.o", "-o", "test_a"], cwd=tmp_path, check=True)
        monkeypatch.setattr(mcdc, "ROOT", tmp_path)
        result, = mcdc.results_of(mcdc.measure([tmp_path / "test_a"], [tmp_path / "a.o"], 1), ["a.c"])
        decision, = result.decisions
        assert decision.conditions == ["a > 1", "b > 1"]
        assert [text for text, shown in zip(decision.conditions, decision.shown) if not shown] == missing
