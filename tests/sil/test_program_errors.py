"""Every way that input and output of jp-mission and jp-identify can be wrong: one clear line on stderr, exit status 2,
nothing half-written, what was there before as it was."""
import json
import resource
import shutil
import signal

import pytest
from conftest import ROOT, assert_one_line_error, fill_disk, run

MISSION_FILES = [*(f"log_{name}.csv" for name in ("optimal", "straight", "bezier", "cruise", "straight_cruise",
                                                  "bezier_route")), "summary.json"]
IDENTIFY_FILES = ["experiments.csv", "experiments.json"]
OLD = "from an earlier run\n"


def mission(scenario, output, **options):
    return run("jp-mission", scenario, "--output", output, **options)


def identify(output, *arguments, **options):
    return run("jp-identify", ROOT / "sim/robots/gao2018.cfg", "--count", 20, "--output", output, *arguments,
               **options)


@pytest.fixture
def output(tmp_path):
    """An output folder with the files of an earlier run."""
    folder = tmp_path / "out"
    folder.mkdir()
    for name in MISSION_FILES + IDENTIFY_FILES:
        (folder / name).write_text(OLD)
    return folder


def assert_untouched(folder, but=None):
    assert sorted(path.name for path in folder.iterdir()) == sorted(MISSION_FILES + IDENTIFY_FILES)
    for path in folder.iterdir():
        assert path.name == but or path.read_text() == OLD, path


# ---- scenario ------------------------------------------------------------------------------------------------------

LINES = {
    "name": 'name = "short";\n',
    "robot": 'robot = "robot.cfg";\n',
    "energy_model": 'energy_model = "identified";\n',
    "seed": "seed = 1;\n",
    "waypoints": "waypoints = ( [0.0, 0.0], [2.0, 0.5], [3.0, 2.0] );\n",
}

