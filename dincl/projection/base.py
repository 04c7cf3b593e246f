"""What a projection is, and the certificate that it must earn."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from dincl.checks import describe, number
from dincl.errors import InvalidProblem, StepFailure
from dincl.matrices import combined
from dincl.rows.affine import linearised
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.rows.affine import AffineRows
    from dincl.rows.base import Rows
    from dincl.system.compiled_problem import CompiledProblem

# A point that violates by less than this part of the tolerance is its own nearest point, which its certificate says.
NEGLIGIBLE = 1e-3
# Completions on the active rows; on curved rows each shortens the error by about multiplier / distance.
MOST_COMPLETIONS = 20

# Weight of the step from the multipliers given, relative to the rows: makes redundant rows solvable.
DAMPING = 1e-7
# Each step shortens the error by DAMPING over the least eigenvalue of A A^T that is not zero.
STEPS = 6

# The name in a result that needed no back end: the point was feasible.
NO_BACK_END = "none"


@dataclass(frozen=True)
class Projected:
    """The nearest point of {x : g(x) >= 0} to y, with residuals recomputed from y and g alone.

    Attributes
    ----------
    point
        x, shape (N, d).
    multipliers
        Shape (m,): x - y = sum_k multipliers_k grad g_k(x).
    violation
        max_k max(0, -g_k(x)).
    stationarity
        max |x - y - J(x)^T multipliers|.
    complementarity
        max_k |min(multipliers_k, g_k(x))|, which is zero just when both are >= 0 and one of them is zero.
    iterations, back_end
        What the back end reports of its work, and its name.
    """

    point: NDArray[np.float64]
    multipliers: NDArray[np.float64]
    violation: float
    stationarity: float
    complementarity: float
    iterations: int
    back_end: str

    @property
    def solved(self) -> bool:
        """Whether a back end was needed: the point was not feasible."""
        return self.back_end != NO_BACK_END

    @property
    def residual(self) -> float:
        """The largest of the three residuals."""
        return max(self.violation, self.stationarity, self.complementarity)


@dataclass(frozen=True)
class Projection(ABC):
    """A way to compute nearest points, to the tolerance ``tol`` > 0 on the residual of Projected [length]."""

    tol: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "tol", number("tol", self.tol, positive=True))

    def check(self, problem: Problem) -> None:  # noqa: B027 - most projections serve every problem
        """Raise InvalidProblem if this projection cannot serve the problem's constraints."""

    @abstractmethod
    def solver(self) -> Solver:
        """A solver for one run; it may store warm starts and compiled problems."""


def check_projection(projection: object) -> None:
    """Raise InvalidProblem unless this is what a scheme can be given to project with."""
    if not isinstance(projection, Projection):
        raise InvalidProblem(f"projection = {describe(projection)}: must be a projection such as Daqp(tol=1e-9)")


