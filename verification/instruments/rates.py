"""How fast N particles represent a density, and through the flow of a model its mean-field limit: W1 against N.

In one dimension W1(mu_N, mu) is exact, also at later times: mu^t is carried by the flow of the limit. In two and three,
W1(mu_N, mu'_N) of two independent samples is taken, each with a flow of its own. Both have the same rate: mu is the
mean of mu'_N and W1 is convex, so that

    E W1(mu_N, mu) <= E W1(mu_N, mu'_N) <= 2 E W1(mu_N, mu).
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import KW_ONLY, dataclass, fields
from functools import cached_property, partial
from numbers import Integral
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri, stdtrit

from dincl import InvalidProblem
from dincl.checks import describe, integer
from dincl.study import Key, Row, Study
from meanfield import Density, Flow, Model, State, push_forward, solve_characteristics, solve_ode, w1
from verification.instruments.result import Result
from verification.instruments.stored import Store, carried_out, settings_of

if TYPE_CHECKING:
    from verification.site.sheet import Axes

Floats = NDArray[np.float64]
# What is compared with what.
IID, PAIR, QUANTILES = "iid against density", "iid against iid", "quantiles against density"
# With fewer repeats, the deviation of one value is taken from the next smaller N; its relative size falls with N.
ENOUGH = 8
# Of all intervals.
CONFIDENCE = 0.95
# A line and its scatter need so many sizes.
FEWEST_SIZES = 3
QUANTITIES = ("w1", "error_y")


@dataclass(frozen=True, eq=False, repr=False)
class W1Rates(Result):
    """W1 and the error of y against the number N of particles.

    Attributes
    ----------
    table
        One row for each N, repeat and time: ``w1``, and ``error_y`` = |y_N - y| (0 at t = 0).
    means
        One row for each quantity, time and N: the mean over the repeats with its 95 % interval ``low``, ``high`` by
        Student's t, and ``deviation``, that of the logarithm of one value.
    fit
        One row for each quantity and time: ``slope`` of log E against log N with its 95 % interval ``low``, ``high``,
        the sizes ``from``, ``to``, and ``misfit``, chi^2 per degree of freedom. Least squares on the means, weighted by
        their errors over the repeats; the interval is the larger one of two: from these errors, and by Student's t from
        the scatter of the means about the line. Starts at quantiles have no errors: only the second, misfit NaN.
    start
        What is compared: "iid against density", "iid against iid" or "quantiles against density".
    """

    table: pd.DataFrame
    means: pd.DataFrame
    fit: pd.DataFrame
    start: str
    title: str = "W1 against the number of particles"
    name: str = "w1_rates"

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the means with their intervals and the fitted lines on logarithmic axes; the error of y dashed."""
        from verification.instruments.charts import draw_rates

        panel = draw_rates(self.means, self.fit, ax)
        panel.set_title(f"{self.title} ({self.start})")
        return panel

    def summaries(self) -> dict[str, pd.DataFrame]:
        """Return the fits and the means."""
        return {"Powers of N with 95 % intervals.": self.fit, "Means with 95 % intervals.": self.means}

    def __repr__(self) -> str:
        lines = [
            f"  {row.quantity} at t = {row.t:g}: N^{row.slope:.3f} [{row.low:.3f}, {row.high:.3f}]"
            for row in self.fit.itertuples()
        ]
        return "\n".join([f"W1Rates, {self.start}", *lines])


