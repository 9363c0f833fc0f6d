"""The picture of from where a robot comes home: what it draws, and what it refuses."""
import json

import pytest
from conftest import assert_one_line_error, run_tool

SIDE = 12


@pytest.fixture
def results(tmp_path):
    cells = ["#" * SIDE, *["#" + "." * (SIDE - 2) + "#"] * (SIDE - 2), "#" * SIDE]
    (tmp_path / "map.json").write_text(json.dumps({"format": "joulepath-map-1", "name": "hall", "width": SIDE, "height": SIDE,
                                                   "resolution_m": 0.2, "origin_m": [0, 0, 0], "rows": cells}))
    reach = [[-1 if cell == "#" else min(100, 10 * (x + 1)) for x, cell in enumerate(row)] for row in cells]
    home = {"state": "home", "turned_back": True, "stranded": False, "battery_j": 100, "confidence": 0.999, "given_j": 90,
            "least_probability": 0.999, "trip_j": 150, "trip_deviation_j": 12, "reach_percent": reach}
    summary = {"robot": "courier24", "map": {"file": str(tmp_path / "map.json"), "name": "hall", "note": ""},
               "start": [0.5, 0.5, 0], "goal": [2, 2, 0], "log": "drive.csv", "home": home}
    (tmp_path / "drive.csv").write_text("t_s,x_m,y_m,state,reason\n0,0.5,0.5,idle,-\n1,1.0,0.5,driving,-\n")
    return tmp_path, summary


def draw(folder, summary):
    (folder / "summary.json").write_text(json.dumps(summary))
    return run_tool("report.reach_picture", folder)


def test_picture(results):
    folder, summary = results
    result = draw(folder, summary)
    assert (result.returncode, result.stderr) == (0, "")
    assert (folder / "reach.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("change", [
    lambda home: home.pop("reach_percent"),
    lambda home: home.update(reach_percent=[[1, 2], [3]]),
    lambda home: home.update(reach_percent=[[101] * SIDE] * SIDE),
    lambda home: home.update(reach_percent="all"),
    lambda home: home.update(given_j="much"),
    lambda home: home.update(state=3),
])
def test_refuses_what_it_cannot_draw(results, change):
    folder, summary = results
    change(summary["home"])
    assert_one_line_error(draw(folder, summary), "home")
    assert not (folder / "reach.png").exists()


def test_refuses_a_drive_without_a_battery(results):
    folder, summary = results
    del summary["home"]
    assert_one_line_error(draw(folder, summary), "home")
