"""The first-order model of growing epithelium, stepped by position based dynamics (Method 3.7)."""

from __future__ import annotations

from collections.abc import Callable

from dincl.checks import flag
from tissue.files.parameters import Parameters
from tissue.lot import Lot
from tissue.run import Run, RunFailed
from tissue.state.frame import Frame


def simulate(
    parameters: Parameters,
    seed: int = 0,
    start: Frame | None = None,
    *,
    throw: bool = True,
    watch: Callable[[float], None] | None = None,
) -> Run:
    """Grow a tissue from t = 0, or from a kept state, to ``parameters.t_end``.

    mu dZ/dt in -grad W(Z) - N(S, Z) + noise, with the rules of the cell cycle applied every dt (Method 3.7).

    Parameters
    ----------
    parameters
        From ``load`` or ``preset``.
    seed
        An integer >= 0. The run is a function of (parameters, seed, start): on one kind of processor the same bits.
    start
        A kept state of a run, ``run.final``, one of ``run.frames`` or ``Frame.load(path)``; None: drawn at t = 0. With
        the parameters and the seed of that run it goes on with the bits that it has without a stop; with another seed
        it goes on with the random numbers of this one. Parameters may differ: they hold from here on, and those of the
        state at t = 0 have no effect. What has begun of the EMT stays; what has not, and INM of its cells, is drawn by
        the seed from the parameters. Types are known by their names. Where there were control cells alone, EMT cells
        and named types get their places now.
    throw
        Whether a run that fails raises; otherwise its Status says so.
    watch
        Called with the time [h] of each state that is kept after the first.

    Raises
    ------
    InvalidProblem
        For an argument of another kind, a bad seed, a function of the user that cannot be compiled, or for more cells
        than fit at the start; for a ``start`` that is no state of a run or was lost, is later than the end or no whole
        number of steps, has another number of EMT cells or types that the parameters do not have, or is later than the
        time of an event that has not begun.
    RunFailed
        If coordinates leave the finite numbers, or a function of the user fails, which is the cause of the error then;
        the error carries the Run up to then.
    """
    flag("throw", throw)
    lot = Lot(parameters, [seed], [] if start is None else [start])
    run = lot.runs(watch)[0]
    if throw and not run.status:
        raise RunFailed(run) from lot.fault
    return run
