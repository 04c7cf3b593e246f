"""Stability of substeps and of DAHA: maps with the limits that linear theory predicts."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
import pandas as pd

from dincl.status import Status
from dincl.study import Study
from tissue.files.parameters import preset
from verification.instruments.outcome import Outcome
from verification.instruments.stability import Limit, StabilityMap, StabilityRuns
from verification.thesis.chapter3 import frozen, linear
from verification.thesis.chapter3.frozen import Frozen, begun, floored, substepped, swing
from verification.thesis.chapter3.growing import OUT_OF_BOUNDS, PRESETS, SUCCESS, extent, far_from, growing
from verification.thesis.quasi_steady.daha import TissueArrowHurwicz

# Growing tissues are looked at after this time [h], a multiple of every dt of the map; the seed of their runs. Nuclei
# that swing by more than SEEN jitter [R_soft].
GROWN, SEED, SEEN = 4.8, 0, 0.01
# Tissues at rest are pushed by so much [R_soft] and left to themselves for so many substeps.
PUSH, SUBSTEPS = 1e-5, 1000
# Distance of a nucleus in mitosis to its apical point, at which the springs hold it [R_soft].
MITOSIS = 1.0
# Two numbers that are equal but for rounding.
ROUNDING = 1e-9
# Of DAHA: iterations after which a step counts as not terminated; age of the tissue [h].
MOST, AGE = 25_000, 5.0
TITLES = {"thesis": "Thesis", "published": "Published"}
COLUMNS = {
    "preset": "Preset",
    "mitosis": "Limit of a cell in mitosis, h/μ",
    "held": "No cell lost up to",
    "lost": "Cells lost from",
    "predicted": "Share at rest as predicted",
    "cells": "Runs at rest",
    "parameter": "Parameter",
    "method": "Tissue",
    "from": "Ends well from factor",
    "to": "to",
    "below": "Below",
    "above": "Above",
    "limit": "Linear limit of the factor",
}


def mitotic_limit(name: str) -> float:
    """Return the linear limit of h/mu for a cell in mitosis, its nucleus one soft radius below the apical layer."""
    numbers, height = preset(name).numbers(), preset(name).start_numbers().height
    return linear.LIMIT / linear.bending(numbers.alpha_axb, MITOSIS, height - MITOSIS)


def grow(name: str, **changes: float) -> dict[str, Any]:
    """Return the outcome of a growing tissue with other numbers; substeps are rounded."""
    run = growing(name, SEED, **changes | {"substeps": round(changes["substeps"])})
    scale = run.numbers.dt / run.numbers.substeps / run.numbers.mu
    frame = run.frame() if run.to(GROWN) else None
    state = None if frame is None else Frozen(frame.cells, frame.layers, run.numbers)
    return {"scale": scale} | _seen(state, scale, run.status, SEEN)


def rest(name: str, names: tuple[str, ...], scale: float, alpha: float) -> dict[str, Any]:
    """Return the outcome of a tissue at rest with other stiffnesses, pushed a little, and its linear limit of h/mu."""
    state, limit = _settled(name, names, alpha)
    cells = substepped(frozen.disturbed(state, PUSH), scale, SUBSTEPS)
    lost = cells is None or extent(cells) > far_from(state.cells)
    after = None if lost or cells is None else state._replace(cells=cells)
    return {"limit": limit} | _seen(after, scale, SUCCESS, PUSH)


@cache
def _settled(name: str, names: tuple[str, ...], alpha: float) -> tuple[Frozen, float]:
    """Return the tissue at rest and its linear limit: one for all steps of a line of a map."""
    state = frozen.at_rest(frozen.stiffened(frozen.grown(name), **dict.fromkeys(names, alpha)))
    return state, frozen.limit(state)


def _seen(state: Frozen | None, scale: float, status: str, calm: float) -> dict[str, Any]:
    """Judge a state by the mean swing of its nuclei: bounded, inaccurate where they jitter, unstable without cells."""
    found = None if state is None else swing(state, scale)
    if found is None:
        lost = OUT_OF_BOUNDS if status == SUCCESS else status
        return {"outcome": Outcome.UNSTABLE.value, "amplitude": np.nan, "status": lost}
    amplitude = float(found.nuclei.mean())
    outcome = Outcome.BOUNDED if amplitude <= calm else Outcome.INACCURATE
    return {"outcome": outcome.value, "amplitude": amplitude, "status": status}


def daha_limit() -> float:
    """Return the bound of dtau^2 alpha lambda for stable eigenvalues lambda of D^2 W, whatever c is.

    (3.25) for one eigenvalue: (1 + a) s^2 - (2 - k) s + (1 - a) = 0 with k = dtau^2 alpha lambda. |s| < 1 if and only
    if a > 0 and the value at s = -1 is positive: (1 + a) + (2 - k) + (1 - a) = 4 - k > 0.
    """
    return 4.0


@cache
def steepest(seed: int) -> float:
    """Return the largest eigenvalue of D^2 W where DAHA of Table 4 stops in the step of the maps."""
    state = begun(floored(), seed, AGE)
    reached = TissueArrowHurwicz(floored().daha_numbers()).minimise(*state).cells
    return float(linear.largest(linear.hessian(reached, state.layers, state.numbers)))


def stepped(seed: int, **factors: float) -> dict[str, Any]:
    """Return the outcome of one step with some parameters times their factors, and the limit of the factor of alpha."""
    own = floored().daha_numbers()
    changed = {name: getattr(own, name) * factor for name, factor in factors.items()}
    minimiser = TissueArrowHurwicz(own._replace(most_iterations=MOST, **changed))
    found = minimiser.minimise(*begun(floored(), seed, AGE))
    limit = daha_limit() / (own.dtau**2 * own.alpha * steepest(seed))
    outcome = Outcome.NOT_TERMINATED if found.status is Status.NOT_CONVERGED else Outcome.UNSTABLE
    if found.status is Status.SUCCESS:
        outcome = Outcome.CONVERGED if found.violation <= SEEN else Outcome.INFEASIBLE
    numbers = {"iterations": found.iterations, "violation": found.violation, "energy": found.energy, "limit": limit}
    return {"outcome": outcome.value, "status": found.status.name} | numbers


def _of_presets(function: Callable[..., dict[str, Any]], *more: Any) -> dict[str, Callable[..., dict[str, Any]]]:
    return {TITLES[name]: partial(function, name, *more) for name in PRESETS}


def _geometric(low: float, high: float, count: int) -> tuple[float, ...]:
    return tuple(float(value) for value in np.geomspace(low, high, count))


def _mitotic(of: str) -> list[Limit]:
    """Return the substeps at which h/mu is the limit of a cell in mitosis, over dt or over mu."""
    limits = []
    for name in PRESETS:
        numbers, limit = preset(name).numbers(), mitotic_limit(name)
        at = {"dt": lambda dt, k=numbers.mu * limit: dt / k, "mu": lambda mu, k=numbers.dt / limit: k / mu}[of]
        limits.append(Limit("a cell in mitosis", at, [TITLES[name]]))
    return limits


COUNTS = ("substeps", (1, 2, 3, 5, 7, 10, 14, 20, 28, 40, 57, 80, 160), "substeps in dt")
SCALES = ("scale", _geometric(2.5e-4, 0.5, 34), "h/μ")
FACTORS = tuple(10.0 ** (k / 4) for k in range(-8, 13))
TISSUES = {"Seed 0": partial(stepped, 0), "Seed 1": partial(stepped, 1)}
BOTH = ("stiff_ax", "stiff_bx")


def _table_4(name: str, letter: str) -> tuple[str, tuple[float, ...], str]:
    return name, FACTORS, f"{letter} / Table 4"


STEPS = ("dt", tuple(0.0125 * 2.0**k for k in range(8)), "dt [h]")
DAMPINGS = ("mu", _geometric(0.0125, 0.4, 16), "μ [h]")
BENDING = ("alpha", _geometric(1.5, 150.0, 13), "α of straightness")
SPRINGS = ("alpha", _geometric(0.5, 32.0, 13), "α of both springs")


@cache
def maps() -> Mapping[str, StabilityRuns]:
    """Return the maps by the names of their tables: growing tissues, tissues at rest, one step of DAHA."""
    return {
        "tissue_map_steps": StabilityRuns(None, _of_presets(grow), STEPS, COUNTS, limits=_mitotic("dt")),
        "tissue_map_damping": StabilityRuns(None, _of_presets(grow), DAMPINGS, COUNTS, limits=_mitotic("mu")),
        "tissue_map_bending": StabilityRuns(None, _of_presets(rest, ("stiff_axb",)), BENDING, SCALES),
        "tissue_map_springs": StabilityRuns(None, _of_presets(rest, BOTH), SPRINGS, SCALES),
        "tissue_daha_descent": StabilityRuns(None, TISSUES, _table_4("beta", "β"), _table_4("alpha", "α")),
        "tissue_daha_multipliers": StabilityRuns(None, TISSUES, _table_4("gamma", "γ"), _table_4("c", "c")),
    }


TITLED = {
    "tissue_map_steps": "Growing tissues: dt and substeps",
    "tissue_map_damping": "Growing tissues: damping and substeps",
    "tissue_map_bending": "Tissues at rest: straightness",
    "tissue_map_springs": "Tissues at rest: springs",
    "tissue_daha_descent": "One step of DAHA: α and β",
    "tissue_daha_multipliers": "One step of DAHA: γ and c",
}
GROWING, RESTING, DAHA = (tuple(TITLED)[k : k + 2] for k in (0, 2, 4))


def map_study(name: str, smallest: bool = False) -> Study:
    """Return the runs of a map."""
    made = maps()[name].study(name, f"Map: {TITLED[name]}", smallest)
    return replace(made, columns={**made.columns, **COLUMNS})


def map_of(name: str, rows: pd.DataFrame) -> StabilityMap:
    """Return a map from its rows, with the linear limits of h/mu, or of the factor of alpha, that these have."""
    runs = maps()[name]
    if name in RESTING or name == DAHA[0]:
        across = runs.x[0]
        lines = rows.groupby("method")
        words = "2/λ_max of the Hessian" if name in RESTING else "Δτ² α λ_max = 4"
        runs = replace(runs, limits=[Limit(words, _line(mine, across), [method]) for method, mine in lines])
    return replace(runs.result(rows), title=TITLED[name])


def _line(rows: pd.DataFrame, across: str) -> Callable[[float], float]:
    """Return the limit over an axis, between its values by straight lines of logarithms."""
    limits = rows.groupby(across)["limit"].first()
    x, y = np.log(limits.index.to_numpy(np.float64)), np.log(limits.to_numpy())
    return lambda value: float(np.exp(np.interp(math.log(value), x, y)))


def losses(tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return one row for each preset, from all maps of tissues: between which h/mu cells of growing ones are lost.

    ``held`` is the largest below which none were, ``lost`` the least at which some were; beside them the limit of a
    cell in mitosis, and the part of the maps of tissues at rest that comes out as the linear limit says: a jitter that
    grew above it, and none below.
    """
    rows = []
    for name, label in TITLES.items():
        grown, resting = (
            pd.concat([tables[one][tables[one]["method"] == label] for one in some]) for some in (GROWING, RESTING)
        )
        lost = grown.loc[grown["outcome"] == Outcome.UNSTABLE.value, "scale"].min()
        held = grown.loc[grown["scale"] < lost * (1 - ROUNDING), "scale"].max()
        agree = (resting["outcome"] != Outcome.BOUNDED.value) == (resting["scale"] > resting["limit"])
        row = {"preset": label, "mitosis": mitotic_limit(name), "held": held, "lost": lost}
        rows.append(row | {"predicted": float(agree.mean()), "cells": len(resting)})
    return pd.DataFrame(rows)


