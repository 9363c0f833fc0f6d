"""Batches of a campaign on Dask: on threads of this machine, which wait for the programs, or on a scheduler's workers.

A batch that fails is tried once more.
"""
import contextlib
import importlib
import logging
import queue
import tempfile
import time
import zipfile
from dataclasses import dataclass
from pathlib import Path

import psutil
from distributed import Client, KilledWorker, LocalCluster

from tools.campaign import campaign_task
from tools.common import ROOT, ToolError

RETRIES = 1
CONNECT_LIMIT = 10.0     # s, for a scheduler to answer, and then for its first worker
WATCH_PERIOD = 2.0       # s, from one look at the workers to the next
WORKERLESS_LIMIT = 30.0  # s without a worker, after which the campaign ends


@dataclass(frozen=True)
class Job:
    """The same for all batches."""
    command: list
    fingerprints: dict    # of the files that it needs, by their paths
    mission_limit: float  # s


@dataclass(frozen=True)
class Result:
    """Of a batch: what the program printed, or else why it failed, in one line."""
    first: int
    count: int
    text: str | None
    failure: str | None


# ---- clusters ------------------------------------------------------------------------------------------------------

def end_programs(command):
    """Those that this process started by the command."""
    for child in psutil.Process().children():
        with contextlib.suppress(psutil.NoSuchProcess):
            if set(command) <= set(child.cmdline()):
                child.kill()


@contextlib.contextmanager
def local_client(job, threads):
    """Programs that still run are ended with it."""
    # Without an address for its status page Dask takes one that others may have.
    with LocalCluster(n_workers=1, threads_per_worker=threads, processes=False, dashboard_address="127.0.0.1:0",
                      memory_limit=None, silence_logs=logging.CRITICAL) as cluster, Client(cluster) as client:
        try:
            yield client
        finally:
            end_programs(job.command)


@contextlib.contextmanager
def remote_client(job, address):
    """Of a scheduler whose workers have the files."""
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=CONNECT_LIMIT)
    except (OSError, ValueError) as error:
        raise ToolError(f"--scheduler {address}: {one_line(error)}") from None
    with client:
        prepare_workers(client, address, job.fingerprints)
        yield client


def upload_task(client):
    """To the scheduler and its workers, as the part of the package that the task is; they may have an older one."""
    task = Path(campaign_task.__file__)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "joulepath_campaign.zip"
        with zipfile.ZipFile(path, "w") as archive:
            for part in (*(parent / "__init__.py" for parent in task.parents if ROOT in parent.parents), task):
                archive.write(part, part.relative_to(ROOT))
        client.upload_file(str(path))
    client.run(importlib.reload, campaign_task)


def prepare_workers(client, address, fingerprints):
    try:
        client.wait_for_workers(1, timeout=CONNECT_LIMIT)
    except TimeoutError:
        raise ToolError(f"--scheduler {address}: has no worker; start one there: dask worker {address}") from None
    upload_task(client)
    for worker, complaint in client.run(campaign_task.complaint_about_files, fingerprints).items():
        if complaint is not None:
            raise ToolError(f"worker {worker}: {complaint}; all need the same files at the same paths")


# ---- batches -------------------------------------------------------------------------------------------------------

def one_line(error):
    return " ".join(str(error).split()) or type(error).__name__


def failure_of(future):
    error = future.exception()
    return "the workers that ran it were lost" if isinstance(error, KilledWorker) else one_line(error)


def result_of(future, first, count):
    if future.status == "cancelled":
        raise ToolError("the connection to the scheduler was lost")
    if future.status == "finished":
        return Result(first, count, future.result(), None)
    return Result(first, count, None, failure_of(future))


def finished(client, futures):
    """The futures as they finish. While nothing does, watches that there are workers."""
    done = queue.SimpleQueue()
    for future in futures:
        future.add_done_callback(done.put)
    seen = time.monotonic()
    for _ in range(len(futures)):
        future = None
        while future is None:
            with contextlib.suppress(queue.Empty):
                future = done.get(timeout=WATCH_PERIOD)
            if future is not None or client.scheduler_info()["workers"]:
                seen = time.monotonic()
            elif time.monotonic() - seen > WORKERLESS_LIMIT:
                raise ToolError(f"no worker has been there for {WORKERLESS_LIMIT:g} s")
        yield future


def results(client, job, batches):
    """Results of batches, given by first seed and count, as they come. Whoever stops early cancels the rest."""
    futures = {client.submit(campaign_task.run_batch, job.command, job.fingerprints, first, count,
                             count * job.mission_limit, pure=False, retries=RETRIES): (first, count)
               for first, count in batches}
    try:
        for future in finished(client, list(futures)):
            yield result_of(future, *futures.pop(future))
    finally:
        client.cancel(list(futures))
