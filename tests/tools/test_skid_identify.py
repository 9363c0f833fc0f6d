"""tools/design/skid_identify.py: the committed tables are fresh; its model is the core's; what it refuses."""
import ctypes
import dataclasses
import json
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, assert_one_line_error, run_tool

from tools.design import skid_identify, skid_model

JP_SKID_IDENTIFY = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve() / "bin" / "jp-skid-identify"
TABLES = ROOT / "src" / "tables"
ROBOTS = sorted(path.stem.removeprefix("skid_energy_") for path in TABLES.glob("skid_energy_*.c"))

# Another libm may round the simulated robot's sines differently; the fits move by less than this share.
TOLERANCE = 1e-3

CORE = """
#include <joulepath/skid_energy.h>
int64_t energy_of(const struct jp_skid_energy_model *model, const struct jp_skid_piece *piece)
{
    struct jp_skid_drive drive = {0};
    return jp_skid_energy_add(model, &drive, piece) == JP_OK ? drive.energy : INT64_MIN;
}
"""


def integers(text):
    body = text[text.index("= {"):]
    return [int(number) for number in re.findall(r"(-?\d+)U?,\s*/\*", body)]


def drive(robot, directory, *options):
    subprocess.run([JP_SKID_IDENTIFY, ROOT / "sim" / "robots" / f"{robot}.cfg", "--output", directory, *options], check=True, capture_output=True)


def identify(robot, directory):
    return run_tool("design.skid_identify", robot, "--experiments", directory, "--tables", directory)


@pytest.fixture(scope="module")
def few_drives(tmp_path_factory):
    directory = tmp_path_factory.mktemp("few")
    drive("zhang2018", directory, "--count", "20", "--robots", "10")
    return directory


@pytest.fixture
def copied(few_drives, tmp_path):
    for name in ("experiments.csv", "robots.csv", "experiments.json"):
        (tmp_path / name).write_bytes((few_drives / name).read_bytes())
    return tmp_path


def test_both_kinds_are_identified():
    assert {"burger", "zhang2018"} <= set(ROBOTS)


@pytest.mark.parametrize("robot", ROBOTS)
def test_committed_tables_are_fresh(robot, tmp_path):
    drive(robot, tmp_path)
    result = identify(robot, tmp_path)
    assert result.returncode == 0, result.stderr
    for kind, numbers in (("energy", slice(None)), ("learning", slice(-1))):  # the identity hangs on every bit
        name = f"skid_{kind}_{robot}.c"
        made = integers((tmp_path / name).read_text(encoding="utf-8"))[numbers]
        committed = integers((TABLES / name).read_text(encoding="utf-8"))[numbers]
        assert made == pytest.approx(committed, rel=TOLERANCE, abs=2), f"run make identify ROBOT={robot}"


# ---- The model -------------------------------------------------------------------------------------------------------

FIELDS = [field.name for field in dataclasses.fields(skid_model.Model)]
Q16 = {"weight", "copper_driving", "copper_braking", "electronics_power"}


@pytest.fixture(scope="module")
def core(tmp_path_factory):
    directory = tmp_path_factory.mktemp("core")
    (directory / "core.c").write_text(CORE)
    sources = [ROOT / "src" / name for name in ("energy/skid_energy.c", "energy/energy.c", "base/fixed.c",
                                                "base/config_check.c")]
    subprocess.run(["gcc", "-std=c11", "-shared", "-fPIC", "-O1", "-I", ROOT / "include", "-I", ROOT, directory / "core.c",
                    *sources, "-o", directory / "core.so"], check=True)
    library = ctypes.CDLL(directory / "core.so")
    library.energy_of.restype = ctypes.c_int64
    return library


def core_energy(library, model, piece):
    """J; piece: v0, w0, v1, w1, grade, bank, seconds."""
    numbers = [round(getattr(model, name) * 2**(16 if name in Q16 else 24)) for name in FIELDS]
    members = [round(value * 2**bits) for value, bits in zip(piece, (24, 24, 24, 24, 24, 24, 16))]
    energy = library.energy_of((ctypes.c_int32 * 18)(*numbers, 0), (ctypes.c_int32 * 7)(*members))
    return energy / 2**16


def random_model(generator):
    efficiency, weight = generator.uniform(0.5, 0.95), generator.uniform(5, 2000)
    return skid_model.Model(
        half_track=generator.uniform(0.05, 1), weight=weight, rolling=generator.uniform(0.005, 0.1),
        friction=generator.uniform(0.2, 1.2), turning=generator.uniform(0, 0.6), yielding=generator.uniform(0, 2),
        scrub=generator.uniform(0, 0.6), easing=generator.uniform(0, 2),
        bank_easing=generator.uniform(0, 2), tilting=generator.uniform(0, 1), inertia=0.15, turn_inertia=0.03, driving=1 / efficiency,
        braking=efficiency / 2, copper_driving=weight / 2, copper_braking=weight / 4, electronics_power=5.0)


def pieces_of(rows):
    v0, w0, v1, w1, grade, bank, seconds = np.array(rows).T
    return skid_model.Pieces(np.array([v0, v1]), np.array([w0, w1]), grade, bank, seconds, np.zeros_like(v0),
                             np.arange(len(v0)))


