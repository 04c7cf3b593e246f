"""Projections alone, without particles: nearest points of polyhedra in a metric, and the dual problem by W and q."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.checks import array, as_array, attempt, describe, shaped
from dincl.errors import InvalidProblem, StepFailure
from dincl.matrices import divided, from_rows, row_squares
from dincl.norms import length
from dincl.projection.certificate import (
    DAMPING,
    MOST_COMPLETIONS,
    REGION,
    STEPS,
    check_projection,
    least_combination,
    missed,
    row_lengths,
    why_unsolved,
)
from dincl.projection.compiled import ActiveSet, ProjectedCG
from dincl.projection.quadratic import Daqp
from dincl.rows.kinds import AffineRows
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.projection.certificate import Projection

    Floats = NDArray[np.float64]
    Flags = NDArray[np.bool_]

# The tolerance without a projection, and from how many rows on gradients are faster than an active set. Measured on
# piles: 4 and 6 ms for 284 rows, 100 and 50 ms for 886. Where rows are dense, Daqp is 1.4 to 3 times as fast.
TOLERANCE, MANY = 1e-9, 300
# The part of the tolerance for the back end; the way back into the coordinates of the user adds rounding.
SHARE = 0.5
# Eigenvalues above minus this are rounding in a W with ones in its diagonal, as are skew parts, and parts of rows of
# length 1.
ROUNDING = 1e-10
# Rows of dense matrices that are made at once, and rows that a message names.
BLOCK, NAMED = 256, 10


@dataclass(frozen=True, eq=False)
class Certified:
    """A point and its multipliers, with residuals recomputed from the data, whatever the back end reports.

    The residuals have no units. With g = A v - b, d_k = sqrt(a_k M^-1 a_k) and ``scale`` s, the largest distance
    (b_k - a_k c) / d_k by which c violates a row (of equalities the magnitude), they are

        violation        max -g_k / (d_k s), and of equalities |g_k| / (d_k s)
        stationarity     max |M (v - c) - A^T lambda|_i / (sqrt(M_ii) s)
        complementarity  max |min(lambda_k d_k, g_k / d_k)| / s  of inequalities
        sign             max -lambda_k d_k / s  of inequalities

    Attributes
    ----------
    point
        v, shape (n,). For an Lcp the gaps W lambda + q, shape (m,).
    multipliers
        lambda, shape (m,), with M (v - c) = A^T lambda.
    status
        SUCCESS: ``residual`` is at most the tolerance. INFEASIBLE, which is proved, or NOT_CONVERGED: point and
        multipliers are c and 0 if the back end gave none.
    detail
        Why there is no point, and which rows contradict each other.
    back_end, iterations
        The projection, and what its back end reports of its work.
    """

    point: Floats
    multipliers: Floats
    status: Status
    detail: str
    violation: float
    stationarity: float
    complementarity: float
    sign: float
    scale: float
    back_end: str
    iterations: int

    @property
    def residual(self) -> float:
        """The largest of the four residuals."""
        return max(self.violation, self.stationarity, self.complementarity, self.sign)


class _Program(ABC):
    """A program that is solved in coordinates in which the metric is the identity, with rows of length 1."""

    equal: Any
    _rows: Any  # A in these coordinates

    @abstractmethod
    def _start(self) -> tuple[Floats, Floats]:
        """Return d (m,), and (b - A c) / d."""

    @abstractmethod
    def _search(self, how: Projection, least: Floats) -> tuple[Floats, int]:
        """Return multipliers for rows of length 1 and right-hand sides ``least``, and the iterations."""

    @abstractmethod
    def _state(self, multipliers: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the point, g there, and |M (v - c) - A^T lambda|_i / sqrt(M_ii), from the data."""

    def solve(self, projection: Projection | None = None) -> Certified:
        """Find the point with a projection, whose tolerance is that of ``Certified.residual``.

        None is ActiveSet(1e-9), Daqp(1e-9) for dense rows, ProjectedCG(1e-9) from 300 rows on. With thousands of rows
        Piqp is two to ten times as fast.
        """
        lengths, least = self._start()
        if projection is None:
            few = Daqp if 2 * self._rows.nnz > self._rows.shape[0] * self._rows.shape[1] else ActiveSet
            projection = (few if len(least) < MANY else ProjectedCG)(TOLERANCE)
        check_projection(projection)
        scale = float(np.where(self.equal, np.abs(least), least).max(initial=0.0))
        unit, weights, work, status, detail = scale or 1.0, np.zeros(len(least)), 0, Status.SUCCESS, ""
        if scale > 0:
            try:
                weights, work = self._search(replace(projection, tol=SHARE * projection.tol), least / scale)
            except StepFailure as failure:
                status, detail = failure.status, failure.detail
        multipliers = weights * unit / lengths
        point, gaps, misfit = self._state(multipliers)
        gaps, fixed = gaps / lengths / unit, self.equal
        found = Certified(
            point,
            multipliers,
            status,
            detail,
            float(max((-gaps).max(initial=0.0), gaps[fixed].max(initial=0.0))) + 0.0,  # -0 is 0
            float(misfit.max(initial=0.0) / unit),
            float(np.abs(np.minimum(weights, gaps)[~fixed]).max(initial=0.0)),
            float((-weights[~fixed]).max(initial=0.0)) + 0.0,
            scale,
            type(projection).__name__,
            work,
        )
        if status and not found.residual <= projection.tol:
            detail = f"A residual of {found.residual:.2g} is left where {projection.tol:.2g} is asked for."
            return replace(found, status=Status.NOT_CONVERGED, detail=detail)
        return found


