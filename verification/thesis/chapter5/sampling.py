"""Rates at which N particles represent a density: E W1 against N at t = 0, random starts in d = 1, 2, 3 and quantiles.

In one dimension W1(mu_N, mu) is exact. In two and three, W1(mu_N, mu'_N) of two independent samples is taken, between
proved bounds. Both have the same rate: mu is the mean of mu'_N and W1 is convex, so that

    E W1(mu_N, mu) <= E W1(mu_N, mu'_N) <= 2 E W1(mu_N, mu).

The complete form takes three quarters of an hour: ``python -m verification.thesis.chapter5.sampling FOLDER``.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.special import ndtri

from dincl.study import Key, Row, Study, workers
from meanfield import Density
from verification.instruments.lines import CONFIDENCE
from verification.instruments.rates import IID, PAIR, QUANTILES, distance, draw, fitted_power, log_points, mean_of
from verification.page.kept import DATA, keep

FILE = DATA / "w1_rates.parquet"
KEY = ("d", "start", "N", "repeat")
# N: repeats. They fall with the cost of a value; at 1e5 in two dimensions it is four minutes.
COUNTS = {
    1: {n: 400 if n <= 10_000 else 100 for n in (10, 30, 100, 300, 1000, 3000, 10_000, 30_000, 100_000)},
    2: {10: 400, 30: 400, 100: 400, 300: 200, 1000: 100, 3000: 40, 10_000: 16, 30_000: 6, 100_000: 3},
    3: {10: 400, 30: 400, 100: 400, 300: 200, 1000: 100, 3000: 40, 10_000: 16, 30_000: 6, 100_000: 3},
}
# (upper - lower) / upper of exact transport: far below the scatter of the repeats.
GAP = 1e-4
# Random numbers: stream (d, N, repeat) of this seed.
SEED = 20260105
# Fits begin where the faces of the cube no longer touch most particles.
FIRST = 100
Floats = NDArray[np.float64]


class Law(NamedTuple):
    """(E W1)^power = a term_1 + b term_2 in dimension d; terms: (N, log N) -> one or two arrays."""

    d: int
    name: str
    power: int
    terms: Callable[[Floats, Floats], list[Floats]]


# In one dimension a = sqrt(pi / 32), the mean of int |B| for the Brownian bridge B. In two the logarithm is that of
# Ajtai, Komlos and Tusnady (1984): disorder of all scales adds up. In three, that of the scale of the cube adds N^-1/2.
LAWS = (
    Law(1, "a N^-1/2", 1, lambda n, log: [n**-0.5]),
    Law(2, "a N^-1/2", 1, lambda n, log: [n**-0.5]),
    Law(2, "a (log N / N)^1/2", 1, lambda n, log: [np.sqrt(log / n)]),
    Law(2, "a N^-1/2 log N", 1, lambda n, log: [log * n**-0.5]),
    Law(2, "((a + b log N) / N)^1/2", 2, lambda n, log: [1 / n, log / n]),
    Law(3, "a N^-1/3", 1, lambda n, log: [n ** (-1 / 3)]),
    Law(3, "a N^-1/3 + b N^-1/2", 1, lambda n, log: [n ** (-1 / 3), n**-0.5]),
)


def known(d: int, start: str) -> float:
    """Return the exponent p of the known rate N^p, in two dimensions without its logarithm."""
    return -1.0 if start == QUANTILES else -1.0 / max(d, 2)


def value(key: Key) -> list[Row]:
    """Compute one distance on the unit cube: one row."""
    d, count = key["d"], key["N"]
    density = Density.uniform(np.zeros(d), np.ones(d))
    rng = np.random.default_rng(np.random.SeedSequence(SEED, spawn_key=(d, count, key["repeat"])))
    began = time.process_time()
    lower, upper = distance(density, *draw(density, key["start"], count, rng), GAP)
    seconds = time.process_time() - began
    return [dict(key) | {"w1": (lower + upper) / 2, "lower": lower, "upper": upper, "seconds": seconds}]


def study() -> Study:
    """Return the study: runs by falling size; of one size each dimension comes before any repeat."""
    found: list[Key] = [{"d": 1, "start": QUANTILES, "N": n, "repeat": 0} for n in COUNTS[1]]
    for d, counts in COUNTS.items():
        start = IID if d == 1 else PAIR
        found += [{"d": d, "start": start, "N": n, "repeat": k} for n, many in counts.items() for k in range(many)]
    runs = sorted(found, key=lambda key: (-key["N"], key["repeat"]))
    return Study("w1_rates", "Mean field: rates of W1", KEY, tuple(runs), value)


def means(table: pd.DataFrame) -> pd.DataFrame:
    """Average W1 over the repeats, with its 95 % interval by Student's t, for each d, start and N.

    ``deviation`` is that of log W1 in one run, approximately; 0 for quantiles, which are not random. One random run has
    no interval: NaN.
    """
    rows = []
    for (d, start, n), group in table.groupby(["d", "start", "N"]):
        found = {"d": d, "start": start, "N": n} | mean_of(group["w1"], random=start != QUANTILES)
        rows.append(found | {"seconds": group["seconds"].mean()})
    return pd.DataFrame(rows)


def exponents(found: pd.DataFrame) -> pd.DataFrame:
    """Fit the slope p of log E W1 = c + p log N with its 95 % interval, for each d and start; add the known one.

    Least squares on the rows of ``means``, weighted by their errors; the interval is the larger one of two: from these
    errors, and by Student's t from the scatter of the means about the line. ``misfit`` is chi^2 per degree of freedom,
    NaN for quantiles, which have no errors.
    """
    rows = []
    for (d, start), group in found[found["N"] >= FIRST].groupby(["d", "start"]):
        rows.append({"d": d, "start": start, "known": known(d, start)} | fitted_power(group))
    columns = ["d", "start", "sizes", "from", "to", "exponent", "low", "high", "known", "misfit"]
    return pd.DataFrame(rows).rename(columns={"slope": "exponent"})[columns]


def laws(found: pd.DataFrame) -> pd.DataFrame:
    """Fit ``LAWS`` to ``means``, N >= 100: a and b with half their 95 % intervals, and how they fit.

    ``misfit`` is chi^2 per degree of freedom, about 1 for a law that describes the data; ``largest`` is the largest
    relative distance of a mean from the law.
    """
    rows = []
    for law in LAWS:
        random = found[(found["d"] == law.d) & (found["start"] != QUANTILES) & (found["N"] >= FIRST)]
        x, y, error = log_points(random)
        target = np.exp(law.power * y)
        basis = np.stack(law.terms(np.exp(x), x), axis=1) / (law.power * target * error)[:, None]
        covariance = np.linalg.inv(basis.T @ basis)
        terms = covariance @ basis.T @ (1 / (law.power * error))
        ratio = (basis @ terms) * law.power * error
        misfit = float((((ratio - 1) / (law.power * error)) ** 2).sum()) / (len(x) - len(terms))
        half = ndtri((1 + CONFIDENCE) / 2) * np.sqrt(np.diag(covariance) * max(1.0, misfit))
        row = dict(zip(("a", "a_half", "b", "b_half"), np.stack([terms, half], axis=1).ravel().tolist(), strict=False))
        largest = np.abs(np.maximum(ratio, 0.0) ** (1 / law.power) - 1).max()
        rows.append({"d": law.d, "law": law.name} | row | {"misfit": misfit, "largest": largest})
    return pd.DataFrame(rows)


def main(folder: Path) -> None:
    """Complete the study, and keep its table."""
    with workers() as executor:
        keep(study().complete(folder, executor), FILE, main)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
