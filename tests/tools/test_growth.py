"""tools/measure/growth.py and the comparison with the last commit: what may grow, what must be explained."""
import json

import pytest
from conftest import assert_one_line_error, run_tool

from tools.common import ToolError
from tools.measure import core_numbers, growth

VERSIONS = {"arm-none-eabi-gcc": "12.2.1", "riscv64-unknown-elf-gcc": "12.2.0"}
NAME = "size: energy: Cortex-M4"


def tables(size=1000, stack=200, cycles=900):
    return {"size": {"energy": {"Cortex-M4": size}}, "stack": {"jp_hal_tick": {"Cortex-M0": 300, "Cortex-M4": stack}},
            "cycles": {"tick": {"Cortex-M4": cycles}}}


@pytest.fixture
def compare(monkeypatch, tmp_path):
    """Runs the tool on measured tables against accepted ones."""
    monkeypatch.setenv("JP_BUILD", str(tmp_path / "build"))
    monkeypatch.setattr(growth, "compiler_versions", lambda: dict(VERSIONS))

    def run(measured, *options, accepted=None, explained=(), compilers=None):
        path = tmp_path / "numbers.json"
        if accepted is not False:
            path.write_text(json.dumps({"compilers": compilers or VERSIONS, **(accepted or tables()),
                                        "explained": list(explained)}))
        for kind, table in measured.items():
            core_numbers.write_measured(kind, table)
        return run_tool("measure.growth", "--accepted", path, *options)
    run.accepted = lambda: json.loads((tmp_path / "numbers.json").read_text())
    return run


@pytest.mark.parametrize("size", [0, 900, 1000, 1050])
def test_what_shrinks_or_grows_by_5_percent_passes(compare, size):
    result = compare(tables(size=size))
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")


def test_what_grows_more_fails_and_is_named(compare):
    result = compare(tables(size=1051))
    assert result.returncode == 1
    assert f"error: {NAME}: 1000 grew to 1051 B" in result.stdout
    assert json.dumps({"name": NAME, "value": 1051, "reason": "..."}) in result.stdout


@pytest.mark.parametrize("kind, slack", [("size", 16), ("stack", 8), ("cycles", 20)])
def test_tiny_numbers_may_grow_by_a_little(compare, kind, slack):
    tiny = tables(**{kind: 10})
    assert compare(tables(**{kind: 10 + slack}), accepted=tiny).returncode == 0
    assert compare(tables(**{kind: 11 + slack}), accepted=tiny).returncode == 1


def test_only_the_named_kind_is_judged(compare):
    assert compare(tables(size=5000), "stack", "cycles").returncode == 0
    assert compare(tables(size=5000), "size").returncode == 1


def line(value, reason="a new check", name=NAME):
    return {"name": name, "value": value, "reason": reason}


@pytest.mark.parametrize("explained, status", [
    ([line(1200)], 0), ([line(1199)], 1), ([line(1200, name="size: energy: Cortex-M0")], 1), ([], 1)])
def test_an_explanation_covers_its_number_up_to_its_value(compare, explained, status):
    assert compare(tables(size=1200), explained=explained).returncode == status


@pytest.mark.parametrize("explained, part", [
    (line(1200, reason=" "), "reason"), ({"name": NAME, "value": 1200}, "reason"), ({"name": NAME, "reason": "x"}, "value"),
    ("because", "name")])
def test_a_garbled_explanation_is_refused(compare, explained, part):
    assert_one_line_error(compare(tables(), explained=[explained]), "numbers.json", "explained 0", part)


def test_another_compiler_may_differ_more_but_not_at_will(compare):
    other = {**VERSIONS, "arm-none-eabi-gcc": "13.2.1"}
    assert compare(tables(size=1200), compilers=other).returncode == 0
    assert compare(tables(size=1251), compilers=other).returncode == 1


def test_new_and_lost_numbers_fail(compare):
    more = tables()
    more["size"]["novelty"] = {"Cortex-M4": 1}
    result = compare(more)
    assert result.returncode == 1 and "size: novelty: Cortex-M4: 1 is new" in result.stdout
    result = compare(tables(), accepted=more)
    assert result.returncode == 1 and "size: novelty: Cortex-M4: is measured no more" in result.stdout


def test_accepting_writes_numbers(compare):
    more = tables(size=1040)
    more["size"]["novelty"] = {"Cortex-M0": 7}
    result = compare(more, "--accept", explained=[line(1500, name="gone")])
    assert result.returncode == 0, result.stdout + result.stderr
    assert compare.accepted() == {"compilers": VERSIONS, **more, "explained": []}
    assert core_numbers.markdown(more["size"]) == (
        "| | Cortex-M0 | Cortex-M4 |\n|---|--:|--:|\n| energy | – | 1040 |\n| novelty | 7 | – |")


def test_an_unexplained_growth_is_not_accepted(compare):
    before = tables()
    assert compare(tables(size=1100), "--accept").returncode == 1
    assert compare.accepted()["size"] == before["size"]


def test_an_explained_growth_is_accepted_and_stays_explained(compare):
    assert compare(tables(size=1200), "--accept", explained=[line(1200)]).returncode == 0
    assert compare.accepted()["size"] == tables(size=1200)["size"]
    assert compare.accepted()["explained"] == [line(1200)]


def test_bad_input_is_named(compare, tmp_path):
    assert_one_line_error(compare(tables(), "weight"), "weight", "size, stack, cycles")
    assert_one_line_error(compare(tables(), "--accept", "size"), "--accept")
    assert_one_line_error(compare({**tables(), "size": {}}), "size.json", "no number")
    assert_one_line_error(compare({**tables(), "stack": {"x": {"Cortex-M4": 1.5}}}), "stack.json", "whole number")
    assert_one_line_error(compare(tables(), accepted={**tables(), "cycles": []}), "numbers.json", "cycles")
    (tmp_path / "numbers.json").write_text("{")
    assert_one_line_error(compare(tables(), accepted=False), "numbers.json", "no JSON")
    (tmp_path / "numbers.json").unlink()
    assert_one_line_error(compare(tables(), accepted=False), "numbers.json")


def test_a_difference_shows_old_new_and_change(capsys):
    old = {"tick": {"Cortex-M0": 100, "Cortex-M4": 50}, "gone": {"Cortex-M4": 1}}
    core_numbers.print_difference("cycles", old, {"tick": {"Cortex-M0": 110, "Cortex-M4": 50}, "new": {"RV32": 3}})
    rows = [row.split() for row in capsys.readouterr().out.splitlines()]
    assert rows[1:] == [["tick", "Cortex-M0", "100", "110", "+10.0"], ["gone", "Cortex-M4", "1", "-", "-"],
                        ["new", "RV32", "-", "3", "-"]]
    core_numbers.print_difference("cycles", old, old)
    assert "nothing changed" in capsys.readouterr().out


def test_cores_are_told_from_variants():
    assert [core_numbers.core_of(name) for name in ("cortex-m0-o2", "cortex-m4", "rv32-os", "firmware")] == [
        "Cortex-M0", "Cortex-M4", "RV32", "STM32F405"]
    with pytest.raises(ToolError, match="host-gcc"):
        core_numbers.core_of("host-gcc")
