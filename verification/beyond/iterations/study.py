"""PBD and XPBD with the same number of sweeps in all, divided into few steps of many sweeps or many steps of few."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd

import dincl
from dincl.drifts import constant
from dincl.study import Key, Row, Study, read_sealed
from verification.beyond.chart.references import FILES, stacked
from verification.instruments.error_norms import distance
from verification.instruments.measure import reached
from verification.instruments.references import Known, reference

LINKS, COLUMN = 20, 20
# Of the references, far below all errors of the study [length].
TOL = 1e-9
TIMES = 10


def chain() -> dincl.Problem:
    """A slack rope of links that is pulled apart at its ends."""
    bent = np.column_stack([0.9 * np.arange(LINKS), 0.2 * (-1.0) ** np.arange(LINKS)])
    pull = np.zeros((LINKS, 2))
    pull[-1], pull[0] = (5.0, 2.0), (-1.0, 0.0)
    return dincl.Problem(bent, constant(pull), [dincl.MaxDistance([(k, k + 1) for k in range(LINKS - 1)], 1.0)])


def column() -> dincl.Problem:
    """A column of balls that falls on the ground, one ball after another: each carries all balls above it."""
    height = 0.5 + 1.05 * np.arange(COLUMN)
    ground = dincl.HalfSpace(normal=(1,), radius=0.5)
    return dincl.Problem(height[:, None], constant((-1.0,)), [dincl.NonOverlap(0.5), ground])


# Name -> problem, end [time], numbers of sweeps in all.
SCENES: Mapping[str, tuple[Callable[[], dincl.Problem], float, tuple[int, ...]]] = {
    "four discs": (dincl.scenes.four_disks, 2.0, (256, 1024, 4096)),
    "chain of 20 links": (chain, 2.0, (256, 1024, 4096)),
    "column of 20 balls": (column, 2.0, (256, 1024, 4096)),
    "stack of 6 intervals": (dincl.scenes.stack, 1.5, (256, 1024, 4096)),
    "pile of 30 discs": (lambda: dincl.scenes.pile(30), 1.0, (256, 1024, 4096)),
    "pile of 1,000 discs": (lambda: dincl.scenes.pile(1000), 1.0, (256, 1024)),
}
SWEEPS = (1, 2, 4, 8, 16, 32, 64)
COMPLIANCE = 1e-3  # [time]
METHODS: Mapping[str, Callable[[float, int], dincl.Scheme]] = {
    "PBD": lambda dt, sweeps: dincl.PBD(dt, sweeps=sweeps),
    "XPBD": lambda dt, sweeps: dincl.XPBD(dt, sweeps=sweeps),
    "XPBD, compliance 0.001": lambda dt, sweeps: dincl.XPBD(dt, sweeps=sweeps, compliance=COMPLIANCE),
}


def study() -> Study:
    """Return the study: a run for each scene, method, number of sweeps in all and in a step."""
    return Study(
        name="iterations",
        title="Iterations or smaller steps",
        key=("scene", "method", "total", "sweeps"),
        runs=tuple(
            {"scene": name, "method": method, "total": total, "sweeps": sweeps}
            for name, (_, _, totals) in SCENES.items()
            for total in totals
            for method in METHODS
            for sweeps in SWEEPS
        ),
        run=run,
    )


def run(key: Key) -> list[Row]:
    """Return one row: largest error and largest overlap over all times, corrections made."""
    make, end, _ = SCENES[key["scene"]]
    problem, dt = make(), end * key["sweeps"] / key["total"]
    exact = _reference(key["scene"], problem, end)
    path = dincl.solve(problem, METHODS[key["method"]](dt, key["sweeps"]), t=exact.t, throw=False)
    states = reached(path, exact.t)
    found = {
        "error": float(distance(states, exact.x).max()),
        "overlap": float(path.violation().max()),
        "corrections": path.stats.constraint_projections,
        "status": path.status.name,
    }
    return [dict(key) | {"dt": dt, "reference_error": float(exact.error.max())} | found]


def _reference(name: str, problem: dincl.Problem, end: float) -> Known:
    if name.startswith("pile of 1,000"):
        return stacked(read_sealed(FILES["pile_1000"]))
    return reference(problem, TOL)(np.linspace(0.0, end, TIMES + 1)[1:])


def best_splits(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each scene, method and total: the sweeps of the least error, and what other splits cost.

    ``one`` is the error of steps with one sweep over the least error, ``most`` of steps with ``SWEEPS[-1]`` sweeps.
    """
    rows = []
    for (scene, method, total), mine in table.groupby(["scene", "method", "total"], sort=False):
        errors = mine.set_index("sweeps")["error"]
        overlaps = mine.set_index("sweeps")["overlap"]
        rows.append(
            {
                "scene": scene,
                "method": method,
                "total": total,
                "best": int(errors.idxmin()),
                "error": errors.min(),
                "one": errors[SWEEPS[0]] / errors.min(),
                "most": errors[SWEEPS[-1]] / errors.min(),
                "overlap_best": int(overlaps.idxmin()),
                "overlap": overlaps.min(),
                "overlap_one": overlaps[SWEEPS[0]],
            }
        )
    return pd.DataFrame(rows)
