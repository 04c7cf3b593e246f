"""Few sweeps: long rows and crowds of discs that they do not carry, and whether smaller steps do better.

Rows of discs are pressed onto a wall. Sweeps carry a push from one neighbour to the next: long rows need many.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache, partial
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from dincl import FixedStep
from dincl.drifts import attraction, constant
from verification.instruments.outcome import judge
from verification.instruments.references import Known, reference
from verification.instruments.stability import Limit, StabilityRuns, judged_run
from verification.methods.stability.schemes import Maker, Map, geometric, some

Floats = NDArray[np.float64]
RADIUS = 0.5
GAP = 0.1
ERROR = 0.02


def packed(n: int) -> Floats:
    """Return where the discs of a row end: 1/2, 3/2, ..., shape (n, 1)."""
    return np.arange(float(n))[:, None] + RADIUS


def pressed(n: float, gap: float = 0.0) -> dincl.Problem:
    """Return n intervals of diameter 1 with gaps, each pressed with the force 1 onto a wall at 0."""
    count = round(n)
    x = packed(count) + gap * np.arange(1, count + 1)[:, None]
    push = constant(np.full((count, 1), -1.0))
    return dincl.Problem(x, push, [dincl.NonOverlap(RADIUS), dincl.HalfSpace(normal=(1,), radius=RADIUS)])


def apart(n: float) -> dincl.Problem:
    """Return a row with gaps."""
    return pressed(n, GAP)


def closed(problem: dincl.Problem) -> Floats:
    """Return where the discs come to rest."""
    return packed(len(problem.x0))


def times(dt: float, n: float) -> Floats:
    """Return times at the end of a run long enough for all gaps to close."""
    return np.linspace(0.9, 1.0, 3) * max(GAP * n + 2.0, 10 * dt)


def sunk(n: int) -> float:
    """Return how deep the last disc of the row sinks in the equilibrium of PBD with one sweep, over dt |F|.

    At rest the moves of a step add up to zero: pair k (of discs k - 1 and k) moves each of its discs by (n - k) dt |F|,
    the wall moves disc 0 by n dt |F|. A pair is closed when it is treated; what later rows do to it stays: pair k + 1
    pushes disc k back by (n - k - 1) dt |F|, and the wall pushes disc 0. The sum of these overlaps is

        n + sum_{k = 1}^{n - 1} (n - k - 1) = n + (n - 1)(n - 2) / 2   for n >= 2.
    """
    return n + (n - 1) * (n - 2) / 2 if n > 1 else 0.0


def longest_row(dt: float) -> float:
    """Return the n with dt sunk(n) = ERROR, the positive root of n^2 - n + 2 = 2 ERROR / dt; NaN if there is none."""
    square = 8 * ERROR / dt - 7
    return (1 + math.sqrt(square)) / 2 if square >= 0 else math.nan


ROW = Map(
    "row",
    "the length of a row",
    StabilityRuns(
        apart,
        some(
            "PBD",
            "PBD with 4 sweeps",
            "PBD with 16 sweeps",
            "XPBD with 16 sweeps",
            "second-order PBD",
            "catch-up with Daqp",
            "springs of 0.3/dt",
            "force as printed of 10",
        ),
        x=("dt", geometric(1 / 256, 1.0, 17), "step dt [time]"),
        y=("n", (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96), "discs n"),
        t=times,
        reference=closed,
        accurate=ERROR,
        limits=[Limit("PBD, one sweep: error 0.02", longest_row, ["PBD"])],
    ),
)


# A crowd of discs drawn to one point: with few sweeps it collapses, with large steps centres coincide.

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


CROWD_SCHEMES = some("PBD", "PBD with 16 sweeps", "springs of 0.3/dt", "springs of 100", "force as printed of 10")
CROWD_NUMBERS = Map(
    "crowd",
    "the number of attracted discs",
    StabilityRuns(
        None,
        {label: partial(by_number, scheme) for label, scheme in CROWD_SCHEMES.items()},
        x=STEPS,
        y=("n", (4, 8, 16, 32, 64, 128, 256, 512), "discs n"),
        limits=[Limit("dt R²/2 = 0.1", lambda dt: 2 * OVERLAP / dt / radius(1) ** 2, ["PBD"])],
    ),
)
CROWD_SWEEPS = Map(
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


# More sweeps or smaller steps: PBD and XPBD with equal numbers of sweeps in all, in few steps or in many.

LINKS, COLUMN = 20, 20
# Of the references, far below all errors of the map [length].
TOL = 1e-9


def chain() -> dincl.Problem:
    """Return a slack rope of links that is pulled apart at its ends."""
    bent = np.column_stack([0.9 * np.arange(LINKS), 0.2 * (-1.0) ** np.arange(LINKS)])
    pull = np.zeros((LINKS, 2))
    pull[-1], pull[0] = (5.0, 2.0), (-1.0, 0.0)
    return dincl.Problem(bent, constant(pull), [dincl.MaxDistance([(k, k + 1) for k in range(LINKS - 1)], 1.0)])


def column() -> dincl.Problem:
    """Return a column of balls that falls on the ground, one ball after another: each carries all balls above it."""
    height = 0.5 + 1.05 * np.arange(COLUMN)
    ground = dincl.HalfSpace(normal=(1,), radius=0.5)
    return dincl.Problem(height[:, None], constant((-1.0,)), [dincl.NonOverlap(0.5), ground])


# Name -> problem, end [time].
SCENES: Mapping[str, tuple[Callable[[], dincl.Problem], float]] = {
    "four discs": (dincl.scenes.four_disks, 2.0),
    "chain of 20 links": (chain, 2.0),
    "column of 20 balls": (column, 2.0),
    "stack of 6 intervals": (dincl.scenes.stack, 1.5),
    "pile of 30 discs": (partial(dincl.scenes.pile, 30), 1.0),
}
METHODS = {"PBD": dincl.PBD, "XPBD": dincl.XPBD}
SWEEPS = (1, 2, 4, 8, 16, 32, 64)


@cache
def exact(scene: str) -> Known:
    """Return the solution of a scene at ten times."""
    make, end = SCENES[scene]
    return reference(make(), TOL)(np.linspace(0.0, end, 11)[1:])


def run_divided(scene: str, method: Callable[..., dincl.Scheme], sweeps: float, total: float) -> dict[str, Any]:
    """Run total / sweeps steps."""
    make, end = SCENES[scene]
    known = exact(scene)
    return judged_run(make(), method(end * sweeps / total, sweeps=round(sweeps)), known.t, known.x)


SWEEPS_OR_STEPS = Map(
    "sweeps_or_steps",
    "more sweeps or smaller steps",
    StabilityRuns(
        None,
        {
            f"{name}, {scene}": partial(run_divided, scene, method)
            for name, method in METHODS.items()
            for scene in SCENES
        },
        x=("sweeps", SWEEPS, "sweeps in a step"),
        y=("total", (256, 1024, 4096), "sweeps in all"),
    ),
)


def divisions(table: pd.DataFrame) -> pd.DataFrame:
    """Return for each method and number of sweeps in all: the best sweeps in a step, and errors over the least error.

    ``one`` is the error with one sweep in a step over the least error, ``most`` the error with most sweeps.
    """
    errors = table.pivot_table(index=["method", "total"], columns="sweeps", values="error", sort=False)
    least = errors.min(axis=1)
    found = {
        "best": errors.idxmin(axis=1),
        "error": least,
        "one": errors[SWEEPS[0]] / least,
        "most": errors[SWEEPS[-1]] / least,
    }
    return pd.DataFrame(found).reset_index()
