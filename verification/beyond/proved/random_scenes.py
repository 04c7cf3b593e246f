"""The error that ``EventDriven`` states beside the proved one, on random scenes of two to six discs.

``python -m verification.beyond.proved.random_scenes`` makes the table again, in some minutes, and writes
``verification/data/proved_random.parquet``.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pandas as pd

import dincl
from dincl.drifts import attraction, constant, swirl
from dincl.study import read_sealed
from verification.page.kept import DATA, keep
from verification.proofs.proof import NotProved, prove

FILE = DATA / "proved_random.parquet"
SCENES, TOLERANCES = 300, (1e-6, 1e-11)
TIMES = (0.5, 1.0, 1.5)
# Of the proof [length]: far below what the scheme reaches.
BOUND = 1e-18


def main() -> None:
    """Prove all scenes and keep the table."""
    keep(pd.DataFrame([row for seed in range(SCENES) for row in measure(seed)]), FILE, main)


def scene(seed: int) -> dincl.Problem:
    """Return two to six discs of different radii, drawn to a point, turned, or falling on a floor or into a corner."""
    rng = np.random.default_rng([seed, 1])
    n = int(rng.integers(2, 7))
    radius = rng.uniform(0.3, 0.6, n)
    x0, size = _places(rng, radius)
    kind = rng.integers(3)
    if kind == 0:
        return dincl.Problem(x0, attraction(0, rng.uniform(0.5, 2.0, n)), [dincl.NonOverlap(radius)])
    if kind == 1:
        turns = attraction(0, rng.uniform(0.5, 1.5)) + swirl(0, rng.uniform(-2.0, 2.0, n))
        return dincl.Problem(x0, turns, [dincl.NonOverlap(radius)])
    walls = [dincl.HalfSpace((0.0, 1.0), -size, radius)]
    if rng.random() < 0.5:
        walls.append(dincl.HalfSpace((1.0, 0.0), -size, radius))
    falls = constant(rng.uniform(-0.5, 0.5, (n, 2)) + np.array([-0.5, -1.5]))
    return dincl.Problem(x0, falls, [dincl.NonOverlap(radius), *walls])


def _places(rng: np.random.Generator, radius: np.ndarray[Any, Any]) -> tuple[np.ndarray[Any, Any], float]:
    """Return places one by one where there is room, in a square that grows, which contains all discs in the end."""
    places: list[Any] = []
    size = 1.0
    while len(places) < len(radius):
        place, own = size * rng.uniform(-1, 1, 2), radius[len(places)]
        if all(np.hypot(*(place - other)) > own + r for other, r in zip(places, radius, strict=False)):
            places.append(place)
        size *= 1.02
    return np.array(places), float(size + radius.max())


def measure(seed: int) -> list[dict[str, Any]]:
    """Return, for each tolerance, stated and proved error over all times; an infinite bound if there is no proof."""
    problem = scene(seed)
    start = time.perf_counter()
    try:
        proof, bound, why = prove(problem, TIMES, BOUND), 0.0, ""
        bound = proof.bound
    except NotProved as failed:
        proof, bound, why = None, failed.best, str(failed)
    seconds, rows = time.perf_counter() - start, []
    for tol in TOLERANCES:
        path = dincl.solve(problem, dincl.EventDriven(tol), TIMES)
        error = np.full(len(TIMES), np.nan) if proof is None else proof.errors(path.x)
        stated = np.asarray(path.error)
        row = {"seed": seed, "discs": len(problem.x0), "tol": tol, "events": len(path.events), "bound": bound}
        ratio = float((error / stated).max())
        row |= {"stated": float(stated.max()), "proved": float(error.max()), "ratio": ratio}
        rows.append(row | {"seconds": seconds, "why": why})
    return rows


def table() -> pd.DataFrame:
    """Return the kept table."""
    return read_sealed(FILE)


if __name__ == "__main__":
    main()
