"""tools.campaign, with fake_trip.py for the program: whole campaigns on this machine and on a real scheduler of
Dask, interrupted ones, failures, the report against figures reckoned by hand."""
import contextlib
import json
import signal
import subprocess
import sys
from pathlib import Path

import fake_trip
import pytest
from conftest import ROOT, assert_one_line_error, run_tool
from programs import LIMIT, wait_until

from tools import common
from tools.campaign import campaign_cluster, campaign_report, campaign_store, campaign_task
from tools.measure.figure_store import read_figures

PROGRAM = Path(fake_trip.__file__).resolve()
PNG = b"\x89PNG\r\n\x1a\n"
DRAW = campaign_report.picture


class Campaign:
    """A robot, its program's orders, and the folder of its results."""

    def __init__(self, folder):
        self.folder = folder
        self.robot = folder / "walker.cfg"
        self.robot.write_text("# does as it should\n")
        self.program = folder / "fake_trip.py"
        # By this Python itself: one that is looked up may take longer to start than to run.
        self.program.write_text(f"#!{sys.executable} -IS\n" + PROGRAM.read_text().split("\n", 1)[1])
        self.program.chmod(0o755)
        self.output = folder / "output"

    def orders(self, *lines):
        self.robot.write_text("".join(f"{line}\n" for line in lines))

    def hold(self, *seeds):
        """The programs wait there until it is let go. Its orders are the same when it goes on."""
        gate = self.folder / "held"
        self.orders(*(f"hang {seed} {gate}" for seed in seeds))
        gate.touch()

    def wait_until_held(self, *batches):
        """All but the batches that are under way are kept."""
        wait_until(lambda: {*batches} <= {*self.starts()}, f"the start of {batches}")
        wait_until(lambda: len(list((self.output / "batches").glob("*.jsonl"))) == len(self.starts()) - len(batches),
                   "the batches before it")

    def let_go(self):
        (self.folder / "held").unlink()

    def command(self, *options, output=None, workers=2):
        return [self.robot, "--program", self.program, "--output", output or self.output,
                *(["--workers", workers] if workers else []), *options]

    def run(self, *options, **settings):
        return run_tool("campaign.campaign", *self.command(*options, **settings))

    def start(self, *options, **settings):
        command = [sys.executable, "-m", "tools.campaign.campaign", *self.command(*options, **settings)]
        return subprocess.Popen(list(map(str, command)), cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                text=True)

    def starts(self):
        """(first seed, count) of each start of the program."""
        log = self.robot.with_suffix(".log")
        return [tuple(map(int, line.split())) for line in log.read_text().splitlines()] if log.exists() else []

    def seeds_run(self):
        return sorted(seed for first, count in self.starts() for seed in range(first, first + count))

    def forget_starts(self):
        self.robot.with_suffix(".log").unlink()

    def kept(self):
        files = sorted((self.output / "batches").glob("*"))
        return sorted(json.loads(line)["seed"] for file in files for line in file.read_text().splitlines())

    def report(self, output=None):
        return json.loads(((output or self.output) / "campaign.json").read_text())


@pytest.fixture
def campaign(tmp_path, monkeypatch):
    """Without its picture, which takes longest."""
    monkeypatch.setattr(campaign_report, "picture", lambda *_: PNG)
    return Campaign(tmp_path)


