"""Stability of substeps: growing tissues over dt, damping and substeps, with the linear limit of a cell in mitosis."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
import pandas as pd

from dincl.study import Study
from tissue.files.parameters import preset
from verification.instruments.outcome import Outcome
from verification.instruments.stability import Limit, StabilityMap, StabilityRuns
from verification.thesis.chapter3.frozen import Frozen, swing
from verification.thesis.chapter3.growing import OUT_OF_BOUNDS, PRESETS, SUCCESS, growing

# Growing tissues are looked at after this time [h], a multiple of every dt of the map; the seed of their runs. Nuclei
# that swing by more than SEEN jitter [R_soft].
GROWN, SEED, SEEN = 4.8, 0, 0.01
# Distance of a nucleus in mitosis to its apical point, at which the springs hold it [R_soft].
MITOSIS = 1.0
# Of h/mu times an eigenvalue, for explicit Euler; two numbers that are equal but for rounding.
LIMIT, ROUNDING = 2.0, 1e-9
LABELS = {"thesis": "Thesis", "published": "Published"}
COLUMNS = {
    "preset": "Preset",
    "mitosis": "Limit of a cell in mitosis, h/μ",
    "held": "No cell lost up to",
    "lost": "Cells lost from",
}
TITLES = {
    "tissue_map_steps": "Growing tissues: dt and substeps",
    "tissue_map_damping": "Growing tissues: damping and substeps",
}


def bending(alpha: float, u: float, v: float) -> float:
    """Return 2 alpha (1/u^2 + 1/v^2 + 1/(u v)): the eigenvalue of a straight cell, nucleus u and v away from its ends.

    The angle is off by a sideways move of A, X, B as (1/u, -1/u - 1/v, 1/v), and W by alpha/2 times its square. Springs
    are at rest, so that they do not resist such a move.
    """
    return 2 * alpha * (1 / u**2 + 1 / v**2 + 1 / (u * v))


def mitotic_limit(name: str) -> float:
    """Return the linear limit of h/mu for a cell in mitosis, its nucleus one soft radius below the apical layer."""
    numbers, height = preset(name).numbers(), preset(name).start_numbers().height
    return LIMIT / bending(numbers.alpha_axb, MITOSIS, height - MITOSIS)


def grow(name: str, **changes: float) -> dict[str, Any]:
    """Return the outcome of a growing tissue with other numbers; substeps are rounded.

    It is judged by the mean swing of its nuclei: bounded, inaccurate where they jitter, unstable where cells are lost.
    """
    run = growing(name, SEED, **changes | {"substeps": round(changes["substeps"])})
    scale = run.numbers.dt / run.numbers.substeps / run.numbers.mu
    frame = run.frame() if run.to(GROWN) else None
    found = None if frame is None else swing(Frozen(frame.cells, frame.layers, run.numbers), scale)
    if found is None:
        lost = OUT_OF_BOUNDS if run.status == SUCCESS else run.status
        return {"scale": scale, "outcome": Outcome.UNSTABLE.value, "amplitude": np.nan, "status": lost}
    amplitude = float(found.mean())
    outcome = Outcome.BOUNDED if amplitude <= SEEN else Outcome.INACCURATE
    return {"scale": scale, "outcome": outcome.value, "amplitude": amplitude, "status": run.status}


def _mitotic(of: Callable[[Any, float], Callable[[float], float]]) -> list[Limit]:
    """Return the substeps at which h/mu is the limit of a cell in mitosis, over dt or over mu."""
    return [
        Limit("a cell in mitosis", of(preset(name).numbers(), mitotic_limit(name)), [label])
        for name, label in LABELS.items()
    ]


@cache
def maps() -> Mapping[str, StabilityRuns]:
    """Return the maps by the names of their tables."""
    of_presets = {LABELS[name]: partial(grow, name) for name in PRESETS}
    substeps = ("substeps", (1, 2, 3, 5, 7, 10, 14, 20, 28, 40, 57, 80, 160), "substeps in dt")
    dt = ("dt", tuple(0.0125 * 2.0**k for k in range(8)), "dt [h]")
    mu = ("mu", tuple(np.geomspace(0.0125, 0.4, 16).tolist()), "μ [h]")
    over_dt = _mitotic(lambda numbers, limit: lambda dt: dt / (numbers.mu * limit))
    over_mu = _mitotic(lambda numbers, limit: lambda mu: numbers.dt / limit / mu)
    return {
        "tissue_map_steps": StabilityRuns(None, of_presets, dt, substeps, limits=over_dt),
        "tissue_map_damping": StabilityRuns(None, of_presets, mu, substeps, limits=over_mu),
    }


def map_study(name: str, smallest: bool = False) -> Study:
    """Return the runs of a map."""
    made = maps()[name].study(name, f"Map: {TITLES[name]}", smallest)
    return replace(made, columns={**made.columns, **COLUMNS})


def map_of(name: str, rows: pd.DataFrame) -> StabilityMap:
    """Return a map from its rows."""
    return replace(maps()[name].result(rows), title=TITLES[name])


def losses(tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return one row for each preset, from all maps: between which h/mu cells are lost.

    ``held`` is the largest below which none were, ``lost`` the least at which some were; beside them the limit of a
    cell in mitosis.
    """
    rows = []
    for name, label in LABELS.items():
        grown = pd.concat([tables[one][tables[one]["method"] == label] for one in TITLES])
        lost = grown.loc[grown["outcome"] == Outcome.UNSTABLE.value, "scale"].min()
        held = grown.loc[grown["scale"] < lost * (1 - ROUNDING), "scale"].max()
        rows.append({"preset": label, "mitosis": mitotic_limit(name), "held": held, "lost": lost})
    return pd.DataFrame(rows)
