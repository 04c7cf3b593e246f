"""The dense output of a run: one polynomial for each step, held on the contacts of its time."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.compiled.structs import written
from dincl.errors import StepFailure
from dincl.events import integrate as kernels
from dincl.events.arrays import STATE, March, Path, RungeKutta, begin_march, room_for_path
from dincl.events.choice import TOUCHING
from dincl.events.gram_room import GramRoom, gram_room
from dincl.projection.cone import distance_to_cone
from dincl.run.outcome import Between
from dincl.system.arrays import OK
from dincl.system.compiled_problem import CompiledProblem

if TYPE_CHECKING:
    from numpy.typing import NDArray


class PathPieces(Between):
    """The pieces of a run in the units of its system, in the order of time.

    ``size`` is that of the problem, ``start`` is x(0), shape (N d,).
    """

    def __init__(
        self, system: CompiledProblem, gram: GramRoom, pair: RungeKutta, size: float, start: NDArray[np.float64]
    ) -> None:
        self._problem, self._units, self._pair, self._size = system.problem, system.units, pair, size
        self._start, self._system, self._gram = start, system, gram
        self._spacing, self._kinks = system.sets.spacing, system.sets.kinks
        self._parts: list[Path] = []

    def add(self, path: Path, size: float) -> None:
        """More pieces, and the size that the problem has now."""
        if len(path.end):
            self._parts.append(path)
        self._size = size

    def states(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """The polynomials, moved back onto the contacts that are held."""
        x = self._states(np.asarray(times) / self._units.time)
        return x.reshape(-1, *self._problem.x0.shape) * self._units.length

    def residuals(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """With the velocity from before each time, or from after t = 0."""
        scaled = np.asarray(times) / self._units.time
        pairs = zip(times, scaled, *self._pieces(scaled), self._states(scaled), strict=True)
        return np.array([self._residual(float(t), float(s), int(k), int(p), x) for t, s, k, p, x in pairs])

    def __getstate__(self) -> dict[str, Any]:
        """Without what is bound to this process."""
        bound = ("_bound", "_words", "_system", "_gram")
        return {name: value for name, value in self.__dict__.items() if name not in bound}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """With a system of this process."""
        system = CompiledProblem(state["_problem"], units=state["_units"])
        self.__dict__ |= state | {"_system": system, "_gram": gram_room(system.arrays)}

    @cached_property
    def _bound(self) -> March:
        """A run without pieces, made when the run has ended."""
        path = room_for_path(0, self._pair.terms, self._start.size, 0, 0)
        state = np.zeros(1, dtype=STATE)
        state["size"] = self._size
        system, x = self._system, self._start.copy()
        return begin_march(system.place, self._gram.place, system.arrays, self._pair, state, path, x, np.zeros(0))

    @cached_property
    def _words(self) -> list[NDArray[np.int64]]:
        """The run with each part of its path; in one array the path of many particles would need its room twice."""
        paths = self._parts or [self._bound.path]
        return [written(self._bound._replace(path=path)) for path in paths]

    def _handle(self, part: int) -> int:
        return int(self._words[part].ctypes.data)

    def _states(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """The states (K, n) in the units of the run."""
        self._system.sets.spacing, self._system.sets.kinks = self._spacing, self._kinks
        x = np.tile(self._start, (len(times), 1))
        if not self._parts or not len(times):
            return x
        part, piece = self._pieces(times)
        with self._system.drift, self._system.sets:
            for k in range(part.min(), part.max() + 1):
                mine = (part == k) & (times > 0)
                made = x[mine]
                code = kernels.states_at(self._handle(k), times[mine], piece[mine], made)
                if code != OK:
                    self._system.failure(code)
                x[mine] = made
        return x

    def _pieces(self, times: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """For each time the part of the path, and the piece in it."""
        part, piece = np.zeros(len(times), dtype=np.int64), np.zeros(len(times), dtype=np.int64)
        begins = -np.inf
        for k, path in enumerate(self._parts):
            later = times > begins
            part[later], begins = k, path.end[-1]
            piece[later] = np.minimum(np.searchsorted(path.end, times[later]), len(path.end) - 1)
        return part, piece

    def _residual(self, t: float, scaled: float, part: int, piece: int, x: NDArray[np.float64]) -> float:
        """The residual at time t, which is ``scaled`` in the units of the run, as x (n,) is."""
        if not self._parts:
            return np.inf
        rate, at = np.empty(x.size), x.reshape(self._problem.x0.shape) * self._units.length
        try:
            with self._system.drift, self._system.sets:
                code = kernels.rate_at(self._handle(part), scaled, piece, x, rate)
            if code != OK:
                self._system.failure(code)
            reaction = rate * self._units.speed - self._problem.velocity(t, at).ravel()
            touching = TOUCHING * self._size * self._units.length
            return distance_to_cone(reaction, self._problem.rows_within(t, at, touching).jacobian(at))
        except StepFailure:
            return np.inf
