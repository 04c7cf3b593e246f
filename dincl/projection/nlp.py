"""The nonlinear program of a nearest point, compiled by CasADi for Ipopt; the only file that imports CasADi."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import casadi
import numpy as np

from dincl.errors import StepFailure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dincl.rows.base import Polynomial, RowsOfOneKind

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


class NlpAnswer(NamedTuple):
    """Point x (N, d), multipliers (m,) of g, iterations, and the word of Ipopt on how it ended."""

    x: NDArray[np.float64]
    multipliers: NDArray[np.float64]
    iterations: int
    word: str


class Program:
    """min 1/2 |w|^2 subject to the rows at x = y + scale w; all numbers in it are parameters, so it is compiled once.

    Rows that are polynomials enter as such, with their exact sparse derivatives. The others, such as those of a user's
    function, are called back; with them, second derivatives are approximated from the gradients met (limited memory).
    """

    def __init__(self, blocks: Sequence[RowsOfOneKind], shape: tuple[int, ...]) -> None:
        polynomials = [block.polynomial(np.zeros(shape), 1.0) for block in blocks]
        self._functions: dict[int, _Called] = {
            k: _Called(len(block), shape) for k, block in enumerate(blocks) if polynomials[k] is None
        }
        kind: Any = casadi.MX if self._functions else casadi.SX
        w = kind.sym("w", shape[0] * shape[1])
        rows: list[Any] = []
        parameters: list[Any] = []
        for k, polynomial in enumerate(polynomials):
            if polynomial is None:
                rows.append(self._functions[k](w))
            else:
                expression, numbers = _expression(kind, polynomial, w, shape)
                rows.append(expression)
                parameters += numbers
        program = {"x": w, "p": casadi.vertcat(*parameters), "f": casadi.dot(w, w) / 2, "g": casadi.vertcat(*rows)}
        options: Any = OPTIONS | (LIMITED_MEMORY if self._functions else {})
        self._solver: Any = casadi.nlpsol("nearest", "ipopt", program, options)

    def solve(
        self, blocks: Sequence[RowsOfOneKind], y: NDArray[np.float64], guess: NDArray[np.float64], scale: float
    ) -> NlpAnswer:
        """The program with the numbers of ``blocks`` around y, searched from ``guess``."""
        parameters = [np.zeros(0)]
        for k, block in enumerate(blocks):
            polynomial = block.polynomial(y, scale)
            if polynomial is None:
                self._functions[k].set(block, y, scale)
            else:
                # The numbers that _expression has symbols for, in the same order.
                parameters += [polynomial.constant, polynomial.linear.data, polynomial.weight]
        start = ((guess - y) / scale).ravel()
        found = self._solver(x0=start, p=np.concatenate(parameters), lbg=0.0, ubg=np.inf)
        for function in self._functions.values():
            if function.failure is not None:
                raise function.failure
        x = y + scale * np.array(found["x"]).reshape(y.shape)
        steep = np.concatenate([block.steepness(x) for block in blocks])
        # CasADi gives multipliers <= 0 to lower bounds.
        multipliers = np.maximum(-scale * np.array(found["lam_g"]).ravel() * steep, 0.0)
        stats = self._solver.stats()
        return NlpAnswer(x, multipliers, int(stats["iter_count"]), str(stats["return_status"]))


def _expression(kind: Any, polynomial: Polynomial, w: Any, shape: tuple[int, ...]) -> tuple[Any, list[Any]]:
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


class _Called(casadi.Callback):
    """w -> g(y + scale w) / scale for a user's g, whose numbers are set before each solve."""

    def __init__(self, rows: int, shape: tuple[int, ...]) -> None:
        casadi.Callback.__init__(self)
        self._rows, self._shape = rows, shape
        self._derivative: _CalledDerivative | None = None
        self.failure: StepFailure | None = None
        self.construct("g", {})

    def set(self, rows: RowsOfOneKind, y: NDArray[np.float64], scale: float) -> None:
        """Take these rows from now on."""
        self.current, self._y, self.scale, self.failure = rows, y, scale, None

    def at(self, w: Any) -> NDArray[np.float64]:
        """The point x for w."""
        return self._y + self.scale * np.array(w).reshape(self._shape)

    def get_sparsity_in(self, i: int) -> Any:
        return casadi.Sparsity.dense(self._shape[0] * self._shape[1], 1)

    def get_sparsity_out(self, i: int) -> Any:
        return casadi.Sparsity.dense(self._rows, 1)

    def eval(self, arguments: Any) -> Any:
        try:
            return [self.current.values(self.at(arguments[0])) / self.scale]
        except StepFailure as failure:
            self.failure = failure
            return [np.full(self._rows, np.nan)]

    def has_jacobian(self) -> bool:
        return True

    def get_jacobian(self, name: str, inputs: Any, outputs: Any, options: Any) -> Any:
        self._derivative = _CalledDerivative(name, self, self._rows, self._shape[0] * self._shape[1], options)
        return self._derivative


class _CalledDerivative(casadi.Callback):
    """(w, g) -> dg/dx at w, dense, since it is not known which entries are always zero."""

    def __init__(self, name: str, of: _Called, rows: int, columns: int, options: Any) -> None:
        casadi.Callback.__init__(self)
        self._of, self._rows, self._columns = of, rows, columns
        self.construct(name, options)

    def get_n_in(self) -> int:
        return 2

    def get_sparsity_in(self, i: int) -> Any:
        return casadi.Sparsity.dense(self._columns, 1) if i == 0 else casadi.Sparsity.dense(self._rows, 1)

    def get_sparsity_out(self, i: int) -> Any:
        return casadi.Sparsity.dense(self._rows, self._columns)

    def eval(self, arguments: Any) -> Any:
        try:
            return [self._of.current.jacobian(self._of.at(arguments[0])).toarray()]
        except StepFailure as failure:
            self._of.failure = failure
            return [np.full((self._rows, self._columns), np.nan)]
