"""Nearest points by quadratic programs, and the libraries that solve these programs."""

from __future__ import annotations

import warnings
from abc import abstractmethod
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, TypeVar

import numpy as np

from dincl.errors import StepFailure
from dincl.extras import needs
from dincl.matrices import combined, divided, from_rows, row_squares
from dincl.norms import length as norm
from dincl.projection.certificate import NEGLIGIBLE, Projected, Projection, Solver, missed, row_lengths
from dincl.rows.kinds import AffineRows, linearised
from dincl.status import Status

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from dincl.compiled.arrays import Floats
    from dincl.rows.base import Rows

Program = TypeVar("Program")
# Iterations end when all points of a set are proved to be this many times the largest violation away.
FARTHEST = 1e8
# Linearisations for one projection onto a curved set: ten digits where each shortens the error by a tenth.
MOST_LINEARISATIONS = 200
# A step shows the curvature of a row if the square of its part across the gradient is more than this share of its own.
ACROSS = 1e-8


class QpAnswer(NamedTuple):
    """Solution u (n,), multipliers (m,) >= 0 and iterations of a least-distance program."""

    u: Floats
    multipliers: Floats
    iterations: int


class QpSolver(Solver):
    """Projects onto polyhedra, and onto curved sets by linearising again at the point reached, for the same y.

    A back end sees each program in the displacement u = (z - y) / s, with rows of unit length and the largest
    violation s, so that its tolerances are relative to the move and not to the coordinates.
    """

    def compute(self, rows: Rows, y: Floats, guess: Floats, multipliers: Floats) -> Projected:
        """Solve one program for affine rows, else a sequence of programs that know the curvature of the set.

        A program in coordinates that are ``root`` times those of z has the Hessian D = root^2, see ``_hessian``.
        """
        flat = all(block.affine for block in rows.by_kind())
        x, linear = guess.ravel(), linearised(rows, guess)
        target, root, work, bent = y.ravel(), np.ones(y.size), 0, 1.0
        for _ in range(1 if flat else MOST_LINEARISATIONS):
            move, multipliers, iterations = self._program(linear, target, root, multipliers)
            z, work = target + move, work + iterations
            now = linearised(rows, z.reshape(y.shape))
            found = self.certify(now, y, z.reshape(y.shape), multipliers, work)
            if flat or found.residual <= self.tol:
                return found
            hessian = _hessian(linear.matrix, now.matrix, z - x, multipliers)
            target, root, bent = z + (y.ravel() - z) / hessian, np.sqrt(hessian), max(bent, float(hessian.max()))
            x, linear = z, now
        raise missed(self.name, found.residual, self.tol, bent - 1.0, float(np.abs(y).max()))

    def _program(
        self, linear: AffineRows, target: Floats, root: Floats, multipliers: Floats
    ) -> tuple[Floats, Floats, int]:
        """Find the move v with the least |root v| so that target + v meets the rows, its multipliers, and the work."""
        scaled, tol = linear.matrix, self.tol / float(root.max())
        if tol != self.tol:
            scaled = from_rows(scaled.indptr, scaled.indices, scaled.data / root[scaled.indices], scaled.shape[1])
        length, relative = row_lengths(scaled), AffineRows(scaled, -linear.values(target))
        found = self._solve(
            divided(scaled, length),
            relative.bound / length,
            multipliers * length,
            tol / max(1.0, float(length.max(initial=1.0))),
        )
        # The back end misses the tolerance where an interior point leaves a duality gap eps, and so sqrt(eps) in the
        # point, where rows are longer than the largest violation, and where they are so short that multipliers are
        # long.
        origin = np.zeros((len(target), 1))
        certified = self.certify(relative, origin, found.u[:, None], found.multipliers / length, found.iterations)
        done = self.completed(relative, origin, certified, tol)
        return done.point.ravel() / root, done.multipliers, done.iterations

    def _solve(self, matrix: csr_array, missing: Floats, multipliers: Floats, tol: float) -> QpAnswer:
        """min 1/2 |u|^2 s.t. matrix u >= missing, to the residual ``tol``, for rows of length 1 or 0."""
        scale = float(missing.max(initial=0.0))
        if scale <= NEGLIGIBLE * tol:
            return QpAnswer(np.zeros(matrix.shape[1]), np.zeros(len(missing)), 0)
        if ((row_squares(matrix) == 0) & (missing > 0)).any():
            raise StepFailure(Status.NOT_CONVERGED, "A violated constraint has the gradient zero.")
        near = float(multipliers.max(initial=0.0)) <= FARTHEST * scale
        start = multipliers / scale if near else np.zeros(len(missing))
        found = self.qp(matrix, missing / scale, start, tol / scale)
        return QpAnswer(scale * found.u, scale * found.multipliers, found.iterations)

    @abstractmethod
    def qp(self, matrix: csr_array, least: Floats, multipliers: Floats, tol: float) -> QpAnswer:
        """min 1/2 |u|^2 s.t. matrix u >= least, to the residual ``tol``, from the multipliers of a similar program.

        Rows of ``matrix`` (m, n) have length 1 (or 0), max ``least`` = 1; the solution obeys u = matrix^T multipliers.
        StepFailure(NOT_CONVERGED) when the back end gives up, for whatever reason.
        """


