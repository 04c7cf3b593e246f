"""Chapter 4, section 4.3.2 and Figure 14: freed springs draw the nucleus back, by forces and by runs."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tissue.files.parameters import preset as named
from tissue.frames.observables import ab_positions
from tissue.runs.simulate import simulate_many
from tissue.state.cells import Floats
from verification.claims import Evidence, Verdict, at_least, proved
from verification.formal.reals import implication
from verification.thesis.chapter4.frequencies import in_readings
from verification.thesis.text.quoted import claim

# Runs with one cell each; how long after [B] they end [h].
SEEDS, AFTER = range(60, 120), 3


def positions(preset: str, seeds: Sequence[int], b: str) -> Floats:
    """Return y_AB of isolated EMT cells at 24 h and after some hours, for [A] at 6 h and [B] at ``b``: (2, seeds)."""
    emt = {"emt.cells": 1, "emt.a": "6 h", "emt.b": b}
    parameters = named(preset).changed(emt | {"numerics.t_end": f"{24 + AFTER} h", "numerics.keep": f"{AFTER} h"})
    runs = simulate_many(parameters, seeds)
    return np.array([[ab_positions(run.frames[k])[run.frames[k].cells.emt >= 0][0] for run in runs] for k in (-2, -1)])


@claim(
    "c4.pulled-back",
    "Some cells that left apically after [A] return into the tissue when [B] frees their basal spring.",
    "Figure 14",
    rests_on=("c4.pull-in",),
    chosen=f"[A] at 6 h, [B] at 24 h; back: y^AB ≤ 1 within {AFTER} h; the same seeds with [B] and without",
)
def _pulled_back() -> Evidence:
    def compare(preset: str) -> Evidence:
        at, later = positions(preset, SEEDS, "24 h")
        above = [seed for seed, y in zip(SEEDS, at, strict=True) if y > 1]
        _, control = positions(preset, above, "never")
        back = int((later[at > 1] <= 1).sum()) - int((control <= 1).sum())
        return Evidence(
            printed=(
                at_least("isolated cells above the tissue at 24 h", len(above), 1),
                at_least("of these, return with [B] minus return without [B]", back, 1),
            )
        )

    return in_readings(compare)


@claim(
    "c4.pull-in",
    "The freed spring draws the nucleus to its apical side after [A] and to its basal side after [B].",
    "section 4.3.2, Figure 14",
    Verdict.PROVED,
    rests_on=("c4.rest-length",),
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
