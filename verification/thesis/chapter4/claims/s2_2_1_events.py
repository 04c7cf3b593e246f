"""Chapter 4, sections 2.2.1 to 2.2.3 and 2.2.5: how cells leave the layers, what their springs do, and who divides."""

from __future__ import annotations

from itertools import permutations
from typing import Any

import numpy as np

from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.runs.run import Run
from tissue.runs.simulate import simulate
from verification.claims import Correction, Effect, Evidence, Verdict, at_least, at_most, claim, equal, proved
from verification.formal.cases import all_cases

SEED = 4
GROUP = 10
# The freed apical spring of Table 2 of chapter 3, in R_soft and hours: stiffness, rate, damping, and its start.
ALPHA, RATE, MU, ETA, STEP, HOURS = 2.0, 5.0, 0.15, 1.5, 1e-3, 3.0
# A contraction worth the name: the spring becomes at least a tenth shorter.
SHORTER = 0.9
# What rounding leaves of y = 0 and of a length.
# A bend that can be seen [degrees], and how many times that of a cell with a stiff bending spring.
BEND, TIMES = 10.0, 2.0

Edges = frozenset[tuple[int, int]]


def bridged(edges: Edges, i: int) -> Edges:
    """The edges (j1, i) and (i, j2) replaced by (j1, j2); at the boundary the one edge is removed."""
    left = [a for a, b in edges if b == i]
    right = [b for a, b in edges if a == i]
    return frozenset(edge for edge in edges if i not in edge) | frozenset((a, b) for a in left for b in right)


@claim(
    "c4.bridged",
    "When cells leave a layer their neighbours are joined, so that the rest is again one line of cells.",
    source="sections 2.2.1, 2.2.2",
    quote="we replace the edges (j₁, i) and (i, j₂) with the new edge (j₁, j₂)",
    recorded=Verdict.PROVED_INSTANCE,
    tried_on="layers of six cells, all orders in which four leave",
)
def _bridge() -> Evidence:
    """Four of six cells leave in every order; the wrong variant removes edges without joining neighbours."""
    start = frozenset((k, k + 1) for k in range(5))

    def line(s: Any, gone: tuple[int, ...]) -> bool:
        edges = start
        for i in gone:
            edges = bridged(edges, i) if s == 1 else frozenset(edge for edge in edges if i not in edge)
        stay = sorted(set(range(6)) - set(gone))
        return edges == frozenset({(stay[0], stay[1])})

    return proved(
        all_cases(
            "whichever four of six cells leave, in whichever order, one edge joins the two that stay",
            line,
            permutations(range(6), 4),
            "neighbours are not joined",
        )
    )


def contracted(relaxes: bool) -> float:
    """|X - A| of a freed spring after some hours, over that before; η* = 0, and (3.2) holds or does not."""
    eta, d = ETA, 1.0 + ETA
    for _ in range(round(HOURS / STEP)):
        # Both ends move along the spring, each by its force 2 α (d - l)/l.
        d -= STEP / MU * 2 * (2 * ALPHA * (d - 1.0 - eta) / (1.0 + eta))
        eta -= STEP * RATE * eta * relaxes
    return d / (1.0 + ETA)


@claim(
    "c4.rest-length",
    "After the loss of adhesion an equation of chapter 3 no longer holds for the rest length.",
    source="sections 2.2.1, 2.2.2",
    quote="the INM-specific cell event (3.2) [(3.3)] will not apply anymore for the i th cell",
    correction=Correction(
        (
            "the rules of sections 2.2.2 and 2.2.3 of chapter 3 that set η^{ax*} and η^{bx*} do not apply any "
            "more; (3.2) and (3.3), by which η tends to η* = 0, do"
        ),
        Effect.MODEL,
        "events [A] and [B], the contraction in Figures 5 and 6, the pull-in effect of section 4.3.2",
        why=(
            "η tends to η* only by (3.2) and (3.3); if they stop at the time of the event, η stays as it is and "
            "nothing contracts, against Figures 5 and 6"
        ),
        place=2403,
    ),
)
def _rest_length() -> Evidence:
    what = f"length of a freed spring at rest {HOURS:g} h after [A], over the one before,"
    return Evidence(
        printed=(at_most(f"{what} without (3.2)", contracted(relaxes=False), SHORTER),),
        corrected=(at_most(f"{what} with (3.2) and η* = 0", contracted(relaxes=True), SHORTER),),
    )


def run_with(changes: dict[str, object]) -> Run:
    """Ten EMT cells in the model as printed."""
    return simulate(preset("thesis").changed({"emt.cells": GROUP} | changes), SEED)


def bend(frames: tuple[Frame, ...]) -> float:
    """Mean of 180° - γ over the EMT cells of these states [degrees]."""
    angles = []
    for frame in frames:
        cells = frame.cells
        group = cells.emt >= 0
        a = np.stack((cells.ax - cells.x, cells.ay - cells.y))[:, group]
        b = np.stack((cells.bx - cells.x, cells.by - cells.y))[:, group]
        cosine = (a * b).sum(axis=0) / np.hypot(*a) / np.hypot(*b)
        angles.append(180 - np.degrees(np.arccos(np.clip(cosine, -1, 1))))
    return float(np.mean(angles))


@claim(
    "c4.bent",
    "A cell whose bending spring has no stiffness is bent.",
    source="section 2.2.3, Figure 7",
    quote="the angle between the apical-nuclei and basal-nuclei springs is no longer straight",
    tried_on="ten cells of one run",
)
def _bent() -> Evidence:
    straight, loose = (
        bend(run_with({"emt.s": time, "numerics.t_end": "18 h"}).frames[9:]) for time in ("never", "6 h")
    )
    return Evidence(
        printed=(
            at_least(f"180° minus the mean angle of the springs of {GROUP} cells from 3 h after [S] [°]", loose, BEND),
            at_least("the same bend over that of cells without [S]", loose / straight, TIMES),
        ),
        seed=SEED,
    )


@claim(
    "c4.constant-group",
    "The number of EMT cells is constant: they begin new cycles and have no daughters.",
    source="sections 2.2.5, 2.3.1",
    quote="the EMT cells will effectively reset their cell cycle instead of performing cell division",
    tried_on="ten cells of one run, 48 h",
)
def _constant() -> Evidence:
    run = run_with({"numerics.t_end": "48 h", "numerics.keep": "12 h"})
    counts = [int((frame.cells.emt >= 0).sum()) for frame in run.frames]
    last = run.final.cells
    group = last.emt >= 0
    daughters = int(np.isin(last.mother, last.id[group]).sum())
    renewed = int((last.birth[group] > 0).sum())
    return Evidence(
        printed=(
            at_least("cells of the tissue after 48 h", len(last.x), len(run.frames[0].cells.x) + 1),
            equal("least number of EMT cells in 48 h", min(counts), GROUP),
            equal("greatest number of EMT cells in 48 h", max(counts), GROUP),
            equal("daughters of EMT cells", daughters, 0),
            equal("EMT cells with a new cycle", renewed, GROUP),
        ),
        seed=SEED,
    )
