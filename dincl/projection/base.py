"""What a projection is, and the certificate that it must earn."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from dincl.checks import describe, number
from dincl.errors import InvalidProblem, StepFailure
from dincl.matrices import combined, divided, row_squares
from dincl.projection.emptiness import why_unsolved
from dincl.rows.affine import linearised
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.problem import Problem
    from dincl.rows.affine import AffineRows
    from dincl.rows.base import Rows
    from dincl.system.compiled_problem import CompiledProblem

# A point that violates by less than this part of the tolerance is its own nearest point, which its certificate says.
NEGLIGIBLE = 1e-3
# Completions on the active rows; on curved rows each shortens the error by about multiplier / distance.
MOST_COMPLETIONS = 20

# Weight of the step from the multipliers given, for rows of length 1: makes redundant rows solvable.
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
    size
        The largest coordinate of the problem for which it works [length].
    """

    name: ClassVar[str]
    whole: ClassVar[bool] = True
    dense: ClassVar[bool] = False

    def __init__(self, tol: float) -> None:
        self.tol, self.size = tol, 0.0

    def nearest(self, rows: Rows, y: NDArray[np.float64], guess: NDArray[np.float64]) -> Projected:
        """The nearest point to y (N, d) with rows >= 0, searched from ``guess``; StepFailure if it is not found."""
        values, tolerance = rows.values(y), self.tolerance(rows, y)
        violation = float(np.max(-values, initial=0.0))
        if violation <= NEGLIGIBLE * tolerance:
            return Projected(y, np.zeros(len(values)), violation, 0.0, violation, 0, NO_BACK_END)
        try:
            found = self.compute(rows, y, guess)
            if not found.residual <= tolerance:
                raise missed(self.name, found.residual, tolerance)
        except StepFailure as failure:
            raise self._reason(failure, rows, y, guess) from failure
        return found

    def _reason(
        self, failure: StepFailure, rows: Rows, y: NDArray[np.float64], guess: NDArray[np.float64] | None
    ) -> StepFailure:
        """Return why there is no nearest point, by the rows linearised at ``guess``, if it is seen."""
        if failure.status is not Status.NOT_CONVERGED:
            return failure
        linear = linearised(rows, y if guess is None else guess)
        lengths = row_lengths(linear.matrix)
        binding = np.repeat([block.concave for block in rows.by_kind()], [len(block) for block in rows.by_kind()])
        size = max(self.size, float(np.abs(y).max()), 0.0 if guess is None else float(np.abs(guess).max()))
        return why_unsolved(failure, divided(linear.matrix, lengths), -linear.values(y) / lengths, size, binding)

    @property
    def compiled(self) -> Any | None:
        """The solver as a function of ``dincl.steps.loop.step_function``; None if it is in Python.

        See ``dincl.system.arrays.Solving``.
        """
        return None

    def bind(self, system: CompiledProblem) -> Any:
        """What has the address of this solver for the compiled projections of a system."""
        from dincl.projection.solving import ProgramSolving, WholeSolving

        self.size = float(np.abs(system.problem.x0).max())
        if self.compiled is not None:
            return self.compiled
        return WholeSolving(self, system) if self.whole else ProgramSolving(self, system)

    def tolerance(self, rows: Rows, y: NDArray[np.float64]) -> float:
        """The greatest residual allowed for a projection of y."""
        return self.tol

    @abstractmethod
    def compute(self, rows: Rows, y: NDArray[np.float64], guess: NDArray[np.float64]) -> Projected:
        """The same for a y that violates a row, as ``certify`` gives it; StepFailure(NOT_CONVERGED) if it gives up.

        The certificate may miss ``tol``: ``nearest`` then raises StepFailure, and says INFEASIBLE where that is proved.
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
        """The answer of a back end, put exactly onto its active rows until it reaches ``tol`` or gets no better.

        Only a smaller certified residual is taken.
        """
        for _ in range(MOST_COMPLETIONS):
            if found.residual <= tol:
                break
            linear = linearised(rows, found.point)
            point, lam = on_active_rows(linear, y, found.point, found.multipliers)
            better = self.certify(linearised(rows, point), y, point, lam, found.iterations)
            if not better.residual < found.residual:
                break
            found = better
        return found


def missed(name: str, residual: float, tol: float) -> StepFailure:
    """Return the failure of a back end that left a residual above the tolerance."""
    detail = f"{name} left a residual of {residual:.2g} where {tol:.2g} is asked for [units of g]."
    return StepFailure(Status.NOT_CONVERGED, detail)


def row_lengths(matrix: csr_array) -> NDArray[np.float64]:
    """Compute |a_k|, 1 for a row that vanishes, shape (m,)."""
    lengths: NDArray[np.float64] = np.sqrt(row_squares(matrix))
    lengths[lengths == 0] = 1.0
    return lengths


def on_active_rows(
    linear: AffineRows, y: NDArray[np.float64], x: NDArray[np.float64], multipliers: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nearest point to y with A z = bound in the active rows, and its multipliers (m,), zero in the others.

    With rows scaled to length 1, those are active whose multiplier is larger than their gap at x. Solves
    A A^T lambda = bound - A y by the proximal point method from the multipliers given,

        lambda <- lambda + (A A^T + damping)^{-1} (bound - A (y + A^T lambda)),

    which for redundant rows ends at the nearest of the many solutions. The matrix is sparse and factorised once.
    """
    from scipy.sparse import eye_array
    from scipy.sparse.linalg import splu

    full, lengths = np.zeros_like(multipliers), row_lengths(linear.matrix)
    active = multipliers * lengths > linear.values(x) / lengths
    if not active.any() or not linear.matrix[active].nnz:
        return y, full
    matrix = divided(linear.matrix[active], lengths[active])
    gram = matrix @ matrix.T
    factor = splu((gram + DAMPING * eye_array(gram.shape[0])).tocsc())
    lam = multipliers[active] * lengths[active]
    missing = (linear.bound[active] - linear.matrix[active] @ y.ravel()) / lengths[active]
    for _ in range(STEPS):
        lam = lam + factor.solve(missing - matrix @ (matrix.T @ lam))
    full[active] = np.maximum(lam, 0.0) / lengths[active]
    return y + combined(linear.matrix, full).reshape(y.shape), full
