"""Chapter 1, sections 4.6.3 and 5: the proof of uniqueness, and whether the theorems cover the later models."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

import dincl
from verification.claims import Correction, Effect, Evidence, at_most, claim
from verification.thesis.chapter1.cells import TOL, State, divided, in_mitosis, nearest, overlap, problem
from verification.thesis.chapter1.sets import Floats, catch_up, falling

# Of catch-up from a feasible state, in units of the time in which the pull to the middle acts.
DT, END = 0.1, 1.0


def beside_the_top() -> tuple[Floats, Floats, Floats]:
    """Return two paths that slide down beside the top of the disc, their ẋ - F, and the time step; from 10^-3 apart."""
    angles, h = np.array([0.01, 0.011]), 1e-3
    path = catch_up(np.stack([np.sin(angles), np.cos(angles)], axis=1), falling, h, 1000)
    return path, np.diff(path, axis=0) / h - falling(path[:-1]), np.array(h)


@claim(
    "c1.uniqueness-sign",
    "½ d/dt ‖x - y‖² ≤ -(v - w)·(x - y) for two solutions with constraint forces v, w ∈ -N, F constant.",
    source="proof of Lemma 1.32",
    quote="½ d/dt ‖x - y‖² ≤ -(v - w)·(x - y) + … ≤ (‖v‖ + ‖w‖)/(2η) ‖x - y‖² + …",
    correction=Correction(
        "(v - w)·(x - y)",
        Effect.PROOF,
        "(1.77), which stands but for its exponential",
        why="ẋ − ẏ = (v − w) + F(x) − F(y), and (1.28) for −v, −w ∈ N(S, ·) bounds (v − w)·(x − y) from above",
        place=1119,
    ),
    rests_on=("c1.hypomonotone",),
    tried_on="two points that slide over a disc",
)
def _uniqueness_sign() -> Evidence:
    """Rates over the squared distance, so that all times count alike."""
    path, pulls, h = beside_the_top()
    gap, pull = path[:, 0] - path[:, 1], pulls[:, 0] - pulls[:, 1]
    square = (gap**2).sum(axis=1)
    rate, product = np.diff(square) / (2 * h) / square[1:], (pull * gap[1:]).sum(axis=1) / square[1:]
    bound = np.linalg.norm(pulls, axis=2).sum(axis=1) / 2
    return Evidence(
        printed=(
            at_most("largest ½ d/dt ‖x - y‖² + (v - w)·(x - y), over ‖x - y‖²", (rate + product).max(), 0.0, 0.01),
        ),
        corrected=(
            at_most("largest ½ d/dt ‖x - y‖² - (v - w)·(x - y), over ‖x - y‖²", (rate - product).max(), 0.0, 0.01),
            at_most("largest (v - w)·(x - y)/‖x - y‖² - (‖v‖ + ‖w‖)/(2η)", (product - bound).max(), 0.0, 1e-6),
        ),
    )


@claim(
    "c1.gronwall",
    ("The distance of two solutions is at most its first value times the integral of L_F + (‖v‖ + ‖w‖)/(2η)."),
    source="(1.77)",
    quote="‖x(t) - y(t)‖ ≤ ‖xⁱⁿⁱᵗ - yⁱⁿⁱᵗ‖ ∫₀ᵗ (L_F + (‖v‖ + ‖w‖)/(2η)) ds",
    correction=Correction(
        "‖xⁱⁿⁱᵗ - yⁱⁿⁱᵗ‖ exp(∫₀ᵗ (L_F + (‖v‖ + ‖w‖)/(2η)) ds)",
        Effect.PROOF,
        "the constant a of Lemma 1.32",
        why=(
            "Gronwall's lemma turns d/dt ‖x − y‖² ≤ 2a(t)‖x − y‖² into the exponential of ∫a; at t = 0 the "
            "printed bound is 0"
        ),
        place=1123,
    ),
    rests_on=("c1.uniqueness-sign",),
    tried_on="two points that slide over a disc",
)
def _gronwall() -> Evidence:
    """L_F = 0 and eta = 1; the integral by the rule that goes with the steps."""
    path, pulls, h = beside_the_top()
    gaps = np.linalg.norm(path[:, 0] - path[:, 1], axis=1)
    integral = np.cumsum(np.linalg.norm(pulls, axis=2).sum(axis=1) / 2 * h)
    grown = gaps[1:] / gaps[0]
    printed, right = (grown / integral).max(), (grown / np.exp(integral)).max()
    return Evidence(
        printed=(at_most("largest distance over the bound with the integral", printed, 1.0),),
        corrected=(at_most("largest distance over the bound with its exponential", right, 1.0, 0.01),),
    )


def refined(start: State) -> tuple[float, float]:
    """Return the largest overlap of catch-up, and how much less the end moves when the step is halved a second time."""
    paths = [
        dincl.solve(problem(*start), dincl.CatchUp(dt, dincl.Daqp(tol=TOL)), t=np.arange(1, round(END / dt) + 1) * dt)
        for dt in (DT, DT / 2, DT / 4)
    ]
    first, second = (float(np.linalg.norm(b.final - a.final)) for a, b in pairwise(paths))
    return max(float(path.violation().max()) for path in paths), second / first


@claim(
    "c1.applications",
    "The theorems also cover the tissue models of chapters 3 and 4.",
    source="section 5, and introduction, Part I",
    quote="the presented theorems also cover our applications in Chapters 3 and 4.",
    correction=Correction(
        (
            "they cover the motion from one cell event to the next, if it starts in S; after a division, and when"
            " mitosis begins, the state is not in S, and has to be projected or set anew, e.g. with daughters "
            "2R^hard apart"
        ),
        Effect.CONCLUSION,
        (
            "“which fulfil the assumptions needed for well-posedness” in the introduction; section 3.2 of chapter"
            " 3, which takes Theorem 1.31 for its model"
        ),
        why=(
            "Theorem 1.31 needs xⁱⁿⁱᵗ ∈ S; by (3.7) daughters are set nearer to each other than twice the hard "
            "radius, and by (3.4) that radius jumps"
        ),
        place=1129,
    ),
    rests_on=("c1.existence", "c1.dependence", "c1.time-independent"),
    chosen="nuclei in a row that touch, pulled to the middle, without noise",
)
def _applications() -> Evidence:
    events = (divided(), in_mitosis())
    starts = [nearest(event) for event in events]
    left = max(overlap(start) for start in starts)
    later, moves = (max(values) for values in zip(*(refined(start) for start in starts), strict=True))
    return Evidence(
        printed=(
            at_most("overlap of daughters after a division (3.7) [μm]", overlap(events[0]), 0.0, TOL),
            at_most("overlap of neighbours when mitosis begins (3.4) [μm]", overlap(events[1]), 0.0, TOL),
        ),
        corrected=(
            at_most("overlap of the states projected onto S [μm]", left, 0.0, 10 * TOL),
            at_most("overlap of catch-up from there [μm]", later, 0.0, 10 * TOL),
            at_most("change of its end when the step is halved again, over that before", moves, 1.0),
        ),
    )
