"""Pictures of single runs, from the stored trajectories."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import InvalidProblem
from tissue.events.known import EVENTS
from tissue.frames.frame import Frame
from tissue.network.triangulation import triangulate
from tissue.pictures.picture import WIDTH, drawing
from tissue.pictures.sheet import Figure
from tissue.runs.tables import DEPTH_LENGTHS, LENGTHS
from tissue.state.cells import CellLayers, Cells, Floats, Integers, empty
from tissue.state.mesh import Mesh, Sheets
from tissue.state.surface import SPHERE

if TYPE_CHECKING:
    import pandas as pd

    from tissue.files.parameters import Parameters
    from tissue.study.read import Results


STILLS, MOST = 3, 2  # states of a run, runs


def examples(results: Results, scenario: str) -> dict[int, pd.DataFrame]:
    """Return stored runs of a scenario, two at most: their tables by replicate."""
    stored = set(results.runs(scenario, ["replicate"])["replicate"])
    kept = [number for number in results.study.trajectories if number in stored]
    return {number: results.trajectory(scenario, number) for number in kept[:MOST]}


def example_figure(tables: Iterable[pd.DataFrame], parameters: Parameters, width: float = WIDTH) -> Figure:
    """Draw a row for each run, from its start to its end."""
    states = []
    for table in tables:
        kept = table["time_h"].unique()
        chosen = np.unique(np.linspace(0, len(kept) - 1, STILLS).round().astype(int))
        states += frames(table, kept[chosen].tolist(), parameters)
    return drawing(states, parameters, width)


def frames(table: pd.DataFrame, times: Sequence[float], parameters: Parameters) -> list[Frame]:
    """Make states of a run from its table, for pictures.

    In three dimensions neighbours are those of Delaunay, states without any are left out, and z = 0, where sections
    are, is at the first EMT cell.

    Parameters
    ----------
    table
        As ``Run.table`` has it.
    times
        Output times [h].
    parameters
        Of the run.
    """
    found = (_frame(table[table["time_h"] == t], t, parameters) for t in times)
    return [frame for frame in found if frame is not None]


def _frame(rows: pd.DataFrame, t: float, parameters: Parameters) -> Frame | None:
    um, types = parameters.cell.soft_radius.value, list(parameters.type_names)
    known = LENGTHS | (DEPTH_LENGTHS if parameters.in_space else {})
    lengths = {name: rows[column].to_numpy() / um for column, name in known.items()}
    others = {"birth": t - rows["age_h"], "cycle": rows["cycle_h"], "id": rows["id"], "emt": rows["emt"]}
    codes = {"events": rows["events"].map(EVENTS.index), "kind": rows["type"].map(types.index)}
    plain = {name: column.to_numpy() for name, column in (others | codes).items()}
    cells: Cells = empty(len(rows))._replace(**lengths, **plain)
    layers = CellLayers(*(np.flatnonzero(rows[f"in_{layer}_layer"]) for layer in CellLayers._fields))
    if not parameters.in_space:
        return Frame(t, cells, layers, parameters.curve())
    surface, emt = parameters.lattice().surface, cells.z[cells.emt >= 0]
    if len(emt) and surface.bends != SPHERE:  # all is the same along z
        cells = cells._replace(z=cells.z - emt[0], az=cells.az - emt[0], bz=cells.bz - emt[0])
    longest, _ = parameters.joining()

    def mesh(layer: Integers, *points: Floats) -> Mesh:
        edges, triangles = triangulate(surface, np.column_stack(points)[layer], longest)
        return Mesh(layer[edges], np.ones(len(edges)), layer[triangles])

    try:
        apical, basal = (
            mesh(layers.apical, cells.ax, cells.ay, cells.az),
            mesh(layers.basal, cells.bx, cells.by, cells.bz),
        )
    except InvalidProblem:
        return None
    return Frame(t, cells, layers, parameters.curve(), sheets=Sheets(surface, apical, basal, longest))
