"""Tables of runs: nothing is lost by an interruption, rows of different settings are not mixed."""

import json
import os
from collections.abc import Callable
from concurrent.futures import Executor, Future
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import dincl
from dincl.errors import InvalidProblem
from dincl.study import Key, Row, Study, joined, read_sealed
from dincl.study.record import differences, record

RUNS = tuple({"method": name, "dt": dt} for name in ("b", "a") for dt in (0.1, 0.025, 0.05))


# What their rows depend on, whatever function makes them here.
OF = {"rows": "two"}


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


def never(key: Key) -> list[Row]:
    raise AssertionError(key)


def study(run: Callable[[Key], list[Row]] = two_rows, runs: tuple[Key, ...] = RUNS, **settings: str) -> Study:
    return Study("runs", "Runs", ("method", "dt"), runs, run, settings or (OF if hasattr(run, "__code__") else {}))


def done(folder: Path) -> set[tuple[str, float]]:
    """The runs that the table in a folder has."""
    path = folder / "runs.parquet"
    return set(read_sealed(path)[["method", "dt"]].itertuples(index=False, name=None)) if path.exists() else set()


def test_rows_of_all_runs_sorted_by_key(tmp_path: Path) -> None:
    rows = study().complete(tmp_path, Inline())
    assert rows["method"].tolist() == ["a"] * 6 + ["b"] * 6
    assert rows["dt"].tolist() == [0.025, 0.025, 0.05, 0.05, 0.1, 0.1] * 2
    assert rows["t"].tolist() == [2.0, 1.0] * 6  # rows of a run stay as they were made
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "runs.csv"), rows, check_dtype=False)
    failed = rows["status"] == "FAILED"
    assert (failed.sum(), rows["error"].isna().sum()) == (4, 4)
    some = study(never, RUNS[:2]).complete(tmp_path, Inline())
    assert some["dt"].tolist() == [0.025, 0.025, 0.1, 0.1]  # those asked for, and nothing is run
    assert len(pd.read_parquet(tmp_path / "runs.parquet")) == 12


@pytest.mark.parametrize("at", range(len(RUNS)))
def test_interrupted_study_ends_as_if_it_had_not_been(at: int, tmp_path: Path) -> None:
    whole = study().complete(tmp_path / "whole", Inline())

    def stops(key: Key) -> list[Row]:
        if key == RUNS[at]:
            raise KeyboardInterrupt
        return two_rows(key)

    with pytest.raises(KeyboardInterrupt):
        study(stops).complete(tmp_path / "broken", Inline())
    kept = done(tmp_path / "broken")
    again: list[Key] = []

    def notes(key: Key) -> list[Row]:
        again.append(key)
        return two_rows(key)

    resumed = study(notes).complete(tmp_path / "broken", Inline())
    assert again == [key for key in RUNS if (key["method"], key["dt"]) not in kept]
    assert RUNS[at] in again
    pd.testing.assert_frame_equal(resumed, whole)


