"""The kept answers on the simplest models: verdicts follow from intervals, and a row comes out again."""

import numpy as np
import pandas as pd
import pytest

from tissue.study.plan import load_study
from tissue.study.question import asked
from tissue.study.simplifications import KINDS
from tissue.study.simplify import BLOCK, FULL, measure
from verification.beyond.needs import answers
from verification.beyond.needs.questions import EIGHT, FIVE, QUESTIONS, placed, without_protrusions
from verification.thesis.chapter4.questions import QUESTIONS as CHAPTER4


def test_verdicts_follow_from_the_intervals() -> None:
    kept = answers.table()
    assert set(FIVE) <= set(kept["question"]) <= set(QUESTIONS)
    shown = kept[kept["bias"].notna()]
    within = shown[["low", "high"]].abs().max(axis=1) < shown["tolerance"]
    assert ((shown["verdict"] == "enough") == within).all()
    assert (kept.loc[kept["bias"].isna(), "reason"] != "").all()
    assert (shown.loc[shown["verdict"] == "open", "missing"] > 0).all()


def test_an_answer_is_enough_and_has_one_simplification_of_a_kind() -> None:
    kept = answers.table()
    for row in kept[kept["answer"]].to_dict("records"):
        assert (row["verdict"], row["step"]) == ("enough", "together")
        kinds = [KINDS[name] for name in row["model"].split(" + ")]
        assert len(kinds) == len(set(kinds)) == row["parts"]
    assert kept.groupby("question")["answer"].sum().max() <= 1


def test_what_the_full_model_answers_is_kept() -> None:
    full = answers.table().groupby("question")["full"].agg(["nunique", "first"])
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


@pytest.mark.parametrize("name", QUESTIONS)
def test_every_question_can_be_asked(name: str) -> None:
    question = asked(load_study(QUESTIONS[name].study), QUESTIONS[name].what)
    assert question.tolerance > 0
    assert set(EIGHT) == {*CHAPTER4} - {"Q5, mixtures"}


@pytest.mark.slow
def test_a_bias_of_the_height_comes_out_again() -> None:
    name_of_study, what = QUESTIONS["height at 48 h"]
    study = load_study(name_of_study)
    (name,) = what["scenarios"]
    scenarios = {name: study.scenarios[name].changed({"numerics.t_end": "48 h", "numerics.keep": "48 h"})}
    heights = {
        model: np.array(
            [
                row["value"]
                for row in measure(
                    scenarios, what["outcome"], study.seed, {"model": model, "scenario": name, "first": 0}
                )
            ]
        )
        for model in (FULL, "no noise")
    }
    kept = answers.table()
    row = kept[(kept["question"] == "height at 48 h") & (kept["model"] == "no noise")].iloc[0]
    assert row["runs"] == BLOCK
    assert (heights["no noise"] - heights[FULL]).mean() == pytest.approx(row["bias"], abs=1e-3)
