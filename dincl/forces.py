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

    from dincl.compiled.arrays import Floats
    from dincl.problem import Problem

# Rows whose gap is at most this part of the largest coordinate touch, also without a force.
TOUCHING = 1e-9


class Reaction(NamedTuple):
    """x' - F, shape (N d,), at the state x (N, d) of time t, in the coordinates of a problem.

    Rows matter that can be violated after each particle moved by ``search_radius``. Of second-order schemes it is
    x'' - F.
    """

    problem: Problem
    t: float
    x: Floats
    value: Floats
    search_radius: float
    second_order: bool = False

    def gradients(self) -> csr_array:
        """Compute the gradients of the rows near x; StepFailure where one is not defined."""
        return self.problem.rows_within(self.t, self.x, self.search_radius).jacobian(self.x)


@dataclass(frozen=True, eq=False)
class Forces:
    """Contact forces at one time: x' = B (F + sum_k multiplier_k grad g_k(x)), with m rows in contact.

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
        Shape (m,), >= 0, of either sign for an equality: the force between two discs, or of a wall on a disc, in units
        of F.
    gradients
        grad g_k, m rows and N*d columns.
    shape
        (N, d).
    """

    t: float
    constraint: NDArray[np.int64]
    row: tuple[str, ...]
    particles: tuple[tuple[int, ...], ...]
    gap: Floats
    multiplier: Floats
    gradients: csr_array
    shape: tuple[int, int]

    @property
    def force(self) -> Floats:
        """sum_k multiplier_k grad g_k: the force of all contacts on each particle, shape (N, d)."""
        return combined(self.gradients, self.multiplier).reshape(self.shape)

    def load(self, constraint: int) -> Floats:
        """Return the total force of a constraint on all particles, shape (d,); a wall bears its negative.

        Zero for constraints between particles, whose forces are opposite. Raises InvalidProblem unless ``constraint``
        is an integer >= 0.
        """
        chosen = self.constraint == integer("constraint", constraint, least=0)
        total: Floats = combined(self.gradients, self.multiplier * chosen).reshape(self.shape).sum(axis=0)
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
    from dincl.geometry import shortest_multipliers

    t, x, scaling = reaction.t, reaction.x, reaction.problem.scaling
    x = x if scaling is None else scaling.positions(x)
    selection = select(problem.constraints, t, x, reaction.search_radius)
    rows, names, d = selection.at(t), selection.names, x.shape[1]
    gradients, gaps = rows.jacobian(x), rows.values(x)
    scaled = gradients if scaling is None else gradients.copy()
    if scaling is not None:
        scaled.data *= np.repeat(scaling.root, d)[scaled.indices]
    multiplier = shortest_multipliers(reaction.value, scaled)
    multiplier = multiplier if scaling is None else multiplier / scaling.most
    touching = gaps <= TOUCHING * float(np.abs(x).max()) * np.sqrt(row_squares(gradients))
    keep, first = (multiplier > 0) | touching, 0
    for block in rows.blocks:
        if block.equal:  # two rows that are opposite
            one, other = (slice(first + k * len(block) // 2, first + (k + 1) * len(block) // 2) for k in (0, 1))
            multiplier[one] -= multiplier[other]
            keep[one], keep[other] = True, False
        first += len(block)
    chosen = np.flatnonzero(keep)
    gradients = gradients[chosen]
    parts = np.split(np.where(gradients.data != 0, gradients.indices // d, -1), gradients.indptr[1:-1])
    return Forces(
        t=t,
        constraint=np.array([names[k][0] for k in chosen], dtype=np.int64),
        row=tuple(names[k][1] for k in chosen),
        particles=tuple(tuple(sorted(set(one.tolist()) - {-1})) for one in parts[: len(chosen)]),
        gap=gaps[chosen],
        multiplier=multiplier[chosen],
        gradients=gradients,
        shape=(len(x), d),
    )
