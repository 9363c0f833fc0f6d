"""learning.py: the committed tables are fresh; regressors and chains against the library's formulas; what it refuses."""
import json
import re
import zlib

import numpy as np
import pytest
from conftest import ROBOTS, ROOT, assert_one_line_error, robot_text, run_tool
from once import once

from tools.design import closed_loop, horizon, learning, robot_json

SUFFIXES = ("", "_battery")

# Another LAPACK rounds directions differently; of the largest number of a table.
TOLERANCE = 1e-4


@pytest.fixture(scope="module")
def courier24():
    return robot_json.from_text("courier24", robot_text("courier24"))


def make_tables(directory):
    for robot in ROBOTS:
        result = run_tool("design.learning", robot, "--robot-json", write_robot(directory, robot), "--tables",
                          directory)
        assert result.returncode == 0, result.stderr


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    """The tables of both robots, made anew."""
    return once(tmp_path_factory, "learning_tables", make_tables)


def write_robot(directory, robot, **groups):
    about = json.loads(robot_text(robot))
    for group, numbers in groups.items():
        about[group].update(numbers)
    path = directory / f"{robot}.json"
    path.write_text(json.dumps(about), encoding="utf-8")
    return path


def numbers_of(path):
    """All numbers but the identity."""
    text = path.read_text(encoding="utf-8")
    body = re.sub(r"/\*.*?\*/|\.identity = \d+U", "", text[text.index("= {"):], flags=re.S)
    return np.array([int(number) for number in re.findall(r"(?<![\w.])-?\d+", body)])


def member(path, name):
    return int(re.search(rf"\.{name} = (-?\d+)", path.read_text(encoding="utf-8"))[1])


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_committed_tables_are_fresh(robot, suffix, made):
    committed = numbers_of(ROOT / "src" / "tables" / f"learning_{robot}{suffix}.c")
    fresh = numbers_of(made / f"learning_{robot}{suffix}.c")
    assert len(committed) == 15 * 4 + 4 + 4 + 6
    assert np.abs(fresh - committed).max() <= TOLERANCE * np.abs(committed).max(), "run make learning"


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_identity_is_that_of_the_numbers(robot, suffix):
    path = ROOT / "src" / "tables" / f"learning_{robot}{suffix}.c"
    text = path.read_text(encoding="utf-8")
    rows = re.findall(r"^ {12}(\{.*?\}|-?\d+),", text, re.M)
    singles = [re.search(rf"\.{name} = (\d+U?)", text)[1] for name in (
        "ground_deviation", "payload_deviation", "noise_relative", "noise_transient", "noise", "memory")]
    assert member(path, "identity") == zlib.crc32(",".join([*rows, *singles]).encode())


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_symmetric_robot_has_symmetric_directions(robot, made):
    direction = numbers_of(made / f"learning_{robot}.c")[:60].reshape(15, 4)
    assert not direction[3:5].any()
    assert (direction[6] == direction[9]).all()
    assert (direction[7] == -direction[10]).all()
    assert (direction[8] == -direction[11]).all()


def segments_of(rows):
    columns = np.array(rows, float).T
    return learning.Segments(*columns[:4], np.arange(len(rows)) == 0)


def test_driving_agrees_with_the_horizon_tool(courier24):
    """Two ways through the linear loop: all segments at once here, one after the other there."""
    segments = segments_of([(0.7, 0.1, 0.5, 1.5), (0.2, -0.3, -1.0, 0.7), (0, 0, 0, 5), (1, 0, 0.3, 0.5)])
    resistance = courier24.positive("motor.resistance_ohm")
    for definition in horizon.SUFFIXES:
        axes = closed_loop.axes(courier24)
        energies, transients = learning.drive(axes, segments, definition, resistance)
        expected = np.zeros(len(segments))
        for axis, speed, turn in zip(axes, (segments.speed, segments.turn_rate), (0 * segments.turn, segments.turn)):
            chain = horizon.Chain(axis, closed_loop.energy(axis, definition, resistance))
            expected += [chain.drive(*step) for step in zip(speed, turn, segments.seconds)]
        assert energies == pytest.approx(expected, rel=1e-9, abs=1e-9)
        assert transients[0] != 0  # what the first segment leaves behind is not its own cost


def test_settled_segments_are_the_papers_formula(courier24):
    """Of segments that settle, regressors times some parameters are the energy."""
    generator = np.random.default_rng(2)
    segments = segments_of([(*generator.uniform((0, -0.35, -1.4, 40), (1, 0.35, 1.4, 60)),) for _ in range(200)])
    model = learning.read_built_in(ROOT / "src" / "tables" / "energy_courier24.c")
    energies, _ = learning.drive(closed_loop.axes(courier24), segments, closed_loop.MOTOR, model.motor_resistance)
    basis = learning.regressors(segments, model) @ learning.SYMMETRY
    predicted = basis @ np.linalg.lstsq(basis, energies, rcond=None)[0]
    assert np.abs(predicted - energies).max() < 1e-3 * energies.mean()


def test_x_of_the_population_is_standard_normal_by_its_moments(courier24):
    """Its second moments are what the learner starts from."""
    generator = np.random.default_rng(3)
    segments = learning.draw_segments(courier24, generator)
    axes = closed_loop.axes(courier24)
    model = learning.read_built_in(ROOT / "src" / "tables" / "energy_courier24.c")
    reference = learning.reference_of(courier24, axes, segments, closed_loop.MOTOR, model)
    true_x = generator.normal(size=(40, 10)) * 0.01
    changes = true_x @ (reference.regressors @ learning.SYMMETRY).T
    directions, x, shares = learning.find_directions(courier24, reference, changes)
    assert x.T @ x / 40 == pytest.approx(np.eye(4), abs=1e-9)
    assert (np.diff(shares) < 0).all()
    # The first direction explains more than any parameter alone.
    weighted = reference.regressors / reference.totals[:, None]
    left = changes / reference.totals - x @ (weighted @ directions).T
    assert np.linalg.norm(left) < 0.2 * np.linalg.norm(changes / reference.totals)


def test_noise_is_found_again(courier24):
    generator = np.random.default_rng(4)
    totals, transients = generator.uniform(5, 100, 2000), generator.normal(size=2000)
    reference = learning.Reference(totals, totals, transients, np.zeros((2000, 15)))
    deviations = np.sqrt(0.1**2 + (0.01 * totals)**2 + (0.5 * transients)**2)
    found = learning.fit_noise(reference, generator.normal(size=(50, 2000)) * deviations)
    assert found == pytest.approx([0.1, 0.01, 0.5], rel=0.05)


def test_bad_input_is_one_line(tmp_path):
    robot = write_robot(tmp_path, "courier24")
    assert_one_line_error(run_tool("design.learning", "courier24", "--robot-json", tmp_path / "none.json"), "none.json")
    assert_one_line_error(run_tool("design.learning", "courier24", "--robot-json", robot, "--models", tmp_path),
                          "energy_courier24.c")
    (tmp_path / "energy_courier24.c").write_text("nothing", encoding="utf-8")
    assert_one_line_error(run_tool("design.learning", "courier24", "--robot-json", robot, "--models", tmp_path),
                          "settling_time is missing", "make identify")


def test_a_robot_too_light_for_the_population_is_refused(tmp_path):
    robot = write_robot(tmp_path, "courier24", body={"mass_kg": 0.2})
    result = run_tool("design.learning", "courier24", "--robot-json", robot, "--tables", tmp_path)
    assert_one_line_error(result, "body.mass_kg")
    assert not list(tmp_path.glob("*.c"))