def _hessian(before: csr_array, now: csr_array, step: Floats, multipliers: Floats) -> Floats:
    """Compute the diagonal D (n,) of the next program, from the gradients before and after a step.

    ``dincl.steps.programs.bend`` is the same in compiled code, and derives it.
    """
    lengths = row_lengths(now)
    along = (now @ step) / lengths
    turn = (before @ step) / row_lengths(before) - along
    pattern = from_rows(now.indptr, now.indices, (now.data != 0.0).astype(float), now.shape[1])
    square = pattern @ step**2
    across = square - along**2
    bent = (multipliers > 0) & (turn > 0) & (across > ACROSS * square)
    weights = np.where(bent, multipliers * lengths * turn / np.where(bent, across, 1.0), 0.0)
    return 1.0 + combined(pattern, weights)


def stop_if_suspected(matrix: csr_array, least: Floats, weights: Floats) -> None:
    """StepFailure if ``weights`` (m,) >= 0 show that all u with A u >= least are far away: iterations would not end.

    Any such u has |u| >= least . weights / |A^T weights|; of an empty set, multipliers grow towards such weights.
    """
    if float(least @ weights) > FARTHEST * norm(combined(matrix, weights)):
        detail = f"All points that meet the constraints are more than {FARTHEST:g} violations away."
        raise StepFailure(Status.NOT_CONVERGED, detail)


# The libraries: each function imports one and returns (A, least, multipliers) -> solution of
# min 1/2 |u|^2 s.t. A u >= least.

# Residuals and duality gaps of interior points, in units of the largest violation and of its square.
TOLERANCE = 1e-12
# The same relative to the numbers in the sums: a few of their roundings, which no answer can beat.
RELATIVE = 1e-13
# What Clarabel may call almost solved: the certificate, not this word, decides whether the point is good enough.
REDUCED_TOLERANCE = 1e-9
# Clarabel's own 1e-8 stops it short of TOLERANCE in degenerate piles ("InsufficientProgress"); the identity in the cost
# needs no more than this.
REGULARISATION = 1e-10
PIQP_ITERATIONS = 250
# Greatest violation of a row of unit length, in units of the largest violation of y. Below 1e-13 rounding decides.
PRIMAL_TOLERANCE = 1e-13
DAQP_ITERATIONS = 10_000
DAQP_MEANINGS = {
    -1: "it finds no point that meets all constraints",
    -2: "the active set cycles",
    -3: "the program is unbounded",
    -4: f"the limit of {DAQP_ITERATIONS} iterations is reached",
    -5: "the cost is not convex",
    -6: "the active set at the start is overdetermined",
}
# Programs that CVXPY has canonicalised, kept for the next time that rows tie the same coordinates.
MOST_PROGRAMS = 16


