"""jp-route: plans of CSV and JSON routes, models, energies, receding horizon, table, bad input."""
import json
import math
import os
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT, assert_one_line_error

JP_ROUTE = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve() / "bin" / "jp-route"
PAPER = [(0, 0), (10, 10), (20, 15), (25, 25), (15, 30)]
SHORT = [(0, 0), (1.2, 0.4), (2.0, 1.6), (3.9, 1.4), (4.4, 2.6), (3.2, 3.1), (3.6, 4.5), (5.3, 4.6), (6.0, 3.2)]
OLD = "from an earlier run\n"


def route(*arguments, robot="gao2018"):
    path = ROOT / "sim" / "robots" / f"{robot}.cfg"
    return subprocess.run([JP_ROUTE, "--robot", path, *map(str, arguments)], capture_output=True, text=True, check=False,
                          timeout=600)


def write_csv(path, points, heading=None):
    heads = "x_m,y_m" + ("" if heading is None else ",heading_deg")
    tail = "" if heading is None else f",{heading}"
    path.write_text("\n".join([heads, *(f"{x},{y}{tail}" for x, y in points)]) + "\n")
    return path


def write_json(path, points, **more):
    path.write_text(json.dumps({"points_m": points, **more}))
    return path


def plans(tmp_path, *arguments, robot="gao2018"):
    """What a run writes, a plan a line."""
    output = tmp_path / "plans.json"
    result = route(*arguments, "--json", output, robot=robot)
    assert (result.returncode, result.stderr) == (0, "")
    return [json.loads(line) for line in output.read_text().splitlines()]


@pytest.fixture
def paper(tmp_path):
    return write_csv(tmp_path / "paper.csv", PAPER)


def landings(points, plan, heading=0.0):
    """Where the segments end when each begins at the last point."""
    for (x, y), segment in zip(points, plan):
        half = segment["arc_rad"] / 2
        chord = segment["length_m"] * (math.sin(half) / half if half else 1)
        direction = heading + segment["turn_rad"] + half
        yield x + chord * math.cos(direction), y + chord * math.sin(direction)
        heading = direction + half


def total(plan):
    return math.fsum(segment["energy_j"] for segment in plan)


# ---- Plans ---------------------------------------------------------------------------------------------------------

def test_the_papers_four_segments(paper, tmp_path):
    plan, = plans(tmp_path, paper, "--model", "published")
    assert plan["joint_j"] == pytest.approx(1110.26, abs=0.02)
    assert plan["greedy_j"] == pytest.approx(1114.21, abs=0.02)
    assert plan["gain_percent"] == pytest.approx(100 * (1 - plan["joint_j"] / plan["greedy_j"]))
    assert plan["settled"] and plan["model"] == "published" and plan["legs"] == 64
    for name in ("greedy", "joint"):
        assert total(plan[name]) == pytest.approx(plan[f"{name}_j"])
        for landing, point in zip(landings(PAPER, plan[name]), PAPER[1:]):
            assert landing == pytest.approx(point, abs=1e-3)


def test_segments_are_within_the_limits(tmp_path):
    plan, = plans(tmp_path, write_json(tmp_path / "short.json", SHORT))
    assert not plan["settled"]
    for segment in plan["joint"]:
        assert 0.5 <= segment["duration_s"] <= 600 and 0 <= segment["speed_m_s"] <= 1
        assert abs(segment["turn_rate_rad_s"]) <= 0.35 and abs(segment["turn_rad"]) <= math.radians(80) + 1e-7
        assert segment["speed_m_s"] * segment["duration_s"] == pytest.approx(segment["length_m"], abs=1e-4)
    assert any(segment["duration_s"] < plan["parameters"]["settling_time"] for segment in plan["joint"])
    assert plan["gain_percent"] > 10


def test_csv_and_json_are_the_same_route(tmp_path):
    files = [write_csv(tmp_path / "a.csv", PAPER, heading=30), write_json(tmp_path / "b.json", PAPER, heading_deg=30)]
    one, other = plans(tmp_path, *files)
    assert (one["route"], other["route"]) == tuple(map(str, files))
    assert one["joint"] == other["joint"] and one["greedy"] == other["greedy"]
    for landing, point in zip(landings(PAPER, one["joint"], math.radians(30)), PAPER[1:]):
        assert landing == pytest.approx(point, abs=1e-3)


def test_other_columns_are_left_alone(tmp_path):
    named = tmp_path / "plan.csv"
    named.write_text("z_m, y_m ,name,x_m\n1,0,a,0\n\n2, 10 ,b,10\r\n")
    plan, plain = plans(tmp_path, named, write_json(tmp_path / "plain.json", PAPER[:2]))
    assert plan["joint"] == plain["joint"]


@pytest.mark.parametrize("text", [
    "\ufeffx_m,y_m\r\n0,0\r\n10,10\r\n",
    '"x_m","y_m"\n"0","0"\n"10","10"\n',
    '\ufeff"note, ""quoted""", "x_m" ,"y_m"\n"a, ""b""",0,0\n"",10,10\n',
    "x_m,y_m,heading_deg\n0,0,0\n10,10,\n",
    "x_m,y_m,heading_deg\n0,0,\n10,10\n",
])
def test_csv_of_spreadsheets(tmp_path, text):
    path = tmp_path / "route.csv"
    path.write_text(text, newline="")
    plan, plain = plans(tmp_path, path, write_json(tmp_path / "plain.json", PAPER[:2]))
    assert plan["joint"] == plain["joint"]