def programs_of(campaign):
    """Processes that run this campaign's program."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            command = (folder / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if str(campaign.program).encode() in command and str(campaign.robot).encode() in command and \
                b"--program" not in command:
            found.append(int(folder.name))
    return found


def missions(first, count, faults=False, robot="walker"):
    return [fake_trip.mission(robot, seed, faults) for seed in range(first, first + count)]


# ---- whole campaigns -----------------------------------------------------------------------------------------------

def test_every_seed_is_run_once_and_reported(campaign, monkeypatch):
    monkeypatch.setattr(campaign_report, "picture", DRAW)
    result = campaign.run("--missions", 45, "--seed", 7, "--batch", 10)
    assert (result.returncode, result.stderr) == (0, ""), result.stderr
    assert campaign.kept() == campaign.seeds_run() == list(range(7, 52))
    assert sorted(campaign.starts()) == [(7, 10), (17, 10), (27, 10), (37, 10), (47, 5)]
    report = campaign.report()
    assert report["missions"] == 45 and report["groups"][0]["missions"] == 45
    picture = (campaign.output / "campaign.png").read_bytes()
    assert picture.startswith(PNG) and len(picture) > 20_000
    assert "campaign.json" in result.stdout and "campaign.png" in result.stdout


def test_results_depend_on_seeds_alone(campaign):
    reports = []
    for workers, batch in ((1, 40), (4, 3), (2, 7)):
        output = campaign.folder / f"of-{workers}"
        assert campaign.run("--missions", 40, "--batch", batch, workers=workers, output=output).returncode == 0
        reports.append((output / "campaign.json").read_bytes())
    assert reports[0] == reports[1] == reports[2]


def test_small_campaigns_use_all_workers(campaign):
    assert campaign.run("--missions", 6, workers=3).returncode == 0
    assert sorted(campaign.starts()) == [(1, 2), (3, 2), (5, 2)]


def test_faults_are_passed_on(campaign):
    assert campaign.run("--missions", 30, "--faults").returncode == 0
    names = {(group["kind"], group["name"]) for group in campaign.report()["groups"]}
    assert {("fault", "imu"), ("fault", "encoder"), ("fault", "none"), ("change", "payload")} <= names
    assert campaign.report()["settings"]["faults"] is True


def test_a_robot_of_the_project_is_named(campaign, monkeypatch):
    monkeypatch.setenv("JP_BUILD", str(campaign.folder / "build"))
    monkeypatch.chdir(campaign.folder)
    robot = common.ROOT / "sim/robots/courier24.cfg"
    program = campaign.folder / "build/bin/jp-trip"
    program.parent.mkdir(parents=True)
    lines = (json.dumps(fake_trip.mission("courier24", seed, False)) for seed in (1, 2))
    program.write_text(f"#!/bin/sh\ntest $1 = {robot} && cat <<END\n" + "\n".join(lines) + "\nEND\n")
    program.chmod(0o755)
    result = run_tool("campaign.campaign", "courier24", "--missions", 2, "--workers", 1)
    assert result.returncode == 0, result.stderr
    assert (campaign.folder / "build/campaign/courier24/campaign.json").exists()


def test_a_campaign_without_a_mission_done_is_reported(campaign, monkeypatch):
    monkeypatch.setattr(campaign_report, "picture", DRAW)
    fallen = {**fake_trip.mission("walker", 1, False), "outcome": "fell", "measured_j": 0, "std_j": 0}
    campaign.orders(f"print 1 {json.dumps(fallen)}")
    result = campaign.run("--missions", 1)
    assert result.returncode == 0, result.stderr
    assert campaign.report()["groups"][0]["coverage"]["percent"] is None
    assert not (campaign.output / "campaign.png").exists()
    result = campaign.run("--missions", 1, "--bench", campaign.folder / "bench.json")
    assert_one_line_error(result, "no mission is done")


# ---- going on ------------------------------------------------------------------------------------------------------

def test_ctrl_c_keeps_what_there_is_and_only_the_rest_is_run(campaign):
    campaign.hold(7, 9)
    process = campaign.start("--missions", 40, "--batch", 2)
    campaign.wait_until_held((7, 2), (9, 2))
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=LIMIT)
    kept = campaign.kept()
    assert process.returncode == 130, stderr
    assert stderr == (f"campaign.py: interrupted; 6 of 40 missions are kept in {campaign.output}; the same command "
                      "goes on with the others\n")
    assert kept == [1, 2, 3, 4, 5, 6]
    assert programs_of(campaign) == []
    assert not (campaign.output / "campaign.json").exists()

    campaign.let_go()
    campaign.forget_starts()
    result = campaign.run("--missions", 40, "--batch", 4)
    assert result.returncode == 0, result.stderr
    assert campaign.seeds_run() == sorted(set(range(1, 41)) - set(kept))
    whole = campaign_report.report(campaign.report()["settings"], missions(1, 40))
    assert campaign.report() == json.loads(json.dumps(whole))


def test_a_killed_campaign_leaves_whole_files(campaign):
    campaign.hold(5, 7)
    process = campaign.start("--missions", 40, "--batch", 2)
    campaign.wait_until_held((5, 2), (7, 2))
    process.kill()
    campaign.let_go()
    process.communicate(timeout=LIMIT)
    wait_until(lambda: programs_of(campaign) == [], "the programs' end")
    assert campaign.kept() == [1, 2, 3, 4]
    campaign.forget_starts()
    assert campaign.run("--missions", 40).returncode == 0
    assert campaign.seeds_run() == list(range(5, 41))


def test_a_finished_campaign_runs_nothing(campaign):
    assert campaign.run("--missions", 20).returncode == 0
    before = campaign.report()
    campaign.forget_starts()
    assert campaign.run("--missions", 20).returncode == 0
    assert campaign.starts() == [] and campaign.report() == before


def test_a_campaign_goes_on_to_more_missions_and_reports_fewer(campaign):
    assert campaign.run("--missions", 20).returncode == 0
    campaign.forget_starts()
    assert campaign.run("--missions", 30, "--batch", 3).returncode == 0
    assert campaign.seeds_run() == list(range(21, 31))
    assert campaign.run("--missions", 10).returncode == 0
    assert campaign.report()["missions"] == 10


def test_a_lost_batch_is_run_again(campaign):
    assert campaign.run("--missions", 20, "--batch", 5).returncode == 0
    (campaign.output / "batches" / "0000006-0000010.jsonl").unlink()
    campaign.forget_starts()
    assert campaign.run("--missions", 20).returncode == 0
    assert campaign.seeds_run() == [6, 7, 8, 9, 10]


@pytest.mark.parametrize("option, word", [(["--seed", 2], "seed (was 1, is 2)"), (["--faults"], "faults (was False")])
def test_other_settings_are_refused(campaign, option, word):
    assert campaign.run("--missions", 10).returncode == 0
    before = campaign.report()
    campaign.forget_starts()
    result = campaign.run("--missions", 10, *option)
    assert_one_line_error(result, word, "--fresh", "--output")
    assert campaign.starts() == [] and campaign.report() == before
    assert campaign.run("--missions", 10, *option, "--fresh").returncode == 0
    assert len(campaign.seeds_run()) == 10


def test_another_program_or_robot_file_is_refused(campaign):
    assert campaign.run("--missions", 4).returncode == 0
    with campaign.program.open("a") as program:
        program.write("# another build\n")
    assert_one_line_error(campaign.run("--missions", 4), "other settings: program (was ")
    campaign.orders("fail 5")
    assert_one_line_error(campaign.run("--missions", 4), "program (was ", "robot_file (was ")


def test_fresh_removes_the_campaign_and_nothing_else(campaign):
    assert campaign.run("--missions", 4).returncode == 0
    strangers = [campaign.output / "notes.txt", campaign.output / "batches" / "mine.jsonl"]
    for path in strangers:
        path.write_text("keep me")
    campaign.forget_starts()
    assert campaign.run("--missions", 4, "--fresh").returncode == 0
    assert campaign.seeds_run() == [1, 2, 3, 4] and all(path.read_text() == "keep me" for path in strangers)


# ---- failures ------------------------------------------------------------------------------------------------------

def test_a_batch_that_fails_once_is_run_again(campaign):
    campaign.orders(f"fail 6 {campaign.folder / 'failed-once'}")
    result = campaign.run("--missions", 12, "--batch", 4)
    assert result.returncode == 0, result.stderr
    assert campaign.starts().count((5, 4)) == 2 and len(campaign.starts()) == 4
    assert campaign.kept() == list(range(1, 13))


RUN = subprocess.run


def limited_at_seed_5(command, *, timeout, **options):
    """A busy machine may take longer than the limit for the other batches too."""
    assert timeout == 2
    return RUN(command, timeout=timeout if command[-3] == "5" and "hang" in Path(command[1]).read_text() else LIMIT,
               **options)


@pytest.mark.parametrize("order, words", [
    ("fail 6", ["ended with exit status 1: fake_trip: no such seed: 6"]),
    ("die 6", ["died of SIGSEGV"]),
    ("hang 6", ["took longer than 2 s"]),
    ("print 6 nonsense", ["line 2 is no JSON: 'nonsense'"]),
    ("print 6 {}", ["line 2: variation is missing"]),
])
def test_a_batch_that_fails_twice_is_named_and_the_rest_is_kept(campaign, order, words, monkeypatch):
    campaign.orders(order)
    monkeypatch.setattr(campaign_task.subprocess, "run", limited_at_seed_5)
    result = campaign.run("--missions", 12, "--batch", 4, "--mission-limit", 0.5)
    assert_one_line_error(result, "seeds 5…8: ", *words, "8 of 12 missions are kept")
    assert campaign.starts().count((5, 4)) == 2
    assert campaign.kept() == [1, 2, 3, 4, 9, 10, 11, 12]
    assert not (campaign.output / "campaign.json").exists()
    assert programs_of(campaign) == []


def test_after_three_failed_batches_no_more_are_run(campaign):
    campaign.orders(*(f"fail {seed}" for seed in range(1, 101)))
    result = campaign.run("--missions", 100, "--batch", 1, workers=1)
    assert_one_line_error(result, "failed twice: seeds 1, 2, 3: ", "0 of 100 missions are kept")
    assert set(campaign.seeds_run()) < set(range(1, 10))


def test_a_program_that_changes_meanwhile_fails(campaign):
    campaign.hold(3)
    process = campaign.start("--missions", 40, "--batch", 2, workers=1)
    campaign.wait_until_held((3, 2))
    with campaign.program.open("a") as program:
        program.write("# another build\n")
    campaign.let_go()
    _, stderr = process.communicate(timeout=LIMIT)
    assert process.returncode == 2
    assert stderr.count("\n") == 1 and "is not the file that the campaign began with" in stderr


def test_kept_batches_that_are_damaged_are_named(campaign):
    assert campaign.run("--missions", 4, "--batch", 2).returncode == 0
    batch = campaign.output / "batches" / "0000003-0000004.jsonl"
    batch.write_text(batch.read_text().replace('"seed": 3', '"seed": 5'))
    assert_one_line_error(campaign.run("--missions", 4), "0000003-0000004.jsonl", "seeds 3…4", "remove it")
    (campaign.output / "settings.json").write_text("[]")
    assert_one_line_error(campaign.run("--missions", 4), "settings.json", "--fresh")
    (campaign.output / "settings.json").unlink()
    assert_one_line_error(campaign.run("--missions", 4), "no settings.json", "--fresh")


# ---- bad input -----------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("options, word", [
    (["--missions", "0"], "--missions"), (["--missions", "many"], "--missions"), (["--seed", "-1"], "--seed"),
    (["--workers", "0"], "--workers"), (["--batch", "0"], "--batch"), (["--mission-limit", "0"], "--mission-limit"),
    (["--mission-limit", "nan"], "--mission-limit"),
])
def test_bad_options(campaign, options, word):
    assert_one_line_error(campaign.run(*options), f"campaign.py: {word}: {options[1]}: must be a ")
    assert not campaign.output.exists()


def test_options_that_do_not_fit_together(campaign):
    assert_one_line_error(campaign.run("--seed", 2**32 - 1, "--missions", 2), "last seed")
    assert_one_line_error(campaign.run("--scheduler", "tcp://127.0.0.1:1"), "--workers")


def test_missing_files(campaign):
    campaign.program.chmod(0o644)
    assert_one_line_error(campaign.run(), str(campaign.program), "not a program")
    campaign.program.unlink()
    assert_one_line_error(campaign.run(), str(campaign.program), "No such file", "--program")
    campaign.program.write_text("")
    campaign.robot.unlink()
    assert_one_line_error(campaign.run(), str(campaign.robot), "No such file")
    assert not campaign.output.exists()


def test_an_output_that_cannot_be_written(campaign):
    campaign.output.write_text("a file")
    assert_one_line_error(campaign.run(), "output")


# ---- a scheduler ---------------------------------------------------------------------------------------------------

class DaskCluster:
    """dask scheduler and workers of one thread, on this machine; ends them with a `with`."""

    def __init__(self, folder):
        self._folder = folder
        self._processes = []
        self._file = folder / "scheduler.json"
        self.scheduler = self._start("scheduler", "--port", "0", "--host", "127.0.0.1", "--no-dashboard",
                                     "--dashboard-address", "127.0.0.1:0", "--scheduler-file", self._file)
        self.address = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in self._processes:
            process.kill()
            process.wait()

    def wait(self):
        wait_until(self._has_address, "the scheduler's start")

    def start_worker(self):
        return self._start("worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--host",
                           "127.0.0.1", "--death-timeout", LIMIT)

    def _has_address(self):
        """The file may be there before its text."""
        with contextlib.suppress(OSError, ValueError):
            self.address = json.loads(self._file.read_text())["address"]
        return self.address is not None

    def _start(self, *command):
        with (self._folder / f"dask-{len(self._processes)}.log").open("w") as log:
            process = subprocess.Popen([sys.executable, "-m", "dask", *map(str, command)], cwd=self._folder, stdout=log,
                                       stderr=log)
        self._processes.append(process)
        return process


@pytest.fixture
def cluster(tmp_path, monkeypatch):
    monkeypatch.setattr(campaign_cluster, "CONNECT_LIMIT", LIMIT)
    with DaskCluster(tmp_path) as dask:
        dask.wait()
        yield dask


def test_a_scheduler_runs_the_same_campaign_though_a_worker_is_lost(campaign, cluster):
    here = campaign.folder / "here"
    first, _ = cluster.start_worker(), cluster.start_worker()
    campaign.hold(*range(9, 41))
    campaign.let_go()
    assert campaign.run("--missions", 40, output=here).returncode == 0
    campaign.forget_starts()
    campaign.hold(*range(9, 41))
    process = campaign.start("--missions", 40, "--batch", 4, "--scheduler", cluster.address, workers=None)
    wait_until(lambda: len(campaign.starts()) == 4, "a batch that is held on each worker")
    first.kill()
    campaign.let_go()
    _, stderr = process.communicate(timeout=LIMIT)
    assert process.returncode == 0, stderr
    assert (campaign.output / "campaign.json").read_bytes() == (here / "campaign.json").read_bytes()


def test_a_scheduler_without_workers_is_left(campaign, cluster, monkeypatch):
    wait = campaign_cluster.Client.wait_for_workers
    monkeypatch.setattr(campaign_cluster.Client, "wait_for_workers",
                        lambda self, count, timeout: wait(self, count, timeout=0.5))
    result = campaign.run("--scheduler", cluster.address, workers=None)
    assert_one_line_error(result, cluster.address, "has no worker", "0 of 1000 missions are kept")


def kill_in_a_mission(campaign, victim):
    campaign.program.write_text(f"#!/bin/sh\nkill -KILL {victim.pid}\n")


def test_a_scheduler_that_loses_all_workers_is_left(campaign, cluster, monkeypatch):
    monkeypatch.setattr(campaign_cluster, "WORKERLESS_LIMIT", 0.5)
    monkeypatch.setattr(campaign_cluster, "WATCH_PERIOD", 0.2)
    kill_in_a_mission(campaign, cluster.start_worker())
    result = campaign.run("--missions", 4, "--batch", 2, "--scheduler", cluster.address, workers=None)
    assert_one_line_error(result, "no worker has been there for 0.5 s", "0 of 4 missions are kept")


def test_a_scheduler_that_dies_ends_the_campaign(campaign, cluster):
    cluster.start_worker()
    kill_in_a_mission(campaign, cluster.scheduler)
    process = campaign.start("--missions", 4, "--batch", 2, "--scheduler", cluster.address, workers=None)
    stdout, stderr = process.communicate(timeout=LIMIT)
    assert (process.returncode, stdout) == (2, "")
    assert stderr.count("\n") == 1 and "connection to the scheduler was lost; 0 of 4 missions are kept" in stderr


def test_files_that_workers_lack_are_named(campaign, cluster, monkeypatch):
    cluster.start_worker()
    options = ["--missions", 4, "--scheduler", cluster.address]
    monkeypatch.setattr(campaign_task, "fingerprint", lambda path: "0" * 64)
    result = campaign.run(*options, workers=None)
    assert_one_line_error(result, "worker tcp://127.0.0.1:", str(campaign.program), "same files at the same paths")
    assert campaign.starts() == []


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nonsense://here:1", "tcp://127.0.0.1:port"])
def test_a_scheduler_that_is_not_there(campaign, monkeypatch, address):
    monkeypatch.setattr(campaign_cluster, "CONNECT_LIMIT", 0.5)
    assert_one_line_error(campaign.run("--scheduler", address, workers=None), f"--scheduler {address}: ", "kept")


# ---- what the program prints ---------------------------------------------------------------------------------------

def changed(key, value):
    """A mission with another value, or without the key."""
    mission = fake_trip.mission("walker", 1, True)
    *groups, name = key.split(".")
    place = mission
    for group in groups:
        place = place[group]
    if value is KeyError:
        del place[name]
    else:
        place[name] = value
    return mission


def test_the_fake_prints_what_is_agreed():
    for mission in missions(1, 200, faults=True):
        campaign_task.check_mission(mission)


@pytest.mark.parametrize("key", [key for keys, _, _ in campaign_task.KINDS for key in keys])
def test_every_key_is_needed_and_of_its_kind(key):
    with pytest.raises(RuntimeError, match=key):
        campaign_task.check_mission(changed(key, KeyError))
    with pytest.raises(RuntimeError, match=key):
        campaign_task.check_mission(changed(key, []))


@pytest.mark.parametrize("key, value", [
    ("measured_j", float("nan")), ("std_j", float("inf")), ("measured_j", True), ("seed", 1.0), ("seed", -1),
    ("inside", 1), ("robot", None), ("outcome", "won"), ("variation", 3), ("variation", {}),
    ("learned", {"payload_kg": None}),
])
def test_values_that_are_almost_right(key, value):
    with pytest.raises(RuntimeError, match=key.split(".", maxsplit=1)[0]):
        campaign_task.check_mission(changed(key, value))


@pytest.mark.parametrize("key", ["measured_j", "std_j"])
def test_a_mission_that_is_done_took_energy(key):
    mission = {**changed(key, 0), "outcome": "done"}
    with pytest.raises(RuntimeError, match="above 0"):
        campaign_task.check_mission(mission)
    campaign_task.check_mission({**mission, "outcome": "fell"})


@pytest.mark.parametrize("seeds", [[], [5], [5, 6, 7], [6, 5], [5, 5], [6, 7]])
def test_lines_are_of_the_seeds_in_turn(seeds):
    text = "".join(json.dumps(fake_trip.mission("walker", seed, False)) + "\n" for seed in seeds)
    with pytest.raises(RuntimeError, match="seeds 5…6"):
        campaign_task.parse_missions(text, 5, 2)


def test_runs_of_seeds():
    assert campaign_store.runs([1, 2, 3, 7, 8, 10], 2) == [(1, 2), (3, 1), (7, 2), (10, 1)]
    assert campaign_store.runs([], 2) == []
    assert campaign_store.span(4, 1) == "4" and campaign_store.span(4, 3) == "4…6"


# ---- the report ----------------------------------------------------------------------------------------------------

def mission(seed, measured=100.0, predicted=100.0, std=10.0, prior=50.0, **others):
    return {**fake_trip.mission("walker", seed, False), "outcome": "done", "change": None, "measured_j": measured,
            "predicted_j": predicted, "std_j": std, "prior_predicted_j": prior,
            "inside": abs(measured - predicted) <= 1.96 * std,
            "reserve": {"asked": False, "answer": False, "true": False}, **others}


def figures(*missions):
    return campaign_report.figures_of(list(missions))


def test_errors_are_relative_to_the_measured_energy():
    found = figures(mission(1, measured=50), mission(2, measured=200), mission(3))
    assert found["error"]["mean_percent"] == pytest.approx((100 + 50 + 0) / 3)
    assert found["error"]["percentile_95_percent"] == pytest.approx(95)
    assert found["unlearned_error"]["mean_percent"] == pytest.approx((0 + 75 + 50) / 3)


def test_energies_are_of_missions_that_are_done():
    fell, stopped = mission(3, measured=1, outcome="fell"), mission(4, measured=1, outcome="stopped")
    found = figures(mission(1), mission(2), fell, stopped)
    assert (found["missions"], found["done"]) == (4, 2)
    assert found["outcome_percent"] == {"done": 50, "fell": 25, "stopped": 25}
    assert found["error"]["mean_percent"] == 0 and found["coverage"]["percent"] == 100


def test_coverage_has_the_exact_binomial_interval():
    outside = [mission(seed, measured=130.0) for seed in range(5)]
    coverage = figures(*(mission(seed) for seed in range(95)), *outside)["coverage"]
    # Clopper and Pearson's interval of 95 of 100.
    assert coverage == pytest.approx({"percent": 95, "from_percent": 88.7165, "to_percent": 98.3568}, abs=1e-3)


def test_reserve_answers():
    answers = [(True, True), (False, False), (True, False), (False, True), (False, True)]
    asked = [mission(seed, reserve={"asked": True, "answer": answer, "true": true})
             for seed, (answer, true) in enumerate(answers)]
    assert figures(*asked, mission(9))["reserve"] == {"asked": 5, "right_percent": 40, "optimistic_percent": 20,
                                                      "pessimistic_percent": 40}
    assert figures(mission(1))["reserve"]["right_percent"] is None


def test_groups_by_fault_and_change():
    found = campaign_report.report({}, [mission(1, change="payload"), mission(2), mission(3, change="payload")])
    assert [(group["kind"], group["name"], group["missions"]) for group in found["groups"]] == [
        ("all", "all", 3), ("change", "none", 1), ("change", "payload", 2)]


def test_tables_are_aligned_and_have_a_row_each(campaign):
    result = campaign.run("--missions", 60, "--faults")
    rows = [line for line in result.stdout.splitlines() if line.startswith("fault: imu")]
    group = next(group for group in campaign.report()["groups"] if group["name"] == "imu")
    assert len(rows) == 2
    assert rows[0].split()[2:5] == [str(group["missions"]), *(f"{group['outcome_percent'][outcome]:.1f}"
                                                              for outcome in ("done", "fell"))]
    assert rows[1].split()[2:4] == [str(group["done"]), f"{group['coverage']['percent']:.1f}"]
    tables = [table.splitlines() for table in result.stdout.split("\n\n")[:2]]
    for table in tables:
        assert len(table) == 1 + len(campaign.report()["groups"])


def test_bench_figures_fit_the_collector(campaign):
    bench = campaign.folder / "campaign.json"
    result = campaign.run("--missions", 300, "--bench", bench)
    assert result.returncode == 0, result.stderr
    first = read_figures(bench)[0]
    coverage = campaign.report()["groups"][0]["coverage"]["percent"]
    assert first["value"] == pytest.approx(abs(coverage - 95)) and first["bound"] == {"op": "<=", "value": 2}
    assert first["command"] == f"make campaign ROBOT={campaign.robot} MISSIONS=300 SEED=1"


def test_bench_misses_its_bar_on_either_side():
    for measured in (100, 130):
        report = campaign_report.report({"robot": "walker", "faults": True}, [mission(1, measured=measured)])
        first = campaign_report.bench(report, "x")[0]
        assert first["value"] > first["bound"]["value"]
        assert first["name"].startswith("campaign of 1 unseen missions, walker, with faults: ")
