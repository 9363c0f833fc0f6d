"""The programs' command lines: one vocabulary of options, one line for what is wrong, strict numbers."""
import json
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


@pytest.mark.parametrize(("program", "arguments"), [
    ("jp-ecu", ["--bus=in-process"]), ("jp-plant", ["scenario.cfg", "--bus=in-process"])])
def test_what_tells_as_it_runs_counts_into_a_file(program, arguments):
    assert_one_line_error(run(program, *arguments, "--json=-"), program, "--json needs a file")


@pytest.mark.parametrize(("program", "arguments", "part"), [
    ("jp-mission", ["a", "b"], "one scenario"), ("jp-front", ["a", "b"], "one scenario"), ("jp-plant", ["a", "b"], "one scenario"),
    ("jp-plan", ["a", "b"], "one map"), ("jp-trip", ["a", "b"], "one robot"), ("jp-robot", ["a", "b"], "one robot"),
    ("jp-mission", [], "a scenario"), ("jp-front", [], "a scenario"), ("jp-plan", [], "a map"), ("jp-grounds", [], "a map"), ("jp-grounds", ["a", "b"], "one map"), ("jp-navigate", [], "a map"), ("jp-navigate", ["a", "b"], "one map"), ("jp-trip", [], "a robot"), ("jp-lattice", [], "a robot"),
    ("jp-identify", [], "a robot"), ("jp-balance", [], "a robot"), ("jp-robot", [], "a robot"), ("jp-skid", [], "a robot"), ("jp-skid", ["a", "b"], "one robot"), ("jp-skid-identify", [], "a robot"), ("jp-skid-identify", ["a", "b"], "one robot"), ("jp-four-wheel-identify", [], "a robot"), ("jp-four-wheel-identify", ["a", "b"], "one robot"),
    ("jp-patrol-config", [], "a robot"),
    ("jp-patrol", [], "a scene"), ("jp-plant", [], "--bus"), ("jp-ecu", [], "--bus"),
    ("jp-lcm", [], "--bus"), ("jp-robot", ["x" * 2000], "path"), ("jp-robot", [""], "path")])
def test_too_few_and_too_many(program, arguments, part):
    assert_one_line_error(run(program, *arguments), program, part)


def test_a_robot_by_its_name_and_by_its_file():
    assert run("jp-robot", "courier24", cwd=ROOT).stdout == run("jp-robot", COURIER).stdout != ""
    assert_one_line_error(run("jp-robot", "nobody", cwd=ROOT), "sim/robots/nobody.cfg", "No such file")


@pytest.mark.parametrize(("name", "type_name", "key", "value"), [
    ("courier24", "balancer", "wheel.mass_kg", 0.25), ("zhang2018", "skid_steer", "wheel.axles", 2),
    ("burger", "differential_drive", "caster.ahead_m", -0.081), ("patrol", "four_wheel", "body.track_m", 0.44)])
def test_robots_of_every_type(name, type_name, key, value):
    table = run("jp-robot", ROOT / f"sim/robots/{name}.cfg").stdout.splitlines()
    assert [line.split() for line in table[:2]] == [["name", name], ["type", type_name]]
    assert [line.split()[1] for line in table if line.startswith(f"{key} ")] == [f"{value:g}"]
    printed = json.loads(run("jp-robot", ROOT / f"sim/robots/{name}.cfg", "--json=-").stdout)
    assert (printed["name"], printed["type"]) == (name, type_name)
    group, member = key.split(".")
    assert printed[group][member] == value


def test_a_robot_of_no_type(tmp_path):
    path = tmp_path / "boat.cfg"
    path.write_text('type = "boat"; name = "boat";')
    assert_one_line_error(run("jp-robot", path), path, "boat robot", "four_wheel")


def test_json_beside_the_table(tmp_path):
    table = run("jp-robot", COURIER, "--json", tmp_path / "robot.json").stdout
    assert table == run("jp-robot", COURIER).stdout
    assert (tmp_path / "robot.json").read_text() == run("jp-robot", COURIER, "--json=-").stdout
