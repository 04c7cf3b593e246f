"""DAE, RATTLE, the ODE and its reduction against each other: errors of y, y', X and the multipliers; drift of g."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.study import Key, Row, Study
from meanfield import Motion, solve_rattle
from verification.instruments.meanfield_methods import SOLVERS
from verification.instruments.order import estimate, order_text
from verification.thesis.chapter5 import cases, exact
from verification.thesis.chapter5.methods import applies

Floats = NDArray[np.float64]
MODELS = ("straight", "linear", "wavy", "element", "interacting")
HARMONIC = ("straight", "linear")
PARTICLES = 5
TIMES = np.array([0.0, 1.0, 2.0])
QUANTITIES = ("y", "v", "X", "multipliers")
# The ODE at its tightest tolerance is the reference where there is no closed form; RATTLE of order 8 tells its error.
TIGHTEST, FINEST = 1e-13, 1 / 8
CLAIMED = 1e-9


@dataclass(frozen=True)
class AgreementForm:
    """How far the study goes.

    Attributes
    ----------
    digits
        Of the tolerances, by method.
    steps
        By the order of RATTLE: steps of time 1 over these numbers.
    rattled
        Models for RATTLE, whose runs take longest.
    """

    digits: Mapping[str, Sequence[int]]
    steps: Mapping[int, Sequence[int]]
    rattled: tuple[str, ...] = MODELS
    models: tuple[str, ...] = MODELS


FULL = AgreementForm(
    dict.fromkeys(("ode", "reduced", "dae"), tuple(range(3, 13))),
    {
        2: (5, 10, 20, 40, 80, 160, 320, 640),
        4: (3, 4, 6, 8, 12, 16, 24, 32, 48, 64),
        6: (2, 3, 4, 5, 6, 8, 10, 12, 16),
        8: (2, 3, 4, 5, 6, 7, 8, 10),
    },
)


class TrueMotion(NamedTuple):
    """The true motion, and how far off it may be in each of ``QUANTITIES``."""

    path: exact.ExactMotion
    error: dict[str, float]


def study(form: AgreementForm) -> Study:
    """Plan all methods on all models, a row for each setting."""
    names = [*(f"rattle{order}" for order in sorted(form.steps, reverse=True)), "dae", "ode", "reduced"]
    runs = [
        {"model": name, "method": method}
        for method in names
        for name in reversed(form.models)
        if applies(method, cases.model(name)) and (name in form.rattled or not method.startswith("rattle"))
    ]
    return Study(
        name="meanfield_agreement",
        title="Mean field: agreement",
        key=("model", "method"),
        runs=tuple(runs),
        run=partial(_rows, digits=form.digits, steps=form.steps),
    )


def _rows(key: Key, digits: Mapping[str, Sequence[int]], steps: Mapping[int, Sequence[int]]) -> list[Row]:
    name, method = key["model"], key["method"]
    if method.startswith("rattle"):
        settings = [1 / n for n in steps[int(method[-1])]]
    else:
        settings = [10.0**-k for k in digits[method]]
    model, start, known = cases.model(name), cases.few(name, PARTICLES), reference(name)
    solve = SOLVERS[method]
    return [
        dict(key) | {"setting": setting} | _measured(solve(model, start, TIMES, setting), known) for setting in settings
    ]


@cache
def reference(name: str) -> TrueMotion:
    """Return the closed form, or else the ODE to rounding; its error is its distance from the other way."""
    model, start = cases.model(name), cases.few(name, PARTICLES)
    if name in HARMONIC:
        path = exact.harmonic(name, np.asarray(start.X), TIMES)
        rounding = {quantity: float(np.spacing(np.abs(getattr(path, quantity)).max())) for quantity in QUANTITIES}
        return TrueMotion(path, rounding)
    best = SOLVERS["ode"](model, start, TIMES, TIGHTEST)
    other = solve_rattle(model, start, TIMES, FINEST, 8)
    path = exact.ExactMotion(best.y, best.v, best.X, best.multipliers)
    return TrueMotion(path, {quantity: _apart(other, path, quantity) for quantity in QUANTITIES})


def _apart(motion: Motion, path: exact.ExactMotion, quantity: str) -> float:
    return float(np.abs(getattr(motion, quantity) - getattr(path, quantity)).max())


def _measured(motion: Motion, known: TrueMotion) -> dict[str, Any]:
    energy = motion.energy()
    return (
        # Below its own error the reference does not tell.
        {f"error_{name}": max(_apart(motion, known.path, name), known.error[name]) for name in QUANTITIES}
        | {f"reference_{quantity}": known.error[quantity] for quantity in QUANTITIES}
        | {
            "drift": float(motion.constraint_drift().max()),
            "velocity_drift": float(motion.velocity_drift().max()),
            "energy": float(np.abs(energy - energy[0]).max()),
            "energy_scale": float(np.abs(energy[0])),
        }
        | motion.work._asdict()
    )


def best(table: pd.DataFrame) -> pd.DataFrame:
    """Find each method's best setting on each model, and whether its largest error is at most CLAIMED."""
    errors = [f"error_{quantity}" for quantity in QUANTITIES]
    worst = table.assign(
        worst=table[errors].max(axis=1),
        reference=table[[f"reference_{quantity}" for quantity in QUANTITIES]].max(axis=1),
    )
    found = worst.loc[worst.groupby(["model", "method"])["worst"].idxmin()].reset_index(drop=True)
    columns = [
        "model",
        "method",
        "setting",
        *errors,
        "worst",
        "drift",
        "velocity_drift",
        "reference",
        "unknowns",
        "steps",
    ]
    return found[columns].assign(reached=found["worst"] <= CLAIMED)


def orders(table: pd.DataFrame) -> pd.DataFrame:
    """Fit the order of RATTLE in y and in the multipliers, with the ranges of local orders, for each model."""
    rows = []
    for (name, method), mine in table[table["method"].str.startswith("rattle")].groupby(["model", "method"]):
        fits = {
            quantity: estimate(mine["setting"], mine[f"error_{quantity}"], float(mine[f"reference_{quantity}"].iloc[0]))
            for quantity in ("y", "multipliers")
        }
        row = {"model": name, "method": method, "nominal": int(method[-1])}
        row |= {f"order_{quantity}": order_text(fit) for quantity, fit in fits.items()}
        slope = fits["y"].slope
        rows.append(row | {"slope": np.nan if slope is None else slope, "error": float(mine["error_y"].min())})
    return pd.DataFrame(rows)
