"""Chapter 1, sections 4.6.3 and 5: the proof of uniqueness, and whether the theorems cover the later models."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

import dincl
from verification.claims import Correction, Effect, Evidence, at_most, claim
from verification.claims.formal.algebra import library
from verification.claims.formal.stated import identity
from verification.thesis.chapter1.cells import TOL, State, divided, in_mitosis, nearest, overlap, problem

sp = library()

# Of catch-up from a feasible state, in units of the time in which the pull to the middle acts.
DT, END = 0.1, 1.0

# One coordinate: x' = v + f, y' = w + f.
x, y, v, w, f, K, rho, t = sp.symbols("x y v w f K rho t")

_uniqueness_sign = identity(
    "c1.uniqueness-sign",
    "proof of Lemma 1.32",
    "½ d/dt ‖x - y‖² ≤ -(v - w)·(x - y) + … ≤ (‖v‖ + ‖w‖)/(2η) ‖x - y‖² + …",
    "½ d/dt ‖x - y‖² ≤ -(v - w)·(x - y) for two solutions with constraint forces v, w ∈ -N, F constant.",
    right=(x - y) * ((v + f) - (w + f)) - (v - w) * (x - y),
    wrong=(x - y) * ((v + f) - (w + f)) + (v - w) * (x - y),
    correction=Correction(
        "(v - w)·(x - y)",
        Effect.PROOF,
        "(1.77), which stands but for its exponential",
        why="ẋ − ẏ = (v − w) + F(x) − F(y), and (1.28) for −v, −w ∈ N(S, ·) bounds (v − w)·(x − y) from above",
        place=1119,
    ),
    rests_on=("c1.hypomonotone",),
)

# K is the integral of L_F + (|v| + |w|)/(2 eta) up to t, rho the first distance: the bound begins with rho and grows at
# the rate K'.
BOUND = rho * sp.exp(sp.Function("K")(t))
PRINTED = rho * sp.Function("K")(t)
RATE = sp.Function("K")(t).diff(t)

_gronwall = identity(
    "c1.gronwall",
    "(1.77)",
    "‖x(t) - y(t)‖ ≤ ‖xⁱⁿⁱᵗ - yⁱⁿⁱᵗ‖ ∫₀ᵗ (L_F + (‖v‖ + ‖w‖)/(2η)) ds",
    "The distance of two solutions is at most its first value times the integral of L_F + (‖v‖ + ‖w‖)/(2η).",
    right=[BOUND.diff(t) - RATE * BOUND, (rho * sp.exp(K)).subs(K, 0) - rho],
    wrong=[PRINTED.diff(t) - RATE * PRINTED, (rho * K).subs(K, 0) - rho],
    correction=Correction(
        "‖xⁱⁿⁱᵗ - yⁱⁿⁱᵗ‖ exp(∫₀ᵗ (L_F + (‖v‖ + ‖w‖)/(2η)) ds)",
        Effect.PROOF,
        "the constant a of Lemma 1.32",
        why=(
            "Gronwall's lemma turns d/dt ‖x − y‖² ≤ 2a(t)‖x − y‖² into the exponential of ∫a; at t = 0 the printed "
            "bound is 0"
        ),
        place=1123,
    ),
    rests_on=("c1.uniqueness-sign",),
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
            "they cover the motion from one cell event to the next, if it starts in S; after a division, and when "
            "mitosis begins, the state is not in S, and has to be projected or set anew, e.g. with daughters 2R^hard "
            "apart"
        ),
        Effect.CONCLUSION,
        (
            "“which fulfil the assumptions needed for well-posedness” in the introduction; section 3.2 of chapter 3, "
            "which takes Theorem 1.31 for its model"
        ),
        why=(
            "Theorem 1.31 needs xⁱⁿⁱᵗ ∈ S; by (3.7) daughters are set nearer to each other than twice the hard radius,"
            " and by (3.4) that radius jumps"
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
