"""The kept answers on the simplest models: verdicts follow from intervals, and a row comes out again."""

import numpy as np
import pytest

from tissue.study.plan import load_study
from tissue.study.simplifications import KINDS
from tissue.study.simplify import BLOCK, FULL, measure
from verification.beyond.needs import answers


def test_verdicts_follow_from_the_intervals() -> None:
    kept = answers.table()
    assert set(kept["question"]) == set(answers.QUESTIONS)
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


@pytest.mark.slow
def test_a_bias_of_the_height_comes_out_again() -> None:
    name_of_study, asked = answers.QUESTIONS["height at 48 h"]
    study = load_study(name_of_study)
    (name,) = asked["scenarios"]
    scenarios = {name: study.scenarios[name].changed({"numerics.t_end": "48 h", "numerics.keep": "48 h"})}
    heights = {
        model: np.array(
            [
                row["value"]
                for row in measure(
                    scenarios, asked["outcome"], study.seed, {"model": model, "scenario": name, "first": 0}
                )
            ]
        )
        for model in (FULL, "no noise")
    }
    kept = answers.table()
    row = kept[(kept["question"] == "height at 48 h") & (kept["model"] == "no noise")].iloc[0]
    assert row["runs"] == BLOCK
    assert (heights["no noise"] - heights[FULL]).mean() == pytest.approx(row["bias"], abs=1e-3)
