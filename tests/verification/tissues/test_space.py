"""The third dimension: what is measured, what is kept, and what the page says of it."""

import numpy as np
import pandas as pd
import pytest

import tissue
from tissue.frames.section import section
from tissue.state.cells import CONTROL
from tissue.study.plan import load_study
from verification.site.store import shipped
from verification.tissues.space import growth, isolated
from verification.tissues.space import sheet as fitted
from verification.tissues.space.growth import part_that_stays, roughness
from verification.tissues.space.isolated import are_inner, counted, with_intervals

pytestmark = pytest.mark.filterwarnings("ignore:.* never begins")


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


def test_sections_of_a_sheet_that_cannot_spread_keep_their_share_of_the_cells():
    """Over all planes a plane meets 2 N r / L nuclei, so p of ``part_that_stays`` is 1 but for the mean radius r."""
    given = {"tissue.dimension": 3, "tissue.cells": 182, "tissue.two_daughters": 1}
    given |= {"numerics.t_end": "6 h", "numerics.keep": "6 h"}
    frames = tissue.simulate(tissue.preset("published").changed(given), 1).frames
    period, counts = frames[0].sheets.surface.period_z, []
    for frame in frames:
        planes = period * (np.arange(500) + 0.5) / 500
        counts.append(np.mean([len(section(frame, z).cells.x) for z in planes]))
        assert counts[-1] == pytest.approx(2 * frame.cells.radius.sum() / period, rel=0.01)
    first, last = (frame.cells.radius for frame in frames)
    number, radius = len(last) / len(first), last.mean() / first.mean()
    assert number > 1.2
    assert part_that_stays(counts[1] / counts[0] / radius, number) == pytest.approx(1.0, abs=0.06)


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
    for scenario, study in isolated.SLICES.items():
        beside = load_study(study).scenarios[scenario]
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


def test_inner_cells_are_part_of_those_of_the_growing_sheets():
    counts = shipped("space_isolated").pivot(index=["scenario", "what"], columns="tissue", values=["count", "of"])
    assert set(counts["of"]["growing"]) == {4 * 36}
    assert set(counts["of"]["inner"]) == {4 * 17}
    outside = counts["count"]["growing"] - counts["count"]["inner"]
    assert outside.between(0, 4 * 19).all()


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
