"""learning.py: the committed tables are fresh; regressors and chains against the library's formulas; what it refuses."""
import json
import math
import re
import zlib
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import ROBOTS, ROOT, assert_one_line_error, robot_text, run_tool
from once import once

from tools.common import ToolError, Verdict
from tools.design import closed_loop, horizon, learning, learning_legs, robot_json

SUFFIXES = ("", "_battery")

# Another LAPACK rounds directions differently; of the largest number of a table.
TOLERANCE = 1e-4


@pytest.fixture(scope="module")
def courier24():
    return robot_json.from_text("courier24", robot_text("courier24"))


@pytest.fixture
def made(robot, tmp_path_factory):
    """The robot's tables, made anew."""
    def make_tables(directory):
        result = run_tool("design.learning", robot, "--robot-json", write_robot(directory, robot), "--tables", directory)
        assert result.returncode == 0, result.stderr

    return once(tmp_path_factory, f"learning_tables_{robot}", make_tables)


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
    assert len(committed) == 15 * 4 + 4 + 4 + 5 + 3 * 4 + 4 + 1
    assert np.abs(fresh - committed).max() <= TOLERANCE * np.abs(committed).max(), "run make learning"


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_identity_is_that_of_the_numbers(robot, suffix):
    path = ROOT / "src" / "tables" / f"learning_{robot}{suffix}.c"
    text = path.read_text(encoding="utf-8")
    rows = re.findall(r"^ {12}(\{.*?\}|-?\d+),", text, re.M)
    legs = rows[-learning_legs.TRANSIENTS:]

    def singles(*names):
        return [re.search(rf"\.{name} = (\d+U?)", text)[1] for name in names]

    numbers = [*rows[:-len(legs)], *singles("ground_deviation", "payload_deviation", "noise_relative", "noise_transient",
                                            "noise"),
               *legs, *singles("leg_noise_relative", "leg_noise_transient", "leg_noise", "leg_spread", "memory")]
    assert member(path, "identity") == zlib.crc32(",".join(numbers).encode())


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
            expected += [sum(chain.drive(*step)) for step in zip(speed, turn, segments.seconds)]
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
    deviations = np.sqrt(0.1**2 + (0.01 * totals)**2 + (0.5 * transients)**2)
    squares = np.mean((generator.normal(size=(50, 2000)) * deviations)**2, axis=0)
    found = learning.fit_noise(totals, transients, squares)
    assert found == pytest.approx([0.1, 0.01, 0.5], rel=0.05)


STEADY = np.array([[0.9, -0.3, 0.01, 0.0], [0.2, 0.25, 0.02, -0.02]])  # of b1 and b2
ROWS = 0.5 * np.array([[1, -1], [2, 1], [0.5, 1.5]]) @ np.linalg.svd(STEADY)[2][2:]


def legs_of(robots, seed):
    """24 legs to learn on and 12 to forecast of each; the first and last of a route change the speed."""
    generator = np.random.default_rng(seed)
    count = 36 * robots
    is_end = np.isin(np.arange(count) % 36, [0, 23, 24, 35])[:, None]
    transients = np.column_stack([generator.normal(0, 2, count), generator.uniform(0.5, 2, count),
                                  generator.normal(0, 0.2, count)]) * np.where(is_end, 1, [0, 0, 1])
    legs = learning_legs.Legs(np.arange(count) // 36, [None] * robots, np.arange(count) % 36 >= 24,
                              generator.uniform((1, 0.1), (6, 1.5), (count, 2)), transients, generator.uniform(30, 150, count), np.zeros(count))
    return legs, generator


def test_what_legs_teach_is_found_again():
    legs, generator = legs_of(200, 5)
    x = generator.normal(size=(200, 4))
    changes = np.einsum("ij,ij->i", legs.steady @ STEADY + legs.transients @ ROWS, x[legs.robot])
    legs.measured[:] = legs.expected + changes + generator.normal(0, 0.03, len(changes))
    directions = np.vstack([np.zeros((13, 4)), STEADY])
    lesson = learning_legs.learn(legs, directions, x, learning.MEMORY, learning.fit_noise)
    assert lesson.rows == pytest.approx(ROWS, abs=0.15)
    assert np.corrcoef(lesson.taught[:, 0], x[:, 0])[0, 1] > 0.9
    assert lesson.rows @ STEADY.T == pytest.approx(0, abs=1e-9)  # b1 and b2 keep their directions
    assert 0.5 * 0.03 < math.hypot(lesson.noise[0], lesson.noise[1] * legs.expected.mean()) < 1.1 * 0.03
    assert 1 <= lesson.spread < 2


def test_forecasts_are_as_far_off_as_they_say():
    legs, generator = legs_of(100, 6)
    sensitivity = legs.steady @ STEADY + legs.transients @ ROWS
    x = generator.normal(size=(100, 4))
    changes = np.einsum("ij,ij->i", sensitivity, x[legs.robot]) + generator.normal(0, 0.05, len(legs.expected))
    deviations = np.full(len(legs.expected), 0.02)
    factor, surprises = learning_legs.calibrated(legs, changes, sensitivity, deviations, learning.MEMORY)
    assert 1.5 < factor < 3.5 and learning_legs.spread_of(factor) == 1
    assert np.mean(np.square(surprises)) == pytest.approx(1, abs=0.05)


def test_legs_that_make_up_for_each_other_have_a_spread():
    legs, generator = legs_of(100, 7)
    sensitivity = legs.steady @ STEADY + legs.transients @ ROWS
    x = generator.normal(size=(100, 4))
    # What each leg takes too much, the next of a pair takes too little.
    turns = generator.normal(0, 0.1, len(legs.expected) // 2)
    changes = np.einsum("ij,ij->i", sensitivity, x[legs.robot]) + np.ravel(np.column_stack([turns, -turns]))
    factor, surprises = learning_legs.calibrated(legs, changes, sensitivity, np.full(len(changes), 0.1), learning.MEMORY)
    assert 1.5 < learning_legs.spread_of(factor) <= learning_legs.SPREAD_MAX
    assert np.mean(np.square(surprises)) < 1.3


def test_more_than_can_be_learned_is_a_verdict():
    robot = SimpleNamespace(source="x.cfg")
    learning.check_quality(robot, "motor", SimpleNamespace(chain=np.array([0.02, 0.04])))
    with pytest.raises(Verdict, match="x.cfg: limits: .* by 3.5 % when all is learned, .*; a smaller limits.payload_kg"):
        learning.check_quality(robot, "motor", SimpleNamespace(chain=np.array([0.03, 0.04])))


def test_what_is_not_legs_is_one_line(tmp_path):
    with pytest.raises(ToolError, match="not the legs of jp-trip --legs"):
        learning_legs.read("a,b\n1,2\n", "here")
    with pytest.raises(ToolError, match="no legs"):
        learning_legs.read("", "here")
    with pytest.raises(ToolError, match="run make"):
        learning_legs.drive(tmp_path / "none", "courier24", "motor")
    with pytest.raises(ToolError, match="none.cfg"):
        learning_legs.drive(robot_json.build_directory() / "bin" / "jp-trip", tmp_path / "none.cfg", "motor")


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
