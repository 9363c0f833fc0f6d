#!/usr/bin/env python3
"""Run a campaign: thousands of missions of a robot, each varied by its seed, on all cores or on a Dask cluster.

What is kept of an interrupted campaign is gone on with when it is started again. Writes DIR/campaign.json and
DIR/campaign.png. Exit status 2: bad input, or missions failed; 130: interrupted. The missions so far are kept.
"""
import argparse
import contextlib
import json
import os
import shlex
import sys
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from tools.campaign import campaign_cluster, campaign_report, campaign_task
from tools.campaign.campaign_store import Store, default_folder, runs, span
from tools.common import (ArgumentParser, ToolError, print_aligned, real_number, run, shown_path, whole_number,
                          write_whole)
from tools.design import robot_json

EXIT_INTERRUPTED = 130
SEED_MAX = 2**32 - 1
MISSIONS_MAX = 1_000_000
BATCH = 20            # missions: a task takes seconds
FAILURES_MAX = 3      # batches, after which no more are run
MISSION_LIMIT = 60.0  # s


# ---- command line --------------------------------------------------------------------------------------------------

def arguments():
    build = robot_json.build_directory()
    parser = ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", help="name, or path of its .cfg file")
    parser.add_argument("--missions", metavar="N", type=whole_number(1, MISSIONS_MAX), default=1000,
                        help="default: %(default)s; a campaign can be gone on with to more")
    parser.add_argument("--seed", metavar="S", type=whole_number(0, SEED_MAX), default=1,
                        help="of the first mission; the others' follow (default: %(default)s)")
    parser.add_argument("--faults", action="store_true", help="parts of the robots fail on the way")
    parser.add_argument("--output", metavar="DIR", type=Path, help="default: build/campaign/ROBOT")
    parser.add_argument("--fresh", action="store_true", help="forget the missions that DIR keeps")
    parser.add_argument("--scheduler", metavar="ADDRESS",
                        help="of Dask, as tcp://host:8786; its workers need the same files at the same paths")
    parser.add_argument("--workers", metavar="N", type=whole_number(1, 4096),
                        help="missions that run at once on this machine (default: its cores)")
    parser.add_argument("--batch", metavar="N", type=whole_number(1, MISSIONS_MAX),
                        help=f"missions a task (default: {BATCH}, or fewer so that all cores work)")
    parser.add_argument("--mission-limit", metavar="S", type=real_number(0.001, 1e6), default=MISSION_LIMIT,
                        help="a batch that takes longer than this a mission has failed (default: %(default)g s)")
    parser.add_argument("--program", metavar="FILE", type=Path, default=build / "bin" / "jp-trip",
                        help="what runs the missions (default: build/bin/jp-trip)")
    parser.add_argument("--bench", metavar="FILE", type=Path, help="write the figures for tools/measure/figures.py")
    options = parser.parse_args()
    if options.seed + options.missions - 1 > SEED_MAX:
        raise ToolError(f"--seed {options.seed} --missions {options.missions}: the last seed is above {SEED_MAX}")
    if options.scheduler is not None and options.workers is not None:
        raise ToolError("--workers: is for this machine; the scheduler has its own")
    return options


def fingerprint(path, advice):
    try:
        return campaign_task.fingerprint(path)
    except RuntimeError as error:
        raise ToolError(f"{error}; {advice}") from None


def job_of(options, robot):
    program = options.program.resolve()
    fingerprints = {str(program): fingerprint(program, "build it with `make`, or name it by --program"),
                    str(robot): fingerprint(robot, "a robot is a name of sim/robots or a .cfg file")}
    if not os.access(program, os.X_OK):
        raise ToolError(f"{program}: not a program that can be run")
    command = [str(program), str(robot), *(["--faults"] if options.faults else [])]
    return campaign_cluster.Job(command, fingerprints, options.mission_limit)


def settings_of(options, job):
    """What the missions depend on besides their seeds; and the first seed, so that ranges do not mix by mistake."""
    program, robot = job.fingerprints.values()
    return {"robot": Path(job.command[1]).stem, "seed": options.seed, "faults": options.faults, "program": program,
            "robot_file": robot}


# ---- missions ------------------------------------------------------------------------------------------------------

