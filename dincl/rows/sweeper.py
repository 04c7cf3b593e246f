"""Gauss-Seidel sweeps: exact projections onto the single rows of one constraint, one after another, in place.

This is (2.5) and (2.9), ``P_{S_M} ... P_{S_1}``; the order is that of the rows.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.work import Work


class SweptRows(NamedTuple):
    """What a sweeper goes through, row after row, for compiled code that does the same.

    ``formula`` is that of ``kernels.sweep_steps``: "pairs", "distances", "wall" or "affine"; ``rows`` are of one kind.
    """

    formula: str
    rows: Any


class Sweeper(ABC):
    """The projections onto the rows of one constraint; an ``idle`` one has no rows, and need not be asked.

    A sweeper belongs to one run: it may keep a neighbour list, on which its result does not depend.
    """

    idle = False

    def __init_subclass__(cls, **keywords: Any) -> None:
        """A class that overrides ``sweep`` alone does something else than what it derives from."""
        super().__init_subclass__(**keywords)
        if "sweep" in cls.__dict__ and "swept" not in cls.__dict__:
            cls.swept = Sweeper.swept  # type: ignore[method-assign]

    @property
    def swept(self) -> SweptRows | None:
        """The rows, if nothing but a formula of compiled code is applied to them; None if only ``sweep`` knows."""
        return None

    @abstractmethod
    def sweep(self, t: float, x: NDArray[np.float64], work: Work) -> None:
        """Project x (N, d) onto row after row, in place, and add their number to ``work.constraint_projections``.

        The set is meant as it is at time t, which says nothing to a set at rest. StepFailure where a projection has no
        direction.
        """
