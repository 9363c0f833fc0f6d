"""tools/measure/bench_plan.py: what bench_plan measured becomes tables, and bad files one line."""
import json

import pytest
from conftest import assert_one_line_error, run_tool

from tools.measure.bench_plan import map_table
from tools.measure.figure_store import check_tables


def row(kib, answer="within bound", ratio=1.25, name="scene 1"):
    return {"map": name, "width": 300, "height": 300, "block_kib": kib, "answer": answer, "cost_j": 100.0,
            "left_j": 0.0, "optimum_j": 80.0, "ratio": ratio, "bound": 1.5, "states": 10, "states_max": 1234,
            "expansions": 42, "first_ms": 1.0, "total_ms": 2.0, "honest": True}


def rows():
    return {"scenes": [row(64), row(64, "optimal", 1.0), row(64, "partial", 0.4), row(8192, "optimal", 1.0)],
            "maps": [row(64, "within bound", None, "depot"), row(64, "unreachable", None, "depot")],
            "curve": [{"price_j_per_m": 0.0, "saved_percent": 31.4, "longer_percent": 8.0}]}


def bench_plan(tmp_path, text):
    """What it says, and its tables: None when it wrote none."""
    (tmp_path / "rows.json").write_text(text, encoding="utf-8")
    tables = tmp_path / "tables.json"
    result = run_tool("measure.bench_plan", tmp_path / "rows.json", tables)
    return result, json.loads(tables.read_text(encoding="utf-8")) if tables.exists() else None


def test_tables_hold_the_scenes_and_the_curve(tmp_path):
    result, tables = bench_plan(tmp_path, json.dumps(rows()))
    assert result.returncode == 0, result.stderr
    check_tables("tables.json", tables)
    assert tables["plan"]["rows"] == [["64", "1234", "2 of 3", "1", "1.125", "1.250", "1.50", "42"],
                                      ["8192", "1234", "1 of 1", "1", "1.000", "1.000", "1.50", "42"]]
    assert tables["prices"]["rows"] == [["0", "31.4", "8.0"]]


def test_maps_of_others_are_shown(tmp_path):
    assert list(map_table(rows()["maps"])) == [("depot", "300 × 300", "64", "1 of 2", "0", "1", "-")]
    result, _ = bench_plan(tmp_path, json.dumps(rows()))
    assert "\ndepot  " in result.stdout


def test_no_route_at_all(tmp_path):
    data = rows()
    data["scenes"] = [row(64, "partial", 0.4)]
    result, tables = bench_plan(tmp_path, json.dumps(data))
    assert result.returncode == 0, result.stderr
    assert tables["plan"]["rows"] == [["64", "1234", "0 of 1", "0", "-", "-", "-", "42"]]


@pytest.mark.parametrize("text", ["", "{}", "[1]"])
def test_bad_input_is_one_line(tmp_path, text):
    result, tables = bench_plan(tmp_path, text)
    assert_one_line_error(result, "rows.json")
    assert tables is None
