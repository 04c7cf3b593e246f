"""The tables of a run: columns and kinds that stay, values that are those of the frames, lengths in um."""

import inspect
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from dincl.status import Status
from tissue.events.known import EVENTS, bit, events
from tissue.files.parameters import preset
from tissue.frames.observables import PHASES, height, nuclear_layers, phases
from tissue.runs.run import Run
from tissue.runs.simulate import simulate
from tissue.runs.tables import DEPTH_LENGTHS, cell_table, summary_table

CELL_KINDS = {
    "time_h": "float64",
    "id": "int64",
    "mother": "int64",
    "phase": "category",
    "age_h": "float64",
    "cycle_h": "float64",
    "nucleus_x_um": "float64",
    "nucleus_y_um": "float64",
    "apical_x_um": "float64",
    "apical_y_um": "float64",
    "basal_x_um": "float64",
    "basal_y_um": "float64",
    "hard_radius_um": "float64",
    "apical_rest_um": "float64",
    "basal_rest_um": "float64",
    "junction_rest_um": "float64",
    "y_ab": "float64",
    "in_apical_layer": "bool",
    "in_basal_layer": "bool",
    "migrates": "bool",
    "divides": "bool",
    "emt": "int64",
    "events": "str",
    "type": "str",
}
SUMMARY_KINDS = {
    "time_h": "float64",
    "cells": "int64",
    "divisions": "int64",
    "height_um": "float64",
    "nucleus_height_um": "float64",
    "apical_width_um": "float64",
    "basal_width_um": "float64",
    "nuclei_width_um": "float64",
    "nuclear_layers": "float64",
    "mean_y_ab": "float64",
    "apically_extruded": "int64",
    "basally_extruded": "int64",
}
TUBE_KINDS = SUMMARY_KINDS | {"lumen_area_um2": "float64", "tissue_area_um2": "float64"}


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


def test_columns_and_their_kinds(run):
    assert kinds(run.table()) == CELL_KINDS
    assert kinds(run.summary()) == SUMMARY_KINDS
    assert list(run.table()) == list(CELL_KINDS)
    assert list(run.summary()) == list(SUMMARY_KINDS)
    tube = grown(**{"layer.shape": "circle", "layer.closed": True, "layer.side": "outside", "tissue.cells": 190})
    assert kinds(tube.summary()) == TUBE_KINDS


@pytest.mark.parametrize(("table", "expected"), [(cell_table, CELL_KINDS), (summary_table, TUBE_KINDS)])
def test_every_column_is_described(table, expected):
    text = inspect.getdoc(table)
    described = [line for line in text.splitlines() if line.startswith("``")]
    in_space = {name for name in DEPTH_LENGTHS if table is cell_table}
    described = [line for line in described if not in_space & {*line.split("  ")[0].replace("`", "").split(", ")}]
    found = [name.strip("`") for line in described for name in line.split("  ")[0].split(", ")]
    assert found == list(expected)
    for line in described:
        names, kind = line.split("  ")[0], line[56:].split()[0]
        assert {expected[name.strip("`")] for name in names.split(", ")} == {kind}


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


def test_phases_are_ordered_and_all_known_even_where_one_is_missing():
    table = grown(**{"tissue.cells": 1, "numerics.t_end": "0.1 h", "numerics.keep": "0.1 h"}).table()
    assert table["phase"].cat.categories.tolist() == list(PHASES)
    assert table["phase"].cat.ordered
    assert len(table) == 2


def changed(run, **arrays):
    """The run with just its last state, some arrays of its cells with other values by place."""
    cells = run.final.cells
    copies = {name: getattr(cells, name).copy() for name in arrays}
    for name, values in arrays.items():
        for place, value in values.items():
            copies[name][place] = value
    return replace(run, frames=(run.final._replace(cells=cells._replace(**copies)),))


def test_layers_and_rules_are_flags(run):
    apical = run.final.layers.apical[3:-1]
    (final,) = changed(run, moves={5: False}, divides={6: False, 7: False}).frames
    table = replace(run, frames=(final._replace(layers=final.layers._replace(apical=apical)),)).table()
    places = {name: np.flatnonzero(~table[name]).tolist() for name, kind in CELL_KINDS.items() if kind == "bool"}
    last = len(table) - 1
    assert places == {"in_apical_layer": [0, 1, 2, last], "in_basal_layer": [], "migrates": [5], "divides": [6, 7]}


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
    assert summary["nuclear_layers"].tolist() == [nuclear_layers(frame) for frame in run.frames]


def test_divisions_are_counted_as_the_kernel_does(run):
    divisions = run.summary()["divisions"]
    assert divisions.iloc[0] == 0
    assert divisions.iloc[-1] == run.stats["divisions"] > 0
    assert (run.summary()["cells"] - divisions == 60).all()


def test_daughters_name_their_mother(run):
    table = run.table()
    daughters = table[table["mother"] >= 0]
    assert len(daughters)
    assert set(daughters["mother"]) <= set(table["id"])
    assert (daughters["mother"] < daughters["id"]).all()


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


def test_events_are_named_in_one_order_and_control_cells_have_none():
    """[P] at 3 h waits for [B] at 4 h; cells of the group count from left to right."""
    events = {"emt.cells": 3, "emt.a": "3 h", "emt.b": "4 h", "emt.p": "3 h", "emt.s": "5 h"}
    table = grown(**events, **{"numerics.t_end": "5 h", "numerics.keep": "1 h"}).table()
    group = table[table["emt"] >= 0]
    assert group.groupby("time_h")["emt"].agg(list).tolist() == [[0, 1, 2]] * 6
    assert group.groupby("time_h")["events"].agg(set).tolist() == [{""}, {""}, {""}, {"A"}, {"ABP"}, {"ABSP"}]
    assert (table.loc[table["emt"] < 0, "emt"] == -1).all()
    assert set(table.loc[table["emt"] < 0, "events"]) == {""}


def test_every_set_of_events_has_its_name():
    sets = ("", "a", "b", "as", "bp", "absp")
    assert [EVENTS[sum(map(bit, names))] for names in sets] == [names.upper() for names in sets]
    assert [bit(name) for name in "absp"] == [1, 2, 4, 8]
    assert len(set(EVENTS)) == len(EVENTS) == 2 ** len(events())
