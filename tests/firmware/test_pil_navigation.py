"""The navigator in the image: in QEMU it gets map, goal and hidden obstacles over the bus, and drives as in process."""
import json
import subprocess

import pytest
from emulator import Emulator
from programs import BIN, BUILD, LIMIT, ROOT, Programs

from tools.measure.bench_image import are_equal, told

ROBOT = "courier24"
CELL = 0.1
HALL = (50, 40)
WALL = range(24, 26), range(18, 40)  # columns and rows from the south
# A box that comes into view stands in the way: it brakes, plans anew, and goes round it.
TASK = ["--start=1,1,90", "--goal=1,3.4", "--hidden=2", "--view=1", "--seed=3"]
REPLANS = 1


@pytest.fixture(name="programs")
def fixture_programs(tmp_path):
    with Programs(tmp_path) as programs:
        yield programs


@pytest.fixture(name="hall")
def fixture_hall(tmp_path):
    width, height = HALL
    rows = ["".join("#" if x in (0, width - 1) or y in (0, height - 1) or (x in WALL[0] and y in WALL[1]) else "."
                    for x in range(width)) for y in reversed(range(height))]
    path = tmp_path / "hall.json"
    path.write_text(json.dumps({"format": "joulepath-map-1", "name": "hall", "width": width, "height": height,
                                "resolution_m": CELL, "origin_m": [0, 0, 0], "rows": rows}))
    return path


def command(hall, bus, output):
    return [BIN / "jp-navigate", hall, "--robot", ROOT / f"sim/robots/{ROBOT}.cfg", *TASK, "--bus", bus, "--frames",
            "--patience", str(LIMIT), "--output", output]


def in_process(hall, output):
    subprocess.run(command(hall, "in-process", output), check=True, stdout=subprocess.DEVNULL, timeout=LIMIT)
    return output


def test_the_image_finds_its_way_as_the_program_does(programs, hall, tmp_path):
    expected = in_process(hall, tmp_path / "in-process")
    with Emulator(tmp_path, ROBOT) as emulator:
        program = programs.start(*command(hall, f"slcan:{emulator.line}", tmp_path / "pil"))
        assert program.process.wait(LIMIT) == 0, program.err.read_text()
    assert are_equal(tmp_path / "pil", expected)
    (summary, home), (_, other_home) = told(tmp_path / "pil"), told(expected)
    assert (home, other_home) == ("no memory for the way", "no battery")
    result = summary["result"]
    assert (result["state"], result["touched"], result["replans"]) == ("arrived", False, REPLANS)
    assert result["cells_seen"] > 0 and summary["bus"]["commands_late"] == 0


def test_the_map_goes_beside_the_core():
    """The linker puts there what DMA need not reach, and refuses what fits nowhere."""
    image = BUILD / f"firmware/{ROBOT}/joulepath.elf"
    sections = subprocess.run(["arm-none-eabi-objdump", "-h", image], capture_output=True, text=True, check=True).stdout
    line = next(line for line in sections.splitlines() if " .ccm " in line).split()
    assert int(line[3], 16) == 0x10000000 and 18432 < int(line[2], 16) <= 65536
