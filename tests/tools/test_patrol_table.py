"""patrol_table.py and jp-patrol-config: the committed tables are fresh, numbers read back, what is refused."""
import json
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import JP_ROBOT, ROOT, assert_one_line_error, run_tool

from tools.design import patrol_table

PROGRAM = JP_ROBOT.with_name("jp-patrol-config")
ROBOT = ROOT / "sim" / "robots" / "patrol.cfg"
TABLES = tuple(f"src/tables/{part}_patrol.c" for part in patrol_table.PARTS)

COMPARE = """
#include <joulepath/patrol.h>
#include <stdio.h>
extern const struct jp_patrol_config jp_patrol_config_patrol;
int main(void)
{
    printf("[%.17g, %.17g, %d]\\n", (double)jp_patrol_config_patrol.turn_first, (double)jp_patrol_config_patrol.jump,
           (int)jp_patrol_config_patrol.waits_max);
    return 0;
}
"""


def make(*arguments):
    return run_tool("design.patrol_table", *arguments)


def config(*arguments):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False)


def printed():
    return json.loads(config(ROBOT, "--json=-").stdout)


def changed_robot(path, before, after):
    text = ROBOT.read_text(encoding="utf-8")
    assert text.count(before) == 1
    path.write_text(text.replace(before, after), encoding="utf-8")
    return path


def test_committed_tables_are_fresh(tmp_path):
    result = make("patrol", "--tables", tmp_path / "src/tables")
    assert result.returncode == 0, result.stderr
    made = sorted(path for path in tmp_path.rglob("*") if path.is_file())
    assert made == sorted(tmp_path / table for table in TABLES)
    for table in TABLES:
        assert (tmp_path / table).read_bytes() == (ROOT / table).read_bytes(), "run make patrol-config ROBOT=patrol"


@pytest.mark.parametrize("table", TABLES)
def test_tables_are_formatted_and_hold_every_member(table):
    text = (ROOT / table).read_text(encoding="utf-8")
    part = Path(table).stem.removesuffix("_patrol")
    names = re.findall(r"\.(\w+) = \S", text)
    assert names == [member["key"].rsplit(".", 1)[-1] for member in printed()[part]]
    for line in text.splitlines():
        assert len(line) <= 120


def test_a_change_of_the_robot_reaches_the_compiler(tmp_path):
    robot = changed_robot(tmp_path / "patrol.cfg", "from_deg = 30.0;", "from_deg = 33.3;")
    assert make(robot, "--tables", tmp_path).returncode == 0
    (tmp_path / "compare.c").write_text(COMPARE)
    subprocess.run(["gcc", "-std=c11", "-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror", "-I",
                    ROOT / "include", tmp_path / "compare.c", tmp_path / "patrol_patrol.c", "-o",
                    tmp_path / "compare"], check=True)
    shown = subprocess.run([tmp_path / "compare"], capture_output=True, check=True).stdout
    assert json.loads(shown) == [float(np.float32(np.radians(33.3))), float(np.float32(0.3)), 100]


def test_floats_read_back():
    chance = np.random.default_rng(1)
    bits = np.concatenate([chance.integers(0, 0x7F800000, 20000, dtype=np.uint32),
                           np.array([0, 1, 0x007FFFFF, 0x00800000, 0x7F7FFFFF], dtype=np.uint32)])
    for value in bits.view(np.float32):
        text = patrol_table.float_text(float(value))
        assert re.fullmatch(r"\d+\.\d+f", text)
        assert np.float32(text[:-1]) == value
    assert patrol_table.float_text(0.1) == "0.1f"
    assert patrol_table.float_text(10000) == "10000.0f"


def test_members_become_groups():
    [wheels, flag, *_] = patrol_table.members_of([
        {"key": "a.b.c", "format": "float", "value": 0.5, "unit": "m"},
        {"key": "a.b.d", "format": "whole", "value": 3, "unit": "1"},
        {"key": "a.e", "format": "q24", "value": 2**23, "unit": "m/s"},
        {"key": "f", "format": "flag", "value": True, "unit": "1"}])
    [inner, speed] = wheels.members
    assert (wheels.name, inner.name) == ("a", "b")
    assert [(member.name, member.value, member.comment) for member in inner.members] == [
        ("c", "0.5f", "m"), ("d", "3U", "")]
    assert (speed.value, speed.comment, flag.value) == (str(2**23), "0.5 m/s", "true")


def test_bad_robots_are_refused_in_one_line_and_leave_nothing(tmp_path):
    for before, after, part in (("from_deg = 30.0;", "from_deg = 200.0;", "turning.from_deg"),
                                ("rounds = 3;", "", "band.rounds"),
                                ("hysteresis_s = 0.1;", "hysteresis_s = 0.01;", "band.hysteresis_s"),
                                ("horizon_m = 3.5;", "horizon_m = 3.5; mood = 1;", "patrol.mood")):
        robot = changed_robot(tmp_path / "broken.cfg", before, after)
        assert_one_line_error(make(robot, "--tables", tmp_path / "src"), "broken.cfg", part)
    assert_one_line_error(make("gao2018", "--tables", tmp_path / "src"), "gao2018.cfg", "type")
    assert_one_line_error(make("nobody", "--tables", tmp_path / "src"), "nobody.cfg", "No such file")
    assert not (tmp_path / "src").exists()


def test_a_copy_under_another_name_is_refused(tmp_path):
    copy = tmp_path / "mine.cfg"
    copy.write_bytes(ROBOT.read_bytes())
    assert_one_line_error(make(copy, "--tables", tmp_path / "src"), "mine.cfg", "name: is 'patrol'", "same name")
    assert not (tmp_path / "src").exists()


def test_a_missing_program_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv("JP_BUILD", str(tmp_path))
    assert_one_line_error(make("patrol", "--tables", tmp_path / "src"), "jp-patrol-config", "No such file")


# ---- jp-patrol-config ------------------------------------------------------------------------------------------------

def test_table_shows_every_member_in_its_unit():
    result = config(ROBOT)
    assert (result.returncode, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    data = printed()
    assert lines[0] == "patrol" and "pure_pursuit" in lines
    shown = [line.split() for line in lines if line.startswith(" ")]
    assert [(key, unit) for key, _, unit in shown] == [
        (member["key"], member["unit"]) for part in patrol_table.PARTS for member in data[part]]
    values = {key: float(value) for key, value, _ in shown}
    assert values["wheels.wheelbase"] == 0.5
    assert values["wheels.steering_limit"] == pytest.approx(100 / 360, rel=1e-5)
    assert values["turn_first"] == pytest.approx(np.radians(30), rel=1e-5)
    assert values["turns_in_place"] == 1
    assert values["waits_max"] == 100


@pytest.mark.parametrize("arguments, part", [
    ([], "a robot is needed"),
    ([ROBOT, ROBOT], "one robot only"),
    ([ROBOT, "--colour"], "colour"),
    ([ROOT / "sim" / "robots" / "zhang2018.cfg"], "four_wheel"),
    (["none.cfg"], "No such file"),
])
def test_wrong_command_lines_are_refused(arguments, part):
    result = config(*arguments)
    assert (result.returncode, result.stdout) == (2, "")
    assert part in result.stderr


def test_a_full_disk_is_an_error():
    with open("/dev/full", "w", encoding="utf-8") as full:
        result = subprocess.run([PROGRAM, ROBOT], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert result.returncode == 2
    assert "standard output: cannot write" in result.stderr
