"""tools/measure/time_front.py and tools/report/time_front_picture.py: limits of a drive of jp-front; the picture of synthetic
results; bad input."""
import copy
import json
import subprocess

import pytest
from conftest import ROOT, assert_one_line_error, run_tool
from PIL import Image

from tools.design import robot_json
from tools.measure import bench_limit, time_front
from tools.report import time_front_picture

PICTURE = "report.time_front_picture"
MEASURE = "measure.time_front"


def energy_in(seconds):
    """J, least in 20 s."""
    return 100 + 2000 / seconds + 5 * seconds


def forecast_in(seconds):
    return {"cruise_m_s": 10 / seconds, "duration_s": seconds, "energy_j": 1.004 * energy_in(seconds)}


def drive_in(seconds, request="share", limit=None):
    return {"request": request, "limit": seconds if limit is None else limit, "forecast": forecast_in(seconds),
            "duration_s": seconds, "plant_energy_j": 1.003 * energy_in(seconds), "end_speed_m_s": 10 / seconds,
            "passed_m": 0.004}


FRONT = {
    "robot": "gao2018", "scenario": "hill", "energy": "motor", "seed": 1, "waypoints_m": [[0, 0], [1.0, 0.5]],
    "forecasts": [forecast_in(seconds) for seconds in range(10, 40)],
    "drives": [drive_in(20.0, "least_energy", 0), drive_in(18.0), drive_in(14.0), drive_in(12.0),
               drive_in(16.0, "within_seconds"), drive_in(13.0, "within_joules", 330.0)],
}
LIMITS = {"scenario": "hill",
          "drives": [{"duration_s": drive["duration_s"], "energy_j": energy_in(drive["duration_s"])}
                     for drive in FRONT["drives"]],
          "slower": [{"duration_s": seconds, "energy_j": energy_in(seconds)} for seconds in (26.0, 24.0, 22.0)]}


def write(folder, front=None, limits=None):
    (folder / "front.json").write_text(json.dumps(front or FRONT))
    (folder / "limits.json").write_text(json.dumps(limits or LIMITS))


# ---- Limits --------------------------------------------------------------------------------------------------------

def test_limits_of_a_short_route(tmp_path, monkeypatch):
    monkeypatch.setattr(bench_limit, "STARTS", 1)
    monkeypatch.setattr(time_front, "SLOWER", (1.2,))
    scenario = tmp_path / "corner.cfg"
    scenario.write_text(f'name = "corner"; robot = "{ROOT}/sim/robots/gao2018.cfg"; energy_model = "identified"; '
                        "seed = 1; waypoints = ( [0.0, 0.0], [0.99, 0.99], [2.0, 1.0] );\n")
    subprocess.run([robot_json.build_directory() / "bin/jp-front", scenario, "--output", tmp_path], check=True,
                   capture_output=True)
    front = json.loads((tmp_path / "front.json").read_text())
    front["drives"] = [drive for drive in front["drives"] if drive["request"] != "share"]
    (tmp_path / "front.json").write_text(json.dumps(front))
    result = run_tool(MEASURE, tmp_path)
    assert result.returncode == 0, result.stderr
    limits = json.loads((tmp_path / "limits.json").read_text())
    assert [limit["duration_s"] for limit in limits["drives"]] == pytest.approx(
        [drive["duration_s"] for drive in front["drives"]])
    for drive, limit in zip(front["drives"], limits["drives"], strict=True):
        assert -0.005 < drive["plant_energy_j"] / limit["energy_j"] - 1 < 0.05
    least, in_time, in_energy = (limit["energy_j"] for limit in limits["drives"])
    slower, = (limit["energy_j"] for limit in limits["slower"])
    assert in_energy > in_time > least < slower
    for text in ("corner: robot gao2018", "asked: within s", "above, %"):
        assert text in result.stdout
    assert run_tool(PICTURE, tmp_path).returncode == 0


