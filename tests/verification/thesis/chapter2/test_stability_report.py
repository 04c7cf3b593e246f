"""The stability chapter from its studies to the page, with few cells, and its command."""

from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

from dincl import study
from dincl.study import read_sealed
from tests.executors import Here
from tests.verification.thesis.shortened import FEW_CASES, STABILITY
from tests.verification.undrawn import draw_nothing
from verification import cli
from verification.page import context
from verification.page.context import Context
from verification.page.kept import STUDIES
from verification.page.report import write_report
from verification.thesis.chapter2.stability import page as stability
from verification.thesis.chapter2.stability.catalogue import CASES
from verification.thesis.chapter2.stability.outcome import WORDS


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(context, "Context", lambda *given, complete: Context(*given, forms=STABILITY))
    draw_nothing(monkeypatch)


@pytest.mark.slow
@pytest.mark.usefixtures("short")
def test_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "workers", Here)
    result = CliRunner().invoke(cli.app, ["stability", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert "agrees" in result.output
    assert result.output.count("yes") == len(FEW_CASES)
    planes = STABILITY[0].planes
    names = {plane.name for plane in planes}
    assert {f"stability_{name}.png" for name in names} <= {file.name for file in (tmp_path / "figures").iterdir()}
    for plane in planes:
        table = pd.read_parquet(tmp_path / "tables" / f"stability_{plane.name}.parquet")
        assert len(table) == 4 * len(plane.methods)
        assert set(table["outcome"]) <= set(WORDS)
    counts = pd.read_parquet(tmp_path / "tables" / "stability_outcomes.parquet")
    assert (counts[list(WORDS)].sum(axis=1) == 4).all()
    # The page is written from the tables alone.
    monkeypatch.setattr(study.Study, "_make", _nothing_runs)
    write_report([stability.CHAPTER], Context(tmp_path, False, Here(), STABILITY))
    page = (tmp_path / "failures.html").read_text("utf-8")
    assert "2 of 2 limits and sizes" in page
    assert "1 of 1 failures of which theory predicts the kind" in page


def test_numbers_found_are_of_the_quantity_that_is_predicted() -> None:
    """A failure of which theory predicts the kind only has no numbers beside it."""
    shipped = read_sealed(STUDIES / "stability_cases.parquet")
    assert set(shipped["case"]) == {case.id for case in CASES}
    places, kinds = stability.places_and_kinds(shipped)
    assert places["found"].to_numpy() == pytest.approx(places["expected"].to_numpy(), rel=1e-2, abs=1e-6)
    assert kinds[["expected", "found"]].isna().all(axis=None)
    assert {"collapse", "gap-linearised", "sweep-limit"} <= set(kinds["case"])


def _nothing_runs(*_: object) -> None:
    raise AssertionError("a study ran again")
