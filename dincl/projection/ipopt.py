"""Projections onto S itself, by the interior-point method Ipopt, in nonlinear programs that CasADi compiles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.errors import StepFailure
from dincl.extras import needs
from dincl.matrices import divided
from dincl.projection.certificate import Projected, Projection, Solver
from dincl.projection.quadratic import remembered
from dincl.rows.kinds import AffineRows, DistanceRows, linearised
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Sequence

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

# A user's function comes without second derivatives.
LIMITED_MEMORY = {"ipopt.hessian_approximation": "limited-memory"}
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
    rows.

    Parameters
    ----------
    tol
        Greatest certified residual of a projection [length].
    """

    def solver(self) -> Solver:
        return _IpoptSolver(self.tol)


class _IpoptSolver(Solver):
    name = "ipopt"

    def __init__(self, tol: float) -> None:
        super().__init__(tol)
        with needs("Ipopt", "yardsticks"):
            import casadi

        self._casadi = casadi
        self._programs: dict[Hashable, _Program] = {}

    def compute(self, rows: Rows, y: Floats, guess: Floats, multipliers: Floats) -> Projected:
        blocks = rows.by_kind()
        scale = float(-rows.values(y).min())
        make = partial(_Program, self._casadi, blocks, y.shape)
        program = remembered(self._programs, tuple(map(_structure, blocks)), make, MOST_PROGRAMS)
        x, lam, work, word = program.solve(blocks, y, guess, scale)
        if word not in FOUND:
            raise StepFailure(Status.NOT_CONVERGED, f"ipopt stopped: {word}.")
        return self.completed(rows, y, self.certify(linearised(rows, x), y, x, lam, work), self.tol)


class _Program:
    """min 1/2 |w|^2 subject to the rows at x = y + scale w; all numbers in it are parameters, so it is compiled once.

    Rows that are polynomials enter as such, with their exact sparse derivatives. The others, such as those of a user's
    function, are called back; with them, second derivatives are approximated from the gradients met (limited memory).
    """

    def __init__(self, casadi: Any, blocks: Sequence[RowsOfOneKind], shape: tuple[int, ...]) -> None:
        polynomials = [_polynomial(block, np.zeros(shape), 1.0) for block in blocks]
        self._functions = {k: _UserRows(len(block), shape) for k, block in enumerate(blocks) if polynomials[k] is None}
        kind: Any = casadi.MX if self._functions else casadi.SX
        w = kind.sym("w", shape[0] * shape[1])
        rows: list[Any] = []
        parameters: list[Any] = []
        for k, polynomial in enumerate(polynomials):
            if polynomial is None:
                rows.append(self._functions[k].function(w))
            else:
                expression, numbers = _expression(casadi, kind, polynomial, w, shape)
                rows.append(expression)
                parameters += numbers
        program = {"x": w, "p": casadi.vertcat(*parameters), "f": casadi.dot(w, w) / 2, "g": casadi.vertcat(*rows)}
        options: Any = OPTIONS | (LIMITED_MEMORY if self._functions else {})
        self._solver: Any = casadi.nlpsol("nearest", "ipopt", program, options)

    def solve(
        self, blocks: Sequence[RowsOfOneKind], y: Floats, guess: Floats, scale: float
    ) -> tuple[Floats, Floats, int, str]:
        """Solve with the numbers of ``blocks`` around y, from ``guess``: x (N, d), multipliers (m,), iterations, word.

        The word is that of Ipopt on how it ended.
        """
        parameters = [np.zeros(0)]
        for k, block in enumerate(blocks):
            polynomial = _polynomial(block, y, scale)
            if polynomial is None:
                self._functions[k].place(block, y, scale)
            else:
                # The numbers that _expression has symbols for, in the same order.
                parameters += [polynomial.constant, polynomial.linear.data, polynomial.weight]
        start = ((guess - y) / scale).ravel()
        # The second half of an equality is left out, and has what is negative of the multipliers of the first.
        first = np.concatenate([_half(block, 0) for block in blocks])
        second = np.concatenate([_half(block, 1) for block in blocks])
        bounds = {"lbg": np.where(second, -np.inf, 0.0), "ubg": np.where(first, 0.0, np.inf)}
        found = self._solver(x0=start, p=np.concatenate(parameters), **bounds)
        for function in self._functions.values():
            if function.failure is not None:
                raise function.failure
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


