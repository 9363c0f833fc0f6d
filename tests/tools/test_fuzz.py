"""tools/measure/fuzz.py: what it makes of libFuzzer's runs; and that the target of messages knows all of them."""
import json
import re
from pathlib import Path

import pytest
from conftest import assert_one_line_error, run_tool

ROOT = Path(__file__).resolve().parents[2]
CLEAN = """#2\tINITED cov: 5 ft: 7 corp: 1/1b
#100\tNEW    cov: 9 ft: 12 corp: 2/2b
stat::number_of_executed_units: 100
stat::average_exec_per_sec:     50
"""
BROKEN = "src/x.c:3:1: runtime error: signed integer overflow\nstat::number_of_executed_units: 3\n"


@pytest.fixture
def target(tmp_path):
    """A program that says this, leaves an input where it is told to, and ends so."""
    def make(name, text, status=0, finds=False):
        program = tmp_path / f"fuzz_{name}"
        found = 'for a; do case $a in -artifact_prefix=*) touch "${a#*=}crash-1";; esac; done' if finds else ":"
        program.write_text(f"#!/bin/sh\necho \"$@\" >&2\n{found}\ncat <<'END'\n{text}END\nexit {status}\n")
        program.chmod(0o755)
        return program
    return make


def fuzz(tmp_path, *arguments):
    return run_tool("measure.fuzz", "--folder", tmp_path / "fuzz", *arguments)


def test_a_campaign_is_a_table_and_a_file(tmp_path, target):
    result = fuzz(tmp_path, "--seconds", "1", "--json", tmp_path / "fuzz.json", target("a", CLEAN), target("b", CLEAN))
    assert result.returncode == 0, result.stdout + result.stderr
    lines = result.stdout.splitlines()
    assert lines[:2] == ["fuzz_a: 1 of 2, 1 s", "fuzz_b: 2 of 2, 1 s"]
    assert [line.split() for line in lines[2:]] == [
        ["target", "executions", "executions/s", "features", "findings"], ["a", "100", "50", "12", "0"],
        ["b", "100", "50", "12", "0"]]
    rows = json.loads((tmp_path / "fuzz.json").read_text())
    assert [(row["target"], row["executions"], row["features"], row["findings"]) for row in rows] == [
        ("a", 100, 12, []), ("b", 100, 12, [])]


def test_a_finding_is_named_with_its_input(tmp_path, target):
    result = fuzz(tmp_path, "--seconds", "1", target("a", BROKEN, status=1, finds=True))
    assert result.returncode == 1
    assert f"{tmp_path}/fuzz/a/found-crash-1: src/x.c:3:1: runtime error: signed integer overflow" in result.stdout
    again = fuzz(tmp_path, "--seconds", "1", target("a", CLEAN))
    assert again.returncode == 0, "an old finding is not a new one"


@pytest.mark.parametrize("text, status, finds, line", [
    (CLEAN, 0, False, "tests/fuzz/fuzz_a.c:1:no_input_breaks_it:PASS"),
    (BROKEN, 77, True, "tests/fuzz/fuzz_a.c:1:no_input_breaks_it:FAIL: {}/fuzz/a/found-crash-1: src/x.c:3:1: runtime"),
    (BROKEN, 77, False, "tests/fuzz/fuzz_a.c:1:no_input_breaks_it:FAIL: {}/fuzz/a/log: src/x.c:3:1: runtime")])
def test_a_short_run_is_a_test(tmp_path, target, text, status, finds, line):
    result = fuzz(tmp_path, "--runs", "10", "--seed", "1", target("a", text, status, finds))
    assert result.returncode == (1 if status else 0)
    assert result.stdout.startswith(line.format(tmp_path))
    assert f"\n1 Tests {int(status != 0)} Failures 0 Ignored\n" in result.stdout
    said = (tmp_path / "fuzz/a/log").read_text().splitlines()[0].split()
    assert "-runs=10" in said and "-seed=1" in said and str(tmp_path / "fuzz/a/seeds") in said


def test_files_of_the_repository_are_seeds(tmp_path, target):
    fuzz(tmp_path, "--runs", "10", target("robot_file", CLEAN))
    seeds = {path.name for path in (tmp_path / "fuzz/robot_file/seeds").iterdir()}
    assert seeds == {path.name for path in (ROOT / "sim/robots").glob("*.cfg")}
    fuzz(tmp_path, "--runs", "10", target("map_file", CLEAN))
    assert str(ROOT / "tests/fuzz/seeds/map_file") in (tmp_path / "fuzz/map_file/log").read_text()


def test_what_ran_nothing_is_an_error(tmp_path, target):
    assert_one_line_error(fuzz(tmp_path, "--seconds", "1", target("a", "")), "ran nothing")
    assert_one_line_error(fuzz(tmp_path, "--seconds", "1", tmp_path / "fuzz_none"), "no such program")


def test_the_target_of_messages_knows_all():
    header = (ROOT / "hal/can/jp_can.h").read_text()
    source = (ROOT / "tests/fuzz/fuzz_can_messages.c").read_text()
    known = set(re.findall(r"int jp_can_(\w+)_unpack\(", header))
    assert known and set(re.findall(r"X\((\w+)\)", source)) - {"X"} == known