WRONG_LINES = [  # key, its line, what the message must hold besides file and key
    ("name", "", "missing"),
    ("name", "name = 3;\n", "text"),
    ("name", 'name = "";\n', "text"),
    ("name", f'name = "{"x" * 64}";\n', "63"),
    ("robot", "", "missing"),
    ("robot", "robot = 1;\n", "text"),
    ("energy_model", "", "missing"),
    ("energy_model", 'energy_model = "guessed";\n', "guessed"),
    ("energy_model", "energy_model = true;\n", "text"),
    ("energy", LINES["seed"] + 'energy = "heat";\n', "heat"),
    ("energy", LINES["seed"] + 'energy = "";\n', "text"),
    ("energy", LINES["seed"] + "energy = 2;\n", "text"),
    ("energy_model", 'energy_model = "published"; energy = "battery";\n', "published model is of the motors"),
    ("seed", "", "whole number"),
    ("seed", "seed = -1;\n", "whole number"),
    ("seed", "seed = 1.5;\n", "whole number"),
    ("seed", "seed = 1e10;\n", "whole number"),
    ("seed", 'seed = "1";\n', "whole number"),
    ("within_seconds", LINES["seed"] + "within_seconds = 0;\n", "from 0.001 to 32767 s"),
    ("within_seconds", LINES["seed"] + "within_seconds = 1e6;\n", "from 0.001 to 32767 s"),
    ("within_seconds", LINES["seed"] + 'within_seconds = "soon";\n', "number in s"),
    ("within_joules", LINES["seed"] + "within_joules = -1.0;\n", "from 0.001 to 1000000000 J"),
    ("within_joules", LINES["seed"] + "within_seconds = 9.0; within_joules = 9.0;\n", "leave one of them out"),
    ("waypoints", "", "list"),
    ("waypoints", "waypoints = 5;\n", "list"),
    ("waypoints", "waypoints = ();\n", "list"),
    ("waypoints", "waypoints = ( [0.0, 0.0] );\n", "list"),
    ("waypoints", "waypoints = ( " + ", ".join(f"[{i}.0, 0.0]" for i in range(129)) + " );\n", "128"),
    ("waypoints[0]", "waypoints = ( [1.0, 0.0], [2.0, 0.0] );\n", "odometry starts"),
    ("waypoints[1]", "waypoints = ( [0.0, 0.0], [0.0, 0.0] );\n", "coincides"),
    ("waypoints[1]", "waypoints = ( [0.0, 0.0], [1.0] );\n", "write [x, y]"),
    ("waypoints[1]", "waypoints = ( [0.0, 0.0], [1.0, 0.0, 361.0] );\n", "heading within ±360°"),
    ("waypoints[1]", "waypoints = ( [0.0, 0.0], [1.0, 0.0, 0.0, 9.0] );\n", "speed of 0.01 to 8 m/s"),
    ("waypoints[1]", "waypoints = ( [0.0, 0.0], [1.0, 0.0, 0.0, 0.1, 1.0] );\n", "write [x, y]"),
    ("waypoints[0]", "waypoints = ( [0.0, 0.0, 90.0], [1.0, 0.0] );\n", "looking along x"),
    ("waypoints[2]", "waypoints = ( [0.0, 0.0], [1.0, 1.0], [1.0, 1.001] );\n", "coincides"),
    ("waypoints[1]", "waypoints = ( [0.0, 0.0], [600.0, 0.0] );\n", "512"),
    ("waypoints[1]", "waypoints = ( [0.0, 0.0], [1e5, 0.0] );\n", "two numbers"),
    ("waypoints[1]", "waypoints = ( [0.0, 0.0], [1e999, 0.0] );\n", "two numbers"),
    ("waypoints[1]", "waypoints = ( [0.0, 0.0], [1.0] );\n", "two numbers"),
    ("waypoints[1]", 'waypoints = ( [0.0, 0.0], ["a", "b"] );\n', "two numbers"),
    ("waypoints[1]", "waypoints = ( [0.0, 0.0], 7 );\n", "two numbers"),
    ("waypoints[1]", "waypoints = ( [0.0, 0.0], { x = 1.0; } );\n", "two numbers"),
    ("colour", LINES["seed"] + "colour = 3;\n", "unknown key"),
    ("Seed", "Seed = 1;\n", "unknown key"),
]


@pytest.mark.parametrize(("key", "line", "reason"), WRONG_LINES)
def test_wrong_line_of_a_scenario(scenario, output, key, line, reason):
    replaced = LINES.get(key.split("[")[0], LINES["seed"])
    text = scenario.read_text()
    assert replaced in text
    scenario.write_text(text.replace(replaced, line))
    assert_one_line_error(mission(scenario, output), scenario, key, reason)
    assert_untouched(output)


@pytest.mark.parametrize("text", ["waypoints = ( [0.0, nan], [inf, 0.0] );", "name = ", "{", "\0", "name = \"x", "é;",
                                  'name = "a"; name = "b";', '@include "missing.cfg"\n'])
def test_scenario_that_cannot_be_parsed(scenario, output, text):
    scenario.write_text(text)
    assert_one_line_error(mission(scenario, output), scenario)
    assert_untouched(output)


def test_scenario_that_cannot_be_read(scenario, output, tmp_path):
    assert_one_line_error(mission(tmp_path / "none.cfg", output), "none.cfg", "No such file")
    assert_one_line_error(mission(tmp_path, output), tmp_path)
    scenario.write_text("")
    assert_one_line_error(mission(scenario, output), scenario, "empty")
    scenario.write_text("#" * 100000)
    assert_one_line_error(mission(scenario, output), scenario)
    assert_untouched(output)


def test_robot_that_is_missing(scenario, output):
    (scenario.parent / "robot.cfg").unlink()
    assert_one_line_error(mission(scenario, output), scenario.parent / "robot.cfg", "No such file")
    assert_untouched(output)


