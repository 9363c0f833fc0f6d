"""From robot files to tables: those of the tools, which are committed; and what is wrong is said."""
import subprocess

import numpy
import pytest
from conftest import BUILD, ROOT, SITE
from joulepath import Error, Lattice, Robot, tables


@pytest.mark.parametrize("name", ["courier24", "gao2018"])
def test_the_controller_of_a_balancer_is_the_committed_one(name):
    design = tables.design(name)
    assert design.controller.text == (ROOT / "src/tables" / design.controller.name).read_text()
    assert design.controller.struct == "jp_robot_config"
    assert (design.poles.real < 0).all() and min(design.margins.values()) > 0.3
    assert design.a.shape == (13,) and (design.b > 0).all() and design.settling_s > 0
    assert set(design.gains) >= {"wheel", "pitch", "yaw"}
    assert design.controller.values["estimator"]["tick_rate"] == 1000
    assert f"jp_energy_model_{name}" in design.energy.text


def test_the_controller_of_a_skid_steered_robot_is_the_committed_one():
    design = tables.design("burger")
    assert design.controller.text == (ROOT / "src/tables/skid_robot_burger.c").read_text()
    assert design.controller.values["control"]["tick_rate"] == 100


def test_members_are_those_of_the_text():
    table = tables.design("courier24").controller

    def check(values):
        for name, value in values.items():
            if isinstance(value, dict):
                check(value)
            elif isinstance(value, int) and not isinstance(value, bool):
                assert f".{name} = {value}" in table.text, name

    check(table.values)
    assert "{" not in str(table.name) and any(isinstance(value, dict) for value in table.values.values())


def test_a_robot_file_of_ones_own(tmp_path):
    text = (ROOT / "sim/robots/courier24.cfg").read_text()
    path = tmp_path / "mine.cfg"
    path.write_text(text.replace('name = "courier24"', 'name = "mine"'))
    assert tables.design(path).controller.name == "robot_mine.c"
    path.write_text(text.replace('name = "courier24"', 'name = "mine"').replace("mass_kg", "mass_g", 1))
    with pytest.raises(Error, match="mass_g") as caught:
        tables.design(path)
    assert len(str(caught.value).splitlines()) == 1
    with pytest.raises(Error, match="patrol"):
        tables.design("patrol")


def test_the_energy_model_is_identified():
    few = tables.identify("courier24", experiments=100, seed=3)
    assert few.error_percent < 1 and few.table.struct == "jp_energy_model"
    assert "100 experiments of jp-identify, seed 3" in few.table.text and few.a.shape == (13,)


def test_a_lattice_is_made(tmp_path):
    path = tmp_path / "lattice.json"
    tables.write_lattice("zhang2018", path)
    assert Lattice.load(path).cell_m == Lattice(Robot("zhang2018")).cell_m


def test_without_scipy_it_says_what_is_needed(tmp_path):
    program = ("import sys; sys.modules['scipy'] = None; import joulepath.tables as t\n"
               "try: t.design('courier24')\nexcept t.Error as error: print(error)")
    import sys
    result = subprocess.run([sys.executable, "-c", program], env={"PYTHONPATH": str(SITE), "PATH": "/usr/bin"},
                            capture_output=True, text=True, check=True, cwd=tmp_path)
    assert "scipy; pip install 'joulepath[tools]'" in result.stdout and BUILD.exists()
