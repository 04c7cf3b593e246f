"""What is made again, and how tables before and after are compared."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from verification.page.kept import changes, files
from verification.thesis import remake, studies

BEFORE = pd.DataFrame({"method": ["PBD", "PBD", "XPBD"], "error": [1.0, 2.0, np.nan], "seconds": [1.0, 1.0, 1.0]})


def test_equal_tables_differ_in_nothing() -> None:
    slower = BEFORE.assign(seconds=9.0, error=BEFORE["error"] * (1 + 1e-5))
    assert remake.differing(BEFORE, slower, "some") == []


def test_numbers_and_words_that_differ_are_named() -> None:
    changed = BEFORE.assign(error=[1.0, 2.2, np.nan], method=["PBD", "PBD", "Penalty"])
    words, numbers = remake.differing(BEFORE, changed, "some")
    assert (words["column"], words["differ"], words["largest"]) == ("method", 1, np.inf)
    assert (numbers["column"], numbers["differ"], numbers["example"]) == ("error", 1, "2.0 before, 2.2 now")
    assert abs(numbers["largest"] - 0.2 / 2.2) < 1e-12


def test_rows_that_came_or_went_are_counted_and_the_others_paired() -> None:
    rows, numbers = remake.differing(BEFORE, BEFORE.iloc[1:].assign(error=[1.0, 5.0]), "some")
    assert rows["example"] == "3 rows before, 2 now"
    assert (numbers["column"], numbers["rows"], numbers["differ"]) == ("error", 2, 1)


@pytest.mark.slow
def test_what_the_present_code_made_is_left() -> None:
    stale = {file.stem for file in files() if changes(file)}
    named = {name for names, _ in remake.commands(Path("folder")) for name in names.split(", ")}
    assert named == stale | {f"studies of {name}" for name in studies.NAMES}
    assert stale <= {file.stem for file in files()}


def test_a_table_of_other_code_is_made_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remake, "changes", lambda file: ["a module"] if file.stem == "emt_ratios" else [])
    made = dict(remake.commands(Path("folder")))
    module = "verification.thesis.chapter4.kept"
    assert made.pop("emt_ratios") == [module, f"folder/{module}"]
    assert set(made) == {f"studies of {name}" for name in studies.NAMES}
