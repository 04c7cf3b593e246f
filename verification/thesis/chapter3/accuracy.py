"""Accuracy on frozen tissues: the overdamped motion over dt by PBD and catch-up; steps by DAHA beside the minimum."""
# ruff: noqa: RUF001 - headings for readers are written with mathematical signs

from __future__ import annotations

import time
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.optimize import nnls

import dincl
from dincl.study import Key, Row, Study
from tissue.model.energy import energy, forces
from tissue.state.cells import CellLayers, Cells, Forces
from tissue.state.numbers import Numbers
from verification.instruments.budget import CpuSeconds
from verification.instruments.method import Method
from verification.instruments.references import Known
from verification.instruments.speed_accuracy import WorkPrecisionRuns
from verification.thesis.chapter3.growing import Frozen, begun, floored, substepped
from verification.thesis.chapter3.sampled import DT, over_seeds
from verification.thesis.quasi_steady.daha import Stopped, TissueArrowHurwicz, violation
from verification.thesis.quasi_steady.frozen import constraints, frozen_problem, made_feasible, particles
from verification.thesis.quasi_steady.iteration import TABLE_4

Floats = NDArray[np.float64]
# Second derivatives of the energy of a cell, by complex steps.
# Unknowns of a cell whose basal point is on its line.
UNKNOWNS = ("x", "y", "ax", "ay", "bx")
# Of the complex step: its square is nothing beside any force.
STEP = 1e-20


def own_hessians(cells: Cells, numbers: Numbers) -> Floats:
    """Return d^2 W/dZ dZ of each cell by itself, without junctions and repulsion: Z its UNKNOWNS, shape (n, 5, 5)."""
    alone, nobody = numbers._replace(repulsion=0.0), CellLayers(np.zeros(0, np.int64), np.zeros(0, np.int64))
    columns = []
    for name in UNKNOWNS:
        moved = _complex(cells)
        getattr(moved, name)[:] += 1j * STEP
        columns.append(_slopes(forces(moved, nobody, alone)).T)
    return np.stack(columns, axis=2)


def largest_eigenvalue(matrix: Floats) -> Floats:
    """Return the largest eigenvalue of symmetric matrices (..., m, m)."""
    return np.asarray(np.linalg.eigvalsh(matrix)[..., -1], dtype=np.float64)


def _complex(cells: Cells) -> Cells:
    names = (*UNKNOWNS, "by")
    return cells._replace(**{name: getattr(cells, name).astype(np.complex128) for name in names})


def _slopes(at: Forces) -> Floats:
    """Return -d(force)/d(the coordinate moved), shape (5, n)."""
    return -np.stack([getattr(at, name).imag for name in UNKNOWNS]) / STEP


# The frozen tissue of the motion: seed, age [h], tolerance of its projections; steps in dt of the reference.
SEED, AGE, FINE_TOL, REFERENCE = 0, 5.0, 1e-10, 2560
SUBSTEPS = (5, 10, 20, 40, 80, 160, 320, 640, 1280, 2560)
STEPS = (20, 40, 80, 160, 320, 640)
# Single steps of so many tissues, at these times [h]; what may be left of the gradient at a minimum, over |z|.
SEEDS, TIMES, TOL = 20, (0.1, 1.0, 2.0, 5.0, 10.0), 1e-9
# Of the descent to a minimum: the numbers of DAHA, and the curvature by junctions and repulsion, which is added to that
# of cells alone for a bound of the largest one.
DESCENT: dict[str, Any] = {"beta": 0.05, "c": 0.5, "eps": 1e-12, "most_iterations": 1_000_000}
MORE = 20.0
# A gap below this is looked at as a contact [R_soft]: DAHA leaves gaps of up to 0.01 either way.
CONTACT = 0.02
COLUMNS = {
    "where": "State",
    "energy": "W, mean",
    "part": "Part of the way down",
    "low": "from",
    "high": "to",
    "distance": "Nuclei to the minimum [R_soft]",
    "relative": "Relative",
    "gradient": "‖∇W − Jᵀλ‖/‖z‖, median",
    "steepest": "Largest",
    "violation": "Largest violation [R_soft]",
    "made": "Iterations, mean",
    "seconds": "Seconds, median",
    "solved": "Solved",
    "steps": "Steps",
}


