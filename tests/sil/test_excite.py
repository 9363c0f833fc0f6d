"""Routes of tools.operate.excite as an operator drives them, jp-ecu and jp-plant being processes, in simulated time."""
import pytest
from programs import BIN, ROOT, Programs, write_scenario
from simulated_time import Host

from tools.operate import excite
from tools.operate.can_client import Operator

COURIER = ROOT / "sim/robots/courier24.cfg"
SPACE = excite.Space(0.75, 0.75)
NAME = "short steps"


@pytest.fixture(name="programs")
def fixture_programs(tmp_path):
    with Programs(tmp_path) as programs:
        yield programs


def test_a_robot_stays_where_the_trial_had_it(programs, tmp_path, monkeypatch):
    monkeypatch.setattr(excite, "STAND", 0.5)
    monkeypatch.setattr(excite, "SETTLE", 1.0)
    route, _ = excite.fitted(BIN / "jp-plant", COURIER, SPACE, NAME, excite.Pose(0.0, 0.0, 0.0))
    places = []

    def watch(state):
        if "Pose" in state.latest:
            places.append((state.get("Pose", "X"), state.get("Pose", "Y")))
    with Host(programs, write_scenario(tmp_path / "host.cfg", (1.0, 0.0), robot="courier24")) as host:
        host.start_ecu("--robot", "courier24")
        excite.command(Operator(host.bus, "robot", excite.Guard(watch, SPACE, "robot"), host.time.clock), [route])
        host.stop()
    reach = [max(abs(place[axis]) for place in places) for axis in (0, 1)]
    assert reach == pytest.approx(route.reach, abs=0.05)
    assert all(abs(place) < 0.2 for place in places[-1])
