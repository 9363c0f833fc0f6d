"""LCM: a drive that is watched live and logged, reports from logs, and what is wrong with either.

The drive runs in a network namespace of its own, with multicast on its loopback.
"""
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import ROOT, assert_one_line_error, run_tool, sketched

import lcm

from tools.identify import log_lcm

BUILD = Path(os.environ.get("JP_BUILD", ROOT / "build")).resolve()
LIMIT = 1800  # s, for what takes seconds on an idle machine
JP_LCM = BUILD / "bin" / "jp-lcm"
URL = "udpm://239.255.76.67:7667?ttl=0"
MULTICAST = "ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo"
POINTS = ((0.8, 0.1), (1.5, 0.6))
RESULTS = ("summary.json", "log_cruise.csv")

sys.path.insert(0, str(BUILD / "lcm"))
import jp  # noqa: E402


def in_namespace(network, *command, timeout=LIMIT):
    """Run a command where `network`, a shell command, has set up a network that nobody else sees."""
    return subprocess.run(["unshare", "-rn", "sh", "-c", f'{network} && exec "$@"', "sh", *map(str, command)],
                          capture_output=True, text=True, timeout=timeout, check=False)


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """The folder of a drive that was watched, and how its processes ended."""
    folder = tmp_path_factory.mktemp("drive")
    result = in_namespace(MULTICAST, sys.executable, ROOT / "tests" / "tools" / "lcm_drive.py", folder,
                          *(f"{x},{y}" for x, y in POINTS))
    said = "".join(f"--- {path.name}\n{path.read_text()}" for path in sorted(folder.glob("*.err")))
    assert result.returncode == 0, result.stdout + result.stderr + said
    return folder


def test_all_programs_end_well(drive):
    codes = json.loads((drive / "drive.json").read_text())
    assert codes == dict.fromkeys(("live", "jp-lcm", "lcm-logger", "jp-plant", "jp-ecu"), 0)


def test_the_route_is_driven(drive):
    summary = json.loads((drive / "live" / "summary.json").read_text())
    segments = summary["strategies"][0]["segments"]
    assert len(segments) == len(POINTS)
    for segment, point in zip(segments, POINTS):
        assert segment["target_m"] == pytest.approx(point, abs=2 ** -16)
        assert abs(segment["error_percent"]) < 5
        assert segment["end_error_m"] < 0.3
    assert summary["waypoints_m"][0] == pytest.approx([0, 0], abs=0.01)


def test_a_log_gives_the_files_of_the_live_run(drive, tmp_path):
    result = run_tool("operate.lcm_report", drive / "drive.lcm", tmp_path)
    assert result.returncode is None or result.returncode == 0, result.stderr
    for name in RESULTS:
        assert (tmp_path / name).read_bytes() == (drive / "live" / name).read_bytes()


@sketched
def test_a_page_is_made_of_them(drive, tmp_path):
    for folder in ("from_log", "from_live"):
        (tmp_path / folder).mkdir()
    run_tool("operate.lcm_report", drive / "drive.lcm", tmp_path / "from_log")
    for name in RESULTS:
        (tmp_path / "from_live" / name).write_bytes((drive / "live" / name).read_bytes())
    for folder in ("from_log", "from_live"):
        result = run_tool("report.report", tmp_path / folder)
        assert not result.returncode, result.stderr
    page = (tmp_path / "from_log" / "report.html").read_bytes()
    assert page.count(b"data:image/png") == 7
    assert page == (tmp_path / "from_live" / "report.html").read_bytes()


def test_rubbish_is_named_and_disturbs_nothing(drive):
    errors = (drive / "jp-lcm.err").read_text().splitlines()
    for part in ("fingerprint", "cut off", "not a finite number", "not within 512 m", "1 to 32 points"):
        assert sum(part in line for line in errors) == 1, errors
    assert "LCM packets dropped                         9" in (drive / "jp-lcm.out").read_text()
    assert "1 messages were not of their type" in (drive / "live.err").read_text()


