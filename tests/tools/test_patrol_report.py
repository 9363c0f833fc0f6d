"""tools/report/patrol_report.py: page and picture from synthetic results of jp-patrol, bad input."""
import json
import math
import re

import numpy as np
import pytest
from conftest import assert_one_line_error, run_tool, sketched
from PIL import Image
from test_report import Page

from tools.report import patrol_report

WIDTH, HEIGHT, CELL = 120, 80, 0.05
SIZE = [0.8, 0.6]
START, GOAL = [1.0, 1.0, 0.0], [5.0, 3.0, 90.0]
NAMES = {"improved": "improved TEB", "plain": "plain TEB", "pursuit": "pure pursuit"}


def map_rows(hidden=True):
    """The northern row first, as in the file: walls, a pillar, unknown ground, and what the map does not show."""
    cells = np.full((HEIGHT, WIDTH), ".")
    cells[:4], cells[-4:], cells[:, :4], cells[:, -4:] = "#", "#", "#", "#"
    cells[30:38, 50:60] = "#"
    cells[60:70, 8:20] = "?"
    if hidden:
        cells[10:22, 108:116] = "o"
    return ["".join(row) for row in cells]


def write_log(path, seconds, bow):
    """A drive on a bow from start to goal, the first second turning in place."""
    lines = ["t_s,x_m,y_m,heading_deg,believed_x_m,believed_y_m,believed_heading_deg,speed_m_s,turn_rate_rad_s,"
             "clearance_m,energy_j,state,reason"]
    for i in range(round(10 * seconds)):
        share = i / max(10 * seconds - 1, 1)
        x = START[0] + share * (GOAL[0] - START[0])
        y = START[1] + share * (GOAL[1] - START[1]) + bow * math.sin(math.pi * share)
        lines.append(",".join(f"{value:.4f}" for value in (
            0.1 * i, x, y, 90 * share, x, y, 90 * share, 0.6 * math.sin(math.pi * share) - 0.1 * (bow < 0),
            math.cos(9 * share), 1 - 0.9 * share, 30 * i, 1 if i < 10 else 2, 0)))
    path.write_text("\n".join(lines) + "\n")


def snapshot(second, moving):
    obstacles = [{"x_m": 3.0, "y_m": 0.6 + (0.3 * second if moving else 0), "heading_deg": 0.0, "radius_m": 0.25,
                  "length_m": 0.0, "width_m": 0.0},
                 {"x_m": 2.0, "y_m": 3.0, "heading_deg": 30.0, "radius_m": 0.0, "length_m": 0.6, "width_m": 0.4}]
    return {"time_s": float(second), "pose": [1.0, 1.0, 0.0], "obstacles": obstacles,
            "band_m": [[1.0 + 0.3 * second, 1.0], [2.0 + 0.3 * second, 1.2], [2.5 + 0.3 * second, 1.5]]}


def method_about(name, seconds, outcome="arrived", reason="", moving=False, plans=1):
    plan = {"time_s": 0.0, "way_m": [START[:2], [3.0, 2.4], GOAL[:2]],
            "path_m": [START[:2], [2.0, 1.8], [3.0, 2.4], GOAL[:2]]}
    return {"name": name, "title": NAMES[name], "log": f"log_{name}.csv", "outcome": outcome, "reason": reason,
            "time_s": float(seconds), "length_m": 5.25, "energy_j": 1931.0, "reversed_m": 0.75,
            "direction_changes": 3, "clearance_min_m": 0.123, "position_error_m": 0.034, "heading_error_deg": 2.5,
            "odometry_error_m": 0.021,
            "planner": {"turning_points": 3, "expansions": 1234, "edge_nodes": 4321, "bytes": 262144,
                        "path_length_m": 4.7},
            "counts": {"cycles": 10 * seconds, "turns": 2, "waits": 1, "infeasible_bands": 4, "laser_missing": 5,
                       "laser_rejected": 6, "scans_missing": 7, "shapes_dropped": 8, "replans": plans - 1},
            "plans": [plan] * plans, "snapshots": [snapshot(second, moving) for second in range(seconds)]}