def progress_bar():
    console = Console(stderr=True)
    return Progress(TextColumn("missions"), BarColumn(bar_width=None), MofNCompleteColumn(), TimeRemainingColumn(),
                    TextColumn("{task.fields[failed]}"), console=console, disable=not console.is_terminal,
                    transient=True, expand=True)


def open_client(options, job, threads):
    if options.scheduler is None:
        return campaign_cluster.local_client(job, threads)
    return campaign_cluster.remote_client(job, options.scheduler)


def threads_of(client):
    return max(1, sum(client.nthreads().values()))


def run_batches(client, job, store, batches, bar, task):
    """Keeps the batches that succeed; those that failed. After too many, the rest are left."""
    failed = []
    with contextlib.closing(campaign_cluster.results(client, job, batches)) as results:
        for result in results:
            if result.failure is None:
                store.keep(result.first, result.count, result.text)
                bar.advance(task, result.count)
            else:
                failed.append(result)
                bar.update(task, failed=f"{len(failed)} failed")
            if len(failed) == FAILURES_MAX:
                break
    return failed


def run_missing(options, job, store, missing):
    """The batches that failed."""
    with open_client(options, job, options.workers or os.cpu_count()) as client, progress_bar() as bar:
        batch = options.batch or min(BATCH, -(-len(missing) // threads_of(client)))
        task = bar.add_task("", total=options.missions, completed=options.missions - len(missing), failed="")
        return run_batches(client, job, store, runs(missing, batch), bar, task)


def missing_seeds(options, store):
    kept = store.seeds()
    return [seed for seed in range(options.seed, options.seed + options.missions) if seed not in kept]


def kept_line(options, store):
    kept = options.missions - len(missing_seeds(options, store))
    return (f"{kept} of {options.missions} missions are kept in {shown_path(store.folder)}; the same command goes on "
            "with the others")


def complain(options, store, failed):
    failed = sorted(failed, key=lambda result: result.first)
    seeds = ", ".join(span(result.first, result.count) for result in failed)
    return ToolError(f"failed twice: seeds {seeds}: {failed[0].failure}; {kept_line(options, store)}")


# ---- report --------------------------------------------------------------------------------------------------------

def again(options):
    """The command as a person types it."""
    return shlex.join(["make", "campaign", f"ROBOT={options.robot}", f"MISSIONS={options.missions}",
                       f"SEED={options.seed}", *(["CAMPAIGN=--faults"] if options.faults else [])])


def write_bench(options, data):
    figures = campaign_report.bench(data, again(options))
    if figures is None:
        raise ToolError(f"{options.bench}: no mission is done: no figures")
    write_whole(options.bench, json.dumps(figures, indent=1, ensure_ascii=False) + "\n")


def show(options, settings, store):
    kept = store.missions()
    missions = [kept[seed] for seed in range(options.seed, options.seed + options.missions)]
    data = campaign_report.report(settings, missions)
    written = [store.folder / "campaign.json"]
    write_whole(written[0], json.dumps(data, indent=1) + "\n")
    picture = campaign_report.picture(missions, data)
    if picture is not None:
        written.append(store.folder / "campaign.png")
        write_whole(written[-1], picture)
    if options.bench is not None:
        write_bench(options, data)
        written.append(options.bench)

    for table in campaign_report.tables(data["groups"]):
        print_aligned(table)
        print()
    print(f"wrote {', '.join(map(shown_path, written))}")


def main():
    options = arguments()
    robot = robot_json.robot_path(options.robot).resolve()
    job = job_of(options, robot)
    settings = settings_of(options, job)
    store = Store(options.output or default_folder(robot_json.build_directory(), robot))
    if options.fresh:
        store.forget()
    store.open(settings)

    missing = missing_seeds(options, store)
    try:
        failed = run_missing(options, job, store, missing) if missing else []
    except KeyboardInterrupt:
        print(f"{Path(sys.argv[0]).name}: interrupted; {kept_line(options, store)}", file=sys.stderr)
        return EXIT_INTERRUPTED
    except ToolError as error:
        raise ToolError(f"{error}; {kept_line(options, store)}") from None
    if failed:
        raise complain(options, store, failed)
    show(options, settings, store)
    return 0


if __name__ == "__main__":
    run(main)
