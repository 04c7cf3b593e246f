"""Running a study: the same rows for any workers, order and interruption; nothing that was computed is lost."""

import threading
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor

import numpy as np
import pandas as pd
import pytest

import tissue
from dincl.errors import InvalidProblem
from dincl.study import StudyStopped
from dincl.study.execute import AHEAD
from tests.tissue.study.stand_in import outcomes, stored, study_file
from tissue.files.parameters import preset
from tissue.study.plan import load_study, run_seeds
from tissue.study.read import Results

HOME = "tissue.study.outcomes.outcomes"


class Shuffled(Executor):
    """Computes a piece only when no more are handed in, and then a random one."""

    def __init__(self, workers, pieces, seed):
        self._max_workers = workers
        self.left, self.stored, self.most = pieces, -1, 0
        self.waiting, self.order, self.draws = [], [], np.random.default_rng(seed)

    def submit(self, fn, /, *args):
        future = Future()
        self.waiting.append((len(self.order) + len(self.waiting), future, fn, args))
        self.left -= 1
        self.most = max(self.most, len(self.order) + len(self.waiting) - self.stored)
        while self.waiting and (self.left == 0 or len(self.waiting) == AHEAD * self._max_workers):
            self.finish()
        return future

    def finish(self):
        number, future, fn, args = self.waiting.pop(self.draws.integers(len(self.waiting)))
        self.order.append(number)
        future.set_result(fn(*args))

    def watch(self, _):
        """Count what is stored, but for the first call, which is before."""
        self.stored += 1


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(HOME, outcomes)
    study_file(".")


@pytest.fixture
def whole():
    """The tables of a run without interruption."""
    return stored(tissue.run_study("small.toml", "whole").folder)


@pytest.mark.parametrize("workers", [1, 2, 5])
def test_the_tables_are_the_same_for_any_number_of_workers(workers, whole):
    with ThreadPoolExecutor(workers) as executor:
        tissue.run_study("small.toml", "out", executor)
    assert stored("out") == whole


@pytest.mark.parametrize("seed", [0, 1])
def test_the_tables_are_the_same_for_any_order(seed, whole):
    executor = Shuffled(2, 6, seed)
    tissue.run_study("small.toml", "out", executor, executor.watch)
    assert stored("out") == whole
    assert executor.most == AHEAD * 2
    assert sorted(executor.order) == list(range(6)) != executor.order


def test_the_watch_is_told_what_is_stored():
    told = []
    with ThreadPoolExecutor(1) as executor:
        tissue.run_study("small.toml", "out", executor, told.append)
    assert told == [0, 128, 256, 300, 428, 556, 600]
    told.clear()
    tissue.run_study("small.toml", "out", watch=told.append)
    assert told == [600]


def failing(error, at):
    """Outcomes that raise an error for one piece."""

    def fails(parameters, replicates, *rest):
        if (parameters.emt.inm, replicates[0]) == at:
            raise error
        return outcomes(parameters, replicates, *rest)

    return fails


@pytest.mark.parametrize("error", [ZeroDivisionError("no"), KeyboardInterrupt(), BrokenExecutor("gone")])
@pytest.mark.parametrize("workers", [1, 3])
def test_an_error_leaves_what_was_computed_and_the_rest_comes_later(error, workers, whole, monkeypatch):
    monkeypatch.setattr(HOME, failing(error, (1, 256)))
    expected = StudyStopped if isinstance(error, BrokenExecutor) else type(error)
    with ThreadPoolExecutor(workers) as executor, pytest.raises(expected):
        tissue.run_study("small.toml", "out", executor)
    kept = stored("out")
    assert len([name for name in kept if name.startswith("parts")]) >= 2
    assert kept.items() < whole.items()
    results = Results("out")
    assert not results.complete
    assert results.runs("[A]")["replicate"].tolist() == list(range(256))
    monkeypatch.setattr(HOME, outcomes)
    tissue.run_study("small.toml", "out")
    assert stored("out") == whole