def test_routes_are_planned_from_where_they_start(tmp_path):
    moved = [(x + 100, y - 50) for x, y in PAPER]
    one, other = plans(tmp_path, write_json(tmp_path / "a.json", PAPER), write_json(tmp_path / "b.json", moved))
    assert one["joint"] == other["joint"]


def test_a_model_from_a_file(paper, tmp_path):
    published, = plans(tmp_path, paper, "--model", "published")
    model = tmp_path / "model.json"
    model.write_text(json.dumps(published["parameters"]))
    same, = plans(tmp_path, paper, "--model", model)
    assert same["joint"] == published["joint"] and same["parameters"] == published["parameters"]
    # The steady voltages that b implies: 2 cv²/Rm = b1, 2 cw²/Rm = b2.
    cv, cw = (math.sqrt(b * published["parameters"]["motor_resistance"] / 2) for b in published["parameters"]["b"])
    model.write_text(json.dumps({**published["parameters"], "voltage_per_speed": cv, "voltage_per_turn_rate": cw}))
    changed, = plans(tmp_path, paper, "--model", model)
    assert changed["joint_j"] == pytest.approx(1110.12, abs=0.02)


def test_energy_of_the_battery(tmp_path):
    points = write_json(tmp_path / "short.json", SHORT)
    motor, = plans(tmp_path, points, robot="courier24")
    battery, = plans(tmp_path, points, "--energy", "battery", robot="courier24")
    assert (motor["energy"], battery["energy"]) == ("motor", "battery")
    assert motor["parameters"] != battery["parameters"] and battery["joint_j"] < battery["greedy_j"]


def test_settled_segments_last_longer(tmp_path):
    points = write_json(tmp_path / "short.json", SHORT)
    free, = plans(tmp_path, points)
    settled, = plans(tmp_path, points, "--settled")
    assert settled["settled"]
    least = settled["parameters"]["settling_time"]
    assert all(segment["duration_s"] >= least for segment in settled["joint"])
    assert free["joint_j"] < settled["joint_j"]


def test_receding_horizon(tmp_path):
    points = SHORT + [(x + 7, y + 3) for x, y in SHORT]
    path = write_json(tmp_path / "long.json", points)
    whole, = plans(tmp_path, path, "--settled")
    short, = plans(tmp_path, path, "--settled", "--legs", 4)
    single, = plans(tmp_path, path, "--settled", "--legs", 1)
    assert (whole["legs"], short["legs"]) == (64, 4)
    assert len(short["joint"]) == len(points) - 1
    assert max(whole["joint_j"], short["joint_j"]) < 0.9 * single["joint_j"]
    assert single["joint_j"] == pytest.approx(single["greedy_j"], rel=1e-3)
    for landing, point in zip(landings(points, short["joint"]), points[1:]):
        assert landing == pytest.approx(point, abs=5e-3)


def test_more_targets_than_legs(tmp_path):
    points = [(1.5 * i, 0.5 * (i % 3)) for i in range(100)]
    plan, = plans(tmp_path, write_json(tmp_path / "long.json", points))
    assert len(plan["joint"]) == len(plan["greedy"]) == 99 and plan["joint_j"] < plan["greedy_j"]


# ---- Table ---------------------------------------------------------------------------------------------------------

