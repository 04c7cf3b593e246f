"""A study that is killed again and again ends with the tables of one that is not."""

import multiprocessing
import signal
import threading
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tissue
import tissue.study.outcomes
from dincl.errors import InvalidProblem
from dincl.files import PARTIAL
from tests.tissue.study.stand_in import outcomes, stored, study_file
from tissue.study.plan import load_study
from tissue.study.read import Results
from tissue.study.store import opened

tissue.preset("thesis")
# Processes that need not import anything again, nor read the preset: each is a copy of one that has.
PROCESSES = multiprocessing.get_context("forkserver")
PROCESSES.set_forkserver_preload(["tests.tissue.study.test_kill"])
KILLS = 14
LONGEST = 0.15  # seconds until a process is killed
EARLY = 4  # each fourth counted from its start, the others from the first piece they begin
REPLICATES = 21 * 128  # in two scenarios


def _run_until_killed(folder, seed, begun):
    """Compute two pieces of random length at most, then wait for the end."""
    draws, pieces = np.random.default_rng(seed), threading.Semaphore(2)

    def slow(*args):
        begun.set()
        pieces.acquire()
        threading.Event().wait(draws.uniform(0.0, LONGEST / 10))
        return outcomes(*args)

    tissue.study.outcomes.outcomes = slow
    tissue.run_study(Path(folder) / "small.toml", Path(folder) / "out")


@pytest.mark.slow
def test_killed_at_random_moments_and_resumed_the_tables_are_those_of_one_run(tmp_path, monkeypatch):
    study_file(tmp_path, REPLICATES)
    original = PROCESSES.Process(target=str)  # starts what the others are copies of
    original.start()
    original.join()
    done = []
    for kill, moment in enumerate(np.random.default_rng(20).uniform(0.0, LONGEST, KILLS)):
        begun = PROCESSES.Event()
        process = PROCESSES.Process(target=_run_until_killed, args=(str(tmp_path), kill, begun))
        process.start()
        assert kill % EARLY == 0 or begun.wait(60)  # on a slow machine, too, the others have something to lose
        process.join(moment)
        process.kill()
        process.join()
        assert process.exitcode == -signal.SIGKILL
        done.append(sum(name.startswith("parts") and PARTIAL not in name for name in stored(tmp_path / "out")))
    assert done == sorted(done)
    assert len(set(done)) > 3
    assert 0 < done[-1] < 42
    monkeypatch.setattr(tissue.study.outcomes, "outcomes", outcomes)
    told = []
    results = tissue.run_study(tmp_path / "small.toml", tmp_path / "out", watch=told.append)
    assert told[0] == 128 * done[-1]
    whole = tissue.run_study(tmp_path / "small.toml", tmp_path / "whole")
    assert stored(tmp_path / "out") == stored(tmp_path / "whole")
    for name in results.study.scenarios:
        pd.testing.assert_frame_equal(Results(tmp_path / "out").cells(name), whole.cells(name), check_exact=True)
        pd.testing.assert_frame_equal(Results(tmp_path / "out").runs(name), whole.runs(name), check_exact=True)
    assert sorted(path.suffix for path in (tmp_path / "out").iterdir() if path.is_file()) == [".json", ".lock", ".toml"]


def _hold(folder, held):
    """Keep the folder until killed."""
    with opened(load_study(Path(folder) / "small.toml"), Path(folder) / "out"):
        held.set()
        threading.Event().wait()


def test_a_second_process_is_refused_until_the_first_one_is_gone(tmp_path, monkeypatch):
    monkeypatch.setattr(tissue.study.outcomes, "outcomes", outcomes)
    study_file(tmp_path)
    held = PROCESSES.Event()
    first = PROCESSES.Process(target=_hold, args=(str(tmp_path), held), daemon=True)
    first.start()
    assert held.wait(60)
    with pytest.raises(InvalidProblem, match="out: another process works on it, and goes on undisturbed"):
        tissue.run_study(tmp_path / "small.toml", tmp_path / "out")
    first.kill()  # which cannot tidy up
    first.join()
    assert tissue.run_study(tmp_path / "small.toml", tmp_path / "out").complete
