"""tools/TUTORIAL.md: its robot file and scenario are good as they stand there, and `make tutorial` does all of it."""
import subprocess

import pytest
from conftest import ROOT, assert_one_line_error, run_tool
from programs import BIN

from tools.measure import bench_tutorial
from tools.measure.figure_store import read_figures, read_json

TEXT = bench_tutorial.TUTORIAL.read_text(encoding="utf-8")
ROBOT, SCENARIO = (bench_tutorial.files(TEXT)[f"sim/{name}/mine.cfg"] for name in ("robots", "scenarios"))


@pytest.fixture(name="robot")
def fixture_robot(tmp_path):
    path = tmp_path / "robots" / "mine.cfg"
    path.parent.mkdir()
    path.write_text(ROBOT, encoding="utf-8")
    return path


def test_its_robot_file_is_accepted(robot):
    subprocess.run([BIN / "jp-robot", robot], check=True, capture_output=True)


def test_its_robot_gets_a_controller(robot, tmp_path):
    result = run_tool("design.gain_design", robot, "--tables", tmp_path)
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "robot_mine.c").exists()


def test_constants_of_the_motor_mixed_up_are_told_as_it_says(robot, tmp_path):
    mixed = robot.read_text(encoding="utf-8").replace("gear_ratio = 1.0;", "gear_ratio = 82.0;")
    robot.write_text(mixed, encoding="utf-8")
    result = run_tool("design.gain_design", robot, "--tables", tmp_path)
    assert result.returncode == 2 and "takes 154 V" in result.stderr


def test_its_scenario_is_of_its_robot(robot, tmp_path):
    scenario = tmp_path / "scenarios" / "mine.cfg"
    scenario.parent.mkdir()
    scenario.write_text(SCENARIO, encoding="utf-8")
    result = subprocess.run([BIN / "jp-mission", scenario, "--output", tmp_path / "results"], capture_output=True, text=True)
    # Its tables are not built in here: until `make robot` has made them, that is all that it lacks.
    assert result.returncode == 2 and result.stderr.count("\n") == 1 and result.stderr.startswith("mine: no gains for this robot"), result.stderr


# ---- The bench, which does the steps in a fresh copy -----------------------------------------------------------------

def test_every_section_has_its_step():
    sections = [title for title, _ in bench_tutorial.sections(TEXT)]
    assert sections[0] == "The robot file" and sections[-1] == "Measured energy"
    assert [title for title, _ in bench_tutorial.steps(TEXT)] == sections[1:-1]


def test_its_targets_are_there():
    text = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tools/make").glob("*.mk"))
    for _, command in bench_tutorial.steps(TEXT):
        assert f"\n{command.split()[1]}:" in text


def run_bench(tmp_path, monkeypatch, text, setup="skip"):
    (tmp_path / "TUTORIAL.md").write_text(text, encoding="utf-8")
    monkeypatch.setattr(bench_tutorial, "TUTORIAL", tmp_path / "TUTORIAL.md")
    monkeypatch.setattr(bench_tutorial, "build_directory", lambda: tmp_path)
    monkeypatch.setattr(bench_tutorial, "copy_sources", lambda folder: [(folder / "sim" / name).mkdir(parents=True)
                                                                        for name in ("robots", "scenarios")])
    monkeypatch.setenv("JP_SETUP", setup)
    (tmp_path / "tutorial").mkdir()
    return run_tool("measure.bench_tutorial")


STEPS = """# All
## 1. Files
`sim/robots/mine.cfg`:
```
robot
```
`sim/scenarios/mine.cfg`:
```
scenario
```
## 2. Look
`make -f /dev/null -v` looks.
## 3. Read
`make -f {}` reads.
"""


def test_steps_are_done_in_a_copy_with_the_files_and_are_timed(tmp_path, monkeypatch):
    (tmp_path / "good.mk").write_text("all: ; @cat sim/robots/mine.cfg sim/scenarios/mine.cfg\n")
    result = run_bench(tmp_path, monkeypatch, STEPS.format(tmp_path / "good.mk"))
    assert result.returncode == 0, result.stderr
    rows = read_json(tmp_path / "tutorial/tutorial.tables.json")["tutorial"]["rows"]
    assert [row[0] for row in rows] == ["Look", "Read"] and all(float(row[2]) >= 0 for row in rows)
    figures = read_figures(tmp_path / "tutorial/tutorial.json")
    assert [figure["unit"] for figure in figures] == ["s", "s"] and figures[0]["bound"] == {"op": "<=", "value": 600}


def test_the_copy_gets_what_it_needs_first(tmp_path, monkeypatch):
    (tmp_path / "good.mk").write_text("all: ; @test ! -e .venv\n")
    monkeypatch.setattr(bench_tutorial, "SETUP", ("needs", "touch installed"))
    result = run_bench(tmp_path, monkeypatch, STEPS.format(tmp_path / "good.mk"), "")
    assert result.returncode == 0, result.stderr
    rows = read_json(tmp_path / "tutorial/tutorial.tables.json")["tutorial"]["rows"]
    assert [row[:2] for row in rows][0] == ["needs", "`touch installed`"] and len(rows) == 3


def test_a_step_that_fails_is_named(tmp_path, monkeypatch):
    (tmp_path / "bad.mk").write_text("all: ; @echo it broke >&2; exit 1\n")
    result = run_bench(tmp_path, monkeypatch, STEPS.format(tmp_path / "bad.mk"))
    assert_one_line_error(result, "bad.mk", "exit status 2")
