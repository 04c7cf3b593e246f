"""Chapter 4, section 4.3.2 and Figure 14: freed springs draw the nucleus back, by forces and by runs."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from tissue.files.parameters import preset
from tissue.frames.observables import ab_positions
from tissue.runs.simulate import simulate
from tissue.state.cells import Floats
from verification.claims import Evidence, Verdict, at_least, proved
from verification.formal.reals import implication
from verification.thesis.chapter4.frequencies import DECIDES
from verification.thesis.text.quoted import claim

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
    "Figure 14",
    chosen=f"back: y^AB ≤ 1 within {AFTER} h",
)
def _pulled_back() -> Evidence:
    (out, found), (others, control) = back("24 h"), back("never")
    return Evidence(
        f"Of {RUNS} isolated cells [A] at 6 h has brought {out} above the tissue by 24 h; {found} of them are back in "
        f"it {AFTER} h after [B] at 24 h, and {control} of {others} without [B].",
        printed=(at_least("cells that return with [B] more than without", found - control, 1),),
    )


@claim(
    "c4.pull-in",
    "The freed spring draws the nucleus to its apical side after [A] and to its basal side after [B].",
    "section 4.3.2, Figure 14",
    Verdict.PROVED,
)
def _pull_in() -> Evidence:
    """A straight cell at rest, d = R + eta of one spring, eta > 0; its rest length becomes R; f acts on the nucleus."""
    return proved(
        implication(
            "the freed spring pulls the nucleus to its point with 2α(d − R^soft)/R^soft > 0 and the point with "
            "the opposite",
            lambda s, d, R, eta, alpha, f, point: (
                [R > 0, eta > 0, alpha > 0, d == R + eta, f * R == s * 2 * alpha * (d - R), point == -f],
                [f > 0, point < 0, f + point == 0],
            ),
            "−α",
        )
    )