@cache
def start() -> tuple[Frozen, dincl.Problem]:
    """Return the frozen tissue of the motion, moved into S, and its problem."""
    given = begun(floored(), SEED, AGE)
    state = given._replace(cells=made_feasible(*given, dincl.Ipopt(tol=FINE_TOL)))
    return state, frozen_problem(*state)


def _substeps(problem: object, h: float, t: Floats) -> Floats:
    """Return the particles after substeps of at most h, by the kernel."""
    state, _ = start()
    steps = round(float(t[-1]) / h)
    cells = substepped(state, float(t[-1]) / steps / state.numbers.mu, steps)
    if cells is None:
        raise RuntimeError(f"cells are lost with {steps} substeps")
    return particles(cells)[None]


def _linearised(problem: object, h: float, t: Floats) -> Floats:
    return dincl.solve(start()[1], dincl.LinearisedCatchUp(h, dincl.ProjectedCG(tol=FINE_TOL)), t).x


def _midpoint(problem: object, h: float, t: Floats) -> Floats:
    return dincl.solve(start()[1], dincl.MidpointCatchUp(h, dincl.ProjectedCG(tol=FINE_TOL)), t).x


@cache
def _exact(t: float) -> Known:
    coarse, fine = (_midpoint(None, t / steps, np.array([t])) for steps in (REFERENCE // 2, REFERENCE))
    off = (fine - coarse) / 3
    return Known(np.array([t]), fine + off, np.array([np.hypot(off[..., 0], off[..., 1]).max()]))


def exact(t: Any) -> Known:
    """Return the motion at one time by MidpointCatchUp, with its error of h^2 taken out.

    The error is 1/3 of the change by the last halving of the step, and the reference is off by no more than that.
    """
    return _exact(float(np.ravel(t)[-1]))


MOTION = WorkPrecisionRuns(
    "a frozen tissue",
    [
        Method("substeps of PBD", "PBD", run=_substeps),
        Method("LinearisedCatchUp", "catch-up", run=_linearised),
        Method("MidpointCatchUp", "catch-up", run=_midpoint),
    ],
    {"substeps of PBD": [DT / n for n in SUBSTEPS]} | {"dt": [DT / n for n in STEPS]},
    [DT],
    exact,
    CpuSeconds(10.0),
    errors=("final",),
)


def motion(smallest: bool = False) -> Study:
    """Return the runs of the motion over dt, without rules and noise: one for each method."""
    return MOTION.study("tissue_motion", "Tissue: a frozen tissue", smallest)


def steps(smallest: bool = False) -> Study:
    """Return single steps: one run for each seed and time."""
    times, seeds = ((5.0,), 1) if smallest else (TIMES, SEEDS)
    runs = tuple({"seed": seed, "t": t} for t in times for seed in range(seeds))
    return Study("tissue_judged", "Tissue: steps, judged", ("seed", "t"), runs, judged, {"tol": TOL}, COLUMNS)


def judged(key: Key) -> list[Row]:
    """Return one row for the start, DAHA, PBD over dt, and the minimum below where DAHA stopped."""
    state = begun(floored(), key["seed"], key["t"])
    numbers = state.numbers
    minimiser = TissueArrowHurwicz(TABLE_4)
    minimiser.minimise(*state)  # loading and compiling
    daha, seconds = _timed(lambda: minimiser.minimise(*state))
    moved = substepped(state, numbers.dt / numbers.substeps / numbers.mu, numbers.substeps)
    least, more = _timed(lambda: minimum(daha.cells, state))
    at_least = particles(least.cells)
    certified = bool(left_over(least.cells, state) <= TOL * np.linalg.norm(at_least))
    rows = [
        ("start", state.cells, True, np.nan, 0),
        ("DAHA", daha.cells, bool(daha.status), seconds, daha.iterations),
        ("minimum", least.cells, bool(least.status) and certified, more, least.iterations),
    ]
    if moved is not None:
        rows.insert(2, ("PBD", moved, True, np.nan, 0))
    names = ("where", "solved", "seconds", "made")
    return [
        dict(key) | dict(zip(names, (where, *about), strict=True)) | _measured(at, state, at_least)
        for where, at, *about in rows
    ]


def _timed(make: Callable[[], Stopped]) -> tuple[Stopped, float]:
    """Return what is made, and its CPU time."""
    began = time.process_time()
    return make(), time.process_time() - began


def minimum(cells: Cells, state: Frozen) -> Stopped:
    """Return a local minimum of W over S below some cells of a state, by DAHA with small steps and a small eps.

    The step alpha is half of one over a bound of the largest curvature. What ``left_over`` says there is the
    certificate: it knows nothing of the way.
    """
    alpha = 0.5 / (MORE + float(largest_eigenvalue(own_hessians(cells, state.numbers)).max()))
    own = TABLE_4._replace(alpha=alpha, gamma=10 * alpha, **DESCENT)
    return TissueArrowHurwicz(own).minimise(cells, state.layers, state.numbers)


def _measured(at: Cells, state: Frozen, least: Floats) -> dict[str, Any]:
    """Return energy, violation, what is left of the gradient over |z|, and distance of the nuclei to the minimum."""
    n, x = len(at.x), particles(at)
    off = (x - least)[:n]
    return {
        "energy": energy(at, state.layers, state.numbers),
        "violation": violation(constraints(*state), at),
        "gradient": left_over(at, state) / float(np.linalg.norm(x)),
        "distance": float(np.sqrt((off**2).sum(axis=1).mean())),
        "relative": float(np.linalg.norm(off) / np.linalg.norm(least[:n])),
    }


def left_over(cells: Cells, state: Frozen) -> float:
    """Return min |grad W - J^T lambda| over lambda >= 0 of constraints with a gap below CONTACT: 0 at a minimum."""
    x = particles(cells)
    sets = constraints(cells, state.layers, state.numbers)
    free = np.ones_like(x, dtype=bool)
    free[2 * len(cells.x) + state.layers.basal, 1] = False
    slope = -particles(forces(cells, state.layers, state.numbers))[free]
    rows = [family.select(x, 2 * CONTACT) for family in sets]
    pushing = np.vstack([r.jacobian(x).toarray()[r.values(x) < CONTACT][:, free.ravel()] for r in rows])
    if not len(pushing):  # nnls of scipy takes no empty matrix
        return float(np.linalg.norm(slope))
    return float(nnls(pushing.T, slope)[1])


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each place: means over all steps, the part of the way down to the minimum with its interval.

    The way down is counted from the start of the step to the minimum below where DAHA stopped.
    """
    energies = table.pivot(index=["seed", "t"], columns="where", values="energy")
    least = energies["minimum"]
    rows = []
    for name, mine in table.groupby("where", sort=False):
        down = (energies["start"] - energies[name]) / (energies["start"] - least)
        part = over_seeds(down.groupby("seed").mean().dropna())
        means = mine[["energy", "distance", "relative", "made"]].mean().to_dict()
        extremes = {"violation": mine["violation"].max(), "gradient": mine["gradient"].median()}
        extremes |= {"steepest": mine["gradient"].max(), "seconds": mine["seconds"].median()}
        about = {"where": name, "part": part.mean, "low": part.low, "high": part.high}
        rows.append(about | means | extremes | {"solved": int(mine["solved"].sum()), "steps": len(mine)})
    return pd.DataFrame(rows)