def test_table(paper, tmp_path):
    plan, = plans(tmp_path, paper, "--settled")
    result = route(paper, "--settled")
    assert (result.returncode, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    assert lines[0] == str(paper)
    assert lines[1].split() == ["greedy", "joint"]
    assert lines[2].split() == ["segment"] + 2 * ["T", "s", "v", "m/s", "w", "rad/s", "arc", "deg", "turn", "deg", "E",
                                                  "J"]
    for number, line in enumerate(lines[3:7]):
        cells = list(map(float, line.split()))
        assert cells[0] == number + 1
        for first, name in ((1, "greedy"), (7, "joint")):
            segment = plan[name][number]
            assert cells[first:first + 6] == pytest.approx([
                segment["duration_s"], segment["speed_m_s"], segment["turn_rate_rad_s"],
                math.degrees(segment["arc_rad"]), math.degrees(segment["turn_rad"]), segment["energy_j"]], abs=6e-3)
    sums = lines[7].split()
    assert sums[0] == "sum" and [float(sums[2]), float(sums[4])] == pytest.approx([plan["greedy_j"], plan["joint_j"]],
                                                                                  abs=1e-3)
    assert lines[8] == f"gain {plan['gain_percent']:.3f} %"
    assert len({len(line) for line in lines[1:8]}) == 1


def test_json_instead_of_the_table(paper, tmp_path):
    result = route(paper, "--json=-")
    assert [json.loads(line) for line in result.stdout.splitlines()] == plans(tmp_path, paper)


def test_equal_runs_give_equal_bytes(paper):
    assert route(paper).stdout == route(paper).stdout


# ---- Bad input -----------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("text, parts", [
    ("", ("empty",)),
    ("x_m\n1\n", ("line 1", "y_m")),
    ("x_m,y_m\n0,0\n", ("1 points",)),
    ("x_m,y_m\n0,0\n1,a\n", ("line 3", "'a'")),
    ("x_m,y_m\n0,0\n1\n", ("line 3", "30000")),
    ("x_m,y_m\n0,0\n1,\n", ("line 3", "30000")),
    ('x_m,y_m\n0,0\n1,"2\n', ("line 3", "not a number")),
    ("x_m,y_m,heading_deg\n0,0,0\n1,0,x\n", ("line 3", "'x'")),
    ("x_m,y_m\n0,0\n40000,0\n", ("line 3", "30000")),
    ("x_m,y_m\n0,0\nnan,0\n", ("line 3",)),
    ("x_m,y_m,heading_deg\n0,0,400\n1,0,0\n", ("heading_deg",)),
    ("x_m,y_m\n0,0\n1,0\n1,0\n", ("target 2", "coincides")),
    ("x_m,y_m\n0,0\n600,0\n", ("target 1", "512 m")),
    ("x_m,y_m\n0,0\n" + "1,1\n" * 5000, ("4096 targets",)),
])
def test_bad_csv(text, parts, tmp_path):
    path = tmp_path / "route.csv"
    path.write_text(text)
    assert_one_line_error(route(path), "route.csv", *parts)


@pytest.mark.parametrize("text, parts", [
    ("", ("line 1",)),
    ("[]", ("points_m",)),
    ("{}", ("points_m",)),
    ('{"points_m": 3}', ("0 points",)),
    ('{"points_m": [[0, 0], [1, 2, 3]]}', ("points_m[1]", "[x, y]")),
    ('{"points_m": [[0, 0], [1, "a"]]}', ("points_m[1]",)),
    ('{"points_m": [[0, 0], [1, 1e9]]}', ("points_m[1]", "30000")),
    ('{"points_m": [[0, 0], [1, 1]], "heading_deg": 1000}', ("heading_deg",)),
    ('{"points_m": [[0, 0], [1, 1]], "speed": 1}', ("speed",)),
])
def test_bad_json(text, parts, tmp_path):
    path = tmp_path / "route.json"
    path.write_text(text)
    assert_one_line_error(route(path), "route.json", *parts)


def test_energy_beyond_its_format(paper, tmp_path):
    published, = plans(tmp_path, paper, "--model", "published")
    model = tmp_path / "model.json"
    model.write_text(json.dumps({**published["parameters"], "b": [4096, 4096]}))
    path = write_json(tmp_path / "far.json", [(0, 0), (1, 0), (1, -508)])
    assert_one_line_error(route(path, "--model", model), "far.json", "target 2", "format")


@pytest.mark.parametrize("change, parts", [
    ({"a": [1, 2]}, ("a", "13 numbers")),
    ({"a": ["x"] * 13}, ("a:", "numbers")),
    ({"b": [1]}, ("b", "2 numbers")),
    ({"b": [-1, 1]}, ("b", "range")),
    ({"motor_resistance": 0}, ("motor_resistance",)),
    ({"settling_time": 1e9}, ("settling_time",)),
    ({"electronics_power": "six"}, ("electronics_power",)),
    ({"colour": 1}, ("colour",)),
    ({"a": [-4096] + 12 * [0]}, ("paper.csv", "not physical")),
])
def test_bad_models(change, parts, paper, tmp_path):
    published, = plans(tmp_path, paper, "--model", "published")
    path = tmp_path / "model.json"
    path.write_text(json.dumps({**published["parameters"], **change}))
    assert_one_line_error(route(paper, "--model", path), *parts)


@pytest.mark.parametrize("arguments, part", [
    (("--model", "none.json"), "none.json"),
    (("--energy", "heat"), "motor or battery"),
    (("--energy", "battery", "--model", "published"), "identified"),
    (("--legs", "0"), "from 1 to 64"),
    (("--legs", "65"), "from 1 to 64"),
    (("--legs", "x"), "from 1 to 64"),
    (("none.csv",), "none.csv"),
])
def test_bad_options(arguments, part, paper):
    assert_one_line_error(route(paper, *arguments), part)


def test_route_is_missing():
    assert_one_line_error(route(), "at least one route")


def test_robot_without_a_controller(paper):
    assert_one_line_error(route(paper, robot="zhang2018"), "zhang2018")


def test_bad_route_leaves_the_old_output(paper, tmp_path):
    output = tmp_path / "plans.json"
    output.write_text(OLD)
    assert_one_line_error(route(paper, "none.csv", "--json", output), "none.csv")
    assert output.read_text() == OLD and sorted(path.name for path in tmp_path.iterdir()) == ["paper.csv", "plans.json"]


def test_output_that_cannot_be_written(paper, tmp_path):
    assert_one_line_error(route(paper, "--json", tmp_path / "none" / "plans.json"), "none/plans.json")
