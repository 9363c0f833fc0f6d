"""tools/report/navigate_report.py: page and picture from synthetic results of jp-navigate, bad input."""
import json
import math

import numpy as np
import pytest
from conftest import assert_one_line_error, run_tool, sketched
from PIL import Image
from test_plan_report import HEIGHT, ORIGIN, WIDTH, change, headings_of, map_data
from test_report import Page

from tools.report import navigate_report, plots
from tools.report.ground import OBSTACLE, UNKNOWN_FILL

START, GOAL = [10.5, -4.4, 30.0], [15.0, -4.4, 0.0]
# The first leg of each is 2 m long.
FIRST = {"time_s": 0.5, "reason": "-", "points_m": [[10.5, -4.4], [12.1, -3.2], [15.0, -4.4]]}
LATER = {"time_s": 9.0, "reason": "blocked ahead", "points_m": [[12.0, -3.5], [13.2, -1.9], [15.0, -4.4]]}
STATES = [("planning", 0.5, "-"), ("turning", 2.0, "-"), ("driving", 6.0, "-"), ("braking", 8.0, "blocked ahead"),
          ("planning", 9.0, "blocked ahead"), ("turning", 10.0, "blocked ahead"), ("driving", 20.0, "-"),
          ("arrived", 21.0, "-")]
PAGES = ("report.html", "navigate.png")


def write_log(path, states=None, seconds=20.0, part=1.0):
    """A drive on a part of a bow from start to goal, a line each half second."""
    lines = ["t_s,x_m,y_m,heading_deg,energy_j,state,reason,left_m,left_s"]
    for i in range(round(2 * seconds) + 1):
        time, share = 0.5 * i, part * 0.5 * i / seconds
        state, _, reason = next(state for state in states or STATES if time < state[1])
        lines.append(f"{time:.2f},{START[0] + 4.5 * share:.4f},{START[1] + 1.8 * math.sin(math.pi * share):.4f},"
                     f"{30 * share:.2f},{1234.5 * share:.3f},{state},{reason},{6 - 6 * share:.3f},{20 - time:.2f}")
    path.write_text("\n".join(lines) + "\n")


def write_drive(folder, elevation=False):
    """Results of a drive, equal on each call."""
    (folder / "map.json").write_text(json.dumps(map_data(elevation)))
    write_log(folder / "drive.csv")
    result = {"state": "arrived", "reason": "-", "touched": False, "replans": 1, "cells_seen": 4, "clearance_m": 0.035,
              "goal_error_m": 0.0424, "deviation_m": 0.0, "planned_j": 0.0, "length_m": 6.25, "time_s": 20.0, "energy_j": 1234.5, "forecast_j": 1010.0,
              "forecast_deviation_j": 20.0}
    summary = {"robot": "rover", "map": {"file": str(folder / "map.json"), "name": "yard", "note": "a <yard> & more"},
               "steepest": 2.0, "steep_cells": 0, "start": START, "goal": GOAL, "view_m": 2.5, "hidden_boxes": 6, "memory_bytes": 1048576, "seed": 3,
               "result": result, "courses": [FIRST, LATER],
               "seen": [[13, 6, 0.0], [14, 6, 5.5], [13, 7, 5.5], [14, 7, 6.0]], "log": "drive.csv"}
    (folder / "summary.json").write_text(json.dumps(summary))


def never_sets_out(folder, state, reason):
    """Makes it a drive that ends where it begins, without a course."""
    def edit(summary):
        summary["result"].update(state=state, reason=reason, replans=0, cells_seen=0, length_m=0.0, time_s=1.0,
                                 energy_j=4.0, forecast_j=0.0, forecast_deviation_j=0.0, goal_error_m=4.5)
        summary.update(courses=[], seen=[])
    change(folder, edit)
    write_log(folder / "drive.csv", [("planning", 0.5, "-"), ("proving", 1.0, "-"), (state, 2.0, reason)], 1.0, 0.0)


@pytest.fixture
def results(tmp_path):
    write_drive(tmp_path)
    return tmp_path


def report(folder):
    result = run_tool("report.navigate_report", folder)
    assert result.returncode == 0, result.stderr
    assert [line.split("/")[-1] for line in result.stdout.splitlines()] == list(PAGES)
    assert result.stdout.count("wrote ") == 2
    return (folder / "report.html").read_text()


