"""What finds the minima of the quasi-steady model, and what it gives back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from dincl.checks import number
from dincl.extras import needs
from dincl.status import Status
from tissue.state.cells import CellLayers, Cells
from tissue.state.numbers import Numbers


class Minimised(Protocol):
    """Where a minimiser ended.

    Attributes
    ----------
    cells
        The state, with all but the positions as given; after a failure the last one.
    energy
        W there  (3.14).
    violation
        By how much (C1), (C2) or (C4) is broken at most [R_soft].
    iterations
        How many were made.
    status, detail
        How it ended, and the particulars in words ("" on success).
    """

    @property
    def cells(self) -> Cells: ...
    @property
    def energy(self) -> float: ...
    @property
    def violation(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def status(self) -> Status: ...
    @property
    def detail(self) -> str: ...


class TissueMinimiser(Protocol):
    """A way to find a local minimum of W over S near a given state  (3.18)."""

    def minimise(self, cells: Cells, layers: CellLayers, numbers: Numbers) -> Minimised:
        """Go down from ``cells``, which need not be in S."""


@dataclass(frozen=True)
class Judge:
    """The minimiser of ``judge.local_minimum``: Ipopt, with all conditions of a local minimum met to ``tol`` > 0."""

    tol: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "tol", number("tol", self.tol, positive=True))

    def minimise(self, cells: Cells, layers: CellLayers, numbers: Numbers) -> Minimised:
        with needs("Judge", "yardsticks"):
            from verification.thesis.quasi_steady.judge import local_minimum

        return local_minimum(cells, layers, numbers, self.tol)
