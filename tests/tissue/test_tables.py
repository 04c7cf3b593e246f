"""What a run shows: tables, their columns with meanings and units, a picture, a page; and files of other programs."""

import json
import pickle
import re
from base64 import b64decode
from dataclasses import replace

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from matplotlib.figure import Figure
from PIL import Image

import tissue
from dincl.errors import InvalidProblem
from dincl.status import Status
from docs.building.lists import PAGES
from tests.optional import need_module
from tests.tissue.space.in_space import of_surface
from tests.tissue.users import shelves
from tissue.files.parameters import preset
from tissue.frames.observables import PHASES, extents, height, phases
from tissue.runs.columns import TABLES, dictionary, facts
from tissue.runs.run import Run, RunFailed
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
    failed = Run(run.parameters, 4, (*run.frames, broken), Status.NON_FINITE, "t = 11 h", run.stats, "")
    pd.testing.assert_frame_equal(failed.table(), run.table())
    pd.testing.assert_frame_equal(failed.summary(), run.summary())


# Picture, movie, a page in a notebook; pickles, also from a failure


def title(panel):
    return panel.texts[0].get_text()


def failed(run):
    """The run with a last state that is not finite."""
    cells = run.final.cells
    lost = run.final._replace(cells=cells._replace(x=np.full(len(cells.x), np.nan)))
    return replace(run, frames=(*run.frames[:-1], lost), status=Status.NON_FINITE, detail="t = 10 h: <lost>.")


def test_a_plot_has_a_legend_or_goes_into_axes_of_the_user_and_leaves_the_others_alone(run):
    panel = run.plot()
    assert title(panel).startswith(f"t = 10 h · {len(run.final.cells.x)} cells")
    assert len(panel.figure.legends) == 1
    with pytest.raises(InvalidProblem, match=r"t = 0\.7 h: must be an output time: 0, 2, 4, 6, 8, 10"):
        run.plot(t=0.7)
    mine, other = Figure(figsize=(4.0, 4.0)).subplots(1, 2)
    assert run.plot(mine, t=2.0) is mine
    assert title(mine).startswith("t = 2 h")
    assert mine.collections[0].get_offsets().shape == (len(run.frames[1].cells.x), 2)
    assert other.has_data() is False
    assert not mine.figure.legends


def test_of_a_failed_run_the_last_finite_state_is_shown(run, tmp_path):
    bad = failed(run)
    assert title(bad.plot()).startswith("t = 8 h")
    with pytest.raises(InvalidProblem, match="t = 10 h: must have finite coordinates"):
        bad.plot(t=10.0)
    bad.animate(tmp_path / "run.gif")
    with Image.open(tmp_path / "run.gif") as movie:
        assert movie.n_frames == 5


def test_a_page_says_how_it_ended_with_picture_and_summary(run):
    page = failed(run)._repr_html_()
    assert "Run(NON_FINITE, t = 10 h" in page
    assert "&lt;lost&gt;" in page
    assert b64decode(page.partition("base64,")[2].partition('"')[0]).startswith(b"RIFF")
    assert page.count("<tr>") == 5  # states below the head, which has a style
    assert "<th>0</th>" not in page


def test_a_run_pickles(run):
    again = pickle.loads(pickle.dumps(run))
    assert repr(again) == repr(run)
    assert again.parameters == run.parameters
    pd.testing.assert_frame_equal(again.table(), run.table())


def test_a_failure_pickles_with_its_run(run):
    again = pickle.loads(pickle.dumps(RunFailed(failed(run))))
    assert str(again) == str(RunFailed(failed(run)))
    assert again.run.status is Status.NON_FINITE


# Columns with unit and meaning wherever they go, and other libraries that open them

GROWING = {"numerics.t_end": "12 h", "numerics.keep": "6 h", "emt.cells": 3, "emt.a": "2 h", "numerics.dt": "0.1 h"}
STUDY = """title = "small"
base = "published"
replicates = 2
seed = 7
overrides = {numerics = {t_end = "2 h"}, emt = {cells = 2}, tissue = {cells = 20}}
[scenarios.A]
emt.a = "1 h"
[scenarios.no]
"""


@pytest.fixture(scope="module")
def slice_run():
    return tissue.simulate(tissue.preset("published").changed(GROWING), seed=3)


@pytest.fixture(scope="module")
def sheet_run():
    return tissue.simulate(of_surface("plane", numerics__t_end="0.2 h", numerics__keep="0.1 h"), 1)


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_lists_of_the_reference_are_up_to_date(path):
    """Else make them again: python -m docs.building.lists."""
    assert path.read_text("utf-8") == PAGES[path]()


def test_each_column_has_a_meaning_and_its_unit(slice_run, sheet_run):
    """Of runs here, of studies below; what users register says its own."""
    for run in (slice_run, sheet_run):
        found = dictionary({"table": run.table(), "summary": run.summary()})
        assert found["meaning"].all()
        named = {"um": "um", "um2": "um^2", "h": "h"}
        assert [named.get(one.rpartition("_")[2], "") for one in found["column"]] == found["unit"].tolist()
    assert facts("runs", "height_um_0.5h") == ("height_um_{t}h", "um", "mean height of the apical layer")
    assert facts("cells", "t_a_h")[1] == "h"
    with shelves():
        tissue.register(tissue.Variable("signal", "of a test", "nM"), tissue.Observable("low", "lowest", least, "um"))
        assert facts("table", "signal_nM") == ("signal_nM", "nM", "of a test")
        assert facts("runs", "low_um_12h") == ("low_um_{t}h", "um", "lowest")


