"""The first-order model of growing epithelium, stepped by position based dynamics (Method 3.7)."""

from __future__ import annotations

from collections.abc import Callable

from tissue.files.parameters import Parameters
from tissue.lot import Lot
from tissue.run import Run, RunFailed


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
        If coordinates leave the finite numbers; the error carries the Run up to then.
    """
    run = Lot(parameters, [seed]).runs(watch)[0]
    if throw and not run.status:
        raise RunFailed(run)
    return run
