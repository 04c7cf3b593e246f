"""The first-order model of growing epithelium, stepped by position based dynamics (Method 3.7)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count, takewhile

from dincl.status import Status
from tissue.files.parameters import Parameters
from tissue.kernels.advance import CROWDED, DONE, FULL, NON_FINITE, advance, find_lost
from tissue.kernels.neighbours import LOST
from tissue.kernels.scratch import COUNTERS
from tissue.kernels.store import CELLS, Store, contents, grown
from tissue.model.frame import Frame
from tissue.model.numbers import Numbers
from tissue.model.streams import Streams, streams
from tissue.run import Run, RunFailed
from tissue.start import started

# Makes the steps ``made`` to ``steps``: the store, how many are made then, how it went, and the particulars in words.
Advance = Callable[[Store, int, int, Numbers, Streams], tuple[Store, int, Status, str]]
STATUS = {DONE: Status.SUCCESS, CROWDED: Status.CROWDED, NON_FINITE: Status.NON_FINITE}


def simulate(
    parameters: Parameters, seed: int = 0, *, throw: bool = True, watch: Callable[[float], None] | None = None
) -> Run:
    """Grow a tissue from t = 0 to ``parameters.t_end``.

    mu dZ/dt in -grad W(Z) - N(S, Z) + noise, with the rules of the cell cycle applied every dt (Method 3.7).

    Parameters
    ----------
    parameters
        From ``load`` or ``preset``.
    seed
        An integer >= 0. The run is a function of (parameters, seed): on one kind of processor the same bits.
    throw
        Whether a run that fails raises; otherwise its Status says so.
    watch
        Called with the time [h] of each state that is kept after the first.

    Raises
    ------
    InvalidProblem
        For a bad seed, or for more cells than fit at the start.
    RunFailed
        If coordinates leave the finite numbers, or cells crowd beyond all bounds; the error carries the Run up to then.
    """
    run = grow(parameters, seed, _advance, watch)
    if throw and not run.status:
        raise RunFailed(run)
    return run


def grow(parameters: Parameters, seed: int, advance: Advance, watch: Callable[[float], None] | None) -> Run:
    """The run whose steps ``advance`` makes; the arguments and the first error are those of ``simulate``."""
    numbers, random = parameters.numbers(), streams(seed)
    held, parted = started(parameters, random)
    frames = [Frame(0.0, *contents(held))]
    made, status, detail = 0, Status.SUCCESS, ""
    for step in kept_steps(parameters):
        held, made, status, detail = advance(held, made, step, numbers, random)
        frames.append(Frame((made + (not status)) * numbers.dt, *contents(held)))
        if watch is not None:
            watch(frames[-1].t)
        if not status:
            break
    stats = dict(zip(COUNTERS, held.scratch.counts.tolist(), strict=True))
    return Run(parameters, seed, tuple(frames), status, detail, stats, parted)


def kept_steps(parameters: Parameters) -> Iterator[int]:
    """The numbers of steps after which a state is kept: every so often or at the times listed, and at the end."""
    dt, keep = parameters.numerics.dt.value, parameters.numerics.keep
    last = round(parameters.t_end / dt)
    times = (time.value for time in keep) if isinstance(keep, tuple) else (keep.value * k for k in count(1))
    yield from takewhile(lambda step: step < last, (round(time / dt) for time in times))
    yield last


def _advance(held: Store, made: int, steps: int, numbers: Numbers, random: Streams) -> tuple[Store, int, Status, str]:
    """The way of the first-order model to make steps."""
    held, made, end = advance_to(held, made, steps, numbers, random)
    return held, made, STATUS[end], "" if end == DONE else failed_at(held, (made + 1) * numbers.dt)


def advance_to(held: Store, made: int, steps: int, numbers: Numbers, random: Streams) -> tuple[Store, int, int]:
    """Make the steps ``made`` to ``steps`` in as many calls as the growth of the arrays takes.

    Returns the store, how many steps are made then, and how it ended: a key of STATUS.
    """
    while True:
        made, end = advance(held, made, steps, numbers, random.cycle, random.noise)
        if end != FULL:
            return held, made, end
        held = grown(held)


def failed_at(held: Store, t: float) -> str:
    """When a run failed, and where, in words."""
    cell = find_lost(held.cells, held.sizes[CELLS])
    if cell >= 0:
        lost = f"cell {held.cells.id[cell]} has a coordinate that is not finite, or beyond {LOST:g} R_soft"
        return f"t = {t:g} h: {lost}."
    return f"t = {t:g} h: {held.sizes[CELLS]} cells lie on top of each other."