def least(frame, parameters):
    return frame.cells.y.min()


def test_a_study_says_what_its_columns_mean(tmp_path):
    (tmp_path / "study.toml").write_text(STUDY, "utf-8")
    results = tissue.run_study(tmp_path / "study.toml", tmp_path / "out")
    found = pd.read_csv(tmp_path / "out" / "columns.csv", keep_default_na=False)
    assert set(found["table"]) == {"runs", "cells"}
    assert found["meaning"].all()
    for kind in ("runs", "cells"):
        file = next((tmp_path / "out" / kind / "scenario=A").glob("*.parquet"))
        schema = pq.read_schema(file)
        about = {key.decode(): value.decode() for key, value in schema.metadata.items()}
        assert about["seed"] == "7"
        assert about["scenario"] == "A"
        assert about["version"].startswith("dincl-testbed ")
        said = json.loads(about["columns"])
        assert {re.sub(r"_\d+h$", "_{t}h", name) for name in schema.names} == said.keys()
        assert all(one["meaning"] for one in said.values())
    series, wide = results.series("A"), results.runs("A")
    assert series["time_h"].tolist() == [0.0, 1.0, 2.0] * 2
    for t in (0, 1, 2):
        np.testing.assert_array_equal(series.query("time_h == @t")["height_um"], wide[f"height_um_{t}h"])
    assert set(series) == {re.sub(r"_\d+h$", "", one) for one in wide} - {"detail", "folded"} | {"time_h"}


def test_xarray_has_labels_and_units(slice_run, tmp_path):
    need_module("xarray")
    import xarray

    slice_run.to_xarray().to_netcdf(tmp_path / "run.nc", engine="scipy")
    with xarray.open_dataset(tmp_path / "run.nc", engine="scipy") as found:
        table = slice_run.table()
        assert dict(found.sizes) == {"time_h": 3, "id": table["id"].nunique()}
        row = table[table["time_h"] == 6].iloc[4]
        at = found.sel(time_h=6, id=row["id"])
        assert (at["nucleus_y_um"], at["events"], at["in_apical_layer"]) == (row["nucleus_y_um"], row["events"], 1.0)
        assert np.isnan(found["age_h"].sel(time_h=0, id=table["id"].max()))
        assert found["height_um"].values.tolist() == slice_run.summary()["height_um"].tolist()
        assert found["height_um"].attrs == {"units": "um", "long_name": "mean height of the apical layer"}
        assert found.attrs["seed"] == "3"
        assert tissue.preset("published").cell.soft_radius.value == 5.0
        assert "base = " not in found.attrs["parameters"]


def test_networks_are_those_of_the_frames(slice_run, sheet_run):
    found = sheet_run.networks()
    assert [*found] == [*TABLES["networks"]]
    for frame in sheet_run.frames:
        mesh = frame.sheets.apical
        rows = found[(found["time_h"] == frame.t) & (found["layer"] == "apical")]
        np.testing.assert_array_equal(rows[["id", "other_id"]], frame.cells.id[mesh.edges])
        assert rows["rest_um"].to_numpy() == pytest.approx(5.0 * mesh.rest)
    with pytest.raises(InvalidProblem, match="must be of a tissue in three dimensions"):
        slice_run.networks()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["slice_run", "sheet_run"])
def test_vtk_reads_each_file_of_a_series(name, request, tmp_path):
    need_module("pyvista")
    import pyvista

    run = request.getfixturevalue(name)
    run.save_vtk(tmp_path)
    blocks = ["nuclei", "apical", "basal", *(["junctions"] if name == "sheet_run" else [])]
    assert {one.name for one in tmp_path.glob("*.series")} == {f"{block}.vtp.series" for block in blocks}
    for block in blocks:
        series = json.loads((tmp_path / f"{block}.vtp.series").read_text("utf-8"))
        assert series["file-series-version"] == "1.0"
        assert [one["time"] for one in series["files"]] == [frame.t for frame in run.frames]
        last = pyvista.read(tmp_path / series["files"][-1]["name"])
        if block == "nuclei":
            table = run.table().query("time_h == @run.final.t")
            np.testing.assert_array_equal(last["id"], table["id"])
            np.testing.assert_array_equal(last["y_ab"], table["y_ab"])
            assert last.points[:, 1] == pytest.approx(table["nucleus_y_um"].to_numpy(), rel=1e-6, abs=1e-5)
        elif name == "slice_run":
            assert last.n_points == len(getattr(run.final.layers, block))
            assert last.n_cells == last.n_points - 1
        elif block == "junctions":
            assert last["rest"] == pytest.approx(5.0 * run.final.sheets.apical.rest)
