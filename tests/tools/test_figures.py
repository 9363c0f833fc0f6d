"""tools/measure: what benches measured, its store, the pages made of it; and the committed ones."""
import json
import re
from unittest import mock

import pytest
from conftest import ROOT, assert_one_line_error, run_tool
from tools.common import ToolError, read_text
from tools.measure import core_numbers, figure_pages, figure_store, figures

BAR = {"op": "<=", "value": 1}


def figure(name, value, unit="ms", bound=None, command="make figures"):
    return {"name": name, "value": value, "unit": unit, "bound": bound, "command": command}


def store(*misses, **benches):
    return {"known_misses": list(misses), "benches": benches, "tables": {}}


def miss(name, value, reason="because"):
    return {"name": name, "value": value, "reason": reason}


NUMBERS = {kind: {"row": {"Cortex-M4": 1}} for kind in core_numbers.UNITS}
TABLES = {name: {"headings": ["a"], "rows": [[name]]}
          for name in ("plan", "prices", "patrol", "pursuit", "limit_scenarios", "limit_routes", "random_robots", "intervals",
                       "logs")}


# ---- formats -------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("value, text", [(0, "0"), (12345, "12\u202f345"), (1110.262, "1\u202f110.3"), (2.5, "2.50"),
                                         (0.00123, "0.00123"), (1e-9, "1e-09"), (-2.5, "-2.50")])
def test_numbers_as_people_read_them(value, text):
    assert figure_pages.format_value(value) == text


def test_a_value_that_rounds_to_its_bar_shows_all_digits():
    assert figure_pages.measured(figure("x", 1.0004, "%", BAR)) == "1.0004 %"
    assert figure_pages.measured(figure("x", 1, "%", BAR)) == "1 %"


# ---- the store -----------------------------------------------------------------------------------------------------

def test_the_store_is_read_as_it_was_written(tmp_path):
    whole = {**store(miss("a", 2), bench=[figure("a", 2, "µs", BAR), figure("b", 0.5)]), "tables": TABLES}
    path = tmp_path / "figures.json"
    figure_store.write_store(path, whole)
    assert figure_store.read_store(path) == whole
    assert '   {"name": "b", "value": 0.5, ' in path.read_text("utf-8")


@pytest.mark.parametrize("broken, part", [
    ([], "must hold"), ({"benches": {}}, "known_misses"), ({**store(), "tables": []}, "tables by name"),
    ({**store(), "tables": {"t": {"rows": []}}}, "t: must hold headings"),
    (store(miss("a", 2, " ")), "the reason is missing"), (store({"name": "a"}), "must have name and value"),
    (store(b=[figure("a", 1)], c=[figure("a", 1)]), "'a' stands in b too"),
    (store(b=[{"name": "a"}]), "b: figure 0: value"), (store(b=[figure("a", float("nan"))]), "finite"),
    (store(b=[figure("a", 1, bound={"op": "<", "value": 1})]), "bound must be"), (store(b={}), "must be a list"),
])
def test_a_broken_store_is_refused(tmp_path, broken, part):
    path = tmp_path / "figures.json"
    path.write_text(json.dumps(broken))
    with pytest.raises(ToolError, match=re.escape(part)):
        figure_store.read_store(path)


# ---- surprises -----------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("known, value, part", [
    ([], 2, "misses its bar of ≤ 1"), ([miss("tick", 2)], 2.5, "a known miss with 2, but now 2.50 ms"),
    ([miss("tick", 2)], 1.5, "but now 1.50 ms"), ([miss("tick", 2)], 1, "no known miss any more"),
    ([miss("tock", 2)], 1, "measured no more")])
def test_surprises(known, value, part):
    (line,) = figures.surprises(store(*known, a=[figure("tick", value, bound=BAR)]))
    assert part in line


@pytest.mark.parametrize("known, value", [([], 1), ([miss("tick", 2)], 2), ([miss("tick", 2.001)], 2.0012)])
def test_what_is_met_or_known_is_no_surprise(known, value):
    assert list(figures.surprises(store(*known, a=[figure("tick", value, bound=BAR)]))) == []


# ---- pages ---------------------------------------------------------------------------------------------------------

