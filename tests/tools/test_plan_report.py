"""tools/report/plan_report.py: page and picture from synthetic results of jp-plan, bad input."""
import json
import math
import re

import numpy as np
import pytest
from conftest import assert_one_line_error, run_tool, sketched
from PIL import Image
from test_report import Page

from tools.report import plan_report
from tools.report.ground import OBSTACLE, UNKNOWN_FILL, cell_centres, read_map

WIDTH, HEIGHT, CELL = 30, 20, 0.2
ORIGIN = [10.0, -5.0, 0.0]


def map_data(elevation=True):
    rows = ["." * WIDTH] * 8 + ["." * 10 + "####" + "." * 10 + "??????"] * 4 + ["." * WIDTH] * 8
    data = {"format": "joulepath-map-1", "name": "yard", "width": WIDTH, "height": HEIGHT, "resolution_m": CELL,
            "origin_m": ORIGIN, "note": "a <yard> & more", "rows": rows}
    if elevation:
        data["elevation_m"] = [[round(math.sin(x / 6) * math.cos(y / 5), 3) for x in range(WIDTH)]
                               for y in range(HEIGHT)]
    return data


def route_about(name, energy, length, answer="optimal"):
    return {"name": name, "title": f"{name}-optimal", "file": f"{name}_route.csv", "cost": "physical",
            "answer": answer, "length_m": length, "energy_j": energy, "time_s": 2 * length, "climb_m": 0.8,
            "turning_energy_j": 31.5, "bound": 1.0 if answer == "optimal" else None,
            "distance_left_m": 0.0 if answer == "optimal" else 1.75, "steps": 20, "expansions": 1234, "states": 2345,
            "planning_s": 0.0125}


def write_route(path, about, bow, steps=20):
    lines = [",".join(plan_report.ROUTE_COLUMNS)]
    for i in range(steps + 1):
        share = i / max(steps, 1)
        lines.append(",".join(f"{value:.4f}" for value in (
            ORIGIN[0] + 0.5 + 4.5 * share, ORIGIN[1] + 0.6 + bow * math.sin(math.pi * share), 0.3 * share, 45.0,
            about["length_m"] * share, about["energy_j"] * share, about["time_s"] * share)))
    path.write_text("\n".join(lines) + "\n")


def write_plan(folder, elevation=True, drive=False):
    """Results of a plan, equal on each call."""
    (folder / "map.json").write_text(json.dumps(map_data(elevation)))
    routes = [route_about("energy", 1931.0, 5.25), route_about("distance", 2289.0, 5.05)]
    for about, bow in zip(routes, (2.2, 0.4)):
        write_route(folder / about["file"], about, bow)
    summary = {
        "robot": "rover", "map": {"file": str(folder / "map.json"), "name": "yard", "note": "a <yard> & more",
                                  "width": WIDTH, "height": HEIGHT, "resolution_m": CELL, "has_elevation": elevation},
        "parameters": {"version": 7, "file": "learned.json"},
        "memory": {"block_bytes": 262144, "guide_bytes": 4096, "field_bytes": 1200, "search_bytes": 250000,
                   "states_max": 13333, "map_bytes": 1360},
        "task_chosen": True, "start": [10.5, -4.4, 30.0], "goal_m": [15.0, -4.4], "routes": routes,
        "comparison": {"energy_percent": -15.64, "length_percent": 3.96, "time_percent": None}, "drive": None}
    if drive:
        summary["drive"] = {
            "scenario": "scenario.cfg", "log": "drive.csv", "waypoints_m": [[10.5, -4.4], [12.6, -3.2], [15.0, -4.4]],
            "margin_m": 0.1, "clear": True, "end_error_m": 0.0123, "level_ground_assumed": elevation,
            "planned": {"length_m": 5.25, "energy_j": 1900.0, "time_s": 10.5},
            "predicted": {"length_m": 5.2, "energy_j": 1955.5, "time_s": 11.0},
            "driven": {"length_m": 5.22, "energy_j": 1961.25, "time_s": 11.1}, "battery_energy_j": 1700.0}
        log = [f"{0.25 * i},{0.1 * i},{98.0 * i}" for i in range(20)]
        (folder / "drive.csv").write_text("x_m,y_m,energy_j\n" + "\n".join(log) + "\n")
    (folder / "summary.json").write_text(json.dumps(summary))