def write_patrol(folder, hidden=True, moving=False, faults=False):
    """Results of three drives, equal on each call."""
    methods = [method_about("improved", 20, moving=moving),
               method_about("plain", 24, "gave up", "no way"),
               method_about("pursuit", 12, "collided")]
    for method, bow in zip(methods, (0.4, -0.6, 0.9)):
        write_log(folder / method["log"], method["time_s"], bow)
    summary = {
        "robot": "patrol", "scene": "a <room> & more", "robot_size_m": SIZE, "seed": 7,
        "map": {"file": None, "width": WIDTH, "height": HEIGHT, "resolution_m": CELL, "rows": map_rows(hidden)},
        "start": START, "goal": GOAL, "limit_s": 90.0,
        "faults": {"beam_dropout": 0.25, "scan_dropout_s": [3.0, 5.5], "jump_s_m": [8.0, 0.4], "slip": True} if faults else
                  {"beam_dropout": 0.0, "scan_dropout_s": [0.0, 0.0], "jump_s_m": [-1.0, 0.0], "slip": False},
        "states": ["held", "turning", "driving", "waiting", "arrived", "stopped"], "reasons": ["", "in collision"],
        "methods": methods}
    (folder / "summary.json").write_text(json.dumps(summary))


@pytest.fixture
def results(tmp_path):
    write_patrol(tmp_path)
    return tmp_path


def change(folder, edit):
    data = json.loads((folder / "summary.json").read_text())
    edit(data)
    (folder / "summary.json").write_text(json.dumps(data))


def report(folder):
    result = run_tool("report.patrol_report", folder)
    assert result.returncode == 0, result.stderr
    return (folder / "report.html").read_text()


def picture(folder):
    return np.asarray(Image.open(folder / "patrol.png").convert("RGB")).astype(int)


def share_of(pixels, colour):
    """Share of the picture near a colour."""
    wanted = [int(colour[i:i + 2], 16) for i in (1, 3, 5)]
    return float(np.mean(np.abs(pixels - wanted).max(axis=2) < 12))


# ---- page and picture ----------------------------------------------------------------------------------------------

@sketched
@pytest.mark.parametrize(("moving", "faults"), [(True, True), (False, False)])
def test_the_page_has_every_section_and_needs_nothing_else(tmp_path, moving, faults):
    write_patrol(tmp_path, moving=moving, faults=faults)
    text = report(tmp_path)
    assert re.findall(r"<h2>(.*?)</h2>", text) == ["Methods compared", "What the controller counted", "The drives",
                                                   "Over time"]
    page = Page()
    page.feed(text)
    assert page.open == []
    assert len(page.images) == 2
    assert all(image["alt"] and image["src"].startswith("data:image/png;base64,") for image in page.images)
    assert page.outside == []
    assert "://" not in text
    for part in ("gave up: no way", "collided", "arrived", "1\u202f931.0", "0.123", "12.3\u202fcm", "256\u202fKiB",
                 "1\u202f234", "4.70\u202fm"):
        assert part in text, part
    for fault in ("25\u202f% of the beams", "no scans from 3 to 5.5\u202fs", "jumps by 0.40\u202fm at 8\u202fs",
                  "slippery ground"):
        assert (fault in text) == faults


@sketched
def test_texts_are_text_not_markup(results):
    text = report(results)
    assert "<room>" not in text and "&lt;room&gt; &amp; more" in text


@sketched
def test_equal_data_give_equal_bytes(results):
    first = report(results), (results / "patrol.png").read_bytes()
    assert (report(results), (results / "patrol.png").read_bytes()) == first


