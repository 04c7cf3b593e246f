"""The complete studies that ship: which they are, that they are whole, and that they come out again."""

from pathlib import Path

import pandas as pd
import pytest

from dincl.study import workers
from tests.executors import Here, Nowhere
from tests.verification.thesis.shortened import FORMS
from tests.verification.thesis.shortened_space import shorten_space
from verification.page.chapters import CHAPTERS
from verification.page.context import Context
from verification.page.kept import STUDIES
from verification.thesis import studies

SHIPPED = sorted(STUDIES.glob("*.parquet"))
# Tissues are chaotic: on another kind of processor rounding ends in other places of nuclei.
REPEATABLE = ("experiments", "failures", "geometry", "meanfield")


def test_all_of_them_take_less_room_than_a_photograph() -> None:
    assert sum(file.stat().st_size for file in SHIPPED) < 8e6
    assert len(SHIPPED) > 40


@pytest.mark.parametrize("file", SHIPPED, ids=lambda file: file.stem)
def test_each_knows_what_it_was_made_by(file: Path) -> None:
    table = pd.read_parquet(file)
    assert len(table)
    assert {"code", "data", "libraries"} <= table.attrs["provenance"].keys()


def test_an_unknown_chapter_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="chapter 'emt': must be one of experiments, moving, speed, iterations"):
        studies.main(tmp_path, ["emt"])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["experiments", "geometry", "meanfield", "space"])
def test_a_chapter_makes_its_studies_once(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With few, coarse steps; the other chapters have files of their own for it."""
    shorten_space(monkeypatch)
    (chapter,) = (chapter for chapter in CHAPTERS if chapter.name == name)
    first, again = Context(tmp_path, False, Here(), FORMS), Context(tmp_path, False, Nowhere(), FORMS)
    chapter.run(first)
    chapter.run(again)
    assert first.tables.keys() == again.tables.keys() != set()
    for table, rows in first.tables.items():
        pd.testing.assert_frame_equal(rows, again.tables[table])


@pytest.mark.xslow
@pytest.mark.parametrize("name", REPEATABLE)
def test_parts_come_out_again(name: str, tmp_path: Path) -> None:
    (chapter,) = (chapter for chapter in CHAPTERS if chapter.name == name)
    with workers() as executor:
        context = Context(tmp_path, False, executor, complete=STUDIES)
        chapter.run(context)
        for repeat in context.waiting:
            repeat()
    assert context.agreements
    assert {one.title: one.worst for one in context.agreements.values() if one.apart} == {}
