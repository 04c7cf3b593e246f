"""Outcomes of EMT cells: the rows that a study stores of each run."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from dincl.compiled.lanes import WIDTH
from dincl.status import Status
from tissue.events.known import OF_THESIS, acting, events
from tissue.files.parameters import Parameters
from tissue.frames.frame import Frame
from tissue.model.extents import measure_extents
from tissue.model.scale import measure
from tissue.plugins import Observable, registered
from tissue.runs.batch import Batch
from tissue.state.cells import Flags, Floats, Integers
from tissue.state.running import CELLS, TissueState

if TYPE_CHECKING:
    import pandas as pd

SIDES = ("basal", "no", "apical")
# What ``scale.measure`` says of the control cells.
CONTROLS = ("controls", "controls_apical", "controls_basal")
# What ``measure_extents`` says of the tissue, in um.
EXTENTS = ("height_um", "nucleus_height_um", "apical_width_um", "basal_width_um", "nuclei_width_um")


class Outcomes(NamedTuple):
    """Tables of some replicates of one scenario."""

    cells: pa.Table  # one row for each EMT cell of the start of each run that did not fail
    runs: pa.Table  # one row for each run
    tables: dict[int, pd.DataFrame]  # of all cells at all output times, for the replicates asked for


class _Measured(NamedTuple):
    """Measurements of a batch at its output times."""

    times: list[float]
    positions: Floats  # (times, runs, m): y_AB
    controls: Floats  # (times, runs, 4)
    extents: Floats  # (times, runs, 5) [R_soft]
    own: Floats  # (times, runs, k): the observables that were registered


def outcomes(
    parameters: Parameters,
    replicates: Sequence[int],
    seeds: Sequence[int],
    whole: Collection[int] = (),
    ask: Callable[[], None] | None = None,
) -> Outcomes:
    """Simulate, and measure the EMT cells.

    Parameters
    ----------
    parameters
        Of all replicates.
    replicates, seeds
        The number of each replicate, and its seed; a multiple of eight is simulated at the least cost for each.
    whole
        The replicates whose cells are all wanted, at all output times.
    ask
        Called every now and then, about ten times a second; what it raises ends the work.

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
        _batch(parameters, replicates[begin : begin + WIDTH], seeds[begin : begin + WIDTH], whole, ask)
        for begin in range(0, len(seeds), WIDTH)
    ]
    tables = {name: table for part in parts for name, table in part.tables.items()}
    return Outcomes(pa.concat_tables(p.cells for p in parts), pa.concat_tables(p.runs for p in parts), tables)


def _batch(
    parameters: Parameters,
    replicates: Sequence[int],
    seeds: Sequence[int],
    whole: Collection[int],
    ask: Callable[[], None] | None,
) -> Outcomes:
    batch = Batch(parameters, seeds)
    wanted: dict[int, list[Frame]] = {k: [] for k, name in enumerate(replicates) if name in whole}
    times, measured = [], []
    for t in batch.times(ask):
        times.append(t)
        measured.append((*_measured(batch), _own(batch, t)))
        for k, frames in wanted.items():
            frames.append(batch.frame(k, t))
    series = _Measured(times, *(np.array(parts) for parts in zip(*measured, strict=True)))
    sound = np.array([batch.goes_on(k) for k in range(len(seeds))]) & np.isfinite(series.positions).all(axis=(0, 2))
    tables = {replicates[k]: batch.run(k, frames).table() for k, frames in wanted.items()}
    return Outcomes(_cells(batch, replicates, series, sound), _runs(batch, replicates, series, sound), tables)


def _followed(batch: Batch) -> int:
    """Return the number of EMT cells of the start: they come before their daughters in ``Emt``."""
    return sum(group.scenario.cells for group in batch.parameters.groups() if group.may_leave)


def _measured(batch: Batch) -> tuple[Floats, Floats, Floats]:
    n, m = len(batch.seeds), _followed(batch)
    positions = np.zeros((n, m))
    controls, extents = np.full((n, 4), np.nan), np.full((n, len(EXTENTS)), np.nan)
    for k in filter(batch.goes_on, range(n)):
        held = batch.state(k)
        of_all = np.zeros(len(held.emt.side))
        measure(held, of_all, controls[k])
        measure_extents(held, extents[k])
        positions[k] = of_all[:m]
    return positions, controls, extents


def _own(batch: Batch, t: float) -> Floats:
    """Return the observables that were registered, of each run; NaN for one that failed."""
    shown = registered(Observable)
    found = np.full((len(batch.seeds), len(shown)), np.nan)
    for k in filter(batch.goes_on, range(len(batch.seeds)) if shown else ()):
        frame = batch.frame(k, t)
        found[k] = [one.of(frame, batch.parameters) for one in shown]
    return found


