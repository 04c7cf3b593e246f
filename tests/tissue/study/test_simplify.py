"""The simplest model that answers: the tests, on runs whose differences are known, and what each one changes."""

import re
from collections.abc import Sequence
from pathlib import Path
from zlib import crc32

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from statsmodels.stats.weightstats import ttost_paired
from typer.testing import CliRunner

import tissue
from dincl.errors import InvalidProblem
from tests.tissue.users import shelves
from tissue.cli.app import app
from tissue.files.parameters import Parameters
from tissue.study.outcomes import Outcomes
from tissue.study.plan import load_study
from tissue.study.simplifications import KINDS, applicable, simplified
from tissue.study.simplify import FRESH, equivalence, simplify

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
ASKS = {"outcome": "height_um", "at": "12 h", "runs": 64}
# Seeds of the runs that were made.
MADE: list[int] = []


def difference(parameters: Parameters) -> float:
    """Return the mean height of the stand-in: changes that are equivalent alone, and one that is not."""
    found = 0.3 * (parameters.numerics.substeps < 40) + 0.4 * (parameters.tissue.diffusion.value == 0)
    return found + 5.0 * (parameters.cell.alpha_axb == 0)


def outcomes(parameters: Parameters, replicates: Sequence[int], seeds: Sequence[int]) -> Outcomes:
    """Stand in for runs: normal heights of the seed, with the difference of the parameters."""
    MADE.extend(seeds)
    end, n = f"{parameters.t_end:g}", len(seeds)
    heights = [np.random.default_rng(seed).normal(50.0, 1.0) + difference(parameters) for seed in seeds]
    noise = np.random.default_rng([crc32(parameters.as_toml().encode()), *seeds]).normal(0.0, 0.05, n)
    failed = parameters.cell.hard_radius.value == 0
    ends = "FOLDED" if parameters.emt.p.ever else "NON_FINITE" if failed else "SUCCESS"
    runs = {"replicate": list(replicates), "status": [ends] * n}
    runs |= {f"height_um_{end}h": np.array(heights) + noise}
    runs |= {"controls_0h": [parameters.tissue.cells] * n, f"controls_{end}h": [parameters.tissue.cells] * n}
    cells = {"replicate": np.repeat(list(replicates), 2), f"ab_{end}h": np.zeros(2 * n)}
    return Outcomes(pa.table(cells), pa.table(runs))


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tissue.study.simplify.outcomes", outcomes)
    Path("study.toml").write_text(STUDY)
    MADE.clear()


def test_the_tests_are_those_of_statsmodels() -> None:
    rng = np.random.default_rng(4)
    full = rng.normal(1.0, 0.4, 200)
    simple = full + rng.normal(0.03, 0.3, 200)
    found = equivalence(simple - full, 0.1, shares=False, level=0.01)
    assert found.p == pytest.approx(ttost_paired(simple, full, -0.1, 0.1)[0], rel=1e-9)
    assert (found.low > -0.1 and found.high < 0.1) == (found.p < 0.01)
    assert equivalence(np.full(64, 0.5), 1.0, shares=False, level=0.05)[:] == (0.5, 0.5, 0.5, 0.0)
    assert equivalence(np.full(64, -2.0), 1.0, shares=False, level=0.05).p == 1.0


@pytest.mark.parametrize("changed", [0.03, 0.1])
@pytest.mark.parametrize("runs", [64, 256])
def test_of_a_difference_of_the_tolerance_equivalence_is_rarely_said(changed: float, runs: int) -> None:
    """Shares of runs with one cell: a part of the runs gains it, another part loses it, 3 points more than gain."""
    rng, low = np.random.default_rng([5, runs, int(100 * changed)]), (changed - 0.03) / 2
    draws = rng.choice([-1.0, 0.0, 1.0], (4000, runs), p=[low + 0.03, 1 - changed, low])
    said = [equivalence(one, 0.03, shares=True, level=0.05).p < 0.05 for one in draws]
    assert np.mean(said) < 0.05 + 3 * np.sqrt(0.05 * 0.95 / 4000)


