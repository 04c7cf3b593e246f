"""Projections and their certificate: residuals recomputed from the rows, the proof that a set is empty, wedges."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import instance, number
from dincl.constants import NARROW, OPPOSITE
from dincl.errors import StepFailure
from dincl.matrices import combined, divided, row_squares
from dincl.norms import length
from dincl.rows.kinds import linearised
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.compiled.arrays import Floats
    from dincl.rows.base import Rows
    from dincl.rows.kinds import AffineRows

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

# A failure names the curvature of the set where a point is outside of it by more than this part of a radius, and where
# the residual is more than rounding, relative to the coordinates.
CURVED, ROUNDED = 0.5, 1e-10

# Multipliers of sum 1 prove that a set is empty if |A^T mu| is at most OPPOSITE, and no point within so many sizes of
# the problem meets the rows even if |A^T mu| were a few roundings.
REGION, ROUNDING = 1e6, 4 * np.finfo(float).eps
# Programs of more rows times columns than these are only examined for the rows that have multipliers.
MOST_ENTRIES = 1_000_000


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
    linear
        The rows linearised at the point; None for a point that was feasible.
    """

    point: Floats
    multipliers: Floats
    violation: float
    stationarity: float
    complementarity: float
    iterations: int
    back_end: str
    linear: AffineRows | None = field(default=None, repr=False, compare=False)

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

    @abstractmethod
    def solver(self) -> Solver:
        """A solver for one run; it may store warm starts and compiled problems."""


def check_projection(projection: object) -> None:
    """Raise InvalidProblem unless this is what a scheme can be given to project with."""
    instance("projection", projection, Projection, "a projection such as Daqp(tol=1e-9)")


class Solver(ABC):
    """A back end at work, for one run: the nearest point of {x : g(x) >= 0} to y, where g are some ``Rows``.

    A subclass gives its ``name`` and ``compute``, which ends with ``certify``: the answer is judged by residuals that
    are recomputed from the rows, not by what the back end says of itself.

    Attributes
    ----------
    tol
        The greatest residual of an answer [length].
    size
        The largest coordinate of the problem for which it works [length].
    """

    name: str

    def __init__(self, tol: float) -> None:
        self.tol, self.size = tol, 0.0

    def nearest(self, rows: Rows, y: Floats, guess: Floats, multipliers: Floats | None = None) -> Projected:
        """The nearest point to y (N, d) with rows >= 0, searched from ``guess``; StepFailure if it is not found.

        ``multipliers`` (m,) are those of a similar projection, from which a back end may start.
        """
        values = rows.values(y)
        violation = float(np.max(-values, initial=0.0))
        nothing = np.zeros(len(values))
        if violation <= NEGLIGIBLE * self.tol:
            found = Projected(y, nothing, violation, 0.0, violation, 0, NO_BACK_END)
        else:
            try:
                found = self.compute(rows, y, guess, nothing if multipliers is None else multipliers)
                if not found.residual <= self.tol:
                    raise missed(self.name, found.residual, self.tol)
            except StepFailure as failure:
                reason = self._reason(failure, rows, y, guess)
                if reason is failure:  # its cause is what a function of the user raised
                    raise
                raise reason from failure
        refuse_wedge(rows, found, self.tol)
        return found

    def _reason(self, failure: StepFailure, rows: Rows, y: Floats, guess: Floats) -> StepFailure:
        """Return why there is no nearest point, by the rows linearised at ``guess``, if it is seen."""
        if failure.status is not Status.NOT_CONVERGED:
            return failure
        linear = linearised(rows, guess)
        lengths = row_lengths(linear.matrix)
        binding = np.repeat([block.concave for block in rows.by_kind()], [len(block) for block in rows.by_kind()])
        size = max(self.size, float(np.abs(y).max()), float(np.abs(guess).max()))
        return why_unsolved(failure, divided(linear.matrix, lengths), -linear.values(y) / lengths, size, binding)

    @abstractmethod
    def compute(self, rows: Rows, y: Floats, guess: Floats, multipliers: Floats) -> Projected:
        """The same for a y that violates a row, as ``certify`` gives it; StepFailure(NOT_CONVERGED) if it gives up.

        The certificate may miss ``tol``: ``nearest`` then raises StepFailure, and says INFEASIBLE where that is proved.
        """

    def certify(self, linear: AffineRows, y: Floats, x: Floats, lam: Floats, work: int) -> Projected:
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
            linear=linear,
        )

    def completed(self, rows: Rows, y: Floats, found: Projected, tol: float) -> Projected:
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


