"""The results page is what its generator makes of the tables that ship, and the README has no findings of its own."""

import pytest

from tests.pages import ROOT
from verification.thesis import results
from verification.thesis.chapter4 import kept

TEXT = (ROOT / "docs" / "explain" / "results.md").read_text("utf-8")


@pytest.mark.slow
def test_the_page_is_the_one_that_the_kept_tables_give():
    """Otherwise: python -m verification.thesis.results."""
    assert results.page() == TEXT


@pytest.mark.slow
def test_its_numbers_come_from_the_tables(monkeypatch):
    """A changed table changes the page."""
    controls = kept.read("controls")
    monkeypatch.setattr(
        kept, "read", lambda name, read=kept.read: controls.assign(apical=0.5) if name == "controls" else read(name)
    )
    assert "50.0 %" not in TEXT
    assert results.page().count("50.0 %") == 3


def test_a_changed_study_changes_the_page(monkeypatch):
    read = results.read_sealed
    monkeypatch.setattr(results, "read_sealed", lambda file: read(file).assign(true=0.5))
    results.discs.cache_clear()
    assert "its error is at most 0.5" in results.page()
    results.discs.cache_clear()


def test_the_laws_in_the_plane_and_in_space_are_those_of_two_samples():
    table = results.read_sealed(results.sampling.FILE)
    assert set(table.loc[table["d"] > 1, "start"]) == {results.sampling.PAIR}
    assert "In the plane and in space the distance of two independent samples" in TEXT


def test_runs_of_daha_are_counted_by_reading():
    table = results.read_sealed(results.STUDIES / "tissue_daha_ends.parquet")
    for reading in ("desired rest lengths ≥ 0", "published program"):
        ended = table.loc[table["reading"] == reading, "ended"]
        assert f"{ended.sum()} of {len(ended)} runs" in TEXT
