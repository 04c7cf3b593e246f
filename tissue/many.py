"""Runs of the first-order model for many seeds, eight side by side in the lanes of the vector registers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from tissue.files.parameters import Parameters
from tissue.kernels.lanes import WIDTH
from tissue.lot import Lot
from tissue.model.frame import Frame
from tissue.run import Run, RunFailed


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
        lot = _runs(parameters, wanted[begin : begin + WIDTH])
        for run in lot:
            if throw and not run.status:
                raise RunFailed(run)
        runs += lot
    return tuple(runs)


def _runs(parameters: Parameters, seeds: Sequence[int]) -> list[Run]:
    """The runs of up to WIDTH seeds."""
    lot = Lot(parameters, seeds)
    frames: list[list[Frame]] = [[] for _ in seeds]
    for t in lot.times():
        for k, mine in enumerate(frames):
            frame = lot.frame(k, t)
            if not mine or mine[-1].t < frame.t:  # a run that has failed stays where it is
                mine.append(frame)
    return [lot.run(k, mine) for k, mine in enumerate(frames)]