def _cells(batch: Batch, replicates: Sequence[int], series: _Measured, sound: Flags) -> pa.Table:
    """Return one row for each EMT cell of the start of the sound runs."""
    kept = np.flatnonzero(sound)
    states, m = [batch.state(int(k)) for k in kept], _followed(batch)
    side, onset, since, since_x = (
        np.array([getattr(held.emt, name)[:m] for held in states]).ravel()
        for name in ("side", "onset_ab", "since", "since_x")
    )
    at = np.array([held.emt.at[:, :m] for held in states]).reshape(len(states), len(events()), m)
    began = {events()[k].name: at[:, k].ravel() for k in acting()}
    times = [group.scenario.times for group in batch.parameters.groups()]
    shown = {*OF_THESIS, *(name for one in times for name, timing in one.items() if timing.ever)}
    mine = [_by_number(held)[:m] for held in states]
    inm, kinds = (
        [getattr(held.cells, name)[of] for held, of in zip(states, mine, strict=True)] for name in ("moves", "kind")
    )
    scale = batch.parameters.cell.soft_radius.value
    columns: dict[str, Any] = {
        "replicate": np.repeat(np.array(replicates, np.int64)[kept], m),
        "cell": np.tile(np.arange(m), len(kept)),
        "inm": np.array(inm, np.bool_).ravel(),
        **(_types(batch, np.array(kinds, np.int8)) if batch.parameters.types.named() else {}),
        **{f"t_{name}_h": times for name, times in began.items() if name in shown},
        "onset_h": np.minimum.reduce(list(began.values())),
        "onset_ab": pa.array(onset, mask=np.isinf(onset)),
        "extruded": pa.DictionaryArray.from_arrays((side + 1).astype(np.int8), list(SIDES)),
        "extruded_h": pa.array(since, mask=side == 0),
        "extruded_x_um": pa.array(scale * since_x, mask=side == 0),
    }
    for t, positions, controls, *_ in zip(*series, strict=True):
        columns[f"ab_{t:g}h"] = positions[kept].ravel()
        columns[f"below_{t:g}h"] = (positions <= controls[:, 3:])[kept].ravel()
    return pa.table(columns)


def _by_number(held: TissueState) -> Integers:
    """Return the EMT cells of a tissue in the order of their numbers."""
    number = held.cells.emt[: held.sizes[CELLS]]
    found = np.flatnonzero(number >= 0)
    return found[np.argsort(number[found])]


def _types(batch: Batch, kinds: NDArray[np.int8]) -> dict[str, Any]:
    """Return the type of each EMT cell, where there are named ones."""
    return {"type": pa.DictionaryArray.from_arrays(kinds.ravel(), list(batch.parameters.type_names))}


def _runs(batch: Batch, replicates: Sequence[int], series: _Measured, sound: Flags) -> pa.Table:
    """Return one row for each run; what was not measured, because it had failed, is null."""
    n, scale = len(replicates), batch.parameters.cell.soft_radius.value
    detail = [batch.failure(k) or ("" if sound[k] else "y_AB could not be measured") for k in range(n)]
    states = [Status.NON_FINITE, Status.SUCCESS, Status.LUMEN_CLOSED, Status.NETWORK_TORN, Status.UNSTABLE]
    ended = [batch.status(k) if sound[k] or not batch.goes_on(k) else Status.NON_FINITE for k in range(n)]
    columns: dict[str, Any] = {
        "replicate": np.array(replicates, np.int64),
        "seed": np.array(batch.seeds, np.int64),
        "status": pa.DictionaryArray.from_arrays(
            np.array([states.index(one) for one in ended], np.int8), [state.name for state in states]
        ),
        "detail": detail,
    }
    for t, _, controls, extents, own in zip(*series, strict=True):
        for place, name in enumerate(CONTROLS):
            counts = controls[:n, place]
            columns[f"{name}_{t:g}h"] = pa.array(counts, mask=np.isnan(counts), type=pa.float64()).cast(pa.int64())
        for place, name in enumerate(EXTENTS):
            lengths = scale * extents[:n, place]
            columns[f"{name}_{t:g}h"] = pa.array(lengths, mask=np.isnan(lengths))
        for one, values in zip(registered(Observable), own[:n].T, strict=True):
            columns[f"{one.column}_{t:g}h"] = pa.array(values, mask=np.isnan(values))
    return pa.table(columns)
