"""The programs' command lines: one vocabulary of options, one line for what is wrong, strict numbers."""
import re

import pytest
from conftest import ROOT, assert_one_line_error, run

PROGRAMS = sorted(path.stem for path in (ROOT / "sim/programs").glob("jp-*.c"))
LETTERS = {"b": "bus", "e": "energy", "j": "json", "m": "model", "n": "count", "o": "output", "p": "parameters",
           "r": "robot", "s": "seed", "V": "version", "?": "help"}
COURIER = ROOT / "sim/robots/courier24.cfg"
VERSION = ".".join(re.findall(r"#define JP_VERSION_\w+ (\d+)", (ROOT / "include/joulepath/version.h").read_text()))
WHOLE = [("jp-identify", "--seed"), ("jp-identify", "--count"), ("jp-plant", "--patience"),
         ("jp-trip", "--seed"), ("jp-trip", "--count"), ("jp-patrol", "--seed"), ("jp-plan", "--memory"), ("jp-navigate", "--hidden")]
NO_WHOLE_NUMBER = ["1.5", "", "x", "-1", "+1", " 1", "1 ", "1e3", "0x10", "99999999999999999999"]


@pytest.mark.parametrize("program", PROGRAMS)
def test_letters_mean_the_same_everywhere(program):
    text = run(program, "--help").stdout
    letters = dict(re.findall(r"^  -(\S), --([a-z-]+)", text, re.MULTILINE))
    assert {"V": "version", "?": "help"}.items() <= letters.items() <= LETTERS.items()
    own = re.findall(r"^      --([a-z-]+)", text, re.MULTILINE)
    assert not set(own) & set(LETTERS.values())


@pytest.mark.parametrize("program", PROGRAMS)
def test_version(program):
    result = run(program, "--version")
    assert (result.returncode, result.stdout, result.stderr) == (0, f"{program} {VERSION}\n", "")


@pytest.mark.parametrize("text", NO_WHOLE_NUMBER)
@pytest.mark.parametrize(("program", "option"), WHOLE)
def test_no_whole_number(program, option, text):
    assert_one_line_error(run(program, f"{option}={text}"), program, option, "whole number")


@pytest.mark.parametrize(("program", "arguments", "part"), [
    ("jp-mission", ["a", "b"], "one scenario"), ("jp-front", ["a", "b"], "one scenario"), ("jp-plant", ["a", "b"], "one scenario"),
    ("jp-plan", ["a", "b"], "one map"), ("jp-trip", ["a", "b"], "one robot"), ("jp-robot", ["a", "b"], "one robot"),
    ("jp-mission", [], "a scenario"), ("jp-front", [], "a scenario"), ("jp-plan", [], "a map"), ("jp-navigate", [], "a map"), ("jp-navigate", ["a", "b"], "one map"), ("jp-trip", [], "a robot"), ("jp-lattice", [], "a robot"),
    ("jp-identify", [], "a robot"), ("jp-balance", [], "a robot"), ("jp-robot", [], "a robot"), ("jp-skid", [], "a robot"), ("jp-skid", ["a", "b"], "one robot"), ("jp-skid-identify", [], "a robot"), ("jp-skid-identify", ["a", "b"], "one robot"), ("jp-patrol-config", [], "a robot"),
    ("jp-patrol", [], "a scene"), ("jp-plant", [], "--bus"), ("jp-ecu", [], "--bus"),
    ("jp-lcm", [], "--bus"), ("jp-robot", ["x" * 2000], "path"), ("jp-robot", [""], "path")])
def test_too_few_and_too_many(program, arguments, part):
    assert_one_line_error(run(program, *arguments), program, part)


def test_a_robot_by_its_name_and_by_its_file():
    assert run("jp-robot", "courier24", cwd=ROOT).stdout == run("jp-robot", COURIER).stdout != ""
    assert_one_line_error(run("jp-robot", "nobody", cwd=ROOT), "sim/robots/nobody.cfg", "No such file")


def test_json_beside_the_table(tmp_path):
    table = run("jp-robot", COURIER, "--json", tmp_path / "robot.json").stdout
    assert table == run("jp-robot", COURIER).stdout
    assert (tmp_path / "robot.json").read_text() == run("jp-robot", COURIER, "--json=-").stdout