def _polynomial(rows: RowsOfOneKind, y: Floats, scale: float) -> _Polynomial | None:
    """Return g / s of affine rows, and sign (|X_i - X_j|^2 - L^2) / (2 L s); None if g itself is to be called."""
    if isinstance(rows, DistanceRows) and rows.plain:
        twice, values = 2.0 * rows.length, rows.squared_values(rows.values(y), rows.squared_steepness(y))
        linear = divided(rows.squared_jacobian(y), twice)
        return _Polynomial(values / (twice * scale), linear, rows.sign * scale / twice, rows.i, rows.j)
    if isinstance(rows, AffineRows):
        return _Polynomial(rows.values(y) / scale, rows.matrix, np.zeros(len(rows)))
    return None


def _steepness(rows: RowsOfOneKind, x: Floats) -> Floats:
    """Compute the length of the gradient of the polynomial over that of g / s at x, shape (m,)."""
    if isinstance(rows, DistanceRows) and rows.plain:
        return rows.squared_steepness(x) / (2.0 * rows.length)
    return np.ones(len(rows))


def _half(rows: RowsOfOneKind, which: int) -> NDArray[np.bool_]:
    """Return which rows are in the first or second half of an equality, shape (m,)."""
    in_half: NDArray[np.bool_] = np.arange(len(rows)) // max(len(rows) // 2, 1) == which
    return in_half & rows.equal


def _structure(rows: RowsOfOneKind) -> tuple[Any, ...]:
    """Return a key that is equal for rows whose programs differ in numbers only."""
    if isinstance(rows, DistanceRows):
        return np.asarray(rows.sign).tobytes(), rows.i.tobytes(), None if rows.j is None else rows.j.tobytes()
    if isinstance(rows, AffineRows):
        return rows.matrix.indptr.tobytes(), rows.matrix.indices.tobytes()
    return type(rows), len(rows)


def _expression(
    casadi: Any, kind: Any, polynomial: _Polynomial, w: Any, shape: tuple[int, ...]
) -> tuple[Any, list[Any]]:
    """Expressions of the rows of one block in w, and the symbols of their numbers: constants, linear part, weights."""
    linear, entries = polynomial.linear, len(polynomial.linear.data)
    m = linear.shape[0]
    numbers = [kind.sym(name, size) for name, size in (("c", m), ("m", entries), ("q", m))]
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


class _UserRows:
    """w -> g(y + scale w) / scale for a user's g, whose numbers are set before each solve; ``function`` is CasADi's."""

    def __init__(self, rows: int, shape: tuple[int, ...]) -> None:
        self._size, self._shape = (rows, shape[0] * shape[1]), shape
        self.failure: StepFailure | None = None
        self.function = _callback()("g", self._values, self._size, self._slopes, {})

    def place(self, rows: RowsOfOneKind, y: Floats, scale: float) -> None:
        """Take these rows from now on."""
        self._rows, self._y, self._scale, self.failure = rows, y, scale, None

    def _values(self, w: Any) -> Floats:
        return self._evaluated(lambda x: self._rows.values(x) / self._scale, w, self._size[:1])

    def _slopes(self, w: Any) -> Floats:
        """Compute dg/dx, dense, since it is not known which entries are always zero."""
        return self._evaluated(lambda x: self._rows.jacobian(x).toarray(), w, self._size)

    def _evaluated(self, function: Callable[[Floats], Floats], w: Any, shape: tuple[int, ...]) -> Floats:
        try:
            return function(self._y + self._scale * np.array(w).reshape(self._shape))
        except StepFailure as failure:
            self.failure = failure
            return np.full(shape, np.nan)


@cache
def _callback() -> Any:
    """Make the class of functions that CasADi calls, once CasADi is needed."""
    import casadi

    class Called(casadi.Callback):
        """w (n,) -> m numbers, and its derivative: (w, the m numbers) -> (m, n)."""

        def __init__(self, name: str, function: Any, size: tuple[int, int], slopes: Any, options: Any) -> None:
            casadi.Callback.__init__(self)
            self._function, self._size, self._slopes = function, size, slopes
            self.construct(name, options)

        def get_n_in(self) -> int:
            return 1 if self._slopes else 2

        def get_sparsity_in(self, i: int) -> Any:
            return casadi.Sparsity.dense(self._size[1 - i], 1)

        def get_sparsity_out(self, i: int) -> Any:
            return casadi.Sparsity.dense(self._size[0], 1 if self._slopes else self._size[1])

        def eval(self, arguments: Any) -> Any:
            return [self._function(arguments[0])]

        def has_jacobian(self) -> bool:
            return self._slopes is not None

        def get_jacobian(self, name: str, inputs: Any, outputs: Any, options: Any) -> Any:
            self._derivative = Called(name, self._slopes, self._size, None, options)  # CasADi keeps no reference
            return self._derivative

    return Called