@dataclass(frozen=True, eq=False)
class NearestPoint(_Program):
    """v = argmin 1/2 (v - c)^T M (v - c)  subject to  A v >= b, and = b in the rows that are ``equal``.

    No point needs to be feasible. Matrices are arrays, or sparse ones of SciPy.

    Parameters
    ----------
    c
        Shape (n,).
    A, b
        Rows, shapes (m, n) and (m,).
    equal
        Truth values of the rows, shape (m,); None: no row is an equality. Equalities are eliminated by a dense matrix
        of their number, squared.
    metric
        M, shape (n, n), symmetric and positive definite; None for the identity. The rows stay sparse in the metric of
        a sparse M that is diagonal or has small blocks.

    Raises
    ------
    InvalidProblem
        For wrong shapes, numbers that are not finite, an M that is not symmetric or not positive definite.
    """

    c: Any
    A: Any
    b: Any
    equal: Any = None
    metric: Any = None

    def __post_init__(self) -> None:
        c, b, equal, metric = shaped("c", self.c, (None,)), shaped("b", self.b, (None,)), self.equal, self.metric
        m, n = len(b), len(c)
        which = attempt(as_array, np.zeros(m, dtype=np.bool_) if equal is None else equal)
        if which is None or which.dtype != np.bool_ or which.shape != (m,):
            raise InvalidProblem(f"equal = {describe(equal)}: must be {m} truth values, one for each row")
        weights = None if metric is None else _matrix("metric", metric, (n, n))
        if weights is not None and abs(weights - weights.T).max() > ROUNDING * abs(weights).max():
            raise InvalidProblem(f"metric = {describe(metric)}: must be symmetric")
        self.__dict__.update(c=c, A=_matrix("A", self.A, (m, n)), b=b, equal=which.copy(), metric=weights)
        try:
            _ = self._factor
        except np.linalg.LinAlgError:
            raise InvalidProblem(f"metric = {describe(metric)}: must be positive definite") from None

    def __reduce__(self) -> tuple[Any, ...]:  # factors cannot be pickled
        return type(self), (self.c, self.A, self.b, self.equal, self.metric)

    @cached_property
    def _factor(self) -> Factor | None:
        return None if self.metric is None else factorised(self.metric)

    @cached_property
    def _rows(self) -> csr_array:
        """A F with F F^T = M^-1."""
        from scipy.sparse import csr_array, vstack

        rows = csr_array(self.A)
        if self._factor is None:
            return rows
        if not isinstance(self.metric, np.ndarray) and self.metric.nnz == len(self.c):  # diagonal
            roots = np.sqrt(self.metric.diagonal())
            return from_rows(rows.indptr, rows.indices, rows.data / roots[rows.indices], len(roots))
        half = self._factor.half
        blocks = [half(rows[k : k + BLOCK].T.toarray()).T for k in range(0, rows.shape[0], BLOCK)]
        return csr_array(vstack([csr_array(block) for block in blocks], format="csr"))

    def _start(self) -> tuple[Floats, Floats]:
        lengths = row_lengths(self._rows)
        return lengths, (self.b - self.A @ self.c) / lengths

    def _state(self, multipliers: Floats) -> tuple[Floats, Floats, Floats]:
        force = self.A.T @ multipliers
        if self._factor is None:
            point = self.c + force
            return point, self.A @ point - self.b, np.abs(point - self.c - force)
        point = self.c + self._factor.solve(force)
        misfit = np.abs(self.metric @ (point - self.c) - force) / np.sqrt(self.metric.diagonal())
        return point, self.A @ point - self.b, misfit

    def _search(self, how: Projection, least: Floats) -> tuple[Floats, int]:
        """Eliminate equalities and coordinates without rows, then project the origin."""
        from scipy.linalg import qr
        from scipy.sparse import csr_array

        weights, rows, fixed = np.zeros(len(least)), divided(self._rows, row_lengths(self._rows)), self.equal
        free = np.flatnonzero(~fixed)
        if fixed.any():
            rows, least, forces, coupling = _without_equalities(rows, least, fixed)
        empty, work = row_squares(rows) == 0, 0
        if (wrong := free[empty & (least > how.tol)]).size:
            what = f"rows {', '.join(map(str, wrong[:NAMED]))}: they vanish, on the equalities if there are any,"
            raise StepFailure(Status.INFEASIBLE, f"No point meets the {what} and their right-hand sides do not.")
        rows, least, free = rows[~empty], least[~empty], free[~empty]
        if (least > 0).any():
            used, place = np.unique(rows.indices, return_inverse=True)
            rows = from_rows(rows.indptr, place, rows.data, len(used))
            m, n = rows.shape
            if n > m and (isinstance(how, Daqp) or 2 * rows.nnz > m * n):
                rows = csr_array(qr(rows.toarray().T, mode="r", check_finite=False)[0][:m].T)
            lengths = row_lengths(rows)
            rows, least, origin = divided(rows, lengths), least / lengths, np.zeros((rows.shape[1], 1))
            try:
                found = how.solver().nearest(AffineRows(rows, least), origin, origin)
            except StepFailure as failure:
                raise _named(failure, rows, least, free) from failure
            weights[free], work = found.multipliers / lengths, found.iterations
        if fixed.any():
            weights[fixed] = forces - coupling @ weights[~fixed]
        return weights, work


