"""The results page says who is cheapest in the sentences of the kept table, and nothing of its own."""

import pandas as pd

from tests.verification.thesis.shortened import WORK_PRECISION, Here
from verification.thesis import results
from verification.thesis.chapter2 import cheapest, kept_winners, work_precision

FALLBACK = "is said there from the table `work_winners`"


def test_the_page_says_what_the_kept_table_says(tmp_path, monkeypatch):
    monkeypatch.setattr(kept_winners, "FILE", tmp_path / "winners.parquet")
    monkeypatch.setattr(kept_winners, "workers", Here)
    monkeypatch.setattr(work_precision, "FULL", WORK_PRECISION)
    assert kept_winners.sentences() == []
    assert FALLBACK in results.page()
    kept_winners.main(tmp_path)
    winners = pd.read_parquet(kept_winners.FILE)
    assert set(winners["scene"]) == set(WORK_PRECISION.scenes)
    page = results.page()
    assert FALLBACK not in page
    assert f"- {cheapest.summary(winners)}\n" in page
    for scene, rows in winners.groupby("scene"):
        title = work_precision.SCENES[scene]().title
        assert f"- {title}: {cheapest.sentence(rows)}\n" in page
