"""The results page is what its generator makes of the tables that ship, and the README has no findings of its own."""

import re

from tests.pages import ROOT
from verification.thesis import results
from verification.thesis.chapter4 import kept

TEXT = (ROOT / "docs" / "explain" / "results.md").read_text("utf-8")


def test_the_page_is_the_one_that_the_kept_tables_give():
    """Otherwise: python -m verification.thesis.results."""
    assert results.page() == TEXT


def test_its_numbers_come_from_the_tables(monkeypatch):
    """A changed table changes the page."""
    controls = kept.read("controls")
    monkeypatch.setattr(
        kept, "read", lambda name, read=kept.read: controls.assign(apical=0.5) if name == "controls" else read(name)
    )
    assert "50.0 %" not in TEXT
    assert results.page().count("50.0 %") == 3


def test_every_section_says_how_its_numbers_are_made():
    sections = re.split(r"^## ", TEXT, flags=re.MULTILINE)[1:]
    assert len(sections) == 8
    for section in sections:
        title, _, body = section.partition("\n")
        assert title.endswith("(kept)") or "`make report FULL=1`" in body or "`make bench`" in body, title