def test_robot_that_is_wrong(scenario, output):
    robot = scenario.parent / "robot.cfg"
    robot.write_text(robot.read_text().replace("mass_kg", "mass_pounds", 1))
    assert_one_line_error(mission(scenario, output), robot, "mass_pounds")
    assert_untouched(output)


@pytest.mark.parametrize(("kind", "type_name"), [("zhang2018", "skid_steer"), ("patrol", "four_wheel")])
def test_robot_of_another_kind(scenario, output, kind, type_name):
    shutil.copy(ROOT / f"sim/robots/{kind}.cfg", scenario.parent / "robot.cfg")
    results = [run("jp-identify", scenario.parent / "robot.cfg", "--output", output)]
    if kind == "patrol":
        results.append(mission(scenario, output))
    for result in results:
        assert_one_line_error(result, scenario.parent / "robot.cfg", f"{type_name} robot; needs a balancer")
    assert_untouched(output)


def test_whole_and_real_coordinates_may_be_mixed(scenario, tmp_path):
    assert mission(scenario, tmp_path / "real").returncode == 0
    scenario.write_text(scenario.read_text().replace("[0.0, 0.0], [2.0, 0.5]", "[0, 0], [2, 0.5]"))
    assert mission(scenario, tmp_path / "mixed").returncode == 0
    for name in MISSION_FILES[:-1]:
        assert (tmp_path / "real" / name).read_bytes() == (tmp_path / "mixed" / name).read_bytes()


def test_robot_without_gains(scenario, output):
    robot = scenario.parent / "robot.cfg"
    robot.write_text(robot.read_text().replace('name = "gao2018"', 'name = "nobody"'))
    assert_one_line_error(mission(scenario, output), "nobody", "make gains ROBOT=nobody", "gao2018")
    assert_one_line_error(run("jp-identify", robot, "--output", output), "nobody", "make gains ROBOT=nobody")
    assert_untouched(output)


UNDRIVABLE = [  # robot, a line of its file and what it becomes, what the message must hold
    ("gao2018", "torque_constant_nm_per_a = 0.317;", "torque_constant_nm_per_a = 0.05;", "fell", "control.weights"),
    ("gao2018", "centre_height_m = 0.159;", "centre_height_m = 0.5;", "fault: overspeed;", "limits"),
    ("courier24", "noise_rms_dps = 0.1;", "noise_rms_dps = 60.0;", "fault: IMU jump;", "sensors"),
]


@pytest.mark.parametrize("name, before, after, reason, advice", UNDRIVABLE)
def test_why_a_robot_does_not_drive(tmp_path, output, name, before, after, reason, advice):
    robot = tmp_path / f"{name}.cfg"
    text = (ROOT / "sim/robots" / robot.name).read_text()
    assert text.count(before) == 1
    robot.write_text(text.replace(before, after))
    scenario = tmp_path / "scenario.cfg"
    scenario.write_text("".join(LINES.values()).replace("robot.cfg", robot.name))
    assert_one_line_error(run("jp-identify", robot, "--count", 20, "--output", output), robot, "experiment", reason, advice,
                          f"make gains ROBOT={name}")
    assert_one_line_error(mission(scenario, output), "leg", reason)
    assert_untouched(output)


# Behind the robot: σ reaches 80°, and the arc that is left takes longer than the 600 s allowed. Cruise has no such limit.
def test_waypoint_that_segments_cannot_reach_is_a_row(scenario, output):
    scenario.write_text(scenario.read_text().replace(LINES["waypoints"], "waypoints = ( [0.0, 0.0], [-511.0, 0.0] );"))
    result = mission(scenario, output)
    assert result.returncode == 0, result.stderr
    assert "cannot drive this route: waypoints[1]: cannot be planned" in result.stdout
    optimal, cruise = (next(row for row in json.loads((output / "summary.json").read_text())["strategies"]
                            if row["name"] == name) for name in ("optimal", "cruise"))
    assert "cannot be planned" in optimal["impossible"] and cruise["segments"][0]["passed_m"] < 0.01