def test_the_page_shows_every_figure_and_the_known_misses():
    whole = {**store(miss("tick", 2, "slow | old"), bench_plan=[figure("plain", 12345), figure("tick", 2, bound=BAR)]),
             "tables": TABLES}
    page = figure_pages.page(whole, NUMBERS)
    assert "| tick | 2 ms | ≤ 1 | slow \\| old |" in page.split("## Planner")[0]
    plain = page.index("| plain | 12\u202f345 ms | – | – |")
    assert page.index("| tick | 2 ms | ≤ 1 | **no** | `make figures` |") < plain
    assert all(f"| {name} |" in page for name in TABLES)


def test_a_bench_without_a_section_is_refused():
    with pytest.raises(ToolError, match="bench new: belongs to no section"):
        figure_pages.page({**store(new=[figure("a", 1)]), "tables": TABLES}, NUMBERS)


def test_marks_are_filled_in():
    whole = {**store(a=[figure("tick", 0.5, "%", BAR)]), "tables": {**TABLES, "frames": {"lines": ["x", "y"]}}}
    text = ("<!-- figure: tick -->old<!-- /figure -->, <!-- bar: tick --><!-- /bar -->\n"
            "<!-- block: frames -->\nold\n<!-- /block -->\n<!-- block: size -->\n<!-- /block -->\n")
    once = figure_pages.filled("page", text, whole, NUMBERS)
    assert "-->0.5 %<!-- /figure -->, <!-- bar: tick -->1 %<!-- /bar -->\n" in once
    assert "<!-- block: frames -->\n```\nx\ny\n```\n<!-- /block -->" in once
    assert "| row | 1 |" in once
    assert figure_pages.filled("page", once, whole, NUMBERS) == once


@pytest.mark.parametrize("text, part", [("<!-- figure: tock --><!-- /figure -->", "figure 'tock': there is no such"),
                                        ("<!-- bar: plain --><!-- /bar -->", "bar 'plain': the figure has none"),
                                        ("<!-- block: tock -->\n<!-- /block -->", "block tock: there is no such")])
def test_marks_of_nothing_are_refused(text, part):
    with pytest.raises(ToolError, match=part):
        figure_pages.filled("page", text, store(a=[figure("plain", 1)]), NUMBERS)


# ---- the command ---------------------------------------------------------------------------------------------------

@pytest.fixture
def place(tmp_path):
    """A tree with a store, a README and bench files; runs the tool in it."""
    def write(name, content):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")

    def collect(*arguments, **benches):
        for name, content in benches.items():
            write(f"bench/{name}.json", content)
        with (mock.patch.object(figures, "ROOT", tmp_path),
              mock.patch.object(figures.robot_json, "build_directory", lambda: tmp_path)):
            return run_tool("measure.figures", *(tmp_path / "bench" / name for name in arguments))

    write(figure_store.STORE, {**store(bench_plan=[figure("old", 1), figure("tick", 3)]), "tables": TABLES})
    write("README.md", "<!-- figure: tick -->3 ms<!-- /figure -->\n")
    collect.path = tmp_path
    collect.readme = lambda: (tmp_path / "README.md").read_text("utf-8")
    collect.store = lambda: figure_store.read_store(tmp_path / figure_store.STORE)
    write("bench/blocks.tables.json", TABLES)
    return collect


def test_all_that_was_measured_takes_the_place_of_the_store(place):
    result = place(bench_grid=[figure("tick", 0.5, bound=BAR)])
    assert result.returncode == 0, result.stderr
    assert place.store()["benches"] == {"bench_grid": [figure("tick", 0.5, bound=BAR)]}
    assert place.readme() == "<!-- figure: tick -->0.5 ms<!-- /figure -->\n"
    assert "| tick | 0.5 ms |" in (place.path / figure_pages.PAGE).read_text("utf-8")


def test_files_take_the_place_of_their_benches_only(place):
    assert place("bench_grid.json", bench_grid=[figure("tock", 0.5)], bus=[figure("left", 1)]).returncode == 0
    assert sorted(place.store()["benches"]) == ["bench_grid", "bench_plan"]


