"""Chapter 2, section 2.3: first-order PBD, what one sweep leaves, and alternating projections."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math
from typing import Any

import numpy as np

import dincl
from verification.claims import Tables, claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal, proved
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter1.sets import Floats
from verification.thesis.chapter2.discs import overlap, parted
from verification.thesis.chapter2.methods import PBD

# Steps of the four discs, and how far from 1 an order may be that is read off two of them.
STEPS, ORDER_BAND = (1 / 160, 1 / 320), 0.1
# Alternating projections: a disc of radius 1 at the origin and the half plane y >= EDGE; how often.
EDGE = 0.5
ROUNDS = 400


@claim(
    "c2.infeasible",
    "One sweep of projections need not reach the intersection of the sets.",
    source="section 2.3",
    quote="it can happen that even the corrected state is not feasible, i.e. x_{k+1} ∉ S",
    recorded=Kind.PROVED,
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
    source="section 2.3",
    quote="dist(x̃_{k+1}, S) ≤ dist(x_k, S) + Δt ‖F(x_k)‖",
    recorded=Kind.PROVED,
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
    source="Figure 2",
    quote="by choosing sufficiently small time steps the infeasibility will also decrease",
    chosen="the four discs of Figure 4, the start is not given",
    recorded=Kind.NOT_REFUTED,
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
    source="Figure 2",
    quote="Crucially, the use of large time steps does not make the simulations unstable.",
    needs=("large_steps",),
    chosen="steps at which explicit Euler without constraints is stable; the starts",
    recorded=Kind.NOT_REFUTED,
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


def half_plane(x: Floats) -> Floats:
    """The nearest point with y >= EDGE."""
    return np.array([x[0], max(x[1], EDGE)])


def disc(x: Floats) -> Floats:
    """The nearest point of the unit disc."""
    return x / max(1.0, float(np.linalg.norm(x)))


@claim(
    "c2.alternating",
    "Alternating projections converge to a common point, in examples also for sets that are not convex.",
    source="Remark 2.4",
    quote="alternating projections finds a point in the intersection A ∩ B by iterating x_{k+1} = P_A(P_B(x_k))",
    chosen="a disc and a half plane; two contacts of three discs",
    recorded=Kind.NOT_REFUTED,
    tried_on="a disc and a half plane, and two contacts of three discs",
)
def _alternating() -> Evidence:
    """A convex pair of sets, and the two contacts of three discs in a row, whose sets are not convex."""
    x, three = np.array([2.0, -1.5]), np.array([[0.0, 0.0], [0.7, 0.1], [1.4, -0.1]])
    for _round in range(ROUNDS):
        x = disc(half_plane(x))
        three[[1, 2]] = parted(three[[1, 2]])
        three[[0, 1]] = parted(three[[0, 1]])
    convex = float(np.linalg.norm(half_plane(x) - x))
    curved = max(overlap(three[:2]), overlap(three[1:]))
    return Evidence(
        f"After {ROUNDS} rounds the point is {convex:.0e} from the intersection of a disc and a half plane; three "
        f"discs in a row, whose sets are not convex, overlap by {curved:.0e}.",
        (at_most("distance to the second set", convex, 1e-9), at_most("overlap", curved, 1e-9)),
    )


@claim(
    "c2.subspaces",
    "For subspaces the iteration converges, and then to the projection onto the intersection.",
    source="Remark 2.4",
    quote="If A, B are closed subspaces … Von Neumann's alternating projections",
    recorded=Kind.PROVED_INSTANCE,
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
