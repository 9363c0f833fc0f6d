"""tools/figures.py: merging, checking, the README's table."""
import json

import pytest
from conftest import assert_one_line_error, run_tool

README = "# Title\n\nbefore\n<!-- figures -->\nold\n<!-- /figures -->\nafter\n"


def figure(name, value, unit="ms", bound=None, command="make bench"):
    return {"name": name, "value": value, "unit": unit, "bound": bound, "command": command}


@pytest.fixture
def place(tmp_path):
    """A directory with bench files of the given figures; runs the tool on it."""
    def collect(**files):
        bench = tmp_path / "bench"
        bench.mkdir(exist_ok=True)
        for name, figures in files.items():
            (bench / f"{name}.json").write_text(figures if isinstance(figures, str) else json.dumps(figures))
        readme = tmp_path / "README.md"
        if not readme.exists():
            readme.write_text(README)
        return run_tool("figures.py", "--bench", bench, "--output", tmp_path / "figures.json", "--readme", readme)
    collect.path = tmp_path
    return collect


def test_figures_are_merged_in_order_and_shown(place):
    result = place(b=[figure("late", 2, "B", {"op": "==", "value": 2})],
                   a=[figure("tick", 0.61, "µs", {"op": "<=", "value": 1}), figure("plain", 12345)])
    assert result.returncode == 0, result.stderr
    merged = json.loads((place.path / "figures.json").read_text())
    assert [f["name"] for f in merged] == ["tick", "plain", "late"]
    readme = (place.path / "README.md").read_text()
    assert readme.startswith("# Title\n\nbefore\n<!-- figures -->\n| what |")
    assert readme.endswith("\n<!-- /figures -->\nafter\n")
    assert "old" not in readme
    assert "| tick | 0.61 µs | ≤ 1 | yes | `make bench` |" in readme
    assert "| plain | 12 345 ms | – | – | `make bench` |" in readme.replace("\u202f", " ")
    assert "3 figures, 0 below the bar" in result.stdout


def test_figures_without_a_bar_are_to_be_unfolded(place):
    assert place(a=[figure("plain", 1), figure("barred", 1, bound={"op": "<=", "value": 2})]).returncode == 0
    shown, folded = (place.path / "README.md").read_text().split("<summary>1 more, without a bar</summary>")
    assert "| barred |" in shown and "| plain |" not in shown
    assert "| plain |" in folded and "| barred |" not in folded


def test_nothing_is_folded_when_all_have_a_bar(place):
    assert place(a=[figure("barred", 1, bound={"op": "<=", "value": 2})]).returncode == 0
    assert "details" not in (place.path / "README.md").read_text()


@pytest.mark.parametrize("op, value", [("<=", 0.5), (">=", 1), ("==", 0.6)])
def test_a_broken_bound_is_written_and_fails(place, op, value):
    result = place(a=[figure("tick", 0.61, "µs", {"op": op, "value": value}), figure("fine", 1)])
    assert result.returncode == 1
    assert "| **no** |" in (place.path / "README.md").read_text()
    assert "1 below the bar" in result.stdout


def test_rounding_never_hides_a_broken_bound(place):
    assert place(a=[figure("x", 1.0004, "%", {"op": "<=", "value": 1})]).returncode == 1
    assert "| 1.0004 % | ≤ 1 | **no** |" in (place.path / "README.md").read_text()


def test_a_second_run_changes_nothing(place):
    figures = [figure("a | b", 1.5, "%", {"op": "<=", "value": 2})]
    assert place(a=figures).returncode == 0
    first = (place.path / "README.md").read_text()
    assert place(a=figures).returncode == 0
    assert (place.path / "README.md").read_text() == first
    assert "a \\| b" in first


@pytest.mark.parametrize("content, part", [
    ("", "a.json"), ("{}", "list"), ("[1]", "figure 0"), ('[{"name": "x"}]', "value"),
    (json.dumps([figure("x", True)]), "value"), ('[{"name": "x", "value": NaN, "unit": "", "bound": null, '
                                                 '"command": ""}]', "finite"),
    (json.dumps([figure("x", 1, bound={"op": "<", "value": 1})]), "bound"),
    (json.dumps([figure("x", 1), figure("x", 2)]), "too"),
])
def test_garbled_benches_are_refused(place, content, part):
    assert_one_line_error(place(a=content), "a.json", part)
    assert (place.path / "README.md").read_text() == README
    assert not (place.path / "figures.json").exists()


def test_no_benches_is_an_error(place):
    assert_one_line_error(place(), "bench")


def test_a_readme_without_markers_is_refused(place):
    (place.path / "README.md").write_text("no markers\n")
    assert_one_line_error(place(a=[figure("x", 1)]), "README.md", "<!-- figures -->")
    assert not (place.path / "figures.json").exists()