def test_pieces_under_way_are_stored_when_another_fails(monkeypatch):
    begun, failed = threading.Event(), threading.Event()

    def together(parameters, replicates, *rest):
        if replicates[0] == 0:
            begun.wait()
            failed.set()
            raise ZeroDivisionError
        begun.set()
        failed.wait()
        return outcomes(parameters, replicates, *rest)

    monkeypatch.setattr(HOME, together)
    with ThreadPoolExecutor(2) as executor, pytest.raises(ZeroDivisionError):
        tissue.run_study("small.toml", "out", executor)
    assert Results("out").runs("[A]")["replicate"].tolist()[:128] == list(range(128, 256))


def test_a_worker_with_other_code_is_refused(monkeypatch):
    here = threading.current_thread()
    monkeypatch.setattr("tissue.study.run.code", lambda: {"tissue": "ab"[threading.current_thread() is here]})
    with ThreadPoolExecutor(1) as executor, pytest.raises(StudyStopped, match="a worker has other code"):
        tissue.run_study("small.toml", "out", executor)


def test_results_are_the_tables_in_order():
    results = tissue.run_study("small.toml", "out")
    assert results.complete
    assert results.study == ("small", 300, 7, (2, 129), ("[A]", "[A] no INM"), None)
    study = load_study("small.toml")
    for name, parameters in study.scenarios.items():
        assert results.parameters(name) == parameters
        made = outcomes(parameters, list(range(300)), run_seeds(7, name, range(300)), [129])
        pd.testing.assert_frame_equal(results.cells(name), made.cells.to_pandas())
        pd.testing.assert_frame_equal(results.runs(name), made.runs.to_pandas())
        pd.testing.assert_frame_equal(results.trajectory(name, 129), made.tables[129])
    assert results.runs("[A]", ["seed"]).columns.tolist() == ["seed"]
    assert results.cells("[A]", ["ab_0h", "cell"]).columns.tolist() == ["ab_0h", "cell"]


def test_results_refuse_what_is_not_there():
    with pytest.raises(InvalidProblem, match="none: must be the folder of a study"):
        Results("none")
    results = tissue.run_study("small.toml", "out")
    with pytest.raises(InvalidProblem, match=r"scenario = 'A': must be one of '\[A\]', '\[A\] no INM'"):
        results.cells("A")
    with pytest.raises(InvalidProblem, match=r"columns = \['ab'\]: must be of replicate, cell, extruded, ab_0h"):
        results.cells("[A]", ["cell", "ab"])
    with pytest.raises(InvalidProblem, match=r"replicate = 3: must be stored, as may be \[2, 129\]"):
        results.trajectory("[A]", 3)
    next(results.folder.glob("cells/*5D/part-00001.parquet")).write_bytes(b"PAR1")
    with pytest.raises(
        InvalidProblem, match=r"(?s)out: files are damaged, .*tissue study FILE --out out, .*part-00001"
    ):
        results.cells("[A]")
    for path in (results.folder / "parts").rglob("*.json"):
        path.unlink()
    with pytest.raises(InvalidProblem, match="nothing of the scenario '\\[A\\]' is stored yet"):
        results.cells("[A]")


@pytest.mark.slow
def test_the_simulation_gives_the_same_rows_whatever_runs_beside_it(monkeypatch, tmp_path):
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    text = (
        study_file(".", replicates=136)
        .read_text("utf-8")
        .replace('a = "12 h"', 'a = "0.5 h"')
        .replace("[2, 129]", "[2]")
    )
    more = "[overrides.tissue]\ncells = 8\n[overrides.numerics]\nkeep = '0.5 h'\nt_end = '1 h'\n"
    (tmp_path / "small.toml").write_text(text + more, "utf-8")
    tissue.run_study("small.toml", "whole")
    with ThreadPoolExecutor(1) as executor:
        results = tissue.run_study("small.toml", "out", executor)
    assert stored("out") == stored("whole")
    assert len(stored("out")) == 14
    cells = results.cells("[A]")
    assert len(cells) == 272
    assert cells["ab_1h"].nunique() == 272
    assert (cells["t_a_h"] == 0.5).all()
    seeds = run_seeds(7, "[A]", range(136))
    assert results.runs("[A]")["seed"].tolist() == seeds
    run = tissue.simulate(results.parameters("[A]"), seeds[2])
    assert preset("thesis") != results.parameters("[A]")
    pd.testing.assert_frame_equal(results.trajectory("[A]", 2), run.table(), rtol=1e-6, check_exact=False)
