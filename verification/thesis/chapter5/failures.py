"""Failures of the methods of the mean-field chapter, predicted and found."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import pandas as pd

from dincl.study import Key, Row, Study
from verification.thesis.chapter5.methods import LABELS
from verification.thesis.chapter5.provoked import (
    KERNELS,
    PARTICLE_SOLVERS,
    Provoked,
    blow_up,
    flat_element,
    fold,
    left_grid,
    off_constraint,
    rattle_limit,
    stiff_steps,
    through_zero,
    unbounded_kernel,
)


@dataclass(frozen=True)
class Failure:
    """What fails, by which solver ("" if any), and how to look for it."""

    title: str
    solver: str
    look: Callable[[], Provoked]


FAILURES = {
    **{
        f"{name}-{solver}": Failure(f"Start off the constraint, {name}", solver, partial(off_constraint, name, solver))
        for name in ("U", "level")
        for solver in PARTICLE_SOLVERS
    },
    **{
        f"zero-{solver}": Failure("StraightFibre, y goes to 0", solver, partial(through_zero, solver))
        for solver in (*PARTICLE_SOLVERS, "reduced", "moments", "characteristics", "pde")
    },
    **{
        f"flat-{solver}": Failure("TissueElement, det F(y) goes to 0", solver, partial(flat_element, solver))
        for solver in PARTICLE_SOLVERS
    },
    **{f"fold-{solver}": Failure("A fold of g", solver, partial(fold, solver)) for solver in PARTICLE_SOLVERS},
    "stiff-ode": Failure("Stiff springs, steps", "ode", stiff_steps),
    "stiff-rattle2": Failure("Stiff springs, stability limit", "rattle2", rattle_limit),
    **{f"kernel-{kind}": Failure(f"Kernel V = {kind}", "", partial(unbounded_kernel, kind)) for kind in KERNELS},
    **{
        f"blow-{solver}": Failure("W0 = −y⁴, y goes to infinity", solver, partial(blow_up, solver))
        for solver in ("ode", "rattle2")
    },
    "grid-pde": Failure("The density reaches the end of the grid", "pde", left_grid),
}


@dataclass(frozen=True)
class FailuresForm:
    """Names of the cases."""

    cases: tuple[str, ...] = tuple(FAILURES)


# There is one form only.
FORM = FailuresForm()


def study(form: FailuresForm) -> Study:
    """Run each case once."""
    return Study(
        name="meanfield_failures",
        title="Mean field: failures",
        key=("case",),
        runs=tuple({"case": name} for name in form.cases),
        run=_row,
    )


def _row(key: Key) -> list[Row]:
    failure = FAILURES[key["case"]]
    began = time.process_time()
    found = failure.look()
    seconds = time.process_time() - began
    return [dict(key) | found._asdict() | {"seconds": seconds}]


def named(table: pd.DataFrame) -> pd.DataFrame:
    """Add the title of each case and the name of its solver, in the order of the page."""
    rows = table.set_index("case").loc[[name for name in FAILURES if name in set(table["case"])]].reset_index()
    return rows.assign(
        title=[FAILURES[case].title for case in rows["case"]],
        solver=[LABELS.get(FAILURES[case].solver, "any") for case in rows["case"]],
    )