def test_a_gateway_that_is_stopped_stops_the_robot(drive):
    """On its way to the goal: jp-lcm says Stand and hears that it was obeyed before it goes."""
    states = list(messages(drive / "drive.lcm", "JP_STATE", jp.state_t))
    driving = [state for state in states if state.task == jp.state_t.TASK_DRIVING and state.route_length == 1]
    assert any(state.robot_state == 2 and state.speed > 0.05 for state in driving)
    assert (states[-1].route_state, states[-1].route_reason) == (6, 5)  # Stopped, Command
    assert states[-1].task == jp.state_t.TASK_IDLE


def events(path):
    log = lcm.EventLog(str(path), "r")
    yield from log
    log.close()


def messages(path, channel, message_type):
    for event in events(path):
        if event.channel == channel and event.data != b"not a state":
            yield message_type.decode(event.data)


def test_a_log_can_be_identified_from(drive, gao2018):
    log = log_lcm.read(drive / "drive.lcm", gao2018)
    log.check()
    assert log.has("current_left", "reference_speed", "battery_current", "drawn") and log.left_out == 1
    summary = json.loads((drive / "live" / "summary.json").read_text())
    segments = summary["strategies"][0]["segments"]
    assert [one.spent for one in log.segments] == pytest.approx([one["measured_energy_j"] for one in segments])
    assert [one.end - one.begin for one in log.segments] == pytest.approx([one["duration_s"] for one in segments], abs=0.1)


def test_messages_come_50_times_a_second(drive):
    for channel, message_type, extra in (("JP_STATE", jp.state_t, 0), ("JP_ENERGY", jp.energy_t, len(POINTS))):
        times = [message.utime for message in messages(drive / "drive.lcm", channel, message_type)]
        seconds = (times[-1] - times[0]) / 1e6
        assert seconds > 5
        assert len(times) - 1 == pytest.approx(50 * seconds + extra, abs=3)
        assert all(before <= after for before, after in zip(times, times[1:]))  # a busy machine sends two at once


def test_energy_plan_and_identification_agree(drive):
    plan = [plan for plan in messages(drive / "drive.lcm", "JP_PLAN", jp.plan_t) if plan.segment_count == 2][-1]
    energy = [energy for energy in messages(drive / "drive.lcm", "JP_ENERGY", jp.energy_t) if energy.segment == 2][-1]
    identification = [identification
                      for identification in messages(drive / "drive.lcm", "JP_IDENTIFICATION", jp.identification_t)
                      if identification.segment_count == 2][-1]
    assert [segment.index for segment in plan.segments] == [1, 2]
    assert identification.segment_count == 2
    for segment, residual in zip(plan.segments, identification.residuals):
        assert residual.segment == segment.index
        assert residual.forecast == segment.energy
        assert residual.residual == residual.forecast - residual.measured
    assert (energy.segment, energy.segment_spent) == (2, identification.residuals[1].measured)
    assert energy.segment_forecast == plan.segments[1].energy
    assert energy.spent > sum(residual.measured for residual in identification.residuals)
    assert 0 < energy.state_of_charge <= 1
    assert identification.motor_resistance == pytest.approx(6.69, abs=1e-4)
    assert identification.electronics_power == pytest.approx(6, abs=0.001)  # with what noise takes


# ---- logs made by hand ---------------------------------------------------------------------------------------------

def state_at(t, route_state=3):
    state = jp.state_t()
    state.utime = round(t * 1e6)
    state.x, state.y, state.speed, state.reference_speed = 0.5 * t, 0.1 * t, 0.5, 0.5
    state.route_state = route_state
    return state


def energy_at(t, segment=0, spent=0.0):
    energy = jp.energy_t()
    energy.utime = round(t * 1e6) + 4000
    energy.spent, energy.segment, energy.segment_spent, energy.segment_drawn = 6 * t, segment, spent, spent - 1
    return energy


def plan_at(t, energies, points=((2, 0.4), (4, 0.8)), route_id=1):
    plan = jp.plan_t()
    plan.utime, plan.route_id, plan.route_segment = round(t * 1e6), route_id, 1
    plan.point_count, plan.segment_count = len(points), len(energies)
    for x, y in points:
        point = jp.point_t()
        point.x, point.y = x, y
        plan.points.append(point)
    for i, forecast in enumerate(energies, start=1):
        segment = jp.segment_t()
        segment.index, segment.speed, segment.duration, segment.energy = i, 0.5, 4.0, forecast
        plan.segments.append(segment)
    return plan


