"""The other tutorials: their notebooks run, files, Python and commands, and what their text says is so."""

import re

import pytest

import tissue
from docs.building import notebooks
from tests.optional import need_module
from tests.pages import ROOT, blocks, play
from tissue.study.answers import answer_table
from verification.claims import Verdict

PAGES, HOW_TO = ROOT / "docs" / "tutorials", ROOT / "docs" / "howto"


@pytest.mark.slow
def test_a_kernel_of_jupyter_runs_a_notebook(tmp_path, monkeypatch):
    """Of all the one with libraries that no other has; the others are run by IPython in this process."""
    for module in ("ipykernel", "nbclient"):
        need_module(module)
    import nbclient

    for variable in ("JUPYTER_RUNTIME_DIR", "IPYTHONDIR"):
        monkeypatch.setenv(variable, str(tmp_path))
    made = notebooks.notebook(PAGES / "meanfield.md")
    nbclient.NotebookClient(made, resources={"metadata": {"path": str(tmp_path)}}).execute()
    words = notebooks.printed(made)
    assert [word for word in ("g is affine in X", "Work(") if word not in words] == []


@pytest.mark.slow
def test_five_minutes(tmp_path):
    found = play(PAGES / "first_steps.md", tmp_path)
    costs = found["chart"].costs([1e-2, 1e-4])
    assert costs.loc["PBD"].notna().tolist() == [True, False]
    assert costs.loc[["midpoint catch-up", "event-driven"], 1e-4].max() < 0.05
    assert (tmp_path / "results" / "first" / "picture.png").exists()
    assert found["run"].summary()["time_h"].iloc[-1] == 54
    assert found["path"].error.max() < 1e-8


@pytest.mark.slow
def test_tissue(tmp_path):
    found = play(PAGES / "tissue.md", tmp_path)
    assert [word for word in ("SUCCESS", "height_um", "damping") if word not in found["printed"]] == []
    assert (tmp_path / "results" / "tissue.gif").exists()


@pytest.mark.slow
def test_a_small_study_is_planned_run_and_drawn(tmp_path):
    found = play(PAGES / "emt_study.md", tmp_path)
    words = ("6 comparisons, planned", "Least effect that is shown", "Answers: 6 comparisons", "page.html")
    assert [word for word in words if word not in found["printed"]] == []
    answers = tmp_path / "results" / "constriction" / "figures" / "answer_3.png"
    assert answers.read_bytes().startswith(b"\x89PNG")
    assert "not shown" in found["printed"]


@pytest.mark.slow
def test_the_simplest_model_is_found(tmp_path):
    found = play(HOW_TO / "simplify.md", tmp_path)
    words = ("within 6;", "within 3;", "Left out", "no noise", "times less work")
    assert [word for word in words if word not in found["printed"]] == []
    assert found["found"].saving > 2


@pytest.mark.xslow
def test_the_large_study_has_the_answers_of_the_text(tmp_path):
    """To what another processor may change: a few of 2,000 cells."""
    page = PAGES / "emt_study.md"
    text = page.read_text("utf-8")
    (study,) = [block for block in blocks(text, "toml") if "replicates = 40" in block]
    (tmp_path / "constriction.toml").write_text(study.replace("replicates = 40", "replicates = 400"))
    results = tissue.run_study(tmp_path / "constriction.toml", tmp_path / "out")
    table = answer_table(results).set_index(["question", "measure"])
    rows = {
        "on a line": "early - late, line",
        "inside an arc": "early - late, arc",
        "inside against on a line": "(early - late, arc) - (early - late, line)",
    }
    for name, question in rows.items():
        cells = re.search(rf"^\| {name} \|.*\|(.*)\|(.*)\|$", text, re.MULTILINE).groups()
        for measure, cell, scale in (("difference", cells[0], 100), ("ratio", cells[1], 1)):
            row = scale * table.loc[(question, measure), ["value", "low", "high"]].astype(float)
            said = [float(number) for number in re.findall(r"[-+]?\d+\.\d+", cell)]
            assert row.to_list() == pytest.approx(said, rel=0.1, abs=0.5)
            assert (row["low"] > 0 or row["high"] < 0) if scale == 100 else (row["low"] > 1 or row["high"] < 1)


@pytest.mark.slow
def test_claims_of_ones_own(tmp_path):
    found = play(PAGES / "claims.md", tmp_path)
    assert "2 passed" in found["printed"]
    assert found["found"].verdict is Verdict.REFUTED


@pytest.mark.slow
def test_solve(tmp_path):
    words = play(PAGES / "solve.md", tmp_path)["printed"]
    wanted = ("SUCCESS", "LinearisedCatchUp", "contact, particle", "smaller dt")
    assert [word for word in wanted if word not in words] == []
