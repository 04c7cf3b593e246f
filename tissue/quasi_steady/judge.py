"""Local minima of the energy over the feasible states, by Ipopt (CasADi): the judge of other minimisers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import casadi
import numpy as np

from dincl.checks import number
from dincl.neighbours.search import neighbour_pairs
from dincl.rows.base import StackedRows
from dincl.rows.distance import DistanceRows
from dincl.status import Status
from tissue.kernels.workspace import SOFT
from tissue.model import bending, junctions, repulsion, springs
from tissue.model.energy import energy, forces
from tissue.quasi_steady.frozen import cells_at, constraints, of_a_frame, particles
from tissue.state.cells import CellLayers, Cells, Floats, Integers
from tissue.state.numbers import Numbers

Ends = tuple[Integers, Integers]

# How far a disc reaches beyond its radius when pairs are listed [R_soft], and how often the lists may be completed.
SEARCH_RADIUS, MOST_ROUNDS = 0.5, 20
# Tolerance of grad W - J^T multipliers; with less, searches that end at the kink of W stop for want of digits of W.
SLOPE = 1e-10
# Tolerance of gaps and of multipliers times gaps: min(multiplier, gap) is its root where both are small.
GAP = 1e-12
OPTIONS: dict[str, Any] = {
    "print_time": False,
    "error_on_fail": False,
    "show_eval_warnings": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.max_iter": 1000,
    "ipopt.tol": SLOPE,
    "ipopt.dual_inf_tol": SLOPE,
    "ipopt.constr_viol_tol": GAP,
    "ipopt.compl_inf_tol": GAP,
    # Without these, Ipopt answers for a slightly larger set, accepts less than asked for, and rescales the energy.
    "ipopt.bound_relax_factor": 0.0,
    "ipopt.acceptable_iter": 0,
    "ipopt.nlp_scaling_method": "none",
}
# Weights of the barrier that searches begin with, one after another until one succeeds. A small one keeps the search
# near its start: of 120 minima with noise of 0.01 all were found again, with weight 0.1 all but one. A search that is
# led into a corner, which happened in 6 of 220 tissues with points anywhere, finds another way with another weight.
BARRIERS = (1e-6, 1e-4, 1e-2, 1e-1)
SOLVED = "Solve_Succeeded"
# Words after which the point may be good enough, which its residuals decide.
ENDED = (SOLVED, "Solved_To_Acceptable_Level", "Search_Direction_Becomes_Too_Small")


@dataclass(frozen=True, eq=False, repr=False)
class JudgedMinimum:
    """Cells and multipliers >= 0 with, up to the residuals, grad W = J^T multipliers, g >= 0, multipliers . g = 0.

    Attributes
    ----------
    cells
        The given ones with new positions.
    energy
        W there.
    status, detail
        SUCCESS if no residual is above ``tol``, else NOT_CONVERGED, and the particulars in words.
    rows, multipliers
        The g listed, on the particles of ``frozen_problem``: (C1), (C4), (C2) in this order; and the multiplier of
        each, shape (m,) [1 / R_soft]. The other g have none.
    stationarity, violation, complementarity
        max |grad W - J^T multipliers| over the free coordinates, max_k max(0, -g_k) over all constraints,
        max_k |min(multipliers_k, g_k)|: from ``forces`` and ``constraints``, given Ipopt's positions and multipliers.
    iterations, starts
        Of Ipopt in all, and how often it was started.
    """

    cells: Cells
    energy: float
    status: Status
    detail: str
    rows: StackedRows
    multipliers: Floats
    stationarity: float
    violation: float
    complementarity: float
    iterations: int
    starts: int

    @property
    def residual(self) -> float:
        """The largest of the three residuals."""
        return max(self.stationarity, self.violation, self.complementarity)

    def __repr__(self) -> str:
        return f"Minimum(W = {self.energy:.9g}, {self.status.name}, residual = {self.residual:.2g})"


def local_minimum(cells: Cells, layers: CellLayers, numbers: Numbers, tol: float) -> JudgedMinimum:
    r"""Return a local minimum of W over S near the given state:  argmin over Z in S of W(Z).

    Source: section 2.2.8 of chapter 3.

    Unknown are all coordinates but the y of the basal layer. Moving a tissue along the line changes neither W nor S;
    the sum of all x is kept, as the motion (section 3.2 of chapter 3) keeps it. Pairs of nuclei enter when they are
    near. When others turn out near at the minimum, it is searched again from there, until no pair is missing.

    The start may violate (C1), (C2), (C4), as after a division. W has many local minima: from random starts of 60 cells
    those found differ by 0.5 %, and which it is depends on the path of the search. So judge the result of another
    method by starting from it: the search stays at a minimum that is not too shallow, else it says how far down one is.

    At |X_i - X_j| = 2 the second derivatives of W jump by k_xx along X_i - X_j; the first do not, so the conditions for
    a minimum and the line search stay as they are. Newton's steps take the second derivatives of one side, and are as
    fast as ever unless a pair ends just at 2. That happens to cells with room, which part until they do not overlap:
    one search in twenty then stalled at a residual of 1e-9 to 1e-6, and reached 1e-10 when taken up again.

    Parameters
    ----------
    cells, layers, numbers
        The start, and W and S: rest lengths, stiffnesses, radii, ``max_basal``.
    tol
        Greatest residual of the result: 1e-7 was met from all of 580 starts, 1e-8 from all but one.

    Returns
    -------
    Minimum
        With Status SUCCESS; or NOT_CONVERGED, and a state that proves nothing: the start, if Ipopt found no other.

    Raises
    ------
    InvalidProblem
        For a basal point of the layer off the line, or a state that has no forces.
    """
    number("tol", tol, positive=True)
    of_a_frame(cells, layers, numbers)
    forces(cells, layers, numbers)
    sets = constraints(cells, layers, numbers)
    found, (i, j) = _search(cells, layers, numbers)
    at = cells_at(found.x, cells, layers)
    discs = DistanceRows(i, j, cells.radius[i] + cells.radius[j], 1.0)
    rows = StackedRows((discs, *(family.select(found.x, math.inf) for family in sets[1:])), found.x.size)
    gradient = -particles(forces(at, layers, numbers)).ravel()
    misfit = gradient - found.multipliers @ rows.jacobian(found.x)
    stationarity = float(np.abs(misfit[_free(cells, layers)]).max())
    violation = max(float(np.max(-family.select(found.x, 0.0).values(found.x), initial=0.0)) for family in sets)
    complementarity = float(np.max(np.abs(np.minimum(found.multipliers, rows.values(found.x))), initial=0.0))
    residual = max(stationarity, violation, complementarity)
    reached = residual <= tol
    return JudgedMinimum(
        cells=at,
        energy=float(energy(at, layers, numbers)),
        status=Status.SUCCESS if reached else Status.NOT_CONVERGED,
        detail="" if reached else f"The residual is {residual:.2g}, asked for was {tol:g}; Ipopt said {found.word}.",
        rows=rows,
        multipliers=found.multipliers,
        stationarity=stationarity,
        violation=violation,
        complementarity=complementarity,
        iterations=found.iterations,
        starts=found.starts,
    )


class _Found(NamedTuple):
    """Particles (3n, 2), multipliers of the rows (m,), Ipopt's iterations, starts and last word so far."""

    x: Floats
    multipliers: Floats
    iterations: int
    starts: int
    word: str


