"""``tissue.fit`` and ``tissue.sensitivity``: the design of a fit is run, and its results answer from the table."""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree
from scipy.stats import chi2

from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from tissue.fitting.design import NAME, design, sobol_points
from tissue.fitting.emulator import Emulator, emulate
from tissue.fitting.plan import Fit, check_data, load_fit
from tissue.fitting.posterior import Posterior, posterior
from tissue.state.cells import Floats
from tissue.study.store import refuse_others

if TYPE_CHECKING:
    import pandas as pd

# A parameter is identified if its interval is shorter than this part of its range, as seen in its scale.
IDENTIFIED = 0.5
# Correlation of two parameters from which on data fix a combination of them better than either.
TOGETHER = 0.8
# An interval that ends so near the end of a range is cut by it.
NEAR_END = 0.02
# Probability of a misfit below which the model is said not to fit; values this many deviations off are named.
MISFIT, OFF = 0.01, 3.0
LEAST_CALIBRATION, MOST_FAILED, LEAST_EFFECTIVE = 0.9, 0.05, 200


def fit(
    file: str | os.PathLike[str] | Fit, out: str | os.PathLike[str], executor: Executor | None = None
) -> FitResults:
    """Run the design of a fit where runs are missing, and fit its parameters to the data.

    Runs at Sobol points of the ranges, several of each, give the mean and the covariance of what was measured as
    functions of the parameters (``tissue.fitting.emulator``). With them the posterior of the parameters follows from
    the data: uniform ranges, normal errors, and tissues that differ as those of the model. The same call goes on after
    an interruption, and with more ``points`` in the file from those that there are.

    Parameters
    ----------
    file
        A fit file, or what ``load_fit`` made of one.
    out
        The folder of the runs: new, empty, or of this fit. A table of other ranges or outputs is set aside there.
    executor
        Computes the runs; None: threads on the cores of this machine.

    Raises
    ------
    InvalidProblem
        If the file is not in order, ``out`` cannot be used, or too few points have runs that did not fail.
    """
    plan = file if isinstance(file, Fit) else load_fit(file)
    return FitResults(plan, _run(plan, out, executor))


def sensitivity(
    file: str | os.PathLike[str] | Fit, out: str | os.PathLike[str], executor: Executor | None = None
) -> pd.DataFrame:
    """Compute how much each parameter of a fit file matters for each output; its data need no values.

    Arguments and errors are those of ``fit``, the table that of ``FitResults.sensitivity``.
    """
    plan = file if isinstance(file, Fit) else load_fit(file, values=False)
    return FitResults(plan, _run(plan, out, executor)).sensitivity()


def _run(plan: Fit, out: str | os.PathLike[str], executor: Executor | None) -> pd.DataFrame:
    """Make the runs that are missing; return the table of all."""
    folder = checked_path("out", out)
    threads = ThreadPoolExecutor(len(os.sched_getaffinity(0))) if executor is None else nullcontext(executor)
    try:
        refuse_others(folder, "fit", NAME)
        with threads as workers:
            table = design(plan).complete(folder, workers)
    except OSError as error:
        raise InvalidProblem(f"{folder}: must be a folder that can be written to: {error}") from error
    return table[table["point"] < plan.points]


