"""The quasi-steady model as a nonlinear program: the energy and its constraints by CasADi, solved by Ipopt."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import casadi
import numpy as np

from tissue.kernels.workspace import SOFT
from tissue.model import bending, junctions, repulsion, springs
from tissue.state.cells import CellLayers, Cells, Floats, Integers
from tissue.state.numbers import Numbers

Ends = tuple[Integers, Integers]

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


class SearchResult(NamedTuple):
    """Particles (3n, 2), multipliers of the rows (m,), Ipopt's iterations, starts and last word so far."""

    x: Floats
    multipliers: Floats
    iterations: int
    starts: int
    word: str


def free_coordinates(cells: Cells, layers: CellLayers) -> Integers:
    """Return the coordinates of the particles (3n, 2), flattened, that may change: not y in the basal layer  (C3)."""
    n = len(cells.x)
    return np.delete(np.arange(6 * n), 2 * (2 * n + layers.basal) + 1)


class EnergyProgram:
    """min W, subject to the gaps of the ``hard`` pairs, the basal layer, and the sum of all x; compiled once.

    Vectors over cells and pairs stay single nodes of the expressions: with exact second derivatives, 60 cells are
    compiled in 0.1 s, where scalar expressions take 1 s and are evaluated no faster. ``soft`` pairs may repel.
    """

    def __init__(self, cells: Cells, layers: CellLayers, numbers: Numbers, soft: Ends, hard: Ends) -> None:
        n = len(cells.x)
        self._free = free_coordinates(cells, layers)
        z = casadi.MX.sym("z", len(self._free))
        points = casadi.MX.zeros(6 * n)
        points[self._free.tolist()] = z
        x, a, b = casadi.horzsplit(casadi.reshape(points, 2, 3 * n), n)
        gaps = _lengths(x, hard) - _row(cells.radius[hard[0]] + cells.radius[hard[1]])
        steps = _arrows(b[0, :], (layers.basal[:-1], layers.basal[1:]))
        along = casadi.sum2((x + a + b)[0, :])
        w = _cell_energy(cells, numbers, x, a, b) + _pair_energy(cells, layers, numbers, x, a, soft)
        self._program = {"x": z, "f": w, "g": casadi.horzcat(gaps, steps, along).T}
        self._high = np.repeat([math.inf, numbers.max_basal_distance], [gaps.numel(), steps.numel()])
        self._discs = gaps.numel()

    def best(self, start: SearchResult) -> SearchResult:
        """Return the first search that succeeds, or all of them, each from where the one before ended."""
        found = start._replace(multipliers=np.zeros(2 * len(self._high) - self._discs))
        for barrier in BARRIERS:
            found = self._searched(found, barrier)
            if found.word == SOLVED:
                break
        return found

    def _searched(self, before: SearchResult, barrier: float) -> SearchResult:
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
        return SearchResult(x, multipliers, iterations, before.starts + 1, word)


def _cell_energy(cells: Cells, numbers: Numbers, x: Any, a: Any, b: Any) -> Any:
    """(3.9), (3.10), (3.12), for symbols x, a, b of shape (2, n)."""
    d_ax, d_bx, power = _norms(a - x), _norms(b - x), numbers.spring_power
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
