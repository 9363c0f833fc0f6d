"""tools/design/skid_identify.py: the committed tables are fresh; its model and its learner are the core's; what it refuses."""
import ctypes
import dataclasses
import fcntl
import hashlib
import json
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, assert_one_line_error, run_tool

from tools.design import identification, skid_identify, skid_learning, skid_model

BUILD = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve()
JP_SKID_IDENTIFY = BUILD / "bin" / "jp-skid-identify"
TABLES = ROOT / "src" / "tables"
ROBOTS = sorted(path.stem.removeprefix("skid_energy_") for path in TABLES.glob("skid_energy_*.c"))

# Another libm may round the simulated robot's sines differently; the fits move by less than this share.
TOLERANCE = 1e-3

CORE = """
#include <joulepath/skid_learner.h>
int64_t energy_of(const struct jp_skid_energy_model *model, const struct jp_skid_piece *piece)
{
    struct jp_skid_drive drive = {0};
    return jp_skid_energy_add(model, &drive, piece) == JP_OK ? drive.energy : INT64_MIN;
}
static struct jp_skid_learner learner;
void start(const struct jp_skid_learning *learning, const struct jp_skid_energy_model *model)
{
    jp_skid_learner_start(&learner, learning, model);
}
/* Learns from a leg; energy and deviation of its forecast beforehand. */
int learn(const struct jp_skid_piece *pieces, int count, int32_t measured, struct jp_forecast *forecast)
{
    struct jp_skid_drive drive = {0};
    struct jp_forecast_sum sum = {0};
    enum jp_learned learned;
    for (int i = 0; i < count; i++) {
        (void)jp_skid_energy_add(&learner.model, &drive, &pieces[i]);
    }
    (void)jp_skid_forecast_add(&learner, &sum, &drive);
    (void)jp_skid_forecast_total(&learner, &sum, forecast);
    return (int)jp_skid_learner_update(&learner, &drive, measured, &learned);
}
"""


def integers(text):
    """The table's numbers but for its identity, which hangs on every bit of them."""
    body = re.sub(r"\.identity = .*", "", text[text.index("= {"):])
    return [int(number) for number in re.findall(r"(-?\d+)U?,\s*/\*", body)]


def numbers_of(directory):
    return identification.read_numbers(directory / "experiments.json", "zhang2018", skid_identify.NUMBERS)


def identify(robot, directory, tables=None):
    return run_tool("design.skid_identify", robot, "--experiments", directory, "--tables", tables or directory)


