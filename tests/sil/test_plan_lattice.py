"""jp-plan --lattice: the built-in lattices from files plan alike, lattices of SBPL and Nav2 without a compiler."""
import json
import math
import subprocess
import sys
from types import SimpleNamespace

import pytest
from conftest import LIMIT, ROOT, assert_one_line_error
from test_plan import (BALANCER, ROVER, TASK, hill, names_in, places, plan, planned, room, rows_of, without_times,
                       write_map)

from tools.design import import_map

CELL = 0.1  # of the imported lattices
STEPS = [(1, 0), (2, 1), (1, 1), (1, 2), (0, 1), (-1, 2), (-1, 1), (-2, 1), (-1, 0), (-2, -1), (-1, -1), (-1, -2),
         (0, -1), (1, -2), (1, -1), (2, -1)]


def run_tool(name, *arguments):
    command = [sys.executable, "-m", f"tools.design.{name}", *arguments]
    return subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, timeout=LIMIT, cwd=ROOT)


def make(robot, path, *options):
    return run_tool("lattice", robot, "--json", path, *options)


def make_lattice(path, robot, *options):
    result = make(robot, path, *options)
    assert result.returncode == 0, result.stderr
    return path


@pytest.fixture(scope="module")
def rover_lattice(tmp_path_factory):
    return make_lattice(tmp_path_factory.mktemp("lattice") / "rover.json", ROVER)


def mprim_text():
    """Steps ahead and back and turns in place, as SBPL's scripts write them."""
    motions = [(start, (n * x, n * y), start) for start, (x, y) in enumerate(STEPS) for n in (1, 3, -1)]
    motions += [(start, (0, 0), start + turn) for start in range(16) for turn in (1, -1)]
    lines = [f"resolution_m: {CELL:.6f}", "numberofangles: 16", f"totalnumberofprimitives: {len(motions)}"]
    for start, (x, y), end in sorted(motions, key=lambda motion: motion[0]):
        lines += ["primID: 0", f"startangle_c: {start}", f"endpose_c: {x} {y} {end % 16}",
                  "additionalactioncostmult: 1", "intermediateposes: 10"]
        lines += [f"{x * CELL * i / 9:.4f} {y * CELL * i / 9:.4f} {(start + (end - start) * i / 9) * math.pi / 8:.4f}"
                  for i in range(10)]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("robot", [ROVER, BALANCER])
def test_a_built_in_lattice_from_a_file_plans_alike(tmp_path, robot):
    """Bit for bit: routes, answers, expansions and what the balancer's drive took."""
    lattice = make_lattice(tmp_path / "lattice.json", robot)
    path = write_map(tmp_path / "hills.json", room(), elevation=hill(60, 40))
    planned(path, tmp_path / "built_in", *TASK, robot=robot)
    _, table = planned(path, tmp_path / "file", *TASK, "--lattice", lattice, robot=robot)
    assert f"lattice: 144 primitives, {lattice}" in table
    for name in names_in(tmp_path / "built_in"):
        expected = without_times(tmp_path / "built_in" / name)
        if name == "summary.json":
            expected = expected.replace('"lattice_file": null', f'"lattice_file": "{lattice}"')
        assert without_times(tmp_path / "file" / name) == expected, name


def test_a_lattice_of_sbpl_plans_on_cells_of_its_own(tmp_path):
    (tmp_path / "some.mprim").write_text(mprim_text())
    lattice = make_lattice(tmp_path / "some.json", "zhang2018", "--import", tmp_path / "some.mprim")
    path = write_map(tmp_path / "level.json", room(120, 80, [(50, 0, 4, 56)]), resolution=CELL)
    summary, _ = planned(path, tmp_path / "out", *places("2,4,0", "10,4"), "--lattice", lattice)
    cells = json.loads(path.read_text())["rows"][::-1]
    for route in summary["routes"]:
        assert route["answer"] == "optimal"
        rows = rows_of(tmp_path / "out" / route["file"])
        assert all(cells[int(row["y_m"] / CELL)][int(row["x_m"] / CELL)] == "." for row in rows)
        assert all(abs(math.remainder(row["heading_deg"], 22.5)) < 0.01 for row in rows)


def test_a_lattice_of_nav2_plans(tmp_path):
    headings = [math.atan2(y, x) % (2 * math.pi) for x, y in STEPS]
    primitives = [{"start_angle_index": k, "end_angle_index": k, "poses": [[x * CELL, y * CELL, headings[k]]]}
                  for k, (x, y) in enumerate(STEPS)]
    primitives += [{"start_angle_index": k, "end_angle_index": (k + turn) % 16,
                    "poses": [[0, 0, headings[k]], [0, 0, headings[(k + turn) % 16]]]}
                   for k in range(16) for turn in (1, -1)]
    about = {"grid_resolution": CELL, "heading_angles": headings}
    (tmp_path / "nav2.json").write_text(json.dumps({"lattice_metadata": about, "primitives": primitives}))
    lattice = make_lattice(tmp_path / "out.json", ROVER, "--import", tmp_path / "nav2.json")
    path = write_map(tmp_path / "level.json", room(120, 80), resolution=CELL)
    summary, table = planned(path, tmp_path / "out", *places("2,4,0", "10,4"), "--lattice", lattice)
    assert summary["routes"][1]["length_m"] == pytest.approx(8)
    assert "lattice: 48 primitives" in table


