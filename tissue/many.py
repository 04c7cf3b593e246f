"""Runs of the first-order model for many seeds, eight side by side in the lanes of the vector registers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from dincl.status import Status
from tissue.cells import Integers
from tissue.first_order import failed_at, kept_steps
from tissue.kernels.advance import FULL
from tissue.kernels.batch.advance import advance
from tissue.kernels.batch.board import EMPTY, RUNNING, board_for
from tissue.kernels.batch.group import grouped, grown_group, replicate
from tissue.kernels.lanes import WIDTH
from tissue.kernels.scratch import DIVISIONS
from tissue.kernels.store import Store, contents
from tissue.numbers import Numbers
from tissue.parameters import Parameters
from tissue.run import Frame, Run, RunFailed
from tissue.start import Parted, first_state
from tissue.streams import Streams, streams


def simulate_many(parameters: Parameters, seeds: Iterable[int], *, throw: bool = True) -> tuple[Run, ...]:
    """Grow a tissue for each seed, as ``simulate`` does, in less than half of its time for each.

    A run is a function of (parameters, seed): on one kind of processor the same bits, whatever the other seeds are. It
    equals that of ``simulate`` to rounding, for forces are added in another order; where many cells divide at once such
    differences grow like any disturbance. Of the counted work ``stats`` has what belongs to one run alone.

    Parameters
    ----------
    parameters
        From ``load`` or ``preset``.
    seeds
        Integers >= 0. A last lot of less than eight takes as long as eight.
    throw
        Whether a run that fails raises, and the others are lost; otherwise its Status says so.

    Raises
    ------
    InvalidProblem
        For a bad seed, or for more cells than fit at the start.
    RunFailed
        If coordinates leave the finite numbers; the error carries the Run up to then.
    """
    wanted, runs = list(seeds), []
    for begin in range(0, len(wanted), WIDTH):
        lot = _lot(parameters, wanted[begin : begin + WIDTH])
        for run in lot:
            if throw and not run.status:
                raise RunFailed(run)
        runs += lot
    return tuple(runs)


def _lot(parameters: Parameters, seeds: Sequence[int]) -> list[Run]:
    """The runs of up to WIDTH seeds."""
    numbers, random = parameters.numbers(), [streams(seed) for seed in seeds]
    starts = [first_state(parameters.start_numbers(), numbers, one.start) for one in random]
    ended = np.where(np.arange(WIDTH) < len(seeds), RUNNING, EMPTY)
    frames = [[Frame(0.0, *contents(held))] for held, _ in starts]
    steps = _steps(grouped([held for held, _ in starts]), ended, numbers, random, kept_steps(parameters))
    for step, group in steps:
        for k in range(len(seeds)):
            if ended[k] == RUNNING or frames[k][-1].t < ended[k] * numbers.dt:  # it just failed
                last = step if ended[k] == RUNNING else ended[k]
                frames[k].append(Frame(last * numbers.dt, *contents(replicate(group, k))))
    return [
        _run(parameters, seed, frames[k], replicate(group, k), ended[k] != RUNNING, starts[k][1])
        for k, seed in enumerate(seeds)
    ]


def _steps(
    group: Store, ended: Integers, numbers: Numbers, random: list[Streams], kept: Iterable[int]
) -> Iterator[tuple[int, Store]]:
    """The numbers of steps ``kept`` and the group as it is then, in as many calls as the growth of the arrays takes."""
    everyone = random + random[-1:] * (WIDTH - len(random))
    draws, noise = tuple(one.cycle for one in everyone), tuple(one.noise for one in everyone)
    made, board = 0, board_for(group.cells.x.shape[1])
    for step in kept:
        end = FULL
        while end == FULL:
            made, end = advance(group, board, ended, made, step, numbers, draws, noise)
            if end == FULL:
                group = grown_group(group)
                board = board_for(group.cells.x.shape[1])
        yield step, group


def _run(parameters: Parameters, seed: int, frames: list[Frame], held: Store, failed: bool, parted: Parted) -> Run:
    """The run of one seed, of which ``held`` is the last state."""
    t = frames[-1].t
    steps = round(t / parameters.numerics.dt.value)
    stats = {"substeps": steps * parameters.numerics.substeps, "divisions": int(held.scratch.counts[DIVISIONS])}
    status, detail = (Status.NON_FINITE, failed_at(held, t)) if failed else (Status.SUCCESS, "")
    return Run(parameters, seed, tuple(frames), status, detail, stats, parted)
