"""Local minima of the energy over the feasible states, by Ipopt: the judge of other minimisers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dincl.checks import number
from dincl.neighbours.search import neighbour_pairs
from dincl.rows.base import StackedRows
from dincl.rows.distance import DistanceRows
from dincl.status import Status
from tissue.kernels.workspace import SOFT
from tissue.model.energy import energy, forces
from tissue.state.cells import CellLayers, Cells, Floats, Integers
from tissue.state.numbers import Numbers
from verification.thesis.quasi_steady.frozen import cells_at, constraints, of_a_frame, particles
from verification.thesis.quasi_steady.program import ENDED, Ends, EnergyProgram, SearchResult, free_coordinates

# How far a disc reaches beyond its radius when pairs are listed [R_soft], and how often the lists may be completed.
SEARCH_RADIUS, MOST_ROUNDS = 0.5, 20


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
        The start, and W and S: rest lengths, stiffnesses, radii, ``max_basal_distance``.
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
    stationarity = float(np.abs(misfit[free_coordinates(cells, layers)]).max())
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


def _search(cells: Cells, layers: CellLayers, numbers: Numbers) -> tuple[SearchResult, Ends]:
    """Solve programs with more and more pairs until one has all that it meets, or fails; and its pairs of (C1)."""
    n = len(cells.x)
    found = SearchResult(particles(cells), np.zeros(0), 0, 0, "")
    soft, hard = _Pairs(np.full(n, SOFT / 2)), _Pairs(cells.radius)
    for _ in range(MOST_ROUNDS):
        soft.add(found.x[:n])
        hard.add(found.x[:n])
        program = EnergyProgram(cells, layers, numbers, soft.ends(), hard.ends())
        found = program.best(found)
        if found.word not in ENDED or (soft.complete(found.x[:n]) and hard.complete(found.x[:n])):
            break
    return found, hard.ends()


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
