"""A study on a Dask cluster: a scheduler and two workers on loopback, one of which dies; a scheduler that goes away."""

import json
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import tissue
import tissue.study.outcomes
from dincl.errors import InvalidProblem
from dincl.study import StudyStopped
from tests.executors import Here
from tests.tissue.study.stand_in import outcomes, stored, study_file, use_stand_in
from tissue.study import identity
from tissue.study.read import Results
from tissue.study.run import Absence, cluster, watched

ROOT = Path(__file__).parents[3]
REPLICATES = 8 * 128  # in two scenarios
SCHEDULER = ["scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
WORKER = ["worker", "--host", "127.0.0.1", "--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "30"]


class Dask:
    """The processes of a cluster."""

    def __init__(self, file):
        self.file, self.scheduler, self.workers = file, self.start(SCHEDULER, file), []
        while not (file.exists() and file.stat().st_size):
            assert self.scheduler.poll() is None
            time.sleep(0.01)

    def start(self, what, file):
        program, *options = what
        command = [sys.executable, "-m", f"distributed.cli.dask_{program}", *options, "--scheduler-file", str(file)]
        return subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def add(self, workers):
        self.workers += [self.start(WORKER, self.file) for _ in range(workers)]

    @property
    def address(self):
        return json.loads(self.file.read_text("utf-8"))["address"]


@pytest.fixture
def dask(tmp_path):
    started = Dask(tmp_path / "scheduler.json")
    yield started
    for process in [*started.workers, started.scheduler]:
        process.kill()
        process.wait()


@pytest.fixture
def whole(tmp_path, monkeypatch):
    """The tables of the study, made on this machine."""
    monkeypatch.setattr(tissue.study.outcomes, "outcomes", outcomes)
    return stored(tissue.run_study(study_file(tmp_path, REPLICATES), tmp_path / "whole").folder)


def prepare(dask, count):
    """Wait for the workers, and have them use the stand-in."""
    from distributed import Client

    with Client(dask.address, set_as_default=False) as client:
        client.wait_for_workers(count, timeout=60)
        client.run(use_stand_in)


@pytest.mark.slow
def test_a_cluster_without_workers_is_refused_and_a_worker_that_dies_loses_nothing(dask, tmp_path, whole, monkeypatch):
    # In a process of its own: what is left of the client that found nobody may hold up the next one for long.
    code = f"from tissue.study.run import cluster\nwith cluster({dask.address!r}): pass"
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert f"InvalidProblem: scheduler {dask.address}: has no workers" in run.stderr
    dask.add(2)
    prepare(dask, 2)
    with monkeypatch.context() as patch:
        patch.setitem(identity.house_code(), "tissue", "other")
        with pytest.raises(
            InvalidProblem,
            match=r"worker tcp://.*: must have the code of this machine, but has other: tissue: other -> \w+$",
        ):
            cluster(dask.address).__enter__()
    told = []

    def watch(runs):
        told.append(runs)
        if len(told) == 5:
            dask.workers[0].send_signal(signal.SIGKILL)

    with cluster(dask.address) as executor:
        assert executor._max_workers == 2
        results = tissue.run_study(tmp_path / "small.toml", tmp_path / "out", executor, watch)
    assert dask.workers[0].wait() == -signal.SIGKILL
    assert told[-1] == 2 * REPLICATES
    assert results.complete
    assert stored(tmp_path / "out") == whole


@pytest.mark.slow
def test_without_workers_it_says_that_it_waits(dask, monkeypatch):
    from distributed import Client

    monkeypatch.setattr("tissue.study.run.FIRST", 0.2)
    monkeypatch.setattr("tissue.study.run.LOOK", 0.05)
    said = threading.Event()
    monkeypatch.setattr("tissue.study.run.log.warning", lambda _: said.set())
    with Client(dask.address, set_as_default=False) as client, watched(client.get_executor()):
        assert said.wait(60)


def test_executors_that_users_bring_are_watched(tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(tissue.study.outcomes, "outcomes", outcomes)
    monkeypatch.setattr("tissue.study.run.watched", lambda executor: seen.append(executor) or watched(executor))
    executor = Here()
    assert tissue.run_study(study_file(tmp_path), tmp_path / "out", executor).complete
    assert seen == [executor]


def test_the_absence_of_workers_is_said_after_10_s_and_every_minute():
    absence = Absence("tcp://here:1")
    said = {now: text for now in range(200) if (text := absence.look(0, 1000.0 + now))}
    assert list(said) == [10, 70, 130, 190]
    assert said[70] == (
        "scheduler tcp://here:1: has had no workers for 70 s, and nothing is computed; "
        "start some: dask worker tcp://here:1"
    )
    assert absence.look(1, 1200.0) == ""
    assert [now for now in range(1201, 1280) if absence.look(0, now)] == [1211, 1271]


def test_of_other_executors_nothing_is_watched():
    with Here() as executor, watched(executor):
        assert "watches the workers" not in [thread.name for thread in threading.enumerate()]


@pytest.mark.slow
def test_a_scheduler_that_goes_away_stops_the_study_which_goes_on_here(dask, tmp_path, whole):
    dask.add(1)
    prepare(dask, 1)
    told = []

    def watch(runs):
        told.append(runs)
        if len(told) == 4:
            dask.scheduler.kill()

    lost = f"the connection to the scheduler {dask.address} is lost"
    with pytest.raises(StudyStopped, match=lost), cluster(dask.address) as executor:
        tissue.run_study(tmp_path / "small.toml", tmp_path / "out", executor, watch)
    assert not Results(tmp_path / "out").complete
    assert 3 * 128 <= told[-1] < 2 * REPLICATES
    again = []
    tissue.run_study(tmp_path / "small.toml", tmp_path / "out", watch=again.append)
    assert again[0] == told[-1]
    assert stored(tmp_path / "out") == whole


def test_what_is_no_address_is_refused():
    with pytest.raises(InvalidProblem, match="must be the address of a Dask scheduler"), cluster("nowhere"):
        pass
