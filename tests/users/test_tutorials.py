"""Tutorials, how-to pages and pages about extensions: all run, and what they promise in words comes out."""

import numpy as np
import pytest

import dincl
from docs.building.shown import is_notebook
from tests.optional import need_module, need_rendering
from tests.pages import ROOT, play, run
from tissue.plugins import registry
from tissue.runs.registration import KINDS
from verification.claims import Verdict

pytestmark = pytest.mark.slow

DOCS = ROOT / "docs"
PAGES = {page.stem: page for page in sorted(DOCS.rglob("*.md")) if "made" not in page.parts and is_notebook(page)}
EXTENSIONS = [page for page in sorted((DOCS / "extend").glob("*.md")) if "```python" in page.read_text("utf-8")]
# Words that a page prints.
PRINTED = {
    "claims": ["2 passed"],
    "emt_study": ["Answers: 6 comparisons", "not shown"],
    "meanfield": ["Phi is not affine in X"],
    "simplify": ["within 6;", "within 3;", "Left out", "no noise", "times less work"],
    "solve": ["SUCCESS", "LinearisedCatchUp", "contact, particle", "smaller dt"],
    "tissue": ["SUCCESS", "height_um", "damping"],
}


def slope(found, method):
    return found["orders"].fits.set_index(["method", "error"]).loc[(method, "final"), "slope"]


def first_steps(found):
    costs = found["chart"].costs([1e-2, 1e-4])
    assert costs.loc["PBD"].notna().tolist() == [True, False]
    assert found["path"].error.max() < 1e-8


def own_problem(found):
    assert found["known"].x[-1] == pytest.approx(np.array([[0.55, 0.3], [1.15, 0.3], [0.55, 0.9]]), abs=1e-9)
    assert slope(found, "PBD") == pytest.approx(1.0, abs=0.15)
    springs = found["chart"].table.query("method == 'LSODA on springs'").sort_values("setting")
    assert springs["largest"].iloc[0] < 1e-3 < springs["largest"].iloc[-1]
    assert set(found["penalties"].table.set_index(["dt", "pull"])["outcome"][0.04]) == {"unstable"}


def own_scheme(found):
    free, slide = found["free"], found["slide"]
    for problem, exact, t in ((free, np.exp(-1.0) * free.x0, 1.0), (slide, slide.exact(2.0), 2.0)):
        assert abs(found["orders"](problem, exact, t, found["bdf"])[-1] - 2) < 0.1
    table = found["table"].set_index(["method", "setting"])
    assert table["compiled"].groupby("method").all().to_dict() == {"PBD": True, "HeunPBD": True, "HeunCatchUp": False}
    np.testing.assert_allclose(found["ours"].x, found["theirs"].x, atol=1e-5)
    exact = dincl.solve(found["problem"], dincl.EventDriven(1e-8), t=[1.0])
    for scheme in found["schemes"]:
        path = dincl.solve(found["problem"], scheme, t=[1.0])
        np.testing.assert_allclose(path.x, exact.x, atol=0.1 if isinstance(scheme, dincl.Penalty) else 0.02)


def moving_sets(found):
    path = found["path"]
    assert np.abs(path.x - found["exact"](path.t)).max() <= path.error.max() <= 1e-9
    assert slope(found, "midpoint catch-up") == pytest.approx(2.0, abs=0.3)


def as_you_have_it(found):
    assert found["forces"].load(1).tolist() == pytest.approx([0.0, 3.0])
    assert found["driven"].final[0, 0] == pytest.approx(2 * (1.1 - 1 / 3))
    assert abs(found["rest"].x - found["whole"].x).max() < 1e-9


def own_event(found):
    table = found["run"].table().query("emt >= 0 and time_h == 12")
    squeezed = table["events"] == "BSqueeze"
    assert table.loc[squeezed, "hard_radius_um"].tolist() == pytest.approx([0.75] * squeezed.sum()) != []
    assert "t_squeeze_h" not in found["results"].cells("not")


def own_force(found):
    assert found["error"] < 1e-6
    heights = found["heights"]
    assert heights[max(heights)] < heights[min(heights)]


def cell_types(found):
    assert found["counts"].iloc[0].to_dict() == {"control": 30, "stiff": 6, "quick": 6, "leaving": 3}
    assert found["counts"]["quick"].iloc[-1] > 18
    assert len(found["results"].cells("slow")) == 3 * 16


def space(found):
    assert len(found["run"].final.cells.x) == 196
    assert {"nucleus_z_um", "apical_z_um", "basal_z_um"} <= set(found["run"].table().columns)


def own_rules(found):
    sensed = found["sensed"].query("time_h == 12")
    assert (sensed["events"] == "BSense").all()
    assert sensed.query("signal_nM < 6").shape[0] > 0  # daughters, which have half of what their mother had
    for base in ("published", "sheet"):
        assert found["mean"][base, "10 um/h"] > 20
        assert found["mean"][base, "-10 um/h"] < -20
    assert found["widths"][10] < 0.5 * found["widths"][1]


def other_programs(found):
    assert found["found"].sizes["time_h"] == 13
    assert len(found["results"].series("short")) == 8 * 3


def simplify(found):
    assert found["found"].saving > 2


def claims(found):
    assert found["found"].verdict is Verdict.REFUTED


def proofs(found):
    assert found["proof"].bound <= 1e-25


FOUND = (
    first_steps,
    own_problem,
    own_scheme,
    as_you_have_it,
    moving_sets,
    own_event,
    own_force,
    cell_types,
    space,
)
CHECKS = {check.__name__: check for check in (*FOUND, own_rules, other_programs, simplify, claims, proofs)}


@pytest.mark.parametrize("name", PAGES)
def test_a_page_runs_and_gives_what_it_says(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    if name == "space":
        need_rendering()
    if name == "other_programs":
        need_module("xarray")
    try:
        found = play(PAGES[name], tmp_path)
        assert [words for words in PRINTED.get(name, ()) if words not in found["printed"]] == []
        CHECKS.get(name, lambda _: None)(found)
    finally:
        for kind in KINDS:
            registry(kind).clear()


@pytest.mark.parametrize("page", EXTENSIONS, ids=lambda page: page.stem)
def test_examples_of_extensions_run(page, capsys):
    run(page)
    assert capsys.readouterr().out.strip()
