"""coverage_report.py: a summary by gcovr becomes a table, figures, and an error for each file with a gap."""
import json

import pytest
from conftest import assert_one_line_error, run_tool


def counts(lines, branches):
    return {"line_total": lines[0], "line_covered": lines[1], "branch_total": branches[0],
            "branch_covered": branches[1]}


@pytest.fixture(name="report")
def fixture_report(tmp_path):
    def report(summary):
        (tmp_path / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
        result = run_tool("measure.coverage_report", tmp_path / "summary.json", tmp_path / "figures.json")
        return result, json.loads((tmp_path / "figures.json").read_text(encoding="utf-8"))

    return report


def test_all_is_covered(report):
    files = [{"filename": "src/a.c", **counts((10, 10), (4, 4))}, {"filename": "src/b.h", **counts((2, 2), (0, 0))}]
    result, figures = report({"files": files, **counts((12, 12), (4, 4))})
    assert result.stderr == ""
    assert [line.split() for line in result.stdout.splitlines()[1:]] == [
        ["src/a.c", "10", "100.00", "4", "100.00"], ["src/b.h", "2", "100.00", "0", "100.00"],
        ["all", "12", "100.00", "4", "100.00"]]
    assert [figure["value"] for figure in figures] == [100, 100]
    assert all(figure["bound"] == {"op": "==", "value": 100} for figure in figures)


def test_one_branch_is_missing(report):
    files = [{"filename": "src/a.c", **counts((20000, 20000), (20000, 19999))}]
    result, figures = report({"files": files, **counts((20000, 20000), (20000, 19999))})
    assert result.stderr == "src/a.c:1: error: not tested: 0 lines, 1 branches\n"
    assert figures[0]["value"] == 100 and figures[1]["value"] < 100


def test_summary_that_is_not_there(tmp_path):
    result = run_tool("measure.coverage_report", tmp_path / "none.json", tmp_path / "figures.json")
    assert_one_line_error(result, "none.json")
    assert not (tmp_path / "figures.json").exists()
