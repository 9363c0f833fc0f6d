"""tools/report/report.py: every section from synthetic results, bad input."""
import json
import re
import shutil
from html.parser import HTMLParser

import pytest
from conftest import ROOT, assert_one_line_error, run_tool, sketched
from mission_data import write_mission

from tools.report.report import COLOURS, STYLES

SECTIONS = ["Segments of the route", "Strategies compared", "Path", "Energy", "Speed and turn rate", "Pitch", "Motors",
            "Power", "Coordinate error"]


class Page(HTMLParser):
    """Collects headings, images, and what the page loads from elsewhere."""

    def __init__(self):
        super().__init__()
        self.open, self.images, self.outside, self.rows = [], [], [], 0

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag not in ("meta", "img", "br", "link"):
            self.open.append(tag)
        if tag == "img":
            self.images.append(attributes)
        self.rows += tag == "tr"
        self.outside += [value for key, value in attributes.items()
                         if key in ("src", "href") and not value.startswith("data:")]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.fixture(scope="session")
def sound_mission(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mission")
    write_mission(folder)
    return folder


@pytest.fixture
def mission(sound_mission, tmp_path):
    return shutil.copytree(sound_mission, tmp_path, dirs_exist_ok=True)


def change(directory, edit):
    path = directory / "summary.json"
    summary = json.loads(path.read_text())
    edit(summary)
    path.write_text(json.dumps(summary))


def test_the_page_has_every_section_and_needs_nothing_else(mission):
    result = run_tool("report.report", mission)
    assert result.returncode == 0, result.stderr
    text = (mission / "report.html").read_text()
    headings = re.findall(r"<h2>(.*?)</h2>", text)
    assert [h.replace("'", "&#39;") for h in headings] == SECTIONS
    page = Page()
    page.feed(text)
    assert page.open == []
    assert len(page.images) == 7
    assert all(image["alt"] and image["src"].startswith("data:image/png;base64,") for image in page.images)
    assert page.outside == []
    assert "://" not in text
    for number in ("1\u202f114.06", "1\u202f203.30", "326.11", "100.00"):
        assert number in text


def cells(page, row):
    """The cells of the table row with this label."""
    return re.findall(r"<td>(.*?)</td>", re.search(rf"<tr[^>]*><td>{row}</td>(.*?)</tr>", page)[1])


@sketched
def test_what_was_foretold_stands_beside_what_was_spent(mission):
    assert run_tool("report.report", mission).returncode == 0
    page = (mission / "report.html").read_text()
    assert cells(page, "forecast before the start, J") == ["–", "–", "–", "1\u202f079.78 ± 24.69"]
    assert cells(page, "total energy, J")[3] == "1\u202f079.81"
    # Its segments are shown one by one, as those of the first strategy.
    assert page.count("what was planned and what the robot spent") == 2
    assert page.index("Cruise and transients: what was planned") < page.index("Strategies compared")


@sketched
def test_without_a_forecast_none_is_shown(mission):
    change(mission, lambda s: s["strategies"][3].update(forecast=None))
    assert run_tool("report.report", mission).returncode == 0
    page = (mission / "report.html").read_text()
    assert "forecast" not in page and page.count("what was planned and what the robot spent") == 1


def test_every_strategy_of_the_simulator_has_a_colour_and_style_of_its_own():
    report = (ROOT / "sim/missions/mission_report.c").read_text()
    names = re.findall(r'\[MISSION_\w+\] = \{"(\w+)"', report)
    balancers, skid = names[:names.index("rounded")], names[names.index("rounded"):]
    assert len(balancers) >= 6 and len(skid) >= 3 and set(COLOURS) == set(STYLES) == set(names)
    for kind in (balancers, skid):
        assert len({COLOURS[name] for name in kind}) == len(kind)


WORLD = {"name": "MuJoCo 3", "conditions": "slope 5°", "ledger_j": {"cells": 200.0, "copper": 50.0, "open": -1.0},
         "film": "film.png", "film_is": "rendered by MuJoCo"}


@sketched
def test_a_drive_in_another_world_shows_its_film_and_ledger(mission):
    (mission / "film.png").write_bytes(b"film")
    change(mission, lambda s: s.update(world=WORLD))
    assert run_tool("report.report", mission).returncode == 0
    page = (mission / "report.html").read_text()
    assert "In MuJoCo 3" in page and "slope 5°. The film is rendered by MuJoCo." in page
    assert cells(page, "copper") == ["50.000", "25.000"] and "ZmlsbQ==" in page


@sketched
def test_a_film_that_is_not_there_is_named(mission):
    change(mission, lambda s: s.update(world=WORLD))
    assert_one_line_error(run_tool("report.report", mission), "film.png")
    change(mission, lambda s: s.update(world={"name": "MuJoCo 3"}))
    assert_one_line_error(run_tool("report.report", mission), "world", "conditions")


@sketched
def test_equal_data_give_equal_bytes(mission):
    assert run_tool("report.report", mission).returncode == 0
    first = (mission / "report.html").read_bytes()
    assert run_tool("report.report", mission).returncode == 0
    assert (mission / "report.html").read_bytes() == first


@sketched
def test_a_robot_that_does_not_balance_has_no_pitch(mission):
    path = mission / "log_optimal.csv"
    header, *rows = path.read_text().splitlines()
    place = header.split(",").index("pitch_deg")
    level = [",".join("0" if i == place else cell for i, cell in enumerate(row.split(","))) for row in rows]
    path.write_text("\n".join([header, *level]) + "\n")
    assert run_tool("report.report", mission).returncode == 0
    headings = re.findall(r"<h2>(.*?)</h2>", (mission / "report.html").read_text())
    assert headings == [section for section in SECTIONS if section != "Pitch"]


@sketched
def test_titles_are_text_not_markup(mission):
    change(mission, lambda s: s["strategies"][0].update(title="<script>alert(1)</script>"))
    assert run_tool("report.report", mission).returncode == 0
    text = (mission / "report.html").read_text()
    assert "<script" not in text and "&lt;script&gt;" in text


@sketched
def test_a_single_strategy_makes_a_page(mission):
    def edit(summary):
        del summary["strategies"][1:]
        summary["waypoints_m"] = summary["waypoints_m"][:2]
        summary["strategies"][0]["segments"] = summary["strategies"][0]["segments"][:1]
    change(mission, edit)
    assert run_tool("report.report", mission).returncode == 0
    assert (mission / "path.png").read_bytes().startswith(b"\x89PNG")


@sketched
def test_a_strategy_that_cannot_drive_the_route_is_said(mission):
    reason = "leg 2: the path bends more than the robot takes"
    kept = ("name", "title", "log")
    change(mission, lambda s: s["strategies"].__setitem__(2, {**{key: s["strategies"][2][key] for key in kept},
                                                              "impossible": reason}))
    (mission / "log_bezier.csv").write_text("t_s\n")
    assert run_tool("report.report", mission).returncode == 0
    page = (mission / "report.html").read_text()
    assert f"cannot drive this route: {reason}." in page
    assert len(cells(page, "total energy, J")) == 3


@sketched
def test_what_a_recorded_drive_does_not_know_is_left_out(mission):
    change(mission, lambda s: s.update(robot=None, energy_model=None, energy=None, seed=None, simulation=None))
    assert run_tool("report.report", mission).returncode == 0
    text = re.sub(r"data:image[^\"]*", "", (mission / "report.html").read_text())
    assert "<title>gao2018_table3 · Joulepath</title>" in text
    assert not any(part in text for part in ("None", "seed", "energy model", "energy of the", "real time", "Simulated"))


@pytest.mark.parametrize("edit, part", [
    (lambda s: s.pop("strategies"), "strategies"),
    (lambda s: s.update(strategies=[]), "strategies"),
    (lambda s: s.update(waypoints_m=[[0, 0], [1]]), "waypoints_m[1]"),
    (lambda s: s["strategies"][1]["segments"][0].pop("duration_s"), "duration_s"),
    (lambda s: s["strategies"][0]["segments"][2].update(measured_energy_j="many"), "measured_energy_j"),
    (lambda s: s["strategies"][0]["total"].update(duration_s=None), "duration_s"),
    (lambda s: s["strategies"][0].update(log="none.csv"), "none.csv"),
    (lambda s: s["simulation"].pop("ticks"), "ticks"),
    (lambda s: s.update(simulation={}), "ticks"),
    (lambda s: s.pop("simulation"), "simulation"),
    (lambda s: s["strategies"][0].update(title=3), "title"),
    (lambda s: s["strategies"][1].pop("forecast"), "forecast"),
    (lambda s: s["strategies"][1].update(impossible=3), "impossible"),
    (lambda s: s["strategies"][0].update(impossible="no way"), "compared with it"),
    (lambda s: s["strategies"][3].update(forecast={"energy_j": 1}), "deviation_j"),
    (lambda s: s["strategies"][3]["forecast"].update(energy_j="many"), "strategies[3].forecast"),
])
def test_garbled_summaries_are_refused(mission, edit, part):
    change(mission, edit)
    assert_one_line_error(run_tool("report.report", mission), part)
    assert not (mission / "report.html").exists()


@pytest.mark.parametrize("damage, part", [
    (lambda text: text.replace("pitch_deg", "tilt", 1), "pitch_deg"),
    (lambda text: text[: len(text) // 2], "line"),
    (lambda text: text.replace("\n0.02", "\nx", 1), "line 3"),
    (lambda text: "", "t_s"),
    (lambda text: text.split("\n", 1)[0] + "\n", "samples"),
])
def test_garbled_logs_are_refused(mission, damage, part):
    path = mission / "log_straight.csv"
    path.write_text(damage(path.read_text()))
    assert_one_line_error(run_tool("report.report", mission), "log_straight.csv", part)
    assert not (mission / "report.html").exists()


def test_missing_results_are_named(tmp_path):
    assert_one_line_error(run_tool("report.report", tmp_path), "summary.json")
    (tmp_path / "summary.json").write_bytes(b"\xff\xfe")
    assert_one_line_error(run_tool("report.report", tmp_path), "summary.json")


