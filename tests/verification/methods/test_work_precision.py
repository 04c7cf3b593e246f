"""The chart of speed against accuracy: references, rows of each method, who is the cheapest, the chapter."""

import math

import numpy as np
import pandas as pd
import pytest

import dincl
from tests.executors import Here, Nowhere
from verification.audit import STUDIES
from verification.instruments.charts import made_of
from verification.methods.chart import work_precision
from verification.methods.chart import work_precision as chapter
from verification.methods.chart.references import SCENES, known
from verification.methods.decisions import study as decisions
from verification.methods.methods import (
    ADAPTIVE,
    CHARTED,
    CHIPMUNK,
    EVENT_DRIVEN,
    LSODA,
    PBD,
    PBD_16,
)
from verification.site import sheet
from verification.site.context import Context
from verification.site.store import DATA, shipped

SLIDE = "sliding_disc"


def made(scene, method):
    return pd.DataFrame(work_precision.ChartRun(smallest=True)({"scene": scene, "method": method.label}))


# References


def test_references_are_in_their_sets_and_tighter_than_every_method():
    for name, charted in SCENES.items():
        scene, kept = charted.make(), known(name)
        assert 0 < kept.error.max() <= charted.tol
        assert kept.t == pytest.approx(charted.t)
        assert max(scene.violation(t, x) for t, x in zip(kept.t, kept.x, strict=True)) < 1e-12
    assert min(work_precision.SETTINGS["tol"]) == pytest.approx(1e-12)
    assert sum(100 <= len(known(name).x[0]) <= 1000 for name in SCENES) >= 3


# Runs


def test_rows_hold_the_errors_of_each_setting():
    rows, exact, slide = made(SLIDE, PBD), known(SLIDE), SCENES[SLIDE].make()
    assert rows["setting"].tolist() == work_precision.SETTINGS["dt"][:2]
    for row in rows.itertuples():
        path = dincl.solve(slide, dincl.PBD(row.setting), t=exact.t)
        error = np.linalg.norm(path.x - exact.x, axis=-1).max(axis=1)
        assert (row.largest, row.final) == pytest.approx((error.max(), error[-1]), rel=1e-12)
        assert row.steps == row.drift_evaluations == round(3 / row.setting)
    assert set(rows["scene"]) == {SLIDE}
    assert set(rows) >= {*shipped("work_precision")}


@pytest.mark.parametrize("method", [LSODA, CHIPMUNK, EVENT_DRIVEN, ADAPTIVE], ids=lambda method: method.name)
def test_smallest_runs_come_out_as_they_ship(method):
    rows, kept = made(SLIDE, method), shipped("work_precision").query("scene == @SLIDE and method == @method.label")
    both = rows.merge(kept, on="setting", suffixes=("", "_kept"))
    assert len(both) == len(rows) == 2
    assert (both["status"] == "SUCCESS").all()
    for column in ("largest", "final", "overlap"):
        assert both[column].to_numpy() == pytest.approx(both[f"{column}_kept"].to_numpy(), rel=1e-3, abs=1e-9)


def test_who_cannot_run_says_why():
    row = made("ball_pile_30", CHIPMUNK).iloc[0]
    assert row["status"] == "REFUSED"
    assert "Chipmunk" in row["detail"]
    assert row["repeats"] == 0


# Who is the cheapest


def measured(errors, seconds, method=PBD, **columns):
    count = len(errors)
    rows = {"scene": SLIDE, "method": method.label, "setting": 0.1 / 2.0 ** np.arange(count), "status": "SUCCESS"}
    rows |= {"largest": errors, "cpu_seconds": seconds, "spread": 1.0, "disturbed": False, "reference_error": 0.0}
    return pd.DataFrame(rows | columns)


def test_winners_are_those_of_the_instrument_beside_pbd():
    pbd, more = measured([1e-1, 1e-3], [1.0, 2.0]), measured([1e-1, 1e-3], [2.0, 3.0], PBD_16)
    rows = pd.concat([measured([1e-3, 1e-6], [1.0, 1.2], LSODA), more, pbd])
    found = work_precision.winners(rows).set_index("target")
    assert found.loc[[1e-2, 1e-3, 1e-6, 1e-8], "cheapest"].tolist() == [LSODA.label] * 3 + ["not reached"]
    assert found.loc[1e-3, "pbd_ratio"] == pytest.approx(2.0)
    assert math.isnan(found.loc[1e-6, "pbd_ratio"])
    wide = work_precision.wide(found.reset_index())
    assert wide["Scene"].tolist() == [SCENES[SLIDE].make().title]
    assert wide[["0.01", "10⁻⁶", "10⁻⁸"]].iloc[0].tolist() == [LSODA.label, LSODA.label, "not reached"]
    coarse = work_precision.winners(rows.assign(reference_error=1e-7)).set_index("target")
    assert coarse.loc[1e-8, "cheapest"] == "not resolved"
    tied = work_precision.winners(pd.concat([pbd, measured([1e-1, 1e-3], [1.1, 2.2], PBD_16)])).set_index("target")
    assert tied.loc[1e-2, "cheapest"] == "tie"


# The chapter


@pytest.mark.slow
def test_chapter_writes_its_charts_from_its_tables(tmp_path, monkeypatch):
    monkeypatch.setattr(sheet, "DPI", 50)
    context = Context(tmp_path, False, Nowhere(), STUDIES, complete=DATA)
    context.executor = Here()
    for part in (chapter, decisions):
        part.run(context)
        part.show(context)
    scenes = set(context.tables["work_precision"]["scene"])
    pictures = list((tmp_path / "figures").glob("*.png"))
    assert len(pictures) == 2 + len(scenes)  # profiles, programs of others
    assert all(path.stat().st_size > 1000 for path in pictures)
    shown = {f"decisions_{name}" for name in ("profile", "promise", "cost")}
    assert set(context.grids) == shown | {"cheapest", "programs"} | {f"cheapest_{name}" for name in scenes}
    python = {"lsoda", "chipmunk", "catch_up_ipopt", "midpoint_cg", "moreau_jean_daqp"}
    python |= {"catch_up_daqp", "linearised_clarabel", "linearised_daqp", "linearised_piqp"}
    names = {method.label: method.name for method in CHARTED}
    for (_, method), mine in context.tables["work_precision"].groupby(["scene", "method"]):
        if (mine["status"] == "SUCCESS").any():
            assert made_of(mine) == (" (calls Python)" if names[method] in python else " (compiled)"), method
