"""Drifts with machine code of their own."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class CompiledDrift(ABC):
    """A drift F that a compiled run calls as a C function; an ordinary callable for everybody else.

    Both forms give the same numbers, and fail at the same states.
    """

    @abstractmethod
    def __call__(self, t: float, x: NDArray[np.float64]) -> Any:
        """F(t, x), (N, d) -> (N, d) [length / time]."""

    @abstractmethod
    def pointer(self) -> tuple[int, NDArray[np.float64]]:
        """The address of F as a C function, and the data to call it with; both live as long as the drift.

        ``int64 f(double t, double *x, double *out, int64 n, int64 d, double *data)`` writes F(t, x) to out and returns
        0, or another number if it fails. What it did wrong is then asked of the ordinary form. The data are float64
        numbers, at least one.
        """

    def check(self, count: int, d: int) -> None:  # noqa: B027  # most drifts take any shape
        """Raise InvalidProblem if this drift does not fit ``count`` particles in d dimensions."""

    def made(self, evaluations: int) -> None:  # noqa: B027  # for drifts that count
        """A compiled run made so many evaluations since it last said so; what this raises ends the run."""