@dataclass(frozen=True, eq=False)
class W1Runs:
    """What ``w1_rates`` runs, apart from what it makes of the rows; the arguments are the same."""

    model: Model | None
    density: Density
    sizes: Sequence[int]
    repeats: int | Sequence[int]
    seed: int | Sequence[int]
    _: KW_ONLY
    t: ArrayLike | None = None
    y0: ArrayLike | None = None
    v0: ArrayLike | None = None
    tol: float | None = None
    quantiles: bool = False

    def __post_init__(self) -> None:
        _checked_repeats(self.repeats, len(_checked_sizes(self.sizes)), self.quantiles)
        for part in _listed(self.seed):
            integer("seed", part, least=0)
        if self.quantiles and self.density.nx > 1:
            raise InvalidProblem(
                f"quantiles = True in {self.density.nx} dimensions: must be False, they need one dimension"
            )
        _check_limit(self.model, self.t, self.y0, self.v0, self.tol)

    @property
    def start(self) -> str:
        """What is compared."""
        return QUANTILES if self.quantiles else IID if self.density.nx == 1 else PAIR

    @cached_property
    def limit(self) -> tuple[Flow, list[Density | None]] | None:
        """The limit of the model by characteristics and, on a line, its densities, computed for the first run."""
        if self.model is None or self.t is None or self.y0 is None or self.v0 is None or self.tol is None:
            return None
        model, start = self.model, np.asarray(self.y0, dtype=np.float64)
        flow = solve_characteristics(model, self.density, start, self.v0, self.t, self.tol)
        return flow, [push_forward(model, self.density, start, y) if model.nx == 1 else None for y in flow.y]

    def draw(self, n: int, rng: np.random.Generator) -> list[Floats]:
        """Draw n particles (n, nx), and for ``PAIR`` as many others that are independent of them."""
        if self.quantiles:
            return [self.density.quantiles(n)]
        return [self.density.sample(rng, n) for _ in range(2 if self.start == PAIR else 1)]

    def __call__(self, key: Key) -> list[Row]:
        """Compare one sample at the start and along the flow; one row for each time."""
        n, k = int(key["N"]), int(key["repeat"])
        groups = self.draw(n, np.random.default_rng((*_listed(self.seed), n, k)))
        rows = [{"t": 0.0, "w1": _distance(groups, self.density), "error_y": 0.0}]
        if self.limit is not None and self.model is not None and self.tol is not None:
            flow, laws = self.limit
            starts = [State(X=X, y=self.y0, v=self.v0) for X in groups]  # type: ignore[arg-type]
            motions = [solve_ode(self.model, start, flow.t, self.tol) for start in starts]
            for j, (time, y, law) in enumerate(zip(flow.t, flow.y, laws, strict=True)):
                found = _distance([one.X[j] for one in motions], law)
                off = float(np.linalg.norm(motions[0].y[j] - y))
                rows.append({"t": float(time), "w1": found, "error_y": off})
        return [{"N": n, "repeat": k} | row for row in rows]

    def study(self, name: str = "w1_rates", title: str = "Rates of W1", smallest: bool = False) -> Study:
        """Return the runs, the largest first; in the smallest form two repeats of the three smallest sizes."""
        counts = _checked_sizes(self.sizes)
        pairs = list(zip(counts, _checked_repeats(self.repeats, len(counts), self.quantiles), strict=True))
        if smallest:
            pairs = [(n, min(many, 2)) for n, many in pairs[:FEWEST_SIZES]]
        runs = tuple({"N": n, "repeat": k} for n, many in reversed(pairs) for k in range(many))
        settings = {one.name: getattr(self, one.name) for one in fields(self) if one.name not in ("sizes", "repeats")}
        columns = {"N": "N", "t": "t [time]", "w1": "W1 [length]", "error_y": "Error of y [length]"}
        prepare = partial(getattr, self, "limit")
        return Study(name, title, ("N", "repeat"), runs, self, settings_of(**settings), columns, ("t",), prepare)

    def result(self, rows: pd.DataFrame) -> W1Rates:
        """Return the rates that rows of the study show, of the complete one or of some of its runs."""
        table = rows.sort_values(["N", "repeat", "t"], kind="stable", ignore_index=True)
        means, fit = summarised(table, random=not self.quantiles)
        return W1Rates(table, means, fit, self.start)


