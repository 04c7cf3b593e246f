"""Tables of runs: nothing is lost by an interruption, rows made by different code are not mixed."""

import os
from collections.abc import Callable
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from dincl.provenance import provenance
from dincl.study import Key, Row, Study, Table

RUNS = tuple({"method": name, "dt": dt} for name in ("b", "a") for dt in (0.1, 0.025, 0.05))


def made_by(**settings: str) -> dict[str, str]:
    """What the tables of these tests are made by."""
    return provenance(two_rows, **settings)


class Inline(Executor):
    """Makes each run where it is submitted, in order."""

    def submit(self, run: Callable[..., Any], /, *arguments: Any, **options: Any) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(run(*arguments, **options))
        except KeyboardInterrupt as interruption:
            future.set_exception(interruption)
        return future


def two_rows(key: Key) -> list[Row]:
    """A run with two rows, where the coarsest one failed."""
    failed = key["dt"] == 0.1
    return [
        dict(key) | {"t": t, "error": np.nan if failed else key["dt"] * t, "status": "FAILED" if failed else "SUCCESS"}
        for t in (2.0, 1.0)
    ]


def study(run: Callable[[Key], list[Row]] = two_rows, runs: tuple[Key, ...] = RUNS, **settings: str) -> Study:
    return Study("runs", "Runs", ("method", "dt"), runs, run, settings)


def test_rows_of_all_runs_sorted_by_key(tmp_path: Path) -> None:
    rows = study().complete(tmp_path, Inline())
    assert rows["method"].tolist() == ["a"] * 6 + ["b"] * 6
    assert rows["dt"].tolist() == [0.025, 0.025, 0.05, 0.05, 0.1, 0.1] * 2
    assert rows["t"].tolist() == [2.0, 1.0] * 6  # rows of a run stay as they were made
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "runs.csv"), rows, check_dtype=False)


def test_failed_runs_are_rows(tmp_path: Path) -> None:
    rows = study().complete(tmp_path, Inline())
    failed = rows[rows["status"] == "FAILED"]
    assert len(failed) == 4
    assert failed["error"].isna().all()
    assert rows["error"].notna().sum() == 8


@pytest.mark.parametrize("at", range(len(RUNS)))
def test_interrupted_study_ends_as_if_it_had_not_been(at: int, tmp_path: Path) -> None:
    whole = study().complete(tmp_path / "whole", Inline())

    def stops(key: Key) -> list[Row]:
        if key == RUNS[at]:
            raise KeyboardInterrupt
        return two_rows(key)

    with pytest.raises(KeyboardInterrupt):
        study(stops).complete(tmp_path / "broken", Inline())
    table = Table(tmp_path / "broken" / "runs.parquet", ("method", "dt"), made_by())
    kept = table.done()
    again: list[Key] = []

    def notes(key: Key) -> list[Row]:
        again.append(key)
        return two_rows(key)

    resumed = study(notes).complete(tmp_path / "broken", Inline())
    assert again == [key for key in RUNS if (key["method"], key["dt"]) not in kept]
    assert RUNS[at] in again
    pd.testing.assert_frame_equal(resumed, whole)


def test_finished_study_runs_nothing(tmp_path: Path) -> None:
    first = study().complete(tmp_path, Inline())

    def never(key: Key) -> list[Row]:
        raise AssertionError(key)

    pd.testing.assert_frame_equal(study(never).complete(tmp_path, Inline()), first)


def test_only_the_runs_asked_for_come_back(tmp_path: Path) -> None:
    study().complete(tmp_path, Inline())
    rows = study(runs=RUNS[:2]).complete(tmp_path, Inline())
    assert rows["dt"].tolist() == [0.025, 0.025, 0.1, 0.1]
    assert len(pd.read_parquet(tmp_path / "runs.parquet")) == 12


def test_write_that_breaks_off_leaves_the_old_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    table = Table(tmp_path / "runs.parquet", ("method", "dt"), made_by())
    table.append(two_rows(RUNS[0]))

    def breaks(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", breaks)
    with pytest.raises(OSError, match="disk full"):
        table.append(two_rows(RUNS[1]))
    assert table.done() == {("b", 0.1)}


def test_rows_of_other_making_are_refused(tmp_path: Path) -> None:
    Table(tmp_path / "runs.parquet", ("method", "dt"), made_by(code="1", other="2")).append(two_rows(RUNS[0]))
    other = Table(tmp_path / "runs.parquet", ("method", "dt"), made_by(code="9", other="2"))
    with pytest.raises(ValueError, match=r"runs\.parquet was made by other .*\(setting code: 1 -> 9\), "):
        other.append(two_rows(RUNS[1]))


def test_stale_table_is_set_aside_and_starts_anew(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study(runs=RUNS[:1]).complete(tmp_path, Inline())
    rows = study(runs=RUNS[1:3], code="2").complete(tmp_path, Inline())
    told = capsys.readouterr().out
    assert "starts anew" in told
    assert "setting code is new" in told
    assert rows["dt"].tolist() == [0.025, 0.025, 0.05, 0.05]
    assert pd.read_parquet(tmp_path / "superseded" / "runs.parquet")["dt"].tolist() == [0.1, 0.1]