def test_the_model_is_the_cores(core):
    generator = np.random.default_rng(1)
    for _ in range(100):
        model = random_model(generator)
        rows = generator.uniform((-1, -1, -1, -1, -0.3, -0.3, 0.5), (1, 1, 1, 1, 0.3, 0.3, 5), (20, 7))
        rows[::3, :2] = rows[::3, 2:4]
        rows[::5, [0, 2]] = 0
        rows[1::5, [1, 3]] = 0
        expected = [core_energy(core, model, row) for row in rows]
        np.testing.assert_allclose(skid_model.energies(model, pieces_of(rows)), expected, rtol=1e-4, atol=0.01)


def test_standing_takes_the_electronics():
    model = random_model(np.random.default_rng(2))
    assert skid_model.energies(model, pieces_of([[0, 0, 0, 0, 0.1, 0.1, 2]])) == pytest.approx([10.0])


def test_factors_scale_the_model():
    model = random_model(np.random.default_rng(3))
    scaled = model.scaled((1.1, 0.9, 1.2, 0.8))
    assert scaled.rolling == pytest.approx(1.1 * model.rolling)
    assert scaled.friction == pytest.approx(0.9 * model.friction)
    assert scaled.weight == pytest.approx(1.2 * model.weight)
    assert scaled.copper_driving == pytest.approx(1.44 * model.copper_driving)
    assert scaled.electronics_power == pytest.approx(0.8 * model.electronics_power)


def synthetic(numbers, model, generator):
    """Rows of experiments whose energies are exactly the model's."""
    rows = generator.uniform((0, -0.8, 0, -0.8, -0.25, -0.25, 1), (0.8, 0.8, 0.8, 0.8, 0.25, 0.25, 3), (300, 7))
    rows[:, 2:4] = rows[:, :2]
    rows[::4, [0, 2]] = 0
    rows[1::4, [1, 3]] = 0
    pieces = pieces_of(rows)
    return dataclasses.replace(pieces, energy=skid_model.energies(model, pieces))


def test_a_model_is_found_again(few_drives):
    numbers = skid_identify.read_numbers(few_drives / "experiments.json", "zhang2018")
    start = skid_identify.start_of(numbers)
    model = dataclasses.replace(start, half_track=0.5, rolling=0.05, turning=0.3, yielding=0.4, scrub=0.3, easing=0.8,
                                bank_easing=1.2, tilting=0.4, driving=1.4,                                braking=0.3, electronics_power=12.0)
    pieces = synthetic(numbers, model, np.random.default_rng(4))
    found = skid_identify.fit_model(numbers, (pieces,))
    for name in skid_identify.FITTED:
        assert getattr(found, name) == pytest.approx(getattr(model, name), rel=0.02), name


def test_deviations_are_those_of_the_ranges():
    draws = np.random.default_rng(5).uniform(0.7, 1.5, 1000000) - 1
    assert skid_identify.deviations()[0] == pytest.approx(np.sqrt(np.mean(draws**2)), rel=0.01)


# ---- Bad input -------------------------------------------------------------------------------------------------------

def expect_refusal(directory, *words):
    result = identify("zhang2018", directory)
    assert_one_line_error(result, *words)


def test_few_drives_are_enough_for_a_table(copied):
    result = identify("zhang2018", copied)
    assert result.returncode == 0, result.stderr
    assert (copied / "skid_energy_zhang2018.c").exists()


def test_other_columns(copied):
    text = (copied / "experiments.csv").read_text()
    (copied / "experiments.csv").write_text(text.replace("grade", "slope", 1))
    expect_refusal(copied, "experiments.csv", "line 1")


@pytest.mark.parametrize(("cell", "word"), [("x", "not a number"), ("nan", "finite"), ("1,2", "finite")])
def test_a_bad_cell(copied, cell, word):
    lines = (copied / "robots.csv").read_text().splitlines()
    lines[3] = lines[3].rpartition(",")[0] + "," + cell
    (copied / "robots.csv").write_text("\n".join(lines) + "\n")
    expect_refusal(copied, "robots.csv", "line 4", word)


def test_no_rows(copied):
    text = (copied / "robots.csv").read_text()
    (copied / "robots.csv").write_text(text.splitlines()[0] + "\n")
    expect_refusal(copied, "robots.csv", "no drives")


def test_a_piece_without_duration(copied):
    lines = (copied / "robots.csv").read_text().splitlines()
    cells = lines[5].split(",")
    cells[8] = "0"
    lines[5] = ",".join(cells)
    (copied / "robots.csv").write_text("\n".join(lines) + "\n")
    expect_refusal(copied, "robots.csv", "seconds")


def test_numbers_that_are_missing_or_garbled(copied):
    path = copied / "experiments.json"
    numbers = json.loads(path.read_text())
    path.write_text(json.dumps({**numbers, "weight_n": "heavy"}))
    expect_refusal(copied, "experiments.json", "garbled")
    del numbers["weight_n"]
    path.write_text(json.dumps(numbers))
    expect_refusal(copied, "experiments.json", "weight_n")
    path.write_text(json.dumps({**numbers, "weight_n": 900, "robot": "burger"}))
    expect_refusal(copied, "experiments.json", "burger")


def test_a_model_that_misses_is_not_written(copied):
    """Energies that no motion explains."""
    lines = (copied / "experiments.csv").read_text().splitlines()
    for i, line in enumerate(lines[1:], 1):
        cells = line.split(",")
        if cells[1] == str(skid_identify.CHECK):
            cells[-1] = str(3 * float(cells[-1]))
        lines[i] = ",".join(cells)
    (copied / "experiments.csv").write_text("\n".join(lines) + "\n")
    result = identify("zhang2018", copied)
    assert result.returncode == 1
    assert "misses random motions" in result.stderr
    assert not (copied / "skid_energy_zhang2018.c").exists()