def drives_in(directory, robot):
    """Where the drives of a robot are: they follow from the program and the robot's file, and are made where these changed."""
    file = ROOT / "sim" / "robots" / f"{robot}.cfg"
    key = hashlib.sha256(JP_SKID_IDENTIFY.read_bytes() + file.read_bytes()).hexdigest()
    kept = directory / robot
    directory.mkdir(parents=True, exist_ok=True)
    with open(directory / f"{robot}.lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (kept / "key").exists() or (kept / "key").read_text() != key:
            (kept / "key").unlink(missing_ok=True)
            subprocess.run([JP_SKID_IDENTIFY, file, "--output", kept], check=True, capture_output=True)
            (kept / "key").write_text(key)
    return kept


@pytest.fixture(scope="session")
def drives():
    return lambda robot: drives_in(BUILD / "test-identify", robot)


@pytest.fixture(scope="session")
def few_drives(drives, tmp_path_factory):
    """All motions, but few robots."""
    whole, directory = drives("zhang2018"), tmp_path_factory.mktemp("few")
    for name in ("experiments.csv", "experiments.json"):
        (directory / name).write_bytes((whole / name).read_bytes())
    rows = (whole / "robots.csv").read_text().splitlines(keepends=True)
    few = skid_identify.FITTED_ROBOTS + 4
    (directory / "robots.csv").write_text("".join(rows[:1] + [row for row in rows[1:] if int(row.partition(",")[0]) < few]))
    return directory


@pytest.fixture
def copied(few_drives, tmp_path):
    for name in ("experiments.csv", "robots.csv", "experiments.json"):
        (tmp_path / name).write_bytes((few_drives / name).read_bytes())
    return tmp_path


def test_both_kinds_are_identified():
    assert {"burger", "zhang2018"} <= set(ROBOTS)


@pytest.mark.parametrize("robot", ROBOTS)
def test_committed_tables_are_fresh(robot, drives, tmp_path):
    result = identify(robot, drives(robot), tmp_path)
    assert result.returncode == 0, result.stderr
    for kind in ("energy", "learning"):
        name = f"skid_{kind}_{robot}.c"
        made = integers((tmp_path / name).read_text(encoding="utf-8"))
        committed = integers((TABLES / name).read_text(encoding="utf-8"))
        assert made == pytest.approx(committed, rel=TOLERANCE, abs=2), f"run make identify ROBOT={robot}"


# ---- The model -------------------------------------------------------------------------------------------------------

FIELDS = [field.name for field in dataclasses.fields(skid_model.Model)]
Q16 = {"weight", "copper_driving", "copper_braking", "electronics_power"}


@pytest.fixture(scope="module")
def core(tmp_path_factory):
    directory = tmp_path_factory.mktemp("core")
    (directory / "core.c").write_text(CORE)
    sources = [ROOT / "src" / name for name in ("energy/skid_energy.c", "energy/energy.c", "base/fixed.c",
                                                "base/config_check.c", "learn/skid_learner.c", "learn/factor_learning.c", "learn/learned_state.c",
                                                "learn/learner_filter.c", "learn/forecast_sum.c")]
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


def test_the_learner_is_the_cores(core, few_drives):
    """What both say of the legs of a robot before they learn from them."""
    run, phase, pieces = skid_identify.read_table(few_drives / "robots.csv")
    numbers = numbers_of(few_drives)
    model, noise = skid_identify.start_of(numbers), skid_learning.Noise(np.array((5, 0.02, 0.05)), 1.5)
    legs = skid_learning.legs_of(run[run == 0], phase[run == 0], pieces.chosen(run == 0))
    learner = skid_learning.Learner(model, noise, 1)
    fixed = [round(getattr(model, name) * 2**(16 if name in Q16 else 24)) for name in FIELDS]
    constant, by_energy, by_slopes = noise.parts
    factors = [round(value * 2**16) for value in (*skid_learning.deviations(), by_energy, constant, noise.spread)]
    in_c = ((ctypes.c_int32 * 18)(*fixed, 0),
            (ctypes.c_int32 * 10)(*factors, identification.MEMORY, 1, round(by_slopes * 2**16)))
    core.start(in_c[1], in_c[0])
    for leg in range(legs.shape[1]):
        column = legs.column(leg)
        one = column.pieces
        rows = np.array([one.speed[0], one.turn_rate[0], one.speed[1], one.turn_rate[1], one.grade, one.bank, one.seconds])
        members = np.round(rows.T * 2.0**np.array((24, 24, 24, 24, 24, 24, 16))).astype(np.int32).ravel()
        forecast = (ctypes.c_int32 * 2)()
        energy, gradient, variance = learner.expect(column)
        deviation = np.sqrt(variance[0, 0] + np.sum((gradient[0, 0] @ learner.root[0])**2))
        measured = round(column.measured[0, 0] * 2**16)
        assert core.learn((ctypes.c_int32 * len(members))(*members), len(one.seconds), measured, forecast) == 0
        assert np.array(forecast) / 2**16 == pytest.approx((energy[0, 0], deviation), rel=0.02)
        learner.update(column, np.array([True]))


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
    return skid_model.Pieces(seconds, np.zeros_like(v0), np.arange(len(v0)), np.array([v0, v1]), np.array([w0, w1]), grade, bank)


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
    numbers = numbers_of(few_drives)
    start = skid_identify.start_of(numbers)
    model = dataclasses.replace(start, half_track=0.5, rolling=0.05, turning=0.3, yielding=0.4, scrub=0.3, easing=0.8,
                                bank_easing=1.2, tilting=0.4, driving=1.4, braking=0.3, electronics_power=12.0)
    generator = np.random.default_rng(4)
    usual = synthetic(numbers, model, generator)
    robots = synthetic(numbers, model.scaled((1.2, 0.9, 1.1, 1)), generator)
    legs = skid_learning.Legs(robots, np.zeros(300, int), np.arange(300), np.zeros(300, int), (1, 300))
    found = skid_identify.fit_model(numbers, (usual,), legs)
    for name in skid_identify.FITTED:
        assert getattr(found, name) == pytest.approx(getattr(model, name), rel=0.02), name


def test_deviations_are_those_of_the_ranges():
    draws = np.random.default_rng(5).uniform(0.7, 1.5, 1000000) - 1
    assert skid_learning.deviations()[0] == pytest.approx(np.sqrt(np.mean(draws**2)), rel=0.01)


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


def test_too_few_robots(copied):
    rows = (copied / "robots.csv").read_text().splitlines()
    (copied / "robots.csv").write_text("\n".join(row for row in rows if row.partition(",")[0] in ("run", "0", "1")) + "\n")
    expect_refusal(copied, "robots.csv", f"more than {skid_identify.FITTED_ROBOTS}")


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