@pytest.fixture
def results(tmp_path):
    write_plan(tmp_path)
    return tmp_path


def change(folder, edit, name="summary.json"):
    data = json.loads((folder / name).read_text())
    edit(data)
    (folder / name).write_text(json.dumps(data))


def report(folder):
    result = run_tool("report.plan_report", folder)
    assert result.returncode == 0, result.stderr
    return (folder / "report.html").read_text()


def headings_of(text):
    return re.findall(r"<h2>(.*?)</h2>", text)


@sketched
@pytest.mark.parametrize("elevation", [True, False])
@pytest.mark.parametrize("drive", [True, False])
def test_the_page_has_every_section_and_needs_nothing_else(tmp_path, elevation, drive):
    write_plan(tmp_path, elevation, drive)
    text = report(tmp_path)
    sections = ["Routes compared", "Routes over the map", "Along the routes"]
    assert headings_of(text) == sections[:1] + ["The energy-optimal route, driven"] * drive + sections[1:]
    page = Page()
    page.feed(text)
    assert page.open == []
    assert len(page.images) == 2
    assert all(image["alt"] and image["src"].startswith("data:image/png;base64,") for image in page.images)
    assert page.outside == []
    assert "://" not in text
    assert "<h1>Plan over yard</h1>" in text
    assert "parameters learned, version 7 ·" in text
    for number in ("1\u202f931.0", "2\u202f289.0", "−15.64", "+3.96", "256\u202fKiB", "13\u202f333"):
        assert number in text
    assert ("climbs out" in text) == (elevation and drive)
    assert ("1\u202f961.2" in text) == drive


@sketched
def test_equal_data_give_equal_bytes(results):
    first = report(results), (results / "plan.png").read_bytes()
    assert (report(results), (results / "plan.png").read_bytes()) == first


@sketched
def test_texts_are_text_not_markup(results):
    text = report(results)
    assert "<yard>" not in text and "&lt;yard&gt; &amp; more" in text


def shares_of_colours(folder):
    """Share of the picture near each colour."""
    pixels = np.asarray(Image.open(folder / "plan.png").convert("RGB")).astype(int)

    def share(colour):
        wanted = [int(colour[i:i + 2], 16) for i in (1, 3, 5)]
        return float(np.mean(np.abs(pixels - wanted).max(axis=2) < 12))
    return share


@pytest.mark.parametrize("elevation", [True, False])
def test_picture_shows_routes_obstacles_and_unknown_ground(tmp_path, elevation):
    write_plan(tmp_path, elevation, drive=True)
    report(tmp_path)
    share = shares_of_colours(tmp_path)
    for colour in (plan_report.COLOURS["energy"], plan_report.COLOURS["distance"], plan_report.plots.GREEN):
        assert 2e-4 < share(colour) < 0.05, colour
    assert 0.005 < share(OBSTACLE) < 0.1
    assert 0.005 < share(UNKNOWN_FILL) < 0.1


@sketched
def test_the_unreachable_is_named(results):
    def edit(summary):
        for route in summary["routes"]:
            route.update(route_about(route["name"], 0.0, 0.0, "unreachable"))
        summary["comparison"] = None
    change(results, edit)
    for name in ("energy", "distance"):
        write_route(results / f"{name}_route.csv", route_about(name, 0.0, 0.0), 0.0, steps=0)
    text = report(results)
    assert "unreachable" in text
    assert "1.8\u202fm are left" in text
    assert "difference" not in text


@sketched
def test_parameters_that_are_built_in(results):
    change(results, lambda summary: summary.update(parameters={"version": 0, "file": None}))
    assert "parameters built in, version 0 ·" in report(results)


