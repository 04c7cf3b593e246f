"""A map of where a method fails: the outcome of each run over two parameters."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

import dincl
from dincl.checks import describe, items, number
from dincl.checks import times as checked_times
from dincl.extras import MissingLibrary
from verification.instruments.error_norms import distance
from verification.instruments.method import Failure, Method, attempted, made_scheme
from verification.instruments.outcome import Outcome, judge
from verification.instruments.references import known_at
from verification.instruments.result import Result

if TYPE_CHECKING:
    from verification.page.sheet import Axes

Axis = tuple[str, Sequence[float]]


@dataclass(frozen=True, eq=False, repr=False)
class StabilityMap(Result):
    """Outcomes over two parameters.

    Attributes
    ----------
    table
        One row for each cell: the two parameters, ``outcome``, ``status``, ``detail``, ``error`` (NaN without a
        reference), ``overlap``, ``growth`` (largest coordinate over what it may be).
    x, y
        Names of the parameters.
    """

    table: pd.DataFrame
    x: str
    y: str
    title: str = "Stability"
    name: str = "stability"

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw one colour for each outcome."""
        from verification.instruments.charts import draw_stability

        panel = draw_stability(self.table, self.x, self.y, ax)
        panel.set_title(self.title)
        return panel

    def summaries(self) -> dict[str, pd.DataFrame]:
        """Count the cells of each outcome."""
        counts = self.table["outcome"].value_counts().rename_axis("outcome").reset_index(name="cells")
        return {"Cells by outcome.": counts}

    def __repr__(self) -> str:
        counts = ", ".join(f"{word} {count}" for word, count in self.table["outcome"].value_counts().items())
        return f"StabilityMap over {self.x} and {self.y}: {counts}"


def stability_map(
    problem: dincl.Problem | Callable[..., dincl.Problem],
    method: Method | Callable[..., dincl.Scheme],
    x: Axis,
    y: Axis,
    t: ArrayLike | None = None,
    reference: Callable[[dincl.Problem], Any] | None = None,
    accurate: float = 0.02,
    feasible: float = 0.1,
) -> StabilityMap:
    """Run ``method`` on ``problem`` for each pair of values, and say of each run what became of it.

    Parameters
    ----------
    problem
        A Problem, or a function that makes one of the parameters that it names.
    method
        A function that makes a scheme of the parameters that it names, such as ``dincl.Penalty`` for "dt" and
        "strength"; or a Method, whose setting is x.
    x, y
        (name, values): names of arguments of ``method`` or of ``problem``.
    t
        Times to look at, the last ends the run; by default eight until 1, or until the end of a scene.
    reference
        problem -> what ``order_study`` takes as reference; None: runs are judged by boundedness and overlap only.
    accurate, feasible
        The largest error of a run that converged, and the largest overlap of one that is feasible [length].

    Raises
    ------
    InvalidProblem
        If a name is an argument neither of the method nor of the problem, or values are not one or more finite numbers.

    What the problem, the method or the reference raises for a pair of values is in the row of this pair. A missing
    library ends the map: every pair needs it.
    """
    for name, axis in (("x", x), ("y", y)):
        if not isinstance(axis, tuple | list) or len(axis) != 2 or not isinstance(axis[0], str):
            raise dincl.InvalidProblem(f"{name} = {describe(axis)}: must be (name, values)")
    cell = _Cell(problem, method, (x[0], y[0]), t, reference, accurate, feasible)
    xs, ys = (_values(name, values) for name, values in (x, y))
    rows = [{x[0]: a, y[0]: b} | cell.row({x[0]: a, y[0]: b}) for b in ys for a in xs]
    label = method.label if isinstance(method, Method) else getattr(method, "__name__", "")
    title = f"Stability of {label}" if label.isidentifier() or isinstance(method, Method) else "Stability"
    return StabilityMap(pd.DataFrame(rows), x[0], y[0], title=title)


def _values(name: str, values: Any) -> list[float]:
    found = [number(name, value) for value in items(name, values, object, "one or more numbers")]
    if not found:
        raise dincl.InvalidProblem(f"{name} = {describe(values)}: must be one or more numbers")
    return found


