"""Stability of substeps: growing tissues over dt and substeps, with the linear limit of a cell in mitosis."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
import pandas as pd

from dincl.study import Study
from tissue.files.parameters import preset
from verification.instruments.outcome import Outcome
from verification.instruments.stability import Limit, StabilityMap, StabilityRuns
from verification.thesis.chapter3.growing import OUT_OF_BOUNDS, PRESETS, SUCCESS, Frozen, growing, swing

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
NAME, TITLE = "tissue_map_steps", "Growing tissues: dt and substeps"


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


def _limit(name: str) -> Limit:
    """Return the substeps at which h/mu is the limit of a cell in mitosis, over dt."""
    scale = preset(name).numbers().mu * mitotic_limit(name)
    return Limit("a cell in mitosis", lambda dt: dt / scale, [LABELS[name]])


@cache
def runs() -> StabilityRuns:
    """Return the map."""
    return StabilityRuns(
        None,
        {LABELS[name]: partial(grow, name) for name in PRESETS},
        ("dt", tuple(0.0125 * 2.0**k for k in range(8)), "dt [h]"),
        ("substeps", (1, 2, 3, 5, 7, 10, 14, 20, 28, 40, 57, 80, 160), "substeps in dt"),
        limits=[_limit(name) for name in PRESETS],
    )


def study(smallest: bool = False) -> Study:
    """Return the runs of the map."""
    made = runs().study(NAME, f"Map: {TITLE}", smallest)
    return replace(made, columns={**made.columns, **COLUMNS})


def map_of(rows: pd.DataFrame) -> StabilityMap:
    """Return the map from its rows."""
    return replace(runs().result(rows), title=TITLE)


def losses(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each preset: between which h/mu cells are lost.

    ``held`` is the largest below which none were, ``lost`` the least at which some were; beside them the limit of a
    cell in mitosis.
    """
    rows = []
    for name, label in LABELS.items():
        grown = table[table["method"] == label]
        lost = grown.loc[grown["outcome"] == Outcome.UNSTABLE.value, "scale"].min()
        held = grown.loc[grown["scale"] < lost * (1 - ROUNDING), "scale"].max()
        rows.append({"preset": label, "mitosis": mitotic_limit(name), "held": held, "lost": lost})
    return pd.DataFrame(rows)
