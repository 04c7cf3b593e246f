"""How a run or a projection ended, and what to try when it ended badly."""

from __future__ import annotations

from enum import Enum


class Status(Enum):
    """The outcome; ``value`` is the sentence for a reader, with the remedy."""

    SUCCESS = "The run reached its last time."
    STOPPED = "The function until changed its sign, and the run ended there."
    NOT_CONVERGED = (
        "The projection, an iteration or the estimated error did not reach its tolerance: use a smaller dt, a looser "
        "tol, fewer points or another projection."
    )
    INFEASIBLE = (
        "The set to project onto is empty: use a smaller dt, or check that the constraints can be met together."
    )
    NON_FINITE = (
        "A force, an energy or the state left the finite numbers: use a smaller dt or strength of the penalty, "
        "bound the forces, or end the run earlier."
    )
    DRIFT_FAILED = (
        "The drift could not be evaluated: it must return finite numbers of shape (N, d) at every state it meets; "
        "correct it, or use a smaller dt."
    )
    CONSTRAINT_FAILED = (
        "A constraint could not be evaluated: g, its jacobian and the path of a moving set must return finite numbers."
    )
    FUNCTION_FAILED = (
        "A function given by the user could not be evaluated: it must return finite numbers of its shape where it is "
        "called."
    )
    CROWDED = "Particles lie on top of each other in such numbers that their pairs cannot be listed: use a smaller dt."
    COINCIDENT_CENTRES = "Two centres coincide, so no direction separates them: use a smaller dt."

    LUMEN_CLOSED = (
        "The lumen of a tube closed: its apical points met. End the run earlier, or use a longer basal layer, lower or "
        "fewer cells."
    )
    FOLDED = (
        "The apical layer is folded, so that heights and positions mean nothing: end the run earlier, or let cells "
        "divide less often; numerics.folded says whether such runs go on."
    )
    NETWORK_TORN = (
        "A layer of cells in space has no network of neighbours any more: let fewer cells leave or divide at once, or "
        "end the run earlier."
    )
    UNSTABLE = (
        "The steps are too long for the stiffness, so that points swing or jump from step to step and measurements "
        "mean nothing: use more substeps or a smaller dt, or softer springs and forces."
    )
    SINGULAR = (
        "dg/dX lost its full rank (5.5), so that y no longer determines the particles: start elsewhere, or end the run "
        "earlier."
    )
    STEP_TOO_SMALL = (
        "The step needed for the tolerance fell below the spacing of numbers, as near a singularity: use a looser tol, "
        "or end the run earlier."
    )
    TOO_MANY_STEPS = "The run needs more steps than allowed: use a looser tol, softer springs or a shorter run."
    LEFT_GRID = "The density reached the boundary of the grid: give wider bounds."

    def __bool__(self) -> bool:
        return self in (Status.SUCCESS, Status.STOPPED)
