"""Growth of coordinates at large steps: PBD against the penalty method (Figure 2 of chapter 2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dincl.study import Key, Row, Study
from verification.thesis.chapter2.convergence import SCENES
from verification.thesis.chapter2.methods import METHODS, PBD, PENALTIES, PENALTY_PRINTED
from verification.thesis.chapter2.runs import about, scene, timed

COMPARED = (PBD, *PENALTIES, PENALTY_PRINTED)
# Long enough that something unstable has time to grow [time].
END = 32.0
# A run is unstable if a disc gets this many times farther out than any disc was at the start.
FAR = 2.0


@dataclass(frozen=True)
class LargeStepsForm:
    """The steps [time]."""

    steps: tuple[float, ...]


# There is one form only, it takes a second.
FORM = LargeStepsForm((0.0125, 0.025, 0.05, 0.1, 0.2, 0.4, 0.8, 1.0, 1.6))


def extent(key: Key) -> list[Row]:
    """Return the largest coordinate of one run, after every step, over that of the start: one row."""
    problem = scene(key["scene"])
    steps = round(END / key["dt"])
    times = np.array([END * k / steps for k in range(steps + 1)])
    path, seconds = timed(problem, METHODS[key["method"]].make(END / steps), times)
    growth = float(np.abs(path.x).max() / np.abs(problem.x0).max())
    last = float(path.violation()[-1])
    row = {"growth": growth, "infeasibility": last, "stable": bool(path.status) and growth <= FAR}
    return [dict(key) | row | about(path, seconds)]


def study(form: LargeStepsForm = FORM) -> Study:
    """Return all runs."""
    runs = [
        {"scene": name, "method": method.name, "dt": dt} for name in SCENES for method in COMPARED for dt in form.steps
    ]
    return Study(
        name="large_steps",
        title="Large steps",
        key=("scene", "method", "dt"),
        runs=tuple(runs),
        run=extent,
    )
