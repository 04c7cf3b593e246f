"""Maps of the jitter of substeps and of lost cells: growing tissues, and tissues at rest."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pandas as pd

from dincl.study import Study
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.state.numbers import Numbers
from verification.thesis.chapter2.stability.plane import Axis, Plane, geometric
from verification.thesis.chapter3 import frozen, linear
from verification.thesis.chapter3.frozen import Frozen
from verification.thesis.chapter3.growing import OUT_OF_BOUNDS, SUCCESS, extent, far_from, growing
from verification.thesis.chapter3.jitter import substepped, swing

LABELS = {"thesis": "Thesis", "published": "Published"}
# Growing tissues are looked at after this time [h], a multiple of every dt of the map; the seed of their runs.
GROWN, SEED = 4.8, 0
# Tissues at rest are pushed by so much [R_soft] and left to themselves for so many substeps.
PUSH, SUBSTEPS = 1e-5, 1000
# Two h/mu that are equal but for rounding.
ROUNDING = 1e-9
# Distance of a nucleus in mitosis to its apical point, at which the springs hold it [R_soft].
MITOSIS = 1.0


def mitotic_limit(numbers: Numbers, height: float) -> float:
    """Return the linear limit of h/mu for a cell in mitosis, its nucleus one soft radius below the apical layer."""
    return linear.LIMIT / linear.bending(numbers.alpha_axb, MITOSIS, height - MITOSIS)


def grown_with_step(method: str, dt: float, substeps: float) -> dict[str, Any]:
    """Return a growing tissue with other dt and substeps; the limit is that of dt."""
    numbers, height = preset(method).numbers(), preset(method).start_numbers().height
    limit = mitotic_limit(numbers, height) * numbers.mu * substeps
    return _grown(method, limit, dt=dt, substeps=round(substeps))


def grown_with_damping(method: str, mu: float, substeps: float) -> dict[str, Any]:
    """Return a growing tissue with other mu and substeps; the limit is that of mu."""
    numbers, height = preset(method).numbers(), preset(method).start_numbers().height
    limit = numbers.dt / substeps / mitotic_limit(numbers, height)
    return _grown(method, limit, mu=mu, substeps=round(substeps))


def _grown(method: str, limit: float, **changes: Any) -> dict[str, Any]:
    run = growing(method, SEED, **changes)
    frame = run.frame() if run.to(GROWN) else None
    scale = run.numbers.dt / run.numbers.substeps / run.numbers.mu
    return {"limit": limit, "scale": scale} | _seen(frame, run.numbers, scale, run.status)


def _seen(frame: Frame | None, numbers: Numbers, scale: float, status: str) -> dict[str, Any]:
    found = None if frame is None else swing(frame.cells, frame.layers, numbers, scale)
    if found is None:
        return {"amplitude": np.nan, "status": OUT_OF_BOUNDS if status == SUCCESS else status}
    return {"amplitude": float(found.nuclei.mean()), "status": status}


def rest_with_bending(method: str, scale: float, alpha: float) -> dict[str, Any]:
    """Return a tissue at rest with another stiffness alpha_axb; the limit is that of h/mu."""
    return _at_rest(method, scale, ("stiff_axb",), alpha)


def rest_with_springs(method: str, scale: float, alpha: float) -> dict[str, Any]:
    """Return a tissue at rest with other stiffnesses alpha_ax = alpha_bx; the limit is that of h/mu."""
    return _at_rest(method, scale, ("stiff_ax", "stiff_bx"), alpha)


def _at_rest(method: str, scale: float, names: tuple[str, ...], alpha: float) -> dict[str, Any]:
    state, limit = _settled(method, names, alpha)
    pushed = frozen.disturbed(state, PUSH)
    cells = substepped(pushed.cells, pushed.layers, pushed.numbers, scale, SUBSTEPS)
    lost = cells is None or extent(cells) > far_from(state.cells)
    frame = None if lost or cells is None else Frame(0.0, cells, pushed.layers)
    return {"limit": limit, "scale": scale} | _seen(frame, state.numbers, scale, SUCCESS)


@cache
def _settled(method: str, names: tuple[str, ...], alpha: float) -> tuple[Frozen, float]:
    """Return the tissue at rest and its linear limit: one for all steps of a line of a map."""
    state = frozen.at_rest(frozen.stiffened(frozen.grown(method), **dict.fromkeys(names, alpha)))
    return state, frozen.limit(state)


STEP = Axis("dt [h]", tuple(0.0125 * 2.0**k for k in range(8)))
SUBSTEPS_AXIS = Axis("substeps in dt", (1, 2, 3, 5, 7, 10, 14, 20, 28, 40, 57, 80, 160))
DAMPING = Axis("μ [h]", geometric(0.0125, 0.4, 16))
SCALE = Axis("h/μ", geometric(2.5e-4, 0.5, 34))
BENDING = Axis("α of straightness", geometric(1.5, 150.0, 13))
SPRINGS = Axis("α of both springs", geometric(0.5, 32.0, 13))


PLANES = (
    Plane("steps", "dt and substeps", STEP, SUBSTEPS_AXIS, LABELS, grown_with_step, ()),
    Plane("damping", "damping and substeps", DAMPING, SUBSTEPS_AXIS, LABELS, grown_with_damping, ()),
    Plane("bending", "straightness", SCALE, BENDING, LABELS, rest_with_bending, ()),
    Plane("springs", "springs", SCALE, SPRINGS, LABELS, rest_with_springs, ()),
)
GROWING, RESTING = PLANES[:2], PLANES[2:]


@dataclass(frozen=True)
class MapsForm:
    """Planes to map."""

    planes: tuple[Plane, ...] = PLANES


# There is one form only.
FORM = MapsForm()


def study(plane: Plane) -> Study:
    """Return all cells of a map."""
    return named(plane, "tissue_map", "Tissue map")


def named(plane: Plane, name: str, title: str) -> Study:
    """Return the study of a map under a name of the tissue."""
    return replace(plane.study(), name=f"{name}_{plane.name}", title=f"{title}: {plane.title}")


def losses(tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return one row for each preset, from all maps of growing tissues: between which h/mu cells begin to be lost.

    ``held`` is the largest below which none were, ``lost`` the least at which some were; beside them the limit of a
    cell in mitosis, and the part of the maps of tissues at rest that comes out as the linear limit says: a jitter that
    grew above it, and none below.
    """
    rows = []
    for name in LABELS:
        growing_rows, resting = (
            pd.concat([table[table["method"] == name] for table in (tables[plane.name] for plane in planes)])
            for planes in (GROWING, RESTING)
        )
        lost = growing_rows.loc[growing_rows["status"] != SUCCESS, "scale"].min()
        fine = growing_rows["scale"]
        jitters = ~(resting["amplitude"] <= PUSH)
        rows.append(
            {
                "preset": name,
                "mitosis": mitotic_limit(preset(name).numbers(), preset(name).start_numbers().height),
                "held": fine[fine < lost * (1 - ROUNDING)].max(),
                "lost": lost,
                "predicted": float((jitters == (resting["scale"] > resting["limit"])).mean()),
                "cells": len(resting),
            }
        )
    return pd.DataFrame(rows)