def missed(name: str, residual: float, tol: float, bent: float = 0.0, size: float = np.inf) -> StepFailure:
    """Return the failure of a back end that left a residual above the tolerance.

    ``bent`` is how many radii of curvature the point was outside of the set, ``size`` the largest coordinate.
    """
    detail = f"{name} left a residual of {residual:.2g} where {tol:.2g} is asked for [units of g]."
    if bent > CURVED and residual > ROUNDED * size:
        detail += (
            f" The set is strongly curved on the scale of a step: the point to project lies {bent:.2g} radii of "
            "curvature outside of it. A smaller dt makes steps shorter than that radius."
        )
    return StepFailure(Status.NOT_CONVERGED, detail)


def refuse_wedge(rows: Rows, found: Projected, tol: float) -> None:
    """StepFailure if a point may lie farther from the nearest one than the tolerance though its gaps do not.

    Rows that make a wedge have gaps of at most the tolerance. What matters is how far the point violates them, or is
    off those that have a multiplier.
    """
    if found.violation == 0 and not found.solved:
        return
    linear = linearised(rows, found.point) if found.linear is None else found.linear
    indptr, indices = linear.matrix.indptr, linear.matrix.indices
    lengths = row_lengths(linear.matrix)
    gaps = linear.values(found.point) / lengths
    close = np.flatnonzero((gaps <= tol) & (np.diff(indptr) > 0))
    # Only rows in the same coordinates make a wedge, and most rows are the only ones in theirs.
    ends = indices[indptr[close]] * float(found.point.size) + indices[indptr[close + 1] - 1]
    once = np.sort(ends)
    shared = once[1:][once[1:] == once[:-1]]
    if not len(shared):
        return
    close = close[np.isin(ends, shared)]
    off = np.where(found.multipliers > 0, np.abs(gaps), -gaps)[close]
    if off.max() <= 0:
        return
    from dincl.solvers.wedges import narrowest_of

    width = narrowest_of(divided(linear.matrix, lengths)[close])
    if off.max() > tol * width:
        raise wedge(2 * width)


def row_lengths(matrix: csr_array) -> Floats:
    """Compute |a_k|, 1 for a row that vanishes, shape (m,)."""
    lengths: Floats = np.sqrt(row_squares(matrix))
    lengths[lengths == 0] = 1.0
    return lengths


def on_active_rows(linear: AffineRows, y: Floats, x: Floats, multipliers: Floats) -> tuple[Floats, Floats]:
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


class Combination(NamedTuple):
    """Multipliers of sum 1 with the least |A^T mu| for their mu . missing.

    Every u with A u >= missing has |u| >= mu . missing / |A^T mu|  (Farkas' lemma).
    """

    remainder: float  # |A^T mu|
    missing: float  # mu . missing
    opening: float  # of two nearly opposite rows: |A^T mu| times the number of rows with a multiplier [rad]
    rows: NDArray[np.int64]  # those with a multiplier


