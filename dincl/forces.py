"""Contact forces: the multipliers of the rows that touch, and the forces they exert."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import integer
from dincl.constraints.selection import select
from dincl.extras import needs
from dincl.matrices import combined, row_squares

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from pandas import DataFrame
    from scipy.sparse import csr_array

    from dincl.problem import Problem
    from dincl.rows.base import Rows

# Rows whose gap is at most this part of the largest coordinate touch, also without a force.
TOUCHING = 1e-9


class Reaction(NamedTuple):
    """x' - F, shape (N d,), at the state x (N, d) of time t.

    Rows matter that can be violated after each particle moved by ``search_radius``. Of second-order schemes it is
    x'' - F.
    """

    t: float
    x: NDArray[np.float64]
    value: NDArray[np.float64]
    search_radius: float
    second_order: bool = False

    def rows(self, problem: Problem) -> Rows:
        """Select the rows near x."""
        return problem.rows_within(self.t, self.x, self.search_radius)


@dataclass(frozen=True, eq=False, repr=False)
class Forces:
    """Contact forces at one time: x' = F + sum_k multiplier_k grad g_k(x), with m rows in contact.

    Attributes
    ----------
    t
        Time of the state at which rows are evaluated; of time steps the end of the step.
    constraint
        Index of the constraint of each row in the problem, shape (m,).
    row
        Each row in words, e.g. "particle 3 and 1".
    particles
        The particles of each row.
    gap
        g_k, shape (m,).
    multiplier
        Shape (m,), >= 0: the force between two discs, or of a wall on a disc, in units of F.
    gradients
        grad g_k, m rows and N*d columns.
    shape
        (N, d).
    """

    t: float
    constraint: NDArray[np.int64]
    row: tuple[str, ...]
    particles: tuple[tuple[int, ...], ...]
    gap: NDArray[np.float64]
    multiplier: NDArray[np.float64]
    gradients: csr_array
    shape: tuple[int, int]

    @property
    def force(self) -> NDArray[np.float64]:
        """sum_k multiplier_k grad g_k: the force of all contacts on each particle, shape (N, d)."""
        return combined(self.gradients, self.multiplier).reshape(self.shape)

    def load(self, constraint: int) -> NDArray[np.float64]:
        """Return the total force of a constraint on all particles, shape (d,); a wall bears its negative.

        Zero for constraints between particles, whose forces are opposite. Raises InvalidProblem unless ``constraint``
        is an integer >= 0.
        """
        chosen = self.constraint == integer("constraint", constraint, least=0)
        total: NDArray[np.float64] = combined(self.gradients, self.multiplier * chosen).reshape(self.shape).sum(axis=0)
        return total

    def to_frame(self) -> DataFrame:
        """Return a pandas table with a row per contact: t, constraint, row, particles, gap, multiplier."""
        with needs("to_frame", "report"):
            import pandas as pd

        names = ("constraint", "row", "particles", "gap", "multiplier")
        return pd.DataFrame({"t": self.t, **{name: getattr(self, name) for name in names}})

    def __repr__(self) -> str:
        return f"Forces(t = {self.t:g}, {len(self.row)} contacts, N = {self.shape[0]}, d = {self.shape[1]})"


def contact_forces(problem: Problem, reaction: Reaction) -> Forces:
    """Compute the forces whose sum is nearest to a reaction; StepFailure where a gradient is not defined."""
    from dincl.projection.cone import shortest_multipliers

    t, x = reaction.t, reaction.x
    selection = select(problem.constraints, t, x, reaction.search_radius)
    rows = selection.at(t)
    gradients, gaps = rows.jacobian(x), rows.values(x)
    multiplier = shortest_multipliers(reaction.value, gradients)
    touching = gaps <= TOUCHING * float(np.abs(x).max()) * np.sqrt(row_squares(gradients))
    keep = np.flatnonzero((multiplier > 0) | touching)
    names, d = selection.names, x.shape[1]
    gradients = gradients[keep]
    columns = [gradients.indices[a:b][gradients.data[a:b] != 0] for a, b in zip(*_ends(gradients), strict=True)]
    return Forces(
        t=t,
        constraint=np.array([names[k][0] for k in keep], dtype=np.int64),
        row=tuple(names[k][1] for k in keep),
        particles=tuple(tuple(np.unique(one // d).tolist()) for one in columns),
        gap=gaps[keep],
        multiplier=multiplier[keep],
        gradients=gradients,
        shape=(len(x), d),
    )


def _ends(matrix: csr_array) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    return matrix.indptr[:-1], matrix.indptr[1:]
