"""Runs for other programs: labelled arrays of xarray, networks as tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from dincl.errors import InvalidProblem
from dincl.extras import needs
from dincl.study.record import PACKAGE, version_of
from tissue.frames.observables import measurable
from tissue.runs.columns import facts

if TYPE_CHECKING:
    from tissue.runs.run import Run


def to_xarray(run: Run) -> Any:
    """Return the tables of a run as an ``xarray.Dataset``, see ``Run.to_xarray``."""
    with needs("Run.to_xarray", "data"):
        import xarray
    # A seed may be larger than the numbers of files.
    about = {"version": f"{PACKAGE} {version_of(PACKAGE)}", "seed": str(run.seed), "status": run.status.name}
    about["parameters"] = run.parameters.as_toml()
    cells, summary = run.table(), run.summary()
    flags = dict.fromkeys(cells.select_dtypes("bool"), "float64")
    cells = cells.astype(flags | dict.fromkeys(cells.select_dtypes(exclude=["number", "bool"]), object))
    of_cells, of_times = cells.set_index(["time_h", "id"]).to_xarray(), summary.set_index("time_h").to_xarray()
    found: Any = xarray.merge([of_cells, of_times]).assign_attrs(about)
    for name, values in found.variables.items():
        if values.dtype == object:
            found[name] = found[name].fillna("")
        known = facts("summary" if values.dims == ("time_h",) else "table", str(name))
        found[name].attrs = {"units": known.unit or "1", "long_name": known.meaning}
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
