"""The tables of a run: columns and kinds that stay, values that are those of the frames, lengths in um."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from dincl.status import Status
from tissue.files.parameters import preset
from tissue.frames.observables import PHASES, extents, height, phases
from tissue.runs.columns import TABLES
from tissue.runs.run import Run
from tissue.runs.simulate import simulate
from tissue.runs.tables import DEPTH_LENGTHS


def grown(**changes):
    """Ten hours of the thesis, a state every two."""
    times = {"numerics.t_end": "10 h", "numerics.keep": "2 h"}
    return simulate(preset("thesis").changed(times | changes), seed=4)


@pytest.fixture(scope="module")
def run():
    """A run with divisions."""
    return grown()


def kinds(table):
    return {name: str(kind) for name, kind in table.dtypes.items()}


# The kinds of columns that are not float64.
KINDS = dict.fromkeys(("id", "mother", "emt", "cells", "divisions", "crossings"), "int64")
KINDS |= dict.fromkeys(("apically_extruded", "basally_extruded"), "int64")
KINDS |= dict.fromkeys(("in_apical_layer", "in_basal_layer", "migrates", "divides"), "bool")
KINDS |= dict.fromkeys(("events", "type", "folded"), "str") | {"phase": "category"}


def described(columns):
    """Columns as they are listed, in their order, and their kinds."""
    return {name: KINDS.get(name, "float64") for name in columns}


def test_columns_are_as_described(run):
    """Some of three dimensions, of curved layers and of tubes alone."""
    cells = described(TABLES["table"])
    after = (one for one in TABLES["summary"] if one not in ("time_h", "folded"))
    summary = described(["time_h", "folded", *after])
    bent = {f"{point}_{what}_um" for point in ("nucleus", "apical", "basal") for what in ("height", "along")}
    further, of_tubes = {*DEPTH_LENGTHS, *bent}, {"lumen_area_um2", "tissue_area_um2"}
    tube = grown(**{"layer.shape": "circle", "layer.closed": True, "layer.side": "outside", "tissue.cells": 190})
    assert list(kinds(run.table()).items()) == [one for one in cells.items() if one[0] not in further]
    assert list(kinds(run.summary()).items()) == [one for one in summary.items() if one[0] not in of_tubes]
    assert list(kinds(tube.summary()).items()) == list(summary.items())
    assert kinds(tube.table()) == {name: kind for name, kind in cells.items() if name not in DEPTH_LENGTHS}


def test_rows_are_those_of_the_frames(run):
    table, um = run.table(), 5.0
    assert table["time_h"].unique().tolist() == [frame.t for frame in run.frames]
    for frame in run.frames:
        rows = table[table["time_h"] == frame.t]
        cells = frame.cells
        assert rows["id"].tolist() == cells.id.tolist()
        assert rows["mother"].tolist() == cells.mother.tolist()
        assert rows["age_h"].tolist() == (frame.t - cells.birth).tolist()
        assert rows["cycle_h"].tolist() == cells.cycle.tolist()
        names = ("x", "y", "ax", "ay", "bx", "by", "radius", "rest_ax", "rest_bx", "rest_aa")
        assert (
            um * np.array([getattr(cells, name) for name in names])
            == rows.loc[:, "nucleus_x_um":"junction_rest_um"].to_numpy().T
        ).all()
        assert [PHASES.index(name) for name in rows["phase"]] == phases(frame, run.parameters.numbers()).tolist()


def changed(run, **arrays):
    """The run with just its last state, some arrays of its cells with other values by place."""
    cells = run.final.cells
    copies = {name: getattr(cells, name).copy() for name in arrays}
    for name, values in arrays.items():
        for place, value in values.items():
            copies[name][place] = value
    return replace(run, frames=(run.final._replace(cells=cells._replace(**copies)),))


def test_the_summary_counts_cells_above_below_and_divided(run):
    lonely = dict.fromkeys(range(len(run.final.cells.x)), -1)
    few = changed(run, y={0: 99.0, 1: 99.0, 2: 99.0, 3: -1.0, 4: -1.0}, mother=lonely)
    (row,) = few.summary().to_dict("records")
    assert (row["apically_extruded"], row["basally_extruded"], row["divisions"]) == (3, 2, 0)
    assert changed(few, mother={9: 0, 11: 4}).summary()["divisions"].tolist() == [2]


def test_the_summary_is_that_of_the_rows(run):
    table, summary = run.table(), run.summary()
    groups = table.groupby("time_h")
    assert summary["time_h"].tolist() == [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
    assert summary["cells"].tolist() == groups.size().tolist()
    assert summary["height_um"].tolist() == pytest.approx(groups["apical_y_um"].mean().tolist())
    for name in ("apical", "basal"):
        spread = groups[f"{name}_x_um"].max() - groups[f"{name}_x_um"].min()
        assert summary[f"{name}_width_um"].tolist() == pytest.approx(spread.tolist())
    spread = groups["nucleus_x_um"].max() - groups["nucleus_x_um"].min()
    assert summary["nuclei_width_um"].tolist() == pytest.approx(spread.tolist())
    assert summary["mean_y_ab"].tolist() == pytest.approx(groups["y_ab"].mean().tolist())
    assert summary["apically_extruded"].tolist() == [(part["y_ab"] > 1).sum() for _, part in groups]
    assert summary["basally_extruded"].tolist() == [(part["y_ab"] < 0).sum() for _, part in groups]
    assert summary["nuclear_layers"].tolist() == [extents(frame).nuclear_layers for frame in run.frames]


def test_um_follow_the_soft_radius():
    """The published lengths are all in R_soft: the same run in R_soft, so that lengths in um double with it."""
    small = preset("published").changed({"numerics.t_end": "2 h", "numerics.keep": "1 h"})
    tables = [simulate(small.changed({"cell.soft_radius": radius}), 1) for radius in ("5 um", "10 um")]
    for one, two in ((tables[0].table(), tables[1].table()), (tables[0].summary(), tables[1].summary())):
        for name in one:
            same = 2 * one[name] == two[name] if name.endswith("_um") else one[name] == two[name]
            assert same.all(), name
    assert tables[0].summary()["height_um"].tolist() == [5.0 * height(frame) for frame in tables[0].frames]


def test_a_state_that_is_not_finite_has_no_rows(run):
    broken = run.final._replace(t=11.0, cells=run.final.cells._replace(y=np.full(len(run.final.cells.y), np.nan)))
    failed = Run(run.parameters, 4, (*run.frames, broken), Status.NON_FINITE, "t = 11 h", run.stats, run.separation)
    pd.testing.assert_frame_equal(failed.table(), run.table())
    pd.testing.assert_frame_equal(failed.summary(), run.summary())


def test_tables_come_back_from_files_as_they_were(run, tmp_path):
    for name, table in (("table", run.table()), ("summary", run.summary())):
        table.to_parquet(tmp_path / f"{name}.parquet", index=False)
        pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / f"{name}.parquet"), table)
    run.summary().to_csv(tmp_path / "summary.csv", index=False)
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "summary.csv"), run.summary())