class Solver(ABC):
    """A back end at work, for one run: the nearest point of {x : g(x) >= 0} to y, where g are some ``Rows``.

    A subclass gives its ``name`` and ``compute``, which ends with ``certify``: the answer is judged by residuals that
    are recomputed from the rows, not by what the back end says of itself.

    Attributes
    ----------
    whole
        Whether it projects onto curved sets itself; else it solves programs, one linearisation after another.
    dense
        Whether it needs room for dense factors.
    """

    name: ClassVar[str]
    whole: ClassVar[bool] = True
    dense: ClassVar[bool] = False

    def __init__(self, tol: float) -> None:
        self.tol = tol

    def nearest(self, rows: Rows, y: NDArray[np.float64], guess: NDArray[np.float64]) -> Projected:
        """The nearest point to y (N, d) with rows >= 0, searched from ``guess``; StepFailure if it is not found."""
        values, tolerance = rows.values(y), self.tolerance(rows, y)
        violation = float(np.max(-values, initial=0.0))
        if violation <= NEGLIGIBLE * tolerance:
            return Projected(y, np.zeros(len(values)), violation, 0.0, violation, 0, NO_BACK_END)
        found = self.compute(rows, y, guess)
        if not found.residual <= tolerance:
            raise StepFailure(
                Status.NOT_CONVERGED,
                f"{self.name} left a residual of {found.residual:.2g}, asked for was {tolerance:.2g}.",
            )
        return found

    @property
    def compiled(self) -> Any | None:
        """The solver as a function of ``dincl.steps.loop.step_function``; None if it is in Python.

        See ``dincl.system.arrays.Solving``.
        """
        return None

    def bind(self, system: CompiledProblem) -> Any:
        """What has the address of this solver for the compiled projections of a system."""
        from dincl.projection.solving import ProgramSolving, WholeSolving

        if self.compiled is not None:
            return self.compiled
        return WholeSolving(self, system) if self.whole else ProgramSolving(self, system)

    def tolerance(self, rows: Rows, y: NDArray[np.float64]) -> float:
        """The greatest residual allowed for a projection of y."""
        return self.tol

    @abstractmethod
    def compute(self, rows: Rows, y: NDArray[np.float64], guess: NDArray[np.float64]) -> Projected:
        """The same for a y that violates a row, as ``certify`` gives it.

        The certificate may miss ``tol``: ``nearest`` then raises StepFailure(NOT_CONVERGED).
        """

    def certify(
        self, linear: AffineRows, y: NDArray[np.float64], x: NDArray[np.float64], lam: NDArray[np.float64], work: int
    ) -> Projected:
        """The certificate of x with multipliers ``lam`` (m,), from ``linearised(rows, x)`` and ``work`` iterations."""
        values = linear.values(x)
        misfit = (x - y).ravel() - combined(linear.matrix, lam)
        return Projected(
            point=x,
            multipliers=lam,
            violation=float(np.max(-values, initial=0.0)),
            stationarity=float(np.max(np.abs(misfit), initial=0.0)),
            complementarity=float(np.max(np.abs(np.minimum(lam, values)), initial=0.0)),
            iterations=work,
            back_end=self.name,
        )

    def completed(self, rows: Rows, y: NDArray[np.float64], found: Projected, tol: float) -> Projected:
        """The answer of an interior point, put exactly onto its active rows until it reaches ``tol`` or gets no better.

        Only a smaller certified residual is taken.
        """
        for _ in range(MOST_COMPLETIONS):
            if found.residual <= tol:
                break
            linear = linearised(rows, found.point)
            active = found.multipliers > linear.values(found.point)
            point, lam = on_active_rows(linear, y, found.multipliers, active)
            better = self.certify(linearised(rows, point), y, point, lam, found.iterations)
            if not better.residual < found.residual:
                break
            found = better
        return found


def on_active_rows(
    linear: AffineRows, y: NDArray[np.float64], multipliers: NDArray[np.float64], active: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nearest point to y with A x = bound in the ``active`` rows, and its multipliers (m,), zero in the others.

    Solves A A^T lambda = bound - A y by the proximal point method from the multipliers given,

        lambda <- lambda + (A A^T + damping)^{-1} (bound - A (y + A^T lambda)),

    which for redundant rows ends at the nearest of the many solutions. The matrix is sparse and factorised once.
    """
    from scipy.sparse import eye_array
    from scipy.sparse.linalg import splu

    full = np.zeros_like(multipliers)
    if not active.any():
        return y, full
    rows = linear.take(active)
    matrix = rows.matrix
    gram = matrix @ matrix.T
    weight = DAMPING * float(gram.diagonal().max())
    if weight == 0:
        return y, full
    factor = splu((gram + weight * eye_array(gram.shape[0])).tocsc())
    lam = multipliers[active]
    missing = -rows.values(y)
    for _ in range(STEPS):
        lam = lam + factor.solve(missing - matrix @ (matrix.T @ lam))
    full[active] = np.maximum(lam, 0.0)
    return y + combined(linear.matrix, full).reshape(y.shape), full
