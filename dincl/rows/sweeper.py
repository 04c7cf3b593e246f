"""What a Gauss-Seidel sweep projects onto: the rows of one constraint, one after another, in place.

This is (2.5) and (2.9), ``P_{S_M} ... P_{S_1}``; the order is that of the rows.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.work import Work


class DiscPairs(NamedTuple):
    """Discs that may not overlap: i ascending, then j < i ascending; each overlapping pair parts by half the overlap.

    ``radius`` has shape (m,); ``among`` names the particles that are discs, None if all particles are.
    """

    radius: NDArray[np.float64]
    among: NDArray[np.int64] | None


class Sweeper(ABC):
    """Projections of your own onto the rows of one constraint."""

    @abstractmethod
    def sweep(self, t: float, x: NDArray[np.float64], work: Work) -> None:
        """Project x (N, d) onto row after row, in place, and add their number to ``work.constraint_projections``.

        The set is where it is at rest, also if it is Moving: x is then seen from there. StepFailure where a projection
        has no direction.
        """
