"""What programs write: links, devices and pipes stay what they are, two runs at once leave one whole set, an interrupt
leaves nothing, and standard output that cannot be written is an error."""
import contextlib
import json
import os
import signal
import stat
import subprocess

import pytest
from conftest import BIN, LIMIT, ROOT, assert_one_line_error, run
from programs import wait_until

ROBOTS = ROOT / "sim/robots"
SCENARIO = ROOT / "sim/scenarios/gao2018_short.cfg"
FOLDER = ["experiments.csv", "experiments.json"]
OLD = "from an earlier run\n"


def identify(output, *options, **more):
    return run("jp-identify", ROBOTS / "gao2018.cfg", "--count=20", "--output", output, *options, **more)


def constants(json_path, **more):
    """Of a robot by its name, from the folder of the project."""
    return run("jp-robot", "gao2018", "--json", json_path, cwd=ROOT, **more)


def names(folder):
    return sorted(path.name for path in folder.iterdir())


# ---- what stands at the place ----------------------------------------------------------------------------------------

def test_device_is_written_to(tmp_path):
    """A node of its own, so that a program that replaces it does no harm."""
    device = tmp_path / "null"
    try:
        os.mknod(device, 0o666 | stat.S_IFCHR, os.makedev(1, 3))
        device.open("w").close()
    except PermissionError:
        pytest.skip("device nodes need rights that this machine does not give")
    assert constants(device).returncode == 0
    assert stat.S_ISCHR(device.stat().st_mode)


def test_full_device(tmp_path):
    link = tmp_path / "robot.json"
    link.symlink_to("/dev/full")
    assert_one_line_error(constants(link), link, "No space left on device")
    assert link.is_symlink() and names(tmp_path) == ["robot.json"]


def test_pipe_is_written_to(tmp_path):
    pipe = tmp_path / "robot.json"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    assert constants(pipe).returncode == 0
    with os.fdopen(reader) as end:
        assert json.loads(end.read())["name"] == "gao2018"
    assert stat.S_ISFIFO(pipe.stat().st_mode)


@pytest.mark.parametrize("exists", [True, False])
@pytest.mark.parametrize("absolute", [True, False])
def test_links_stay_links(tmp_path, exists, absolute):
    """Over a second link in another folder."""
    store, links = tmp_path / "store", tmp_path / "links"
    store.mkdir()
    links.mkdir()
    if exists:
        (store / "robot.json").write_text(OLD)
    (links / "second").symlink_to(store / "robot.json" if absolute else "../store/robot.json")
    (links / "first").symlink_to("second")
    assert constants(links / "first").returncode == 0
    assert names(links) == ["first", "second"] and (links / "first").is_symlink() and (links / "second").is_symlink()
    assert names(store) == ["robot.json"] and json.loads((store / "robot.json").read_text())["name"] == "gao2018"


def test_link_to_itself(tmp_path):
    link = tmp_path / "loop"
    link.symlink_to("loop")
    assert_one_line_error(constants(link), link, "symbolic links")


def test_permissions_stay(tmp_path):
    file = tmp_path / "robot.json"
    assert constants(file, umask=0o027).returncode == 0
    assert stat.S_IMODE(file.stat().st_mode) == 0o640
    file.chmod(0o604)
    assert constants(file).returncode == 0
    assert stat.S_IMODE(file.stat().st_mode) == 0o604


# ---- several at once, and interrupts ---------------------------------------------------------------------------------

