"""tools/operate/with_vcan.sh: what a command finds inside, what comes out, and that nothing stays behind.

The kernel is emulated where this machine's has no vcan. Inside it the script runs once more, there natively, so that
both ways are tested. Failures of the emulation come from a stand-in for QEMU.
"""
import json
import os
import shutil
import signal
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT, assert_one_line_error
from programs import LIMIT as PATIENCE
from programs import wait_until

SCRIPT = Path("tools/operate/with_vcan.sh")
LIMIT = 1800  # s, of a run on a busy machine that waits for another
ODD_TEXT = "two words, 'quotes' \" $HOME `x` \\ and\na second line"
LINES = 20_000
KILLED = (-signal.SIGKILL, 128 + signal.SIGKILL)  # as the process itself, as a shell reports it

# Runs under /usr/bin/python3, without the project's packages.
PROBE = r'''
import json, os, pty, socket, struct, subprocess, sys, tempfile
from pathlib import Path

def output(*command):
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)

def multicast():
    group = ("239.255.76.67", 7667)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver, \
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        receiver.bind(group)
        receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                            struct.pack("4sl", socket.inet_aton(group[0]), socket.INADDR_ANY))
        receiver.settimeout(600)
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        sender.sendto(b"goal", group)
        return receiver.recv(16).decode()

def dumped_frames():
    """What candump saw; it is sent to until it has."""
    dump = subprocess.Popen(["candump", "-L", "-n", "1", "vcan1"], stdout=subprocess.PIPE, text=True)
    while dump.poll() is None:
        output("cansend", "vcan0", "111#00")
        output("cansend", "vcan1", "123#DEADBEEF")
    return dump.stdout.read()

def ptys():
    pairs = [pty.openpty() for _ in range(8)]
    for number, (master, _) in enumerate(pairs):
        os.write(master, b"%d\n" % number)
    return [os.read(slave, 16).decode() for _, slave in pairs]

def temporary_socket():
    with tempfile.TemporaryDirectory() as folder, socket.socket(socket.AF_UNIX) as listener:
        listener.bind(folder + "/socket")
        listener.listen()
        with socket.socket(socket.AF_UNIX) as caller:
            caller.connect(folder + "/socket")
    return True

script, text = sys.argv[1:]
nested = output(script, "--", "sh", "-c", "cansend vcan0 123#; echo inner; exit 3")
killed = output(script, "--", "sh", "-c", "kill -KILL $$")
Path("written").write_text("from inside")
os.system("echo reopened >/dev/stderr")
json.dump({
    "argument": text, "variable": os.environ["JP_ODD"], "folder": os.getcwd(), "path": os.environ["PATH"],
    "umask": os.umask(0), "input": sys.stdin.read(), "links": output("ip", "-brief", "link").stdout,
    "frames": dumped_frames(), "multicast": multicast(), "ptys": ptys(), "socket": temporary_socket(),
    "nested": [nested.returncode, nested.stdout, nested.stderr], "killed": killed.returncode,
}, sys.stdout)
print()
for line in range(int(os.environ["JP_LINES"])):
    print("line", line)
sys.stdout.flush()
subprocess.Popen(["sleep", "1000"])
os.kill(os.getpid(), 9)
'''


def run_probe(folder):
    """The result of one run, and what the probe found inside."""
    (folder / "probe.py").write_text(PROBE)
    environment = dict(os.environ, JP_ODD=ODD_TEXT, JP_LINES=str(LINES))
    result = subprocess.run(
        [ROOT / SCRIPT, "--interfaces", "2", "--", "/usr/bin/python3", "probe.py", ROOT / SCRIPT, ODD_TEXT],
        cwd=folder, env=environment, umask=0o027, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False,
        timeout=LIMIT)
    assert result.stdout, result.stderr
    return result, json.loads(result.stdout.splitlines()[0])


def check_status_and_output(result):
    assert result.returncode in KILLED
    assert result.stdout.splitlines()[1:] == [f"line {number}" for number in range(LINES)]
    lines = result.stderr.splitlines()
    assert lines[0].startswith("with_vcan: ")
    # Another emulated kernel may have been waited for.
    assert [line for line in lines if not line.startswith("with_vcan: ")] == ["reopened"]


def check_surroundings(found, folder):
    assert found["argument"] == found["variable"] == ODD_TEXT
    assert found["folder"] == str(folder)
    assert found["path"] == os.environ["PATH"]
    assert found["umask"] == 0o027
    assert found["input"] == ""
    assert (folder / "written").read_text() == "from inside"