def test_known_misses_stay_and_changes_fail(place):
    result = place(bench_grid=[figure("tick", 2, bound=BAR)])
    assert result.returncode == 1
    assert result.stdout.splitlines()[-1] == "tick: 2 ms misses its bar of ≤ 1"
    assert place.readme() == "<!-- figure: tick -->2 ms<!-- /figure -->\n"
    known = place.store()
    known["known_misses"] = [miss("tick", 2)]
    figure_store.write_store(place.path / figure_store.STORE, known)
    assert place(bench_grid=[figure("tick", 2, bound=BAR)]).returncode == 0
    assert place.store()["known_misses"] == [miss("tick", 2)]
    assert place(bench_grid=[figure("tick", 3, bound=BAR)]).returncode == 1


@pytest.mark.parametrize("content, part", [("{", "no JSON"), ({}, "must be a list"), ([figure("tock", 1)], "'tick'")])
def test_bad_benches_change_nothing(place, content, part):
    before = place.store(), place.readme()
    assert_one_line_error(place(bench_grid=content), part)
    assert (place.store(), place.readme()) == before


def test_without_benches_it_says_so(place):
    (place.path / "bench/blocks.tables.json").unlink()
    assert_one_line_error(place(), "run the benches first")


# ---- what is committed ---------------------------------------------------------------------------------------------

@pytest.fixture(scope="module")
def committed():
    numbers = core_numbers.check_accepted(core_numbers.ACCEPTED, figure_store.read_json(core_numbers.ACCEPTED))
    return figure_store.read_store(ROOT / figure_store.STORE), numbers


def test_the_page_is_made_of_the_store(committed):
    assert read_text(ROOT / figure_pages.PAGE) == figure_pages.page(*committed), "run make pages"


@pytest.mark.parametrize("path", figure_pages.documents(ROOT), ids=lambda path: str(path.relative_to(ROOT)))
def test_figures_in_the_readmes_are_those_of_the_store(path, committed):
    text = read_text(path)
    assert text == figure_pages.filled(path, text, *committed), "run make pages"


def test_no_bar_is_newly_missed(committed):
    assert list(figures.surprises(committed[0])) == []


def test_every_section_has_content(committed):
    whole = committed[0]
    for section in figure_pages.SECTIONS:
        assert section.blocks or any(re.fullmatch(section.benches, bench) for bench in whole["benches"]), section.title


def makefiles():
    return "\n".join(read_text(path) for path in [ROOT / "Makefile", *ROOT.glob("tools/make/*")])


def test_every_bench_has_figures(committed):
    """Those in C: a bench of its own, one of the targets, or a property test at bench length."""
    benches = {re.sub(r"-(cortex|rv).*", "", name) for name in committed[0]["benches"]}
    sources = {path.stem for path in ROOT.glob("tests/bench/*.c") if re.match("bench_|target_", path.stem)}
    (properties,) = re.findall(r"^PROPERTIES *:= (.*)$", makefiles(), re.M)
    assert sources | set(properties.split()) <= benches, "a bench has no figures: run make figures"
    assert {name for name in benches if re.match("bench_|target_", name)} <= sources, "figures of a bench that is gone"


def commands(committed):
    return {name: figure["command"] for name, figure in figure_store.by_name("", committed[0]).items()}


def test_every_bench_command_named_measures_something(committed):
    known = set(commands(committed).values())
    for path in figure_pages.documents(ROOT):
        for command in re.findall(r"`(make bench-[a-z]+|build/bench/\w+)`", read_text(path)):
            assert command in known, f"{path}: {command}"


def test_the_front_page_names_the_commands_of_its_figures(committed):
    rows = re.findall(r"^\| .*<!-- figure: (.+?) -->.*\| `(make [a-z-]+)` \|$", read_text(ROOT / "README.md"), re.M)
    assert len(rows) >= 5
    for name, command in rows:
        assert commands(committed)[name].startswith(command), name


def test_sizes_are_those_that_are_accepted(committed):
    whole, numbers = committed
    for bench in ("size", "stack"):
        for shown in whole["benches"][bench]:
            core, _, row = re.match(r"([^,:]+)(, -Os)?: (.*)", shown["name"]).groups()
            row = re.sub(r"worst-case stack of (\w+)\(\)", r"\1", row)
            assert numbers[bench][row][core] == shown["value"], shown["name"]
