"""Single steps of a growing tissue by DAHA and PBD from one state, compared with the local minimum of Ipopt."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import nnls

from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters, preset
from tissue.frames.observables import height
from tissue.model.energy import energy, forces
from tissue.quasi_steady.daha import TissueArrowHurwicz, violation
from tissue.quasi_steady.frozen import constraints, particles
from tissue.quasi_steady.judge import local_minimum
from tissue.quasi_steady.minimiser import Judge
from tissue.quasi_steady.run import simulate_quasi_steady
from tissue.runs.compiled_rules import rules_pointer
from tissue.runs.simulate import simulate
from tissue.state.cells import Cells
from tissue.state.numbers import numbers_pointer
from tissue.state.running import contents
from tissue.step.advance import apply_rules
from verification.thesis.chapter3.frozen import Frozen
from verification.thesis.chapter3.growing import SUCCESS, growing_from, until
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.chapter3.jitter import substepped

# One rule of the thesis preset changed: desired rest lengths that are not negative, as the published runs have it.
FLOORED = {"rules.floor_rest_length": True}
TOL = 1e-7
# A gap below this is looked at as a contact [R_soft]: DAHA leaves gaps of up to 0.01 either way.
CONTACT = 0.02
# How long the whole runs are [h].
END = 10.0


@dataclass(frozen=True)
class JudgedForm:
    """Extent of the study: number of seeds, times of the steps [h], number of whole runs that the judge makes."""

    seeds: int
    times: tuple[float, ...]
    whole: int = 0


FULL = JudgedForm(20, (0.1, 1.0, 2.0, 5.0, 10.0), whole=5)


def study(form: JudgedForm) -> Study:
    """Return the study: one run for each seed and time."""
    return Study(
        name="tissue_judged",
        title="Tissue: steps, judged",
        key=("seed", "t"),
        runs=tuple({"seed": seed, "t": t} for t in form.times for seed in range(form.seeds)),
        run=partial(judged, parameters=floored()),
    )


def floored() -> Parameters:
    """Return the thesis preset with desired rest lengths that are not negative, with which DAHA terminates."""
    return preset("thesis").changed(FLOORED)


@cache
def begun(parameters: Parameters, seed: int, t: float) -> Frozen:
    """Return the state from which the step that ends at t + dt begins: rules and noise applied, nothing moved yet.

    The tissue was grown by PBD. The state need not be in S.
    """
    run = growing_from(parameters, seed)
    run.to(t)
    if run.status != SUCCESS:
        raise RuntimeError(f"seed {seed}: the tissue was lost before t = {t:g} h: {run.status}")
    t, numbers = (run.made + 1) * run.numbers.dt, numbers_pointer(run.numbers)
    apply_rules(run.held, t, numbers, rules_pointer([run.held]), run.random.cycle, run.random.noise)
    return Frozen(*contents(run.held), run.numbers)


def judged(key: Key, parameters: Parameters) -> list[Row]:
    """Return one row for the start, DAHA, PBD over dt, and the minima from the start and from where DAHA stopped."""
    state = begun(parameters, key["seed"], key["t"])
    cells, layers, numbers = state
    minimiser = TissueArrowHurwicz(parameters.daha_numbers())
    minimiser.minimise(*state)  # loading and compiling
    began = time.process_time()
    daha = minimiser.minimise(*state)
    times, counts = {"DAHA": time.process_time() - began}, {"DAHA": daha.iterations}
    scale = numbers.dt / numbers.substeps / numbers.mu
    moved = substepped(cells, layers, numbers, scale, numbers.substeps)
    reached: dict[str, Cells] = {"start": cells, "DAHA": daha.cells}
    if moved is not None:
        reached["PBD"] = moved
    solved = {"start": True, "DAHA": bool(daha.status), "PBD": moved is not None}
    for name, start in (("minimum", cells), ("minimum from DAHA", daha.cells)):
        began = time.process_time()
        found = local_minimum(start, layers, numbers, TOL)
        times[name], counts[name], solved[name] = time.process_time() - began, found.iterations, bool(found.status)
        reached[name] = found.cells
    least = particles(reached["minimum from DAHA"])
    return [
        dict(key)
        | {"where": name, "solved": solved[name], "seconds": times.get(name, np.nan), "made": counts.get(name, 0)}
        | _measured(at, state, least)
        for name, at in reached.items()
    ]


def _measured(at: Cells, state: Frozen, least: np.ndarray) -> dict[str, Any]:
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
    touching = [r.jacobian(x).toarray()[r.values(x) < CONTACT][:, free.ravel()] for r in rows]
    pushing = np.vstack(touching)
    if not len(pushing):  # nnls of scipy takes no empty matrix
        return float(np.linalg.norm(slope))
    return float(nnls(pushing.T, slope)[1])


def whole(form: JudgedForm) -> Study:
    """Return whole runs with the judge as the minimiser: one run for each seed."""
    return Study(
        name="tissue_judged_runs",
        title="Tissue: runs through minima",
        key=("seed",),
        runs=tuple({"seed": seed} for seed in range(form.whole)),
        run=grown_through_minima,
    )


def grown_through_minima(key: Key) -> list[Row]:
    """Return one row: heights at END of the runs by the judge, by DAHA and by PBD, NaN where a run ended before."""
    parameters = floored().changed(until(END))
    runs = {
        "judge": simulate_quasi_steady(parameters, key["seed"], Judge(TOL), throw=False),
        "DAHA": simulate_quasi_steady(parameters, key["seed"], throw=False),
        "PBD": simulate(parameters, key["seed"], throw=False),
    }
    heights = {name: height(run.final) if run.status else np.nan for name, run in runs.items()}
    return [dict(key) | heights | {"start": height(runs["PBD"].frames[0]), "ended": runs["judge"].final.t}]


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each place: means over all steps, the part of the way down to the minimum with its interval.

    The way down is counted from the start of the step to the minimum that is reached from where DAHA stopped.
    """
    energies = table.pivot(index=["seed", "t"], columns="where", values="energy")
    least = energies["minimum from DAHA"]
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