def drive_messages(start=0.0, energies=(24.0, 25.0), **options):
    """A drive of two segments of 4 s, as (channel, message) in order."""
    result, ended = [("JP_PLAN", plan_at(start, energies[:1], **options))], 0
    for k in range(430):
        t = start + 0.02 * k
        if k == 150:
            result.append(("JP_PLAN", plan_at(t, energies, **options)))
        if k in (200, 400):
            ended += 1
        result.append(("JP_STATE", state_at(t, 4 if ended == 2 else 3)))
        result.append(("JP_ENERGY", energy_at(t, ended, 24.5 if ended else 0.0)))
    return result


def write_log(path, entries):
    log = lcm.EventLog(str(path), "w", overwrite=True)
    for i, (channel, message) in enumerate(entries):
        log.write_event(i, channel, message if isinstance(message, bytes) else message.encode())
    log.close()


def summary_of(tmp_path, entries):
    write_log(tmp_path / "hand.lcm", entries)
    result = run_tool("operate.lcm_report", tmp_path / "hand.lcm", tmp_path / "out")
    assert not result.returncode, result.stderr
    return json.loads((tmp_path / "out" / "summary.json").read_text())


def test_a_log_by_hand(tmp_path):
    segments = summary_of(tmp_path, drive_messages())["strategies"][0]["segments"]
    assert [segment["target_m"] for segment in segments] == [[2, 0.4], [4, 0.8]]
    assert [segment["planned_energy_j"] for segment in segments] == [24, 25]
    assert [segment["measured_energy_j"] for segment in segments] == [24.5, 24.5]
    assert [segment["battery_energy_j"] for segment in segments] == [23.5, 23.5]
    assert [segment["duration_s"] for segment in segments] == pytest.approx([4, 4], abs=0.03)


def test_a_lost_forecast_is_unknown_not_zero(tmp_path):
    segments = summary_of(tmp_path, drive_messages(energies=(24.0, math.nan)))["strategies"][0]["segments"]
    assert segments[1]["planned_energy_j"] is None
    assert segments[1]["error_percent"] is None


def test_the_last_drive_counts(tmp_path):
    second = drive_messages(start=100.0, points=((52, 10.4), (54, 10.8)), route_id=2)
    summary = summary_of(tmp_path, drive_messages() + second)
    assert summary["waypoints_m"][1:] == [[52, 10.4], [54, 10.8]]
    assert len(summary["strategies"][0]["segments"]) == 2


def test_bad_messages_are_counted_and_left_out(tmp_path):
    good = drive_messages()
    write_log(tmp_path / "good.lcm", good)
    whole = good[5][1].encode()
    rubbish = [("JP_STATE", b""), ("JP_STATE", whole[:-4]), ("JP_STATE", whole[:30]), ("JP_PLAN", whole),
               ("JP_ENERGY", bytes(8) + whole[8:]), ("JP_PLAN", good[0][1].encode()[:-1]),
               ("OTHER", b"of another program"), ("JP_PLAN", good[0][1].encode()[:22] + b"\x7f\xff\xff\xff")]
    mixed = list(good)
    for i, bad in enumerate(rubbish):
        mixed.insert(100 + 40 * i, bad)
    write_log(tmp_path / "mixed.lcm", mixed)
    run_tool("operate.lcm_report", tmp_path / "good.lcm", tmp_path / "good")
    result = run_tool("operate.lcm_report", tmp_path / "mixed.lcm", tmp_path / "mixed")
    assert f"{len(rubbish) - 1} messages were not of their type" in result.stderr
    for name in RESULTS:
        assert (tmp_path / "good" / name).read_bytes() == (tmp_path / "mixed" / name).read_bytes()


@pytest.mark.parametrize("content", [b"", b"no log at all\n" * 50, b"\xed\xa1\xda\x01" + b"\xff" * 40])
def test_files_that_are_no_logs(tmp_path, content):
    (tmp_path / "bad.lcm").write_bytes(content)
    result = run_tool("operate.lcm_report", tmp_path / "bad.lcm", tmp_path / "out")
    assert_one_line_error(result, "bad.lcm")
    assert not (tmp_path / "out").exists()