def assert_refused(folder, *parts):
    assert_one_line_error(run_tool("report.navigate_report", folder), *parts)
    assert not any((folder / name).exists() for name in PAGES)


def shares_of_colours(folder):
    """Share of the picture near each colour."""
    pixels = np.asarray(Image.open(folder / "navigate.png").convert("RGB")).astype(int)

    def share(colour):
        wanted = [int(colour[i:i + 2], 16) for i in (1, 3, 5)]
        return float(np.mean(np.abs(pixels - wanted).max(axis=2) < 4))
    return share


@sketched
@pytest.mark.parametrize("elevation", [True, False])
def test_the_page_has_every_section_and_needs_nothing_else(tmp_path, elevation):
    write_drive(tmp_path, elevation)
    text = report(tmp_path)
    assert headings_of(text) == ["Courses", "The drive over the map", "Over time"]
    page = Page()
    page.feed(text)
    assert page.open == []
    assert len(page.images) == 2
    assert all(image["alt"] and image["src"].startswith("data:image/png;base64,") for image in page.images)
    assert page.outside == []
    assert "://" not in text
    assert "<h1>Drive over yard</h1>" in text
    for part in ("Robot rover", f"{WIDTH} × {HEIGHT} cells", "6 boxes", "seed 3", "1\u202f024\u202fKiB"):
        assert part in text


@sketched
def test_the_numbers_are_on_the_page(results):
    text = report(results)
    for card in ("<b>arrived</b><span>0.04\u202fm from the goal<", "<b>1\u202f234\u202fJ</b><span>energy driven<",
                 "<b>1\u202f010 ± 39\u202fJ</b><span>forecast of the first course",
                 "<b>6.2\u202fm</b><span>driven in 20.0\u202fs<", "<b>3.5\u202fcm</b><span>least clearance<",
                 "<b>4</b><span>cells not on the map; planned anew once<"):
        assert card in text


@sketched
def test_every_course_is_a_row_of_the_table(results):
    rows = report(results).split("<tr>")[2:]
    assert len(rows) == 2
    length = 2 + math.hypot(2.9, 1.2)
    for part in ("first</td>", "<td>0.5</td>", "<td>–</td>", "<td>2</td>", f"<td>{length:.2f}</td>"):
        assert part in rows[0]
    length = 2 + math.hypot(1.8, 2.5)
    for part in ("1</td>", "<td>9.0</td>", "<td>blocked ahead</td>", "<td>2</td>", f"<td>{length:.2f}</td>"):
        assert part in rows[1]


@sketched
def test_equal_data_give_equal_bytes(results):
    first = report(results), (results / "navigate.png").read_bytes()
    assert (report(results), (results / "navigate.png").read_bytes()) == first


@sketched
def test_texts_are_text_not_markup(results):
    text = report(results)
    assert "<yard>" not in text and "&lt;yard&gt; &amp; more" in text


@pytest.mark.parametrize("elevation", [True, False])
def test_picture_shows_ways_ground_and_what_was_seen(tmp_path, elevation):
    write_drive(tmp_path, elevation)
    report(tmp_path)
    share = shares_of_colours(tmp_path)
    for colour in (navigate_report.DRIVEN, navigate_report.FIRST["color"], navigate_report.BLOCKED):
        assert 1e-4 < share(colour) < 0.05, colour
    assert 0.001 < share(navigate_report.SEEN) < 0.01
    assert 0.005 < share(OBSTACLE) < 0.1
    assert 0.005 < share(UNKNOWN_FILL) < 0.1
    for _, _, colour in navigate_report.PHASES:
        assert share(colour) > 0.005, colour


@pytest.mark.parametrize("elevation", [True, False])
def test_ground_that_is_too_steep_is_shown(tmp_path, elevation):
    write_drive(tmp_path, elevation)
    change(tmp_path, lambda summary: summary.update(steepest=0.3, steep_cells=100))
    report(tmp_path)
    share = shares_of_colours(tmp_path)(navigate_report.STEEP)
    assert share > 0.05 if elevation else share < 0.01


