"""tools/design/identify.py: recovery of known parameters of both energies, reports, bad input."""
import json

import numpy as np
import pytest
from conftest import assert_one_line_error, assert_verdict, robot_text, run_tool

from tools.design import identify, linear_model, robot_json

A = np.array([172.2, 7.57, 13.2, -0.66, -0.94, 1.37, 16.26, -4.39, -1.11, 15.97, 4.27, 1.09, 5.82])
B = np.array([20.83, 0.93])
SETTLING, SEGMENT, LAST, SEED = 5.82, 10.0, 1.0, 7
ABOUT = {"robot": "gao2018", "settling_time_s": SETTLING, "segment_s": SEGMENT, "last_s": LAST, "seed": SEED}


def synthetic(robot, count=1000, noise=0.0, seed=3, voltages=None, energy="motor"):
    """Experiments whose energy obeys the model with parameters A and B, steady voltages cv and cw (default: the robot's), and
    noise (J, rms)."""
    generator = np.random.default_rng(seed)
    c = {
        "v1_m_s": generator.uniform(0, 1, count), "w1_rad_s": generator.uniform(-0.35, 0.35, count),
        "turn1_rad": generator.uniform(-1.4, 1.4, count), "v2_m_s": generator.uniform(0, 1, count),
        "w2_rad_s": generator.uniform(-0.35, 0.35, count), "turn2_rad": generator.uniform(-1.4, 1.4, count),
    }
    left, right = identify.predicted_voltages(robot, c)
    c["u_left_before_v"], c["u_right_before_v"] = left + 0.002, right - 0.001
    c["settling_s"] = np.full(count, SETTLING)
    before = identify.voltages_before(c, *voltages) if voltages else (left, right)
    state = identify.state_regressors(c, *before, robot.number("motor.resistance_ohm"))
    c[f"{energy}_state_j"] = state @ A + noise * generator.standard_normal(count)
    c[f"{energy}_steady_j"] = identify.steady_regressors(c, SEGMENT - SETTLING) @ B + noise * generator.standard_normal(count)
    c[f"{energy}_last_j"] = identify.steady_regressors(c, LAST) @ B + noise * generator.standard_normal(count)
    c[f"{energy}_total_j"] = c[f"{energy}_state_j"] + c[f"{energy}_steady_j"]
    return c


def write(directory, columns, about=ABOUT):
    directory.mkdir(parents=True, exist_ok=True)
    rows = [",".join(columns)] + [",".join(repr(float(x)) for x in row) for row in zip(*columns.values())]
    (directory / "experiments.csv").write_text("\n".join(rows) + "\n")
    (directory / "experiments.json").write_text(json.dumps(about))


@pytest.fixture
def place(tmp_path):
    """A directory with good experiments, and the tool's arguments for it."""
    source = tmp_path / "robot.json"
    source.write_text(robot_text("gao2018"))
    robot = robot_json.load_json(source)
    columns = synthetic(robot)
    # The paper's parameters allow negative energies where a start with σ and ul− nearly cancels; keep physical ones.
    keep = columns["motor_total_j"] > 1
    columns = {name: values[keep] for name, values in columns.items()}
    write(tmp_path / "experiments", columns)
    arguments = ("gao2018", "--robot-json", source, "--experiments", tmp_path / "experiments", "--tables",
                 tmp_path / "tables")
    return tmp_path, arguments, columns


def test_known_parameters_are_recovered(place):
    directory, arguments, _ = place
    result = run_tool("design.identify", *arguments, "--bench", directory / "bench.json")
    assert result.returncode == 0, result.stderr
    found = json.loads((directory / "experiments/identification.json").read_text())
    values = [parameter["value"] for parameter in found["parameters"]]
    assert np.allclose(values, [*A, *B], atol=1e-6)
    assert found["validation"]["max_absolute_error_j"] < 1e-6
    assert found["max_steady_voltage_difference_v"] == pytest.approx(0.002, abs=1e-9)
    assert found["fit"]["experiments"] + found["validation"]["experiments"] == len(place[2]["motor_total_j"])
    assert (directory / "experiments/identification.png").read_bytes().startswith(b"\x89PNG")

    table = (directory / "tables/energy_gao2018.c").read_text()
    assert "const struct jp_energy_model jp_energy_model_gao2018 = {" in table
    assert f"{round(172.2 * 65536)}, /* a1: 172.2 J·s²/m² */" in table
    assert ".settling_time = 381420," in table
    bench = json.loads((directory / "bench.json").read_text())
    assert [figure["unit"] for figure in bench] == ["%", "J"]