@sketched
def test_a_turned_map(results):
    change(results, lambda data: data.update(origin_m=[10.0, -5.0, 0.5]), "map.json")
    report(results)
    ground = read_map(results / "map.json")
    x, y = cell_centres(ground)
    assert (x[0, 0] - 10, y[0, 0] + 5) == pytest.approx(
        (0.1 * math.cos(0.5) - 0.1 * math.sin(0.5), 0.1 * math.cos(0.5) + 0.1 * math.sin(0.5)))


def test_driven_path_is_in_the_frame_of_the_map():
    log = {"x_m": np.array([0.0, 2.0]), "y_m": np.array([0.0, 1.0])}
    path = plan_report.driven_path(log, [10.0, 20.0, 90.0])
    assert path == pytest.approx(np.array([[10.0, 20.0], [9.0, 22.0]]))


@sketched
def test_small_and_level_maps(results):
    def edit(data):
        data.update(width=1, height=1, rows=["."], elevation_m=[[0.0]])
    change(results, edit, "map.json")
    report(results)
    change(results, lambda data: data.update(rows=["?"]), "map.json")
    report(results)


@pytest.mark.parametrize("edit, part", [
    (lambda s: s.pop("routes"), "routes"),
    (lambda s: s.update(routes=[]), "routes"),
    (lambda s: s["routes"][1].pop("energy_j"), "routes[1]"),
    (lambda s: s["routes"][0].update(length_m="far"), "length_m"),
    (lambda s: s["routes"][0].update(title=7), "title"),
    (lambda s: s["routes"][0].update(file="none.csv"), "none.csv"),
    (lambda s: s.update(start=[1, 2]), "start"),
    (lambda s: s.update(goal_m=["x", 2]), "goal_m"),
    (lambda s: s.update(comparison={}), "comparison"),
    (lambda s: s["memory"].pop("states_max"), "states_max"),
    (lambda s: s.pop("parameters"), "parameters"),
    (lambda s: s["parameters"].update(version="new"), "version"),
    (lambda s: s["drive"].update(waypoints_m=[[1]]), "drive.waypoints_m[0]"),
    (lambda s: s["drive"]["driven"].pop("energy_j"), "drive.driven"),
    (lambda s: s["map"].update(file="none.json"), "none.json"),
])
def test_garbled_summaries_are_refused(tmp_path, edit, part):
    write_plan(tmp_path, drive=True)
    change(tmp_path, edit)
    assert_one_line_error(run_tool("report.plan_report", tmp_path), part)
    assert not (tmp_path / "report.html").exists() and not (tmp_path / "plan.png").exists()


@pytest.mark.parametrize("edit, part", [
    (lambda m: m.update(format="joulepath-map-9"), "format"),
    (lambda m: m.pop("rows"), "rows"),
    (lambda m: m.update(rows=3), "rows"),
    (lambda m: m["rows"].pop(), "rows"),
    (lambda m: m["rows"].__setitem__(3, "..."), "rows"),
    (lambda m: m.update(elevation_m=[[1.0]]), "elevation_m"),
    (lambda m: m["elevation_m"][2].__setitem__(2, "high"), "elevation_m"),
    (lambda m: m["elevation_m"][2].__setitem__(2, math.nan), "elevation_m"),
    (lambda m: m.update(origin_m=[0, 0]), "origin_m"),
])
def test_garbled_maps_are_refused(results, edit, part):
    change(results, edit, "map.json")
    assert_one_line_error(run_tool("report.plan_report", results), "map.json", part)


@pytest.mark.parametrize("damage, part", [
    (lambda text: text.replace("energy_j", "joules", 1), "energy_j"),
    (lambda text: text.replace("45.0", "x", 1), "line 2"),
    (lambda text: text.split("\n", 1)[0] + "\n", "samples"),
])
def test_garbled_routes_are_refused(results, damage, part):
    path = results / "energy_route.csv"
    path.write_text(damage(path.read_text()))
    assert_one_line_error(run_tool("report.plan_report", results), "energy_route.csv", part)


def test_missing_results_are_named(tmp_path):
    assert_one_line_error(run_tool("report.plan_report", tmp_path), "summary.json")
