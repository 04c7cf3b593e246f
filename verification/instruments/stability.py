"""A map of where a method fails: the outcome of each run over two parameters."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

import dincl
from dincl.checks import describe, items, number
from dincl.checks import times as checked_times
from dincl.extras import MissingLibrary
from dincl.study import Key, Row, Study
from dincl.study.table import kind_of, rounded
from verification.instruments.error_norms import distance
from verification.instruments.method import Failure, Method, attempted, made_scheme
from verification.instruments.outcome import COLOURS, Outcome, judge
from verification.instruments.references import known_at
from verification.instruments.result import Result
from verification.instruments.stored import Store, carried_out, settings_of

if TYPE_CHECKING:
    from verification.site.sheet import Axes

Axis = tuple[str, Sequence[float]] | tuple[str, Sequence[float], str]
Floats = NDArray[np.float64]
COLUMNS = {
    "outcome": "Outcome",
    "status": "Status",
    "error": "Error [length]",
    "overlap": "Largest overlap [length]",
    "growth": "Growth",
}
# Columns that are no parameter of a map.
RESERVED = ("method", *COLUMNS, "detail")
# Points of a curve of a limit.
POINTS = 200
NO_LIMITS = pd.DataFrame(columns=["label", "method", "x", "y"])


@dataclass(frozen=True)
class Limit:
    """A limit that theory predicts, drawn over a map as the curve y(x).

    Attributes
    ----------
    label
        Its formula, for the legend.
    y
        x -> y on the limit, called with one value of the axis x at a time; NaN where there is none. Or one number.
    methods
        Labels of the methods that have this limit; None: all.
    """

    label: str
    y: Callable[[float], float] | float
    methods: Sequence[str] | None = None

    def at(self, x: Floats) -> Floats:
        """Return y at x (K,); InvalidProblem if it is no number somewhere."""
        return np.array([self._one(value) for value in x.tolist()])

    def _one(self, x: float) -> float:
        try:
            found = self.y(x) if callable(self.y) else self.y
            return float(found)
        except Exception as error:
            raise dincl.InvalidProblem(
                f"limits: {self.label!r} at x = {x:g}: {type(error).__name__}: {error}; must be a number, NaN where "
                "there is no limit"
            ) from error


@dataclass(frozen=True, eq=False, repr=False)
class StabilityMap(Result):
    """Outcomes over two parameters.

    Attributes
    ----------
    table
        One row for each cell: ``method``, if there are several, the two parameters, ``outcome``, ``status``,
        ``detail``, ``error`` (NaN without a reference), ``overlap``, ``growth`` (largest coordinate over what it may
        be).
    x, y
        Names of the parameters.
    limits
        Curves of the limits that theory predicts: columns label, method, x, y.
    labels
        Name of a parameter -> label of its axis.
    """

    table: pd.DataFrame
    x: str
    y: str
    title: str = "Stability"
    name: str = "stability"
    limits: pd.DataFrame = field(default_factory=NO_LIMITS.copy)
    labels: Mapping[str, str] = field(default_factory=dict)

    def plot(self, ax: Axes | None = None, method: str | None = None) -> Axes:
        """Draw one colour for each outcome with the limits over it, one panel for each method; return the first panel.

        Parameters
        ----------
        ax, method
            Draw one method, by default the first one, into these axes.
        """
        from verification.instruments.charts import draw_stability, draw_stability_panels

        axes, labels = (self.x, self.y), [self.labels.get(name, name) for name in (self.x, self.y)]
        if "method" in self.table and ax is None and method is None:
            return draw_stability_panels(self.table, axes, labels, self.limits)
        table, limits, title = self.table, self.limits, self.title
        if "method" in table:
            title = method or table["method"].iloc[0]
            table, limits = (rows[rows["method"] == title] for rows in (table, limits))
        panel = draw_stability(table, axes, labels, limits, ax)
        panel.set_title(title)
        return panel

    def summaries(self) -> dict[str, pd.DataFrame]:
        """Count the cells of each outcome."""
        if "method" in self.table:
            counts = self.table.groupby(["method", "outcome"], sort=False).size().unstack(fill_value=0)
            ordered = counts[[one.value for one in Outcome if one.value in counts]]
            return {"Cells by outcome.": ordered.rename_axis(columns=None).reset_index()}
        counts = self.table["outcome"].value_counts().rename_axis("outcome").reset_index(name="cells")
        return {"Cells by outcome.": counts}

    def __repr__(self) -> str:
        counts = ", ".join(f"{word} {count}" for word, count in self.table["outcome"].value_counts().items())
        return f"StabilityMap over {self.x} and {self.y}: {counts}"


@dataclass(frozen=True, eq=False)
class StabilityRuns:
    """What ``stability_map`` runs, apart from what it makes of the rows; the arguments are the same."""

    problem: Any
    method: Any
    x: Axis
    y: Axis
    t: ArrayLike | Callable[..., ArrayLike] | None = None
    reference: Callable[[dincl.Problem], Any] | None = None
    accurate: float = 0.02
    feasible: float = 0.1
    limits: Sequence[Limit] = ()

    def __post_init__(self) -> None:
        for name, axis in (("x", self.x), ("y", self.y)):
            named = isinstance(axis, tuple | list) and len(axis) in (2, 3) and isinstance(axis[0], str)
            if not named or not all(isinstance(one, str) for one in axis[2:]):
                raise dincl.InvalidProblem(
                    f"{name} = {describe(axis)}: must be (name, values) or (name, values, label of the axis)"
                )
            _values(axis)
            if axis[0] in RESERVED:
                raise dincl.InvalidProblem(
                    f"{name} = {describe(axis)}: must have another name than {', '.join(RESERVED)}"
                )
        for limit in self.limits:
            unknown = [] if limit.methods is None else [one for one in limit.methods if one not in self._methods()]
            if unknown:
                known = ", ".join(self._methods())
                raise dincl.InvalidProblem(f"limits: {limit.label!r} names {unknown[0]!r}: must be among {known}")
        self._runs()  # which refuses what cannot run
        self._curves(pd.DataFrame({self.x[0]: _values(self.x)}))

    def study(self, name: str = "stability", title: str = "Stability", smallest: bool = False) -> Study:
        """Return the runs, one for each pair of values; in the smallest form those of the first and last values."""
        x, y = self.x[0], self.y[0]
        axes = (_values(axis) for axis in (self.x, self.y))
        xs, ys = (
            {rounded(one): one for one in (values[:: len(values) - 1 or 1] if smallest else values)} for values in axes
        )
        drawn = ("x", "y", "limits")
        settings = {one.name: getattr(self, one.name) for one in fields(self) if one.name not in drawn}
        several = {"method": "Method"} if isinstance(self.method, Mapping) else {}
        which = [{"method": label} if several else {} for label in self._methods()]
        pairs = tuple(label | {x: a, y: b} for label in which for b in ys.values() for a in xs.values())
        run, columns = self._runs(), several | self._labels() | COLUMNS
        return Study(name, title, (*several, x, y), pairs, run, settings_of(**settings), columns=columns)

    def result(self, rows: pd.DataFrame) -> StabilityMap:
        """Return the map of rows of the study, of the complete one or of some of its runs."""
        x, y, several = self.x[0], self.y[0], isinstance(self.method, Mapping)
        label = self.method.label if isinstance(self.method, Method) else getattr(self.method, "__name__", "")
        title = f"Stability of {label}" if label.isidentifier() or isinstance(self.method, Method) else "Stability"
        order = {name: place for place, name in enumerate(self._methods())}
        by = ["method", y, x] if several else [y, x]
        ordered = rows.sort_values(
            by, kind="stable", ignore_index=True, key=lambda one: one.map(order) if one.name == "method" else one
        )
        return StabilityMap(ordered, x, y, title, limits=self._curves(rows), labels=self._labels())

    def _methods(self) -> Mapping[str, Any]:
        """Return label -> method; the label of a single method is empty."""
        return self.method if isinstance(self.method, Mapping) else {"": self.method}

    def _labels(self) -> dict[str, str]:
        return {axis[0]: axis[2] if len(axis) == 3 else axis[0] for axis in (self.x, self.y)}

    def _runs(self) -> _Runs:
        names = (self.x[0], self.y[0])
        more = (names, self.t, self.reference, self.accurate, self.feasible)
        if isinstance(self.method, Mapping) and not self.method:
            raise dincl.InvalidProblem(f"method = {describe(self.method)}: must have one or more methods")
        cells = {
            label: _Judged(method) if self.problem is None else _Cell(self.problem, method, *more)
            for label, method in self._methods().items()
        }
        return _Runs(cells, names)

    def _curves(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Return the points of the limits between the sides of the map."""
        if not self.limits:
            return NO_LIMITS
        from verification.instruments.charts import sides

        x = sides(rows[self.x[0]], POINTS)
        curves = [
            pd.DataFrame({"label": limit.label, "method": label, "x": x, "y": limit.at(x)})
            for limit in self.limits
            for label in (self._methods() if limit.methods is None else limit.methods)
        ]
        return pd.concat(curves, ignore_index=True)