class _Cell:
    """Makes problem and scheme of two values, runs, and judges."""

    def __init__(
        self,
        problem: Any,
        method: Any,
        names: tuple[str, str],
        t: ArrayLike | None,
        reference: Callable[[dincl.Problem], Any] | None,
        accurate: float,
        feasible: float,
    ) -> None:
        self._problem, self._t, self._reference = problem, None if t is None else checked_times("t", t), reference
        self._accurate, self._feasible = accurate, feasible
        maker = method.scheme if isinstance(method, Method) else method
        if not callable(maker):
            raise dincl.InvalidProblem(f"method = {describe(method)}: must make a scheme of its arguments")
        if not callable(problem) and not isinstance(problem, dincl.Problem):
            raise dincl.InvalidProblem(f"problem = {describe(problem)}: must be a dincl.Problem, or make one")
        self._maker: Callable[..., Any] = maker
        self._label = method.label if isinstance(method, Method) else getattr(method, "__name__", "method")
        self._of_method = _arguments(maker, names)
        self._of_problem = () if isinstance(problem, dincl.Problem) else _arguments(problem, names)
        if not self._of_method and names[0] not in self._of_problem and _takes_one(maker):
            self._of_method, self._positional = (names[0],), True
        else:
            self._positional = False
        for name in names:
            if name not in (*self._of_method, *self._of_problem):
                known = ", ".join(inspect.signature(maker).parameters)
                raise dincl.InvalidProblem(
                    f"{name!r}: must be an argument of the method, which has {known}, "
                    "or of the function that makes the problem"
                )

    def row(self, values: dict[str, float]) -> dict[str, Any]:
        """Return the outcome of the run with these values."""
        found = attempted(self._run, values)
        if isinstance(found, Failure) and isinstance(found.error, MissingLibrary):
            raise found.error
        if isinstance(found, Failure):
            numbers = dict.fromkeys(("error", "overlap", "growth"), np.nan)
            status = "INVALID" if found.status == "REFUSED" else found.status
            return {"outcome": Outcome.REFUSED.value, "status": status, "detail": found.detail} | numbers
        return found

    def _run(self, values: dict[str, float]) -> dict[str, Any]:
        made = {name: values[name] for name in self._of_problem}
        problem = self._problem if isinstance(self._problem, dincl.Problem) else self._problem(**made)
        if not isinstance(problem, dincl.Problem):
            raise dincl.InvalidProblem(f"problem made {describe(problem)} of {made}: must make a dincl.Problem")
        given = {name: values[name] for name in self._of_method}
        scheme = self._maker(*given.values()) if self._positional else self._maker(**given)
        times = self._times(problem)
        words = ", ".join(f"{name} = {value:g}" for name, value in given.items())
        path = dincl.solve(problem, made_scheme(self._label, scheme, words), t=times, throw=False)
        return self._judged(problem, path, times)

    def _times(self, problem: dincl.Problem) -> NDArray[np.float64]:
        if self._t is not None:
            return self._t
        end = float(getattr(problem, "times", (1.0,))[-1])
        return np.linspace(0.0, end, 9)[1:]

    def _judged(self, problem: dincl.Problem, path: dincl.Trajectory, t: NDArray[np.float64]) -> dict[str, Any]:
        known = None if self._reference is None else known_at(self._reference(problem), t, problem=problem)
        reach = reach_of(problem, float(t[-1]), np.zeros(1) if known is None else known.x)
        growth, overlap = float(np.abs(path.x).max()) / reach, float(path.violation().max())
        arrived = bool(path.status) and len(path.t) == len(t)
        error = None if known is None else float(distance(path.x, known.x).max()) if arrived else np.nan
        found = judge(path.status, error, overlap, growth, self._accurate, self._feasible)
        numbers = {"error": np.nan if error is None else error, "overlap": overlap, "growth": growth}
        return {"outcome": found.value, "status": path.status.name, "detail": path.detail} | numbers


def _arguments(maker: Callable[..., Any], names: tuple[str, ...]) -> tuple[str, ...]:
    try:
        parameters = inspect.signature(maker).parameters
    except (TypeError, ValueError) as unknown:
        raise dincl.InvalidProblem(f"{describe(maker)}: must be a function with named arguments: {unknown}") from None
    everything = any(one.kind is inspect.Parameter.VAR_KEYWORD for one in parameters.values())
    return tuple(name for name in names if everything or name in parameters)


def _takes_one(maker: Callable[..., Any]) -> bool:
    required = [one for one in inspect.signature(maker).parameters.values() if one.default is inspect.Parameter.empty]
    return len(required) == 1


def reach_of(problem: dincl.Problem, end: float, true: NDArray[np.float64]) -> float:
    """Return the distance by which the first drift carries a coordinate, so that falling freely is no instability."""
    carried = end * float(np.abs(problem.velocity(0.0, problem.x0)).max())
    return max(1.0, float(np.abs(problem.x0).max()) + carried, float(np.nan_to_num(np.abs(true)).max()))
