"""Outcomes of EMT cells: the rows that a study stores of each run."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from dincl.status import Status
from tissue.events.known import OF_THESIS, acting, events
from tissue.files.parameters import Parameters
from tissue.kernels.lanes import WIDTH
from tissue.plugins import Observable, registered
from tissue.runs.batch import Batch
from tissue.runs.columns import EXTENTS, SHAPE
from tissue.state.cells import Flags, Floats, Integers
from tissue.state.running import CELLS, TissueState

SIDES = ("basal", "no", "apical")
ENDS = (Status.NON_FINITE, Status.SUCCESS, Status.LUMEN_CLOSED, Status.NETWORK_TORN, Status.UNSTABLE, Status.FOLDED)
# How many control cells there are, and how many are outside on each side.
CONTROLS = ("controls", "controls_apical", "controls_basal")


class Outcomes(NamedTuple):
    """Tables of some replicates of one scenario."""

    cells: pa.Table  # one row for each EMT cell of the start of each run that did not fail
    runs: pa.Table  # one row for each run


def outcomes(
    parameters: Parameters,
    replicates: Sequence[int],
    seeds: Sequence[int],
    ask: Callable[[], None] | None = None,
) -> Outcomes:
    """Simulate, and measure the EMT cells.

    Parameters
    ----------
    parameters
        Of all replicates.
    replicates, seeds
        The number of each replicate, and its seed; a multiple of eight is simulated at the least cost for each.
    ask
        Called every now and then, about ten times a second; what it raises ends the work.

    Returns
    -------
    Outcomes
        Rows that depend on (parameters, seed) alone. Lengths are in um, times in h, positions on the apical-basal
        scale; the columns are those of ``tissue.runs.columns``.

    Raises
    ------
    InvalidProblem
        If more cells are to start than fit.
    """
    parts = [
        _batch(parameters, replicates[begin : begin + WIDTH], seeds[begin : begin + WIDTH], ask)
        for begin in range(0, len(seeds), WIDTH)
    ]
    return Outcomes(pa.concat_tables(p.cells for p in parts), pa.concat_tables(p.runs for p in parts))


def emt_count(parameters: Parameters) -> int:
    """Return the number of EMT cells of the start: they come before their daughters in ``Emt``."""
    return sum(group.cells for group in parameters.groups() if group.may_leave)


def _batch(
    parameters: Parameters,
    replicates: Sequence[int],
    seeds: Sequence[int],
    ask: Callable[[], None] | None,
) -> Outcomes:
    batch, n = Batch(parameters, seeds), len(seeds)
    of_cells: dict[str, NDArray[Any]] = {}
    of_runs: dict[str, NDArray[Any]] = {}
    for t in batch.times(ask):
        of_each = [measured(batch, k, t) for k in range(n)]
        positions, beyond, lowest, rows = (np.array(parts) for parts in zip(*of_each, strict=True))
        of_cells[f"ab_{t:g}h"] = positions
        if parameters.curve().ring:
            of_cells[f"beyond_{t:g}h"] = beyond
        of_cells[f"below_{t:g}h"] = positions <= lowest[:, None]
        names = [*CONTROLS, *EXTENTS, *SHAPE, *(one.column for one in registered(Observable))]
        of_runs |= {f"{name}_{t:g}h": column for name, column in zip(names, rows.T, strict=True)}
    sound = np.array([batch.goes_on(k) and not _left_out(batch, k) for k in range(n)])
    for name, array in of_cells.items():
        if name.startswith("ab_"):
            sound &= np.isfinite(array).all(axis=1)
    return Outcomes(_cells(batch, replicates, of_cells, sound), _runs(batch, replicates, of_runs, sound))


def _left_out(batch: Batch, k: int) -> bool:
    """Return whether the apical layer of a run was folded, and the answers go without such runs."""
    return k in batch.folded and batch.parameters.numerics.folded != "keep"


def measured(batch: Batch, k: int, t: float) -> tuple[Floats, Flags, float, Floats]:
    """Return what is measured of a run at the present output time: y_AB of the EMT cells of the start, whether they
    are beyond the apical layer, the lowest y_AB of a control cell, and the numbers of the run.

    NaN for a run that failed; where the apical layer is folded, also for what means nothing, unless it is kept.
    """
    parameters = batch.each[k]
    m, um = emt_count(parameters), parameters.cell.soft_radius.value
    positions, beyond, lowest = np.full(m, np.nan), np.zeros(m, np.bool_), math.nan
    own = np.full(len(shown := registered(Observable)), np.nan)
    if shown and batch.goes_on(k):
        frame = batch.frame(k, t)
        own[:] = [one.of(frame, parameters) for one in shown]
    found = batch.measures[k]
    if found is None:
        return positions, beyond, lowest, np.append(np.full(len(CONTROLS) + len(EXTENTS) + len(SHAPE), np.nan), own)
    where, others = found.positions, found.controls
    extents = um * np.array(found.extents[: len(EXTENTS)])
    controls = np.array([others.sum(), where.apically[others].sum(), where.basally[others].sum()], np.float64)
    if found.fold and parameters.numerics.folded != "keep":
        extents[0] = controls[1:] = math.nan
    else:
        numbers = batch.state(k).cells.emt[: len(where.y_ab)]
        mine = np.flatnonzero((numbers >= 0) & (numbers < m))
        positions[numbers[mine]], beyond[numbers[mine]] = where.y_ab[mine], where.apically[mine]
        lowest = where.y_ab[others].min(initial=np.inf) if others.any() else -math.inf
    return positions, beyond, lowest, np.concatenate((controls, extents, found.shape, own))


def _cells(batch: Batch, replicates: Sequence[int], at_times: Mapping[str, NDArray[Any]], sound: Flags) -> pa.Table:
    """Return one row for each EMT cell of the start of the sound runs."""
    kept = np.flatnonzero(sound)
    states, m = [batch.state(int(k)) for k in kept], emt_count(batch.parameters)
    side, onset, since = (
        np.array([getattr(held.emt, name)[:m] for held in states]).ravel() for name in ("side", "onset_ab", "since")
    )
    at = np.array([held.emt.at[:, :m] for held in states]).reshape(len(states), len(events()), m)
    began = {events()[k].name: at[:, k].ravel() for k in acting()}
    times = [group.times for group in batch.parameters.groups()]
    shown = {*OF_THESIS, *(name for one in times for name, timing in one.items() if timing.ever)}
    mine = [_by_number(held)[:m] for held in states]
    inm, kinds = (
        np.array([getattr(held.cells, name)[of] for held, of in zip(states, mine, strict=True)]).ravel()
        for name in ("moves", "kind")
    )
    columns: dict[str, Any] = {
        "replicate": np.repeat(np.array(replicates, np.int64)[kept], m),
        "cell": np.tile(np.arange(m), len(kept)),
        "inm": inm.astype(np.bool_),
    }
    if batch.parameters.types.named():
        columns["type"] = pa.DictionaryArray.from_arrays(kinds.astype(np.int8), list(batch.parameters.type_names))
    columns |= {
        **{f"t_{name}_h": times for name, times in began.items() if name in shown},
        "onset_h": np.minimum.reduce(list(began.values())),
        "onset_ab": pa.array(onset, mask=np.isinf(onset)),
        "extruded": pa.DictionaryArray.from_arrays((side + 1).astype(np.int8), list(SIDES)),
        "extruded_h": pa.array(since, mask=side == 0),
    }
    return pa.table(columns | {name: array[kept].ravel() for name, array in at_times.items()})


def _by_number(held: TissueState) -> Integers:
    """Return the EMT cells of a tissue in the order of their numbers."""
    number = held.cells.emt[: held.sizes[CELLS]]
    found = np.flatnonzero(number >= 0)
    return found[np.argsort(number[found])]


def _runs(batch: Batch, replicates: Sequence[int], at_times: Mapping[str, NDArray[Any]], sound: Flags) -> pa.Table:
    """Return one row for each run; what was not measured, because it had failed, is null."""
    status, detail, remarks = [], [], []
    for k in range(len(replicates)):
        ended, failure, remark = batch.status(k), batch.failure(k), batch.remark(k) or "no"
        if batch.goes_on(k) and not sound[k]:
            folded = _left_out(batch, k)
            ended = Status.FOLDED if folded else Status.NON_FINITE
            failure = failure or (remark if folded else "y_AB could not be measured")
        status.append(ENDS.index(ended))
        detail.append(failure)
        remarks.append(remark)
    columns: dict[str, Any] = {
        "replicate": np.array(replicates, np.int64),
        "seed": np.array(batch.seeds, np.int64),
        "status": pa.DictionaryArray.from_arrays(np.array(status, np.int8), [one.name for one in ENDS]),
        "detail": detail,
        "folded": remarks,
    }
    for name, array in at_times.items():
        column = pa.array(array, mask=np.isnan(array), type=pa.float64())
        columns[name] = column.cast(pa.int64()) if name.rpartition("_")[0] in CONTROLS else column
    return pa.table(columns)