def stability_map(
    problem: dincl.Problem | Callable[..., dincl.Problem] | None,
    method: Method | Callable[..., Any] | Mapping[str, Method | Callable[..., Any]],
    x: Axis,
    y: Axis,
    t: ArrayLike | Callable[..., ArrayLike] | None = None,
    reference: Callable[[dincl.Problem], Any] | None = None,
    accurate: float = 0.02,
    feasible: float = 0.1,
    limits: Sequence[Limit] = (),
    *,
    store: Store = None,
    executor: Executor | None = None,
) -> StabilityMap:
    """Run ``method`` on ``problem`` for each pair of values, and say of each run what became of it.

    Parameters
    ----------
    problem
        A Problem, or a function that makes one of the parameters that it names; None: ``method`` runs and judges.
    method
        A function that makes a scheme of the parameters that it names, such as ``dincl.Penalty`` for "dt" and
        "strength"; or a Method, whose setting is x. Without a problem: a function of both parameters by name that
        runs anything and returns an ``Outcome``, or a row with "outcome" and further numbers, such as that of
        ``judged_run``. Or label -> one of these: a panel for each.
    x, y
        (name, values): names of arguments of ``method`` or of ``problem``; or (name, values, label of the axis).
    t
        Times to look at, the last ends the run, or a function that makes them of the parameters that it names; by
        default eight until 1, or until the end of a scene.
    reference
        problem -> what ``order_study`` takes as reference, or a state at rest (N, d); None: runs are judged by
        boundedness and overlap only.
    accurate, feasible
        The largest error of a run that converged, and the largest overlap of one that is feasible [length].
    limits
        Limits that theory predicts, drawn over the map.
    store, executor
        A Parquet file that makes an interrupted call go on; who makes the runs: see ``carried_out``.

    Raises
    ------
    InvalidProblem
        If a name is an argument neither of the method nor of the problem, values are not one or more finite numbers,
        or a limit names a method that is not there.

    What the problem, the method or the reference raises for a pair of values is in the row of this pair. A missing
    library ends the map: every pair needs it.
    """
    runs = StabilityRuns(problem, method, x, y, t, reference, accurate, feasible, limits)
    return runs.result(carried_out(runs.study(), store, executor))


