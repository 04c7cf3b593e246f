"""Examples of tissue: what is measured of curved layers, sheets, fits and simpler models, and what the tables say."""

import numpy as np
import pandas as pd
import pytest

import tissue
from tests.executors import Nowhere
from tissue.state.cells import CONTROL
from tissue.study.plan import load_study
from tissue.study.simplifications import KINDS
from verification.audit import STUDIES
from verification.site.context import Context
from verification.site.store import DATA, shipped
from verification.thesis.chapter4.questions import QUESTIONS as CHAPTER4
from verification.tissues import curved
from verification.tissues.fits import HEIGHT, OTHERS, OWN
from verification.tissues.needs import study
from verification.tissues.needs.study import EIGHT, NAME, QUESTIONS, placed, without_protrusions
from verification.tissues.space import growth, isolated
from verification.tissues.space import sheet as fitted
from verification.tissues.space.growth import roughness
from verification.tissues.space.isolated import are_inner, counted, with_intervals

pytestmark = pytest.mark.filterwarnings("ignore:.* never begins")


def test_ways_out_are_counted_with_their_intervals():
    table = shipped(curved.NAME)
    assert len(table) == 2 * len(curved.study().runs) == 2 * 6 * len(curved.LAYERS)
    assert ((table["low"] <= table["value"]) & (table["value"] <= table["high"])).all()
    assert table["value"].to_numpy() == pytest.approx((table["count"] / table["of"]).to_numpy())


def test_curvature_matters_as_the_page_says():
    table = shipped(curved.NAME).query("side == 'basal'").set_index(["events", "layer"])
    of_a = table.loc["[A]"]
    assert of_a.loc["inside", "low"] > 2 * of_a.loc["line", "high"]
    assert of_a.loc["outside", "high"] < 0.7 * of_a.loc["line", "low"]
    assert (table.loc["[BP]", "low"] > 0.5).all()


# Fits


def test_coverage_is_within_its_range():
    table = shipped("fit_coverage")
    for data, names in ((OWN, ("mu", "two_daughters")), (HEIGHT, ("mu", "two_daughters"))):
        rows = table[(table["data"] == data) & (table["points"] == 96)]
        assert len(rows) > 200
        for name in names:
            inside = (rows[f"{name}_low"] <= rows[name]) & (rows[name] <= rows[f"{name}_high"])
            assert 0.9 <= inside.mean() <= 0.99
        widths = (rows["two_daughters_high"] - rows["two_daughters_low"]).median()
        assert widths < 0.2 if data == OWN else widths > 0.45
        assert (rows["p"] < 0.05).mean() <= 0.1
    for name in OTHERS:
        rows = table[table["data"].str.startswith(f"preset {name},")]
        assert (rows["p"] < 0.01).mean() > 0.9


# What a scene needs


def test_verdicts_follow_from_the_intervals() -> None:
    kept = shipped(NAME)
    assert list(dict.fromkeys(kept["question"])) == list(QUESTIONS)
    shown = kept[kept["difference"].notna()]
    within = shown[["low", "high"]].abs().max(axis=1) < shown["tolerance"]
    assert within[shown["verdict"] == "equivalent"].all()
    assert ((shown[["low", "high"]].abs().min(axis=1) > shown["tolerance"]) == (shown["verdict"] == "different")).all()
    assert (kept.loc[kept["difference"].isna(), "reason"] != "").all()
    for row in kept[kept["answer"]].to_dict("records"):
        assert row["verdict"] == "equivalent"
        kinds = [KINDS[name] for name in row["model"].split(" + ")]
        assert len(kinds) == len(set(kinds))
    assert kept.groupby("question")["answer"].sum().max() <= 1


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
    assert without_protrusions(cells(t_p_h=[1.0] * 4), 48.0).tolist() == [0.0] * 4


def test_the_questions_are_those_of_chapter_4() -> None:
    assert set(EIGHT) == {*CHAPTER4} - {"Q5, mixtures"}


def test_the_summary_names_a_simplest_model_or_says_why_not(tmp_path) -> None:
    context = Context(tmp_path, False, Nowhere(), STUDIES, complete=DATA)
    study.run(context)
    table = context.tables["needs_summary"].set_index("id")
    assert table["work"].isna().tolist() == table["model"].isin(["not decided", "the full model"]).tolist()
    first = context.tables[NAME].groupby("question", sort=False)[["full", "tolerance"]].first()
    assert (table["remark"] != "").tolist() == (first["full"].abs() <= first["tolerance"]).tolist()


# Sheets


def sheet(**more):
    changes = {"tissue.dimension": 3, "tissue.cells": 64, "space.boundary": "open", "numerics.t_end": "0.05 h"}
    return tissue.simulate(tissue.preset("published").changed(changes | more), 1).frames[0]


