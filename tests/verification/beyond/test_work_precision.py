"""The chart of speed against accuracy says what was measured: its rows, its winners, its sentences."""

import pickle
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import dincl
from tests.executors import Here, Nowhere
from tests.verification.thesis.shortened import TWO_SCENES, WORK_PRECISION
from verification.beyond.chart import page as chapter
from verification.beyond.chart import references as work_references
from verification.beyond.chart import work_precision
from verification.beyond.chart.references import reference, rows
from verification.beyond.chart.work_precision import ChartRun, Form
from verification.instruments.budget import CpuSeconds
from verification.instruments.charts import made_of
from verification.instruments.measure import REPEATS
from verification.instruments.references import Known
from verification.page import sheet
from verification.page.context import Context
from verification.page.kept import STUDIES
from verification.thesis.chapter2.methods import (
    ADAPTIVE,
    CATCH_UP_ACTIVE,
    CATCH_UP_DAQP,
    CHARTED,
    CHIPMUNK,
    EVENT_DRIVEN,
    LINEARISED_ACTIVE,
    LINEARISED_DAQP,
    LSODA,
    METHODS,
    MIDPOINT,
    MIDPOINT_ACTIVE,
    PBD,
)

SLIDE = dincl.scenes.sliding_disc()
FEW = Form({"dt": [0.1, 0.05, 0.025], "tol": [1e-2, 1e-4]}, CpuSeconds(100.0))


def table_of(key):
    return pd.DataFrame(rows(key))


def known(name):
    return reference(table_of({"scene": name}), name)


@pytest.fixture(scope="module")
def references():
    return {name: known(name) for name in ("sliding_disc", "stack", "four_disks")}


def made(references, scene, method, form=FEW):
    return pd.DataFrame(ChartRun(references, form)({"scene": scene, "method": method.name}))


# References


def test_exact_references_state_their_rounding(references):
    found = references["stack"]
    assert found.t == pytest.approx(np.arange(1, 31) * 0.05)
    assert (found.x == dincl.scenes.stack().exact(found.t)).all()
    assert 0 < found.error.max() < 1e-12


def test_computed_references_agree_with_catch_up(references):
    found = references["four_disks"]
    assert found.error.max() < 1e-11
    path = dincl.solve(dincl.scenes.four_disks(), dincl.LinearisedCatchUp(1e-3, dincl.Daqp(1e-12)), t=found.t)
    assert np.linalg.norm(path.x - found.x, axis=-1).max() < 1e-3


def test_references_know_their_own_times_only(references):
    found = references["sliding_disc"]
    x, error = found.at(np.array([0.1, 3.0 + 1e-12]))
    assert (x == found.x[[1, -1]]).all()
    assert (error == found.error[[1, -1]]).all()
    with pytest.raises(ValueError, match="among the times"):
        found.at(np.array([0.12]))


def test_tables_of_references_come_back_as_they_were(tmp_path, monkeypatch):
    rng = np.random.default_rng(3)
    x, t, error = rng.normal(size=(2, 5, 2)), [0.25, 1.0], [1e-6, 2e-6]
    kept = pd.DataFrame(
        [
            {"t": t[k], "particle": i, "x": x[k, i, 0], "y": x[k, i, 1], "error": error[k]}
            for k in (1, 0)
            for i in range(5)
        ]
    )
    kept.sample(frac=1, random_state=0).to_parquet(tmp_path / "five.parquet")
    monkeypatch.setattr(work_references, "FILES", {"five": tmp_path / "five.parquet"})
    # Together with a scene of one dimension, whose rows have no y.
    both = pd.concat([table_of({"scene": "stack"}), table_of({"scene": "five"})])
    found = reference(both, "five")
    assert (found.x == x).all()
    assert found.t.tolist() == t
    assert found.error.tolist() == error
    assert reference(both, "stack").x.shape == (30, 6, 1)


