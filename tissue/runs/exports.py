"""Runs for other programs: labelled arrays of xarray, tables of single cells of anndata, networks as tables."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from scipy.sparse import csr_array

from dincl.errors import InvalidProblem
from dincl.extras import needs
from dincl.study.record import PACKAGE, version_of
from tissue.frames.observables import measurable
from tissue.runs.columns import facts
from tissue.runs.tables import cell_table

if TYPE_CHECKING:
    from tissue.frames.frame import Frame
    from tissue.runs.run import Run


def _about(run: Run) -> dict[str, Any]:
    """Return where a run is from; a seed may be larger than the numbers of files."""
    return {
        "version": f"{PACKAGE} {version_of(PACKAGE)}",
        "seed": str(run.seed),
        "status": run.status.name,
        "parameters": run.parameters.as_toml(),
    }


def to_xarray(run: Run) -> Any:
    """Return the tables of a run as an ``xarray.Dataset``, see ``Run.to_xarray``."""
    with needs("Run.to_xarray", "data"):
        import xarray
    cells, summary = run.table(), run.summary()
    flags = dict.fromkeys(cells.select_dtypes("bool"), "float64")
    cells = cells.astype(flags | dict.fromkeys(cells.select_dtypes(["category", "str"]), object))
    of_cells, of_times = cells.set_index(["time_h", "id"]).to_xarray(), summary.set_index("time_h").to_xarray()
    found: Any = xarray.merge([of_cells, of_times]).assign_attrs(_about(run))
    for name, values in found.variables.items():
        if values.dtype == object:
            found[name] = found[name].fillna("")
        known = facts("summary" if values.dims == ("time_h",) else "table", str(name))
        found[name].attrs = {"units": known.unit or "1", "long_name": known.meaning}
    return found


def to_anndata(run: Run, frame: Frame) -> Any:
    """Return one state of a run as an ``anndata.AnnData``, see ``Run.to_anndata``."""
    with needs("Run.to_anndata", "anndata"):
        import anndata
    rows = cell_table([frame], run.parameters).drop(columns="time_h")
    names = pd.Index(rows.pop("id").astype(str).to_numpy(object), dtype=object)
    numbers = rows.select_dtypes("float64")
    of_columns = [facts("table", str(name)) for name in numbers]
    labels = {name: _labels(rows[name]) for name in rows.select_dtypes(["category", "str"])}
    point = [f"nucleus_{axis}_um" for axis in ("xyz" if run.parameters.in_space else "xy")]
    return anndata.AnnData(
        numbers.to_numpy(),
        obs=rows.drop(columns=numbers.columns).assign(**labels).set_index(names),
        var=pd.DataFrame(
            {key: _labels([getattr(one, key) for one in of_columns]) for key in ("unit", "meaning")},
            index=pd.Index(numbers.columns.to_numpy(object), dtype=object),
        ),
        obsm={"spatial": rows[point].to_numpy()},
        obsp=_junctions(run, frame),
        uns={"time_h": frame.t, **_about(run)},
    )


def _labels(texts: Iterable[str]) -> pd.Categorical:
    """Return texts as categories, the one kind of texts that anndata writes with every version of pandas."""
    return pd.Categorical(np.array([*texts], object))


def _junctions(run: Run, frame: Frame) -> dict[str, Any]:
    """Return the networks of a tissue in three dimensions as symmetric matrices of rest lengths and of ones."""
    if frame.sheets is None:
        return {}
    um, n = run.parameters.cell.soft_radius.value, len(frame.cells.x)
    found = {}
    for name, mesh, values in (
        ("apical_rest_um", frame.sheets.apical, um * frame.sheets.apical.rest),
        ("basal_neighbours", frame.sheets.basal, np.ones(len(frame.sheets.basal.edges))),
    ):
        i, j = mesh.edges.T
        found[name] = csr_array((np.tile(values, 2), (np.append(i, j), np.append(j, i))), (n, n))
    return found


def networks(run: Run) -> pd.DataFrame:
    """Return the networks of a tissue in three dimensions as a table, see ``Run.networks``."""
    if not run.parameters.in_space:
        raise InvalidProblem("networks: must be of a tissue in three dimensions; layers of a slice are in its table")
    um, rows = run.parameters.cell.soft_radius.value, []
    for frame in measurable(run.frames):
        for name in ("apical", "basal"):
            mesh: Any = getattr(frame.sheets, name)
            i, j = frame.cells.id[mesh.edges].T
            rest = um * mesh.rest if name == "apical" else np.nan
            rows.append(pd.DataFrame({"time_h": frame.t, "layer": name, "id": i, "other_id": j, "rest_um": rest}))
    return pd.concat(rows, ignore_index=True)
