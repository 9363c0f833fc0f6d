"""tools/report/round_report.py: page and picture of hours of patrol from synthetic results of jp-patrol, bad input."""
import json
import math
import re

import numpy as np
import pytest
from conftest import assert_one_line_error, run_tool, sketched
from PIL import Image
from test_patrol_report import CELL, HEIGHT, SIZE, WIDTH, map_rows
from test_report import Page

from tools.report import round_report

CHARGER, STOPS = [1.0, 1.0, 0.0], [[5.0, 1.0, 90.0], [4.5, 3.2, 180.0]]
SURVEYING, LEAVING, DWELLING, HOMING = 4, 6, 7, 8


def write_log(path, seconds=240):
    """Out to the first stop, a stay, home, and charged."""
    lines = ["t_s,x_m,y_m,heading_deg,held_j,told_j,state,stop"]
    for i in range(2 * seconds):
        share = i / (2 * seconds)
        state = LEAVING if share < 0.4 else DWELLING if share < 0.5 else HOMING if share < 0.9 else SURVEYING
        way = min(share / 0.4, 1) if share < 0.5 else max(0, (0.9 - share) / 0.4)
        held = 5000 - 4000 * min(share / 0.9, 1) + (4000 * (share - 0.9) / 0.1 if share > 0.9 else 0)
        lines.append(",".join(f"{value:.3f}" for value in (
            0.5 * i, 1 + 4 * way, 1 + 0.2 * math.sin(math.pi * way), 0, held, held - 5, state,
            0 if share < 0.5 else 2)))
    path.write_text("\n".join(lines) + "\n")


def journey(start, end, outcome="arrived", **more):
    return {"from": start, "to": end, "outcome": outcome, "start_s": 0.0, "time_s": 40.0, "length_m": 4.1,
            "foretold_j": 1234.5, "deviation_j": 99.0, "taken_j": 1301.0, "left_j": 2345.0, **more}


def summary_of(**changes):
    battery = {"full_j": 5000.0, "reserve_j": 200.0, "charger_w": 400.0, "deviations": 1.645, "least_left_j": 987.0,
               "below_reserve": 0, "account_error_j": 7.5}
    return {"kind": "round", "robot": "patrol", "scene": "depot", "robot_size_m": SIZE, "seed": 3, "hours": 0.5,
            "outcome": "went on", "reason": "", "visits": 2, "charges": 1, "skipped": 1, "time_s": 240.0,
            "length_m": 16.5, "energy_j": 4321.0, "charger": CHARGER, "stops": [{"pose": pose, "dwell_s": 12.0} for pose in STOPS],
            "map": {"file": "room.json", "width": WIDTH, "height": HEIGHT, "resolution_m": CELL, "rows": map_rows()},
            "battery": battery, "journeys": [journey(2, 0), journey(0, 2, "turned home")], "log": "log_round.csv",
            **changes}


def write(folder, seconds=240, **changes):
    (folder / "summary.json").write_text(json.dumps(summary_of(**changes)))
    write_log(folder / "log_round.csv", seconds)
    return folder


def report(folder):
    return run_tool("report.patrol_report", folder)


def test_page_and_picture(tmp_path):
    result = report(write(tmp_path))
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.splitlines() == [f"wrote {tmp_path}/report.html", f"wrote {tmp_path}/patrol.png"]
    text = (tmp_path / "report.html").read_text()
    assert "Hours of patrol: depot" in text and "turned home" in text and "stop 1" in text
    assert re.search(r"987\u202fJ", text) and "1 stops left out" in text
    page = Page()
    page.feed(text)
    assert page.open == [] and page.outside == [] and len(page.images) == 2
    assert page.rows == 1 + 2 and re.findall(r"<h2>(.*?)</h2>", text) == ["Journeys", "The ways", "The battery"]
    assert Image.open(tmp_path / "patrol.png").size[0] > 1000


@sketched
def test_equal_results_give_equal_files(tmp_path):
    found = []
    for name in "ab":
        (tmp_path / name).mkdir()
        assert report(write(tmp_path / name)).returncode == 0
        found.append([(tmp_path / name / file).read_bytes() for file in ("report.html", "patrol.png")])
    assert found[0] == found[1]


@pytest.mark.parametrize("seconds, label", [(240, "time, s"), (1200, "time, min")])
def test_the_battery_over_time(seconds, label, tmp_path):
    folder = write(tmp_path, seconds)
    rounds = round_report.read_round(folder / "summary.json", json.loads((folder / "summary.json").read_text()))
    figure, axes = round_report.plots.new_figure(6, 3)
    round_report.fill_battery(axes, rounds)
    texts = [text.get_text() for text in axes.get_legend().get_texts()]
    assert texts == ["at the charger", "at a stop", "on its way home", "in the battery", "as the robot counts",
                     "reserve"]
    assert axes.get_xlabel() == label and axes.get_ylabel() == "energy, kJ"
    held = axes.lines[0].get_ydata()
    assert np.isclose(held.max(), 5, atol=0.1) and np.isclose(held.min(), 1, atol=0.1)
    round_report.plots.plt.close(figure)


def test_the_map_names_every_place(tmp_path):
    folder = write(tmp_path)
    rounds = round_report.read_round(folder / "summary.json", json.loads((folder / "summary.json").read_text()))
    figure, axes = round_report.plots.new_figure(6, 4)
    round_report.fill_map(axes, rounds)
    assert {"charger", "1", "2"} <= {text.get_text() for text in axes.texts}
    outward, homeward = (line.get_xdata() for line in axes.lines[:2])
    assert not np.any(np.isfinite(outward) & np.isfinite(homeward)) and np.nanmax(homeward) > 4.9
    round_report.plots.plt.close(figure)


@sketched
def test_a_round_that_never_came_home(tmp_path):
    battery = {**summary_of()["battery"], "least_left_j": None}
    result = report(write(tmp_path, battery=battery, journeys=[], charges=0, outcome="gave up",
                          reason="there is no way"))
    assert result.returncode == 0, result.stderr
    assert "there is no way" in (tmp_path / "report.html").read_text()


@pytest.mark.parametrize("changes, text", [
    ({"stops": []}, "stops"),
    ({"stops": [{"pose": [1.0, 2.0], "dwell_s": 1.0}]}, "stops[0].pose"),
    ({"stops": [{"pose": CHARGER}]}, "dwell_s"),
    ({"charger": [1.0]}, "charger"),
    ({"visits": "many"}, "visits"),
    ({"battery": {"full_j": 1.0}}, "battery"),
    ({"journeys": 1}, "journeys"),
    ({"journeys": [journey(0, 7)]}, "to is 7"),
    ({"journeys": [{**journey(0, 1), "taken_j": None}]}, "taken_j"),
    ({"map": {"width": 3, "height": 1, "resolution_m": 0.05, "rows": ["..x"]}}, "map.rows"),
    ({"log": "none.csv"}, "none.csv"),
])
def test_bad_results_are_one_line(changes, text, tmp_path):
    result = report(write(tmp_path, **changes))
    assert result.returncode == 2
    assert_one_line_error(result, text)
    assert not (tmp_path / "report.html").exists()
