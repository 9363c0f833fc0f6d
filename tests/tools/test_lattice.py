"""tools/design/lattice.py: the committed lattices are fresh; importers of .mprim and Nav2 files; what they refuse."""
import json
import math
import os
import random
import re
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT, assert_one_line_error, run_tool
from mprim_data import motions, mprim_text

from tools.design import lattice, lattice_import

JP_LATTICE = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve() / "bin" / "jp-lattice"
TABLES = ROOT / "src" / "tables"
LATTICES = sorted(path.stem.removeprefix("lattice_") for path in TABLES.glob("lattice_*.c"))
ROBOTS = [name for name in LATTICES if not name.endswith("_navigation")]
HEADINGS = 16
ROM_MAX = 32768

CHECK = """
#include <joulepath/lattice.h>
#include <stdio.h>
extern const struct jp_lattice LATTICE;
int main(void)
{
    const char *field = "";
    enum jp_status status = jp_lattice_check(&LATTICE, &field);
    printf("%d %s\\n", (int)status, status == JP_OK ? "" : field);
    return status != JP_OK;
}
"""


def make(*arguments):
    return run_tool("design.lattice", *arguments)


@pytest.mark.parametrize("name", ROBOTS)
def test_committed_tables_are_fresh(name, tmp_path):
    result = make(name, "--tables", tmp_path)
    assert result.returncode == 0, result.stderr
    made = sorted(tmp_path.iterdir())
    assert [path.name for path in made] == sorted(path.name for kind in ("lattice", "navigation", "skid_steer")
                                                  for end in ("", "_navigation")
                                                  for path in TABLES.glob(f"{kind}_{name}{end}.c"))
    for path in made:
        assert path.read_bytes() == (TABLES / path.name).read_bytes(), f"run make lattice ROBOT={name}"


def test_both_robots_have_a_lattice():
    assert {"gao2018", "zhang2018"} <= set(LATTICES)


def test_a_long_robot_that_finds_its_way_has_a_lattice_of_its_rectangle_and_one_of_its_disc():
    assert {"zhang2018", "zhang2018_navigation", "burger"} <= set(LATTICES) and "burger_navigation" not in LATTICES


def test_only_who_finds_its_way_has_a_lattice_for_it(tmp_path):
    result = subprocess.run([JP_LATTICE, ROOT / "sim/robots/gao2018.cfg", "--navigation", "--output", tmp_path / "out"],
                            capture_output=True, text=True, check=False)
    assert_one_line_error(result, "--navigation", "section navigation")


@pytest.mark.parametrize("name", LATTICES)
def test_tables_fit_their_rom(name):
    text = (TABLES / f"lattice_{name}.c").read_text(encoding="utf-8")
    assert int(re.search(r"(\d+) bytes", text)[1]) <= ROM_MAX
    assert f"<= {ROM_MAX}U," in text


def test_sizes_are_those_of_the_compiler(tmp_path):
    sizes = (lattice.PRIMITIVE_SIZE, lattice.INDEX_SIZE, lattice.SPAN_SIZE, lattice.LATTICE_SIZE)
    types = ("struct jp_primitive", "uint16_t", "struct jp_span", "struct jp_lattice")
    source = tmp_path / "sizes.c"
    source.write_text("#include <joulepath/lattice.h>\n" + "".join(
        f'_Static_assert(sizeof({name}) == {size}, "{name}");\n' for name, size in zip(types, sizes))
        + f'_Static_assert(JP_PRIMITIVES_PER_HEADING_MAX == {lattice.BRANCHES_MAX}, "branches");\n'
        + f'_Static_assert(JP_COST_PER_JOULE == {lattice.UNITS_PER_JOULE}, "unit");\n')
    subprocess.run(["arm-none-eabi-gcc", "-mthumb", "-mcpu=cortex-m4", "-std=c11", "-I", ROOT / "include",
                    "-fsyntax-only", source], check=True)


