"""Limits of DAHA in its four parameters: one step of a tissue, the others as in Table 4."""
# ruff: noqa: RUF001 - axes for readers are written with Greek letters

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pandas as pd

from dincl.status import Status
from dincl.study import Study
from tissue.quasi_steady.daha import TissueArrowHurwicz
from verification.thesis.chapter2.stability.plane import Axis, Plane
from verification.thesis.chapter3 import linear, maps
from verification.thesis.chapter3.judged import begun, floored

# Iterations after which a step counts as not terminated, and the least violation that a reader would see [R_soft].
MOST, SEEN = 25_000, 0.01
AGE = 5.0
OUTCOMES = ("terminated", "violated", "not terminated", "not finite")
FACTORS = tuple(10.0 ** (k / 4) for k in range(-8, 13))
# Tissues that the maps are of, by the name of the column "method".
SEEDS = {"0": "Seed 0", "1": "Seed 1"}


def limit() -> float:
    """Return the bound of dtau^2 alpha lambda for stable eigenvalues lambda of D^2 W, whatever c is.

    (3.25) for one eigenvalue: (1 + a) s^2 - (2 - k) s + (1 - a) = 0 with k = dtau^2 alpha lambda. |s| < 1 if and only
    if a > 0 and the value at s = -1 is positive: (1 + a) + (2 - k) + (1 - a) = 4 - k > 0.
    """
    return 4.0


@cache
def steepest(seed: int) -> float:
    """Return the largest eigenvalue of D^2 W where DAHA of Table 4 stops in the step of the maps."""
    parameters = floored()
    state = begun(parameters, seed, AGE)
    reached = TissueArrowHurwicz(parameters.daha_numbers()).minimise(*state).cells
    return float(linear.largest(linear.hessian(reached, state.layers, state.numbers)))


def stepped(seed: str, **factors: float) -> dict[str, Any]:
    """Return the outcome of one step with some parameters times their factors, and the limit of the factor of alpha."""
    parameters = floored()
    own = parameters.daha_numbers()
    changed = {name: getattr(own, name) * factor for name, factor in factors.items()}
    numbers = own._replace(most_iterations=MOST, **changed)
    found = TissueArrowHurwicz(numbers).minimise(*begun(parameters, int(seed), AGE))
    return {
        "outcome": _outcome(found.status, found.violation),
        "iterations": found.iterations,
        "violation": found.violation,
        "energy": found.energy,
        "limit": limit() / (own.dtau**2 * own.alpha * steepest(int(seed))),
    }


def _outcome(status: Status, violation: float) -> str:
    if status is Status.SUCCESS:
        return OUTCOMES[0] if violation <= SEEN else OUTCOMES[1]
    return OUTCOMES[2] if status is Status.NOT_CONVERGED else OUTCOMES[3]


def descent(method: str, x: float, y: float) -> dict[str, Any]:
    """Return the outcome of one step over alpha and beta."""
    return stepped(method, alpha=x, beta=y)


def damping(method: str, x: float, y: float) -> dict[str, Any]:
    """Return the outcome of one step over gamma and c."""
    return stepped(method, gamma=x, c=y)


def _axis(name: str) -> Axis:
    return Axis(f"{name} / Table 4", FACTORS)


PLANES = (
    Plane("descent", "α and β", _axis("α"), _axis("β"), SEEDS, descent, ()),
    Plane("multipliers", "γ and c", _axis("γ"), _axis("c"), SEEDS, damping, ()),
)


@dataclass(frozen=True)
class DahaLimitsForm:
    """Planes to map."""

    planes: tuple[Plane, ...] = PLANES


# There is one form only.
FORM = DahaLimitsForm()


def study(plane: Plane) -> Study:
    """Return all cells of a map."""
    return maps.named(plane, "tissue_daha", "Tissue, DAHA")


def held(tables: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """Return one row for each seed and parameter: the factors, around Table 4, between which a step ends well.

    ``from`` and ``to`` are those next to 1 from which on all terminate without a violation that is seen; beside them
    what is met beyond. The limit of alpha is that of the linear theory.
    """
    rows = []
    for plane, names in zip(PLANES, (("alpha", "beta"), ("gamma", "c")), strict=True):
        for seed, table in tables[plane.name].groupby("method"):
            for name, along, across in zip(names, "xy", "yx", strict=True):
                line = table[np.isclose(table[across], 1.0, rtol=maps.ROUNDING)].sort_values(along)
                predicted = float(table["limit"].iloc[0]) if name == "alpha" else np.nan
                rows.append({"seed": seed, "parameter": name} | _around(line, along) | {"limit": predicted})
    return pd.DataFrame(rows)


def _around(line: pd.DataFrame, along: str) -> dict[str, Any]:
    """Return the factors around 1 between which a line of cells ends well."""
    good, factor = (line["outcome"] == OUTCOMES[0]).to_numpy(), line[along].to_numpy()
    middle = int(np.argmin(np.abs(np.log(factor))))
    below, above = np.flatnonzero(~good[: middle + 1]), middle + np.flatnonzero(~good[middle:])
    first = int(below[-1]) + 1 if below.size else 0
    last = int(above[0]) - 1 if above.size else len(factor) - 1
    outcome = line["outcome"].to_numpy()
    return {
        "from": factor[first] if first <= last else np.nan,
        "to": factor[last] if first <= last else np.nan,
        "below": outcome[first - 1] if first else "as far as tried",
        "above": outcome[last + 1] if last + 1 < len(factor) else "as far as tried",
    }
