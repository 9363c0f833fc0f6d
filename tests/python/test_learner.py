"""The learner: what it is taught it forecasts, with less and less doubt; its state outlives it."""
import struct

import numpy
import pytest
from joulepath import Error, Learner, Segment

RANDOM = numpy.random.default_rng(22)
ROBOT = "courier24"


def segments(count):
    return [Segment(*(RANDOM.uniform(low, high) for low, high in ((0.2, 0.9), (-0.5, 0.5), (-1, 1), (6, 12))))
            for _ in range(count)]


def each(learner, driven):
    """J of each segment, as it is forecast."""
    sums = [0.0, *(learner.forecast(driven[:count + 1])[0] for count in range(len(driven)))]
    return numpy.diff(sums)


def another_robot(x):
    """One that differs from the robot of the file along the directions in which robots of its kind do."""
    learner = Learner(ROBOT)
    state = bytearray(learner.state)
    state[:16] = struct.pack("<4i", *(round(value * (1 << 24)) for value in x))
    learner.restore(bytes(state))
    return learner


def teach(learner, robot, count):
    driven = segments(count)
    return learner.learn(driven, each(robot, driven))


def test_a_robot_that_differs_is_learned():
    robot, learner, route = another_robot((1.0, -0.5, 0.3, 0)), Learner(ROBOT), segments(5)
    built_in, doubt = learner.forecast(route)
    for _ in range(4):
        teach(learner, robot, 10)
    (joules, less_doubt), (truth, _) = learner.forecast(route), robot.forecast(route)
    assert abs(joules - truth) < 0.1 * abs(built_in - truth) and less_doubt < doubt / 2
    assert learner.coordinates[0] == pytest.approx(1, abs=0.2)
    assert learner.ground[0] == pytest.approx(robot.ground[0], abs=2 * learner.ground[1])
    assert learner.changes == (0, None)


def test_what_is_as_expected_changes_nothing():
    learner = Learner(ROBOT)
    before = learner.parameters
    teach(learner, Learner(ROBOT), 10)
    assert learner.parameters == pytest.approx(before, rel=0.02, abs=0.02) and before.shape == (15,)
    assert learner.payload_kg[0] == pytest.approx(0, abs=learner.payload_kg[1])


def test_a_state_goes_on_where_it_ended():
    learner, other = Learner(ROBOT), Learner(ROBOT)
    teach(learner, another_robot((1, 0, 0, 0)), 10)
    other.restore(learner.state)
    route = segments(3)
    assert other.forecast(route) == learner.forecast(route) != Learner(ROBOT).forecast(route)
    with pytest.raises(Error, match="identity is out of range, or of other tables"):
        Learner(ROBOT, "battery").restore(learner.state)


def test_an_outlier_is_counted():
    driven = segments(1)
    assert Learner(ROBOT).learn(driven, 3 * each(Learner(ROBOT), driven)) == 1


def test_doubt_of_a_route_grows_with_it():
    learner, route = Learner(ROBOT), segments(6)
    deviations = [learner.forecast(route[:count])[1] for count in (1, 3, 6)]
    assert 0 < deviations[0] < deviations[1] < deviations[2]


@pytest.mark.parametrize("make, says", [
    (lambda: Learner("nobody"), "nobody: no tables to learn with"),
    (lambda: Learner("burger"), "burger: no tables to learn with"),
    (lambda: Learner(ROBOT, "solar"), "energy: 'solar' is none of"),
    (lambda: Learner(ROBOT).forecast([(99, 0, 0, 10)]), "segment: out of range"),
    (lambda: Learner(ROBOT).forecast([(999, 0, 0, 10)]), "out of range"),
    (lambda: Learner(ROBOT).learn(segments(1), [1e12]), "joules: 1e\\+12 is more than"),
    (lambda: Learner(ROBOT).learn(segments(2), [1]), "shorter"),
    (lambda: Learner(ROBOT).restore(b"x"), "state: 1 bytes")])
def test_what_is_wrong_is_said(make, says):
    with pytest.raises(ValueError, match=says):
        make()
