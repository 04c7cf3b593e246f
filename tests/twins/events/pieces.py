"""The dense output of a run: one polynomial for each step, held on the contacts of its time."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.errors import StepFailure
from dincl.projection.cone import distance_to_cone
from dincl.trajectory import Between

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from tests.twins.events.held import Held


class DensePiece(NamedTuple):
    """x on (.., end]: a polynomial, t -> (N d,), and the contacts on which it is held."""

    end: float
    dense: Callable[[float], NDArray[np.float64]]
    held: Held


@dataclass(frozen=True, eq=False)
class Pieces(Between):
    """The pieces of a run, in the order of time; ``near`` is how close to closed a gap counts as a contact [length]."""

    problem: Problem
    near: float
    pieces: list[DensePiece] = field(default_factory=list)

    def states(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """The polynomials, moved back onto the contacts that are held."""
        return np.array([self._state(float(t)) for t in times])

    def residuals(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """With the velocity from before each time, or from after t = 0."""
        return np.array([self._residual(float(t)) for t in times])

    def _piece(self, t: float) -> DensePiece | None:
        place = bisect_left(self.pieces, t, key=lambda piece: piece.end)
        return self.pieces[min(place, len(self.pieces) - 1)] if self.pieces else None

    def _state(self, t: float) -> NDArray[np.float64]:
        piece = self._piece(t)
        if piece is None:
            return self.problem.x0
        return piece.held.corrected(t, piece.dense(t)).reshape(self.problem.x0.shape)

    def _residual(self, t: float) -> float:
        piece = self._piece(t)
        if piece is None:
            return np.inf
        try:
            x = self._state(t)
            reaction = piece.held.rate(t, x.ravel()) - self.problem.velocity(t, x).ravel()
            return distance_to_cone(reaction, self.problem.rows_within(t, x, self.near).jacobian(x))
        except StepFailure:
            return np.inf
