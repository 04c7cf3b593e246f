"""The kept answers on the simplest models: verdicts follow from intervals, and a row comes out again."""

import numpy as np
import pandas as pd
import pytest

from tests.executors import Nowhere
from tissue.study.simplifications import KINDS
from verification.site.context import Context
from verification.site.store import DATA, shipped
from verification.thesis.chapter4.questions import QUESTIONS as CHAPTER4
from verification.tissues.needs import page
from verification.tissues.needs.study import EIGHT, NAME, QUESTIONS, placed, without_protrusions
from verification.tissues.studies import STUDIES


def test_verdicts_follow_from_the_intervals() -> None:
    kept = shipped(NAME)
    assert list(dict.fromkeys(kept["question"])) == list(QUESTIONS)
    shown = kept[kept["difference"].notna()]
    within = shown[["low", "high"]].abs().max(axis=1) < shown["tolerance"]
    assert within[shown["verdict"] == "equivalent"].all()
    assert ((shown[["low", "high"]].abs().min(axis=1) > shown["tolerance"]) == (shown["verdict"] == "different")).all()
    assert (kept.loc[kept["difference"].isna(), "reason"] != "").all()


def test_an_answer_is_equivalent_and_has_one_simplification_of_a_kind() -> None:
    kept = shipped(NAME)
    for row in kept[kept["answer"]].to_dict("records"):
        assert row["verdict"] == "equivalent"
        kinds = [KINDS[name] for name in row["model"].split(" + ")]
        assert len(kinds) == len(set(kinds))
    assert kept.groupby("question")["answer"].sum().max() <= 1


def test_what_the_full_model_answers_is_kept() -> None:
    full = shipped(NAME).groupby("question")["full"].agg(["nunique", "first"])
    assert (full["nunique"] == 1).all()
    assert full.loc["height at 48 h", "first"] == pytest.approx(76, abs=2)
    assert full["first"].drop("height at 48 h").abs().max() < 1


def cells(**columns: list[float]) -> pd.DataFrame:
    return pd.DataFrame({"replicate": [0, 0, 0, 0], "ab_48h": [-0.1, 0.5, -0.2, 0.5], **columns})


def test_the_place_at_the_onset_is_weighed_by_its_share() -> None:
    """The cells of THERE = 7 % begin below a fifth: the mean is the difference of both ratios of basal extrusion."""
    low, high = 7, 93
    table = pd.DataFrame(
        {
            "replicate": 0,
            "onset_ab": [0.1] * low + [0.6] * high,
            "ab_48h": [-0.1] * 5 + [0.5] * 2 + [-0.1] * 31 + [0.5] * 62,
        }
    )
    assert placed(table, 48.0).mean() == pytest.approx(5 / 7 - 31 / 93)


def test_cells_with_protrusions_are_left_out_of_the_mean() -> None:
    table = cells(t_p_h=[10.0, np.inf, np.inf, 12.0])
    # Of the two without protrusions, the second and the third, one leaves.
    assert without_protrusions(table, 48.0).mean() == 0.5
    table = cells(t_p_h=[np.inf, np.inf, 12.0, 12.0])
    assert without_protrusions(table, 48.0).mean() == 0.5
    assert without_protrusions(cells(t_p_h=[1.0] * 4), 48.0).tolist() == [0.0] * 4


def test_the_questions_are_those_of_chapter_4() -> None:
    assert set(EIGHT) == {*CHAPTER4} - {"Q5, mixtures"}


def test_the_summary_names_a_simplest_model_or_says_why_not(tmp_path) -> None:
    context = Context(tmp_path, False, Nowhere(), STUDIES, complete=DATA)
    page.run(context)
    table = context.tables["needs_summary"].set_index("id")
    assert table["work"].isna().tolist() == table["model"].isin(["not decided", "the full model"]).tolist()
    first = context.tables[NAME].groupby("question", sort=False)[["full", "tolerance"]].first()
    assert (table["remark"] != "").tolist() == (first["full"].abs() <= first["tolerance"]).tolist()