@dataclass(frozen=True, eq=False)
class Lcp(_Program):
    """0 <= lambda  perpendicular to  W lambda + q >= 0, for W symmetric and positive semidefinite.

    lambda are the multipliers of a projection with W = A M^-1 A^T and q = A c - b. The gaps W lambda + q are unique.

    Parameters
    ----------
    W
        Shape (m, m), an array or a sparse matrix, which is treated as an array.
    q
        Shape (m,).

    Raises
    ------
    InvalidProblem
        For a W that is not symmetric, or not positive semidefinite up to rounding: such a problem is no projection.
    """

    W: Any
    q: Any

    def __post_init__(self) -> None:
        q = shaped("q", self.q, (None,))
        W = _matrix("W", self.W, (len(q), len(q)))
        self.__dict__.update(W=W, q=q, equal=np.zeros(len(q), dtype=np.bool_))
        refused = ": must be symmetric and positive semidefinite, else the problem is no projection"
        skew = np.abs(self._scaled - self._scaled.T)
        i, j = np.unravel_index(int(skew.argmax()), skew.shape)
        if skew[i, j] > ROUNDING:
            raise InvalidProblem(f"W[{i}, {j}] = {W[i, j]:g}, W[{j}, {i}] = {W[j, i]:g}{refused}")
        try:
            factorised(self._scaled + ROUNDING * np.eye(len(q)))
        except np.linalg.LinAlgError:
            raise InvalidProblem(f"W is not positive semidefinite{refused}") from None

    @cached_property
    def _scaled(self) -> Floats:
        """W for rows of length 1."""
        lengths = self._start()[0]
        scaled: Floats = (self.W if isinstance(self.W, np.ndarray) else self.W.toarray()) / lengths / lengths[:, None]
        return scaled

    @cached_property
    def _rows(self) -> csr_array:
        """A with A A^T = W, for rows of length 1, and as many columns as the rank."""
        from scipy.sparse import csr_array

        low, order = pivoted_cholesky(self._scaled)
        rows = np.empty_like(low)
        rows[order] = low
        return csr_array(rows)

    def _start(self) -> tuple[Floats, Floats]:
        lengths = np.sqrt(np.maximum(self.W.diagonal(), 0.0))
        lengths[lengths == 0] = 1.0
        return lengths, -self.q / lengths

    def _state(self, multipliers: Floats) -> tuple[Floats, Floats, Floats]:
        gaps: Floats = self.W @ multipliers + self.q
        return gaps, gaps, np.zeros(0)

    def _search(self, how: Projection, least: Floats) -> tuple[Floats, int]:
        """Project with the factor of W; the multipliers are completed with W itself."""
        solver, origin = how.solver(), np.zeros((self._rows.shape[1], 1))
        try:
            # ``nearest`` would also look for wedges, in which u is inaccurate, but u is not the answer.
            found = solver.compute(AffineRows(self._rows, least), origin, origin, np.zeros(len(least)))
            weights, left = _on_active_gram(self._scaled, least, found.multipliers, how.tol)
            if not left <= how.tol:
                raise missed(solver.name, left, how.tol)
        except StepFailure as failure:
            raise _named(why_unsolved(failure, self._rows, least, 1.0), self._rows, least) from failure
        return weights, found.iterations


