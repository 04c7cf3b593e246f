"""Variance-based sensitivity: how much of the variance of a ratio is due to each parameter of the model, by SALib.

It is a study of its own: each point of the sample is a scenario. The ratio of a point is that of finitely many
replicates. This noise is independent from point to point, as every scenario has its own seeds. It adds to the variance
of the ratios and to the total indices: for a share q of noise in the variance, the expected indices are (1 - q) S1 and
(1 - q) ST + q. The share is estimated from the ratios themselves and taken out again.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from dincl.checks import describe, integer
from dincl.checks import seed as checked_seed
from dincl.errors import InvalidProblem
from tissue.files.parameter_files import flat, nested
from tissue.files.parameters import Parameters
from tissue.statistics.proportions import LEVEL, quantile
from tissue.statistics.ratios import Ratio

RESAMPLES = 200  # of the bootstrap
MOST_NOISE = 0.9  # of the variance; with more, what is left for the parameters is the difference of two large numbers

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Plan:
    """The points of a sensitivity study.

    Attributes
    ----------
    names
        Keys of the parameters that vary, such as "cell.alpha_aa".
    n
        Base points: there are n (number of parameters + 2) points in all.
    points
        The changes of each point to the base: values, as in a file, by key.
    """

    names: tuple[str, ...]
    n: int
    points: tuple[dict[str, Any], ...]

    def scenarios(self) -> dict[str, dict[str, dict[str, Any]]]:
        """Return the overrides of each point, by section and key: {"point 00000": {"cell": {"alpha_aa": 4.2}}}."""
        return {point_name(k): nested(point) for k, point in enumerate(self.points)}

    def toml(self, head: Mapping[str, Any], overrides: Mapping[str, Mapping[str, Any]]) -> str:
        """Return the text of a study file with a scenario for each point.

        Parameters
        ----------
        head
            ``title``, ``base``, ``replicates``, ``seed``.
        overrides
            Of all points, by section and key.
        """
        lines = [f"{key} = {json.dumps(value)}" for key, value in head.items()]
        lines += ["", "[overrides]", *_inline(overrides)]
        for name, sections in self.scenarios().items():
            lines += ["", f'[scenarios."{name}"]', *_inline(sections)]
        return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class Sensitivity:
    """Effect of the parameters on the ratio.

    Attributes
    ----------
    table
        By parameter: ``S1`` [share of the variance it explains alone], ``ST`` [share that is lost if it is fixed, with
        what it does together with others], with ``S1_low``, ``S1_high``, ``ST_low``, ``ST_high``. Noise is taken out.
    noise
        Share of the variance of the ratios that is due to the finite number of replicates.
    deviation
        Standard deviation of the ratio over the parameters, without noise.
    """

    table: pd.DataFrame
    noise: float
    deviation: float


def point_name(k: int) -> str:
    """Return the scenario of a point."""
    return f"point {k:05d}"


def plan_sensitivity(base: Parameters, bounds: Mapping[str, tuple[Any, Any]], n: int, seed: int) -> Plan:
    """Plan points for the estimators of Saltelli: parameters are independent and uniform between their bounds.

    Parameters
    ----------
    base
        What the points change.
    bounds
        Least and largest value, as in a file, both in one unit, by key: {"numerics.mu": ("0.1 h", "0.2 h")}.
    n
        Base points, a power of 2, at least 8.
    seed
        Of the scrambling of the Sobol sequence, >= 0.

    Returns
    -------
    Plan

    Raises
    ------
    InvalidProblem
        If a key or value is unknown, a point is no valid combination, or n is no power of 2.

    Source
    ------
    A. Saltelli et al., Variance based sensitivity analysis of model output, Computer Physics Communications 181 (2010).
    """
    ends = {name: _ends(base, name, pair) for name, pair in bounds.items()}
    if not ends:
        raise InvalidProblem("bounds are empty: must have at least one parameter")
    sample = sobol_points([(low, high) for low, high, _ in ends.values()], n, seed)
    units = [f" {unit}" if unit else "" for *_, unit in ends.values()]
    points = tuple(
        {name: f"{x!r}{unit}" if unit else x for name, x, unit in zip(ends, row, units, strict=True)}
        for row in sample.tolist()
    )
    for point in points:
        base.changed(point)
    return Plan(tuple(ends), n, points)


def analyse(plan: Plan, ratios: Mapping[str, Ratio], *, seed: int, level: float = LEVEL) -> Sensitivity:
    """Estimate S1 and ST of the parameters of a plan.

    Parameters
    ----------
    plan
        Whose scenarios were run.
    ratios
        Of each scenario, by its name.
    seed
        Of the bootstrap, >= 0.
    level
        Of the intervals.

    Returns
    -------
    Sensitivity

    Raises
    ------
    InvalidProblem
        If a scenario has no ratio or one of a single cell, or the ratios hardly vary but for noise.
    """
    names = [point_name(k) for k in range(len(plan.points))]
    if missing := [name for name in names if name not in ratios]:
        raise InvalidProblem(f"no ratio for {len(missing)} scenarios, such as {missing[0]!r}: must have one for each")
    found = [ratios[name] for name in names]
    if small := [name for name, ratio in zip(names, found, strict=True) if ratio.size < 2]:
        raise InvalidProblem(f"ratio of {small[0]!r}: must be of two or more independent cells, for its noise")
    values = np.array([ratio.value for ratio in found])
    # Without bias: the mean of p (1 - p)/(n - 1) over samples is P (1 - P)/n.
    variances = values * (1 - values) / np.array([ratio.size - 1 for ratio in found])
    return indices(plan.names, values, variances, seed=seed, level=level)


def sobol_points(bounds: Sequence[tuple[float, float]], n: int, seed: int) -> Floats:
    """Return points of shape (n (d + 2), d) for first and total indices of d parameters, n a power of 2."""
    from SALib.sample.sobol import sample

    if integer("n", n, least=8) & (n - 1):
        raise InvalidProblem(f"n = {n}: must be a power of 2, as 64 or 128")
    names = [str(k) for k in range(len(bounds))]
    problem = {"num_vars": len(bounds), "names": names, "bounds": [list(pair) for pair in bounds]}
    points: Floats = sample(problem, n, calc_second_order=False, seed=checked_seed("seed", seed))
    return points


def indices(
    names: Sequence[str], values: ArrayLike, variances: ArrayLike, *, seed: int, level: float = LEVEL
) -> Sensitivity:
    """Estimate S1 and ST of numbers with noise, at points by ``sobol_points``.

    Parameters
    ----------
    names
        Of the d parameters.
    values, variances
        (n (d + 2),) numbers, and the variance of the noise in each.
    seed, level
        Of the bootstrap over base points, and of the intervals. They are normal ones, not cut at 0 or 1, and take the
        share of noise as known.

    Returns
    -------
    Sensitivity

    Raises
    ------
    InvalidProblem
        If the values are all the same, or more than ``MOST_NOISE`` of their variance is noise.
    """
    from SALib.analyze import sobol

    quantile(level)  # refuses a bad level
    y, step = np.asarray(values, dtype=np.float64), len(names) + 2
    independent = np.concatenate([y[::step], y[step - 1 :: step]])  # what the indices are shares of the variance of
    noisy = np.asarray(variances, dtype=np.float64)
    noise = float(np.concatenate([noisy[::step], noisy[step - 1 :: step]]).mean())
    variance = float(independent.var())
    if not noise <= MOST_NOISE * variance or np.ptp(y) == 0:
        raise InvalidProblem(
            f"variance of the values = {variance:.3g}, of their noise = {noise:.3g}: the noise must be at most "
            f"{100 * MOST_NOISE:.0f} % of it; more replicates or wider bounds are needed"
        )
    problem = {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}
    options = {"calc_second_order": False, "num_resamples": RESAMPLES, "conf_level": level}
    raw = sobol.analyze(problem, y, **options, seed=checked_seed("seed", seed) + 1)  # 0 would stand for none
    share = noise / variance
    table = pd.DataFrame(index=pd.Index(list(names), name="parameter", dtype=object))
    for name, bias in (("S1", 0.0), ("ST", share)):
        middle, half = (raw[name] - bias) / (1 - share), raw[f"{name}_conf"] / (1 - share)
        table[name], table[f"{name}_low"], table[f"{name}_high"] = middle, middle - half, middle + half
    return Sensitivity(table, share, float(np.sqrt(variance - noise)))


def _ends(base: Parameters, name: str, pair: tuple[Any, Any]) -> tuple[float, float, str]:
    """Return the bounds of a parameter as numbers with their unit, "" for none."""
    texts = [str(flat(base.changed({name: value}).as_dict())[name]).split(" ", 1) for value in pair]
    units = [" ".join(rest) for _, *rest in texts]
    try:
        low, high = (float(number) for number, *_ in texts)
    except ValueError as error:
        raise InvalidProblem(f"bounds of {name} = {describe(pair)}: must be two numbers or quantities") from error
    if units[0] != units[1] or not low < high:
        raise InvalidProblem(f"bounds of {name} = {describe(pair)}: must rise, in one unit")
    return low, high, units[0]


def _inline(sections: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return sections as inline tables of TOML."""
    return [
        f"{section} = {{ {', '.join(f'{key} = {json.dumps(value)}' for key, value in flat(table).items())} }}"
        for section, table in sections.items()
    ]
