"""Runs of the first-order model, stepped by position based dynamics (Method 3.7): one, or many side by side."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any
from warnings import warn

import numpy as np

from dincl.checks import flag, items
from dincl.checks import seed as checked_seed
from dincl.errors import InvalidProblem
from tissue.files.groups import never_begun
from tissue.files.parameters import Parameters
from tissue.frames.frame import Frame
from tissue.kernels.lanes import WIDTH
from tissue.runs.batch import Batch
from tissue.runs.run import Run, RunFailed


def simulate(
    parameters: Parameters,
    seed: int = 0,
    start: Frame | None = None,
    *,
    throw: bool = True,
    watch: Callable[[float], None] | None = None,
) -> Run:
    """Grow a tissue from t = 0, or from a saved state, to ``parameters.t_end``.

    mu dZ/dt in -grad W(Z) - N(S, Z) + noise, with the rules of the cell cycle applied every dt (Method 3.7).

    Parameters
    ----------
    parameters
        From ``load`` or ``preset``.
    seed
        An integer >= 0. The run is a function of (parameters, seed, start): on one kind of processor the same bits.
    start
        A saved state of a run, ``run.final``, one of ``run.frames`` or ``Frame.load(path)``; None: drawn at t = 0. With
        the parameters and the seed of that run it goes on with the bits that it has without a stop; with another seed
        it goes on with the random numbers of this one. Numbers of the parameters may differ, and hold from here on. The
        soft radius, the basal layer and the groups of cells must be those of that run, whose EMT cells keep the times
        of their events. Where there were control cells alone, EMT cells and named types get their places now.
    throw
        Whether a run that fails raises; otherwise its Status says so.
    watch
        Called with the time [h] of each state that is kept after the first.

    Warns
    -----
    UserWarning
        If an event is later than the end, or the apical layer was folded (``Run.folded``).

    Raises
    ------
    InvalidProblem
        For an argument of another kind, a bad seed, a function of the user that cannot be compiled, or for more cells
        than fit at the start; for a ``start`` that is no state of a run or was lost, is later than the end or no whole
        number of steps, has another number of EMT cells or types that the parameters do not have, or is later than the
        time of an event that has not begun.
    RunFailed
        If coordinates leave the finite numbers, a function of the user fails, which is the cause of the error then, or
        the apical layer is folded with numerics.folded = "stop"; the error carries the Run up to then.
    """
    return _simulated(parameters, [seed], [] if start is None else [start], throw, watch)[0]


def simulate_many(
    parameters: Parameters | Sequence[Parameters],
    seeds: Sequence[int],
    start: Frame | None = None,
    *,
    throw: bool = True,
) -> tuple[Run, ...]:
    """Grow a tissue for each seed, as ``simulate`` does, in less than half of its time for each.

    A run is a function of (parameters, seed, start): on one kind of processor the same bits as those of ``simulate``,
    whatever the other seeds are.

    Parameters
    ----------
    parameters
        From ``load`` or ``preset``; or a list of them, one for each seed, with the same dt and output times. Eight
        that differ in numbers alone cost as much as eight seeds; those with other substeps, layers, rules of divisions
        or forces as much as ``simulate``.
    seeds
        A list of integers >= 0. A last lot of two to seven takes as long as eight.
    start
        As of ``simulate``: one saved state for all seeds.
    throw
        Whether a run that fails raises, and the others are lost; otherwise its Status says so.

    Raises
    ------
    InvalidProblem
        As ``simulate``, and for another number of parameters than of seeds, or ones of other output times.
    RunFailed
        As ``simulate``: of the eight runs side by side in which a function of the user fails, all do.
    """
    listed = items("seeds", seeds, (int, np.integer), "a list of integers >= 0")
    wanted = [checked_seed("seeds", seed) for seed in listed]
    return _simulated(parameters, wanted, [] if start is None else [start] * len(wanted), throw)


def _simulated(
    parameters: Parameters | Sequence[Parameters],
    seeds: Sequence[int],
    starts: Sequence[Frame],
    throw: bool,
    watch: Callable[[float], None] | None = None,
) -> tuple[Run, ...]:
    """Make the runs, up to eight side by side; warn of events that never begin, and of folded layers."""
    flag("throw", throw)
    listed = isinstance(parameters, (list, tuple))
    each: Any = parameters if listed else [parameters]
    late = (never_begun(one.groups(), one.t_end) for one in each if isinstance(one, Parameters))
    for line in dict.fromkeys(line for lines in late for line in lines):
        warn(line, UserWarning, stacklevel=3)
    if listed and len(each) != len(seeds):
        raise InvalidProblem(f"parameters = {len(each)} of them: must be one for each of {len(seeds)} seeds")
    runs: list[Run] = []
    for begin in range(0, len(seeds), WIDTH):
        some = slice(begin, begin + WIDTH)
        batch = Batch(each[some] if listed else parameters, seeds[some], starts[some])
        found = batch.runs(watch)
        for run in found:
            if throw and not run.status:
                raise RunFailed(run) from batch.fault
        runs += found
    # Those that stopped say so.
    if folded := [run.folded for run in runs if run.folded and run.status]:
        many = f"{len(folded)} of {len(runs)} runs: " if len(runs) > 1 else ""
        meaning = "the apical layer was folded, so that heights and positions mean nothing"
        warn(f"{many}{meaning}: {folded[0]}", UserWarning, stacklevel=3)
    return tuple(runs)
