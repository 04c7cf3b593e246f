"""What becomes of the EMT cells: the rows that a study keeps of each run."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pyarrow as pa

from dincl.status import Status
from tissue.files.parameters import Parameters
from tissue.kernels.batch.board import RUNNING
from tissue.kernels.batch.measure import measure_all
from tissue.kernels.lanes import WIDTH
from tissue.lot import Lot
from tissue.model.cells import Flags, Floats
from tissue.model.frame import Frame

if TYPE_CHECKING:
    import pandas as pd

SIDES = ("basal", "no", "apical")
# What ``scale.measure`` says of the control cells.
CONTROLS = ("controls", "controls_apical", "controls_basal")
# What ``measure_extents`` says of the tissue, in um.
EXTENTS = ("height_um", "nucleus_height_um", "apical_width_um", "basal_width_um", "nuclei_width_um")


class Outcomes(NamedTuple):
    """Tables of some replicates of one scenario."""

    cells: pa.Table  # one row for each EMT cell of each run that did not fail
    runs: pa.Table  # one row for each run
    tables: dict[int, pd.DataFrame]  # of all cells at all kept times, for the replicates asked for


class _Course(NamedTuple):
    """What was measured of a lot at its kept times."""

    times: list[float]
    positions: Floats  # (times, WIDTH, m): y_AB
    controls: Floats  # (times, WIDTH, 4)
    extents: Floats  # (times, WIDTH, 5) [R_soft]


def outcomes(
    parameters: Parameters, replicates: Sequence[int], seeds: Sequence[int], whole: Collection[int] = ()
) -> Outcomes:
    """Simulate, and measure the EMT cells.

    Parameters
    ----------
    parameters
        Of all replicates.
    replicates, seeds
        The number of each replicate, and its seed; a multiple of eight is simulated at the least cost for each.
    whole
        The replicates whose cells are all wanted, at all kept times.

    Returns
    -------
    Outcomes
        Rows that depend on (parameters, seed) alone. Lengths are in um, times in h, positions on the apical-basal
        scale; the columns are those of ``tissue.study.read``.

    Raises
    ------
    InvalidProblem
        If more cells are to start than fit.
    """
    parts = [
        _lot(parameters, replicates[begin : begin + WIDTH], seeds[begin : begin + WIDTH], whole)
        for begin in range(0, len(seeds), WIDTH)
    ]
    tables = {name: table for part in parts for name, table in part.tables.items()}
    return Outcomes(pa.concat_tables(p.cells for p in parts), pa.concat_tables(p.runs for p in parts), tables)


def _lot(parameters: Parameters, replicates: Sequence[int], seeds: Sequence[int], whole: Collection[int]) -> Outcomes:
    lot = Lot(parameters, seeds)
    wanted: dict[int, list[Frame]] = {k: [] for k, name in enumerate(replicates) if name in whole}
    times, measured = [], []
    for t in lot.times():
        times.append(t)
        measured.append(_measured(lot))
        for k, frames in wanted.items():
            frames.append(lot.frame(k, t))
    course = _Course(times, *(np.array(parts) for parts in zip(*measured, strict=True)))
    sound = (lot.ended == RUNNING) & np.isfinite(course.positions).all(axis=(0, 2))
    tables = {replicates[k]: lot.run(k, frames).table() for k, frames in wanted.items()}
    return Outcomes(_cells(lot, replicates, course, sound), _runs(lot, replicates, course, sound), tables)


def _measured(lot: Lot) -> tuple[Floats, Floats, Floats]:
    positions = np.zeros(lot.group.emt.side.shape)
    controls, extents = np.full((WIDTH, 4), np.nan), np.full((WIDTH, len(EXTENTS)), np.nan)
    measure_all(lot.group, lot.ended, positions, controls, extents)
    return positions, controls, extents


def _cells(lot: Lot, replicates: Sequence[int], course: _Course, sound: Flags) -> pa.Table:
    """One row for each EMT cell of the sound runs."""
    kept = np.flatnonzero(sound)
    emt, m = lot.group.emt, lot.group.emt.side.shape[1]
    group = lot.group.cells.emt[kept] >= 0  # in the order of the tissue, which is that of their numbers
    side, onset = emt.side[kept].ravel(), emt.onset_ab[kept].ravel()
    began = [getattr(emt, name)[kept].ravel() for name in ("at_a", "at_b", "at_s", "at_p")]
    scale = lot.parameters.cell.soft_radius.value
    columns: dict[str, Any] = {
        "replicate": np.repeat(np.array(replicates, np.int64)[kept], m),
        "cell": np.tile(np.arange(m), len(kept)),
        "inm": lot.group.cells.moves[kept][group],
        **dict(zip(("t_a_h", "t_b_h", "t_s_h", "t_p_h"), began, strict=True)),
        "onset_h": np.minimum.reduce(began[:3]),
        "onset_ab": pa.array(onset, mask=np.isinf(onset)),
        "extruded": pa.DictionaryArray.from_arrays((side + 1).astype(np.int8), list(SIDES)),
        "extruded_h": pa.array(emt.since[kept].ravel(), mask=side == 0),
        "extruded_x_um": pa.array(scale * emt.since_x[kept].ravel(), mask=side == 0),
    }
    for t, positions, controls, _ in zip(*course, strict=True):
        columns[f"ab_{t:g}h"] = positions[kept].ravel()
        columns[f"below_{t:g}h"] = (positions <= controls[:, 3:])[kept].ravel()
    return pa.table(columns)


def _runs(lot: Lot, replicates: Sequence[int], course: _Course, sound: Flags) -> pa.Table:
    """One row for each run; what was not measured, because it had failed, is null."""
    n, scale = len(replicates), lot.parameters.cell.soft_radius.value
    detail = [lot.failure(k) or ("" if sound[k] else "y_AB could not be measured") for k in range(n)]
    states = [Status.NON_FINITE.name, Status.SUCCESS.name]
    columns: dict[str, Any] = {
        "replicate": np.array(replicates, np.int64),
        "seed": np.array(lot.seeds, np.int64),
        "status": pa.DictionaryArray.from_arrays(sound[:n].astype(np.int8), states),
        "detail": detail,
    }
    for t, _, controls, extents in zip(*course, strict=True):
        for place, name in enumerate(CONTROLS):
            counts = controls[:n, place]
            columns[f"{name}_{t:g}h"] = pa.array(counts, mask=np.isnan(counts), type=pa.float64()).cast(pa.int64())
        for place, name in enumerate(EXTENTS):
            lengths = scale * extents[:n, place]
            columns[f"{name}_{t:g}h"] = pa.array(lengths, mask=np.isnan(lengths))
    return pa.table(columns)
