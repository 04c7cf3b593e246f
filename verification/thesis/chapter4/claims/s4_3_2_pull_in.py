"""Chapter 4, section 4.3.2 and Figure 14: freed springs draw the nucleus back, by forces and by runs."""

from __future__ import annotations

import numpy as np

from tissue.files.parameters import preset
from tissue.model.energy import forces
from tissue.model.observables import ab_positions
from tissue.runs.simulate import simulate
from tissue.state.cells import CellLayers, Floats, empty
from verification.claims import claim
from verification.evidence import Evidence, Kind, at_least, at_most
from verification.thesis.chapter4.frequencies import DECIDES

TOL = 1e-7
# Runs with one cell each, and how long after [B] they end [h].
RUNS, AFTER = 60, 3


def positions(seed: int, b: str) -> Floats:
    """y_AB of an isolated EMT cell at 24 h and after some hours, for [A] at 6 h and [B] at ``b``."""
    emt = {"emt.cells": 1, "emt.a": "6 h", "emt.b": b}
    parameters = preset(DECIDES).changed(emt | {"numerics.t_end": f"{24 + AFTER} h", "numerics.keep": f"{AFTER} h"})
    frames = simulate(parameters, seed).frames[-2:]
    return np.array([ab_positions(frame)[frame.cells.emt >= 0] for frame in frames])


def back(b: str) -> tuple[int, int]:
    """Cells above the tissue at 24 h, and those of them that are not any more some hours later."""
    at, later = np.concatenate([positions(seed, b) for seed in range(RUNS)], axis=1)
    return int((at > 1).sum()), int(((at > 1) & (later <= 1)).sum())


@claim(
    "c4.pulled-back",
    "Some cells that left apically after [A] return into the tissue when [B] frees their basal spring.",
    source="Figure 14",
    quote=(
        "In [A⊗B], the amount of apical extrusion increases rapidly in the beginning … at the onset of [B] some cells "
        "are pulled back into the tissue."
    ),
    chosen=f"back: y^AB ≤ 1 within {AFTER} h",
)
def _pulled_back() -> Evidence:
    (out, found), (others, control) = back("24 h"), back("never")
    return Evidence(
        f"Of {RUNS} isolated cells [A] at 6 h has brought {out} above the tissue by 24 h; {found} of them are back in "
        f"it {AFTER} h after [B] at 24 h, and {control} of {others} without [B].",
        printed=(at_least("cells that return with [B] more than without", found - control, 1),),
    )


def on_points(freed: str) -> tuple[float, float]:
    """Vertical forces on the nucleus and on the freed point of a cell at rest, once one rest length is zero."""
    numbers = preset("thesis").numbers()
    cells = empty(1)
    for name, value in {"y": 4.0, "ay": 8.0, "rest_ax": 3.0, "rest_bx": 3.0}.items():
        getattr(cells, name)[:] = value
    cells.stiff_ax[:], cells.stiff_bx[:] = numbers.alpha_ax, numbers.alpha_bx
    getattr(cells, f"rest_{freed}x")[:] = 0.0
    found = forces(cells, CellLayers(np.zeros(1, np.int64), np.zeros(1, np.int64)), numbers)
    return float(found.y[0]), float(getattr(found, f"{freed}y")[0])


@claim(
    "c4.pull-in",
    "The freed spring draws the nucleus to its apical side after [A] and to its basal side after [B].",
    source="section 4.3.2, Figure 14",
    quote="not only pulls the apical or basal point towards the nucleus but it also pulls the nucleus itself",
    recorded=Kind.NOT_REFUTED,
    tried_on="one straight cell at rest",
)
def _pull_in() -> Evidence:
    (up, apical), (down, basal) = on_points("a"), on_points("b")
    return Evidence(
        f"A straight cell at rest whose apical rest length becomes zero feels {up:+.1f} on the nucleus and "
        f"{apical:+.1f} on the apical point; with the basal one it is {down:+.1f} and {basal:+.1f} on the basal point.",
        printed=(
            at_least("upward force on the nucleus after [A]", up, TOL),
            at_most("upward force on the nucleus after [B]", down, -TOL),
            at_most("sum of the forces on nucleus and point, [A]", abs(up + apical), 0.0, TOL),
            at_most("sum of the forces on nucleus and point, [B]", abs(down + basal), 0.0, TOL),
        ),
    )