@dataclass(frozen=True, eq=False)
class FitResults:
    """What the data of a fit say about its parameters; made by ``tissue.fit``.

    Attributes
    ----------
    fit
        Its file.
    runs
        The design, a row for each run: ``point``, ``replicate``, ``seed``, ``status``, and the outputs.
    """

    fit: Fit
    runs: pd.DataFrame

    def given(self, data: pd.DataFrame) -> FitResults:
        """Return the results for other data of the same measures and times, or some of them, from the same runs."""
        other = replace(self.fit, data=check_data(data, "data", values=True))
        if unknown := sorted({*other.outputs} - {*self.runs}):
            kept = ", ".join(self.fit.outputs)
            raise InvalidProblem(f"data: {unknown[0]} was not kept of the runs: must be among {kept}")
        return FitResults(other, self.runs)

    @cached_property
    def points(self) -> Floats:
        """The parameters of the points, (points, d) in [-1, 1] of the ranges."""
        parts = zip(self.fit.ranges, sobol_points(self.fit, self.fit.points).T, strict=True)
        return 2 * np.column_stack([one.of_runs(part) for one, part in parts]) - 1

    @cached_property
    def emulator(self) -> Emulator:
        """Mean and covariance of the outputs."""
        outputs = self.fit.outputs
        by_point = dict(iter(self.runs.loc[self._sound].groupby("point")[outputs]))
        none = np.empty((0, len(outputs)))
        runs = [by_point[k].to_numpy(float) if k in by_point else none for k in range(len(self.points))]
        try:
            return emulate(self.points, runs)
        except InvalidProblem as error:
            had = self.runs[outputs].notna().sum()
            raise InvalidProblem(f"{error}; of {len(self.runs)} runs {had.min()} have {had.idxmin()}") from None

    @cached_property
    def posterior(self) -> Posterior:
        """The posterior of the parameters, in [-1, 1] of the ranges."""
        values, errors = self.fit.data[["value", "standard_error"]].to_numpy(float).T
        return posterior(self.emulator, values, errors, self.fit.tissues)

    @property
    def _sound(self) -> pd.Series:
        """Whether all outputs of a run were measured."""
        return (self.runs["status"] == "SUCCESS") & self.runs[self.fit.outputs].notna().all(axis=1)

    def intervals(self) -> pd.DataFrame:
        """Return a row for each parameter: ``parameter``, ``unit``, ``low``, ``median``, ``high`` of its 95 % interval,
        ``of_range``, the part of its range that this covers, on its scale, and whether it is ``identified``.
        """
        import pandas as pd

        rows = []
        for one, ends in zip(self.fit.ranges, self.posterior.quantiles(), strict=True):
            low, median, high = one.value((1 + ends) / 2)
            part = float(ends[2] - ends[0]) / 2
            rows.append((one.key, one.unit, low, median, high, part, part < IDENTIFIED))
        return pd.DataFrame(rows, columns=["parameter", "unit", "low", "median", "high", "of_range", "identified"])

    def sample(self, number: int = 1000) -> pd.DataFrame:
        """Return draws from the posterior, a column for each parameter in its unit."""
        import pandas as pd

        drawn = (1 + self.posterior.drawn(number)) / 2
        return pd.DataFrame({one.key: one.value(line) for one, line in zip(self.fit.ranges, drawn.T, strict=True)})

    def predicted(self) -> pd.DataFrame:
        """Return the data with what the fitted model gives: ``mean``, its 95 % interval ``low`` to ``high`` for as many
        tissues, and ``off``, the difference of the value and the mean over the standard deviation of both.
        """
        chosen = self.posterior.drawn(400)
        means, own = self.emulator.mean.at(chosen), self.emulator.covariance(chosen, self.fit.tissues)
        mean = means.mean(axis=0)
        variance = means.var(axis=0) + np.diagonal(own, axis1=1, axis2=2).mean(axis=0)
        table, s = self.fit.data, 1.96 * np.sqrt(variance)
        off = (table["value"] - mean) / np.sqrt(variance + table["standard_error"] ** 2)
        return table.assign(mean=mean, low=mean - s, high=mean + s, off=off)

    def p_value(self) -> float:
        """Return the probability of a misfit as large as that of the best parameters, if the model is right.

        The square of the distance of data and model, over the covariance of both, has the distribution chi^2 then, with
        the number of data less that of identified parameters; NaN where that is not positive.
        """
        freedom = len(self.fit.data) - int(self.intervals()["identified"].sum())
        return float(chi2.sf(self.posterior.misfits.min(), freedom)) if freedom > 0 else float("nan")

    def sensitivity(self) -> pd.DataFrame:
        """Return a row for each output and parameter: the part of the variance of the mean of runs that the parameter
        makes alone (``first``), and with the others (``total``), with 95 % intervals ``first_low``, ..., and
        ``chance``, the part of the variance of a single run that no parameter makes. Parameters are uniform in their
        ranges, on their scales.
        """
        import pandas as pd

        found, emulator, rows = self.emulator.sensitivity(), self.emulator, []
        made = np.square(emulator.mean.coefficients[1:]).sum(axis=0)
        chance = emulator.between / (emulator.between + made)
        for j, output in enumerate(self.fit.outputs):
            for i, one in enumerate(self.fit.ranges):
                rows.append((output, one.key, *found[i, j].ravel(), chance[j]))
        ends = [f"{name}{end}" for name in ("first", "total") for end in ("", "_low", "_high")]
        return pd.DataFrame(rows, columns=["output", "parameter", *ends, "chance"])

    def remarks(self) -> list[str]:
        """Return what must be known before the intervals: what is not identified first, then what does not fit."""
        return [*self._not_identified(), *self._misfits(), *self._weak()]

    def _not_identified(self) -> Iterator[str]:
        found = self.intervals()
        for row in found[~found["identified"]].itertuples():
            yield f"{row.parameter} is not identified: its 95 % interval covers {100 * row.of_range:.0f} % of the range"
        correlations = self.posterior.correlations()
        for i, j in zip(*np.triu_indices(len(correlations), 1), strict=True):
            if abs(correlations[i, j]) > TOGETHER:
                pair = f"{found['parameter'][i]} and {found['parameter'][j]}"
                yield f"{pair} are identified together only: their correlation is {correlations[i, j]:.2f}"
        for row, ends in zip(found.itertuples(), self.posterior.quantiles(), strict=True):
            if row.identified and max(-ends[0], ends[2]) > 1 - NEAR_END:
                yield f"{row.parameter}: its interval ends where the range ends, which may have to be wider"

    def _misfits(self) -> Iterator[str]:
        if (p := self.p_value()) < MISFIT:
            yield f"The model does not fit the data (p = {p:.1g}): intervals mean nothing before it is known why"
        table = self.predicted()
        for row in table[table["off"].abs() > OFF].itertuples():
            yield f"{row.measure} at {row.time_h:g} h is {abs(row.off):.3g} deviations from the fitted model"

    def _weak(self) -> Iterator[str]:
        if (share := self.emulator.calibration()) < LEAST_CALIBRATION:
            found = f"{100 * share:.0f} % of points left out are in its 95 % intervals"
            yield f"The emulator is weak: {found}; take more points"
        if (failed := 1 - self._sound.mean()) > MOST_FAILED:
            said = f"{100 * failed:.0f} % of the runs failed or were folded, and are left out"
            yield f"{said}, {100 * self._failed_near():.0f} % of those next to the posterior; ranges may be too wide"
        if (effective := self.posterior.effective) < LEAST_EFFECTIVE:
            yield f"The posterior stands on {effective:.0f} points only; take fewer parameters, or narrower ranges"

    def _failed_near(self) -> float:
        """Return the part of runs that failed at the points next to draws from the posterior."""
        _, nearest = KDTree(self.points).query(self.posterior.drawn(400))
        return 1 - float(self._sound.groupby(self.runs["point"]).mean().loc[nearest].mean())

    def __repr__(self) -> str:
        return f"FitResults({self.fit.title!r}, {len(self.runs)} runs)"

    def _repr_html_(self) -> str:
        """Return the remarks and the intervals."""
        said = "".join(f"<li>{line}</li>" for line in self.remarks())
        return f"<ul>{said}</ul>{self.intervals().to_html(index=False)}"
