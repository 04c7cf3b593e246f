"""Frozen tissues in space: substeps of PBD against catch-up, as ``chapter3.catch_up`` in the plane, by counted work."""

from __future__ import annotations

from dataclasses import asdict
from functools import partial

import numpy as np
import pandas as pd

import dincl
from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters
from tissue.quasi_steady.frozen import frozen_problem_in_space
from tissue.state.cells import Floats
from verification.beyond.space.frozen import (
    FrozenInSpace,
    begun_in_space,
    least_steps,
    open_sheet,
    substepped_in_space,
)
from verification.thesis.chapter3.catch_up import SCHEMES, SECOND_ORDER, CatchUpForm
from verification.thesis.chapter3.growing import rms

CELLS, AGE = 64, 2.0
# Of the start, which is the same for all methods: Ipopt does not get nearer to S for each seed.
START_TOL = 1e-9
SUBSTEPS = (1, 2, 5, 10, 20, 40, 80, 160, 320, 640, 1280, 2560)
FULL = CatchUpForm(5, SUBSTEPS, (15, 30, 60, 120, 240), 960)


def study(form: CatchUpForm) -> Study:
    """Plan one run for each seed."""
    return Study(
        name="space_catch_up",
        title="Tissue in space: catch-up",
        key=("seed",),
        runs=tuple({"seed": seed} for seed in range(form.seeds)),
        run=partial(moved, form=form, parameters=open_sheet(CELLS, AGE)),
        settings=asdict(form) | {"seeds": None},  # more seeds are more runs
    )


def moved(key: Key, form: CatchUpForm, parameters: Parameters) -> list[Row]:
    """Return a row for each method and number of steps in dt: error of the nuclei and counted work.

    The reference is MidpointCatchUp with its error of h^2 taken out. Contacts that begin, and the tolerance of the
    projections, leave it less than order 2 at the finest steps: so its own error is said to be the whole change that
    the last halving of its step makes, not a third of it. ``calls``: evaluations of the forces; ``pairs``: pairs of
    nuclei looked at in them.
    """
    state = begun_in_space(parameters, key["seed"], START_TOL)
    fine = [_by_scheme(state, "MidpointCatchUp", form.reference // k)[0] for k in (2, 1)]
    true, own = fine[1] + (fine[1] - fine[0]) / SECOND_ORDER, rms(fine[1].T, fine[0].T)
    about = dict(key) | {"cells": len(state.frame.cells.x), "own": own, "least": least_steps(state)}
    rows: list[Row] = []
    for method, counts in {"PBD": form.substeps, **dict.fromkeys(SCHEMES, form.steps)}.items():
        for steps in counts:
            x, calls, pairs = _by_pbd(state, steps) if method == "PBD" else _by_scheme(state, method, steps)
            made = {"method": method, "steps": steps, "rms": rms(x.T, true.T), "calls": calls, "pairs": pairs}
            rows.append(about | made)
    return rows


def _by_pbd(state: FrozenInSpace, steps: int) -> tuple[Floats, int, int]:
    """Return nuclei (n, 3) after dt by the kernel, evaluations of the forces, and pairs looked at."""
    x, pairs = substepped_in_space(state, steps)
    return x[: len(state.frame.cells.x)], steps, pairs


def _by_scheme(state: FrozenInSpace, name: str, steps: int) -> tuple[Floats, int, int]:
    """Return the same by a scheme, NaN if a step fails; the drift looks at all pairs."""
    n, dt, calls = len(state.frame.cells.x), state.numbers.dt, 0
    problem = frozen_problem_in_space(*state)

    def counted(t: float, x: Floats) -> Floats:
        nonlocal calls
        calls += 1
        return problem.velocity(t, x)

    again = dincl.Problem(problem.x0, counted, problem.constraints)
    calls = 0
    found = dincl.solve(again, SCHEMES[name](dt / steps), t=[dt], throw=False)
    return (found.final[:n] if found.status else np.full((n, 3), np.nan)), calls, calls * n * (n - 1) // 2


def errors(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each method and number of steps: median error and work over the seeds, runs lost."""
    grouped = table.groupby(["method", "steps"])
    made = grouped[["rms", "calls", "pairs", "own", "least"]].median().reset_index()
    return made.assign(lost=grouped["rms"].apply(lambda error: int(error.isna().sum())).to_numpy())
