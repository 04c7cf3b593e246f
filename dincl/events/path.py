"""The dense output of a run: one polynomial for each step, held on the contacts of its time."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.cone import distance_to_cone
from dincl.errors import StepFailure
from dincl.kernels import events as kernels
from dincl.kernels.choice import TOUCHING
from dincl.kernels.handles import written
from dincl.kernels.march import STATE, March, Path, RungeKutta, begin_march, room_for_path
from dincl.kernels.system import OK
from dincl.run.outcome import Between
from dincl.run.small import SmallSystem

if TYPE_CHECKING:
    from numpy.typing import NDArray


class PathPieces(Between):
    """The pieces of a run, in the order of time; ``size`` is that of the problem, ``start`` is x(0), shape (N d,)."""

    def __init__(self, system: SmallSystem, pair: RungeKutta, size: float, start: NDArray[np.float64]) -> None:
        self._problem, self._pair, self._size = system.problem, pair, size
        self._start, self._spacing, self._system = start, system.sets.spacing, system
        self._parts: list[Path] = []

    def add(self, path: Path, size: float) -> None:
        """More pieces, and the size that the problem has now."""
        self._parts.append(path)
        self._size = size

    def states(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """The polynomials, moved back onto the contacts that are held."""
        march = self._bound
        self._system.sets.spacing = self._spacing
        x = np.tile(self._start, (len(times), 1))
        later = np.asarray(times) > 0
        if later.any() and len(march.path.end):
            made = np.empty((int(later.sum()), x.shape[1]))
            with self._system.drift, self._system.sets:
                code = kernels.states_at(self._handle, np.asarray(times)[later], self._pieces(times)[later], made)
            if code != OK:
                self._system.failure(code)
            x[later] = made
        return x.reshape(-1, *self._problem.x0.shape)

    def residuals(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """With the velocity from before each time, or from after t = 0."""
        pairs = zip(times, self._pieces(times), self.states(times), strict=True)
        return np.array([self._residual(float(t), int(piece), x) for t, piece, x in pairs])

    def __getstate__(self) -> dict[str, Any]:
        """Without what is bound to this process."""
        return {name: value for name, value in self.__dict__.items() if name not in ("_bound", "_words", "_system")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """With a system of this process."""
        self.__dict__ |= state | {"_system": SmallSystem(state["_problem"])}

    @cached_property
    def _bound(self) -> March:
        """Made when the run has ended."""
        if self._parts:
            path = Path._make(np.concatenate(parts) for parts in zip(*self._parts, strict=True))
        else:
            path = room_for_path(0, self._start.size, 0, 0)
        state = np.zeros(1, dtype=STATE)
        state["size"] = self._size
        return begin_march(self._system.place, self._system.arrays, self._pair, state, path, self._start.copy())

    @cached_property
    def _words(self) -> NDArray[np.int64]:
        return written(self._bound)

    @property
    def _handle(self) -> int:
        return int(self._words.ctypes.data)

    def _pieces(self, times: NDArray[np.float64]) -> NDArray[np.int64]:
        ends = self._bound.path.end
        found: NDArray[np.int64] = np.minimum(np.searchsorted(ends, times), max(len(ends) - 1, 0))
        return found

    def _residual(self, t: float, piece: int, x: NDArray[np.float64]) -> float:
        march = self._bound
        if not len(march.path.end):
            return np.inf
        self._system.sets.spacing = self._spacing
        rate = np.empty(x.size)
        try:
            with self._system.drift, self._system.sets:
                code = kernels.rate_at(self._handle, t, piece, x.ravel(), rate)
            if code != OK:
                self._system.failure(code)
            reaction = rate - self._problem.velocity(t, x).ravel()
            return distance_to_cone(reaction, self._problem.rows_within(t, x, TOUCHING * self._size).jacobian(x))
        except StepFailure:
            return np.inf