def test_an_environment_of_sbpl_with_its_lattice_and_its_task(tmp_path):
    """Start and end as the import prints them; the wall with its gap stands where the first row is y = 0."""
    rows = [["0"] * 60 for _ in range(40)]
    for y in range(40):
        rows[y][30] = "0" if 10 <= y < 22 else "254"
    (tmp_path / "env.cfg").write_text("\n".join([
        "discretization(cells): 60 40", "obsthresh: 254", f"cellsize(meters): {CELL}", "start(meters,rads): 1.05 3.05 0",
        "end(meters,rads): 5.05 3.05 0", "environment:", *map(" ".join, rows)]) + "\n")
    (tmp_path / "some.mprim").write_text(mprim_text())
    lattice = make_lattice(tmp_path / "lattice.json", "zhang2018", "--import", tmp_path / "some.mprim")
    result = run_tool("import_map", tmp_path / "env.cfg", tmp_path / "map.json")
    assert result.returncode == 0, result.stderr
    task = import_map.read_sbpl(tmp_path / "env.cfg", SimpleNamespace(cell_size=CELL)).task.split()
    assert f"its task for jp-plan: {' '.join(task)}\n" in result.stdout
    assert task == places("1.05,3.05,0", "5.05,3.05,0")
    result = plan(tmp_path / "map.json", tmp_path / "out", *task, "--lattice", lattice)
    assert result.returncode == 0 or "TOUCHED AN OBSTACLE" in result.stdout  # it sweeps no margin
    for name in ("energy_route.csv", "distance_route.csv"):
        route = rows_of(tmp_path / "out" / name)
        assert (route[-1]["x_m"], route[-1]["y_m"], route[-1]["heading_deg"]) == pytest.approx((5.05, 3.05, 0), abs=0.01)
        assert all(1 < row["y_m"] < 2.2 for row in route if 2.7 < row["x_m"] < 3.4)


def test_costs_of_cells_lead_round_them(tmp_path):
    """The direct way is dear; what a route takes is its energy all the same."""
    data = json.loads(write_map(tmp_path / "plain.json", room()).read_text())
    data |= {"cost_shift": 4, "cost": [[255 if 20 <= x < 40 and 8 <= y < 32 else 0 for x in range(60)]
                                       for y in range(40)]}
    (tmp_path / "dear.json").write_text(json.dumps(data))
    plain, table = planned(tmp_path / "plain.json", tmp_path / "out", *TASK)
    assert "costs" not in table and not plain["map"]["has_costs"]
    straight = plain["routes"][0]
    dear, table = planned(tmp_path / "dear.json", tmp_path / "out", *TASK)
    assert "whose costs count in the choice of routes" in table and dear["map"]["has_costs"]
    for route in dear["routes"]:
        rows = rows_of(tmp_path / "out" / route["file"])
        assert not any(20 <= row["x_m"] / 0.2 < 40 and 8 <= 39 - row["y_m"] // 0.2 < 32 for row in rows)
        assert 1.05 * straight["length_m"] < route["length_m"] < 2 * straight["length_m"]
        assert 1.05 * straight["energy_j"] < route["energy_j"] < 3 * straight["energy_j"]


# ---- wrong input ---------------------------------------------------------------------------------------------------

@pytest.fixture
def level(tmp_path):
    return write_map(tmp_path / "level.json", room())


def expect_refused(level, tmp_path, lattice, *parts, robot=ROVER):
    assert_one_line_error(plan(level, tmp_path / "out", *TASK, "--lattice", lattice, robot=robot), *parts)
    assert not (tmp_path / "out").exists()


def test_lattice_of_another_robot(level, tmp_path, rover_lattice):
    expect_refused(level, tmp_path, rover_lattice, rover_lattice, "zhang2018", "gao2018", robot=BALANCER)


def test_files_of_others_say_what_makes_a_lattice_of_them(level, tmp_path):
    (tmp_path / "some.mprim").write_text(mprim_text())
    for path in (tmp_path / "some.mprim", level):
        expect_refused(level, tmp_path, path, path, "python -m tools.design.lattice", "--import", "--json")


def test_cells_of_another_size(tmp_path, rover_lattice):
    path = write_map(tmp_path / "fine.json", room(), resolution=0.05)
    expect_refused(path, tmp_path, rover_lattice, path, "0.05 m", "--resolution 0.2")


def test_files_that_are_absent_or_damaged(level, tmp_path, rover_lattice):
    expect_refused(level, tmp_path, tmp_path / "none.json", "none.json", "No such file")
    text = rover_lattice.read_text()
    for wrong in (text[:len(text) // 2], text.replace('"core": [[', '"core": [[9', 1),
                  text.replace("[1, 0,", "[1, 7,")):
        (tmp_path / "wrong.json").write_text(wrong)
        expect_refused(level, tmp_path, tmp_path / "wrong.json", "wrong.json", "tools.design.lattice")


def test_a_source_is_not_written_over(tmp_path):
    (tmp_path / "some.mprim").write_text(mprim_text())
    result = make("zhang2018", tmp_path / "some.mprim", "--import", tmp_path / "some.mprim")
    assert_one_line_error(result, "some.mprim", "is read for this lattice")
    assert (tmp_path / "some.mprim").read_text() == mprim_text()