def held(tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return one row for each tissue and parameter of DAHA: the factors around 1 between which a step ends well.

    ``from`` and ``to`` are those next to 1 from which on all terminate without a violation that is seen; beside them
    what is met beyond. The limit of alpha is that of the linear theory.
    """
    rows = []
    for map_name, names in zip(DAHA, (("alpha", "beta"), ("gamma", "c")), strict=True):
        for method, table in tables[map_name].groupby("method"):
            for name, across in (names, names[::-1]):
                line = table[np.isclose(table[across], 1.0, rtol=ROUNDING)].sort_values(name)
                predicted = float(table["limit"].iloc[0]) if name == "alpha" else np.nan
                rows.append({"method": method, "parameter": name} | _around(line, name) | {"limit": predicted})
    return pd.DataFrame(rows)


def _around(line: pd.DataFrame, along: str) -> dict[str, Any]:
    """Return the factors around 1 between which a line of cells ends well."""
    good, factor = (line["outcome"] == Outcome.CONVERGED.value).to_numpy(), line[along].to_numpy()
    middle = int(np.argmin(np.abs(np.log(factor))))
    below, above = np.flatnonzero(~good[: middle + 1]), middle + np.flatnonzero(~good[middle:])
    first = int(below[-1]) + 1 if below.size else 0
    last = int(above[0]) - 1 if above.size else len(factor) - 1
    outcome, inside = line["outcome"].to_numpy(), first <= last
    return {
        "from": factor[first] if inside else np.nan,
        "to": factor[last] if inside else np.nan,
        "below": outcome[first - 1] if first else "as far as tried",
        "above": outcome[last + 1] if last + 1 < len(factor) else "as far as tried",
    }
