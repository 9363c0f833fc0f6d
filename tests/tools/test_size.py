"""tools/measure/size.py: bytes of modules and structs from real objects."""
import json

import pytest
from conftest import assert_one_line_error, run_tool
from core_fixtures import make_variant

from tools.measure import core_numbers, size

STRUCTS = "struct jp_robot { int a[5]; } robot_of(void);\nstruct jp_ecu { int a[9]; };\nstruct jp_planner { char a; };\n" \
          "struct jp_robot first(struct jp_ecu *e, struct jp_planner *p) { struct jp_robot r = {{e->a[0], p->a}}; return r; }\n"
CODE = "const int table[{0}] = {{1}};\n"


@pytest.fixture
def measure(monkeypatch, tmp_path):
    monkeypatch.setenv("JP_BUILD", str(tmp_path / "build"))

    def run(sources, variant="cortex-m4"):
        folder = make_variant(tmp_path, {"src/balancer/robot.o": STRUCTS, **sources}, variant)
        result = run_tool("measure.size", folder)
        measured = tmp_path / "build/numbers/size.json"
        return result, json.loads(measured.read_text()) if measured.exists() else None
    return run


def test_constants_and_code_are_flash(measure):
    _, before = measure({"src/energy/energy.o": CODE.format(100)})
    _, after = measure({"src/energy/energy.o": CODE.format(150)})
    assert after["flash: energy"]["Cortex-M4"] - before["flash: energy"]["Cortex-M4"] == 200
    row = "flash: balancer + energy + optimiser"
    assert after[row]["Cortex-M4"] - before[row]["Cortex-M4"] == 200
    assert before["RAM: variables of all modules"] == {"Cortex-M4": 0}


def test_modules_add_their_objects(measure):
    _, table = measure({"src/trajectory/segment.o": CODE.format(10), "src/trajectory/segment_arc.o": "const int other[20] = {1};\n"})
    assert table["flash: optimiser"]["Cortex-M4"] == 120


def test_a_core_without_an_fpu_has_no_row_of_the_float_library(measure):
    _, without = measure({})
    _, with_it = measure({"src/local/obstacles.o": CODE.format(10)})
    assert "flash: obstacles" not in without
    assert with_it["flash: obstacles"] == {"Cortex-M4": 40}


@pytest.mark.parametrize("variable, ram, flash", [("int counter[4];", 16, 0), ("int counter[4] = {1};", 16, 16),
                                                  ("static int counter; int *of(void) { return &counter; }", 4, None)])
def test_variables_are_ram(measure, variable, ram, flash):
    _, table = measure({"src/energy/energy.o": variable})
    assert table["RAM: variables of all modules"]["Cortex-M4"] == ram
    if flash is not None:
        assert table["flash: energy"]["Cortex-M4"] == flash


@pytest.mark.parametrize("variant, core", [("cortex-m4", "Cortex-M4"), ("rv32", "RV32")])
def test_structs_have_their_size(measure, variant, core):
    _, table = measure({}, variant)
    assert [table[f"RAM: struct {name}"][core] for name in size.STRUCTS] == [20, 36, 1]


def test_the_codec_without_what_the_linker_drops(measure):
    kept = "int jp_can_pose_pack(int x) { return x * 3; }\n"
    _, before = measure({"hal/can/jp_can.o": kept})
    _, after = measure({"hal/can/jp_can.o": kept + "double jp_can_pose_x_encode(double x) { return x / 3; }\n"})
    assert after == before


def test_the_bars_are_figures(measure, tmp_path):
    measure({})
    figures = json.loads((tmp_path / "build/bench/size.json").read_text())
    bars = [(figure["value"], figure["bound"]["value"]) for figure in figures if figure["bound"] is not None]
    assert bars[1:] == [(0, 12288), (20, 1024)]
    assert figures[0]["bound"] == {"op": "<=", "value": 15360}


def test_parts_of_skid_steer_are_figures_of_their_sum(measure, tmp_path):
    of = {"src/skid_steer/skid_robot.o": 1, "src/skid_steer/skid_tilt.o": 2, "src/energy/skid_energy.o": 3,
          "src/learn/skid_grounds.o": 4}
    measure({path: CODE.replace("table", f"table_{number}").format(number) for path, number in of.items()})
    figures = json.loads((tmp_path / "build/bench/size.json").read_text())
    values = {figure["name"].rpartition("flash: ")[2]: figure["value"] for figure in figures}
    parts = [values[module] for module in size.SKID_STEER]
    assert min(parts) > 0 and sum(parts) == values["skid steer, control and energy"]


def test_an_object_of_no_module_is_an_error(measure):
    result, table = measure({"src/base/novelty.o": CODE.format(1)})
    assert_one_line_error(result, "src/base/novelty.o", "MODULES")
    assert table is None


def test_every_source_has_one_module():
    for source in [*core_numbers.ROOT.glob("src/**/*.c"), *core_numbers.ROOT.glob("hal/*.c"),
                   *(path for room in size.HAL_ROOMS for path in core_numbers.ROOT.glob(f"hal/{room}/*.c"))]:
        size.module_of(source.relative_to(core_numbers.ROOT).with_suffix(".o").as_posix(), size.MODULES)


def test_garbage_is_refused(monkeypatch, tmp_path):
    monkeypatch.setenv("JP_BUILD", str(tmp_path / "build"))
    (tmp_path / "cortex-m4/src/balancer").mkdir(parents=True)
    (tmp_path / "cortex-m4/src/balancer/robot.o").write_text("no object")
    assert_one_line_error(run_tool("measure.size", tmp_path / "cortex-m4"), "robot.o", "no object file")
    assert_one_line_error(run_tool("measure.size", tmp_path / "cortex-m9"), "cortex-m9")
    assert not (tmp_path / "build").exists()