def _search(cells: Cells, layers: CellLayers, numbers: Numbers) -> tuple[_Found, Ends]:
    """Solve programs with more and more pairs until one has all that it meets, or fails; and its pairs of (C1)."""
    n = len(cells.x)
    found = _Found(particles(cells), np.zeros(0), 0, 0, "")
    soft, hard = _Pairs(np.full(n, SOFT / 2)), _Pairs(cells.radius)
    for _ in range(MOST_ROUNDS):
        soft.add(found.x[:n])
        hard.add(found.x[:n])
        program = _Program(cells, layers, numbers, soft.ends(), hard.ends())
        found = program.best(found)
        if found.word not in ENDED or (soft.complete(found.x[:n]) and hard.complete(found.x[:n])):
            break
    return found, hard.ends()


def _free(cells: Cells, layers: CellLayers) -> Integers:
    """Return the coordinates of the particles (3n, 2), flattened, that may change: not y in the basal layer  (C3)."""
    n = len(cells.x)
    return np.delete(np.arange(6 * n), 2 * (2 * n + layers.basal) + 1)


class _Pairs:
    """Pairs (i, j < i) of discs that may come together: a list that only grows."""

    def __init__(self, radius: Floats) -> None:
        self._radius = radius
        self._codes: Integers = np.zeros(0, dtype=np.int64)

    def add(self, x: Floats) -> None:
        """Take the pairs within SEARCH_RADIUS around x (n, 2) into the list."""
        self._codes = np.union1d(self._codes, self._near(x, SEARCH_RADIUS))

    def complete(self, x: Floats) -> bool:
        """Return whether all pairs that overlap at x (n, 2) are in the list."""
        return bool(np.isin(self._near(x, 0.0), self._codes).all())

    def ends(self) -> Ends:
        """i and j, each of shape (m,)."""
        i, j = np.divmod(self._codes, len(self._radius))
        return i, j

    def _near(self, x: Floats, margin: float) -> Integers:
        start, partner = neighbour_pairs(np.ascontiguousarray(x), self._radius + margin)
        codes: Integers = np.repeat(np.arange(len(x)), np.diff(start)) * len(x) + partner
        return codes


