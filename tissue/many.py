"""Runs of the first-order model for many seeds, eight side by side in the lanes of the vector registers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dincl.checks import flag, items
from dincl.checks import seed as checked_seed
from dincl.compiled.lanes import WIDTH
from dincl.errors import InvalidProblem
from tissue.files.parameters import Parameters
from tissue.lot import Lot
from tissue.resume import checkpoint_of
from tissue.run import Run, RunFailed
from tissue.state.frame import A_START, Frame


def simulate_many(
    parameters: Parameters, seeds: Sequence[int], start: Frame | Sequence[Frame] | None = None, *, throw: bool = True
) -> tuple[Run, ...]:
    """Grow a tissue for each seed, as ``simulate`` does, in less than half of its time for each.

    A run is a function of (parameters, seed, start): on one kind of processor the same bits as those of ``simulate``,
    whatever the other seeds are.

    Parameters
    ----------
    parameters
        From ``load`` or ``preset``.
    seeds
        A list of integers >= 0. A last lot of two to seven takes as long as eight.
    start
        As of ``simulate``: one kept state for all seeds, or one for each, all of the same time.
    throw
        Whether a run that fails raises, and the others are lost; otherwise its Status says so.

    Raises
    ------
    InvalidProblem
        As ``simulate``, and for starts of different times or another number than seeds.
    RunFailed
        As ``simulate``: of the eight runs side by side in which a function of the user fails, all do.
    """
    flag("throw", throw)
    listed = items("seeds", seeds, (int, np.integer), "a list of integers >= 0")
    wanted, runs = [checked_seed("seeds", seed) for seed in listed], []
    starts = _for_each(start, len(wanted))
    for begin in range(0, len(wanted), WIDTH):
        part = slice(begin, begin + WIDTH)
        lot = Lot(parameters, wanted[part], starts[part])
        found = lot.runs()
        for run in found:
            if throw and not run.status:
                raise RunFailed(run) from lot.fault
        runs += found
    return tuple(runs)


def _for_each(start: Frame | Sequence[Frame] | None, count: int) -> list[Frame]:
    """The start of each run; none where they begin at t = 0."""
    if start is None or isinstance(start, Frame):
        return [] if start is None else [start] * count
    starts = list(items("start", start, Frame, f"{A_START}, or a list of them"))
    for frame in starts:
        checkpoint_of(frame)
    if len(starts) != count or len({frame.t for frame in starts}) > 1:
        times = ", ".join(f"{frame.t:g}" for frame in starts)
        raise InvalidProblem(
            f"start = {len(starts)} frames at t = {times} h: must be {count}, one for each seed, of one time"
        )
    return starts