def judged_run(
    problem: dincl.Problem,
    scheme: dincl.Scheme,
    t: ArrayLike,
    exact: ArrayLike | None = None,
    *,
    accurate: float = 0.02,
    feasible: float = 0.1,
    reach: float | None = None,
) -> dict[str, Any]:
    """Run a scheme, and judge it by the largest error, overlap and coordinate at the times t (K,).

    Parameters
    ----------
    exact
        The states that are right, (K, N, d), or one at rest, (N, d); None: there is no error to look at.
    accurate, feasible
        As for ``stability_map`` [length].
    reach
        How far a coordinate may come [length]; None: as far as the first drift carries it, so that falling freely is
        no instability. A run that comes ``FAR`` times as far is unstable.

    Returns the columns outcome, status, detail, error, overlap and growth of a map.
    """
    times = np.atleast_1d(np.asarray(t, dtype=np.float64))
    path = dincl.solve(problem, scheme, t=times, throw=False)
    true = (
        None if exact is None else np.broadcast_to(np.asarray(exact, dtype=np.float64), (len(times), *path.x.shape[1:]))
    )
    if reach is None:
        reach = reach_of(problem, float(times[-1]), np.zeros(1) if true is None else true)
    growth, overlap = float(np.abs(path.x).max()) / reach, float(path.violation().max())
    arrived = bool(path.status) and len(path.t) == len(times)
    error = None if true is None else float(distance(path.x, true).max()) if arrived and growth < np.inf else np.nan
    found = judge(path.status, error, overlap, growth, accurate, feasible)
    numbers = {"error": np.nan if error is None else error, "overlap": overlap, "growth": growth}
    return {"outcome": found.value, "status": path.status.name, "detail": path.detail} | numbers


def _values(axis: Axis) -> list[float]:
    name, values = axis[:2]
    found = [number(name, value) for value in items(name, values, object, "one or more numbers")]
    if not found:
        raise dincl.InvalidProblem(f"{name} = {describe(values)}: must be one or more numbers")
    return found