def _on_active_gram(gram: Floats, least: Floats, multipliers: Floats, tol: float) -> tuple[Floats, float]:
    """Return the best multipliers >= 0 of steps that solve gram lambda = least in the active rows, and their residual.

    Those are active whose multiplier, of either sign, is larger than their gap gram lambda - least, so that a wrong
    guess of an interior point is corrected; ends once the residual max |min(lambda, gap)| is at most ``tol``. ``gram``
    (m, m) has ones in its diagonal.
    """
    best, smallest = multipliers, np.inf
    for _ in range(MOST_COMPLETIONS):
        kept, active = np.maximum(multipliers, 0.0), multipliers > gram @ multipliers - least
        residual = float(np.abs(np.minimum(kept, gram @ kept - least)).max())
        if residual < smallest:
            best, smallest = kept, residual
        if smallest <= tol or not active.any():
            break
        part, right, inner = gram[active][:, active], least[active], multipliers[active]
        solve = factorised(part + DAMPING * np.eye(len(part))).solve
        for _ in range(STEPS):
            inner = inner + solve(right - part @ inner)
        multipliers = np.zeros_like(best)
        multipliers[active] = inner
    return best, smallest


class Factor(NamedTuple):
    """M^-1 B and F B for B (n, k), where F^T F = M^-1."""

    solve: Callable[[Floats], Floats]
    half: Callable[[Floats], Floats]