def _stopped(name: str, why: object) -> StepFailure:
    return StepFailure(Status.NOT_CONVERGED, f"{name} stopped: {why}.")


def _daqp() -> Callable[..., QpAnswer]:
    import daqp

    def solve(matrix: csr_array, least: Floats, multipliers: Floats) -> QpAnswer:
        """Solve -A u <= -least: DAQP takes active rows at the start to be at their upper bound; it changes arrays."""
        n, start = matrix.shape[1], (multipliers > 0).astype(np.int32)
        options = {"primal_tol": PRIMAL_TOLERANCE, "iter_limit": DAQP_ITERATIONS}
        u, _, flag, info = daqp.solve(np.eye(n), np.zeros(n), -matrix.toarray(), -least, None, start, **options)
        if flag < 0:
            raise _stopped("daqp", DAQP_MEANINGS.get(flag, f"flag {flag}"))
        return QpAnswer(u, np.maximum(info["lam"], 0.0), int(info["iterations"]))

    return solve


def _piqp() -> Callable[..., QpAnswer]:
    with needs("Piqp", "yardsticks"):
        import piqp
    from scipy.sparse import csc_matrix, eye_array

    def solve(matrix: csr_array, least: Floats, multipliers: Any) -> QpAnswer:
        solver: Any = piqp.SparseSolver()
        settings = solver.settings
        settings.max_iter = PIQP_ITERATIONS
        settings.eps_abs = settings.eps_duality_gap_abs = TOLERANCE
        settings.eps_rel = settings.eps_duality_gap_rel = RELATIVE
        n = matrix.shape[1]
        solver.setup(csc_matrix(eye_array(n)), np.zeros(n), G=csc_matrix(matrix), h_l=least)
        flag = solver.solve()
        if flag != piqp.PIQP_SOLVED:
            raise _stopped("piqp", flag.name)
        found = solver.result
        return QpAnswer(np.array(found.x), np.maximum(found.z_l, 0.0), int(found.info.iter))

    return solve


def _clarabel() -> Callable[..., QpAnswer]:
    with needs("Clarabel", "yardsticks"):
        import clarabel
    from scipy.sparse import eye_array

    settings: Any = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    settings.static_regularization_constant = REGULARISATION
    settings.reduced_tol_feas = settings.reduced_tol_gap_abs = settings.reduced_tol_gap_rel = REDUCED_TOLERANCE

    def solve(matrix: csr_array, least: Floats, multipliers: Any) -> QpAnswer:
        """Solve with -A u + s = -least, s >= 0."""
        settings.tol_feas = settings.tol_gap_abs = settings.tol_gap_rel = TOLERANCE
        m, n = matrix.shape
        cone: Any = [clarabel.NonnegativeConeT(m)]
        program = eye_array(n, format="csc"), np.zeros(n), (-matrix).tocsc(), -least
        found: Any = clarabel.DefaultSolver(*program, cone, settings).solve()
        if str(found.status) not in ("Solved", "AlmostSolved", "InsufficientProgress"):  # the certificate decides
            raise _stopped("clarabel", found.status)
        return QpAnswer(np.array(found.x), np.maximum(found.z, 0.0), found.iterations)

    return solve


