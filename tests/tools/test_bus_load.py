"""tools/measure/bus_load.py: bits against a bit-by-bit reference and known frames, the worst case, logs, figures."""
import itertools
import json
import random

import can
import numpy as np
import pytest
from conftest import assert_one_line_error, run_tool

from tools.measure import bus_load, figure_store
from tools.measure.bus_load import Kind, frame_bits, worst_bits


# ---- a reference that goes bit by bit --------------------------------------------------------------------------------

def binary(value, width):
    return format(value, f"0{width}b")


def reference_bits(frame):
    """The frame's bits as a text: header, data, CRC; stuffed; trailer."""
    rtr = "1" if frame.is_remote_frame else "0"
    if frame.is_extended_id:
        header = "0" + binary(frame.arbitration_id >> 18, 11) + "11" + binary(frame.arbitration_id & 0x3FFFF, 18)
    else:
        header = "0" + binary(frame.arbitration_id, 11)
    text = header + rtr + "00" + binary(frame.dlc, 4) + "".join(binary(byte, 8) for byte in frame.data)
    remainder = int(text + "0" * 15, 2)
    for place in range(len(text) - 1, -1, -1):
        if remainder >> place + 15 & 1:
            remainder ^= 0xC599 << place
    text += binary(remainder, 15)
    stuffed = ""
    for bit in text:
        stuffed += bit
        if len(stuffed) >= 5 and len(set(stuffed[-5:])) == 1:
            stuffed += "1" if bit == "0" else "0"
    return stuffed + "1" + "11" + "1111111" + "111"


def standard(identifier, data):
    return can.Message(arbitration_id=identifier, data=data, is_extended_id=False)


def random_frame(source):
    length = source.randrange(9)
    # Long runs of equal bits as often as noise.
    data = bytes(source.choice((0, 0xFF, 0x0F, 0xF0, source.randrange(256))) for _ in range(length))
    extended, remote = source.random() < 0.3, source.random() < 0.1
    return can.Message(arbitration_id=source.randrange(1 << (29 if extended else 11)), is_extended_id=extended,
                       is_remote_frame=remote, data=None if remote else data, dlc=length)


def kind_of(frame):
    return Kind(frame.is_extended_id, frame.is_remote_frame, frame.dlc)


def test_random_frames_against_the_reference():
    source = random.Random(20)
    frames = sorted((random_frame(source) for _ in range(5000)), key=kind_of)
    for kind, same in itertools.groupby(frames, kind_of):
        same = list(same)
        counted = frame_bits(kind, [frame.arbitration_id for frame in same], b"".join(bytes(f.data) for f in same))
        for frame, bits in zip(same, counted, strict=True):
            assert bits == len(reference_bits(frame)), f"seed 20: {frame}"
            if not frame.is_extended_id:
                assert bits <= worst_bits(frame.dlc)


def test_crc_15():
    """The check value of CRC-15/CAN."""
    bits = "".join(binary(byte, 8) for byte in b"123456789")
    assert bus_load.crc15(np.array([list(map(int, bits))]))[0] == 0x059E


@pytest.mark.parametrize("length, bits", [(0, 55), (1, 65), (2, 75), (3, 85), (4, 95), (5, 105), (6, 115), (7, 125),
                                          (8, 135)])
def test_worst_bits(length, bits):
    """8n + 47 + floor((34 + 8n − 1) / 4)."""
    assert worst_bits(length) == bits == 8 * length + 47 + (34 + 8 * length - 1) // 4


# ---- the tool ------------------------------------------------------------------------------------------------------

def write_log(path, frames):
    path.write_text("".join(f"({t:.6f}) vcan0 {f.arbitration_id:03X}#{bytes(f.data).hex().upper()}\n" for t, f in frames))