def test_a_reference_that_fails_is_no_reference(monkeypatch):
    monkeypatch.setattr(work_references, "TOL", 1e-100)
    monkeypatch.setattr(work_references.dincl, "EventDriven", lambda tol: dincl.PBD(dt=1.0))
    with pytest.raises(dincl.StepFailed):
        rows({"scene": "four_disks"})


# Runs


def test_rows_hold_the_errors_of_each_setting(references):
    found = made(references, "sliding_disc", PBD)
    assert found["setting"].tolist() == FEW.settings["dt"]
    assert (found["status"] == "SUCCESS").all()
    times = references["sliding_disc"].t
    for row in found.itertuples():
        path = dincl.solve(SLIDE, dincl.PBD(row.setting), t=times)
        error = np.linalg.norm(path.x - SLIDE.exact(times), axis=-1).max(axis=1)
        assert (row.largest, row.final) == pytest.approx((error.max(), error[-1]), rel=1e-12)
        assert row.overlap == max(SLIDE.violation(t, x) for t, x in zip(times, path.x, strict=True))
        assert row.steps == row.drift_evaluations == round(3 / row.setting)
    assert (found["repeats"] == REPEATS).all()
    assert (found["cpu_seconds"] > 0).all()


@pytest.mark.slow
def test_tolerances_are_the_settings_of_methods_that_choose_their_steps(references):
    for method in (LSODA, EVENT_DRIVEN, ADAPTIVE):
        found = made(references, "sliding_disc", method)
        assert found["setting"].tolist() == FEW.settings["tol"]
        assert (found["status"] == "SUCCESS").all()
        assert (found["largest"] < 10 * found["setting"]).all()


def test_rows_carry_the_names_of_scene_and_method(references):
    found = made(references, "sliding_disc", CHIPMUNK)
    assert set(found["method"]) == {CHIPMUNK.name}
    assert set(found["scene"]) == {"sliding_disc"}
    one = work_precision.chart(found, "sliding_disc", FEW)
    assert one.costs([0.1]).index.tolist() == [CHIPMUNK.label]
    assert one.looks[CHIPMUNK.label]["color"] == CHIPMUNK.colour


@pytest.mark.parametrize(
    ("method", "like"),
    [(LINEARISED_ACTIVE, LINEARISED_DAQP), (CATCH_UP_ACTIVE, CATCH_UP_DAQP), (MIDPOINT_ACTIVE, MIDPOINT)],
    ids=lambda method: method.name,
)
def test_the_active_set_is_on_the_chart(references, method, like):
    assert method in CHARTED
    assert pickle.loads(pickle.dumps(method)) is method
    ours, theirs = method.make(0.01), like.make(0.01)
    assert type(ours) is type(theirs)
    assert ours.projection == dincl.ActiveSet(theirs.projection.tol)
    found = made(references, "four_disks", method)
    assert (found["status"] == "SUCCESS").all()
    assert (found["largest"] < 2 * found["setting"]).all()


def test_who_cannot_run_says_why(monkeypatch):
    scenes = {"pile": lambda: dincl.scenes.pile(1001), "balls": lambda: dincl.scenes.ball_pile(2)}
    monkeypatch.setattr(work_precision, "SCENES", scenes)
    none = {name: Known(np.ones(1), make().x0[None], np.zeros(1)) for name, make in scenes.items()}
    large = made(none, "pile", EVENT_DRIVEN)
    assert large["status"].tolist() == ["REFUSED", "LEFT_OUT"]
    assert "1001 particles" in large["detail"].iloc[0]
    refused = made(none, "balls", CHIPMUNK)
    assert refused["status"].iloc[0] == "REFUSED"
    assert "Chipmunk" in refused["detail"].iloc[0]
    assert refused["repeats"].iloc[0] == 0