def check_interfaces(found):
    up = [line.split()[0] for line in found["links"].splitlines() if "UP" in line.rpartition("<")[2]]
    assert up == ["lo", "vcan0", "vcan1"]
    assert found["frames"].split()[1:] == ["vcan1", "123#DEADBEEF"]


def test_inside(tmp_path):
    """All that needs a boot, in one: it takes seconds, and each worker of pytest would boot a module's fixture anew."""
    folder = tmp_path / "a folder"
    folder.mkdir()
    result, found = run_probe(folder)
    check_status_and_output(result)
    check_surroundings(found, folder)
    check_interfaces(found)
    assert found["multicast"] == "goal"
    assert found["ptys"] == [f"{number}\n" for number in range(8)]
    assert found["socket"]
    assert found["nested"] == [3, "inner\n", "with_vcan: vcan of this kernel\n"]
    assert found["killed"] in KILLED


class Tree:
    """A copy of the scripts, on a machine without vcan and with stand-ins for other programs."""

    def __init__(self, folder):
        self.folder = folder
        self.commands = folder / "commands"
        self.commands.mkdir()
        shutil.copytree(ROOT / "tools", folder / "tools", ignore=shutil.ignore_patterns("__pycache__"))
        (folder / "tmp").mkdir()
        self.environment = dict(os.environ, PATH=f"{self.commands}:{os.environ['PATH']}", TMPDIR=str(folder / "tmp"),
                                JP_BUILD=str(folder / "built"))
        self.command("unshare", "exit 1")

    def command(self, name, text):
        path = self.commands / name
        path.write_text(f"#!/bin/bash\n{text}\n")
        path.chmod(0o755)

    def emulator(self, text):
        """A kernel and a QEMU that does as the text says."""
        kernel = self.folder / ".cache" / "vcan"
        kernel.mkdir(parents=True)
        shutil.copy(self.folder / "tools/operate/vcan/init.sh", kernel)
        (kernel / "vmlinux").touch()
        (kernel / "initramfs.gz").touch()
        self.command("busybox", "exit 1")
        self.command("qemu-system-x86_64", text)

    def start(self, script, *arguments):
        return subprocess.Popen([self.folder / script, *arguments], env=self.environment, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def run(self, script, *arguments, **environment):
        return subprocess.run([self.folder / script, *arguments], env={**self.environment, **environment},
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, timeout=PATIENCE)


@pytest.fixture
def tree(tmp_path):
    return Tree(tmp_path)


BOOTED = "touch booted; exec >stdout 2>stderr; "


def test_emulator_passes_status_and_both_outputs(tree):
    tree.emulator(BOOTED + "echo out; echo err >&2; echo 42 >status")
    result = tree.run(SCRIPT, "--", "true")
    assert (result.returncode, result.stdout) == (42, "out\n")
    assert result.stderr.splitlines()[1:] == ["err"]
    assert not list((tree.folder / "tmp").iterdir())


def test_missing_kernel_is_told(tree):
    assert_one_line_error(tree.run(SCRIPT, "--", "true"), "no vcan", "tools/setup.sh vcan")


def test_kernel_of_another_version_of_the_scripts_is_not_used(tree):
    tree.emulator("exit 1")
    (tree.folder / ".cache" / "vcan" / "init.sh").write_text("old")
    assert_one_line_error(tree.run(SCRIPT, "--", "true"), "no vcan", "tools/setup.sh vcan")


@pytest.mark.parametrize("machine, reason", [
    ("echo out of memory >&2; exit 1", "ended before it had booted"),
    (BOOTED + "echo out of memory >>boot.log", "broke down while the command ran"),
])
def test_failed_emulation_is_told_with_its_log(tree, machine, reason):
    tree.emulator(machine)
    result = tree.run(SCRIPT, "--", "true")
    assert result.returncode == 2
    log = tree.folder / "built" / "with_vcan.log"
    _, message, error = result.stderr.splitlines()
    assert message == "out of memory"
    assert reason in error and str(log) in error
    assert "out of memory" in log.read_text()


def process_ended(pid):
    """Also as a zombie that nobody waits for."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] in "ZX"
    except FileNotFoundError:
        return True


@pytest.mark.parametrize("sent", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGKILL])
@pytest.mark.parametrize("machine", ["", BOOTED], ids=["booting", "running"])
def test_no_emulator_survives_the_script(tree, machine, sent):
    pid = tree.folder / "pid"
    tree.emulator(f"{machine}echo $$ >{pid}.new; mv {pid}.new {pid}; exec sleep 1000")
    script = tree.start(SCRIPT, "--", "true")
    wait_until(pid.exists, "the emulator")
    script.send_signal(sent)
    script.communicate(timeout=PATIENCE)
    assert script.returncode == (-sent if sent == signal.SIGKILL else 128 + sent)
    wait_until(lambda: process_ended(int(pid.read_text())), "the emulator's end")


def test_nothing_starts_that_has_outlived_the_script(tree):
    """Its children ask to die with it only after it was killed: what they would run holds its outputs open."""
    tree.emulator("exec sleep 1000")
    started = tree.folder / "started"
    tree.command("setpriv", f'echo >>{started}; while kill -0 $PPID 2>/dev/null; do sleep 0.01; done; '
                 f'exec {shutil.which("setpriv")} "$@"')
    script = tree.start(SCRIPT, "--", "true")
    wait_until(lambda: started.exists() and len(started.read_text()) == 3, "two cats and the emulator")
    script.kill()
    script.wait(PATIENCE)
    script.communicate(timeout=PATIENCE)


def test_emulators_run_one_at_a_time(tree):
    """Each runs until its gate is read from, and finds no other one."""
    tree.emulator(BOOTED + f'mkdir {tree.folder}/only || exit; mkfifo {tree.folder}/gate.$$; echo >{tree.folder}/gate.$$; '
                  f'rm {tree.folder}/gate.$$; rmdir {tree.folder}/only; echo 0 >status')
    scripts = [tree.start(SCRIPT, "--", "true")]
    wait_until(lambda: gates(tree), "the first emulator")
    scripts += [tree.start(SCRIPT, "--", "true") for _ in range(2)]
    for script in scripts[1:]:
        assert any("waits for another" in line for line in script.stderr)
    for _ in scripts:
        wait_until(lambda: gates(tree), "an emulator")
        [gate] = gates(tree)
        gate.read_text()
        wait_until(lambda: not gate.exists(), "its end")
    errors = [script.communicate(timeout=PATIENCE)[1] for script in scripts]
    assert [script.returncode for script in scripts] == [0, 0, 0], errors


def gates(tree):
    return list(tree.folder.glob("gate.*"))


@pytest.mark.parametrize("arguments", [
    [], ["true"], ["--"], ["--interfaces"], ["--interfaces", "0", "--", "true"], ["--interfaces", "17", "--", "true"],
    ["--interfaces", "two", "--", "true"], ["--interfaces", "2", "true"],
])
def test_wrong_command_line_is_one_line(tree, arguments):
    assert_one_line_error(tree.run(SCRIPT, *arguments), "usage: tools/operate/with_vcan.sh")


def test_missing_tool_is_told(tree):
    for tool in ("bash", "dirname", "env"):
        (tree.commands / tool).symlink_to(shutil.which(tool))
    assert_one_line_error(tree.run(SCRIPT, "--", "true", PATH=str(tree.commands)), "no ip", "tools/setup.sh vcan")


PACKAGE = "linux-image-6.1.0-99-amd64"


@pytest.mark.parametrize("download, part", [
    ("exit 100", "apt-get download"),
    (f"echo half >{PACKAGE}_6.1_amd64.deb", "could not unpack"),
    (f"echo half >{PACKAGE}_6.1_amd64.deb; exit 100", "apt-get download"),
], ids=["no download", "half a package", "broken off"])
def test_failed_fetch_leaves_nothing_half_made(tree, download, part):
    tree.command("apt-cache", f"echo '  Depends: {PACKAGE}'")
    tree.command("apt-get", f'[ "$1" = update ] && exit 1; {download}')
    tree.command("sudo", "exit 1")
    tree.emulator("exit 1")
    kernel = tree.folder / ".cache" / "vcan"
    before = sorted(kernel.iterdir())
    assert_one_line_error(tree.run("tools/operate/vcan/kernel.sh"), "setup: ", part)
    assert list(kernel.parent.iterdir()) == [kernel]
    assert sorted(kernel.iterdir()) == before


def test_setup_says_that_vcan_is_missing(tree):
    result = tree.run("tools/setup.sh", "vcan", JP_SETUP="skip")
    assert_one_line_error(result, "JP_SETUP=skip, and missing: ", "vcan in this kernel", "tools/operate/vcan/kernel.sh")


def test_setup_of_the_simulator_needs_no_vcan(tree):
    assert "vcan in this kernel" not in tree.run("tools/setup.sh", "sil", JP_SETUP="skip").stderr