def factorised(matrix: Any) -> Factor:
    """Factorise a matrix M, an array or sparse; LinAlgError unless it is positive definite."""
    if isinstance(matrix, np.ndarray):
        from scipy.linalg import cho_solve, cholesky, solve_triangular

        low = cholesky(matrix, lower=True, check_finite=False)
        return Factor(
            lambda b: cho_solve((low, True), b, check_finite=False),
            lambda b: solve_triangular(low, b, lower=True, check_finite=False),
        )
    from scipy.sparse.linalg import splu, spsolve_triangular

    try:
        found = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise np.linalg.LinAlgError(str(error)) from error
    pivots, place = found.U.diagonal(), np.argsort(found.perm_r)
    if not ((pivots > 0).all() and (found.perm_r == found.perm_c).all()):
        raise np.linalg.LinAlgError("a pivot is not positive")
    low, roots = found.L.tocsr(), np.sqrt(pivots)[:, None]
    return Factor(found.solve, lambda b: spsolve_triangular(low, b[place], unit_diagonal=True) / roots)


def pivoted_cholesky(matrix: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Return L (m, rank) and an order with M[order][:, order] = L L^T, up to rounding of the largest entry."""
    from scipy.linalg.lapack import dpstrf

    size = float(matrix.diagonal().max(initial=0.0))
    lower, order, rank, _ = dpstrf(matrix, tol=len(matrix) * np.finfo(float).eps * size, lower=1)
    return np.tril(lower)[:, :rank], order.astype(np.int64) - 1


def _matrix(name: str, value: Any, shape: tuple[int, int]) -> Any:
    """Return an array, or a ``csr_array`` of a sparse matrix, with finite numbers."""
    from scipy.sparse import csr_array, issparse

    if not issparse(value):
        return shaped(name, value, shape)
    found = csr_array(value)
    if found.shape != shape:
        raise InvalidProblem(f"{name} of shape {found.shape}: must have shape {shape}")
    found.sum_duplicates()
    return csr_array((array(name, found.data), found.indices, found.indptr), shape=shape)


def _named(
    failure: StepFailure, rows: csr_array, least: Floats, numbers: NDArray[np.int64] | None = None
) -> StepFailure:
    """Name the rows that contradict each other."""
    proof = least_combination(rows, least) if failure.status is Status.INFEASIBLE else None
    if proof is None:
        return failure
    named = proof.rows if numbers is None else numbers[proof.rows]
    return StepFailure(failure.status, f"{failure.detail} They are of the rows {', '.join(map(str, named[:NAMED]))}.")


def _without_equalities(rows: csr_array, least: Floats, equal: Flags) -> tuple[csr_array, Floats, Floats, Floats]:
    """Project the inequalities, of length 1, onto the kernel of the equalities E u = e, as seen from its least u.

    Returns their rows and right-hand sides, and forces and coupling: the multipliers of E are forces - coupling @ those
    of the inequalities. Equalities that follow from others get none.
    """
    from scipy.linalg import cho_solve
    from scipy.sparse import csr_array

    fixed, others, right = rows[equal], rows[~equal], least[equal]
    gram = (fixed @ fixed.T).toarray()
    low, order = pivoted_cholesky(gram)
    kept = order[: low.shape[1]]

    def solved(b: Floats) -> Floats:
        full = np.zeros_like(b)
        full[kept] = cho_solve((low[: len(kept)], True), b[kept], check_finite=False)
        return full

    forces, coupling = solved(right), solved((fixed @ others.T).toarray())
    start = fixed.T @ forces
    off = np.abs(fixed @ start - right)
    k = int(off.argmax())
    if off[k] > ROUNDING:
        # Row k less its combination of the others vanishes, its right-hand side does not.
        proved = off[k] > REGION * length(fixed[[k]].toarray()[0] - fixed.T @ solved(gram[:, k]))
        detail = f"The equality in row {np.flatnonzero(equal)[k]} contradicts others, or depends on them."
        raise StepFailure(Status.INFEASIBLE if proved else Status.NOT_CONVERGED, detail)
    left = csr_array(others - csr_array(coupling.T) @ fixed)
    left.data[np.repeat(row_lengths(left) < ROUNDING, np.diff(left.indptr))] = 0.0
    return left, least[~equal] - others @ start, forces, coupling
