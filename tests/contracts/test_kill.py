"""Contract of resumable tables: killed again and again they end with the bytes of one run; one process at a time.

Tables of runs are one file (``dincl.study.Study``) or a folder of parts (studies of tissues).
"""

import multiprocessing
import signal
import threading
from collections.abc import Callable
from functools import partial
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
import pytest

import tissue
import tissue.study.outcomes
from dincl.errors import InvalidProblem
from dincl.files import PARTIAL
from dincl.study import Key, Row, Study
from tests.dincl.study.test_table import Inline
from tests.tissue.study.stand_in import outcomes, stored, study_file

tissue.preset("thesis")
# Processes that need not import anything again, nor read the preset: each is a copy of one that has.
PROCESSES = multiprocessing.get_context("forkserver")
PROCESSES.set_forkserver_preload(["tests.contracts.test_kill"])
KILLS = 20
LONGEST = 0.5  # seconds until a process is killed
PAUSE = 0.015  # seconds before a piece of work, at most
EARLY = 4  # each fourth counted from its start, the others from the first piece of work they begin
RUNS = tuple({"method": f"method {m}", "dt": 0.5**k} for m in range(20) for k in range(20))
REPLICATES = 21 * 32  # in two scenarios: 42 parts


class OneByOne(Inline):
    """Makes two runs, and stores them, before it makes others."""

    _max_workers = 1


def two_rows(key: Key) -> list[Row]:
    """A run with two rows."""
    return [dict(key) | {"t": t, "error": key["dt"] * t, "steps": int(1 / key["dt"])} for t in (1.0, 2.0)]


def one_file(folder: Path, pause: Callable[[], object]) -> None:
    """Complete a table in one file; ``pause`` is called before each run."""

    def run(key: Key) -> list[Row]:
        pause()
        return two_rows(key)

    Study("runs", "Runs", ("method", "dt"), RUNS, run, {"form": "kills"}).complete(folder, OneByOne())


def parts(folder: Path, pause: Callable[[], object]) -> None:
    """Complete a study of tissues; ``pause`` is called before each part."""
    real = tissue.study.outcomes.outcomes
    tissue.study.outcomes.outcomes = lambda *args: (pause(), outcomes(*args))[1]
    folder.mkdir(exist_ok=True)
    study_file(folder, REPLICATES)
    try:
        tissue.run_study(folder / "small.toml", folder / "out")
    finally:
        tissue.study.outcomes.outcomes = real


class Store(NamedTuple):
    """A kind of resumable table: what completes it, how far it is, and its bytes by file.

    ``most``: pieces of work that a process makes before it waits to be killed, so that the last one finds work, too.
    """

    complete: Callable[[Path, Callable[[], object]], None]
    done: Callable[[Path], int]
    whole: int  # what ``done`` returns of a complete one
    contents: Callable[[Path], dict[str, bytes]]
    most: int


def _rows(folder: Path) -> int:
    file = folder / "runs.parquet"
    return len(pd.read_parquet(file)) if file.exists() else 0


def _parts(folder: Path) -> int:
    return sum(name.startswith("runs") and PARTIAL not in name for name in stored(folder / "out"))


STORES = {
    "one file": Store(
        one_file,
        _rows,
        2 * len(RUNS),
        lambda folder: {name: (folder / name).read_bytes() for name in ("runs.parquet", "runs.csv")},
        len(RUNS) // KILLS - 1,
    ),
    "folder of parts": Store(parts, _parts, 42, lambda folder: stored(folder / "out"), 2),
}


def _until_killed(kind: str, folder: str, seed: int, begun: Event) -> None:
    """Make some runs, with pauses of random length, then wait for the end."""
    draws, left = np.random.default_rng(seed), threading.Semaphore(STORES[kind].most)

    def pause() -> None:
        begun.set()
        left.acquire()
        threading.Event().wait(draws.uniform(0.0, PAUSE))

    STORES[kind].complete(Path(folder), pause)


@pytest.mark.slow
@pytest.mark.parametrize("kind", STORES)
def test_killed_at_random_moments_and_resumed_the_bytes_are_those_of_one_run(kind: str, tmp_path: Path) -> None:
    store, killed, done = STORES[kind], tmp_path / "killed", []
    original = PROCESSES.Process(target=str)  # starts what the others are copies of
    original.start()
    original.join()
    for kill, moment in enumerate(np.random.default_rng(20).uniform(0.0, LONGEST, KILLS)):
        begun = PROCESSES.Event()
        process = PROCESSES.Process(target=_until_killed, args=(kind, str(killed), kill, begun))
        process.start()
        assert kill % EARLY == 0 or begun.wait(60)  # on a slow machine, too, the others have something to lose
        process.join(moment)
        process.kill()
        process.join()
        assert process.exitcode == -signal.SIGKILL
        done.append(store.done(killed))
    assert done == sorted(done)
    assert len(set(done)) > 3
    assert 0 < done[-1] < store.whole
    for folder in (killed, tmp_path / "whole"):
        store.complete(folder, partial(int))
        assert store.done(folder) == store.whole
    assert store.contents(killed) == store.contents(tmp_path / "whole")


def _hold(kind: str, folder: str, held: Event) -> None:
    """Hold a table until killed."""

    def pause() -> None:
        held.set()
        threading.Event().wait()

    STORES[kind].complete(Path(folder), pause)


@pytest.mark.slow
@pytest.mark.parametrize("kind", STORES)
def test_a_second_process_is_refused_until_the_first_one_is_gone(kind: str, tmp_path: Path) -> None:
    held = PROCESSES.Event()
    first = PROCESSES.Process(target=_hold, args=(kind, str(tmp_path / "out"), held), daemon=True)
    first.start()
    assert held.wait(60)
    with pytest.raises(InvalidProblem, match="another process works on it, and goes on undisturbed"):
        STORES[kind].complete(tmp_path / "out", partial(int))
    first.kill()
    first.join()
    STORES[kind].complete(tmp_path / "out", partial(int))
    assert STORES[kind].done(tmp_path / "out") == STORES[kind].whole