@pytest.mark.parametrize("frame", [sheet(), tissue.simulate(tissue.preset("published"), 1).frames[0]])
def test_roughness_is_that_of_neighbours(frame):
    """Heights on a plane have none within; a point that is h above its neighbours adds h^2, and h^2 / k to each."""
    assert roughness(frame) == 0.0
    cells, apical = frame.cells, frame.layers.apical
    i = apical[len(apical) // 2 + 4]
    raised = frame._replace(cells=cells._replace(ay=np.where(np.arange(len(cells.ay)) == i, 8.5, 8.0)))
    edges = growth.junctions(frame)
    counts = np.bincount(edges.ravel(), minlength=len(cells.x))
    around = edges[(edges == i).any(axis=1)].sum(axis=1) - i
    inner = counts[around] > 1
    squares = 0.5**2 * (1 + (1 / counts[around][inner] ** 2).sum())
    assert roughness(raised) == pytest.approx(np.sqrt(squares / (counts > 1).sum()))


def test_extents_are_measured_over_the_start():
    first = sheet()
    wide = first.cells._replace(bx=2 * first.cells.bx, bz=2 * first.cells.bz)
    told = growth.measured(first._replace(cells=wide), first)
    assert told["basal"] == pytest.approx(2.0)
    assert told["fan"] == pytest.approx(0.5)
    assert told["height"] == told["number"] == told["section"] == 1.0


def test_folded_runs_have_no_height():
    """Of three runs one is folded: its cells count, its height does not."""
    same = {"layer": "periodic sheet", "cells": 196, "both": 1.0, "t": 48.0, "basal": 1.0, "fan": 1.0, "rough": 0.1}
    rows = [
        {**same, "seed": seed, "height": height, "number": 8.0, "section": section, "folded": folded}
        for seed, height, section, folded in ((0, 2.0, 4.0, False), (1, 3.0, 4.0, False), (2, 99.0, 7.0, True))
    ]
    (mean,) = growth.means(pd.DataFrame(rows)).itertuples()
    assert (mean.height, mean.section, mean.runs, mean.folded) == (2.5, 5.0, 3, 1)
    (lost,) = growth.means(pd.DataFrame(rows[2:])).itertuples()
    assert np.isnan(lost.height)


def test_outlines_of_hexagons():
    """A triangular lattice has regular hexagons of the side s/sqrt 3 around its points."""
    found = tissue.preset("sheet").lattice()
    periods = np.array([found.surface.period_x, found.surface.period_z])
    assert fitted.outline(found.basal[[0, 2]].T, periods) == pytest.approx(2 * np.sqrt(3) * found.spacing)


def test_the_fitted_sheet_keeps_what_is_published_in_every_run():
    table = shipped("space_sheet").set_index("tissue").loc[fitted.FITTED]
    assert table["height"].between(50, 70).all()
    assert table["area"].between(6.5, 7.9).all()
    later = table[table["t"] > 0]
    assert later["outline"].between(9.8, 10.1).all()
    assert later["crossed"].between(3, 6).all()
    assert not table["folded"].any()
    assert (table["outside"] == 0).all()
    assert table.groupby("seed")["height"].agg(np.ptp).max() < 6


def ratios(**values):
    """A table with these basal ratios of 200 cells in each tissue, all others 0.5."""
    rows = []
    for of in isolated.TISSUES:
        for scenario in isolated.SLICES:
            for what in isolated.SIDES:
                value = values.get(scenario, 0.5) if what == "basal" else 0.5
                numbers = {"count": round(200 * value), "of": 200, "effective": 200.0, "runs": 200, "value": value}
                rows.append({"tissue": of, "scenario": scenario, "what": what} | numbers)
    return pd.DataFrame(rows)


def test_a_comparison_has_the_verdict_of_its_interval():
    table = isolated.compared(ratios(**{"[BP]": 0.9, "[A]": 0.5, "[S]": 0.8}))
    verdicts = table.set_index(["compared", "what"])["growing_verdict"]
    assert verdicts["[BP] than [A]", "basal"] == "holds"
    assert verdicts["[A] than [S]", "basal"] == "does not hold"
    assert verdicts["[A] than [S]", "apical"] == "not decided"
    assert table["slice"].iloc[0] == "+40.0 [+31.5, +47.7] points: holds"


def test_sheets_have_the_events_of_the_slices_beside_them():
    mine = load_study(isolated.PLAN).scenarios
    assert {name.rsplit(", ", 1)[1] for name in mine} == {isolated.GROWING, isolated.PERIODIC}
    for scenario, name in isolated.SLICES.items():
        beside = load_study(name).scenarios[scenario]
        for of in (isolated.GROWING, isolated.PERIODIC):
            parameters = mine[f"{scenario}, {of}"]
            here, there = parameters.groups()[1], beside.groups()[0]
            assert here.inm == there.inm
            assert here.times == there.times
            assert parameters.t_end == beside.t_end
            assert parameters.space.boundary == ("periodic" if of == "periodic" else "open")
            assert parameters.tissue.two_daughters == (1 if of == "growing" else beside.tissue.two_daughters)


def test_inner_cells_begin_away_from_the_edge():
    given = load_study(isolated.PLAN).scenarios["[A], growing"]
    first = tissue.simulate(given.changed({"numerics.t_end": "0.05 h", "numerics.keep": "0.05 h"}), 3).frames[0]
    bx, bz = first.cells.bx, first.cells.bz
    far = 3 * given.lattice().spacing
    around = [
        all((side * (axis - axis[i]) > far).any() for axis in (bx, bz) for side in (1, -1))
        for i in np.flatnonzero(first.cells.kind != CONTROL)
    ]
    assert are_inner(given).tolist() == around
    assert sum(around) == 17


def test_cells_that_share_a_fate_count_as_one():
    """Runs of four cells, all hits or none: the design effect is 4 (up to R/(R - 1)), in each row of the tissue."""
    replicate = pd.Series(np.repeat(np.arange(50), 4))
    together, alone = replicate % 2 == 0, pd.Series(np.arange(200) % 2 == 0)
    rows = [counted(together, replicate) | {"of_a": 1}, counted(together & False, replicate) | {"of_a": 1}]
    rows.append(counted(alone, replicate) | {"of_a": 2})
    table = with_intervals(pd.DataFrame(rows), "of_a")
    assert table["effect"].tolist() == pytest.approx([4 * 50 / 49, 4 * 50 / 49, 1.0])
    assert table["value"].tolist() == [0.5, 0.0, 0.5]
    assert table["effective"].tolist() == pytest.approx([49, 49, 200])
    assert (table["low"].iloc[1], table["high"].iloc[1]) == (0.0, pytest.approx(1.96**2 / (49 + 1.96**2), abs=1e-4))