def test_a_log_that_is_not_there(tmp_path):
    assert_one_line_error(run_tool("operate.lcm_report", tmp_path / "none.lcm", tmp_path / "out"), "none.lcm",
                          "No such file")


def test_a_log_without_a_drive(tmp_path):
    write_log(tmp_path / "idle.lcm", [("JP_STATE", state_at(0.02 * k, 0)) for k in range(100)])
    result = run_tool("operate.lcm_report", tmp_path / "idle.lcm", tmp_path / "out")
    assert_one_line_error(result, "no segment was driven")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("arguments", [(), ("a", "b", "--live", URL), ("out",)])
def test_either_a_log_or_live(arguments):
    assert_one_line_error(run_tool("operate.lcm_report", *arguments), "lcm_report.py: ")


# ---- wrong addresses -----------------------------------------------------------------------------------------------

WRONG_URLS = {"foo://": "begin", "memq://": "begin", "": "begin", "udpm://foo": "multicast IP address",
              "udpm://239.255.76.67:99999": "port", "udpm://10.0.0.1:7667": "multicast route"}


@pytest.mark.parametrize(("url", "part"), WRONG_URLS.items())
def test_wrong_urls(tmp_path, url, part):
    result = subprocess.run([JP_LCM, "--bus", f"pty:{tmp_path}/bus", "--lcm", url], capture_output=True, text=True,
                            timeout=LIMIT, check=False)
    assert_one_line_error(result, "--lcm", part)
    live = subprocess.run([sys.executable, "-m", "tools.operate.lcm_report", "--live", url, tmp_path / "out"],
                          cwd=ROOT, capture_output=True, text=True, timeout=LIMIT, check=False)
    assert_one_line_error(live, "--live", part)


@pytest.mark.parametrize("url", ["udpm://239.255.76.67:7667?tttl=0", "udpm://239.255.76.67:7667?ttl=x"])
def test_options_of_a_url_that_lcm_only_warns_of(tmp_path, url):
    result = in_namespace(MULTICAST, JP_LCM, "--bus", f"pty:{tmp_path}/bus", "--lcm", url, timeout=LIMIT)
    assert_one_line_error(result, "--lcm", url)


@pytest.mark.parametrize("network", ["true", "ip link set lo up"])
def test_no_multicast_route(tmp_path, network):
    for command in ((JP_LCM, "--bus", f"pty:{tmp_path}/bus"),
                    (sys.executable, "-m", "tools.operate.lcm_report", "--live", URL, tmp_path / "out")):
        assert_one_line_error(in_namespace(network, *command, timeout=LIMIT), "ip route add 224.0.0.0/4 dev lo")


@pytest.mark.parametrize("bus", ["can:none0", "nonsense", "slcan:/nowhere/at/all"])
def test_wrong_buses(bus):
    result = subprocess.run([JP_LCM, "--bus", bus], capture_output=True, text=True, timeout=LIMIT, check=False)
    assert_one_line_error(result, bus.split(":")[-1])


def test_a_bus_is_needed():
    result = subprocess.run([JP_LCM], capture_output=True, text=True, timeout=LIMIT, check=False)
    assert result.returncode == 2
    assert "--bus is needed" in result.stderr


# ---- a bus without a robot -----------------------------------------------------------------------------------------

def gateway_with(what, folder):
    """What jp-lcm says, and what lcm_gateway.py has heard on its line."""
    result = in_namespace(MULTICAST, sys.executable, ROOT / "tests" / "tools" / "lcm_gateway.py", folder, what)
    assert result.returncode == 0, result.stderr
    return result.stdout, (folder / "heard").read_bytes()


def test_an_idle_gateway_sends_nothing_and_stops_cleanly(tmp_path):
    """On a bus that may have another operator it keeps silent, also when it goes."""
    _, heard = gateway_with("idle", tmp_path)
    assert heard == b""


def test_datagrams_that_end_before_their_channels_name(tmp_path):
    """LCM may take one for a message to the channel of the one before: no route comes of it."""
    said, _ = gateway_with("cut", tmp_path)
    assert int(said.partition("LCM packets dropped")[2].split()[0]) >= 500  # the whole ones
    assert "standing up" not in said