def test_write_that_breaks_off_leaves_the_old_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study(runs=RUNS[:1]).complete(tmp_path)

    def breaks(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", breaks)
    with pytest.raises(OSError, match="disk full"):
        study(runs=RUNS[:2]).complete(tmp_path)
    assert done(tmp_path) == {("b", 0.1)}


@pytest.mark.parametrize(
    ("one", "two", "line"),
    [
        ({"x": 1}, {"x": 2}, "setting x: 1 -> 2"),
        ({}, {"x": 2}, "setting x is new"),
        ({"x": np.arange(2)}, {"x": [0, 1]}, None),
        ({"x": lambda t: t + 1}, {"x": lambda t: t + 1}, None),
        ({"x": lambda t: t + 1}, {"x": lambda t: t + 2}, "setting x: "),
        ({"x": partial(max, 1)}, {"x": partial(max, 2)}, "setting x: "),
    ],
)
def test_every_difference_of_settings_is_named(one: dict[str, Any], two: dict[str, Any], line: str | None) -> None:
    found = differences(record(one), record(two))
    assert found == [] if line is None else [text.startswith(line) for text in found] == [True]


@pytest.mark.parametrize(
    ("setting", "written"),
    [
        ((None, True, 2, 0.5, "a"), [None, True, 2, 0.5, "a"]),
        ((Path("a/b"), 1j, b"a", np), ["a/b", "1j", "b'a'", "numpy"]),
        ({2: range(2), "a": np.float32(0.5)}, {"2": [0, 1], "a": 0.5}),
        ({"b", "a"}, ["a", "b"]),
        (dincl.Status.SUCCESS, "Status.SUCCESS"),
        (dincl.CatchUp(1, dincl.ActiveSet(0.1)), {"CatchUp": {"dt": 1, "projection": {"ActiveSet": {"tol": 0.1}}}}),
        (max, "builtins.max"),
    ],
)
def test_a_setting_is_written_as_what_it_holds(setting: Any, written: Any) -> None:
    assert json.loads(record({"x": setting})["settings"])["x"] == written


def test_a_setting_that_holds_itself_or_is_long_is_written_all_the_same() -> None:
    ring: list[Any] = [1]
    ring.append(ring)
    assert json.loads(record({"x": ring})["settings"])["x"] == [1, "itself"]
    one, other = (record({"x": [0] * 1000 + [last]}) for last in (1, 2))
    assert len(one["settings"]) < 60
    assert [text.startswith("setting x: [0, 0") for text in differences(one, other)] == [True]
    exact = "a" * 998
    assert json.loads(record({"x": exact})["settings"])["x"] == exact
    (line,) = differences(record({"x": exact}), record({"x": exact[:500] + "b" + exact[501:]}))
    assert line == f"setting x: ...{'a' * 80}... -> ...{'a' * 40}b{'a' * 39}..."


def test_what_a_run_binds_is_a_setting_and_tables_of_others_are_set_aside(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for factor in (1, 2, 1):
        rows = study(partial(scaled, factor)).complete(tmp_path)
    told = capsys.readouterr().out
    assert "starts anew" in told
    assert "setting argument 0: 1 -> 2" in told
    assert rows["error"].max() == 2.0 * 0.05
    kept = [pd.read_parquet(path)["error"].max() for path in sorted((tmp_path / "superseded").glob("*.parquet"))]
    assert kept == [2.0 * 0.05, 2.0 * 0.05 * 2]


def scaled(factor: float, key: Key) -> list[Row]:
    """A run that binds a factor."""
    return [dict(row) | {"error": factor * row["error"]} for row in two_rows(key)]


def test_rows_of_another_version_are_not_mixed() -> None:
    now = record({})
    assert differences(now | {"package": "0.1"}, now) == [f"dincl-testbed: 0.1 -> {now['package']}"]
    assert differences({"code": "1"}, now) == ["the file does not record what it was made by"]


def test_joined_studies_are_one_table_with_the_name_of_the_study(tmp_path: Path) -> None:
    several = {"first": study(runs=RUNS[:2], a="1"), "second": study(runs=RUNS[1:], a="2")}
    both = joined("both", "Both", several)
    rows = both.complete(tmp_path, Inline())
    assert both.key == ("problem", "method", "dt")
    assert rows["problem"].value_counts().to_dict() == {"first": 4, "second": 10}
    for name, one in several.items():
        mine = rows[rows["problem"] == name].drop(columns="problem").reset_index(drop=True)
        pd.testing.assert_frame_equal(mine, one.complete(tmp_path / name, Inline()))
    assert both.made()["settings"] != joined("both", "Both", several | {"first": several["second"]}).made()["settings"]


def of(*keys: Key, run: Callable[[Key], list[Row]] = lambda key: [dict(key)], key: tuple[str, ...] = ("n",)) -> Study:
    return Study("s", "S", key, keys, run, {"of": "these"})


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: of({"n": 1}, {"n": 1}), "two runs are"),
        (lambda: of({"n": 0.1}, {"n": 0.1 + 1e-15}), "two runs are"),
        (lambda: of({"m": 1}), "has no 'n'"),
        (lambda: joined("j", "J", {}), "none: must be one or more"),
        (lambda: joined("j", "J", {"a": of({"n": 1}), "b": of({"n": 1, "k": 1}, key=("n", "k"))}), "of the same key"),
        (lambda: joined("j", "J", {"a": of({"n": 1})}, column="n"), "without 'n'"),
    ],
)
def test_runs_that_cannot_be_told_apart_are_refused(make: Callable[[], Study], message: str) -> None:
    with pytest.raises(InvalidProblem, match=message):
        make()


@pytest.mark.parametrize(
    ("second", "message"),
    [
        ({"v": np.ones(2)}, "v = .*: must be a number, flag, text or None"),
        ({"v": "text"}, "v = 'text': must be a number, as before"),
        ({"n": 7}, "must carry its key"),
    ],
)
def test_a_row_that_no_table_holds_is_refused_and_rows_before_it_stay(
    second: Row, message: str, tmp_path: Path
) -> None:
    def run(key: Key) -> list[Row]:
        return [dict(key) | {"v": 1.0} | (second if key["n"] == 2 else {})]

    with pytest.raises(InvalidProblem, match=message):
        of({"n": 1}, {"n": 2}, run=run).complete(tmp_path)
    assert pd.read_parquet(tmp_path / "s.parquet")["n"].tolist() == [1]