def full_pipe():
    """Both ends; whoever writes there waits until it is read."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    for size in (4096, 1):
        with contextlib.suppress(BlockingIOError):
            while True:
                os.write(writer, bytes(size))
    os.set_blocking(writer, True)
    return reader, writer


def start_patrol(output, seed=1):
    """A drive that has opened its first file, and ends when its standard output is read."""
    before = names(output)
    reader, writer = full_pipe()
    process = subprocess.Popen([BIN / "jp-patrol", "corridor", f"--robot={ROBOTS / 'patrol.cfg'}", f"--seed={seed}",
                                "--output", output], stdout=writer)
    os.close(writer)
    process.stdout = open(reader, "rb")
    wait_until(lambda: names(output) != before, "the first file")
    return process


def end_patrol(process):
    process.communicate(timeout=LIMIT)
    assert process.returncode == 0


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_two_runs_into_one_folder(tmp_path):
    """The second begins and ends while the first one is under way."""
    both, alone = tmp_path / "both", tmp_path / "alone"
    both.mkdir()
    alone.mkdir()
    first = start_patrol(both, seed=1)
    end_patrol(start_patrol(both, seed=2))
    end_patrol(first)
    end_patrol(start_patrol(alone, seed=1))
    assert contents(both) == contents(alone)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_interrupt_leaves_nothing(tmp_path, number):
    output = tmp_path / "out"
    output.mkdir()
    (output / "summary.json").write_text(OLD)
    with start_patrol(output) as process:
        process.send_signal(number)
        assert process.wait(LIMIT) == -number
    assert names(output) == ["summary.json"] and (output / "summary.json").read_text() == OLD


def test_signal_that_is_ignored_stays_so(tmp_path):
    process = subprocess.Popen([BIN / "jp-identify", ROBOTS / "gao2018.cfg", "--count=20", "--output", tmp_path / "out"],
                               stdout=subprocess.DEVNULL,
                               preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    while process.poll() is None:
        process.send_signal(signal.SIGHUP)
    assert process.returncode == 0 and names(tmp_path / "out") == FOLDER


# ---- standard output -------------------------------------------------------------------------------------------------

def programs(tmp_path):
    """A command of each program that says something and comes to an end, and the folder that it writes to."""
    output = tmp_path / "out"
    hall = tmp_path / "hall.json"
    hall.write_text(json.dumps({"format": "joulepath-map-1", "name": "hall", "width": 60, "height": 60,
                                "resolution_m": 0.2, "origin_m": [0, 0, 0], "rows": ["." * 60] * 60}))
    fine = tmp_path / "fine.json"
    fine.write_text(hall.read_text().replace('"resolution_m": 0.2', '"resolution_m": 0.1'))
    gao, patrol = ROBOTS / "gao2018.cfg", ROBOTS / "patrol.cfg"
    return {
        "jp-robot": [gao, "--json", output / "robot.json"], "jp-patrol-config": [patrol], "jp-balance": [gao],
        "jp-skid": [ROBOTS / "burger.cfg", "--json", output / "skid.json"],
        "jp-skid-identify": [ROBOTS / "burger.cfg", "--count=1", "--robots=1", "--output", output],
        "jp-four-wheel-identify": [patrol, "--count=1", "--robots=1", "--output", output],
        "jp-trip": [ROBOTS / "courier24.cfg", "--output", output], "jp-mission": [SCENARIO, "--output", output],
        "jp-identify": [gao, "--count=20", "--output", output],
        "jp-plant": [SCENARIO, "--bus=in-process", "--output", output],
        "jp-patrol": ["corridor", f"--robot={patrol}", "--method=pursuit", "--output", output],
        "jp-navigate": [fine, "--robot", ROBOTS / "courier24.cfg", "--start=1,1,0", "--goal=3,3", "--output", output],
        "jp-plan": [hall, "--robot", ROBOTS / "zhang2018.cfg", "--start=3,3,0", "--goal=9,9", "--output", output],
    }, output


PROGRAMS = ["jp-robot", "jp-balance", "jp-skid", "jp-skid-identify", "jp-four-wheel-identify", "jp-patrol-config", "jp-trip", "jp-mission", "jp-identify", "jp-plant", "jp-patrol",
            "jp-plan", "jp-navigate"]


@pytest.mark.parametrize("program", PROGRAMS)
def test_standard_output_that_cannot_be_written(program, tmp_path):
    """Full, and closed, when the first file that is opened would else take its place."""
    commands, output = programs(tmp_path)
    output.mkdir()
    for redirection, reason in ((">/dev/full", "No space left"), (">&-", "")):
        command = " ".join(["exec", str(BIN / program), *map(str, commands[program]), redirection])
        result = subprocess.run(["sh", "-c", command], stderr=subprocess.PIPE, text=True, check=False, timeout=LIMIT)
        result.stdout = ""
        assert_one_line_error(result, "standard output", reason)
        assert names(output) == []


def test_closed_output_that_nobody_needs(tmp_path):
    """jp-lattice says nothing."""
    command = f"exec {BIN / 'jp-lattice'} {ROBOTS / 'zhang2018.cfg'} --output {tmp_path / 'out'} <&- >&- 2>&-"
    assert subprocess.run(["sh", "-c", command], check=False, timeout=LIMIT).returncode == 0
    assert json.loads((tmp_path / "out/lattice.json").read_text())
