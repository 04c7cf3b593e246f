"""The pages of the tissue, in the plane and in space: what they show, and that their studies give what ships."""

import re

import pytest

from tests.executors import Here
from tests.verification.undrawn import draw_nothing
from verification.site.agreement import compare_studies
from verification.site.context import Context
from verification.site.parts import Grid, Picture
from verification.site.report import write_report
from verification.site.store import DATA, shipped
from verification.thesis.chapter3 import page as tissue
from verification.thesis.shipped_studies import STUDIES
from verification.tissues.space import page as space

# The amplitude of a tissue at rest far from its limit is as small as the last digits.
LAST_DIGITS = ("tissue_map_bending", "tissue_map_springs")
NAMES = [name for name in STUDIES if name.startswith(("tissue_", "space_")) and STUDIES[name](smallest=True).runs]


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_smallest_form_gives_the_rows_that_ship(name):
    study, complete = STUDIES[name](smallest=True), shipped(name)
    rows = study.rows()
    assert set(rows) == set(complete)
    found = compare_studies(rows, complete, STUDIES[name](), study.by)
    assert found.rows == len(rows)
    assert found.apart == 0 or (name in LAST_DIGITS and found.worst.startswith("amplitude"))


@pytest.mark.slow
@pytest.mark.parametrize("page", [tissue, space])
def test_a_page_is_written_from_what_ships(page, tmp_path, monkeypatch):
    draw_nothing(monkeypatch)
    monkeypatch.setattr(Context, "_repeat", lambda *_: None)
    context = Context(tmp_path, False, Here(), STUDIES, complete=DATA)
    write_report([page.CHAPTER], context)
    assert not re.search(r"\bnan\b", (tmp_path / page.CHAPTER.file).read_text("utf-8"))
    parts = [part for section in page.CHAPTER.sections(context) for part in section.parts]
    for part in parts:
        if isinstance(part, Picture):
            assert part.path.exists()
        if isinstance(part, Grid):
            assert part.file in context.tables
            assert len(part.rows.columns) == len(set(part.rows.columns)) > 1
            assert len(part.rows)
