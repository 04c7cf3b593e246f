"""A crowd of discs drawn to one point: with few sweeps it collapses, with large steps centres coincide."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl import FixedStep
from dincl.drifts import attraction
from verification.instruments.outcome import judge
from verification.instruments.stability import Limit, StabilityRuns
from verification.methods.stability.schemes import Maker, Map, geometric, some

Floats = NDArray[np.float64]
# Spacing and jitter of the start: no two discs touch.
SPACING, JITTER = 1.2, 0.09
# Runs last so long [time], and at least so many steps.
END, LEAST = 4.0, 20
# Relative error of the radius of gyration that counts as converged: packings differ by a few per cent.
ALIKE, OVERLAP = 0.06, 0.1
FEW = 200
STEPS = ("dt", (*geometric(2e-3, 0.8, 14), 1.0, 1.3, 1.7, 2.2), "step dt [time]")


def crowd(n: int) -> dincl.Problem:
    """Return F = -x, n discs of diameter 1 on a jittered lattice around the origin."""
    side = math.ceil(math.sqrt(n))
    place = np.indices((side, side)).reshape(2, -1).T[:n].astype(np.float64)
    jitter = np.random.default_rng(n).uniform(-JITTER, JITTER, (n, 2))
    return dincl.Problem(SPACING * (place - place.mean(axis=0)) + jitter, attraction(0), [dincl.NonOverlap(0.5)])


def gyration(x: Floats) -> float:
    """Return the root mean square distance from the centre of mass."""
    return float(np.sqrt(((x - x.mean(axis=0)) ** 2).sum(axis=1).mean()))


def densest(n: int) -> float:
    """Return the least radius of gyration of a heap: n points of a triangular lattice of width 1 around a centre.

    The heap may be centred on a point of the lattice, on the middle of a bond, or on that of a triangle.
    """
    side = math.ceil(math.sqrt(n)) + 2
    i, j = np.mgrid[-side : side + 1, -side : side + 1]
    lattice = np.column_stack(((i + j / 2).ravel(), (math.sqrt(3) / 2 * j).ravel()))
    sizes = []
    for centre in ((0.0, 0.0), (0.5, 0.0), (0.5, math.sqrt(3) / 6)):
        nearest = np.argsort(((lattice - centre) ** 2).sum(axis=1), kind="stable")[:n]
        sizes.append(gyration(lattice[nearest]))
    return min(sizes)


def radius(n: float) -> float:
    """Return the radius of n densely packed discs of diameter 1, as a round heap [diameters]."""
    return math.sqrt(n * math.sqrt(12) / (4 * math.pi))


def seen(problem: dincl.Problem, scheme: FixedStep) -> dict[str, Any]:
    """Judge a run by overlap and by the radius of gyration, since equilibria are many."""
    end = scheme.dt * max(LEAST, math.ceil(END / scheme.dt))
    path = dincl.solve(problem, scheme, t=end, throw=False)
    growth = float(np.abs(path.final).max() / np.abs(problem.x0).max())
    error = abs(gyration(path.final) / densest(len(problem.x0)) - 1) if growth < np.inf else np.nan
    numbers = {"error": error, "overlap": float(path.violation()[-1]), "growth": growth}
    found = judge(path.status, accurate=ALIKE, feasible=OVERLAP, **numbers)
    return {"outcome": found.value, "status": path.status.name, "detail": path.detail} | numbers


def by_number(scheme: Maker, dt: float, n: float) -> dict[str, Any]:
    """Run a crowd of n."""
    return seen(crowd(round(n)), scheme(dt=dt))


def by_sweeps(dt: float, sweeps: float) -> dict[str, Any]:
    """Run a crowd of FEW."""
    return seen(crowd(FEW), dincl.PBD(dt=dt, sweeps=round(sweeps)))


METHODS = some("PBD", "PBD with 16 sweeps", "springs of 0.3/dt", "springs of 100", "force as printed of 10")
NUMBERS = Map(
    "crowd",
    "the number of attracted discs",
    StabilityRuns(
        None,
        {label: partial(by_number, scheme) for label, scheme in METHODS.items()},
        x=STEPS,
        y=("n", (4, 8, 16, 32, 64, 128, 256, 512), "discs n"),
        limits=[Limit("dt R²/2 = 0.1", lambda dt: 2 * OVERLAP / dt / radius(1) ** 2, ["PBD"])],
    ),
)
SWEEPS = Map(
    "sweeps",
    "the number of sweeps",
    StabilityRuns(
        None,
        {"PBD": by_sweeps},
        x=STEPS,
        y=("sweeps", (1, 2, 4, 8, 16, 32, 64)),
        limits=[Limit("dt R²/2 = 0.1 · sweeps", lambda dt: dt * radius(FEW) ** 2 / 2 / OVERLAP)],
    ),
)
