"""tools/measure/target_tests.py: the sum of the logs of the emulated cores."""
import json

import pytest
from conftest import assert_one_line_error, run_tool

PASSED = "tests/unit/test_x.c:3:test_a:PASS\n\n1 Tests 0 Failures 0 Ignored\nOK\n\nrun: exit 0, 1.500 s\n"
FAILED = "tests/unit/test_x.c:3:test_a:FAIL: Expected 1\n\n1 Tests 1 Failures 0 Ignored\nFAIL\n\nrun: exit 1, 0.500 s\n"


@pytest.fixture
def summarise(tmp_path):
    def run(logs, seconds="12"):
        paths = []
        for name, text in logs.items():
            paths.append(tmp_path / name)
            paths[-1].parent.mkdir(exist_ok=True)
            if text is not None:
                paths[-1].write_text(text)
        result = run_tool("measure.target_tests", "--bench", tmp_path / "targets.json", "--seconds", seconds, *paths)
        bench = tmp_path / "targets.json"
        return result, json.loads(bench.read_text()) if bench.exists() else None
    return run


def test_passed_failed_and_seconds_are_figures(summarise):
    result, figures = summarise({"cortex-m0/a.log": PASSED, "cortex-m0-o2/a.log": PASSED, "rv32/a.log": PASSED})
    assert result.returncode == 0, result.stdout + result.stderr
    assert [(f["name"], f["value"], f["bound"]) for f in figures] == [
        ("unit tests on 2 emulated cores: passed", 3, None),
        ("unit tests on 2 emulated cores: failed", 0, {"op": "==", "value": 0}),
        ("unit tests on 2 emulated cores: time of the whole run", 12.0, {"op": "<=", "value": 300})]
    assert result.stdout.splitlines()[1].split() == ["cortex-m0", "1", "0", "1.5"]
    assert "3 passed, 0 failed, 12 s" in result.stdout


@pytest.mark.parametrize("log, part", [
    (FAILED, "Expected 1"), (None, "did not run"), ("hard fault\n\nrun: exit 1, 0.1 s\n", "crashed"), ("", "broken off"),
    (PASSED.replace("exit 0", "exit 124"), "too long")])
def test_a_failure_is_named_and_counted(summarise, log, part):
    result, figures = summarise({"cortex-m4/a.log": PASSED, "cortex-m7/a.log": log})
    assert result.returncode == 1
    assert part in result.stdout
    assert figures[1]["value"] == 1


@pytest.mark.parametrize("seconds", ["-1", "nan"])
def test_a_time_must_be_one(summarise, seconds):
    result, figures = summarise({"rv32/a.log": PASSED}, seconds)
    assert_one_line_error(result, "--seconds")
    assert figures is None
