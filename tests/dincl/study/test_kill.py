"""A table that is killed again and again ends as the one of a run that is not; one process at a time makes it."""

import multiprocessing
import signal
import time
from collections.abc import Callable
from multiprocessing.synchronize import Event
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from dincl.errors import InvalidProblem
from dincl.study import Key, Row, Study
from tests.dincl.study.test_table import Inline

# Processes that need not import anything again: each is a copy of one that has.
PROCESSES = multiprocessing.get_context("forkserver")
PROCESSES.set_forkserver_preload(["tests.dincl.study.test_kill"])
KILLS = 20
LONGEST = 0.15  # seconds until a process is killed
EARLY = 4  # each fourth counted from its start, the others from the first run they begin
RUNS = tuple({"method": f"method {m}", "dt": 0.5**k} for m in range(20) for k in range(20))


class OneByOne(Inline):
    """Makes two runs, and stores them, before it makes others."""

    _max_workers = 1


def two_rows(key: Key) -> list[Row]:
    """A run with two rows."""
    return [dict(key) | {"t": t, "error": key["dt"] * t, "steps": int(1 / key["dt"])} for t in (1.0, 2.0)]


def _study(run: Callable[[Key], list[Row]] = two_rows) -> Study:
    return Study("runs", "Runs", ("method", "dt"), RUNS, run, {"form": "kills"})


def _complete(folder: str, begun: Event) -> None:
    """Make the runs slowly, until killed."""

    def slow(key: Key) -> list[Row]:
        begun.set()
        time.sleep(0.002)
        return two_rows(key)

    _study(slow).complete(Path(folder), OneByOne())


@pytest.mark.slow
def test_killed_at_random_moments_and_resumed_the_bytes_are_those_of_one_run(tmp_path: Path) -> None:
    killed, whole, done = tmp_path / "killed", tmp_path / "whole", []
    for kill, moment in enumerate(np.random.default_rng(21).uniform(0.0, LONGEST, KILLS)):
        begun = PROCESSES.Event()
        process = PROCESSES.Process(target=_complete, args=(str(killed), begun))
        process.start()
        assert kill % EARLY == 0 or begun.wait(60)
        process.join(moment)
        process.kill()
        process.join()
        assert process.exitcode == -signal.SIGKILL
        table = killed / "runs.parquet"
        done.append(len(pd.read_parquet(table)) if table.exists() else 0)
    assert done == sorted(done)
    assert len(set(done)) > 3
    assert 0 < done[-1] < 2 * len(RUNS)
    assert all(rows % 2 == 0 for rows in done)  # both rows of a run, or none
    for folder in (killed, whole):
        _study().complete(folder, OneByOne())
    for name in ("runs.parquet", "runs.csv"):
        assert (killed / name).read_bytes() == (whole / name).read_bytes()


def _hold(folder: str, held: Event) -> None:
    """Hold the table until killed."""

    def stays(key: Key) -> list[Row]:
        held.set()
        time.sleep(600)
        return two_rows(key)

    _study(stays).complete(Path(folder), OneByOne())


def test_a_second_process_is_refused_until_the_first_one_is_gone(tmp_path: Path) -> None:
    held = PROCESSES.Event()
    first = PROCESSES.Process(target=_hold, args=(str(tmp_path), held), daemon=True)
    first.start()
    assert held.wait(60)
    with pytest.raises(InvalidProblem, match="another process works on it, and goes on undisturbed"):
        _study().complete(tmp_path, OneByOne())
    first.kill()
    first.join()
    assert len(_study().complete(tmp_path, OneByOne())) == 2 * len(RUNS)
