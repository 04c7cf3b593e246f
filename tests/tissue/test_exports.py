"""Data that travels: columns with unit and meaning wherever they go, and other libraries that open them."""

import json
import re
from importlib.util import find_spec

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

import tissue
from dincl.errors import InvalidProblem
from docs.building.lists import PAGES
from tests.optional import need_module
from tests.tissue.space.in_space import of_surface
from tests.tissue.users import shelves
from tissue.runs.columns import TABLES, dictionary, facts

GROWING = {"numerics.t_end": "12 h", "numerics.keep": "6 h", "emt.cells": 3, "emt.a": "2 h", "numerics.dt": "0.1 h"}
STUDY = """title = "small"
base = "published"
replicates = 2
seed = 7
trajectories = [1]
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
    assert set(found["table"]) == {"runs", "cells", "trajectories"}
    assert found["meaning"].all()
    for kind in ("runs", "cells", "trajectories"):
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


@pytest.mark.skipif(find_spec("anndata") is None, reason="the extra anndata is not installed: it needs pandas 2")
@pytest.mark.filterwarnings("ignore")  # of anndata with pandas 3
def test_anndata_has_cells_and_networks(slice_run, sheet_run, tmp_path):
    import anndata

    for name, run in (("slice", slice_run), ("sheet", sheet_run)):
        run.to_anndata().write_h5ad(tmp_path / f"{name}.h5ad")
        found, table = anndata.read_h5ad(tmp_path / f"{name}.h5ad"), run.table()
        table = table[table["time_h"] == run.final.t]
        assert found.obs_names.tolist() == table["id"].astype(str).tolist()
        np.testing.assert_array_equal(found[:, "age_h"].X[:, 0], table["age_h"])
        assert found.var.loc["age_h", "unit"] == "h"
        assert found.obs["events"].tolist() == table["events"].tolist()
        assert found.obsm["spatial"].shape == (len(table), 3 if name == "sheet" else 2)
        assert found.uns["seed"] == str(run.seed)
    edges = sheet_run.networks().query("layer == 'apical' and time_h == @sheet_run.final.t")
    matrix = found.obsp["apical_rest_um"]
    assert matrix.nnz == 2 * len(edges)
    first = edges.iloc[0]
    i, j = (found.obs_names.get_loc(str(first[name])) for name in ("id", "other_id"))
    assert matrix[i, j] == matrix[j, i] == first["rest_um"]
    assert found.obsp["basal_neighbours"].sum() == 2 * len(sheet_run.final.sheets.basal.edges)


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
