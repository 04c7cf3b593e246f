"""The simplest model that answers: on runs whose biases are known, and what each simplification changes."""

import re
from collections.abc import Sequence
from pathlib import Path
from zlib import crc32

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from typer.testing import CliRunner

import tissue
from dincl.errors import InvalidProblem
from tissue.cli.app import app
from tissue.files.parameters import Parameters
from tissue.study.outcomes import Outcomes
from tissue.study.plan import load_study
from tissue.study.simplifications import SIMPLIFICATIONS, applicable, simplified
from tissue.study.simplify import FRESH, simplify

STUDY = """
title = "small"
base = "published"
replicates = 8
seed = 3
[overrides.emt]
cells = 2
[overrides.numerics]
t_end = "24 h"
keep = "6 h"
[scenarios."[A]"]
emt = { a = "6 h to 18 h" }
[scenarios."[B]"]
emt = { b = "12 h" }
"""
ASKS = '[simplify]\noutcome = "height_um"\nscenarios = ["[A]"]\ntolerance = 1.0\nat = "12 h"\nruns = 128\n'
# Seeds of the runs that were made.
MADE: list[int] = []


def bias(parameters: Parameters) -> float:
    """Return the mean height of the stand-in: two changes that are enough alone, one that is not, one that fails."""
    longer = parameters.numerics.dt.value / parameters.numerics.substeps > 0.05 / 40
    found = 0.6 * longer + 0.7 * (parameters.tissue.diffusion.value == 0)
    return found + 5.0 * (parameters.cell.alpha_axb == 0)


def outcomes(parameters: Parameters, replicates: Sequence[int], seeds: Sequence[int]) -> Outcomes:
    """Stand in for runs: normal heights of the seed, with the bias of the parameters."""
    MADE.extend(seeds)
    end, n = f"{parameters.t_end:g}", len(seeds)
    heights = [np.random.default_rng(seed).normal(50.0, 1.0) + bias(parameters) for seed in seeds]
    ages = np.random.default_rng([crc32(parameters.as_toml().encode()), *seeds]).normal(0.0, 0.05, n)
    failed = parameters.cell.hard_radius.value == 0
    status = ["NON_FINITE" if failed else "SUCCESS"] * n
    runs = {"replicate": list(replicates), "status": status, f"height_um_{end}h": np.array(heights) + ages}
    runs |= {"controls_0h": [parameters.tissue.cells] * n, f"controls_{end}h": [parameters.tissue.cells] * n}
    cells = {"replicate": np.repeat(list(replicates), 2), f"ab_{end}h": np.zeros(2 * n)}
    return Outcomes(pa.table(cells), pa.table(runs), {})


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tissue.study.simplify.outcomes", outcomes)
    Path("study.toml").write_text(STUDY + ASKS)
    MADE.clear()


def verdicts(table: pd.DataFrame, step: str = "alone") -> dict[str, str]:
    rows = table[table["step"] == step]
    return dict(zip(rows["model"], rows["verdict"], strict=True))


@pytest.mark.slow
def test_the_cheapest_model_that_is_enough_is_found() -> None:
    found = simplify("study.toml")
    said = verdicts(found.table)
    assert said["half of the substeps"] == said["no noise"] == said["dt twice as long"] == "enough"
    assert said["no bending"] == said["no hard discs"] == "not enough"
    assert said["a slice"] == "left out"
    reasons = found.table.set_index("model")["reason"]
    assert reasons["a slice"] == "the tissue is a slice already"
    assert reasons["no hard discs"] == "64 of its runs fail"
    # Together the biases of 0.6 and 0.7 exceed the tolerance of 1: the larger one is dropped.
    first, *_, last = verdicts(found.table, "together").items()
    assert "no noise" in first[0]
    assert first[1] == "not enough"
    assert last == (found.model, "enough")
    assert "no noise" not in found.answer
    assert sum("substeps" in name or "dt" in name for name in found.answer) == 1
    simpler = found.parameters(load_study("study.toml").scenarios["[A]"])
    assert bias(simpler) == 0.6
    assert found.saving[1] > 4


@pytest.mark.slow
def test_runs_of_a_look_are_paired_and_combinations_have_fresh_seeds() -> None:
    found = simplify("study.toml", out="out")
    rows = pd.read_parquet("out/simplify.parquet")
    alone = rows["replicate"] < FRESH
    assert set(rows["model"][~alone]) == {"the full model", *verdicts(found.table, "together")}
    noise = rows[alone].pivot_table("value", "replicate", "model")
    assert (noise["no noise"] - noise["the full model"]).std() < 0.1  # heights themselves spread by 1
    assert (found.table.loc[found.table["model"] == "no noise", "bias"] - 0.7).abs().iloc[0] < 0.05


def below_a_third(cells: pd.DataFrame, end: float) -> pd.Series:
    return (cells[f"ab_{end:g}h"] < 1 / 3).astype(float)


@pytest.mark.slow
def test_the_outcome_may_be_a_function_of_the_cells() -> None:
    found = simplify("study.toml", 0.2, outcome=below_a_third, out="out")
    assert found.question.name.endswith("test_simplify.below_a_third")
    # All cells of the stand-in are at 0, in all models that do not fail.
    assert set(pd.read_parquet("out/simplify.parquet")["value"].dropna()) == {1.0}
    assert not found.question.shares


