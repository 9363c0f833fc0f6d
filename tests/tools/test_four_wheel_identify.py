"""tools/design/four_wheel_identify.py: the committed tables are fresh; its model is the core's; what it refuses."""
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

from tools.design import four_wheel_identify, four_wheel_model, identification

JP_IDENTIFY = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve() / "bin" / "jp-four-wheel-identify"
TABLES = ROOT / "src" / "tables"

# Another libm may round the simulated robot's sines differently; the fits move by less than this share.
TOLERANCE = 1e-3

CORE = """
#include <joulepath/four_wheel_energy.h>
int64_t energy_of(const struct jp_four_wheel_energy_model *model, const struct jp_four_wheel_piece *piece)
{
    struct jp_four_wheel_drive drive = {0};
    return jp_four_wheel_energy_add(model, &drive, piece) == JP_OK ? drive.energy : INT64_MIN;
}
"""


def integers(text):
    body = text[text.index("= {"):]
    return [int(number) for number in re.findall(r"(-?\d+)U?,\s*/\*", body)]


def drive(directory, *options):
    subprocess.run([JP_IDENTIFY, ROOT / "sim" / "robots" / "patrol.cfg", "--output", directory, *options], check=True,
                   capture_output=True)


def identify(directory):
    return run_tool("design.four_wheel_identify", "patrol", "--experiments", directory, "--tables", directory)


@pytest.fixture(scope="module")
def few_drives(tmp_path_factory):
    directory = tmp_path_factory.mktemp("few")
    drive(directory, "--count", "4", "--robots", "2")
    return directory


@pytest.fixture
def copied(few_drives, tmp_path):
    for name in ("experiments.csv", "robots.csv", "experiments.json"):
        (tmp_path / name).write_bytes((few_drives / name).read_bytes())
    return tmp_path


def test_committed_tables_are_fresh(tmp_path):
    drive(tmp_path)
    result = identify(tmp_path)
    assert result.returncode == 0, result.stderr
    for kind, numbers in (("energy", slice(None)), ("learning", slice(-1))):  # the identity hangs on every bit
        name = f"four_wheel_{kind}_patrol.c"
        made = integers((tmp_path / name).read_text(encoding="utf-8"))[numbers]
        committed = integers((TABLES / name).read_text(encoding="utf-8"))[numbers]
        assert made == pytest.approx(committed, rel=TOLERANCE, abs=2), "run make identify ROBOT=patrol"


# ---- The model -------------------------------------------------------------------------------------------------------

FIELDS = [field.name for field in dataclasses.fields(four_wheel_model.Model)]
Q16 = {"weight", "copper_driving", "copper_braking", "steering", "electronics_power"}


@pytest.fixture(scope="module")
def core(tmp_path_factory):
    directory = tmp_path_factory.mktemp("core")
    (directory / "core.c").write_text(CORE)
    sources = [ROOT / "src" / name for name in ("energy/four_wheel_energy.c", "base/fixed.c", "base/config_check.c")]
    subprocess.run(["gcc", "-std=c11", "-shared", "-fPIC", "-O1", "-I", ROOT / "include", "-I", ROOT, directory / "core.c",
                    *sources, "-o", directory / "core.so"], check=True)
    library = ctypes.CDLL(directory / "core.so")
    library.energy_of.restype = ctypes.c_int64
    return library


def core_energy(library, model, piece):
    """J; piece: x, y and w at the start and at the end, grade, bank, travel, seconds."""
    numbers = [round(getattr(model, name) * 2**(16 if name in Q16 else 24)) for name in FIELDS]
    members = [round(value * 2**bits) for value, bits in zip(piece, [24] * 8 + [16] * 2)]
    return library.energy_of((ctypes.c_int32 * 16)(*numbers, 0), (ctypes.c_int32 * 10)(*members)) / 2**16


def random_model(generator):
    efficiency, weight = generator.uniform(0.5, 0.95), generator.uniform(50, 2000)
    return four_wheel_model.Model(
        wheelbase=generator.uniform(0.2, 1), track=generator.uniform(0.2, 1), weight=weight, rolling=generator.uniform(0.005, 0.1),
        drag=generator.uniform(0, 0.01), cornering=generator.uniform(0, 0.001), inertia=0.13, turn_inertia=0.02,
        driving=1 / efficiency, braking=efficiency / 2, copper_driving=2 * weight, copper_braking=weight,
        steering=generator.uniform(1, 5), contact=generator.uniform(0.01, 0.05), electronics_power=25.0)


def pieces_of(rows):
    x0, y0, w0, x1, y1, w1, grade, bank, travel, seconds = np.array(rows).T
    return four_wheel_model.Pieces(seconds, np.zeros_like(x0), np.arange(len(x0)), np.array([x0, x1]), np.array([y0, y1]),
                                   np.array([w0, w1]), grade, bank, travel)