def why_unsolved(
    failure: StepFailure,
    matrix: csr_array,
    missing: Floats,
    size: float,
    binding: NDArray[np.bool_] | None = None,
    multipliers: Floats | None = None,
) -> StepFailure:
    """Return INFEASIBLE if it is proved that no u has A u >= missing; else the failure, with its reason if one is seen.

    Parameters
    ----------
    failure
        How a back end failed. Only NOT_CONVERGED is examined.
    matrix, missing
        A (m, n) with rows of length 1 or 0, and b - A y (m,): the program for u = x - y.
    size
        The largest coordinate or offset of the problem [length].
    binding
        Whether each point of the set obeys the row, (m,); only such rows prove anything. None: all do.
    multipliers
        Those of the back end: of large programs only their rows are examined.
    """
    if failure.status is not Status.NOT_CONVERGED:
        return failure
    size = max(size, float(np.abs(missing).max(initial=0.0)))
    keep = np.ones(len(missing), dtype=np.bool_) if binding is None else binding
    proof = least_combination(matrix[keep], missing[keep], None if multipliers is None else multipliers[keep])
    if proof is not None and _is_proof(proof, size):
        return StepFailure(
            Status.INFEASIBLE,
            f"No point meets all constraints: multipliers mu >= 0 of sum 1 with |A^T mu| = {proof.remainder:.1g} and "
            f"mu . (b - A y) = {proof.missing:.3g} > 0 prove it.",
        )
    found = proof if keep.all() else least_combination(matrix, missing, multipliers)
    if found is None:
        return failure
    if _is_proof(found, size):
        return StepFailure(
            failure.status,
            f"{failure.detail} The constraints as linearised cannot be met together; the curved set may have points.",
        )
    if found.opening > NARROW:
        return failure
    if found.opening > OPPOSITE:
        return wedge(found.opening, failure.detail)
    detail = (
        f"{failure.detail} Constraints are opposite to each other, and rounding decides whether there is room left."
    )
    return StepFailure(failure.status, detail)


def wedge(opening: float, detail: str = "") -> StepFailure:
    """Return the failure in a wedge of constraints, whose opening magnifies what their gaps are off."""
    return StepFailure(
        Status.NOT_CONVERGED,
        f"{detail} Constraints are opposite to each other but for {opening:.1g} rad, so that rounding and tolerances "
        f"count {1 / opening:.0e} times in the position: widen this wedge, or leave out one of them.".lstrip(),
    )


def _is_proof(found: Combination, size: float) -> bool:
    return found.remainder <= OPPOSITE and found.missing > max(found.remainder, ROUNDING) * REGION * size


def least_combination(matrix: csr_array, missing: Floats, multipliers: Floats | None = None) -> Combination | None:
    """Find multipliers mu >= 0 that minimise |A^T mu|^2 + (mu . missing / max missing - 1)^2; None if none are found.

    This is the dual of the least-distance program (Lawson, Hanson 1974, chapter 23): for an empty set the minimum is
    zero, and else A^T mu points to the nearest point.
    """
    from scipy.optimize import nnls

    scale = float(missing.max(initial=0.0))
    if not (scale > 0 and np.isfinite(missing).all() and np.isfinite(matrix.data).all()):
        return None
    chosen, columns = np.arange(len(missing)), np.unique(matrix.indices)
    if len(missing) * len(columns) > MOST_ENTRIES and multipliers is not None:
        chosen = np.flatnonzero(multipliers > 0)
        columns = np.unique(matrix[chosen].indices)
    if not 0 < len(chosen) * max(len(columns), 1) <= MOST_ENTRIES:
        return None
    rows, right = matrix[chosen][:, columns].toarray(), np.zeros(len(columns) + 1)
    right[-1] = 1.0
    try:
        mu, _ = nnls(np.vstack((rows.T, missing[chosen] / scale)), right)
    except RuntimeError:
        return None
    used = mu > 0
    if not used.any():
        return None
    of_used, weights = rows[used].T, mu[used] / mu.sum()
    # Rounding of mu is taken out of A^T mu, as far as the multipliers stay positive.
    corrected = weights - np.linalg.lstsq(of_used, of_used @ weights, rcond=NARROW)[0]
    if (corrected > 0).all() and length(of_used @ corrected) / corrected.sum() < length(of_used @ weights):
        weights = corrected / corrected.sum()
    remainder = length(of_used @ weights)
    opening = remainder * len(weights)
    return Combination(remainder, float(missing[chosen][used] @ weights), opening, chosen[used])
