"""How the functions of time of a problem change until the end of a run: the sets, and the drift at x0."""

from __future__ import annotations

from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from dincl.drifts import compiled
from dincl.errors import StepFailure
from dincl.system.kinks import CUT, NO_KINKS, common_pieces, kinks_and_pieces, pieces_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from dincl.constraints.moving import Path
    from dincl.problem import Problem

# A drift that has the same value at x0 at so many times does not depend on time.
LOOKS = 61
# Around a singularity pieces become shorter and shorter; so small a part of the run no equal steps need resolve.
NEGLECTED = 1e-3


class TimeScales(NamedTuple):
    """Kinks (K, 2) of sets and pieces (P, 2), see ``kinks_and_pieces``; ``failure`` says why there are none, if so.

    ``evaluations`` of the drift were made to find them.
    """

    kinks: NDArray[np.float64]
    pieces: NDArray[np.float64]
    failure: StepFailure | None
    evaluations: int

    @property
    def shortest(self) -> float:
        """The step that resolves all but a small part of the run [time]; infinite if nothing depends on time."""
        if not len(self.pieces):
            return np.inf
        order = self.pieces[:, 1].argsort()
        passed = np.diff(self.pieces[:, 0], prepend=0.0)[order].cumsum()
        return float(self.pieces[order, 1][passed > NEGLECTED * self.pieces[-1, 0]].min())


def time_scales(problem: Problem, end: float) -> TimeScales:
    """Find kinks of sets, and how long steps may be that resolve all functions of time until ``end``.

    A function that fails, perhaps later than the run ends, is left out. Jumps of the drift are no kinks: a run finds
    them on its way.
    """
    kinks, pieces, failure = NO_KINKS, NO_KINKS, None
    try:
        kinks, pieces = kinks_and_pieces(list(_paths(problem)), end)
    except StepFailure as found:
        failure = found
    drift, evaluations = compiled(problem.drift), 0
    if drift is not None and drift.autonomous:
        return TimeScales(kinks, pieces, failure, 0)

    def at_start(t: float) -> NDArray[np.float64]:
        nonlocal evaluations
        evaluations += 1
        return problem.velocity(t, problem.x0).ravel()

    with suppress(StepFailure):  # a run that gets so far says why
        first = at_start(0.0)
        if any((at_start((k + CUT) / LOOKS * end) != first).any() for k in range(LOOKS)):
            pieces = common_pieces([pieces, pieces_of(at_start, end)])
    return TimeScales(kinks, pieces, failure, evaluations)


def _paths(problem: Problem) -> Iterator[Path]:
    """Give the displacement of each set that is translated, and the numbers of each other one that depends on time."""
    d = problem.x0.shape[1]
    for one in problem.constraints:
        if one.timed:
            found: Any = partial(one.parameters, x=problem.x0)
            yield found if one.displacement(0.0, d) is None else cast(Any, partial(one.displacement, d=d))