def test_steep_cells_are_free_ones_whose_neighbours_differ(tmp_path):
    write_drive(tmp_path, True)
    ground = navigate_report.read_map(tmp_path / "map.json")
    steep = navigate_report.steep_cells(ground, 0.3)
    assert steep.any() and not steep[ground.cells != "."].any()
    for y, x in [(1, 2), (5, 20), (15, 8)]:
        slopes = [(ground.elevation[y, x + 1] - ground.elevation[y, x - 1]) / 0.4,
                  (ground.elevation[y + 1, x] - ground.elevation[y - 1, x]) / 0.4]
        assert steep[y, x] == (math.hypot(*slopes) > 0.3 and ground.cells[y, x] == ".")
    assert not navigate_report.steep_cells(ground, 2).any()


@sketched
def test_what_was_planned_and_how_well_it_knows_its_place(results):
    def edit(summary):
        summary["result"].update(planned_j=987.6, deviation_m=0.317)
    change(results, edit)
    assert "0.04\u202fm from the goal, known to 0.32\u202fm<" in report(results)
    log = navigate_report.read_log(results / "drive.csv")
    summary = navigate_report.read_summary(results / "summary.json")
    labels = [label for _, label in navigate_report.legend_of(summary, navigate_report.read_map(results / "map.json"), log)]
    assert any("planned 988\u202fJ, 1\u202f010 ± 39\u202fJ forecast" in label for label in labels)


def test_nothing_seen_and_nothing_planned_anew(results):
    def edit(summary):
        summary.update(seen=[], courses=[FIRST])
        summary["result"].update(replans=0, cells_seen=0)
    change(results, edit)
    assert "<b>0</b><span>cells not on the map; planned anew 0 times<" in report(results)
    assert shares_of_colours(results)(navigate_report.SEEN) == 0


@pytest.mark.parametrize("turn", [0.0, 0.5])
def test_seen_cells_are_where_the_map_has_them(results, turn):
    change(results, lambda data: data.update(origin_m=[*ORIGIN[:2], turn]), "map.json")
    ground = navigate_report.read_map(results / "map.json")
    figure, axes = plots.new_figure(4, 3)
    navigate_report.draw_seen(axes, ground, [[13, 6, 0.0]])
    image = axes.images[0]
    assert np.argwhere(np.asarray(image.get_array())[..., 3] > 0).tolist() == [[6, 13]]
    place = (image.get_transform() - axes.transData).transform((2.6, 1.2))
    plots.plt.close(figure)
    c, s = math.cos(turn), math.sin(turn)
    assert place == pytest.approx((ORIGIN[0] + 2.6 * c - 1.2 * s, ORIGIN[1] + 2.6 * s + 1.2 * c))


def test_stops_are_the_ends_of_braking_for_what_blocks_the_way():
    log = {"x_m": np.arange(7.0), "y_m": np.zeros(7),
           "state": np.array(["driving", "braking", "braking", "planning", "driving", "braking", "braking"]),
           "reason": np.array(["-", "blocked ahead", "blocked ahead", "blocked ahead", "-", "astray", "astray"])}
    assert navigate_report.stops(log).tolist() == [[2.0, 0.0]]
    log["reason"][5:] = "blocked ahead"
    assert navigate_report.stops(log).tolist() == [[2.0, 0.0], [6.0, 0.0]]
    log["state"][:] = "driving"
    assert navigate_report.stops(log).tolist() == []


@pytest.mark.parametrize("state, reason, label", [("unreachable", "-", "4.50\u202fm from the goal"),
                                                  ("failed", "no memory", "no memory, 4.50\u202fm from the goal")])
def test_a_drive_without_a_course(results, state, reason, label):
    never_sets_out(results, state, reason)
    text = report(results)
    assert f"<b>{state}</b><span>{label}<" in text
    assert "<b>–</b><span>forecast of the first course" in text
    assert "no course at all" in text and "<table>" not in text
    assert shares_of_colours(results)(navigate_report.FIRST["color"]) == 0


@sketched
def test_a_drive_that_is_over_at_once(results):
    never_sets_out(results, "failed", "hemmed in")
    path = results / "drive.csv"
    header, *_, last = path.read_text().splitlines()
    path.write_text(f"{header}\n0.00,{last.split(',', 1)[1]}\n")
    assert "hemmed in" in report(results)


@sketched
def test_a_drive_that_was_given_up(results):
    change(results, lambda summary: summary["result"].update(state="driving", goal_error_m=2.0))
    assert "<b>given up</b><span>while driving, 2.00\u202fm from the goal<" in report(results)


