"""The event-driven solution against the scenes whose exact solution is known, evaluated to 30 digits."""

from __future__ import annotations

import numpy as np

import dincl
from dincl.study import Key, Row, Study
from verification.instruments.error_norms import distance
from verification.thesis.chapter2.reference import TOL
from verification.thesis.chapter2.runs import about, exact, scene, timed

SCENES = (
    "sliding_disc",
    "two_disks",
    "stack",
    "step_inclusion",
    "sweeping_interval",
    "drum",
    "closing_walls",
    "growing_discs",
)
# Output times of each scene, equally spaced from its start to its end.
KEPT = 24


def study() -> Study:
    """Return one run for each scene; there is one form only, it takes seconds."""
    return Study(
        name="exactness",
        title="Event-driven against exact",
        key=("scene",),
        runs=tuple({"scene": name} for name in SCENES),
        run=run,
    )


def run(key: Key) -> list[Row]:
    """Return the largest true error of a scene over its output times, and the largest stated one: one row."""
    problem = scene(key["scene"])
    times = np.linspace(0.0, problem.times[-1], KEPT + 1)
    path, seconds = timed(problem, dincl.EventDriven(TOL), times)
    columns = {
        "t_end": times[-1],
        "events": len(path.events),
        "true": float(distance(path.x, exact(problem, path.t)).max()),
        "stated": np.inf if path.error is None else float(path.error.max()),
    }
    return [dict(key) | columns | about(path, seconds)]
