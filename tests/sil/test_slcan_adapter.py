"""jp-ecu on a pseudo-terminal is an SLCAN adapter: python-can opens it as any other, and so does a second one later."""
import os
import select
import subprocess

import can
import cantools
import pytest
from conftest import BIN, ROOT, assert_one_line_error, run
from programs import LIMIT, wait_until

ID_MAX = 0x7FF
DBC = cantools.database.load_file(ROOT / "hal/can/joulepath.dbc")


@pytest.fixture(name="adapter")
def fixture_adapter(tmp_path):
    """The path of a running ECU's line, which is gone when it has been told to stop."""
    path = tmp_path / "ecu"
    with subprocess.Popen([BIN / "jp-ecu", "--real-time", "--bus", f"pty:{path}"], stdout=subprocess.DEVNULL) as ecu:
        wait_until(path.is_symlink, "the line of jp-ecu")
        yield path
        ecu.terminate()
        assert ecu.wait(LIMIT) == 0
    assert not path.is_symlink()


def open_bus(path):
    return can.Bus(interface="slcan", channel=str(path), bitrate=1_000_000, sleep_after_open=0)


def test_python_can_opens_it_and_hears_the_ecu(adapter):
    with open_bus(adapter) as bus:
        hardware, software = bus.get_version(LIMIT)
        assert hardware == 10 and software is not None
        assert bus.get_serial_number(LIMIT) == "JP01"
        message = bus.recv(LIMIT)
        assert message is not None and message.arbitration_id <= ID_MAX and not message.is_extended_id


def test_another_host_comes_after_the_first(adapter):
    for _ in range(3):
        with open_bus(adapter) as bus:
            assert bus.recv(LIMIT) is not None


def test_malformed_lines_do_not_disturb_it(adapter):
    with open_bus(adapter) as bus:
        bus.serialPortOrig.write(b"\x00\xff" * 1000 + b"\rt1009\rTFFFFFFFF0\rwhat\r\a")
        bus.send(can.Message(arbitration_id=0x123, is_extended_id=False, data=[1, 2, 3]))
        bus.send(can.Message(arbitration_id=0x12345678, is_extended_id=True, is_remote_frame=True, dlc=4))
        assert bus.get_serial_number(LIMIT) == "JP01"
        assert bus.recv(LIMIT) is not None


def test_simulated_time_does_not_switch_it_off_in_real_time(adapter):
    """No power, in reset and off the bus: frames that anybody can send. What comes after them is still heard."""
    with open_bus(adapter) as bus:
        for flags in (0b000, 0b101, 0b011):
            data = (1).to_bytes(4, "little") + bytes([flags, 0, 0, 0])
            bus.send(can.Message(arbitration_id=DBC.get_message_by_name("SimTime").frame_id, is_extended_id=False,
                                 data=data))
        for _ in range(5):
            bus.send(can.Message(arbitration_id=0x555, is_extended_id=False, data=[1, 2, 3]))
        losses = DBC.get_message_by_name("EcuLosses")
        unknown = 0
        while unknown < 3 + 5:
            message = bus.recv(LIMIT)
            assert message is not None and message.arbitration_id != DBC.get_message_by_name("SimDone").frame_id
            if message.arbitration_id == losses.frame_id:
                unknown = losses.decode(message.data)["UnknownFrames"]
        assert unknown == 3 + 5


def test_a_closed_channel_is_silent(adapter):
    line = os.open(adapter, os.O_RDWR | os.O_NOCTTY)
    assert select.select([line], [], [], 1)[0] == []
    os.write(line, b"t1000\r")
    assert os.read(line, 1) == b"\a"
    assert select.select([line], [], [], 0.1)[0] == []
    os.close(line)


@pytest.mark.parametrize(("bus", "parts"), [
    ("vcan0", ("vcan0: not a CAN bus",)),
    ("slcan:/dev/null", ("slcan:/dev/null: not a serial line",)),
    ("slcan:/nowhere/tty", ("slcan:/nowhere/tty", "No such file or directory", "plug in the adapter")),
    ("pty:/nowhere/ecu", ("pty:/nowhere/ecu", "No such file or directory")),
    ("can:", ("1 to 15 characters",)),
])
def test_a_bus_that_cannot_be_opened_is_named(bus, parts):
    assert_one_line_error(run("jp-ecu", "--bus", bus), *parts)


def test_a_file_in_the_place_of_the_line_is_kept(tmp_path):
    path = tmp_path / "ecu"
    path.write_text("mine", encoding="utf-8")
    assert_one_line_error(run("jp-ecu", "--bus", f"pty:{path}"), path, "remove it or give another name")
    assert path.read_text(encoding="utf-8") == "mine"