@pytest.mark.slow
def test_the_same_call_goes_on_from_the_table_of_runs() -> None:
    first = simplify("study.toml", out="out")
    made = len(MADE)
    again = simplify("study.toml", tolerance=1.1, out="out")
    assert len(MADE) == made
    assert first.answer == again.answer


@pytest.mark.slow
def test_the_difference_of_two_scenarios_has_no_bias_that_both_share() -> None:
    found = simplify("study.toml", 0.5, scenarios=["[A]", "[B]"])
    assert verdicts(found.table)["no noise"] == "enough"


@pytest.mark.slow
def test_without_simplifications_that_are_enough_the_full_model_stays() -> None:
    found = simplify("study.toml", tolerance=1e-6, runs=64)
    assert found.answer == ()
    assert found.saving == (1.0, 1.0)
    rows = found.table.set_index("model").loc["one length of cycles"]
    assert rows["verdict"] == "open"
    assert rows["missing"] > 64


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"outcome": "hight_um"}, "outcome = 'hight_um': must be one of basal, apical, below, height_um"),
        ({"scenarios": ["[C]"]}, r"scenarios = \['\[C\]'\]: must be a list of one or two of \[A\], \[B\]"),
        ({"scenarios": ["[A]", "[A]"]}, "must be a list of one or two"),
        ({"tolerance": -1}, "tolerance = -1: must be a number above 0, in the unit of the outcome"),
        ({"outcome": "basal", "tolerance": 3}, "tolerance = 3: must be a number above 0 and below 1, such as 0.03"),
        ({"runs": 100}, "runs = 100: must be one of 64, 128, 256, 512, 1024, 2048, 4096, 8192"),
        ({"at": "6 um"}, "at = '6 um': must be a duration"),
        ({"at": "6.03 h"}, "at = '6.03 h': must be an end of its runs: .* a whole number of steps"),
    ],
)
def test_a_bad_question_is_refused_with_one_message(given: dict[str, object], said: str) -> None:
    with pytest.raises(InvalidProblem, match=rf"^study\.toml: simplify\.{list(given)[-1]} = ") as caught:
        simplify("study.toml", **given)  # type: ignore[arg-type]
    assert re.search(said, str(caught.value))
    assert not MADE


def test_an_unknown_key_and_a_missing_tolerance_are_named() -> None:
    Path("study.toml").write_text(f"{STUDY}[simplify]\ntolerances = 0.1\n")
    with pytest.raises(InvalidProblem, match=r"(?s)simplify.tolerances.*tolerance is missing"):
        simplify("study.toml")


@pytest.mark.slow
def test_the_command_prints_verdicts_and_writes_table_and_chart() -> None:
    result = CliRunner().invoke(app, ["simplify", "study.toml", "--out", "out", "--scenario", "[B]"])
    assert result.exit_code == 0, result.output
    assert "height_um of [B] at 12 h, within 1 um" in result.stdout
    assert "no bending" in result.stdout
    assert "counted work." in result.stdout
    assert len(pd.read_csv("out/answer.csv")) >= len(SIMPLIFICATIONS)
    assert Path("out/bias.png").stat().st_size > 10_000
    bad = CliRunner().invoke(app, ["simplify", "study.toml", "--out", "out", "--runs", "3"])
    assert bad.exit_code == 2
    assert "runs = 3: must be one of" in bad.stderr


CHANGES = {
    "a slice": {"tissue.dimension": "2", "tissue.two_daughters": "0.2"},
    "a straight layer": {"layer.shape": "line"},
    "half of the cells": {"tissue.cells": "22"},
    "a third of the cells": {"tissue.cells": "15", "tissue.width": "3.3333333333333335 R_soft"},
    "isolated cells": {"emt.cells": "1"},
    "half of the substeps": {"numerics.substeps": "20"},
    "a quarter of the substeps": {"numerics.substeps": "10"},
    "dt twice as long": {"numerics.dt": "0.1 h"},
    "dt four times as long": {"numerics.dt": "0.2 h"},
    "noise once per dt": {"numerics.noise": "step"},
    "no noise": {"tissue.diffusion": "0 R_soft^2/h"},
    "no hard discs": {"cell.hard_radius": "0 um", "cell.enlarged_radius": "0 um"},
    "no bending": {"cell.alpha_axb": "0.0", "events.bent_stiffness": "0.0"},
    "fixed event times": {"emt.a": "15 h, 70 %"},
    "one length of cycles": {"cell.min_cycle": "15.5 h", "cell.max_cycle": "15.5 h"},
    "no INM of EMT cells": {"emt.inm": "0.0"},
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_simplification_changes_what_it_names(name: str) -> None:
    changes = {"emt.cells": 10, "emt.a": "6 h to 24 h, 70 %", "numerics.noise": "substep"}
    if name == "a straight layer":
        changes |= {"layer.shape": "circle", "layer.perimeter": "600 um"}
    if name == "a slice":
        changes |= {"tissue.dimension": 3, "tissue.two_daughters": 1, "emt.cells": 30}
    full = tissue.preset("published").changed(changes)
    assert applicable([full])[name] == ""
    found = simplified(full, [name])
    for key, value in CHANGES[name].items():
        section, _, field = key.partition(".")
        assert str(getattr(getattr(found, section), field)) == value
    assert applicable([found])[name] != "" or any(word in name for word in ("half", "third", "quarter", "dt"))


def test_every_simplification_is_tested() -> None:
    assert CHANGES.keys() == {one.name for one in SIMPLIFICATIONS}
