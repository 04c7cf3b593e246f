"""The overdamped motion of a frozen tissue: substeps of PBD against catch-up, to which a reference belongs."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

import dincl
from dincl import Scheme
from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters
from tissue.quasi_steady.frozen import frozen_problem, made_feasible, particles
from verification.instruments.order import estimate, order_text
from verification.thesis.chapter3 import linear
from verification.thesis.chapter3.frozen import Frozen
from verification.thesis.chapter3.jitter import substepped
from verification.thesis.chapter3.judged import begun, floored

Floats = np.ndarray
AGE = 5.0
TOL = 1e-10
REPEATS = 5
# A scheme whose error falls as h^2 is off by a third of the change that halving the step makes.
SECOND_ORDER = 3.0
SCHEMES: dict[str, Callable[[float], Scheme]] = {
    "LinearisedCatchUp": lambda dt: dincl.LinearisedCatchUp(dt, dincl.ProjectedCG(tol=TOL)),
    "MidpointCatchUp": lambda dt: dincl.MidpointCatchUp(dt, dincl.ProjectedCG(tol=TOL)),
}


@dataclass(frozen=True)
class CatchUpForm:
    """Extent of the study: number of seeds, steps in dt of PBD, of catch-up, and of the reference."""

    seeds: int
    substeps: tuple[int, ...]
    steps: tuple[int, ...]
    reference: int


SUBSTEPS = (1, 2, 5, 10, 20, 40, 80, 160, 320, 640)
FULL = CatchUpForm(5, (*SUBSTEPS, 1280, 2560), (20, 40, 80, 160, 320, 640), 2560)


def study(form: CatchUpForm) -> Study:
    """Return the study: one run for each seed."""
    return Study(
        name="tissue_catch_up",
        title="Tissue: catch-up",
        key=("seed",),
        runs=tuple({"seed": seed} for seed in range(form.seeds)),
        run=partial(moved, form=form, parameters=floored()),
        settings=asdict(form) | {"seeds": None},  # more seeds are more runs
    )


def moved(key: Key, form: CatchUpForm, parameters: Parameters) -> list[Row]:
    """Return one row for each method and number of steps in dt: error of the nuclei and seconds.

    The reference is MidpointCatchUp with its error of h^2 taken out; it is off by no more than what was taken out.
    """
    given = begun(parameters, key["seed"], AGE)
    state = given._replace(cells=made_feasible(*given, dincl.Ipopt(tol=TOL)))
    fine = [_by_scheme(state, "MidpointCatchUp", form.reference // k)[0] for k in (2, 1)]
    true, own = fine[1] + (fine[1] - fine[0]) / SECOND_ORDER, _rms(fine[1], fine[0]) / SECOND_ORDER
    limit = linear.LIMIT / linear.largest(linear.hessian(*state))
    about = dict(key) | {"own": own, "least": state.numbers.dt / state.numbers.mu / float(limit)}
    rows: list[Row] = []
    for method, counts in {"PBD": form.substeps, **dict.fromkeys(SCHEMES, form.steps)}.items():
        for steps in counts:
            x, seconds = _by_pbd(state, steps) if method == "PBD" else _by_scheme(state, method, steps)
            rows.append(about | {"method": method, "steps": steps, "rms": _rms(x, true), "seconds": seconds})
    return rows


def _by_pbd(state: Frozen, steps: int) -> tuple[Floats, float]:
    """Return nuclei (n, 2) after dt, by the kernel; best of the repeats."""
    scale = state.numbers.dt / steps / state.numbers.mu
    seconds = []
    for _ in range(REPEATS):
        began = time.process_time()
        cells = substepped(state.cells, state.layers, state.numbers, scale, steps)
        seconds.append(time.process_time() - began)
    n = len(state.cells.x)
    return (np.full((n, 2), np.nan) if cells is None else particles(cells)[:n]), min(seconds)


def _by_scheme(state: Frozen, name: str, steps: int) -> tuple[Floats, float]:
    """Return nuclei (n, 2) after dt, NaN if a step fails."""
    n, dt = len(state.cells.x), state.numbers.dt
    problem = frozen_problem(*state)
    began = time.process_time()
    found = dincl.solve(problem, SCHEMES[name](dt / steps), t=[dt], throw=False)
    seconds = time.process_time() - began
    return (found.final[:n] if found.status else np.full((n, 2), np.nan)), seconds


def _rms(x: Floats, y: Floats) -> float:
    return float(np.sqrt(((x - y) ** 2).sum(axis=1).mean()))


def errors(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each method and number of steps: median error and seconds over the seeds."""
    grouped = table.groupby(["method", "steps"])
    made = grouped[["rms", "seconds", "own", "least"]].median().reset_index()
    return made.assign(lost=grouped["rms"].apply(lambda rms: int(rms.isna().sum())).to_numpy())


def orders(made: pd.DataFrame, dt: float) -> pd.DataFrame:
    """Return one row for each method with enough steps: the order in h beyond the limit of explicit Euler."""
    rows: list[dict[str, Any]] = []
    for method, mine in made[made["steps"] > made["least"]].groupby("method"):
        if len(mine) < 5:  # what an order takes
            continue
        found = estimate(dt / mine["steps"], mine["rms"], floor=float(mine["own"].iloc[0]))
        rows.append({"method": method, "order": order_text(found), "verdict": found.verdict})
    return pd.DataFrame(rows, columns=["method", "order", "verdict"])