def _row(found: Any) -> dict[str, Any]:
    """Return the row of a run, or of what it raised."""
    if isinstance(found, Failure) and isinstance(found.error, MissingLibrary):
        raise found.error
    if isinstance(found, Failure):
        numbers = dict.fromkeys(("error", "overlap", "growth"), np.nan)
        status = "INVALID" if found.status == "REFUSED" else found.status
        return {"outcome": Outcome.REFUSED.value, "status": status, "detail": found.detail} | numbers
    row: dict[str, Any] = found
    return row


@dataclass(frozen=True)
class _Runs:
    """Makes the row of a pair of values; ``cells`` has the methods by their labels."""

    cells: Mapping[str, Callable[[dict[str, float]], Any]]
    names: tuple[str, str]

    def __call__(self, key: Key) -> list[Row]:
        """Return the row of a run."""
        values = {name: key[name] for name in self.names}
        return [_row(attempted(self.cells[key.get("method", "")], values)) | dict(key)]


@dataclass(frozen=True)
class _Judged:
    """Calls a function that runs and judges."""

    method: Callable[..., Any]

    def __call__(self, values: dict[str, float]) -> dict[str, Any]:
        """Return the outcome of a pair of values, and further numbers."""
        found = self.method(**values)
        row = {"outcome": found.value} if isinstance(found, Outcome) else dict(found)
        if row.get("outcome") not in COLOURS:
            raise dincl.InvalidProblem(
                f"method returned {describe(found)}: must return an Outcome, or a row with an outcome that is one of "
                f"{', '.join(COLOURS)}"
            )
        for name, value in row.items():
            if value is not None and not kind_of(value):
                raise dincl.InvalidProblem(
                    f"method returned {name} = {describe(value)}: must be a number, flag, text or None"
                )
        return {"status": "SUCCESS", "detail": ""} | row


class _Cell:
    """Makes problem and scheme of two values, runs, and judges."""

    def __init__(
        self,
        problem: Any,
        method: Any,
        names: tuple[str, str],
        t: ArrayLike | Callable[..., ArrayLike] | None,
        reference: Callable[[dincl.Problem], Any] | None,
        accurate: float,
        feasible: float,
    ) -> None:
        self._problem, self._reference = problem, reference
        self._t = t if t is None or callable(t) else checked_times("t", t)
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
        self._of_times = _arguments(t, names) if callable(t) else ()
        for name in names:
            if name not in (*self._of_method, *self._of_problem):
                known = ", ".join(inspect.signature(maker).parameters)
                raise dincl.InvalidProblem(
                    f"{name!r}: must be an argument of the method, which has {known}, "
                    "or of the function that makes the problem"
                )

    def __call__(self, values: dict[str, float]) -> dict[str, Any]:
        """Return the outcome of a pair of values, and the numbers that it follows from."""
        made = {name: values[name] for name in self._of_problem}
        problem = self._problem if isinstance(self._problem, dincl.Problem) else self._problem(**made)
        if not isinstance(problem, dincl.Problem):
            raise dincl.InvalidProblem(f"problem made {describe(problem)} of {made}: must make a dincl.Problem")
        given = {name: values[name] for name in self._of_method}
        scheme = self._maker(*given.values()) if self._positional else self._maker(**given)
        words = ", ".join(f"{name} = {value:g}" for name, value in given.items())
        t = self._times(problem, values)
        exact = None if self._reference is None else self._reference(problem)
        if exact is not None and np.shape(exact) != problem.x0.shape:
            exact = known_at(exact, t, problem=problem).x
        tolerated = {"accurate": self._accurate, "feasible": self._feasible}
        return judged_run(problem, made_scheme(self._label, scheme, words), t, exact, **tolerated)

    def _times(self, problem: dincl.Problem, values: dict[str, float]) -> Floats:
        if callable(self._t):
            return checked_times("t", self._t(**{name: values[name] for name in self._of_times}))
        if self._t is not None:
            return self._t
        end = float(getattr(problem, "times", (1.0,))[-1])
        return np.linspace(0.0, end, 9)[1:]


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


def reach_of(problem: dincl.Problem, end: float, true: Floats) -> float:
    """Return the distance by which the first drift carries a coordinate, so that falling freely is no instability."""
    carried = end * float(np.abs(problem.velocity(0.0, problem.x0)).max())
    return max(1.0, float(np.abs(problem.x0).max()) + carried, float(np.nan_to_num(np.abs(true)).max()))