def _cvxpy() -> Callable[..., QpAnswer]:
    with needs("CvxpyQP", "yardsticks"):
        import cvxpy
    library: Any = cvxpy
    programs: dict[Hashable, Any] = {}

    def canonicalised(matrix: csr_array) -> tuple[Any, ...]:
        """Write A u as a sum over entries, a_kl u_l: the pattern is data, and no dense parameter is needed."""
        entries = len(matrix.data)
        summing = from_rows(matrix.indptr, np.arange(entries), np.ones(entries), entries)
        u, data, least = (
            library.Variable(matrix.shape[1]),
            library.Parameter(entries),
            library.Parameter(matrix.shape[0]),
        )
        rows = summing @ library.multiply(data, u[matrix.indices]) >= least
        return library.Problem(library.Minimize(library.sum_squares(u) / 2), [rows]), u, data, least, rows

    def solve(matrix: csr_array, least: Floats, multipliers: Any) -> QpAnswer:
        key = (matrix.indptr.tobytes(), matrix.indices.tobytes())
        problem, u, data, right, rows = remembered(programs, key, lambda: canonicalised(matrix), MOST_PROGRAMS)
        data.value, right.value = matrix.data, least
        try:
            with warnings.catch_warnings():
                # CVXPY warns of an answer that Clarabel calls almost solved; here the certificate decides.
                warnings.simplefilter("ignore", UserWarning)
                options = dict.fromkeys(("tol_feas", "tol_gap_abs", "tol_gap_rel"), TOLERANCE)
                options |= {"static_regularization_constant": REGULARISATION, "max_threads": 1}
                problem.solve(solver=library.CLARABEL, **options)
        except library.error.SolverError as error:
            raise _stopped("cvxpy", error) from error
        if problem.status not in ("optimal", "optimal_inaccurate"):
            raise _stopped("cvxpy", problem.status)
        return QpAnswer(u.value, np.maximum(rows.dual_value, 0.0), int(problem.solver_stats.num_iters))

    return solve


def remembered(programs: dict[Hashable, Program], key: Hashable, make: Callable[[], Program], most: int) -> Program:
    """Return the program of a key, made if it is new; of more than ``most`` the least recently used is dropped."""
    programs[key] = programs.pop(key) if key in programs else make()
    if len(programs) > most:
        del programs[next(iter(programs))]
    return programs[key]


class _LibrarySolver(QpSolver):
    """Solves programs by a library, which is imported when the solver is made."""

    def __init__(self, tol: float, name: str, library: Callable[..., QpAnswer]) -> None:
        super().__init__(tol)
        self.name, self._library = name, library

    def qp(self, matrix: csr_array, least: Floats, multipliers: Floats, tol: float) -> QpAnswer:
        return self._library(matrix, least, multipliers)


@dataclass(frozen=True)
class _Library(Projection):
    """Nearest points by a library that solves quadratic programs."""

    name: ClassVar[str]
    _load: ClassVar[Callable[[], Callable[..., QpAnswer]]]

    def solver(self) -> Solver:
        return _LibrarySolver(self.tol, self.name, type(self)._load())


@dataclass(frozen=True)
class Daqp(_Library):
    """Nearest points by DAQP (Arnstroem, Bemporad, Axehill 2022), a dense active-set method: best up to 30 particles.

    Set are its primal tolerance, to 1e-13 of the largest violation, and the active rows of the last solve for a start.

    Parameters
    ----------
    tol
        Greatest certified residual of a projection [length].
    """

    name, _load = "daqp", staticmethod(_daqp)


@dataclass(frozen=True)
class Piqp(_Library):
    """Nearest points by PIQP (Schwan, Jiang, Kuhn, Jones 2023), a sparse proximal interior-point method.

    Set are all tolerances, that on the duality gap included, to 1e-12 of the largest violation. There is no start from
    an earlier solution.

    Parameters
    ----------
    tol
        Greatest certified residual of a projection [length].
    """

    name, _load = "piqp", staticmethod(_piqp)


@dataclass(frozen=True)
class Clarabel(_Library):
    """Nearest points by Clarabel (Goulart, Chen 2024), a sparse interior-point method, single-threaded.

    Set are all tolerances, that on the duality gap included, to 1e-12 of the largest violation, and a smaller
    regularisation, without which it stops short of them.

    Parameters
    ----------
    tol
        Greatest certified residual of a projection [length].
    """

    name, _load = "clarabel", staticmethod(_clarabel)


@dataclass(frozen=True)
class CvxpyQP(_Library):
    """Nearest points by CVXPY with Clarabel inside: min |u|^2 subject to A u >= least, canonicalised once, re-solved.

    The judge of the others, not for hot loops: the first solve for rows that tie other coordinates takes up to 30 times
    as long as the next one. Clarabel has the settings of ``Clarabel``.

    Parameters
    ----------
    tol
        Greatest certified residual of a projection [length].
    """

    name, _load = "cvxpy", staticmethod(_cvxpy)