class _Program:
    """min W, subject to the gaps of the ``hard`` pairs, the basal layer, and the sum of all x; compiled once.

    Vectors over cells and pairs stay single nodes of the expressions: with exact second derivatives, 60 cells are
    compiled in 0.1 s, where scalar expressions take 1 s and are evaluated no faster. ``soft`` pairs may repel.
    """

    def __init__(self, cells: Cells, layers: CellLayers, numbers: Numbers, soft: Ends, hard: Ends) -> None:
        n = len(cells.x)
        self._free = _free(cells, layers)
        z = casadi.MX.sym("z", len(self._free))
        points = casadi.MX.zeros(6 * n)
        points[self._free.tolist()] = z
        x, a, b = casadi.horzsplit(casadi.reshape(points, 2, 3 * n), n)
        gaps = _lengths(x, hard) - _row(cells.radius[hard[0]] + cells.radius[hard[1]])
        steps = _arrows(b[0, :], (layers.basal[:-1], layers.basal[1:]))
        along = casadi.sum2((x + a + b)[0, :])
        w = _cell_energy(cells, numbers, x, a, b) + _pair_energy(cells, layers, numbers, x, a, soft)
        self._program = {"x": z, "f": w, "g": casadi.horzcat(gaps, steps, along).T}
        self._high = np.repeat([math.inf, numbers.max_basal], [gaps.numel(), steps.numel()])
        self._discs = gaps.numel()

    def best(self, start: _Found) -> _Found:
        """Return the first search that succeeds, or all of them, each from where the one before ended."""
        found = start._replace(multipliers=np.zeros(2 * len(self._high) - self._discs))
        for barrier in BARRIERS:
            found = self._searched(found, barrier)
            if found.word == SOLVED:
                break
        return found

    def _searched(self, before: _Found, barrier: float) -> _Found:
        solver: Any = casadi.nlpsol("minimum", "ipopt", self._program, OPTIONS | {"ipopt.mu_init": barrier})
        along = before.x[:, 0].sum()
        low, high = np.append(np.zeros_like(self._high), along), np.append(self._high, along)
        answer = solver(x0=before.x.ravel()[self._free], lbg=low, ubg=high)
        stats = solver.stats()
        word, iterations = str(stats["return_status"]), before.iterations + int(stats["iter_count"])
        if word not in ENDED:
            return before._replace(iterations=iterations, starts=before.starts + 1, word=word)
        x = before.x.copy()
        x.reshape(-1)[self._free] = np.array(answer["x"]).ravel()
        # CasADi gives multipliers <= 0 to lower bounds, >= 0 to upper ones.
        signed = np.array(answer["lam_g"]).ravel()[:-1]
        multipliers = np.maximum(np.concatenate((-signed, signed[self._discs :])), 0.0)
        return _Found(x, multipliers, iterations, before.starts + 1, word)


def _cell_energy(cells: Cells, numbers: Numbers, x: Any, a: Any, b: Any) -> Any:
    """(3.9), (3.10), (3.12), for symbols x, a, b of shape (2, n)."""
    d_ax, d_bx, power = _norms(a - x), _norms(b - x), numbers.power
    cosine = casadi.sum1((a - x) * (b - x)) / (d_ax * d_bx)
    each = springs.energy(d_ax, _row(1 + cells.rest_ax), _row(cells.stiff_ax), power)
    each += springs.energy(d_bx, _row(1 + cells.rest_bx), _row(cells.stiff_bx), power)
    return casadi.sum2(each + bending.energy(cosine, _row(cells.stiff_axb)))


def _pair_energy(cells: Cells, layers: CellLayers, numbers: Numbers, x: Any, a: Any, soft: Ends) -> Any:
    """(3.11) and, of the pairs ``soft``, (3.13)."""
    ends = junctions.pairs(cells, layers, closed=False)
    stiffness = _row(junctions.stiffness(cells, ends, numbers.junction_factor))
    apical = junctions.energy(_lengths(a, ends), _row(cells.rest_aa[ends[0]]), stiffness)
    nuclei = repulsion.energy(casadi.fmin(SOFT, _lengths(x, soft)), numbers.repulsion)
    return casadi.sum2(apical) + casadi.sum2(nuclei)


def _arrows(points: Any, ends: Ends) -> Any:
    """Return the arrows from the first ends to the second ones, one column each."""
    return points[:, ends[1].tolist()] - points[:, ends[0].tolist()]


def _lengths(points: Any, ends: Ends) -> Any:
    return _norms(_arrows(points, ends))


def _norms(arrows: Any) -> Any:
    return casadi.sqrt(casadi.sum1(arrows * arrows))


def _row(values: Floats) -> Any:
    return casadi.DM(values).T
