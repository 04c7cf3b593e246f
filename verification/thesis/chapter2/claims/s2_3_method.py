"""Chapter 2, section 2.3: first-order PBD, what one sweep leaves, and alternating projections."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math
from typing import Any

import numpy as np

import dincl
from verification.claims import Evidence, Tables, Verdict, at_least, at_most, equal, proved
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter2.methods import PBD
from verification.thesis.text.quoted import claim

# Steps of the four discs, and how far from 1 an order may be that is read off two of them.
STEPS, ORDER_BAND = (1 / 160, 1 / 320), 0.1


@claim(
    "c2.infeasible",
    "One sweep of projections need not reach the intersection of the sets.",
    "section 2.3",
    Verdict.PROVED,
)
def _infeasible() -> Evidence:
    """Discs of diameter 1 at -1 + h, 0 and 1 - h; a, b, c after the first pair is moved apart, then d, e the second."""
    return proved(
        implication(
            "three discs in a row, the outer ones pressed inwards by h: after one sweep the first pair overlaps "
            "by ¾h > 0",
            lambda s, h, a, b, d, e: (
                [h > 0, h < 0.5, a == -1 + h - h / 2, b == h / 2, d == b - (1 - (1 - h - b)) / 2, e == 1 - h + (b - d)],
                [b - a == 1, e - d == 1, 1 - (d - a) == s * 0.75 * h, d - a < 1],
            ),
            "by ½h",
            2 / 3,
        )
    )


@claim(
    "c2.prediction",
    "The prediction adds at most the length of its step to the distance from the feasible set.",
    "section 2.3",
    Verdict.PROVED,
)
def _prediction() -> Evidence:
    """p is the point of S nearest to x; d = |x - p|, n = |x~ - p|, q = dist(x~, S) <= n."""
    return proved(
        implication(
            "dist(x̃, S) ≤ |x̃ − p| ≤ |x − p| + Δt‖F‖ for the point p of S nearest to x, in any set S",
            lambda s, q, n, d, f: ([d >= 0, f > 0, q <= n, n <= d + f], q <= d + s * f),
            "without Δt‖F‖",
            0,
        )
    )


def largest_overlap(dt: float) -> float:
    """Of the four discs of Figure 4, over all steps to t = 2."""
    times = np.arange(1, round(2.0 / dt) + 1) * dt
    return float(dincl.solve(dincl.scenes.four_disks(), dincl.PBD(dt=dt), t=times).violation().max())


@claim(
    "c2.smaller",
    "The largest overlap of a run of PBD goes to zero with the step.",
    "Figure 2",
    Verdict.NOT_REFUTED,
    chosen="the four discs of Figure 4, the start is not given",
    tried_on="four discs that are drawn to one point",
)
def _smaller() -> Evidence:
    coarse, fine = (largest_overlap(dt) for dt in STEPS)
    order = math.log2(coarse / fine)
    return Evidence(
        f"Four discs to t = 2: they overlap by at most {coarse:.2e} at dt = {STEPS[0]:.3g} and {fine:.2e} at half of "
        f"it, order {order:.2f}.",
        (equal("order of the overlap", order, 1.0, ORDER_BAND),),
    )


@claim(
    "c2.large-steps",
    "At steps at which the penalty method throws the discs apart, PBD does not.",
    "Figure 2",
    Verdict.NOT_REFUTED,
    needs=("large_steps",),
    chosen="steps at which explicit Euler without constraints is stable; the starts",
    tried_on="the scenes of Figures 4 and 5",
)
def _large(tables: Tables) -> Evidence:
    """Runs that threw a disc out; those that stopped, for centres came to coincide, are told."""
    rows = tables["large_steps"]
    pbd, penalty = rows[rows["method"] == PBD.name], rows[rows["method"] != PBD.name]
    done, thrown = pbd[pbd["status"] == "SUCCESS"], penalty[(penalty["status"] == "SUCCESS") & ~penalty["stable"]]
    stopped = len(pbd) - len(done)
    limits = thrown.groupby("method")["dt"].min()
    told = ", ".join(f"{name.replace('_', ' ')} from {dt:g}" for name, dt in limits.items())
    return Evidence(
        f"PBD at dt = {pbd['dt'].min():g} … {pbd['dt'].max():g}: {int((~done['stable']).sum())} of {len(done)} runs "
        f"unstable ({stopped} stopped: centres coincide, no projection is defined). Unstable: {told}. (Explicit Euler "
        "for F = −x itself needs dt ≤ 2.)",
        (
            at_most("unstable runs of PBD", float((~done["stable"]).sum()), 0),
            at_least("runs of PBD", len(done), 1),
            at_least("unstable runs of the penalty method", len(thrown), 1),
        ),
    )


@claim(
    "c2.alternating",
    "Alternating projections converge to a common point, in examples also for sets that are not convex.",
    "Remark 2.4",
    Verdict.PROVED_INSTANCE,
    chosen="a disc and a half plane; two contacts of three discs",
    tried_on="the unit disc and y ≥ ½, and three discs in a line",
)
def _alternating() -> Evidence:
    """A point (x, y) of the unit disc with y < 1/2 goes to (x, 1/2) and, if that is outside, to (x, 1/2)/|(x, 1/2)|.

    u = x^2, w is u of the next point, 3/4 that of the common point. Of three discs in a line a and b are the overlaps.
    """
    return proved(
        identity(
            "u = x² becomes w = u/(u + ¼), and w − ¾ = (u − ¾)/(4u + 1)",
            lambda s, u: (
                u / (u + library().Rational(1, 4))
                - library().Rational(3, 4)
                - s * (u - library().Rational(3, 4)) / (4 * u + 1)
            ),
            "−(u − ¾)/(4u + 1)",
        ),
        implication(
            "so each round leaves less than a quarter of the distance to the disc and the half plane",
            lambda s, u, d, new: ([d > 0, u == 0.75 + d, new * (4 * u + 1) == d], new <= s * d / 4),
            "less than an eighth",
            0.5,
        ),
        implication(
            "and a quarter of the overlap of three discs in a line, whose sets are not convex",
            lambda s, a, b, new: ([a == 0, b > 0, new == (a + b / 2) / 2], new == s * b / 4),
            "an eighth",
            0.5,
        ),
    )


@claim(
    "c2.subspaces",
    "For subspaces the iteration converges, and then to the projection onto the intersection.",
    "Remark 2.4",
    Verdict.PROVED_INSTANCE,
    tried_on="subspaces of finite dimension, in the planes of their principal angles",
)
def _subspaces() -> Evidence:
    """In each such plane both subspaces are lines, at an angle w: for w = 0 a common one, else they share 0 only."""
    sp = library()
    w = sp.Symbol("w", real=True)

    def onto(angle: Any) -> Any:
        unit = sp.Matrix([sp.cos(angle), sp.sin(angle)])
        return unit * unit.T

    A, B = onto(0), onto(w)
    return proved(
        identity(
            "(P_A P_B)² = cos²w P_A P_B, so (P_A P_B)ⁿ → 0 for w ≠ 0 and is P_A for w = 0: the projection onto A ∩ B",
            lambda s: [A * B * A * B - s * sp.cos(w) ** 2 * A * B, (A * B - A).subs(w, 0)],
            "−cos²w",
        )
    )
