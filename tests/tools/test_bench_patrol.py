"""tools/measure/bench_patrol.py: what the patrol robot's benches measured becomes tables, and bad files one line."""
import json

import pytest
from conftest import assert_one_line_error, run_tool

from tools.measure.figure_store import check_tables

def scene(method, cleanly, time=12.34, slip=False):
    return {"scene": "corridor", "slip": slip, "method": method, "drives": 100, "arrived": cleanly + 1,
            "cleanly": cleanly, "collided": 100 - cleanly, "backwards": 7, "time_s": time, "energy_j": time and 456.7,
            "clearance_min_m": 0.0321}


def scenes():
    return [scene("plain", 60), scene("improved", 100), scene("pursuit", 0, None),
            scene("improved", 30, slip=True), scene("plain", 20, slip=True), scene("pursuit", 10, slip=True)]


def courses():
    return [{"course": name, "speed_m_s": speed, "drives": 40, "arrived": 40, "largest_m": 0.0412, "rms_m": 0.0056}
            for name in ("paths on ice", "paths of glass") for speed in (0.5, 1.0)]


def bench_patrol(folder, scene_rows, course_rows):
    """What it says, and its tables: None when it wrote none."""
    for name, content in (("scenes.json", scene_rows), ("courses.json", course_rows)):
        (folder / name).write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    tables = folder / "tables.json"
    result = run_tool("measure.bench_patrol", folder / "scenes.json", folder / "courses.json", tables)
    return result, json.loads(tables.read_text(encoding="utf-8")) if tables.exists() else None


def test_it_writes_both_tables(tmp_path):
    result, tables = bench_patrol(tmp_path, scenes(), courses())
    assert result.returncode == 0, result.stderr
    check_tables("tables.json", tables)
    assert tables["patrol"]["rows"][0] == ["corridor", "100", "101 / 61 / 1", "100 / 60 / 0", "0 / 40 / 100",
                                           "12.3 / 12.3 / –", "457 / 457 / –", "3.2 / 3.2 / 3.2"]
    assert tables["patrol"]["rows"][1][:4] == ["corridor, slippery", "100", "31 / 21 / 11", "30 / 20 / 10"]
    assert tables["pursuit"]["headings"] == ["course", "paths", "0.5 m/s", "1 m/s"]
    assert tables["pursuit"]["rows"][1] == ["paths of glass", "40", "4.1 (0.6)", "4.1 (0.6)"]


def test_terminal_shows_the_same_numbers(tmp_path):
    result, _ = bench_patrol(tmp_path, scenes(), courses())
    assert "100 / 60 / 0" in result.stdout and "4.1 (0.6)" in result.stdout


def without(rows, key):
    return [{name: value for name, value in row.items() if name != key} for row in rows]


@pytest.mark.parametrize("scene_rows, course_rows, word", [
    ("", courses(), "scenes.json"),
    ([], courses(), "scenes.json"),
    ("[1]", courses(), "scenes.json"),
    (without(scenes(), "cleanly"), courses(), "scenes.json"),
    (scenes()[:2], courses(), "corridor"),
    (scenes(), "{", "courses.json"),
    (scenes(), without(courses(), "rms_m"), "courses.json"),
])
def test_bad_rows_are_one_line(tmp_path, scene_rows, course_rows, word):
    result, tables = bench_patrol(tmp_path, scene_rows, course_rows)
    assert_one_line_error(result, word)
    assert tables is None
