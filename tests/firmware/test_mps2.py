"""The second board in real time: its timer is the tick's, its watchdog ends what hangs, and what outlives the reset tells
of it. Drives, crashes and faults of the core are tested as those of the first board: test_pil.py, test_faults.c."""
import os
import time
import tty

import pytest
from emulator import BUILD, Emulator, address_of
from programs import LIMIT, wait_until

ROBOT = "courier24"
RATE = 1000  # Hz, of its ticks
IMAGE = BUILD / f"mps2/{ROBOT}/joulepath.elf"
SLICE = 0.2  # s
WATCHDOG_VALUE, WATCHDOG_HZ = 0x40008004, 25_000_000
NMI = 2
LOOP = 0xE7FEE7FE  # b .
RECORD = {name: 4 * at for at, name in enumerate(
    ("cause", "exception", "pc", "lr", "psr", "status", "address", "tick", "pending", "crashes"))}
CAUSE = 5  # JP_RESET_FAULT


@pytest.fixture(name="board")
def fixture_board(tmp_path):
    with Emulator(tmp_path, ROBOT, board="mps2", path=IMAGE, debug=True, icount=True) as emulator:
        yield emulator


def ticks_of(debugger):
    return debugger.word(address_of("ticks", IMAGE))


def record_of(debugger):
    start = address_of("jp_post_mortem", IMAGE)
    return {name: debugger.word(start + offset) for name, offset in RECORD.items()}


def hang(debugger, where):
    """The program runs to a function, and from there round in a circle."""
    loop = address_of("parameters", IMAGE)  # memory that the image does not use
    debugger.write_word(loop, LOOP)
    debugger.run_to(address_of(where, IMAGE))
    debugger.jump(loop)
    return loop


def run_until(debugger, condition):
    end = time.monotonic() + LIMIT
    while not condition():
        assert time.monotonic() < end, "it hangs"
        debugger.run(SLICE)


def restart_after_crash(debugger, crashes):
    """Until the program that starts after it counts its ticks."""
    def has_restarted():
        record = record_of(debugger)
        return record["crashes"] >= crashes and record["pending"] == 0 and ticks_of(debugger) > 0

    run_until(debugger, has_restarted)


def test_the_timer_gives_the_ticks(board):
    """Against the watchdog's count, however the emulator's time passes: nobody feeds it while the main loop hangs."""
    debugger = board.debugger()
    run_until(debugger, lambda: ticks_of(debugger) > 0)
    hang(debugger, "jp_ecu_work")
    ticks, count = ticks_of(debugger), debugger.word(WATCHDOG_VALUE)
    while ticks_of(debugger) < ticks + 20:
        debugger.run(0.005)
    ticks, count = ticks_of(debugger) - ticks, count - debugger.word(WATCHDOG_VALUE)
    assert ticks == pytest.approx(count / WATCHDOG_HZ * RATE, abs=1.5)


@pytest.mark.parametrize("where", ["jp_ecu_work", "jp_ecu_tick"], ids=["in the main loop", "in the tick"])
def test_the_watchdog_ends_what_hangs(board, where):
    debugger = board.debugger()
    run_until(debugger, lambda: ticks_of(debugger))
    assert record_of(debugger)["crashes"] == 0
    loop = hang(debugger, where)
    restart_after_crash(debugger, 1)
    record = record_of(debugger)
    assert (record["cause"], record["exception"], record["crashes"]) == (CAUSE, NMI, 1)
    assert loop <= record["pc"] < loop + 4
    before = ticks_of(debugger)
    run_until(debugger, lambda: ticks_of(debugger) > before)


def test_after_the_third_crash_in_a_row_it_does_not_go_on(board):
    debugger = board.debugger()
    run_until(debugger, lambda: ticks_of(debugger))
    report = address_of("reset_report", IMAGE)
    may_go_on = report + 4 * (1 + 1 + len(RECORD) - 2)
    for crashes in (1, 2, 3):
        hang(debugger, "jp_ecu_work")
        restart_after_crash(debugger, crashes)
        assert debugger.word(report + 4) == crashes
        assert (debugger.word(may_go_on) & 0xFF) == (crashes < 3)


def test_the_bus_is_the_serial_line(tmp_path):
    """SLCAN: opened, it tells its state; without samples the motors stay off."""
    with Emulator(tmp_path, ROBOT, board="mps2", path=IMAGE) as emulator:
        line = os.open(emulator.line, os.O_RDWR | os.O_NONBLOCK)
        tty.setraw(line)
        heard = bytearray()

        def hears(text):
            try:
                heard.extend(os.read(line, 4096))
            except BlockingIOError:
                pass
            return text in heard

        os.write(line, b"C\rS8\rO\r")
        wait_until(lambda: hears(b"\rt180"), "EcuStatus")
        os.close(line)
    assert b"\rt010" not in heard  # MotorCommand