@pytest.mark.parametrize("noise, accepted", [(0.3, True), (8.0, False)])
def test_a_model_that_misses_the_validation_is_refused(place, noise, accepted):
    directory, arguments, columns = place
    disturbed = columns["motor_total_j"] * (1 + noise / 100 * np.random.default_rng(5).choice([-1, 1], len(columns["v1_m_s"])))
    write(directory / "experiments", {**columns, "motor_total_j": disturbed})
    result = run_tool("design.identify", *arguments)
    if accepted:
        assert result.returncode == 0, result.stderr
        return
    assert_verdict(result, "experiments.csv", "on average, at most 3 %", "make gains ROBOT=gao2018")
    assert not (directory / "tables").exists()
    assert sorted(path.name for path in (directory / "experiments").iterdir()) == ["experiments.csv", "experiments.json",
                                                                                   "identification.png"]


def test_noise_shows_in_the_validation_error(gao2018):
    columns = synthetic(gao2018, noise=0.5)
    columns["motor_total_j"] = np.maximum(columns["motor_total_j"], 1)
    experiments = identify.Experiments("test", columns, SETTLING, SEGMENT, LAST, SEED)
    result = identify.identify(gao2018, experiments)
    # Two noises of 0.5 J rms: mean |error| √2·0.5·√(2/π).
    assert result.validation.summary()["mean_absolute_error_j"] == pytest.approx(0.564, rel=0.15)
    assert np.abs(np.array(result.model.a) - A)[[0, 6, 12]].max() < 2


def test_equal_seeds_give_equal_bytes(place):
    directory, arguments, _ = place
    files = [directory / "tables/energy_gao2018.c", directory / "experiments/identification.json",
             directory / "experiments/identification.png"]
    assert run_tool("design.identify", *arguments).returncode == 0
    first = [path.read_bytes() for path in files]
    assert run_tool("design.identify", *arguments).returncode == 0
    assert [path.read_bytes() for path in files] == first


def test_linear_prediction_is_recovered_too(gao2018):
    """The regressors of identify and the linear model's parameters mean the same."""
    loop = linear_model.design(gao2018)
    model = linear_model.linear_energy_model(gao2018, loop, SETTLING)
    columns = synthetic(gao2018)
    left, right = identify.predicted_voltages(gao2018, columns)
    state = identify.state_regressors(columns, left, right, model.motor_resistance)
    columns["motor_state_j"] = state @ np.array(model.a)
    columns["motor_steady_j"] = identify.steady_regressors(columns, SEGMENT - SETTLING) @ np.array(model.b)
    columns["motor_last_j"] = identify.steady_regressors(columns, LAST) @ np.array(model.b)
    columns["motor_total_j"] = columns["motor_state_j"] + columns["motor_steady_j"]
    assert columns["motor_total_j"].min() > 0
    result = identify.identify(gao2018, identify.Experiments("test", columns, SETTLING, SEGMENT, LAST, SEED))
    assert np.allclose(result.model.a, model.a, atol=1e-6)


# ---- energy of the battery -----------------------------------------------------------------------------------------

@pytest.fixture
def battery_place(place, gao2018):
    """Experiments whose steady power is not u²/Rm of the robot's voltages, but b1 v² + b2 w²."""
    directory, arguments, _ = place
    columns = synthetic(gao2018, voltages=identify.effective_voltages(B, gao2018.number("motor.resistance_ohm")),
                        energy="battery")
    keep = columns["battery_total_j"] > 1
    columns = {name: values[keep] for name, values in columns.items()}
    write(directory / "experiments", columns)
    return directory, (*arguments, "--energy", "battery")


def test_effective_voltages_give_the_steady_power(gao2018):
    resistance = gao2018.number("motor.resistance_ohm")
    per_speed, per_turn_rate = identify.effective_voltages(np.array([13.0, 0.4]), resistance)
    columns = {"v1_m_s": np.array([0.7]), "w1_rad_s": np.array([-0.3])}
    left, right = identify.voltages_before(columns, per_speed, per_turn_rate)
    assert (left**2 + right**2) / resistance == pytest.approx(13 * 0.7**2 + 0.4 * 0.3**2)


