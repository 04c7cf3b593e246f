"""Position based dynamics in its original, second-order form."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, integer
from dincl.errors import InvalidProblem
from dincl.schemes.base import FixedStep
from dincl.schemes.pbd import MOST_SWEEPS, sweeping

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dincl.problem import Problem
    from dincl.run.stepper import Stepper


@dataclass(frozen=True, eq=False)
class SecondOrderPBD(FixedStep):
    """v~ = v_k + dt F(t_k, x_k), x~ = x_k + dt v~, x_{k+1} = P_{S_M} ... P_{S_1} x~, v_{k+1} = (x_{k+1} - x_k)/dt.

    Method 2.2 for x'' = F(t, x), x in S, with unit masses: the drift of the problem is an acceleration here
    [length / time^2]. Impacts are inelastic. It approximates Newton's equation, not the first-order inclusion that
    the other schemes solve.

    Parameters
    ----------
    dt
        Step [time].
    v0
        Velocity at the start, shape (N, d) [length / time]; None: at rest.
    sweeps
        As in PBD.
    """

    v0: ArrayLike | None = None
    sweeps: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.v0 is not None:
            object.__setattr__(self, "v0", array("v0", self.v0))
        object.__setattr__(self, "sweeps", integer("sweeps", self.sweeps, least=1, most=MOST_SWEEPS))

    def stepper(self, problem: Problem) -> Stepper:
        v0 = np.zeros_like(problem.x0) if self.v0 is None else np.asarray(self.v0)
        if v0.shape != problem.x0.shape:
            raise InvalidProblem(f"v0 of shape {v0.shape}: must have the shape of x0, {problem.x0.shape}")
        return sweeping(problem, self.sweeps, v0)