def test_study_names_each_run_once():
    none = {name: Known(np.ones(1), np.zeros((1, 1, 2)), np.zeros(1)) for name in work_references.SCENES}
    complete, again = (work_precision.study(none, form) for form in (work_precision.FULL, chapter.AGAIN))
    for study, scenes in ((complete, work_references.SCENES), (again, chapter.AGAIN.scenes)):
        assert len({(run["scene"], run["method"]) for run in study.runs}) == len(study.runs)
        assert len(study.runs) == len(CHARTED) * len(scenes)
    assert complete.provenance() != again.provenance()


def test_references_are_tighter_than_every_method_on_the_chart():
    assert min(work_precision.FULL.settings["tol"]) == pytest.approx(1e-12)
    assert min(work_precision.FULL.settings["tol"]) > work_references.TOL


def test_what_is_made_again_is_of_the_complete_chart():
    for setting, values in chapter.AGAIN.settings.items():
        assert set(values) <= set(work_precision.FULL.settings[setting])
    assert set(chapter.AGAIN.scenes) <= set(work_precision.FULL.scenes)


# The chapter


@pytest.mark.slow
def test_chapter_writes_its_charts_from_its_tables(tmp_path, monkeypatch):
    monkeypatch.setattr(sheet, "DPI", 50)
    forms = [WORK_PRECISION, TWO_SCENES]
    context = Context(tmp_path, False, Here(), forms)
    chapter.CHAPTER.run(context)
    kept = {"work_references", "work_precision", "work_times", "work_winners", "work_reach"}
    decided = {"decisions", *(f"decisions_{name}" for name in ("profile", "judged", "promise", "cost"))}
    assert context.tables.keys() == kept | decided
    sections = chapter.CHAPTER.sections(context)
    assert len(sections) == 7
    parts = [part for section in sections for part in section.parts]
    pictures = [part.path for part in parts if part.kind == "picture"]
    assert len(pictures) == 3
    assert all(Path(path).stat().st_size > 1000 for path in pictures)
    files = {part.file for part in parts if part.kind == "grid"}
    shown = {"work_precision", "work_reach", "work_times", "work_winners"}
    shown |= {"decisions_profile", "decisions_promise", "decisions_cost"}
    assert files == shown
    assert all((context.folder / f"{name}.csv").is_file() for name in files)
    grids = [part for part in parts if part.kind == "grid" and part.file == "work_winners"]
    winners = [grid.rows["Cheapest"].tolist() for grid in grids if "Cheapest" in grid.rows]
    assert [row for one in winners for row in one] == context.tables["work_winners"]["cheapest"].tolist()
    before = context.tables
    again = Context(tmp_path, False, Nowhere(), forms)  # nothing to run on, as nothing is missing
    chapter.CHAPTER.run(again)
    for name, table in again.tables.items():
        pd.testing.assert_frame_equal(table, before[name])


def test_legends_of_the_charts_that_ship_say_who_calls_python(tmp_path):
    """Also of methods some of whose settings were left out, which are neither compiled nor not."""
    context = Context(tmp_path, False, Nowhere(), complete=STUDIES)
    chapter.CHAPTER.run(context)
    python = {"lsoda", "chipmunk", "catch_up_ipopt", "midpoint_cg", "midpoint_newton", "moreau_jean_daqp"}
    python |= {"catch_up_daqp", "linearised_clarabel", "linearised_daqp", "linearised_piqp"}
    runs = context.tables["work_precision"].groupby(["scene", "method"])
    assert len(runs) == len(CHARTED) * len(work_references.SCENES)
    for (_, method), mine in runs:
        if (mine["status"] == "SUCCESS").any():
            assert made_of(mine) == (" (calls Python)" if method in python else " (compiled)"), method


def test_the_run_of_the_chart_travels_to_other_processes(references):
    """With its form, whose methods hold functions without a name."""
    for form in (chapter.AGAIN, work_precision.FULL):
        run = pickle.loads(pickle.dumps(work_precision.ChartRun(references, form)))
        assert run.form == form
        assert all(method is METHODS[method.name] for method in run.form.methods)