def w1_rates(
    model: Model | None,
    density: Density,
    sizes: Sequence[int],
    repeats: int | Sequence[int],
    seed: int | Sequence[int],
    *,
    t: ArrayLike | None = None,
    y0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    tol: float | None = None,
    quantiles: bool = False,
    store: Store = None,
    executor: Executor | None = None,
) -> W1Rates:
    """Measure E W1 of N particles against N, and through the flow of a model E W1 and the error of y at times t.

    Parameters
    ----------
    model
        None: only the start is looked at, and t, y0, v0, tol must be left out; else they are needed.
    density
        Of the particles at the start, in one, two or three dimensions.
    sizes, repeats
        At least three numbers N, increasing; independent repeats, the same for all or one for each N.
    seed
        Of the random numbers, one integer or several; each N and repeat has a stream of its own,
        ``numpy.random.default_rng((*seed, N, repeat))``.
    t, y0, v0, tol
        Kept times > 0, the macroscopic start (ny,), and the tolerance of the particles and of their limit, which must
        lie below the errors that are looked for.
    quantiles
        In one dimension: particles at the quantiles, which are not random (one repeat), instead of a random sample.
    store, executor
        A Parquet file that makes an interrupted call go on; who makes the runs: see ``carried_out``.

    Raises
    ------
    InvalidProblem
        If an argument cannot be right.
    SolveFailed
        If a run of the model ends early.

    Source: section 3.5 of chapter 5, (5.59); of N^-1/2, (log N / N)^1/2, N^-1/3 in d = 1, 2, 3 Ajtai, Komlos and
    Tusnady (1984); Fournier and Guillin (2015).
    """
    given = {"t": t, "y0": y0, "v0": v0, "tol": tol, "quantiles": quantiles}
    runs = W1Runs(model, density, sizes, repeats, seed, **given)  # type: ignore[arg-type]
    return runs.result(carried_out(runs.study(), store, executor))


def _distance(groups: list[Floats], law: Density | None) -> float:
    """Return W1 between particles and others, or the density (d = 1)."""
    against = law if len(groups) == 1 else groups[1]
    if against is None:
        raise InvalidProblem("density = None without other particles: one of them must be given")
    return w1(groups[0], against)


def summarised(table: pd.DataFrame, *, random: bool) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the means and the fits of ``W1Rates`` from its table, without quantities that have zeros."""
    means, fits = [], []
    for quantity in QUANTITIES:
        for time, rows in table.groupby("t"):
            if not (rows[quantity] > 0).all():
                continue
            found = [{"N": n} | mean_of(group[quantity], random=random) for n, group in rows.groupby("N")]
            mine = pd.DataFrame(found)
            label = {"quantity": quantity, "t": float(str(time))}
            means.append(mine.assign(**label)[[*label, *mine.columns]])
            fits.append(label | fitted_power(mine))
    return pd.concat(means, ignore_index=True), pd.DataFrame(fits)


def mean_of(values: pd.Series, *, random: bool) -> dict[str, Any]:
    """Return the mean of one size over its repeats, its 95 % interval by Student's t, the deviation of log(value).

    Values that are not random have no scatter: 0. One random value has no interval: NaN.
    """
    many, mean = len(values), values.mean()
    scatter = float(values.std()) if random else 0.0
    half = float(stdtrit(max(many - 1, 1), (1 + CONFIDENCE) / 2)) * scatter / np.sqrt(many)
    return {"repeats": many, "mean": mean, "low": mean - half, "high": mean + half, "deviation": scatter / mean}


def log_points(means: pd.DataFrame) -> tuple[Floats, Floats, Floats]:
    """Return log N, log mean and the standard error of log mean."""
    means = means.sort_values("N")
    deviation = means["deviation"].where(means["repeats"] >= ENOUGH).ffill().fillna(means["deviation"])
    error = (deviation / np.sqrt(means["repeats"])).to_numpy()
    return np.log(means["N"].to_numpy(float)), np.log(means["mean"].to_numpy()), error


def fitted_power(means: pd.DataFrame) -> dict[str, Any]:
    """Fit a power of N to means, as a row of ``W1Rates.fit``; ``constant`` is the mean at N = 1."""
    line = weighted_line(*log_points(means))
    row = {"sizes": len(means), "from": means["N"].min(), "to": means["N"].max(), "slope": line.slope.value}
    row |= {"low": line.slope.low, "high": line.slope.high}
    return row | {"constant": float(np.exp(line.at_zero)), "misfit": line.misfit}


class Slope(NamedTuple):
    """Slope of a line with the ends of its 95 % interval."""

    value: float
    low: float
    high: float


class WeightedLine(NamedTuple):
    """A line: its slope, its value at x = 0, and chi^2 per degree of freedom, NaN for points without errors."""

    slope: Slope
    at_zero: float
    misfit: float


def slope(x: ArrayLike, y: ArrayLike) -> Slope:
    """Return the slope of y (n,) against x (n,), n >= 3, with Student's interval from the residuals."""
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    centred = x - x.mean()
    spread = float(centred @ centred)
    value = float(centred @ y) / spread
    residual = y - y.mean() - value * centred
    freedom = len(x) - 2
    half = float(stdtrit(freedom, 0.5 + 0.5 * CONFIDENCE) * np.sqrt(residual @ residual / freedom / spread))
    return Slope(value, value - half, value + half)


