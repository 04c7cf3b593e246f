"""Projections onto S itself, by the interior-point method Ipopt, in nonlinear programs that CasADi compiles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.errors import StepFailure
from dincl.extras import needs
from dincl.matrices import divided
from dincl.projection.certificate import Projected, Projection, Solver
from dincl.projection.quadratic import QpAnswer, QpSolver, remembered
from dincl.rows.kinds import AffineRows, DistanceRows, linearised
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Hashable, Sequence

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.compiled.arrays import Floats
    from dincl.rows.base import Rows, RowsOfOneKind

MOST_ITERATIONS = 500
# Lengths are in units of the largest violation, so that the tolerances are relative to the move.
TOLERANCE = 1e-11
OPTIONS = {
    "print_time": False,
    "error_on_fail": False,
    "show_eval_warnings": False,
    "calc_lam_p": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.max_iter": MOST_ITERATIONS,
    "ipopt.tol": TOLERANCE,
    "ipopt.dual_inf_tol": TOLERANCE,
    "ipopt.constr_viol_tol": TOLERANCE,
    "ipopt.compl_inf_tol": TOLERANCE,
    # Without these, Ipopt answers for a slightly larger set, accepts less than asked for, and rescales what is scaled.
    "ipopt.bound_relax_factor": 0.0,
    "ipopt.acceptable_iter": 0,
    "ipopt.nlp_scaling_method": "none",
}

# Compiled programs kept for the next time that the same rows are near.
MOST_PROGRAMS = 64
# Words after which the certificate decides whether the point is good enough.
FOUND = ("Solve_Succeeded", "Solved_To_Acceptable_Level", "Search_Direction_Becomes_Too_Small")


@dataclass(frozen=True)
class Ipopt(Projection):
    """Nearest points of S itself, curved and nonconvex, by Ipopt (Waechter, Biegler 2006): min |x - y|^2, g(x) >= 0.

    The answer is a point where the first-order conditions hold, searched from the state before the step. Lengths are in
    units of the largest violation; tolerances are 1e-11 of it, bounds are not relaxed, iterations are limited to 500.
    Rows of distances are polynomials with exact sparse derivatives, so a program is compiled once for the rows that are
    near, not at every step. Of a start only the point is used. What is missing to ``tol`` is completed on the active
    rows. Other sets, as of a user's function, are linearised again and again, as by the other back ends.

    Parameters
    ----------
    tol
        Greatest certified residual of a projection [length].
    """

    def solver(self) -> Solver:
        return _IpoptSolver(self.tol)


class _IpoptSolver(QpSolver):
    """Solves nonlinear programs of polynomials; other sets, as of a user's function, by linearising again and again."""

    name = "ipopt"

    def __init__(self, tol: float) -> None:
        super().__init__(tol)
        with needs("Ipopt", "yardsticks"):
            import casadi

        self._casadi = casadi
        self._programs: dict[Hashable, _Program] = {}

    def compute(self, rows: Rows, y: Floats, guess: Floats, multipliers: Floats) -> Projected:
        blocks = rows.by_kind()
        if not all(isinstance(one, AffineRows) or (isinstance(one, DistanceRows) and one.plain) for one in blocks):
            return super().compute(rows, y, guess, multipliers)
        x, lam, work = self._solved(blocks, y, guess, float(-rows.values(y).min()))
        return self.completed(rows, y, self.certify(linearised(rows, x), y, x, lam, work), self.tol)

    def qp(self, matrix: csr_array, least: Floats, multipliers: Floats, tol: float) -> QpAnswer:
        origin = np.zeros((matrix.shape[1], 1))
        u, lam, work = self._solved((AffineRows(matrix, least),), origin, origin, 1.0)
        return QpAnswer(u.ravel(), lam, work)

    def _solved(
        self, blocks: Sequence[RowsOfOneKind], y: Floats, guess: Floats, scale: float
    ) -> tuple[Floats, Floats, int]:
        """Solve a program, compiled if its rows are new: the point (N, d), multipliers (m,), iterations."""
        make = partial(_Program, self._casadi, blocks, y.shape)
        program = remembered(self._programs, (y.shape, *map(_structure, blocks)), make, MOST_PROGRAMS)
        x, lam, work, word = program.solve(blocks, y, guess, scale)
        if word not in FOUND:
            raise StepFailure(Status.NOT_CONVERGED, f"ipopt stopped: {word}.")
        return x, lam, work


