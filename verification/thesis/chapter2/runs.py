"""One run of one method on one scene, as rows."""

from __future__ import annotations

import time
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import dincl
from dincl import FixedStep
from dincl.scenes import Scene
from dincl.study import Row
from verification.instruments.measure import COUNTERS, reached
from verification.thesis.chapter2.methods import METHODS


def scene(name: str) -> Scene:
    """Return the ready-made problem ``dincl.scenes.<name>()``."""
    made: Scene = getattr(dincl.scenes, name)()
    return made


def exact(problem: Scene, t: ArrayLike) -> NDArray[np.float64]:
    """Return the exact solution of a scene at ``t``; InvalidProblem if none is known."""
    if problem.exact is None:
        raise dincl.InvalidProblem(f"scene {problem.name}: its exact solution is not known")
    return problem.exact(t)


def timed(problem: dincl.Problem, scheme: dincl.Scheme, t: NDArray[np.float64]) -> tuple[dincl.Trajectory, float]:
    """Return the run and its seconds; two steps before it pay for loading, compiling and importing.

    A scheme without time steps is run to the first output time before.
    """
    warm = 2 * scheme.dt if isinstance(scheme, FixedStep) else float(t[t > 0][0])
    dincl.solve(problem, scheme, t=[min(warm, float(t[-1]))], throw=False)
    start = time.process_time()
    path = dincl.solve(problem, scheme, t=t, throw=False)
    return path, time.process_time() - start


def solved(name: str, method: str, dt: float, t: NDArray[np.float64]) -> tuple[dincl.Trajectory, dict[str, Any]]:
    """Run a named method on a named scene; the Trajectory, and what every row of the run says about it."""
    path, seconds = timed(scene(name), METHODS[method].make(dt), t)
    return path, about(path, seconds)


def about(path: dincl.Trajectory, seconds: float) -> dict[str, Any]:
    """Return status, time and counters of a run, as columns."""
    counted = asdict(path.stats)
    return {"status": path.status.name, "detail": path.detail, "seconds": seconds} | {
        name: counted[name] for name in COUNTERS
    }


def position_rows(path: dincl.Trajectory, times: NDArray[np.float64], columns: dict[str, Any]) -> list[Row]:
    """Return one row for each of ``times`` and each particle with its coordinates, and ``columns`` in every row."""
    return [
        columns | {"t": t, "particle": i} | dict(zip("xyz", x, strict=False))
        for t, state in zip(times, reached(path, times), strict=True)
        for i, x in enumerate(state)
    ]