def test_picture_shows_tracks_walls_and_what_is_hidden(results):
    report(results)
    pixels = picture(results)
    for name in NAMES:
        assert 3e-4 < share_of(pixels, patrol_report.LOOKS[name]["color"]) < 0.05, name
    assert 1e-4 < share_of(pixels, patrol_report.WAY) < 0.05
    assert 0.01 < share_of(pixels, patrol_report.FILLS["#"]) < 0.3
    assert 0.002 < share_of(pixels, patrol_report.FILLS["?"]) < 0.1
    assert 0.002 < share_of(pixels, patrol_report.FILLS["o"]) < 0.1
    assert share_of(pixels, patrol_report.COLLISION) > 1e-4


def test_what_moves_is_shown_along_its_way(tmp_path):
    shares = []
    for moving in (False, True):
        folder = tmp_path / str(moving)
        folder.mkdir()
        write_patrol(folder, hidden=False, moving=moving)
        report(folder)
        pixels = picture(folder)
        shares.append((share_of(pixels, patrol_report.FILLS["o"]), share_of(pixels, patrol_report.MOVER)))
    (standing, _), (_, mover) = shares
    assert standing > 0.002  # what stands is filled as what is hidden
    assert shares[1][0] < standing
    assert mover > 1e-5


def shape_of(folder):
    return Image.open(folder / "patrol.png").size


@sketched
def test_a_high_map_has_the_panels_beside_it(tmp_path):
    write_patrol(tmp_path)
    report(tmp_path)
    wide = shape_of(tmp_path)

    def turn(summary):
        rows = ["".join(column) for column in zip(*summary["map"]["rows"])]
        summary["map"].update(width=HEIGHT, height=WIDTH, rows=rows)
        summary.update(start=[1.0, 1.0, 90.0], goal=[3.0, 5.0, 0.0])
        for method in summary["methods"]:
            method.update(plans=[], snapshots=[])
    change(tmp_path, turn)
    for name in NAMES:
        path = tmp_path / f"log_{name}.csv"
        path.write_text(path.read_text().replace("t_s,x_m,y_m", "t_s,y_m,x_m"))
    report(tmp_path)
    assert wide[1] > shape_of(tmp_path)[1]


@sketched
def test_methods_that_never_drove(results):
    """No path: the logs have no lines."""
    def edit(summary):
        for method in summary["methods"]:
            method.update(outcome="no path", time_s=0.0, plans=[], snapshots=[])
    change(results, edit)
    for name in NAMES:
        path = results / f"log_{name}.csv"
        path.write_text(path.read_text().split("\n")[0] + "\n")
    text = report(results)
    assert "no path" in text
    assert share_of(picture(results), patrol_report.LOOKS["plain"]["color"]) < 2e-3  # the legend's


@sketched
def test_one_method_alone(results):
    change(results, lambda summary: summary.update(methods=summary["methods"][1:2]))
    assert "pure pursuit" not in report(results)


@sketched
def test_new_plans_are_told(results):
    change(results, lambda s: s["methods"].__setitem__(0, method_about("improved", 20, plans=3)))
    summary, drives = patrol_report.load(results)
    _, labels = patrol_report.map_legend(summary, drives)
    assert any(label.endswith("planned 3 times") for label in labels)


# ---- parts ---------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize(("seconds", "period"), [(0, 1), (30, 1), (31, 2), (150, 5), (299, 10), (5000, 60)])
def test_outlines_stay_few(seconds, period):
    assert patrol_report.outline_period(seconds) == period


def test_runs_of_a_state():
    times = np.arange(6) / 10
    assert patrol_report.spans_of(times, np.array([True, True, False, False, True, False])) == pytest.approx(
        [(0, 0.2), (0.4, 0.5)])
    assert patrol_report.spans_of(times, np.zeros(6, dtype=bool)) == []
    assert patrol_report.spans_of(times, np.ones(6, dtype=bool)) == pytest.approx([(0, 0.5)])