class _Program:
    """min 1/2 |w|^2 subject to the rows at x = y + scale w; all numbers in it are parameters, so it is compiled once.

    Rows enter as polynomials, with their exact sparse derivatives.
    """

    def __init__(self, casadi: Any, blocks: Sequence[RowsOfOneKind], shape: tuple[int, ...]) -> None:
        w = casadi.SX.sym("w", shape[0] * shape[1])
        rows: list[Any] = []
        parameters: list[Any] = []
        for block in blocks:
            expression, numbers = _expression(casadi, _polynomial(block, np.zeros(shape), 1.0), w, shape)
            rows.append(expression)
            parameters += numbers
        program = {"x": w, "p": casadi.vertcat(*parameters), "f": casadi.dot(w, w) / 2, "g": casadi.vertcat(*rows)}
        options: Any = OPTIONS
        self._solver: Any = casadi.nlpsol("nearest", "ipopt", program, options)

    def solve(
        self, blocks: Sequence[RowsOfOneKind], y: Floats, guess: Floats, scale: float
    ) -> tuple[Floats, Floats, int, str]:
        """Solve with the numbers of ``blocks`` around y, from ``guess``: x (N, d), multipliers (m,), iterations, word.

        The word is that of Ipopt on how it ended.
        """
        polynomials = [_polynomial(block, y, scale) for block in blocks]
        # The numbers that _expression has symbols for, in the same order.
        parameters = [part for one in polynomials for part in (one.constant, one.linear.data, one.weight)]
        start = ((guess - y) / scale).ravel()
        # The second half of an equality is left out, and has what is negative of the multipliers of the first.
        first = np.concatenate([_half(block, 0) for block in blocks])
        second = np.concatenate([_half(block, 1) for block in blocks])
        bounds = {"lbg": np.where(second, -np.inf, 0.0), "ubg": np.where(first, 0.0, np.inf)}
        found = self._solver(x0=start, p=np.concatenate(parameters), **bounds)
        x = y + scale * np.array(found["x"]).reshape(y.shape)
        steep = np.concatenate([_steepness(block, x) for block in blocks])
        # CasADi gives multipliers <= 0 to lower bounds.
        signed = -scale * np.array(found["lam_g"]).ravel() * steep
        signed[second] = -signed[first]
        multipliers = np.maximum(signed, 0.0)
        stats = self._solver.stats()
        return x, multipliers, int(stats["iter_count"]), str(stats["return_status"])


class _Polynomial(NamedTuple):
    """Rows as quadratic polynomials c + m . w + q |w_i - w_j|^2 of w, x = y + s w, which are >= 0 where g is.

    Unlike g they are smooth where centres coincide. ``constant`` c and ``weight`` q have shape (m,), ``linear`` m rows;
    ``i`` and ``j`` (m,) are the particles of the square. Without ``j`` it is |w_i|^2, without ``i`` there is none.
    """

    constant: Floats
    linear: csr_array
    weight: Floats
    i: NDArray[np.int64] | None = None
    j: NDArray[np.int64] | None = None


def _polynomial(rows: Any, y: Floats, scale: float) -> _Polynomial:
    """Return g / s of affine rows, and sign (|X_i - X_j|^2 - L^2) / (2 L s) of distances."""
    if isinstance(rows, AffineRows):
        return _Polynomial(rows.values(y) / scale, rows.matrix, np.zeros(len(rows)))
    twice, values = 2.0 * rows.length, rows.squared_values(rows.values(y), rows.squared_steepness(y))
    linear = divided(rows.squared_jacobian(y), twice)
    return _Polynomial(values / (twice * scale), linear, rows.sign * scale / twice, rows.i, rows.j)


def _steepness(rows: Any, x: Floats) -> Floats:
    """Compute the length of the gradient of the polynomial over that of g / s at x, shape (m,)."""
    if isinstance(rows, AffineRows):
        return np.ones(len(rows))
    found: Floats = rows.squared_steepness(x) / (2.0 * rows.length)
    return found


def _half(rows: RowsOfOneKind, which: int) -> NDArray[np.bool_]:
    """Return which rows are in the first or second half of an equality, shape (m,)."""
    in_half: NDArray[np.bool_] = np.arange(len(rows)) // max(len(rows) // 2, 1) == which
    return in_half & rows.equal


def _structure(rows: Any) -> tuple[Any, ...]:
    """Return a key that is equal for rows whose programs differ in numbers only."""
    if isinstance(rows, AffineRows):
        return rows.matrix.indptr.tobytes(), rows.matrix.indices.tobytes()
    return np.asarray(rows.sign).tobytes(), rows.i.tobytes(), None if rows.j is None else rows.j.tobytes()


def _expression(casadi: Any, polynomial: _Polynomial, w: Any, shape: tuple[int, ...]) -> tuple[Any, list[Any]]:
    """Expressions of the rows of one block in w, and the symbols of their numbers: constants, linear part, weights."""
    linear, entries = polynomial.linear, len(polynomial.linear.data)
    m = linear.shape[0]
    numbers = [casadi.SX.sym(name, size) for name, size in (("c", m), ("m", entries), ("q", m))]
    row_of_entry = np.repeat(np.arange(m), np.diff(linear.indptr))
    adding = casadi.Sparsity.triplet(m, entries, row_of_entry.tolist(), list(range(entries)))
    # A single unknown without rows would give a row of no entries where a column is meant.
    taken = casadi.reshape(w[linear.indices.tolist()], entries, 1)
    value = numbers[0] + casadi.mtimes(casadi.DM(adding, 1), numbers[1] * taken)
    if polynomial.i is not None:
        by_particle = casadi.reshape(w, shape[1], shape[0])
        arrows = by_particle[:, polynomial.i.tolist()]
        if polynomial.j is not None:
            arrows = arrows - by_particle[:, polynomial.j.tolist()]
        value = value + numbers[2] * casadi.sum1(arrows * arrows).T
    return value, numbers