def test_the_slowest_is_found_first(monkeypatch):
    asked = []

    def least_in(_, ends, *__):
        asked.extend(ends)
        return [type("Found", (), {"energy": energy_in(seconds)}) for _, seconds in ends]
    monkeypatch.setattr(time_front.energy_limit, "least_in", least_in)
    monkeypatch.setattr(bench_limit, "check_limit", lambda *_: None)
    limits = time_front.limits_of(FRONT)
    assert [seconds for _, seconds in asked] == sorted((seconds for seconds, _ in limits), reverse=True)
    assert limits[:2] == [(20.0, energy_in(20.0)), (18.0, energy_in(18.0))]
    assert [seconds for seconds, _ in limits[-3:]] == pytest.approx([26.0, 24.0, 22.0])
    assert asked[0] == (pytest.approx(0.5 / 1.3), pytest.approx(26.0))


# ---- Picture -------------------------------------------------------------------------------------------------------

def test_it_is_a_picture_and_repeats(tmp_path):
    write(tmp_path)
    assert run_tool(PICTURE, tmp_path).returncode == 0
    first = (tmp_path / "front.png").read_bytes()
    width, height = Image.open(tmp_path / "front.png").size
    assert width > height > 600
    assert run_tool(PICTURE, tmp_path).returncode == 0
    assert (tmp_path / "front.png").read_bytes() == first


def test_it_names_what_it_shows():
    figure = time_front_picture.draw(FRONT, LIMITS)
    upper, lower = figure.axes
    labels = [text.get_text().replace("\u202f", " ") for text in upper.get_legend().get_texts()]
    assert labels[-3:] == ["least energy: 20.00 s, 300.9 J", "asked: least energy within 16.00 s: 16.00 s, 305.9 J",
                           "asked: fastest within 330.0 J: 13.00 s, 319.8 J"]
    assert any("0.4 cm" in label for label in labels)
    assert [axes.get_ylabel() for axes in (upper, lower)] == ["energy (motor), J", "above the least, %"]
    assert lower.get_xlabel() == "time of the whole route, s"
    heights = [line.get_ydata()[0] for line in lower.lines if len(line.get_ydata()) == 1]
    assert heights == pytest.approx([0.3] * len(FRONT["drives"]))


def test_a_drive_that_was_asked_for_twice_is_one_point_of_the_curve():
    front, limits = copy.deepcopy(FRONT), copy.deepcopy(LIMITS)
    front["drives"].append(front["drives"][-1])
    limits["drives"].append(limits["drives"][-1])
    assert len(time_front_picture.draw(front, limits).axes) == 2


# ---- Bad input -----------------------------------------------------------------------------------------------------

def broken(data, *path, value=None):
    data = copy.deepcopy(data)
    *parents, last = path
    place = data
    for key in parents:
        place = place[key]
    place[last] = value
    return data


@pytest.mark.parametrize(("path", "part"), [
    (("waypoints_m",), "waypoints_m"), (("waypoints_m", 0), "waypoints_m[0]"), (("forecasts",), "forecasts"),
    (("forecasts", 3), "forecasts[3]"), (("drives",), "drives"), (("drives", 1, "duration_s"), "duration_s"),
    (("drives", 1, "forecast"), "drives[1].forecast"), (("drives", 1, "request"), "request is None")])
def test_a_bad_front_is_one_line(tmp_path, path, part):
    write(tmp_path, front=broken(FRONT, *path))
    for tool in (PICTURE, MEASURE):
        assert_one_line_error(run_tool(tool, tmp_path), "front.json", part)
    assert not (tmp_path / "front.png").exists()


@pytest.mark.parametrize(("path", "value", "part"), [
    (("slower",), None, "slower"), (("drives", 0), None, "drives[0]"), (("slower", 0, "energy_j"), "x", "energy_j"),
    (("scenario",), "valley", "another front"), (("drives",), LIMITS["drives"][:2], "another front")])
def test_bad_limits_are_one_line(tmp_path, path, value, part):
    write(tmp_path, limits=broken(LIMITS, *path, value=value))
    assert_one_line_error(run_tool(PICTURE, tmp_path), "limits.json", part)


def test_an_empty_folder_is_one_line(tmp_path):
    for tool in (PICTURE, MEASURE):
        assert_one_line_error(run_tool(tool, tmp_path), "front.json", "No such file")
