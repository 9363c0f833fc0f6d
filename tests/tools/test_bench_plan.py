"""tools/bench_plan.py: what bench_plan measured becomes tables, and bad files one line."""
import json
import subprocess
import sys

import pytest
from conftest import ROOT

README = "before\n<!-- plan -->\nold\n<!-- /plan -->\nafter\n"


def row(kib, answer="within bound", ratio=1.25, name="scene 1"):
    return {"map": name, "width": 300, "height": 300, "block_kib": kib, "answer": answer, "cost_j": 100.0,
            "left_j": 0.0, "optimum_j": 80.0, "ratio": ratio, "bound": 1.5, "states": 10, "states_max": 1234,
            "expansions": 42, "first_ms": 1.0, "total_ms": 2.0, "honest": True}


def rows():
    return {"scenes": [row(64), row(64, "optimal", 1.0), row(64, "partial", 0.4), row(8192, "optimal", 1.0)],
            "maps": [row(64, "within bound", None, "depot"), row(64, "unreachable", None, "depot")],
            "curve": [{"price_j_per_m": 0.0, "saved_percent": 31.4, "longer_percent": 8.0}]}


def bench_plan(tmp_path, text, readme=README):
    (tmp_path / "rows.json").write_text(text, encoding="utf-8")
    (tmp_path / "README.md").write_text(readme, encoding="utf-8")
    command = [sys.executable, str(ROOT / "tools" / "bench_plan.py"), str(tmp_path / "rows.json"), "--readme",
               str(tmp_path / "README.md")]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    return result, (tmp_path / "README.md").read_text(encoding="utf-8")


def test_readme_holds_the_scenes_and_the_curve(tmp_path):
    result, readme = bench_plan(tmp_path, json.dumps(rows()))
    assert result.returncode == 0, result.stderr
    lines = readme.splitlines()
    assert lines[0] == "before" and lines[-1] == "after" and "old" not in readme
    assert "| 64 | 1234 | 2 of 3 | 1 | 1.125 | 1.250 | 1.50 | 42 |" in lines
    assert "| 8192 | 1234 | 1 of 1 | 1 | 1.000 | 1.000 | 1.50 | 42 |" in lines
    assert "| 0 | 31.4 | 8.0 |" in lines
    assert "depot" not in readme


def test_maps_of_others_are_shown(tmp_path):
    result, _ = bench_plan(tmp_path, json.dumps(rows()))
    line = next(line for line in result.stdout.splitlines() if line.startswith("depot"))
    assert line.split() == ["depot", "300", "×", "300", "64", "1", "of", "2", "0", "1", "-"]


def test_no_route_at_all(tmp_path):
    data = rows()
    data["scenes"] = [row(64, "partial", 0.4)]
    result, readme = bench_plan(tmp_path, json.dumps(data))
    assert result.returncode == 0, result.stderr
    assert "| 64 | 1234 | 0 of 1 | 0 | - | - | - | 42 |" in readme.splitlines()


@pytest.mark.parametrize("text, readme, word", [
    ("", README, "rows.json"),
    ("{}", README, "rows.json"),
    ("[1]", README, "rows.json"),
    (json.dumps(rows()), "no marks\n", "<!-- plan -->"),
])
def test_bad_input_is_one_line(tmp_path, text, readme, word):
    result, kept = bench_plan(tmp_path, text, readme)
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1 and word in result.stderr
    assert kept == readme