@sketched
@pytest.mark.parametrize("about, card", [
    ({"touched": True, "clearance_m": 0.0}, "<b>touched</b><span>something in the way<"),
    ({"clearance_m": 0.25}, "<b>≥ 25.0\u202fcm</b><span>least clearance<"),
])
def test_the_least_clearance_is_told_as_it_is_known(results, about, card):
    change(results, lambda summary: summary["result"].update(about))
    assert card in report(results)


@pytest.mark.parametrize("edit, part", [
    (lambda s: s.pop("courses"), "courses"),
    (lambda s: s.update(courses={}), "courses"),
    (lambda s: s["courses"][1].pop("time_s"), "courses[1]"),
    (lambda s: s["courses"][1].update(time_s="soon"), "time_s"),
    (lambda s: s["courses"][1].update(reason=7), "courses[1]: reason"),
    (lambda s: s["courses"][0].update(points_m=[]), "courses[0].points_m"),
    (lambda s: s["courses"][0].update(points_m=[[1, 2], [3]]), "courses[0].points_m[1]"),
    (lambda s: s.update(seen=3), "seen"),
    (lambda s: s["seen"].append([1, 2]), "seen[4]"),
    (lambda s: s["seen"].append([WIDTH, 2, 0.0]), "seen[4]"),
    (lambda s: s["seen"].append([2, -1, 0.0]), "seen[4]"),
    (lambda s: s["seen"].append([2.5, 1, 0.0]), "seen[4]"),
    (lambda s: s.update(start=[1, 2]), "start"),
    (lambda s: s.update(goal=["x", 2, 3]), "goal"),
    (lambda s: s.update(seed="lucky"), "seed"),
    (lambda s: s.update(view_m=None), "view_m"),
    (lambda s: s.pop("steepest"), "steepest"),
    (lambda s: s.update(steep_cells="many"), "steep_cells"),
    (lambda s: s["result"].pop("planned_j"), "planned_j"),
    (lambda s: s["result"].pop("energy_j"), "energy_j"),
    (lambda s: s["result"].update(forecast_j="much"), "forecast_j"),
    (lambda s: s["result"].update(clearance_m=math.nan), "clearance_m"),
    (lambda s: s["result"].update(touched="no"), "touched"),
    (lambda s: s["result"].pop("touched"), "touched"),
    (lambda s: s["result"].update(state="asleep"), "asleep"),
    (lambda s: s.update(result=[]), "result"),
    (lambda s: s.update(log=7), "log"),
    (lambda s: s.update(log="none.csv"), "none.csv"),
    (lambda s: s["map"].update(file=7), "file"),
    (lambda s: s["map"].update(file="none.json"), "none.json"),
    (lambda s: s["map"].pop("note"), "note"),
])
def test_garbled_summaries_are_refused(results, edit, part):
    change(results, edit)
    assert_refused(results, part)


@pytest.mark.parametrize("edit, part", [
    (lambda m: m.update(format="joulepath-map-9"), "format"),
    (lambda m: m.pop("rows"), "rows"),
    (lambda m: m["rows"].__setitem__(3, "..."), "rows"),
    (lambda m: m.update(origin_m=[0, 0]), "origin_m"),
])
def test_garbled_maps_are_refused(results, edit, part):
    change(results, edit, "map.json")
    assert_refused(results, "map.json", part)


@pytest.mark.parametrize("damage, part", [
    (lambda text: text.replace("left_m", "rest", 1), "left_m"),
    (lambda text: text.replace("state", "mood", 1), "state"),
    (lambda text: text.replace("0.00", "x", 1), "line 2"),
    (lambda text: text.replace("0.00", "nan", 1), "line 2"),
    (lambda text: text.replace("turning,", "", 1), "line 3"),
    (lambda text: text.replace("turning", "asleep", 1), "line 3: state 'asleep'"),
    (lambda text: text.split("\n", 1)[0] + "\n", "samples"),
    (lambda text: "", "column"),
])
def test_garbled_logs_are_refused(results, damage, part):
    path = results / "drive.csv"
    path.write_text(damage(path.read_text()))
    assert_refused(results, "drive.csv", part)


def test_missing_results_are_named(tmp_path):
    assert_refused(tmp_path, "summary.json")


def test_a_summary_that_is_no_json_is_refused(results):
    (results / "summary.json").write_text("{")
    assert_refused(results, "summary.json", "no JSON")
