"""How a run ended, and what to try when it ended badly."""

from __future__ import annotations

from enum import Enum


class Status(Enum):
    """The outcome; ``value`` is the sentence for a reader, with the remedy."""

    SUCCESS = "The run reached its last time."
    SINGULAR = (
        "dg/dX lost its full rank (5.5), so that y no longer determines the particles: start elsewhere, or end the run "
        "earlier."
    )
    STEP_TOO_SMALL = (
        "The step needed for the tolerance fell below the spacing of numbers, as near a singularity: use a looser tol, "
        "or end the run earlier."
    )
    TOO_MANY_STEPS = "The run needs more steps than allowed: use a looser tol, softer springs or a shorter run."
    NOT_CONVERGED = "An iteration did not reach its tolerance: use a smaller dt, a looser tol, or fewer points."
    NON_FINITE = "A force, an energy or the state left the finite numbers: end the run earlier, or bound the forces."
    LEFT_GRID = "The density reached the boundary of the grid: give wider bounds."

    def __bool__(self) -> bool:
        return self is Status.SUCCESS