def check_table(path, directory):
    """A table compiles without warnings and passes jp_lattice_check()."""
    program = directory / "check"
    source = directory / "check.c"
    source.write_text(CHECK)
    core = [ROOT / "src" / name for name in ("map/lattice.c", "map/terrain.c", "base/fixed.c", "base/config_check.c")]
    subprocess.run(["gcc", "-std=c11", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-I", ROOT / "include", "-I", ROOT,
                    f"-DLATTICE=jp_{path.stem}", source, path, *core, "-o", program], check=True)
    result = subprocess.run([program], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout


# ---- Samples in the formats of the originals -------------------------------------------------------------------------

STEPS = [(1, 0), (2, 1), (1, 1), (1, 2), (0, 1), (-1, 2), (-1, 1), (-2, 1), (-1, 0), (-2, -1), (-1, -1), (-1, -2),
         (0, -1), (1, -2), (1, -1), (2, -1)]


def interpolated(resolution, start, end, cell, count=10):
    """Poses on a straight line with a heading that turns evenly, as SBPL's own scripts make them."""
    turn = math.remainder(end - start, 2 * math.pi)
    return [(cell[0] * resolution * i / (count - 1), cell[1] * resolution * i / (count - 1),
             start + turn * i / (count - 1)) for i in range(count)]


def sbpl_primitives():
    """(start, end cell, end heading): a step, three steps, a step back, and a turn to each side, from each heading."""
    for start, (x, y) in enumerate(STEPS):
        yield start, (x, y), start
        yield start, (3 * x, 3 * y), start
        yield start, (-x, -y), start
        yield start, (0, 0), start + 1
        yield start, (0, 0), start - 1


def sbpl_text(resolution=0.1):
    primitives = list(sbpl_primitives())
    lines = [f"resolution_m: {resolution:.6f}", "numberofangles: 16", f"totalnumberofprimitives: {len(primitives)}"]
    for index, (start, cell, end) in enumerate(primitives):
        poses = interpolated(resolution, start * math.pi / 8, end * math.pi / 8, cell)
        lines += [f"primID: {index % 5}", f"startangle_c: {start}", f"endpose_c: {cell[0]} {cell[1]} {end}",
                  "additionalactioncostmult: 1", f"intermediateposes: {len(poses)}"]
        lines += [f"{x:.4f} {y:.4f} {heading:.4f}" for x, y, heading in poses]
    return "\n".join(lines) + "\n"


def nav2_data(resolution=0.1):
    headings = [math.atan2(y, x) % (2 * math.pi) for x, y in STEPS]
    primitives = []
    for start, (x, y) in enumerate(STEPS):
        straight = interpolated(resolution, headings[start], headings[start], (2 * x, 2 * y), 5)[1:]
        end = (start + 1) % HEADINGS
        turn = interpolated(resolution, headings[start], headings[end], (0, 0), 4)
        for to, poses in ((start, straight), (end, turn)):
            primitives.append({
                "trajectory_id": len(primitives), "start_angle_index": start, "end_angle_index": to, "left_turn": True,
                "trajectory_radius": 0.0, "trajectory_length": 0.2, "arc_length": 0.0, "straight_length": 0.2,
                "poses": [[round(px, 5), round(py, 5), heading % (2 * math.pi)] for px, py, heading in poses]})
    return {"version": 1.0, "date_generated": "2022-03-17",
            "lattice_metadata": {"motion_model": "diff", "turning_radius": 0.5, "grid_resolution": resolution,
                                 "stopping_threshold": 5, "num_of_headings": HEADINGS, "heading_angles": headings,
                                 "number_of_trajectories": len(primitives)},
            "primitives": primitives}


SAMPLES = {"sample.mprim": sbpl_text(), "sample.json": json.dumps(nav2_data())}


def write_sample(directory, name, text=None):
    path = directory / name
    path.write_text(SAMPLES[name] if text is None else text)
    return path


@pytest.mark.parametrize("robot", ["zhang2018", "gao2018"])
@pytest.mark.parametrize("name", SAMPLES)
def test_import_makes_a_valid_table(name, robot, tmp_path):
    result = make(robot, "--import", write_sample(tmp_path, name), "--tables", tmp_path)
    assert result.returncode == 0, result.stderr
    table = tmp_path / f"lattice_{robot}_sample.c"
    check_table(table, tmp_path)
    text = table.read_text()
    assert f"{80 if name.endswith('mprim') else 32} primitives on cells of 0.1 m" in text
    assert f"`python -m tools.design.lattice {robot} --import {name}`" in text


def headings_of(directory, name):
    return lattice_import.read_primitives(write_sample(directory, name)).input["headings_rad"]


def test_imported_headings(tmp_path):
    assert headings_of(tmp_path, "sample.mprim") == [math.pi / 8 * k for k in range(HEADINGS)]
    exact = [math.atan2(y, x) % (2 * math.pi) for x, y in STEPS]
    assert headings_of(tmp_path, "sample.json") == pytest.approx(exact, abs=1e-12)


def test_paths_end_exactly_on_their_end_states(tmp_path):
    """SBPL's own files miss them by up to 0.12 rad."""
    text = sbpl_text().replace("0.1000 0.0000 0.0000\nprimID: 1", "0.0990 0.0010 0.1200\nprimID: 1", 1)
    found = lattice_import.read_primitives(write_sample(tmp_path, "sample.mprim", text)).input
    assert found["primitives"][0]["poses"][-1] == pytest.approx([1, 0, 0], abs=1e-12)


def strafing(cell):
    """The way to a cell, at every heading."""
    return [(start, cell, 0, 1) for start in range(HEADINGS)]


def skews_left_out(directory, chosen, resolution=0.1):
    """How many primitives of a file are left out, and the note that says so."""
    chosen = sorted(chosen, key=lambda motion: motion[0])
    path = write_sample(directory, "sample.mprim", mprim_text(resolution, chosen))
    found = lattice_import.read_primitives(path)
    return len(chosen) - len(found.input["primitives"]), found.notes


def test_primitives_across_their_heading_are_left_out(tmp_path):
    """By more than half of 22.5 degrees."""
    ahead = list(motions())
    assert skews_left_out(tmp_path, ahead)[0] == 0
    for cell in ((0, 1), (1, 1), (5, 1)):  # 5, 1 is 11.3 degrees from heading 0 and 11.2 from heading 1
        count, notes = skews_left_out(tmp_path, ahead + strafing(cell))
        assert count == 14, cell
        assert "14 primitives drive across their heading" in notes[0]
        assert re.search(r"its headings explain 11\.[23]", notes[0])
    result = make("zhang2018", "--import", write_sample(tmp_path, "sample.mprim", mprim_text(0.1, sorted(
        ahead + strafing((0, 3)), key=lambda motion: motion[0]))), "--tables", tmp_path)
    assert result.returncode == 0, result.stderr
    assert "14 primitives drive across their heading, by 22.5 to 90.0 degrees, and were left out" in result.stdout


@pytest.mark.parametrize("resolution", [0.01, 0.025, 1.0])
def test_decimals_do_not_make_a_way_across(resolution, tmp_path):
    """At a centimetre a cell, four decimals turn a tenth of a cell by 4 degrees."""
    assert skews_left_out(tmp_path, motions(), resolution) == (
        0, ["80 primitives cost 2 to 5 times what they take: additionalactioncostmult"])


def test_only_ways_across_are_refused(tmp_path):
    path = write_sample(tmp_path, "sample.mprim", mprim_text(0.1, [
        (start, (-y, x), 0, 1) for start, (x, y) in enumerate(STEPS)]))
    assert_one_line_error(make("zhang2018", "--import", path, "--tables", tmp_path / "tables"), "sample.mprim",
                          "every primitive drives across its heading")


def level_costs(data):
    """Of each primitive by the tables, and the costs of its steps."""
    for primitive in data["primitives"]:
        steps = [sum(max(move["floor"], move["climb"][0] >> 16) for move in (
            kind["moves"][1 if step % 2 else 2 if step % 4 else 0] for step in primitive["moves"]))
            for kind in data["costs"]]
        yield [base + step for base, step in zip(primitive["base"], steps)], steps


@pytest.mark.parametrize("robot", ["zhang2018", "gao2018"])
def test_factors_multiply_every_cost(robot, tmp_path):
    """Up to the rounding to whole units; the steps, which bound the costs from below, stay."""
    plain = [(*motion[:3], 1) for motion in motions()]
    made = []
    for chosen in (plain, [(*motion[:3], 1 + index % 5) for index, motion in enumerate(plain)]):
        found = lattice_import.read_primitives(write_sample(tmp_path, "sample.mprim", mprim_text(0.1, chosen)))
        data = lattice.run_on_primitives(ROOT / f"sim/robots/{robot}.cfg", "sample.mprim", found.input)
        made.append(list(level_costs(data)))
    for index, ((once, steps), (times, same_steps)) in enumerate(zip(*made)):
        assert steps == same_steps
        for cost, multiplied in zip(once, times):
            factor = 1 + index % 5
            assert abs(multiplied - factor * cost) <= factor
    assert any(times[0] > 4 * once[0] for (once, _), (times, _) in zip(*made))


def test_files_of_several_cells_and_reaches(tmp_path):
    """From a robot of 2 cm to cells of a metre, and sweeps of 90 cells."""
    tiny = write_tiny_robot(tmp_path)
    for robot, resolution, stretch in ((tiny, 0.01, 1), ("zhang2018", 0.025, 1), ("gao2018", 1.0, 1),
                                       ("gao2018", 0.1, 10)):
        path = write_sample(tmp_path, "sample.mprim", mprim_text(resolution, motions(stretch)))
        result = make(robot, "--import", path, "--json", tmp_path / "lattice.json")
        assert result.returncode == 0, result.stderr
        made = json.loads((tmp_path / "lattice.json").read_text())
        assert len(made["primitives"]) == 112
        assert made["resolution"] == [round(resolution * 65536)]
    assert max(span[2] for span in made["spans"]) >= 80


def write_tiny_robot(directory):
    """zhang2018 at a fortieth of its size."""
    path = directory / "tiny.cfg"
    text = (ROOT / "sim/robots/zhang2018.cfg").read_text(encoding="utf-8")
    for key, value in (("name", '"tiny"'), ("length_m", 0.02), ("width_m", 0.02), ("wheelbase_m", 0.01),
                       ("mass_kg", 0.02), ("radius_m", 0.003), ("torque_constant_nm_per_a", 0.001),
                       ("resistance_ohm", 5.0), ("gear_ratio", 30.0), ("voltage_v", 12.0), ("distance_j_per_m", 0.6),
                       ("centre_height_m", 0.002), ("inertia_kg_m2", 1e-7), ("yaw_inertia_kg_m2", 1.3e-6),
                       ("current_limit_a", 0.2)):
        text = re.sub(rf"{key} = [^;]*;", f"{key} = {value};", text)
    for before, after in (("power_w = 240.0", "power_w = 1.0"), ("power_w = 10.0", "power_w = 0.05"),
                          ("speed_m_s = 1.0", "speed_m_s = 0.2"), ("speed_m_s = 0.5", "speed_m_s = 0.1")):
        text = text.replace(before, after)
    path.write_text(text)
    return path


def test_steps_that_are_counted_badly_are_named(tmp_path):
    """Energies are whole sixteenths of a joule."""
    def said(robot, resolution):
        path = write_sample(tmp_path, "sample.mprim", mprim_text(resolution))
        result = make(robot, "--import", path, "--json", tmp_path / "lattice.json")
        assert result.returncode == 0, result.stderr
        return [line for line in result.stdout.splitlines() if "a step of" in line]

    assert said("zhang2018", 0.2) == said("gao2018", 0.025) == []
    line, = said("gao2018", 0.01)
    found = lattice_import.read_primitives(tmp_path / "sample.mprim")
    data = lattice.run_on_primitives(ROOT / "sim/robots/gao2018.cfg", "sample.mprim", found.input)
    step = data["costs"][0]["moves"][0]["climb"][0] / 65536
    assert f"takes {step / 16:.2g} J, {step:.2g} of the units" in line
    assert "each primitive is rounded to whole ones" in line
    line, = said(write_tiny_robot(tmp_path), 0.01)
    assert "less than one: plans by energy count steps" in line


@pytest.mark.parametrize("robot", ["zhang2018", "gao2018"])
def test_long_ways_cost_as_much_as_short_ones(robot, tmp_path):
    """Within a unit a primitive, by every cost: what each step loses by rounding does not add up."""
    found = lattice_import.read_primitives(write_sample(tmp_path, "sample.mprim", mprim_text(0.025)))
    data = lattice.run_on_primitives(ROOT / f"sim/robots/{robot}.cfg", "sample.mprim", found.input)
    costs = {(p["start"], p["dx"], p["dy"]): cost for p, (cost, _) in zip(data["primitives"], level_costs(data))}
    for step, way, times in (((0, 1, 0), (0, 8, 0), 8), ((2, 1, 1), (2, 6, 6), 6), ((1, 2, 1), (1, 6, 3), 3)):
        for one, all_of_them in zip(costs[step], costs[way]):
            assert times * (one - 1) <= all_of_them <= times * one + 1


def test_tables_of_what_no_controller_holds_are_refused(tmp_path):
    """A file for jp-plan has no constants of skid steering."""
    result = make(write_tiny_robot(tmp_path), "--tables", tmp_path / "tables")
    assert_one_line_error(result, "wheel_radius", "0.01")
    assert not (tmp_path / "tables").exists()


def test_other_headers_of_sbpl_files(tmp_path):
    """The files of non-uniform angles list them, and a radius for each primitive."""
    angles = "".join(f"angle:{k} {math.pi / 8 * k:.8f}\n" for k in range(HEADINGS))
    text = sbpl_text().replace("numberofangles: 16\n", f"min_turning_radius_m: 1.0\nnumberofangles: 16\n{angles}")
    text = text.replace("additionalactioncostmult: 1\n", "additionalactioncostmult: 1\nturning_radius: 0.0000\n")
    plain = lattice_import.read_primitives(write_sample(tmp_path, "sample.mprim"))
    other = lattice_import.read_primitives(write_sample(tmp_path, "sample.mprim", text))
    assert plain.input == other.input


# ---- What is refused -------------------------------------------------------------------------------------------------

def expect_refused(directory, name, text, *parts):
    path = write_sample(directory, name, text)
    result = make("zhang2018", "--import", path, "--tables", directory / "tables")
    assert_one_line_error(result, name, *parts)
    assert not (directory / "tables").exists()


@pytest.mark.parametrize("before, after, part", [
    ("numberofangles: 16", "numberofangles: 8", "numberofangles: must be 16"),
    ("resolution_m: 0.100000", "resolution_m: 0", "resolution_m"),
    ("resolution_m: 0.100000", "resolution: 0.1", "expected resolution_m"),
    ("totalnumberofprimitives: 80", "totalnumberofprimitives: 81", "ends early"),
    ("totalnumberofprimitives: 80", "totalnumberofprimitives: 75", "no primitive starts at heading 15"),
    ("totalnumberofprimitives: 80", "totalnumberofprimitives: 1000000000", "out of range"),
    ("startangle_c: 3", "startangle_c: 16", "startangle_c"),
    ("startangle_c: 3", "startangle_c: 4", "rad"),
    ("additionalactioncostmult: 1", "additionalactioncostmult: 0", "must be 1 to 65535"),
    ("additionalactioncostmult: 1", "additionalactioncostmult: x", "additionalactioncostmult"),
    ("additionalactioncostmult: 1", "additionalactioncostmult: 60000", "its energy"),
    ("endpose_c: 1 0 0", "endpose_c: 2 0 0", "do not end at its end"),
    ("endpose_c: 1 0 0", "endpose_c: 1 0", "endpose_c"),
    ("endpose_c: 1 0 0", "endpose_c: 1000 0 0", "out of range"),
    ("intermediateposes: 10", "intermediateposes: 0", "intermediateposes"),
    ("0.0111 0.0000 0.0000", "0.0111 nan 0.0000", "nan"),
    ("0.0111 0.0000 0.0000", "0.0111 x 0.0000", "not a number"),
    ("0.0111 0.0000 0.0000", "0.0111 0.0000", "a pose is three numbers"),
])
def test_wrong_mprim_files_are_refused(before, after, part, tmp_path):
    expect_refused(tmp_path, "sample.mprim", sbpl_text().replace(before, after, 1), part)


def changed(*keys, value):
    data = nav2_data()
    place = data
    for key in keys[:-1]:
        place = place[key]
    place[keys[-1]] = value
    return json.dumps(data)


@pytest.mark.parametrize("text, part", [
    (changed("lattice_metadata", "grid_resolution", value=0), "grid_resolution"),
    (changed("lattice_metadata", "grid_resolution", value="0.1"), "grid_resolution"),
    (changed("lattice_metadata", "heading_angles", value=[0, 1, 2]), "3 headings"),
    (changed("lattice_metadata", "heading_angles", 3, value=0.1), "must rise"),
    (changed("lattice_metadata", "heading_angles", 3, value=None), "not a number"),
    (changed("primitives", value=[]), "0 primitives"),
    (changed("primitives", value={}), "primitives"),
    (changed("primitives", 5, value=7), "primitive 5"),
    (changed("primitives", 5, "start_angle_index", value=16), "start_angle_index"),
    (changed("primitives", 5, "end_angle_index", value=1.5), "end_angle_index"),
    (changed("primitives", 5, "end_angle_index", value=9), "primitive 5"),
    (changed("primitives", 5, "poses", value=[]), "0 poses"),
    (changed("primitives", 5, "poses", 0, value=[0, 0]), "three numbers"),
    (changed("primitives", 5, "poses", 0, value=[0, math.inf, 0]), "out of range"),
    ("[" * 100000, "no JSON"),
    ("{}", "lattice_metadata"),
    ("", "no JSON"),
])
def test_wrong_nav2_files_are_refused(text, part, tmp_path):
    expect_refused(tmp_path, "sample.json", text, part)


def test_other_files_are_refused(tmp_path):
    assert_one_line_error(make("zhang2018", "--import", tmp_path / "absent.mprim"), "absent.mprim", "No such file")
    (tmp_path / "notes.txt").write_text("notes")
    assert_one_line_error(make("zhang2018", "--import", tmp_path / "notes.txt"), "notes.txt", ".mprim")
    (tmp_path / "binary.json").write_bytes(b"\xff\xfe\x00")
    assert_one_line_error(make("zhang2018", "--import", tmp_path / "binary.json"), "binary.json")


def test_a_copy_under_another_name_is_refused(tmp_path):
    copy = tmp_path / "mine.cfg"
    copy.write_bytes((ROOT / "sim/robots/zhang2018.cfg").read_bytes())
    assert_one_line_error(make(copy, "--tables", tmp_path / "tables"), "mine.cfg", "name: is 'zhang2018'", "same name")
    assert not (tmp_path / "tables").exists()


def test_unknown_robots_are_refused(tmp_path):
    assert_one_line_error(make("nobody", "--tables", tmp_path), "nobody")
    broken = tmp_path / "broken.cfg"
    text = (ROOT / "sim" / "robots" / "zhang2018.cfg").read_text(encoding="utf-8")
    for before, after, part in (("gear_ratio = 244.3333845", "gear_ratio = 2.0", "gear_ratio"),
                                ("power_w = 240.0", "power_w = 100.0", "power_w"),
                                ("friction = 0.69", "friction = \"x\"", "ground.friction"),
                                ("mass_kg = 92.0", "mass_kg = -1", "mass_kg"),
                                ("\"skid_steer\"", "\"hover\"", "type"),
                                ("name = \"zhang2018\"", "name = \"Zhang 2018\"", "name"),
                                ("  speed_m_s = 0.5;", "  speed_m_s = 2.0;", "lattice.speed_m_s"),
                                ("resistance_ohm = 0.74;", "", "resistance_ohm"),
                                ("efficiency = 0.78;", "efficiency = 0.78; efficient = 1.0;", "motor.efficient"),
                                ("type =", "colour = 1; type =", "colour")):
        assert before in text
        broken.write_text(text.replace(before, after, 1))
        assert_one_line_error(make(broken, "--tables", tmp_path / "tables"), "broken.cfg", part)
    assert not (tmp_path / "tables").exists()


def big_lattice(primitives, rows):
    """What jp-lattice might print: every primitive sweeps rows of its own."""
    cells = [[y, 0, 1] for y in range(rows)]
    own = [{"start": 0, "end": 0, "dx": 1, "dy": 0, "length_m": 0.2, "duration_s": 0.4, "base": [0, 0, 0], "moves": [0],
            "swept": [[y, -1, i % 100] for y in range(rows)] + [[100, i // 100, 100]]} for i in range(primitives)]
    return {"resolution_m": 0.2, "headings_rad": [0.0] * HEADINGS, "primitives": own, "footprint": [cells] * HEADINGS,
            "reach": [[[0, -127, 127]]] * HEADINGS, "core": cells}


def test_tables_beyond_the_rom_are_refused():
    lattice.Tables("some", big_lattice(100, 50)).check_rom()
    with pytest.raises(lattice.ToolError, match=f"bytes of tables, at most {ROM_MAX}.*--json"):
        lattice.Tables("many", big_lattice(250, 50)).check_rom()


def test_too_many_branches_are_refused():
    with pytest.raises(lattice.ToolError, match="256 primitives start at one heading"):
        lattice.Tables("many", big_lattice(lattice.BRANCHES_MAX + 1, 1))


@pytest.mark.parametrize("key, value, part", [
    ("base", [70000, 0, 0], "its energy on top of that of its steps is 4375 J, the tables hold at most 4095.94 J; "
     "import cells of at most 0.19 m"),
    ("base", [0, 0, 70000], "by distance on top of that of its steps is 70 m, the tables hold at most 65.535 m"),
    ("length_m", 70.0, "its length is 70 m"),
    ("duration_s", 140.0, "its duration is 140 s, the tables hold at most 65.535 s; import cells of at most 0.093 m"),
])
def test_values_beyond_their_members_are_refused(key, value, part):
    data = big_lattice(2, 3)
    data["primitives"][1][key] = value
    with pytest.raises(lattice.ToolError, match=part):
        lattice.Tables("some", data)
    data["primitives"][1]["dx"] = 0
    with pytest.raises(lattice.ToolError, match="smaller turns"):
        lattice.Tables("some", data)


def test_cells_too_large_for_the_tables_are_refused(tmp_path):
    steps = [(start, cell, 0, 1) for start, cell in enumerate(STEPS)]
    path = write_sample(tmp_path, "sample.mprim", mprim_text(9, steps))
    result = make("zhang2018", "--import", path, "--json", tmp_path / "lattice.json")
    assert_one_line_error(result, "zhang2018", "a step of", "choose cells of at most", "instead of 9 m")


def mutated(text, chance):
    """A few damages: characters, numbers, lines."""
    for _ in range(chance.randint(1, 4)):
        place = chance.randrange(len(text))
        kind = chance.randrange(5)
        if kind == 0:
            text = text[:place] + chance.choice("0123456789.-:{}[],\n eNx\"") + text[place + 1:]
        elif kind == 1:
            text = text[:place]
        elif kind == 2:
            end = place + chance.randint(1, 200)
            text = text[:place] + text[end:]
        elif kind == 3:
            numbers = list(re.finditer(r"-?\d+(\.\d+)?", text))
            if numbers:
                found = chance.choice(numbers)
                value = chance.choice(["-1", "0", "1e9", "99999999999999999999", "nan", "0.5", "16", "-7", "1e-9"])
                text = text[:found.start()] + value + text[found.end():]
        else:
            end = place + chance.randint(1, 200)
            text = text[:place] + text[place:end] + text[place:]
        if not text:
            break
    return text


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("name", SAMPLES)
def test_damaged_files_give_a_valid_table_or_one_line(name, seed, tmp_path):
    chance = random.Random(f"{name} {seed}")
    for _ in range(15):
        path = write_sample(tmp_path, name, mutated(SAMPLES[name], chance))
        tables = tmp_path / "tables"
        result = make("zhang2018", "--import", path, "--tables", tables)
        if result.returncode == 0:
            check_table(tables / "lattice_zhang2018_sample.c", tmp_path)
            (tables / "lattice_zhang2018_sample.c").unlink()
        else:
            assert_one_line_error(result, name)
            assert not tables.exists() or not list(tables.iterdir())


@pytest.mark.parametrize("seed", range(4))
def test_damaged_input_of_jp_lattice_gives_one_line(seed, tmp_path):
    sound = json.dumps(lattice_import.read_primitives(write_sample(tmp_path, "sample.json")).input)
    chance = random.Random(seed)
    robot = ROOT / "sim" / "robots" / "zhang2018.cfg"
    for number in range(15):
        path = tmp_path / "primitives.json"
        path.write_text(mutated(sound, chance))
        output = tmp_path / f"output{number}"
        result = subprocess.run([JP_LATTICE, robot, "--output", output, "--primitives", path], capture_output=True,
                                text=True, check=False)
        assert result.returncode in (0, 2), result.stderr
        assert len(result.stderr.splitlines()) == (result.returncode == 2)
        assert (output / "lattice.json").exists() == (result.returncode == 0)
