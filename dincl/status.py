"""How a run or a projection ended, and what to try when it ended badly."""

from __future__ import annotations

from enum import Enum


class Status(Enum):
    """The outcome; ``value`` is the sentence for a reader, with the remedy."""

    SUCCESS = "The run reached its last time."
    NOT_CONVERGED = (
        "The projection, or the estimated error, did not reach its tolerance: use a smaller dt, a looser tol, or "
        "another projection."
    )
    INFEASIBLE = (
        "The set to project onto is empty: use a smaller dt, or check that the constraints can be met together."
    )
    NON_FINITE = "The state left the finite numbers: use a smaller dt, or a smaller strength of the penalty."
    DRIFT_FAILED = (
        "The drift could not be evaluated: it must return finite numbers of shape (N, d) at every state it meets; "
        "correct it, or use a smaller dt."
    )
    CONSTRAINT_FAILED = (
        "A constraint could not be evaluated: g, its jacobian and the path of a moving set must return finite numbers."
    )
    CROWDED = "Particles lie on top of each other in such numbers that their pairs cannot be listed: use a smaller dt."
    COINCIDENT_CENTRES = "Two centres coincide, so no direction separates them: use a smaller dt."

    def __bool__(self) -> bool:
        return self is Status.SUCCESS
