"""What a run hands back: the kept states, how it ended, and what it knows about the times between them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.errors import StepFailure
    from dincl.status import Status
    from dincl.work import Work


class Event(NamedTuple):
    """A change of the contacts.

    Attributes
    ----------
    t
        When [time].
    kind
        "contact": a gap closes; "release": a multiplier reaches zero and the gap opens.
    constraint
        Index into the constraints of the problem.
    row
        The row of that constraint in words, e.g. "particle 3 and 1".
    """

    t: float
    kind: str
    constraint: int
    row: str


class Between(ABC):
    """What a run knows about the times between those that it keeps."""

    @abstractmethod
    def states(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """x at increasing times (K,) within the run, shape (K, N, d)."""

    @abstractmethod
    def residuals(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """dist(x' - F, -N^g) at the kept times, shape (K,); infinite where it is not defined."""


@dataclass(frozen=True, eq=False)
class RunOutcome:
    """The solution at the kept times, without the problem and the scheme that it belongs to; see ``Trajectory``.

    Attributes
    ----------
    t, x
        Kept times (K,), K >= 1, and states (K, N, d); after a failure those reached, and last the last state.
    status, detail
        How the run ended, and the particulars in words ("" on success).
    stats
        The counted work.
    between
        The states between the kept times, and the residuals.
    events, error
        As in ``Trajectory``.
    failure
        What ended the run early, for the error that solve raises.
    """

    t: NDArray[np.float64]
    x: NDArray[np.float64]
    status: Status
    detail: str
    stats: Work
    between: Between
    events: tuple[Event, ...] = ()
    error: NDArray[np.float64] | None = None
    failure: StepFailure | None = None