@pytest.mark.parametrize("arguments", [[], ["--output"], ["a.cfg"], ["--output", "out"], ["--nonsense"],
                                       ["a.cfg", "b.cfg", "--output", "out"]])
@pytest.mark.parametrize("program", ["jp-mission", "jp-identify"])
def test_wrong_command_lines(program, arguments, tmp_path):
    result = run(program, *arguments, cwd=tmp_path)
    assert result.returncode == 2
    assert result.stderr != ""
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("arguments", [["--count", "5"], ["--count", "nan"], ["--count", "1e9"], ["--count", "x"],
                                       ["--count", "20.5"], ["--seed", "-1"], ["--seed", "inf"], ["--seed", "1.5"],
                                       ["--threshold", "0"], ["--threshold", "nan"], ["--count", ""]])
def test_numbers_out_of_range(output, arguments):
    result = run("jp-identify", ROOT / "sim/robots/gao2018.cfg", "--output", output, *arguments)
    assert result.returncode == 2
    assert arguments[0] in result.stderr
    assert_untouched(output)


# ---- output --------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("start", ["jp-mission", "jp-identify"])
def test_output_that_is_a_file(scenario, tmp_path, start):
    place = tmp_path / "place"
    place.write_text(OLD)
    for path in [place, place / "below"]:
        result = mission(scenario, path) if start == "jp-mission" else identify(path)
        assert_one_line_error(result, place, "--output")
        assert place.read_text() == OLD


def test_output_that_cannot_be_made(scenario):
    assert_one_line_error(mission(scenario, "/proc/none"), "/proc/none")
    assert_one_line_error(mission(scenario, ""), "output directory")
    assert_one_line_error(mission(scenario, "x/" * 600), "output directory")
    assert_one_line_error(identify("/proc/none"), "/proc/none")


def test_output_that_nobody_may_write(scenario):
    """/proc takes files from no one, not even from root."""
    assert_one_line_error(mission(scenario, "/proc"), "/proc")
    assert_one_line_error(identify("/proc"), "/proc")


@pytest.mark.parametrize("name", MISSION_FILES)
def test_disk_is_full_for_one_file_of_the_mission(scenario, output, name):
    fill_disk(output / name)
    assert_one_line_error(mission(scenario, output), output / name, "No space left on device")
    assert_untouched(output, but=name)


@pytest.mark.parametrize("name", IDENTIFY_FILES)
def test_disk_is_full_for_one_file_of_the_identification(output, name):
    fill_disk(output / name)
    assert_one_line_error(identify(output), output / name, "No space left on device")
    assert_untouched(output, but=name)


@pytest.mark.parametrize("name", MISSION_FILES)
def test_place_of_one_file_is_taken_by_a_folder(scenario, output, name):
    (output / name).unlink()
    (output / name).mkdir()
    assert_one_line_error(mission(scenario, output), output / name)
    (output / name).rmdir()
    (output / name).write_text(OLD)
    assert_untouched(output)


def limit_file_size(size):
    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    return limit


def test_every_write_fails_once(scenario, output, tmp_path):
    """The n-th block of the longest file cannot be written, for every n."""
    assert mission(scenario, tmp_path / "whole").returncode == 0
    longest = max(path.stat().st_size for path in (tmp_path / "whole").iterdir())
    for size in [0, 1, *range(4096, longest, 4096), longest - 1]:
        assert_one_line_error(mission(scenario, output, preexec_fn=limit_file_size(size)), output, "File too large")
        assert_untouched(output)


def test_success_replaces_what_was_there(scenario, output):
    result = mission(scenario, output)
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    assert sorted(path.name for path in output.iterdir()) == sorted(MISSION_FILES + IDENTIFY_FILES)
    assert all((output / name).read_text() != OLD for name in MISSION_FILES)