def weighted_line(x: ArrayLike, y: ArrayLike, error: ArrayLike) -> WeightedLine:
    """Fit a line through (x, y) (n,), n >= 3, weighted by the standard errors of y; all of them 0: equal weights.

    The interval of the slope is the larger one of two: from the errors, and by Student's t from the scatter of the
    points about the line.
    """
    x, y, error = (np.asarray(values, dtype=np.float64) for values in (x, y, error))
    exact = not error.any()
    weight = np.ones(len(x)) if exact else error**-2.0
    centre = np.average(x, weights=weight)
    spread = float(weight @ (x - centre) ** 2)
    value = float(weight @ ((x - centre) * y)) / spread
    at_zero = float(np.average(y, weights=weight)) - value * centre
    misfit = float(weight @ (y - at_zero - value * x) ** 2) / (len(x) - 2)
    by_scatter = float(stdtrit(len(x) - 2, (1 + CONFIDENCE) / 2)) * np.sqrt(misfit)
    by_error = 0.0 if exact else float(ndtri((1 + CONFIDENCE) / 2))
    half = max(by_error, by_scatter) * spread**-0.5
    return WeightedLine(Slope(value, value - half, value + half), at_zero, np.nan if exact else misfit)


def _listed(value: int | Sequence[int]) -> list[int]:
    """Return a number, of Python or NumPy, or several, as a list."""
    return [value] if isinstance(value, Integral) else list(value)  # type: ignore[arg-type, list-item]


def _checked_sizes(sizes: Sequence[int]) -> list[int]:
    counts = [integer("sizes", n, least=1) for n in sizes]
    if len(counts) < FEWEST_SIZES or (np.diff(counts) <= 0).any():
        raise InvalidProblem(f"sizes = {describe(list(sizes))}: must be at least {FEWEST_SIZES}, increasing")
    return counts


def _checked_repeats(repeats: int | Sequence[int], sizes: int, quantiles: bool) -> list[int]:
    """Return the repeats of each size."""
    given = _listed(repeats) * (sizes if np.ndim(repeats) == 0 else 1)
    least, most = (1, 1) if quantiles else (2, None)
    many = [integer("repeats", k, least=least, most=most) for k in given]
    if len(many) != sizes:
        raise InvalidProblem(f"repeats = {describe(repeats)}: must be one number, or one for each of {sizes} sizes")
    return many


def _check_limit(model: Model | None, t: Any, y0: Any, v0: Any, tol: Any) -> None:
    """Raise InvalidProblem if arguments of the flow are left out with a model, or given without one."""
    names = [name for name, value in (("t", t), ("y0", y0), ("v0", v0), ("tol", tol)) if value is None]
    if model is None and len(names) < 4:
        raise InvalidProblem("model = None with t, y0, v0 or tol given: must be a Model, or they must be left out")
    if model is not None and names:
        raise InvalidProblem(f"{', '.join(names)} left out: must be given with a model")
    if model is not None and float(np.min(np.asarray(t, dtype=np.float64))) <= 0:
        raise InvalidProblem(f"t = {describe(t)}: must be > 0; the start is looked at anyway")