@sketched
def test_what_is_shown_of_a_large_map(results):
    summary, drives = patrol_report.load(results)
    summary["map"].update(width=4000, height=4000)
    west, east, south, north = patrol_report.map_extent(summary, drives)
    assert (west, south) == (0, 0)
    assert 7 < east < 9 and 5 < north < 7
    summary["map"].update(width=WIDTH, height=HEIGHT)
    assert patrol_report.map_extent(summary, drives) == pytest.approx((0, 6, 0, 4))


def test_whether_anything_moves():
    assert not patrol_report.moves([])
    assert not patrol_report.moves([snapshot(0, False), snapshot(1, False)])
    assert patrol_report.moves([snapshot(0, True), snapshot(1, True)])


def test_robot_is_drawn_where_it_is():
    corners = patrol_report.placed(patrol_report.rectangle(*SIZE), 2.0, 1.0, 90.0)
    assert np.ptp(corners, axis=0) == pytest.approx([0.6, 0.8])
    assert corners.mean(axis=0) == pytest.approx([2.0, 1.0])


# ---- bad input -----------------------------------------------------------------------------------------------------

@pytest.mark.parametrize(("edit", "part"), [
    (lambda s: s.pop("methods"), "methods"),
    (lambda s: s.update(methods=[]), "methods"),
    (lambda s: s.update(start=[1, 2]), "start"),
    (lambda s: s.update(goal=["x", 2, 3]), "goal"),
    (lambda s: s.update(scene=3), "scene"),
    (lambda s: s["map"].pop("rows"), "map"),
    (lambda s: s["map"]["rows"].pop(), "map.rows"),
    (lambda s: s["map"]["rows"].__setitem__(2, "." * 3), "map.rows"),
    (lambda s: s["map"]["rows"].__setitem__(2, "x" * WIDTH), "map.rows"),
    (lambda s: s["map"].update(rows=[], height=0), "map.rows"),
    (lambda s: s["faults"].pop("jump_s_m"), "faults"),
    (lambda s: s["methods"][1].pop("energy_j"), "methods[1]"),
    (lambda s: s["methods"][0].update(time_s="late"), "time_s"),
    (lambda s: s["methods"][0].update(outcome=1), "outcome"),
    (lambda s: s["methods"][0].update(log="none.csv"), "none.csv"),
    (lambda s: s["methods"][2]["planner"].pop("bytes"), "methods[2].planner"),
    (lambda s: s["methods"][2]["counts"].update(turns=None), "turns"),
    (lambda s: s["methods"][0].update(plans=3), "plans"),
    (lambda s: s["methods"][0]["plans"][0].update(way_m=[[1]]), "methods[0].plans[0].way_m[0]"),
    (lambda s: s["methods"][0]["plans"][0].update(path_m=None), "path_m"),
    (lambda s: s["methods"][0]["snapshots"][1].pop("obstacles"), "snapshots[1]"),
    (lambda s: s["methods"][0]["snapshots"][1]["obstacles"][0].update(x_m="here"), "x_m"),
])
def test_garbled_summaries_are_refused(results, edit, part):
    change(results, edit)
    assert_one_line_error(run_tool("report.patrol_report", results), part)
    assert not (results / "report.html").exists() and not (results / "patrol.png").exists()


@pytest.mark.parametrize(("damage", "part"), [
    (lambda text: text.replace("clearance_m", "room", 1), "clearance_m"),
    (lambda text: text.replace("1.0000", "x", 1), "line 2"),
    (lambda text: text + "1,2\n", "values"),
])
def test_garbled_logs_are_refused(results, damage, part):
    path = results / "log_plain.csv"
    path.write_text(damage(path.read_text()))
    assert_one_line_error(run_tool("report.patrol_report", results), "log_plain.csv", part)


def test_missing_results_are_named(tmp_path):
    assert_one_line_error(run_tool("report.patrol_report", tmp_path), "summary.json")