@pytest.mark.slow
def test_those_that_are_equivalent_are_combined_and_tested_with_fresh_seeds() -> None:
    found = simplify("study.toml", 1.0, out="out", **ASKS)
    rows = found.table.set_index("model")
    verdicts = rows["verdict"].to_dict()
    assert verdicts["fewest substeps"] == verdicts["no noise"] == verdicts["half of the cells"] == "equivalent"
    assert verdicts["no bending"] == verdicts["no hard discs"] == "different"
    assert rows.loc["no hard discs", "reason"] == "64 of its runs fail"
    assert found.left_out["a slice"] == "these parameters are so already"
    # 0.3 and 0.4 add up to more than half of the tolerance: fewer substeps save more work.
    assert {"fewest substeps", "a third of the cells"} < set(found.answer)
    assert len({KINDS[name] for name in found.answer}) == len(found.answer)
    assert "no noise" not in found.answer
    assert difference(found.parameters(load_study("study.toml").scenarios["[A]"])) == 0.3
    assert found.saving > 4
    made = pd.read_parquet("out/simplify.parquet")
    alone = made["replicate"] < FRESH
    assert set(made["model"][~alone]) == {"the full model", " + ".join(found.answer)}
    heights = made[alone].pivot_table("value", "replicate", "model")
    assert (heights["no noise"] - heights["the full model"]).std() < 0.1  # heights themselves spread by 1
    assert rows.loc["no noise", "difference"] == pytest.approx(0.4, abs=0.05)
    # The same call with another tolerance goes on from these runs.
    count = len(MADE)
    assert simplify("study.toml", 1.1, out="out", **ASKS).answer == found.answer
    assert len(MADE) == count
    with shelves():  # runs of other modules of users are other runs
        tissue.register(tissue.Variable("dose", "of a drug"))
        simplify("study.toml", 1.1, out="out", **ASKS)
    assert len(MADE) == 2 * count


@pytest.mark.slow
def test_a_combination_that_is_not_equivalent_leaves_the_one_that_saves_most(monkeypatch: pytest.MonkeyPatch) -> None:
    def together(parameters: Parameters, replicates: Sequence[int], seeds: Sequence[int]) -> Outcomes:
        made = outcomes(parameters, replicates, seeds)
        shifted = made.runs.to_pandas()
        if parameters.tissue.cells == 15 and parameters.numerics.substeps < 40:
            shifted["height_um_12h"] += 3.0
        return made._replace(runs=pa.Table.from_pandas(shifted))

    monkeypatch.setattr("tissue.study.simplify.outcomes", together)
    found = simplify("study.toml", 1.0, **ASKS)
    assert found.table["verdict"].iloc[-1] == "different"
    assert len(found.answer) == 1
    assert found.saving == pytest.approx(1 / found.table.loc[found.table["verdict"] == "equivalent", "work"].min())


def below_a_third(cells: pd.DataFrame, end: float) -> pd.Series:
    return (cells[f"ab_{end:g}h"] < 1 / 3).astype(float)


@pytest.mark.slow
def test_functions_of_cells_differences_of_scenarios_and_no_answer() -> None:
    simplify("study.toml", 0.2, outcome=below_a_third, runs=32, out="out")
    # All cells of the stand-in are at 0, in all models that do not fail.
    assert set(pd.read_parquet("out/simplify.parquet")["value"].dropna()) == {1.0}
    both = simplify("study.toml", 0.2, scenarios=["[A]", "[B]"], **ASKS)
    assert both.table.set_index("model").loc["no noise", "verdict"] == "equivalent"  # both have the difference
    none = simplify("study.toml", 1e-6, **ASKS | {"runs": 32})
    assert none.answer == ()
    assert none.saving == 1.0
    assert none.table.set_index("model").loc["one length of cycles", "verdict"] == "open"


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"outcome": "hight_um"}, "outcome = 'hight_um': must be one of basal, apical, below, height_um"),
        ({"scenarios": ["[C]"]}, r"scenarios = \['\[C\]'\]: must be a list of one or two of \[A\], \[B\]"),
        ({"scenarios": ["[A]", "[A]"]}, "must be a list of one or two"),
        ({"tolerance": -1}, "tolerance = -1: must be a finite number > 0"),
        ({"tolerance": 3}, "tolerance = 3: must be below 1 for shares, such as 0.03"),
        ({"runs": 8}, "runs = 8: must be an integer from 16"),
        ({"at": "6 um"}, "numerics.t_end"),
    ],
)
def test_a_bad_question_is_refused_with_one_message(given: dict[str, object], said: str) -> None:
    with pytest.raises(InvalidProblem) as caught:
        simplify("study.toml", **({"tolerance": 0.1} | given))  # type: ignore[arg-type]
    assert re.search(said, str(caught.value))
    assert not MADE


