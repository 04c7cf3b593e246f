"""The chapter on the tissue from its studies to the page."""

import re
from pathlib import Path

import pandas as pd
import pytest

from tests.executors import Here
from tests.verification.thesis.shortened_tissue import TISSUE, shorten_tissue
from tests.verification.undrawn import draw_nothing
from verification.page.context import Context
from verification.page.parts import number
from verification.page.report import write_report
from verification.thesis.chapter3.growing import SUCCESS
from verification.thesis.chapter3.sections import growth, kernel, predicted, stability, substeps
from verification.thesis.chapter3.sections import page as chapter

pytestmark = pytest.mark.slow

PARTS = (substeps.PART, predicted.PART, growth.PART, stability.PART, kernel.PART)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    out = tmp_path_factory.mktemp("report")
    context = Context(out, False, Here(), TISSUE)
    with pytest.MonkeyPatch.context() as patch:
        shorten_tissue(patch)
        draw_nothing(patch)
        patch.setattr(chapter, "PARTS", PARTS)
        write_report([chapter.CHAPTER], context)
    return (out / "tissue.html").read_text("utf-8"), context


def test_the_page_says_what_the_tables_say(made):
    page, context = made
    assert not re.search(r"\bnan\b", page)
    tables = context.tables
    for order in tables["tissue_orders"]["order"]:
        assert order in page
    for row in tables["tissue_enough"].itertuples():
        assert f"{row.preset}, {row.t:g} h: " + (f"from {row.substeps} " if row.substeps else "with none tried") in page
    own = tables["tissue_swing"].set_index(["preset", "substeps"])["beyond"]
    assert f"{100 * own['thesis', 20]:.1f} % [" in page
    assert "The condition does not hold" in page
    for row in tables["tissue_swing"].itertuples():
        assert f">{number(row.scale)}</td>" in page
        assert f">{number(row.mean)}</td>" in page
    assert (tables["tissue_limits_found"]["agrees"]).all()
    assert set(tables["tissue_kernel"]["status"]) == {SUCCESS}


def test_the_page_is_written_from_tables_alone(made, monkeypatch):
    shorten_tissue(monkeypatch)
    monkeypatch.setattr(chapter, "PARTS", PARTS)
    again = Context(made[1].out, False, Here(), TISSUE)
    monkeypatch.setattr(Here, "submit", _nothing_runs)
    chapter.run(again)
    for name, rows in again.tables.items():
        pd.testing.assert_frame_equal(rows, made[1].tables[name])


def test_tables_lie_beside_the_page(made):
    folder = Path(made[1].folder)
    assert {path.stem for path in folder.glob("*.csv")} == {
        *("tissue_substeps", "tissue_errors", "tissue_orders", "tissue_heights", "tissue_enough"),
        *("tissue_disturbed", "tissue_distances", "tissue_rates", "tissue_predicted"),
        *("tissue_growth", "tissue_ratios", "tissue_doubling"),
        *(f"tissue_map_{name}" for name in ("steps", "damping", "bending", "springs")),
        *("tissue_losses", "tissue_jitter", "tissue_swing", "tissue_limits", "tissue_limits_found"),
        *("tissue_kernel", "tissue_kernel_growth"),
    }


def _nothing_runs(*_):
    raise AssertionError("a study ran again")
