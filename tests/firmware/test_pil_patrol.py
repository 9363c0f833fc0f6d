"""The patrol robot's image for a Cortex-M7: in QEMU it gets map and goal, or a round, sees and drives as the program
does, bit by bit; what it takes of flash and RAM."""
import json
import re
import subprocess

import pytest
from emulator import Emulator, image
from programs import BIN, LIMIT, ROOT, Programs

ROBOT = "patrol"
SCENE = "l-passage"
OF_THE_CLOCK = ("7F0#", "7F1#")  # lockstep's frames, sent again when the computer is slow
KIB = 1024
README = ROOT / "hal/mps2/README.md"


@pytest.fixture(name="programs")
def fixture_programs(tmp_path):
    with Programs(tmp_path) as programs:
        yield programs


def command(bus, output):
    return [BIN / "jp-patrol", SCENE, "--bus", bus, "--patience", str(LIMIT), "--output", output]


def room():
    """A small one, that its survey and its drive take seconds."""
    width, height = 70, 50
    rows = ["#" * width, *(["#" + "." * (width - 2) + "#"] * (height - 2)), "#" * width]
    return {"format": "joulepath-map-1", "name": "room", "width": width, "height": height, "resolution_m": 0.05,
            "origin_m": [0.0, 0.0, 0.0], "rows": rows}


ROUND = """charger = [0.8, 1.2, 0.0];
stops = ( [2.6, 1.2, 0.0, 1.0] );
battery: { full_j = 1500.0; reserve_j = 50.0; charger_w = 500.0; };
deviations = 1.645;
"""


def patrol(folder, bus, output):
    (folder / "room.json").write_text(json.dumps(room()))
    (folder / "round.cfg").write_text(ROUND)
    return [BIN / "jp-patrol", "--map", folder / "room.json", "--round", folder / "round.cfg", "--hours=0.005",
            "--bus", bus, "--patience", str(LIMIT), "--output", output]


def frames(output):
    return [line for line in (output / "frames.log").read_text().splitlines()
            if not any(frame in line for frame in OF_THE_CLOCK)]


def test_the_image_drives_as_the_program_does(programs, tmp_path):
    subprocess.run(command("in-process", tmp_path / "in-process"), check=True, stdout=subprocess.DEVNULL, timeout=LIMIT)
    with Emulator(tmp_path, ROBOT, machine="mps2-an500") as emulator:
        program = programs.start(*command(f"slcan:{emulator.line}", tmp_path / "pil"))
        assert program.process.wait(4 * LIMIT) == 0, program.err.read_text()
    summary = json.loads((tmp_path / "pil" / "summary.json").read_text())
    assert summary == json.loads((tmp_path / "in-process" / "summary.json").read_text())
    assert summary["outcome"] == "arrived" and summary["commands_late"] == 0
    assert frames(tmp_path / "pil") == frames(tmp_path / "in-process")


def test_the_image_goes_round_as_the_program_does(programs, tmp_path):
    subprocess.run(patrol(tmp_path, "in-process", tmp_path / "in-process"), check=True, stdout=subprocess.DEVNULL,
                   timeout=LIMIT)
    with Emulator(tmp_path, ROBOT, machine="mps2-an500") as emulator:
        program = programs.start(*patrol(tmp_path, f"slcan:{emulator.line}", tmp_path / "pil"))
        assert program.process.wait(4 * LIMIT) == 0, program.err.read_text()
    summary = json.loads((tmp_path / "pil" / "summary.json").read_text())
    assert summary == json.loads((tmp_path / "in-process" / "summary.json").read_text())
    assert summary["outcome"] == "went on" and summary["visits"] >= 1 and summary["charges"] >= 1
    assert summary["commands_late"] == 0
    log = (tmp_path / "pil" / "log_round.csv").read_bytes()
    assert log == (tmp_path / "in-process" / "log_round.csv").read_bytes()


def sizes():
    text = subprocess.run(["arm-none-eabi-size", image(ROBOT)], capture_output=True, text=True, check=True).stdout
    code, data, cleared = map(int, text.splitlines()[1].split()[:3])
    return code + data, data + cleared


def test_the_sizes_are_those_that_the_readme_states():
    flash, ram = sizes()
    stated = re.search(r"\| all \| ([\d ]+) KiB \| ([\d ]+) KiB \|", README.read_text())
    assert [int(number.replace(" ", "")) for number in stated.groups()] == [-(-flash // KIB), -(-ram // KIB)]


def test_the_code_computes_in_single_precision():
    """Double would be emulated, at a hundred times the work."""
    names = subprocess.run(["arm-none-eabi-nm", image(ROBOT)], capture_output=True, text=True, check=True).stdout
    assert not re.findall(r"__aeabi_(?:d\w+|f2d|ui2d|i2d|l2d|ul2d)\b", names)