def random_rows(generator, count):
    rows = generator.uniform((-1, -1, -1, -1, -1, -1, -0.1, -0.1, 0, 0.5), (1, 1, 1, 1, 1, 1, 0.1, 0.1, 6, 5), (count, 10))
    rows[::3, :3] = rows[::3, 3:6]
    rows[::5, [0, 1, 3, 4]] = 0
    rows[1::5, [2, 5]] = 0
    return rows


def test_the_model_is_the_cores(core):
    generator = np.random.default_rng(1)
    for _ in range(100):
        model = random_model(generator)
        rows = random_rows(generator, 20)
        expected = [core_energy(core, model, row) for row in rows]
        np.testing.assert_allclose(four_wheel_model.energies(model, pieces_of(rows)), expected, rtol=1e-4, atol=0.02)


def test_standing_takes_electronics_and_steering():
    model = random_model(np.random.default_rng(2))
    energy = four_wheel_model.energies(model, pieces_of([[0, 0, 0, 0, 0, 0, 0.1, 0.1, 3, 2]]))
    assert energy == pytest.approx([50 + 3 * model.steering])


def test_factors_scale_the_model():
    model = random_model(np.random.default_rng(3))
    scaled = model.scaled((1.1, 1.2, 0.9, 0.8))
    assert scaled.rolling == pytest.approx(1.1 * model.rolling)
    assert scaled.weight == pytest.approx(1.2 * model.weight)
    assert scaled.drag == pytest.approx(model.drag / 1.2)
    assert scaled.copper_driving == pytest.approx(1.44 * model.copper_driving)
    assert scaled.steering == pytest.approx(0.9 * model.steering)
    assert scaled.electronics_power == pytest.approx(0.8 * model.electronics_power)


def test_a_model_is_found_again(few_drives):
    numbers = identification.read_numbers(few_drives / "experiments.json", "patrol", four_wheel_identify.NUMBERS)
    start = four_wheel_identify.start_of(numbers)
    model = dataclasses.replace(start, rolling=0.03, drag=0.004, driving=1.6, braking=0.5, copper_driving=2000, steering=3,
                                contact=0.02, electronics_power=40)
    pieces = pieces_of(random_rows(np.random.default_rng(4), 400))
    pieces = dataclasses.replace(pieces, energy=four_wheel_model.energies(model, pieces))
    found = four_wheel_identify.fit_model(numbers, (pieces,))
    for name in ("rolling", "driving", "braking", "steering", "contact", "electronics_power"):
        assert getattr(found, name) == pytest.approx(getattr(model, name), rel=0.02), name


def test_deviations_are_those_of_the_ranges():
    draws = np.random.default_rng(5).uniform(0.7, 1.5, 1000000) - 1
    assert four_wheel_identify.deviations()[0] == pytest.approx(np.sqrt(np.mean(draws**2)), rel=0.01)


# ---- Bad input -------------------------------------------------------------------------------------------------------

def expect_refusal(directory, *words):
    assert_one_line_error(identify(directory), *words)


def test_few_drives_are_enough_for_a_table(copied):
    result = identify(copied)
    assert result.returncode == 0, result.stderr
    assert (copied / "four_wheel_energy_patrol.c").exists()


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
    cells[-2] = "0"
    lines[5] = ",".join(cells)
    (copied / "robots.csv").write_text("\n".join(lines) + "\n")
    expect_refusal(copied, "robots.csv", "seconds")


def test_numbers_that_are_missing_or_garbled(copied):
    path = copied / "experiments.json"
    numbers = json.loads(path.read_text())
    path.write_text(json.dumps({**numbers, "weight_n": "heavy"}))
    expect_refusal(copied, "experiments.json", "garbled")
    path.write_text(json.dumps({**numbers, "robot": "burger"}))
    expect_refusal(copied, "experiments.json", "burger")
    del numbers["weight_n"]
    path.write_text(json.dumps(numbers))
    expect_refusal(copied, "experiments.json", "weight_n")


def test_a_model_that_misses_is_not_written(copied):
    """Energies that no motion explains."""
    lines = (copied / "experiments.csv").read_text().splitlines()
    for i, line in enumerate(lines[1:], 1):
        cells = line.split(",")
        if cells[1] == str(four_wheel_identify.CHECK):
            cells[-1] = str(3 * float(cells[-1]))
        lines[i] = ",".join(cells)
    (copied / "experiments.csv").write_text("\n".join(lines) + "\n")
    result = identify(copied)
    assert result.returncode == 1
    assert "misses random motions" in result.stderr
    assert not (copied / "four_wheel_energy_patrol.c").exists()