def test_battery_model_is_recovered_with_effective_voltages(battery_place, gao2018):
    directory, arguments = battery_place
    result = run_tool("design.identify", *arguments, "--bench", directory / "bench.json")
    assert result.returncode == 0, result.stderr
    found = json.loads((directory / "experiments/identification_battery.json").read_text())
    assert found["energy"] == "battery"
    assert np.allclose([parameter["value"] for parameter in found["parameters"]], [*A, *B], atol=1e-6)
    assert {parameter["published"] for parameter in found["parameters"]} == {None}
    assert found["validation"]["max_absolute_error_j"] < 1e-6
    # Still that of the robot's own voltages.
    assert found["max_steady_voltage_difference_v"] == pytest.approx(0.002, abs=1e-9)
    assert "as published" not in result.stdout

    assert not (directory / "tables/energy_gao2018.c").exists()
    table = (directory / "tables/energy_gao2018_battery.c").read_text()
    assert "const struct jp_energy_model jp_energy_model_gao2018_battery = {" in table
    assert "effective" in table and "2 cv²/Rm = b1" in table
    resistance = gao2018.number("motor.resistance_ohm")
    for name, b in (("voltage_per_speed", B[0]), ("voltage_per_turn_rate", B[1])):
        assert f".{name} = {round((b * resistance / 2)**0.5 * 65536)}," in table
    names = [figure["name"] for figure in json.loads((directory / "bench.json").read_text())]
    assert names == ["battery energy model of gao2018, mean error", "battery energy model of gao2018, largest error"]


def test_experiments_without_that_energy_are_refused(place, battery_place):
    _, arguments, columns = place
    directory, battery_arguments = battery_place
    assert_one_line_error(run_tool("design.identify", *arguments), "experiments.csv", "motor_state_j is missing")
    write(directory / "experiments", columns)
    assert_one_line_error(run_tool("design.identify", *battery_arguments), "experiments.csv", "battery_state_j")
    assert not (directory / "tables").exists()


def test_energy_is_one_of_two(place):
    result = run_tool("design.identify", *place[1], "--energy", "heat")
    assert result.returncode == 2
    assert "heat" in result.stderr


# ---- bad input -----------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("column, value, part", [
    ("w1_rad_s", 0.0, "rank"),
    ("turn2_rad", 0.0, "σ"),
    ("motor_total_j", -1.0, "total_j"),
])
def test_experiments_that_cannot_identify_are_refused(place, column, value, part):
    directory, arguments, columns = place
    columns[column] = np.full_like(columns[column], value)
    write(directory / "experiments", columns)
    assert_one_line_error(run_tool("design.identify", *arguments), "experiments.csv", part)
    assert not (directory / "tables").exists()


@pytest.mark.parametrize("damage, part", [
    (lambda text: text.replace("v2_m_s", "v3_m_s", 1), "v2_m_s"),
    (lambda text: text[:-40], "line"),
    (lambda text: "\n".join(text.splitlines()[:20]), "at least"),
    (lambda text: text.replace("\n0.", "\nnan,0.", 1), "line"),
    (lambda text: "", "line 1"),
])
def test_garbled_experiments_are_refused(place, damage, part):
    directory, arguments, _ = place
    path = directory / "experiments/experiments.csv"
    path.write_text(damage(path.read_text()))
    assert_one_line_error(run_tool("design.identify", *arguments), "experiments.csv", part)
    assert not (directory / "tables").exists()


@pytest.mark.parametrize("about, part", [
    ({"robot": "courier24"}, "robot"),
    ({"settling_time_s": 12}, "settling_time_s"),
    ({"last_s": 10}, "last_s"),
    ({"settling_time_s": "x"}, "garbled"),
])
def test_garbled_description_is_refused(place, about, part):
    directory, arguments, columns = place
    write(directory / "experiments", columns, ABOUT | about)
    assert_one_line_error(run_tool("design.identify", *arguments), "experiments.json", part)


@pytest.mark.parametrize("key", ["robot", "settling_time_s", "segment_s", "last_s", "seed"])
def test_description_without_a_key_is_refused(place, key):
    directory, arguments, columns = place
    write(directory / "experiments", columns, {name: value for name, value in ABOUT.items() if name != key})
    assert_one_line_error(run_tool("design.identify", *arguments), "experiments.json", key)


def test_missing_experiments_are_named(place):
    directory, arguments, _ = place
    (directory / "experiments/experiments.json").unlink()
    assert_one_line_error(run_tool("design.identify", *arguments), "experiments.json")
