"""First-order position based dynamics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dincl.checks import integer
from dincl.schemes.base import FixedStep

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.run.stepper import Stepper

# Sweeps that converge are done long before; more of them look like a run that does not end.
MOST_SWEEPS = 1_000_000


@dataclass(frozen=True)
class PBD(FixedStep):
    """x_{k+1} = P_{S_M} ... P_{S_1} (x_k + dt F(t_k, x_k))  (Method 2.3).

    Parameters
    ----------
    dt
        Step [time].
    sweeps
        How often the row of projections is run through in a step; the method has one.

    The S_j come in the order of the problem's constraints and, within one of them, of its rows: for NonOverlap i
    ascending, then j < i ascending; particles, pairs, links of a chain as numbered or given. Each P_{S_j} is exact.
    """

    sweeps: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "sweeps", integer("sweeps", self.sweeps, least=1, most=MOST_SWEEPS))

    def stepper(self, problem: Problem) -> Stepper:
        return sweeping(problem, self.sweeps)


def sweeping(problem: Problem, sweeps: int, v0: NDArray[np.float64] | None = None) -> Stepper:
    """The compiled step, bound to a problem; of second order if there is a velocity at the start."""
    from dincl.steps.stepper import CompiledStepper
    from dincl.steps.sweeping import pbd

    return CompiledStepper.sweeping(problem, pbd, [sweeps], v0=v0)
