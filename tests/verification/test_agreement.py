"""What ships is shown; parts of it are made again, laid over it, and what differs is said."""

import datetime
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from dincl.study import Key, Row, Study, write
from tests.executors import Here, Nowhere
from verification.site.agreement import Agreement, compare_studies
from verification.site.context import Context


def rows_of(key: Key) -> list[Row]:
    """Two rows."""
    return [dict(key) | {"t": t, "error": key["n"] * t, "seconds": 0.5, "status": "SUCCESS"} for t in (1.0, 2.0)]


STUDY = Study("few", "Few", ("n",), tuple({"n": n} for n in (3, 2, 1)), rows_of)


def known(part: Study = STUDY) -> dict[str, Callable[..., Study]]:
    """The study, and its smallest form, by its name."""
    return {"few": lambda smallest: part if smallest else STUDY}


def shipped(folder: Path) -> pd.DataFrame:
    """The complete study as it ships."""
    table = STUDY.complete(folder, Here())
    (folder / "few.csv").unlink()
    return table


def compared(change: dict[str, object], by: tuple[str, ...] = ()) -> Agreement:
    """The complete rows beside those of n = 2 with one value changed."""
    complete = pd.DataFrame([row for key in STUDY.runs for row in rows_of(key)])
    here = complete[complete["n"] == 2].reset_index(drop=True)
    for name, value in change.items():
        here.loc[1, name] = value
    return compare_studies(here, complete, replace(STUDY, by=by))


def test_what_ships_is_shown_and_nothing_is_run(tmp_path: Path) -> None:
    table = shipped(tmp_path / "ships")
    context = Context(tmp_path / "report", False, Nowhere(), known(), tmp_path / "ships")
    pd.testing.assert_frame_equal(context.rows("few"), table)
    assert (tmp_path / "report" / "tables" / "few.csv").exists()
    assert len(context.waiting) == 1


def test_a_part_is_made_again_once_and_laid_over_it(tmp_path: Path) -> None:
    table = shipped(tmp_path / "ships").assign(seconds=0.25)
    write(table, tmp_path / "ships" / "few.parquet")
    context = Context(tmp_path / "report", False, Here(), known(replace(STUDY, runs=({"n": 2},))), tmp_path / "ships")
    context.rows("few")
    for repeat in context.waiting:
        repeat()
    said = f"{version('dincl-testbed')}, {datetime.datetime.now(datetime.UTC).date()}"
    assert context.agreements["few"] == Agreement("Few", 1, 3, 2, 0, "", 2.0, made=said)
    context.waiting.clear()
    context.rows("few")
    assert context.waiting == []


def test_anew_the_complete_study_is_made_and_what_ships_is_laid_beside_it(tmp_path: Path) -> None:
    old = shipped(tmp_path / "ships").assign(error=7.0)
    write(old, tmp_path / "ships" / "few.parquet")
    context = Context(tmp_path / "report", True, Here(), known(replace(STUDY, runs=STUDY.runs[:1])), tmp_path / "ships")
    assert context.rows("few")["error"].tolist() == [1.0, 2.0, 2.0, 4.0, 3.0, 6.0]
    context.waiting[0]()
    found = context.agreements["few"]
    assert (found.runs, found.of, found.rows, found.apart) == (3, 3, 6, 6)


@pytest.mark.parametrize(
    ("change", "apart"),
    [
        ({}, 0),
        ({"seconds": 9.0}, 0),  # of the machine
        ({"error": 4.003}, 0),
        ({"error": 4.005}, 1),
        ({"error": np.nan}, 1),
        ({"error": np.inf}, 1),
        ({"status": "FAR"}, 1),
        ({"status": "OUT_OF_BUDGET", "error": 9.0}, 0),  # a smaller budget says nothing
    ],
)
def test_numbers_agree_to_three_digits_and_words_to_the_letter(change: dict[str, object], apart: int) -> None:
    found = compared(change)
    assert found.apart == apart
    assert bool(found.worst) == bool(apart)


def test_the_farthest_number_is_named_with_its_place() -> None:
    assert compared({"error": 5.0}, ("t",)).worst == "error (5 here, 4 there) at n = 2, t = 2"


def test_what_both_lack_or_is_below_all_tolerances_agrees() -> None:
    table = pd.DataFrame({"n": [1, 1], "error": [np.nan, 1e-12]})
    assert compare_studies(table, table.assign(error=[np.nan, 3e-12]), STUDY).apart == 0
    assert compare_studies(table, table.assign(error=[0.0, 1e-12]), STUDY).apart == 1
    words = table.assign(status=[np.nan, "SUCCESS"])
    assert compare_studies(words, words, STUDY).apart == 0
    assert compare_studies(words, words.assign(status="SUCCESS"), STUDY).apart == 1


def test_rows_that_the_complete_study_lacks_are_not_counted(tmp_path: Path) -> None:
    table = pd.DataFrame({"n": [1, 8], "error": [1.0, 1.0]})
    assert compare_studies(table, table.iloc[:1], STUDY).rows == 1
    nothing = replace(STUDY, runs=()).complete(tmp_path, Here())
    found = compare_studies(nothing, pd.DataFrame(rows_of(STUDY.runs[0])), STUDY)
    assert (found.runs, found.rows, found.apart) == (0, 0, 0)
