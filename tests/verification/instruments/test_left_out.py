"""A method whose library is missing is left out of a chart, which says so; the others are measured."""

import sys

import pytest

import dincl
import verification as v
from dincl.extras import MissingLibrary
from verification.command import main
from verification.instruments.compare import compare

SLIDE = dincl.scenes.sliding_disc()
T = [1.0, 2.0]
STEPS = [0.1 / 2**k for k in range(5)]
METHODS = {"PBD": dincl.PBD, "Clarabel": lambda dt: dincl.LinearisedCatchUp(dt, dincl.Clarabel(1e-9))}
WHY = "Clarabel needs clarabel, not installed here; in a clone: pip install '.[yardsticks]'"
FILE = """
import dincl
problem, t, settings = dincl.scenes.sliding_disc(), [1.0], [0.1, 0.05]
methods = {"PBD": dincl.PBD, "Clarabel": lambda dt: dincl.LinearisedCatchUp(dt, dincl.Clarabel(1e-9))}
"""


@pytest.fixture(autouse=True)
def _without_clarabel(monkeypatch):
    monkeypatch.setitem(sys.modules, "clarabel", None)


def test_a_chart_leaves_it_out_and_says_why():
    chart = v.work_precision(SLIDE, METHODS, STEPS, T, SLIDE.exact, v.CpuSeconds(5.0))
    rows = chart.table.set_index("method")
    assert set(rows.loc["PBD", "status"]) == {"SUCCESS"}
    assert set(rows.loc["Clarabel", "status"]) == {"LEFT_OUT"}
    assert set(rows.loc["Clarabel", "detail"]) == {WHY}
    assert repr(chart).endswith(f"left out: Clarabel: {WHY}")
    said = chart.summaries()["Methods that were left out or refused."]
    assert said.to_numpy().tolist() == [["Clarabel", WHY]]
    assert chart.cheapest([1e-2])["cheapest"].tolist() == ["PBD"]
    assert "Clarabel: left out" in [text.get_text() for text in chart.plot().get_legend().get_texts()]


def test_a_chart_of_methods_that_were_all_tried_says_nothing():
    chart = v.work_precision(SLIDE, {"PBD": dincl.PBD}, STEPS, T, SLIDE.exact, v.CpuSeconds(5.0))
    assert "left out" not in repr(chart)
    assert len(chart.summaries()) == 3


def test_a_study_of_orders_leaves_it_out_and_says_why():
    found = v.order_study(SLIDE, METHODS, STEPS, T, SLIDE.exact)
    fits = found.fits.set_index(["method", "error"])
    assert fits.loc[("PBD", "largest"), "low"] < 1.1
    assert fits.loc[("Clarabel", "largest"), ["order", "failed", "verdict"]].tolist() == ["left out", 0, WHY]
    assert repr(found).endswith(f"left out: Clarabel: {WHY}")
    found.plot()


def test_a_program_of_ones_own_whose_library_is_missing_is_left_out():
    def run(problem, setting, t):
        import no_such_library  # noqa: F401

    methods = [v.Method("PBD", scheme=dincl.PBD), v.Method("own", run=run)]
    table = v.work_precision(SLIDE, methods, STEPS, T, SLIDE.exact, v.CpuSeconds(5.0)).table.set_index("method")
    assert set(table.loc["own", "detail"]) == {"No module named 'no_such_library'"}
    assert set(table.loc["PBD", "status"]) == {"SUCCESS"}


@pytest.mark.slow
def test_a_comparison_says_it_on_its_page(tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(FILE, "utf-8")
    page = compare(file, tmp_path / "out")[0].read_text("utf-8")
    assert "Methods that were left out or refused." in page
    assert ".[yardsticks]" in page


def test_a_map_of_one_method_ends_with_the_message():
    with pytest.raises(MissingLibrary, match="needs clarabel"):
        v.stability_map(SLIDE, lambda dt, tol: dincl.CatchUp(dt, dincl.Clarabel(tol)), ("dt", [0.1]), ("tol", [1e-9]))


@pytest.mark.parametrize("command", ["report", "claims", "stability"])
def test_what_one_source_says_needs_all(command, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["verification", command])
    with pytest.raises(SystemExit) as end:
        main()
    message = f"Error: verification {command} needs clarabel, not installed here; in a clone: pip install '.[thesis]'\n"
    assert (end.value.code, capsys.readouterr().err) == (2, message)