def test_where_all_runs_are_folded_that_is_said() -> None:
    Path("study.toml").write_text(STUDY.replace('emt = { b = "12 h" }', 'emt = { b = "6 h", p = "6 h" }'))
    with pytest.raises(InvalidProblem) as caught:
        simplify("study.toml", 1.0, scenarios=["[B]"], **ASKS)
    assert str(caught.value).startswith("all 64 runs of the full model are folded, so that heights and positions mean")


@pytest.mark.slow
def test_the_command_prints_verdicts_and_writes_the_table() -> None:
    asks = ["--outcome", "height_um", "--at", "12 h", "--runs", "32", "--scenario", "[B]", "--out", "out"]
    result = CliRunner().invoke(app, ["simplify", "study.toml", "--tolerance", "1", *asks])
    assert result.exit_code == 0, result.output
    assert "times less work." in result.stdout
    rows = pd.read_csv("out/answer.csv").set_index("model")
    assert rows.loc["no bending", "verdict"] == "different"
    known = pd.read_csv("out/columns.csv")
    assert set(known.loc[known["table"] == "answer", "column"]) == {"model", *rows}
    assert set(known.loc[known["table"] == "simplify", "column"]) == set(pd.read_parquet("out/simplify.parquet"))
    assert known["meaning"].notna().all()
    bad = CliRunner().invoke(app, ["simplify", "study.toml", "--tolerance", "-1", *asks])
    assert bad.exit_code == 2
    assert "tolerance = -1" in bad.stderr


CHANGES = {
    "a slice": {"tissue.dimension": "2", "tissue.two_daughters": "0.2"},
    "a straight layer": {"layer.shape": "line"},
    "half of the cells": {"tissue.cells": "22"},
    "a third of the cells": {"tissue.cells": "15", "tissue.width": "3.3333333333333335 R_soft"},
    "isolated cells": {"emt.cells": "1"},
    "half of the substeps": {"numerics.substeps": "20"},
    "fewest substeps": {"numerics.substeps": "4"},
    "noise once per dt": {"numerics.noise": "step"},
    "no noise": {"tissue.diffusion": "0 R_soft^2/h"},
    "no hard discs": {"cell.hard_radius": "0 um", "cell.enlarged_radius": "0 um"},
    "no bending": {"cell.alpha_axb": "0.0", "events.bent_stiffness": "0.0"},
    "fixed event times": {"emt.a": "15 h, 70 %"},
    "one length of cycles": {"cell.min_cycle": "15.5 h", "cell.max_cycle": "15.5 h"},
    "no INM of EMT cells": {"emt.inm": "0.0"},
}


@pytest.mark.parametrize("name", KINDS)
def test_a_simplification_changes_what_it_names(name: str) -> None:
    changes = {"emt.cells": 10, "emt.a": "6 h to 24 h, 70 %", "numerics.noise": "substep"}
    if name == "a straight layer":
        changes |= {"layer.shape": "circle", "layer.perimeter": "600 um"}
    if name == "a slice":
        changes |= {"tissue.dimension": 3, "tissue.cells": 196, "tissue.two_daughters": 1, "emt.cells": 30}
    full = tissue.preset("published").changed(changes)
    assert applicable([full])[name] == ""
    found = simplified(full, [name])
    for key, value in CHANGES[name].items():
        section, _, field = key.partition(".")
        assert str(getattr(getattr(found, section), field)) == value
    assert applicable([found])[name] != "" or any(word in name for word in ("half", "third"))
