"""The stability chapter from its studies to the page, with few cells, and its command."""

from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

from dincl import study
from tests.executors import Here
from tests.verification.thesis.shortened import FEW_CASES, STABILITY
from tests.verification.undrawn import draw_nothing
from verification import cli
from verification.page import context
from verification.page.context import Context
from verification.page.report import write_report
from verification.thesis.chapter2.stability import page as stability
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
    assert "3 failures that theory predicts" in page


def _nothing_runs(*_: object) -> None:
    raise AssertionError("a study ran again")