def test_the_worst_case_is_below_the_bar(tmp_path):
    result = run_tool("measure.bus_load", "--json", tmp_path / "load.json", "--bench", tmp_path / "bench.json")
    assert result.returncode == 0, result.stderr
    about = json.loads((tmp_path / "load.json").read_text())
    by_name = {message["name"]: message for message in about["messages"]}
    assert by_name["MotorCommand"]["load_percent"] == pytest.approx(13.5)
    assert by_name["OperatorCommand"]["load_percent"] == pytest.approx(0.095)
    assert by_name["Waypoint"]["load_percent"] is None
    assert "SimTime" not in by_name and "SimDone" not in by_name
    total = sum(m["load_percent"] or 0 for m in about["messages"])
    of_four_wheels = sum(by_name[name]["load_percent"] for name in bus_load.OF_FOUR_WHEELS)
    assert of_four_wheels == pytest.approx(2 * 4 * 1.35 + 1.35 + 90 * 0.135 + 0.095 + 6 * 0.135)
    # A bus has one robot: the messages of the other kinds' wheels take more.
    assert about["worst_percent"] == pytest.approx(total - of_four_wheels)
    assert about["worst_percent"] <= 60
    shown = figure_store.read_figures(tmp_path / "bench.json")
    assert [figure["value"] for figure in shown] == [about["worst_percent"]]
    assert shown[0]["bound"] == {"op": "<=", "value": 60} and shown[0]["unit"] == "%"


def test_the_table_is_aligned():
    lines = run_tool("measure.bus_load").stdout.splitlines()
    assert lines[0].split()[:2] == ["message", "id"] and lines[-1].startswith("sum")
    assert len({len(line) for line in lines[1:] if line.split()[-1] != "–"}) == 1


def test_a_log_is_measured(tmp_path):
    frames = [(100 + i / 1000, standard(0x184, bytes([i % 256] * 8))) for i in range(101)]
    frames += [(100.1, standard(0x555, b"\x01"))]
    write_log(tmp_path / "bus.log", frames)
    result = run_tool("measure.bus_load", "--log", tmp_path / "bus.log", "--json", tmp_path / "load.json")
    assert result.returncode == 0, result.stderr
    about = json.loads((tmp_path / "load.json").read_text())
    bits = sum(len(reference_bits(frame)) for _, frame in frames)
    assert about["log_s"] == pytest.approx(0.1)
    assert about["measured_percent"] == pytest.approx(100 * bits / 0.1 / 1e6)
    by_name = {message["name"]: message for message in about["messages"]}
    assert by_name["Pose"]["frames"] == 101 and by_name["id 0x555"]["frames"] == 1
    assert by_name["MotorCommand"]["frames"] == 0


def test_in_lockstep_the_simulation_tells_the_time(tmp_path):
    """From a tick that waits (-1) to tick 199, however long that took; its own frames do not count."""
    ticks = [0xFFFFFFFF, 0xFFFFFFFF, *range(200)]
    frames = [(i * 3.0, standard(0x7F0, tick.to_bytes(4, "little") + b"\1\0\xE8\3")) for i, tick in enumerate(ticks)]
    frames += [(9000.0, standard(0x7F1, bytes(4))), (9000.0, standard(0x184, bytes(8)))]
    write_log(tmp_path / "bus.log", frames)
    run_tool("measure.bus_load", "--log", tmp_path / "bus.log", "--json", tmp_path / "load.json")
    about = json.loads((tmp_path / "load.json").read_text())
    assert about["log_s"] == pytest.approx(0.2)
    assert about["measured_percent"] == pytest.approx(100 * len(reference_bits(frames[-1][1])) / 0.2 / 1e6)


@pytest.mark.parametrize("text, part", [
    ("", "no time passes"), ("(1.0) vcan0 184#0011223344556677\n", "no time passes"), ("(1.0) vcan0\n", "damaged"),
    ("(1.0) vcan0 184#00\n(1.1) vca", "damaged after frame 1"), ("(x) vcan0 184#00\n", "damaged after frame 0"),
    ("(1.0) vcan0 XYZ#00\n", "damaged"), ("(1.0) vcan0 184\n", "damaged"), ("(1.0) vcan0 184#0G\n", "damaged"),
    ("\x00\xff", "damaged"), ("(2.0) vcan0 184#00\n(1.0) vcan0 184#00\n", "no time passes")])
def test_damaged_logs(tmp_path, text, part):
    path = tmp_path / "bad.log"
    path.write_text(text, encoding="latin-1")
    result = run_tool("measure.bus_load", "--log", path, "--json", tmp_path / "load.json")
    assert_one_line_error(result, "bad.log", part)
    assert not (tmp_path / "load.json").exists()


@pytest.mark.parametrize("name, part", [("none.log", "No such file"), ("bus.txt", "must end in")])
def test_logs_that_cannot_be_read(tmp_path, name, part):
    assert_one_line_error(run_tool("measure.bus_load", "--log", tmp_path / name), name, part)
