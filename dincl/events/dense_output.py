"""Dense output of a run of the event-driven method: its states and reactions at any time."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.compiled.structs import StructPointer
from dincl.errors import StepFailure
from dincl.events import integrate as kernels
from dincl.events.workspace import KIND, TOUCHING, StepTable, event_workspace, sparse_gram, step_table
from dincl.forces import Reaction
from dincl.system.arrays import OK
from dincl.system.compiled_problem import CompiledProblem
from dincl.trajectory import Between

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.events.run import EventSystem
    from dincl.events.runge_kutta import RungeKutta


class DenseOutput(Between):
    """A polynomial for each step of a run, in the units of its system; states are moved onto the active rows.

    ``size`` is that of the problem, ``start`` is x(t0), shape (N d,). States that are
    asked for ``during`` the run need a factor of their own.
    """

    def __init__(
        self, system: EventSystem, pair: RungeKutta, size: float, start: NDArray[np.float64], *, during: bool = False
    ) -> None:
        self._system = system.compiled
        self._gram = sparse_gram(system.compiled.arrays) if during else system.gram
        self._problem, self._units, self._smooth = self._system.problem, self._system.units, system.scales.smooth
        self._start, self._pair, self._size = start, pair, size
        self._begin = system.scales.start / self._units.time
        self._differences = {name: getattr(self._system.sets, name) for name in ("spacing", "spacings", "breaks")}
        self._tables: list[StepTable] = []

    def add(self, table: StepTable, size: float) -> None:
        """Append steps, and set the size of the problem after them."""
        if len(table.end):
            self._tables.append(table)
            self.__dict__.pop("_workspaces", None)
        self._size = size

    def states(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Evaluate the polynomials, moved onto the active rows."""
        x = self._states(np.asarray(times) / self._units.time)
        return x.reshape(-1, *self._problem.x0.shape) * self._units.length

    def reactions(self, times: NDArray[np.float64]) -> list[Reaction | None]:
        """Evaluate reactions with the velocity from before each time, or from after the start."""
        scaled = np.asarray(times) / self._units.time
        points = zip(times, scaled, *self._steps(scaled), self._states(scaled), strict=True)
        return [self._reaction(float(t), float(s), int(k), int(p), x) for t, s, k, p, x in points]

    def __getstate__(self) -> dict[str, Any]:
        """Leave out what is bound to this process."""
        bound = ("_workspaces", "_system", "_gram")
        return {name: value for name, value in self.__dict__.items() if name not in bound}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Bind a system of this process."""
        system = CompiledProblem.for_events(state["_problem"], state["_units"])
        system.sets.tabulate(state["_smooth"])
        self.__dict__ |= state | {"_system": system, "_gram": sparse_gram(system.arrays)}

    @cached_property
    def _workspaces(self) -> list[StructPointer]:
        """One workspace for each table, once the run has ended: to join the tables needs twice their memory."""
        system, pair, x = self._system, self._pair, self._start
        tables = self._tables or [step_table(0, pair.terms, x.size, 0, 0)]
        first = event_workspace(
            system.arrays,
            system.place,
            self._gram,
            pair,
            tables[0],
            x.copy(),
            np.zeros((0, 3)),
            np.zeros((0, 2)),
            size=self._size,
        )
        return [StructPointer(first._replace(steps=table), KIND) for table in tables]

    def _states(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Evaluate the states (K, n) in the units of the run."""
        vars(self._system.sets).update(self._differences)
        x = np.tile(self._start, (len(times), 1))
        if not self._tables or not len(times):
            return x
        table, step = self._steps(times)
        with self._system.callbacks():
            for k in range(table.min(), table.max() + 1):
                chosen = (table == k) & (times > self._begin)
                found = x[chosen]
                code = kernels.integrate(self._workspaces[k], 0, times[chosen], step[chosen], found)
                if code != OK:
                    self._system.failure(code)
                x[chosen] = found
        return x

    def _steps(self, times: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Find the table of each time, and the step in it."""
        which, step = np.zeros(len(times), dtype=np.int64), np.zeros(len(times), dtype=np.int64)
        begins = -np.inf
        for k, table in enumerate(self._tables):
            later = times > begins
            which[later], begins = k, table.end[-1]
            step[later] = np.minimum(np.searchsorted(table.end, times[later]), len(table.end) - 1)
        return which, step

    def _reaction(self, t: float, scaled: float, table: int, step: int, x: NDArray[np.float64]) -> Reaction | None:
        """Compute the reaction at time t, which is ``scaled`` in the units of the run, as x (n,) is."""
        if not self._tables:
            return None
        rate, at = np.empty(x.size), x.reshape(self._problem.x0.shape) * self._units.length
        try:
            with self._system.callbacks():
                code = kernels.rate_at(self._workspaces[table], scaled, step, x, rate)
            if code != OK:
                self._system.failure(code)
            value = rate * self._units.speed - self._problem.velocity(t, at).ravel()
        except StepFailure:
            return None
        return Reaction(self._problem, t, at, value, TOUCHING * self._size * self._units.length)
